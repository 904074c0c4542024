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
# # Prefiltered environments

# %%
import numpy as np

import framework as fw


# %% nbgrader={"grade_id": "sample_ggx", "solution": true}
def sample_ggx(xi, alpha):
    """Half vectors about +z with the density of the normals that GGX describes.

    Parameters
    ----------
    xi : (N, 2) float in [0, 1)   points in the unit square
    alpha : float or (N,) float   width, roughness squared

    Returns
    -------
    (N, 3) float                  unit vectors with density D(h) (n.h) per steradian

    Notes
    -----
    Walter et al. 2007, eq. 35: tan = alpha sqrt(u / (1 - u)).
    """
    ### BEGIN SOLUTION
    u, phi = np.asarray(xi, dtype=float)[:, 0], 2.0 * np.pi * np.asarray(xi, dtype=float)[:, 1]
    # Sine and cosine from the same triangle: nothing overflows as u nears 1, nothing cancels as it nears 0.
    opposite, adjacent = alpha * np.sqrt(u), np.sqrt(1.0 - u)
    length = np.maximum(np.hypot(opposite, adjacent), np.finfo(float).tiny)
    sine, cosine = opposite / length, adjacent / length
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)
    ### END SOLUTION


# %% nbgrader={"grade_id": "irradiance", "solution": true}
def irradiance(env, height):
    """What a white diffuse surface shows under the environment, for every orientation.

    Parameters
    ----------
    env : framework.Environment
    height : int               rows of the result

    Returns
    -------
    (height, 2 height, 3) float   cosine-weighted mean radiance (irradiance / pi), one pixel per normal

    Notes
    -----
    All pixels of the map, with their exact solid angles: the sum of the weights cancels what is left of the
    discretisation, so a constant map stays as it is.
    """
    ### BEGIN SOLUTION
    normals = fw.environment.pixel_directions(height).reshape(-1, 3)
    directions, solid_angles = env.directions().reshape(-1, 3), env.solid_angles().reshape(-1, 1)
    light = env.pixels.reshape(-1, 3) * solid_angles
    result = np.empty_like(normals)
    step = max(1, 2_000_000 // len(directions))
    for i in range(0, len(normals), step):
        cosine = np.maximum(normals[i : i + step] @ directions.T, 0.0)
        result[i : i + step] = (cosine @ light) / (cosine @ solid_angles)
    return result.reshape(height, 2 * height, 3)
    ### END SOLUTION


# %% nbgrader={"grade_id": "prefilter", "solution": true}
def prefilter(env, alpha, height, samples):
    """Radiance blurred by the lobe of a rough mirror that is seen from straight above: n = v = r.

    Parameters
    ----------
    env : framework.Environment
    alpha : float              width of the lobe, roughness squared; 0 copies the map
    height : int               rows of the result
    samples : int              look-ups for each pixel of the result

    Returns
    -------
    (height, 2 height, 3) float   GGX-filtered radiance, weighted by n.l and normalised

    Notes
    -----
    With n = v = r the lobe depends on n.l alone, so it needs no samples where it is wider than a pixel: the result
    is a weighted mean of all pixels. In a narrower lobe the pixels near its axis are too coarse. There look-ups are
    spread evenly over the logarithm of the lobe's tail, for a sun that lies far out in it still counts.
    """
    ### BEGIN SOLUTION
    normals = fw.environment.pixel_directions(height).reshape(-1, 3)
    if alpha == 0.0:
        return env.radiance(normals).reshape(height, 2 * height, 3)
    directions, solid_angles = env.directions().reshape(-1, 3), env.solid_angles().reshape(-1, 1)
    light = env.pixels.reshape(-1, 3) * solid_angles
    pixel = np.pi / env.height
    near = min(4.0 * pixel, 0.5 * np.pi) if alpha < pixel else 0.0

    def share_of_pixels(sin2):
        x = np.clip(sin2 / np.sin(0.5 * near) ** 2, 0.0, 1.0) if near else 1.0
        return x * x * (3.0 - 2.0 * x)

    def sum_pixels(normal):
        n_l = normal @ directions.T
        sin2 = 0.5 - 0.5 * n_l  # of the half vector
        density = (alpha / (alpha**2 * (1.0 - sin2) + sin2)) ** 2 / (4.0 * np.pi)
        weight = density * np.maximum(n_l, 0.0) * share_of_pixels(sin2)
        return weight @ light, weight @ solid_angles

    def sum_samples(normal):
        xi = fw.hammersley(samples) + 0.5 / samples
        depth = np.log1p((np.tan(0.5 * near) / alpha) ** 2)
        beyond = np.exp(-depth * xi[:, 1])
        half = sample_ggx(np.stack([1.0 - beyond, xi[:, 0]], axis=1), alpha)
        to_light = 2.0 * half[:, 2:] * half - [0.0, 0.0, 1.0]
        weight = depth * beyond * to_light[:, 2] * (1.0 - share_of_pixels(1.0 - half[:, 2] ** 2)) / samples
        frame = np.stack([*fw.orthonormal_frame(normal), normal], axis=1)
        radiance = env.radiance((to_light @ frame).reshape(-1, 3)).reshape(-1, samples, 3)
        return np.einsum("s,nsk->nk", weight, radiance), weight.sum()

    result = np.empty_like(normals)
    step = max(1, 1_000_000 // max(len(directions), samples))
    for i in range(0, len(normals), step):
        parts = [sum_pixels(normals[i : i + step])] + ([sum_samples(normals[i : i + step])] if near else [])
        result[i : i + step] = sum(total for total, _ in parts) / sum(weight for _, weight in parts)
    return result.reshape(height, 2 * height, 3)
    ### END SOLUTION


# %% nbgrader={"grade_id": "prefilter_chain", "solution": true}
def prefilter_chain(env, roughness_levels, heights, samples):
    """One filtered map for each roughness.

    Parameters
    ----------
    env : framework.Environment
    roughness_levels : (L,) float   in [0, 1], in any order
    heights : (L,) int              rows of each map
    samples : int                   look-ups for each pixel

    Returns
    -------
    list of (height, 2 height, 3) float   each straight from `env`, in the given order
    """
    ### BEGIN SOLUTION
    levels = zip(roughness_levels, heights, strict=True)
    return [prefilter(env, roughness**2, height, samples) for roughness, height in levels]
    ### END SOLUTION


# %% nbgrader={"grade_id": "sample_chain", "solution": true}
def sample_chain(chain, roughness_levels, direction, roughness):
    """Look filtered radiance up between the pixels and between the levels.

    Parameters
    ----------
    chain : sequence of (h, 2h, 3) float   one map per level
    roughness_levels : (L,) float          strictly ascending
    direction : (N, 3) float               unit vectors
    roughness : float or (N,) float

    Returns
    -------
    (N, 3) float   bilinear in the two nearest levels, linear in roughness between them; beyond the ends the end level
    """
    ### BEGIN SOLUTION
    direction = np.asarray(direction, dtype=float)
    # 1.25 is a quarter of the way from the second level to the third.
    position = np.interp(roughness, roughness_levels, np.arange(len(chain)))
    position = np.broadcast_to(position, direction.shape[:-1])
    result = np.zeros(direction.shape)
    for level, pixels in enumerate(chain):
        weight = np.maximum(1.0 - np.abs(position - level), 0.0)
        near = weight > 0.0
        if near.any():
            result[near] += weight[near][..., None] * fw.Environment(pixels).radiance(direction[near])
    return result
    ### END SOLUTION


# %% nbgrader={"grade_id": "classic_approximation", "solution": true}
def classic_approximation(f, g, weights):
    """The integral of a product, taken apart: the mean of f where g is, times the integral of g.

    Parameters
    ----------
    f, g : (N,) float          samples of the two functions
    weights : (N,) float       quadrature weights

    Returns
    -------
    float                      (sum f w over g's support / sum w over g's support) * sum g w; 0 without support
    """
    ### BEGIN SOLUTION
    f, g, weights = (np.asarray(values, dtype=float) for values in (f, g, weights))
    support = g != 0.0
    extent = weights[support].sum()
    if extent == 0.0:
        return 0.0
    return float((f * weights)[support].sum() / extent * (g * weights)[support].sum())
    ### END SOLUTION
