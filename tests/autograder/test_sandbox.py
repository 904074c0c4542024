"""The real sandbox: what a stranger's code finds there, and what it cannot do."""

import nbformat
import pytest

from autograder import checks, sandbox
from autograder.grade import grade
from autograder.samples import filled_notebook
from autograder.sandbox import Limits, Pool, strongest_level
from framework import compiled

ROOT = sandbox.ROOT
strong = pytest.mark.skipif(strongest_level() == sandbox.PROCESS, reason="this machine starts no sandbox")
RIGHT = "\n    return np.linalg.norm(np.asarray(p) - center, axis=-1) - radius"


@pytest.fixture
def first(tmp_path):
    """Judges a notebook whose `sdf_sphere` has this body; the check, with its neighbours still at full marks."""

    def run(body, level=None, blend=None, **limits):
        source = f"def sdf_sphere(p, center, radius):\n    {body}{RIGHT}"
        left_out = dict.fromkeys(("sdf_torus", "smooth_union", "estimate_normal", "sphere_trace"))
        replacements = left_out | {"sdf_sphere": source} | ({"blend": blend} if blend else {})
        path = tmp_path / "sphere_tracing.ipynb"
        nbformat.write(filled_notebook("sphere_tracing", replacements), path)
        with Pool(level or strongest_level(), Limits(**limits)) as pool:
            result, _ = grade(path, "amy", pool)
        for check in result["checks"]:
            if check["name"] == "sdf_box" or (check["name"] == "blend" and not blend):
                assert check["score"] == check["max_score"], check
        run.result = result
        return result["checks"][0]

    return run


@strong
@pytest.mark.parametrize(
    "body",
    [
        "import socket; socket.create_connection(('127.0.0.1', 80), 1)",
        "import socket; socket.socket(socket.AF_UNIX)",
        "import urllib.request; urllib.request.urlopen('http://127.0.0.1/')",
        "import os; os.fork()",
        "import subprocess; subprocess.run(['true'])",
        "import multiprocessing; multiprocessing.Process(target=print).start()",
        "import os; os.kill(os.getppid(), 9)",
        "import os; os.kill(-1, 9)",
        f"open({str(ROOT / 'README.md')!r})",
        f"import os; os.listdir({str(ROOT / 'solutions')!r})",
        "import solutions",
        "import autograder.checks",
        "import autograder.mistakes",
        "open('/etc/passwd')",
        "open('/proc/self/environ')",
        "import os; os.listdir(os.path.expanduser('~root/.ssh'))",
        "open('/course/framework/x', 'w')",
        "open('/usr/x', 'w')",
        "open('/course/compiled/x', 'w')",
        "import os; os.mkdir('/course/compiled')",
        "import glob; open(glob.glob('/course/compiled/*/*')[0], 'r+b')",
        "import os; os.chmod(np.__file__, 0o777)",
        "import ctypes; raise OSError(ctypes.CDLL(None).ptrace(0, 0, 0, 0))",
        "import os; os.memfd_create('x')",
        "import os; os.unshare(os.CLONE_NEWNS) if hasattr(os, 'unshare') else os.mkdir('/x')",
        "np.zeros(1 << 30)",
        "open('big', 'wb').write(bytes(100 << 20))",
        "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (-1, -1))",
    ],
)
def test_what_no_solution_needs_fails_and_costs_its_own_task_alone(first, body):
    check = first(body)
    assert check["status"] in ("error", "out_of_memory") and check["score"] == 0
    assert check["traceback"] or check["status"] == "out_of_memory"


@strong
def test_memory_beyond_the_limit_is_told_as_such(first):
    check = first("x = np.ones(60 << 20)", memory_mb=400)
    assert check["status"] == "out_of_memory" and check["score"] == 0


@strong
@pytest.mark.parametrize(
    ("body", "status", "words"),
    [
        ("import os; os._exit(0)", "crashed", "exit code 0"),
        ("import os; os._exit(3)", "crashed", "exit code 3"),
        ("import ctypes; ctypes.string_at(0)", "crashed", "SIGSEGV"),
        ("import os; os.abort()", "crashed", "SIGABRT"),
        ("import sys; sys.exit(0)", "error", "SystemExit"),
        ("raise KeyboardInterrupt", "error", "KeyboardInterrupt"),
        ("import gc; [o for o in gc.get_objects() if type(o).__name__ == 'Task'][0].link.close()", "crashed", ""),
        ("import gc; [o for o in gc.get_objects() if type(o).__name__ == 'Task'][0].link.sendall(bytes(5000))",
         "crashed", ""),
    ],
)  # fmt: skip
def test_a_process_that_ends_costs_its_own_task_alone(first, body, status, words):
    check = first(body)
    assert check["status"] == status and words in check["message"]


@strong
def test_a_call_that_sleeps_is_late_once_and_again(first):
    check = first("import time; time.sleep(60)", call_wall_seconds=0.7)
    assert check["status"] == "timeout" and "0.7 s" in check["message"]


@strong
def test_the_submission_has_a_deadline(first, tmp_path):
    path = tmp_path / "all.ipynb"
    order = [task.name for task in checks.assignment("sphere_tracing").tasks]
    asleep = {name: f"def {name}(*a):\n    import time\n    time.sleep(9)" for name in order}
    nbformat.write(filled_notebook("sphere_tracing", asleep), path)
    with Pool(strongest_level(), Limits(submission_seconds=3)) as pool:
        result, _ = grade(path, "amy", pool, assignment="sphere_tracing")
    assert result["status"] == "timeout" and result["wall_seconds"] < 6


@strong
def test_tasks_see_nothing_of_each_other(first):
    look = "def blend(d1, d2, t):\n    import os\n    left = os.listdir('.') + os.listdir('/dev/shm')\n"
    look += "    return (1 - t) * d1 + t * d2 + len(left)"
    check = first(
        "open('left', 'w').write('x'); open('/dev/shm/left', 'w').write('x'); fw.left = 1; np.pi = 3",
        blend=look,
    )
    assert check["status"] == "pass"
    assert first.result["checks"][3]["status"] == "pass"


@pytest.mark.parametrize("level", [strongest_level(), sandbox.PROCESS])
def test_a_task_runs_the_framework_from_a_copy_of_the_compiled_code(first, level):
    compiled.prepare()
    look = "from framework import lookup_kernel as kernel\n    kernel.warm()\n    if kernel.bilinear.stats.cache_misses:\n"
    assert first(look + "        raise OSError('it was compiled anew')", level)["status"] == "pass"


@strong
def test_threads_of_a_task_end_with_it(first):
    body = "import threading, time; threading.Thread(target=lambda: [open('t', 'w') for _ in iter(int, 1)]).start()"
    assert first(body)["status"] in ("pass", "timeout")


@strong
def test_what_is_printed_is_kept_as_text_and_bounded(first):
    check = first("print('<script>alert(1)</script>')")
    assert check["status"] == "pass" and "<script>" in check["prints"]
    check = first("print('x' * (5 << 20))", output_bytes=1 << 16)
    assert check["status"] == "pass" and len(check["prints"]) == 1 << 16


@strong
def test_changed_settings_of_numpy_change_no_mark(first):
    body = "np.seterr(all='raise'); np.random.seed(1); import warnings; warnings.simplefilter('error'); p[...] = p"
    assert first(body)["status"] == "pass"


@strong
def test_the_peak_of_memory_is_recorded(first):
    first("x = np.ones(30 << 20)")
    assert 200 < first.result["peak_memory_mb"] < 600


def test_a_plain_process_is_recorded_as_such_and_ends_what_it_started(first, tmp_path):
    mark = tmp_path / "alive"
    again = f"[open({str(mark)!r}, 'w').close() or __import__('time').sleep(0.05) for _ in iter(int, 1)]"
    body = f"import os; os.fork() or {again}"
    check = first(body, level=sandbox.PROCESS)
    assert first.result["isolation"] == "process"
    assert check["score"] <= check["max_score"]
    import time

    time.sleep(0.3)
    mark.unlink(missing_ok=True)
    time.sleep(0.3)
    assert not mark.exists()


def test_a_plain_process_has_no_solutions_to_import(first):
    check = first("import solutions", level=sandbox.PROCESS)
    assert check["status"] == "error" and check["score"] == 0


@strong
def test_a_call_that_uses_up_its_time_of_the_processor_is_told_so(first):
    check = first("while True: pass", call_cpu_seconds=1)
    assert check["status"] == "timeout" and "CPU" in check["message"]


@strong
@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("return fw.sdf.sphere(center, radius)(p)", "would answer the task"),
        ("from framework.sdf import sphere; return sphere(center, radius)(p)", "would answer the task"),
        ("sdf_torus(p, center, 1.0, 0.5)", "sdf_torus"),
    ],
    ids=["by name", "by import", "a higher task"],
)
def test_what_would_answer_a_task_is_not_there(first, body, words):
    check = first(body)
    assert check["status"] == "error" and words in check["message"]


@strong
def test_lower_tasks_are_answered_by_the_grader(first):
    """Its own 1.1 is broken; in 1.4 the name holds the reference."""
    zero = "sdf_sphere(np.array([0, 3.0, 4.0]), np.zeros(3), radius=5.0)"
    blend = f"def blend(d1, d2, t):\n    return (1 - t) * d1 + t * d2 + {zero}"
    assert first("return 0 * p[..., 0]", blend=blend)["score"] == 0
    assert first.result["checks"][3]["status"] == "pass"


@strong
def test_a_request_to_a_lower_task_for_gigabytes_fails_in_its_own_task(first):
    blend = (
        "def blend(d1, d2, t):\n    return sdf_sphere(np.zeros((20000, 1, 3)), np.zeros((1, 20000, 3)), 1.0)"
    )
    assert first("", blend=blend)["status"] == "pass"
    assert (
        first.result["checks"][3]["status"] == "error"
        and "MemoryError" in first.result["checks"][3]["message"]
    )
