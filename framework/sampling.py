"""Low-discrepancy points: sequences whose samples cover the square more evenly than random ones."""

import numpy as np


def van_der_corput(index):
    """Radical inverse in base 2: the bits of the index mirrored about the binary point.

    Parameters
    ----------
    index : (...) int, from 0 to 2^32 - 1

    Returns
    -------
    (...) float in [0, 1): 0, 1/2, 1/4, 3/4, 1/8, ...
    """
    bits = np.asarray(index)
    if bits.dtype.kind not in "iu" or (bits.size and (bits.min() < 0 or bits.max() >= 2**32)):
        raise ValueError("van_der_corput: index must be whole numbers from 0 to 2^32 - 1")
    bits = bits.astype(np.uint64)
    for shift, pattern in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF), (16, 0xFFFF)):
        mask = np.uint64(pattern)
        bits = ((bits & mask) << np.uint64(shift)) | ((bits >> np.uint64(shift)) & mask)
    return bits / 2.0**32


def hammersley(n, shift=(0.0, 0.0)):
    """The Hammersley set: n points (i / n, van_der_corput(i)), each axis turned by a shift.

    Parameters
    ----------
    n : int, at least 1
    shift : (2,) float      added to every point, modulo 1 (Cranley-Patterson rotation): with a random one,
        `rng.random(2)`, the mean over the points is unbiased

    Returns
    -------
    (n, 2) float in [0, 1)
    """
    if int(n) != n or n < 1:
        raise ValueError(f"hammersley: n is {n!r}; want a whole number of at least 1")
    index = np.arange(int(n))
    points = np.stack([index / int(n), van_der_corput(index)], axis=1) + np.asarray(shift, dtype=np.float64)
    # A sum just below a whole number may round up to it.
    return np.minimum(points % 1.0, np.nextafter(1.0, 0.0))
