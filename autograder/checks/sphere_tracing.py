"""Checks 1.1 to 1.7: distance functions, blending, normals, sphere tracing."""

import numpy as np

from autograder.checks import Assignment, Function, field_of, like
from autograder.student import Counted
from autograder.wall import Returns

assignment = Assignment("sphere_tracing", forbidden=("sdf", "sdf_primitives", "sdf_operators"))
SLICE = 64


@assignment.task("1.1", Function("sdf_sphere", field_of(0, 1)))
def sdf_sphere(trial):
    """The signed distance to a sphere: negative inside, zero on it, positive outside."""
    center, radius = trial.rng.uniform(-1, 1, 3), trial.rng.uniform(0.4, 1.5)
    _show_slice(trial, "a slice through the middle of the sphere", center, radius)
    away = _directions(trial.rng, 200)
    yield trial.close("on the surface", trial.call(center + radius * away, center, radius), 0.0,
                      property=True, message="points of the surface have the distance 0")  # fmt: skip
    far = trial.rng.uniform(1.01, 4, 200)
    yield trial.close("outside", trial.call(center + (radius * far)[:, None] * away, center, radius),
                      radius * (far - 1), message="outside, the distance is how far the surface is")  # fmt: skip
    near = trial.rng.uniform(0, 0.99, 200)
    yield trial.close("inside", trial.call(center + (radius * near)[:, None] * away, center, radius),
                      radius * (near - 1), message="inside, the distance is negative")  # fmt: skip
    yield _any_shape(trial, center, radius)


@assignment.task("1.2", Function("sdf_box", field_of(0, 1, 2)))
def sdf_box(trial):
    """The exact signed distance to a box: also off its edges and corners, and negative inside."""
    center, half = trial.rng.uniform(-1, 1, 3), trial.rng.uniform(0.3, 1.2, 3)
    _show_slice(trial, "a slice through the middle of the box", center, half)
    side = np.where(trial.rng.random((300, 3)) < 0.5, -1.0, 1.0)
    beyond = trial.rng.uniform(0.1, 2, (300, 3)) * (trial.rng.random((300, 3)) < 0.6)
    within = trial.rng.uniform(0, 0.99, (300, 3))
    p = center + side * np.where(beyond > 0, half + beyond, within * half)
    outside = (beyond > 0).any(axis=1)
    yield trial.close("outside", trial.call(p[outside], center, half), np.linalg.norm(beyond[outside], axis=1),
                      message="outside, the distance is to the nearest face, edge or corner")  # fmt: skip
    p = center + side * within * half
    yield trial.close("inside", trial.call(p, center, half), -np.min(half - within * half, axis=1),
                      message="inside, the distance is negative: minus the way to the nearest face")  # fmt: skip
    yield _any_shape(trial, center, half)


@assignment.task("1.3", Function("sdf_torus", field_of(0, 1)))
def sdf_torus(trial):
    """The exact signed distance to a torus that lies flat: its axis is +y."""
    center, major = trial.rng.uniform(-1, 1, 3), trial.rng.uniform(0.7, 1.4)
    minor = trial.rng.uniform(0.2, 0.5) * major
    _show_slice(trial, "an upright slice through the axis", center, major, minor, axes=(0, 1))
    turn, around = trial.rng.uniform(0, 2 * np.pi, (2, 400))
    for name, low, high in (("outside", 1.01, major / minor), ("inside", 0.0, 0.99)):
        tube = minor * trial.rng.uniform(low, high, 400)
        # from the tube's centre line outwards, but not across the axis
        ring = major + tube * np.cos(around)
        p = center + np.stack([ring * np.sin(turn), tube * np.sin(around), ring * np.cos(turn)], axis=-1)
        yield trial.close(name, trial.call(p, center, major, minor), tube - minor,
                          message=f"{name} the tube, the distance is to its surface, along +y and across")  # fmt: skip
    height = trial.rng.uniform(-2, 2, 50)
    p = center + height[:, None] * np.array([0.0, 1.0, 0.0])
    yield trial.close("on the axis", trial.call(p, center, major, minor), np.hypot(major, height) - minor,
                      message="on the axis, the whole ring is equally far")  # fmt: skip
    yield _any_shape(trial, center, major, minor)


@assignment.task("1.4", Function("blend", field_of()))
def blend(trial):
    """A mix of two distances: all of the first at t = 0, all of the second at t = 1."""
    d1, d2 = _two_fields(trial.rng)
    t = 0.5 + trial.rng.uniform(0.1, 0.3) * trial.rng.choice([-1, 1])
    trial.show(*_images(trial.both(d1, d2, t)), "distance", f"two spheres, t = {t:.2f}")
    d1, d2 = trial.rng.uniform(-2, 2, (2, 200))
    yield trial.close("ends", [trial.call(d1, d2, 0.0), trial.call(d1, d2, 1.0)], [d1, d2], share=0.5,
                      message="t = 0 gives the first distance, t = 1 the second")  # fmt: skip
    yield trial.close("between", trial.call(d1, d2, t), d1 + t * (d2 - d1),
                      message="between, the weights are 1 - t and t")  # fmt: skip
    many = trial.rng.random(200)
    yield trial.survives("an array of t", lambda: [trial.close("between", trial.call(d1, d2, many),
                         d1 + many * (d2 - d1))], share=0.25, message="t may be an array.")  # fmt: skip


@assignment.task("1.5", Function("smooth_union", field_of()))
def smooth_union(trial):
    """A union whose crease is rounded within a band of width k: the quadratic smooth minimum."""
    d1, d2 = _two_fields(trial.rng)
    k = trial.rng.uniform(0.3, 0.8)
    trial.show(*_images(trial.both(d1, d2, k)), "distance", f"two spheres, k = {k:.2f}")
    d1 = trial.rng.uniform(-2, 2, 300)
    apart = trial.rng.uniform(1.0, 3.0, 300) * k * np.where(trial.rng.random(300) < 0.5, -1, 1)
    yield trial.close("outside the band", trial.call(d1, d1 + apart, k), np.minimum(d1, d1 + apart), share=0.75,
                      message="where the distances differ by k or more, the smaller one is the answer")  # fmt: skip
    near = trial.rng.uniform(-1, 1, 300) * k
    got = trial.call(d1, d1 + near, k)
    want = np.minimum(d1, d1 + near) - (k - np.abs(near)) ** 2 / (4 * k)
    yield trial.close("inside the band", got, want, share=1.75,
                      message="where both distances are near, the surface swells: by k / 4 where they are equal")  # fmt: skip
    yield trial.close("symmetric", trial.call(d1 + near, d1, k), got, share=0.5,
                      property=True, message="the order of the two shapes does not matter")  # fmt: skip
    small, large = (trial.call(s * d1, s * (d1 + near), s * k) / s for s in (1e-3, 1e3))
    yield trial.close("any scale", [small, large], [want, want], share=0.5,
                      message="a scene that is scaled, k with it, gives scaled distances")  # fmt: skip


@assignment.task("1.6", Function("estimate_normal", like(1, 3)))
def estimate_normal(trial):
    """The direction in which the distance grows fastest, as unit vectors."""
    scene, eps = _scene(trial.rng), 5e-4
    origin, direction = _camera(trial.rng, 32, 24)
    p = _hits(scene, origin, direction)
    true, got = _gradient(scene, p), trial.call(Counted(scene), p, eps)
    trial.show(0.5 + 0.5 * got.reshape(24, 32, 3), 0.5 + 0.5 * true.reshape(24, 32, 3), "color",
               "normals as colours, where the rays of a small picture meet the scene")  # fmt: skip
    # a field may grow slower than the distance does, as a blend of two does
    normal, slope = _directions(trial.rng, 1)[0], trial.rng.uniform(0.3, 0.7)
    points = trial.rng.uniform(-5, 5, (100, 3))
    flat = trial.call(Counted(lambda q: slope * (q @ normal)), points, 1e-2)
    length = np.linalg.norm(np.concatenate([got, flat]), axis=-1)
    yield trial.close("unit length", length, 1.0, property=True, message="a normal has length 1")
    center, radius = trial.rng.uniform(-1, 1, 3), trial.rng.uniform(0.5, 2.0)
    away = _directions(trial.rng, 200)
    sphere = Counted(lambda q: np.linalg.norm(q - center, axis=-1) - radius)
    yield trial.close("sphere", trial.call(sphere, center + radius * away, 1e-3 * radius), away,
                      message="on a sphere, the normal points away from the centre")  # fmt: skip
    yield trial.close("plane", flat, np.broadcast_to(normal, flat.shape),
                      message="a plane has one normal everywhere, whatever eps is, however slowly the field grows")  # fmt: skip
    # at creases of the union the gradient jumps: the worst tenth is left out
    error = np.linalg.norm(got - true, axis=-1)
    yield trial.at_most("scene", np.quantile(error, 0.9), message="the normals of a scene of several shapes")


def _rays(*arguments):
    count = np.shape(arguments[1])[0]
    return Returns(((count,), (count,)), sequence=True)


@assignment.task("1.7", Function("sphere_trace", _rays, infinite=True))
def sphere_trace(trial):
    """Where rays first meet the surface, marching by the distance: hits, misses, and no wasted evaluations."""
    width, height, eps = 32, 24, 1e-4
    scene = _scene(trial.rng)
    origin, direction = _camera(trial.rng, width, height)
    sdf = Counted(scene)
    t, hit = _checked(trial, sdf, origin, direction, 40.0, eps, 256)
    work = sdf.count
    t_true = _march(scene, origin, direction, 40.0)
    found = np.isfinite(t_true)
    trial.show(t.reshape(height, width), t_true.reshape(height, width), "scalar", "distance along each ray")
    yield trial.at_most("misses are infinite", float(np.mean(np.isfinite(t) != hit)), share=0.5, property=True,
                        message="t is inf exactly where hit is false")  # fmt: skip

    for name, (message, situations) in _situations().items():
        wrong = max(_wrong(trial, **situation) for situation in situations)
        yield trial.at_most(name, wrong, share=0.4, property=True, message=message)

    yield trial.at_most("hits and misses", float(np.mean(hit != found)), share=1.5,
                        message="some rays that should hit miss, or the other way round")  # fmt: skip
    both = hit & found
    normal = _gradient(scene, origin[both] + t_true[both, None] * direction[both])
    cosine = np.maximum(-np.sum(normal * direction[both], axis=1), 0.05)
    error = np.abs(t[both] - t_true[both]) * cosine / eps
    yield trial.at_most("distance along the ray", float(np.quantile(error, 0.99)) if both.any() else np.inf, share=2.0,
                        message="t is not where the surface is")  # fmt: skip
    yield trial.work(work, width * height)


def _situations():
    """Single situations in front of the plane z = 0, or where all is equally far: what is a hit is said word for word."""
    plane = lambda p: -p[..., 2]  # noqa: E731
    constant = lambda distance: lambda p: np.full(p.shape[:-1], distance)  # noqa: E731
    before, inside, on = [-5.0, -3.0, -8.0], [0.5, 2.0, 0.1], [-8e-5, -5e-5, -2e-5]
    miss, now = [np.inf] * 3, [0.0] * 3
    return {
        "starts inside": ("a ray that starts inside hits at t = 0", [
            {"field": plane, "z": inside, "want": now}]),
        "starts on the surface": ("the origin is the first point to be tested, wherever the ray goes", [
            {"field": plane, "z": on, "want": now}, {"field": plane, "z": on, "want": now, "along": -1.0}]),
        "t_max": ("a surface beyond t_max is a miss", [
            {"field": plane, "z": before, "want": [np.inf, 3.0, np.inf], "t_max": 4.0}]),
        "eps": ("a visited point is a hit where the distance is less than eps, and only there", [
            {"field": constant(0.05), "z": before, "want": now, "eps": 0.1},
            {"field": constant(0.2), "z": before, "want": miss, "eps": 0.1, "t_max": 5.0}]),
        "max_steps": ("a ray has max_steps evaluations, no fewer and no more; without a hit it is a miss", [
            {"field": plane, "z": on, "want": now, "max_steps": 1},
            {"field": constant(0.5), "z": before, "want": miss, "t_max": 1e6, "max_steps": 12}]),
    }  # fmt: skip


def _wrong(trial, field, z, want, along=1.0, t_max=40.0, eps=1e-4, max_steps=64):
    """The fraction of rays along z whose t or hit is wrong; all are, where more was evaluated than allowed."""
    origin = np.stack([[0.3, 0.0, 1.0], [-0.2, 0.1, 0.0], z], axis=-1)
    sdf, direction = Counted(field), np.tile([0.0, 0.0, along], (len(z), 1))
    t, hit = _checked(trial, sdf, origin, direction, t_max, eps, max_steps)
    found = np.isfinite(want)
    off = np.abs(np.where(found & hit, t, 0.0) - np.where(found & hit, want, 0.0)) > 3 * eps
    return 1.0 if sdf.count > max_steps * len(z) else float(np.mean((hit != found) | off))


def _checked(trial, *arguments):
    t, hit = trial.call(*arguments)
    return t, hit > 0.5


def _any_shape(trial, *arguments):
    """One point, none, and a grid of points are as good as a list of them."""

    def cases():
        for shape in ((3,), (0, 3), (2, 4, 3)):
            yield trial.close("outside", *trial.both(trial.rng.uniform(-3, 3, shape), *arguments))

    return trial.survives("any shape", cases, share=0.25,
                          message="p may be one point (3,), a grid (2, 4, 3) or empty (0, 3).")  # fmt: skip


def _directions(rng, count):
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def _show_slice(trial, caption, center, *arguments, axes=(0, 2)):
    """Show the distances in a slice through the centre; asked for as a list of points, as any answer takes them."""
    both = trial.both(_slice(center, axes), center, *arguments)
    trial.show(*_images(both), "distance", caption)


def _images(values):
    return [np.reshape(v, (SLICE, SLICE)) for v in values]


def _slice(center, axes=(0, 2), extent=2.2):
    x, y = np.meshgrid(np.linspace(-extent, extent, SLICE), np.linspace(extent, -extent, SLICE))
    points = np.zeros((SLICE * SLICE, 3))
    points[:, axes[0]], points[:, axes[1]] = x.ravel(), y.ravel()
    return points + center


def _two_fields(rng):
    points = _slice(np.zeros(3))
    a, b = rng.uniform(-1.0, -0.4, 3), rng.uniform(0.4, 1.0, 3)
    a[1] = b[1] = 0
    return np.linalg.norm(points - a, axis=-1) - 0.7, np.linalg.norm(points - b, axis=-1) - 0.6


def _scene(rng):
    """A ground, a sphere, a box and a torus in general position; the whole turned at random about the axis."""
    turn = rng.uniform(0, 2 * np.pi)
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    jitter = rng.uniform(-0.15, 0.15, (3, 3))

    def scene(p):
        q = np.asarray(p, float) @ rotation.T
        ground = q[..., 1]
        sphere = np.linalg.norm(q - ([0.9, 0.9, 0.2] + jitter[0]), axis=-1) - 0.8
        b = np.abs(q - ([-0.9, 0.6, 0.5] + jitter[1])) - [0.5, 0.6, 0.4]
        box = np.linalg.norm(np.maximum(b, 0), axis=-1) + np.minimum(b.max(axis=-1), 0)
        v = q - ([-0.1, 0.4, -1.2] + jitter[2])
        torus = np.hypot(np.hypot(v[..., 0], v[..., 2]) - 0.6, v[..., 1]) - 0.2
        return np.minimum(np.minimum(ground, sphere), np.minimum(box, torus))

    return scene


def _camera(rng, width, height):
    from framework.camera import Camera

    turn = rng.uniform(0, 2 * np.pi)
    position = np.array([5 * np.sin(turn), 2.2, 5 * np.cos(turn)])
    camera = Camera(position, np.array([0, 0.7, 0]), np.array([0, 1.0, 0]), 0.7)
    origin, direction = camera.rays(width, height)
    return origin.reshape(-1, 3).copy(), direction.reshape(-1, 3).copy()


def _march(scene, origin, direction, t_max):
    """Distances to the surface, ten thousand times tighter than what is asked for: the checks' own truth."""
    t, result, active = np.zeros(len(origin)), np.full(len(origin), np.inf), np.arange(len(origin))
    for _ in range(4000):
        d = scene(origin[active] + t[active, None] * direction[active])
        result[active[d <= 1e-8]] = t[active[d <= 1e-8]]
        active, d = active[d > 1e-8], d[d > 1e-8]
        t[active] += d
        active = active[t[active] <= t_max]
        if not active.size:
            break
    return result


def _hits(scene, origin, direction):
    t = _march(scene, origin, direction, 40.0)
    return origin + np.where(np.isfinite(t), t, 20.0)[:, None] * direction


def _gradient(scene, p, eps=1e-6):
    steps = eps * np.eye(3)
    gradient = np.stack([scene(p + s) - scene(p - s) for s in steps], axis=-1)
    return gradient / np.maximum(np.linalg.norm(gradient, axis=-1, keepdims=True), 1e-300)
