"""Measure contenders of one technique in turn, in one process; write a CSV and a plot of run time against error.

A technique is a module of this package with `TITLE`, `ERROR` and `WORK`, which name the axes, and `contenders()`, or
with `TITLE` and `series()` where growth is what is asked.
"""

import csv
import importlib
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from framework import plane

COLUMNS = ("technique", "method", "setting", "milliseconds", "error", "work", "on_front")
GROWTH_COLUMNS = ("technique", "method", "size", "milliseconds", "exponent")


@dataclass(frozen=True)
class Contender:
    """One way to do the work, at one setting.

    Attributes
    ----------
    method, setting : str       the way, one line of the plot; its knob with the value
    run : callable              does the work once, returns the result
    error : callable            of the result, a float: 0 is exact
    work : callable, optional   of the result, the exact count of evaluations or look-ups
    """

    method: str
    setting: str
    run: Callable[[], Any]
    error: Callable[[Any], float]
    work: Callable[[Any], int] = lambda result: 0


def bench(name, out):
    """Measure a technique and write `out/NAME.csv` and `out/NAME.png`; returns the lines of a summary.

    Each file is written whole or not at all: what an interrupted run has finished can be used.
    """
    technique = importlib.import_module(f"benchmarks.{name}")
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    if hasattr(technique, "series"):
        rows = measure_growth(name, technique.series())
        _write_csv(out / f"{name}.csv", GROWTH_COLUMNS, rows)
        _plot_growth(out / f"{name}.png", technique, rows)
        return [f"{row['method']}, {row['size']}: {row['milliseconds']} ms" for row in rows] + [
            f"{method}: grows with the power {found[0]['exponent']}" for method, found in _by_method(rows).items()
        ]
    rows = measure(name, technique.contenders())
    _write_csv(out / f"{name}.csv", COLUMNS, rows)
    _plot(out / f"{name}.png", technique, rows)
    return [
        f"{row['method']}, {row['setting']}: {row['milliseconds']} ms, {technique.ERROR} {row['error']}"
        for row in rows if row["on_front"]
    ]  # fmt: skip


def measure(name, contenders):
    """Rows of COLUMNS, sorted by time within a method as given."""
    results = [contender.run() for contender in contenders]
    seconds = plane.medians([contender.run for contender in contenders])
    points = [(s, c.error(r)) for s, c, r in zip(seconds, contenders, results, strict=True)]
    front = plane.front(points)
    return [
        {
            "technique": name, "method": c.method, "setting": c.setting, "milliseconds": f"{1e3 * s:.4g}",
            "error": f"{error:.4g}", "work": c.work(result), "on_front": int(i in front),
        }
        for i, (c, (s, error), result) in enumerate(zip(contenders, points, results, strict=True))
    ]  # fmt: skip


def measure_growth(name, series):
    """Rows of GROWTH_COLUMNS for a dict: method -> dict of size -> function to time; all take turns."""
    runs = [(method, size, run) for method, sizes in series.items() for size, run in sizes.items()]
    seconds = plane.medians([run for _, _, run in runs])
    taken = {(method, size): s for (method, size, _), s in zip(runs, seconds, strict=True)}
    exponents = {method: slope(list(sizes), [taken[method, n] for n in sizes]) for method, sizes in series.items()}
    return [
        {"technique": name, "method": method, "size": size, "milliseconds": f"{1e3 * s:.4g}",
         "exponent": f"{exponents[method]:.2f}"}
        for (method, size), s in taken.items()
    ]  # fmt: skip


def slope(sizes, seconds):
    """The power with which seconds grow: a straight line through their logarithms, least squares."""
    import numpy as np

    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])


def _write_csv(path, columns, rows):
    with _whole(path) as temporary, open(temporary, "w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)


class _whole:
    """A path beside the wanted one, put in its place at the end if all went well."""

    def __init__(self, path):
        self.path, self.temporary = path, path.with_name(f".{path.name}")

    def __enter__(self):
        return self.temporary

    def __exit__(self, failed, *_):
        if failed is None:
            os.replace(self.temporary, self.path)
        else:
            self.temporary.unlink(missing_ok=True)


def _figure(path):
    """A figure of one plot, written to `path` as PNG at the end."""
    import contextlib

    @contextlib.contextmanager
    def opened():
        from matplotlib.figure import Figure

        figure = Figure(figsize=(8, 5), layout="constrained")
        yield figure.subplots()
        with _whole(path) as temporary:
            figure.savefig(temporary, format="png", dpi=120)

    return opened()


def _by_method(rows):
    found: dict[str, list] = {}
    for row in rows:
        found.setdefault(row["method"], []).append(row)
    return found


def _plot(path, technique, rows):
    with _figure(path) as axes:
        for method, found in _by_method(rows).items():
            axes.plot(*_columns(found), "o-", label=method, markersize=4, linewidth=1)
        front = sorted((row for row in rows if row["on_front"]), key=lambda row: float(row["milliseconds"]))
        axes.plot(*_columns(front), "k--", label="best of all", linewidth=2, alpha=0.4)
        axes.set(title=technique.TITLE, xlabel="milliseconds, median", ylabel=technique.ERROR, xscale="log", yscale="log")
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small")


def _plot_growth(path, technique, rows):
    with _figure(path) as axes:
        for method, found in _by_method(rows).items():
            label = f"{method}: power {found[0]['exponent']}"
            axes.plot([row["size"] for row in found], [float(row["milliseconds"]) for row in found], "o-", label=label)
        axes.set(title=technique.TITLE, xlabel="size", ylabel="milliseconds, median", xscale="log", yscale="log")
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small")


def _columns(rows):
    return [float(row["milliseconds"]) for row in rows], [max(float(row["error"]), 1e-12) for row in rows]
