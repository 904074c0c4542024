"""Builds the small maps that lie beside the notebooks: `python -m solutions.lights`."""

from pathlib import Path

import numpy as np

import framework as fw
from solutions.prefilter import irradiance, prefilter_chain
from solutions.split_sum import brdf_lut

DATA = Path(__file__).parent / "data"
ROUGHNESS_LEVELS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)
HEIGHTS = (64, 64, 64, 32, 32, 32, 16, 16, 16)


def small_sky(height):
    """The course's photographed sky with that many rows: a `framework.Environment` that keeps all light."""
    import warnings

    path = Path(fw.__file__).parent / "data" / "sky_512x256.exr"
    with warnings.catch_warnings():
        # The file rings below zero beside the sun, as lossy ones do.
        warnings.simplefilter("ignore", UserWarning)
        return fw.Environment.load(path).resized(height)


def build(path, brightest=np.inf):
    """Write the sky, filtered and ready for shading, as `framework.EnvironmentLight` to an `.npz` file.

    Parameters
    ----------
    path : str or Path      its folder must exist
    brightest : float       pixels above it are clamped: without a sun, Monte Carlo converges while one waits

    Returns
    -------
    framework.EnvironmentLight      what was written
    """
    env = fw.Environment(np.minimum(small_sky(64).pixels, brightest))
    chain = prefilter_chain(env, ROUGHNESS_LEVELS, HEIGHTS, 1024)
    light = fw.EnvironmentLight(env, irradiance(env, 16), chain, ROUGHNESS_LEVELS, brdf_lut(64, 4096))
    light.save(path)
    return light


if __name__ == "__main__":
    for name in ("prefilter", "split_sum", "environment_shadows"):
        (DATA / name).mkdir(parents=True, exist_ok=True)
    fw.write_image(DATA / "prefilter" / "sky.exr", small_sky(32).pixels)
    build(DATA / "split_sum" / "light.npz", brightest=10.0)
    build(DATA / "environment_shadows" / "light.npz")
