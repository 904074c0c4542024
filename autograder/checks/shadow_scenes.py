"""Scenes for the shadow checks: distances, straight rays and sampled light, all exact or as good as that."""

import numpy as np

MARCH = (0.02, 8.0, 256)
PIXELS = 24


class Scene:
    """Balls and boxes, turned about an axis: distances to them, and which rays they stop, both exact."""

    def __init__(self, balls=(), boxes=(), frame=None):
        self._balls, self._boxes = balls, boxes
        self._frame = np.eye(3) if frame is None else frame

    @classmethod
    def ball_and_box(cls, rng):
        radius, half = rng.uniform(0.45, 0.65), rng.uniform([0.3, 0.4, 0.3], [0.5, 0.7, 0.5])
        ball = [rng.uniform(-1.1, -0.7), radius + rng.uniform(0.1, 0.5), rng.uniform(-0.3, 0.3)]
        box = [rng.uniform(0.6, 0.9), half[1] + rng.uniform(0, 0.3), rng.uniform(-0.3, 0.3)]
        return cls([(np.array(ball), radius)], [(np.array(box), half)], _turn(rng))

    @classmethod
    def ball(cls, rng):
        radius = rng.uniform(0.5, 0.7)
        center = np.array([0, radius + rng.uniform(0.3, 0.9), 0])
        return cls([(center, radius)]), center

    @classmethod
    def large_box(cls, rng):
        half = rng.uniform([1.0, 0.8, 1.0], [1.4, 1.2, 1.4])
        return cls([], [(np.array([0, half[1] + rng.uniform(0.1, 0.3), 0]), half)], _turn(rng))

    @classmethod
    def wall(cls, rng, radius):
        """A thick wall, the direction past its edge, and points across: from hidden over the edge to free."""
        frame, near = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.uniform(1.5, 3)
        across = np.linspace(-1.8, 1.8, 33) * radius * (near + 0.5)
        points = np.stack([across, rng.uniform(-1, 1, 33), np.zeros(33)], axis=-1)
        box = np.array([-10, 0, near + 0.5]), np.array([10, 20, 0.5])
        return cls([], [box], frame), frame[2].copy(), points @ frame

    def __call__(self, p):
        p = np.asarray(p, dtype=float) @ self._frame.T
        distances = [np.linalg.norm(p - center, axis=-1) - radius for center, radius in self._balls]
        for center, half in self._boxes:
            q = np.abs(p - center) - half
            distances.append(np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0))
        return np.min(distances, axis=0)

    def stops(self, origin, direction, grown=0.0):
        """Whether the ray from each origin in each direction meets an object within the march: (N, M) bool."""
        origin, direction = origin @ self._frame.T, direction @ self._frame.T
        stopped = np.zeros((len(origin), len(direction)), dtype=bool)
        for center, radius in self._balls:
            v = origin - center
            along = v @ direction.T
            inner = along**2 - np.sum(v * v, axis=1)[:, None] + (radius + grown) ** 2
            root = np.sqrt(np.maximum(inner, 0))
            stopped |= (inner > 0) & (root - along > MARCH[0]) & (-root - along < MARCH[1])
        for center, half in self._boxes:
            first, last = np.full(stopped.shape, MARCH[0]), np.full(stopped.shape, MARCH[1])
            for axis in range(3):
                v, side = (center - origin)[:, axis, None], half[axis] + grown
                slope = np.where(np.abs(direction[:, axis]) < 1e-12, 1e-12, direction[:, axis])
                first = np.maximum(first, np.minimum((v - side) / slope, (v + side) / slope))
                last = np.minimum(last, np.maximum((v - side) / slope, (v + side) / slope))
            stopped |= first < last
        return stopped

    def visible(self, origin, light, radius, count=1024):
        """The visible fraction of a disc, by rays to `count` points spread over it by the golden angle."""
        i = np.arange(count)
        r, angle = np.tan(radius) * np.sqrt((i + 0.5) / count), i * np.pi * (3 - np.sqrt(5))
        u = np.cross(light, [0.36, 0.48, 0.8])
        u /= np.linalg.norm(u)
        d = light + (r * np.cos(angle))[:, None] * u + (r * np.sin(angle))[:, None] * np.cross(light, u)
        return 1 - self.stops(origin, d / np.linalg.norm(d, axis=1, keepdims=True)).mean(axis=1)


def across_the_shade(rng, scene, light, radius, count=64):
    """Points of the floor that see a part of the light, in even steps from little to most of it; some all or nothing."""
    points = ground(rng, 6000)
    seen = scene.visible(points, light, radius, 32)
    order = np.argsort(seen, kind="stable")
    order = order[(seen[order] > 0) & (seen[order] < 1)]
    steps = np.searchsorted(seen[order], np.linspace(0.03, 0.97, count))
    partly = np.unique(order[np.minimum(steps, len(order) - 1)])
    return points[np.concatenate([partly, np.flatnonzero(seen == 0)[:8], np.flatnonzero(seen == 1)[:8]])]


def light_above(rng):
    turn, height = rng.uniform(0, 2 * np.pi), rng.uniform(0.7, 1.1)
    return np.array([np.cos(height) * np.sin(turn), np.sin(height), np.cos(height) * np.cos(turn)])


def _turn(rng):
    c, s = np.cos(angle := rng.uniform(0, 2 * np.pi)), np.sin(angle)
    return np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


def ground(rng, count, extent=2.8):
    return np.insert(rng.uniform(-extent, extent, (count, 2)), 1, 0.0, axis=1)


def floor_from_above(light, extent=2.0):
    """The pixels of a picture of the floor, about the place where shadows fall."""
    side = extent * ((2 * np.arange(PIXELS) + 1) / PIXELS - 1)
    x, z = np.meshgrid(side, side)
    return np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3) - [0.8, 0, 0.8] * light / light[1]
