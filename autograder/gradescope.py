"""The autograder as Gradescope runs it: a zip to upload, and the program in it that grades one submission."""

from __future__ import annotations

import json
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

from autograder import cli, export, report
from autograder import report_view as view

ROOT = Path(__file__).resolve().parents[1]
SCRIPTS = Path(__file__).parent / "templates" / "gradescope"
FILES = ("pyproject.toml", "requirements.lock", "README.md", "LICENSE")


def package(path) -> Path:
    """Write the zip: `setup.sh`, `run_autograder`, and the course with its solutions; the same bytes every time."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    folders = sorted({name.split(".")[0] for name in project["tool"]["setuptools"]["packages"]} | {"assignments"})
    files = [ROOT / name for name in FILES]
    for folder in folders:
        files += sorted(p for p in (ROOT / folder).rglob("*") if p.is_file() and "__pycache__" not in p.parts)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for script in ("setup.sh", "run_autograder"):
            add(archive, script, (SCRIPTS / script).read_bytes(), 0o755)
        for file in files:
            add(archive, file.relative_to(ROOT).as_posix(), file.read_bytes())
    return Path(path)


def add(archive, name, data, mode=0o644):
    """Put a file into a zip, without a time: the same bytes every time."""
    entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
    entry.compress_type, entry.create_system, entry.external_attr = zipfile.ZIP_DEFLATED, 3, (0o100000 | mode) << 16
    archive.writestr(entry, data)


def main(arguments=None) -> int:
    """`python -m autograder.gradescope SUBMISSION RESULTS.json`: grade a folder with one notebook in it."""
    submission, results = map(Path, sys.argv[1:] if arguments is None else arguments)
    with tempfile.TemporaryDirectory(prefix="course-") as folder:
        graded = Path(folder)
        # The container holds one submission and is thrown away; where it starts no sandbox, the result says so.
        code = cli.main(["grade", str(submission), "--out", folder, "--jobs", "1", "--allow-weak-isolation"])
        if code:
            return code
        found = [export.gradescope(result, path.parent, graded / "pages")
                 for path, result, _ in view.results(graded) if result is not None]  # fmt: skip
    shown = found[0] if len(found) == 1 else _refusal(len(found))
    report.write_whole(results, [json.dumps(shown, indent=1) + "\n"])
    return 0


def _refusal(count):
    return {"score": 0.0, "output": f"{count} notebooks were handed in; exactly one is wanted.", "visibility": "visible"}


if __name__ == "__main__":
    sys.exit(main())
