"""The inner loop of `monte_carlo`: visible normals, one point at a time. Importing this module loads Numba."""

import math

import numpy as np
from numba import njit, prange

from solutions.fast.shade_kernel import look_up

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX1, _MIX2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)


@njit(cache=True, nogil=True)
def _mixed(state):
    """The output function of SplitMix64 (Steele et al. 2014)."""
    state = (state ^ (state >> _30)) * _MIX1
    state = (state ^ (state >> _27)) * _MIX2
    return state ^ (state >> _31)


@njit(parallel=True, cache=True, nogil=True, error_model="numpy")
def estimate(texels, starts, heights, levels, normal, view, r0, alpha, samples, seed, mean, error):
    """Fill mean and its standard error (N, 3). Each point draws from a stream of its own, whatever the threads."""
    for i in prange(normal.shape[0]):
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        sign = math.copysign(1.0, nz)
        s = -1.0 / (sign + nz)
        t = nx * ny * s
        tx, ty, tz = 1.0 + sign * nx * nx * s, sign * t, -sign * nx
        bx, by, bz = t, sign + ny * ny * s, -ny
        vx = view[i, 0] * tx + view[i, 1] * ty + view[i, 2] * tz
        vy = view[i, 0] * bx + view[i, 1] * by + view[i, 2] * bz
        vz = view[i, 0] * nx + view[i, 1] * ny + view[i, 2] * nz
        mean[i] = 0.0
        error[i] = 0.0
        if not vz > 0.0:
            continue
        a = alpha[i]
        length = math.sqrt(a * a * (vx * vx + vy * vy) + vz * vz)
        wx, wy, wz = a * vx / length, a * vy / length, vz / length
        slope_o = math.sqrt(a * a * (1.0 - min(vz * vz, 1.0)) + vz * vz) / vz
        state = _mixed(seed + _GOLDEN * np.uint64(2 * i + 1))
        red = green = blue = red2 = green2 = blue2 = 0.0
        for _ in range(samples):
            state += _GOLDEN
            phi = 2.0 * math.pi * np.float64(_mixed(state) >> _11) * 2.0**-53
            state += _GOLDEN
            z = 1.0 - np.float64(_mixed(state) >> _11) * 2.0**-53 * (1.0 + wz)
            radius = math.sqrt(max(1.0 - z * z, 0.0))
            hx, hy, hz = a * (radius * math.cos(phi) + wx), a * (radius * math.sin(phi) + wy), z + wz
            scale = 1.0 / math.sqrt(hx * hx + hy * hy + hz * hz)
            hx, hy, hz = hx * scale, hy * scale, hz * scale
            v_h = vx * hx + vy * hy + vz * hz
            lx, ly, lz = 2.0 * v_h * hx - vx, 2.0 * v_h * hy - vy, 2.0 * v_h * hz - vz
            if not lz > 0.0:
                continue
            # Smith's G2 / G1(v): (1 + slope_o) / (slope_i + slope_o).
            slope_i = math.sqrt(a * a * (1.0 - min(lz * lz, 1.0)) + lz * lz)
            weight = (1.0 + slope_o) * lz / (slope_i + slope_o * lz)
            r, g, b = look_up(
                texels, starts, heights, levels,
                lx * tx + ly * bx + lz * nx, lx * ty + ly * by + lz * ny, lx * tz + ly * bz + lz * nz, 0.0,
            )  # fmt: skip
            away = max(1.0 - v_h, 0.0)
            schlick = away * away * away * away * away
            r *= weight * (r0[i, 0] + (1.0 - r0[i, 0]) * schlick)
            g *= weight * (r0[i, 1] + (1.0 - r0[i, 1]) * schlick)
            b *= weight * (r0[i, 2] + (1.0 - r0[i, 2]) * schlick)
            red, green, blue = red + r, green + g, blue + b
            red2, green2, blue2 = red2 + r * r, green2 + g * g, blue2 + b * b
        mean[i, 0], mean[i, 1], mean[i, 2] = red / samples, green / samples, blue / samples
        for k, square in enumerate((red2, green2, blue2)):
            variance = max(square / samples - mean[i, k] ** 2, 0.0)
            error[i, k] = math.sqrt(variance / (samples - 1)) if samples > 1 else np.inf


def warm():
    """Compile the kernel, or load it from the cache."""
    texels, start, height = np.ones((2, 3), np.float32), np.zeros(1, np.int64), np.ones(1, np.int64)
    up, one, out = np.array([[0.0, 1.0, 0.0]]), np.ones(1), np.empty((1, 3))
    estimate(texels, start, height, one, up, up, up, one, 2, np.uint64(1), out, out.copy())
