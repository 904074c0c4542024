"""How far the split sum is from Monte Carlo on real and made maps: `python -m solutions.split_sum_error`.

Writes the table that lies beside the notebook. The photographs are read from a folder, since only one of them travels
with the project.
"""

import csv
import sys
import warnings
from pathlib import Path

import numpy as np

import framework as fw
from solutions.prefilter import prefilter
from solutions.split_sum import brdf_lut, microfacet_brdf, monte_carlo_shade, shade_split_sum

ROOT = Path(__file__).resolve().parents[1]
PHOTOGRAPHS = ROOT.parent / "shared" / "data" / "hdri"
TABLE = ROOT / "solutions" / "data" / "split_sum" / "error.csv"
ROUGHNESS, R0 = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0), (0.04, 0.5, 1.0)
# Finer than a ball of 64 pixels can show; every stored map is made for one of the roughnesses above.
ROWS, STORED_ROWS, BALL, SAMPLES = 64, (64, 64, 32, 32, 32, 32), 64, 1024


def maps(folder=PHOTOGRAPHS, rows=ROWS):
    """The maps of the table by name: the two photographs of the folder, and three that are made.

    Returns
    -------
    dict of str -> framework.Environment, each with that many rows
    """
    with warnings.catch_warnings():  # lossy files ring below zero beside what is bright
        warnings.simplefilter("ignore", UserWarning)
        sky = fw.Environment.load(Path(folder) / "sky_512x256.exr").resized(rows)
        studio = fw.Environment.load(Path(folder) / "studio_1024x512.exr").resized(rows)
    return {
        "photo: sky with sun": sky,
        "photo: studio": studio,
        "made: overcast": fw.skies.gradient(rows),
        "made: sun and sky": fw.skies.sun_and_sky(rows),
        "made: softboxes": fw.skies.studio(rows),
    }


def ball(size=BALL):
    """A ball that fills a picture: its mask (size, size), and normal and view of what is seen of it, (N, 3) each."""
    camera = fw.Camera(position=(0.0, 0.0, 5.0), target=(0.0, 0.0, 0.0), up=(0, 1, 0), fov_y=0.42)
    seen = fw.rasterize(fw.mesh.sphere(), camera, size, size)
    return seen.mask, fw.normalize(seen.normal[seen.mask]), fw.normalize(camera.position - seen.position[seen.mask])


def truth(env, normal, view, alpha, samples=SAMPLES):
    """The rendering equation without visibility for r0 = 0 and r0 = 1; in between it is linear in r0.

    Parameters
    ----------
    env : framework.Environment
    normal, view : (N, 3) float     unit vectors, n.v > 0
    alpha : float                   width
    samples : int                   directions for each point

    Returns
    -------
    (2, N, 3) float                 radiance for r0 = 0 and for r0 = 1

    Notes
    -----
    `monte_carlo_shade` under the map clamped at ten times its mean, with evenly spread numbers; what is brighter is
    added up pixel by pixel, in 4 x 4 parts: so a sun leaves no noise.
    """
    mean = np.tensordot(env.solid_angles(), env.pixels, axes=2).mean() / (4.0 * np.pi)
    calm = fw.Environment(np.minimum(env.pixels, 10.0 * mean))
    fine = fw.environment.pixel_directions(4 * env.height).reshape(-1, 3)
    bright = env.radiance(fine) - calm.radiance(fine)
    shines = bright.max(axis=1) > 0.0
    to_light, power = fine[shines], bright[shines]
    power *= fw.environment.pixel_solid_angles(4 * env.height).reshape(-1, 1)[shines]
    result = np.stack([monte_carlo_shade(calm, normal, view, r0, alpha, samples, _Even()) for r0 in (0.0, 1.0)])
    step = max(1, 200_000 // max(len(to_light), 1))
    for i in range(0, len(normal) if len(to_light) else 0, step):
        n, v = (np.repeat(a[i : i + step], len(to_light), axis=0) for a in (normal, view))
        l = np.tile(to_light, (len(n) // len(to_light), 1))
        reflected = microfacet_brdf(n, v, l, (0.0, 1.0, 1.0), alpha) * fw.arrays.dot(n, l)[:, None]
        reflected = reflected[:, :2].reshape(-1, len(to_light), 2)
        result[:, i : i + step] += np.einsum("nlf,lk->fnk", reflected, power)
    return result


class _Even:
    """Stands in for a generator: points as even as can be, turned for each row of them, the same every time."""

    def random(self, shape):
        rows, samples, _ = shape
        turn = np.random.default_rng(rows).random((rows, 1, 2))
        return np.minimum((fw.hammersley(samples) + turn) % 1.0, np.nextafter(1.0, 0.0))


def measure(envs, roughness=ROUGHNESS, r0=R0):
    """Compare both answers on a ball.

    Parameters
    ----------
    envs : dict of str -> framework.Environment
    roughness, r0 : sequences of float

    Yields
    ------
    dict            map, roughness, r0, relmse, flip (empty where FLIP has no wheel)
    """
    lut, (mask, normal, view) = brdf_lut(64, 1024), ball()
    stored_rows = dict(zip(ROUGHNESS, STORED_ROWS, strict=True))
    for name, env in envs.items():
        for rough in roughness:
            stored = fw.Environment(prefilter(env, rough**2, min(stored_rows[rough], env.height), 256))
            black, white = truth(env, normal, view, rough**2)
            for reflectance in r0:
                slow = black + reflectance * (white - black)
                fast = shade_split_sum(normal, view, reflectance, rough, lambda d, _, s=stored: s.radiance(d), lut)
                pictures = np.zeros((2, *mask.shape, 3))
                pictures[:, mask] = fast, slow
                try:
                    perceived = round(fw.metrics.flip(*pictures)[0], 4)
                except ImportError:
                    perceived = ""
                # In units of the picture's own mean, so that one small number keeps black from dividing in all.
                relmse = fw.metrics.relmse(fast / slow.mean(), slow / slow.mean())
                yield dict(map=name, roughness=rough, r0=reflectance, relmse=float(f"{relmse:.3g}"), flip=perceived)


if __name__ == "__main__":
    with open(TABLE, "w", newline="", encoding="ascii") as file:
        writer = csv.DictWriter(file, ["map", "roughness", "r0", "relmse", "flip"], lineterminator="\n")
        writer.writeheader()
        for row in measure(maps(*sys.argv[1:])):
            writer.writerow(row)
            file.flush()
            print(*row.values())
