"""The rasteriser: which triangle each pixel sees, and what there is to know about that point.

Visibility comes first and gives one number per pixel, the triangle. Everything else follows from it by
intersecting the pixel's ray with that triangle, once and only where there is one, when it is first asked for.
"""

import os
from functools import cached_property

import numba
import numpy as np

from framework import raster_grid_kernels as grid
from framework import raster_kernels as kernels
from framework import recycle
from framework.arrays import as_positive
from framework.resolve_kernel import resolve

# GNU OpenMP, which Numba may run its threads on, reads this when the first parallel kernel starts. Where cores
# are few, threads that spin while they wait take them from those that work: 57 instead of 20 ms (measured).
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

_CHANNELS = ("depth", "barycentric", "position", "normal", "uv")
_SIDES = {None: (True, True), "back": (True, False), "front": (False, True)}
_CHUNKS = 64
_LARGEST = 8192  # pixels along a side: a quarter of the grid that keeps edge functions exact


class GBuffer:
    """What each pixel of an image sees. A channel is computed when it is first read.

    Attributes
    ----------
    triangle : (H, W) int32         row of `mesh.faces`; -1 where nothing was drawn
    mask : (H, W) bool              where something was drawn
    depth : (H, W) float64          distance along the camera's axis, scene units; inf where nothing was drawn
    barycentric : (H, W, 3) float64 weights of the face's corners, in its order, not negative, of sum 1
    position : (H, W, 3) float64    the point seen, in the world
    normal : (H, W, 3) float64      unit; interpolated where the mesh has normals, else the face's
    uv : (H, W, 2) float64          interpolated; None where the mesh has no uv

    The last four are 0 where nothing was drawn.
    """

    def __init__(self, mesh, camera, near, triangle):
        self.triangle = triangle
        self._mesh, self._camera, self._near = mesh, camera, near

    mask = cached_property(lambda self: self.triangle >= 0)
    depth = cached_property(lambda self: self._resolve(["depth"])["depth"])
    barycentric = cached_property(lambda self: self._resolve(["barycentric"])["barycentric"])
    position = cached_property(lambda self: self._resolve(["position"])["position"])
    normal = cached_property(lambda self: self._resolve(["normal"])["normal"])
    uv = cached_property(lambda self: self._resolve(["uv"])["uv"])

    def _resolve(self, names):
        """The channels named, in one pass over the image."""
        mesh, (height, width) = self._mesh, self.triangle.shape
        sizes = {"depth": (), "barycentric": (3,), "position": (3,), "normal": (3,), "uv": (2,)}
        wanted = [name for name in names if not (name == "uv" and mesh.uv is None)]
        out = {
            name: recycle.empty((height, width, *size) if name in wanted else (0, 0, *size))
            for name, size in sizes.items()
        }
        none = np.zeros((0, 3))
        none.flags.writeable = False
        resolve(
            numba.get_num_threads(),
            self.triangle,
            (mesh.faces, mesh.vertices),
            none if mesh.normals is None else mesh.normals,
            none if mesh.uv is None else mesh.uv,
            self._camera.position,
            np.linalg.inv(_pixel_matrix(self._camera, width, height)),
            self._near,
            tuple(out.values()),
        )
        return {name: out[name] if name in wanted else None for name in names}


def rasterize(mesh, camera, width, height, near=0.01, cull=None, channels=()):
    """Draw a mesh into a G-buffer.

    Parameters
    ----------
    mesh : Mesh
    camera : Camera
    width, height : int             size of the image in pixels, up to 8192
    near : float                    depth of the near plane, scene units: what is nearer is cut away
    cull : None, "back" or "front"  which side of the triangles not to draw; counter-clockwise is the front
    channels : sequence of str      channels to compute now, in one pass, rather than when they are first read

    Returns
    -------
    GBuffer

    Notes
    -----
    A pixel is covered where its centre is, with the top-left rule. Corners are rounded to 1/4096 pixel for
    that question alone; depth and the rest come from the mesh as given, by the ray through the centre.
    """
    near = as_positive(near, "rasterize: near")
    if cull not in _SIDES:
        raise ValueError(f"rasterize: cull is {cull!r}; None, 'back' or 'front' is wanted")
    unknown = [name for name in channels if name not in _CHANNELS]
    if unknown:
        raise ValueError(f"rasterize: channels holds {unknown[0]!r}; of {', '.join(_CHANNELS)} is wanted")
    if max(width, height) > _LARGEST:
        raise ValueError(f"rasterize: the image is {width} x {height}; at most {_LARGEST} a side is wanted")
    gbuffer = GBuffer(mesh, camera, near, _visibility(mesh, camera, width, height, near, *_SIDES[cull]))
    vars(gbuffer).update(gbuffer._resolve(channels) if channels else {})
    return gbuffer


def _pixel_matrix(camera, width, height):
    """Takes a point relative to the camera to (column, row, 1) times depth, pixel centres at halves."""
    x, y, _, w = camera.view_projection(width, height)[:, :3]
    return np.stack([0.5 * width * (w + x), 0.5 * height * (w - y), w])


def _visibility(mesh, camera, width, height, near, front, back):
    x, y, w = _pixel_matrix(camera, width, height)
    matrix = np.stack([(x - (width // 2 + 0.5) * w) * grid.ONE, (y - (height // 2 + 0.5) * w) * grid.ONE, w])
    view = (mesh.vertices, matrix, camera.position, near)
    xy = np.empty((len(mesh.vertices), 4), np.int32)
    grid.project(*view, xy, xy.view(np.float32))

    tiles_x, tiles_y = -(-width // kernels.TILE), -(-height // kernels.TILE)
    codes = np.empty(len(mesh.faces), np.uint32)
    counts = np.zeros((_CHUNKS, 2 * tiles_x * tiles_y), np.int64)
    kernels.classify(mesh.faces, xy, *view, width, height, front, back, codes, counts)

    # Counting sort: bin after bin, in each the chunks in order, so that faces keep theirs.
    ends = np.cumsum(counts.T.ravel()).reshape(-1, _CHUNKS)
    starts = np.append(ends[:, 0] - counts[0], ends[-1, -1])
    bins = np.empty(ends[-1, -1], np.int32)
    kernels.fill_bins(codes, tiles_x, ends.T - counts, bins)
    del codes

    triangle = np.empty((height, width), np.int32)
    order = _dealt(starts[2::2] - starts[:-2:2])
    kernels.draw_tiles(mesh.faces, xy, xy.view(np.float32), *view, bins, starts, order, triangle)
    return triangle


def _dealt(load):
    """Tiles in an order that gives each thread, which takes a run of them, as much work as the others."""
    order, threads = np.argsort(-load, kind="stable"), numba.get_num_threads()
    return np.concatenate([order[k::threads] for k in range(threads)])
