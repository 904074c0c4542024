import dataclasses
import json

import numpy as np
import pytest
from numpy.testing import assert_allclose

import framework as fw
from framework import sdf
from framework.scene_file import EXAMPLES, scene_from_dict, scene_to_dict

CAMERA = {"position": [0, 1, 4], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 0.7}
BALL = {"sphere": {"center": [1, 0, 0], "radius": 1}}
ROD = {"capsule": {"a": [0, 0, 0], "b": [1, 1, 1], "radius": 0.2}}
SCENE = {
    "about": "text is left alone",
    "camera": CAMERA,
    "objects": [
        {
            "mesh": {"torus": {"major_radius": 1.0, "minor_radius": 0.3}, "scale": 2, "translate": [0, 1, 0]},
            "material": {"r0": [1, 0.7, 0.3], "roughness": 0.2},
            "casts": {"torus": {"center": [0, 1, 0], "major_radius": 2, "minor_radius": 0.6}},
        },
        {"mesh": {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}, "casts": False},
        {
            "sdf": {
                "smooth_union": {
                    "k": 0.3,
                    "of": [
                        {"rotate": {"axis": [1, 2, 3], "angle": 0.4, "of": [BALL]}},
                        {"intersection": [{"plane": {"normal": [1, 3, -2], "offset": 0.2}}, ROD]},
                    ],
                }
            },
            "material": {"albedo": 0.5},
        },
    ],
    "environment": {"sky": "studio", "height": 8},
    "lights": [{"to_light": [1, 2, 1], "radiance": 60, "angular_radius": 0.1}],
    "environment_shadows": "ambient",
    "reach": 7,
}  # fmt: skip


def changed(key, value, scene=SCENE):
    """The scene with the value at a path such as "objects.0.material" replaced."""
    scene = json.loads(json.dumps(scene))
    *path, last = (int(part) if part.isdigit() else part for part in key.split("."))
    place = scene
    for part in path:
        place = place[part]
    if value is None:
        del place[last]
    else:
        place[last] = value
    return scene


def test_a_scene_is_the_same_from_a_file_and_from_python(tmp_path):
    (tmp_path / "scene.json").write_text(json.dumps(SCENE))
    read = fw.load_scene(tmp_path / "scene.json")
    torus = fw.mesh.torus(1.0, 0.3)
    assert_allclose(read.objects[0].shape.vertices, 2 * torus.vertices + [0, 1, 0])
    assert read.objects[0].material == fw.Material((1, 0.7, 0.3), 0.2)
    assert read.objects[0].casts == sdf.torus((0, 1, 0), 2, 0.6)
    assert read.objects[1].occluder is None and read.objects[2].occluder is read.objects[2].shape
    assert_allclose(read.lights[0].k, 1 / np.sin(0.1))
    assert read.environment_shadows == "ambient" and read.reach == 7
    python = fw.Scene(
        fw.Camera(**CAMERA),
        read.objects,
        fw.skies.studio(8),
        [fw.Light((1, 2, 1), 60, 1 / np.sin(0.1))],
        "ambient",
        7,
    )
    assert_allclose(python.environment.pixels, read.environment.pixels)
    assert dataclasses.replace(python, environment=read.environment) == read
    assert python != dataclasses.replace(python, reach=8)


@pytest.mark.parametrize("name", sorted(path.stem for path in EXAMPLES.glob("*.json")))
@pytest.mark.filterwarnings("ignore:.*negative")
def test_an_example_survives_writing_and_reading(name, tmp_path):
    scene = fw.load_scene(name)
    scene.save(tmp_path / "again.json")
    assert fw.load_scene(tmp_path / "again.json") == scene
    assert len(json.loads((EXAMPLES / f"{name}.json").read_text())["about"]) > 20


def test_what_was_made_in_python_survives_writing_and_reading(tmp_path):
    turned = sdf.rotate(sdf.plane((1, 2, 3), 0.1), (0.3, -0.2, 0.7), 1.1)
    scene = fw.Scene(
        fw.Camera((0, 0, 3), (0, 0, 0), (0, 1, 0), 1),
        [fw.SceneObject(fw.mesh.sphere(rings=4, segments=6), casts=turned), fw.SceneObject(turned)],
        fw.skies.gradient(2),
    )
    scene.save(tmp_path / "scene.json")
    again = fw.load_scene(tmp_path / "scene.json")
    assert again == scene
    assert_allclose(again.objects[0].shape.normals, scene.objects[0].shape.normals, rtol=0)


def test_paths_in_a_file_are_relative_to_it(tmp_path):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    scene = scene_from_dict({"camera": CAMERA, "objects": [{"mesh": {"file": "meshes/one.obj"}}]}, tmp_path)
    assert scene_to_dict(scene, tmp_path / "meshes")["objects"][0]["mesh"] == {"file": "one.obj"}


def test_a_light_has_the_irradiance_of_its_disc():
    # The integral of the cosine over a disc of angular radius a is pi sin(a)^2.
    light = fw.Light((0, 3, 0), (60000, 1, 2), k=1 / np.sin(0.00465))
    assert_allclose(light.irradiance, np.array([60000, 1, 2]) * np.pi * np.sin(0.00465) ** 2)
    assert_allclose(light.direction, [0, 1, 0])


@pytest.mark.parametrize(
    "key, value, message",
    [
        ("camera", None, "scene has no camera; an object with position, target, up, fov_y is wanted"),
        ("camera.fov_y", None, "scene: camera has no fov_y"),
        ("camera.fov_y", 4, "scene: camera: Camera: fov_y is 4; an angle between 0 and pi"),
        ("sun", 1, "scene has the unknown key 'sun'; about, camera, objects"),
        ("objects", {}, "scene: objects is {}; a list is wanted"),
        ("objects.0", 5, "objects[0] is 5; an object is wanted"),
        ("objects.0.sdf", {}, "objects[0] has both mesh and sdf; one of them is wanted"),
        ("objects.0.mesh", None, "objects[0] has neither mesh nor sdf"),
        ("objects.0.mesh.box", {}, "objects[0].mesh says 2 shapes; exactly one of file, vertices, sphere"),
        ("objects.0.mesh.file", "no.obj", "says 2 shapes"),
        ("objects.0.mesh.cube", {}, "objects[0].mesh has the unknown key 'cube'"),
        (
            "objects.0.mesh.torus.radius",
            1,
            "objects[0].mesh.torus cannot be called: got an unexpected keyword",
        ),
        ("objects.0.mesh.torus.rings", "many", "objects[0].mesh.torus: "),
        ("objects.0.mesh.scale", 0, "objects[0].mesh: scale is 0; a number above 0 is wanted"),
        ("objects.0.mesh.rotate", [1], "objects[0].mesh: rotate is [1]; an object with axis and angle"),
        ("objects.1.mesh.faces", [[0, 1, 3]], "objects[1].mesh: Mesh: faces holds indices from 0 to 3"),
        ("objects.1.mesh.faces", None, "objects[1].mesh has no faces"),
        ("objects.0.material.roughness", 1.4, "Material: roughness is 1.4; a number from 0 to 1 is wanted"),
        ("objects.0.material.r0", [1, 2], "Material: r0 has shape (2,); a number or three are wanted"),
        ("objects.0.material.r0", [1, 2, 0], "Material: r0 is 2; a number from 0 to 1 is wanted"),
        ("objects.0.material.colour", 1, "objects[0].material has the unknown key 'colour'"),
        ("objects.0.casts", "yes", "objects[0].casts is 'yes'; true, false or a field is wanted"),
        ("objects.0.casts", {"cone": {}}, "objects[0].casts: sdf: there is no node 'cone'"),
        ("objects.2.sdf", {"sphere": {"center": [0, 0, 0]}}, "objects[2].sdf: sdf: sphere holds"),
        ("environment", {}, "environment has the keys ; one of file, light, sky or pixels is wanted"),
        ("environment.sky", "night", "environment.sky is 'night'; one of constant, gradient"),
        ("environment.height", 0, "environment, studio: skies: height is 0"),
        ("environment.colour", 1, "environment, studio cannot be called"),
        ("environment", {"pixels": [[1, 2]]}, "environment.pixels: Environment: pixels have shape (1, 2)"),
        ("environment", {"file": "x", "height": [1], "sky": 1}, "environment has the keys file, height, sky"),
        ("objects.0.mesh.scale", "x", "objects[0].mesh: scale is str of dtype"),
        ("lights.0.k", 8, "lights[0] has both k and angular_radius; one of them is wanted"),
        (
            "lights.0.angular_radius",
            2,
            "lights[0].angular_radius is 2; radians between 0 and pi/2 are wanted",
        ),
        ("lights.0.to_light", [0, 0, 0], "lights[0]: Light: to_light is zero; a direction is wanted"),
        ("lights.0.radiance", -1, "lights[0]: Light: radiance is -1; a number of at least 0 is wanted"),
        ("environment_shadows", "some", "environment_shadows is 'some'; one of 'none', 'ambient', 'full'"),
        ("reach", 0, "Scene: reach is 0; a number above 0 is wanted"),
    ],
)
def test_bad_input_is_refused_by_name(key, value, message):
    with pytest.raises(ValueError) as caught:
        scene_from_dict(changed(key, value))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text, error, message",
    [
        ("{", ValueError, "bad.json is not JSON"),
        ("[]", ValueError, "bad.json is []; an object is wanted"),
        (json.dumps(changed("objects.0.mesh", {"file": "no.obj"})), FileNotFoundError, "mesh.file: there is no file"),
        (json.dumps(changed("environment", {"file": "bad.json"})), ValueError, "bad.json: environment.file: "),
        (json.dumps(changed("environment", {"light": 3})), ValueError, "bad.json: environment.light is 3; the name of a file"),
        (json.dumps(changed("reach", float("nan"))), ValueError, "bad.json: Scene: reach holds 1 values that"),
    ],
)  # fmt: skip
def test_a_bad_file_is_refused_by_name(text, error, message, tmp_path):
    (tmp_path / "bad.json").write_text(text)
    with pytest.raises(error) as caught:
        fw.load_scene(tmp_path / "bad.json")
    assert message in str(caught.value)


def test_a_missing_file_is_refused_by_name():
    with pytest.raises(FileNotFoundError, match="load_scene: there is no file .*nowhere.json"):
        fw.load_scene("nowhere")
