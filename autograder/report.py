"""The pages that students and instructors read: one per submission, an index, a table of grades.

Pages carry their style and pictures with them, and a policy under which no script but the index's own runs.
"""

import csv
import io
import os
import tempfile
from base64 import b64encode
from collections import Counter
from functools import cache
from hashlib import sha256
from pathlib import Path
from urllib.parse import quote

import jinja2
from markupsafe import Markup

from autograder import report_view as view
from framework import colors

# A spreadsheet runs a cell that starts so; some take the full-width forms too.
FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")
TEMPLATES = Path(__file__).parent / "templates"


def write_page(result, json_path, out):
    """Write the page of one submission, with its pictures inside.

    Parameters
    ----------
    result : dict       what `json_path` holds
    json_path : Path    `out/results/STUDENT/ASSIGNMENT.json`; picture paths are relative to it
    out : Path          the output directory

    Returns
    -------
    Path of the page, `out/pages/STUDENT/ASSIGNMENT.html`

    Raises
    ------
    ValueError where `result` is not a grader's result
    """
    json_path, out = Path(json_path), Path(out)
    submission = view.submission(result)
    view.embed_pictures(submission["checks"], json_path.parent, out / "pages")
    page = out / "pages" / json_path.parent.name / f"{json_path.stem}.html"
    template = templates().get_template("page.html")
    shared = {"style": style("base.css", "page.css"), "script": script("page.js")}
    write_whole(page, template.generate(**submission, **shared))
    return page


def write_index(out):
    """Write `out/index.html`, a summary and a row for each result, holding one result at a time."""
    out = Path(out)
    row, index = (templates().get_template(name) for name in ("row.html", "index.html"))
    tally, places = _Tally(), []
    with tempfile.TemporaryFile() as rows:  # the summary stands above the rows, and is known after them
        for path, result, problem in view.results(out):
            tally.add(result)
            student, assignment = (view.text(name, 200) for name in view.names(path, result))
            page = f"pages/{path.parent.name}/{path.stem}.html"
            link = quote(page) if (out / page).is_file() else ""
            shown = {"r": view.row(result) if result else None, "problem": problem, "link": link}
            text = row.render(**shown, student=student, assignment=assignment)
            places.append((student, assignment, rows.tell()))
            rows.write(text.replace("\n", " ").encode() + b"\n")
        chunks = index.generate(
            tally=tally,
            rows=_lines(rows, sorted(places)),
            check_words=view.CHECK_WORDS,
            script=script("index.js"),
            style=style("base.css", "index.css"),
        )
        write_whole(out / "index.html", chunks)


def write_grades(out):
    """Write `out/grades.csv`, sorted by student and assignment; an unreadable result has no score."""
    rows = []
    for path, result, _ in view.results(Path(out)):
        marks = (result["status"], result["score"], result["max_score"]) if result else ("unreadable", "", "")
        rows.append([*view.names(path, result), *marks])
    write_table(Path(out) / "grades.csv", ["student", "assignment", "status", "score", "max_score"], rows)


def write_table(path, header, rows):
    """Write a table, its rows sorted, in which no value is a formula for a spreadsheet to run."""
    quoted = [[_cell(value) for value in row] for row in rows]
    write_whole(path, map(_line, [header, *sorted(quoted)]))


def _line(cells):
    line = io.StringIO()
    # Python 3.11 quotes a bare CR only where lines end so
    csv.writer(line, lineterminator="\r\n").writerow(cells)
    return line.getvalue().removesuffix("\r\n") + "\n"


def _cell(value):
    """A value of the table; text that a spreadsheet would run as a formula gets a quote in front."""
    text = str(value).encode("utf-8", "backslashreplace").decode()  # half a surrogate pair has no UTF-8
    return f"'{text}" if text.startswith(FORMULA) else text


class _Tally:
    """Counts over all results: by status, and marks by assignment and task."""

    def __init__(self):
        self.total = self.unreadable = self.weak = 0
        self.statuses: Counter[str] = Counter()
        self.assignments: dict = {}

    def add(self, result):
        self.total += 1
        if result is None:
            self.unreadable += 1
            return
        self.statuses[result["status"]] += 1
        self.weak += view.is_weak(result)
        if result["status"] == "graded":
            name = view.text(result["assignment"], 100)
            self.assignments.setdefault(name, _Assignment()).add(result)

    def mean_percent(self):
        """Mean over graded submissions of their score in percent of the maximum; None without any."""
        count = sum(assignment.with_marks for assignment in self.assignments.values())
        return (
            100 * sum(assignment.shares for assignment in self.assignments.values()) / count
            if count
            else None
        )


class _Assignment:
    """Sums over the graded submissions of one assignment."""

    def __init__(self):
        self.count = self.with_marks = 0
        self.score = self.max_score = self.shares = 0.0
        self.tasks = {}

    def add(self, result):
        self.count += 1
        self.score += result["score"]
        self.max_score += result["max_score"]
        if result["max_score"] > 0:
            self.with_marks += 1
            self.shares += result["score"] / result["max_score"]
        for check in result["checks"]:
            sums = self.tasks.setdefault(view.text(check.get("id"), 20), [0.0, 0.0])
            sums[0] += view.number(check.get("score")) or 0.0
            sums[1] += view.number(check.get("max_score")) or 0.0


def _lines(file, places):
    """The lines of `file` that start at the offsets that end the entries of `places`."""
    for *_, offset in places:
        file.seek(offset)
        yield Markup(file.readline().decode())


@cache
def templates():
    """The pages' templates, in which every value is escaped."""
    loader = jinja2.FileSystemLoader(TEMPLATES)
    env = jinja2.Environment(
        loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    env.globals.update(signed_colors=_stops(colors.SIGNED_ERROR), error_colors=_stops(colors.ERROR))
    env.filters.update(figure=_figure, points=_points, count=_count, title=_title)
    return env


def _stops(table):
    """Nine colours of a table, as `(percent, #rrggbb)`."""
    return [(round(100 * k / 8, 1), f"#{bytes(table[k * (len(table) - 1) // 8]).hex()}") for k in range(9)]


def _figure(value):
    """A measured number with three digits: 0.0213, 1.2×10⁻⁵."""
    text = f"{value + 0.0:.3g}"  # no −0
    if "e" not in text:
        return text.replace("-", "−")
    mantissa, power = text.split("e")
    return f"{mantissa.replace('-', '−')}×10{str(int(power)).translate(str.maketrans('-0123456789', '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'))}"


def _points(value):
    """Marks, with two decimals at most."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def _count(value):
    """A whole number, its thousands set apart by narrow spaces that do not break."""
    return f"{value:,.0f}".replace(",", "\u202f")


def _title(name):
    """An assignment's name as words: `split_sum` is Split sum."""
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]


def style(*names):
    """Style sheets as one, and the word that lets the page's policy accept it."""
    text = Markup("".join((TEMPLATES / name).read_text(encoding="utf-8") for name in names))
    return {"text": text, "hash": _csp_hash(text)}


script = style  # the policy accepts a script in the same way


def _csp_hash(text):
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def write_whole(path, chunks):
    """Write `path` whole or not at all; the temporary name is fixed, so that a run after a kill clears it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.unfinished")
    try:
        with open(unfinished, "w", encoding="utf-8", newline="") as file:
            file.writelines(chunks)
        os.replace(unfinished, path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
