"""Daylight on distance fields: what the light and the colours do to known pixels."""

import numpy as np

import framework as fw
from solutions.daylight import daylight, part_colors

CAMERA = fw.Camera((0, 4, 4), (0, 0, 0), (0, 1, 0), 0.5)
FLOOR, BALL = fw.sdf.plane((0, 1, 0), 0.0), fw.sdf.sphere((0, 0.5, 0), 0.4)


def test_a_wider_sun_blurs_the_shadow_and_leaves_the_lit_floor():
    scene = fw.sdf.union(FLOOR, BALL)
    hard, soft = (daylight(scene, CAMERA, 64, k, (1, 1, 1)) for k in (100, 2))
    assert hard.shape == (64, 64, 3) and hard.min() >= 0 and hard.max() <= 1
    assert np.abs(np.diff(hard, axis=1)).max() > np.abs(np.diff(soft, axis=1)).max() * 0.99
    assert soft.mean() < hard.mean() and np.allclose(soft[-1, 0], hard[-1, 0])


def test_each_pixel_takes_the_colour_of_the_nearest_part():
    paint = part_colors([FLOOR, BALL], [(0, 1, 0), (1, 0, 0)], CAMERA, 32)
    assert paint.shape == (64, 64, 3)
    assert (paint[32, 32] == [1, 0, 0]).all() and (paint[0, 0] == [0, 1, 0]).all()
