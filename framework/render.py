"""From a scene to a picture, with functions that are handed in: a student's, the reference's or compiled ones.

`framework.plan` says what is wanted, and is told what was done. Shadows, environment and shading run on lists of the
points that the camera sees, each on those points alone whose pixels it can change.
"""

from functools import partial

import numpy as np

from framework import recycle
from framework.arrays import dot
from framework.environment_light import EnvironmentLight
from framework.lookup import lookup
from framework.mesh import Mesh
from framework.plan import plan_scene
from framework.render_bounds import Bounds
from framework.render_cache import Cache, mesh_digest
from framework.render_functions import Functions, counted
from framework.render_light import environment_light

GRID_RESOLUTION = 64

_CACHE = Cache()
_SHADOW_STEPS = 128
_SEGMENTS = 8
_BATCH = 8192  # points shaded with environment shadows at once: their arrays stay in the cache, half the time of all at once


def render_scene(scene, width, height, functions, everything=False, samples=256):
    """Render a scene.

    Parameters
    ----------
    scene : Scene
    width, height : int     size of the image in pixels
    functions : mapping, module or object, or a sequence of them
        where the contract's functions are found by name, the first that has one wins: `globals()` of a notebook,
        `solutions.split_sum`. Only those that the scene needs are asked for.
    everything : bool       leave nothing out and reuse nothing, for comparison
    samples : int           budget of `prefilter_chain` and `brdf_lut`, where they take one

    Returns
    -------
    image : (height, width, 3) float64      linear radiance
    plan : Plan                             what was done and what was left out, with counts

    Raises
    ------
    ValueError              the functions lack one that the scene needs
    """
    from framework.render_points import visible_points

    plan, functions = plan_scene(scene, width, height, everything), Functions(functions)
    cache = Cache() if everything else _CACHE
    points = visible_points(scene, plan, functions, cache)
    plan.narrow(points.slices)
    light = environment_light(scene.environment, plan, functions, cache, samples)
    shading = _Shading(scene, plan, functions, cache, points)
    color = shading.environment(light)
    for number in range(len(scene.lights)):
        shading.add_light(number, color)
    return _image(scene, plan, points, color), plan


def _image(scene, plan, points, color):
    """The image (H, W, 3): the colours of the points, and the environment where there are none."""
    from framework.render_kernels import background, place
    from framework.render_points import ray_matrix

    everywhere = plan.width * plan.height
    image = recycle.empty((everywhere, 3))
    if scene.environment is None:
        plan.count("background", 0, 0)
        image[:] = 0.0
    else:
        empty = np.ones(everywhere, bool)
        if not plan.everything:
            empty[points.pixel] = False
        plan.count("background", np.count_nonzero(empty), everywhere)
        pixels, rays = _map(scene), ray_matrix(scene.camera, plan.width, plan.height)
        background(empty, plan.width, rays, pixels.reshape(-1, 3), len(pixels), image)
    place(points.pixel, color, image)
    return image.reshape(plan.height, plan.width, 3)


def _map(scene):
    given = scene.environment
    return (given.env if isinstance(given, EnvironmentLight) else given).pixels


class _Shading:
    """What the points of one picture reflect. A material without r0 or albedo reflects nothing by that part."""

    def __init__(self, scene, plan, functions, cache, points):
        self._scene, self._plan, self._functions, self._cache = scene, plan, functions, cache
        self._points = points
        self._casting = [item.occluder for item in scene.objects if item.occluder is not None]
        self._casting = [shape for shape in self._casting if not isinstance(shape, Mesh) or len(shape.faces)]
        self._bounds = Bounds(self._casting)
        self._field = None
        plan.count("grids", 0, sum(isinstance(shape, Mesh) for shape in self._casting))
        if plan.everything and self._casting:
            self._occluder()

    def _occluder(self):
        """The distance to all that casts shadows. Meshes become grids here, when the first ray asks."""
        if self._field is None:
            from framework import sdf

            meshes = [shape for shape in self._casting if isinstance(shape, Mesh)]
            nodes = [shape for shape in self._casting if not isinstance(shape, Mesh)]
            made = 0
            for mesh in meshes:
                key = ("grid", mesh_digest(mesh), GRID_RESOLUTION)
                grid = self._cache.find(key)
                if grid is None:
                    made += 1
                    grid = self._cache.keep(key, sdf.from_mesh(mesh, GRID_RESOLUTION))
                nodes.append(grid)
            kept = "kept from an earlier frame" if meshes and not made else None
            self._plan.count("grids", made, len(meshes), kept)
            self._field = sdf.union(*nodes)
        return self._field

    def environment(self, light):
        """Radiance (N, 3) that reaches the camera from the environment."""
        from framework.render_kernels import around

        scene, plan, points = self._scene, self._plan, self._points
        color = recycle.empty((len(points), 3))
        color[:] = 0.0
        if scene.environment is None:
            for name in ("environment shadows", "matt under the sky", "mirror of the sky"):
                plan.count(name, 0, 0)
            return color
        near, matt, mirror = self._near_occluders(), 0, 0
        free = self._free_share(near) if scene.environment_shadows == "ambient" else None
        if scene.environment_shadows == "full":
            self._shade_with_shadows(light, near, color)
        for i, part in points.slices.items():
            material, of = scene.objects[i].material, part
            if scene.environment_shadows == "full":  # the rest
                of = np.arange(part.start, part.stop)[~near[part]]
            if material.scatters or plan.everything:
                matt += part.stop - part.start
                normal = points.normal[of]
                term = recycle.empty(normal.shape)
                around(normal, light.irradiance_map.reshape(-1, 3), len(light.irradiance_map), term)
                term *= material.albedo
                color[of] += term if free is None else term * free[of, None]
            if material.reflects or plan.everything:
                mirror += part.stop - part.start
                mirrored = self._mirror(material, light, of)
                if material.reflects:
                    color[of] += mirrored
        plan.count("matt under the sky", matt, len(points))
        plan.count("mirror of the sky", mirror, len(points))
        return color

    def _mirror(self, material, light, of):
        """The mirror part (M, 3) under the environment, without shadows."""
        normal, view, r0 = self._points.normal[of], self._points.view[of], np.array(material.r0)
        if material.roughness == 0 and self._scene.environment_shadows != "full":
            fresnel = self._functions.get("fresnel_schlick", "a perfect mirror")
            cosine = dot(normal, view)[:, None]
            return lookup(_map(self._scene), 2 * cosine * normal - view) * fresnel(r0, np.clip(cosine, 0, 1))
        split_sum = self._functions.get("shade_split_sum", "rough mirrors under the environment")
        return np.asarray(split_sum(normal, view, r0, material.roughness, light.prefiltered, light.lut))

    def _near_occluders(self):
        """Where shadows may change what is seen of the environment: bool (N,)."""
        scene, points, kind = self._scene, self._points, self._scene.environment_shadows
        near = np.zeros(len(points), bool)
        if kind == "none" or not self._casting:
            self._plan.count("environment shadows", 0, 0)
            return near
        for i, part in points.slices.items():
            material = scene.objects[i].material
            near[part] = material.scatters or (kind == "full" and material.reflects)
        # Beyond twice the reach all points of a cone are farther from everything than they are from its tip.
        near &= self._bounds.near(points.position, 2 * scene.reach)
        near |= self._plan.everything
        self._plan.count("environment shadows", near.sum(), len(points))
        return near

    def _free_share(self, near):
        """The share of the sky that points see, as matt surfaces weight it: (N,)."""
        points, free, chosen = self._points, np.ones(len(self._points)), np.flatnonzero(near)
        if len(chosen):
            visibility = self._functions.get("ambient_visibility", "environment shadows")
            surface = points.position[chosen], points.normal[chosen]
            free[chosen], evaluations = counted(visibility, self._occluder(), *surface, self._scene.reach)
            self._plan.count_each("environment shadows", evaluations)
        return free

    def _shade_with_shadows(self, light, near, color):
        """Put what the points near occluders reflect of the environment, shadowed, into `color`."""
        points, total = self._points, 0
        # Without a table nothing is left of the mirror part.
        maps = light.env, light.irradiance_map, light.chain, light.roughness_levels
        matt = EnvironmentLight(*maps, 0 * light.lut)
        for i, part in points.slices.items():
            of, m = np.arange(part.start, part.stop)[near[part]], self._scene.objects[i].material
            if not len(of):
                continue
            shade = self._functions.get("shade_with_shadows", "environment shadows")
            shade = partial(shade, light if m.reflects else matt)
            look = np.array(m.r0), m.roughness, np.array(m.albedo), self._scene.reach
            for some in np.array_split(of, -(-len(of) // _BATCH)):
                surface = points.position[some], points.normal[some], points.view[some]
                color[some], evaluations = counted(shade, self._occluder(), *surface, *look)
                total += evaluations
        self._plan.count_each("environment shadows", total)

    def add_light(self, number, color):
        """Add what the points reflect of a light to `color`."""
        plan, points, light = self._plan, self._points, self._scene.lights[number]
        if not plan[f"light {number}"].done or not len(points):
            plan.count(f"light {number}", 0, len(points))
            plan.count(f"shadow {number}", 0, len(points) if self._casting else 0)
            return
        from framework.render_kernels import add_light

        cosine, visible = self._visibility(number, light)
        strength, lit = visible * cosine, 0
        for i, part in points.slices.items():
            material = self._scene.objects[i].material
            # Picking the lit points costs as much as it saves where they are the most: there all are taken.
            some = np.flatnonzero(strength[part]) + part.start
            few = not plan.everything and 2 * len(some) < part.stop - part.start
            of: slice | np.ndarray = some if few else part
            glint = np.empty((0, 3))
            if material.reflects or plan.everything:
                brdf = self._functions.get("microfacet_brdf", f"the mirror parts under light {number}")
                # A lobe narrower than the light shows the light's disc: the GGX lobe of that width stands in for it.
                alpha = max(material.roughness**2, 0.5 / light.k, 1e-4)
                glint = brdf(
                    points.normal[of], points.view[of], light.direction, np.array(material.r0), alpha
                )
                glint = np.asarray(glint, float) if material.reflects else np.empty((0, 3))
            lit += len(strength[of])
            reflected = color[of]
            matt = np.array(material.albedo) / np.pi
            add_light(reflected, strength[of], matt, light.irradiance, np.ascontiguousarray(glint))
            if few:
                color[of] = reflected
        plan.count(f"light {number}", lit, len(points))

    def _visibility(self, number, light):
        """`n.l` where positive, else 0, and the part of the light that is seen: (N,) each."""
        name, scene, plan, points = f"shadow {number}", self._scene, self._plan, self._points
        if not self._casting:
            plan.count(name, 0, 0)
            return np.maximum(points.normal @ light.direction, 0.0), np.ones(len(points))
        from framework.render_kernels import offset_points, shadow_rays

        offset, edges = scene.reach / 2400, np.geomspace(scene.reach / 600, scene.reach, _SEGMENTS + 1)
        low, high = self._bounds.boxes(np.maximum(edges[1:] / light.k, 1e-4) * (1 + 1e-6))
        cosine, mask = recycle.empty((len(points),)), np.empty(len(points), bool)
        ways = low, high, self._bounds.planes, edges, light.k
        shadow_rays(points.position, points.normal, light.direction, offset, *ways, cosine, mask)
        wanted, visible = np.flatnonzero(mask | plan.everything), np.ones(len(points))
        plan.count(name, len(wanted), len(points))
        if len(wanted):
            march = self._functions.get("soft_shadow", f"the shadows of light {number}")
            origin = recycle.empty((len(wanted), 3))
            offset_points(points.position, points.normal, wanted, offset, origin)
            limits = light.k, edges[0], edges[-1], _SHADOW_STEPS
            visible[wanted], evaluations = counted(march, self._occluder(), origin, light.direction, *limits)
            plan.count_each(name, evaluations)
        return cosine, visible
