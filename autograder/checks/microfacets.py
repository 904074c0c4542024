"""Checks 4.1 to 4.4, of what has a closed form: Fresnel, normal distributions, masking, and the BRDF made of them."""

import numpy as np

from autograder.checks import Assignment, Function, Measure, field_of, like
from autograder.checks import reflection_truth as truth
from autograder.checks.reflection_inputs import PIXELS, above, image, logarithmic, near_the_mirror, sphere
from autograder.student import Failure
from framework.arrays import dot, normalize

assignment = Assignment("split_sum")


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
