"""The zip for students: what is in it, and what must not be."""

import json
import re
import tomllib
import zipfile

import pytest

from autograder import bundle, checks
from autograder.release import ROOT

PLAIN = {"return result", "else:", "break", "return color", "return 0.0", "p = np.asarray(p, dtype=float)",
         "t = np.full(len(origin), np.inf)"}  # fmt: skip


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    path = tmp_path_factory.mktemp("bundle") / "course.zip"
    bundle.write(path)
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def solution_lines():
    """Lines of code between the marks of the references."""
    regions = [region for name in checks.ASSIGNMENTS for region in re.findall(
        r"### BEGIN SOLUTION\n(.*?)### END SOLUTION", (ROOT / "solutions" / f"{name}.py").read_text(), re.S)]  # fmt: skip
    return {line.strip() for line in "".join(regions).splitlines() if line.strip(" #")} - PLAIN


def lines_of(name, data):
    text = data.decode("utf-8", "replace")
    if name.endswith(".ipynb"):
        text = "\n".join("".join(cell["source"]) for cell in json.loads(text)["cells"])
    return {line.strip() for line in text.splitlines()}


def test_no_line_of_a_solution_is_in_it(files):
    wanted = solution_lines()
    assert len(wanted) > 250
    assert {name: found for name, data in files.items() if (found := wanted & lines_of(name, data))} == {}


def test_the_search_for_solutions_finds_them_where_they_are():
    path = ROOT / "solutions" / "soft_shadows.py"
    assert len(solution_lines() & lines_of(path.name, path.read_bytes())) > 20


def test_neither_grader_nor_reference_images_nor_mistakes_are_in_it(files):
    folders = {name.rpartition("/")[0] for name in files}
    assert not {folder for folder in folders if re.match(r"solutions|autograder/mistakes|tests|benchmarks", folder)}
    assert [name for name in files if name.startswith("autograder/references/")] == ["autograder/references/tolerances.json"]
    grader = {"grade", "sandbox", "worker", "zygote", "unit", "batch", "release", "samples", "calibrate", "cli", "cli_grade"}
    assert not grader & {name.split("/")[1][:-3] for name in files if name.startswith("autograder/")}


def test_all_of_every_assignment_and_its_public_arrays_are_in_it(files):
    for name in checks.available():
        for path in (ROOT / "assignments" / name).iterdir():
            assert files[f"assignments/{name}/{path.name}"] == path.read_bytes()
        assert f"autograder/checks/public/{name}.npz" in files
    assert {"README.md", "LICENSE", "requirements.txt", "docs/student.md", "framework/data/teapot.obj"} <= set(files)


def test_its_project_asks_for_what_students_need_alone(files):
    project = tomllib.loads(files["pyproject.toml"].decode())
    named = {re.match(r"[\w-]+", line)[0].lower() for line in project["project"]["dependencies"]}
    assert {"numpy", "numba", "jupyterlab", "ipywidgets"} <= named and not {"nbgrader", "dask", "pytest"} & named
    pinned = {line.split("==")[0] for line in files["requirements.txt"].decode().splitlines()}
    assert named <= pinned and "nbgrader" not in pinned
    assert project["project"]["scripts"] == {"course": "autograder.cli_student:main"}


def test_the_same_sources_give_the_same_bytes(tmp_path):
    for name in ("a.zip", "b.zip"):
        bundle.write(tmp_path / name)
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()
