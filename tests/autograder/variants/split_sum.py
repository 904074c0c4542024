"""Right and wrong versions of tasks 4.1 to 4.8, named `right_FUNCTION_what` and `wrong_FUNCTION_what`."""

import math

import numpy as np

import framework as fw
from framework.arrays import dot


def _each(function, *arguments):
    """A Python loop over broadcast arguments, returned as nested lists."""
    arguments = np.broadcast_arrays(*arguments)
    return np.reshape([function(*map(float, a)) for a in zip(*(a.flat for a in arguments), strict=True)],
                      arguments[0].shape).tolist()  # fmt: skip


def _single(*arguments):
    return [np.asarray(a, np.float32) for a in arguments]


# 4.1 --------------------------------------------------------------------------------------------------------------
def right_fresnel_schlick_loop(r0, cos_theta):
    return _each(lambda r, c: r + (1 - r) * (1 - c) ** 5, r0, cos_theta)


def right_fresnel_schlick_float32(r0, cos_theta):
    r, c = _single(r0, cos_theta)
    return r + (np.float32(1) - r) * (np.float32(1) - c) ** 5


def right_fresnel_schlick_as_a_mix(r0, cos_theta):
    away = np.power(1 - np.asarray(cos_theta), 5.0)
    return np.asarray(r0) * (1 - away) + away


def wrong_fresnel_schlick_fourth_power(r0, cos_theta):
    return r0 + (1 - r0) * (1 - cos_theta) ** 4


def wrong_fresnel_schlick_of_the_cosine(r0, cos_theta):
    return r0 + (1 - r0) * cos_theta**5


def wrong_fresnel_schlick_not_scaled(r0, cos_theta):
    return r0 + (1 - cos_theta) ** 5


def wrong_fresnel_schlick_of_the_sine(r0, cos_theta):
    return r0 + (1 - r0) * np.sqrt(1 - np.asarray(cos_theta) ** 2) ** 5


def wrong_fresnel_schlick_spherical_gaussian(r0, cos_theta):
    """An approximation of it, off by 1e-3 and more."""
    return r0 + (1 - r0) * 2.0 ** ((-5.55473 * cos_theta - 6.98316) * cos_theta)


def wrong_fresnel_schlick_linear(r0, cos_theta):
    return r0 + (1 - r0) * (1 - cos_theta)


def right_r0_from_ior_loop(n1, n2):
    return _each(lambda a, b: ((a - b) / (a + b)) ** 2, n1, n2)


def right_r0_from_ior_float32(n1, n2):
    a, b = _single(n1, n2)
    return np.square((a - b) / (a + b))


def right_r0_from_ior_relative(n1, n2):
    ratio = np.divide(n2, n1)
    return ((ratio - 1) / (ratio + 1)) ** 2


def wrong_r0_from_ior_not_squared(n1, n2):
    return np.abs(np.subtract(n1, n2)) / np.add(n1, n2)


def wrong_r0_from_ior_air_only(n1, n2):
    return ((1 - np.asarray(n2)) / (1 + np.asarray(n2))) ** 2 + 0 * np.asarray(n1)


def wrong_r0_from_ior_quotient(n1, n2):
    return np.divide(n1, n2) ** 2


def wrong_r0_from_ior_squares(n1, n2):
    a, b = np.square(n1), np.square(n2)
    return ((a - b) / (a + b)) ** 2


def wrong_r0_from_ior_upside_down(n1, n2):
    return (np.add(n1, n2) / (np.subtract(n1, n2) + 1e-9)) ** 2


# 4.2 --------------------------------------------------------------------------------------------------------------
def right_ndf_beckmann_loop(cos_h, alpha):
    def one(c, a):
        if c <= 0:
            return 0.0
        return math.exp((c * c - 1) / (a * a * c * c)) / (math.pi * a * a * c**4)

    return _each(one, cos_h, alpha)


def right_ndf_beckmann_tangent(cos_h, alpha):
    c = np.clip(cos_h, 1e-9, 1)
    with np.errstate(under="ignore"):
        d = np.exp(-(np.tan(np.arccos(c)) ** 2) / np.square(alpha)) / (np.pi * np.square(alpha) * c**4)
    return np.where(np.asarray(cos_h) > 0, d, 0)


def right_ndf_beckmann_float32_result(cos_h, alpha):
    return np.float32(right_ndf_beckmann_tangent(cos_h, alpha))


def wrong_ndf_beckmann_no_cos4(cos_h, alpha):
    c = np.clip(cos_h, 1e-9, 1)
    return np.where(np.asarray(cos_h) > 0, right_ndf_beckmann_tangent(cos_h, alpha) * c**4, 0)


def wrong_ndf_beckmann_no_pi(cos_h, alpha):
    return np.pi * right_ndf_beckmann_tangent(cos_h, alpha)


def wrong_ndf_beckmann_roughness(cos_h, alpha):
    return right_ndf_beckmann_tangent(cos_h, np.square(alpha))


def wrong_ndf_beckmann_alpha_not_squared(cos_h, alpha):
    return right_ndf_beckmann_tangent(cos_h, np.sqrt(alpha))


def wrong_ndf_beckmann_below(cos_h, alpha):
    return right_ndf_beckmann_tangent(np.abs(cos_h), alpha)


def wrong_ndf_beckmann_sine(cos_h, alpha):
    c, a = np.clip(cos_h, 1e-9, 1), np.square(alpha)
    return np.where(np.asarray(cos_h) > 0, np.exp(-(1 - c * c) / a) / (np.pi * a * c**4), 0)


def right_ndf_ggx_loop(cos_h, alpha):
    def one(c, a):
        return a * a / (math.pi * (c * c * (a * a - 1) + 1) ** 2) if c > 0 else 0.0

    return _each(one, cos_h, alpha)


def right_ndf_ggx_tangent(cos_h, alpha):
    c, a = np.clip(cos_h, 1e-9, 1), np.square(alpha)
    return np.where(np.asarray(cos_h) > 0, a / (np.pi * c**4 * (a + (1 - c * c) / (c * c)) ** 2), 0)


def right_ndf_ggx_float32_result(cos_h, alpha):
    return np.float32(right_ndf_ggx_tangent(cos_h, alpha))


def wrong_ndf_ggx_roughness(cos_h, alpha):
    return right_ndf_ggx_tangent(cos_h, np.square(alpha))


def wrong_ndf_ggx_alpha_not_squared(cos_h, alpha):
    return right_ndf_ggx_tangent(cos_h, np.sqrt(alpha))


def wrong_ndf_ggx_no_pi(cos_h, alpha):
    return np.pi * right_ndf_ggx_tangent(cos_h, alpha)


def wrong_ndf_ggx_not_squared(cos_h, alpha):
    c, a = np.clip(cos_h, 0, 1), np.square(alpha)
    return np.where(np.asarray(cos_h) > 0, a / (np.pi * (c * c * (a - 1) + 1)), 0)


def wrong_ndf_ggx_below(cos_h, alpha):
    return right_ndf_ggx_tangent(np.abs(cos_h) + 1e-9, alpha)


def wrong_ndf_ggx_wide_floor(cos_h, alpha):
    """Narrow lobes are widened."""
    return right_ndf_ggx_tangent(cos_h, np.maximum(alpha, 0.05))


def wrong_ndf_ggx_float32(cos_h, alpha):
    """The textbook form in single precision: narrow lobes lose their shape."""
    c, a = _single(cos_h, alpha)
    a = a * a
    return np.where(
        c > 0, a / (np.float32(np.pi) * np.maximum(c * c * (a - 1) + 1, np.float32(1e-20)) ** 2), 0
    )


# 4.3 --------------------------------------------------------------------------------------------------------------
def _lambda(c, a):
    c = np.clip(c, 1e-9, 1)
    return (np.sqrt(1 + np.square(a) * (1 - c * c) / (c * c)) - 1) / 2


def _where_above(i, o, value):
    return np.where((np.asarray(i) > 0) & (np.asarray(o) > 0), value, 0)


def right_masking_shadowing_loop(cos_i, cos_o, alpha):
    def one(i, o, a):
        return 0.0 if i <= 0 or o <= 0 else float(1 / (1 + _lambda(i, a) + _lambda(o, a)))

    return _each(one, cos_i, cos_o, alpha)


def right_masking_shadowing_lambda(cos_i, cos_o, alpha):
    return _where_above(cos_i, cos_o, 1 / (1 + _lambda(cos_i, alpha) + _lambda(cos_o, alpha)))


def right_masking_shadowing_heitz(cos_i, cos_o, alpha):
    """4 n.i n.o times the visibility term."""
    i, o, a = np.clip(cos_i, 0, 1), np.clip(cos_o, 0, 1), np.square(alpha)
    v = o * np.sqrt(i * i * (1 - a) + a) + i * np.sqrt(o * o * (1 - a) + a)
    return _where_above(cos_i, cos_o, 2 * i * o / np.maximum(v, 1e-30))


def right_masking_shadowing_float32(cos_i, cos_o, alpha):
    return np.float32(right_masking_shadowing_heitz(*_single(cos_i, cos_o, alpha)))


def right_masking_shadowing_from_g1(cos_i, cos_o, alpha):
    i, o = (1 / (1 + _lambda(c, alpha)) for c in (cos_i, cos_o))
    return _where_above(cos_i, cos_o, i * o / (i + o - i * o))


def wrong_masking_shadowing_uncorrelated(cos_i, cos_o, alpha):
    i, o = (1 / (1 + _lambda(c, alpha)) for c in (cos_i, cos_o))
    return _where_above(cos_i, cos_o, i * o)


def _schlick_smith(cos_i, cos_o, k):
    i, o = np.clip(cos_i, 0, 1), np.clip(cos_o, 0, 1)
    return _where_above(
        cos_i, cos_o, i / np.maximum(i * (1 - k) + k, 1e-9) * o / np.maximum(o * (1 - k) + k, 1e-9)
    )


def wrong_masking_shadowing_half_alpha(cos_i, cos_o, alpha):
    return _schlick_smith(cos_i, cos_o, np.asarray(alpha) / 2)


def wrong_masking_shadowing_direct_lights(cos_i, cos_o, alpha):
    return _schlick_smith(cos_i, cos_o, (np.sqrt(alpha) + 1) ** 2 / 8)


def wrong_masking_shadowing_roughness(cos_i, cos_o, alpha):
    return right_masking_shadowing_lambda(cos_i, cos_o, np.square(alpha))


def wrong_masking_shadowing_one_direction(cos_i, cos_o, alpha):
    return _where_above(cos_i, cos_o, 1 / (1 + _lambda(cos_o, alpha)))


def wrong_masking_shadowing_visibility(cos_i, cos_o, alpha):
    """Divided by 4 n.i n.o already."""
    g = right_masking_shadowing_lambda(cos_i, cos_o, alpha)
    return g / (4 * np.clip(cos_i, 1e-3, 1) * np.clip(cos_o, 1e-3, 1))


def wrong_masking_shadowing_minimum(cos_i, cos_o, alpha):
    return _where_above(cos_i, cos_o, 1 / (1 + np.maximum(_lambda(cos_i, alpha), _lambda(cos_o, alpha))))


def wrong_masking_shadowing_below(cos_i, cos_o, alpha):
    return 1 / (1 + _lambda(np.abs(cos_i), alpha) + _lambda(np.abs(cos_o), alpha))


def wrong_masking_shadowing_whole_lambda(cos_i, cos_o, alpha):
    """Lambda without its half."""
    return _where_above(cos_i, cos_o, 1 / (1 + 2 * _lambda(cos_i, alpha) + 2 * _lambda(cos_o, alpha)))


# 4.4 --------------------------------------------------------------------------------------------------------------
def _brdf(
    normal, view, to_light, r0, alpha, fresnel_at="v.h", four=4.0, g=None, d=None, below=False, cosines=True
):
    normal, view, to_light = (np.asarray(a, float) for a in (normal, view, to_light))
    h = fw.normalize(view + to_light)
    n_i, n_o, n_h, v_h = dot(normal, to_light), dot(normal, view), dot(normal, h), dot(view, h)
    if below:
        n_i, n_o = np.abs(n_i), np.abs(n_o)
    g, d = g or right_masking_shadowing_lambda, d or right_ndf_ggx_tangent
    scale = d(np.abs(n_h), alpha) * g(n_i, n_o, alpha) / four
    if cosines:
        scale = scale / (np.maximum(n_i, 1e-9) * np.maximum(n_o, 1e-9))
    c = {"v.h": v_h, "n.v": n_o, "n.h": n_h, "n.l": n_i}[fresnel_at]
    r0 = np.asarray(r0, float) * np.ones(3)
    return scale[..., None] * (r0 + (1 - r0) * np.clip(1 - c, 0, 1)[..., None] ** 5)


def right_microfacet_brdf_another_form(normal, view, to_light, r0, alpha):
    return _brdf(normal, view, to_light, r0, alpha, g=right_masking_shadowing_heitz)


def right_microfacet_brdf_loop(normal, view, to_light, r0, alpha):
    n = len(normal)
    to_light, r0 = np.broadcast_to(to_light, (n, 3)), np.broadcast_to(r0, (n, 3))
    alpha = np.broadcast_to(alpha, n)
    return np.reshape([_brdf(normal[i], view[i], to_light[i], r0[i], alpha[i]) for i in range(n)], (n, 3))


def right_microfacet_brdf_float32_result(normal, view, to_light, r0, alpha):
    return np.float32(_brdf(normal, view, to_light, r0, alpha))


def right_microfacet_brdf_dot_of_sum(normal, view, to_light, r0, alpha):
    """n.h and v.h without the half vector."""
    n_i, n_o, v_l = dot(normal, to_light), dot(normal, view), dot(view, to_light)
    length = np.sqrt(np.maximum(2 + 2 * v_l, 1e-30))
    d = right_ndf_ggx_loop(np.clip((n_i + n_o) / length, 0, 1), alpha) * right_masking_shadowing_lambda(
        n_i, n_o, alpha
    )
    r0 = np.asarray(r0, float) * np.ones(3)
    f = r0 + (1 - r0) * (1 - np.clip(length / 2, 0, 1))[..., None] ** 5
    return (d / (4 * np.maximum(n_i, 1e-9) * np.maximum(n_o, 1e-9)))[..., None] * f


def wrong_microfacet_brdf_fresnel_at_the_normal(*a):
    return _brdf(*a, fresnel_at="n.v")


def wrong_microfacet_brdf_fresnel_at_n_h(*a):
    return _brdf(*a, fresnel_at="n.h")


def wrong_microfacet_brdf_pi_for_four(*a):
    return _brdf(*a, four=np.pi)


def wrong_microfacet_brdf_no_cosines(*a):
    return _brdf(*a, cosines=False)


def wrong_microfacet_brdf_uncorrelated(*a):
    return _brdf(*a, g=wrong_masking_shadowing_uncorrelated)


def wrong_microfacet_brdf_beckmann(*a):
    return _brdf(*a, d=right_ndf_beckmann_tangent)


def wrong_microfacet_brdf_below(*a):
    return _brdf(*a, below=True)


def wrong_microfacet_brdf_with_the_cosine(normal, view, to_light, r0, alpha):
    """The light's cosine is in it already."""
    cosine = np.maximum(dot(normal, np.broadcast_to(to_light, np.shape(normal))), 0)
    return _brdf(normal, view, to_light, r0, alpha) * cosine[..., None]


def wrong_microfacet_brdf_roughness(normal, view, to_light, r0, alpha):
    return _brdf(normal, view, to_light, r0, np.square(alpha))


# 4.5 --------------------------------------------------------------------------------------------------------------
def _monte_carlo(env, normal, view, r0, alpha, samples, rng, how="ggx", wrong=""):
    n = len(normal)
    color = np.zeros((n, 3))
    if not n:
        return color
    r0, alpha = np.broadcast_to(np.asarray(r0, float), (n, 3)), np.broadcast_to(alpha, n)
    for i in range(n):
        if normal[i] @ view[i] <= 0 and wrong != "below":
            continue
        t, b = fw.orthonormal_frame(normal[i])
        axes = np.stack([t, b, normal[i]])
        xi = fw.hammersley(samples, rng.random(2)) if how == "quasi" else rng.random((samples, 2))
        if how == "stratified":
            xi[:, 1] = (np.arange(samples) + xi[:, 1]) / samples
        if wrong == "seed":
            xi = np.random.default_rng().random((samples, 2))
        if how in ("cosine", "uniform"):
            z = np.sqrt(1 - xi[:, 1]) if how == "cosine" else 1 - xi[:, 1]
            s = np.sqrt(1 - z * z)
            l = (
                np.stack([s * np.cos(2 * np.pi * xi[:, 0]), s * np.sin(2 * np.pi * xi[:, 0]), z], axis=1)
                @ axes
            )
            pdf = z / np.pi if how == "cosine" else np.full(samples, 1 / (2 * np.pi))
            if wrong == "pdf":
                pdf = np.full(samples, 1 / np.pi)
        else:
            a = alpha[i]
            h = fw.sample_ggx(xi, a) @ axes
            v_h, n_h = h @ view[i], h @ normal[i]
            l = 2 * v_h[:, None] * h - view[i]
            pdf = right_ndf_ggx_tangent(n_h, a) * n_h / (4 * np.maximum(np.abs(v_h), 1e-9))
            if wrong == "jacobian":
                pdf = right_ndf_ggx_tangent(n_h, a) * n_h
        cos_i = l @ normal[i]
        ok = cos_i > 0
        f = _brdf(np.tile(normal[i], (samples, 1)), np.tile(view[i], (samples, 1)), l, r0[i], alpha[i],
                  fresnel_at="n.v" if wrong == "fresnel" else "v.h",)  # fmt: skip
        if wrong == "no cosine":
            f = f / np.maximum(cos_i, 1e-3)[:, None]
        value = np.where(ok[:, None], f * np.maximum(cos_i, 0)[:, None] / np.maximum(pdf, 1e-12)[:, None], 0)
        value = value * env.radiance(l)
        color[i] = value[ok].mean(axis=0) if wrong == "renormalised" and ok.any() else value.mean(axis=0)
        if wrong == "one sample":
            color[i] = value[0]
    return color


def right_monte_carlo_shade_normals(*a):
    return _monte_carlo(*a)


def right_monte_carlo_shade_stratified(*a):
    return np.float32(_monte_carlo(*a, how="stratified"))


def right_monte_carlo_shade_quasi(*a):
    return _monte_carlo(*a, how="quasi")


def right_monte_carlo_shade_cosine(*a):
    return _monte_carlo(*a, how="cosine")


def right_monte_carlo_shade_uniform(*a):
    return _monte_carlo(*a, how="uniform")


def right_monte_carlo_shade_quadrature(env, normal, view, r0, alpha, samples, rng):
    """No chance at all: pixels with their solid angles."""
    d, w = env.directions().reshape(-1, 3), env.solid_angles().reshape(-1, 1)
    light = env.pixels.reshape(-1, 3)
    n = len(normal)
    r0, alpha, color = np.broadcast_to(r0, (n, 3)), np.broadcast_to(alpha, n), np.zeros((n, 3))
    for i in range(n):
        f = _brdf(np.tile(normal[i], (len(d), 1)), np.tile(view[i], (len(d), 1)), d, r0[i], alpha[i])
        color[i] = (f * np.maximum(d @ normal[i], 0)[:, None] * light * w).sum(axis=0)
    return color


def wrong_monte_carlo_shade_jacobian(*a):
    return _monte_carlo(*a, wrong="jacobian")


def wrong_monte_carlo_shade_fresnel_at_the_normal(*a):
    return _monte_carlo(*a, wrong="fresnel")


def wrong_monte_carlo_shade_renormalised(*a):
    return _monte_carlo(*a, wrong="renormalised")


def wrong_monte_carlo_shade_roughness(*a):
    *rest, alpha, samples, rng = a
    return _monte_carlo(*rest, np.square(alpha), samples, rng)


def wrong_monte_carlo_shade_no_cosine(*a):
    return _monte_carlo(*a, wrong="no cosine")


def wrong_monte_carlo_shade_wrong_density(*a):
    return _monte_carlo(*a, how="cosine", wrong="pdf")


def wrong_monte_carlo_shade_one_sample(*a):
    return _monte_carlo(*a, wrong="one sample")


def wrong_monte_carlo_shade_own_seed(*a):
    return _monte_carlo(*a, wrong="seed")


# 4.6 --------------------------------------------------------------------------------------------------------------
def _lut(size, samples, how="quasi", wrong="", centers=None):
    xi = np.random.default_rng(3).random((samples, 2)) if how == "random" else fw.hammersley(samples)
    c = (np.arange(size) + 0.5) / size if centers is None else centers
    lut = np.zeros((size, size, 2))
    for row, roughness in enumerate(c):
        alpha = roughness if wrong == "alpha" else roughness**2
        h = fw.sample_ggx(xi, alpha)
        for column, mu in enumerate(c):
            v = np.array([np.sqrt(1 - mu * mu), 0, mu])
            v_h = np.clip(h @ v, 0, 1)
            cos_i = 2 * v_h * h[:, 2] - mu
            lit = cos_i > 0
            if wrong == "half alpha":
                g = wrong_masking_shadowing_half_alpha(cos_i, mu, alpha)
            elif wrong == "direct":
                g = wrong_masking_shadowing_direct_lights(cos_i, mu, alpha)
            elif wrong == "uncorrelated":
                g = wrong_masking_shadowing_uncorrelated(cos_i, mu, alpha)
            else:
                g = right_masking_shadowing_lambda(cos_i, mu, alpha)
            weight = np.where(lit, g * v_h / (h[:, 2] * mu), 0)
            s = (1 - (mu if wrong == "fresnel" else v_h)) ** 5
            count = max(lit.sum(), 1) if wrong == "lit only" else samples
            lut[row, column] = (weight * (1 - s)).sum() / count, (weight * s).sum() / count
    return lut


def right_brdf_lut_normals(size, samples):
    return _lut(size, samples)


def right_brdf_lut_float32(size, samples):
    return np.float32(_lut(size, samples))


def right_brdf_lut_quadrature(size, samples):
    from solutions.truth import brdf_integral

    c = (np.arange(size) + 0.5) / size
    return [[brdf_integral(mu, r * r, nodes=24) for mu in c] for r in c]


def wrong_brdf_lut_transposed(size, samples):
    return _lut(size, samples).swapaxes(0, 1)


def wrong_brdf_lut_flipped(size, samples):
    return _lut(size, samples)[::-1]


def wrong_brdf_lut_exchanged(size, samples):
    return _lut(size, samples)[..., ::-1]


def wrong_brdf_lut_alpha(size, samples):
    return _lut(size, samples, wrong="alpha")


def wrong_brdf_lut_half_alpha(size, samples):
    return _lut(size, samples, wrong="half alpha")


def wrong_brdf_lut_direct_lights(size, samples):
    return _lut(size, samples, wrong="direct")


def wrong_brdf_lut_uncorrelated(size, samples):
    return _lut(size, samples, wrong="uncorrelated")


def wrong_brdf_lut_fresnel_at_the_normal(size, samples):
    return _lut(size, samples, wrong="fresnel")


def wrong_brdf_lut_lit_only(size, samples):
    return _lut(size, samples, wrong="lit only")


def wrong_brdf_lut_ends(size, samples):
    """Rows and columns from 0 to 1 instead of cell centres."""
    return _lut(size, samples, centers=np.clip(np.linspace(0, 1, size), 1e-3, 1 - 1e-9))


def wrong_brdf_lut_without_bias(size, samples):
    return _lut(size, samples) * [1, 0]


# 4.7 --------------------------------------------------------------------------------------------------------------
def _look_up(lut, cos_theta, roughness, place=lambda x, n: np.clip(np.asarray(x, float) * n - 0.5, 0, n - 1)):
    lut = np.asarray(lut)
    size = lut.shape[0]
    x, y = np.broadcast_arrays(place(cos_theta, size), place(roughness, size))
    i, j = (np.floor(v).astype(int) for v in (y, x))
    u, v = (y - i)[..., None], (x - j)[..., None]
    k, m = np.minimum(i + 1, size - 1), np.minimum(j + 1, size - 1)
    return (1 - u) * ((1 - v) * lut[i, j] + v * lut[i, m]) + u * ((1 - v) * lut[k, j] + v * lut[k, m])


def right_sample_lut_four_weights(lut, cos_theta, roughness):
    return _look_up(lut, cos_theta, roughness)


def right_sample_lut_float32(lut, cos_theta, roughness):
    return np.float32(_look_up(*_single(lut, cos_theta, roughness)))


def right_sample_lut_interp(lut, cos_theta, roughness):
    """NumPy's interpolation, in a loop."""
    x, y = np.broadcast_arrays(cos_theta, roughness)
    size = len(lut)
    c = (np.arange(size) + 0.5) / size

    def one(x, y, k):
        return np.interp(y, c, [np.interp(x, c, row) for row in lut[..., k]])

    values = [[one(a, b, k) for k in (0, 1)] for a, b in zip(x.flat, y.flat, strict=True)]
    return np.reshape(values, x.shape + (2,))


def wrong_sample_lut_swapped(lut, cos_theta, roughness):
    return _look_up(lut, roughness, cos_theta)


def wrong_sample_lut_nearest(lut, cos_theta, roughness):
    n = len(lut)
    x, y = np.broadcast_arrays(cos_theta, roughness)
    i, j = (np.clip((v * n).astype(int), 0, n - 1) for v in (y, x))
    return np.asarray(lut)[i, j]


def wrong_sample_lut_corners(lut, cos_theta, roughness):
    return _look_up(lut, cos_theta, roughness, lambda x, n: np.clip(np.asarray(x, float) * (n - 1), 0, n - 1))


def wrong_sample_lut_no_half(lut, cos_theta, roughness):
    return _look_up(lut, cos_theta, roughness, lambda x, n: np.clip(np.asarray(x, float) * n, 0, n - 1))


def wrong_sample_lut_flipped(lut, cos_theta, roughness):
    return _look_up(lut, cos_theta, 1 - np.asarray(roughness))


def wrong_sample_lut_extrapolates(lut, cos_theta, roughness):
    """Wraps to the other end of the table."""
    n = len(lut)
    x, y = np.broadcast_arrays(np.asarray(cos_theta, float) * n - 0.5, np.asarray(roughness, float) * n - 0.5)
    i, j = (np.floor(v).astype(int) for v in (y, x))
    u, v = (y - i)[..., None], (x - j)[..., None]
    at = lambda a, b: np.asarray(lut)[a % n, b % n]  # noqa: E731
    return (1 - u) * ((1 - v) * at(i, j) + v * at(i, j + 1)) + u * (
        (1 - v) * at(i + 1, j) + v * at(i + 1, j + 1)
    )


def wrong_sample_lut_fixed_size(lut, cos_theta, roughness):
    return _look_up(
        lut, cos_theta, roughness, lambda x, n: np.clip(np.asarray(x, float) * 8 - 0.5, 0, min(n, 8) - 1)
    )


def wrong_sample_lut_alpha(lut, cos_theta, roughness):
    return _look_up(lut, cos_theta, np.square(roughness))


# 4.8 --------------------------------------------------------------------------------------------------------------
def _shade(normal, view, r0, roughness, prefiltered, lut, wrong=""):
    normal, view = np.asarray(normal, float), np.asarray(view, float)
    cosine = dot(normal, view)
    roughness = np.broadcast_to(roughness, cosine.shape)
    direction = {"sign": -1, "": 1}.get(wrong, 1) * (2 * cosine[..., None] * normal - view)
    if wrong == "normal":
        direction = normal
    r0 = np.asarray(r0, float) * np.ones(3)
    ab = _look_up(lut, cosine, roughness**2 if wrong == "alpha" else roughness)
    a, b = ab[..., :1], ab[..., 1:]
    if wrong == "fresnel":
        r0 = r0 + (1 - r0) * (1 - np.clip(cosine, 0, 1))[..., None] ** 5
    light = prefiltered(direction, roughness**2 if wrong == "filter alpha" else roughness)
    answer = light * (r0 * b + a if wrong == "exchanged" else r0 * a + b)
    if wrong == "cosine":
        answer = answer * cosine[..., None]
    if wrong == "no bias":
        answer = light * r0 * a
    return answer if wrong == "below" else np.where((cosine > 0)[..., None], answer, 0)


def right_shade_split_sum_all_at_once(*a):
    return _shade(*a)


def right_shade_split_sum_float32(normal, view, r0, roughness, prefiltered, lut):
    normal, view, r0, roughness, lut = _single(normal, view, r0, roughness, lut)
    return np.float32(_shade(normal, view, r0, roughness, prefiltered, lut))


def right_shade_split_sum_loop(normal, view, r0, roughness, prefiltered, lut):
    n = len(normal)
    r0, roughness = np.broadcast_to(r0, (n, 3)), np.broadcast_to(roughness, n)
    one = [
        _shade(normal[i : i + 1], view[i : i + 1], r0[i], roughness[i : i + 1], prefiltered, lut)[0]
        for i in range(n)
    ]
    return np.reshape(one, (n, 3))


def wrong_shade_split_sum_fresnel_twice(*a):
    return _shade(*a, wrong="fresnel")


def wrong_shade_split_sum_reflected_sign(*a):
    return _shade(*a, wrong="sign")


def wrong_shade_split_sum_along_the_normal(*a):
    return _shade(*a, wrong="normal")


def wrong_shade_split_sum_lut_alpha(*a):
    return _shade(*a, wrong="alpha")


def wrong_shade_split_sum_filter_alpha(*a):
    return _shade(*a, wrong="filter alpha")


def wrong_shade_split_sum_exchanged(*a):
    return _shade(*a, wrong="exchanged")


def wrong_shade_split_sum_with_the_cosine(*a):
    return _shade(*a, wrong="cosine")


def wrong_shade_split_sum_without_bias(*a):
    return _shade(*a, wrong="no bias")


def wrong_shade_split_sum_below(*a):
    return _shade(*a, wrong="below")
