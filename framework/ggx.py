"""Half vectors of the GGX distribution."""

import numpy as np


def sample_ggx(xi, alpha):
    """Half vectors about +z with the density of the normals that GGX describes.

    Parameters
    ----------
    xi : (N, 2) float in [0, 1)     azimuth from the first column, elevation from the second
    alpha : float or (N,) float     width, above 0: roughness squared

    Returns
    -------
    (N, 3) float, unit, z >= 0; density D(h) (n.h) per steradian

    Raises
    ------
    ValueError : shapes or ranges other than these.

    Notes
    -----
    The elevation inverts the distribution in closed form: tan^2 = alpha^2 u / (1 - u) (Walter et al. 2007,
    eq. 35). No sine comes from 1 - cos^2, which would lose the shape of narrow lobes.
    """
    xi, alpha = np.asarray(xi, dtype=np.float64), np.asarray(alpha, dtype=np.float64)
    if xi.ndim != 2 or xi.shape[1] != 2:
        raise ValueError(f"sample_ggx: xi has shape {xi.shape}; want (N, 2)")
    if alpha.shape not in ((), (len(xi),)):
        raise ValueError(f"sample_ggx: alpha has shape {alpha.shape}; want a number or ({len(xi)},)")
    if not ((xi >= 0) & (xi < 1)).all():
        raise ValueError("sample_ggx: xi has values outside [0, 1)")
    if not (alpha > 0).all() or not np.isfinite(alpha).all():
        raise ValueError("sample_ggx: alpha must be above 0 and finite")
    phi, u = 2 * np.pi * xi[:, 0], xi[:, 1]
    # tan = alpha sqrt(u) / sqrt(1 - u): sine and cosine up to their common length.
    sine, cosine = alpha * np.sqrt(u), np.sqrt(1 - u)
    length = np.hypot(sine, cosine)
    sine, cosine = sine / length, cosine / length
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1)
