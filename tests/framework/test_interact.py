"""Pictures under sliders: the strip without a notebook, and the live part in a real kernel."""

import io

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient
from numpy.testing import assert_array_equal
from PIL import Image

import framework as fw
from framework import show


def grey(level, tint="none"):
    picture = np.full((8, 12, 3), level)
    return picture * [1, 0, 0] if tint == "red" else picture


def pictures_in(figure):
    return [axes.images[0].get_array() for axes in figure.axes]


def test_the_strip_shows_the_first_control_from_end_to_end_with_the_others_at_their_start():
    figure = fw.interact(grey, strip=3, level=np.linspace(0, 1, 5), tint=["red", "none"])
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["level = 0", "level = 0.5", "level = 1"]
    for picture, level in zip(pictures_in(figure), (0, 128, 255), strict=True):
        assert_array_equal(picture, np.full((8, 12, 3), level) * [1, 0, 0])
    words = " ".join(" ".join(text.get_text() for text in figure.texts).split())
    assert "12 × 8 pixels. A picture took" in words and "tint = red" in words


def test_without_controls_or_values_it_is_refused():
    for controls in ({}, {"level": []}):
        with pytest.raises(ValueError, match="at least one control"):
            fw.interact(grey, **controls)


WRONG = [np.full((4, 4, 3), 1.5), np.full((4, 4, 3), np.nan), np.zeros((4, 4)), np.zeros((4, 4, 3), int)]


@pytest.mark.parametrize("wrong", WRONG)
def test_a_picture_that_is_no_picture_is_refused(wrong):
    with pytest.raises(ValueError, match="the picture"):
        show.display_pixels(wrong)


def test_a_plot_has_its_units_and_a_legend_where_curves_have_names():
    with show.plot("t, s", "x, m", "Falling") as axes:
        axes.plot([0, 1], [0, 1], label="stone")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("t, s", "x, m")
    assert axes.get_legend().get_texts()[0].get_text() == "stone"


LIVE = """
import gc, ipywidgets, numpy as np, framework as fw
fw.interact(lambda level: np.full((8, 12, 3), level), level=[0.0, 0.2, 1.0])
slider = next(o for o in gc.get_objects() if isinstance(o, ipywidgets.SelectionSlider))
picture = next(o for o in gc.get_objects() if isinstance(o, ipywidgets.Image))
before = picture.value
slider.value = 1.0
print(before.hex(), picture.value.hex())
"""


def run(source):
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    return notebook.cells[0].outputs


def test_in_a_notebook_the_picture_follows_its_slider():
    outputs = run(LIVE)
    kinds = [kind for output in outputs for kind in output.get("data", {})]
    assert "image/png" in kinds and "application/vnd.jupyter.widget-view+json" in kinds
    said = next(output.text for output in outputs if output.get("name") == "stdout")
    before, after = (np.asarray(Image.open(io.BytesIO(bytes.fromhex(part)))) for part in said.split())
    assert_array_equal(before, np.full((8, 12, 3), 51))
    assert_array_equal(after, np.full((8, 12, 3), 255))


def test_without_ipywidgets_the_strip_is_there_alone():
    outputs = run("import sys; sys.modules['ipywidgets'] = None\n" + LIVE.split("slider =")[0].replace("gc, ipywidgets, ", ""))
    assert [list(output.get("data", {})) for output in outputs if output.output_type == "display_data"] == [
        ["image/png", "text/plain"]
    ]
    assert not [output for output in outputs if output.output_type == "error"]
