"""Checks 5.1 to 5.3: lights that stand for a sky, how much of it a point sees, and shading with its shadows."""

import numpy as np

from autograder.checks import Assignment, Function, like
from autograder.checks import sky_scenes as scenes
from autograder.checks.sky_scenes import LUMINANCE, Solids
from autograder.student import Counted
from autograder.wall import Returns
from framework.arrays import normalize
from framework.environment import Environment

assignment = Assignment("environment_shadows")
T_MAX, SIDE = 4.0, 10


def _light_sent(arguments, values):
    """What lights send, however they are numbered: from which sides, how evenly, and along vectors of which length."""
    toward, power = values
    lobes = np.vstack([np.eye(3), -np.eye(3)] + [(2 * np.array(s) - 1) / np.sqrt(3) for s in np.ndindex(2, 2, 2)])
    spread = np.quantile(power @ LUMINANCE, np.linspace(0, 1, 9)) * len(power)
    return [_under(lobes, toward, power), spread, np.quantile(np.linalg.norm(toward, axis=1), np.linspace(0, 1, 5))]


_LIGHTS = Function(
    "dominant_lights", lambda env, count: Returns(((count, 3),) * 2, sequence=True), digest=_light_sent
)


@assignment.task("5.1", _LIGHTS)
def dominant_lights(trial):
    """A few lights that stand for a sky: of about equal energy, where its light comes from, as bright as all of it."""
    env = scenes.sky(trial.rng, 32)
    count = int(trial.rng.integers(40, 90))
    answers = {n: trial.call(env, n) for n in (1, 16, count)}
    lengths = np.concatenate([np.linalg.norm(toward, axis=1) for toward, _ in answers.values()])
    yield trial.close(
        "unit length", lengths, 1.0, share=0.5, property=True, message="directions have length 1"
    )
    total = _energy(env).sum(axis=0)
    sums = [power.sum(axis=0) for _, power in answers.values()]
    yield trial.close("total", sums, total, scale=total, property=True,
                      message="the powers add up to the map's radiance times solid angle, for each channel")  # fmt: skip
    centroid = normalize((_energy(env) @ LUMINANCE) @ env.directions().reshape(-1, 3))
    yield trial.close("one light", answers[1][0][0], centroid,
                      message="the only light stands at the centroid of all luminous energy")  # fmt: skip
    yield _sun(trial)
    for n in (16, count):
        power = answers[n][1] @ LUMINANCE
        uneven = power.max() / power.mean() - 1 if power.min() >= 0 < power.max() else np.inf
        yield trial.at_most(f"even, {'sixteen' if n == 16 else 'many'}", uneven,
                            property=True, message="of about equal luminous energy: none far above the mean")  # fmt: skip
    lobes = normalize(trial.rng.normal(size=(200, 3)))
    want = _under(lobes, env.directions().reshape(-1, 3), _energy(env))
    error = _relative(_under(lobes, *answers[count]), want)
    yield trial.at_most("where from", error, share=1.5,
                        message="from each side the lights send as much as the sky does")  # fmt: skip
    trial.show(*(_drawn(env, *pair) for pair in ((answers[16]), trial.expected.dominant_lights(env, 16))),
               "color", "sixteen lights on a map of 32 rows; other right cuts look different")  # fmt: skip
    yield _any_map(trial)


def _sun(trial):
    pixels, place = np.zeros((16, 32, 3)), tuple(trial.rng.integers((2, 0), (14, 32)))
    pixels[place] = trial.rng.uniform(1e3, 1e4, 3)
    env = Environment(pixels)
    errors = []
    for count in (1, 5):
        toward, power = trial.call(env, count)
        brightest = np.argmax(power @ LUMINANCE)
        errors += [np.abs(toward[brightest] - env.directions()[place]).max()]
        errors += [np.abs(power[brightest] / (pixels[place] * env.solid_angles()[place]) - 1).max()]
    return trial.at_most("sun", max(errors), message="a sun of one pixel becomes one light, at its centre")


def _any_map(trial):
    faint = Environment(trial.rng.uniform(0, 1, (4, 8, 3)))
    black, plain = Environment(np.zeros((4, 8, 3))), Environment(np.ones((4, 8, 3)))

    def cases():
        for env, count in ((faint, 32), (faint, 31), (faint, 2), (plain, 7), (black, 5), (plain, 1)):
            toward, power = trial.call(env, count)
            total = _energy(env).sum(axis=0)
            yield trial.close("unit length", np.linalg.norm(toward, axis=1), 1.0)
            yield trial.close("total", power.sum(axis=0), total, scale=np.maximum(total, 1e-3))

    return trial.survives("any count", cases,
                          message="any count up to the number of pixels, and any map, a black one too.")  # fmt: skip


def _energy(env):
    return (env.pixels * env.solid_angles()[..., None]).reshape(-1, 3)


def _under(lobes, toward, power):
    """Light gathered from around directions, by the fourth power of the cosine."""
    return np.maximum(lobes @ toward.T, 0) ** 4 @ power


def _drawn(env, toward, power):
    """The map with a light's power in the pixels around it."""
    image, d = 0.15 * env.pixels, env.directions()
    for direction, color in zip(toward, power, strict=True):
        image[d @ direction > np.cos(0.08)] = color / max(power.max(), 1e-12) + 0.2
    return image


@assignment.task("5.2", Function("ambient_visibility", like(1)))
def ambient_visibility(trial):
    """How much of the sky a point sees within t_max, each direction weighted by its cosine to the normal."""
    floor, normal = (
        np.insert(trial.rng.uniform(-1, 1, (8, 2)), 1, 0.0, axis=1),
        np.tile([0.0, 1.0, 0.0], (24, 1)),
    )
    nothing = trial.call(Counted(lambda p: np.full(p.shape[:-1], 10.0)), floor, normalize(floor + 0.5), 2.0)
    yield trial.close(
        "open space", nothing, 1.0, share=0.5, property=True, message="1 where nothing is around"
    )
    plane = trial.call(Counted(Solids()), floor, normal[:8], 2.0)
    yield trial.close("floor alone", plane, 1.0, share=0.5, property=True,
                      message="a floor does not hide the sky from itself")  # fmt: skip

    # close below it, the ball hides what the cosine weighs most
    radius = trial.rng.uniform(0.5, 0.7)
    ball = np.array([0, radius + trial.rng.uniform(0.15, 0.3), 0])
    p = np.insert(trial.rng.uniform(-0.5, 0.5, (24, 2)), 1, 0.0, axis=1)
    distance = np.linalg.norm(ball - p, axis=1)
    got = trial.call(Counted(Solids([(ball, radius)])), p, normal, 4.0)
    # the form factor of a ball above the horizon
    yield _rms(trial, "under a ball", got, 1 - radius**2 * ball[1] / distance**3,
               "1 less the share that a ball over a floor hides")  # fmt: skip

    wall = Solids([], [((0, 6, -5), (20, 6, 5))])
    away = trial.rng.uniform(0.1, 1.2, 24)
    p, normal = np.zeros((24, 3)), normal.copy()
    p[:12, 2], p[12:, 1], normal[12:] = away[:12], away[12:], [0, 0, 1]
    p[:, 0] = trial.rng.uniform(-1, 1, 24)
    got = trial.call(Counted(wall), p, normal, 1.5)
    yield _rms(
        trial, "corner", got, scenes.ambient(wall, p, normal, 1.5), "near a corner of a floor and a wall"
    )

    scene = Solids.ball_and_box(trial.rng)
    p, normal = scene.surface_points(trial.rng, 48)
    for name, t_max, message in (
        ("ball and box", T_MAX, "on a floor, a ball and a box"),
        ("near things alone", 0.4, "what lies beyond t_max hides nothing"),
    ):
        got = trial.call(Counted(scene), p, normal, t_max)
        yield _rms(trial, name, got, scenes.ambient(scene, p, normal, t_max), message)
    yield trial.survives("no point", lambda: [trial.close("open space", trial.call(
        Counted(scene), p[:0], normal[:0], T_MAX), 1.0)], share=0.25, message="there may be no point.")  # fmt: skip
    p, up = _floor(scene)
    got, want = trial.call(Counted(scene), p, up, T_MAX), scenes.ambient(scene, p, up, T_MAX)
    trial.show(*(_framed(v, p) for v in (got, want)), "scalar",
               "the floor around a ball and a box, from above; expected: 2048 rays a point")  # fmt: skip
    yield _rms(trial, "picture", got, want, "the floor around a ball and a box")


def _rms(trial, name, got, want, message):
    return trial.at_most(name, float(np.sqrt(np.mean((got - want) ** 2))), message=message)


@assignment.task("5.3", Function("shade_with_shadows", like(3, 3)))
def shade_with_shadows(trial):
    """A matt and a glossy part under a sky, each with the shadows that the sky casts, without wasted evaluations."""
    rng = trial.rng
    env, scene = scenes.sky(rng, 16, scenes.SUNNY), Solids.ball_and_box(rng)
    light = scenes.light_of(env)
    p, normal = scene.surface_points(rng, 40)
    view = normalize(normal + 0.9 * normalize(rng.normal(size=normal.shape)))
    r0, albedo, roughness = (
        rng.uniform(0.1, 0.9, (40, 3)),
        rng.uniform(0.2, 0.9, (40, 3)),
        rng.uniform(0.2, 0.4, 40),
    )

    behind = trial.call(light, Counted(scene), p, normal, -view, r0, roughness, 0.0, T_MAX)
    yield trial.close("nothing left", behind, 0.0, share=0.25, property=True,
                      message="0 where the albedo is 0 and n.v is 0 or less")  # fmt: skip
    far = Counted(lambda x: np.full(x.shape[:-1], 10.0))
    matt, gloss = albedo * light.irradiance(normal), scenes.split_sum(light, normal, view, r0, roughness)
    got = trial.call(light, far, p, normal, view, r0, roughness, 0.3 * albedo, T_MAX)
    # the split sum by itself, of rougher mirrors: there the table's scale is far below 1
    alone = trial.call(light, far, p, normal, view, r0, 2.2 * roughness, 0.0, T_MAX)
    want = scenes.split_sum(light, normal, view, r0, 2.2 * roughness)
    off = max(_relative(got, 0.3 * matt + gloss), _relative(alone, want))
    yield trial.at_most("nothing in the way", off, share=0.75,
                        message="without occluders: the albedo times the irradiance, plus the split sum")  # fmt: skip

    got = trial.call(light, Counted(scene), p, normal, -normal, r0, roughness, albedo, T_MAX)
    shadowed, _ = scenes.diffuse(env, scene, p, normal, T_MAX)
    yield _graded(trial, "matt", got, albedo * shadowed, matt, 1.5)
    half = trial.call(light, Counted(scene), p, normal, -normal, r0, roughness, 0.5 * albedo, T_MAX)
    yield trial.close("albedo", 2 * half, got, scale=max(np.abs(got).max(), 1e-9), share=0.25, property=True,
                      message="the matt part is proportional to the albedo")  # fmt: skip
    yield _glossy(trial, scene, r0, roughness)

    even = scenes.light_of(Environment(np.broadcast_to(rng.uniform(0.3, 1, 3), (8, 16, 3))))
    got = trial.call(even, Counted(scene), p, normal, -normal, 0.04, 0.5, 1.0, T_MAX)
    shadowed, _ = scenes.diffuse(even.env, scene, p, normal, T_MAX, 1024)
    yield _graded(trial, "constant sky", got, shadowed, even.irradiance(normal), 0.5)

    def shapes():
        whole = trial.call(light, Counted(scene), p[:3], normal[:3], view[:3], np.full((3, 3), 0.3),
                           np.full(3, 0.4), np.full((3, 3), 0.5), T_MAX)  # fmt: skip
        for a, b in ((0.3, 0.5), (np.full(3, 0.3), np.full(3, 0.5))):
            got = trial.call(light, Counted(scene), p[:3], normal[:3], view[:3], a, 0.4, b, T_MAX)
            yield trial.close("albedo", got, whole)
        none = p[:0]
        trial.call(light, Counted(scene), none, none, none, 0.3, 0.4, 0.5, T_MAX)

    yield trial.survives("any shape", shapes, share=0.25,
                         message="r0 and albedo may be numbers or colours, roughness a number, and no point.")  # fmt: skip
    p, normal = _floor(scene)
    view = normalize(np.array([0.0, 2.5, 3.5]) - p)
    sdf = Counted(scene)
    got = trial.call(light, sdf, p, normal, view, 0.5, 0.3, 0.6, T_MAX)
    shadowed, _ = scenes.diffuse(env, scene, p, normal, T_MAX, 1024)
    want = 0.6 * shadowed + scenes.specular(env, scene, p, normal, view, 0.5, 0.3, T_MAX, 512)
    trial.show(*(_framed(v, p) for v in (got, want)), "color",
               "the floor around a ball and a box, from above; expected: 1536 rays a point")  # fmt: skip
    plain = 0.6 * light.irradiance(normal) + scenes.split_sum(light, normal, view, 0.5, 0.3)
    yield _graded(trial, "picture", got, want, plain, 1.0)
    yield trial.work(sdf.count, len(p))


def _glossy(trial, scene, r0, roughness):
    """Mirrors of which half show something near, below a sky so soft that the split sum itself errs little."""
    env = scenes.sky(trial.rng, 16, scenes.SOFT, spread=6.0)
    light = scenes.light_of(env)
    p, normal, view = scene.mirrors(trial.rng, len(r0), T_MAX)
    got = trial.call(light, Counted(scene), p, normal, view, r0, roughness, 0.0, T_MAX)
    want = scenes.specular(env, scene, p, normal, view, r0, roughness, T_MAX)
    return _graded(trial, "glossy", got, want, scenes.split_sum(light, normal, view, r0, roughness), 1.0)


def _graded(trial, name, got, want, plain, share):
    """Full marks within the tolerance, none at the error of shading without shadows, even steps between."""
    error = float(np.sqrt(np.mean((got - want) ** 2)) / np.sqrt(np.mean((plain - want) ** 2)))
    full = trial.at_most(name, error).tolerance
    credit = float(np.clip((1 - error) / (1 - full), 0, 1))
    message = (
        "the error against rays to all of the sky, over that of shading without shadows, which earns nothing"
    )
    return trial.at_most(name, error, share=share, credit=credit, message=message)


def _relative(got, want):
    return float(np.sqrt(np.mean((got - want) ** 2) / np.mean(want**2)))


def _floor(scene):
    """Points of the floor from above, those below objects left out, and their normals."""
    side = 1.6 * ((2 * np.arange(SIDE) + 1) / SIDE - 1)
    x, z = np.meshgrid(side, side)
    p = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)
    p = p[scene(p + [0, 0.05, 0]) > 0.04]
    return p, np.tile([0.0, 1.0, 0.0], (len(p), 1))


def _framed(values, p):
    """Values at points of the floor as an image, 0 below objects."""
    image = np.zeros((SIDE, SIDE, *values.shape[1:]))
    column, row = (np.rint((p[:, axis] / 1.6 + 1) * SIDE / 2 - 0.5).astype(int) for axis in (0, 2))
    image[row, column] = values
    return image
