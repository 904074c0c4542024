"""Arrays whose memory is used again once nobody holds them.

The system hands out a large array as pages that it clears one by one when they are first touched: for the position and
the normal of a megapixel that takes longer than to fill them (5 of 17 ms, measured). Frames ask for the same sizes
over and over.
"""

import math
import threading

import numpy as np

_IDLE_BYTES = 128 << 20  # how much memory may wait for its next use
_LOCK = threading.RLock()  # arrays also die within it, where the garbage collector runs
_idle: list[np.ndarray] = []


def empty(shape):
    """As `numpy.empty(shape)`, float64; its memory comes from an array that has died, where one of that size has."""
    size = math.prod(shape)
    for memory in reversed(_idle.copy()):
        if len(memory) == size and _taken(memory):
            return np.asarray(_Lease(memory, shape))
    return np.asarray(_Lease(np.empty(size), shape))


def _taken(memory):
    """Whether this thread is the one that gets it."""
    with _LOCK:
        for i, waiting in enumerate(_idle):
            if waiting is memory:
                del _idle[i]
                return True
    return False


class _Lease:
    """Owns the memory while an array, or a view of it, refers to it."""

    def __init__(self, memory, shape):
        self._memory = memory
        self.__array_interface__ = memory.__array_interface__ | {"shape": tuple(shape)}

    def __del__(self, idle=_idle, lock=_LOCK):
        with lock:
            idle.append(self._memory)
            while sum(memory.nbytes for memory in idle) > _IDLE_BYTES:
                idle.pop(0)
