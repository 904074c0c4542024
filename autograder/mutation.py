"""Mutants of the references run through the checks: which lose marks, by which measure, and what they are taken for."""

from __future__ import annotations

import concurrent.futures
import importlib
import multiprocessing
import time
from dataclasses import dataclass

from autograder import checks, likely, likely_record, mutants
from autograder.bounded import bounded
from autograder.judge import run_check, seed_of
from autograder.student import InMemory

SECONDS, SECRET = 20.0, b"mutants"  # a round of the references takes half a second at most


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant.

    Attributes
    ----------
    task, function, id : str
    killed_by : str         the measure that it misses, or why it could not be judged; empty for a survivor
    named : str             the mistake that it is taken for, or nothing
    fits : bool             whether it errs as that mistake does with inputs that nobody has seen, too
    """

    task: str
    function: str
    id: str
    killed_by: str
    named: str = ""
    fits: bool = True


class _Late(BaseException):
    """A mutant that never ends; no answer to a check catches it."""


def judge(mutant) -> Verdict:
    """Run the check of a mutant's task, with hidden inputs where the public ones do not tell it from right."""
    task = checks.assignment(mutant.assignment).find(mutant.task)
    found = ""
    try:
        with bounded(time.monotonic() + SECONDS, _Late):
            seen = _round(task, mutant, True)
            found = _missed(seen)
            if not found:
                return Verdict(task.id, mutant.function, mutant.id, _missed(_round(task, mutant, False)))
            named = likely.name(task, seen.calls)
            fits = named is None or likely_record.fits(mutant, named.id, SECRET)
    except _Late:
        return Verdict(task.id, mutant.function, mutant.id, found or "it never ends")
    return Verdict(task.id, mutant.function, mutant.id, found, named.id if named else "", fits)


def _round(task, mutant, public):
    reference = importlib.import_module(f"solutions.{mutant.assignment}")
    functions = {f.name: getattr(reference, f.name) for f in task.functions}
    calls = InMemory(functions | {mutant.function: mutant.code.compiled}, task).call
    return run_check(task, calls, reference, seed_of(SECRET, mutant.assignment, task.id, public), public)


def _missed(round_):
    if round_.failure is not None:
        return round_.failure.message
    return next((m.name for m in round_.measures if m.credit < 1 - 1e-9), "")


def run(chosen, jobs, progress=lambda: None) -> list[Verdict]:
    """Judge mutants in `jobs` processes; each has bounds on its time and memory."""
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(jobs, context) as pool:
        futures = [pool.submit(judge, mutant) for mutant in chosen]
        for _ in concurrent.futures.as_completed(futures):
            progress()
    return [future.result() for future in futures]


def chosen_for(answers) -> list:
    """The mutants of the functions that these known answers answer."""
    functions = dict.fromkeys((a.assignment, a.function) for a in answers)
    return [mutant for assignment, function in functions for mutant in mutants.mutants(assignment, function)]


def lines(verdicts) -> list[str]:
    """The table: for each function how many mutants lose marks, and the survivors with the reason why."""
    known, result = mutants.reasons(), []
    for function in dict.fromkeys(v.function for v in verdicts):
        own = [v for v in verdicts if v.function == function]
        left = [v for v in own if not v.killed_by]
        same = sum(v.id in known for v in left)
        few = f", all that there are of at least {mutants.LEAST}" if len(own) < mutants.LEAST else ""
        rate = (len(own) - len(left)) / max(len(own) - same, 1)
        result.append(f"{own[0].task} {function}: {len(own)} mutants{few}, {len(own) - len(left)} lose marks, "
                      f"{same} as right as the reference: {rate:.0%}")  # fmt: skip
        result += [f"  {'=' if v.id in known else '!'} {v.id}: {known.get(v.id, 'keeps all marks')}" for v in left]
    return result


def problems(verdicts) -> list[str]:
    """Survivors without a reason, and reasons for mutants that lose marks."""
    known = mutants.reasons()
    return [f"{v.id}: keeps all marks" for v in verdicts if not v.killed_by and v.id not in known] + [
        f"{v.id}: loses marks ({v.killed_by}), though it is said to be right" for v in verdicts if v.killed_by and v.id in known
    ]


def summary(verdicts) -> str:
    """How many mutants lose marks, and how many are taken for known mistakes."""
    killed = [v for v in verdicts if v.killed_by]
    same = len(verdicts) - len(killed) - sum("keeps" in p for p in problems(verdicts))
    named = [v for v in killed if v.named]
    unfit = [v for v in named if not v.fits]
    return (
        f"{len(verdicts)} mutants: {len(killed)} lose marks, {same} are as right as the reference; kill rate "
        f"{len(killed) / max(len(verdicts) - same, 1):.1%}; {len(named)} are taken for known mistakes, "
        f"{len(unfit)} of them ({len(unfit) / max(len(killed), 1):.1%} of all) err otherwise with hidden inputs"
    )
