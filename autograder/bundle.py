"""The zip that an instructor hands out: what a student's machine needs, and no solution, secret or hidden input."""

from __future__ import annotations

import ast
import json
import tomllib
import zipfile
from pathlib import Path

from autograder import gradescope

ROOT = Path(__file__).resolve().parents[1]
ENTRIES = ("autograder.cli_student", "autograder.notebook")
# beside the modules: what they read, and what a student reads
DATA = ("framework/data/**/*", "autograder/checks/**/*", "autograder/references/tolerances.json",
        "autograder/templates/*", "assignments/*/*", "docs/student.md", "LICENSE")  # fmt: skip
RENAMED = {"README.md": "autograder/templates/bundle/README.md", "requirements.txt": "requirements-student.txt"}


def write(path) -> list[str]:
    """Write the zip; the same bytes every time.

    Parameters
    ----------
    path : path     of the zip

    Returns
    -------
    list of str     the names of the files in it
    """
    files = {file.relative_to(ROOT).as_posix(): file.read_bytes() for file in _files()}
    files |= {name: (ROOT / source).read_bytes() for name, source in RENAMED.items()}
    files["pyproject.toml"] = _project().encode()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            gradescope.add(archive, name, files[name])
    return sorted(files)


def modules() -> list[Path]:
    """The modules of the autograder that a student's commands and check cells import, early or late."""
    found, waiting = set(), [*ENTRIES, "autograder"]
    while waiting:
        path = ROOT / f"{waiting.pop().replace('.', '/')}.py"
        path = path if path.is_file() else path.with_suffix("") / "__init__.py"
        if path in found or not path.is_file():
            continue
        found.add(path)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "autograder":
                waiting += [str(node.module), *(f"{node.module}.{name.name}" for name in node.names)]
    return sorted(found)


def _files():
    globbed = [file for pattern in ("framework/*.py", *DATA) for file in ROOT.glob(pattern)]
    return {file for file in (*globbed, *modules()) if file.is_file() and "__pycache__" not in file.parts}


def _project():
    """The student's pyproject.toml: the course's own, less all that only instructors need."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    whole, tools = project["project"], project["tool"]["setuptools"]
    kept = {key: whole[key] for key in ("name", "version", "description", "requires-python", "license")}
    kept["dependencies"] = whole["dependencies"] + whole["optional-dependencies"]["student"]
    data = {name: [p for p in tools["package-data"][name] if "gradescope" not in p] for name in ("framework", "autograder")}
    # the notebooks are installed too, so that `course start` finds them
    tables = {
        "build-system": project["build-system"],
        "project": kept,
        "project.scripts": {"course": "autograder.cli_student:main"},
        "tool.setuptools": {"packages": ["framework", "autograder", "autograder.checks", "assignments"]},
        "tool.setuptools.package-data": data | {"assignments": ["*/*"]},
    }
    lines = []
    for table, values in tables.items():
        # a JSON string or list of strings is TOML too
        lines += [f"[{table}]", *(f"{key} = {json.dumps(value)}" for key, value in values.items()), ""]
    return "\n".join(lines)
