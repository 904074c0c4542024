"""A batch of strangers' notebooks that do what they can: nothing leaves its place, and honest neighbours keep their marks."""

import csv
import json
import os
import socket
import threading
from pathlib import Path

import nbformat
import pytest

from autograder import checks, cli, sandbox
from autograder.samples import filled_notebook, solution_sources
from tests.drill import hostile_cells, hostile_files

pytestmark = pytest.mark.drill
ROOT = Path(__file__).parents[2]
LIMITS = ["--call-cpu-seconds", "2", "--call-wall-seconds", "4", "--memory-mb", "1024"]
ORDER = [task.name for task in checks.assignment("sphere_tracing").tasks]
SECRET_WORD = "canary-3f9b1c"
strong = pytest.mark.skipif(sandbox.strongest_level() == sandbox.PROCESS, reason="this machine starts no sandbox")


class Outside:
    """What hostile code would like to reach: a secret file, a folder to write to, a port that listens."""

    def __init__(self, folder):
        self.folder = folder / "outside"
        self.folder.mkdir()
        self.canary = self.folder / "canary"
        self.canary.write_text(SECRET_WORD)
        self.calls = []
        self._sockets = [socket.create_server(("127.0.0.1", 0))]
        self.port = self._sockets[0].getsockname()[1]
        self._sockets.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self._sockets[1].bind(("127.0.0.1", self.port))
        for listening, wait in ((self._sockets[0], lambda s: s.accept()), (self._sockets[1], lambda s: s.recv(99))):
            threading.Thread(target=self._listen, args=(listening, wait), daemon=True).start()

    def _listen(self, listening, wait):
        while True:
            try:
                wait(listening)
            except OSError:
                return
            self.calls.append(listening.type)

    def close(self):
        for listening in self._sockets:
            listening.close()


@pytest.fixture
def outside(tmp_path):
    found = Outside(tmp_path)
    yield found
    found.close()


def cell(code, outside):
    names = {"CANARY": str(outside.canary), "OUTSIDE": str(outside.folder), "PORT": outside.port}
    set_up = "\n".join(f"{name} = {value!r}" for name, value in names.items())
    body = "\n".join("    " + line for line in f"{set_up}\n{code}".splitlines())
    return f"def sdf_sphere(p, center, radius):\n{body}\n    return np.zeros(np.shape(p)[:-1])"


def hand_in(folder, student, notebook):
    path = folder / student / "sphere_tracing.ipynb"
    path.parent.mkdir(parents=True)
    nbformat.write(notebook, path)


def files_below(folder):
    """Path -> size and time of everything below, but for what Python and the tests themselves write."""
    left_out = {".git", ".venv", "__pycache__", ".hypothesis", ".mypy_cache", ".ruff_cache", "out", "build"}
    found = {}
    for here, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if name not in left_out and not name.endswith(".egg-info")]
        for name in names:
            status = os.lstat(os.path.join(here, name))
            found[os.path.join(here, name)] = status.st_size, status.st_mtime_ns
    return found


def grader_processes():
    """Sandboxes of this repository that run, by what bubblewrap is told to show them."""
    found = set()
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            command = _command(entry.name)
            if b"bwrap" in command and str(ROOT / "framework").encode() in command and not _of_others(int(entry.name)):
                found.add(int(entry.name))
    return found


def _of_others(pid):
    """Whether a process descends from another test's, which runs beside this one; an orphan may well be ours."""
    line = [pid]
    while line[-1] > 1 and line[-1] != os.getpid():
        try:
            line.append(int(Path(f"/proc/{line[-1]}/stat").read_text().rpartition(")")[2].split()[1]))
        except OSError:
            return True  # it has ended
    sandboxes = [b"bwrap" in _command(one) for one in line[:-1]]
    return line[-1] != os.getpid() and not all(sandboxes)


def _command(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""


def grade(folder, out, *more):
    return cli.main(["grade", str(folder), "--out", str(out), "--jobs", "2", "--allow-weak-isolation", *LIMITS, *more])


def results(out):
    return {path.parent.name: json.loads(path.read_text()) for path in sorted(out.glob("results/*/sphere_tracing.json"))}


@strong
def test_hostile_cells_reach_nothing(outside, tmp_path):
    folder, out = tmp_path / "in", tmp_path / "out"
    names = {f"c{i:03d}": name for i, name in enumerate(hostile_cells.CELLS)}
    assert len(names) >= 60
    for student, name in names.items():
        code, _ = hostile_cells.CELLS[name]
        hand_in(folder, student, filled_notebook("sphere_tracing", hostile_files.FEW | {"sdf_sphere": cell(code, outside)}))
    for student in ("a-honest", "c030-honest", "z-honest"):
        hand_in(folder, student, hostile_files.honest())
    before, running = files_below(ROOT) | files_below(outside.folder), grader_processes()

    assert grade(folder, out) == 0

    assert files_below(ROOT) | files_below(outside.folder) == before
    assert not outside.calls
    assert grader_processes() <= running
    found = results(out)
    odd = {}
    for student, name in names.items():
        checks = {check["name"]: check for check in found[student]["checks"]}
        if checks["sdf_sphere"]["status"] not in hostile_cells.CELLS[name][1] or checks["sdf_sphere"]["score"] > 0.6:
            odd[name] = checks["sdf_sphere"]["status"], checks["sdf_sphere"]["score"], checks["sdf_sphere"]["message"]
        if checks["blend"]["score"] != 1:
            odd[name + ": its neighbour task"] = checks["blend"]["message"]
    assert not odd
    kept = {path: path.read_text() for path in out.rglob("*") if path.suffix in (".json", ".html", ".csv")}
    assert not [path for path, text in kept.items() if SECRET_WORD in text or "FOUND" in text]
    assert not [path for path, text in kept.items() if path.suffix == ".html" and "<script>document" in text]
    honest = [found[student]["checks"] for student in ("a-honest", "c030-honest", "z-honest")]
    assert all([c["score"] for c in checks] == [2, 0, 0, 1, 0, 0, 0] for checks in honest)
    assert {path.suffix for path in out.rglob("*") if path.is_file()} == {".json", ".html", ".csv", ".png"}


@strong
def test_hostile_files_each_get_a_sentence_and_the_batch_goes_on(outside, tmp_path, capsys):
    folder, out = tmp_path / "in", tmp_path / "out"
    assert len(hostile_files.FILES) + len(hostile_files.ODD_NAMES) >= 25
    students = {}
    for i, (name, (lay, status)) in enumerate(hostile_files.FILES.items()):
        place = folder / f"f{i:03d}"
        place.mkdir(parents=True)
        lay(place)
        students[place.name] = name, status
    for name in hostile_files.ODD_NAMES:
        hand_in(folder, name, hostile_files.honest())
    before = files_below(ROOT) | files_below(outside.folder) | files_below(folder)

    assert grade(folder, out) == 0

    assert files_below(ROOT) | files_below(outside.folder) | files_below(folder) == before
    assert not Path("/tmp/owned").exists()
    said = capsys.readouterr().err
    by_student = {}
    for path in out.glob("results/*/*.json"):
        result = json.loads(path.read_text())
        by_student[result["student"]] = result
        assert path.resolve().is_relative_to(out.resolve())
    for student, (name, status) in students.items():
        if status is None:
            assert student not in by_student, name
            told = any(f"{student}/" in line and "left alone" in line for line in said.splitlines())
            assert told or (folder / student / hostile_files.NAME).is_dir(), name  # a folder is a folder
            continue
        result = by_student[student]
        assert result["status"] == status, (name, result["message"])
        assert status == "graded" or (result["message"] and "\n" not in result["message"]), name
        if status == "graded":
            assert result["score"] <= result["max_score"] == 20 and result["score"] >= 2, name
    for name in hostile_files.ODD_NAMES:
        shown = name.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
        assert by_student[shown]["score"] == 3, name
    with open(out / "grades.csv", newline="", encoding="utf-8") as file:
        cells = [cell for row in csv.reader(file) for cell in row]
    assert not any(cell.startswith(("=", "+", "-", "@")) for cell in cells)


@strong
def test_tasks_and_cells_that_take_all_the_time_they_can_cost_their_own_points_alone(tmp_path):
    """With the limits as they are by default, and sleep, which no limit on CPU time ends."""
    sources = {name: f"def {name}(*a):\n    import time\n    time.sleep(999)" for name in ORDER[:5]}
    hand_in(tmp_path / "in", "tasks", filled_notebook("sphere_tracing", sources))
    right = solution_sources("sphere_tracing")
    cells = {name: f"{right[name]}\nimport time; time.sleep(999)" for name in ORDER[:5]}
    hand_in(tmp_path / "in", "cells", filled_notebook("sphere_tracing", cells))
    assert cli.main(["grade", str(tmp_path / "in"), "--out", str(tmp_path / "out"), "--jobs", "2"]) == 0
    found = {student: [c["status"] for c in result["checks"]] for student, result in results(tmp_path / "out").items()}
    assert found == {"tasks": ["timeout"] * 5 + ["pass"] * 2, "cells": ["pass"] * 7}


def test_weak_isolation_is_told_and_shown_to_be_weak(outside, tmp_path, monkeypatch, capsys):
    """What a plain process does not stop is listed, so that nobody relies on it; the results say how they were made."""
    monkeypatch.setattr(sandbox, "strongest_level", lambda: sandbox.PROCESS)
    folder, out = tmp_path / "in", tmp_path / "out"
    names = {f"c{i:03d}": name for i, name in enumerate(hostile_cells.HARMLESS_WHEN_WEAK)}
    for student, name in names.items():
        code, _ = hostile_cells.CELLS[name]
        hand_in(folder, student, filled_notebook("sphere_tracing", hostile_files.FEW | {"sdf_sphere": cell(code, outside)}))
    assert grade(folder, out) == 0
    found = results(out)
    assert all(result["isolation"] == "process" for result in found.values())
    assert "NOT ISOLATED" in capsys.readouterr().err
    escaped = set()
    for student, name in names.items():
        check = found[student]["checks"][0]
        if check["status"] not in hostile_cells.CELLS[name][1] or SECRET_WORD in check["prints"]:
            escaped.add(name)
    with capsys.disabled():
        print(f"\nnot contained by a plain process: {', '.join(sorted(escaped))}")
    assert {"reads the canary", "writes outside", "connects"} <= escaped
    assert not {"never ends", "dies", "imports the solutions"} & escaped
    assert (outside.folder / "mark").exists() and outside.calls


def test_two_workers_give_the_grades_of_one(tmp_path):
    for i in range(5):
        wrong = {"blend": f"def blend(d1, d2, t):\n    return d1 + {i} * (d2 - d1) * t"}
        hand_in(tmp_path / "in", f"s{i}", filled_notebook("sphere_tracing", hostile_files.FEW | wrong))
    for jobs in ("1", "3"):
        assert grade(tmp_path / "in", tmp_path / jobs, "--jobs", jobs) == 0
    assert (tmp_path / "1" / "grades.csv").read_bytes() == (tmp_path / "3" / "grades.csv").read_bytes()
