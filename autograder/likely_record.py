"""What the known mistakes answer to the public inputs, recorded for `likely`: one file for each assignment."""

from __future__ import annotations

import importlib

import numpy as np

from autograder import checks, likely, mistakes
from autograder.judge import run_check, seed_of
from autograder.public import write_arrays
from autograder.student import InMemory

# Of the spread of right answers, and of the scale: what is below is no error.
SPREAD, FLOOR = 1.5, 1e-6


def record(name):
    """Write what the mistakes of an assignment answer, and right answers beside them.

    Parameters
    ----------
    name : str      an assignment

    Returns
    -------
    Path            the file, the same bytes for the same answers
    """
    arrays: dict[str, np.ndarray] = {}
    right, wrong = mistakes.right_answers(name), mistakes.mistakes(name)
    for task in checks.assignment(name).tasks:
        arrays |= {f"{task.id}/{key}": value for key, value in _recorded(
            task, [a for a in right if a.task == task.id], [a for a in wrong if a.task == task.id]).items()}  # fmt: skip
    return write_arrays(likely.FOLDER / f"{name}-mistakes.npz", arrays)


def answers(answer) -> dict[str, np.ndarray]:
    """What a known answer gives in the public round of its task, by call."""
    task = checks.assignment(answer.assignment).find(answer.task)
    reference = importlib.import_module(f"solutions.{answer.assignment}")
    functions = {f.name: getattr(reference, f.name) for f in task.functions} | {answer.function: answer.code}
    seed = seed_of(b"", answer.assignment, task.id, True)
    return likely.answers(task, run_check(task, InMemory(functions, task).call, reference, seed, True).calls)


def _recorded(task, right, wrong):
    reference, *others = map(answers, right)
    values = list(reference.values())
    scales = np.array([_scale(v) for v in values])
    known = likely.Known(list(reference), np.array([v.size for v in values]), scales, np.empty(0), np.empty(0),
                         np.empty((0, 0)), [], [])  # fmt: skip
    middle = known.vector(reference)
    spread = np.full(len(values), FLOOR)
    for other in others:
        spread = np.fmax(spread, SPREAD * known.lengths(known.vector(other) - middle))
    answered = [known.vector(answers(a)) for a in wrong]
    # one whose answers are right errs in its work alone, or between two runs
    errs = [bool(np.any(~(known.lengths(v - middle) <= spread))) for v in answered]
    kept = [a for a, wrong_here in zip(wrong, errs, strict=True) if wrong_here]
    return {
        "keys": np.array(known.keys), "sizes": known.sizes, "scales": scales,
        "right": middle.astype(np.float32), "spread": spread.astype(np.float32),
        "wrong": np.array([v for v, wrong_here in zip(answered, errs, strict=True) if wrong_here], dtype=np.float32),
        "ids": np.array([a.id for a in kept]), "functions": np.array([a.function for a in kept]),
        "symptoms": np.array([a.symptom for a in kept]), "hints": np.array([a.hint for a in kept]),
    }  # fmt: skip


def _scale(values):
    """How large values are, the infinite ones left out; 1 where all are 0."""
    sane = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(sane**2))) if np.any(sane) else 1.0
