import numpy as np
import pytest

import framework as fw
from framework import sdf
from framework.plan import LADDER

CAMERA = fw.Camera((0, 0, 4), (0, 0, 0), (0, 1, 0), 0.8)
BALL = fw.mesh.sphere(rings=6, segments=8)
MIRROR = fw.Material(1, 0, 0)
MATT = fw.Material(0, 0.5, 0.5)
SKY = fw.skies.gradient(16)
LAMP = fw.Light((0, 1, 0), 10, 8)


def scene(*materials, shape=BALL, casts=False, **rest):
    objects = [fw.SceneObject(shape, material, casts) for material in materials]
    return fw.Scene(CAMERA, objects, **{"environment": SKY, **rest})


def done(plan):
    return {name for name, item in plan.passes.items() if item.done}


def test_a_perfect_mirror_needs_nothing_but_normals_and_the_environment():
    plan = fw.plan_scene(scene(MIRROR), 8, 8)
    assert done(plan) == {"meshes", "channels", "mirror of the sky", "background"}
    assert plan.channels == ("normal",) and not plan.levels


def test_a_matt_surface_needs_the_irradiance_alone():
    plan = fw.plan_scene(scene(MATT), 8, 8)
    assert done(plan) == {"meshes", "channels", "irradiance", "matt under the sky", "background"}


def test_a_rough_mirror_needs_the_levels_around_its_roughness_and_the_table():
    plan = fw.plan_scene(scene(fw.Material(0.5, 0.25), fw.Material(0.5, 0.8), MIRROR), 8, 8)
    assert list(plan.levels) == [0.2, 0.3, 0.8]
    assert {"filtered maps", "table"} <= done(plan) and not plan.irradiance
    assert list(fw.plan_scene(scene(fw.Material(0.5, 0.05)), 8, 8).levels) == [0.0, 0.1]
    assert list(fw.plan_scene(scene(fw.Material(0.5, 1.0)), 8, 8).levels) == [1.0]


def test_no_map_has_more_rows_than_the_environment():
    plan = fw.plan_scene(scene(fw.Material(0.5, 0.15)), 8, 8)
    assert plan.levels == {0.1: 16, 0.2: 16}
    plan = fw.plan_scene(scene(fw.Material(0.5, 0.5), environment=fw.skies.constant(100)), 8, 8)
    assert plan.levels == {0.5: LADDER[0.5]}


def test_a_light_that_comes_filtered_is_not_filtered_again():
    pixels, black = SKY.pixels, np.zeros((4, 4, 2))
    light = fw.EnvironmentLight(SKY, pixels, [pixels], [0.0], black)
    plan = fw.plan_scene(scene(fw.Material(0.5, 0.25, 0.5), environment=light), 8, 8)
    assert done(plan) == {"meshes", "channels", "matt under the sky", "mirror of the sky", "background"}
    assert plan["filtered maps"].why == "come with the light"


def test_shadows_are_planned_where_something_casts_and_something_shines():
    assert "shadow 0" not in done(fw.plan_scene(scene(MATT, lights=[LAMP]), 8, 8))
    plan = fw.plan_scene(scene(MATT, lights=[LAMP], casts=sdf.sphere((0, 0, 0), 1)), 8, 8)
    assert {"light 0", "shadow 0"} <= done(plan) and "grids" not in done(plan)
    assert plan.channels == ("depth", "normal")
    plan = fw.plan_scene(scene(MATT, lights=[fw.Light((0, 1, 0), 0)], casts=True), 8, 8)
    assert not done(plan) & {"light 0", "shadow 0", "grids"}
    assert "grids" in done(fw.plan_scene(scene(MATT, lights=[LAMP], casts=True), 8, 8))


def test_environment_shadows_are_planned_for_what_they_can_change():
    field = sdf.sphere((0, 0, 0), 1)
    for kind, material, wanted in (
        ("none", MATT, False),
        ("ambient", MATT, True),
        ("ambient", MIRROR, False),
        ("full", MIRROR, True),
    ):
        plan = fw.plan_scene(scene(material, shape=field, casts=True, environment_shadows=kind), 8, 8)
        assert ("environment shadows" in done(plan)) == wanted
    plan = fw.plan_scene(scene(MATT, environment_shadows="full"), 8, 8)
    assert "environment shadows" not in done(plan)


def test_everything_leaves_nothing_out():
    plan = fw.plan_scene(scene(MIRROR, lights=[LAMP], casts=True), 8, 8, everything=True)
    assert set(plan.passes) - done(plan) == {"fields", "environment shadows", "matt under the sky"}
    assert list(plan.levels) == [0.0, *LADDER]
    assert plan.channels == ("depth", "barycentric", "position", "normal", "uv")


def test_a_box_that_is_left_out_holds_no_point_in_the_view():
    rng = np.random.default_rng(0)
    camera = fw.Camera((0.5, 0.2, 3), (0, 0.4, 0), (0.2, 1, 0), 0.7)
    matrix = camera.view_projection(3, 2)
    left_out = kept = 0
    for _ in range(400):
        middle, half = rng.uniform(-5, 5, 3), rng.uniform(0.05, 1.0, 3)
        box = fw.SceneObject(fw.mesh.box(half, middle))
        plan = fw.plan_scene(fw.Scene(camera, [box]), 3, 2)
        inside = middle + rng.uniform(-1, 1, (200, 3)) * half
        clip = np.c_[inside, np.ones(200)] @ matrix.T
        seen = (np.abs(clip[:, :2]) < clip[:, 3:]).all(axis=1)
        assert plan.drawn or not seen.any()
        left_out, kept = left_out + (not plan.drawn), kept + bool(seen.any())
    assert left_out > 200 and kept > 50  # of about 90 % that lie beside the view, most are recognised


def test_a_field_without_end_is_always_drawn_and_a_mesh_without_faces_never():
    plan = fw.plan_scene(scene(MATT, shape=sdf.plane((0, 1, 0), -100)), 8, 8)
    assert plan.drawn == (0,)
    plan = fw.plan_scene(scene(MATT, shape=fw.Mesh([[0, 0, 0]], [])), 8, 8)
    assert plan.drawn == ()


def test_a_plan_prints_a_line_for_each_pass_with_its_reason():
    plan = fw.plan_scene(scene(MIRROR, lights=[LAMP]), 640, 480)
    lines = str(plan).splitlines()
    assert lines[0] == "640 x 480 pixels" and len(lines) == 2 + len(plan.passes)
    assert any(line.startswith("table") and "skipped" in line and "perfect mirror" in line for line in lines)
    plan.count("table", 0, 4096)
    plan.count("meshes", 60, 84)
    assert any(line.startswith("table") and "4,096" in line for line in str(plan).splitlines())
    assert any(
        "in part" in line and "60 triangles" in line and "24" in line for line in str(plan).splitlines()
    )


@pytest.mark.parametrize("size", [0, -3, 2.5, "8"])
def test_a_size_that_is_none_is_refused(size):
    with pytest.raises(ValueError, match="plan_scene: width is .*; a whole number of pixels"):
        fw.plan_scene(scene(MATT), size, 8)
