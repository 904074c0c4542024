"""One submission: its tasks judged one by one, each alone, and what they are worth."""

from __future__ import annotations

import importlib
import inspect
import time

from autograder import checks, submission
from autograder.judge import (
    UNJUDGED,
    Judgement,
    Round,
    check_record,
    result_of,
    rounded,
    run_check,
    seed_of,
    settle,
    summed,
    versions,
)
from autograder.student import Failure, Remote, out_of_time, why_ended

DEFAULT_SECRET = b"envmap-course"


def grade(path, student, pool, secret=DEFAULT_SECRET, assignment=None, problem="", points=None, only=()):
    """Judge one notebook.

    Parameters
    ----------
    path : path             the file; it may hold anything
    student : str           whose it is
    pool : sandbox.Pool     of the isolation and the limits wanted
    secret : bytes          what the hidden inputs are seeded with
    assignment : str        by default the one that the notebook names
    problem : str           why the file cannot be read, where that is known already
    points : dict           task id -> points, where they are not as released; at 0 a task is not judged
    only : set of str       ids of the tasks to judge; by default all

    Returns
    -------
    dict                    the result as the contract describes it
    list of Judgement       what it was made from; empty where the file was rejected
    """
    begun = time.monotonic()
    try:
        if problem:
            raise submission.Rejected(problem)
        read = submission.read(path, assignment)
    except submission.Rejected as rejected:
        return _rejected(assignment or "unknown", student, str(rejected), pool.level, points or {}), []
    judgements = _Session(read, pool, secret, points or {}).judge_all(only)
    result = result_of(read, student, pool.level, judgements)
    result["wall_seconds"] = round(time.monotonic() - begun, 3)
    return result, judgements


def judgements_of(read, pool, secret):
    """Every task of what was read, judged: a Judgement each."""
    return _Session(read, pool, secret, {}).judge_all(())


class _Session:
    """One submission, and what was learnt while its tasks were judged."""

    def __init__(self, read, pool, secret, points):
        self.read, self.pool, self.limits, self.secret = read, pool, pool.limits, secret
        self.assignment = checks.assignment(read.assignment)
        self.points = _points(self.assignment, points)
        self.reference = importlib.import_module(f"solutions.{read.assignment}")
        self.deadline = self.until = time.monotonic() + self.limits.submission_seconds
        self.order = [f.name for task in self.assignment.tasks for f in task.functions]
        self.hanging: dict[int, Failure] = {}

    def judge_all(self, only):
        """Every task, or these, in order, each in a process of its own.

        Half of the submission's time is kept for the tasks that are still to come, an equal part for each: `until` is
        when the one that is judged must be done.
        """
        tasks = [task for task in self.assignment.tasks if not only or task.id in only]
        part = self.limits.submission_seconds / (2 * len(tasks))
        judgements = []
        for to_come, task in zip(reversed(range(len(tasks))), tasks, strict=True):
            self.until = self.deadline - to_come * part
            judgements.append(self._judge(task))
        return judgements

    def _judge(self, task):
        result = Judgement(task, self.points[task.id], [])
        if result.points == 0:
            settle(result)
            return result
        if task.name not in self.read.changed:
            result.status = "not_attempted"
            present = task.name in self.read.cells
            result.message = "as released: nothing was filled in" if present else "its cell is missing in the notebook"
            return result
        self._try(task, result)
        if any(r.failure and r.failure.status == "timeout" and "CPU" not in r.failure.message for r in result.rounds):
            # a busy machine can make an honest task late: once more, alone
            if self.until - time.monotonic() > self.limits.call_wall_seconds:
                first, result.rounds = result.rounds, []
                self._try(task, result)
                result.rounds = result.rounds or first
        settle(result)
        return result

    def _try(self, task, result):
        """Judge in a fresh process; a cell outside functions that never ends is skipped in a second one."""
        for _ in range(len(self.read.cells) + 1):
            if time.monotonic() >= self.until:
                result.rounds = [Round(True, failure=out_of_time(self.limits))]
                return
            stuck = self._run(task, result)
            if stuck is None or stuck in self.hanging:
                return
            failure = result.rounds[0].failure
            self.hanging[stuck] = Failure(failure.status, f"the code outside functions in its cell: {failure.message}")
            result.rounds = []

    def _run(self, task, result):
        """One process for the task. Returns the index of a cell that never came back, or None."""
        box = self.pool.sandbox(task.forbidden)
        link = box.start_task()
        lower = self.order[: self.order.index(task.name)]
        names = [f.name for f in task.functions]
        references = {name: getattr(self.reference, name) for name in lower}
        job = {
            "task": task.name, "forbidden": task.forbidden, "cells": list(self.read.cells.items()),
            "skip": sorted(self.hanging), "higher": self.order[len(lower) + len(names) :],
            "lower": [(name, i, list(inspect.signature(f).parameters)) for i, (name, f) in enumerate(references.items())],
        }  # fmt: skip
        remote, loaded = Remote(box, link, references, self.until), False
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
            self.pool.drop(task.forbidden)
        else:
            result.cpu_seconds, result.peak_memory_mb = ended.cpu_seconds, ended.peak_memory_mb
        return None if loaded else remote.cell

    def _rounds(self, task, remote, result):
        index = list(self.read.cells).index(task.name)
        broken = remote.cell_failures.get(index) or self.hanging.get(index)
        for public in (True, False):
            if not public and result.rounds[0].failure and result.rounds[0].failure.status in UNJUDGED:
                break
            seed = seed_of(self.secret, self.assignment.name, task.id, public)
            round_ = run_check(task, remote.call, self.reference, seed, public)
            if round_.failure and broken and "is not defined in its cell" in round_.failure.message:
                round_.failure = Failure(broken.status, f"its cell fails: {broken.message}", broken.traceback)
            result.rounds.append(round_)


def merged(before, result) -> dict:
    """A result with the tasks of `result` in place of those that `before` had, everything else summed anew."""
    new = {record["id"]: record for record in result["checks"]}
    return result | summed([new.get(record["id"], record) for record in before["checks"]])


def _points(assignment, points):
    """Points by task id: as released, but where the instructor says otherwise."""
    released = submission.release_of(assignment.name).points
    return {task.id: float(points.get(task.id, released[task.name])) for task in assignment.tasks}


def _rejected(name, student, message, level, points):
    """The result of a file that is no submission: its tasks with 0, none where it names no assignment."""
    tasks = []
    if name != "unknown":
        worth = _points(checks.assignment(name), points)
        tasks = [
            check_record(Judgement(task, worth[task.id], [], "not_attempted", message="the file was rejected"))
            for task in checks.assignment(name).tasks
        ]
    return {
        "schema": 1, "assignment": name, "student": student, "status": "rejected", "message": message, "score": 0.0,
        "max_score": rounded(sum(t["max_score"] for t in tasks)), "isolation": level, "wall_seconds": 0.0,
        "peak_memory_mb": 0.0, "checks": tasks, "record": versions(),
    }  # fmt: skip
