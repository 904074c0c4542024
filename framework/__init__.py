"""The renderer that the notebooks build on: `import framework as fw`.

Everything is loaded when it is first used, so that importing costs little more than NumPy.
"""

from importlib import import_module

from framework import compiled as compiled  # watches for the first kernel

__version__ = "0.1.0"

_HOME = {
    "Camera": "camera",
    "Environment": "environment",
    "EnvironmentLight": "environment_light",
    "Light": "scene",
    "Material": "scene",
    "Mesh": "mesh",
    "Scene": "scene",
    "SceneObject": "scene",
    "hammersley": "sampling",
    "interact": "interact",
    "load_mesh": "mesh",
    "load_scene": "scene_file",
    "normalize": "arrays",
    "orthonormal_frame": "arrays",
    "plan_scene": "plan",
    "rasterize": "raster",
    "read_image": "image",
    "reflect": "arrays",
    "render_scene": "render",
    "sample_ggx": "ggx",
    "scene_from_dict": "scene_file",
    "tone_map": "image",
    "write_image": "image",
}
_MODULES = ("arrays", "camera", "environment", "ggx", "image", "mesh", "metrics", "plane", "raster", "sampling", "sdf",
            "show", "skies")  # fmt: skip

__all__ = [*_HOME, *_MODULES]


def __getattr__(name):
    if name in _HOME:
        value = getattr(import_module(f"framework.{_HOME[name]}"), name)
    elif name in _MODULES:
        value = import_module(f"framework.{name}")
    else:
        raise AttributeError(f"framework has no {name!r}; it offers {', '.join(sorted(__all__))}")
    globals()[name] = value
    return value


def __dir__():
    return sorted(__all__)
