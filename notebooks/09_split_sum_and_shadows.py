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
# # 9 · The split sum against the truth, and shadows from the environment
#
# ## The question
#
# Walkthroughs 7 and 8 replaced an integral over the whole sky by two look-ups, one in a blurred map and one in a table.
# The lecture calls the result almost identical. **How far is it from the truth, and which of its steps is to blame?**
# Both look-ups also forgot that things stand in the way of the light. **What brings the shadows back, and at what price?**
#
# Words that we need:
#
# - **Radiance** is what a camera measures along one ray, the brightness of what it sees. Here it has no unit: a sheet of
#   white paper outdoors has about 1.
# - The **environment** $L(l)$ is the radiance that arrives from each direction $l$ when nothing is in the way
#   ([walkthrough 5](05_environments.ipynb)). It is the same at all points, as if it came from infinitely far away.
# - At a point of a surface, $n$ is the **normal**, which stands upright on it, $v$ the **view**, towards the camera, and
#   $r$ the **mirror direction**, $v$ reflected about $n$. All of them have length 1, so that $n \cdot v$ is a cosine.
# - The **BRDF** $f(l, v)$ says how much of the light from $l$ goes to $v$, per steradian. A rough mirror is made of tiny
#   flat ones, and its **roughness** from 0 to 1 tells how much their normals $h$ scatter about $n$: their density is
#   $D(h)$, with the width $\alpha = \text{roughness}^2$. **$R_0$** is the share that it reflects of light from straight
#   above: 0.04 for plastic, near 1 for silver ([walkthrough 8](08_brdf_and_table.ipynb)). The directions $l$ from which
#   $v$ receives light worth mentioning are the **lobe**.
# - The **visibility** $V(p, l)$ is 1 where the point $p$ sees the sky in the direction $l$, and 0 where something hides it.
# - **Monte Carlo** estimates an integral by the mean over random samples. It is right on average, and its **standard
#   error**, the usual distance from the truth, falls with the square root of their number.
# - The **RMS error** is the root of the mean squared difference. We divide it by the mean of the truth and write per cent.

# %%
import numpy as np

import framework as fw
from solutions import fast
from solutions.environment_shadows import dominant_lights
from solutions.lights import small_sky
from solutions.split_sum import sample_lut
from solutions.split_sum_error import ball
from solutions.truth_visibility import Solids, diffuse_radiance

# %% [markdown]
# ## The idea
#
# What a point sends to the camera is the rendering equation. Its last factor, the visibility, waits for the second half:
#
# $$L_o = \int L(l)\, f(l, v)\, (n \cdot l)\, V(p, l)\, \mathrm{d}l .$$
#
# Without $V$, call $w(l) = f(l, v)\,(n \cdot l)$ the **weight** of a direction. Multiply and divide by its integral:
#
# $$L_o = \frac{\int L\, w\, \mathrm{d}l}{\int w\, \mathrm{d}l} \cdot \int w\, \mathrm{d}l .$$
#
# Nothing has been approximated. *The split itself is exact*, if the mean of the light is taken under the right weight.
# The second factor is the table of walkthrough 8, and it is exact too. So the whole error of the split sum is that its
# blurred maps are made with **another weight**, in two steps:
#
# 1. $w$ loses Fresnel and shadowing among the tiny mirrors. What is left is where the mirrors send the view,
#    $w_1 = \dfrac{D(h)\,(n \cdot h)}{4\, v \cdot h}\,(n \cdot l)$, with $h$ half way between $l$ and $v$.
# 2. $w_1$ still knows the view, and a map for each view is too much to store. So the lobe is taken as it is for
#    $n = v = r$ and turned towards $r$: **round**, the same for all views. The real lobe of a grazing view is long and
#    narrow, and the horizon of the surface cuts it.
#
# A third step costs little: maps are stored for some roughnesses, here eleven, and what lies between is interpolated.

# %% [markdown]
# ## The code
#
# The fast way, in four lines. `light` holds the blurred maps and the table.


# %%
def split_sum(normal, view, r0, roughness, light):
    """Radiance (N, 3) towards the viewer, without shadows, from two look-ups."""
    blurred = light.prefiltered(fw.reflect(view, normal), np.full(len(normal), roughness))
    cosine = np.clip(np.sum(normal * view, axis=1), 0, 1)
    scale, bias = np.moveaxis(sample_lut(light.lut, cosine, roughness), -1, 0)[..., None]
    return blurred * (r0 * scale + bias)


# %% [markdown]
# And the slow one. It draws mirrors $h$ with the density $D(h)\,(n \cdot h)$ and reflects the view in each. From the same
# samples it takes three answers: the truth, the mean under $w_1$, and that under the round lobe.


# %%
def shadowing(cos_i, cos_o, alpha):
    """Share of the tiny mirrors that are seen from both directions: Smith's, for the GGX distribution."""
    hidden_i, hidden_o = (np.sqrt(1 + alpha**2 * (1 / c**2 - 1)) for c in (cos_i, cos_o))
    return 2 / (hidden_i + hidden_o)


def three_answers(env, normal, view, r0, alpha, samples, rng):
    """Radiance (3, N, 3) of many points: the truth, the mean under w1, the mean under the round lobe."""
    answers = np.zeros((3, len(normal), 3))
    for i in range(len(normal)):
        xi = fw.hammersley(samples, rng.random(2))  # spread evenly, so that fewer are enough
        h = fw.sample_ggx(xi, alpha) @ np.stack([*fw.orthonormal_frame(normal[i]), normal[i]])
        n_h, n_v, v_h = h @ normal[i], normal[i] @ view[i], h @ view[i]
        l = 2 * v_h[:, None] * h - view[i]
        n_l = np.maximum(l @ normal[i], 0)
        arriving = env.radiance(l)
        fresnel = r0 + (1 - r0) * np.clip(1 - v_h, 0, 1) ** 5
        seen = shadowing(np.maximum(n_l, 1e-9), n_v, alpha) * np.maximum(v_h, 0) / (n_v * n_h)
        weight = np.where(n_l > 0, fresnel * seen, 0)
        mirror = fw.reflect(view[i], normal[i])
        turned = fw.sample_ggx(xi, alpha) @ np.stack([*fw.orthonormal_frame(mirror), mirror])
        m_h = turned @ mirror
        about = 2 * m_h[:, None] * turned - mirror
        round_weight = np.maximum(about @ mirror, 0)
        whole = weight.mean()  # what the table holds
        answers[0, i] = weight @ arriving / samples
        answers[1, i] = n_l @ arriving / n_l.sum() * whole
        answers[2, i] = round_weight @ env.radiance(about) / round_weight.sum() * whole
    return answers


# %% [markdown]
# ## The picture
#
# A metal ball under a photographed sky, drawn by the compiled twin of `split_sum`. Two look-ups a pixel are so cheap that
# the slider is as quick as a screen. (The black dots on the rim are a failure: we come to them.)

# %%
sky = small_sky(128)
light = fast.environment_light(sky)
mask, normal, view = ball(256)
background = fw.Camera((0, 0, 5), (0, 0, 0), (0, 1, 0), 1.2).rays(256, 256)[1]
behind = light.prefiltered(background.reshape(-1, 3), 0.2).reshape(256, 256, 3)
METAL = np.array([0.95, 0.78, 0.55])


def shiny_ball(roughness, reflectance):
    picture = behind.copy()
    picture[mask] = fast.shade_split_sum(normal, view, reflectance * METAL, roughness, light.prefiltered, light.lut)
    return fw.tone_map(picture, exposure=-1, method="filmic")


fw.interact(shiny_ball, roughness=np.linspace(0, 1, 41), reflectance=np.linspace(0.04, 1, 25),
            title="The split sum: two look-ups a pixel");

# %% [markdown]
# ### Beside the truth
#
# Monte Carlo with some thousand samples a point can serve as the truth, except for the sun: it is tiny and very bright, and
# most samples miss it (a later section shows what that looks like). So everything above 30 times the mean radiance is taken
# out of the map, cut into small patches, and added up patch by patch; only the calm rest is sampled.


# %%
def calm_and_bright(env):
    """The environment without what is above 30 times its mean; directions and power of the rest, in small patches."""
    mean = np.tensordot(env.solid_angles(), env.pixels, axes=2).mean() / (4 * np.pi)
    calm, patches = fw.Environment(np.minimum(env.pixels, 30 * mean)), fw.skies.constant(256)
    toward = patches.directions().reshape(-1, 3)
    rest = (env.radiance(toward) - calm.radiance(toward)) * patches.solid_angles().reshape(-1, 1)
    bright = rest.max(axis=1) > 0
    return calm, toward[bright], rest[bright]


def truth(env, normal, view, r0, roughness, samples=1024):
    """Radiance (N, 3) without shadows, and its standard error (N, 3)."""
    calm, toward, power = calm_and_bright(env)
    alpha, rng = roughness**2, np.random.default_rng(1)
    color, error = fast.monte_carlo_shade(calm, normal, view, r0, alpha, samples, rng)
    for l, arriving in zip(toward, power, strict=True):
        cosine = np.maximum(normal @ l, 0)[:, None]
        color += fast.microfacet_brdf(normal, view, l, r0, alpha) * cosine * arriving
    return color, error


def relative_error(image, reference):
    return fw.metrics.rmse(image, reference) / reference.mean()


def on_black(values):
    """The ball of 128 pixels from the radiance of what is seen of it, twice as large."""
    picture = np.full((*small.shape, 3), 0.03)
    picture[small] = values
    return fw.tone_map(picture, exposure=-1, method="filmic").repeat(2, axis=0).repeat(2, axis=1)


small, n, v = ball(96)
for roughness in (0.3, 0.6, 1.0):
    exact, noise = truth(sky, n, v, METAL, roughness)
    quick = split_sum(n, v, METAL, roughness, light)
    error, noise = relative_error(quick, exact), np.sqrt(np.mean(noise**2)) / exact.mean()
    caption = f"RMS error {error:.0%} of the mean radiance; the truth's own standard error is {noise:.1%}."
    fw.show.strip([on_black(quick), on_black(exact), on_black(abs(quick - exact))],
                  [f"split sum, roughness {roughness}", "truth", "difference, black is none"], caption=caption)

# %% [markdown]
# The mirror image is right. The rougher the ball, the farther the split sum goes astray: the true ball is lit on all of
# the side that the sun sees, as a matt one would be, and the split sum keeps a round spot about the mirror direction. At
# the rim the true lobe is long and cut by the horizon, and the round one is neither.
#
# ### Which step is to blame?
#
# Now three lights: an overcast sky, the photographed one with its sun, and a dark room with three lamps.

# %%
R0 = 0.5
roughnesses = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0])
room = fw.skies.studio(64)
lights = {"overcast sky": fw.skies.gradient(64), "sky with sun": sky, "room with lamps": room}
_, n, v = ball(32)
with fw.show.plot("roughness", "RMS error, % of the mean radiance", "The split sum on a ball",
                  caption=f"{len(n)} points of a ball, R₀ = {R0}, against Monte Carlo.") as axes:
    for (name, env), color in zip(lights.items(), ("#2f6db5", "#d1622b", "#3f8f5b"), strict=True):
        filtered = fast.environment_light(env)
        errors = [relative_error(split_sum(n, v, R0, rough, filtered), truth(env, n, v, R0, rough)[0])
                  for rough in roughnesses]
        axes.plot(roughnesses, 100 * np.array(errors), "o-", color=color, markersize=4, label=name)
        print(f"{name}: from {min(errors):.1%} to {max(errors):.1%}, the most at roughness {roughnesses[np.argmax(errors)]}")
    axes.set_ylim(0)

# %% [markdown]
# Under the sun a nearly polished ball has the largest error of all. There the highlight is a small spot, far brighter than
# the mean, and its brightest points are a little too bright or too dark. The eye forgives that, RMS does not.
#
# In the room every sample meets some lamp, so that the steps can be told apart: how much does each of them change?

# %%
_, n, v = ball(24)
filtered = fast.environment_light(room)
between = np.array([0.25, 0.35, 0.45, 0.58, 0.72, 0.9])  # roughnesses that have no map of their own
steps = {"1: Fresnel and shadowing leave the weight": [], "2: the lobe is made round": [], "3: levels are interpolated": [],
         "all of them": []}
for rough in between:
    exact, without, as_round = three_answers(room, n, v, R0, rough**2, 1024, np.random.default_rng(2))
    final, mean = split_sum(n, v, R0, rough, filtered), exact.mean()
    for (one, other), changes in zip(((without, exact), (as_round, without), (final, as_round), (final, exact)),
                                     steps.values(), strict=True):
        changes.append(100 * fw.metrics.rmse(one, other) / mean)
with fw.show.plot("roughness", "RMS change, % of the mean radiance", "What each step changes, in the room",
                  caption=f"{len(n)} points, 1024 samples each, the same ones for all curves.") as axes:
    for (name, changes), color in zip(steps.items(), ("#8a4fa3", "#d1622b", "#3f8f5b", "0.6"), strict=True):
        axes.plot(between, changes, "o-", color=color, markersize=4, label=name)
    axes.set_ylim(0)
for name, changes in steps.items():
    print(f"{name}: {min(changes):.1f} to {max(changes):.1f} % of the mean")
first, second = (np.array(changes) for changes in list(steps.values())[:2])
print(f"The round lobe changes {min(second / first):.1f} to {max(second / first):.1f} times as much as the first step.")

# %% [markdown]
# So the split, the table and the stored levels are innocent. **The wrong weight is the error**, and most of it is the round
# lobe, as Karis (2013) said of his own method. The two steps partly cancel: all together change less than the second
# alone. And the error grows with what the light has to tell apart: an even sky does not care about the shape of a lobe, a
# lamp does.
#
# ## Shadows
#
# Now put the visibility back. A table, a crate, a cup and a ball stand on a floor, as distance fields. Take the matt part
# of the light first: a **diffuse** surface sends the same radiance to all sides. With an **albedo** (the share that it
# sends back) of 1 it is
#
# $$L_o(p) = \frac1\pi \int L(l)\, (n \cdot l)\, V(p, l)\, \mathrm{d}l .$$
#
# Without $V$ this depends on the normal alone: the **irradiance** over $\pi$, one look-up. With $V$ there are two ways to
# see it. *Many lights*: each pixel of the sky is a lamp, and each wants its shadow; here that is
# $64 \times 128 = 8192$ of them. *Sampling*: $V$ is part of the integrand, and nothing is known about it before one has
# looked. Both cost rays.
#
# Could $V$ be split off, as the light was? That makes two terms again,
# $\int L\,(n \cdot l) \cdot \frac{1}{\pi} \int V\,(n \cdot l)$. It is good where the weight is narrow or one of the two is
# smooth. The cosine is the widest of all weights, and $V$ jumps. So it cannot be good in general: we measure by how much.
#
# What engines do:
#
# - **Ambient visibility** (ambient occlusion) is that split: the irradiance times the part of the hemisphere that is free.
# - A **bent normal** is the mean of the free directions. The irradiance is looked up there.
# - **Few lamps**: cut the sky into regions of equal energy ([median cut](https://vgl.ict.usc.edu/Research/MedianCut/)),
#   replace each by one lamp in its middle, and shadow those. The sum with shadows over the sum without is the share of
#   light that is left; times the exact irradiance it has no error where nothing is hidden.
# - **The sun and the rest**: a shadow for the lamp that everybody sees, ambient visibility for all else.

# %%
legs = [((0.75 + x, 0.365, -0.25 + z), (0.05, 0.365, 0.05)) for x in (-0.68, 0.68) for z in (-0.48, 0.48)]
boxes = [((0.75, 0.78, -0.25), (0.8, 0.05, 0.58)), *legs, ((1.0, 0.98, -0.35), (0.22, 0.15, 0.22))]
solids = Solids(spheres=(((-0.85, 0.45, 0.35), 0.45), ((0.45, 0.16, 0.85), 0.16)), boxes=tuple(boxes))
scene, T_MAX = solids.sdf(), 6.0


def free(p, normal, l, k):
    """Share (N,) of a round lamp in the direction l that points see; k is 1 / sin(its angular radius)."""
    cosine = normal @ l
    share, above = np.zeros(len(p)), cosine > 0
    marched = fast.soft_shadow(scene, p[above], l, k, 0.02, T_MAX, 128)  # walkthrough 3
    share[above] = np.minimum(marched / np.minimum(k * cosine[above], 1), 1)  # the surface does not shadow itself
    return share


def cones(count):
    """Directions (count, 3) spread evenly over the sphere, and the k of a cone that covers its part of it."""
    i = np.arange(count) + 0.5
    y, phi = 1 - 2 * i / count, np.pi * (3 - np.sqrt(5)) * i
    directions = np.stack([np.sqrt(1 - y**2) * np.cos(phi), y, np.sqrt(1 - y**2) * np.sin(phi)], axis=1)
    return directions, 1 / np.sqrt(1 - (1 - 2 / count) ** 2)


def look_around(p, normal, count=64):
    """Ambient visibility (N,) and bent normals (N, 3)."""
    directions, k = cones(count)
    open_, bent, whole = np.zeros(len(p)), 1e-9 * normal, np.zeros(len(p))
    for l in directions:
        cosine = np.maximum(normal @ l, 0)
        weight = cosine * free(p, normal, l, k)
        open_, bent, whole = open_ + weight, bent + weight[:, None] * l, whole + cosine
    return open_ / whole, fw.normalize(bent)


def lamps(env, count):
    """Directions (count, 3), powers (count, 3) and ks (count,) of lamps that stand for a sky."""
    toward, power = dominant_lights(env, count)
    # As large as its power over the radiance that it shows, and no larger than its region may be.
    solid_angle = power.sum(axis=1) / np.maximum(env.radiance(toward).sum(axis=1), 1e-9)
    cosine = 1 - np.clip(solid_angle, 1e-3, 8 * np.pi / count) / (2 * np.pi)
    return toward, power, 1 / np.sqrt(np.maximum(1 - cosine**2, 1e-9)).clip(0, 0.9)


def sun_of(env):
    """Direction (1, 3), power (1, 3) and k (1,) of one lamp for all that is above 30 times the mean radiance."""
    _, toward, power = calm_and_bright(env)
    weight = power.sum(axis=1) / max(power.sum(), 1e-9)
    middle = fw.normalize(weight @ toward)
    across = weight @ (1 - (toward @ middle) ** 2)  # half the squared sine of a disc's angular radius
    return middle[None], power.sum(axis=0)[None], np.array([1 / np.sqrt(np.clip(2 * across, 1e-6, 0.8))])


def arriving(p, normal, toward, power, ks, seen=free):
    """Radiance (N, 3) of a white matt surface under lamps, with shadows and without."""
    shadowed, plain = np.zeros((2, len(p), 3))
    for l, light_power, k in zip(toward, power, ks, strict=True):
        lit = np.maximum(normal @ l, 0)[:, None] * light_power / np.pi
        plain += lit
        shadowed += lit * seen(p, normal, l, k)[:, None]
    return shadowed, plain


# %% [markdown]
# ### The picture
#
# The visibility of a place does not depend on the light. So ambient visibility is computed once for all points that the
# camera sees; then the sky may turn. Only the sun's shadow marches anew for each picture, one ray a pixel.

# %%
camera = fw.Camera((-1.6, 2.5, 4.6), (0.22, 0.38, 0.0), (0, 1, 0), 0.56)
sky, light = sky.resized(64), fast.environment_light(sky.resized(64))  # each pixel of it wants a ray, below
COLORS = np.array([[0.5, 0.48, 0.45], [0.75, 0.3, 0.16], [0.2, 0.42, 0.62], [0.62, 0.45, 0.27]])


def seen_by(camera, size):
    """Points (N, 3), normals (N, 3) and views (N, 3) that a camera sees of the scene; the floor fills the picture."""
    t, normal, _ = fast.render_sdf(scene, camera, size, size, (0, 1, 0), 8.0)
    origin, direction = (a.reshape(-1, 3) for a in camera.rays(size, size))
    normal = fw.normalize(normal.reshape(-1, 3).astype(float))
    return origin + t.reshape(-1, 1) * direction + 1e-3 * normal, normal, -direction


p, n, v = seen_by(camera, 256)
nearest = np.argmin([p[:, 1], *(np.linalg.norm(p - c, axis=1) - r for c, r in solids.spheres), fw.sdf.union(
    *(fw.sdf.box(*box) for box in solids.boxes))(p)], axis=0)
albedo = COLORS[nearest]
ambient, bent = look_around(p, n)
to_sun, sun_power, sun_k = sun_of(sky)
height_of_sun, size_of_sun = np.degrees(np.arcsin([to_sun[0, 1], 1 / sun_k[0]]))
share = sun_power.sum() / np.tensordot(sky.solid_angles(), sky.pixels, 2).sum()
print(f"The sun of this map of {sky.height} rows stands {height_of_sun:.0f}° above the horizon, has an angular radius of "
      f"{size_of_sun:.1f}°, and sends {share:.0%} of all light.")


def turned(directions, degrees):
    """Directions turned about the vertical axis."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return directions @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


def under_the_sky(shadows, turn_in_degrees):
    diffuse = light.irradiance(turned(n, -turn_in_degrees))
    if shadows == "sun + ambient":
        shadowed, plain = arriving(p, n, turned(to_sun, turn_in_degrees), sun_power, sun_k)
        diffuse = shadowed + np.maximum(diffuse - plain, 0) * ambient[:, None]
    elif shadows == "ambient":
        diffuse = diffuse * ambient[:, None]
    return fw.tone_map((albedo * diffuse).reshape(256, 256, 3), exposure=-0.5, method="filmic")


fw.interact(under_the_sky, shadows=["none", "ambient", "sun + ambient"],
            turn_in_degrees=np.linspace(0, 345, 24), title="The matt part under a sky that turns");

# %% [markdown]
# Without shadows everything floats. Ambient visibility puts things on the floor and darkens the room under the table, but no
# shadow tells where the sun stands. Its own shadow does.
#
# The truth: one ray to each pixel of the sky above the horizon. A second truth, with rays that are met in closed form
# instead of marched, and with each pixel of the sky cut in 16 parts, tells how far we may trust the first.

# %%
def every_pixel(env, p, normal):
    """Radiance (N, 3) of a white matt surface with a hard shadow ray to each pixel of a map."""
    above = env.directions()[..., 1] > 0  # below is the floor
    power = (env.pixels * env.solid_angles()[..., None])[above]
    return arriving(p, normal, env.directions()[above], power, np.full(len(power), 1e3))[0]


p, n, v = seen_by(camera, 64)
exact = every_pixel(sky, p, n)
some = np.random.default_rng(3).choice(len(p), 24, replace=False)
closed = diffuse_radiance(solids, sky, p[some], n[some], 1.0, T_MAX)
print(f"{np.sum(sky.directions()[..., 1] > 0)} rays from each of {len(p)} points; at {len(some)} of them the closed form "
      f"differs by {relative_error(exact[some], closed):.1%} (RMS, of the mean)")

# %%
ambient, bent = look_around(p, n)
irradiance = light.irradiance(n)
shadowed, plain = arriving(p, n, *lamps(sky, 16))
sun_shadowed, sun_plain = arriving(p, n, *sun_of(sky))
answers = {
    "no shadows": irradiance,
    "ambient": irradiance * ambient[:, None],
    "bent normal": light.irradiance(bent) * ambient[:, None],
    "16 lamps": irradiance * shadowed / np.maximum(plain, 1e-9),
    "sun + ambient": sun_shadowed + np.maximum(irradiance - sun_plain, 0) * ambient[:, None],
    "truth": exact,
}


def as_picture(values):
    return fw.tone_map(values.reshape(64, 64, 3), exposure=-1.5, method="filmic").repeat(3, axis=0).repeat(3, axis=1)


errors = ", ".join(f"{name} {relative_error(a, exact):.0%}" for name, a in answers.items() if name != "truth")
fw.show.strip([as_picture(a) for a in answers.values()], list(answers), "White matt surfaces under the sky with its sun",
              f"RMS error in per cent of the mean radiance: {errors}. 64 × 64 points, each drawn as 3 × 3 pixels.");

# %% [markdown]
# ## Run time against error
#
# First without shadows: the split sum against Monte Carlo, on a ball in the room with lamps. Change the roughness, or the
# light, and run the cell again.

# %%
ROUGHNESS, LIGHT = 0.5, room  # try 0.2 and 1.0; and lights["overcast sky"]

_, n_ball, v_ball = ball(64)
filtered = fast.environment_light(LIGHT)
reference, _ = truth(LIGHT, n_ball, v_ball, R0, ROUGHNESS, 4096)


def sampled(samples):
    return fast.monte_carlo_shade(LIGHT, n_ball, v_ball, R0, ROUGHNESS**2, samples, np.random.default_rng(4))[0]


points = fw.plane.measure({
    "split sum": {"two look-ups": lambda: fast.shade_split_sum(
        n_ball, v_ball, R0, ROUGHNESS, filtered.prefiltered, filtered.lut)},
    "Monte Carlo": {f"{s} samples": lambda s=s: sampled(s) for s in (4, 16, 64, 256, 1024)},
}, lambda image: 100 * relative_error(image, reference))
fw.plane.show(points, "RMS error, % of the mean radiance", f"{len(n_ball)} points of a ball, roughness {ROUGHNESS}");

# %% [markdown]
# Both are compiled and look up the same maps. Monte Carlo can be as right as one likes, for four times the samples
# per halved error. The split sum has one price and one error. Then with shadows, on the points of the strip above:

# %%
SKY, COUNTS = sky, (1, 4, 16, 64)  # try lights["overcast sky"]: another way wins

sky_light = fast.environment_light(SKY)
plain_light = sky_light.irradiance(n)
reference = exact if SKY is sky else every_pixel(SKY, p, n)


def with_lamps(count):
    shadowed, plain = arriving(p, n, *lamps(SKY, count))
    return plain_light * np.where(plain > 0, shadowed / np.maximum(plain, 1e-9), 1)


def sun_and_rest(count):
    shadowed, plain = arriving(p, n, *sun_of(SKY))
    return shadowed + np.maximum(plain_light - plain, 0) * look_around(p, n, count)[0][:, None]


def around(bend, count):
    open_, bent = look_around(p, n, count)
    return (sky_light.irradiance(bent) if bend else plain_light) * open_[:, None]


def shadow_methods():
    return {
        "no shadows": {"one look-up": lambda: sky_light.irradiance(n)},
        "ambient": {f"{s} cones": lambda s=s: around(False, s) for s in (16, 64)},
        "bent normal": {f"{s} cones": lambda s=s: around(True, s) for s in (16, 64)},
        "lamps": {f"n = {s}": lambda s=s: with_lamps(s) for s in COUNTS},
        "sun + ambient": {f"{s} cones": lambda s=s: sun_and_rest(s) for s in (16, 64)},
        "a ray to each pixel": {f"map of {h} rows": lambda h=h: every_pixel(SKY.resized(h), p, n) for h in (4, 8, 16)},
    }


points = fw.plane.measure(shadow_methods(), lambda image: 100 * relative_error(image, reference), repeats=3)
fw.plane.show(points, "RMS error, % of the mean radiance", f"Shadows from the sky at {len(p)} points");

# %% [markdown]
# Under the clear sky almost all of the shadow is the sun's. One lamp knows it, ambient visibility does not, whatever it
# costs. A ray to each pixel of a *small* map spends most of its rays on dark blue.
#
# ## What goes wrong, and the cure
#
# **Normals that look away.** A rasterised ball interpolates its normals between the corners of triangles. At the rim some
# then look away from the camera, $n \cdot v \le 0$. The microfacet model has no answer there, and black dots are left.
# *Cure:* tilt such normals back, just far enough.

# %%
facing = np.sum(normal * view, axis=1)
tilted = fw.normalize(normal + np.maximum(0.02 - facing, 0)[:, None] * view)
light_128 = fast.environment_light(small_sky(128))
rim = slice(117, 141), slice(0, 24)
crops = []
for which in (normal, tilted):
    picture = behind.copy()
    picture[mask] = fast.shade_split_sum(which, view, METAL, 0.3, light_128.prefiltered, light_128.lut)
    crops.append(fw.tone_map(picture, exposure=-1, method="filmic")[rim].repeat(9, axis=0).repeat(9, axis=1))
fw.show.strip(crops, ["as interpolated", "tilted back"], "The left rim of the ball", f"{np.sum(facing <= 0)} of {len(normal)} "
              "normals look away from the camera. 24 × 24 pixels of the rim, each drawn as 9 × 9.");

# %% [markdown]
# **A sun that samples miss.** Monte Carlo gives its own standard error along with the mean. If none of the samples has met
# the sun, both are small: the answer is wrong, *and sure of itself*. *Cure:* what is small and bright does not belong
# to chance. Sample the calm rest, and add the sun up, as `truth` does.

# %%
small, n_ball, v_ball = ball(96)
exact_ball, _ = truth(sky, n_ball, v_ball, METAL, 0.6, 2048)
by_chance, own_error = fast.monte_carlo_shade(sky, n_ball, v_ball, METAL, 0.36, 64, np.random.default_rng(5))
cured, cured_error = truth(sky, n_ball, v_ball, METAL, 0.6, 64)
fw.show.strip([on_black(by_chance), on_black(cured), on_black(exact_ball)],
              ["64 samples", "64 samples and the sun apart", "truth"],
              caption=f"RMS error {relative_error(by_chance, exact_ball):.0%} and "
                      f"{relative_error(cured, exact_ball):.0%} of the mean. Roughness 0.6.")
for name, answer, error in (("by chance", by_chance, own_error), ("the sun apart", cured, cured_error)):
    surprised = np.mean(np.abs(answer - exact_ball).max(axis=1) > 5 * error.max(axis=1))
    print(f"{name}: at {surprised:.1%} of the points the truth lies more than 5 of its own standard errors away")

# %% [markdown]
# **A surface that shadows itself.** A wide cone close to the horizon meets the very surface that it starts from. On an
# empty floor the distance at $t$ is $h = t\,(n \cdot l)$, so that the march returns $k\,h/t = k\,(n \cdot l)$, which is
# below 1 for a low lamp, with nothing in its way. *Cure:* that part of the lamp is below the horizon, and the
# cosine knows it already. Divide by it, as `free` does.

# %%
floor_point, up = np.array([[-3.0, 0.001, -3.0]]), np.array([[0.0, 1.0, 0.0]])
low = np.array([-np.cos(np.radians(10)), np.sin(np.radians(10)), 0.0])


def uncorrected(p, normal, l, k):
    return fast.soft_shadow(scene, p, l, k, 0.02, T_MAX, 128) * (normal @ l > 0)


print(f"Empty floor, a lamp of k = 3 at 10° above the horizon: it sees {uncorrected(floor_point, up, low, 3.0)[0]:.2f} of "
      f"the lamp, and {free(floor_point, up, low, 3.0)[0]:.2f} when corrected; k (n·l) = {3 * low[1]:.2f}.")
shadowed, plain = arriving(p, n, *lamps(sky, 64), seen=uncorrected)
wrong = irradiance * shadowed / np.maximum(plain, 1e-9)
shadowed, plain = arriving(p, n, *lamps(sky, 64))
right = irradiance * shadowed / np.maximum(plain, 1e-9)
print(f"64 lamps: RMS error {relative_error(wrong, exact):.1%} of the mean without the correction, "
      f"{relative_error(right, exact):.1%} with it")

# %% [markdown]
# **A sun that counts twice.** A lamp with a shadow is put where the sun is, and the scene is lit by the irradiance map
# *of the same sky* besides. The sun is in that map too. *Cure:* take the lamp's own light, without its shadow, out of
# the irradiance.

# %%
twice = sun_shadowed + irradiance * ambient[:, None]
once = sun_shadowed + np.maximum(irradiance - sun_plain, 0) * ambient[:, None]
fw.show.strip([as_picture(twice), as_picture(once), as_picture(exact)], ["sun twice", "sun once", "truth"],
              caption=f"Mean radiance {twice.mean() / exact.mean():.2f} and "
                      f"{once.mean() / exact.mean():.2f} times the truth's.");

# %% [markdown]
# ## Exercises
#
# 1. For which light is the split sum exact, at every roughness and every view, and what checks does that give?
#
# <details><summary>Answer</summary>
#
# For a light that is the same from everywhere. The mean of a constant is that constant under *any* weight, so the wrong
# one does no harm, and what is left is the table. Try `env = fw.skies.constant(16)`: what comes out is
# $R_0 \cdot \text{scale} + \text{bias}$. With $R_0 = 1$ it is the share of light that a perfect rough mirror returns,
# at most 1. This is the **white furnace**, the first test of any renderer.
#
# </details>
#
# 2. Ambient visibility asks 64 directions at each point and forgets them. How many bytes would it take to remember, for
#    each of the $256 \times 256$ points of the picture, which of the 64 are free, and what could one do with it?
#
# <details><summary>Answer</summary>
#
# One bit for each: 8 bytes a point, 512 KiB in all. Then *any* sky can light the picture without a single ray: multiply
# the bits by the cosines and by the 64 radiances of the sky, and add. That is a matrix product, and the idea behind
# *precomputed radiance transfer* (Sloan et al. 2002), which stores the product in a smooth basis instead of bits. The
# price: nothing in the scene may move, and 64 directions give a sun no sharp edge.
#
# </details>
#
# 3. Put `SKY = lights["overcast sky"]` into the last experiment. What becomes of one lamp, and what of ambient visibility?
#
# <details><summary>Answer</summary>
#
# An even sky has no sun. One lamp in the middle of all light is a fiction, and its hard shadow is worse than none. What
# matters now is how much of the sky is open: ambient visibility more than halves the error, which it could not do under
# the sun. And the front goes to a ray to each pixel of a map of eight rows: even light asks for evenly spread rays.
#
# </details>
#
# ## From the lecture
#
# The lecture finds the split sum very fast, and its results almost identical to the truth. The first is true, as the plane
# shows. The second holds for smooth light and for smooth surfaces; the curves above say how far it is from true elsewhere.
#
# On shadows from the environment it says that they are many lights or sampling, that both are too slow, and that engines
# shadow the brightest lights. The last plane agrees: under a sun, a few lamps beat all else at their price. Since then
# the sampling side has come
# to games as well, by a few rays a pixel on hardware that traces them, lights chosen by reservoirs (Bitterli et al. 2020)
# and filters that remove the noise.
#
# *What is deep learning good for in real time?* The lecture's answer is: little, it is too slow. Let us weigh it. A
# network of the size that Müller et al. (2021) ask for the light at a point has five hidden layers of 64 numbers.

# %%
layers = [np.random.default_rng(6).standard_normal((64, width), dtype=np.float32) / 8 for width in (64,) * 6 + (3,)]
features = np.random.default_rng(7).standard_normal((len(normal), 64), dtype=np.float32)


def network(x):
    for layer in layers:
        x = np.maximum(x @ layer, 0)
    return x


two_lookups, asked = fw.plane.medians([
    lambda: fast.shade_split_sum(normal, view, METAL, 0.3, light.prefiltered, light.lut), lambda: network(features)])
print(f"{sum(layer.size for layer in layers):,} multiplications a pixel. For the {len(normal):,} pixels of the ball: "
      f"{1e3 * asked:.0f} ms for the network, {1e3 * two_lookups:.1f} ms for the split sum: 1 to {asked / two_lookups:.0f}.")

# %% [markdown]
# So as a replacement for two look-ups it was too slow, and still is. What has changed is what it is asked for, and where:
# graphics cards now have units for small matrix products, and networks are used once a frame for what has no formula:
# to remove noise (Chaitanya et al. 2017), to draw at low resolution and enlarge, to remember light that has bounced
# (Müller et al. 2021), to stand for a layered material (Zeltner et al. 2024).
#
# ## Where to read on
#
# - Brian Karis, *Real Shading in Unreal Engine 4*, SIGGRAPH courses, 2013: the split sum, with the n = v = r.
# - Sébastien Lagarde, Charles de Rousiers, *Moving Frostbite to Physically Based Rendering*, SIGGRAPH courses, 2014: how to
#   bend the mirror direction so that the round lobe errs less.
# - Paul Debevec, *A Median Cut Algorithm for Light Probe Sampling*, SIGGRAPH posters, 2005.
# - Eric Heitz, Stephen Hill, Morgan McGuire, *Combining Analytic Direct Illumination and Stochastic Shadows*, I3D, 2018: the
#   quotient with and without shadows.
# - Jorge Jimenez, Xian-Chun Wu, Angelo Pesce, Adrian Jarabo, *Practical Real-Time Strategies for Accurate Indirect
#   Occlusion*, SIGGRAPH courses, 2016: ambient visibility and bent normals, for mirrors too.
# - Peter-Pike Sloan, Jan Kautz, John Snyder, *Precomputed Radiance Transfer for Real-Time Rendering in Dynamic,
#   Low-Frequency Lighting Environments*, SIGGRAPH, 2002.
# - Benedikt Bitterli et al., *Spatiotemporal Reservoir Resampling for Real-Time Ray Tracing with Dynamic Direct Lighting*,
#   SIGGRAPH, 2020.
# - Chakravarty Chaitanya et al., *Interactive Reconstruction of Monte Carlo Image Sequences Using a Recurrent Denoising
#   Autoencoder*, SIGGRAPH, 2017; Thomas Müller et al., *Real-Time Neural Radiance Caching for Path Tracing*, SIGGRAPH, 2021;
#   Tizian Zeltner et al., *Real-Time Neural Appearance Models*, ACM Transactions on Graphics, 2024.
#
# The assignments `split_sum` and `environment_shadows` have you write all of this yourself.
