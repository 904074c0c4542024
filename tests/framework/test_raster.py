"""The rasteriser against rays cast at every triangle in float64, and against what must hold without exception."""

from pathlib import Path

import numba
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework import mesh as shapes

CAMERA = fw.Camera((0.4, 0.7, 3.0), (0.0, 0.0, 0.0), (0, 1, 0), 0.8)
CHANNELS = ("depth", "barycentric", "position", "normal", "uv")


@numba.njit(parallel=True, cache=True, error_model="numpy")
def cast_rays(vertices, faces, origin, direction, near):
    """Nearest face and depth per ray by Moeller-Trumbore on every triangle; the rays (N, 3) have depth 1."""
    count = direction.shape[0]
    triangle, depth = np.full(count, -1), np.full(count, np.inf)
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    for i in numba.prange(count):
        dx, dy, dz = direction[i]
        for f in range(len(faces)):
            ax, ay, az = a[f]
            ux, uy, uz = b[f, 0] - ax, b[f, 1] - ay, b[f, 2] - az
            vx, vy, vz = c[f, 0] - ax, c[f, 1] - ay, c[f, 2] - az
            px, py, pz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
            inverse = 1.0 / (ux * px + uy * py + uz * pz)
            sx, sy, sz = origin[0] - ax, origin[1] - ay, origin[2] - az
            u = (sx * px + sy * py + sz * pz) * inverse
            if not 0 <= u <= 1:
                continue
            qx, qy, qz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
            v = (dx * qx + dy * qy + dz * qz) * inverse
            t = (vx * qx + vy * qy + vz * qz) * inverse
            if v >= 0 and u + v <= 1 and near <= t < depth[i]:
                triangle[i], depth[i] = f, t
    return triangle, depth


def rays(camera, width, height):
    """Rays through pixel centres `(height, width, 3)`, of length 1 along the camera's axis."""
    _, direction = camera.rays(width, height)
    return direction / (direction @ camera.axis)[..., None]


def truth(mesh, camera, width, height, near=0.01):
    direction = rays(camera, width, height).reshape(-1, 3)
    triangle, depth = cast_rays(mesh.vertices, mesh.faces, camera.position, direction, near)
    return triangle.reshape(height, width), depth.reshape(height, width)


def pixels_to_edges(mesh, camera, width, height, face, column, row, near=0.01):
    """Distance in pixels from a pixel's centre to the outline of a face on the image, as far as it is in front."""
    matrix = camera.view_projection(width, height)
    points = np.c_[mesh.vertices[mesh.faces[face]], np.ones(3)] @ matrix.T
    nearest = np.inf
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        if max(a[3], b[3]) < near:
            continue
        if a[3] < near:
            a = a + (near - a[3]) / (b[3] - a[3]) * (b - a)
        if b[3] < near:
            b = b + (near - b[3]) / (a[3] - b[3]) * (a - b)
        a, b = (
            ((p[:2] / p[3]) * [1, -1] + 1) / 2 * [width, height] - [column + 0.5, row + 0.5] for p in (a, b)
        )
        along = b - a
        t = np.clip(-(a @ along) / max(along @ along, 1e-300), 0, 1)
        nearest = min(nearest, np.linalg.norm(a + t * along))
    return nearest


def coverage(mesh, camera, width, height, near=0.01):
    """How many faces that show their front, and their back, cover each pixel: each face is drawn alone."""
    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    count = {"back": np.zeros((height, width), int), "front": np.zeros((height, width), int)}
    for face in mesh.faces:
        alone = fw.Mesh(mesh.vertices[face], [[0, 1, 2]])
        for cull, total in count.items():
            total += fw.rasterize(alone, camera, width, height, near=near, cull=cull).mask
    numba.set_num_threads(threads)
    return count["back"], count["front"]


def teapot():
    return fw.load_mesh(Path(fw.__file__).parent / "data" / "teapot.obj")


def slivers():
    """Long triangles, a hundredth of a pixel to two pixels wide."""
    rng = np.random.default_rng(7)
    centre, along = rng.uniform(-1, 1, (300, 3)), rng.normal(size=(300, 3))
    width = rng.normal(size=(300, 3)) * 10 ** rng.uniform(-4, -2, (300, 1))
    vertices = np.stack([centre - along, centre + along, centre + along + width], 1)
    return fw.Mesh(vertices.reshape(-1, 3), np.arange(900).reshape(-1, 3))


def ground():
    """A floor that runs under the camera to the horizon, and large triangles around it that cut each other."""
    rng = np.random.default_rng(8)
    soup = rng.uniform(-3, 3, (60, 1, 3)) + rng.normal(size=(60, 3, 3))
    a, b, c, d = [-900, -1, -900], [-900, -1, 900], [900, -1, 900], [900, -1, -900]
    corners = np.concatenate([np.array([[a, b, c], [a, c, d]], float), soup])
    return fw.Mesh(corners.reshape(-1, 3), np.arange(186).reshape(-1, 3))


def soup():
    """Small triangles in a thick layer, many deep at each pixel, of either side."""
    rng = np.random.default_rng(9)
    corners = rng.uniform(-1, 1, (3000, 1, 3)) * [1, 1, 0.2] + 0.08 * rng.normal(size=(3000, 3, 3))
    return fw.Mesh(corners.reshape(-1, 3), np.arange(9000).reshape(-1, 3))


SCENES = {
    "bumps": (lambda: shapes.bumpy_sphere(4000), CAMERA),
    "teapot": (teapot, fw.Camera((5, 7, 12), (0, 1.5, 0), (0, 1, 0), 0.9)),
    "ball": (lambda: shapes.shading_ball(40, 48), CAMERA),
    "slivers": (slivers, CAMERA),
    "soup": (soup, CAMERA),
    "ground": (ground, fw.Camera((0.1, 0.2, 0.3), (0.5, -0.1, -1), (0, 1, 0), 1.4)),
    "inside": (
        lambda: shapes.bumpy_sphere(3000, 0.3),
        fw.Camera((0.5, 0.3, 0.6), (0, 0, -1), (0, 1, 0), 2.0),
    ),
}


@pytest.fixture(scope="module", params=SCENES)
def scene(request):
    make, camera = SCENES[request.param]
    return make(), camera


def test_visibility_and_depth_agree_with_rays_cast_at_every_triangle(scene):
    mesh, camera = scene
    size = 256
    gbuffer = fw.rasterize(mesh, camera, size, size)
    triangle, depth = truth(mesh, camera, size, size)
    differ = gbuffer.triangle != triangle
    # Measured: at most 6e-5 of the pixels, on the slivers.
    assert differ.mean() <= 0.002
    both = ~differ & (triangle >= 0)
    # Measured: 5e-12, on the slivers.
    assert np.quantile(np.abs(gbuffer.depth[both] / depth[both] - 1), 0.999) <= 1e-4
    for row, column in np.argwhere(differ):
        seen = {gbuffer.triangle[row, column], triangle[row, column]} - {-1}
        assert min(pixels_to_edges(mesh, camera, size, size, f, column, row) for f in seen) <= 1


@pytest.mark.parametrize("size", [(1, 1), (7, 5), (131, 37), (65, 200)])
def test_visibility_agrees_with_rays_at_odd_sizes(size):
    mesh, camera = shapes.shading_ball(24, 32), CAMERA
    triangle, depth = truth(mesh, camera, *size)
    gbuffer = fw.rasterize(mesh, camera, *size)
    assert (gbuffer.triangle != triangle).mean() <= 0.002
    both = gbuffer.mask & (triangle >= 0)
    assert_allclose(gbuffer.depth[both], depth[both], rtol=1e-6)


def test_every_channel_is_finite_and_describes_the_same_point(scene):
    mesh, camera = scene
    gbuffer = fw.rasterize(mesh, camera, 201, 143)
    mask, direction = gbuffer.mask, rays(camera, 201, 143)
    corners = mesh.vertices[mesh.faces[gbuffer.triangle[mask]]]
    scale = np.abs(mesh.vertices).max()
    assert np.isfinite(gbuffer.depth[mask]).all() and np.isinf(gbuffer.depth[~mask]).all()
    assert (gbuffer.depth[mask] >= 0.01 - 1e-12).all()
    for name in ("barycentric", "position", "normal"):
        assert np.isfinite(getattr(gbuffer, name)).all()
        assert not getattr(gbuffer, name)[~mask].any()
    assert_allclose(gbuffer.barycentric[mask].sum(-1), 1, atol=1e-12)
    assert gbuffer.barycentric.min() >= 0
    assert_allclose(np.linalg.norm(gbuffer.normal[mask], axis=-1), 1, atol=1e-12)
    on_ray = camera.position + gbuffer.depth[mask][:, None] * direction[mask]
    assert_allclose(gbuffer.position[mask], on_ray, atol=1e-9 * scale)
    # Weights are held inside the face where rounding to the grid covers a centre just outside it.
    on_face = np.einsum("nk,nkc->nc", gbuffer.barycentric[mask], corners)
    assert np.quantile(np.abs(on_face - gbuffer.position[mask]).max(-1), 0.999) <= 1e-9 * scale


def test_a_box_of_known_corners_covers_exactly_the_centres_that_the_top_left_rule_gives_it():
    # Its front, 2 away, spans 33 pixels from centre to centre: 33 columns and rows, the last ones left out.
    camera = fw.Camera((0, 0, 3), (0, 0, 0), (0, 1, 0), 2 * np.arctan(32 / 33))
    front, back = coverage(shapes.box(), camera, 64, 64)
    expected = np.zeros((64, 64), int)
    expected[15:48, 15:48] = 1
    assert_array_equal(front, expected)
    assert_array_equal(back, expected)


@pytest.mark.parametrize("seed", range(4))
def test_a_convex_mesh_covers_a_pixel_once_with_each_side_or_not_at_all(seed):
    eye = np.random.default_rng(seed).normal(size=3)
    camera = fw.Camera(3 * eye / np.linalg.norm(eye), (0.1, 0, 0), (0, 1, 0), 0.75)
    for mesh in (shapes.sphere(rings=9, segments=14), shapes.box((0.5, 0.6, 0.7))):
        front, back = coverage(mesh, camera, 61, 61)
        assert_array_equal(front, back)
        assert front.max() == 1 and front.min() == 0


def test_a_closed_mesh_covers_a_pixel_with_as_many_fronts_as_backs():
    for mesh in (shapes.torus(rings=16, segments=10), shapes.bumpy_sphere(400, 0.4, 5.0)):
        front, back = coverage(mesh, CAMERA, 73, 55)
        assert_array_equal(front, back)
        assert front.max() >= 2


def test_from_inside_a_closed_mesh_shows_one_back_more_than_fronts_at_every_pixel():
    # Most faces in view have corners behind the camera or far outside the image.
    camera = fw.Camera((0.05, 0.1, 0.0), (0.3, 0, -1), (0, 1, 0), 2.2)
    for mesh in (shapes.box(), shapes.bumpy_sphere(400, 0.4, 5.0), shapes.box((1e5, 1e5, 1e5))):
        front, back = coverage(mesh, camera, 60, 44, near=1e-3)
        assert_array_equal(back - front, 1)


def test_around_a_corner_at_a_pixels_centre_faces_that_reach_behind_the_camera_share_the_pixels_out():
    camera = fw.Camera((0.3, -0.2, 0.1), (0.1, 0.4, -2), (0, 1, 0), 1.5)
    for row, column in np.random.default_rng(6).integers(0, 35, (25, 2)):
        apex = camera.position + 1.7 * rays(camera, 47, 35)[row, column]
        around = np.linspace(0, 2 * np.pi, 9, endpoint=False) + 0.1
        ring = camera.position + np.c_[3 * np.cos(around), 3 * np.sin(around), np.full(9, 0.3)]
        faces = [[0, 1 + k, 1 + (k + 1) % 9] for k in range(9)]
        front, back = coverage(fw.Mesh(np.vstack([apex, ring]), faces), camera, 47, 35)
        assert_array_equal(front + back, 1)


def test_triangles_of_a_ten_thousandth_of_a_pixel_leave_no_hole():
    # 90000 away the whole sphere is 0.007 pixels wide; the axis goes through the centre of the middle pixel.
    mesh, camera = shapes.bumpy_sphere(1000), fw.Camera((0, 0, 90000), (0, 0, 0), (0, 1, 0), 0.8)
    front, back = coverage(mesh, camera, 65, 65)
    expected = np.zeros((65, 65), int)
    expected[32, 32] = 1
    assert_array_equal(front, expected)
    assert_array_equal(back, expected)
    gbuffer = fw.rasterize(mesh, camera, 65, 65)
    assert_array_equal(gbuffer.mask, expected == 1)
    assert_allclose(gbuffer.depth[32, 32], 90000 - 1, atol=0.1)
    assert_allclose(np.linalg.norm(gbuffer.normal[32, 32]), 1)


def test_moving_the_scene_by_100000_changes_nothing_to_speak_of():
    mesh, far = shapes.bumpy_sphere(20000), np.array([1e5, -1e5, 1e5])
    moved = fw.Mesh(mesh.vertices + far, mesh.faces, mesh.normals)
    here = fw.rasterize(mesh, CAMERA, 256, 256)
    there = fw.rasterize(moved, fw.Camera(CAMERA.position + far, far, (0, 1, 0), 0.8), 256, 256)
    same = (here.triangle == there.triangle) & here.mask
    assert (here.triangle != there.triangle).mean() <= 1e-3
    assert_allclose(there.depth[same], here.depth[same], rtol=1e-7)
    assert_allclose(there.normal[same], here.normal[same], atol=1e-6)


@pytest.mark.parametrize("scale", [1e-3, 1e5])
def test_scaling_the_scene_scales_the_depth(scale):
    mesh = shapes.bumpy_sphere(5000)
    camera = fw.Camera(scale * CAMERA.position, (0, 0, 0), (0, 1, 0), 0.8)
    here = fw.rasterize(mesh, CAMERA, 128, 128)
    there = fw.rasterize(fw.Mesh(scale * mesh.vertices, mesh.faces), camera, 128, 128, near=0.01 * scale)
    same = (here.triangle == there.triangle) & here.mask
    assert (here.triangle != there.triangle).mean() <= 1e-3
    assert_allclose(there.depth[same], scale * here.depth[same], rtol=1e-9)


def test_attributes_are_interpolated_in_space_not_on_the_image():
    # A floor seen at a low angle that runs behind the camera: its uv is known from the point seen.
    mesh, camera = shapes.plane(200.0), fw.Camera((0.3, 0.5, 0.1), (0, 0.3, -1), (0, 1, 0), 1.2)
    gbuffer = fw.rasterize(mesh, camera, 120, 80)
    mask, direction = gbuffer.mask, rays(camera, 120, 80)
    assert_array_equal(mask, direction[..., 1] < -0.5 / 99.9)
    depth = -0.5 / direction[mask][:, 1]
    point = camera.position + depth[:, None] * direction[mask]
    assert_allclose(gbuffer.depth[mask], depth, rtol=1e-9)
    assert_allclose(gbuffer.uv[mask], np.c_[0.5 + point[:, 0] / 200, 0.5 - point[:, 2] / 200], atol=1e-9)
    assert_allclose(gbuffer.normal[mask], np.tile([0.0, 1.0, 0.0], (mask.sum(), 1)), atol=1e-12)
    assert not gbuffer.uv[~mask].any()


def test_the_near_plane_cuts_where_it_is():
    # The slope y + z = 0 rises away from the camera, which looks along it from 1 above its foot and meets it
    # at (0, 1, 0) + t (x, y, -1) with t = 1 / (1 - y): nearer than 1 in the lower half of the image.
    mesh = fw.Mesh([[-500, -9, 9], [500, -9, 9], [0, 500, -500]], [[0, 1, 2]])
    camera = fw.Camera((0, 1, 0), (0, 1, -1), (0, 1, 0), np.pi / 2)
    depth = 1 / (1 - rays(camera, 50, 50)[..., 1])
    gbuffer = fw.rasterize(mesh, camera, 50, 50, near=1.0)
    assert_array_equal(gbuffer.mask, depth >= 1)
    assert_allclose(gbuffer.depth[gbuffer.mask], depth[gbuffer.mask], rtol=1e-9)


def test_rows_run_down_and_columns_to_the_right():
    mesh = shapes.sphere(0.2, (0.6, 0.5, 0))
    mask = fw.rasterize(mesh, fw.Camera((0, 0, 3), (0, 0, 0), (0, 1, 0), 0.8), 90, 60).mask
    rows, columns = np.nonzero(mask)
    assert rows.size and rows.max() < 30 and columns.min() > 45


def test_a_face_normal_is_on_the_side_that_the_winding_says():
    camera = fw.Camera((0, 3, 0.1), (0, 0, 0), (0, 1, 0), 0.3)
    up = fw.Mesh([[-1, 0, 1], [1, 0, 1], [0, 0, -1]], [[0, 1, 2]])
    down = fw.Mesh(up.vertices, [[0, 2, 1]])
    assert_allclose(fw.rasterize(up, camera, 3, 3).normal[1, 1], [0, 1, 0], atol=1e-12)
    assert_allclose(fw.rasterize(down, camera, 3, 3).normal[1, 1], [0, -1, 0], atol=1e-12)


def test_both_sides_are_drawn_unless_one_is_culled():
    up = fw.Mesh([[-1, 0, 1], [1, 0, 1], [0, 0, -1]], [[0, 1, 2]])
    above, below = (fw.Camera((0, y, 0.1), (0, 0, 0), (0, 1, 0), 0.3) for y in (3, -3))
    drawn = {
        cull: [fw.rasterize(up, c, 3, 3, cull=cull).mask.all() for c in (above, below)]
        for cull in (None, "back", "front")
    }
    assert drawn == {None: [True, True], "back": [True, False], "front": [False, True]}


def test_vertex_normals_of_length_zero_give_way_to_the_face():
    mesh = fw.Mesh([[-9, -9, 0], [9, -9, 0], [0, 9, 0]], [[0, 1, 2]], normals=np.zeros((3, 3)))
    normal = fw.rasterize(mesh, CAMERA, 5, 5).normal
    assert_allclose(normal, np.broadcast_to([0.0, 0.0, 1.0], (5, 5, 3)), atol=1e-12)


def test_of_equal_depths_the_first_face_is_seen():
    mesh = fw.Mesh([[-9, -9, 0], [9, -9, 0], [0, 9, 0]], [[0, 2, 1], [0, 1, 2], [1, 2, 0]])
    assert_array_equal(fw.rasterize(mesh, CAMERA, 8, 8).triangle, 0)


@pytest.mark.parametrize(
    "faces",
    [
        pytest.param([], id="empty"),
        pytest.param([[0, 0, 1], [1, 1, 1], [2, 1, 2]], id="repeated corners"),
        pytest.param([[0, 3, 6], [6, 3, 0]], id="behind the camera"),
        pytest.param([[4, 4, 5], [4, 5, 7]], id="on one line, or one point"),
    ],
)
def test_what_cannot_be_seen_leaves_an_empty_image(faces):
    vertices = [
        [0, 0, 9],
        [1, 0, 0],
        [0, 1, 0],
        [1, 1, 20],
        [0.5, 0.5, 0],
        [0, 0, 0],
        [0, 5, 9],
        [0.25, 0.25, 0],
    ]
    gbuffer = fw.rasterize(fw.Mesh(vertices, faces), CAMERA, 31, 17)
    assert not gbuffer.mask.any() and (gbuffer.triangle == -1).all() and np.isinf(gbuffer.depth).all()
    assert not gbuffer.position.any() and not gbuffer.normal.any() and not gbuffer.barycentric.any()
    assert gbuffer.uv is None


def test_an_empty_mesh_leaves_an_empty_image():
    gbuffer = fw.rasterize(fw.Mesh([], []), CAMERA, 5, 4, channels=CHANNELS)
    assert not gbuffer.mask.any() and gbuffer.position.shape == (4, 5, 3)


def test_a_channel_is_computed_when_it_is_read_and_the_same_in_one_pass():
    mesh = shapes.plane()
    lazy, eager = fw.rasterize(mesh, CAMERA, 40, 30), fw.rasterize(mesh, CAMERA, 40, 30, channels=CHANNELS)
    assert not set(CHANNELS) & set(vars(lazy)) and set(CHANNELS) <= set(vars(eager))
    for name in CHANNELS:
        assert_array_equal(getattr(lazy, name), getattr(eager, name))


def test_the_number_of_threads_changes_nothing():
    mesh, threads = shapes.bumpy_sphere(5000), numba.get_num_threads()
    many = fw.rasterize(mesh, CAMERA, 100, 100)
    many.depth  # noqa: B018
    numba.set_num_threads(1)
    one = fw.rasterize(mesh, CAMERA, 100, 100)
    assert_array_equal(one.triangle, many.triangle)
    assert_array_equal(one.depth, many.depth)
    numba.set_num_threads(threads)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"cull": "both"}, "cull is 'both'"),
        ({"near": 0.0}, "near is 0"),
        ({"channels": ("colour",)}, "channels holds 'colour'"),
        ({"width": 10000}, "10000 x 20"),
        ({"height": 0}, "height is 0"),
        ({"height": 2.5}, "height is 2.5"),
    ],
)
def test_a_wrong_argument_is_named(change, message):
    arguments = {"mesh": shapes.box(), "camera": CAMERA, "width": 30, "height": 20} | change
    with pytest.raises(ValueError, match=message):
        fw.rasterize(**arguments)
