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
# # 3 · Safe angles and soft shadows
#
# ## The question
#
# A lamp has a size. Close behind a post its shadow has a sharp edge, further away a blurred one. A point in the blur
# sees a *part* of the lamp. **How large a part, and can a single ray find out?**
#
# Words that we need:
#
# - The **shading point** $o$ is where we want to know how much light arrives.
# - The **light** here is a disc, far away, seen from $o$ in the direction $l$ (a unit vector to its centre). Its
#   **angular radius** $\theta_L$ is half the angle under which it is seen.
# - The **visibility** $v$ is the part of that disc which nothing hides: 0 is the full shadow (the **umbra**), 1 is none,
#   and all that is between is the half shade, the **penumbra**.
# - A **signed distance field** $f$ gives for any point of space how far the nearest surface is, negative inside of
#   objects ([walkthrough 1](01_distance_functions.ipynb)). So the ball of radius $f(p)$ about $p$ is empty, and a ray may
#   walk by $f(p)$ without meeting anything: that is **sphere tracing** ([walkthrough 2](02_sphere_tracing.ipynb)).

# %%
import numpy as np

import framework as fw
from framework import colors
from solutions.daylight import FLOOR, TO_SUN, daylight, part_colors
from solutions.truth_visibility import Solids

# %% [markdown]
# ## The idea
#
# March from $o$ towards the light. At the distance $t$ along the ray the field says $h = f(o + t\,l)$: a ball of radius
# $h$ is empty. Seen from $o$, this ball fills a cone about the ray. Its outermost rays touch the ball, and a tangent
# stands at a right angle on the radius, so that $h = t \sin\theta$. The half angle of the cone,
#
# $$\theta = \arcsin \frac{h}{t},$$
#
# is the **safe angle**: as far as this one ball can tell, nothing stands within $\theta$ of the ray. What counts is the
# narrowest place of the whole march, the *smallest* angle. A large one leaves the whole disc free, 0 means that the ray
# touches something. Between them the simplest guess is the quotient $\theta / \theta_L$, cut off at 1.
#
# For small angles the sine is nearly the angle, and the arcsine can go. What is left is the lecture's formula:
#
# $$v \approx \min_t\ \min\left\{\frac{k\,h}{t},\ 1\right\}, \qquad \sin\theta_L = \frac{1}{k} .$$
#
# So **$k$ is no mere knob for softness: it is one over the sine of the light's angular radius.** A large $k$ is a small
# light and a hard shadow.

# %% [markdown]
# ## The code
#
# It is a march that keeps a minimum. `evaluations` counts how many points were handed to the field, which is what a march
# costs on any machine.


# %%
def soft_shadow(sdf, origin, to_light, k, t_min=0.02, t_max=8.0, max_steps=128):
    """Visibility (N,) from the smallest k h / t of one ray each, and the evaluations (N,) that it took."""
    visible, evaluations = np.ones(len(origin), origin.dtype), np.zeros(len(origin), int)
    t = np.full(len(origin), t_min, origin.dtype)
    marching = np.arange(len(origin))
    for _ in range(max_steps):
        h = sdf(origin[marching] + t[marching, None] * to_light)
        evaluations[marching] += 1
        blocked = h < 1e-4
        ratio = np.where(blocked, 0, k * h / t[marching])
        visible[marching] = np.minimum(visible[marching], ratio)
        t[marching] += h
        marching = marching[~blocked & (t[marching] <= t_max)]
        if not marching.size:
            break
    return visible, evaluations


# %% [markdown]
# One ray in a plane, past a ball. Each circle is empty space that a step relied on; its two tangents from $o$ enclose
# twice the safe angle. The narrowest place is drawn in orange.

# %%
center, radius = np.array([1.0, 2.2]), 0.6
t, visited = 0.3, []
while t < 5:
    h = np.hypot(*(np.array([0, t]) - center)) - radius
    visited.append((np.arcsin(min(h / t, 1)), t, h))
    t += h
theta, t_narrow, h_narrow = min(visited)

with fw.show.plot("x, scene units", "height above o, scene units", "Empty balls along one ray", width=4.4, height=5.4,
                  caption=f"The smallest safe angle is {np.degrees(theta):.1f}°, at t = {t_narrow:.2f} with "
                          f"h = {h_narrow:.2f}. After {len(visited)} steps the ray has passed.") as axes:
    turn = np.linspace(0, 2 * np.pi, 200)
    axes.fill(center[0] + radius * np.cos(turn), center[1] + radius * np.sin(turn), color="0.78")
    for angle, t, h in visited:
        color, width = ("#d1622b", 1.8) if angle == theta else ("#2f6db5", 0.8)
        axes.plot(h * np.cos(turn), t + h * np.sin(turn), color=color, linewidth=width)
        reach = np.sqrt(max(t * t - h * h, 0))
        for side in (-1, 1):
            axes.plot([0, side * reach * np.sin(angle)], [0, reach * np.cos(angle)], color=color, linewidth=width)
    axes.plot([0, 0], [0, 5], color="0.2", linestyle="--", linewidth=0.8)
    axes.set(xlim=(-2, 2), ylim=(0, 4.9), aspect="equal")

# %% [markdown]
# How much did we lose with the arcsine? Print it for three angles. And what lights do the lecture's three $k$ stand for?

# %%
for degrees in (10, 30, 90):
    angle = np.radians(degrees)
    print(f"at {degrees:2d}° the angle is {angle / np.sin(angle) - 1:6.1%} larger than its sine")
for k in (2, 8, 32, 215):
    print(f"k = {k:3d}: a light of {np.degrees(np.arcsin(1 / k)):5.2f}° angular radius")

# %% [markdown]
# The first is a window close by, the second a shaded lamp, the third a bare bulb across the room, and the last is the
# sun. Only for the window could one see which of the two formulas was used.
#
# ## The picture
#
# A ring, a ball and a box over a floor. The compiled engine in `solutions.fast` does for each pixel what the code above
# does. Look at the box: where it stands on the floor, its shadow is sharp for every $k$, since there $t$ is small and
# $k h / t$ comes to 1 quickly. The ring hangs in the air, and its shadow is soft all over.
#
# In a live notebook, drag the slider.

# %%
ball, ring = fw.sdf.sphere((-1.1, 0.6, 0.3), 0.5), fw.sdf.torus((-0.1, 0.9, -0.8), 0.5, 0.14)
box, floor = fw.sdf.box((0.6, 0.6, 0.8), (0.25, 0.6, 0.25)), fw.sdf.plane((0, 1, 0), 0.0)
scene = fw.sdf.union(floor, ball, ring, box)
camera = fw.Camera((2.6, 3.4, 4.4), (0.15, 0.3, 0.15), (0, 1, 0), 0.55)
paint = part_colors([floor, ball, ring, box], [FLOOR, (0.2, 0.4, 0.65), (0.75, 0.35, 0.2), (0.75, 0.62, 0.3)], camera, 256)


def shadows(k):
    return daylight(scene, camera, 256, k, paint)


fw.interact(shadows, k=np.geomspace(2, 32, 33), title="One ray a pixel, lights of three sizes");

# %% [markdown]
# ## Run time against error
#
# A guess should be measured. The truth is easy to get, only slow: send many rays from $o$ to points that are spread
# evenly over the disc, and count how many arrive. Balls and boxes are hit in closed form, so this truth has no march in it.
# Light comes from straight above here, a ball hangs over the floor, and we walk on the floor from the middle of its shadow
# outwards.


# %%
def disc(to_light, angular_radius, count):
    """Directions (count, 3) spread evenly over a round light: a spiral by the golden angle."""
    i = np.arange(count)
    r, phi = np.tan(angular_radius) * np.sqrt((i + 0.5) / count), i * np.pi * (3 - np.sqrt(5))
    tangent, bitangent = fw.orthonormal_frame(to_light)[:2]
    return fw.normalize(to_light + (r * np.cos(phi))[:, None] * tangent + (r * np.sin(phi))[:, None] * bitangent)


def truth(solids, points, to_light, angular_radius, count=1024):
    rays = disc(to_light, angular_radius, count)
    return np.array([1 - solids.blocked(p, rays, 8.0).mean() for p in points])


up, k = np.array([0.0, 1.0, 0.0]), 5
one_ball = Solids(spheres=(((0, 1.6, 0), 0.8),), ground=None)  # the floor is where we stand, it hides nothing
x = np.linspace(0, 1.6, 161)
line = x[:, None] * [1.0, 0.0, 0.0]
wanted = truth(one_ball, line, up, np.arcsin(1 / k))
ratio, _ = soft_shadow(one_ball.sdf(), line, up, k)

# %% [markdown]
# The formula says 0 wherever the ray is blocked, and half of the disc may be free there. How could it know better? The
# march stopped at the surface. But distances have a sign: let it **go on inside**, and keep the smallest *signed* angle. In
# units of the light's radius, $x = \theta/\theta_L$, the object's edge crosses the disc at $x$ radii from its middle. Take
# that edge for a straight line, and the free part of the disc is a segment of a circle, whose share is
#
# $$v(x) = \frac12 + \frac{x\sqrt{1-x^2} + \arcsin x}{\pi}, \qquad -1 \le x \le 1 .$$
#
# Inside, $\lvert h\rvert$ is as safe a step as outside. At the surface it is 0, so a step is at least a quarter of the light's
# radius there, $\theta_L\,t/4$, or the march would stand still.


# %%
def signed_shadow(sdf, origin, to_light, k, t_min=0.02, t_max=8.0, max_steps=128):
    """Visibility (N,) from the smallest signed angle of a march that goes on inside, and the evaluations (N,)."""
    radius = np.arcsin(1 / k)
    x, evaluations = np.ones(len(origin)), np.zeros(len(origin), int)
    t = np.full(len(origin), t_min)
    marching = np.arange(len(origin))
    for _ in range(max_steps):
        h = sdf(origin[marching] + t[marching, None] * to_light)
        evaluations[marching] += 1
        x[marching] = np.minimum(x[marching], np.arcsin(np.clip(h / t[marching], -1, 1)) / radius)
        t[marching] += np.maximum(np.abs(h), 0.25 * radius * t[marching])
        marching = marching[(x[marching] > -1) & (t[marching] <= t_max)]
        if not marching.size:
            break
    x = np.clip(x, -1, 1)
    return 0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi, evaluations


signed, _ = signed_shadow(one_ball.sdf(), line, up, k)
partly = (wanted > 0.02) & (wanted < 0.98)
edge = np.argmin(np.abs(x - 0.8))
said = (f"Light of k = {k}. Under the ball's edge, at 0.8, the truth is {wanted[edge]:.2f}, the ratio says {ratio[edge]:.2f}, "
        f"the signed angle {signed[edge]:.2f}. Mean error over the half shade: {np.abs(ratio - wanted)[partly].mean():.2f} "
        f"and {np.abs(signed - wanted)[partly].mean():.3f}.")
with fw.show.plot("distance from the middle of the shadow, scene units", "visible part of the light, 0 to 1",
                  "A ball's shadow, seen in section", said) as axes:
    axes.plot(x, wanted, color="0.1", linewidth=2.2, label="truth: 1024 rays a point")
    axes.plot(x, ratio, color="#d1622b", label="smallest k h / t")
    axes.plot(x, signed, color="#2f6db5", linestyle="--", label="smallest signed angle")
    axes.axvline(0.8, color="0.6", linewidth=0.8, linestyle=":")

# %% [markdown]
# The shape is right, but the lecture's shadow is too dark and too wide: it uses only the outer half of the half shade.
# That is no slip in the code. No $k$ can mend it, since any multiple of 0 is 0.
#
# Now the question behind all real-time rendering: what is the least error for the time that we have? Below, each method
# runs on a piece of floor with a ball and a box above, with a growing budget: steps of the march, or rays to the disc.
# **Change the light's `radius` in the first line, from 0.03 to 0.5 radians, and run the cell again.** Who wins for a small
# light, who for a large one?

# %%
radius, budgets, rays = 0.12, (4, 8, 16, 32, 64), (4, 16, 64)

solids = Solids(spheres=(((-0.9, 0.8, 0.0), 0.45),), boxes=(((0.9, 0.6, 0.0), (0.3, 0.6, 0.3)),), ground=None)
field, to_light, wide = solids.sdf(), fw.normalize([0.5, 1.0, 0.3]), 1 / np.sin(radius)
side_x, side_z = np.meshgrid(np.linspace(-2.6, 1.8, 48), np.linspace(-1.6, 1.2, 48))
floor_points = np.stack([side_x, np.full_like(side_x, 1e-4), side_z], axis=-1).reshape(-1, 3)
wanted_floor = truth(solids, floor_points, to_light, radius)


def hard_rays(count):
    """The mean over rays to the disc, each marched through the same field: 1 where it gets through."""
    hits = [soft_shadow(field, floor_points, ray, 1e9)[0] for ray in disc(to_light, radius, count)]
    return np.mean(hits, axis=0)


points = fw.plane.measure(
    {
        "smallest k h / t": {
            f"{n} steps": lambda n=n: soft_shadow(field, floor_points, to_light, wide, max_steps=n)[0] for n in budgets
        },
        "smallest signed angle": {
            f"{n} steps": lambda n=n: signed_shadow(field, floor_points, to_light, wide, max_steps=n)[0] for n in budgets
        },
        "rays to the disc": {f"{n} rays": lambda n=n: hard_rays(n) for n in rays},
    },
    error=lambda visible: fw.metrics.rmse(visible, wanted_floor),
    repeats=3,
)
fw.plane.show(points, "RMS error of the visibility, 0 to 1", f"Shadows of a light of {np.degrees(radius):.1f}° radius")

# %%
best = {method: min((p for p in points if p.method == method), key=lambda p: p.error) for method in
        ("smallest k h / t", "smallest signed angle", "rays to the disc")}  # fmt: skip
for p in best.values():
    print(f"{p.method}, at its best with {p.setting}: error {p.error:.3f} in {p.milliseconds:.0f} ms")
ratio_best, signed_best, rays_best = best.values()
print(f"One ray that goes on inside is {ratio_best.error / signed_best.error:.1f} times as accurate as one that stops,")
print(f"and takes {rays_best.milliseconds / signed_best.milliseconds:.0f} times less time than {rays_best.setting}.")

# %% [markdown]
# Both one-ray methods come to a floor that no further step lowers: what is left is the error of the *idea*, not of the
# march. The ratio even gets a little worse with more steps: they find narrower places, and darken what is too dark already.
# Only rays get ever closer to the truth, at a price that real time cannot pay.
#
# And where does the march spend its steps? Rays that graze an object take short steps along it.

# %%
near_x, near_z = np.meshgrid(np.linspace(-2.6, 1.8, 220), np.linspace(-1.9, 1.5, 170))
from_above = np.stack([near_x, np.full_like(near_x, 1e-4), near_z], axis=-1).reshape(-1, 3)
_, evaluations = soft_shadow(field, from_above, to_light, wide)
drawn = np.minimum(evaluations, 40).reshape(170, 220)
fw.show.march_heat_map(drawn, "One shadow ray a pixel: floor of 4.4 × 3.4 units, from above")
print(f"{np.mean(evaluations > 40):.2%} of the rays take more than 40 evaluations, up to {evaluations.max()}; drawn as 40")

# %% [markdown]
# ## What goes wrong, and the cure
#
# ### 1. A march that starts on the surface
#
# At $t = 0$ the point's own surface is the nearest: $h = 0$, the ray counts as blocked, and $h/t$ is $0/0$. Here are ten
# thousand points on top of a box, under a light that nothing hides, for three ways to start.

# %%
rng = np.random.default_rng(3)
top = np.stack([rng.uniform(-1, 1, 10_000), np.full(10_000, 0.6), rng.uniform(-1, 1, 10_000)], axis=-1)
slab = fw.sdf.box((0, 0, 0), (1.2, 0.6, 1.2))
sun = fw.normalize(TO_SUN)
for name, start, t_min in (
    ("on the surface, t from 1e-9", top, 1e-9),
    ("on the surface, t from 0.02", top, 0.02),
    ("lifted by 0.005 along the normal, t from 0.02", top + [0, 0.005, 0], 0.02),
):
    visible, _ = soft_shadow(slab, start, sun, 8, t_min=t_min)
    print(f"{np.mean(visible < 1):7.2%} of the points are wrongly in shadow: {name}")

# %% [markdown]
# **The cure** is to begin a little off: at $t_{min}$ along the ray, or lifted along the normal, by a few times what the hit
# point itself may be wrong. Too large a lift, and shadows no longer reach the foot of what casts them.
#
# ### 2. Bands: the narrowest place lies between two steps
#
# The formula wants the smallest $h/t$ of *all* points of the ray, the march visits only some. From one shading point to
# the next these wander, and the narrowest place is now met, now missed: the shadow shows bands. Compare with a march of
# tiny steps, which misses nothing, and with two cures. **Shorter steps**: never more than a part of $t$. **Triangulation**
# (Aaltonen 2018): two balls in a row touch something at most where their surfaces cross; with the last radius $h'$ that place
# is $y = h^2/(2h')$ before the new centre, and $\sqrt{h^2 - y^2}$ off the ray.


# %%
def closest(sdf, origin, to_light, k, limit=np.inf, triangulate=False, t_max=8.0):
    """As soft_shadow, with steps of at most `limit` t, or with the place where two balls cross."""
    visible, count = np.ones(len(origin)), 0
    t, before, marching = np.full(len(origin), 0.02), np.full(len(origin), np.inf), np.arange(len(origin))
    while marching.size:
        here = t[marching]
        h = sdf(origin[marching] + here[:, None] * to_light)
        count += len(marching)
        y = h * h / (2 * before[marching]) if triangulate else np.zeros_like(h)
        off, along = np.sqrt(np.maximum(h * h - y * y, 0)), np.maximum(here - y, 1e-6)
        visible[marching] = np.where(h < 1e-4, 0, np.minimum(visible[marching], k * off / along))
        before[marching] = h
        t[marching] = here + np.minimum(h, limit * here)
        marching = marching[(h >= 1e-4) & (t[marching] <= t_max)]
    return visible, count / len(origin)


corner = fw.sdf.box((0.0, 1.0, 0.0), (0.5, 1.0, 0.5))
size = 160
floor_x, floor_z = np.meshgrid(np.linspace(-0.2, 2.2, size), np.linspace(-1.6, 0.8, size))
patch = np.stack([floor_x, np.full_like(floor_x, 1e-4), floor_z], axis=-1).reshape(-1, 3)
ways = {
    "all of the ray": dict(limit=0.01),
    "plain steps": dict(),
    "steps up to t / 10": dict(limit=0.1),
    "triangulated": dict(triangulate=True),
}
found = {name: closest(corner, patch, sun, 4, **way) for name, way in ways.items()}
dense = found["all of the ray"][0]
fw.show.strip([np.repeat(visible.reshape(size, size, 1), 3, axis=2) for visible, _ in found.values()], list(found),
              "The shadow of a tall box, k = 4",
              "The floor from above, 2.4 × 2.4 units; white: all of the light is seen, black: none.")
off = [(visible - dense).reshape(size, size) for visible, _ in found.values()]
off = [colors.from_table(error, -0.05, 0.05, colors.SIGNED_ERROR) for error in off]
fw.show.strip(off, list(found), "The same, less what all of the ray would give",
              "Dark green: too bright by 0.05 or more; dark purple: too dark by as much; white: the same.")
for name, (visible, count) in found.items():
    error = visible - dense
    print(f"{name:18s}: {count:6.1f} evaluations a ray; off by {error.min():+.3f} to {error.max():+.3f}")

# %% [markdown]
# Plain steps are too bright where they are wrong, for a march can only miss a narrow place. What they miss comes in stripes,
# and an eye finds a stripe of a few percent where it would not notice a slow change. Short steps make the stripes finer, and
# cost more the finer they are. Triangulation costs no evaluation. It takes the worst that the two balls *allow*, and is a
# little too dark nearly everywhere: one smooth error in place of most of the stripes.
#
# ### 3. float32, far from the origin
#
# Graphics hardware computes in float32, with 24 bits for a number's digits. A point on the ray is $o + t\,l$, and far from
# the origin its digits are used up by where it *is*; what is left for the distance is soon coarser than the hit threshold
# of $10^{-4}$. We carry the ball and the floor away from the origin, and compute the very same shadow in float32. (The
# surface of the Earth is $6 \times 10^6$ m from its middle.) **The cure** is to move the origin instead: subtract the place of
# the scene from everything once, in float64, before the march.

# %%
size, away = 160, (0.0, 1e4, 1e6)
near = np.linspace(-1.2, 1.2, size)
local = np.stack([*np.meshgrid(near, near), np.zeros((size, size))], axis=-1)[..., [0, 2, 1]].reshape(-1, 3)
exact, _ = soft_shadow(fw.sdf.sphere((0, 0.9, 0), 0.5), local, up, 4)


def in_float32(points, center):
    def ball(p):
        return np.sqrt(np.sum((p - np.float32(center)) ** 2, axis=-1)) - np.float32(0.5)

    return soft_shadow(ball, points.astype(np.float32), up.astype(np.float32), np.float32(4))[0]


pictures, names = [], []
for distance in away:
    print(f"{distance:9,.0f} units away, neighbours in float32 are {np.spacing(np.float32(distance + 1)):.1g} apart")
    shift = np.array([distance, 0, distance])
    center = np.array([0, 0.9, 0]) + shift
    for name, origin in (("as it is", 0), ("moved to the origin", shift)):
        visible = in_float32(local + shift - origin, center - origin)
        print(f"          {name:20s}: largest error of the visibility {np.abs(visible - exact).max():.5f}")
        if distance:
            pictures.append(np.repeat(np.float64(visible).reshape(size, size, 1), 3, axis=2))
            names.append(f"{distance:,.0f} away" if name == "as it is" else "the same, moved")
fw.show.strip(pictures, names, "One shadow in float32, two distances from the origin",
              "The floor from above, 2.4 × 2.4 units; white: all of the light is seen, black: none. k = 4.");

# %% [markdown]
# ## Exercises
#
# **1.** The edge of a roof is 10 m above the ground, and the sun stands straight above it. How wide is the half shade? And
# how wide does the lecture's formula make it?
#
# <details><summary>Answer</summary>
#
# On the ground, at a distance $s$ from the point under the edge, the ray to the sun's middle passes the edge at
# $h = s$, $t = 10$ m. A part of the sun is hidden while $\lvert s\rvert < t\tan\theta_L$: the half shade is
# $2\,t\tan\theta_L$ wide, on both sides of the edge. The formula reaches 1 at $h = t/k$, and is 0 from the edge inwards: it
# draws the outer half only. The cell below has the numbers.
#
# </details>
#
# **2.** Two walls stand left and right of the ray to the light's middle, each at half of the light's radius from it:
# $x = 0.5$ for both. What do the formula and the signed angle say, and what is true?
#
# <details><summary>Answer</summary>
#
# Both keep *one* smallest value, and never learn that there is a second wall. The ratio says 0.5, the signed angle $v(0.5)$,
# the share of the disc beyond one wall. Each wall hides $1 - v(0.5)$ of the disc, and they hide different parts: true is
# $1 - 2(1 - v(0.5)) = 2v(0.5) - 1$. The signed angle is too bright by the other wall's part. Shadows add, a minimum does
# not. (That the ratio comes out nearer is luck: its two errors have opposite signs here.)
#
# </details>
#
# **3.** The light stands 20° above an empty floor, and $k = 2$. What visibility does the formula give the floor, with
# nothing there to cast a shadow? Is it a fault?
#
# <details><summary>Answer</summary>
#
# The floor itself is the nearest surface of every point of the ray: $h = t \sin 20°$, so that $k h/t = k\sin 20°$ for
# all $t$, which is below 1. The floor darkens itself. But look at the light: its radius is 30°, it stands only 20° above
# the horizon, and a part of it is really below. With $x = 20/30$ the true share is $v(x)$. The formula is right to darken,
# and too dark. As long as $k\,(n \cdot l) \ge 1$, with the floor's normal $n$, nothing of the kind happens, and an engine
# may leave the floor out of its own shadow.
#
# </details>

# %%
def share(x):
    return 0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi


sun_radius = np.arcsin(1 / 215)
print(f"1. half shade of the roof: {200 * 10 * np.tan(sun_radius):.1f} cm, {100 * 10 / 215:.1f} cm by the formula")
print(f"2. two walls: ratio 0.50, signed angle {share(0.5):.3f}, true {2 * share(0.5) - 1:.3f}")
print(f"3. low light: formula {2 * np.sin(np.radians(20)):.3f}, true {share(20 / 30):.3f}")

# %% [markdown]
# ## From the lecture
#
# Its conclusion on distance fields: *fast, of high quality, but large to store, slow to build, and built anew when something
# moves.* The first two you have measured above. For the third, our scene was formulas, a few numbers each; a modelled
# object has no formula, and engines store its field on a grid.

# %%
for n in (64, 128, 256):
    print(f"{n:3d} values along each side, 4 bytes each: {4 * n**3 / 2**20:5.1f} MiB; in a 5 m room, {500 / n:.1f} cm a cell")
print(f"a shadow map of 1024 × 1024 depths: {4 * 1024**2 / 2**20:.1f} MiB")

# %% [markdown]
# Twice the resolution is eight times the memory, and a wall thinner than a cell is lost. A shadow map of twice the resolution
# takes four times as much, and is drawn anew in each frame anyway. Against that, *an object that moves as a whole keeps its
# field*: turn the query point into its frame, $f(R^{-1}(p - c))$, with its rotation $R$ and place $c$. Only what bends
# needs a new one.
# [Walkthrough 4](04_distance_grids.ipynb) measures all of this, with bricks near the surface that save most of the memory.
#
# ## Where to read on
#
# - Inigo Quilez, *Free penumbra shadows for raymarching distance fields*, iquilezles.org, 2010, with later additions: where
#   $k h/t$ comes from, and a march through the inside.
# - John C. Hart, *Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces*, The Visual
#   Computer 12, 1996: the march.
# - Sebastian Aaltonen, *GPU-based clay simulation and ray-tracing tech in Claybook*, Game Developers Conference, 2018: the
#   triangulation, and a game that lives in one distance field.
# - Daniel Wright, *Dynamic occlusion with signed distance fields*, SIGGRAPH course Advances in Real-Time Rendering in
#   Games, 2015: cones through fields of whole scenes, in an engine.
# - Lingqi Yan, *GAMES202: real-time high quality rendering*, lecture 5, 2021: the lecture.
