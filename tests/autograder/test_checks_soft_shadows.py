"""Tasks 2.1 to 2.5: right answers of any make keep their marks, wrong ones lose some, with every secret."""

import functools
import json

import nbformat
import numpy as np
import pytest
from numpy.testing import assert_allclose
from variants import soft_shadows as variants

from autograder import checks
from autograder.checks.shadow_scenes import Scene, across_the_shade, light_above
from autograder.grade import grade
from autograder.judge import run_check, seed_of
from autograder.samples import filled_notebook
from autograder.student import InMemory
from solutions import soft_shadows as reference

ASSIGNMENT = checks.assignment("soft_shadows")
TASKS = [task.name for task in ASSIGNMENT.tasks]
SECRETS = (b"north", b"east", b"south", b"west", b"zenith")


def versions(kind):
    """(function, version) for all that the module `variants` holds of a kind."""
    return [(f, v) for f in TASKS for v in vars(variants) if v.startswith(f"{kind}_{f}_")]


@functools.cache
def rounds(function, version, secrets=SECRETS):
    """The public round of a version and one round for each secret."""
    task = ASSIGNMENT.find(function)
    code = getattr(variants, version) if version else getattr(reference, function)
    return [_round(task, code, True)] + [_round(task, code, False, secret) for secret in secrets]


def _round(task, code, public, secret=b""):
    calls = InMemory({task.name: code}, task).call
    return run_check(task, calls, reference, seed_of(secret, ASSIGNMENT.name, task.id, public), public)


def missed(round_):
    """The names of the measures that an answer does not meet."""
    return {m.name for m in round_.measures if m.credit < 1}


def test_every_task_has_the_versions_that_its_claim_rests_on():
    for function in TASKS:
        assert sum(f == function for f, _ in versions("right")) >= 4
        assert sum(f == function for f, _ in versions("wrong")) >= 9


@pytest.mark.parametrize(("function", "version"), [(f, None) for f in TASKS] + versions("right"))
def test_a_right_answer_gets_full_marks(function, version):
    for r in rounds(function, version):
        assert (r.failure, missed(r), round(r.fraction, 9)) == (None, set(), 1.0)


@pytest.mark.drill
@pytest.mark.parametrize(
    ("function", "version"), [(f, None) for f in TASKS] + versions("right") + versions("wrong")
)
def test_right_and_wrong_stay_apart_over_many_secrets(function, version):
    for r in rounds.__wrapped__(function, version, [b"secret %d" % i for i in range(12)]):
        right = version is None or version.startswith("right")
        assert r.failure is None and (missed(r) == set() if right else r.fraction <= 0.96)


@pytest.mark.parametrize(("function", "version"), versions("costly"))
def test_an_answer_that_is_right_at_a_price_loses_marks_for_work_alone(function, version):
    for r in rounds(function, version, SECRETS[:2]):
        assert missed(r) == {"work"}
        assert 0.8 <= round(r.fraction, 9) < 1


@pytest.mark.parametrize(("function", "version"), versions("wrong"))
def test_a_wrong_answer_loses_marks_on_every_input(function, version):
    for r in rounds(function, version, SECRETS if function in TASKS[:3] else SECRETS[:2]):
        assert r.failure is None
        assert missed(r), getattr(variants, version).__doc__
        assert r.fraction <= 0.96


@pytest.mark.parametrize("value", [0.0, 1.0, 0.5])
@pytest.mark.parametrize("function", TASKS)
def test_an_answer_that_does_not_look_at_its_input_earns_next_to_nothing(function, value):
    task = ASSIGNMENT.find(function)
    calls = lambda name, arguments, returns: [np.full(shape, value) for shape in returns.shapes]  # noqa: E731
    for secret in SECRETS[:3]:
        seed = seed_of(secret, ASSIGNMENT.name, task.id, False)
        assert run_check(task, calls, reference, seed, False).fraction < 0.1


@pytest.mark.parametrize(
    ("version", "measures"),
    [
        ("wrong_safe_angle_not_a_number", {"inside", "wide", "no way", "map"}),
        ("wrong_safe_angle_start_blocked", {"no way", "map"}),
        ("wrong_safe_angle_epsilon", {"any scale"}),
        ("wrong_safe_angle_one_shape", {"any shape"}),
        ("wrong_penumbra_not_a_number", {"no way", "map"}),
        ("wrong_penumbra_not_clamped", {"wide", "no way", "map"}),
        ("wrong_penumbra_negative", {"inside", "no way", "map"}),
        ("wrong_needs_shadow_ray_at_the_horizon", {"at the horizon"}),
        ("wrong_needs_shadow_ray_margin", {"near the horizon"}),
        ("wrong_needs_shadow_ray_light_each", {"one light"}),
        ("wrong_soft_shadow_endless", {"t_max"}),
        ("wrong_soft_shadow_exhausted_is_dark", {"blocked", "out of steps"}),
        ("wrong_soft_shadow_light_for_all", {"a light each"}),
    ],
)
def test_a_mistake_costs_exactly_the_measures_that_it_breaks(version, measures):
    function = next(f for f in TASKS if f in version)
    for r in rounds(function, version, SECRETS if function in TASKS[:3] else SECRETS[:2]):
        assert missed(r) - {"work"} == measures
        assert r.fraction > 0.5


@pytest.mark.parametrize("version", [v for _, v in versions("half")])
def test_the_form_without_signs_gets_about_half_of_the_marks(version):
    assert all(0.43 <= r.fraction <= 0.55 for r in rounds("area_light_shadow", version))


def test_a_smaller_error_is_never_worth_less():
    unsigned, linear, smooth = (
        rounds("area_light_shadow", version)
        for version in (
            "half_area_light_shadow_unsigned",
            "near_area_light_shadow_linear",
            "near_area_light_shadow_smoothstep",
        )
    )
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


def test_every_measure_has_a_tolerance_with_its_reason():
    records = json.loads((checks.HERE.parent / "references" / "tolerances.json").read_text(encoding="utf-8"))
    for task in ASSIGNMENT.tasks:
        for name, record in records[task.id].items():
            assert len(record["reason"]) > 20, (task.id, name)


@pytest.mark.parametrize("function", TASKS)
def test_a_check_shows_a_picture(function):
    for r in rounds(function, None):
        assert r.picture.yours.shape == r.picture.expected.shape
        assert len(np.unique(r.picture.expected)) > 1


@pytest.fixture
def marks(tmp_path, pool):
    """Grades a notebook with the given functions replaced; task name -> its check."""

    def run(replacements):
        path = tmp_path / "soft_shadows.ipynb"
        nbformat.write(filled_notebook("soft_shadows", replacements), path)
        return {check["name"]: check for check in grade(path, "amy", pool)[0]["checks"]}

    return run


def test_the_reference_has_full_marks_through_the_sandbox(marks):
    judged = marks({})
    assert {name: check["score"] for name, check in judged.items()} == {
        name: check["max_score"] for name, check in judged.items()
    }
    assert list(judged) == TASKS


@pytest.mark.parametrize(
    "function",
    ["soft_shadow", *(pytest.param(f, marks=pytest.mark.drill) for f in TASKS if f != "soft_shadow")],
)
def test_a_stub_costs_exactly_its_task(marks, function):
    judged = marks({function: None})
    assert judged[function]["status"] == "not_attempted" and judged[function]["score"] == 0
    assert all(c["score"] == c["max_score"] for name, c in judged.items() if name != function)
