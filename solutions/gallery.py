"""Pictures that show what the course is about, made by the reference: `make demo` renders them."""

from __future__ import annotations

import html
import sys
import time
from pathlib import Path

import numpy as np

import framework as fw
from solutions import sphere_tracing

CAMERA = dict(position=[4.5, 3.5, 6.0], target=[0, 0.5, 0], up=[0, 1, 0], fov_y=0.9272952180016122)
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


PICTURES = {"traced_scene": traced_scene, "march_cost": march_cost}


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
        figures.append(f'<figure><img src="{name}.png" alt="{name}"><figcaption>{caption}</figcaption></figure>')
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
