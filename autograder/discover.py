"""What there is to grade: submissions below the given paths, whose they are, and where their results go."""

from __future__ import annotations

import hashlib
import os
import re
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

from autograder import submission


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
    try:
        return time.mktime((*entry.date_time, 0, 0, -1))
    except (ValueError, OverflowError):
        return 0.0


def _unit(path, member, student, modified):
    unit = Unit(str(path), member, _text(student), "unknown", modified=modified)
    stem = PurePosixPath(member).stem if member else path.stem
    try:
        block = submission.block_of(path) if member is None else member_bytes(unit)
        name = submission.named_in(block, stem)
    except submission.Rejected:
        name = stem if stem in submission.known_assignments() else None
    return replace(unit, assignment=name or "unknown")


def member_bytes(unit) -> bytes:
    """The bytes of a notebook in a zip; raises submission.Rejected."""
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
