"""Builds the walkthroughs: each percent script beside this file becomes a notebook, executed, with its pictures.

A cell that prints to stderr, a warning say, stops the build, as an error does. What changes from run to run for no
reason is left out: times of execution, versions, and sliders, which need a kernel anyway.
"""

import argparse
import os
import sys
import time
from pathlib import Path

import jupytext
import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from tqdm import tqdm

HERE = Path(__file__).resolve().parent
KERNEL = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}
LARGEST = 1_500_000  # bytes of a notebook: viewers in browsers give up on large ones
SECONDS_A_CELL = 120
WIDGET = "application/vnd.jupyter.widget-view+json"


class Broken(Exception):
    """A walkthrough that cannot be built: which one, and why."""


def sources():
    """The scripts, in the order of reading: a list of Path."""
    return sorted(HERE.glob("[0-9][0-9]_*.py"))


def read(source):
    """A script as a notebook without outputs; its cells are named by their place."""
    notebook = jupytext.read(source, fmt="py:percent")
    notebook.nbformat, notebook.nbformat_minor = 4, 5
    notebook.metadata = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
    for place, cell in enumerate(notebook.cells):
        cell.id, cell.metadata = f"cell-{place:03d}", {}
    return notebook


def execute(notebook, name, folder=HERE):
    """Run all cells in order, in a kernel of its own, and keep what they show.

    Parameters
    ----------
    notebook : NotebookNode     changed in place
    name : str                  for messages and the progress line
    folder : path               where the kernel runs

    Raises
    ------
    Broken                      a cell raised an exception, or printed to stderr
    """
    with tqdm(total=len(notebook.cells), desc=name, unit="cell", leave=False, disable=None) as bar:
        client = NotebookClient(
            notebook, timeout=SECONDS_A_CELL, kernel_name="python3", record_timing=False, store_widget_state=False,
            coalesce_streams=True,
            extra_arguments=["--IPKernelApp.log_level=ERROR"],
            resources={"metadata": {"path": str(folder)}}, on_cell_complete=lambda **_: bar.update(),
        )  # fmt: skip
        try:
            client.execute()
        except CellExecutionError as error:
            raise Broken(f"{name}: {error}") from None
    notebook.metadata = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
    for cell in notebook.cells:
        cell.metadata = {}
        said = "".join(output.text for output in cell.get("outputs", []) if output.get("name") == "stderr")
        if said:
            raise Broken(f"{name}: this cell complains:\n{cell.source}\n\n{said}")
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if WIDGET not in output.get("data", {})]


def build(source):
    """Write the notebook of one script beside it, whole or not at all; returns its path."""
    notebook, target = read(source), source.with_suffix(".ipynb")
    execute(notebook, source.stem)
    text = nbformat.writes(notebook) + "\n"
    if len(text) > LARGEST:
        raise Broken(f"{source.stem}: {len(text) / 1e6:.1f} MB; at most {LARGEST / 1e6} MB are wanted: smaller pictures")
    temporary = target.with_name(f".{target.name}")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, target)
    return target


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Build the walkthroughs from their scripts, and execute them.")
    parser.add_argument("numbers", nargs="*", metavar="NN", help="walkthroughs by number, 03; by default all")
    wanted = parser.parse_args(arguments).numbers
    chosen = [source for source in sources() if not wanted or source.stem[:2] in wanted]
    unknown = set(wanted) - {source.stem[:2] for source in chosen}
    if unknown:
        there = ", ".join(source.stem for source in sources())
        print(f"there is no walkthrough {sorted(unknown)[0]!r}; there are {there}", file=sys.stderr)
        return 2
    from framework import compiled

    if not compiled.is_complete():
        compiled.prepare()
    for source in chosen:
        begun = time.perf_counter()
        try:
            target = build(source)
        except Broken as broken:
            print(broken, file=sys.stderr)
            return 1
        print(f"{target.name}: {time.perf_counter() - begun:.0f} s, {target.stat().st_size / 1024:.0f} KiB", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
