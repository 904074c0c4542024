"""Tasks 5.1 to 5.3: right answers of any make keep their marks, wrong ones lose some, with every secret."""

import inspect
import pickle

import numpy as np
import pytest
from known import rounds
from numpy.testing import assert_allclose

from autograder import checks
from autograder.checks import sky_scenes as scenes
from autograder.judge import run_check, seed_of
from framework.environment import Environment
from solutions import environment_shadows as reference

ASSIGNMENT = checks.assignment("environment_shadows")
TASKS = [task.name for task in ASSIGNMENT.tasks]


@pytest.mark.parametrize("value", [0.0, 1.0])
@pytest.mark.parametrize("task", ASSIGNMENT.tasks, ids=lambda task: task.name)
def test_an_answer_that_does_not_look_at_its_input_earns_next_to_nothing(task, value):
    calls = lambda name, arguments, returns: [np.full(shape, value) for shape in returns.shapes]  # noqa: E731
    seed = seed_of(b"north", ASSIGNMENT.name, task.id, False)
    assert run_check(task, calls, reference, seed, False).fraction < 0.2


def test_shading_without_shadows_earns_little():
    for r in rounds(ASSIGNMENT.name, "shade-with-shadows-none", (b"north",)):
        assert {m.name: m.credit for m in r.measures}["matt"] < 1e-3
        assert r.fraction < 0.3


def test_a_check_shows_a_picture():
    for function in TASKS:
        picture = rounds(ASSIGNMENT.name, f"{function.replace('_', '-')}-reference", ())[0].picture
        assert picture.yours.shape == picture.expected.shape and np.isfinite(picture.expected).all()


def test_straight_rays_and_distances_of_a_scene_agree():
    rng = np.random.default_rng(7)
    scene = scenes.Solids.ball_and_box(rng)
    p, normal = scene.surface_points(rng, 30)
    direction = scenes.around(normal, 40)
    t = np.linspace(0.02, 4, 2000)
    nearest = np.array(
        [scene(q + 1e-6 * n + t[:, None, None] * d) for q, n, d in zip(p, normal, direction, strict=True)]
    )
    nearest = nearest.min(axis=1)
    sure = np.abs(nearest) > 4e-3
    np.testing.assert_array_equal(scene.free(p, normal, direction, 4.0)[sure], nearest[sure] > 0)


def test_a_ball_over_a_floor_hides_its_form_factor():
    scene, p = scenes.Solids([((0, 1, 0), 0.5)]), np.array([[0.3, 0, 0.2]])
    want = 1 - 0.25 / (0.13 + 1) ** 1.5
    assert_allclose(scenes.ambient(scene, p, np.array([[0.0, 1, 0]]), 5.0), want, atol=3e-3)


def test_the_checks_light_agrees_with_the_slow_one():
    from solutions.prefilter import irradiance
    from solutions.split_sum import brdf_lut

    env = scenes.sky(np.random.default_rng(5), 16)
    light = scenes.light_of(env)
    assert_allclose(light.irradiance_map, irradiance(env, 16), rtol=0.02)
    assert_allclose(light.lut, brdf_lut(16, 256), atol=0.04)
    again = pickle.loads(pickle.dumps(light))
    assert_allclose(again.prefiltered([0.0, 1.0, 0.0], 0.3), light.prefiltered([0.0, 1.0, 0.0], 0.3))


def test_the_checks_truths_agree_with_an_even_sky():
    rng, env = np.random.default_rng(3), Environment(np.full((8, 16, 3), 0.5))
    scene = scenes.Solids.ball_and_box(rng)
    p, normal = scene.surface_points(rng, 20)
    shadowed, plain = scenes.diffuse(env, scene, p, normal, 3.0)
    assert_allclose(plain, 0.5)
    assert_allclose(shadowed[:, 0], 0.5 * scenes.ambient(scene, p, normal, 3.0), atol=1e-12)
    mirror = scenes.specular(
        env, scenes.Solids(), p, normal * 0 + [0, 1, 0], normal * 0 + [0, 1, 0], 1.0, 0.1, 3.0
    )
    assert_allclose(mirror, 0.5, rtol=1e-3)


def test_the_checks_ask_for_no_solutions():
    for module in (scenes, inspect.getmodule(ASSIGNMENT.tasks[0].check)):
        assert "solutions" not in inspect.getsource(module)
