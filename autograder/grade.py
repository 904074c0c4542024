"""One submission: its tasks judged one by one, each alone, and what they are worth."""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import importlib
import inspect
import math
import time
from dataclasses import dataclass, field

import numpy as np

import framework
from autograder import checks, submission
from autograder.sandbox import Limits, Sandbox, SandboxFailed
from autograder.student import Failure, Remote, why_ended

PUBLIC_SHARE, WORK_SHARE = 0.3, 0.2
UNJUDGED = ("timeout", "out_of_memory", "crashed")
DEFAULT_SECRET = b"envmap-course"


@dataclass
class Round:
    """One run of a check: its measures, or why it could not be judged."""

    public: bool
    measures: list = field(default_factory=list)
    failure: Failure | None = None
    picture: checks.Picture | None = None
    calls: list = field(default_factory=list)

    @property
    def fraction(self):
        """The part of the points that this round earns."""
        if self.failure is not None or not self.measures:
            return 0.0
        values = [m for m in self.measures if not m.work]
        fraction = sum(m.share * m.credit for m in values) / sum(m.share for m in values)
        for work in (m for m in self.measures if m.work):
            passed = all(m.credit == 1 for m in values)
            fraction = (1 - WORK_SHARE) * fraction + WORK_SHARE * (work.credit if passed else 0.0)
        return fraction


@dataclass
class Judgement:
    """A task's result: the two rounds, and what was seen of the process."""

    task: checks.Task
    points: float
    rounds: list[Round]
    status: str = ""
    score: float = 0.0
    message: str = ""
    printed: str = ""
    cpu_seconds: float = 0.0
    peak_memory_mb: float = 0.0


def run_check(task, student_calls, expected, seed, public):
    """Run a task's check once.

    Parameters
    ----------
    task : Task
    student_calls : callable    (name, arguments, returns) -> list of arrays; raises Failure
    expected : namespace        the right functions
    seed : int                  of the inputs
    public : bool

    Returns
    -------
    Round
    """
    trial = checks.Trial(task, student_calls, expected, np.random.default_rng(seed), public)
    result = Round(public)
    try:
        with np.errstate(all="ignore"):
            for measure in task.check(trial):
                if not math.isfinite(measure.error) and not measure.message:
                    raise Failure("error", f"{measure.name}: the error is infinite")
                result.measures.append(measure)
    except Failure as failure:
        result.failure = failure
    result.picture, result.calls = trial.picture, trial.calls
    return result


def seed_of(secret, assignment, task_id, public) -> int:
    """The seed of a task's inputs: fixed for public ones, from the secret for hidden ones."""
    key = b"public" if public else b"hidden:" + secret
    digest = hmac.new(key, f"{assignment}/{task_id}".encode(), hashlib.sha256).digest()
    return int.from_bytes(digest[:8], "little")


def grade(path, student, level, limits=None, secret=DEFAULT_SECRET, assignment=None, problem=""):
    """Judge one notebook.

    Parameters
    ----------
    path : path             the file; it may hold anything
    student : str           whose it is
    level : str             isolation, one of `sandbox.STRENGTH`
    limits : Limits
    secret : bytes          what the hidden inputs are seeded with
    assignment : str        by default the one that the notebook names
    problem : str           why the file cannot be read, where that is known already

    Returns
    -------
    dict                    the result as the contract describes it
    list of Judgement       what it was made from; empty where the file was rejected
    """
    limits = limits or Limits()
    begun = time.monotonic()
    try:
        if problem:
            raise submission.Rejected(problem)
        read = submission.read(path, assignment)
    except submission.Rejected as rejected:
        return _rejected(assignment or "unknown", student, str(rejected), level), []
    session = _Session(read, level, limits, secret)
    judgements = session.judge_all()
    result = {
        "schema": 1, "assignment": read.assignment, "student": student, "status": _status(judgements),
        "message": session.message, "score": 0.0, "max_score": 0.0, "isolation": level,
        "wall_seconds": round(time.monotonic() - begun, 3),
        "peak_memory_mb": round(max((j.peak_memory_mb for j in judgements), default=0.0), 1),
        "checks": [_check_record(j) for j in judgements],
        "record": {"sha256": read.sha256, "notebook_version": read.version, "course_version": framework.__version__},
    }  # fmt: skip
    result["score"] = _round(sum(c["score"] for c in result["checks"]))
    result["max_score"] = _round(sum(c["max_score"] for c in result["checks"]))
    if result["status"] in UNJUDGED and not result["message"]:
        result["message"] = next(j.message for j in judgements if j.status == result["status"])
    return result, judgements


class _Session:
    """The sandboxes of one submission, and what was learnt while its tasks were judged."""

    def __init__(self, read, level, limits, secret):
        self.read, self.level, self.limits, self.secret = read, level, limits, secret
        self.assignment = checks.assignment(read.assignment)
        self.released = submission.release_of(read.assignment)
        self.reference = importlib.import_module(f"solutions.{read.assignment}")
        self.deadline = time.monotonic() + limits.submission_seconds
        self.order = [f.name for task in self.assignment.tasks for f in task.functions]
        self.hanging: dict[int, Failure] = {}
        self.message = ""

    def judge_all(self):
        """Every task, in order; tasks with the same forbidden modules share a sandbox, one process each."""
        judgements = []
        with contextlib.ExitStack() as stack:
            self.stack, self.box = stack, None
            for task in self.assignment.tasks:
                judgements.append(self._judge(task))
        return judgements

    def _judge(self, task):
        result = Judgement(task, self.released.points[task.name], [])
        if task.name not in self.read.changed:
            result.status = "not_attempted"
            present = task.name in self.read.cells
            result.message = "as released: nothing was filled in" if present else "its cell is missing in the notebook"
            return result
        self._try(task, result)
        if any(r.failure and r.failure.status == "timeout" and "CPU" not in r.failure.message for r in result.rounds):
            # a busy machine can make an honest task late: once more, alone
            if self.deadline - time.monotonic() > self.limits.call_wall_seconds:
                first, result.rounds = result.rounds, []
                self._try(task, result)
                result.rounds = result.rounds or first
        _settle(result)
        return result

    def _try(self, task, result):
        """Judge in a fresh process; a cell outside functions that never ends is skipped in a second one."""
        for _ in range(len(self.read.cells) + 1):
            if time.monotonic() >= self.deadline:
                text = f"the submission took over {self.limits.submission_seconds:g} s"
                result.rounds = [Round(True, failure=Failure("timeout", text))]
                return
            stuck = self._run(task, result)
            if stuck is None or stuck in self.hanging:
                return
            cell, failure = list(self.read.cells)[stuck], result.rounds[0].failure
            self.hanging[stuck] = Failure(failure.status, f"the code outside functions in its cell: {failure.message}")
            if cell == task.name:
                result.rounds = [Round(True, failure=self.hanging[stuck])]
                return
            result.rounds = []

    def _run(self, task, result):
        """One process for the task. Returns the index of a cell that never came back, or None."""
        box = self._sandbox(task.forbidden)
        link = box.start_task()
        lower = self.order[: self.order.index(task.name)]
        names = [f.name for f in task.functions]
        references = {name: getattr(self.reference, name) for name in lower}
        job = {
            "task": task.name, "forbidden": task.forbidden, "cells": list(self.read.cells.items()),
            "skip": sorted(self.hanging), "higher": self.order[len(lower) + len(names) :],
            "lower": [(name, i, list(inspect.signature(f).parameters)) for i, (name, f) in enumerate(references.items())],
        }  # fmt: skip
        remote, loaded = Remote(box, link, references, self.deadline), False
        with link:
            try:
                remote.load(job)
                loaded = True
                self._rounds(task, remote, result)
                remote.stop()
            except Failure as failure:
                result.rounds = [Round(True, failure=failure)]
            ended = box.end_task()
            result.printed = box.printed()
        for round_ in result.rounds:
            if round_.failure is not None:
                round_.failure = why_ended(round_.failure, ended, self.limits)
        if ended is None or not ended.clean:
            self.stack.close()
            self.box = None
        else:
            result.cpu_seconds, result.peak_memory_mb = ended.cpu_seconds, ended.peak_memory_mb
        return None if loaded else remote.cell

    def _rounds(self, task, remote, result):
        broken = remote.cell_failures.get(list(self.read.cells).index(task.name))
        for public in (True, False):
            if not public and result.rounds[0].failure and result.rounds[0].failure.status in UNJUDGED:
                break
            seed = seed_of(self.secret, self.assignment.name, task.id, public)
            round_ = run_check(task, remote.call, self.reference, seed, public)
            if round_.failure and broken and "is not defined in its cell" in round_.failure.message:
                round_.failure = Failure("error", f"its cell fails: {broken.message}", broken.traceback)
            result.rounds.append(round_)

    def _sandbox(self, forbidden):
        if self.box is None or self.box[0] != forbidden:
            self.stack.close()
            try:
                self.box = forbidden, self.stack.enter_context(Sandbox(self.level, self.limits, forbidden))
            except SandboxFailed:
                # a machine short of processes or memory for a moment
                time.sleep(1)
                self.box = forbidden, self.stack.enter_context(Sandbox(self.level, self.limits, forbidden))
        return self.box[1]


def _settle(result):
    """Status, score and message of a task from its rounds."""
    shares = [PUBLIC_SHARE, 1 - PUBLIC_SHARE] if len(result.rounds) > 1 else [1.0]
    failures = [r.failure for r in result.rounds if r.failure is not None]
    if len(result.rounds) == 1 and result.rounds[0].failure:
        shares = [0.0]
    fraction = sum(share * r.fraction for share, r in zip(shares, result.rounds, strict=True))
    result.score = _round(result.points * fraction)
    broken = next((f for f in failures if f.status in UNJUDGED), None)
    if broken is not None:
        result.status, result.message = broken.status, broken.message
    elif fraction >= 1 - 1e-9:
        result.status, result.message = "pass", "all measures lie within their tolerances"
    elif failures:
        result.status = "partial" if fraction > 0 else "error"
        result.message = failures[0].message
        if failures[0].status == "not_attempted":
            result.message = "it still raises NotImplementedError: take that line out"
    else:
        result.status = "partial" if fraction > 0 else "fail"
        result.message = _first_miss(result.rounds)


def _first_miss(rounds):
    for round_ in rounds:
        for measure in round_.measures:
            if measure.credit < 1:
                hidden = "" if round_.public else " (on inputs that the notebook does not show)"
                error, limit = _number(measure.error), _number(measure.tolerance)
                why = f" {measure.message}:" if measure.message and not measure.work else ""
                if measure.work:
                    return f"right, but more work than needed: {measure.message}"
                return f"{measure.name}:{why} the error is {error}, allowed is {limit}{hidden}"
    return ""


def _check_record(judgement):
    """A task's entry in the result."""
    measures = [(m, r.public) for r in judgement.rounds for m in r.measures]
    values = [m for m, _ in measures if not m.work]
    worst = max(values, key=_over, default=None)
    works = [m for m, _ in measures if m.work]
    failure = next((r.failure for r in judgement.rounds if r.failure is not None), None)
    return {
        "id": judgement.task.id, "name": judgement.task.name, "status": judgement.status,
        "score": judgement.score, "max_score": judgement.points,
        "metric": worst.metric if worst else None,
        "error": _finite(worst.error) if worst else None,
        "tolerance": _finite(worst.tolerance) if worst else None,
        "evaluations": sum(m.evaluations for m in works) if works else None,
        "evaluations_reference": sum(m.evaluations_reference for m in works) if works else None,
        "message": judgement.message, "likely_mistake": None, "hint": None,
        "images": {"yours": None, "reference": None, "difference": None},
        "title": judgement.task.asks, "cpu_seconds": round(judgement.cpu_seconds, 3),
        "traceback": failure.traceback if failure else "", "prints": judgement.printed,
        "measures": [
            {"name": m.name, "metric": m.metric, "error": _finite(m.error), "tolerance": _finite(m.tolerance),
             "credit": m.credit, "share": m.share, "message": m.message, "public": public, "work": m.work}
            for m, public in measures
        ],
    }  # fmt: skip


def _rejected(name, student, message, level):
    """The result of a file that is no submission: its tasks with 0, none where it names no assignment."""
    tasks = []
    if name != "unknown":
        points = submission.release_of(name).points
        tasks = [
            _check_record(Judgement(task, points[task.name], [], "not_attempted", message="the file was rejected"))
            for task in checks.assignment(name).tasks
        ]
    return {
        "schema": 1, "assignment": name, "student": student, "status": "rejected", "message": message, "score": 0.0,
        "max_score": _round(sum(t["max_score"] for t in tasks)), "isolation": level, "wall_seconds": 0.0,
        "peak_memory_mb": 0.0, "checks": tasks, "record": {"course_version": framework.__version__},
    }  # fmt: skip


def _status(judgements):
    states = [j.status for j in judgements]
    if all(state == "not_attempted" for state in states):
        return "not_attempted"
    if any(state in ("pass", "partial", "fail", "error") for state in states):
        return "graded"
    return next(state for state in UNJUDGED if state in states)


def _over(measure):
    if measure.tolerance > 0:
        return measure.error / measure.tolerance
    return math.inf if measure.error > 0 else 0.0


def _finite(value):
    return float(value) if math.isfinite(value) else None


def _number(value):
    return "infinite" if not math.isfinite(value) else f"{value:.3g}"


def _round(value):
    return round(float(value), 4)
