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
# # The split sum

# %%
import numpy as np

import framework as fw


# %% nbgrader={"grade_id": "fresnel", "solution": true}
def fresnel_schlick(r0, cos_theta):
    """Reflectance at an angle, from the reflectance at normal incidence.

    Parameters
    ----------
    r0 : (...) float           reflectance at normal incidence, in [0, 1]
    cos_theta : (...) float    cosine between the direction and the (half) normal, in [0, 1]

    Returns
    -------
    (...) float                from r0 at cosine 1 to 1 at cosine 0

    Notes
    -----
    Schlick 1994.
    """
    ### BEGIN SOLUTION
    away = 1.0 - np.clip(cos_theta, 0.0, 1.0)
    return r0 + np.subtract(1.0, r0) * away**5
    ### END SOLUTION


def r0_from_ior(n1, n2):
    """Reflectance at normal incidence between two media.

    Parameters
    ----------
    n1, n2 : (...) float       their indices of refraction, > 0; 1 for air

    Returns
    -------
    (...) float in [0, 1)      the same from either side
    """
    ### BEGIN SOLUTION
    return (np.subtract(n1, n2) / np.add(n1, n2)) ** 2
    ### END SOLUTION


# %% nbgrader={"grade_id": "ndf", "solution": true}
def ndf_beckmann(cos_h, alpha):
    """Density of microfacet normals per steradian: a Gaussian of slopes.

    Parameters
    ----------
    cos_h : (...) float        cosine between the normal and the half vector
    alpha : (...) float        width, roughness squared

    Returns
    -------
    (...) float                0 where cos_h <= 0

    Notes
    -----
    Beckmann & Spizzichino 1963: exp(-tan^2 / alpha^2) / (pi alpha^2 cos^4).
    """
    ### BEGIN SOLUTION
    c = np.clip(cos_h, 1e-30, 1.0)
    a2 = np.square(np.maximum(alpha, 1e-4))
    tan2 = (1.0 - c) * (1.0 + c) / c**2
    return np.where(np.greater(cos_h, 0.0), np.exp(-tan2 / a2) / (np.pi * a2 * c**4), 0.0)
    ### END SOLUTION


def ndf_ggx(cos_h, alpha):
    """Density of microfacet normals per steradian: a narrower peak than Beckmann's, and longer tails.

    Parameters
    ----------
    cos_h : (...) float        cosine between the normal and the half vector
    alpha : (...) float        width, roughness squared

    Returns
    -------
    (...) float                0 where cos_h <= 0

    Notes
    -----
    Walter et al. 2007: alpha^2 / (pi (1 + (alpha^2 - 1) cos^2)^2), with the bracket as alpha^2 cos^2 + sin^2:
    no difference of close numbers is left, so narrow lobes keep their peak.
    """
    ### BEGIN SOLUTION
    c = np.clip(cos_h, 0.0, 1.0)
    a2 = np.square(np.maximum(alpha, 1e-4))
    bracket = a2 * c**2 + (1.0 - c) * (1.0 + c)
    return np.where(c > 0.0, a2 / (np.pi * bracket**2), 0.0)
    ### END SOLUTION


# %% nbgrader={"grade_id": "masking_shadowing", "solution": true}
def masking_shadowing(cos_i, cos_o, alpha):
    """Fraction of the microfacets that both directions see.

    Parameters
    ----------
    cos_i, cos_o : (...) float     cosines between the normal and the two directions
    alpha : (...) float            width, roughness squared

    Returns
    -------
    (...) float in [0, 1]          0 where either cosine is at or below 0

    Notes
    -----
    Height-correlated Smith G2 of GGX (Heitz 2014): 1 / (1 + Lambda(i) + Lambda(o)), with
    1 + 2 Lambda = sqrt(1 + alpha^2 tan^2).
    """
    ### BEGIN SOLUTION
    a2 = np.square(np.maximum(alpha, 1e-4))
    i, o = (np.clip(cosine, 1e-100, 1.0) for cosine in (cos_i, cos_o))
    slope_i, slope_o = (np.sqrt(a2 / c**2 + (1.0 - a2)) for c in (i, o))
    above = np.greater(cos_i, 0.0) & np.greater(cos_o, 0.0)
    return np.where(above, 2.0 / (slope_i + slope_o), 0.0)
    ### END SOLUTION


# %% nbgrader={"grade_id": "microfacet_brdf", "solution": true}
def microfacet_brdf(normal, view, to_light, r0, alpha):
    """Reflection of one light direction by a rough mirror.

    Parameters
    ----------
    normal, view : (N, 3) float            unit vectors
    to_light : (3,) or (N, 3) float        unit vectors towards the light
    r0 : float, (3,) or (N, 3) float       reflectance at normal incidence
    alpha : float or (N,) float            width, roughness squared

    Returns
    -------
    (N, 3) float               per steradian; 0 where view or light is at or below the horizon

    Notes
    -----
    Cook & Torrance 1982: F G D / (4 n.i n.o), GGX, F at the angle between view and half vector.
    """
    ### BEGIN SOLUTION
    normal, view, to_light = (np.asarray(v, dtype=float) for v in (normal, view, to_light))
    cos_i, cos_o = fw.arrays.dot(normal, to_light), fw.arrays.dot(normal, view)
    half = fw.normalize(view + to_light)
    # From the sine: where the cosine is all but 1, single-precision vectors would lose a narrow lobe's shape.
    sin2 = np.minimum(np.sum(np.cross(normal, half) ** 2, axis=-1), 1.0)
    density = ndf_ggx(np.sqrt(1.0 - sin2), alpha)
    visible = masking_shadowing(cos_i, cos_o, alpha)
    above = (cos_i > 0.0) & (cos_o > 0.0)
    slopes = 4.0 * np.clip(cos_i, 1e-30, 1.0) * np.clip(cos_o, 1e-30, 1.0)
    scale = np.where(above, density * visible / slopes, 0.0)
    r0 = np.asarray(r0, dtype=float) * np.ones(3)
    return scale[..., None] * fresnel_schlick(r0, fw.arrays.dot(view, half)[..., None])
    ### END SOLUTION


# %% nbgrader={"grade_id": "monte_carlo_shade", "solution": true}
def monte_carlo_shade(env, normal, view, r0, alpha, samples, rng):
    """Light that a rough mirror reflects to the viewer, without shadows: the slow general answer.

    Parameters
    ----------
    env : framework.Environment
    normal, view : (N, 3) float            unit vectors
    r0 : float, (3,) or (N, 3) float       reflectance at normal incidence
    alpha : float or (N,) float            width, roughness squared
    samples : int                          directions for each point
    rng : numpy.random.Generator

    Returns
    -------
    (N, 3) float               radiance, right on average; 0 where the view is at or below the horizon

    Notes
    -----
    The estimator is mean(L f (n.l) / density). Half vectors from `fw.sample_ggx` make the weight
    F G (v.h) / (n.v n.h), which is right, but noisy at grazing angles. Here they come from the normals that the
    viewer sees (Dupuy & Benyoub 2023): the weight is F G2 / G1, never above 1.
    """
    ### BEGIN SOLUTION
    normal, view = np.broadcast_arrays(np.asarray(normal, dtype=float), np.asarray(view, dtype=float))
    shape = normal.shape
    normal, view = normal.reshape(-1, 3), view.reshape(-1, 3)
    r0 = np.broadcast_to(np.asarray(r0, dtype=float), shape).reshape(-1, 3)
    alpha = np.broadcast_to(np.maximum(alpha, 1e-4), shape[:-1]).reshape(-1)

    def shade(n, v, r0, a, xi):
        tangent, bitangent = fw.orthonormal_frame(n)
        axes = np.stack([tangent, bitangent, n], axis=1)
        v = np.einsum("nij,nj->ni", axes, v)[:, None]
        a = a[:, None]
        flatten = np.stack([a, a, np.ones_like(a)], axis=-1)
        # Microfacets are the normals of a squashed sphere: stretch it, sample the cap that the view sees, squash.
        v_round = fw.normalize(v * flatten)
        z = 1.0 - xi[..., 1] * (1.0 + v_round[..., 2])
        radius, phi = np.sqrt(np.maximum(1.0 - z * z, 0.0)), 2.0 * np.pi * xi[..., 0]
        cap = np.stack([radius * np.cos(phi), radius * np.sin(phi), z], axis=-1)
        h = fw.normalize((cap + v_round) * flatten)
        v_h = fw.arrays.dot(v, h)
        l = 2.0 * v_h[..., None] * h - v
        cos_i, cos_o = l[..., 2], v[..., 2]
        weight = masking_shadowing(cos_i, cos_o, a) / masking_shadowing(np.ones_like(cos_o), cos_o, a)
        radiance = env.radiance(np.einsum("nsi,nij->nsj", l, axes).reshape(-1, 3)).reshape(l.shape)
        return (weight[..., None] * radiance * fresnel_schlick(r0[:, None], v_h[..., None])).mean(axis=1)

    lit = np.flatnonzero(fw.arrays.dot(normal, view) > 0.0)
    color = np.zeros(normal.shape)
    batch = max(1, 65536 // samples)
    for some in (lit[start : start + batch] for start in range(0, len(lit), batch)):
        xi = rng.random((len(some), samples, 2))
        color[some] = shade(normal[some], view[some], r0[some], alpha[some], xi)
    return color.reshape(shape)
    ### END SOLUTION


# %% nbgrader={"grade_id": "brdf_lut", "solution": true}
def brdf_lut(size, samples):
    """The second half of the split sum: reflection under a white sky, as scale and bias of r0.

    Parameters
    ----------
    size : int                 rows (roughness) and columns (cosine of the view), sampled at (i + 0.5) / size
    samples : int              directions for each entry

    Returns
    -------
    (size, size, 2) float      scale and bias: white-sky reflection = r0 scale + bias

    Notes
    -----
    Karis 2013. Samples are those of `monte_carlo_shade`, spread evenly: at 1024 the error is below 2e-3.
    """
    ### BEGIN SOLUTION
    centers = (np.arange(size) + 0.5) / size
    points = fw.hammersley(samples) + 0.5 / samples
    cos_phi, u = np.cos(2.0 * np.pi * points[:, 0]), points[:, 1]
    v_z = centers[:, None]
    v_x = np.sqrt((1.0 - v_z) * (1.0 + v_z))
    lut = np.empty((size, size, 2))
    for row, alpha in enumerate(centers**2):
        length = np.hypot(alpha * v_x, v_z)
        round_x, round_z = alpha * v_x / length, v_z / length
        z = 1.0 - u * (1.0 + round_z)
        radius = np.sqrt(np.maximum(1.0 - z * z, 0.0))
        # The cap around the view, which lies in the plane y = 0; of y only its square matters.
        h_x, h_z = alpha * (radius * cos_phi + round_x), z + round_z
        h_y2 = (alpha * radius) ** 2 * (1.0 - cos_phi**2)
        v_h = (v_x * h_x + v_z * h_z) / np.sqrt(h_x**2 + h_y2 + h_z**2)
        cos_i = 2.0 * v_h * h_z / np.sqrt(h_x**2 + h_y2 + h_z**2) - v_z
        weight = masking_shadowing(cos_i, v_z, alpha) / masking_shadowing(1.0, v_z, alpha)
        schlick = fresnel_schlick(0.0, v_h)
        lut[row, :, 0] = (weight * (1.0 - schlick)).mean(axis=1)
        lut[row, :, 1] = (weight * schlick).mean(axis=1)
    return lut
    ### END SOLUTION


# %% nbgrader={"grade_id": "sample_lut", "solution": true}
def sample_lut(lut, cos_theta, roughness):
    """Look the table up between its entries.

    Parameters
    ----------
    lut : (rows, columns, 2) float   sampled at (i + 0.5) / size: rows by roughness, columns by cosine
    cos_theta : (...) float          cosine of the view, in [0, 1]
    roughness : (...) float          in [0, 1]

    Returns
    -------
    (..., 2) float                   bilinear; beyond the outermost centres their values
    """
    ### BEGIN SOLUTION
    lut = np.asarray(lut, dtype=float)

    def neighbours(x, count):
        position = np.clip(np.asarray(x, dtype=float) * count - 0.5, 0.0, count - 1.0)
        first = np.minimum(position.astype(int), max(count - 2, 0))
        return first, np.minimum(first + 1, count - 1), (position - first)[..., None]

    cos_theta, roughness = np.broadcast_arrays(cos_theta, roughness)
    top, bottom, down = neighbours(roughness, lut.shape[0])
    left, right, across = neighbours(cos_theta, lut.shape[1])
    upper = (1.0 - across) * lut[top, left] + across * lut[top, right]
    lower = (1.0 - across) * lut[bottom, left] + across * lut[bottom, right]
    return (1.0 - down) * upper + down * lower
    ### END SOLUTION


# %% nbgrader={"grade_id": "shade_split_sum", "solution": true}
def shade_split_sum(normal, view, r0, roughness, prefiltered, lut):
    """Light that a rough mirror reflects to the viewer, without shadows: two look-ups.

    Parameters
    ----------
    normal, view : (N, 3) float            unit vectors
    r0 : float, (3,) or (N, 3) float       reflectance at normal incidence
    roughness : float or (N,) float        in [0, 1]
    prefiltered : callable                 (N, 3) directions, (N,) roughnesses -> (N, 3) radiance
    lut : (size, size, 2) float            as from `brdf_lut`

    Returns
    -------
    (N, 3) float               radiance; 0 where the view is at or below the horizon
    """
    ### BEGIN SOLUTION
    normal, view = np.broadcast_arrays(np.asarray(normal, dtype=float), np.asarray(view, dtype=float))
    shape = normal.shape
    cos_o = fw.arrays.dot(normal, view)
    lit = cos_o > 0.0
    color = np.zeros(shape)
    if lit.any():
        roughness = np.broadcast_to(np.asarray(roughness, dtype=float), shape[:-1])[lit]
        r0 = np.broadcast_to(np.asarray(r0, dtype=float), shape)[lit]
        scale, bias = np.moveaxis(sample_lut(lut, cos_o[lit], roughness), -1, 0)[..., None]
        color[lit] = prefiltered(fw.reflect(view[lit], normal[lit]), roughness) * (r0 * scale + bias)
    return color
    ### END SOLUTION
