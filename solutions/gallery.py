"""Pictures that show what the course is about, made by the reference: `make demo` renders them."""

from __future__ import annotations

import functools
import html
import json
import sys
import time
import warnings
from pathlib import Path

import numpy as np

import framework as fw
from framework.scene_file import EXAMPLES
from solutions import environment_shadows, fast, soft_shadows, sphere_tracing, split_sum

CAMERA = dict(position=[4.5, 3.5, 6.0], target=[0, 0.5, 0], up=[0, 1, 0], fov_y=0.9272952180016122)
DATA = Path(fw.__file__).parent / "data"
OVERSAMPLING = 2
TO_SUN = [0.5, 0.8, 0.3]
COLORS = [[0.62, 0.60, 0.56], [0.80, 0.42, 0.30], [0.30, 0.48, 0.70], [0.84, 0.66, 0.28],
          [0.40, 0.62, 0.42], [0.70, 0.45, 0.62], [0.35, 0.60, 0.64], [0.75, 0.72, 0.66]]  # fmt: skip


def traced_scene(width=480, height=320):
    """Nine shapes, met by sphere tracing and lit by a sun with hard shadows."""
    scene, camera = _nine_shapes(), fw.Camera(**CAMERA)
    origin, direction = (a.reshape(-1, 3) for a in camera.rays(width, height))
    t, hit = sphere_tracing.sphere_trace(scene, origin, direction, 60.0, 1e-3, 256)
    image = np.array([0.42, 0.58, 0.80]) * (1 - 0.8 * np.clip(direction[:, 1:2], 0, 1))
    p = origin[hit] + t[hit, None] * direction[hit]
    normal = sphere_tracing.estimate_normal(scene, p, 1e-4)
    to_sun = np.broadcast_to(fw.normalize(TO_SUN), p.shape)
    lit = np.sum(normal * to_sun, axis=1)
    _, shadowed = sphere_tracing.sphere_trace(scene, p + 5e-3 * normal, to_sun, 20.0, 1e-4, 128)
    light = 1.2 * (np.clip(lit, 0, 1) * ~shadowed)[:, None] * [1.0, 0.93, 0.8]
    light = light + 0.25 * (0.6 + 0.4 * normal[:, 1:2]) * [0.75, 0.87, 1.0]
    shape = np.argmin([part(p) for part in scene.of], axis=0)
    image[hit] = light * np.array(COLORS)[shape]
    return fw.tone_map(image.reshape(height, width, 3))


def march_cost(width=480, height=320):
    """What each ray of that picture cost: evaluations of the distance, most of them where rays graze a surface."""
    from framework import colors

    scene, camera = _nine_shapes(), fw.Camera(**CAMERA)
    origin, direction = (a.reshape(-1, 3) for a in camera.rays(width, height))
    counts, t = np.zeros(len(origin)), np.zeros(len(origin))
    marching = np.arange(len(origin))
    for _ in range(128):
        distance = scene(origin[marching] + t[marching, None] * direction[marching])
        counts[marching] += 1
        t[marching] += distance
        marching = marching[(distance > 1e-3) & (t[marching] < 60)]
    return colors.from_table(counts.reshape(height, width), 0, 60, colors.SEQUENTIAL)


def mirrors(width=480, height=320):
    """The teapot and a bumpy sphere, rasterised, as mirrors under a real sky."""
    env = _sky()
    camera = fw.Camera([0, 3.6, 10.5], [0, 1.0, 0], [0, 1, 0], 0.55)
    teapot = fw.load_mesh(DATA / "teapot.obj")
    low, high = teapot.vertices.min(axis=0), teapot.vertices.max(axis=0)
    to_y_up = (
        np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]) if high[2] - low[2] < high[1] - low[1] else np.eye(3)
    )
    vertices = (teapot.vertices - 0.5 * (low + high)) @ to_y_up.T * (3.6 / (high - low).max())
    teapot = fw.Mesh(vertices + [-1.9, 1.0, 0], teapot.faces)
    bumpy = fw.mesh.bumpy_sphere(60_000)
    bumpy = fw.Mesh(1.35 * bumpy.vertices + [2.4, 1.1, 0], bumpy.faces, bumpy.normals)
    large, tall = OVERSAMPLING * width, OVERSAMPLING * height
    image = env.radiance(camera.rays(large, tall)[1])
    nearest = np.full((tall, large), np.inf)
    for mesh in (teapot, bumpy):
        gbuffer = fw.rasterize(mesh, camera, large, tall)
        covered = gbuffer.mask & (gbuffer.depth < nearest)
        nearest[covered] = gbuffer.depth[covered]
        view = fw.normalize(camera.position - gbuffer.position[covered])
        normal = gbuffer.normal[covered]
        normal = np.where(np.sum(normal * view, axis=-1, keepdims=True) < 0, -normal, normal)
        image[covered] = 0.85 * env.radiance(fw.reflect(view, normal))
    shown = fw.tone_map(image, exposure=-0.5, method="filmic")
    return shown.reshape(height, OVERSAMPLING, width, OVERSAMPLING, 3).mean(axis=(1, 3))


def environment_three_ways(width=480, height=320):
    """One environment as a map, as the six faces of a cube (+x, -x, +y, -y, +z, -z), and on a mirror ball."""
    env = _sky()
    canvas = np.zeros((height, width, 3))
    map_height = height // 2
    canvas[:map_height, : 2 * map_height] = env.resized(map_height).pixels
    ball = width - 2 * map_height
    y, x = np.mgrid[1 : -1 : ball * 1j, -1 : 1 : ball * 1j]
    inside = x * x + y * y < 0.98
    normal = np.stack([x, y, np.sqrt(np.clip(1 - x * x - y * y, 0, 1))], axis=-1)[inside]
    canvas[:ball, 2 * map_height :][inside] = env.radiance(fw.reflect(np.array([0.0, 0.0, 1.0]), normal))
    size = width // 6
    top = map_height + (height - map_height - size) // 2
    canvas[top : top + size, : 6 * size] = np.concatenate(list(env.to_cube(size)), axis=1)
    return fw.tone_map(canvas, exposure=-0.5, method="filmic")


def _example(name):
    """A function that renders one of the framework's scenes with the compiled twins, where there are any."""
    scene_of = functools.cache(lambda: _quietly(lambda: fw.load_scene(name)))
    functions = [fast, split_sum, soft_shadows, environment_shadows, sphere_tracing]

    def draw(width=480, height=320):
        large, tall = OVERSAMPLING * width, OVERSAMPLING * height
        image, _ = _quietly(lambda: fw.render_scene(scene_of(), large, tall, functions))
        shown = fw.tone_map(image, method="filmic")
        return shown.reshape(height, OVERSAMPLING, width, OVERSAMPLING, 3).mean(axis=(1, 3))

    draw.__doc__ = json.loads((EXAMPLES / f"{name}.json").read_text(encoding="utf-8"))["about"]
    return draw


PICTURES = {
    "traced_scene": traced_scene,
    "march_cost": march_cost,
    "mirrors": mirrors,
    "environment_three_ways": environment_three_ways,
    **{
        name: _example(name)
        for name in ("roughness", "penumbra", "three_lamps", "meeting", "fields", "teapot")
    },
}


def render(folder, progress=True) -> Path:
    """Render every picture into `folder`, with a page that shows them.

    Parameters
    ----------
    folder : path
    progress : bool     a line for each picture, on stderr

    Returns
    -------
    Path                the page
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    figures = []
    for name, draw in PICTURES.items():
        begun = time.perf_counter()
        fw.write_image(folder / f"{name}.png", draw())
        if progress:
            print(f"  {name}: {time.perf_counter() - begun:.1f} s", file=sys.stderr)
        caption = html.escape(" ".join((draw.__doc__ or "").split()))
        figures.append(
            f'<figure><img src="{name}.png" alt="{name}"><figcaption>{caption}</figcaption></figure>'
        )
    page = folder / "index.html"
    page.write_text(_PAGE.format("\n".join(figures)), encoding="utf-8")
    return page


_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Gallery</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
:root {{ color-scheme: light dark }}
body {{ font: 16px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 66em; padding: 0 1em }}
main {{ display: grid; grid-template-columns: repeat(auto-fill, minmax(min(30em, 100%), 1fr)); gap: 1.5em }}
figure {{ margin: 0 }} img {{ width: 100%; height: auto; border-radius: 4px }} figcaption {{ opacity: .75 }}
</style>
<h1>Gallery</h1><main>
{}
</main></html>
"""


def _sky():
    return _quietly(lambda: fw.Environment.load(DATA / "sky_512x256.exr"))


def _quietly(function):
    """What it returns. Known warnings: lossy files ring below zero beside the sun; the teapot's mesh is open."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return function()


def _nine_shapes():
    return fw.sdf.union(
        fw.sdf.plane([0, 1, 0], 0.0),
        fw.sdf.sphere([0, 1, 0], 1.0),
        fw.sdf.box([2.2, 0.7, 0], [0.7, 0.7, 0.7]),
        fw.sdf.torus([-2.2, 0.5, 0], 0.8, 0.3),
        fw.sdf.smooth_union(fw.sdf.sphere([0, 0.6, 2.0], 0.6), fw.sdf.sphere([0.7, 0.9, 2.2], 0.5), 0.3),
        fw.sdf.capsule([-2, 0, 2], [-2, 1.2, 2], 0.3),
        fw.sdf.box([2, 0.5, 2.2], [0.5, 0.5, 0.5]),
        fw.sdf.sphere([0, 0.4, -2.2], 0.4),
    )
