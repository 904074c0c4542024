"""Maps for the checks of prefiltering, and what they should be filtered to: sums over all of their pixels."""

import numpy as np

from framework.environment import Environment, pixel_directions, pixel_solid_angles


def map_shape(height):
    """The shape of a map of this height."""
    return (int(height), 2 * int(height), 3)


def soft_lights(rng, height):
    """Soft coloured lights over a dim ground, turned at random: each wider than two pixels of the map."""
    turn, shift = rng.uniform(0, 2 * np.pi), rng.uniform(-0.08, 0.08, (5, 2))
    elevation = np.array([1.1, 0.35, 0.0, -0.5, -0.9]) + shift[:, 0]
    azimuth = np.array([0.5, 2.0, 4.4, 0.9, 3.3]) + shift[:, 1] + turn
    axes = np.stack([np.cos(elevation) * np.sin(azimuth), np.sin(elevation), -np.cos(elevation) * np.cos(azimuth)])
    colors = np.array([[1.0, 1.2, 1.6], [2.6, 1.8, 0.9], [0.4, 1.6, 0.6], [0.9, 0.3, 0.2], [0.3, 0.5, 1.4]])
    falloff = np.exp(np.array([6.0, 14.0, 10.0, 8.0, 8.0]) * (pixel_directions(height) @ axes - 1.0))
    return Environment(0.15 + falloff @ colors)


def filtered(env, alpha, height):
    """The truth: a sum over all pixels of the map. At alpha = 1 the lobe is the clamped cosine."""
    cosine = pixel_directions(height).reshape(-1, 3) @ pixel_directions(env.height).reshape(-1, 3).T
    sin2 = 0.5 - 0.5 * cosine  # of the half vector
    lobe = np.maximum(cosine, 0.0) / (alpha**2 * (1 - sin2) + sin2) ** 2 * pixel_solid_angles(env.height).reshape(-1)
    return (lobe @ env.pixels.reshape(-1, 3) / lobe.sum(axis=1, keepdims=True)).reshape(map_shape(height))


def looked_up(env, height):
    """A map at the centres of another's pixels."""
    return env.radiance(pixel_directions(height))


def between(chain, levels, direction, roughness):
    """The truth of a chain's look-up, level by level."""
    values = np.stack([Environment(pixels).radiance(direction) for pixels in chain])
    upper = np.clip(np.searchsorted(levels, roughness), 1, len(levels) - 1)
    t = np.clip((roughness - levels[upper - 1]) / (levels[upper] - levels[upper - 1]), 0.0, 1.0)[:, None]
    each = np.arange(len(direction))
    return (1 - t) * values[upper - 1, each] + t * values[upper, each]


def split(f, g, weights):
    """The mean of f over g's support, times the integral of g."""
    support = g != 0
    return np.sum((f * weights)[support]) / np.sum(weights[support]) * np.sum(g * weights)


def random_directions(rng, count):
    """Directions all around, evenly."""
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)
