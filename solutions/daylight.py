"""A distance field in daylight: a sun with soft shadows and a sky, drawn by the compiled engine for the walkthroughs."""

import numpy as np

import framework as fw
from solutions import fast

CLAY, FLOOR = (0.72, 0.45, 0.32), (0.66, 0.64, 0.60)
TO_SUN = (-0.8, 1.0, 0.4)
SUN, SKY = np.array([[2.6, 2.35, 2.0], [0.42, 0.52, 0.68]], np.float32)
_OVERSAMPLING = 2


def daylight(scene, camera, size, k=32.0, albedo=CLAY, to_sun=TO_SUN):
    """Draw a distance field, as wide as high.

    Parameters
    ----------
    scene : framework.sdf node
    camera : framework.Camera
    size : int                  of the picture, pixels
    k : float                   1 / sin(angular radius of the sun): larger is harder
    albedo : (3,) float, or what `part_colors` returns
    to_sun : (3,) float         of any length

    Returns
    -------
    (size, size, 3) float64     display values in [0, 1]
    """
    large = _OVERSAMPLING * size
    t, normal, visible = fast.render_sdf(scene, camera, large, large, to_sun, k)
    cosine = np.maximum(normal @ fw.normalize(to_sun).astype(np.float32), 0)
    light = (cosine * visible)[..., None] * SUN + (0.6 + 0.4 * normal[..., 1:2]) * SKY
    image = np.where(np.isfinite(t)[..., None], light * np.asarray(albedo, np.float32), 1.1 * SKY)
    shown = fw.tone_map(0.4 * image, method="filmic")
    return shown.reshape(size, _OVERSAMPLING, size, _OVERSAMPLING, 3).mean(axis=(1, 3))


def part_colors(parts, colors, camera, size):
    """The colour of the nearest part at each point that a camera sees of their union, for `daylight`.

    Parameters
    ----------
    parts : sequence of framework.sdf nodes
    colors : sequence of (3,) float     linear, one for each part
    camera, size                        as for `daylight`

    Returns
    -------
    (H, W, 3) float             0 where nothing is seen
    """
    large = _OVERSAMPLING * size
    t, _, _ = fast.render_sdf(fw.sdf.union(*parts), camera, large, large, TO_SUN, 32.0)
    origin, direction = camera.rays(large, large)
    seen = np.isfinite(t)
    p = origin[seen] + t[seen, None] * direction[seen]
    found = np.zeros((large, large, 3))
    found[seen] = np.asarray(colors, float)[np.argmin([part(p) for part in parts], axis=0)]
    return found
