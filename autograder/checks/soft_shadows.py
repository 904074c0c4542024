"""Checks 2.1 to 2.5: safe angles, penumbrae, shadow rays, soft shadows, round lights."""

import numpy as np

from autograder.checks import Assignment, Function, field_of, like, tolerance
from autograder.checks.shadow_scenes import (
    MARCH,
    PIXELS,
    Scene,
    across_the_shade,
    floor_from_above,
    ground,
    light_above,
)
from autograder.student import Counted

assignment = Assignment("soft_shadows")
SIZES = (2.0, 8.0, 32.0)


@assignment.task("2.1", Function("safe_angle", field_of()))
def safe_angle(trial):
    """The angle about the ray within which nothing is in the way: between 0 and pi / 2."""
    angle, travelled = trial.rng.uniform(0.005, 1.4, 300), _lengths(trial.rng, 300)
    distance = travelled * np.sin(angle)
    yield trial.close("tangent", trial.call(distance, travelled), angle, share=2.0,
                      message="a ball of this radius, so far away, is seen under this half angle")  # fmt: skip
    yield _any_scale(trial, distance, travelled, angle)
    yield from _ends(trial, np.pi / 2, 1.0)
    yield _any_shape(trial, "tangent")
    yield _map(trial, np.linspace(-0.4, 2, 64))


@assignment.task("2.2", Function("penumbra", field_of()))
def penumbra(trial):
    """k times the distance over the way travelled, from 0 to 1: the cheap stand-in for the safe angle."""
    want, travelled = trial.rng.uniform(0.01, 0.99, (3, 100)), _lengths(trial.rng, (3, 100))
    distance = want * travelled / np.array(SIZES)[:, None]
    got = [trial.call(d, t, k) for d, t, k in zip(distance, travelled, SIZES, strict=True)]
    yield trial.close("proportional", got, want, share=2.0,
                      message="k distance / travelled where that is below 1, for k = 2, 8 and 32")  # fmt: skip
    yield _any_scale(trial, distance[1], travelled[1], want[1], SIZES[1])
    k = SIZES[trial.rng.integers(3)]
    yield from _ends(trial, 1.0, 1 / k, k)
    yield _any_shape(trial, "proportional", k)
    yield _map(trial, np.linspace(-0.1, 0.5, 64), 8.0)


def _ends(trial, top, least, *k):
    """The ends of the domain; a plain quotient gives NaN there, which costs the measure, not the task."""
    ahead, outside, inside = trial.rng.uniform(0.1, 5, (3, 40))
    larger = np.exp(trial.rng.uniform(0, 3, 40))
    larger[:10], inside[:10] = 1.0, 0.0
    behind = np.where(np.arange(40) < 20, 0.0, -ahead)
    cases = {
        "inside": (-inside, ahead, np.zeros(40), "0 on and inside an object"),
        "wide": (ahead * least * larger, ahead, np.full(40, top), f"{top:.4g} where the ball is large enough"),
        "no way": (np.concatenate([outside, -inside]), np.tile(behind, 2), np.repeat([top, 0], 40),
                   f"without any way travelled {top:.4g} outside of objects, 0 inside"),
    }  # fmt: skip
    for name, (distance, travelled, want, message) in cases.items():
        yield trial.survives(name, lambda d=distance, t=travelled, w=want, n=name: [
            trial.close(n, trial.call(d, t, *k), w)], share=0.75, message=message + ".")  # fmt: skip


def _any_scale(trial, distance, travelled, want, *k):
    got = [trial.call(scale * distance, scale * travelled, *k) for scale in (1e-4, 1e6)]
    return trial.close("any scale", got, [want, want], share=0.5,
                       message="only the quotient counts: the same in a scene of any size")  # fmt: skip


def _any_shape(trial, name, *k):
    shapes = [((), ()), ((2, 3), (2, 3)), ((3, 1), (4,)), ((5,), ()), ((0,), (0,))]

    def cases():
        for first, second in shapes:
            # uniform gives a number of Python for the shape ()
            d, t = trial.rng.uniform(0.01, 0.09, first or None), trial.rng.uniform(3, 9, second or None)
            yield trial.close(name, *trial.both(d, t, *k))

    return trial.survives("any shape", cases, share=0.5,
                          message="arguments may be numbers, or arrays of any shapes that broadcast.")  # fmt: skip


def _map(trial, distance, *k):
    distance, travelled = np.meshgrid(distance, np.linspace(-0.25, 2, 64))

    def picture():
        yours, expected = trial.both(distance, travelled, *k)
        trial.show(yours, expected, "scalar", "over the distance, to the right, and the way travelled, down")
        yield trial.close("map", yours, expected)

    return trial.survives("map", picture, share=0.5, message="everywhere, inside and out.")


@assignment.task("2.3", Function("needs_shadow_ray", like(0)))
def needs_shadow_ray(trial):
    """True where the light is above the horizon: where alone a shadow ray can change anything."""
    normal, to_light = _directions(trial.rng, 400), _directions(trial.rng, 400)
    cosine = np.sum(normal * to_light, axis=1)
    clear = np.abs(cosine) > 1e-3
    yield _decided(trial, "above and below", normal[clear], to_light[clear], cosine[clear] > 0, share=2.0,
                   message="True where the angle to the light is less than a right one, False where it is more")  # fmt: skip
    for name, cosine, message in (
        ("at the horizon", np.zeros(24), "a cosine of exactly 0 is no light: False"),
        (
            "near the horizon",
            np.tile([1e-9, -1e-9, 1e-4], 8),
            "the sign of the cosine decides, however small",
        ),
    ):
        # along the axes the sum of products is exact, in any order and precision
        axis, flip = trial.rng.integers(3, size=24), trial.rng.choice([-1.0, 1.0], 24)
        normal = flip[:, None] * np.eye(3)[axis]
        to_light = cosine[:, None] * normal + np.sqrt(1 - cosine**2)[:, None] * np.eye(3)[axis - 1]
        yield _decided(trial, name, normal, to_light, cosine > 0, property=True, message=message)
    size, light = 48, light_above(trial.rng)
    light[2] = abs(light[2])
    x, y = np.meshgrid(*2 * [(2 * np.arange(size) + 1) / size - 1])
    inside = x * x + y * y < 1
    ball = np.stack([x, -y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)[inside]

    def picture():
        answer, want = np.zeros((2, size, size))
        answer[inside], want[inside] = trial.call(ball, light), ball @ light > 0
        trial.show(answer > 0, want > 0, "mask", "a ball, and the part of it that one light reaches")
        yield trial.at_most("one light", float(np.mean(answer != want)))
        trial.call(ball[:0], light)

    yield trial.survives("one light", picture,
                         message="to_light may be (3,), one light for all points, and there may be no point.")  # fmt: skip


def _decided(trial, name, normal, to_light, want, **how):
    return trial.at_most(name, float(np.mean(trial.call(normal, to_light) != want)), **how)


@assignment.task("2.4", Function("soft_shadow", like(1)))
def soft_shadow(trial):
    """Visibility from the smallest penumbra along one ray to the light, without wasted evaluations."""
    for name, field, origin, light, rest, want, message in _situations(trial.rng):
        sdf = Counted(field)
        error = np.max(np.abs(trial.call(sdf, origin, light, *rest) - want))
        beyond = sdf.count > (rest[-1] + 1) * len(origin)
        yield trial.at_most(name, np.inf if beyond else error, share=0.4, property=True, message=message)

    scene, light = Scene.ball_and_box(trial.rng), light_above(trial.rng)
    points = ground(trial.rng, 6000)
    expected = [trial.expected.soft_shadow(scene, points, light, k, *MARCH) for k in SIZES]
    half = [np.flatnonzero((e > 0) & (e < 1))[:32] for e in expected]
    chosen = np.concatenate(half)
    got = [trial.call(Counted(scene), points[chosen], light, k, *MARCH) for k in SIZES]
    limits = np.zeros(len(chosen)), np.ones(len(chosen))
    falls = -np.min(np.diff([limits[0], *got, limits[1]], axis=0))
    yield trial.at_most("order", falls, share=0.4, property=True,
                        message="from 0 to 1, and nowhere darker for a larger k, which is a smaller light")  # fmt: skip
    last = np.cumsum([len(h) for h in half])
    for k, own, end, answer, want in zip(SIZES, half, last, got, expected, strict=True):
        yield trial.at_most(f"half shade, k = {k:g}", _trimmed(answer[end - len(own) : end] - want[own]),
                            message="the smallest penumbra of the points that a ray visits")  # fmt: skip
    some, lights = points[half[1]], np.array([light_above(trial.rng) for _ in half[1]])

    def a_light_each():
        yours, want = trial.both(Counted(scene), some, lights, 8.0, *MARCH)
        yield trial.at_most("half shade, k = 8", _trimmed(yours - want))
        trial.call(Counted(scene), some[:0], light, 8.0, *MARCH)

    yield trial.survives("a light each", a_light_each, share=0.4,
                         message="to_light may be (N, 3), a light for each point, and there may be no point.")  # fmt: skip
    origin = floor_from_above(light)
    blocked, grown = (scene.stops(origin, light[None], margin)[:, 0] for margin in (-0.01, 0.01))
    sure = np.flatnonzero(blocked == grown)[::3]
    hard = trial.call(Counted(scene), origin[sure], light, 1e7, *MARCH)
    yield trial.at_most("hard shadow", float(np.mean(np.abs(hard - ~blocked[sure]))),
                        message="for a very small light, points are lit or dark, as straight rays say")  # fmt: skip
    sdf = Counted(scene)
    answer = trial.call(sdf, origin, light, 8.0, *MARCH)
    want = trial.expected.soft_shadow(scene, origin, light, 8.0, *MARCH)
    trial.show(*(v.reshape(PIXELS, PIXELS) for v in (answer, want)), "scalar",
               "the floor under a ball and a box, from above, k = 8")  # fmt: skip
    error = np.sqrt(np.mean((answer - want) ** 2))
    yield trial.at_most("picture", error, message="the shadows of a ball and a box")
    yield trial.work(sdf.count, len(origin))


def _situations(rng):
    """Fields whose answer is known without a march, so that each says one thing; the light is along +z."""
    up, two = np.array([0.0, 0.0, 1.0]), np.array([[0.0, 0, 0], [9.0, 0, 0]])
    seen, near = rng.uniform(0.2, 0.9), rng.uniform(1.6, 2.4)
    slant = np.array([np.sqrt(1 - seen**2 / 4), 0, seen / 2])
    ball = lambda c, r: lambda p: np.linalg.norm(p - np.array(c), axis=-1) - r  # noqa: E731
    both = lambda f, g: lambda p: np.minimum(f(p), g(p))  # noqa: E731
    gaps = lambda p: np.where(p[..., 0] < 5, 0.5e-4, 2e-4)  # noqa: E731
    return [
        ("own floor", lambda p: p[..., 2] + 0.0, ground(rng, 4)[:, [0, 2, 1]], slant, (2.0, 0.02, 2.0, 256), seen,
         "above a plane, distance / travelled is the cosine of the light all along the ray"),
        ("t_min", both(ball((0, 0, 0), 0.1), ball((9, 0, near), 0.5)), two, up, (2.0, 0.3, 4.0, 64), [1, 0],
         "what lies before t_min does not count"),
        ("t_max", both(ball((0, 0, 5 + near), 0.5), ball((9, 0, near), 0.5)), two, up, (2.0, 0.02, 3.0, 64), [1, 0],
         "what lies beyond t_max does not count"),
        ("blocked", gaps, two, up, (1e6, 0.02, 0.1, 20), [0, 1],
         "a ray that comes closer than 1e-4 is blocked, any other is not"),
        ("out of steps", lambda p: np.full(p.shape[:-1], 0.1), two, up, (3 * near, 1.0, 1e3, 4), near * 0.3 / 1.3,
         "a ray that has used its max_steps evaluations keeps what it has"),
    ]  # fmt: skip


@assignment.task("2.5", Function("area_light_shadow", like(1)))
def area_light_shadow(trial):
    """The fraction of a round light that is seen, told from one ray that goes on inside what is in the way."""
    radius = np.arcsin(1 / 8)
    scene, center = Scene.ball(trial.rng)
    light = light_above(trial.rng)
    yield _free_and_hidden(trial, scene, center, light, radius)
    lights = np.array([light_above(trial.rng) for _ in range(8)])
    yield trial.survives("a light each", lambda: [_free_and_hidden(trial, scene, center, lights, radius)],
                         share=0.4, message="to_light may be (N, 3), a light for each point.")  # fmt: skip
    wall, along, origin = Scene.wall(trial.rng, radius)
    got = trial.call(Counted(wall), origin, along, radius, *MARCH)
    steps = np.diff(got)
    falls = max(-steps.min(), steps.max() - 0.2, got[0], 1 - got[-1])
    yield trial.at_most("across an edge", falls, share=0.4, property=True,
                        message="from 0 to 1, never darker on the way out of a shadow, and without a jump")  # fmt: skip
    yield _graded(trial, "straight edge", got, wall.visible(origin, along, radius))

    fields = {
        "ball, k = 8": scene,
        "ball and box, k = 32": Scene.ball_and_box(trial.rng),
        "large box, k = 2": Scene.large_box(trial.rng),
    }
    for (name, field), k in zip(fields.items(), (8, 32, 2), strict=True):
        light, radius = light_above(trial.rng), np.arcsin(1 / k)
        origin = across_the_shade(trial.rng, field, light, radius)
        got = trial.call(Counted(field), origin, light, radius, *MARCH)
        yield _graded(trial, name, got, field.visible(origin, light, radius))
    scene, light, radius = Scene.ball_and_box(trial.rng), light_above(trial.rng), np.arcsin(1 / 5)
    origin = floor_from_above(light)
    got = trial.call(Counted(scene), origin, light, radius, *MARCH)
    want = scene.visible(origin, light, radius, 512)
    trial.show(*(v.reshape(PIXELS, PIXELS) for v in (got, want)), "scalar",
               "the floor under a ball and a box, from above; expected: 512 rays a point")  # fmt: skip
    yield _graded(trial, "picture", got, want)


def _free_and_hidden(trial, scene, center, light, radius):
    """Points whose ray leads away from the ball, through its middle, and to it only beyond t_max."""
    way = np.broadcast_to(light * (center[1] / light[..., 1:2]), (8, 3))
    spread = trial.rng.uniform(-0.1, 0.1, (8, 3)) * [1, 0, 1]
    got = [
        trial.call(Counted(scene), origin + spread, light, radius, t_min, t_max, 256)
        for origin, t_min, t_max in ((center + way, 0.02, 8.0), (center - way, 0.2, 8.0), (center - way, 0.02, 0.2))
    ]
    return trial.close("free and hidden", got, np.array([[1.0], [0.0], [1.0]]), share=0.4, property=True,
                       message="1 where nothing is in the way up to t_max, 0 where all of the light is hidden")  # fmt: skip


def _graded(trial, name, got, want):
    """Full marks near the reference's error, half at that of the form without signs, none at twice that."""
    # a fully lit or dark point adds its error, but makes the mean no smaller
    half_shaded = np.sum((want > 0) & (want < 1))
    record, error = tolerance("2.5", name), float(np.sum(np.abs(got - want)) / half_shaded)
    full, half = record["tolerance"], record["half"]
    if error <= half:
        credit = 1 - 0.5 * np.log(max(error, full) / full) / np.log(half / full)
    else:
        credit = max(1 - error / (2 * half), 0.0)
    message = (
        f"compared with rays to all of the light; half marks at {half:.2g}, which is the form without signed "
        f"distances, none from {2 * half:.2g}, and up to half marks each halving of the error is worth the same"
    )
    return trial.at_most(name, error, credit=float(credit), message=message)


def _trimmed(error):
    """The mean of all but the largest tenth: rays that graze an object differ with every rule of stepping."""
    return float(np.mean(np.sort(np.abs(error))[: max(int(0.9 * len(error)), 1)]))


def _lengths(rng, shape):
    return np.exp(rng.uniform(np.log(0.01), np.log(100), shape))


def _directions(rng, count):
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)
