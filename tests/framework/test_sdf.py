import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from framework import sdf

CENTER = np.array([0.3, -0.2, 0.5])


def unit_vectors(count):
    """Evenly spread: a spiral of equal areas."""
    y = 1 - (2 * np.arange(count) + 1) / count
    turn = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    r = np.sqrt(1 - y * y)
    return np.stack([r * np.cos(turn), y, r * np.sin(turn)], axis=1)


def box_surface(half, per_side=60):
    u, v = (g.ravel() for g in np.meshgrid(*[np.linspace(-1, 1, per_side)] * 2))
    faces = [np.insert(np.stack([u, v], 1), axis, side, axis=1) for axis in range(3) for side in (-1, 1)]
    return np.concatenate(faces) * half


def torus_surface(major, minor, per_turn=150):
    u, v = (g.ravel() for g in np.meshgrid(*[np.linspace(0, 2 * np.pi, per_turn, endpoint=False)] * 2))
    ring = major + minor * np.cos(v)
    return np.stack([ring * np.cos(u), minor * np.sin(v), ring * np.sin(u)], axis=1)


def capsule_surface(a, b, radius):
    """Half a ball at each end, and circles along the tube between them."""
    axis = (b - a) / np.linalg.norm(b - a)
    ball = unit_vectors(20000)
    side = np.linalg.svd(axis[None])[2][1:]
    turn = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1) @ side
    tube = (np.linspace(a, b, 60)[:, None] + radius * circle).reshape(-1, 3)
    return np.concatenate([a + radius * ball[ball @ axis < 0], b + radius * ball[ball @ axis > 0], tube])


HALF, A, B = np.array([0.8, 0.5, 0.3]), np.array([-0.5, 0.1, 0.2]), np.array([0.6, 0.4, -0.3])
# A primitive, samples of its surface, a membership test that does not use distances, and its box.
PRIMITIVES = {
    "sphere": (
        sdf.sphere(CENTER, 0.7),
        CENTER + 0.7 * unit_vectors(20000),
        lambda p: ((p - CENTER) ** 2).sum(axis=1) < 0.49,
        (CENTER - 0.7, CENTER + 0.7),
    ),
    "box": (
        sdf.box(CENTER, HALF),
        CENTER + box_surface(HALF),
        lambda p: (np.abs(p - CENTER) < HALF).all(axis=1),
        (CENTER - HALF, CENTER + HALF),
    ),
    "torus": (
        sdf.torus(CENTER, 0.9, 0.25),
        CENTER + torus_surface(0.9, 0.25),
        lambda p: (
            (((p - CENTER) ** 2).sum(axis=1) + 0.9**2 - 0.25**2) ** 2
            < 4 * 0.9**2 * ((p - CENTER)[:, [0, 2]] ** 2).sum(axis=1)
        ),
        (CENTER - [1.15, 0.25, 1.15], CENTER + [1.15, 0.25, 1.15]),
    ),
    "capsule": (
        sdf.capsule(A, B, 0.3),
        capsule_surface(A, B, 0.3),
        lambda p: np.linalg.norm(p[:, None] - np.linspace(A, B, 2000), axis=-1).min(axis=1) < 0.3,
        (np.minimum(A, B) - 0.3, np.maximum(A, B) + 0.3),
    ),
}


def random_points(count, seed=0, extent=2.0):
    return np.random.default_rng(seed).uniform(-extent, extent, (count, 3))


def random_tree(rng, depth):
    def point():
        return rng.uniform(-0.8, 0.8, 3)

    if depth == 0:
        return [
            lambda: sdf.sphere(point(), rng.uniform(0.1, 0.6)),
            lambda: sdf.box(point(), rng.uniform(0.1, 0.6, 3)),
            lambda: sdf.torus(point(), rng.uniform(0.3, 0.6), rng.uniform(0.05, 0.25)),
            lambda: sdf.capsule(point(), point(), rng.uniform(0.1, 0.3)),
            lambda: sdf.plane(rng.normal(size=3), rng.uniform(-0.5, 0.5)),
        ][rng.integers(5)]()
    a, b = random_tree(rng, depth - 1), random_tree(rng, rng.integers(depth))
    return [
        lambda: sdf.union(a, b),
        lambda: sdf.smooth_union(a, b, rng.uniform(0.05, 1.0)),
        lambda: sdf.subtraction(a, b),
        lambda: sdf.intersection(a, b),
        lambda: sdf.blend(a, b, rng.uniform()),
        lambda: sdf.translate(a, point()),
        lambda: sdf.rotate(a, rng.normal(size=3), rng.uniform(-4, 4)),
        lambda: sdf.scale(a, rng.uniform(0.3, 2)),
    ][rng.integers(8)]()


TREES = [random_tree(np.random.default_rng(seed), 3) for seed in range(40)]


@pytest.mark.parametrize("name", PRIMITIVES)
def test_primitives_are_exact_against_samples_of_their_surface(name):
    field, surface, inside, _ = PRIMITIVES[name]
    p = random_points(150, extent=1.3)
    squared = (p**2).sum(1)[:, None] + (surface**2).sum(1) - 2 * p @ surface.T
    nearest = np.sqrt(np.maximum(squared.min(axis=1), 0))
    expected = np.where(inside(p), -nearest, nearest)
    # The nearest sample is farther than the surface by up to spacing (0.03) squared over distance.
    assert_allclose(field(p), expected, atol=0.02)
    assert np.median(np.abs(field(p) - expected)) < 2e-3
    assert_allclose(field(surface), 0, atol=1e-14)
    assert (inside(p) == (field(p) < 0)).all() and inside(p).any()


@pytest.mark.parametrize("name", PRIMITIVES)
def test_primitives_have_a_gradient_of_length_one(name):
    field = PRIMITIVES[name][0]
    p, step = random_points(4000, seed=1), 1e-6 * np.eye(3)
    gradient = np.stack([field(p + s) - field(p - s) for s in step], axis=-1) / 2e-6
    # All but the few points where a medial surface lies between the two samples.
    assert np.mean(np.abs(np.linalg.norm(gradient, axis=1) - 1) < 1e-6) > 0.999


def test_a_plane_is_the_height_above_it():
    field = sdf.plane([0, 0, 5], 2.0)  # the offset counts along the unit normal
    assert_array_equal(field([[7, 8, 2], [0, 0, 5], [0, 0, -1]]), [0, 3, -3])
    assert_allclose(sdf.plane([1, 1, 0], 0)([1, 1, 9]), np.sqrt(2))


def test_values_known_by_hand():
    assert sdf.box([0, 0, 0], [1, 2, 3])([0, 0, 0]) == -1  # the nearest face, not the corner
    assert sdf.box([0, 0, 0], [1, 2, 3])([4, 6, 3]) == 5  # the edge: 3, 4, 0 away
    assert sdf.torus([0, 0, 0], 2, 0.5)([0, 0, 0]) == 1.5
    assert sdf.torus([0, 0, 0], 2, 0.5)([2, 1, 0]) == 0.5
    assert sdf.capsule([0, 0, 0], [0, 2, 0], 0.5)([1, 1, 0]) == 0.5
    assert sdf.capsule([1, 1, 1], [1, 1, 1], 0.5)([1, 1, 3]) == 1.5  # no length: a ball


@pytest.mark.parametrize("size", [1e-4, 1e-2, 1.0, 1e3, 1e5])
def test_relative_accuracy_does_not_depend_on_scale(size):
    p = random_points(500, seed=2)
    for unit, scaled in [
        (sdf.sphere(CENTER, 0.7), sdf.sphere(CENTER * size, 0.7 * size)),
        (sdf.box(CENTER, HALF), sdf.box(CENTER * size, HALF * size)),
        (sdf.torus(CENTER, 0.9, 0.25), sdf.torus(CENTER * size, 0.9 * size, 0.25 * size)),
        (sdf.capsule(A, B, 0.3), sdf.capsule(A * size, B * size, 0.3 * size)),
        (sdf.plane([1, 2, 3], 0.4), sdf.plane([1, 2, 3], 0.4 * size)),
        (TREES[3], sdf.scale(TREES[3], size)),
    ]:
        assert_allclose(scaled(p * size) / size, unit(p), atol=2e-15 * 4)


@pytest.mark.parametrize("index", range(len(TREES)))
def test_every_tree_is_lipschitz_with_constant_one(index):
    field = TREES[index]
    p, step = random_points(3000, seed=index), np.random.default_rng(index).normal(size=(3000, 3))
    for size in (1e-4, 0.1, 1.0):
        distance = np.linalg.norm(size * step, axis=1)
        assert (np.abs(field(p + size * step) - field(p)) <= distance * (1 + 1e-9) + 1e-14).all()


@pytest.mark.parametrize("level", [0.0, 0.4])
@pytest.mark.parametrize("index", range(len(TREES)))
def test_bounds_hold_the_whole_solid(index, level):
    field = TREES[index]
    p = random_points(20000, seed=index, extent=4)
    low, high = field.bounds_of_level(level)
    within = ((p >= low) & (p <= high)).all(axis=1)
    assert within[field(p) <= level].all()
    assert (low <= high).all()


@pytest.mark.parametrize("name", PRIMITIVES)
def test_bounds_of_primitives_are_tight(name):
    field, _, _, (low, high) = PRIMITIVES[name]
    assert_allclose(field.bounds, (low, high), rtol=1e-14)


def test_bounds_of_planes_are_half_spaces_where_they_follow_an_axis():
    ground = sdf.plane([0, 1, 0], 0.5)
    assert_array_equal(ground.bounds, ([-np.inf] * 3, [np.inf, 0.5, np.inf]))
    assert_array_equal(sdf.plane([0, 0, -2], 1).bounds, ([-np.inf, -np.inf, -1], [np.inf] * 3))
    assert_array_equal(sdf.plane([1, 1, 0], 0).bounds, ([-np.inf] * 3, [np.inf] * 3))
    assert_array_equal(
        sdf.rotate(ground, [0, 0, 1], np.pi / 2).bounds, ([-0.5] + [-np.inf] * 2, [np.inf] * 3)
    )
    assert_allclose(sdf.intersection(ground, sdf.sphere([0, 0, 0], 1)).bounds, ([-1] * 3, [1, 0.5, 1]))


@pytest.mark.parametrize("factor", [0.25, 1.0, 4.0])
def test_bounds_of_a_smooth_union_make_room_for_the_fill(factor):
    ball = sdf.scale(sdf.sphere([0, 0, 0], 1 / factor), factor)  # radius 1, whatever the factor
    fused = sdf.smooth_union(ball, ball, 0.8)  # the fill is k / 4 all over: a ball of radius 1.2
    assert_allclose(fused([1.2, 0, 0]), 0, atol=1e-15)
    assert_allclose(fused.bounds, ([-1.2] * 3, [1.2] * 3), rtol=1e-15)


def test_operators_combine_the_two_values():
    a, b = sdf.sphere([0, 0, 0], 1), sdf.box([0.5, 0, 0], [0.6, 0.7, 0.8])
    p = random_points(1000, seed=3)
    da, db = a(p), b(p)
    assert_array_equal(sdf.union(a, b)(p), np.minimum(da, db))
    assert_array_equal(sdf.intersection(a, b)(p), np.maximum(da, db))
    assert_array_equal(sdf.subtraction(a, b)(p), np.maximum(da, -db))
    assert_allclose(sdf.blend(a, b, 0.25)(p), 0.75 * da + 0.25 * db, rtol=1e-14)
    k = 0.5
    expected = np.minimum(da, db) - np.maximum(k - np.abs(da - db), 0) ** 2 / (4 * k)
    assert_allclose(sdf.smooth_union(a, b, k)(p), expected, atol=1e-15)
    assert_allclose(sdf.smooth_union(a, a, k)(p), da - k / 4, atol=1e-15)


def test_subtraction_takes_the_second_from_the_first():
    hollow = sdf.subtraction(sdf.sphere([0, 0, 0], 1), sdf.sphere([0.5, 0, 0], 0.4))
    assert_array_equal(np.sign(hollow([[0.5, 0, 0], [-0.5, 0, 0], [2, 0, 0]])), [1, -1, 1])


@pytest.mark.parametrize(
    ("axis", "moved"), [([0, 0, 1], [0, 1, 0]), ([0, 1, 0], [0, 0, -1]), ([0, 0, -2], [0, -1, 0])]
)
def test_a_quarter_turn_moves_the_x_axis_counter_clockwise(axis, moved):
    turned = sdf.rotate(sdf.sphere([1, 0, 0], 0.1), axis, np.pi / 2)
    assert turned(moved) == -0.1


def test_rotated_surfaces_follow_the_rotation_matrix():
    node = sdf.rotate(PRIMITIVES["box"][0], [1, 2, -0.5], 0.7)
    assert_allclose(node.matrix @ node.matrix.T, np.eye(3), atol=1e-15)
    assert_allclose(node(PRIMITIVES["box"][1] @ node.matrix.T), 0, atol=1e-14)


def test_translate_and_scale_move_the_surface_with_them():
    ball = sdf.sphere([1, 0, 0], 0.5)
    assert_array_equal(sdf.translate(ball, [0, 2, 0])([1, 2, 0]), -0.5)
    assert_array_equal(sdf.scale(ball, 4)([[4, 0, 0], [4, 2, 0], [4, 5, 0]]), [-2, 0, 3])
