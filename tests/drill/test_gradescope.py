"""The zip for Gradescope, unpacked and run as Gradescope does, in a folder in place of its /autograder."""

import json
import os
import shutil
import subprocess
import zipfile

import nbformat
import pytest

from autograder import gradescope, samples

pytestmark = pytest.mark.drill


def _run(script):
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("VIRTUAL_ENV", "PYTHON"))}
    done = subprocess.run([script], env=environment, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr[-2000:]


def test_the_zip_sets_itself_up_and_grades_one_submission(tmp_path):
    source = tmp_path / "source"
    with zipfile.ZipFile(gradescope.package(tmp_path / "autograder.zip")) as archive:
        archive.extractall(source)
        for entry in archive.infolist():
            (source / entry.filename).chmod(entry.external_attr >> 16)
    _run(source / "setup.sh")

    shutil.copy2(source / "run_autograder", tmp_path)
    (tmp_path / "submission").mkdir()
    (tmp_path / "results").mkdir()
    _run(tmp_path / "run_autograder")
    results = json.loads((tmp_path / "results" / "results.json").read_text())
    assert results["score"] == 0 and "exactly one is wanted" in results["output"]

    wrong = {"blend": "def blend(d1, d2, t):\n    return d1"}
    nbformat.write(samples.filled_notebook("sphere_tracing", wrong), tmp_path / "submission" / "sphere_tracing.ipynb")
    _run(tmp_path / "run_autograder")
    results = json.loads((tmp_path / "results" / "results.json").read_text())
    lost = [test["name"] for test in results["tests"] if test["score"] < test["max_score"]]
    assert lost == ["1.4 blend"] and len(results["tests"]) == 7
    assert results["score"] == sum(test["score"] for test in results["tests"])
