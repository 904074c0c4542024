"""Right and wrong versions of tasks 3.1 to 3.6, named `right_FUNCTION_what` and `wrong_FUNCTION_what`."""

import math

import numpy as np

import framework as fw
from solutions import prefilter as reference


# 3.1 --------------------------------------------------------------------------------------------------------------
def _around(cos_theta, sin_theta, phi):
    return np.stack(
        [sin_theta * np.cos(phi), sin_theta * np.sin(phi), cos_theta * np.ones_like(phi)], axis=-1
    )


def _cosine(u, alpha):
    return np.sqrt((1 - u) / (1 + (alpha * alpha - 1) * u))


def right_sample_ggx_cosine(xi, alpha):
    """The inverse for the cosine, azimuth from the first column, as in Karis's listing."""
    cos_theta = _cosine(xi[:, 1], alpha)
    return _around(cos_theta, np.sqrt(np.maximum(1 - cos_theta**2, 0)), 2 * np.pi * xi[:, 0])


def right_sample_ggx_arctan(xi, alpha):
    """By the angle, elevation from the first column."""
    theta = np.arctan(alpha * np.sqrt(xi[:, 0] / (1 - xi[:, 0])))
    return _around(np.cos(theta), np.sin(theta), 2 * np.pi * xi[:, 1])


def right_sample_ggx_loop(xi, alpha):
    """A Python loop, with lists; the uniform number is mirrored."""
    out = []
    for (a, b), width in zip(xi, np.broadcast_to(alpha, len(xi)), strict=True):
        theta = math.atan2(width * math.sqrt(1 - a), math.sqrt(a))
        turn = 2 * math.pi * b
        out.append([math.sin(theta) * math.cos(turn), math.sin(theta) * math.sin(turn), math.cos(theta)])
    return out


def right_sample_ggx_float32(xi, alpha):
    """In float32, with both sides of the triangle."""
    # A double just below 1 is 1 in float32: its lobe ends at the horizon.
    u, phi = np.float32(xi[:, 0]), np.float32(2 * np.pi) * np.float32(xi[:, 1])
    opposite, adjacent = np.float32(alpha) * np.sqrt(u), np.sqrt(np.float32(1) - u)
    length = np.hypot(opposite, adjacent)
    return _around(adjacent / length, opposite / length, phi)


def right_sample_ggx_disc(xi, alpha):
    """A uniform disc, stretched and projected onto the hemisphere: visible normals seen from straight above."""
    r, phi = np.sqrt(xi[:, 1]), 2 * np.pi * xi[:, 0]
    z = np.sqrt(np.maximum(1 - r * r, 0))
    h = np.stack([alpha * r * np.cos(phi), alpha * r * np.sin(phi), z], axis=-1)
    return h / np.linalg.norm(h, axis=1, keepdims=True)


def wrong_sample_ggx_roughness(xi, alpha):
    """Alpha is squared once more."""
    return right_sample_ggx_arctan(xi, np.square(alpha))


def wrong_sample_ggx_root(xi, alpha):
    """The square of alpha is forgotten in the cosine."""
    cos_theta = np.sqrt((1 - xi[:, 1]) / (1 + (alpha - 1) * xi[:, 1]))
    return _around(cos_theta, np.sqrt(1 - cos_theta**2), 2 * np.pi * xi[:, 0])


def wrong_sample_ggx_beckmann(xi, alpha):
    """Samples of Beckmann."""
    theta = np.arctan(alpha * np.sqrt(-np.log(1 - xi[:, 0])))
    return _around(np.cos(theta), np.sin(theta), 2 * np.pi * xi[:, 1])


def wrong_sample_ggx_no_root(xi, alpha):
    """The root of the tangent's square is forgotten."""
    theta = np.arctan(alpha * xi[:, 0] / (1 - xi[:, 0]))
    return _around(np.cos(theta), np.sin(theta), 2 * np.pi * xi[:, 1])


def wrong_sample_ggx_hemisphere(xi, alpha):
    """A uniform hemisphere."""
    return _around(xi[:, 0], np.sqrt(1 - xi[:, 0] ** 2), 2 * np.pi * xi[:, 1])


def wrong_sample_ggx_same_column(xi, alpha):
    """Tilt and azimuth from one column: samples on a spiral."""
    return right_sample_ggx_arctan(xi[:, [0, 0]], alpha)


def wrong_sample_ggx_half_turn(xi, alpha):
    """The azimuth covers half a circle."""
    return right_sample_ggx_arctan(xi * [1, 0.5], alpha)


def wrong_sample_ggx_about_y(xi, alpha):
    """About +y instead of +z."""
    return right_sample_ggx_arctan(xi, alpha)[:, [0, 2, 1]]


def wrong_sample_ggx_reflected(xi, alpha):
    """The reflected direction instead of the half vector."""
    h = right_sample_ggx_arctan(xi, alpha)
    return 2 * h[:, 2:] * h - [0, 0, 1]


def wrong_sample_ggx_not_unit(xi, alpha):
    """Slopes, not unit vectors."""
    h = right_sample_ggx_disc(xi, alpha)
    return h / np.maximum(h[:, 2:], 1e-9)


def wrong_sample_ggx_density_without_cosine(xi, alpha):
    """Density D(h) alone, normalised: the factor n.h is forgotten."""
    theta = np.linspace(0, np.pi / 2, 4000)
    d = np.sin(theta) / ((np.cos(theta) * alpha) ** 2 + np.sin(theta) ** 2 + 1e-300) ** 2
    share = np.cumsum(d) / d.sum() if np.ndim(alpha) == 0 else np.linspace(0, 1, 4000)
    theta = np.interp(xi[:, 0], share, theta)
    return _around(np.cos(theta), np.sin(theta), 2 * np.pi * xi[:, 1])


# 3.2 and 3.3 ------------------------------------------------------------------------------------------------------
def _normals(height):
    return fw.environment.pixel_directions(height).reshape(-1, 3)


def _quadrature(env, height, kernel, weights=None):
    """A weighted mean over all pixels, in rows of the result."""
    d = env.directions().reshape(-1, 3)
    weights = env.solid_angles() if weights is None else weights
    lobe = kernel(_normals(height) @ d.T) * weights.reshape(-1)
    return lobe @ env.pixels.reshape(-1, 3), lobe.sum(axis=1, keepdims=True)


def _shaped(values, height):
    return np.asarray(values).reshape(height, 2 * height, 3)


def _clamped(cosine):
    return np.maximum(cosine, 0)


def _frame(n):
    """The usual frame: up is z, or x where the normal is near z."""
    up = np.array([0.0, 0.0, 1.0]) if abs(n[2]) < 0.999 else np.array([1.0, 0.0, 0.0])
    x = np.cross(up, n)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(n, x), n])


def _cosine_samples(env, height, count, points):
    out = []
    for n in _normals(height):
        xi = points(count)
        local = _around(np.sqrt(1 - xi[:, 0]), np.sqrt(xi[:, 0]), 2 * np.pi * xi[:, 1])
        out.append(env.radiance(local @ _frame(n)).mean(axis=0))
    return _shaped(out, height)


def right_irradiance_midpoint(env, height):
    """Midpoint rule with sines of the rows, divided by pi."""
    theta = np.pi * (np.arange(env.height) + 0.5) / env.height
    weights = np.repeat(np.sin(theta)[:, None] * (np.pi / env.height) ** 2, 2 * env.height, axis=1)
    return _shaped(_quadrature(env, height, _clamped, weights)[0] / np.pi, height)


def right_irradiance_hammersley(env, height):
    """512 cosine-weighted directions for each normal."""
    return _cosine_samples(env, height, 512, fw.hammersley)


def right_irradiance_random(env, height):
    """1024 random cosine-weighted directions for each normal."""
    rng = np.random.default_rng(5)
    return _cosine_samples(env, height, 1024, lambda n: rng.random((n, 2)))


def right_irradiance_hemisphere_loops(env, height):
    """Learn OpenGL's way: steps in both angles of the hemisphere about each normal."""
    theta = (np.arange(24) + 0.5) * np.pi / 48
    phi, theta = np.meshgrid((np.arange(48) + 0.5) * np.pi / 24, theta)
    local = _around(np.cos(theta), np.sin(theta), phi).reshape(-1, 3)
    weight = (np.cos(theta) * np.sin(theta)).reshape(-1, 1)
    return _shaped(
        [np.sum(env.radiance(local @ _frame(n)) * weight, 0) / weight.sum() for n in _normals(height)], height
    )


def right_irradiance_harmonics(env, height):
    """Nine spherical harmonics (Ramamoorthi and Hanrahan 2001)."""
    d, w = env.directions().reshape(-1, 3), env.solid_angles().reshape(-1, 1)
    band = np.array([np.pi] + [2 * np.pi / 3] * 3 + [np.pi / 4] * 5)
    moments = _harmonics(d).T @ (env.pixels.reshape(-1, 3) * w)
    return _shaped((_harmonics(_normals(height)) * band) @ moments / np.pi, height)


def _harmonics(d):
    x, y, z = d.T
    one = np.ones_like(x)
    return np.stack(
        [0.282095 * one, 0.488603 * y, 0.488603 * z, 0.488603 * x, 1.092548 * x * y, 1.092548 * y * z,
         0.315392 * (3 * z * z - 1), 1.092548 * x * z, 0.546274 * (x * x - y * y)], axis=-1,
    )  # fmt: skip


def right_irradiance_float32(env, height):
    """All pixels, in float32."""
    d, w = np.float32(env.directions().reshape(-1, 3)), np.float32(env.solid_angles().reshape(-1, 1))
    lobe = np.maximum(np.float32(_normals(height)) @ d.T, np.float32(0))
    return _shaped(lobe @ (np.float32(env.pixels.reshape(-1, 3)) * w) / (lobe @ w), height)


def wrong_irradiance_without_sine(env, height):
    """Pixels count alike: the solid angle is forgotten."""
    total, weight = _quadrature(env, height, _clamped, np.ones(env.pixels.shape[:2]))
    return _shaped(total / weight, height)


def wrong_irradiance_without_pi(env, height):
    """Not divided by pi."""
    return reference.irradiance(env, height) * np.pi


def wrong_irradiance_without_cosine(env, height):
    """The plain mean of the hemisphere."""
    total, weight = _quadrature(env, height, lambda c: np.where(c > 0, 1.0, 0.0))
    return _shaped(total / weight, height)


def wrong_irradiance_squared_cosine(env, height):
    """Weighted by the cosine although the samples already are."""
    total, weight = _quadrature(env, height, lambda c: np.maximum(c, 0) ** 2)
    return _shaped(total / weight, height)


def wrong_irradiance_both_sides(env, height):
    """Light from behind counts."""
    total, weight = _quadrature(env, height, np.abs)
    return _shaped(total / weight, height)


def wrong_irradiance_edges(env, height):
    """Normals through the corners of the pixels."""
    fine = reference.irradiance(env, 2 * height)
    corners = 0.25 * (fine + np.roll(fine, 1, 1) + np.roll(fine, 1, 0) + np.roll(fine, (1, 1), (0, 1)))
    return corners[::2, ::2]


def wrong_irradiance_mirrored(env, height):
    """The azimuth runs the other way."""
    return reference.irradiance(env, height)[:, ::-1]


def wrong_irradiance_shifted(env, height):
    """Azimuth 0 in the middle of the map."""
    return np.roll(reference.irradiance(env, height), height, axis=1)


def wrong_irradiance_upside_down(env, height):
    """Row 0 looks down."""
    return reference.irradiance(env, height)[::-1]


def wrong_irradiance_mean(env, height):
    """The mean of the whole map."""
    mean = (env.pixels * env.solid_angles()[..., None]).sum((0, 1)) / (4 * np.pi)
    return np.broadcast_to(mean, (height, 2 * height, 3))


def wrong_irradiance_looked_up(env, height):
    """The map itself, smaller."""
    return env.resized(height).pixels


def _sampled(env, alpha, height, samples, points=fw.hammersley, mips=False, weigh=True, normalise=True,
             reflect=True, widen=lambda a: a, normals=None, lod=0.0, wrong_side=False):  # fmt: skip
    """GGX importance sampling by the book, pixel by pixel; what differs is said by the arguments."""
    normals = _normals(height) if normals is None else normals
    if alpha == 0:
        return _shaped(env.radiance(normals), height)
    chain = env.mips() if mips else None
    out = []
    for n in normals:
        half = right_sample_ggx_cosine(points(samples), widen(alpha))
        light = 2 * half[:, 2:] * half - [0, 0, 1] if reflect else half
        n_l = -light[:, 2] if wrong_side else light[:, 2]
        weight = np.where(n_l > 0, n_l if weigh else 1.0, 0.0)
        world = light @ _frame(n)
        if mips:
            seen = _from_mips(env, chain, world, half[:, 2], alpha, samples, lod)
        else:
            seen = env.radiance(world)
        out.append(weight @ seen / (weight.sum() if normalise else samples))
    return _shaped(out, height)


def _from_mips(env, chain, world, cos_h, alpha, samples, bias):
    """Look-ups in the level whose pixel is as large as the sample's share of the sphere."""
    density = (alpha / (cos_h**2 * (alpha**2 - 1) + 1)) ** 2 / np.pi / 4
    pixel = 4 * np.pi / (2 * env.height**2)
    level = np.clip(0.5 * np.log2(1 / (samples * density) / pixel) + bias, 0, len(chain) - 1)
    low = np.minimum(level.astype(int), len(chain) - 2)
    t = (level - low)[:, None]
    values = np.stack([e.radiance(world) for e in chain])
    each = np.arange(len(world))
    return (1 - t) * values[low, each] + t * values[low + 1, each]


def right_prefilter_hammersley(env, alpha, height, samples):
    """Importance sampling with Hammersley's points."""
    return _sampled(env, alpha, height, samples)


def right_prefilter_random(env, alpha, height, samples):
    """Importance sampling with random points, others for each pixel."""
    rng = np.random.default_rng(3)
    return _sampled(env, alpha, height, samples, points=lambda n: rng.random((n, 2)))


def right_prefilter_same_random(env, alpha, height, samples):
    """Importance sampling with the same random points everywhere."""
    return _sampled(env, alpha, height, samples, points=lambda n: np.random.default_rng(11).random((n, 2)))


def right_prefilter_mips(env, alpha, height, samples):
    """Importance sampling with look-ups in smaller maps where samples are sparse."""
    return _sampled(env, alpha, height, samples, mips=True)


def right_prefilter_mips_biased(env, alpha, height, samples):
    """The same, one level further, as Colbert and Krivanek have it."""
    return _sampled(env, alpha, height, samples, mips=True, lod=1.0)


def right_prefilter_quadrature(env, alpha, height, samples):
    """All pixels with their solid angles; a narrow lobe is looked up."""
    if alpha < 0.02:
        return env.radiance(_normals(height)).reshape(height, 2 * height, 3)
    total, weight = _quadrature(env, height, lambda c: _lobe(c, alpha))
    return _shaped(total / weight, height)


def _lobe(cosine, alpha):
    half2 = 0.5 + 0.5 * cosine
    return np.maximum(cosine, 0) / (1 + (alpha**2 - 1) * half2) ** 2


def right_prefilter_float32(env, alpha, height, samples):
    """All samples at once, in float32."""
    n = np.float32(_normals(height))
    if alpha == 0:
        return np.float32(env.radiance(n)).reshape(height, 2 * height, 3)
    half = np.float32(right_sample_ggx_arctan(fw.hammersley(samples), alpha))
    light = 2 * half[:, 2:] * half - np.float32([0, 0, 1])
    weight = np.maximum(light[:, 2], np.float32(0))
    x, y = (np.float32(v) for v in fw.orthonormal_frame(n))
    world = np.einsum("sk,nkj->nsj", light, np.stack([x, y, n], axis=1))
    seen = np.float32(env.radiance(world.reshape(-1, 3))).reshape(len(n), -1, 3)
    return _shaped(np.einsum("s,nsj->nj", weight, seen) / weight.sum(), height)


def wrong_prefilter_roughness(env, alpha, height, samples):
    """Alpha taken for the roughness: squared once more."""
    return _sampled(env, alpha, height, samples, widen=lambda a: a * a)


def wrong_prefilter_root(env, alpha, height, samples):
    """The roughness taken for alpha."""
    return _sampled(env, alpha, height, samples, widen=np.sqrt)


def wrong_prefilter_by_count(env, alpha, height, samples):
    """Divided by the number of samples."""
    return _sampled(env, alpha, height, samples, normalise=False)


def wrong_prefilter_unweighted(env, alpha, height, samples):
    """Not weighted by n.l."""
    return _sampled(env, alpha, height, samples, weigh=False)


def wrong_prefilter_half_vector(env, alpha, height, samples):
    """Looks along the half vector instead of the reflection."""
    return _sampled(env, alpha, height, samples, reflect=False)


def wrong_prefilter_away(env, alpha, height, samples):
    """Light from the other side: the reflected view has the wrong sign."""
    return _sampled(env, alpha, height, samples, normals=-_normals(height))


def wrong_prefilter_corners(env, alpha, height, samples):
    """Normals through the corners of the pixels."""
    row, col = np.mgrid[:height, : 2 * height] * np.pi / height
    d = np.stack([np.sin(row) * np.sin(col), np.cos(row), -np.sin(row) * np.cos(col)], -1)
    return _sampled(env, alpha, height, samples, normals=d.reshape(-1, 3))


def wrong_prefilter_mirrored(env, alpha, height, samples):
    """The azimuth runs the other way."""
    return _sampled(env, alpha, height, samples)[:, ::-1]


def wrong_prefilter_turned(env, alpha, height, samples):
    """Azimuth 0 along another axis."""
    return np.roll(_sampled(env, alpha, height, samples), height // 2, axis=1)


def wrong_prefilter_beckmann(env, alpha, height, samples):
    """Samples of Beckmann."""
    if alpha == 0:
        return _sampled(env, 0, height, samples)
    half = wrong_sample_ggx_beckmann(fw.hammersley(samples), alpha)
    light = 2 * half[:, 2:] * half - [0, 0, 1]
    weight = np.maximum(light[:, 2], 0)
    return _shaped(
        [weight @ env.radiance(light @ _frame(n)) / weight.sum() for n in _normals(height)], height
    )


def wrong_prefilter_density_twice(env, alpha, height, samples):
    """Weighted by D although the samples follow it."""
    kernel = lambda c: _lobe(c, alpha) / (1 + (alpha**2 - 1) * (0.5 + 0.5 * c)) ** 2  # noqa: E731
    if alpha < 0.02:
        return _sampled(env, alpha, height, samples)
    total, weight = _quadrature(env, height, kernel)
    return _shaped(total / weight, height)


def wrong_prefilter_without_solid_angle(env, alpha, height, samples):
    """All pixels alike: the solid angle is forgotten."""
    if alpha < 0.02:
        return _sampled(env, alpha, height, samples)
    total, weight = _quadrature(env, height, lambda c: _lobe(c, alpha), np.ones(env.pixels.shape[:2]))
    return _shaped(total / weight, height)


def wrong_prefilter_coarse_mips(env, alpha, height, samples):
    """Look-ups two levels too far."""
    return _sampled(env, alpha, height, samples, mips=True, lod=3.0)


def wrong_prefilter_few(env, alpha, height, samples):
    """Sixteen random samples whatever was asked for."""
    rng = np.random.default_rng(3)
    return _sampled(env, alpha, height, 16, points=lambda n: rng.random((n, 2)))


def wrong_prefilter_looked_up(env, alpha, height, samples):
    """The map itself, smaller."""
    return env.radiance(_normals(height)).reshape(height, 2 * height, 3)


# 3.4 --------------------------------------------------------------------------------------------------------------
def right_prefilter_chain_array_or_list(env, roughness_levels, heights, samples):
    """A tuple, sampled."""
    pairs = zip(roughness_levels, heights, strict=True)
    return tuple(_sampled(env, r * r, int(h), samples) for r, h in pairs)


def right_prefilter_chain_quadrature(env, roughness_levels, heights, samples):
    """All pixels."""
    pairs = zip(roughness_levels, heights, strict=True)
    return [right_prefilter_quadrature(env, r * r, int(h), samples) for r, h in pairs]


def right_prefilter_chain_random(env, roughness_levels, heights, samples):
    """Random samples."""
    pairs = zip(roughness_levels, heights, strict=True)
    return [right_prefilter_random(env, r * r, int(h), samples) for r, h in pairs]


def wrong_prefilter_chain_roughness(env, roughness_levels, heights, samples):
    """The roughness is not squared."""
    return [reference.prefilter(env, r, h, samples) for r, h in zip(roughness_levels, heights, strict=True)]


def wrong_prefilter_chain_fourth(env, roughness_levels, heights, samples):
    """Squared twice."""
    return [
        reference.prefilter(env, r**4, h, samples) for r, h in zip(roughness_levels, heights, strict=True)
    ]


def wrong_prefilter_chain_cascade(env, roughness_levels, heights, samples):
    """Each map from the one before it."""
    chain, source = [], env
    for r, h in zip(roughness_levels, heights, strict=True):
        wide = reference.prefilter(source, r * r, max(16, h), samples)
        chain.append(fw.Environment(wide).radiance(fw.environment.pixel_directions(h)))
        source = fw.Environment(wide)
    return chain


def wrong_prefilter_chain_sorted_cascade(env, roughness_levels, heights, samples):
    """Each map from the next sharper one."""
    order = np.argsort(roughness_levels)
    chain = wrong_prefilter_chain_cascade(
        env, np.asarray(roughness_levels)[order], np.asarray(heights)[order], samples
    )
    return [chain[i] for i in np.argsort(order)]


def wrong_prefilter_chain_sorted(env, roughness_levels, heights, samples):
    """The levels in ascending order, whatever was asked for."""
    return reference.prefilter_chain(env, np.sort(roughness_levels), heights, samples)


def wrong_prefilter_chain_reversed(env, roughness_levels, heights, samples):
    """Backwards."""
    return reference.prefilter_chain(env, roughness_levels, heights, samples)[::-1]


def wrong_prefilter_chain_one_height(env, roughness_levels, heights, samples):
    """All maps as high as the first."""
    return reference.prefilter_chain(env, roughness_levels, [heights[0]] * len(heights), samples)


def wrong_prefilter_chain_even(env, roughness_levels, heights, samples):
    """Evenly spaced levels instead of those asked for."""
    return reference.prefilter_chain(env, np.linspace(0, 1, len(heights)), heights, samples)


# 3.5 --------------------------------------------------------------------------------------------------------------
def _levels(chain, levels, direction, roughness, spread=lambda t: t, look=None, outside=False):
    look = look or (lambda pixels, d: fw.Environment(pixels).radiance(d))
    out = []
    for d, r in zip(direction, np.broadcast_to(roughness, len(direction)), strict=True):
        i = int(np.clip(np.searchsorted(levels, r) - 1, 0, len(levels) - 2))
        t = (r - levels[i]) / (levels[i + 1] - levels[i])
        t = spread(t if outside else min(max(t, 0.0), 1.0))
        out.append((1 - t) * look(chain[i], d[None])[0] + t * look(chain[i + 1], d[None])[0])
    return np.array(out)


def right_sample_chain_loop(chain, roughness_levels, direction, roughness):
    """Direction by direction."""
    return _levels(chain, roughness_levels, direction, roughness)


def right_sample_chain_all_levels(chain, roughness_levels, direction, roughness):
    """Every level looked up, in float32."""
    seen = np.stack([fw.Environment(pixels).radiance(direction) for pixels in chain]).astype(np.float32)
    place = np.interp(np.broadcast_to(roughness, len(direction)), roughness_levels, np.arange(len(chain)))
    weight = np.maximum(1 - np.abs(place - np.arange(len(chain))[:, None]), 0).astype(np.float32)
    return (seen * weight[..., None]).sum(axis=0)


def right_sample_chain_own_bilinear(chain, roughness_levels, direction, roughness):
    """With bilinear look-ups by hand."""
    from solutions.truth_maps import bilinear

    return _levels(chain, roughness_levels, direction, roughness, look=bilinear)


def wrong_sample_chain_nearest_level(chain, roughness_levels, direction, roughness):
    """The nearest level alone."""
    return _levels(chain, roughness_levels, direction, roughness, spread=np.round)


def wrong_sample_chain_lower_level(chain, roughness_levels, direction, roughness):
    """The sharper level alone."""
    return _levels(chain, roughness_levels, direction, roughness, spread=np.floor)


def wrong_sample_chain_exchanged(chain, roughness_levels, direction, roughness):
    """Exchanged weights."""
    return _levels(chain, roughness_levels, direction, roughness, spread=lambda t: 1 - t)


def wrong_sample_chain_smooth(chain, roughness_levels, direction, roughness):
    """A smooth step instead of a line."""
    return _levels(chain, roughness_levels, direction, roughness, spread=lambda t: t * t * (3 - 2 * t))


def wrong_sample_chain_even_levels(chain, roughness_levels, direction, roughness):
    """As if levels were evenly spaced from 0 to 1."""
    return _levels(chain, np.linspace(0, 1, len(chain)), direction, roughness)


def wrong_sample_chain_extrapolated(chain, roughness_levels, direction, roughness):
    """Goes on beyond the ends."""
    return _levels(chain, roughness_levels, direction, roughness, outside=True)


def wrong_sample_chain_linear_in_alpha(chain, roughness_levels, direction, roughness):
    """Linear in roughness squared."""
    return _levels(chain, np.square(roughness_levels), direction, np.square(roughness))


def wrong_sample_chain_nearest_pixel(chain, roughness_levels, direction, roughness):
    """The nearest pixel."""

    def look(pixels, d):
        height = len(pixels)
        row = np.arccos(np.clip(d[:, 1], -1, 1)) / np.pi * height
        col = np.arctan2(d[:, 0], -d[:, 2]) / np.pi * height % (2 * height)
        return pixels[np.clip(row.astype(int), 0, height - 1), np.clip(col.astype(int), 0, 2 * height - 1)]

    return _levels(chain, roughness_levels, direction, roughness, look=look)


def wrong_sample_chain_half_pixel(chain, roughness_levels, direction, roughness):
    """Centres at whole pixels; columns do wrap."""
    from solutions.truth_maps import bilinear

    def look(pixels, d):
        theta = np.arccos(np.clip(d[:, 1], -1, 1)) + 0.5 * np.pi / len(pixels)
        phi = np.arctan2(d[:, 0], -d[:, 2]) + 0.5 * np.pi / len(pixels)
        d = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], axis=-1)
        return bilinear(pixels, d)

    return _levels(chain, roughness_levels, direction, roughness, look=look)


def wrong_sample_chain_no_wrap(chain, roughness_levels, direction, roughness):
    """Columns end at the seam, rows at the poles."""

    def look(pixels, d):
        height = len(pixels)
        v = np.clip(np.arccos(np.clip(d[:, 1], -1, 1)) / np.pi * height - 0.5, 0, height - 1)
        u = np.clip(np.arctan2(d[:, 0], -d[:, 2]) / np.pi * height % (2 * height) - 0.5, 0, 2 * height - 1)
        i, j = np.minimum(v.astype(int), height - 2), np.minimum(u.astype(int), 2 * height - 2)
        s, t = (v - i)[:, None], (u - j)[:, None]
        upper = (1 - t) * pixels[i, j] + t * pixels[i, j + 1]
        return (1 - s) * upper + s * ((1 - t) * pixels[i + 1, j] + t * pixels[i + 1, j + 1])

    return _levels(chain, roughness_levels, direction, roughness, look=look)


def wrong_sample_chain_first_roughness(chain, roughness_levels, direction, roughness):
    """One roughness for all directions."""
    return _levels(chain, roughness_levels, direction, np.ravel(roughness)[0])


# 3.6 --------------------------------------------------------------------------------------------------------------
def right_classic_approximation_loop(f, g, weights):
    """A Python loop."""
    size = total = extent = 0.0
    for a, b, w in zip(f, g, weights, strict=True):
        size += b * w
        total, extent = (total + a * w, extent + w) if b != 0 else (total, extent)
    return total / extent * size if extent else 0.0


def right_classic_approximation_average(f, g, weights):
    """With np.average."""
    where = np.asarray(g) != 0
    return np.average(f[where], weights=weights[where]) * np.dot(g, weights) if where.any() else 0.0


def right_classic_approximation_float32(f, g, weights):
    """In float32."""
    f, g, weights = np.float32(f), np.float32(g), np.float32(weights)
    where = (g != 0).astype(np.float32)
    extent = (where * weights).sum()
    return (f * where * weights).sum() / np.where(extent > 0, extent, 1) * (g * weights).sum()


def wrong_classic_approximation_exact(f, g, weights):
    """The integral of the product itself."""
    return np.sum(f * g * weights)


def wrong_classic_approximation_everywhere(f, g, weights):
    """The mean of f over everything."""
    return np.sum(f * weights) / np.sum(weights) * np.sum(g * weights)


def wrong_classic_approximation_plain_mean(f, g, weights):
    """The mean of f without weights."""
    where = g != 0
    return f[where].mean() * np.sum(g * weights) if where.any() else 0.0


def wrong_classic_approximation_not_normalised(f, g, weights):
    """The integral of f instead of its mean."""
    return np.sum((f * weights)[g != 0]) * np.sum(g * weights)


def wrong_classic_approximation_means(f, g, weights):
    """The product of two means."""
    where = g != 0
    if not where.any():
        return 0.0
    return np.average(f[where], weights=weights[where]) * np.average(g[where], weights=weights[where])


def wrong_classic_approximation_support_of_f(f, g, weights):
    """The mean of f over its own support."""
    where = f != 0
    return np.sum((f * weights)[where]) / np.sum(weights[where]) * np.sum(g * weights)


def wrong_classic_approximation_weighted_by_g(f, g, weights):
    """The mean of f weighted by g: the exact product again."""
    total = np.sum(g * weights)
    return np.sum(f * g * weights) / total * total if total else 0.0


def wrong_classic_approximation_positive(f, g, weights):
    """Only where g is positive."""
    where = g > 0
    return np.average(f[where], weights=weights[where]) * np.dot(g, weights) if where.any() else 0.0


def wrong_classic_approximation_not_a_number(f, g, weights):
    """No support is not thought of."""
    where = g != 0
    return np.sum((f * weights)[where]) / np.sum(weights[where]) * np.sum(g * weights)


def wrong_classic_approximation_g_without_weights(f, g, weights):
    """The integral of g without weights."""
    where = g != 0
    return np.average(f[where], weights=weights[where]) * g.sum() if where.any() else 0.0
