"""Five notebooks with one thing wrong each, of the kinds that a page has to tell apart."""

from pathlib import Path

import nbformat

from autograder import demo
from autograder.samples import filled_notebook

WRONG = {
    "nan": ("soft_shadows", "safe_angle", """
def safe_angle(distance, travelled):
    return np.arcsin(distance / travelled)
"""),
    "exception": ("sphere_tracing", "estimate_normal", """
def estimate_normal(sdf, p, eps):
    steps = eps * np.eye(3)
    gradient = np.stack([sdf(p + s) - sdf(p - s) for s in steps], axis=-1)
    return gradient / np.linalg.norm(gradient, axis=1)
"""),
    "shape": ("sphere_tracing", "sdf_box", """
def sdf_box(p, center, half_size):
    q = np.abs(np.asarray(p) - center) - half_size
    return np.maximum(q, 0) + np.minimum(q.max(-1), 0)[..., None]
"""),
    "slow": ("sphere_tracing", "smooth_union", demo.ENDLESS["smooth_union"]),  # of CPU, however busy the machine is
    "mistake": ("soft_shadows", "penumbra", """
def penumbra(distance, travelled, k):
    return np.clip(k * distance + 0 * travelled, 0, 1)
"""),
}  # fmt: skip


def write(folder):
    """Write `folder/KIND/ASSIGNMENT.ipynb` for each of the five."""
    for kind, (assignment, function, source) in WRONG.items():
        path = Path(folder) / kind / f"{assignment}.ipynb"
        path.parent.mkdir(parents=True, exist_ok=True)
        nbformat.write(filled_notebook(assignment, {function: source}), path)
