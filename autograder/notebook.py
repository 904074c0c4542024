"""`check("1.2")` in a notebook: the public checks of a function as it is in memory, with numbers and pictures."""

from __future__ import annotations

import base64
import html
import io
import sys

import numpy as np

import framework
from autograder import checks, likely, public, submission
from autograder.judge import PUBLIC_SHARE, Judgement, result_of, run_check, seed_of, settle
from autograder.student import Failure, InMemory
from autograder.wall import sentence

WORDS = {
    "pass": ("✔", "#1a7f37", "right, on the inputs that you can see"),
    "partial": ("◐", "#9a6700", "partly right"),
    "fail": ("✘", "#b3261e", "not right yet"),
    "not_attempted": ("○", "#57606a", "not written yet"),
    "error": ("⚠", "#8250df", "could not be judged"),
    "out_of_memory": ("⚠", "#8250df", "needs too much memory"),
}


def check(task, namespace=None):
    """Judge a task's functions by the inputs that the notebook shows, and display what was found.

    Parameters
    ----------
    task : str          the task's number, such as "1.2"
    namespace : dict    where the functions are; by default the notebook that calls
    """
    namespace = sys._getframe(1).f_globals if namespace is None else namespace
    judged = judge(task, namespace)
    try:
        from IPython import get_ipython
        from IPython.display import HTML, display
    except ImportError:
        get_ipython = None
    if get_ipython is None or get_ipython() is None:
        print(as_text(judged))
    else:
        display(HTML(_as_html(judged)))


def judge(task, namespace):
    """The public round of a task, on functions in memory.

    Returns
    -------
    dict    id, name, status, message, measures, traceback and the Picture, for `as_text` and the pages
    """
    assignment = _assignment_of(str(task))
    found = assignment.find(str(task))
    seed = seed_of(b"", assignment.name, found.id, True)
    result = run_check(found, InMemory(namespace, found).call, public.expected(assignment.name, found.id), seed, True)
    if result.failure is not None:
        status, message, trace = result.failure.status, result.failure.message, result.failure.traceback
        if status == "not_attempted":
            message = "fill in the function in the cell above, run it, then run this cell again"
    else:
        status = "pass" if result.fraction >= 1 - 1e-9 else "partial" if result.fraction > 0 else "fail"
        missed = next((m for m in result.measures if m.credit < 1), None)
        message, trace = (missed.message or missed.name) if missed else "", ""
    wrong = status in ("partial", "fail", "error")
    return {"id": found.id, "name": found.name, "status": status, "message": message, "traceback": trace,
            "measures": result.measures, "picture": result.picture, "fraction": result.fraction,
            "likely": likely.name(found, result.calls) if wrong else None}  # fmt: skip


def check_file(path):
    """The public checks of a notebook's solution cells, run in this process: for a student's own work.

    Parameters
    ----------
    path : Path     the notebook

    Returns
    -------
    dict            a result as the grader writes it; its points are those of the public inputs alone
    list of Judgement

    Raises
    ------
    submission.Rejected     where the file is not a notebook of the course
    """
    read = submission.read(path)
    namespace: dict = {"__name__": "__main__", "np": np, "fw": framework, "framework": framework}
    broken = {}
    for grade_id, source in read.cells.items():
        try:
            exec(compile(source, f"<cell {grade_id}>", "exec"), namespace)
        except Exception as failure:
            broken[grade_id] = Failure("error", f"its cell fails: {sentence(failure)}")
    points = submission.release_of(read.assignment).points
    judgements = []
    for task in checks.assignment(read.assignment).tasks:
        if task.name not in read.changed:
            worth = PUBLIC_SHARE * points[task.name]
            judgements.append(Judgement(task, worth, [], "not_attempted", message="nothing was filled in"))
            continue
        seed = seed_of(b"", read.assignment, task.id, True)
        expected = public.expected(read.assignment, task.id)
        found = run_check(task, InMemory(namespace, task).call, expected, seed, True)
        if found.failure and task.name in broken:
            found.failure = broken[task.name]
        found.weight = 1.0
        judgements.append(Judgement(task, PUBLIC_SHARE * points[task.name], [found]))
        settle(judgements[-1])
    return result_of(read, "you", "none", judgements), judgements


def as_text(judged) -> str:
    """What was found, for a terminal."""
    sign, _, words = WORDS[judged["status"]]
    lines = [f"{sign} {judged['id']} {judged['name']}: {words}" + (f" ({judged['message']})" if judged["message"] else "")]
    if judged["status"] in ("pass", "partial", "fail"):
        for m in judged["measures"]:
            lines.append(f"    {'✔' if m.credit == 1 else '✘'} {m.name}: {m.metric} {m.error:.3g}, allowed {m.tolerance:.3g}")
    elif judged["traceback"]:
        lines += ["    " + line for line in judged["traceback"].splitlines()]
    if judged["likely"] is not None:
        lines += [f"    it looks like a known mistake: {judged['likely'].symptom}", f"    {judged['likely'].hint}"]
    if judged["status"] not in ("pass", "not_attempted"):
        lines.append(f'    stuck? hint("{judged["id"]}") helps in three steps')
    return "\n".join(lines)


def _assignment_of(task):
    number = task.split(".")[0]
    if number.isdigit() and 1 <= int(number) <= len(checks.ASSIGNMENTS):
        name = checks.ASSIGNMENTS[int(number) - 1]
        if name in checks.available():
            return checks.assignment(name)
    raise KeyError(f"there is no task {task!r}: a number such as \"1.2\" is wanted")


def _as_html(judged):
    sign, color, words = WORDS[judged["status"]]
    said = f": {html.escape(judged['message'])}" if judged["message"] else ""
    parts = [
        f'<div style="border-left:5px solid {color};padding:.4em 1em;margin:.3em 0;max-width:60em">'
        f'<div style="font-size:1.1em"><b style="color:{color}">{sign} {words}</b>'
        f' — {judged["id"]} <code>{html.escape(judged["name"])}</code>{said}</div>'
    ]
    if judged["status"] in ("pass", "partial", "fail"):
        rows = "".join(
            f'<tr><td style="text-align:left">{"✔" if m.credit == 1 else "✘"} {html.escape(m.name)}</td>'
            f'<td style="text-align:left">{html.escape(m.metric)}</td><td>{m.error:.3g}</td><td>{m.tolerance:.3g}</td></tr>'
            for m in judged["measures"]
        )
        parts.append(
            '<table style="margin:.5em 0"><tr><th style="text-align:left">measure</th><th style="text-align:left">metric</th>'
            f"<th>yours</th><th>allowed</th></tr>{rows}</table>"
        )
    elif judged["traceback"]:
        parts.append(f"<pre>{html.escape(judged['traceback'])}</pre>")
    if judged["likely"] is not None:
        symptom, hint = html.escape(judged["likely"].symptom), html.escape(judged["likely"].hint)
        parts.append(f"<div>It looks like a known mistake: {symptom}<br><b>Think again:</b> {hint}</div>")
    if judged["status"] not in ("pass", "not_attempted"):
        parts.append(f'<div style="color:#57606a">stuck? <code>hint("{judged["id"]}")</code> helps in three steps</div>')
    if judged["picture"] is not None and judged["status"] != "not_attempted":
        parts.append(_figures(judged["picture"]))
    return "".join(parts) + "</div>"


def _figures(picture):
    from PIL import Image

    from framework.comparison import comparison_images

    shown = comparison_images(picture.yours, picture.expected, picture.kind)
    cells = []
    for title, pixels in (("yours", shown.yours), ("expected", shown.expected), ("difference", shown.difference)):
        file = io.BytesIO()
        Image.fromarray(pixels).save(file, format="png")
        data = base64.b64encode(file.getvalue()).decode()
        cells.append(
            f'<figure style="display:inline-block;margin:0 .8em 0 0;text-align:center"><img alt="{title}" width="220" '
            f'style="image-rendering:pixelated" src="data:image/png;base64,{data}"><figcaption>{title}</figcaption></figure>'
        )
    caption = html.escape(f"{picture.caption}. {shown.caption}")
    return f'<div>{"".join(cells)}</div><div style="color:#57606a">{caption}</div>'
