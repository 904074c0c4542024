"""The demo, end to end: what `make demo` does."""

import json

import numpy as np
import pytest

from autograder import demo, sandbox


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("demo")
    assert demo.main(["--out", str(out)]) == 0
    return out


def result(made, student):
    return json.loads((made / "graded" / "results" / student / "sphere_tracing.json").read_text())


def lost(made, student):
    return {c["name"]: c for c in result(made, student)["checks"] if c["score"] < c["max_score"]}


def test_right_answers_have_full_marks_in_whatever_way(made):
    assert not lost(made, "ada") and not lost(made, "ben")


def test_mistakes_lose_marks_in_their_own_task_and_say_why(made):
    assert set(lost(made, "chloe")) == {"sdf_box"} and set(lost(made, "dan")) == {"sphere_trace"}
    assert "inside, the distance is negative" in lost(made, "chloe")["sdf_box"]["message"]
    assert "without a hit it is a miss" in lost(made, "dan")["sphere_trace"]["message"]
    for student, name in (("chloe", "sdf_box"), ("dan", "sphere_trace")):
        page = (made / "graded" / "pages" / student / "sphere_tracing.html").read_text()
        assert lost(made, student)[name]["message"].split(":")[1].strip() in page


def test_an_empty_notebook_is_not_attempted(made):
    assert result(made, "eve")["status"] == "not_attempted"


def test_an_endless_loop_costs_its_own_task_alone(made):
    assert {name: c["status"] for name, c in lost(made, "finn").items()} == {"smooth_union": "timeout"}


def test_the_isolation_is_recorded(made):
    assert result(made, "ada")["isolation"] == sandbox.strongest_level()


def test_the_gallery_has_its_pictures(made):
    from PIL import Image

    from solutions.gallery import PICTURES

    for name in PICTURES:
        with Image.open(made / "gallery" / f"{name}.png") as picture:
            assert len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)) > 40
