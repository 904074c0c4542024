"""A traced scene: how far each ray goes, and what it meets."""

import numpy as np

import framework as fw
from solutions import truth_rays
from solutions.sphere_tracing import estimate_normal, sphere_trace


def distance(spec):
    """distance along the ray through each pixel's centre, inf where nothing is met; sphere tracing down to 1e-7"""
    return _trace(spec)[2].reshape(spec["height"], spec["width"])


def distance_truth(spec):
    """analytic: each ray cast at each shape in closed form (the torus a quartic, the blend by bisection)"""
    return _cast(spec)[0], 0.0


def normal(spec):
    """outward unit normal at each hit, 0 where nothing is met; central differences over 1e-6"""
    origin, direction, t = _trace(spec)
    result, hit = np.zeros(origin.shape), np.isfinite(t)
    surface = origin[hit] + t[hit, None] * direction[hit]
    result[hit] = estimate_normal(fw.sdf.load({"union": spec["union"]}), surface, 1e-6)
    return result.reshape(spec["height"], spec["width"], 3)


def normal_truth(spec):
    """analytic: the gradient of each shape at the point where a ray, cast in closed form, meets it"""
    return _cast(spec)[1], 0.0


def _rays(spec):
    rays = fw.Camera(**spec["camera"]).rays(spec["width"], spec["height"])
    return (a.reshape(-1, 3) for a in rays)


def _trace(spec):
    origin, direction = _rays(spec)
    t, _ = sphere_trace(
        fw.sdf.load({"union": spec["union"]}), origin, direction, spec["t_max"], 1e-7, 4000
    )
    return origin, direction, t


def _cast(spec):
    t, normal = truth_rays.cast(spec["union"], *_rays(spec))
    met, shape = t <= spec["t_max"], (spec["height"], spec["width"])
    t = np.where(met, t, np.inf).reshape(shape)
    return t, np.where(met[:, None], normal, 0.0).reshape(*shape, 3)
