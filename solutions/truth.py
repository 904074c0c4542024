"""Independent truths of the split sum: float64 quadrature that shares no code with the solutions.

Everything is integrated over half vectors about the normal, in polar coordinates: theta is their tilt, u the
share of the projected normals tilted less, phi the azimuth from the viewer's side. Then D (n.h) dh is
du dphi / (2 pi), and the reflected direction covers dl = 4 (v.h) dh.
"""

import numpy as np


def brdf_integral(mu, alpha, ndf="ggx", nodes=128):
    """Reflection under a white sky, as scale and bias of r0.

    Parameters
    ----------
    mu : float in (0, 1]        cosine of the view
    alpha : float > 0           width
    ndf : "ggx" or "beckmann"   with its own height-correlated Smith term
    nodes : int                 Gauss-Legendre nodes along each axis of each of the two patches

    Returns
    -------
    (2,) float                  scale and bias
    """
    x, w = np.polynomial.legendre.leggauss(nodes)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    total = np.zeros(2)
    for cos_h, sin_h, phi, weight in _patches(mu, alpha, ndf, (x, w), (x, w)):
        v_h = mu * cos_h + np.sqrt(1.0 - mu * mu) * sin_h * np.cos(phi)
        cos_i = 2.0 * v_h * cos_h - mu
        density = weight * _smith(cos_i, mu, alpha, ndf) * np.maximum(v_h, 0.0) / (cos_h * mu)
        schlick = np.clip(1.0 - v_h, 0.0, 1.0) ** 5
        total += (density * (1.0 - schlick)).sum(), (density * schlick).sum()
    return total


def reflected_radiance(radiance, normal, view, r0, alpha, rows=256, columns=512):
    """Light that a rough mirror of GGX reflects to the viewer, without shadows, and how its samples scatter.

    Parameters
    ----------
    radiance : callable         (M, 3) directions -> (M, 3)
    normal, view : (3,) float   unit
    r0 : float or (3,) float    reflectance at normal incidence
    alpha : float > 0           width
    rows, columns : int         midpoints in tilt and azimuth, for each of the two patches

    Returns
    -------
    mean : (3,) float           the rendering equation's integral
    variance : (3,) float       of one sample whose half vector has the density of the visible normals
    """
    normal, view = np.asarray(normal, float), np.asarray(view, float)
    mu = float(np.clip(normal @ view, 0.0, 1.0))
    mean, square = np.zeros(3), np.zeros(3)
    if mu == 0.0:
        return mean, square
    tangent = view - mu * normal
    if np.linalg.norm(tangent) < 1e-9:
        tangent = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    tangent /= np.linalg.norm(tangent)
    bitangent = np.cross(normal, tangent)
    middle = [((np.arange(count) + 0.5) / count, np.full(count, 1.0 / count)) for count in (rows, columns)]
    for cos_h, sin_h, phi, weight in _patches(mu, alpha, "ggx", *middle):
        half = np.multiply.outer(sin_h * np.cos(phi), tangent) + np.multiply.outer(
            sin_h * np.sin(phi), bitangent
        )
        half += cos_h[..., None] * normal
        v_h = half @ view
        light = 2.0 * v_h[..., None] * half - view
        smith = _smith(light @ normal, mu, alpha, "ggx")
        masked = 1.0 / (1.0 + _lambda(np.asarray(mu), alpha, "ggx"))
        schlick = np.clip(1.0 - v_h, 0.0, 1.0)[..., None] ** 5
        color = (r0 + np.subtract(1.0, r0) * schlick) * radiance(light.reshape(-1, 3)).reshape(light.shape)
        seen = weight * np.maximum(v_h, 0.0) / (cos_h * mu)
        mean += np.einsum("rc,rck->k", smith * seen, color)
        square += np.einsum("rc,rck->k", smith**2 / masked * seen, color**2)
    return mean, np.maximum(square - mean**2, 0.0)


def _patches(mu, alpha, ndf, rows, columns):
    """Half vectors whose reflection is above the horizon, in two patches: cos_h, sin_h, phi, du dphi / (2 pi).

    The horizon cuts the lobe along a curve, where integrands have a kink: up to the first tilt no azimuth is
    cut, past the last one all are. `rows` and `columns` are nodes and weights on [0, 1].
    """
    view = np.arccos(mu)
    edges = [_depth(theta, alpha, ndf) for theta in (0.0, np.pi / 4 - view / 2, np.pi / 4 + view / 2)]
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        # Closer at both ends: there the arc of azimuths opens and shuts like a square root.
        x, w = rows
        x, w = x * x * (3.0 - 2.0 * x), 6.0 * w * x * (1.0 - x)
        depth = (low + (high - low) * x)[:, None]
        du = (high - low) * w[:, None] * np.exp(-depth)
        tan = alpha * np.sqrt(np.expm1(depth) if ndf == "ggx" else depth)
        cos_h = 1.0 / np.sqrt(1.0 + tan * tan)
        sin_h = tan * cos_h
        # The reflection meets the horizon where 2 (v.h) (n.h) = n.v.
        across = 2.0 * np.sqrt(1.0 - mu * mu) * sin_h * cos_h
        last = np.arccos(np.clip(mu * (sin_h**2 - cos_h**2) / np.maximum(across, 1e-300), -1.0, 1.0))
        phi = last * (2.0 * columns[0] - 1.0)
        yield cos_h, sin_h, phi, du * last * columns[1] / np.pi


def _depth(theta, alpha, ndf):
    """-log(1 - u) at a tilt: even steps in it resolve the core of the lobe and its far tail alike."""
    ratio2 = (np.tan(theta) / alpha) ** 2
    return np.log1p(ratio2) if ndf == "ggx" else min(ratio2, 40.0)


def _smith(cos_i, mu, alpha, ndf):
    """Height-correlated Smith G2; 0 where cos_i is at or below 0."""
    lit = cos_i > 0.0
    both = _lambda(np.where(lit, cos_i, 1.0), alpha, ndf) + _lambda(np.asarray(mu), alpha, ndf)
    return np.where(lit, 1.0 / (1.0 + both), 0.0)


def _lambda(cosine, alpha, ndf):
    sine = np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0))
    if ndf == "ggx":
        return 0.5 * (np.sqrt(1.0 + (alpha * sine / cosine) ** 2) - 1.0)
    a = np.minimum(cosine / np.maximum(alpha * sine, 1e-300), 40.0)
    return 0.5 * (np.exp(-a * a) / (a * np.sqrt(np.pi)) - _erfc(a))


_CRAIG = np.polynomial.legendre.leggauss(60)


def _erfc(a):
    """Complementary error function for a > 0: Craig's integral, a mean over angles that never cancels."""
    angle = 0.25 * np.pi * (_CRAIG[0] + 1.0)
    return np.exp(-((a[..., None] / np.sin(angle)) ** 2)) @ _CRAIG[1] * 0.5
