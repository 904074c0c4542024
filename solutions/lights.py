"""Builds the small maps that lie beside the notebooks: `python -m solutions.lights`."""

from pathlib import Path

import numpy as np

import framework as fw
from solutions.prefilter import irradiance, prefilter_chain
from solutions.split_sum import brdf_lut
from solutions.split_sum_error import maps

DATA = Path(__file__).parent / "data"
ROUGHNESS_LEVELS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)
HEIGHTS = (64, 64, 64, 32, 32, 32, 16, 16, 16)
LOW_HEIGHTS = (32, 32, 32, 16, 16, 16, 16, 16, 16)


def small_sky(height):
    """The course's photographed sky with that many rows: a `framework.Environment` that keeps all light."""
    import warnings

    path = Path(fw.__file__).parent / "data" / "sky_512x256.exr"
    with warnings.catch_warnings():
        # The file rings below zero beside the sun, as lossy ones do.
        warnings.simplefilter("ignore", UserWarning)
        return fw.Environment.load(path).resized(height)


def build(path, env, heights=HEIGHTS):
    """Write an environment, filtered and ready for shading, as `framework.EnvironmentLight` to an `.npz` file.

    Parameters
    ----------
    path : str or Path      its folder must exist
    env : framework.Environment
    heights : sequence of int       rows of the map for each of `ROUGHNESS_LEVELS`

    Returns
    -------
    framework.EnvironmentLight      what was written
    """
    chain = prefilter_chain(env, ROUGHNESS_LEVELS, heights, 1024)
    light = fw.EnvironmentLight(env, irradiance(env, 16), chain, ROUGHNESS_LEVELS, brdf_lut(64, 4096))
    light.save(path)
    return light


if __name__ == "__main__":
    for name in ("prefilter", "split_sum", "environment_shadows"):
        (DATA / name).mkdir(parents=True, exist_ok=True)
    sky = small_sky(64)
    fw.write_image(DATA / "prefilter" / "sky.exr", small_sky(32).pixels)
    build(DATA / "environment_shadows" / "light.npz", sky)
    # Without a sun, Monte Carlo converges while one waits.
    build(DATA / "split_sum" / "light.npz", fw.Environment(np.minimum(sky.pixels, 10.0)))
    build(DATA / "split_sum" / "studio.npz", maps(rows=32)["photo: studio"], LOW_HEIGHTS)
