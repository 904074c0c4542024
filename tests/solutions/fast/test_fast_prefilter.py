"""Exact prefiltering against float64 sums over all of the map, and against what symmetry demands."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import framework as fw
from framework.environment import pixel_directions
from framework.metrics import relmse
from solutions.fast import irradiance, prefilter_chain
from solutions.truth_maps import bilinear, cosine_weighted_radiance, filtered_radiance, sphere_grid
from tests.solutions.fast.whole_maps import filtered_maps

ROOT = Path(__file__).resolve().parents[3]
MAPS = {
    "studio": ROOT.parent / "shared/data/hdri/studio_1024x512.exr",
    "sky": ROOT / "framework/data/sky_512x256.exr",
}
WIDTHS = [0.0, 1e-4, 0.003, 0.02, 0.05, 0.06, 0.2, 0.7, 1.0]


# Their truth takes half a minute.
NARROW = [pytest.param(alpha, marks=pytest.mark.drill) for alpha in (0.003, 0.01)]


def filtered(env, alpha, height):
    return prefilter_chain(env, [np.sqrt(alpha)], [height])[0]


def sunny(height, row=3, column=5):
    """A sky with a sun of 60000 in one texel."""
    pixels = fw.skies.gradient(height).pixels.copy()
    pixels[row, column] = 60000.0
    return fw.Environment(pixels)


@pytest.mark.parametrize("alpha", WIDTHS)
@pytest.mark.parametrize("height", [1, 2, 7, 33])
def test_a_white_map_stays_white(alpha, height):
    for rows in (1, 5, 48):
        assert_allclose(filtered(fw.skies.constant(rows, 0.7), alpha, height), 0.7, rtol=1e-12)


@pytest.mark.parametrize("alpha", [*NARROW, 0.02, 0.0599, 0.06, 0.15, 1.0])
def test_every_width_meets_full_quadrature_with_a_sun_in_one_texel(alpha):
    env = sunny(32)
    result = filtered(env, alpha, 16).reshape(-1, 3)
    directions = pixel_directions(16).reshape(-1, 3)
    toward = directions @ env.directions()[3, 5]
    # All near the sun, where the lobe is hardest to follow, and every ninth elsewhere.
    some = np.unique(np.concatenate([np.argsort(-toward)[:16], np.arange(0, 512, 9)]))
    oversample = min(int(np.ceil(0.1 / (0.7 * alpha))) + 4, 48)
    truth = filtered_radiance(env.pixels, directions[some], alpha, oversample)
    assert relmse(result[some], truth) < 1e-4


def test_width_1_is_irradiance():
    env = sunny(24)
    truth = cosine_weighted_radiance(env.pixels, pixel_directions(12), oversample=8)
    assert relmse(irradiance(env, 12), truth) < 1e-4
    assert_allclose(filtered(env, 1.0, 12), irradiance(env, 12), rtol=1e-12)


@pytest.mark.parametrize("height", [4, 16, 40])
def test_width_0_looks_the_map_up(height):
    env = sunny(16)
    assert_allclose(filtered(env, 0.0, height), env.radiance(pixel_directions(height)), rtol=1e-14)
    # And is where narrow lobes end; beside a sun the tail of any lobe shows.
    sky = fw.skies.gradient(16)
    assert relmse(filtered(sky, 1e-4, height), sky.radiance(pixel_directions(height))) < 1e-6


@pytest.mark.parametrize("alpha", WIDTHS)
def test_turning_the_map_turns_the_result(alpha):
    env = sunny(12)
    turned = fw.Environment(np.roll(env.pixels, 6, axis=1))
    result = filtered(env, alpha, 12)
    assert_allclose(filtered(turned, alpha, 12), np.roll(result, 6, axis=1), rtol=1e-9)
    # Upside down as well: no pole is special, and the seam is nowhere.
    flipped = fw.Environment(env.pixels[::-1])
    assert_allclose(filtered(flipped, alpha, 12), result[::-1], rtol=1e-9)


@pytest.mark.parametrize("alpha", WIDTHS)
@pytest.mark.parametrize("row", [0, 6])
def test_no_light_is_negative_around_a_sun_in_the_dark(alpha, row):
    result = filtered(fw.skies.single_texel(13, row=row), alpha, 10)
    assert np.isfinite(result).all() and result.min() >= 0 and result.max() > 0


@pytest.mark.parametrize("alpha", WIDTHS)
def test_a_map_of_one_row_is_filtered(alpha):
    env = fw.Environment([[[1.0, 2, 3], [3, 2, 1]]])
    result = filtered(env, alpha, 6)
    assert_allclose(result.mean(axis=(0, 1)), 2.0, rtol=1e-12)
    assert ((result >= 1 - 1e-9) & (result <= 3 + 1e-9)).all()


def test_filtering_keeps_the_light_of_the_whole_map():
    env = sunny(48)
    around, solid_angles = sphere_grid(48 * 8)
    total = (bilinear(env.pixels, around) * solid_angles[..., None]).sum(axis=(0, 1))
    for alpha, height in ((0.04, 96), (0.2, 96), (1.0, 64)):
        weighted = filtered(env, alpha, height) * fw.environment.pixel_solid_angles(height)[..., None]
        assert_allclose(weighted.sum(axis=(0, 1)), total, rtol=1e-3)


@pytest.mark.parametrize(
    ("levels", "heights", "message"),
    [([0.5], [8, 8], "heights"), ([1.5], [8], "roughness_levels"), ([np.nan], [8], "roughness_levels"),
     ([0.5], [0], "heights"), ([0.5], [2.5], "heights")],
)  # fmt: skip
def test_bad_levels_are_refused_by_name(levels, heights, message):
    with pytest.raises(ValueError, match=message):
        prefilter_chain(fw.skies.constant(4), levels, heights)
    assert prefilter_chain(fw.skies.constant(4), [], []) == []


@pytest.mark.drill
def test_seven_levels_of_real_maps_meet_full_quadrature_at_every_pixel(capsys):
    skies = {"sun of 60000 in a texel": sunny(512, row=135, column=170)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # lossy files ring below zero
        skies |= {name: fw.Environment.load(path) for name, path in MAPS.items() if path.exists()}
    roughness, heights = np.arange(7) / 6, [256, 128, 64, 64, 32, 32, 32]
    chains = {name: prefilter_chain(env, roughness, heights) for name, env in skies.items()}
    for name, env in skies.items():
        assert_allclose(chains[name][0], env.radiance(pixel_directions(256)), rtol=1e-12)
    # The smaller map at the others' size: four parts of a pixel, each with the interpolant's value.
    finest = np.stack([env.radiance(pixel_directions(512)) if env.height < 512 else env.pixels for env in skies.values()])
    errors = {name: [] for name in skies}
    for i, (r, height) in enumerate(zip(roughness[1:], heights[1:], strict=True), start=1):
        truth = filtered_maps(finest, r * r, height, parts=2 if r < 0.5 else 1)
        for name, true in zip(skies, truth, strict=True):
            errors[name].append(relmse(chains[name][i], true))
        if i == 1:  # finer parts, in the narrowest lobe, in the rows of the sun and of the poles
            some = slice(0, None, 33)
            finer = filtered_maps(finest, r * r, height, parts=6, rows=some)
            own = [relmse(one[some], other) for one, other in zip(truth, finer, strict=True)]
    with capsys.disabled():
        print("\nrelMSE over all pixels at roughness 1/6, 2/6, ... 1, and the truth's own at 1/6:")
        for (name, found), doubt in zip(errors.items(), own, strict=True):
            print(f"{name:24}", *(f"{error:.1e}" for error in found), f"({doubt:.0e})")
    assert max(max(found) for found in errors.values()) < 1e-4
    assert max(own) < 2e-6
