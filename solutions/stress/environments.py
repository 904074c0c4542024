"""Look-ups, cubes, samples and lights, under suns in one texel, checkerboards, seams and poles."""

import numpy as np

import framework as fw
from solutions import environment_shadows, fast, prefilter, truth_maps
from solutions.stress import ROUGHNESS, measured, relative


def rows(share):
    rng = np.random.default_rng(33)
    yield from _look_up(rng, int(12_000 * share))
    yield from _resampled()
    yield from _sampled(rng, int(60_000 * share))
    yield from _chains(rng, int(6_000 * share))
    yield from _lights()
    yield from _split(rng, int(400 * share))


def maps():
    """Environments by name: suns at a pole, on the seam and in the open, a checkerboard, noise, one of two pixels."""
    rows, columns = np.indices((8, 16))
    board = np.repeat(((rows + columns) % 2 * 1e3)[..., None], 3, axis=2)
    noise = np.exp(np.random.default_rng(5).normal(0, 3, (7, 14, 3)))
    return {
        "constant": fw.skies.constant(5, 0.7), "pole": fw.skies.single_texel(8, 0, 3),
        "seam": fw.skies.single_texel(9, 4, 0),
        "sun": fw.Environment(fw.skies.single_texel(16, 5, 9).pixels + fw.skies.gradient(16).pixels),
        "checkerboard": fw.Environment(board), "noise": fw.Environment(noise),
        "smallest": fw.Environment([[[1, 2, 3], [0, 0, 9]]]),
    }  # fmt: skip


def _directions(rng, count):
    """Evenly about, at poles and seam and within ulps of both, (N, 3), unit."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    near = np.repeat(axes, 8, axis=0)
    near = near + 10.0 ** rng.uniform(-17, -3, (len(near), 1)) * rng.normal(size=near.shape)
    return fw.normalize(np.concatenate([axes, near, rng.normal(size=(count, 3))]))


def _look_up(rng, count):
    direction = _directions(rng, count)
    found, errors, lengths, beyond, turns, compiled = [], [], [], [], [], []
    for env in maps().values():
        value, top = env.radiance(direction), env.pixels.max()
        found.append(value)
        errors.append(np.abs(value - truth_maps.bilinear(env.pixels, direction)) / top)
        beyond += [(value - env.pixels.max((0, 1))) / top, (env.pixels.min((0, 1)) - value) / top]
        for length in (1e-250, 1e-160, 1e-4, 1e5, 1e160, 1e250):
            lengths.append(np.abs(env.radiance(length * direction) - value) / top)
            compiled.append(np.abs(fast.sample_chain([env.pixels], [0.0], length * direction, 0.0) - value) / top)
        quarter = fw.Environment(np.roll(env.pixels, env.height // 2, axis=1))
        if env.height % 2 == 0:  # a quarter turn is a whole number of pixels
            turned = quarter.radiance(direction @ [[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
            turns.append((np.abs(turned - value) / top)[np.hypot(direction[:, 0], direction[:, 2]) > 0])
    reason = "an ulp of the angle, times the map's slope"
    yield measured("Environment.radiance", "error over the map's top", found, np.array(errors), 1e-13, reason)
    yield measured("Environment.radiance", "beyond the map's extremes", found, np.array(beyond), 1e-15, "a convex sum")
    yield measured("Environment.radiance", "changed by a direction's length", lengths, np.array(lengths), 1e-13, reason)
    yield measured("Environment.radiance", "changed by a quarter turn", turns, np.array(turns), 1e-13, "all but the poles")
    yield measured("fast.sample_chain", "difference of the twins over the top, lengths to 1e250", compiled, np.array(compiled),
                   1e-6, "float32 texels")  # fmt: skip


def _resampled():
    kept, constant, negative = [], [], []
    for env in maps().values():
        total = np.einsum("hwk,hw->k", env.pixels, env.solid_angles())
        for height in (1, 2, 3, 5, 8, 17, 64):
            small = env.resized(height)
            kept.append(relative(np.einsum("hwk,hw->k", small.pixels, small.solid_angles()), total))
            negative.append(float(-small.pixels.min()))
        kept.append(relative(np.einsum("hwk,hw->k", (last := env.mips()[-1]).pixels, last.solid_angles()), total))
    for size in (1, 2, 3, 7):
        faces = fw.skies.constant(5, 0.7).to_cube(size)
        constant += [np.abs(faces - 0.7).max(), np.abs(fw.Environment.from_cube(faces).pixels - 0.7).max()]
        negative += [float(-env.to_cube(size).min()) for env in maps().values()]
    yield measured("Environment.resized, mips", "light lost or won, relative", kept, np.array(kept), 1e-13, "exact overlaps")
    yield measured("to_cube, from_cube", "change of a constant map", constant, np.array(constant), 1e-14, "weights add up to 1")
    yield measured("resized, to_cube", "below 0", negative, np.array(negative), 0, "no weight is negative")
    flat = np.concatenate([np.ravel(s.pixels) for h in (1, 2, 3, 7, 32) for s in _skies(h)])
    yield measured("skies", "below 0", flat, -flat, 0, "light")
    lit = np.concatenate([[0.0], 10.0 ** np.linspace(-4, 5, 997)])
    shown = [fw.tone_map(np.repeat(lit[:, None, None], 3, axis=2), exposure) for exposure in (-20.0, 0.0, 20.0)]
    falls = np.array([-np.diff(image.astype(float), axis=0) for image in shown])
    yield measured("tone_map", "fall with radiance", shown, falls, 0, "brighter is not darker")


def _skies(height):
    sky = fw.skies
    return [sky.constant(height), sky.gradient(height), sky.sun_and_sky(height), sky.studio(height), sky.single_texel(height),
            sky.orientation(height)]  # fmt: skip


def _sampled(rng, count):
    u = np.concatenate([[0.0, 1e-300, 1e-17, 0.5, 1 - 2.0**-24, 1 - 2.0**-53], rng.uniform(0, 1, count)])
    phi = rng.choice([0.0, 0.25, 0.5, 1 - 2.0**-53, *rng.uniform(0, 1, 50)], len(u))
    samplers = ("fw.sample_ggx", fw.sample_ggx, [1, 0]), ("prefilter.sample_ggx", prefilter.sample_ggx, [0, 1])
    for name, sample, order in samplers:
        found, unit, errors = [], [], []
        for alpha in np.maximum(ROUGHNESS**2, 1e-8):
            h = sample(np.stack([u, phi], axis=1)[:, order], alpha)
            sine = np.hypot(h[:, 0], h[:, 1])
            wide = u.astype(np.longdouble)
            exact = alpha * np.sqrt(wide / (1 - wide))
            exact = exact / np.sqrt(1 + exact * exact)
            found.append(h)
            unit.append(np.abs(np.sqrt((h**2).sum(1)) - 1))
            errors.append(relative(sine, exact, 1e-290))
        yield measured(name, "sine's relative error", found, np.array(errors), 1e-14, "1 - u is exact", points=len(u) * 14)
        beyond = np.maximum(np.array(unit), -np.array(found)[..., 2])
        yield measured(name, "length off 1, below the horizon", found, beyond, 1e-15,
                       "two roundings", points=len(u) * 14)  # fmt: skip


def _chains(rng, count):
    direction = _directions(rng, count)
    rough = np.concatenate([np.resize(ROUGHNESS, len(direction) - count), rng.uniform(-0.1, 1.1, count)])
    pairs = []
    for env in maps().values():
        chain, levels = [env.resized(h).pixels for h in (9, 4, 1)], [0.0, 0.045, 1.0]
        light = fw.EnvironmentLight(env, chain[-1], chain, levels, np.ones((1, 1, 2)))
        values = (prefilter.sample_chain(chain, levels, direction, rough), light.prefiltered(direction, rough),
                  fast.sample_chain(chain, levels, direction, rough))  # fmt: skip
        pairs.append(np.array(values) / max(env.pixels.max(), 1e-300))
    found = np.array(pairs)
    away = np.abs(found[:, 1:] - found[:, :1])
    yield measured("sample_chain, prefiltered", "difference over the top", found[:, :2], away[:, 0], 1e-13,
                   "one sum")  # fmt: skip
    yield measured("fast.sample_chain",
                   "difference of the twins over the top", found[:, 2], away[:, 1], 1e-6,  # fmt: skip
                   "float32 texels")  # fmt: skip


def _lights():
    kept, unit, values = [], [], []
    for env in maps().values():
        total = np.einsum("hwk,hw->k", env.pixels, env.solid_angles())
        for count in sorted({1, 2, 3, 7, 16, env.pixels[..., 0].size}):
            if count <= env.pixels[..., 0].size:
                direction, power = environment_shadows.dominant_lights(env, count)
                values += [direction, power]
                unit.append(np.abs(np.linalg.norm(direction, axis=1) - 1).max())
                kept.append(relative(power.sum(0), total).max())
        light = fast.environment_light(env)
        values += [light.irradiance_map, *light.chain]
    flat = np.concatenate([np.ravel(v) for v in values])
    yield measured("dominant_lights", "power lost or won, relative", flat, np.array(kept), 1e-12, "sums over a partition")
    yield measured("dominant_lights", "length off 1", np.array(unit), np.array(unit), 1e-15, "two roundings")


def _split(rng, count):
    found, errors, scaled = [], [], []
    for _ in range(count):
        n = rng.integers(1, 40)
        f, g, w = 10.0 ** rng.uniform(-4, 5, (3, n)) * (rng.random((3, n)) < 0.8)
        wide = [a.astype(np.longdouble) for a in (f, g, w)]
        support = g != 0
        extent = wide[2][support].sum()
        exact = (wide[0] * wide[2])[support].sum() / extent * (wide[1] * wide[2])[support].sum() if extent > 0 else 0
        found.append(prefilter.classic_approximation(f, g, w))
        errors.append(relative(found[-1], exact))
        scaled.append(relative(prefilter.classic_approximation(f, 4 * g, w), 4 * found[-1]))
    yield measured("classic_approximation", "relative error", found, np.array(errors), 1e-13, "sums of 40 positive terms")
    yield measured("classic_approximation", "not linear in g", found, np.array(scaled), 0, "a power of two")
