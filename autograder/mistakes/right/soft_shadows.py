"""Right answers to tasks 2.1 to 2.5, each in another way, named `FUNCTION_way`."""

import math

import numpy as np

from autograder.mistakes import costly


# 2.1 --------------------------------------------------------------------------------------------------------------
def _angle(distance, travelled):
    if distance <= 0:
        return 0.0
    return math.pi / 2 if distance >= travelled else math.asin(distance / travelled)


def safe_angle_loop(distance, travelled):
    """A Python loop, returned as nested lists."""
    d, t = np.broadcast_arrays(distance, travelled)
    return np.reshape([_angle(a, b) for a, b in zip(d.flat, t.flat, strict=True)], d.shape).tolist()


def safe_angle_float32(distance, travelled):
    """Computed in float32."""
    d, t = np.broadcast_arrays(np.float32(distance), np.float32(travelled))
    ratio = np.where(d >= t, np.float32(1), d / np.where((d >= t) | (t <= 0), np.float32(1), t))
    return np.arcsin(np.where(d <= 0, np.float32(0), np.clip(ratio, 0, 1)))


def safe_angle_tangent(distance, travelled):
    """The angle from both sides of the triangle."""
    d, t = np.maximum(distance, 0.0), np.maximum(travelled, 0.0)
    wide = np.arctan2(d, np.sqrt(np.maximum(t * t - d * d, 0)))
    return np.where(d > 0, wide, 0.0)


def safe_angle_clipped(distance, travelled):
    """A clipped quotient with a floor under the divisor."""
    return np.arcsin(np.clip(distance / np.maximum(travelled, 1e-12), 0, 1))


# 2.2 --------------------------------------------------------------------------------------------------------------
def penumbra_loop(distance, travelled, k):
    """A Python loop, returned as nested lists."""
    d, t = np.broadcast_arrays(distance, travelled)
    values = [
        0.0 if a <= 0 else 1.0 if b <= 0 else min(k * a / b, 1.0) for a, b in zip(d.flat, t.flat, strict=True)
    ]
    return np.reshape(values, d.shape).tolist()


def penumbra_float32(distance, travelled, k):
    """Computed in float32."""
    d, t = np.broadcast_arrays(np.float32(distance), np.float32(travelled))
    ratio = np.float32(k) * d / np.where(t <= 0, np.float32(1), t)
    return np.where(d <= 0, np.float32(0), np.where(t <= 0, np.float32(1), np.minimum(ratio, 1)))


def penumbra_clipped(distance, travelled, k):
    """A clipped quotient with a floor under the divisor."""
    return np.clip(k * np.asarray(distance) / np.maximum(travelled, 1e-12), 0, 1)


def penumbra_as_a_hat(distance, travelled, k):
    """The shorter one of two lengths, over the longer."""
    reach = k * np.maximum(distance, 0.0)
    return np.minimum(reach, np.maximum(travelled, 0)) / np.maximum(np.maximum(travelled, 0), 1e-300) + (
        (reach > 0) & (np.asarray(travelled) <= 0)
    )


# 2.3 --------------------------------------------------------------------------------------------------------------
def needs_shadow_ray_loop(normal, to_light):
    """A Python loop, a list of bools."""
    lights = np.broadcast_to(to_light, np.shape(normal))
    return [sum(a * b for a, b in zip(n, l, strict=True)) > 0 for n, l in zip(normal, lights, strict=True)]


def needs_shadow_ray_einsum(normal, to_light):
    """With einsum, as 0.0 and 1.0."""
    return 1.0 * (np.einsum("...i,...i", normal, np.broadcast_to(to_light, normal.shape)) > 0)


def needs_shadow_ray_float32(normal, to_light):
    """In float32."""
    return (np.float32(normal) * np.float32(to_light)).sum(axis=-1) > 0


def needs_shadow_ray_not_below(normal, to_light):
    """By exclusion."""
    return ~(np.sum(normal * to_light, axis=-1) <= 0)


# 2.4 --------------------------------------------------------------------------------------------------------------
def march(
    sdf, origin, to_light, t_min, t_max, max_steps, estimate, step=lambda h, t: h, near=1e-4, dtype=float
):
    """The smallest `estimate(distance, travelled)` along each ray; 0 where one comes nearer than `near`."""
    origin = np.asarray(origin, dtype)
    light = np.broadcast_to(np.asarray(to_light, dtype), origin.shape)
    seen, t = np.ones(len(origin), dtype), np.full(len(origin), t_min, dtype)
    rays = np.flatnonzero(t <= t_max)
    for _ in range(max_steps):
        if not rays.size:
            break
        here = t[rays]
        h = np.asarray(sdf(origin[rays] + here[:, None] * light[rays]), dtype)
        blocked = h < near
        seen[rays] = np.minimum(seen[rays], np.where(blocked, 0, np.clip(estimate(h, here), 0, 1)))
        t[rays] = here + step(h, here)
        rays = rays[~blocked & (t[rays] <= t_max)]
    return seen


def ratio(k):
    return lambda h, t: k * h / t


def soft_shadow_loop(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """One ray after the other, a list."""
    lights, out = np.broadcast_to(to_light, np.shape(origin)), []
    for o, light in zip(origin, lights, strict=True):
        seen, t = 1.0, t_min
        for _ in range(max_steps):
            if t > t_max:
                break
            h = sdf((o + t * light)[None])[0]
            if h < 1e-4:
                seen = 0.0
                break
            seen = min(seen, k * h / t)
            t += h
        out.append(seen)
    return out


def soft_shadow_float32(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """The march in float32."""
    return march(sdf, origin, to_light, t_min, t_max, max_steps, ratio(np.float32(k)), dtype=np.float32)


def soft_shadow_cautious(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps of nine tenths of the distance."""
    return march(sdf, origin, to_light, t_min, t_max, max_steps, ratio(k), lambda h, t: 0.9 * h)


def soft_shadow_relaxed(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps a fifth longer than the distance."""
    return march(sdf, origin, to_light, t_min, t_max, max_steps, ratio(k), lambda h, t: 1.2 * h)


def soft_shadow_least_step(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps of at least a hundredth."""
    return march(sdf, origin, to_light, t_min, t_max, max_steps, ratio(k), lambda h, t: np.maximum(h, 0.01))


@costly
def soft_shadow_clamped(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps from 0.02 to 0.2, against bands."""
    return march(sdf, origin, to_light, t_min, t_max, max_steps, ratio(k), lambda h, t: np.clip(h, 0.02, 0.2))


@costly
def soft_shadow_clamped_less(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps from 0.01 to 0.3."""
    return march(sdf, origin, to_light, t_min, t_max, max_steps, ratio(k), lambda h, t: np.clip(h, 0.01, 0.3))


@costly
def soft_shadow_all_rays(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """All rays are evaluated as long as one of them marches."""
    seen, t = np.ones(len(origin)), np.full(len(origin), t_min)
    done = t > t_max
    for _ in range(max_steps):
        if done.all():
            break
        h = sdf(origin + t[:, None] * to_light)
        seen = np.where(done, seen, np.where(h < 1e-4, 0, np.minimum(seen, k * h / t)))
        done |= h < 1e-4
        t = np.where(done, t, t + h)
        done |= t > t_max
    return seen


# 2.5 --------------------------------------------------------------------------------------------------------------
def segment(x):
    return 0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi


def quarter(radius):
    return lambda h, t: np.maximum(np.abs(h), 0.25 * radius * t)


def _sine(h, t):
    return np.clip(h / t, -1, 1)


def _arcsine(h, t):
    return np.arcsin(_sine(h, t))


def through(
    sdf, origin, to_light, radius, t_min, t_max, max_steps, step, shade=segment, angle=_arcsine, dtype=float
):
    """The smallest signed angle, in radii of the light, of a march that goes on inside; what `shade` makes of it."""
    origin = np.asarray(origin, dtype)
    light = np.broadcast_to(np.asarray(to_light, dtype), origin.shape)
    x, t = np.ones(len(origin), dtype), np.full(len(origin), t_min, dtype)
    rays = np.flatnonzero(t <= t_max)
    for _ in range(max_steps):
        if not rays.size:
            break
        here = t[rays]
        h = np.asarray(sdf(origin[rays] + here[:, None] * light[rays]), dtype)
        x[rays] = np.minimum(x[rays], angle(h, here) / dtype(radius))
        t[rays] = here + step(h, here)
        rays = rays[(x[rays] > -1) & (t[rays] <= t_max)]
    return shade(np.clip(x, -1, 1))


def area_light_shadow_loop(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """One ray after the other, a list."""
    lights, out = np.broadcast_to(to_light, np.shape(origin)), []
    for o, light in zip(origin, lights, strict=True):
        x, t = 1.0, t_min
        for _ in range(max_steps):
            if t > t_max or x <= -1:
                break
            h = sdf((o + t * light)[None])[0]
            x = min(x, math.asin(max(-1.0, min(1.0, h / t))) / angular_radius)
            t += max(abs(h), 0.25 * angular_radius * t)
        x = max(x, -1.0)
        out.append(0.5 + (x * math.sqrt(1 - x * x) + math.asin(x)) / math.pi)
    return out


def area_light_shadow_float32(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The march in float32."""
    step = quarter(np.float32(angular_radius))
    return through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, dtype=np.float32)


def area_light_shadow_fine(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Smaller least steps."""
    step = lambda h, t: np.maximum(np.abs(h), 0.1 * angular_radius * t)  # noqa: E731
    return through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step)


def area_light_shadow_clamped(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Steps from 0.01 to a half."""
    step = lambda h, t: np.clip(np.abs(h), 0.01, 0.5)  # noqa: E731
    return through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step)


def area_light_shadow_sine(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Sines compared instead of angles."""
    radius = np.sin(angular_radius)
    step = quarter(radius)
    return through(sdf, origin, to_light, radius, t_min, t_max, max_steps, step, angle=_sine)
