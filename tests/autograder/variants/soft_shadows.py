"""Right and wrong versions of tasks 2.1 to 2.5, named `right_FUNCTION_what` and `wrong_FUNCTION_what`."""

import math

import numpy as np


# 2.1 --------------------------------------------------------------------------------------------------------------
def _angle(distance, travelled):
    if distance <= 0:
        return 0.0
    return math.pi / 2 if distance >= travelled else math.asin(distance / travelled)


def right_safe_angle_loop(distance, travelled):
    """A Python loop, returned as nested lists."""
    d, t = np.broadcast_arrays(distance, travelled)
    return np.reshape([_angle(a, b) for a, b in zip(d.flat, t.flat, strict=True)], d.shape).tolist()


def right_safe_angle_float32(distance, travelled):
    """Computed in float32."""
    d, t = np.broadcast_arrays(np.float32(distance), np.float32(travelled))
    ratio = np.where(d >= t, np.float32(1), d / np.where((d >= t) | (t <= 0), np.float32(1), t))
    return np.arcsin(np.where(d <= 0, np.float32(0), np.clip(ratio, 0, 1)))


def right_safe_angle_tangent(distance, travelled):
    """The angle from both sides of the triangle."""
    d, t = np.maximum(distance, 0.0), np.maximum(travelled, 0.0)
    wide = np.arctan2(d, np.sqrt(np.maximum(t * t - d * d, 0)))
    return np.where(d > 0, wide, 0.0)


def right_safe_angle_clipped(distance, travelled):
    """A clipped quotient with a floor under the divisor."""
    return np.arcsin(np.clip(distance / np.maximum(travelled, 1e-12), 0, 1))


def wrong_safe_angle_ratio(distance, travelled):
    """No arcsine."""
    return np.clip(distance / np.maximum(travelled, 1e-12), 0, 1)


def wrong_safe_angle_degrees(distance, travelled):
    """In degrees."""
    return np.degrees(right_safe_angle_clipped(distance, travelled))


def wrong_safe_angle_arctan(distance, travelled):
    """The tangent taken for the sine."""
    return np.where(np.asarray(distance) > 0, np.arctan2(distance, np.maximum(travelled, 0)), 0.0)


def wrong_safe_angle_not_a_number(distance, travelled):
    """Nothing is done about the ends of the domain."""
    return np.arcsin(distance / np.asarray(travelled))


def wrong_safe_angle_nan_to_zero(distance, travelled):
    """What cannot be computed is taken for 0."""
    return np.nan_to_num(np.clip(np.arcsin(distance / np.asarray(travelled)), 0, None))


def wrong_safe_angle_signed(distance, travelled):
    """Negative inside."""
    return np.arcsin(np.clip(distance / np.maximum(travelled, 1e-12), -1, 1))


def wrong_safe_angle_absolute(distance, travelled):
    """The sign of the distance is lost."""
    return right_safe_angle_clipped(np.abs(distance), travelled)


def wrong_safe_angle_full_cone(distance, travelled):
    """The whole opening of the cone."""
    return 2 * right_safe_angle_clipped(distance, travelled)


def wrong_safe_angle_start_blocked(distance, travelled):
    """0 at the start of the ray."""
    return np.where(np.asarray(travelled) > 0, right_safe_angle_clipped(distance, travelled), 0.0)


def wrong_safe_angle_epsilon(distance, travelled):
    """A floor under the divisor that small scenes notice."""
    return np.arcsin(np.clip(distance / np.maximum(travelled, 1e-2), 0, 1))


def wrong_safe_angle_one_shape(distance, travelled):
    """Arrays of one shape are taken for granted."""
    out = np.zeros_like(distance)
    outside = distance > 0
    out[outside] = np.arcsin(np.clip(distance[outside] / np.maximum(travelled[outside], 1e-12), 0, 1))
    return out


# 2.2 --------------------------------------------------------------------------------------------------------------
def right_penumbra_loop(distance, travelled, k):
    """A Python loop, returned as nested lists."""
    d, t = np.broadcast_arrays(distance, travelled)
    values = [
        0.0 if a <= 0 else 1.0 if b <= 0 else min(k * a / b, 1.0) for a, b in zip(d.flat, t.flat, strict=True)
    ]
    return np.reshape(values, d.shape).tolist()


def right_penumbra_float32(distance, travelled, k):
    """Computed in float32."""
    d, t = np.broadcast_arrays(np.float32(distance), np.float32(travelled))
    ratio = np.float32(k) * d / np.where(t <= 0, np.float32(1), t)
    return np.where(d <= 0, np.float32(0), np.where(t <= 0, np.float32(1), np.minimum(ratio, 1)))


def right_penumbra_clipped(distance, travelled, k):
    """A clipped quotient with a floor under the divisor."""
    return np.clip(k * np.asarray(distance) / np.maximum(travelled, 1e-12), 0, 1)


def right_penumbra_as_a_hat(distance, travelled, k):
    """The shorter one of two lengths, over the longer."""
    reach = k * np.maximum(distance, 0.0)
    return np.minimum(reach, np.maximum(travelled, 0)) / np.maximum(np.maximum(travelled, 0), 1e-300) + (
        (reach > 0) & (np.asarray(travelled) <= 0)
    )


def wrong_penumbra_not_divided(distance, travelled, k):
    """Not divided by the way travelled."""
    return np.clip(k * np.asarray(distance) + 0 * np.asarray(travelled), 0, 1)


def wrong_penumbra_not_clamped(distance, travelled, k):
    """Brighter than 1."""
    return np.maximum(k * np.asarray(distance) / np.maximum(travelled, 1e-12), 0)


def wrong_penumbra_negative(distance, travelled, k):
    """Darker than 0."""
    return np.minimum(k * np.asarray(distance) / np.maximum(travelled, 1e-12), 1)


def wrong_penumbra_k_is_softness(distance, travelled, k):
    """Divided by k."""
    return np.clip(np.asarray(distance) / (k * np.maximum(travelled, 1e-12)), 0, 1)


def wrong_penumbra_of_the_angle(distance, travelled, k):
    """k times the angle."""
    return np.minimum(k * right_safe_angle_clipped(distance, travelled), 1)


def wrong_penumbra_of_both_angles(distance, travelled, k):
    """The angle over the light's own."""
    return np.minimum(right_safe_angle_clipped(distance, travelled) / np.arcsin(1 / k), 1)


def wrong_penumbra_smoothstep(distance, travelled, k):
    """With a smooth start and end."""
    v = right_penumbra_clipped(distance, travelled, k)
    return v * v * (3 - 2 * v)


def wrong_penumbra_without_k(distance, travelled, k):
    """k is forgotten."""
    return np.clip(np.asarray(distance) / np.maximum(travelled, 1e-12), 0, 1)


def wrong_penumbra_not_a_number(distance, travelled, k):
    """Nothing is done about a way of 0."""
    return np.clip(k * np.asarray(distance) / np.asarray(travelled), 0, 1)


def wrong_penumbra_start_blocked(distance, travelled, k):
    """0 at the start of the ray."""
    return np.where(np.asarray(travelled) > 0, right_penumbra_clipped(distance, travelled, k), 0.0)


# 2.3 --------------------------------------------------------------------------------------------------------------
def right_needs_shadow_ray_loop(normal, to_light):
    """A Python loop, a list of bools."""
    lights = np.broadcast_to(to_light, np.shape(normal))
    return [sum(a * b for a, b in zip(n, l, strict=True)) > 0 for n, l in zip(normal, lights, strict=True)]


def right_needs_shadow_ray_einsum(normal, to_light):
    """With einsum, as 0.0 and 1.0."""
    return 1.0 * (np.einsum("...i,...i", normal, np.broadcast_to(to_light, normal.shape)) > 0)


def right_needs_shadow_ray_float32(normal, to_light):
    """In float32."""
    return (np.float32(normal) * np.float32(to_light)).sum(axis=-1) > 0


def right_needs_shadow_ray_not_below(normal, to_light):
    """By exclusion."""
    return ~(np.sum(normal * to_light, axis=-1) <= 0)


def wrong_needs_shadow_ray_at_the_horizon(normal, to_light):
    """The horizon counts as lit."""
    return np.sum(normal * to_light, axis=-1) >= 0


def wrong_needs_shadow_ray_away(normal, to_light):
    """The light's direction is taken the other way."""
    return np.sum(normal * to_light, axis=-1) < 0


def wrong_needs_shadow_ray_cosine(normal, to_light):
    """The cosine instead of the decision."""
    return np.sum(normal * to_light, axis=-1)


def wrong_needs_shadow_ray_both_sides(normal, to_light):
    """Light from behind counts."""
    return np.sum(normal * to_light, axis=-1) != 0


def wrong_needs_shadow_ray_margin(normal, to_light):
    """Only where the light is well above the horizon."""
    return np.sum(normal * to_light, axis=-1) > 1e-3


def wrong_needs_shadow_ray_height(normal, to_light):
    """Whether the light is above the ground."""
    return np.broadcast_to(to_light, np.shape(normal))[..., 1] > 0


def wrong_needs_shadow_ray_every_component(normal, to_light):
    """Each product must be positive, not their sum."""
    return np.all(normal * to_light > 0, axis=-1)


def wrong_needs_shadow_ray_one_light(normal, to_light):
    """All points get the first point's light."""
    return np.sum(normal * np.reshape(to_light, (-1, 3))[:1], axis=-1) > 0


def wrong_needs_shadow_ray_light_each(normal, to_light):
    """A light for each point is taken for granted."""
    return np.array([np.dot(n, to_light[i]) > 0 for i, n in enumerate(normal)], dtype=float)


def wrong_needs_shadow_ray_always(normal, to_light):
    """Every point sends a ray."""
    return np.ones(len(normal), dtype=bool)


# 2.4 --------------------------------------------------------------------------------------------------------------
def _march(
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


def _ratio(k):
    return lambda h, t: k * h / t


def right_soft_shadow_loop(sdf, origin, to_light, k, t_min, t_max, max_steps):
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


def right_soft_shadow_float32(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """The march in float32."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(np.float32(k)), dtype=np.float32)


def right_soft_shadow_cautious(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps of nine tenths of the distance."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k), lambda h, t: 0.9 * h)


def right_soft_shadow_relaxed(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps a fifth longer than the distance."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k), lambda h, t: 1.2 * h)


def right_soft_shadow_least_step(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps of at least a hundredth."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k), lambda h, t: np.maximum(h, 0.01))


def costly_soft_shadow_clamped(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps from 0.02 to 0.2, against bands."""
    return _march(
        sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k), lambda h, t: np.clip(h, 0.02, 0.2)
    )


def costly_soft_shadow_clamped_less(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps from 0.01 to 0.3."""
    return _march(
        sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k), lambda h, t: np.clip(h, 0.01, 0.3)
    )


def costly_soft_shadow_all_rays(sdf, origin, to_light, k, t_min, t_max, max_steps):
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


def wrong_soft_shadow_not_divided(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """k times the distance."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, lambda h, t: k * h)


def wrong_soft_shadow_largest(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """The largest penumbra instead of the smallest."""
    best = np.zeros(len(origin))

    def estimate(h, t):
        return np.ones_like(h)

    blocked = _march(sdf, origin, to_light, t_min, t_max, max_steps, estimate)
    for i, (o, light) in enumerate(zip(origin, np.broadcast_to(to_light, np.shape(origin)), strict=True)):
        h = sdf((o + t_min * light)[None])[0]
        best[i] = min(k * h / t_min, 1)
    return np.clip(best, 0, 1) * blocked


def wrong_soft_shadow_hard(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Lit or dark."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, lambda h, t: np.ones_like(h))


def wrong_soft_shadow_k_is_softness(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Divided by k."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, lambda h, t: h / (t * k))


def wrong_soft_shadow_from_zero(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Starts at the point itself."""
    return _march(
        sdf,
        origin,
        to_light,
        0.0,
        t_max,
        max_steps,
        lambda h, t: np.where(t > 0, k * h / np.maximum(t, 1e-9), 1),
    )


def wrong_soft_shadow_endless(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """What lies beyond the light still hides it."""
    return _march(sdf, origin, to_light, t_min, 100.0, max_steps, _ratio(k))


def wrong_soft_shadow_exhausted_is_dark(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """A ray out of steps is taken for blocked."""
    seen, t = np.ones(len(origin)), np.full(len(origin), t_min)
    for _ in range(max_steps):
        rays = np.flatnonzero((t <= t_max) & (seen > 0))
        if not rays.size:
            return seen
        light = np.broadcast_to(to_light, origin.shape)[rays]
        h = sdf(origin[rays] + t[rays, None] * light)
        seen[rays] = np.where(h < 1e-4, 0, np.minimum(seen[rays], k * h / t[rays]))
        t[rays] += h
    return np.where(t <= t_max, 0, seen)


def wrong_soft_shadow_half_k(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """The light's diameter taken for its radius."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k / 2))


def wrong_soft_shadow_smoothstep(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """With a smooth start and end."""
    v = _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k))
    return v * v * (3 - 2 * v)


def wrong_soft_shadow_square_root(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Encoded for the screen."""
    return np.sqrt(_march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k)))


def wrong_soft_shadow_double_steps(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps of twice the distance."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k), lambda h, t: 2 * h)


def wrong_soft_shadow_fixed_steps(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Steps of a fifth, whatever the distance is."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k), lambda h, t: 0.2)


def wrong_soft_shadow_coarse(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Blocked already at a hundredth."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(k), near=1e-2)


def wrong_soft_shadow_five_steps(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Few steps only."""
    return _march(sdf, origin, to_light, t_min, t_max, min(max_steps, 5), _ratio(k))


def wrong_soft_shadow_light_for_all(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """One light for all points is taken for granted."""
    return _march(sdf, origin, np.reshape(to_light, 3), t_min, t_max, max_steps, _ratio(k))


def wrong_soft_shadow_last_step(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Only the last visited point counts."""
    last = np.ones(len(origin))
    for i, (o, light) in enumerate(zip(origin, np.broadcast_to(to_light, np.shape(origin)), strict=True)):
        t = t_min
        for _ in range(max_steps):
            if t > t_max:
                break
            h = sdf((o + t * light)[None])[0]
            last[i] = min(max(k * h / t, 0), 1)
            if h < 1e-4:
                last[i] = 0
                break
            t += h
    return last


# 2.5 --------------------------------------------------------------------------------------------------------------
def _segment(x):
    return 0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi


def _smoothstep(x):
    return (1 + x) ** 2 * (2 - x) / 4


def _quarter(radius):
    return lambda h, t: np.maximum(np.abs(h), 0.25 * radius * t)


def _sine(h, t):
    return np.clip(h / t, -1, 1)


def _arcsine(h, t):
    return np.arcsin(_sine(h, t))


def _through(
    sdf, origin, to_light, radius, t_min, t_max, max_steps, step, shade=_segment, angle=_arcsine, dtype=float
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


def right_area_light_shadow_loop(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
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


def right_area_light_shadow_float32(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The march in float32."""
    step = _quarter(np.float32(angular_radius))
    return _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, dtype=np.float32)


def right_area_light_shadow_fine(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Smaller least steps."""
    step = lambda h, t: np.maximum(np.abs(h), 0.1 * angular_radius * t)  # noqa: E731
    return _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step)


def right_area_light_shadow_clamped(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Steps from 0.01 to a half."""
    step = lambda h, t: np.clip(np.abs(h), 0.01, 0.5)  # noqa: E731
    return _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step)


def right_area_light_shadow_sine(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Sines compared instead of angles."""
    radius = np.sin(angular_radius)
    step = _quarter(radius)
    return _through(sdf, origin, to_light, radius, t_min, t_max, max_steps, step, angle=_sine)


def near_area_light_shadow_smoothstep(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """A smoothstep instead of the segment of the disc."""
    step = _quarter(angular_radius)
    return _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, _smoothstep)


def near_area_light_shadow_linear(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """A straight line instead of the segment of the disc."""
    step = _quarter(angular_radius)
    return _through(
        sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, lambda x: 0.5 + 0.5 * x
    )


def half_area_light_shadow_unsigned(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The form of 2.4: the light is cut off at its centre."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, _ratio(1 / np.sin(angular_radius)))


def half_area_light_shadow_unsigned_through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Without the part below 0, of a march that goes on inside."""
    step = _quarter(angular_radius)
    return _through(
        sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, lambda x: np.maximum(x, 0)
    )


def wrong_area_light_shadow_hard(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Lit or dark."""
    return _march(sdf, origin, to_light, t_min, t_max, max_steps, lambda h, t: np.ones_like(h))


def wrong_area_light_shadow_absolute(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The sign of the distance is lost."""
    step = _quarter(angular_radius)
    return _through(lambda p: np.abs(sdf(p)), origin, to_light, angular_radius, t_min, t_max, max_steps, step)


def wrong_area_light_shadow_stops(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """No least step: the march stands still at the surface."""
    return _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, lambda h, t: np.abs(h))


def wrong_area_light_shadow_turns_back(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Steps by the signed distance: inside, it turns back."""
    return _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, lambda h, t: h)


def wrong_area_light_shadow_degrees(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The radius taken for degrees."""
    radius = np.radians(angular_radius)
    return _through(sdf, origin, to_light, radius, t_min, t_max, max_steps, _quarter(angular_radius))


def wrong_area_light_shadow_diameter(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """A light of twice the radius."""
    radius = 2 * angular_radius
    return _through(sdf, origin, to_light, radius, t_min, t_max, max_steps, _quarter(radius))


def wrong_area_light_shadow_half_radius(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """A light of half the radius."""
    radius = angular_radius / 2
    return _through(sdf, origin, to_light, radius, t_min, t_max, max_steps, _quarter(radius))


def wrong_area_light_shadow_not_divided(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The distance instead of the angle."""
    step = _quarter(angular_radius)
    return _through(
        sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, angle=lambda h, t: h
    )


def wrong_area_light_shadow_one_half_less(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The segment counts from the centre."""
    step = _quarter(angular_radius)
    segment = lambda x: np.clip(2 * _segment(x) - 1, 0, 1)  # noqa: E731
    return _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, segment)


def wrong_area_light_shadow_inverted(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The hidden fraction."""
    step = _quarter(angular_radius)
    return 1 - _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step)


def wrong_area_light_shadow_wide_steps(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Least steps of half of the way."""
    step = lambda h, t: np.maximum(np.abs(h), 0.5 * t)  # noqa: E731
    return _through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step)
