"""The rasteriser by number of triangles, and OpenGL on the same processor where it is installed.

A frame has 1024 x 1024 pixels. The mesh is a bumpy sphere that covers 56 % of them; half of its triangles face away,
and are drawn like the others. OpenGL writes float32 into memory that it keeps, this course float64.
"""

import functools
import sys

import framework as fw
from framework import mesh as shapes

TITLE = "G-buffers of 1024 x 1024 pixels: run time by triangles"
SIZE = 1024
CAMERA = fw.Camera((0.3, 0.5, 2.6), (0, 0, 0), (0, 1, 0), 0.9)
TRIANGLES = (1_000, 10_000, 66_000, 300_000, 1_000_000, 5_000_000)
CHANNELS = {"triangle alone": (), "depth": ("depth",), "position and normal": ("position", "normal")}


def series():
    found: dict[str, dict] = {name: {} for name in CHANNELS}
    for triangles in TRIANGLES:
        mesh = shapes.bumpy_sphere(triangles)
        for name, channels in CHANNELS.items():
            run = functools.partial(fw.rasterize, mesh, CAMERA, SIZE, SIZE, channels=channels)
            found[name][len(mesh.faces)] = run
        peer = _peer(mesh)
        if peer is not None:
            found.setdefault(f"position and normal, {peer.name}", {})[len(mesh.faces)] = peer.draw
    return found


@functools.cache
def _missing():
    """Say once what keeps OpenGL away, "" if nothing does."""
    try:
        from benchmarks.peers import llvmpipe_raster

        llvmpipe_raster.Rasterizer(shapes.bumpy_sphere(12), CAMERA, 8, 8)
    except Exception as problem:  # no package, no library, no context: each has its own kind
        print(f"raster: OpenGL is left out ({problem}); pip install moderngl, apt-get install libegl1 libgl1-mesa-dri",
              file=sys.stderr)  # fmt: skip
        return str(problem) or "unknown"
    return ""


def _peer(mesh):
    if _missing():
        return None
    from benchmarks.peers.llvmpipe_raster import Rasterizer

    return Rasterizer(mesh, CAMERA, SIZE, SIZE)
