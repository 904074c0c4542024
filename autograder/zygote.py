"""The trusted process inside the sandbox: it forks one process per task, and kills all that a task leaves behind.

It never runs a line of the student's.
"""

from __future__ import annotations

import contextlib
import os
import random
import resource
import signal
import socket
import sys

import numpy as np

from autograder import wall
from autograder.worker import Task

SCRATCH = ("/scratch", "/dev/shm")


def main(control_fd: int) -> None:
    """Serve the grader: one forked process for each socket that arrives on the control connection."""
    control = socket.socket(fileno=control_fd)
    config = wall.receive(control)
    _harden(config)
    control.sendall(b"r")
    while True:
        data, fds, _, _ = socket.recv_fds(control, 1, 1)
        if not data:
            return
        child = os.fork()
        if child == 0:
            control.close()
            _run_task(socket.socket(fileno=fds[0]), config)
        os.close(fds[0])
        if not control.recv(1):
            _clear(child, config["own_pid_namespace"])
            return
        left = _clear(child, config["own_pid_namespace"])
        _, status, usage = os.wait4(child, 0)
        _reap()
        code = os.waitstatus_to_exitcode(status)
        cpu = int(1000 * (usage.ru_utime + usage.ru_stime))
        peak = usage.ru_maxrss // (1024 if sys.platform == "darwin" else 1)
        control.sendall(wall.ENDED.pack(max(code, 0), max(-code, 0), peak, cpu, left))


def _harden(config):
    """Take from this process, and so from its children, what no task needs."""
    if sys.platform == "linux":
        prctl = _libc().prctl
        prctl(4, 0, 0, 0, 0)  # PR_SET_DUMPABLE off: no child may look into the zygote
        prctl(36, 1, 0, 0, 0)  # PR_SET_CHILD_SUBREAPER: orphans come back to be killed
    for name in config["blocked_packages"]:
        sys.modules[name] = None  # type: ignore[assignment]  # importing it raises ModuleNotFoundError


def _clear(child, own_pid_namespace):
    """Kill the task's process and everything that it started; empty the scratch folders. Count what resists."""
    if own_pid_namespace:
        with contextlib.suppress(ProcessLookupError):
            os.kill(-1, signal.SIGKILL)
    else:
        for kill in (os.killpg, os.kill):
            with contextlib.suppress(ProcessLookupError, PermissionError):
                kill(child, signal.SIGKILL)
    return sum(map(_emptied, SCRATCH)) if own_pid_namespace else 0


def _emptied(folder, depth=8):
    """Remove what is in a folder, and count what stays: a task may leave folders in folders without end."""
    left = 0
    with contextlib.suppress(OSError):
        for entry in list(os.scandir(folder)):
            if not entry.is_dir(follow_symlinks=False):
                with contextlib.suppress(OSError):
                    os.unlink(entry.path)
            elif depth:
                _emptied(entry.path, depth - 1)
                with contextlib.suppress(OSError):
                    os.rmdir(entry.path)
            left += os.path.lexists(entry.path)
    return left


def _reap():
    """Collect orphans that were adopted from the task; those that still run are killed."""
    while True:
        try:
            pid, _ = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return
        if pid == 0:
            for orphan in _children():
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.kill(orphan, signal.SIGKILL)
            with contextlib.suppress(ChildProcessError):
                os.waitpid(-1, 0)


def _children():
    try:
        with open(f"/proc/self/task/{os.getpid()}/children") as file:
            return [int(word) for word in file.read().split()]
    except OSError:
        return []


def _run_task(link, config):
    """The life of one task's process; never returns."""
    try:
        os.setsid()
        _limit(config)
        random.seed(0)
        np.random.seed(0)  # noqa: NPY002  the student may use the global generator; it must start alike everywhere
        Task(link, config).run()
    except (EOFError, OSError):
        pass
    finally:
        os._exit(0)


def _limit(config):
    def lower(kind, value):
        hard = resource.getrlimit(kind)[1]
        value = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(kind, (value, value))

    lower(resource.RLIMIT_CORE, 0)
    lower(resource.RLIMIT_FSIZE, config["file_bytes"])
    lower(resource.RLIMIT_NOFILE, 256)
    if sys.platform == "linux":  # macOS knows this limit but does not keep it
        lower(resource.RLIMIT_AS, config["memory_bytes"])
    if config["seccomp"] is not None:
        _install_filter(config["seccomp"])


def _install_filter(program):
    """Forbid, for good, what the grader's BPF program forbids: starting processes among it."""
    import ctypes

    class Program(ctypes.Structure):
        _fields_ = [("length", ctypes.c_ushort), ("code", ctypes.c_char_p)]

    filter_ = Program(len(program) // 8, program)
    libc = _libc()
    if libc.prctl(38, 1, 0, 0, 0) or libc.prctl(22, 2, ctypes.byref(filter_), 0, 0):  # NO_NEW_PRIVS, SECCOMP
        raise OSError(ctypes.get_errno(), "seccomp filter refused")


def _libc():
    import ctypes

    return ctypes.CDLL(None, use_errno=True)
