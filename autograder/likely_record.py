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
        of_task = ([a for a in answers if a.task == task.id] for answers in (right, wrong))
        arrays |= {f"{task.id}/{key}": value for key, value in _recorded(*of_task).items()}
    return write_arrays(likely.FOLDER / f"{name}-mistakes.npz", arrays)


def answers(answer, secret=None) -> dict[str, np.ndarray]:
    """What a known answer gives in the public round of its task, by call; or in the hidden one of a secret."""
    task = checks.assignment(answer.assignment).find(answer.task)
    reference = importlib.import_module(f"solutions.{answer.assignment}")
    functions = {f.name: getattr(reference, f.name) for f in task.functions} | {answer.function: answer.code}
    public = secret is None
    seed = seed_of(secret or b"", answer.assignment, task.id, public)
    return likely.answers(task, run_check(task, InMemory(functions, task).call, reference, seed, public).calls)


def fits(answer, id, secret) -> bool:
    """Whether an answer errs as the mistake of this id does in the hidden round of a secret."""
    wrong = next(a for a in mistakes.mistakes(answer.assignment) if a.id == id)
    right = next(a for a in mistakes.right_answers(answer.assignment) if a.task == answer.task)
    known, _ = _compared([right], [wrong], secret)
    return known.distances(known.vector(answers(answer, secret)))[0] <= likely.NEAR


def _compared(right, wrong, secret=None):
    """What answers give, the first right one as the middle; and which of the wrong ones err there at all."""
    reference, *others = (answers(a, secret) for a in right)
    values = list(reference.values())
    sizes, scales = np.array([v.size for v in values]), np.array([_scale(v) for v in values])
    empty = likely.Known(list(reference), sizes, scales, np.empty(0), np.empty(0), np.empty((0, 0)), [], [])
    middle = empty.vector(reference)
    spread = np.full(len(values), FLOOR)
    for other in others:
        spread = np.fmax(spread, SPREAD * empty.lengths(empty.vector(other) - middle))
    answered = [empty.vector(answers(a, secret)) for a in wrong]
    # one whose answers are right errs in its work alone, or between two runs
    errs = [bool(np.any(~(empty.lengths(v - middle) <= spread))) for v in answered]
    said = [likely.Likely(a.id, a.symptom, a.hint) for a in wrong]
    functions = [a.function for a in wrong]
    return likely.Known(list(reference), sizes, scales, middle, spread, np.array(answered), said, functions), errs


def _recorded(right, wrong):
    known, errs = _compared(right, wrong)
    kept = [i for i, answer in enumerate(wrong) if errs[i] and _repeats(answer, known.wrong[i], known)]
    said = [known.mistakes[i] for i in kept]
    return {
        "keys": np.array(known.keys), "sizes": known.sizes, "scales": known.scales,
        "right": known.right.astype(np.float32), "spread": known.spread.astype(np.float32),
        "wrong": known.wrong[kept].astype(np.float32), "functions": np.array([known.functions[i] for i in kept]),
        "ids": np.array([m.id for m in said]), "symptoms": np.array([m.symptom for m in said]),
        "hints": np.array([m.hint for m in said]),
    }  # fmt: skip


def _repeats(answer, vector, known):
    """Whether an answer gives the same twice: one that draws its own random numbers cannot be told by what it gave."""
    return np.array_equal(vector, known.vector(answers(answer)), equal_nan=True)


def _scale(values):
    """How large values are, the infinite ones left out; 1 where all are 0."""
    sane = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(sane**2))) if np.any(sane) else 1.0
