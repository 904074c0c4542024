"""The bilinear look-up, compiled. Importing this module loads Numba; `framework.lookup` does when it pays."""

import math

import numpy as np
from numba import njit


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
