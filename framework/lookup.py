"""Bilinear look-up in a latitude-longitude map."""

import sys

import numpy as np

# The compiled twin costs half a second to load: as much as half a million look-ups in NumPy.
_COMPILED_FROM = 4_096
_LOADED_FROM = 500_000


def lookup(pixels, direction):
    """Value of a latitude-longitude map in a direction, bilinear between pixel centres.

    Parameters
    ----------
    pixels : (H, 2H, 3) float       row 0 at +y, in the orientation of OpenEXR's latlong envmap, centres at
        half pixels
    direction : (..., 3) float      any length; only where it points counts

    Returns
    -------
    (..., 3) float. 0 for a direction of length 0, which looks nowhere; NaN for one that is not finite.

    Raises
    ------
    ValueError : a shape is none of these.

    Notes
    -----
    Columns wrap. The row above the first is the first row turned by half a circle; likewise at the bottom:
    so the map is continuous along every great circle, over the poles too.
    """
    pixels = np.ascontiguousarray(pixels, dtype=np.float64)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.shape[1] != 2 * pixels.shape[0] or not pixels.size:
        raise ValueError(f"lookup: pixels has shape {pixels.shape}; want (H, 2H, 3)")
    direction = np.asarray(direction, dtype=np.float64)
    if direction.shape[-1:] != (3,):
        raise ValueError(f"lookup: direction has shape {direction.shape}; want (..., 3)")
    flat = np.ascontiguousarray(direction.reshape(-1, 3))
    if len(flat) >= (_COMPILED_FROM if "numba" in sys.modules else _LOADED_FROM):
        from framework.lookup_kernel import bilinear

        return bilinear(_read_only(pixels), _read_only(flat)).reshape(direction.shape)
    return _bilinear(pixels, flat).reshape(direction.shape)


def _read_only(array):
    """The same array, in the one form that the kernel is compiled for."""
    view = array.view()
    view.flags.writeable = False
    return view


def _bilinear(pixels, direction):
    """`lookup` in NumPy: (H, 2H, 3), (N, 3) -> (N, 3). `lookup_kernel.bilinear` is the same, step by step."""
    height, width = pixels.shape[:2]
    x, y, z = direction.T
    finite = np.isfinite(x) & np.isfinite(y) & np.isfinite(z)
    if not finite.all():
        x, y, z = (np.where(finite, axis, 0.0) for axis in (x, y, z))
    # arctan2 needs no unit length, and is precise at the poles, where arccos(y) loses half of the digits.
    v = np.arctan2(np.hypot(x, z), y) * (height / np.pi) - 0.5
    u = np.arctan2(x, -z) * (height / np.pi) - 0.5
    row, column = np.floor(v).astype(np.intp), np.floor(u).astype(np.intp)
    v, u = (v - row)[:, None], (u - column)[:, None]
    texels = pixels.reshape(-1, 3)

    def along(row):
        turned = np.where((row < 0) | (row >= height), column + height, column)
        start = np.clip(row, 0, height - 1) * width
        left, right = texels[start + turned % width], texels[start + (turned + 1) % width]
        return (1 - u) * left + u * right

    value = (1 - v) * along(row) + v * along(row + 1)
    value[(x == 0) & (y == 0) & (z == 0)] = 0.0
    value[~finite] = np.nan
    return value
