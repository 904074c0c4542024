"""Samples of a mesh's distance, and how far to trust what lies between them. Importing this module loads Numba.

A block is a cube of `n` x `n` x `n` samples at the corners of cells; blocks stand side by side and share the
samples of their faces. Between samples the value that is handed out is the trilinear distance, brought towards
zero by the trilinear margin, but not over it. Margins are so large that the value is never larger than the
distance, and that its sign is right or it is 0.
"""

import math

import numpy as np
from numba import njit, prange

from framework.grid_bvh_kernels import (
    OPTIONS,
    box_squared,
    leaf,
    nearest_squared,
    triangle_squared,
    winding_number,
)

_SEARCH = 2.5  # cells: beyond, the margin by curvature is below a quarter of a cell, and good enough


@njit(parallel=True, **OPTIONS)
def sample(places, low, spacing, tree, signed, f, e):
    """Fill the blocks at `places` (B, 3), counted in blocks from `low` (3,).

    `f` and `e`, (B, n, n, n) float32 each, take distances and margins, the latter for the block's own cells.
    `tree` is that of `framework.grid_bvh_kernels`; unless `signed`, distances are positive everywhere.
    """
    n = f.shape[1]
    slack = 1e-6 * spacing * n  # more than float32 loses
    for block in prange(places.shape[0]):
        x0 = low[0] + places[block, 0] * (n - 1) * spacing
        y0 = low[1] + places[block, 1] * (n - 1) * spacing
        z0 = low[2] + places[block, 2] * (n - 1) * spacing
        distance, margin = np.empty((n, n, n)), np.full((n, n, n), slack)
        for i in range(n):
            for j in range(n):
                for k in range(n):
                    _sample_point(
                        distance,
                        i,
                        j,
                        k,
                        x0 + i * spacing,
                        y0 + j * spacing,
                        z0 + k * spacing,
                        spacing,
                        tree,
                        signed,
                    )
        for i in range(n - 1):
            for j in range(n - 1):
                for k in range(n - 1):
                    x, y, z = x0 + (i + 0.5) * spacing, y0 + (j + 0.5) * spacing, z0 + (k + 0.5) * spacing
                    cell = distance[i : i + 2, j : j + 2, k : k + 2]
                    needed = _cell_margin(cell, x, y, z, spacing, tree, signed) + slack
                    for a in range(2):
                        for b in range(2):
                            for c in range(2):
                                margin[i + a, j + b, k + c] = max(margin[i + a, j + b, k + c], needed)
        f[block], e[block] = distance, margin


@njit(**OPTIONS)
def _sample_point(distance, i, j, k, x, y, z, spacing, tree, signed):
    """A neighbour that was done before bounds the search, and lends its sign where no surface can lie between."""
    bound = np.inf
    if i:
        bound = min(bound, abs(distance[i - 1, j, k]))
    if j:
        bound = min(bound, abs(distance[i, j - 1, k]))
    if k:
        bound = min(bound, abs(distance[i, j, k - 1]))
    d = math.sqrt(nearest_squared(x, y, z, ((bound + spacing) * (1.0 + 1e-9)) ** 2, tree))
    if signed:
        apart = spacing * (1.0 + 1e-9) - d
        if i and abs(distance[i - 1, j, k]) > apart:
            d = math.copysign(d, distance[i - 1, j, k])
        elif j and abs(distance[i, j - 1, k]) > apart:
            d = math.copysign(d, distance[i, j - 1, k])
        elif k and abs(distance[i, j, k - 1]) > apart:
            d = math.copysign(d, distance[i, j, k - 1])
        elif abs(winding_number(x, y, z, tree)) > 0.5:
            d = -d
    distance[i, j, k] = d


@njit(**OPTIONS)
def _cell_margin(f, x, y, z, spacing, tree, signed):
    """How far the trilinear value in a cell around (x, y, z) may exceed the distance, on either side.

    Three bounds, of which the least counts.
    - A distance is 1-Lipschitz: half the cell's diagonal.
    - Away from the surface its second derivative is at most 1 / distance.
    - Near it: the distance to what lies below a plane `n . q = s` is at least `n . p - s`. The trilinear value less
      that is trilinear, so that its largest value is at a corner. All triangles that may be nearest to a point of
      the cell are asked for `s`, of each the part within reach. Exact for a flat surface, of second order for a
      smooth one.
    """
    half = 0.5 * math.sqrt(3.0) * spacing
    least = np.inf
    for a in range(2):
        for b in range(2):
            for c in range(2):
                least = min(least, abs(f[a, b, c]))
    d = math.sqrt(nearest_squared(x, y, z, ((least + half) * (1.0 + 1e-9)) ** 2, tree))
    limit = half
    if d > half:
        limit = min(limit, 0.375 * spacing * spacing / (d - half))
    if d > _SEARCH * spacing:
        return limit

    nx, ny, nz = 0.0, 0.0, 0.0
    for a in range(2):
        for b in range(2):
            nx += f[1, a, b] - f[0, a, b]
            ny += f[a, 1, b] - f[a, 0, b]
            nz += f[a, b, 1] - f[a, b, 0]
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if not length > 0.0:
        return limit
    nx, ny, nz = nx / length, ny / length, nz / length
    over, under, highest, lowest = -np.inf, -np.inf, -np.inf, np.inf
    outside, inside, at_highest, at_lowest = False, False, 0.0, 0.0
    for a in range(2):
        for b in range(2):
            for c in range(2):
                value = f[a, b, c]
                along = ((a - 0.5) * nx + (b - 0.5) * ny + (c - 0.5) * nz) * spacing
                over, under = max(over, value - along), max(under, along - value)
                outside, inside = outside or value > 0.0, inside or value < 0.0
                if along > highest:
                    highest, at_highest = along, value
                if along < lowest:
                    lowest, at_lowest = along, value
    if not outside:
        over = -np.inf
    if not inside:
        under = -np.inf
    if signed and d <= half:
        # Seen along n, what lies above all that passes through the cell is one piece, and has the sign of the highest
        # corner; likewise below. Where that is the wrong one, a thin sheet or a gap hides in the cell.
        if (outside and at_highest < 0.0) or (inside and at_lowest > 0.0):
            return limit
    reach = d + 2.0 * half
    return min(
        limit,
        _support(x, y, z, nx, ny, nz, reach, half if signed else 0.0, over, under, limit, f, spacing, tree),
    )


@njit(**OPTIONS)
def _support(x, y, z, nx, ny, nz, reach, through, over, under, limit, f, spacing, tree):
    """The margin by planes: the least that is right for all triangles within `reach`, or some number above `limit`.

    For those that come nearer than `through` it must be by planes along n, which tell the sign too; for the others,
    the plane of the triangle itself will do.
    """
    triangles, boxes, _ = tree
    leaves = boxes.shape[0] // 2
    margin, slack = 1e-3 * spacing, 1e-9 * spacing
    stack = np.empty(64, np.int64)
    stack[0], top = 1, 1
    while top and margin < limit:
        top -= 1
        node = stack[top]
        if box_squared(x, y, z, boxes, node) > reach * reach:
            continue
        middle, extent = 0.0, 0.0
        for axis in range(3):
            n, p = (nx, x) if axis == 0 else ((ny, y) if axis == 1 else (nz, z))
            middle += n * (0.5 * (boxes[node, axis] + boxes[node, axis + 3]) - p)
            extent += abs(n) * 0.5 * (boxes[node, axis + 3] - boxes[node, axis])
        if max(over + min(middle + extent, reach), under - max(middle - extent, -reach)) < margin - slack:
            continue
        if node < leaves:
            stack[top], stack[top + 1] = 2 * node, 2 * node + 1
            top += 2
            continue
        first, last = leaf(node, leaves, triangles.shape[0])
        for k in range(first, last):
            squared = triangle_squared(x, y, z, triangles, k)
            if squared <= reach * reach * (1.0 + 1e-9):
                needed = _above(x, y, z, nx, ny, nz, reach, over, under, f, spacing, triangles, k)
                if squared <= through * through * (1.0 + 1e-9):
                    low, high, _, _, _, _ = _extent(x, y, z, nx, ny, nz, through, triangles, k)
                    needed = max(needed, over + high, under - low)
                margin = max(margin, needed)
    return margin


@njit(**OPTIONS)
def _above(x, y, z, nx, ny, nz, reach, over, under, f, spacing, triangles, k):
    """How far the trilinear value may exceed the distance to triangle `k`, on either side of the surface.

    On each the best of three planes is taken: one along n, and the triangle's own seen from above and from below.
    """
    low, high, height, mx, my, mz = _extent(x, y, z, nx, ny, nz, reach, triangles, k)
    over, under = over + high, under - low
    if mx == 0.0 and my == 0.0 and mz == 0.0:
        return max(over, under)
    # Most and least of the value less the height over the plane, and less the height below it.
    most_up, least_up, most_down, least_down = -np.inf, np.inf, -np.inf, np.inf
    for a in range(2):
        for b in range(2):
            for c in range(2):
                lift = ((a - 0.5) * mx + (b - 0.5) * my + (c - 0.5) * mz) * spacing - height
                value = f[a, b, c]
                most_up, least_up = max(most_up, value - lift), min(least_up, value - lift)
                most_down, least_down = max(most_down, value + lift), min(least_down, value + lift)
    return max(min(over, most_up, most_down), min(under, -least_up, -least_down))


@njit(**OPTIONS)
def _extent(x, y, z, nx, ny, nz, reach, triangles, k):
    """Least and most of `n . (q - p)` over a triangle, and over the disc that a ball around p cuts from its plane.

    Then `m . (q - p)` for its unit normal m, and m: zero for a triangle without a plane.
    """
    ax, ay, az = triangles[k, 0, 0] - x, triangles[k, 0, 1] - y, triangles[k, 0, 2] - z
    bx, by, bz = triangles[k, 1, 0] - x, triangles[k, 1, 1] - y, triangles[k, 1, 2] - z
    cx, cy, cz = triangles[k, 2, 0] - x, triangles[k, 2, 1] - y, triangles[k, 2, 2] - z
    a, b, c = nx * ax + ny * ay + nz * az, nx * bx + ny * by + nz * bz, nx * cx + ny * cy + nz * cz
    low, high = min(a, b, c), max(a, b, c)
    bx, by, bz, cx, cy, cz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    mx, my, mz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    squared, longest = (
        mx * mx + my * my + mz * mz,
        max(bx * bx + by * by + bz * bz, cx * cx + cy * cy + cz * cz),
    )
    if not squared > 1e-16 * longest * longest:
        return low, high, 0.0, 0.0, 0.0, 0.0
    length = math.sqrt(squared)
    mx, my, mz = mx / length, my / length, mz / length
    height = mx * ax + my * ay + mz * az
    cosine = mx * nx + my * ny + mz * nz
    radius = math.sqrt(max(reach * reach - height * height, 0.0) * max(1.0 - cosine * cosine, 0.0))
    return max(low, height * cosine - radius), min(high, height * cosine + radius), height, mx, my, mz


def warm():
    """Compile everything."""
    tree = np.zeros((1, 3, 3)), np.zeros((2, 6)), np.zeros((2, 7))
    block = np.zeros((1, 3, 3, 3), np.float32)
    sample(np.zeros((1, 3), np.int32), np.zeros(3), 1.0, tree, True, block, block.copy())
