"""The compiled twin of `split_sum.microfacet_brdf`."""

import numpy as np

from framework import recycle
from solutions import split_sum


def microfacet_brdf(normal, view, to_light, r0, alpha):
    """What a surface of microfacets reflects from one direction to another.

    Parameters
    ----------
    normal, view : (N, 3) float     unit vectors
    to_light : (3,) or (N, 3) float unit vectors
    r0 : float, (3,) or (N, 3) float    reflectance at normal incidence
    alpha : float or (N,) float     width of the GGX lobe

    Returns
    -------
    (N, 3) float    per steradian; 0 where either cosine is at or below 0. Many points under one light with one r0 and
                    alpha are computed by one loop, others by the reference
    """
    shape = np.shape(normal)
    if (
        shape != np.shape(view)
        or len(shape) != 2
        or np.ndim(to_light) > 1
        or np.ndim(r0) > 1
        or np.ndim(alpha)
    ):
        return split_sum.microfacet_brdf(normal, view, to_light, r0, alpha)
    from solutions.fast.microfacet_kernel import microfacet

    normal, view = (np.ascontiguousarray(v, dtype=float) for v in (normal, view))
    toward, color = np.array(to_light, dtype=float), recycle.empty(shape)
    microfacet(normal, view, toward, np.broadcast_to(r0, 3).astype(float), max(float(alpha), 1e-4), color)
    return color
