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
# # 1 · Distance functions and blending
#
# ## The question
#
# A shape can be a list of triangles. Or it can be a *question that you may ask at any point $p$ of space*: **how far
# is it from here to the nearest point of the surface?** What can be done with such answers that cannot be done with
# triangles, and what do we have to be careful about?
#
# Words that we need:
#
# - The **distance function** of a shape gives that distance, in scene units. **Signed** means: positive outside, 0 on
#   the surface, negative inside. We write $f(p)$, and call it an SDF for short.
# - The **gradient** $\nabla f$ is the vector of the three derivatives; it points to where $f$ grows fastest.
# - A function is **1-Lipschitz** if a step of length $s$ never changes it by more than $s$:
#   $\lvert f(p) - f(q)\rvert \le \lVert p - q\rVert$.

# %%
import numpy as np

import framework as fw
from solutions.daylight import daylight
from solutions.sphere_tracing import sphere_trace

# %% [markdown]
# ## The idea
#
# With the surface $S$,
#
# $$f(p) = \pm \min_{q \in S} \lVert p - q \rVert , \qquad \lVert\nabla f\rVert = 1 \text{ where the nearest point is unique.}$$
#
# The second half says that one step straight away from the surface makes the distance one step larger. From this
# follows the promise that everything later rests on: $f$ is 1-Lipschitz, so that **the ball of radius $\lvert
# f(p)\rvert$ about $p$ contains no surface**.
#
# Distances are numbers, and numbers can be mixed. With two fields $d_1$ and $d_2$:
#
# | name | formula | what it is |
# | --- | --- | --- |
# | union | $\min(d_1, d_2)$ | whatever is nearer |
# | intersection | $\max(d_1, d_2)$ | inside both |
# | subtraction | $\max(d_1, -d_2)$ | the first without the second |
# | blend | $(1 - t)\,d_1 + t\,d_2$ | a shape between the two, $0 \le t \le 1$ |
# | smooth union | $\min(d_1, d_2) - \max(k - \lvert d_1 - d_2\rvert, 0)^2 / (4k)$ | a seam of width $k$, in scene units |
#
# Each of them is 1-Lipschitz if $d_1$ and $d_2$ are: minimum and maximum choose one of two, and the last two have a
# gradient that is a weighted mean of theirs. The promise is kept. But the result need not *be* the distance any more.
# It is a **bound**: never further from 0 than the distance is.

# %% [markdown]
# ## The code
#
# Three primitives and the mixtures, for points of shape `(N, 3)`. A ball: the distance to its centre, less the
# radius. A box: how far $p$ is beyond each pair of faces; outside, only what is positive counts, inside, the nearest
# face. A ring: in the plane that holds the axis and $p$ it is a circle.


# %%
def sphere(p, center, radius):
    return np.linalg.norm(p - np.asarray(center), axis=-1) - radius


def box(p, center, half_size):
    beyond = np.abs(p - np.asarray(center)) - half_size
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=-1)
    return outside + np.minimum(beyond.max(axis=-1), 0)


def torus(p, center, major_radius, minor_radius):
    q = p - np.asarray(center)
    from_ring = np.hypot(q[..., 0], q[..., 2]) - major_radius
    return np.hypot(from_ring, q[..., 1]) - minor_radius


def blend(d1, d2, t):
    return (1 - t) * d1 + t * d2


def smooth_union(d1, d2, k):
    return np.minimum(d1, d2) - np.maximum(k - np.abs(d1 - d2), 0) ** 2 / (4 * k)


# %% [markdown]
# A slice through a box and a ball. Thin lines join points of equal distance. Outside they are rounded at a corner,
# for there the corner itself is nearest; inside they have a crease where two faces are equally near, and only there
# the gradient has a jump.

# %%
fw.show.sdf_slice(lambda p: np.minimum(box(p, (-0.6, 0, 0), (0.9, 0.6, 0.5)), sphere(p, (1.1, 0.3, 0), 0.5)), axis="z",
                  title="Union of a box and a ball, at z = 0");  # fmt: skip

# %% [markdown]
# Why blend *distances* and not pictures? The lecture's example: a wall whose edge moves from $x = -0.5$ to $x = 0.5$.
# Halfway between the two *pictures* there is a grey ghost of both. Halfway between the two *distances* there is an
# edge at 0: the wall has moved.

# %%
x = np.linspace(-1, 2.4, 681)
before, after = x + 0.5, x - 0.5  # distances to the edge; the wall is where they are negative
middle = x[np.argmin(np.abs(blend(before, after, 0.5)))]
with fw.show.plot("x, scene units", "1 in the wall, 0 outside", "An edge on its way, half of the time",
                  f"The blend of distances has its edge at x = {middle:.2f}.", height=2.4) as axes:  # fmt: skip
    axes.plot(x, (before < 0) * 1.0, color="0.75", label="before")
    axes.plot(x, (after < 0) * 1.0, color="0.75", linestyle="--", label="after")
    axes.plot(x, 0.5 * (before < 0) + 0.5 * (after < 0), color="#d1622b", label="mean of the pictures")
    axes.plot(x, (blend(before, after, 0.5) < 0) * 1.0, color="#2f6db5", label="wall of the mean distance")
    axes.legend(loc="upper right", fontsize=8, frameon=False)

# %% [markdown]
# ## The picture
#
# Two shapes and all that lies between them. There is no such mean of two triangle meshes: which corner would become
# which? The compiled engine meets the blended field with rays ([walkthrough 2](02_sphere_tracing.ipynb) shows how)
# and lights it. In a live notebook, drag the slider.

# %%
camera = fw.Camera((2.4, 2.6, 3.6), (0, 0.55, 0), (0, 1, 0), 0.6)
ground = fw.sdf.plane((0, 1, 0), 0.0)
brick, ring = fw.sdf.box((0, 0.7, 0), (0.9, 0.6, 0.6)), fw.sdf.torus((0, 0.7, 0), 0.85, 0.34)


def between(t):
    return daylight(fw.sdf.union(ground, fw.sdf.blend(brick, ring, t)), camera, 256, 12)


fw.interact(between, t=np.linspace(0, 1, 41), title="From a box to a ring");

# %% [markdown]
# Where the plain minimum leaves a crease, the smooth one lays a fillet. $k$ is a length, the width of the seam.

# %%
left, right = fw.sdf.sphere((-0.55, 0.75, 0), 0.7), fw.sdf.sphere((0.65, 0.6, 0.15), 0.5)


def melted(k):
    return daylight(fw.sdf.union(ground, fw.sdf.smooth_union(left, right, k)), camera, 256, 12)


fw.interact(melted, k=np.geomspace(0.02, 1.5, 41), title="A union with a rounded seam");

# %% [markdown]
# ## Run time against error
#
# What is a formula worth? Without one, we could scatter $N$ points over the surface and take the distance to the
# nearest. Here are both ways for a ring, at two thousand points near it. The truth is the formula in longer numbers,
# with 80 bits where the machine has them. **Change `samples` in the first line**: how many would be needed to come as
# near as the formula in float32?

# %%
samples = (64, 256, 1024, 4096)

rng = np.random.default_rng(1)
near = rng.uniform(-1.6, 1.6, (2000, 3))
exact = torus(near.astype(np.longdouble), np.zeros(3, np.longdouble), 1, np.longdouble(0.4))


def by_samples(count):
    """Signed distance to the nearest of so many points on the ring, spread evenly by the golden ratio."""
    i = np.arange(count)
    u, v = 2 * np.pi * (i + 0.5) / count, 2 * np.pi * i * 0.6180339887
    surface = np.stack([(1 + 0.4 * np.cos(v)) * np.cos(u), 0.4 * np.sin(v), (1 + 0.4 * np.cos(v)) * np.sin(u)], axis=-1)
    squared = (near**2).sum(axis=1)[:, None] + (surface**2).sum(axis=1) - 2 * near @ surface.T
    inside = np.hypot(np.hypot(near[:, 0], near[:, 2]) - 1, near[:, 1]) < 0.4
    return np.sqrt(np.maximum(squared.min(axis=1), 0)) * np.where(inside, -1, 1)


in_float32 = near.astype(np.float32)
points = fw.plane.measure(
    {
        "nearest of N points": {f"N = {n}": lambda n=n: by_samples(n) for n in samples},
        "formula": {
            "float32": lambda: torus(in_float32, np.zeros(3, np.float32), np.float32(1), np.float32(0.4)),
            "float64": lambda: torus(near, np.zeros(3), 1.0, 0.4),
        },
    },
    error=lambda distance: np.sqrt(np.mean((distance - exact) ** 2)),
)
fw.plane.show(points, "RMS error of the distance, scene units", "Distance to a ring, two thousand points")

# %%
scattered = [p for p in points if p.method.startswith("nearest")]
first, last = scattered[0], scattered[-1]
power = np.log(first.error / last.error) / np.log(samples[-1] / samples[0])
single = next(p for p in points if p.setting == "float32")
print(f"From {first.setting} to {last.setting} the error falls as N to the power {-power:.2f}.")
needed = samples[-1] * (last.error / single.error) ** (1 / power)
print(f"At that rate float32's error of {single.error:.1e} needs about {needed:.0e} points.")

# %% [markdown]
# A formula is exact, needs a few numbers of memory, and costs next to nothing. This is why a scene of formulas can be
# met at every pixel anew. For shapes without one, [walkthrough 4](04_distance_grids.ipynb) stores distances on a
# grid.

# %% [markdown]
# ## What goes wrong, and the cure
#
# ### 1. Stretching breaks the promise
#
# Moving and turning a shape is easy: ask the field at the point moved and turned *back*. Enlarging it by $s$ needs a
# factor, $s\,f(p/s)$, since all distances grow. But stretch it by different factors along the axes, and $f(p/s)$ is
# no distance at all: across the flat side it grows faster than we walk. A ray that trusts it jumps through the wall.
# We flatten a ball to a lens, and let the rays of a camera look for it.

# %%
stretch = np.array([1.4, 0.5, 1.4])


def lens(p):
    return sphere(p / stretch, (0, 0, 0), 1.0)


def steepest(f, count=20_000):
    p, step = rng.uniform(-2, 2, (count, 3)), fw.normalize(rng.normal(size=(count, 3)))
    return np.max(np.abs(f(p + 1e-4 * step) - f(p)) / 1e-4)


view = fw.Camera((2.2, 2.1, 1.8), (0, 0, 0), (0, 1, 0), 0.95)
origin, direction = (a.reshape(-1, 3) for a in view.rays(160, 160))
a, b = direction / stretch, origin / stretch  # where the lens is a ball of radius 1, hit by a square equation
hidden = np.sum(a * b, axis=1) ** 2 >= np.sum(a * a, axis=1) * (np.sum(b * b, axis=1) - 1)
fields = {"f(p / s)": lens, "smallest s times f(p / s)": lambda p: stretch.min() * lens(p)}
pictures, names = [np.repeat(hidden.reshape(160, 160, 1) * 0.8, 3, axis=2)], ["truth"]
for name, field in fields.items():
    _, hit = sphere_trace(field, origin, direction, 20.0, 1e-3, 200)
    pictures.append(np.repeat(hit.reshape(160, 160, 1) * 0.8, 3, axis=2))
    names.append(name)
    missed = np.sum(hidden & ~hit) / np.sum(hidden)
    print(f"{name}: grows by up to {steepest(field):.2f} a unit; {missed:.0%} of the rays that should hit miss")
fw.show.strip(pictures, names, "A flat lens, seen by rays",
              f"Grey: the ray hits; black: it misses. Each picture is {np.degrees(view.fov_y):.0f}° high.");

# %% [markdown]
# **The cure** is the smallest factor in front: then no direction grows faster than 1. The rays take more and shorter
# steps where the lens is wide, which is the price. It is the same for every bending of space: divide by how much it
# can stretch a distance.
#
# ### 2. Normals from differences: neither too near nor too far
#
# Light needs the **normal**, the unit vector that stands on the surface, and $\nabla f$ is one. We can only ask for
# values, so take differences over a step $\varepsilon$: to both sides of each axis, six values (*central*), or
# towards the corners of a tetrahedron, four values. A long step sees the surface's curvature. A short one subtracts
# two nearly equal numbers, and what is left are their rounding errors.


# %%
def central(f, p, eps):
    steps = np.eye(3, dtype=p.dtype) * p.dtype.type(eps)
    return fw.normalize(np.stack([f(p + s) - f(p - s) for s in steps], axis=-1).astype(float))


def tetrahedron(f, p, eps):
    corners = np.array([[1, -1, -1], [-1, -1, 1], [-1, 1, -1], [1, 1, 1]], p.dtype)
    return fw.normalize(sum(c * f(p + p.dtype.type(eps) * c)[:, None] for c in corners).astype(float))


def ring_field(p):
    kind = p.dtype.type
    return torus(p, np.zeros(3, kind), kind(1), kind(0.4))


u, v = rng.uniform(0, 2 * np.pi, (2, 2000))
outward = np.stack([np.cos(v) * np.cos(u), np.sin(v), np.cos(v) * np.sin(u)], axis=-1)
on_ring = np.stack([np.cos(u), np.zeros_like(u), np.sin(u)], axis=-1) + 0.4 * outward
steps = np.geomspace(1e-9, 0.3, 60)
with fw.show.plot("step ε, scene units", "mean error of the normal, degrees", "Normals of a ring by differences") as axes:
    axes.set(xscale="log", yscale="log")
    for kind, color in ((np.float32, "#d1622b"), (np.float64, "#2f6db5")):
        for method, line in ((central, "-"), (tetrahedron, ":")):
            wrong = []
            for eps in steps:
                estimate = method(ring_field, on_ring.astype(kind), eps)
                sine = np.linalg.norm(np.cross(estimate, outward), axis=1)
                angle = np.degrees(np.arctan2(sine, np.sum(estimate * outward, axis=1)))
                wrong.append(np.where(estimate.any(axis=1), angle, 90).mean())  # no direction at all counts as 90°
            axes.plot(steps, wrong, line, color=color, label=f"{kind.__name__}, {method.__name__}")
            least = np.argmin(wrong)
            rule = np.finfo(kind).eps ** (1 / 3 if method is central else 1 / 2)
            print(f"{kind.__name__}, {method.__name__:11s}: best step {steps[least]:.0e} (the rule says {rule:.0e}), error "
                  f"{wrong[least]:.1e}°; with a step of 1e-08 {np.interp(1e-8, steps, wrong):.1e}°")  # fmt: skip

# %% [markdown]
# **The cure** is to choose the step by the digits that there are. With numbers exact to one part in $1/u$, rounding
# costs about $u/\varepsilon$. Central differences pay $\varepsilon^2$ for the curvature: both are equal at
# $\varepsilon \approx u^{1/3}$. The four values of the tetrahedron do not cancel the second derivatives, they pay
# $\varepsilon$ itself, and are best at $u^{1/2}$. That is the rule in the printed lines.
#
# ### 3. A smooth minimum that overflows
#
# Another smooth union takes all of space into account, $-k \ln(e^{-d_1/k} + e^{-d_2/k})$. As it stands it fails: deep
# inside, $e^{-d/k}$ is larger than any number; far outside, both terms are 0, and the logarithm of 0 is no number
# either. **The cure**: take the smaller distance $m$ out of the sum first, $m - k \ln(e^{-(d_1 - m)/k} + e^{-(d_2 -
# m)/k})$. One term is then 1, and the other at most 1.


# %%
def soft_plain(d1, d2, k):
    return -k * np.log(np.exp(-d1 / k) + np.exp(-d2 / k))


def soft_shifted(d1, d2, k):
    m = np.minimum(d1, d2)
    return m - k * np.log(np.exp(-(d1 - m) / k) + np.exp(-(d2 - m) / k))


d1 = np.linspace(-20, 20, 4001, dtype=np.float32)
d2 = d1 + np.float32(0.01)
for form in (soft_plain, soft_shifted):
    with np.errstate(all="ignore"):
        result = form(d1, d2, np.float32(0.1))
    print(f"{form.__name__:12s}: {np.mean(~np.isfinite(result)):.0%} of the results are no finite numbers, k = 0.1, float32")

# %% [markdown]
# The quadratic form of the table above has no such trouble: it uses no exponential, and is the plain minimum wherever
# the two differ by more than $k$.
#
# ## Exercises
#
# **1.** How much does the smooth union rise at most over the plain one, and where? Why is this a good way to *define*
# what $k$ means?
#
# <details><summary>Answer</summary>
#
# The square is largest where $d_1 = d_2$: the union is lowered by $k^2/(4k) = k/4$ there, so the surface rises by
# $k/4$ at most where it is flat. Different authors write different factors into their smooth minimum. This number, or
# $\operatorname{smin}(a, a) = a - k/4$, tells them apart.
#
# </details>
#
# **2.** A box is all that is inside of six planes: $\max(\lvert x\rvert - h_x, \lvert y\rvert - h_y, \lvert z\rvert -
# h_z)$. Same shape, shorter code. What is different, and by how much at most?
#
# <details><summary>Answer</summary>
#
# The sign and the surface are right, and inside the values are, too. Outside, before an edge or a corner, it gives
# the distance to the furthest *plane* instead of the way to the edge. It is a bound, too small by a factor of up to
# $\sqrt 2$ before an edge and $\sqrt 3$ before a corner. A march arrives with more steps. But whoever takes the value
# for a distance is misled: thickened by subtracting $r$, this box keeps sharp corners, the exact one gets round ones.
#
# </details>
#
# **3.** The union's field is exact outside. What about a subtraction, $\max(d_1, -d_2)$? Where is it too small, and
# why does the march survive that?
#
# <details><summary>Answer</summary>
#
# Before the hole, $d_1$ is the distance to a surface that has been cut away, and $-d_2$ that to the bowl continued
# through the air. The true distance is the one to the rim, which is longer. The field is a bound: too small, never
# too large. A march takes more steps there, and goes through nothing.
#
# </details>

# %%
rise = smooth_union(np.zeros(1), np.zeros(1), 0.4)[0]
print(f"1. smooth union of two distances of 0 with k = 0.4: {rise:.3f}, and −k / 4 = {-0.4 / 4:.3f}")

around = rng.uniform(-3, 3, (200_000, 3))
true = box(around, (0, 0, 0), (1, 1, 1))
planes = (np.abs(around) - 1).max(axis=1)
print(f"2. six planes: inside the largest difference is {np.abs(planes - true)[true < 0].max():.0e}, "
      f"outside the distance is up to {np.max((true / planes)[planes > 0.01]):.2f} times the value")  # fmt: skip

above = np.stack([np.zeros(200), np.linspace(1.0, 3.0, 200), np.zeros(200)], axis=-1)  # over a bowl of radius 0.5 in the top
carved = np.maximum(box(above, (0, 0, 0), (1, 1, 1)), -sphere(above, (0, 1, 0), 0.5))
rim = np.hypot(0.5, above[:, 1] - 1)
worst = np.argmax(rim / carved)
print(f"3. over the bowl, {above[worst, 1] - 1:.2f} above the rim: value {carved[worst]:.2f}, distance {rim[worst]:.2f}")

# %% [markdown]
# ## From the lecture
#
# *Signed distances say on which side of the surface a point lies, and any two of them can be blended.* You have seen
# both, and what the lecture leaves out: what remains true of the result. The zero set is a shape in any case, and the
# value is a safe distance as long as the field is 1-Lipschitz. That is all the next walkthrough needs.
#
# ## Where to read on
#
# - John C. Hart, *Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces*, The Visual
#   Computer 12, 1996: Lipschitz bounds of primitives and operators.
# - Inigo Quilez, *Distance functions* and *Smooth minimum*, iquilezles.org: formulas for dozens of primitives, and a
#   family of smooth minima compared.
# - Sarah Frisken, Ronald Perry, Alyn Rockwood, Thouis Jones, *Adaptively sampled distance fields: a general
#   representation of shape for computer graphics*, SIGGRAPH 2000: distances stored where they matter.
# - Chris Green, *Improved alpha-tested magnification for vector textures and special effects*, SIGGRAPH course, 2007:
#   the lecture's moving edge at work, in letters that stay sharp.
# - Csaba Bálint, Gábor Valasek, Lajos Gergó, *Operations on signed distance functions*, Acta Cybernetica 24, 2019:
#   which operations keep which bound.
