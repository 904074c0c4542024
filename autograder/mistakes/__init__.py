"""Known answers to the tasks: wrong ones, each with its symptom and a hint, and right ones made in other ways.

An answer is a function named `FUNCTION_what`, after the function of the task that it answers. The mistakes of an
assignment are in the module of its name, with the symptom as their docstring; right answers in the one below `right`.
Both prove that the checks tell right from wrong (`course calibrate`). Students' installations go without them.
"""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from autograder import checks

RIGHT, COSTLY, WRONG = "right", "costly", "wrong"


@dataclass(frozen=True)
class Answer:
    """An answer to one function of a task, and what its marks should be.

    Attributes
    ----------
    assignment, task, function : str    "soft_shadows", "2.2", "penumbra"
    id : str                            "penumbra-not-divided"
    code : callable
    verdict : str                       RIGHT, WRONG, or COSTLY: right values, at a price in evaluations
    symptom, hint : str                 of a mistake: what the result looks like, and where to think again
    """

    assignment: str
    task: str
    function: str
    id: str
    code: Callable
    verdict: str
    symptom: str = ""
    hint: str = ""


def mistake(hint):
    """Declare a wrong answer: its docstring is the symptom, `hint` points to the idea."""

    def declare(code):
        code.hint = hint
        return code

    return declare


def costly(code):
    """Declare an answer that is right and does more work than is worth all marks."""
    code.verdict = COSTLY
    return code


def mistakes(assignment) -> list[Answer]:
    """The known wrong answers to an assignment's tasks."""
    found = _answers(assignment, importlib.import_module(f"autograder.mistakes.{assignment}"))
    return [Answer(*names, code, WRONG, inspect.getdoc(code) or "", code.hint) for names, code in found]


def right_answers(assignment) -> list[Answer]:
    """The reference's answers to an assignment's tasks, and right ones made in other ways."""
    reference = importlib.import_module(f"solutions.{assignment}")
    found = _answers(assignment, importlib.import_module(f"autograder.mistakes.right.{assignment}"))
    return [
        Answer(assignment, task.id, f.name, f"{_dashed(f.name)}-reference", getattr(reference, f.name), RIGHT)
        for task in checks.assignment(assignment).tasks
        for f in task.functions
    ] + [Answer(*names, code, getattr(code, "verdict", RIGHT)) for names, code in found]


def _answers(assignment, module) -> Iterator[tuple[tuple[str, str, str, str], Any]]:
    """(assignment, task, function, id) and the code of what a module holds that is named after a task's function."""
    tasks = {f.name: task.id for task in checks.assignment(assignment).tasks for f in task.functions}
    for name, code in vars(module).items():
        # the longest name that fits: prefilter_chain, not prefilter
        function = max((f for f in tasks if name.startswith(f + "_")), key=len, default=None)
        if function and getattr(code, "__module__", "") == module.__name__:
            yield (assignment, tasks[function], function, _dashed(name)), code


def _dashed(name):
    return name.replace("_", "-")
