"""The photographed sky, blurred by the lobes of rough mirrors and of a matt surface."""

import numpy as np

import framework as fw
from solutions import truth_maps
from solutions.lights import small_sky
from solutions.prefilter import irradiance as irradiance_of
from solutions.prefilter import prefilter


def irradiance(spec):
    """cosine-weighted mean radiance (irradiance / pi) around each pixel's direction"""
    return irradiance_of(small_sky(spec["sky"]), spec["height"])


def irradiance_truth(spec):
    """float64 quadrature: a sum over all pixels of the sky with their exact solid angles"""
    return truth_maps.cosine_weighted_radiance(small_sky(spec["sky"]).pixels, _towards(spec)), 0.0


def radiance(spec):
    """GGX-filtered radiance of n = v = r, weighted by n.l; where the lobe is narrower than a pixel 4096 look-ups"""
    return prefilter(small_sky(spec["sky"]), spec["roughness"] ** 2, spec["height"], 4096)


def radiance_truth(spec):
    """float64 quadrature: a sum over all pixels of the sky, each cut in parts where the lobe is narrow"""
    sky = small_sky(spec["sky"]).pixels
    return truth_maps.filtered_radiance(sky, _towards(spec), spec["roughness"] ** 2, spec["parts"]), 0.0


def clamped_sky(spec):
    """The sky with few rows and its pixels clamped: with a full sun no Monte Carlo would converge."""
    return fw.Environment(np.minimum(small_sky(spec["sky"]).pixels, spec["brightest"]))


def _towards(spec):
    return np.ascontiguousarray(truth_maps.sphere_grid(spec["height"])[0][:: spec["every"], :: spec["every"]])
