"""Cube maps in OpenEXR's order and orientation, to and from latitude-longitude maps."""

import numpy as np

from framework.lookup import lookup

# A face has columns (a, left to right) and rows (b, downwards), from -1 to 1. Per face: the world vectors
# of a, of b and of its middle. From OpenEXR's ImfEnvmap.cpp, CubeMap::direction and CubeMap::pixelPosition.
_FRAMES = np.array(
    [
        [[0, 0, 1], [0, -1, 0], [1, 0, 0]],
        [[0, 0, -1], [0, -1, 0], [-1, 0, 0]],
        [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
        [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
        [[-1, 0, 0], [0, -1, 0], [0, 0, 1]],
        [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
    ],
    dtype=np.float64,
)


def face_directions(size):
    """Directions, not unit, through the pixel centres of all faces: (6, size, size, 3)."""
    return _grid(np.arange(size), size)


def latlong_to_cube(pixels, size):
    """The faces (6, size, size, 3) of a map (H, 2H, 3), each pixel the mean over its solid angle.

    Raises
    ------
    ValueError : size is no whole number of at least 1.
    """
    if int(size) != size or size < 1:
        raise ValueError(f"to_cube: size is {size!r}; want a whole number of at least 1")
    size = int(size)
    # Samples a third of a pixel of the map apart: a sun of a few pixels keeps its energy within 1e-3.
    parts = 3 * int(np.ceil(2 * len(pixels) / (np.pi * size)))
    offset = ((2 * np.arange(size * parts) + 1) / (size * parts) - 1).reshape(size, parts)
    rows = max(1, 200_000 // (size * parts * parts))  # at a time, for the sake of memory
    faces = np.empty((6, size, size, 3))
    for start in range(0, size, rows):
        a, b = np.broadcast_arrays(offset, offset[start : start + rows, :, None, None])
        weight = (1 + a * a + b * b) ** -1.5  # solid angle of a piece of the face
        weight /= weight.sum(axis=(1, 3), keepdims=True)
        values = lookup(pixels, _on_faces(a, b))
        faces[:, start : start + rows] = np.einsum("frpcqk,rpcq->frck", values, weight)
    return faces


def cube_to_latlong(faces):
    """The map (2N, 4N, 3) of the faces (6, N, N, 3), each pixel the mean over its solid angle.

    Raises
    ------
    ValueError : another shape.
    """
    faces = np.asarray(faces, dtype=np.float64)
    if faces.ndim != 4 or faces.shape[0] != 6 or faces.shape[1] != faces.shape[2] or faces.shape[3] != 3:
        raise ValueError(f"from_cube: faces have shape {faces.shape}; want (6, N, N, 3)")
    if not faces.size:
        raise ValueError("from_cube: the faces are empty; want (6, N, N, 3) with N of at least 1")
    height, parts = 2 * faces.shape[1], 4
    padded = _padded(faces)
    fine = height * parts
    theta = np.pi * (np.arange(fine) + 0.5) / fine
    phi = np.pi * (np.arange(2 * fine) + 0.5) / fine
    pixels = np.empty((height, 2 * height, 3))
    for row in range(height):  # row by row: the samples of the whole map would fill the memory
        t = theta[row * parts : (row + 1) * parts, None]
        direction = np.stack(
            np.broadcast_arrays(np.sin(t) * np.sin(phi), np.cos(t), -np.sin(t) * np.cos(phi)), axis=-1
        )
        weight = np.sin(t[:, 0]) / np.sin(t).sum()
        values = np.einsum("r,rck->ck", weight, _bilinear(padded, direction))
        pixels[row] = values.reshape(2 * height, parts, 3).mean(axis=1)
    return pixels


def _grid(index, size):
    """Directions (6, n, n, 3) through the pixels whose rows and columns are those n indices."""
    offset = (2 * index + 1) / size - 1
    return _on_faces(offset, offset[:, None])


def _on_faces(a, b):
    """Directions (6, ..., 3) of the points with columns a and rows b of every face."""
    a, b = np.broadcast_arrays(a, b)
    return np.einsum("i...,fik->f...k", np.stack([a, b, np.ones_like(a)]), _FRAMES, optimize=True)


def _locate(direction):
    """The face that a direction (..., 3) hits, and where: index, a and b in [-1, 1]."""
    axis = np.argmax(np.abs(direction), axis=-1)
    middle = np.take_along_axis(direction, axis[..., None], axis=-1)[..., 0]
    face = 2 * axis + (middle < 0)
    a, b = (np.einsum("...k,...k->...", _FRAMES[face, i], direction) / np.abs(middle) for i in (0, 1))
    return face, a, b


def _padded(faces):
    """The faces with a frame of one more pixel, (6, N + 2, N + 2, 3), read from the neighbours."""
    size = faces.shape[1]
    direction = _grid(np.arange(-1, size + 1), size)
    frame = np.ones((size + 2, size + 2), dtype=bool)
    frame[1:-1, 1:-1] = False
    padded = np.empty((6, size + 2, size + 2, 3))
    padded[:, 1:-1, 1:-1] = faces
    # Without frames of their own the neighbours are read as far as their outermost centres.
    padded[:, frame] = _bilinear(
        np.pad(faces, ((0, 0), (1, 1), (1, 1), (0, 0)), mode="edge"), direction[:, frame]
    )
    return padded


def _bilinear(padded, direction):
    """Look-up in padded faces: (6, N + 2, N + 2, 3), (..., 3) -> (..., 3)."""
    size = padded.shape[1] - 2
    face, a, b = _locate(direction)
    u, v = (np.clip((c + 1) * (size / 2) + 0.5, 0, size + 1) for c in (a, b))
    column, row = (np.minimum(c.astype(np.intp), size) for c in (u, v))
    u, v = (u - column)[..., None], (v - row)[..., None]
    above = (1 - u) * padded[face, row, column] + u * padded[face, row, column + 1]
    below = (1 - u) * padded[face, row + 1, column] + u * padded[face, row + 1, column + 1]
    return (1 - v) * above + v * below
