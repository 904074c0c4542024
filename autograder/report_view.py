"""What the pages show of a result, made safe to show.

A result holds text and numbers that a stranger's program had a hand in. Text loses control characters and
is cut, numbers count when finite, pictures come from `pages/` alone; what is missing or odd is left empty.
Escaping is the templates' part.
"""

import json
import os
import re
from base64 import b64encode
from math import isfinite, log10
from numbers import Real
from urllib.parse import quote

from autograder import next_step
from autograder.plane import plane

SUBMISSION_WORDS = {
    "graded": "Graded",
    "not_attempted": "Not attempted: every solution cell is as released",
    "rejected": "Rejected: the file could not be read as this assignment",
    "timeout": "Timeout: time ran out before anything could be judged",
    "out_of_memory": "Out of memory: it ran out before anything could be judged",
    "crashed": "Crashed: Python died before anything could be judged",
}
CHECK_WORDS = {
    "pass": ("Pass", "the answer is right"),
    "partial": ("Partial", "part of the answer is right"),
    "fail": ("Fail", "it ran, and the answer is wrong"),
    "not_attempted": ("Not attempted", "the cell is as released"),
    "error": ("Error", "no answer that could be judged"),
    "timeout": ("Timeout", "no answer to judge: time ran out"),
    "out_of_memory": ("Out of memory", "no answer to judge: memory ran out"),
    "crashed": ("Crashed", "no answer to judge: Python died"),
}
PICTURES = {"yours": "Yours", "reference": "Expected", "difference": "Difference"}
PICTURE_BYTES = 1_200_000  # all pictures of a page; 1.6 MB in base 64, which keeps the page below 2 MB
PICTURE_WIDTH = 384  # CSS pixels: two fit beside each other on a desk; three, and on a phone, are scaled down
RESULT_BYTES = 16 << 20
MEASURES = 40  # shown for a check
DECADES = 3  # of the error's scale, on each side of the tolerance
# Control characters, those that reorder the text around them, and halves of surrogate pairs.
UNPRINTABLE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")


def results(out):
    """Yield `(path, result, problem)` of each JSON file, by folder; no result where there is a problem."""
    folder = out / "results"
    students = sorted(os.scandir(folder), key=lambda entry: entry.name) if folder.is_dir() else []
    for student in students:
        if student.is_dir(follow_symlinks=False):
            for path in sorted((folder / student.name).glob("*.json")):
                try:
                    yield path, read(path), ""
                except (OSError, ValueError) as reason:
                    yield path, None, text(str(reason), 300)


def read(path):
    """The result in a file; ValueError where it is none."""
    if path.is_symlink() or not path.is_file():
        raise ValueError("not a regular file")
    if path.stat().st_size > RESULT_BYTES:
        raise ValueError(f"{path.stat().st_size} bytes long, of {RESULT_BYTES} at most")
    try:
        result = json.loads(path.read_bytes(), parse_constant=lambda name: None)
    except (ValueError, RecursionError) as reason:
        raise ValueError(f"not JSON: {reason}") from None
    require_result(result)
    return result


def require_result(result):
    """Raise ValueError unless `result` has what every result has."""

    def require(holds, wanted):
        if not holds:
            raise ValueError(f"not a grader's result: {wanted} is wanted")

    require(isinstance(result, dict) and result.get("schema") == 1, "an object of schema 1")
    for key in ("student", "assignment"):
        require(isinstance(result.get(key), str), f"the name of the {key}")
    require(result.get("status") in list(SUBMISSION_WORDS), "a known status")
    for key in ("score", "max_score"):
        value = number(result.get(key))
        require(value is not None and value >= 0, f"a {key} of 0 or more")
    checks = result.get("checks")
    require(isinstance(checks, list) and all(isinstance(check, dict) for check in checks), "a list of checks")


def names(path, result):
    """Student and assignment as the result names them, or else the path."""
    return (result["student"], result["assignment"]) if result else (path.parent.name, path.stem)


def is_weak(result):
    """Whether the submission ran without the isolation that the marks of strangers need."""
    return not text(result.get("isolation")).startswith("namespaces")


def submission(result):
    """What a page shows of a result; ValueError where it is none."""
    require_result(result)
    checks = [_check(check) for check in result["checks"]]
    gains = sorted((c for c in checks if c["max_score"] > c["score"]), key=_loss, reverse=True)
    shown = {
        **{key: text(result.get(key), 200) for key in ("student", "assignment", "isolation")},
        **{key: number(result.get(key)) for key in ("score", "max_score", "wall_seconds", "peak_memory_mb")},
        "status": result["status"],
        "words": SUBMISSION_WORDS[result["status"]],
        "message": text(result.get("message")),
        "weak": is_weak(result),
        "checks": checks,
        "gains": gains,
        "record": _flat(result.get("record")),
    }
    return shown | {"first": next_step.sentence(shown)}


def row(result):
    """What the index shows of a result that `require_result` has accepted."""
    checks = [
        {"id": text(check.get("id"), 20), "name": text(check.get("name"), 40), "status": _status(check)}
        for check in result["checks"]
    ]
    return {**{key: result[key] for key in ("status", "score", "max_score")}, "checks": checks}


def _status(check):
    return check.get("status") if check.get("status") in list(CHECK_WORDS) else "error"


def _loss(check):
    return check["max_score"] - check["score"]


def _check(check):
    status = _status(check)
    max_score = number(check.get("max_score")) or 0.0
    measures = check.get("measures")
    if not isinstance(measures, list) or not measures:
        measures = (
            [{key: check.get(key) for key in ("metric", "error", "tolerance")}] if check.get("metric") else []
        )
    done, needed = number(check.get("evaluations")), number(check.get("evaluations_reference"))
    images = check.get("images")
    return {
        **{key: text(check.get(key), 100) for key in ("id", "name")},
        **{key: text(check.get(key)) for key in ("title", "message", "symptom", "hint", "caption")},
        "status": status,
        "word": CHECK_WORDS[status][0],
        "meaning": CHECK_WORDS[status][1],
        "score": number(check.get("score")) or 0.0,
        "max_score": max_score,
        "mistake": text(check.get("likely_mistake")).replace("-", " ").replace("_", " "),
        "measures": [_measure(m, max_score) for m in measures[:MEASURES] if isinstance(m, dict)],
        "evaluations": done,
        "evaluations_reference": needed,
        "work": _ratio(done, needed),
        "judged": number(check.get("error")) is not None,
        "kind": text(check.get("kind"), 20),
        "scale": number(check.get("scale")),
        **_planes(check),
        "traceback": text(check.get("traceback"), 8000).strip("\n"),
        "prints": text(check.get("prints"), 20000).strip("\n"),
        "images": images if isinstance(images, dict) else {},
        "pictures": [],
    }


def _planes(check):
    """The student and the reference on the planes of time and of evaluations against error."""
    against = check.get("against_reference")
    against = against if isinstance(against, dict) else {}
    error, right, limit = (number(against.get(key)) for key in ("error", "error_reference", "tolerance"))
    seconds = [number(check.get(key)) for key in ("cpu_seconds", "cpu_seconds_reference")]
    counts = [number(check.get(key)) for key in ("evaluations", "evaluations_reference")]
    planes = []
    for name, unit, costs in (("CPU time of the task", "s", seconds), ("SDF evaluations", "", counts)):
        figures = [error, right, limit, *costs]
        if all(figure is not None and figure >= 0 for figure in figures):
            you, other = ({"error": e, "cost": c} for e, c in zip((error, right), costs, strict=True))
            points = [other | {"kind": "reference"}, you | {"kind": "you"}]
            planes.append(plane(points, limit, unit=unit) | {"across": name})
    return {"planes": planes, "compared": text(against.get("measure"), 100), "compared_limit": limit}


def _measure(measure, max_score):
    """A measured error, and its place on a log scale whose middle is the tolerance, from 0 to 1."""
    error, tolerance = number(measure.get("error")), number(measure.get("tolerance"))
    credit, share = number(measure.get("credit")), number(measure.get("share"))
    inside, ratio, place = None, None, None
    if error is not None and tolerance is not None:
        inside, ratio = error <= tolerance, _ratio(error, tolerance)
        decades = log10(ratio) if ratio else DECADES * (-1 if inside else 1)
        place = min(max(0.5 + decades / (2 * DECADES), 0.0), 1.0)
    return {
        **{key: text(measure.get(key), 300) for key in ("name", "metric", "message")},
        "error": error,
        "tolerance": tolerance,
        "inside": inside,
        "ratio": ratio,
        "place": place,
        "hidden_only": measure.get("hidden_only") is True,
        "worth": None if share is None else number(share * max_score),
        "earned": None if share is None or credit is None else number(credit * share * max_score),
    }


def _ratio(value, unit):
    return (
        number(value / unit) if value is not None and value >= 0 and unit is not None and unit > 0 else None
    )


def embed_pictures(checks, folder, pages, room=PICTURE_BYTES):
    """Put pictures into `checks` as base 64, those of the dearest mistakes first, until their bytes fill `room`.

    Paths are relative to `folder`, the result's; only files below `pages` are read.
    """
    pages = pages.resolve()
    for check in sorted(checks, key=_loss, reverse=True):
        for kind, title in PICTURES.items():
            name = check["images"].get(kind)
            if isinstance(name, str):
                picture = {"kind": kind, "title": title, "problem": "", "link": ""}
                try:
                    room -= _embed(picture, (folder / name).resolve(), pages, folder.name, room)
                except (OSError, ValueError):
                    picture["problem"] = "This picture is missing."
                check["pictures"].append(picture)


def _embed(picture, path, pages, student, room):
    """Fill in `picture` from the file at `path`; returns the bytes that it takes of `room`."""
    if not path.is_relative_to(pages):
        raise ValueError(f"{path} is not below {pages}")
    if path.stat().st_size > room:
        picture["problem"] = "Left out, to keep this page small."
        picture["link"] = quote(os.path.relpath(path, pages / student))
        return 0
    data = path.read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n" or data[12:16] != b"IHDR":
        raise ValueError(f"{path} is not a PNG")
    width, height = int.from_bytes(data[16:20]), int.from_bytes(data[20:24])
    zoom = max(1, PICTURE_WIDTH // max(width, height, 1))
    picture.update(width=width * zoom, height=height * zoom, pixels=f"{width} × {height}")
    picture["data"] = b64encode(data).decode()
    return len(data)


def _flat(value, prefix=""):
    """`(name, text)` pairs of a nested record, in its order."""
    if isinstance(value, dict):
        return [pair for key, item in value.items() for pair in _flat(item, f"{prefix} {text(str(key), 80)}")]
    shown = value if isinstance(value, str) else json.dumps(value, default=str)
    return [(prefix.strip().replace("_", " "), text(shown, 400))] if prefix else []


def number(value):
    """A finite float, else None."""
    try:
        usable = isinstance(value, Real) and not isinstance(value, bool) and isfinite(value)
    except OverflowError:  # an integer beyond float64
        return None
    return float(value) if usable else None


def text(value, limit=2000):
    """A stranger's text without control characters, cut at `limit` characters; empty for anything else."""
    if not isinstance(value, str):
        return ""
    cut = value[:limit].replace("\r\n", "\n")
    more = f" … ({len(value) - limit} more characters)" if limit and len(value) > limit else ""
    return UNPRINTABLE.sub(lambda match: match[0].encode("unicode_escape").decode(), cut) + more
