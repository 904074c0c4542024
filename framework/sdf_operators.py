"""The inner nodes of a distance field's expression tree: operators on one, two or many fields.

`framework.sdf` builds them, with checks; `framework.sdf_primitives` says what every node promises.
"""

from dataclasses import dataclass

import numpy as np

from framework.sdf_primitives import Node


@dataclass(frozen=True)
class Union(Node):
    of: tuple

    @property
    def children(self):
        return self.of

    def _value(self, x, y, z):
        nearest = self.of[0]._value(x, y, z)
        for node in self.of[1:]:
            np.minimum(nearest, node._value(x, y, z), out=nearest)
        return nearest

    def bounds_of_level(self, level):
        return _hull(node.bounds_of_level(level) for node in self.of)


@dataclass(frozen=True)
class SmoothUnion(Node):
    """Quadratic: at most k / 4 below the smaller one, where the two are equal."""

    a: Node
    b: Node
    k: float

    @property
    def children(self):
        return self.a, self.b

    def _value(self, x, y, z):
        a, b = self.a._value(x, y, z), self.b._value(x, y, z)
        overlap = np.maximum(self.k - np.abs(a - b), 0.0)
        return np.minimum(a, b) - overlap * overlap / (4.0 * self.k)

    def bounds_of_level(self, level):
        return _hull(node.bounds_of_level(level + self.k / 4.0) for node in self.children)


@dataclass(frozen=True)
class Subtraction(Node):
    a: Node
    b: Node

    @property
    def children(self):
        return self.a, self.b

    def _value(self, x, y, z):
        return np.maximum(self.a._value(x, y, z), -self.b._value(x, y, z))

    def bounds_of_level(self, level):
        return self.a.bounds_of_level(level)


@dataclass(frozen=True)
class Intersection(Node):
    of: tuple

    @property
    def children(self):
        return self.of

    def _value(self, x, y, z):
        farthest = self.of[0]._value(x, y, z)
        for node in self.of[1:]:
            np.maximum(farthest, node._value(x, y, z), out=farthest)
        return farthest

    def bounds_of_level(self, level):
        lows, highs = zip(*(node.bounds_of_level(level) for node in self.of), strict=True)
        low, high = np.max(lows, axis=0), np.min(highs, axis=0)
        return low, np.maximum(low, high)  # a box without volume where nothing is in common


@dataclass(frozen=True)
class Blend(Node):
    a: Node
    b: Node
    t: float

    @property
    def children(self):
        return self.a, self.b

    def _value(self, x, y, z):
        return (1.0 - self.t) * self.a._value(x, y, z) + self.t * self.b._value(x, y, z)

    def bounds_of_level(self, level):
        # Where both are above the level, so is any mean of the two.
        return _hull(node.bounds_of_level(level) for node in self.children)


@dataclass(frozen=True)
class Translate(Node):
    of: Node
    offset: tuple

    @property
    def children(self):
        return (self.of,)

    def _value(self, x, y, z):
        ox, oy, oz = self.offset
        return self.of._value(x - ox, y - oy, z - oz)

    def bounds_of_level(self, level):
        low, high = self.of.bounds_of_level(level)
        return low + self.offset, high + self.offset


@dataclass(frozen=True)
class Rotate(Node):
    """Counter-clockwise by `angle` as seen from the tip of the unit `axis`, about the origin."""

    of: Node
    axis: tuple
    angle: float

    @property
    def children(self):
        return (self.of,)

    @property
    def matrix(self):
        """`(3, 3)`: takes points of the child to points of this node (Rodrigues' formula)."""
        x, y, z = self.axis
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        matrix = np.eye(3) + np.sin(self.angle) * cross + (1.0 - np.cos(self.angle)) * (cross @ cross)
        # Quarter turns without a remainder of 6e-17, which would make half-spaces look unbounded all around.
        return np.where(np.abs(matrix) < 1e-15, 0.0, matrix)

    def _value(self, x, y, z):
        # Points go back by the transpose, which is the inverse: its rows are the matrix's columns.
        return self.of._value(*(c0 * x + c1 * y + c2 * z for c0, c1, c2 in self.matrix.T))

    def bounds_of_level(self, level):
        low, high = self.of.bounds_of_level(level)
        matrix = self.matrix
        with np.errstate(invalid="ignore"):
            ends = np.where(matrix == 0.0, 0.0, matrix * low), np.where(matrix == 0.0, 0.0, matrix * high)
        return np.minimum(*ends).sum(axis=1), np.maximum(*ends).sum(axis=1)


@dataclass(frozen=True)
class Scale(Node):
    of: Node
    factor: float

    @property
    def children(self):
        return (self.of,)

    def _value(self, x, y, z):
        return self.factor * self.of._value(x / self.factor, y / self.factor, z / self.factor)

    def bounds_of_level(self, level):
        low, high = self.of.bounds_of_level(level / self.factor)
        return low * self.factor, high * self.factor


def _hull(boxes):
    lows, highs = zip(*boxes, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)
