"""Shading by the split sum, with its look-ups in one loop: the twin of `split_sum.shade_split_sum`."""

from weakref import WeakKeyDictionary

import numpy as np

import framework as fw
from framework import recycle

_packed: WeakKeyDictionary = WeakKeyDictionary()


def shade_split_sum(normal, view, r0, roughness, prefiltered, lut):
    """Light that a rough mirror reflects to the viewer, without shadows: two look-ups.

    Parameters
    ----------
    normal, view : (N, 3) float            unit vectors
    r0 : float, (3,) or (N, 3) float       reflectance at normal incidence
    roughness : float or (N,) float        in [0, 1]
    prefiltered : callable                 (N, 3) directions, (N,) roughnesses -> (N, 3) radiance; that of a
        `framework.EnvironmentLight` is looked up in the same loop, in float32, and with its maps as they are now
    lut : (size, size, 2) float            as from `brdf_lut`

    Returns
    -------
    (N, 3) float               radiance; 0 where the view is at or below the horizon

    Raises
    ------
    ValueError : the shapes do not fit.
    """
    light = getattr(prefiltered, "__self__", None)
    if (
        not isinstance(light, fw.EnvironmentLight)
        or prefiltered.__func__ is not fw.EnvironmentLight.prefiltered
    ):
        from solutions.split_sum import shade_split_sum

        return shade_split_sum(normal, view, r0, roughness, prefiltered, lut)
    from solutions.fast.shade_kernel import shade

    if light not in _packed:
        _packed[light] = pack(light.chain)
    normal, view = (np.asarray(v, dtype=float) for v in (normal, view))
    shape = np.broadcast_shapes(normal.shape, view.shape, (3,))
    color = recycle.empty(shape)
    texels, starts, heights = _packed[light]
    shade(
        texels,
        starts,
        heights,
        light.roughness_levels,
        np.ascontiguousarray(lut, dtype=np.float32),
        _batch(normal, shape),
        _batch(view, shape),
        np.full((1, 3), r0, dtype=float) if np.ndim(r0) < 2 else _batch(r0, shape),
        np.full(1, roughness, dtype=float) if np.ndim(roughness) == 0 else _batch(roughness, shape[:-1], ()),
        color.reshape(-1, 3),
    )
    return color


def sample_chain(chain, roughness_levels, direction, roughness):
    """Look filtered radiance up between the pixels and between the levels: `prefilter.sample_chain`, compiled.

    Parameters
    ----------
    chain : sequence of (h, 2h, 3) float   one map per level, looked up in float32
    roughness_levels : (L,) float          strictly ascending
    direction : (N, 3) float               of any length
    roughness : float or (N,) float

    Returns
    -------
    (N, 3) float   bilinear in the two nearest levels, linear in roughness between them; beyond the ends the end level;
                   NaN where a direction is not finite
    """
    from solutions.fast.shade_kernel import look_up_all

    direction = np.asarray(direction, dtype=float)
    finite = np.isfinite(direction).all(axis=-1, keepdims=True)
    size = np.abs(direction).max(axis=-1, initial=0.0, keepdims=True)
    if not (finite & (size > 1e-150) & (size < 1e150)).all():  # squares would leave the range of float64
        direction = fw.normalize(np.where(finite, direction, 0.0))
    levels = np.ascontiguousarray(roughness_levels, dtype=float)
    if len(levels) != len(chain) or not len(levels):
        raise ValueError(
            f"sample_chain: {len(levels)} roughness_levels for {len(chain)} maps; want one for each"
        )
    color = np.empty(direction.shape)
    rough = (
        np.full(1, roughness, dtype=float)
        if np.ndim(roughness) == 0
        else _batch(roughness, color.shape[:-1], ())
    )
    texels, starts, heights = pack(chain)
    look_up_all(texels, starts, heights, levels, _batch(direction, color.shape), rough, color.reshape(-1, 3))
    return color if finite.all() else np.where(finite, color, np.nan)


def pack(chain):
    """Maps one behind the other: texels (T, 3) float32, and where each starts and its height, (L,) int."""
    heights = np.array([len(level) for level in chain])
    starts = np.concatenate([[0], np.cumsum(2 * heights**2)[:-1]])
    return np.concatenate([np.asarray(level, np.float32).reshape(-1, 3) for level in chain]), starts, heights


def _batch(value, shape, item=(3,)):
    return np.ascontiguousarray(np.broadcast_to(np.asarray(value, dtype=float), shape)).reshape(-1, *item)
