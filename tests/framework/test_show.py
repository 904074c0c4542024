import io
import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from PIL import Image

from framework import colors, figure, sdf, show


def pixels_of(fig):
    return np.asarray(Image.open(io.BytesIO(fig.png())).convert("RGB"))


def pictures_in(fig):
    """The images on a figure, colour bars left aside."""
    return [axes.images[0].get_array() for axes in fig.axes if axes.images]


def words_on(fig):
    return " ".join(text.get_text() for text in fig.findobj(match=lambda o: hasattr(o, "get_text")))


def ball(p):
    return np.linalg.norm(p, axis=-1) - 1.0


FIGURES = {
    "image of colours": lambda: show.image(np.full((6, 8, 3), 3.0), "Bright"),
    "image of a scalar": lambda: show.image(np.arange(48.0).reshape(6, 8)),
    "comparison": lambda: show.comparison(np.eye(8) + 0.1, np.eye(8), "2.2 penumbra"),
    "comparison of distances": lambda: show.comparison(-np.eye(8) + 0.4, -np.eye(8) + 0.5),
    "comparison of colours": lambda: show.comparison(np.ones((4, 8, 3)), np.full((4, 8, 3), 0.9)),
    "comparison of masks": lambda: show.comparison(np.eye(8) > 0, np.eye(8) < 0),
    "slice": lambda: show.sdf_slice(ball, resolution=32),
    "heat map": lambda: show.march_heat_map(np.arange(48).reshape(6, 8)),
    "a tall image": lambda: show.image(np.zeros((64, 4))),
    "one pixel": lambda: show.comparison(np.ones((1, 1)), np.zeros((1, 1))),
}


@pytest.mark.parametrize("name", FIGURES)
def test_figures_become_png_with_all_their_words_inside(name):
    fig = FIGURES[name]()
    rgb = pixels_of(fig)
    assert rgb.std() > 5
    border = np.concatenate([rgb[:3].ravel(), rgb[-3:].ravel(), rgb[:, :3].ravel(), rgb[:, -3:].ravel()])
    assert (border == 255).all()  # nothing is cut off at the edge of the sheet


def test_a_comparison_shows_the_pictures_that_comparison_images_makes():
    yours, expected = np.random.default_rng(0).uniform(-1, 1, (2, 9, 12))
    fig = show.comparison(yours, expected, "1.1 sdf_sphere")
    shown = show.comparison_images(yours, expected, "distance")
    for picture, name in zip(pictures_in(fig), ("yours", "expected", "difference"), strict=True):
        assert_array_equal(picture, getattr(shown, name))
    words = words_on(fig)
    assert "1.1 sdf_sphere" in words and "scene units" in words and shown.caption in words


@pytest.mark.parametrize(
    ("expected", "kind"),
    [
        (np.ones((4, 4, 3)), "color"),
        (np.eye(4) > 0, "mask"),
        (np.eye(4), "scalar"),
        (np.eye(4) - 0.5, "distance"),
        (np.full((4, 4), np.inf), "scalar"),
    ],
)
def test_a_comparison_sees_what_kind_of_image_it_has(expected, kind):
    fig = show.comparison(expected, expected)
    assert_array_equal(pictures_in(fig)[1], show.comparison_images(expected, expected, kind).expected)


def test_the_panels_of_a_comparison_have_one_size():
    fig = show.comparison(np.eye(8)[:5], np.eye(8)[1:6])
    sizes = [axes.get_position().size for axes in fig.axes if axes.images]
    assert_allclose(sizes, [sizes[0]] * 3)
    inches = sizes[0] * fig.get_size_inches()
    assert_allclose(inches[0] / inches[1], 8 / 5)  # square pixels


@pytest.mark.parametrize(
    ("axis", "point", "row", "column"),
    [
        # Resolution 40, half size 2: pixels of 0.1, the middle between pixels 19 and 20.
        ("y", (1.05, 0.5, -0.55), 14, 30),  # x to the right, z downwards
        ("z", (1.05, 0.55, 0.5), 14, 30),  # x to the right, y up
        ("x", (0.5, 0.55, -1.05), 14, 30),  # z to the left, y up
    ],
)
def test_slices_are_seen_from_the_tip_of_their_axis(axis, point, row, column):
    def distance(p):
        return np.linalg.norm(p - np.array(point), axis=1) - 0.01

    fig = show.sdf_slice(distance, axis=axis, height=0.5, resolution=40)
    picture = pictures_in(fig)[0].astype(int)
    inside = np.argwhere(picture.sum(axis=2) < 100)  # the dark line of the tiny surface
    assert_array_equal(inside.mean(axis=0).round(), [row, column])
    axes = next(axes for axes in fig.axes if axes.images)
    left, right, bottom, top = axes.images[0].get_extent()
    across, up = {"y": (point[0], point[2]), "z": point[:2], "x": (point[2], point[1])}[axis]
    assert_allclose(left + (right - left) * (column + 0.5) / 40, across)
    assert_allclose(top + (bottom - top) * (row + 0.5) / 40, up)


def test_slices_call_the_field_once_with_flat_points():
    shapes = []
    show.sdf_slice(lambda p: shapes.append(p.shape) or ball(p), resolution=16)
    assert shapes == [(256, 3)]
    show.sdf_slice(sdf.sphere([0, 0, 0], 1), resolution=16)


def test_a_heat_map_tells_the_mean_and_the_largest_cost():
    fig = show.march_heat_map(np.array([[1, 2], [3, 10]]))
    assert "Mean 4.0 a pixel, at most 10." in words_on(fig)
    assert_array_equal(pictures_in(fig)[0][1, 1], colors.SEQUENTIAL[-1])


def test_images_explain_the_colours_that_stand_for_no_number():
    t = np.array([[1.0, np.inf], [2.0, np.nan]])
    assert "Magenta: not a number. Grey: infinite." in words_on(show.image(t))
    assert "Magenta" not in words_on(show.image(np.ones((2, 2))))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: show.image(np.zeros(5)), r"image has shape \(5,\)"),
        (lambda: show.image(np.zeros((4, 4, 2))), r"image has shape \(4, 4, 2\)"),
        (lambda: show.image(np.zeros((0, 4))), r"image has shape \(0, 4\)"),
        (lambda: show.image([["a"]]), "dtype <U1"),
        (lambda: show.march_heat_map(np.zeros((2, 2, 3))), r"counts has shape \(2, 2, 3\)"),
        (lambda: show.sdf_slice(ball, axis="w"), "axis is 'w'"),
        (lambda: show.sdf_slice(ball, extent=0), "extent is 0"),
        (lambda: show.sdf_slice(lambda p: p, resolution=8), r"shape \(64, 3\) for 64 points"),
    ],
)
def test_bad_input_is_refused_by_name(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_a_notebook_cell_shows_a_picture_once(monkeypatch):
    display = pytest.importorskip("IPython.display")
    shown, cell = [], [3]
    monkeypatch.setattr(figure, "_cell", lambda: cell[0])
    monkeypatch.setattr(display, "display", shown.append)
    fig = show.image(np.eye(4))
    assert len(shown) == 1
    fig._ipython_display_()  # the cell ends with the figure: it is there already
    assert len(shown) == 1
    cell[0] = 4
    fig._ipython_display_()  # a later cell asks for it again
    assert len(shown) == 2


def test_pictures_leave_pyplot_and_its_settings_alone():
    code = (
        "import matplotlib\n"
        "settings = lambda: {k: matplotlib.rcParams[k] for k in matplotlib.rcParams if k != 'backend'}\n"
        "before = settings()\n"
        "import sys, numpy as np; from framework import show\n"
        "show.comparison(np.eye(4), np.ones((4, 4))).png()\n"
        "assert 'matplotlib.pyplot' not in sys.modules and settings() == before"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
