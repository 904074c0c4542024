"""Known mistakes in tasks 2.1 to 2.5."""

import numpy as np

from autograder.mistakes import mistake
from autograder.mistakes.right import soft_shadows as right


# 2.1 --------------------------------------------------------------------------------------------------------------
@mistake("The quotient is the sine of the angle: what is the angle?")
def safe_angle_ratio(distance, travelled):
    """Close to right for small angles, too small for large ones."""
    return np.clip(distance / np.maximum(travelled, 1e-12), 0, 1)


@mistake("In which unit does the course measure angles?")
def safe_angle_degrees(distance, travelled):
    """Too large by a factor of 57."""
    return np.degrees(right.safe_angle_clipped(distance, travelled))


@mistake("Which side of the right triangle is the way travelled: a leg, or the longest side?")
def safe_angle_arctan(distance, travelled):
    """Close to right for small angles, 45 degrees where it should be 90."""
    return np.where(np.asarray(distance) > 0, np.arctan2(distance, np.maximum(travelled, 0)), 0.0)


@mistake("For which quotients has the arcsine no value, and what is the angle there?")
def safe_angle_not_a_number(distance, travelled):
    """Not a number where the distance is larger than the way travelled."""
    return np.arcsin(distance / np.asarray(travelled))


@mistake("If the ball reaches back beyond the start of the ray, is anything in the way?")
def safe_angle_nan_to_zero(distance, travelled):
    """0 where the ball is so large that it should be 90 degrees."""
    return np.nan_to_num(np.clip(np.arcsin(distance / np.asarray(travelled)), 0, None))


@mistake("How large is the free angle inside of an object?")
def safe_angle_signed(distance, travelled):
    """Right outside, negative inside of objects."""
    return np.arcsin(np.clip(distance / np.maximum(travelled, 1e-12), -1, 1))


@mistake("What does a negative distance say about the way to the light?")
def safe_angle_absolute(distance, travelled):
    """Right outside, wide open inside of objects."""
    return right.safe_angle_clipped(np.abs(distance), travelled)


@mistake("From the ray to the edge of the cone, or from edge to edge?")
def safe_angle_full_cone(distance, travelled):
    """Twice what it should be."""
    return 2 * right.safe_angle_clipped(distance, travelled)


@mistake("At the point itself nothing has been travelled yet: can anything be in the way?")
def safe_angle_start_blocked(distance, travelled):
    """Right but at the start of the ray, which is taken for blocked."""
    return np.where(np.asarray(travelled) > 0, right.safe_angle_clipped(distance, travelled), 0.0)


@mistake("What happens to your guard when the whole scene is a millimetre wide?")
def safe_angle_epsilon(distance, travelled):
    """Right in large scenes, too small in tiny ones."""
    return np.arcsin(np.clip(distance / np.maximum(travelled, 1e-2), 0, 1))


@mistake("What does an index of one argument do to the other when their shapes differ?")
def safe_angle_one_shape(distance, travelled):
    """Right for two arrays of one shape, an error for others."""
    out = np.zeros_like(distance)
    outside = distance > 0
    out[outside] = np.arcsin(np.clip(distance[outside] / np.maximum(travelled[outside], 1e-12), 0, 1))
    return out


# 2.2 --------------------------------------------------------------------------------------------------------------
@mistake("Why does the shadow of a pole get softer towards its top?")
def penumbra_not_divided(distance, travelled, k):
    """The penumbra is as wide near the occluder as far from it."""
    return np.clip(k * np.asarray(distance) + 0 * np.asarray(travelled), 0, 1)


@mistake("What is the largest visible fraction?")
def penumbra_not_clamped(distance, travelled, k):
    """Points without a shadow shine brighter than 1."""
    return np.maximum(k * np.asarray(distance) / np.maximum(travelled, 1e-12), 0)


@mistake("What is the least visible fraction?")
def penumbra_negative(distance, travelled, k):
    """Points in the umbra fall below 0."""
    return np.minimum(k * np.asarray(distance) / np.maximum(travelled, 1e-12), 1)


@mistake("k is large for a small light: what should its shadows look like?")
def penumbra_k_is_softness(distance, travelled, k):
    """A larger k makes shadows softer."""
    return np.clip(np.asarray(distance) / (k * np.maximum(travelled, 1e-12)), 0, 1)


@mistake("Which is multiplied by k: the angle or the quotient?")
def penumbra_of_the_angle(distance, travelled, k):
    """Too bright, most so for small k."""
    return np.minimum(k * right.safe_angle_clipped(distance, travelled), 1)


@mistake("The estimate is cheap because it needs no arcsine: where do the two part?")
def penumbra_of_both_angles(distance, travelled, k):
    """Nearly right, off by a percent or two for small k."""
    return np.minimum(right.safe_angle_clipped(distance, travelled) / np.arcsin(1 / k), 1)


@mistake("Is the estimate a straight line of the quotient?")
def penumbra_smoothstep(distance, travelled, k):
    """Right at 0, one half and 1, eased between."""
    v = right.penumbra_clipped(distance, travelled, k)
    return v * v * (3 - 2 * v)


@mistake("Where does the size of the light come in?")
def penumbra_without_k(distance, travelled, k):
    """The light always has the same, huge size."""
    return np.clip(np.asarray(distance) / np.maximum(travelled, 1e-12), 0, 1)


@mistake("At the point itself nothing has been travelled yet: what do you divide by?")
def penumbra_not_a_number(distance, travelled, k):
    """Not a number at the start of the ray."""
    return np.clip(k * np.asarray(distance) / np.asarray(travelled), 0, 1)


@mistake("At the point itself nothing has been travelled yet: can anything be in the way?")
def penumbra_start_blocked(distance, travelled, k):
    """Right but at the start of the ray, which is taken for blocked."""
    return np.where(np.asarray(travelled) > 0, right.penumbra_clipped(distance, travelled, k), 0.0)


# 2.3 --------------------------------------------------------------------------------------------------------------
@mistake("How much light arrives at a cosine of exactly 0?")
def needs_shadow_ray_at_the_horizon(normal, to_light):
    """Rays are sent where the light is exactly at the horizon."""
    return np.sum(normal * to_light, axis=-1) >= 0


@mistake("What is the sign of the cosine where the light is above the horizon?")
def needs_shadow_ray_away(normal, to_light):
    """Rays are sent from the dark side alone."""
    return np.sum(normal * to_light, axis=-1) < 0


@mistake("Is the answer a number, or yes and no?")
def needs_shadow_ray_cosine(normal, to_light):
    """Numbers where a decision is asked for."""
    return np.sum(normal * to_light, axis=-1)


@mistake("Can light from behind a surface reach its front?")
def needs_shadow_ray_both_sides(normal, to_light):
    """Rays are sent from the dark side too."""
    return np.sum(normal * to_light, axis=-1) != 0


@mistake("How small may a cosine be and still be light?")
def needs_shadow_ray_margin(normal, to_light):
    """A thin strip along the terminator gets no rays."""
    return np.sum(normal * to_light, axis=-1) > 1e-3


@mistake("Above which horizon: the ground's, or the surface's own?")
def needs_shadow_ray_height(normal, to_light):
    """All points agree, whatever their normal is."""
    return np.broadcast_to(to_light, np.shape(normal))[..., 1] > 0


@mistake("Is a sum positive only if each of its terms is?")
def needs_shadow_ray_every_component(normal, to_light):
    """Many lit points get no rays."""
    return np.all(normal * to_light > 0, axis=-1)


@mistake("to_light may have a row for each point.")
def needs_shadow_ray_one_light(normal, to_light):
    """Right for the first point's light alone."""
    return np.sum(normal * np.reshape(to_light, (-1, 3))[:1], axis=-1) > 0


@mistake("to_light may be a single direction, (3,).")
def needs_shadow_ray_light_each(normal, to_light):
    """Right where each point has its light, an error for one light that all share."""
    return np.array([np.dot(n, to_light[i]) > 0 for i, n in enumerate(normal)], dtype=float)


@mistake("Which points can never be lit by this light?")
def needs_shadow_ray_always(normal, to_light):
    """Rays are sent from everywhere."""
    return np.ones(len(normal), dtype=bool)


# 2.4 --------------------------------------------------------------------------------------------------------------
@mistake("What do you compare the distance with, so that far occluders give softer shadows?")
def soft_shadow_not_divided(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """The penumbra is as wide near the occluder as far from it."""
    return right.march(sdf, origin, to_light, t_min, t_max, max_steps, lambda h, t: k * h)


@mistake("A ray is as dark as its worst place: which of the penumbrae is that?")
def soft_shadow_largest(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Hardly any shadow but the umbra."""
    best = np.zeros(len(origin))

    def estimate(h, t):
        return np.ones_like(h)

    blocked = right.march(sdf, origin, to_light, t_min, t_max, max_steps, estimate)
    for i, (o, light) in enumerate(zip(origin, np.broadcast_to(to_light, np.shape(origin)), strict=True)):
        h = sdf((o + t_min * light)[None])[0]
        best[i] = min(k * h / t_min, 1)
    return np.clip(best, 0, 1) * blocked


@mistake("What is kept of a ray that comes near something without touching it?")
def soft_shadow_hard(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Shadows have sharp edges."""
    return right.march(sdf, origin, to_light, t_min, t_max, max_steps, lambda h, t: np.ones_like(h))


@mistake("k is large for a small light: what should its shadows look like?")
def soft_shadow_k_is_softness(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """A larger k makes shadows softer."""
    return right.march(sdf, origin, to_light, t_min, t_max, max_steps, lambda h, t: h / (t * k))


@mistake("Where does the march start, and why not at the point itself?")
def soft_shadow_from_zero(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Everything stands in its own shadow, or nothing does where it should."""
    return right.march(
        sdf,
        origin,
        to_light,
        0.0,
        t_max,
        max_steps,
        lambda h, t: np.where(t > 0, k * h / np.maximum(t, 1e-9), 1),
    )


@mistake("Where does the way to the light end?")
def soft_shadow_endless(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Things beyond the light cast shadows."""
    return right.march(sdf, origin, to_light, t_min, 100.0, max_steps, right.ratio(k))


@mistake("What do you know of a ray that has used up its steps?")
def soft_shadow_exhausted_is_dark(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Dark rims where rays pass close along a surface."""
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


@mistake("k belongs to the light's radius: do you use its diameter?")
def soft_shadow_half_k(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Shadows are twice as soft as they should be."""
    return right.march(sdf, origin, to_light, t_min, t_max, max_steps, right.ratio(k / 2))


@mistake("Which quotient is kept: as it is, or bent afterwards?")
def soft_shadow_smoothstep(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Right at 0, one half and 1, eased between."""
    v = right.march(sdf, origin, to_light, t_min, t_max, max_steps, right.ratio(k))
    return v * v * (3 - 2 * v)


@mistake("Visibility is a fraction of light: is it encoded for a screen here?")
def soft_shadow_square_root(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Penumbrae are too bright."""
    return np.sqrt(right.march(sdf, origin, to_light, t_min, t_max, max_steps, right.ratio(k)))


@mistake("How far can a ray go without meeting anything?")
def soft_shadow_double_steps(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Shadows have holes."""
    return right.march(sdf, origin, to_light, t_min, t_max, max_steps, right.ratio(k), lambda h, t: 2 * h)


@mistake("How far can a ray go without meeting anything?")
def soft_shadow_fixed_steps(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Shadows are banded, and thin things cast none."""
    return right.march(sdf, origin, to_light, t_min, t_max, max_steps, right.ratio(k), lambda h, t: 0.2)


@mistake("How close may a ray come before it counts as blocked?")
def soft_shadow_coarse(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Umbrae are too large."""
    return right.march(sdf, origin, to_light, t_min, t_max, max_steps, right.ratio(k), near=1e-2)


@mistake("How many steps may a ray take?")
def soft_shadow_five_steps(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Shadows of far things are missing."""
    return right.march(sdf, origin, to_light, t_min, t_max, min(max_steps, 5), right.ratio(k))


@mistake("to_light may have a row for each point.")
def soft_shadow_light_for_all(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Right for one light, an error where each point has its own."""
    return right.march(sdf, origin, np.reshape(to_light, 3), t_min, t_max, max_steps, right.ratio(k))


@mistake("Which of the visited points decides?")
def soft_shadow_last_step(sdf, origin, to_light, k, t_min, t_max, max_steps):
    """Penumbrae are missing: only what the ray meets last counts."""
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
@mistake("A ray to the centre that is blocked: can a part of the light still be seen?")
def area_light_shadow_unsigned(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The dark half of every penumbra is missing: the light is cut off at its centre."""
    return right.march(
        sdf, origin, to_light, t_min, t_max, max_steps, right.ratio(1 / np.sin(angular_radius))
    )


@mistake("What does a negative angle say about how much of the light is left?")
def area_light_shadow_unsigned_through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The dark half of every penumbra is black."""
    step = right.quarter(angular_radius)
    return right.through(
        sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, lambda x: np.maximum(x, 0)
    )


@mistake("How much of a round light is hidden by an edge that passes in front of it?")
def area_light_shadow_hard(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Shadows have sharp edges."""
    return right.march(sdf, origin, to_light, t_min, t_max, max_steps, lambda h, t: np.ones_like(h))


@mistake("How do you tell a ray that passes by an object from one that passes through?")
def area_light_shadow_absolute(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Umbrae are bright in the middle."""
    step = right.quarter(angular_radius)
    return right.through(
        lambda p: np.abs(sdf(p)), origin, to_light, angular_radius, t_min, t_max, max_steps, step
    )


@mistake("The smallest angle lies inside the occluder: how does the march get there?")
def area_light_shadow_stops(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Umbrae are half lit: rays end at the surface that they meet."""
    return right.through(
        sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, lambda h, t: np.abs(h)
    )


@mistake("Which way does a step of negative length lead?")
def area_light_shadow_turns_back(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Umbrae are half lit: rays swing about the surface that they meet."""
    return right.through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, lambda h, t: h)


@mistake("In which unit is angular_radius?")
def area_light_shadow_degrees(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Shadows are sharp: the light is nearly a point."""
    radius = np.radians(angular_radius)
    return right.through(
        sdf, origin, to_light, radius, t_min, t_max, max_steps, right.quarter(angular_radius)
    )


@mistake("From the light's centre to its edge, or from edge to edge?")
def area_light_shadow_diameter(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Penumbrae are twice as wide as they should be."""
    radius = 2 * angular_radius
    return right.through(sdf, origin, to_light, radius, t_min, t_max, max_steps, right.quarter(radius))


@mistake("From the light's centre to its edge, or from edge to edge?")
def area_light_shadow_half_radius(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Penumbrae are half as wide as they should be."""
    radius = angular_radius / 2
    return right.through(sdf, origin, to_light, radius, t_min, t_max, max_steps, right.quarter(radius))


@mistake("Under which angle does the point see a distance that is so far away?")
def area_light_shadow_not_divided(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """The penumbra is as wide near the occluder as far from it."""
    step = right.quarter(angular_radius)
    return right.through(
        sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, angle=lambda h, t: h
    )


@mistake("How much of the disc is seen when its centre is exactly at the edge?")
def area_light_shadow_one_half_less(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Shadows begin where half of the light is still seen."""
    step = right.quarter(angular_radius)
    segment = lambda x: np.clip(2 * right.segment(x) - 1, 0, 1)  # noqa: E731
    return right.through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step, segment)


@mistake("Is the visible fraction asked for, or the hidden one?")
def area_light_shadow_inverted(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Light and shadow are exchanged."""
    step = right.quarter(angular_radius)
    return 1 - right.through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step)


@mistake("How long may a step be at most, so that nothing as large as the light is jumped over?")
def area_light_shadow_wide_steps(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps):
    """Thin things cast no shadows, others torn ones."""
    step = lambda h, t: np.maximum(np.abs(h), 0.5 * t)  # noqa: E731
    return right.through(sdf, origin, to_light, angular_radius, t_min, t_max, max_steps, step)
