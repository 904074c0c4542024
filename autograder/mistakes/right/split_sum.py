"""Right answers to tasks 4.1 to 4.8, each in another way, named `FUNCTION_way`."""

import math

import numpy as np

import framework as fw
from framework.arrays import dot


def _each(function, *arguments):
    """A Python loop over broadcast arguments, returned as nested lists."""
    arguments = np.broadcast_arrays(*arguments)
    return np.reshape([function(*map(float, a)) for a in zip(*(a.flat for a in arguments), strict=True)],
                      arguments[0].shape).tolist()  # fmt: skip


def single(*arguments):
    return [np.asarray(a, np.float32) for a in arguments]


# 4.1 --------------------------------------------------------------------------------------------------------------
def fresnel_schlick_loop(r0, cos_theta):
    return _each(lambda r, c: r + (1 - r) * (1 - c) ** 5, r0, cos_theta)


def fresnel_schlick_float32(r0, cos_theta):
    r, c = single(r0, cos_theta)
    return r + (np.float32(1) - r) * (np.float32(1) - c) ** 5


def fresnel_schlick_as_a_mix(r0, cos_theta):
    away = np.power(1 - np.asarray(cos_theta), 5.0)
    return np.asarray(r0) * (1 - away) + away


def r0_from_ior_loop(n1, n2):
    return _each(lambda a, b: ((a - b) / (a + b)) ** 2, n1, n2)


def r0_from_ior_float32(n1, n2):
    a, b = single(n1, n2)
    return np.square((a - b) / (a + b))


def r0_from_ior_relative(n1, n2):
    ratio = np.divide(n2, n1)
    return ((ratio - 1) / (ratio + 1)) ** 2


# 4.2 --------------------------------------------------------------------------------------------------------------
def ndf_beckmann_loop(cos_h, alpha):
    def one(c, a):
        if c <= 0:
            return 0.0
        return math.exp((c * c - 1) / (a * a * c * c)) / (math.pi * a * a * c**4)

    return _each(one, cos_h, alpha)


def ndf_beckmann_tangent(cos_h, alpha):
    c = np.clip(cos_h, 1e-9, 1)
    with np.errstate(under="ignore"):
        d = np.exp(-(np.tan(np.arccos(c)) ** 2) / np.square(alpha)) / (np.pi * np.square(alpha) * c**4)
    return np.where(np.asarray(cos_h) > 0, d, 0)


def ndf_beckmann_float32_result(cos_h, alpha):
    return np.float32(ndf_beckmann_tangent(cos_h, alpha))


def ndf_ggx_loop(cos_h, alpha):
    def one(c, a):
        return a * a / (math.pi * (c * c * (a * a - 1) + 1) ** 2) if c > 0 else 0.0

    return _each(one, cos_h, alpha)


def ndf_ggx_tangent(cos_h, alpha):
    c, a = np.clip(cos_h, 1e-9, 1), np.square(alpha)
    return np.where(np.asarray(cos_h) > 0, a / (np.pi * c**4 * (a + (1 - c * c) / (c * c)) ** 2), 0)


def ndf_ggx_float32_result(cos_h, alpha):
    return np.float32(ndf_ggx_tangent(cos_h, alpha))


# 4.3 --------------------------------------------------------------------------------------------------------------
def smith_lambda(c, a):
    c = np.clip(c, 1e-9, 1)
    return (np.sqrt(1 + np.square(a) * (1 - c * c) / (c * c)) - 1) / 2


def where_above(i, o, value):
    return np.where((np.asarray(i) > 0) & (np.asarray(o) > 0), value, 0)


def masking_shadowing_loop(cos_i, cos_o, alpha):
    def one(i, o, a):
        return 0.0 if i <= 0 or o <= 0 else float(1 / (1 + smith_lambda(i, a) + smith_lambda(o, a)))

    return _each(one, cos_i, cos_o, alpha)


def masking_shadowing_lambda(cos_i, cos_o, alpha):
    return where_above(cos_i, cos_o, 1 / (1 + smith_lambda(cos_i, alpha) + smith_lambda(cos_o, alpha)))


def masking_shadowing_heitz(cos_i, cos_o, alpha):
    """4 n.i n.o times the visibility term."""
    i, o, a = np.clip(cos_i, 0, 1), np.clip(cos_o, 0, 1), np.square(alpha)
    v = o * np.sqrt(i * i * (1 - a) + a) + i * np.sqrt(o * o * (1 - a) + a)
    return where_above(cos_i, cos_o, 2 * i * o / np.maximum(v, 1e-30))


def masking_shadowing_float32(cos_i, cos_o, alpha):
    return np.float32(masking_shadowing_heitz(*single(cos_i, cos_o, alpha)))


def masking_shadowing_from_g1(cos_i, cos_o, alpha):
    i, o = (1 / (1 + smith_lambda(c, alpha)) for c in (cos_i, cos_o))
    return where_above(cos_i, cos_o, i * o / (i + o - i * o))


# 4.4 --------------------------------------------------------------------------------------------------------------
def brdf(
    normal, view, to_light, r0, alpha, fresnel_at="v.h", four=4.0, g=None, d=None, below=False, cosines=True
):
    normal, view, to_light = (np.asarray(a, float) for a in (normal, view, to_light))
    h = fw.normalize(view + to_light)
    n_i, n_o, n_h, v_h = dot(normal, to_light), dot(normal, view), dot(normal, h), dot(view, h)
    if below:
        n_i, n_o = np.abs(n_i), np.abs(n_o)
    g, d = g or masking_shadowing_lambda, d or ndf_ggx_tangent
    scale = d(np.abs(n_h), alpha) * g(n_i, n_o, alpha) / four
    if cosines:
        scale = scale / (np.maximum(n_i, 1e-9) * np.maximum(n_o, 1e-9))
    c = {"v.h": v_h, "n.v": n_o, "n.h": n_h, "n.l": n_i}[fresnel_at]
    r0 = np.asarray(r0, float) * np.ones(3)
    return scale[..., None] * (r0 + (1 - r0) * np.clip(1 - c, 0, 1)[..., None] ** 5)


def microfacet_brdf_another_form(normal, view, to_light, r0, alpha):
    return brdf(normal, view, to_light, r0, alpha, g=masking_shadowing_heitz)


def microfacet_brdf_loop(normal, view, to_light, r0, alpha):
    n = len(normal)
    to_light, r0 = np.broadcast_to(to_light, (n, 3)), np.broadcast_to(r0, (n, 3))
    alpha = np.broadcast_to(alpha, n)
    return np.reshape([brdf(normal[i], view[i], to_light[i], r0[i], alpha[i]) for i in range(n)], (n, 3))


def microfacet_brdf_float32_result(normal, view, to_light, r0, alpha):
    return np.float32(brdf(normal, view, to_light, r0, alpha))


def microfacet_brdf_dot_of_sum(normal, view, to_light, r0, alpha):
    """n.h and v.h without the half vector."""
    n_i, n_o, v_l = dot(normal, to_light), dot(normal, view), dot(view, to_light)
    length = np.sqrt(np.maximum(2 + 2 * v_l, 1e-30))
    d = ndf_ggx_loop(np.clip((n_i + n_o) / length, 0, 1), alpha) * masking_shadowing_lambda(n_i, n_o, alpha)
    r0 = np.asarray(r0, float) * np.ones(3)
    f = r0 + (1 - r0) * (1 - np.clip(length / 2, 0, 1))[..., None] ** 5
    return (d / (4 * np.maximum(n_i, 1e-9) * np.maximum(n_o, 1e-9)))[..., None] * f


# 4.5 --------------------------------------------------------------------------------------------------------------
def monte_carlo(env, normal, view, r0, alpha, samples, rng, how="ggx", change=""):
    """Point by point; `how` samples are drawn, and `change` is what is done otherwise than it should be."""
    n = len(normal)
    color = np.zeros((n, 3))
    if not n:
        return color
    r0, alpha = np.broadcast_to(np.asarray(r0, float), (n, 3)), np.broadcast_to(alpha, n)
    for i in range(n):
        if normal[i] @ view[i] <= 0:
            continue
        t, b = fw.orthonormal_frame(normal[i])
        axes = np.stack([t, b, normal[i]])
        xi = fw.hammersley(samples, rng.random(2)) if how == "quasi" else rng.random((samples, 2))
        if how == "stratified":
            xi[:, 1] = (np.arange(samples) + xi[:, 1]) / samples
        if change == "seed":
            xi = np.random.default_rng().random((samples, 2))
        if how in ("cosine", "uniform", "sphere"):
            z = np.sqrt(1 - xi[:, 1]) if how == "cosine" else 1 - xi[:, 1] * (2 if how == "sphere" else 1)
            s = np.sqrt(1 - z * z)
            l = (
                np.stack([s * np.cos(2 * np.pi * xi[:, 0]), s * np.sin(2 * np.pi * xi[:, 0]), z], axis=1)
                @ axes
            )
            pdf = z / np.pi if how == "cosine" else np.full(samples, 1 / ((4 if how == "sphere" else 2) * np.pi))
            if change == "pdf":
                pdf = np.full(samples, 1 / np.pi)
        else:
            a = alpha[i]
            h = fw.sample_ggx(xi, a) @ axes
            v_h, n_h = h @ view[i], h @ normal[i]
            l = 2 * v_h[:, None] * h - view[i]
            pdf = ndf_ggx_tangent(n_h, a) * n_h / (4 * np.maximum(np.abs(v_h), 1e-9))
            if change == "jacobian":
                pdf = ndf_ggx_tangent(n_h, a) * n_h
        cos_i = l @ normal[i]
        ok = cos_i > 0
        f = brdf(np.tile(normal[i], (samples, 1)), np.tile(view[i], (samples, 1)), l, r0[i], alpha[i],
                  fresnel_at="n.v" if change == "fresnel" else "v.h", below=change == "negative")  # fmt: skip
        if change == "no cosine":
            f = f / np.maximum(cos_i, 1e-3)[:, None]
        if change == "negative":
            ok = np.ones(samples, bool)
        else:
            cos_i = np.maximum(cos_i, 0)
        value = np.where(ok[:, None], f * cos_i[:, None] / np.maximum(pdf, 1e-12)[:, None], 0)
        value = value * env.radiance(l)
        color[i] = value[ok].mean(axis=0) if change == "renormalised" and ok.any() else value.mean(axis=0)
        if change == "one sample":
            color[i] = value[0]
    return color


def monte_carlo_shade_normals(*a):
    return monte_carlo(*a)


def monte_carlo_shade_stratified(*a):
    return np.float32(monte_carlo(*a, how="stratified"))


def monte_carlo_shade_quasi(*a):
    return monte_carlo(*a, how="quasi")


def monte_carlo_shade_cosine(*a):
    return monte_carlo(*a, how="cosine")


def monte_carlo_shade_uniform(*a):
    return monte_carlo(*a, how="uniform")


def monte_carlo_shade_quadrature(env, normal, view, r0, alpha, samples, rng):
    """No chance at all: pixels with their solid angles."""
    d, w = env.directions().reshape(-1, 3), env.solid_angles().reshape(-1, 1)
    light = env.pixels.reshape(-1, 3)
    n = len(normal)
    r0, alpha, color = np.broadcast_to(r0, (n, 3)), np.broadcast_to(alpha, n), np.zeros((n, 3))
    for i in range(n):
        f = brdf(np.tile(normal[i], (len(d), 1)), np.tile(view[i], (len(d), 1)), d, r0[i], alpha[i])
        color[i] = (f * np.maximum(d @ normal[i], 0)[:, None] * light * w).sum(axis=0)
    return color


# 4.6 --------------------------------------------------------------------------------------------------------------
def lut(
    size,
    samples,
    points=fw.hammersley,
    widen=np.square,
    masking=None,
    fresnel_at="v.h",
    over="all",
    centers=None,
):
    """Half vectors on all normals, entry by entry; what differs is said by the arguments."""
    xi, masking = points(samples), masking or masking_shadowing_lambda
    c = (np.arange(size) + 0.5) / size if centers is None else centers
    lut = np.zeros((size, size, 2))
    for row, alpha in enumerate(widen(c)):
        h = fw.sample_ggx(xi, alpha)
        for column, mu in enumerate(c):
            v = np.array([np.sqrt(1 - mu * mu), 0, mu])
            v_h = np.clip(h @ v, 0, 1)
            cos_i = 2 * v_h * h[:, 2] - mu
            lit = cos_i > 0
            weight = np.where(lit, masking(cos_i, mu, alpha) * v_h / (h[:, 2] * mu), 0)
            s = (1 - (v_h if fresnel_at == "v.h" else mu)) ** 5
            count = max(lit.sum(), 1) if over == "lit" else samples
            lut[row, column] = (weight * (1 - s)).sum() / count, (weight * s).sum() / count
    return lut


def brdf_lut_normals(size, samples):
    return lut(size, samples)


def brdf_lut_random(size, samples):
    """Random half vectors instead of a sequence."""
    return lut(size, samples, points=lambda n: np.random.default_rng(3).random((n, 2)))


def brdf_lut_visible_normals(size, samples):
    """Only the normals that the view sees, by spherical caps."""
    from autograder.checks.reflection_truth import smith

    u, turn = fw.hammersley(samples).T
    c = (np.arange(size) + 0.5) / size
    lut = np.zeros((size, size, 2))
    for row, alpha in enumerate(c**2):
        for column, mu in enumerate(c):
            top = fw.normalize(np.array([alpha * np.sqrt(1 - mu * mu), 0, mu]))
            z = 1 - u * (1 + top[2])
            r = np.sqrt(np.maximum(1 - z * z, 0))
            cap = np.stack([r * np.cos(2 * np.pi * turn), r * np.sin(2 * np.pi * turn), z], axis=1) + top
            h = fw.normalize(cap * [alpha, alpha, 1])
            v_h = np.clip(h @ [np.sqrt(1 - mu * mu), 0, mu], 0, 1)
            cos_i = 2 * v_h * h[:, 2] - mu
            lit = np.clip(cos_i, 1e-9, 1)
            weight = np.where(cos_i > 0, smith(lit, mu, alpha) / smith(1.0, mu, alpha), 0)
            s = (1 - v_h) ** 5
            lut[row, column] = (weight * (1 - s)).mean(), (weight * s).mean()
    return lut


def brdf_lut_fewer_samples(size, samples):
    """1024 half vectors, whatever the budget is."""
    return lut(size, 1024)


def brdf_lut_float32(size, samples):
    return np.float32(lut(size, samples))


def brdf_lut_quadrature(size, samples):
    from solutions.truth import brdf_integral

    c = (np.arange(size) + 0.5) / size
    return [[brdf_integral(mu, r * r, nodes=24) for mu in c] for r in c]


# 4.7 --------------------------------------------------------------------------------------------------------------
def look_up(lut, cos_theta, roughness, place=lambda x, n: np.clip(np.asarray(x, float) * n - 0.5, 0, n - 1)):
    lut = np.asarray(lut)
    size = lut.shape[0]
    x, y = np.broadcast_arrays(place(cos_theta, size), place(roughness, size))
    i, j = (np.floor(v).astype(int) for v in (y, x))
    u, v = (y - i)[..., None], (x - j)[..., None]
    k, m = np.minimum(i + 1, size - 1), np.minimum(j + 1, size - 1)
    return (1 - u) * ((1 - v) * lut[i, j] + v * lut[i, m]) + u * ((1 - v) * lut[k, j] + v * lut[k, m])


def sample_lut_four_weights(lut, cos_theta, roughness):
    return look_up(lut, cos_theta, roughness)


def sample_lut_float32(lut, cos_theta, roughness):
    return np.float32(look_up(*single(lut, cos_theta, roughness)))


def sample_lut_interp(lut, cos_theta, roughness):
    """NumPy's interpolation, in a loop."""
    x, y = np.broadcast_arrays(cos_theta, roughness)
    size = len(lut)
    c = (np.arange(size) + 0.5) / size

    def one(x, y, k):
        return np.interp(y, c, [np.interp(x, c, row) for row in lut[..., k]])

    values = [[one(a, b, k) for k in (0, 1)] for a, b in zip(x.flat, y.flat, strict=True)]
    return np.reshape(values, x.shape + (2,))


# 4.8 --------------------------------------------------------------------------------------------------------------
def shade(normal, view, r0, roughness, prefiltered, lut, change=""):
    """The split sum; `change` is what is done otherwise than it should be."""
    normal, view = np.asarray(normal, float), np.asarray(view, float)
    cosine = dot(normal, view)
    roughness = np.broadcast_to(roughness, cosine.shape)
    direction = {"sign": -1, "": 1}.get(change, 1) * (2 * cosine[..., None] * normal - view)
    if change == "normal":
        direction = normal
    r0 = np.asarray(r0, float) * np.ones(3)
    ab = look_up(lut, cosine, roughness**2 if change == "alpha" else roughness)
    a, b = ab[..., :1], ab[..., 1:]
    if change == "fresnel":
        r0 = r0 + (1 - r0) * (1 - np.clip(cosine, 0, 1))[..., None] ** 5
    light = prefiltered(direction, roughness**2 if change == "filter alpha" else roughness)
    answer = light * (r0 * b + a if change == "exchanged" else r0 * a + b)
    if change == "cosine":
        answer = answer * cosine[..., None]
    if change == "no bias":
        answer = light * r0 * a
    return answer if change == "below" else np.where((cosine > 0)[..., None], answer, 0)


def shade_split_sum_all_at_once(*a):
    return shade(*a)


def shade_split_sum_float32(normal, view, r0, roughness, prefiltered, lut):
    normal, view, r0, roughness, lut = single(normal, view, r0, roughness, lut)
    return np.float32(shade(normal, view, r0, roughness, prefiltered, lut))


def shade_split_sum_loop(normal, view, r0, roughness, prefiltered, lut):
    n = len(normal)
    r0, roughness = np.broadcast_to(r0, (n, 3)), np.broadcast_to(roughness, n)
    one = [
        shade(normal[i : i + 1], view[i : i + 1], r0[i], roughness[i : i + 1], prefiltered, lut)[0]
        for i in range(n)
    ]
    return np.reshape(one, (n, 3))
