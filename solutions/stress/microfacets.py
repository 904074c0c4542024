"""Fresnel, normal distributions, masking, the BRDF, the table of the split sum and its shading.

Truths are the textbooks' formulas in extended precision, from the very float64 inputs.
"""

import numpy as np

import framework as fw
from solutions import fast, split_sum, truth
from solutions.stress import COSINES, ROUGHNESS, measured, relative

# Widths that are asked for, and those that the functions use: none is narrower than 1e-4.
_ALPHA = ROUGHNESS**2
_CLAMPED = np.maximum(_ALPHA, 1e-4)


def rows(share):
    rng = np.random.default_rng(31)
    yield from _fresnel(rng, int(200_000 * share))
    yield from _distributions(rng, int(3_000 * share))
    yield from _masking(rng, int(60 * share))
    yield from _brdf(rng, int(4_000 * share))
    yield from _monte_carlo(rng, int(40 * share))
    yield from _tables(int(max(4, 24 * share)))
    yield from _look_up(rng, int(100_000 * share))
    yield from _shading(rng, int(20_000 * share))


def _fresnel(rng, count):
    cosine = np.concatenate([COSINES, rng.uniform(-0.2, 1.2, count), 1.0 + np.spacing(1.0) * np.arange(-4, 5)])
    r0 = rng.choice([0.0, 1e-4, 0.02, 0.04, 0.5, 1.0], len(cosine))
    found = split_sum.fresnel_schlick(r0, cosine)
    exact = r0 + (1 - r0) * (1 - np.clip(cosine, 0, 1).astype(np.longdouble)) ** 5
    yield measured("fresnel_schlick", "relative error", found, relative(found, exact, 1e-3), 1e-12, "1 - cos cancels at 1")
    yield measured("fresnel_schlick", "below r0 or above 1", found, np.maximum(r0 - found, found - 1), 3e-16, "one rounding")
    n1, n2 = np.exp(rng.uniform(-4, 4, (2, count)))
    found = split_sum.r0_from_ior(n1, n2)
    exact = ((n1.astype(np.longdouble) - n2) / (n1.astype(np.longdouble) + n2)) ** 2
    yield measured("r0_from_ior", "relative error", found, relative(found, exact), 2e-15, "three roundings, one squared")
    yield measured("r0_from_ior", "changed by swapping", found, np.abs(found - split_sum.r0_from_ior(n2, n1)), 0, "a square")


def _distributions(rng, count):
    cosine = np.concatenate([COSINES, np.cos(rng.uniform(0, 1.6, count)), 1 - 10 ** rng.uniform(-16, 0, count)])
    c = np.maximum(cosine, 0.0).astype(np.longdouble)[:, None]
    a2 = _CLAMPED.astype(np.longdouble) ** 2
    sin2 = (1 - c) * (1 + c)
    ggx = np.where(c > 0, a2 / (np.pi * np.longdouble(1) * (sin2 + a2 * c * c) ** 2), 0)
    found = split_sum.ndf_ggx(cosine[:, None], _ALPHA)
    yield measured("ndf_ggx", "relative error", found, relative(found, ggx), 1e-14, "ten roundings; widths from 1e-4")
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        exponent = np.where(c > 0, sin2 / np.where(c > 0, c * c * a2, 1), np.inf)
        beckmann = np.where(c > 0, np.exp(-exponent) / (np.pi * a2 * np.where(c > 0, c, 1) ** 4), 0)
    found = split_sum.ndf_beckmann(cosine[:, None], _ALPHA)
    error = relative(found, beckmann, 1e-300) / (1 + np.minimum(exponent, 700))
    yield measured("ndf_beckmann", "relative error over exponent", found, error, 1e-14, "exp(-x) carries x roundings")
    for name in ("ndf_ggx", "ndf_beckmann"):
        ndf = getattr(split_sum, name)
        peak = ndf(1.0, _ALPHA)
        value = ndf(cosine[:, None], _ALPHA)
        beyond = value / peak - 1 if name == "ndf_ggx" else 0 * value  # Beckmann's may be higher off its middle
        yield measured(name, "above its peak, or below 0", value, np.maximum(beyond, -value), 1e-14, "roundings of one ratio")


def _masking(rng, count):
    cosine = np.concatenate([COSINES, rng.uniform(0, 1, count)])
    i, o, a = np.meshgrid(cosine, cosine, _ALPHA, indexing="ij")
    found = split_sum.masking_shadowing(i, o, a)
    ci, co, a2 = (x.astype(np.longdouble) for x in (i, o, np.maximum(a, 1e-4) ** 2))
    lit = (i > 0) & (o > 0)
    slopes = [np.sqrt(1 + a2 * (1 - c) * (1 + c) / np.where(c > 0, c * c, 1)) for c in (ci, co)]
    exact = np.where(lit, 2 / (slopes[0] + slopes[1]), 0)
    yield measured("masking_shadowing", "relative error", found, relative(found, exact), 1e-14, "ten roundings")
    yield measured("masking_shadowing", "outside [0, 1]", found, np.maximum(-found, found - 1), 0, "it is a probability")
    yield measured("masking_shadowing", "changed by swapping", found, np.abs(found - found.swapaxes(0, 1)), 0, "one sum")
    yield measured("masking_shadowing", "growth with alpha", found, np.diff(found[..., 1:], axis=2), 1e-15, "one rounding")


def _frames(rng, count):
    """Normals, views and lights at the cosines of the sweep and about the mirror direction, (N, 3) each."""
    normal = fw.normalize(np.concatenate([np.eye(3), -np.eye(3), rng.normal(size=(count, 3))]))
    frame = np.stack([*fw.orthonormal_frame(normal), normal], axis=1)
    mu, phi = rng.choice(COSINES[1:], len(normal)), rng.uniform(0, 2 * np.pi, len(normal))
    sine = np.sqrt((1 - mu) * (1 + mu))
    view = np.einsum("ni,nij->nj", np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1), frame)
    return normal, fw.normalize(view)


def _brdf(rng, count):
    normal, view = _frames(rng, count)
    r0, both = np.array([0.9, 0.5, 0.04]), (split_sum.microfacet_brdf, fast.microfacet_brdf)
    for name, function in zip(("microfacet_brdf", "fast.microfacet_brdf"), both, strict=True):
        found, errors, swapped, turned = [], [], [], []
        for asked, alpha in zip(_ALPHA, _CLAMPED, strict=True):
            light = fw.normalize([1.0, 2.0, -0.5])
            # Normals about the half vector, within a few widths: that is where a narrow lobe lives.
            half = fw.normalize(view + light)
            near = fw.normalize(half + alpha * rng.normal(size=half.shape))
            n = np.where(rng.random((len(half), 1)) < 0.5, normal, near)
            value = function(n, view, light, r0, asked)
            found.append(value)
            errors.append(relative(value, _brdf_truth(n, view, light, r0, alpha), 1e-290))
            turned.append(relative(function(*(np.roll(x, 1, axis=-1) for x in (n, view, light)), r0, asked), value, 1e-290))
            swapped.append(relative(split_sum.microfacet_brdf(n, light, view, r0, asked), value, 1e-290))
        reason = "vectors that are unit to 1e-16, over a width of 1e-4, nearly opposed"
        yield measured(name, "relative error", found, np.array(errors), 1e-7, reason)
        yield measured(name, "changed by swapping view and light", found, np.array(swapped), 1e-7, reason)
        yield measured(name, "changed by quarter turns", found, np.array(turned), 1e-7, reason)
    grazing = np.array([[1.0, 0.0, 1e-170], [1.0, 0.0, 1e-9], [1.0, 0.0, 1e-3], [0.0, 0.0, 1.0]])
    up, views = np.broadcast_to([0.0, 0.0, 1.0], grazing.shape), fw.normalize(grazing)
    lights = views * [-1, 1, 1]
    grazed = np.array([f(up, views, light, 0.5, alpha) for f in both for light in lights for alpha in _ALPHA])
    yield measured("microfacet_brdf, both", "below 0", grazed, -grazed, 0, "view and light opposed at the horizon")
    empty = [f(np.empty((0, 3)), np.empty((0, 3)), lights[0], 0.5, 0.5).size for f in both]
    yield measured("microfacet_brdf, both", "values for an empty batch", empty, empty, 0, "nothing asked")


def _brdf_truth(normal, view, light, r0, alpha):
    n, v, l = (np.broadcast_to(np.asarray(x, np.longdouble), normal.shape) for x in (normal, view, light))
    alpha = np.longdouble(alpha)
    n, v, l = (x / np.sqrt((x * x).sum(-1, keepdims=True)) for x in (n, v, l))
    h = v + l
    h = h / np.sqrt((h * h).sum(-1, keepdims=True))
    cos_i, cos_o, cos_h = ((n * x).sum(-1) for x in (l, v, h))
    across = np.cross(n, h)
    density = alpha**2 / (np.pi * ((across**2).sum(-1) + (alpha * cos_h) ** 2) ** 2)
    lit = (cos_i > 0) & (cos_o > 0)
    i, o = np.where(lit, cos_i, 1), np.where(lit, cos_o, 1)
    seen = 0.5 / (i * np.sqrt(alpha**2 + (1 - alpha**2) * o * o) + o * np.sqrt(alpha**2 + (1 - alpha**2) * i * i))
    fresnel = r0 + (1 - r0) * (1 - np.clip((v * h).sum(-1), 0, 1))[:, None] ** 5
    return np.where(lit, density * seen, 0)[:, None] * fresnel


def _monte_carlo(rng, count):
    normal, view = _frames(rng, count)
    white = fw.Environment(np.ones((4, 8, 3)))
    found = []
    for alpha in _ALPHA:
        found.append(split_sum.monte_carlo_shade(white, normal, view, 1.0, alpha, 16, rng))
        found.append(fast.monte_carlo_shade(white, normal, view, 1.0, alpha, 16, rng)[0])
    values = np.array(found)
    yield measured("monte_carlo_shade, both", "energy gained from a white sky", values, np.maximum(values - 1, -values), 1e-6,
                   "G2 / G1 <= 1; texels are float32", points=16 * values.size // 3)  # fmt: skip


def _tables(size):
    lut = fast.brdf_lut(128)
    pick = np.unique(np.linspace(0, 127, size).astype(int))
    exact = np.array([[truth.brdf_integral((j + 0.5) / 128, ((i + 0.5) / 128) ** 2) for j in pick] for i in pick])
    error = np.abs(lut[np.ix_(pick, pick)] - exact)
    fine = (pick[:, None] + 0.5 >= 0.02 * 128) & (pick + 0.5 >= 2)
    yield measured("fast.brdf_lut", "error, roughness >= 0.02, mu >= 1/64", lut, error[fine], 2e-5, "stated; quadrature")
    yield measured("fast.brdf_lut", "error, beyond", error, error[~fine], 1e-4, "stated; quadrature")
    tables = [lut, *(fast.brdf_lut(n) for n in (1, 2, 3, 7, 33)), *(split_sum.brdf_lut(n, 256) for n in (1, 2, 3, 7, 32))]
    flat = np.concatenate([t.reshape(-1, 2) for t in tables])
    yield measured("brdf_lut, both", "A + B above 1, or either below 0", flat, np.maximum(flat.sum(1) - 1, -flat.min(1)), 1e-6,
                   "a white surface reflects no more than arrives")  # fmt: skip
    yield measured("fast.brdf_lut", "B growing with mu, roughness >= 0.13", lut, np.diff(lut[16:, :, 1], axis=1), 0,
                   "Fresnel fades; in narrower lobes masking near the horizon fades faster")  # fmt: skip


def _look_up(rng, count):
    cosine = np.concatenate([COSINES, rng.uniform(-0.5, 1.5, count)])
    rough = np.concatenate([rng.choice(ROUGHNESS, len(COSINES)), rng.uniform(-0.5, 1.5, count)])
    found, errors = [], []
    for size in (1, 2, 3, 7, 64):
        centre = (np.arange(size) + 0.5) / size
        lut = np.stack(np.broadcast_arrays(centre[:, None], centre), axis=-1)
        value = split_sum.sample_lut(lut, cosine, rough)
        ends = [np.clip(x, centre[0], centre[-1]) for x in (rough, cosine)]
        found.append(value)
        errors.append(np.abs(value - np.stack(ends, axis=-1)))
    yield measured("sample_lut", "error on a plane, clamped", found, np.array(errors), 1e-14, "bilinear is exact there")


def _shading(rng, count):
    normal, view = _frames(rng, count)
    rough, r0 = rng.choice(ROUGHNESS, len(normal)), rng.uniform(0, 1, (len(normal), 3))
    lut = fast.brdf_lut(32)
    white = fw.skies.constant(8)
    sun = fw.skies.single_texel(16)
    sun = fw.Environment(sun.pixels + fw.skies.gradient(16).pixels)
    levels = [0.0, 0.3, 1.0]
    for env, claim in ((white, "relative error under a white sky"), (sun, "difference of the twins under a sun of 60000")):
        maps = [env.resized(n).pixels for n in (16, 7, 1)]
        light = fw.EnvironmentLight(env, maps[-1], maps, levels, lut)
        pair = [f(normal, view, r0, rough, light.prefiltered, lut) for f in (split_sum.shade_split_sum, fast.shade_split_sum)]
        if env is white:
            ab = split_sum.sample_lut(lut, fw.arrays.dot(normal, view), rough)
            exact = r0 * ab[:, :1] + ab[:, 1:]
            yield measured("shade_split_sum", claim, pair[0], relative(pair[0], exact), 1e-12, "a constant map stays as it is")
        bound = "float32 tables of a float64 look-up; stated as 1e-3"
        yield measured("fast.shade_split_sum", claim, pair[1], relative(pair[1], pair[0], 1e-6 * env.pixels.max()), 1e-3, bound)
