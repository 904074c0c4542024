"""Compiled twins of the reference solutions: the same answers, as fast as a CPU gives them."""

from importlib import import_module

_HOME = {
    "brdf_lut": "lut",
    "environment_light": "light",
    "irradiance": "prefilter",
    "microfacet_brdf": "microfacet",
    "monte_carlo_shade": "monte_carlo",
    "prefilter_chain": "prefilter",
    "render_sdf": "render_sdf",
    "sample_chain": "shade",
    "shade_split_sum": "shade",
    "soft_shadow": "soft_shadow",
}

__all__ = list(_HOME)


def __getattr__(name):
    if name not in _HOME:
        raise AttributeError(f"solutions.fast has no {name!r}; it offers {', '.join(sorted(__all__))}")
    value = getattr(import_module(f"solutions.fast.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted(__all__)
