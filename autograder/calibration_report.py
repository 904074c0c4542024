"""What a calibration found: as text for the terminal, and as the records of tolerances.json."""

from __future__ import annotations

import json
import math

from autograder import checks, mistakes
from autograder.calibrate import KEEPS

RECORDS = checks.HERE.parent / "references" / "tolerances.json"


def lines(table) -> list[str]:
    """A table as text: for each measure the right answers' largest error, the tolerance, and the nearest mistake."""
    count = table.counts.get
    wrong = count(mistakes.WRONG, 0)
    head = (
        f"{table.task.id} {table.task.name}: {count(mistakes.RIGHT, 0)} right, {count(mistakes.COSTLY, 0)} costly, "
        f"{wrong} wrong, of which {wrong - _kept(table)} lose marks"
    )
    return [head, *(_line(row) for row in table.rows), *(f"  ! {problem}" for problem in table.problems)]


def _kept(table):
    """How many of a task's mistakes keep too many marks."""
    return sum(KEEPS in problem for problem in table.problems)


def summary(tables) -> list[str]:
    """What the tables come to: how many mistakes lose marks, and the smallest margins."""
    wrong = sum(table.counts.get(mistakes.WRONG, 0) for table in tables)
    right = sum(table.counts.get(mistakes.RIGHT, 0) for table in tables)
    kept, problems = sum(map(_kept, tables)), sum(len(table.problems) for table in tables)
    rate = f", of which {wrong - kept} lose marks ({(wrong - kept) / wrong:.0%})" if wrong else ""
    result = [f"{right} right answers; {wrong} mistakes{rate}; {problems} problems"]
    for verdict, better, margin in ((mistakes.RIGHT, max, _inverse), (mistakes.WRONG, min, float)):
        found = [table.margins[verdict] for table in tables if verdict in table.margins]
        if found:
            worst = better(found, key=lambda e: e.over)
            result.append(f"smallest margin of {verdict} answers: {margin(worst.over):.3g} ({worst.id})")
    return result


def _line(row):
    right, wrong = row.right, row.wrong
    tolerance = (right or wrong).tolerance
    low = f"{right.error:9.2g} {_times(_inverse(right.over))}" if right else f"{'':16}"
    high = f"{wrong.error:9.2g} {_times(wrong.over)}" if wrong else f"{'':16}"
    return f"  {row.name[:34]:34} {low} | {tolerance:8.2g} | {high}  {right.id if right else ''} | {wrong.id if wrong else ''}"


def _inverse(value):
    return 1 / value if value > 0 else math.inf


def _times(value):
    return f"x{value:<5.3g}" if value < 1e4 else "x  inf" if math.isinf(value) else f"x{value:<5.0e}"


def write(tables):
    """Put what was measured into tolerances.json, beside the tolerances and their reasons."""
    records = json.loads(RECORDS.read_text(encoding="utf-8"))
    for table in tables:
        for row in table.rows:
            record = records[table.task.id].get(row.name)
            if record is not None:
                records[table.task.id][row.name] = _record(record, row)
    RECORDS.write_text(_text(records), encoding="utf-8")


def _record(record, row):
    kept = {key: record[key] for key in ("metric", "tolerance", "half", "per_unit") if key in record}
    right, wrong = row.right, row.wrong
    measured = {
        "right": _digits(right.error), "right_way": right.id, "right_margin": _digits(_inverse(right.over)),
        "wrong": wrong and _digits(wrong.error), "wrong_way": wrong and wrong.id,
        "wrong_margin": wrong and _digits(wrong.over),
    }  # fmt: skip
    return kept | measured | {"reason": record["reason"]}


def _digits(value):
    return float(f"{value:.3g}") if math.isfinite(value) else None


def _text(records):
    """JSON with a line for each measure."""
    tasks = []
    for id, measures in records.items():
        rows = ",\n".join(f"  {json.dumps(name)}: {json.dumps(record)}" for name, record in measures.items())
        tasks.append(f" {json.dumps(id)}: {{\n{rows}\n }}")
    return "{\n" + ",\n".join(tasks) + "\n}\n"
