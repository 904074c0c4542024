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


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_a_filled_notebook_runs_in_order_shows_all_it_has_and_ends_in_a_mesh_and_one_question(name, tmp_path):
    # One test a notebook, so that each is executed once, however many processes share the tests.
    notebook = executed(name, tmp_path)
    every_cell_ran_in_order_without_an_error_or_a_warning(notebook)
    every_cell_that_shows_something_left_it_behind(notebook)
    every_public_check_says_right(name, notebook)
    no_cell_makes_the_reader_wait(name, notebook)
    the_notebook_ends_in_a_mesh_and_one_question(notebook)


def executed(name, folder):
    """An assignment's notebook as `jupyter nbconvert --execute` leaves it in a folder of its own."""
    shutil.copytree(ROOT / "assignments" / name, folder, dirs_exist_ok=True)
    nbformat.write(filled_notebook(name), folder / f"{name}.ipynb")
    jupyter = Path(sys.executable).with_name("jupyter")
    command = [jupyter, "nbconvert", "--to", "notebook", "--execute", "--output", "done", f"{name}.ipynb"]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=SECONDS_A_NOTEBOOK)
    assert result.returncode == 0, result.stderr[-2000:]
    return nbformat.read(folder / "done.ipynb", as_version=4)


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


def every_cell_ran_in_order_without_an_error_or_a_warning(notebook):
    cells = code_cells(notebook)
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    said = [output for cell in cells for output in cell.outputs if output.output_type == "error"]
    stderr = [output.text for cell in cells for output in cell.outputs if output.get("name") == "stderr"]
    # The first picture on a new machine says that it compiles.
    said += [text for text in stderr if text.strip() and "compiling the renderer" not in text]
    assert said == []


def every_cell_that_shows_something_left_it_behind(notebook):
    silent = [
        cell.source
        for cell in code_cells(notebook)
        if shows_something(cell) and "def " not in cell.source and not cell.outputs
    ]
    assert silent == []
    for cell in code_cells(notebook):
        if "\nfw.show." in cell.source or "\nplt.show()" in cell.source:
            assert "image/png" in kinds(cell), cell.source


def every_public_check_says_right(name, notebook):
    checks = [cell for cell in code_cells(notebook) if cell.source.startswith("check(")]
    assert len(checks) == {"sphere_tracing": 7, "soft_shadows": 5, "prefilter": 6, "split_sum": 8}.get(name, 3)
    for cell in checks:
        assert "right, on the inputs that you can see" in str(cell.outputs), cell.source


def no_cell_makes_the_reader_wait(name, notebook):
    timed = [cell for cell in code_cells(notebook) if "compiling the renderer" not in str(cell.outputs)]
    slow = {cell.id: seconds(cell) for cell in timed if seconds(cell) > SECONDS_A_CELL}
    assert slow == {}
    longest = max(timed, key=seconds)
    print(f"{name}: {sum(map(seconds, code_cells(notebook))):.1f} s, the longest {longest.id} {seconds(longest):.2f} s")


def the_notebook_ends_in_a_mesh_and_one_question(notebook):
    code = code_cells(notebook)
    assert any("fw.rasterize(" in cell.source for cell in code)
    # After the picture comes at most one cell, which counts what it cost.
    assert any("image/png" in kinds(cell) for cell in code[-2:])
    asked = [c for c in notebook.cells if c.cell_type == "markdown" and c.metadata.get("nbgrader", {}).get("grade")]
    assert [cell.metadata.nbgrader.points for cell in asked] == [2]
