"""Triangle meshes: a checked container, files, and shapes made by formula.

Faces wind counter-clockwise as seen from outside. Shapes that are closed share their vertices: every edge
belongs to exactly two faces, which run along it in opposite directions.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from framework.arrays import as_positive, as_vector, normalize, orthonormal_frame

_FORMATS = (".obj", ".ply", ".stl", ".glb")


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that index a list of vertices. The arrays are read-only.

    Parameters
    ----------
    vertices : (V, 3) float             positions, scene units
    faces : (F, 3) int                  rows of `vertices`, counter-clockwise as seen from outside
    normals : (V, 3) float, optional    a normal per vertex, of any length
    uv : (V, 2) float, optional         texture coordinates per vertex

    Raises
    ------
    ValueError                          for other shapes, for numbers that are not finite, for indices that
                                        are not whole or outside [0, V)
    """

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray | None = None
    uv: np.ndarray | None = None

    def __post_init__(self):
        vertices = _floats(self.vertices, "vertices", 3)
        faces = _indices(self.faces, len(vertices))
        normals = None if self.normals is None else _floats(self.normals, "normals", 3, len(vertices))
        uv = None if self.uv is None else _floats(self.uv, "uv", 2, len(vertices))
        for name, array in (("vertices", vertices), ("faces", faces), ("normals", normals), ("uv", uv)):
            if array is not None:
                array = array.view()
                array.flags.writeable = False
            object.__setattr__(self, name, array)


def _floats(value, name, columns, rows=None):
    array = np.asarray(value)
    if array.size == 0 and array.ndim == 1:
        array = array.reshape(0, columns)
    wanted = f"({'V' if rows is None else rows}, {columns})"
    if array.ndim != 2 or array.shape[1] != columns or rows not in (None, len(array)):
        raise ValueError(f"Mesh: {name} has shape {array.shape}; {wanted} is wanted")
    if array.dtype.kind not in "biuf":
        raise ValueError(f"Mesh: {name} has dtype {array.dtype}; real numbers are wanted")
    array = np.ascontiguousarray(array, dtype=np.float64)
    # Extremes pass on NaN, and take no array of flags, which would weigh on a large mesh.
    if array.size and not (np.isfinite(array.min()) and np.isfinite(array.max())):
        bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
        raise ValueError(
            f"Mesh: {len(bad)} {name} are not finite, the first in row {bad[0]}; finite ones are wanted"
        )
    return array


def _indices(value, vertex_count):
    faces = np.asarray(value)
    if faces.size == 0 and faces.ndim in (1, 2):
        return np.zeros((0, 3), np.int32)
    if faces.ndim != 2 or faces.shape[1] != 3:
        raise ValueError(f"Mesh: faces has shape {faces.shape}; (F, 3) is wanted")
    if faces.dtype.kind not in "iu":
        raise ValueError(f"Mesh: faces has dtype {faces.dtype}; integers are wanted")
    low, high = faces.min(), faces.max()
    if low < 0 or high >= vertex_count:
        raise ValueError(
            f"Mesh: faces holds indices from {low} to {high}; "
            f"with {vertex_count} vertices, 0 to {vertex_count - 1} are wanted"
        )
    return np.ascontiguousarray(faces, dtype=np.int32)


def load_mesh(path):
    """Read a mesh, with its vertex normals and texture coordinates where the file has them.

    Parameters
    ----------
    path : str or Path          .obj, .ply, .stl or .glb; the parts of a scene come as one mesh, in place

    Returns
    -------
    Mesh

    Raises
    ------
    FileNotFoundError           where there is no such file
    ValueError                  where the file is of another format, damaged, or holds no triangle
    """
    path = Path(path)
    if path.suffix.lower() not in _FORMATS:
        raise ValueError(f"load_mesh: {path} ends in {path.suffix!r}; one of {', '.join(_FORMATS)} is wanted")
    if not path.is_file():
        raise FileNotFoundError(f"load_mesh: there is no file {path}")
    import trimesh

    try:
        scene = trimesh.load_scene(path, process=False)
        placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
        parts = [(scene.geometry[name], matrix) for matrix, name in placed]
        parts = [part for part in parts if isinstance(part[0], trimesh.Trimesh) and len(part[0].faces)]
        if path.suffix.lower() == ".stl":  # the format repeats the corners in every triangle
            parts[0][0].merge_vertices()
    except Exception as error:  # the parsers raise whatever they stumble over: KeyError, struct.error, ...
        raise ValueError(f"load_mesh: {path} cannot be read as {path.suffix[1:]}: {error}") from error
    if not parts:
        raise ValueError(f"load_mesh: {path} holds no triangles; a mesh with at least one is wanted")
    try:
        return _concatenate([_place(part, matrix) for part, matrix in parts])
    except ValueError as error:
        raise ValueError(f"load_mesh: {path}: {error}") from error


def _place(part, matrix):
    """A part of a scene as a Mesh, moved to its place."""
    linear = matrix[:3, :3]
    faces = part.faces if np.linalg.det(linear) > 0 else part.faces[:, ::-1]  # a mirror turns the winding
    normals = None
    if "vertex_normals" in part._cache:  # came with the file; trimesh would make up others when asked
        normals = normalize(part.vertex_normals @ np.linalg.inv(linear))
    uv = getattr(part.visual, "uv", None)
    return Mesh(part.vertices @ linear.T + matrix[:3, 3], faces, normals, None if uv is None else uv[:, :2])


def _concatenate(meshes):
    """One mesh of several; with normals and uv where every one has them."""
    if len(meshes) == 1:
        return meshes[0]
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    normals, uv = [mesh.normals for mesh in meshes], [mesh.uv for mesh in meshes]
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + offset for mesh, offset in zip(meshes, first, strict=True)]),
        None if any(n is None for n in normals) else np.concatenate(normals),
        None if any(t is None for t in uv) else np.concatenate(uv),
    )


def sphere(radius=1.0, center=(0.0, 0.0, 0.0), rings=32, segments=64):
    """A closed sphere of `2 (rings - 1) segments` triangles, with exact normals."""
    radius, center = as_positive(radius, "sphere: radius"), as_vector(center, "sphere: center")
    mesh = _star(lambda direction: np.ones(len(direction)), rings, segments)
    return Mesh(mesh.vertices * radius + center, mesh.faces, mesh.normals)


def bumpy_sphere(triangles, amplitude=0.05, frequency=9.0):
    """A closed sphere of radius 1 with bumps, of as many triangles as wanted, within 1 % above a thousand.

    Parameters
    ----------
    triangles : int             about how many, at least 12
    amplitude : float           largest height of a bump, scene units, below 1
    frequency : float           radians of the bumps' waves per scene unit
    """
    if triangles < 12:
        raise ValueError(f"bumpy_sphere: triangles is {triangles}; at least 12 are wanted")
    bands = round(np.sqrt(triangles / 4))
    wave = lambda d: 1.0 + amplitude * np.sin(frequency * d).prod(axis=1)  # noqa: E731
    return _star(wave, bands + 1, round(triangles / (2 * bands)))


def shading_ball(rings=192, segments=256):
    """A closed ball of radius 1 with a groove, on a foot: it shows a material on convex and concave parts.

    Its middle is the origin, its axis +y; the foot stands at y = -1.2.
    """

    def radius(direction):
        y = direction[:, 1]
        across = np.sqrt(np.maximum(1.0 - y * y, 0.0))
        groove = 0.12 * np.exp(-(((y - 0.35) / 0.09) ** 4))
        # The foot is a disc seen from the origin, its underside or its rim, whichever is nearer. The high
        # power rounds the edge between them.
        foot = np.where(y < 0, ((y / 1.2) ** 16 + (across / 0.62) ** 16) ** (-1 / 16), 0.0)
        # A rounded maximum, so that the joint is a fillet.
        gap = np.maximum(0.05 - np.abs(1.0 - foot), 0.0)
        return np.maximum(1.0, foot) + gap**2 / 0.2 - groove

    return _star(radius, rings, segments)


def torus(major_radius=1.0, minor_radius=0.4, rings=64, segments=32):
    """A closed torus about +y of `2 rings segments` triangles, with exact normals."""
    around = 2 * np.pi * np.arange(rings)[:, None] / rings
    tube = 2 * np.pi * np.arange(segments)[None, :] / segments
    normals = np.stack(
        np.broadcast_arrays(np.cos(tube) * np.sin(around), np.sin(tube), np.cos(tube) * np.cos(around)), -1
    )
    spine = np.stack(np.broadcast_arrays(np.sin(around), 0.0 * tube, np.cos(around)), -1)
    vertices = major_radius * spine + minor_radius * normals
    row, column = np.meshgrid(np.arange(rings), np.arange(segments), indexing="ij")
    faces = _quads(
        row * segments + column,
        (row + 1) % rings * segments + column,
        (row + 1) % rings * segments + (column + 1) % segments,
        row * segments + (column + 1) % segments,
    )
    return Mesh(vertices.reshape(-1, 3), faces, normals.reshape(-1, 3))


def plane(size=2.0, center=(0.0, 0.0, 0.0), segments=1):
    """A square in the plane y = const that faces +y, with `2 segments**2` triangles, normals and uv."""
    u, v = np.meshgrid(np.linspace(0, 1, segments + 1), np.linspace(0, 1, segments + 1), indexing="ij")
    uv = np.stack([u, v], -1).reshape(-1, 2)
    vertices = np.stack([(uv[:, 0] - 0.5) * size, 0 * uv[:, 0], (0.5 - uv[:, 1]) * size], -1)
    row, column = np.meshgrid(np.arange(segments), np.arange(segments), indexing="ij")
    corner = row * (segments + 1) + column
    faces = _quads(corner, corner + segments + 1, corner + segments + 2, corner + 1)
    return Mesh(
        vertices + as_vector(center, "plane: center"), faces, np.tile([0.0, 1.0, 0.0], (len(uv), 1)), uv
    )


def box(half_size=(1.0, 1.0, 1.0), center=(0.0, 0.0, 0.0)):
    """A closed box of 12 triangles and 8 shared corners. It has no normals: each face keeps its own."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    vertices = corners * as_vector(half_size, "box: half_size") + as_vector(center, "box: center")
    return Mesh(vertices, _quads(*quads.T))


def _star(radius, rings, segments):
    """The closed surface `radius(direction) * direction`: two poles, and rings of vertices between them.

    `radius` takes unit vectors (N, 3) to positive (N,). The normal of such a surface is along
    `direction - (tangential gradient of radius) / radius`.
    """
    if rings < 2 or segments < 3:
        raise ValueError(f"mesh: {rings} rings of {segments} segments; at least 2 of 3 are wanted")
    theta = np.pi * np.arange(1, rings) / rings
    phi = 2 * np.pi * np.arange(segments) / segments
    count = (rings - 1) * segments + 2
    vertices, normals = np.empty((count, 3)), np.empty((count, 3))
    # Block by block: the temporaries of millions of vertices would outweigh the mesh.
    for first in range(0, count, 65536):
        k = np.arange(first, min(first + 65536, count))
        ring, segment = np.divmod(np.clip(k - 1, 0, count - 3), segments)
        sine, cosine = np.sin(theta[ring]), np.cos(theta[ring])
        sine = np.where((k == 0) | (k == count - 1), 0.0, sine)
        cosine = np.where(k == 0, 1.0, np.where(k == count - 1, -1.0, cosine))
        direction = np.stack([sine * np.sin(phi[segment]), cosine, sine * np.cos(phi[segment])], -1)
        vertices[k] = radius(direction)[:, None] * direction
        normals[k] = _star_normals(radius, direction)
    return Mesh(vertices, _star_faces(rings, segments), normals)


def _star_normals(radius, direction, step=1e-4):
    normal = direction.copy()
    for tangent in orthonormal_frame(direction):
        slope = radius(normalize(direction + step * tangent)) - radius(normalize(direction - step * tangent))
        normal -= (slope / (2 * step) / radius(direction))[:, None] * tangent
    return normalize(normal)


def _star_faces(rings, segments):
    count = (rings - 1) * segments + 2
    column = np.arange(segments, dtype=np.int32)
    beyond = (column + 1) % segments
    faces = np.empty((2 * (rings - 1) * segments, 3), np.int32)
    for ring in range(rings - 2):
        top, bottom = 1 + ring * segments, 1 + (ring + 1) * segments
        block = faces[2 * ring * segments :][: 2 * segments]
        block[0::2] = np.stack([top + column, bottom + column, bottom + beyond], -1)
        block[1::2] = np.stack([top + column, bottom + beyond, top + beyond], -1)
    last = count - 1 - segments
    faces[-2 * segments : -segments] = np.stack([0 * column, 1 + column, 1 + beyond], -1)
    faces[-segments:] = np.stack([last + beyond, last + column, 0 * column + count - 1], -1)
    return faces


def _quads(a, b, c, d):
    """Two triangles for each four corners, which run counter-clockwise."""
    return np.stack([a, b, c, a, c, d], -1).reshape(-1, 3)
