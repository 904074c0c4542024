"""`course report`: what the instructor should know of a class, as one page beside the pages of its students."""

from __future__ import annotations

from pathlib import Path

from autograder import class_figures as figures
from autograder import discover, likeness, report, submission, unit
from autograder import report_view as view

SHOWN_PAIRS = 20
SOURCE_CHARACTERS = 6000  # of a cell, shown of a pair


def write(out, submissions=(), notice=print) -> Path:
    """Write `out/report.html`.

    Parameters
    ----------
    out : Path              what `course grade --out` has written
    submissions : paths     where the graded notebooks lie, as given to `course grade`; none: solutions are not compared
    notice : callable       is told in a sentence what is odd

    Returns
    -------
    Path of the page
    """
    classes: dict[str, list[figures.Entry]] = {}
    unreadable = []
    for path, result, problem in view.results(Path(out)):
        if result is None:
            unreadable.append((f"{path.parent.name}/{path.name}", problem))
            continue
        page = (Path(out) / "pages" / path.parent.name / f"{path.stem}.html").is_file()
        classes.setdefault(view.text(result["assignment"], 100), []).append(figures.entry(path, result, page))
    units = discover.find([Path(path) for path in submissions], notice=notice) if submissions else []
    parts = [_part(name, entries, [u for u in units if u.assignment == name]) for name, entries in sorted(classes.items())]
    page = Path(out) / "report.html"
    report.write_whole(page, report.templates().get_template("report.html").generate(
        parts=parts, unreadable=unreadable, compared=bool(submissions), bins=figures.BINS, few=figures.FEW,
        near=figures.NEAR, alike=likeness.ALIKE, style=report.style("base.css", "report.css")))  # fmt: skip
    return page


def _part(name, entries, units):
    pairs, missing = _pairs(name, entries, units)
    graded = [e for e in entries if e.result["status"] == "graded"]
    return {
        "name": name, "count": len(entries), "graded": len(graded), "tasks": figures.tasks(entries),
        "mistakes": figures.mistakes(entries), "look": figures.for_a_person(entries),
        "plane": figures.cost_against_error(entries), "pairs": pairs[:SHOWN_PAIRS], "pair_count": len(pairs),
        "missing": missing,
    }  # fmt: skip


def _pairs(name, entries, units):
    """Pairs of solutions that are nearly the same, with their sources; and how many have no source at hand."""
    wanted = {(e.student, e.result["source"]): e for e in entries if e.result["source"]}
    found, sources = [], []
    for one in units:
        try:
            block = unit.block_of(one)
            e = wanted.get((view.text(one.student, 200), unit.fingerprint(block)))
            cells = submission.cells_of(block, name) if e else None
        except submission.Rejected:
            continue
        if cells:
            found.append(e)
            sources.append(cells)
    rows = [
        {"first": found[pair.first], "second": found[pair.second], "percent": 100 * pair.share,
         "cells": [(task, view.text(sources[pair.first][task], SOURCE_CHARACTERS),
                    view.text(sources[pair.second][task], SOURCE_CHARACTERS)) for task in pair.tasks]}
        for pair in likeness.pairs(sources, submission.release_of(name).cells)
    ] if sources else []  # fmt: skip
    return rows, sum(e.result["status"] != "rejected" for e in entries) - len(found)
