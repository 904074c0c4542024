"""The value of a mesh's distance grid at a point, compiled. Importing this module loads Numba.

The arrays are those of `framework.grid.Grid.arrays()`:

    frame : (14,) float64               low corner of the grid, its cells along x, y, z, cells per scene unit, the
                                        band, low and high corner of the mesh's box
    index : (X, Y, Z) int32             row of `bricks`; -1 where there is none and all is outside, -2 inside
    bricks : (B, 9, 9, 9, 2) float32    distance and margin at the corners of 8 x 8 x 8 cells
    coarse : (2X+1, 2Y+1, 2Z+1, 2) float32  the same at every fourth corner of the whole grid
"""

import math

import numpy as np
from numba import njit

from framework.grid_bvh_kernels import OPTIONS

CELLS = 8  # along a brick
STEP = 4  # cells along a coarse one


@njit(**OPTIONS)
def grid_value(x, y, z, frame, index, bricks, coarse):
    """The distance that `Grid` promises, at one point; NaN where a coordinate is."""
    gx, out_x = _inside(x, frame[0], frame[3], frame[6])
    gy, out_y = _inside(y, frame[1], frame[4], frame[6])
    gz, out_z = _inside(z, frame[2], frame[5], frame[6])
    value = _interpolate(gx * (1.0 / STEP), gy * (1.0 / STEP), gz * (1.0 / STEP), coarse)
    band = frame[7]
    if abs(value) < band:
        i, j = _cell(gx / CELLS, index.shape[0]), _cell(gy / CELLS, index.shape[1])
        k = _cell(gz / CELLS, index.shape[2])
        slot = index[i, j, k]
        if slot >= 0:
            fine = _interpolate(gx - i * CELLS, gy - j * CELLS, gz - k * CELLS, bricks[slot])
            fine = min(max(fine, -band), band)
        else:
            fine = band if slot == -1 else -band
        if abs(fine) > abs(value):
            value = fine
    out = out_x * out_x + out_y * out_y + out_z * out_z
    if out != 0.0:
        # The grid is convex and holds the mesh: the way to it is at least the hypotenuse.
        value = math.sqrt(out + value * value)
    dx = max(frame[8] - x, x - frame[11], 0.0)
    dy = max(frame[9] - y, y - frame[12], 0.0)
    dz = max(frame[10] - z, z - frame[13], 0.0)
    box = dx * dx + dy * dy + dz * dz
    return math.sqrt(box) if box > 0.0 and box > value * value else value


@njit(**OPTIONS)
def _inside(x, low, cells, scale):
    """A coordinate in cells, brought into the grid, and how far that moved it in scene units."""
    g = (x - low) * scale
    if not g > 0.0:
        g = 0.0
    elif g > cells:
        g = cells
    return g, 0.0 if 0.0 < g < cells else x - (low + g / scale)


@njit(**OPTIONS)
def _cell(g, count):
    return min(int(g), count - 1)


@njit(**OPTIONS)
def _interpolate(gx, gy, gz, lattice):
    """Trilinear distance, brought towards zero by the trilinear margin, but never over it."""
    i, j, k = (
        _cell(gx, lattice.shape[0] - 1),
        _cell(gy, lattice.shape[1] - 1),
        _cell(gz, lattice.shape[2] - 1),
    )
    u, v, w = gx - i, gy - j, gz - k
    distance, margin = 0.0, 0.0
    for a in range(2):
        for b in range(2):
            edge = (u if a else 1.0 - u) * (v if b else 1.0 - v)
            near, far = edge * (1.0 - w), edge * w
            distance += near * lattice[i + a, j + b, k, 0] + far * lattice[i + a, j + b, k + 1, 0]
            margin += near * lattice[i + a, j + b, k, 1] + far * lattice[i + a, j + b, k + 1, 1]
    return max(distance - margin, 0.0) + min(distance + margin, 0.0)


@njit(**OPTIONS)
def grid_values(x, y, z, frame, index, bricks, coarse):
    """`grid_value` at the points whose coordinates are `x`, `y`, `z`, `(N,)` float64 each."""
    values = np.empty(x.shape[0])
    for n in range(x.shape[0]):
        values[n] = grid_value(x[n], y[n], z[n], frame, index, bricks, coarse)
    return values


def warm():
    """Compile everything."""
    point = np.zeros(1)
    grid_values(
        point, point, point, np.ones(14), np.full((1, 1, 1), -1, np.int32),
        np.zeros((1, 9, 9, 9, 2), np.float32), np.zeros((3, 3, 3, 2), np.float32),
    )  # fmt: skip
