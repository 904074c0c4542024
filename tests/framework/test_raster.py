import numba
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework import _raster_kernels as kernels
from framework import mesh as shapes
from framework import raster

CAMERA = fw.Camera((0.4, 0.7, 3.0), (0.0, 0.0, 0.0), (0, 1, 0), 0.8)


@numba.njit(parallel=True, cache=True, error_model="numpy")
def cast_rays(vertices, faces, origin, direction, near):
    """Nearest face and depth per ray by Moeller-Trumbore on every triangle, float64; the rays have depth 1."""
    count = direction.shape[0]
    triangle, depth = np.full(count, -1), np.full(count, np.inf)
    corners, e1s, e2s = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    for i in numba.prange(count):
        dx, dy, dz = direction[i]
        for f in range(len(faces)):
            ax, ay, az = corners[f]
            ux, uy, uz = e1s[f, 0] - ax, e1s[f, 1] - ay, e1s[f, 2] - az
            vx, vy, vz = e2s[f, 0] - ax, e2s[f, 1] - ay, e2s[f, 2] - az
            px, py, pz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
            inverse = 1.0 / (ux * px + uy * py + uz * pz)
            sx, sy, sz = origin[0] - ax, origin[1] - ay, origin[2] - az
            u = (sx * px + sy * py + sz * pz) * inverse
            if not 0 <= u <= 1:
                continue
            qx, qy, qz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
            v = (dx * qx + dy * qy + dz * qz) * inverse
            t = (vx * qx + vy * qy + vz * qz) * inverse
            if v >= 0 and u + v <= 1 and near <= t < depth[i]:
                triangle[i], depth[i] = f, t
    return triangle, depth


def rays(camera, width, height):
    """Rays through pixel centres, scaled to depth 1."""
    origin, direction = camera.rays(width, height)
    return origin[0, 0], direction / (direction @ camera.axis)[..., None]


def slivers():
    """A fan of triangles across the picture, each about a hundredth of a pixel to two pixels wide."""
    rng = np.random.default_rng(7)
    centre = rng.uniform(-1, 1, (300, 3))
    along = rng.normal(size=(300, 3))
    width = rng.normal(size=(300, 3)) * 10 ** rng.uniform(-4, -2, (300, 1))
    vertices = np.stack([centre - along, centre + along, centre + along + width], 1)
    return fw.Mesh(vertices.reshape(-1, 3), np.arange(900).reshape(-1, 3))


def ground():
    """A floor that runs under the camera to the horizon, with things on it."""
    rng = np.random.default_rng(8)
    soup = rng.uniform(-3, 3, (60, 1, 3)) + rng.normal(size=(60, 3, 3))
    floor = np.array(
        [
            [[-900, -1, -900], [-900, -1, 900], [900, -1, 900]],
            [[-900, -1, -900], [900, -1, 900], [900, -1, -900]],
        ]
    )
    return fw.Mesh(np.concatenate([floor, soup]).reshape(-1, 3), np.arange(186).reshape(-1, 3))


SCENES = {
    "bumpy": (lambda: shapes.bumpy_sphere(6000), CAMERA),
    "teapot": (
        lambda: fw.load_mesh(raster_data("teapot.obj")),
        fw.Camera((5, 7, 12), (0, 1.5, 0), (0, 1, 0), 0.9),
    ),
    "ball": (lambda: shapes.shading_ball(48, 64), CAMERA),
    "slivers": (slivers, CAMERA),
    "ground": (ground, fw.Camera((0.1, 0.2, 0.3), (0.5, -0.1, -1), (0, 1, 0), 1.4)),
    "inside": (
        lambda: shapes.bumpy_sphere(3000, 0.3),
        fw.Camera((0.5, 0.3, 0.6), (0, 0, -1), (0, 1, 0), 2.0),
    ),
}


def raster_data(name):
    from pathlib import Path

    return Path(fw.__file__).parent / "data" / name


@pytest.mark.parametrize("name", SCENES)
def test_visibility_agrees_with_rays_cast_at_every_triangle(name):
    make, camera = SCENES[name]
    mesh, size = make(), 256
    gbuffer = fw.rasterize(mesh, camera, size, size)
    origin, direction = rays(camera, size, size)
    triangle, depth = cast_rays(mesh.vertices, mesh.faces, origin, direction.reshape(-1, 3), 0.01)
    triangle, depth = triangle.reshape(size, size), depth.reshape(size, size)
    differ = triangle != gbuffer.triangle
    same = ~differ & (triangle >= 0)
    error = np.abs(gbuffer.depth[same] / depth[same] - 1)
    print(
        name, len(mesh.faces), differ.sum(), differ.mean(), same.sum(), np.quantile(error, 0.999), error.max()
    )
    assert differ.mean() <= 0.002
    assert np.quantile(error, 0.999) <= 1e-4
