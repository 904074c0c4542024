"""The tape against the tree that it is made from, whose values are float64 and come from NumPy."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from framework import sdf
from framework.tape import compiled
from framework.tape_kernels import load_ball, parts_near, values, workspace

ROUNDING = 4e-7  # of the distances involved: half a dozen roundings of float32

LEAVES = {
    "sphere": sdf.sphere((0.3, -0.2, 0.5), 0.7),
    "box": sdf.box((0.3, -0.2, 0.5), (0.4, 0.7, 0.2)),
    "plate": sdf.box((0.3, -0.2, 0.5), (0.4, 0.0, 0.2)),
    "torus": sdf.torus((0.3, -0.2, 0.5), 0.8, 0.25),
    "capsule": sdf.capsule((0.3, -0.2, 0.5), (-0.4, 0.6, 0.1), 0.3),
    "ball-like capsule": sdf.capsule((0.3, -0.2, 0.5), (0.3, -0.2, 0.5), 0.3),
    "plane": sdf.plane((1, 2, -2), 0.4),
}
A, B = LEAVES["sphere"], LEAVES["box"]
OPERATORS = {
    "union": sdf.union(A, B, LEAVES["plane"]),
    "intersection": sdf.intersection(A, B, LEAVES["torus"]),
    "subtraction": sdf.subtraction(A, B),
    "smooth_union": sdf.smooth_union(A, B, 0.3),
    "blend": sdf.blend(A, B, 0.3),
    "union in a subtraction": sdf.subtraction(sdf.box((0, 0, 0), (1, 1, 1)), sdf.union(A, B)),
}


def moved(node):
    return sdf.translate(sdf.scale(sdf.rotate(node, (1, 2, 0.5), 0.8), 1.7), (0.4, -1.0, 0.2))


def random_tree(rng, depth):
    """Any node over any others, places and sizes of about 1."""
    if depth == 0:
        center, size = rng.uniform(-2, 2, 3), rng.uniform(0.1, 0.8, 3)
        return [
            lambda: sdf.sphere(center, size[0]),
            lambda: sdf.box(center, size),
            lambda: sdf.torus(center, size[0] + 0.2, 0.5 * size[1]),
            lambda: sdf.capsule(center, center + rng.normal(size=3), 0.5 * size[0]),
            lambda: sdf.plane(rng.normal(size=3), rng.uniform(-2, 0)),
        ][rng.integers(5)]()
    a, b, c = (random_tree(rng, depth - 1 - rng.integers(2) * (depth > 1)) for _ in range(3))
    return [
        lambda: sdf.union(a, b, c),
        lambda: sdf.intersection(a, sdf.union(b, c)),
        lambda: sdf.subtraction(a, b),
        lambda: sdf.smooth_union(a, b, rng.uniform(0.05, 1.0)),
        lambda: sdf.blend(a, b, rng.uniform()),
        lambda: sdf.union(a, sdf.rotate(b, rng.normal(size=3), rng.uniform(-3, 3))),
        lambda: sdf.union(a, sdf.scale(sdf.translate(b, rng.uniform(-1, 1, 3)), rng.uniform(0.3, 2.0))),
    ][rng.integers(7)]()


def points(rng, count=1000, extent=4.0):
    return rng.uniform(-extent, extent, (count, 3))


@pytest.mark.parametrize("place", [lambda node: node, moved], ids=["as it is", "moved"])
@pytest.mark.parametrize("node", [*LEAVES.values(), *OPERATORS.values()], ids=[*LEAVES, *OPERATORS])
def test_each_node_has_the_values_of_the_tree(node, place):
    p, node = points(np.random.default_rng(1)), place(node)
    assert np.abs(compiled(node)(p) - node(p)).max() < ROUNDING * 10


@pytest.mark.parametrize("seed", range(40))
def test_random_trees_have_the_values_of_the_tree(seed):
    rng = np.random.default_rng(seed)
    node, p = random_tree(rng, 3), points(rng)
    # Scales of up to 2, three deep, stretch roundings with everything else.
    assert np.abs(compiled(node)(p) - node(p)).max() < ROUNDING * 40


def strewn(count, rng):
    return sdf.union(*(sdf.sphere(c, 0.05) for c in rng.uniform(-3, 3, (count, 3))), sdf.plane((0, 1, 0), -3))


@pytest.mark.parametrize("radius", [0.0, 0.01, 0.3, 2.0])
@pytest.mark.parametrize("seed", range(8))
def test_what_pruning_keeps_has_the_same_values_all_over_the_ball(seed, radius):
    rng = np.random.default_rng(seed)
    node = sdf.union(random_tree(rng, 4), strewn(30, rng))
    tape, middle = compiled(node), rng.uniform(-2, 2, 3)
    offsets = rng.normal(size=(256, 3))
    offsets *= radius * rng.uniform(0, 1, (256, 1)) / np.linalg.norm(offsets, axis=1, keepdims=True)
    x, y, z = np.ascontiguousarray(offsets.T, dtype=np.float32)
    work = workspace(tape.op, tape.start, tape.depth)
    length = load_ball(tape.arrays, *middle, radius, work)
    values(work[5], work[6], length, x, y, z, 256, work[7])
    assert np.abs(work[7][0, 0] - node(middle + offsets)).max() < ROUNDING * 40
    assert length < len(tape.op) + len(tape.start) or radius > 0.3


def test_a_small_ball_in_a_chain_of_smooth_unions_needs_few_of_its_instructions():
    rng = np.random.default_rng(3)
    node = sdf.sphere((0, 0, 0), 0.1)
    for center in rng.uniform(-3, 3, (200, 3)):
        node = sdf.smooth_union(node, sdf.sphere(center, 0.1), 0.2)
    tape = compiled(node)
    work = workspace(tape.op, tape.start, tape.depth)
    assert load_ball(tape.arrays, 1.0, 1.0, 1.0, 0.01, work) < len(tape.op) / 10


@pytest.mark.parametrize("count", [1, 2, 3, 7, 1000])
def test_the_parts_near_a_ball_are_those_that_can_be_the_smallest_in_it(count):
    rng = np.random.default_rng(count)
    tape = compiled(strewn(count, rng))
    work = workspace(tape.op, tape.start, tape.depth)
    for middle in rng.uniform(-3, 3, (20, 3)):
        found = work[3][: parts_near(tape.arrays, *middle, 0.1, work)]
        distance = np.concatenate(
            [[middle[1] + 3], np.linalg.norm(tape.number[1:, :3] - middle, axis=1) - 0.05]
        )
        assert_array_equal(np.sort(found), np.flatnonzero(distance <= distance.min() + 0.2))


def test_no_part_is_nearer_than_its_box():
    for seed in range(40):
        rng = np.random.default_rng(seed)
        node, p = random_tree(rng, 2), points(rng, 2000, 8.0)
        tape = compiled(node)
        low, high = tape.box[:, None, :3], tape.box[:, None, 3:]
        away = np.linalg.norm(np.maximum(np.maximum(low - p, p - high), 0.0), axis=-1).min(axis=0)
        assert (node(p) >= away - 1e-9)[away > 0].all()


def test_far_from_the_origin_no_digits_are_lost():
    away = np.array([1e6, -2e6, 5e5])
    near, far = moved(OPERATORS["union"]), sdf.translate(moved(OPERATORS["union"]), away)
    p = points(np.random.default_rng(0))
    assert np.abs(compiled(far)(p + away) - near(p)).max() < 1e-5  # float64 itself rounds 2e6 to 2e-10


def test_transforms_leave_no_instructions():
    node = moved(moved(sdf.union(moved(A), moved(sdf.smooth_union(A, B, 0.2)))))
    assert len(compiled(node).op) == 1 + 3


def test_a_point_that_is_not_finite_spoils_no_other():
    p = points(np.random.default_rng(0), 100)
    p[17] = np.nan, 0.0, np.inf
    value = compiled(A)(p)
    assert not np.isfinite(value[17])
    assert np.abs(np.delete(value, 17) - A(np.delete(p, 17, axis=0))).max() < ROUNDING * 10


def test_shapes_follow_the_points():
    assert compiled(A)(np.zeros((2, 5, 3))).shape == (2, 5)
    assert compiled(A)(np.zeros((0, 3))).shape == (0,)
    assert np.ndim(compiled(A)(np.zeros(3))) == 0


def test_a_tape_is_made_once_and_goes_with_its_field():
    from framework import tape

    node = sdf.sphere((1, 2, 3), 0.5)
    assert compiled(node) is compiled(node)
    key = id(node)
    del node
    assert key not in tape._TAPES


def test_what_cannot_be_compiled_is_named():
    with pytest.raises(ValueError, match="got function; a field made by"):
        compiled(lambda p: p[..., 0])
