"""The reference of split_sum against closed forms and quadrature."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from solutions.split_sum import (
    brdf_lut,
    fresnel_schlick,
    masking_shadowing,
    microfacet_brdf,
    monte_carlo_shade,
    ndf_beckmann,
    ndf_ggx,
    r0_from_ior,
    sample_lut,
    shade_split_sum,
)
from solutions.truth import brdf_integral, reflected_radiance
from solutions.truth_maps import sphere_grid


def units(seed, count):
    return fw.normalize(np.random.default_rng(seed).normal(size=(count, 3)))


def upper_units(seed, count, normal):
    d = units(seed, count)
    return d * np.where(np.sum(d * normal, axis=-1, keepdims=True) < 0, -1.0, 1.0)


def test_schlick_runs_from_r0_to_one_and_stays_there():
    assert_allclose(fresnel_schlick(0.04, [1.0, 0.5, 0.0]), [0.04, 0.04 + 0.96 / 32, 1.0])
    assert_allclose(fresnel_schlick(0.04, [1 + 1e-9, -1e-9]), [0.04, 1.0])
    assert fresnel_schlick(np.ones(3), np.zeros((5, 1))).shape == (5, 3)


def test_r0_of_glass_and_of_nothing():
    assert_allclose(r0_from_ior(1.0, 1.5), 0.04)
    assert_allclose(r0_from_ior([1.5, 1.0], [1.0, 1.0]), [0.04, 0.0])


@pytest.mark.parametrize("ndf", [ndf_beckmann, ndf_ggx])
@pytest.mark.parametrize("alpha", [1e-4, 1e-3, 0.01, 0.3, 1.0])
def test_the_projected_normals_cover_the_surface_once(ndf, alpha):
    # Even steps in the logarithm of the tangent; what is left out at both ends is below 1e-8.
    tan = alpha * np.logspace(-6, 6, 40001)
    theta = np.arctan(tan)
    integrand = ndf(np.cos(theta), alpha) * np.cos(theta) * 2 * np.pi * np.sin(theta)
    covered = np.sum(0.5 * (integrand[1:] + integrand[:-1]) * np.diff(theta))
    # The cosine's own rounding, 1e-16, is a part of alpha^2.
    assert_allclose(covered, 1.0, atol=1e-5 + 1e-12 / alpha**2)


@pytest.mark.parametrize("ndf", [ndf_beckmann, ndf_ggx])
def test_a_distribution_peaks_at_its_closed_form_and_ends_at_the_horizon(ndf):
    assert_allclose(ndf(1.0, np.array([1e-4, 0.1, 1.0])), 1 / (np.pi * np.array([1e-4, 0.1, 1.0]) ** 2))
    assert_array_equal(ndf(np.array([0.0, -0.5, -1.0]), 0.3), 0.0)
    assert np.isfinite(ndf(np.array([1e-300, 1e-30, 1e-8]), np.array([1e-4, 1e-4, 1.0]))).all()


def test_masking_is_one_straight_above_zero_at_the_horizon_and_symmetric():
    assert masking_shadowing(1.0, 1.0, 0.7) == 1.0
    assert_array_equal(masking_shadowing(np.array([0.0, -0.1, 0.5]), np.array([0.5, 0.5, 0.0]), 0.5), 0.0)
    i, o = np.random.default_rng(1).random((2, 100))
    both = masking_shadowing(i, o, 0.5)
    assert_allclose(both, masking_shadowing(o, i, 0.5))
    assert (both >= 0).all() and (both <= 1).all()
    # The height-correlated form, from its definition by Lambda.
    lam = [(np.sqrt(1 + 0.25 * (1 / c**2 - 1)) - 1) / 2 for c in (i, o)]
    assert_allclose(both, 1 / (1 + lam[0] + lam[1]), rtol=1e-10)


def test_the_brdf_is_reciprocal_and_dark_below_the_horizon():
    n = units(0, 200)
    v, l = upper_units(1, 200, n), upper_units(2, 200, n)
    f = microfacet_brdf(n, v, l, 0.04, 0.2)
    assert_allclose(f, microfacet_brdf(n, l, v, 0.04, 0.2), rtol=1e-9)
    assert (f > 0).all()
    for view, light in ((-v, l), (v, -l), (v, -v)):
        assert_array_equal(microfacet_brdf(n, view, light, 0.04, 0.2), 0.0)


@pytest.mark.parametrize("mu", [0.2, 0.9])
def test_the_brdf_reflects_under_a_white_sky_what_quadrature_says(mu):
    l, solid_angle = sphere_grid(256)
    n, v, r0 = np.array([0, 1.0, 0]), np.array([np.sqrt(1 - mu * mu), mu, 0]), np.array([0.0, 0.5, 1.0])
    f = microfacet_brdf(n, v, l, r0, 0.25)
    scale, bias = brdf_integral(mu, 0.25)
    reflected = np.einsum("hwk,hw->k", f, np.maximum(l[..., 1], 0) * solid_angle)
    assert_allclose(reflected, r0 * scale + bias, rtol=1e-3)


def test_the_brdf_takes_every_shape_that_it_promises():
    n = units(0, 7)
    v, l = upper_units(1, 7, n), upper_units(2, 7, n)
    each = microfacet_brdf(n, v, l, [0.1, 0.2, 0.3], 0.3)
    assert_allclose(microfacet_brdf(n, v, l, np.tile([0.1, 0.2, 0.3], (7, 1)), np.full(7, 0.3)), each)
    assert_allclose(microfacet_brdf(n[2], v[2], l[2], [0.1, 0.2, 0.3], 0.3), each[2])
    assert microfacet_brdf(n, v, l[0], 0.1, 0.3).shape == (7, 3)
    assert microfacet_brdf(n[:0], v[:0], l[:0], np.zeros((0, 3)), np.zeros(0)).shape == (0, 3)


def test_the_brdf_keeps_narrow_peaks_of_single_precision_vectors():
    n = units(0, 500)
    v = upper_units(1, 500, n)
    v = fw.normalize(v + 0.5 * n)  # not at grazing angles, where the peak itself is infinitely steep
    l = fw.normalize(fw.reflect(v, n) + 1e-3 * units(2, 500))
    single = microfacet_brdf(*(a.astype(np.float32) for a in (n, v, l)), 0.04, 0.002)
    double = microfacet_brdf(n, v, l, 0.04, 0.002)
    assert_allclose(single, double, rtol=2e-3)


def test_the_brdf_is_finite_at_the_ends():
    n, up = np.array([[0, 0, 1.0]]), 1e-160
    grazing = np.array([[1.0, 0, up]])
    for alpha in (1e-4, 1.0):
        for v, l in ((n, n), (grazing, grazing), (grazing, grazing * [-1, 1, 1]), (n, grazing)):
            assert np.isfinite(microfacet_brdf(n, v, l, 0.04, alpha)).all()


def clamped_sky():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        env = fw.Environment.load(Path(fw.__file__).parent / "data" / "sky_512x256.exr")
    return fw.Environment(np.minimum(env.pixels, 50.0))


def z_scores(env, count, rows, columns, seeds=64, samples=256):
    """Means over 64 seeds against quadrature, in standard errors that quadrature gives too."""
    rng = np.random.default_rng(5)
    n, v = fw.normalize(rng.normal(size=(2, 64, 3)))
    v *= np.sign(np.sum(n * v, axis=1, keepdims=True))
    r0, alpha = rng.uniform(0.02, 1, (64, 3)), 10 ** rng.uniform(-2.5, 0, 64)
    n, v, r0, alpha = (a[:count] for a in (n, v, r0, alpha))
    found = np.mean(
        [monte_carlo_shade(env, n, v, r0, alpha, samples, np.random.default_rng(s)) for s in range(seeds)],
        axis=0,
    )
    each = [
        reflected_radiance(env.radiance, *one, rows, columns) for one in zip(n, v, r0, alpha, strict=True)
    ]
    mean, variance = np.swapaxes(each, 0, 1)
    return (found - mean) / np.sqrt(variance / (seeds * samples))


def test_monte_carlo_is_unbiased_under_a_real_sky():
    z = z_scores(clamped_sky(), 12, 160, 320)
    assert np.abs(z).max() < 4.5
    assert 0.4 < (z**2).mean() < 2.0


@pytest.mark.drill
def test_monte_carlo_is_unbiased_at_64_random_set_ups():
    z = z_scores(clamped_sky(), 64, 256, 512)
    assert np.abs(z).max() < 4.5
    assert 0.7 < (z**2).mean() < 1.4


@pytest.mark.parametrize(("mu", "alpha"), [(0.05, 1.0), (0.3, 0.5), (0.8, 0.02), (1.0, 1.0)])
def test_monte_carlo_under_a_white_sky_is_the_brdf_integral(mu, alpha):
    n, v = np.array([0, 0, 1.0]), np.array([np.sqrt(1 - mu * mu), 0, mu])
    env, r0 = fw.skies.constant(4), np.array([0.0, 0.5, 1.0])
    found = monte_carlo_shade(env, n, v, r0, alpha, 400_000, np.random.default_rng(1))
    scale, bias = brdf_integral(mu, alpha)
    # No weight exceeds 1: the standard error is below 0.5 / sqrt(400 000).
    assert_allclose(found, r0 * scale + bias, atol=4.5 * 0.5 / np.sqrt(400_000))


def test_monte_carlo_depends_on_nothing_but_its_generator():
    env, n = fw.skies.gradient(8), units(0, 600)
    v = upper_units(1, 600, n)
    first = monte_carlo_shade(env, n, v, 0.5, 0.3, 200, np.random.default_rng(1))
    assert_array_equal(first, monte_carlo_shade(env, n, v, 0.5, 0.3, 200, np.random.default_rng(1)))
    assert (first != monte_carlo_shade(env, n, v, 0.5, 0.3, 200, np.random.default_rng(2))).any()


def test_monte_carlo_is_dark_where_the_view_is_below_the_horizon_and_takes_no_points():
    env, n, rng = fw.skies.constant(4), units(0, 5), np.random.default_rng(0)
    assert_array_equal(monte_carlo_shade(env, n, -n, 0.5, 0.3, 8, rng), 0.0)
    assert monte_carlo_shade(env, n[:0], n[:0], 0.5, 0.3, 8, rng).shape == (0, 3)
    assert_allclose(monte_carlo_shade(env, n[0], n[0], 1.0, 1e-4, 64, rng), 1.0, rtol=1e-6)


def test_the_lut_is_within_2e_3_of_quadrature_everywhere():
    lut = brdf_lut(64, 1024)
    centers = (np.arange(64) + 0.5) / 64
    truth = [[brdf_integral(mu, roughness**2, nodes=32) for mu in centers] for roughness in centers]
    assert_allclose(lut, truth, atol=2e-3)
    assert lut.sum(axis=-1).max() <= 1 + 1e-9


def test_a_lut_has_roughness_along_its_rows_and_the_cosine_along_its_columns():
    lut = brdf_lut(48, 256)
    assert_allclose(lut[0, -1], [1, 0], atol=5e-3)  # smooth, from above
    assert_allclose(lut[-1, -1], [0.31, 0], atol=2e-2)  # rough, from above
    assert lut[0, 0, 1] > 0.9 and lut[0, 0, 0] < 0.1  # smooth, grazing
    assert lut[-1, 0, 0] > 0.8 and lut[-1, 0, 1] < 0.06  # rough, grazing
    assert brdf_lut(1, 1).shape == (1, 1, 2)


def test_a_lut_is_linear_between_centres_and_level_beyond_them():
    centers = (np.arange(5) + 0.5) / 5
    lut = np.stack(
        np.meshgrid(3 * centers, 2 * centers), axis=-1
    )  # the cosine by columns, the roughness by rows
    cosine, roughness = np.random.default_rng(0).random((2, 50))
    inside = np.clip([cosine, roughness], 0.1, 0.9)
    assert_allclose(sample_lut(lut, cosine, roughness), (inside * [[3], [2]]).T)
    assert_allclose(sample_lut(lut, -1.0, 2.0), [0.3, 1.8])
    assert sample_lut(lut, np.zeros((4, 1)), np.zeros(3)).shape == (4, 3, 2)
    assert sample_lut(lut[:1, :1], np.zeros(0), 0.5).shape == (0, 2)


def test_the_split_sum_is_exact_under_a_constant_sky():
    lut, n = brdf_lut(32, 256), units(0, 20)
    v, roughness = upper_units(1, 20, n), np.linspace(0, 1, 20)
    r0 = np.random.default_rng(2).random((20, 3))
    found = shade_split_sum(n, v, r0, roughness, lambda d, r: np.full(d.shape, 2.0), lut)
    scale, bias = sample_lut(lut, np.sum(n * v, axis=1), roughness).T[..., None]
    assert_allclose(found, 2 * (r0 * scale + bias))


def test_the_split_sum_looks_along_the_mirror_direction_and_only_where_it_is_seen():
    asked = []

    def prefiltered(direction, roughness):
        asked.append((direction, roughness))
        return np.ones_like(direction)

    n, v = np.tile([0, 1.0, 0], (3, 1)), fw.normalize([[1, 1, 0], [1, -1, 0], [0, 0, 1]])
    color = shade_split_sum(n, v, [1, 0.5, 0], 0.5, prefiltered, brdf_lut(8, 16))
    ((direction, roughness),) = asked
    assert_allclose(direction, fw.normalize([[-1, 1, 0]]), atol=1e-15)
    assert_array_equal(roughness, [0.5])
    assert (color[0] > 0).all() and (color[1:] == 0).all()
    assert shade_split_sum(n[:0], v[:0], 0.5, 0.5, prefiltered, brdf_lut(8, 16)).shape == (0, 3)


def test_inputs_stay_as_they_are():
    n = units(0, 9)
    given = [n, upper_units(1, 9, n), np.full((9, 3), 0.5), np.full(9, 0.3)]
    for array in given:
        array.setflags(write=False)
    env, rng, lut = fw.skies.constant(4), np.random.default_rng(0), brdf_lut(4, 16)
    lut.setflags(write=False)
    microfacet_brdf(given[0], given[1], given[1], *given[2:])
    monte_carlo_shade(env, *given, 4, rng)
    shade_split_sum(*given, lambda d, r: np.ones_like(d), lut)
