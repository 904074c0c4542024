"""Environments: look-up, orientation, solid angles, cubes, the light file."""

import re
import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

import framework as fw
from framework.lookup import _bilinear

RNG = np.random.default_rng(5)
SKY = fw.Environment(fw.skies.gradient(16).pixels * (1 + RNG.random((16, 32, 1))))


def directions(count, seed=0):
    v = np.random.default_rng(seed).normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


@pytest.mark.parametrize("height", [1, 2, 7, 64])
def test_solid_angles_fill_the_sphere(height):
    solid = fw.skies.constant(height).solid_angles()
    assert solid.shape == (height, 2 * height)
    assert_allclose(solid.sum(), 4 * np.pi, rtol=1e-13)
    assert_allclose(solid[0, 0], (1 - np.cos(np.pi / height)) * np.pi / height, rtol=1e-9)


def test_pixel_centres_look_where_the_contract_says():
    theta, phi = np.pi * 3.5 / 16, 2 * np.pi * 9.5 / 32
    want = [np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)]
    assert_allclose(SKY.directions()[3, 9], want, atol=1e-15)


def test_a_look_up_at_a_pixel_centre_is_the_pixel():
    assert_allclose(SKY.radiance(SKY.directions()), SKY.pixels, rtol=1e-12)


def test_a_look_up_between_four_centres_is_their_mean():
    theta, phi = np.pi * 4 / 16, 2 * np.pi * 5 / 32
    d = [np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)]
    assert_allclose(SKY.radiance(d), SKY.pixels[3:5, 4:6].mean(axis=(0, 1)), rtol=1e-12)


def test_over_the_pole_the_map_goes_on_half_a_turn_further():
    noisy = fw.Environment(RNG.random((8, 16, 3)))
    for pole in (1.0, -1.0):
        row = 0 if pole > 0 else -1
        mean = 0.5 * (noisy.pixels[row] + np.roll(noisy.pixels[row], 8, axis=0))
        phi = 2 * np.pi * (np.arange(16) + 0.5) / 16
        d = np.stack([1e-9 * np.sin(phi), np.full(16, pole), -1e-9 * np.cos(phi)], axis=1)
        assert_allclose(noisy.radiance(d), mean, rtol=1e-7)


@pytest.mark.parametrize("axis", ["seam", "pole"])
def test_steps_across_seam_and_poles_are_no_larger_than_inside(axis):
    t = np.linspace(-0.2, 0.2, 4000)  # not the pole itself: its value depends on where one comes from
    shift = np.linspace(0, np.pi, 7)[1:-1, None]
    if axis == "seam":  # along parallels, through phi = 0
        d = np.stack(
            np.broadcast_arrays(np.sin(shift) * np.sin(t), np.cos(shift), -np.sin(shift) * np.cos(t)), -1
        )
        inside = np.stack([-d[..., 0], d[..., 1], -d[..., 2]], -1)
    else:  # along meridians, over +y
        d = np.stack(np.broadcast_arrays(np.sin(t) * np.cos(shift), np.cos(t), np.sin(t) * np.sin(shift)), -1)
        inside = d[..., [1, 0, 2]]
    steps = np.abs(np.diff(SKY.radiance(d), axis=1)).max()
    assert steps <= 1.5 * np.abs(np.diff(SKY.radiance(inside), axis=1)).max() + 1e-12
    assert np.abs(np.diff(SKY.radiance(d), axis=1)).max() < 0.02


def test_the_compiled_look_up_equals_the_numpy_one():
    from framework.lookup_kernel import bilinear

    d = np.concatenate(
        [directions(5000) * RNG.uniform(1e-3, 1e3, (5000, 1)), np.eye(3), -np.eye(3), np.zeros((1, 3))]
    )
    assert_allclose(bilinear(SKY.pixels, d), _bilinear(SKY.pixels, d), rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("shape", [(3,), (0, 3), (2, 4, 3)])
def test_look_ups_keep_any_leading_shape(shape):
    assert SKY.radiance(np.ones(shape)).shape == shape


def test_a_constant_environment_is_the_same_everywhere():
    assert_allclose(fw.skies.constant(5, 0.7).radiance(directions(1000)), 0.7, rtol=1e-14)


def test_a_direction_of_no_length_is_black_and_its_length_does_not_count():
    assert_allclose(SKY.radiance([[0, 0, 0]]), 0)
    assert_allclose(SKY.radiance(1e-200 * directions(50)), SKY.radiance(directions(50)), rtol=1e-9)


def test_negative_pixels_are_set_to_zero_with_one_warning_that_counts():
    pixels = np.ones((4, 8, 3))
    pixels[0, :3, 0] = -3394
    with pytest.warns(UserWarning, match="3 negative") as said:
        env = fw.Environment(pixels)
    assert len(said) == 1 and env.pixels.min() == 0 and pixels.min() == -3394


def test_pixels_that_are_not_finite_are_refused_unless_asked():
    pixels = np.ones((4, 8, 3))
    pixels[1, 2, 0], pixels[3, 3, 1] = np.nan, np.inf
    with pytest.raises(ValueError, match=r"2 of 96 values are not finite.*at \[1, 2, 0\]"):
        fw.Environment(pixels)
    with pytest.warns(UserWarning, match="2 not finite"):
        assert fw.Environment(pixels, on_bad_pixels="zero").pixels[1, 2, 0] == 0


@pytest.mark.parametrize(
    "pixels", [np.ones((4, 4, 3)), np.ones((4, 8)), np.ones((0, 0, 3)), np.full((1, 2, 3), "a")]
)
def test_other_shapes_and_kinds_are_refused_in_a_sentence(pixels):
    with pytest.raises(ValueError, match="want"):
        fw.Environment(pixels)


def test_the_mip_pyramid_loses_no_light():
    env = fw.skies.sun_and_sky(37)
    total = np.sum(env.pixels * env.solid_angles()[..., None], axis=(0, 1))
    mips = env.mips()
    assert [m.height for m in mips] == [37, 18, 9, 4, 2, 1]
    for mip in mips:
        assert_allclose(np.sum(mip.pixels * mip.solid_angles()[..., None], axis=(0, 1)), total, rtol=1e-12)


def openexr_latlong(direction):
    """OpenEXR's documentation of latlong maps: latitude pi/2 at the top, longitude pi at the left, 0 towards +z."""
    latitude = np.arcsin(direction[1])
    longitude = np.arctan2(direction[0], direction[2])
    return 0.5 - longitude / (2 * np.pi), 0.5 - latitude / np.pi


def openexr_face(direction):
    """OpenEXR's documentation of cube maps: which face, and its columns and rows from -1 to 1, seen from inside."""
    x, y, z = direction
    axis = int(np.argmax(np.abs(direction)))
    face = 2 * axis + (direction[axis] < 0)
    size = abs(direction[axis])
    column = {0: z, 1: -z, 2: x, 3: x, 4: -x, 5: x}[face] / size
    row = {0: -y, 1: -y, 2: -z, 3: z, 4: -y, 5: -y}[face] / size
    return face, column, row


def nearest(color, marks):
    return min(marks, key=lambda name: np.abs(marks[name][1] - color).sum())


def near(direction):
    """A direction within the disc of a mark, but off its letters."""
    side = np.cross(direction, [0.3, 0.8, -0.5])
    return fw.normalize(direction + 0.3 * fw.normalize(side))


def test_axes_and_corners_stand_where_openexr_defines_them(tmp_path):
    marks = fw.skies.orientation_marks()
    assert len(marks) == 14
    path = tmp_path / "orientation.exr"
    fw.write_image(path, fw.skies.orientation(256).pixels, attributes={"envmap": "latlong"})
    image = fw.read_image(path)
    for name, (direction, _) in marks.items():
        u, v = openexr_latlong(near(direction))
        assert nearest(image[int(v * 256), int(u * 512) % 512], marks) == name
        assert nearest(fw.Environment.load(path).radiance(near(direction)), marks) == name


def test_cube_faces_stand_where_openexr_defines_them():
    marks = fw.skies.orientation_marks()
    faces = fw.skies.orientation(256).to_cube(64)
    for name, (direction, _) in marks.items():
        face, column, row = openexr_face(near(direction))
        color = faces[face, int((row + 1) * 32), int((column + 1) * 32)]
        assert nearest(color, marks) == name


def test_a_cube_pixel_is_the_mean_over_its_solid_angle():
    """Over the face +y the mean of y is the square's form factor, 4 atan(1 / sqrt 2) / sqrt 2, by 2 pi / 3."""
    env = fw.Environment(1 + fw.skies.constant(64).directions()[..., 1:2] * np.ones(3))
    mean = 4 * np.arctan(1 / np.sqrt(2)) / np.sqrt(2) / (2 * np.pi / 3)
    assert_allclose(env.to_cube(1)[[2, 3], 0, 0, 0], [1 + mean, 1 - mean], atol=1e-3)


def test_a_cube_file_is_read_as_the_same_environment(tmp_path):
    d = fw.skies.constant(64).directions()
    env = fw.Environment(0.5 + 0.2 * d)
    faces = env.to_cube(64)
    fw.write_image(tmp_path / "cube.exr", faces.reshape(-1, 64, 3), attributes={"envmap": "cube"})
    loaded = fw.Environment.load(tmp_path / "cube.exr")
    assert_allclose(loaded.radiance(directions(2000)), env.radiance(directions(2000)), atol=1e-2)


@pytest.mark.parametrize("env", [fw.skies.sun_and_sky(64, angular_radius=0.1), fw.skies.studio(64), SKY])
def test_map_to_cube_to_map_keeps_the_energy(env):
    back = fw.Environment.from_cube(env.to_cube(64))
    total, kept = (np.sum(e.pixels * e.solid_angles()[..., None], axis=(0, 1)) for e in (env, back))
    assert_allclose(kept, total, rtol=1e-3)


def test_map_to_cube_to_map_keeps_a_smooth_map_everywhere():
    d = fw.skies.constant(64).directions()
    smooth = fw.Environment(0.5 + 0.2 * d + 0.2 * d[..., [1, 2, 0]] * d)
    back = fw.Environment.from_cube(smooth.to_cube(32))
    assert back.height == 64
    assert_allclose(back.pixels, smooth.pixels, atol=1e-2 * smooth.pixels.max())


def light():
    chain = [fw.skies.gradient(h).pixels for h in (16, 8, 4)]
    return fw.EnvironmentLight(
        SKY, fw.skies.gradient(8).pixels, chain, [0.0, 0.5, 1.0], RNG.random((16, 16, 2))
    )


def test_a_light_file_is_the_same_bytes_and_gives_the_same_light(tmp_path):
    one = light()
    one.save(tmp_path / "a.npz")
    again = fw.EnvironmentLight.load(tmp_path / "a.npz")
    again.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    d = directions(100)
    assert_allclose(again.irradiance(d), one.irradiance(d), rtol=1e-6)
    assert_allclose(again.prefiltered(d, 0.3), one.prefiltered(d, 0.3), rtol=1e-6)
    assert_allclose(again.lut, one.lut, rtol=1e-6)


def test_a_light_interpolates_between_levels_and_stops_at_the_ends():
    one, d = light(), directions(50)
    a, b, c = (fw.Environment(fw.skies.gradient(h).pixels).radiance(d) for h in (16, 8, 4))
    assert_allclose(one.prefiltered(d, 0.25), 0.5 * (a + b), rtol=1e-12)
    assert_allclose(one.prefiltered(d, np.full(50, 0.75)), 0.5 * (b + c), rtol=1e-12)
    assert_allclose(one.prefiltered(d, 2.0), c, rtol=1e-12)
    assert_allclose(one.prefiltered(d, -1.0), a, rtol=1e-12)


def test_a_damaged_light_file_is_refused_by_name(tmp_path):
    path = tmp_path / "light.npz"
    light().save(path)
    whole = path.read_bytes()
    rng = np.random.default_rng(2)
    for i in range(60):
        block = bytearray(whole[: rng.integers(len(whole))] if i % 2 else whole)
        for place in rng.integers(
            -400, 300, 4 * (1 - i % 2)
        ):  # the first header, and the directory at the end
            block[place] = rng.integers(256)
        path.write_bytes(block)
        try:
            fw.EnvironmentLight.load(path)
        except ValueError as error:
            assert re.match(re.escape(str(path)) + r"[^\n]+$", str(error))
        else:
            assert i % 2 == 0


def test_the_real_map_loads_with_its_negative_pixels_counted():
    from pathlib import Path

    path = Path(fw.__file__).parent / "data" / "sky_512x256.exr"
    with pytest.warns(UserWarning, match="negative"):
        env = fw.Environment.load(path)
    assert env.pixels.shape == (256, 512, 3) and env.pixels.max() > 20000
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert fw.read_image(path).min() < -3000
