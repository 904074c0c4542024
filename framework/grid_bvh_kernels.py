"""Nearest triangle and winding number, by a hierarchy of boxes. Importing this module loads Numba.

The hierarchy is a complete binary tree over triangles in Morton order: node `i` has the children `2 i` and
`2 i + 1`, the root is 1, and the last half of the nodes are leaves of nearly equal numbers of triangles.
`tree` is `(triangles (F, 3, 3), boxes (2 L, 6), dipoles (2 L, 7))`, all float64, as `framework.grid` makes it:
a box is low and high corner; a dipole is a middle, the summed area vectors around it, and a radius.
"""

import math

import numpy as np
from numba import njit

OPTIONS = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"nsz", "arcp", "contract", "afn", "reassoc"},
}
_FAR = 3.0  # a node is a dipole from this many radii on: the winding number is within 0.02 (measured)
_DEPTH = 64


@njit(**OPTIONS)
def nearest(x, y, z, guess, tree):
    """Squared distance to the nearest triangle, and which it is; the better the `guess`, the faster."""
    triangles, boxes, _ = tree
    leaves = boxes.shape[0] // 2
    stack, gaps = np.empty(_DEPTH, np.int64), np.empty(_DEPTH)
    best, found = triangle_squared(x, y, z, triangles, guess), guess
    stack[0], gaps[0], top = 1, box_squared(x, y, z, boxes, 1), 1
    while top:
        top -= 1
        node = stack[top]
        if gaps[top] >= best:
            continue
        if node >= leaves:
            first, last = leaf(node, leaves, triangles.shape[0])
            for k in range(first, last):
                squared = triangle_squared(x, y, z, triangles, k)
                if squared < best:
                    best, found = squared, k
            continue
        near, far = 2 * node, 2 * node + 1
        near_gap, far_gap = box_squared(x, y, z, boxes, near), box_squared(x, y, z, boxes, far)
        if far_gap < near_gap:
            near, far, near_gap, far_gap = far, near, far_gap, near_gap
        if far_gap < best:
            stack[top], gaps[top] = far, far_gap
            top += 1
        if near_gap < best:
            stack[top], gaps[top] = near, near_gap
            top += 1
    return best, found


@njit(**OPTIONS)
def leaf(node, leaves, count):
    """First and last + 1 of the triangles of a leaf."""
    return (node - leaves) * count // leaves, (node - leaves + 1) * count // leaves


@njit(**OPTIONS)
def box_squared(x, y, z, boxes, node):
    """Squared distance to a box, a little less than exact, so that rounding never hides a triangle."""
    dx = max(boxes[node, 0] - x, x - boxes[node, 3], 0.0)
    dy = max(boxes[node, 1] - y, y - boxes[node, 4], 0.0)
    dz = max(boxes[node, 2] - z, z - boxes[node, 5], 0.0)
    return (dx * dx + dy * dy + dz * dz) * (1.0 - 1e-12)


@njit(**OPTIONS)
def triangle_squared(x, y, z, triangles, k):
    """Squared distance to triangle `k`: to its plane where the foot lies inside, else to its sides.

    Of triangles thinner than 1e-10 of their length only the sides count: their plane is lost in rounding.
    """
    px, py, pz = x - triangles[k, 0, 0], y - triangles[k, 0, 1], z - triangles[k, 0, 2]
    ux = triangles[k, 1, 0] - triangles[k, 0, 0]
    uy = triangles[k, 1, 1] - triangles[k, 0, 1]
    uz = triangles[k, 1, 2] - triangles[k, 0, 2]
    vx = triangles[k, 2, 0] - triangles[k, 0, 0]
    vy = triangles[k, 2, 1] - triangles[k, 0, 1]
    vz = triangles[k, 2, 2] - triangles[k, 0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    uu, vv, nn = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, nx * nx + ny * ny + nz * nz
    if nn > 1e-20 * max(uu, vv) ** 2:
        a = (uy * pz - uz * py) * nx + (uz * px - ux * pz) * ny + (ux * py - uy * px) * nz
        b = (py * vz - pz * vy) * nx + (pz * vx - px * vz) * ny + (px * vy - py * vx) * nz
        if a >= 0.0 and b >= 0.0 and a + b <= nn:
            height = px * nx + py * ny + pz * nz
            return height * height / nn
    best = min(_side_squared(px, py, pz, ux, uy, uz, uu), _side_squared(px, py, pz, vx, vy, vz, vv))
    wx, wy, wz = vx - ux, vy - uy, vz - uz
    ww = wx * wx + wy * wy + wz * wz
    return min(best, _side_squared(px - ux, py - uy, pz - uz, wx, wy, wz, ww))


@njit(**OPTIONS)
def _side_squared(px, py, pz, ux, uy, uz, uu):
    """From p to the segment from 0 to u."""
    t = min(max((px * ux + py * uy + pz * uz) / uu, 0.0), 1.0) if uu > 0.0 else 0.0
    px, py, pz = px - t * ux, py - t * uy, pz - t * uz
    return px * px + py * py + pz * pz


@njit(**OPTIONS)
def winding_number(x, y, z, tree):
    """How many times the triangles wind around a point: 1 inside a closed mesh, 0 outside.

    Far parts count as dipoles: Barill et al., Fast winding numbers for soups and clouds, 2018.
    """
    triangles, boxes, dipoles = tree
    leaves = boxes.shape[0] // 2
    stack = np.empty(_DEPTH, np.int64)
    stack[0], top, angle = 1, 1, 0.0
    while top:
        top -= 1
        node = stack[top]
        dx, dy, dz = dipoles[node, 0] - x, dipoles[node, 1] - y, dipoles[node, 2] - z
        squared = dx * dx + dy * dy + dz * dz
        if squared > (_FAR * dipoles[node, 6]) ** 2:
            flux = dx * dipoles[node, 3] + dy * dipoles[node, 4] + dz * dipoles[node, 5]
            angle += flux / (squared * math.sqrt(squared))
        elif node >= leaves:
            first, last = leaf(node, leaves, triangles.shape[0])
            for k in range(first, last):
                angle += _solid_angle(x, y, z, triangles, k)
        else:
            stack[top], stack[top + 1] = 2 * node, 2 * node + 1
            top += 2
    return angle / (4.0 * math.pi)


@njit(**OPTIONS)
def _solid_angle(x, y, z, triangles, k):
    """Signed, positive where the triangle shows its back. Van Oosterom and Strackee, 1983."""
    ax, ay, az = triangles[k, 0, 0] - x, triangles[k, 0, 1] - y, triangles[k, 0, 2] - z
    bx, by, bz = triangles[k, 1, 0] - x, triangles[k, 1, 1] - y, triangles[k, 1, 2] - z
    cx, cy, cz = triangles[k, 2, 0] - x, triangles[k, 2, 1] - y, triangles[k, 2, 2] - z
    a, b, c = (
        math.sqrt(ax * ax + ay * ay + az * az),
        math.sqrt(bx * bx + by * by + bz * bz),
        math.sqrt(cx * cx + cy * cy + cz * cz),
    )
    volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    ab, bc, ca = ax * bx + ay * by + az * bz, bx * cx + by * cy + bz * cz, cx * ax + cy * ay + cz * az
    return 2.0 * math.atan2(volume, a * b * c + ab * c + bc * a + ca * b)


def warm():
    """Compile everything."""
    tree = np.zeros((1, 3, 3)), np.zeros((2, 6)), np.zeros((2, 7))
    nearest(0.0, 0.0, 0.0, 0, tree)
    winding_number(0.0, 0.0, 0.0, tree)
