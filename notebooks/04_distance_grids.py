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
# # 4 · What a distance field costs to store
#
# ## The question
#
# Balls and boxes have formulas for their distance. A teapot has none: it is a mesh of triangles, and its distance must be
# computed beforehand and stored. The lecture says of such fields: soft shadows from them are fast and good, *if one leaves
# out the time to make them*; they take much memory; and when something moves, they must be made again. **How much memory,
# how much time, and is it worth that, compared with a shadow map?**
#
# Words that we need:
#
# - A **grid** stores the distance $f$ at the corners of cubic **cells** with the side $h$. Between them it is
#   **interpolated**: the eight corners of a cell are averaged with weights that are linear along each axis.
# - The **resolution** is the number of cells along the object's longest side. A **dense** grid stores all of them; a
#   **sparse** one only small cubes of them, **bricks**, near the surface, and a coarse grid for the rest.
# - A stored distance is **conservative** if it is never larger than the true one. Only then is sphere tracing safe
#   ([walkthrough 2](02_sphere_tracing.ipynb)).
# - A **shadow map** is a picture taken from the light that keeps depths instead of colours. A point that is deeper than
#   what the map keeps in its direction is in shadow.

# %%
import time
import warnings
from pathlib import Path

import numpy as np

import framework as fw
from framework import colors
from solutions.soft_shadows import area_light_shadow
from solutions.truth_rays import visible_fraction

# %% [markdown]
# ## The idea
#
# **Error.** Along a line a smooth function and its linear interpolation differ by at most $\tfrac18 h^2 |f''|$, and the
# second derivative of a distance is the surface's curvature $\kappa$. So halving the cells should make the error four
# times smaller, as long as the surface is round. At an edge $f$ has a kink: there the error only halves.
#
# **Memory.** A dense grid of resolution $n$ has about $n^3$ samples. A surface crosses about $n^2$ cells, so a sparse grid
# grows like $n^2$.
#
# **Safety.** Interpolated values may be too *large* by the error. A conservative grid stores beside each sample how wrong
# the values around it can be, and takes that off.
#
# ## The code
#
# A dense grid of a function, and its interpolation:

# %%
def dense_grid(sdf, low, high, cells):
    """Samples (n, n, n) of a distance at the corners of cells between two corners of a cube."""
    axis = np.linspace(low, high, cells + 1)
    p = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    return sdf(p.reshape(-1, 3)).reshape(p.shape[:-1])


def interpolated(samples, low, high, p):
    """Values (N,) of the grid at points (N, 3) inside of it."""
    cells = len(samples) - 1
    u = (p - low) * cells / (high - low)
    corner = np.clip(u.astype(int), 0, cells - 1)
    u, total = u - corner, 0.0
    for offset in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(offset, u, 1 - u), axis=1)
        total = total + weight * samples[tuple((corner + offset).T)]
    return total


ring, cube = fw.sdf.torus((0, 0, 0), 0.6, 0.25), fw.sdf.box((0, 0, 0), (0.6, 0.4, 0.5))
rng = np.random.default_rng(2)
points = rng.uniform(-0.95, 0.95, (200_000, 3))
sizes = (8, 16, 32, 64, 128)
with fw.show.plot("cells along a side", "largest error within 0.05 of the surface, scene units",
                  "Interpolated distances of a ring and a cube") as axes:
    for name, solid, color in (("ring: round", ring, "#2f6db5"), ("cube: edges", cube, "#d1622b")):
        exact = solid(points)
        near = points[np.abs(exact) < 0.05]
        errors = [np.abs(interpolated(dense_grid(solid, -1, 1, n), -1, 1, near) - solid(near)).max() for n in sizes]
        axes.loglog(sizes, errors, "o-", color=color, label=name)
        power = np.log(errors[-1] / errors[1]) / np.log(sizes[-1] / sizes[1])
        print(f"{name}: error {errors[-1]:.1e} at {sizes[-1]} cells; it falls with the power {power:.2f} of the cells")

# %% [markdown]
# As promised: about the power $-2$ where the surface is round, $-1$ where it has edges.
#
# ## The picture
#
# For a mesh the true distance is that to the nearest triangle; `fw.sdf.from_mesh` finds it through a tree of boxes,
# decides inside and outside by how often the mesh winds around the point, and stores bricks. Here is a bumpy ball of
# 20 000 triangles, cut through. Orange is outside, blue is inside, the thin lines are 0.1 apart. Between the two dark
# lines the value is 0: there a grid that never promises too much cannot say on which side a point is. With more cells
# they close in on the surface; further out the coarse grid shows as kinks in the lines. Drag the resolution, or the
# cut's height.

# %%
bumpy = fw.mesh.bumpy_sphere(20_000, amplitude=0.12, frequency=7.0)
cells = (6, 8, 12, 16, 24, 32, 48, 64)
grids = {n: fw.sdf.from_mesh(bumpy, n) for n in cells}
x, z = np.meshgrid(np.linspace(-1.4, 1.4, 256), np.linspace(-1.4, 1.4, 256))


def cut(cells, height):
    p = np.stack([x, np.full_like(x, height), z], axis=-1).reshape(-1, 3)
    return colors.from_distance(grids[cells](p).reshape(x.shape), 0.6, 0.1)


fw.interact(cut, cells=cells, height=np.linspace(-1.0, 1.0, 41), title="A bumpy ball as a grid; 2.8 scene units across")

print("cells    dense bytes   sparse bytes   largest error   of the radius")
for n in cells[2:]:
    grid = grids[n]
    dense = 4 * int(np.prod(np.ceil(np.ptp(bumpy.vertices, axis=0) / grid.cell) + 1))
    print(f"{n:5d}  {dense:13,d}  {grid.nbytes:13,d}  {grid.error:14.4f}  {grid.error:14.1%}")

# %% [markdown]
# At low resolutions the bricks are *larger* than the dense grid, since each carries its margins and the band around the
# surface is as wide as the object. It is growth that counts: the dense grid grows with the third power.

# %%
fine = {n: fw.sdf.from_mesh(bumpy, n).nbytes for n in (32, 64, 128)}
for n in (64, 128):
    print(f"from {n // 2} to {n} cells: dense 8.0 times the bytes, sparse {fine[n] / fine[n // 2]:.1f} times; "
          f"{fine[n] / 2**20:.0f} MiB against {4 * (n + 1) ** 3 / 2**20:.0f} MiB")

# %% [markdown]
# ## Run time against error
#
# Now the lecture's claim: is it faster than a shadow map? A ball and a box over a floor, under a round lamp with an
# angular radius of 11.5°. First three ways to use a shadow map:
#
# - **One look-up**: in shadow or not. Hard edges.
# - **PCF** (*percentage closer filtering*): the share of 32 look-ups, within a fixed disc, that are lit. Soft everywhere.
# - **PCSS** (*percentage closer soft shadows*): first look for the mean depth of what is in the way, the **blocker**. The
#   half shade is as wide as $w = 2 \tan\theta_L\, (d - d_\text{blocker})$ for a lamp far away; then PCF with that width.
#
# Beside the look-up's own pixel a slanted surface is nearer to the light than the point itself, so the comparison allows
# for a slope of 45°.

# %%
sun, theta = fw.normalize(np.array([0.5, 1.0, 0.35])), np.arcsin(0.2)
AWAY, REACH = 60.0, 4.0  # the light's camera, and the half width of what it sees, scene units


def draw_map(mesh, size):
    camera = fw.Camera(AWAY * sun, (0, 0, 0), (0, 1, 0), 2 * np.arctan(REACH / AWAY))
    return fw.rasterize(mesh, camera, size, size, channels=("depth",)).depth, camera.view_projection(size, size)


DISC = np.sqrt((np.arange(32) + 0.5) / 32)[:, None] * np.stack(
    [np.cos(np.arange(32) * 2.39996), np.sin(np.arange(32) * 2.39996)], axis=1)


def map_shadow(shadow_map, p, way, bias):
    """Visibility (N,) by one look-up, by PCF with a fixed width, or by PCSS."""
    depths, matrix = shadow_map
    size = len(depths)
    clip = np.concatenate([p, np.ones((len(p), 1))], axis=1) @ matrix.T
    depth = clip[:, 3]
    pixel = 0.5 * size * (1 + clip[:, :2] / depth[:, None] * [1, -1])

    def look(radius, x, y):  # radius in scene units across the light
        at = np.floor(pixel + (0.5 * size / REACH) * np.multiply.outer(radius, [x, y])).astype(int)
        return depths[tuple(at.clip(0, size - 1).T[::-1])]

    if way == "one look-up":
        return (look(np.zeros(len(p)), 0, 0) > depth - bias) * 1.0
    if way == "PCF":
        radius = np.full(len(p), 0.16)
    else:
        blocked, total = np.zeros(len(p)), np.zeros(len(p))
        for x, y in DISC:
            seen = look(np.full(len(p), np.tan(theta)), x, y)
            blocks = seen < depth - bias - np.tan(theta) * np.hypot(x, y)
            blocked, total = blocked + blocks, total + np.where(blocks, seen, 0)
        mean_depth = np.where(blocked > 0, total / np.maximum(blocked, 1), depth)
        radius = np.tan(theta) * (depth - mean_depth)
    return sum(look(radius, x, y) > depth - bias - radius * np.hypot(x, y) for x, y in DISC) / len(DISC)


# %% [markdown]
# The points are those that a camera sees. The truth is 256 rays a point to the lamp's disc, cast in closed form.

# %%
solids = [
    {"sphere": {"center": [-0.8, 0.75, 0.1], "radius": 0.55}},
    {"box": {"center": [0.75, 0.5, -0.2], "half_size": [0.35, 0.5, 0.3]}},
    {"plane": {"normal": [0, 1, 0], "offset": 0}},
]
meshes = [fw.mesh.sphere(0.55, (-0.8, 0.75, 0.1), 32, 64), fw.mesh.box((0.35, 0.5, 0.3), (0.75, 0.5, -0.2))]
floor = fw.sdf.plane((0, 1, 0), 0.0)
formula = fw.sdf.union(fw.sdf.sphere((-0.8, 0.75, 0.1), 0.55), fw.sdf.box((0.75, 0.5, -0.2), (0.35, 0.5, 0.3)), floor)

camera = fw.Camera((-0.6, 3.4, 4.6), (-0.1, 0.4, -0.2), (0, 1, 0), 0.6)
origin, direction = (a.reshape(-1, 3) for a in camera.rays(112, 84))
t = np.zeros(len(origin))
for _ in range(160):
    t += formula(origin + t[:, None] * direction)
p = origin + t[:, None] * direction
normal = fw.normalize(np.stack([formula(p + s) - formula(p - s) for s in 1e-5 * np.eye(3)], axis=-1))
lit = (normal @ sun > 0) & (np.abs(p).max(axis=1) < 2.6)
p = p[lit] + 0.01 * normal[lit]
truth = visible_fraction(solids, p, sun, theta, 8.0, 256)
print(f"{len(p)} points; {np.mean((truth > 0) & (truth < 1)):.0%} of them in half shade")


def joined(parts):
    """One mesh of several."""
    first = np.cumsum([0] + [len(part.vertices) for part in parts[:-1]])
    faces = [part.faces + k for part, k in zip(parts, first, strict=True)]
    return fw.Mesh(np.concatenate([part.vertices for part in parts]), np.concatenate(faces))


everything = joined([*meshes, fw.mesh.plane(8.0)])


def by_grid(field):
    return area_light_shadow(field, p, sun, theta, 0.02, 8.0, 128)


def built(n):
    return fw.sdf.union(floor, *(fw.sdf.from_mesh(mesh, n) for mesh in meshes))


# %% [markdown]
# Change the sizes of maps and grids, and see where the front goes. Shadow maps are drawn anew each time; for the grids
# there is a version that is stored, and one that is built for each frame.

# %%
map_sizes, resolutions = (256, 1024), (16, 48)  # yours to change

methods = {
    way: {
        f"{s} pixels": lambda way=way, s=s: map_shadow(draw_map(everything, s), p, way, 0.02 + 2 * REACH / s)
        for s in map_sizes
    }
    for way in ("one look-up", "PCF", "PCSS")
}
stored = {n: built(n) for n in resolutions}
methods["grid, stored"] = {f"{n} cells": lambda n=n: by_grid(stored[n]) for n in resolutions}
methods["grid, built each time"] = {f"{n} cells": lambda n=n: by_grid(built(n)) for n in resolutions}
methods["formula"] = {"": lambda: by_grid(formula)}
measured = fw.plane.measure(methods, lambda seen: np.sqrt(np.mean((seen - truth) ** 2)), repeats=3)
fw.plane.show(measured, "RMS error of the visibility, 0 to 1", "A map drawn anew, or a grid")

# %% [markdown]
# The march here is plain NumPy, and the maps are drawn by the compiled rasteriser, so the times favour the maps. What the
# plane shows is independent of that: the map's error stays where its *method* is wrong (hard edges, one fixed width), and
# more pixels do not help; the signed angle is closer to the truth, and its grid soon as good as the formula. And the build
# costs as much as many frames of shadows by a map.

# %%
large = draw_map(everything, 1024)
pictures = {"truth, 256 rays": truth}
pictures |= {way: map_shadow(large, p, way, 0.03) for way in ("one look-up", "PCF", "PCSS")}
pictures |= {f"grid, {resolutions[-1]} cells": by_grid(stored[resolutions[-1]])}
shown = []
for seen in pictures.values():
    picture = np.zeros(112 * 84)
    picture[lit] = 0.05 + 0.85 * seen * (normal[lit] @ sun)
    grey = fw.tone_map(picture.reshape(84, 112)).repeat(2, axis=0).repeat(2, axis=1)
    shown.append(np.stack([grey] * 3, axis=-1))
fw.show.strip(shown[:3], list(pictures)[:3])
fw.show.strip(shown[3:], list(pictures)[3:], caption="Light that arrives: black none, white all. About 4 scene units across.");

# %% [markdown]
# ### Something moves
#
# Three ways when one object of a scene moves: build all again; build only the bricks that the move touched; or give each
# object its own grid and move the *query* instead, $f(p - \text{offset})$, which costs nothing.

# %%
balls = [fw.mesh.bumpy_sphere(8_000) for _ in range(4)]
corners = np.array([[-1.3, 0, -1.3], [1.3, 0, -1.3], [-1.3, 0, 1.3], [1.3, 0, 1.3]])


def placed(height):
    """Four balls, of which the last is lifted."""
    places = corners + [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, height, 0]]
    return joined([fw.Mesh(ball.vertices + place, ball.faces) for ball, place in zip(balls, places, strict=True)])


def milliseconds(run):
    begun = time.perf_counter()
    result = run()
    return 1e3 * (time.perf_counter() - begun), result


print("cells      bytes   build all   touched bricks   (share of bricks)   own grid moved")
for n in (32, 64, 96):
    build_ms, grid = milliseconds(lambda n=n: fw.sdf.from_mesh(placed(0.0), n))
    update_ms, updated = milliseconds(lambda grid=grid: grid.updated(placed(0.05)))
    one = fw.sdf.from_mesh(balls[3], n // 2)
    move_ms, _ = milliseconds(lambda one=one: fw.sdf.translate(one, (1.3, 0.05, 1.3)))
    share = updated.sampled / grid.sampled
    print(f"{n:5d}  {grid.nbytes:9,d}  {build_ms:7.0f} ms  {update_ms:11.0f} ms  {share:17.0%}  {move_ms:14.3f} ms")
draw_ms = np.median([milliseconds(lambda: draw_map(placed(0.05), 1024))[0] for _ in range(7)])
print(f"a shadow map of 1024 x 1024 pixels, drawn anew: {draw_ms:.1f} ms, {4 * 1024 * 1024:,d} bytes")

# %% [markdown]
# ## What goes wrong, and the cure
#
# **Thin walls.** A wall that is thinner than a cell may lie between the samples. Its stored distance is then never 0, and
# rays go straight through. Here 2000 rays meet a sheet of 0.02 in grids of 0.1: a plain one, and a conservative one.

# %%
sheet = fw.sdf.box((0.0, 0.013, 0.0), (0.8, 0.01, 0.8))
plain = dense_grid(sheet, -1, 1, 20)
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    safe = fw.sdf.from_mesh(fw.mesh.box((0.8, 0.01, 0.8), (0.0, 0.013, 0.0)), 16)
start = np.stack([rng.uniform(-0.7, 0.7, 2000), np.full(2000, 0.9), rng.uniform(-0.7, 0.7, 2000)], axis=1)
down = np.array([0.0, -1.0, 0.0])
for name, field in (("plain grid", lambda q: interpolated(plain, -1, 1, q)), ("conservative grid", safe), ("formula", sheet)):
    depth = np.zeros(len(start))
    for _ in range(200):
        depth += np.where(depth < 1.8, np.maximum(field(start + depth[:, None] * down), 0), 0)
    passed = depth > 0.95
    print(f"{name:17s}: {passed.mean():6.1%} of the rays pass through")
print(f"the conservative grid says that it may be wrong by {safe.error:.3f}; the sheet is 0.020 thick")

# %% [markdown]
# The conservative grid lets no ray through. The price is that thin things can look thicker, by at most the error that it
# states.
#
# **Open meshes.** The teapot has an open lid, so it has no inside, and a sign would be an invention. The grid says so, and
# its distance is positive on both sides.

# %%
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    teapot = fw.sdf.from_mesh(fw.load_mesh(Path(fw.__file__).parent / "data" / "teapot.obj"), 32)
print(f"closed: {teapot.closed}; {said[0].message}")

# %% [markdown]
# **Bias.** A shadow map stores one depth for a whole pixel, so a slanted surface shades itself in stripes. A **bias** is
# taken off the depth to prevent that. Too little: stripes. Too much: shadows come loose from their objects. A distance
# field has the same problem at its start, where $t$ and $f$ are both near 0, and the same cure: start a little off the
# surface.

# %%
small = draw_map(everything, 256)
for bias in (0.0, 0.02, 0.05, 0.8):
    seen = map_shadow(small, p, "one look-up", bias)
    print(f"bias {bias:4.2f}: {np.mean(seen[truth == 1] == 0):5.1%} of the lit points are dark, "
          f"{np.mean(seen[truth == 0] == 1):5.1%} of the dark ones lit")

# %% [markdown]
# ## Exercises
#
# **1.** A scene is 20 m long, and details of 1 cm shall be seen. How many bytes does a dense grid take, with cells of 1 cm
# and 4 bytes a sample, if it is as high and as deep as it is long? And a sparse one, if the surface crosses $6 n^2$ cells
# and 10 samples are kept for each?
#
# <details><summary>Answer</summary>
#
# $n = 2000$. Dense: $4 n^3 = 32$ GB. Sparse: $4 \cdot 10 \cdot 6 n^2 \approx 1$ GB. This is why engines store one small
# grid for each object, and only a coarse one for the whole scene.
#
# </details>
#
# **2.** An object is scaled to half its size. Must its grid be built again?
#
# <details><summary>Answer</summary>
#
# No: $f_\text{small}(p) = \tfrac12 f(2p)$ is the distance again (`fw.sdf.scale`). Turning and moving are queries too.
# Only what changes the *shape* needs a build: bending, skinning, and scaling by different factors along the axes,
# after which $f$ is no distance any more.
#
# </details>
#
# **3.** Why does the error of PCSS not vanish with larger maps?
#
# <details><summary>Answer</summary>
#
# Its model is wrong, not its resolution: it takes all blockers to be one flat thing at their mean depth, parallel to the
# lamp. Where a ball and the box both hide parts of the lamp, or a blocker is deep, the half shade has another width.
#
# </details>
#
# ## From the lecture
#
# The conclusion was: distance fields give fast soft shadows of good quality, faster than shadow maps *without their build*,
# but they need memory, time to build, and a new build where objects move. The tables above agree with each part, with
# two additions. Stored sparsely and conservatively, the memory grows with the surface, not with the space. And rigid
# motion needs no build at all; it is deformation that distance fields cannot follow.
#
# ## Where to read on
#
# - W. T. Reeves, D. H. Salesin, R. L. Cook, *Rendering antialiased shadows with depth maps*, SIGGRAPH 1987: PCF.
# - S. F. Frisken and others, *Adaptively sampled distance fields*, SIGGRAPH 2000: sparse storage.
# - R. Fernando, *Percentage-closer soft shadows*, SIGGRAPH 2005 sketches.
# - G. Barill, N. G. Dickson, R. Schmidt, D. I. W. Levin, A. Jacobson, *Fast winding numbers for soups and clouds*,
#   SIGGRAPH 2018: inside and outside.
# - D. Wright, *Dynamic occlusion with signed distance fields*, SIGGRAPH 2015 course *Advances in Real-Time Rendering*.
