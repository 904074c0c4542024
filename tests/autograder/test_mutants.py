"""Mutants of the references: what is changed, that checks tell them from right, and that survivors have a reason."""

import numpy as np
import pytest

from autograder import checks, mutants, mutation

FUNCTIONS = [
    (name, function.name)
    for name in checks.available()
    for task in checks.assignment(name).tasks
    for function in task.functions
]
ids = [function for _, function in FUNCTIONS]


@pytest.mark.parametrize(("name", "function"), FUNCTIONS, ids=ids)
def test_every_function_has_fifteen_mutants_or_more_each_a_program_of_its_own(name, function):
    found = mutants.mutants(name, function)
    assert mutants.LEAST <= len(found) <= mutants.MOST
    assert len({m.id for m in found}) == len({m.code.text for m in found}) == len(found)
    assert all(callable(m.code.compiled) for m in found)


def test_signs_constants_comparisons_axes_clamps_and_terms_are_changed():
    said = {m.id.split(": ", 1)[1] for name, function in FUNCTIONS for m in mutants.mutants(name, function)}
    for change in (
        "outside + inside -> outside - inside", "outside + inside -> outside", "4.0 -> 8.0", "-1 -> 1",
        "distance < eps -> distance <= eps", "np.maximum(beyond, 0.0) -> beyond", "here + distance -> here",
        "np.minimum(d1, d2) -> np.maximum(d1, d2)", "center -> p",
    ):  # fmt: skip
        assert change in said, change


def test_a_mutant_computes_what_it_says():
    (flipped,) = [m for m in mutants.mutants("sphere_tracing", "blend") if m.id.endswith("-> (1.0 - t) * d1 - t * d2")]
    assert flipped.code(np.array([2.0]), np.array([4.0]), 0.25) == [0.5]


# One in twenty by their place in the text; all of them in the drill, by `course calibrate`.
SAMPLE = [m for name, function in FUNCTIONS for m in mutants.mutants(name, function)][7::20]


def test_a_sample_of_the_mutants_loses_marks_or_has_a_reason_not_to():
    verdicts = [mutation.judge(m) for m in SAMPLE if m.task != "5.3"]
    assert mutation.problems(verdicts) == []
    named = [v for v in verdicts if v.named and not v.fits]
    assert len(named) <= 0.1 * len(verdicts)


def test_a_mutant_that_never_ends_is_stopped(monkeypatch):
    endless = mutants.Source("def blend(d1, d2, t):\n    while True:\n        pass", "blend", "solutions.sphere_tracing")
    mutant = mutants.mutants("sphere_tracing", "blend")[0]
    monkeypatch.setattr(mutation, "SECONDS", 0.2)
    verdict = mutation.judge(type(mutant)(mutant.assignment, mutant.task, mutant.function, "x", endless, "wrong"))
    assert verdict.killed_by == "it never ends"


def test_every_reason_is_of_a_mutant_that_there_is():
    every = {m.id for name, function in FUNCTIONS for m in mutants.mutants(name, function)}
    assert set(mutants.reasons()) <= every
    assert all(len(reason) > 20 for reason in mutants.reasons().values())


def test_a_survivor_without_a_reason_is_a_problem_and_so_is_a_reason_for_one_that_loses_marks():
    known = next(iter(mutants.reasons()))
    alive, dead = mutation.Verdict("1.4", "blend", "blend: x -> y", ""), mutation.Verdict("2.1", "f", known, "values")
    assert mutation.problems([alive]) == ["blend: x -> y: keeps all marks"]
    assert "loses marks (values)" in mutation.problems([dead])[0]
    assert any("! blend: x -> y" in line for line in mutation.lines([alive]))
    assert "kill rate 0.0%" in mutation.summary([alive])
