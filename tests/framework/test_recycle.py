"""Memory that is used again: never while anything refers to it, and never without bound."""

import gc

import numpy as np
import pytest

from framework import recycle


@pytest.fixture(autouse=True)
def nothing_idle():
    recycle._idle.clear()


def address(array):
    return array.__array_interface__["data"][0]


def test_memory_is_used_again_for_the_same_size_in_another_shape():
    first = recycle.empty((64, 32, 3))
    where = address(first)
    del first
    assert address(recycle.empty((32, 64, 3))) == where


def test_what_a_view_refers_to_is_not_used_again():
    first = recycle.empty((16, 16, 3))
    first[:] = 7.0
    view = first[2:4, :, 1].T
    del first
    gc.collect()
    second = recycle.empty((16, 16, 3))
    second[:] = 1.0
    assert not np.shares_memory(view, second) and (view == 7.0).all()


def test_an_array_is_an_ordinary_one():
    array = recycle.empty((4, 5))
    assert array.dtype == np.float64 and array.flags.c_contiguous and array.flags.writeable and array.shape == (4, 5)


def test_idle_memory_has_a_bound(monkeypatch):
    monkeypatch.setattr(recycle, "_IDLE_BYTES", 3 * 8000)
    arrays = [recycle.empty((1000,)) for _ in range(10)]
    del arrays
    assert sum(memory.nbytes for memory in recycle._idle) == 3 * 8000
