"""Distance fields, tapes, marches and pictures: scales of 1e-4 to 1e5, far origins, shapes without thickness."""

import warnings

import numpy as np

import framework as fw
from framework.tape import compiled
from solutions import fast, sphere_tracing, truth_rays
from solutions.stress import SCALES, measured

_SHAPES = [
    {"sphere": {"center": [0.3, 1.0, -0.2], "radius": 0.7}},
    {"box": {"center": [-1.0, 0.5, 0.4], "half_size": [0.5, 0.3, 0.2]}},
    {"torus": {"center": [1.2, 0.4, 0.9], "major_radius": 0.6, "minor_radius": 0.2}},
    {"capsule": {"a": [-0.5, 0.2, -1.0], "b": [0.4, 0.9, -1.3], "radius": 0.15}},
]


def rows(share):
    rng = np.random.default_rng(35)
    yield from _primitives(rng, int(6_000 * share))
    yield from _nodes(rng, int(6_000 * share))
    yield from _marches(rng, int(12_000 * share))
    yield from _pictures(max(1, round(6 * share)))
    yield from _twin(96 if share >= 0.5 else 40)
    yield from _grids(rng, int(12_000 * share))


def _points(rng, count, scale=1.0):
    """Near, within, and far away, to 1e4 times the scene's size."""
    spread = 10.0 ** rng.uniform(-3, 4, (count, 1))
    return scale * np.concatenate([rng.uniform(-2, 2, (count, 3)), spread * fw.normalize(rng.normal(size=(count, 3)))])


def _primitives(rng, count):
    """The three shapes of the first assignment in extended precision, and its operators' inequalities."""
    found: list = []
    errors, joined, beyond = [], [], []
    for scale in SCALES:
        p, c = _points(rng, count, scale), scale * np.array([0.3, -0.2, 0.1])
        q = p.astype(np.longdouble) - c
        size = np.abs(p).max(axis=1) + scale
        half = scale * np.array([0.5, 0.0, 0.2])  # without thickness along y
        beyond_box = np.abs(q) - half
        exact = [
            np.sqrt((q**2).sum(1)) - scale * 0.7,
            np.sqrt((np.maximum(beyond_box, 0) ** 2).sum(1)) + np.minimum(beyond_box.max(axis=1), 0),
            np.hypot(np.hypot(q[:, 0], q[:, 2]) - scale * 0.6, q[:, 1]) - scale * 0.2,
        ]
        pairs = [
            (sphere_tracing.sdf_sphere(p, c, scale * 0.7), fw.sdf.sphere(c, scale * 0.7)(p)),
            (sphere_tracing.sdf_box(p, c, half), fw.sdf.box(c, half)(p)),
            (sphere_tracing.sdf_torus(p, c, scale * 0.6, scale * 0.2), fw.sdf.torus(c, scale * 0.6, scale * 0.2)(p)),
        ]
        for pair, truth in zip(pairs, exact, strict=True):
            found += pair
            errors += [np.abs(value - truth) / size for value in pair]
        a, b = pairs[0][0], pairs[1][0]
        for k in (1e-6 * scale, scale, 1e6 * scale):
            smooth = sphere_tracing.smooth_union(a, b, k)
            joined.append(smooth)
            low = np.minimum(a, b)
            beyond.append(np.maximum(smooth - low, low - k / 4 - smooth) / (np.abs(smooth) + size + k))
        mixed = sphere_tracing.blend(a, b, 0.3)
        joined.append(mixed)
        beyond.append(np.maximum(mixed - np.maximum(a, b), np.minimum(a, b) - mixed) / size)
    yield measured("sdf_sphere, box, torus; fw.sdf", "error over the point's size", found, np.array(errors), 1e-15,
                   "ulps of the coordinates", points=np.size(found))  # fmt: skip
    yield measured("smooth_union, blend", "beyond their bounds, relative", joined, np.array(beyond), 1e-15,
                   "min - k / 4 <= smooth <= min; min <= blend <= max", points=np.size(joined))  # fmt: skip


def _trees(scale=1.0):
    s, shape = scale, fw.sdf
    ball, plate = shape.sphere((0, s, 0), s), shape.box((s, s, 0), (s, 0, s))
    ring, rod = shape.torus((0, s, 0), s, 0.2 * s), shape.capsule((-s, 0, 0), (-s, 2 * s, 0), 0.1 * s)
    point = shape.capsule((0, 0, s), (0, 0, s), 0.1 * s)  # without length
    return [
        shape.union(ball, plate, ring, rod, point, ball), shape.smooth_union(ball, plate, 0.5 * s),
        shape.subtraction(ball, ring),
        shape.intersection(ball, plate, rod), shape.blend(ball, ring, 0.3), shape.plane((1, 2, 3), -s),
        shape.translate(shape.rotate(shape.scale(ball, 3.0), (1, 1, 0), 1.0), (s, 0, 0)), shape.subtraction(ball, ball),
    ]  # fmt: skip


def _nodes(rng, count):
    values, steep, scaled, tapes = [], [], [], []
    shift = 10.0 ** rng.uniform(-6, 1, (2 * count, 1)) * fw.normalize(rng.normal(size=(2 * count, 3)))
    unit = _points(rng, count)
    unit = unit[np.argsort(np.abs(unit).max(axis=1))]
    for scale in SCALES:
        for tree, plain in zip(_trees(scale), _trees(), strict=True):
            value = tree(scale * unit)
            size = np.abs(unit).max(axis=1) + 1
            values.append(value)
            scaled.append(np.abs(value / scale - plain(unit)) / size)
            step = np.linalg.norm(shift, axis=1)
            steep.append((np.abs(tree(scale * (unit + shift)) - value) / scale - step) / (size + step))
            # The tape holds points relative to their batch of 256: float32 of the batch's size.
            batch = np.repeat([size[i : i + 256].max() for i in range(0, len(size), 256)], 256)[: len(size)]
            tapes.append(np.abs(compiled(tree)(scale * unit) - value) / (scale * batch))
    yield measured("fw.sdf nodes", "steeper than 1, over the point's size", values, np.array(steep), 1e-14,
                   "1-Lipschitz; roundings")  # fmt: skip
    yield measured("fw.sdf nodes", "changed by scale, over the point's size", values, np.array(scaled), 1e-14,
                   "scales of 1e-4 to 1e5")  # fmt: skip
    yield measured("tape", "difference from the tree over the batch's size", tapes, np.array(tapes), 1e-5,
                   "float32, deep programs")  # fmt: skip


def _marches(rng, count):
    field = fw.sdf.union(*map(fw.sdf.from_dict, _SHAPES))
    target = rng.uniform(-1.5, 1.5, (count, 3))
    found, errors, missed, inside = [], [], [], []
    for far in (4.0, 100.0, 1e4):
        origin = far * fw.normalize(rng.normal(size=(count, 3)))
        direction = fw.normalize(target - origin)
        t, hit = sphere_tracing.sphere_trace(field, origin, direction, 3 * far, 1e-7, 512)
        exact, normal = truth_rays.cast(_SHAPES, origin, direction)
        cosine = -(normal * direction).sum(1)
        both = hit & (cosine > 0.05)
        found.append(np.where(hit, t, 0.0))
        errors.append((np.abs(t[both] - exact[both]) * cosine[both] - 1e-7) / far)
        there = np.abs(field(origin + np.where(hit, t, 0)[:, None] * direction))
        missed.append(hit & ~np.isfinite(exact) & (there > 1e-6))
        p = origin[both] + exact[both, None] * direction[both]
        away = sphere_tracing.estimate_normal(field, p, 1e-4) - normal[both]
        inside.append(np.linalg.norm(away, axis=1).mean())
    yield measured("sphere_trace", "error times cosine over eps, over the way", found, np.concatenate(errors), 1e-14,
                   "closed-form rays")  # fmt: skip
    yield measured("sphere_trace", "hits where nothing is", found, np.array(missed), 0, "a hit is nearer than eps")
    yield measured("estimate_normal", "mean error", inside, np.array(inside), 1e-3, "2 eps times the curvature, and edges")
    start = np.array([[0.3, 1.0, -0.2], [0.3, 1.7, -0.2]])  # the ball's centre and its surface
    t, hit = sphere_tracing.sphere_trace(field, start, np.array([0.0, 1.0, 0.0]), 10.0, 1e-4, 64)
    yield measured("sphere_trace", "t from inside and from the surface", t, t + ~hit, 0, "a hit at 0")
    t, hit = sphere_tracing.sphere_trace(field, np.empty((0, 3)), np.empty((0, 3)), 10.0, 1e-4, 64)
    yield measured("sphere_trace", "values for an empty batch", [t.size], [t.size], 0, "nothing asked")


def _pictures(count):
    light, outputs, beyond, inside, differing = fw.normalize([1.0, 2.0, 0.5]), [], [], [], []
    sizes = ((1, 1), (7, 5), (33, 17), (64, 64), (96, 40), (80, 80))[-count:]
    for width, height in ((1, 1), (7, 5), *sizes):
        for tree in [fw.sdf.union(*map(fw.sdf.from_dict, _SHAPES), fw.sdf.plane((0, 1, 0), 0.0)), *_trees()]:
            for k in (1.01, 8.0, 1000.0):
                camera = fw.Camera((3.0, 3.0, 4.0), (0, 0.6, 0), (0, 1, 0), 0.8)
                t, normal, seen = fast.render_sdf(tree, camera, width, height, light, k)
                hit = np.isfinite(t)
                outputs.append(np.concatenate([np.where(hit, t, 0).ravel(), normal.ravel(), seen.ravel()]))
                length = np.linalg.norm(normal, axis=-1)
                beyond += [np.maximum(-seen, seen - 1).max(), np.abs(np.where(hit, length - 1, length)).max()]
            origin, direction = camera.rays(width, height)
            there = tree(origin + np.where(hit, t, 0)[..., None] * direction)
            footprint = np.where(hit, t, 0) * 0.1 / min(height, 64)
            differing.append(np.where(footprint > 0, np.abs(there) - footprint, 0).max())
        for place in ((0.3, 1.0, -0.2), (0.3, 1.7, -0.2)):
            camera = fw.Camera(place, (5, 1, 3), (0, 1, 0), 0.8)
            inside.append(np.abs(fast.render_sdf(fw.sdf.from_dict(_SHAPES[0]), camera, width, height, light, 8.0)[0]).max())
    flat = np.concatenate(outputs)
    yield measured("fast.render_sdf", "outside [0, 1], or normals not unit", flat, np.array(beyond), 1e-5, "float32")
    yield measured("fast.render_sdf", "hits off the surface", flat, np.array(differing), 2e-3,
                   "a pixel's footprint; shapes without thickness")  # fmt: skip
    yield measured("fast.render_sdf", "t from inside and from the surface", np.array(inside), np.array(inside), 0,
                   "stated: 0 in all pixels")  # fmt: skip


def _twin(size):
    """Pictures of one scene at many scales, against closed-form rays: twice the size is twice the way."""
    light, values, errors, moved = fw.normalize([1.0, 2.0, 0.5]), [], [], []
    for scale in 4.0 ** np.arange(-6, 9):
        field = fw.sdf.scale(fw.sdf.union(*map(fw.sdf.from_dict, _SHAPES)), scale)
        camera = fw.Camera((3.0 * scale, 3.0 * scale, 4.0 * scale), (0, 0.6 * scale, 0), (0, 1, 0), 0.8)
        t, normal, _ = fast.render_sdf(field, camera, size, size, light, 8.0, 40 * scale, offset=0.005 * scale,
                                       t_min=0.02 * scale, shadow_t_max=12 * scale)  # fmt: skip
        origin, direction = (a.reshape(-1, 3) / s for a, s in zip(camera.rays(size, size), (scale, 1.0), strict=True))
        exact, _ = truth_rays.cast(_SHAPES, origin, direction)
        hit, t = np.isfinite(t.ravel()), t.ravel() / scale
        both = hit & np.isfinite(exact)
        values += [np.where(hit, t, 0.0), normal.ravel()]
        errors.append(np.percentile(np.abs(t[both] / exact[both] - 1), 99))
        moved.append(np.mean(hit != np.isfinite(exact)))
    yield measured("fast.render_sdf", "relative error of t, 99th percentile", values, np.array(errors), 1e-3,
                   "stated; scales of 4^-6 to 4^8")  # fmt: skip
    yield measured("fast.render_sdf", "pixels hit or missed wrongly", values, np.array(moved), 6 / size,
                   "half a pixel along four outlines")  # fmt: skip


def _grids(rng, count):
    values, beyond, sign = [], [], []
    for scale in (1e-4, 1.0, 1e5):
        for far in (0.0, 1e3):
            mesh = fw.mesh.sphere(scale, (far * scale, 0, 0), 24, 48)
            grid = fw.sdf.from_mesh(mesh, 12)
            p = rng.uniform(-2, 2, (count, 3))
            value, radius = grid(scale * p + [far * scale, 0, 0]) / scale, np.linalg.norm(p, axis=1)
            values.append(value)
            # The mesh lies between the ball and one smaller by the sagitta of its facets.
            beyond.append(np.abs(value) - np.abs(np.where(radius > 1, radius - 0.985, 1 - radius)))
            sign.append(np.where(radius > 1, value < -1e-6, np.where(radius < 0.985, value > 1e-6, False)))
    size = 1e-4
    yield measured("from_mesh", "larger than the distance", values, np.array(beyond), size,
                   "conservative; float32 samples at 1e3 radii")  # fmt: skip
    yield measured("from_mesh", "of the wrong sign", values, np.array(sign), 0, "stated: right, or 0")
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1e-9], [0.5, 0, 0]])
    meshes = [[[0, 1, 2]], [[0, 1, 4]], [[0, 0, 0]], [[0, 1, 2], [0, 1, 2]], [[0, 1, 2], [0, 2, 1]], [[0, 1, 2], [1, 3, 2]]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # open meshes are reported as such
        found = [fw.sdf.from_mesh(fw.Mesh(vertices, faces), n)(_points(rng, count // 12)) for faces in meshes for n in (1, 7)]
    yield measured("from_mesh", "below 0 around what has no inside", found, -np.array(found), 0,
                   "slivers, points, doubled faces")  # fmt: skip
