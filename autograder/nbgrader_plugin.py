"""nbgrader's own commands with our judgement in place of its `Execute`: `nbgrader_config.py` calls `configure`.

nbgrader never opens a stranger's file. Before `autograde` reads submissions, each is rebuilt: the released notebook, with
the source of the solution cells taken over by grade_id, and the answers that a person marks as plain text. Links, special
files and whatever else lies beside a notebook stay where they are.
"""

from __future__ import annotations

import contextlib
import fnmatch
import functools
import io
import os
import re
import shutil
import tempfile
from base64 import b64encode
from pathlib import Path

import nbformat
import numpy as np
from nbgrader import utils
from nbgrader.converters import Autograde, GenerateAssignment
from nbgrader.converters.base import NbGraderException
from nbgrader.preprocessors import NbGraderPreprocessor
from PIL import Image
from traitlets import Bool, Unicode

from autograder import gradebook, sandbox, submission
from autograder.grade import DEFAULT_SECRET, grade
from autograder.release import ASSIGNMENTS, write_source
from autograder.report_view import text
from framework.comparison import comparison_images


class Judge(NbGraderPreprocessor):
    """Puts into each grade cell its score as a number, what was found in a sentence, and the three pictures."""

    secret_file = Unicode("", help="its bytes seed the inputs that students do not see").tag(config=True)
    allow_weak_isolation = Bool(
        False, help="grade where only a plain process is to be had: a notebook can do what you can"
    ).tag(config=True)

    def preprocess(self, nb, resources):
        """Judge a rebuilt notebook; its cells are numbers, texts and pictures of ours afterwards."""
        level = sandbox.strongest_level()
        if level == sandbox.PROCESS and not self.allow_weak_isolation:
            raise NbGraderException(
                "NOT ISOLATED: this machine starts no sandbox (see `course doctor`), and nothing is graded; "
                "c.Judge.allow_weak_isolation = True in nbgrader_config.py grades all the same"
            )
        names = resources["nbgrader"]
        secret = Path(self.secret_file).read_bytes().strip() if self.secret_file else DEFAULT_SECRET
        problem = nb.metadata.get("course", {}).pop("problem", "")
        with tempfile.TemporaryDirectory(prefix="course-") as folder:
            path = Path(folder) / "submission.ipynb"
            nbformat.write(nb, path)
            with sandbox.Pool(level, sandbox.Limits()) as pool:
                result, judgements = grade(path, names["student"], pool, secret, names["assignment"], problem)
        self.log.info("%s: %s, %g of %g", names["student"], result["status"], result["score"], result["max_score"])
        records = {gradebook.grade_cell(record["id"]): record for record in result["checks"]}
        pictures = {gradebook.grade_cell(j.task.id): j.picture for j in judgements}
        for cell in nb.cells:
            if cell.cell_type != "code":
                continue
            cell.outputs, cell.execution_count = [], None
            record = records.get(cell.metadata.get("nbgrader", {}).get("grade_id"))
            if record is not None:
                cell.outputs = _outputs(record, result, pictures.get(cell.metadata.nbgrader.grade_id))
        return nb, resources


def _outputs(record, result, picture):
    """The score first: it is what nbgrader reads. Never without one, for a cell without outputs has full marks."""
    score = min(max(float(record["score"]), 0.0), float(record["max_score"]))
    said = [f"{record['status']}: {'; '.join(part for part in (record['message'], result['message']) if part)}"]
    said += [record[key] for key in ("symptom", "hint", "traceback", "prints") if record.get(key)]
    outputs = [
        nbformat.v4.new_output("execute_result", {"text/plain": repr(score)}),
        nbformat.v4.new_output("display_data", {"text/plain": text("\n".join(said), 8000)}),
    ]
    if picture is not None:
        caption = f"yours, expected, difference: {picture.caption}"
        for data in ({"text/plain": caption}, {"image/png": _side_by_side(picture)}):
            outputs.append(nbformat.v4.new_output("display_data", data))
    return outputs


def _side_by_side(picture, least=192):
    """Yours, expected and the difference in one PNG, in base 64; small ones in larger pixels."""
    shown = comparison_images(picture.yours, picture.expected, picture.kind)
    zoom = max(1, least // max(shown.yours.shape[:2]))
    parts = [part.repeat(zoom, axis=0).repeat(zoom, axis=1) for part in (shown.yours, shown.expected, shown.difference)]
    gap = np.full((len(parts[0]), 8, 3), 255, np.uint8)
    file = io.BytesIO()
    Image.fromarray(np.concatenate([parts[0], gap, parts[1], gap, parts[2]], axis=1)).save(file, "PNG", optimize=True)
    return b64encode(file.getvalue()).decode()


def rebuilt(path, assignment):
    """The released notebook with what a submission brings to it.

    Parameters
    ----------
    path : Path         a stranger's file; it may hold anything
    assignment : str

    Returns
    -------
    nbformat.NotebookNode   as released where the file is no submission; `metadata.course.problem` says why
    """
    notebook = nbformat.read(submission.release_path(assignment), as_version=4)
    try:
        read = submission.read(path, assignment)
    except submission.Rejected as rejected:
        notebook.metadata.course["problem"] = str(rejected)
        return notebook
    for cell in notebook.cells:
        grade_id = cell.metadata.get("nbgrader", {}).get("grade_id")
        if grade_id in read.cells:
            cell.source = read.cells[grade_id].encode("utf-8", "replace").decode()  # halves of surrogate pairs
        elif grade_id in read.answers and read.answers[grade_id].strip() != cell.source.strip():
            cell.source = _fenced(read.answers[grade_id])
    return notebook


def _fenced(answer, limit=100_000):
    """A student's prose as a block of plain text: markdown may hold scripts, which formgrader would run."""
    fence = "`" * (1 + max(2, *(len(run) for run in re.findall("`+", answer)), 2))
    return f"{fence}text\n{text(answer, limit)}\n{fence}"


@contextlib.contextmanager
def _mirror(course, log):
    """While this is open, nbgrader finds rebuilt submissions in place of those that were handed in."""
    handed_in = course.submitted_directory
    mirror = Path(tempfile.mkdtemp(prefix=".rebuilt-", dir=course.root))
    course.submitted_directory = mirror.name
    try:
        top = Path(course.root) / handed_in
        for student in sorted(os.listdir(top)) if top.is_dir() else []:
            folder = top / student / course.assignment_id
            if not fnmatch.fnmatchcase(student, course.student_id) or not os.path.lexists(folder):
                continue
            _rebuild(folder, mirror / student / course.assignment_id, course.assignment_id, log)
        yield
    finally:
        course.submitted_directory = handed_in
        shutil.rmtree(mirror, ignore_errors=True)


def _rebuild(folder, into, assignment, log):
    shown = text(os.fsencode(folder).decode("utf-8", "backslashreplace"), 300)
    path = folder / f"{assignment}.ipynb"
    if folder.is_symlink() or folder.parent.is_symlink() or path.is_symlink():
        log.warning("%s: left alone, a link", shown)
    elif not str(folder).isprintable():
        log.warning("%s: left alone, for its name cannot be kept in a gradebook", shown)
    elif not path.is_file():
        log.warning("%s: there is no %s.ipynb in it", shown, assignment)
    else:
        into.mkdir(parents=True)
        nbformat.write(rebuilt(path, assignment), into / path.name)
        _copy_timestamp(folder / "timestamp.txt", into, log)


def _copy_timestamp(path, into, log):
    """When it was handed in, where that is a time: nbgrader stops the whole run at one that is none."""
    if not path.is_file() or path.is_symlink() or path.stat().st_size > 200:
        return
    try:
        words = path.read_text(encoding="utf-8").strip()
        utils.parse_utc(words)
    except (ValueError, OverflowError):
        log.warning("%s is no time, and does not count", path)
        return
    (into / "timestamp.txt").write_text(words, encoding="utf-8")


def configure(c) -> None:
    """Set nbgrader up for this course.

    Parameters
    ----------
    c : traitlets.config.Config     as `get_config()` gives it in `nbgrader_config.py`
    """
    c.CourseDirectory.ignore = [".ipynb_checkpoints", "*.pyc", "__pycache__"]
    c.Autograde.autograde_preprocessors = [
        "autograder.nbgrader_plugin.Judge",
        "nbgrader.preprocessors.IgnorePattern",
        "nbgrader.preprocessors.LimitOutput",
        "nbgrader.preprocessors.SaveAutoGrades",
        "nbgrader.preprocessors.AssignLatePenalties",
        "nbgrader.preprocessors.CheckCellMetadata",
    ]
    c.OverwriteCells.add_missing_cells = True
    c.GenerateFeedback.preprocessors = [
        "nbgrader.preprocessors.GetGrades",
        "nbgrader.preprocessors.ClearHiddenTests",
        "nbconvert.preprocessors.CSSHTMLHeaderPreprocessor",
    ]
    gradebook.prepare()
    _wrap(Autograde, _mirror)
    _wrap(GenerateAssignment, _sources)


@contextlib.contextmanager
def _sources(course, log):
    """Build the source of an assignment where there is none yet."""
    name = course.assignment_id
    if name in ASSIGNMENTS and not (Path(course.root) / course.source_directory / name).is_dir():
        log.info("Building %s/%s from solutions/%s.py", course.source_directory, name, name)
        write_source(name, Path(course.root) / course.source_directory)
    yield


def _wrap(converter, around):
    """Let a command of nbgrader's run inside `around`, from the terminal and from formgrader alike.

    nbgrader has no hook before it looks for submissions, and both ways go through `start`.
    """
    start = getattr(converter.start, "__wrapped__", converter.start)

    @functools.wraps(start)
    def wrapped(self):
        with around(self.coursedir, self.log):
            return start(self)

    converter.start = wrapped
