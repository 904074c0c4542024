"""How run time grows with the work: what should be a power of one, and what grows more slowly."""

import functools

import numpy as np

import framework as fw
from benchmarks import sdf
from framework import mesh as shapes
from framework.lookup import _bilinear
from solutions import fast

TITLE = "Growth of run time with work"
LOOK_UPS = (10_000, 100_000, 1_000_000)
CAMERA = fw.Camera((0.3, 0.5, 2.6), (0, 0, 0), (0, 1, 0), 0.9)


def spheres(count):
    """A union of `count` small spheres in a cube."""
    rng = np.random.default_rng(count)
    return fw.sdf.union(*(fw.sdf.sphere(c, 0.3 / count ** (1 / 3)) for c in rng.uniform(-1, 1, (count, 3))))


def series():
    mesh, points = shapes.bumpy_sphere(66_000), np.random.default_rng(0).uniform(-1, 1, (1000, 3))
    sky, directions = fw.skies.gradient(256), np.random.default_rng(1).normal(size=(LOOK_UPS[-1], 3))
    draw = functools.partial(fw.rasterize, mesh, CAMERA, channels=("position", "normal"))
    return {
        "pixels: rasterised": {n * n: functools.partial(draw, n, n) for n in (128, 256, 512, 1024, 2048)},
        "look-ups: NumPy": {n: functools.partial(_bilinear, sky.pixels, directions[:n]) for n in LOOK_UPS},
        "look-ups: compiled": {n: functools.partial(sky.radiance, directions[:n]) for n in LOOK_UPS},
        "primitives: distances of 1000 points, NumPy": {
            n: functools.partial(spheres(n), points) for n in (1, 10, 100, 1000, 10_000)
        },
        "primitives: picture of 256 x 256 pixels with shadows, compiled": {
            n: functools.partial(fast.render_sdf, sdf.on_floor(n), sdf.CAMERA, 256, 256, sdf.LIGHT, sdf.K)
            for n in (10, 100, 1000, 10_000)
        },
        "map size, pixels: exact filter, roughness 0.3": {
            2 * n * n: functools.partial(fast.prefilter_chain, fw.skies.gradient(n), [0.3], [32])
            for n in (64, 128, 256, 512)
        },
    }
