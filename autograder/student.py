"""A student's functions as the checks call them: across the wall, or in memory beside the notebook."""

from __future__ import annotations

import contextlib
import io
import signal
import time
import traceback

import numpy as np

from autograder import wall
from autograder.bounded import bounded

MAX_SERVED_CALLS, MAX_DEPTH = 200_000, 16


class Failure(Exception):
    """A task, or a call in it, that cannot be judged: why, in one sentence, and as which status."""

    def __init__(self, status, message, traceback=""):
        super().__init__(message)
        self.status, self.message, self.traceback = status, message, traceback


class Counted:
    """An SDF that counts the points handed to it."""

    def __init__(self, sdf):
        self._sdf, self.count = sdf, 0

    def __call__(self, points):
        points = np.asarray(points, dtype=float)
        if points.ndim < 1 or points.shape[-1] != 3:
            raise ValueError(f"sdf wants points of shape (N, 3), not {points.shape}")
        self.count += points.size // 3
        return self._sdf(points)

    evaluate = __call__


class Remote:
    """A task's process behind the wall.

    Parameters
    ----------
    sandbox : Sandbox
    link : socket           the process's end of the wall
    lower : dict            the references that the grader answers: name -> function
    deadline : float        of the task, on the monotonic clock
    """

    def __init__(self, sandbox, link, lower, deadline):
        self._sandbox, self._link, self._limits = sandbox, link, sandbox.limits
        self._served = list(lower.values())
        self._final = self._deadline = deadline
        self._calls = self._depth = 0
        self._watched = False
        self.cell, self.cell_failures = None, {}

    def load(self, job):
        """Run the submission's cells in the process; `cell` is the one that runs, failures are kept by cell."""
        now = time.monotonic()
        # where many cells never end, each is found out in less time than the one before, and the calls have some left
        self._deadline = min(now + self._limits.call_wall_seconds, (now + self._final) / 2)
        self._send(job)
        while True:
            kind, category, count, number = self._header()
            if kind == wall.LOADED:
                return
            if kind == wall.CELL:
                self.cell = count
            elif kind == wall.ERROR:
                self.cell_failures[self.cell] = self._failure(category)
            elif kind == wall.CALL:
                self._serve(number, count)
            else:
                raise Failure("crashed", "the process sent what no task sends")

    def call(self, name, arguments, returns):
        """What the student's `name(*arguments)` returns, as float64 arrays of the promised shapes."""
        kept = len(self._served)
        try:
            return self._ask(("call", name, [self._outgoing(a) for a in arguments], returns))
        finally:
            del self._served[kept:]

    def stop(self):
        """Let the process end by itself, so that its output is complete."""
        with contextlib.suppress(OSError):
            self._link.sendall(wall.pack_message(("stop",)))
            self._link.settimeout(1)
            self._link.recv(1)

    def _ask(self, message):
        if self._depth >= MAX_DEPTH:
            raise Failure("crashed", f"its functions and the grader's call each other more than {MAX_DEPTH} deep")
        outer = self._deadline
        self._depth += 1
        self._deadline = min(time.monotonic() + self._limits.call_wall_seconds, self._final)
        returns = message[3]
        try:
            self._send(message)
            while True:
                kind, category, count, number = self._header()
                if kind == wall.VALUE and count == len(returns.shapes):
                    return [
                        np.frombuffer(self._read(8 * size), "<f8").reshape(shape).copy()
                        for size, shape in zip(returns.sizes, returns.shapes, strict=True)
                    ]
                if kind == wall.ERROR:
                    raise self._failure(category)
                if kind != wall.CALL:
                    raise Failure("crashed", "the process sent what no task sends")
                self._serve(number, count)
        finally:
            self._deadline = outer
            self._depth -= 1

    def _serve(self, number, count):
        """Answer a call of the student's to one of the grader's functions; its time is not the student's."""
        try:
            arguments = wall.read_call(count, self._read)
        except wall.Breach as breach:
            raise Failure("crashed", f"the process broke the protocol: {breach}") from None
        self._calls += 1
        begun = time.monotonic()
        try:
            if self._calls > MAX_SERVED_CALLS:
                raise Failure("timeout", f"more than {MAX_SERVED_CALLS} calls to functions that the grader serves")
            if number >= len(self._served):
                raise ValueError("no such function")
            # the outermost call holds for those within it
            with self._bounds(), np.errstate(all="ignore"):
                answer = wall.pack_message(("answer", self._served[number](*[self._argument(*a) for a in arguments])))
        except Failure:
            raise
        except Exception as refused:  # a wrong argument is the student's to hear of
            answer = wall.pack_message(("raise", wall.sentence(refused)))
        self._deadline += time.monotonic() - begun
        self._send(answer)

    @contextlib.contextmanager
    def _bounds(self):
        if self._watched:
            yield
            return
        self._watched = True
        try:
            with bounded(self._final, self._late_at_last):
                yield
        finally:
            self._watched = False

    def _late_at_last(self):
        self._deadline = self._final
        return self._late()

    def _argument(self, kind, value):
        if kind == wall.SERVED:
            if not 0 <= value < len(self._served):
                raise ValueError("no such function")
            return self._served[value]
        if kind == wall.LOCAL:
            return lambda points: self._ask(
                ("local", value, [np.asarray(points)], wall.Returns((np.shape(points)[:-1],)))
            )[0]
        if kind == wall.PIXELS:
            from framework.environment import Environment

            return Environment(value)
        if kind == wall.SEED:
            return np.random.default_rng(abs(value))
        return None if kind == wall.ABSENT else value

    def _outgoing(self, value):
        if callable(value) and not isinstance(value, type):
            self._served.append(value)
            return wall.Handle(len(self._served) - 1, getattr(value, "__name__", "sdf"))
        return value

    def _failure(self, category):
        message, trace = wall.unpack_text(self._read(wall.TEXT.size))
        status = {wall.MEMORY: "out_of_memory", wall.NOT_ATTEMPTED: "not_attempted"}.get(category, "error")
        return Failure(status, message, trace)

    def _send(self, message):
        self._link.settimeout(max(self._deadline - time.monotonic(), 0.01))
        try:
            self._link.sendall(message if isinstance(message, bytes) else wall.pack_message(message))
        except TimeoutError:
            raise self._late() from None
        except OSError:
            raise Failure("crashed", "its process ended") from None

    def _header(self):
        return wall.HEADER.unpack(self._read(wall.HEADER.size))

    def _read(self, size):
        block = bytearray(size)
        view = memoryview(block)
        while view:
            if not self._sandbox.readable(self._link, self._deadline):
                raise self._late()
            try:
                count = self._link.recv_into(view)
            except OSError:
                count = 0
            if not count:
                raise Failure("crashed", "its process ended")
            view = view[count:]
        return bytes(block)

    def _late(self):
        if self._deadline >= self._final:
            return out_of_time(self._limits)
        return Failure("timeout", f"a call took over {self._limits.call_wall_seconds:g} s")


def out_of_time(limits):
    """The failure of a task that was not done when the next one's time came."""
    return Failure("timeout", f"it used up its part of the {limits.submission_seconds:g} s that a submission has")


def why_ended(failure, ended, limits):
    """The failure of a task whose process ended, told by how it ended."""
    if failure.status != "crashed" or ended is None:
        return failure
    if ended.out_of_memory:
        return Failure("out_of_memory", f"it used over {limits.memory_mb} MiB")
    if ended.signal == signal.SIGXCPU:
        return Failure("timeout", f"a call used over {limits.call_cpu_seconds} s of CPU time: does a loop never end?")
    if ended.signal and ended.signal != signal.SIGKILL:
        name = signal.Signals(ended.signal).name if ended.signal in set(signal.Signals) else str(ended.signal)
        return Failure("crashed", f"the process died of {name}")
    if ended.code or not ended.signal:
        return Failure("crashed", f"the process ended itself with exit code {ended.code}")
    return failure


class InMemory:
    """Functions of a running notebook, called in its own process."""

    def __init__(self, namespace, task):
        self._namespace, self._task = namespace, task

    def call(self, name, arguments, returns):
        function = self._namespace.get(name)
        if not callable(function):
            raise Failure("not_attempted", f"{name} is not defined yet: run its cell first")
        arguments = [_own(a) for a in arguments]
        quiet = io.StringIO()
        before = wall.forbid(self._task.forbidden, self._task.name)
        try:
            with wall.calm(), contextlib.redirect_stdout(quiet):
                return wall.as_promised(function(*arguments), returns)
        except wall.WrongShape as wrong:
            raise Failure("error", str(wrong)) from None
        except NotImplementedError as failure:
            raise Failure("not_attempted", wall.sentence(failure)) from None
        except MemoryError as failure:
            raise Failure("out_of_memory", wall.sentence(failure)) from None
        except (Exception, SystemExit) as failure:
            frames = traceback.extract_tb(failure.__traceback__)[1:]
            lines = [f"line {f.lineno}, in {f.name}\n    {f.line}" for f in frames if "ipykernel" in f.filename]
            raise Failure("error", wall.sentence(failure), "\n".join([*lines, wall.sentence(failure)])) from None
        finally:
            wall.allow(before)


def _own(value):
    """A copy of arrays, also in a list, for a function that may write into what it is given."""
    if isinstance(value, (list, tuple)):
        return [_own(part) for part in value]
    return value.copy() if isinstance(value, np.ndarray) else value
