"""Scores in nbgrader's gradebook: SQLite by default, any database that it takes by URL."""

from __future__ import annotations

import json
import os
import sys
import warnings
from pathlib import Path

from autograder import report_view as view
from autograder import submission


def grade_cell(task_id) -> str:
    """The grade_id of the cell under a task that carries its points."""
    return f"check-{task_id.replace('.', '-')}"


def prepare() -> None:
    """Set this process up for nbgrader's gradebooks."""
    from sqlalchemy.exc import SAWarning

    # A new gradebook is stamped by `alembic`, which nbgrader runs by name: half of one would be left without it.
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    # nbgrader's models rely on relations that SQLAlchemy warns of, three times a submission.
    warnings.filterwarnings("ignore", category=SAWarning, module="nbgrader")


def record(out, url) -> int:
    """Write the scores of all results below `out` into a gradebook, as `nbgrader autograde` would.

    Parameters
    ----------
    out : path      what `course grade --out` has written
    url : str       of a database, as SQLAlchemy takes it: `sqlite:///gradebook.db`

    Returns
    -------
    int             submissions recorded; files of no known assignment are left out

    Notes
    -----
    Marks that a person gave stay, and are shown for review where the automatic one has changed. A gradebook that does
    not know an assignment yet is told its cells and points; one that `nbgrader generate_assignment` made knows them.
    """
    from nbgrader.api import Gradebook

    prepare()
    known = set(submission.known_assignments())
    count = 0
    with Gradebook(url) as book:
        for _, result, _ in view.results(Path(out)):
            if result is None or result["assignment"] not in known:
                continue
            _announce(book, result["assignment"])
            _record(book, result)
            count += 1
        book.db.commit()
    return count


def _announce(book, assignment):
    """Tell the gradebook an assignment's cells, where it does not know them."""
    from nbgrader.api import MissingEntry

    try:
        book.find_notebook(assignment, assignment)
        return
    except MissingEntry:
        pass
    book.update_or_create_assignment(assignment)
    book.update_or_create_notebook(assignment, assignment)
    released = json.loads(submission.release_path(assignment).read_text(encoding="utf-8"))
    for cell in released["cells"]:
        mark, kind = cell["metadata"].get("nbgrader"), cell["cell_type"]
        if mark is None:
            continue
        cell_of = (mark["grade_id"], assignment, assignment)
        if mark["grade"]:
            book.update_or_create_grade_cell(*cell_of, max_score=float(mark["points"]), cell_type=kind)
        if mark["solution"]:
            book.update_or_create_solution_cell(*cell_of)
        book.update_or_create_source_cell(
            *cell_of, cell_type=kind, locked=mark["locked"], source="".join(cell["source"]), checksum=mark.get("checksum")
        )


def _record(book, result):
    assignment, student = result["assignment"], view.text(result["student"], 120)
    book.update_or_create_student(student)
    book.update_or_create_submission(assignment, student)
    for check in result["checks"]:
        grade = book.find_grade(grade_cell(check["id"]), assignment, assignment, student)
        score = float(check["score"])
        grade.needs_manual_grade = grade.manual_score is not None and grade.auto_score != score
        grade.auto_score = score
