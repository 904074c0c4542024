"""Tasks 1.1 to 1.7: right answers of any make keep their marks, wrong ones lose some, with every secret."""

import known
import numpy as np
import pytest
from known import judged, missed

from autograder import checks
from autograder.judge import run_check, seed_of
from solutions import sphere_tracing as reference

ASSIGNMENT = checks.assignment("sphere_tracing")
SECRETS = (b"north", b"east", b"south", b"west", b"zenith")


def rounds(id, secrets=SECRETS):
    return known.rounds(ASSIGNMENT.name, id, secrets)


@pytest.mark.parametrize("value", [0.0, 1.0, np.inf])
@pytest.mark.parametrize("function", [task.name for task in ASSIGNMENT.tasks])
def test_an_answer_that_does_not_look_at_its_input_earns_next_to_nothing(function, value):
    task = ASSIGNMENT.find(function)
    calls = lambda name, arguments, returns: [np.full(shape, value) for shape in returns.shapes]  # noqa: E731
    for secret in SECRETS:
        seed = seed_of(secret, ASSIGNMENT.name, task.id, False)
        assert run_check(task, calls, reference, seed, False).fraction < 0.1


@pytest.mark.parametrize(
    ("id", "measures"),
    [
        ("sdf-sphere-flat-only", {"any shape"}),
        ("sdf-box-without-interior", {"inside", "any shape"}),
        ("sdf-torus-clamped", {"inside", "any shape"}),
        ("blend-scalar-t-only", {"an array of t"}),
        ("smooth-union-clamp-missing", {"outside the band"}),
        ("estimate-normal-not-unit", {"unit length", "plane"}),
        ("sphere-trace-all-rays", {"work"}),
        ("sphere-trace-exhausted-is-hit", {"max_steps", "work"}),
        ("sphere-trace-one-step-less", {"max_steps", "work"}),
        ("sphere-trace-one-step-more", {"max_steps", "work"}),
        ("sphere-trace-without-t-max", {"t_max", "work"}),
        ("sphere-trace-misses-at-t-max", {"misses are infinite", "work"}),
        (
            "sphere-trace-origin-skipped",
            {"starts inside", "starts on the surface", "max_steps", "work"},
        ),
        ("sphere-trace-abs", {"starts inside", "work"}),
    ],
)
def test_a_mistake_costs_the_measures_that_it_breaks(id, measures):
    for r in rounds(id, SECRETS[:2]):
        assert missed(r) <= measures
        assert missed(r) & (measures - {"work"} or measures)


def test_rays_that_are_evaluated_for_nothing_cost_the_marks_for_work_alone():
    judged = rounds("sphere-trace-all-rays", SECRETS[:2])
    assert [round(r.fraction, 9) for r in judged] == [0.8] * 3


def test_a_list_of_points_is_asked_for_before_a_grid():
    for r in rounds("sdf-sphere-flat-only"):
        assert r.failure is None
        assert 0.9 < r.fraction < 1


def test_an_answer_that_is_not_a_number_is_told_with_the_point():
    def divides_by_zero(p, center, radius):
        q = np.subtract(p, center)
        return (
            (q * q).sum(-1)
            / np.maximum(np.linalg.norm(q, axis=-1), 1e-300)
            * np.where(p[..., 0] > 0, 1, np.nan)
        )

    (r,) = judged(ASSIGNMENT.name, "sdf_sphere", divides_by_zero, ())
    assert "numbers that sdf_sphere returned are NaN" in r.failure.message
    assert r.fraction == 0
