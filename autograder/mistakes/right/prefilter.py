"""Right answers to tasks 3.1 to 3.6, each in another way, named `FUNCTION_way`."""

import math

import numpy as np

import framework as fw


# 3.1 --------------------------------------------------------------------------------------------------------------
def around(cos_theta, sin_theta, phi):
    return np.stack(
        [sin_theta * np.cos(phi), sin_theta * np.sin(phi), cos_theta * np.ones_like(phi)], axis=-1
    )


def _cosine(u, alpha):
    return np.sqrt((1 - u) / (1 + (alpha * alpha - 1) * u))


def sample_ggx_cosine(xi, alpha):
    """The inverse for the cosine, azimuth from the first column, as in Karis's listing."""
    cos_theta = _cosine(xi[:, 1], alpha)
    return around(cos_theta, np.sqrt(np.maximum(1 - cos_theta**2, 0)), 2 * np.pi * xi[:, 0])


def sample_ggx_arctan(xi, alpha):
    """By the angle, elevation from the first column."""
    theta = np.arctan(alpha * np.sqrt(xi[:, 0] / (1 - xi[:, 0])))
    return around(np.cos(theta), np.sin(theta), 2 * np.pi * xi[:, 1])


def sample_ggx_loop(xi, alpha):
    """A Python loop, with lists; the uniform number is mirrored."""
    out = []
    for (a, b), width in zip(xi, np.broadcast_to(alpha, len(xi)), strict=True):
        theta = math.atan2(width * math.sqrt(1 - a), math.sqrt(a))
        turn = 2 * math.pi * b
        out.append([math.sin(theta) * math.cos(turn), math.sin(theta) * math.sin(turn), math.cos(theta)])
    return out


def sample_ggx_float32(xi, alpha):
    """In float32, with both sides of the triangle."""
    # A double just below 1 is 1 in float32: its lobe ends at the horizon.
    u, phi = np.float32(xi[:, 0]), np.float32(2 * np.pi) * np.float32(xi[:, 1])
    opposite, adjacent = np.float32(alpha) * np.sqrt(u), np.sqrt(np.float32(1) - u)
    length = np.hypot(opposite, adjacent)
    return around(adjacent / length, opposite / length, phi)


def sample_ggx_disc(xi, alpha):
    """A uniform disc, stretched and projected onto the hemisphere: visible normals seen from straight above."""
    r, phi = np.sqrt(xi[:, 1]), 2 * np.pi * xi[:, 0]
    z = np.sqrt(np.maximum(1 - r * r, 0))
    h = np.stack([alpha * r * np.cos(phi), alpha * r * np.sin(phi), z], axis=-1)
    return h / np.linalg.norm(h, axis=1, keepdims=True)


# 3.2 and 3.3 ------------------------------------------------------------------------------------------------------
def output_normals(height):
    return fw.environment.pixel_directions(height).reshape(-1, 3)


def quadrature(env, height, kernel, weights=None):
    """A weighted mean over all pixels, in rows of the result."""
    d = env.directions().reshape(-1, 3)
    weights = env.solid_angles() if weights is None else weights
    lobe = kernel(output_normals(height) @ d.T) * weights.reshape(-1)
    return lobe @ env.pixels.reshape(-1, 3), lobe.sum(axis=1, keepdims=True)


def shaped(values, height):
    return np.asarray(values).reshape(height, 2 * height, 3)


def clamped(cosine):
    return np.maximum(cosine, 0)


def frame(n):
    """The usual frame: up is z, or x where the normal is near z."""
    up = np.array([0.0, 0.0, 1.0]) if abs(n[2]) < 0.999 else np.array([1.0, 0.0, 0.0])
    x = np.cross(up, n)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(n, x), n])


def _cosine_samples(env, height, count, points):
    out = []
    for n in output_normals(height):
        xi = points(count)
        local = around(np.sqrt(1 - xi[:, 0]), np.sqrt(xi[:, 0]), 2 * np.pi * xi[:, 1])
        out.append(env.radiance(local @ frame(n)).mean(axis=0))
    return shaped(out, height)


def irradiance_midpoint(env, height):
    """Midpoint rule with sines of the rows, divided by pi."""
    theta = np.pi * (np.arange(env.height) + 0.5) / env.height
    weights = np.repeat(np.sin(theta)[:, None] * (np.pi / env.height) ** 2, 2 * env.height, axis=1)
    return shaped(quadrature(env, height, clamped, weights)[0] / np.pi, height)


def irradiance_hammersley(env, height):
    """512 cosine-weighted directions for each normal."""
    return _cosine_samples(env, height, 512, fw.hammersley)


def irradiance_random(env, height):
    """1024 random cosine-weighted directions for each normal."""
    rng = np.random.default_rng(5)
    return _cosine_samples(env, height, 1024, lambda n: rng.random((n, 2)))


def irradiance_hemisphere_loops(env, height):
    """Learn OpenGL's way: steps in both angles of the hemisphere about each normal."""
    theta = (np.arange(24) + 0.5) * np.pi / 48
    phi, theta = np.meshgrid((np.arange(48) + 0.5) * np.pi / 24, theta)
    local = around(np.cos(theta), np.sin(theta), phi).reshape(-1, 3)
    weight = (np.cos(theta) * np.sin(theta)).reshape(-1, 1)
    return shaped(
        [np.sum(env.radiance(local @ frame(n)) * weight, 0) / weight.sum() for n in output_normals(height)],
        height,
    )


def irradiance_harmonics(env, height):
    """Nine spherical harmonics (Ramamoorthi and Hanrahan 2001)."""
    d, w = env.directions().reshape(-1, 3), env.solid_angles().reshape(-1, 1)
    band = np.array([np.pi] + [2 * np.pi / 3] * 3 + [np.pi / 4] * 5)
    moments = _harmonics(d).T @ (env.pixels.reshape(-1, 3) * w)
    return shaped((_harmonics(output_normals(height)) * band) @ moments / np.pi, height)


def _harmonics(d):
    x, y, z = d.T
    one = np.ones_like(x)
    return np.stack(
        [0.282095 * one, 0.488603 * y, 0.488603 * z, 0.488603 * x, 1.092548 * x * y, 1.092548 * y * z,
         0.315392 * (3 * z * z - 1), 1.092548 * x * z, 0.546274 * (x * x - y * y)], axis=-1,
    )  # fmt: skip


def irradiance_float32(env, height):
    """All pixels, in float32."""
    d, w = np.float32(env.directions().reshape(-1, 3)), np.float32(env.solid_angles().reshape(-1, 1))
    lobe = np.maximum(np.float32(output_normals(height)) @ d.T, np.float32(0))
    return shaped(lobe @ (np.float32(env.pixels.reshape(-1, 3)) * w) / (lobe @ w), height)


def sampled(env, alpha, height, samples, points=fw.hammersley, mips=False, weigh=True, normalise=True,
             reflect=True, widen=lambda a: a, normals=None, lod=0.0):  # fmt: skip
    """GGX importance sampling by the book, pixel by pixel; what differs is said by the arguments."""
    normals = output_normals(height) if normals is None else normals
    if alpha == 0:
        return shaped(env.radiance(normals), height)
    chain = env.mips() if mips else None
    out = []
    for n in normals:
        half = sample_ggx_cosine(points(samples), widen(alpha))
        light = 2 * half[:, 2:] * half - [0, 0, 1] if reflect else half
        n_l = light[:, 2]
        weight = np.where(n_l > 0, n_l if weigh else 1.0, 0.0)
        world = light @ frame(n)
        if mips:
            seen = _from_mips(env, chain, world, half[:, 2], alpha, samples, lod)
        else:
            seen = env.radiance(world)
        out.append(weight @ seen / (weight.sum() if normalise else samples))
    return shaped(out, height)


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


def prefilter_hammersley(env, alpha, height, samples):
    """Importance sampling with Hammersley's points."""
    return sampled(env, alpha, height, samples)


def prefilter_random(env, alpha, height, samples):
    """Importance sampling with random points, others for each pixel."""
    rng = np.random.default_rng(3)
    return sampled(env, alpha, height, samples, points=lambda n: rng.random((n, 2)))


def prefilter_same_random(env, alpha, height, samples):
    """Importance sampling with the same random points everywhere."""
    return sampled(env, alpha, height, samples, points=lambda n: np.random.default_rng(11).random((n, 2)))


def prefilter_mips(env, alpha, height, samples):
    """Importance sampling with look-ups in smaller maps where samples are sparse."""
    return sampled(env, alpha, height, samples, mips=True)


def prefilter_mips_biased(env, alpha, height, samples):
    """The same, one level further, as Colbert and Krivanek have it."""
    return sampled(env, alpha, height, samples, mips=True, lod=1.0)


def prefilter_quadrature(env, alpha, height, samples):
    """All pixels with their solid angles; a narrow lobe is looked up."""
    if alpha < 0.02:
        return env.radiance(output_normals(height)).reshape(height, 2 * height, 3)
    total, weight = quadrature(env, height, lambda c: lobe(c, alpha))
    return shaped(total / weight, height)


def lobe(cosine, alpha):
    half2 = 0.5 + 0.5 * cosine
    return np.maximum(cosine, 0) / (1 + (alpha**2 - 1) * half2) ** 2


def prefilter_float32(env, alpha, height, samples):
    """All samples at once, in float32."""
    n = np.float32(output_normals(height))
    if alpha == 0:
        return np.float32(env.radiance(n)).reshape(height, 2 * height, 3)
    half = np.float32(sample_ggx_arctan(fw.hammersley(samples), alpha))
    light = 2 * half[:, 2:] * half - np.float32([0, 0, 1])
    weight = np.maximum(light[:, 2], np.float32(0))
    x, y = (np.float32(v) for v in fw.orthonormal_frame(n))
    world = np.einsum("sk,nkj->nsj", light, np.stack([x, y, n], axis=1))
    seen = np.float32(env.radiance(world.reshape(-1, 3))).reshape(len(n), -1, 3)
    return shaped(np.einsum("s,nsj->nj", weight, seen) / weight.sum(), height)


# 3.4 --------------------------------------------------------------------------------------------------------------
def prefilter_chain_array_or_list(env, roughness_levels, heights, samples):
    """A tuple, sampled."""
    pairs = zip(roughness_levels, heights, strict=True)
    return tuple(sampled(env, r * r, int(h), samples) for r, h in pairs)


def prefilter_chain_quadrature(env, roughness_levels, heights, samples):
    """All pixels."""
    pairs = zip(roughness_levels, heights, strict=True)
    return [prefilter_quadrature(env, r * r, int(h), samples) for r, h in pairs]


def prefilter_chain_random(env, roughness_levels, heights, samples):
    """Random samples."""
    pairs = zip(roughness_levels, heights, strict=True)
    return [prefilter_random(env, r * r, int(h), samples) for r, h in pairs]


# 3.5 --------------------------------------------------------------------------------------------------------------
def between_levels(chain, levels, direction, roughness, spread=lambda t: t, look=None, outside=False):
    look = look or (lambda pixels, d: fw.Environment(pixels).radiance(d))
    out = []
    for d, r in zip(direction, np.broadcast_to(roughness, len(direction)), strict=True):
        i = int(np.clip(np.searchsorted(levels, r) - 1, 0, len(levels) - 2))
        t = (r - levels[i]) / (levels[i + 1] - levels[i])
        t = spread(t if outside else min(max(t, 0.0), 1.0))
        out.append((1 - t) * look(chain[i], d[None])[0] + t * look(chain[i + 1], d[None])[0])
    return np.array(out)


def sample_chain_loop(chain, roughness_levels, direction, roughness):
    """Direction by direction."""
    return between_levels(chain, roughness_levels, direction, roughness)


def sample_chain_all_levels(chain, roughness_levels, direction, roughness):
    """Every level looked up, in float32."""
    seen = np.stack([fw.Environment(pixels).radiance(direction) for pixels in chain]).astype(np.float32)
    place = np.interp(np.broadcast_to(roughness, len(direction)), roughness_levels, np.arange(len(chain)))
    weight = np.maximum(1 - np.abs(place - np.arange(len(chain))[:, None]), 0).astype(np.float32)
    return (seen * weight[..., None]).sum(axis=0)


def sample_chain_own_bilinear(chain, roughness_levels, direction, roughness):
    """With bilinear look-ups by hand."""
    from solutions.truth_maps import bilinear

    return between_levels(chain, roughness_levels, direction, roughness, look=bilinear)


# 3.6 --------------------------------------------------------------------------------------------------------------
def classic_approximation_loop(f, g, weights):
    """A Python loop."""
    size = total = extent = 0.0
    for a, b, w in zip(f, g, weights, strict=True):
        size += b * w
        total, extent = (total + a * w, extent + w) if b != 0 else (total, extent)
    return total / extent * size if extent else 0.0


def classic_approximation_average(f, g, weights):
    """With np.average."""
    where = np.asarray(g) != 0
    return np.average(f[where], weights=weights[where]) * np.dot(g, weights) if where.any() else 0.0


def classic_approximation_float32(f, g, weights):
    """In float32."""
    f, g, weights = np.float32(f), np.float32(g), np.float32(weights)
    where = (g != 0).astype(np.float32)
    extent = (where * weights).sum()
    return (f * where * weights).sum() / np.where(extent > 0, extent, 1) * (g * weights).sum()
