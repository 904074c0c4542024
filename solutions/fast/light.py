"""An environment made ready for shading, in half a second."""

from functools import cache

import numpy as np

import framework as fw
from solutions.fast.lut import brdf_lut
from solutions.fast.prefilter import irradiance, prefilter_chain

# Level i: between neighbours, linear interpolation in roughness is closest where narrow lobes change the most.
_ROUGHNESS = (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0)


def environment_light(env):
    """What shading by the split sum needs of an environment.

    Parameters
    ----------
    env : framework.Environment

    Returns
    -------
    framework.EnvironmentLight      11 levels; each as fine as its lobe needs, and no finer than the environment
    """
    heights = [_rows(roughness**2, env.height) for roughness in _ROUGHNESS]
    chain = prefilter_chain(env, _ROUGHNESS, heights)
    return fw.EnvironmentLight(env, irradiance(env, min(env.height, 32)), chain, _ROUGHNESS, _lut())


def _rows(alpha, height):
    """Rows of a level: the lobe's half width, 2 alpha, takes at least three of them; 32 or more, or all."""
    needed = height if alpha == 0.0 else int(np.ceil(3.0 * np.pi / (2.0 * alpha)))
    return min(height, max(needed, 32))


@cache
def _lut():
    lut = brdf_lut(128)
    lut.flags.writeable = False
    return lut
