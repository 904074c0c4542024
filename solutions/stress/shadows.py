"""Soft shadows from distances and marches: k from 1.01 to 1000, rays that start inside objects and on them."""

import numpy as np

import framework as fw
from solutions import environment_shadows, fast, soft_shadows
from solutions.stress import COSINES, ROUGHNESS, measured, relative

_K = np.array([1.01, 2.0, 8.0, 32.0, 215.0, 1000.0])
_EDGES = np.array([0.0, 5e-324, 1e-300, 1e-12, 1e-4, 1e-3, 0.02, 1.0, 10.0, 1e5])
_T_MIN, _T_MAX, _STEPS = 0.02, 12.0, 256


def rows(share):
    rng = np.random.default_rng(32)
    yield from _single_steps(rng, int(30_000 * share))
    yield from _horizon(rng, int(50_000 * share))
    yield from _marches(rng, max(40, int(800 * share)))
    yield from _skies(rng, max(20, int(120 * share)))


def _pairs(rng, count):
    """Distances, negative and larger than travelled ones too, and lengths of the way, (N,) each."""
    signed = np.concatenate([-_EDGES, _EDGES])
    d, t = (a.ravel() for a in np.meshgrid(signed, signed))
    size = 10 ** rng.uniform(-4, 5, count)
    return np.append(d, size * rng.uniform(-1, 2, count)), np.append(t, size * rng.uniform(0, 1, count))


def _single_steps(rng, count):
    d, t = _pairs(rng, count)
    found = soft_shadows.safe_angle(d, t)
    wide_d, wide_t = d.astype(np.longdouble), t.astype(np.longdouble)
    ratio = np.where((d > 0) & (d < t), wide_d / np.where((d > 0) & (d < t), wide_t, 1), np.where(d > 0, 1, 0))
    exact = np.arcsin(ratio)
    # arcsin near 1 turns one rounding of its argument into eps / cos.
    slope = 1 / np.sqrt(np.maximum((1 - ratio) * (1 + ratio), 1e-16))
    yield measured("safe_angle", "error over slope", found, np.abs(found - exact) / slope, 1e-15, "four roundings")
    yield measured("safe_angle", "outside [0, pi/2]", found, np.maximum(-found, found - np.pi / 2), 0, "the definition")
    values: list = []
    errors, growth, scaled = [], [], []
    for k in _K:
        value = soft_shadows.penumbra(d, t, k)
        exact = np.where(d <= 0, 0, np.where(t <= 0, 1, np.minimum(k * wide_d / np.where(t > 0, wide_t, 1), 1)))
        errors.append(relative(value, exact)[np.abs(d) > 1e-300])
        growth.append(values[-1] - value if values else np.zeros_like(value))
        scaled.append(np.abs(soft_shadows.penumbra(1024 * d, 1024 * t, k) - value)[np.abs(d) > 1e-300])
        values.append(value)
    found = np.array(values)
    yield measured("penumbra", "relative error", found, np.array(errors), 1e-15, "three roundings; k d is no denormal")
    yield measured("penumbra", "outside [0, 1]", found, np.maximum(-found, found - 1), 0, "the definition")
    yield measured("penumbra", "fall with k", found, np.array(growth), 0, "a smaller light is hidden less")
    yield measured("penumbra", "changed by scale 1024", found, np.concatenate(scaled), 0, "a power of two costs no rounding")


def _horizon(rng, count):
    normal = fw.normalize(rng.normal(size=(count, 3)))
    frame = np.stack([*fw.orthonormal_frame(normal), normal], axis=1)
    mu = rng.choice(np.concatenate([-COSINES, COSINES[1:]]), count)
    light = np.einsum("ni,nij->nj", np.stack([np.sqrt((1 - mu) * (1 + mu)), np.zeros(count), mu], axis=-1), frame)
    found = soft_shadows.needs_shadow_ray(normal, light)
    wrong = (found != (mu > 0)) & (np.abs(mu) > 1e-15)
    yield measured("needs_shadow_ray", "lights on the wrong side", found, wrong, 0, "cosines of 0 are right within 1e-15")


def _scene(scale=1.0):
    """A floor, a ball, a plate without thickness, and a ring."""
    s, shape = scale, fw.sdf
    return shape.union(
        shape.plane((0, 1, 0), 0.0), shape.sphere((0, s, 0), s), shape.box((2 * s, s, 0), (0.6 * s, 0, 0.6 * s)),
        shape.torus((-2 * s, 0.5 * s, 0), 0.6 * s, 0.2 * s),
    )  # fmt: skip


def _points(rng, count):
    """On the floor, on the ball and within it, on the plate, far away: (N, 3)."""
    floor = rng.uniform(-4, 4, (count, 3)) * [1, 0, 1]
    ball = [0, 1, 0] + rng.choice([0.0, 0.5, 1.0, 1.0 + 1e-9, 1.01], (count, 1)) * fw.normalize(rng.normal(size=(count, 3)))
    plate = [2, 1, 0] + rng.uniform(-0.6, 0.6, (count, 3)) * [1, 0, 1]
    far = 1e4 * fw.normalize(np.abs(rng.normal(size=(count, 3))) + 0.01)
    return np.concatenate([floor, ball, plate, far])


def _marches(rng, count):
    p = _points(rng, count)
    lights = fw.normalize([[0.3, 1, 0.2], [1, 0.02, 0], [0, 1, 0], [0, -1, 0]])
    sdf, reference, twin, scaled = _scene(), [], [], []
    for k in _K:
        for light in lights:
            seen = soft_shadows.soft_shadow(sdf, p, light, k, _T_MIN, _T_MAX, _STEPS)
            compiled = fast.soft_shadow(sdf, p, light, k, _T_MIN, _T_MAX, _STEPS)
            reference.append(seen)
            twin.append((seen, compiled))
            big = soft_shadows.soft_shadow(_scene(16.0), 16 * p, light, k, 16 * _T_MIN, 16 * _T_MAX, _STEPS)
            # Closer than 1e-4 is blocked, at every scale: what is within that of it may be either.
            scaled.append(np.abs(big - seen) - np.where((big > 0) & (seen > 0), 0.0, k * 1e-4 / _T_MIN))
    per_k = np.array(reference)
    grid = per_k.reshape(len(_K), len(lights), -1)
    yield measured("soft_shadow", "outside [0, 1]", per_k, np.maximum(-per_k, per_k - 1), 0, "the definition")
    yield measured("soft_shadow", "fall with k", per_k, -np.diff(grid, axis=0), 0, "the same march, a minimum of what grows")
    yield measured("soft_shadow", "changed by scale 16", per_k, np.array(scaled), 1e-12, "1e-4 stays what is blocked")
    seen, compiled = np.moveaxis(np.array(twin), 1, 0)
    near = np.tile(np.arange(len(p)) < 3 * count, len(seen)).reshape(seen.shape)
    away = np.abs(seen - compiled)
    yield measured("fast.soft_shadow", "outside [0, 1]", compiled, np.maximum(-compiled, compiled - 1), 0, "the definition")
    yield measured("fast.soft_shadow", "difference, 99th percentile", compiled, np.percentile(away[near], 99), 1e-3,
                   "float32; the rest grazes an object within 1e-4")  # fmt: skip
    angles = np.array([1e-4, 0.00465, 0.05, 0.3, 0.7])
    march = soft_shadows.area_light_shadow
    area = np.array([march(sdf, p, light, a, _T_MIN, _T_MAX, _STEPS) for a in angles for light in lights])
    yield measured("area_light_shadow", "outside [0, 1]", area, np.maximum(-area, area - 1), 1e-15, "one rounding")
    large = _scene(16.0)
    big = np.array([march(large, 16 * p, light, a, 16 * _T_MIN, 16 * _T_MAX, _STEPS) for a in angles for light in lights])
    yield measured("area_light_shadow", "changed by scale 16", area, np.abs(big - area), 1e-12, "a power of two")
    empty = [f(sdf, np.empty((0, 3)), lights[0], 8.0, _T_MIN, _T_MAX, _STEPS).size
             for f in (soft_shadows.soft_shadow, fast.soft_shadow, soft_shadows.area_light_shadow)]  # fmt: skip
    yield measured("shadows, all three", "values for an empty batch", empty, empty, 0, "nothing asked")


def _skies(rng, count):
    p = _points(rng, count)[: 3 * count]
    normal = fw.normalize(rng.normal(size=p.shape))
    sdf = _scene()
    found = environment_shadows.ambient_visibility(sdf, p, normal, 5.0)
    yield measured("ambient_visibility", "outside [0, 1]", found, np.maximum(-found, found - 1), 1e-15, "one rounding")
    big = environment_shadows.ambient_visibility(_scene(16.0), 16 * p, normal, 80.0)
    yield measured("ambient_visibility", "changed by scale 16", found, np.abs(big - found), 1e-12, "a power of two")
    nothing = fw.sdf.sphere((0, -1e4, 0), 1.0)
    found = environment_shadows.ambient_visibility(nothing, p, normal, 5.0)
    yield measured("ambient_visibility", "hidden where nothing is", found, 1 - found, 1e-15, "no occluder")
    view = fw.normalize(rng.normal(size=p.shape))
    rough, r0, albedo = rng.choice(ROUGHNESS, len(p)), rng.uniform(0, 1, p.shape), rng.uniform(0, 1, p.shape)
    values, beyond = [], []
    white, black = fw.skies.constant(4), fw.Environment(np.zeros((2, 4, 3)))
    for env in (white, black, fw.skies.single_texel(8), fw.skies.single_texel(9, 0, 0)):
        maps = [env.resized(n).pixels for n in (env.height, 1)]
        light = fw.EnvironmentLight(env, maps[-1], maps, [0.0, 1.0], fast.brdf_lut(16))
        shaded = environment_shadows.shade_with_shadows(light, sdf, p, normal, view, r0, rough, albedo, 5.0)
        bare = environment_shadows.shade_with_shadows(light, nothing, p, normal, view, r0, rough, albedo, 5.0)
        values += [shaded, bare]
        beyond += [-shaded, shaded - bare]
        if env is white:
            exact = albedo + fast.shade_split_sum(normal, view, r0, rough, light.prefiltered, light.lut)
            yield measured("shade_with_shadows", "relative error under a white sky", bare, relative(bare, exact), 1e-5,
                           "albedo plus the split sum, in float32")  # fmt: skip
    yield measured("shade_with_shadows", "below 0, or shadows that add light", values, np.array(beyond), 1e-9,
                   "roundings of 60000")  # fmt: skip
