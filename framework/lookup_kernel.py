"""The bilinear look-up, compiled. Importing this module loads Numba; `framework.lookup` does when it pays."""

import math

import numpy as np
from numba import njit

_FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def half_turns(y, x):
    """atan2(y, x) / pi to 1e-11, without a branch, so that loops over it run in vectors; 0 for (0, 0)."""
    small, large = min(abs(x), abs(y)), max(abs(x), abs(y))
    # Between 0 and 22.5 degrees the series converges: nearer to the diagonal, count from there.
    diagonal = small > 0.41421356237309503 * large
    t = (small - large if diagonal else small) / (small + large if diagonal else (large if large > 0.0 else 1.0))
    t2 = t * t
    high = 1 / 13 + t2 * (-1 / 15 + t2 * (1 / 17 + t2 * (-1 / 19 + t2 * (1 / 21 - t2 / 23))))
    low = -1 / 3 + t2 * (1 / 5 + t2 * (-1 / 7 + t2 * (1 / 9 + t2 * (-1 / 11 + t2 * high))))
    angle = (t + t * t2 * low) * (1.0 / math.pi) + (0.25 if diagonal else 0.0)
    angle = 0.5 - angle if abs(y) > abs(x) else angle
    angle = 1.0 - angle if x < 0.0 else angle
    return -angle if y < 0.0 else angle


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def angles(n, x, y, z, down, right):
    """Where n directions of any length lie in a map, in half turns as for `blend`, into `down` and `right`."""
    # Apart from what reads points of three numbers each: in one loop with that, it takes six times as long.
    for i in range(n):
        down[i] = half_turns(math.sqrt(x[i] * x[i] + z[i] * z[i]), y[i])
        right[i] = half_turns(x[i], -z[i])


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def blend(texels, start, height, down, right):
    """A map of that height, whose rows begin at `start` in texels (T, 3), between its pixels: three numbers.

    The place is `down` half turns from the top, and `right` half turns from the middle of the first row's edge.
    """
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
    # Unsigned: Numba then leaves out what makes -1 the last row.
    upper, lower = start + upper * width, start + lower * width
    a, b, c, d = np.uint64(upper + a), np.uint64(upper + b), np.uint64(lower + c), np.uint64(lower + d)
    wa, wb, wc, wd = (1.0 - v) * (1.0 - u), (1.0 - v) * u, v * (1.0 - u), v * u
    return (
        wa * texels[a, 0] + wb * texels[b, 0] + wc * texels[c, 0] + wd * texels[d, 0],
        wa * texels[a, 1] + wb * texels[b, 1] + wc * texels[c, 1] + wd * texels[d, 1],
        wa * texels[a, 2] + wb * texels[b, 2] + wc * texels[c, 2] + wd * texels[d, 2],
    )


# Not parallel: one core makes the 5 million look-ups a second that are wanted, and a process that has started
# Numba's threads can no longer fork.
@njit(cache=True, nogil=True, error_model="numpy")
def bilinear(pixels, direction):
    """`framework.lookup.lookup` for (H, 2H, 3) and (N, 3) contiguous float64 arrays."""
    height, width = pixels.shape[0], pixels.shape[1]
    scale = height / math.pi
    value = np.empty_like(direction)
    for i in range(direction.shape[0]):
        x, y, z = direction[i, 0], direction[i, 1], direction[i, 2]
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
            value[i] = np.nan
            continue
        if x == 0 and y == 0 and z == 0:
            value[i] = 0.0
            continue
        across = math.sqrt(x * x + z * z)
        if not 1e-150 < across < 1e150:
            across = math.hypot(x, z)
        v = math.atan2(across, y) * scale - 0.5
        u = math.atan2(x, -z) * scale - 0.5
        row, column = math.floor(v), math.floor(u)
        v, u = v - row, u - column
        # Remainders by division would take longer than the rest of the loop: u lies within half a turn.
        column = column + width if column < 0 else column
        beyond = column + 1 if column + 1 < width else 0
        turned = column - height if column >= height else column + height
        beyond_turned = turned + 1 if turned + 1 < width else 0
        below, a, b, c, d = row + 1, column, beyond, column, beyond
        if row < 0:
            row, a, b = 0, turned, beyond_turned
        if below >= height:
            below, c, d = height - 1, turned, beyond_turned
        for k in range(3):
            above = (1 - u) * pixels[row, a, k] + u * pixels[row, b, k]
            under = (1 - u) * pixels[below, c, k] + u * pixels[below, d, k]
            value[i, k] = (1 - v) * above + v * under
    return value


def warm():
    """Compile the kernel for the types that `lookup` calls it with."""
    pixels, direction = np.zeros((1, 2, 3)), np.ones((1, 3))
    pixels.flags.writeable = direction.flags.writeable = False
    bilinear(pixels, direction)
