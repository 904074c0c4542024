"""Processes for strangers' code: the strongest isolation that this machine really starts.

A sandbox holds a zygote (`autograder.zygote`) that sees the interpreter, the installed packages and `framework`, all
read-only, a scratch folder of fixed size, and nothing else: no network, no home, no solutions, checks or references,
no other submission. Each task gets a process of its own, forked from the zygote.
"""

from __future__ import annotations

import contextlib
import functools
import os
import select
import signal
import socket
import subprocess
import sys
import sysconfig
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from autograder import cgroup, syscalls, wall
from framework import compiled

ROOT = Path(__file__).resolve().parents[1]
NAMESPACES_SECCOMP, NAMESPACES, PROCESS = "namespaces+seccomp", "namespaces", "process"
COMPILED = "/course/compiled"  # the framework's compiled code, read-only; a task that wants it takes a copy
SCRATCH, SCRATCH_BYTES = "/scratch", 64 << 20  # the one place where a task may write
STRENGTH = (NAMESPACES_SECCOMP, NAMESPACES, PROCESS)


@dataclass(frozen=True)
class Limits:
    """What a submission may use. Time limits lie far above need: they stop runaways and decide no mark."""

    call_cpu_seconds: int = 10
    call_wall_seconds: float = 20.0
    submission_seconds: float = 120.0
    memory_mb: int = 2048
    file_mb: int = 64
    output_bytes: int = 1 << 20


@dataclass(frozen=True)
class Ended:
    """How the process of a task ended, as its zygote saw it."""

    code: int = 0
    signal: int = 0
    peak_memory_mb: float = 0.0
    cpu_seconds: float = 0.0
    clean: bool = True
    out_of_memory: bool = False


class Sandbox:
    """A zygote behind the wall; use as a context manager, and ask it for tasks one after the other."""

    def __init__(self, level, limits, forbidden_modules=()):
        self.level, self.limits = level, limits
        self._forbidden = tuple(forbidden_modules)
        self._process = self._group = None
        self._killed = 0

    def __enter__(self):
        self._home = tempfile.TemporaryDirectory(prefix="course-") if self.level == PROCESS else None
        self._output, write = os.pipe()
        os.set_blocking(self._output, False)
        self.control, theirs = socket.socketpair()
        inherited = [theirs.fileno()]
        try:
            outer = syscalls.filter_file(syscalls.OUTER) if self.level == NAMESPACES_SECCOMP else None
            if outer is not None:
                inherited.append(outer)
            command = self._grouped(self._command(theirs.fileno(), outer))
            self._process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=write, stderr=write, pass_fds=inherited,
                env=self._environment(), start_new_session=True, cwd=self._home.name if self._home else "/",
            )  # fmt: skip
        finally:
            os.close(write)
            for fd in inherited[1:]:
                os.close(fd)
            theirs.close()
        self.control.settimeout(30)
        try:
            self.control.sendall(wall.pack_message(self._config()))
            ready = self.control.recv(1)
        except OSError:
            ready = b""
        if ready != b"r":
            text = self.printed()
            self.__exit__()
            raise SandboxFailed(text.strip()[-500:] or "the isolated process did not start")
        return self

    def __exit__(self, *_):
        self.control.close()
        if self._process is not None:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
            self._process = None
        if self._group is not None:
            self._group.end()
        with contextlib.suppress(OSError):
            os.close(self._output)
        if self._home is not None:
            self._home.cleanup()

    def start_task(self):
        """A socket to a fresh process for one task."""
        ours, theirs = socket.socketpair()
        with theirs:
            socket.send_fds(self.control, [b"t"], [theirs.fileno()])
        return ours

    def end_task(self) -> Ended | None:
        """Kill what the task left, and say how it ended; None where the sandbox itself is lost."""
        try:
            self.control.settimeout(20)
            self.control.sendall(b"e")
            block = b""
            while len(block) < wall.ENDED.size:
                part = self.control.recv(wall.ENDED.size - len(block))
                if not part:
                    return None
                block += part
        except OSError:
            return None
        code, signum, peak, cpu, left = wall.ENDED.unpack(block)
        before, self._killed = self._killed, self._group.out_of_memory() if self._group else 0
        return Ended(code, signum, peak / 1024, cpu / 1000, left == 0, self._killed > before)

    def readable(self, link, deadline):
        """Wait until `link` can be read, keeping the student's output flowing; False after `deadline`."""
        while True:
            rest = deadline - time.monotonic()
            if rest <= 0:
                return False
            ready, _, _ = select.select([link, self._output], [], [], rest)
            if self._output in ready and not self._drain():
                select.select([link], [], [], rest)
            if link in ready:
                return True

    def printed(self) -> str:
        """What was printed since the last call, cut to the limit."""
        self._drain()
        text, self._kept = self._kept, bytearray()
        return text.decode("utf-8", "replace")

    _kept = bytearray()

    def _drain(self):
        while True:
            try:
                block = os.read(self._output, 1 << 16)
            except BlockingIOError:
                return True
            if not block:
                return False
            room = self.limits.output_bytes - len(self._kept)
            self._kept = self._kept + block[: max(room, 0)]

    def _config(self):
        inner = None
        if self.level == NAMESPACES_SECCOMP:
            fd = syscalls.filter_file(syscalls.INNER)
            with os.fdopen(fd, "rb") as file:
                inner = file.read()
        return {
            "blocked_packages": [
                "solutions", "benchmarks", "autograder.checks", "autograder.mistakes", "autograder.references",
            ],
            "own_pid_namespace": self.level != PROCESS,
            "call_cpu_seconds": self.limits.call_cpu_seconds,
            "memory_bytes": self.limits.memory_mb << 20,
            "file_bytes": self.limits.file_mb << 20,
            "seccomp": inner,
        }  # fmt: skip

    def _environment(self):
        home = self._home.name if self._home else SCRATCH
        keep = {name: os.environ[name] for name in ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE") if name in os.environ}
        kernels = str(compiled.folder()) if self.level == PROCESS else COMPILED
        threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
        return keep | threads | {
            "HOME": home, "TMPDIR": home, "MPLCONFIGDIR": home, "NUMBA_CACHE_DIR": home, "MPLBACKEND": "Agg",
            compiled.COPIED_FROM: kernels, "PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "PYTHONHASHSEED": "0",
            "PYTHONDONTWRITEBYTECODE": "1",
        }  # fmt: skip

    def _grouped(self, command):
        parent = cgroup.delegated()
        if parent is None:
            return command
        try:
            self._group = cgroup.Group(parent, self.limits.memory_mb)
        except OSError as error:
            raise SandboxFailed(f"no control group can be made: {error}") from None
        return self._group.entered(command)

    def _command(self, control, seccomp):
        root = str(ROOT) if self.level == PROCESS else "/course"
        start = f"import sys; sys.path.insert(0, {root!r}); from autograder.zygote import main; main({control})"
        python = [sys.executable, "-s", "-P", "-c", start]
        if self.level == PROCESS:
            return python
        return [*_bubblewrap(self._forbidden), *(["--seccomp", str(seccomp)] if seccomp is not None else []), *python]


class SandboxFailed(Exception):
    """The isolated process did not start."""


class Pool:
    """Sandboxes kept open from task to task: starting one costs as much as judging a whole submission.

    Parameters
    ----------
    level : str         one of `STRENGTH`
    limits : Limits
    """

    KEPT = 4  # as many as an assignment needs: one for each set of modules that a task may not see

    def __init__(self, level, limits):
        self.level, self.limits = level, limits
        self._open: dict[tuple[str, ...], Sandbox] = {}

    def sandbox(self, forbidden) -> Sandbox:
        """A sandbox without these modules of the framework, open until `drop`."""
        box = self._open.pop(forbidden, None)
        if box is None:
            while len(self._open) >= self.KEPT:
                self.drop(next(iter(self._open)))
            box = self._start(forbidden)
        self._open[forbidden] = box  # at the end, as the one used last
        return box

    def _start(self, forbidden):
        try:
            return Sandbox(self.level, self.limits, forbidden).__enter__()
        except SandboxFailed:
            time.sleep(1)  # a machine short of processes or memory for a moment
            return Sandbox(self.level, self.limits, forbidden).__enter__()

    def drop(self, forbidden):
        """Close the sandbox of these modules: what a task left in it is not to be trusted."""
        box = self._open.pop(forbidden, None)
        if box is not None:
            box.__exit__()

    def close(self):
        """Close all of them; their processes are gone afterwards."""
        for forbidden in list(self._open):
            self.drop(forbidden)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


@functools.cache
def strongest_level() -> str:
    """The strongest isolation that this machine starts, found by starting it."""
    for level in STRENGTH[:-1]:
        if level == NAMESPACES_SECCOMP and not syscalls.available():
            continue
        try:
            with Sandbox(level, Limits()) as sandbox:
                sandbox.start_task().close()
                if sandbox.end_task() is not None:
                    return level
        except (SandboxFailed, OSError):
            continue
    return PROCESS


def _bubblewrap(forbidden):
    """The command that starts a process with nothing but what a task needs."""
    binds = []
    if Path("/bin").is_symlink():
        for name in ("bin", "lib", "lib64"):
            if Path("/", name).is_symlink():
                binds += ["--symlink", os.readlink(Path("/", name)), f"/{name}"]
    else:
        for name in ("/bin", "/lib", "/lib64"):
            binds += ["--ro-bind-try", name, name]
    binds += ["--ro-bind", "/usr", "/usr", "--ro-bind-try", "/etc/ld.so.cache", "/etc/ld.so.cache"]
    prefixes = sorted({sys.base_prefix, sys.prefix})
    for prefix in prefixes:
        if not prefix.startswith("/usr"):
            binds += ["--ro-bind", prefix, prefix]
    packages = Path(sysconfig.get_path("purelib"))
    for name in ("solutions", "autograder"):
        if (packages / name).is_dir():
            binds += ["--tmpfs", str(packages / name)]
    binds += ["--ro-bind", str(ROOT / "framework"), "/course/framework"]
    for folder in compiled.folder().glob("framework_*"):
        binds += ["--ro-bind", str(folder), f"{COMPILED}/{folder.name}"]
    for module in forbidden:
        binds += ["--ro-bind", "/dev/null", f"/course/framework/{module}.py"]
    for name in ("wall.py", "worker.py", "zygote.py"):
        binds += ["--ro-bind", str(ROOT / "autograder" / name), f"/course/autograder/{name}"]
    return [
        "bwrap", "--unshare-user", "--unshare-all", "--disable-userns", "--die-with-parent", "--new-session",
        "--cap-drop", "ALL", "--hostname", "sandbox", *binds, "--dev", "/dev",
        "--size", str(SCRATCH_BYTES), "--tmpfs", SCRATCH, "--size", str(8 << 20), "--tmpfs", "/dev/shm",
        *([] if any(prefix.startswith("/tmp/") for prefix in prefixes) else ["--symlink", SCRATCH, "/tmp"]),
        "--remount-ro", "/", "--chdir", SCRATCH,
    ]  # fmt: skip
