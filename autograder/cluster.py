"""The units of a batch on a Dask cluster: bytes go there, results and pictures come back; no file system is shared.

Each worker judges in a process of its own below it, whose main thread can watch the time, and which stays warm from
one unit to the next.
"""

from __future__ import annotations

import contextlib
import pickle
import subprocess
import sys
import threading
from functools import partial

from autograder import sandbox
from autograder.batch import Place
from autograder.judge import versions
from autograder.usage import Usage

_here = threading.local()


@contextlib.contextmanager
def connect(address):
    """The place of `batch.run` that is the cluster whose scheduler listens at `address`.

    Raises
    ------
    Usage       where nobody answers, no worker is there, or a worker has another release of the course
    """
    try:
        from distributed import Client
    except ImportError:
        raise Usage("grading on a cluster needs dask: pip install .[cluster]") from None
    try:
        client = Client(address, timeout=10)
    except (OSError, ValueError) as problem:
        raise Usage(f"no scheduler answers at {address}: {problem}") from None
    with client:
        client.wait_for_workers(1, timeout=30)
        found = client.run(_described)
        ours = versions()
        for worker, (_, theirs) in found.items():
            for name in ("course_version", "tolerances"):
                if theirs[name] != ours[name]:
                    raise Usage(f"the worker {worker} has {name} {theirs[name]}, and this machine {ours[name]}")
        weakest = max((level for level, _ in found.values()), key=sandbox.STRENGTH.index)
        executor = client.get_executor(pure=False, retries=3)
        yield Place(weakest, 2 * sum(client.nthreads().values()), partial(executor.submit, judge))


def judge(unit, block, job, before):
    """`unit.judge` in a process below the worker's, started anew where it has died."""
    child = getattr(_here, "child", None)
    if child is None or child.poll() is not None:
        command = [sys.executable, "-c", "from autograder.cluster import serve; serve()"]
        child = _here.child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    to, back = child.stdin, child.stdout
    assert to is not None and back is not None
    pickle.dump((unit, block, job, before), to)
    to.flush()
    answer = pickle.load(back)
    if isinstance(answer, BaseException):
        raise answer
    return answer


def serve():
    """Judge what arrives on standard input, until it ends."""
    import os

    from autograder import unit

    # What a library prints must not get between the answers.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while True:
        try:
            work = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            pickle.dump(unit.judge(*work), answers)
        except Exception as failure:
            pickle.dump(failure, answers)
        answers.flush()


def _described():
    return sandbox.strongest_level(), versions()
