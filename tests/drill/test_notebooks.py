"""Every notebook, filled with the solutions, runs in a real kernel as on a student's machine."""

import shutil
import subprocess
import sys
from datetime import datetime
from pathlib import Path

import nbformat
import pytest

from autograder.release import ASSIGNMENTS, ROOT
from autograder.samples import filled_notebook

pytestmark = pytest.mark.drill

# Promised are 2 s a cell on two free cores, and 60 s a notebook; a machine that is busy, or compiles a kernel for the
# first time, takes longer. What is bound here is work that nobody would wait for.
SECONDS_A_CELL, SECONDS_A_NOTEBOOK = 20, 180


@pytest.fixture(scope="module", params=ASSIGNMENTS)
def executed(request, tmp_path_factory):
    """An assignment's name and its notebook as `jupyter nbconvert --execute` leaves it, in a folder of its own."""
    name = request.param
    folder = tmp_path_factory.mktemp(name)
    shutil.copytree(ROOT / "assignments" / name, folder, dirs_exist_ok=True)
    nbformat.write(filled_notebook(name), folder / f"{name}.ipynb")
    jupyter = Path(sys.executable).with_name("jupyter")
    command = [jupyter, "nbconvert", "--to", "notebook", "--execute", "--output", "done", f"{name}.ipynb"]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=SECONDS_A_NOTEBOOK)
    assert result.returncode == 0, result.stderr[-2000:]
    return name, nbformat.read(folder / "done.ipynb", as_version=4)


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def seconds(cell):
    """What the kernel took for a cell, by its own clock."""
    begun, done = (cell.metadata.execution[key] for key in ("iopub.execute_input", "shell.execute_reply"))
    return (datetime.fromisoformat(done) - datetime.fromisoformat(begun)).total_seconds()


def shows_something(cell):
    """Whether the cell is there to show something: a check, a picture, a line of text."""
    return any(call in cell.source for call in ("check(", "fw.show.", "plt.show()", "print("))


def kinds(cell):
    return {kind for output in cell.outputs for kind in output.get("data", {output.get("name"): ""})}


def test_every_cell_ran_in_order_without_an_error_or_a_warning(executed):
    _, notebook = executed
    cells = code_cells(notebook)
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    said = [output for cell in cells for output in cell.outputs if output.output_type == "error"]
    stderr = [output.text for cell in cells for output in cell.outputs if output.get("name") == "stderr"]
    # The first picture on a new machine says that it compiles.
    said += [text for text in stderr if text.strip() and "compiling the renderer" not in text]
    assert said == []


def test_every_cell_that_shows_something_left_it_behind(executed):
    _, notebook = executed
    silent = [
        cell.source
        for cell in code_cells(notebook)
        if shows_something(cell) and "def " not in cell.source and not cell.outputs
    ]
    assert silent == []
    for cell in code_cells(notebook):
        if "\nfw.show." in cell.source or "\nplt.show()" in cell.source:
            assert "image/png" in kinds(cell), cell.source


def test_every_public_check_says_right(executed):
    name, notebook = executed
    checks = [cell for cell in code_cells(notebook) if cell.source.startswith("check(")]
    assert len(checks) == {"sphere_tracing": 7, "soft_shadows": 5, "prefilter": 6, "split_sum": 8}.get(name, 3)
    for cell in checks:
        assert "right, on the inputs that you can see" in str(cell.outputs), cell.source


def test_no_cell_makes_the_reader_wait(executed):
    name, notebook = executed
    timed = [cell for cell in code_cells(notebook) if "compiling the renderer" not in str(cell.outputs)]
    slow = {cell.id: seconds(cell) for cell in timed if seconds(cell) > SECONDS_A_CELL}
    assert slow == {}
    longest = max(timed, key=seconds)
    print(f"{name}: {sum(map(seconds, code_cells(notebook))):.1f} s, the longest {longest.id} {seconds(longest):.2f} s")


def test_the_notebook_ends_in_a_mesh_and_one_question(executed):
    name, notebook = executed
    code = code_cells(notebook)
    assert any("fw.rasterize(" in cell.source for cell in code), name
    assert "image/png" in kinds(code[-1])
    asked = [c for c in notebook.cells if c.cell_type == "markdown" and c.metadata.get("nbgrader", {}).get("grade")]
    assert [cell.metadata.nbgrader.points for cell in asked] == [2]
