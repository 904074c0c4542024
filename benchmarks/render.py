"""Run time of a whole frame, pass by pass: `python benchmarks/render.py`.

A bumpy sphere of 66 thousand triangles, its SDF shadow and the split sum, 1024 x 1024 pixels, by the compiled twins:
the median of eleven frames after a warm-up, while nothing else runs. Between frames the roughness changes, as it
does under a slider.
"""

import dataclasses
import time

import numpy as np

import framework as fw
from framework import render, render_points
from solutions import fast, soft_shadows, split_sum

SIZE = 1024
FUNCTIONS = [fast, split_sum, soft_shadows]
PASSES = [
    (render_points, "_draw"),
    (render_points, "_gather"),
    (render, "environment_light"),
    (render._Shading, "environment"),
    (render._Shading, "add_light"),
    (render, "_image"),
]


def main(frames=11):
    scene = _scene()
    print(f"{'frame':<34}{'median ms':>10} {'fastest':>8}")
    for title, albedo in (("a rough mirror", 0.0), ("with a matt ground", 0.4)):
        spent: dict[str, list[float]] = {}
        undo = [_timed(owner, name, spent) for owner, name in PASSES]
        times = [_frame(scene, albedo, i) for i in range(frames + 2)][2:]
        for put_back in undo:
            put_back()
        print(f"{title:<34}{1e3 * np.median(times):>10.1f} {1e3 * min(times):>8.1f}")
        for part, seconds in spent.items():
            print(
                f"    {part.strip('_'):<30}{1e3 * np.median(seconds[2:]):>10.1f} {1e3 * min(seconds[2:]):>8.1f}"
            )
    print(fw.render_scene(scene, SIZE, SIZE, FUNCTIONS)[1])


def _scene():
    ball = fw.mesh.bumpy_sphere(66_000)
    occluders = fw.sdf.union(fw.sdf.sphere((0, 0, 0), 0.94), fw.sdf.torus((0.5, 0.9, 0.6), 0.4, 0.1))
    camera = fw.Camera((0.3, 0.5, 2.6), (0, 0, 0), (0, 1, 0), 0.9)
    lamp = fw.Light((1, 1.3, 1), 60, 8)
    return fw.Scene(camera, [fw.SceneObject(ball, casts=occluders)], fw.skies.studio(128), [lamp], reach=6)


def _frame(scene, albedo, i):
    material = fw.Material(0.5, 0.3 + 0.09 * (i % 11) / 11, albedo)
    scene = dataclasses.replace(scene, objects=[dataclasses.replace(scene.objects[0], material=material)])
    start = time.perf_counter()
    fw.render_scene(scene, SIZE, SIZE, FUNCTIONS)
    return time.perf_counter() - start


def _timed(owner, name, spent):
    """Note the time of each call of a function; returns what puts it back as it was."""
    function = getattr(owner, name)

    def timed(*args, **keys):
        start = time.perf_counter()
        result = function(*args, **keys)
        spent.setdefault(name, []).append(time.perf_counter() - start)
        return result

    setattr(owner, name, timed)
    return lambda: setattr(owner, name, function)


if __name__ == "__main__":
    main()
