"""The rendering equation itself, sampled until it can serve as truth: the twin of `split_sum.monte_carlo_shade`."""

import numpy as np


def monte_carlo_shade(env, normal, view, r0, alpha, samples, rng):
    """Light that a rough mirror reflects to the viewer, without shadows, and how sure that is.

    Parameters
    ----------
    env : framework.Environment
    normal, view : (N, 3) float            unit vectors
    r0 : float, (3,) or (N, 3) float       reflectance at normal incidence
    alpha : float or (N,) float            width, roughness squared; at least 1e-4 is used
    samples : int                          directions for each point
    rng : numpy.random.Generator           one draw of it seeds the streams of all points

    Returns
    -------
    mean : (N, 3) float                    radiance, right on average; 0 where the view is at or below the horizon
    standard_error : (N, 3) float          of the mean; inf for a single sample

    Notes
    -----
    Visible normals (Dupuy & Benyoub 2023). The same for any number of threads.
    """
    from solutions.fast.monte_carlo_kernel import estimate
    from solutions.fast.shade import pack

    if int(samples) != samples or samples < 1:
        raise ValueError(f"monte_carlo_shade: samples is {samples!r}; want a whole number of at least 1")
    normal, view, r0 = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in (normal, view, r0)))
    shape = normal.shape
    normal, view, r0 = (np.ascontiguousarray(value).reshape(-1, 3) for value in (normal, view, r0))
    alpha = np.broadcast_to(np.maximum(np.asarray(alpha, dtype=float), 1e-4), shape[:-1]).reshape(-1)
    mean, error = np.empty(normal.shape), np.empty(normal.shape)
    seed = np.uint64(rng.integers(2**63))
    texels, starts, heights = pack([env.pixels])
    estimate(
        texels,
        starts,
        heights,
        np.zeros(1),
        normal,
        view,
        r0,
        np.ascontiguousarray(alpha),
        int(samples),
        seed,
        mean,
        error,
    )
    return mean.reshape(shape), error.reshape(shape)
