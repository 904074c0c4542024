"""Right, costly and wrong versions of tasks 5.1 to 5.3, named `KIND_FUNCTION_what`."""

import numpy as np

import framework as fw
from solutions import environment_shadows as reference

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


# 5.1 --------------------------------------------------------------------------------------------------------------
def _cut(env, count, weights=LUMINANCE, even=True, centre=False, flat=False, unequal=False, narrow=True):
    """Median cut with a list; each switch is one choice, or one mistake."""
    height = len(env.pixels)
    solid = np.full((height, 2 * height), 2 * np.pi / height**2) if flat else env.solid_angles()
    light, d = env.pixels * solid[..., None], env.directions()
    energy = light @ np.asarray(weights)
    regions = [(0, height, 0, 2 * height)]
    while len(regions) < count:
        size = [(b - a) * (r - l) for a, b, l, r in regions]
        value = [energy[a:b, l:r].sum() if even else (b - a) * (r - l) for a, b, l, r in regions]
        best = max((i for i in range(len(regions)) if size[i] > 1), key=lambda i: (value[i], size[i]))
        a, b, l, r = regions.pop(best)
        width = (r - l) * (np.sin(np.pi * 0.5 * (a + b) / height) if narrow else 1)
        columns = r - l > 1 and (width > b - a or b - a == 1)
        profile = energy[a:b, l:r].sum(axis=0 if columns else 1)
        sums = np.cumsum(profile)[:-1]
        at = (
            1 + int(np.argmin(np.abs(sums - profile.sum() / 2)))
            if profile.sum() > 0 and not unequal
            else len(profile) // 2
        )
        regions += (
            [(a, b, l, l + at), (a, b, l + at, r)] if columns else [(a, a + at, l, r), (a + at, b, l, r)]
        )
    toward, power = [], []
    for a, b, l, r in regions:
        power.append(light[a:b, l:r].sum(axis=(0, 1)))
        c = np.tensordot(energy[a:b, l:r], d[a:b, l:r], axes=2)
        if centre or np.linalg.norm(c) <= 1e-12:
            c = d[(a + b) // 2, (l + r) // 2]
        toward.append(c / np.linalg.norm(c))
    return np.array(toward), np.array(power)


def right_dominant_lights_list(env, count):
    return _cut(env, count)


def right_dominant_lights_float32(env, count):
    return [np.float32(a).tolist() for a in _cut(env, count)]


def right_dominant_lights_without_narrowing(env, count):
    return _cut(env, count, narrow=False)


def wrong_dominant_lights_by_area(env, count):
    """Regions of equal size."""
    return _cut(env, count, even=False, unequal=True)


def wrong_dominant_lights_middle_of_the_region(env, count):
    return _cut(env, count, centre=True)


def wrong_dominant_lights_no_solid_angle(env, count):
    return _cut(env, count, flat=True)


def wrong_dominant_lights_red(env, count):
    return _cut(env, count, weights=(1.0, 0.0, 0.0))


def wrong_dominant_lights_brightest_pixels(env, count):
    """The brightest pixels, scaled to the total."""
    light = (env.pixels * env.solid_angles()[..., None]).reshape(-1, 3)
    best = np.argsort(-(light @ LUMINANCE), kind="stable")[:count]
    total = light[best].sum(axis=0)
    scale = light.sum(axis=0) / np.where(total > 0, total, 1)
    return env.directions().reshape(-1, 3)[best], light[best] * scale


def wrong_dominant_lights_mean_radiance(env, count):
    toward, power = _cut(env, count)
    return toward, power / (4 * np.pi / count)


def wrong_dominant_lights_grey(env, count):
    toward, power = _cut(env, count)
    return toward, np.repeat((power @ LUMINANCE)[:, None], 3, axis=1)


def wrong_dominant_lights_not_unit(env, count):
    toward, power = _cut(env, count)
    return toward * 0.9, power


# 5.2 --------------------------------------------------------------------------------------------------------------
def _ambient(sdf, p, normal, t_max, cones=16, uniform=False, up=False, hard=False, turn=0.0, smooth=False):
    shape = p.shape[:-1]
    if not len(p):
        return np.zeros(0)
    i = np.arange(cones)
    u = (i + 0.5) / cones
    radius, phi = np.sqrt(1 - (1 - u) ** 2) if uniform else np.sqrt(u), turn + i * np.pi * (3 - np.sqrt(5))
    z = np.sqrt(1 - radius**2)
    local = np.stack([radius * np.cos(phi), radius * np.sin(phi), z], axis=-1)
    if up:
        normal = np.broadcast_to([0.0, 1.0, 0.0], normal.shape)
    frame = np.stack([*fw.orthonormal_frame(normal), normal], axis=1)
    d = np.einsum("ci,nij->ncj", local, frame).reshape(-1, 3)
    width = np.minimum(np.sqrt(2 / cones) if uniform else np.sqrt(1 / (cones * z)), np.arcsin(z))
    origin, width = np.repeat(p, cones, axis=0), np.tile(width, len(p))
    t, nearest, on = np.full(len(d), 0.005 * t_max), np.full(len(d), 9.0), np.ones(len(d), bool)
    if hard:
        t = np.full(len(d), 0.02)
    for _ in range(64):
        k = np.flatnonzero(on)
        if not len(k):
            break
        distance = sdf(origin[k] + t[k, None] * d[k])
        if hard:
            nearest[k] = np.where(distance < 2e-3, -9.0, nearest[k])
            t[k] += np.maximum(distance, 0)
        else:
            nearest[k] = np.minimum(nearest[k], np.arcsin(np.clip(distance / t[k], -1, 1)) / width[k])
            t[k] += np.maximum(np.abs(distance), 0.2 * width[k] * t[k])
        on[k] = (nearest[k] > -1) & (t[k] <= t_max)
    x = np.clip(nearest, -1, 1)
    share = (x + 1) ** 2 * (2 - x) / 4 if smooth else 0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi
    return share.reshape(*shape, cones).mean(axis=-1)


def right_ambient_visibility_eight_cones(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, t_max, 8)


def right_ambient_visibility_six_cones(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, t_max, 6)


def right_ambient_visibility_turned(sdf, p, normal, t_max):
    return np.float32(_ambient(sdf, p, normal, t_max, 12, turn=1.0))


def right_ambient_visibility_smooth(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, t_max, 16, smooth=True)


def right_ambient_visibility_rays(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, t_max, 96, hard=True)


def right_ambient_visibility_loop(sdf, p, normal, t_max):
    one = [
        reference.ambient_visibility(sdf, p[i : i + 1], normal[i : i + 1], t_max)[0] for i in range(len(p))
    ]
    return np.reshape(one, len(p))


def wrong_ambient_visibility_uniform(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, t_max, uniform=True)


def wrong_ambient_visibility_no_normal(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, t_max, up=True)


def wrong_ambient_visibility_no_t_max(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, 20.0)


def wrong_ambient_visibility_occlusion(sdf, p, normal, t_max):
    return 1 - _ambient(sdf, p, normal, t_max)


def wrong_ambient_visibility_one_cone(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, t_max, 1)


def wrong_ambient_visibility_along_the_normal(sdf, p, normal, t_max):
    """The old trick: distances at five steps along the normal."""
    t = np.linspace(0.1, 1, 5) * 0.25 * t_max
    missing = sum((s - sdf(p + s * normal)) / 2**i for i, s in enumerate(t))
    return np.clip(1 - missing / t_max, 0, 1)


def wrong_ambient_visibility_squared(sdf, p, normal, t_max):
    return _ambient(sdf, p, normal, t_max) ** 2


# 5.3 --------------------------------------------------------------------------------------------------------------
def _shade(light, sdf, p, normal, view, r0, roughness, albedo, t_max, matt=True, gloss=True):
    """The reference, with an albedo of 0 or a view from below to take one of its parts."""
    shade, zero = reference.shade_with_shadows, np.zeros((len(p), 3))
    a = shade(light, sdf, p, normal, -normal, r0, roughness, albedo, t_max) if matt else zero
    b = shade(light, sdf, p, normal, view, r0, roughness, 0.0, t_max) if gloss else zero
    return a + b


def _free(p):
    return np.full(p.shape[:-1], 100.0)


def _lamps(light, sdf, p, normal, albedo, t_max, count, ratio=True, hard=True):
    """The matt part by hard shadow rays to lamps."""
    toward, power = reference.dominant_lights(light.env, count)
    cosine = np.maximum(normal @ toward.T, 0)
    free = cosine.copy()
    for j, d in enumerate(toward):
        lit = np.flatnonzero(cosine[:, j] > 0)
        t, on = np.full(len(lit), 0.02), np.ones(len(lit), bool)
        for _ in range(64):
            k = np.flatnonzero(on)
            if not len(k):
                break
            distance = sdf(p[lit[k]] + t[k, None] * d)
            free[lit[k[distance < 2e-3]], j] = 0
            t[k] += np.maximum(distance, 2e-3)
            on[k] = (distance >= 2e-3) & (t[k] <= t_max)
    if not ratio:
        return albedo * (free @ power) / np.pi
    return albedo * light.irradiance(normal) * (free @ power) / np.maximum(cosine @ power, 1e-12)


def right_shade_with_shadows_in_two_parts(*a):
    """Each part for itself, in a loop over points."""
    light, sdf, p, normal, view, r0, roughness, albedo, t_max = a
    r0, albedo = (np.broadcast_to(v, p.shape) for v in (r0, albedo))
    roughness = np.broadcast_to(roughness, len(p))
    rows = [
        reference.shade_with_shadows(
            light, sdf, *(v[i : i + 1] for v in (p, normal, view, r0, roughness, albedo)), t_max
        )[0]
        for i in range(len(p))
    ]
    return np.reshape(rows, (len(p), 3)).tolist() if len(p) else np.zeros((0, 3))


def right_shade_with_shadows_float32(*a):
    return np.float32(reference.shade_with_shadows(*a))


def costly_shade_with_shadows_many_lamps(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    a = (light, sdf, p, normal, view, r0, roughness, albedo, t_max)
    count = min(256, light.env.pixels[..., 0].size)
    return _shade(*a, matt=False) + _lamps(light, sdf, p, normal, albedo, t_max, count)


def costly_shade_with_shadows_lamps_alone(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    a = (light, sdf, p, normal, view, r0, roughness, albedo, t_max)
    count = min(128, light.env.pixels[..., 0].size)
    return _shade(*a, matt=False) + _lamps(light, sdf, p, normal, albedo, t_max, count, ratio=False)


def wrong_shade_with_shadows_none(light, sdf, *rest):
    return _shade(light, _free, *rest)


def wrong_shade_with_shadows_only_on_the_matt_part(light, sdf, *rest):
    return _shade(light, sdf, *rest, gloss=False) + _shade(light, _free, *rest, matt=False)


def wrong_shade_with_shadows_only_on_the_glossy_part(light, sdf, *rest):
    return _shade(light, sdf, *rest, matt=False) + _shade(light, _free, *rest, gloss=False)


def wrong_shade_with_shadows_ambient(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Everything times the ambient visibility."""
    everything = _shade(light, _free, p, normal, view, r0, roughness, albedo, t_max)
    return everything * reference.ambient_visibility(sdf, p, normal, t_max)[:, None]


def wrong_shade_with_shadows_divided_by_pi_twice(light, sdf, *rest):
    return _shade(light, sdf, *rest, gloss=False) / np.pi + _shade(light, sdf, *rest, matt=False)


def wrong_shade_with_shadows_one_lamp(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    a = (light, sdf, p, normal, view, r0, roughness, albedo, t_max)
    return _shade(*a, matt=False) + _lamps(light, sdf, p, normal, albedo, t_max, 1)


def wrong_shade_with_shadows_alpha_for_roughness(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    return _shade(light, sdf, p, normal, view, r0, np.square(roughness), albedo, t_max)


def wrong_shade_with_shadows_energy_conserving(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """1 - F on the matt part."""
    facing = np.clip(np.sum(normal * view, axis=1), 0, 1)[:, None]
    fresnel = r0 + (1 - np.asarray(r0)) * (1 - facing) ** 5
    return _shade(light, sdf, p, normal, view, r0, roughness, albedo * (1 - fresnel), t_max)


def wrong_shade_with_shadows_from_behind(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Mirrors seen from behind shine."""
    flip = np.where(np.sum(normal * view, axis=1, keepdims=True) < 0, -1.0, 1.0)
    return _shade(light, sdf, p, normal, flip * view, r0, roughness, albedo, t_max)
