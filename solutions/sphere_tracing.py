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

# %%
import numpy as np

import framework as fw


# %% nbgrader={"grade": false, "grade_id": "sdf_sphere", "locked": false, "schema_version": 3, "solution": true, "task": false}
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


# %% nbgrader={"grade": false, "grade_id": "sdf_box", "locked": false, "schema_version": 3, "solution": true, "task": false}
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


# %% nbgrader={"grade": false, "grade_id": "sdf_torus", "locked": false, "schema_version": 3, "solution": true, "task": false}
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


# %% nbgrader={"grade": false, "grade_id": "blend", "locked": false, "schema_version": 3, "solution": true, "task": false}
def blend(d1, d2, t):
    """Blend two distance fields, from the first at t = 0 to the second at t = 1.

    Parameters
    ----------
    d1, d2 : (...) float       distances to the two shapes
    t : float                  in [0, 1]

    Returns
    -------
    (...) float                values of the blended field
    """
    ### BEGIN SOLUTION
    return (1.0 - t) * d1 + t * d2
    ### END SOLUTION


# %% nbgrader={"grade": false, "grade_id": "smooth_union", "locked": false, "schema_version": 3, "solution": true, "task": false}
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


# %% nbgrader={"grade": false, "grade_id": "estimate_normal", "locked": false, "schema_version": 3, "solution": true, "task": false}
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
    gradient = distance[..., :3] - distance[..., 3:]
    length = np.linalg.norm(gradient, axis=-1, keepdims=True)
    return gradient / np.maximum(length, np.finfo(float).tiny)
    ### END SOLUTION


# %% nbgrader={"grade": false, "grade_id": "sphere_trace", "locked": false, "schema_version": 3, "solution": true, "task": false}
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
