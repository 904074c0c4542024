"""Right answers to tasks 5.1 to 5.3, each in another way, named `FUNCTION_way`."""

import numpy as np

import framework as fw
from autograder.mistakes import costly
from autograder.mistakes.right.split_sum import look_up
from solutions import environment_shadows as reference

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


# 5.1 --------------------------------------------------------------------------------------------------------------
def cut(env, count, weights=LUMINANCE, even=True, centre=False, flat=False, unequal=False, narrow=True):
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


def dominant_lights_list(env, count):
    return cut(env, count)


def dominant_lights_float32(env, count):
    return [np.float32(a).tolist() for a in cut(env, count)]


def dominant_lights_without_narrowing(env, count):
    return cut(env, count, narrow=False)


# 5.2 --------------------------------------------------------------------------------------------------------------
def cone(sdf, origin, direction, width, t_max, smooth=False, least=0.2):
    """The visible part of cones of a half angle, from the smallest signed angle along their axes."""
    t, nearest, on = (
        np.full(len(origin), 0.005 * t_max),
        np.full(len(origin), 9.0),
        np.ones(len(origin), bool),
    )
    for _ in range(64):
        k = np.flatnonzero(on)
        if not len(k):
            break
        distance = sdf(origin[k] + t[k, None] * direction[k])
        nearest[k] = np.minimum(nearest[k], np.arcsin(np.clip(distance / t[k], -1, 1)) / width[k])
        t[k] += np.maximum(np.abs(distance), least * width[k] * t[k])
        on[k] = (nearest[k] > -1) & (t[k] <= t_max)
    x = np.clip(nearest, -1, 1)
    return (x + 1) ** 2 * (2 - x) / 4 if smooth else 0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi


def ray(sdf, origin, direction, t_max):
    """1 where a ray meets nothing, 0 elsewhere."""
    t, free, on = np.full(len(origin), 0.02), np.ones(len(origin)), np.ones(len(origin), bool)
    for _ in range(64):
        k = np.flatnonzero(on)
        if not len(k):
            break
        distance = sdf(origin[k] + t[k, None] * direction[k])
        free[k[distance < 2e-3]] = 0
        t[k] += np.maximum(distance, 2e-3)
        on[k] = (distance >= 2e-3) & (t[k] <= t_max)
    return free


def ambient(sdf, p, normal, t_max, cones=16, uniform=False, up=False, hard=False, turn=0.0, smooth=False):
    """Cones, or hard rays, evenly by cosine; each switch is one choice, or one mistake."""
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
    share = ray(sdf, origin, d, t_max) if hard else cone(sdf, origin, d, width, t_max, smooth)
    return share.reshape(len(p), cones).mean(axis=-1)


def ambient_visibility_eight_cones(sdf, p, normal, t_max):
    return ambient(sdf, p, normal, t_max, 8)


def ambient_visibility_six_cones(sdf, p, normal, t_max):
    return ambient(sdf, p, normal, t_max, 6)


def ambient_visibility_turned(sdf, p, normal, t_max):
    return np.float32(ambient(sdf, p, normal, t_max, 12, turn=1.0))


def ambient_visibility_smooth(sdf, p, normal, t_max):
    return ambient(sdf, p, normal, t_max, 16, smooth=True)


def ambient_visibility_rays(sdf, p, normal, t_max):
    return ambient(sdf, p, normal, t_max, 96, hard=True)


def ambient_visibility_loop(sdf, p, normal, t_max):
    one = [
        reference.ambient_visibility(sdf, p[i : i + 1], normal[i : i + 1], t_max)[0] for i in range(len(p))
    ]
    return np.reshape(one, len(p))


# 5.3 --------------------------------------------------------------------------------------------------------------
def shade_parts(light, sdf, p, normal, view, r0, roughness, albedo, t_max, matt=True, gloss=True):
    """The reference, with an albedo of 0 or a view from below to take one of its parts."""
    shade, zero = reference.shade_with_shadows, np.zeros((len(p), 3))
    a = shade(light, sdf, p, normal, -normal, r0, roughness, albedo, t_max) if matt else zero
    b = shade(light, sdf, p, normal, view, r0, roughness, 0.0, t_max) if gloss else zero
    return a + b


def lamps(light, sdf, p, normal, albedo, t_max, count, ratio=True):
    """The matt part by hard shadow rays to lamps; as a part of the irradiance, or by the lamps' own powers."""
    toward, power = reference.dominant_lights(light.env, count)
    cosine = np.maximum(normal @ toward.T, 0)
    point, lamp = np.nonzero(cosine > 0)
    free = cosine.copy()
    free[point, lamp] *= ray(sdf, p[point], toward[lamp], t_max)
    if not ratio:
        return albedo * (free @ power) / np.pi
    return albedo * light.irradiance(normal) * (free @ power) / np.maximum(cosine @ power, 1e-12)


def shade_with_shadows_in_two_parts(*a):
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


def shade_with_shadows_float32(*a):
    return np.float32(reference.shade_with_shadows(*a))


def shade_with_shadows_smooth_lights(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    """Lights that fade in smoothly, each as large as its share of the sky and no larger, met in longer steps."""
    toward, power = cut(light.env, 16)
    area = (power @ LUMINANCE) / np.maximum(light.env.radiance(toward) @ LUMINANCE, 1e-9)
    cosine = np.clip(normal @ toward.T, 0, 1)
    point, lamp = np.nonzero(cosine > 0.02)
    width = np.minimum(np.sqrt(np.clip(area, 0.01, 1.2) / np.pi)[lamp], np.arcsin(cosine[point, lamp]))
    reaching = cosine.copy()
    reaching[point, lamp] *= cone(sdf, p[point], toward[lamp], width, t_max, smooth=True, least=0.5)
    matt = albedo * light.irradiance(normal) * (reaching @ power) / np.maximum(cosine @ power, 1e-12)
    facing = np.sum(normal * view, axis=-1)
    mirror = 2 * facing[:, None] * normal - view
    lobe = np.minimum(3 * np.arctan(np.square(roughness)), np.arcsin(np.clip(facing, 1e-3, 1)))
    scale, bias = np.moveaxis(look_up(light.lut, np.clip(facing, 0, 1), roughness), -1, 0)[..., None]
    gloss = light.prefiltered(mirror, np.broadcast_to(roughness, len(p))) * (r0 * scale + bias)
    gloss = gloss * cone(sdf, p, mirror, lobe, t_max, smooth=True)[:, None]
    return matt + np.where(facing[:, None] > 0, gloss, 0)


@costly
def shade_with_shadows_many_lamps(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    a = (light, sdf, p, normal, view, r0, roughness, albedo, t_max)
    count = min(256, light.env.pixels[..., 0].size)
    return shade_parts(*a, matt=False) + lamps(light, sdf, p, normal, albedo, t_max, count)


@costly
def shade_with_shadows_lamps_alone(light, sdf, p, normal, view, r0, roughness, albedo, t_max):
    a = (light, sdf, p, normal, view, r0, roughness, albedo, t_max)
    count = min(128, light.env.pixels[..., 0].size)
    return shade_parts(*a, matt=False) + lamps(light, sdf, p, normal, albedo, t_max, count, ratio=False)
