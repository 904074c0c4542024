"""Pictures of errors for the gallery: what is quick, what is right, and what lies between them."""

from __future__ import annotations

import numpy as np

import framework as fw
from framework import colors
from solutions import fast
from solutions.soft_shadows import area_light_shadow, soft_shadow
from solutions.truth_rays import cast

PAPER = 0.93  # display value of what lies between pictures
SCENE = [
    {"sphere": {"center": [0.0, 0.55, 0.0], "radius": 0.45}},
    {"box": {"center": [1.15, 0.85, 0.2], "half_size": [0.2, 0.5, 0.5]}},
]
TO_LIGHT, ANGLE = fw.normalize(np.array([-0.5, 1.0, 0.35])), 0.16


def shadow_errors(size=200, rays=128):
    """The floor below a ball and a hanging box, from above: 128 rays a pixel; the smallest k h / t, and its error; the smallest
    signed angle, and its error. The light has a radius of 9 degrees. Green is too bright, violet too dark, full colour 0.25."""
    x, z = np.meshgrid(np.linspace(-0.9, 2.5, size), np.linspace(-1.9, 1.5, size))
    p = np.stack([x.ravel(), np.full(x.size, 1e-3), z.ravel()], axis=1)
    field = fw.sdf.union(*(fw.sdf.from_dict(node) for node in SCENE))
    truth = _seen(p, rays)
    ways = [
        soft_shadow(field, p, TO_LIGHT, 1 / np.sin(ANGLE), 0.02, 6.0, 128),
        area_light_shadow(field, p, TO_LIGHT, ANGLE, 0.02, 6.0, 128),
    ]
    blank = np.full((size, size, 3), PAPER)
    top = [np.repeat(fw.tone_map(0.9 * v.reshape(size, size, 1)), 3, axis=2) for v in (truth, *ways)]
    return sheet([top, [blank, *(_error((way - truth).reshape(size, size), 0.25) for way in ways)]])


def split_sum_errors(size=140, samples=768):
    """Balls of gold under softboxes, roughness 0.2, 0.5 and 0.9 from left to right: by 768 directions a pixel, by the
    split sum, and its error as a part of the mean. Green is too bright, violet too dark, full colour 0.5."""
    env = fw.skies.studio(64)
    y, x = np.mgrid[1.02 : -1.02 : size * 1j, -1.02 : 1.02 : size * 1j]
    inside = x * x + y * y < 0.995
    normal = np.stack([x, y, np.sqrt(np.clip(1 - x * x - y * y, 0, 1))], axis=-1)[inside]
    view = np.broadcast_to([0.0, 0.0, 1.0], normal.shape)
    light, r0 = fast.environment_light(env), np.array([1.0, 0.71, 0.29])
    rows: list[list[np.ndarray]] = [[], [], []]
    for roughness in (0.2, 0.5, 0.9):
        true, _ = fast.monte_carlo_shade(env, normal, view, r0, roughness**2, samples, np.random.default_rng(0))
        quick = fast.shade_split_sum(normal, view, r0, roughness, light.prefiltered, light.lut)
        off = (quick - true).mean(axis=-1) / true.mean()
        shown = (fw.tone_map(true, -1.2, "filmic"), fw.tone_map(quick, -1.2, "filmic"), _error(off, 0.5))
        for row, values in zip(rows, shown, strict=True):
            picture = np.full((size, size, 3), PAPER)
            picture[inside] = values
            row.append(picture)
    return sheet(rows)


def _seen(p, rays):
    """Part of the light's disc that each point sees, by rays spread evenly over it, cast in closed form."""
    across, along = fw.orthonormal_frame(TO_LIGHT)
    free = np.zeros(len(p))
    for i in range(rays):
        radius, phi = np.tan(ANGLE) * np.sqrt((i + 0.5) / rays), i * np.pi * (3 - np.sqrt(5))
        ray = fw.normalize(TO_LIGHT + radius * (np.cos(phi) * across + np.sin(phi) * along))
        free += np.isinf(cast(SCENE, p, np.broadcast_to(ray, p.shape))[0])
    return free / rays


def _error(values, limit):
    return colors.from_table(values, -limit, limit, colors.SIGNED_ERROR) / 255


def sheet(rows, gap=6):
    """Rows of pictures of one size, (H, W, 3) display values, as one."""
    height, width = rows[0][0].shape[:2]
    canvas = np.full((len(rows) * (height + gap) - gap, len(rows[0]) * (width + gap) - gap, 3), PAPER)
    for i, row in enumerate(rows):
        for j, picture in enumerate(row):
            canvas[i * (height + gap) :, j * (width + gap) :][:height, :width] = picture
    return canvas
