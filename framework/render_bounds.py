"""Where solids can be met: boxes and half-spaces around them, for rays that need not be sent."""

import numpy as np

from framework.mesh import Mesh
from framework.sdf_operators import Union
from framework.sdf_primitives import Plane

_MOST_PARTS = 16


class Bounds:
    """The solids of several meshes and fields.

    Attributes
    ----------
    planes : (P, 4) float       half-spaces: unit normal and offset
    """

    def __init__(self, shapes):
        parts = [part for shape in shapes for part in (shape.of if isinstance(shape, Union) else (shape,))]
        planes = [part for part in parts if isinstance(part, Plane)]
        parts = [part for part in parts if not isinstance(part, Plane)]
        self.planes = np.array([[*plane.normal, plane.offset] for plane in planes]).reshape(-1, 4)
        # Every ray asks for each part: the many parts of a large union share boxes.
        size = max(1, -(-len(parts) // _MOST_PARTS))
        self._groups = [parts[i : i + size] for i in range(0, len(parts), size)]

    def boxes(self, levels):
        """Boxes around all points whose distance is at most a level: low and high, (parts, levels, 3) each."""
        shape = (len(self._groups), len(levels), 3)
        low, high = np.full(shape, np.inf), np.full(shape, -np.inf)
        for i, group in enumerate(self._groups):
            for part in group:
                for k, level in enumerate(levels):
                    a, b = _around(part, level)
                    low[i, k], high[i, k] = np.minimum(low[i, k], a), np.maximum(high[i, k], b)
        return low, high

    def near(self, points, level):
        """Whether points (N, 3) may be as near to a solid as `level`: bool (N,)."""
        low, high = self.boxes([level])
        near = np.zeros(len(points), bool)
        for a, b in zip(low[:, 0], high[:, 0], strict=True):
            near |= ((points >= a) & (points <= b)).all(axis=1)
        for plane in self.planes:
            near |= points @ plane[:3] - plane[3] <= level
        return near


def _around(shape, level):
    if isinstance(shape, Mesh):
        if not len(shape.faces):
            return np.full(3, np.inf), np.full(3, -np.inf)
        return shape.vertices.min(axis=0) - level, shape.vertices.max(axis=0) + level
    return shape.bounds_of_level(level)
