"""What runs inside the sandbox: a zygote of ours that forks one process per task, and that process.

The zygote never runs a line of the student's. The process of a task runs the source of the solution cells, puts
references (answered by the grader) in the place of lower-numbered functions, removes higher-numbered ones, and then
answers the grader's calls until it is told to stop. When a task ends, the zygote kills all that it left behind.
"""

from __future__ import annotations

import ast
import contextlib
import linecache
import os
import random
import re
import resource
import shutil
import signal
import socket
import struct
import sys

import numpy as np

import framework
from autograder import wall

SCRATCH = ("/tmp", "/dev/shm")


def main(control_fd: int) -> None:
    """Serve the grader: one forked process for each socket that arrives on the control connection."""
    control = socket.socket(fileno=control_fd)
    config = _receive(control)
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
    left = 0
    if own_pid_namespace:
        for folder in SCRATCH:
            for entry in os.scandir(folder):
                if entry.is_dir(follow_symlinks=False):
                    shutil.rmtree(entry.path, ignore_errors=True)
                else:
                    with contextlib.suppress(OSError):
                        os.unlink(entry.path)
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


class Task:
    """The student's code, seen from the grader: run the cells, then answer calls."""

    def __init__(self, link, config):
        self.link, self.config = link, config
        self.locals: list = []
        self.call_cpu = config["call_cpu_seconds"]

    def run(self):
        job = _receive(self.link)
        wall.forbid(job["forbidden"], job["task"])
        self.cells = job["cells"]
        self._grant_cpu()
        self.namespace = self._execute(job["skip"])
        for name, number, parameters in job["lower"]:
            self.namespace[name] = Served(self, number, name, parameters)
        for name in job["higher"]:
            self.namespace.pop(name, None)
        self.link.sendall(wall.HEADER.pack(wall.LOADED, 0, 0, 0))
        while True:
            message = _receive(self.link)
            if message[0] == "stop":
                return
            self._grant_cpu()
            self._answer(message)

    def ask(self, number, arguments):
        """Call a function of the grader's; meanwhile the grader may call back what was handed to it."""
        self.link.sendall(wall.pack_call(number, [self._outgoing(a) for a in arguments]))
        while True:
            message = _receive(self.link)
            if message[0] == "answer":
                return message[1]
            if message[0] == "raise":
                raise RuntimeError(message[1])
            self._answer(message)

    def _answer(self, message):
        """("call", name, arguments, returns) or ("local", number, arguments, returns)."""
        kind, which, arguments, returns = message
        try:
            if kind == "local":
                function = self.locals[which]
            else:
                function = self.namespace.get(which)
                if not callable(function):
                    self._error(wall.MISSING, f"{which} is not defined in its cell", "")
                    return
            result = function(*[self._incoming(a) for a in arguments])
            arrays = wall.as_promised(result, returns)
            _flush()
        except wall.WrongShape as wrong:
            self._error(wall.SHAPE, str(wrong), "")
        except BaseException as failure:  # whatever a student's code raises is an answer
            self._error(_category(failure), wall.sentence(failure), self._traceback(failure))
        else:
            header = wall.HEADER.pack(wall.VALUE, 0, len(arrays), 0)
            self.link.sendall(header + b"".join(a.tobytes() for a in arrays))

    def _error(self, category, message, traceback):
        _flush()
        self.link.sendall(wall.HEADER.pack(wall.ERROR, category, 0, 0) + wall.pack_text(message, traceback))

    def _execute(self, skip):
        """Run the solution cells one after the other, as a notebook would; one that fails does not stop the next."""
        namespace = {"__name__": "__main__", "np": np, "fw": framework, "framework": framework}
        for index, (grade_id, source) in enumerate(self.cells):
            self.link.sendall(wall.HEADER.pack(wall.CELL, 0, index, 0))
            if index in skip:
                source = _definitions(source)
            filename = f"<cell {grade_id}>"
            linecache.cache[filename] = (len(source), None, source.splitlines(keepends=True), filename)
            try:
                exec(_compiled(source, filename), namespace)
            except BaseException as failure:
                self._error(wall.SYNTAX if isinstance(failure, SyntaxError) else _category(failure),
                            wall.sentence(failure), self._traceback(failure))  # fmt: skip
        return namespace

    def _grant_cpu(self):
        """Each call has its own allowance of CPU time; above it the kernel ends the process."""
        used = resource.getrusage(resource.RUSAGE_SELF)
        soft = int(used.ru_utime + used.ru_stime) + 1 + self.call_cpu
        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        resource.setrlimit(resource.RLIMIT_CPU, (soft if hard == resource.RLIM_INFINITY else min(soft, hard), hard))

    def _incoming(self, value):
        if isinstance(value, wall.Handle):
            return Served(self, value.number, value.name, None)
        return value

    def _outgoing(self, value):
        if value is None:
            return wall.ABSENT, None
        if isinstance(value, Served):
            return wall.SERVED, value.number
        if isinstance(value, np.random.Generator):
            return wall.SEED, int(value.integers(2**62))
        if hasattr(value, "pixels"):
            return wall.PIXELS, np.asarray(value.pixels, dtype=float)
        if callable(value):
            self.locals.append(value)
            return wall.LOCAL, len(self.locals) - 1
        if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
            return wall.INTEGER, int(value)
        return wall.ARRAY, np.asarray(value, dtype=float)

    def _traceback(self, failure):
        """The frames in the student's own cells, with their lines."""
        import traceback

        lines = []
        for frame in traceback.extract_tb(failure.__traceback__):
            if frame.filename.startswith("<cell "):
                lines.append(f"{frame.filename[1:-1]}, line {frame.lineno}, in {frame.name}\n    {frame.line}")
        if isinstance(failure, SyntaxError):
            lines.append("".join(traceback.format_exception_only(failure)).rstrip())
        else:
            lines.append(wall.sentence(failure))
        return "\n".join(lines)


def _compiled(source, filename):
    """Code of a cell; where it does not parse, lines that only a notebook understands are left out."""
    try:
        return compile(source, filename, "exec")
    except SyntaxError:
        plain = re.sub(r"^(\s*)([%!]{1,2}[A-Za-z].*)$", r"\1pass  # \2", source, flags=re.MULTILINE)
        return compile(plain, filename, "exec")


def _definitions(source):
    """Of a cell that never ends: its imports and definitions alone."""
    try:
        tree = ast.parse(source)
    except SyntaxError:
        return ""
    kept = (ast.FunctionDef, ast.ClassDef, ast.Import, ast.ImportFrom)
    tree.body = [node for node in tree.body if isinstance(node, kept)]
    return ast.unparse(tree)


class Served:
    """A function that the grader answers."""

    def __init__(self, task, number, name, parameters):
        self._task, self.number, self.__name__, self._parameters = task, number, name, parameters

    def __call__(self, *arguments, **named):
        if named:
            if not self._parameters:
                raise TypeError(f"{self.__name__} takes no named arguments")
            rest = self._parameters[len(arguments) :]
            unknown = sorted(set(named) - set(rest))
            if unknown:
                raise TypeError(f"{self.__name__} has no argument {unknown[0]!r} to be given by name")
            arguments += tuple(named[name] for name in rest if name in named)
        return self._task.ask(self.number, arguments)

    evaluate = __call__

    def __repr__(self):
        return f"<{self.__name__}, answered by the grader>"


def _flush():
    """What the student printed must be out before the grader hears the answer."""
    with contextlib.suppress(Exception):
        sys.stdout.flush()
        sys.stderr.flush()


def _category(failure):
    if isinstance(failure, MemoryError):
        return wall.MEMORY
    return wall.NOT_ATTEMPTED if isinstance(failure, NotImplementedError) else wall.EXCEPTION


def _receive(link):
    """One message of the grader's, which is trusted."""
    import pickle

    size = struct.unpack("<Q", _exactly(link, 8))[0]
    return pickle.loads(_exactly(link, size))


def _exactly(link, size):
    block = bytearray(size)
    view = memoryview(block)
    while view:
        count = link.recv_into(view)
        if not count:
            raise EOFError
        view = view[count:]
    return bytes(block)
