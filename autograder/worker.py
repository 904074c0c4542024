"""The process of one task, inside the sandbox.

It runs the source of the solution cells, puts references (answered by the grader) in the place of lower-numbered
functions, removes higher-numbered ones, and then answers the grader's calls until it is told to stop.
"""

from __future__ import annotations

import ast
import contextlib
import linecache
import re
import resource
import sys

import numpy as np

import framework
from autograder import wall


class Task:
    """The student's code, seen from the grader: run the cells, then answer calls."""

    def __init__(self, link, config):
        self.link, self.config = link, config
        self.locals: list = []
        self.call_cpu = config["call_cpu_seconds"]

    def run(self):
        job = wall.receive(self.link)
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
            message = wall.receive(self.link)
            if message[0] == "stop":
                return
            self._grant_cpu()
            self._answer(message)

    def ask(self, number, arguments):
        """Call a function of the grader's; meanwhile the grader may call back what was handed to it."""
        self.link.sendall(wall.pack_call(number, [self._outgoing(a) for a in arguments]))
        while True:
            message = wall.receive(self.link)
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
            with wall.calm():
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
