"""Tasks 4.1 to 4.8: right answers of any make keep their marks, wrong ones lose some, with every secret."""

import functools
import inspect

import numpy as np
import pytest
from variants import split_sum as variants

from autograder import checks
from autograder.checks import reflection_truth as truth
from autograder.judge import run_check, seed_of
from autograder.student import InMemory
from solutions import split_sum as reference

ASSIGNMENT = checks.assignment("split_sum")
SECRETS = (b"north", b"east", b"south", b"west")
FUNCTIONS = [f.name for task in ASSIGNMENT.tasks for f in task.functions]


def versions(kind):
    """(function, version) for all that the module `variants` holds of a kind."""
    return [(f, v) for f in FUNCTIONS for v in vars(variants) if v.startswith(f"{kind}_{f}_")]


@functools.cache
def rounds(function, version, secrets=SECRETS):
    """The public round of a version and one round for each secret; the task's other function is right."""
    task = ASSIGNMENT.find(function)
    names = {f.name: getattr(reference, f.name) for f in task.functions}
    if version:
        names[function] = getattr(variants, version)
    return [_round(task, names, True)] + [_round(task, names, False, secret) for secret in secrets]


def _round(task, names, public, secret=b""):
    seed = seed_of(secret, ASSIGNMENT.name, task.id, public)
    return run_check(task, InMemory(names, task).call, reference, seed, public)


def missed(round_):
    """The names of the measures that a round's answer does not meet, or why it was not judged to its end."""
    failed = {round_.failure.message} if round_.failure else set()
    return {m.name for m in round_.measures if m.credit < 1} or failed


def some(version):
    """Noisy and slow versions are judged with one secret, all others with four."""
    return SECRETS[:1] if "monte_carlo" in version or "brdf_lut" in version else SECRETS


def test_every_function_has_the_versions_that_its_claim_rests_on():
    for function in FUNCTIONS:
        assert sum(f == function for f, _ in versions("right")) >= 3
        assert sum(f == function for f, _ in versions("wrong")) >= 5


@pytest.mark.parametrize("function", [task.name for task in ASSIGNMENT.tasks])
def test_the_reference_gets_full_marks(function):
    assert [(r.failure, missed(r), round(r.fraction, 9)) for r in rounds(function, None)] == [
        (None, set(), 1.0)
    ] * 5


@pytest.mark.parametrize(("function", "version"), versions("right"))
def test_a_right_answer_gets_full_marks(function, version):
    for r in rounds(function, version, some(version)):
        assert (r.failure, missed(r), round(r.fraction, 9)) == (None, set(), 1.0)


@pytest.mark.parametrize(("function", "version"), versions("wrong"))
def test_a_wrong_answer_loses_marks_on_every_input(function, version):
    for r in rounds(function, version, some(version)):
        assert missed(r)
        assert r.fraction <= 0.95


@pytest.mark.drill
@pytest.mark.parametrize(
    ("function", "version"), [v for v in versions("right") if v[0] in ("monte_carlo_shade", "brdf_lut")]
)
def test_a_noisy_right_answer_gets_full_marks_with_many_secrets(function, version):
    secrets = tuple(str(i).encode() for i in range(8))
    assert all(missed(r) == set() and r.failure is None for r in rounds(function, version, secrets))


@pytest.mark.parametrize("value", [0.0, 1.0])
@pytest.mark.parametrize("task", ASSIGNMENT.tasks, ids=lambda task: task.name)
def test_an_answer_that_does_not_look_at_its_input_earns_next_to_nothing(task, value):
    calls = lambda name, arguments, returns: [np.full(shape, value) for shape in returns.shapes]  # noqa: E731
    for secret in SECRETS:
        assert (
            run_check(task, calls, reference, seed_of(secret, "split_sum", task.id, False), False).fraction
            < 0.2
        )


@pytest.mark.parametrize("missing", ["r0_from_ior", "fresnel_schlick", "ndf_ggx", "ndf_beckmann"])
def test_one_of_two_functions_that_is_not_written_costs_its_own_share(missing):
    task = ASSIGNMENT.find(missing)
    names = {f.name: getattr(reference, f.name) for f in task.functions}
    del names[missing]
    judged = _round(task, names, False)
    assert judged.failure is None and 0.2 < judged.fraction < 0.75
    assert _round(task, {}, False).failure.status == "not_attempted"


@pytest.mark.parametrize("size", [1, 5, 16])
def test_the_checks_table_agrees_with_an_independent_quadrature(size):
    from solutions.truth import brdf_integral

    c = (np.arange(size) + 0.5) / size
    want = [[brdf_integral(mu, r * r, nodes=48) for mu in c] for r in c]
    np.testing.assert_allclose(truth.table(size), want, atol=1e-3)


def test_the_checks_radiance_agrees_with_an_independent_quadrature():
    from autograder.checks.reflection_inputs import above, sky
    from solutions.truth import reflected_radiance

    rng = np.random.default_rng(4)
    env, (normal, view, _), r0 = sky(rng), above(rng, 4), rng.uniform(0, 1, (4, 3))
    alpha = np.array([0.4, 0.4, 0.9, 0.9])
    mean, _ = truth.reflected(env, normal, view, r0, alpha)
    want = [reflected_radiance(env.radiance, *one)[0] for one in zip(normal, view, r0, alpha, strict=True)]
    np.testing.assert_allclose(mean, want, rtol=3e-3)


def test_the_checks_ask_for_no_solutions():
    for module in (truth, inspect.getmodule(ASSIGNMENT.tasks[0].check)):
        assert "solutions" not in inspect.getsource(module).replace("the solutions", "")
