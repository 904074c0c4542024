"""Error and work of five ways to shadow a sky, beside the reference of 5.3, against the stored pictures of two scenes."""

from functools import cache

import numpy as np
import pytest

import framework as fw
from autograder import references
from autograder.references.filtered import clamped_sky
from autograder.references.sky_shadows import seen
from solutions.environment_shadows import ambient_visibility, dominant_lights, shade_with_shadows
from solutions.prefilter import irradiance
from solutions.soft_shadows import area_light_shadow
from solutions.sphere_tracing import sphere_trace


class Counted:
    def __init__(self, sdf):
        self.sdf, self.count = sdf, 0

    def __call__(self, p):
        self.count += len(p)
        return self.sdf(p)


@cache
def light():
    env = clamped_sky(references.spec("diffuse_objects"))
    return fw.EnvironmentLight(env, irradiance(env, 16), [env.pixels], [0.0], np.ones((1, 1, 2)))


def hemisphere(normal, u, v):
    """Directions with the density of the cosine, (N, M, 3)."""
    radius, phi = np.sqrt(u), 2 * np.pi * v
    local = np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - u)], axis=-1)
    return local @ np.stack([*fw.orthonormal_frame(normal), normal], axis=1)


def no_shadows(sdf, p, normal, t_max):
    return light().irradiance(normal)


def ambient(sdf, p, normal, t_max):
    return light().irradiance(normal) * ambient_visibility(sdf, p, normal, t_max)[:, None]


def bent_cone(sdf, p, normal, t_max, cones=16):
    """The irradiance towards the mean of the free directions, times their share."""
    i = np.arange(cones)
    u = (i + 0.5) / cones
    direction = hemisphere(normal, u, i * (3 - np.sqrt(5)) / 2)
    radius = np.minimum(np.sqrt(1 / (cones * np.sqrt(1 - u))), np.arcsin(np.sqrt(1 - u)))
    free = [
        area_light_shadow(sdf, p, direction[:, j], radius[j], 0.005 * t_max, t_max, 64) for j in range(cones)
    ]
    bent = fw.normalize(np.einsum("jn,njk->nk", free, direction))
    return light().irradiance(bent) * np.mean(free, axis=0)[:, None]


def dominant_with_ambient(sdf, p, normal, t_max, count=4):
    """The strongest of 16 lights with a shadow each; what is left of the irradiance times the ambient visibility."""
    toward, power = dominant_lights(light().env, 16)
    strongest = np.argsort(power.sum(axis=1))[-count:]
    direct, all_of_it = np.zeros_like(p), np.zeros_like(p)
    for d, w in zip(toward[strongest], power[strongest], strict=True):
        cosine = np.maximum(normal @ d, 0)
        up = cosine > 0
        all_of_it += cosine[:, None] * w / np.pi
        free = area_light_shadow(sdf, p[up], d, 0.1, 0.005 * t_max, t_max, 64)
        direct[up] += (cosine[up] * free)[:, None] * w / np.pi
    rest = np.maximum(light().irradiance(normal) - all_of_it, 0)
    return direct + rest * ambient_visibility(sdf, p, normal, t_max)[:, None]


def monte_carlo(sdf, p, normal, t_max, rays=256):
    direction = hemisphere(normal, *np.random.default_rng(1).random((2, len(p), rays)))
    start = np.repeat(p + 1e-3 * normal, rays, axis=0)
    _, hit = sphere_trace(sdf, start, direction.reshape(-1, 3), t_max, 1e-4, 200)
    return (light().env.radiance(direction) * ~hit.reshape(len(p), rays, 1)).mean(axis=1)


def reference(sdf, p, normal, t_max):
    # Seen from behind, a surface has no specular part.
    return shade_with_shadows(light(), sdf, p, normal, -normal, 0.0, 0.5, 1.0, t_max)


METHODS = (no_shadows, ambient, bent_cone, dominant_with_ambient, monte_carlo, reference)


@pytest.mark.drill
@pytest.mark.parametrize("scene", ["diffuse_objects", "diffuse_corner"])
def test_the_reference_has_a_third_of_the_error_without_shadows_for_600_evaluations(scene):
    spec = references.spec(scene)
    mask, p, normal, _ = seen(spec)
    truth = fw.read_image(references.FOLDER / f"{scene}.exr")[mask] / spec["albedo"]
    error, work = {}, {}
    for method in METHODS:
        sdf = Counted(fw.sdf.load({"union": spec["union"]}))
        found = method(sdf, p, normal, spec["t_max"])
        error[method] = np.sqrt(np.mean((found - truth) ** 2)) / np.sqrt(np.mean(truth**2))
        work[method] = sdf.count / len(p)
        print(f"{scene} {method.__name__:22s} error {error[method]:6.1%}, {work[method]:6.0f} evaluations a point")
    assert error[reference] <= error[no_shadows] / 3
    assert work[monte_carlo] > work[reference]
    sdf = Counted(fw.sdf.load({"union": spec["union"]}))
    shade_with_shadows(light(), sdf, p, normal, normal, 0.5, 0.5, 0.5, spec["t_max"])  # the specular cone as well
    assert sdf.count <= 600 * len(p)
