"""Right and wrong versions of tasks 1.1 to 1.7, named `right_FUNCTION_what` and `wrong_FUNCTION_what`."""

import numpy as np


# 1.1 --------------------------------------------------------------------------------------------------------------
def right_sdf_sphere_loop(p, center, radius):
    """A Python loop over the points that keeps any leading shape."""
    points = np.reshape(p, (-1, 3))
    out = [sum((a - b) ** 2 for a, b in zip(q, center, strict=True)) ** 0.5 - radius for q in points]
    return np.reshape(out, np.shape(p)[:-1])


def right_sdf_sphere_float32(p, center, radius):
    """Computed in float32 throughout."""
    q = np.asarray(p, np.float32) - np.asarray(center, np.float32)
    return np.sqrt((q * q).sum(axis=-1, dtype=np.float32)) - np.float32(radius)


def right_sdf_sphere_lists(p, center, radius):
    """Nested lists instead of arrays."""
    return (np.sqrt(np.einsum("...i,...i", np.subtract(p, center), np.subtract(p, center))) - radius).tolist()


def right_sdf_sphere_by_components(p, center, radius):
    """Coordinate by coordinate."""
    x, y, z = np.moveaxis(np.asarray(p) - center, -1, 0)
    return np.hypot(np.hypot(x, y), z) - radius


def wrong_sdf_sphere_radius_ignored(p, center, radius):
    """The radius is ignored."""
    return np.linalg.norm(p - center, axis=-1)


def wrong_sdf_sphere_center_ignored(p, center, radius):
    """The centre is ignored."""
    return np.linalg.norm(p, axis=-1) - radius


def wrong_sdf_sphere_center_added(p, center, radius):
    """The centre is added."""
    return np.linalg.norm(p + center, axis=-1) - radius


def wrong_sdf_sphere_squared(p, center, radius):
    """Squared distances are compared."""
    return np.sum((p - center) ** 2, axis=-1) - radius**2


def wrong_sdf_sphere_half_squared(p, center, radius):
    """The squared distance less the radius."""
    return np.sum((p - center) ** 2, axis=-1) - radius


def wrong_sdf_sphere_inside_out(p, center, radius):
    """The sign is turned."""
    return radius - np.linalg.norm(p - center, axis=-1)


def wrong_sdf_sphere_unsigned(p, center, radius):
    """The distance has no sign."""
    return np.abs(np.linalg.norm(p - center, axis=-1) - radius)


def wrong_sdf_sphere_clamped(p, center, radius):
    """It is 0 inside."""
    return np.maximum(np.linalg.norm(p - center, axis=-1) - radius, 0)


def wrong_sdf_sphere_manhattan(p, center, radius):
    """Sums the coordinates instead of their squares."""
    return np.abs(p - center).sum(axis=-1) - radius


def wrong_sdf_sphere_chebyshev(p, center, radius):
    """Takes the largest coordinate."""
    return np.abs(p - center).max(axis=-1) - radius


def wrong_sdf_sphere_without_y(p, center, radius):
    """Leaves out one axis: a cylinder."""
    return np.linalg.norm((p - center)[..., [0, 2]], axis=-1) - radius


def wrong_sdf_sphere_diameter(p, center, radius):
    """Takes the radius for the diameter."""
    return np.linalg.norm(p - center, axis=-1) - radius / 2


def wrong_sdf_sphere_relative(p, center, radius):
    """Measures in radii."""
    return np.linalg.norm(p - center, axis=-1) / radius - 1


def wrong_sdf_sphere_flat_only(p, center, radius):
    """Expects a list of points: another leading shape fails."""
    return np.linalg.norm(p - center, axis=1) - radius


def wrong_sdf_sphere_bounded(p, center, radius):
    """Cuts far distances off."""
    return np.clip(np.linalg.norm(p - center, axis=-1) - radius, -1, 1)


def wrong_sdf_sphere_half_precision(p, center, radius):
    """Results in half precision."""
    return (np.linalg.norm(p - center, axis=-1) - radius).astype(np.float16)


# 1.2 --------------------------------------------------------------------------------------------------------------
def right_sdf_box_loop(p, center, half_size):
    """A Python loop over the points that keeps any leading shape."""

    def one(q):
        d = [abs(q[i] - center[i]) - half_size[i] for i in range(3)]
        if max(d) <= 0:
            return max(d)
        return sum(max(v, 0.0) ** 2 for v in d) ** 0.5

    return np.array([one(q) for q in np.reshape(p, (-1, 3))]).reshape(np.shape(p)[:-1])


def right_sdf_box_nearest_point(p, center, half_size):
    """The way to the nearest point of the box; inside, the way to each of the six faces."""
    low, high = np.subtract(center, half_size), np.add(center, half_size)
    outside = np.linalg.norm(p - np.clip(p, low, high), axis=-1)
    faces = np.concatenate([p - low, high - p], axis=-1).min(axis=-1)
    return np.where(faces > 0, -faces, outside)


def right_sdf_box_float32(p, center, half_size):
    """Computed in float32 throughout."""
    q = np.abs(np.float32(p) - np.float32(center)) - np.float32(half_size)
    return np.sqrt((np.maximum(q, 0) ** 2).sum(-1)) + np.minimum(q.max(-1), 0)


def right_sdf_box_lists(p, center, half_size):
    """Nested lists instead of arrays."""
    q = np.abs(np.subtract(p, center)) - half_size
    return (np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)).tolist()


def wrong_sdf_box_without_interior(p, center, half_size):
    """It is 0 inside."""
    return np.linalg.norm(np.maximum(np.abs(p - center) - half_size, 0), axis=-1)


def wrong_sdf_box_chebyshev(p, center, half_size):
    """The largest excess, also off edges and corners."""
    return (np.abs(p - center) - half_size).max(axis=-1)


def wrong_sdf_box_full_size(p, center, half_size):
    """Takes the half size for the whole."""
    q = np.abs(p - center) - np.asarray(half_size) / 2
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


def wrong_sdf_box_smallest_inside(p, center, half_size):
    """Inside, the way to the farthest face."""
    q = np.abs(p - center) - half_size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.min(-1), 0)


def wrong_sdf_box_inside_subtracted(p, center, half_size):
    """The inside has the wrong sign."""
    q = np.abs(p - center) - half_size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) - np.minimum(q.max(-1), 0)


def wrong_sdf_box_inside_unclamped(p, center, half_size):
    """The inner term also counts outside."""
    q = np.abs(p - center) - half_size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + q.max(-1)


def wrong_sdf_box_outside_unclamped(p, center, half_size):
    """The length of the whole excess, its negative parts too."""
    q = np.abs(p - center) - half_size
    return np.linalg.norm(q, axis=-1) + np.minimum(q.max(-1), 0)


def wrong_sdf_box_one_sided(p, center, half_size):
    """Without abs: only one octant is right."""
    q = p - center - half_size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


def wrong_sdf_box_center_ignored(p, center, half_size):
    """The centre is ignored."""
    q = np.abs(p) - half_size
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


def wrong_sdf_box_cube(p, center, half_size):
    """Every side is as long as the first."""
    q = np.abs(p - center) - half_size[0]
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


def wrong_sdf_box_manhattan(p, center, half_size):
    """Sums the excesses."""
    q = np.abs(p - center) - half_size
    return np.maximum(q, 0).sum(-1) + np.minimum(q.max(-1), 0)


def wrong_sdf_box_without_root(p, center, half_size):
    """Squared outside."""
    q = np.abs(p - center) - half_size
    return (np.maximum(q, 0) ** 2).sum(-1) + np.minimum(q.max(-1), 0)


def wrong_sdf_box_axes_reversed(p, center, half_size):
    """The sides in the order z, y, x."""
    q = np.abs(p - center) - half_size[::-1]
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


# 1.3 --------------------------------------------------------------------------------------------------------------
def right_sdf_torus_loop(p, center, major_radius, minor_radius):
    """A Python loop over the points that keeps any leading shape."""
    out = []
    for x, y, z in np.reshape(np.subtract(p, center), (-1, 3)):
        out.append((((x * x + z * z) ** 0.5 - major_radius) ** 2 + y * y) ** 0.5 - minor_radius)
    return np.reshape(out, np.shape(p)[:-1])


def right_sdf_torus_nearest_point(p, center, major_radius, minor_radius):
    """The way to the nearest point of the ring, found by its angle."""
    q = np.subtract(p, center)
    turn = np.arctan2(q[..., 2], q[..., 0])
    ring = major_radius * np.stack([np.cos(turn), np.zeros_like(turn), np.sin(turn)], axis=-1)
    return np.linalg.norm(q - ring, axis=-1) - minor_radius


def right_sdf_torus_float32(p, center, major_radius, minor_radius):
    """Computed in float32 throughout."""
    q = np.float32(p) - np.float32(center)
    ring = np.sqrt(q[..., 0] ** 2 + q[..., 2] ** 2) - np.float32(major_radius)
    return np.sqrt(ring**2 + q[..., 1] ** 2) - np.float32(minor_radius)


def right_sdf_torus_lists(p, center, major_radius, minor_radius):
    """Nested lists instead of arrays; the law of cosines."""
    q = np.subtract(p, center)
    square = (q**2).sum(-1) + major_radius**2 - 2 * major_radius * np.hypot(q[..., 0], q[..., 2])
    return (np.sqrt(np.maximum(square, 0)) - minor_radius).tolist()


def _torus(p, center, major, minor, axis=1):
    q = np.delete(p - center, axis, axis=-1)
    return np.hypot(np.linalg.norm(q, axis=-1) - major, (p - center)[..., axis]) - minor


def wrong_sdf_torus_around_z(p, center, major_radius, minor_radius):
    """Its axis is +z."""
    return _torus(p, center, major_radius, minor_radius, 2)


def wrong_sdf_torus_around_x(p, center, major_radius, minor_radius):
    """Its axis is +x."""
    return _torus(p, center, major_radius, minor_radius, 0)


def wrong_sdf_torus_radii_swapped(p, center, major_radius, minor_radius):
    """The two radii change places."""
    return _torus(p, center, minor_radius, major_radius)


def wrong_sdf_torus_center_ignored(p, center, major_radius, minor_radius):
    """The centre is ignored."""
    return _torus(p, np.zeros(3), major_radius, minor_radius)


def wrong_sdf_torus_tube_ignored(p, center, major_radius, minor_radius):
    """The distance to the ring inside the tube."""
    return _torus(p, center, major_radius, 0)


def wrong_sdf_torus_unsigned(p, center, major_radius, minor_radius):
    """The distance has no sign."""
    return np.abs(_torus(p, center, major_radius, minor_radius))


def wrong_sdf_torus_clamped(p, center, major_radius, minor_radius):
    """It is 0 inside."""
    return np.maximum(_torus(p, center, major_radius, minor_radius), 0)


def wrong_sdf_torus_squared(p, center, major_radius, minor_radius):
    """Squared distances are compared."""
    return (_torus(p, center, major_radius, 0)) ** 2 - minor_radius**2


def wrong_sdf_torus_inner_radius(p, center, major_radius, minor_radius):
    """Takes the radius of the hole for the major one."""
    return _torus(p, center, major_radius + minor_radius, minor_radius)


def wrong_sdf_torus_disc(p, center, major_radius, minor_radius):
    """Fills the hole."""
    q = p - center
    ring = np.maximum(np.hypot(q[..., 0], q[..., 2]) - major_radius, 0)
    return np.hypot(ring, q[..., 1]) - minor_radius


def wrong_sdf_torus_flat(p, center, major_radius, minor_radius):
    """Leaves the height out."""
    q = p - center
    return np.abs(np.hypot(q[..., 0], q[..., 2]) - major_radius) - minor_radius


def wrong_sdf_torus_box_tube(p, center, major_radius, minor_radius):
    """The tube has corners."""
    q = p - center
    return np.maximum(np.abs(np.hypot(q[..., 0], q[..., 2]) - major_radius), np.abs(q[..., 1])) - minor_radius


# 1.4 --------------------------------------------------------------------------------------------------------------
def right_blend_loop(d1, d2, t):
    """A Python loop over the values that keeps any leading shape."""
    d1, d2, t = np.broadcast_arrays(d1, d2, t)
    return np.array([(1 - c) * a + c * b for a, b, c in zip(d1.flat, d2.flat, t.flat, strict=True)]).reshape(
        d1.shape
    )


def right_blend_from_the_first(d1, d2, t):
    """The first distance and a part of the difference."""
    return d1 + t * (d2 - d1)


def right_blend_float32(d1, d2, t):
    """Computed in float32 throughout."""
    return np.float32(d1) * (np.float32(1) - np.float32(t)) + np.float32(d2) * np.float32(t)


def right_blend_lists(d1, d2, t):
    """Nested lists instead of arrays."""
    return (np.multiply(d1, np.subtract(1, t)) + np.multiply(d2, t)).tolist()


def right_blend_bounded(d1, d2, t):
    """t is kept within [0, 1], where it is anyway."""
    t = np.clip(t, 0, 1)
    return (1 - t) * d1 + t * d2


def wrong_blend_swapped(d1, d2, t):
    """The weights change places."""
    return t * d1 + (1 - t) * d2


def wrong_blend_weight_missing(d1, d2, t):
    """The first distance keeps its whole weight."""
    return d1 + t * d2


def wrong_blend_minus(d1, d2, t):
    """The second distance is subtracted."""
    return (1 - t) * d1 - t * d2


def wrong_blend_nearest(d1, d2, t):
    """Jumps from one to the other."""
    return np.where(np.less(t, 0.5), d1, d2) + 0.0 * d1


def wrong_blend_smoothstep(d1, d2, t):
    """An eased t: right at the ends and in the middle only."""
    t = t * t * (3 - 2 * t)
    return (1 - t) * d1 + t * d2


def wrong_blend_squared(d1, d2, t):
    """t squared."""
    return (1 - t**2) * d1 + t**2 * d2


def wrong_blend_mean(d1, d2, t):
    """t is ignored."""
    return 0.5 * (d1 + d2)


def wrong_blend_first(d1, d2, t):
    """Only the first distance."""
    return d1 + 0.0 * t


def wrong_blend_union(d1, d2, t):
    """The union of both, whatever t is."""
    return np.minimum(d1, d2) + 0.0 * t


def wrong_blend_scalar_t_only(d1, d2, t):
    """A test of t that works for numbers alone."""
    return d1 if t == 0 else (1 - t) * d1 + t * d2


def wrong_blend_mean_of_weights(d1, d2, t):
    """Half of what it should be."""
    return ((1 - t) * d1 + t * d2) / 2


# 1.5 --------------------------------------------------------------------------------------------------------------
def right_smooth_union_mix(d1, d2, k):
    """The same curve written as a mix with a clamped weight."""
    h = np.clip(0.5 + 0.5 * (d2 - d1) / k, 0, 1)
    return d2 + (d1 - d2) * h - k * h * (1 - h)


def right_smooth_union_loop(d1, d2, k):
    """A Python loop over the values that keeps any leading shape."""
    out = []
    d1, d2 = np.broadcast_arrays(d1, d2)
    for a, b in zip(d1.flat, d2.flat, strict=True):
        h = max(k - abs(a - b), 0.0) / k
        out.append(min(a, b) - h * h * k / 4)
    return np.reshape(out, d1.shape)


def right_smooth_union_float32(d1, d2, k):
    """Computed in float32 throughout."""
    d1, d2, k = np.float32(d1), np.float32(d2), np.float32(k)
    return np.minimum(d1, d2) - np.maximum(k - np.abs(d1 - d2), np.float32(0)) ** 2 / (np.float32(4) * k)


def right_smooth_union_lists(d1, d2, k):
    """Nested lists instead of arrays; the three cases apart."""
    middle = ((d1 + d2) - (k * k + (d1 - d2) ** 2) / (2 * k)) / 2
    return np.where(np.abs(d1 - d2) < k, middle, np.minimum(d1, d2)).tolist()


def _smooth(d1, d2, k, fall):
    return np.minimum(d1, d2) - fall(np.maximum(k - np.abs(d1 - d2), 0) / k) * k


def wrong_smooth_union_half(d1, d2, k):
    """Divided by 2 k: the surface rises by k / 2."""
    return _smooth(d1, d2, k, lambda h: h**2 / 2)


def wrong_smooth_union_wide(d1, d2, k):
    """A band four times as wide."""
    return _smooth(d1, d2, 4 * k, lambda h: h**2 / 4)


def wrong_smooth_union_sixth(d1, d2, k):
    """Cubic: the surface rises by k / 6."""
    return _smooth(d1, d2, k, lambda h: h**3 / 6)


def wrong_smooth_union_exponential(d1, d2, k):
    """The exponential minimum."""
    return np.minimum(d1, d2) - k * np.log1p(np.exp(-np.abs(d1 - d2) / k))


def wrong_smooth_union_abs_missing(d1, d2, k):
    """Without abs: one side of the band only."""
    return np.minimum(d1, d2) - np.maximum(k - (d1 - d2), 0) ** 2 / (4 * k)


def wrong_smooth_union_clamp_missing(d1, d2, k):
    """Without max(., 0): sinks outside of the band."""
    return np.minimum(d1, d2) - (k - np.abs(d1 - d2)) ** 2 / (4 * k)


def wrong_smooth_union_square_missing(d1, d2, k):
    """Linear: a crease at the edges of the band."""
    return _smooth(d1, d2, k, lambda h: h / 4)


def wrong_smooth_union_sign(d1, d2, k):
    """Added: the seam sinks."""
    return _smooth(d1, d2, k, lambda h: -(h**2) / 4)


def wrong_smooth_union_of_maximum(d1, d2, k):
    """The smooth intersection."""
    return np.maximum(d1, d2) + np.maximum(k - np.abs(d1 - d2), 0) ** 2 / (4 * k)


def wrong_smooth_union_sharp(d1, d2, k):
    """The plain minimum."""
    return np.minimum(d1, d2) + 0.0 * k


def wrong_smooth_union_not_divided(d1, d2, k):
    """Divided by 4, not by 4 k: changes with the scene's scale."""
    return np.minimum(d1, d2) - np.maximum(k - np.abs(d1 - d2), 0) ** 2 / 4


def wrong_smooth_union_fixed_width(d1, d2, k):
    """k is ignored."""
    return np.minimum(d1, d2) - np.maximum(0.5 - np.abs(d1 - d2), 0) ** 2 / 2


# 1.6 --------------------------------------------------------------------------------------------------------------
CORNERS = np.array([(1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1)], float)


def _unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def right_estimate_normal_tetrahedron(sdf, p, eps):
    """Four evaluations."""
    return _unit(sum(k * sdf(p + eps * k)[:, None] for k in CORNERS))


def right_estimate_normal_loop(sdf, p, eps):
    """A Python loop over points and axes; a list of tuples."""
    normals = []
    for q in p:
        g = [float(sdf((q + e)[None])[0] - sdf((q - e)[None])[0]) for e in eps * np.eye(3)]
        length = sum(v * v for v in g) ** 0.5
        normals.append(tuple(v / length for v in g))
    return normals


def right_estimate_normal_float32(sdf, p, eps):
    """Central differences, results in float32."""
    return _unit(np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=1)).astype(np.float32)


def right_estimate_normal_single_precision(sdf, p, eps):
    """Points and differences in float32."""
    p, eye = p.astype(np.float32), np.float32(eps) * np.eye(3, dtype=np.float32)
    return _unit(np.stack([sdf(p + e) - sdf(p - e) for e in eye], axis=1).astype(np.float32))


def right_estimate_normal_one_sided(sdf, p, eps):
    """Forward differences: they lean by half a step, which is within the error that is allowed."""
    d = sdf(p)
    return _unit(np.stack([sdf(p + e) - d for e in eps * np.eye(3)], axis=-1))


def right_estimate_normal_guarded_differences(sdf, p, eps):
    """Differences that are not divided by the step, kept from a division by 0."""
    gradient = np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1)
    return gradient / (np.linalg.norm(gradient, axis=-1, keepdims=True) + 1e-8)


def right_estimate_normal_richardson(sdf, p, eps):
    """Fourth order: eight differences."""
    near, far = (np.stack([sdf(p + e) - sdf(p - e) for e in s * eps * np.eye(3)], axis=1) for s in (0.5, 1))
    return _unit(8 * near - far)


def right_estimate_normal_guarded(sdf, p, eps):
    """Divided by the step and kept from a division by 0."""
    gradient = np.stack([(sdf(p + e) - sdf(p - e)) / (2 * eps) for e in eps * np.eye(3)], axis=-1)
    return gradient / (np.linalg.norm(gradient, axis=-1, keepdims=True) + 1e-8)


def right_estimate_normal_turned_axes(sdf, p, eps):
    """Central differences along other axes."""
    axes = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    return _unit(sum(a * (sdf(p + eps * a) - sdf(p - eps * a))[:, None] for a in axes))


def wrong_estimate_normal_inward(sdf, p, eps):
    """Points into the shape."""
    return _unit(np.stack([sdf(p - e) - sdf(p + e) for e in eps * np.eye(3)], axis=-1))


def wrong_estimate_normal_not_unit(sdf, p, eps):
    """The gradient as it is: short where the field is no exact distance."""
    return np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1) / (2 * eps)


def wrong_estimate_normal_differences(sdf, p, eps):
    """Differences, neither divided nor normalised."""
    return np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1)


def wrong_estimate_normal_one_sided_wide(sdf, p, eps):
    """One-sided with ten times the step: leans by five steps."""
    d = sdf(p)
    return _unit(np.stack([sdf(p + 10 * e) - d for e in eps * np.eye(3)], axis=-1))


def wrong_estimate_normal_zy_swapped(sdf, p, eps):
    """y and z change places."""
    return _unit(np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1))[:, [0, 2, 1]]


def wrong_estimate_normal_position(sdf, p, eps):
    """The direction from the origin: right for one sphere only."""
    return _unit(p)


def wrong_estimate_normal_normalised_over_points(sdf, p, eps):
    """Normalised over the points instead of the axes."""
    g = np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1)
    return g / np.linalg.norm(g, axis=0)


def wrong_estimate_normal_corner_sign(sdf, p, eps):
    """One corner of the tetrahedron is wrong."""
    corners = CORNERS * [[1, 1, 1], [1, 1, 1], [1, 1, 1], [1, 1, -1]]
    return _unit(sum(k * sdf(p + eps * k)[:, None] for k in corners))


def wrong_estimate_normal_diagonal_only(sdf, p, eps):
    """The same step along all axes at once."""
    d = sdf(p + eps) - sdf(p - eps)
    return _unit(np.stack([d, d, d], axis=-1))


def wrong_estimate_normal_y_missing(sdf, p, eps):
    """One axis is left out."""
    return _unit(
        np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1) * [1, 0, 1] + [0, 1e-9, 0]
    )


def wrong_estimate_normal_largest_is_one(sdf, p, eps):
    """Divided by the largest component."""
    g = np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1)
    return g / np.abs(g).max(axis=-1, keepdims=True)


def wrong_estimate_normal_zero(sdf, p, eps):
    """Nothing."""
    return np.zeros_like(p)


# 1.7 --------------------------------------------------------------------------------------------------------------
def right_sphere_trace_loop(sdf, origin, direction, t_max, eps, max_steps):
    """A Python loop over the rays; lists."""
    ts, hits = [], []
    for o, d in zip(origin, direction, strict=True):
        t, found = 0.0, False
        for _ in range(max_steps):
            if t > t_max:
                break
            h = float(sdf((o + t * d)[None])[0])
            if h < eps:
                found = True
                break
            t += h
        ts.append(t if found else float("inf"))
        hits.append(found)
    return [ts, hits]


def right_sphere_trace_masks(sdf, origin, direction, t_max, eps, max_steps):
    """Boolean masks instead of indices; float32 results."""
    t = np.zeros(len(origin))
    hit, alive = np.zeros(len(origin), bool), np.ones(len(origin), bool)
    for _ in range(max_steps):
        if not alive.any():
            break
        d = sdf(origin[alive] + t[alive, None] * direction[alive])
        near = np.zeros_like(hit)
        near[alive] = d < eps
        hit |= near
        t[alive] += np.where(d < eps, 0, d)
        alive &= ~near & (t <= t_max)
    return np.where(hit, t, np.inf).astype(np.float32), hit


def right_sphere_trace_over_relaxed(sdf, origin, direction, t_max, eps, max_steps, omega=1.2):
    """Steps 1.2 times as long; where two balls do not touch, back, and plain from there."""
    count = len(origin)
    t, step, last, relax = np.zeros(count), np.zeros(count), np.zeros(count), np.full(count, omega)
    hit, alive = np.zeros(count, bool), np.arange(count)
    for _ in range(max_steps):
        if alive.size == 0:
            break
        h = sdf(origin[alive] + t[alive, None] * direction[alive])
        apart = (relax[alive] > 1) & ((h < 0) | (last[alive] + h < step[alive])) & (step[alive] > 0)
        found = ~apart & (h < eps)
        hit[alive[found]] = True
        back = alive[apart]
        t[back] += last[back] - step[back]
        step[back], relax[back] = last[back], 1.0
        on = alive[~apart & ~found]
        last[on] = h[~apart & ~found]
        step[on] = last[on] * relax[on]
        t[on] += step[on]
        alive = alive[~found & (t[alive] <= t_max)]
    return np.where(hit, t, np.inf), hit


def right_sphere_trace_secant(sdf, origin, direction, t_max, eps, max_steps):
    """The last step ends where the line through the last two distances meets 0."""
    count = len(origin)
    t, last, hit = np.zeros(count), np.zeros(count), np.zeros(count, bool)
    alive = np.arange(count)
    for _ in range(max_steps):
        if alive.size == 0:
            break
        h = sdf(origin[alive] + t[alive, None] * direction[alive])
        found = h < eps
        here = alive[found]
        hit[here] = True
        slope = (last[here] - h[found]) / np.maximum(last[here], 1e-12)
        t[here] += np.where(last[here] > 0, h[found] / np.maximum(slope, 0.2), 0)
        alive = alive[~found]
        last[alive] = h[~found]
        t[alive] += last[alive]
        alive = alive[t[alive] <= t_max]
    return np.where(hit, t, np.inf), hit


def right_sphere_trace_auto_relaxed(sdf, origin, direction, t_max, eps, max_steps):
    """Steps as long as the slope of the distance promises, with a way back."""
    count = len(origin)
    t, r = np.zeros(count), np.asarray(sdf(origin), float)
    hit = r < eps
    m, z = np.full(count, -1.0), r.copy()
    alive = np.flatnonzero(~hit & (t <= t_max))
    for _ in range(max_steps - 1):
        if alive.size == 0:
            break
        ahead = t[alive] + z[alive]
        h = sdf(origin[alive] + ahead[:, None] * direction[alive])
        apart = z[alive] > r[alive] + np.abs(h)
        back, on = alive[apart], alive[~apart]
        m[back], z[back] = -1.0, r[back]
        m[on] = 0.7 * m[on] + 0.3 * (h[~apart] - r[on]) / z[on]
        t[on], r[on] = ahead[~apart], h[~apart]
        z[on] = 2 * r[on] / (1 - np.minimum(m[on], 0.8))
        # too deep after a long step counts only as close as a few eps
        hit[on] = np.abs(r[on]) < eps
        alive = alive[~hit[alive] & (t[alive] <= t_max)]
    hit &= t <= t_max
    return np.where(hit, t, np.inf), hit


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


def wrong_sphere_trace_all_rays(sdf, origin, direction, t_max, eps, max_steps):
    """Evaluates all rays until the last one is done: right values, too much work."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, all_rays=True)


def wrong_sphere_trace_exhausted_is_hit(sdf, origin, direction, t_max, eps, max_steps):
    """A ray that is out of steps is a hit."""
    finish = lambda t, hit, alive: (np.where(hit | alive, t, np.inf), hit | alive)  # noqa: E731
    return _trace(sdf, origin, direction, t_max, eps, max_steps, finish=finish)


def wrong_sphere_trace_misses_at_t_max(sdf, origin, direction, t_max, eps, max_steps):
    """t is t_max where it should be infinite."""
    finish = lambda t, hit, alive: (np.where(hit, t, t_max), hit)  # noqa: E731
    return _trace(sdf, origin, direction, t_max, eps, max_steps, finish=finish)


def wrong_sphere_trace_misses_at_zero(sdf, origin, direction, t_max, eps, max_steps):
    """t is 0 where it should be infinite."""
    finish = lambda t, hit, alive: (np.where(hit, t, 0), hit)  # noqa: E731
    return _trace(sdf, origin, direction, t_max, eps, max_steps, finish=finish)


def wrong_sphere_trace_without_t_max(sdf, origin, direction, t_max, eps, max_steps):
    """t_max is ignored."""
    return _trace(sdf, origin, direction, np.inf, eps, max_steps)


def wrong_sphere_trace_hit_beyond_t_max(sdf, origin, direction, t_max, eps, max_steps):
    """One point beyond t_max is still tested."""
    t, hit = _trace(sdf, origin, direction, np.inf, eps, max_steps)
    return t, hit & (t < 2 * t_max)


def wrong_sphere_trace_eps_ignored(sdf, origin, direction, t_max, eps, max_steps):
    """A fixed precision of 1e-6."""
    return _trace(sdf, origin, direction, t_max, 1e-6, max_steps)


def wrong_sphere_trace_eps_fixed(sdf, origin, direction, t_max, eps, max_steps):
    """A fixed precision of 1e-3."""
    return _trace(sdf, origin, direction, t_max, 1e-3, max_steps)


def wrong_sphere_trace_eps_times_t(sdf, origin, direction, t_max, eps, max_steps):
    """A precision that grows with the way."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, near=lambda h, t: h < eps * t)


def wrong_sphere_trace_abs(sdf, origin, direction, t_max, eps, max_steps):
    """Tests and steps by the unsigned distance: walks out of what it starts in."""
    return _trace(
        sdf, origin, direction, t_max, eps, max_steps, step=np.abs, near=lambda h, t: np.abs(h) < eps
    )


def wrong_sphere_trace_one_step_less(sdf, origin, direction, t_max, eps, max_steps):
    """One evaluation less than allowed."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps - 1)


def wrong_sphere_trace_one_step_more(sdf, origin, direction, t_max, eps, max_steps):
    """One evaluation more than allowed."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps + 1)


def wrong_sphere_trace_fixed_steps(sdf, origin, direction, t_max, eps, max_steps):
    """max_steps is ignored: a hundred steps."""
    return _trace(sdf, origin, direction, t_max, eps, 100)


def wrong_sphere_trace_origin_skipped(sdf, origin, direction, t_max, eps, max_steps):
    """Starts a little off the origin."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, start=1e-3)


def wrong_sphere_trace_half_steps(sdf, origin, direction, t_max, eps, max_steps):
    """A fixed step that may cross a surface."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, step=lambda h: np.full_like(h, 0.1))


def wrong_sphere_trace_double_steps(sdf, origin, direction, t_max, eps, max_steps):
    """Steps twice as long, without a way back."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, step=lambda h: 2 * h)


def wrong_sphere_trace_relaxed_carelessly(sdf, origin, direction, t_max, eps, max_steps):
    """Steps 1.2 times as long, without a way back."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, step=lambda h: 1.2 * h)


def wrong_sphere_trace_short_steps(sdf, origin, direction, t_max, eps, max_steps):
    """Steps half as long as allowed: too much work, and rays that run out of steps."""
    return _trace(sdf, origin, direction, t_max, eps, max_steps, step=lambda h: 0.5 * h)


def wrong_sphere_trace_first_hit_ends_all(sdf, origin, direction, t_max, eps, max_steps):
    """The march ends for all rays as soon as one has hit."""
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


def wrong_sphere_trace_depth(sdf, origin, direction, t_max, eps, max_steps):
    """The way along the middle ray instead of the way along each ray."""
    t, hit = _trace(sdf, origin, direction, t_max, eps, max_steps)
    return t * (direction @ _unit(direction.mean(axis=0))), hit


def wrong_sphere_trace_squared(sdf, origin, direction, t_max, eps, max_steps):
    """Squared distance to the hit."""
    t, hit = _trace(sdf, origin, direction, t_max, eps, max_steps)
    return t**2, hit


def wrong_sphere_trace_inverted(sdf, origin, direction, t_max, eps, max_steps):
    """hit says what missed."""
    t, hit = _trace(sdf, origin, direction, t_max, eps, max_steps)
    return t, ~hit


def wrong_sphere_trace_backwards(sdf, origin, direction, t_max, eps, max_steps):
    """Marches against the direction."""
    return _trace(sdf, origin, -direction, t_max, eps, max_steps)


def wrong_sphere_trace_origin_ignored(sdf, origin, direction, t_max, eps, max_steps):
    """All rays start at 0."""
    return _trace(sdf, 0 * origin, direction, t_max, eps, max_steps)


def wrong_sphere_trace_all_hit(sdf, origin, direction, t_max, eps, max_steps):
    """Every ray hits at once."""
    return np.zeros(len(origin)), np.ones(len(origin), bool)


def wrong_sphere_trace_none_hits(sdf, origin, direction, t_max, eps, max_steps):
    """No ray hits."""
    return np.full(len(origin), np.inf), np.zeros(len(origin), bool)
