"""A small real class: the demo's samples, known mistakes, a copy with other names, and accidents."""

import inspect
import re
from pathlib import Path

import nbformat

from autograder import demo, mistakes
from autograder.samples import filled_notebook

# student -> the known mistakes in their notebook
MISTAKEN = {
    "gus": ["sdf-torus-disc"],
    "hal": ["sdf-torus-disc", "blend-swapped"],
    "ida": ["blend-swapped", "sdf-torus-flat"],
    "jon": ["blend-swapped"],
}
OWN_NAMES = {"offset": "o", "nearest_face": "face", "corners": "tips", "corner": "tip", "gradient": "slope", "q": "d",
             "travelled": "way", "distance": "far"}  # fmt: skip
CRASH = {"blend": "def blend(d1, d2, t):\n    import os\n    os.abort()\n"}


def copied(sources):
    """The same functions with other names and other comments."""
    for name, source in sources.items():
        for old, new in OWN_NAMES.items():
            source = re.sub(rf"\b{old}\b", new, source)
        yield name, re.sub(r"\n    return", "\n    # done\n    return", source)


def write(folder):
    """Write the class's notebooks; returns the known mistakes that it has, by id."""
    folder = demo.write_samples(folder)
    known = {m.id: m for m in mistakes.mistakes("sphere_tracing")}
    plain = {"kim": dict(copied(demo.IN_ANOTHER_WAY)), "lea": CRASH}
    for student, ids in MISTAKEN.items():
        plain[student] = {known[id].function: _plain(known[id]) for id in ids}
    for student, replacements in plain.items():
        path = Path(folder) / student / "sphere_tracing.ipynb"
        path.parent.mkdir(parents=True, exist_ok=True)
        nbformat.write(filled_notebook("sphere_tracing", replacements), path)
    (Path(folder) / "max").mkdir(exist_ok=True)
    (Path(folder) / "max" / "sphere_tracing.ipynb").write_text("not a notebook")
    return {id: known[id] for ids in MISTAKEN.values() for id in ids}


def _plain(mistake):
    """A mistake's source as a student would write it."""
    source = inspect.getsource(mistake.code)
    return re.sub(r"def \w+\(", f"def {mistake.function}(", source[source.index("def ") :], count=1)
