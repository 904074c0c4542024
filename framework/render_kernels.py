"""The renderer's compiled half: which pixels see what, and which rays can meet anything at all.

`rays` takes (column, row, 1) at a pixel's centre to the direction, of depth 1, of the camera's ray through it. A
solid is known by boxes around it and by half-spaces `(nx, ny, nz, offset)`, which no box can hold.
"""

import numpy as np
from numba import njit, prange

from framework.lookup_kernel import angles, blend
from framework.raster_grid_kernels import one_triangle

OPTIONS = dict(parallel=True, cache=True, nogil=True, error_model="numpy")


@njit(**OPTIONS)
def count_points(triangle, first_face, counts):
    """Pixels of each object in each row, into `counts` (H, objects); object k has faces from first_face[k]."""
    height, width = triangle.shape
    for row in prange(height):
        k = 0
        for column in range(width):
            face = triangle[row, column]
            if face >= 0:
                k = _owner(face, first_face, k)
                counts[row, k] += 1


@njit(**OPTIONS)
def fill_points(triangle, depth, normal, mesh, first_face, rays, origin, starts, points):
    """What the pixels see, object after object, from `starts` (H, objects); positions only if not empty.

    Both sides of a triangle are seen. Where the interpolated normal and the triangle disagree about the side, as
    they do along outlines, the normal is bent until it is just seen.
    """
    faces, vertices = mesh
    pixel, positions, normals, views = points
    height, width = triangle.shape
    for row in prange(height):
        k = 0
        for column in range(width):
            face = triangle[row, column]
            if face < 0:
                continue
            k = _owner(face, first_face, k)
            i = starts[row, k]
            starts[row, k] += 1
            pixel[i] = row * width + column
            dx, dy, dz = _ray(rays, column, row)
            if positions.size:
                t = depth[row, column]
                positions[i, 0] = origin[0] + t * dx
                positions[i, 1] = origin[1] + t * dy
                positions[i, 2] = origin[2] + t * dz
            scale = -1.0 / np.sqrt(dx * dx + dy * dy + dz * dz)
            vx, vy, vz = dx * scale, dy * scale, dz * scale
            nx, ny, nz = normal[row, column, 0], normal[row, column, 1], normal[row, column, 2]
            facing = nx * vx + ny * vy + nz * vz
            if facing < 1e-4:
                if _sees_back(faces, vertices, face, vx, vy, vz):
                    nx, ny, nz, facing = -nx, -ny, -nz, -facing
                if facing < 1e-4:
                    nx, ny, nz = (
                        nx + (1e-4 - facing) * vx,
                        ny + (1e-4 - facing) * vy,
                        nz + (1e-4 - facing) * vz,
                    )
                    scale = 1.0 / np.sqrt(nx * nx + ny * ny + nz * nz)
                    nx, ny, nz = nx * scale, ny * scale, nz * scale
            normals[i, 0], normals[i, 1], normals[i, 2] = nx, ny, nz
            views[i, 0], views[i, 1], views[i, 2] = vx, vy, vz


@njit(**OPTIONS)
def directions(pixel, width, rays, out):
    """Unit directions of the camera's rays through pixels, numbered row by row, into `out` (N, 3)."""
    for i in prange(pixel.shape[0]):
        dx, dy, dz = _ray(rays, pixel[i] % width, pixel[i] // width)
        scale = 1.0 / np.sqrt(dx * dx + dy * dy + dz * dz)
        out[i, 0], out[i, 1], out[i, 2] = dx * scale, dy * scale, dz * scale


@njit(**OPTIONS)
def background(empty, width, rays, texels, height, image):
    """Fill the pixels (P,) that are `empty` in an image (P, 3) with the environment (height, 2 height, 3), as `texels`."""
    for row in prange(empty.shape[0] // width):
        pixel, lines, n = np.empty(width, np.int64), np.empty((5, width)), 0
        x, y, z, down, right = lines[0], lines[1], lines[2], lines[3], lines[4]
        for column in range(width):
            if empty[row * width + column]:
                pixel[n] = row * width + column
                x[n], y[n], z[n] = _ray(rays, column, row)
                n += 1
        angles(n, x, y, z, down, right)
        for i in range(n):
            at = pixel[i]
            image[at, 0], image[at, 1], image[at, 2] = blend(texels, 0, height, down[i], right[i])


@njit(**OPTIONS)
def around(normal, texels, height, color):
    """The map (height, 2 height, 3), as `texels`, looked up along normals (N, 3); NaN where one is not finite."""
    count = normal.shape[0]
    for span in prange((count + 127) // 128):
        lines, first = np.empty((5, 128)), 128 * span
        n = min(128, count - first)
        x, y, z, down, right = lines[0], lines[1], lines[2], lines[3], lines[4]
        for i in range(n):
            x[i], y[i], z[i] = normal[first + i, 0], normal[first + i, 1], normal[first + i, 2]
        angles(n, x, y, z, down, right)
        for i in range(n):
            at = first + i
            if abs(x[i]) + abs(y[i]) + abs(z[i]) < 1e150:
                color[at, 0], color[at, 1], color[at, 2] = blend(texels, 0, height, down[i], right[i])
            else:
                color[at, 0] = color[at, 1] = color[at, 2] = np.nan


@njit(**OPTIONS)
def place(pixel, color, image):
    """Put the colours (N, 3) of pixels into an image (P, 3)."""
    for i in prange(pixel.shape[0]):
        at = pixel[i]
        image[at, 0], image[at, 1], image[at, 2] = color[i, 0], color[i, 1], color[i, 2]


@njit(**OPTIONS)
def camera_rays(low, high, planes, rays, origin, far, depth, mask):
    """Whether a pixel's ray may meet a solid, before `far` and before the mesh at `depth` (H, W), into `mask`."""
    height, width = mask.shape
    for row in prange(height):
        for column in range(width):
            d = _ray(rays, column, row)
            limit = far / np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
            if depth.size:
                limit = min(limit, depth[row, column])
            meets = False
            for part in range(low.shape[0]):
                meets = meets or _meets_box(low[part], high[part], origin, d, 0.0, limit)
            for part in range(planes.shape[0]):
                height_now, slope = _above(planes[part], origin, d)
                meets = meets or min(height_now, height_now + slope * limit) <= 0.0
            mask[row, column] = meets


@njit(**OPTIONS)
def shadow_rays(position, normal, to_light, offset, low, high, planes, edges, k, cosine, mask):
    """Whether a light may be hidden from points, in part or whole, into `mask`; n.l goes into `cosine`, if positive.

    For distances from edges[s] to edges[s + 1] along the ray, `low` and `high` (parts, segments, 3) hold all points
    that are nearer to a solid than the light's cone is wide there: a ray outside of them sees all of the light.
    """
    for i in prange(position.shape[0]):
        n = normal[i]
        cosine[i] = n[0] * to_light[0] + n[1] * to_light[1] + n[2] * to_light[2]
        mask[i] = False
        if not cosine[i] > 0.0:
            cosine[i] = 0.0
            continue
        p = (position[i, 0] + offset * n[0], position[i, 1] + offset * n[1], position[i, 2] + offset * n[2])
        meets, last = False, edges.shape[0] - 1
        for part in range(low.shape[0]):
            if _meets_box(low[part, last - 1], high[part, last - 1], p, to_light, edges[0], edges[last]):
                for s in range(last):
                    meets = meets or _meets_box(
                        low[part, s], high[part, s], p, to_light, edges[s], edges[s + 1]
                    )
        for part in range(planes.shape[0]):
            height, slope = _above(planes[part], p, to_light)
            for t in (edges[0], edges[-1]):
                meets = meets or height + slope * t <= max(t / k, 1e-4) * (1.0 + 1e-6)
        mask[i] = meets


@njit(**OPTIONS)
def offset_points(position, normal, which, offset, out):
    """The points of those numbers, `offset` above the surface, into `out` (M, 3)."""
    for j in prange(which.shape[0]):
        i = which[j]
        for axis in range(3):
            out[j, axis] = position[i, axis] + offset * normal[i, axis]


@njit(**OPTIONS)
def add_light(color, strength, matt, irradiance, glint):
    """Add what points reflect of a light to `color` (N, 3); `glint` is (N, 3), or (0, 3) for no mirror part."""
    for i in prange(color.shape[0]):
        if strength[i] > 0.0:
            for c in range(3):
                brdf = matt[c]
                if glint.shape[0]:
                    brdf += glint[i, c]
                color[i, c] += strength[i] * irradiance[c] * brdf


@njit(cache=True, nogil=True, error_model="numpy")
def _ray(rays, column, row):
    x, y = column + 0.5, row + 0.5
    return (
        rays[0, 0] * x + rays[0, 1] * y + rays[0, 2],
        rays[1, 0] * x + rays[1, 1] * y + rays[1, 2],
        rays[2, 0] * x + rays[2, 1] * y + rays[2, 2],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _owner(face, first_face, k):
    """The object that has this face; k, the neighbour's, is the likeliest."""
    if not first_face[k] <= face < first_face[k + 1]:
        k = np.searchsorted(first_face, face, side="right") - 1
    return k


@njit(cache=True, nogil=True, error_model="numpy")
def _sees_back(faces, vertices, face, vx, vy, vz):
    a, b, c = vertices[faces[face, 0]], vertices[faces[face, 1]], vertices[faces[face, 2]]
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    wx, wy, wz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    return (uy * wz - uz * wy) * vx + (uz * wx - ux * wz) * vy + (ux * wy - uy * wx) * vz < 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def _above(plane, p, d):
    """Height of p above the plane, and how it grows along d."""
    height = plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] - plane[3]
    return height, plane[0] * d[0] + plane[1] * d[1] + plane[2] * d[2]


@njit(cache=True, nogil=True, error_model="numpy")
def _meets_box(low, high, p, d, near, far):
    for axis in range(3):
        if d[axis] == 0.0:
            if not low[axis] <= p[axis] <= high[axis]:
                return False
        else:
            inverse = 1.0 / d[axis]
            a, b = (low[axis] - p[axis]) * inverse, (high[axis] - p[axis]) * inverse
            near, far = max(near, min(a, b)), min(far, max(a, b))
    return near <= far


def warm():
    """Compile the kernels for the types that the renderer calls them with."""
    faces, vertices, _, origin = one_triangle()
    triangle, one, mask = np.zeros((1, 1), np.int32), np.ones((1, 1)), np.zeros((1, 1), bool)
    first_face, rays, planes = np.array([0, 1]), np.eye(3), np.ones((1, 4))
    count_points(triangle, first_face, np.zeros((1, 1), np.int64))
    points = np.zeros(1, np.int64), np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, 3))
    mesh, starts = (faces, vertices), np.zeros((1, 1), np.int64)
    fill_points(triangle, one, np.ones((1, 1, 3)), mesh, first_face, rays, origin, starts, points)
    pixel, position, normal, out = points
    directions(pixel, 1, rays, out)
    texels = np.zeros((2, 3))
    texels.flags.writeable = False
    background(mask[0], 1, rays, texels, 1, out)
    around(normal, texels, 1, out)
    place(pixel, out, out)
    camera_rays(np.ones((1, 3)), np.ones((1, 3)), planes, rays, origin, 1.0, one, mask)
    boxes = np.ones((1, 1, 3)), np.ones((1, 1, 3)), planes, np.ones(2)
    shadow_rays(position, normal, np.ones(3), 0.1, *boxes, 8.0, np.zeros(1), mask[0])
    offset_points(position, normal, pixel, 0.1, out)
    add_light(out, one[0], one[0], one[0], out)
