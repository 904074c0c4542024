"""The table of the split sum by quadrature: the twin of `split_sum.brdf_lut`."""

import numpy as np

# Nodes in tilt and in azimuth, on each side of the horizon: at 128 x 128 the table's error is below 3e-6 for
# roughness >= 0.02 and mu >= 1/64, and below 2e-5 elsewhere.
_TILTS, _AZIMUTHS = 24, 12


def brdf_lut(size):
    """The second half of the split sum: reflection under a white sky, as scale and bias of r0.

    Parameters
    ----------
    size : int                      rows (roughness) and columns (cosine of the view), at (i + 0.5) / size

    Returns
    -------
    (size, size, 2) float           scale and bias: white-sky reflection = r0 scale + bias

    Raises
    ------
    ValueError : size is no whole number of at least 1.

    Notes
    -----
    Karis 2013; GGX, height-correlated Smith, F at v.h. Gauss-Legendre nodes over the half vector, no samples.
    """
    from solutions.fast.lut_kernel import integrate

    if int(size) != size or size < 1:
        raise ValueError(f"brdf_lut: size is {size!r}; want a whole number of at least 1")
    x, w = _nodes(_TILTS)
    # Closer at both ends: there the arc of azimuths opens and shuts like a square root.
    rows = np.stack([x * x * (3.0 - 2.0 * x), 6.0 * w * x * (1.0 - x)])
    lut = np.empty((int(size), int(size), 2))
    integrate(rows, np.stack(_nodes(_AZIMUTHS)), lut)
    return lut


def _nodes(count):
    """Gauss-Legendre nodes and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w
