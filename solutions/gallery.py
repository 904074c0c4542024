"""Pictures that show what the course is about: `make demo` renders them. Copies of three stand in docs/pictures/."""

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
from solutions.daylight import FLOOR, daylight, part_colors
from solutions.gallery_errors import PAPER, shadow_errors, sheet, split_sum_errors

CAMERA = dict(position=[4.5, 3.5, 6.0], target=[0, 0.5, 0], up=[0, 1, 0], fov_y=0.9272952180016122)
DATA = Path(fw.__file__).parent / "data"
OVERSAMPLING = 2
TO_SUN = (-0.5, 0.8, 0.45)
COLORS = [FLOOR, (0.72, 0.30, 0.18), (0.18, 0.34, 0.58), (0.78, 0.55, 0.16),
          (0.24, 0.46, 0.26), (0.55, 0.28, 0.46), (0.20, 0.45, 0.50), (0.62, 0.58, 0.50)]  # fmt: skip


def three_lights(size=240):
    """One ray a pixel, lights of three sizes: k = 2, 8 and 32 are 1 / sin of angular radii of 30, 7 and 2 degrees."""
    parts = [
        fw.sdf.plane((0, 1, 0), 0.0),
        fw.sdf.sphere((-1.1, 0.6, 0.3), 0.5),
        fw.sdf.torus((-0.1, 0.9, -0.8), 0.5, 0.14),
        fw.sdf.box((0.6, 0.6, 0.8), (0.25, 0.6, 0.25)),
    ]
    camera = fw.Camera((2.6, 3.4, 4.4), (0.15, 0.3, 0.15), (0, 1, 0), 0.55)
    paint = part_colors(parts, [FLOOR, COLORS[2], COLORS[1], COLORS[3]], camera, size)
    return sheet([[daylight(fw.sdf.union(*parts), camera, size, k, paint) for k in (2.0, 8.0, 32.0)]])


def nine_shapes(size=400):
    """Nine shapes, blended and plain, met by sphere tracing; the sun's shadows come from the same march."""
    scene, camera = _nine_shapes(), fw.Camera(**CAMERA | {"fov_y": 0.8})
    return daylight(scene, camera, size, 60.0, part_colors(scene.of, COLORS, camera, size), TO_SUN)


def march_cost(width=480, height=320):
    """What rays to such shapes cost, from 0 evaluations of the distance, dark, to 60, bright: most where they graze one."""
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
    shown = _shown(image)
    return shown.reshape(height, OVERSAMPLING, width, OVERSAMPLING, 3).mean(axis=(1, 3))


def environment_three_ways(width=480):
    """One sky as a map of all directions, on a mirror ball, and as the six faces of a cube: +x, -x, +y, -y, +z, -z."""
    env, gap = _sky(), 6
    size = (width - 5 * gap) // 6
    ball = (width - 3 * gap) // 3
    canvas = np.full((ball + gap + size, width, 3), PAPER)
    canvas[:ball, : 2 * ball] = _shown(env.resized(ball).pixels)
    y, x = np.mgrid[1 : -1 : ball * 1j, -1 : 1 : ball * 1j]
    inside = x * x + y * y < 0.98
    normal = np.stack([x, y, np.sqrt(np.clip(1 - x * x - y * y, 0, 1))], axis=-1)[inside]
    canvas[:ball, -ball:][inside] = _shown(env.radiance(fw.reflect(np.array([0.0, 0.0, 1.0]), normal)))
    for i, face in enumerate(env.to_cube(size)):
        canvas[-size:, i * (size + gap) :][:, :size] = _shown(face)
    return canvas


def _example(name, width=480, height=320, oversampling=OVERSAMPLING):
    """A function that renders one of the framework's scenes with the compiled twins, where there are any."""
    scene_of = functools.cache(lambda: _quietly(lambda: fw.load_scene(name)))
    functions = [fast, split_sum, soft_shadows, environment_shadows, sphere_tracing]

    def draw():
        large, tall = oversampling * width, oversampling * height
        image, _ = _quietly(lambda: fw.render_scene(scene_of(), large, tall, functions))
        shown = fw.tone_map(image, method="filmic")
        return shown.reshape(height, oversampling, width, oversampling, 3).mean(axis=(1, 3))

    draw.__doc__ = json.loads((EXAMPLES / f"{name}.json").read_text(encoding="utf-8"))["about"]
    return draw


PICTURES = {
    "courtyard": _example("courtyard", 360, 240),
    "roughness": _example("roughness"),
    "three_lights": three_lights,
    "nine_shapes": nine_shapes,
    "march_cost": march_cost,
    "shadow_errors": shadow_errors,
    "environment_three_ways": environment_three_ways,
    "mirrors": mirrors,
    "split_sum_errors": split_sum_errors,
    "meeting": _example("meeting"),
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


def _shown(radiance):
    return fw.tone_map(radiance, exposure=-0.5, method="filmic")


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
