"""The compiled half of a G-buffer's channels: where a pixel's ray meets the triangle that it sees."""

import numpy as np
from numba import njit, prange

from framework.raster_grid_kernels import one_triangle


@njit(parallel=True, cache=True, nogil=True, error_model="numpy")
def resolve(threads, triangle, mesh, normals, uvs, origin, rays, near, channels):
    """Fill the channels (H, W, ...) that are not empty; `rays` takes (column, row, 1) to a ray of depth 1.

    The point is `v0 + u e1 + v e2 = origin + depth ray`, solved by Cramer's rule: each determinant is the
    product of the ray with a vector that depends on the face alone, and neighbours mostly see the same face.
    """
    faces, vertices = mesh
    depth, barycentric, position, normal, uv = channels
    height, width = triangle.shape
    for thread in prange(threads):
        for row in range(thread, height, threads):
            last = -1
            e1x = e1y = e1z = e2x = e2y = e2z = sx = sy = sz = 0.0
            nx = ny = nz = ux = uy = uz = vx = vy = vz = across = 0.0
            i0 = i1 = i2 = 0
            for column in range(width):
                face = triangle[row, column]
                if face < 0:
                    if depth.size:
                        depth[row, column] = np.inf
                    continue
                if face != last:
                    last = face
                    i0, i1, i2 = faces[face, 0], faces[face, 1], faces[face, 2]
                    ax, ay, az = vertices[i0, 0], vertices[i0, 1], vertices[i0, 2]
                    e1x, e1y, e1z = vertices[i1, 0] - ax, vertices[i1, 1] - ay, vertices[i1, 2] - az
                    e2x, e2y, e2z = vertices[i2, 0] - ax, vertices[i2, 1] - ay, vertices[i2, 2] - az
                    sx, sy, sz = origin[0] - ax, origin[1] - ay, origin[2] - az
                    nx, ny, nz = e1y * e2z - e1z * e2y, e1z * e2x - e1x * e2z, e1x * e2y - e1y * e2x
                    ux, uy, uz = sy * e2z - sz * e2y, sz * e2x - sx * e2z, sx * e2y - sy * e2x
                    vx, vy, vz = e1y * sz - e1z * sy, e1z * sx - e1x * sz, e1x * sy - e1y * sx
                    across = -(sx * nx + sy * ny + sz * nz)
                x, y = column + 0.5, row + 0.5
                dx = rays[0, 0] * x + rays[0, 1] * y + rays[0, 2]
                dy = rays[1, 0] * x + rays[1, 1] * y + rays[1, 2]
                dz = rays[2, 0] * x + rays[2, 1] * y + rays[2, 2]
                inverse = 1.0 / (dx * nx + dy * ny + dz * nz)
                t = across * inverse
                u = (dx * ux + dy * uy + dz * uz) * inverse
                v = (dx * vx + dy * vy + dz * vz) * inverse
                w = 1.0 - u - v
                if not (u >= 0.0 and v >= 0.0 and w >= 0.0):
                    u, v, w = _clamped(u, v, w)
                    # The point of the ray that is nearest to there.
                    px, py, pz = u * e1x + v * e2x - sx, u * e1y + v * e2y - sy, u * e1z + v * e2z - sz
                    t = max((px * dx + py * dy + pz * dz) / (dx * dx + dy * dy + dz * dz), near)
                if depth.size:
                    depth[row, column] = t
                if barycentric.size:
                    barycentric[row, column, 0] = w
                    barycentric[row, column, 1] = u
                    barycentric[row, column, 2] = v
                if position.size:
                    position[row, column, 0] = origin[0] + t * dx
                    position[row, column, 1] = origin[1] + t * dy
                    position[row, column, 2] = origin[2] + t * dz
                if normal.size:
                    gx, gy, gz = nx, ny, nz
                    if normals.size:
                        gx = w * normals[i0, 0] + u * normals[i1, 0] + v * normals[i2, 0]
                        gy = w * normals[i0, 1] + u * normals[i1, 1] + v * normals[i2, 1]
                        gz = w * normals[i0, 2] + u * normals[i1, 2] + v * normals[i2, 2]
                        if gx == 0.0 and gy == 0.0 and gz == 0.0:
                            gx, gy, gz = nx, ny, nz
                    if gx == 0.0 and gy == 0.0 and gz == 0.0:  # no area either: it looks at the camera
                        gx, gy, gz = -dx, -dy, -dz
                    scale = 1.0 / np.sqrt(gx * gx + gy * gy + gz * gz)
                    normal[row, column, 0] = gx * scale
                    normal[row, column, 1] = gy * scale
                    normal[row, column, 2] = gz * scale
                if uv.size:
                    for k in range(2):
                        uv[row, column, k] = w * uvs[i0, k] + u * uvs[i1, k] + v * uvs[i2, k]


@njit(cache=True, nogil=True, error_model="numpy")
def _clamped(u, v, w):
    """The rounded grid put the pixel just outside the triangle: the weights of the nearest point inside."""
    u, v, w = max(u, 0.0), max(v, 0.0), max(w, 0.0)
    total = u + v + w
    if not 0.0 < total < np.inf:  # seen exactly edge-on
        return 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0
    return u / total, v / total, w / total


def warm():
    """Compile the kernel for the types that `raster` calls it with."""
    faces, vertices, _, origin = one_triangle()
    channels = tuple(np.empty((0, 0, *size)) for size in ((), (3,), (3,), (3,), (2,)))
    resolve(1, np.full((1, 1), -1, np.int32), (faces, vertices), vertices, vertices, origin, np.eye(3), 0.01, channels)
