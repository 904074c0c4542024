"""Independent truths of filtered environments: float64 sums over all of the map, no samples."""

import numpy as np


def filtered_radiance(pixels, direction, alpha, oversample=1):
    """Radiance under the GGX lobe of n = v = r, weighted by n.l and normalised.

    Parameters
    ----------
    pixels : (H, 2H, 3) float   latitude-longitude map
    direction : (..., 3) float  unit, where the lobes point
    alpha : float > 0           width; at 1 the lobe is the clamped cosine
    oversample : int            1: pixels as they are, with their exact solid angles. s: the bilinear interpolant, on
                                s x s parts of each pixel; needed where the lobe is narrower than a pixel

    Returns
    -------
    (..., 3) float
    """

    def kernel(lobe, around):
        # From the chord: 1 - n.l would cancel in a narrow lobe. sin^2 of the half vector's tilt is a quarter of it.
        chord2 = np.maximum(2.0 - 2.0 * lobe @ around.T, 0.0)
        near = np.argwhere(chord2 < 1e-4)
        chord2[near[:, 0], near[:, 1]] = ((lobe[near[:, 0]] - around[near[:, 1]]) ** 2).sum(axis=1)
        sin2 = 0.25 * chord2
        return np.maximum(1.0 - 2.0 * sin2, 0.0) * (alpha / (alpha**2 * (1.0 - sin2) + sin2)) ** 2

    return _mean_under(kernel, pixels, direction, oversample)


def cosine_weighted_radiance(pixels, direction, oversample=1):
    """Irradiance over pi around normals: the mean radiance weighted by the clamped cosine, (..., 3)."""
    return _mean_under(lambda n, d: np.maximum(n @ d.T, 0.0), pixels, direction, oversample)


def bilinear(pixels, direction):
    """Value of a map between its pixel centres, (..., 3): columns wrap, rows go on over the poles."""
    height, width = pixels.shape[:2]
    x, y, z = np.moveaxis(direction, -1, 0)
    v = np.arctan2(np.hypot(x, z), y) / np.pi * height - 0.5
    u = np.arctan2(x, -z) / (2.0 * np.pi) * width - 0.5
    # A frame of one pixel on all sides leaves no special case inside.
    framed = np.concatenate(
        [np.roll(pixels[:1], height, axis=1), pixels, np.roll(pixels[-1:], height, axis=1)]
    )
    framed = np.concatenate([framed, framed[:, :1]], axis=1)
    row, column = np.floor(v).astype(int), np.floor(u).astype(int)
    down, right = (v - row)[..., None], (u - column)[..., None]
    row, column = row + 1, column % width
    upper = (1 - right) * framed[row, column] + right * framed[row, column + 1]
    lower = (1 - right) * framed[row + 1, column] + right * framed[row + 1, column + 1]
    return (1 - down) * upper + down * lower


def sphere_grid(height):
    """Directions through the pixel centres of a map, (height, 2 height, 3), and exact solid angles."""
    edges = np.pi * np.arange(height + 1) / height
    theta, phi = 0.5 * (edges[1:] + edges[:-1])[:, None], np.pi * (np.arange(2 * height) + 0.5) / height
    d = np.stack(
        np.broadcast_arrays(np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)), -1
    )
    return d, np.repeat(
        ((np.cos(edges[:-1]) - np.cos(edges[1:])) * np.pi / height)[:, None], 2 * height, axis=1
    )


def _mean_under(kernel, pixels, direction, oversample):
    pixels, direction = np.asarray(pixels, dtype=float), np.asarray(direction, dtype=float)
    around, solid_angle = sphere_grid(len(pixels) * oversample)
    light = bilinear(pixels, around) if oversample > 1 else pixels
    around, solid_angle = around.reshape(-1, 3), solid_angle.reshape(-1, 1)
    # The last column sums the weights themselves.
    light = np.concatenate([light.reshape(-1, 3), np.ones_like(solid_angle)], axis=1) * solid_angle
    lobes = direction.reshape(-1, 3)
    total = np.zeros((len(lobes), 4))
    for i in range(0, len(lobes), 64):
        for j in range(0, len(around), 16384):
            total[i : i + 64] += kernel(lobes[i : i + 64], around[j : j + 16384]) @ light[j : j + 16384]
    return (total[:, :3] / total[:, 3:]).reshape(direction.shape)
