"""Numbers to colours, without a plotting library: pictures of distances, scalars, radiance and errors.

The hues are safe for the common kinds of colour blindness: blue against orange for inside and outside, purple
against green for too small and too large. What cannot be shown has colours of its own: magenta for NaN, grey
for infinity.
"""

import numpy as np

NAN_COLOR = np.array([255, 0, 255], np.uint8)
BACKGROUND = np.array([139, 143, 153], np.uint8)


def _table(*anchors):
    """`(255, 3)` uint8, so that it has a middle: even steps between the anchors, hexadecimal sRGB."""
    rgb = np.array([list(bytes.fromhex(anchor)) for anchor in anchors], float)
    at = np.linspace(0, len(anchors) - 1, 255)
    channels = [np.interp(at, np.arange(len(anchors)), rgb[:, channel]) for channel in range(3)]
    return np.rint(np.stack(channels, axis=1)).astype(np.uint8)


# Dark to bright.
SEQUENTIAL = _table("11142e", "28397a", "1f6e96", "2c9d8c", "86c267", "f0dc4e", "fffad2")
# Inside, blue, to outside, orange: palest at the surface, where the hue changes at once.
_INSIDE = _table("0a2a5c", "2465a8", "5f9fd4", "a5cdec")
_OUTSIDE = _table("fdeacd", "f5b568", "d17a22", "7c3e08")
DISTANCE = np.concatenate([_INSIDE, _OUTSIDE])
# Too small, purple, to too large, green; white where right.
SIGNED_ERROR = _table("4a1c74", "8a5fb0", "c9b3dc", "f7f7f7", "afdcb0", "4fa363", "0e5a30")
# No error, white, to the largest, brown.
ERROR = _table("f7f7f7", "fbd08f", "e8861e", "a54a07", "4a1c00")
# Of a mask: false in both, true in both, only yours, only expected.
MASK = np.array([[34, 38, 51], [226, 229, 236], [240, 140, 30], [52, 132, 214]], np.uint8)


def from_table(values, low, high, table):
    """Colours of scalars.

    Parameters
    ----------
    values : (H, W) float       NaN and infinities allowed
    low, high : float           values at the two ends of the table; beyond them the ends are held
    table : (K, 3) uint8

    Returns
    -------
    (H, W, 3) uint8
    """
    values = np.asarray(values, float)
    finite = np.isfinite(values)
    # Halves, so that the width of any range of float64 is a float64.
    position = (np.where(finite, np.clip(values, low, high), low) / 2 - low / 2) / (high / 2 - low / 2)
    return _with_unshowable(table[np.rint((len(table) - 1) * position).astype(int)], values)


def from_distance(distance, limit, step):
    """Colours of signed distances: two hues, contour lines every `step`, the surface as a dark line.

    Parameters
    ----------
    distance : (H, W) float     scene units; NaN and infinities allowed
    limit : float               distance at both ends of the colours
    step : float                between contour lines, scene units

    Returns
    -------
    (H, W, 3) uint8
    """
    distance = np.asarray(distance, float)
    colors = from_table(distance, -limit, limit, DISTANCE).astype(float)
    # In units of the limit, where no difference of two values overflows.
    d = np.clip(np.where(np.isfinite(distance), distance, limit), -limit, limit) / limit
    step = step / limit
    slope = np.hypot(_steepest(d, 0), _steepest(d, 1))
    slope = np.where(slope > 1e-6 * step, slope, np.inf)  # no lines across plateaus

    def line(offset, half_width):
        """Coverage of a pixel by a line where `offset` is 0."""
        with np.errstate(invalid="ignore"):
            return np.clip(half_width + 0.5 - np.abs(offset) / slope, 0, 1) * np.isfinite(slope)

    contour = line(d - step * np.rint(d / step), 0.25)
    surface = line(d, 1.0)
    for coverage, ink, strength in ((contour, (40, 40, 48), 0.35), (surface, (18, 20, 28), 1.0)):
        weight = (strength * coverage)[..., None]
        colors = (1 - weight) * colors + weight * np.array(ink, float)
    return _with_unshowable(np.rint(colors).astype(np.uint8), distance)


def _steepest(d, axis):
    """Change to the next or the last pixel, the larger one: their mean would vanish on a ridge."""
    change = np.abs(np.diff(d, axis=axis))
    none = np.zeros_like(np.take(d, [0], axis=axis))
    return np.maximum(np.concatenate([change, none], axis=axis), np.concatenate([none, change], axis=axis))


def from_radiance(radiance, exposure):
    """Colours of linear RGB: scaled, clipped to [0, 1] and encoded as sRGB (IEC 61966-2-1).

    Parameters
    ----------
    radiance : (H, W, 3) float  pixels with NaN are magenta, with infinities grey
    exposure : float            factor on the radiance

    Returns
    -------
    (H, W, 3) uint8
    """
    radiance = np.asarray(radiance, float)
    with np.errstate(over="ignore"):
        linear = np.clip(np.nan_to_num(radiance, nan=0.0) * exposure, 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    worst = np.abs(radiance).max(axis=-1)  # NaN where any channel is, else infinite where any is
    return _with_unshowable(np.rint(255 * encoded).astype(np.uint8), worst)


def exposure_for(radiance):
    """A factor that brings all but the brightest percent of the values into [0, 1]; 1 where they are there.

    Parameters
    ----------
    radiance : (H, W, 3) float

    Returns
    -------
    float
    """
    finite = np.asarray(radiance, float)[np.isfinite(radiance)]
    bright = np.percentile(finite, 99) if finite.size else 1.0
    return 1.0 if 0.1 <= bright <= 1.0 or bright < 1e-30 else float(1.0 / bright)


def round_up(value):
    """The next of 1, 2, 5, 10, 20, 50, ... at or above a positive number, for scales that read well."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(digit * power for digit in (1, 2, 5, 10) if digit * power >= value * (1 - 1e-9)))


def _with_unshowable(colors, values):
    colors[np.isnan(values)] = NAN_COLOR
    colors[np.isinf(values)] = BACKGROUND
    return colors
