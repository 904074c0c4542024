"""Tasks 1.1 to 1.7: right answers of any make keep their marks, wrong ones lose some, with every secret."""

import functools
import json

import numpy as np
import pytest
from variants import sphere_tracing as variants

from autograder import checks
from autograder.judge import run_check, seed_of
from autograder.student import InMemory
from solutions import sphere_tracing as reference

ASSIGNMENT = checks.assignment("sphere_tracing")
SECRETS = (b"north", b"east", b"south", b"west", b"zenith")
LOOPS_OVER_A_PICTURE = ("right_estimate_normal_loop", "right_sphere_trace_loop")


def versions(kind):
    """(function, version) for all that the module `variants` holds of a kind."""
    names = [task.name for task in ASSIGNMENT.tasks]
    return [(f, v) for f in names for v in vars(variants) if v.startswith(f"{kind}_{f}_")]


@functools.cache
def rounds(function, version, secrets=SECRETS):
    """The public round of a version and one round for each secret."""
    task = ASSIGNMENT.find(function)
    code = getattr(variants, version) if version else getattr(reference, function)
    secrets = secrets[:1] if version in LOOPS_OVER_A_PICTURE else secrets
    return [_round(task, code, True)] + [_round(task, code, False, secret) for secret in secrets]


def _round(task, code, public, secret=b""):
    calls = InMemory({task.name: code}, task).call
    return run_check(task, calls, reference, seed_of(secret, ASSIGNMENT.name, task.id, public), public)


def missed(round_):
    """The names of the measures that a round's answer does not meet, or why it was not judged to its end."""
    return {m.name for m in round_.measures if m.credit < 1} or (
        {round_.failure.message} if round_.failure else set()
    )


def test_every_task_has_the_versions_that_its_claim_rests_on():
    for function in (task.name for task in ASSIGNMENT.tasks):
        assert sum(f == function for f, _ in versions("right")) >= 3
        assert sum(f == function for f, _ in versions("wrong")) >= 7


@pytest.mark.parametrize("function", [task.name for task in ASSIGNMENT.tasks])
def test_the_reference_gets_full_marks(function):
    assert [(r.failure, missed(r), round(r.fraction, 9)) for r in rounds(function, None)] == [
        (None, set(), 1.0)
    ] * 6


@pytest.mark.parametrize(("function", "version"), versions("right"))
def test_a_right_answer_gets_full_marks(function, version):
    for r in rounds(function, version):
        assert (r.failure, missed(r), round(r.fraction, 9)) == (None, set(), 1.0), getattr(
            variants, version
        ).__doc__


@pytest.mark.parametrize(("function", "version"), versions("wrong"))
def test_a_wrong_answer_loses_marks_on_every_input(function, version):
    for r in rounds(function, version, SECRETS[:3] if function == "sphere_trace" else SECRETS):
        assert missed(r), getattr(variants, version).__doc__
        assert r.fraction <= 0.95


@pytest.mark.parametrize("value", [0.0, 1.0, np.inf])
@pytest.mark.parametrize("function", [task.name for task in ASSIGNMENT.tasks])
def test_an_answer_that_does_not_look_at_its_input_earns_next_to_nothing(function, value):
    task = ASSIGNMENT.find(function)
    calls = lambda name, arguments, returns: [np.full(shape, value) for shape in returns.shapes]  # noqa: E731
    for secret in SECRETS:
        seed = seed_of(secret, ASSIGNMENT.name, task.id, False)
        assert run_check(task, calls, reference, seed, False).fraction < 0.1


@pytest.mark.parametrize(
    ("function", "version", "measures"),
    [
        ("sdf_sphere", "wrong_sdf_sphere_flat_only", {"any shape"}),
        ("sdf_box", "wrong_sdf_box_without_interior", {"inside", "any shape"}),
        ("sdf_torus", "wrong_sdf_torus_clamped", {"inside", "any shape"}),
        ("blend", "wrong_blend_scalar_t_only", {"an array of t"}),
        ("smooth_union", "wrong_smooth_union_clamp_missing", {"outside the band"}),
        ("estimate_normal", "wrong_estimate_normal_not_unit", {"unit length", "plane"}),
        ("sphere_trace", "wrong_sphere_trace_all_rays", {"work"}),
        ("sphere_trace", "wrong_sphere_trace_exhausted_is_hit", {"max_steps", "work"}),
        ("sphere_trace", "wrong_sphere_trace_one_step_less", {"max_steps", "work"}),
        ("sphere_trace", "wrong_sphere_trace_one_step_more", {"max_steps", "work"}),
        ("sphere_trace", "wrong_sphere_trace_without_t_max", {"t_max", "work"}),
        ("sphere_trace", "wrong_sphere_trace_misses_at_t_max", {"misses are infinite", "work"}),
        (
            "sphere_trace",
            "wrong_sphere_trace_origin_skipped",
            {"starts inside", "starts on the surface", "max_steps", "work"},
        ),
        ("sphere_trace", "wrong_sphere_trace_abs", {"starts inside", "work"}),
    ],
)
def test_a_mistake_costs_the_measures_that_it_breaks(function, version, measures):
    for r in rounds(function, version, SECRETS[:3] if function == "sphere_trace" else SECRETS):
        assert missed(r) <= measures
        assert missed(r) & (measures - {"work"} or measures)


def test_rays_that_are_evaluated_for_nothing_cost_the_marks_for_work_alone():
    judged = rounds("sphere_trace", "wrong_sphere_trace_all_rays", SECRETS[:3])
    assert [round(r.fraction, 9) for r in judged] == [0.8] * 4


def test_a_list_of_points_is_asked_for_before_a_grid():
    for r in rounds("sdf_sphere", "wrong_sdf_sphere_flat_only"):
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

    r = _round(ASSIGNMENT.find("1.1"), divides_by_zero, True)
    assert "numbers that sdf_sphere returned are NaN" in r.failure.message
    assert r.fraction == 0


def test_every_measure_has_a_tolerance_with_its_reason():
    records = json.loads((checks.HERE.parent / "references" / "tolerances.json").read_text(encoding="utf-8"))
    for task in ASSIGNMENT.tasks:
        names = {m.name for r in rounds(task.name, None) for m in r.measures}
        assert names - {"any shape", "an array of t"} == set(records[task.id])
        assert all(len(record["reason"]) > 30 for record in records[task.id].values())


@pytest.mark.drill
@pytest.mark.parametrize("function", [task.name for task in ASSIGNMENT.tasks])
def test_right_and_wrong_keep_apart_over_many_secrets(function):
    secrets = tuple(b"%d" % number for number in range(40))
    for kind, low, high in (("right", 1 - 1e-9, 1), ("wrong", 0, 0.95)):
        for version in (v for f, v in versions(kind) if f == function):
            assert all(low <= r.fraction <= high for r in rounds(function, version, secrets)), version
