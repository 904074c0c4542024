"""Results as the grader writes them, with pictures, and as a stranger would like them."""

import json

import numpy as np
from PIL import Image

from autograder.report import write_page

TASKS = {
    "sphere_tracing": [
        "sdf_sphere",
        "sdf_box",
        "sdf_torus",
        "blend",
        "smooth_union",
        "estimate_normal",
        "sphere_trace",
    ],
    "soft_shadows": ["safe_angle", "penumbra", "needs_shadow_ray", "soft_shadow", "area_light_shadow"],
}
ASKED = {
    "sdf_box": "Return the exact signed distance to a box, negative inside.",
    "estimate_normal": "Return the unit gradient of the distance by finite differences.",
    "sphere_trace": "March each ray by its distance and return where it hits.",
    "soft_shadow": "March towards the light and keep the smallest penumbra.",
}
MISTAKE = {
    "message": "inside the box the distance is 0 where it should be negative (812 of 4096 points).",
    "likely_mistake": "box-without-interior-term",
    "symptom": "The distance is 0 everywhere inside.",
    "hint": "Add min(max(q.x, q.y, q.z), 0): the first term alone is 0 everywhere inside.",
    "title": ASKED["sdf_box"],
    "caption": "A slice through the centre of the box; outside is grey, inside is blue.",
    "scale": 0.25,
    "measures": [
        {"name": "outside the box", "metric": "max abs", "error": 3.1e-16, "tolerance": 1e-9, "credit": 1.0,
         "share": 0.3, "hidden_only": False, "message": ""},
        {"name": "inside the box", "metric": "max abs", "error": 0.25, "tolerance": 1e-9, "credit": 0.0,
         "share": 0.5, "hidden_only": True, "message": "At the centre it is 0, and -0.25 is wanted."},
        {"name": "length of the gradient", "metric": "rms", "error": 0.0213, "tolerance": 0.01, "credit": 0.4,
         "share": 0.2, "hidden_only": True, "message": ""},
    ],
}  # fmt: skip
TRACEBACK = """Traceback (most recent call last):
  cell estimate_normal, line 4, in estimate_normal
    return gradient / np.linalg.norm(gradient, axis=1)
ValueError: operands could not be broadcast together with shapes (64,3) (64,)"""
BREAKS = {"error": "estimate_normal raised ValueError: operands could not be broadcast together.",
          "timeout": "sphere_trace used its 10 s of CPU; the reference needs 0.05 s. Does every ray advance?",
          "out_of_memory": "the process ran over its 2 GiB.",
          "crashed": "Python died of a segmentation fault.",
          "not_attempted": ""}  # fmt: skip


def check(task, name, status="pass", score=2, max_score=2, **more):
    return {"id": task, "name": name, "status": status, "score": score, "max_score": max_score,
            "message": BREAKS.get(status, ""), **more}  # fmt: skip


def result(student="amy", assignment="sphere_tracing", checks=(), **more):
    return {
        "schema": 1, "assignment": assignment, "student": student, "status": "graded", "message": "",
        "score": sum(c["score"] for c in checks), "max_score": sum(c["max_score"] for c in checks),
        "isolation": "namespaces+seccomp", "wall_seconds": 1.9, "peak_memory_mb": 210,
        "checks": list(checks),
        "record": {"notebook": "9f2c" * 16, "versions": {"python": "3.11.9", "numpy": "2.4.0"}, "seed": 2024},
        **more,
    }  # fmt: skip


def sample_checks():
    """One check of every status, with everything that a check may carry somewhere among them."""
    names = TASKS["sphere_tracing"]
    return [
        check("1.1", names[0], title="Return the signed distance to a sphere.",
              measures=[{"name": "grid of points", "metric": "max abs", "error": 0.0, "tolerance": 1e-9,
                         "credit": 1.0, "share": 1.0, "hidden_only": False, "message": ""}]),
        check("1.2", names[1], "partial", 1.16, 3, **MISTAKE),
        check("1.3", names[2], "fail", 0, 3, metric="max abs", error=1.7, tolerance=1e-9,
              message="the axis is z, not y."),
        check("1.4", names[3], "not_attempted", 0, 1),
        check("1.5", names[4], "crashed", 0, 2),
        check("1.6", names[5], "error", 0, 4, title=ASKED["estimate_normal"], traceback=TRACEBACK,
              prints="eps = 0.001\nshape (64, 3)\n"),
        check("1.7", names[6], "timeout", 0, 5, title=ASKED["sphere_trace"], evaluations=912345,
              evaluations_reference=81234),
        check("1.8", "one_more", "out_of_memory", 0, 2),
    ]  # fmt: skip


def paint(folder, task, size=128, noise=0.0):
    """The three pictures of a task: a shaded ball, the student's darker below, and the difference."""
    y, x = np.mgrid[-1.3 : 1.3 : size * 1j, -1.3 : 1.3 : size * 1j]
    z = np.sqrt(np.clip(1 - x * x - y * y, 0, 1))
    light = np.clip(0.5 * x - 0.6 * y + 0.62 * z, 0, 1) * (z > 0)
    rng = np.random.default_rng(7)
    reference = 0.12 + 0.75 * light[..., None] * [1.0, 0.93, 0.8] + noise * rng.random((size, size, 3))
    yours = reference * (1 - 0.5 * (y > 0.1) * (z > 0))[..., None]
    difference = (np.abs(yours - reference)[..., :1] * [2.6, 0.9, 0.4]) ** 0.8
    folder.mkdir(parents=True, exist_ok=True)
    for kind, pixels in {"yours": yours, "reference": reference, "difference": difference}.items():
        Image.fromarray((np.clip(pixels, 0, 1) * 255).astype(np.uint8)).save(folder / f"{task}-{kind}.png")
    where = f"../../pages/{folder.parent.name}/{folder.name}/{task}"
    return {kind: f"{where}-{kind}.png" for kind in ("yours", "reference", "difference")}


def store(out, data, folder=None):
    """Write a result where the grader would; returns its path."""
    path = out / "results" / (folder or data["student"]) / f"{data['assignment']}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(data))
    return path


def page_of(out, data, folder=None):
    return write_page(data, store(out, data, folder), out).read_text(encoding="utf-8")


EVIL = "</title></style><script>alert(1)</script>\"'><img src=x onerror=alert(2)>{{ 7*7 }}&lt;b&gt;"


def poison(value):
    if isinstance(value, dict):
        return {key: poison(item) for key, item in value.items()}
    if isinstance(value, list):
        return [poison(item) for item in value]
    return EVIL if isinstance(value, str) else value
