"""Results that outlive a frame: filtered maps, tables, grids, kept by the content that they were made of."""

import hashlib
from collections import OrderedDict
from weakref import WeakKeyDictionary

import numpy as np

_LIMIT = 512 * 2**20  # bytes


class Cache:
    """The most recently used results, up to a number of bytes."""

    def __init__(self, limit=_LIMIT):
        self._limit, self._size = limit, 0
        self._kept: OrderedDict = OrderedDict()

    def find(self, key):
        """What was kept under the key; None where nothing is."""
        if key not in self._kept:
            return None
        self._kept.move_to_end(key)
        return self._kept[key][0]

    def keep(self, key, value):
        """Keep a value, at the expense of those that were not used for longest; returns it."""
        self._size += _bytes(value) - self._kept.get(key, (None, 0))[1]
        self._kept[key] = value, _bytes(value)
        self._kept.move_to_end(key)
        while self._size > self._limit and len(self._kept) > 1:
            self._size -= self._kept.popitem(last=False)[1][1]
        return value

    def clear(self):
        """Forget everything."""
        self._kept.clear()
        self._size = 0


_digests: WeakKeyDictionary = WeakKeyDictionary()


def digest(holder, *arrays):
    """A hash of the read-only arrays of an object, which is computed once for each object."""
    if holder not in _digests:
        content = hashlib.blake2b(digest_size=16)
        for array in arrays:
            if array is not None:
                content.update(f"{array.shape}{array.dtype}".encode())
                content.update(np.ascontiguousarray(array).data)
        _digests[holder] = content.digest()
    return _digests[holder]


def mesh_digest(mesh):
    """A hash of what the renderer uses of a mesh."""
    return digest(mesh, mesh.vertices, mesh.faces, mesh.normals)


def _bytes(value):
    """About what a value holds in arrays."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, list | tuple):
        return sum(map(_bytes, value))
    return sum(map(_bytes, vars(value).values())) if hasattr(value, "__dict__") else 64
