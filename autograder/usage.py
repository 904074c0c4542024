"""What commands share: arguments that cannot be used, numbers from the command line, the first use of a machine."""

from __future__ import annotations

import argparse


class Usage(Exception):
    """Arguments that cannot be used: why, in one sentence."""


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
