"""What the checks of the split sum look at: points, directions, a ball to paint, and a small sky."""

import numpy as np

from framework.arrays import dot, normalize, orthonormal_frame

PIXELS = 40


def logarithmic(rng, low, high, count):
    """Numbers drawn evenly by their logarithm."""
    return np.exp(rng.uniform(np.log(low), np.log(high), count))


def tilted(rng, normal, cosine):
    """Unit vectors at these cosines to the normals, in random directions around them."""
    x, y = orthonormal_frame(normal)
    phi = rng.uniform(0, 2 * np.pi, len(normal))[:, None]
    cosine = np.asarray(cosine, float)[:, None]
    return cosine * normal + np.sqrt(1 - cosine**2) * (np.cos(phi) * x + np.sin(phi) * y)


def above(rng, count):
    """Normals, and two directions above the horizon of each."""
    normal = normalize(rng.normal(size=(count, 3)))
    return normal, *(tilted(rng, normal, rng.uniform(0.05, 0.98, count)) for _ in range(2))


def near_the_mirror(rng, normal, view, alpha):
    """Lights whose half vectors are tilted by up to two widths."""
    tan = alpha * rng.uniform(0.2, 2, len(alpha))
    half = tilted(rng, normal, 1 / np.sqrt(1 + tan**2))
    return normalize(2 * dot(view, half)[:, None] * half - view)


def sky(rng):
    """A smooth map of 16 rows: pixels and what is between them give the same integrals within 1 %."""
    from framework.environment import Environment, pixel_directions

    towards = normalize(rng.normal(size=(3, 3)))
    shine = np.exp(3 * (pixel_directions(16) @ towards.T - 1))
    return Environment(0.1 + shine @ rng.uniform(0.2, 2, (3, 3)))


def _disc(pixels):
    x, y = np.meshgrid(*2 * [(np.arange(pixels) + 0.5) / pixels * 2 - 1])
    return x, -y, x**2 + y**2 < 0.98


def sphere(pixels=PIXELS):
    """Normals and views of a ball that fills a square picture, seen from far away."""
    x, y, mask = _disc(pixels)
    x, y = x[mask], y[mask]
    normal = np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=1)
    return normal, np.tile([0.0, 0.0, 1.0], (len(normal), 1))


def image(color, pixels=PIXELS):
    """The picture of such a ball, black around it: (pixels, pixels, 3)."""
    picture, mask = np.zeros((pixels, pixels, 3)), _disc(pixels)[2]
    picture[mask] = color
    return picture
