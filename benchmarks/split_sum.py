"""A rough mirror under an environment: the split sum against Monte Carlo, on a sphere seen from the front.

Truth: Monte Carlo with 65536 visible normals for each point; its own error is an eighth of that
of 1024, about 0.02. The split
sum's error does not fall with time: what its approximation, v = n, costs. Mitsuba 3 takes part where it is installed.
"""

import functools
import sys

import numpy as np

import framework as fw
from benchmarks.harness import Contender
from solutions import fast

TITLE = "Split sum and Monte Carlo: run time against error"
ERROR = "relative RMS error"
WORK = "directions"
SIZE, R0 = 24, 0.9


def contenders():
    env = fw.skies.studio(128)
    light = fast.environment_light(env)
    x, y = np.meshgrid(*[(np.arange(SIZE) + 0.5) / SIZE * 2 - 1] * 2)
    inside = x * x + y * y < 0.98
    x, y = x[inside], y[inside]
    normal = np.stack([x, y, np.sqrt(1 - x * x - y * y)], axis=1)
    view = np.broadcast_to([0.0, 0.0, 1.0], normal.shape)
    found = _mitsuba(env, inside)
    for roughness in (0.2, 0.5):
        truth, _ = fast.monte_carlo_shade(env, normal, view, R0, roughness**2, 65536, np.random.default_rng(1))

        def error(color, truth=truth):
            return float(np.sqrt(np.mean(((color - truth) / (truth + 1e-2)) ** 2)))

        def sampled(samples, roughness=roughness):
            rng = np.random.default_rng(2)
            return fast.monte_carlo_shade(env, normal, view, R0, roughness**2, samples, rng)[0]

        where = f"roughness {roughness}"
        for samples in (1, 4, 16, 64, 256, 1024):
            work = functools.partial(lambda result, samples: len(result) * samples, samples=samples)
            run = functools.partial(sampled, samples)
            found.append(Contender(f"Monte Carlo: {where}", f"{samples} samples", run, error, work))
        split = functools.partial(fast.shade_split_sum, normal, view, R0, roughness, light.prefiltered, light.lut)
        found.append(Contender(f"split sum: {where}", "no knob", split, error, len))
    return found


def _mitsuba(env, inside):
    """The same ball by Mitsuba, against a converged picture of its own."""
    try:
        from benchmarks.peers.mitsuba_ball import Ball
    except ImportError as problem:
        print(f"split_sum: Mitsuba is left out ({problem}); pip install mitsuba", file=sys.stderr)
        return []
    found = []
    for roughness in (0.2, 0.5):
        ball = Ball(env, roughness**2, SIZE)
        truth = ball.render(8192, seed=1)[inside]

        def error(image, truth=truth):
            return float(np.sqrt(np.mean(((image[inside] - truth) / (truth + 1e-2)) ** 2)))

        for samples in (1, 4, 16, 64, 256):
            run = functools.partial(ball.render, samples)
            work = functools.partial(lambda image, samples: int(inside.sum()) * samples, samples=samples)
            found.append(Contender(f"Mitsuba: roughness {roughness}", f"{samples} samples", run, error, work))
    return found
