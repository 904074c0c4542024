"""docs/instructor.md, followed to the letter: every command on the page is run, in order."""

import subprocess
import time

import nbformat
import pytest

from autograder.samples import filled_notebook
from tests.drill.hostile_files import FEW
from tests.guides import environment, follow, shell

pytestmark = pytest.mark.drill
PAGE = "docs/instructor.md"


@pytest.fixture
def folder(tmp_path):
    """An empty folder of an instructor's, in which two students have handed in."""
    for student, wrong in (("amy", {}), ("bob", {"blend": "def blend(d1, d2, t):\n    return d1"})):
        path = tmp_path / "submissions" / student / "sphere_tracing.ipynb"
        path.parent.mkdir(parents=True)
        nbformat.write(filled_notebook("sphere_tracing", FEW | wrong), path)
    return tmp_path


def test_every_command_of_the_guide_works(folder):
    blocks = shell(PAGE)
    assert sum(text.count("course ") + text.count("nbgrader ") for text in blocks) >= 13
    follow(blocks, folder, environment(), seconds=600)
    assert (folder / "graded" / "grades.csv").read_text().splitlines()[1].startswith("amy,sphere_tracing,graded,3.0,22.0")
    made = ["graded/export/csv/tasks.csv", "graded/export/gradescope/autograder.zip", "marks.db",
            "graded/export/prairielearn/bob/sphere_tracing/results.json",
            "feedback/bob/sphere_tracing/sphere_tracing.html"]  # fmt: skip
    assert [name for name in made if not (folder / name).exists()] == []


def test_the_cluster_of_the_guide_grades(folder):
    (commands,) = [text.replace("grader", "127.0.0.1").splitlines() for text in shell(PAGE, "cluster")]
    (folder / "secret.txt").write_text("secret")
    stays = []
    try:
        for command in commands:
            words = command.split()
            if words[0] == "dask":
                stays.append(subprocess.Popen(words, cwd=folder, env=environment(), stderr=subprocess.DEVNULL))
                time.sleep(4)
            else:
                done = subprocess.run(words, cwd=folder, env=environment(), capture_output=True, text=True, timeout=300)
                assert done.returncode == 0, done.stderr[-1500:]
    finally:
        for process in stays:
            process.terminate()
            process.wait(20)
    assert len(stays) == 2
    assert "bob,sphere_tracing,graded,2.0,20.0" in (folder / "graded-there" / "grades.csv").read_text()
