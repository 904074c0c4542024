"""`course start`: a folder to work in, and never a file of the student's replaced."""

import pytest

from autograder import cli, cli_student
from autograder.release import ROOT


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("main", [cli.main, cli_student.main])
def test_start_makes_a_folder_with_all_that_the_notebook_needs_and_says_what_is_next(main, tmp_path, capsys):
    assert main(["start", "prefilter"]) == 0
    released = {path.name: path.read_bytes() for path in (ROOT / "assignments" / "prefilter").iterdir()}
    assert {path.name: path.read_bytes() for path in (tmp_path / "prefilter").iterdir()} == released
    assert "sky.exr" in released
    assert capsys.readouterr().out.splitlines()[-1] == "next: jupyter lab prefilter/prefilter.ipynb"


def test_start_takes_an_empty_folder(tmp_path):
    (tmp_path / "mine").mkdir()
    assert cli.main(["start", "soft_shadows", "--into", "mine"]) == 0
    assert (tmp_path / "mine" / "soft_shadows.ipynb").is_file()
    assert cli.main(["start", "sphere_tracing", "--into", "."]) == 2


@pytest.mark.parametrize(
    "there, asked, said",
    [
        ("prefilter/prefilter.ipynb", ["prefilter"], "prefilter/prefilter.ipynb is there already and stays as it is"),
        ("prefilter/notes.txt", ["prefilter"], "prefilter is not empty; --into DIR names another folder"),
        ("mine", ["prefilter", "--into", "mine"], "mine is a file; an empty or a new folder is wanted"),
        ("mine", ["prefilter", "--into", "mine/deep"], "mine/deep cannot be made: "),
        ("mine", ["prefiltering"], "there is no assignment 'prefiltering'; there are sphere_tracing, soft_shadows"),
    ],
)
def test_start_refuses_in_one_sentence_and_leaves_all_as_it_was(there, asked, said, tmp_path, capsys):
    path = tmp_path / there
    path.parent.mkdir(exist_ok=True)
    path.write_text("mine")
    assert cli.main(["start", *asked]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"course: {said}")
    assert [p for p in tmp_path.rglob("*") if p.is_file()] == [path] and path.read_text() == "mine"
