"""Checks 3.1 to 3.6: right answers in other ways keep full marks, wrong ones lose some, whatever the inputs."""

import numpy as np
import pytest
from known import judged

from autograder import checks, wall
from autograder.judge import run_check
from autograder.student import InMemory
from framework.environment import pixel_directions
from solutions import prefilter as reference
from solutions.truth_maps import filtered_radiance

SEEDS = range(4)
ASSIGNMENT = checks.assignment("prefilter")
TASKS = {task.name: task for task in ASSIGNMENT.tasks}


@pytest.mark.parametrize("value", [0.0, 1.0])
@pytest.mark.parametrize("name", TASKS)
def test_a_constant_answer_earns_next_to_nothing(name, value):
    task = TASKS[name]

    def call(_, arguments, returns):
        return [np.full(shape, value) for shape in returns.shapes]

    for seed in SEEDS:
        assert run_check(task, call, reference, seed, True).fraction < 0.2


def test_the_framework_does_not_answer_the_first_task():
    import framework as fw

    call = InMemory({"sample_ggx": lambda xi, alpha: fw.sample_ggx(xi, alpha)}, TASKS["sample_ggx"]).call
    round_ = run_check(TASKS["sample_ggx"], call, reference, 0, True)
    assert round_.failure.status == "error" and "would answer the task" in round_.failure.message


@pytest.mark.parametrize("name", ["irradiance", "prefilter", "prefilter_chain"])
def test_a_map_of_another_size_is_an_error_that_names_the_shape(name):
    def other(*arguments):
        answer = getattr(reference, name)(*arguments)
        return [a[1:] for a in answer] if isinstance(answer, list) else answer[1:]

    (round_,) = judged(ASSIGNMENT.name, name, other, ())
    assert round_.failure.status == "error" and "shape" in round_.failure.message and round_.fraction == 0


@pytest.mark.parametrize(
    "alpha, tolerance", [(0.2, "more samples"), (0.55, "more samples"), (1.0, "more samples")]
)
def test_pixels_and_their_interpolant_agree_within_a_quarter_of_the_tolerance(alpha, tolerance):
    from autograder.checks.filter_truth import filtered, soft_lights
    from autograder.checks.prefilter import _off

    env = soft_lights(np.random.default_rng(5), 32)
    interpolated = filtered_radiance(env.pixels, pixel_directions(4), alpha, oversample=4)
    assert _off(interpolated, filtered(env, alpha, 4)) < checks.tolerance("3.3", tolerance)["tolerance"] / 4


@pytest.mark.parametrize("alpha", [0.2, 1.0])
def test_the_checks_truth_is_the_independent_one(alpha):
    from autograder.checks.filter_truth import filtered, soft_lights

    env = soft_lights(np.random.default_rng(6), 32)
    np.testing.assert_allclose(filtered(env, alpha, 4), filtered_radiance(env.pixels, pixel_directions(4), alpha),
                               rtol=1e-9)  # fmt: skip


def test_a_loop_that_asks_for_single_samples_stays_within_the_calls_that_are_served():
    """A scalar loop over pixels and samples asks the grader for `sample_ggx` once each."""
    from autograder.student import MAX_SERVED_CALLS

    asked = []

    def call(name, arguments, returns):
        env, alpha, height, samples = arguments
        asked.append(2 * height * height * samples if alpha else 0)
        return wall.as_promised(reference.prefilter(env, alpha, height, samples), returns)

    run_check(TASKS["prefilter"], call, reference, 0, True)
    assert 2 * sum(asked) < MAX_SERVED_CALLS
