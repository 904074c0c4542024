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
# # 7 · Prefiltering: blurred maps instead of samples
#
# ## The question
#
# A rough mirror shows its surroundings blurred. Averaging them anew at each pixel takes hundreds of look-ups. **Can the
# blur be done beforehand, and how well do a few stored maps serve all roughnesses?**
#
# Words that we need:
#
# - **Radiance** is the brightness seen along a ray. The **environment** $L(l)$ is the radiance from each direction $l$, stored
#   as a map whose rows run from straight up to straight down ([walkthrough 5](05_environments.ipynb)).
# - $n$ is the **normal** of a surface, $v$ the direction to the viewer, $r$ the **mirror direction**, all of length 1.
# - A rough mirror consists of tiny mirrors. Their normals $h$ scatter about $n$ with the density $D(h)$ (GGX here), whose
#   width is $\alpha = \text{roughness}^2$, roughness from 0 to 1. The directions that they reflect to the viewer are the
#   **lobe**.
# - The **RMS error** is the root of the mean squared difference, here divided by the mean of what is right.

# %%
import numpy as np

import framework as fw
from solutions import fast
from solutions.lights import small_sky
from solutions.truth_maps import filtered_radiance

# %% [markdown]
# ## The idea
#
# The lobe depends on the view, and a map for each view would be too much. So look from straight above: $n = v = r$. What
# is left depends on the angle between $l$ and $r$ alone. The lobe is round, the same everywhere, and only turned:
#
# $$L_\text{blurred}(r) = \frac{\int L(l)\, w(l)\,\mathrm{d}l}{\int w(l)\,\mathrm{d}l}, \qquad
# w(l) = \frac{D(h)}{4}\,\max(r \cdot l, 0), \qquad h = \frac{l + r}{|l + r|} .$$
#
# This is a *blur of the map by one kernel*, made once for each of a few roughnesses (the **levels**). Between two levels
# one interpolates. Dividing by the sum of the weights keeps an even sky as it is.
#
# ## The code
#
# The way of the engines: draw mirrors, reflect, average, weighted by $r \cdot l$.


# %%
def blurred(env, direction, alpha, samples):
    """Radiance (N, 3) about directions (N, 3) under the round lobe, by samples."""
    h = fw.sample_ggx(fw.hammersley(samples, (0.5 / samples, 0.5 / samples)), alpha)
    l = 2 * h[:, 2:] * h - [0, 0, 1]  # mirrored about h, with the lobe's axis as +z
    weight = np.maximum(l[:, 2], 0)
    frame = np.stack([*fw.orthonormal_frame(direction), direction], axis=1)
    return np.einsum("s,nsk->nk", weight, env.radiance(l @ frame)) / weight.sum()


# %% [markdown]
# ## The picture
#
# The compiled twin needs no samples: a round kernel is a convolution on the sphere, done with Fourier series along the
# rows. Eleven levels are made, then a slider looks them up.

# %%
sky = small_sky(128)
light = fast.environment_light(sky)
across = np.linspace(-1, 1, 256)
x, y = np.meshgrid(across, -across)
on_ball = x * x + y * y < 0.99
normal = np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)[on_ball]
toward = fw.reflect(np.array([0.0, 0.0, 1.0]), normal)  # seen from far away


def blurred_sky(roughness):
    picture = np.full((256, 256, 3), 0.03)
    picture[on_ball] = fast.sample_chain(light.chain, light.roughness_levels, toward, roughness)
    return fw.tone_map(picture, exposure=-1, method="filmic")


fw.interact(blurred_sky, roughness=np.linspace(0, 1, 41), title="The sky in mirror balls of growing roughness");

# %% [markdown]
# How good is the interpolation between levels? Against the map blurred for just that roughness, for three sets of levels:

# %%
even, few = np.linspace(0, 1, 11), np.linspace(0, 1, 5)
wanted = np.linspace(0.02, 0.98, 25)
calm = fw.Environment(np.minimum(small_sky(64).pixels, 10))  # without the sun, whose peak would be all that counts
somewhere = fw.environment.pixel_directions(24).reshape(-1, 3)
right = [fw.Environment(level).radiance(somewhere) for level in fast.prefilter_chain(calm, wanted, [64] * 25)]
with fw.show.plot("roughness", "RMS error, % of the mean radiance", "What lies between the levels",
                  caption=f"{len(somewhere)} directions, maps of 64 rows, the sun clipped at radiance 10.") as axes:
    for levels, name in ((few, "5 even levels"), (even, "11 even levels"), (light.roughness_levels, "11, closer near 0")):
        chain = fast.prefilter_chain(calm, levels, [64] * len(levels))
        errors = [100 * fw.metrics.rmse(fast.sample_chain(chain, levels, somewhere, r), exact) / exact.mean()
                  for r, exact in zip(wanted, right, strict=True)]
        axes.plot(wanted, errors, "o-", markersize=3, label=f"{name}: at most {max(errors):.1f} %")

# %% [markdown]
# ## Run time against error

# %%
ROUGHNESS, SAMPLES = 0.4, (16, 64, 256, 1024)  # try 0.2 and 1.0; and put `sky` in place of `calm`
LIGHT = calm

pixels = fw.environment.pixel_directions(16).reshape(-1, 3)
exact = filtered_radiance(LIGHT.pixels, pixels, ROUGHNESS**2, oversample=2)
points = fw.plane.measure({
    "samples": {f"{s}": lambda s=s: blurred(LIGHT, pixels, ROUGHNESS**2, s) for s in SAMPLES},
    "convolution": {"no samples": lambda: fast.prefilter_chain(LIGHT, [ROUGHNESS], [16])[0].reshape(-1, 3)},
}, lambda values: 100 * fw.metrics.rmse(values, exact) / exact.mean(), repeats=3)
fw.plane.show(points, "RMS error, % of the mean radiance", f"A map of 16 rows, roughness {ROUGHNESS}");

# %% [markdown]
# The truth sums over all of the map in float64, with 2 × 2 parts of each pixel.
#
# ## What goes wrong, and the cure
#
# **Dots around the sun.** Few of the samples meet the sun, the same few at each pixel: the blurred map shows copies of it.
# *Cure*, in engines: look up a map that was blurred a little before, so coarse that the samples' shares of the sphere touch
# (Colbert & Křivánek 2007). That helps much, and 64 are still too few for this sun. So leave sampling out, as the twin does.

# %%
fine = fw.environment.pixel_directions(64).reshape(-1, 3)
dotted = blurred(sky, fine, 0.3**2, 64)
coarser = blurred(sky.resized(32), fine, 0.3**2, 64)
smooth = fast.prefilter_chain(sky, [0.3], [64])[0].reshape(-1, 3)


def shown(values):
    picture = fw.tone_map(values.reshape(64, 128, 3), exposure=-1, method="filmic")
    return picture.repeat(2, axis=0).repeat(2, axis=1)


errors = [fw.metrics.rmse(values, smooth) / smooth.mean() for values in (dotted, coarser)]
fw.show.strip([shown(dotted), shown(coarser), shown(smooth)], ["64 samples", "64 samples of a coarser map", "convolution"],
              caption=f"Roughness 0.3. RMS error {errors[0]:.0%} and {errors[1]:.0%} of the mean radiance.");

# %% [markdown]
# **No division by the weights.** Who divides by the number of samples instead of the sum of the weights gets maps that
# darken with roughness. *Test:* an even sky must stay as it is.

# %%
white = fw.skies.constant(8)
for rough in (0.2, 0.6, 1.0):
    h = fw.sample_ggx(fw.hammersley(1024, (0.0005, 0.0005)), rough**2)
    print(f"roughness {rough}: {np.maximum(2 * h[:, 2] ** 2 - 1, 0).mean():.3f} divided by the number, "
          f"{blurred(white, pixels[:1], rough**2, 1024)[0, 0]:.3f} by the weights")

# %% [markdown]
# ## Exercises
#
# 1. At roughness 1 the kernel has a familiar name. Which?
#
# <details><summary>Answer</summary>
#
# $\alpha = 1$ makes $D$ constant, so that $w$ is the clamped cosine: the map is the irradiance over $\pi$ of a matt surface.
#
# </details>
#
# 2. How many rows does a level need?
#
# <details><summary>Answer</summary>
#
# As many as its lobe can still show. Its half width is about $2\alpha$ radians; three rows in it make
# $3 \pi / (2 \alpha)$ rows, 19 at roughness 0.5.
#
# </details>
#
# 3. Why not blur each level from the one before, as mip maps are made?
#
# <details><summary>Answer</summary>
#
# Two GGX lobes after each other are no GGX lobe, and errors add up. Each level straight from the map has its own error only.
#
# </details>
#
# ## From the lecture
#
# It calls the interpolation between maps trilinear: twice along the map, once between the levels, as measured above. What
# $n = v = r$ costs is measured in [walkthrough 9](09_split_sum_and_shadows.ipynb).
#
# ## Where to read on
#
# - Brian Karis, *Real Shading in Unreal Engine 4*, SIGGRAPH courses, 2013.
# - Mark Colbert, Jaroslav Křivánek, *GPU-Based Importance Sampling*, GPU Gems 3, 2007.
# - Josiah Manson, Peter-Pike Sloan, *Fast Filtering of Reflection Probes*, EGSR, 2016.
# - Ravi Ramamoorthi, Pat Hanrahan, *An Efficient Representation for Irradiance Environment Maps*, SIGGRAPH, 2001.
