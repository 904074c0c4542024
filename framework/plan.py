"""What a picture of a scene needs, what it does not, and what either costs.

`plan_scene` decides before anything is drawn; `framework.render` fills in the counters, and narrows the plan to what
the camera really sees. What is left out changes no pixel: each rule below says why.
"""

from dataclasses import dataclass, replace

import numpy as np

from framework.environment import Environment
from framework.mesh import Mesh

CHANNELS = {"depth": 1, "barycentric": 3, "position": 3, "normal": 3, "uv": 2}

# Roughness levels of a filtered environment, and the most rows that the map of each is worth: a lobe of width alpha
# is seen by 2 to 4 rows. Roughness 0 is the environment itself.
LADDER = {0.1: 256, 0.2: 128, 0.3: 64, 0.4: 64, 0.5: 32, 0.6: 32, 0.8: 32, 1.0: 32}
IRRADIANCE_ROWS = 32
TABLE_SIZE = 64


@dataclass(frozen=True)
class Pass:
    """One step of a rendering.

    Attributes
    ----------
    done : bool         False where it is left out altogether
    why : str           in a few words
    unit : str          what is counted
    cost : int or None  how many of them were worked on; None before the rendering
    saved : int or None how many more it would have been, had nothing been left out
    each : float        operations that one of them takes: samples of a texel, distances of a ray, where known
    """

    done: bool
    why: str
    unit: str
    cost: int | None = None
    saved: int | None = None
    each: float = 1.0


class Plan:
    """The passes of a rendering, and the decisions behind them. `print(plan)` shows them.

    Attributes
    ----------
    width, height : int             of the image, pixels
    everything : bool               whether nothing is left out, needed or not
    passes : dict of str to Pass    in the order of the rendering
    drawn : tuple of int            objects that may be in the picture
    channels : tuple of str         of the G-buffer
    levels : dict of float to int   roughness levels to filter the environment for, and the rows of each
    irradiance, table : bool        whether the map for matt surfaces and the split sum's table are used
    """

    def __init__(self, scene, width, height, everything):
        self.width, self.height, self.everything = width, height, everything
        self.passes: dict[str, Pass] = {}
        self._scene = scene
        self._geometry()
        self._lights()
        self.narrow(self.drawn)

    def __getitem__(self, name):
        return self.passes[name]

    def count(self, name, cost, whole, why=None):
        """Note what a pass cost, and what it would have cost in whole."""
        was, cost = self.passes[name], int(cost)
        self.passes[name] = replace(was, done=cost > 0, why=why or was.why, cost=cost, saved=int(whole) - cost)

    def count_each(self, name, operations):
        """Note how many operations all of a pass took, where they can be counted: 0 says that they cannot."""
        was = self.passes[name]
        self.passes[name] = replace(was, each=operations / was.cost if operations and was.cost else 1.0)

    def operations(self):
        """Counted work of all passes: triangles, values, distances, samples and points alike, a float."""
        return sum((item.cost or 0) * item.each for item in self.passes.values())

    def narrow(self, objects):
        """Plan the light for these objects alone, the ones that the camera was found to see."""
        scene, everything = self._scene, self.everything
        materials = [
            scene.objects[i].material for i in (range(len(scene.objects)) if everything else objects)
        ]
        given = not isinstance(scene.environment, Environment)
        sky, full = scene.environment is not None, scene.environment_shadows == "full"
        matt = sky and any(m.scatters for m in materials)
        mirrors = [m.roughness for m in materials if m.reflects] if sky else []
        # A perfect mirror shows the environment itself, and its table is Fresnel's formula: no look-up is as exact.
        rough = [r for r in mirrors if r > 0 or full]

        self.levels = {} if given else self._bracketing(rough)
        self.irradiance = sky and (matt or everything)
        self.table = sky and (bool(rough) or everything)
        nothing = "there is no environment" if not sky else "nothing in view has a mirror part"
        if mirrors and not rough:
            nothing = "a perfect mirror shows the environment itself"
        ready = "come with the light"
        why = ready if given and sky else f"roughness {_listed(self.levels)}" if self.levels else nothing
        self._pass("filtered maps", bool(self.levels), why, "texels")
        no_matt = "there is no environment" if not sky else "nothing in view has an albedo"
        why = ready if given and sky else "matt surfaces are in view" if matt else no_matt
        self._pass("irradiance", self.irradiance and not given, why, "texels")
        why = ready if given and sky else "rough mirrors are in view" if rough else nothing
        self._pass("table", self.table and not given, why, "cells")

        self._ambient(matt, bool(mirrors), sky)
        self._grids()
        self._pass("matt under the sky", matt, "objects with an albedo" if matt else no_matt, "points")
        self._pass(
            "mirror of the sky", bool(mirrors), "objects with r0 above 0" if mirrors else nothing, "points"
        )
        why = "pixels where nothing is drawn" if sky else "there is no environment"
        self._pass("background", sky, why, "pixels")

    def _pass(self, name, done, why, unit):
        self.passes[name] = Pass(done, why, unit)

    def _geometry(self):
        scene = self._scene
        bounds = [_bounds(item.shape) for item in scene.objects]
        seen = [self.everything or _in_view(scene.camera, self.width / self.height, *box) for box in bounds]
        self.drawn = tuple(i for i, visible in enumerate(seen) if visible)
        meshes = [i for i, item in enumerate(scene.objects) if isinstance(item.shape, Mesh)]
        fields = [i for i in range(len(scene.objects)) if i not in meshes]
        for name, which, unit in (("meshes", meshes, "triangles"), ("fields", fields, "rays")):
            visible = [i for i in which if seen[i]]
            why = f"no {name} in the scene" if not which else f"{len(visible)} of {len(which)} may be in view"
            self._pass(name, bool(visible), why, unit)

        # Normals serve the light. Points are needed where rays start; depth gives them with a third of the memory
        # of the position, and says which of a mesh and a field is in front.
        casters = any(item.occluder is not None for item in scene.objects)
        shadows = casters and (bool(scene.lights) or scene.environment_shadows != "none")
        drawn_fields = any(i in self.drawn for i in fields)
        wanted = (
            CHANNELS if self.everything else ("depth", "normal") if shadows or drawn_fields else ("normal",)
        )
        self.channels = tuple(wanted)
        unread = [name for name in CHANNELS if name not in self.channels]
        why = (
            f"{_listed(self.channels)}; nobody reads {_listed(unread)}" if unread else _listed(self.channels)
        )
        self._pass("channels", self.passes["meshes"].done, why, "values")

    def _lights(self):
        casters = sum(item.occluder is not None for item in self._scene.objects)
        for i, light in enumerate(self._scene.lights):
            shines = any(light.radiance) or self.everything
            self._pass(
                f"light {i}", shines, "points that face it" if shines else "its radiance is 0", "points"
            )
            why = "where n.l > 0 and an occluder may hide it" if casters else "nothing casts shadows"
            self._pass(f"shadow {i}", shines and casters > 0, why if shines else "its radiance is 0", "rays")

    def _grids(self):
        grids = sum(isinstance(item.occluder, Mesh) for item in self._scene.objects)
        used = any(self.passes[name].done for name in self.passes if "shadow" in name)
        why = (
            "meshes that cast"
            if grids and used
            else "no mesh casts shadows"
            if used
            else "nothing asks for shadows"
        )
        self._pass("grids", bool(grids) and used, why, "grids")

    def _ambient(self, matt, mirror, sky):
        kind = self._scene.environment_shadows
        casters = any(item.occluder is not None for item in self._scene.objects)
        done = sky and casters and ((kind == "ambient" and matt) or (kind == "full" and (matt or mirror)))
        why = "points within reach of an occluder"
        if not done:
            why = "not asked for" if kind == "none" else "nothing would be shadowed"
        self._pass("environment shadows", done, why, "points")

    def _bracketing(self, roughnesses):
        """Levels on both sides of each roughness, and their rows: what look-ups between levels read."""
        rows = self._scene.environment.height
        ladder = np.array([0.0, *LADDER])
        wanted: set[float] = set(ladder) if self.everything else set()
        for r in roughnesses:
            wanted |= {ladder[ladder <= r].max(), ladder[ladder >= r].min()}
        return {float(level): min(rows, LADDER.get(level, rows)) for level in sorted(wanted)}

    def __str__(self):
        lines = [("pass", "", "cost", "saved", "")]
        for name, item in self.passes.items():
            state = "done" if item.done else "skipped"
            if item.done and item.saved:
                state = "in part"
            cost, saved = ("" if n is None else f"{n:,}" for n in (item.cost, item.saved))
            if item.cost and item.each != 1:
                cost += f" x {item.each:.3g}"
            lines.append((name, state, f"{cost} {item.unit}".strip() if item.done else "", saved, item.why))
        widths = [max(len(line[column]) for line in lines) for column in range(5)]
        title = f"{self.width} x {self.height} pixels" + (", nothing left out" if self.everything else "")
        rows = (
            "  ".join(text.ljust(size) for text, size in zip(line, widths, strict=True)) for line in lines
        )
        return "\n".join([title, *(row.rstrip() for row in rows)])


def plan_scene(scene, width, height, everything=False):
    """Decide what a picture needs.

    Parameters
    ----------
    scene : Scene
    width, height : int     size of the image in pixels
    everything : bool       leave nothing out, for comparison

    Returns
    -------
    Plan
    """
    for name, size in (("width", width), ("height", height)):
        if not isinstance(size, int | np.integer) or size < 1:
            raise ValueError(
                f"plan_scene: {name} is {size!r}; a whole number of pixels, at least 1, is wanted"
            )
    return Plan(scene, int(width), int(height), bool(everything))


def _bounds(shape):
    if isinstance(shape, Mesh):
        used = shape.vertices if len(shape.faces) else np.full((1, 3), np.nan)
        return used.min(axis=0), used.max(axis=0)
    return shape.bounds


def _in_view(camera, aspect, low, high):
    """Whether a box may be seen: False where all of it lies beyond one side of the view, or behind the camera."""
    if np.isnan(low).any():
        return False
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return True
    right, up, backward = camera.basis
    half_height = np.tan(camera.fov_y / 2)
    half_width = half_height * aspect
    inward = [-backward]
    inward += [-backward * half_width + side * right for side in (1, -1)]
    inward += [-backward * half_height + side * up for side in (1, -1)]
    normals = np.array(inward)
    # The corner that is farthest inwards of each plane through the camera.
    farthest = np.where(normals > 0, high - camera.position, low - camera.position)
    return bool((np.sum(normals * farthest, axis=1) > 0).all())


def _listed(items):
    return ", ".join(f"{item:g}" if isinstance(item, float) else str(item) for item in items)
