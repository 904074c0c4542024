"""The plane of cost against error, as the pages draw it: points and ticks on two logarithmic axes."""

from __future__ import annotations

from math import ceil, floor, log10

WIDTH, HEIGHT = 340, 210  # of the drawing, in the units of its SVG
LEFT, RIGHT, TOP, BOTTOM = 56, 26, 14, 44  # margins of the axes
TICKS = 5  # at most, on an axis


def plane(points, limit=None, width=WIDTH, height=HEIGHT, unit="s") -> dict:
    """Lay points out on a plane of cost (to the right) and error (up).

    Parameters
    ----------
    points : list of dict       with `cost` and `error`, both finite and at least 0; what else they hold is kept
    limit : float or None       the error that is allowed, drawn as a line
    width, height : int         of the drawing
    unit : str                  of the cost: "s" for seconds, "" for a count

    Returns
    -------
    dict        the `unit`, `points` with their `x` and `y`, `x_ticks` and `y_ticks` as (place, label), `limit` as a y or None,
                `box` as (left, top, right, bottom) of the axes, `width`, `height`
    """
    box = (LEFT, TOP, width - RIGHT, height - BOTTOM)
    across = _Axis([p["cost"] for p in points], box[0], box[2])
    up = _Axis([*(p["error"] for p in points), *([limit] if limit else [])], box[3], box[1])
    return {
        "points": [p | {"x": across.place(p["cost"]), "y": up.place(p["error"])} for p in points],
        "x_ticks": across.ticks(_seconds if unit == "s" else _counted),
        "y_ticks": up.ticks(_power),
        "limit": up.place(limit) if limit else None,
        "box": box, "width": width, "height": height, "unit": unit,
    }  # fmt: skip


class _Axis:
    """A logarithmic axis from `start` to `end`, whole decades long; what is 0 lies at its start."""

    def __init__(self, values, start, end):
        powers = [log10(value) for value in values if value > 0] or [0.0]
        self.low, self.high = floor(min(powers)), ceil(max(powers))
        if self.low == self.high:
            self.low, self.high = self.low - 1, self.high + 1
        self.start, self.end = start, end

    def place(self, value):
        share = (log10(value) - self.low) / (self.high - self.low) if value > 0 else 0.0
        return round(self.start + share * (self.end - self.start), 1)

    def ticks(self, label):
        step = ceil((self.high - self.low) / (TICKS - 1))
        return [(self.place(10.0**k), label(k)) for k in range(self.low, self.high + 1, step)]


def _seconds(power):
    unit, least = next((u, p) for u, p in (("s", 0), ("ms", -3), ("µs", -6), ("ns", -99)) if power >= p)
    return f"{10 ** (power - max(least, -9)):g} {unit}"


def _counted(power):
    return f"{10**power:,}".replace(",", "\u202f") if 0 <= power <= 5 else _power(power)


def _power(power):
    if -2 <= power <= 2:
        return f"{10.0**power:g}"
    return "10" + str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
