"""The truths themselves, against closed forms and against published or independently computed values."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import framework as fw
from solutions.truth import brdf_integral, reflected_radiance
from solutions.truth_maps import bilinear, cosine_weighted_radiance, filtered_radiance, sphere_grid
from solutions.truth_visibility import (
    Solids,
    ambient_visibility,
    diffuse_radiance,
    specular_radiance,
    surface_points,
)

MU = (0.05, 0.1, 0.25, 0.5, 0.75, 1.0)

# Scale and bias by roughness, at the cosines above: a product quadrature with 500 x 500 nodes, spot-checked with
# 2^20 quasi-random visible normals, rounded to five digits.
GGX = {
    0.05: "22789/77075 41013/58954 76273/23722 96872/03127 99901/00098 99999/00000",
    0.10: "24255/73366 41577/57835 76293/23616 96834/03140 99885/00100 99990/00000",
    0.25: "44926/44485 50515/39162 75803/20354 95569/03264 99231/00150 99568/00000",
    0.50: "76882/16431 75193/13969 75925/08083 83492/02235 88881/00272 91578/00003",
    0.75: "83981/06512 79577/05258 71651/02795 65469/00848 63124/00164 62684/00005",
    1.00: "81568/03209 73634/02387 58676/01088 44771/00299 36389/00063 30682/00003",
}
BECKMANN = {
    0.25: "32755/58770 44332/48881 76485/23281 96755/03245 99888/00112 100000/00000",
    0.50: "67018/29191 69852/23660 78218/12298 91457/03198 98736/00338 99999/00000",
    0.75: "85766/11952 85999/09685 85779/05025 84447/01466 84718/00294 89206/00008",
    1.00: "91937/05669 90816/04464 86342/02141 76083/00574 62288/00119 46151/00007",
}


@pytest.mark.parametrize(("ndf", "gold"), [("ggx", GGX), ("beckmann", BECKMANN)])
def test_the_brdf_integral_meets_the_known_values_within_1e_5(ndf, gold):
    for roughness, row in gold.items():
        for mu, pair in zip(MU, row.split(), strict=True):
            expected = [float(number) / 1e5 for number in pair.split("/")]
            assert_allclose(
                brdf_integral(mu, roughness**2, ndf), expected, atol=1e-5, err_msg=f"{roughness} {mu}"
            )


def test_the_brdf_integral_meets_its_closed_forms():
    assert_allclose(brdf_integral(1.0, 1.0).sum(), 1 - np.log(2), atol=1e-12)
    for mu in MU:
        assert_allclose(brdf_integral(mu, 1e-4), [1 - (1 - mu) ** 5, (1 - mu) ** 5], atol=1e-5)


@pytest.mark.parametrize("alpha", [1e-4, 1e-2, 0.3, 1.0])
def test_the_brdf_integral_has_converged_at_any_angle(alpha):
    for mu in (1 / 1024, 1 / 128, 0.1, 0.9):
        assert_allclose(brdf_integral(mu, alpha), brdf_integral(mu, alpha, nodes=300), atol=1e-6)


def test_reflected_radiance_under_a_white_sky_is_the_brdf_integral():
    normal, view = np.array([0, 1.0, 0]), fw.normalize([0.7, 0.4, -0.2])
    for alpha in (0.003, 0.1, 1.0):
        scale, bias = brdf_integral(view[1], alpha)
        mean, variance = reflected_radiance(lambda d: np.full(d.shape, 2.0), normal, view, 0.3, alpha)
        assert_allclose(mean, 2 * (0.3 * scale + bias), rtol=1e-4)
        assert (variance >= 0).all()
    assert reflected_radiance(lambda d: d, normal, -view, 0.3, 0.1)[0].max() == 0


def test_a_map_of_pixel_centres_is_looked_up_where_it_was_sampled():
    direction, solid_angle = sphere_grid(16)
    pixels = np.random.default_rng(1).random((16, 32, 3))
    assert_allclose(bilinear(pixels, direction), pixels, atol=1e-12)
    assert_allclose(solid_angle.sum(), 4 * np.pi)
    env = fw.Environment(pixels)
    assert_allclose(direction, env.directions(), atol=1e-15)
    anywhere = fw.normalize(np.random.default_rng(2).normal(size=(500, 3)))
    assert_allclose(bilinear(pixels, anywhere), env.radiance(anywhere), atol=1e-12)


# How much the lobe shortens a linear map: the first coefficient of the kernel's Legendre series.
@pytest.mark.parametrize(("alpha", "first"), [(1.0, 2 / 3), (0.25, 0.8674), (0.16, 0.9182), (0.09, 0.9603)])
def test_filtering_shortens_a_linear_map_by_the_known_factor(alpha, first):
    direction, _ = sphere_grid(128)
    towards = fw.normalize([[0.2, 0.5, -0.4], [0, 1, 0], [0.3, -0.9, 0.1]])
    filtered = filtered_radiance(1 + direction, towards, alpha)
    assert_allclose(filtered, 1 + first * towards, atol=3e-4)


def test_the_roughest_lobe_is_the_clamped_cosine():
    pixels, normal = np.random.default_rng(3).random((16, 32, 3)), fw.normalize([[1, 2, 3], [0, -1, 0.1]])
    assert_allclose(
        filtered_radiance(pixels, normal, 1.0), cosine_weighted_radiance(pixels, normal), rtol=1e-12
    )


def test_a_narrow_lobe_returns_the_bilinear_map():
    pixels, d = 1 + np.random.default_rng(4).random((8, 16, 3)), fw.normalize([[0.3, 0.4, 0.5]])
    assert_allclose(filtered_radiance(pixels, d, 0.01, oversample=48), bilinear(pixels, d), rtol=2e-2)


def test_a_ball_over_a_floor_hides_the_sine_squared_of_its_radius():
    # From the point below it, a ball of radius r at distance d covers sin^2 = (r / d)^2 of the cosine-weighted sky.
    solids = Solids(spheres=(((0, 2.0, 0), 0.8),))
    seen = ambient_visibility(solids, np.zeros((1, 3)), np.array([[0, 1.0, 0]]), 10.0)
    assert_allclose(seen, 1 - 0.16, atol=2e-3)


def test_a_box_hides_what_it_shadows_and_only_within_reach():
    solids = Solids(boxes=(((0, 2.0, 0), (5.0, 0.1, 5.0)),), ground=None)
    up, p = np.array([[0, 1.0, 0], [1.0, 0, 0]]), np.zeros((2, 3))
    assert list(solids.blocked(p, up, 10.0)) == [True, False]
    assert list(solids.blocked(p, up, 1.8)) == [False, False]
    assert list(solids.blocked(p + [0, 2.05, 0], up, 10.0)) == [True, True]


def test_shadowed_light_without_solids_is_unshadowed_light():
    env, nothing = fw.skies.gradient(8), Solids(ground=None)
    p, n, v = np.zeros((1, 3)), np.array([[0, 1.0, 0]]), fw.normalize([[0.5, 1, 0]])
    mean = cosine_weighted_radiance(env.pixels, n, oversample=4)
    assert_allclose(diffuse_radiance(nothing, env, p, n, 0.5, 9.0), 0.5 * mean, rtol=2e-3)
    expected, _ = reflected_radiance(lambda d: bilinear(env.pixels, d), n[0], v[0], 0.1, 0.16)
    assert_allclose(specular_radiance(nothing, env, p, n, v, 0.1, 0.4, 9.0)[0], expected, rtol=2e-3)


def test_cast_points_lie_on_the_distance_field():
    solids = Solids(spheres=(((-1, 0.5, 0), 0.5),), boxes=(((1, 0.5, 0), (0.4, 0.5, 0.3)),))
    camera = fw.Camera((1, 2, 4), (0, 0.3, 0), (0, 1, 0), 0.7)
    p, n, v = surface_points(solids, camera, 16, 12)
    assert len(p) > 150
    assert np.abs(solids.sdf()(p)).max() < 1e-5
    assert (np.sum(n * v, axis=1) > 0).all()
