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
from solutions.daylight import FLOOR, daylight, part_colors

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
