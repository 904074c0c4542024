"""Hypothesis looks for inputs on which public functions are not finite, or break what always holds."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import framework as fw
from solutions import prefilter, soft_shadows, sphere_tracing, split_sum

few = settings(max_examples=60, deadline=None, derandomize=True, database=None)
length = st.floats(-1e6, 1e6)
positive = st.floats(1e-4, 1e5)
unit_interval = st.floats(0, 1)
cosine = st.floats(-1, 1)
point = st.tuples(length, length, length)
anywhere = st.tuples(*3 * [st.floats(allow_nan=False, allow_infinity=False)])


@few
@given(anywhere)
def test_normalize_gives_length_1_or_0(v):
    found = np.linalg.norm(fw.normalize(v))
    assert abs(found - any(v)) <= 1e-15


@few
@given(anywhere, st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_a_look_up_stays_between_the_maps_extremes(direction, height, seed):
    pixels = 10.0 ** np.random.default_rng(seed).uniform(-4, 5, (height, 2 * height, 3))
    found = fw.Environment(pixels).radiance(direction)
    if any(direction):
        assert (pixels.min((0, 1)) * (1 - 1e-14) <= found).all() and (found <= pixels.max((0, 1)) * (1 + 1e-14)).all()
    else:
        assert not found.any()


@few
@given(length, length, st.floats(1.01, 1000))
def test_penumbra_and_safe_angle_are_finite_in_range_and_0_inside(distance, travelled, k):
    seen, angle = soft_shadows.penumbra(distance, travelled, k), soft_shadows.safe_angle(distance, travelled)
    assert 0 <= seen <= 1 and 0 <= angle <= np.pi / 2
    assert distance > 0 or seen == angle == 0


@few
@given(cosine, cosine, unit_interval)
def test_masking_is_a_symmetric_probability_and_densities_are_finite(cos_i, cos_o, alpha):
    found = split_sum.masking_shadowing(cos_i, cos_o, alpha)
    assert 0 <= found <= 1 and found == split_sum.masking_shadowing(cos_o, cos_i, alpha)
    for ndf in (split_sum.ndf_ggx, split_sum.ndf_beckmann):
        assert 0 <= ndf(cos_i, alpha) < np.inf


@few
@given(point, point, positive, positive, positive)
def test_distances_grow_no_faster_than_the_way(p, q, radius, minor, k):
    def field(x):
        ball = sphere_tracing.sdf_sphere(x, (1.0, 2.0, 3.0), radius)
        ring = sphere_tracing.sdf_torus(x, (1.0, 2.0, 3.0), radius, minor)
        return sphere_tracing.smooth_union(ball, ring, k)

    p, q = np.array(p), np.array(q)
    way = np.linalg.norm(p - q)
    assert abs(field(p) - field(q)) <= way + 1e-14 * (np.abs([p, q]).max() + radius + minor + k)


@few
@given(st.lists(st.tuples(st.floats(-10, 10), st.floats(-10, 10), st.floats(-10, 10)), min_size=3, max_size=12))
def test_any_triangles_draw_finite_channels(corners):
    corners = corners[: len(corners) // 3 * 3]
    mesh = fw.Mesh(corners, np.arange(len(corners)).reshape(-1, 3))
    found = fw.rasterize(mesh, fw.Camera((1, 2, 3), (0, 0, 0), (0, 1, 0), 1.0), 9, 7)
    assert (np.isfinite(found.depth) == found.mask).all() and (found.depth >= 0.01 * (1 - 1e-9)).all()
    for channel in (found.position, found.normal, found.barycentric):
        assert np.isfinite(channel).all()


@few
@given(st.floats(0, 1, exclude_max=True), st.floats(0, 1, exclude_max=True), st.floats(1e-8, 1))
def test_sampled_half_vectors_are_unit_and_above_the_horizon(u, v, alpha):
    for sample in (fw.sample_ggx, prefilter.sample_ggx):
        (h,) = sample(np.array([[u, v]]), alpha)
        assert abs(h @ h - 1) < 1e-14 and h[2] >= 0
