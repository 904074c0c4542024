"""The wall's protocol: whatever a student's side sends, the grader answers with a result or a Failure, in time."""

import os
import pickle
import re
import signal
import socket
import struct
import sys
import threading
import time

import numpy as np
import pytest

from autograder import wall
from autograder.sandbox import Limits
from autograder.student import Failure, Remote

SHAPE = (7,)
ANSWER = np.linspace(0, 1, 7)
VALUE = wall.HEADER.pack(wall.VALUE, 0, 1, 0) + ANSWER.astype("<f8").tobytes()
CALL = wall.pack_call(0, [(wall.ARRAY, np.ones((2, 3)))])
ERROR = wall.HEADER.pack(wall.ERROR, wall.EXCEPTION, 0, 0) + wall.pack_text("it failed", "line 1")


class Box:
    """Stands for the sandbox: no output to keep flowing, short limits."""

    limits = Limits(call_wall_seconds=0.3, submission_seconds=10)

    def readable(self, link, deadline):
        link.settimeout(max(deadline - time.monotonic(), 0.001))
        try:
            return link.recv(1, socket.MSG_PEEK) is not None
        except TimeoutError:
            return False
        except OSError:
            return True


def answer_to(reply, served=None, close=True):
    """What the grader makes of a student's side that sends these bytes whatever it is asked."""
    ours, theirs = socket.socketpair()
    ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 20)
    with ours, theirs:
        theirs.sendall(reply)
        if close:
            theirs.shutdown(socket.SHUT_WR)
        lower = {"sdf": served or (lambda p: np.linalg.norm(p, axis=-1))}
        remote = Remote(Box(), ours, lower, time.monotonic() + 10)
        return remote.call("f", [np.ones(7)], wall.Returns((SHAPE,)))


def judged(reply, **how):
    begun = time.monotonic()
    try:
        (value,) = answer_to(reply, **how)
        assert value.shape == SHAPE and value.dtype == float
        return "value"
    except Failure as failure:
        assert failure.status in ("crashed", "timeout", "error", "out_of_memory", "not_attempted")
        assert "\n" not in failure.message
        return failure.status
    finally:
        assert time.monotonic() - begun < 2


def test_a_right_answer_comes_through_to_the_bit():
    np.testing.assert_array_equal(answer_to(VALUE)[0], ANSWER)
    np.testing.assert_array_equal(answer_to(CALL + CALL + VALUE)[0], ANSWER)


def test_an_error_brings_its_texts():
    with pytest.raises(Failure) as said:
        answer_to(ERROR)
    assert (said.value.status, said.value.message, said.value.traceback) == ("error", "it failed", "line 1")


@pytest.mark.parametrize("stream", [VALUE, CALL + VALUE, ERROR[:40]], ids=["value", "call", "error"])
def test_garbage_at_every_byte_is_an_answer_or_a_failure(stream):
    rng = np.random.default_rng(0)
    for place in range(len(stream)):
        for byte in (0, 0xFF, int(rng.integers(256))):
            broken = bytearray(stream)
            broken[place] = byte
            judged(bytes(broken))


@pytest.mark.parametrize("stream", [VALUE, CALL + VALUE, ERROR], ids=["value", "call", "error"])
def test_a_stream_cut_anywhere_is_a_crash(stream):
    for end in [*range(0, min(len(stream), 200)), len(stream) - 1]:
        assert judged(stream[:end]) == "crashed"


def test_random_streams_are_failures():
    rng = np.random.default_rng(1)
    for size in rng.integers(1, 3000, 300):
        judged(rng.bytes(int(size)))


def test_silence_ends_at_the_deadline():
    assert judged(VALUE[:-1], close=False) == "timeout"


@pytest.mark.parametrize(
    "call",
    [
        wall.HEADER.pack(wall.CALL, 0, 65535, 0),
        wall.HEADER.pack(wall.CALL, 0, 1, 0) + wall.ARGUMENT.pack(wall.ARRAY, 4, *[2**32 - 1] * 4, 0),
        wall.HEADER.pack(wall.CALL, 0, 1, 0) + wall.ARGUMENT.pack(wall.ARRAY, 255, 1, 1, 1, 1, 0),
        wall.HEADER.pack(wall.CALL, 0, 1, 0) + wall.ARGUMENT.pack(99, 0, 0, 0, 0, 0, 0),
        wall.HEADER.pack(wall.CALL, 0, 2, 0) + 2 * wall.ARGUMENT.pack(wall.ARRAY, 2, 2**20, 3, 0, 0, 0),
    ],
    ids=["arguments", "size", "axes", "kind", "sum"],
)
def test_a_call_beyond_the_limits_is_refused_before_anything_is_allocated(call):
    assert judged(call + bytes(1000)) == "crashed"


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        [(wall.SERVED, 99)],
        [(wall.SERVED, -1)],
        [(wall.ARRAY, np.ones((2, 2)))],
        [(wall.ARRAY, np.ones(3)), (wall.ARRAY, np.ones(3))],
        [(wall.PIXELS, np.full((2, 3, 3), np.nan))],
        [(wall.SEED, -(2**62))],
        [(wall.ABSENT, None)],
        [(wall.INTEGER, 2**62)],
    ],
)
def test_arguments_that_a_function_refuses_are_told_to_the_student_alone(arguments):
    def picky(points):
        points = np.asarray(points, float)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError("points of shape (N, 3) are wanted")
        return points[:, 0]

    assert judged(wall.pack_call(0, arguments) + VALUE, served=picky) == "value"


def test_an_unknown_function_is_told_to_the_student_alone():
    for number in (1, 77, 2**32 - 1):
        assert judged(wall.pack_call(number, [(wall.ARRAY, np.ones((1, 3)))]) + VALUE) == "value"


def test_texts_with_bad_lengths_and_bytes_do_no_harm():
    for block in (bytes([255] * wall.TEXT.size), os.urandom(wall.TEXT.size), bytes(wall.TEXT.size)):
        message, traceback = wall.unpack_text(block)
        assert len(message) <= wall.MESSAGE_BYTES and len(traceback) <= wall.TRACEBACK_BYTES
    assert wall.unpack_text(wall.pack_text("é" * 5000, "x" * 50_000))[1] == "x" * wall.TRACEBACK_BYTES


def test_calls_without_end_end():
    """A student's side that calls back from within each call: the grader stops it, not Python's stack."""
    ours, theirs = socket.socketpair()

    def student():
        try:
            call = wall.pack_call(0, [(wall.LOCAL, 0)])
            theirs.sendall(call)
            while True:
                size = struct.unpack("<Q", theirs.recv(8, socket.MSG_WAITALL))[0]
                pickle.loads(theirs.recv(size, socket.MSG_WAITALL))
                theirs.sendall(call)
        except (OSError, struct.error):
            pass

    thread = threading.Thread(target=student, daemon=True)
    thread.start()
    box = Box()
    box.limits = Limits(call_wall_seconds=5, submission_seconds=10)
    with ours:
        remote = Remote(box, ours, {"f": lambda sdf: sdf(np.ones((1, 3)))}, time.monotonic() + 10)
        with pytest.raises(Failure) as said:
            remote.call("f", [np.ones(7)], wall.Returns((SHAPE,)))
    assert said.value.status == "crashed" and "deep" in said.value.message
    theirs.close()
    thread.join(5)


def test_garbage_while_cells_are_run_is_a_failure():
    """What comes before a task's functions are loaded passes through the same gate."""
    head = wall.HEADER.pack(wall.CELL, 0, 0, 0)
    streams = [
        head + wall.HEADER.pack(wall.CALL, 0, 65535, 0),
        head + VALUE,
        ERROR[:30],
        bytes(40),
        CALL[:20],
    ]
    streams += [np.random.default_rng(seed).bytes(200) for seed in range(100)]
    for stream in streams:
        ours, theirs = socket.socketpair()
        with ours, theirs:
            theirs.sendall(stream)
            theirs.shutdown(socket.SHUT_WR)
            with pytest.raises(Failure):
                Remote(Box(), ours, {"f": lambda p: p}, time.monotonic() + 10).load({})


def said_to_student(call, served, final=10.0):
    """What the student's side hears when it makes this call, or the grader's Failure."""
    ours, theirs = socket.socketpair()
    with ours, theirs:
        threading.Thread(target=theirs.sendall, args=(call + VALUE,), daemon=True).start()
        remote = Remote(Box(), ours, {"f": served}, time.monotonic() + final)
        try:
            remote.call("g", [np.ones(7)], wall.Returns((SHAPE,)))
        except Failure as failure:
            return failure.status, failure.message
        assert wall.receive(theirs)[0] == "call"
        return wall.receive(theirs)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux keeps the limit of the address space")
def test_a_request_for_three_gigabytes_fails_for_the_student_alone():
    wide, tall = (wall.ARRAY, np.zeros((1, 20_000))), (wall.ARRAY, np.zeros((20_000, 1)))
    kind, message = said_to_student(wall.pack_call(0, [wide, tall]), np.add)
    assert kind == "raise" and "MemoryError" in message


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="this system has no interval timer")
def test_a_request_that_never_ends_ends_with_the_submission():
    def march(sdf, steps):
        for _ in range(steps):
            sdf(np.ones((1, 3)))

    call = wall.pack_call(0, [(wall.SERVED, 1), (wall.INTEGER, 2**62)])
    begun = time.monotonic()
    ours, theirs = socket.socketpair()
    with ours, theirs:
        theirs.sendall(call)
        remote = Remote(Box(), ours, {"march": march, "sdf": lambda p: p[:, 0]}, time.monotonic() + 0.5)
        with pytest.raises(Failure) as said:
            remote.call("f", [np.ones(7)], wall.Returns((SHAPE,)))
    assert said.value.status == "timeout" and time.monotonic() - begun < 2
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_an_answer_that_cannot_be_sent_is_told_to_the_student_alone():
    kind, _ = said_to_student(wall.pack_call(0, [(wall.ABSENT, None)]), lambda _: lambda: None)
    assert kind == "raise"


def test_handles_reach_only_functions_that_are_served():
    for number in (-1, 1, 2**62):
        kind, message = said_to_student(
            wall.pack_call(0, [(wall.SERVED, number)]), lambda f: f(np.ones((1, 3)))
        )
        assert (kind, message) == ("raise", "ValueError: no such function")


def test_more_calls_than_any_task_needs_are_a_timeout(monkeypatch):
    monkeypatch.setattr("autograder.student.MAX_SERVED_CALLS", 20)
    assert judged(20 * CALL + VALUE) == "value"
    assert judged(21 * CALL + VALUE) == "timeout"


def test_an_error_in_a_function_of_the_students_ends_the_call_with_its_text():
    assert (
        judged(wall.pack_call(0, [(wall.LOCAL, 0)]) + ERROR, served=lambda f: f(np.ones((2, 3)))) == "error"
    )


@pytest.mark.parametrize("count", [0, 2, 65535])
def test_a_value_of_another_count_is_a_crash(count):
    assert judged(wall.HEADER.pack(wall.VALUE, 0, count, 0) + bytes(56 * max(min(count, 9), 1))) == "crashed"


@pytest.mark.parametrize(
    ("result", "words"),
    [
        (np.ones(6), "an array of numbers of shape (6,), not an array of shape (7,)"),
        (np.ones(7, complex), "complex numbers"),
        ([[1.0], [1.0, 2.0]], "ragged"),
        ("text", "type str"),
        (None, "type NoneType"),
        (np.array([None] * 7), "type ndarray"),
    ],
)
def test_a_result_of_another_shape_or_kind_is_described(result, words):
    with pytest.raises(wall.WrongShape, match=re.escape(words)):
        wall.as_promised(result, wall.Returns((SHAPE,)))
