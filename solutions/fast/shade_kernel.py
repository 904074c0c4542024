"""Look-ups and shading, compiled: the inner loops of `shade` and `monte_carlo`. Importing this module loads Numba.

Maps lie one behind the other in `texels` (T, 3) float32, row by row; `starts` and `heights` (L,) say where.
"""

import math

import numpy as np
from numba import njit, prange

_FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _half_turns(y, x):
    """atan2(y, x) / pi to 1e-11, at a third of its time; 0 for (0, 0)."""
    small, large = min(abs(x), abs(y)), max(abs(x), abs(y))
    if large == 0.0:
        return 0.0
    # Between 0 and 22.5 degrees the series converges: nearer to the diagonal, count from there.
    diagonal = small > 0.41421356237309503 * large
    t = (small - large) / (small + large) if diagonal else small / large
    t2 = t * t
    high = 1 / 13 + t2 * (-1 / 15 + t2 * (1 / 17 + t2 * (-1 / 19 + t2 * (1 / 21 - t2 / 23))))
    low = -1 / 3 + t2 * (1 / 5 + t2 * (-1 / 7 + t2 * (1 / 9 + t2 * (-1 / 11 + t2 * high))))
    angle = (t + t * t2 * low) * (1.0 / math.pi) + (0.25 if diagonal else 0.0)
    angle = 0.5 - angle if abs(y) > abs(x) else angle
    angle = 1.0 - angle if x < 0.0 else angle
    return -angle if y < 0.0 else angle


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _bilinear(texels, start, height, down, right):
    """A map at `down` half turns from the top, and `right` half turns from the middle of its first edge."""
    width = 2 * height
    v, u = down * height - 0.5, right * height - 0.5
    upper, left = math.floor(v), math.floor(u)
    v, u = v - upper, u - left
    a = left + width if left < 0 else left
    c, lower = a, upper + 1
    if upper < 0:  # over a pole a row goes on half a turn away
        upper, a = 0, a - height if a >= height else a + height
    if lower >= height:
        lower, c = height - 1, c - height if c >= height else c + height
    b, d = a + 1 if a + 1 < width else 0, c + 1 if c + 1 < width else 0
    upper, lower = start + upper * width, start + lower * width
    a, b, c, d = upper + a, upper + b, lower + c, lower + d
    wa, wb, wc, wd = (1.0 - v) * (1.0 - u), (1.0 - v) * u, v * (1.0 - u), v * u
    return (
        wa * texels[a, 0] + wb * texels[b, 0] + wc * texels[c, 0] + wd * texels[d, 0],
        wa * texels[a, 1] + wb * texels[b, 1] + wc * texels[c, 1] + wd * texels[d, 1],
        wa * texels[a, 2] + wb * texels[b, 2] + wc * texels[c, 2] + wd * texels[d, 2],
    )


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def look_up(texels, starts, heights, levels, x, y, z, roughness):
    """Filtered radiance along (x, y, z): bilinear in the two nearest levels, linear in roughness between them."""
    down, right = _half_turns(math.sqrt(x * x + z * z), y), _half_turns(x, -z)
    level = 0
    while level + 2 < len(levels) and roughness >= levels[level + 1]:
        level += 1
    r, g, b = 0.0, 0.0, 0.0
    share = 0.0
    if len(levels) > 1:
        share = min(max((roughness - levels[level]) / (levels[level + 1] - levels[level]), 0.0), 1.0)
    if share < 1.0:
        r, g, b = _bilinear(texels, starts[level], heights[level], down, right)
    if share > 0.0:
        r1, g1, b1 = _bilinear(texels, starts[level + 1], heights[level + 1], down, right)
        r, g, b = r + share * (r1 - r), g + share * (g1 - g), b + share * (b1 - b)
    return r, g, b


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
    rows, columns = lut.shape[0], lut.shape[1]
    each_r0, each_roughness = 1 if len(r0) > 1 else 0, 1 if len(roughness) > 1 else 0
    for i in prange(normal.shape[0]):
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        vx, vy, vz = view[i, 0], view[i, 1], view[i, 2]
        mu = nx * vx + ny * vy + nz * vz
        if not mu > 0.0:
            color[i, 0] = color[i, 1] = color[i, 2] = 0.0
            continue
        rough = roughness[each_roughness * i]
        across = min(max(mu * columns - 0.5, 0.0), columns - 1.0)
        down = min(max(rough * rows - 0.5, 0.0), rows - 1.0)
        left, top = min(int(across), max(columns - 2, 0)), min(int(down), max(rows - 2, 0))
        right, bottom = min(left + 1, columns - 1), min(top + 1, rows - 1)
        u, v = across - left, down - top
        wa, wb, wc, wd = (1.0 - v) * (1.0 - u), (1.0 - v) * u, v * (1.0 - u), v * u
        scale = wa * lut[top, left, 0] + wb * lut[top, right, 0]
        scale += wc * lut[bottom, left, 0] + wd * lut[bottom, right, 0]
        bias = wa * lut[top, left, 1] + wb * lut[top, right, 1]
        bias += wc * lut[bottom, left, 1] + wd * lut[bottom, right, 1]
        x, y, z = 2.0 * mu * nx - vx, 2.0 * mu * ny - vy, 2.0 * mu * nz - vz
        r, g, b = look_up(texels, starts, heights, levels, x, y, z, rough)
        color[i, 0] = r * (r0[each_r0 * i, 0] * scale + bias)
        color[i, 1] = g * (r0[each_r0 * i, 1] * scale + bias)
        color[i, 2] = b * (r0[each_r0 * i, 2] * scale + bias)


def warm():
    """Compile every kernel, or load it from the cache."""
    texels, start, height = np.ones((2, 3), np.float32), np.zeros(1, np.int64), np.ones(1, np.int64)
    up, one = np.array([[0.0, 1.0, 0.0]]), np.ones(1)
    look_up_all(texels, start, height, one, up, one, np.empty((1, 3)))
    shade(texels, start, height, one, np.ones((1, 1, 2), np.float32), up, up, up, one, np.empty((1, 3)))
