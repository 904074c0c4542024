"""The `course` command: exit codes, sentences, and what it leaves behind."""

import json
import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from autograder import cli, sandbox
from autograder.samples import filled_notebook

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def submissions(tmp_path):
    for student, wrong in (("amy", {}), ("bob", {"blend": "def blend(d1, d2, t):\n    return d1"})):
        path = tmp_path / "in" / student / "sphere_tracing.ipynb"
        path.parent.mkdir(parents=True)
        nbformat.write(filled_notebook("sphere_tracing", wrong), path)
    (tmp_path / "in" / "essay.ipynb").write_text("no JSON")
    return tmp_path / "in"


def grade(*arguments):
    return cli.main(["grade", *map(str, arguments), "--jobs", "2"])


def files(folder):
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in Path(folder).rglob("*") if p.is_file()}


def test_a_batch_gets_results_pages_an_index_and_marks(submissions, tmp_path, isolation):
    out = tmp_path / "out"
    assert grade(submissions, "--out", out) == (3 if isolation == sandbox.PROCESS else 0)
    assert (out / "grades.csv").read_text().splitlines() == [
        "student,assignment,status,score,max_score",
        "amy,sphere_tracing,graded,20.0,20.0",
        "bob,sphere_tracing,graded,19.0,20.0",
        "essay,unknown,rejected,0.0,0.0",
    ]
    before = files(out)
    kinds = {Path(name).suffix for name in before}
    assert kinds == {".json", ".html", ".png", ".csv"}
    for name in before:
        assert name.split("/")[0] in ("results", "pages", "index.html", "grades.csv")
    result = json.loads(before["results/bob/sphere_tracing.json"])
    assert {"schema", "assignment", "student", "status", "message", "score", "max_score", "isolation", "wall_seconds",
            "peak_memory_mb", "checks"} <= set(result)  # fmt: skip
    assert [check["id"] for check in result["checks"]] == [f"1.{n}" for n in range(1, 8)]
    assert abs(result["score"] - sum(check["score"] for check in result["checks"])) < 1e-9
    for check in result["checks"]:
        for path in check["images"].values():
            assert (out / "results" / "bob" / path).is_file()
    # again: nothing that is finished is touched
    assert grade(submissions, "--out", out) == 0
    assert {n: b for n, b in files(out).items() if n.startswith("results")} == {
        n: b for n, b in before.items() if n.startswith("results")
    }


def test_another_secret_grades_anew(submissions, tmp_path, isolation):
    (tmp_path / "secret").write_text("otters")
    grade(submissions / "amy", "--out", tmp_path / "out", "--allow-weak-isolation")
    first = (tmp_path / "out/results/sphere_tracing/sphere_tracing.json").read_bytes()
    grade(submissions / "amy", "--out", tmp_path / "out", "--secret", tmp_path / "secret", "--allow-weak-isolation")
    second = (tmp_path / "out/results/sphere_tracing/sphere_tracing.json").read_bytes()
    assert first != second and json.loads(second)["score"] == 20


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["grade", "nowhere", "--out", "out"], "nowhere does not exist"),
        (["grade", ".", "--out", "out", "--secret", "missing"], "cannot be read"),
        (["check", "missing.ipynb"], "is not a file"),
        (["release", "no_such"], "there is no assignment 'no_such'"),
    ],
)
def test_wrong_arguments_are_told_in_a_sentence(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(arguments) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("arguments", [[], ["grade"], ["grade", "x"], ["grade", "x", "--out", "y", "--jobs", "0"]])
def test_the_parser_exits_with_2(arguments, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(arguments)
    assert ended.value.code == 2


def test_weak_isolation_is_refused_unless_asked_for(submissions, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sandbox, "strongest_level", lambda: sandbox.PROCESS)
    assert grade(submissions, "--out", tmp_path / "out") == 3
    assert "NOT ISOLATED" in capsys.readouterr().err and not (tmp_path / "out").exists()
    assert grade(submissions / "bob", "--out", tmp_path / "out", "--allow-weak-isolation") == 0
    result = json.loads((tmp_path / "out/results/sphere_tracing/sphere_tracing.json").read_text())
    assert result["isolation"] == "process" and result["score"] == 19


def test_check_prints_a_line_for_each_task_and_writes_a_page(submissions, capsys):
    assert cli.main(["check", str(submissions / "bob" / "sphere_tracing.ipynb")]) == 0
    said = capsys.readouterr().out
    assert said.count("right, on the inputs that you can see") == 6 and "1.4 blend" in said
    assert (submissions / "bob" / "sphere_tracing-check.html").is_file()


def test_the_doctor_finds_what_students_need(capsys):
    assert cli.main(["doctor"]) == 0
    assert "all that a student needs is here" in capsys.readouterr().out


def test_importing_the_framework_loads_little_and_costs_little():
    """At most three times NumPy: the best of five, in turn, for the machine is shared."""
    code = "import sys, time; begun = time.perf_counter(); import {0}; print(time.perf_counter() - begun, *sys.modules)"

    def run(name):
        done = subprocess.run([sys.executable, "-c", code.format(name)], capture_output=True, text=True, cwd=ROOT)
        seconds, *modules = done.stdout.split()
        return float(seconds), set(modules)

    runs = [(run("numpy"), run("framework")) for _ in range(5)]
    assert min(b[0] for _, b in runs) <= 3 * min(a[0] for a, _ in runs)
    assert not {"numba", "matplotlib", "OpenEXR", "solutions", "autograder"} & runs[0][1][1]


def test_no_process_remains_after_grading(submissions, tmp_path, isolation):
    if isolation == sandbox.PROCESS:
        pytest.skip("this machine starts no sandbox")
    grade(submissions, "--out", tmp_path / "out")
    running = [Path(f"/proc/{pid}/cmdline") for pid in os.listdir("/proc") if pid.isdigit()]
    commands = []
    for path in running:
        try:
            commands.append(path.read_bytes())
        except OSError:
            continue
    assert not [c for c in commands if b"bwrap" in c and str(os.getpid()).encode() in c]
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    names = [Path(f"/proc/{pid}/cmdline").read_bytes() for pid in children]
    assert not [name for name in names if b"bwrap" in name or b"zygote" in name]
