"""Control groups: on the kernel's own tree where it lets us, else on a folder that looks like one."""

import os
import subprocess
from pathlib import Path

import pytest

from autograder import cgroup
from autograder.sandbox import PROCESS, Ended, Limits, Sandbox
from autograder.student import Failure, why_ended

MOUNTED = next((p for p in map(Path, ("/sys/fs/cgroup/unified", "/sys/fs/cgroup")) if (p / "cgroup.procs").exists()), None)
kernel = pytest.mark.skipif(MOUNTED is None or not os.access(MOUNTED / "cgroup.procs", os.W_OK),
                            reason="this user may not make groups")  # fmt: skip


@kernel
def test_all_that_a_command_started_ends_with_its_group():
    group = cgroup.Group(MOUNTED, 256)
    daemon = 'setsid sh -c "echo \\$\\$; exec sleep 99" & setsid sleep 98 & wait'
    with subprocess.Popen(group.entered(["/bin/sh", "-c", daemon]), stdout=subprocess.PIPE, text=True) as running:
        daemon_pid = int(running.stdout.readline())
        assert group.path.name in Path(f"/proc/{daemon_pid}/cgroup").read_text()
        group.end()
        assert running.wait() == -9
    assert not group.path.exists()


@kernel
def test_a_sandbox_lives_in_its_group_and_takes_it_along(monkeypatch):
    monkeypatch.setattr(cgroup, "delegated", lambda: MOUNTED)
    with Sandbox(PROCESS, Limits()) as box:
        (folder,) = MOUNTED.glob(f"course-{os.getpid()}-*")
        box.start_task().close()
        assert len((folder / "cgroup.procs").read_text().split()) >= 1
        assert not box.end_task().out_of_memory
    assert not folder.exists()


def test_groups_are_made_below_the_nearest_group_that_hands_both_controllers_down(tmp_path):
    tree, own = tmp_path / "tree", tmp_path / "cgroup"
    for name, down in ("", "memory pids cpu"), ("user", "memory pids"), ("user/app", "pids"), ("user/app/run", ""):
        (tree / name).mkdir(parents=True)
        (tree / name / "cgroup.subtree_control").write_text(down)
    own.write_text("4:memory:/elsewhere\n0::/user/app/run\n")
    left_over = tree / "user" / "course-999999999-0"
    left_over.mkdir()
    assert cgroup.delegated(tree, own) is None  # a folder is no kernel: nothing enters it
    assert not left_over.exists() and not list(tree.glob("course-*"))
    own.write_text("4:memory:/elsewhere\n")
    assert cgroup.delegated(tree, own) is None


def test_the_bounds_are_those_of_the_limits(tmp_path):
    for name in ("memory.max", "memory.swap.max", "pids.max"):
        (tmp_path / name).write_text("max")
    cgroup.bound(tmp_path, 2048)
    found = {path.name: int(path.read_text()) for path in tmp_path.iterdir()}
    assert found == {"memory.max": 2048 << 20, "memory.swap.max": 0, "pids.max": 64}


def test_what_the_kernel_ended_for_its_memory_is_told_as_such(tmp_path):
    group = cgroup.Group(tmp_path, 256)
    assert group.out_of_memory() == 0
    (group.path / "memory.events").write_text("low 0\nmax 7\noom 1\noom_kill 1\n")
    assert group.out_of_memory() == 1
    ended = Ended(signal=9, out_of_memory=True)
    assert why_ended(Failure("crashed", "its process ended"), ended, Limits()).status == "out_of_memory"
