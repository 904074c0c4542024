"""How far the lecture's shadow and the signed form are from a sampled round light, under four occluders."""

import numpy as np
import pytest

import framework as fw
from solutions.soft_shadows import area_light_shadow, soft_shadow
from solutions.truth_rays import visible_fraction

OCCLUDERS = {
    "sphere": {"sphere": {"center": [0, 1.5, 0], "radius": 0.7}},
    "box": {"box": {"center": [0, 1.5, 0], "half_size": [0.7, 0.5, 0.6]}},
    "torus": {"torus": {"center": [0, 1.5, 0], "major_radius": 0.8, "minor_radius": 0.25}},
    "capsule": {"capsule": {"a": [-0.7, 1.4, 0], "b": [0.7, 1.6, 0.2], "radius": 0.3}},
}
TO_LIGHT = fw.normalize([0.3, 1.0, 0.2])
MARCH = {"t_min": 0.02, "t_max": 12.0, "max_steps": 256}


def half_lit_points(node, radius, count=200):
    """Points of the floor whose visible fraction lies in [0.02, 0.98], and that fraction, from 1024 rays each."""
    below = -1.5 / TO_LIGHT[1] * TO_LIGHT[[0, 2]]
    spread = 1.4 + 2.5 * np.tan(radius)
    origin = np.zeros((2000, 3))
    origin[:, [0, 2]] = below + np.random.default_rng(1).uniform(-spread, spread, (2000, 2))
    for rays in (24, 1024):
        truth = visible_fraction([node], origin, TO_LIGHT, radius, 12.0, rays)
        between = (truth >= 0.02) & (truth <= 0.98)
        origin, truth = origin[between][:count], truth[between][:count]
    return origin, truth


def errors(name, k):
    """Mean absolute errors of min(k d / t, 1) and of the signed form, on the same points."""
    node, radius = OCCLUDERS[name], np.arcsin(1 / k)
    sdf = fw.sdf.from_dict(node)
    origin, truth = half_lit_points(node, radius)
    lecture = np.abs(soft_shadow(sdf, origin, TO_LIGHT, k, **MARCH) - truth).mean()
    signed = np.abs(area_light_shadow(sdf, origin, TO_LIGHT, radius, **MARCH) - truth).mean()
    print(f"{name:8s} k = {k:2d}: {len(origin):3d} points, lecture {lecture:.4f}, signed {signed:.4f}")
    assert len(origin) >= 50
    return lecture, signed


@pytest.mark.drill
@pytest.mark.parametrize("k", [8, 32])
@pytest.mark.parametrize("name", OCCLUDERS)
def test_the_signed_form_keeps_a_quarter_of_the_error_under_every_occluder(name, k):
    lecture, signed = errors(name, k)
    assert signed <= lecture / 4


@pytest.mark.drill
@pytest.mark.parametrize("name", OCCLUDERS)
def test_under_a_light_wider_than_the_occluder_the_signed_form_is_still_nearer(name):
    lecture, signed = errors(name, 2)
    assert signed < lecture
