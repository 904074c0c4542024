"""OpenEXR files: images of radiance, and their header. OpenEXR loads when the first file is touched."""

import sys
import threading
import warnings
from contextlib import contextmanager
from pathlib import Path

import numpy as np

# All channels together, as floats: 8192 x 4096 RGBA just fits. Decoding holds the pixels twice.
_MAX_BYTES = 512 * 2**20
_MAGIC = b"\x76\x2f\x31\x01"
# What describes the layout in the file, not the image.
_STRUCTURE = {
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "tiles",
    "type",
    "chunkCount",
}
_STDOUT = threading.Lock()


def read_exr(path):
    """The colours in an OpenEXR file, as the file says them, and the attributes of its header.

    Parameters
    ----------
    path : path of a file with channels R, G, B or Y, and perhaps A; of several parts the first is read

    Returns
    -------
    pixels : (H, W, 3), (H, W, 4) with A, (H, W) for Y, or (H, W, 2) for Y with A
        float32 for half and float channels, which is exact; uint32 for whole numbers
    attributes : dict       by name, without those of the file's layout; "envmap" is "latlong" or "cube"

    Raises
    ------
    OSError : no such file. ValueError : not an OpenEXR file, damaged, too large, or without these channels.
    """
    path = Path(path)
    with path.open("rb") as file:
        if file.read(4) != _MAGIC:
            raise ValueError(f"{path}: not an OpenEXR file")
    header = _decode(path, True, lambda file: dict(file.header()))
    names = _color_channels(path, header)
    channels = _decode(
        path, False, lambda file: {n: c.pixels for n, c in file.channels().items() if n in names}
    )
    planes = [channels[name] for name in names if name in channels]
    if len(planes) < len(names) or len({plane.shape for plane in planes}) != 1 or planes[0].ndim != 2:
        raise ValueError(f"{path}: damaged: its channels are missing or of different sizes")
    planes = [plane.astype(np.float32) if plane.dtype == np.float16 else plane for plane in planes]
    attributes = {name: value for name, value in header.items() if name not in _STRUCTURE}
    if "envmap" in attributes:
        attributes["envmap"] = "cube" if "CUBE" in str(attributes["envmap"]) else "latlong"
    return (np.stack(planes, axis=-1) if len(planes) > 1 else planes[0]), attributes


def write_exr(path, image, half=False, attributes=None, on_overflow="raise", compression="zip"):
    """Write radiance to an OpenEXR file; see `framework.image.write_image`."""
    import OpenEXR

    image = np.asarray(image)
    if image.dtype.kind != "f":
        raise ValueError(f"{path}: the image is of type {image.dtype}; want floating point radiance")
    names = {2: "Y"}.get(
        image.ndim, {2: "YA", 3: "RGB", 4: "RGBA"}.get(image.shape[-1]) if image.ndim == 3 else None
    )
    if names is None or not image.size:
        raise ValueError(f"{path}: the image has shape {image.shape}; want (H, W), (H, W, 3) or (H, W, 4)")
    code = getattr(OpenEXR, f"{str(compression).upper()}_COMPRESSION", None)
    if code is None:
        raise ValueError(f"{path}: compression is {compression!r}; want zip, zips, piz, rle, no, ...")
    stored = _narrowed(path, image, np.float16 if half else np.float32, on_overflow)
    planes = stored[..., None] if image.ndim == 2 else stored
    channels = {name: np.ascontiguousarray(planes[..., i]) for i, name in enumerate(names)}
    header = {**(attributes or {}), "compression": code, "type": OpenEXR.scanlineimage}
    if "envmap" in header:
        kinds = {"latlong": OpenEXR.ENVMAP_LATLONG, "cube": OpenEXR.ENVMAP_CUBE}
        if header["envmap"] not in kinds:
            raise ValueError(f"{path}: attribute envmap is {header['envmap']!r}; want 'latlong' or 'cube'")
        header["envmap"] = kinds[header["envmap"]]
    part = Path(f"{path}.part")  # what fails half way leaves the old file alone
    part.touch()  # a folder that is missing or closed to us is an OSError that says so
    try:
        with _quiet_stdout(), OpenEXR.File(header, channels) as file:
            file.write(str(part))
        part.replace(path)
    except OSError:
        raise
    except Exception as error:
        raise ValueError(f"{path}: cannot be written: {error}") from None
    finally:
        part.unlink(missing_ok=True)


def _decode(path, header_only, take):
    """take(file) of the opened file; whatever OpenEXR throws at damaged ones becomes one ValueError."""
    import OpenEXR

    with _quiet_stdout() as said:
        try:
            # In this thread alone: a process that has started OpenEXR's threads cannot fork.
            with OpenEXR.File(
                str(path), separate_channels=True, header_only=header_only, num_threads=0
            ) as file:
                return take(file)
        except Exception as error:
            reason = " ".join("".join(said or [str(error)]).split())
    raise ValueError(f"{path}: damaged or not readable as OpenEXR: {reason}")


def _color_channels(path, header):
    """Names of the channels to read, after a look at what they would cost."""
    try:
        low, high = ([int(c) for c in corner] for corner in header["dataWindow"])
        sampling = {c.name: (c.xSampling, c.ySampling) for c in header["channels"]}
        kind = str(header.get("type", "scanlineimage"))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"{path}: damaged: its header lacks {error}") from None
    width, height = high[0] - low[0] + 1, high[1] - low[1] + 1
    if "deep" in kind:
        raise ValueError(f"{path}: holds deep pixels; want a flat image")
    if width < 1 or height < 1:
        raise ValueError(f"{path}: damaged: its window is {width} x {height} pixels")
    if width * height * len(sampling) * 4 > _MAX_BYTES:
        raise ValueError(
            f"{path}: {width} x {height} pixels in {len(sampling)} channels need more than "
            f"{_MAX_BYTES >> 20} MiB; want a smaller image"
        )
    color = next((names for names in ("RGB", "Y") if set(names) <= set(sampling)), None)
    if color is None:
        raise ValueError(f"{path}: has the channels {', '.join(sampling) or 'none'}; want R, G and B, or Y")
    if color == "Y" and {"RY", "BY"} <= set(sampling):
        raise ValueError(f"{path}: stores luminance and chroma (Y, RY, BY); want R, G and B, or Y alone")
    names = [*color, "A"] if "A" in sampling else [*color]
    if any(sampling[name] != (1, 1) for name in names):
        raise ValueError(f"{path}: has channels of lower resolution than the image; want all of one size")
    return names


def _narrowed(path, image, dtype, on_overflow):
    """The image as `dtype`; finite values that would become infinite are refused, or set to its largest."""
    if on_overflow not in ("raise", "clamp"):
        raise ValueError(f"{path}: on_overflow is {on_overflow!r}; want 'raise' or 'clamp'")
    with np.errstate(over="ignore", under="ignore"):
        narrow = image.astype(dtype)
    over = np.isinf(narrow) & np.isfinite(image)
    if not over.any():
        return narrow
    largest = np.finfo(dtype).max
    found = (
        f"{path}: {over.sum()} of {image.size} values are beyond {largest:.6g}, the largest {np.dtype(dtype)}"
    )
    if on_overflow == "raise":
        raise ValueError(f"{found}; want a wider format, or on_overflow='clamp'")
    warnings.warn(f"{found}, and were clamped", stacklevel=4)
    return np.where(over, np.copysign(largest, narrow), narrow)


@contextmanager
def _quiet_stdout():
    """Collects what this thread prints, for OpenEXR prints its warnings; other threads print as ever."""
    with _STDOUT:
        said: list[str] = []
        before = sys.stdout
        sys.stdout = _Aside(before, said)
        try:
            yield said
        finally:
            sys.stdout = before


class _Aside:
    def __init__(self, stream, said):
        self._stream, self._said, self._thread = stream, said, threading.get_ident()

    def write(self, text):
        if threading.get_ident() == self._thread:
            self._said.append(text)
            return len(text)
        return self._stream.write(text)

    def __getattr__(self, name):
        return getattr(self._stream, name)
