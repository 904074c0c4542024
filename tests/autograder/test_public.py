"""The arrays that travel with the public checks."""

import numpy as np
import pytest

from autograder import checks, public
from autograder.notebook import judge
from autograder.submission import known_assignments

NAMES = known_assignments()


@pytest.mark.parametrize("name", NAMES)
def test_the_recorded_answers_are_the_references(name, tmp_path, monkeypatch):
    recorded = np.load(public.FOLDER / f"{name}.npz", allow_pickle=False)
    monkeypatch.setattr(public, "FOLDER", tmp_path)
    fresh = np.load(public.record(name), allow_pickle=False)
    assert sorted(recorded.files) == sorted(fresh.files) and fresh.files
    for key in fresh.files:
        np.testing.assert_allclose(fresh[key], recorded[key], atol=1e-5, rtol=1e-5, err_msg=key)


@pytest.mark.parametrize("name", NAMES)
def test_the_same_arrays_are_the_same_bytes(name, tmp_path, monkeypatch):
    monkeypatch.setattr(public, "FOLDER", tmp_path)
    assert public.record(name).read_bytes() == public.record(name).read_bytes()


@pytest.mark.parametrize("name", NAMES)
def test_the_reference_passes_its_public_checks_from_the_arrays(name):
    import importlib

    reference = vars(importlib.import_module(f"solutions.{name}"))
    for task in checks.assignment(name).tasks:
        judged = judge(task.id, dict(reference))
        assert judged["status"] == "pass", (task.id, judged["message"])


def test_a_stub_and_a_missing_function_are_not_attempted():
    def stub(*_):
        raise NotImplementedError()

    for namespace in ({}, {"sdf_sphere": stub}):
        assert judge("1.1", namespace)["status"] == "not_attempted"


def test_a_check_leaves_the_framework_as_it_was():
    import framework as fw

    judge("1.1", {"sdf_sphere": lambda p, c, r: fw.sdf.sphere(c, r)(p)})
    assert fw.sdf.sphere([0, 0, 0], 1.0)(np.zeros((1, 3)))[0] == -1


def test_the_framework_does_not_answer_in_the_notebook_either():
    import framework as fw

    judged = judge("1.1", {"sdf_sphere": lambda p, c, r: fw.sdf.sphere(c, r)(p)})
    assert judged["status"] == "error" and "would answer the task" in judged["message"]
