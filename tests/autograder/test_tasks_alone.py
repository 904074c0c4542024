"""Through the sandbox: a wrong function costs its own task alone, in every assignment."""

import importlib
import inspect

import nbformat
import pytest

from autograder import checks
from autograder.grade import grade
from autograder.samples import filled_notebook

FUNCTIONS = [
    (name, task.id, function.name)
    for name in checks.available()
    for task in checks.assignment(name).tasks
    for function in task.functions
]
HALVED = """
def {name}(*arguments):
    answer = _right(*arguments)
    if isinstance(answer, (list, tuple)):
        return [0.5 * np.asarray(part) for part in answer]
    return 0.5 * np.asarray(answer)
"""


@pytest.mark.drill
@pytest.mark.parametrize(("name", "task_id", "function"), FUNCTIONS, ids=[f for *_, f in FUNCTIONS])
def test_a_function_that_returns_half_costs_marks_of_its_own_task_alone(name, task_id, function, tmp_path, pool):
    reference = getattr(importlib.import_module(f"solutions.{name}"), function)
    right = inspect.getsource(reference).replace(f"def {function}(", "def _right(", 1)
    path = tmp_path / f"{name}.ipynb"
    nbformat.write(filled_notebook(name, {function: right + HALVED.format(name=function)}), path)
    judged = grade(path, "amy", pool)[0]["checks"]
    assert [c["id"] for c in judged if c["score"] < c["max_score"]] == [task_id]
