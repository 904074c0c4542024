"""Known mistakes in tasks 1.1 to 1.7."""

import numpy as np

from autograder.mistakes import mistake
from autograder.mistakes.right import sphere_tracing as right


# 1.1 --------------------------------------------------------------------------------------------------------------
@mistake("Where is the distance to a ball 0: at its centre, or on its surface?")
def sdf_sphere_radius_ignored(p, center, radius):
    """Every distance is too large by the radius: the ball is a point."""
    return np.linalg.norm(p - center, axis=-1)


@mistake("From where is a point's distance to the ball measured?")
def sdf_sphere_center_ignored(p, center, radius):
    """The ball always sits at the origin."""
    return np.linalg.norm(p, axis=-1) - radius


@mistake("Which vector leads from the centre to the point?")
def sdf_sphere_center_added(p, center, radius):
    """The ball sits on the opposite side of the origin."""
    return np.linalg.norm(p + center, axis=-1) - radius


@mistake("Is the result a length, or a length squared?")
def sdf_sphere_squared(p, center, radius):
    """Distances are right on the surface, too small near it inside and out, and far too large far away."""
    return np.sum((p - center) ** 2, axis=-1) - radius**2


@mistake("Both terms of the difference must be lengths.")
def sdf_sphere_half_squared(p, center, radius):
    """The surface lies where the squared distance equals the radius."""
    return np.sum((p - center) ** 2, axis=-1) - radius


@mistake("What is the sign of a signed distance outside?")
def sdf_sphere_inside_out(p, center, radius):
    """Inside is positive, outside negative."""
    return radius - np.linalg.norm(p - center, axis=-1)


@mistake("A march that starts inside has to notice it: what tells it?")
def sdf_sphere_unsigned(p, center, radius):
    """Right outside, positive where it should be negative."""
    return np.abs(np.linalg.norm(p - center, axis=-1) - radius)


@mistake("How deep inside a point lies is asked for too.")
def sdf_sphere_clamped(p, center, radius):
    """Right outside, 0 everywhere inside."""
    return np.maximum(np.linalg.norm(p - center, axis=-1) - radius, 0)


@mistake("How long is the diagonal of a square: the sum of its sides?")
def sdf_sphere_manhattan(p, center, radius):
    """Balls look like octahedra."""
    return np.abs(p - center).sum(axis=-1) - radius


@mistake("All three coordinates add to a distance, not the largest alone.")
def sdf_sphere_chebyshev(p, center, radius):
    """Balls look like cubes."""
    return np.abs(p - center).max(axis=-1) - radius


@mistake("How many coordinates has the vector to the centre?")
def sdf_sphere_without_y(p, center, radius):
    """Balls look like endless cylinders."""
    return np.linalg.norm((p - center)[..., [0, 2]], axis=-1) - radius


@mistake("The radius reaches from the centre to the surface: does it need halving?")
def sdf_sphere_diameter(p, center, radius):
    """The ball is half as large as it should be."""
    return np.linalg.norm(p - center, axis=-1) - radius / 2


@mistake("In which unit is the result when all lengths are doubled?")
def sdf_sphere_relative(p, center, radius):
    """Distances are measured in radii: right for a ball of radius 1 alone."""
    return np.linalg.norm(p - center, axis=-1) / radius - 1


@mistake("Which axis of p holds the coordinates when p is (3,), and when it is (H, W, 3)?")
def sdf_sphere_flat_only(p, center, radius):
    """Right for a list of points, an error or nonsense for a single point or a grid of them."""
    return np.linalg.norm(p - center, axis=1) - radius


@mistake("A sphere tracer steps by the distance: who limits it?")
def sdf_sphere_bounded(p, center, radius):
    """Right near the surface; far away the distance stops growing."""
    return np.clip(np.linalg.norm(p - center, axis=-1) - radius, -1, 1)


@mistake("In which precision are the results returned?")
def sdf_sphere_half_precision(p, center, radius):
    """Right to three digits only."""
    return (np.linalg.norm(p - center, axis=-1) - radius).astype(np.float16)


# 1.2 --------------------------------------------------------------------------------------------------------------
@mistake("Inside, all three excesses are negative: which one says how far the nearest face is?")
def sdf_box_without_interior(p, center, size):
    """Right outside, 0 everywhere inside."""
    return np.linalg.norm(np.maximum(np.abs(p - center) - size, 0), axis=-1)


@mistake("How far is a corner from a point on its diagonal?")
def sdf_box_chebyshev(p, center, size):
    """Right over the faces, too small off edges and corners."""
    return (np.abs(p - center) - size).max(axis=-1)


@mistake("The half size reaches from the centre to a face: does it need halving?")
def sdf_box_full_size(p, center, size):
    """The box is half as large as it should be."""
    q = np.abs(p - center) - np.asarray(size) / 2
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


@mistake("Which of three negative excesses belongs to the nearest face?")
def sdf_box_smallest_inside(p, center, size):
    """Inside, distances lead to the farthest face."""
    q = np.abs(p - center) - size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.min(-1), 0)


@mistake("What sign has the inner term by itself, and what sign should the result have?")
def sdf_box_inside_subtracted(p, center, size):
    """Right outside, positive where it should be negative."""
    q = np.abs(p - center) - size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) - np.minimum(q.max(-1), 0)


@mistake("One term counts inside and one outside: what switches the inner one off?")
def sdf_box_inside_unclamped(p, center, size):
    """Right inside, too large outside."""
    q = np.abs(p - center) - size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + q.max(-1)


@mistake("A negative excess along one axis says nothing about the distance outside.")
def sdf_box_outside_unclamped(p, center, size):
    """Too large over the faces, and positive inside."""
    q = np.abs(p - center) - size
    return np.linalg.norm(q, axis=-1) + np.minimum(q.max(-1), 0)


@mistake("The box is symmetric about its centre: what folds all octants onto one?")
def sdf_box_one_sided(p, center, size):
    """Right in one octant; everywhere else points look as if they were inside."""
    q = p - center - size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


@mistake("From where is a point's distance to the box measured?")
def sdf_box_center_ignored(p, center, size):
    """The box always sits at the origin."""
    q = np.abs(p) - size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


@mistake("half_size has three components: which one belongs to which axis?")
def sdf_box_cube(p, center, size):
    """Every box is a cube."""
    q = np.abs(p - center) - size[0]
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


@mistake("How long is the way to a corner: the sum of its components?")
def sdf_box_manhattan(p, center, size):
    """Too large off edges and corners, right over the faces."""
    q = np.abs(p - center) - size
    return np.maximum(q, 0).sum(-1) + np.minimum(q.max(-1), 0)


@mistake("Is the result a length, or a length squared?")
def sdf_box_without_root(p, center, size):
    """Squared outside: too small near the box, too large far away."""
    q = np.abs(p - center) - size
    return (np.maximum(q, 0) ** 2).sum(-1) + np.minimum(q.max(-1), 0)


@mistake("In which order do half_size and the coordinates come?")
def sdf_box_axes_reversed(p, center, size):
    """Width and depth are exchanged."""
    q = np.abs(p - center) - size[::-1]
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


# 1.3 --------------------------------------------------------------------------------------------------------------
def _torus(p, center, major, minor, axis=1):
    q = np.delete(p - center, axis, axis=-1)
    return np.hypot(np.linalg.norm(q, axis=-1) - major, (p - center)[..., axis]) - minor


@mistake("Around which axis does the ring turn, and which two coordinates lie in its plane?")
def sdf_torus_around_z(p, center, major_radius, minor_radius):
    """The ring stands upright and faces the camera instead of lying flat."""
    return _torus(p, center, major_radius, minor_radius, 2)


@mistake("Around which axis does the ring turn, and which two coordinates lie in its plane?")
def sdf_torus_around_x(p, center, major_radius, minor_radius):
    """The ring stands upright, edge on, instead of lying flat."""
    return _torus(p, center, major_radius, minor_radius, 0)


@mistake("Which radius belongs to the ring, and which to the tube around it?")
def sdf_torus_radii_swapped(p, center, major_radius, minor_radius):
    """The tube is thicker than the ring is wide: no hole."""
    return _torus(p, center, minor_radius, major_radius)


@mistake("From where is a point's distance to the ring measured?")
def sdf_torus_center_ignored(p, center, major_radius, minor_radius):
    """The ring always sits around the origin."""
    return _torus(p, np.zeros(3), major_radius, minor_radius)


@mistake("Where is the distance to be 0: in the tube's middle, or on its surface?")
def sdf_torus_tube_ignored(p, center, major_radius, minor_radius):
    """Every distance is too large by the radius of the tube: the ring is a wire."""
    return _torus(p, center, major_radius, 0)


@mistake("What is the sign of a signed distance inside?")
def sdf_torus_unsigned(p, center, major_radius, minor_radius):
    """Right outside, positive inside the tube."""
    return np.abs(_torus(p, center, major_radius, minor_radius))


@mistake("How deep inside a point lies is asked for too.")
def sdf_torus_clamped(p, center, major_radius, minor_radius):
    """Right outside, 0 everywhere inside the tube."""
    return np.maximum(_torus(p, center, major_radius, minor_radius), 0)


@mistake("Is the result a length, or a length squared?")
def sdf_torus_squared(p, center, major_radius, minor_radius):
    """Right on the surface alone."""
    return (_torus(p, center, major_radius, 0)) ** 2 - minor_radius**2


@mistake("The major radius leads to the middle of the tube, not to the rim of the hole.")
def sdf_torus_inner_radius(p, center, major_radius, minor_radius):
    """The ring is too wide by the radius of the tube."""
    return _torus(p, center, major_radius + minor_radius, minor_radius)


@mistake("A point in the hole is away from the ring too: what is the sign of that way, and does it matter?")
def sdf_torus_disc(p, center, major_radius, minor_radius):
    """The hole is filled."""
    q = p - center
    ring = np.maximum(np.hypot(q[..., 0], q[..., 2]) - major_radius, 0)
    return np.hypot(ring, q[..., 1]) - minor_radius


@mistake("The height above the ring's plane is a part of the distance too.")
def sdf_torus_flat(p, center, major_radius, minor_radius):
    """The ring is an endless pipe along its axis."""
    q = p - center
    return np.abs(np.hypot(q[..., 0], q[..., 2]) - major_radius) - minor_radius


@mistake("How far is a point from a circle's middle: its larger coordinate?")
def sdf_torus_box_tube(p, center, major_radius, minor_radius):
    """The tube has corners."""
    q = p - center
    return np.maximum(np.abs(np.hypot(q[..., 0], q[..., 2]) - major_radius), np.abs(q[..., 1])) - minor_radius


# 1.4 --------------------------------------------------------------------------------------------------------------
@mistake("Which distance is left when t is 0?")
def blend_swapped(d1, d2, t):
    """At t = 0 the second shape appears, at t = 1 the first."""
    return t * d1 + (1 - t) * d2


@mistake("What do the two weights add up to?")
def blend_weight_missing(d1, d2, t):
    """The first shape never fades."""
    return d1 + t * d2


@mistake("What is left at t = 1, with which sign?")
def blend_minus(d1, d2, t):
    """At t = 1 the second shape is turned inside out."""
    return (1 - t) * d1 - t * d2


@mistake("Between the two ends each has a part in the result.")
def blend_nearest(d1, d2, t):
    """One shape jumps into the other half-way."""
    return np.where(np.less(t, 0.5), d1, d2) + 0.0 * d1


@mistake("Does the result move evenly when t does?")
def blend_smoothstep(d1, d2, t):
    """Right at the ends and half-way, eased between them."""
    t = t * t * (3 - 2 * t)
    return (1 - t) * d1 + t * d2


@mistake("Half-way, how much of each is in the result?")
def blend_squared(d1, d2, t):
    """Too much of the first shape everywhere between the ends."""
    return (1 - t**2) * d1 + t**2 * d2


@mistake("What does t do?")
def blend_mean(d1, d2, t):
    """The same shape, whatever t is."""
    return 0.5 * (d1 + d2)


@mistake("Where does the second distance come in?")
def blend_first(d1, d2, t):
    """The first shape, whatever t is."""
    return d1 + 0.0 * t


@mistake("A blend moves from one shape to the other; a union shows both.")
def blend_union(d1, d2, t):
    """Both shapes at once, whatever t is."""
    return np.minimum(d1, d2) + 0.0 * t


@mistake("What does `if` make of an array?")
def blend_scalar_t_only(d1, d2, t):
    """Right for a number t, an error for an array of them."""
    return d1 if t == 0 else (1 - t) * d1 + t * d2


@mistake("What do the two weights add up to?")
def blend_mean_of_weights(d1, d2, t):
    """Half of what it should be, everywhere."""
    return ((1 - t) * d1 + t * d2) / 2


# 1.5 --------------------------------------------------------------------------------------------------------------
def _smooth(d1, d2, k, fall):
    return np.minimum(d1, d2) - fall(np.maximum(k - np.abs(d1 - d2), 0) / k) * k


@mistake("How deep is the bulge where both distances are equal? Compare it with k / 4.")
def smooth_union_half(d1, d2, k):
    """The bulge between the shapes is twice as deep as it should be."""
    return _smooth(d1, d2, k, lambda h: h**2 / 2)


@mistake("From which difference of the distances on is the result exactly the smaller one?")
def smooth_union_wide(d1, d2, k):
    """The shapes melt together over twice the width."""
    return _smooth(d1, d2, 4 * k, lambda h: h**2 / 4)


@mistake("Which constant makes the curve meet the smaller distance without a kink?")
def smooth_union_sixth(d1, d2, k):
    """The bulge has the right width and the wrong depth."""
    return _smooth(d1, d2, k, lambda h: h**3 / 6)


@mistake("How wide is the band in which both distances count, and how wide is yours?")
def smooth_union_exponential(d1, d2, k):
    """Close to right, but the shapes never quite part."""
    return np.minimum(d1, d2) - k * np.log1p(np.exp(-np.abs(d1 - d2) / k))


@mistake("The band lies on both sides of equal distances.")
def smooth_union_abs_missing(d1, d2, k):
    """The order of the two shapes matters."""
    return np.minimum(d1, d2) - np.maximum(k - (d1 - d2), 0) ** 2 / (4 * k)


@mistake("What becomes of the band's term where the difference is larger than k?")
def smooth_union_clamp_missing(d1, d2, k):
    """Far from where they meet, the shapes grow without limit."""
    return np.minimum(d1, d2) - (k - np.abs(d1 - d2)) ** 2 / (4 * k)


@mistake("Where the band ends, the slope should not jump: which power does that?")
def smooth_union_square_missing(d1, d2, k):
    """There is a crease along the rim of the bulge."""
    return _smooth(d1, d2, k, lambda h: h / 4)


@mistake("Does the union grow or shrink where both surfaces are near?")
def smooth_union_sign(d1, d2, k):
    """The shapes part where they should melt together."""
    return _smooth(d1, d2, k, lambda h: -(h**2) / 4)


@mistake("Which of two distances leads to the union of two shapes?")
def smooth_union_of_maximum(d1, d2, k):
    """Only what both shapes have in common appears."""
    return np.maximum(d1, d2) + np.maximum(k - np.abs(d1 - d2), 0) ** 2 / (4 * k)


@mistake("What is the result where both distances are equal?")
def smooth_union_sharp(d1, d2, k):
    """The shapes meet in a crease."""
    return np.minimum(d1, d2) + 0.0 * k


@mistake("A length squared over what is a length again?")
def smooth_union_not_divided(d1, d2, k):
    """The depth of the bulge changes with the units of the scene."""
    return np.minimum(d1, d2) - np.maximum(k - np.abs(d1 - d2), 0) ** 2 / 4


@mistake("How wide is the band: a constant, or k?")
def smooth_union_fixed_width(d1, d2, k):
    """Right for one k alone."""
    return np.minimum(d1, d2) - np.maximum(0.5 - np.abs(d1 - d2), 0) ** 2 / 2


# 1.6 --------------------------------------------------------------------------------------------------------------
@mistake("In which direction does the distance grow?")
def estimate_normal_inward(sdf, p, eps):
    """Normals point into the shape."""
    return right.unit(np.stack([sdf(p - e) - sdf(p + e) for e in eps * np.eye(3)], axis=-1))


@mistake("The slope of a field is 1 only if it is an exact distance: what makes any vector a unit vector?")
def estimate_normal_not_unit(sdf, p, eps):
    """Right direction, lengths that differ from 1 where the field is no exact distance."""
    return np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1) / (2 * eps)


@mistake("A difference is not a slope, and neither is a unit vector.")
def estimate_normal_differences(sdf, p, eps):
    """Right direction, far too short."""
    return np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1)


@mistake("How far apart are your samples, compared with eps, and are they on both sides?")
def estimate_normal_one_sided_wide(sdf, p, eps):
    """Normals lean over where the surface curves."""
    d = sdf(p)
    return right.unit(np.stack([sdf(p + 10 * e) - d for e in eps * np.eye(3)], axis=-1))


@mistake("In which order do the three differences go into the result?")
def estimate_normal_zy_swapped(sdf, p, eps):
    """Right along x, y and z exchanged."""
    return right.unit(np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1))[:, [0, 2, 1]]


@mistake("Where does the field come in?")
def estimate_normal_position(sdf, p, eps):
    """Right for a ball around the origin alone."""
    return right.unit(p)


@mistake("Along which axis is a normal's length summed?")
def estimate_normal_normalised_over_points(sdf, p, eps):
    """Right for a single point, wrong for many."""
    g = np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1)
    return g / np.linalg.norm(g, axis=0)


@mistake("Do the four corners of the tetrahedron add up to 0?")
def estimate_normal_corner_sign(sdf, p, eps):
    """Normals are skewed to one side."""
    corners = right.CORNERS * [[1, 1, 1], [1, 1, 1], [1, 1, 1], [1, 1, -1]]
    return right.unit(sum(k * sdf(p + eps * k)[:, None] for k in corners))


@mistake("One difference tells the slope along one direction: how many are needed?")
def estimate_normal_diagonal_only(sdf, p, eps):
    """All normals point along one diagonal."""
    d = sdf(p + eps) - sdf(p - eps)
    return right.unit(np.stack([d, d, d], axis=-1))


@mistake("How many axes has space?")
def estimate_normal_y_missing(sdf, p, eps):
    """Normals are never tilted up or down."""
    return right.unit(
        np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1) * [1, 0, 1] + [0, 1e-9, 0]
    )


@mistake("Is the longest component of a unit vector 1?")
def estimate_normal_largest_is_one(sdf, p, eps):
    """Right direction, lengths up to 1.7."""
    g = np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1)
    return g / np.abs(g).max(axis=-1, keepdims=True)


@mistake("What is returned?")
def estimate_normal_zero(sdf, p, eps):
    """No normal at all."""
    return np.zeros_like(p)


# 1.7 --------------------------------------------------------------------------------------------------------------
def _trace(
    sdf, o, d, t_max, eps, max_steps, start=0.0, step=lambda h: h, near=None, finish=None, all_rays=False
):
    """The plain march, with a screw at every place."""
    t, hit = np.full(len(o), start, float), np.zeros(len(o), bool)
    alive = np.ones(len(o), bool)
    for _ in range(max_steps):
        if not alive.any():
            break
        h = np.full(len(o), np.inf)
        if all_rays:
            h = np.where(alive, sdf(o + t[:, None] * d), np.inf)
        else:
            h[alive] = sdf(o[alive] + t[alive, None] * d[alive])
        found = alive & (near(h, t) if near else h < eps)
        hit |= found
        alive &= ~found
        t = np.where(alive, t + step(h), t)
        alive &= t <= t_max
    if finish:
        return finish(t, hit, alive)
    return np.where(hit, t, np.inf), hit


@mistake("Which rays still need a distance after the first few steps?")
def sphere_trace_all_rays(sdf, origin, direction, t_max, eps, max_steps):
    """Right, with far more evaluations than needed."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, all_rays=True)


@mistake("What do you know of a ray that has used up its steps?")
def sphere_trace_exhausted_is_hit(sdf, origin, direction, t_max, eps, max_steps):
    """A rim of false hits around every silhouette."""
    finish = lambda t, hit, alive: (np.where(hit | alive, t, np.inf), hit | alive)  # noqa: E731
    return _trace(sdf, origin, direction, t_max, eps, max_steps, finish=finish)


@mistake("How far away is what a ray never meets?")
def sphere_trace_misses_at_t_max(sdf, origin, direction, t_max, eps, max_steps):
    """A wall at t_max stands behind the scene."""
    finish = lambda t, hit, alive: (np.where(hit, t, t_max), hit)  # noqa: E731
    return _trace(sdf, origin, direction, t_max, eps, max_steps, finish=finish)


@mistake("How far away is what a ray never meets?")
def sphere_trace_misses_at_zero(sdf, origin, direction, t_max, eps, max_steps):
    """Rays that miss report a hit at the camera."""
    finish = lambda t, hit, alive: (np.where(hit, t, 0), hit)  # noqa: E731
    return _trace(sdf, origin, direction, t_max, eps, max_steps, finish=finish)


@mistake("When does a ray end without having met anything?")
def sphere_trace_without_t_max(sdf, origin, direction, t_max, eps, max_steps):
    """Things beyond t_max are seen."""
    return _trace(sdf, origin, direction, np.inf, eps, max_steps)


@mistake("A point is visited only if it still lies on the ray: when is that decided?")
def sphere_trace_hit_beyond_t_max(sdf, origin, direction, t_max, eps, max_steps):
    """Things a little beyond t_max are seen."""
    t, hit = _trace(sdf, origin, direction, np.inf, eps, max_steps)
    return t, hit & (t < 2 * t_max)


@mistake("Who chooses the precision?")
def sphere_trace_eps_ignored(sdf, origin, direction, t_max, eps, max_steps):
    """Hits come closer to the surface than asked for, with more steps."""
    return _trace(sdf, origin, direction, t_max, 1e-6, max_steps)


@mistake("Who chooses the precision?")
def sphere_trace_eps_fixed(sdf, origin, direction, t_max, eps, max_steps):
    """Hits hover at a fixed height over the surface, whatever eps is."""
    return _trace(sdf, origin, direction, t_max, 1e-3, max_steps)


@mistake("Does the distance at which a ray counts as a hit depend on t?")
def sphere_trace_eps_times_t(sdf, origin, direction, t_max, eps, max_steps):
    """Far things grow a coat, near ones need more steps."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, near=lambda h, t: h < eps * t)


@mistake("What does a negative distance at the origin mean?")
def sphere_trace_abs(sdf, origin, direction, t_max, eps, max_steps):
    """Rays that start inside a shape leave it."""
    return _trace(
        sdf, origin, direction, t_max, eps, max_steps, step=np.abs, near=lambda h, t: np.abs(h) < eps
    )


@mistake("Is the origin one of the max_steps visited points?")
def sphere_trace_one_step_less(sdf, origin, direction, t_max, eps, max_steps):
    """Some rays give up one step too early."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps - 1)


@mistake("Is the origin one of the max_steps visited points?")
def sphere_trace_one_step_more(sdf, origin, direction, t_max, eps, max_steps):
    """Some rays take one evaluation more than allowed."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps + 1)


@mistake("Who says how many steps a ray may take?")
def sphere_trace_fixed_steps(sdf, origin, direction, t_max, eps, max_steps):
    """The same picture for every max_steps."""
    return _trace(sdf, origin, direction, t_max, eps, 100)


@mistake("Which point of the ray is visited first?")
def sphere_trace_origin_skipped(sdf, origin, direction, t_max, eps, max_steps):
    """Rays that start on or in a shape are not stopped there."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, start=1e-3)


@mistake("How far can a ray go without meeting anything?")
def sphere_trace_half_steps(sdf, origin, direction, t_max, eps, max_steps):
    """Thin things disappear, others are hit too deep."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, step=lambda h: np.full_like(h, 0.1))


@mistake("How far can a ray go without meeting anything?")
def sphere_trace_double_steps(sdf, origin, direction, t_max, eps, max_steps):
    """Surfaces are torn, thin things disappear."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, step=lambda h: 2 * h)


@mistake("After a step longer than the distance, how do you notice that it was too long?")
def sphere_trace_relaxed_carelessly(sdf, origin, direction, t_max, eps, max_steps):
    """Edges fray: some rays step over what they graze."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, step=lambda h: 1.2 * h)


@mistake("How far may a ray go at once, and how far does yours?")
def sphere_trace_short_steps(sdf, origin, direction, t_max, eps, max_steps):
    """Right in the middle of shapes; rays run out of steps at their rims."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, step=lambda h: 0.5 * h)


@mistake("Each ray ends by itself: what happens to the others?")
def sphere_trace_first_hit_ends_all(sdf, origin, direction, t_max, eps, max_steps):
    """Only the nearest point of the scene is seen."""
    t, alive = np.zeros(len(origin)), np.ones(len(origin), bool)
    hit = np.zeros(len(origin), bool)
    for _ in range(max_steps):
        h = sdf(origin + t[:, None] * direction)
        hit = (h < eps) & (t <= t_max)
        if hit.any():
            break
        t = np.where(alive, t + h, t)
        alive &= t <= t_max
    return np.where(hit, t, np.inf), hit


@mistake("Is t measured along each ray, or along the camera's axis?")
def sphere_trace_depth(sdf, origin, direction, t_max, eps, max_steps):
    """Right in the middle of the picture, too near towards its borders."""
    t, hit = _trace(sdf, origin, direction, t_max, eps, max_steps)
    return t * (direction @ right.unit(direction.mean(axis=0))), hit


@mistake("In which unit is t?")
def sphere_trace_squared(sdf, origin, direction, t_max, eps, max_steps):
    """Right hits; distances that grow with their square."""
    t, hit = _trace(sdf, origin, direction, t_max, eps, max_steps)
    return t**2, hit


@mistake("What does a True in hit say?")
def sphere_trace_inverted(sdf, origin, direction, t_max, eps, max_steps):
    """The background is hit, the shapes are not."""
    t, hit = _trace(sdf, origin, direction, t_max, eps, max_steps)
    return t, ~hit


@mistake("Where is the point at a distance t along the ray?")
def sphere_trace_backwards(sdf, origin, direction, t_max, eps, max_steps):
    """The camera sees what lies behind it."""
    return _trace(sdf, origin, -direction, t_max, eps, max_steps)


@mistake("Where does a ray start?")
def sphere_trace_origin_ignored(sdf, origin, direction, t_max, eps, max_steps):
    """The scene looks the same from everywhere."""
    return _trace(sdf, 0 * origin, direction, t_max, eps, max_steps)


@mistake("What has to be small where a ray hits?")
def sphere_trace_all_hit(sdf, origin, direction, t_max, eps, max_steps):
    """Every ray hits at its origin."""
    return np.zeros(len(origin)), np.ones(len(origin), bool)


@mistake("When does a march end with a hit?")
def sphere_trace_none_hits(sdf, origin, direction, t_max, eps, max_steps):
    """No ray ever hits."""
    return np.full(len(origin), np.inf), np.zeros(len(origin), bool)
