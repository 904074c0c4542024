"""`make demo`: six sample submissions graded, pictures rendered, and where to look."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import nbformat

from autograder import cli, samples

IN_ANOTHER_WAY = {
    "sdf_sphere": '''
def sdf_sphere(p, center, radius):
    offset = np.asarray(p, float) - center
    return np.sqrt((offset ** 2).sum(-1)) - radius
''',
    "sdf_box": '''
def sdf_box(p, center, half_size):
    q = np.abs(np.asarray(p, float) - center) - half_size
    nearest_face = q.max(axis=-1)
    return np.where(nearest_face > 0, np.linalg.norm(q.clip(0), axis=-1), nearest_face)
''',
    "estimate_normal": '''
def estimate_normal(sdf, p, eps):
    # four corners of a tetrahedron instead of six points on the axes
    corners = np.array([[1, -1, -1], [-1, -1, 1], [-1, 1, -1], [1, 1, 1]])
    gradient = sum(sdf(p + eps * corner)[:, None] * corner for corner in corners)
    return gradient / np.linalg.norm(gradient, axis=1, keepdims=True)
''',
    "sphere_trace": '''
def sphere_trace(sdf, origin, direction, t_max, eps, max_steps):
    t = np.full(len(origin), np.inf)
    for i in range(len(origin)):
        travelled = 0.0
        for _ in range(max_steps):
            distance = sdf(origin[i:i + 1] + travelled * direction[i:i + 1])[0]
            if distance < eps:
                t[i] = travelled
                break
            travelled += distance
            if travelled > t_max:
                break
    return t, np.isfinite(t)
''',
}
NO_INSIDE = {
    "sdf_box": '''
def sdf_box(p, center, half_size):
    q = np.abs(np.asarray(p) - center) - half_size
    return np.linalg.norm(np.maximum(q, 0), axis=-1)
''',
}
STEPS_ARE_HITS = {
    "sphere_trace": '''
def sphere_trace(sdf, origin, direction, t_max, eps, max_steps):
    t = np.zeros(len(origin))
    for _ in range(max_steps):
        distance = sdf(origin + t[:, None] * direction)
        t = np.where(distance < eps, t, t + distance)
    hit = t < t_max
    return np.where(hit, t, np.inf), hit
''',
}
ENDLESS = {
    "smooth_union": '''
def smooth_union(d1, d2, k):
    h = np.maximum(k - np.abs(d1 - d2), 0)
    while np.any(h >= 0):
        h = h / 2
    return np.minimum(d1, d2) - h * h / (4 * k)
''',
}
SAMPLES = {
    "ada": {},
    "ben": IN_ANOTHER_WAY,
    "chloe": NO_INSIDE,
    "dan": STEPS_ARE_HITS,
    "eve": None,
    "finn": ENDLESS,
}


def write_samples(folder) -> Path:
    """Six submissions made from the released notebook: right, right in another way, two with common mistakes, one
    with nothing filled in, one with an endless loop."""
    for student, replacements in SAMPLES.items():
        notebook = samples.filled_notebook("sphere_tracing", replacements or {}, fill=replacements is not None)
        path = Path(folder) / student / "sphere_tracing.ipynb"
        path.parent.mkdir(parents=True, exist_ok=True)
        nbformat.write(notebook, path)
    return Path(folder)


def main(arguments=None) -> int:
    """Grade the samples, render the pictures, say where they are."""
    parser = argparse.ArgumentParser(prog="python -m autograder.demo", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/demo"), help="folder of the results")
    options = parser.parse_args(arguments)
    print("Grading six sample submissions to sphere_tracing (one has an endless loop, which takes its 10 s) ...")
    write_samples(options.out / "submissions")
    graded = options.out / "graded"
    code = cli.main(["grade", str(options.out / "submissions"), "--out", str(graded), "--allow-weak-isolation"])
    if code:
        return code
    print("Rendering pictures ...")
    from solutions import gallery

    pictures = gallery.render(options.out / "gallery")
    print(f"\nThe marks:     {graded / 'index.html'}")
    print(f"The pictures:  {pictures}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
