"""The table of the split sum: samples of the distribution, samples of the visible normals, and quadrature; and by its size.

Truth: float64 quadrature at points that no table of these sizes has a centre at, looked up bilinearly: the error of a
table is that of its entries and that between them.
"""

import functools

import numpy as np

import framework as fw
from benchmarks.harness import Contender
from solutions import fast
from solutions.split_sum import brdf_lut, fresnel_schlick, masking_shadowing, sample_lut
from solutions.truth import brdf_integral

TITLE = "Table of the split sum: run time against error"
ERROR = "largest error of scale and bias"
WORK = "directions"
SIZE = 32
SAMPLES = (64, 256, 1024)


def sampled_by_ndf(size, samples):
    """The table from half vectors with density D (n.h): weights F G (v.h) / (n.v n.h), as Karis 2013 has it."""
    centres = (np.arange(size) + 0.5) / size
    view = np.stack([np.sqrt(1 - centres**2), 0 * centres, centres], axis=1)
    lut = np.empty((size, size, 2))
    for row, alpha in enumerate(centres**2):
        h = fw.sample_ggx(fw.hammersley(samples), alpha)
        v_h = view @ h.T
        cos_i = 2 * v_h * h[:, 2] - centres[:, None]
        weight = masking_shadowing(cos_i, centres[:, None], alpha) * np.maximum(v_h, 0)
        weight /= centres[:, None] * np.maximum(h[:, 2], 1e-9)
        schlick = fresnel_schlick(0.0, v_h)
        lut[row, :, 0], lut[row, :, 1] = (weight * (1 - schlick)).mean(1), (weight * schlick).mean(1)
    return lut


def contenders():
    centres = (np.arange(SIZE) + 0.5) / SIZE
    places = [(row, column) for row in range(1, SIZE, 5) for column in range(0, SIZE, 5)]
    at_centres = np.array([brdf_integral(centres[column], centres[row] ** 2) for row, column in places])
    between = np.random.default_rng(0).uniform(0.05, 0.98, (60, 2))
    wanted = np.array([brdf_integral(mu, roughness**2) for mu, roughness in between])

    def error(lut):
        return float(np.abs([lut[place] for place in places] - at_centres).max())

    def error_between(lut):
        return float(np.abs(sample_lut(lut, *between.T) - wanted).max())

    found = []
    for samples in SAMPLES:
        for method, build in (("samples of the distribution", sampled_by_ndf), ("visible normals", brdf_lut)):
            run = functools.partial(build, SIZE, samples)
            work = functools.partial(lambda result, samples: SIZE * SIZE * samples, samples=samples)
            found.append(Contender(f"{method}, at centres", f"{samples} samples", run, error, work))
    found.append(Contender("quadrature, at centres", "no knob", functools.partial(fast.brdf_lut, SIZE), error))
    for size in (16, 32, 64, 128):
        run = functools.partial(fast.brdf_lut, size)
        found.append(Contender("quadrature, between centres", f"{size} x {size}", run, error_between))
    return found
