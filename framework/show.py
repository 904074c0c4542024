"""Pictures for notebooks: images, comparisons, slices through distance fields, and what a march costs.

Each function returns a matplotlib figure that is drawn without pyplot; in a notebook it also appears at once.
matplotlib is loaded by the first picture; `comparison_images` does without it.
"""

from contextlib import contextmanager

import numpy as np

from framework import colors
from framework.arrays import as_number, as_positive
from framework.comparison import Comparison, comparison_images, contour_step, value_range

_PIXELS_AN_INCH = 72  # in notebooks, see `Picture.png`
_BAR = 0.52  # inches that a colour bar takes below its picture, see `Picture.bar_at`

__all__ = ["Comparison", "comparison", "comparison_images", "image", "march_heat_map", "plot", "sdf_slice", "strip"]


def image(image, title=None):
    """A picture of colours or of a scalar.

    Parameters
    ----------
    image : (H, W, 3) or (H, W) float or bool
                                linear RGB radiance, brought to the range of the screen; or a scalar, with a
                                colour bar. NaN is magenta, infinity grey
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    pixels = _pixels(image, "show.image: image")
    if pixels.ndim == 2:
        return _scalar(pixels, title, label="", notes=[])
    exposure = colors.exposure_for(pixels)
    notes = [] if exposure == 1 else [f"Shown at {exposure:.2g} times its brightness."]
    width, height = _panel(pixels.shape, 5.6)
    figure = _picture(width, height, title, " ".join(notes + _legend(pixels)))
    figure.image_at(0, 0, width, height, colors.from_radiance(pixels, exposure))
    return figure.present()


def comparison(yours, expected, title=None, kind=None):
    """Yours, what is expected, and the difference, side by side, with what the colours mean.

    Parameters
    ----------
    yours, expected : (H, W) or (H, W, 3), of equal shape
                                see `comparison_images`
    title : str, optional
    kind : "distance", "scalar", "color" or "mask", optional
                                by default what `expected` looks like: RGB is a color, bool a mask, numbers of
                                both signs are distances

    Returns
    -------
    matplotlib.figure.Figure
    """
    shown = comparison_images(yours, expected, kind or _kind_of(np.asarray(expected)))
    width, height = _panel(shown.yours.shape, 2.8)
    gap, above = 0.16, 0.2
    bar = 0.0 if shown.kind == "mask" else _BAR
    figure = _picture(3 * width + 2 * gap, above + height + bar, title, shown.caption)
    for column, name in enumerate(("yours", "expected", "difference")):
        figure.image_at(column * (width + gap), above, width, height, getattr(shown, name), name)
    left, top, scale = 2 * (width + gap), above + height, shown.scale
    if shown.kind == "color":
        label = "largest channel of |yours − expected|"
        figure.bar_at(left, top, width, colors.ERROR, 0, scale, label, [0, scale / 2, scale])
    elif shown.kind != "mask":
        table, label = colors.SEQUENTIAL, ""
        if shown.kind == "distance":
            table, label = colors.DISTANCE, "signed distance, scene units"
        figure.bar_at(0, top, 2 * width + gap, table, shown.low, shown.high, label)
        label = "yours − expected"
        figure.bar_at(left, top, width, colors.SIGNED_ERROR, -scale, scale, label, [-scale, 0, scale])
    return figure.present()


def sdf_slice(sdf, axis="y", height=0.0, extent=2.0, resolution=256, title=None):
    """A slice through a distance field: blue inside, orange outside, contour lines at equal steps.

    Parameters
    ----------
    sdf : callable              (N, 3) -> (N,)
    axis : "x", "y" or "z"      the slice lies across this axis, seen from its tip
    height : float              where on that axis, scene units
    extent : float              half of the slice's width and height around the origin, scene units
    resolution : int            pixels along each side
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError                  where an argument is out of range, or `sdf` returns another shape than (N,)
    """
    # What runs to the right and what runs up, each with its direction, for a viewer at the tip of the axis.
    views = {"x": ("z", -1, "y", 1), "y": ("x", 1, "z", -1), "z": ("x", 1, "y", 1)}
    if axis not in views:
        raise ValueError(f"sdf_slice: axis is {axis!r}; 'x', 'y' or 'z' is wanted")
    height, extent = as_number(height, "sdf_slice: height"), as_positive(extent, "sdf_slice: extent")
    right, right_sign, up, up_sign = views[axis]
    at = extent * ((2 * np.arange(resolution) + 1) / resolution - 1)
    points = np.empty((resolution, resolution, 3))
    points[..., "xyz".index(axis)] = height
    points[..., "xyz".index(right)] = right_sign * at
    points[..., "xyz".index(up)] = (up_sign * at[::-1])[:, None]
    distance = np.asarray(sdf(points.reshape(-1, 3)), float)
    if distance.shape != (resolution**2,):
        raise ValueError(
            f"sdf_slice: sdf returned shape {distance.shape} for {resolution**2} points; (N,) is wanted"
        )
    distance = distance.reshape(resolution, resolution)
    low, high = value_range(distance, "distance")
    step = contour_step(high)

    size, left, below = 3.7, 0.45, 0.4
    figure = _picture(left + size, size + below + _BAR, title or f"Slice at {axis} = {height:g}")
    axes = figure.axes_at(left, 0, size, size)
    sides = (-right_sign * extent, right_sign * extent, -up_sign * extent, up_sign * extent)
    axes.imshow(colors.from_distance(distance, high, step), extent=sides)
    axes.locator_params(nbins=5)
    axes.set_xlabel(f"{right} (scene units)", labelpad=2)
    axes.set_ylabel(f"{up} (scene units)", labelpad=2)
    label = f"signed distance, scene units; a line every {step:g}"
    figure.bar_at(left, size + below, size, colors.DISTANCE, low, high, label)
    return figure.present()


def march_heat_map(counts, title=None):
    """What each pixel cost.

    Parameters
    ----------
    counts : (H, W) int         evaluations of the distance field per pixel
    title : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    pixels = _pixels(counts, "march_heat_map: counts")
    if pixels.ndim != 2:
        raise ValueError(f"march_heat_map: counts has shape {pixels.shape}; (H, W) is wanted")
    finite = pixels[np.isfinite(pixels)]
    notes = [f"Mean {finite.mean():.1f} a pixel, at most {finite.max():g}."] if finite.size else []
    return _scalar(pixels, title or "Cost of the march", "evaluations of the distance field", notes)


def strip(pictures, names, title=None, caption=None):
    """Pictures in a row, each under its name, pixel by pixel as they are.

    Parameters
    ----------
    pictures : sequence of (H, W, 3)    of one size; display values: uint8, or float in [0, 1], see `fw.tone_map`
    names : sequence of str             one for each picture
    title, caption : str, optional

    Returns
    -------
    matplotlib.figure.Figure
    """
    shown = [display_pixels(picture) for picture in pictures]
    if not shown or len({pixels.shape for pixels in shown}) > 1 or len(names) != len(shown):
        raise ValueError("show.strip: pictures of one size are wanted, and a name for each")
    height, width = (n / _PIXELS_AN_INCH for n in shown[0].shape[:2])
    gap, above = 0.12, 0.2
    figure = _picture(len(shown) * (width + gap) - gap, above + height, title, caption)
    for column, (pixels, name) in enumerate(zip(shown, names, strict=True)):
        figure.image_at(column * (width + gap), above, width, height, pixels, name)
    return figure.present()


@contextmanager
def plot(x, y, title=None, caption=None, width=5.6, height=3.2):
    """Axes to draw curves on, for a `with` block at whose end they are shown.

    Parameters
    ----------
    x, y : str                  what the axes show, with the unit: "distance from the edge, scene units"
    title, caption : str, optional
    width, height : float       of the axes, inches

    Yields
    ------
    matplotlib.axes.Axes        what is drawn with a `label` gets a legend, where the block has made none
    """
    left, below = 0.55, 0.45
    figure = _picture(left + width, height + below, title, caption)
    axes = figure.axes_at(left, 0, width, height)
    axes.set(xlabel=x, ylabel=y)
    axes.grid(alpha=0.25, linewidth=0.6)
    yield axes
    if axes.get_legend_handles_labels()[1] and axes.get_legend() is None:
        axes.legend(fontsize=8, frameon=False)
    figure.present()


def display_pixels(picture):
    """A picture of display values as (H, W, 3) uint8."""
    pixels = np.asarray(picture)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.size == 0:
        raise ValueError(f"the picture has shape {pixels.shape}; (H, W, 3) is wanted")
    if pixels.dtype == np.uint8:
        return pixels
    if pixels.dtype.kind != "f" or not np.isfinite(pixels).all() or pixels.min() < 0 or pixels.max() > 1:
        raise ValueError("the picture's values are not all in [0, 1]; fw.tone_map brings radiance there")
    return np.rint(255 * pixels).astype(np.uint8)


def _scalar(pixels, title, label, notes):
    low, high = value_range(pixels, "scalar")
    width, height = _panel(pixels.shape, 5.6)
    figure = _picture(width, height + _BAR, title, " ".join(notes + _legend(pixels)))
    figure.image_at(0, 0, width, height, colors.from_table(pixels, low, high, colors.SEQUENTIAL))
    figure.bar_at(0, height, width, colors.SEQUENTIAL, low, high, label)
    return figure.present()


def _legend(pixels):
    """What the colours mean that stand for no number, where there are any."""
    cases = (np.isnan(pixels), "Magenta: not a number."), (np.isinf(pixels), "Grey: infinite.")
    return [words for where, words in cases if where.any()]


def _kind_of(expected):
    if expected.ndim == 3:
        return "color"
    if expected.dtype == bool:
        return "mask"
    finite = expected[np.isfinite(expected)]
    return "distance" if finite.size and finite.min() < 0 < finite.max() else "scalar"


def _pixels(value, name):
    pixels = np.asarray(value)
    good = pixels.ndim == 2 or (pixels.ndim == 3 and pixels.shape[2] == 3)
    if not good or pixels.size == 0 or pixels.dtype.kind not in "biuf":
        raise ValueError(
            f"{name} has shape {pixels.shape} and dtype {pixels.dtype}; "
            "real numbers of shape (H, W) or (H, W, 3) are wanted"
        )
    return pixels.astype(float)


def _panel(shape, width):
    """Inches that an image takes: `width` wide, and no higher than that, however tall it is."""
    height = width * shape[0] / shape[1]
    return (width, height) if height <= width else (max(width * width / height, 1.6), width)


def _picture(width, height, title, caption=None):
    """A sheet to draw on; the first one loads matplotlib."""
    from framework.figure import Picture

    return Picture(width, height, title, caption)
