"""The plane of run time and error, on ways of known time and error."""

import time

import numpy as np
import pytest

from framework import plane


def test_the_front_holds_what_nothing_beats_in_time_and_error():
    points = [(1.0, 5.0), (2.0, 5.0), (2.0, 3.0), (3.0, 4.0), (4.0, 3.0), (9.0, 0.0)]
    assert plane.front(points) == {0, 2, 5}


def test_runs_take_turns_after_a_warm_up():
    order = []
    plane.medians([lambda: order.append("a"), lambda: order.append("b")], repeats=3)
    assert order == ["a", "b"] * 4


def ways():
    return {"sleep": {f"{ms} ms": lambda ms=ms: time.sleep(ms / 1000) or ms for ms in (2, 8)}, "know": {"all": lambda: 0}}


def test_points_carry_the_time_and_the_error_of_their_way():
    points = plane.measure(ways(), error=lambda ms: ms / 4, repeats=3)
    assert [(p.method, p.setting, p.error) for p in points] == [
        ("sleep", "2 ms", 0.5), ("sleep", "8 ms", 2.0), ("know", "all", 0.0),
    ]  # fmt: skip
    assert points[0].milliseconds >= 2 and points[1].milliseconds >= 8


@pytest.mark.parametrize("exact", [True, False])
def test_the_picture_names_its_axes_and_says_what_is_too_exact_for_it(exact, monkeypatch):
    drawn = []
    monkeypatch.setattr("framework.figure.Picture.present", lambda picture: drawn.append(picture))
    points = plane.measure(ways(), error=lambda ms: ms / 4 + (not exact), repeats=1)
    plane.show(points, "error, widgets", "Sleeping")
    (axes,), words = drawn[0].axes, [text.get_text() for text in drawn[0].texts]
    assert axes.get_xlabel() == "run time, milliseconds (median)" and axes.get_ylabel() == "error, widgets"
    shown = sorted(y for line in axes.lines[1:] for y in line.get_ydata())
    assert np.allclose(shown, [0.5, 2.0] if exact else [1.0, 1.5, 3.0])
    assert any("know, all" in text for text in words) == exact
