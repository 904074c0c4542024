"""`hint` in a notebook, and how `check` tells apart what was not tried, what cannot be judged, and what is wrong."""

import re

import numpy as np
import pytest

from autograder import checks, hinting
from autograder.checks.hints import HINTS
from autograder.notebook import WORDS, _as_html, as_text, judge

TASKS = [(name, task) for name in checks.available() for task in checks.assignment(name).tasks]


def test_every_task_has_three_hints_of_its_own_from_a_question_on():
    assert list(HINTS) == [task.id for _, task in TASKS]
    for id, steps in HINTS.items():
        assert len(steps) == 3 and "?" in steps[0], id
    assert len({step for steps in HINTS.values() for step in steps}) == 3 * len(HINTS)


def test_no_hint_holds_a_line_of_the_solution():
    import importlib
    import inspect

    for name, task in TASKS:
        said = re.sub(r"\s", "", " ".join(HINTS[task.id]))
        for function in task.functions:
            source = inspect.getsource(getattr(importlib.import_module(f"solutions.{name}"), function.name))
            body = source.split("### BEGIN SOLUTION")[1].split("### END SOLUTION")[0]
            for line in map(str.strip, body.splitlines()):
                right = re.sub(r"\s", "", line.removeprefix("return ").split(" = ")[-1])
                assert len(right) < 20 or right not in said, (task.id, line)


def test_hints_come_one_by_one_and_stay(monkeypatch, capsys):
    monkeypatch.setattr(hinting, "_asked", {})
    shown = []
    for _ in range(4):
        hinting.hint("2.4")
        shown.append(capsys.readouterr().out)
    assert [text.count("2.4, hint") for text in shown] == [1, 2, 3, 3]
    assert "2 more" in shown[0] and "all there is" in shown[2]
    with pytest.raises(KeyError, match="9.9"):
        hinting.hint("9.9")


def test_check_and_hint_are_what_a_notebook_imports():
    space: dict = {}
    for _ in range(2):
        exec("from autograder import check, hint", space)
    assert space["check"].__module__ == "autograder.notebook" and space["hint"] is hinting.hint


def judged(blend):
    return judge("1.4", {"blend": blend})


def stub(d1, d2, t):
    raise NotImplementedError



NOT_JUDGED = {
    "exception": (lambda d1, d2, t: undefined_name, "undefined_name"),  # noqa: F821
    "shape": (lambda d1, d2, t: np.zeros(3), "of shape (3,)"),
    "nan": (lambda d1, d2, t: np.sqrt(d1 * np.ones(np.shape(t))), "the first where the first argument is"),
}


def test_not_tried_not_judged_and_wrong_look_so():
    looks = {}
    for status, function in (
        ("not_attempted", stub), ("error", NOT_JUDGED["shape"][0]), ("fail", lambda d1, d2, t: d1 + d2 + 9),
        ("pass", lambda d1, d2, t: (1 - t) * d1 + t * d2),
    ):  # fmt: skip
        found = judged(function)
        assert found["status"] == status
        sign, color, words = WORDS[status]
        page = _as_html(found)
        assert sign in page and f"border-left:5px solid {color}" in page and words in page
        assert as_text(found).startswith(sign)
        looks[status] = (sign, color, words)
        # what was not tried or not judged has no table of errors, and only what was tried is offered hints
        assert ("<table" in page) == (status in ("fail", "pass"))
        assert ('hint("1.4")' in page) == ('hint("1.4")' in as_text(found)) == (status in ("fail", "error"))
    assert all(len(set(column)) == 4 for column in zip(*looks.values(), strict=True))


@pytest.mark.parametrize("kind", NOT_JUDGED)
def test_what_cannot_be_judged_says_why_in_its_first_line(kind):
    function, why = NOT_JUDGED[kind]
    found = judged(function)
    assert found["status"] == "error" and why in as_text(found).splitlines()[0]


def test_a_wrong_answer_shows_its_number_its_limit_its_pictures_and_the_likely_mistake():
    page = _as_html(judged(lambda d1, d2, t: t * d1 + (1 - t) * d2))
    assert "<th>yours</th><th>allowed</th>" in page and page.count("<img") == 3
    assert "At t = 0 the second shape appears" in page and "Which distance is left when t is 0?" in page
