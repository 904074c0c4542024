"""A rough mirror of a ball under an environment by Mitsuba 3 (scalar, single precision), with visible normals alone.

Its masking is a product of two Smith terms, ours the height-correlated one, and its pixels are means over their area:
its error is therefore measured against a converged picture of its own.
"""

import mitsuba
import numpy as np

mitsuba.set_variant("scalar_rgb")


class Ball:
    """The picture, from the front and without perspective, of `size` x `size` pixels.

    Parameters
    ----------
    env : framework.Environment
    alpha : float
    size : int
    """

    def __init__(self, env, alpha, size):
        film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
        seen_from = mitsuba.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0])
        metal = {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": alpha}
        self._scene = mitsuba.load_dict({
            "type": "scene", "integrator": {"type": "direct", "bsdf_samples": 1, "emitter_samples": 0},
            "sensor": {"type": "orthographic", "to_world": seen_from, "film": film},
            "sky": {"type": "envmap", "bitmap": mitsuba.Bitmap(env.pixels.astype("f4"))},
            "ball": {"type": "sphere", "bsdf": metal},
        })  # fmt: skip

    def render(self, samples, seed=0):
        """Radiance (size, size, 3), from so many samples a pixel."""
        return np.array(mitsuba.render(self._scene, spp=samples, seed=seed), dtype=float)
