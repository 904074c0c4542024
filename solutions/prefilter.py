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
# # Prefiltered environments
#
# ![A ball with a groove on a foot, polished on one side and rough on the other, under a photographed sky](goal.png)
#
# So far the light came from one lamp. Outdoors it comes from everywhere: the sun, the blue sky around it,
# clouds, the ground. A photograph of all directions, an **environment map**, holds all of it, and to shade
# a point means to add up what arrives from thousands of directions, at every point, in every frame. That is
# too slow, and random samples of it are too noisy.
#
# The way out is older than graphics hardware: **blur the map once, ahead of time, and look it up once.** In
# this notebook you will build the blurred maps, use them to shade a mesh, and find out what was given up.
#
# You need the idea of an integral over the directions of a hemisphere, and NumPy.
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
# import matplotlib.pyplot as plt
#
# sky = fw.Environment.load("sky.exr")
# fw.show.image(sky.pixels, title="All directions: the top row is straight up, the bottom row straight down")

# %% tags=["active-ipynb"]
# from autograder import check, hint

# %% [markdown]
# This map has 32 rows and 64 columns, small enough to experiment with. It is *linear* and *high dynamic
# range*: the pixel with the sun is a thousand times as bright as the rest. `sky.radiance(direction)` looks
# it up between pixel centres, `sky.directions()` and `sky.solid_angles()` say where each pixel looks and
# how much of the sphere it covers: the rows at the poles cover little.

# %% tags=["active-ipynb"]
# luminance = sky.pixels @ [0.2126, 0.7152, 0.0722]
# energy = luminance * sky.solid_angles()
# print(f"brightest pixel: {luminance.max():.0f}, median: {np.median(luminance):.2f}")
# print(f"its share of all light: {energy.max() / energy.sum():.0%}")
# print(f"solid angles: {sky.solid_angles().min():.5f} to {sky.solid_angles().max():.5f}, sum {sky.solid_angles().sum():.4f}")

# %% [markdown]
# ## 3.1 Where a rough mirror's facets point
#
# A rough surface is made of tiny flat mirrors, the **microfacets**. A light direction $l$ is reflected into
# the view $v$ by the facets whose normal is the half vector $h$ between them. How many there are says the
# distribution of normals $D(h)$. The one called GGX has a sharp peak and long tails, as real surfaces do:
#
# $$D(h) = \frac{\alpha^2}{\pi \left(1 + (\alpha^2 - 1) \cos^2\theta\right)^2}, \qquad \alpha = \text{roughness}^2 .$$
#
# To sample it is to draw half vectors with density $D(h) \cos\theta$ per steradian, which is what the
# facets cover of the surface seen from above. The azimuth is uniform: $\varphi = 2\pi \xi_2$. For the tilt,
# ask what share of the facets is tilted by less than $\theta$. Written in the tangent, that share is $u =
# \tan^2\theta / (\alpha^2 + \tan^2\theta)$. Set it to a uniform number $u = \xi_1$ and solve:
#
# $$\tan\theta = \alpha \sqrt{\frac{u}{1 - u}} .$$
#
# Return unit vectors about $+z$. Which of the two columns you use for which angle is up to you. Think about
# $u$ close to 1, where the tangent has no bound: sine and cosine are harmless.


# %% nbgrader={"grade_id": "sample_ggx", "solution": true}
def sample_ggx(xi, alpha):
    """Half vectors about +z with the density of the normals that GGX describes.

    Parameters
    ----------
    xi : (N, 2) float in [0, 1)   points in the unit square
    alpha : float or (N,) float   width, roughness squared

    Returns
    -------
    (N, 3) float                  unit vectors with density D(h) (n.h) per steradian

    Notes
    -----
    Walter et al. 2007, eq. 35: tan = alpha sqrt(u / (1 - u)).
    """
    ### BEGIN SOLUTION
    u, phi = np.asarray(xi, dtype=float)[:, 0], 2.0 * np.pi * np.asarray(xi, dtype=float)[:, 1]
    # Sine and cosine from the same triangle: nothing overflows as u nears 1, nothing cancels as it nears 0.
    opposite, adjacent = alpha * np.sqrt(u), np.sqrt(1.0 - u)
    length = np.maximum(np.hypot(opposite, adjacent), np.finfo(float).tiny)
    sine, cosine = opposite / length, adjacent / length
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-3-1", "points": 3}
# check("3.1")

# %% [markdown]
# Left, half vectors from straight above for three widths. Right, how they are spread over the tilt, against
# the density $2\pi \sin\theta \, D \cos\theta$.

# %% tags=["active-ipynb"]
# rng = np.random.default_rng(1)
# fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8))
# theta = np.linspace(0.001, 1.5, 300)
# for alpha, color in ((0.6, "tab:green"), (0.25, "tab:orange"), (0.06, "tab:blue")):
#     h = sample_ggx(rng.random((20000, 2)), alpha)
#     left.plot(*h[:600, :2].T, ".", markersize=2, color=color, label=f"alpha = {alpha}")
#     right.hist(np.arccos(h[:, 2]), bins=np.linspace(0, 1.5, 75), density=True, color=color, alpha=0.35)
#     density = alpha**2 / (np.pi * (1 + (alpha**2 - 1) * np.cos(theta) ** 2) ** 2)
#     right.plot(theta, 2 * np.pi * np.sin(theta) * np.cos(theta) * density, color=color)
# left.axis("scaled")
# left.legend()
# right.set_xlabel("tilt of the half vector, radians")
# right.set_ylim(0, 6)
# plt.show()

# %% [markdown]
# ## 3.2 The roughest case: irradiance
#
# A diffuse surface reflects light from all directions alike. All that counts is how much arrives, each
# direction weighted by the cosine to the normal, for a slanted beam spreads over more surface. The **mean**
# radiance with that weight is
#
# $$\frac{E(n)}{\pi} = \frac{\int L(l)\, \max(n \cdot l, 0)\, \mathrm{d}l}{\int \max(n \cdot l, 0)\, \mathrm{d}l} .$$
#
# The denominator is $\pi$. Divide by the *sum* of your weights rather than by $\pi$, and a constant sky
# comes out exactly constant.
#
# Here is what is added up for one normal, which points up and to the side: the light, the cosine, and their product.

# %% tags=["active-ipynb"]
# def side_by_side(pictures, titles, exposure):
#     fig, axes = plt.subplots(1, len(pictures), figsize=(11, 2.4), layout="constrained")
#     for axis, picture, title in zip(axes, pictures, titles):
#         axis.imshow(np.clip(exposure * picture, 0, 1) ** (1 / 2.2))
#         axis.set_title(title, fontsize=9)
#         axis.axis("off")
#     plt.show()
#
#
# n = fw.normalize([0.6, 0.5, 0.6])
# cosine = np.clip(sky.directions() @ n, 0, None)[..., None]
# pictures = [sky.pixels, np.repeat(cosine, 3, axis=2), sky.pixels * cosine]
# side_by_side(pictures, ["light L", "cosine, 0 below the horizon", "what the sum adds up: L times cosine"], exposure=0.5)

# %% [markdown]
# Make a map of it: one pixel for each normal, laid out like an environment.
# `fw.skies.constant(height).directions()` has the normals. No randomness is needed. The map has 2048
# pixels, and for each normal you may add up all of them: radiance, times the pixel's solid angle, times the
# cosine. As matrices this is one product of `(normals, pixels)` by `(pixels, 3)`.


# %% nbgrader={"grade_id": "irradiance", "solution": true}
def irradiance(env, height):
    """What a white diffuse surface shows under the environment, for every orientation.

    Parameters
    ----------
    env : framework.Environment
    height : int               rows of the result

    Returns
    -------
    (height, 2 height, 3) float   cosine-weighted mean radiance (irradiance / pi), one pixel per normal

    Notes
    -----
    All pixels of the map, with their exact solid angles: the sum of the weights cancels what is left of the
    discretisation, so a constant map stays as it is.
    """
    ### BEGIN SOLUTION
    normals = fw.environment.pixel_directions(height).reshape(-1, 3)
    directions, solid_angles = env.directions().reshape(-1, 3), env.solid_angles().reshape(-1, 1)
    light = env.pixels.reshape(-1, 3) * solid_angles
    result = np.empty_like(normals)
    step = max(1, 2_000_000 // len(directions))
    for i in range(0, len(normals), step):
        cosine = np.maximum(normals[i : i + step] @ directions.T, 0.0)
        result[i : i + step] = (cosine @ light) / (cosine @ solid_angles)
    return result.reshape(height, 2 * height, 3)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-3-2", "points": 4}
# check("3.2")

# %% tags=["active-ipynb"]
# diffuse = irradiance(sky, 16)
# fw.show.image(diffuse, title="What a white matt ball would show, for every orientation of its surface")

# %% [markdown]
# 512 normals by 2048 pixels: a million multiplications, done once. From now on each shaded point costs one
# look-up. The price is that a look-up knows a direction and nothing else: the map is the same at every
# point, so the sky must be far away, and nothing may stand in the way. Shadows are the subject of the last
# notebook.
#
# ## 3.3 Between mirror and matt
#
# A polished surface mirrors the map itself. A matt one shows the irradiance. A rough mirror is in between:
# it shows the map *blurred* by the lobe of directions that its facets reflect into the view.
#
# That lobe depends on two directions, normal and view, and so its blurred maps would fill a table of four
# dimensions. The classic step is to pretend that one looks from straight above: $n = v = r$, where $r$ is
# the mirror direction. Then one direction is left, and one map per roughness does.
#
# What to do for each pixel of the result, with $n$ its direction:
#
# 1. Draw half vectors with `sample_ggx`, `samples` of them; `fw.hammersley(samples)` gives points that
#    cover the square more evenly than random ones, and the same may serve all pixels.
# 2. Reflect the view about each, $l = 2 (v \cdot h)\, h - v$. Here $v = n$, which in the local frame is
#    $+z$.
# 3. Turn $l$ into the world by a frame about $n$: `fw.orthonormal_frame(n)` gives the two tangents.
# 4. Add up `env.radiance(l)`, weighted by $n \cdot l$ where that is positive, and divide by the **sum of
#    the weights**.
#
# For `alpha = 0` the lobe is a single direction: look the map up at the pixel centres of the result.
#
# `samples` is how many look-ups you may use for each pixel, not how many you must. The lobe around $n = v =
# r$ depends on the angle to $n$ alone, so there are ways without any randomness; anything that is right
# counts.


# %% nbgrader={"grade_id": "prefilter", "solution": true}
def prefilter(env, alpha, height, samples):
    """Radiance blurred by the lobe of a rough mirror that is seen from straight above: n = v = r.

    Parameters
    ----------
    env : framework.Environment
    alpha : float              width of the lobe, roughness squared; 0 copies the map
    height : int               rows of the result
    samples : int              look-ups for each pixel of the result

    Returns
    -------
    (height, 2 height, 3) float   GGX-filtered radiance, weighted by n.l and normalised

    Notes
    -----
    With n = v = r the lobe depends on n.l alone, so it needs no samples where it is wider than a pixel: the result
    is a weighted mean of all pixels. In a narrower lobe the pixels near its axis are too coarse. There look-ups are
    spread evenly over the logarithm of the lobe's tail, for a sun that lies far out in it still counts.
    """
    ### BEGIN SOLUTION
    normals = fw.environment.pixel_directions(height).reshape(-1, 3)
    if alpha == 0.0:
        return env.radiance(normals).reshape(height, 2 * height, 3)
    directions, solid_angles = env.directions().reshape(-1, 3), env.solid_angles().reshape(-1, 1)
    light = env.pixels.reshape(-1, 3) * solid_angles
    pixel = np.pi / env.height
    near = min(4.0 * pixel, 0.5 * np.pi) if alpha < pixel else 0.0

    def share_of_pixels(sin2):
        x = np.clip(sin2 / np.sin(0.5 * near) ** 2, 0.0, 1.0) if near else 1.0
        return x * x * (3.0 - 2.0 * x)

    def sum_pixels(normal):
        n_l = normal @ directions.T
        sin2 = 0.5 - 0.5 * n_l  # of the half vector
        density = (alpha / (alpha**2 * (1.0 - sin2) + sin2)) ** 2 / (4.0 * np.pi)
        weight = density * np.maximum(n_l, 0.0) * share_of_pixels(sin2)
        return weight @ light, weight @ solid_angles

    def sum_samples(normal):
        xi = fw.hammersley(samples) + 0.5 / samples
        depth = np.log1p((np.tan(0.5 * near) / alpha) ** 2)
        beyond = np.exp(-depth * xi[:, 1])
        half = sample_ggx(np.stack([1.0 - beyond, xi[:, 0]], axis=1), alpha)
        to_light = 2.0 * half[:, 2:] * half - [0.0, 0.0, 1.0]
        weight = depth * beyond * to_light[:, 2] * (1.0 - share_of_pixels(1.0 - half[:, 2] ** 2)) / samples
        frame = np.stack([*fw.orthonormal_frame(normal), normal], axis=1)
        radiance = env.radiance((to_light @ frame).reshape(-1, 3)).reshape(-1, samples, 3)
        return np.einsum("s,nsk->nk", weight, radiance), weight.sum()

    result = np.empty_like(normals)
    step = max(1, 1_000_000 // max(len(directions), samples))
    for i in range(0, len(normals), step):
        parts = [sum_pixels(normals[i : i + step])] + ([sum_samples(normals[i : i + step])] if near else [])
        result[i : i + step] = sum(total for total, _ in parts) / sum(weight for _, weight in parts)
    return result.reshape(height, 2 * height, 3)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-3-3", "points": 5}
# check("3.3")

# %% tags=["active-ipynb"]
# roughnesses = (0.2, 0.4, 0.7)
# blurred = [prefilter(sky, roughness**2, 16, 256) for roughness in roughnesses]
# side_by_side(blurred, [f"roughness {roughness}" for roughness in roughnesses], exposure=0.5)

# %% [markdown]
# At roughness 1 the lobe becomes a well-known one. $D$ is constant, and the weight is $n \cdot l$: the
# blurred map *is* the irradiance.

# %% tags=["active-ipynb"]
# difference = np.abs(prefilter(sky, 1.0, 16, 256) - diffuse) / diffuse
# print(f"roughness 1 against the irradiance: {difference.max():.1%} apart at most, {difference.mean():.1%} on average")

# %% [markdown]
# ### Noise, and fireflies
#
# How many samples does it take? Here is importance sampling by itself, in one direction and with random
# points, under this sky as a camera would have clipped it, at a hundredth of the sun. Beside it are directions
# spread evenly over the hemisphere, weighted by the lobe. In the end both errors fall with the square root of
# the number of samples: for one digit more, a hundred times the work. But even directions mostly land where
# the lobe is dim, and it takes about twenty of them to do the work of one from the facets.
#
# Now look at the third line. It is the sky as it is, its one brightest pixel not clipped. A few samples hit
# it and give far too much, the others miss it and give too little.

# %% tags=["active-ipynb"]
# def facet_directions(xi, alpha):
#     h = sample_ggx(xi, alpha)
#     l = 2 * h[:, 2:] * h - [0, 0, 1]
#     return l, np.clip(l[:, 2], 0, None)
#
#
# def even_directions(xi, alpha):
#     cosine, phi = xi[:, 0], 2 * np.pi * xi[:, 1]
#     sine = np.sqrt(1 - cosine**2)
#     density = alpha**2 / (1 + (alpha**2 - 1) * (1 + cosine) / 2) ** 2  # D up to a factor: cos(h)^2 = (1 + cos(l)) / 2
#     return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1), density * cosine
#
#
# def noisy_filter(env, n, alpha, samples, directions):
#     l, weight = directions(np.random.default_rng(0).random((len(n) * samples, 2)), alpha)
#     l = l.reshape(len(n), samples, 3) @ np.stack([*fw.orthonormal_frame(n), n], axis=1)
#     radiance = env.radiance(l.reshape(-1, 3)).reshape(l.shape)
#     weight = weight.reshape(len(n), samples, 1)
#     return (weight * radiance).sum(axis=1) / weight.sum(axis=1)
#
#
# def spread(env, directions):
#     means = [noisy_filter(env, np.tile(n, (2**15 // count, 1)), 0.09, count, directions)[:, 1] for count in counts]
#     return [values.std() / values.mean() for values in means]
#
#
# clipped = fw.Environment(np.minimum(sky.pixels, luminance.max() / 100))
# counts, n = np.array([4, 16, 64, 256]), fw.normalize([0.3, 0.7, -0.5])
# plt.figure(figsize=(7, 3.8))
# plt.loglog(counts, spread(clipped, even_directions), "o-", color="tab:green", label="clipped sky, even directions")
# plt.loglog(counts, spread(clipped, facet_directions), "o-", color="tab:blue", label="clipped sky, from the facets")
# plt.loglog(counts, spread(sky, facet_directions), "o-", color="tab:orange", label="with its sun, from the facets")
# plt.loglog(counts, 2 / np.sqrt(counts), "k:", label="slope of 1 / sqrt(samples)")
# plt.xlabel("samples")
# plt.ylabel("standard deviation / mean")
# plt.legend(fontsize=8)
# plt.show()

# %% [markdown]
# Neighbouring pixels of the map disagree, and in a picture that looks like bright dots: **fireflies**. Not
# because the method is wrong, on average it is right; but the average of few samples has an enormous spread
# if one direction in thousands carries most of the light.

# %% tags=["active-ipynb"]
# outputs = sky.directions().reshape(-1, 3)
# few = [noisy_filter(env, outputs, 0.09, 16, facet_directions).reshape(sky.pixels.shape) for env in (clipped, sky)]
# titles = ["16 random samples, clipped sky", "its sun 100 times as bright", "the same, by your prefilter"]
# side_by_side([*few, prefilter(sky, 0.09, 32, 256)], titles, exposure=0.5)

# %% [markdown]
# Engines fight fireflies in three ways: they look up a coarser version of the map where samples are far
# apart (`env.mips()` has them), they take the sun out and treat it as a lamp, or they clamp it, and lose
# light.
#
# ## 3.4 A chain of maps
#
# One map for each roughness would be too many. A handful will do, with look-ups between them. The rougher,
# the smoother the map, and the fewer pixels it needs: 32 rows for a mirror, 8 for a matt surface.
#
# Filter each level **straight from the environment**, not from the level before. A blur of a blur is not
# the lobe of any roughness, and errors would add up. Mind that `roughness_levels` are roughnesses, and
# `prefilter` wants $\alpha$.


# %% nbgrader={"grade_id": "prefilter_chain", "solution": true}
def prefilter_chain(env, roughness_levels, heights, samples):
    """One filtered map for each roughness.

    Parameters
    ----------
    env : framework.Environment
    roughness_levels : (L,) float   in [0, 1], in any order
    heights : (L,) int              rows of each map
    samples : int                   look-ups for each pixel

    Returns
    -------
    list of (height, 2 height, 3) float   each straight from `env`, in the given order
    """
    ### BEGIN SOLUTION
    levels = zip(roughness_levels, heights, strict=True)
    return [prefilter(env, roughness**2, height, samples) for roughness, height in levels]
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-3-4", "points": 2}
# check("3.4")

# %% tags=["active-ipynb"]
# roughness_levels = (0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0)
# chain = prefilter_chain(sky, roughness_levels, (32, 32, 16, 16, 16, 8, 8), 128)
# print("pixels in each level:", [level.shape[0] * level.shape[1] for level in chain])

# %% [markdown]
# ## 3.5 Looking it up
#
# Shading asks for any direction and any roughness. Between pixels, interpolate bilinearly: each level is
# laid out like an environment, so `fw.Environment(level).radiance(direction)` does it. Between the two
# nearest levels, interpolate linearly in roughness. This is what graphics hardware calls a *trilinear*
# look-up. Below the first level and above the last, use these.
#
# Levels may have any spacing: `np.interp(roughness, roughness_levels, np.arange(len(chain)))` tells the
# position as a number such as 1.25, a quarter of the way from the second level to the third.


# %% nbgrader={"grade_id": "sample_chain", "solution": true}
def sample_chain(chain, roughness_levels, direction, roughness):
    """Look filtered radiance up between the pixels and between the levels.

    Parameters
    ----------
    chain : sequence of (h, 2h, 3) float   one map per level
    roughness_levels : (L,) float          strictly ascending
    direction : (N, 3) float               unit vectors
    roughness : float or (N,) float

    Returns
    -------
    (N, 3) float   bilinear in the two nearest levels, linear in roughness between them; beyond the ends the end level
    """
    ### BEGIN SOLUTION
    direction = np.asarray(direction, dtype=float)
    # 1.25 is a quarter of the way from the second level to the third.
    position = np.interp(roughness, roughness_levels, np.arange(len(chain)))
    position = np.broadcast_to(position, direction.shape[:-1])
    result = np.zeros(direction.shape)
    for level, pixels in enumerate(chain):
        weight = np.maximum(1.0 - np.abs(position - level), 0.0)
        near = weight > 0.0
        if near.any():
            result[near] += weight[near][..., None] * fw.Environment(pixels).radiance(direction[near])
    return result
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-3-5", "points": 4}
# check("3.5")

# %% [markdown]
# What does the look-up between levels cost? The mean of a sharp and a soft picture is not a picture of
# medium sharpness: it has a sharp core and a wide halo. Along one direction past the sun, from the level at
# 0.35 to that at 0.5, against the map that was made for the roughness in the middle:

# %% tags=["active-ipynb"]
# sun = fw.normalize(sky.directions()[np.unravel_index(luminance.argmax(), luminance.shape)])
# across, _ = fw.orthonormal_frame(sun)
# angle = np.linspace(-1.2, 1.2, 200)[:, None]
# path = np.cos(angle) * sun + np.sin(angle) * across
# between = sample_chain(chain, roughness_levels, path, 0.425)
# exact = fw.Environment(prefilter(sky, 0.425**2, 16, 256)).radiance(path)
# plt.figure(figsize=(7, 3.5))
# plt.plot(angle, exact[:, 1], "k", label="filtered for roughness 0.425")
# plt.plot(angle, between[:, 1], "tab:red", label="between the levels 0.35 and 0.5")
# plt.xlabel("angle from the sun, radians")
# plt.ylabel("radiance, green")
# plt.legend()
# plt.show()

# %% [markdown]
# ## 3.6 The approximation behind it all
#
# We replaced the integral of a product by the product of two integrals, without saying so. The lecture
# does:
#
# $$\int_\Omega f(x)\, g(x)\, \mathrm{d}x \;\approx\;
# \frac{\int_{\Omega_g} f(x)\, \mathrm{d}x}{\int_{\Omega_g} \mathrm{d}x} \cdot \int_\Omega g(x)\, \mathrm{d}x ,$$
#
# with $\Omega_g$ the **support** of $g$, the part of the domain where it is not zero. Put the light $L$ for
# $f$ and the reflection $f_r \cos\theta$ for $g$: the first factor is a blurred map, the second depends on
# the surface only, and is the subject of the next notebook.
#
# Write it for functions given by samples, with quadrature weights $w$ in place of $\mathrm{d}x$. Where $g$
# is zero, $f$ must not count at all, not even if it is `nan` there. Without any support, the result is 0.


# %% nbgrader={"grade_id": "classic_approximation", "solution": true}
def classic_approximation(f, g, weights):
    """The integral of a product, taken apart: the mean of f where g is, times the integral of g.

    Parameters
    ----------
    f, g : (N,) float          samples of the two functions
    weights : (N,) float       quadrature weights

    Returns
    -------
    float                      (sum f w over g's support / sum w over g's support) * sum g w; 0 without support
    """
    ### BEGIN SOLUTION
    f, g, weights = (np.asarray(values, dtype=float) for values in (f, g, weights))
    support = g != 0.0
    extent = weights[support].sum()
    if extent == 0.0:
        return 0.0
    return float((f * weights)[support].sum() / extent * (g * weights)[support].sum())
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-3-6", "points": 2}
# check("3.6")

# %% [markdown]
# When is it good? Let $f$ be a wave of some length, the "sky", and $g$ a bump, the "lobe", which is zero
# outside of its width. Try it, for a lobe that is flat and for one that is peaked.

# %% tags=["active-ipynb"]
# x = (np.arange(4000) + 0.5) / 4000
# w = np.full_like(x, 1 / 4000)
#
#
# def error(f, g):
#     exact = np.sum(f * g * w)
#     return abs(classic_approximation(f, g, w) - exact) / exact
#
#
# plt.figure(figsize=(7, 3.8))
# widths = np.geomspace(0.01, 0.45, 40)
# for length, style in ((2.0, "-"), (0.4, "--")):
#     f = 1 + 0.9 * np.sin(2 * np.pi * x / length)
#     for name, color, shape in (
#         ("peaked lobe", "tab:red", lambda s: np.clip(1 - s**2, 0, None) ** 4),
#         ("flat lobe", "tab:blue", lambda s: (np.abs(s) < 1) * 1.0),
#     ):
#         errors = [error(f, shape((x - 0.5) / width)) for width in widths]
#         plt.loglog(widths, np.maximum(errors, 1e-16), style, color=color, label=f"{name}, wave of length {length}")
# plt.ylim(1e-7, 2)
# plt.xlabel("half width of the lobe")
# plt.ylabel("relative error")
# plt.legend(fontsize=8)
# plt.show()

# %% [markdown]
# The lecture's two rules are visible. The approximation is good where **the support of $g$ is small**, the
# left of the plot: a polished surface. And it is good where **one of the two is smooth**: with the long
# wave the error is small everywhere, and for a flat $g$ there is no error at all, whatever the light does.
# It fails at the upper right: a wide, peaked lobe over light that changes within it.
#
# Our filter uses the lobe itself as a weight for the light, not just its support. That is better than the
# formula: much of what the peak does is in the map already. What stays wrong is that the lobe of the map is
# round, and the real one is not.
#
# ## The picture
#
# A mesh, rasterised, and lit by nothing but look-ups: for each visible pixel one into the chain, along the
# mirror direction, and one into the irradiance. The ball is polished on one side and rough on the other.

# %% tags=["active-ipynb"]
# ball = fw.mesh.shading_ball()
# camera = fw.Camera(position=(0.0, 0.7, 5.4), target=(0.0, -0.12, 0.0), up=(0, 1, 0), fov_y=0.5)
# warm = np.array([0.95, 0.64, 0.35])
#
#
# def render(width, height):
#     seen = fw.rasterize(ball, camera, width, height)
#     image = sky.radiance(camera.rays(width, height)[1])
#
#     position, normal = seen.position[seen.mask], fw.normalize(seen.normal[seen.mask])
#     view = fw.normalize(camera.position - position)
#     roughness = np.clip(0.5 - 0.5 * position[:, 0], 0, 1)
#     mirrored = sample_chain(chain, roughness_levels, fw.reflect(view, normal), roughness)
#     matt = fw.Environment(diffuse).radiance(normal)
#     image[seen.mask] = 0.9 * warm * mirrored + 0.1 * warm * matt
#     return 0.5 * image
#
#
# fw.show.image(render(300, 200))

# %% [markdown]
# What the look-up replaces can be counted. A trilinear one is two bilinear ones, one in each level.

# %% tags=["active-ipynb"]
# shaded = np.count_nonzero(fw.rasterize(ball, camera, 300, 200).mask)
# ahead = 128 * sum(level.shape[0] * level.shape[1] for level in chain[1:])
# print(f"128 samples of the lobe at each of {shaded:,} pixels: {128 * shaded:,} look-ups in every frame")
# print(f"the chain: {2 * shaded:,} in every frame, and at most {ahead:,} once, ahead of time")

# %% [markdown]
# Two look-ups where there were 128 directions, and no noise. Look at the rim: a real rough surface mirrors
# more and more light there, and its highlights stretch towards the viewer. Ours stay round, because the map
# was made for someone who looks from straight above. The next notebook puts the first of the two right.
#
# ## A question
#
# Answer in a few sentences of your own, in the cell below (2 points, read by a person):
#
# - Somebody divides by the number of samples instead of the sum of the weights. What happens to the rough
#   levels, and which simple environment shows it at once?
# - Why does one bright pixel spoil importance sampling of the *lobe*, though every direction of it is drawn
#   with the right density? What would you sample instead?

# %% [markdown] nbgrader={"grade_id": "question-3", "solution": true, "points": 2}
# The weights n.l lie between 0 and 1, and the wider the lobe the smaller they are on average. Divided by
# the number of samples, rough levels come out too dark, at roughness 1 by a third and more. A constant
# environment shows it: each level must have the same constant.
#
# The density follows the lobe and knows nothing of the light. The product of both has its peak at the sun,
# where few samples fall, so that the rare hits carry most of the sum: the variance is large though the mean
# is right. Sample the light, directions by their radiance times solid angle, or both with weights (multiple
# importance sampling); or look up a coarser map where samples are sparse; or add up all pixels.

# %% [markdown]
# ## Where to go from here
#
# - Give the chain fewer levels, or filter each level from the one before, and look at the ball.
# - Clamp the sky at 10 and compare: what is lost besides the fireflies?
# - `fw.skies.sun_and_sky(32)` has a sun as bright as the real one. How many samples would your `prefilter`
#   need?
# - Light alone is half of the story. How much of it a surface reflects depends on the angle: `split_sum`.
