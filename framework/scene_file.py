"""Scenes as JSON: reading with messages that name the key, and writing what was read. For example::

    {"camera": {"position": [0, 1, 4], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 0.7},
     "objects": [{"mesh": {"file": "teapot.obj", "scale": 0.5}, "material": {"r0": 0.9, "roughness": 0.2}},
                 {"sdf": {"plane": {"normal": [0, 1, 0], "offset": -1}}, "material": {"albedo": 0.5}}],
     "environment": {"sky": "studio", "height": 64},
     "lights": [{"to_light": [1, 2, 1], "radiance": 60, "k": 8}]}

Every key but `camera` may be left out. Files are looked for beside the JSON file.
"""

import inspect
import json
import os
from dataclasses import MISSING, fields
from pathlib import Path
from weakref import WeakKeyDictionary

import numpy as np

from framework import mesh as shapes
from framework import sdf, skies
from framework.arrays import as_positive, as_vector
from framework.camera import Camera
from framework.environment import Environment
from framework.environment_light import EnvironmentLight
from framework.mesh import Mesh, load_mesh
from framework.scene import Light, Material, Scene, SceneObject
from framework.sdf_primitives import Node

EXAMPLES = Path(__file__).parent / "data" / "scenes"

_MAKERS = ("sphere", "bumpy_sphere", "shading_ball", "torus", "plane", "box")
_SKIES = ("constant", "gradient", "sun_and_sky", "studio", "single_texel", "orientation")
_ARRAYS = ("vertices", "faces", "normals", "uv")
_PLACED = ("scale", "rotate", "translate")

# How meshes and environments that were read are to be written again; the paths in it are absolute.
_sources: WeakKeyDictionary = WeakKeyDictionary()


def load_scene(path):
    """The scene in a JSON file.

    Parameters
    ----------
    path : path of a file; or the name of one of the framework's examples, such as "soft_shadow"

    Returns
    -------
    Scene

    Raises
    ------
    FileNotFoundError, ValueError       the file, or one that it names, is missing; or it describes no scene
    """
    path = Path(path)
    if not path.suffix and not path.exists():
        path = EXAMPLES / f"{path}.json"
    if not path.is_file():
        raise FileNotFoundError(f"load_scene: there is no file {path}")
    try:
        description = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{path.name} is not JSON: {error}") from None
    return scene_from_dict(description, path.parent, path.name)


def save_scene(scene, path):
    """Write a scene to a JSON file, from which `load_scene` makes an equal one."""
    path = Path(path)
    path.write_text(json.dumps(scene_to_dict(scene, path.parent), indent=1) + "\n", encoding="utf-8")


def scene_from_dict(description, folder=".", name="scene"):
    """The scene that a nested description says; files are relative to `folder`, `name` opens messages."""
    keys = _object(description, name, optional=("about", *(f.name for f in fields(Scene))))
    if "camera" not in keys:
        raise ValueError(f"{name} has no camera; an object with {_listed(_names(Camera))} is wanted")
    given = {key: keys[key] for key in ("environment_shadows", "reach") if key in keys}
    given["camera"] = _read(Camera, keys["camera"], f"{name}: camera")
    given["objects"] = [
        _read_object(item, f"{name}: objects[{i}]", folder)
        for i, item in enumerate(_list(keys.get("objects", []), f"{name}: objects"))
    ]
    given["lights"] = [
        _read_light(item, f"{name}: lights[{i}]")
        for i, item in enumerate(_list(keys.get("lights", []), f"{name}: lights"))
    ]
    if keys.get("environment") is not None:
        given["environment"] = _read_environment(keys["environment"], f"{name}: environment", folder)
    return _naming(name, Scene, **given)


def scene_to_dict(scene, folder="."):
    """The description of a scene, of lists, numbers and text; names of files are relative to `folder`."""
    description = {
        "camera": {key: _plain(getattr(scene.camera, key)) for key in _names(Camera)},
        "objects": [_write_object(item, folder) for item in scene.objects],
        "environment": _write_environment(scene.environment, folder),
        "lights": [{key: _plain(getattr(light, key)) for key in _names(Light)} for light in scene.lights],
        "environment_shadows": scene.environment_shadows,
        "reach": scene.reach,
    }
    return description


def _read_object(item, name, folder):
    _object(item, name, optional=("mesh", "sdf", "material", "casts"))
    if ("mesh" in item) == ("sdf" in item):
        found = "both mesh and sdf" if "mesh" in item else "neither mesh nor sdf"
        raise ValueError(f"{name} has {found}; one of them is wanted")
    shape = (
        _read_mesh(item["mesh"], f"{name}.mesh", folder)
        if "mesh" in item
        else _naming(f"{name}.sdf", sdf.from_dict, item["sdf"])
    )
    material = _read(Material, item.get("material", {}), f"{name}.material")
    casts = item.get("casts", True)
    if isinstance(casts, dict):
        casts = _naming(f"{name}.casts", sdf.from_dict, casts)
    if not isinstance(casts, bool | Node):
        raise ValueError(f"{name}.casts is {_excerpt(casts)}; true, false or a field is wanted")
    return SceneObject(shape, material, casts)


def _read_mesh(item, name, folder):
    keys = _object(item, name, optional=("file", *_MAKERS, *_ARRAYS, *_PLACED))
    ways = [key for key in ("file", *_MAKERS, "vertices") if key in keys]
    if len(ways) != 1:
        wanted = f"exactly one of file, vertices, {_listed(_MAKERS)} is wanted"
        raise ValueError(f"{name} says {len(ways)} shapes; {wanted}")
    source, way = dict(keys), ways[0]
    if way == "file":
        path = _path(keys["file"], f"{name}.file", folder)
        source["file"] = path
        made = _naming(f"{name}.file", load_mesh, path)
    elif way == "vertices":
        made = _read(Mesh, {key: keys[key] for key in _ARRAYS if key in keys}, name)
    else:
        made = _call(getattr(shapes, way), keys[way], f"{name}.{way}")
    made = _naming(name, _placed, made, **{key: keys[key] for key in _PLACED if key in keys})
    _sources[made] = source
    return made


def _placed(mesh, scale=1.0, rotate=None, translate=(0.0, 0.0, 0.0)):
    """The mesh scaled from the origin, turned about it, and moved, in this order."""
    vertices, normals = mesh.vertices * as_positive(scale, "scale"), mesh.normals
    if rotate is not None:
        if not isinstance(rotate, dict) or set(rotate) != {"axis", "angle"}:
            raise ValueError(f"rotate is {_excerpt(rotate)}; an object with axis and angle is wanted")
        turn = sdf.rotate(sdf.sphere((0, 0, 0), 1), **rotate).matrix
        vertices, normals = vertices @ turn.T, None if normals is None else normals @ turn.T
    return Mesh(vertices + as_vector(translate, "translate"), mesh.faces, normals, mesh.uv)


def _read_environment(item, name, folder):
    keys = _object(item, name)
    ways = [key for key in ("file", "light", "sky", "pixels") if key in keys]
    if len(ways) != 1:
        raise ValueError(f"{name} has the keys {_listed(keys)}; one of file, light, sky or pixels is wanted")
    source, way = dict(keys), ways[0]
    if way in ("file", "light"):
        _object(item, name, optional=(way, *(["height"] if way == "file" else [])))
        source[way] = path = _path(keys[way], f"{name}.{way}", folder)
        made = _naming(f"{name}.{way}", (Environment if way == "file" else EnvironmentLight).load, path)
        if "height" in keys:
            made = _naming(f"{name}.height", made.resized, keys["height"])
    elif way == "pixels":
        made = _naming(f"{name}.pixels", Environment, np.array(keys["pixels"], dtype=float))
    else:
        if keys["sky"] not in _SKIES:
            raise ValueError(f"{name}.sky is {_excerpt(keys['sky'])}; one of {_listed(_SKIES)} is wanted")
        made = _call(
            getattr(skies, keys["sky"]),
            {key: keys[key] for key in keys if key != "sky"},
            f"{name}, {keys['sky']}",
        )
    _sources[made] = source
    return made


def _read_light(item, name):
    keys = dict(_object(item, name, optional=(*_names(Light), "angular_radius")))
    if "angular_radius" in keys:
        if "k" in keys:
            raise ValueError(f"{name} has both k and angular_radius; one of them is wanted")
        radius = keys.pop("angular_radius")
        if not isinstance(radius, int | float) or not 0 < radius < np.pi / 2:
            raise ValueError(
                f"{name}.angular_radius is {_excerpt(radius)}; radians between 0 and pi/2 are wanted"
            )
        keys["k"] = 1 / np.sin(radius)
    return _read(Light, keys, name)


def _write_object(item, folder):
    if isinstance(item.shape, Mesh):
        source = _sources.get(item.shape)
        if source is None:
            arrays = {key: getattr(item.shape, key) for key in _ARRAYS}
            source = {key: array for key, array in arrays.items() if array is not None}
        description = {"mesh": _plain(source, folder)}
    else:
        description = {"sdf": _field_to_dict(item.shape)}
    description["material"] = {key: _plain(getattr(item.material, key)) for key in _names(Material)}
    description["casts"] = item.casts if isinstance(item.casts, bool) else _field_to_dict(item.casts)
    return description


def _write_environment(environment, folder):
    if environment is None:
        return None
    if environment in _sources:
        return _plain(_sources[environment], folder)
    if isinstance(environment, EnvironmentLight):
        raise ValueError(
            "Scene: environment is a light without a file; one that a scene was read with is wanted"
        )
    return {"pixels": environment.pixels.tolist()}


def _field_to_dict(node):
    """The description of a field that `framework.sdf.from_dict` reads."""
    name = "".join("_" + c.lower() if c.isupper() else c for c in type(node).__name__).lstrip("_")
    if name not in sdf._READ:
        raise ValueError(
            f"Scene: a field of type {type(node).__name__} has no description; nodes of framework.sdf do"
        )
    children = [_field_to_dict(child) for child in node.children]
    if sdf._READ[name][2] is None:
        return {name: children}
    values = {f.name: getattr(node, f.name) for f in fields(node)}
    arguments = {key: _plain(value) for key, value in values.items() if not isinstance(value, Node)}
    return {name: {**arguments, **({"of": children} if children else {})}}


def _plain(value, folder="."):
    """The value as JSON knows it."""
    if isinstance(value, dict):
        return {key: _plain(item, folder) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item, folder) for item in value]
    if isinstance(value, Path):
        return Path(os.path.relpath(value, folder)).as_posix()
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def _read(kind, item, name):
    """A dataclass from an object whose keys are its fields."""
    required = [f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING]
    keys = _object(item, name, optional=_names(kind))
    missing = [key for key in required if key not in keys]
    if missing:
        raise ValueError(
            f"{name} has no {_listed(missing)}; an object with {_listed(_names(kind))} is wanted"
        )
    return _naming(name, kind, **keys)


def _call(function, arguments, name):
    keys = _object(arguments, name)
    try:
        inspect.signature(function).bind(**keys)
    except TypeError as error:
        wanted = _listed(inspect.signature(function).parameters)
        raise ValueError(f"{name} cannot be called: {error}; arguments of {wanted} are wanted") from None
    return _naming(name, function, **keys)


def _naming(name, function, *args, **keys):
    """The result of the function; what it refuses says where in the description it came from."""
    try:
        return function(*args, **keys)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{name}: {error}") from None


def _object(item, name, optional=None):
    if not isinstance(item, dict):
        raise ValueError(f"{name} is {_excerpt(item)}; an object is wanted")
    unknown = [key for key in item if optional is not None and key not in optional]
    if unknown:
        raise ValueError(f"{name} has the unknown key {unknown[0]!r}; {_listed(optional)} are known")
    return item


def _list(value, name):
    if not isinstance(value, list | tuple):
        raise ValueError(f"{name} is {_excerpt(value)}; a list is wanted")
    return value


def _path(value, name, folder):
    if not isinstance(value, str | Path):
        raise ValueError(f"{name} is {_excerpt(value)}; the name of a file is wanted")
    path = (Path(folder) / value).resolve()
    if not path.is_file():
        raise FileNotFoundError(f"{name}: there is no file {path}")
    return path


def _names(kind):
    return tuple(f.name for f in fields(kind))


def _listed(names):
    return ", ".join(str(name) for name in names)


def _excerpt(value):
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
