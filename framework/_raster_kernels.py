"""The rasteriser's compiled half: projection, binning, and the visibility of one tile after another.

Positions on the image are whole numbers of 1/4096 pixel, counted from the centre of the middle pixel, and below
2**25 in size: an edge function of such numbers is exact in int64 and in float64, so that two triangles never
both claim or both miss a pixel on the edge that they share. A vertex before the near plane, or further out
than that, is off this grid; edges that end in it are evaluated in homogeneous coordinates (Olano and Greer,
Triangle Scan Conversion Using 2D Homogeneous Coordinates, 1997), to the same bits whichever triangle asks.
"""

import numpy as np
from numba import njit, prange

BITS = 12
ONE = 1 << BITS
GUARD = 1 << 25
OFF = -(1 << 31)  # in place of a position, where there is none
TILE = 64
BLOCK = 8
BLOCKS = TILE // BLOCK
REJECTED = 0xFFFFFFFF
LOW_HALF = 0xFFFFFFFF
OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(parallel=True, **OPTIONS)
def project(vertices, matrix, origin, near, xy, inverse_depth):
    """Fill `xy` (V, 4) int32 with positions, and column 2 of `inverse_depth`, its float32 view."""
    for v in prange(vertices.shape[0]):
        x, y, w = _homogeneous(vertices, v, matrix, origin)
        inverse = 1.0 / w
        x, y = np.floor(x * inverse + 0.5), np.floor(y * inverse + 0.5)
        # A comparison with NaN is false: what overflowed is off the grid too.
        if w >= near and abs(x) < GUARD and abs(y) < GUARD:
            xy[v, 0], xy[v, 1] = np.int32(x), np.int32(y)
            inverse_depth[v, 2] = np.float32(inverse)
        else:
            xy[v, 0] = OFF


@njit(**OPTIONS)
def _homogeneous(vertices, v, matrix, origin):
    """Position times depth in 1/4096 pixel, and depth."""
    x, y, z = vertices[v, 0] - origin[0], vertices[v, 1] - origin[1], vertices[v, 2] - origin[2]
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z,
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z,
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z,
    )


@njit(parallel=True, **OPTIONS)
def classify(faces, xy, vertices, matrix, origin, near, width, height, front, back, codes, counts):
    """Tiles that each face's box touches, packed in `codes` (F,), and how many faces each bin gets.

    `counts` is (chunks, bins): faces that look at the camera go to the even bin of a tile, others to the odd one.
    Faces that cover no pixel centre, or a side that is not to be drawn, are rejected here.
    """
    chunks, total = counts.shape[0], faces.shape[0]
    left, top, tiles_x = -(width // 2), -(height // 2), -(-width // TILE)
    for chunk in prange(chunks):
        for face in range(chunk * total // chunks, (chunk + 1) * total // chunks):
            codes[face] = REJECTED
            x0, y0, x1, y1, x2, y2, on = _corners(faces, face, xy)
            if on:
                px0, py0, px1, py1 = _box(x0, y0, x1, y1, x2, y2)
                area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
            else:
                px0, py0, px1, py1 = _off_box(faces, face, vertices, matrix, origin, near)
                area = _off_area(faces, face, xy, vertices, matrix, origin)
            px0, py0 = max(px0, left) - left, max(py0, top) - top
            px1, py1 = min(px1, left + width - 1) - left, min(py1, top + height - 1) - top
            # Rows run downwards: what winds counter-clockwise in the world has a negative area here.
            if px0 > px1 or py0 > py1 or not (area < 0 and front or area > 0 and back):
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
def _corners(faces, face, xy):
    a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
    on = xy[a, 0] != OFF and xy[b, 0] != OFF and xy[c, 0] != OFF
    return (
        np.int64(xy[a, 0]), np.int64(xy[a, 1]), np.int64(xy[b, 0]), np.int64(xy[b, 1]),
        np.int64(xy[c, 0]), np.int64(xy[c, 1]), on,
    )  # fmt: skip


@njit(**OPTIONS)
def _box(x0, y0, x1, y1, x2, y2):
    """First and last column and row whose centres lie in the box about a triangle."""
    return (
        (min(x0, x1, x2) + (ONE - 1)) >> BITS,
        (min(y0, y1, y2) + (ONE - 1)) >> BITS,
        max(x0, x1, x2) >> BITS,
        max(y0, y1, y2) >> BITS,
    )


@njit(**OPTIONS)
def _covers(x0, y0, x1, y1, x2, y2, area, x, y):
    if area < 0:
        x1, y1, x2, y2 = x2, y2, x1, y1
    e0, _, _ = _edge(x1, y1, x2, y2, x, y)
    e1, _, _ = _edge(x2, y2, x0, y0, x, y)
    e2, _, _ = _edge(x0, y0, x1, y1, x, y)
    return (e0 | e1 | e2) >= 0


@njit(**OPTIONS)
def _edge(xa, ya, xb, yb, x, y):
    """Edge function at (x, y) in units of ONE, rounded down, and its steps per pixel: it is >= 0 inside."""
    step_x, step_y = ya - yb, xb - xa
    value = step_x * (x - xa) + step_y * (y - ya)
    # Top-left rule: a centre on the edge belongs to the triangle to its right, or below.
    if not (step_x > 0 or (step_x == 0 and step_y > 0)):
        value -= 1
    return value >> BITS, step_x, step_y


@njit(parallel=True, **OPTIONS)
def fill_bins(codes, tiles_x, cursors, bins):
    """Write each face into the bins that `codes` names; `cursors` (chunks, bins) say where, and are used up."""
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
        keys = np.zeros((TILE, TILE), np.int64)
        farthest = np.zeros((BLOCKS, BLOCKS), np.int64)
        left, top = tile % tiles_x * TILE - width // 2, tile // tiles_x * TILE - height // 2
        seen = 0
        for i in range(starts[2 * tile], starts[2 * tile + 2]):
            # Front faces come first: when they are through, most of the others are hidden.
            if i == starts[2 * tile + 1] or seen == 1024:
                seen = 0
                for y in range(TILE):
                    for x in range(TILE):
                        if x % BLOCK == 0 and y % BLOCK == 0:
                            farthest[y // BLOCK, x // BLOCK] = keys[y, x]
                        else:
                            farthest[y // BLOCK, x // BLOCK] = min(
                                farthest[y // BLOCK, x // BLOCK], keys[y, x]
                            )
            seen += 1
            face = bins[i]
            x0, y0, x1, y1, x2, y2, on = _corners(faces, face, xy)
            if on:
                _draw(keys, farthest, faces, face, x0, y0, x1, y1, x2, y2, inverse_depth, left, top)
            else:
                _draw_off(keys, faces, face, xy, vertices, matrix, origin, near, left, top)
        left, top = left + width // 2, top + height // 2
        for y in range(min(TILE, height - top)):
            for x in range(min(TILE, width - left)):
                key = keys[y, x]
                triangle[top + y, left + x] = LOW_HALF - (key & LOW_HALF) if key else -1


@njit(**OPTIONS)
def _draw(keys, farthest, faces, face, x0, y0, x1, y1, x2, y2, inverse_depth, left, top):
    q0, q1, q2 = (
        inverse_depth[faces[face, 0], 2],
        inverse_depth[faces[face, 1], 2],
        inverse_depth[faces[face, 2], 2],
    )
    low, high = min(q0, q1, q2), max(q0, q1, q2)
    px0, py0, px1, py1 = _box(x0, y0, x1, y1, x2, y2)
    px0, py0, px1, py1 = max(px0, left), max(py0, top), min(px1, left + TILE - 1), min(py1, top + TILE - 1)
    best = np.int64(np.float32(high).view(np.int32)) << 32 | LOW_HALF
    hidden = True
    for by in range((py0 - top) // BLOCK, (py1 - top) // BLOCK + 1):
        for bx in range((px0 - left) // BLOCK, (px1 - left) // BLOCK + 1):
            hidden = hidden and best < farthest[by, bx]
    if hidden:
        return
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if area < 0:
        x1, x2, y1, y2, q1, q2, area = x2, x1, y2, y1, q2, q1, -area
    x, y = px0 << BITS, py0 << BITS
    e0, a0, b0 = _edge(x1, y1, x2, y2, x, y)
    e1, a1, b1 = _edge(x2, y2, x0, y0, x, y)
    e2, a2, b2 = _edge(x0, y0, x1, y1, x, y)
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
def _off_box(faces, face, vertices, matrix, origin, near):
    """Columns and rows of a box around what lies beyond the near plane, a pixel too wide; empty if it is behind."""
    x_low, x_high, y_low, y_high = np.inf, -np.inf, np.inf, -np.inf
    for k in range(3):
        xa, ya, wa = _homogeneous(vertices, faces[face, k], matrix, origin)
        xb, yb, wb = _homogeneous(vertices, faces[face, (k + 1) % 3], matrix, origin)
        if (wa < near) != (wb < near):  # the edge crosses the plane: take the crossing
            t = (near - wa) / (wb - wa)
            x, y = (xa + t * (xb - xa)) / near, (ya + t * (yb - ya)) / near
            x_low, x_high, y_low, y_high = min(x_low, x), max(x_high, x), min(y_low, y), max(y_high, y)
        if wa >= near:
            x, y = xa / wa, ya / wa
            x_low, x_high, y_low, y_high = min(x_low, x), max(x_high, x), min(y_low, y), max(y_high, y)
    limit = 16384.0  # beyond every image
    if not (x_low <= x_high and y_low <= y_high):
        return 0, 0, -1, -1
    return (
        np.int64(min(max(x_low / ONE, -limit), limit)) - 1,
        np.int64(min(max(y_low / ONE, -limit), limit)) - 1,
        np.int64(min(max(x_high / ONE, -limit), limit)) + 1,
        np.int64(min(max(y_high / ONE, -limit), limit)) + 1,
    )


@njit(**OPTIONS)
def _off_corner(xy, vertices, v, matrix, origin):
    """Homogeneous position: with weight 1 where the vertex is on the grid."""
    if xy[v, 0] != OFF:
        return np.float64(xy[v, 0]), np.float64(xy[v, 1]), 1.0
    return _homogeneous(vertices, v, matrix, origin)


@njit(**OPTIONS)
def _off_area(faces, face, xy, vertices, matrix, origin):
    """Twice the signed area as the eye sees it, times the weights."""
    x0, y0, w0 = _off_corner(xy, vertices, faces[face, 0], matrix, origin)
    x1, y1, w1 = _off_corner(xy, vertices, faces[face, 1], matrix, origin)
    x2, y2, w2 = _off_corner(xy, vertices, faces[face, 2], matrix, origin)
    return x0 * (y1 * w2 - y2 * w1) + x1 * (y2 * w0 - y0 * w2) + x2 * (y0 * w1 - y1 * w0)


@njit(**OPTIONS)
def _off_edge(xy, vertices, a, b, matrix, origin):
    """Line `nx (x - x0) + ny (y - y0) + c` through two corners; swapping them changes its sign and nothing else."""
    xa, ya, wa = _off_corner(xy, vertices, a, matrix, origin)
    xb, yb, wb = _off_corner(xy, vertices, b, matrix, origin)
    nx, ny = ya * wb - yb * wa, xb * wa - xa * wb
    if xy[a, 0] != OFF:
        return nx, ny, xa, ya, 0.0
    if xy[b, 0] != OFF:
        return nx, ny, xb, yb, 0.0
    return nx, ny, 0.0, 0.0, xa * yb - ya * xb


@njit(**OPTIONS)
def _off_inside(edge, sign, x, y):
    nx, ny, x0, y0, c = edge
    value = sign * (nx * (x - x0) + ny * (y - y0) + c)
    return value > 0 or (value == 0 and (sign * nx > 0 or (nx == 0 and sign * ny > 0)))


@njit(**OPTIONS)
def _draw_off(keys, faces, face, xy, vertices, matrix, origin, near, left, top):
    """As `_draw`, for a face with a corner off the grid: float64 throughout, the near plane tested per pixel."""
    a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
    edge0 = _off_edge(xy, vertices, b, c, matrix, origin)
    edge1 = _off_edge(xy, vertices, c, a, matrix, origin)
    edge2 = _off_edge(xy, vertices, a, b, matrix, origin)
    sign = 1.0 if _off_area(faces, face, xy, vertices, matrix, origin) > 0 else -1.0
    # 1 / depth is linear on the image: the plane (gx, gy, gw) takes each corner (x, y, w) to 1.
    x0, y0, w0 = _homogeneous(vertices, a, matrix, origin)
    x1, y1, w1 = _homogeneous(vertices, b, matrix, origin)
    x2, y2, w2 = _homogeneous(vertices, c, matrix, origin)
    x1, y1, w1, x2, y2, w2 = x1 - x0, y1 - y0, w1 - w0, x2 - x0, y2 - y0, w2 - w0
    gx, gy, gw = y1 * w2 - y2 * w1, w1 * x2 - w2 * x1, x1 * y2 - x2 * y1
    scale = 1.0 / (gx * x0 + gy * y0 + gw * w0)
    name = LOW_HALF - np.int64(face)
    px0, py0, px1, py1 = _off_box(faces, face, vertices, matrix, origin, near)
    for row in range(max(py0, top), min(py1, top + TILE - 1) + 1):
        for column in range(max(px0, left), min(px1, left + TILE - 1) + 1):
            x, y = np.float64(column << BITS), np.float64(row << BITS)
            if (
                _off_inside(edge0, sign, x, y)
                and _off_inside(edge1, sign, x, y)
                and _off_inside(edge2, sign, x, y)
            ):
                q = (gx * x + gy * y + gw) * scale
                if 0 < q <= 1.0 / near:
                    key = np.int64(np.float32(q).view(np.int32)) << 32 | name
                    keys[row - top, column - left] = max(keys[row - top, column - left], key)
