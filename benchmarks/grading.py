"""How many submissions a minute: `python -m benchmarks.grading`.

Grades varied submissions to sphere_tracing by `course grade`, 20 and then 200, and the same 20 by nbgrader's own
`autograde`: its `Execute` preprocessor, which runs the notebook with the checks that it shows. Prints both rates and the
grader's memory: all of its processes, without the students' behind the wall.
"""

import argparse
import ast
import inspect
import os
import subprocess
import sys
import tempfile
import textwrap
import time
from pathlib import Path

import nbformat
import numpy as np

from autograder import mistakes, samples
from autograder.release import write_source

NAME = "sphere_tracing"
ROOT = Path(__file__).parents[1]


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.grading", description=__doc__)
    parser.add_argument("--few", type=int, default=20, metavar="N", help="graded by nbgrader too (default: 20)")
    parser.add_argument("--many", type=int, default=200, metavar="N", help="graded by the course alone (default: 200)")
    parser.add_argument("--without-nbgrader", action="store_true", help="leave nbgrader's run out")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="course-") as folder:
        few, many = (Path(folder, str(count)) for count in (options.few, options.many))
        for path, count in ((few, options.few), (many, options.many)):
            hand_in(path, count)
        ours, memory = graded(few, options.few)
        print(f"course grade, {options.few} submissions: {ours:.1f} a minute, {memory:.0f} MB", flush=True)
        rate, larger = graded(many, options.many)
        print(f"course grade, {options.many} submissions: {rate:.1f} a minute, {larger:.0f} MB, {larger - memory:+.0f} MB")
        if not options.without_nbgrader:
            stock = autograded(Path(folder), few, options.few)
            print(f"nbgrader autograde, {options.few} submissions: {stock:.1f} a minute")
            print(f"{ours / stock:.1f} times as many")


def hand_in(folder, count):
    """Write submissions of that many students: to each task the reference's answer, another right one, or a mistake."""
    rng = np.random.default_rng(7)
    right, wrong = _sources(mistakes.right_answers(NAME)), _sources(mistakes.mistakes(NAME))
    for i in range(count):
        answers = {}
        for function in right:
            kind = rng.choice(["reference", "right", "wrong"], p=[0.5, 0.25, 0.25])
            if kind != "reference":
                answers[function] = str(rng.choice((right if kind == "right" else wrong)[function]))
        path = folder / f"student{i:03d}" / NAME / f"{NAME}.ipynb"
        path.parent.mkdir(parents=True)
        nbformat.write(samples.filled_notebook(NAME, answers), path)


def _sources(answers):
    """Function -> sources of its answers that stand alone: those which call nothing else of their module."""
    found = {}
    for answer in answers:
        code = answer.code
        globals_ = set(inspect.getclosurevars(code).globals) - {"np", "fw"}
        if code.__closure__ or globals_ or getattr(code, "verdict", None) == mistakes.COSTLY:
            continue
        node = ast.parse(textwrap.dedent(inspect.getsource(code))).body[0]
        node.name, node.decorator_list = answer.function, []
        found.setdefault(answer.function, []).append(ast.unparse(node))
    return found


def graded(folder, count):
    """Submissions a minute of `course grade`, and the grader's largest memory in MB."""
    command = [sys.executable, "-c", "import sys; from autograder.cli import main; sys.exit(main())", "grade", str(folder),
               "--out", str(folder / "out"), "--allow-weak-isolation", "--jobs", "2"]  # fmt: skip
    begun, most = time.monotonic(), 0.0
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as grader:
        while grader.poll() is None:
            most = max(most, _memory(grader.pid))
            time.sleep(0.2)
    if grader.returncode:
        raise SystemExit(f"course grade ended with {grader.returncode}")
    return 60 * count / (time.monotonic() - begun), most


def _memory(pid):
    """Proportional set size of a process and of those it started, but for sandboxes, in MB."""
    try:
        if b"bwrap" in Path(f"/proc/{pid}/cmdline").read_bytes():
            return 0.0
        rollup = Path(f"/proc/{pid}/smaps_rollup").read_text()
        own = next(int(line.split()[1]) for line in rollup.splitlines() if line.startswith("Pss:")) / 1024
        children = [word for file in Path(f"/proc/{pid}/task").glob("*/children") for word in file.read_text().split()]
    except (OSError, StopIteration):  # it has ended meanwhile
        return 0.0
    return own + sum(map(_memory, children))


def autograded(folder, submitted, count):
    """Submissions a minute of nbgrader as it comes, without this course's configuration."""
    course = folder / "course"
    write_source(NAME, course / "source")
    (course / "submitted").symlink_to(submitted)
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    for command in ("generate_assignment", "autograde"):
        begun = time.monotonic()
        subprocess.run(["nbgrader", command, NAME], cwd=course, env=os.environ | {"PATH": path}, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
    return 60 * count / (time.monotonic() - begun)


if __name__ == "__main__":
    main()
