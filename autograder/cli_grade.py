"""`course grade` and `course replay`: from a folder of strangers' notebooks to marks, and back to one of them."""

from __future__ import annotations

import concurrent.futures
import json
import sys
import tomllib
from dataclasses import fields
from pathlib import Path

from autograder.usage import Usage, compile_first, count, positive

LIMIT_HELP = {
    "call_cpu_seconds": "CPU time of one call",
    "call_wall_seconds": "wall time of one call",
    "submission_seconds": "wall time of a submission",
    "memory_mb": "memory of a process, and of a sandbox where it has a control group, in MiB",
    "file_mb": "size of a file that it may write, in MiB",
    "output_bytes": "bytes of its output that are kept",
}


def add_commands(commands):
    """Add the two commands to the parser's."""
    from autograder.sandbox import Limits

    grade = commands.add_parser(
        "grade", help="grade notebooks, folders of them, or zips",
        description="Grade every notebook found. Finished results in DIR are kept: stop and start as you like.",
        epilog="exit code: 0 every file got its result, 1 the grader failed, 2 wrong arguments, 3 only weak isolation",
    )  # fmt: skip
    grade.add_argument("paths", nargs="+", metavar="PATH", type=Path, help="a notebook, a zip, or a folder of them")
    grade.add_argument("--out", required=True, metavar="DIR", type=Path, help="where results, pages and grades.csv go")
    grade.add_argument("--jobs", type=count, metavar="N", help="submissions at a time (default: one a core)")
    grade.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster that grades, such as tcp://host:8786")
    _add_terms(grade)
    grade.add_argument("--points", metavar="FILE", type=Path, help="TOML: a table for each assignment, with the points "
                       "of its tasks where they are not as released; 0 leaves a task out")  # fmt: skip
    grade.add_argument("--regrade", metavar="STUDENT", action="append", default=[],
                       help="grade this student anew, finished or not (may be repeated)")  # fmt: skip
    grade.add_argument("--task", metavar="ID", action="append", default=[],
                       help="judge this task anew in every result and keep the others' marks (may be repeated)")  # fmt: skip
    grade.add_argument("--gradebook", metavar="URL", help="write the scores into nbgrader's gradebook too, "
                       "for instance sqlite:///gradebook.db")  # fmt: skip
    group = grade.add_argument_group("limits", "Far above need: they stop runaways and decide no mark. "
                                     "Where isolation is strong, a task may start threads but no processes.")  # fmt: skip
    for field in fields(Limits):
        kind = type(field.default)
        group.add_argument(f"--{field.name.replace('_', '-')}", type=positive(kind), default=field.default,
                           metavar="N", help=f"{LIMIT_HELP[field.name]} (default: %(default)s)")  # fmt: skip
    grade.set_defaults(run=_grade)

    replay = commands.add_parser(
        "replay", help="judge again what a result was made from, and compare the marks",
        epilog="exit code: 0 the same marks, 1 other marks, 2 it cannot be replayed, 3 only weak isolation",
    )  # fmt: skip
    replay.add_argument("result", metavar="RESULT.json", type=Path)
    replay.add_argument("--notebook", metavar="FILE", type=Path, help="where it is now (default: as the result says)")
    _add_terms(replay)
    replay.set_defaults(run=_replay)


def _add_terms(parser):
    parser.add_argument("--secret", metavar="FILE", type=Path, help="its bytes seed the inputs that students do not see")
    parser.add_argument("--allow-weak-isolation", action="store_true",
                        help="go on where only a plain process is to be had; results say so")  # fmt: skip


def _grade(options):
    from autograder import batch, cluster, discover, doctor, report, sandbox
    from autograder.unit import Job

    for path in options.paths:
        if not path.exists() and not path.is_symlink():
            raise Usage(f"{path} does not exist")
    secret, points = _secret(options.secret), _points(options.points)
    tasks = _tasks(options.task)
    places = cluster.connect(options.scheduler) if options.scheduler else batch.processes(options.jobs or doctor.cores())
    with places as place:
        if not _allowed(place.level, options.allow_weak_isolation):
            return 3
        try:
            options.out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise Usage(f"{options.out} cannot be made: {error.strerror}") from None
        compile_first()
        limits = sandbox.Limits(**{f.name: getattr(options, f.name) for f in fields(sandbox.Limits)})
        job = Job(str(options.out), place.level, limits, secret, points, frozenset(options.regrade), tasks)
        units = discover.find(options.paths, notice=lambda text: print(f"course: {text}", file=sys.stderr))
        unknown = job.regrade - {unit.student for unit in units}
        if unknown:
            raise Usage(f"--regrade {sorted(unknown)[0]}: there is no submission of that student")
        try:
            states, kept = _with_progress(units, job, place)
        except concurrent.futures.BrokenExecutor as broken:
            print(f"course: a process of the grader ended: {broken}; run the same command again", file=sys.stderr)
            return 1
        finally:
            report.write_grades(options.out)
            report.write_index(options.out)
    if options.gradebook:
        from autograder import gradebook

        print(f"{gradebook.record(options.out, options.gradebook)} submissions recorded in the gradebook")
    counts = ", ".join(f"{count} {state}" for state, count in sorted(states.items())) or "no notebook found"
    print(f"{len(units)} submissions: {counts}" + (f"; {kept} were done already" if kept else ""))
    print(f"open {options.out / 'index.html'}")
    return 0


def _with_progress(units, job, place):
    from tqdm import tqdm

    from autograder import batch

    kept = 0
    with tqdm(total=len(units), unit="submission", disable=not units) as bar:

        def progress(unit, status, was_kept):
            nonlocal kept
            kept += was_kept
            bar.set_postfix_str(f"{unit.student}: {status}", refresh=False)
            bar.update()

        return batch.run(units, job, place, progress), kept


def _replay(options):
    from autograder import discover, sandbox, unit
    from autograder import report_view as view

    try:
        result = view.read(options.result)
    except (OSError, ValueError) as problem:
        raise Usage(f"{options.result}: {problem}") from None
    made, secret = result.get("record", {}), _secret(options.secret)
    path = options.notebook or Path(made.get("file", ""))
    if not path.is_file():
        raise Usage(f"the notebook {path} is not there; --notebook FILE says where it is now")
    job = unit.Job("", sandbox.strongest_level(), sandbox.Limits(), secret, json.loads(made.get("points") or "{}"))
    if job.terms["secret"] != made.get("secret"):
        raise Usage("the result was made with another secret: --secret FILE must be the one of that run")
    one = discover.Unit(str(path), None, result["student"], result["assignment"])
    block = unit.block_of(one)
    if unit.fingerprint(block) != made.get("source"):
        raise Usage(f"{path} is not the file that the result was made from: its bytes are others")
    if not _allowed(job.level, options.allow_weak_isolation):
        return 3
    compile_first()
    now = unit.judge(one, block, job).result
    for name in ("course_version", "python", "numpy", "tolerances"):
        if now["record"][name] != made.get(name):
            print(f"{name}: {made.get(name)} then, {now['record'][name]} now")
    same = True
    for then, again in zip(result["checks"], now["checks"], strict=True):
        equal = all(then.get(key) == again[key] for key in ("status", "score", "max_score"))
        same &= equal
        inputs = "the same inputs" if then.get("inputs") == again["inputs"] else "OTHER INPUTS"
        marks = [f"{check['score']:g} of {check['max_score']:g}, {check['status']}" for check in (then, again)]
        print(f"{again['id']} {again['name']}: {marks[0] if equal else ' then, now '.join(marks)} ({inputs})")
        print(f"    {again['message']}")
    print("the same marks" if same else "OTHER MARKS")
    return 0 if same else 1


def _allowed(level, weak_is):
    from autograder import sandbox

    if level != sandbox.PROCESS:
        return True
    print("NOT ISOLATED: no sandbox starts here, and notebooks can do what you can (see `course doctor`)", file=sys.stderr)
    if not weak_is:
        print("course: nothing was graded; --allow-weak-isolation grades all the same", file=sys.stderr)
    return weak_is


def _secret(path):
    from autograder.grade import DEFAULT_SECRET

    if path is None:
        return DEFAULT_SECRET
    try:
        secret = path.read_bytes().strip()
    except OSError as error:
        raise Usage(f"the secret {path} cannot be read: {error.strerror}") from None
    if not secret:
        raise Usage(f"the secret {path} is empty")
    return secret


def _points(path) -> dict:
    """Assignment -> task id -> points, as the instructor's file says."""
    if path is None:
        return {}
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise Usage(f"the points {path} cannot be read: {problem}") from None
    known = _known_tasks()
    for name, table in tables.items():
        if name not in known or not isinstance(table, dict):
            raise Usage(f"{path}: there is no assignment {name!r}; there are {', '.join(known)}")
        for task, points in table.items():
            if task not in known[name]:
                raise Usage(f"{path}: {name} has no task {task!r}; it has {', '.join(known[name])}")
            if isinstance(points, bool) or not isinstance(points, (int, float)) or not 0 <= points < 1e6:
                raise Usage(f"{path}: the points of {task} are {points!r}; a number of at least 0 is wanted")
    return tables


def _tasks(ids):
    known = _known_tasks()
    for task in ids:
        if not any(task in tasks for tasks in known.values()):
            raise Usage(f"--task {task}: there is no such task")
    return frozenset(ids)


def _known_tasks():
    from autograder import checks

    return {name: [task.id for task in checks.assignment(name).tasks] for name in checks.available()}
