"""Many submissions: what is to be graded, in which files the results lie, and the processes that do it."""

from __future__ import annotations

import concurrent.futures
import hashlib
import json
import multiprocessing
import os
import re
import signal
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

from autograder import report, submission
from autograder.grade import grade
from autograder.sandbox import Limits

PICTURES = ("yours", "reference", "difference")


@dataclass(frozen=True)
class Unit:
    """One submission to grade: where it is, whose it is, and what else was found of the same student."""

    path: str
    member: str | None
    student: str
    assignment: str
    folder: str = ""
    modified: float = 0.0
    problem: str = ""
    message: str = ""

    @property
    def label(self):
        """The file as a person would name it."""
        return _text(self.path) + (f" / {_text(self.member)}" if self.member else "")


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


def find(paths, notice=print) -> list[Unit]:
    """The submissions below the given paths; of several of one student and assignment the newest.

    Parameters
    ----------
    paths : list of path    notebooks, zips, folders of them
    notice : callable       is told in a sentence of what is left alone

    Returns
    -------
    list of Unit            sorted by student and assignment
    """
    newest: dict[tuple[str, str], Unit] = {}
    for path in map(Path, paths):
        for unit in _below(path, notice):
            key = unit.student, unit.assignment
            other = newest.get(key)
            if other is None:
                newest[key] = unit
                continue
            first, last = sorted((other, unit), key=lambda u: (u.modified, u.label))
            notice(f"{unit.student}, {unit.assignment}: {last.label} counts, being the newest; {first.label} does not")
            message = f"{last.message}; {first.label}" if last.message else f"not counted, being older: {first.label}"
            if first.message:
                message += "; " + first.message.removeprefix("not counted, being older: ")
            newest[key] = replace(last, message=message)
    return _named([newest[key] for key in sorted(newest)])


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
    if unit.problem or unit.member is not None:
        with tempfile.TemporaryDirectory(prefix="course-") as folder:
            path = Path(folder) / "submission.ipynb"
            problem = unit.problem
            if not problem:
                try:
                    path.write_bytes(_member_bytes(unit))
                except submission.Rejected as rejected:
                    problem = str(rejected)
            result, judgements = grade(path, unit.student, job.level, job.limits, job.secret,
                                       _known(unit.assignment), problem=problem)  # fmt: skip
    else:
        result, judgements = grade(Path(unit.path), unit.student, job.level, job.limits, job.secret,
                                   _known(unit.assignment))  # fmt: skip
    if unit.message:
        result["message"] = "; ".join(part for part in (result["message"], unit.message) if part)
    result["record"] |= {"file": unit.label, "secret": job.secret_id, "source": _fingerprint(unit)}
    write(result, judgements, Path(job.out), unit.folder)
    return result["status"]


def write(result, judgements, out, folder):
    """Write a result with its pictures and page below `out`, whole or not at all."""
    path = Path(out) / "results" / folder / f"{result['assignment']}.json"
    pages = Path(out) / "pages" / folder
    path.parent.mkdir(parents=True, exist_ok=True)
    for record, judgement in zip(result["checks"], judgements, strict=False):
        picture = next((r.picture for r in judgement.rounds if r.picture is not None), None)
        if picture is not None:
            record.update(_pictures(picture, record["id"], pages / result["assignment"], path.parent))
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


def _below(path, notice) -> Iterator[Unit]:
    if path.is_symlink() or not (path.is_file() or path.is_dir()):
        notice(f"{_text(str(path))}: left alone, not a regular file or folder")
    elif path.is_dir():
        yield from _in_folder(path, notice)
    elif path.suffix == ".zip":
        yield from _in_zip(path, given=True)
    else:
        yield _unit(path, None, path.stem, path.stat().st_mtime)


def _in_folder(top, notice):
    for folder, folders, files in os.walk(top, followlinks=False):
        here = Path(folder)
        folders.sort()
        for name in [n for n in folders if (here / n).is_symlink()]:
            notice(f"{_text(str(here / name))}: left alone, a link")
        for name in sorted(files):
            path = here / name
            is_zip = path.suffix == ".zip" and here == top
            if path.suffix != ".ipynb" and not is_zip:
                continue
            if path.is_symlink() or not path.is_file():
                notice(f"{_text(str(path))}: left alone, {'a link' if path.is_symlink() else 'a special file'}")
            elif is_zip:
                yield from _in_zip(path, given=False)
            else:
                student = path.stem if here == top else _student(path.relative_to(top).parent, top.resolve().name)
                yield _unit(path, None, student, path.stat().st_mtime)


def _student(folder, top_name):
    """The folder that holds the file; where that is an assignment's, the folder above."""
    if folder.name in submission.known_assignments():
        return folder.parent.name or top_name
    return folder.name


def _in_zip(path, given):
    stem = path.stem
    try:
        with zipfile.ZipFile(path) as file:
            entries = [e for e in file.infolist() if e.filename.endswith(".ipynb") and not e.is_dir()]
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError, UnicodeError, RuntimeError):
        yield Unit(str(path), None, stem, "unknown", problem="the zip is damaged", modified=path.stat().st_mtime)
        return
    if not entries:
        yield Unit(str(path), None, stem, "unknown", problem="no notebook is in the zip", modified=path.stat().st_mtime)
    for entry in entries[:10_000]:
        inside = PurePosixPath(entry.filename)
        folder = PurePosixPath(*[part for part in inside.parts[:-1] if part not in ("/", "..")])
        if not folder.parts:
            student = inside.stem if given else stem
        else:
            student = _student(folder, stem)
        yield _unit(path, entry.filename, student, _zip_time(entry))


def _zip_time(entry):
    import time

    try:
        return time.mktime((*entry.date_time, 0, 0, -1))
    except (ValueError, OverflowError):
        return 0.0


def _unit(path, member, student, modified):
    unit = Unit(str(path), member, _text(student), "unknown", modified=modified)
    stem = PurePosixPath(member).stem if member else path.stem
    try:
        block = submission.block_of(path) if member is None else _member_bytes(unit)
        name = submission.named_in(block, stem)
    except submission.Rejected:
        name = stem if stem in submission.known_assignments() else None
    return replace(unit, assignment=name or "unknown")


def _member_bytes(unit):
    try:
        with zipfile.ZipFile(unit.path) as file, file.open(unit.member) as entry:
            block = entry.read(submission.MAX_BYTES + 1)
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError, KeyError, RuntimeError, EOFError) as error:
        raise submission.Rejected(f"it cannot be unpacked: {type(error).__name__}") from None
    except Exception as error:  # zlib.error, lzma.LZMAError: what decompressors raise has no common base
        raise submission.Rejected(f"it cannot be unpacked: {type(error).__name__}") from None
    if len(block) > submission.MAX_BYTES:
        raise submission.Rejected(submission.TOO_LARGE)
    return block


def _named(units):
    """Folder names that any system takes, one for each student, the same whatever else is graded beside."""
    names: dict[str, str] = {}
    taken: dict[str, str] = {}
    for student in sorted({unit.student for unit in units}):
        plain = re.sub(r"[^A-Za-z0-9._-]", "_", student)[:80]
        if plain != student or plain.strip(".") == "" or taken.get(plain.lower(), student) != student:
            plain = f"{plain[:71]}-{hashlib.sha256(student.encode()).hexdigest()[:8]}"
        taken[plain.lower()] = student
        names[student] = plain
    return [replace(unit, folder=names[unit.student]) for unit in units]


def _text(name):
    """A file's name as text: bytes that are not UTF-8 are escaped."""
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


def _known(assignment):
    return None if assignment == "unknown" else assignment


def _fingerprint(unit):
    """What a unit's bytes are, to know a result that is still good; None where it cannot be read."""
    try:
        block = submission.block_of(Path(unit.path)) if unit.member is None else _member_bytes(unit)
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
