"""What is asked of each task, and how an answer is measured; one file per assignment.

A check is a generator: it calls the student's functions as if they were its own, and yields measures. It runs twice,
with the inputs that the notebook shows (30 % of the points) and with hidden ones. What it needs to know of the right
answer comes from `trial.expected`: the reference where the solutions are at hand, recorded arrays where they are not.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from autograder.student import Failure
from autograder.wall import Returns

ASSIGNMENTS = ("sphere_tracing", "soft_shadows", "prefilter", "split_sum", "environment_shadows")
HERE = Path(__file__).parent


@dataclass(frozen=True)
class Measure:
    """One thing that was measured: an error against its tolerance, and what that is worth.

    `credit` is 1 within the tolerance and 0 beyond it, unless the check says otherwise; `share` weighs the measure
    among its task's. A `property` is what wrong answers may have too, such as symmetry: it counts only as far as the
    values are right. `work` marks the measure of SDF evaluations, which counts only once all others pass.
    """

    name: str
    metric: str
    error: float
    tolerance: float
    credit: float
    share: float = 1.0
    message: str = ""
    property: bool = False
    work: bool = False
    evaluations: int | None = None
    evaluations_reference: int | None = None


@dataclass(frozen=True)
class Picture:
    """Two images to lay side by side: what the student's function gives, and what it should give."""

    yours: np.ndarray
    expected: np.ndarray
    kind: str
    caption: str


@dataclass(frozen=True)
class Function:
    """A function that a task asks for: the shape of its result, from the arguments.

    `digest` makes of (arguments, values) of a call what is compared with known mistakes: by default the values.
    """

    name: str
    returns: Callable[..., Returns]
    infinite: bool = False
    digest: Callable = lambda arguments, values: values


@dataclass(frozen=True)
class Task:
    """A numbered task: its functions and its check."""

    id: str
    assignment: str
    functions: tuple[Function, ...]
    check: Callable[[Trial], Iterator[Measure]]
    forbidden: tuple[str, ...] = ()

    @property
    def name(self):
        return self.functions[0].name

    @property
    def asks(self):
        """What the task asks for, in one sentence."""
        return " ".join((self.check.__doc__ or "").split("\n\n")[0].split())


class Assignment:
    """The tasks of one assignment, in order; `forbidden` are modules of the framework that would answer them."""

    def __init__(self, name, forbidden=()):
        self.name, self.forbidden = name, tuple(forbidden)
        self.tasks: list[Task] = []

    def task(self, id, *functions, forbidden=()):
        """Declare a task: decorates its check."""

        def declare(check):
            self.tasks.append(Task(id, self.name, functions, check, self.forbidden + tuple(forbidden)))
            return check

        return declare

    def find(self, id) -> Task:
        """The task of this number or name."""
        for task in self.tasks:
            if id in (task.id, *(f.name for f in task.functions)):
                return task
        known = ", ".join(f"{task.id} {task.name}" for task in self.tasks)
        raise KeyError(f"{self.name} has no task {id!r}; it has {known}")


def assignment(name) -> Assignment:
    """The tasks of an assignment, by its name."""
    return importlib.import_module(f"autograder.checks.{name}").assignment


def available() -> list[str]:
    """The assignments that this installation has checks for."""
    return [name for name in ASSIGNMENTS if (HERE / f"{name}.py").is_file()]


@dataclass
class Trial:
    """One run of a check: the student's functions, the expected ones, the inputs' seed, and what was seen.

    Attributes
    ----------
    student, expected : namespaces of functions
    rng : numpy.random.Generator    of the public or of the hidden inputs
    public : bool                   whether these are the inputs that the notebook shows
    picture : Picture or None       what the check wants shown
    measured : list                 (name, error, tolerance) of all that was held against a record
    calls : list                    (function, arguments, values) of all calls; NaN where one failed
    """

    task: Task
    student_calls: Callable
    expected: object
    rng: np.random.Generator
    public: bool
    picture: Picture | None = None
    calls: list = field(default_factory=list)
    measured: list = field(default_factory=list)

    @property
    def student(self):
        return _Functions(self)

    def call(self, *arguments, name=None):
        """What the student's function returns; an answer with NaN cannot be judged."""
        function = self._function(name)
        returns = function.returns(*arguments)
        try:
            values = self.student_calls(function.name, arguments, returns)
        except Failure:
            self.calls.append((function.name, arguments, [np.full(shape, np.nan) for shape in returns.shapes]))
            raise
        self.calls.append((function.name, arguments, values))
        for value in values:
            _refuse_not_finite(function, value, arguments)
        return values if returns.sequence else values[0]

    def both(self, *arguments, name=None):
        """The student's answer and the expected one, for the same arguments."""
        function = self._function(name)
        return self.call(*arguments, name=name), getattr(self.expected, function.name)(*arguments)

    def show(self, yours, expected, kind, caption):
        """Keep two images for the page; the first that a check shows is the one."""
        self.picture = self.picture or Picture(np.array(yours), np.array(expected), kind, caption)

    def close(self, name, got, want, scale=1.0, share=1.0, message="", property=False):
        """A measure: the largest error, over `scale`, against the recorded tolerance."""
        error = float(np.max(np.abs(np.asarray(got, float) - want) / scale, initial=0.0))
        return self.at_most(name, error, share=share, message=message, property=property)

    def at_most(self, name, error, share=1.0, message="", credit=None, property=False):
        """A measure: `error` against the tolerance recorded under this name."""
        record = tolerance(self.task.id, name)
        limit = record["tolerance"]
        self.measured.append((name, float(error), limit))
        if credit is None:
            credit = 1.0 if error <= limit else 0.0
        return Measure(name, record["metric"], float(error), limit, credit, share, message, property)

    def survives(self, name, measures, share=1.0, message=""):
        """A measure of cases at the edge: an exception or a wrong shape there costs this measure, not the task."""
        try:
            error = max(measure.error / measure.tolerance for measure in measures())
        except Failure as failure:
            if failure.status not in ("error", "not_attempted"):
                raise
            return Measure(name, "cases", np.inf, 1.0, 0.0, share, f"{message} {failure.message}".strip(), True)
        return Measure(name, "error / tolerance", float(error), 1.0, float(error <= 1.0), share, message, True)

    def work(self, evaluations, units):
        """The measure of SDF evaluations: full up to 1.5 times the stored figure plus 2 a ray, nothing at 4 times."""
        reference = int(round(tolerance(self.task.id, "work")["per_unit"] * units))
        full, nothing = 1.5 * reference + 2 * units, 4.0 * reference
        credit = float(np.clip((nothing - evaluations) / max(nothing - full, 1e-12), 0.0, 1.0))
        credit = 1.0 if evaluations <= full else credit
        message = f"{evaluations} evaluations of the distance field, where the reference needs {reference}"
        return Measure("work", "evaluations", float(evaluations), full, credit, 1.0, message, False, True,
                       int(evaluations), reference)  # fmt: skip

    def _function(self, name):
        for function in self.task.functions:
            if name in (None, function.name):
                return function
        raise KeyError(name)


class _Functions:
    """Attribute access to the functions of a trial's task."""

    def __init__(self, trial):
        self._trial = trial

    def __getattr__(self, name):
        return functools.partial(self._trial.call, name=name)


def _refuse_not_finite(function, value, arguments):
    bad = np.isnan(value) if function.infinite else ~np.isfinite(value)
    if not bad.any():
        return
    where, first = "", np.asarray(arguments[0] if isinstance(arguments[0], (np.ndarray, float, int)) else None)
    place = np.unravel_index(np.argmax(bad), bad.shape)
    if first.dtype.kind in "biuf":
        shared = [k for k in range(1, bad.ndim + 1) if first.shape[:k] == bad.shape[:k]]
        if shared:
            where = f"; the first where the first argument is {np.array2string(first[place[: shared[-1]]], precision=4)}"
    kind = "NaN" if np.isnan(value).any() else "infinite"
    raise Failure("error", f"{int(bad.sum())} of {bad.size} numbers that {function.name} returned are {kind}{where}")


@functools.cache
def _tolerances():
    return json.loads((HERE.parent / "references" / "tolerances.json").read_text(encoding="utf-8"))


def tolerances_id() -> str:
    """Tells one set of tolerances from another."""
    return hashlib.sha256(json.dumps(_tolerances(), sort_keys=True).encode()).hexdigest()[:12]


def tolerance(task_id, name) -> dict:
    """The record of a tolerance: its value, its metric, and the reason for both."""
    try:
        return _tolerances()[task_id][name]
    except KeyError:
        raise KeyError(f"tolerances.json has no record of {name!r} for task {task_id}") from None


def field_of(*vectors):
    """The shape of a result that has one number a point: the arguments at `vectors` are vectors, others numbers."""

    def returns(*arguments):
        shapes = [np.shape(a)[:-1] if i in vectors else np.shape(a) for i, a in enumerate(arguments)]
        return Returns((np.broadcast_shapes(*shapes),))

    return returns


def fixed(*shapes):
    """The shape of a result that depends on nothing."""
    return lambda *_: Returns(shapes, sequence=len(shapes) > 1)


def like(index, *tail):
    """The shape of a result with a row for each row of argument `index`, and `tail` behind."""
    return lambda *arguments: Returns((np.shape(arguments[index])[:-1] + tail,))
