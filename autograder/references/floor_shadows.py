"""Shadows on a floor, seen from above: the lecture's estimate, and the round light that it stands for."""

import numpy as np

import framework as fw
from solutions import truth_rays
from solutions.soft_shadows import soft_shadow
from solutions.sphere_tracing import sphere_trace

RAYS = 1024


def penumbra(spec):
    """smallest min(k d / t, 1) along one ray a pixel, 0 where it is blocked"""
    sdf, march = fw.sdf.load({"union": spec["union"]}), (spec["t_min"], spec["t_max"], spec["max_steps"])
    return soft_shadow(sdf, _floor(spec), _to_light(spec), spec["k"], *march).reshape(_shape(spec))


def penumbra_truth(spec):
    """analytic: the definition, step by step for one point after the other, over distances in closed form"""
    march = spec["t_min"], spec["t_max"], spec["max_steps"]
    seen = truth_rays.smallest_penumbra(spec["union"], _floor(spec), _to_light(spec), spec["k"], *march)
    return seen.reshape(_shape(spec)), 0.0


def round_light(spec):
    """visible part of a disc of angular radius arcsin(1 / k): 1024 rays a pixel, each cast in closed form"""
    radius = np.arcsin(1 / spec["k"])
    seen = truth_rays.visible_fraction(
        spec["union"], _floor(spec), _to_light(spec), radius, spec["t_max"], 1024
    )
    return seen.reshape(_shape(spec))


def round_light_truth(spec):
    """brute force: 1024 random rays a pixel, marched through the distance field"""
    every = spec["every"]
    floor = _floor(spec).reshape(*_shape(spec), 3)[::every, ::every]
    rng, light = np.random.default_rng(spec["k"]), _to_light(spec)
    r = np.tan(np.arcsin(1 / spec["k"])) * np.sqrt(rng.random((*floor.shape[:2], RAYS)))
    phi = 2 * np.pi * rng.random(r.shape)
    tangent, bitangent = fw.orthonormal_frame(light)
    ray = fw.normalize(
        light + (r * np.cos(phi))[..., None] * tangent + (r * np.sin(phi))[..., None] * bitangent
    )
    start = np.broadcast_to(floor[:, :, None], ray.shape).reshape(-1, 3)
    sdf = fw.sdf.load({"union": spec["union"]})
    _, hit = sphere_trace(sdf, start, ray.reshape(-1, 3), spec["t_max"], 1e-5, 400)
    seen = 1 - hit.reshape(r.shape).mean(axis=-1)
    return seen, np.sqrt(np.mean(seen * (1 - seen)) / (RAYS - 1))


def _shape(spec):
    return spec["size"], spec["size"]


def _to_light(spec):
    return fw.normalize(spec["to_light"])


def _floor(spec):
    """Pixel centres of a square of the floor y = 0, rows along +z, columns along +x."""
    side = spec["extent"] * ((2 * np.arange(spec["size"]) + 1) / spec["size"] - 1)
    x, z = np.meshgrid(side, side)
    return np.stack([x, np.zeros_like(x), z], axis=-1).reshape(-1, 3)
