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
# # 2 · Sphere tracing and what it costs
#
# ## The question
#
# A camera sends a ray through each pixel. **Where does the ray first meet a surface, when all we know of the scene is a
# distance function? And how many questions must we ask?**
#
# Words that we need:
#
# - A **ray** starts at the origin $o$ and goes along the unit vector $d$; its points are $o + t\,d$, with $t$ in
#   scene units.
# - The **signed distance function** $f(p)$ says how far the nearest surface is from $p$, negative inside. It is a
#   safe step: the ball of radius $f(p)$ about $p$ is empty ([walkthrough 1](01_distance_functions.ipynb)).
# - An **evaluation** is one point handed to $f$. It is what costs, and it is counted exactly, on any machine alike.
# - A pixel's **footprint** at $t$ is how wide the pixel is there, in scene units: it grows in proportion to $t$.

# %%
import numpy as np

import framework as fw
from framework import colors
from framework.tape import compiled
from solutions.gallery import _nine_shapes

# %% [markdown]
# ## The idea
#
# Walk by as much as is safe, and ask again:
#
# $$t_0 = 0, \qquad t_{i+1} = t_i + f(o + t_i\,d) .$$
#
# The points run up to the surface and never through it. Where $f < \varepsilon$, the march is near enough: a **hit**.
# Where $t > t_\max$, the ray has left the scene: a **miss**.
#
# How fast is that? Close to a surface, it looks like a plane. If the ray meets it under the angle $\theta$ to its
# normal, a distance $h$ is followed by
#
# $$h' = (1 - \cos\theta)\,h .$$
#
# Straight on, one step does it. At 60°, each step leaves half. Near 90° almost nothing is gained: **rays that graze a
# surface are what sphere tracing costs.**
#
# Can one step further than $f$? **Over-relaxation** steps $\omega f$ with $1 < \omega < 2$, and then looks whether
# the ball there still touches the last one: $\omega h \le h + h'$. If so, no surface hides between. If not, it goes
# back and takes the plain step. **Auto-relaxation** learns the factor from the ray's own past: with $m$, a running
# mean of the slope $(h' - h)/\text{step}$, the next step is $2h/(1 - m)$, the one that would meet the next ball
# exactly if the surface were flat.

# %% [markdown]
# ## The code
#
# All rays march together; those that are done are taken out, so that only rays that still march are evaluated.
# `width` is $\varepsilon$ as a function of $t$.


# %%
def march(sdf, origin, direction, width, t_max=30.0, max_steps=128, omega=1.0, beta=None):
    """Where each ray meets the surface, (N,), inf where it does not; and the evaluations that it took, (N,)."""
    found, evaluations = np.full(len(direction), np.inf), np.ones(len(direction), int)
    ray, t, m = np.arange(len(direction)), np.zeros(len(direction)), np.full(len(direction), -1.0)
    relaxed = np.full(len(direction), omega)
    h = sdf(origin + t[:, None] * direction)
    for _ in range(max_steps - 1):
        step = relaxed * h if beta is None else 2 * h / (1 - np.minimum(m, 0.8))
        ahead = t + step
        there = sdf(origin + ahead[:, None] * direction)
        evaluations[ray] += 1
        meets = step <= h + np.abs(there)  # else something may hide between the two balls
        if beta is not None:
            m = np.where(meets, (1 - beta) * m + beta * (there - h) / np.maximum(step, 1e-30), -1.0)
        relaxed = np.where(meets, relaxed, 1.0)
        t, h = np.where(meets, ahead, t), np.where(meets, there, h)
        hit = meets & (h < width(t))
        found[ray[hit]] = t[hit]
        on = ~hit & (t <= t_max)
        ray, t, h, m, relaxed, direction = ray[on], t[on], h[on], m[on], relaxed[on], direction[on]
        if not len(ray):
            break
    return found, evaluations


STEPPERS = {"plain": {}, "over-relaxed": {"omega": 1.2}, "auto-relaxed": {"beta": 0.3}}

# %% [markdown]
# First the claim about the angle: one plane, rays under four angles, and what is left of the distance after each
# step. The slopes in the picture are measured; the labels say what $1 - \cos\theta$ promises.

# %%
with fw.show.plot("steps", "distance that is left, in parts of the first", "How a march arrives at a plane") as axes:
    axes.set(yscale="log", ylim=(1e-6, 1.5))
    for degrees, color in ((30, "#3f8f5b"), (60, "#2f6db5"), (75, "#d1622b"), (85, "#c23b5a")):
        cosine, height, left = np.cos(np.radians(degrees)), 1.0, []
        for _ in range(40):
            left.append(height)
            height = height - height * cosine
        slope = (left[20] / left[0]) ** (1 / 20)
        axes.semilogy(left, ".-", color=color, markersize=3, linewidth=1,
                      label=f"{degrees}°: times {slope:.2f} a step, 1 − cos = {1 - cosine:.2f}")  # fmt: skip

# %% [markdown]
# ## The picture
#
# Nine shapes, and for each pixel the number of evaluations. Bright rims are rays that just miss an object: they creep
# along it. So does the floor near the horizon. In a live notebook, choose a stepper and walk around the scene.

# %%
scene = _nine_shapes()
field = compiled(scene)  # the same values, evaluated by a compiled program
PIXEL = 2 * np.tan(0.75 / 2) / 256  # a pixel's footprint at distance 1


def camera_at(degrees):
    turn = np.radians(degrees)
    return fw.Camera((7.2 * np.sin(turn), 3.4, 7.2 * np.cos(turn)), (0, 0.4, 0), (0, 1, 0), 0.75)


def cost(stepper, turn_in_degrees):
    origin, direction = (a.reshape(-1, 3) for a in camera_at(turn_in_degrees).rays(256, 256))
    _, evaluations = march(field, origin[0], direction, lambda t: 0.5 * PIXEL * t, 20.0, 64, **STEPPERS[stepper])
    return colors.from_table(np.minimum(evaluations, 40).reshape(256, 256).astype(float), 0, 40, colors.SEQUENTIAL)


fw.interact(cost, stepper=list(STEPPERS), turn_in_degrees=np.linspace(0, 72, 37),
            title="Evaluations a ray: 0 is dark blue, 20 green, 40 or more pale yellow");  # fmt: skip

# %%
origin, direction = (a.reshape(-1, 3) for a in camera_at(36).rays(256, 256))
counts = {}
for name, options in STEPPERS.items():
    _, counts[name] = march(field, origin[0], direction, lambda t: 0.5 * PIXEL * t, **options)
    print(f"{name:12s}: {counts[name].mean():5.1f} evaluations a ray, "
          f"one ray in a hundred more than {np.percentile(counts[name], 99):.0f}")  # fmt: skip
costly = np.sort(counts["plain"])[::-1]
share = costly[: len(costly) // 10].sum() / costly.sum()
print(f"The most expensive tenth of the rays takes {share:.0%} of all evaluations of the plain march.")
fw.show.march_heat_map(np.minimum(counts["plain"], 40).reshape(256, 256), "The plain march; 40 stands for 40 or more");

# %% [markdown]
# ## Run time against error
#
# When is a hit good enough? The error here is measured along the ray, in footprints of a pixel, on the average of all
# rays; where one march hits and the truth does not, it counts as 10. The truth is a march to $10^{-6}$ with thousands
# of steps. Two rules for $\varepsilon$ compete: a constant, and a part of the pixel's footprint. **Change the lists
# in the first line.**

# %%
constants, parts = (1e-1, 1e-2, 1e-3, 1e-4), (2.0, 1.0, 0.5, 0.25, 0.1)

origin, direction = (a.reshape(-1, 3) for a in camera_at(36).rays(96, 96))
wide = PIXEL * 256 / 96
truth, _ = march(scene, origin[0], direction, lambda t: 1e-6, max_steps=5000, beta=0.3)


def pixels_off(result):
    t, same = result[0], np.isfinite(result[0]) == np.isfinite(truth)
    off = np.abs(np.where(np.isfinite(truth) & same, t, 0) - np.where(np.isfinite(truth) & same, truth, 0))
    return np.mean(np.where(same, np.minimum(off / (wide * np.where(np.isfinite(truth), truth, 1)), 10), 10))


def run(width, **options):
    return lambda: march(field, origin[0], direction, width, max_steps=256, **options)


points = fw.plane.measure(
    {
        "plain, constant width": {f"{eps:g}": run(lambda t, eps=eps: eps) for eps in constants},
        "plain, part of a pixel": {f"{part:g} pixel": run(lambda t, part=part: part * wide * t) for part in parts},
        "auto-relaxed, part of a pixel": {
            f"{part:g} pixel": run(lambda t, part=part: part * wide * t, beta=0.3) for part in parts
        },
    },
    error=pixels_off,
    repeats=3,
)
fw.plane.show(points, "mean error along the ray, footprints of a pixel", "When to stop a march, 96 × 96 rays")

# %%
def least_time(method, wanted):
    return min((p.milliseconds for p in points if p.method.startswith(method) and p.error <= wanted), default=np.inf)


methods = {p.method for p in points}
wanted = 1.05 * max(min(p.error for p in points if p.method == method) for method in methods)
for method in ("plain, constant", "plain, part", "auto-relaxed"):
    print(f"{method:16s}: an error of {wanted:.2g} footprints or less takes {least_time(method, wanted):.0f} ms")

# %% [markdown]
# In this scene, all of one size and seen from one distance, a well chosen constant does as well as a part of the
# pixel. But it must be chosen anew whenever the camera goes ten times nearer or further away; the pixel's part need
# not.
#
# ## What goes wrong, and the cure
#
# ### 1. Steps run out before the ray arrives
#
# A march needs an end. Many programs stop after so many steps and call that a miss. Then the grazing rays, just those
# that need most, show the sky: a rim of holes. **The cure** is to look how near the ray is when the steps are gone.
# If the surface is within a few footprints, to call it a hit is nearer the truth.

# %%
origin, direction = (a.reshape(-1, 3) for a in camera_at(36).rays(192, 192))
near = PIXEL * 256 / 192
truth_hit = np.isfinite(march(field, origin[0], direction, lambda t: 0.1 * near * t, max_steps=2000)[0])


def with_candidate(max_steps):
    """Plain steps to the end of the budget; a ray that is then within two footprints counts as a hit."""
    t = np.zeros(len(direction))
    for _ in range(max_steps):
        h = field(origin[0] + t[:, None] * direction)
        t = np.where((h < 0.1 * near * t) | (t > 30), t, t + h)
    return (h < 2 * near * t) & (t <= 30)


pictures, names = [], []
for steps in (16, 32, 64):
    plain = np.isfinite(march(field, origin[0], direction, lambda t: 0.1 * near * t, max_steps=steps)[0])
    cured = with_candidate(steps)
    wrong, left = np.mean(plain != truth_hit), np.mean(cured != truth_hit)
    print(f"{steps} steps: wrong in {wrong:.2%} of the pixels, {left:.2%} with the cure")
    if steps < 64:
        for name, hit in ((f"{steps} steps", plain), ("the same, cured", cured)):
            picture = np.where(hit[:, None], 0.8, 0.0) * np.ones(3)
            picture[hit != truth_hit] = [0.9, 0.25, 0.1]
            pictures.append(picture.reshape(192, 192, 3))
            names.append(name)
fw.show.strip(pictures, names, "Which rays hit",
              "Grey: a hit; black: a miss; red: another answer than the truth's. The view is 43° high.");

# %% [markdown]
# ### 2. Stepping too far, without looking back
#
# Over-relaxation without its test jumps through whatever is thinner than the excess of its steps. Here are thin
# posts, and a factor of 1.2. **The cure** is the line with `meets` in the code above: it costs nothing that is not
# evaluated anyway.


# %%
def reckless(sdf, origin, direction, width, omega, t_max=30.0, max_steps=256):
    t, hit = np.zeros(len(direction)), np.zeros(len(direction), bool)
    for _ in range(max_steps):
        h = sdf(origin + t[:, None] * direction)
        hit |= (np.abs(h) < width(t)) & (t <= t_max)
        t = np.where(hit, t, t + omega * np.abs(h))
    return hit


places = [(x, z) for x in np.linspace(-1.5, 1.5, 7) for z in (-1, 0)]
post_tree = fw.sdf.union(*(fw.sdf.capsule((x, -1, z), (x, 1, z), 0.03) for x, z in places))
posts = compiled(post_tree)
view = fw.Camera((0.6, 0.4, 4.5), (0, 0, 0), (0, 1, 0), 0.6)
origin, direction = (a.reshape(-1, 3) for a in view.rays(192, 192))
fine = lambda t: np.full_like(t, 1e-3)  # noqa: E731
right = np.isfinite(march(posts, origin[0], direction, fine, max_steps=1000)[0])
ways = {
    "plain": right,
    "1.2, reckless": reckless(posts, origin[0], direction, fine, 1.2),
    "1.2, looking back": np.isfinite(march(posts, origin[0], direction, fine, omega=1.2, max_steps=1000)[0]),
}
for name, hit in ways.items():
    print(f"{name:18s}: loses {np.sum(right & ~hit) / np.sum(right):.1%} of the posts' pixels")
fw.show.strip([hit.reshape(192, 192, 1) * np.full(3, 0.85) for hit in ways.values()], list(ways), "Thin posts",
              f"Grey: a hit; black: a miss. The view is {np.degrees(0.6):.0f}° high.");

# %% [markdown]
# ### 3. An $\varepsilon$ that float32 cannot reach
#
# In float32 a number near $t$ has neighbours $6 \times 10^{-8}\,t$ to $1.2 \times 10^{-7}\,t$ away. If $\varepsilon$
# is smaller than what rounding does to the point $o + t\,d$, a ray may stand before the surface for ever: each step
# is too small to change $t$. **The cure**: never ask for less than a few such neighbours, $\varepsilon \ge
# 4\,\mathrm{ulp}(t)$. The footprint of a pixel is wider in all practice.

# %%
def stuck(eps, distance, floor_of_eps=0.0):
    """Share of 2000 rays in float32 towards a tilted plane that never come to h < eps in 500 steps."""
    slant = np.linspace(0.3, 1.4, 2000).astype(np.float32)  # angle of the ray to the plane's normal, radians
    normal, along = np.stack([np.cos(slant), np.sin(slant)], axis=-1), np.float32([1, 0])
    anchor = normal[:, 0] * np.float32(distance)
    t = np.zeros(len(slant), np.float32)
    for _ in range(500):
        h = anchor - (normal * (t[:, None] * along)).sum(axis=1, dtype=np.float32)
        t = np.where(h < np.maximum(eps, floor_of_eps * np.spacing(t)), t, t + h)
    return np.mean(h >= np.maximum(eps, floor_of_eps * np.spacing(t)))


for distance in (1, 100, 10_000):
    for eps in (1e-4, 1e-7):
        print(f"{distance:6d} units away, ε = {eps:.0e}: {stuck(eps, distance):6.1%} of the rays never arrive, "
              f"{stuck(eps, distance, 4.0):.1%} with the cure")  # fmt: skip

# %% [markdown]
# ## Exercises
#
# **1.** A ray meets a wall under 80° to its normal, from one unit of distance. How many steps to $\varepsilon =
# 10^{-3}$? And straight on?
#
# <details><summary>Answer</summary>
#
# $(1 - \cos 80°)^n \le 10^{-3}$ gives $n = \ln 10^{-3} / \ln(1 - \cos 80°)$, printed below. Straight on, one step.
# Grazing angles cost by the logarithm of a number near 1.
#
# </details>
#
# **2.** Somebody is afraid of holes, and halves all distances: $\tfrac12 f$ instead of $f$. The picture stays the
# same. What does it cost?
#
# <details><summary>Answer</summary>
#
# Half a step each time: far from everything, twice as many steps. Near the surface it is worse: straight on, one step
# becomes a halving each, until $\varepsilon$ is reached. The cell below counts. This is what a field that is only a
# *bound* costs, and why a bound should be as close to the distance as one can make it.
#
# </details>
#
# **3.** A floor without end lies under the scene. Of what use is it to meet it by its equation, and to march only for
# the rest?
#
# <details><summary>Answer</summary>
#
# The floor is the nearest surface almost everywhere near it, and holds back each ray that passes over it, also those
# that never touch it. Without it in the field, rays walk freely to the objects; where the plane's own $t = -o_y/d_y$
# comes before, that is the hit. The cell below counts. The compiled engine does so for all convex shapes.
#
# </details>

# %%
print(f"1. under 80°: {np.ceil(np.log(1e-3) / np.log(1 - np.cos(np.radians(80)))):.0f} steps; straight on: 1")
origin, direction = (a.reshape(-1, 3) for a in camera_at(36).rays(128, 128))
part = lambda t: 0.5 * PIXEL * 2 * t  # noqa: E731
_, whole = march(field, origin[0], direction, part, max_steps=1000)
_, halved = march(lambda p: 0.5 * field(p), origin[0], direction, part, max_steps=1000)
print(f"2. evaluations a ray: {whole.mean():.1f} with f, {halved.mean():.1f} with f / 2")
objects = compiled(fw.sdf.union(*scene.of[1:]))  # the first of the nine is the floor
_, without = march(objects, origin[0], direction, part, max_steps=1000)
print(f"3. evaluations a ray: {whole.mean():.1f} with the floor in the field, {without.mean():.1f} without it")

# %% [markdown]
# ## From the lecture
#
# *Within the distance, every direction is safe; a ray that has gone far without meeting anything can be given up.*
# Both are in the code above, the second as `t_max`. What the lecture leaves out is the price list: the angle decides
# about the steps, the pixel about when to stop, and grazing rays about the time.
#
# ## Where to read on
#
# - John C. Hart, *Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces*, The Visual
#   Computer 12, 1996.
# - Benjamin Keinert, Henry Schäfer, Johann Korndörfer, Urs Ganse, Marc Stamminger, *Enhanced sphere tracing*, Smart
#   Tools and Apps for Graphics, 2014: over-relaxation with its test, and the pixel's cone.
# - Róbert Bán, Gábor Valasek, *Automatic step size relaxation in sphere tracing*, Eurographics short papers, 2023.
# - Eric Galin, Eric Guérin, Axel Paris, Adrien Peytavie, *Segment tracing using local Lipschitz bounds*, Computer
#   Graphics Forum 39, 2020: how far is safe in *this* direction.
# - Wilhem Barbier and others, *Lipschitz pruning*, Computer Graphics Forum 44, 2025: leaving out the parts of a scene
#   that cannot be nearest.
