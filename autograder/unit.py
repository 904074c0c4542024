"""One unit of work: a submission's bytes in, its result and pictures out, the same here and on a cluster."""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import multiprocessing.util
import os
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from autograder import report, submission, yardstick
from autograder.discover import Unit, member_bytes
from autograder.grade import grade, merged
from autograder.sandbox import PROCESS, Limits, Pool

PICTURES = ("yours", "reference", "difference")


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
    return Graded(unit, result, draw(result, judgements))


def draw(result, judgements) -> dict[str, tuple[bytes, ...]]:
    """The pictures of the judged tasks as PNG, by task id; their captions and scales go into the result."""
    records = {record["id"]: record for record in result["checks"]}
    return {j.task.id: _drawn(j.picture, records[j.task.id]) for j in judgements if j.picture is not None}


def store(result, pictures, out, folder):
    """Write a result with its pictures and page below `out`; the result comes last, whole or not at all."""
    path = Path(out) / "results" / folder / f"{result['assignment']}.json"
    pages = Path(out) / "pages" / folder
    path.parent.mkdir(parents=True, exist_ok=True)
    for record in result["checks"]:
        for name, data in zip(PICTURES, pictures.get(record["id"], ()), strict=False):
            file = pages / result["assignment"] / f"{record['id']}-{name}.png"
            file.parent.mkdir(parents=True, exist_ok=True)
            _replace(file, data)
            record["images"][name] = os.path.relpath(file, path.parent).replace(os.sep, "/")
    report.write_page(result, path, Path(out))
    text = json.dumps(result, indent=1, ensure_ascii=True, allow_nan=False) + "\n"
    _replace(path, text.encode("ascii"))


def fingerprint(block) -> str:
    """What tells a notebook's bytes, to know a result that is still good."""
    return hashlib.sha256(block).hexdigest() if isinstance(block, bytes) else str(block)


def _drawn(picture, record):
    """The three pictures as PNG; their caption and scale go into the task's record."""
    from PIL import Image

    from framework.comparison import comparison_images

    shown = comparison_images(picture.yours, picture.expected, picture.kind)
    record.update(kind=shown.kind, scale=shown.scale, caption=f"{picture.caption}. {shown.caption}")
    drawn = []
    for pixels in (shown.yours, shown.expected, shown.difference):
        file = io.BytesIO()
        Image.fromarray(pixels).save(file, format="png", optimize=True)
        drawn.append(file.getvalue())
    return tuple(drawn)


def _replace(path, data):
    unfinished = path.with_name(f".{path.name}.unfinished")
    unfinished.write_bytes(data)
    os.replace(unfinished, path)


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
