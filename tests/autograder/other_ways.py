"""The known mistakes made in other right ways than those that they are written with."""

import contextlib
import importlib
import inspect

import numpy as np

from autograder import mistakes
from solutions import environment_shadows, split_sum


def _with(function, **changed):
    """A function with other defaults."""
    signature = inspect.signature(function)

    def call(*arguments, **named):
        return function(**changed | signature.bind(*arguments, **named).arguments)

    return call


def _random(count):
    return np.random.default_rng(11).random((count, 2))


def _replacements(assignment):
    """(module, name, what stands there instead): right as what it replaces, and another method or discretisation."""
    right = importlib.import_module(f"autograder.mistakes.right.{assignment}")
    own = importlib.import_module(f"autograder.mistakes.{assignment}")
    return {
        "sphere_tracing": lambda: [(own, "_trace", _with(own._trace, step=lambda h: 0.9 * h))],
        "soft_shadows": lambda: [
            (right, "march", _with(right.march, step=lambda h, t: 0.9 * h)),
            (right, "quarter", lambda radius: lambda h, t: np.maximum(np.abs(h), 0.1 * radius * t)),
            (right, "safe_angle_clipped", right.safe_angle_tangent),
            (right, "penumbra_clipped", right.penumbra_as_a_hat),
        ],
        "prefilter": lambda: [
            (right, "sampled", _with(right.sampled, points=_random)),
            (right, "sample_ggx_arctan", right.sample_ggx_cosine),
        ],
        "split_sum": lambda: [
            (right, "ndf_ggx_tangent", split_sum.ndf_ggx),
            (right, "ndf_beckmann_tangent", split_sum.ndf_beckmann),
            (right, "masking_shadowing_lambda", right.masking_shadowing_heitz),
            (right, "monte_carlo", _with(right.monte_carlo, how="quasi")),
            (right, "lut", _with(right.lut, points=_random)),
        ],
        "environment_shadows": lambda: [
            (right, "cut", _with(right.cut, narrow=False)),
            (right, "ambient", _with(right.ambient, turn=1.0)),
            (environment_shadows, "shade_with_shadows", right.shade_with_shadows_smooth_lights),
        ],
    }[assignment]()  # fmt: skip


@contextlib.contextmanager
def made_otherwise(assignment):
    """Within it, what the mistakes of an assignment are built from is another right answer."""
    replaced = [(module, name, getattr(module, name), other) for module, name, other in _replacements(assignment)]
    try:
        for module, name, _, other in replaced:
            setattr(module, name, other)
        yield mistakes.mistakes(assignment)
    finally:
        for module, name, before, _ in replaced:
            setattr(module, name, before)
