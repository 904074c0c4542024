"""Known answers, run through the checks of their tasks."""

import functools
import importlib

from autograder import checks, mistakes
from autograder.judge import run_check, seed_of
from autograder.student import InMemory


@functools.cache
def answers(assignment):
    """id -> answer, of all that are known to an assignment's tasks."""
    return {a.id: a for a in mistakes.right_answers(assignment) + mistakes.mistakes(assignment)}


@functools.cache
def rounds(assignment, id, secrets):
    """The public round of an answer and one for each secret; a task's other function is right."""
    answer = answers(assignment)[id]
    return judged(assignment, answer.function, answer.code, secrets)


def judged(assignment, function, code, secrets):
    """The rounds of any function in the place of a task's."""
    task = checks.assignment(assignment).find(function)
    reference = importlib.import_module(f"solutions.{assignment}")
    calls = InMemory(
        {f.name: getattr(reference, f.name) for f in task.functions} | {function: code}, task
    ).call
    seeds = [(seed_of(b"", assignment, task.id, True), True)]
    seeds += [(seed_of(secret, assignment, task.id, False), False) for secret in secrets]
    return [run_check(task, calls, reference, seed, public) for seed, public in seeds]


def missed(round_):
    """The names of the measures that an answer does not meet, or why it was not judged to its end."""
    failed = {round_.failure.message} if round_.failure else set()
    return {m.name for m in round_.measures if m.credit < 1} or failed
