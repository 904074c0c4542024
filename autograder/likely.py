"""Which known mistake a wrong answer resembles, told by the answers to the inputs that the notebook shows.

These inputs are the same for everybody. So what each mistake answers is recorded once, by `course release`, and naming
one takes arrays alone: a student's machine does what the grader does.

Two answers are compared call by call, by how they err: `|a - b| / (|a - right| + |b - right|)` is 0 where both err in the
same way, 1 where one of them is right, about 0.7 where they err in unrelated ways. The mean of it over the calls in
which either errs is their distance.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent / "checks" / "public"
VALUES = 96  # kept of a call
# A number that is none, and an infinite one, on the scale of `_squeezed`: far from all others.
NO_NUMBER, INFINITE = 9.0, 6.0
# Named is a mistake at most NEAR away, and CLEAR times nearer than the next. Mistakes nearer than SAME to each other
# answer alike: they count as one. The same mistakes made in other right ways were at most 0.37 away, all others at
# least 0.46 or 1.7 times as far, but for neighbours that are named apart by the ratio (tests/autograder/other_ways.py).
NEAR, CLEAR, SAME = 0.4, 1.6, 0.06


@dataclass(frozen=True)
class Likely:
    """A mistake that an answer resembles.

    Attributes
    ----------
    id : str                "penumbra-not-divided"
    symptom, hint : str     what the result looks like, and where to think again
    """

    id: str
    symptom: str
    hint: str


def name(task, calls):
    """The mistake that a task's answer resembles clearly more than the right answer and than any other mistake.

    Parameters
    ----------
    task : checks.Task
    calls : list        of the public round: (function, arguments, values)

    Returns
    -------
    Likely, or None where nothing can be claimed
    """
    with np.errstate(all="ignore"):  # an answer may hold anything
        return known(task.assignment, task.id).nearest(answers(task, calls))


def answers(task, calls) -> dict[str, np.ndarray]:
    """What a task's functions answered, by call: calls that differ in nothing but seeds and callables are averaged.

    Arguments are told apart by their shapes and rounded sums: another machine may round another way.
    """
    found: dict[str, list] = {}
    digests = {f.name: f.digest for f in task.functions}
    for function, arguments, values in calls:
        key = f"{function}({', '.join(_told(a) for a in arguments)})"
        flat = np.concatenate([np.ravel(v) for v in digests[function](arguments, values)])
        if flat.size:
            # of many numbers, some that lie in no row or column
            chosen = np.sort(np.random.default_rng(flat.size).permutation(flat.size)[:VALUES])
            found.setdefault(key, []).append(flat[chosen])
    return {key: np.mean(each, axis=0) for key, each in found.items()}


def _told(value):
    if isinstance(value, (list, tuple)):
        return f"[{' '.join(map(_told, value))}]"
    if hasattr(value, "env"):
        value = value.env
    if callable(value) or isinstance(value, np.random.Generator):
        return ""
    array = np.asarray(getattr(value, "pixels", value), dtype=float)
    return f"{'x'.join(map(str, array.shape))} {np.abs(array).sum():.6g}"


@dataclass(frozen=True)
class Known:
    """What is recorded of a task: the calls of its public round, and the right answers and the mistakes to them.

    Attributes
    ----------
    keys : list of str          the calls
    sizes : (K,) int            how many values each has
    scales : (K,) float         how large the right values are
    right : (S,) float          the reference's answers, call by call, squeezed
    spread : (K,) float         how far other right answers are from them
    wrong : (M, S) float        the mistakes' answers; NaN for a call that was never made
    mistakes : list of Likely
    functions : list of str     which of the task's functions each of them answers
    """

    keys: list[str]
    sizes: np.ndarray
    scales: np.ndarray
    right: np.ndarray
    spread: np.ndarray
    wrong: np.ndarray
    mistakes: list[Likely]
    functions: list[str]

    def nearest(self, answers):
        """The mistake that these answers by call resemble clearly, or None."""
        return self.nearest_to(self.vector(answers))

    def nearest_to(self, mine):
        """The same for a vector."""
        distances = self.distances(mine)
        if not len(distances) or self._mostly_broken(mine):
            return None
        first = int(np.argmin(distances))
        others = distances[~self.alike(first)]
        clear = CLEAR * max(distances[first], SAME / 2) <= others.min(initial=1.0)
        return self.mistakes[first] if distances[first] <= NEAR and clear else None

    def alike(self, index):
        """Which mistakes answer as this one does: (M,) bool."""
        return self.distances(self.wrong[index]) <= SAME

    def vector(self, answers):
        """Answers by call in the order of `keys`, squeezed; NaN for a call that was never made."""
        parts = []
        for key, size, scale in zip(self.keys, self.sizes, self.scales, strict=True):
            values = answers.get(key, np.empty(0))
            parts.append(squeezed(values, scale) if len(values) == size else np.full(size, np.nan))
        return np.concatenate(parts)

    def distances(self, mine):
        """How far these answers are from each mistake: (M,), 1 at most."""
        return np.array([self._distance(mine, m, f) for m, f in zip(self.wrong, self.functions, strict=True)])

    def _distance(self, a, b, function):
        made = self.lengths(a * 0 + b * 0) == 0
        own = np.array([key.startswith(function + "(") for key in self.keys])
        off_a, off_b = self.lengths(a - self.right), self.lengths(b - self.right)
        count = made & own & ((off_a > self.spread) | (off_b > self.spread))
        if not count.any():
            return 1.0
        return float(np.mean(self.lengths(a - b)[count] / (off_a + off_b)[count]))

    def _mostly_broken(self, mine):
        """Whether most calls gave no number at all: that looks the same for any reason."""
        made = ~np.isnan(mine)
        return np.mean(mine[made] == NO_NUMBER) > 0.5 if made.any() else True

    def lengths(self, vector):
        """The length of each call's part of a vector: (K,)."""
        return np.sqrt(np.add.reduceat(vector**2, np.cumsum(self.sizes) - self.sizes))


def squeezed(values, scale):
    """Values on a scale that is even below `scale` and logarithmic above, with a place for what is no number."""
    sane = np.nan_to_num(values / scale, nan=0.0, posinf=0.0, neginf=0.0)
    place = np.where(np.isinf(values), np.sign(values) * INFINITE, np.arcsinh(np.clip(sane, -1e18, 1e18)))
    return np.where(np.isnan(values), NO_NUMBER, place)


@functools.cache
def known(assignment, task_id) -> Known:
    """What is recorded of a task's mistakes."""
    with np.load(FOLDER / f"{assignment}-mistakes.npz", allow_pickle=False) as file:
        part = {key.split("/")[1]: file[key] for key in file.files if key.startswith(f"{task_id}/")}
    texts = zip(part["ids"], part["symptoms"], part["hints"], strict=True)
    return Known(
        [str(key) for key in part["keys"]], part["sizes"], part["scales"], part["right"].astype(float),
        part["spread"].astype(float), part["wrong"].astype(float),
        [Likely(*map(str, text)) for text in texts], [str(f) for f in part["functions"]],
    )  # fmt: skip
