"""The inner loop of `lut`: quadrature over half vectors. Importing this module loads Numba."""

import math

import numpy as np
from numba import njit, prange

_FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def integrate(rows, columns, lut):
    """Fill lut (size, size, 2) from nodes and weights on [0, 1]: rows (2, R) in tilt, columns (2, C) in azimuth.

    With the tilt's log-density as variable, `depth = log(1 + tan^2 / alpha^2)`, D (n.h) dh is
    `exp(-depth) ddepth dphi / (2 pi)`. The horizon cuts no azimuth up to one tilt and all past another: the range
    is split there, and each part is smooth.
    """
    size = lut.shape[0]
    tilts, azimuths = rows.shape[1], columns.shape[1]
    for row in prange(size):
        alpha = ((row + 0.5) / size) ** 2
        cos_phi = np.empty(azimuths)
        for column in range(size):
            mu = (column + 0.5) / size
            across = math.sqrt((1.0 - mu) * (1.0 + mu))
            slope_o = math.sqrt(1.0 + (alpha * across / mu) ** 2)
            # tan(pi/4 -+ view/2) by the half angle: neither overflows, for mu > 0.
            first = math.log1p((mu / (1.0 + across) / alpha) ** 2)
            last = math.log1p(((1.0 + across) / mu / alpha) ** 2)
            scale = bias = 0.0
            for part in range(2):
                low, high = (0.0, first) if part == 0 else (first, last)
                for r in range(tilts):
                    depth = low + (high - low) * rows[0, r]
                    tan2 = alpha * alpha * math.expm1(depth)
                    cos2 = 1.0 / (1.0 + tan2)
                    cos_h, sin_h = math.sqrt(cos2), math.sqrt(tan2 * cos2)
                    weight = (high - low) * rows[1, r] * math.exp(-depth) / (cos_h * mu)
                    swing, middle = across * sin_h, mu * cos_h
                    # The reflection meets the horizon where 2 (v.h) (n.h) = n.v.
                    edge = mu * (sin_h * sin_h - cos2) / max(2.0 * swing * cos_h, 1e-300)
                    limit = math.acos(min(max(edge, -1.0), 1.0))
                    weight *= limit / math.pi
                    for c in range(azimuths):
                        cos_phi[c] = _sin(0.5 * math.pi - limit * columns[0, c])
                    sum_scale = sum_bias = 0.0
                    for c in range(azimuths):
                        v_h = middle + swing * cos_phi[c]
                        cos_i = max(2.0 * v_h * cos_h - mu, 0.0)
                        slope_i = math.sqrt(cos_i * cos_i + alpha * alpha * (1.0 - cos_i * cos_i))
                        # Smith's 2 / (slope_i / cos_i + slope_o).
                        seen = columns[1, c] * v_h * 2.0 * cos_i / (slope_i + cos_i * slope_o)
                        away = max(1.0 - v_h, 0.0)
                        schlick = away * away
                        schlick *= schlick * away
                        sum_bias += seen * schlick
                        sum_scale += seen - seen * schlick
                    scale += weight * sum_scale
                    bias += weight * sum_bias
            lut[row, column, 0] = scale
            lut[row, column, 1] = bias


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _sin(x):
    """Taylor's polynomial, to 6e-8 for |x| <= pi / 2: unlike the library's it runs on several values at a time."""
    y = x * x
    return x * (1.0 + y * (-1 / 6 + y * (1 / 120 + y * (-1 / 5040 + y * (1 / 362880 - y / 39916800)))))


def warm():
    """Compile the kernel, or load it from the cache."""
    integrate(np.full((2, 1), 0.5), np.full((2, 1), 0.5), np.empty((1, 1, 2)))
