import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework import render, sdf
from framework.render_bounds import Bounds
from framework.render_cache import Cache
from framework.scene_file import EXAMPLES
from solutions import environment_shadows, prefilter, soft_shadows, sphere_tracing, split_sum

FUNCTIONS = [sphere_tracing, soft_shadows, prefilter, split_sum, environment_shadows]
CAMERA = fw.Camera((0, 3, 0), (0, 0, 0), (0, 0, -1), 0.8)
FLOOR = fw.mesh.plane(20.0)
GREY = fw.Material(0, 0.5, (0.2, 0.4, 0.6))
CONSTANT = fw.skies.constant(8, (1.0, 2.0, 3.0))
LAMP = fw.Light((1, 2, -1), (10, 20, 30), 8)


def picture(scene, width=24, height=16, functions=FUNCTIONS, **keys):
    return fw.render_scene(scene, width, height, functions, samples=32, **keys)


def one(shape, material, **rest):
    return fw.Scene(CAMERA, [fw.SceneObject(shape, material, rest.pop("casts", False))], **rest)


@pytest.fixture(autouse=True)
def nothing_kept():
    render._CACHE.clear()


# What the picture must be


def test_a_matt_surface_under_an_even_sky_has_the_radiance_of_its_albedo():
    image, _ = picture(one(FLOOR, GREY, environment=CONSTANT))
    assert_allclose(image, np.broadcast_to([0.2, 0.8, 1.8], image.shape), rtol=1e-12)


def test_a_matt_surface_under_a_lamp_follows_the_cosine():
    image, _ = picture(one(FLOOR, GREY, lights=[LAMP]))
    expected = np.array(GREY.albedo) / np.pi * (np.array([10, 20, 30]) * np.pi / 64) * (2 / np.sqrt(6))
    assert_allclose(image, np.broadcast_to(expected, image.shape), rtol=1e-12)


def test_a_perfect_mirror_under_an_even_sky_shows_it_through_fresnel():
    image, _ = picture(one(FLOOR, fw.Material(0.2, 0, 0), environment=CONSTANT))
    cosine = -CAMERA.rays(24, 16)[1][..., 1:2]
    assert_allclose(image, (0.2 + 0.8 * (1 - cosine) ** 5) * [1.0, 2.0, 3.0], rtol=1e-9)


def test_a_rough_mirror_is_the_split_sum():
    sky, material = fw.skies.gradient(8), fw.Material((0.9, 0.5, 0.1), 0.3, 0)
    image, _ = picture(one(FLOOR, material, environment=sky))
    view = -CAMERA.rays(24, 16)[1].reshape(-1, 3)
    normal = np.broadcast_to([0.0, 1.0, 0.0], view.shape)
    level = prefilter.prefilter(sky, 0.3**2, 8, 32)
    light = lambda direction, roughness: fw.Environment(level).radiance(direction)  # noqa: E731
    table = split_sum.brdf_lut(64, 32)
    expected = split_sum.shade_split_sum(normal, view, material.r0, 0.3, light, table)
    assert_allclose(image.reshape(-1, 3), expected, rtol=1e-9)


def test_a_glossy_surface_under_a_lamp_adds_the_microfacet_term():
    material = fw.Material(0.3, 0.6, 0)
    image, _ = picture(one(FLOOR, material, lights=[LAMP]))
    view = -CAMERA.rays(24, 16)[1].reshape(-1, 3)
    normal = np.broadcast_to([0.0, 1.0, 0.0], view.shape)
    brdf = split_sum.microfacet_brdf(normal, view, LAMP.direction, 0.3, 0.36)
    assert_allclose(image.reshape(-1, 3), brdf * LAMP.irradiance * LAMP.direction[1], rtol=1e-9)


def test_the_shadow_is_that_of_the_ray_from_each_point():
    ball = sdf.sphere((0.3, 0.8, -0.2), 0.4)
    image, _ = picture(one(FLOOR, GREY, casts=ball, lights=[LAMP]), 60, 40)
    gbuffer = fw.rasterize(FLOOR, CAMERA, 60, 40)
    origin = gbuffer.position.reshape(-1, 3) + [0, 0.005, 0]
    visible = soft_shadows.soft_shadow(ball, origin, LAMP.direction, 8.0, 0.02, 12.0, 128).reshape(40, 60)
    assert 0 < np.count_nonzero(visible < 1) < visible.size / 2
    free = np.array(GREY.albedo) / np.pi * LAMP.irradiance * LAMP.direction[1]
    assert_allclose(image, visible[..., None] * free, atol=1e-9)


@pytest.mark.parametrize("kind", ["ambient", "full"])
def test_environment_shadows_darken_what_lies_under_a_roof(kind):
    roof, sky = sdf.box((0, 1.5, 0), (0.5, 0.1, 0.5)), fw.skies.constant(8)
    camera = fw.Camera((0, 1, 4), (0, 0, 0), (0, 1, 0), 0.8)
    scene = fw.Scene(camera, [fw.SceneObject(FLOOR, GREY, roof)], sky, (), kind, reach=3)
    image, plan = picture(scene, 40, 30)
    gbuffer = fw.rasterize(FLOOR, camera, 40, 30)
    under = gbuffer.mask & (np.abs(gbuffer.position[..., [0, 2]]) < 0.3).all(axis=-1)
    far = gbuffer.mask & (np.abs(gbuffer.position) > 6.6).any(axis=-1)
    assert under.any() and far.any()
    assert (image[under] < 0.93 * np.array(GREY.albedo)).all()
    assert_allclose(image[far], np.broadcast_to(GREY.albedo, image[far].shape), rtol=1e-12)
    assert plan["environment shadows"].saved > 0


def test_a_mesh_and_a_field_of_the_same_ball_look_alike():
    camera = fw.Camera((0, 1, 4), (0, 0, 0), (0, 1, 0), 0.7)
    material, sky = fw.Material(0.6, 0, 0.3), fw.skies.studio(32)
    images = []
    for shape in (fw.mesh.sphere(rings=256, segments=512), sdf.sphere((0, 0, 0), 1)):
        scene = fw.Scene(camera, [fw.SceneObject(shape, material, False)], sky, [LAMP])
        images.append(picture(scene, 60, 40)[0])
    difference = np.abs(images[0] - images[1]).max(axis=-1)
    assert np.quantile(difference, 0.95) < 0.02 * images[0].max()


def test_the_nearer_of_a_mesh_and_a_field_is_seen():
    camera = fw.Camera((0, 0, 5), (0, 0, 0), (0, 1, 0), 0.7)
    red, blue = fw.Material(0, 0.5, (1, 0, 0)), fw.Material(0, 0.5, (0, 0, 1))
    ball = fw.SceneObject(fw.mesh.sphere(0.6, (0, 0, 0)), red, False)
    for z, seen in ((1.0, blue), (-1.0, red)):
        other = fw.SceneObject(sdf.sphere((0, 0, z), 0.3), blue, False)
        image, _ = picture(fw.Scene(camera, [ball, other], fw.skies.constant(4)), 31, 31)
        assert_allclose(image[15, 15], seen.albedo, atol=1e-12)


def test_each_field_has_its_own_material():
    camera = fw.Camera((0, 0, 5), (0, 0, 0), (0, 1, 0), 0.7)
    objects = [
        fw.SceneObject(sdf.sphere((x, 0, 0), 0.4), fw.Material(0, 0.5, albedo))
        for x, albedo in ((-1, (1, 0, 0)), (1, (0, 1, 0)))
    ]
    image, _ = picture(fw.Scene(camera, objects, fw.skies.constant(4)), 61, 31)
    assert_allclose(image[15, 22], [1, 0, 0], atol=1e-12)
    assert_allclose(image[15, 39], [0, 1, 0], atol=1e-12)
    assert_allclose(image[0, 0], [1, 1, 1])  # the background


def test_meshes_with_and_without_normals_keep_their_own():
    camera = fw.Camera((0, 0, 6), (0, 0, 0), (0, 1, 0), 0.7)
    lamp = fw.Light((0, 0, 1), 64, 8)
    box = fw.SceneObject(fw.mesh.box((0.5, 0.5, 0.5), (-1, 0, 0)), fw.Material(0, 0.5, 1), False)
    ball = fw.SceneObject(fw.mesh.sphere(0.5, (1, 0, 0), 64, 128), fw.Material(0, 0.5, 1), False)
    image, _ = picture(fw.Scene(camera, [box, ball], None, [lamp]), 61, 31)
    face = image[13:18, 20:26, 0]
    assert_allclose(face, 1.0, rtol=1e-12)  # flat, and it faces the lamp
    ball = image[15, 33:43, 0]
    assert ball.max() == pytest.approx(1.0, abs=0.02) and ball[ball > 0].min() < 0.75


def test_both_sides_of_a_surface_are_seen():
    camera = fw.Camera((0, -3, 0), (0, 0, 0), (0, 0, 1), 0.5)
    image, _ = picture(fw.Scene(camera, [fw.SceneObject(FLOOR, GREY, False)], CONSTANT))
    assert_allclose(image, np.broadcast_to([0.2, 0.8, 1.8], image.shape), rtol=1e-12)


# What is left out


def small(name):
    """An example with an environment so small that the functions in NumPy filter it quickly."""
    scene = fw.load_scene(name)
    if scene.environment is None:
        return scene
    return dataclasses.replace(scene, environment=scene.environment.resized(8))


NAMES = sorted(path.stem for path in EXAMPLES.glob("*.json"))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.filterwarnings("ignore:.*negative", "ignore:.*the mesh is open")
def test_what_is_left_out_changes_no_pixel_and_is_counted(name):
    scene = small(name)
    image, plan = picture(scene, 60, 40)
    whole, all_of_it = picture(scene, 60, 40, everything=True)
    assert_allclose(image, whole, rtol=0, atol=1e-6 * max(1.0, whole.max()))
    assert whole.max() > 0.1
    for key, item in plan.passes.items():
        assert item.cost + item.saved == all_of_it[key].cost, key
    kept, again = picture(scene, 60, 40)
    assert_array_equal(kept, image)
    assert again.operations() < plan.operations() or not {"filtered maps", "irradiance"} & {
        key for key, item in plan.passes.items() if item.done
    }


@pytest.mark.drill
@pytest.mark.filterwarnings("ignore:.*negative", "ignore:.*the mesh is open")
def test_most_examples_are_spared_more_than_half_of_the_work():
    shares = {}
    for name in NAMES:
        render._CACHE.clear()
        plans = [picture(small(name), 240, 160, everything=every)[1] for every in (False, True)]
        shares[name] = 1 - plans[0].operations() / plans[1].operations()
    print({name: round(share, 2) for name, share in shares.items()})
    assert len(shares) >= 10 and sum(share > 0.5 for share in shares.values()) >= 6


def test_random_fields_and_lamps_lose_nothing_by_the_rays_that_are_left_out():
    rng = np.random.default_rng(3)
    for unbounded in (True, False) * 3:
        parts = [sdf.sphere(rng.uniform(-2, 2, 3), rng.uniform(0.1, 0.6)) for _ in range(4)]
        parts += [sdf.box(rng.uniform(-2, 2, 3), rng.uniform(0.1, 0.5, 3))]
        parts += [sdf.plane(rng.normal(size=3), -2.5)] * unbounded
        parts += [sdf.smooth_union(sdf.rotate(parts[4], rng.normal(size=3), 1.0), parts[0], 0.3)]
        lamps = [fw.Light(rng.normal(size=3), 10, k) for k in (1.5, 8, 200)]
        camera = fw.Camera(rng.normal(size=3) * 4, rng.normal(size=3) * 0.3, (0, 1, 0), 0.9)
        objects = [fw.SceneObject(part, GREY, bool(rng.integers(2))) for part in parts]
        objects.append(fw.SceneObject(fw.mesh.torus(1.5, 0.2, 16, 8), GREY, sdf.union(*parts[:2])))
        scene = fw.Scene(camera, objects, None, lamps, reach=rng.uniform(3, 12))
        (image, plan), (whole, _) = picture(scene), picture(scene, everything=True)
        assert_allclose(image, whole, rtol=0, atol=1e-9)
        assert plan["shadow 2"].saved > 0


def test_rays_end_where_no_field_can_be_hit_any_more():
    far = []

    def traced(sdf, origin, direction, t_max, eps, max_steps):
        far.append(t_max)
        return sphere_tracing.sphere_trace(sdf, origin, direction, t_max, eps, max_steps)

    ball = one(sdf.sphere((0, 0, 0), 1), GREY, lights=[LAMP], reach=6.0)
    mine = [{"sphere_trace": traced}, *FUNCTIONS]
    image, whole = (picture(ball, functions=mine, everything=every)[0] for every in (False, True))
    assert_array_equal(image, whole)
    # The farthest corner of the box around the ball, seen from a height of 3; without it, five times the reach.
    assert_allclose(far, [np.sqrt(1 + 1 + 16), 30.0], rtol=1e-3)


def test_only_what_the_camera_sees_is_planned_for():
    hidden = fw.SceneObject(fw.mesh.sphere(0.3, (0, -2, 0)), fw.Material(0.5, 0.7, 0), False)
    scene = fw.Scene(CAMERA, [fw.SceneObject(FLOOR, GREY, False), hidden], fw.skies.gradient(8))
    assert fw.plan_scene(scene, 24, 16)["filtered maps"].done
    _, plan = picture(scene)
    assert not plan["filtered maps"].done and not plan["table"].done and plan["irradiance"].done


def test_results_are_kept_by_content_and_by_function():
    scene = one(FLOOR, fw.Material(0.5, 0.25, 0.5), environment=fw.skies.gradient(8))
    assert picture(scene)[1]["filtered maps"].cost == 2 * 2 * 8 * 8
    same = dataclasses.replace(scene, environment=fw.skies.gradient(8))
    assert [picture(same)[1][name].cost for name in ("filtered maps", "irradiance", "table")] == [0, 0, 0]
    rougher = dataclasses.replace(scene.objects[0], material=fw.Material(0.5, 0.35, 0.5))
    assert picture(dataclasses.replace(scene, objects=[rougher]))[1]["filtered maps"].cost == 2 * 8 * 8
    other = dataclasses.replace(scene, environment=fw.skies.gradient(8, zenith=(1, 0, 0)))
    assert picture(other)[1]["filtered maps"].cost == 2 * 2 * 8 * 8
    mine = {"prefilter_chain": lambda env, levels, heights, samples: [env.pixels * 0 for _ in levels]}
    image, plan = picture(scene, functions=[mine, *FUNCTIONS])
    assert plan["filtered maps"].cost == 2 * 2 * 8 * 8 and plan["irradiance"].cost == 0
    assert (image < picture(scene)[0]).all()


def test_the_cache_forgets_what_was_not_used_for_longest():
    cache = Cache(limit=3000)
    for name in "abc":
        cache.keep(name, np.zeros(120))
    assert cache.find("a") is not None
    cache.keep("d", np.zeros(120))
    assert cache.find("b") is None and cache.find("a") is not None and cache.find("d") is not None
    cache.keep("e", [np.zeros(1000)])
    assert cache.find("e") is not None and cache.find("d") is None


@pytest.mark.parametrize("level", [0.0, 0.3])
def test_bounds_hold_all_points_near_a_solid(level):
    rng = np.random.default_rng(1)
    parts = [sdf.sphere(rng.uniform(-2, 2, 3), 0.3) for _ in range(40)]
    shapes = [sdf.union(*parts, sdf.plane((1, 2, 0), -2.0)), sdf.torus((0, 1, 0), 1, 0.2)]
    points = rng.uniform(-3, 3, (20000, 3))
    value = np.minimum(*(shape(points) for shape in shapes))
    near = Bounds(shapes).near(points, level)
    assert near[value <= level].all()
    assert not near.all()


# What it works with


def test_functions_are_asked_for_by_need_and_missed_by_name():
    assert picture(one(FLOOR, GREY, lights=[LAMP]), functions={})[0].max() > 0
    for scene, name in (
        (one(FLOOR, GREY, environment=CONSTANT), "irradiance"),
        (one(FLOOR, fw.Material(1, 0, 0), environment=CONSTANT), "fresnel_schlick"),
        (one(FLOOR, fw.Material(1, 0.5, 0), environment=CONSTANT), "prefilter_chain"),
        (one(FLOOR, fw.Material(1, 0.5, 0), lights=[LAMP]), "microfacet_brdf"),
        (one(FLOOR, GREY, lights=[LAMP], casts=sdf.sphere((0, 1, 0), 0.5)), "soft_shadow"),
        (one(sdf.sphere((0, 0, 0), 1), GREY), "sphere_trace"),
    ):
        with pytest.raises(ValueError, match=f"render_scene: functions has no {name}; one is wanted for"):
            picture(scene, functions={"unused": None})


def test_the_first_place_that_has_a_function_wins():
    black = {"fresnel_schlick": lambda r0, cosine: 0.0 * cosine * r0}
    scene = one(FLOOR, fw.Material(1, 0, 0), environment=CONSTANT)
    assert picture(scene, functions=[black, *FUNCTIONS])[0].max() == 0
    assert picture(scene, functions=[*FUNCTIONS, black])[0].max() > 0.5


def test_a_light_that_comes_filtered_gives_what_filtering_it_gives():
    sky, material = fw.skies.gradient(8), fw.Material(0.5, 0.3, 0.3)
    chain = prefilter.prefilter_chain(sky, [0.3, 0.4], [8, 8], 32)
    light = fw.EnvironmentLight(
        sky, prefilter.irradiance(sky, 8), chain, [0.3, 0.4], split_sum.brdf_lut(64, 32)
    )
    ready, made = (picture(one(FLOOR, material, environment=given))[0] for given in (light, sky))
    assert_allclose(ready, made, rtol=1e-12)


# Extremes

EVERY = fw.Material(0.5, 0.4, 0.3)
THING = fw.SceneObject(sdf.union(sdf.sphere((0, 0, 0), 1), sdf.plane((0, 1, 0), -1)), EVERY)
SHELL = fw.SceneObject(fw.mesh.sphere(2.0), EVERY, sdf.sphere((0, 0, 0), 0.5))


@pytest.mark.parametrize("kind", ["none", "ambient", "full"])
@pytest.mark.parametrize(
    "camera",
    [
        fw.Camera((0, 0, 0), (1, 0, 0), (0, 1, 0), 1.2),  # inside a field, and inside a mesh
        fw.Camera((0, 0, 1), (0, 0, 5), (0, 1, 0), 1.2),  # on a field
        fw.Camera((9, -0.999, 9), (0, -0.9999, 0), (0, 1, 0), 0.3),  # grazing
        fw.Camera((0, 50, 0), (0, 90, 0), (1, 0, 0), 0.3),  # nothing in view
        fw.Camera((0, 0, 6), (0, 0, 0), (0, 1, 0), 3.1),
    ],
)
@pytest.mark.parametrize("size", [(1, 1), (17, 9)])
def test_pictures_are_finite_and_lose_nothing_at_extremes(kind, camera, size):
    lamps = [LAMP, fw.Light((0, -1, 0), 5, 1.01), fw.Light((1, 1e-9, 0), 5, 1e5)]
    scene = fw.Scene(camera, [THING, SHELL], fw.skies.gradient(4), lamps, kind, reach=3)
    image, plan = picture(scene, *size)
    assert image.shape == (size[1], size[0], 3) and np.isfinite(image).all() and image.min() >= 0
    assert_allclose(image, picture(scene, *size, everything=True)[0], rtol=0, atol=1e-6)
    assert all(item.cost is not None and item.saved >= 0 for item in plan.passes.values())


@pytest.mark.parametrize("everything", [False, True])
def test_an_empty_scene_is_its_environment(everything):
    image, _ = picture(fw.Scene(CAMERA, [], CONSTANT, [LAMP]), everything=everything)
    assert_allclose(image, np.broadcast_to([1.0, 2.0, 3.0], image.shape))
    nothing = fw.SceneObject(fw.Mesh([[0, 0, 0]], []), EVERY)
    image, _ = picture(fw.Scene(CAMERA, [nothing], None, [LAMP]), everything=everything)
    assert image.max() == 0
