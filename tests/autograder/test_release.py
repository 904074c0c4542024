"""What students get: reproducible, accepted by nbgrader, without answers."""

import subprocess
import sys
from pathlib import Path

import nbformat
import numpy as np
import pytest

import framework as fw
from autograder.goal_pictures import run_cells
from autograder.release import ASSIGNMENTS, ROOT, build_source, release, write_source
from autograder.samples import filled_notebook, solution_sources

POINTS = {"split_sum": 24}  # for its numbered tasks; 20 for others; the question that a person marks comes on top


@pytest.fixture(scope="module")
def released(tmp_path_factory):
    """All assignments, released into a fresh folder."""
    folder = tmp_path_factory.mktemp("released")
    release(into=folder)
    return folder


def code_cells(notebook, role):
    return [cell for cell in notebook.cells if cell.metadata.get("nbgrader", {}).get(role)]


def files_below(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_two_releases_are_the_same_to_the_byte(released, tmp_path):
    release(into=tmp_path)
    assert files_below(tmp_path) == files_below(released)


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_what_is_committed_is_what_the_sources_give(released, name):
    assert files_below(ROOT / "assignments" / name) == files_below(released / name), "run `course release`"


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_no_line_of_a_solution_is_released(released, name):
    text = "\n".join(path.read_text() for path in (released / name).glob("*.ipynb"))
    lines = [line for source in _bodies(name) for line in map(str.strip, source) if len(line) > 12]
    assert len(lines) > 10
    assert [line for line in lines if _quoted(line) in text] == []


def _bodies(name):
    """The lines between the marks of each solution, and the model answers."""
    for cell in build_source(name).cells:
        if cell.cell_type == "markdown" and cell.metadata.get("nbgrader"):
            yield cell.source.split("\n")
        elif cell.metadata.get("nbgrader", {}).get("solution"):
            lines = [line.strip() for line in cell.source.split("\n")]
            yield lines[lines.index("### BEGIN SOLUTION") + 1 : lines.index("### END SOLUTION")]


def _quoted(line):
    """A line as it stands in a notebook's JSON."""
    return line.replace("\\", "\\\\").replace('"', '\\"')


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_a_release_says_what_it_is_and_cells_have_stable_names(released, name):
    notebook = nbformat.read(released / name / f"{name}.ipynb", as_version=4)
    nbformat.validate(notebook)
    assert notebook.metadata.course.assignment == name
    assert notebook.metadata.kernelspec.name == "python3"
    for cell in notebook.cells:
        assert cell.id == cell.metadata.get("nbgrader", {}).get("grade_id", cell.id)
        assert not cell.get("outputs")
    assert (released / name / "goal.png").stat().st_size < 300_000


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_each_function_has_a_stub_a_docstring_and_a_check(released, name):
    notebook = nbformat.read(released / name / f"{name}.ipynb", as_version=4)
    solutions = [cell for cell in code_cells(notebook, "solution") if cell.cell_type == "code"]
    checks = [cell for cell in code_cells(notebook, "grade") if cell.cell_type == "code"]
    assert [cell.metadata.nbgrader.grade_id for cell in solutions] == list(solution_sources(name))
    for cell in solutions:
        assert "raise NotImplementedError()" in cell.source and "Returns" in cell.source
    assert all(cell.source.startswith("check(") and cell.metadata.nbgrader.locked for cell in checks)
    assert sum(cell.metadata.nbgrader.points for cell in checks) == POINTS.get(name, 20)


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_a_solution_cell_needs_only_np_fw_and_the_cells_above(name):
    namespace = {}
    exec("import numpy as np\nimport framework as fw", namespace)
    for grade_id, source in solution_sources(name).items():
        exec(source, namespace)
        assert callable(namespace[grade_id])


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_the_notebook_ends_in_the_picture_that_it_promised(name):
    image = run_cells(name)["render"](180, 120)
    goal = (
        fw.read_image(ROOT / "assignments" / name / "goal.png").reshape(120, 4, 180, 4, 3).mean(axis=(1, 3))
    )
    assert np.abs(fw.tone_map(image) - goal).mean() < 0.02, f"run `python -m autograder.goal_pictures {name}`"


def test_a_filled_notebook_holds_the_solutions_the_replacements_and_the_stubs_asked_for():
    wrong = "def blend(d1, d2, t):\n    return d1"
    notebook = filled_notebook("sphere_tracing", {"blend": wrong, "sdf_box": None})
    cells = {cell.id: cell.source for cell in notebook.cells}
    assert cells["blend"] == wrong
    assert "raise NotImplementedError()" in cells["sdf_box"]
    assert cells["sdf_sphere"] == solution_sources("sphere_tracing")["sdf_sphere"]
    assert not any("SOLUTION" in source for source in cells.values())
    nbformat.validate(notebook)


def test_a_notebook_filled_with_nothing_is_the_released_one():
    path = ROOT / "assignments" / "sphere_tracing" / "sphere_tracing.ipynb"
    assert filled_notebook("sphere_tracing", fill=False) == nbformat.read(path, as_version=4)


def test_a_replacement_that_is_not_asked_for_is_refused():
    with pytest.raises(KeyError, match="sdf_cone"):
        filled_notebook("sphere_tracing", {"sdf_cone": "def sdf_cone(): ..."})


def test_an_unknown_assignment_is_refused_by_name():
    with pytest.raises(FileNotFoundError, match="solutions/ray_tracing.py"):
        build_source("ray_tracing")


def test_a_source_for_nbgraders_own_commands_holds_the_solutions(tmp_path):
    path = write_source("sphere_tracing", tmp_path)
    assert path == tmp_path / "sphere_tracing" / "sphere_tracing.ipynb"
    assert "### BEGIN SOLUTION" in path.read_text()
    assert (path.parent / "goal.png").is_file()


def validate(path):
    """What `nbgrader validate` prints about a notebook, run away from the repository."""
    command = [str(Path(sys.executable).with_name("nbgrader")), "validate", str(path)]
    result = subprocess.run(command, cwd=path.parent, capture_output=True, text=True, timeout=100)
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.mark.drill
@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_nbgrader_accepts_a_release(released, name):
    assert "Success! Your notebook passes all the tests." in validate(released / name / f"{name}.ipynb")


@pytest.mark.drill
@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_nbgrader_accepts_a_notebook_with_its_question_answered(tmp_path, name):
    notebook = filled_notebook(name)
    for cell in code_cells(notebook, "grade"):
        if cell.cell_type == "markdown":
            cell.source = "Because the ball is empty."
    nbformat.write(notebook, tmp_path / f"{name}.ipynb")
    assert "Success! Your notebook passes all the tests." in validate(tmp_path / f"{name}.ipynb")
