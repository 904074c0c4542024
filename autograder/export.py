"""Results in the formats of other tools: Gradescope, PrairieLearn, and one table of all tasks."""

from __future__ import annotations

import html
import json
from pathlib import Path

from autograder import report
from autograder import report_view as view

# PrairieLearn refuses results above 1 MB; pictures stop short of it, for the texts come on top.
PRAIRIELEARN_BYTES, PICTURE_BYTES = 1_000_000, 700_000
COLUMNS = ("student", "assignment", "submission_status", "task", "name", "status", "score", "max_score",
           "metric", "error", "tolerance", "likely_mistake", "message")  # fmt: skip


def export(graded, form, out) -> tuple[int, list[str]]:
    """Write the results below `graded`, as `course grade --out` left them, in another tool's format.

    Parameters
    ----------
    graded : path
    form : str          one of `FORMATS`
    out : path          made where it is missing

    Returns
    -------
    int                 how many results were written
    list of str         a sentence for each result that could not be read
    """
    return FORMATS[form](Path(graded), Path(out))


def gradescope(result, folder, pages) -> dict:
    """A result as Gradescope's `results.json`.

    Parameters
    ----------
    result : dict       as in CONTRACT: a submission's JSON
    folder : Path       where that JSON lies: picture paths are relative to it
    pages : Path        below which pictures may lie

    Returns
    -------
    dict                marks by task, texts escaped, pictures inside; shown to the student
    """
    shown = _shown(result, folder, pages)
    words = " ".join(part for part in (shown["words"] + ".", shown["message"]) if part)
    if shown["weak"]:
        words += " NOT ISOLATED: this ran beside the grader's own files."
    return {
        "score": shown["score"],
        "execution_time": round(shown["wall_seconds"] or 0.0),
        "output": html.escape(words),
        "output_format": "html",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "tests": [
            {
                "number": check["id"],
                "name": f"{check['id']} {check['name']}",
                "score": check["score"],
                "max_score": check["max_score"],
                "status": "passed" if check["status"] == "pass" else "failed",
                "output": _as_html(check),
                "output_format": "html",
                "visibility": "visible",
            }
            for check in shown["checks"]
        ],
    }


def prairielearn(result, folder, pages) -> dict:
    """A result as PrairieLearn's `results.json`: the score is a share; arguments as for `gradescope`.

    A file that is no submission is "not gradable", so that it costs no attempt.
    """
    shown = _shown(result, folder, pages)
    if shown["status"] == "rejected":
        return {"gradable": False, "format_errors": [shown["message"] or shown["words"]]}
    return {
        "gradable": True,
        "score": shown["score"] / shown["max_score"] if shown["max_score"] else 0.0,
        "message": " ".join(part for part in (shown["words"] + ".", shown["message"]) if part),
        "tests": [
            {
                "name": f"{check['id']} {check['name']}",
                "description": check["title"],
                "points": check["score"],
                "max_points": check["max_score"],
                "message": " ".join(_sentences(check)),
                "output": check["prints"],
                "images": [
                    {"label": picture["title"], "url": f"data:image/png;base64,{picture['data']}"}
                    for picture in check["pictures"]
                    if not picture["problem"]
                ],
            }
            for check in shown["checks"]
        ],
    }


def _shown(result, folder, pages):
    """What pages show of a result, with as many pictures as fit everywhere."""
    shown = view.submission(result)
    view.embed_pictures(shown["checks"], folder, pages, PICTURE_BYTES * 3 // 4)  # base 64 adds a third
    return shown


def _sentences(check):
    """Verdict, message, mistake and hint of a check, a sentence each."""
    yield f"{check['word']}: {check['message']}" if check["message"] else f"{check['word']}."
    if check["mistake"]:
        yield f"Looks like: {check['mistake']}. {check['symptom']}".strip()
    if check["hint"]:
        yield check["hint"]


def _as_html(check):
    parts = [f"<p>{html.escape(sentence)}</p>" for sentence in _sentences(check)]
    for key in ("traceback", "prints"):
        if check[key]:
            parts.append(f"<pre>{html.escape(check[key])}</pre>")
    for picture in check["pictures"]:
        if not picture["problem"]:
            parts.append(
                f'<figure><img alt="{picture["title"]}" src="data:image/png;base64,{picture["data"]}">'
                f"<figcaption>{picture['title']}</figcaption></figure>"
            )
    return "\n".join(parts)


def _one_file_each(convert):
    """Writes `out/STUDENT/ASSIGNMENT/results.json` for every result."""

    def write(graded, out):
        written, problems = 0, []
        for path, result, problem in view.results(graded):
            if result is None:
                problems.append(f"{path}: {problem}")
                continue
            text = json.dumps(convert(result, path.parent, graded / "pages"), indent=1) + "\n"
            report.write_whole(out / path.parent.name / path.stem / "results.json", [text])
            written += 1
        return written, problems

    return write


def _tasks_table(graded, out):
    """Writes `out/tasks.csv`: a line for each task of each submission."""
    rows, problems, written = [], [], 0
    for path, result, problem in view.results(graded):
        if result is None:
            problems.append(f"{path}: {problem}")
            continue
        written += 1
        first = (result["student"], result["assignment"], result["status"])
        for check in result["checks"]:
            keys = ("id", "name", "status", "score", "max_score", "metric", "error", "tolerance", "likely_mistake", "message")
            rows.append([*first, *("" if check.get(key) is None else check[key] for key in keys)])
    report.write_table(out / "tasks.csv", COLUMNS, rows)
    return written, problems


FORMATS = {
    "gradescope": _one_file_each(gradescope),
    "prairielearn": _one_file_each(prairielearn),
    "csv": _tasks_table,
}
