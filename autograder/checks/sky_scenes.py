"""Scenes and lights for the checks of environment shadows: distances and straight rays exact, light summed over rays."""

import numpy as np

from autograder.checks import reflection_truth as reflection
from framework.arrays import dot, normalize, orthonormal_frame
from framework.environment import Environment, pixel_directions, pixel_solid_angles
from framework.environment_light import EnvironmentLight

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
LEVELS = (0.0, 0.25, 0.4, 0.6, 0.8, 1.0)
# the least and greatest radiance of a sky's spots
SPOTS = (5.0, 9.0), (1.0, 3.0), (0.6, 2.0)
SUNNY = (9.0, 14.0), (0.5, 1.5), (0.3, 1.0)
SOFT = (1.5, 2.5), (1.0, 2.0), (0.6, 1.5)
_OFF = 1e-6


class Solids:
    """Balls and boxes on a floor at y = 0: distances to them, and which rays they stop, both exact."""

    def __init__(self, balls=(), boxes=()):
        self.balls = [(np.array(center, float), radius) for center, radius in balls]
        self.boxes = [(np.array(center, float), np.array(half, float)) for center, half in boxes]

    @classmethod
    def ball_and_box(cls, rng):
        radius, half = rng.uniform(0.4, 0.55), rng.uniform([0.25, 0.4, 0.25], [0.4, 0.7, 0.4])
        ball = rng.uniform(-0.9, -0.6), radius + rng.uniform(0.05, 0.3), rng.uniform(-0.3, 0.3)
        return cls([(ball, radius)], [((rng.uniform(0.5, 0.8), half[1], rng.uniform(-0.3, 0.3)), half)])

    def __call__(self, p):
        p = np.asarray(p, dtype=float)
        distances = [p[..., 1]]
        distances += [np.linalg.norm(p - center, axis=-1) - radius for center, radius in self.balls]
        for center, half in self.boxes:
            q = np.abs(p - center) - half
            distances.append(np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0))
        return np.min(distances, axis=0)

    def free(self, p, normal, direction, t_max):
        """Which rays from surface points (N, 3) in directions (N, M, 3) meet nothing within t_max: (N, M) bool."""
        origin = (p + _OFF * normal)[:, None]
        away = np.where(np.abs(direction) < 1e-12, 1e-12, direction)
        t = -origin[..., 1] / away[..., 1]
        stopped = (t > 0) & (t < t_max)
        for center, radius in self.balls:
            v = origin - center
            along = np.sum(v * direction, axis=-1)
            inner = along**2 - np.sum(v * v, axis=-1) + radius**2
            near = -along - np.sqrt(np.maximum(inner, 0))
            stopped |= (inner > 0) & (near > 0) & (near < t_max)
        for center, half in self.boxes:
            one, other = (center - half - origin) / away, (center + half - origin) / away
            first, last = np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)
            stopped |= (first < last) & (first > 0) & (first < t_max)
        return ~stopped

    def surface_points(self, rng, count):
        """Points and normals of the floor, the balls and the boxes' sides, away from edges and contacts."""
        n = 40 * count
        floor = np.insert(rng.uniform(-1.5, 1.5, (n, 2)), 1, 0.0, axis=1)
        parts = [(floor, np.broadcast_to([0.0, 1.0, 0.0], (n, 3)))] * 2
        for center, radius in self.balls:
            normal = normalize(rng.normal(size=(n, 3)))
            parts.append((center + radius * normal, normal))
        for center, half in self.boxes:
            axis = rng.choice([0, 2], n)
            normal = rng.choice([-1.0, 1.0], n)[:, None] * np.eye(3)[axis]
            parts.append(
                (center + half * np.where(normal != 0, normal, rng.uniform(-0.85, 0.85, (n, 3))), normal)
            )
        share = count // len(parts) + 1
        kept = []
        for p, normal in parts:
            # a step off its own surface leads away from it, unless something else is near
            good = np.flatnonzero((self(p + 0.08 * normal) > 0.07) & (np.abs(self(p)) < 1e-9))
            some = rng.permutation(good)[:share]
            kept.append((p[some], normal[some]))
        p, normal = (np.concatenate(part) for part in zip(*kept, strict=True))
        some = rng.permutation(len(p))[:count]
        return p[some], normal[some]

    def mirrors(self, rng, count, t_max):
        """Points, normals and views: something within t_max stands in the mirror direction of half of them."""
        p, normal = self.surface_points(rng, 10 * count)
        view = normalize(normal + 0.9 * normalize(rng.normal(size=normal.shape)))
        mirror = 2 * dot(normal, view)[:, None] * normal - view
        hidden = ~self.free(p, normal, mirror[:, None], t_max)[:, 0]
        steep = dot(normal, mirror) > 0.1
        first = np.flatnonzero(steep & hidden)[: count // 2]
        some = np.concatenate([first, np.flatnonzero(steep & ~hidden)[: count - len(first)]])
        return p[some], normal[some], view[some]


def around(normal, count):
    """Directions evenly spread by cosine above each normal: (N, count, 3)."""
    r2 = (np.arange(count) + 0.5) / count
    return _about(normal, np.sqrt(1 - r2))


def ambient(scene, p, normal, t_max, count=2048):
    """The free part of the cosine-weighted hemisphere, by `count` rays a point."""
    return scene.free(p, normal, around(normal, count), t_max).mean(axis=1)


def diffuse(env, scene, p, normal, t_max, count=2048):
    """The shadowed irradiance over pi, and the one without shadows, by `count` rays a point: (N, 3) each."""
    direction = around(normal, count)
    light = env.radiance(direction)
    free = scene.free(p, normal, direction, t_max)
    return np.mean(light * free[..., None], axis=1), light.mean(axis=1)


def specular(env, scene, p, normal, view, r0, roughness, t_max, count=1024):
    """Reflected light with shadows, by `count` half vectors a point that are spread like GGX: (N, 3)."""
    alpha2 = np.broadcast_to(np.asarray(roughness, float) ** 4, len(p))[:, None]
    u = (np.arange(count) + 0.5) / count
    half = _about(normal, np.sqrt((1 - u) / (1 + (alpha2 - 1) * u)))
    v_h, n_h = dot(half, view[:, None]), dot(half, normal[:, None])
    direction = 2 * v_h[..., None] * half - view[:, None]
    n_l, n_v = dot(direction, normal[:, None]), dot(normal, view)[:, None]
    lit = (n_l > 0) & (n_v > 0) & (v_h > 0)
    g = reflection.smith(np.where(lit, n_l, 1.0), np.where(lit, n_v, 1.0), np.sqrt(alpha2))
    weight = np.where(lit, g * v_h / np.where(lit, n_v * n_h, 1.0), 0.0)
    lit &= scene.free(p, normal, direction, t_max)
    r0 = np.broadcast_to(np.asarray(r0, float), p.shape)[:, None]
    fresnel = r0 + (1 - r0) * ((1 - np.clip(v_h, 0, 1)) ** 5)[..., None]
    return np.mean((weight * lit)[..., None] * fresnel * env.radiance(direction), axis=1)


def split_sum(light, normal, view, r0, roughness):
    """The split sum without shadows: (N, 3), 0 where n.v <= 0."""
    cosine = dot(normal, view)
    pair = reflection.bilinear(light.lut, np.clip(cosine, 0, 1), np.broadcast_to(roughness, cosine.shape))
    mirror = 2 * cosine[:, None] * normal - view
    color = light.prefiltered(mirror, roughness) * (r0 * pair[..., :1] + pair[..., 1:])
    return np.where(cosine[:, None] > 0, color, 0.0)


def sky(rng, height, spots=SPOTS, spread=20.0):
    """A dim coloured gradient with soft spots, the first high up: `spots` are their least and greatest radiance."""
    d = pixel_directions(height)
    pixels = rng.uniform(0.1, 0.4, 3) + (1 + d[..., 1:2]) * rng.uniform(0.05, 0.2, 3)
    for i, (low, high) in enumerate(spots):
        turn, up = rng.uniform(0, 2 * np.pi), rng.uniform(0.7, 1.0) if i == 0 else rng.uniform(0.2, 1.2)
        toward = np.array([np.cos(up) * np.sin(turn), np.sin(up), np.cos(up) * np.cos(turn)])
        color = rng.uniform(0.5, 1, 3) * rng.uniform(low, high)
        pixels = pixels + color * np.exp(spread * (d @ toward - 1))[..., None]
    return Environment(pixels)


def light_of(env):
    """The environment, filtered at its own size, as `framework.EnvironmentLight`: sums over a finer grid."""
    height, fine = env.height, 32
    out, d = pixel_directions(height).reshape(-1, 3), pixel_directions(fine).reshape(-1, 3)
    weighted = env.radiance(d) * pixel_solid_angles(fine).reshape(-1, 1)
    cosine = np.maximum(out @ d.T, 0)
    shape = (height, 2 * height, 3)
    irradiance = (cosine @ weighted) / (cosine @ pixel_solid_angles(fine).reshape(-1, 1))
    chain = [env.pixels]
    for level in LEVELS[1:]:
        # seen from straight above, the density over l is D(h) / 4; constants cancel
        kernel = cosine / (1 + (level**4 - 1) * (1 + cosine) / 2) ** 2
        total = kernel @ pixel_solid_angles(fine).reshape(-1, 1)
        chain.append(((kernel @ weighted) / total).reshape(shape))
    return EnvironmentLight(env, irradiance.reshape(shape), chain, LEVELS, reflection.table(16))


def _about(normal, cosine):
    """Directions at these cosines to each normal, (M,) or (N, M), turned on by the golden angle: (N, M, 3)."""
    cosine = np.broadcast_to(cosine, (len(normal), cosine.shape[-1]))
    sine, phi = np.sqrt(1 - cosine**2), np.arange(cosine.shape[-1]) * np.pi * (3 - np.sqrt(5))
    tangent, bitangent = orthonormal_frame(normal)
    side = np.cos(phi)[:, None] * tangent[:, None] + np.sin(phi)[:, None] * bitangent[:, None]
    return sine[..., None] * side + cosine[..., None] * normal[:, None]
