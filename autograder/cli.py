"""The `course` command."""

from __future__ import annotations

import argparse
import sys
from dataclasses import fields
from pathlib import Path

import framework

DESCRIPTION = """\
The environment mapping course. Students check their notebooks, instructors grade and release them.

  course check sphere_tracing.ipynb           the public checks of a notebook
  course grade submissions/ --out results     every notebook below a folder
  course doctor                               what this machine has, and what is missing"""


def main(arguments=None) -> int:
    """Run one command; returns the exit code."""
    parser = _parser()
    options = parser.parse_args(arguments)
    try:
        return options.run(options) or 0
    except KeyboardInterrupt:
        print("stopped; run the same command again to go on", file=sys.stderr)
        return 130
    except _Usage as problem:
        print(f"course: {problem}", file=sys.stderr)
        return 2


class _Usage(Exception):
    """Arguments that cannot be used: why, in one sentence."""


def _parser():
    parser = argparse.ArgumentParser(
        prog="course", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--version", action="version", version=f"course {framework.__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)

    check = commands.add_parser("check", help="run a notebook's public checks, in the terminal and as a page")
    check.add_argument("notebook", type=Path)
    check.set_defaults(run=_check)

    grade = commands.add_parser(
        "grade", help="grade notebooks, folders of them, or zips",
        description="Grade every notebook found. Finished results in DIR are kept: stop and start as you like.",
        epilog="exit code: 0 every file got its result, 1 the grader failed, 2 wrong arguments, 3 only weak isolation",
    )  # fmt: skip
    grade.add_argument("paths", nargs="+", metavar="PATH", type=Path, help="a notebook, a zip, or a folder of them")
    grade.add_argument("--out", required=True, metavar="DIR", type=Path, help="where results, pages and grades.csv go")
    grade.add_argument("--jobs", type=_count, metavar="N", help="submissions at a time (default: one a core)")
    grade.add_argument("--secret", metavar="FILE", type=Path, help="its bytes seed the inputs that students do not see")
    grade.add_argument("--allow-weak-isolation", action="store_true",
                       help="go on where only a plain process is to be had; results say so")  # fmt: skip
    grade.add_argument("--gradebook", metavar="URL", help="write the scores into nbgrader's gradebook too, "
                       "for instance sqlite:///gradebook.db")  # fmt: skip
    _add_limits(grade)
    grade.set_defaults(run=_grade)

    export = commands.add_parser("export", help="write graded results in another tool's format")
    export.add_argument("graded", metavar="DIR", type=Path, help="what `course grade --out DIR` has written")
    export.add_argument("--format", required=True, choices=("gradescope", "prairielearn", "csv"),
                        help="gradescope, prairielearn: a results.json for each submission, and for Gradescope the zip "
                        "to upload as autograder; csv: one table with a line for each task")  # fmt: skip
    export.add_argument("--out", metavar="DIR", type=Path, help="where to write (default: DIR/export/FORMAT)")
    export.set_defaults(run=_export)

    release = commands.add_parser("release", help="rebuild assignments/ from solutions/")
    release.add_argument("assignments", nargs="*", metavar="ASSIGNMENT", help="by default all")
    release.set_defaults(run=_release)

    references = commands.add_parser("references", help="build the reference images, or prove them")
    references.add_argument("action", choices=("build", "verify"),
                            help="build: make them anew; verify: measure them, exit 1 when something is off")  # fmt: skip
    references.add_argument("names", nargs="*", metavar="NAME", help="by default all")
    references.set_defaults(run=_references)

    techniques = _techniques()
    bench = commands.add_parser(
        "bench", help="run time against error: a CSV and a plot per technique",
        description="Measure how long each technique takes and how wrong it is; needs a clone of the repository.",
        epilog="\n".join(["techniques:", *(f"  {name:12} {about}" for name, about in techniques.items())]),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    bench.add_argument("name", nargs="?", metavar="NAME", help="a technique, see below; by default all")
    bench.add_argument("--out", required=True, metavar="DIR", type=Path, help="where NAME.csv and NAME.png go")
    bench.set_defaults(run=_bench)

    calibrate = commands.add_parser(
        "calibrate", help="measure the checks' tolerances against known right and wrong answers",
        description="Judge every known answer with many inputs. For each measure: the largest error of right answers, "
        "the tolerance, the nearest wrong answer that it catches, and the margins between them.",
        epilog="exit code: 0 all is well, 1 an answer has the wrong marks or a margin is below 1.5, 2 wrong arguments",
    )  # fmt: skip
    calibrate.add_argument("names", nargs="*", metavar="NAME",
                           help="assignments, or tasks by number or function; by default all")  # fmt: skip
    calibrate.add_argument("--seeds", type=_count, metavar="N", default=8, help="inputs for each answer (default: %(default)s)")
    calibrate.add_argument("--write", action="store_true", help="put the figures into tolerances.json")
    calibrate.set_defaults(run=_calibrate)

    doctor = commands.add_parser("doctor", help="what this machine has, what is missing, how to get it")
    doctor.set_defaults(run=_doctor)
    return parser


LIMIT_HELP = {
    "call_cpu_seconds": "CPU time of one call",
    "call_wall_seconds": "wall time of one call",
    "submission_seconds": "wall time of a submission",
    "memory_mb": "memory of a process, in MiB",
    "file_mb": "size of a file that it may write, in MiB",
    "output_bytes": "bytes of its output that are kept",
}


def _add_limits(parser):
    from autograder.sandbox import Limits

    group = parser.add_argument_group("limits", "Far above need: they stop runaways and decide no mark. "
                                      "Where isolation is strong, a task may start threads but no processes.")  # fmt: skip
    for field in fields(Limits):
        kind = type(field.default)
        group.add_argument(f"--{field.name.replace('_', '-')}", type=_positive(kind), default=field.default,
                           metavar="N", help=f"{LIMIT_HELP[field.name]} (default: %(default)s)")  # fmt: skip


def _count(text):
    return _positive(int)(text)


def _positive(kind):
    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = kind(0)
        if not 0 < value < float("inf"):
            raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
        return value

    return parse


def _check(options):
    import shutil
    import tempfile

    from autograder import batch, notebook, submission

    if not options.notebook.is_file():
        raise _Usage(f"{options.notebook} is not a file")
    _compile_first()
    try:
        result, judgements = notebook.check_file(options.notebook)
    except submission.Rejected as rejected:
        raise _Usage(f"{options.notebook}: {rejected}") from None
    for record in result["checks"]:
        sign, _, words = notebook.WORDS[record["status"]]
        said = "" if record["status"] in ("pass", "not_attempted") else f": {record['message']}"
        print(f"{sign} {record['id']} {record['name']}: {words}{said}")
    page = options.notebook.with_name(f"{options.notebook.stem}-check.html")
    with tempfile.TemporaryDirectory() as folder:
        batch.write(result, judgements, Path(folder), "you")
        shutil.copyfile(Path(folder) / "pages" / "you" / f"{result['assignment']}.html", page)
    print(f"open {page}")
    return 0


def _compile_first():
    """A task that waits for an answer of the grader's has no time for the grader to compile."""
    from framework import compiled

    if not compiled.is_complete():
        compiled.prepare()


def _grade(options):
    from tqdm import tqdm

    from autograder import batch, discover, doctor, report, sandbox
    from autograder.grade import DEFAULT_SECRET

    for path in options.paths:
        if not path.exists() and not path.is_symlink():
            raise _Usage(f"{path} does not exist")
    secret = DEFAULT_SECRET
    if options.secret is not None:
        try:
            secret = options.secret.read_bytes().strip()
        except OSError as error:
            raise _Usage(f"the secret {options.secret} cannot be read: {error.strerror}") from None
        if not secret:
            raise _Usage(f"the secret {options.secret} is empty")
    level = sandbox.strongest_level()
    if level == sandbox.PROCESS:
        print("NOT ISOLATED: this machine starts no sandbox, and notebooks can do what you can (see `course doctor`)",
              file=sys.stderr)  # fmt: skip
        if not options.allow_weak_isolation:
            print("course: nothing was graded; --allow-weak-isolation grades all the same", file=sys.stderr)
            return 3
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _Usage(f"{options.out} cannot be made: {error.strerror}") from None
    _compile_first()
    limits = sandbox.Limits(**{f.name: getattr(options, f.name) for f in fields(sandbox.Limits)})
    job = batch.Job(str(options.out), level, limits, secret)
    units = discover.find(options.paths, notice=lambda text: print(f"course: {text}", file=sys.stderr))
    jobs = options.jobs or doctor.cores()
    kept = 0
    with tqdm(total=len(units), unit="submission", disable=not units) as bar:

        def progress(unit, status, was_kept):
            nonlocal kept
            kept += was_kept
            bar.set_postfix_str(f"{unit.student}: {status}", refresh=False)
            bar.update()

        try:
            states = batch.run(units, job, jobs, progress)
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


def _export(options):
    from autograder import export, gradescope

    if not (options.graded / "results").is_dir():
        raise _Usage(f"{options.graded} holds no results/; the folder given to `course grade --out` is wanted")
    out = options.out or options.graded / "export" / options.format
    count, problems = export.export(options.graded, options.format, out)
    if options.format == "gradescope":
        gradescope.package(out / "autograder.zip")
    for problem in problems:
        print(f"course: left out, unreadable: {problem}", file=sys.stderr)
    print(f"{count} results in {out}")
    return 1 if problems else 0


def _release(options):
    from autograder import checks, public, release

    unknown = set(options.assignments) - set(release.ASSIGNMENTS)
    if unknown:
        raise _Usage(f"there is no assignment {sorted(unknown)[0]!r}; there are {', '.join(release.ASSIGNMENTS)}")
    release.release(options.assignments or None)
    for name in options.assignments or release.ASSIGNMENTS:
        if name in checks.available():
            print(f"{name}: public arrays, {public.record(name).stat().st_size >> 10} KiB")
    return 0


def _references(options):
    from tqdm import tqdm

    from autograder import references

    unknown = set(options.names) - set(references.names())
    if unknown:
        raise _Usage(f"there is no reference {sorted(unknown)[0]!r}; there are {', '.join(references.names())}")
    findings = []
    with tqdm(options.names or references.names(), unit="image", leave=False) as bar:
        for name in bar:
            bar.set_postfix_str(name)
            findings.append(getattr(references, options.action)(name))
    print(references.table(findings))
    return 1 if any(finding.problem for finding in findings) else 0


def _techniques():
    """Techniques that can be measured; none where only the packages are installed, and the repository is elsewhere."""
    root = Path(__file__).resolve().parents[1]
    if not (root / "benchmarks" / "harness.py").is_file():
        return {}
    sys.path.insert(0, str(root))
    try:
        from benchmarks import TECHNIQUES
    finally:
        sys.path.remove(str(root))
    return TECHNIQUES


def _bench(options):
    techniques = _techniques()
    if not techniques:
        raise _Usage("the benchmarks lie in the repository: clone it and install it there with `pip install -e .`")
    if options.name is not None and options.name not in techniques:
        raise _Usage(f"there is no technique {options.name!r}; there are {', '.join(techniques)}")
    from benchmarks import harness

    for name in [options.name] if options.name else techniques:
        print(f"{name}: {techniques[name]}", flush=True)
        try:
            lines = harness.bench(name, options.out)
        except OSError as error:
            raise _Usage(f"{options.out} cannot be written: {error.strerror}") from None
        print(*(f"  {line}" for line in lines), sep="\n")
        print(f"  written: {options.out / name}.csv and .png", flush=True)
    return 0


def _calibrate(options):
    from tqdm import tqdm

    from autograder import calibrate, calibration_report, doctor

    try:
        answers = calibrate.answers_of(options.names)
    except KeyError as unknown:
        raise _Usage(unknown.args[0]) from None
    with tqdm(total=len(answers), unit="answer") as bar:
        tables = calibrate.measure(answers, options.seeds, doctor.cores(), bar.update)
    print("\n".join(line for table in tables for line in calibration_report.lines(table)))
    print("\n".join(calibration_report.summary(tables)))
    if options.write:
        calibration_report.write(tables)
    return 1 if any(table.problems for table in tables) else 0


def _doctor(options):
    from autograder import doctor

    return doctor.report()


if __name__ == "__main__":
    sys.exit(main())
