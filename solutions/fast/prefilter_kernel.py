"""The inner loops of `prefilter`: rings of a map joined by a zonal lobe. Importing this module loads Numba.

A map's Fourier series along its rows is kept as planes (rows, 6, frequencies): the real and the imaginary part
of three colours, for the frequencies from 0 up.
"""

import math

import numpy as np
from numba import njit, prange

_FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}
# Frequencies whose share has fallen to exp(-23) = 1e-10 are left out: far behind a sun the lobe itself has
# fallen to 1e-6 of its peak, and that must still be right to a part in a thousand.
CUT = 23.0


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def row_series(spectrum, factor, planes):
    """The transform (H, 3, H + 1) of rows of 2H values, times a factor (M,) for each frequency below M <= 2H."""
    rows, half = spectrum.shape[0], spectrum.shape[2] - 1
    for row in prange(rows):
        for k in range(3):
            for m in range(factor.shape[0]):
                # A row of real values: the upper half of its transform mirrors the lower one.
                value = spectrum[row, k, m] if m <= half else spectrum[row, k, 2 * half - m].conjugate()
                value *= factor[m]
                planes[row, 2 * k, m] = value.real
                planes[row, 2 * k + 1, m] = value.imag


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def project_rows(weights, first, last, planes, result):
    """Rows of another grid as sums of rows: (H, 6, M) to (n, 6, M).

    weights (2, n, H) for even and odd frequencies (they differ beyond a pole, where a row goes on half a turn
    away), not 0 from first[j] to before last[j].
    """
    for j in prange(result.shape[0]):
        for plane in range(6):
            for m in range(result.shape[2]):
                result[j, plane, m] = 0.0
        for b in range(first[j], last[j]):
            even, odd = weights[0, j, b], weights[1, j, b]
            for plane in range(6):
                if even == odd:
                    for m in range(result.shape[2]):
                        result[j, plane, m] += even * planes[b, plane, m]
                else:
                    for m in range(result.shape[2]):
                        result[j, plane, m] += (odd if m & 1 else even) * planes[b, plane, m]


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def fold_columns(planes, window, steps, result):
    """The series of the comb of `w` columns at azimuths 2 pi (c + steps / 2) / w: (n, 6, M) to (n, 6, w / 2 + 1).

    `window` (M,) is the transform of what spreads a point over the columns.
    """
    w = 2 * (result.shape[2] - 1)
    for j in prange(planes.shape[0]):
        for plane in range(6):
            conjugate = -1.0 if plane & 1 else 1.0
            for m in range(result.shape[2]):
                result[j, plane, m] = 0.0
            for m in range(planes.shape[2]):
                value = planes[j, plane, m] * window[m]
                place = m % w
                if place <= w // 2:
                    result[j, plane, place] += -value if (m // w) * steps & 1 else value
                opposite = (w - place) % w
                if opposite <= w // 2 and m > 0:
                    turned = -value if (m + opposite) // w * steps & 1 else value
                    result[j, plane, opposite] += conjugate * turned
            result[j, plane, w // 2] *= 0.5  # reached from both sides


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def sample_lobe(alpha, side, height, lobe):
    """lobe[i, j, c]: between row i of `height` and row j of n, c of `half` steps of azimuth apart.

    `side` 1 is the part of the lobe above its horizon; -1 the part below, with the sign turned.
    """
    n, half = lobe.shape[1], lobe.shape[2] - 1
    a2 = alpha * alpha
    along = np.cos(math.pi * np.arange(half + 1) / half)
    for i in prange(lobe.shape[0]):
        theta_i = math.pi * (i + 0.5) / height
        for j in range(n):
            theta_j = math.pi * (j + 0.5) / n
            middle, swing = math.cos(theta_i) * math.cos(theta_j), math.sin(theta_i) * math.sin(theta_j)
            for c in range(half + 1):
                cosine = middle + swing * along[c]
                peak = alpha / (a2 + (1.0 - a2) * 0.5 * (1.0 - cosine))
                lobe[i, j, c] = max(side * cosine, 0.0) * peak * peak


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def join_rings(alpha, planes, unit, result, norm):
    """Each ring of the result from all rings of the map, under a lobe that goes on below its horizon.

    Parameters
    ----------
    alpha : float below 1
    planes : (n, 6, M) float    the map's rows, each with its share of the solid angle
    unit : (n,) float           those of a white map, at frequency 0
    result : (h, 6, M) float    filled with the sums
    norm : (h,) float           filled with those of a white map

    Notes
    -----
    Between two rings the lobe is alpha^2 cos / D^2 with D = A - B cos(phi), and cos is linear in D. The Fourier
    coefficients of 1 / D are r^m / R, those of 1 / D^2 are r^m (A + m R) / R^3, with R^2 = A^2 - B^2 and
    r = B / (A + R): in closed form, and the farther the rings are apart, the sooner they vanish.
    """
    n, count, h = planes.shape[0], planes.shape[2], result.shape[0]
    a2 = alpha * alpha
    for i in prange((h + 1) // 2):
        # The mirror images of both rings in the equator have the same coefficients.
        mirrored = h - 1 - i
        theta_i = math.pi * (i + 0.5) / h
        for plane in range(6):
            for m in range(count):
                result[i, plane, m] = 0.0
                result[mirrored, plane, m] = 0.0
        series = np.empty(count + 8)
        total = 0.0
        for j in range(n):
            theta_j = math.pi * (j + 0.5) / n
            # A - B and A + B, without a difference of close numbers.
            near = a2 + (1.0 - a2) * math.sin(0.5 * (theta_i - theta_j)) ** 2
            far = a2 + (1.0 - a2) * math.sin(0.5 * (theta_i + theta_j)) ** 2
            root = math.sqrt(near * far)
            r = max(0.5 * (far - near) / (0.5 * (far + near) + root), 1e-30)
            u = a2 / (1.0 - a2) * (0.5 * (1.0 + a2) * (near + far) / root**3 - 2.0 / root)
            v = a2 / (1.0 - a2) * (1.0 + a2) / root**2
            total += u * unit[j]
            last = min(count, int(-CUT / math.log(r)) + 2)
            power = 1.0
            for m in range(8):
                series[m] = power
                power *= r
            for m in range(8, last):  # eight chains at a time: a single one would wait for each product
                series[m] = series[m - 8] * power
            for m in range(last):
                series[m] *= u + v * m
            for plane in range(6):
                for m in range(last):
                    result[i, plane, m] += series[m] * planes[j, plane, m]
            if mirrored != i:
                for plane in range(6):
                    for m in range(last):
                        result[mirrored, plane, m] += series[m] * planes[n - 1 - j, plane, m]
        norm[i] = total
        norm[mirrored] = total


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def look_around(pixels, tilt, azimuth, weight, result):
    """Weighted mean of bilinear look-ups at the same tilts and azimuths (N,) about each pixel centre of the result.

    All pixels of a row share the row of the map, and its fraction, that a look-up falls on.
    """
    height, width = pixels.shape[0], pixels.shape[1]
    rows, columns = result.shape[0], result.shape[1]
    stride = width / columns
    for i in prange(rows):
        theta = math.pi * (i + 0.5) / rows
        for k in range(columns):
            for c in range(3):
                result[i, k, c] = 0.0
        for s in range(len(weight)):
            # About +z for the axis in the plane of x and z; x grows with theta, y with phi.
            along, across = math.sin(tilt[s]) * math.cos(azimuth[s]), math.sin(tilt[s]) * math.sin(azimuth[s])
            up = math.cos(tilt[s]) * math.cos(theta) - along * math.sin(theta)
            out = math.cos(tilt[s]) * math.sin(theta) + along * math.cos(theta)
            v = math.atan2(math.hypot(out, across), up) / math.pi * height - 0.5
            start = (0.5 + math.atan2(across, out) / (2.0 * math.pi) * columns) * stride - 0.5
            upper = math.floor(v)
            v -= upper
            lower, turn_upper, turn_lower = upper + 1, 0, 0
            if upper < 0:
                upper, turn_upper = 0, height
            if lower >= height:
                lower, turn_lower = height - 1, height
            for k in range(columns):
                u = start + k * stride
                left = math.floor(u)
                u -= left
                a = (left + turn_upper) % width
                b = (left + turn_lower) % width
                a2 = a + 1 if a + 1 < width else 0
                b2 = b + 1 if b + 1 < width else 0
                for c in range(3):
                    above = (1.0 - u) * pixels[upper, a, c] + u * pixels[upper, a2, c]
                    below = (1.0 - u) * pixels[lower, b, c] + u * pixels[lower, b2, c]
                    result[i, k, c] += weight[s] * ((1.0 - v) * above + v * below)


def warm():
    """Compile every kernel, or load it from the cache."""
    planes, spectrum = np.ones((2, 6, 3)), np.ones((2, 3, 3), dtype=complex)
    row_series(spectrum, np.ones(3, dtype=complex), planes)
    project_rows(np.ones((2, 2, 2)), np.zeros(2, dtype=np.int64), np.full(2, 2), planes, np.empty((2, 6, 3)))
    fold_columns(planes, np.ones(3), 1, np.empty((2, 6, 3)))
    sample_lobe(0.5, 1.0, 2, np.empty((1, 2, 3)))
    join_rings(0.5, planes, np.ones(2), np.empty((2, 6, 3)), np.empty(2))
    look_around(np.ones((2, 4, 3)), np.ones(1), np.ones(1), np.ones(1), np.empty((2, 4, 3)))
