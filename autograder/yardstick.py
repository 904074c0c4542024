"""What a student's figures are held against: the reference, judged as a submission on this machine.

It runs in a sandbox of its own that no student's code ever enters, behind the same wall, on the same inputs. So its
error, its evaluations and its CPU time mean what a student's mean. No mark depends on them.
"""

from __future__ import annotations

import importlib
import inspect
from functools import cache

from autograder import checks, grade, judge, sandbox, submission


def add(records, judgements, job, assignment):
    """Say of each judged task how it and the reference stand.

    Parameters
    ----------
    records : list of dict          entries of a result; judged ones get `cpu_seconds_reference`, and, of the measure
                                    whose finite error is largest, `against_reference`: `measure`, `error`,
                                    `tolerance` and `error_reference`
    judgements : list of Judgement
    job : object                    with the `level`, `limits` and `secret` of the run
    assignment : str
    """
    by_id = {record["id"]: record for record in records}
    measured = [(j, judge.worst_of(j, finite=True)) for j in judgements if j.status in ("pass", "partial", "fail")]
    measured = [(j, worst) for j, worst in measured if worst is not None]
    reference = _judged(assignment, job.level, job.limits, job.secret) if measured else {}
    for judgement, worst in measured:
        other = reference[judgement.task.id]
        errors = [m.error for round_ in other.rounds for m in round_.measures if m.name == worst.name]
        if other.status == "pass" and errors and judgement.cpu_seconds:
            by_id[judgement.task.id] |= {
                "cpu_seconds_reference": round(other.cpu_seconds, 3),
                "against_reference": {
                    "measure": worst.name, "error": worst.error, "tolerance": worst.tolerance,
                    "error_reference": float(max(errors)),
                },
            }  # fmt: skip


@cache
def _judged(assignment, level, limits, secret):
    """Task id -> Judgement of the reference; once a process, for all submissions have the same inputs."""
    source = inspect.getsource(importlib.import_module(f"solutions.{assignment}"))
    names = [task.name for task in checks.assignment(assignment).tasks]
    cells = dict.fromkeys(names, "") | {names[0]: source}
    read = submission.Submission(assignment, "", cells, {}, frozenset(cells), "")
    with sandbox.Pool(level, limits) as pool:
        return {j.task.id: j for j in grade.judgements_of(read, pool, secret)}
