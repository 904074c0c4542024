"""What a class's results say together: marks by task, mistakes, what tells strong from weak, what wants a look."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from dataclasses import dataclass
from math import atanh, sqrt, tanh

import numpy as np

from autograder import report_view as view
from autograder.plane import plane

NEAR = 1.25  # an error this near its limit, on either side
FEW = 20  # submissions, below which a correlation is mostly chance
BINS = ("0 %", "up to 20 %", "up to 40 %", "up to 60 %", "up to 80 %", "below 100 %", "100 %")
SHOWN_MISTAKES = 40
ENDED = {"timeout": "ran out of time", "out_of_memory": "ran out of memory", "crashed": "crashed"}


@dataclass(frozen=True)
class Entry:
    """A submission, as far as the class is concerned: a few hundred bytes of its result."""

    student: str
    link: str
    result: dict
    checks: tuple[dict, ...]


def entry(path, result, page_exists) -> Entry:
    """What the class keeps of the result at `path`."""
    link = view.quote(f"pages/{path.parent.name}/{path.stem}.html") if page_exists else ""
    kept = {key: view.text(result.get(key), 300) for key in ("status", "message", "isolation")}
    record = result.get("record") if isinstance(result.get("record"), dict) else {}
    kept["source"] = view.text(record.get("source"), 100)
    return Entry(view.text(result["student"], 200), link, kept, tuple(_check(check) for check in result["checks"]))


def _check(check):
    against = check.get("against_reference") if isinstance(check.get("against_reference"), dict) else {}
    measures = check.get("measures") if isinstance(check.get("measures"), list) else []
    ratios = [(_ratio(m), view.text(m.get("name"), 60)) for m in measures if isinstance(m, dict) and not m.get("work")]
    near = [(ratio, name) for ratio, name in ratios if ratio is not None and 1 / NEAR <= ratio <= NEAR]
    most = view.number(check.get("max_score")) or 0.0
    return {
        **{key: view.text(check.get(key), 60) for key in ("id", "name", "likely_mistake")},
        **{key: view.text(check.get(key), 300) for key in ("message", "symptom", "hint")},
        **{key: view.number(check.get(key)) for key in ("cpu_seconds", "cpu_seconds_reference")},
        "status": check.get("status") if check.get("status") in list(view.CHECK_WORDS) else "error",
        "share": (view.number(check.get("score")) or 0.0) / most if most else None,
        "score": view.number(check.get("score")) or 0.0,
        "ratio": _ratio(against), "ratio_reference": _ratio(against, "error_reference"),
        "near": max(near, default=None),
    }  # fmt: skip


def _ratio(measure, error="error"):
    value, limit = view.number(measure.get(error)), view.number(measure.get("tolerance"))
    return value / limit if value is not None and value >= 0 and limit is not None and limit > 0 else None


def tasks(entries) -> list[dict]:
    """Of each task: how many got which part of its points, and how well it tells strong from weak."""
    columns: dict[str, list] = defaultdict(list)
    for e in entries:
        if e.result["status"] == "graded":
            for check in e.checks:
                if check["share"] is not None:
                    columns[check["id"]].append((check, sum(c["score"] for c in e.checks) - check["score"]))
    return [_task(task, rows) for task, rows in sorted(columns.items())]


def _task(task, rows):
    shares = np.array([check["share"] for check, _ in rows])
    counts = [0] * len(BINS)
    for share in shares:
        counts[0 if share <= 0 else 6 if share >= 1 else min(int(np.ceil(share * 5)), 5)] += 1
    r = correlation(shares, np.array([rest for _, rest in rows]))
    low, high = interval(r, len(rows))
    return {
        "id": task, "name": rows[0][0]["name"], "counts": counts, "most": max(counts), "count": len(rows),
        "mean": 100 * float(shares.mean()), "r": r, "low": low, "high": high, "verdict": _verdict(r, low, high, len(rows)),
    }  # fmt: skip


def correlation(a, b):
    """Pearson's correlation; None where one of the two is the same for all."""
    a, b = a - a.mean(), b - b.mean()
    norm = sqrt(float(a @ a) * float(b @ b))
    return float(np.clip((a @ b) / norm, -1, 1)) if norm > 1e-12 else None


def interval(r, count):
    """The 95 % interval of a correlation of `count` pairs, by Fisher's transformation; (None, None) where there is none."""
    if r is None or count < 4:
        return None, None
    z, wide = atanh(min(max(r, -0.999999), 0.999999)), 1.96 / sqrt(count - 3)
    return tanh(z - wide), tanh(z + wide)


def _verdict(r, low, high, count):
    if r is None:
        return "all have the same marks, in it or in the rest"
    if count < FEW:
        return f"{count} submissions are too few to tell"
    if low > 0:
        return "separates strong from weak"
    return "runs against the rest: look at the task" if high < 0 else "no clear relation to the rest"


def mistakes(entries) -> list[dict]:
    """The most frequent mistakes with their hints and students; those without a name by what was said of them."""
    found: dict[tuple, dict] = {}
    for e in entries:
        for check in e.checks:
            if check["status"] in ("partial", "fail", "error"):
                named = check["likely_mistake"]
                what = check["symptom"] if named else re.sub(r"-?\d[\d.]*(e-?\d+)?", "…", check["message"])
                key = (check["id"], named or what)
                row = found.setdefault(key, {"id": check["id"], "name": check["name"], "named": named.replace("-", " "),
                                             "what": what, "hint": check["hint"], "students": []})  # fmt: skip
                row["students"].append((e.student, f"{e.link}#task-{check['id']}" if e.link else ""))
    rows = sorted(found.values(), key=lambda row: (-len(row["students"]), not row["named"], row["id"]))
    return rows[:SHOWN_MISTAKES]


def for_a_person(entries) -> list[dict]:
    """Submissions that a person should look at, each with the reasons."""
    usual = Counter(e.result["isolation"] for e in entries).most_common(1)[0][0] if entries else ""
    rows = []
    for e in entries:
        reasons, status = [], e.result["status"]
        if status in ("rejected", *ENDED):
            reasons.append(f"{view.SUBMISSION_WORDS[status]}{'; ' + e.result['message'] if e.result['message'] else ''}")
        if view.is_weak(e.result):
            reasons.append(f"NOT ISOLATED ({e.result['isolation'] or 'level not recorded'})")
        elif e.result["isolation"] != usual:
            reasons.append(f"isolation {e.result['isolation']}, where the class has {usual}")
        for check in e.checks:
            if check["status"] in ENDED and status not in ENDED:
                reasons.append(f"{check['id']} {check['name']} {ENDED[check['status']]}")
            elif check["near"]:
                ratio, name = check["near"]
                reasons.append(f"{check['id']} {check['name']}: “{name}” at {ratio:.2f} of its limit")
        if reasons:
            rows.append({"student": e.student, "link": e.link, "reasons": reasons})
    return rows


def cost_against_error(entries) -> dict | None:
    """Every submission on one plane: CPU time of all tasks against the largest error over its limit."""
    points, ids = [], max((len(e.checks) for e in entries), default=0)
    for e in entries:
        judged = [check for check in e.checks if check["ratio"] is not None]
        if judged:
            points.append({
                "kind": "you", "cost": sum(c["cpu_seconds"] or 0.0 for c in judged), "error": max(c["ratio"] for c in judged),
                "student": e.student, "link": e.link, "judged": len(judged), "of": ids,
            })  # fmt: skip
    right = {c["id"]: (c["cpu_seconds_reference"], c["ratio_reference"]) for e in entries for c in e.checks
             if c["ratio_reference"] is not None and c["cpu_seconds_reference"] is not None}  # fmt: skip
    if not points:
        return None
    if len(right) == ids:
        cost, error = sum(seconds for seconds, _ in right.values()), max(ratio for _, ratio in right.values())
        points.append({"kind": "reference", "cost": cost, "error": error})
    return plane(points, limit=1.0, width=900, height=420)
