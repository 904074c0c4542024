"""How far a ray steps, and when it stops, in NumPy, on one scene of 11 shapes.

Over-relaxation is Keinert et al. 2014, Enhanced Sphere Tracing; auto-relaxation Ban and Valasek 2023, Automatic Step
Size Relaxation in Sphere Tracing. All fall back to the plain step where two spheres do not meet.
"""

import functools
import math

import numpy as np

import framework as fw
from benchmarks.harness import Contender

TITLE = "Sphere tracing: run time against error"
ERROR = "mean error along the ray, pixels (at most 10)"
WORK = "SDF evaluations"
WIDTH, HEIGHT, T_MAX = 128, 96, 30.0
CAMERA = fw.Camera((3.0, 2.0, 4.5), (0.0, 0.5, 0.0), (0, 1, 0), 0.8)
PIXEL = 2 * math.tan(CAMERA.fov_y / 2) / HEIGHT  # footprint at distance 1
STEPPERS = {
    "plain": {},
    "over-relaxed 1.2": {"omega": 1.2},
    "over-relaxed 1.6": {"omega": 1.6},
    "auto-relaxed": {"beta": 0.3},
}


def scene():
    """A floor, a ring, a box blended with a ball, a tilted plate and a row of balls."""
    ring = fw.sdf.translate(fw.sdf.torus((0, 0, 0), 0.8, 0.2), (-1.2, 0.3, 0.2))
    mound = fw.sdf.smooth_union(fw.sdf.box((0.4, 0.4, 0), (0.4, 0.4, 0.4)), fw.sdf.sphere((0.8, 0.8, 0.3), 0.4), 0.3)
    plate = fw.sdf.rotate(fw.sdf.box((0, 1.2, -1.5), (1.2, 0.6, 0.04)), (0, 1, 0), 0.5)
    balls = [fw.sdf.sphere((0.5 * i - 1.2, 0.15, 1.4), 0.15) for i in range(6)]
    return fw.sdf.union(fw.sdf.plane((0, 1, 0), 0.0), ring, mound, plate, *balls)


def march(sdf, origin, direction, width, max_steps, omega=1.0, beta=None, refine=0):
    """Distances (N,), `inf` where missed, and how many points were evaluated.

    A point is a hit where the distance is below `width(t)`; `refine` Newton steps follow it to the surface.
    """
    n, evaluations = len(origin), len(origin)
    result, before = np.full(n, np.inf), np.zeros(n)
    ray = np.arange(n)
    t, r = np.zeros(n), sdf(origin)
    relaxed, m = np.full(n, omega), np.full(n, -1.0)
    for _ in range(max_steps):
        step = 2 * r / (1 - np.minimum(m, 0.8)) if beta is not None else relaxed * r
        ahead = t + step
        there = sdf(origin[ray] + ahead[:, None] * direction[ray])
        evaluations += len(ray)
        meets = step <= (r + np.abs(there)) * (1 + 1e-12)
        slope = (there - r) / np.maximum(step, 1e-300)
        if beta is not None:
            m = np.where(meets, (1 - beta) * m + beta * slope, -1.0)
        relaxed = np.where(meets, relaxed, 1.0)
        t, r = np.where(meets, ahead, t), np.where(meets, there, r)
        hit = meets & (r < width(t)) & (t <= T_MAX)
        result[ray[hit]], before[ray[hit]] = t[hit], slope[hit]
        on = ~hit & (t <= T_MAX)
        ray, t, r, relaxed, m = ray[on], t[on], r[on], relaxed[on], m[on]
        if not len(ray):
            break
    found = np.flatnonzero(np.isfinite(result))
    for _ in range(refine):
        rest = sdf(origin[found] + result[found, None] * direction[found])
        evaluations += len(found)
        result[found] += rest / np.clip(-before[found], 0.05, 1.0)
    return result, evaluations


def pixels_off(t, truth):
    """Mean difference along the ray in pixels' footprints; where one hits and the other misses it counts 10."""
    same = np.isfinite(t) == np.isfinite(truth)
    with np.errstate(invalid="ignore"):
        off = np.where(np.isfinite(truth), np.abs(t - truth) / (PIXEL * truth), 0.0)
    return float(np.mean(np.where(same, np.minimum(off, 10.0), 10.0)))


def contenders():
    sdf = scene()
    origin, direction = (a.reshape(-1, 3) for a in CAMERA.rays(WIDTH, HEIGHT))
    truth, _ = march(sdf, origin, direction, lambda t: np.full(len(t), 1e-9), 5000)
    error = lambda result: pixels_off(result[0], truth)  # noqa: E731
    work = lambda result: int(result[1])  # noqa: E731

    def contender(method, setting, *arguments, **options):
        run = functools.partial(march, sdf, origin, direction, *arguments, **options)
        return Contender(method, setting, run, error, work)

    fixed = lambda eps: lambda t: np.full(len(t), eps)  # noqa: E731
    cone = lambda pixels: lambda t: pixels * PIXEL * t  # noqa: E731
    found = [
        contender(name, f"at most {steps} steps", fixed(1e-4), steps, **options)
        for name, options in STEPPERS.items()
        for steps in (16, 32, 64, 128, 256)
    ]
    for eps in (1e-1, 1e-2, 1e-3, 1e-4):
        found.append(contender("plain, constant width", f"eps {eps:g}", fixed(eps), 256))
    for pixels in (2.0, 1.0, 0.5, 0.25, 0.1):
        found.append(contender("plain, pixel's cone", f"{pixels:g} pixels", cone(pixels), 256))
        found.append(contender("plain, cone and refinement", f"{pixels:g} pixels", cone(pixels), 256, refine=2))
        found.append(contender("auto-relaxed, cone and refinement", f"{pixels:g} pixels", cone(pixels), 256,
                               beta=0.3, refine=2))  # fmt: skip
    return found
