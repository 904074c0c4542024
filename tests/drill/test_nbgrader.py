"""nbgrader's own commands in a course folder: its gradebook, feedback and formgrader, with our judgement."""

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import nbformat
import pytest

from autograder import cli, samples

pytestmark = pytest.mark.drill
ROOT = Path(__file__).parents[2]
NAME = "sphere_tracing"
EVIL = "<script>document.title = 'owned'</script> ``` <img src=x onerror=\"document.title='owned'\">"
WRONG = {"blend": "def blend(d1, d2, t):\n    return d1", "sdf_box": "def sdf_box(p, center, half_size):\n    return p[..., 0]"}


def run(folder, *command):
    """nbgrader as an instructor calls it: without the environment's programs on the path."""
    done = subprocess.run([str(Path(sys.executable).with_name("nbgrader")), *command], cwd=folder, text=True,
                          env=os.environ | {"PATH": "/usr/bin:/bin"}, capture_output=True, timeout=300)  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stderr


def grades_in(url):
    """Student -> grade_id -> automatic score, and whether a person must look."""
    from nbgrader.api import Gradebook

    with Gradebook(url) as book:
        return {
            s.student.id: {g.name: (g.auto_score, g.needs_manual_grade) for n in s.notebooks for g in n.grades}
            for s in book.assignment_submissions(NAME)
        }


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """A course folder after generate_assignment, autograde and generate_feedback."""
    folder = tmp_path_factory.mktemp("course")
    shutil.copy(ROOT / "nbgrader_config.py", folder)
    run(folder, "generate_assignment", NAME)

    def hand_in(student, notebook):
        place = folder / "submitted" / student / NAME
        place.mkdir(parents=True)
        if isinstance(notebook, str):
            (place / f"{NAME}.ipynb").write_text(notebook)
        else:
            nbformat.write(notebook, place / f"{NAME}.ipynb")
        return place

    place = hand_in("amy", samples.filled_notebook(NAME))
    (place / "timestamp.txt").write_text("2026-01-02 03:04:05 UTC")
    (place / "private.txt").write_text("stays where it is")
    evil = samples.filled_notebook(NAME, WRONG)
    for cell in evil.cells:
        if cell.metadata.get("nbgrader", {}).get("grade_id") == "question-1":
            cell.source = EVIL
        elif cell.cell_type == "markdown":
            cell.source += EVIL
    (hand_in("eve", evil) / "timestamp.txt").write_text("no time at all")
    twice = samples.filled_notebook(NAME)
    marked = [cell for cell in twice.cells if "nbgrader" in cell.metadata]
    twice.cells += [nbformat.from_dict(dict(marked[1]) | {"id": "again"})]
    marked[3].metadata.nbgrader.schema_version = "?"
    del twice.cells[twice.cells.index(marked[5])]
    hand_in("odd", twice)
    hand_in("broken", '{"cells": [')
    (folder / "submitted" / "link" / NAME).mkdir(parents=True)
    (folder / "submitted" / "link" / NAME / f"{NAME}.ipynb").symlink_to("/etc/passwd")
    printed = run(folder, "autograde", NAME)
    assert "left alone, a link" in printed and "is no time" in printed
    run(folder, "generate_feedback", NAME)
    return folder


def test_scores_are_those_of_course_grade(course, tmp_path):
    cli.main(["grade", str(course / "submitted"), "--out", str(tmp_path), "--allow-weak-isolation"])
    graded = grades_in(f"sqlite:///{course}/gradebook.db")
    assert sorted(graded) == ["amy", "broken", "eve", "odd"]
    for student, grades in graded.items():
        result = json.loads((tmp_path / "results" / student / f"{NAME}.json").read_text())
        scores = {f"check-{check['id'].replace('.', '-')}": check["score"] for check in result["checks"]}
        assert {name: score for name, (score, _) in grades.items() if name in scores} == scores
    assert sum(score for score, _ in graded["amy"].values()) == 20
    assert graded["eve"]["question-1"] == (None, True) and graded["amy"]["question-1"][1] is False
    assert not list(course.glob(".rebuilt-*"))


def test_nothing_but_solution_cells_reaches_what_nbgrader_keeps(course):
    assert not list(course.glob("autograded/**/private.txt")) and not list(course.glob("feedback/**/private.txt"))
    assert not (course / "autograded" / "link").exists()
    notebook = nbformat.read(course / "autograded" / "eve" / NAME / f"{NAME}.ipynb", as_version=4)
    holding = [cell for cell in notebook.cells if "owned" in cell.source]
    assert [cell.metadata.nbgrader.grade_id for cell in holding] == ["question-1"]
    assert holding[0].source.startswith("````text\n")


def test_feedback_has_pictures_and_runs_no_script(course, browser):
    for student, pictures in (("amy", 7), ("eve", 7), ("broken", 0)):
        page = browser.new_page()
        page.goto((course / "feedback" / student / NAME / f"{NAME}.html").as_uri())
        assert page.title() != "owned"
        assert page.locator("img[src^='data:image/png']").count() >= pictures
        page.close()
    assert "not valid JSON" in (course / "feedback" / "broken" / NAME / f"{NAME}.html").read_text()


def test_formgrader_shows_partial_credit_and_pictures(course, browser, tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = subprocess.Popen(
        [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", f"--port={port}",
         "--IdentityProvider.token=", "--ServerApp.password="],
        cwd=course, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env=os.environ | {"HOME": str(tmp_path), "PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"},
    )  # fmt: skip
    try:
        address = f"http://127.0.0.1:{port}"
        _wait_for(f"{address}/api/status", server)
        page = browser.new_page(viewport={"width": 1280, "height": 1600})
        page.goto(f"{address}/formgrader/gradebook/{NAME}/{NAME}")
        page.get_by_text("Submission #1").wait_for(timeout=60_000)
        from nbgrader.api import Gradebook

        with Gradebook(f"sqlite:///{course}/gradebook.db") as book:
            ids = {s.student.id: s.notebooks[0].id for s in book.assignment_submissions(NAME)}
        page.goto(f"{address}/formgrader/submissions/{ids['eve']}/?index=0")
        page.get_by_text("check(\"1.2\")").wait_for(timeout=60_000)
        assert page.title() != "owned"
        assert page.locator("img[src^='data:image/png']").count() >= 7
        page.wait_for_function("document.querySelectorAll('input.score[placeholder]').length >= 7")
        scores = [float(box.get_attribute("placeholder") or 0) for box in page.locator("input.score").all()[:7]]
        assert scores == [2, 0, 3, 0, 3, 3, 5]
        page.screenshot(path=tmp_path / "formgrader.png")
        print(tmp_path / "formgrader.png")
    finally:
        server.terminate()
        server.wait(20)


def _wait_for(address, server):
    for _ in range(240):
        assert server.poll() is None, "JupyterLab ended"
        try:
            urllib.request.urlopen(address, timeout=2).close()
            return
        except OSError:
            time.sleep(0.25)
    raise AssertionError("JupyterLab did not start in a minute")


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request, tmp_path):
    """The URL of an empty database."""
    if request.param == "sqlite":
        yield f"sqlite:///{tmp_path}/own.db"
        return
    programs = sorted(Path("/usr/lib/postgresql").glob("*/bin"))
    if not programs:
        pytest.skip("PostgreSQL is not installed: apt-get install postgresql")
    folder = Path("/tmp") / f"course-postgres-{os.getpid()}"
    as_postgres = ["runuser", "-u", "postgres", "--"] if os.geteuid() == 0 else []

    def call(program, *arguments):
        subprocess.run([*as_postgres, programs[-1] / program, *arguments], check=True, capture_output=True, cwd="/")

    call("initdb", "-D", folder, "--auth=trust", "--username=postgres")
    try:
        call("pg_ctl", "-D", folder, "-w", "-l", folder / "log", "-o", f"-k {folder} -c listen_addresses=", "start")
        yield f"postgresql://postgres@/postgres?host={folder}"
    finally:
        subprocess.run([*as_postgres, programs[-1] / "pg_ctl", "-D", folder, "-m", "immediate", "stop"], cwd="/")
        shutil.rmtree(folder)


def test_course_grade_writes_the_same_scores_into_a_gradebook(course, database, tmp_path):
    for _ in range(2):
        arguments = ["grade", str(course / "submitted"), "--out", str(tmp_path / "graded"), "--gradebook", database]
        assert cli.main([*arguments, "--allow-weak-isolation"]) == 0
        ours, theirs = grades_in(database), grades_in(f"sqlite:///{course}/gradebook.db")
        assert {s: {n: g[0] for n, g in grades.items() if n != "question-1"} for s, grades in ours.items()} == {
            s: {n: g[0] for n, g in grades.items() if n != "question-1"} for s, grades in theirs.items()
        }


def test_a_mark_given_by_a_person_stays_when_it_is_graded_again(course, database, tmp_path):
    from nbgrader.api import Gradebook

    arguments = ["grade", str(course / "submitted"), "--out", str(tmp_path / "graded"), "--gradebook", database]
    cli.main([*arguments, "--allow-weak-isolation"])
    with Gradebook(database) as book:
        book.find_grade("check-1-2", NAME, NAME, "eve").manual_score = 2.5
        book.db.commit()
    cli.main([*arguments, "--allow-weak-isolation"])
    with Gradebook(database) as book:
        grade = book.find_grade("check-1-2", NAME, NAME, "eve")
        assert (grade.manual_score, grade.score, grade.auto_score) == (2.5, 2.5, 0.0)
