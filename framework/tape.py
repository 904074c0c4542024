"""A distance field's expression tree as flat arrays of numbers: compiled once, evaluated and pruned fast.

A scene is the union of its *parts*. Most are a single primitive; the others are short programs for a stack
machine, operands first. Translations, rotations and scales vanish: they are folded into the primitives. A
hierarchy of boxes over the parts finds the few that matter in a region, so that the cost of a scene grows with
what is near rather than with what there is.
"""

import weakref
from dataclasses import dataclass

import numpy as np

from framework import sdf_operators as operators
from framework import sdf_primitives as primitives
from framework import tape_kernels as kernels

_PER_LEAF = 2  # parts in a leaf of the hierarchy
_UNIT = (np.eye(3), np.zeros(3), 1.0)


@dataclass(frozen=True, eq=False)
class Tape:
    """A compiled field. Call it on points `(..., 3)` for values `(...)`, as the tree that it was made from.

    Attributes
    ----------
    op : (I,) int32                 instruction codes, parts one after another, operands first
    number : (I, 16) float64        parameters of each instruction, in the world
    size : (I,) int64               instructions of the operand that ends here
    start : (P + 1,) int64          where each part's instructions start; parts without bounds come first
    box : (P, 6) float64            low and high corners: outside its box a part's value is at least the distance to it
    node : (B, 6) float64           boxes of the hierarchy: a complete binary tree, children of i at 2 i + 1, 2 i + 2
    leaf : (L + 1,) int64           first part of each of the tree's leaves
    unbounded : int                 number of parts without bounds
    depth : int                     of the stack
    """

    op: np.ndarray
    number: np.ndarray
    size: np.ndarray
    start: np.ndarray
    box: np.ndarray
    node: np.ndarray
    leaf: np.ndarray
    unbounded: int
    depth: int

    @property
    def arrays(self):
        """What kernels take, as one tuple."""
        return (self.op, self.number, self.size, self.start, self.box, self.node, self.leaf, self.unbounded)

    def __call__(self, points):
        """Signed distance at each point.

        Parameters
        ----------
        points : (..., 3) float     scene units

        Returns
        -------
        (...) float32               right to a few roundings of the distance from the centre of the 256 points
                                    that are evaluated together: keep neighbours together
        """
        points = np.asarray(points, float)
        if points.ndim == 0 or points.shape[-1] != 3:
            raise ValueError(f"tape: points have shape {points.shape}; points of shape (..., 3) are wanted")
        flat = np.ascontiguousarray(points.reshape(-1, 3))
        values = np.empty(len(flat), np.float32)
        kernels.evaluate(self.arrays, self.depth, flat, values)
        return values.reshape(points.shape[:-1])[()]


def compiled(scene):
    """The tape of a field, made when it is first asked for and kept while the field lives.

    Parameters
    ----------
    scene : framework.sdf node

    Returns
    -------
    Tape
    """
    key = id(scene)
    if key not in _TAPES:
        tape = _compile(scene)
        _TAPES[key] = tape
        weakref.finalize(scene, _TAPES.pop, key)
    return _TAPES[key]


_TAPES: dict[int, Tape] = {}


def _compile(scene):
    if not isinstance(scene, primitives.Node):
        raise ValueError(
            f"tape: got {type(scene).__name__}; a field made by a function of framework.sdf is wanted"
        )
    programs = [_Program(node, place) for node, place in _parts(scene, _UNIT)]
    bounded = np.array([np.isfinite(program.box).all() for program in programs])
    free, kept = np.flatnonzero(~bounded), np.flatnonzero(bounded)
    boxes = np.array([programs[i].box for i in kept]).reshape(-1, 6)
    order, node, leaf = _hierarchy(boxes)
    programs = [programs[i] for i in (*free, *kept[order])]
    return Tape(
        op=np.array([op for program in programs for op in program.op], np.int32),
        number=np.array([row for program in programs for row in program.number]).reshape(-1, kernels.WIDTH),
        size=np.array([size for program in programs for size in program.size], np.int64),
        start=np.cumsum([0, *(len(program.op) for program in programs)], dtype=np.int64),
        box=np.array([program.box for program in programs]).reshape(-1, 6),
        node=node,
        leaf=leaf + len(free),
        unbounded=len(free),
        depth=max(program.depth for program in programs),
    )


def _parts(node, place):
    """The members of the scene's union, each with its place in the world."""
    if isinstance(node, operators.Union):
        for child in node.of:
            yield from _parts(child, place)
    elif isinstance(node, _MOVES):
        yield from _parts(node.of, _within(place, node))
    else:
        yield node, place


_MOVES = (operators.Translate, operators.Rotate, operators.Scale)


def _within(place, node):
    """The place of a moved node's child: points go to `factor * matrix @ point + offset`."""
    matrix, offset, factor = place
    if isinstance(node, operators.Translate):
        return matrix, offset + factor * matrix @ node.offset, factor
    if isinstance(node, operators.Rotate):
        return matrix @ node.matrix, offset, factor
    return matrix, offset, factor * node.factor


class _Program:
    """The instructions of one part, and a box that its value is never below the distance to."""

    def __init__(self, node, place):
        self.op, self.number, self.size = [], [], []
        self.depth, self._height = 0, 0
        self.box = np.concatenate(self._emit(node, place))

    def _emit(self, node, place):
        if isinstance(node, _MOVES):
            return self._emit(node.of, _within(place, node))
        if type(node) in _LEAVES:
            op, numbers, (low, high) = _LEAVES[type(node)](node, *place)
            self._append(op, numbers, 1)
            return low, high
        if type(node) not in _COMBINE:
            raise ValueError(f"tape: a {type(node).__name__} cannot be compiled; nodes of framework.sdf can")
        op, numbers, box_of = _COMBINE[type(node)]
        boxes = [self._emit(node.children[0], place)]
        for child in node.children[1:]:
            left = self.size[-1]
            boxes.append(self._emit(child, place))
            self._append(op, numbers(node, place[2]), left + self.size[-1] + 1)
        return box_of(boxes, node, place[2])

    def _append(self, op, numbers, size):
        self.op.append(op)
        self.number.append(np.pad(np.asarray(numbers, float), (0, kernels.WIDTH - len(numbers))))
        self.size.append(size)
        self._height += 1 if op <= kernels.TORUS else -1
        self.depth = max(self.depth, self._height)


def _plane(node, matrix, offset, factor):
    normal = matrix @ node.normal
    away = factor * node.offset + normal @ offset
    low, high = np.full(3, -np.inf), np.full(3, np.inf)
    return kernels.PLANE, (*normal, away), (low, high)


def _sphere(node, matrix, offset, factor):
    center, radius = factor * matrix @ node.center + offset, factor * node.radius
    return kernels.SPHERE, (*center, radius), (center - radius, center + radius)


def _box(node, matrix, offset, factor):
    center, half = factor * matrix @ node.center + offset, factor * np.asarray(node.half_size)
    reach = np.abs(matrix) @ half
    box = center - reach, center + reach
    if np.allclose(reach, half, rtol=1e-15, atol=0) and np.isin(np.abs(matrix), (0.0, 1.0)).all():
        return kernels.BOX, (*center, *half), box
    return kernels.ROTATED_BOX, (*center, *half, *matrix.T.ravel()), box


def _capsule(node, matrix, offset, factor):
    a, b = (factor * matrix @ end + offset for end in (node.a, node.b))
    radius, length = factor * node.radius, np.linalg.norm(b - a)
    along = (b - a) / length if length > 0 else np.zeros(3)
    return (
        kernels.CAPSULE,
        (*a, radius, *along, length),
        (np.minimum(a, b) - radius, np.maximum(a, b) + radius),
    )


def _torus(node, matrix, offset, factor):
    center, axis = factor * matrix @ node.center + offset, matrix[:, 1]
    major, minor = factor * node.major_radius, factor * node.minor_radius
    reach = major * np.sqrt(np.maximum(1.0 - axis * axis, 0.0)) + minor
    return kernels.TORUS, (*center, minor, *axis, major), (center - reach, center + reach)


_LEAVES = {
    primitives.Plane: _plane,
    primitives.Sphere: _sphere,
    primitives.Box: _box,
    primitives.Capsule: _capsule,
    primitives.Torus: _torus,
}


def _hull(boxes, node, factor):
    lows, highs = zip(*boxes, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def _filled_hull(boxes, node, factor):
    low, high = _hull(boxes, node, factor)
    return low - factor * node.k / 4.0, high + factor * node.k / 4.0


def _smallest(boxes, node, factor):
    # Not what the boxes have in common: values of an intersection can be below the distance to that.
    return min(boxes, key=lambda box: np.linalg.norm(box[1] - box[0]))


def _first(boxes, node, factor):
    return boxes[0]


# For each operator: its code, its numbers, and the box of its value from those of its operands.
_COMBINE = {
    operators.Union: (kernels.UNION, lambda node, factor: (), _hull),
    operators.Intersection: (kernels.INTERSECTION, lambda node, factor: (), _smallest),
    operators.Subtraction: (kernels.SUBTRACTION, lambda node, factor: (), _first),
    operators.SmoothUnion: (kernels.SMOOTH_UNION, lambda node, factor: (factor * node.k,), _filled_hull),
    operators.Blend: (kernels.BLEND, lambda node, factor: (node.t,), _hull),
}


def _hierarchy(boxes):
    """A complete binary tree over boxes `(N, 6)`, halved at the median of the longest side.

    Returns the order of the boxes along the leaves, the tree's boxes, and where each leaf starts.
    """
    count = len(boxes)
    levels = max(int(np.ceil(np.log2(max(count, 1) / _PER_LEAF))), 0)
    order, ends = np.arange(count), np.array([0, count])
    middle = 0.5 * (boxes[:, :3] + boxes[:, 3:])
    for _ in range(levels):
        segment = np.repeat(np.arange(len(ends) - 1), np.diff(ends))
        spread = np.maximum.reduceat(middle[order], ends[:-1]) - np.minimum.reduceat(middle[order], ends[:-1])
        key = middle[order, spread.argmax(axis=1)[segment]]
        order = order[np.lexsort((key, segment))]
        ends = np.insert(ends, np.arange(1, len(ends)), (ends[:-1] + ends[1:]) // 2)
    node = np.empty((2 * len(ends) - 3, 6))
    if count == 0:
        node[:] = (np.inf,) * 3 + (-np.inf,) * 3
        return order, node, ends.astype(np.int64)
    first = len(ends) - 2
    node[first:, :3] = np.minimum.reduceat(boxes[order, :3], ends[:-1])
    node[first:, 3:] = np.maximum.reduceat(boxes[order, 3:], ends[:-1])
    for i in range(first - 1, -1, -1):
        node[i, :3] = np.minimum(node[2 * i + 1, :3], node[2 * i + 2, :3])
        node[i, 3:] = np.maximum(node[2 * i + 1, 3:], node[2 * i + 2, 3:])
    return order, node, ends.astype(np.int64)
