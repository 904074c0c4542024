"""Two images and their difference, as pictures: what a reader looks at to see where an answer is wrong."""

from dataclasses import dataclass

import numpy as np

from framework import colors

KINDS = ("distance", "scalar", "color", "mask")

# A range of values smaller than this counts as one value: its parts would not be numbers of full precision.
_LEAST = 1e-300


@dataclass(frozen=True, eq=False)
class Comparison:
    """Three pictures and the words that belong to them.

    Attributes
    ----------
    kind : str                  "distance", "scalar", "color" or "mask"
    yours, expected : (H, W, 3) uint8
                                sRGB, in the same colours
    difference : (H, W, 3) uint8
                                sRGB, yours - expected: green where too large, purple where too small; of
                                colours the largest channel's absolute difference, white to brown; of masks
                                orange where true only in yours, blue where only in expected, else plain
    low, high : float           values at the ends of the colours of yours and expected
    scale : float               difference at the top of its colours
    caption : str               one or two plain sentences with the numbers
    """

    kind: str
    yours: np.ndarray
    expected: np.ndarray
    difference: np.ndarray
    low: float
    high: float
    scale: float
    caption: str


def comparison_images(yours, expected, kind):
    """Pictures of an image, of what it should be, and of the difference.

    Colours are chosen from `expected` alone, so that they stay while an answer improves. NaN is magenta;
    infinity, such as the distance of a ray that misses, is grey.

    Parameters
    ----------
    yours, expected : (H, W) or (H, W, 3)
                                of equal shape: bool for "mask", linear RGB for "color", signed distances in
                                scene units for "distance", else any scalar
    kind : str                  "distance", "scalar", "color" or "mask"

    Returns
    -------
    Comparison

    Raises
    ------
    ValueError                  where the shapes differ, or do not suit the kind
    """
    yours, expected = np.asarray(yours), np.asarray(expected)
    if kind not in KINDS:
        raise ValueError(f"comparison: kind is {kind!r}; one of {', '.join(KINDS)} is wanted")
    if yours.shape != expected.shape:
        raise ValueError(
            f"comparison: yours has shape {yours.shape}, expected {expected.shape}; equal ones are wanted"
        )
    wanted = 3 if kind == "color" else 2
    if yours.ndim != wanted or 0 in yours.shape or (kind == "color" and yours.shape[2] != 3):
        shape = "(H, W, 3)" if kind == "color" else "(H, W)"
        raise ValueError(
            f"comparison: an image of shape {yours.shape} was given; {shape} is wanted for {kind!r}"
        )
    if kind == "mask":
        return _masks(yours.astype(bool), expected.astype(bool))
    yours, expected = yours.astype(float), expected.astype(float)
    low, high, paint = _painter(expected, kind)
    with np.errstate(invalid="ignore", over="ignore"):
        # Both infinite alike: no difference to speak of; the picture shows background.
        error = np.where(yours == expected, 0.0, yours - expected)
    if kind == "color":
        error = np.abs(error).max(axis=-1)
    scale = _scale(error, max(abs(low), abs(high)))
    shown = np.where(np.isinf(error), np.copysign(scale, error), error)
    if kind == "color":
        difference = colors.from_table(shown, 0.0, scale, colors.ERROR)
    else:
        difference = colors.from_table(shown, -scale, scale, colors.SIGNED_ERROR)
        difference[np.isinf(expected) & (error == 0)] = colors.BACKGROUND
    caption = _caption(error, yours, expected, scale, "±" if kind != "color" else "")
    return Comparison(kind, paint(yours), paint(expected), difference, low, high, scale, caption)


def contour_step(limit):
    """Between the contour lines of a picture whose distances end at `limit`: six to fifteen lines a side."""
    return colors.round_up(limit / 15)


def value_range(values, kind):
    """`(low, high)`: the values that the ends of the colours stand for, from the finite ones."""
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    if kind == "distance":
        high = max(abs(low), abs(high))
        return (-high, high) if high > _LEAST else (-1.0, 1.0)
    if 0 < low <= high / 4:
        low = 0.0  # scales read best from zero, where that costs little contrast
    if high / 2 - low / 2 < _LEAST:
        return (0.0, high) if high > _LEAST else (low, low + 1.0 + abs(low))
    return low, high


def _painter(expected, kind):
    """The two ends of the colours, and the function that paints with them."""
    if kind == "color":
        exposure = colors.exposure_for(expected)
        return 0.0, 1.0 / exposure, lambda image: colors.from_radiance(image, exposure)
    low, high = value_range(expected, kind)
    if kind == "distance":
        return low, high, lambda image: colors.from_distance(image, high, contour_step(high))
    return low, high, lambda image: colors.from_table(image, low, high, colors.SEQUENTIAL)


def _scale(error, size):
    """A round number that all but a few differences stay below; rounding errors of float32 stay invisible."""
    finite = np.abs(error[np.isfinite(error)])
    top = float(np.percentile(finite, 99)) if finite.size else 0.0
    return colors.round_up(min(max(top, 1e-6 * size, _LEAST), 1e300))


def _caption(error, yours, expected, scale, sign):
    finite = np.abs(error[np.isfinite(error)])
    if not finite.any():
        sentence = "No difference" if finite.size else "Nothing to compare"
    else:
        sentence = (
            f"Largest difference {finite.max():.2g}, mean {finite.mean():.2g}; colours end at {sign}{scale:g}"
        )
    count = error.size
    for bad, what in (
        (np.isnan(yours), "NaN in yours (magenta)"),
        (np.isinf(yours) & np.isfinite(expected), "infinite in yours alone"),
        (np.isfinite(yours) & np.isinf(expected), "finite in yours where infinity is expected"),
    ):
        pixels = np.count_nonzero(bad.any(axis=-1) if bad.ndim == 3 else bad)
        if pixels:
            sentence += f". {pixels} of {count} pixels are {what}"
    return sentence + "."


def _masks(yours, expected):
    surplus, missing = yours & ~expected, expected & ~yours
    difference = colors.MASK[np.where(surplus, 2, np.where(missing, 3, 0))]
    more, less = np.count_nonzero(surplus), np.count_nonzero(missing)
    caption = "No difference."
    if more or less:
        caption = (
            f"{more + less} of {yours.size} pixels differ: {more} true only in yours (orange), "
            f"{less} only in expected (blue)."
        )
    pictures = colors.MASK[yours.astype(int)], colors.MASK[expected.astype(int)], difference
    return Comparison("mask", *pictures, low=0.0, high=1.0, scale=1.0, caption=caption)
