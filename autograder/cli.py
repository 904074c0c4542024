"""The `course` command."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from autograder import cli_grade, cli_student
from autograder.usage import Usage, compile_first, count, parser_of, run

DESCRIPTION = """\
The environment mapping course. Students check their notebooks, instructors grade and release them.

  course start sphere_tracing                 a folder with the notebook, to work in
  course check sphere_tracing.ipynb           the public checks of a notebook
  course grade submissions/ --out results     every notebook below a folder
  course doctor                               what this machine has, and what is missing"""


def main(arguments=None) -> int:
    """Run one command; returns the exit code."""
    return run(_parser(), arguments)


def _parser():
    parser, commands = parser_of(DESCRIPTION)
    cli_student.add_commands(commands)
    cli_grade.add_commands(commands)

    bundle = commands.add_parser(
        "bundle", help="make the zip to hand out to students, which installs and works on its own",
        description="Pack what students get: the framework, the assignments, and the public half of the checks. "
        "No solution and no hidden input is in it. Its README leads from the zip to a checked notebook.",
    )  # fmt: skip
    bundle.add_argument("--out", metavar="ZIP", type=Path, default=Path("course.zip"), help="default: %(default)s")
    bundle.set_defaults(run=_bundle)

    export = commands.add_parser("export", help="write graded results in another tool's format")
    export.add_argument("graded", metavar="DIR", type=Path, help="what `course grade --out DIR` has written")
    export.add_argument("--format", required=True, choices=("gradescope", "prairielearn", "csv"),
                        help="gradescope, prairielearn: a results.json for each submission, and for Gradescope the zip "
                        "to upload as autograder; csv: one table with a line for each task")  # fmt: skip
    export.add_argument("--out", metavar="DIR", type=Path, help="where to write (default: DIR/export/FORMAT)")
    export.set_defaults(run=_export)

    report = commands.add_parser(
        "report", help="what a class got right and wrong, as one page",
        description="Write DIR/report.html: marks by task, frequent mistakes, tasks that separate strong from weak, run time "
        "against error, submissions that want a person's look, and pairs of solutions that are nearly the same.",
    )  # fmt: skip
    report.add_argument("graded", metavar="DIR", type=Path, help="what `course grade --out DIR` has written")
    report.add_argument("--submissions", nargs="+", metavar="PATH", type=Path, default=[],
                        help="the notebooks as given to `course grade`; without them solutions are not compared")  # fmt: skip
    report.set_defaults(run=_report)

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
        "the tolerance, the nearest wrong answer that it catches, and the margins between them. Then judge mutants of the "
        "references, and say which keep all marks, and why.",
        epilog="exit code: 0 all is well, 1 an answer or a mutant has the wrong marks or a margin is below 1.5, 2 wrong "
        "arguments",
    )  # fmt: skip
    calibrate.add_argument("names", nargs="*", metavar="NAME",
                           help="assignments, or tasks by number or function; by default all")  # fmt: skip
    calibrate.add_argument("--seeds", type=count, metavar="N", default=8, help="inputs for each answer (default: %(default)s)")
    calibrate.add_argument("--write", action="store_true", help="put the figures into tolerances.json")
    calibrate.set_defaults(run=_calibrate)

    stress = commands.add_parser(
        "stress", help="the numerical-stability sweeps, as a table",
        description="Sweep every function over inputs that break fragile code; measure errors and invariants against bounds.",
        epilog="exit code: 0 all bounds hold, 1 one does not, 2 wrong arguments",
    )  # fmt: skip
    stress.add_argument("name", nargs="?", metavar="NAME", help="one sweep; by default all")
    stress.set_defaults(run=_stress)

    doctor = commands.add_parser("doctor", help="what this machine has, what is missing, how to get it")
    doctor.set_defaults(run=_doctor)
    return parser


def _export(options):
    from autograder import export, gradescope

    if not (options.graded / "results").is_dir():
        raise Usage(f"{options.graded} holds no results/; the folder given to `course grade --out` is wanted")
    out = options.out or options.graded / "export" / options.format
    count, problems = export.export(options.graded, options.format, out)
    if options.format == "gradescope":
        gradescope.package(out / "autograder.zip")
    for problem in problems:
        print(f"course: left out, unreadable: {problem}", file=sys.stderr)
    print(f"{count} results in {out}")
    return 1 if problems else 0


def _bundle(options):
    from autograder import bundle

    try:
        files = bundle.write(options.out)
    except OSError as error:
        raise Usage(f"{options.out} cannot be written: {error.strerror}") from None
    print(f"{options.out}: {len(files)} files, {options.out.stat().st_size >> 10} KiB; its README.md says what to do")
    return 0


def _report(options):
    from autograder import class_report

    if not (options.graded / "results").is_dir():
        raise Usage(f"{options.graded} holds no results/; the folder given to `course grade --out` is wanted")
    for path in options.submissions:
        if not path.exists():
            raise Usage(f"{path} does not exist")
    page = class_report.write(options.graded, options.submissions, lambda text: print(f"course: {text}", file=sys.stderr))
    print(f"open {page}")
    return 0


def _release(options):
    from autograder import checks, likely_record, public, release

    unknown = set(options.assignments) - set(release.ASSIGNMENTS)
    if unknown:
        raise Usage(f"there is no assignment {sorted(unknown)[0]!r}; there are {', '.join(release.ASSIGNMENTS)}")
    release.release(options.assignments or None)
    for name in options.assignments or release.ASSIGNMENTS:
        if name in checks.available():
            kib = [path.stat().st_size >> 10 for path in (public.record(name), likely_record.record(name))]
            print(f"{name}: public arrays, {kib[0]} KiB; what known mistakes answer, {kib[1]} KiB")
    return 0


def _references(options):
    from tqdm import tqdm

    from autograder import references

    unknown = set(options.names) - set(references.names())
    if unknown:
        raise Usage(f"there is no reference {sorted(unknown)[0]!r}; there are {', '.join(references.names())}")
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
        raise Usage("the benchmarks lie in the repository: clone it and install it there with `pip install -e .`")
    if options.name is not None and options.name not in techniques:
        raise Usage(f"there is no technique {options.name!r}; there are {', '.join(techniques)}")
    from benchmarks import harness

    for name in [options.name] if options.name else techniques:
        print(f"{name}: {techniques[name]}", flush=True)
        try:
            lines = harness.bench(name, options.out)
        except OSError as error:
            raise Usage(f"{options.out} cannot be written: {error.strerror}") from None
        print(*(f"  {line}" for line in lines), sep="\n")
        print(f"  written: {options.out / name}.csv and .png", flush=True)
    return 0


def _calibrate(options):
    from tqdm import tqdm

    from autograder import calibrate, calibration_report, doctor, mutation

    try:
        answers = calibrate.answers_of(options.names)
    except KeyError as unknown:
        raise Usage(unknown.args[0]) from None
    with tqdm(total=len(answers), unit="answer") as bar:
        tables = calibrate.measure(answers, options.seeds, doctor.cores(), bar.update)
    chosen = mutation.chosen_for(answers)
    with tqdm(total=len(chosen), unit="mutant") as bar:
        verdicts = mutation.run(chosen, doctor.cores(), bar.update)
    print("\n".join(line for table in tables for line in calibration_report.lines(table)))
    print("\n".join(mutation.lines(verdicts)))
    print("\n".join([*calibration_report.summary(tables), mutation.summary(verdicts)]))
    if options.write:
        calibration_report.write(tables)
    for problem in mutation.problems(verdicts):
        print(f"! {problem}")
    return 1 if any(table.problems for table in tables) or mutation.problems(verdicts) else 0


def _stress(options):
    from tqdm import tqdm

    from solutions import stress

    if options.name is not None and options.name not in stress.SWEEPS:
        raise Usage(f"there is no sweep {options.name!r}; there are {', '.join(stress.SWEEPS)}")
    compile_first()
    rows = []
    for name in [options.name] if options.name else stress.SWEEPS:
        with tqdm(stress.sweep(name), desc=name, unit="claim", leave=False) as bar:
            found = list(bar)
        print(f"{name}: {stress.SWEEPS[name]}", *(f"  {line}" for line in stress.table(found)), "", sep="\n", flush=True)
        rows += found
    broken = [row for row in rows if not row.holds]
    nonfinite = sum(row.nonfinite for row in rows)
    print(f"{stress.points(rows):,} points, {nonfinite} outputs not finite, {len(broken)} of {len(rows)} bounds broken")
    for row in broken:
        print(f"  {row.function}, {row.claim}: {row.worst:.2g}, of at most {row.bound:.2g}; {row.nonfinite} not finite")
    return 1 if broken else 0


def _doctor(options):
    from autograder import doctor

    return doctor.report()


if __name__ == "__main__":
    sys.exit(main())
