# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3 (ipykernel)
#     language: python
#     name: python3
# ---

# %% [markdown]
# # 6 · The classic approximation
#
# ## The question
#
# A pixel under an environment is the integral of a product: light times what the surface makes of it. Products are
# costly, because both factors change from pixel to pixel. If only one could average the light by itself, beforehand!
# **When may the integral of a product be taken apart into a product of two integrals?**
#
# Words that we need:
#
# - $f$ and $g$ are two functions over a domain $\Omega$. Here $f$ is the light, $g$ is what weighs it, for instance a BRDF
#   times the cosine ([walkthrough 5](05_environments.ipynb) explains both), and $\Omega$ is a line, or the directions.
# - The **support** $\Omega_G$ of $g$ is where $g$ is not 0: the only place where $f$ matters.
# - The **mean** of $f$ over the support is $\bar f = \int_{\Omega_G} f\,dx \,/ \int_{\Omega_G} dx$, and its **standard
#   deviation** $\sigma_f$ is the root of the mean of $(f - \bar f)^2$: how uneven $f$ is there. Likewise for $g$.

# %%
from pathlib import Path

import numpy as np

import framework as fw

# %% [markdown]
# ## The idea
#
# The lecture's approximation replaces $f$ by its mean over the support of $g$, which then comes out of the integral:
#
# $$\int_\Omega f g\, dx \;\approx\; \frac{\int_{\Omega_G} f\, dx}{\int_{\Omega_G} dx} \cdot \int_\Omega g\, dx .$$
#
# How wrong is it? Write $f = \bar f + (f - \bar f)$ and $g = \bar g + (g - \bar g)$ within the support, and multiply
# out. The mixed terms vanish, because a deviation from the mean has the integral 0. Exactly one term is left:
#
# $$\int f g\, dx - \bar f \int g\, dx \;=\; \int_{\Omega_G} (f - \bar f)(g - \bar g)\, dx, \qquad
# \left|\text{error}\right| \;\le\; \sigma_f\, \sigma_g\, |\Omega_G| ,$$
#
# with the size $|\Omega_G|$ of the support. The equation on the left says that **the error is the covariance of $f$ and
# $g$**; the bound on the right is the Cauchy-Schwarz inequality. So the approximation is good in any of three cases:
#
# - the support is small, so that $f$ hardly changes within it ($\sigma_f$ is small);
# - $f$ is smooth there (again $\sigma_f$), or $g$ is ($\sigma_g$);
# - the deviations of $f$ and $g$ have nothing to do with each other, so that their products cancel.
#
# The lecture names the first two. The third is why pictures often look better than the bound.
#
# ## The code

# %%
def taken_apart(f, g, weights):
    """The mean of f over the support of g times the integral of g; samples (N, ...) and quadrature weights (N,)."""
    support = weights * (g != 0)
    return (support @ f) / support.sum() * (weights @ g)


def bound(f, g, weights):
    """sigma_f sigma_g |support|, the most that `taken_apart` can be wrong by."""
    w = weights[g != 0]
    f, g = f[g != 0], g[g != 0]
    deviations = [np.sqrt(w @ (values - w @ values / w.sum()) ** 2 / w.sum()) for values in (f, g)]
    return deviations[0] * deviations[1] * w.sum()


# %% [markdown]
# Try it on a line. $f$ is a smooth wave in one case and a sharp step in the other, $g$ a bump whose support has a half
# width that we change, and that leans to one side.

# %%
x = (np.arange(20000) + 0.5) / 20000
weights = np.full(x.size, 1 / x.size)
lights = {"smooth light": 1 + 0.5 * np.sin(2 * np.pi * (x - 0.45)), "sharp light": np.where(x > 0.52, 1.9, 0.1)}
widths = np.geomspace(0.004, 0.45, 30)

with fw.show.plot("half width of the support, part of the line", "error, relative to the integral", "Small support, or smooth",
                  "Full: what happened. Broken: the bound of Cauchy and Schwarz.") as axes:
    for (name, f), color in zip(lights.items(), ("#2f6db5", "#d1622b"), strict=True):
        errors, bounds = [], []
        for width in widths:
            u = (x - 0.5) / width
            g = np.where(np.abs(u) < 1, (1 - u * u) * (1 + 0.6 * u), 0)
            exact = weights @ (f * g)
            errors.append(abs(taken_apart(f, g, weights) - exact) / exact)
            bounds.append(bound(f, g, weights) / exact)
        axes.loglog(widths, np.maximum(errors, 1e-9), color=color, label=name)
        axes.loglog(widths, np.maximum(bounds, 1e-9), color=color, linestyle="--", linewidth=0.8)
        print(f"{name}: half width {widths[0]:.3f} is {errors[0]:.1e} wrong, {widths[-1]:.2f} is {errors[-1]:.1e} wrong; "
              f"never above its bound: {bool(np.all(np.array(errors) <= np.array(bounds) + 1e-12))}")
    axes.set(ylim=(1e-7, 2))

# %% [markdown]
# The smooth light gets better with every narrowing, in proportion to the width. The sharp one has two regimes: as long as
# the step lies inside the support the error stays large, whatever the width; once it lies outside, there is none.
#
# ## The picture
#
# Now over directions. The weight is a lobe about a direction $r$, linear in the cosine:
# $g(\omega) = \omega \cdot r - \cos\theta_c$, and 0 beyond the angle $\theta_c$. Its support is a cap, and with 90° it is
# the cosine of a matt surface. Each ball shows for all $r$ the integral with $f$ the light: on top exact, in the
# middle taken apart, at the bottom the difference (red: taken apart it is too bright, blue: too dark; the full colour
# stands for half the mean). Nothing is precomputed: each frame integrates over all pixels of the
# map. Change the light, and drag the angle.

# %%
sky = fw.Environment(np.maximum(fw.read_image(Path(fw.__file__).parent / "data" / "sky_512x256.exr").astype(float), 0))
softened = np.minimum(sky.resized(64).pixels, 8)
environments = {"softboxes": fw.skies.studio(64).resized(32), "clouds": fw.Environment(softened).resized(32),
                "even sky": fw.skies.gradient(32)}

ROWS = 20  # of the maps of results
targets = fw.skies.constant(ROWS).directions().reshape(-1, 3)
source = fw.skies.constant(32)
cosines = (targets @ source.directions().reshape(-1, 3).T).astype(np.float32)
source_weights = source.solid_angles().ravel().astype(np.float32)


def both_ways(light, degrees):
    """The integral exact and taken apart, divided by the integral of g, for all targets: two (ROWS, 2 ROWS, 3)."""
    g = np.maximum(cosines - np.float32(np.cos(np.radians(degrees))), 0) * source_weights
    support = (g > 0) * source_weights
    f = environments[light].pixels.reshape(-1, 3).astype(np.float32)
    shape = (ROWS, 2 * ROWS, 3)
    return [((m @ f) / m.sum(axis=1, keepdims=True)).reshape(shape) for m in (g, support)]


SIZE = 184
y, x = np.mgrid[1.02 : -1.02 : SIZE * 1j, -1.02 : 1.02 : SIZE * 1j]
ball = x * x + y * y < 1
normal = np.stack([x, y, np.sqrt(np.clip(1 - x * x - y * y, 0, 1))], axis=-1)[ball]


def balls(support_in_degrees, light):
    exact, apart = (fw.Environment(m).radiance(normal) for m in both_ways(light, support_in_degrees))
    picture = np.full((3, SIZE, SIZE, 3), 0.93)
    scale = exact.mean()
    picture[0][ball], picture[1][ball] = (fw.tone_map(0.35 * values / scale, method="filmic") for values in (exact, apart))
    off = np.clip(2 * (apart - exact).mean(axis=1, keepdims=True) / scale, -1, 1)
    picture[2][ball] = 0.96 - np.where(off > 0, off * [0.10, 0.55, 0.75], -off * [0.75, 0.45, 0.10])
    return np.concatenate(picture, axis=0)


fw.interact(balls, strip=3, support_in_degrees=np.linspace(12, 90, 27), light=["softboxes", "clouds", "even sky"],
            title="From top to bottom: exact, taken apart, the difference")

for light in environments:
    errors = []
    for degrees in (12, 45, 90):
        exact, apart = both_ways(light, degrees)
        errors.append(np.sqrt(np.mean((apart - exact) ** 2)) / exact.mean())
    print(f"{light:9s}: RMS error over the mean, at 12°, 45°, 90°: " + ", ".join(f"{e:.1%}" for e in errors))

# %% [markdown]
# A **glossy** surface has a narrow lobe: small support. A **diffuse** one has a wide lobe, but it is smooth ($\sigma_g$ is
# small against its mean). This is the lecture's observation: a BRDF is good in either case. But read the numbers at 90°:
# "smooth" means a moderate error under an even sky, and a far larger one where the light is a few bright boxes, because then
# $\sigma_f$ is as large as it gets. The wide lobe therefore has a map of its own, the exact irradiance.
#
# ## Run time against error
#
# What do we win? The integral under the clouds, for 512 directions $r$, three ways: by Monte Carlo with more and more
# directions; exact, as the sum over all pixels; and taken apart, where the mean of $f$ comes from a map that was made
# beforehand, so that a pixel costs *one* look-up. Change `light` and `degrees`.

# %%
light, degrees = "clouds", 30  # yours to change

edge = np.cos(np.radians(degrees))
rng = np.random.default_rng(3)
r = fw.normalize(rng.normal(size=(512, 3)))
map_directions, map_weights = source.directions().reshape(-1, 3), source.solid_angles().ravel()
f = environments[light].pixels.reshape(-1, 3)
whole = np.pi * (1 - edge) ** 2  # the integral of g


def all_pixels():
    return (np.maximum(r @ map_directions.T - edge, 0) * map_weights) @ f


def sampled(n):
    """Uniform directions within the cap: the mean of f g, times the solid angle of the cap."""
    u = np.random.default_rng(4).random((len(r), n, 2))
    z = 1 - u[..., 0] * (1 - edge)
    side = np.sqrt(1 - z * z)
    t, b = fw.orthonormal_frame(r)
    phi = 2 * np.pi * u[..., 1]
    d = (side * np.cos(phi))[..., None] * t[:, None] + (side * np.sin(phi))[..., None] * b[:, None] + z[..., None] * r[:, None]
    return 2 * np.pi * (1 - edge) * (environments[light].radiance(d) * (z - edge)[..., None]).mean(axis=1)


prepared = fw.Environment(both_ways(light, degrees)[1].astype(float))
truth = sampled(16384)
points = fw.plane.measure(
    {
        "Monte Carlo": {f"{n}": lambda n=n: sampled(n) for n in (4, 16, 64, 256)},
        "all pixels": {"2048": all_pixels},
        "taken apart": {"1 look-up": lambda: prepared.radiance(r) * whole},
    },
    lambda found: np.sqrt(np.mean((found - truth) ** 2)) / truth.mean(),
)
fw.plane.show(points, "RMS error, relative to the mean", f"512 directions, {light}, support of {degrees}°")
one, most = points[-1], points[3]
print(f"{most.setting} directions of Monte Carlo are {most.error / one.error:.2f} times as wrong as the one look-up, "
      f"and take {most.milliseconds / one.milliseconds:.0f} times as long")

# %% [markdown]
# (The sum over all pixels takes each as even, the other ways interpolate between them: hence its small error.)
#
# %% [markdown]
# ## What goes wrong, and the cure
#
# **The support of a function that never ends.** The formula asks where $g \ne 0$. For the lobes of real BRDFs that is
# nearly everywhere: they have tails. The mean is then taken over directions that hardly count. Worse, *where* a tail
# becomes 0 is decided by the computer: an exponential underflows. Take the Beckmann distribution of normals,
# $g \propto \exp(-\tan^2\theta / \alpha^2) / \cos^4\theta$ with the width $\alpha = 0.1$, in float64 and in float32, about a
# direction beside the edge of a softbox.

# %%
def beckmann(cosine, alpha, kind):
    c2 = np.maximum(cosine, 1e-4).astype(kind) ** 2
    return np.where(cosine > 0, np.exp(-((1 - c2) / c2) / kind(alpha) ** 2) / c2**2, 0)


fine = fw.skies.studio(128)
d, w = fine.directions().reshape(-1, 3), fine.solid_angles().ravel()
light_there = fine.pixels.reshape(-1, 3).mean(axis=1)
across = np.abs(np.diff(light_there.reshape(128, 256)[:, :200], axis=1))
row, column = np.unravel_index(np.argmax(across), across.shape)
towards = fine.directions()[row, column + 4]  # a few degrees beside a softbox's edge
for kind in (np.float64, np.float32):
    g = beckmann(d @ towards, 0.1, kind)
    value = taken_apart(light_there, g, w) / (w @ g)
    reach = np.degrees(np.arccos((d @ towards)[g != 0].min()))
    print(f"{kind.__name__}: support up to {reach:.0f}°, mean of the light {value:.2f}")
exact = w @ (light_there * g) / (w @ g)
print(f"weighed by the lobe, as it should be: {exact:.2f}")

# %% [markdown]
# Two precisions, two pictures, and both are wrong: a support defined by "not 0" is no property of the lobe. The cure is
# to weigh by *how much* a direction counts. With the mean taken with weights $q \ge 0$,
#
# $$\bar f_q = \frac{\int f q\, dx}{\int q\, dx},$$
#
# the lecture's form is $q = 1$ on the support. And $q = g$ is no approximation at all: it gives $\int f g / \int g
# \cdot \int g$, the exact product. The closer $q$ comes to $g$, the better. But a $q$ that follows $g$ exactly would
# depend on everything that $g$ depends on, and the map of means could not be made beforehand. **The split sum lives
# from a $q$ that is nearly $g$ and depends on two things only, a direction and a roughness.**

# %%
g = beckmann(d @ towards, 0.1, np.float64)
by_size = np.argsort(-g)
least = g[by_size][np.searchsorted(np.cumsum((g * w)[by_size]), 0.99 * (w @ g))]
choices = {
    "1 on the support": g != 0,
    "1 where 99 % of g are": g >= least,
    "a lobe twice as wide": beckmann(d @ towards, 0.2, np.float64),
    "a lobe a fifth wider": beckmann(d @ towards, 0.12, np.float64),
    "g itself": g,
}
for name, q in choices.items():
    print(f"weights q = {name:21s}: error {abs((w * q) @ light_there / (w @ q) / exact - 1):6.1%}")

# %% [markdown]
# ## Exercises
#
# **1.** For which $f$ is the approximation exact, whatever $g$ is? And for which $g$, whatever $f$ is?
#
# <details><summary>Answer</summary>
#
# The error is the covariance over the support. It is 0 for every $g$ if $f$ is constant there, and for every $f$ if $g$
# is constant on its support (a box): then the mean over the support *is* the weighted mean.
#
# </details>
#
# **2.** Let $g$ change its sign, so that $\int g\,dx = 0$. What does the approximation give, and what is the truth?
#
# <details><summary>Answer</summary>
#
# It gives 0, whatever the light. The truth is $\int (f - \bar f)\, g\, dx$, which can be anything: a product may only be taken
# apart where the weight does not change its sign. BRDFs are never negative; the harmonics of spherical-harmonics
# lighting are, and there one must not do this.
#
# </details>
#
# **3.** Take $f$ out of the integral, or take $g$ out? The formula is not symmetric. When would you take out $g$?
#
# <details><summary>Answer</summary>
#
# Whichever factor is taken out is averaged over the other's support, and what remains is the other's exact integral. If
# the light is one small lamp, its support is small, and the BRDF is nearly constant over it: take the BRDF out, and what is
# left is the lamp's own integral, its power. That is how a renderer treats a lamp. Under an environment the light
# is everywhere, and the BRDF has the small support: take the light out.
#
# </details>
#
# ## From the lecture
#
# The previous lecture took the *visibility* out of the same integral, with the same formula, to get soft shadows. Here the
# *light* is taken out: the shadows have been left away, what remains is light times BRDF times cosine, and the BRDF is glossy
# (small support) or diffuse (smooth). [Walkthrough 7](07_prefiltering.ipynb) computes the first factor for all directions
# and widths at once, [walkthrough 8](08_brdf_and_table.ipynb) the second.
#
# ## Where to read on
#
# - G. H. Hardy, J. E. Littlewood, G. Pólya, *Inequalities*, Cambridge University Press, 1934: Cauchy and Schwarz, and more.
# - R. Ramamoorthi, P. Hanrahan, *An efficient representation for irradiance environment maps*, SIGGRAPH 2001: why the
#   diffuse lobe is smooth, in numbers.
# - B. Karis, *Real shading in Unreal Engine 4*, SIGGRAPH 2013 course *Physically Based Shading in Theory and Practice*: the
#   split sum.
# - T. Akenine-Möller, E. Haines, N. Hoffman and others, *Real-Time Rendering*, 4th edition, 2018, chapter 10.
