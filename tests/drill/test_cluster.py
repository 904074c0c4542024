"""A batch on a real Dask cluster of two workers, one of which is killed half-way: the same grades."""

import os
import signal
import subprocess
import sys
import time

import nbformat
import pytest

from autograder import batch, cli, cluster
from autograder.demo import IN_ANOTHER_WAY, NO_INSIDE
from autograder.samples import filled_notebook

pytestmark = pytest.mark.drill


@pytest.fixture
def submissions(tmp_path):
    for i in range(12):
        path = tmp_path / "in" / f"s{i:02d}" / "sphere_tracing.ipynb"
        path.parent.mkdir(parents=True)
        nbformat.write(filled_notebook("sphere_tracing", ({}, NO_INSIDE, IN_ANOTHER_WAY)[i % 3]), path)
    (tmp_path / "in" / "bad").mkdir()
    (tmp_path / "in" / "bad" / "sphere_tracing.ipynb").write_text("{")
    return tmp_path / "in"


@pytest.fixture
def two_workers(tmp_path):
    """The address of a scheduler, and the processes that stand for two machines: they share no folder with us."""
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0",
               "--scheduler-file", str(tmp_path / "scheduler.json"), "--no-dashboard"]  # fmt: skip
    processes = [subprocess.Popen(command, stderr=subprocess.DEVNULL)]
    try:
        workers = []
        for name in ("one", "two"):
            (tmp_path / name).mkdir()
            command = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file",
                       str(tmp_path / "scheduler.json"), "--nthreads", "1", "--no-nanny", "--no-dashboard",
                       "--local-directory", str(tmp_path / name)]  # fmt: skip
            workers.append(subprocess.Popen(command, cwd=tmp_path / name, stderr=subprocess.DEVNULL, start_new_session=True))
        processes += workers
        from distributed import Client

        with Client(scheduler_file=str(tmp_path / "scheduler.json"), timeout=60) as client:
            client.wait_for_workers(2, timeout=60)
            address = client.scheduler.address
        yield address, workers
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_a_cluster_that_loses_a_worker_gives_the_same_grades(submissions, two_workers, tmp_path, monkeypatch):
    address, workers = two_workers
    here, there = tmp_path / "here", tmp_path / "there"
    assert cli.main(["grade", str(submissions), "--out", str(here), "--allow-weak-isolation"]) == 0

    stored, killed = batch.store.write, []

    def store_and_kill(*arguments):
        stored(*arguments)
        if len(list(there.glob("results/*/*.json"))) == 4 and not killed:
            os.killpg(workers[0].pid, signal.SIGKILL)
            killed.append(time.monotonic())

    monkeypatch.setattr(batch.store, "write", store_and_kill)
    command = ["grade", str(submissions), "--out", str(there), "--scheduler", address, "--allow-weak-isolation"]
    assert cli.main(command) == 0
    assert killed and workers[0].wait(10) == -signal.SIGKILL and workers[1].poll() is None
    assert (there / "grades.csv").read_bytes() == (here / "grades.csv").read_bytes()
    assert len((here / "grades.csv").read_text().splitlines()) == 14
    assert sorted(p.relative_to(there) for p in there.rglob("*.png")) == sorted(
        p.relative_to(here) for p in here.rglob("*.png")
    )


def test_a_scheduler_that_is_not_there_is_named(submissions, tmp_path, capsys):
    command = ["grade", str(submissions), "--out", str(tmp_path / "out"), "--scheduler", "tcp://127.0.0.1:9"]
    assert cli.main(command) == 2
    assert "no scheduler answers at tcp://127.0.0.1:9" in capsys.readouterr().err


def test_a_worker_of_another_release_is_refused(two_workers, monkeypatch):
    monkeypatch.setattr(cluster, "versions", lambda: {"course_version": "9.9", "tolerances": ""})
    with pytest.raises(cluster.Usage, match=r"course_version 0\.\d+\.\d+, and this machine 9\.9"):
        cluster.connect(two_workers[0]).__enter__()
