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
# # Soft shadows
#
# ![A ring, a ball and a box; their shadows are sharp at the foot and soft further out](goal.png)
#
# Look at the shadow of a lamp post: sharp at its foot, blurred at its tip. Lights have a size, and a point
# in the blur sees a part of the light. To find out how large a part, one would send many rays to the light.
# In this notebook you will do it with **one ray**, because a distance field says at each point of the ray
# not only that nothing was hit, but *how narrowly it was missed*.
#
# You need the idea of the notebook `sphere_tracing`: the value of a signed distance field at a point is the
# radius of an empty ball about it. The fields themselves come from `fw.sdf` here.
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

# %% tags=["active-ipynb"]
# import matplotlib.pyplot as plt
#
# import framework as fw

# %% tags=["active-ipynb"]
# from autograder import check, hint

# %% [markdown]
# ## 2.1 The safe angle
#
# Stand at the point $o$ that is to be shaded and look along the ray to the light. At distance $t$ along the
# ray, the field says $h = f(o + t\,d)$: the ball of radius $h$ about that point is empty. Seen from $o$,
# this ball covers a cone around the ray. Its outermost rays are tangents to the ball, and a tangent makes a
# right angle with the radius: $t$ is the hypotenuse, $h$ the side opposite, so the half angle of the cone
# is
#
# $$\theta = \arcsin \frac{h}{t} .$$
#
# Within this angle nothing can be in the way, *at that distance*. All along the ray, what counts is the
# narrowest place: the **smallest** angle of all visited points. The smaller it is, the closer something
# comes to the line between $o$ and the light, and the less of the light can be seen.
#
# Mind the ends. On and inside an object ($h \le 0$) the angle is 0. Where the ball holds $o$ itself
# ($h \ge t$), there is no tangent, and the angle is as large as it gets, $\pi/2$. At $t \le 0$ outside of objects
# it is $\pi/2$, too. `np.where` chooses between cases, but computes both: see to it that it never divides
# by zero or asks for the arcsine of 2.


# %% nbgrader={"grade_id": "safe_angle", "solution": true}
def safe_angle(distance, travelled):
    """Angle about the ray, seen from its start, within which nothing is in the way.

    Parameters
    ----------
    distance : (...) float     signed distance to the scene, scene units
    travelled : (...) float    distance from the ray's start, scene units

    Returns
    -------
    (...) float in [0, pi/2]   0 on and inside an object, pi/2 where the safe sphere holds the start
    """
    ### BEGIN SOLUTION
    distance, travelled = np.broadcast_arrays(distance, travelled)
    inside, around = distance <= 0, distance >= travelled
    sine = distance / np.where(inside | around, 1.0, travelled)
    return np.arcsin(np.where(inside, 0.0, np.where(around, 1.0, sine)))
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-2-1", "points": 3}
# check("2.1")

# %% [markdown]
# Here is a ray on its way up, past a ball. Each circle is an empty ball that a step relied on, the lines
# are its tangents from $o$. The red pair is the narrowest.

# %% tags=["active-ipynb"]
# def ball_beside(p):
#     return np.hypot(p[..., 0] - 1.0, p[..., 1] - 2.2) - 0.6
#
#
# visited = []
# t = 0.3
# while t < 5.0:
#     distance = ball_beside(np.array([0.0, t]))
#     visited.append((t, distance, safe_angle(distance, t)))
#     t = t + distance
#
# narrowest = min(angle for _, _, angle in visited)
# plt.figure(figsize=(5, 5.5))
# plt.gca().add_patch(plt.Circle((1.0, 2.2), 0.6, color="0.75"))
# for t, distance, angle in visited:
#     color = "tab:red" if angle == narrowest else "tab:blue"
#     plt.gca().add_patch(plt.Circle((0, t), distance, fill=False, color=color))
#     length = np.sqrt(max(t * t - distance * distance, 0))
#     for side in (-1, 1):
#         plt.plot([0, side * length * np.sin(angle)], [0, length * np.cos(angle)], color=color, linewidth=0.8)
# plt.plot([0, 0], [0, 5], "k--", linewidth=0.8)
# plt.axis("scaled")
# plt.title(f"smallest safe angle: {np.degrees(narrowest):.1f} degrees")
# plt.show()

# %% [markdown]
# ## 2.2 The cheap way: a penumbra from a ratio
#
# The light is a disc. Let $\theta_L$ be its angular radius, half the angle under which it is seen. If the
# safe angle is at least $\theta_L$, nothing stands before the light: visibility 1. If it is 0, something
# touches the line to the light's centre: the estimate says 0. Between them the simplest guess is the
# quotient $\theta / \theta_L$.
#
# Shaders count every instruction, and for small angles $\arcsin x$ is nearly $x$. So the lecture leaves it
# out:
#
# $$v = \min\left\{ \frac{k\, h}{t},\ 1 \right\}, \qquad k = \frac{1}{\sin \theta_L} .$$
#
# $k$ has a meaning, then: it is 1 over the sine of the light's angular radius. Large $k$, small light, hard
# shadow.
#
# | $k$ | angular radius of the light | what it is like |
# | --- | --- | --- |
# | 2 | 30° | a window close by |
# | 8 | 7.2° | a lamp with a shade |
# | 32 | 1.8° | a bare bulb across the room |
# | 215 | 0.27° | the sun |
#
# The same ends as before: 0 on and inside objects, also where $t \le 0$; 1 at $t \le 0$ outside.


# %% nbgrader={"grade_id": "penumbra", "solution": true}
def penumbra(distance, travelled, k):
    """Visibility estimated from one step of the march.

    Parameters
    ----------
    distance : (...) float     signed distance to the scene, scene units
    travelled : (...) float    distance from the shading point, scene units
    k : float                  1 / sin(angular radius of the light); larger is harder

    Returns
    -------
    (...) float in [0, 1]      0 on and inside an object, 1 at the shading point itself

    Notes
    -----
    Quilez 2010: k times the ratio stands in for the safe angle over the light's radius.
    """
    ### BEGIN SOLUTION
    distance, travelled = np.broadcast_arrays(distance, travelled)
    blocked, clear = distance <= 0, k * distance >= travelled
    ratio = k * distance / np.where(blocked | clear, 1.0, travelled)
    return np.where(blocked, 0.0, np.where(clear, 1.0, ratio))
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-2-2", "points": 3}
# check("2.2")

# %% [markdown]
# Where do the two ways part? As angles, left: up to 10° they differ by half a percent, at 30° by 5 %, at 90°
# by 57 %. As visibilities, right, less of it is left, since each is divided by the light's own radius and both
# begin at 0 and end at 1. Only for a light that covers a good part of the sky, $k$ below 2, can you see which
# one was used.

# %% tags=["active-ipynb"]
# fig, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6))
# ratio = np.linspace(0, 1, 400)
# left.plot(ratio, np.degrees(safe_angle(ratio, 1.0)), label="arcsin(h / t)")
# left.plot(ratio, np.degrees(penumbra(ratio, 1.0, k=1.0)), "--", label="h / t")
# left.set_xlabel("h / t")
# left.set_ylabel("angle, degrees")
# left.legend()
# for k, style in ((1, "-"), (2, "--"), (8, ":")):
#     by_angle = np.minimum(safe_angle(ratio, 1.0) / np.arcsin(1 / k), 1)
#     apart = penumbra(ratio, 1.0, k) - by_angle
#     right.plot(k * ratio, apart, style, label=f"k = {k}: {apart.max():.3f} at most")
# right.set_xlim(0, 1)
# right.set_xlabel("k h / t")
# right.set_ylabel("visibility: ratio − angle")
# right.legend()
# plt.show()

# %% [markdown]
# ## 2.3 Points that need no ray
#
# A surface that faces away from the light is dark, whatever lies between: the cosine $n \cdot l$ in the
# rendering equation is not positive, and the answer is known before any ray starts. The fastest ray is the
# one that is never sent.
#
# Return `True` where the light is above the horizon of the point, $n \cdot l > 0$, where alone a shadow ray
# is needed.


# %% nbgrader={"grade_id": "needs_shadow_ray", "solution": true}
def needs_shadow_ray(normal, to_light):
    """Whether a shadow ray can change the picture at all.

    Parameters
    ----------
    normal : (N, 3) float      unit normals
    to_light : (3,) or (N, 3) float   unit vectors towards the light

    Returns
    -------
    (N,) bool                  true where the light is above the horizon
    """
    ### BEGIN SOLUTION
    return np.sum(np.multiply(normal, to_light), axis=-1) > 0
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-2-3", "points": 2}
# check("2.3")

# %% tags=["active-ipynb"]
# camera = fw.Camera(position=(0, 3, 4), target=(0, 0, 0), up=(0, 1, 0), fov_y=0.6)
# seen = fw.rasterize(fw.mesh.torus(), camera, 300, 200)
# ray = seen.mask & needs_shadow_ray(seen.normal, fw.normalize([1.0, 0.1, 0.3]))
# grey = np.where(ray, 0.8, np.where(seen.mask, 0.15, 0.0))
# title = f"{ray.sum()} points need a ray, the {seen.mask.sum() - ray.sum()} darker do not"
# fw.show.image(np.repeat(grey[..., None], 3, axis=2), title=title)

# %% [markdown]
# ## 2.4 Soft shadows with one ray
#
# Now put it together. March from each point towards the light, as in sphere tracing, but do not begin at 0:
# there the point's own surface is as near as can be. Begin at $t_\text{min}$.
#
# 1. At a visited point with $t \le t_\text{max}$, evaluate $h = f(o + t\,l)$ once.
# 2. Closer than $10^{-4}$: the ray is blocked, the visibility is 0, the march is over.
# 3. Otherwise keep the smaller one of what you have and `penumbra(h, t, k)`; go on to $t + h$.
# 4. Past $t_\text{max}$, or after `max_steps` evaluations, the ray keeps what it has. It starts with 1.
#
# Evaluate only the rays that still march: part of the points is for the number of points that you hand to
# `sdf`.


# %% nbgrader={"grade_id": "soft_shadow", "solution": true}
def soft_shadow(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """How much of the light is seen, from the smallest penumbra along one ray.

    Parameters
    ----------
    sdf : callable             (N, 3) points -> (N,) distances
    origin : (N, 3) float      shading points
    to_light : (3,) or (N, 3) float   unit vectors towards the light
    k : float                  1 / sin(angular radius of the light)
    t_min, t_max : float       where the march starts and ends, scene units along the ray
    max_steps : int            evaluations of sdf that each ray may use

    Returns
    -------
    (N,) float in [0, 1]       0 for a ray that comes closer than 1e-4 to an object
    """
    ### BEGIN SOLUTION
    origin, to_light = np.broadcast_arrays(np.asarray(origin, dtype=float), to_light)
    shape = origin.shape[:-1]
    origin, to_light = origin.reshape(-1, 3), to_light.reshape(-1, 3)
    visibility = np.ones(len(origin))
    travelled = np.full(len(origin), float(t_min))
    marching = np.flatnonzero(travelled <= t_max)
    for _ in range(max_steps):
        if marching.size == 0:
            break
        here = travelled[marching]
        distance = sdf(origin[marching] + here[:, None] * to_light[marching])
        blocked = distance < 1e-4
        seen = np.where(blocked, 0.0, penumbra(distance, here, k))
        visibility[marching] = np.minimum(visibility[marching], seen)
        here = here + distance
        travelled[marching] = here
        marching = marching[~blocked & (here <= t_max)]
    return visibility.reshape(shape)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-2-4", "points": 6}
# check("2.4")

# %% [markdown]
# A floor from above, with a ball, a ring and a box on or over it, and three lights of different size from
# the same direction. Where an object stands on the floor its shadow begins sharp, whatever the light: $t$
# is small there, and $k h / t$ reaches 1 quickly.

# %% tags=["active-ipynb"]
# ball = fw.sdf.sphere((-1.1, 0.6, 0.3), 0.5)
# ring = fw.sdf.torus((-0.1, 0.9, -0.8), 0.5, 0.14)
# box = fw.sdf.box((0.6, 0.6, 0.8), (0.25, 0.6, 0.25))
# objects = fw.sdf.union(ball, ring, box)
# to_light = fw.normalize([-0.8, 1.0, 0.4])
#
#
# def floor(size, extent=2.4):
#     side = extent * ((2 * np.arange(size) + 1) / size - 1)
#     x, z = np.meshgrid(side, side)
#     return np.stack([x, np.zeros_like(x), z], axis=-1).reshape(-1, 3)
#
#
# size = 160
# fig, axes = plt.subplots(1, 3, figsize=(9.5, 3), layout="constrained")
# for axis, k in zip(axes, (2, 8, 32)):
#     visible = soft_shadow(objects, floor(size), to_light, k, t_min=0.02, t_max=8.0, max_steps=64)
#     shown = axis.imshow(visible.reshape(size, size), cmap="gray", vmin=0, vmax=1)
#     axis.set_title(f"k = {k}: a light of {np.degrees(np.arcsin(1 / k)):.1f}° radius", fontsize=10)
#     axis.set_xticks([])
#     axis.set_yticks([])
# fig.colorbar(shown, ax=axes, label="visible part of the light")
# plt.show()

# %% [markdown]
# ## How right is it?
#
# A guess should be measured. The truth is easy to get, only slow: send several hundred rays to points
# spread over the disc of the light, and count how many arrive. For hard shadows we need no new function:
# with an enormous $k$ yours says 0 for a ray that is blocked and 1 for any other.
#
# The plot runs along the floor, from the middle of a ball's shadow outwards, with the light right above.

# %% tags=["active-ipynb"]
# def rays_to_disc(to_light, angular_radius, count):
#     i = np.arange(count)  # the golden angle spreads points evenly over a disc
#     r, angle = np.tan(angular_radius) * np.sqrt((i + 0.5) / count), i * np.pi * (3 - np.sqrt(5))
#     u = fw.normalize(np.cross(to_light, [1.0, 0.0, 0.0]))
#     w = np.cross(to_light, u)
#     return fw.normalize(to_light + (r * np.cos(angle))[:, None] * u + (r * np.sin(angle))[:, None] * w)
#
#
# def true_visibility(sdf, origin, to_light, angular_radius, count=256):
#     direction = rays_to_disc(to_light, angular_radius, count)
#     start = np.repeat(origin, count, axis=0)
#     reached = soft_shadow(sdf, start, np.tile(direction, (len(origin), 1)), 1e9, 0.02, 8.0, 200)
#     return reached.reshape(-1, count).mean(axis=1)
#
#
# high_ball = fw.sdf.sphere((0, 1.6, 0), 0.8)
# overhead = np.array([0.0, 1.0, 0.0])
# k, x = 5, np.linspace(0, 1.6, 120)
# line = np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=-1)
# truth = true_visibility(high_ball, line, overhead, np.arcsin(1 / k))
# lecture = soft_shadow(high_ball, line, overhead, k, 0.02, 8.0, 200)
#
# plt.figure(figsize=(7, 3.5))
# plt.plot(x, truth, "k", label="256 rays a point")
# plt.plot(x, lecture, "tab:red", label="min(k h / t, 1)")
# at_edge = np.interp(0.8, x, truth) - np.interp(0.8, x, lecture)
# plt.axvline(0.8, color="0.6", linestyle=":", label=f"under the ball's edge: {at_edge:.2f} off")
# plt.xlabel("distance from the middle of the shadow, scene units")
# plt.ylabel("visible part of the light")
# plt.legend()
# plt.show()

# %% [markdown]
# The shape is right, but the shadow is too dark and too wide. Look at the dotted line, the point from which
# the ray to the light's centre just touches the ball. Half of the disc is free there, yet the estimate is 0, since $h$ is: **an
# error of one half, at the edge**, and more than a quarter on average over the half shade. And further in it
# stays 0, while a part of the light can still be seen. The estimate uses only the outer half of the half
# shade.
#
# This is no mistake of yours. It is what was thrown away: the march stopped at the surface, so all points
# in the inner half look the same.
#
# ## 2.5 Going on inside
#
# Distances have a sign. Let the march go *on* inside the object, and keep the smallest **signed** angle
#
# $$\theta = \arcsin \frac{h}{t}, \qquad x = \frac{\theta}{\theta_L} .$$
#
# Negative now says by how much the line to the light's centre is buried. $x = 1$: the light is free.
# $x = -1$: all of it is hidden, and the march may stop. Between the two, take the edge of the object for a
# straight line across the disc, at $x$ radii from its centre. The part on the free side is a segment of a
# circle, and its share of the disc is
#
# $$v(x) = \frac12 + \frac{x \sqrt{1 - x^2} + \arcsin x}{\pi}, \qquad -1 \le x \le 1 .$$
#
# Check it in your head: $v(-1) = 0$, $v(0) = \frac12$, $v(1) = 1$.
#
# Two things are different from 2.4. Inside, $h$ is negative: step by $\lvert h \rvert$, which is just as
# safe. And at a surface $\lvert h \rvert$ is 0, and the march would stand still. It must be pushed through,
# so give the step a lower limit. A good limit is a part of the light's width where you are, such as
# $\theta_L\, t / 4$: small enough to meet the narrowest place, large enough to get on.
#
# Full points are for an error near that of our own solution, measured against rays to the disc; the
# unsigned form earns half.


# %% nbgrader={"grade_id": "area_light_shadow", "solution": true}
def area_light_shadow(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Visible fraction of a round light, from the smallest signed angle along one ray.

    Parameters
    ----------
    sdf : callable             (N, 3) points -> (N,) distances
    origin : (N, 3) float      shading points
    to_light : (3,) or (N, 3) float   unit vectors towards the light's centre
    angular_radius : float     half the angle under which the light is seen, radians
    t_min, t_max : float       where the march starts and ends, scene units along the ray
    max_steps : int            evaluations of sdf that each ray may use

    Returns
    -------
    (N,) float in [0, 1]       1/2 where the ray grazes a straight edge

    Notes
    -----
    The march goes on inside the occluder, by steps of at least a quarter of the light's radius as seen
    from the start: steps of a tenth change the mean error by less than 5 %.
    """
    ### BEGIN SOLUTION
    origin, to_light = np.broadcast_arrays(np.asarray(origin, dtype=float), to_light)
    shape = origin.shape[:-1]
    origin, to_light = origin.reshape(-1, 3), to_light.reshape(-1, 3)
    offset = np.ones(len(origin))
    travelled = np.full(len(origin), float(t_min))
    marching = np.flatnonzero(travelled <= t_max)
    for _ in range(max_steps):
        if marching.size == 0:
            break
        here = travelled[marching]
        distance = sdf(origin[marching] + here[:, None] * to_light[marching])
        sine = np.clip(distance / np.maximum(here, np.finfo(float).tiny), -1.0, 1.0)
        smallest = np.minimum(offset[marching], np.arcsin(sine) / angular_radius)
        offset[marching] = smallest
        here = here + np.maximum(np.abs(distance), 0.25 * angular_radius * here)
        travelled[marching] = here
        marching = marching[(smallest > -1.0) & (here <= t_max)]
    x = np.clip(offset, -1.0, 1.0)
    visible = 0.5 + (x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / np.pi
    return visible.reshape(shape)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-2-5", "points": 6}
# check("2.5")

# %% tags=["active-ipynb"]
# signed = area_light_shadow(high_ball, line, overhead, np.arcsin(1 / k), 0.02, 8.0, 200)
#
# plt.figure(figsize=(7, 3.5))
# plt.plot(x, truth, "k", label="256 rays a point")
# plt.plot(x, lecture, "tab:red", label="min(k h / t, 1)")
# plt.plot(x, signed, "tab:blue", linestyle="--", label="signed angle")
# plt.xlabel("distance from the middle of the shadow, scene units")
# plt.ylabel("visible part of the light")
# plt.legend()
# plt.show()

# %% [markdown]
# How much of the error is repaired, for a large, a middle and a small light? What counts is the half shade:
# the points that see a part of the light and not all of it. For a large light the ball's edge is no straight
# line across the disc any more, and the repair is less complete.

# %% tags=["active-ipynb"]
# def errors(k, count=60):
#     x = np.linspace(0, 4.0, 2000)
#     v = area_light_shadow(high_ball, x[:, None] * [1, 0, 0], overhead, np.arcsin(1 / k), 0.02, 8.0, 200)
#     half_shade = np.linspace(*x[(v > 0) & (v < 1)][[0, -1]], count)[:, None] * [1, 0, 0]
#     true = true_visibility(high_ball, half_shade, overhead, np.arcsin(1 / k))
#     one_ray = soft_shadow(high_ball, half_shade, overhead, k, 0.02, 8.0, 200)
#     on_inside = area_light_shadow(high_ball, half_shade, overhead, np.arcsin(1 / k), 0.02, 8.0, 200)
#     counts = (true > 0.02) & (true < 0.98)
#     return [np.abs(estimate - true)[counts].mean() for estimate in (one_ray, on_inside)]
#
#
# print("mean error in the half shade")
# for k in (2, 8, 32):
#     one_ray, on_inside = errors(k)
#     print(f"k = {k:2d}   min(k h / t, 1): {one_ray:.3f}   signed angle: {on_inside:.3f}")

# %% [markdown]
# ## What a distance field costs
#
# Our scenes are formulas: a ball is four numbers. A modelled object is not a formula, so engines *store*
# its field in a grid of values and interpolate. That is where the price of these cheap rays is paid: eight
# times the memory and the time for twice the resolution, and details smaller than a cell are lost.

# %% tags=["active-ipynb"]
# import time
#
# for n in (32, 64, 128):
#     start = time.perf_counter()
#     side = np.linspace(-2.4, 2.4, n)
#     grid = objects(np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1)).astype(np.float32)
#     seconds = time.perf_counter() - start
#     print(f"{n:4d}^3 values: {grid.nbytes / 2**20:6.1f} MiB, {seconds:.3f} s to build, a cell is {4.8 / n:.3f} wide")

# %% [markdown]
# A picture at sixty a second has 0.017 s, all in all. And these are three primitives; for a mesh of a
# hundred thousand triangles each value asks for the nearest one of them. As long as nothing moves this is done once,
# ahead of time. A shadow map, on the other hand, is drawn anew in every frame, and does not care. So the
# lecture's conclusion: shadows from distance fields are fast and look good, **if** the field is there. An
# object that moves as a whole still has its field, you only carry the query point into its frame:
# $f(R^{-1}(p - c))$. One that bends needs a new one.
#
# ## The picture
#
# The pieces of a renderer: a rasteriser finds the visible points of a mesh, your functions light them. Each
# object is drawn by itself, and each pixel takes the nearest one. Then only the points that face the light
# send a ray, one each, through the *distance field* of the scene: it is never asked for anything but
# shadows.

# %% tags=["active-ipynb"]
# meshes = [
#     fw.mesh.plane(size=9.0),
#     fw.mesh.sphere(0.5, (-1.1, 0.6, 0.3)),
#     fw.mesh.torus(0.5, 0.14),
#     fw.mesh.box((0.25, 0.6, 0.25), (0.6, 0.6, 0.8)),
# ]
# meshes[2] = fw.Mesh(meshes[2].vertices + [-0.1, 0.9, -0.8], meshes[2].faces, meshes[2].normals)
# colors = np.array([[0.40, 0.38, 0.36], [0.10, 0.25, 0.42], [0.55, 0.14, 0.07], [0.55, 0.36, 0.08]])
# camera = fw.Camera(position=(-0.4, 3.4, 4.8), target=(0.25, 0.4, 0.0), up=(0, 1, 0), fov_y=0.56)
#
#
# def render(width, height):
#     seen = [fw.rasterize(mesh, camera, width, height) for mesh in meshes]
#     nearest = np.argmin([one.depth for one in seen], axis=0)
#     mask = np.any([one.mask for one in seen], axis=0)
#     position = np.choose(nearest[..., None], [one.position for one in seen])[mask]
#     normal = np.choose(nearest[..., None], [one.normal for one in seen])[mask]
#
#     visible = np.zeros(len(position))
#     ray = needs_shadow_ray(normal, to_light)
#     start = position[ray] + 0.01 * normal[ray]
#     visible[ray] = area_light_shadow(objects, start, to_light, np.arcsin(1 / 12), 0.02, 8.0, 128)
#
#     sun = visible * np.clip(normal @ to_light, 0, 1)
#     light = 1.6 * sun[:, None] * [1.0, 0.93, 0.80] + 0.3 * (0.6 + 0.4 * normal[:, 1:2]) * [0.75, 0.87, 1.0]
#     image = np.full((height, width, 3), [0.45, 0.60, 0.80])
#     image[mask] = colors[nearest[mask]] * light
#     return image
#
#
# fw.show.image(render(300, 200))

# %% [markdown]
# What did it save to leave out the points that face away? Count the evaluations of the field with and without
# 2.3, for the ball alone, seen from the side that is mostly turned away from the light. A ray from there would run
# through the ball's inside, and learn what the cosine had told already.

# %% tags=["active-ipynb"]
# seen = fw.rasterize(meshes[1], fw.Camera((3.2, 1.2, 2.6), (-1.1, 0.6, 0.3), (0, 1, 0), 0.3), 120, 120)
# p, n = seen.position[seen.mask], seen.normal[seen.mask]
# for name, chosen in (("all points", np.ones(len(p), bool)), ("those that face the light", needs_shadow_ray(n, to_light))):
#     evaluations = []
#
#     def counting(q):
#         evaluations.append(len(q))
#         return objects(q)
#
#     area_light_shadow(counting, p[chosen] + 0.01 * n[chosen], to_light, np.arcsin(1 / 12), 0.02, 8.0, 128)
#     print(f"{name}: {chosen.sum()} rays, {sum(evaluations)} evaluations")

# %% [markdown]
# ## What the picture did not need
#
# The fastest ray is the one that is never sent. `fw.render_scene` draws a scene with *your* functions, and
# returns a plan beside the picture: for each pass what it cost, what was saved, and why. Here a ring floats
# over a floor.
#
# Read the line `shadow 0`. The floor has thousands of points that face the lamp: why do most of them need no
# ray? Move the ring lower, make the lamp larger with a smaller `k`, and say before you look which way the
# number of rays will go.

# %% tags=["active-ipynb"]
# def ring_over_floor(height, k):
#     ring = fw.sdf.torus((0, height, 0), 0.5, 0.14)
#     floor = fw.SceneObject(fw.mesh.plane(8.0), fw.Material(r0=0, albedo=0.7), casts=ring)
#     camera = fw.Camera((2.5, 3.0, 3.5), (0, 0.2, 0), (0, 1, 0), 0.6)
#     return fw.Scene(camera, [floor], lights=[fw.Light((-0.8, 1.0, 0.4), 0.9 * k**2, k)], reach=8.0)
#
#
# picture, plan = fw.render_scene(ring_over_floor(height=0.9, k=8), 180, 120, globals())
# fw.show.image(picture)
# print(plan)

# %% [markdown]
# ## A question
#
# Answer in a few sentences of your own, in the cell below (2 points, read by a person):
#
# - Why does `min(k h / t, 1)` say 0 at a point that sees half of the light, and why can no choice of $k$
#   mend that?
# - The signed form is much better, but not exact. Name a scene in which it goes wrong, and say whether the
#   shadow is too bright or too dark there, and why.

# %% [markdown] nbgrader={"grade_id": "question-2", "solution": true, "points": 2}
# At the edge the ray to the light's centre touches the object: the smallest h is 0, so any multiple of it
# is 0. The estimate knows only whether and how narrowly the centre ray was missed, and the points in the
# inner half of the half shade, where the centre is hidden but a part of the disc is not, all have a blocked
# ray. A smaller k only widens the outer half.
#
# An occluder thinner than the light's width where it stands: inside it h never becomes as negative as the
# light is wide, so x stays above -1 and the shadow stays too bright in the middle of what should be dark,
# or, for a thin wire before a large light, the straight edge that is assumed hides one half although the
# wire hides much less, and it is too dark. Two objects on opposite sides of the ray: the smallest angle
# knows only one of them, the other one's shadow is not added, too bright. Corners: two edges at once, or a
# disc that is not cut by a straight line.

# %% [markdown]
# ## Where to go from here
#
# - Set the light's radius in the picture to that of the sun, 0.0047, and to 0.4.
# - The box's shadow has fine bands near its tip: there the narrowest place lies between two steps. A smaller lower
#   limit of the step, or an upper one, makes them finer. What does it cost?
# - Move the ring through the floor, or put a thin post (`fw.sdf.capsule`) before the light.
# - All light came from one disc so far. The next notebook, `prefilter`, takes it from everywhere: an
#   environment map.
