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
# # Sphere tracing
#
# ![Four shapes on a slab, in the light of a low sun](goal.png)
#
# This is where you are going: a picture without a single triangle. Everything in it is described by one
# function that says, for any point in space, how far away the nearest surface is. You will put it together
# from small functions of your own, and then find where the camera's rays meet the surface by an idea that
# fits in one sentence: *as far as the distance allows, it is safe to walk.*
#
# You need to know vectors and a little NumPy. Nothing else is assumed.
#
# **How it works.** Each section explains one idea and asks for one function. Write it in place of
# `raise NotImplementedError()`, run the cell, then run the `check` under it: it tells you what it found,
# how far off you are and how far off you may be, and shows three pictures: yours, the expected one, and the
# difference. You may run it as often as you like. The cell after it makes a picture with your function; if
# it stops with a `NotImplementedError`, the line above the error names the function that is still to be
# written.
#
# **What is graded.** Only the cells that hold the functions are taken over from your notebook. Each of them
# may use `np`, `fw` and the functions above it, so if you need a helper or a constant, put it into the same
# cell. Each function is judged by itself, with right versions of the ones before it: one mistake never
# costs you twice.

# %%
import numpy as np

import framework as fw

# %% tags=["active-ipynb"]
# from autograder import check, hint

# %% [markdown]
# ## 1.1 What a distance function is
#
# A sphere can be a list of triangles, or an equation for its points. Here it is a *question you may ask
# anywhere*: how far is it from $p$ to the nearest point of the surface? The answer $f(p)$ is given a sign:
#
# $$f(p) \;\begin{cases} > 0 & \text{outside} \\ = 0 & \text{on the surface} \\ < 0 & \text{inside.}
# \end{cases}$$
#
# This is a **signed distance function**, SDF for short. For a sphere you can write it down at once. The
# distance from $p$ to the centre $c$ is $\lVert p - c \rVert$, and the surface is reached $r$ before that:
#
# $$f(p) = \lVert p - c \rVert - r .$$
#
# All functions here work on many points at once. An array of points has the coordinates in its last axis:
# `p` has shape `(N, 3)`, the result `(N,)`. In NumPy, `np.linalg.norm(v, axis=-1)` measures the length
# along that last axis, whatever comes before it.


# %% nbgrader={"grade_id": "sdf_sphere", "solution": true}
def sdf_sphere(p, center, radius):
    """Signed distance to a sphere.

    Parameters
    ----------
    p : (..., 3) float         points
    center : (3,) float        the sphere's centre
    radius : float             its radius, > 0

    Returns
    -------
    (...) float                distance to the surface, negative inside
    """
    ### BEGIN SOLUTION
    return np.linalg.norm(np.subtract(p, center), axis=-1) - radius
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-1-1", "points": 2}
# check("1.1")

# %% [markdown]
# The picture below is a slice through space at $z = 0$. The thick line is the surface, the thin ones join
# points of equal distance: circles, evenly spaced, because one step away from the sphere makes the distance
# larger by one step.
#
# Now read one value, say $f(p) = 2$, as a promise: *nothing is closer to $p$ than 2.* The whole ball of
# radius 2 about $p$ is empty. In whatever direction you walk from there, 2 units are **safe**. Remember
# this; all of section 1.7 is made of it.

# %% tags=["active-ipynb"]
# fw.show.sdf_slice(lambda p: sdf_sphere(p, center=(0, 0, 0), radius=1.0), axis="z")

# %% [markdown]
# ## 1.2 A box
#
# A box has six faces, twelve edges and eight corners, and a nearest point can lie on any of them. Symmetry
# makes it short. Put the centre at the origin and take absolute values: that folds all eight octants into
# one, and only one corner is left. With the half size $h$, let
#
# $$q = \lvert p - c \rvert - h \quad\text{(for each coordinate).}$$
#
# Each component of $q$ says how far $p$ is *beyond* a face, and is negative where it is not.
#
# - **Outside**, only the positive components count. One of them: the nearest point is on a face. Two: on an
#   edge. Three: on a corner. The length $\lVert \max(q, 0) \rVert$ is right in all three cases.
# - **Inside**, all components are negative, and the nearest face is the one that is least far away: the
#   largest component, $\max(q_x, q_y, q_z)$.
#
# One of the two is always zero if you write the second as $\min(\max(q_x, q_y, q_z),\, 0)$, so just add
# them. It is tempting to leave the second part out. The picture outside stays the same, but shadows and
# cut-outs need it.


# %% nbgrader={"grade_id": "sdf_box", "solution": true}
def sdf_box(p, center, half_size):
    """Signed distance to a box whose edges run along the axes.

    Parameters
    ----------
    p : (..., 3) float         points
    center : (3,) float        the box's centre
    half_size : (3,) float     half of its width, height and depth

    Returns
    -------
    (...) float                exact distance to the surface, negative inside
    """
    ### BEGIN SOLUTION
    beyond = np.abs(np.subtract(p, center)) - half_size
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
    inside = np.minimum(beyond.max(axis=-1), 0.0)
    return outside + inside
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-1-2", "points": 3}
# check("1.2")

# %% [markdown]
# Look at the corners: outside, the lines of equal distance are rounded, because there the nearest point is
# the corner itself. Inside they stay sharp, along the lines where two faces are equally near.

# %% tags=["active-ipynb"]
# fw.show.sdf_slice(lambda p: sdf_box(p, center=(0, 0, 0), half_size=(1.2, 0.7, 0.5)), axis="z")

# %% [markdown]
# ## 1.3 A torus
#
# A torus is a circle drawn around an axis, here the axis $+y$. So walk around the axis until you stand in
# the plane that holds both the axis and $p$. In this plane only two numbers are left: the distance from the
# axis, $\rho = \sqrt{x^2 + z^2}$, and the height $y$. The torus is a plain circle there, with its centre at
# $\rho = R$, $y = 0$ and radius $r$, and a circle is what you have already solved:
#
# $$f(p) = \sqrt{(\rho - R)^2 + y^2} - r, \qquad (x, y, z) = p - c .$$
#
# $R$ is the `major_radius`, $r$ the `minor_radius`.


# %% nbgrader={"grade_id": "sdf_torus", "solution": true}
def sdf_torus(p, center, major_radius, minor_radius):
    """Signed distance to a torus that lies flat: its axis is +y.

    Parameters
    ----------
    p : (..., 3) float         points
    center : (3,) float        the torus's centre
    major_radius : float       from the centre to the middle of the tube
    minor_radius : float       radius of the tube

    Returns
    -------
    (...) float                exact distance to the surface, negative inside the tube
    """
    ### BEGIN SOLUTION
    q = np.subtract(p, center)
    from_ring = np.hypot(q[..., 0], q[..., 2]) - major_radius
    return np.hypot(from_ring, q[..., 1]) - minor_radius
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-1-3", "points": 3}
# check("1.3")

# %% tags=["active-ipynb"]
# fw.show.sdf_slice(lambda p: sdf_torus(p, center=(0, 0, 0), major_radius=1.1, minor_radius=0.4), axis="z")

# %% [markdown]
# ## 1.4 Blending two shapes
#
# Distance functions are numbers, and numbers can be mixed. Three mixtures are worth knowing by heart:
#
# | | | |
# | --- | --- | --- |
# | union | $\min(d_1, d_2)$ | whatever is nearer |
# | intersection | $\max(d_1, d_2)$ | inside both |
# | subtraction | $\max(d_1, -d_2)$ | the first, without the second |
#
# They need no function of ours. The next one is more surprising: a weighted mean turns one shape into
# another,
#
# $$d = (1 - t)\, d_1 + t\, d_2, \qquad 0 \le t \le 1 ,$$
#
# with all the shapes in between. There is no such mean of two triangle meshes: which vertex would become
# which?
#
# Is the promise kept? If $p$ moves by one unit, $d_1$ and $d_2$ change by at most one unit each, and so
# does any mean of them. The blend can never fall faster than you walk. It may not be the exact distance any
# more, but it is never *more* than the distance to the new surface, and that is all that a safe step needs.


# %% nbgrader={"grade_id": "blend", "solution": true}
def blend(d1, d2, t):
    """Blend two distance fields, from the first at t = 0 to the second at t = 1.

    Parameters
    ----------
    d1, d2 : (...) float       distances to the two shapes
    t : (...) float            in [0, 1]

    Returns
    -------
    (...) float                values of the blended field
    """
    ### BEGIN SOLUTION
    return (1.0 - t) * d1 + t * d2
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-1-4", "points": 1}
# check("1.4")

# %% tags=["active-ipynb"]
# def box_to_torus(p, t):
#     return blend(sdf_box(p, (0, 0, 0), (1.2, 0.7, 0.5)), sdf_torus(p, (0, 0, 0), 1.1, 0.4), t)
#
#
# for t in (0.0, 0.5, 1.0):
#     fw.show.sdf_slice(lambda p: box_to_torus(p, t), axis="z", title=f"t = {t}")

# %% [markdown]
# ## 1.5 A union without a crease
#
# Where two shapes meet, $\min$ leaves a sharp crease: nature prefers a fillet. The **smooth minimum** looks
# at how much the two distances differ. More than $k$: it is the plain minimum. Less: it goes a little
# lower, and that fills the crease,
#
# $$\operatorname{smin}(d_1, d_2) = \min(d_1, d_2) - \frac{\max(k - \lvert d_1 - d_2 \rvert,\ 0)^2}{4 k} .$$
#
# The square makes it start gently, and the factor $1/(4k)$ is exactly what makes the two sides meet without
# a kink. Where both are equal the surface rises by $k^2 / (4k) = k/4$, nowhere more. $k$ is a length: the
# width of the seam.
#
# The promise still holds: the gradient of smin is a weighted mean of the two gradients, so it is not longer
# than 1.


# %% nbgrader={"grade_id": "smooth_union", "solution": true}
def smooth_union(d1, d2, k):
    """Union of two shapes with the seam rounded: the quadratic smooth minimum.

    Parameters
    ----------
    d1, d2 : (...) float       distances to the two shapes
    k : float                  width of the blend, > 0, scene units

    Returns
    -------
    (...) float                the minimum, lowered by up to k / 4 where the two are closer than k
    """
    ### BEGIN SOLUTION
    overlap = np.maximum(k - np.abs(np.subtract(d1, d2)), 0.0)
    return np.minimum(d1, d2) - overlap**2 / (4.0 * k)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-1-5", "points": 3}
# check("1.5")

# %% tags=["active-ipynb"]
# def two_balls(p, k):
#     return smooth_union(sdf_sphere(p, (-0.6, 0, 0), 0.8), sdf_sphere(p, (0.7, 0, 0), 0.6), k)
#
#
# for k in (0.01, 0.4, 1.0):
#     fw.show.sdf_slice(lambda p: two_balls(p, k), axis="z", title=f"k = {k}")

# %% [markdown]
# ## 1.6 Which way the surface faces
#
# Light needs normals. The distance knows them: it grows fastest straight away from the surface, and the
# direction of fastest growth is the gradient,
#
# $$n = \frac{\nabla f}{\lVert \nabla f \rVert} .$$
#
# We may only ask for values of $f$, so look a little to both sides, along each axis:
#
# $$\frac{\partial f}{\partial x} \approx
# \frac{f(p + \varepsilon e_x) - f(p - \varepsilon e_x)}{2 \varepsilon},
# \quad\text{and likewise for } y \text{ and } z .$$
#
# Then bring the three numbers to length 1; common factors do not matter. Six values per point is the plain
# way. Four are enough if you look towards the corners of a tetrahedron: with $k_i$ = $(1,-1,-1)$,
# $(-1,-1,1)$, $(-1,1,-1)$ and $(1,1,1)$, the sum $\sum_i k_i\, f(p + \varepsilon k_i)$ points along the
# gradient. Both are fine here.
#
# Not too small an $\varepsilon$: two nearly equal numbers are subtracted, and only their rounding errors
# would be left.


# %% nbgrader={"grade_id": "estimate_normal", "solution": true}
def estimate_normal(sdf, p, eps):
    """Unit normal of the surface through p: the direction in which the distance grows fastest.

    Parameters
    ----------
    sdf : callable             (N, 3) points -> (N,) distances
    p : (N, 3) float           points on or near the surface
    eps : float                how far from p to look, scene units

    Returns
    -------
    (N, 3) float               unit vectors, pointing out of the shape
    """
    ### BEGIN SOLUTION
    p = np.asarray(p, dtype=float)
    steps = eps * np.concatenate([np.eye(3), -np.eye(3)])
    around = p[..., None, :] + steps
    distance = np.reshape(sdf(around.reshape(-1, 3)), around.shape[:-1])
    return fw.normalize(distance[..., :3] - distance[..., 3:])
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-1-6", "points": 3}
# check("1.6")

# %% [markdown]
# Each pixel below is a point of the slice $z = 0$ and shows the direction away from the nearest surface: red
# for $x$, green for $y$, blue for $z$, from 0 for $-1$ to full for $+1$. Follow a line from the middle of the
# tube outwards: the colour does not change until another part of the torus becomes the nearest.

# %% tags=["active-ipynb"]
# size = 240
# x, y = np.meshgrid(np.linspace(-2, 2, size), np.linspace(2, -2, size))
# p = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
# direction = estimate_normal(lambda p: sdf_torus(p, (0, 0, 0), 1.1, 0.4), p, eps=1e-4)
# fw.show.image(0.5 + 0.5 * direction.reshape(size, size, 3))

# %% [markdown]
# ## 1.7 Sphere tracing
#
# Now the rays. A ray starts at the origin $o$ and goes along the unit vector $d$; its points are
# $o + t\,d$. Where does it first meet the surface? There is no equation to solve, since $f$ can be anything. But
# there is the promise: at $p$, all within $f(p)$ is empty. So walk by exactly that much, and ask again:
#
# $$t_0 = 0, \qquad t_{i+1} = t_i + f(o + t_i\, d) .$$
#
# Far from everything the steps are long; near a surface they become short, and the points run into it
# without ever passing through. Three things can happen at a visited point:
#
# 1. $f < \varepsilon$: close enough. It is a **hit**, at this $t$. (A ray that starts inside hits at 0.)
# 2. $t > t_\text{max}$: it left the scene, a **miss**. Such a point is not even evaluated.
# 3. After `max_steps` evaluations without a hit we give up: a miss, too.
#
# **Work on rays that still march.** Evaluating $f$ is what costs, and most rays are done after a few steps
# while some need a hundred. Keep an array of the *indices* of the rays that still march; evaluate only
# those; then throw out the ones that are done. `a[index]` picks rows, `a[index] = values` puts them back,
# `index[keep]` with a bool array shortens the list. A part of the points is for this: the check counts how
# many points you hand to `sdf`.
#
# Return $t = \infty$ where a ray missed.


# %% nbgrader={"grade_id": "sphere_trace", "solution": true}
def sphere_trace(sdf, origin, direction, t_max, eps, max_steps):
    """First hit of each ray with the surface, found by steps as long as the distance allows.

    Parameters
    ----------
    sdf : callable             (N, 3) points -> (N,) distances
    origin : (N, 3) float      where the rays start
    direction : (N, 3) float   unit vectors
    t_max : float              how far to look, scene units
    eps : float                closer than this is a hit, scene units
    max_steps : int            evaluations of sdf that each ray may use

    Returns
    -------
    t : (N,) float             distance along the ray, inf where it missed
    hit : (N,) bool            whether it hit; a ray that starts inside hits at 0

    Notes
    -----
    Hart 1996. Only rays that still march are evaluated.
    """
    ### BEGIN SOLUTION
    origin, direction = np.broadcast_arrays(np.asarray(origin, dtype=float), direction)
    shape = origin.shape[:-1]
    origin, direction = origin.reshape(-1, 3), direction.reshape(-1, 3)
    t = np.full(len(origin), np.inf)
    travelled = np.zeros(len(origin))
    marching = np.flatnonzero(travelled <= t_max)
    for _ in range(max_steps):
        if marching.size == 0:
            break
        here = travelled[marching]
        distance = sdf(origin[marching] + here[:, None] * direction[marching])
        found = distance < eps
        t[marching[found]] = here[found]
        here = here + distance
        travelled[marching] = here
        marching = marching[~found & (here <= t_max)]
    return t.reshape(shape), np.isfinite(t).reshape(shape)
    ### END SOLUTION


# %% tags=["active-ipynb"] nbgrader={"grade_id": "check-1-7", "points": 5}
# check("1.7")

# %% [markdown]
# Here is one ray of yours from above the slice, with the ball that each step relied on. Your function does
# not return the points it visits, but it must ask for the distance at each of them: an `sdf` that keeps a
# list sees them all. Move the height of the ray, `-0.62`, so that it only just passes the sphere: what
# happens to the steps?

# %% tags=["active-ipynb"]
# import matplotlib.pyplot as plt
#
# visited = []
#
#
# def two_shapes(p):
#     return np.minimum(sdf_sphere(p, (0, -1.4, 0), 0.7), sdf_box(p, (2.2, 0, 0), (0.4, 1.2, 1)))
#
#
# def two_shapes_with_a_list(p):
#     visited.extend(p)
#     return two_shapes(p)
#
#
# sphere_trace(two_shapes_with_a_list, np.array([[-3.0, -0.62, 0]]), np.array([[1.0, 0, 0]]), 10.0, 1e-3, 100)
# x, y = np.meshgrid(np.linspace(-3.5, 3, 300), np.linspace(-2.2, 2.2, 200))
# plt.figure(figsize=(8, 5.4))
# plt.contourf(x, y, two_shapes(np.stack([x, y, np.zeros_like(x)], -1)), [-9, 0], colors=["0.75"])
# for p in np.array(visited):
#     plt.gca().add_patch(plt.Circle(p[:2], two_shapes(p), fill=False, color="tab:blue"))
# plt.plot(*np.array(visited).T[:2], "o-", color="tab:red", markersize=4)
# plt.axis("scaled")
# plt.title(f"{len(visited)} evaluations")
# plt.show()

# %% [markdown]
# ## The picture
#
# All is ready. First the scene, made of your shapes: a slab, a ring and a ball that melt into each other, a
# box that is half a sphere already, and a cube with a ball cut out of it. The scene's distance is the
# smallest of the four. Which of them is the smallest tells the colour.

# %% tags=["active-ipynb"]
# def parts(p):
#     slab = sdf_box(p, (0, -0.1, 0), (3.0, 0.1, 2.2))
#     melted = smooth_union(sdf_torus(p, (0, 0.22, 0.1), 0.75, 0.22), sdf_sphere(p, (0, 0.6, 0.1), 0.5), 0.35)
#     half_way = blend(sdf_box(p, (-1.85, 0.6, 0), (0.5, 0.6, 0.5)), sdf_sphere(p, (-1.85, 0.6, 0), 0.6), 0.5)
#     cube, hole = sdf_box(p, (1.85, 0.5, 0), (0.5, 0.5, 0.5)), sdf_sphere(p, (1.75, 0.75, 0.3), 0.55)
#     return np.stack([slab, melted, half_way, np.maximum(cube, -hole)])
#
#
# def scene(p):
#     return parts(p).min(axis=0)
#
#
# colors = np.array([[0.35, 0.34, 0.32], [0.55, 0.12, 0.06], [0.06, 0.20, 0.40], [0.60, 0.36, 0.06]])

# %% [markdown]
# Then the light. For each pixel the camera gives a ray. Where it hits, the surface gets light from the sun
# if a second ray, from there to the sun, meets nothing: a hard shadow, and again your `sphere_trace` that
# answers. It starts a little off the surface, or it would hit where it stands. What the sun does not reach
# sees some blue of the sky. How these shadows get soft edges is the subject of the next notebook.

# %% tags=["active-ipynb"]
# camera = fw.Camera(position=(0.0, 2.9, 5.6), target=(0.0, 0.3, 0.0), up=(0, 1, 0), fov_y=0.58)
# to_sun = fw.normalize([-0.7, 0.8, 0.5])
#
#
# def render(width, height):
#     origin, direction = (a.reshape(-1, 3) for a in camera.rays(width, height))
#     t, hit = sphere_trace(scene, origin, direction, t_max=20.0, eps=1e-3, max_steps=200)
#     image = np.array([0.45, 0.60, 0.80]) * (1 - 0.6 * np.clip(direction[:, 1:2], 0, 1))  # the sky
#
#     p = origin[hit] + t[hit, None] * direction[hit]
#     normal = estimate_normal(scene, p, 1e-4)
#     off_surface, towards_sun = p + 5e-3 * normal, np.broadcast_to(to_sun, p.shape)
#     _, shadowed = sphere_trace(scene, off_surface, towards_sun, t_max=10.0, eps=1e-4, max_steps=100)
#     sun = np.clip(normal @ to_sun, 0, 1) * ~shadowed
#     sky = 0.5 + 0.5 * normal[:, 1]
#     light = 1.5 * sun[:, None] * [1.0, 0.92, 0.78] + 0.35 * sky[:, None] * [0.7, 0.85, 1.0]
#     image[hit] = colors[parts(p).argmin(axis=0)] * light
#     return image.reshape(height, width, 3)
#
#
# fw.show.image(render(300, 200))

# %% [markdown]
# How much did each pixel cost? Every point that `sphere_trace` visits lies on the ray of one pixel, so the
# camera can tell which one: project the point back into the image, and count. (All rays visit the origin
# once.)
#
# Bright pixels are expensive. Look for them: not where the surface is far away, but where rays *graze* a
# surface. There the distance stays small for a long way, though nothing is hit.

# %% tags=["active-ipynb"]
# def evaluations_per_ray(width, height):
#     origin, direction = (a.reshape(-1, 3) for a in camera.rays(width, height))
#     counts = np.ones((height, width))
#     to_clip = camera.view_projection(width, height)
#
#     def counting_scene(p):
#         ahead = p[np.linalg.norm(p - camera.position, axis=1) > 1e-9]
#         x, y, _, w = to_clip @ np.column_stack([ahead, np.ones(len(ahead))]).T
#         column, row = (x / w + 1) / 2 * width, (1 - y / w) / 2 * height
#         np.add.at(counts, (row.astype(int), column.astype(int)), 1)
#         return scene(p)
#
#     sphere_trace(counting_scene, origin, direction, t_max=20.0, eps=1e-3, max_steps=200)
#     return counts
#
#
# fw.show.march_heat_map(evaluations_per_ray(300, 200))

# %% [markdown]
# ## The same with triangles
#
# Games find what is visible by rasterising triangles, which hardware does faster than any march. Distance fields
# come in after that, for what triangles are bad at: asking what lies in some direction. So keep the two apart. A
# rasterised mesh tells *where* each pixel's surface is; your field tells its normal and whether the sun is hidden.
#
# A torus and a ball as meshes, and the same as fields. Do the two agree about where the surface is?

# %% tags=["active-ipynb"]
# ring = fw.mesh.torus(0.75, 0.25)
# meshes = [
#     fw.mesh.plane(size=6.0),
#     fw.Mesh(ring.vertices + [-0.7, 0.25, 0.2], ring.faces, ring.normals),
#     fw.mesh.sphere(0.6, (0.9, 0.6, -0.1)),
# ]
#
#
# def on_floor(p):
#     torus = sdf_torus(p, (-0.7, 0.25, 0.2), 0.75, 0.25)
#     return np.stack([p[..., 1], torus, sdf_sphere(p, (0.9, 0.6, -0.1), 0.6)])
#
#
# def field(p):
#     return on_floor(p).min(axis=0)
#
#
# seen = [fw.rasterize(mesh, camera, 300, 200) for mesh in meshes]
# nearest = np.argmin([one.depth for one in seen], axis=0)
# mask = np.any([one.mask for one in seen], axis=0)
# p = np.choose(nearest[..., None], [one.position for one in seen])[mask]
# print(f"the triangles lie within {np.abs(field(p)).max():.4f} of the field's surface")

# %% [markdown]
# They do, as well as flat triangles can follow a curve. So your functions take over each pixel's point:

# %% tags=["active-ipynb"]
# normal = estimate_normal(field, p, 1e-4)
# _, shadowed = sphere_trace(field, p + 1e-2 * normal, np.broadcast_to(to_sun, p.shape), 10.0, 1e-4, 100)
# sun = np.clip(normal @ to_sun, 0, 1) * ~shadowed
# shaded = np.tile([0.45, 0.60, 0.80], (200, 300, 1))
# shaded[mask] = colors[nearest[mask]] * (1.5 * sun[:, None] * [1.0, 0.92, 0.78] + 0.25)
# fw.show.image(shaded, title="Found by the rasteriser, lit by your functions")

# %% [markdown]
# ## A question
#
# Sphere tracing looks at single points and never at what lies between them. Answer in a few sentences of
# your own, in the cell below (2 points, read by a person):
#
# - Why can it still not step through a surface, however thin?
# - Somebody scales a shape and forgets to scale its distances, so that the field says *twice* the true
#   distance. What would you see in the picture, and why? And if it says *half*?

# %% [markdown] nbgrader={"grade_id": "question-1", "solution": true, "points": 2}
# The value at a point is the distance to the nearest surface in any direction, so the ball of that radius
# about it is empty. A step along the ray stays within the ball: whatever is thin would have been nearer,
# and would have made the step shorter.
#
# A field that says twice the distance breaks the promise: steps reach beyond the empty ball, so rays can
# jump over thin parts and edges, or land inside, at a point where the value is negative and which counts as
# a hit too deep. Holes, torn silhouettes and wrong depths follow, which change with the camera. Half the
# distance keeps the promise: the picture stays right, but each ray needs more steps, and with few steps
# allowed rays give up near edges.

# %% [markdown]
# ## Where to go from here
#
# - Turn the camera, or write a scene of your own: `fw.sdf` has more shapes (a capsule, a plane, rotation
#   and scaling), and its fields are callables just like yours.
# - Raise `eps` to `0.05`, or lower `max_steps` to 20, and look at the rim of the shapes.
# - The next notebook, `soft_shadows`, uses the same march once more: the *smallest* distance on the way
#   says how close a ray came to being blocked.
