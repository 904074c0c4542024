"""What a distance field of a mesh costs to store and to rebuild, and how good it is: `python benchmarks/grid.py`.

A scene of three objects, 66 000 triangles each; one of them moves. A shadow map holds none of this: it is drawn anew.
"""

import time

import numpy as np

import framework as fw
from benchmarks.harness import Contender
from framework import mesh as shapes
from framework import sdf

RESOLUTIONS = (32, 64, 128, 256)
MAP_SIZES = (512, 1024, 2048)
LIGHT = fw.Camera((4.0, 9.0, 3.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.45)
TITLE = "Meshes as grids of distances: built whole, or brought up to date after a move"
ERROR, WORK = "mean distance from the truth near the surface, scene units", "bytes"


def contenders(resolutions=(16, 32, 64), triangles=10_000):
    """Grids of two bumpy spheres, built whole, and brought up to date after one of them moved."""
    objects = [shapes.bumpy_sphere(triangles), shapes.bumpy_sphere(triangles)]
    places = np.array([[-1.3, 0.0, 0.0], [1.3, 0.0, 0.0]])
    before, after = _placed(objects, places), _placed(objects, places + [[0.0, 0.0, 0.0], [0.0, 0.1, 0.0]])
    points = _near(after, 4000)
    truth = _distance(after, points)

    def error(grid):
        return float(np.abs(truth - np.abs(grid(points)))[truth < 2 * grid.cell].mean())

    found = []
    for size in resolutions:
        old = sdf.from_mesh(before, size)
        for method, run in (
            ("built whole", lambda size=size: sdf.from_mesh(after, size)),
            ("brought up to date", lambda old=old: old.updated(after)),
        ):
            found.append(Contender(method, f"{size} cells", run, error, lambda grid: grid.nbytes))
    return found


def rows(resolutions=RESOLUTIONS, map_sizes=MAP_SIZES, triangles=66_000):
    """A row for each grid resolution and shadow map size.

    Returns
    -------
    list of dict        `name`, `size` (cells along the longest side, or pixels); `bytes`, and `dense_bytes` of all
                        samples as float32; `build_ms`; `mean_error`, `max_error` in scene units, of points within
                        two cells of the surface; after one of three objects moved: `update_ms` of the one grid and
                        `update_share` of its bricks that were sampled again, `move_ms` where each object has its own
                        grid. None where a column does not apply
    """
    objects = [
        shapes.bumpy_sphere(triangles),
        shapes.bumpy_sphere(triangles),
        shapes.torus(0.6, 0.25, 256, 128),
    ]
    places = np.array([[-1.3, 0.0, 0.0], [1.3, 0.0, 0.0], [0.0, 1.1, 0.0]])
    moved = places + [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -0.1, 0.0]]
    before, after = _placed(objects, places), _placed(objects, moved)
    points = _near(before, 4000)
    truth = _distance(before, points)
    sdf.from_mesh(shapes.box(), 8)  # compiles
    return [
        *(_grid_row(objects, moved, before, after, points, truth, size) for size in resolutions),
        *(_map_row(after, size) for size in map_sizes),
    ]


def _grid_row(objects, moved, before, after, points, truth, size):
    build_ms, grid = _timed(lambda: sdf.from_mesh(before, size))
    update_ms, updated = _timed(lambda: grid.updated(after))
    apart = [sdf.from_mesh(one, max(size // 2, 1)) for one in objects]
    move_ms, _ = _timed(
        lambda: sdf.union(*(sdf.translate(one, place) for one, place in zip(apart, moved, strict=True)))
    )
    near = truth < 2 * grid.cell
    error = np.abs(truth - np.abs(grid(points)))[near]
    low, high = before.vertices.min(axis=0), before.vertices.max(axis=0)
    return {
        "name": "grid", "size": size, "bytes": grid.nbytes,
        "dense_bytes": int(4 * np.prod(np.ceil((high - low) / grid.cell) + 1)),
        "build_ms": build_ms, "mean_error": float(error.mean()), "max_error": float(error.max()),
        "update_ms": update_ms, "update_share": updated.sampled / grid.sampled, "move_ms": move_ms,
    }  # fmt: skip


def _map_row(mesh, size):
    draw_ms, _ = _timed(lambda: fw.rasterize(mesh, LIGHT, size, size, channels=("depth",)))
    return {
        "name": "shadow map", "size": size, "bytes": 4 * size * size, "dense_bytes": 4 * size * size,
        "build_ms": draw_ms, "mean_error": None, "max_error": None,
        "update_ms": draw_ms, "update_share": None, "move_ms": None,
    }  # fmt: skip


def _placed(objects, places):
    first = np.cumsum([0] + [len(one.vertices) for one in objects[:-1]])
    return fw.Mesh(
        np.concatenate([one.vertices + place for one, place in zip(objects, places, strict=True)]),
        np.concatenate([one.faces + k for one, k in zip(objects, first, strict=True)]),
    )


def _near(mesh, count):
    """Points on both sides of the surface, up to a twentieth away, more of them near it."""
    rng = np.random.default_rng(0)
    corners = mesh.vertices[mesh.faces[rng.integers(len(mesh.faces), size=count)]]
    on = (rng.dirichlet(np.ones(3), count)[..., None] * corners).sum(axis=1)
    normal = fw.normalize(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    return on + normal * (0.05 * rng.uniform(-1, 1, (count, 1)) ** 3)


def _distance(mesh, points):
    """Exact distances, (N, 3) -> (N,), by the search that fills the grid, which tests hold to brute force."""
    from framework.grid_bvh import tree_of
    from framework.grid_bvh_kernels import nearest

    tree = tree_of(mesh.vertices[mesh.faces])
    return np.sqrt([nearest(*point, 0, tree)[0] for point in points])


def _timed(run, repeats=3):
    """Median wall time in milliseconds, and a result."""
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        result = run()
        times.append(1e3 * (time.perf_counter() - begun))
    return float(np.median(times)), result


def show(table):
    """Print rows as a table: numbers to three digits."""
    for row in [dict(zip(table[0], table[0], strict=True)), *table]:
        cells = (f"{v:.3g}" if isinstance(v, float) else "" if v is None else str(v) for v in row.values())
        print("  ".join(f"{cell:>12}" for cell in cells))


if __name__ == "__main__":
    show(rows())
