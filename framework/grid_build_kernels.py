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
    nearest,
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
        closest = np.zeros((n, n, n), np.int64)
        for i in range(n):
            for j in range(n):
                for k in range(n):
                    x, y, z = x0 + i * spacing, y0 + j * spacing, z0 + k * spacing
                    guess = (
                        closest[i, j, k - 1] if k else (closest[i, j - 1, k] if j else closest[i - 1, j, k])
                    )
                    squared, closest[i, j, k] = nearest(x, y, z, guess, tree)
                    distance[i, j, k] = math.sqrt(squared)
        if signed:
            _set_signs(distance, x0, y0, z0, spacing, tree)
        for i in range(n - 1):
            for j in range(n - 1):
                for k in range(n - 1):
                    x, y, z = x0 + (i + 0.5) * spacing, y0 + (j + 0.5) * spacing, z0 + (k + 0.5) * spacing
                    cell = distance[i : i + 2, j : j + 2, k : k + 2]
                    needed = _cell_margin(cell, x, y, z, closest[i, j, k], spacing, tree, signed) + slack
                    for a in range(2):
                        for b in range(2):
                            for c in range(2):
                                margin[i + a, j + b, k + c] = max(margin[i + a, j + b, k + c], needed)
        f[block], e[block] = distance, margin


@njit(**OPTIONS)
def _set_signs(distance, x0, y0, z0, spacing, tree):
    """Make distances negative inside: neighbours that are too far from the surface for it to pass between are alike."""
    n = distance.shape[0]
    known = np.zeros((n, n, n), np.bool_)
    stack = np.empty((n * n * n, 3), np.int64)
    for start in range(n * n * n):
        i, j, k = start // (n * n), start // n % n, start % n
        if known[i, j, k]:
            continue
        inside = abs(winding_number(x0 + i * spacing, y0 + j * spacing, z0 + k * spacing, tree)) > 0.5
        known[i, j, k], stack[0, 0], stack[0, 1], stack[0, 2], top = True, i, j, k, 1
        while top:
            top -= 1
            i, j, k = stack[top, 0], stack[top, 1], stack[top, 2]
            for side in range(6):
                step = 1 if side & 1 else -1
                a, b, c = (
                    i + (step if side < 2 else 0),
                    j + (step if 2 <= side < 4 else 0),
                    k + (step if side > 3 else 0),
                )
                if 0 <= a < n and 0 <= b < n and 0 <= c < n and not known[a, b, c]:
                    if abs(distance[i, j, k]) + distance[a, b, c] > spacing * (1.0 + 1e-9):
                        known[a, b, c], stack[top, 0], stack[top, 1], stack[top, 2] = True, a, b, c
                        top += 1
            if inside:
                distance[i, j, k] = -distance[i, j, k]


@njit(**OPTIONS)
def _cell_margin(f, x, y, z, guess, spacing, tree, signed):
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
    most = 0.0
    for a in range(2):
        for b in range(2):
            for c in range(2):
                most = max(most, abs(f[a, b, c]))
    if most - half > _SEARCH * spacing:  # so is the distance from the middle
        return min(half, 0.375 * spacing * spacing / (most - 2.0 * half))
    squared, _ = nearest(x, y, z, guess, tree)
    d = math.sqrt(squared)
    limit = min(half, 0.375 * spacing * spacing / (d - half)) if d > half else half

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
            low, high = _along(x, y, z, nx, ny, nz, triangles, k)
            if max(over + high, under - low) <= margin:
                continue
            above, below = _by_own_plane(x, y, z, f, spacing, triangles, k)
            touches = _box_reaches(x, y, z, through, triangles, k)
            if not touches and max(min(over + high, above), min(under - low, below)) <= margin:
                continue
            squared = triangle_squared(x, y, z, triangles, k)
            if squared <= reach * reach * (1.0 + 1e-9):
                low, high = _clip(x, y, z, nx, ny, nz, reach, triangles, k, low, high)
                margin = max(margin, min(over + high, above), min(under - low, below))
                if squared <= through * through * (1.0 + 1e-9):
                    low, high = _clip(x, y, z, nx, ny, nz, through, triangles, k, low, high)
                    margin = max(margin, over + high, under - low)
    return margin


@njit(**OPTIONS)
def _along(x, y, z, nx, ny, nz, triangles, k):
    """Least and most of `n . (q - p)` over a triangle."""
    here = nx * x + ny * y + nz * z
    a = nx * triangles[k, 0, 0] + ny * triangles[k, 0, 1] + nz * triangles[k, 0, 2] - here
    b = nx * triangles[k, 1, 0] + ny * triangles[k, 1, 1] + nz * triangles[k, 1, 2] - here
    c = nx * triangles[k, 2, 0] + ny * triangles[k, 2, 1] + nz * triangles[k, 2, 2] - here
    return min(a, b, c), max(a, b, c)


@njit(**OPTIONS)
def _box_reaches(x, y, z, reach, triangles, k):
    """Whether the triangle's box comes within `reach` along each axis."""
    for axis in range(3):
        p = x if axis == 0 else (y if axis == 1 else z)
        a, b, c = triangles[k, 0, axis], triangles[k, 1, axis], triangles[k, 2, axis]
        if min(a, b, c) - p > reach or p - max(a, b, c) > reach:
            return False
    return True


@njit(**OPTIONS)
def _by_own_plane(x, y, z, f, spacing, triangles, k):
    """How far the trilinear value in the cell exceeds the distance to the triangle's plane, and the negative value."""
    mx, my, mz, height = _plane(x, y, z, triangles, k)
    if mx == 0.0 and my == 0.0 and mz == 0.0:
        return np.inf, np.inf
    most_up, least_up, most_down, least_down = -np.inf, np.inf, -np.inf, np.inf
    for a in range(2):
        for b in range(2):
            for c in range(2):
                lift = ((a - 0.5) * mx + (b - 0.5) * my + (c - 0.5) * mz) * spacing - height
                value = f[a, b, c]
                most_up, least_up = max(most_up, value - lift), min(least_up, value - lift)
                most_down, least_down = max(most_down, value + lift), min(least_down, value + lift)
    return min(most_up, most_down), min(-least_up, -least_down)


@njit(**OPTIONS)
def _clip(x, y, z, nx, ny, nz, reach, triangles, k, low, high):
    """`low` and `high` of `_along` for the disc that a ball around p cuts from the triangle's plane."""
    mx, my, mz, height = _plane(x, y, z, triangles, k)
    if mx == 0.0 and my == 0.0 and mz == 0.0:
        return low, high
    cosine = mx * nx + my * ny + mz * nz
    radius = math.sqrt(max(reach * reach - height * height, 0.0) * max(1.0 - cosine * cosine, 0.0))
    return max(low, height * cosine - radius), min(high, height * cosine + radius)


@njit(**OPTIONS)
def _plane(x, y, z, triangles, k):
    """Unit normal m of a triangle, and `m . (q - p)` of its points; zeros where it is too thin to have a plane."""
    ax, ay, az = triangles[k, 0, 0], triangles[k, 0, 1], triangles[k, 0, 2]
    bx, by, bz = triangles[k, 1, 0] - ax, triangles[k, 1, 1] - ay, triangles[k, 1, 2] - az
    cx, cy, cz = triangles[k, 2, 0] - ax, triangles[k, 2, 1] - ay, triangles[k, 2, 2] - az
    mx, my, mz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    squared, longest = (
        mx * mx + my * my + mz * mz,
        max(bx * bx + by * by + bz * bz, cx * cx + cy * cy + cz * cz),
    )
    if not squared > 1e-16 * longest * longest:
        return 0.0, 0.0, 0.0, 0.0
    scale = 1.0 / math.sqrt(squared)
    mx, my, mz = mx * scale, my * scale, mz * scale
    return mx, my, mz, mx * (ax - x) + my * (ay - y) + mz * (az - z)


def warm():
    """Compile everything."""
    tree = np.zeros((1, 3, 3)), np.zeros((2, 6)), np.zeros((2, 7))
    block = np.zeros((1, 3, 3, 3), np.float32)
    sample(np.zeros((1, 3), np.int32), np.zeros(3), 1.0, tree, True, block, block.copy())
