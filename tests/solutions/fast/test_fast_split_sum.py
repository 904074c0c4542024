"""The compiled table, shading, look-ups and Monte Carlo against independent truths and the reference solutions."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from solutions import fast, prefilter, split_sum
from solutions.truth import brdf_integral, reflected_radiance
from solutions.truth_maps import bilinear


def points(count, seed=0):
    """Random normals, views (a few below the horizon), reflectances and roughnesses."""
    rng = np.random.default_rng(seed)
    normal = fw.normalize(rng.normal(size=(count, 3)))
    view = fw.normalize(rng.normal(size=(count, 3)) + normal)
    return normal, view, rng.random((count, 3)), rng.random(count)


@pytest.fixture(scope="module")
def light():
    return fast.environment_light(fw.skies.sun_and_sky(48))


def test_the_table_meets_quadrature_that_shares_no_code():
    lut = fast.brdf_lut(128)
    centres = (np.arange(128) + 0.5) / 128
    for row in (0, 1, 3, 12, 30, 64, 127):
        for column in (0, 1, 2, 5, 20, 64, 127):
            error = np.abs(lut[row, column] - brdf_integral(centres[column], centres[row] ** 2)).max()
            sure = centres[row] >= 0.02 and centres[column] >= 1 / 64
            assert error < (2e-5 if sure else 1e-4), (row, column)


@pytest.mark.drill
def test_all_of_the_table_meets_quadrature():
    lut = fast.brdf_lut(128)
    centres = (np.arange(128) + 0.5) / 128
    truth = np.array([[brdf_integral(mu, r * r, nodes=64) for mu in centres] for r in centres])
    error = np.abs(lut - truth).max(axis=2)
    sure = (centres[:, None] >= 0.02) & (centres >= 1 / 64)
    assert error[sure].max() < 2e-5 and error.max() < 1e-4


def test_the_table_reflects_no_more_than_falls_on_it():
    for size in (1, 2, 33):
        lut = fast.brdf_lut(size)
        assert lut.shape == (size, size, 2) and np.isfinite(lut).all() and lut.min() >= 0
        assert lut.sum(axis=2).max() <= 1 + 1e-6
    with pytest.raises(ValueError, match="size"):
        fast.brdf_lut(0)


def test_shading_is_that_of_the_reference_within_1e_6(light):
    normal, view, r0, roughness = points(3000)
    # Mirrors along the axes, at the poles and on the seam.
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    normal, view = np.concatenate([normal, axes]), np.concatenate([view, axes])
    r0, roughness = np.concatenate([r0, np.ones((6, 3))]), np.concatenate([roughness, np.linspace(0, 1, 6)])
    for reflectance, rough in ((r0, roughness), (0.04, roughness), ((0.9, 0.6, 0.3), 0.5), (r0, 0.0)):
        result = fast.shade_split_sum(normal, view, reflectance, rough, light.prefiltered, light.lut)
        expected = split_sum.shade_split_sum(normal, view, reflectance, rough, light.prefiltered, light.lut)
        assert_allclose(result, expected, rtol=1e-5, atol=1e-6)
    assert (result[np.sum(normal * view, axis=1) <= 0] == 0).all()


def test_shading_takes_any_callable_and_no_points(light):
    normal, view, r0, roughness = points(50)
    served = fast.shade_split_sum(
        normal, view, r0, roughness, lambda d, r: light.prefiltered(d, r), light.lut
    )
    fused = fast.shade_split_sum(normal, view, r0, roughness, light.prefiltered, light.lut)
    assert_allclose(fused, served, rtol=1e-5, atol=1e-6)
    empty = fast.shade_split_sum(normal[:0], view[:0], r0[:0], roughness[:0], light.prefiltered, light.lut)
    assert empty.shape == (0, 3)


def test_the_chain_look_up_is_that_of_the_reference(light):
    normal, _, _, roughness = points(2000)
    roughness = 1.4 * roughness - 0.2  # beyond both ends as well
    levels = light.roughness_levels
    result = fast.sample_chain(light.chain, levels, normal, roughness)
    assert_allclose(
        result, prefilter.sample_chain(light.chain, levels, normal, roughness), rtol=1e-5, atol=1e-6
    )
    assert_allclose(
        fast.sample_chain(light.chain[:1], [0.0], normal, 0.3), light.env.radiance(normal), rtol=1e-5
    )


@pytest.mark.parametrize("rows", [1, 2, 5, 48])
def test_a_light_of_any_size_is_white_where_the_environment_is(rows):
    white = fast.environment_light(fw.skies.constant(rows, 0.7))
    d = points(100)[0]
    assert_allclose(white.irradiance(d), 0.7, rtol=1e-12)
    assert_allclose(white.prefiltered(d, np.linspace(0, 1, 100)), 0.7, rtol=1e-12)


def test_monte_carlo_means_what_it_says():
    env = fw.skies.gradient(16)
    normal, view, r0, roughness = points(300)
    roughness = 0.2 + 0.8 * roughness
    usable = np.flatnonzero(np.sum(normal * view, axis=1) > 0.2)[:60]
    mean, error = fast.monte_carlo_shade(env, normal, view, r0, roughness**2, 2000, np.random.default_rng(3))
    truth = np.array(
        [
            reflected_radiance(
                lambda d: bilinear(env.pixels, d), normal[i], view[i], r0[i], roughness[i] ** 2, 64, 96
            )[0]
            for i in usable
        ]
    )
    z = (mean[usable] - truth) / error[usable]
    # 60 points in 3 colours that go together: a mean square of 1, to about a fifth.
    assert 0.5 < np.mean(z**2) < 1.6 and np.abs(z).max() < 4.5
    assert (mean[np.sum(normal * view, axis=1) <= 0] == 0).all()


def test_monte_carlo_repeats_itself_for_any_number_of_threads():
    import numba

    env = fw.skies.gradient(8)
    arguments = *points(64)[:3], 0.3, 16
    once = fast.monte_carlo_shade(env, *arguments, np.random.default_rng(5))
    numba.set_num_threads(1)
    try:
        again = fast.monte_carlo_shade(env, *arguments, np.random.default_rng(5))
    finally:
        numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    assert_array_equal(once, again)
    assert not np.array_equal(once[0], fast.monte_carlo_shade(env, *arguments, np.random.default_rng(6))[0])


def test_nothing_is_nan_at_the_edges_of_what_is_allowed(light):
    up = np.array([0.0, 1.0, 0.0])
    cosines = np.array([0.0, 1e-12, 1e-6, 1e-3, 0.5, 1.0])
    view = np.stack([np.sqrt(1 - cosines**2), cosines, 0 * cosines], axis=1)
    for roughness in (0.0, 1e-4, 0.02, 0.045, 1.0):
        shaded = fast.shade_split_sum(up, view, 1.0, roughness, light.prefiltered, light.lut)
        mean, error = fast.monte_carlo_shade(
            light.env, up, view, 1.0, roughness**2, 64, np.random.default_rng(0)
        )
        assert np.isfinite(shaded).all() and np.isfinite(mean).all() and np.isfinite(error).all()
        assert (shaded >= 0).all() and (mean >= 0).all()


def test_directions_of_any_length_are_looked_up_and_those_that_are_not_finite_are_nan():
    env = fw.skies.orientation(8)
    direction = fw.normalize(np.random.default_rng(4).normal(size=(50, 3)))
    expected = fast.sample_chain([env.pixels], [0.0], direction, 0.0)
    for length in (1e-250, 1e-4, 1e5, 1e250):
        assert_allclose(fast.sample_chain([env.pixels], [0.0], length * direction, 0.0), expected, atol=1e-12)
    direction[0], direction[1, 2] = np.nan, np.inf
    found = fast.sample_chain([env.pixels], [0.0], direction, 0.0)
    assert np.isnan(found[:2]).all()
    assert_allclose(found[2:], expected[2:], atol=1e-12)
