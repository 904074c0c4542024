"""Filtered maps: what a constant map, a sun in one texel and a turn of the map do to them.

Truths are float64 sums over all of the map, `solutions.truth_maps`.
"""

import numpy as np

import framework as fw
from solutions import fast, prefilter, truth_maps
from solutions.stress import ROUGHNESS, measured, relative
from solutions.stress.environments import maps


def rows(share):
    for height in (6, 5, 1)[: max(1, round(3 * share))]:
        yield from _of_height(height, ROUGHNESS if share >= 0.5 else ROUGHNESS[[0, 2, 6, 13]])


def _of_height(height, levels):
    found = {name: _compiled(env, height, levels) for name, env in maps().items()}
    slow = {
        name: np.array([*(prefilter.prefilter(env, a, height, 64) for a in levels**2), prefilter.irradiance(env, height)])
        for name, env in maps().items()
    }
    size = f", {height} rows"
    for function, values in (("fast.prefilter_chain" + size, found), ("prefilter" + size, slow)):
        flat = list(values.values())
        beyond = [np.maximum(v - maps()[name].pixels.max((0, 1)), -v) / v.max() for name, v in values.items()]
        yield measured(function, "below 0, or above the map's top", flat, np.array(beyond), 1e-6, "a weighted mean, in float32")
        yield measured(function, "change of a constant map", flat, np.abs(values["constant"] / 0.7 - 1), 1e-6,
                       "weights add up to 1")  # fmt: skip
    around, errors, turned, diffuse, twin = fw.environment.pixel_directions(height), [], [], [], []
    for name, env in maps().items():
        brightest = env.directions()[np.unravel_index(env.pixels.sum(2).argmax(), env.pixels.shape[:2])]
        for level, roughness in zip(found[name], levels, strict=True):
            if roughness >= (0.2 if height == 5 else 0.3) and env.height >= 5:
                fine = (256 if roughness < 0.3 else 64) // env.height
                exact = truth_maps.filtered_radiance(env.pixels, around, roughness**2, oversample=fine)
                peak = truth_maps.filtered_radiance(env.pixels, brightest[None], roughness**2, oversample=fine)
                errors.append(np.abs(level - exact).max() / max(peak.max(), exact.max()))
        exact = truth_maps.cosine_weighted_radiance(env.pixels, around)
        diffuse.append(relative(slow[name][-1], exact, 1e-3 * env.pixels.max()))
        # Towards the brightest pixel too: a map of one row may see nothing but what is left at the horizon.
        toward = np.append(around.reshape(-1, 3), brightest[None], axis=0)
        exact = truth_maps.cosine_weighted_radiance(env.pixels, toward, oversample=-(-256 // env.height))
        twin.append(np.abs(fast.irradiance(env, height) - exact[:-1].reshape(around.shape)) / exact.max())
        # Turned by whole pixels of the map and of the result at once.
        step = env.height // np.gcd(env.height, height)
        turn = _compiled(fw.Environment(np.roll(env.pixels, step, axis=1)), height, levels)
        turned.append(np.abs(np.roll(found[name], step * height // env.height, axis=2) - turn) / env.pixels.max())
    reason = "stated: right to a percent at the peak; maps of 5 rows and more"
    flat = list(found.values())
    yield measured("fast.prefilter_chain" + size, "error over the lobe's peak, roughness >= 0.3", flat, np.array(errors), 1e-2,
                   reason)  # fmt: skip
    yield measured("fast.prefilter_chain" + size, "changed by turning, over the top", turned, np.array(turned), 1e-5,
                   "float32 rings")  # fmt: skip
    yield measured("prefilter.irradiance" + size, "relative error", diffuse, np.array(diffuse), 1e-12,
                   "the same sum, in another order")  # fmt: skip
    yield measured("fast.irradiance" + size, "error over the brightest", twin, np.array(twin), 3e-4, "truth's grid of 256 rows")


def _compiled(env, height, levels):
    return np.array(fast.prefilter_chain(env, levels, [height] * len(levels)))
