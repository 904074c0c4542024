"""Images from and to files, and from radiance to what a screen shows."""

from pathlib import Path

import numpy as np

from framework.exr import read_exr, write_exr

__all__ = ["read_exr", "read_image", "tone_map", "write_image"]

_MAX_PIXELS = 2**27  # of a PNG


def read_image(path):
    """The image in a file, as the file says it.

    Parameters
    ----------
    path : path of an `.exr` or `.png` file

    Returns
    -------
    (H, W, 3), (H, W, 4) with alpha, or (H, W) for one channel
        of an .exr: linear radiance, see `read_exr`; of a .png: display values in [0, 1], float32, not decoded

    Raises
    ------
    OSError : no such file. ValueError : damaged, too large, or of another kind.
    """
    return {".exr": lambda: read_exr(path)[0], ".png": lambda: _read_png(path)}[_kind(path)]()


def write_image(path, image, half=False, attributes=None, on_overflow="raise", compression="zip"):
    """Write an image to an `.exr` or `.png` file.

    Parameters
    ----------
    path : path; its ending chooses the format
    image : (H, W), (H, W, 3) or (H, W, 4)
        for .exr: linear radiance, float; for .png: display values in [0, 1] (`tone_map` makes them), or uint8
    half : bool                     .exr with 16 instead of 32 bits a channel
    attributes : dict, optional     header of an .exr: text, numbers, "envmap" ("latlong" or "cube")
    on_overflow : "raise" or "clamp"    for values beyond the format, 65504 with half; clamping warns with a count
    compression : str               of an .exr: any name that OpenEXR knows; those but "zip", "zips", "rle", "piz"
        and "no" are newer, or lose precision

    Raises
    ------
    OSError : the file cannot be written. ValueError : the image does not fit the format.
    """
    if _kind(path) == ".exr":
        write_exr(path, image, half, attributes, on_overflow, compression)
    else:
        _write_png(path, image)


def tone_map(image, exposure=0.0, method="gamma"):
    """Display values of radiance, for showing only: errors are measured before.

    Parameters
    ----------
    image : (...) float     linear radiance
    exposure : float        in stops: each one doubles the brightness
    method : "gamma"        clipped at 1; or "filmic", which rolls the highlights off

    Returns
    -------
    (...) float in [0, 1], encoded as sRGB (IEC 61966-2-1)

    Notes
    -----
    The filmic curve is Narkowicz's fit of ACES (2015).
    """
    linear = np.clip(np.asarray(image, dtype=np.float64), 0.0, 1e10) * 2.0**exposure
    if method == "filmic":
        linear = np.minimum(linear, 1e10)
        linear = linear * (2.51 * linear + 0.03) / (linear * (2.43 * linear + 0.59) + 0.14)
    elif method != "gamma":
        raise ValueError(f"tone_map: method is {method!r}; want 'gamma' or 'filmic'")
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def _kind(path):
    suffix = Path(path).suffix.lower()
    if suffix not in (".exr", ".png"):
        raise ValueError(f"{path}: ends in {suffix or 'nothing'}; want .exr or .png")
    return suffix


def _read_png(path):
    from PIL import Image

    with Path(path).open("rb") as file:
        try:
            with Image.open(file, formats=["PNG"]) as opened:
                png: Image.Image = opened
                if png.width * png.height > _MAX_PIXELS:
                    raise ValueError(f"{png.width} x {png.height} pixels are too many")
                if png.mode == "P":
                    png = png.convert("RGBA" if "transparency" in png.info else "RGB")
                elif png.mode in ("1", "LA"):
                    png = png.convert("L" if png.mode == "1" else "RGBA")
                pixels = np.asarray(png)
        except Exception as error:  # Pillow lets anything through, struct.error and SyntaxError included
            raise ValueError(f"{path}: damaged or not a PNG file: {error}") from None
    return (pixels / (255.0 if pixels.dtype == np.uint8 else 65535.0)).astype(np.float32)


def _write_png(path, image):
    from PIL import Image

    image = np.asarray(image)
    if image.ndim not in (2, 3) or not image.size or (image.ndim == 3 and image.shape[2] not in (3, 4)):
        raise ValueError(f"{path}: the image has shape {image.shape}; want (H, W), (H, W, 3) or (H, W, 4)")
    if image.dtype != np.uint8:
        if image.dtype.kind != "f":
            raise ValueError(f"{path}: the image is of type {image.dtype}; want uint8, or floats in [0, 1]")
        if not np.isfinite(image).all() or image.min() < -1e-6 or image.max() > 1 + 1e-6:
            raise ValueError(
                f"{path}: the image has values outside [0, 1]; want display values, see tone_map"
            )
        image = np.rint(255.0 * np.clip(image, 0.0, 1.0)).astype(np.uint8)
    Image.fromarray(image).save(path)
