"""What there is to see: shapes with their materials, lights, an environment and a camera.

A scene can be written to a JSON file and read from one (`framework.scene_file`); it is the same either way. Lengths
are in scene units, angles in radians, light in linear RGB radiance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from framework.arrays import as_number, as_positive, as_vector, normalize
from framework.camera import Camera
from framework.environment import Environment
from framework.environment_light import EnvironmentLight
from framework.mesh import Mesh
from framework.sdf_primitives import Node

ENVIRONMENT_SHADOWS = ("none", "ambient", "full")


@dataclass(frozen=True)
class Material:
    """A mirror of microfacets over a matt ground.

    Parameters
    ----------
    r0 : float or (3,) float        reflectance at normal incidence, in [0, 1]; 0 for no mirror at all
    roughness : float               in [0, 1]; 0 for a perfect mirror
    albedo : float or (3,) float    diffuse reflectance, in [0, 1]; 0 for no matt ground
    """

    r0: tuple = (0.04, 0.04, 0.04)
    roughness: float = 0.5
    albedo: tuple = (0.0, 0.0, 0.0)

    def __post_init__(self):
        object.__setattr__(self, "r0", _color(self.r0, "Material: r0", high=1))
        object.__setattr__(self, "albedo", _color(self.albedo, "Material: albedo", high=1))
        object.__setattr__(self, "roughness", as_number(self.roughness, "Material: roughness", 0, 1))

    @property
    def reflects(self):
        """Whether it has a mirror part: bool."""
        return any(self.r0)

    @property
    def scatters(self):
        """Whether it has a diffuse part: bool."""
        return any(self.albedo)


@dataclass(frozen=True)
class Light:
    """A round light, infinitely far away.

    Parameters
    ----------
    to_light : (3,) float           towards its centre, of any length
    radiance : float or (3,) float  of its disc
    k : float                       1 / sin(angular radius), above 1; larger is smaller, 215 is the sun
    """

    to_light: tuple
    radiance: tuple
    k: float = 215.0

    def __post_init__(self):
        toward = as_vector(self.to_light, "Light: to_light")
        if not toward.any():
            raise ValueError("Light: to_light is zero; a direction is wanted")
        k = as_positive(self.k, "Light: k")
        if k <= 1:
            raise ValueError(f"Light: k is {k:g}; a number above 1, 1 / sin(angular radius), is wanted")
        object.__setattr__(self, "to_light", tuple(toward.tolist()))
        object.__setattr__(self, "radiance", _color(self.radiance, "Light: radiance"))
        object.__setattr__(self, "k", k)

    @property
    def direction(self):
        """Unit vector to the centre, (3,)."""
        return normalize(self.to_light)

    @property
    def irradiance(self):
        """On a surface that faces it, (3,): the disc's projected solid angle is pi sin^2 = pi / k^2."""
        return np.array(self.radiance) * (np.pi / self.k**2)


@dataclass(frozen=True, eq=False)
class SceneObject:
    """A shape and what it is made of.

    Parameters
    ----------
    shape : Mesh or sdf node        drawn by the rasteriser or by sphere tracing
    material : Material
    casts : bool or sdf node        whether it casts shadows: by its own distances, a mesh by those of a grid made of
        it; or the distances that stand in for it
    """

    shape: Mesh | Node
    material: Material = field(default_factory=Material)
    casts: bool | Node = True

    def __post_init__(self):
        _check("SceneObject: shape", self.shape, (Mesh, Node), "a Mesh or a node of framework.sdf")
        _check("SceneObject: material", self.material, Material, "a Material")
        _check("SceneObject: casts", self.casts, (bool, Node), "True, False or a node of framework.sdf")

    @property
    def occluder(self):
        """The Mesh or sdf node that casts its shadow; None where it casts none."""
        return {True: self.shape, False: None}[self.casts] if isinstance(self.casts, bool) else self.casts


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that a picture depends on but its size. Equal scenes have equal descriptions (`to_dict`).

    Parameters
    ----------
    camera : Camera
    objects : sequence of SceneObject
    environment : Environment, EnvironmentLight or None     None is black; a light comes filtered already
    lights : sequence of Light
    environment_shadows : "none", "ambient" (the matt part by the share of the sky that is free) or "full" (the matt
        part by the brightest parts of the sky, the mirror part along its direction)
    reach : float               how far occluders matter, scene units. A shadow ray starts reach / 2400 above the
        surface and marches from reach / 600 to reach; a camera's ray ends at 5 reach
    """

    camera: Camera
    objects: Sequence[SceneObject] = ()
    environment: Environment | EnvironmentLight | None = None
    lights: Sequence[Light] = ()
    environment_shadows: str = "none"
    reach: float = 12.0

    def __post_init__(self):
        _check("Scene: camera", self.camera, Camera, "a Camera")
        for name, kind in (("objects", SceneObject), ("lights", Light)):
            items = getattr(self, name)
            _check(f"Scene: {name}", items, (list, tuple), f"a sequence of {kind.__name__}")
            for i, item in enumerate(items):
                _check(f"Scene: {name}[{i}]", item, kind, f"a {kind.__name__}")
            object.__setattr__(self, name, tuple(items))
        known = (Environment, EnvironmentLight, type(None))
        _check("Scene: environment", self.environment, known, "an Environment, an EnvironmentLight or None")
        if self.environment_shadows not in ENVIRONMENT_SHADOWS:
            wanted = ", ".join(map(repr, ENVIRONMENT_SHADOWS))
            raise ValueError(
                f"Scene: environment_shadows is {self.environment_shadows!r}; one of {wanted} is wanted"
            )
        object.__setattr__(self, "reach", as_positive(self.reach, "Scene: reach"))

    def to_dict(self, folder="."):
        """The description that `scene_from_dict` reads; names of files are relative to `folder`."""
        from framework.scene_file import scene_to_dict

        return scene_to_dict(self, folder)

    def save(self, path):
        """Write the description to a JSON file."""
        from framework.scene_file import save_scene

        save_scene(self, path)

    def __eq__(self, other):
        return isinstance(other, Scene) and self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]  # equality is by content, which may be large


def _color(value, name, high=np.inf):
    """A number or three, as a tuple of three from 0 to `high`."""
    color = np.asarray(value, dtype=object)
    if color.shape not in ((), (3,)):
        raise ValueError(f"{name} has shape {color.shape}; a number or three are wanted")
    return tuple(np.broadcast_to([as_number(c, name, 0, high) for c in color.reshape(-1)], 3).tolist())


def _check(name, value, kind, wanted):
    if not isinstance(value, kind):
        raise ValueError(f"{name} is {type(value).__name__}; {wanted} is wanted")
