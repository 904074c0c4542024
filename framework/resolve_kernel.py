"""The compiled half of a G-buffer's channels: where a pixel's ray meets the triangle that it sees.

Pixels are taken in spans of a row: the corners of their triangles are gathered, number by number, into arrays along
the span; then all pixels of the span are solved at once, without a branch, in the processor's vectors.
"""

import numpy as np
from numba import njit, prange

from framework.raster_grid_kernels import one_triangle

SPAN = 64
# Where what is gathered of a pixel's triangle begins: corner, two edges, three normals, of three numbers each, and
# whether there is one ...
CORNER, EDGE_1, EDGE_2, NORMAL_0, NORMAL_1, NORMAL_2, SEEN = range(0, 19 * SPAN, 3 * SPAN)
# ... and what is solved for: depth, barycentric weights, position, normal.
DEPTH, WEIGHT, POSITION, ACROSS = 0, SPAN, 4 * SPAN, 7 * SPAN
OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": {"contract"}}


@njit(parallel=True, **OPTIONS)
def resolve(threads, triangle, mesh, normals, uvs, origin, rays, near, channels):
    """Fill the channels (H, W, ...) that are not empty; `rays` takes (column, row, 1) to a ray of depth 1."""
    height, width = triangle.shape
    for thread in prange(threads):
        gathered, solved, background = np.ones(19 * SPAN), np.empty(10 * SPAN), np.zeros(10 * SPAN)
        background[:SPAN] = np.inf
        for row in range(thread, height, threads):
            for first in range(0, width, SPAN):
                span = triangle[row, first : first + SPAN]
                if _gather(span, mesh, normals, origin, gathered):
                    _solve(first, row, origin, rays, near, normals.size > 0, gathered, solved)
                    _write(first, row, span, mesh, uvs, solved, channels)
                else:
                    _write(first, row, span, mesh, uvs, background, channels)


@njit(**OPTIONS)
def _gather(span, mesh, normals, origin, gathered):
    """What the span's triangles are made of, relative to the camera; whether there is any."""
    faces, vertices = mesh
    seen = False
    for i in range(len(span)):
        gathered[SEEN + i] = span[i] >= 0
        if span[i] < 0:
            continue
        seen, face = True, np.uint32(span[i])  # unsigned: Numba then leaves out what makes -1 the last row
        a, b, c = np.uint32(faces[face, 0]), np.uint32(faces[face, 1]), np.uint32(faces[face, 2])
        for k in range(3):
            corner = vertices[a, k]
            gathered[CORNER + k * SPAN + i] = corner - origin[k]
            gathered[EDGE_1 + k * SPAN + i] = vertices[b, k] - corner
            gathered[EDGE_2 + k * SPAN + i] = vertices[c, k] - corner
        if normals.size:
            for k in range(3):
                gathered[NORMAL_0 + k * SPAN + i] = normals[a, k]
                gathered[NORMAL_1 + k * SPAN + i] = normals[b, k]
                gathered[NORMAL_2 + k * SPAN + i] = normals[c, k]
    return seen


@njit(**OPTIONS)
def _solve(first, row, origin, rays, near, smooth, gathered, solved):
    """Depth, weights and normal of each pixel.

    The point is `corner + u e1 + v e2 = depth ray`, seen from the camera, solved by Cramer's rule.
    """
    rx, ry, rz = rays[0, 0], rays[1, 0], rays[2, 0]
    y = row + 0.5
    bx = rays[0, 1] * y + rays[0, 2]
    by = rays[1, 1] * y + rays[1, 2]
    bz = rays[2, 1] * y + rays[2, 2]
    for i in range(SPAN):
        x = first + i + 0.5
        dx, dy, dz = rx * x + bx, ry * x + by, rz * x + bz
        cx, cy, cz = gathered[i], gathered[SPAN + i], gathered[2 * SPAN + i]
        e1x, e1y, e1z = gathered[EDGE_1 + i], gathered[EDGE_1 + SPAN + i], gathered[EDGE_1 + 2 * SPAN + i]
        e2x, e2y, e2z = gathered[EDGE_2 + i], gathered[EDGE_2 + SPAN + i], gathered[EDGE_2 + 2 * SPAN + i]
        nx, ny, nz = e1y * e2z - e1z * e2y, e1z * e2x - e1x * e2z, e1x * e2y - e1y * e2x
        qx, qy, qz = cy * dz - cz * dy, cz * dx - cx * dz, cx * dy - cy * dx
        inverse = 1.0 / (dx * nx + dy * ny + dz * nz)
        t = (cx * nx + cy * ny + cz * nz) * inverse
        u = (qx * e2x + qy * e2y + qz * e2z) * inverse
        v = -(qx * e1x + qy * e1y + qz * e1z) * inverse
        w = 1.0 - u - v
        # Where the rounded grid put the pixel just outside the triangle, the weights of the nearest point inside.
        inside = u >= 0.0 and v >= 0.0 and w >= 0.0
        u, v, w = max(u, 0.0), max(v, 0.0), max(w, 0.0)
        total = u + v + w
        edge_on = not 0.0 < total < np.inf
        scale = 1.0 / total
        u = 1.0 / 3.0 if edge_on else u * scale
        v = 1.0 / 3.0 if edge_on else v * scale
        w = 1.0 / 3.0 if edge_on else w * scale
        # The point of the ray that is nearest to there.
        px, py, pz = cx + u * e1x + v * e2x, cy + u * e1y + v * e2y, cz + u * e1z + v * e2z
        beside = max((px * dx + py * dy + pz * dz) / (dx * dx + dy * dy + dz * dz), near)
        t = t if inside else beside
        seen = gathered[SEEN + i] > 0.0
        solved[DEPTH + i] = t if seen else np.inf
        solved[WEIGHT + i] = w if seen else 0.0
        solved[WEIGHT + SPAN + i] = u if seen else 0.0
        solved[WEIGHT + 2 * SPAN + i] = v if seen else 0.0
        solved[POSITION + i] = origin[0] + t * dx if seen else 0.0
        solved[POSITION + SPAN + i] = origin[1] + t * dy if seen else 0.0
        solved[POSITION + 2 * SPAN + i] = origin[2] + t * dz if seen else 0.0
        if smooth:
            gx = w * gathered[NORMAL_0 + i] + u * gathered[NORMAL_1 + i] + v * gathered[NORMAL_2 + i]
            gy = (w * gathered[NORMAL_0 + SPAN + i] + u * gathered[NORMAL_1 + SPAN + i]
                  + v * gathered[NORMAL_2 + SPAN + i])  # fmt: skip
            gz = (w * gathered[NORMAL_0 + 2 * SPAN + i] + u * gathered[NORMAL_1 + 2 * SPAN + i]
                  + v * gathered[NORMAL_2 + 2 * SPAN + i])  # fmt: skip
            flat = gx == 0.0 and gy == 0.0 and gz == 0.0
            nx, ny, nz = nx if flat else gx, ny if flat else gy, nz if flat else gz
        none = nx == 0.0 and ny == 0.0 and nz == 0.0  # no area either: it looks at the camera
        nx, ny, nz = -dx if none else nx, -dy if none else ny, -dz if none else nz
        scale = 1.0 / np.sqrt(nx * nx + ny * ny + nz * nz)
        solved[ACROSS + i] = nx * scale if seen else 0.0
        solved[ACROSS + SPAN + i] = ny * scale if seen else 0.0
        solved[ACROSS + 2 * SPAN + i] = nz * scale if seen else 0.0


@njit(**OPTIONS)
def _write(first, row, span, mesh, uvs, solved, channels):
    """The span's share of each channel that is wanted."""
    depth, barycentric, position, normal, uv = channels
    if depth.size:
        for i in range(len(span)):
            depth[row, first + i] = solved[DEPTH + i]
    for channel, begin in ((barycentric, WEIGHT), (position, POSITION), (normal, ACROSS)):
        if channel.size:
            for i in range(len(span)):
                channel[row, first + i, 0] = solved[begin + i]
                channel[row, first + i, 1] = solved[begin + SPAN + i]
                channel[row, first + i, 2] = solved[begin + 2 * SPAN + i]
    if uv.size:
        for i in range(len(span)):
            for k in range(2):
                uv[row, first + i, k] = 0.0
                if span[i] >= 0:
                    for corner in range(3):
                        weight = solved[WEIGHT + corner * SPAN + i]
                        uv[row, first + i, k] += weight * uvs[mesh[0][span[i], corner], k]


def warm():
    """Compile the kernel for the types that `raster` calls it with."""
    faces, vertices, _, origin = one_triangle()
    channels = tuple(np.empty((0, 0, *size)) for size in ((), (3,), (3,), (3,), (2,)))
    resolve(1, np.full((1, 1), -1, np.int32), (faces, vertices), vertices, vertices, origin, np.eye(3), 0.01, channels)
