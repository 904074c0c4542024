"""An environment made ready for shading, no more of it than is wanted, and nothing twice."""

import numpy as np

from framework.environment import Environment
from framework.environment_light import EnvironmentLight
from framework.plan import IRRADIANCE_ROWS, LADDER, TABLE_SIZE
from framework.render_cache import digest
from framework.render_functions import budgeted

_BLACK = np.zeros((1, 2, 3))
_KEPT = "kept from an earlier frame"
_NO_TABLE = np.zeros((1, 1, 2))


def environment_light(environment, plan, functions, cache, samples):
    """The filtered maps and the table that `plan` wants; what it does not want is black.

    Parameters
    ----------
    environment : Environment, EnvironmentLight or None
    plan : Plan                 counts are noted there
    functions : Functions       `prefilter_chain`, `irradiance` and `brdf_lut`, each if it is wanted
    cache : Cache
    samples : int               budget of those that take one

    Returns
    -------
    EnvironmentLight, or None where there is no environment
    """
    if not isinstance(environment, Environment):
        for name in ("filtered maps", "irradiance", "table"):
            plan.count(name, 0, 0)
        return environment
    chain = _chain(environment, plan, functions, cache, samples)
    irradiance = _irradiance(environment, plan, functions, cache)
    table = _table(plan, functions, cache, samples)
    levels = list(plan.levels) or [0.0]
    # Checking and copying the maps takes a while: the light is kept as well.
    key = ("light", digest(environment), tuple(levels), *map(id, (*chain, irradiance, table)))
    kept = cache.find(key)
    if kept is None:
        light = EnvironmentLight(environment, irradiance, chain, levels, table)
        kept = cache.keep(key, (light, chain, irradiance, table))
    return kept[0]


def _chain(environment, plan, functions, cache, samples):
    levels = plan.levels
    rows = {level: min(environment.height, most) for level, most in LADDER.items()}
    whole = sum(2 * n * n for n in rows.values())
    if not any(levels):
        plan.count("filtered maps", 0, whole)
        return [environment.pixels if 0.0 in levels else _BLACK]
    prefilter_chain = functions.get("prefilter_chain", "rough mirrors under the environment")
    keys = {
        r: ("level", digest(environment, environment.pixels), r, n, samples, prefilter_chain)
        for r, n in levels.items()
    }
    maps = {r: environment.pixels if r == 0 else cache.find(key) for r, key in keys.items()}
    missing = [r for r in levels if maps[r] is None]
    cost = sum(2 * levels[r] ** 2 for r in missing)
    plan.count("filtered maps", cost, whole, None if missing else _KEPT)
    if missing:
        heights = [levels[r] for r in missing]
        made, used = budgeted(prefilter_chain, environment, missing, heights, samples=samples)
        for r, pixels in zip(missing, made, strict=True):
            maps[r] = cache.keep(keys[r], np.asarray(pixels))
        plan.count_each("filtered maps", cost * used)
    return [maps[r] for r in levels]


def _irradiance(environment, plan, functions, cache):
    rows = min(environment.height, IRRADIANCE_ROWS)
    if not plan.irradiance:
        plan.count("irradiance", 0, 2 * rows * rows)
        return _BLACK
    irradiance = functions.get("irradiance", "matt surfaces under the environment")
    key = ("irradiance", digest(environment, environment.pixels), rows, irradiance)
    kept = cache.find(key)
    cost, why = (2 * rows * rows, None) if kept is None else (0, _KEPT)
    plan.count("irradiance", cost, 2 * rows * rows, why)
    return cache.keep(key, np.asarray(irradiance(environment, rows))) if kept is None else kept


def _table(plan, functions, cache, samples):
    if not plan.table:
        plan.count("table", 0, TABLE_SIZE**2)
        return _NO_TABLE
    brdf_lut = functions.get("brdf_lut", "rough mirrors under the environment")
    key = ("table", TABLE_SIZE, samples, brdf_lut)
    kept = cache.find(key)
    if kept is not None:
        plan.count("table", 0, TABLE_SIZE**2, _KEPT)
        return kept
    made, used = budgeted(brdf_lut, TABLE_SIZE, samples=samples)
    plan.count("table", TABLE_SIZE**2, TABLE_SIZE**2)
    plan.count_each("table", TABLE_SIZE**2 * used)
    return cache.keep(key, np.asarray(made))
