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
#
# ![A ball, a ring and a box under a photographed sky, with the shadows that the sky casts](goal.png)
#
# The last two notebooks lit surfaces by a whole sky with two look-ups, and had to pretend that nothing
# stands in the way. Compare a photograph: under the table it is dark, though no lamp is near. Each
# direction of the sky casts its own shadow, and what we see is their sum. In this notebook you will put
# shadows back, in three ways, and see what each of them leaves out and what it costs.
#
# You need the ideas of `soft_shadows` (how narrowly a ray misses) and `split_sum` (two look-ups).
#
# **How it works.** Each section explains one idea and asks for one function. Write it in place of
# `raise NotImplementedError()`, run the cell, then run the `check` under it: it tells you what it found,
# how far off you are and how far off you may be, and shows three pictures: yours, the expected one, and the
# difference. You may run it as often as you like. If a cell stops with a `NotImplementedError`, the line
# above the error names the function that is still to be written.
#
# **What is graded.** Only the cells that hold the functions are taken over from your notebook. Each of them
# may use `np`, `fw` and the functions above it, so if you need a helper or a constant, put it into the same
# cell. Each function is judged by itself, with right versions of the ones before it: one mistake never
# costs you twice.

# %%
import numpy as np

import framework as fw

# %% tags=["active-ipynb"]
# import time
#
# import matplotlib.pyplot as plt
#
# light = fw.EnvironmentLight.load("light.npz")
# fw.show.image(light.env.pixels, title="The light")

# %% tags=["active-ipynb"]
# from autograder import check, hint

# %% [markdown]
# ## Why this is hard
#
# The rendering equation with visibility:
#
# $$L_o = \int_\Omega L(l)\, f_r(l, v)\, (n \cdot l)\, V(l)\, \mathrm{d}l$$
#
# One way to see it is as **many lights**: each pixel of the sky is a lamp, and each lamp wants a shadow map
# or a ray. That is thousands of them. The other is as a **sampling** problem, and then $V$ is the trouble:
# it may be any shape, sharp at its edges, different at each point, and nothing about it is known before one
# looks.
#
# Could we take $V$ out of the integral, like the light before? The approximation is good where the support
# is small or one of the functions is smooth. For a polished surface the lobe is narrow: that works. For a
# matt one the support is the whole hemisphere, and $V$ is not smooth: it does not.
#
# So there is no general solution in real time. What engines do instead is to shadow **the brightest few
# lights**, for there the shadows are that one can see, or to take **visibility alone**, averaged over all
# directions.
#
# The scene: three objects on a floor, as distance fields and as meshes.

# %% tags=["active-ipynb"]
# ball = ((-1.0, 0.5, 0.1), 0.5)
# ring = ((0.15, 0.75, -0.7), 0.5, 0.16)
# box = ((0.9, 0.45, 0.5), (0.3, 0.45, 0.3))
# scene = fw.sdf.union(
#     fw.sdf.plane((0, 1, 0), 0.0), fw.sdf.sphere(*ball), fw.sdf.torus(*ring), fw.sdf.box(*box)
# )
# ring_mesh = fw.mesh.torus(*ring[1:])
# meshes = [
#     fw.mesh.plane(size=9.0),
#     fw.mesh.sphere(ball[1], ball[0]),
#     fw.Mesh(ring_mesh.vertices + ring[0], ring_mesh.faces, ring_mesh.normals),
#     fw.mesh.box(box[1], box[0]),
# ]
# albedo = np.array([[0.45, 0.43, 0.40], [0.10, 0.25, 0.42], [0.05, 0.05, 0.05], [0.55, 0.30, 0.08]])
# r0 = np.array([[0.04, 0.04, 0.04], [0.04, 0.04, 0.04], [0.95, 0.64, 0.35], [0.04, 0.04, 0.04]])
# roughness = np.array([0.8, 0.3, 0.25, 0.6])
# camera = fw.Camera(position=(-0.6, 2.6, 4.6), target=(0.0, 0.35, 0.0), up=(0, 1, 0), fov_y=0.5)
# t_max = 4.0
#
#
# def visible_points(width, height, meshes=meshes, camera=camera):
#     seen = [fw.rasterize(mesh, camera, width, height) for mesh in meshes]
#     nearest = np.argmin([one.depth for one in seen], axis=0)
#     mask = np.any([one.mask for one in seen], axis=0)
#     position = np.choose(nearest[..., None], [one.position for one in seen])[mask]
#     normal = fw.normalize(np.choose(nearest[..., None], [one.normal for one in seen])[mask])
#     return mask, nearest[mask], position, normal, fw.normalize(camera.position - position)
#
#
# mask, which, position, normal, view = visible_points(150, 100)
# print(f"{len(position):,} points to shade, each under {light.env.solid_angles().size:,} pixels of sky")

# %% [markdown]
# ## 5.1 The brightest few
#
# Replace the sky by `count` lamps that are infinitely far away. They should stand where the light comes
# from, and together they must be as bright as the sky, or the picture changes its brightness.
#
# **Median cut** does it with a few lines. Begin with the map as one region. Take the region with the most
# luminous energy (radiance, weighted by 0.2126, 0.7152, 0.0722, times *solid angle*), and cut it across its
# longer side, so that both halves have as nearly as possible the same energy. Go on until there are `count`
# regions. Rows and columns are equally far apart at the equator only: at the angle $\theta$ from the pole a
# column is $\sin\theta$ as wide as a row is high.
#
# Each region becomes a lamp:
# - its **power** is the sum over its pixels of radiance times solid angle, for each channel. All powers
#   together are the sum over the map;
# - its **direction** is the energy centroid, the mean of the pixels' directions weighted by energy, brought
#   to length 1.
#
# Mind the ends: a region of one pixel cannot be cut, one without light has no centroid (any unit vector
# will do). `count` may be anything from 1 to the number of pixels.


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


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-5-1", "points": 6}
# check("5.1")

# %% [markdown]
# Where the lamps are, with the size of a dot for the power of the lamp. Most of them gather around the sun.

# %% tags=["active-ipynb"]
# fig, axes = plt.subplots(1, 2, figsize=(10, 3))
# height = light.env.height
# for axis, count in zip(axes, (16, 128)):
#     direction, power = dominant_lights(light.env, count)
#     row = np.arccos(np.clip(direction[:, 1], -1, 1)) / np.pi * height
#     column = np.arctan2(direction[:, 0], -direction[:, 2]) % (2 * np.pi) / np.pi * height
#     axis.imshow(np.clip(light.env.pixels, 0, 1) ** 0.45)
#     axis.scatter(column, row, s=300 * np.sqrt(power[:, 1] / power[:, 1].sum()), facecolors="none", edgecolors="red")
#     axis.set_title(f"{count} lamps; the strongest has {power[:, 1].max() / power[:, 1].sum():.0%} of the power", fontsize=9)
#     axis.axis("off")
# plt.show()

# %% [markdown]
# ## 5.2 Visibility alone
#
# The second way forgets where the light comes from and asks how much of the sky a point can see at all:
#
# $$V_\text{ambient}(p) = \frac1\pi \int_\Omega V(l)\, (n \cdot l)\, \mathrm{d}l .$$
#
# Multiply the irradiance by it and corners get dark. Engines call it *ambient occlusion*. Rays would answer
# it, hundreds for each point. A **cone** answers for all directions within it at once: a distance field
# tells how narrowly its axis misses, and `soft_shadows` turned the smallest signed angle $\theta$ into the
# visible share of a round light of angular radius $\theta_c$:
#
# $$v(x) = \frac12 + \frac{x \sqrt{1 - x^2} + \arcsin x}{\pi}, \qquad
# x = \operatorname{clip}\left(\frac{\theta}{\theta_c}, -1, 1\right) .$$
#
# A few cones cover the hemisphere. A good way to place $K$ of them: spread points evenly over the unit
# *disc*, for example along a spiral, $r_i = \sqrt{(i + 0.5) / K}$, $\varphi_i = i\, \pi (3 - \sqrt 5)$, and
# lift them to the hemisphere, $z = \sqrt{1 - r^2}$. What is even on the disc has the density of the cosine
# above it, so that a plain mean is the answer. Each cone stands for a solid angle of $\pi / (K z)$, and a
# round cone of that size has the radius $\theta_c \approx 1 / \sqrt{K z}$. Let none reach below the
# horizon: there it would meet the surface it starts from, $\theta_c \le \arcsin z$.
#
# March as in 2.5: go on inside of things, by steps of at least a part of the cone's width. Begin a little
# off the surface, say at $t = t_\text{max} / 200$, and stop at `t_max`.


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


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-5-2", "points": 6}
# check("5.2")

# %% tags=["active-ipynb"]
# ambient = ambient_visibility(scene, position, normal, t_max)
# image = np.zeros(mask.shape)
# image[mask] = ambient
# fw.show.image(image, title="How much of the sky each point sees")

# %% [markdown]
# It is dark under the ring and where things stand on the floor. But there is no *shadow*: nothing shows
# where the sun is.
#
# ## 5.3 Shading with shadows
#
# Now the whole: a matt part and a glossy part, both with shadows.
#
# $$\frac{\text{albedo}}{\pi} \int L\, (n \cdot l)\, V\, \mathrm{d}l
# \;+\; L_\text{prefiltered}(r, \text{roughness}) \cdot (R_0\, \text{scale} + \text{bias}) \cdot V(r)$$
#
# How you do it is yours to choose. You are judged by the error against many rays, and once that is right,
# by the number of points that you hand to `sdf`. What works well:
#
# - **The matt part.** Some 16 lamps from 5.1, for each that is above the horizon one soft shadow ray as in
#   5.2. A lamp stands for a region and is not a point. How large is it? Its power is radiance times solid
#   angle, so divide its luminous power by the sky's luminance in its direction. From the solid angle
#   $\omega$ follows the radius, $\cos\theta_c = 1 - \omega / 2\pi$.
# - Sixteen lamps are a coarse sky. Let them tell only **what part** of the light is lost: the sum with
#   shadows over the sum without, for each channel, times the exact irradiance, `light.irradiance(normal)`
#   (which has been divided by $\pi$ already). Where nothing stands in the way this is exact, whatever the
#   lamps are.
# - **The glossy part.** The split sum, from `light.prefiltered` and `light.lut` (rows are roughness,
#   columns $n \cdot v$, at cell centres), and a cone along the mirror direction. A straight edge at the
#   angle $\theta$ from the axis leaves free the share $\frac12 + \frac{s}{2 \sqrt{s^2 + \alpha^2}}$ of a
#   GGX lobe, $s = \tan(\theta / 2)$. The horizon of the surface is in the table already, so divide by the
#   share above the horizon, and clip at 1. It is 0 where $n \cdot v \le 0$.


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


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-5-3", "points": 8}
# check("5.3")

# %% [markdown]
# ## What each choice leaves out
#
# Time to compare, on two scenes that differ in what is hard about them. The three objects stand under the clear
# sky, where most of the light comes from one place. A gate, two walls and a slab on top, stands under an overcast
# one, where it comes from everywhere and the walls hide much of it. The truth takes a ray from each point to each
# of 2592 directions, under skies of 16 rows, in which the sun is a large soft spot: more rows would take all day.

# %% tags=["active-ipynb"]
# posts = [((-0.9, 0.6, 0.0), (0.15, 0.6, 1.0)), ((0.9, 0.6, 0.0), (0.15, 0.6, 1.0)), ((0.0, 1.35, 0.0), (1.15, 0.15, 0.7))]
# gate = fw.sdf.union(fw.sdf.plane((0, 1, 0), 0.0), *(fw.sdf.box(*post) for post in posts))
# gate_meshes = [fw.mesh.plane(size=9.0)] + [fw.mesh.box(half_size, center) for center, half_size in posts]
# in_front = fw.Camera(position=(1.6, 1.7, 4.6), target=(0.1, 0.6, 0.0), up=(0, 1, 0), fov_y=0.5)
#
#
# def as_light(env):
#     """Only what the matt part needs: the map, and the irradiance of each normal."""
#     normals, to_pixel = fw.skies.constant(16).directions(), env.directions().reshape(-1, 3)
#     cosine = np.clip(normals @ to_pixel.T, 0, None) * env.solid_angles().reshape(-1)
#     irradiance = cosine @ env.pixels.reshape(-1, 3) / cosine.sum(axis=-1, keepdims=True)
#     return fw.EnvironmentLight(env, irradiance, light.chain, light.roughness_levels, light.lut)
#
#
# def is_free(sdf, p, direction):
#     t, free, marching = np.full(len(p), 0.02), np.ones(len(p), bool), np.arange(len(p))
#     for _ in range(48):
#         distance = sdf(p[marching] + t[marching, None] * direction[marching])
#         free[marching[distance < 2e-3]] = False
#         t[marching] += distance
#         marching = marching[(distance >= 2e-3) & (t[marching] < t_max)]
#         if not len(marching):
#             break
#     return free
#
#
# def lit_by(sdf, direction, power, p, n):
#     """Light of lamps, with a hard shadow ray to each of them."""
#     cosine = np.clip(n @ direction.T, 0, None)
#     point, lamp = np.nonzero(cosine)
#     cosine[point, lamp] *= is_free(sdf, p[point], direction[lamp])
#     return cosine @ power / np.pi
#
#
# to_sky, patch = (a.reshape(2592, -1) for a in (fw.skies.constant(36).directions(), fw.skies.constant(36).solid_angles()))
# cases = {}
# for name, sdf, env, seen in (
#     ("clear sky", scene, light.env.resized(16), visible_points(24, 16)),
#     ("overcast gate", gate, fw.skies.gradient(16), visible_points(24, 16, gate_meshes, in_front)),
# ):
#     mask, _, p, n, _ = seen
#     cases[name] = sdf, as_light(env), mask, p, n, lit_by(sdf, to_sky, env.radiance(to_sky) * patch, p, n)

# %% [markdown]
# Five methods that engines use, and yours, light the matt part:
#
# - **none**: the irradiance, without shadows;
# - **ambient visibility**: the irradiance times your 5.2;
# - **bent cone**: the same, but the irradiance is looked up along the axis of what is free, the mean of the free
#   directions among 16, instead of the normal;
# - **lamps + ambient**: the 4 brightest of your 16 lamps get a shadow ray each; the rest of the irradiance is
#   multiplied by the ambient visibility, and so nothing counts twice;
# - **Monte Carlo**: 256 random rays a point, spread by the cosine;
# - **shade_with_shadows**: your 5.3.

# %% tags=["active-ipynb"]
# def towards(n, xi):
#     """Directions about normals by the cosine: (N, 3), (N, S, 2) -> (N, S, 3)."""
#     radius, phi = np.sqrt(xi[..., 0]), 2 * np.pi * xi[..., 1]
#     local = np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - radius**2)], axis=-1)
#     return local @ np.stack([*fw.orthonormal_frame(n), n], axis=1)
#
#
# def free_rays(sdf, p, directions):
#     start = np.repeat(p, directions.shape[1], axis=0)
#     return is_free(sdf, start, directions.reshape(-1, 3)).reshape(directions.shape[:2])
#
#
# def none(sdf, light, p, n):
#     return light.irradiance(n)
#
#
# def ambient(sdf, light, p, n):
#     return light.irradiance(n) * ambient_visibility(sdf, p, n, t_max)[:, None]
#
#
# def bent_cone(sdf, light, p, n):
#     directions = towards(n, np.broadcast_to(fw.hammersley(16) + 1 / 32, (len(p), 16, 2)))
#     axis = np.einsum("ns,nsk->nk", free_rays(sdf, p, directions), directions) + 1e-6 * n
#     return light.irradiance(fw.normalize(axis)) * ambient_visibility(sdf, p, n, t_max)[:, None]
#
#
# def lamps_and_ambient(sdf, light, p, n):
#     direction, power = dominant_lights(light.env, 16)
#     few = np.argsort(power.sum(axis=1))[-4:]
#     without = np.clip(n @ direction[few].T, 0, None) @ power[few] / np.pi
#     rest = np.maximum(light.irradiance(n) - without, 0)
#     return lit_by(sdf, direction[few], power[few], p, n) + rest * ambient_visibility(sdf, p, n, t_max)[:, None]
#
#
# def monte_carlo(sdf, light, p, n):
#     directions = towards(n, np.random.default_rng(1).random((len(p), 256, 2)))
#     arriving = light.env.radiance(directions.reshape(-1, 3)).reshape(directions.shape)
#     return (arriving * free_rays(sdf, p, directions)[..., None]).mean(axis=1)
#
#
# def yours(sdf, light, p, n):
#     return shade_with_shadows(light, sdf, p, n, n, 0.0, 0.5, 1.0, t_max)
#
#
# methods = {
#     "none": none, "ambient visibility": ambient, "bent cone": bent_cone,
#     "lamps + ambient": lamps_and_ambient, "Monte Carlo, 256": monte_carlo, "shade_with_shadows": yours,
# }
# evaluations = 0
# answers, results = {}, {}
# for case, (sdf, sky, mask, p, n, truth) in cases.items():
#
#     def counting(q):
#         global evaluations
#         evaluations += len(q)
#         return sdf(q)
#
#     print(f"{case + ', ' + str(len(p)) + ' points':26s}  error   evaluations a point   milliseconds")
#     for name, method in methods.items():
#         evaluations, start = 0, time.perf_counter()
#         answers[case, name] = method(counting, sky, p, n)
#         milliseconds = 1e3 * (time.perf_counter() - start)
#         error = np.sqrt(np.mean((answers[case, name] - truth) ** 2) / np.mean(truth**2))
#         results[case, name] = error, evaluations / len(p), milliseconds
#         print(f"{name:26s} {error:6.1%}   {evaluations / len(p):12.0f}   {milliseconds:17.1f}")

# %% tags=["active-ipynb"]
# fig, axes = plt.subplots(1, 2, figsize=(10.5, 4), sharey=True, layout="constrained")
# for (case, name), (error, per_point, milliseconds) in results.items():
#     marker = dict(zip(methods, "osDv^P"))[name]
#     color = f"C{list(methods).index(name)}"
#     fill = color if case == "clear sky" else "none"
#     for axis, cost in zip(axes, (milliseconds, per_point)):
#         axis.plot(cost, error, marker, color=color, markerfacecolor=fill, markersize=8,
#                   label=name if fill == color and axis is axes[0] else None)
# axes[0].set_xscale("log")
# axes[0].set_xlabel("milliseconds")
# axes[1].set_xscale("symlog", linthresh=10)
# axes[1].set_xlim(-2, 6000)
# axes[1].set_xlabel("evaluations of the field, a point")
# axes[0].set_yscale("log")
# axes[0].set_ylabel("relative error (filled: clear sky, open: overcast gate)")
# fig.legend(loc="outside right upper", fontsize=9)
# plt.show()

# %% [markdown]
# Where are they wrong? Purple is too dark, orange too bright, in parts of the scene's mean light, white is right and
# grey the sky behind; all on one scale.

# %% tags=["active-ipynb"]
# fig, axes = plt.subplots(2, len(methods), figsize=(12.5, 3.4), layout="constrained")
# for row, (case, (_, _, mask, p, _, truth)) in zip(axes, cases.items()):
#     for axis, name in zip(row, methods):
#         picture = np.full(mask.shape, np.nan)
#         picture[mask] = (answers[case, name] - truth).mean(axis=1) / truth.mean()
#         shown = axis.imshow(picture, cmap="PuOr_r", vmin=-0.5, vmax=0.5)
#         axis.set_title(name if case == "clear sky" else "", fontsize=9)
#         axis.set_facecolor("0.75")
#         axis.set_xticks([])
#         axis.set_yticks([])
#     row[0].set_ylabel(case, fontsize=9)
# fig.colorbar(shown, ax=axes, shrink=0.8)
# plt.show()

# %% [markdown]
# What each of them leaves out:
#
# - **none** leaves out everything. Under the gate its floor is lit like a field.
# - **ambient visibility** forgets where the light comes from. Under the overcast sky that is a good bargain: two
#   thirds of the error are gone. Under the clear one it gains next to nothing, for what is hidden is seldom the sun.
# - **bent cone** knows on which side it is open, though not what of the sky is to be seen there: better in both, and
#   never a shadow with an edge.
# - **lamps + ambient** has the shadow of the sun, the one that everybody sees; what is not in the 4 lamps is treated as
#   by ambient visibility. It needs a light that a few lamps can stand for.
# - **Monte Carlo** leaves out nothing, and is noise instead: right on average, at ten times the evaluations. Under the
#   overcast sky it is the best of all. Under the clear one it is the worst: most rays look past the sun.
# - **shade_with_shadows** takes each lamp for a round light and everything in its way for a straight edge. Where the
#   light comes through a gap between two walls, that is wrong.
#
# So there is no best method, only one that suits a light. And none of them, not even the truth here, knows light that
# bounces between things, or the mirror image of the object that hides the sky, with its colour. All this is known as
# global illumination, and is where the lecture goes next.
#
# ## The picture

# %% tags=["active-ipynb"]
# def render(width, height):
#     mask, which, p, n, v = visible_points(width, height)
#     image = 0.5 * light.env.radiance(camera.rays(width, height)[1])
#     color = np.empty_like(p)
#     for i in range(0, len(p), 20000):
#         part = slice(i, i + 20000)
#         of = which[part]
#         color[part] = shade_with_shadows(
#             light, scene, p[part], n[part], v[part], r0[of], roughness[of], albedo[of], t_max
#         )
#     image[mask] = 0.5 * color
#     return image
#
#
# fw.show.image(render(150, 100))

# %% [markdown]
# ## A question
#
# Answer in a few sentences of your own, in the cell below (2 points, read by a person):
#
# - For a polished surface one may take $V$ out of the integral, for a matt one not. Why?
# - Somebody draws the sun as a lamp with a shadow, and lights the scene by the irradiance map of the same
#   sky besides. What is wrong with the picture, and what must be done to the map?

# %% [markdown] nbgrader={"grade_id": "question-5", "solution": true, "points": 2}
# The approximation is good where the support of the rest of the integrand is small, or V is smooth. The
# lobe of a polished surface is a few degrees wide, and within it V is mostly 0 or 1 throughout. A matt
# surface looks at the whole hemisphere, in which V is cut by sharp edges and correlated with the light:
# whether an occluder hides the sun or a dark piece of sky makes all the difference, and the mean of V does
# not know it.
#
# The sun counts twice: once as a lamp and once in the map. Everything in the sun is too bright, and the
# shadows are filled with sunlight from the map that nothing blocks. Take the sun's pixels out of the map
# before it is filtered, so that lamp and map together have the energy of the sky.

# %% [markdown]
# ## Where to go from here
#
# - Replace the light by `fw.skies.gradient(32)`, filtered with your functions of `prefilter`, a cloudy day:
#   which of the ways is the best now?
# - Give the box a hole, or move the ring through the ball: the field is all that has to change.
# - Find the point of the picture with the largest error, and say which assumption failed there.
