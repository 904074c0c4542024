"""Light from far away: a latitude-longitude map of radiance."""

import warnings

import numpy as np

from framework.lookup import lookup


class Environment:
    """Radiance from every direction, as a latitude-longitude map.

    Parameters
    ----------
    pixels : (H, 2H, 3) float       linear RGB radiance, row 0 at +y; a read-only float64 copy is kept.
        Negative values are set to 0, with one warning that counts them: lossy EXR files ring below zero.
    on_bad_pixels : None or "zero"  what becomes of values that are not finite: refused, or set to 0 as well

    Raises
    ------
    ValueError : another shape, values that are no real numbers, or values that are not finite.

    Notes
    -----
    The centre of pixel (row, col) looks along theta = pi (row + 0.5) / H, phi = 2 pi (col + 0.5) / (2H),
    d = (sin(theta) sin(phi), cos(theta), -sin(theta) cos(phi)): the orientation of OpenEXR's latlong envmap.
    """

    def __init__(self, pixels, on_bad_pixels=None):
        self.pixels = _positive(_latlong(pixels, "Environment"), on_bad_pixels, "Environment")
        self.pixels.flags.writeable = False

    @classmethod
    def load(cls, path, on_bad_pixels=None):
        """The environment in an image file. A cube map that says so in its header is converted.

        Raises
        ------
        OSError, ValueError : the file cannot be read, or what it holds is no environment.
        """
        from framework.exr import read_exr

        pixels, attributes = read_exr(path)
        if pixels.ndim == 2 or pixels.shape[2] == 2:  # grey, perhaps with alpha
            pixels = np.repeat(pixels.reshape(*pixels.shape[:2], -1)[..., :1], 3, axis=2)
        pixels = pixels[..., :3]
        if attributes.get("envmap") != "cube":
            return cls(_positive(_latlong(pixels, path), on_bad_pixels, path))
        size = pixels.shape[1]
        if len(pixels) != 6 * size:
            raise ValueError(f"{path}: a cube map of shape {pixels.shape}; want six squares in a column")
        return cls.from_cube(_positive(pixels.reshape(6, size, size, 3), on_bad_pixels, path))

    @classmethod
    def from_cube(cls, faces, on_bad_pixels=None):
        """The environment on the faces (6, N, N, 3) of a cube in OpenEXR's order and orientation; 2N rows."""
        from framework.cube import cube_to_latlong

        return cls(cube_to_latlong(_positive(faces, on_bad_pixels, "Environment.from_cube")))

    def to_cube(self, size):
        """The faces (6, size, size, 3) in OpenEXR's order (+x, -x, +y, -y, +z, -z) and orientation."""
        from framework.cube import latlong_to_cube

        return latlong_to_cube(self.pixels, size)

    @property
    def height(self):
        """Rows of the map: int."""
        return len(self.pixels)

    def directions(self):
        """Unit vectors through the pixel centres, (H, 2H, 3)."""
        return pixel_directions(self.height)

    def solid_angles(self):
        """Exact solid angles of the pixels, steradians, (H, 2H); they add up to 4 pi."""
        return pixel_solid_angles(self.height)

    def radiance(self, direction):
        """Radiance from directions (..., 3) of any length, bilinear between pixel centres: (..., 3).

        Black for a direction of length 0, NaN for one that is not finite.
        """
        return lookup(self.pixels, direction)

    def resized(self, height):
        """The environment with that many rows, each pixel the mean over its solid angle: no light is lost."""
        height, rows, columns = _overlaps(self.height, height)
        # Rows first: the larger reduction of the two, and the weights of rows do not depend on the column.
        halfway = np.tensordot(rows, self.pixels, axes=(1, 0))
        return type(self)(np.einsum("cw,hwk->hck", columns, halfway, optimize=True))

    def mips(self):
        """The environment and ever smaller ones: half the rows each (rounded down), the last has one row."""
        chain = [self]
        while chain[-1].height > 1:
            chain.append(chain[-1].resized(chain[-1].height // 2))
        return chain

    def __repr__(self):
        return f"Environment({self.height} x {2 * self.height}, radiance up to {self.pixels.max():.4g})"


def pixel_directions(height):
    """Unit vectors through the pixel centres of a map of that many rows, (height, 2 height, 3)."""
    theta = np.pi * (np.arange(height) + 0.5) / height
    phi = np.pi * (np.arange(2 * height) + 0.5) / height
    directions = np.empty((height, 2 * height, 3))
    directions[..., 0] = np.sin(theta)[:, None] * np.sin(phi)
    directions[..., 1] = np.cos(theta)[:, None]
    directions[..., 2] = -np.sin(theta)[:, None] * np.cos(phi)
    return directions


def pixel_solid_angles(height):
    """Exact solid angles of the pixels of a map of that many rows, steradians, (height, 2 height)."""
    theta = np.pi * (np.arange(height) + 0.5) / height
    # cos(upper edge) - cos(lower edge) as a product: the difference would cancel at the poles.
    band = 2 * np.sin(theta) * np.sin(0.5 * np.pi / height)
    return np.repeat(band[:, None] * (np.pi / height), 2 * height, axis=1)


def _latlong(pixels, name):
    """The pixels as they are, if (H, 2H, 3); `name` opens messages."""
    pixels = np.asarray(pixels)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.shape[1] != 2 * pixels.shape[0] or not pixels.size:
        raise ValueError(f"{name}: pixels have shape {pixels.shape}; want (H, 2H, 3), twice as wide as high")
    return pixels


def _positive(pixels, on_bad_pixels, name):
    """The pixels as a new float64 array without negative values; what is not finite is refused or set to 0."""
    if on_bad_pixels not in (None, "zero"):
        raise ValueError(f"{name}: on_bad_pixels is {on_bad_pixels!r}; want None or 'zero'")
    given = np.asarray(pixels)
    if given.dtype.kind not in "fiu":
        raise ValueError(f"{name}: pixels are of type {given.dtype}; want real numbers")
    pixels = np.array(given, dtype=np.float64, order="C")
    bad = ~np.isfinite(pixels)
    if bad.any() and on_bad_pixels is None:
        first = np.argwhere(bad)[0]
        raise ValueError(
            f"{name}: {bad.sum()} of {bad.size} values are not finite, the first is {pixels[tuple(first)]} "
            f"at {first.tolist()}; want finite radiance, or on_bad_pixels='zero'"
        )
    negative = ~bad & (pixels < 0)
    changed = [
        f"{mask.sum()} {what}" for mask, what in ((negative, "negative"), (bad, "not finite")) if mask.any()
    ]
    if changed:
        lowest = f", the lowest is {pixels[negative].min():.4g}" if negative.any() else ""
        message = f"{name}: {' and '.join(changed)} of {pixels.size} values set to 0{lowest}"
        warnings.warn(message, stacklevel=3)
        pixels[negative | bad] = 0.0
    return pixels


def _overlaps(old, new):
    """Weights of rows (new, old) and columns (2 new, 2 old) in the mean over a new pixel's solid angle."""
    if int(new) != new or new < 1:
        raise ValueError(f"Environment.resized: height is {new!r}; want a whole number of at least 1")
    new = int(new)

    def overlap(new_edges, old_edges):
        first = np.maximum(new_edges[:-1, None], old_edges[:-1])
        last = np.minimum(new_edges[1:, None], old_edges[1:])
        return first, np.maximum(last, first)

    theta = np.pi * np.arange(new + 1) / new
    first, last = overlap(theta, np.pi * np.arange(old + 1) / old)
    rows = 2 * np.sin(0.5 * (first + last)) * np.sin(0.5 * (last - first))
    first, last = overlap(np.arange(2 * new + 1) / (2 * new), np.arange(2 * old + 1) / (2 * old))
    columns = last - first
    return new, rows / rows.sum(axis=1, keepdims=True), columns / columns.sum(axis=1, keepdims=True)
