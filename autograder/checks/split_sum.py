"""Checks 4.5 to 4.8, of what is an integral: light under a sky, its table, and the split sum; 4.1 to 4.4 are before it."""

import numpy as np

from autograder.checks import Function, like
from autograder.checks import reflection_truth as truth
from autograder.checks.microfacets import assignment
from autograder.checks.reflection_inputs import PIXELS, above, image, sky, sphere, tilted
from autograder.wall import Returns
from framework.arrays import dot, normalize

SEEDS, SAMPLES, LUT_SAMPLES = 32, 64, 8192


@assignment.task("4.5", Function("monte_carlo_shade", like(1, 3)))
def monte_carlo_shade(trial):
    """All the light of a sky that a rough mirror sends to the viewer: noisy, but right on average."""
    rng, env = trial.rng, sky(trial.rng)
    normal, view, _ = above(rng, 10)
    view = tilted(rng, normal, np.tile([0.3, 0.45, 0.6, 0.75, 0.95], 2))
    # little is reflected straight on where the view is low: there Fresnel's angle matters most
    most = np.tile([0.1, 0.1, 0.9, 0.9, 0.9], 2)
    r0, alpha = rng.uniform(0.04, most[:, None], (10, 3)), np.repeat([0.9, 0.4], 5)
    mean, variance = truth.reflected(env, normal, view, r0, alpha)
    seeds = rng.integers(2**32, size=SEEDS)
    runs = np.array(
        [trial.call(env, normal, view, r0, alpha, SAMPLES, np.random.default_rng(s)) for s in seeds]
    )  # fmt: skip
    doubt = runs.std(axis=0, ddof=1) / np.sqrt(SEEDS)
    yield trial.at_most("right on average", np.max(np.abs(runs.mean(axis=0) - mean) / (doubt + 0.01 * mean)), share=2.0,
                        message=f"the mean of {SEEDS} runs is off by more than chance explains")  # fmt: skip
    noise = np.mean(runs.var(axis=0, ddof=1) / mean**2) / np.mean(variance / SAMPLES / mean**2)
    yield trial.at_most("noise", np.sqrt(noise), share=0.5, property=True,
                        message="more noise than directions drawn by the cosine of the light have")  # fmt: skip
    again = trial.call(env, normal, view, r0, alpha, SAMPLES, np.random.default_rng(seeds[0]))
    yield trial.close("repeatable", again, runs[0], scale=mean, share=0.25, property=True,
                      message="the same generator gives the same answer: draw from rng alone")  # fmt: skip

    def below():
        yield trial.close(
            "below", trial.call(env, normal, -view, r0, alpha, 8, np.random.default_rng(1)), 0.0
        )
        up, across = np.array([[0.0, 1, 0]]), np.array([[1.0, 0, 0]])
        yield trial.close("below", trial.call(env, up, across, 0.5, 0.3, 8, np.random.default_rng(1)), 0.0)

    yield trial.survives("horizon", below, share=0.25, message="0 where the view is at or below the horizon.")

    def shapes():
        for r0, alpha in ((0.5, 0.4), (np.array([0.1, 0.2, 0.3]), np.full(10, 0.4)), (0.5, 1e-4)):
            got = trial.call(env, normal, view, r0, alpha, 8, np.random.default_rng(2))
            yield trial.at_most("negative", np.max(-got))
        trial.call(env, np.zeros((0, 3)), np.zeros((0, 3)), 0.5, 0.3, 8, np.random.default_rng(2))

    yield trial.survives("any shape", shapes, share=0.25, message=(
        "r0 may be a number, (3,) or (N, 3), alpha a number down to 1e-4 or (N,), and N may be 0."))  # fmt: skip
    normal, view = sphere(20)
    r0, alpha = np.tile([0.9, 0.6, 0.3], (len(normal), 1)), np.full(len(normal), 0.4)
    got = trial.call(env, normal, view, r0, alpha, SAMPLES, np.random.default_rng(seeds[1]))
    want, variance = truth.reflected(env, normal, view, r0, alpha, 16, 32)
    trial.show(
        image(got, 20), image(want, 20), "color", f"a ball of rough gold under a sky, {SAMPLES} samples"
    )
    off = np.sqrt(np.mean((got - want) ** 2) / np.mean(variance / SAMPLES))
    yield trial.at_most(
        "picture", off, share=0.25, property=True, message="the picture is wrong by more than noise"
    )


@assignment.task("4.6", Function("brdf_lut", lambda size, *_: Returns(((size, size, 2),))))
def brdf_lut(trial):
    """The second half of the split sum: what a white sky gives, as scale and bias of r0, over roughness and cosine."""
    size = 8 + int(trial.rng.integers(2))
    want, got = truth.table(size), trial.call(size, LUT_SAMPLES)
    trial.show(*(np.concatenate([t, 0 * t[..., :1]], axis=-1) for t in (got, want)), "color",
               "scale in red, bias in green; the cosine to the right, the roughness down")  # fmt: skip
    for channel, name in enumerate(("scale", "bias")):
        error = np.sqrt(np.mean((got[..., channel] - want[..., channel]) ** 2))
        yield trial.at_most(
            name, error, share=1.5, message=f"the {name} on average over the table, with {LUT_SAMPLES} samples"
        )
    corner = np.ix_([0, -1], [0, -1])
    yield trial.close("corners", got[corner], want[corner], share=0.5, property=True,
                      message="smooth and rough, from above and at grazing angles")  # fmt: skip
    excess = max(got.sum(axis=-1).max() - 1, -got.min(), 0)
    yield trial.at_most("energy", excess, share=0.5, property=True,
                        message="neither is negative, and together they never give more than what came in")  # fmt: skip
    small = int(trial.rng.integers(4, 6))

    def sizes():
        for n in (small, 1):
            error = trial.call(n, LUT_SAMPLES) - truth.table(n)
            yield trial.at_most("other sizes", np.sqrt(np.mean(error**2)))

    yield trial.survives("other sizes, more samples", sizes, share=0.5,
                         message=f"sizes {small} and 1, cell centres at (i + 0.5) / size.")  # fmt: skip


def _entries(lut, cos_theta, roughness):
    return Returns((np.broadcast_shapes(np.shape(cos_theta), np.shape(roughness)) + (2,),))


@assignment.task("4.7", Function("sample_lut", _entries))
def sample_lut(trial):
    """The table between its entries: bilinear, and level beyond the outermost centres."""
    rng = trial.rng
    lut = rng.uniform(0, 1, (4, 4, 2))
    cosine, roughness = np.meshgrid(np.linspace(0, 1, PIXELS), np.linspace(0, 1, PIXELS))
    trial.show(*(np.concatenate([t, 0 * t[..., :1]], axis=-1) for t in trial.both(lut, cosine, roughness)), "color",
               "a table of 4 x 4 random entries; the cosine to the right, the roughness down")  # fmt: skip
    lut = rng.uniform(0, 1, (8, 8, 2))
    column, row = np.meshgrid(np.arange(8), np.arange(8))
    yield trial.close("at the centres", trial.call(lut, (column + 0.5) / 8, (row + 0.5) / 8), lut,
                      message="at (i + 0.5) / size the entries themselves: roughness by rows, cosine by columns")  # fmt: skip
    inside = rng.uniform(1 / 16, 15 / 16, (2, 200))
    yield trial.close("between", trial.call(lut, *inside), truth.bilinear(lut, *inside), share=1.5,
                      message="between the centres, a mix of the four around")  # fmt: skip
    edge = rng.uniform(0, 1, (2, 80))
    edge[rng.integers(2, size=80), np.arange(80)] = rng.uniform(0, 1 / 16, 80)
    edge = np.concatenate([edge, 1 - edge, [[0, 0, 1, 1], [0, 1, 0, 1]]], axis=1)

    def level():
        yield trial.close("between", trial.call(lut, *edge), truth.bilinear(lut, *edge))

    yield trial.survives("clamped", level, share=0.75, message="beyond the outermost centres their values.")

    def sizes():
        for size in (1, 2, 3, 32):
            lut, at = rng.uniform(0, 1, (size, size, 2)), rng.uniform(0, 1, (2, 50))
            yield trial.close("between", trial.call(lut, *at), truth.bilinear(lut, *at))

    yield trial.survives("any size", sizes, share=0.5, message="tables of 1, 2, 3 and 32 rows.")

    def shapes():
        for pair in (((), ()), ((5,), ()), ((4, 1), (3,)), ((0,), (0,))):
            at = [rng.uniform(0.1, 0.9, s) if s else float(rng.uniform(0.1, 0.9)) for s in pair]
            yield trial.close("between", trial.call(lut, *at), truth.bilinear(lut, *np.broadcast_arrays(*at)))

    yield trial.survives("any shape", shapes, share=0.25,
                         message="cos_theta and roughness may be numbers, or arrays that broadcast.")  # fmt: skip


@assignment.task("4.8", Function("shade_split_sum", like(0, 3)))
def shade_split_sum(trial):
    """The whole light of a sky in two look-ups: the filtered sky in the mirror direction, times r0 scale + bias."""
    rng = trial.rng
    lut = truth.table(8)
    turn = normalize(rng.normal(size=(3, 3)))

    def prefiltered(direction, roughness):
        direction = np.asarray(direction, float)
        roughness = np.broadcast_to(np.asarray(roughness, float), direction.shape[:-1])
        return 1.5 + (1 - 0.7 * roughness[..., None]) * (direction @ turn)

    def right(normal, view, r0, roughness, lut):
        cosine = dot(normal, view)
        scale, bias = np.moveaxis(truth.bilinear(lut, cosine, roughness), -1, 0)[..., None]
        return prefiltered(2 * cosine[:, None] * normal - view, roughness) * (r0 * scale + bias)

    normal, view = sphere()
    ball = normal, view, np.array([0.9, 0.6, 0.3]), np.full(len(normal), 0.3)
    got = trial.call(*ball, prefiltered, lut)
    trial.show(image(got), image(right(*ball, lut)), "color", "a ball of rough gold under a filtered sky")
    noise = rng.uniform(0, 1, (8, 8, 2))
    for name, low, high, share, message in (
        ("values", 0.3, 1.0, 1.5, "prefiltered(mirror direction, roughness) * (r0 * scale + bias)"),
        ("grazing", 0.02, 0.3, 1.0, "r0 is that of normal incidence: Fresnel is in the table already"),
    ):
        normal = above(rng, 200)[0]
        view = tilted(rng, normal, rng.uniform(low, high, 200))
        some = normal, view, rng.uniform(0.02, 0.9, (200, 3)), rng.uniform(0, 1, 200)
        got = [trial.call(*some, prefiltered, t) for t in (lut, noise)]
        want = np.array([right(*some, t) for t in (lut, noise)])
        yield trial.close(name, got, want, share=share, message=message)

    def below():
        yield trial.close("below", trial.call(normal, -view, *some[2:], prefiltered, lut), 0.0)
        up, across = np.array([[0.0, 1, 0]]), np.array([[1.0, 0, 0]])
        yield trial.close("below", trial.call(up, across, 0.5, 0.3, prefiltered, lut), 0.0)

    yield trial.survives("horizon", below, share=0.5, message="0 where the view is at or below the horizon.")

    def shapes():
        for r0, roughness in ((0.3, 0.4), (np.array([0.1, 0.5, 0.9]), some[3]), (some[2], 0.7)):
            each = np.broadcast_to(roughness, 200)
            got = trial.call(normal, view, r0, roughness, prefiltered, lut)
            yield trial.close("values", got, right(normal, view, r0, each, lut))
        trial.call(np.zeros((0, 3)), np.zeros((0, 3)), 0.3, 0.4, prefiltered, lut)

    yield trial.survives("any shape", shapes, share=0.5, message=(
        "r0 may be a number, (3,) or (N, 3), roughness a number or (N,), and N may be 0."))  # fmt: skip
