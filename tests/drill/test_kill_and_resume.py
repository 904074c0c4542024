"""A batch that is killed at random moments and run again: the marks of an undisturbed one, to the byte."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import nbformat
import pytest

from autograder.samples import filled_notebook
from tests.drill.hostile_files import FEW

pytestmark = pytest.mark.drill
COUNT, KILLS = 40, 10


@pytest.fixture(scope="module")
def submissions(tmp_path_factory):
    folder = tmp_path_factory.mktemp("submissions")
    for i in range(COUNT):
        wrong = {"blend": f"def blend(d1, d2, t):\n    return d1 + {i % 3} * (d2 - d1) * t"}
        path = folder / f"s{i:02d}" / "sphere_tracing.ipynb"
        path.parent.mkdir()
        nbformat.write(filled_notebook("sphere_tracing", FEW | wrong), path)
    (folder / "s03" / "sphere_tracing.ipynb").write_text("{")
    return folder


def start(submissions, out):
    command = [sys.executable, "-m", "autograder.cli", "grade", str(submissions), "--out", str(out), "--jobs", "2",
               "--allow-weak-isolation"]  # fmt: skip
    # A shell lets what it runs in the background ignore Ctrl-C, and that is inherited.
    heed = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                            start_new_session=True, preexec_fn=heed)  # fmt: skip


def finished(out):
    return {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in out.glob("results/*/*.json")}


def left_by(run, patience=10):
    """Processes of a batch that do not end by themselves."""
    deadline = time.monotonic() + patience
    while (found := _in_session(run.pid)) and time.monotonic() < deadline:
        time.sleep(0.05)
    return found


def _in_session(session):
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if int(fields[3]) == session and fields[0] != "Z":
                found.append(int(entry.name))
    return found


@pytest.fixture(scope="module")
def undisturbed(submissions, tmp_path_factory):
    out = tmp_path_factory.mktemp("undisturbed")
    begun = time.monotonic()
    assert start(submissions, out).wait(300) == 0
    return out, time.monotonic() - begun


def test_ten_kills_change_no_mark_and_no_finished_result(submissions, undisturbed, tmp_path):
    whole, seconds = undisturbed
    out, moments = tmp_path / "out", random.Random(4)
    kept = {}
    for _ in range(KILLS):
        run = start(submissions, out)
        time.sleep(moments.uniform(0.1, 0.6 * seconds))
        os.kill(run.pid, signal.SIGKILL)
        run.wait()
        assert not left_by(run)
        now = finished(out)
        assert {path: now[path] for path in kept} == kept
        kept = now
    assert start(submissions, out).wait(300) == 0
    now = finished(out)
    assert {path: now[path] for path in kept} == kept and len(now) == COUNT
    assert (out / "grades.csv").read_bytes() == (whole / "grades.csv").read_bytes()
    assert not list(out.rglob("*.unfinished"))


def test_an_interrupt_finishes_what_runs_and_stops(submissions, tmp_path):
    run = start(submissions, tmp_path / "out")
    while not list((tmp_path / "out").glob("results/*/*.json")):
        time.sleep(0.05)
    os.killpg(run.pid, signal.SIGINT)
    said = run.communicate(timeout=60)[1]
    assert run.returncode == 130 and "stopping: what runs is finished first" in said
    assert not left_by(run)
    assert 0 < len(finished(tmp_path / "out")) < COUNT
    assert (tmp_path / "out" / "index.html").is_file() and (tmp_path / "out" / "grades.csv").is_file()
