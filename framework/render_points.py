"""What each pixel sees: meshes by the rasteriser, fields by sphere tracing, the nearer of the two."""

from dataclasses import dataclass

import numpy as np

from framework import recycle
from framework.arrays import dot, normalize
from framework.mesh import Mesh
from framework.plan import CHANNELS
from framework.raster import rasterize
from framework.render_bounds import Bounds
from framework.render_cache import mesh_digest
from framework.render_functions import counted
from framework.render_kernels import camera_rays, count_points, directions, fill_points
from framework.sdf import union

_MAX_STEPS = 256
_JUST_SEEN = 1e-4  # the least cosine between a normal and the view; the kernel for meshes has the same


@dataclass(frozen=True)
class Points:
    """The points that the camera sees, object after object.

    Attributes
    ----------
    pixel : (N,) int                row by row from the top left
    position : (N, 3) float64       (0, 3) where no position is planned
    normal, view : (N, 3) float64   unit; normals are turned to the viewer
    slices : dict of int to slice   the points of each object that is seen
    """

    pixel: np.ndarray
    position: np.ndarray
    normal: np.ndarray
    view: np.ndarray
    slices: dict

    def __len__(self):
        return len(self.pixel)


def visible_points(scene, plan, functions, cache):
    """The points that the camera sees, as `plan` wants them; counts are noted there."""
    shapes = dict(enumerate(item.shape for item in scene.objects))
    meshes = {i: shapes[i] for i in plan.drawn if isinstance(shapes[i], Mesh) and len(shapes[i].faces)}
    fields = {i: shape for i, shape in shapes.items() if not isinstance(shape, Mesh)}
    rays = ray_matrix(scene.camera, plan.width, plan.height)
    mesh, gbuffer = _draw(scene, plan, meshes, cache)
    hits = _march(scene, plan, fields, rays, gbuffer, functions)
    return _gather(scene, plan, meshes, mesh, gbuffer, hits, rays)


def ray_matrix(camera, width, height):
    """Takes (column, row, 1), pixel centres at halves, to the direction of depth 1 of the ray through it: (3, 3)."""
    half_height = np.tan(camera.fov_y / 2)
    half_width = half_height * width / height
    right, up, backward = camera.basis
    x, y = 2 * half_width / width * right, -2 * half_height / height * up
    return np.ascontiguousarray(np.stack([x, y, half_height * up - half_width * right - backward], axis=1))


def _draw(scene, plan, meshes, cache):
    """All meshes as one and its G-buffer: what one mesh hides of another costs little."""
    everywhere = plan.width * plan.height
    all_faces = sum(len(item.shape.faces) for item in scene.objects if isinstance(item.shape, Mesh))
    plan.count("meshes", sum(len(mesh.faces) for mesh in meshes.values()), all_faces)
    values = sum(CHANNELS[name] for name in plan.channels)
    whole = sum(CHANNELS.values()) if all_faces else 0
    plan.count("channels", values * everywhere if meshes else 0, whole * everywhere)
    if not meshes:
        return None, None
    key = ("mesh", *map(mesh_digest, meshes.values()))
    mesh = cache.find(key) or cache.keep(key, _merged(list(meshes.values())))
    return mesh, rasterize(mesh, scene.camera, plan.width, plan.height, channels=plan.channels)


def _merged(meshes):
    """One mesh of several. Where some have normals, the others get one corner per face, to keep the faces' own."""
    if len(meshes) == 1:
        return meshes[0]
    if any(mesh.normals is not None for mesh in meshes):
        meshes = [_with_normals(mesh) for mesh in meshes]
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]),
        None if meshes[0].normals is None else np.concatenate([mesh.normals for mesh in meshes]),
    )


def _with_normals(mesh):
    if mesh.normals is not None:
        return mesh
    corners = mesh.vertices[mesh.faces]
    normals = normalize(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    faces = np.arange(corners.shape[0] * 3).reshape(-1, 3)
    return Mesh(corners.reshape(-1, 3), faces, np.repeat(normals, 3, axis=0))


def _march(scene, plan, fields, rays, gbuffer, functions):
    """Object, pixels, positions, normals and views of the points of fields that no mesh hides."""
    everywhere, camera = plan.width * plan.height, scene.camera
    if not fields:
        plan.count(
            "fields", 0, everywhere if any(not isinstance(o.shape, Mesh) for o in scene.objects) else 0
        )
        return []
    eps, far = scene.reach / 12000, 5 * scene.reach
    depth = np.zeros((0, 0)) if gbuffer is None else gbuffer.depth
    mask = np.ones((plan.height, plan.width), bool)
    if not plan.everything:
        bounds = Bounds(list(fields.values()))
        low, high = bounds.boxes([eps])
        boxes = low[:, 0].copy(), high[:, 0].copy(), bounds.planes - [0, 0, 0, -eps]
        camera_rays(*boxes, rays, camera.position, far, depth, mask)
        if not bounds.planes.size:  # nothing can be hit beyond the corner that is farthest away
            corner = np.maximum(np.abs(low - camera.position), np.abs(high - camera.position))
            far = min(far, float(np.sqrt((corner**2).sum(axis=-1)).max(initial=0.0)))
    pixel = np.flatnonzero(mask)
    plan.count("fields", len(pixel), everywhere)
    if not len(pixel):
        return []
    direction = np.empty((len(pixel), 3))
    directions(pixel, plan.width, rays, direction)
    field, origin = union(*fields.values()), np.tile(camera.position, (len(pixel), 1))
    trace = functions.get("sphere_trace", "objects given as fields")
    (t, hit), evaluations = counted(trace, field, origin, direction, far, eps, _MAX_STEPS)
    plan.count_each("fields", evaluations)
    hit = np.asarray(hit, bool).copy()
    if gbuffer is not None:
        in_front = t[hit] * (direction[hit] @ camera.axis) < depth.reshape(-1)[pixel[hit]]
        hit[hit] = in_front
    pixel, view = pixel[hit], -direction[hit]
    position = origin[hit] - np.asarray(t)[hit, None] * view
    normal = functions.get("estimate_normal", "objects given as fields")(field, position, eps)
    normal = _turned(np.asarray(normal, float), view)
    nearest = np.zeros(len(pixel), int)
    if len(fields) > 1:
        nearest = np.argmin([node(position) for node in fields.values()], axis=0)
    owned = [(i, nearest == k) for k, i in enumerate(fields)]
    return [(i, *(array[of] for array in (pixel, position, normal, view))) for i, of in owned if of.any()]


def _turned(normal, view):
    """Normals bent until the viewer just sees them."""
    missing = np.maximum(_JUST_SEEN - dot(normal, view), 0.0)
    return normalize(normal + missing[:, None] * view) if missing.any() else normal


def _gather(scene, plan, meshes, mesh, gbuffer, hits, rays):
    """The points of meshes, where no field is in front, and of fields."""
    counts = np.zeros((plan.height, len(meshes)), np.int64)
    depth = np.zeros((0, 0))
    if gbuffer is not None:
        first_face = np.cumsum([0, *(len(part.faces) for part in meshes.values())])
        for _, pixel, *_ in hits:
            gbuffer.triangle.reshape(-1)[pixel] = -1
        count_points(gbuffer.triangle, first_face, counts)
        depth = gbuffer.depth if "depth" in plan.channels else depth
    drawn = int(counts.sum())
    total = drawn + sum(len(pixel) for _, pixel, *_ in hits)
    position = recycle.empty((total if hits or depth.size else 0, 3))
    arrays = np.empty(total, np.int64), position, recycle.empty((total, 3)), recycle.empty((total, 3))
    if drawn:
        starts = np.cumsum(counts.T.ravel()).reshape(-1, plan.height).T - counts
        channels = gbuffer.triangle, depth, gbuffer.normal
        fill_points(
            *channels, (mesh.faces, mesh.vertices), first_face, rays, scene.camera.position, starts, arrays
        )
    slices, start = {}, 0
    for i, size in zip(meshes, counts.sum(axis=0).tolist(), strict=True):
        if size:
            slices[i] = slice(start, start + size)
        start += size
    for i, *found in hits:
        slices[i] = slice(start, start + len(found[0]))
        for array, part in zip(arrays, found, strict=True):
            array[slices[i]] = part
        start = slices[i].stop
    return Points(*arrays, slices)
