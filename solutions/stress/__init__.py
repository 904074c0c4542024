"""Numerical stress: every public function of the renderer, the solutions and their compiled twins, swept over inputs
that break code which is only right in the middle. Each row of a sweep holds its worst value against a bound with a reason.
"""

import importlib
from dataclasses import dataclass

import numpy as np

# `course stress NAME`: a module of that name in this package, whose `rows(share)` yields `Row`s at that share of the points.
SWEEPS = {
    "vectors": "vectors, frames, sequences, measures of error, cameras",
    "microfacets": "Fresnel, normal distributions, masking, the BRDF, the table of the split sum, its shading",
    "environments": "look-ups, cubes, samples and lights: suns in one texel, checkerboards, seams and poles",
    "filters": "filtered maps: what a constant map, a sun in one texel and a turn of the map do to them",
    "shadows": "soft shadows from distances and marches: k from 1.01 to 1000, rays that start inside and on surfaces",
    "tracing": "distance fields, tapes, marches and pictures: scales of 1e-4 to 1e5, far origins, shapes without thickness",
    "raster": "the rasteriser: slivers, coplanar faces, the near plane through a mesh, images of one pixel",
}

ROUGHNESS = np.array([0.0, 1e-4, 0.02, 0.045, *np.linspace(0.1, 1.0, 10)])
COSINES = np.array([0.0, 1e-6, 1e-3, *np.linspace(0.02, 0.98, 25), 1.0 - 1e-3, 1.0 - 1e-6, 1.0])
SCALES = 10.0 ** np.arange(-4, 6)


@dataclass(frozen=True)
class Row:
    """One claim about a function.

    Attributes
    ----------
    function, claim : str   what was called; what is measured, an error or the violation of an invariant
    points : int            inputs tried
    nonfinite : int         outputs that are NaN, or infinite where infinity says nothing
    worst : float           largest measured; NaN counts as beyond every bound
    bound : float
    reason : str            where the bound comes from
    """

    function: str
    claim: str
    points: int
    nonfinite: int
    worst: float
    bound: float
    reason: str

    @property
    def holds(self):
        return self.nonfinite == 0 and self.worst <= self.bound


def measured(function, claim, outputs, worst, bound, reason, *, points=None):
    """The row of one claim.

    Parameters
    ----------
    outputs : array, or a sequence of arrays    all that the function returned: counted, and looked through for NaN and inf
    worst : array of float                      measured values, of which the largest counts; empty is 0
    points : int, optional                      inputs tried, where that is not the number of outputs, vectors counted once
    """
    arrays = [np.asarray(a) for a in (outputs if isinstance(outputs, tuple | list) else (outputs,))]
    worst = np.asarray(worst, dtype=float)
    bad = sum(int(np.count_nonzero(~np.isfinite(a))) for a in arrays)
    return Row(
        function, claim, sum(map(_count, arrays)) if points is None else points, bad,
        float(worst.max(initial=0.0)), float(bound), reason,
    )  # fmt: skip


def _count(array):
    return array.size // (array.shape[-1] if array.ndim > 1 and array.shape[-1] in (2, 3) else 1)


def relative(found, truth, floor=0.0):
    """`|found - truth| / max(|truth|, floor)`, 0 where both are 0: float64, for truths of any precision."""
    truth = np.asarray(truth)
    away, size = np.abs(found - truth), np.maximum(np.abs(truth), floor)
    return np.asarray(np.where(away == 0, 0.0, away / np.where(size > 0, size, np.finfo(float).tiny)), dtype=float)


def sweep(name, share=1.0):
    """The rows of one sweep, as they are measured; `share` of the points, for who cannot wait."""
    yield from importlib.import_module(f"solutions.stress.{name}").rows(share)


def points(rows):
    """Inputs tried: claims about one function share them."""
    most: dict[str, int] = {}
    for row in rows:
        most[row.function] = max(most.get(row.function, 0), row.points)
    return sum(most.values())


def table(rows):
    """Rows as lines of text, a head first; what does not hold is marked."""
    cells = [("function", "claim", "points", "non-finite", "worst", "bound", "", "because")]
    cells += [
        (r.function, r.claim, f"{r.points}", f"{r.nonfinite}", f"{r.worst:.1e}", f"{r.bound:.1e}",
         "ok" if r.holds else "NO", r.reason)
        for r in rows
    ]  # fmt: skip
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    aligned = [str.ljust, str.ljust, *4 * [str.rjust], str.ljust, str.ljust]
    return ["  ".join(to(cell, w) for to, cell, w in zip(aligned, line, widths, strict=True)).rstrip() for line in cells]
