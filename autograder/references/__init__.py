"""Reference images: what right functions give in fixed scenes, each proven by a truth that shares no code with it.

    course references build [NAME...]       rebuild them, after `scenes.json` or a method changed
    course references verify [NAME...]      measure them again, and say which do not keep their word

`scenes.json` holds the scenes and, for every image, its method, its parameters and a limit: the largest error that it
may have. A method is a pair of functions in one of the modules here. NAME(spec) makes the image; NAME_truth(spec) finds
the same numbers in another way, at every pixel or at each `every`-th of each row and column, and says how far it can be
trusted itself: its standard error, 0 where it is exact. What both do is the one line of their docstrings.

| images | show | truth |
| --- | --- | --- |
| traced_* | distance along the rays to nine shapes, and the normals there | rays in closed form |
| penumbra_k* | min(k d / t, 1) on a floor under four shapes, for three sizes of light | the definition, point by point |
| round_light_k* | the visible part of the round light that k stands for | random rays, marched |
| irradiance, prefiltered_r* | the photographed sky, blurred by a matt surface and rough mirrors | sums over all pixels |
| brdf_lut | the table of the split sum | quadrature |
| spheres | rough mirrors under the sky, roughness to the right and r0 downwards | Monte Carlo |
| ambient_*, diffuse_*, glossy_* | two scenes: the free part of the sky, and its light with shadows | random rays, marched |

The header of each file says what it `shows`, its `scene` and parameters as JSON, its `truth`, the `measure` (the
maximum, or the root mean square where the truth is noisy), the `error` by that measure, the `standardError` of the truth,
and a hash of its `pixels`, for OpenEXR itself would not notice a changed one. Pixels are float32. No random number goes
into an image, so that it is the same within 1e-5 on every machine.
"""

from __future__ import annotations

import hashlib
import importlib
import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from framework.exr import read_exr, write_exr

FOLDER = Path(__file__).parent

# Another machine rounds otherwise: what a measured error may exceed the stated one by.
_SLACK, _ROUNDING = 1.05, 1e-6


@dataclass(frozen=True)
class Finding:
    """What came of the proof of one image.

    Attributes
    ----------
    name : str
    truth : str             how the truth is known
    measure : str           "max" or "rms"
    error : float           as measured now; inf where nothing could be measured
    stated : float          as the file's header says
    standard_error : float  of the truth, root mean square; 0 where it is exact
    problem : str           one sentence, or nothing where all is well
    """

    name: str
    truth: str = ""
    measure: str = ""
    error: float = np.inf
    stated: float = np.nan
    standard_error: float = 0.0
    problem: str = ""


def names() -> list[str]:
    """All references, in the order of the assignments."""
    return list(_data()["references"])


def spec(name) -> dict:
    """Scene and parameters of a reference, as its method takes them.

    Raises
    ------
    KeyError : there is no such reference
    """
    data = _data()
    own = data["references"][name]
    scenes = [data["scenes"][part] for part in own["scene"]]
    return {key: value for part in ({"every": 1}, *scenes, own) for key, value in part.items()}


def build(name) -> Finding:
    """Make one image, measure it, and write it if it is within its limit.

    Parameters
    ----------
    name : str      of a reference

    Returns
    -------
    Finding         with a problem, and the old file left alone, where the error is beyond the limit
    """
    wanted = spec(name)
    make, truth = _method(wanted)
    image = np.asarray(make(wanted), dtype=np.float32)
    found = _measured(name, wanted, image, truth)
    if not found.error <= wanted["limit"]:
        return replace(found, problem=f"{name}: the error {found.error:.3g} is beyond its limit {wanted['limit']:g}")
    attributes = {
        "shows": make.__doc__,
        "scene": _scene(wanted),
        "truth": truth.__doc__,
        "measure": found.measure,
        "error": found.error,
        "standardError": found.standard_error,
        "pixels": _hash(image),
    }
    write_exr(_path(name), image, attributes=attributes)
    return replace(found, stated=found.error)


def verify(name) -> Finding:
    """Measure one stored image against its truth.

    Parameters
    ----------
    name : str      of a reference

    Returns
    -------
    Finding         with a problem where the file is missing, damaged, of another scene, or further off than it says
    """
    wanted = spec(name)
    try:
        image, attributes = read_exr(_path(name))
        stated = float(attributes["error"])
        scene, pixels = attributes["scene"], attributes["pixels"]
    except FileNotFoundError:
        return Finding(name, problem=f"{name}: {_path(name)} is missing; `course references build {name}` makes it")
    except (OSError, ValueError) as error:
        return Finding(name, problem=f"{name}: {error}")
    except KeyError as error:
        return Finding(name, problem=f"{name}: the header has no attribute {error}; it was not built as a reference")
    if pixels != _hash(image):
        return Finding(name, stated=stated, problem=f"{name}: damaged: its pixels are not those that were built")
    if scene != _scene(wanted):
        return Finding(name, stated=stated, problem=f"{name}: built from another scene than scenes.json says; build it again")
    found = replace(_measured(name, wanted, image, _method(wanted)[1]), stated=stated)
    if not found.error <= _SLACK * stated + _ROUNDING:
        return replace(found, problem=f"{name}: the error is {found.error:.3g}; the header says {stated:.3g}")
    if not stated <= wanted["limit"]:
        return replace(found, problem=f"{name}: the header says an error of {stated:.3g}; the limit is {wanted['limit']:g}")
    return found


def table(findings) -> str:
    """Findings as a table, with a sentence for each problem below it."""
    head = ("image", "truth", "measure", "error", "stated", "std. error", "ok")
    rows = [
        (
            f.name, f.truth, f.measure, f"{f.error:.2e}", f"{f.stated:.2e}",
            f"{f.standard_error:.2e}" if f.standard_error else "", "NO" if f.problem else "yes",
        )
        for f in findings
    ]  # fmt: skip
    widths = [max(len(cell) for cell in column) for column in zip(head, *rows, strict=True)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in (head, *rows)]
    return "\n".join([*(line.rstrip() for line in lines), *(f.problem for f in findings if f.problem)])


def _measured(name, wanted, image, truth):
    expected, standard_error = truth(wanted)
    part = image[:: wanted["every"], :: wanted["every"]].astype(np.float64)
    measure = "rms" if standard_error else "max"
    error = np.inf
    if part.shape == np.shape(expected) and not np.isnan(part).any():
        same = part == expected  # both may be infinite
        difference = np.subtract(part, expected, out=np.zeros_like(part), where=~same)
        error = np.abs(difference).max() if measure == "max" else np.sqrt(np.mean(difference**2))
    kind = truth.__doc__.partition(":")[0]
    return Finding(name, kind, measure, float(error), np.nan, float(standard_error))


def _method(wanted):
    module, function = wanted["method"].split(".")
    module = importlib.import_module(f"{__name__}.{module}")
    return getattr(module, function), getattr(module, f"{function}_truth")


def _path(name):
    return FOLDER / f"{name}.exr"


def _data():
    return json.loads((Path(__file__).parent / "scenes.json").read_text(encoding="utf-8"))


def _scene(wanted):
    return json.dumps({key: value for key, value in wanted.items() if key != "limit"})


def _hash(image):
    return hashlib.sha256(np.ascontiguousarray(image, dtype="<f4").tobytes()).hexdigest()
