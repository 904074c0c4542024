"""Which files are submissions, whose they are, and where their results go."""

import os
import shutil
import zipfile

import nbformat
import pytest

from autograder.discover import find
from autograder.samples import filled_notebook


@pytest.fixture
def notebook(tmp_path):
    path = tmp_path / "made" / "sphere_tracing.ipynb"
    path.parent.mkdir()
    nbformat.write(filled_notebook("sphere_tracing", fill=False), path)
    return path


@pytest.fixture
def place(notebook, tmp_path):
    def put(where, modified=None):
        path = tmp_path / "given" / where
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(notebook, path)
        if modified:
            os.utime(path, (modified, modified))
        return path

    return put


def found(*paths, notices=None):
    notices = [] if notices is None else notices
    return [(unit.student, unit.assignment) for unit in find(paths, notices.append)]


def test_the_student_is_the_folder_that_holds_the_file(place, tmp_path):
    place("amy/sphere_tracing.ipynb")
    place("bob/homework.ipynb")
    assert found(tmp_path / "given") == [("amy", "sphere_tracing"), ("bob", "sphere_tracing")]


def test_a_folder_named_like_an_assignment_is_passed_over(place, tmp_path):
    place("amy/sphere_tracing/sphere_tracing.ipynb")
    assert found(tmp_path / "given") == [("amy", "sphere_tracing")]


def test_a_file_in_the_folder_given_or_by_itself_is_its_stem(place, tmp_path):
    path = place("carol.ipynb")
    assert found(tmp_path / "given") == found(path) == [("carol", "sphere_tracing")]


def test_of_several_the_newest_counts_and_the_others_are_named(place, tmp_path):
    place("amy/old.ipynb", 1000)
    newest = place("amy/new.ipynb", 3000)
    place("amy/older.ipynb", 2000)
    notices = []
    (unit,) = find([tmp_path / "given"], notices.append)
    assert unit.path == str(newest)
    assert "old.ipynb" in unit.message and "older.ipynb" in unit.message and len(notices) == 2


def test_on_a_tie_the_last_path_counts(place, tmp_path):
    place("amy/a.ipynb", 1000)
    last = place("amy/b.ipynb", 1000)
    (unit,) = find([tmp_path / "given"], lambda text: None)
    assert unit.path == str(last)


def test_links_and_special_files_are_left_alone_and_named(place, notebook, tmp_path):
    place("amy/sphere_tracing.ipynb")
    (tmp_path / "given" / "bob").mkdir()
    (tmp_path / "given" / "bob" / "link.ipynb").symlink_to(notebook)
    (tmp_path / "given" / "linked").symlink_to(tmp_path / "made")
    os.mkfifo(tmp_path / "given" / "bob" / "pipe.ipynb")
    notices = []
    assert found(tmp_path / "given", notices=notices) == [("amy", "sphere_tracing")]
    assert len(notices) == 3


def test_a_zip_counts_as_a_folder_of_its_name(notebook, tmp_path):
    (tmp_path / "given").mkdir()
    with zipfile.ZipFile(tmp_path / "given" / "amy.zip", "w") as file:
        file.write(notebook, "sphere_tracing.ipynb")
    with zipfile.ZipFile(tmp_path / "given" / "class.zip", "w") as file:
        file.write(notebook, "bob/sphere_tracing.ipynb")
        file.write(notebook, "../../carol/sphere_tracing.ipynb")
    assert found(tmp_path / "given") == [(name, "sphere_tracing") for name in ("amy", "bob", "carol")]


def test_a_damaged_or_empty_zip_gets_one_rejected_result(tmp_path):
    (tmp_path / "given").mkdir()
    (tmp_path / "given" / "amy.zip").write_bytes(b"PK\x03\x04 no zip")
    zipfile.ZipFile(tmp_path / "given" / "bob.zip", "w").close()
    units = find([tmp_path / "given"], lambda text: None)
    assert [(u.student, u.assignment, bool(u.problem)) for u in units] == [
        ("amy", "unknown", True),
        ("bob", "unknown", True),
    ]


def test_odd_names_become_file_names_that_differ(place, tmp_path):
    names = ["Zoë", "Zo_", "a b", "a_b", "x" * 120, "..."]
    for name in names:
        place(f"{name}/sphere_tracing.ipynb")
    units = find([tmp_path / "given"], lambda text: None)
    folders = [unit.folder for unit in units]
    assert len(set(map(str.lower, folders))) == len(names)
    assert all(len(f) <= 80 and f.strip(".") and set(f) <= set(ALLOWED) for f in folders)
    assert {u.student: u.folder for u in units}["a_b"] == "a_b"


ALLOWED = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-"


def test_an_unknown_assignment_is_unknown(tmp_path):
    (tmp_path / "given").mkdir()
    (tmp_path / "given" / "essay.ipynb").write_text("{}")
    (tmp_path / "given" / "sphere_tracing.ipynb").write_text("not JSON")
    assert found(tmp_path / "given") == [("essay", "unknown"), ("sphere_tracing", "sphere_tracing")]
