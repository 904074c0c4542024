"""Run time against error: how long each way takes, how wrong it is, and which ones no other beats in both."""

import math
import statistics
import time
from dataclasses import dataclass
from typing import Any

REPEATS = 7
_COLORS = ("#2f6db5", "#d1622b", "#3f8f5b", "#8a4fa3", "#b8922a", "#5c6170", "#c23b5a")


@dataclass(frozen=True)
class Point:
    """One way to do the work at one setting, measured.

    Attributes
    ----------
    method, setting : str       the way, and its knob with the value
    milliseconds : float        median of `repeats` runs
    error : float               0 is exact
    """

    method: str
    setting: str
    milliseconds: float
    error: float


def measure(methods, error, repeats=REPEATS):
    """Run each way to do some work, time it, and say how wrong its result is.

    Parameters
    ----------
    methods : dict          method -> dict of setting -> function without arguments, which does the work once
    error : callable        of such a function's result, a float: 0 is exact
    repeats : int           timed runs of each; one more goes before, to warm up, and gives the error

    Returns
    -------
    list of Point           in the order given
    """
    ways = [(method, setting, run) for method, settings in methods.items() for setting, run in settings.items()]
    errors = [float(error(run())) for _, _, run in ways]
    seconds = medians([run for _, _, run in ways], repeats)
    return [
        Point(method, setting, 1e3 * s, e)
        for (method, setting, _), s, e in zip(ways, seconds, errors, strict=True)
    ]


def medians(runs, repeats=REPEATS):
    """Median seconds of each function, all in turn in each round, after one round to warm up."""
    times: list[list[float]] = [[] for _ in runs]
    for round_ in range(repeats + 1):
        for run, seconds in zip(runs, times, strict=True):
            begun = time.perf_counter()
            run()
            if round_:
                seconds.append(time.perf_counter() - begun)
    return [statistics.median(seconds) for seconds in times]


def front(points):
    """Indices of the points (seconds, error) that no other beats or equals in both: the Pareto front."""
    kept, least = set(), math.inf
    for i in sorted(range(len(points)), key=points.__getitem__):
        if points[i][1] < least:
            kept.add(i)
            least = points[i][1]
    return kept


def show(points, error, title=None):
    """The plane of run time and error, with the front of what no other way beats. Lower left is better.

    Parameters
    ----------
    points : list of Point      see `measure`; a line joins those of one method
    error : str                 what the error is, with its unit
    title : str, optional
    """
    from framework.show import plot

    drawn = [p for p in points if p.error > 0]
    exact = [f"{p.method}, {p.setting} ({p.milliseconds:.3g} ms)" for p in points if p.error == 0]
    best = front([(p.milliseconds, p.error) for p in drawn])
    caption = "Lower left is better. The broken line joins what no other way beats in both."
    caption += f" Without error, so not on this plane: {'; '.join(exact)}." if exact else ""
    with plot("run time, milliseconds (median)", error, title, caption, width=6.4, height=3.8) as axes:
        axes.set(xscale="log", yscale="log")
        axes.margins(0.14, 0.12)
        ahead = sorted((drawn[i].milliseconds, drawn[i].error) for i in best)
        axes.plot(*zip(*ahead, strict=True), color="#22252e", linestyle="--", linewidth=2.4, alpha=0.25)
        for number, method in enumerate(dict.fromkeys(p.method for p in drawn)):
            color, own = _COLORS[number % len(_COLORS)], [p for p in drawn if p.method == method]
            across, up = [p.milliseconds for p in own], [p.error for p in own]
            axes.plot(across, up, "o-", color=color, markersize=4, linewidth=1, label=method)
        _number(axes)
        _label(axes, drawn)


def _number(axes):
    """Plain numbers along both axes: powers of ten, and where they are few, twice and five times these."""
    from matplotlib.ticker import LogLocator

    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("{x:g}" if high < 1000 * low else "")
        axis.set_minor_locator(LogLocator(subs=(2, 5)))


def _label(axes, points):
    """The setting beside each point, where it hides no other's."""
    axes.figure.draw_without_rendering()  # settles the scales, which places depend on
    taken: list[Any] = []
    for p in points:
        text = axes.annotate(p.setting, (p.milliseconds, p.error), xytext=(4, 4), textcoords="offset points", fontsize=7)
        box = text.get_window_extent()
        if any(box.overlaps(other) for other in taken):
            text.remove()
        else:
            taken.append(box)
