import warnings

import numba
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework import mesh as shapes
from framework import sdf
from framework.grid import _build


def true_distance(mesh, points):
    """Unsigned, by brute force: to planes where the foot is inside, and to all sides. (N, 3) -> (N,)."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    best = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        side = end - start
        along = np.einsum("nfk,fk->nf", points[:, None] - start, side)
        t = np.clip(along / np.maximum((side * side).sum(1), 1e-300), 0, 1)
        best = np.minimum(best, np.linalg.norm(points[:, None] - start - t[..., None] * side, axis=-1).min(1))
    normal = np.cross(b - a, c - a)
    area = (normal * normal).sum(1)
    flat = area > 1e-24
    a, b, c, normal, area = a[flat], b[flat], c[flat], normal[flat], area[flat]
    if not len(a):
        return best
    p = points[:, None] - a
    u = np.einsum("nfk,fk->nf", np.cross(p, c - a), normal) / area
    v = np.einsum("nfk,fk->nf", np.cross(b - a, p), normal) / area
    height = np.abs(np.einsum("nfk,fk->nf", p, normal)) / np.sqrt(area)
    return np.minimum(best, np.where((u >= 0) & (v >= 0) & (u + v <= 1), height, np.inf).min(1))


def is_inside(mesh, points):
    """By the sum of signed solid angles (van Oosterom and Strackee)."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
    dot = lambda u, v: (u * v).sum(-1)  # noqa: E731
    below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    return np.abs(np.arctan2(dot(a, np.cross(b, c)), below).sum(1) / (2 * np.pi)) > 0.5


def soup(seed, count=12):
    rng = np.random.default_rng(seed)
    return fw.Mesh(rng.uniform(-1, 1, (3 * count, 3)), np.arange(3 * count).reshape(-1, 3))


def joined(*meshes):
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return fw.Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + k for mesh, k in zip(meshes, first, strict=True)]),
    )


def moved(mesh, offset):
    return fw.Mesh(mesh.vertices + offset, mesh.faces)


def quietly(mesh, resolution):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sdf.from_mesh(mesh, resolution)


def points_about(mesh, grid, count, seed=0):
    """A third all around, the others near the surface, where margins matter."""
    rng = np.random.default_rng(seed)
    low, high = grid.bounds
    far = rng.uniform(low - 6 * grid.cell, high + 6 * grid.cell, (count // 3, 3))
    corners = mesh.vertices[mesh.faces[rng.integers(len(mesh.faces), size=count - len(far))]]
    weight = rng.dirichlet(np.ones(3), len(corners))
    near = (weight[..., None] * corners).sum(1) + rng.normal(0, grid.cell, (len(corners), 3))
    return np.concatenate([far, near])


THIN = shapes.box((1.0, 0.01, 1.0))
CLOSED = {
    "ball": shapes.sphere(1.0, (0.2, -0.1, 0.4), rings=16, segments=32),
    "ring": shapes.torus(1.0, 0.3, rings=24, segments=12),
    "box": shapes.box((1.0, 0.5, 0.3)),
    "thin plate": THIN,
    "bumps": shapes.bumpy_sphere(800, 0.2),
    "two that overlap": joined(shapes.sphere(rings=12, segments=24), shapes.box((0.6, 0.6, 1.4))),
    "one around another": joined(shapes.box((1.0, 1.0, 1.0)), shapes.sphere(0.3, rings=8, segments=16)),
    "far away": shapes.sphere(1.0, (3e4, -2e4, 1e4), rings=12, segments=24),
    "tiny": shapes.sphere(1e-4, rings=12, segments=24),
    "one point": fw.Mesh([[1, 2, 3]] * 3, [[0, 1, 2]]),
    "inside out": fw.Mesh(shapes.box().vertices, shapes.box().faces[:, ::-1]),
}
OPEN = {
    "one triangle": fw.Mesh(np.eye(3), [[0, 1, 2]]),
    "square": shapes.plane(2.0),
    "soup": soup(0),
    "needle": fw.Mesh([[0, 0, 0], [1, 0, 0], [0.5, 1e-14, 0]], [[0, 1, 2]]),
    "no area": fw.Mesh([[0, 0, 0], [1, 1, 0], [2, 2, 0]], [[0, 1, 2], [0, 0, 1], [1, 1, 1]]),
}


@pytest.mark.parametrize("resolution", [7, 40])
@pytest.mark.parametrize("name", [*CLOSED, *OPEN])
def test_values_are_lower_bounds_of_the_right_sign(name, resolution):
    mesh = (CLOSED | OPEN)[name]
    grid = quietly(mesh, resolution)
    p = points_about(mesh, grid, 1500)
    distance = np.concatenate([true_distance(mesh, part) for part in np.array_split(p, 10)])
    value = grid(p)
    assert grid.closed == (name in CLOSED)
    rounding = 1e-12 * np.abs(p).max()
    assert (np.abs(value) <= distance + rounding).all()
    inside = is_inside(mesh, p) if grid.closed else np.zeros(len(p), bool)
    assert (value[inside] <= rounding).all() and (value[~inside] >= -rounding).all()


@pytest.mark.parametrize("name", [*CLOSED, *OPEN])
def test_values_are_within_the_stated_error_of_the_distance(name):
    mesh = (CLOSED | OPEN)[name]
    grid = quietly(mesh, 40)
    p = points_about(mesh, grid, 1500)
    distance = np.concatenate([true_distance(mesh, part) for part in np.array_split(p, 10)])
    near = distance < 2 * grid.cell
    zero = grid(p) == 0
    assert distance[zero].max(initial=0) <= grid.error + 1e-12
    # Zero up to `error`, and no farther off at two cells.
    assert (distance - np.abs(grid(p)))[near].max() <= grid.error + 1e-12
    assert grid.error <= 1.8 * grid.cell


def test_the_error_at_a_smooth_surface_falls_with_the_square_of_the_cell():
    mesh = shapes.sphere(rings=128, segments=256)
    grids = [sdf.from_mesh(mesh, resolution) for resolution in (16, 32)]
    rng = np.random.default_rng(1)
    d = fw.normalize(rng.normal(size=(4000, 3)))
    p = d * rng.uniform(0.95, 1.05, (4000, 1))
    off = [np.abs(grid(p) - (np.linalg.norm(p, axis=1) - 1)).mean() for grid in grids]
    # The mesh itself lies 1e-4 below the sphere.
    assert off[0] < 0.05 * grids[0].cell and off[1] - 1e-4 < off[0] / 3


def test_a_sphere_trace_hits_a_ball_within_the_stated_error():
    grid = sdf.from_mesh(shapes.sphere(rings=64, segments=128), 32)
    rng = np.random.default_rng(2)
    direction = fw.normalize(rng.normal(size=(2000, 3)))
    origin = 3.0 * direction + 0.4 * rng.normal(size=(2000, 3)) * [1, 0, 0]
    t = np.zeros(len(origin))
    for _ in range(200):
        t += np.maximum(grid(origin - t[:, None] * direction), 0)
    p = origin - t[:, None] * direction
    hit = grid(p) < 1e-5
    b = (origin * direction).sum(1)
    expected = b**2 - (origin**2).sum(1) + 1 > 0
    # Rays that pass the ball within the error may end either way.
    sure = np.abs(np.linalg.norm(origin - b[:, None] * direction, axis=1) - 1) > grid.error
    assert sure.mean() > 0.95
    assert_array_equal(hit[sure], expected[sure])
    assert np.abs(np.linalg.norm(p[hit], axis=1) - 1).max() <= grid.error + 2e-3  # of the mesh, of the hit


def test_gradients_stay_below_the_stated_bound():
    grid = sdf.from_mesh(CLOSED["box"], 24)
    p = points_about(grid.mesh, grid, 20000)
    q = p + 1e-6 * fw.normalize(np.random.default_rng(3).normal(size=p.shape))
    slope = np.abs(grid(p) - grid(q)) / np.linalg.norm(p - q, axis=1)
    assert 1.0 < slope.max() <= grid.lipschitz + 1e-4


def test_a_grid_is_a_node_like_others():
    mesh = CLOSED["box"]
    grid = sdf.from_mesh(mesh, 24)
    axis, angle, offset = (1.0, 2.0, 0.5), 0.7, (0.3, -0.2, 0.9)
    placed = sdf.translate(sdf.rotate(sdf.scale(grid, 1.5), axis, angle), offset)
    scene = sdf.subtraction(sdf.union(placed, sdf.plane((0, 1, 0), -1.0)), sdf.sphere((0.3, 0.3, 0.9), 0.4))
    solid = sdf.scale(sdf.box((0, 0, 0), (1.0, 0.5, 0.3)), 1.5)
    solid = sdf.translate(sdf.rotate(solid, axis, angle), offset)
    truth = sdf.subtraction(sdf.union(solid, sdf.plane((0, 1, 0), -1.0)), sdf.sphere((0.3, 0.3, 0.9), 0.4))
    p = np.random.default_rng(4).uniform(-2, 2, (5, 1000, 3))
    assert scene(p).shape == (5, 1000) and scene.evaluate(p[0, 0]) == scene(p)[0, 0]
    assert np.abs(scene(p) - truth(p)).max() < 1.5 * (grid.error + grid.cell)
    assert (scene(p) <= np.maximum(truth(p), 0) + 1e-9).all()
    assert_array_equal(grid.bounds, ([-1, -0.5, -0.3], [1, 0.5, 0.3]))
    low, high = placed.bounds
    assert (solid.bounds[0] >= low - 1e-9).all() and (solid.bounds[1] <= high + 1e-9).all()
    assert hash(scene) == hash(scene)


def test_outside_the_grid_the_distance_is_right_within_a_tenth():
    grid = sdf.from_mesh(CLOSED["ball"], 16)
    p = np.array([[1e6, 0, 0], [5, 5, 5], [-3, 0, 0.4]])
    truth = np.linalg.norm(p - [0.2, -0.1, 0.4], axis=1) - 1
    assert_allclose(grid(p), [1, 0.95, 1] * truth, rtol=0.055)
    assert np.isnan(grid([np.nan, 0, 0])) and grid([np.inf, 0, 0]) == np.inf


def test_an_open_mesh_is_told_of_once():
    with pytest.warns(UserWarning, match="open, or faces of it are turned over: 3 edges") as caught:
        assert not sdf.from_mesh(OPEN["one triangle"], 8).closed
    assert len(caught) == 1 and caught[0].filename == __file__


def test_duplicate_vertices_do_not_open_a_mesh():
    mesh = shapes.box()
    apart = fw.Mesh(mesh.vertices[mesh.faces.ravel()], np.arange(36).reshape(-1, 3))
    p = np.random.default_rng(5).uniform(-2, 2, (1000, 3))
    assert_array_equal(sdf.from_mesh(apart, 12)(p), sdf.from_mesh(mesh, 12)(p))


def test_one_face_turned_over_makes_the_sign_unreliable():
    faces = shapes.box().faces.copy()
    faces[0] = faces[0, ::-1]
    assert not quietly(fw.Mesh(shapes.box().vertices, faces), 8).closed


@pytest.mark.parametrize("offset", [(0.0, 0.05, 0.0), (0.0, -0.6, 0.3)])
def test_an_updated_grid_equals_one_made_anew(offset):
    still, ball = shapes.box((2.0, 0.2, 1.0)), shapes.sphere(0.3, (-1.4, 0.8, 0.0), rings=12, segments=24)
    post = shapes.box((0.2, 1.2, 0.2), (1.7, 0.0, 0.0))
    old = sdf.from_mesh(joined(still, post, ball), 48)
    mesh = joined(still, post, moved(ball, offset))
    updated = old.updated(mesh)
    fresh = _build(mesh, 48, old.cell, old.arrays()[0][:3], old.arrays()[1].shape, None)
    for one, other in zip(updated.arrays(), fresh.arrays(), strict=True):
        assert_array_equal(one, other)
    assert 0 < updated.sampled < 0.7 * fresh.sampled


def test_an_update_that_leaves_the_box_is_made_anew():
    ball = shapes.sphere(rings=8, segments=16)
    far = sdf.from_mesh(ball, 12).updated(moved(ball, (3.0, 0, 0)))
    p = np.random.default_rng(6).uniform(1, 5, (500, 3))
    assert_array_equal(far(p), sdf.from_mesh(moved(ball, (3.0, 0, 0)), 12)(p))


def test_the_grid_is_the_same_for_any_number_of_threads():
    mesh, threads = shapes.torus(rings=24, segments=12), numba.get_num_threads()
    both = sdf.from_mesh(mesh, 24)
    numba.set_num_threads(1)
    try:
        one = sdf.from_mesh(mesh, 24)
    finally:
        numba.set_num_threads(threads)
    for left, right in zip(both.arrays(), one.arrays(), strict=True):
        assert_array_equal(left, right)


@pytest.mark.parametrize(
    ("mesh", "resolution", "message"),
    [
        (
            fw.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)),
            8,
            "mesh has no triangles; at least one is wanted",
        ),
        (np.zeros((3, 3)), 8, "mesh is a ndarray; a framework.Mesh is wanted"),
        (shapes.box(), 0, "resolution is 0; a whole number of cells from 1 to 1024 is wanted"),
        (shapes.box(), 8.5, "resolution is 8.5; a whole number"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(mesh, resolution, message):
    with pytest.raises(ValueError, match=message):
        sdf.from_mesh(mesh, resolution)
