"""Environments that are made, not photographed: any number of rows, the same everywhere, of known energy."""

import numpy as np

from framework.arrays import normalize
from framework.environment import Environment, pixel_directions, pixel_solid_angles


def constant(height, radiance=1.0):
    """The same radiance from everywhere.

    Parameters
    ----------
    height : int            rows of the map, at least 1
    radiance : float or (3,) float

    Returns
    -------
    Environment
    """
    return Environment(np.broadcast_to(np.asarray(radiance, dtype=float), (*_shape(height), 3)))


def gradient(height, zenith=(0.25, 0.45, 0.9), horizon=(0.9, 0.9, 0.85), ground=(0.25, 0.22, 0.2)):
    """A sky that changes from the horizon to the zenith, above an even ground.

    Parameters
    ----------
    height : int
    zenith, horizon, ground : (3,) float    radiance

    Returns
    -------
    Environment, continuous: the ground takes over within a tenth below the horizon
    """
    y = pixel_directions(_shape(height)[0])[..., 1:2]
    up = np.clip(y, 0, 1) ** 0.6
    sky = (1 - up) * np.asarray(horizon, float) + up * np.asarray(zenith, float)
    below = np.clip(-10 * y, 0, 1)
    return Environment((1 - below) * sky + below * np.asarray(ground, float))


def sun_and_sky(height, to_sun=(0.4, 0.6, 0.5), angular_radius=0.00465, sun_radiance=60000.0, **sky):
    """A clear sky with a sun as bright against it as outdoors.

    Parameters
    ----------
    height : int
    to_sun : (3,) float         where the sun stands, of any length
    angular_radius : float      radians; 0.00465 is the real sun's
    sun_radiance : float or (3,) float      of the disc
    sky                         see `gradient`

    Returns
    -------
    Environment; the sun's part of it has the disc's energy, sun_radiance times 2 pi (1 - cos(angular_radius)), at
    every height: pixels that the disc covers in part have their part of its radiance
    """
    if not 0 < angular_radius < np.pi:
        raise ValueError(f"sun_and_sky: angular_radius is {angular_radius!r}; want radians between 0 and pi")
    back = gradient(height, **sky)
    middle = normalize(np.asarray(to_sun, dtype=float))
    if not np.any(middle):
        raise ValueError("sun_and_sky: to_sun has no direction; want a vector that is not 0")
    covered = _coverage(
        height, lambda d: np.linalg.norm(d - middle, axis=-1) <= 2 * np.sin(angular_radius / 2)
    )
    energy = np.sum(covered * back.solid_angles())
    disc = 4 * np.pi * np.sin(angular_radius / 2) ** 2
    if energy == 0:  # smaller than the gaps between the samples: it shines in one pixel
        covered.flat[np.argmax(back.directions() @ middle)] = 1.0
        energy = np.sum(covered * back.solid_angles())
    return Environment(back.pixels + (covered * disc / energy)[..., None] * np.asarray(sun_radiance, float))


def studio(height, boxes=None, room=0.03):
    """A dark room with softboxes.

    Parameters
    ----------
    height : int
    boxes : list of (direction (3,), half width, half height, radiance (3,))    extents as tangents of half angles;
        by default a large warm box to the right, a cool one to the left, a strip above
    room : float                radiance of the walls

    Returns
    -------
    Environment
    """
    pixels = np.full((*_shape(height), 3), float(room))
    for direction, half_width, half_height, radiance in boxes or _BOXES:
        forward, right, up = _view(direction)

        def inside(d, f=forward, r=right, u=up, w=half_width, h=half_height):
            ahead = d @ f
            return (ahead > 0) & (np.abs(d @ r) < w * ahead) & (np.abs(d @ u) < h * ahead)

        pixels += _coverage(height, inside)[..., None] * np.asarray(radiance, float)
    return Environment(pixels)


def single_texel(height, row=None, column=None, radiance=60000.0):
    """Black but for one pixel: the hardest light there is.

    Parameters
    ----------
    height : int
    row, column : int       by default in the upper half, a third round
    radiance : float or (3,) float

    Returns
    -------
    Environment
    """
    height, width = _shape(height)
    row, column = height // 4 if row is None else row, width // 3 if column is None else column
    if not (0 <= row < height and 0 <= column < width):
        raise ValueError(f"single_texel: ({row}, {column}) lies outside a map of {height} x {width} pixels")
    pixels = np.zeros((height, width, 3))
    pixels[row, column] = radiance
    return Environment(pixels)


def orientation(height):
    """A map that says where it looks: the six axes and eight corners in their own colours, with labels.

    Parameters
    ----------
    height : int

    Returns
    -------
    Environment; a disc of the colour of `orientation_marks` about each of its directions, with the name in it, to be
    read from inside; corners are named by the signs of x, y and z. Elsewhere a grid of every 15 degrees.
    """
    d = pixel_directions(_shape(height)[0])
    latitude, longitude = np.arcsin(np.clip(d[..., 1], -1, 1)), np.arctan2(d[..., 0], -d[..., 2])
    step = np.pi / 12
    lines = [np.abs(angle / step - np.round(angle / step)) < 0.06 for angle in (latitude, longitude)]
    pixels = np.where((lines[0] | lines[1])[..., None], 0.12, 0.25 + 0.1 * d)
    for name, (direction, color) in orientation_marks().items():
        forward, right, up = _view(direction)
        ahead = np.maximum(d @ forward, 1e-9)
        x, y = (d @ right) / ahead, (d @ up) / ahead
        disc = (np.hypot(x, y) < 0.36) & (d @ forward > 0)
        pixels[disc] = color
        pixels[disc & _written(name, x, y)] = 0.0
    return Environment(pixels)


def orientation_marks():
    """The directions that `orientation` marks: name -> (unit direction (3,), colour (3,))."""
    marks = {}
    for axis, letter in enumerate("xyz"):
        for sign, bright in (("+", True), ("-", False)):
            direction = np.zeros(3)
            direction[axis] = 1.0 if bright else -1.0
            color = np.where(np.arange(3) == axis, 1.0, 0.15)
            marks[sign + letter] = direction, color if bright else 1.15 - color
    for corner in range(8):
        signs = np.array([1.0 if corner >> bit & 1 else -1.0 for bit in range(3)])
        name = "".join("+" if sign > 0 else "-" for sign in signs)
        marks[name] = signs / np.sqrt(3), 0.5 + 0.25 * signs
    return marks


_BOXES = (
    ((1.0, 0.6, 0.4), 0.6, 0.9, (18.0, 16.5, 14.0)),
    ((-1.0, 0.3, 0.2), 0.35, 0.8, (5.0, 6.0, 8.0)),
    ((0.0, 1.0, -0.3), 1.2, 0.15, (12.0, 12.0, 12.0)),
)
_GLYPHS = {
    "+": ("000", "010", "111", "010", "000"),
    "-": ("000", "000", "111", "000", "000"),
    "x": ("101", "101", "010", "101", "101"),
    "y": ("101", "101", "010", "010", "010"),
    "z": ("111", "001", "010", "100", "111"),
}


def _shape(height):
    if int(height) != height or height < 1:
        raise ValueError(f"skies: height is {height!r}; want a whole number of at least 1")
    return int(height), 2 * int(height)


def _view(direction):
    """Forward, right and up of somebody inside who looks along a direction; from -z the head bends to the poles."""
    forward = normalize(np.asarray(direction, dtype=float))
    up = np.array([0.0, 1.0, 0.0]) if abs(forward[1]) < 0.999 else np.array([0.0, 0.0, forward[1]])
    right = normalize(np.cross(forward, up))
    return forward, right, np.cross(right, forward)


def _written(text, x, y, size=0.055):
    """Whether points in the plane of a label lie on its letters."""
    column = np.floor(x / size + 2 * len(text) - 0.5).astype(int)
    row = np.floor(2.5 - y / size).astype(int)
    bits = np.zeros((5, 4 * len(text)), dtype=bool)
    for i, letter in enumerate(text):
        bits[:, 4 * i : 4 * i + 3] = [[bit == "1" for bit in line] for line in _GLYPHS[letter]]
    on = (row >= 0) & (row < 5) & (column >= 0) & (column < bits.shape[1])
    return on & bits[np.where(on, row, 0), np.where(on, column, 0)]


def _coverage(height, inside, parts=8):
    """The part of each pixel's solid angle in which `inside(directions)` holds, by parts x parts samples."""
    height, width = _shape(height)
    fine = np.empty((height, width))
    solid = pixel_solid_angles(height * parts)[:, :1]
    for row in range(height):  # row by row: all samples at once would fill the memory
        rows = slice(row * parts, (row + 1) * parts)
        weight = solid[rows] / solid[rows].sum()
        hit = inside(_rows(height * parts, rows)).reshape(parts, width, parts)
        fine[row] = np.einsum("r,rcp->c", weight[:, 0], hit) / parts
    return fine


def _rows(height, rows):
    theta = np.pi * (np.arange(height)[rows] + 0.5) / height
    phi = np.pi * (np.arange(2 * height) + 0.5) / height
    sine = np.sin(theta)[:, None]
    return np.stack(
        np.broadcast_arrays(sine * np.sin(phi), np.cos(theta)[:, None], -sine * np.cos(phi)), axis=-1
    )
