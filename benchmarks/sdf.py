"""Run time and error of `render_sdf`: `python -m benchmarks.sdf [SCENE.json]`.

Each time is the median of seven pictures of 512 x 512 pixels after a warm-up, position, normal and soft shadow. The
peer, a fragment shader on Mesa's llvmpipe, draws in turn with it where moderngl is installed, without being read
back. Errors are against a march fifty times tighter and, of the visibility, against `soft_shadow` at the same points.

Measured on two cores: nine primitives 6.6 ms where the shader takes 22.7. Visibility differs from the reference's by
4e-7 in the mean; of 16384 pixels none (nine) and one (500) sees something else than the tighter march, at a silhouette.
From 10 primitives to 10000 the time grows by 4.1 where they spread, by 12.5 where they shrink and shadow rays pass many.
"""

import sys
import time

import numpy as np

import framework as fw
from benchmarks.peers.llvmpipe import draw_only
from framework import sdf
from solutions.fast import render_sdf
from solutions.soft_shadows import soft_shadow
from solutions.sphere_tracing import sphere_trace

SIZE, K = 512, 8.0
LIGHT = fw.normalize([0.5, 0.8, 0.3])
CAMERA = fw.Camera((4.5, 3.5, 6.0), (0, 0.5, 0), (0, 1, 0), 0.9272952180016122)
FOUND = 1e-6  # where the reference's march ends; a pixel's radius is 1.5e-2 in the middle of the picture


def nine():
    """A floor and eight objects on it."""
    return sdf.union(
        sdf.plane((0, 1, 0), 0),
        sdf.sphere((0, 1, 0), 1.0),
        sdf.box((2.2, 0.7, 0), (0.7, 0.7, 0.7)),
        sdf.torus((-2.2, 0.5, 0), 0.8, 0.3),
        sdf.smooth_union(sdf.sphere((0, 0.6, 2.0), 0.6), sdf.sphere((0.7, 0.9, 2.2), 0.5), 0.3),
        sdf.capsule((-2, 0, 2), (-2, 1.2, 2), 0.3),
        sdf.box((2, 0.5, 2.2), (0.5, 0.5, 0.5)),
        sdf.sphere((0, 0.4, -2.2), 0.4),
    )


def in_space(count, seed=0):
    """A floor, and spheres, boxes, rings and capsules all over the room above it."""
    rng = np.random.default_rng(seed)
    centers, sizes = rng.uniform((-3, 0, -3), (3, 3, 3), (count, 3)), rng.uniform(0.05, 0.25, count)
    return sdf.union(sdf.plane((0, 1, 0), 0), *map(_object, range(count), centers, sizes))


def on_floor(count, extent=3.0, size=None, seed=0):
    """Objects on a floor that cover the same part of it, however many they are: smaller, or on more of it."""
    rng = np.random.default_rng(seed)
    size = size or 0.4 * extent / np.sqrt(count)
    centers = rng.uniform((-extent, 0, -extent), (extent, 0, extent), (count, 3)) + (0, size, 0)
    return sdf.union(sdf.plane((0, 1, 0), 0), *map(_object, range(count), centers, np.full(count, size)))


def _object(i, center, size):
    return (
        lambda: sdf.sphere(center, size),
        lambda: sdf.box(center, (size, 0.7 * size, 0.5 * size)),
        lambda: sdf.torus(center, size, 0.3 * size),
        lambda: sdf.capsule(center, center + (0, size, 0), 0.5 * size),
    )[i % 4]()


def main(scene=None):
    scenes = {"nine": scene or nine(), "500 in space": in_space(500)}
    for name, field in scenes.items():
        ours, peer = times(field, draw_only)
        print(f"{name}: {ours:.1f} ms", end="")
        print(f", llvmpipe {peer:.1f} ms, ratio {ours / peer:.3f}" if peer else "")
    for name, made in {
        "smaller": on_floor,
        "farther": lambda n: on_floor(n, 0.95 * np.sqrt(n), 0.38),
    }.items():
        growth = {count: times(made(count))[0] for count in (10, 100, 1000, 10_000)}
        print(f"ever {name}:", ", ".join(f"{count} {ms:.1f} ms" for count, ms in growth.items()), end="")
        print(f"; 10 to 10000: {growth[10_000] / growth[10]:.2f} times")
    for name, field in scenes.items():
        print(f"{name}:", ", ".join(f"{key} {value:.3g}" for key, value in errors(field, SIZE // 4).items()))


def times(field, peer=None, frames=7):
    """Medians in ms of `render_sdf` and of a peer that draws in turn with it, 0 for none."""
    ours, theirs = [], []
    for _ in range(frames + 1):
        start = time.perf_counter()
        render_sdf(field, CAMERA, SIZE, SIZE, LIGHT, K)
        ours.append(time.perf_counter() - start)
        start = time.perf_counter()
        if peer and peer(field, CAMERA, SIZE, SIZE, LIGHT, K):
            theirs.append(time.perf_counter() - start)
    return 1e3 * np.median(ours[1:]), 1e3 * np.median(theirs[1:]) if theirs else 0.0


def errors(field, size):
    """What differs from a march fifty times tighter, and from the reference's visibility."""
    t, normal, visibility = render_sdf(field, CAMERA, size, size, LIGHT, K)
    origin, direction = CAMERA.rays(size, size)
    expected, _ = sphere_trace(field, origin.reshape(-1, 3), direction.reshape(-1, 3), 40.0, FOUND, 4000)
    expected = expected.reshape(size, size)
    both = np.isfinite(t) & np.isfinite(expected)
    away = np.full(t.shape, np.inf)
    away[both] = np.abs(t[both] - expected[both])
    away[~np.isfinite(t) & ~np.isfinite(expected)] = 0.0
    footprint = np.tan(CAMERA.fov_y / 2) / size * np.where(np.isfinite(expected), expected, 40.0)
    other = away > footprint
    p = origin[both] + t[both][:, None] * direction[both] + 0.005 * normal[both]
    reference = np.where(normal[both] @ LIGHT > 0, soft_shadow(field, p, LIGHT, K, 0.02, 12.0, 500), 0.0)
    off = np.abs(visibility[both] - reference)
    return {
        "pixels with another hit": other.mean(),
        "of them farther than a pixel from a silhouette": (other & ~_near_silhouette(expected)).sum(),
        "99th percentile of t": np.percentile(away[both], 99),
        "in half footprints": np.percentile((away / footprint)[both], 99),
        "visibility, mean": off.mean(),
        "99.9th percentile": np.percentile(off, 99.9),
    }


def _near_silhouette(t, jump=0.02):
    """Pixels beside which, or at which, `t` jumps."""
    t = np.pad(np.where(np.isfinite(t), t, 1e3), 1, mode="edge")
    height, width = t.shape
    around = [t[r : height - 2 + r, c : width - 2 + c] for r in range(3) for c in range(3)]
    return np.ptp(around, axis=0) > jump


if __name__ == "__main__":
    main(*map(sdf.load, sys.argv[1:2]))
