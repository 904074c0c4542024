"""Known mistakes in tasks 4.1 to 4.8."""

import numpy as np

from autograder.mistakes import mistake
from autograder.mistakes.right import split_sum as right
from framework.arrays import dot


# 4.1 --------------------------------------------------------------------------------------------------------------
@mistake("Which power did Schlick choose?")
def fresnel_schlick_fourth_power(r0, cos_theta):
    """A little too bright between the ends."""
    return r0 + (1 - r0) * (1 - cos_theta) ** 4


@mistake("What is the reflectance when you look straight down?")
def fresnel_schlick_of_the_cosine(r0, cos_theta):
    """Bright straight on, r0 at grazing angles."""
    return r0 + (1 - r0) * cos_theta**5


@mistake("What is left to be reflected beside r0?")
def fresnel_schlick_not_scaled(r0, cos_theta):
    """Exceeds 1 at grazing angles."""
    return r0 + (1 - cos_theta) ** 5


@mistake("Which function of the angle is raised to the power?")
def fresnel_schlick_of_the_sine(r0, cos_theta):
    """Too bright at all but the ends."""
    return r0 + (1 - r0) * np.sqrt(1 - np.asarray(cos_theta) ** 2) ** 5


@mistake("The exponential is an approximation of an approximation: which form is asked for?")
def fresnel_schlick_spherical_gaussian(r0, cos_theta):
    """Right to two digits only."""
    return r0 + (1 - r0) * 2.0 ** ((-5.55473 * cos_theta - 6.98316) * cos_theta)


@mistake("How fast does the reflectance rise towards the horizon?")
def fresnel_schlick_linear(r0, cos_theta):
    """Far too bright between the ends."""
    return r0 + (1 - r0) * (1 - cos_theta)


@mistake("Amplitude or energy: what happens to an amplitude on the way to an energy?")
def r0_from_ior_not_squared(n1, n2):
    """Glass reflects a fifth of the light."""
    return np.abs(np.subtract(n1, n2)) / np.add(n1, n2)


@mistake("A boundary has two sides: where does n1 come in?")
def r0_from_ior_air_only(n1, n2):
    """Right only if the first medium is air."""
    return ((1 - np.asarray(n2)) / (1 + np.asarray(n2))) ** 2 + 0 * np.asarray(n1)


@mistake("What is reflected where both indices are equal?")
def r0_from_ior_quotient(n1, n2):
    """More is reflected than comes in."""
    return np.divide(n1, n2) ** 2


@mistake("Are the indices squared before the quotient, or is the quotient?")
def r0_from_ior_squares(n1, n2):
    """Nearly four times too bright."""
    a, b = np.square(n1), np.square(n2)
    return ((a - b) / (a + b)) ** 2


@mistake("What is reflected where both indices are equal?")
def r0_from_ior_upside_down(n1, n2):
    """More is reflected than comes in."""
    return (np.add(n1, n2) / (np.subtract(n1, n2) + 1e-9)) ** 2


# 4.2 --------------------------------------------------------------------------------------------------------------
@mistake("How does a step in the tangent relate to a solid angle?")
def ndf_beckmann_no_cos4(cos_h, alpha):
    """Right straight on, too low for tilted facets."""
    c = np.clip(cos_h, 1e-9, 1)
    return np.where(np.asarray(cos_h) > 0, right.ndf_beckmann_tangent(cos_h, alpha) * c**4, 0)


@mistake("What is the integral of D times the cosine?")
def ndf_beckmann_no_pi(cos_h, alpha):
    """Too high by a factor of 3.14."""
    return np.pi * right.ndf_beckmann_tangent(cos_h, alpha)


@mistake("Is the argument the roughness, or alpha already?")
def ndf_beckmann_roughness(cos_h, alpha):
    """The lobe is too narrow and too high."""
    return right.ndf_beckmann_tangent(cos_h, np.square(alpha))


@mistake("Does alpha or alpha squared stand in the density?")
def ndf_beckmann_alpha_not_squared(cos_h, alpha):
    """The lobe is too wide and too low."""
    return right.ndf_beckmann_tangent(cos_h, np.sqrt(alpha))


@mistake("Can a facet face away from the surface?")
def ndf_beckmann_below(cos_h, alpha):
    """Facets below the horizon are counted."""
    return right.ndf_beckmann_tangent(np.abs(cos_h), alpha)


@mistake("Is the exponent a function of the sine or of the tangent?")
def ndf_beckmann_sine(cos_h, alpha):
    """Too high for tilted facets."""
    c, a = np.clip(cos_h, 1e-9, 1), np.square(alpha)
    return np.where(np.asarray(cos_h) > 0, np.exp(-(1 - c * c) / a) / (np.pi * a * c**4), 0)


@mistake("Is the argument the roughness, or alpha already?")
def ndf_ggx_roughness(cos_h, alpha):
    """The lobe is too narrow and too high."""
    return right.ndf_ggx_tangent(cos_h, np.square(alpha))


@mistake("Does alpha or alpha squared stand in the density?")
def ndf_ggx_alpha_not_squared(cos_h, alpha):
    """The lobe is too wide and too low."""
    return right.ndf_ggx_tangent(cos_h, np.sqrt(alpha))


@mistake("What is the integral of D times the cosine?")
def ndf_ggx_no_pi(cos_h, alpha):
    """Too high by a factor of 3.14."""
    return np.pi * right.ndf_ggx_tangent(cos_h, alpha)


@mistake("With which power does the tail of GGX fall?")
def ndf_ggx_not_squared(cos_h, alpha):
    """The tail is far too high."""
    c, a = np.clip(cos_h, 0, 1), np.square(alpha)
    return np.where(np.asarray(cos_h) > 0, a / (np.pi * (c * c * (a - 1) + 1)), 0)


@mistake("Can a facet face away from the surface?")
def ndf_ggx_below(cos_h, alpha):
    """Facets below the horizon are counted."""
    return right.ndf_ggx_tangent(np.abs(cos_h) + 1e-9, alpha)


@mistake("How small may alpha be, and what does your guard do there?")
def ndf_ggx_wide_floor(cos_h, alpha):
    """Narrow lobes are widened."""
    return right.ndf_ggx_tangent(cos_h, np.maximum(alpha, 0.05))


@mistake("At alpha = 1e-4 the cosine differs from 1 by 5e-9: in which precision do you take the difference?")
def ndf_ggx_float32(cos_h, alpha):
    """Narrow lobes have steps, or are infinite."""
    c, a = right.single(cos_h, alpha)
    a = a * a
    return np.where(
        c > 0, a / (np.float32(np.pi) * np.maximum(c * c * (a - 1) + 1, np.float32(1e-20)) ** 2), 0
    )


# 4.3 --------------------------------------------------------------------------------------------------------------
@mistake("Facets that are high are seen and lit alike: is that chance a product?")
def masking_shadowing_uncorrelated(cos_i, cos_o, alpha):
    """Too dark where both directions are low."""
    i, o = (1 / (1 + right.smith_lambda(c, alpha)) for c in (cos_i, cos_o))
    return right.where_above(cos_i, cos_o, i * o)


def _schlick_smith(cos_i, cos_o, k):
    i, o = np.clip(cos_i, 0, 1), np.clip(cos_o, 0, 1)
    return right.where_above(
        cos_i, cos_o, i / np.maximum(i * (1 - k) + k, 1e-9) * o / np.maximum(o * (1 - k) + k, 1e-9)
    )


@mistake("Is the exact Lambda asked for, or a fit?")
def masking_shadowing_half_alpha(cos_i, cos_o, alpha):
    """Nearly right: this is Schlick's fit to it."""
    return _schlick_smith(cos_i, cos_o, np.asarray(alpha) / 2)


@mistake("Is the exact Lambda asked for, or a remapped fit?")
def masking_shadowing_direct_lights(cos_i, cos_o, alpha):
    """Too dark for rough surfaces: this is the remapping made for lamps."""
    return _schlick_smith(cos_i, cos_o, (np.sqrt(alpha) + 1) ** 2 / 8)


@mistake("Is the argument the roughness, or alpha already?")
def masking_shadowing_roughness(cos_i, cos_o, alpha):
    """Too bright."""
    return right.masking_shadowing_lambda(cos_i, cos_o, np.square(alpha))


@mistake("Light must come in and go out: how many directions are hidden?")
def masking_shadowing_one_direction(cos_i, cos_o, alpha):
    """The other direction does not matter."""
    return right.where_above(cos_i, cos_o, 1 / (1 + right.smith_lambda(cos_o, alpha)))


@mistake("Is the fraction asked for, or the term that shaders fold it into?")
def masking_shadowing_visibility(cos_i, cos_o, alpha):
    """Exceeds 1 at low angles: it is divided by the cosines already."""
    g = right.masking_shadowing_lambda(cos_i, cos_o, alpha)
    return g / (4 * np.clip(cos_i, 1e-3, 1) * np.clip(cos_o, 1e-3, 1))


@mistake("What do two Lambdas do together?")
def masking_shadowing_minimum(cos_i, cos_o, alpha):
    """Too bright where both directions are low."""
    return right.where_above(
        cos_i, cos_o, 1 / (1 + np.maximum(right.smith_lambda(cos_i, alpha), right.smith_lambda(cos_o, alpha)))
    )


@mistake("How much of the surface is seen from below?")
def masking_shadowing_below(cos_i, cos_o, alpha):
    """Directions below the horizon are lit."""
    return 1 / (1 + right.smith_lambda(np.abs(cos_i), alpha) + right.smith_lambda(np.abs(cos_o), alpha))


@mistake("Look at the constants of Lambda once more.")
def masking_shadowing_whole_lambda(cos_i, cos_o, alpha):
    """Too dark at low angles."""
    return right.where_above(
        cos_i, cos_o, 1 / (1 + 2 * right.smith_lambda(cos_i, alpha) + 2 * right.smith_lambda(cos_o, alpha))
    )


# 4.4 --------------------------------------------------------------------------------------------------------------
@mistake("At which surface is the light reflected: the large one, or the facets?")
def microfacet_brdf_fresnel_at_the_normal(*a):
    """Too bright when seen from low angles."""
    return right.brdf(*a, fresnel_at="n.v")


@mistake("The angle of incidence lies between which two directions?")
def microfacet_brdf_fresnel_at_n_h(*a):
    """Too dark at grazing angles."""
    return right.brdf(*a, fresnel_at="n.h")


@mistake("The constant is the Jacobian of the half vector: which is it?")
def microfacet_brdf_pi_for_four(*a):
    """Too bright by a quarter."""
    return right.brdf(*a, four=np.pi)


@mistake("By which cosines is the product divided?")
def microfacet_brdf_no_cosines(*a):
    """Too dark at low angles."""
    return right.brdf(*a, cosines=False)


@mistake("Facets that are high are seen and lit alike: is that chance a product?")
def microfacet_brdf_uncorrelated(*a):
    """Too dark where both directions are low."""
    return right.brdf(*a, g=masking_shadowing_uncorrelated)


@mistake("Which distribution is asked for?")
def microfacet_brdf_beckmann(*a):
    """The highlight has no tail."""
    return right.brdf(*a, d=right.ndf_beckmann_tangent)


@mistake("What is the result where a cosine is 0 or less?")
def microfacet_brdf_below(*a):
    """Light from below the horizon is reflected."""
    return right.brdf(*a, below=True)


@mistake("Is the cosine of the light a part of the BRDF, or of the integral?")
def microfacet_brdf_with_the_cosine(normal, view, to_light, r0, alpha):
    """Light and view may not be exchanged."""
    cosine = np.maximum(dot(normal, np.broadcast_to(to_light, np.shape(normal))), 0)
    return right.brdf(normal, view, to_light, r0, alpha) * cosine[..., None]


@mistake("Is the argument the roughness, or alpha already?")
def microfacet_brdf_roughness(normal, view, to_light, r0, alpha):
    """The highlight is too small and too bright."""
    return right.brdf(normal, view, to_light, r0, np.square(alpha))


# 4.5 --------------------------------------------------------------------------------------------------------------
@mistake("The density of half vectors is not the density of directions: what stands between them?")
def monte_carlo_shade_jacobian(*a):
    """Too dark by a factor that grows with the angle."""
    return right.monte_carlo(*a, change="jacobian")


@mistake("At which surface is the light reflected: the large one, or the facets?")
def monte_carlo_shade_fresnel_at_the_normal(*a):
    """Too bright when seen from low angles."""
    return right.monte_carlo(*a, change="fresnel")


@mistake("Samples below the horizon bring no light: do they count all the same?")
def monte_carlo_shade_renormalised(*a):
    """Too bright for rough surfaces at low angles."""
    return right.monte_carlo(*a, change="renormalised")


@mistake("Is the argument the roughness, or alpha already?")
def monte_carlo_shade_roughness(*a):
    """The reflection is too sharp."""
    *rest, alpha, samples, rng = a
    return right.monte_carlo(*rest, np.square(alpha), samples, rng)


@mistake("Which cosine stands in the rendering equation?")
def monte_carlo_shade_no_cosine(*a):
    """Too bright, most at the rim of the lobe."""
    return right.monte_carlo(*a, change="no cosine")


@mistake("By the density of which samples is each value divided?")
def monte_carlo_shade_wrong_density(*a):
    """The brightness is off by the wrong density."""
    return right.monte_carlo(*a, how="cosine", change="pdf")


@mistake("How many samples is the mean taken over?")
def monte_carlo_shade_one_sample(*a):
    """Right on average and far too noisy."""
    return right.monte_carlo(*a, change="one sample")


@mistake("From which side of the surface may the view look at it?")
def monte_carlo_shade_from_behind(env, normal, view, *rest):
    """Surfaces that are seen from behind shine."""
    side = np.where(dot(normal, view) < 0, -1.0, 1.0)[..., None]
    return right.monte_carlo(env, normal, side * view, *rest)


@mistake("What does a direction below the horizon bring: less than no light?")
def monte_carlo_shade_negative(*a):
    """Too dark, below 0 here and there: directions of the whole sphere count with the sign of their cosine."""
    return right.monte_carlo(*a, how="sphere", change="negative")


@mistake("Where do the random numbers come from?")
def monte_carlo_shade_own_seed(*a):
    """Another answer at every call."""
    return right.monte_carlo(*a, change="seed")


# 4.6 --------------------------------------------------------------------------------------------------------------
@mistake("Which axis is the roughness, and which the cosine?")
def brdf_lut_transposed(size, samples):
    """Roughness runs along the columns."""
    return right.lut(size, samples).swapaxes(0, 1)


@mistake("Where in the table is roughness 0?")
def brdf_lut_flipped(size, samples):
    """The first row is the roughest."""
    return right.lut(size, samples)[::-1]


@mistake("What multiplies r0, and what is added?")
def brdf_lut_exchanged(size, samples):
    """Scale and bias are exchanged."""
    return right.lut(size, samples)[..., ::-1]


@mistake("A row has a roughness: what does the lobe want?")
def brdf_lut_alpha(size, samples):
    """Rows are those of rougher surfaces."""
    return right.lut(size, samples, widen=np.asarray)


@mistake("Which masking goes with GGX exactly?")
def brdf_lut_half_alpha(size, samples):
    """Nearly right: this is Schlick's fit of the masking."""
    return right.lut(size, samples, masking=masking_shadowing_half_alpha)


@mistake("For lamps the roughness is remapped: for skies too?")
def brdf_lut_direct_lights(size, samples):
    """Too dark at grazing angles: this is the masking made for lamps."""
    return right.lut(size, samples, masking=masking_shadowing_direct_lights)


@mistake("Facets that are high are seen and lit alike: is that chance a product?")
def brdf_lut_uncorrelated(size, samples):
    """A little too dark for rough surfaces."""
    return right.lut(size, samples, masking=masking_shadowing_uncorrelated)


@mistake("At which surface is the light reflected: the large one, or the facets?")
def brdf_lut_fresnel_at_the_normal(size, samples):
    """Too much bias at grazing angles."""
    return right.lut(size, samples, fresnel_at="n.v")


@mistake("Samples below the horizon bring no light: do they count all the same?")
def brdf_lut_lit_only(size, samples):
    """Too bright for rough surfaces at grazing angles."""
    return right.lut(size, samples, over="lit")


@mistake("Where in its cell is an entry taken?")
def brdf_lut_ends(size, samples):
    """The outermost rows and columns are those of 0 and 1."""
    return right.lut(size, samples, centers=np.clip(np.linspace(0, 1, size), 1e-3, 1 - 1e-9))


@mistake("What is left of the reflectance where r0 is 0?")
def brdf_lut_without_bias(size, samples):
    """Grazing angles are dark."""
    return right.lut(size, samples) * [1, 0]


# 4.7 --------------------------------------------------------------------------------------------------------------
@mistake("Which axis of the table is which?")
def sample_lut_swapped(lut, cos_theta, roughness):
    """Roughness and cosine are exchanged."""
    return right.look_up(lut, roughness, cos_theta)


@mistake("Between the centres of cells four entries count.")
def sample_lut_nearest(lut, cos_theta, roughness):
    """Steps between the entries."""
    n = len(lut)
    x, y = np.broadcast_arrays(cos_theta, roughness)
    i, j = (np.clip((v * n).astype(int), 0, n - 1) for v in (y, x))
    return np.asarray(lut)[i, j]


@mistake("Where in its cell is an entry taken?")
def sample_lut_corners(lut, cos_theta, roughness):
    """Stretched: the ends of the table lie at 0 and 1."""
    return right.look_up(
        lut, cos_theta, roughness, lambda x, n: np.clip(np.asarray(x, float) * (n - 1), 0, n - 1)
    )


@mistake("Where in its cell is an entry taken?")
def sample_lut_no_half(lut, cos_theta, roughness):
    """Shifted by half a cell."""
    return right.look_up(lut, cos_theta, roughness, lambda x, n: np.clip(np.asarray(x, float) * n, 0, n - 1))


@mistake("Where in the table is roughness 0?")
def sample_lut_flipped(lut, cos_theta, roughness):
    """The smooth end is rough."""
    return right.look_up(lut, cos_theta, 1 - np.asarray(roughness))


@mistake("What is the answer beyond the outermost centres?")
def sample_lut_extrapolates(lut, cos_theta, roughness):
    """At the borders the other end of the table shows."""
    n = len(lut)
    x, y = np.broadcast_arrays(np.asarray(cos_theta, float) * n - 0.5, np.asarray(roughness, float) * n - 0.5)
    i, j = (np.floor(v).astype(int) for v in (y, x))
    u, v = (y - i)[..., None], (x - j)[..., None]
    at = lambda a, b: np.asarray(lut)[a % n, b % n]  # noqa: E731
    return (1 - u) * ((1 - v) * at(i, j) + v * at(i, j + 1)) + u * (
        (1 - v) * at(i + 1, j) + v * at(i + 1, j + 1)
    )


@mistake("How many rows has the table that you are given?")
def sample_lut_fixed_size(lut, cos_theta, roughness):
    """Right for one size of table alone."""
    return right.look_up(
        lut, cos_theta, roughness, lambda x, n: np.clip(np.asarray(x, float) * 8 - 0.5, 0, min(n, 8) - 1)
    )


@mistake("Do the rows run over the roughness, or over alpha?")
def sample_lut_alpha(lut, cos_theta, roughness):
    """Right at the ends, too smooth between."""
    return right.look_up(lut, cos_theta, np.square(roughness))


# 4.8 --------------------------------------------------------------------------------------------------------------
@mistake("What of Fresnel is in the table already?")
def shade_split_sum_fresnel_twice(*a):
    """Rims are too bright."""
    return right.shade(*a, change="fresnel")


@mistake("On which side of the surface does the mirror direction lie?")
def shade_split_sum_reflected_sign(*a):
    """The reflection is upside down."""
    return right.shade(*a, change="sign")


@mistake("Along which direction does a mirror look?")
def shade_split_sum_along_the_normal(*a):
    """Reflections do not move with the camera."""
    return right.shade(*a, change="normal")


@mistake("Do the rows of the table run over the roughness, or over alpha?")
def shade_split_sum_lut_alpha(*a):
    """Too much scale, too little spread at the rim."""
    return right.shade(*a, change="alpha")


@mistake("Does the filtered sky want the roughness, or alpha?")
def shade_split_sum_filter_alpha(*a):
    """Reflections are too sharp."""
    return right.shade(*a, change="filter alpha")


@mistake("What multiplies r0, and what is added?")
def shade_split_sum_exchanged(*a):
    """Scale and bias are exchanged."""
    return right.shade(*a, change="exchanged")


@mistake("Is the cosine of the view in the rendering equation?")
def shade_split_sum_with_the_cosine(*a):
    """Rims are dark."""
    return right.shade(*a, change="cosine")


@mistake("What is left of the reflectance where r0 is 0?")
def shade_split_sum_without_bias(*a):
    """Rims are dark, and dark materials black."""
    return right.shade(*a, change="no bias")


@mistake("What is the result where n.v is 0 or less?")
def shade_split_sum_below(*a):
    """Surfaces seen from behind shine."""
    return right.shade(*a, change="below")
