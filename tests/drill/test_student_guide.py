"""docs/student.md, followed to the letter in an empty folder, with nothing but the bundle; and the bundle's own README."""

import contextlib
import json
import os
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import nbformat
import pytest

from autograder import bundle, cli
from autograder.samples import filled_notebook, solution_sources
from tests.guides import ROOT, follow, samples, shell

pytestmark = pytest.mark.drill
GUIDE, README = "docs/student.md", "autograder/templates/bundle/README.md"
NOTEBOOK = Path("course", "sphere_tracing", "sphere_tracing.ipynb")
INSIDE = "cd course; . .venv/bin/activate"  # where a reader is after the first block


@pytest.fixture(scope="module")
def student(tmp_path_factory):
    """A folder with the zip in it, on a machine without the course; the page followed up to its first notebook."""
    folder = tmp_path_factory.mktemp("student")
    bundle.write(folder / "course.zip")
    install, start, check = shell(GUIDE)
    follow([install, start], folder, outside(folder), seconds=900)
    return folder


def outside(folder):
    """The environment of somebody who never saw the repository."""
    kept = {key: os.environ[key] for key in ("HOME", "LANG", "NUMBA_CACHE_DIR") if key in os.environ}
    kept |= {key: value for key, value in os.environ.items() if key.startswith(("PIP_", "SSL_", "REQUESTS_", "AWS_CA"))
             or key.lower().endswith("_proxy")}  # fmt: skip
    base = Path(sys.base_prefix) / "bin"
    return kept | {"PATH": f"{base}{os.pathsep}/usr/bin:/bin", "JUPYTER_CONFIG_DIR": str(folder / "jupyter")}


def fill(path, name):
    """Write one function into its cell, as a student would."""
    notebook = nbformat.read(path, as_version=4)
    (cell,) = [c for c in notebook.cells if c.metadata.get("nbgrader", {}).get("grade_id") == name]
    cell.source = solution_sources("sphere_tracing")[name]
    nbformat.write(notebook, path)


def test_the_bundle_stands_alone(student):
    ask = 'python -c "import framework, autograder; print(framework.__file__)"'
    said = follow([INSIDE, "cd ..", ask], student, outside(student))
    assert said.splitlines()[-1].startswith(str(student / "course" / ".venv"))
    with pytest.raises(AssertionError, match="No module named 'solutions'"):
        follow([INSIDE, 'python -c "import solutions"'], student, outside(student))


def test_jupyter_opens_the_notebook(student):
    (command,) = shell(GUIDE, "stays")
    settings = {"ServerApp": {"allow_root": True, "open_browser": False, "port": 8931, "token": "t"}}
    (student / "jupyter").mkdir(exist_ok=True)
    (student / "jupyter" / "jupyter_server_config.json").write_text(json.dumps(settings))
    lab = subprocess.Popen(["bash", "-c", f"{INSIDE}; exec {command}"], cwd=student, env=outside(student),
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
    url = "http://127.0.0.1:8931/api/contents/sphere_tracing.ipynb?token=t"
    try:
        content = None
        for _ in range(120):
            with contextlib.suppress(OSError):
                content = json.load(urllib.request.urlopen(url, timeout=5))
                break
            time.sleep(0.5)
        assert content and len(content["content"]["cells"]) > 20
    finally:
        lab.terminate()
        lab.wait(20)


def test_one_function_filled_in_is_right_in_the_notebook_in_the_terminal_and_for_the_grader(student, tmp_path):
    fill(student / NOTEBOOK, "sdf_sphere")
    run = "jupyter nbconvert --to notebook --execute --allow-errors --inplace sphere_tracing/sphere_tracing.ipynb"
    check = shell(GUIDE)[2]
    said = follow([INSIDE, run, check], student, outside(student))
    assert "✔ 1.1 sdf_sphere: right, on the inputs that you can see" in said
    assert said.count("not written yet") == 6
    assert (student / "course" / "sphere_tracing" / "sphere_tracing-check.html").is_file()
    shown = [o["data"]["text/html"] for c in nbformat.read(student / NOTEBOOK, as_version=4).cells
             for o in c.get("outputs", []) if "text/html" in o.get("data", {})]  # fmt: skip
    (verdict,) = [html for html in shown if "sdf_sphere" in html]
    assert "right, on the inputs that you can see" in verdict and "data:image/png" in verdict
    assert cli.main(["grade", str(student / NOTEBOOK), "--out", str(tmp_path / "out"), "--allow-weak-isolation"]) == 0
    (result,) = [json.loads(path.read_text()) for path in (tmp_path / "out" / "results").rglob("*.json")]
    marks = [(check["status"], check["score"]) for check in result["checks"]]
    assert marks == [("pass", result["checks"][0]["max_score"])] + 6 * [("not_attempted", 0)]


def test_the_cell_for_colab_sets_a_machine_up(student, tmp_path):
    (cell,) = [s.text for s in samples(GUIDE) if s.kind == "colab"]
    (tmp_path / "course.zip").write_bytes((student / "course.zip").read_bytes())
    (tmp_path / "cell.ipy").write_text(cell + "from autograder import check\nimport framework\nprint('ready')\n")
    said = follow([f". {student}/course/.venv/bin/activate", "ipython cell.ipy"], tmp_path, outside(student), seconds=600)
    assert said.splitlines()[-1] == "ready"
    assert (tmp_path / "sphere_tracing.ipynb").is_file() and (tmp_path / "goal.png").is_file()


def test_a_notebook_whose_marks_are_lost_is_told_so_and_mends_as_the_page_says(student, tmp_path):
    notebook = filled_notebook("sphere_tracing")
    for cell in notebook.cells:
        cell.metadata = {}
    nbformat.write(notebook, student / "course" / "sphere_tracing.ipynb")
    (said,) = [line for line in (ROOT / GUIDE).read_text().splitlines() if "marks are lost*" in line]
    sentence = said.strip("- ,or").strip("*")
    with pytest.raises(AssertionError) as refused:
        follow([INSIDE, "course check sphere_tracing.ipynb"], student, outside(student))
    assert sentence.split("*")[0] in str(refused.value)
    follow([INSIDE, "course start sphere_tracing --into again"], student, outside(student))
    again = student / "course" / "again" / "sphere_tracing.ipynb"
    fill(again, "blend")
    said = follow([INSIDE, "course check again/sphere_tracing.ipynb"], student, outside(student))
    assert "✔ 1.4 blend" in said


def test_the_readme_of_the_bundle_says_the_same(student):
    install, start, check = shell(README)
    (opens,) = shell(README, "stays")
    assert opens.split()[-1] == "sphere_tracing/sphere_tracing.ipynb" and "jupyter lab" in opens
    said = follow(["cd course", start.replace("sphere_tracing", "sphere_tracing --into third"),
                   check.replace("sphere_tracing/", "third/")], student, outside(student))  # fmt: skip
    assert said.count("not written yet") == 7
    commands = install.replace(".venv/bin/pip", "pip").splitlines()
    assert commands == [line for line in shell(GUIDE)[0].splitlines() if line in commands]
