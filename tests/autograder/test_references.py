"""The references' own notebooks through the real sandbox: full marks, and a stub costs exactly its task."""

import nbformat
import pytest

from autograder import checks
from autograder.grade import grade
from autograder.samples import filled_notebook
from autograder.submission import known_assignments

TASKS = [(name, task) for name in known_assignments() for task in checks.assignment(name).tasks]


def marks(name, replacements, tmp_path, pool):
    path = tmp_path / f"{name}.ipynb"
    nbformat.write(filled_notebook(name, replacements), path)
    result, _ = grade(path, "amy", pool)
    return {check["id"]: check for check in result["checks"]}


@pytest.mark.parametrize("name", known_assignments())
def test_the_reference_has_full_marks_in_every_task(name, tmp_path, pool):
    lost = {i: c["message"] for i, c in marks(name, {}, tmp_path, pool).items() if c["score"] < c["max_score"]}
    assert not lost


@pytest.mark.drill
@pytest.mark.parametrize(("name", "task"), TASKS, ids=[task.id for _, task in TASKS])
def test_a_stub_costs_exactly_its_task(name, task, tmp_path, pool):
    stubs = {function.name: None for function in task.functions}
    checked = marks(name, stubs, tmp_path, pool)
    assert [i for i, c in checked.items() if c["score"] < c["max_score"]] == [task.id]
    assert checked[task.id]["status"] == "not_attempted"
