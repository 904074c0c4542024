"""Where triangles lie on the image, compiled, to the last bit: the rasteriser's grid and its edge functions.

Positions are whole numbers of 1/4096 pixel, counted from the centre of the middle pixel, and below 2**25 in
size: an edge function of such numbers is exact in int64 and in float64, so that two triangles never both
claim or both miss a pixel on the edge that they share. A vertex before the near plane, or further out than
that, is off this grid; edges that end in it are evaluated in homogeneous coordinates (Olano and Greer,
Triangle Scan Conversion Using 2D Homogeneous Coordinates, 1997), to the same bits whichever triangle asks.
"""

import numpy as np
from numba import njit, prange

BITS = 12
ONE = 1 << BITS
GUARD = 1 << 25
OFF = -(1 << 31)  # in place of a position, where there is none
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


@njit(**OPTIONS)
def corners(faces, face, xy):
    """Positions x0, y0, x1, y1, x2, y2 of a face's corners, and whether all are on the grid."""
    a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
    on = xy[a, 0] != OFF and xy[b, 0] != OFF and xy[c, 0] != OFF
    return (
        np.int64(xy[a, 0]), np.int64(xy[a, 1]), np.int64(xy[b, 0]), np.int64(xy[b, 1]),
        np.int64(xy[c, 0]), np.int64(xy[c, 1]), on,
    )  # fmt: skip


@njit(**OPTIONS)
def box(x0, y0, x1, y1, x2, y2):
    """First column and row, last column and row whose centres lie in the box about a triangle."""
    return (
        (min(x0, x1, x2) + (ONE - 1)) >> BITS,
        (min(y0, y1, y2) + (ONE - 1)) >> BITS,
        max(x0, x1, x2) >> BITS,
        max(y0, y1, y2) >> BITS,
    )


@njit(**OPTIONS)
def edge(xa, ya, xb, yb, x, y):
    """Edge function at (x, y) in units of ONE, rounded down, and its steps per pixel: it is >= 0 inside."""
    step_x, step_y = ya - yb, xb - xa
    value = step_x * (x - xa) + step_y * (y - ya)
    # Top-left rule: a centre on the edge belongs to the triangle to its right, or below.
    if not (step_x > 0 or (step_x == 0 and step_y > 0)):
        value -= 1
    return value >> BITS, step_x, step_y


@njit(**OPTIONS)
def off_box(faces, face, vertices, matrix, origin, near):
    """As `box`, of the part beyond the near plane, a pixel too wide; first > last where there is none."""
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
    if not (x_low <= x_high and y_low <= y_high):
        return 0, 0, -1, -1
    return _pixel(x_low) - 1, _pixel(y_low) - 1, _pixel(x_high) + 1, _pixel(y_high) + 1


@njit(**OPTIONS)
def _pixel(position):
    return np.int64(min(max(position / ONE, -16384.0), 16384.0))  # beyond every image


@njit(**OPTIONS)
def _off_corner(xy, vertices, v, matrix, origin):
    """Homogeneous position: with weight 1 where the vertex is on the grid."""
    if xy[v, 0] != OFF:
        return np.float64(xy[v, 0]), np.float64(xy[v, 1]), 1.0
    return _homogeneous(vertices, v, matrix, origin)


@njit(**OPTIONS)
def off_area(faces, face, xy, vertices, matrix, origin):
    """Twice the signed area on the image, times the weights: positive where the back is seen."""
    x0, y0, w0 = _off_corner(xy, vertices, faces[face, 0], matrix, origin)
    x1, y1, w1 = _off_corner(xy, vertices, faces[face, 1], matrix, origin)
    x2, y2, w2 = _off_corner(xy, vertices, faces[face, 2], matrix, origin)
    return x0 * (y1 * w2 - y2 * w1) + x1 * (y2 * w0 - y0 * w2) + x2 * (y0 * w1 - y1 * w0)


@njit(**OPTIONS)
def off_edge(xy, vertices, a, b, matrix, origin):
    """A line through two vertices, `nx (x - x0) + ny (y - y0) + c`; swapping them flips its sign, no more."""
    xa, ya, wa = _off_corner(xy, vertices, a, matrix, origin)
    xb, yb, wb = _off_corner(xy, vertices, b, matrix, origin)
    nx, ny = ya * wb - yb * wa, xb * wa - xa * wb
    # Anchored where an end is on the grid, so that all edges of that corner pass through it exactly.
    if xy[a, 0] != OFF:
        return nx, ny, xa, ya, 0.0
    if xy[b, 0] != OFF:
        return nx, ny, xb, yb, 0.0
    return nx, ny, 0.0, 0.0, xa * yb - ya * xb


@njit(**OPTIONS)
def off_inside(line, sign, x, y):
    """Whether (x, y) is on the inner side of an `off_edge`, or on it by the top-left rule."""
    nx, ny, x0, y0, c = line
    value = sign * (nx * (x - x0) + ny * (y - y0) + c)
    return value > 0 or (value == 0 and (sign * nx > 0 or (nx == 0 and sign * ny > 0)))


@njit(**OPTIONS)
def off_inverse_depth(faces, face, vertices, matrix, origin):
    """The plane (gx, gy, gw) whose product with (x, y, 1) is 1 / depth: it takes each corner (x, y, w) to 1."""
    x0, y0, w0 = _homogeneous(vertices, faces[face, 0], matrix, origin)
    x1, y1, w1 = _homogeneous(vertices, faces[face, 1], matrix, origin)
    x2, y2, w2 = _homogeneous(vertices, faces[face, 2], matrix, origin)
    x1, y1, w1, x2, y2, w2 = x1 - x0, y1 - y0, w1 - w0, x2 - x0, y2 - y0, w2 - w0
    gx, gy, gw = y1 * w2 - y2 * w1, w1 * x2 - w2 * x1, x1 * y2 - x2 * y1
    scale = 1.0 / (gx * x0 + gy * y0 + gw * w0)
    return gx * scale, gy * scale, gw * scale


def one_triangle():
    """Faces, vertices, matrix and camera as the kernels get them, for a mesh of one triangle that faces the camera."""
    faces = np.array([[0, 1, 2]], np.int32)
    vertices = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]])
    origin = np.zeros(3)
    for array in (faces, vertices, origin):  # as a mesh's and a camera's are
        array.flags.writeable = False
    return faces, vertices, np.diag([ONE, ONE, 1.0]), origin


def warm():
    """Compile the kernels for the types that `raster` calls them with."""
    _, vertices, matrix, origin = one_triangle()
    xy = np.empty((3, 4), np.int32)
    project(vertices, matrix, origin, 0.01, xy, xy.view(np.float32))
