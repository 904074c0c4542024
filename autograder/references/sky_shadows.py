"""Scenes under the photographed sky, with the shadows that every part of it casts."""

import numpy as np

import framework as fw
from autograder.references.filtered import clamped_sky
from solutions import truth_rays
from solutions.sphere_tracing import sphere_trace
from solutions.split_sum import masking_shadowing
from solutions.truth_visibility import Solids, ambient_visibility, diffuse_radiance, specular_radiance

RAYS = 512


def ambient(spec):
    """free part of the cosine-weighted hemisphere, 0 where nothing is seen; 2048 rays a pixel in closed form"""
    mask, p, normal, _ = seen(spec)
    return _picture(mask, ambient_visibility(solids(spec), p, normal, spec["t_max"], 2048))


def ambient_truth(spec):
    """brute force: 512 random rays a pixel, marched through the distance field"""
    mask, p, normal, _ = seen(spec)
    free = _free(spec, p, normal, _around(normal))
    return _estimate(mask, free.astype(float))


def diffuse(spec):
    """albedo / pi times the integral of L (n.l) V; each pixel of the sky in 2 x 2 parts, a ray in closed form to each"""
    mask, p, normal, _ = seen(spec)
    return _picture(mask, diffuse_radiance(solids(spec), clamped_sky(spec), p, normal, spec["albedo"], spec["t_max"], 2))


def diffuse_truth(spec):
    """brute force: 512 random rays a pixel, marched through the distance field"""
    mask, p, normal, _ = seen(spec)
    direction = _around(normal)
    light = clamped_sky(spec).radiance(direction) * _free(spec, p, normal, direction)[..., None]
    return _estimate(mask, spec["albedo"] * light)


def glossy(spec):
    """integral of L f (n.l) V of a rough mirror; quadrature over half vectors, rays in closed form"""
    mask, p, normal, view = seen(spec)
    material = spec["r0"], spec["roughness"], spec["t_max"]
    light = specular_radiance(solids(spec), clamped_sky(spec), p, normal, view, *material, *spec["nodes"])
    return _picture(mask, light)


def glossy_truth(spec):
    """brute force: 512 random half vectors a pixel, the rays marched through the distance field"""
    mask, p, normal, view = seen(spec)
    alpha, rng = spec["roughness"] ** 2, np.random.default_rng(3)
    local = fw.sample_ggx(rng.random((len(p) * RAYS, 2)), alpha).reshape(len(p), RAYS, 3)
    half = local @ _axes(normal)
    v_h = fw.arrays.dot(half, view[:, None])[..., None]
    direction = 2 * v_h * half - view[:, None]
    cos_o, cos_i = fw.arrays.dot(normal, view)[:, None], fw.arrays.dot(direction, normal[:, None])
    weight = masking_shadowing(cos_i, cos_o, alpha) / (cos_o * local[..., 2])
    fresnel = spec["r0"] + (1 - spec["r0"]) * np.clip(1 - v_h, 0, 1) ** 5
    lit = (cos_i > 0) & (v_h[..., 0] > 0) & _free(spec, p, normal, direction)
    light = clamped_sky(spec).radiance(direction) * fresnel * v_h
    return _estimate(mask, light * (weight * lit)[..., None])


def solids(spec):
    """The scene's floor, spheres and boxes."""
    of = {kind: [node[kind] for node in spec["union"] if kind in node] for kind in ("sphere", "box", "plane")}
    return Solids(
        spheres=tuple((one["center"], one["radius"]) for one in of["sphere"]),
        boxes=tuple((one["center"], one["half_size"]) for one in of["box"]),
        ground=of["plane"][0]["offset"],
    )


def seen(spec):
    """Which pixels see the scene, (H, W), and there the points, a little off the surface, normals and views."""
    origin, direction = fw.Camera(**spec["camera"]).rays(spec["width"], spec["height"])
    t, normal = truth_rays.cast(spec["union"], origin.reshape(-1, 3), direction.reshape(-1, 3))
    mask = (t < spec["far"]).reshape(origin.shape[:2])
    normal = normal[mask.reshape(-1)]
    p = origin[mask] + t[mask.reshape(-1), None] * direction[mask]
    return mask, p + 1e-6 * normal, normal, -direction[mask]


def _axes(normal):
    return np.stack([*fw.orthonormal_frame(normal), normal], axis=1)


def _around(normal):
    """Random directions with the density of the cosine, (N, RAYS, 3)."""
    u, v = np.random.default_rng(2).random((2, len(normal), RAYS))
    radius, phi = np.sqrt(u), 2 * np.pi * v
    return np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - u)], axis=-1) @ _axes(normal)


def _free(spec, p, normal, direction):
    """Which rays meet nothing within t_max, (N, RAYS) bool; they start a thousandth off the surface."""
    start = np.broadcast_to((p + 1e-3 * normal)[:, None], direction.shape).reshape(-1, 3)
    sdf = fw.sdf.load({"union": spec["union"]})
    _, hit = sphere_trace(sdf, start, direction.reshape(-1, 3), spec["t_max"], 1e-5, 400)
    return ~hit.reshape(direction.shape[:2])


def _picture(mask, values):
    image = np.zeros(mask.shape + values.shape[1:])
    image[mask] = values
    return image


def _estimate(mask, samples):
    """Means over rays (N, RAYS, ...), as a picture, and the standard error of its values."""
    variance = _picture(mask, samples.var(axis=1, ddof=1) / RAYS)
    return _picture(mask, samples.mean(axis=1)), float(np.sqrt(variance.mean()))
