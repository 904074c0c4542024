"""The public half of the checks: what a student's machine needs to judge the inputs that the notebook shows.

Public inputs are made from fixed seeds, so that only the expected outputs have to travel: one file of arrays for each
assignment, in the order in which its checks ask for them.
"""

from __future__ import annotations

import importlib
import io
import zipfile
from pathlib import Path

import numpy as np

from autograder import checks
from autograder.judge import run_check, seed_of

FOLDER = Path(__file__).parent / "checks" / "public"


def record(name) -> Path:
    """Write the arrays of an assignment's public checks, from its reference.

    Parameters
    ----------
    name : str      an assignment

    Returns
    -------
    Path            the file, the same bytes for the same arrays
    """
    reference = importlib.import_module(f"solutions.{name}")
    arrays = {}
    for task in checks.assignment(name).tasks:
        recorder = _Recorder(reference)
        run_check(task, _as_student(reference), recorder, seed_of(b"", name, task.id, True), True)
        for index, value in enumerate(recorder.answers):
            for part, array in enumerate(value if isinstance(value, (tuple, list)) else [value]):
                kind = "s" if isinstance(value, (tuple, list)) else "a"
                arrays[f"{task.id}/{index:03d}{kind}{part:02d}"] = np.asarray(array)
    return write_arrays(FOLDER / f"{name}.npz", arrays)


def write_arrays(path, arrays) -> Path:
    """Write arrays by name; the same bytes for the same arrays."""
    path.parent.mkdir(exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for key in sorted(arrays):
            block = io.BytesIO()
            np.lib.format.write_array(block, arrays[key], allow_pickle=False)
            file.writestr(zipfile.ZipInfo(key + ".npy"), block.getvalue(), zipfile.ZIP_DEFLATED)
    return path


def expected(name, task_id):
    """The recorded answers of one task, to be asked for in their order.

    Parameters
    ----------
    name : str          an assignment
    task_id : str       "1.2"

    Returns
    -------
    namespace           every function of it gives the next recorded answer
    """
    answers: dict[str, list] = {}
    with np.load(FOLDER / f"{name}.npz", allow_pickle=False) as file:
        for key in sorted(file.files):
            task, place = key.split("/")
            if task == task_id:
                answers.setdefault(place[:4], []).append(file[key])
    return _Player([a if key[3] == "s" else a[0] for key, a in sorted(answers.items())])


def _as_student(reference):
    from autograder.wall import as_promised

    return lambda name, arguments, returns: as_promised(getattr(reference, name)(*arguments), returns)


class _Recorder:
    """A reference that remembers what it answered."""

    def __init__(self, reference):
        self._reference, self.answers = reference, []

    def __getattr__(self, name):
        def answer(*arguments):
            self.answers.append(getattr(self._reference, name)(*arguments))
            return self.answers[-1]

        return answer


class _Player:
    """Answers as they were recorded."""

    def __init__(self, answers):
        self._answers = iter(answers)

    def __getattr__(self, name):
        return lambda *_: next(self._answers)
