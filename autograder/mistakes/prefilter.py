"""Known mistakes in tasks 3.1 to 3.6."""

import numpy as np

import framework as fw
from autograder.mistakes import mistake
from autograder.mistakes.right import prefilter as right
from solutions import prefilter as reference


# 3.1 --------------------------------------------------------------------------------------------------------------
@mistake("Is the argument the roughness, or alpha already?")
def sample_ggx_roughness(xi, alpha):
    """The lobe is too narrow."""
    return right.sample_ggx_arctan(xi, np.square(alpha))


@mistake("Does alpha or alpha squared stand in the inverse?")
def sample_ggx_root(xi, alpha):
    """The lobe is too wide."""
    cos_theta = np.sqrt((1 - xi[:, 1]) / (1 + (alpha - 1) * xi[:, 1]))
    return right.around(cos_theta, np.sqrt(1 - cos_theta**2), 2 * np.pi * xi[:, 0])


@mistake("Which distribution has an exponential in it?")
def sample_ggx_beckmann(xi, alpha):
    """The lobe has the right width and no tail."""
    theta = np.arctan(alpha * np.sqrt(-np.log(1 - xi[:, 0])))
    return right.around(np.cos(theta), np.sin(theta), 2 * np.pi * xi[:, 1])


@mistake("The inverse gives the squared tangent: what is the tangent?")
def sample_ggx_no_root(xi, alpha):
    """Too many half vectors are upright, and too many at the horizon."""
    theta = np.arctan(alpha * xi[:, 0] / (1 - xi[:, 0]))
    return right.around(np.cos(theta), np.sin(theta), 2 * np.pi * xi[:, 1])


@mistake("Where does alpha come in?")
def sample_ggx_hemisphere(xi, alpha):
    """The same even hemisphere for every alpha."""
    return right.around(xi[:, 0], np.sqrt(1 - xi[:, 0] ** 2), 2 * np.pi * xi[:, 1])


@mistake("xi has two columns: what is each for?")
def sample_ggx_same_column(xi, alpha):
    """Half vectors lie on a spiral."""
    return right.sample_ggx_arctan(xi[:, [0, 0]], alpha)


@mistake("How many radians has a full turn?")
def sample_ggx_half_turn(xi, alpha):
    """Half vectors fill one side of the lobe alone."""
    return right.sample_ggx_arctan(xi * [1, 0.5], alpha)


@mistake("Which of the three components is the cosine?")
def sample_ggx_about_y(xi, alpha):
    """The lobe stands about +y."""
    return right.sample_ggx_arctan(xi, alpha)[:, [0, 2, 1]]


@mistake("Half vectors are asked for: what lies half-way between view and light?")
def sample_ggx_reflected(xi, alpha):
    """The lobe is twice as wide: these are reflected directions."""
    h = right.sample_ggx_arctan(xi, alpha)
    return 2 * h[:, 2:] * h - [0, 0, 1]


@mistake("A slope is not yet a direction: what is its length?")
def sample_ggx_not_unit(xi, alpha):
    """Right directions, lengths above 1."""
    h = right.sample_ggx_disc(xi, alpha)
    return h / np.maximum(h[:, 2:], 1e-9)


@mistake("A facet that is tilted covers less of the surface: by which factor?")
def sample_ggx_density_without_cosine(xi, alpha):
    """Too many half vectors are flat."""
    theta = np.linspace(0, np.pi / 2, 4000)
    d = np.sin(theta) / ((np.cos(theta) * alpha) ** 2 + np.sin(theta) ** 2 + 1e-300) ** 2
    share = np.cumsum(d) / d.sum() if np.ndim(alpha) == 0 else np.linspace(0, 1, 4000)
    theta = np.interp(xi[:, 0], share, theta)
    return right.around(np.cos(theta), np.sin(theta), 2 * np.pi * xi[:, 1])


# 3.2 and 3.3 ------------------------------------------------------------------------------------------------------
@mistake("How large is a pixel near the pole, on the sphere?")
def irradiance_without_sine(env, height):
    """The poles of the map count too much."""
    total, weight = right.quadrature(env, height, right.clamped, np.ones(env.pixels.shape[:2]))
    return right.shaped(total / weight, height)


@mistake("What should a constant map of 1 become?")
def irradiance_without_pi(env, height):
    """Too bright by a factor of 3.14."""
    return reference.irradiance(env, height) * np.pi


@mistake("Why is a slanted beam weaker on the surface?")
def irradiance_without_cosine(env, height):
    """Light from the horizon counts as much as from above."""
    total, weight = right.quadrature(env, height, lambda c: np.where(c > 0, 1.0, 0.0))
    return right.shaped(total / weight, height)


@mistake("Directions drawn by the cosine have it in their density: must it be in their weight too?")
def irradiance_squared_cosine(env, height):
    """Light from above counts too much."""
    total, weight = right.quadrature(env, height, lambda c: np.maximum(c, 0) ** 2)
    return right.shaped(total / weight, height)


@mistake("What is the cosine of a direction below the horizon worth?")
def irradiance_both_sides(env, height):
    """Light from below the surface counts."""
    total, weight = right.quadrature(env, height, np.abs)
    return right.shaped(total / weight, height)


@mistake("Where in its pixel is a result's direction taken?")
def irradiance_edges(env, height):
    """The result is shifted by half a pixel."""
    fine = reference.irradiance(env, 2 * height)
    corners = 0.25 * (fine + np.roll(fine, 1, 1) + np.roll(fine, 1, 0) + np.roll(fine, (1, 1), (0, 1)))
    return corners[::2, ::2]


@mistake("In which direction does the azimuth run along a row?")
def irradiance_mirrored(env, height):
    """Left and right are exchanged."""
    return reference.irradiance(env, height)[:, ::-1]


@mistake("Along which axis does the first column look?")
def irradiance_shifted(env, height):
    """The result is turned by half a circle."""
    return np.roll(reference.irradiance(env, height), height, axis=1)


@mistake("Does row 0 look up or down?")
def irradiance_upside_down(env, height):
    """The sky lights the floor's underside."""
    return reference.irradiance(env, height)[::-1]


@mistake("Which part of the map does a surface see?")
def irradiance_mean(env, height):
    """The same colour for every normal."""
    mean = (env.pixels * env.solid_angles()[..., None]).sum((0, 1)) / (4 * np.pi)
    return np.broadcast_to(mean, (height, 2 * height, 3))


@mistake("From how many directions does a matt surface gather light?")
def irradiance_looked_up(env, height):
    """As sharp as the map itself."""
    return env.resized(height).pixels


@mistake("Is the argument the roughness, or alpha already?")
def prefilter_roughness(env, alpha, height, samples):
    """Too sharp."""
    return right.sampled(env, alpha, height, samples, widen=lambda a: a * a)


@mistake("Is the argument the roughness, or alpha already?")
def prefilter_root(env, alpha, height, samples):
    """Too blurred."""
    return right.sampled(env, alpha, height, samples, widen=np.sqrt)


@mistake("By what is a weighted sum divided to become a mean?")
def prefilter_by_count(env, alpha, height, samples):
    """Darker the rougher."""
    return right.sampled(env, alpha, height, samples, normalise=False)


@mistake("Which cosine weighs a sample?")
def prefilter_unweighted(env, alpha, height, samples):
    """Too much light from the rim of the lobe."""
    return right.sampled(env, alpha, height, samples, weigh=False)


@mistake("Light comes along the reflected direction: is that the half vector?")
def prefilter_half_vector(env, alpha, height, samples):
    """Too sharp: the blur has half the width."""
    return right.sampled(env, alpha, height, samples, reflect=False)


@mistake("On which side of the surface does the reflected direction lie?")
def prefilter_away(env, alpha, height, samples):
    """The world behind the surface is seen."""
    return right.sampled(env, alpha, height, samples, normals=-right.output_normals(height))


@mistake("Where in its pixel is a result's direction taken?")
def prefilter_corners(env, alpha, height, samples):
    """The result is shifted by half a pixel."""
    row, col = np.mgrid[:height, : 2 * height] * np.pi / height
    d = np.stack([np.sin(row) * np.sin(col), np.cos(row), -np.sin(row) * np.cos(col)], -1)
    return right.sampled(env, alpha, height, samples, normals=d.reshape(-1, 3))


@mistake("In which direction does the azimuth run along a row?")
def prefilter_mirrored(env, alpha, height, samples):
    """Left and right are exchanged."""
    return right.sampled(env, alpha, height, samples)[:, ::-1]


@mistake("Along which axis does the first column look?")
def prefilter_turned(env, alpha, height, samples):
    """The result is turned by a quarter circle."""
    return np.roll(right.sampled(env, alpha, height, samples), height // 2, axis=1)


@mistake("Which distribution has an exponential in it?")
def prefilter_beckmann(env, alpha, height, samples):
    """The highlights have no tails."""
    if alpha == 0:
        return right.sampled(env, 0, height, samples)
    half = sample_ggx_beckmann(fw.hammersley(samples), alpha)
    light = 2 * half[:, 2:] * half - [0, 0, 1]
    weight = np.maximum(light[:, 2], 0)
    return right.shaped(
        [weight @ env.radiance(light @ right.frame(n)) / weight.sum() for n in right.output_normals(height)],
        height,
    )


@mistake("Samples that follow a density have it in their number: must it be in their weight too?")
def prefilter_density_twice(env, alpha, height, samples):
    """Too sharp."""
    kernel = lambda c: right.lobe(c, alpha) / (1 + (alpha**2 - 1) * (0.5 + 0.5 * c)) ** 2  # noqa: E731
    if alpha < 0.02:
        return right.sampled(env, alpha, height, samples)
    total, weight = right.quadrature(env, height, kernel)
    return right.shaped(total / weight, height)


@mistake("How large is a pixel near the pole, on the sphere?")
def prefilter_without_solid_angle(env, alpha, height, samples):
    """The poles of the map count too much."""
    if alpha < 0.02:
        return right.sampled(env, alpha, height, samples)
    total, weight = right.quadrature(
        env, height, lambda c: right.lobe(c, alpha), np.ones(env.pixels.shape[:2])
    )
    return right.shaped(total / weight, height)


@mistake("How large is the part of the sphere that one sample stands for?")
def prefilter_coarse_mips(env, alpha, height, samples):
    """Too blurred, most so for narrow lobes."""
    return right.sampled(env, alpha, height, samples, mips=True, lod=3.0)


@mistake("Who says how many samples there are?")
def prefilter_few(env, alpha, height, samples):
    """Noisy, whatever the number of samples is."""
    rng = np.random.default_rng(3)
    return right.sampled(env, alpha, height, 16, points=lambda n: rng.random((n, 2)))


@mistake("Where does alpha come in?")
def prefilter_looked_up(env, alpha, height, samples):
    """As sharp as the map itself, whatever alpha is."""
    return env.radiance(right.output_normals(height)).reshape(height, 2 * height, 3)


# 3.4 --------------------------------------------------------------------------------------------------------------
@mistake("The chain has roughnesses, the filter wants a width: how do they go together?")
def prefilter_chain_roughness(env, roughness_levels, heights, samples):
    """All levels but the ends are too blurred."""
    return [reference.prefilter(env, r, h, samples) for r, h in zip(roughness_levels, heights, strict=True)]


@mistake("How often is the roughness squared on its way to the lobe?")
def prefilter_chain_fourth(env, roughness_levels, heights, samples):
    """All levels but the ends are too sharp."""
    return [
        reference.prefilter(env, r**4, h, samples) for r, h in zip(roughness_levels, heights, strict=True)
    ]


@mistake("From which map is a level filtered?")
def prefilter_chain_cascade(env, roughness_levels, heights, samples):
    """Each level is blurred once more by the ones before it."""
    chain, source = [], env
    for r, h in zip(roughness_levels, heights, strict=True):
        wide = reference.prefilter(source, r * r, max(16, h), samples)
        chain.append(fw.Environment(wide).radiance(fw.environment.pixel_directions(h)))
        source = fw.Environment(wide)
    return chain


@mistake("From which map is a level filtered?")
def prefilter_chain_sorted_cascade(env, roughness_levels, heights, samples):
    """Rough levels are too blurred."""
    order = np.argsort(roughness_levels)
    chain = prefilter_chain_cascade(
        env, np.asarray(roughness_levels)[order], np.asarray(heights)[order], samples
    )
    return [chain[i] for i in np.argsort(order)]


@mistake("Which map belongs to which roughness?")
def prefilter_chain_sorted(env, roughness_levels, heights, samples):
    """Levels come in ascending order, whatever was asked for."""
    return reference.prefilter_chain(env, np.sort(roughness_levels), heights, samples)


@mistake("Which map belongs to which roughness?")
def prefilter_chain_reversed(env, roughness_levels, heights, samples):
    """The first level is the last."""
    return reference.prefilter_chain(env, roughness_levels, heights, samples)[::-1]


@mistake("Each level has a height of its own.")
def prefilter_chain_one_height(env, roughness_levels, heights, samples):
    """All levels have the size of the first."""
    return reference.prefilter_chain(env, roughness_levels, [heights[0]] * len(heights), samples)


@mistake("Who chooses the roughnesses?")
def prefilter_chain_even(env, roughness_levels, heights, samples):
    """Right only for evenly spaced levels."""
    return reference.prefilter_chain(env, np.linspace(0, 1, len(heights)), heights, samples)


# 3.5 --------------------------------------------------------------------------------------------------------------
@mistake("Between two levels both have a part in the result.")
def sample_chain_nearest_level(chain, roughness_levels, direction, roughness):
    """Sharpness jumps half-way between two levels."""
    return right.between_levels(chain, roughness_levels, direction, roughness, spread=np.round)


@mistake("Between two levels both have a part in the result.")
def sample_chain_lower_level(chain, roughness_levels, direction, roughness):
    """Too sharp, and sharpness jumps at each level."""
    return right.between_levels(chain, roughness_levels, direction, roughness, spread=np.floor)


@mistake("Which level has all the weight at its own roughness?")
def sample_chain_exchanged(chain, roughness_levels, direction, roughness):
    """Right half-way between levels alone."""
    return right.between_levels(chain, roughness_levels, direction, roughness, spread=lambda t: 1 - t)


@mistake("Does the result move evenly when the roughness does?")
def sample_chain_smooth(chain, roughness_levels, direction, roughness):
    """Right at the levels and half-way, eased between."""
    return right.between_levels(
        chain, roughness_levels, direction, roughness, spread=lambda t: t * t * (3 - 2 * t)
    )


@mistake("At which roughnesses do the levels lie?")
def sample_chain_even_levels(chain, roughness_levels, direction, roughness):
    """Right only for evenly spaced levels."""
    return right.between_levels(chain, np.linspace(0, 1, len(chain)), direction, roughness)


@mistake("What is the answer beyond the ends?")
def sample_chain_extrapolated(chain, roughness_levels, direction, roughness):
    """Beyond the first and the last level colours run away."""
    return right.between_levels(chain, roughness_levels, direction, roughness, outside=True)


@mistake("Linear in what: the roughness, or its square?")
def sample_chain_linear_in_alpha(chain, roughness_levels, direction, roughness):
    """Right at the levels, too sharp between them."""
    return right.between_levels(chain, np.square(roughness_levels), direction, np.square(roughness))


@mistake("Between the centres of pixels four of them count.")
def sample_chain_nearest_pixel(chain, roughness_levels, direction, roughness):
    """Blocks: every pixel has an edge."""

    def look(pixels, d):
        height = len(pixels)
        row = np.arccos(np.clip(d[:, 1], -1, 1)) / np.pi * height
        col = np.arctan2(d[:, 0], -d[:, 2]) / np.pi * height % (2 * height)
        return pixels[np.clip(row.astype(int), 0, height - 1), np.clip(col.astype(int), 0, 2 * height - 1)]

    return right.between_levels(chain, roughness_levels, direction, roughness, look=look)


@mistake("Where in its pixel does its value lie?")
def sample_chain_half_pixel(chain, roughness_levels, direction, roughness):
    """Shifted by half a pixel."""
    from solutions.truth_maps import bilinear

    def look(pixels, d):
        theta = np.arccos(np.clip(d[:, 1], -1, 1)) + 0.5 * np.pi / len(pixels)
        phi = np.arctan2(d[:, 0], -d[:, 2]) + 0.5 * np.pi / len(pixels)
        d = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], axis=-1)
        return bilinear(pixels, d)

    return right.between_levels(chain, roughness_levels, direction, roughness, look=look)


@mistake("What lies left of the first column, and above the first row?")
def sample_chain_no_wrap(chain, roughness_levels, direction, roughness):
    """A seam down the sky, and flat poles."""

    def look(pixels, d):
        height = len(pixels)
        v = np.clip(np.arccos(np.clip(d[:, 1], -1, 1)) / np.pi * height - 0.5, 0, height - 1)
        u = np.clip(np.arctan2(d[:, 0], -d[:, 2]) / np.pi * height % (2 * height) - 0.5, 0, 2 * height - 1)
        i, j = np.minimum(v.astype(int), height - 2), np.minimum(u.astype(int), 2 * height - 2)
        s, t = (v - i)[:, None], (u - j)[:, None]
        upper = (1 - t) * pixels[i, j] + t * pixels[i, j + 1]
        return (1 - s) * upper + s * ((1 - t) * pixels[i + 1, j] + t * pixels[i + 1, j + 1])

    return right.between_levels(chain, roughness_levels, direction, roughness, look=look)


@mistake("roughness may have a value for each direction.")
def sample_chain_first_roughness(chain, roughness_levels, direction, roughness):
    """All directions get one sharpness."""
    return right.between_levels(chain, roughness_levels, direction, np.ravel(roughness)[0])


# 3.6 --------------------------------------------------------------------------------------------------------------
@mistake("The exercise asks for what the split makes of it: a mean times an integral.")
def classic_approximation_exact(f, g, weights):
    """The integral of the product itself."""
    return np.sum(f * g * weights)


@mistake("Over which part of the domain is f averaged?")
def classic_approximation_everywhere(f, g, weights):
    """Too much or too little of f: places where g is 0 count."""
    return np.sum(f * weights) / np.sum(weights) * np.sum(g * weights)


@mistake("Every sample stands for a part of the domain: how large is it?")
def classic_approximation_plain_mean(f, g, weights):
    """Right only for equal weights."""
    where = g != 0
    return f[where].mean() * np.sum(g * weights) if where.any() else 0.0


@mistake("By what is a sum divided to become a mean?")
def classic_approximation_not_normalised(f, g, weights):
    """Smaller than it should be: f is summed, not averaged."""
    return np.sum((f * weights)[g != 0]) * np.sum(g * weights)


@mistake("One factor is a mean, the other an integral: which is which?")
def classic_approximation_means(f, g, weights):
    """Larger than it should be, the more so the narrower g is."""
    where = g != 0
    if not where.any():
        return 0.0
    return np.average(f[where], weights=weights[where]) * np.average(g[where], weights=weights[where])


@mistake("Whose support limits the mean?")
def classic_approximation_support_of_f(f, g, weights):
    """As if g were everywhere: f is averaged over its own support."""
    where = f != 0
    return np.sum((f * weights)[where]) / np.sum(weights[where]) * np.sum(g * weights)


@mistake("If f is weighted by g, what is left of the approximation?")
def classic_approximation_weighted_by_g(f, g, weights):
    """The integral of the product itself."""
    total = np.sum(g * weights)
    return np.sum(f * g * weights) / total * total if total else 0.0


@mistake("Where exactly is g's support?")
def classic_approximation_positive(f, g, weights):
    """Wrong where g is negative."""
    where = g > 0
    return np.average(f[where], weights=weights[where]) * np.dot(g, weights) if where.any() else 0.0


@mistake("What is the mean over nothing, and what is the answer then?")
def classic_approximation_not_a_number(f, g, weights):
    """Not a number where g is 0 everywhere."""
    where = g != 0
    return np.sum((f * weights)[where]) / np.sum(weights[where]) * np.sum(g * weights)


@mistake("An integral is a sum of values times what?")
def classic_approximation_g_without_weights(f, g, weights):
    """Far too large."""
    where = g != 0
    return np.average(f[where], weights=weights[where]) * g.sum() if where.any() else 0.0
