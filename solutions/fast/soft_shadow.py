"""The compiled twin of `soft_shadows.soft_shadow`."""

import functools
import os
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np

from framework.arrays import as_vector
from framework.render_functions import reads_trees
from framework.tape import compiled
from solutions import soft_shadows


@reads_trees
def soft_shadow(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """How much of the light is seen, from the smallest penumbra along one ray.

    Parameters
    ----------
    sdf : framework.sdf node        another callable is marched through by the reference
    origin : (N, 3) float           neighbours are marched together: keep them together
    to_light : (3,) or (N, 3) float unit; one for each point by the reference, too
    k : float                       1 / sin(angular radius of the light)
    t_min, t_max : float            where the march starts and ends, scene units along the ray
    max_steps : int                 of the reference; this one has 512

    Returns
    -------
    (N,) float64 in [0, 1]
    """
    origin = np.asarray(origin, float)
    try:
        tape = compiled(sdf)
    except ValueError:
        tape = None
    if tape is None or np.ndim(to_light) > 1 or origin.ndim != 2:
        return soft_shadows.soft_shadow(sdf, origin, to_light, k, t_min, t_max, max_steps)
    from solutions.fast.soft_shadow_kernels import soft_shadows as march

    light = np.array([*as_vector(to_light, "soft_shadow: to_light"), k, 0.0, t_min, t_max], float)
    origin, visibility = np.ascontiguousarray(origin), np.empty(len(origin))
    threads = numba.get_num_threads()
    rest = threads, tape.arrays, tape.depth, origin, light, visibility
    jobs = [_pool().submit(march, thread, *rest) for thread in range(1, threads)]
    march(0, *rest)
    for job in jobs:
        job.result()
    return visibility


@functools.cache
def _pool():
    return ThreadPoolExecutor(os.cpu_count())
