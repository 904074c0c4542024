"""Closed-form rays and distances against the field that the framework builds of the same description."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import framework as fw
from solutions.truth_rays import cast, smallest_penumbra, visible_fraction

BALL, OTHER = ({"sphere": {"center": c, "radius": r}} for c, r in (([0.1, 0.2, 0], 0.7), ([0.8, 0.5, 0.3], 0.5)))
SHAPES = {
    "plane": {"plane": {"normal": [0.1, 1, -0.2], "offset": -0.4}},
    "sphere": BALL,
    "box": {"box": {"center": [0.2, -0.1, 0.3], "half_size": [0.6, 0.4, 0.8]}},
    "torus": {"torus": {"center": [0.1, 0, 0.2], "major_radius": 0.8, "minor_radius": 0.3}},
    "capsule": {"capsule": {"a": [-0.5, -0.3, 0], "b": [0.6, 0.4, 0.2], "radius": 0.3}},
    "smooth_union": {"smooth_union": {"k": 0.4, "of": [BALL, OTHER]}},
}


@pytest.mark.parametrize("kind", SHAPES)
def test_rays_end_on_the_surface_and_pass_nothing_before(kind):
    node = SHAPES[kind]
    rng, sdf = np.random.default_rng(0), fw.sdf.from_dict(node)
    origin = 4 * fw.normalize(rng.normal(size=(400, 3)) + [0, 1.5, 0])
    origin = origin[sdf(origin) > 0]
    direction = fw.normalize(rng.uniform(-1, 1, origin.shape) - origin)
    t, normal = cast([node], origin, direction)
    met = np.isfinite(t)
    assert 50 < met.sum()
    p = origin[met] + t[met, None] * direction[met]
    assert_allclose(sdf(p), 0, atol=1e-7)
    slope = np.stack([sdf(p + step) - sdf(p - step) for step in 1e-6 * np.eye(3)], axis=-1)
    assert_allclose(normal[met], fw.normalize(slope), atol=1e-5)
    assert (normal[~met] == 0).all()
    before = np.where(met, t, 8)[:, None] * np.linspace(0, 0.999, 60)
    assert (sdf(origin[:, None] + before[..., None] * direction[:, None]) > 0).all()


@pytest.mark.parametrize("x", [-0.9, -0.4, 0.0, 0.6])
def test_a_straight_edge_leaves_its_segment_of_the_disc(x):
    radius = 0.1
    edge = 4 * np.tan(radius) * x
    wall = {"box": {"center": [edge + 5, 4, 0], "half_size": [5, 1e-4, 5]}}
    seen = visible_fraction([wall], np.zeros((1, 3)), np.array([0, 1.0, 0]), radius, 12.0, 4096)
    assert_allclose(seen, 0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi, atol=2e-3)


@pytest.mark.parametrize("kind", ["sphere", "box", "torus", "capsule"])
def test_a_march_of_one_step_is_k_times_the_distance_over_the_way(kind):
    node = SHAPES[kind]
    p = np.random.default_rng(1).uniform(-3, 3, (200, 3))
    p = p[fw.sdf.from_dict(node)(p + [0, 0.5, 0]) > 0.01]
    seen = smallest_penumbra([node], p, [0, 1, 0], 0.02, 0.5, 9.0, 1)
    assert_allclose(seen, np.minimum(0.04 * fw.sdf.from_dict(node)(p + [0, 0.5, 0]), 1), rtol=1e-9)
