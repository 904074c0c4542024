"""Builds what students get: `assignments/NAME/NAME.ipynb` from `solutions/NAME.py`, by nbgrader's generator.

The same sources give the same bytes: cell ids come from grade ids and positions, and nothing says when.

A source is a percent script. Its cells say in `nbgrader={...}` only what differs from cell to cell:
`"grade_id": NAME, "solution": true` for a function, `"grade_id": ID, "points": P` for a check, and all three
for a question that a person marks.
"""

import logging
import shutil
import tempfile
from pathlib import Path

import framework
from autograder.checks import ASSIGNMENTS

ROOT = Path(__file__).resolve().parents[1]


def release(assignments=None, into="assignments"):
    """Build the notebooks that students get, one folder each, with the files that belong beside them.

    Parameters
    ----------
    assignments : sequence of str, optional   names of modules in `solutions`; all that are ready by default
    into : path                               folder of the results; a relative one lies in the repository

    Returns
    -------
    list of Path                              the notebooks written, in the order asked for

    Raises
    ------
    FileNotFoundError                         where an assignment has no source or no goal picture
    """
    written = []
    for name in ASSIGNMENTS if assignments is None else assignments:
        target = ROOT / into / name
        with tempfile.TemporaryDirectory() as course:
            write_source(name, Path(course) / "source")
            _generate(name, Path(course))
            _open_questions(Path(course) / "release" / name / f"{name}.ipynb")
            shutil.rmtree(target, ignore_errors=True)
            shutil.copytree(Path(course) / "release" / name, target)
        notebook = target / f"{name}.ipynb"
        size = sum(path.stat().st_size for path in target.iterdir())
        print(f"{name}: {len(list(target.iterdir()))} files, {size / 1024:.0f} KiB")
        written.append(notebook)
    return written


def write_source(name, into="source"):
    """Write an assignment with its solutions where nbgrader looks for sources: `into/NAME/NAME.ipynb`.

    Parameters
    ----------
    name : str      a module of `solutions`
    into : path     nbgrader's source folder; a relative one lies in the repository, where git ignores it

    Returns
    -------
    Path            the notebook; the files that belong beside it are there too
    """
    import nbformat

    notebook = build_source(name)
    folder = ROOT / into / name
    folder.mkdir(parents=True, exist_ok=True)
    for file_name, path in _files_beside(name).items():
        shutil.copyfile(path, folder / file_name)
    nbformat.write(notebook, folder / f"{name}.ipynb")
    return folder / f"{name}.ipynb"


def build_source(name):
    """The notebook of an assignment as `solutions/NAME.py` has it, solutions included.

    Parameters
    ----------
    name : str                  a module of `solutions`

    Returns
    -------
    nbformat.NotebookNode       with stable cell ids, the course's metadata, no outputs

    Raises
    ------
    FileNotFoundError           where there is no such module
    """
    import jupytext

    path = ROOT / "solutions" / f"{name}.py"
    if not path.is_file():
        raise FileNotFoundError(f"release: there is no solutions/{name}.py to build {name!r} from")
    notebook = jupytext.read(path, fmt="py:percent")
    notebook.nbformat, notebook.nbformat_minor = 4, 5
    notebook.metadata = {
        "course": {"assignment": name, "version": framework.__version__},
        "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for position, cell in enumerate(notebook.cells):
        role = cell.metadata.get("nbgrader")
        # The tags told jupytext what the module leaves out, and say nothing to students.
        cell.metadata = {"nbgrader": _complete(role)} if role else {}
        cell.id = role["grade_id"] if role else f"cell-{position:03d}"
    return notebook


def _complete(role):
    """nbgrader's metadata of a cell with all the fields that its schema wants."""
    grade, solution = "points" in role, role.get("solution", False)
    locked = grade and not solution
    return {
        "schema_version": 3,
        "task": False,
        "grade": grade,
        "solution": solution,
        "locked": locked,
        **role,
    }


def _files_beside(name):
    """The files that belong beside a notebook: the goal picture, and what `solutions/data/NAME` holds."""
    picture = ROOT / "solutions" / "pictures" / f"{name}.png"
    if not picture.is_file():
        raise FileNotFoundError(
            f"release: {name} has no goal picture; `python -m autograder.goal_pictures {name}` draws it"
        )
    data = sorted((ROOT / "solutions" / "data" / name).glob("*"))
    return {"goal.png": picture} | {path.name: path for path in data}


def _open_questions(path):
    """Let `nbgrader validate` accept a question that is not answered yet: a person marks it, whatever it says."""
    import nbformat

    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        role = cell.metadata.get("nbgrader", {})
        if role.get("grade") and role.get("solution"):
            role.pop("checksum", None)
    nbformat.write(notebook, path)


def _generate(name, course):
    """Run nbgrader's generate_assignment, without a database, from `course/source` to `course/release`."""
    from nbgrader.converters import GenerateAssignment
    from nbgrader.coursedir import CourseDirectory
    from traitlets.config import Config

    config = Config()
    config.CourseDirectory.root = str(course)
    config.CourseDirectory.assignment_id = name
    config.GenerateAssignment.no_database = True
    config.SaveCells.enabled = False
    quiet = logging.getLogger("autograder.release.nbgrader")
    quiet.setLevel(logging.ERROR)
    GenerateAssignment(coursedir=CourseDirectory(config=config), config=config, log=quiet).start()
