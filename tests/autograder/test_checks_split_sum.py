"""Tasks 4.1 to 4.8: right answers of any make keep their marks, wrong ones lose some, with every secret."""

import inspect

import numpy as np
import pytest

from autograder import checks
from autograder.checks import reflection_truth as truth
from autograder.judge import run_check, seed_of
from autograder.student import InMemory
from solutions import split_sum as reference

ASSIGNMENT = checks.assignment("split_sum")
SECRETS = (b"north", b"east", b"south", b"west")


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
    names = {f.name: getattr(reference, f.name) for f in task.functions if f.name != missing}
    judged, nothing = (
        run_check(task, InMemory(written, task).call, reference, seed_of(b"north", "split_sum", task.id, False), False)
        for written in (names, {})
    )
    assert judged.failure is None and 0.2 < judged.fraction < 0.75
    assert nothing.failure.status == "not_attempted"


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
