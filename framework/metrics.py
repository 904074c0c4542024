"""How far an image, or any array, is from what it should be. All refuse what is not finite, and add up in float64."""

import numpy as np


def rmse(image, reference):
    """Root of the mean squared difference, in the unit of the images.

    Parameters
    ----------
    image, reference : arrays of equal shape

    Returns
    -------
    float

    Raises
    ------
    ValueError : the shapes differ, there is nothing to compare, or a value is not finite.
    """
    difference = np.subtract(*_pair(image, reference))
    scale = float(np.max(np.abs(difference)))  # keeps squares of very large and very small values in range
    return scale * float(np.sqrt(np.mean((difference / scale) ** 2))) if scale > 0 else 0.0


def relmse(image, reference, eps=1e-2):
    """Mean of the squared difference over the squared reference plus `eps`: bright parts do not drown dark ones.

    Parameters
    ----------
    image, reference : arrays of equal shape
    eps : float     squared radiance below which a pixel counts as dark

    Returns
    -------
    float, of no unit
    """
    image, reference = _pair(image, reference)
    return float(np.mean((image - reference) ** 2 / (reference**2 + eps)))


def maximum(image, reference):
    """Largest absolute difference, in the unit of the images."""
    return float(np.max(np.abs(np.subtract(*_pair(image, reference)))))


def percentile(image, reference, q):
    """The absolute difference that `q` percent of the values stay below."""
    if not 0 <= q <= 100:
        raise ValueError(f"percentile: q is {q!r}; want a number from 0 to 100")
    return float(np.percentile(np.abs(np.subtract(*_pair(image, reference))), q))


def flip(image, reference, hdr=True):
    """Perceived difference by FLIP, and its map.

    Parameters
    ----------
    image, reference : (H, W, 3) float      linear radiance; with hdr=False display values (sRGB) in [0, 1]
    hdr : bool

    Returns
    -------
    mean : float in [0, 1]
    map : (H, W) float in [0, 1]            equal on one system only: the mean is what may be compared

    Raises
    ------
    ImportError : flip-evaluator has no wheel for this system.

    Notes
    -----
    Andersson et al. 2020 (LDR) and 2021 (HDR), at the package's standard viewing distance of 67 pixels a degree.
    """
    image, reference = _pair(image, reference)
    if image.ndim != 3 or image.shape[2] != 3:
        raise ValueError(f"flip: images of shape {image.shape}; want (H, W, 3)")
    if not hdr and (min(image.min(), reference.min()) < 0 or max(image.max(), reference.max()) > 1):
        raise ValueError("flip: values outside [0, 1]; want display values, or hdr=True")
    try:
        import flip_evaluator
    except ImportError:
        raise ImportError("flip needs the package flip-evaluator, which has no wheel for this system") from None
    pair = (np.ascontiguousarray(a, dtype=np.float32) for a in (reference, image))
    errors, mean, _ = flip_evaluator.evaluate(*pair, "HDR" if hdr else "LDR", inputsRGB=True, applyMagma=False)
    return float(mean), np.asarray(errors).reshape(image.shape[:2])


def _pair(image, reference):
    image, reference = np.asarray(image, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    if image.shape != reference.shape:
        raise ValueError(f"metrics: image has shape {image.shape}, reference {reference.shape}; want equal ones")
    if not image.size:
        raise ValueError("metrics: the images are empty; want at least one value")
    for name, values in (("image", image), ("reference", reference)):
        bad = ~np.isfinite(values)
        if bad.any():
            raise ValueError(f"metrics: {bad.sum()} of {values.size} values of the {name} are not finite")
    return image, reference
