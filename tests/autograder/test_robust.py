"""Through the sandbox: what a notebook does to its own process changes no mark, and no answer stops the grader."""

import nbformat
import numpy as np
import pytest

from autograder.grade import grade
from autograder.notebook import judge
from autograder.samples import filled_notebook
from autograder.sandbox import Limits, Pool

LOUD = """
import sys, warnings
def {name}({arguments}):
    warnings.warn("look out")
    print("here I am", "x" * 5000)
    print("and here", file=sys.stderr)
    return {right}
"""
BEFORE = {
    "warnings are errors": "import warnings\nwarnings.simplefilter('error')",
    "floating-point errors raise": "np.seterr(all='raise')",
    "floating-point errors call": "np.seterrcall(lambda *_: 1 / 0)\nnp.seterr(all='call')",
    "seeds are set": "import random\nnp.random.seed(0)\nrandom.seed(0)",
    "print options": "np.set_printoptions(precision=1, threshold=1)",
    "recursion": "import sys\nsys.setrecursionlimit(60)",
    "numpy is changed": "np.allclose = np.array_equal = lambda *a, **k: True\nnp.max = np.mean = lambda *a, **k: 0.0",
    "no output": "import sys\nsys.stdout = sys.stderr = None",
    "closed output": "import os\nos.close(1)\nos.close(2)",
    "the framework is changed": "fw.normalize = None\nimport autograder\nautograder.judge = None",
}
# Each leaves a right answer as it is, in another container.
WRAPPED = {
    "Fortran order": "np.asfortranarray(answer)",
    "every second one": "np.repeat(answer, 2, axis=0)[::2] if np.ndim(answer) else answer",
    "backwards twice": "answer[::-1].copy()[::-1] if np.ndim(answer) else answer",
    "read-only": "np.lib.stride_tricks.as_strided(answer, writeable=False)",
    "a subclass": "np.asarray(answer).view(type('Mine', (np.ndarray,), {'shape': property(lambda s: (1,))}))",
    "a masked array": "np.ma.masked_array(answer, mask=False)",
    "big-endian": "np.asarray(answer).astype('>f8')",
    "long double": "np.asarray(answer, np.longdouble)",
    "nested lists": "answer.tolist()",
    "a tuple": "tuple(answer.tolist()) if np.ndim(answer) == 1 else answer",
    "what has an __array__": "type('Own', (), {'__array__': lambda s, *a, **k: np.asarray(answer)})()",
    "its own memory": "np.frombuffer(bytearray(answer.tobytes())).reshape(answer.shape)",
}
REFUSED = {
    "objects": "np.asarray(answer, dtype=object)",
    "huge integers": "[10**400] * answer.size",
    "a huge integer": "10**400",
    "text": "'1.0'",
    "complex numbers": "answer + 0j",
    "dates": "np.zeros(answer.shape, 'M8[s]')",
    "records": "np.zeros(answer.shape, [('a', float)])",
    "a generator": "(x for x in answer)",
    "nothing": "None",
    "a set": "{1.0, 2.0}",
    "ragged": "[[1.0], [1.0, 2.0]]",
    "itself": "blend",
    "a module": "np",
    "an array that raises": "type('Bad', (), {'__array__': lambda s, *a, **k: 1 / 0})()",
    "an array that exits": "type('Bad', (), {'__array__': lambda s, *a, **k: exit(0)})()",
    "text that raises": "raises()",
}
RIGHT = "(1.0 - t) * d1 + t * d2"
WRONG = "d1 + t * d2"


def blend(answer, before="", right=RIGHT):
    """A cell; on its way to the answer there is a division by zero, and a mean of nothing, of which NumPy warns."""
    return (
        f"{before}\ndef blend(d1, d2, t):\n    np.ones(1) / np.zeros(1), np.mean([])\n"
        f"    answer = np.asarray({right})\n    return {answer}\n"
    )


@pytest.fixture(scope="module")
def pool(isolation):
    """Sandboxes that end with this module: other tests look for processes that were left."""
    with Pool(isolation, Limits()) as pool:
        yield pool


@pytest.fixture
def graded(tmp_path, pool):
    """Grades some tasks of a notebook whose blend, and whatever else is given, is replaced: task name -> check."""

    def run(**replaced):
        path = tmp_path / "sphere_tracing.ipynb"
        nbformat.write(filled_notebook("sphere_tracing", replaced), path)
        result = grade(path, "amy", pool, only={"1.1", "1.4", "1.6"})[0]
        assert result["status"] == "graded"
        return {check["name"]: check for check in result["checks"]}

    return run


def lost(checks):
    return sorted(name for name, check in checks.items() if check["score"] < check["max_score"])


@pytest.mark.parametrize("kind", BEFORE)
def test_what_a_cell_sets_costs_a_right_answer_nothing(kind, graded):
    # the reference's normals need the framework that this cell has broken
    other = ["estimate_normal"] if kind == "the framework is changed" else []
    assert lost(graded(blend=blend("answer", BEFORE[kind]))) == other


@pytest.mark.parametrize("kind", BEFORE)
def test_what_a_cell_sets_earns_a_wrong_answer_nothing(kind, graded):
    plain, changed = graded(blend=blend("answer", "", WRONG)), graded(blend=blend("answer", BEFORE[kind], WRONG))
    assert changed["blend"]["score"] == plain["blend"]["score"] < plain["blend"]["max_score"]
    assert changed["blend"]["error"] == plain["blend"]["error"]
    assert changed["blend"]["likely_mistake"] == plain["blend"]["likely_mistake"] == "blend-weight-missing"


def test_warnings_and_printed_text_cost_nothing(graded):
    assert lost(graded(blend=LOUD.format(name="blend", arguments="d1, d2, t", right=RIGHT))) == []


def test_inputs_that_are_written_over_cost_nothing(graded):
    spoiled = f"def blend(d1, d2, t):\n    answer = {RIGHT}\n    d1[...] = d2[...] = 7\n    return answer"
    in_place = "def sdf_sphere(p, center, radius):\n    p -= center\n    return np.linalg.norm(p, axis=-1) - radius"
    assert lost(graded(blend=spoiled, sdf_sphere=in_place)) == []


@pytest.mark.parametrize("kind", WRAPPED)
def test_a_right_answer_in_any_array_has_full_marks(kind, graded):
    assert lost(graded(blend=blend(WRAPPED[kind]))) == []


@pytest.mark.parametrize("kind", REFUSED)
def test_what_is_no_array_of_numbers_is_refused_in_a_sentence_and_costs_its_own_task(kind, graded):
    checks = graded(blend=blend(REFUSED[kind]))
    assert lost(checks) == ["blend"] and checks["blend"]["score"] == 0
    assert checks["blend"]["status"] == "error" and len(checks["blend"]["message"]) > 10


@pytest.mark.parametrize("kind", sorted(REFUSED | WRAPPED))
def test_a_notebook_judges_the_same_answers_alike(kind):
    space = {"np": np}
    exec(blend((REFUSED | WRAPPED)[kind]), space)
    assert judge("1.4", space)["status"] == ("error" if kind in REFUSED else "pass")


def test_a_notebook_keeps_its_inputs_and_its_settings():
    def spoiled(chain, roughness_levels, direction, roughness):
        np.seterr(all="raise")
        for part in chain:
            part[...] = 7.0
        return np.full(direction.shape, 7.0)

    before = np.geterr()
    assert judge("3.5", {"sample_chain": spoiled})["status"] == "fail"
    assert np.geterr() == before
