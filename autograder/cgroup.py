"""A control group for each sandbox, where one is to be had: bounds on its memory and processes together, one end for all.

Of cgroup v2 alone, below the nearest group, from this process's own upwards, that hands the controllers for memory and
processes down and that this user may write to: for instance in `systemd-run --user --scope course grade ...`.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import os
import shlex
import subprocess
import time
from pathlib import Path

PROCESSES = 64
_numbers = itertools.count()


class Group:
    """One group. The processes of a command started by `entered` stay in it; `end` leaves none of them.

    Parameters
    ----------
    parent : Path       where it is made, as `delegated` gives it
    memory_mb : int     of all its processes together, in MiB
    """

    def __init__(self, parent, memory_mb):
        self.path = parent / f"course-{os.getpid()}-{next(_numbers)}"
        self.path.mkdir()
        bound(self.path, memory_mb)

    def entered(self, command) -> list[str]:
        """The command that enters the group and becomes `command`."""
        return ["/bin/sh", "-c", f'echo $$ > {shlex.quote(str(self.path))}/cgroup.procs && exec "$@"', "sh", *command]

    def out_of_memory(self) -> int:
        """How many of its processes the kernel has ended because they used too much memory together."""
        try:
            counts = dict(line.split() for line in (self.path / "memory.events").read_text().splitlines())
        except OSError:
            return 0
        return int(counts.get("oom_kill", 0))

    def end(self):
        """Kill its processes all at once, and remove it."""
        with contextlib.suppress(OSError):
            (self.path / "cgroup.kill").write_text("1")
        for _ in range(200):
            try:
                return self.path.rmdir()
            except OSError:  # the kernel takes a moment
                time.sleep(0.01)


def bound(folder, memory_mb):
    """Write the bounds of a group into its files."""
    for name, limit in ("memory.max", memory_mb << 20), ("memory.swap.max", 0), ("pids.max", PROCESSES):
        if (folder / name).exists():  # a kernel without swap knows no bound on it
            (folder / name).write_text(str(limit))


@functools.cache
def delegated(root=Path("/sys/fs/cgroup"), own=Path("/proc/self/cgroup")) -> Path | None:
    """The group below which groups can be made, found by making one; None where there is none."""
    try:
        line = next(line for line in own.read_text().splitlines() if line.startswith("0::/"))
        here = root / line[len("0::/") :]
        parent = next(folder for folder in (here, *here.parents) if folder.is_relative_to(root) and _hands_down(folder))
        _remove_left_over(parent)
        group = Group(parent, 256)
        try:
            kills = (group.path / "cgroup.kill").exists()  # since Linux 5.14
            entered = subprocess.run(group.entered(["true"]), stderr=subprocess.DEVNULL).returncode == 0
            return parent if kills and entered else None
        finally:
            group.end()
    except (OSError, StopIteration):
        return None


def _hands_down(folder):
    try:
        return {"memory", "pids"} <= set((folder / "cgroup.subtree_control").read_text().split())
    except OSError:
        return False


def _remove_left_over(parent):
    """Remove groups of graders that were killed; the kernel refuses where a process is left."""
    for folder in parent.glob("course-*-*"):
        if not Path("/proc", folder.name.split("-")[1]).exists():
            with contextlib.suppress(OSError):
                folder.rmdir()
