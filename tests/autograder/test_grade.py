"""Whole notebooks through the real sandbox: marks where they belong, and what cheats earn."""

import nbformat
import pytest

from autograder.demo import ENDLESS, IN_ANOTHER_WAY, NO_INSIDE, STEPS_ARE_HITS
from autograder.grade import grade
from autograder.samples import filled_notebook
from autograder.sandbox import Limits, Pool

TASKS = ["sdf_sphere", "sdf_box", "sdf_torus", "blend", "smooth_union", "estimate_normal", "sphere_trace"]


@pytest.fixture
def marks(tmp_path, isolation):
    """Grades a notebook with the given functions replaced; a dict of task name to its check."""

    def run(replacements=None, fill=True, **limits):
        path = tmp_path / "sphere_tracing.ipynb"
        nbformat.write(filled_notebook("sphere_tracing", replacements, fill), path)
        with Pool(isolation, Limits(**limits)) as pool:
            result, _ = grade(path, "amy", pool)
        run.result = result
        return {check["name"]: check for check in result["checks"]}

    return run


def full(checks):
    return [name for name, check in checks.items() if check["score"] == check["max_score"]]


@pytest.mark.parametrize("replacements", [{}, IN_ANOTHER_WAY], ids=["reference", "another way"])
def test_a_right_notebook_has_full_marks(marks, replacements):
    assert full(marks(replacements)) == TASKS
    assert marks.result["status"] == "graded" and marks.result["score"] == 20


@pytest.mark.parametrize("replacements", [NO_INSIDE, STEPS_ARE_HITS], ids=["no inside", "steps are hits"])
def test_a_mistake_costs_its_own_task_alone(marks, replacements):
    checks = marks(replacements)
    (wrong,) = replacements
    assert full(checks) == [name for name in TASKS if name != wrong]
    assert checks[wrong]["status"] == "partial"
    assert checks[wrong]["error"] > checks[wrong]["tolerance"]


@pytest.mark.parametrize("name", TASKS)
def test_a_stub_costs_exactly_its_task(marks, name):
    checks = marks({name: None})
    assert full(checks) == [task for task in TASKS if task != name]
    assert checks[name]["status"] == "not_attempted" and checks[name]["score"] == 0


def test_an_empty_notebook_is_not_attempted(marks):
    checks = marks({}, fill=False)
    assert marks.result["status"] == "not_attempted" and marks.result["score"] == 0
    assert {check["status"] for check in checks.values()} == {"not_attempted"}


def test_an_endless_loop_costs_its_own_task(marks):
    checks = marks(ENDLESS, call_cpu_seconds=2)
    assert full(checks) == [name for name in TASKS if name != "smooth_union"]
    assert checks["smooth_union"]["status"] == "timeout" and "CPU" in checks["smooth_union"]["message"]


def test_an_endless_loop_outside_functions_leaves_what_was_defined_before(marks):
    before = "def blend(d1, d2, t):\n    return (1 - t) * d1 + t * d2\nwhile True:\n    pass"
    assert full(marks({"blend": before}, call_cpu_seconds=2)) == TASKS


def test_an_endless_loop_that_keeps_a_function_from_being_defined_costs_its_task(marks):
    after = "while True:\n    pass\nblend = lambda d1, d2, t: (1 - t) * d1 + t * d2"
    checks = marks({"blend": after}, call_cpu_seconds=2)
    assert full(checks) == [name for name in TASKS if name != "blend"]
    assert checks["blend"]["status"] == "timeout"


def test_the_framework_does_not_answer_a_task(marks):
    checks = marks({"sdf_box": "def sdf_box(p, center, half_size):\n    return fw.sdf.box(center, half_size)(p)"})
    assert checks["sdf_box"]["score"] == 0
    assert "framework.sdf.box would answer the task" in checks["sdf_box"]["message"]


@pytest.mark.parametrize(
    "source",
    [
        "    import solutions.sphere_tracing as s\n    return s.sdf_box(p, center, half_size)",
        "    from framework.sdf_primitives import Box\n    return Box(center, half_size)(p)",
        "    import importlib\n    return importlib.reload(fw.sdf).box(center, half_size)(p)",
        "    import importlib.util, pathlib\n"
        "    path = pathlib.Path(fw.__file__).parent / 'sdf.py'\n"
        "    spec = importlib.util.spec_from_file_location('copy', path)\n"
        "    copy = importlib.util.module_from_spec(spec)\n    spec.loader.exec_module(copy)\n"
        "    return copy.box(center, half_size)(p)",
    ],
    ids=["imports solutions", "imports a primitive", "reloads", "loads the file"],
)
def test_no_way_round_leads_to_an_answer(marks, source):
    checks = marks({"sdf_box": f"def sdf_box(p, center, half_size):\n{source}"})
    assert checks["sdf_box"]["score"] == 0 and checks["sdf_box"]["status"] == "error"


def test_a_task_is_not_served_by_a_later_one(marks):
    source = "def sdf_sphere(p, center, radius):\n    return sdf_torus(p, center, 0.0, radius)"
    checks = marks({"sdf_sphere": source})
    assert checks["sdf_sphere"]["score"] == 0 and "sdf_torus" in checks["sdf_sphere"]["message"]
    through_itself = "def sphere_trace(*a):\n    return soft_shadow(*a)\n\n\ndef soft_shadow(*a):\n    return sphere_trace(*a)"
    assert marks({"sphere_trace": through_itself})["sphere_trace"]["score"] == 0


def test_earlier_functions_are_answered_by_the_grader(marks):
    source = """
def smooth_union(d1, d2, k):
    h = np.maximum(k - abs(d1 - d2), 0)
    return blend(np.minimum(d1, d2), d2=np.minimum(d1, d2) - h * h / (4 * k), t=1.0)
"""
    checks = marks({"smooth_union": source, "blend": "def blend(d1, d2, t):\n    return np.nan"})
    assert checks["smooth_union"]["status"] == "pass"
    assert checks["blend"]["status"] == "error"


def test_a_table_of_the_public_answers_earns_at_most_the_public_part(marks):
    # the public inputs are known to everybody: answers to them, and nonsense for any other input
    source = """
import numpy as np
def sdf_sphere(p, center, radius, known={}):
    public = %r
    p = np.asarray(p)
    right = np.allclose(center, public)
    return (np.linalg.norm(p - center, axis=-1) - radius) if right else np.zeros(p.shape[:-1])
"""
    import numpy as np

    from autograder.judge import seed_of

    rng = np.random.default_rng(seed_of(b"", "sphere_tracing", "1.1", True))
    checks = marks({"sdf_sphere": source % list(rng.uniform(-1, 1, 3))})
    check = checks["sdf_sphere"]
    assert 0 < check["score"] <= 0.3 * check["max_score"] + 1e-9
    assert check["status"] == "partial" and "does not show" in check["message"]


def test_hidden_inputs_depend_on_the_secret():
    from autograder.judge import seed_of

    seeds = {seed_of(secret, "sphere_tracing", "1.1", False) for secret in (b"a", b"b")}
    assert len(seeds) == 2
    assert seed_of(b"a", "sphere_tracing", "1.1", True) == seed_of(b"b", "sphere_tracing", "1.1", True)
