"""How far the tolerances of the checks lie from right answers and from wrong ones, as measured.

Every known answer goes through the check of its task with the inputs that the notebook shows and with hidden ones of
several secrets. What is asked of them, in the worst case over these inputs:

- A right answer has full marks, and none of its errors is larger than tolerance / MARGIN. Its work is exempt: the
  limit of 1.5 times the reference's evaluations is part of what is asked for.
- A mistake loses at least LOSS of the marks, and in every run at least one error is larger than MARGIN times the
  tolerance, or the task cannot be judged at all. A measure catches a mistake if this holds for it in all runs; the
  nearest mistake of a measure is, of those that it catches, the one with the smallest error.
- A costly answer misses the measure of work, and no other.

A mistake costs no other task anything, because tasks are judged alone, with the reference's functions for all others.
"""

from __future__ import annotations

import concurrent.futures
import importlib
import math
import multiprocessing
from dataclasses import dataclass, field

from autograder import checks, mistakes
from autograder.judge import run_check, seed_of
from autograder.student import InMemory

MARGIN, LOSS = 1.5, 0.04


@dataclass
class Run:
    """What one run of a check made of an answer: the marks, and each measure's (error, tolerance) at its worst."""

    fraction: float
    failure: str = ""
    measures: dict[str, tuple[float, float]] = field(default_factory=dict)
    missed: set[str] = field(default_factory=set)


@dataclass
class Extreme:
    """The error that lies nearest to a tolerance, from one side, and the answer that made it."""

    id: str
    error: float
    tolerance: float

    @property
    def over(self):
        """Error over tolerance."""
        return _over(self.error, self.tolerance)


@dataclass
class Row:
    """One measure of a task: the largest error of right answers and the nearest mistake that it catches."""

    name: str
    right: Extreme | None = None
    wrong: Extreme | None = None


@dataclass
class Table:
    """What was found of one task.

    Attributes
    ----------
    rows : list of Row
    counts : dict               how many answers there are of each verdict
    margins : dict of Extreme   by verdict: what comes nearest to losing marks, or to keeping them
    problems : list of str      what is not as it should be, a sentence each
    """

    task: checks.Task
    rows: list[Row]
    counts: dict
    margins: dict
    problems: list[str]


def judge(answer, seeds) -> list[Run]:
    """Run the check of an answer's task with public inputs and with hidden ones, once for each of the other seeds."""
    task = checks.assignment(answer.assignment).find(answer.task)
    reference = importlib.import_module(f"solutions.{answer.assignment}")
    names = {f.name: getattr(reference, f.name) for f in task.functions} | {answer.function: answer.code}
    runs = []
    for number in range(seeds):
        seed = seed_of(str(number).encode(), answer.assignment, task.id, number == 0)
        runs.append(_summary(task.id, run_check(task, InMemory(names, task).call, reference, seed, number == 0)))
    return runs


def _summary(task_id, round_):
    run = Run(round_.fraction, round_.failure.message if round_.failure else "")
    for name, error, tolerance in round_.measured:
        _keep(run, name, error, tolerance)
        if error > tolerance:
            run.missed.add(name)
    for m in round_.measures:
        if m.work:
            # told a unit: a ray or a point
            scale = checks.tolerance(task_id, m.name)["per_unit"] / m.evaluations_reference
            _keep(run, m.name, m.error * scale, m.tolerance * scale)
        elif m.name not in run.measures or math.isinf(m.error):
            _keep(run, m.name, m.error, m.tolerance)
        if m.credit < 1:
            run.missed.add(m.name)
    return run


def _keep(run, name, error, tolerance):
    """Add a measure, or the worse of two that are held against the same record."""
    pair = error, tolerance
    run.measures[name] = max(run.measures.get(name, pair), pair, key=lambda p: _over(*p))


def answers_of(names) -> list[mistakes.Answer]:
    """The known answers to assignments, or to tasks by number or function; to all where no name is given.

    Raises
    ------
    KeyError    at a name that is neither
    """
    available = checks.available()
    every = [a for name in available for a in mistakes.right_answers(name) + mistakes.mistakes(name)]
    chosen = {name: [a for a in every if name in (a.assignment, a.task, a.function)] for name in names}
    for name, found in chosen.items():
        if not found:
            raise KeyError(f"there is no assignment or task {name!r}; there are {', '.join(available)}")
    return [a for a in every if not names or any(a in found for found in chosen.values())]


def measure(answers, seeds, jobs, progress=lambda: None) -> list[Table]:
    """Judge answers in `jobs` processes and compare them, task by task.

    Parameters
    ----------
    answers : list of mistakes.Answer
    seeds : int             how many inputs each is judged with, the public ones among them
    jobs : int
    progress : callable     called after each answer

    Returns
    -------
    list of Table           one for each task that is answered, in their order
    """
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(jobs, context) as pool:
        futures = [pool.submit(judge, answer, seeds) for answer in answers]
        for _ in concurrent.futures.as_completed(futures):
            progress()
    judged = [(answer, future.result()) for answer, future in zip(answers, futures, strict=True)]
    tasks = list(dict.fromkeys((answer.assignment, answer.task) for answer in answers))
    return [
        compare(checks.assignment(name).find(id), [(a, runs) for a, runs in judged if a.task == id])
        for name, id in tasks
    ]


def compare(task, judged) -> Table:
    """The table of a task, from its answers and what their runs gave."""
    rows: dict[str, Row] = {}
    counts: dict[str, int] = {}
    margins: dict[str, Extreme] = {}
    problems = []
    for answer, runs in judged:
        counts[answer.verdict] = counts.get(answer.verdict, 0) + 1
        problem = _VERDICTS[answer.verdict](answer, runs, rows, margins)
        if problem:
            problems.append(f"{task.id} {answer.id}: {problem}")
    return Table(task, list(rows.values()), counts, margins, problems)


def _right(answer, runs, rows, margins):
    for run in runs:
        for name, pair in run.measures.items():
            row, seen = rows.setdefault(name, Row(name)), Extreme(answer.id, *pair)
            row.right = max(row.right or seen, seen, key=lambda e: e.over)
            if name != "work":
                margins[mistakes.RIGHT] = max(margins.get(mistakes.RIGHT, seen), seen, key=lambda e: e.over)
    for run in runs:
        if run.fraction < 1 - 1e-9:
            return f"a right answer loses marks: {run.failure or ', '.join(sorted(run.missed))}"
    name, pair = max(((n, p) for run in runs for n, p in run.measures.items() if n != "work"), key=lambda m: _over(*m[1]))
    if _over(*pair) > 1 / MARGIN:
        return f"a right answer's error of {pair[0]:.2g} in {name!r} is near the tolerance of {pair[1]:.2g}"
    return ""


def _wrong(answer, runs, rows, margins):
    for name in set.union(*(run.missed for run in runs)):
        each = [Extreme(answer.id, *run.measures[name]) for run in runs if name in run.measures]
        least = min(each, key=lambda e: e.over)
        if least.over >= MARGIN and all(run.failure or name in run.measures for run in runs):
            row = rows.setdefault(name, Row(name))
            row.wrong = min(row.wrong or least, least, key=lambda e: e.over)
    weakest = min((_strongest(run, answer) for run in runs), key=lambda e: e.over)
    margins[mistakes.WRONG] = min(margins.get(mistakes.WRONG, weakest), weakest, key=lambda e: e.over)
    most = max(run.fraction for run in runs)
    if most > 1 - LOSS + 1e-9:
        return f"{KEEPS} {most:.0%} of the marks"
    if weakest.over < MARGIN:
        return f"a mistake's largest error is only {weakest.over:.2f} times the tolerance"
    return ""


def _strongest(run, answer):
    """The error that tells most clearly that a run's answer is wrong."""
    if run.failure:
        return Extreme(answer.id, math.inf, 1.0)
    return max((Extreme(answer.id, *run.measures[name]) for name in run.missed), key=lambda e: e.over,
               default=Extreme(answer.id, 0.0, 1.0))  # fmt: skip


def _costly(answer, runs, rows, margins):
    for run in runs:
        if run.failure or run.missed != {"work"}:
            return f"a costly answer misses {run.failure or ', '.join(sorted(run.missed)) or 'nothing'}, not only work"
    return ""


KEEPS = "a mistake keeps"
_VERDICTS = {mistakes.RIGHT: _right, mistakes.WRONG: _wrong, mistakes.COSTLY: _costly}


def _over(error, tolerance):
    if tolerance > 0:
        return error / tolerance
    return math.inf if error > 0 else 0.0
