"""What rough mirrors reflect: under a white sky, as a table, and under the photographed one, on a row of spheres."""

import numpy as np

from autograder.references.filtered import clamped_sky
from solutions import truth
from solutions.split_sum import brdf_lut, monte_carlo_shade

SAMPLES, SEEDS = 256, 16


def lut(spec):
    """scale on r0 in red, bias in green: rows by roughness, columns by n.v, at (i + 0.5) / size; 16384 samples"""
    table = brdf_lut(spec["size"], 16384)
    return np.concatenate([table, np.zeros_like(table[..., :1])], axis=-1)


def lut_truth(spec):
    """float64 quadrature: over half vectors, split where the horizon cuts the lobe"""
    center = (np.arange(spec["size"]) + 0.5) / spec["size"]
    table = [[[*truth.brdf_integral(mu, r * r, nodes=48), 0.0] for mu in center] for r in center]
    return np.array(table), 0.0


def spheres(spec):
    """radiance of spheres without shadows, roughness to the right and r0 downwards; quadrature over half vectors"""
    inside, normal, view = _sphere(spec)
    sky, up = clamped_sky(spec), np.array([0.0, 0.0, 1.0])
    image = np.zeros((len(spec["r0"]), len(spec["roughness"]), *inside.shape, 3))
    for column, roughness in enumerate(spec["roughness"]):
        # Schlick's term is linear in r0: two of them tell all.
        black, white = (
            np.array(
                [
                    truth.reflected_radiance(sky.radiance, n, up, r0, roughness**2, *spec["nodes"])[0]
                    for n in normal
                ]
            )
            for r0 in (0.0, 1.0)
        )
        for row, r0 in enumerate(spec["r0"]):
            image[row, column, inside] = (1 - r0) * black + r0 * white
    return _joined(image)


def spheres_truth(spec):
    """brute force: Monte Carlo of the rendering equation, 4096 samples a pixel"""
    inside, normal, view = _sphere(spec)
    sky = clamped_sky(spec)
    shape = (len(spec["r0"]), len(spec["roughness"]), *inside.shape, 3)
    image, variance = np.zeros(shape), np.zeros(shape)
    for column, roughness in enumerate(spec["roughness"]):
        for row, r0 in enumerate(spec["r0"]):
            each = [
                monte_carlo_shade(
                    sky, normal, view, r0, roughness**2, SAMPLES, np.random.default_rng((row, column, seed))
                )
                for seed in range(SEEDS)
            ]
            image[row, column, inside] = np.mean(each, axis=0)
            variance[row, column, inside] = np.var(each, axis=0, ddof=1) / SEEDS
    return _joined(image), float(np.sqrt(variance.mean()))


def _sphere(spec):
    """Where a sphere covers its square, seen from +z from far away, and normals and views there."""
    side = (2 * np.arange(spec["size"]) + 1) / spec["size"] - 1
    x, y = np.meshgrid(side, -side)
    inside = x * x + y * y < 0.98
    x, y = x[inside], y[inside]
    normal = np.stack([x, y, np.sqrt(1 - x * x - y * y)], axis=-1)
    return inside, normal, np.broadcast_to([0.0, 0.0, 1.0], normal.shape)


def _joined(image):
    """Tiles in rows and columns as one picture."""
    rows, columns, height, width, _ = image.shape
    return image.swapaxes(1, 2).reshape(rows * height, columns * width, 3)
