"""Checks 4.1 to 4.8: Fresnel, normal distributions, masking, the BRDF, its integral under a sky, and the split sum."""

import numpy as np

from autograder.checks import Assignment, Function, Measure, field_of, like
from autograder.checks import reflection_truth as truth
from autograder.checks.reflection_inputs import (
    PIXELS,
    above,
    image,
    logarithmic,
    near_the_mirror,
    sky,
    sphere,
    tilted,
)
from autograder.student import Failure
from autograder.wall import Returns
from framework.arrays import dot, normalize

assignment = Assignment("split_sum")
SEEDS, SAMPLES = 32, 64


@assignment.task("4.1", Function("fresnel_schlick", field_of()), Function("r0_from_ior", field_of()))
def fresnel(trial):
    """How much a surface reflects at an angle, by Schlick, and how much straight on, from two indices of refraction."""
    yield from _parts(trial, {"fresnel_schlick": (_schlick, 3.0), "r0_from_ior": (_r0_from_ior, 1.5)})


def _schlick(trial):
    cosine, r0 = np.meshgrid(np.linspace(0, 1, PIXELS), np.linspace(0, 1, PIXELS))
    trial.show(*trial.both(r0, cosine), "scalar", "over the cosine, to the right, and r0, down")
    r0, cosine = trial.rng.uniform(0.02, 0.9, 200), trial.rng.uniform(0.02, 0.98, 200)
    yield trial.close("ends", [trial.call(r0, np.ones(200)), trial.call(r0, np.zeros(200))], [r0, np.ones(200)],
                      share=0.5, property=True, message="r0 straight on, 1 at a right angle")  # fmt: skip
    yield trial.close("between", trial.call(r0, cosine), truth.schlick(r0, cosine), share=2.0,
                      message="from r0 to 1 with the fifth power of 1 - cos_theta")  # fmt: skip
    yield _any_shape(trial, "between", ((0.5, 0.9), (0.1, 0.9)))


def _r0_from_ior(trial):
    n1, n2 = trial.rng.uniform(1, 2.5, (2, 200))
    n1[:50], n2[:2] = 1.0, (1.5, 1.0)
    got = trial.call(n1, n2, name="r0_from_ior")
    yield trial.close("two media", got, ((n1 - n2) / (n1 + n2)) ** 2,
                      message="the square of (n1 - n2) / (n1 + n2)")  # fmt: skip
    yield trial.close("either side", trial.call(n2, n1, name="r0_from_ior"), got, share=0.25, property=True,
                      message="a boundary reflects the same from either side")  # fmt: skip
    yield _any_shape(trial, "two media", ((1, 2), (1, 2)), "r0_from_ior", share=0.25)


@assignment.task("4.2", Function("ndf_beckmann", field_of()), Function("ndf_ggx", field_of()))
def ndf(trial):
    """How many microfacets face a direction: a density per steradian that, seen from above, covers the surface once."""
    yield from _parts(
        trial, {name: (lambda t, n=name: _density(t, n), 4.5) for name in ("ndf_beckmann", "ndf_ggx")}
    )


def _density(trial, name):
    kind = name.removeprefix("ndf_")
    right = getattr(truth, kind)
    if kind == "ggx":
        angle, roughness = np.meshgrid(np.linspace(0, 1.5, PIXELS), np.linspace(0.25, 1, PIXELS))
        yours, expected = trial.both(np.cos(angle), roughness**2, name=name)
        trial.show(np.log1p(np.maximum(yours, 0)), np.log1p(expected), "scalar",
                   "log(1 + GGX) over the tilt, to the right, and the roughness, down")  # fmt: skip
    for title, low, high, share, message in (
        ("values", 0.1, 1.0, 2.0, "the density at a tilt, for widths alpha from 0.1 to 1"),
        ("narrow lobes", 1e-4, 0.1, 0.75, "the density of narrow lobes: alpha from 1e-4 to 0.1"),
    ):
        alpha, x = logarithmic(trial.rng, low, high, 200), trial.rng.uniform(0, 2, 200)
        x[:10] = 0
        cosine = 1 / np.sqrt(1 + (alpha * x) ** 2)
        error = np.abs(trial.call(cosine, alpha, name=name) / right(alpha * x, alpha) - 1)
        yield trial.at_most(f"{kind}: {title}", error.max(), share=share, message=message)
    alpha = trial.rng.uniform(0.1, 1)
    # even steps in the logarithm of the tangent resolve peak and tail; what is left out at the ends is below 1e-5
    tan, step = alpha * np.exp(np.linspace(-6.5, 7, 500)), 13.5 / 499
    cosine = 1 / np.sqrt(1 + tan**2)
    covered = np.sum(trial.call(cosine, alpha, name=name) * 2 * np.pi * tan**2 * cosine**4) * step
    yield trial.close(f"{kind}: covers the surface", covered, 1.0, share=0.5, property=True,
                      message="the integral of D cos over the hemisphere is 1")  # fmt: skip
    below = np.concatenate([[0.0, -1.0], trial.rng.uniform(-1, 0, 20)])
    yield trial.survives(f"{kind}: horizon", lambda: [trial.close(f"{kind}: below", trial.call(
        below, alpha, name=name), 0.0)], share=0.5, message="0 where cos_h is 0 or less.")  # fmt: skip
    yield _any_shape(trial, f"{kind}: shapes", ((0.2, 1), (0.2, 1)), name)


@assignment.task("4.3", Function("masking_shadowing", field_of()))
def masking_shadowing(trial):
    """The fraction of the microfacets that both directions see, with heights correlated: from 0 to 1."""
    cos_i, cos_o = np.meshgrid(np.linspace(0.02, 1, PIXELS), np.linspace(0.02, 1, PIXELS))
    trial.show(*trial.both(cos_i, cos_o, 0.6), "scalar", "over both cosines, alpha = 0.6")
    i, o = trial.rng.uniform(0.05, 1, (2, 300))
    alpha = trial.rng.uniform(0.3, 1, 300)
    got = trial.call(i, o, alpha)
    yield trial.close("values", got, truth.smith(i, o, alpha), share=2.0,
                      message="1 / (1 + Lambda(i) + Lambda(o)): heights are correlated")  # fmt: skip
    narrow = logarithmic(trial.rng, 1e-4, 0.1, 300)
    yield trial.close("narrow lobes", trial.call(i, o, narrow), truth.smith(i, o, narrow), share=0.5, property=True,
                      message="smooth surfaces hide little of themselves: alpha from 1e-4 to 0.1")  # fmt: skip
    low = logarithmic(trial.rng, 1e-3, 0.1, 300)
    want = truth.smith(low, o, alpha)
    yield trial.close("grazing", trial.call(low, o, alpha), want, scale=want,
                      message="towards the horizon it falls to 0 with the cosine")  # fmt: skip
    yield trial.close("straight above", trial.call(np.ones(300), np.ones(300), alpha), 1.0, share=0.25, property=True,
                      message="from straight above all is seen, and lit")  # fmt: skip
    yield trial.close("symmetric", trial.call(o, i, alpha), got, share=0.25, property=True,
                      message="the order of the two directions does not matter")  # fmt: skip
    down, up = np.concatenate([[0.0, -1.0], -i[:20]]), o[:22]

    def below():
        for pair in ((down, up), (up, down), (down, down)):
            yield trial.close("below", trial.call(*pair, 0.5), 0.0)

    yield trial.survives("horizon", below, share=0.5, message="0 where either cosine is 0 or less.")
    yield _any_shape(trial, "shapes", ((0.2, 1), (0.2, 1), (0.2, 1)))


@assignment.task("4.4", Function("microfacet_brdf", like(0, 3)))
def microfacet_brdf(trial):
    """How a rough mirror turns light of one direction into another: F G D / (4 n.i n.o)."""
    rng = trial.rng
    normal, view = sphere()
    lamp = normalize(rng.uniform(-0.7, 0.7, 3) + [0, 0.3, 1])
    lit = np.maximum(dot(normal, lamp), 0)[:, None]
    facing, want = lit[:, 0] > 0, np.zeros(normal.shape)
    r0 = np.array([0.9, 0.6, 0.3])
    got = trial.call(normal, view, lamp, r0, 0.25)
    want[facing] = truth.brdf(normal[facing], view[facing], lamp, r0, 0.25)
    trial.show(image(got * lit), image(want * lit), "color", "a ball of rough gold under one lamp")

    normal, view, light = above(rng, 300)
    r0, alpha = rng.uniform(0.02, 0.9, (300, 3)), rng.uniform(0.15, 1, 300)
    got, want = trial.call(normal, view, light, r0, alpha), truth.brdf(normal, view, light, r0, alpha)
    yield trial.close("values", got, want, scale=want, share=2.0,
                      message="Fresnel at the angle to the half vector, times G D / (4 n.i n.o)")  # fmt: skip
    narrow = logarithmic(rng, 1e-4, 0.05, 300)
    light = near_the_mirror(rng, normal, view, narrow)
    keep = dot(normal, light) > 0.02
    some = [a[keep] for a in (normal, view, light, r0, narrow)]
    want = truth.brdf(*some)
    yield trial.close("narrow lobes", trial.call(*some), want, scale=want, share=0.5,
                      message="alpha from 1e-4 to 0.05, near the mirror direction")  # fmt: skip
    normal, view, light = above(rng, 100)
    one, other = trial.call(normal, view, light, 0.3, 0.4), trial.call(normal, light, view, 0.3, 0.4)
    yield trial.close("reciprocal", one, other, scale=np.maximum(np.abs(one), 1e-6), share=0.5, property=True,
                      message="light and view may be exchanged")  # fmt: skip
    x, w = np.polynomial.legendre.leggauss(32)
    cosine = 0.5 + 0.5 * x
    up = np.tile([0.0, 0.0, 1.0], (32, 1))
    tilted = np.stack([np.sqrt(1 - cosine**2), 0 * cosine, cosine], axis=1)
    white = np.sum(trial.call(up, up, tilted, 1.0, 1.0)[:, 0] * cosine * w) * np.pi
    yield trial.close("furnace", white, 1 - np.log(2), share=0.5, property=True,
                      message="with r0 = 1 and alpha = 1, a white sky seen from above gives 1 - ln 2")  # fmt: skip

    def below():
        across = up @ np.array([[1.0, 0, 0], [0, 1, 0], [1, 0, 0]])
        for pair in ((view, -light), (-view, light), (-view, -light)):
            yield trial.close("below", trial.call(normal, *pair, 0.3, 0.4), 0.0)
        for pair in ((up, across), (across, up), (across, across)):
            yield trial.close("below", trial.call(up, *pair, 0.3, 0.4), 0.0)

    yield trial.survives(
        "horizon", below, share=0.5, message="0 where view or light is at or below the horizon."
    )
    light = normalize(normal[0] + 0.3 * view[0])

    def shapes():
        facing = np.tile(normal[0], (5, 1)), np.tile(view[0], (5, 1))
        for r0, alpha in (
            (0.3, 0.4),
            (np.array([0.1, 0.2, 0.3]), np.full(5, 0.4)),
            (np.full((5, 3), 0.2), 0.4),
        ):
            want = truth.brdf(*facing, light, r0, np.asarray(alpha))
            yield trial.close("values", trial.call(*facing, light, r0, alpha), want, scale=want)
        trial.call(np.zeros((0, 3)), np.zeros((0, 3)), light, 0.3, 0.4)

    yield trial.survives("any shape", shapes, share=0.5, message=(
        "to_light may be (3,) or (N, 3), r0 a number, (3,) or (N, 3), alpha a number or (N,), and N may be 0."))  # fmt: skip


@assignment.task("4.5", Function("monte_carlo_shade", like(1, 3)))
def monte_carlo_shade(trial):
    """All the light of a sky that a rough mirror sends to the viewer: noisy, but right on average."""
    rng, env = trial.rng, sky(trial.rng)
    normal, view, _ = above(rng, 10)
    view = tilted(rng, normal, np.tile([0.3, 0.45, 0.6, 0.75, 0.95], 2))
    r0, alpha = rng.uniform(0.04, 0.9, (10, 3)), np.repeat([0.9, 0.4], 5)
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
    size = 16 + int(trial.rng.integers(3))
    want, got = truth.table(size), trial.call(size, 2048)
    trial.show(*(np.concatenate([t, 0 * t[..., :1]], axis=-1) for t in (got, want)), "color",
               "scale in red, bias in green; the cosine to the right, the roughness down")  # fmt: skip
    for channel, name in enumerate(("scale", "bias")):
        error = np.sqrt(np.mean((got[..., channel] - want[..., channel]) ** 2))
        yield trial.at_most(
            name, error, share=1.5, message=f"the {name} on average over the table, with 2048 samples"
        )
    corner = np.ix_([0, -1], [0, -1])
    yield trial.close("corners", got[corner], want[corner], share=0.5, property=True,
                      message="smooth and rough, from above and at grazing angles")  # fmt: skip
    excess = max(got.sum(axis=-1).max() - 1, -got.min(), 0)
    yield trial.at_most("energy", excess, share=0.5, property=True,
                        message="neither is negative, and together they never give more than what came in")  # fmt: skip
    small = int(trial.rng.integers(4, 8))

    def sizes():
        for n, samples in ((small, 2048), (1, 2048)):
            error = trial.call(n, samples) - truth.table(n)
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


def _parts(trial, parts):
    """A task of several functions: one that fails costs its own share, unless all do."""
    failures = []
    for name, (part, share) in parts.items():
        try:
            for measure in part(trial):
                share -= measure.share
                yield measure
        except Failure as failure:
            if failure.status not in ("error", "not_attempted"):
                raise
            failures.append(failure)
            yield Measure(name, "cases", np.inf, 1.0, 0.0, share, f"{name}: {failure.message}")
    if len(failures) == len(parts):
        raise failures[0]


def _any_shape(trial, record, ranges, name=None, share=0.5):
    """Numbers, arrays that broadcast, and no value at all are as good as a list of values."""
    shapes = (), (5,), (2, 3), (3, 1), (0,)

    def cases():
        for shape in shapes:
            at = [
                trial.rng.uniform(*ends, shape) if shape else float(trial.rng.uniform(*ends))
                for ends in ranges
            ]
            yield trial.close(record, *trial.both(*at, name=name))
            at[-1] = (
                float(trial.rng.uniform(*ranges[-1]))
                if shape != (3, 1)
                else trial.rng.uniform(*ranges[-1], 4)
            )
            yield trial.close(record, *trial.both(*at, name=name))

    return trial.survives(f"{name or trial.task.name}: any shape", cases, share=share,
                          message="arguments may be numbers, or arrays of any shapes that broadcast.")  # fmt: skip
