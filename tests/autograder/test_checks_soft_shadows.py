"""Tasks 2.1 to 2.5: right answers of any make keep their marks, wrong ones lose some, with every secret."""

import known
import numpy as np
import pytest
from known import judged, missed
from numpy.testing import assert_allclose

from autograder import checks
from autograder.checks.shadow_scenes import Scene, across_the_shade, light_above
from autograder.judge import run_check, seed_of
from autograder.mistakes.right import soft_shadows as right
from solutions import soft_shadows as reference

ASSIGNMENT = checks.assignment("soft_shadows")
TASKS = [task.name for task in ASSIGNMENT.tasks]
SECRETS = (b"north", b"east", b"south", b"west", b"zenith")


def rounds(id, secrets=SECRETS):
    return known.rounds(ASSIGNMENT.name, id, secrets)


@pytest.mark.parametrize("value", [0.0, 1.0, 0.5])
@pytest.mark.parametrize("function", TASKS)
def test_an_answer_that_does_not_look_at_its_input_earns_next_to_nothing(function, value):
    task = ASSIGNMENT.find(function)
    calls = lambda name, arguments, returns: [np.full(shape, value) for shape in returns.shapes]  # noqa: E731
    for secret in SECRETS[:3]:
        seed = seed_of(secret, ASSIGNMENT.name, task.id, False)
        assert run_check(task, calls, reference, seed, False).fraction < 0.1


@pytest.mark.parametrize(
    ("id", "measures"),
    [
        ("safe-angle-not-a-number", {"inside", "wide", "no way", "map"}),
        ("safe-angle-start-blocked", {"no way", "map"}),
        ("safe-angle-epsilon", {"any scale"}),
        ("safe-angle-one-shape", {"any shape"}),
        ("penumbra-not-a-number", {"no way", "map"}),
        ("penumbra-not-clamped", {"wide", "no way", "map"}),
        ("penumbra-negative", {"inside", "no way", "map"}),
        ("needs-shadow-ray-at-the-horizon", {"at the horizon"}),
        ("needs-shadow-ray-margin", {"near the horizon"}),
        ("needs-shadow-ray-light-each", {"one light"}),
        ("soft-shadow-endless", {"t_max"}),
        ("soft-shadow-exhausted-is-dark", {"blocked", "out of steps"}),
        ("soft-shadow-light-for-all", {"a light each"}),
    ],
)
def test_a_mistake_costs_exactly_the_measures_that_it_breaks(id, measures):
    for r in rounds(id, SECRETS[:2]):
        assert missed(r) - {"work"} == measures
        assert r.fraction > 0.5


@pytest.mark.parametrize("id", ["area-light-shadow-unsigned", "area-light-shadow-unsigned-through"])
def test_the_form_without_signs_gets_about_half_of_the_marks(id):
    assert all(0.43 <= r.fraction <= 0.55 for r in rounds(id))


def test_a_smaller_error_is_never_worth_less():
    def shaded_by(shade):
        def area_light_shadow(sdf, origin, to_light, angular_radius, *march):
            step = right.quarter(angular_radius)
            return right.through(sdf, origin, to_light, angular_radius, *march, step, shade)

        return judged(ASSIGNMENT.name, "area_light_shadow", area_light_shadow, SECRETS)

    unsigned, linear = rounds("area-light-shadow-unsigned"), shaded_by(lambda x: 0.5 + 0.5 * x)
    smooth = shaded_by(lambda x: (1 + x) ** 2 * (2 - x) / 4)
    for low, middle, high in zip(unsigned, linear, smooth, strict=True):
        assert 0.5 < middle.fraction - low.fraction + 0.1 and 0.9 < middle.fraction <= high.fraction + 0.02
        assert high.fraction >= 0.98


def test_the_visible_fraction_at_a_straight_edge_is_that_of_a_segment_of_the_disc():
    wall = Scene(boxes=[(np.array([-50.0, 3.0, 0.0]), np.array([50.0, 1e-4, 50.0]))])
    radius, x = 0.1, np.linspace(-0.9, 0.9, 7)
    origin = np.stack([3 * np.tan(radius) * x, 0 * x, 0 * x], axis=-1)
    expected = 0.5 + (x * np.sqrt(1 - x * x) + np.arcsin(x)) / np.pi
    assert_allclose(wall.visible(origin, np.array([0.0, 1.0, 0.0]), radius), expected, atol=3e-3)


def test_straight_rays_and_distances_of_a_scene_agree():
    rng = np.random.default_rng(7)
    for scene in (Scene.ball_and_box(rng), Scene.ball(rng)[0], Scene.large_box(rng)):
        light = light_above(rng)
        origin = across_the_shade(rng, scene, light, 0.3)
        t = np.linspace(0.02, 8, 4000)
        nearest = scene(origin[:, None] + t[:, None] * light).min(axis=1)
        sure = np.abs(nearest) > 3e-3
        np.testing.assert_array_equal(scene.stops(origin, light[None])[sure, 0], nearest[sure] < 0)


@pytest.mark.parametrize("function", TASKS)
def test_a_check_shows_a_picture(function):
    for r in rounds(f"{function.replace('_', '-')}-reference", SECRETS[:1]):
        assert r.picture.yours.shape == r.picture.expected.shape
        assert len(np.unique(r.picture.expected)) > 1
