"""How visible a round light is, estimated from one march towards its centre, in NumPy.

Ratio and arcsin are the lecture's, Aaltonen's triangulation is from GDC 2018 (Claybook), the signed forms follow the
march inside: Quilez's smooth step, and the disc's exact share for a straight edge. Truth: 1024 rays cast in closed form.
"""

import functools

import numpy as np

import framework as fw
from benchmarks.harness import Contender
from solutions.soft_shadows import area_light_shadow
from solutions.truth_visibility import Solids

TITLE = "Soft shadows: run time against error"
ERROR = "visibility, RMS error against 1024 rays"
WORK = "SDF evaluations"
SOLIDS = Solids(spheres=(((-0.9, 0.8, 0.0), 0.45),), boxes=(((0.9, 0.6, 0.0), (0.3, 0.6, 0.3)),))
TO_LIGHT = fw.normalize(np.array([0.5, 1.0, 0.3]))
RADIUS, T_MIN, T_MAX = 0.12, 0.02, 12.0  # of the light, seen from the floor: radians


def floor(size=56):
    x, z = np.meshgrid(np.linspace(-2.6, 1.8, size), np.linspace(-1.6, 1.2, size))
    return np.stack([x, np.full_like(x, 1e-4), z], axis=-1).reshape(-1, 3)


def truth(points, rays=1024):
    """The light's visible part, by rays spread evenly over its disc."""
    i = np.arange(rays)
    r, phi = np.tan(RADIUS) * np.sqrt((i + 0.5) / rays), i * np.pi * (3 - np.sqrt(5))
    tangent, bitangent = fw.orthonormal_frame(TO_LIGHT)[:2]
    direction = fw.normalize(
        TO_LIGHT + (r * np.cos(phi))[:, None] * tangent + (r * np.sin(phi))[:, None] * bitangent
    )
    return np.array([1.0 - SOLIDS.blocked(p, direction, T_MAX).mean() for p in points])


def march(sdf, origin, max_steps, estimate):
    """The least of `estimate(h, t, h before)` along the ray outside of things, 0 where it is blocked."""
    n, evaluations = len(origin), 0
    visible, ray = np.ones(n), np.arange(n)
    t, before = np.full(n, T_MIN), np.full(n, np.inf)
    for _ in range(max_steps):
        h = sdf(origin[ray] + t[:, None] * TO_LIGHT)
        evaluations += len(ray)
        visible[ray] = np.where(h < 1e-4, 0.0, np.minimum(visible[ray], estimate(h, t, before)))
        t, before = t + h, h
        on = (h >= 1e-4) & (t <= T_MAX)
        ray, t, before = ray[on], t[on], before[on]
        if not len(ray):
            break
    return visible, evaluations


def ratio(h, t, before):
    return np.clip(h / (np.sin(RADIUS) * t), 0, 1)


def arcsin(h, t, before):
    return np.clip(np.arcsin(np.clip(h / t, 0, 1)) / RADIUS, 0, 1)


def aaltonen(h, t, before):
    y = h * h / (2 * before)
    return np.clip(np.sqrt(np.maximum(h * h - y * y, 0)) / (np.sin(RADIUS) * np.maximum(t - y, 1e-6)), 0, 1)


def smooth_signed(sdf, origin, max_steps):
    """Quilez: the march goes on inside, to a ratio of -1; a cubic from there to 1."""
    n, evaluations = len(origin), 0
    least, ray, t = np.ones(n), np.arange(n), np.full(n, T_MIN)
    for _ in range(max_steps):
        h = sdf(origin[ray] + t[:, None] * TO_LIGHT)
        evaluations += len(ray)
        least[ray] = np.minimum(least[ray], h / (np.sin(RADIUS) * t))
        t = t + np.clip(h, 0.005, 0.5)
        on = (least[ray] > -1) & (t <= T_MAX)
        ray, t = ray[on], t[on]
        if not len(ray):
            break
    x = np.maximum(least, -1.0)
    return 0.25 * (1 + x) ** 2 * (2 - x), evaluations


def exact_for_edges(sdf, origin, max_steps):
    """`solutions.soft_shadows.area_light_shadow`, its evaluations counted."""
    counted = 0

    def counting(p):
        nonlocal counted
        counted += len(p)
        return sdf(p)

    return area_light_shadow(counting, origin, TO_LIGHT, RADIUS, T_MIN, T_MAX, max_steps), counted


def contenders():
    # The floor is where the points are: it casts no shadow on itself, and would be the nearest thing all the way.
    sdf = Solids(SOLIDS.spheres, SOLIDS.boxes, None).sdf()
    points = floor()
    wanted = truth(points)
    error = lambda result: float(np.sqrt(np.mean((result[0] - wanted) ** 2)))  # noqa: E731
    work = lambda result: int(result[1])  # noqa: E731
    methods = {form.__name__: functools.partial(march, estimate=form) for form in (ratio, arcsin, aaltonen)}
    methods |= {"signed, smooth step": smooth_signed, "signed, exact for edges": exact_for_edges}
    return [
        Contender(name, f"at most {steps} steps", functools.partial(method, sdf, points, max_steps=steps), error, work)
        for name, method in methods.items()
        for steps in (4, 8, 16, 32, 64, 128)
    ]
