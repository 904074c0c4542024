"""Signed distance fields: primitives, operators that combine them, and scenes as data.

Lengths are in scene units, angles in radians. Each function returns a `Node`, a callable `(..., 3) -> (...)`
that is negative inside, immutable, and 1-Lipschitz (but for `from_mesh`). After Quilez, Distance functions,
iquilezles.org/articles/distfunctions.
"""

import json
from collections.abc import Callable
from pathlib import Path

from framework import sdf_operators as operators
from framework import sdf_primitives as primitives
from framework.arrays import as_number, as_positive, as_vector, normalize
from framework.sdf_primitives import Node


def sphere(center, radius):
    """A ball, exact."""
    return primitives.Sphere(_point(center, "sphere: center"), as_positive(radius, "sphere: radius"))


def box(center, half_size):
    """An axis-aligned box of size `2 half_size`, exact inside and outside."""
    half = _point(half_size, "box: half_size")
    if min(half) < 0:
        raise ValueError(f"box: half_size is {half}; three numbers of at least 0 are wanted")
    return primitives.Box(_point(center, "box: center"), half)


def torus(center, major, minor):
    """A ring about the axis +y: `major` from the centre to the tube's middle, `minor` the tube's radius.

    Exact where `minor <= major`; a fatter tube meets itself, and then values inside are a lower bound.
    """
    return primitives.Torus(
        _point(center, "torus: center"),
        as_positive(major, "torus: major"),
        as_positive(minor, "torus: minor"),
    )


def capsule(a, b, radius):
    """All points within `radius` of the segment from `a` to `b`, exact."""
    return primitives.Capsule(
        _point(a, "capsule: a"), _point(b, "capsule: b"), as_positive(radius, "capsule: radius")
    )


def plane(normal, offset):
    """The half-space below a plane: `n . p - offset`, exact.

    `normal` is brought to length 1; `offset` is the distance of the plane from the origin along it.
    """
    return primitives.Plane(_unit(normal, "plane: normal"), as_number(offset, "plane: offset"))


def from_mesh(mesh, resolution):
    """The distance to a triangle mesh, sampled on a grid.

    Parameters
    ----------
    mesh : Mesh                 closed, wound counter-clockwise as seen from outside; an open one gets distances that
                                are positive on both sides, and a warning
    resolution : int            cells along the longest side of the mesh's box, 1 to 1024

    Returns
    -------
    Grid                        a node like the others, which also says `.cell`, `.closed`, `.error`, `.nbytes`, and
                                has `.updated(mesh)`

    Raises
    ------
    ValueError                  for a mesh without triangles, or another resolution

    Notes
    -----
    Values are lower bounds: never larger than the distance, of the right sign or 0, so that no march passes
    through the mesh. They are 0 up to `.error` from it: some hundredths of a cell where the surface is smooth,
    up to 1.8 cells at sharp edges and around open meshes. Where two parts of the surface are equally near, they
    may be steeper than 1, by `.lipschitz`.
    """
    from framework.grid import build

    return build(mesh, resolution)


def union(*many):
    """What is in any of them: the minimum. Exact outside, a lower bound inside."""
    return _joined(operators.Union, many, "union")


def smooth_union(a, b, k):
    """A union whose seam is filled: `min(a, b) - max(k - |a - b|, 0)^2 / (4 k)`, `k > 0` in scene units.

    The fill is at most `k / 4` thick, and begins where the two values differ by less than `k`.
    """
    a, b = _nodes((a, b), "smooth_union")
    return operators.SmoothUnion(a, b, as_positive(k, "smooth_union: k"))


def subtraction(a, b):
    """`a` without `b`: `max(a, -b)`. A lower bound."""
    return operators.Subtraction(*_nodes((a, b), "subtraction"))


def intersection(*many):
    """What is in all of them: the maximum. Exact inside, a lower bound outside."""
    return _joined(operators.Intersection, many, "intersection")


def blend(a, b, t):
    """A shape between two: `(1 - t) a + t b`, `t` in [0, 1]. A lower bound."""
    a, b = _nodes((a, b), "blend")
    return operators.Blend(a, b, as_number(t, "blend: t", 0, 1))


def translate(a, offset):
    """`a`, moved by `offset`."""
    (a,) = _nodes((a,), "translate")
    return operators.Translate(a, _point(offset, "translate: offset"))


def rotate(a, axis, angle):
    """`a`, turned about the origin by `angle`: counter-clockwise for who looks against `axis`."""
    (a,) = _nodes((a,), "rotate")
    return operators.Rotate(a, _unit(axis, "rotate: axis"), as_number(angle, "rotate: angle"))


def scale(a, factor):
    """`a`, larger by `factor > 0` in all directions from the origin."""
    (a,) = _nodes((a,), "scale")
    return operators.Scale(a, as_positive(factor, "scale: factor"))


def load(scene):
    """The distance field of a scene description.

    Parameters
    ----------
    scene : path, str or dict   a JSON file, or what is in it: an object in which one key, such as `union`, is
                                a node (see `from_dict`); other keys, such as `camera`, are left to others

    Returns
    -------
    Node

    Raises
    ------
    ValueError                  where the file or the object does not describe one field
    """
    name = "scene"
    if not isinstance(scene, dict):
        name = Path(scene).name
        try:
            scene = json.loads(Path(scene).read_text(encoding="utf-8"))
        except ValueError as error:
            raise ValueError(f"{name} is not JSON: {error}") from None
    if not isinstance(scene, dict):
        raise ValueError(
            f"{name} holds a {type(scene).__name__}; an object with one key of {_known()} is wanted"
        )
    found = [key for key in scene if key in _READ]
    if len(found) != 1:
        raise ValueError(f"{name} describes {len(found)} fields; exactly one key of {_known()} is wanted")
    return from_dict({found[0]: scene[found[0]]})


def from_dict(node):
    """The field that a nested description says.

    Parameters
    ----------
    node : dict                 one key, the name of a function of this module. Its value: for `union` and
                                `intersection` a list of nodes; else an object of the arguments, as in
                                `{"sphere": {"center": [0, 1, 0], "radius": 1}}`, where operators have their
                                nodes in a list `of`, as in `{"scale": {"factor": 2, "of": [...]}}`

    Returns
    -------
    Node
    """
    if not isinstance(node, dict) or len(node) != 1:
        raise ValueError(
            f"sdf: {_excerpt(node)} is not a node; an object with one key of {_known()} is wanted"
        )
    ((name, arguments),) = node.items()
    if name not in _READ:
        raise ValueError(f"sdf: there is no node {name!r}; {_known()} are known")
    make, wanted, arity = _READ[name]
    if arity is None:
        return make(*_read_nodes(arguments, name))
    if not isinstance(arguments, dict) or set(arguments) != {*wanted, *(["of"] if arity else [])}:
        keys = ", ".join([*wanted, *(["of"] if arity else [])])
        raise ValueError(f"sdf: {name} holds {_excerpt(arguments)}; an object with exactly {keys} is wanted")
    nodes = _read_nodes(arguments["of"], name) if arity else []
    if len(nodes) != arity:
        raise ValueError(f"sdf: {name} has {len(nodes)} nodes in `of`; {arity} are wanted")
    return make(*nodes, *(arguments[key] for key in wanted))


# For each node: its function, the keys of its arguments in that order, the number of nodes that it works on.
_READ: dict[str, tuple[Callable[..., Node], list[str], int | None]] = {
    "sphere": (sphere, ["center", "radius"], 0),
    "box": (box, ["center", "half_size"], 0),
    "torus": (torus, ["center", "major_radius", "minor_radius"], 0),
    "capsule": (capsule, ["a", "b", "radius"], 0),
    "plane": (plane, ["normal", "offset"], 0),
    "union": (union, [], None),
    "intersection": (intersection, [], None),
    "smooth_union": (smooth_union, ["k"], 2),
    "subtraction": (subtraction, [], 2),
    "blend": (blend, ["t"], 2),
    "translate": (translate, ["offset"], 1),
    "rotate": (rotate, ["axis", "angle"], 1),
    "scale": (scale, ["factor"], 1),
}


def _read_nodes(values, name):
    if not isinstance(values, list):
        raise ValueError(f"sdf: {name} holds {_excerpt(values)}; a list of nodes is wanted")
    return [from_dict(value) for value in values]


def _known():
    return ", ".join(_READ)


def _excerpt(value):
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _point(value, name):
    return tuple(as_vector(value, name).tolist())


def _unit(value, name):
    vector = as_vector(value, name)
    if not vector.any():
        raise ValueError(f"{name} is zero; a direction is wanted")
    # What is unit stays as it is, to the last bit: a field that is written and read again is the same.
    return tuple((vector if abs(vector @ vector - 1) < 1e-15 else normalize(vector)).tolist())


def _nodes(values, name):
    for value in values:
        if not isinstance(value, Node):
            raise ValueError(
                f"{name}: got {_excerpt(value)}; a field made by a function of framework.sdf is wanted"
            )
    return values


def _joined(kind, many, name):
    """One flat node: scenes built in a loop stay shallow however many parts they have."""
    if not many:
        raise ValueError(f"{name}: no fields are given; at least one is wanted")
    parts = tuple(
        part for node in _nodes(many, name) for part in (node.of if isinstance(node, kind) else (node,))
    )
    return parts[0] if len(parts) == 1 else kind(parts)
