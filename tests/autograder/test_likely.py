"""Known mistakes are recognised in answers, made in the known way or another; right answers are taken for none."""

import importlib
import inspect

import nbformat
import numpy as np
import pytest
from other_ways import made_otherwise

from autograder import checks, likely, likely_record, mistakes
from autograder.grade import grade
from autograder.judge import run_check, seed_of
from autograder.mistakes import sphere_tracing as wrong
from autograder.mistakes.right import sphere_tracing as right
from autograder.notebook import as_text, judge
from autograder.samples import filled_notebook
from autograder.sandbox import Limits, Pool
from autograder.student import InMemory

NAMES = checks.available()
SLOW = {"2.5", "4.5", "4.6", "5.2", "5.3"}
# These leave every answer right, and are told by the number of evaluations, or between two runs: no record has them.
SILENT = {
    "sphere-trace-all-rays",
    "sphere-trace-one-step-more",
    "monte-carlo-shade-own-seed",
    "shade-with-shadows-ray-to-every-pixel",
}
TASKS = [
    pytest.param(name, task.id, marks=pytest.mark.drill if task.id in SLOW else (), id=task.id)
    for name in NAMES
    for task in checks.assignment(name).tasks
]


def of_task(answers, task_id):
    return [answer for answer in answers if answer.task == task_id]


def alike(known, id):
    """The ids of the mistakes that answer as this one does."""
    index = [m.id for m in known.mistakes].index(id)
    return {known.mistakes[i].id for i in np.flatnonzero(known.alike(index))} | {id}


@pytest.mark.parametrize(("name", "task_id"), TASKS)
def test_what_is_recorded_is_what_the_mistakes_answer(name, task_id):
    known = likely.known(name, task_id)
    found = [a for a in of_task(mistakes.mistakes(name), task_id) if a.id not in SILENT]
    assert [(m.id, m.symptom, m.hint) for m in known.mistakes] == [(a.id, a.symptom, a.hint) for a in found]
    for answer, recorded in zip(found, known.wrong, strict=True):
        fresh = known.vector(likely_record.answers(answer))
        np.testing.assert_allclose(fresh, recorded, rtol=1e-3, atol=1e-3, err_msg=answer.id)


@pytest.mark.parametrize("name", NAMES)
def test_every_mistake_that_shows_in_the_answers_is_named(name):
    for task in checks.assignment(name).tasks:
        known = likely.known(name, task.id)
        for mistake, answers in zip(known.mistakes, known.wrong, strict=True):
            found = known.nearest_to(answers)
            assert found is not None and found.id in alike(known, mistake.id), mistake.id


@pytest.mark.parametrize(("name", "task_id"), TASKS)
def test_no_right_answer_is_taken_for_a_mistake(name, task_id):
    known = likely.known(name, task_id)
    for answer in of_task(mistakes.right_answers(name), task_id):
        assert known.nearest(likely_record.answers(answer)) is None, answer.id


@pytest.mark.drill
def test_mistakes_made_in_other_right_ways_are_named_too():
    said = {"right": [], "wrong": [], "nothing": []}
    for name in NAMES:
        with made_otherwise(name) as found:
            for answer in found:
                if answer.id in SILENT:
                    continue
                known = likely.known(name, answer.task)
                answers = likely_record.answers(answer)
                same = known.wrong[[m.id for m in known.mistakes].index(answer.id)]
                if np.allclose(known.vector(answers), same, atol=1e-5, equal_nan=True):
                    continue  # built from nothing that was replaced
                named = known.nearest(answers)
                verdict = "nothing" if named is None else "right" if named.id in alike(known, answer.id) else "wrong"
                said[verdict].append(answer.id)
    print({verdict: len(ids) for verdict, ids in said.items()}, said["wrong"], said["nothing"])
    assert len(said["right"]) >= 0.9 * sum(map(len, said.values())) >= 60
    assert said["wrong"] == []


def test_an_answer_that_errs_in_no_known_way_is_given_no_name():
    judged = judge("1.4", {"blend": lambda d1, d2, t: 0.3 * d1 * d2 + np.sin(9 * d1) * t})
    assert judged["status"] == "fail" and judged["likely"] is None


def test_an_answer_that_always_fails_is_given_no_name():
    def broken(*_):
        raise ZeroDivisionError

    assert judge("1.4", {"blend": broken})["likely"] is None
    assert judge("1.4", {"blend": lambda d1, d2, t: d1 * np.nan})["likely"] is None


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300, -1e300, 0.0], ids=str)
def test_any_numbers_can_be_compared(value):
    for name in NAMES:
        for task in checks.assignment(name).tasks:
            if task.id not in SLOW:
                calls = InMemory({f.name: _Filled(f, value) for f in task.functions}, task).call
                likely.name(task, run_check(task, calls, _reference(name), seed_of(b"", name, task.id, True), True).calls)


class _Filled:
    """A function that answers with one number, in the shape that is promised."""

    def __init__(self, function, value):
        self._function, self._value = function, value

    def __call__(self, *arguments):
        returns = self._function.returns(*arguments)
        parts = [np.full(shape, self._value) for shape in returns.shapes]
        return parts if returns.sequence else parts[0]


def _reference(name):
    return importlib.import_module(f"solutions.{name}")


def test_a_notebook_is_told_the_symptom_and_where_to_think_again():
    text = as_text(judge("1.4", {"blend": wrong.blend_swapped}))
    assert "At t = 0 the second shape appears" in text and "Which distance is left when t is 0?" in text


@pytest.fixture(scope="module")
def pool(isolation):
    """Sandboxes that end with this module: other tests look for processes that were left."""
    with Pool(isolation, Limits()) as pool:
        yield pool


def _cell(code, name):
    """The source of a known answer as a student's function."""
    source = inspect.getsource(code)
    return source[source.index("def ") :].replace(f"def {code.__name__}(", f"def {name}(")


def test_two_mistakes_in_one_notebook_are_both_named(tmp_path, pool):
    replaced = {
        "sdf_box": _cell(wrong.sdf_box_manhattan, "sdf_box"),
        "smooth_union": _cell(wrong.smooth_union_abs_missing, "smooth_union"),
        "sdf_sphere": _cell(right.sdf_sphere_by_components, "sdf_sphere"),
        "sdf_torus": _cell(right.sdf_torus_nearest_point, "sdf_torus"),
        "blend": _cell(right.blend_from_the_first, "blend"),
        "estimate_normal": _cell(right.estimate_normal_loop, "estimate_normal"),
    }
    path = tmp_path / "sphere_tracing.ipynb"
    nbformat.write(filled_notebook("sphere_tracing", replaced), path)
    result = {check["name"]: check for check in grade(path, "amy", pool)[0]["checks"]}
    named = {name: check["likely_mistake"] for name, check in result.items() if check["likely_mistake"]}
    assert named == {"sdf_box": "sdf-box-manhattan", "smooth_union": "smooth-union-abs-missing"}
    for name, check in result.items():
        assert (check["score"] == check["max_score"]) == (name not in named)
    assert "Too large off edges and corners" in result["sdf_box"]["symptom"]
    assert result["sdf_box"]["hint"] == "How long is the way to a corner: the sum of its components?"
