"""Vectors as NumPy arrays: products, unit vectors, frames, and checks of arguments that other modules share.

A vector is the last axis of an array, of length 3; everything before it is the batch, which may be empty.
"""

import numpy as np


def dot(a, b):
    """Scalar product over the last axis: `(..., 3)`, `(..., 3) -> (...)`, the batches broadcast."""
    return np.einsum("...i,...i->...", np.asarray(a, float), np.asarray(b, float))


def normalize(v):
    """Unit vectors along `v`.

    Parameters
    ----------
    v : (..., 3) float          of any length between the smallest and the largest float64

    Returns
    -------
    (..., 3) float64            length 1; zeros where `v` is zero
    """
    v = np.asarray(v, float)
    # Squares of 1e-200 and 1e200 leave the range of float64: bring the largest component to 1 first.
    peak = np.abs(v).max(axis=-1, keepdims=True)
    scaled = v / np.where(peak > 0, peak, 1.0)
    length = np.sqrt(dot(scaled, scaled))[..., None]
    return scaled / np.where(length > 0, length, 1.0)


def reflect(direction_to_viewer, normal):
    """Mirror a direction about the normal: `2 (n . v) n - v`.

    Both point away from the surface, and so does the result, towards the mirror image of the viewer.

    Parameters
    ----------
    direction_to_viewer, normal : (..., 3) float, unit, broadcast against each other

    Returns
    -------
    (..., 3) float64, unit
    """
    view, normal = np.asarray(direction_to_viewer, float), np.asarray(normal, float)
    return 2.0 * dot(normal, view)[..., None] * normal - view


def orthonormal_frame(n):
    """Two tangents that make a right-handed frame `(tangent, bitangent, n)` with each normal.

    Parameters
    ----------
    n : (..., 3) float, unit

    Returns
    -------
    tangent, bitangent : (..., 3) float64, unit, orthogonal to `n`, `tangent x bitangent = n`

    Notes
    -----
    Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017: no direction is near-singular,
    the poles included, because the denominator `|sign + z|` is at least 1.
    """
    x, y, z = np.moveaxis(np.asarray(n, float), -1, 0)
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    tangent = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    bitangent = np.stack([b, sign + y * y * a, -y], axis=-1)
    return tangent, bitangent


def as_vectors(value, name):
    """`value` as finite float64 vectors `(..., 3)`; a ValueError that names the argument where it is none."""
    vectors = _as_numbers(value, name)
    if vectors.ndim == 0 or vectors.shape[-1] != 3:
        raise ValueError(f"{name} has shape {vectors.shape}; vectors of shape (..., 3) are wanted")
    _refuse_nonfinite(vectors, name)
    return vectors


def as_vector(value, name):
    """`value` as one finite float64 vector `(3,)`; a ValueError that names the argument where it is none."""
    vector = as_vectors(value, name)
    if vector.shape != (3,):
        raise ValueError(f"{name} has shape {vector.shape}; one vector of shape (3,) is wanted")
    return vector


def as_number(value, name, low=-np.inf, high=np.inf):
    """`value` as a finite float in [low, high]; a ValueError that names the argument where it is none."""
    number = _as_numbers(value, name)
    if number.ndim:
        raise ValueError(f"{name} has shape {number.shape}; one number is wanted")
    _refuse_nonfinite(number, name)
    if not low <= number <= high:
        raise ValueError(f"{name} is {float(number):g}; a number {_interval(low, high)} is wanted")
    return float(number)


def as_positive(value, name):
    """`value` as a finite float above zero; a ValueError that names the argument where it is none."""
    number = as_number(value, name)
    if number <= 0:
        raise ValueError(f"{name} is {number:g}; a number above 0 is wanted")
    return number


def _as_numbers(value, name):
    try:
        raw = np.asarray(value)
    except ValueError:
        raise ValueError(f"{name} is a ragged sequence; an array of numbers is wanted") from None
    if raw.dtype.kind not in "biuf":
        raise ValueError(f"{name} is {type(value).__name__} of dtype {raw.dtype}; real numbers are wanted")
    return raw.astype(float)


def _refuse_nonfinite(array, name):
    bad = np.count_nonzero(~np.isfinite(array))
    if bad:
        raise ValueError(
            f"{name} holds {bad} values that are NaN or infinite, of {array.size}; finite ones are wanted"
        )


def _interval(low, high):
    if np.isinf(high):
        return f"of at least {low:g}"
    return f"of at most {high:g}" if np.isinf(low) else f"from {low:g} to {high:g}"
