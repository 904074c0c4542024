"""Soft shadows by maps and by distance fields.

A ball, two boxes and a floor, as meshes and in closed form, below a round light. What is judged is the visible part
of the light at the points that a camera sees; the truth is 1024 rays a point, cast in closed form. All of it is NumPy
but the rasteriser, the build of the grids and their look-up.
"""

import math
from dataclasses import dataclass

import numpy as np

import framework as fw
from benchmarks.harness import Contender
from framework import mesh as shapes
from framework import sdf
from solutions.soft_shadows import area_light_shadow, soft_shadow
from solutions.truth_visibility import Solids

SOLIDS = Solids(
    spheres=(((-0.9, 0.8, 0.2), 0.6),),
    boxes=(((0.8, 0.5, -0.3), (0.35, 0.5, 0.35)), ((0.1, 1.3, 0.9), (0.6, 0.04, 0.06))),
)
LIGHT, LIGHT_RADIUS = np.array([18.0, 40.0, 12.0]), 4.0  # under about 5 degrees of half angle
CAMERA = fw.Camera((-0.6, 3.6, 5.2), (0.0, 0.5, 0.0), (0.0, 1.0, 0.0), 0.62)
TITLE = "Soft shadows: maps, and distance fields with and without their build"
ERROR, WORK = "RMS of the visibility", "not counted"
LIFT = 0.01  # points start this far above their surface


@dataclass(frozen=True)
class ShadowMap:
    """Depth of what a light sees first, as a map in perspective.

    Parameters
    ----------
    depth : (S, S) float        along the camera's axis, inf where nothing is
    camera : Camera             at the light
    """

    depth: np.ndarray
    camera: fw.Camera

    @classmethod
    def drawn(cls, mesh, camera, size):
        return cls(fw.rasterize(mesh, camera, size, size, channels=("depth",)).depth, camera)

    def project(self, p):
        """Column and row in pixels, and depth, (N,) each."""
        size = len(self.depth)
        clip = np.concatenate([p, np.ones((len(p), 1))], axis=1) @ self.camera.view_projection(size, size).T
        x, y, _, w = clip.T
        return 0.5 * size * (1 + x / w), 0.5 * size * (1 - y / w), w

    def at(self, column, row):
        """Depth at the nearest pixel; beyond the map nothing is in the way."""
        i, j = np.floor(row).astype(int), np.floor(column).astype(int)
        inside = (i >= 0) & (i < len(self.depth)) & (j >= 0) & (j < len(self.depth))
        return np.where(inside, self.depth[np.where(inside, i, 0), np.where(inside, j, 0)], np.inf)

    def pixels_at(self, length, depth):
        """How many pixels a length covers at a depth."""
        return 0.5 * len(self.depth) * length / (depth * math.tan(0.5 * self.camera.fov_y))


def pcf(shadow_map, p, radius, samples, bias):
    """Percentage closer filtering: the part of a disc of `radius` (pixels, (N,) or a number) that is farther than p.

    Reeves, Salesin and Cook, 1987. `bias` is in scene units of depth.
    """
    column, row, depth = shadow_map.project(p)
    lit = np.zeros(len(p))
    for x, y in _disc(samples):
        lit += shadow_map.at(column + radius * x, row + radius * y) > depth - bias
    return lit / samples


def pcss(shadow_map, p, light_radius, samples, bias):
    """Percentage closer soft shadows: a disc as wide as the mean blocker makes the half shade.

    Fernando, 2005: `w = light_radius (depth - blocker) / blocker` at p, blockers searched where the light shines
    through on its way to p, at the depth of the map's nearest content.
    """
    column, row, depth = shadow_map.project(p)
    nearest = shadow_map.depth.min()
    search = shadow_map.pixels_at(light_radius * (depth - nearest) / depth, nearest)
    total, count = np.zeros(len(p)), np.zeros(len(p))
    for x, y in _disc(samples):
        found = shadow_map.at(column + search * x, row + search * y)
        blocks = found < depth - bias
        total += np.where(blocks, found, 0.0)
        count += blocks
    blocker = total / np.maximum(count, 1)
    width = light_radius * (depth - blocker) / np.where(count > 0, blocker, 1.0)
    lit = pcf(shadow_map, p, np.where(count > 0, shadow_map.pixels_at(width, depth), 0.0), samples, bias)
    return np.where(count > 0, lit, 1.0)


def _disc(count):
    """Points spread evenly over the unit disc, (count, 2)."""
    i = np.arange(count)
    radius, phi = np.sqrt((i + 0.5) / count), i * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(phi), radius * np.sin(phi)], axis=1)


def ray_sampled(p, count):
    """Visible part of the light, (N,): rays from p to points spread evenly over it."""
    axis = fw.normalize(LIGHT)
    tangent, bitangent = fw.orthonormal_frame(axis)
    seen = np.zeros(len(p))
    for x, y in _disc(count):
        way = LIGHT + LIGHT_RADIUS * (x * tangent + y * bitangent) - p
        seen += ~SOLIDS.blocked(p, fw.normalize(way), np.linalg.norm(way, axis=1) - 1e-6)
    return seen / count


def objects():
    """The scene's solids as meshes, without the floor."""
    return [
        *(shapes.sphere(radius, center, 64, 128) for center, radius in SOLIDS.spheres),
        *(shapes.box(half_size, center) for center, half_size in SOLIDS.boxes),
    ]


def points(width, height):
    """Where the camera sees a surface that faces the light: (N, 3), lifted along the normal."""
    origin, direction = (a.reshape(-1, 3) for a in CAMERA.rays(width, height))
    t, scene = np.zeros(len(origin)), SOLIDS.sdf()
    for _ in range(200):
        t += scene(origin + t[:, None] * direction)
    p = origin + t[:, None] * direction
    p = p[(np.abs(p) < 4).all(axis=1)]
    normal = fw.normalize(np.stack([scene(p + s) - scene(p - s) for s in 1e-5 * np.eye(3)], axis=-1))
    up = ((LIGHT - p) * normal).sum(axis=1) > 0
    return p[up] + LIFT * normal[up]


def contenders(width=160, height=120, map_sizes=(512, 1024, 2048), resolutions=(32, 64), rays=1024):
    """Each way to shade the points; maps are drawn anew each time, grids built once unless the name says otherwise."""
    p = points(width, height)
    truth = ray_sampled(p, rays)
    meshes = objects()
    everything = _joined([*meshes, shapes.plane(9.0)])
    away = np.linalg.norm(LIGHT)
    camera = fw.Camera(LIGHT, (0.0, 0.5, 0.0), (0.0, 1.0, 0.0), 2 * math.atan(3.0 / away))
    found = []

    def add(method, setting, run):
        found.append(Contender(method, setting, run, lambda seen: float(np.sqrt(((seen - truth) ** 2).mean()))))

    def by_map(size, shade):
        return lambda: shade(ShadowMap.drawn(everything, camera, size), 0.02 + 0.5 * 6.0 / size)

    # As wide as the half shade of an occluder one unit away.
    wide = LIGHT_RADIUS / away
    for size in map_sizes:
        add("one look-up", f"{size} pixels", by_map(size, lambda m, b: pcf(m, p, 0.0, 1, b)))
        add("PCF, 64 look-ups", f"{size} pixels", by_map(size, lambda m, b: pcf(m, p, m.pixels_at(wide, away), 64, b)))
        for n in (16, 64):
            add(f"PCSS, {n} look-ups", f"{size} pixels", by_map(size, lambda m, b, n=n: pcss(m, p, LIGHT_RADIUS, n, b)))

    to_light, angle = fw.normalize(LIGHT - p), math.asin(LIGHT_RADIUS / away)
    floor = sdf.plane((0, 1, 0), 0.0)

    def signed(field):
        return area_light_shadow(field, p, to_light, angle, 0.02, 8.0, 128)

    def built(size):
        return sdf.union(floor, *(sdf.from_mesh(mesh, size) for mesh in meshes))

    exact = SOLIDS.sdf()
    add("k d / t, formula", "", lambda: soft_shadow(exact, p, to_light, 1 / math.sin(angle), 0.02, 8.0, 128))
    add("signed angle, formula", "", lambda: signed(exact))
    for size in resolutions:
        grid = built(size)
        add("signed angle, grid", f"{size} cells", lambda grid=grid: signed(grid))
        add("signed angle, grid built anew", f"{size} cells", lambda size=size: signed(built(size)))
    for samples in (16, 64):
        add("rays", f"{samples}", lambda n=samples: ray_sampled(p, n))
    return found


def _joined(meshes):
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return fw.Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + k for mesh, k in zip(meshes, first, strict=True)]),
    )
