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
# # The split sum
#
# ![A ball of gold and a ball of clay in a row from smooth to rough](goal.png)
#
# A polished and a brushed spoon, a glazed and an unglazed cup: the difference is what happens between the
# light and the eye, at a surface rougher than one can see. You will build the model that games and films
# use for it, compute its light once the right way, by **adding up hundreds of directions at every point**,
# and then the fast way, with **two look-ups**. And you will measure what the fast way gets wrong, and
# where.
#
# You need the idea of the notebook `prefilter`: an environment blurred by the lobe of a rough mirror. The
# blurred maps are given here, ready-made.
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
# fw.show.image(light.env.pixels, title="The light: a sky whose sun is behind a thin cloud")

# %% tags=["active-ipynb"]
# from autograder import check, hint

# %% [markdown]
# ## 4.1 How much is reflected: Fresnel
#
# Look down into a pond and you see its ground; look across and you see the sky. Every surface reflects more
# at a grazing angle, and everything at the last. The exact formulas are long. Schlick's fit needs one
# number, $R_0$, the reflectance straight from above:
#
# $$F(\theta) = R_0 + (1 - R_0)(1 - \cos\theta)^5 .$$
#
# For glass or water $R_0$ follows from the indices of refraction on both sides. Metals have high values,
# and a different one for each colour: that is the colour of gold.
#
# $$R_0 = \left(\frac{n_1 - n_2}{n_1 + n_2}\right)^2$$
#
# A cosine that is larger than 1 by a rounding error must not do harm: clip it.


# %% nbgrader={"grade_id": "fresnel_schlick", "solution": true}
def fresnel_schlick(r0, cos_theta):
    """Reflectance at an angle, from the reflectance at normal incidence.

    Parameters
    ----------
    r0 : (...) float           reflectance at normal incidence, in [0, 1]
    cos_theta : (...) float    cosine between the direction and the (half) normal, in [0, 1]

    Returns
    -------
    (...) float                from r0 at cosine 1 to 1 at cosine 0

    Notes
    -----
    Schlick 1994.
    """
    ### BEGIN SOLUTION
    away = 1.0 - np.clip(cos_theta, 0.0, 1.0)
    return r0 + np.subtract(1.0, r0) * away**5
    ### END SOLUTION


def r0_from_ior(n1, n2):
    """Reflectance at normal incidence between two media.

    Parameters
    ----------
    n1, n2 : (...) float       their indices of refraction, > 0; 1 for air

    Returns
    -------
    (...) float in [0, 1)      the same from either side
    """
    ### BEGIN SOLUTION
    return (np.subtract(n1, n2) / np.add(n1, n2)) ** 2
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-4-1", "points": 2}
# check("4.1")

# %% tags=["active-ipynb"]
# angle = np.linspace(0, 90, 200)
# plt.figure(figsize=(6, 3.5))
# glass, water = r0_from_ior(1.0, 1.5), r0_from_ior(1.0, 1.33)
# for name, r0 in (("gold, red", 1.0), ("gold, blue", 0.34), ("glass", glass), ("water", water)):
#     plt.plot(angle, fresnel_schlick(r0, np.cos(np.radians(angle))), label=f"{name}: R0 = {r0:.3f}")
# plt.xlabel("angle to the normal, degrees")
# plt.ylabel("reflectance")
# plt.legend(loc=(0.02, 0.47))
# plt.show()

# %% [markdown]
# ## 4.2 Where the facets point: the distribution of normals
#
# A microfacet reflects $l$ into $v$ if its own normal is the half vector between them. $D$ says how many
# facets point in each direction, per steradian. With $\theta$ the tilt of the half vector, $\cos\theta = n
# \cdot h$:
#
# $$D_\text{Beckmann} = \frac{e^{-\tan^2\theta / \alpha^2}}{\pi \alpha^2 \cos^4\theta}, \qquad
# D_\text{GGX} = \frac{\alpha^2}{\pi \left(1 + (\alpha^2 - 1) \cos^2\theta\right)^2}$$
#
# $\alpha$ is the roughness squared, which makes equal steps of roughness look equal. At $\cos\theta \le 0$
# both are 0.
#
# They must work down to $\alpha = 10^{-4}$, where $1 + (\alpha^2 - 1)\cos^2\theta$ is the difference of two
# numbers close to 1. Written as $\alpha^2 \cos^2\theta + (1 - \cos\theta)(1 + \cos\theta)$ it is a sum, and
# nothing is lost.


# %% nbgrader={"grade_id": "ndf_beckmann", "solution": true}
def ndf_beckmann(cos_h, alpha):
    """Density of microfacet normals per steradian: a Gaussian of slopes.

    Parameters
    ----------
    cos_h : (...) float        cosine between the normal and the half vector
    alpha : (...) float        width, roughness squared

    Returns
    -------
    (...) float                0 where cos_h <= 0

    Notes
    -----
    Beckmann & Spizzichino 1963: exp(-tan^2 / alpha^2) / (pi alpha^2 cos^4).
    """
    ### BEGIN SOLUTION
    c = np.clip(cos_h, 1e-30, 1.0)
    a2 = np.square(np.maximum(alpha, 1e-4))
    tan2 = (1.0 - c) * (1.0 + c) / c**2
    return np.where(np.greater(cos_h, 0.0), np.exp(-tan2 / a2) / (np.pi * a2 * c**4), 0.0)
    ### END SOLUTION


def ndf_ggx(cos_h, alpha):
    """Density of microfacet normals per steradian: a narrower peak than Beckmann's, and longer tails.

    Parameters
    ----------
    cos_h : (...) float        cosine between the normal and the half vector
    alpha : (...) float        width, roughness squared

    Returns
    -------
    (...) float                0 where cos_h <= 0

    Notes
    -----
    Walter et al. 2007: alpha^2 / (pi (1 + (alpha^2 - 1) cos^2)^2), with the bracket as alpha^2 cos^2 + sin^2:
    no difference of close numbers is left, so narrow lobes keep their peak.
    """
    ### BEGIN SOLUTION
    c = np.clip(cos_h, 0.0, 1.0)
    a2 = np.square(np.maximum(alpha, 1e-4))
    bracket = a2 * c**2 + (1.0 - c) * (1.0 + c)
    return np.where(c > 0.0, a2 / (np.pi * bracket**2), 0.0)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-4-2", "points": 3}
# check("4.2")

# %% [markdown]
# The same $\alpha$, two characters. Beckmann falls off like a Gaussian, GGX has a narrower peak and a long
# tail. On a logarithmic scale one sees why highlights of GGX have a glow around them, as real ones have.

# %% tags=["active-ipynb"]
# theta = np.linspace(0, np.pi / 2, 300)
# fig, axes = plt.subplots(1, 2, figsize=(9, 3.5))
# for axis in axes:
#     for roughness, color in ((0.4, "tab:blue"), (0.7, "tab:orange")):
#         axis.plot(np.degrees(theta), ndf_ggx(np.cos(theta), roughness**2), color=color, label=f"GGX, roughness {roughness}")
#         axis.plot(np.degrees(theta), ndf_beckmann(np.cos(theta), roughness**2), "--", color=color, label="Beckmann")
#     axis.set_xlabel("tilt, degrees")
# axes[1].set_yscale("log")
# axes[1].set_ylim(1e-4, 30)
# axes[0].legend(fontsize=8)
# plt.show()

# %% [markdown]
# ## 4.3 Facets in the way: masking and shadowing
#
# Facets stand in each other's way, most of all at grazing angles. $G$ is the part of them that both the
# light and the viewer see. Smith's form derives it from $D$. For GGX, with light and view at heights that
# belong together:
#
# $$G = \frac{1}{1 + \Lambda(i) + \Lambda(o)}, \qquad
# \Lambda = \frac{\sqrt{1 + \alpha^2 \tan^2\theta} - 1}{2}$$
#
# 0 where either cosine is at or below 0. There are other forms about: the product of two separate terms,
# or Schlick's with a $k$. They are not the same; here it is the height-correlated one.


# %% nbgrader={"grade_id": "masking_shadowing", "solution": true}
def masking_shadowing(cos_i, cos_o, alpha):
    """Fraction of the microfacets that both directions see.

    Parameters
    ----------
    cos_i, cos_o : (...) float     cosines between the normal and the two directions
    alpha : (...) float            width, roughness squared

    Returns
    -------
    (...) float in [0, 1]          0 where either cosine is at or below 0

    Notes
    -----
    Height-correlated Smith G2 of GGX (Heitz 2014): 1 / (1 + Lambda(i) + Lambda(o)), with
    1 + 2 Lambda = sqrt(1 + alpha^2 tan^2).
    """
    ### BEGIN SOLUTION
    a2 = np.square(np.maximum(alpha, 1e-4))
    i, o = (np.clip(cosine, 1e-100, 1.0) for cosine in (cos_i, cos_o))
    slope_i, slope_o = (np.sqrt(a2 / c**2 + (1.0 - a2)) for c in (i, o))
    above = np.greater(cos_i, 0.0) & np.greater(cos_o, 0.0)
    return np.where(above, 2.0 / (slope_i + slope_o), 0.0)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-4-3", "points": 2}
# check("4.3")

# %% tags=["active-ipynb"]
# cosine = np.linspace(0.001, 1, 300)
# plt.figure(figsize=(6, 3.5))
# for roughness in (0.3, 0.6, 1.0):
#     plt.plot(np.degrees(np.arccos(cosine)), masking_shadowing(cosine, 1.0, roughness**2), label=f"roughness {roughness}")
# plt.xlabel("angle of the light, degrees; the view is straight above")
# plt.ylabel("G")
# plt.legend()
# plt.show()

# %% [markdown]
# ## 4.4 The microfacet BRDF
#
# Everything together: of the facets that point along $h$ (there are $D$), the visible part ($G$) reflects
# the share $F$. The denominator turns densities of normals into densities of directions.
#
# $$f_r(i, o) = \frac{F\, G\, D}{4\, (n \cdot i)\, (n \cdot o)}, \qquad h = \frac{i + o}{\lVert i + o \rVert}$$
#
# The facets are the mirrors, so $F$ takes *their* angle, $v \cdot h$, not the angle to $n$. Return 0 where
# light or view is at or below the horizon. `r0` may be a number, a colour or one colour a point: make it a
# colour first.


# %% nbgrader={"grade_id": "microfacet_brdf", "solution": true}
def microfacet_brdf(normal, view, to_light, r0, alpha):
    """Reflection of one light direction by a rough mirror.

    Parameters
    ----------
    normal, view : (N, 3) float            unit vectors
    to_light : (3,) or (N, 3) float        unit vectors towards the light
    r0 : float, (3,) or (N, 3) float       reflectance at normal incidence
    alpha : float or (N,) float            width, roughness squared

    Returns
    -------
    (N, 3) float               per steradian; 0 where view or light is at or below the horizon

    Notes
    -----
    Cook & Torrance 1982: F G D / (4 n.i n.o), GGX, F at the angle between view and half vector.
    """
    ### BEGIN SOLUTION
    normal, view, to_light = (np.asarray(v, dtype=float) for v in (normal, view, to_light))
    cos_i, cos_o = fw.arrays.dot(normal, to_light), fw.arrays.dot(normal, view)
    half = fw.normalize(view + to_light)
    # From the sine: where the cosine is all but 1, single-precision vectors would lose a narrow lobe's shape.
    sin2 = np.minimum(np.sum(np.cross(normal, half) ** 2, axis=-1), 1.0)
    density = ndf_ggx(np.sqrt(1.0 - sin2), alpha)
    visible = masking_shadowing(cos_i, cos_o, alpha)
    above = (cos_i > 0.0) & (cos_o > 0.0)
    slopes = 4.0 * np.clip(cos_i, 1e-30, 1.0) * np.clip(cos_o, 1e-30, 1.0)
    scale = np.where(above, density * visible / slopes, 0.0)
    r0 = np.asarray(r0, dtype=float) * np.ones(3)
    return scale[..., None] * fresnel_schlick(r0, fw.arrays.dot(view, half)[..., None])
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-4-4", "points": 4}
# check("4.4")

# %% [markdown]
# Slices through the lobe. The light comes from the left; each curve says how much goes out in each
# direction.

# %% tags=["active-ipynb"]
# out = np.linspace(-np.pi / 2, np.pi / 2, 721)[1:-1]
# direction = np.stack([np.sin(out), np.cos(out), np.zeros_like(out)], axis=-1)
# up = np.broadcast_to([0.0, 1.0, 0.0], direction.shape)
# fig, axes = plt.subplots(1, 3, figsize=(10, 3.2), subplot_kw={"projection": "polar"})
# for axis, degrees in zip(axes, (10, 45, 75)):
#     incoming = np.array([-np.sin(np.radians(degrees)), np.cos(np.radians(degrees)), 0.0])
#     for roughness in (0.4, 0.6, 0.9):
#         f = microfacet_brdf(up, direction, incoming, 0.5, roughness**2)[:, 0] * np.cos(out)
#         axis.plot(out, f / f.max(), label=f"roughness {roughness}")
#     axis.set_theta_zero_location("N")
#     axis.set_theta_direction(-1)
#     axis.set_thetalim(-np.pi / 2, np.pi / 2)
#     axis.set_thetagrids([-45, 0, 45])
#     axis.set_yticks([])
#     axis.set_title(f"light at {degrees} degrees", fontsize=9)
# axes[1].legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 0.2), ncols=3)
# plt.show()

# %% [markdown]
# The peak lies where a mirror would send the light, but only for smooth surfaces. The rougher and the more
# grazing, the further out it moves. Remember this when we come to *the price*.
#
# ## 4.5 The slow, right answer
#
# Under an environment the light that leaves a point is the rendering equation without visibility:
#
# $$L_o = \int_\Omega L(l)\, f_r(l, v)\, (n \cdot l)\, \mathrm{d}l
# \approx \frac1N \sum_{k=1}^{N} \frac{L(l_k)\, f_r(l_k, v)\, (n \cdot l_k)}{p(l_k)} .$$
#
# Draw $l$ where $f_r$ is large: half vectors from `fw.sample_ggx(xi, alpha)`, `(N, 2)` and `(N,)` to `(N,
# 3)` about $+z$, turned to the normal by `fw.orthonormal_frame`, then $l = 2 (v \cdot h)\, h - v$. Their
# density is $D\, (n \cdot h)$ per steradian of $h$. Directions $l$ spread out four times $(v \cdot h)$ as
# fast:
#
# $$p(l) = \frac{D\, (n \cdot h)}{4\, (v \cdot h)} \qquad\text{so that}\qquad
# \frac{f_r\, (n \cdot l)}{p} = \frac{F\, G\, (v \cdot h)}{(n \cdot v)(n \cdot h)} .$$
#
# $D$, which may be huge, has cancelled: use the form on the right. A sample below the horizon counts as 0,
# but **it counts**: you divide by all $N$. So does one with $v \cdot h \le 0$.
#
# Random numbers come from `rng` and from nowhere else, each point gets its own. Points whose view is at or
# below the horizon get 0. `env.radiance` takes `(M, 3)` directions; for many points times many samples work
# in portions of some 100 000 directions.


# %% nbgrader={"grade_id": "monte_carlo_shade", "solution": true}
def monte_carlo_shade(env, normal, view, r0, alpha, samples, rng):
    """Light that a rough mirror reflects to the viewer, without shadows: the slow general answer.

    Parameters
    ----------
    env : framework.Environment
    normal, view : (N, 3) float            unit vectors
    r0 : float, (3,) or (N, 3) float       reflectance at normal incidence
    alpha : float or (N,) float            width, roughness squared
    samples : int                          directions for each point
    rng : numpy.random.Generator

    Returns
    -------
    (N, 3) float               radiance, right on average; 0 where the view is at or below the horizon

    Notes
    -----
    The estimator is mean(L f (n.l) / density). Half vectors from `fw.sample_ggx` make the weight
    F G (v.h) / (n.v n.h), which is right, but noisy at grazing angles. Here they come from the normals that the
    viewer sees (Dupuy & Benyoub 2023): the weight is F G2 / G1, never above 1.
    """
    ### BEGIN SOLUTION
    normal, view = np.broadcast_arrays(np.asarray(normal, dtype=float), np.asarray(view, dtype=float))
    shape = normal.shape
    normal, view = normal.reshape(-1, 3), view.reshape(-1, 3)
    r0 = np.broadcast_to(np.asarray(r0, dtype=float), shape).reshape(-1, 3)
    alpha = np.broadcast_to(np.maximum(alpha, 1e-4), shape[:-1]).reshape(-1)

    def shade(n, v, r0, a, xi):
        tangent, bitangent = fw.orthonormal_frame(n)
        axes = np.stack([tangent, bitangent, n], axis=1)
        v = np.einsum("nij,nj->ni", axes, v)[:, None]
        a = a[:, None]
        flatten = np.stack([a, a, np.ones_like(a)], axis=-1)
        # Microfacets are the normals of a squashed sphere: stretch it, sample the cap that the view sees, squash.
        v_round = fw.normalize(v * flatten)
        z = 1.0 - xi[..., 1] * (1.0 + v_round[..., 2])
        radius, phi = np.sqrt(np.maximum(1.0 - z * z, 0.0)), 2.0 * np.pi * xi[..., 0]
        cap = np.stack([radius * np.cos(phi), radius * np.sin(phi), z], axis=-1)
        h = fw.normalize((cap + v_round) * flatten)
        v_h = fw.arrays.dot(v, h)
        l = 2.0 * v_h[..., None] * h - v
        cos_i, cos_o = l[..., 2], v[..., 2]
        weight = masking_shadowing(cos_i, cos_o, a) / masking_shadowing(np.ones_like(cos_o), cos_o, a)
        radiance = env.radiance(np.einsum("nsi,nij->nsj", l, axes).reshape(-1, 3)).reshape(l.shape)
        return (weight[..., None] * radiance * fresnel_schlick(r0[:, None], v_h[..., None])).mean(axis=1)

    lit = np.flatnonzero(fw.arrays.dot(normal, view) > 0.0)
    color = np.zeros(normal.shape)
    batch = max(1, 65536 // samples)
    for some in (lit[start : start + batch] for start in range(0, len(lit), batch)):
        xi = rng.random((len(some), samples, 2))
        color[some] = shade(normal[some], view[some], r0[some], alpha[some], xi)
    return color.reshape(shape)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-4-5", "points": 4}
# check("4.5")

# %% [markdown]
# A ball of rough gold, with a few and with many samples. Watch the time as well as the noise.

# %% tags=["active-ipynb"]
# gold = np.array([1.0, 0.71, 0.29])
# camera = fw.Camera(position=(0.0, 0.0, 5.0), target=(0.0, 0.0, 0.0), up=(0, 1, 0), fov_y=0.42)
# ball = fw.rasterize(fw.mesh.sphere(), camera, 72, 72)
# normal = fw.normalize(ball.normal[ball.mask])
# view = fw.normalize(camera.position - ball.position[ball.mask])
#
#
# def on_ball(color):
#     image = np.zeros((*ball.mask.shape, 3))
#     image[ball.mask] = color
#     return image
#
#
# for samples in (4, 64):
#     start = time.perf_counter()
#     color = monte_carlo_shade(light.env, normal, view, gold, 0.4**2, samples, np.random.default_rng(1))
#     seconds = time.perf_counter() - start
#     fw.show.image(on_ball(color), title=f"{samples} samples, {seconds:.2f} s for {len(normal)} points")

# %% [markdown]
# At one million pixels and sixty pictures a second there is a nanosecond for each direction. Not even a
# fast machine gets there.
#
# ## 4.6 Split it
#
# The lecture's step, the classic approximation of `prefilter`: take the light out of the integral, averaged
# over the lobe.
#
# $$\int L\, f_r\, (n \cdot l)\, \mathrm{d}l \;\approx\;
# \underbrace{L_\text{prefiltered}(r, \text{roughness})}_{\text{first look-up}} \cdot
# \underbrace{\int f_r\, (n \cdot l)\, \mathrm{d}l}_{\text{second look-up}}$$
#
# What is left is the reflection under a white sky. It depends on roughness, on $n \cdot v$, and on $R_0$:
# three numbers, a table that is too large. But Schlick's formula is *linear* in $R_0$. Put it in:
#
# $$\int f_r\, (n \cdot l)\, \mathrm{d}l =
# R_0 \underbrace{\int \frac{f_r}{F} \left(1 - (1 - \cos\theta)^5\right) (n \cdot l)\, \mathrm{d}l}_{\text{scale}}
# + \underbrace{\int \frac{f_r}{F} (1 - \cos\theta)^5\, (n \cdot l)\, \mathrm{d}l}_{\text{bias}}$$
#
# and $R_0$ is out of the integral: two numbers for each roughness and cosine, a picture with two channels.
# The lecture writes one angle for all of them. The one that counts is again that of the facets, $\cos\theta
# = v \cdot h$, and it varies under the integral: that is why $(1 - \cos\theta)^5$ stays inside.
#
# Fill the table. Row $i$ is roughness $(i + 0.5) / \text{size}$, column $j$ is $n \cdot v = (j + 0.5) /
# \text{size}$. The samples are those of 4.5, without light: average $G (v \cdot h) / ((n \cdot v)(n \cdot
# h))$ times $1 - (1 - v \cdot h)^5$ for the first number, times $(1 - v \cdot h)^5$ for the second.
# `fw.hammersley(samples)` is better than random points, and all entries may use the same. Here $n = (0, 0,
# 1)$ and $v = (\sqrt{1 - \mu^2}, 0, \mu)$.


# %% nbgrader={"grade_id": "brdf_lut", "solution": true}
def brdf_lut(size, samples):
    """The second half of the split sum: reflection under a white sky, as scale and bias of r0.

    Parameters
    ----------
    size : int                 rows (roughness) and columns (cosine of the view), sampled at (i + 0.5) / size
    samples : int              directions for each entry

    Returns
    -------
    (size, size, 2) float      scale and bias: white-sky reflection = r0 scale + bias

    Notes
    -----
    Karis 2013. Samples are those of `monte_carlo_shade`, spread evenly: at 1024 the error is below 2e-3.
    """
    ### BEGIN SOLUTION
    centers = (np.arange(size) + 0.5) / size
    points = fw.hammersley(samples) + 0.5 / samples
    cos_phi, u = np.cos(2.0 * np.pi * points[:, 0]), points[:, 1]
    v_z = centers[:, None]
    v_x = np.sqrt((1.0 - v_z) * (1.0 + v_z))
    lut = np.empty((size, size, 2))
    for row, alpha in enumerate(centers**2):
        length = np.hypot(alpha * v_x, v_z)
        round_x, round_z = alpha * v_x / length, v_z / length
        z = 1.0 - u * (1.0 + round_z)
        radius = np.sqrt(np.maximum(1.0 - z * z, 0.0))
        # The cap around the view, which lies in the plane y = 0; of y only its square matters.
        h_x, h_z = alpha * (radius * cos_phi + round_x), z + round_z
        h_y2 = (alpha * radius) ** 2 * (1.0 - cos_phi**2)
        v_h = (v_x * h_x + v_z * h_z) / np.sqrt(h_x**2 + h_y2 + h_z**2)
        cos_i = 2.0 * v_h * h_z / np.sqrt(h_x**2 + h_y2 + h_z**2) - v_z
        weight = masking_shadowing(cos_i, v_z, alpha) / masking_shadowing(1.0, v_z, alpha)
        schlick = fresnel_schlick(0.0, v_h)
        lut[row, :, 0] = (weight * (1.0 - schlick)).mean(axis=1)
        lut[row, :, 1] = (weight * schlick).mean(axis=1)
    return lut
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-4-6", "points": 4}
# check("4.6")

# %% tags=["active-ipynb"]
# table = brdf_lut(64, 256)
# fig, axes = plt.subplots(1, 2, figsize=(8.5, 3.8), layout="constrained")
# for axis, channel, name in zip(axes, np.moveaxis(table, -1, 0), ("scale", "bias")):
#     shown = axis.imshow(channel, cmap="cividis", vmin=0, vmax=1, extent=(0, 1, 1, 0))
#     axis.set_title(name)
#     axis.set_xlabel("n.v")
#     axis.set_ylabel("roughness")
# fig.colorbar(shown, ax=axes)
# plt.show()
# corners = {"smooth, grazing": table[0, 0], "smooth, from above": table[0, -1]}
# corners |= {"rough, grazing": table[-1, 0], "rough, from above": table[-1, -1]}
# for name, (scale, bias) in corners.items():
#     print(f"{name:20s} scale {scale:.3f}  bias {bias:.3f}  sum {scale + bias:.3f}")

# %% [markdown]
# Four corners that one can check without a computer, or nearly. A smooth surface is a mirror: the two
# numbers are $1 - (1 - \mu)^5$ and $(1 - \mu)^5$. From above there is no Fresnel term, the bias is 0. The
# sum is what a perfect white metal reflects. For the roughest from straight above it is $1 - \ln 2 =
# 0.307$, and not 1: light that bounces twice between facets is left out by the model, not by you.
#
# ### One angle for all?
#
# If one angle really stood for all, $F$ at $n \cdot v$ could be taken out of the integral whole, and the table
# would need one channel only, the sum. What does this change? Divide by what the facets' own angles give:

# %% tags=["active-ipynb"]
# mu = (np.arange(64) + 0.5) / 64
# plt.figure(figsize=(6, 3.5))
# for roughness, style in ((0.1, "-"), (0.3, "--"), (0.6, "-."), (0.9, ":")):
#     scale, bias = np.moveaxis(table[int(64 * roughness)], -1, 0)
#     one_angle = fresnel_schlick(0.04, mu) * (scale + bias)
#     plt.plot(np.degrees(np.arccos(mu)), one_angle / (0.04 * scale + bias), style, label=f"roughness {roughness}")
# plt.xlabel("angle of the view to the normal, degrees")
# plt.ylabel("F at n.v over F at v.h, R0 = 0.04")
# plt.legend()
# plt.show()

# %% [markdown]
# For a polished surface nothing: all its facets lie nearly flat. For a rough one the rim would be several times
# too bright. Seen at a grazing angle, the facets that reflect are the ones that lean towards the viewer, and
# they see the light less steeply. For a metal, whose $F$ is near 1 at every angle, it hardly matters.
#
# ## 4.7 Look it up
#
# Entry $i$ of $n$ stands for $(i + 0.5) / n$, so $x$ lies at position $x n - 0.5$ between the entries.
# Interpolate linearly in both directions, and beyond the outermost centres use their values. The table may
# have any size, even 1, and the arguments any shapes that broadcast.


# %% nbgrader={"grade_id": "sample_lut", "solution": true}
def sample_lut(lut, cos_theta, roughness):
    """Look the table up between its entries.

    Parameters
    ----------
    lut : (rows, columns, 2) float   sampled at (i + 0.5) / size: rows by roughness, columns by cosine
    cos_theta : (...) float          cosine of the view, in [0, 1]
    roughness : (...) float          in [0, 1]

    Returns
    -------
    (..., 2) float                   bilinear; beyond the outermost centres their values
    """
    ### BEGIN SOLUTION
    lut = np.asarray(lut, dtype=float)

    def neighbours(x, count):
        position = np.clip(np.asarray(x, dtype=float) * count - 0.5, 0.0, count - 1.0)
        first = np.minimum(position.astype(int), max(count - 2, 0))
        return first, np.minimum(first + 1, count - 1), (position - first)[..., None]

    cos_theta, roughness = np.broadcast_arrays(cos_theta, roughness)
    top, bottom, down = neighbours(roughness, lut.shape[0])
    left, right, across = neighbours(cos_theta, lut.shape[1])
    upper = (1.0 - across) * lut[top, left] + across * lut[top, right]
    lower = (1.0 - across) * lut[bottom, left] + across * lut[bottom, right]
    return (1.0 - down) * upper + down * lower
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-4-7", "points": 2}
# check("4.7")

# %% [markdown]
# What does a coarse table cost? Its error comes from two sources: the samples and the interpolation. Here
# only the second, between tables of equal samples:

# %% tags=["active-ipynb"]
# fine = brdf_lut(128, 64)
# cosine, roughness = np.meshgrid(np.linspace(0.02, 1, 90), np.linspace(0.05, 1, 90))
# for size in (8, 16, 32):
#     coarse = sample_lut(brdf_lut(size, 64), cosine, roughness)
#     print(f"{size:3d} x {size:<3d} {np.abs(coarse - sample_lut(fine, cosine, roughness)).max():.4f} off at most")

# %% [markdown]
# ## 4.8 Two look-ups
#
# Here it is, the whole renderer for light from an environment: reflect the view about the normal, look up
# the blurred light, look up the table.
#
# $$L_o \approx L_\text{prefiltered}(r, \text{roughness}) \cdot (R_0\, \text{scale} + \text{bias})$$
#
# Note that it is $R_0$ and not $F$: the Fresnel term is in the table. `prefiltered` is a function that
# takes `(N, 3)` directions and `(N,)` roughnesses, so a single number must be made as many. 0 where $n
# \cdot v \le 0$.


# %% nbgrader={"grade_id": "shade_split_sum", "solution": true}
def shade_split_sum(normal, view, r0, roughness, prefiltered, lut):
    """Light that a rough mirror reflects to the viewer, without shadows: two look-ups.

    Parameters
    ----------
    normal, view : (N, 3) float            unit vectors
    r0 : float, (3,) or (N, 3) float       reflectance at normal incidence
    roughness : float or (N,) float        in [0, 1]
    prefiltered : callable                 (N, 3) directions, (N,) roughnesses -> (N, 3) radiance
    lut : (size, size, 2) float            as from `brdf_lut`

    Returns
    -------
    (N, 3) float               radiance; 0 where the view is at or below the horizon
    """
    ### BEGIN SOLUTION
    normal, view = np.broadcast_arrays(np.asarray(normal, dtype=float), np.asarray(view, dtype=float))
    shape = normal.shape
    cos_o = fw.arrays.dot(normal, view)
    lit = cos_o > 0.0
    color = np.zeros(shape)
    if lit.any():
        roughness = np.broadcast_to(np.asarray(roughness, dtype=float), shape[:-1])[lit]
        r0 = np.broadcast_to(np.asarray(r0, dtype=float), shape)[lit]
        scale, bias = np.moveaxis(sample_lut(lut, cos_o[lit], roughness), -1, 0)[..., None]
        color[lit] = prefiltered(fw.reflect(view[lit], normal[lit]), roughness) * (r0 * scale + bias)
    return color
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-4-8", "points": 3}
# check("4.8")

# %% tags=["active-ipynb"]
# start = time.perf_counter()
# color = shade_split_sum(normal, view, gold, 0.4, light.prefiltered, light.lut)
# print(f"{time.perf_counter() - start:.4f} s for {len(normal)} points")
# fw.show.image(on_ball(color), title="Two look-ups")

# %% [markdown]
# ## The price
#
# Roughness to the right, first gold and then glass; above Monte Carlo, below the split sum.

# %% tags=["active-ipynb"]
# levels = (0.1, 0.3, 0.5, 0.8)
# for name, r0 in (("gold", gold), ("glass", 0.04)):
#     slow, fast = [], []
#     for roughness in levels:
#         mean = monte_carlo_shade(light.env, normal, view, r0, roughness**2, 48, np.random.default_rng(2))
#         slow.append(on_ball(mean))
#         fast.append(on_ball(shade_split_sum(normal, view, r0, roughness, light.prefiltered, light.lut)))
#     gain = 1.0 if name == "gold" else 6.0
#     fw.show.image(gain * np.vstack([np.hstack(slow), np.hstack(fast)]), title=name)

# %% [markdown]
# From the front, and where the surface is smooth, they agree. Towards the rim of the rough balls the split
# sum goes wrong: real highlights stretch and move outwards there, its own stay round.
#
# ### Four things were given up
#
# Go from the true answer to the fast one, and replace one ingredient after another:
#
# 1. **separation**: the light is averaged by itself, over the lobe $D\, (n \cdot l)$ of the true view, and $F$
#    and $G$ go into the other factor;
# 2. **n = v = r**: the light is averaged with the lobe of someone who looks from straight above;
# 3. **levels**: that average is looked up between a few stored maps;
# 4. **table**: the other factor comes from a table of 64 by 64.
#
# Each replacement changes the picture by some $e_i$, and together they make the whole error $e$. A picture that
# is off by $e$ has the relMSE $\langle e \cdot e \rangle$, where $\langle\,\rangle$ is the mean over the ball
# relative to the squared truth, so $\langle e_i \cdot e \rangle$ is what part $i$ has in it: negative if it undoes
# a bit of the others.
#
# Do the parts add up to the whole? They are measured apart. The parts come from 1024 evenly spread directions,
# the whole from your `monte_carlo_shade` with random ones, as the product of two errors with different seeds:
# noise that has nothing to do with each other multiplies to zero on average.

# %% tags=["active-ipynb"]
# def lobe(n, v, alpha, samples):
#     """Directions that facets about n reflect v into, (N, samples, 3), with v.h and (v.h) / (n.v n.h)."""
#     half = fw.sample_ggx(fw.hammersley(samples), alpha) @ np.stack([*fw.orthonormal_frame(n), n], axis=1)
#     v_h = np.clip(fw.arrays.dot(v[:, None], half), 0, 1)
#     weight = v_h / (fw.arrays.dot(n, v)[:, None] * fw.arrays.dot(n[:, None], half))
#     return 2 * v_h[..., None] * half - v[:, None], v_h, weight
#
#
# def parts(roughness, r0, every=24, samples=1024):
#     """Shares of the four parts in the relMSE, (4,), and the relMSE itself, from Monte Carlo."""
#     n, v, alpha = normal[::every], view[::every], roughness**2
#     r = fw.reflect(v, n)
#     l, v_h, weight = lobe(n, v, alpha, samples)
#     cos_i = fw.arrays.dot(n[:, None], l)
#     radiance = light.env.radiance(l.reshape(-1, 3)).reshape(l.shape)
#     fgd = weight * masking_shadowing(cos_i, fw.arrays.dot(n, v)[:, None], alpha) * fresnel_schlick(r0, v_h)
#     reflection = fgd.mean(axis=1)[:, None]
#     above, _, _ = lobe(r, r, alpha, samples)
#     from_above = light.env.radiance(above.reshape(-1, 3)).reshape(l.shape)
#
#     def mean(radiance, weight):
#         return np.einsum("ns,nsk->nk", weight, radiance) / weight.sum(axis=1)[:, None]
#
#     answers = [
#         (fgd[..., None] * radiance).mean(axis=1),
#         mean(radiance, weight * np.clip(cos_i, 0, None)) * reflection,
#         mean(from_above, np.clip(fw.arrays.dot(r[:, None], above), 0, None)) * reflection,
#         light.prefiltered(r, np.full(len(r), roughness)) * reflection,
#         shade_split_sum(n, v, r0, roughness, light.prefiltered, light.lut),
#     ]
#     rngs = np.random.default_rng(5), np.random.default_rng(6)
#     one, other = (answers[-1] - monte_carlo_shade(light.env, n, v, r0, alpha, 384, rng) for rng in rngs)
#     relative = 1 / (answers[0] ** 2 + 0.01 * answers[0].mean() ** 2)
#     shares = [np.mean(e * (one + other) / 2 * relative) for e in np.diff(answers, axis=0)]
#     return shares, np.mean(one * other * relative)

# %% tags=["active-ipynb"]
# print("roughness   R0   separation  n = v = r   levels     table       sum     whole")
# for roughness in (0.25, 0.45, 0.7, 0.9):
#     for r0 in (0.04, 1.0):
#         shares, whole = parts(roughness, r0)
#         print(f"{roughness:9.2f}  {r0:4.2f}    " + "  ".join(f"{x:8.4f}" for x in [*shares, sum(shares), whole]))

# %% [markdown]
# The table is innocent, and so are the levels. For glass that is not too rough, the separation costs most: $F$
# rises within the lobe towards grazing light and counts it more, which the averaged light does not know. On metals,
# and on everything rough, the largest part by far is **n = v = r**: the shape of the lobe, and where it points. A
# rough mirror that is seen at a grazing angle gathers its light from around the normal rather than from around $r$.
# It is a property of the maps, so no table can mend it.
#
# ### Almost identical?
#
# The lecture shows both pictures side by side and finds them almost identical. When are they? Two yardsticks: the
# relMSE, and **FLIP**, which predicts how much of the largest possible difference a viewer notices who flips between
# the pictures, from 0 to 1. Here is yours, under the sky of this notebook, whose sun is no brighter than 10.

# %% tags=["active-ipynb"]
# small = fw.rasterize(fw.mesh.sphere(), camera, 36, 36)
# few_n = fw.normalize(small.normal[small.mask])
# few_v = fw.normalize(camera.position - small.position[small.mask])
#
#
# def both(light, roughness, r0, samples=96):
#     """Pictures of a small ball: the split sum, and Monte Carlo twice with different seeds."""
#     pictures = np.zeros((3, 36, 36, 3))
#     fast = shade_split_sum(few_n, few_v, r0, roughness, light.prefiltered, light.lut)
#     rngs = np.random.default_rng(7), np.random.default_rng(8)
#     slow = [monte_carlo_shade(light.env, few_n, few_v, r0, roughness**2, samples, rng) for rng in rngs]
#     pictures[:, small.mask] = fast, *slow
#     return pictures
#
#
# def measure(fast, one, other):
#     fast, one, other = (picture / fast.mean() for picture in (fast, one, other))
#     slow = (one + other) / 2
#     relmse = np.sum((fast - one) * (fast - other) / (slow**2 + 0.01)) / small.mask.sum() / 3
#     try:
#         return f"{relmse:.4f}, {fw.metrics.flip(fast, slow)[0]:.3f}"
#     except ImportError:  # FLIP does not exist for every system
#         return f"{relmse:.4f}, none "
#
#
# print("relMSE, FLIP    roughness 0.1          0.3            0.6            0.9")
# for r0 in (0.04, 0.5, 1.0):
#     results = [measure(*both(light, roughness, r0)) for roughness in (0.1, 0.3, 0.6, 0.9)]
#     print(f"R0 = {r0:4.2f}       " + "  ".join(results))

# %% [markdown]
# And here under another light, a photo studio: a few lamps in a dark room. Roughness 0.1, 0.3 and 0.6, above Monte
# Carlo, below the split sum. Look at the rims.

# %% tags=["active-ipynb"]
# studio = fw.EnvironmentLight.load("studio.npz")
# columns = [both(studio, roughness, 1.0, samples=128) for roughness in (0.1, 0.3, 0.6)]
# rows = [[(one + other) / 2 for _, one, other in columns], [fast for fast, _, _ in columns]]
# fw.show.image(np.vstack([np.hstack(row) for row in rows]), title="R0 = 1 in the studio")

# %% [markdown]
# Small pictures and noisy references, but the trend is there. The file `error.csv` beside this notebook holds the
# patient version for five maps: the photographed sky with its sun as bright as it was, the studio, and three that
# are made. It was written by the command `python -m solutions.split_sum_error`: 64 rows a map, a ball of 64
# pixels, 1024 evenly spread directions a pixel, the sun added up exactly, every roughness a stored one.

# %% tags=["active-ipynb"]
# import csv
#
# with open("error.csv", newline="") as file:
#     error = {(row["map"], float(row["roughness"]), float(row["r0"])): row for row in csv.DictReader(file)}
# names, levels, r0s = (list(dict.fromkeys(key[i] for key in error)) for i in range(3))
# for metric in ("relmse", "flip"):
#     print(f"\n{metric:22s}R0" + "".join(f"{level:9.1f}" for level in levels))
#     for name in names:
#         for r0 in r0s:
#             row = [float(error[name, level, r0][metric] or "nan") for level in levels]
#             print(f"{name:20s}{r0:4.2f}" + "".join(f"{value:9.4f}" for value in row))
#
# fig, axes = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
# for axis, metric, label in zip(axes, ("relmse", "flip"), ("relMSE", "FLIP, mean over the picture")):
#     for name, marker in zip(names, "osDv^"):
#         values = [float(error[name, level, 0.5][metric] or "nan") for level in levels]
#         axis.semilogy(levels, values, marker=marker, label=name)
#     axis.set_xlabel("roughness (R0 = 0.5)")
#     axis.set_ylabel(label)
# axes[0].legend(fontsize=8)
# plt.show()

# %% [markdown]
# So when are they almost identical? Take a FLIP below 0.06 for it.
#
# - **Polished surfaces under a sky**, roughness up to 0.2, with the sun or without: yes. The lobe is narrow, and
#   whatever weights it or bends it has little to weight.
# - **An overcast sky**: nearly, up to roughness 0.4 (0.07), and not far off beyond, 0.12 at worst. Where the light is smooth
#   it does not matter over which lobe one averages.
# - **A sun, and roughness from 0.4 on**: no. FLIP is 0.1 to 0.2 at 0.4, and 0.3 to 0.4 at 1: the highlight has another
#   shape and another place.
# - **A dark room with a few lamps**: no, at no roughness. Each lamp is its own edge of light and dark, so that
#   a lobe that is a little too round puts light where there is none: in the studio, FLIP is 0.1 even at roughness 0.1.
#
# $R_0$ matters less than either: the columns of glass and of metal hardly differ, but for medium roughness among
# lamps, where the metal shows more.
#
# ## The picture

# %% tags=["active-ipynb"]
# meshes = [fw.mesh.sphere(0.46, (x, y, 0.0)) for y in (0.55, -0.55) for x in (-2.2, -1.1, 0.0, 1.1, 2.2)]
# wide = fw.Camera(position=(0.0, 0.0, 9.0), target=(0.0, 0.0, 0.0), up=(0, 1, 0), fov_y=0.43)
# clay = np.array([0.04, 0.04, 0.04])
#
#
# def render(width, height):
#     image = 0.8 * light.env.radiance(wide.rays(width, height)[1])
#     for i, mesh in enumerate(meshes):
#         seen = fw.rasterize(mesh, wide, width, height)
#         to_viewer = fw.normalize(wide.position - seen.position)
#         mask = seen.mask & (np.sum(seen.normal * to_viewer, axis=-1) > 0)  # at the rim a few interpolated normals face away
#         n, v = fw.normalize(seen.normal[mask]), to_viewer[mask]
#         roughness = (i % 5) / 4
#         r0, albedo = (gold, 0.0) if i < 5 else (clay, np.array([0.5, 0.22, 0.14]))
#         color = shade_split_sum(n, v, r0, roughness, light.prefiltered, light.lut)
#         image[mask] = 0.8 * (color + albedo * light.irradiance(n))
#     return image
#
#
# fw.show.image(render(300, 200))

# %% [markdown]
# The upper row is gold, the lower one clay: $R_0 = 0.04$ over a matt ground. From left to right the
# roughness goes from 0 to 1. The rims of the smooth clay balls are bright: that is the bias of the table.
#
# ## A question
#
# Answer in a few sentences of your own, in the cell below (2 points, read by a person):
#
# - Why can $R_0$ be taken out of the integral, and why could one not do the same with $\alpha$?
# - A white metal, $R_0 = 1$, that is very rough, under a white sky of radiance 1: what does the split sum
#   show from straight above, and why is it not 1? Is this the fault of the split?

# %% [markdown] nbgrader={"grade_id": "question-4", "solution": true, "points": 2}
# Schlick's F is linear in R0: F = R0 (1 - x) + x with x = (1 - v.h)^5, and a factor or a sum that does not
# depend on l may leave the integral over l. So two integrals without R0 remain. Alpha stands inside D and
# G, in a way that is not linear and that depends on l through h: for each alpha it is another integral,
# which is why the table has a row for each.
#
# About 0.31, 1 - ln 2 at alpha = 1. Under a white sky the split is exact, since the light is the same
# wherever it is averaged. What is missing is light that meets a facet twice: the model drops what G hides,
# though in truth it would be reflected again. It can be put back by a multiple-scattering term.

# %% [markdown]
# ## Where to go from here
#
# - Replace $n = v = r$ by a direction between $r$ and $n$, nearer to $n$ the rougher the surface, when you look
#   the maps up: how much of the second part does it win back?
# - Put back the light that bounces twice: multiply by $1 + R_0 (1 / (\text{scale} + \text{bias}) - 1)$, and
#   try the white metal again.
# - Half vectors from `fw.sample_ggx` ignore the view. Sampling only the normals that the viewer sees makes
#   every weight at most 1. How many samples does it save at grazing angles?
# - All of this was without shadows. The last notebook, `environment_shadows`, puts them back.
