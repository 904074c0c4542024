"""The leaves of a distance field's expression tree, and what all its nodes have in common.

`framework.sdf` builds them, with checks. Every node is a frozen dataclass of floats, tuples and other
nodes, so that a tree is hashable, cannot change, and is walked through `children` and the fields. Every
node is 1-Lipschitz, `|f(p) - f(q)| <= |p - q|`: a march by the value never passes through a surface.
Values are the exact signed distance for primitives; where operators are involved they are a lower bound
of its size.
"""

import math
from dataclasses import dataclass

import numpy as np

# Few enough points that the temporaries of a node stay in the second-level cache, whatever the batch.
_CHUNK = 16384


class Node:
    """A signed distance field: call it on points `(..., 3)` to get values `(...)`, negative inside."""

    @property
    def children(self):
        """The nodes that this one works on, a tuple; none for a primitive."""
        return ()

    def __call__(self, points):
        """Signed distance at each point.

        Parameters
        ----------
        points : (..., 3) float     scene units; where a coordinate is not finite, or above 1e150, so may be
                                    the value

        Returns
        -------
        (...) float64               scene units, negative inside
        """
        points = np.asarray(points, float)
        if points.ndim == 0 or points.shape[-1] != 3:
            raise ValueError(f"sdf: points have shape {points.shape}; points of shape (..., 3) are wanted")
        flat = points.reshape(-1, 3)
        values = np.empty(len(flat))
        with np.errstate(invalid="ignore", over="ignore"):
            for start in range(0, len(flat), _CHUNK):
                x, y, z = np.ascontiguousarray(flat[start : start + _CHUNK].T)
                values[start : start + _CHUNK] = self._value(x, y, z)
        return values.reshape(points.shape[:-1])[()]

    evaluate = __call__

    @property
    def bounds(self):
        """`(low, high)`, `(3,)` each: an axis-aligned box around the solid, infinite where it has no end.

        Tight for primitives; operators keep what they can, and never lose a part of the solid.
        """
        return self.bounds_of_level(0.0)

    def bounds_of_level(self, level):
        """`(low, high)` of a box around all points whose value is at most `level` (at least 0)."""
        raise NotImplementedError

    def _value(self, x, y, z):
        """Values at the points whose coordinates are the columns `x`, `y`, `z`, `(N,)` each."""
        raise NotImplementedError


@dataclass(frozen=True)
class Sphere(Node):
    center: tuple
    radius: float

    def _value(self, x, y, z):
        cx, cy, cz = self.center
        return _length(x - cx, y - cy, z - cz) - self.radius

    def bounds_of_level(self, level):
        return _box_around(self.center, self.radius + level)


@dataclass(frozen=True)
class Box(Node):
    center: tuple
    half_size: tuple

    def _value(self, x, y, z):
        (cx, cy, cz), (hx, hy, hz) = self.center, self.half_size
        qx, qy, qz = np.abs(x - cx) - hx, np.abs(y - cy) - hy, np.abs(z - cz) - hz
        inside = np.minimum(np.maximum(np.maximum(qx, qy), qz), 0.0)
        return _length(np.maximum(qx, 0.0), np.maximum(qy, 0.0), np.maximum(qz, 0.0)) + inside

    def bounds_of_level(self, level):
        return _box_around(self.center, np.asarray(self.half_size) + level)


@dataclass(frozen=True)
class Torus(Node):
    """Axis +y."""

    center: tuple
    major_radius: float
    minor_radius: float

    def _value(self, x, y, z):
        cx, cy, cz = self.center
        from_ring = np.sqrt((x - cx) ** 2 + (z - cz) ** 2) - self.major_radius
        return np.sqrt(from_ring**2 + (y - cy) ** 2) - self.minor_radius

    def bounds_of_level(self, level):
        tube = self.minor_radius + level
        return _box_around(self.center, [self.major_radius + tube, tube, self.major_radius + tube])


@dataclass(frozen=True)
class Capsule(Node):
    a: tuple
    b: tuple
    radius: float

    def _value(self, x, y, z):
        ax, ay, az = self.a
        length = math.dist(self.a, self.b)
        ux, uy, uz = (
            (end - start) / length if length > 0 else 0.0 for start, end in zip(self.a, self.b, strict=True)
        )
        px, py, pz = x - ax, y - ay, z - az
        along = np.clip(px * ux + py * uy + pz * uz, 0.0, length)
        return _length(px - along * ux, py - along * uy, pz - along * uz) - self.radius

    def bounds_of_level(self, level):
        reach = self.radius + level
        return np.minimum(self.a, self.b) - reach, np.maximum(self.a, self.b) + reach


@dataclass(frozen=True)
class Plane(Node):
    """All below a plane: `normal . p - offset`, the normal unit."""

    normal: tuple
    offset: float

    def _value(self, x, y, z):
        nx, ny, nz = self.normal
        return nx * x + ny * y + nz * z - self.offset

    def bounds_of_level(self, level):
        low, high = np.full(3, -np.inf), np.full(3, np.inf)
        for axis, component in enumerate(self.normal):
            if component == 1.0:
                high[axis] = self.offset + level
            elif component == -1.0:
                low[axis] = -self.offset - level
        return low, high


def _length(x, y, z):
    return np.sqrt(x * x + y * y + z * z)


def _box_around(center, half_size):
    return np.asarray(center) - half_size, np.asarray(center) + half_size
