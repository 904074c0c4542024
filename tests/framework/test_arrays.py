import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework.arrays import as_number, as_positive, as_vector, as_vectors, dot

POLES = np.array([[0, 0, 1], [0, 0, -1], [0, 0, -0.0], [0, 1, 0], [1, 0, 0], [-1, 0, 0]], float)


def directions(count, seed=1):
    v = np.random.default_rng(seed).normal(size=(count, 3))
    return v / np.sqrt((v**2).sum(axis=1, keepdims=True))


@pytest.mark.parametrize("shape", [(3,), (0, 3), (5, 3), (2, 0, 3), (2, 4, 3)])
def test_batches_of_any_shape_keep_their_shape(shape):
    v = np.random.default_rng(0).normal(size=shape)
    assert dot(v, v).shape == shape[:-1]
    assert fw.normalize(v).shape == shape
    assert fw.reflect(v, v).shape == shape
    assert [t.shape for t in fw.orthonormal_frame(fw.normalize(v))] == [shape, shape]


def test_dot_broadcasts_and_takes_integers():
    assert_array_equal(dot([[1, 2, 3], [4, 5, 6]], [1, 0, -1]), [-2, -2])


@pytest.mark.parametrize("length", [5e-324, 1e-310, 1e-200, 1e-8, 1.0, 1e200, 1.7e308])
def test_normalize_survives_any_length(length):
    expected = np.array([2.0, -1.0, 2.0]) / 3
    if length > 1e-300:
        assert_allclose(fw.normalize(expected * length), expected, rtol=1e-14)
    assert_array_equal(fw.normalize([0, 0, -length]), [0, 0, -1])


def test_normalize_leaves_zero_vectors_zero_and_its_input_alone():
    v = np.array([[0.0, 0, 0], [0, 3, 4]])
    assert_array_equal(fw.normalize(v), [[0, 0, 0], [0, 0.6, 0.8]])
    assert_array_equal(v, [[0, 0, 0], [0, 3, 4]])


def test_reflect_mirrors_about_the_normal():
    assert_allclose(fw.reflect([1, 2, 3], [0, 1, 0]), [-1, 2, -3])
    view, normal = directions(100), directions(100, seed=2)
    mirrored = fw.reflect(view, normal)
    assert_allclose(dot(mirrored, mirrored), 1, rtol=1e-14)
    assert_allclose(dot(mirrored, normal), dot(view, normal), atol=1e-15)
    assert_allclose(np.cross(view + mirrored, normal), 0, atol=1e-15)  # the three lie in one plane
    assert_allclose(fw.reflect(mirrored, normal), view, atol=1e-15)


def test_frames_are_right_handed_and_orthonormal_everywhere():
    near_poles = fw.normalize([[1e-9, -1e-9, -1], [1e-160, 0, -1], [1e-5, 1e-5, 1]])
    n = np.concatenate([POLES[[0, 1, 3, 4, 5]], near_poles, directions(1000)])
    tangent, bitangent = fw.orthonormal_frame(n)
    frame = np.stack([tangent, bitangent, n], axis=1)
    assert_allclose(frame @ frame.transpose(0, 2, 1), np.broadcast_to(np.eye(3), frame.shape), atol=2e-15)
    assert_allclose(np.cross(tangent, bitangent), n, atol=2e-15)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: as_vectors([1, 2], "p"), "p has shape (2,); vectors of shape (..., 3) are wanted"),
        (lambda: as_vectors(7, "p"), "p has shape (); vectors of shape (..., 3) are wanted"),
        (
            lambda: as_vectors([[0, np.nan, np.inf]], "p"),
            "p holds 2 values that are NaN or infinite, of 3; finite ones are wanted",
        ),
        (lambda: as_vectors("abc", "p"), "p is str of dtype <U3; real numbers are wanted"),
        (lambda: as_vectors([[1, 2, 3], [1]], "p"), "p is a ragged sequence; an array of numbers is wanted"),
        (lambda: as_vectors([1j, 0, 0], "p"), "p is list of dtype complex128; real numbers are wanted"),
        (lambda: as_vector(np.zeros((2, 3)), "p"), "p has shape (2, 3); one vector of shape (3,) is wanted"),
        (lambda: as_number([1], "k"), "k has shape (1,); one number is wanted"),
        (lambda: as_number(2, "t", 0, 1), "t is 2; a number from 0 to 1 is wanted"),
        (lambda: as_number(-1, "t", low=0), "t is -1; a number of at least 0 is wanted"),
        (lambda: as_positive(0, "k"), "k is 0; a number above 0 is wanted"),
    ],
)
def test_bad_arguments_are_refused_in_one_sentence(call, sentence):
    with pytest.raises(ValueError) as refusal:
        call()
    assert str(refusal.value) == sentence


def test_checked_vectors_are_fresh_float64():
    given = np.zeros((2, 3), np.float32)
    checked = as_vectors(given, "p")
    assert checked.dtype == np.float64 and not np.shares_memory(checked, given)
    assert as_vectors(np.zeros((0, 3)), "p").shape == (0, 3)
