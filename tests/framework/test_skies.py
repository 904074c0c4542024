"""Made environments: their energy, at any height."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework import skies

BLACK = dict(zenith=(0, 0, 0), horizon=(0, 0, 0), ground=(0, 0, 0))
MADE = [
    skies.constant,
    skies.gradient,
    skies.sun_and_sky,
    skies.studio,
    skies.orientation,
    skies.single_texel,
]


@pytest.mark.parametrize("make", MADE)
@pytest.mark.parametrize("height", [1, 2, 7, 33])
def test_any_height_gives_the_same_finite_map_each_time(make, height):
    one = make(height)
    assert (
        one.pixels.shape == (height, 2 * height, 3)
        and one.pixels.min() >= 0
        and np.isfinite(one.pixels).all()
    )
    assert_array_equal(one.pixels, make(height).pixels)


@pytest.mark.parametrize("height", [4, 16, 63, 256])
@pytest.mark.parametrize("radius", [0.00465, 0.1, 0.8])
def test_the_sun_has_the_energy_of_its_disc_at_every_height(height, radius):
    env = skies.sun_and_sky(
        height, to_sun=(0.3, 0.9, -0.2), angular_radius=radius, sun_radiance=60000.0, **BLACK
    )
    energy = np.sum(env.pixels[..., 0] * env.solid_angles())
    assert_allclose(energy, 60000 * 2 * np.pi * (1 - np.cos(radius)), rtol=1e-9)
    centroid = np.einsum("hw,hwk->k", env.pixels[..., 1] * env.solid_angles(), env.directions())
    off = np.linalg.norm(np.cross(fw.normalize(centroid), fw.normalize([0.3, 0.9, -0.2])))
    pixel = np.pi / height
    # A disc of many pixels is where it should be, one within a pixel is in the nearest.
    assert off < (0.02 if radius > pixel else 0.75) * pixel


def test_a_single_texel_is_one_pixel():
    env = skies.single_texel(8, 2, 3, 60000)
    assert (env.pixels[..., 0] > 0).sum() == 1 and env.pixels[2, 3, 0] == 60000
    with pytest.raises(ValueError, match="outside"):
        skies.single_texel(8, 8, 0)


def test_a_gradient_is_continuous_across_the_horizon():
    env = skies.gradient(512)
    assert np.abs(np.diff(env.pixels, axis=0)).max() < 0.05


@pytest.mark.parametrize("height", [0, 2.5, -1])
def test_odd_heights_are_refused(height):
    with pytest.raises(ValueError, match="whole number"):
        skies.constant(height)
