import subprocess
import sys
import time

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from framework import colors
from framework.comparison import comparison_images
from framework.comparison import value_range as shown_range

MAGENTA, GREY = colors.NAN_COLOR, colors.BACKGROUND


def waves(shape=(24, 32), seed=0):
    return np.random.default_rng(seed).uniform(-1, 1, shape)


def luminance(rgb):
    linear = (np.asarray(rgb) / 255.0) ** 2.2
    return linear @ [0.2126, 0.7152, 0.0722]


@pytest.mark.parametrize(
    ("kind", "image"),
    [
        ("distance", waves()),
        ("scalar", waves() + 5),
        ("color", waves((24, 32, 3)) ** 2),
        ("mask", waves() > 0),
    ],
)
def test_equal_images_look_alike_and_have_no_difference(kind, image):
    shown = comparison_images(image, image, kind)
    assert_array_equal(shown.yours, shown.expected)
    assert shown.caption == "No difference."
    for picture in (shown.yours, shown.expected, shown.difference):
        assert picture.shape == (24, 32, 3) and picture.dtype == np.uint8
    if kind != "mask":
        assert (shown.difference == 247).all()


def test_the_difference_says_which_side_an_answer_is_wrong_on():
    expected = np.linspace(0, 1, 64).reshape(8, 8)
    error = np.zeros((8, 8))
    error[0], error[1] = 0.1, -0.1
    shown = comparison_images(expected + error, expected, "scalar")
    assert shown.scale == 0.1
    assert_array_equal(shown.difference[0, 0], colors.SIGNED_ERROR[-1])
    assert_array_equal(shown.difference[1, 0], colors.SIGNED_ERROR[0])
    assert (shown.difference[2:] == 247).all()
    assert shown.caption == "Largest difference 0.1, mean 0.025; colours end at ±0.1."


def test_colors_differ_by_their_worst_channel():
    expected = np.full((8, 8, 3), 0.5)
    yours = expected.copy()
    yours[2, 3] += [0.0, -0.2, 0.1]
    shown = comparison_images(yours, expected, "color")
    assert "Largest difference 0.2" in shown.caption
    assert (shown.difference[2, 3] != 247).any() and (np.delete(shown.difference, 2, axis=0) == 247).all()


def test_masks_tell_surplus_from_missing():
    expected = np.zeros((4, 4), bool)
    expected[:2] = True
    yours = np.roll(expected, 1, axis=0)
    shown = comparison_images(yours, expected, "mask")
    assert_array_equal(shown.difference[2, 0], colors.MASK[2])
    assert_array_equal(shown.difference[0, 0], colors.MASK[3])
    assert shown.caption == (
        "8 of 16 pixels differ: 4 true only in yours (orange), 4 only in expected (blue)."
    )


def test_where_masks_agree_their_difference_is_plain_whatever_they_show():
    mask = np.eye(5, dtype=bool)
    shown = comparison_images(mask, mask, "mask")
    assert shown.caption == "No difference."
    assert np.ptp(shown.difference.reshape(-1, 3), axis=0).max() == 0 < np.ptp(shown.yours)


@pytest.mark.parametrize("kind", ["distance", "scalar"])
def test_nan_is_magenta_and_infinity_background_in_every_picture(kind):
    expected = waves() + 2 * (kind == "scalar")
    yours = expected + 0.01
    yours[0, 0], yours[0, 1], expected[0, 2] = np.nan, np.inf, np.inf
    yours[1], expected[1] = np.inf, np.inf
    shown = comparison_images(yours, expected, kind)
    assert_array_equal(shown.yours[0, 0], MAGENTA)
    assert_array_equal(shown.difference[0, 0], MAGENTA)
    for picture in (shown.yours, shown.expected, shown.difference):
        assert (picture[1] == GREY).all()
    assert_array_equal(shown.yours[0, 1], GREY)
    assert_array_equal(shown.difference[0, 1], colors.SIGNED_ERROR[-1])
    assert_array_equal(shown.difference[0, 2], colors.SIGNED_ERROR[0])
    assert "1 of 768 pixels are NaN in yours (magenta)" in shown.caption
    assert "1 of 768 pixels are infinite in yours alone" in shown.caption
    assert "1 of 768 pixels are finite in yours where infinity is expected" in shown.caption


def test_colors_with_nan_or_infinity_are_marked():
    expected = np.full((4, 4, 3), 0.5)
    yours = expected.copy()
    yours[0, 0, 1], yours[0, 1, 2] = np.nan, np.inf
    shown = comparison_images(yours, expected, "color")
    assert_array_equal(shown.yours[0, 0], MAGENTA)
    assert_array_equal(shown.yours[0, 1], GREY)
    assert_array_equal(shown.difference[0, 0], MAGENTA)
    assert_array_equal(shown.difference[0, 1], colors.ERROR[-1])


def test_colours_do_not_depend_on_the_answer():
    expected = waves()
    assert_array_equal(
        comparison_images(expected * 1.1, expected, "distance").expected,
        comparison_images(expected * 99, expected, "distance").expected,
    )


def test_float32_rounding_stays_invisible_and_single_outliers_do_not_set_the_scale():
    expected = waves((64, 64))
    assert (comparison_images(expected.astype(np.float32), expected, "distance").difference >= 240).all()
    yours = expected + np.where(np.arange(4096).reshape(64, 64) % 2, 0.01, -0.01)
    yours[5, 5] += 1e6
    assert comparison_images(yours, expected, "distance").scale == 0.01


def test_the_surface_is_a_dark_line_between_blue_inside_and_orange_outside():
    x = np.linspace(-1, 1, 129)
    rgb = colors.from_distance(np.broadcast_to(x, (129, 129)), 1.0, 0.25).astype(int)
    red_over_blue = rgb[64, :, 0] - rgb[64, :, 2]
    assert (red_over_blue[:60] < -20).all() and (red_over_blue[69:] > 20).all()
    assert luminance(rgb[64, 64]) < 0.03
    # A contour line at each quarter, darker than its neighbours two pixels away.
    for column in (16, 32, 48, 80, 96, 112):
        assert luminance(rgb[64, column]) < 0.9 * min(luminance(rgb[64, column + d]) for d in (-2, 2))


def test_brightness_grows_along_the_scalar_colours_and_away_from_no_error():
    assert (np.diff(luminance(colors.SEQUENTIAL)) > -1e-3).all()
    assert (np.diff(luminance(colors.ERROR)) < 2e-3).all()
    for half in (luminance(colors.SIGNED_ERROR[:128]), luminance(colors.SIGNED_ERROR[:126:-1])):
        assert (np.diff(half) > -1e-3).all()


@pytest.mark.parametrize(("factor", "scaled"), [(0.5, 0.5), (30.0, 1.0), (0.01, 1.0)])
def test_exposure_brings_images_into_range_and_leaves_those_that_are(factor, scaled):
    image = np.full((8, 8, 3), factor)
    assert_allclose(image * colors.exposure_for(image), scaled)


def test_srgb_encoding_of_middle_grey():
    # 0.21586 is the linear value of 128 / 255 (IEC 61966-2-1).
    rgb = colors.from_radiance(np.array([[[0.0, 0.21586, 1.0]]]), 1.0)
    assert_array_equal(rgb[0, 0], [0, 128, 255])


@pytest.mark.parametrize(
    ("value", "rounded"),
    [(1, 1), (1.0000000000001, 1), (1.5, 2), (3, 5), (7, 10), (0.02, 0.02), (0.021, 0.05), (1e-300, 1e-300)],
)
def test_scales_are_round(value, rounded):
    assert_allclose(colors.round_up(value), rounded, rtol=1e-12)


@pytest.mark.parametrize(
    "values",
    [
        np.zeros((3, 3)),
        np.full((3, 3), 7.0),
        np.full((3, 3), -7.0),
        np.full((3, 3), np.nan),
        np.full((3, 3), np.inf),
        np.array([[5e-324]]),
        np.array([[-1.7e308, 1.7e308]]),
        np.array([[1.0, 1e-200, -1e200]]),
    ],
)
@pytest.mark.parametrize("kind", ["distance", "scalar", "color"])
def test_extreme_images_make_pictures_without_a_warning(values, kind):
    image = np.repeat(values[..., None], 3, axis=2) if kind == "color" else values
    other = np.where(np.isfinite(image), -image, 1.0)
    for yours, expected in [(image, image), (image, other), (other, image)]:
        shown = comparison_images(yours, expected, kind)
        assert shown.difference.shape == values.shape + (3,)
        assert np.isfinite([shown.low, shown.high, shown.scale]).all() and shown.low < shown.high


def test_ranges_start_at_zero_where_that_costs_little():
    assert shown_range(np.array([0.1, 1.0]), "scalar") == (0.0, 1.0)
    assert shown_range(np.array([4.0, 6.0]), "scalar") == (4.0, 6.0)
    assert shown_range(np.array([-1.0, 3.0]), "distance") == (-3.0, 3.0)


@pytest.mark.parametrize(
    ("yours", "expected", "kind", "words"),
    [
        (np.zeros((2, 3)), np.zeros((3, 2)), "scalar", r"yours has shape \(2, 3\), expected \(3, 2\)"),
        (np.zeros((2, 3)), np.zeros((2, 3)), "color", r"\(H, W, 3\) is wanted for 'color'"),
        (np.zeros((2, 2, 3)), np.zeros((2, 2, 3)), "scalar", r"\(H, W\) is wanted for 'scalar'"),
        (np.zeros((0, 3)), np.zeros((0, 3)), "mask", r"shape \(0, 3\)"),
        (
            np.zeros((2, 3)),
            np.zeros((2, 3)),
            "colour",
            "kind is 'colour'; one of distance, scalar, color, mask",
        ),
    ],
)
def test_images_that_cannot_be_compared_are_refused(yours, expected, kind, words):
    with pytest.raises(ValueError, match=words):
        comparison_images(yours, expected, kind)


def test_inputs_are_left_alone():
    yours, expected = waves(seed=1), waves(seed=2)
    copies = yours.copy(), expected.copy()
    comparison_images(yours, expected, "distance")
    assert_array_equal((yours, expected), copies)


def test_a_comparison_needs_no_matplotlib_and_takes_little_time():
    d = waves((128, 128))
    start = time.process_time()
    comparison_images(d * 1.01, d, "distance")
    assert time.process_time() - start < 0.1  # 3 ms measured
    code = (
        "import sys, numpy as np; from framework import show;"
        "show.comparison_images(np.eye(4), np.ones((4, 4)), 'scalar');"
        "assert not {'matplotlib', 'numba', 'OpenEXR'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
