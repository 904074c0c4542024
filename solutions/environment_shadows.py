# ---
# jupyter:
#   jupytext:
#     cell_metadata_filter: nbgrader,tags,-all
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3 (ipykernel)
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Shadows from the environment

# %%
import numpy as np

import framework as fw


# %% nbgrader={"grade_id": "dominant_lights", "solution": true}
def dominant_lights(env, count):
    """A few directional lights that stand for a whole environment.

    Parameters
    ----------
    env : framework.Environment
    count : int                number of lights, from 1 to the number of pixels

    Returns
    -------
    directions : (count, 3) float   unit vectors, each the energy centroid of its region of the map
    power : (count, 3) float        radiance times solid angle, summed over the region

    Notes
    -----
    Median cut (Debevec 2005): the region of the largest luminous energy is cut in halves of equal energy, across
    its longer side, until there are enough.
    """
    ### BEGIN SOLUTION
    import heapq

    height, width = env.pixels.shape[:2]
    directions, light = env.directions(), env.pixels * env.solid_angles()[..., None]
    energy = light @ [0.2126, 0.7152, 0.0722]

    def entry(top, bottom, left, right):
        size = (bottom - top) * (right - left)
        # Single pixels cannot be cut; of black regions, the largest comes first.
        return size == 1, -energy[top:bottom, left:right].sum(), -size, (top, bottom, left, right)

    regions = [entry(0, height, 0, width)]
    while len(regions) < count:
        top, bottom, left, right = heapq.heappop(regions)[-1]
        part = energy[top:bottom, left:right]
        # Rows and columns are equally far apart at the equator; towards the poles columns draw together.
        narrowing = np.sin(np.pi * 0.5 * (top + bottom) / height)
        across_columns = right - left > 1 and ((right - left) * narrowing > bottom - top or bottom - top == 1)
        profile = part.sum(axis=0 if across_columns else 1)
        before = np.cumsum(profile)[:-1]
        cut = 1 + int(np.argmin(np.abs(before - 0.5 * profile.sum()))) if profile.any() else len(profile) // 2
        if across_columns:
            halves = (top, bottom, left, left + cut), (top, bottom, left + cut, right)
        else:
            halves = (top, top + cut, left, right), (top + cut, bottom, left, right)
        for half in halves:
            heapq.heappush(regions, entry(*half))

    toward, power = np.empty((count, 3)), np.empty((count, 3))
    for i, (*_, (top, bottom, left, right)) in enumerate(regions):
        here = slice(top, bottom), slice(left, right)
        power[i] = light[here].sum(axis=(0, 1))
        centroid = np.tensordot(energy[here], directions[here], axes=2)
        # Where light comes from all sides alike, or from none, there is no centroid: any direction will do.
        lost = np.linalg.norm(centroid) <= 1e-12 * energy[here].sum()
        toward[i] = directions[(top + bottom) // 2, (left + right) // 2] if lost else fw.normalize(centroid)
    return toward, power
    ### END SOLUTION


# %% nbgrader={"grade_id": "ambient_visibility", "solution": true}
def ambient_visibility(sdf, p, normal, t_max):
    """How much of the sky a point sees, as a diffuse surface weights it.

    Parameters
    ----------
    sdf : callable             (N, 3) points -> (N,) distances
    p, normal : (N, 3) float   points on the surface and their unit normals
    t_max : float              how far occluders matter, scene units

    Returns
    -------
    (N,) float in [0, 1]       fraction of the cosine-weighted hemisphere that is free within t_max
    """
    ### BEGIN SOLUTION
    p, normal = np.broadcast_arrays(np.asarray(p, dtype=float), normal)
    shape = p.shape[:-1]
    p, normal = p.reshape(-1, 3), normal.reshape(-1, 3)
    cones = 16
    # Evenly on the disc below the hemisphere is evenly by cosine; a cone covers its share of the solid angle.
    i = np.arange(cones)
    radius, phi = np.sqrt((i + 0.5) / cones), i * np.pi * (3.0 - np.sqrt(5.0))
    cosine = np.sqrt(1.0 - radius**2)
    local = np.stack([radius * np.cos(phi), radius * np.sin(phi), cosine], axis=-1)
    # No wider than down to the horizon: there the surface itself begins.
    half_angle = np.minimum(np.sqrt(1.0 / (cones * cosine)), np.arcsin(cosine))
    frame = np.stack([*fw.orthonormal_frame(normal), normal], axis=1)
    direction = np.einsum("ci,nij->ncj", local, frame).reshape(-1, 3)
    origin, half_angle = np.repeat(p, cones, axis=0), np.tile(half_angle, len(p))

    offset, travelled = np.ones(len(origin)), np.full(len(origin), 0.005 * t_max)
    marching = np.arange(len(origin))
    for _ in range(64):
        if marching.size == 0:
            break
        t, angle = travelled[marching], half_angle[marching]
        distance = sdf(origin[marching] + t[:, None] * direction[marching])
        offset[marching] = np.minimum(offset[marching], np.arcsin(np.clip(distance / t, -1.0, 1.0)) / angle)
        travelled[marching] = t + np.maximum(np.abs(distance), 0.25 * angle * t)
        marching = marching[(offset[marching] > -1.0) & (travelled[marching] <= t_max)]
    x = np.clip(offset, -1.0, 1.0)
    visible = 0.5 + (x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / np.pi
    return visible.reshape(*shape, cones).mean(axis=-1)
    ### END SOLUTION


# %% nbgrader={"grade_id": "shade_with_shadows", "solution": true}
def shade_with_shadows(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Radiance towards the viewer under an environment, with shadows.

    Parameters
    ----------
    light : framework.EnvironmentLight
    sdf : callable                          (N, 3) points -> (N,) distances
    p, normal, view : (N, 3) float          points on the surface, unit normals, unit vectors to the viewer
    r0 : float, (3,) or (N, 3) float        reflectance at normal incidence
    roughness : float or (N,) float         in [0, 1]
    albedo : float, (3,) or (N, 3) float    diffuse reflectance
    t_max : float                           how far occluders matter, scene units

    Returns
    -------
    (N, 3) float   albedo / pi times the shadowed irradiance, plus the split sum shadowed along the mirror direction
    """
    ### BEGIN SOLUTION
    p, normal, view = np.broadcast_arrays(*(np.asarray(a, dtype=float) for a in (p, normal, view)))
    shape = p.shape
    p, normal, view = (a.reshape(-1, 3) for a in (p, normal, view))
    r0, albedo = (np.broadcast_to(np.asarray(a, dtype=float), shape).reshape(-1, 3) for a in (r0, albedo))
    roughness = np.broadcast_to(np.asarray(roughness, dtype=float), shape[:-1]).reshape(-1)

    def smallest_angle(origin, direction, width):
        """Smallest signed angle between each ray and an object; beyond -width the march stops."""
        smallest, travelled = np.full(len(origin), 0.5 * np.pi), np.full(len(origin), 0.005 * t_max)
        marching = np.arange(len(origin))
        for _ in range(64):
            if marching.size == 0:
                break
            t, limit = travelled[marching], width[marching]
            distance = sdf(origin[marching] + t[:, None] * direction[marching])
            angle = np.minimum(smallest[marching], np.arcsin(np.clip(distance / t, -1.0, 1.0)))
            smallest[marching] = angle
            travelled[marching] = t + np.maximum(np.abs(distance), 0.25 * limit * t)
            marching = marching[(angle > -limit) & (travelled[marching] <= t_max)]
        return smallest

    def diffuse():
        count = min(16, light.env.pixels[..., 0].size)
        toward, power = dominant_lights(light.env, count)
        # A light is as large as its power over the radiance it shows; not larger than its region may be.
        luminance = [0.2126, 0.7152, 0.0722]
        solid_angle = (power @ luminance) / np.maximum(light.env.radiance(toward) @ luminance, 1e-300)
        radius = np.arccos(1.0 - np.clip(solid_angle, 1e-3, 8.0 * np.pi / count) / (2.0 * np.pi))
        cosine = np.clip(normal @ toward.T, 0.0, 1.0)
        point, lamp = np.nonzero(cosine > 0.0)
        width = np.minimum(radius[lamp], np.arcsin(cosine[point, lamp]))  # down to the horizon
        x = np.clip(smallest_angle(p[point], toward[lamp], width) / width, -1.0, 1.0)
        reaching = cosine.copy()
        reaching[point, lamp] *= 0.5 + (x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / np.pi
        # The quotient of the two sums is what shadows take; without them nothing is left of the lights' coarseness.
        arriving = cosine @ power
        share = np.where(arriving > 0.0, (reaching @ power) / np.where(arriving > 0.0, arriving, 1.0), 1.0)
        return albedo * light.irradiance(normal) * share

    def specular():
        color = np.zeros_like(p)
        facing = np.sum(normal * view, axis=-1)
        lit = np.flatnonzero(facing > 0.0)
        if lit.size == 0:
            return color
        cosine, rough = np.minimum(facing[lit], 1.0), roughness[lit]
        mirror = fw.reflect(view[lit], normal[lit])

        def above(angle):
            """Share of the GGX lobe about the mirror direction on this side of a straight edge at an angle."""
            slope = np.tan(0.5 * angle)
            return 0.5 + 0.5 * slope / np.hypot(slope, np.maximum(rough, 0.01) ** 2)

        # The edge of the surface itself is in the table already.
        nearest = smallest_angle(p[lit], mirror, np.full(lit.size, 0.5 * np.pi))
        visible = np.minimum(above(nearest) / above(np.arcsin(cosine)), 1.0)
        size = np.array(light.lut.shape[:2])
        position = np.clip(np.stack([rough, cosine], axis=-1) * size - 0.5, 0.0, size - 1.0)
        first = np.minimum(position.astype(int), np.maximum(size - 2, 0))
        row, column = first.T
        down, right = (position - first).T[..., None]
        below, beside = np.minimum(row + 1, size[0] - 1), np.minimum(column + 1, size[1] - 1)
        upper = (1.0 - right) * light.lut[row, column] + right * light.lut[row, beside]
        lower = (1.0 - right) * light.lut[below, column] + right * light.lut[below, beside]
        scale, bias = np.moveaxis((1.0 - down) * upper + down * lower, -1, 0)[..., None]
        color[lit] = light.prefiltered(mirror, rough) * (r0[lit] * scale + bias) * visible[:, None]
        return color

    return (diffuse() + specular()).reshape(shape)
    ### END SOLUTION
