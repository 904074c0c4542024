import json
import pickle
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from framework import sdf
from framework.sdf_primitives import Node

SCENES = Path(__file__).parents[2] / ".." / "shared" / "data" / "scenes"


DESCRIPTION = {
    "about": "text beside the field is left alone",
    "camera": {},
    "union": [
        {"plane": {"normal": [0, 1, 0], "offset": 0}},
        {"torus": {"center": [-2, 0.5, 0], "major_radius": 0.8, "minor_radius": 0.3}},
        {"smooth_union": {"k": 0.3, "of": [{"sphere": {"center": [0, 1, 2], "radius": 0.6}}] * 2}},
        {
            "rotate": {
                "axis": [0, 1, 0],
                "angle": 1,
                "of": [{"box": {"center": [0, 0, 0], "half_size": [1, 1, 1]}}],
            }
        },
        {"capsule": {"a": [-2, 0, 2], "b": [-2, 1, 2], "radius": 0.3}},
    ],
}

BALL, SCENE = sdf.sphere([0.2, 0, 0], 0.7), sdf.load(DESCRIPTION)


def random_points(count, seed=0):
    return np.random.default_rng(seed).uniform(-2, 2, (count, 3))


@pytest.mark.parametrize("shape", [(3,), (0, 3), (5, 3), (2, 0, 3), (2, 4, 3)])
def test_points_come_in_any_shape(shape):
    p = np.random.default_rng(4).normal(size=shape)
    for field in (BALL, SCENE):
        values = field(p)
        assert np.shape(values) == shape[:-1]
        assert_array_equal(field.evaluate(p), values)
        assert_array_equal(values, field(p.reshape(-1, 3)).reshape(shape[:-1]))


def test_large_batches_are_the_same_as_single_points_and_take_little_memory():
    p = random_points(200_000, seed=5)
    scene = sdf.union(*(sdf.sphere(c, 0.1) for c in random_points(50, seed=6)))
    tracemalloc.start()
    values = scene(p)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert_array_equal(values[[0, 16383, 16384, -1]], [scene(q) for q in p[[0, 16383, 16384, -1]]])
    assert peak < values.nbytes + 2e6


def test_float32_integers_and_strided_points_are_taken_and_left_alone():
    p = random_points(50).astype(np.float32)
    kept = p.copy()
    assert_array_equal(SCENE(p), SCENE(p.astype(float)))
    assert_array_equal(p, kept)
    assert_array_equal(SCENE(p[::-2]), SCENE(p)[::-2])
    assert sdf.sphere([0, 0, 0], 1)([2, 0, 0]) == 1


def test_points_that_are_not_finite_spoil_only_themselves():
    p = np.array([[np.nan, 0, 0], [np.inf, 0, 0], [1e200, 1e200, 0], [0, 0, 0]])
    for field in (BALL, SCENE, *SCENE.of):
        assert field(p)[3] == field([0, 0, 0])
    assert np.isnan(sdf.load(DESCRIPTION)(p)[0])


def test_trees_are_immutable_hashable_and_picklable():
    a, b = sdf.load(DESCRIPTION), sdf.load(DESCRIPTION)
    assert a == b and hash(a) == hash(b)
    assert pickle.loads(pickle.dumps(a)) == a
    with pytest.raises(AttributeError):
        sdf.sphere([0, 0, 0], 1).radius = 2
    assert all(isinstance(child, Node) for child in a.children)


def test_unions_built_in_a_loop_stay_flat():
    scene = sdf.sphere([0, 0, 0], 0.1)
    for x in range(1, 2000):
        scene = sdf.union(scene, sdf.sphere([x, 0, 0], 0.1))
    assert len(scene.children) == 2000 and scene([1500, 1, 0]) == 0.9
    assert sdf.union(scene.of[0]) is scene.of[0]


def test_a_description_gives_the_tree_that_it_says(tmp_path):
    expected = sdf.union(
        sdf.plane([0, 1, 0], 0),
        sdf.torus([-2, 0.5, 0], 0.8, 0.3),
        sdf.smooth_union(sdf.sphere([0, 1, 2], 0.6), sdf.sphere([0, 1, 2], 0.6), 0.3),
        sdf.rotate(sdf.box([0, 0, 0], [1, 1, 1]), [0, 1, 0], 1),
        sdf.capsule([-2, 0, 2], [-2, 1, 2], 0.3),
    )
    assert sdf.load(DESCRIPTION) == expected
    (tmp_path / "scene.json").write_text(json.dumps(DESCRIPTION))
    assert sdf.load(tmp_path / "scene.json") == expected
    assert sdf.load(str(tmp_path / "scene.json")) == expected


@pytest.mark.skipif(not SCENES.exists(), reason="the shared scenes are not beside this repository")
def test_the_timing_scene_loads():
    scene = sdf.load(SCENES / "nine.json")
    assert len(scene.of) == 8
    assert_allclose(scene([[0, 1, 0], [0, 5, 0], [-1.4, 0.5, 0]]), [-1, 3, -0.3], atol=1e-12)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: sdf.sphere([0, 0], 1), r"sphere: center has shape \(2,\)"),
        (lambda: sdf.sphere([0, 0, 0], -1), "sphere: radius is -1; a number above 0 is wanted"),
        (lambda: sdf.sphere([0, 0, 0], np.nan), "sphere: radius holds 1 values that are NaN"),
        (lambda: sdf.box([0, 0, 0], [1, -1, 1]), "box: half_size"),
        (lambda: sdf.plane([0, 0, 0], 1), "plane: normal is zero; a direction is wanted"),
        (lambda: sdf.union(), "union: no fields are given"),
        (lambda: sdf.union(lambda p: p), "union: got <function"),
        (lambda: sdf.smooth_union(BALL, SCENE, 0), "smooth_union: k is 0"),
        (lambda: sdf.blend(BALL, SCENE, 1.5), "blend: t is 1.5; a number from 0 to 1"),
        (lambda: sdf.rotate(BALL, [0, 0, 0], 1), "rotate: axis is zero"),
        (lambda: sdf.scale(BALL, 0), "scale: factor is 0"),
        (lambda: BALL([[1, 2]]), r"points have shape \(1, 2\)"),
        (lambda: sdf.load({"camera": {}}), "scene describes 0 fields"),
        (lambda: sdf.load({"union": [], "sphere": {}}), "scene describes 2 fields"),
        (lambda: sdf.from_dict({"ball": {}}), "there is no node 'ball'; sphere, box"),
        (lambda: sdf.from_dict([]), r"\[\] is not a node"),
        (lambda: sdf.from_dict({"sphere": {"center": [0, 0, 0]}}), "sphere holds .* exactly center, radius"),
        (
            lambda: sdf.from_dict({"scale": {"factor": 2, "of": []}}),
            "scale has 0 nodes in `of`; 1 are wanted",
        ),
        (lambda: sdf.from_dict({"union": {}}), "a list of nodes is wanted"),
    ],
)
def test_bad_input_is_refused_by_name(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_files_that_are_no_scene_are_refused_by_name(tmp_path):
    for text, words in [("{", "bad.json is not JSON"), ("[]", "bad.json holds a list")]:
        (tmp_path / "bad.json").write_text(text)
        with pytest.raises(ValueError, match=words):
            sdf.load(tmp_path / "bad.json")
