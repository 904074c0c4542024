"""A stranger's notebook as data: the source of its solution cells, by grade_id, and nothing else."""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from autograder import checks

ROOT = Path(__file__).resolve().parents[1]
MAX_BYTES = 30 << 20
RELEASE = re.compile(r"\d{1,4}\.\d{1,4}\.\d{1,4}")
TOO_LARGE = f"the file is larger than {MAX_BYTES >> 20} MB: clear the notebook's outputs and hand it in again"


class Rejected(Exception):
    """A file that is no submission: why, in one plain sentence."""


@dataclass(frozen=True)
class Released:
    """What students got: solution cells in their order, with the points of the checks under them, and the questions
    that a person marks."""

    assignment: str
    version: str
    cells: dict[str, str]
    points: dict[str, float]
    questions: dict[str, str]


@dataclass(frozen=True)
class Submission:
    """The solution cells of a submission, in the released order; `changed` are those that are not as released.

    `answers` are the texts in the cells that a person marks.
    """

    assignment: str
    version: str
    cells: dict[str, str]
    answers: dict[str, str]
    changed: frozenset[str]
    sha256: str


def read(path, assignment=None) -> Submission:
    """The solution cells of the notebook at `path`.

    Parameters
    ----------
    path : path             a file that may hold anything
    assignment : str        which assignment to read it as; by default the one that it names, or its stem does

    Raises
    ------
    Rejected                where the file cannot be read as a submission
    """
    block = block_of(Path(path))
    notebook = _parse(block)
    assignment = assignment or assignment_of(notebook, Path(path).stem)
    if assignment is None:
        raise Rejected("the notebook does not say which assignment it belongs to")
    released = release_of(assignment)
    sources, answers = _sources(notebook, "code", released.cells), _sources(notebook, "markdown", released.questions)
    if not sources:
        raise Rejected("none of the assignment's solution cells is in the notebook: their marks are lost")
    changed = {g for g, source in sources.items() if _bare(source) != _bare(released.cells[g])}
    course = notebook.get("metadata", {}).get("course", {})
    version = course.get("version") if isinstance(course, dict) else None
    version = version.encode("ascii", "replace").decode()[:40] if isinstance(version, str) else ""
    if RELEASE.fullmatch(version) and _release(version) != _release(released.version):
        raise Rejected(
            f"the notebook was made from release {version} of the course, and this grader judges release "
            f"{released.version}: hand it in on that release's notebook, or grade it with the course of {version}"
        )
    return Submission(assignment, version, sources, answers, frozenset(changed), hashlib.sha256(block).hexdigest())


def cells_of(block, assignment) -> dict[str, str]:
    """The sources of an assignment's solution cells in a file's bytes; Rejected where it is no notebook."""
    return _sources(_parse(block), "code", release_of(assignment).cells)


def _release(version):
    """What of a version changes when tasks do: 0.1 of 0.1.3."""
    return version.split(".")[:2]


def named_in(block, stem) -> str | None:
    """The assignment of a file's bytes, told by its metadata or by its stem; None where neither does."""
    try:
        return assignment_of(_parse(block), stem)
    except Rejected:
        return stem if stem in known_assignments() else None


def assignment_of(notebook, stem) -> str | None:
    """The assignment that a notebook's metadata names, else the one that its file's name does."""
    metadata = notebook.get("metadata")
    course = metadata.get("course") if isinstance(metadata, dict) else None
    named = course.get("assignment") if isinstance(course, dict) else None
    known = known_assignments()
    if isinstance(named, str) and named in known:
        return named
    return stem if stem in known else None


@cache
def known_assignments() -> tuple[str, ...]:
    """The assignments that are released and can be judged."""
    ready = checks.available()
    return tuple(name for name in ready if release_path(name).is_file())


def release_path(assignment) -> Path:
    """Where the released notebook of an assignment lies."""
    return ROOT / "assignments" / assignment / f"{assignment}.ipynb"


@cache
def release_of(assignment) -> Released:
    """The released notebook of an assignment, as far as marks go."""
    notebook = json.loads(release_path(assignment).read_text(encoding="utf-8"))
    cells, points, questions, last = {}, {}, {}, None
    for cell in notebook["cells"]:
        mark = cell["metadata"].get("nbgrader", {})
        if cell["cell_type"] != "code":
            if mark.get("solution"):
                questions[mark["grade_id"]] = _source(cell)
        elif mark.get("solution"):
            last = mark["grade_id"]
            cells[last] = _source(cell)
        elif mark.get("grade") and last is not None:
            points[last] = float(mark["points"])
    return Released(assignment, notebook["metadata"]["course"]["version"], cells, points, questions)


def block_of(path) -> bytes:
    """The bytes of a regular file that is no larger than a notebook may be."""
    try:
        if not path.is_file() or path.is_symlink():
            raise Rejected("not a regular file")
        with path.open("rb") as file:
            block = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise Rejected(f"the file cannot be read: {error.strerror}") from None
    if len(block) > MAX_BYTES:
        raise Rejected(TOO_LARGE)
    return block


def _parse(block):
    try:
        notebook = json.loads(block.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise Rejected("the file is not a notebook: it is not text in UTF-8") from None
    except RecursionError:
        raise Rejected("the file is not a notebook: its JSON is nested too deeply") from None
    except ValueError as error:
        where = f" (line {error.lineno})" if isinstance(error, json.JSONDecodeError) else ""
        raise Rejected(f"the file is not a notebook: it is not valid JSON{where}") from None
    if not isinstance(notebook, dict) or not isinstance(notebook.get("cells"), list):
        raise Rejected("the file is not a notebook of format 4: it has no list of cells")
    if not isinstance(notebook.get("metadata", {}), dict):
        notebook["metadata"] = {}
    return notebook


def _sources(notebook, cell_type, wanted):
    """The sources of the cells of a type by grade_id, of those that are wanted and in their order."""
    found: dict[str, list[str]] = {}
    for cell in notebook["cells"]:
        if isinstance(cell, dict) and cell.get("cell_type") == cell_type and _grade_id(cell) in wanted:
            # a cell that was split or copied has its id twice: in order, as the notebook would run them
            found.setdefault(_grade_id(cell), []).append(_source(cell))
    return {grade_id: "\n\n".join(found[grade_id]) for grade_id in wanted if grade_id in found}


def _grade_id(cell):
    metadata = cell.get("metadata")
    mark = metadata.get("nbgrader") if isinstance(metadata, dict) else None
    grade_id = mark.get("grade_id") if isinstance(mark, dict) else None
    return grade_id if isinstance(grade_id, str) else None


def _source(cell):
    source = cell.get("source", "")
    if isinstance(source, list):
        source = "".join(part for part in source if isinstance(part, str))
    return source if isinstance(source, str) else ""


def _bare(source):
    return [line.rstrip() for line in source.splitlines() if line.strip()]
