"""`render_sdf` against rays cast in closed form, against a march fifty times tighter, and against `soft_shadow`."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework import sdf
from solutions.fast import render_sdf
from solutions.soft_shadows import soft_shadow
from solutions.sphere_tracing import sphere_trace
from solutions.truth_visibility import Solids

LIGHT = fw.normalize([0.5, 0.8, 0.3])
CAMERA = fw.Camera((4.5, 3.5, 6.0), (0, 0.5, 0), (0, 1, 0), 0.93)
BALLS = sdf.smooth_union(sdf.sphere((0, 0.6, 2.0), 0.6), sdf.sphere((0.7, 0.9, 2.2), 0.5), 0.3)
DIE = sdf.subtraction(sdf.box((0, 0, 0), (0.7, 0.7, 0.7)), sdf.sphere((0, 0.7, 0), 0.5))
SCENES = {
    "nine primitives": sdf.union(
        sdf.plane((0, 1, 0), 0),
        sdf.sphere((0, 1, 0), 1.0),
        sdf.box((2.2, 0.7, 0), (0.7, 0.7, 0.7)),
        sdf.torus((-2.2, 0.5, 0), 0.8, 0.3),
        BALLS,
        sdf.capsule((-2, 0, 2), (-2, 1.2, 2), 0.3),
        sdf.box((2, 0.5, 2.2), (0.5, 0.5, 0.5)),
        sdf.sphere((0, 0.4, -2.2), 0.4),
    ),
    "operators, moved": sdf.union(
        sdf.translate(sdf.rotate(DIE, (1, 1, 0), 0.6), (-1.5, 1.0, 0)),
        sdf.translate(sdf.rotate(sdf.box((0, 0, 0), (0.5, 0.8, 0.3)), (0, 1, 2), 0.9), (1.5, 1.2, 0.4)),
        sdf.intersection(sdf.sphere((0, 1, 1.5), 0.8), sdf.sphere((0.5, 1, 1.8), 0.8)),
        sdf.blend(sdf.box((0, 1, -1.5), (0.5, 0.5, 0.5)), sdf.sphere((0, 1, -1.5), 0.6), 0.5),
        sdf.subtraction(sdf.plane((0, 1, 0), 0), sdf.sphere((1, 0, 2.5), 0.8)),
    ),
}


def strewn(count, seed=0):
    rng = np.random.default_rng(seed)
    kinds = [
        lambda c, r: sdf.sphere(c, r),
        lambda c, r: sdf.box(c, (r, 0.7 * r, 0.5 * r)),
        lambda c, r: sdf.torus(c, r, 0.3 * r),
        lambda c, r: sdf.capsule(c, c + (0, r, 0), 0.5 * r),
    ]
    centers, sizes = rng.uniform((-3, 0, -3), (3, 2, 3), (count, 3)), rng.uniform(0.05, 0.25, count)
    return sdf.union(
        sdf.plane((0, 1, 0), 0),
        *(kinds[i % 4](c, r) for i, (c, r) in enumerate(zip(centers, sizes, strict=True))),
    )


def chain(count, seed=0):
    rng = np.random.default_rng(seed)
    node = sdf.sphere((0, 1, 0), 0.3)
    for center in rng.uniform((-2, 0, -2), (2, 2, 2), (count, 3)):
        node = sdf.smooth_union(node, sdf.sphere(center, 0.3), 0.2)
    return node


def marched(scene, camera, width, height, t_max=40.0):
    """Fifty times closer than the twin's own march goes: 4e-4 of a pixel's radius at most."""
    origin, direction = (a.reshape(-1, 3) for a in camera.rays(width, height))
    t, _ = sphere_trace(scene, origin, direction, t_max, 1e-6, 4000)
    return t.reshape(height, width)


def near_silhouette(t, jump):
    """Pixels within one of a place where `t` jumps."""
    t = np.where(np.isfinite(t), t, 1e3)
    padded = np.pad(t, 1, mode="edge")
    height, width = t.shape
    around = [padded[1 + r : 1 + r + height, 1 + c : 1 + c + width] for r in (-1, 0, 1) for c in (-1, 0, 1)]
    return np.max(around, axis=0) - np.min(around, axis=0) > jump


@pytest.mark.parametrize(
    "scene",
    [*SCENES.values(), strewn(60), chain(40)],
    ids=[*SCENES, "60 primitives", "a chain of 40 smooth unions"],
)
def test_hits_normals_and_visibility_are_the_references(scene):
    size = 96
    t, normal, visibility = render_sdf(scene, CAMERA, size, size, LIGHT, 8.0)
    expected = marched(scene, CAMERA, size, size)
    both = np.isfinite(t) & np.isfinite(expected)
    pixel = 2 * np.tan(CAMERA.fov_y / 2) / size * np.where(both, expected, 1.0)
    differs = np.ones(t.shape, bool)
    differs[both] = np.abs(t[both] - expected[both]) > 0.5 * pixel[both]
    differs &= np.isfinite(t) | np.isfinite(expected)
    assert not (differs & ~near_silhouette(expected, 0.02)).any()
    assert differs.mean() < 2e-3
    assert np.percentile(np.abs(t[both] - expected[both]), 99) < 1e-3

    origin, direction = CAMERA.rays(size, size)
    p = (origin + t[..., None].astype(float) * direction)[both]
    n = normal[both].astype(float)
    assert_allclose(np.linalg.norm(n, axis=-1), 1.0, atol=1e-6)
    step = 1e-5 * np.eye(3)
    gradient = fw.normalize(np.stack([scene(p + s) - scene(p - s) for s in step], axis=-1))
    # Differences straddle edges and creases: there the two may be anything.
    assert np.percentile(np.linalg.norm(n - gradient, axis=-1), 98) < 2e-3
    lit = n @ LIGHT > 0
    reference = np.where(lit, soft_shadow(scene, p + 0.005 * n, LIGHT, 8.0, 0.02, 12.0, 500), 0.0)
    error = np.abs(visibility[both] - reference)
    # The same steps in float32: k h / t moves by k times a rounding of the coordinates over t.
    assert np.percentile(error, 99.5) < 2e-4 and error.mean() < 2e-5
    missed = ~np.isfinite(t)
    assert (visibility[missed] == 0).all() and (normal[missed] == 0).all()


@pytest.mark.parametrize("k", [1.01, 2.0, 32.0, 1000.0])
def test_visibility_is_soft_shadows_for_lights_of_every_size(k):
    scene = SCENES["nine primitives"]
    t, normal, visibility = render_sdf(scene, CAMERA, 64, 64, LIGHT, k)
    hit = np.isfinite(t) & (normal @ LIGHT > 0)
    origin, direction = CAMERA.rays(64, 64)
    p = (origin + np.where(hit, t, 0)[..., None].astype(float) * direction)[hit]
    reference = soft_shadow(scene, p + 0.005 * normal[hit].astype(float), LIGHT, k, 0.02, 12.0, 500)
    error = np.abs(visibility[hit] - reference)
    assert np.percentile(error, 99) < 1e-5 * k + 1e-4 and error.mean() < 1e-4
    assert (visibility[np.isfinite(t) & (normal @ LIGHT <= 0)] == 0).all()


def test_hits_are_those_of_rays_cast_in_closed_form():
    solids = Solids(
        spheres=(((0, 1, 0), 1.0), ((1.5, 0.5, 1.5), 0.5)), boxes=(((-2, 0.7, 0.5), (0.7, 0.7, 0.4)),)
    )
    t, _, _ = render_sdf(solids.sdf(), CAMERA, 128, 96, LIGHT, 8.0)
    origin, direction = CAMERA.rays(128, 96)
    hit = np.isfinite(t)
    before, after = np.where(hit, t * (1 - 1e-5), 40.0), np.where(hit, t * (1 + 1e-5), 40.0)
    assert not solids.blocked(origin, direction, before)[hit].any()
    assert solids.blocked(origin, direction, after)[hit].all()
    assert_array_equal(hit, solids.blocked(origin, direction, 40.0))


@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e3], ids=["millimetre", "metre", "kilometre"])
@pytest.mark.parametrize("away", [(0, 0, 0), (1e5, -2e5, 5e4)], ids=["here", "far away"])
def test_place_and_size_of_a_scene_do_not_change_its_picture(factor, away):
    away = factor * np.array(away)
    for name in SCENES:
        scene = sdf.translate(sdf.scale(SCENES[name], factor), away)
        camera = fw.Camera(
            factor * CAMERA.position + away, factor * CAMERA.target + away, CAMERA.up, CAMERA.fov_y
        )
        t, normal, _ = render_sdf(scene, camera, 48, 48, LIGHT, 8.0, 40.0 * factor)
        t1, normal1, _ = render_sdf(SCENES[name], CAMERA, 48, 48, LIGHT, 8.0)
        same = np.isclose(t / factor, t1, rtol=2e-4) | ((t == np.inf) & (t1 == np.inf))
        assert same.mean() > 0.998
        assert (np.linalg.norm(normal - normal1, axis=-1) < 2e-3).mean() > 0.995


@pytest.mark.parametrize("position", [(0, 1, 0), (0.3, 1.2, 0.1), (3, -1, 5), (3, 0, 5)])
def test_inside_and_on_objects_everything_is_hit_at_zero(position):
    camera = fw.Camera(position, (0.1, 4, 0.2), (0, 0, 1), 0.9)
    t, normal, visibility = render_sdf(SCENES["nine primitives"], camera, 9, 7, LIGHT, 8.0)
    assert (t == 0).all()
    assert_allclose(np.linalg.norm(normal, axis=-1), 1.0, atol=1e-6)
    assert ((visibility >= 0) & (visibility <= 1)).all()


@pytest.mark.parametrize("size", [(1, 1), (7, 5), (17, 33), (16, 1)])
def test_sizes_that_are_no_tiles_show_the_same_rays(size):
    width, height = size
    t, normal, visibility = render_sdf(SCENES["nine primitives"], CAMERA, width, height, LIGHT, 8.0)
    assert t.shape == visibility.shape == (height, width) and normal.shape == (height, width, 3)
    expected = marched(SCENES["nine primitives"], CAMERA, width, height)
    assert_allclose(t, expected, rtol=1e-4)


def test_a_grazing_view_sees_the_plane_up_to_t_max():
    camera = fw.Camera((0, 0.01, 0), (10, 0.01, 0), (0, 1, 0), 0.2)
    t, _, _ = render_sdf(sdf.plane((0, 1, 0), 0), camera, 33, 1001, LIGHT, 8.0)
    _, direction = camera.rays(33, 1001)
    with np.errstate(divide="ignore"):
        expected = np.where(direction[..., 1] < 0, -0.01 / direction[..., 1], np.inf)
    assert_allclose(t, np.where(expected <= 40, expected, np.inf), rtol=1e-5)


def test_nothing_is_nothing():
    t, normal, visibility = render_sdf(sdf.sphere((0, 0, 5), 1), fw.Camera((0, 0, 0), (0, 0, -1), (0, 1, 0), 1.0), 40, 30,
                                       LIGHT, 8.0)  # fmt: skip
    assert (t == np.inf).all() and (normal == 0).all() and (visibility == 0).all()


def test_the_picture_does_not_depend_on_the_number_of_threads():
    import numba

    before = numba.get_num_threads()
    try:
        pictures = []
        for threads in {1, before}:
            numba.set_num_threads(threads)
            pictures.append(render_sdf(strewn(60), CAMERA, 64, 64, LIGHT, 8.0))
    finally:
        numba.set_num_threads(before)
    for one, other in zip(pictures[0], pictures[-1], strict=True):
        assert_array_equal(one, other)


def test_what_is_wrong_is_named():
    scene = SCENES["nine primitives"]
    with pytest.raises(ValueError, match="to_light is zero"):
        render_sdf(scene, CAMERA, 4, 4, (0, 0, 0), 8.0)
    with pytest.raises(ValueError, match="k is -1"):
        render_sdf(scene, CAMERA, 4, 4, LIGHT, -1)
    with pytest.raises(ValueError, match="width is 0"):
        render_sdf(scene, CAMERA, 0, 4, LIGHT, 8.0)
