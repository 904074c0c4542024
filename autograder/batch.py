"""Many submissions: the processes that grade them, and the files in which the results lie."""

from __future__ import annotations

import concurrent.futures
import contextlib
import hashlib
import json
import multiprocessing
import multiprocessing.util
import os
import signal
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from autograder import report, submission
from autograder.discover import Unit, member_bytes
from autograder.grade import grade
from autograder.sandbox import PROCESS, Limits, Pool

PICTURES = ("yours", "reference", "difference")


@dataclass(frozen=True)
class Job:
    """How units are graded: the same for all of a run."""

    out: str
    level: str
    limits: Limits
    secret: bytes

    @property
    def secret_id(self):
        """Tells two secrets apart without giving either away."""
        return hashlib.sha256(b"id:" + self.secret).hexdigest()[:12]


def run(units, job, jobs, progress) -> dict[str, int]:
    """Grade the units in `jobs` processes; results that are there already, of the same bytes, are kept.

    Parameters
    ----------
    units : list of Unit
    job : Job
    jobs : int
    progress : callable     is told the unit and its result's summary, or None where it was kept

    Returns
    -------
    dict                    how many results there are of each status

    Raises
    ------
    KeyboardInterrupt       after what was running has finished
    """
    states: dict[str, int] = {}

    def done(unit, status, kept):
        states[status] = states.get(status, 0) + 1
        progress(unit, status, kept)

    todo = []
    for unit in units:
        status = _kept(unit, job)
        if status is None:
            todo.append(unit)
        else:
            done(unit, status, True)
    if todo:
        _run_in_processes(todo, job, min(jobs, len(todo)), done)
    return states


def grade_unit(unit, job) -> str:
    """Grade one unit and write its pictures, page and result; the result comes last and stands for all.

    Returns
    -------
    str     the submission's status
    """
    path, problem = Path(unit.path), unit.problem
    with tempfile.TemporaryDirectory(prefix="course-") as folder, _sandboxes(job) as pool:
        if unit.member is not None and not problem:
            path = Path(folder) / "submission.ipynb"
            try:
                path.write_bytes(member_bytes(unit))
            except submission.Rejected as rejected:
                problem = str(rejected)
        result, judgements = grade(path, unit.student, pool, job.secret, _known(unit.assignment), problem)
    if unit.message:
        result["message"] = "; ".join(part for part in (result["message"], unit.message) if part)
    result["record"] |= {"file": unit.label, "secret": job.secret_id, "source": _fingerprint(unit)}
    write(result, judgements, Path(job.out), unit.folder)
    return result["status"]


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


def write(result, judgements, out, folder):
    """Write a result with its pictures and page below `out`, whole or not at all."""
    path = Path(out) / "results" / folder / f"{result['assignment']}.json"
    pages = Path(out) / "pages" / folder
    path.parent.mkdir(parents=True, exist_ok=True)
    for record, judgement in zip(result["checks"], judgements, strict=False):
        if judgement.picture is not None:
            record.update(_pictures(judgement.picture, record["id"], pages / result["assignment"], path.parent))
    report.write_page(result, path, Path(out))
    text = json.dumps(result, indent=1, ensure_ascii=True, allow_nan=False) + "\n"
    unfinished = path.with_name(f".{path.name}.unfinished")
    unfinished.write_text(text, encoding="utf-8")
    os.replace(unfinished, path)


def _pictures(picture, id, folder, beside):
    from PIL import Image

    from framework.comparison import comparison_images

    shown = comparison_images(picture.yours, picture.expected, picture.kind)
    folder.mkdir(parents=True, exist_ok=True)
    images = {}
    for name, pixels in zip(PICTURES, (shown.yours, shown.expected, shown.difference), strict=True):
        path = folder / f"{id}-{name}.png"
        unfinished = path.with_name(f".{path.name}.unfinished")
        Image.fromarray(pixels).save(unfinished, format="png", optimize=True)
        os.replace(unfinished, path)
        images[name] = os.path.relpath(path, beside).replace(os.sep, "/")
    return {"images": images, "scale": shown.scale, "caption": f"{picture.caption}. {shown.caption}"}


def _known(assignment):
    return None if assignment == "unknown" else assignment


def _fingerprint(unit):
    """What a unit's bytes are, to know a result that is still good; None where it cannot be read."""
    try:
        block = submission.block_of(Path(unit.path)) if unit.member is None else member_bytes(unit)
    except submission.Rejected as rejected:
        return str(rejected)
    return hashlib.sha256(block).hexdigest()


def _kept(unit, job):
    """The status of a finished result of the same bytes, secret and isolation, or None."""
    path = Path(job.out) / "results" / unit.folder / f"{unit.assignment}.json"
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
        record = result["record"]
        same = record["source"] == _fingerprint(unit) and record["secret"] == job.secret_id
        return result["status"] if same and result["isolation"] == job.level else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _run_in_processes(units, job, jobs, done):
    """A window of units over a pool: what runs is finished after Ctrl-C, what waits is not begun."""
    context = multiprocessing.get_context("spawn")
    waiting = iter(units)
    running: dict[concurrent.futures.Future, Unit] = {}
    interrupted = False
    with concurrent.futures.ProcessPoolExecutor(jobs, context, initializer=_ignore_interrupt) as pool:
        while True:
            try:
                while not interrupted and len(running) < jobs + 1:
                    unit = next(waiting, None)
                    if unit is None:
                        break
                    running[pool.submit(grade_unit, unit, job)] = unit
                if not running:
                    break
                finished, _ = concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED)
                for future in finished:
                    unit = running.pop(future)
                    done(unit, future.result(), False)
            except KeyboardInterrupt:
                if not interrupted:
                    print("\nstopping: what runs is finished first", file=sys.stderr)
                interrupted = True
    if interrupted:
        raise KeyboardInterrupt


def _ignore_interrupt():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
