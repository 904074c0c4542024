"""Bounds on what the grader computes because a student's process asks for it: its arguments are a stranger's."""

from __future__ import annotations

import contextlib
import functools
import signal
import sys
import threading
import time

SPARE_BYTES = 2 << 30


@contextlib.contextmanager
def bounded(deadline, late):
    """Run a block with 2 GiB more memory than is in use now, until `deadline` at the longest.

    Parameters
    ----------
    deadline : float        on the monotonic clock
    late : callable         makes the exception to raise after it

    Notes
    -----
    Above the memory there is a MemoryError (on Linux). Time is watched in the main thread, where processes that grade
    do their work; a single operation on arrays is not interrupted, but its size is bounded by the memory.
    """
    with _memory(), _time(deadline, late):
        yield


@contextlib.contextmanager
def _time(deadline, late):
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "setitimer"):
        yield
        return

    def ring(*_):
        raise late()

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, max(deadline - time.monotonic(), 1e-3))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@contextlib.contextmanager
def _memory():
    if sys.platform != "linux":
        yield
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = min(x for x in (soft, hard, _in_use() + SPARE_BYTES) if x != resource.RLIM_INFINITY)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _in_use():
    return _in_use_at(int(time.monotonic()))


@functools.lru_cache(maxsize=1)
def _in_use_at(second):
    """Bytes of address space; asked for once a second, since a served call takes less than the question."""
    with open("/proc/self/statm") as file:
        import resource

        return int(file.read().split()[0]) * resource.getpagesize()
