"""GGX-filtered radiance with n = v = r: samples, with and without reduced maps, the reference solution, which adds up pixels
where that is less work, and the exact filter.

Reduced maps are Krivanek and Colbert 2008, Real-time Shading with Filtered Importance Sampling: each sample looks up
the map at the resolution whose pixels cover as much as the sample stands for. Truth: quadrature over every pixel.
"""

import functools

import numpy as np

import framework as fw
from benchmarks.harness import Contender
from framework.environment import pixel_directions
from solutions import fast
from solutions.prefilter import prefilter
from solutions.truth_maps import filtered_radiance

TITLE = "Prefiltered environments: run time against error"
ERROR = "relative RMS error"
WORK = "texels looked up"
HEIGHT, ROWS = 64, 16
SAMPLES = (16, 64, 256)


def reduced(env):
    """The map and its halves, quarters and so on: means over 2 x 2 pixels, weighted by their solid angles."""
    maps = [env]
    while maps[-1].height > 4:
        light = maps[-1].pixels * maps[-1].solid_angles()[..., None]
        weight = maps[-1].solid_angles()
        light, weight = (x.reshape(x.shape[0] // 2, 2, x.shape[1] // 2, 2, *x.shape[2:]).sum(axis=(1, 3))
                         for x in (light, weight))  # fmt: skip
        maps.append(fw.Environment(light / weight[..., None]))
    return maps


def filtered_sampling(maps, alpha, height, samples):
    """GGX samples, each from the reduced map that its share of the lobe asks for; with one map, plain sampling."""
    h = fw.sample_ggx(fw.hammersley(samples), alpha)
    light = np.stack([2 * h[:, 2] * h[:, 0], 2 * h[:, 2] * h[:, 1], 2 * h[:, 2] ** 2 - 1], axis=-1)
    light, h = light[light[:, 2] > 0], h[light[:, 2] > 0]
    density = (alpha / (1 + h[:, 2] ** 2 * (alpha**2 - 1))) ** 2 / np.pi / 4  # of `light`, per steradian
    pixel = 2 * np.pi**2 / maps[0].height / (2 * maps[0].height)
    level = np.clip(np.rint(0.5 * np.log2(1 / (samples * density) / pixel)), 0, len(maps) - 1).astype(int)
    normal = pixel_directions(height).reshape(-1, 3)
    tangent, bitangent = fw.orthonormal_frame(normal)
    total = np.zeros((len(normal), 3))
    for local, one in zip(light, level, strict=True):
        direction = local[0] * tangent + local[1] * bitangent + local[2] * normal
        total += local[2] * maps[one].radiance(direction)
    return (total / light[:, 2].sum()).reshape(height, 2 * height, 3)


def contenders():
    found = []
    for sky, env in (("gradient", fw.skies.gradient(HEIGHT)), ("sun", fw.skies.sun_and_sky(HEIGHT))):
        maps = reduced(env)
        for roughness in (0.3, 0.7):
            alpha = roughness**2
            wanted = filtered_radiance(env.pixels, pixel_directions(ROWS), alpha, oversample=3)

            def error(result, wanted=wanted):
                return float(np.sqrt(np.mean(((np.reshape(result, wanted.shape) - wanted) / (wanted + 1e-2)) ** 2)))

            where = f"{sky}, roughness {roughness}"
            texels = lambda result, samples: 2 * ROWS * ROWS * samples  # noqa: E731
            for samples in SAMPLES:
                work = functools.partial(texels, samples=samples)
                for method, source in (("samples", [env]), ("samples of reduced maps", maps)):
                    run = functools.partial(filtered_sampling, source, alpha, ROWS, samples)
                    found.append(Contender(f"{method}: {where}", f"{samples} samples", run, error, work))
            reference = functools.partial(prefilter, env, alpha, ROWS, SAMPLES[-1])
            found.append(Contender(f"reference: {where}", f"{SAMPLES[-1]} samples", reference, error))
            exact = functools.partial(fast.prefilter_chain, env, [roughness], [ROWS])
            found.append(Contender(f"exact: {where}", "no knob", exact, error))
    return found
