"""An environment, filtered and ready for real-time shading, in one small file."""

import io
import zipfile

import numpy as np

from framework.environment import Environment
from framework.lookup import lookup


class EnvironmentLight:
    """What shading by the split sum needs of an environment.

    Parameters
    ----------
    env : Environment                       the light itself
    irradiance_map : (h, 2h, 3) float       cosine-weighted mean radiance around each normal (irradiance / pi)
    chain : sequence of (h, 2h, 3) float    GGX-filtered radiance, one map per roughness, of any heights
    roughness_levels : (L,) float           their roughnesses in [0, 1], strictly ascending
    lut : (size, size, 2) float             scale and bias of r0: one row per roughness, one column per cosine

    Attributes
    ----------
    env, irradiance_map, chain (a tuple), roughness_levels, lut : as given, as float64

    Raises
    ------
    ValueError : a shape or the order of the levels is none of these, or a number is not finite.
    """

    def __init__(self, env, irradiance_map, chain, roughness_levels, lut):
        if not isinstance(env, Environment):
            raise ValueError(f"EnvironmentLight: env is {type(env).__name__}; want an Environment")
        self.env = env
        self.irradiance_map = _map(irradiance_map, "irradiance_map")
        self.chain = tuple(_map(level, f"chain[{i}]") for i, level in enumerate(chain))
        self.roughness_levels = np.array(roughness_levels, dtype=np.float64)
        self.lut = np.array(lut, dtype=np.float64)
        levels = self.roughness_levels
        if levels.shape != (len(self.chain),) or not len(levels) or not (np.diff(levels) > 0).all():
            raise ValueError(
                f"EnvironmentLight: roughness_levels is {levels.tolist()} for a chain of {len(self.chain)} "
                "maps; want one strictly ascending number per map"
            )
        if (
            self.lut.ndim != 3
            or self.lut.shape[0] != self.lut.shape[1]
            or self.lut.shape[2] != 2
            or not self.lut.size
        ):
            raise ValueError(f"EnvironmentLight: lut has shape {self.lut.shape}; want (size, size, 2)")
        if not (np.isfinite(levels).all() and np.isfinite(self.lut).all()):
            raise ValueError("EnvironmentLight: roughness_levels or lut hold numbers that are not finite")

    def irradiance(self, normal):
        """Cosine-weighted mean radiance (irradiance / pi) around normals (..., 3): (..., 3)."""
        return lookup(self.irradiance_map, normal)

    def prefiltered(self, direction, roughness):
        """GGX-filtered radiance: bilinear in the two nearest levels, linear in roughness between them.

        Parameters
        ----------
        direction : (..., 3) float      where the mirror image lies
        roughness : (...) float         a number, or one per direction; beyond the ends the end level

        Returns
        -------
        (..., 3) float
        """
        direction = np.asarray(direction, dtype=np.float64)
        if direction.shape[-1:] != (3,):
            raise ValueError(f"prefiltered: direction has shape {direction.shape}; want (..., 3)")
        roughness = np.broadcast_to(np.asarray(roughness, dtype=np.float64), direction.shape[:-1]).reshape(-1)
        flat = direction.reshape(-1, 3)
        # A position of 1.25 lies a quarter of the way from chain[1] to chain[2].
        position = np.interp(roughness, self.roughness_levels, np.arange(len(self.chain)))
        value = np.full(flat.shape, np.nan)  # stays where the roughness is not finite
        value[np.isfinite(position)] = 0.0
        for level, pixels in enumerate(self.chain):
            weight = 1.0 - np.abs(position - level)
            near = np.flatnonzero(weight > 0)
            if near.size:
                value[near] += weight[near, None] * lookup(pixels, flat[near])
        return value.reshape(direction.shape)

    def save(self, path):
        """Write everything to one `.npz` file, as float32: the same light gives the same bytes everywhere."""
        arrays = {"env": self.env.pixels, "irradiance_map": self.irradiance_map, "lut": self.lut}
        arrays["roughness_levels"] = self.roughness_levels
        arrays |= {f"chain_{i}": level for i, level in enumerate(self.chain)}
        # numpy.savez writes the time of day, and compression depends on the version of zlib.
        with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
            for name, array in arrays.items():
                with np.errstate(over="ignore"):
                    narrow = array.astype("<f4")
                if not np.isfinite(narrow).all():
                    raise ValueError(f"{path}: {name} holds values above 3.4e38, the largest float32")
                buffer = io.BytesIO()
                np.lib.format.write_array(buffer, narrow, allow_pickle=False)
                entry = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
                entry.external_attr, entry.create_system = 0o644 << 16, 3
                archive.writestr(entry, buffer.getvalue())

    @classmethod
    def load(cls, path):
        """The light in a file that `save` wrote.

        Raises
        ------
        OSError, ValueError : the file is missing, or holds something else.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
            count = sum(name.startswith("chain_") for name in arrays)
            parts = [arrays[name] for name in ("env", "irradiance_map", "roughness_levels", "lut")]
            chain = [arrays[f"chain_{i}"] for i in range(count)]
            env, irradiance_map, levels, lut = parts
            # 0.1 in float32 is not 0.1: levels are given with few digits.
            return cls(Environment(env), irradiance_map, chain, np.round(levels.astype(np.float64), 6), lut)
        except (
            Exception
        ) as error:  # zip, NumPy's header and the arrays themselves: each fails in its own ways
            if isinstance(error, OSError) and error.errno is not None:
                raise
            reason = " ".join(str(error).split())
            raise ValueError(f"{path}: no EnvironmentLight, or a damaged one: {reason}") from None


def _map(pixels, name):
    """The pixels as a read-only float64 latitude-longitude map."""
    pixels = np.array(pixels, dtype=np.float64)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.shape[1] != 2 * pixels.shape[0] or not pixels.size:
        raise ValueError(f"EnvironmentLight: {name} has shape {pixels.shape}; want (h, 2h, 3)")
    if not np.isfinite(pixels).all():
        raise ValueError(f"EnvironmentLight: {name} holds values that are not finite")
    pixels.flags.writeable = False
    return pixels
