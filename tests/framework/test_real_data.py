"""Real maps and meshes: those that travel with the project, and those beside it where they are."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import framework as fw

ROOT = Path(fw.__file__).resolve().parents[1]
BESIDE = ROOT.parent / "shared" / "data"
MAPS = [ROOT / "framework/data/sky_512x256.exr", *sorted((BESIDE / "hdri").glob("studio*.exr"))]
MESHES = [ROOT / "framework/data/teapot.obj", *sorted((BESIDE / "mesh").glob("suzanne.obj"))]


def names(paths):
    return [path.stem for path in paths]


@pytest.fixture(scope="module", params=MAPS, ids=names(MAPS))
def env(request):
    with warnings.catch_warnings():  # lossy files ring below zero beside what is bright
        warnings.simplefilter("ignore")
        return fw.Environment.load(request.param)


def energy(env):
    return np.sum(env.pixels * env.solid_angles()[..., None], axis=(0, 1))


def test_a_real_map_is_finite_and_not_negative(env):
    assert np.isfinite(env.pixels).all() and env.pixels.min() >= 0 and env.pixels.max() > 50


def test_a_real_map_keeps_its_light_in_every_mip_and_as_a_cube(env):
    for mip in env.mips()[:4]:
        assert_allclose(energy(mip), energy(env), rtol=1e-10)
    small = env.resized(64)
    assert_allclose(energy(fw.Environment.from_cube(small.to_cube(64))), energy(small), rtol=1e-3)


@pytest.mark.parametrize("path", MESHES, ids=names(MESHES))
def test_a_real_mesh_is_drawn_where_rays_meet_it(path):
    mesh = fw.load_mesh(path)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle, size = 0.5 * (low + high), float(np.max(high - low))
    camera = fw.Camera(middle + size * np.array([0.4, 0.5, 1.6]), middle, [0, 1, 0], 0.7)
    gbuffer = fw.rasterize(mesh, camera, 200, 150)
    assert 0.05 < gbuffer.mask.mean() < 0.9
    origin, direction = camera.rays(200, 150)
    p, d, o = gbuffer.position[gbuffer.mask], direction[gbuffer.mask], origin[gbuffer.mask]
    # the point lies on the pixel's ray, at the depth that is told, in the plane of its triangle
    along = np.sum((p - o) * d, axis=1)
    assert_allclose(o + along[:, None] * d, p, atol=1e-6 * size)
    assert_allclose((p - o) @ camera.axis, gbuffer.depth[gbuffer.mask], rtol=1e-6)
    corner = mesh.vertices[mesh.faces[gbuffer.triangle[gbuffer.mask]]]
    plane = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    off = np.abs(np.sum((p - corner[:, 0]) * plane, axis=1)) / np.linalg.norm(plane, axis=1)
    assert np.quantile(off, 0.999) < 1e-5 * size
