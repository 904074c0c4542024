"""Independent truths of scenes as data: rays cast in closed form, and distances ray by ray. No field is marched or built."""

import math
from collections.abc import Callable

import numpy as np


def cast(nodes, origin, direction):
    """First surface that each ray meets, from outside.

    Parameters
    ----------
    nodes : list of dict            a union, as `framework.sdf.load` reads it: plane, sphere, box, torus, capsule, and
                                    smooth_union of two spheres
    origin, direction : (N, 3) float    unit directions

    Returns
    -------
    t : (N,) float                  distance along the ray, inf where nothing is met
    normal : (N, 3) float           outward and unit, 0 where nothing is met
    """
    origin, direction = np.broadcast_arrays(np.asarray(origin, float), np.asarray(direction, float))
    first, normal = np.full(len(origin), np.inf), np.zeros(origin.shape)
    for node in nodes:
        ((kind, arguments),) = node.items()
        t, n = _CAST[kind](origin, direction, **arguments)
        nearer = t < first
        first[nearer], normal[nearer] = t[nearer], n[nearer]
    return first, normal


def visible_fraction(nodes, origin, to_light, angular_radius, t_max, count):
    """Part of a round light that each point sees, (N,): `count` rays spread evenly over its disc by the golden angle."""
    i = np.arange(count)
    radius, phi = np.tan(angular_radius) * np.sqrt((i + 0.5) / count), i * np.pi * (3.0 - np.sqrt(5.0))
    side = np.cross(to_light, np.eye(3)[np.argmin(np.abs(to_light))])
    side /= np.linalg.norm(side)
    ray = to_light + radius[:, None] * (
        np.cos(phi)[:, None] * side + np.sin(phi)[:, None] * np.cross(to_light, side)
    )
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    seen = [np.mean(cast(nodes, np.broadcast_to(p, ray.shape), ray)[0] > t_max) for p in origin]
    return np.array(seen)


def smallest_penumbra(nodes, origin, to_light, k, t_min, t_max, max_steps):
    """min(k d / t, 1) over the points that a march visits, 0 within 1e-4: its definition, one point after the other."""
    result = []
    for start in np.asarray(origin, float).tolist():
        t, seen = t_min, 1.0
        for _ in range(max_steps):
            if t > t_max:
                break
            d = _nearest(nodes, [x + t * l for x, l in zip(start, to_light, strict=True)])
            if d < 1e-4:
                seen = 0.0
                break
            seen = min(seen, k * d / t)
            t += d
        result.append(seen)
    return np.array(result)


def _nearest(nodes, p):
    """Distance to the nearest of spheres, boxes, tori and capsules."""
    return min(_DISTANCE[kind](p, **a) for node in nodes for kind, a in node.items())


def _distance_to_box(p, center, half_size):
    q = [abs(x - c) - h for x, c, h in zip(p, center, half_size, strict=True)]
    return math.hypot(*(max(x, 0.0) for x in q)) + min(max(q), 0.0)


def _distance_to_capsule(p, a, b, radius):
    axis = [y - x for x, y in zip(a, b, strict=True)]
    along = sum((x - y) * z for x, y, z in zip(p, a, axis, strict=True)) / sum(z * z for z in axis)
    along = min(max(along, 0.0), 1.0)
    return math.dist(p, [x + along * z for x, z in zip(a, axis, strict=True)]) - radius


def _distance_to_torus(p, center, major_radius, minor_radius):
    x, y, z = (a - c for a, c in zip(p, center, strict=True))
    return math.hypot(math.hypot(x, z) - major_radius, y) - minor_radius


_DISTANCE: dict[str, Callable] = {
    "sphere": lambda p, center, radius: math.dist(p, center) - radius,
    "box": _distance_to_box,
    "capsule": _distance_to_capsule,
    "torus": _distance_to_torus,
}


def _dot(a, b):
    return np.einsum("nk,nk->n", a, np.broadcast_to(b, a.shape))


def _plane(origin, direction, normal, offset):
    normal = np.asarray(normal, float) / np.linalg.norm(normal)
    slope = _dot(direction, normal)
    towards = slope < 0.0
    t = (offset - _dot(origin, normal)) / np.where(towards, slope, -1.0)
    return np.where(towards & (t > 0.0), t, np.inf), np.broadcast_to(normal, origin.shape)


def _sphere(origin, direction, center, radius):
    away = origin - center
    b = _dot(away, direction)
    # What is left of the centre's offset across the ray: b^2 - c would cancel far away.
    aside = away - b[:, None] * direction
    inner = radius**2 - _dot(aside, aside)
    t = -b - np.sqrt(np.maximum(inner, 0.0))
    t = np.where((inner > 0.0) & (t > 0.0), t, np.inf)
    return t, _outward(origin, direction, t, lambda p: (p - center) / radius)


def _box(origin, direction, center, half_size):
    center, half_size = np.asarray(center, float), np.asarray(half_size, float)
    slope = np.where(np.abs(direction) < 1e-300, 1e-300, direction)
    sides = np.stack([(center + sign * half_size - origin) / slope for sign in (-1.0, 1.0)])
    enter, leave = sides.min(axis=0), sides.max(axis=0).min(axis=1)
    axis, t = enter.argmax(axis=1), enter.max(axis=1)
    t = np.where((t < leave) & (t > 0.0), t, np.inf)
    return t, -np.sign(direction) * np.eye(3)[axis]


def _capsule(origin, direction, a, b, radius):
    a, axis = np.asarray(a, float), np.subtract(b, a)
    length = np.linalg.norm(axis)
    axis /= length
    ends = [_sphere(origin, direction, end, radius)[0] for end in (a, b)]
    # Between the ends a cylinder: a circle in the plane across the axis.
    away = origin - a
    o, d = (v - _dot(v, axis)[:, None] * axis for v in (away, direction))
    dd, od = np.maximum(_dot(d, d), 1e-300), _dot(o, d)
    aside = o - (od / dd)[:, None] * d
    inner = (radius**2 - _dot(aside, aside)) / dd
    t = -od / dd - np.sqrt(np.maximum(inner, 0.0))
    along = _dot(away, axis) + t * _dot(direction, axis)
    t = np.where((inner > 0.0) & (t > 0.0) & (along >= 0.0) & (along <= length), t, np.inf)
    t = np.minimum(t, np.minimum(*ends))

    def normal(p):
        along = np.clip(_dot(p - a, axis), 0.0, length)
        return (p - a - along[:, None] * axis) / radius

    return t, _outward(origin, direction, t, normal)


def _torus(origin, direction, center, major_radius, minor_radius):
    """The least positive root of a quartic, from its companion matrix, then polished."""
    first = np.full(len(origin), np.inf)
    away = origin - center
    nearest = -_dot(away, direction)  # to the centre: roots are small numbers when counted from there
    o = away + nearest[:, None] * direction
    near = np.flatnonzero(_dot(o, o) < (major_radius + minor_radius) ** 2)
    if near.size:
        o, d = o[near], direction[near]
        # |p|^2 + R^2 - r^2 = 2 R |p across the axis|, squared; o.d = 0.
        c = _dot(o, o) + major_radius**2 - minor_radius**2
        across = [_dot(u[:, ::2], v[:, ::2]) for u, v in ((d, d), (o, d), (o, o))]
        four = 4.0 * major_radius**2
        quartic = np.stack(
            [np.ones_like(c), 0.0 * c, 2.0 * c - four * across[0], -2.0 * four * across[1], c**2 - four * across[2]],
            axis=1,
        )
        companion = np.zeros((len(near), 4, 4))
        companion[:, 0] = -quartic[:, 1:]
        companion[:, [1, 2, 3], [0, 1, 2]] = 1.0
        roots = np.linalg.eigvals(companion)
        real = np.where(np.abs(roots.imag) < 1e-7, roots.real, np.inf)
        s = np.where(real + nearest[near, None] > 0.0, real, np.inf).min(axis=1)
        met = np.isfinite(s)
        s, quartic = s[met], quartic[met]
        for _ in range(3):
            value = (((s + quartic[:, 1]) * s + quartic[:, 2]) * s + quartic[:, 3]) * s + quartic[:, 4]
            slope = ((4.0 * s + 3.0 * quartic[:, 1]) * s + 2.0 * quartic[:, 2]) * s + quartic[:, 3]
            s = s - value / np.where(np.abs(slope) > 1e-9, slope, np.inf)
        first[near[met]] = s + nearest[near[met]]

    def normal(p):
        ring = (p - center) * [1.0, 0.0, 1.0]
        ring *= major_radius / np.linalg.norm(ring, axis=1, keepdims=True)
        return (p - center - ring) / minor_radius

    return first, _outward(origin, direction, first, normal)


def _smooth_union(origin, direction, k, of, samples=1024):
    """Two spheres whose seam is filled: the first change of sign along the ray, then bisected."""
    (a, b), first = (node["sphere"] for node in of), np.full(len(origin), np.inf)

    def field(p):
        one, other = (np.linalg.norm(p - s["center"], axis=-1) - s["radius"] for s in (a, b))
        fill = np.maximum(k - np.abs(one - other), 0.0)
        return np.minimum(one, other) - fill**2 / (4.0 * k), one, other, fill

    # The fill is at most k / 4 thick.
    middle = 0.5 * np.add(a["center"], b["center"])
    reach = 0.5 * math.dist(a["center"], b["center"]) + max(a["radius"], b["radius"]) + 0.25 * k
    start = _sphere(origin, direction, middle, reach)[0]
    near = np.flatnonzero(np.isfinite(start))
    t = start[near, None] + 2.0 * reach * np.linspace(0.0, 1.0, samples)
    inside = field(origin[near, None] + t[..., None] * direction[near, None])[0] < 0.0
    met, step = inside.any(axis=1), inside.argmax(axis=1)
    near = near[met]
    low, high = (t[met, step[met] - back] for back in (1, 0))
    for _ in range(50):
        half = 0.5 * (low + high)
        outside = field(origin[near] + half[:, None] * direction[near])[0] > 0.0
        low, high = np.where(outside, half, low), np.where(outside, high, half)
    first[near] = high

    def normal(p):
        _, one, other, fill = field(p)
        share = fill / (2.0 * k)  # of the farther one in the gradient
        share = np.where(one < other, share, 1.0 - share)[:, None]
        to_one, to_other = ((p - s["center"]) / np.linalg.norm(p - s["center"], axis=1, keepdims=True) for s in (a, b))
        gradient = (1.0 - share) * to_one + share * to_other
        return gradient / np.linalg.norm(gradient, axis=1, keepdims=True)

    return first, _outward(origin, direction, first, normal)


def _outward(origin, direction, t, normal):
    """normal(p) where a ray meets something, 0 elsewhere."""
    result, met = np.zeros(origin.shape), np.isfinite(t)
    result[met] = normal(origin[met] + t[met, None] * direction[met])
    return result


_CAST: dict[str, Callable] = {
    "plane": _plane,
    "sphere": _sphere,
    "box": _box,
    "torus": _torus,
    "capsule": _capsule,
    "smooth_union": _smooth_union,
}
