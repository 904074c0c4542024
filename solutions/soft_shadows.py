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
# # Soft shadows

# %%
import numpy as np


# %% nbgrader={"grade_id": "safe_angle", "solution": true}
def safe_angle(distance, travelled):
    """Angle about the ray, seen from its start, within which nothing is in the way.

    Parameters
    ----------
    distance : (...) float     signed distance to the scene, scene units
    travelled : (...) float    distance from the ray's start, scene units

    Returns
    -------
    (...) float in [0, pi/2]   0 on and inside an object, pi/2 where the safe sphere holds the start
    """
    ### BEGIN SOLUTION
    distance, travelled = np.broadcast_arrays(distance, travelled)
    inside, around = distance <= 0, distance >= travelled
    sine = distance / np.where(inside | around, 1.0, travelled)
    return np.arcsin(np.where(inside, 0.0, np.where(around, 1.0, sine)))
    ### END SOLUTION


# %% nbgrader={"grade_id": "penumbra", "solution": true}
def penumbra(distance, travelled, k):
    """Visibility estimated from one step of the march.

    Parameters
    ----------
    distance : (...) float     signed distance to the scene, scene units
    travelled : (...) float    distance from the shading point, scene units
    k : float                  1 / sin(angular radius of the light); larger is harder

    Returns
    -------
    (...) float in [0, 1]      0 on and inside an object, 1 at the shading point itself

    Notes
    -----
    Quilez 2010: k times the ratio stands in for the safe angle over the light's radius.
    """
    ### BEGIN SOLUTION
    distance, travelled = np.broadcast_arrays(distance, travelled)
    blocked, clear = distance <= 0, k * distance >= travelled
    ratio = k * distance / np.where(blocked | clear, 1.0, travelled)
    return np.where(blocked, 0.0, np.where(clear, 1.0, ratio))
    ### END SOLUTION


# %% nbgrader={"grade_id": "needs_shadow_ray", "solution": true}
def needs_shadow_ray(normal, to_light):
    """Whether a shadow ray can change the picture at all.

    Parameters
    ----------
    normal : (N, 3) float      unit normals
    to_light : (3,) or (N, 3) float   unit vectors towards the light

    Returns
    -------
    (N,) bool                  true where the light is above the horizon
    """
    ### BEGIN SOLUTION
    return np.sum(np.multiply(normal, to_light), axis=-1) > 0
    ### END SOLUTION


# %% nbgrader={"grade_id": "soft_shadow", "solution": true}
def soft_shadow(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """How much of the light is seen, from the smallest penumbra along one ray.

    Parameters
    ----------
    sdf : callable             (N, 3) points -> (N,) distances
    origin : (N, 3) float      shading points
    to_light : (3,) or (N, 3) float   unit vectors towards the light
    k : float                  1 / sin(angular radius of the light)
    t_min, t_max : float       where the march starts and ends, scene units along the ray
    max_steps : int            evaluations of sdf that each ray may use

    Returns
    -------
    (N,) float in [0, 1]       0 for a ray that comes closer than 1e-4 to an object
    """
    ### BEGIN SOLUTION
    origin, to_light = np.broadcast_arrays(np.asarray(origin, dtype=float), to_light)
    shape = origin.shape[:-1]
    origin, to_light = origin.reshape(-1, 3), to_light.reshape(-1, 3)
    visibility = np.ones(len(origin))
    travelled = np.full(len(origin), float(t_min))
    marching = np.flatnonzero(travelled <= t_max)
    for _ in range(max_steps):
        if marching.size == 0:
            break
        here = travelled[marching]
        distance = sdf(origin[marching] + here[:, None] * to_light[marching])
        blocked = distance < 1e-4
        seen = np.where(blocked, 0.0, penumbra(distance, here, k))
        visibility[marching] = np.minimum(visibility[marching], seen)
        here = here + distance
        travelled[marching] = here
        marching = marching[~blocked & (here <= t_max)]
    return visibility.reshape(shape)
    ### END SOLUTION


# %% nbgrader={"grade_id": "area_light_shadow", "solution": true}
def area_light_shadow(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Visible fraction of a round light, from the smallest signed angle along one ray.

    Parameters
    ----------
    sdf : callable             (N, 3) points -> (N,) distances
    origin : (N, 3) float      shading points
    to_light : (3,) or (N, 3) float   unit vectors towards the light's centre
    angular_radius : float     half the angle under which the light is seen, radians
    t_min, t_max : float       where the march starts and ends, scene units along the ray
    max_steps : int            evaluations of sdf that each ray may use

    Returns
    -------
    (N,) float in [0, 1]       1/2 where the ray grazes a straight edge

    Notes
    -----
    The march goes on inside the occluder, by steps of at least a quarter of the light's radius as seen
    from the start: finer ones change the mean error by less than 3 %.
    """
    ### BEGIN SOLUTION
    origin, to_light = np.broadcast_arrays(np.asarray(origin, dtype=float), to_light)
    shape = origin.shape[:-1]
    origin, to_light = origin.reshape(-1, 3), to_light.reshape(-1, 3)
    offset = np.ones(len(origin))
    travelled = np.full(len(origin), float(t_min))
    marching = np.flatnonzero(travelled <= t_max)
    for _ in range(max_steps):
        if marching.size == 0:
            break
        here = travelled[marching]
        distance = sdf(origin[marching] + here[:, None] * to_light[marching])
        sine = np.clip(distance / np.maximum(here, np.finfo(float).tiny), -1.0, 1.0)
        smallest = np.minimum(offset[marching], np.arcsin(sine) / angular_radius)
        offset[marching] = smallest
        here = here + np.maximum(np.abs(distance), 0.25 * angular_radius * here)
        travelled[marching] = here
        marching = marching[(smallest > -1.0) & (here <= t_max)]
    x = np.clip(offset, -1.0, 1.0)
    visible = 0.5 + (x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / np.pi
    return visible.reshape(shape)
    ### END SOLUTION
