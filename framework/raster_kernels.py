"""The rasteriser's compiled half: which tiles a triangle touches, and what is visible in each tile."""

import numpy as np
from numba import njit, prange

from framework.raster_grid_kernels import (
    BITS,
    OFF,
    ONE,
    OPTIONS,
    box,
    corners,
    edge,
    off_area,
    off_box,
    off_edge,
    off_inside,
    off_inverse_depth,
    one_triangle,
)

TILE = 64
BLOCK = 8
BLOCKS = TILE // BLOCK
REJECTED = 0xFFFFFFFF
LOW_HALF = 0xFFFFFFFF


@njit(parallel=True, **OPTIONS)
def classify(faces, xy, vertices, matrix, origin, near, width, height, front, back, codes, counts):
    """Tiles that each face's box touches, packed in `codes` (F,), and how many faces each bin gets.

    `counts` is (chunks, bins). Each tile has two bins, the first for faces that look at the camera. Faces that
    cover no pixel centre, or show a side that is not to be drawn, are rejected here.
    """
    chunks, total = counts.shape[0], faces.shape[0]
    left, top, tiles_x = -(width // 2), -(height // 2), -(-width // TILE)
    for chunk in prange(chunks):
        for face in range(chunk * total // chunks, (chunk + 1) * total // chunks):
            codes[face] = REJECTED
            x0, y0, x1, y1, x2, y2, on = corners(faces, face, xy)
            if on:
                px0, py0, px1, py1 = box(x0, y0, x1, y1, x2, y2)
                area = np.float64((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0))
            else:
                px0, py0, px1, py1 = off_box(faces, face, vertices, matrix, origin, near)
                area = off_area(faces, face, xy, vertices, matrix, origin)
            px0, py0 = max(px0, left) - left, max(py0, top) - top
            px1, py1 = min(px1, left + width - 1) - left, min(py1, top + height - 1) - top
            # Rows run downwards: what winds counter-clockwise in the world has a negative area here.
            if px0 > px1 or py0 > py1 or not ((area < 0 and front) or (area > 0 and back)):
                continue
            if on and px0 == px1 and py0 == py1:
                if not _covers(x0, y0, x1, y1, x2, y2, area, (px0 + left) << BITS, (py0 + top) << BITS):
                    continue
            side = 1 if area > 0 else 0
            tx0, ty0, tx1, ty1 = px0 // TILE, py0 // TILE, px1 // TILE, py1 // TILE
            codes[face] = tx0 | ty0 << 7 | tx1 << 14 | ty1 << 21 | side << 28
            for ty in range(ty0, ty1 + 1):
                for tx in range(tx0, tx1 + 1):
                    counts[chunk, 2 * (ty * tiles_x + tx) + side] += 1


@njit(**OPTIONS)
def _covers(x0, y0, x1, y1, x2, y2, area, x, y):
    if area < 0:
        x1, y1, x2, y2 = x2, y2, x1, y1
    e0, _, _ = edge(x1, y1, x2, y2, x, y)
    e1, _, _ = edge(x2, y2, x0, y0, x, y)
    e2, _, _ = edge(x0, y0, x1, y1, x, y)
    return (e0 | e1 | e2) >= 0


@njit(parallel=True, **OPTIONS)
def fill_bins(codes, tiles_x, cursors, bins):
    """Write each face into the bins that `codes` names, where `cursors` (chunks, bins) says, which it moves."""
    chunks, total = cursors.shape[0], codes.shape[0]
    for chunk in prange(chunks):
        for face in range(chunk * total // chunks, (chunk + 1) * total // chunks):
            code = np.int64(codes[face])
            if code == REJECTED:
                continue
            for ty in range(code >> 7 & 127, (code >> 21 & 127) + 1):
                for tx in range(code & 127, (code >> 14 & 127) + 1):
                    slot = 2 * (ty * tiles_x + tx) + (code >> 28)
                    bins[cursors[chunk, slot]] = face
                    cursors[chunk, slot] += 1


@njit(parallel=True, **OPTIONS)
def draw_tiles(faces, xy, inverse_depth, vertices, matrix, origin, near, bins, starts, order, triangle):
    """The nearest face at each pixel, into `triangle` (H, W) int32.

    A key holds 1 / depth in its upper half, as the bits of a float, which sort like the numbers, and the
    inverted face in the lower half: the largest is the nearest, and among equals the first of `faces`.
    """
    height, width = triangle.shape
    tiles_x = -(-width // TILE)
    for k in prange(order.shape[0]):
        tile = order[k]
        first_x, first_y = tile % tiles_x * TILE, tile // tiles_x * TILE
        left, top = first_x - width // 2, first_y - height // 2
        keys = np.zeros((TILE, TILE), np.int64)
        farthest = np.zeros((BLOCKS, BLOCKS), np.int64)
        drawn = 0
        for i in range(starts[2 * tile], starts[2 * tile + 2]):
            # Faces that look at the camera come first: when they are through, most of the others are hidden.
            if i == starts[2 * tile + 1] or drawn == 1024:
                drawn = 0
                _find_farthest(keys, farthest)
            drawn += 1
            face = bins[i]
            x0, y0, x1, y1, x2, y2, on = corners(faces, face, xy)
            if on:
                _draw(keys, farthest, faces, face, x0, y0, x1, y1, x2, y2, inverse_depth, left, top)
            else:
                _draw_off(keys, faces, face, xy, vertices, matrix, origin, near, left, top)
        for y in range(min(TILE, height - first_y)):
            for x in range(min(TILE, width - first_x)):
                key = keys[y, x]
                triangle[first_y + y, first_x + x] = LOW_HALF - (key & LOW_HALF) if key else -1


@njit(forceinline=True, **OPTIONS)
def _find_farthest(keys, farthest):
    """The smallest key in each block of pixels: a face that is nowhere nearer than that is hidden there."""
    for by in range(BLOCKS):
        for bx in range(BLOCKS):
            least = keys[by * BLOCK, bx * BLOCK]
            for y in range(by * BLOCK, (by + 1) * BLOCK):
                for x in range(bx * BLOCK, (bx + 1) * BLOCK):
                    least = min(least, keys[y, x])
            farthest[by, bx] = least


@njit(forceinline=True, **OPTIONS)
def _draw(keys, farthest, faces, face, x0, y0, x1, y1, x2, y2, inverse_depth, left, top):
    q0, q1, q2 = (
        inverse_depth[faces[face, 0], 2],
        inverse_depth[faces[face, 1], 2],
        inverse_depth[faces[face, 2], 2],
    )
    low, high = min(q0, q1, q2), max(q0, q1, q2)
    px0, py0, px1, py1 = box(x0, y0, x1, y1, x2, y2)
    px0, py0, px1, py1 = max(px0, left), max(py0, top), min(px1, left + TILE - 1), min(py1, top + TILE - 1)
    nearest = np.int64(np.float32(high).view(np.int32)) << 32 | LOW_HALF
    hidden = True
    for by in range((py0 - top) // BLOCK, (py1 - top) // BLOCK + 1):
        for bx in range((px0 - left) // BLOCK, (px1 - left) // BLOCK + 1):
            hidden = hidden and nearest < farthest[by, bx]
    if hidden:
        return
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if area < 0:
        x1, x2, y1, y2, q1, q2, area = x2, x1, y2, y1, q2, q1, -area
    x, y = px0 << BITS, py0 << BITS
    e0, a0, b0 = edge(x1, y1, x2, y2, x, y)
    e1, a1, b1 = edge(x2, y2, x0, y0, x, y)
    e2, a2, b2 = edge(x0, y0, x1, y1, x, y)
    scale = ONE / np.float64(area)
    d1, d2 = np.float64(q1) - q0, np.float64(q2) - q0
    slope_x = (d1 * (y2 - y0) - d2 * (y1 - y0)) * scale
    slope_y = (d2 * (x1 - x0) - d1 * (x2 - x0)) * scale
    q = np.float32(q0 + (slope_x * (x - x0) + slope_y * (y - y0)) * (1.0 / ONE))
    step_x, step_y = np.float32(slope_x), np.float32(slope_y)
    name = LOW_HALF - np.int64(face)
    first, count = px0 - left, px1 - px0 + 1
    for row in range(py0 - top, py1 - top + 1):
        f0, f1, f2 = e0, e1, e2
        for k in range(count):
            if (f0 | f1 | f2) >= 0:
                # Rounding on a steep sliver must not take it out of its own range of depths.
                value = np.float32(min(max(q + np.float32(k) * step_x, low), high))
                key = np.int64(value.view(np.int32)) << 32 | name
                keys[row, first + k] = max(keys[row, first + k], key)
            f0 += a0
            f1 += a1
            f2 += a2
        e0 += b0
        e1 += b1
        e2 += b2
        q += step_y


@njit(**OPTIONS)
def _draw_off(keys, faces, face, xy, vertices, matrix, origin, near, left, top):
    """As `_draw`, for a face with a corner off the grid: in float64, the near plane tested at each pixel."""
    a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
    line0 = off_edge(xy, vertices, b, c, matrix, origin)
    line1 = off_edge(xy, vertices, c, a, matrix, origin)
    line2 = off_edge(xy, vertices, a, b, matrix, origin)
    sign = 1.0 if off_area(faces, face, xy, vertices, matrix, origin) > 0 else -1.0
    gx, gy, gw = off_inverse_depth(faces, face, vertices, matrix, origin)
    name = LOW_HALF - np.int64(face)
    px0, py0, px1, py1 = off_box(faces, face, vertices, matrix, origin, near)
    for row in range(max(py0, top), min(py1, top + TILE - 1) + 1):
        for column in range(max(px0, left), min(px1, left + TILE - 1) + 1):
            x, y = np.float64(column << BITS), np.float64(row << BITS)
            if not (off_inside(line0, sign, x, y) and off_inside(line1, sign, x, y)):
                continue
            q = gx * x + gy * y + gw
            if off_inside(line2, sign, x, y) and 0 < q <= 1.0 / near:
                key = np.int64(np.float32(q).view(np.int32)) << 32 | name
                keys[row - top, column - left] = max(keys[row - top, column - left], key)


def warm():
    """Compile the kernels for the types that `raster` calls them with."""
    faces, vertices, matrix, origin = one_triangle()
    view = (vertices, matrix, origin, 0.01)
    xy = np.full((3, 4), OFF, np.int32)
    codes, counts = np.empty(1, np.uint32), np.zeros((1, 2), np.int64)
    classify(faces, xy, *view, 4, 4, True, True, codes, counts)
    bins = np.empty(1, np.int32)
    fill_bins(codes, 1, np.zeros((1, 2), np.int64), bins)
    starts, order = np.array([0, 1, 1]), np.array([0])
    draw_tiles(faces, xy, xy.view(np.float32), *view, bins, starts, order, np.empty((4, 4), np.int32))
