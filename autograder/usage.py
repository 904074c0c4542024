"""What commands share: the parser, how one runs, arguments that cannot be used, the first use of a machine."""

from __future__ import annotations

import argparse
import sys

import framework


class Usage(Exception):
    """Arguments that cannot be used: why, in one sentence."""


def parser_of(description):
    """The parser of `course`, and where its commands are added."""
    parser = argparse.ArgumentParser(
        prog="course", description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--version", action="version", version=f"course {framework.__version__}")
    return parser, parser.add_subparsers(title="commands", metavar="COMMAND", required=True)


def run(parser, arguments) -> int:
    """Run the command that the arguments name; returns the exit code."""
    options = parser.parse_args(arguments)
    try:
        return options.run(options) or 0
    except KeyboardInterrupt:
        print("stopped; run the same command again to go on", file=sys.stderr)
        return 130
    except Usage as problem:
        print(f"course: {problem}", file=sys.stderr)
        return 2


def count(text) -> int:
    """A whole number above 0."""
    return positive(int)(text)


def positive(kind):
    """A parser of numbers above 0 and below infinity."""

    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = kind(0)
        if not 0 < value < float("inf"):
            raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
        return value

    return parse


def compile_first():
    """A task that waits for an answer of the grader's has no time for the grader to compile."""
    from framework import compiled

    if not compiled.is_complete():
        compiled.prepare()
