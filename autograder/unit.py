"""One unit of work: a submission's bytes in, its result and pictures out, the same here and on a cluster."""

from __future__ import annotations

import contextlib
import hashlib
import json
import multiprocessing.util
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from autograder import store, submission, yardstick
from autograder.discover import Unit, member_bytes
from autograder.grade import grade, merged
from autograder.sandbox import PROCESS, Limits, Pool


@dataclass(frozen=True)
class Job:
    """How units are graded: the same for all of a run.

    Attributes
    ----------
    out : str           folder of the results
    level : str         isolation, one of `sandbox.STRENGTH`
    limits : Limits
    secret : bytes      what the hidden inputs are seeded with
    points : dict       assignment -> task id -> points, where they are not as released
    regrade : frozenset of str      students who are graded anew, though they have a result
    tasks : frozenset of str        task ids that are judged anew, though there is a result; its others are kept
    """

    out: str
    level: str
    limits: Limits
    secret: bytes
    points: dict = field(default_factory=dict)
    regrade: frozenset[str] = frozenset()
    tasks: frozenset[str] = frozenset()

    @property
    def terms(self) -> dict:
        """What a result must have been made under to be kept; the secret is told apart and not given away."""
        points = json.dumps(self.points, sort_keys=True) if self.points else ""
        return {"secret": hashlib.sha256(b"id:" + self.secret).hexdigest()[:12], "points": points}


@dataclass(frozen=True)
class Graded:
    """A result, and its pictures as PNG by task id."""

    unit: Unit
    result: dict
    pictures: dict[str, tuple[bytes, ...]]


def block_of(unit) -> bytes:
    """The bytes of a unit's notebook; raises submission.Rejected where there are none to judge."""
    if unit.problem:
        raise submission.Rejected(unit.problem)
    return submission.block_of(Path(unit.path)) if unit.member is None else member_bytes(unit)


def judge(unit, block, job, before=None) -> Graded:
    """Grade one unit.

    Parameters
    ----------
    unit : Unit
    block : bytes or submission.Rejected    what `block_of` gave
    job : Job
    before : dict                           a result of the same bytes whose tasks are kept, all but `job.tasks`
    """
    assignment = None if unit.assignment == "unknown" else unit.assignment
    with tempfile.TemporaryDirectory(prefix="course-") as folder, _sandboxes(job) as pool:
        path = Path(folder) / "submission.ipynb"
        if isinstance(block, bytes):
            path.write_bytes(block)
        problem = "" if isinstance(block, bytes) else str(block)
        points = job.points.get(assignment, {})
        only = job.tasks if before is not None else frozenset()
        result, judgements = grade(path, unit.student, pool, job.secret, assignment, problem, points, only)
    yardstick.add(result["checks"], judgements, job, result["assignment"])
    if before is not None:
        result = merged(before, result)
    elif unit.message:
        result["message"] = "; ".join(part for part in (result["message"], unit.message) if part)
    result["record"] |= {"file": unit.label, "source": fingerprint(block)} | job.terms
    return Graded(unit, result, store.draw(result, judgements))


def fingerprint(block) -> str:
    """What tells a notebook's bytes, to know a result that is still good."""
    return hashlib.sha256(block).hexdigest() if isinstance(block, bytes) else str(block)


@contextlib.contextmanager
def _sandboxes(job):
    """Sandboxes for one submission: those of this process, warm from the one before, where no task can harm them."""
    if job.level == PROCESS:
        with Pool(job.level, job.limits) as pool:
            yield pool
        return
    global _warm
    if _warm is None or (_warm.level, _warm.limits) != (job.level, job.limits):
        if _warm is not None:
            _warm.close()
        _warm = Pool(job.level, job.limits)
        multiprocessing.util.Finalize(_warm, _warm.close, exitpriority=1)
    yield _warm


_warm: Pool | None = None
