"""The wall between the grader and a student's process: what may cross it, and in which form.

The two directions differ. The grader is trusted: it sends pickled messages. The student's process is not: it sends
headers of fixed size, and after them exactly as many bytes as the grader already knows to expect, or as a header that
was checked against limits has announced. Nothing that a student sends is unpickled, evaluated or trusted.
"""

from __future__ import annotations

import contextlib
import pickle
import struct
import sys
import types
import warnings
from dataclasses import dataclass

import numpy as np

import framework

# student -> grader: kind, category, count, number
HEADER = struct.Struct("<BBHI")
CELL, LOADED, VALUE, ERROR, CALL = range(1, 6)
# categories of ERROR
EXCEPTION, NOT_ATTEMPTED, MISSING, SHAPE, MEMORY, SYNTAX = range(1, 7)

MESSAGE_BYTES, TRACEBACK_BYTES = 2000, 8000
TEXT = struct.Struct(f"<HH{MESSAGE_BYTES}s{TRACEBACK_BYTES}s")

# one argument of a CALL: kind, number of axes, four axes, a number
ARGUMENT = struct.Struct("<BBxxIIIIq")
ARRAY, SERVED, LOCAL, PIXELS, SEED, ABSENT, INTEGER = range(1, 8)
MAX_ARGUMENTS, MAX_AXES, MAX_VALUES = 16, 4, 4_000_000

# zygote -> grader: how a task's process ended. exit code, signal, peak memory in KiB, CPU milliseconds, left behind
ENDED = struct.Struct("<iiQQI")


class Breach(Exception):
    """The student's side sent what the protocol does not allow."""


@dataclass(frozen=True)
class Handle:
    """A callable of the grader's, as the student's side sees it: a number to ask for."""

    number: int
    name: str


@dataclass(frozen=True)
class Local:
    """A callable of the student's, as the grader's side sees it."""

    number: int


@dataclass(frozen=True)
class Returns:
    """What a call must return: one array, or a sequence of arrays, of shapes that the grader fixes."""

    shapes: tuple[tuple[int, ...], ...]
    sequence: bool = False

    @property
    def sizes(self):
        return [int(np.prod(shape, dtype=np.int64)) for shape in self.shapes]


def pack_message(message) -> bytes:
    """A message of the grader's to the student's side, with its length in front."""
    body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    return struct.pack("<Q", len(body)) + body


def receive(link):
    """One message of the grader's, on the student's side."""
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


def pack_text(message: str, traceback: str) -> bytes:
    """The two texts of an ERROR, cut to their fixed sizes; of a long traceback the end is kept."""
    first = message.encode("utf-8", "replace")[:MESSAGE_BYTES]
    second = traceback.encode("utf-8", "replace")[-TRACEBACK_BYTES:]
    return TEXT.pack(len(first), len(second), first, second)


def unpack_text(block: bytes) -> tuple[str, str]:
    """The texts of an ERROR; lengths beyond the buffers and bytes that are not UTF-8 do no harm."""
    first, second, message, traceback = TEXT.unpack(block)
    return (
        message[: min(first, MESSAGE_BYTES)].decode("utf-8", "replace"),
        traceback[: min(second, TRACEBACK_BYTES)].decode("utf-8", "replace"),
    )


def pack_call(handle: int, arguments) -> bytes:
    """The student's side asks for a callable of the grader's.

    `arguments` are pairs (kind, value): arrays of float64, numbers of handles and locals, seeds, None.
    """
    heads, bodies = [], []
    for kind, value in arguments:
        axes, number = (0, 0, 0, 0), 0
        if kind in (ARRAY, PIXELS):
            if value.ndim > MAX_AXES:
                raise ValueError(f"an argument has {value.ndim} axes; at most {MAX_AXES} can be passed to the grader")
            axes = (value.shape + (0, 0, 0, 0))[:MAX_AXES]
            bodies.append(np.ascontiguousarray(value, dtype="<f8").tobytes())
            heads.append(ARGUMENT.pack(kind, value.ndim, *axes, 0))
        else:
            number = 0 if value is None else int(value)
            heads.append(ARGUMENT.pack(kind, 0, *axes, number))
    return HEADER.pack(CALL, 0, len(heads), handle) + b"".join(heads) + b"".join(bodies)


def read_call(count: int, read) -> list[tuple[int, object]]:
    """The arguments of a CALL, read by `read(bytes) -> bytes`; raises Breach for what is out of bounds."""
    if count > MAX_ARGUMENTS:
        raise Breach(f"{count} arguments in one call")
    heads = [ARGUMENT.unpack(read(ARGUMENT.size)) for _ in range(count)]
    shapes = []
    for kind, ndim, a, b, c, d, _ in heads:
        if not ARRAY <= kind <= INTEGER or ndim > MAX_AXES:
            raise Breach("an argument of an unknown kind")
        shapes.append((a, b, c, d)[:ndim])
    # Python integers: a product of four axes cannot wrap round
    sizes = [_product(shape) if head[0] in (ARRAY, PIXELS) else 0 for shape, head in zip(shapes, heads, strict=True)]
    if sum(sizes) > MAX_VALUES:
        raise Breach(f"{sum(sizes)} values in one call; at most {MAX_VALUES} are served")
    arguments: list[tuple[int, object]] = []
    for head, shape, size in zip(heads, shapes, sizes, strict=True):
        if head[0] in (ARRAY, PIXELS):
            arguments.append((head[0], np.frombuffer(read(8 * size), dtype="<f8").reshape(shape).astype(float)))
        else:
            arguments.append((head[0], head[6]))
    return arguments


def _product(shape):
    result = 1
    for axis in shape:
        result *= axis
    return result


@contextlib.contextmanager
def calm():
    """A student's function runs within it: no warning and no floating-point error stops it, whatever was set before."""
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


class WrongShape(Exception):
    """A result is not of the shape that was promised."""


def as_promised(result, returns):
    """The result as float64 arrays of exactly the shapes that the grader fixed."""
    parts = result if returns.sequence else (result,)
    if returns.sequence:
        try:
            parts = list(parts)
        except TypeError:
            raise WrongShape(f"returned {_describe(result)}, not {_promise(returns)}") from None
        if len(parts) != len(returns.shapes):
            raise WrongShape(f"returned {len(parts)} values, not {_promise(returns)}")
    arrays = []
    for part, shape in zip(parts, returns.shapes, strict=True):
        try:
            array = np.asarray(part)
        except ValueError:
            raise WrongShape(f"returned a ragged sequence, not {_promise(returns)}") from None
        if array.dtype.kind not in "biuf" or array.shape != shape:
            raise WrongShape(f"returned {_describe(part)}, not {_promise(returns)}")
        arrays.append(np.ascontiguousarray(array, dtype="<f8"))
    return arrays


def _promise(returns):
    shapes = [f"shape {shape}" if shape else "a number" for shape in returns.shapes]
    if not returns.sequence:
        return f"an array of {shapes[0]}" if returns.shapes[0] else "a number"
    return f"{len(shapes)} arrays of " + (shapes[0] if len(set(shapes)) == 1 else ", ".join(shapes))


def _describe(value):
    array = value if isinstance(value, np.ndarray) else None
    if array is None and isinstance(value, (list, tuple, int, float, np.generic)):
        with contextlib.suppress(ValueError):
            array = np.asarray(value)
    if array is None or array.dtype.kind not in "biufc":
        return f"a value of type {type(value).__name__}"
    kind = "complex numbers" if array.dtype.kind == "c" else "numbers"
    return f"an array of {kind} of shape {array.shape}" if array.shape else "a single number"


def sentence(failure) -> str:
    """An exception in one line; one whose text cannot be had is named."""
    try:
        text = str(failure)
    except BaseException:
        text = ""
    return f"{type(failure).__name__}: {text}" if text else type(failure).__name__


def forbid(modules, task) -> dict:
    """Let what these modules of the framework offer raise by name; the dict undoes it, handed to `allow`."""
    before = {f"framework.{name}": sys.modules.get(f"framework.{name}") for name in modules}
    kept = dict(vars(framework))
    for name in modules:
        sys.modules[f"framework.{name}"] = vars(framework)[name] = _Forbidden(name, task)
        for public, home in framework._HOME.items():
            if home == name:
                vars(framework).pop(public, None)
    return {"modules": before, "names": kept}


def allow(before):
    """Undo `forbid`."""
    for name, module in before["modules"].items():
        if module is None:
            del sys.modules[name]
        else:
            sys.modules[name] = module
    vars(framework).clear()
    vars(framework).update(before["names"])


class _Forbidden(types.ModuleType):
    """Stands where a module of the framework would answer the task."""

    def __init__(self, name, task):
        super().__init__(f"framework.{name}")
        self._task = task

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        text = f"{self.__name__}.{name} would answer the task: it is not available while {self._task} is judged"

        def refuse(*_, **__):
            raise RuntimeError(text)

        return refuse
