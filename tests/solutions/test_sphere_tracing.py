"""The reference of sphere_tracing against closed forms, brute force and exact intersections."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from solutions.sphere_tracing import (
    blend,
    estimate_normal,
    sdf_box,
    sdf_sphere,
    sdf_torus,
    smooth_union,
    sphere_trace,
)

CENTER = np.array([0.3, -0.2, 0.5])
HALF_SIZE = np.array([0.9, 0.4, 0.6])


def unit_ball(p):
    return sdf_sphere(p, (0, 0, 0), 1.0)


def points(count, seed=1):
    return np.random.default_rng(seed).uniform(-2.5, 2.5, (count, 3))


SHAPES = {
    "sphere": lambda p: sdf_sphere(p, CENTER, 0.8),
    "box": lambda p: sdf_box(p, CENTER, HALF_SIZE),
    "torus": lambda p: sdf_torus(p, CENTER, 1.1, 0.35),
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
@pytest.mark.parametrize("batch", [(), (0,), (5,), (2, 3)])
def test_a_shape_takes_points_in_any_batch(shape, batch):
    p = np.broadcast_to([0.1, 0.2, 0.3], (*batch, 3))
    assert_allclose(shape(p), np.full(batch, shape(np.array([0.1, 0.2, 0.3]))))


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_distances_grow_by_one_per_unit_almost_everywhere(shape):
    p, h = points(2000), 1e-6
    gradient = np.stack([shape(p + h * e) - shape(p - h * e) for e in np.eye(3)], -1) / (2 * h)
    length = np.linalg.norm(gradient, axis=-1)
    assert np.mean(np.abs(length - 1) > 1e-6) < 0.005  # the rest straddles a crease
    assert length.max() < 1 + 1e-6


def test_the_centre_of_a_sphere_is_its_radius_deep():
    assert sdf_sphere(CENTER, CENTER, 0.8) == -0.8


def test_a_box_agrees_with_the_nearest_point_of_its_faces():
    # Each face is a rectangle: the nearest point on it is p, clamped. The sign comes from the inside test.
    p = points(3000)
    nearest = np.full(len(p), np.inf)
    for axis in range(3):
        for side in (-1, 1):
            q = np.clip(p - CENTER, -HALF_SIZE, HALF_SIZE)
            q[:, axis] = side * HALF_SIZE[axis]
            nearest = np.minimum(nearest, np.linalg.norm(p - CENTER - q, axis=1))
    inside = np.all(np.abs(p - CENTER) < HALF_SIZE, axis=1)
    assert inside.sum() > 20
    assert_allclose(sdf_box(p, CENTER, HALF_SIZE), np.where(inside, -nearest, nearest), atol=1e-14)


def test_a_torus_agrees_with_the_nearest_of_many_balls_along_its_ring():
    p, angle = points(300), np.linspace(0, 2 * np.pi, 4001)
    ring = CENTER + 1.1 * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=-1)
    nearest = np.linalg.norm(p[:, None] - ring, axis=-1).min(axis=1) - 0.35
    assert_allclose(sdf_torus(p, CENTER, 1.1, 0.35), nearest, atol=1e-5)  # balls are 1.7e-3 apart


def test_a_blend_runs_from_the_first_field_to_the_second():
    d1, d2 = np.array([1.0, -2.0]), np.array([[3.0], [0.5]])
    assert_array_equal(blend(d1, d2, 0.0), np.broadcast_to(d1, (2, 2)))
    assert_array_equal(blend(d1, d2, 1.0), np.broadcast_to(d2, (2, 2)))
    assert_allclose(blend(d1, d2, 0.25), 0.75 * d1 + 0.25 * d2)


def test_a_smooth_union_lowers_equal_distances_by_a_quarter_of_k_and_nothing_beyond_k():
    k = 0.6
    assert_allclose(smooth_union(0.7, 0.7, k), 0.7 - k / 4)
    assert smooth_union(0.2, 0.8, k) == 0.2
    assert smooth_union(1.5, 0.2, k) == 0.2


def test_a_smooth_union_is_symmetric_has_no_kink_and_keeps_steps_safe():
    d1, d2, k = np.linspace(-1, 1, 2001), 0.1, 0.5
    value = smooth_union(d1, d2, k)
    assert_array_equal(value, smooth_union(d2, d1, k))
    slope = np.diff(value) / np.diff(d1)
    assert slope.min() >= -1e-9 and slope.max() <= 1 + 1e-9
    assert np.abs(np.diff(slope)).max() < 1.01e-3 / (2 * k)  # the second derivative is 1 / (2 k), no jump


@pytest.mark.parametrize("eps", [1e-2, 1e-4, 1e-6])
def test_normals_of_a_sphere_are_radial_within_the_contract(eps):
    normal = np.random.default_rng(2).normal(size=(500, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    estimated = estimate_normal(SHAPES["sphere"], CENTER + 0.8 * normal, eps)
    assert_allclose(np.linalg.norm(estimated, axis=1), 1, atol=1e-14)
    assert np.abs(estimated - normal).max() < 2 * eps / 0.8 + 1e-9


def test_normals_are_asked_for_in_one_batch_and_no_points_need_none():
    assert estimate_normal(unit_ball, np.zeros((0, 3)), 1e-4).shape == (0, 3)
    assert estimate_normal(unit_ball, np.array([0.0, 2.0, 0.0]), 1e-4).shape == (3,)


def test_a_flat_spot_of_the_field_gives_a_finite_normal():
    assert np.isfinite(estimate_normal(unit_ball, np.zeros((1, 3)), 1e-4)).all()


def trace(sdf, origin, direction, t_max=10.0, eps=1e-5, max_steps=64):
    return sphere_trace(sdf, np.atleast_2d(origin).astype(float), direction, t_max, eps, max_steps)


def test_a_ray_hits_head_on_misses_beside_and_hits_at_zero_from_inside():
    t, hit = trace(unit_ball, [[0, 0, 3], [0, 2, 3], [0, 0, 0.5]], np.array([0.0, 0.0, -1.0]))
    assert_array_equal(t, [2, np.inf, 0])
    assert_array_equal(hit, [True, False, True])


def test_a_hit_beyond_t_max_is_a_miss_and_one_at_t_max_is_none():
    direction = np.array([[0.0, 0.0, -1.0]])
    assert trace(unit_ball, [0, 0, 3], direction, t_max=1.999)[1] == [False]
    assert trace(unit_ball, [0, 0, 3], direction, t_max=2.0)[1] == [True]


def test_a_ray_has_exactly_max_steps_evaluations():
    direction = np.array([[0.0, 0.0, -1.0]])
    assert trace(unit_ball, [0, 0, 3], direction, max_steps=1)[1] == [False]
    assert trace(unit_ball, [0, 0, 3], direction, max_steps=2)[1] == [True]
    assert trace(unit_ball, [0, 0, 0], direction, max_steps=0)[1] == [False]


def test_only_rays_that_still_march_are_evaluated():
    seen = []

    def counted(p):
        seen.append(len(p))
        return unit_ball(p)

    trace(counted, [[0, 0, 3], [0, 0, 0], [0, 30, 3], [0, 1.2, 3]], np.array([0.0, 0.0, -1.0]))
    assert seen[0] == 4  # all visit their origin
    assert seen[1] == 2  # one hit at 0, one left beyond t_max at once
    assert seen[2] == 1  # the head-on ray is done
    assert min(seen) >= 1  # and nobody is asked about no points


def test_no_rays_a_single_ray_and_a_shared_origin_are_fine():
    down = np.array([0.0, -1.0, 0.0])
    assert sphere_trace(unit_ball, np.zeros((0, 3)), down, 10.0, 1e-5, 64)[0].shape == (0,)
    t, hit = sphere_trace(unit_ball, np.array([0.0, 3.0, 0.0]), down, 10.0, 1e-5, 64)
    assert t.shape == hit.shape == () and t == 2
    t, _ = sphere_trace(unit_ball, np.array([0.0, 3.0, 0.0]), np.stack([down, -down]), 10.0, 1e-5, 64)
    assert_array_equal(t, [2, np.inf])


def test_a_field_that_is_not_a_number_is_a_miss():
    t, hit = trace(lambda p: np.full(len(p), np.nan), [0, 0, 3], np.array([[0.0, 0.0, -1.0]]))
    assert t == [np.inf] and hit == [False]


def test_inputs_are_left_alone():
    origin, direction = np.array([[0.0, 0.0, 3.0]]), np.array([[0.0, 0.0, -1.0]])
    sphere_trace(unit_ball, origin, direction, 10.0, 1e-5, 64)
    assert_array_equal(origin, [[0, 0, 3]])
    assert_array_equal(direction, [[0, 0, -1]])


# Exact intersections, all about the origin: the smallest t >= 0, inf where there is none.


def exact_sphere(o, d):
    b, c = np.sum(o * d, axis=1), np.sum(o * o, axis=1) - 1.0
    root = np.sqrt(np.maximum(b * b - c, 0))
    return np.where((b * b > c) & (b < 0), -b - root, np.inf)


def exact_box(o, d):
    near, far = np.sort([(-HALF_SIZE - o) / d, (HALF_SIZE - o) / d], axis=0)
    enter, leave = near.max(axis=1), far.min(axis=1)
    return np.where((enter < leave) & (enter > 0), enter, np.inf)


def exact_plane(o, d):
    t = -o[:, 1] / d[:, 1]
    return np.where(o[:, 1] <= 0, 0.0, np.where(t > 0, t, np.inf))  # below is inside: a hit at 0


def exact_torus(o, d, major=1.1, minor=0.35):
    # (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + z^2): a quartic in t, its roots from the companion matrix.
    b, g = 2 * np.sum(o * d, axis=1), np.sum(o * o, axis=1) + major**2 - minor**2
    flat = [4 * major**2 * np.sum(u[:, ::2] * v[:, ::2], axis=1) for u, v in ((d, d), (o, d), (o, o))]
    quartic = [2 * b, b * b + 2 * g - flat[0], 2 * b * g - 2 * flat[1], g * g - flat[2]]
    companion = np.zeros((len(o), 4, 4))
    companion[:, [1, 2, 3], [0, 1, 2]] = 1.0
    companion[:, 0] = -np.stack(quartic, axis=1)
    roots = np.linalg.eigvals(companion)
    return np.where((np.abs(roots.imag) < 1e-7) & (roots.real > 0), roots.real, np.inf).min(axis=1)


EXACT = {
    "sphere": (unit_ball, exact_sphere),
    "box": (lambda p: sdf_box(p, (0, 0, 0), HALF_SIZE), exact_box),
    "plane": (lambda p: p[:, 1], exact_plane),
    "torus": (lambda p: sdf_torus(p, (0, 0, 0), 1.1, 0.35), exact_torus),
}


@pytest.mark.parametrize(("sdf", "exact"), EXACT.values(), ids=EXACT)
def test_hits_agree_with_exact_intersections(sdf, exact):
    rng = np.random.default_rng(5)
    origin = rng.normal(size=(20000, 3))
    origin *= 4 / np.linalg.norm(origin, axis=1, keepdims=True)
    direction = rng.uniform(-1.5, 1.5, (20000, 3)) - origin
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)

    expected = exact(origin, direction)
    expected[expected > 20] = np.inf
    t, hit = sphere_trace(sdf, origin, direction, t_max=20.0, eps=1e-5, max_steps=512)

    differing = np.mean(hit != np.isfinite(expected))
    both = hit & np.isfinite(expected)
    away = both & (expected > 0)
    error = np.quantile(np.abs(t[away] - expected[away]) / expected[away], 0.999)
    print(f"{away.sum()} hits, masks differ on {differing:.4%}, error of t at 99.9 %: {error:.1e}")
    assert away.sum() > 2000
    assert_array_equal(t[both & (expected == 0)], 0)
    assert differing < 1e-3
    assert error < 1e-3
