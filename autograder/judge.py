"""One task: its check run on public and on hidden inputs, and what the measures are worth."""

from __future__ import annotations

import hashlib
import hmac
import math
import platform
from dataclasses import dataclass, field

import numpy as np

import framework
from autograder import checks, likely
from autograder.student import Failure

PUBLIC_SHARE, WORK_SHARE = 0.3, 0.2
UNJUDGED = ("timeout", "out_of_memory", "crashed")


@dataclass
class Round:
    """One run of a check: its measures, or why it could not be judged; `weight` is its part of the points."""

    public: bool
    weight: float = 0.0
    measures: list = field(default_factory=list)
    failure: Failure | None = None
    picture: checks.Picture | None = None
    calls: list = field(default_factory=list)
    measured: list = field(default_factory=list)

    @property
    def fraction(self):
        """The part of the points that this round earns."""
        return sum(earned for _, _, earned in self.earnings)

    @property
    def earnings(self):
        """For each measure: itself, its part of this round's points, and what of it is earned.

        Properties count as far as the values are right; the work is a fixed part, which counts once the values pass.
        """
        rest = [m for m in self.measures if not m.work]
        total = sum(m.share for m in rest) or 1.0
        values = [m for m in rest if not m.property]
        right = sum(m.share * m.credit for m in values) / (sum(m.share for m in values) or 1.0)
        passed, works = all(m.credit == 1 for m in values), len(rest) < len(self.measures)
        result = []
        for m in self.measures:
            part = WORK_SHARE if m.work else m.share / total * (1 - WORK_SHARE * works)
            earned = part * m.credit * (float(passed) if m.work else right if m.property else 1.0)
            result.append((m, part, 0.0 if self.failure else earned))
        return result


@dataclass
class Judgement:
    """A task's result: the two rounds, and what was seen of the process."""

    task: checks.Task
    points: float
    rounds: list[Round]
    status: str = ""
    score: float = 0.0
    message: str = ""
    likely: likely.Likely | None = None
    printed: str = ""
    cpu_seconds: float = 0.0
    peak_memory_mb: float = 0.0

    @property
    def picture(self):
        """The check's picture, from the inputs that the notebook shows where there is one; or None."""
        return next((r.picture for r in self.rounds if r.picture is not None), None)


def run_check(task, student_calls, expected, seed, public):
    """Run a task's check once.

    Parameters
    ----------
    task : Task
    student_calls : callable    (name, arguments, returns) -> list of arrays; raises Failure
    expected : namespace        the right functions
    seed : int                  of the inputs
    public : bool

    Returns
    -------
    Round
    """
    trial = checks.Trial(task, student_calls, expected, np.random.default_rng(seed), public)
    result = Round(public, PUBLIC_SHARE if public else 1 - PUBLIC_SHARE)
    try:
        with np.errstate(all="ignore"):
            for measure in task.check(trial):
                if not math.isfinite(measure.error) and not measure.message:
                    raise Failure("error", f"{measure.name}: the error is infinite")
                result.measures.append(measure)
    except Failure as failure:
        result.failure = failure
    result.picture, result.calls, result.measured = trial.picture, trial.calls, trial.measured
    return result


def seed_of(secret, assignment, task_id, public) -> int:
    """The seed of a task's inputs: fixed for public ones, from the secret for hidden ones."""
    key = b"public" if public else b"hidden:" + secret
    digest = hmac.new(key, f"{assignment}/{task_id}".encode(), hashlib.sha256).digest()
    return int.from_bytes(digest[:8], "little")


def settle(result):
    """Status, score and message of a task from its rounds."""
    failures = [r.failure for r in result.rounds if r.failure is not None]
    fraction = sum(r.weight * r.fraction for r in result.rounds)
    result.score = rounded(result.points * fraction)
    broken = next((f for f in failures if f.status in UNJUDGED), None)
    if result.points == 0 and not result.rounds:
        result.status, result.message = "not_attempted", "it does not count in this course"
    elif broken is not None:
        result.status, result.message = broken.status, broken.message
    elif fraction >= 1 - 1e-9:
        result.status, result.message = "pass", "all measures lie within their tolerances"
    elif failures:
        result.status = "partial" if fraction > 0 else "error"
        result.message = failures[0].message
        if failures[0].status == "not_attempted":
            result.message = "it still raises NotImplementedError: take that line out"
    else:
        result.status = "partial" if fraction > 0 else "fail"
        result.message = _first_miss(result.rounds)
    if result.status in ("partial", "fail", "error"):
        # by the round whose inputs are the same for everybody
        result.likely = likely.name(result.task, result.rounds[0].calls)


def _first_miss(rounds):
    """The first measure that was missed, at its worst, in a sentence."""
    missed = [(m, r.public) for r in rounds for m in r.measures if m.credit < 1]
    if not missed:
        return ""
    name = missed[0][0].name
    worst = max((m for m, _ in missed if m.name == name), key=_over)
    if worst.work:
        return f"right, but more work than needed: {worst.message}"
    hidden = "" if missed[0][1] else " (on inputs that the notebook does not show)"
    why = f" {worst.message}:" if worst.message else ""
    return f"{name}:{why} the error is {_number(worst.error)}, allowed is {_number(worst.tolerance)}{hidden}"


def result_of(read, student, level, judgements) -> dict:
    """The result of a submission as the contract describes it, from its judged tasks."""
    peak = round(max((j.peak_memory_mb for j in judgements), default=0.0), 1)
    return {
        "schema": 1, "assignment": read.assignment, "student": student,
        **summed([check_record(j) for j in judgements]), "isolation": level, "wall_seconds": 0.0, "peak_memory_mb": peak,
        "record": {"sha256": read.sha256, "notebook_version": read.version, **versions()},
    }  # fmt: skip


def summed(records) -> dict:
    """The part of a result that follows from its tasks' entries, and they."""
    status = _status([record["status"] for record in records])
    message = next(r["message"] for r in records if r["status"] == status) if status in UNJUDGED else ""
    return {
        "status": status, "message": message, "score": rounded(sum(r["score"] for r in records)),
        "max_score": rounded(sum(r["max_score"] for r in records)), "checks": records,
    }  # fmt: skip


def versions() -> dict:
    """What a mark depends on besides the notebook and the secret."""
    return {
        "course_version": framework.__version__, "python": platform.python_version(), "numpy": np.__version__,
        "tolerances": checks.tolerances_id(),
    }  # fmt: skip


def _status(states):
    if all(state == "not_attempted" for state in states):
        return "not_attempted"
    if any(state in ("pass", "partial", "fail", "error") for state in states):
        return "graded"
    return next(state for state in UNJUDGED if state in states)


def check_record(judgement):
    """A task's entry in the result."""
    measures = [m for r in judgement.rounds for m in r.measures]
    worst = worst_of(judgement)
    work = max((m for m in measures if m.work), key=_over, default=None)
    failure = next((r.failure for r in judgement.rounds if r.failure is not None), None)
    return {
        "id": judgement.task.id, "name": judgement.task.name, "status": judgement.status,
        "score": judgement.score, "max_score": judgement.points,
        "metric": worst.metric if worst else None,
        "error": _finite(worst.error) if worst else None,
        "tolerance": _finite(worst.tolerance) if worst else None,
        "evaluations": work.evaluations if work else None,
        "evaluations_reference": work.evaluations_reference if work else None,
        "message": judgement.message, "likely_mistake": judgement.likely and judgement.likely.id,
        "symptom": judgement.likely and judgement.likely.symptom, "hint": judgement.likely and judgement.likely.hint,
        "images": {"yours": None, "reference": None, "difference": None},
        "title": judgement.task.asks, "cpu_seconds": round(judgement.cpu_seconds, 3),
        "traceback": failure.traceback if failure else "", "prints": judgement.printed,
        "measures": _merged(judgement), "inputs": _inputs_id(judgement),
    }  # fmt: skip


def worst_of(judgement, finite=False):
    """The measure, work apart, whose (finite) error is largest against its tolerance; None where there is none."""
    measures = [m for r in judgement.rounds for m in r.measures if not m.work]
    measures = [m for m in measures if not finite or math.isfinite(m.error)]
    return max(measures, key=_over, default=None)


def _inputs_id(judgement):
    """Tells the inputs of a task's rounds, to see later that a mark was made from the same ones."""
    digest = hashlib.sha256()
    for round_ in judgement.rounds:
        for name, arguments, _ in round_.calls:
            digest.update(name.encode())
            for block in _blocks(arguments):
                digest.update(block)
    return digest.hexdigest()[:16]


def _blocks(value):
    """The bytes of numbers, maps, lights and seeds, however nested; a callable has none."""
    if isinstance(value, (list, tuple)):
        for part in value:
            yield from _blocks(part)
    elif isinstance(value, np.random.Generator):
        yield str(value.bit_generator.state).encode()
    elif hasattr(value, "env"):
        yield value.env.pixels.tobytes()
    elif not callable(value):
        yield np.asarray(getattr(value, "pixels", value), dtype=float).tobytes()


def _merged(judgement):
    """The measures of both rounds by name: the worse error, and which part of the task's points they decide."""
    merged: dict[str, dict] = {}
    for round_ in judgement.rounds:
        for m, part, earned in round_.earnings:
            entry = merged.setdefault(m.name, {"measure": m, "share": 0.0, "earned": 0.0, "missed": []})
            if _over(m) > _over(entry["measure"]):
                entry["measure"] = m
            entry["share"] += round_.weight * part
            entry["earned"] += round_.weight * earned
            if m.credit < 1:
                entry["missed"].append(round_.public)
    return [
        {"name": name, "metric": e["measure"].metric, "error": _finite(e["measure"].error),
         "tolerance": _finite(e["measure"].tolerance), "credit": rounded(e["earned"] / e["share"] if e["share"] else 0.0),
         "share": rounded(e["share"]), "message": _remark(e), "work": e["measure"].work,
         "hidden_only": e["missed"] == [False]}
        for name, e in merged.items()
    ]  # fmt: skip


def _remark(entry):
    """What a measure asks for; of one that is met and yet earns less, why."""
    if entry["missed"] or entry["earned"] >= entry["share"] - 1e-9:
        return entry["measure"].message
    when = "once" if entry["measure"].work else "as far as"
    return f"within its limit; it counts {when} the values are right"


def _over(measure):
    if measure.tolerance > 0:
        return measure.error / measure.tolerance
    return math.inf if measure.error > 0 else 0.0


def _finite(value):
    return float(value) if math.isfinite(value) else None


def _number(value):
    return "infinite" if not math.isfinite(value) else f"{value:.3g}"


def rounded(value) -> float:
    """A score, to four decimals."""
    return round(float(value), 4)
