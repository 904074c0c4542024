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
# # 8 · The BRDF, R₀, and the table of two numbers
#
# ## The question
#
# A rough mirror under an even white sky sends back a part of the light. **How large a part, for every material and every
# view, without an integral at run time?** The lecture gets there by shortcuts. **What does each of them cost?**
#
# Words that we need:
#
# - $n$ is the **normal** of a surface, $l$ the direction to a light, $v$ that to the viewer, all of length 1. The cosine
#   of the view is $\mu = n \cdot v$: 1 from straight above, 0 along the surface.
# - The **BRDF** $f(l, v)$ says how much of the light from $l$ goes to $v$, per steradian.
# - In the **microfacet** model a surface consists of tiny flat mirrors. Only those whose own normal is the **half vector**
#   $h$, half way between $l$ and $v$, send light from $l$ to $v$.
# - Their **distribution** $D(h)$ says how many mirrors face $h$. Its width is $\alpha = \text{roughness}^2$, with the
#   roughness from 0 to 1. **GGX** and **Beckmann** are two formulas for it.
# - **Fresnel reflectance** $F$ is the share of light that one mirror reflects. It grows towards grazing angles. From straight
#   above it is **$R_0$**: 0.04 for plastic, near 1 for silver, a colour for copper.
# - $G$ is the share of mirrors that no other hides from $l$ or $v$ (masking and shadowing, after Smith).

# %%
import numpy as np

import framework as fw
from solutions import fast
from solutions.lights import small_sky
from solutions.split_sum_error import ball
from solutions.truth import brdf_integral

# %% [markdown]
# ## The idea
#
# $$f(l, v) = \frac{F(v \cdot h)\; G(l, v)\; D(h)}{4\,(n \cdot l)\,(n \cdot v)}, \qquad
# F(c) \approx R_0 + (1 - R_0)\,(1 - c)^5 .$$
#
# The second formula is Schlick's, and it is *linear in $R_0$*. So $R_0$ comes out of the integral:
#
# $$\int f\,(n \cdot l)\,\mathrm{d}l =
# R_0 \underbrace{\int \frac{f}{F}\,\bigl(1 - (1 - c)^5\bigr)(n \cdot l)\,\mathrm{d}l}_{\text{scale}}
# + \underbrace{\int \frac{f}{F}\,(1 - c)^5\,(n \cdot l)\,\mathrm{d}l}_{\text{bias}}, \qquad c = v \cdot h .$$
#
# Scale and bias depend on the roughness and on $\mu$ alone. **Two numbers for each pair, a small picture, for all materials
# there are.**
#
# ## The code
#
# Draw mirrors $h$ with the density $D(h)\,(n \cdot h)$, reflect $v$ in each, and average what is left of the integrand.


# %%
def sampled(mu, roughness, samples):
    """Scale and bias, (2,), by samples of GGX's mirrors."""
    alpha = max(roughness**2, 1e-4)
    h = fw.sample_ggx(fw.hammersley(samples, (0.5 / samples, 0.5 / samples)), alpha)
    v = np.array([np.sqrt(1 - mu * mu), 0, mu])
    v_h = h @ v
    n_l = 2 * v_h * h[:, 2] - mu  # the normal is +z
    lit = (n_l > 0) & (v_h > 0)
    n_l, n_h, v_h = n_l[lit], h[lit, 2], v_h[lit]
    hidden_l, hidden_v = (np.sqrt(1 + alpha**2 * (1 / c**2 - 1)) for c in (n_l, mu))
    weight = 2 / (hidden_l + hidden_v) * v_h / (n_h * mu)
    schlick = (1 - np.minimum(v_h, 1)) ** 5
    return np.array([weight @ (1 - schlick), weight @ schlick]) / samples


# %% [markdown]
# ## The picture
#
# The table itself, from the compiled twin, which integrates instead of sampling. Then a ball that looks it up at each pixel.

# %%
table = fast.brdf_lut(128)
with fw.show.plot("n · v", "scale (lines) and bias (broken), no unit", "The table, five of its rows",
                  caption="Seen from above a rough mirror loses light; at grazing angles the bias takes over.") as axes:
    mu = (np.arange(128) + 0.5) / 128
    for row, color in zip((6, 32, 64, 96, 127), ("#2f6db5", "#3f8f5b", "#b8922a", "#d1622b", "#8a4fa3"), strict=True):
        axes.plot(mu, table[row, :, 0], color=color, label=f"roughness {(row + 0.5) / 128:.2f}")
        axes.plot(mu, table[row, :, 1], color=color, linestyle="--")
    axes.set(xlim=(0, 1), ylim=(0, 1))

light = fast.environment_light(small_sky(64))
mask, normal, view = ball(256)
normal = fw.normalize(normal + np.maximum(0.02 - np.sum(normal * view, axis=1), 0)[:, None] * view)  # none looks away


def shiny_ball(r0, roughness):
    picture = np.full((256, 256, 3), 0.05)
    picture[mask] = fast.shade_split_sum(normal, view, r0, roughness, light.prefiltered, table)
    return fw.tone_map(picture, method="filmic")


fw.interact(shiny_ball, r0=np.linspace(0.02, 1, 50), roughness=np.linspace(0.05, 0.75, 29),
            title="One table, all materials");

# %% [markdown]
# With a small $R_0$ the ball is dark in the middle and bright at the rim: that is the bias.
#
# ### The lecture's shortcuts, measured
#
# 1. *Schlick's formula* instead of Fresnel's own. For glass, $R_0 = ((n_1 - n_2) / (n_1 + n_2))^2$.
# 2. *One angle for all*: $F$ at the angle of the view, or of the light, instead of at $v \cdot h$.
# 3. *Beckmann* on the slide, GGX in engines. With the same $\alpha$ they are two materials.


# %%
def fresnel(c, ior):
    """Fresnel's own reflectance of unpolarised light, between air and a medium of that index of refraction."""
    inside = np.sqrt(1 - (1 - c * c) / ior**2)
    return 0.5 * (((c - ior * inside) / (c + ior * inside)) ** 2 + ((inside - ior * c) / (inside + ior * c)) ** 2)


c = np.linspace(0, 1, 500)
with fw.show.plot("cosine between light and mirror", "Schlick − Fresnel, reflectance", "1. Schlick's formula") as axes:
    for ior in (1.33, 1.5, 2.4):
        r0 = ((1 - ior) / (1 + ior)) ** 2
        off = r0 + (1 - r0) * (1 - c) ** 5 - fresnel(c, ior)
        axes.plot(c, off, label=f"index {ior}, R₀ = {r0:.3f}: at most {np.abs(off).max():.3f}")


def total(mu, roughness, r0, angle, samples=4096):
    """Light sent back under a white sky, with F at the cosine that is named."""
    alpha = roughness**2
    h = fw.sample_ggx(fw.hammersley(samples, (0.5 / samples, 0.5 / samples)), alpha)
    v_h = h @ np.array([np.sqrt(1 - mu * mu), 0, mu])
    n_l = 2 * v_h * h[:, 2] - mu
    lit = (n_l > 0) & (v_h > 0)
    n_l, n_h, v_h = n_l[lit], h[lit, 2], v_h[lit]
    hidden_l, hidden_v = (np.sqrt(1 + alpha**2 * (1 / c**2 - 1)) for c in (n_l, mu))
    cosine = {"v·h": v_h, "n·v": mu, "n·l": n_l}[angle]
    reflected = r0 + (1 - r0) * (1 - np.clip(cosine, 0, 1)) ** 5
    return np.sum(reflected * 2 / (hidden_l + hidden_v) * v_h / (n_h * mu)) / samples


roughnesses = np.linspace(0.1, 1, 10)
with fw.show.plot("roughness", "light sent back, share", "2. Which angle goes into F: plastic, R₀ = 0.04, n · v = 0.2") as axes:
    for angle, color in (("v·h", "#22252e"), ("n·v", "#d1622b"), ("n·l", "#2f6db5")):
        axes.plot(roughnesses, [total(0.2, r, 0.04, angle) for r in roughnesses], color=color, label=f"F at {angle}")
for angle in ("n·v", "n·l"):
    worst = max((total(m, r, 0.04, angle) / total(m, r, 0.04, "v·h"), m, r)
                for m in (0.1, 0.2, 0.5) for r in (0.2, 0.5, 1.0))
    print(f"2. F at {angle}: up to {worst[0]:.1f} times the right answer, at n·v = {worst[1]}, roughness {worst[2]}")
for rough in (0.25, 0.5, 1.0):
    ggx, beckmann = (brdf_integral(0.5, rough**2, ndf).sum() for ndf in ("ggx", "beckmann"))
    print(f"3. roughness {rough}, n·v = 0.5, R₀ = 1: GGX sends back {ggx:.3f}, Beckmann {beckmann:.3f}")

# %% [markdown]
# Schlick's formula stays within the few hundredths that the legend names. One angle for all is good for polished surfaces,
# where $h$ is nearly $n$, and wrong for rough ones, that of the view more than that of the light.
# It saves nothing, since the table is made once: **use $v \cdot h$**.
#
# ## Run time against error

# %%
ROUGHNESS, SAMPLES = 0.5, (16, 64, 256, 1024, 4096)  # try 0.1 and 1.0

cosines = (np.arange(16) + 0.5) / 16
exact = np.array([brdf_integral(m, ROUGHNESS**2) for m in cosines])


def looked_up(size):
    """A row of a finished table, between its cells."""
    own, at = tables[size], (np.arange(size) + 0.5) / size
    row = ROUGHNESS * size - 0.5
    low = int(np.clip(row, 0, size - 2))
    between = (low + 1 - row) * own[low] + (row - low) * own[low + 1]
    return np.stack([np.interp(cosines, at, between[:, i]) for i in (0, 1)], axis=1)


tables = {size: fast.brdf_lut(size) for size in (8, 16, 32, 64, 128)}
points = fw.plane.measure({
    "samples": {f"{s}": lambda s=s: np.array([sampled(m, ROUGHNESS, s) for m in cosines]) for s in SAMPLES},
    "table": {f"{s} × {s}": lambda s=s: looked_up(s) for s in tables},
}, lambda values: np.abs(values - exact).max())
fw.plane.show(points, "largest error of scale and bias, no unit", f"16 views, roughness {ROUGHNESS}")
print(f"A table of 64 × 64 as float32: {tables[64].size * 4 // 1024} KiB.")

# %% [markdown]
# ## What goes wrong, and the cure
#
# **A density that cancels.** GGX contains $1 - (n \cdot h)^2$. In float32, near the peak of a polished surface, nothing is
# left of that difference. *Cure:* the same number as $|n \times h|^2$, which does not cancel.

# %%
for rough in (0.25, 0.1, 0.045):
    alpha = np.float32(rough**2)
    tilt = np.linspace(0.05, 2, 400) * rough**2
    right = (alpha.astype(float) / (np.sin(tilt) ** 2 + alpha.astype(float) ** 2 * np.cos(tilt) ** 2)) ** 2 / np.pi
    cosine, sine = np.cos(tilt).astype(np.float32), np.sin(tilt).astype(np.float32)
    textbook = (alpha / (1 + cosine**2 * (alpha**2 - 1))) ** 2 / np.float32(np.pi)
    crossed = (alpha / (sine**2 + alpha**2 * cosine**2)) ** 2 / np.float32(np.pi)
    print(f"roughness {rough}: largest relative error {np.abs(textbook / right - 1).max():.1e} from the cosine, "
          f"{np.abs(crossed / right - 1).max():.1e} from the cross product")

# %% [markdown]
# **A table at its edges.** The integrand divides by $\mu$. Who puts the first column at $\mu = 0$ gets 0 / 0, a black or
# missing rim. *Cure:* cell centres, $(i + 0.5) / \text{size}$, never touch 0.

# %%
with np.errstate(all="ignore"):
    print("scale and bias at n·v = 0:", sampled(np.float64(0), 0.5, 64))
print("at the first cell centre:", sampled(0.5 / 64, 0.5, 64).round(3))

# %% [markdown]
# ## Exercises
#
# 1. What are scale and bias of a perfect mirror, and do the table's first rows agree?
#
# <details><summary>Answer</summary>
#
# Then $h = n$ and $v \cdot h = \mu$: the bias is $(1 - \mu)^5$ and the scale 1 minus that. Compare with `table[0]`.
#
# </details>
#
# 2. A white metal ($R_0 = 1$) of roughness 1 is dark under a white sky. Where did the light go?
#
# <details><summary>Answer</summary>
#
# $G$ takes away what hits another mirror, and the model forgets it. In truth that light is reflected again. At $\mu = 1$ the
# model keeps $1 - \ln 2 \approx 0.307$: the last line of `table[-1]` comes near it.
#
# </details>
#
# 3. Metals have a coloured $R_0$. How many tables does gold need?
#
# <details><summary>Answer</summary>
#
# One, and it is the same one: $R_0$ was taken out, so each channel multiplies the same scale by its own $R_0$.
#
# </details>
#
# ## From the lecture
#
# - *Must Fresnel be precomputed?* Not by itself: its angle is integrated into scale and bias, its colour $R_0$ stays out.
# - *Is the table fixed?* Yes, for one distribution, one $G$ and Schlick's formula. No light and no material enters. For
#   Beckmann it is another table, as measured above.
# - *Does GGX need more parameters?* No: one width, as Beckmann. Brushed metal needs two, and its table two more axes.
#
# ## Where to read on
#
# - Bruce Walter et al., *Microfacet Models for Refraction through Rough Surfaces*, EGSR, 2007: GGX.
# - Eric Heitz, *Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs*, JCGT, 2014.
# - Christophe Schlick, *An Inexpensive BRDF Model for Physically-based Rendering*, Eurographics, 1994.
# - Brian Karis, *Real Shading in Unreal Engine 4*, SIGGRAPH courses, 2013: the table.
# - Carmelo Fdez-Agüera, *A Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting*, JCGT, 2019.
