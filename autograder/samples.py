"""Submissions made to measure: the released notebook with the reference's solutions, or others, filled in."""

import ast

import nbformat

from autograder.release import ROOT, build_source


def filled_notebook(name, replacements=None, fill=True):
    """A submission to an assignment, as a student would hand it in: not executed, without outputs.

    Parameters
    ----------
    name : str              an assignment that is released
    replacements : dict     function name -> source instead of the reference's; None: the cell as released
    fill : bool             whether functions that are not named get the reference's source

    Returns
    -------
    nbformat.NotebookNode   the released notebook with other sources in its solution cells

    Raises
    ------
    KeyError                where a replacement names a function that the assignment does not ask for

    Examples
    --------
    >>> wrong = "def blend(d1, d2, t):\\n    return d1"
    >>> notebook = filled_notebook("sphere_tracing", {"blend": wrong, "sdf_box": None})
    >>> nbformat.write(notebook, "submitted/amy/sphere_tracing/sphere_tracing.ipynb")  # doctest: +SKIP
    """
    replacements = dict(replacements or {})
    sources = solution_sources(name)
    notebook = nbformat.read(ROOT / "assignments" / name / f"{name}.ipynb", as_version=4)
    for cell in notebook.cells:
        grade_id = cell.metadata.get("nbgrader", {}).get("grade_id")
        if grade_id not in sources:
            continue
        functions = _functions(sources[grade_id])
        wanted = {function: replacements.pop(function) for function in functions if function in replacements}
        if None in wanted.values() or not (fill or wanted):
            continue
        cell.source = _replaced(sources[grade_id], wanted)
    if replacements:
        raise KeyError(f"filled_notebook: {name} does not ask for {', '.join(sorted(replacements))}")
    return notebook


def solution_sources(name):
    """The reference's solution cells, without the marks between which nbgrader cuts.

    Parameters
    ----------
    name : str          a module of `solutions`

    Returns
    -------
    dict of str         grade_id -> source, of the code cells
    """
    return {
        cell.metadata.nbgrader.grade_id: "\n".join(
            line for line in cell.source.split("\n") if line.strip() not in _MARKS
        )
        for cell in build_source(name).cells
        if cell.cell_type == "code" and cell.metadata.get("nbgrader", {}).get("solution")
    }


_MARKS = ("### BEGIN SOLUTION", "### END SOLUTION")


def _functions(source):
    return {node.name: node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}


def _replaced(source, wanted):
    """The source with the definitions of the wanted functions replaced, from the last to the first."""
    lines = source.split("\n")
    for name, node in reversed(_functions(source).items()):
        if name in wanted:
            lines[node.lineno - 1 : node.end_lineno] = wanted[name].strip("\n").split("\n")
    return "\n".join(lines)
