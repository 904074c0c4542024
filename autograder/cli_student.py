"""`course start` and `course check`: all that a student's machine needs of the command."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from autograder.usage import Usage, compile_first, parser_of, run

DESCRIPTION = """\
The environment mapping course.

  course start sphere_tracing                 a folder with the notebook, to work in
  course check sphere_tracing.ipynb           its checks, in the terminal and as a page"""


def main(arguments=None) -> int:
    """Run one command, where only the student's half of the course is installed; returns the exit code."""
    parser, commands = parser_of(DESCRIPTION)
    add_commands(commands)
    return run(parser, arguments)


def add_commands(commands):
    """Add the two commands to the parser's."""
    start = commands.add_parser(
        "start", help="set up a folder to work on an assignment in",
        description="Make a folder with the assignment's notebook and the files beside it. What is there is never replaced.",
    )  # fmt: skip
    start.add_argument("assignment", metavar="ASSIGNMENT", help="such as sphere_tracing")
    start.add_argument("--into", metavar="DIR", type=Path, help="an empty or a new folder (default: ./ASSIGNMENT)")
    start.set_defaults(run=_start)

    check = commands.add_parser("check", help="run a notebook's public checks, in the terminal and as a page")
    check.add_argument("notebook", type=Path)
    check.set_defaults(run=_check)


def _start(options):
    from autograder import submission

    name = options.assignment
    if name not in submission.known_assignments():
        raise Usage(f"there is no assignment {name!r}; there are {', '.join(submission.known_assignments())}")
    folder = options.into or Path(name)
    notebook = folder / f"{name}.ipynb"
    if notebook.exists():
        raise Usage(f"{notebook} is there already and stays as it is; --into DIR names another folder")
    if folder.exists() and not folder.is_dir():
        raise Usage(f"{folder} is a file; an empty or a new folder is wanted")
    if folder.is_dir() and any(folder.iterdir()):
        raise Usage(f"{folder} is not empty; --into DIR names another folder")
    try:
        shutil.copytree(submission.release_path(name).parent, folder, dirs_exist_ok=True)
    except OSError as error:
        raise Usage(f"{folder} cannot be made: {error.strerror or error}") from None
    print(f"{folder}: {', '.join(sorted(path.name for path in folder.iterdir()))}")
    print(f"next: jupyter lab {notebook}")
    return 0


def _check(options):
    import tempfile

    from autograder import notebook, store, submission

    if not options.notebook.is_file():
        raise Usage(f"{options.notebook} is not a file")
    compile_first()
    try:
        result, judgements = notebook.check_file(options.notebook)
    except submission.Rejected as rejected:
        raise Usage(f"{options.notebook}: {rejected}") from None
    for record in result["checks"]:
        sign, _, words = notebook.WORDS[record["status"]]
        said = "" if record["status"] in ("pass", "not_attempted") else f": {record['message']}"
        print(f"{sign} {record['id']} {record['name']}: {words}{said}")
        if record["symptom"]:
            print(f"    it looks like a known mistake: {record['symptom']}")
    page = options.notebook.with_name(f"{options.notebook.stem}-check.html")
    with tempfile.TemporaryDirectory() as folder:
        store.write(result, store.draw(result, judgements), Path(folder), "you")
        shutil.copyfile(Path(folder) / "pages" / "you" / f"{result['assignment']}.html", page)
    print(f"open {page}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
