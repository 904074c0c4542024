"""The rasteriser: slivers and degenerate triangles, coplanar faces, the near plane through a mesh, images of one pixel.

Truth is the plane of the triangle that a pixel names, met by the pixel's ray in float64.
"""

import numpy as np

import framework as fw
from solutions.stress import SCALES, measured

_SIZES = ((1, 1), (2, 1), (7, 5), (33, 17), (97, 64))
_NEAR = 0.01


def rows(share):
    rng = np.random.default_rng(36)
    scales = SCALES[:: 2 if share >= 0.5 else 6]
    pixels = 0
    outputs, sums, depths, nears, moved, sides = [], [], [], [], [], []
    for mesh, around in _meshes(rng, max(20, int(200 * share))):
        for width, height in _SIZES:
            for scale in scales:
                camera = _camera(scale, around)
                large = fw.Mesh(scale * mesh.vertices, mesh.faces)
                g = fw.rasterize(large, camera, width, height, near=_NEAR * scale)
                seen, pixels = g.mask, pixels + width * height
                outputs += [g.depth[seen] / scale, g.position.ravel() / scale, g.normal.ravel(), g.barycentric.ravel()]
                sums.append(np.maximum(np.abs(g.barycentric[seen].sum(-1) - 1), -g.barycentric[seen].min(-1, initial=0)))
                nears.append(_NEAR - g.depth[seen] / scale)
                depths.append(_off_the_plane(large, camera, g, width, height) / scale)
                if scale == scales[0]:
                    first = g.triangle
                # Scales that are no powers of two round corners anew: coplanar faces may change places, edges a pixel.
                moved.append(np.count_nonzero((first >= 0) != seen) / max(4 * (width + height), 1))
                if scale != scales[0]:
                    continue
                both = [fw.rasterize(large, camera, width, height, near=_NEAR * scale, cull=c).mask for c in ("back", "front")]
                sides.append(np.count_nonzero(seen & ~(both[0] | both[1])) + np.count_nonzero(~seen & (both[0] | both[1])))
    flat = np.concatenate(outputs)
    yield measured("rasterize", "barycentric below 0, or sum off 1", flat, np.concatenate(sums), 1e-12,
                   "clamped and normalised", points=pixels)  # fmt: skip
    yield measured("rasterize", "off its triangle's plane, over the scene", flat, np.concatenate(depths), 1e-9,
                   "float64 rays; slivers aside",  # fmt: skip
                   points=pixels)  # fmt: skip
    yield measured("rasterize", "nearer than the near plane", flat, np.concatenate(nears), 1e-9, "cut away", points=pixels)
    yield measured("rasterize", "pixels changed by scale, over the outline", flat, np.array(moved), 0.1,
                   "corners round to 1/4096 pixel",  # fmt: skip
                   points=pixels)  # fmt: skip
    yield measured("rasterize", "pixels that neither side alone draws", flat, np.array(sides), 0,
                   "a face has two sides", points=pixels)  # fmt: skip
    yield from _nothing()


def _camera(scale, place):
    return fw.Camera(scale * np.asarray(place), scale * np.array([0.1, 0.2, 0.05]), (0, 1, 0), 0.9)


def _meshes(rng, count):
    """Meshes, and where the camera stands."""
    outside, within, on = (2.5, 1.5, 3.0), (0.3, 0.1, 0.2), (1.0, 0.0, 0.0)
    ball, box = fw.mesh.sphere(1.0, rings=12, segments=24), fw.mesh.box()
    corners = rng.uniform(-1, 1, (count, 3, 3))
    slivers = corners.copy()
    slivers[:, 2] = slivers[:, 0] + 0.5 * (slivers[:, 1] - slivers[:, 0]) + 10.0 ** rng.uniform(-12, -3, (count, 1))
    degenerate = corners.copy()
    degenerate[::2, 2] = degenerate[::2, 1]
    degenerate[1::2] = degenerate[1::2, :1]
    coplanar = corners * [1, 0, 1]
    yield from ((fw.Mesh(m.vertices, m.faces), place) for m in (ball, box) for place in (outside, within, on))
    for triangles in (corners, slivers, degenerate, coplanar, 1e4 * corners, 1e-6 * corners):
        yield fw.Mesh(triangles.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)), outside


def _off_the_plane(mesh, camera, g, width, height):
    """How far each pixel's position is from its triangle's plane and from its ray, as far as the triangle has a plane."""
    origin, direction = camera.rays(width, height)
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces[g.triangle[g.mask]]], 1, 0)
    across = np.cross(b - a, c - a)
    size = np.maximum(np.linalg.norm(b - a, axis=1), np.linalg.norm(c - a, axis=1))
    fat = np.linalg.norm(across, axis=1) > 1e-3 * size**2
    p, origin, direction = g.position[g.mask], origin[g.mask], direction[g.mask]
    off_ray = np.linalg.norm(np.cross(p - origin, direction), axis=1)
    plane = np.abs(np.einsum("ni,ni->n", fw.normalize(across), p - a))
    return np.where(fat, np.maximum(plane, off_ray), 0.0)


def _nothing():
    """No triangles, and all of them behind the camera."""
    camera, values = _camera(1.0, (2.5, 1.5, 3.0)), []
    behind = fw.Mesh([[9.0, 5, 12], [10, 5, 12], [9, 6, 12]], [[0, 1, 2]])
    for mesh in (fw.Mesh(np.empty((0, 3)), np.empty((0, 3), int)), behind):
        for size in _SIZES:
            g = fw.rasterize(mesh, camera, *size)
            values.append(np.concatenate([g.mask.ravel(), np.isfinite(g.depth).ravel(), g.position.ravel(), g.normal.ravel()]))
    flat = np.concatenate(values)
    yield measured("rasterize", "drawn where nothing is", flat, flat, 0, "no triangles, or all of them behind")
