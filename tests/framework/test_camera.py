import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw


def random_camera(seed):
    rng = np.random.default_rng(seed)
    return fw.Camera(rng.normal(size=3) * 5, rng.normal(size=3), rng.normal(size=3), rng.uniform(0.2, 2.8))


def project(camera, points, width, height):
    clip = np.concatenate([points, np.ones_like(points[..., :1])], axis=-1)
    clip = clip @ camera.view_projection(width, height).T
    return clip[..., :3] / clip[..., 3:], clip[..., 3]


def test_a_camera_on_the_z_axis_sees_x_to_the_right_and_y_up():
    # fov 90 degrees: the image plane at depth 1 is 2 high and 4 wide, pixels are 1 by 1.
    origin, direction = fw.Camera([0, 0, 5], [0, 0, 0], [0, 1, 0], np.pi / 2).rays(4, 2)
    expected = np.array([[[x, y, -1] for x in (-1.5, -0.5, 0.5, 1.5)] for y in (0.5, -0.5)])
    assert_allclose(direction, expected / np.linalg.norm(expected, axis=-1, keepdims=True), rtol=1e-15)
    assert_array_equal(origin, np.broadcast_to([0, 0, 5], (2, 4, 3)))


def test_the_ray_through_an_odd_image_s_middle_is_the_axis():
    camera = random_camera(3)
    _, direction = camera.rays(7, 5)
    assert_allclose(direction[2, 3], camera.axis, atol=1e-15)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("width", "height"), [(1, 1), (7, 5), (3, 16)])
def test_points_on_rays_project_to_their_pixel_s_centre(seed, width, height):
    camera = random_camera(seed)
    origin, direction = camera.rays(width, height)
    distance = np.random.default_rng(seed).uniform(0.1, 100, (height, width, 1))
    ndc, depth = project(camera, origin + distance * direction, width, height)
    column, row = np.meshgrid(np.arange(width), np.arange(height))
    assert_allclose((ndc[..., 0] + 1) / 2 * width - 0.5, column, atol=1e-9)
    assert_allclose((1 - ndc[..., 1]) / 2 * height - 0.5, row, atol=1e-9)
    assert_allclose(depth, distance[..., 0] * (direction @ camera.axis), rtol=1e-12)


def test_clip_depth_runs_from_minus_one_at_the_near_plane_to_one_at_infinity():
    camera = fw.Camera([0, 0, 0], [0, 0, -1], [0, 1, 0], 1.0)
    ndc, _ = project(camera, np.array([[0, 0, -0.01], [0, 0, -1e12]]), 8, 8)
    assert_allclose(ndc[:, 2], [-1, 1], atol=1e-10)
    near, _ = project(camera, np.array([[0, 0, -0.5]]), 8, 8)
    clip = camera.view_projection(8, 8, near=0.5) @ [0, 0, -0.5, 1]
    assert near[0, 2] > -1 and clip[2] == -clip[3]


@pytest.mark.parametrize("size", [1e-4, 1.0, 1e5])
def test_rays_do_not_depend_on_the_scene_s_scale(size):
    expected = fw.Camera([1, 2, 3], [0, 1, 0], [0, 1, 0], 1.0).rays(4, 3)[1]
    scaled = fw.Camera([1 * size, 2 * size, 3 * size], [0, size, 0], [0, size, 0], 1.0).rays(4, 3)[1]
    assert_allclose(scaled, expected, atol=1e-14)


def test_the_basis_is_a_rotation_with_the_axis_backwards():
    camera = random_camera(9)
    assert_allclose(camera.basis @ camera.basis.T, np.eye(3), atol=1e-15)
    assert_allclose(np.linalg.det(camera.basis), 1)
    assert_array_equal(camera.basis[2], -camera.axis)
    assert camera.basis[1] @ camera.up > 0


def test_a_camera_keeps_its_own_copy_and_cannot_change():
    position = np.array([0.0, 0, 5])
    camera = fw.Camera(position, [0, 0, 0], [0, 1, 0], 1.0)
    position[:] = 7
    assert_array_equal(camera.position, [0, 0, 5])
    with pytest.raises(ValueError):
        camera.position[0] = 1
    origin, _ = camera.rays(2, 2)
    origin += 1  # results are the caller's own
    assert_array_equal(camera.position, [0, 0, 5])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"target": [0, 0, 5]}, "target equals position"),
        ({"up": [0, 0, 2]}, "along the line of sight"),
        ({"up": [0, 0, 0]}, "up is"),
        ({"up": [0, 1]}, "up has shape"),
        ({"position": [0, np.nan, 0]}, "position holds 1 values that are NaN"),
        ({"fov_y": 0}, "fov_y is 0"),
        ({"fov_y": 60}, "fov_y is 60; an angle between 0 and pi, in radians, is wanted"),
    ],
)
def test_degenerate_cameras_are_refused(change, words):
    good = {"position": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 1.0}
    with pytest.raises(ValueError, match=words):
        fw.Camera(**{**good, **change})


@pytest.mark.parametrize("size", [(0, 4), (4, -1), (4.0, 4), ("4", 4)])
def test_image_sizes_must_be_whole_numbers_of_pixels(size):
    with pytest.raises(ValueError, match="whole number of pixels"):
        fw.Camera([0, 0, 5], [0, 0, 0], [0, 1, 0], 1.0).rays(*size)
