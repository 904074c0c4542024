"""Checks 3.1 to 3.6: GGX samples, irradiance, prefiltered maps and their look-up, the split of a product."""

import numpy as np

from autograder.checks import Assignment, Function, fixed, like
from autograder.checks.filter_truth import (
    between,
    filtered,
    looked_up,
    map_shape,
    random_directions,
    soft_lights,
    split,
)
from autograder.wall import Returns
from framework.environment import Environment, pixel_directions

assignment = Assignment("prefilter")
SAMPLES = 256


def _distribution(arguments, values):
    """Half vectors as a distribution: either column of xi may be the tilt, and azimuths may start anywhere."""
    half = values[0]
    if len(half) < 100 or np.ndim(arguments[1]) or not np.isfinite(half).all():
        return values
    tilt, sector = np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2]), np.arctan2(half[:, 1], half[:, 0])
    sector = np.clip((sector / (2 * np.pi) % 1.0) * 8, 0, 7).astype(int)
    share = np.bincount(sector, minlength=8) / len(half)
    rank = np.bincount(sector, np.argsort(np.argsort(tilt)) / len(half), 8) / np.maximum(share * len(half), 1)
    steps = np.linspace(0.02, 0.98, 25)
    return [np.quantile(tilt, steps), np.quantile(np.linalg.norm(half, axis=1), steps), np.sort(share), np.sort(rank)]


@assignment.task("3.1", Function("sample_ggx", like(0, 3), digest=_distribution), forbidden=("ggx",))
def sample_ggx(trial):
    """Half vectors about +z that are distributed like the normals of GGX, seen from straight above."""
    count, wide = 20_000, trial.rng.uniform(0.25, 0.5)
    tilt, azimuth = [], []
    images: list[np.ndarray] = []
    for alpha in (wide, 1.0, trial.rng.uniform(0.02, 0.1), 1e-4):
        half = trial.call(trial.rng.random((count, 2)), alpha)
        images = images or [_histogram(half)]
        tilt.append(_share_within(half, alpha))
        azimuth.append(np.arctan2(half[:, 1], half[:, 0]) / (2 * np.pi) % 1.0)
        if alpha == 1.0:
            yield trial.close("unit length", np.linalg.norm(half, axis=1), 1.0, share=0.5, property=True,
                              message="a half vector has length 1")  # fmt: skip
            yield trial.at_most("upper half", float(np.mean(half[:, 2] < -1e-6)), share=0.5, property=True,
                                message="no half vector points below the surface: z >= 0")  # fmt: skip
    trial.show(images[0], _expected_histogram(images[0].shape, wide, count), "scalar",
               f"how many of {count} half vectors fall where: tilt downwards from +z to the horizon, "
               f"azimuth across; alpha = {wide:.2f}")  # fmt: skip
    names = ("tilt", "tilt at alpha = 1", "tilt in a narrow lobe", "tilt at alpha = 1e-4")
    for name, values, share in zip(names, tilt, (1.5, 0.5, 1.0, 0.5), strict=True):
        yield trial.at_most(name, _kolmogorov(values), share=share,
                            message="too many half vectors are upright, or too few")  # fmt: skip
    yield trial.at_most("azimuth", max(map(_kolmogorov, azimuth)), property=True,
                        message="all azimuths are equally likely")  # fmt: skip
    yield trial.at_most("tilt and azimuth", max(map(_dependence, tilt, azimuth)), share=2.0,
                        message="tilt and azimuth are independent: each takes a column of xi")  # fmt: skip

    def many_widths():
        alpha = trial.rng.uniform(0.05, 1.0, count)
        half = trial.call(trial.rng.random((count, 2)), alpha)
        yield trial.at_most("tilt", _kolmogorov(_share_within(half, alpha)))

    def corners():
        last = np.nextafter(1.0, 0.0)
        half = trial.call(np.array([[0.0, 0.0], [0.0, last], [last, 0.0], [last, last]]), wide)
        yield trial.close("unit length", np.linalg.norm(half, axis=1), 1.0)

    yield trial.survives("a width for each sample", many_widths, share=0.25, message="alpha may be an array.")
    yield trial.survives("corners", corners, share=0.25, message="xi = 0 and xi just below 1 give half vectors too.")


@assignment.task("3.2", Function("irradiance", lambda env, height: Returns((map_shape(height),))))
def irradiance(trial):
    """The cosine-weighted mean of the radiance above a surface, for each of its orientations."""
    env, height = soft_lights(trial.rng, 32), 8
    got, want = trial.call(env, height), filtered(env, 1.0, height)
    trial.show(got, want, "color", "what a white diffuse surface shows, for every normal")
    yield _constant(trial, "a constant map stays as it is; the cosine's integral is pi", 2)
    again = trial.call(Environment(np.roll(env.pixels, 8, axis=1)), height)
    yield trial.at_most("turned", _turned(again, got, want, 2), share=0.5, property=True,
                        message="a map turned about +y gives the same result, turned")  # fmt: skip
    axes, strength = random_directions(trial.rng, 3), trial.rng.uniform(0.5, 0.9)

    def two_ends(height, strength):
        return 1.0 + strength * (1.5 * (pixel_directions(height) @ axes.T) ** 2 - 0.5)

    # a cosine leaves a quarter of this band; its square would leave 2/5, a plain mean nothing
    got_ends = trial.call(Environment(two_ends(24, strength)), 6)
    yield trial.at_most("two ends", _off(got_ends, two_ends(6, strength / 4)),
                        message="light from both ends of an axis: a quarter of the difference remains")  # fmt: skip
    yield trial.at_most("values", _off(got, want), share=2.0,
                        message="each pixel is the mean over its hemisphere, weighted by n.l and the solid angle")  # fmt: skip


@assignment.task("3.3", Function("prefilter", lambda env, alpha, height, samples: Returns((map_shape(height),))))
def prefilter(trial):
    """Radiance blurred by a rough mirror's lobe: GGX with n = v = r, weighted by n.l and normalised."""
    env, alpha = soft_lights(trial.rng, 32), trial.rng.uniform(0.2, 0.3)
    got, want = trial.call(env, alpha, 6, SAMPLES), filtered(env, alpha, 6)
    trial.show(got, want, "color", f"the map seen in a rough mirror, alpha = {alpha:.2f}")
    yield _constant(trial, "weights are normalised: a constant map stays as it is", alpha, 2, SAMPLES)
    first = trial.call(env, 0.3, 2, SAMPLES)
    again = trial.call(Environment(np.roll(env.pixels, 16, axis=1)), 0.3, 2, SAMPLES)
    yield trial.at_most("turned", _turned(again, first, filtered(env, 0.3, 2), 1), share=0.5, property=True,
                        message="a map turned about +y gives the same result, turned")  # fmt: skip
    yield trial.at_most("values", _off(got, want), share=2.0,
                        message="each pixel is the mean over the lobe, weighted by n.l")  # fmt: skip
    # few pixels, many samples: what random samples leave of the error here is small beside any mistake's;
    # the tails by which GGX and Beckmann differ show best in lobes as wide as the lights
    for name, width, height, samples in (
        ("more samples", trial.rng.uniform(0.15, 0.22), 2, 4096),
        ("wide lobe", trial.rng.uniform(0.5, 0.6), 2, 1024),
        ("alpha = 1", 1.0, 2, 1024),
    ):  # fmt: skip
        got = trial.call(env, width, height, samples)
        yield trial.at_most(name, _off(got, filtered(env, width, height)), message=_LOBES[name])
    yield trial.at_most("narrow lobe", _off(trial.call(env, 1e-3, 2, SAMPLES), looked_up(env, 2)), share=0.5,
                        message="a lobe narrower than a pixel hardly changes the map")  # fmt: skip

    def mirrors():
        rough = Environment(trial.rng.random((12, 24, 3)))
        yield trial.close("alpha = 0", trial.call(rough, 0.0, 5, SAMPLES), looked_up(rough, 5))

    yield trial.survives("alpha = 0", mirrors, share=0.5,
                         message="alpha = 0 looks the map up at the centres of the result's pixels.")  # fmt: skip


_LOBES = {
    "more samples": "with more samples the mean comes nearer to the truth",
    "wide lobe": "in a wide lobe the weights n.l matter, and samples below the horizon count nothing",
    "alpha = 1": "at alpha = 1 the lobe is the cosine: the result is the irradiance over pi",
}


def _maps(env, roughness_levels, heights, samples):
    return Returns(tuple(map_shape(height) for height in heights), sequence=True)


@assignment.task("3.4", Function("prefilter_chain", _maps))
def prefilter_chain(trial):
    """A filtered map for each roughness, each straight from the environment, in the order that was asked for."""
    env = soft_lights(trial.rng, 32)
    for name, levels, heights in (
        ("mixed order", _shuffled(trial.rng, [0.35, 0.5, 0.65, 0.8]), np.full(4, 4)),
        ("close levels", np.linspace(0.4, 0.6, 6) + trial.rng.uniform(-0.02, 0.02), np.full(6, 4)),
        ("other heights", np.array([0.4, 0.55, 0.7]), trial.rng.permutation([8, 4, 2])),
    ):
        chain = trial.call(env, levels, heights, SAMPLES)
        want = [filtered(env, level**2, height) for level, height in zip(levels, heights, strict=True)]
        if name == "mixed order":
            trial.show(np.concatenate(chain), np.concatenate(want), "color",
                       "the maps, one below the other: roughness " + ", ".join(f"{level:g}" for level in levels))  # fmt: skip
        yield trial.at_most(name, max(map(_off, chain, want)), message=_CHAINS[name])

    def mirror():
        rough = Environment(trial.rng.random((8, 16, 3)))
        first, _ = trial.call(rough, np.array([0.0, 1.0]), np.array([6, 3]), SAMPLES)
        yield trial.close("mirror", first, looked_up(rough, 6))

    yield trial.survives("roughness 0", mirror, share=0.5, message="roughness 0 is the map itself, looked up.")


def _shuffled(rng, levels):
    """Four levels in an order that no sorting makes."""
    return np.array(levels)[[[2, 0, 3, 1], [1, 3, 0, 2]][rng.integers(2)]]


_CHAINS = {
    "mixed order": "each map has the width alpha = roughness squared, in the order of the levels",
    "close levels": "each map comes straight from the environment, not from the one before it",
    "other heights": "each map has its own height",
}


@assignment.task("3.5", Function("sample_chain", like(2, 3)))
def sample_chain(trial):
    """Filtered radiance between pixels and between levels: bilinear in two maps, linear in roughness."""
    levels = np.array([0.05, 0.2, 0.65, 0.9]) + trial.rng.uniform(-0.04, 0.04, 4)
    chain = [trial.rng.random(map_shape(height)) for height in (16, 8, 4, 2)]
    around, ramp = pixel_directions(12).reshape(-1, 3), np.tile(np.linspace(0, 1, 24), 12)
    got, want = trial.call(chain, levels, around, ramp), between(chain, levels, around, ramp)
    trial.show(got.reshape(map_shape(12)), want.reshape(map_shape(12)), "color",
               "random maps, looked up all around with a roughness that grows from left to right")  # fmt: skip
    flat = [np.full(map_shape(height), value) for height, value in zip((16, 8, 4, 2), (1.0, 3.0, 2.0, 7.0), strict=True)]
    roughness = trial.rng.uniform(levels[0], levels[-1], 200)
    want = np.interp(roughness, levels, [1.0, 3.0, 2.0, 7.0])[:, None]
    yield trial.close("between levels", trial.call(flat, levels, random_directions(trial.rng, 200), roughness), want,
                      message="between two levels the result is linear in roughness, though levels are uneven")  # fmt: skip
    for index in (1, 2):
        own = pixel_directions(len(chain[index])).reshape(-1, 3)
        yield trial.close("at a level", trial.call(chain, levels, own, np.full(len(own), levels[index])),
                          chain[index].reshape(-1, 3), share=0.5,
                          message="at a level, through the centre of a pixel, the result is that pixel")  # fmt: skip
    poles = np.array([[0.0, 1, 0], [0, -1, 0], [1e-3, 1, 0], [0, -1, 1e-3], [1e-4, 0, 1], [-1e-4, 0, 1], [0, 0, -1]])
    away = np.concatenate([random_directions(trial.rng, 150), poles / np.linalg.norm(poles, axis=1, keepdims=True)])
    roughness = trial.rng.uniform(levels[0], levels[-1], len(away))
    yield trial.close("everywhere", trial.call(chain, levels, away, roughness), between(chain, levels, away, roughness),
                      share=2.0, message="bilinear between the pixels of the two nearest levels")  # fmt: skip
    beyond = np.where(np.arange(len(away)) % 2, 0.0, 1.0)
    yield trial.close("beyond the ends", trial.call(chain, levels, away, beyond), between(chain, levels, away, beyond),
                      message="below the first and above the last roughness, the end level is the answer")  # fmt: skip

    value = float(trial.rng.uniform(levels[1], levels[2]))
    single = lambda: [trial.close("everywhere", *trial.both(chain, levels, away, value))]  # noqa: E731
    yield trial.survives("one roughness", single, share=0.5, message="roughness may be a single number.")


@assignment.task("3.6", Function("classic_approximation", fixed(())))
def classic_approximation(trial):
    """The mean of f over where g is, times the integral of g: what stands for the integral of their product."""
    x = (np.arange(200) + 0.5) / 200
    centers, widths = trial.rng.uniform(0.3, 0.7) + np.linspace(-0.25, 0.25, 10), np.linspace(0.1, 0.4, 10)
    weights, bump = np.full(200, 1 / 200), np.exp(-(((x - trial.rng.uniform(0.3, 0.7)) / 0.25) ** 2))
    image = np.empty((2, 10, 10))
    for i, center in enumerate(centers):
        for j, width in enumerate(widths):
            hat = np.where(np.abs(x - center) < width, 1 - ((x - center) / width) ** 2, 0.0)
            image[:, i, j] = trial.call(bump, hat, weights).item(), split(bump, hat, weights)
    trial.show(*image, "scalar", "a bump f and a bump g that wanders downwards and widens to the right")
    yield trial.close("bumps", *image, message="the mean of f is taken over g's support alone")

    def sample():
        f, g, weights = trial.rng.uniform(0.2, 2, 100), trial.rng.uniform(0.1, 2, 100), trial.rng.uniform(0, 0.03, 100)
        return f, np.where(trial.rng.random(100) < 0.4, 0.0, g), weights

    pairs = [(trial.call(*each).item(), split(*each)) for each in (sample() for _ in range(20))]
    yield trial.close("random samples", *np.transpose(pairs), share=2.0,
                      message="both sums are weighted by the quadrature weights")  # fmt: skip
    f, g, weights = sample()
    yield trial.close("constant f", trial.call(np.full(100, 1.7), g, weights), 1.7 * np.sum(g * weights), property=True,
                      message="a constant f comes out of the integral: the split is exact")  # fmt: skip
    signed = np.where(trial.rng.random(100) < 0.5, -g, g)
    yield trial.close("negative g", *trial.both(f, signed, weights), share=0.5,
                      message="where g is negative is its support too")  # fmt: skip
    nothing = lambda: [trial.close("random samples", trial.call(f, 0 * g, weights), 0.0)]  # noqa: E731
    yield trial.survives("no support", nothing, share=0.5, message="where g is 0 everywhere, the answer is 0.")


def _share_within(half, alpha):
    """The share of GGX's half vectors that are more upright than each of these: uniform, if the lobe is right."""
    sin2 = half[:, 0] ** 2 + half[:, 1] ** 2
    return sin2 / np.maximum(sin2 + (alpha * half[:, 2]) ** 2, 1e-300)


def _kolmogorov(values):
    """Kolmogorov's distance from the uniform distribution, times the root of the number of values."""
    steps = np.arange(len(values) + 1) / len(values)
    values = np.sort(values)
    return float(np.maximum(values - steps[:-1], steps[1:] - values).max() * np.sqrt(len(values)))


def _dependence(u, v, cells=8):
    """Chi-square of a table of two uniform variables, per degree of freedom."""
    table = np.histogram2d(u, v, bins=cells, range=((0, 1), (0, 1)))[0]
    expected = len(u) / cells**2
    return float(np.sum((table - expected) ** 2) / expected / (cells**2 - 1))


def _histogram(half):
    x, y, z = half.T
    span = ((0, np.pi / 2), (-np.pi, np.pi))
    return np.histogram2d(np.arctan2(np.hypot(x, y), z), np.arctan2(y, x), bins=(16, 32), range=span)[0]


def _expected_histogram(shape, alpha, count):
    edges = np.linspace(0, np.pi / 2, shape[0] + 1)
    within = _share_within(np.stack([np.sin(edges), 0 * edges, np.cos(edges)], axis=-1), alpha)
    return np.repeat(np.diff(within)[:, None] * count / shape[1], shape[1], axis=1)


def _off(got, want):
    """Root mean square of the error, over that of what varies in the truth."""
    return float(np.sqrt(np.mean((got - want) ** 2) / np.mean((want - want.mean(axis=(0, 1))) ** 2)))


def _constant(trial, message, *arguments):
    color = trial.rng.uniform(0.3, 2.0, 3)
    got = trial.call(Environment(np.broadcast_to(color, (32, 64, 3))), *arguments)
    return trial.close("constant map", got / color, 1.0, property=True, message=message)


def _turned(again, first, want, pixels):
    """How far the result for a map turned by some of the result's pixels is from the turned result."""
    return _off(want + again - np.roll(first, pixels, axis=1), want)
