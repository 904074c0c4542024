"""Right answers to tasks 1.1 to 1.7, each in another way, named `FUNCTION_way`."""

import numpy as np


# 1.1 --------------------------------------------------------------------------------------------------------------
def sdf_sphere_loop(p, center, radius):
    """A Python loop over the points that keeps any leading shape."""
    points = np.reshape(p, (-1, 3))
    out = [sum((a - b) ** 2 for a, b in zip(q, center, strict=True)) ** 0.5 - radius for q in points]
    return np.reshape(out, np.shape(p)[:-1])


def sdf_sphere_float32(p, center, radius):
    """Computed in float32 throughout."""
    q = np.asarray(p, np.float32) - np.asarray(center, np.float32)
    return np.sqrt((q * q).sum(axis=-1, dtype=np.float32)) - np.float32(radius)


def sdf_sphere_lists(p, center, radius):
    """Nested lists instead of arrays."""
    return (np.sqrt(np.einsum("...i,...i", np.subtract(p, center), np.subtract(p, center))) - radius).tolist()


def sdf_sphere_by_components(p, center, radius):
    """Coordinate by coordinate."""
    x, y, z = np.moveaxis(np.asarray(p) - center, -1, 0)
    return np.hypot(np.hypot(x, y), z) - radius


# 1.2 --------------------------------------------------------------------------------------------------------------
def sdf_box_loop(p, center, half_size):
    """A Python loop over the points that keeps any leading shape."""

    def one(q):
        d = [abs(q[i] - center[i]) - half_size[i] for i in range(3)]
        if max(d) <= 0:
            return max(d)
        return sum(max(v, 0.0) ** 2 for v in d) ** 0.5

    return np.array([one(q) for q in np.reshape(p, (-1, 3))]).reshape(np.shape(p)[:-1])


def sdf_box_nearest_point(p, center, half_size):
    """The way to the nearest point of the box; inside, the way to each of the six faces."""
    low, high = np.subtract(center, half_size), np.add(center, half_size)
    outside = np.linalg.norm(p - np.clip(p, low, high), axis=-1)
    faces = np.concatenate([p - low, high - p], axis=-1).min(axis=-1)
    return np.where(faces > 0, -faces, outside)


def sdf_box_float32(p, center, half_size):
    """Computed in float32 throughout."""
    q = np.abs(np.float32(p) - np.float32(center)) - np.float32(half_size)
    return np.sqrt((np.maximum(q, 0) ** 2).sum(-1)) + np.minimum(q.max(-1), 0)


def sdf_box_lists(p, center, half_size):
    """Nested lists instead of arrays."""
    q = np.abs(np.subtract(p, center)) - half_size
    return (np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)).tolist()


# 1.3 --------------------------------------------------------------------------------------------------------------
def sdf_torus_loop(p, center, major_radius, minor_radius):
    """A Python loop over the points that keeps any leading shape."""
    out = []
    for x, y, z in np.reshape(np.subtract(p, center), (-1, 3)):
        out.append((((x * x + z * z) ** 0.5 - major_radius) ** 2 + y * y) ** 0.5 - minor_radius)
    return np.reshape(out, np.shape(p)[:-1])


def sdf_torus_nearest_point(p, center, major_radius, minor_radius):
    """The way to the nearest point of the ring, found by its angle."""
    q = np.subtract(p, center)
    turn = np.arctan2(q[..., 2], q[..., 0])
    ring = major_radius * np.stack([np.cos(turn), np.zeros_like(turn), np.sin(turn)], axis=-1)
    return np.linalg.norm(q - ring, axis=-1) - minor_radius


def sdf_torus_float32(p, center, major_radius, minor_radius):
    """Computed in float32 throughout."""
    q = np.float32(p) - np.float32(center)
    ring = np.sqrt(q[..., 0] ** 2 + q[..., 2] ** 2) - np.float32(major_radius)
    return np.sqrt(ring**2 + q[..., 1] ** 2) - np.float32(minor_radius)


def sdf_torus_lists(p, center, major_radius, minor_radius):
    """Nested lists instead of arrays; the law of cosines."""
    q = np.subtract(p, center)
    square = (q**2).sum(-1) + major_radius**2 - 2 * major_radius * np.hypot(q[..., 0], q[..., 2])
    return (np.sqrt(np.maximum(square, 0)) - minor_radius).tolist()


# 1.4 --------------------------------------------------------------------------------------------------------------
def blend_loop(d1, d2, t):
    """A Python loop over the values that keeps any leading shape."""
    d1, d2, t = np.broadcast_arrays(d1, d2, t)
    return np.array([(1 - c) * a + c * b for a, b, c in zip(d1.flat, d2.flat, t.flat, strict=True)]).reshape(
        d1.shape
    )


def blend_from_the_first(d1, d2, t):
    """The first distance and a part of the difference."""
    return d1 + t * (d2 - d1)


def blend_float32(d1, d2, t):
    """Computed in float32 throughout."""
    return np.float32(d1) * (np.float32(1) - np.float32(t)) + np.float32(d2) * np.float32(t)


def blend_lists(d1, d2, t):
    """Nested lists instead of arrays."""
    return (np.multiply(d1, np.subtract(1, t)) + np.multiply(d2, t)).tolist()


def blend_bounded(d1, d2, t):
    """t is kept within [0, 1], where it is anyway."""
    t = np.clip(t, 0, 1)
    return (1 - t) * d1 + t * d2


# 1.5 --------------------------------------------------------------------------------------------------------------
def smooth_union_mix(d1, d2, k):
    """The same curve written as a mix with a clamped weight."""
    h = np.clip(0.5 + 0.5 * (d2 - d1) / k, 0, 1)
    return d2 + (d1 - d2) * h - k * h * (1 - h)


def smooth_union_loop(d1, d2, k):
    """A Python loop over the values that keeps any leading shape."""
    out = []
    d1, d2 = np.broadcast_arrays(d1, d2)
    for a, b in zip(d1.flat, d2.flat, strict=True):
        h = max(k - abs(a - b), 0.0) / k
        out.append(min(a, b) - h * h * k / 4)
    return np.reshape(out, d1.shape)


def smooth_union_float32(d1, d2, k):
    """Computed in float32 throughout."""
    d1, d2, k = np.float32(d1), np.float32(d2), np.float32(k)
    return np.minimum(d1, d2) - np.maximum(k - np.abs(d1 - d2), np.float32(0)) ** 2 / (np.float32(4) * k)


def smooth_union_lists(d1, d2, k):
    """Nested lists instead of arrays; the three cases apart."""
    middle = ((d1 + d2) - (k * k + (d1 - d2) ** 2) / (2 * k)) / 2
    return np.where(np.abs(d1 - d2) < k, middle, np.minimum(d1, d2)).tolist()


# 1.6 --------------------------------------------------------------------------------------------------------------
CORNERS = np.array([(1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1)], float)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def estimate_normal_tetrahedron(sdf, p, eps):
    """Four evaluations."""
    return unit(sum(k * sdf(p + eps * k)[:, None] for k in CORNERS))


def estimate_normal_loop(sdf, p, eps):
    """A Python loop over points and axes; a list of tuples."""
    normals = []
    for q in p:
        g = [float(sdf((q + e)[None])[0] - sdf((q - e)[None])[0]) for e in eps * np.eye(3)]
        length = sum(v * v for v in g) ** 0.5
        normals.append(tuple(v / length for v in g))
    return normals


def estimate_normal_float32(sdf, p, eps):
    """Central differences, results in float32."""
    return unit(np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=1)).astype(np.float32)


def estimate_normal_single_precision(sdf, p, eps):
    """Points and differences in float32."""
    p, eye = p.astype(np.float32), np.float32(eps) * np.eye(3, dtype=np.float32)
    return unit(np.stack([sdf(p + e) - sdf(p - e) for e in eye], axis=1).astype(np.float32))


def estimate_normal_one_sided(sdf, p, eps):
    """Forward differences: they lean by half a step, which is within the error that is allowed."""
    d = sdf(p)
    return unit(np.stack([sdf(p + e) - d for e in eps * np.eye(3)], axis=-1))


def estimate_normal_guarded_differences(sdf, p, eps):
    """Differences that are not divided by the step, kept from a division by 0."""
    gradient = np.stack([sdf(p + e) - sdf(p - e) for e in eps * np.eye(3)], axis=-1)
    return gradient / (np.linalg.norm(gradient, axis=-1, keepdims=True) + 1e-8)


def estimate_normal_richardson(sdf, p, eps):
    """Fourth order: eight differences."""
    near, far = (np.stack([sdf(p + e) - sdf(p - e) for e in s * eps * np.eye(3)], axis=1) for s in (0.5, 1))
    return unit(8 * near - far)


def estimate_normal_guarded(sdf, p, eps):
    """Divided by the step and kept from a division by 0."""
    gradient = np.stack([(sdf(p + e) - sdf(p - e)) / (2 * eps) for e in eps * np.eye(3)], axis=-1)
    return gradient / (np.linalg.norm(gradient, axis=-1, keepdims=True) + 1e-8)


def estimate_normal_turned_axes(sdf, p, eps):
    """Central differences along other axes."""
    axes = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    return unit(sum(a * (sdf(p + eps * a) - sdf(p - eps * a))[:, None] for a in axes))


# 1.7 --------------------------------------------------------------------------------------------------------------
def sphere_trace_loop(sdf, origin, direction, t_max, eps, max_steps):
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


def sphere_trace_masks(sdf, origin, direction, t_max, eps, max_steps):
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


def sphere_trace_over_relaxed(sdf, origin, direction, t_max, eps, max_steps, omega=1.2):
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


def sphere_trace_secant(sdf, origin, direction, t_max, eps, max_steps):
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


def sphere_trace_auto_relaxed(sdf, origin, direction, t_max, eps, max_steps):
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
