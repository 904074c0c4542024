"""Look-ups and shading, compiled: the inner loops of `shade` and `monte_carlo`. Importing this module loads Numba.

Maps lie one behind the other in `texels` (T, 3) float32, row by row; `starts` and `heights` (L,) say where.
"""

import math

import numpy as np
from numba import njit, prange

from framework.lookup_kernel import angles, blend, half_turns

_FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}
SPAN = 128  # points whose angles are computed in the processor's vectors, before the look-ups one by one


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def look_up(texels, starts, heights, levels, x, y, z, roughness):
    """Filtered radiance along (x, y, z): bilinear in the two nearest levels, linear in roughness between them."""
    down, right = half_turns(math.sqrt(x * x + z * z), y), half_turns(x, -z)
    low, high, share = _levels(levels, roughness)
    r, g, b = blend(texels, starts[low], heights[low], down, right)
    r1, g1, b1 = blend(texels, starts[high], heights[high], down, right)
    return r + share * (r1 - r), g + share * (g1 - g), b + share * (b1 - b)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _levels(levels, roughness):
    """The two nearest levels, and the share of the second."""
    low, last = 0, len(levels) - 1
    for level in range(1, last):  # all of them: where roughnesses differ, a branch would mostly be guessed wrong
        low += 1 if roughness >= levels[level] else 0
    high = min(low + 1, last)
    share = (roughness - levels[low]) / (levels[high] - levels[low]) if high > low else 0.0
    return low, high, min(max(share, 0.0), 1.0)


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def look_up_all(texels, starts, heights, levels, direction, roughness, color):
    """`look_up` for directions (N, 3); roughness (N,) or (1,) for all."""
    each = 1 if len(roughness) > 1 else 0
    for i in prange(direction.shape[0]):
        x, y, z = direction[i, 0], direction[i, 1], direction[i, 2]
        color[i, 0], color[i, 1], color[i, 2] = look_up(
            texels, starts, heights, levels, x, y, z, roughness[each * i]
        )


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def shade(texels, starts, heights, levels, lut, normal, view, r0, roughness, color):
    """The split sum for (N, 3) normals and views; r0 (N, 3) or (1, 3), roughness (N,) or (1,); fills color."""
    each_r0, each_roughness = 1 if len(r0) > 1 else 0, 1 if len(roughness) > 1 else 0
    count = normal.shape[0]
    for span in prange((count + SPAN - 1) // SPAN):
        first = span * SPAN
        n = min(SPAN, count - first)
        rough = roughness[each_roughness * first : each_roughness * first + (n if each_roughness else 1)]
        reflectance = r0[each_r0 * first : each_r0 * first + (n if each_r0 else 1)]
        there = normal[first : first + n], view[first : first + n], reflectance, rough
        _shade_span(texels, starts, heights, levels, lut, *there, color[first : first + n])


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _shade_span(texels, starts, heights, levels, lut, normal, view, r0, roughness, color):
    n, rows = normal.shape[0], np.empty((6, SPAN))
    cosine, x, y, z, down, right = rows[0], rows[1], rows[2], rows[3], rows[4], rows[5]
    _mirror(normal, view, cosine, x, y, z)
    angles(n, x, y, z, down, right)
    each_r0 = 1 if len(r0) > 1 else 0
    for i in range(n):  # what is below the horizon, or no number at all, looks anywhere and is seen nowhere
        down[i], right[i] = (down[i], right[i]) if 0.0 < cosine[i] < np.inf else (0.5, 0.0)
    _look_ups(n, texels, starts, heights, levels, down, right, roughness, x, y, z)
    for i in range(n):
        if not cosine[i] > 0.0:
            color[i, 0] = color[i, 1] = color[i, 2] = 0.0
            continue
        scale, bias = _table(lut, cosine[i], roughness[i if len(roughness) > 1 else 0])
        color[i, 0] = x[i] * (r0[each_r0 * i, 0] * scale + bias)
        color[i, 1] = y[i] * (r0[each_r0 * i, 1] * scale + bias)
        color[i, 2] = z[i] * (r0[each_r0 * i, 2] * scale + bias)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _look_ups(n, texels, starts, heights, levels, down, right, roughness, r, g, b):
    """`look_up` in n places."""
    each = 1 if len(roughness) > 1 else 0
    for i in range(n):
        low, high, share = _levels(levels, roughness[each * i])
        r0, g0, b0 = blend(texels, starts[low], heights[low], down[i], right[i])
        r1, g1, b1 = blend(texels, starts[high], heights[high], down[i], right[i])
        r[i], g[i], b[i] = r0 + share * (r1 - r0), g0 + share * (g1 - g0), b0 + share * (b1 - b0)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _mirror(normal, view, cosine, x, y, z):
    """Cosines between normals and views, and the mirrored views."""
    for i in range(normal.shape[0]):
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        vx, vy, vz = view[i, 0], view[i, 1], view[i, 2]
        mu = nx * vx + ny * vy + nz * vz
        cosine[i], x[i], y[i], z[i] = mu, 2.0 * mu * nx - vx, 2.0 * mu * ny - vy, 2.0 * mu * nz - vz


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _table(lut, mu, rough):
    """Scale and bias of r0."""
    rows, columns = lut.shape[0], lut.shape[1]
    across = min(max(mu * columns - 0.5, 0.0), columns - 1.0)
    down = min(max(rough * rows - 0.5, 0.0), rows - 1.0)
    left, top = min(int(across), max(columns - 2, 0)), min(int(down), max(rows - 2, 0))
    u, v = across - left, down - top
    right, bottom = np.uint64(min(left + 1, columns - 1)), np.uint64(min(top + 1, rows - 1))
    left, top = np.uint64(left), np.uint64(top)
    wa, wb, wc, wd = (1.0 - v) * (1.0 - u), (1.0 - v) * u, v * (1.0 - u), v * u
    scale = wa * lut[top, left, 0] + wb * lut[top, right, 0]
    scale += wc * lut[bottom, left, 0] + wd * lut[bottom, right, 0]
    bias = wa * lut[top, left, 1] + wb * lut[top, right, 1]
    bias += wc * lut[bottom, left, 1] + wd * lut[bottom, right, 1]
    return scale, bias


def warm():
    """Compile every kernel, or load it from the cache."""
    texels, start, height = np.ones((2, 3), np.float32), np.zeros(1, np.int64), np.ones(1, np.int64)
    up, one = np.array([[0.0, 1.0, 0.0]]), np.ones(1)
    look_up_all(texels, start, height, one, up, one, np.empty((1, 3)))
    shade(texels, start, height, one, np.ones((1, 1, 2), np.float32), up, up, up, one, np.empty((1, 3)))
