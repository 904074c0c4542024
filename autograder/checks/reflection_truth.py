"""What rough mirrors reflect, in float64: closed forms and quadrature that the checks of the split sum measure with."""

import numpy as np

from framework.arrays import dot, normalize, orthonormal_frame


def schlick(r0, cosine):
    """Schlick's Fresnel term, at cosines in [0, 1]."""
    return r0 + (1 - np.asarray(r0)) * (1 - np.asarray(cosine)) ** 5


def ggx(tan, alpha):
    """GGX by the tangent of the tilt: nothing cancels, however narrow the lobe."""
    return (1 + tan**2) ** 2 / (np.pi * alpha**2 * (1 + (tan / alpha) ** 2) ** 2)


def beckmann(tan, alpha):
    """Beckmann by the tangent of the tilt."""
    return (1 + tan**2) ** 2 * np.exp(-((tan / alpha) ** 2)) / (np.pi * alpha**2)


def smith(cos_i, cos_o, alpha):
    """Height-correlated Smith G2 of GGX, from its Lambda; cosines above 0."""

    def masked(cosine):
        return (np.sqrt(1 + alpha**2 * (1 - cosine**2) / cosine**2) - 1) / 2

    return 1 / (1 + masked(cos_i) + masked(cos_o))


def brdf(normal, view, to_light, r0, alpha):
    """F G D / (4 n.i n.o): (..., 3); both directions above the horizon."""
    half = normalize(view + to_light)
    tan = np.linalg.norm(np.cross(normal, half), axis=-1) / dot(normal, half)
    cos_i, cos_o = dot(normal, to_light), dot(normal, view)
    scale = ggx(tan, alpha) * smith(cos_i, cos_o, alpha) / (4 * cos_i * cos_o)
    return scale[..., None] * schlick(r0, dot(view, half)[..., None])


def reflected(env, normal, view, r0, alpha, rows=48, columns=96):
    """Light that points reflect, and how single samples of it scatter that are drawn by the cosine of the light.

    Gauss-Legendre over the cosine, even steps around: the integrand ends smoothly at the horizon. For lobes that
    the grid resolves: alpha of 0.3 and more.

    Returns
    -------
    mean, variance : (N, 3) float
    """
    x, w = np.polynomial.legendre.leggauss(rows)
    cosine, weight = 0.5 + 0.5 * x, w * np.pi / columns
    phi, sine = 2 * np.pi * (np.arange(columns) + 0.5) / columns, np.sqrt(1 - cosine**2)
    local = np.stack(
        [np.outer(sine, np.cos(phi)), np.outer(sine, np.sin(phi)), np.outer(cosine, np.ones(columns))]
    )
    axes = np.stack([*orthonormal_frame(normal), normal], axis=1)
    light = np.einsum("krc,nki->nrci", local, axes)
    each = [v[:, None, None] for v in (normal, view, r0)]
    sent = brdf(each[0], each[1], light, each[2], alpha[:, None, None])
    sent *= env.radiance(light.reshape(-1, 3)).reshape(light.shape)
    mean = np.einsum("r,nrck->nk", weight * cosine, sent)
    square = np.einsum("r,nrck->nk", np.pi * weight * cosine, sent**2)
    return mean, np.maximum(square - mean**2, 0)


def table(size):
    """The scale on r0 and the bias, (size, size, 2), by quadrature over the normals that the view sees.

    These cover a spherical cap evenly once the lobe is stretched to a sphere (Dupuy & Benyoub 2023); what is left is
    G2 / G1, bounded. A Fibonacci lattice, because the horizon may lie along a row of any grid: it errs by less than 1e-3.
    """
    at_centers = (np.arange(size) + 0.5) / size
    count, turn = 6765, 4181
    u = (np.arange(count) + 0.5) / count
    cos_phi = np.cos(2 * np.pi * (np.arange(count) * turn % count + 0.5) / count)
    cos_o = at_centers[:, None]
    sin_o = np.sqrt(1 - cos_o**2)
    result = np.empty((size, size, 2))
    for row, alpha in enumerate(at_centers**2):
        length = np.hypot(alpha * sin_o, cos_o)
        top_x, top_z = alpha * sin_o / length, cos_o / length
        z = 1 - u * (1 + top_z)
        radius = np.sqrt(1 - z**2)
        x, y = alpha * (radius * cos_phi + top_x), alpha * radius * np.sqrt(1 - cos_phi**2)
        scale = 1 / np.sqrt(x**2 + y**2 + (z + top_z) ** 2)
        cos_h = (z + top_z) * scale
        v_h = np.clip(sin_o * x * scale + cos_o * cos_h, 0, 1)
        cos_i = 2 * v_h * cos_h - cos_o
        lit = np.clip(cos_i, 1e-9, 1)
        weight = np.where(cos_i > 0, smith(lit, cos_o, alpha) / smith(1.0, cos_o, alpha), 0)
        result[row] = np.stack(
            [(weight * s).mean(axis=1) for s in (1 - (1 - v_h) ** 5, (1 - v_h) ** 5)], axis=-1
        )
    return result


def bilinear(lut, cosine, roughness):
    """A table between its cell centres (i + 0.5) / size, level beyond the outermost: (..., 2)."""
    rows, columns = (_hats(x, size) for x, size in zip((roughness, cosine), lut.shape, strict=False))
    return np.einsum("...r,...c,rck->...k", rows, columns, lut)


def _hats(x, size):
    """What every cell adds at x: a hat of width 2 about its centre."""
    place = np.clip(np.asarray(x, float) * size - 0.5, 0, size - 1)
    return np.maximum(1 - np.abs(place[..., None] - np.arange(size)), 0)
