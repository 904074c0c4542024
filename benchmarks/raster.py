"""Run time of the rasteriser, and its memory: `python benchmarks/raster.py`.

Each line is the median of eleven frames of 1024 x 1024 pixels after a warm-up. The mesh is a bumpy sphere that
covers 56 % of the image; half of its triangles face away, and are drawn like the others.
"""

import resource
import sys
import time

import numpy as np

import framework as fw
from framework import mesh as shapes

SIZE = 1024
CAMERA = fw.Camera((0.3, 0.5, 2.6), (0, 0, 0), (0, 1, 0), 0.9)
CHANNELS = {
    "visibility": (),
    "depth": ("depth",),
    "position and normal": ("position", "normal"),
    "everything": ("depth", "barycentric", "position", "normal"),
}


def main(frames=11):
    print(f"{'triangles':>10}  {'channels':<20} {'median ms':>9} {'fastest ms':>10}")
    for triangles in (66_000, 1_000_000):
        mesh = shapes.bumpy_sphere(triangles)
        for name, channels in CHANNELS.items():
            times = sorted(_frame(mesh, channels) for _ in range(frames + 1))[:frames]
            print(f"{len(mesh.faces):>10}  {name:<20} {1e3 * np.median(times):>9.1f} {1e3 * times[0]:>10.1f}")
    mesh = shapes.bumpy_sphere(5_000_000)
    seconds = _frame(mesh, CHANNELS["position and normal"])
    print(f"{len(mesh.faces)} triangles, position and normal: {1e3 * seconds:.0f} ms")
    # Kilobytes on Linux, bytes on macOS.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 if sys.platform == "darwin" else 1 / 1024)
    print(
        f"peak memory of the process, the mesh's own {_megabytes(mesh):.0f} MB included: {peak / 1e6:.0f} MB"
    )


def _frame(mesh, channels):
    start = time.perf_counter()
    fw.rasterize(mesh, CAMERA, SIZE, SIZE, channels=channels)
    return time.perf_counter() - start


def _megabytes(mesh):
    return (mesh.vertices.nbytes + mesh.faces.nbytes + mesh.normals.nbytes) / 1e6


if __name__ == "__main__":
    main()
