"""Filtered environments, exact to the grid and without a single sample: the twin of the assignment `prefilter`.

With n = v = r the lobe depends on the angle to its axis alone. Between two parallels of the map it is then a
function of the difference in azimuth: rings of the map meet rings of the result in a product of Fourier series.
The map is its bilinear interpolant throughout.
"""

from functools import cached_property, lru_cache

import numpy as np

from framework.environment import pixel_directions
from framework.lookup import lookup

# A lobe of at least this width is sampled on _ROWS rows: 0.28 of the half width of the narrowest, where cubic
# interpolation is right to a percent at its peak even for a sun in a single texel.
_WIDE, _ROWS = 0.06, 96
# Rows in the half width of a narrower lobe, at which interpolation is right to 2e-4: a map's others are not read.
_ROWS_PER_WIDTH = 10
# The narrowest lobe that meets rings, in pixels of the map, and the look-ups for what is narrower: steps in the
# logarithm of its denominator, and on each circle one for so many widths, within limits. On maps of 64 rows with
# a sun in one texel, widths of 0.06 to 0.4 pixels come out with a relMSE below 1e-4 within 15 degrees of the sun.
_FINEST, _CORE_STEP, _CORE_ARC, _CORE_FEWEST, _CORE_MOST = 0.25, 0.25, 0.5, 4, 16


def irradiance(env, height):
    """What a white diffuse surface shows under the environment, for every orientation.

    Parameters
    ----------
    env : framework.Environment
    height : int                    rows of the result, at least 1

    Returns
    -------
    (height, 2 height, 3) float     cosine-weighted mean radiance (irradiance / pi)

    Raises
    ------
    ValueError : height is none of these.
    """
    return prefilter_chain(env, [1.0], [height])[0]  # GGX of width 1 is the clamped cosine


def prefilter_chain(env, roughness_levels, heights):
    """One map for each roughness, filtered by the lobe of a rough mirror that is seen from straight above.

    Parameters
    ----------
    env : framework.Environment
    roughness_levels : (L,) float   in [0, 1], in any order; 0 looks the map up at the pixel centres of the result
    heights : (L,) int              rows of each result, at least 1

    Returns
    -------
    list of (height, 2 height, 3) float     radiance, never negative

    Raises
    ------
    ValueError : the lengths differ, or a value is out of range.

    Notes
    -----
    A lobe wide against the pixels meets a map of 96 rows; a narrower one the rows that it needs, with its Fourier
    series in closed form; one narrower than a pixel is a share of a lobe as wide as a pixel, which carries its
    tail, and a core that a few look-ups about the axis resolve.
    """
    alphas = np.asarray(roughness_levels, dtype=float) ** 2
    if alphas.ndim != 1 or not ((alphas >= 0) & (alphas <= 1)).all():
        raise ValueError(
            f"prefilter_chain: roughness_levels is {roughness_levels!r}; want (L,) numbers in [0, 1]"
        )
    if len(heights) != len(alphas) or any(int(h) != h or h < 1 for h in heights):
        raise ValueError(
            f"prefilter_chain: heights is {heights!r}; want a whole number of at least 1 for each of "
            f"{len(alphas)} levels"
        )
    source = _Rings(env)
    return [source.filtered(float(alpha), int(height)) for alpha, height in zip(alphas, heights, strict=True)]


class _Rings:
    """An environment as Fourier series along its rows."""

    def __init__(self, env):
        self._env = env
        self._projected = {}

    def filtered(self, alpha, height):
        """The map under a lobe, (height, 2 height, 3)."""
        if alpha < 1e-7:  # tails of 1e-14: none that double precision would show
            return self._env.radiance(pixel_directions(height))
        width = max(alpha, min(_FINEST * np.pi / self._env.height, _WIDE))
        result = self._wide(width, height) if width >= _WIDE else self._narrow(width, height)
        if width > alpha:
            share, tilt, azimuth, weight = _core(alpha, width)
            core = np.empty_like(result)
            _kernels().look_around(self._env.pixels, tilt, azimuth, weight, core)
            result = share * result + (1.0 - share) * core
        return result

    def _wide(self, alpha, height):
        total, norm = self._sampled(alpha, 1.0, height)
        # Rounding in the transforms may leave -1e-16 of a sun.
        return np.maximum(_at_pixel_centres(total) / norm[:, None, None], 0.0)

    def _narrow(self, alpha, height):
        """Closed-form series of the lobe that goes on below its horizon, and what that part is too much."""
        kernels = _kernels()
        own = max(self._env.height, int(np.ceil(np.pi / alpha)))
        rows = min(own, int(np.ceil(0.5 * np.pi * _ROWS_PER_WIDTH / alpha)))
        planes, unit = self._rows(rows, int(0.5 * kernels.CUT / alpha) + 2)
        total, norm = np.empty((height, *planes.shape[1:])), np.empty(height)
        kernels.join_rings(alpha, planes, unit, total, norm)
        # A wide lobe and, for a narrow one, less than 2e-3 of its light: 32 rows resolve it.
        below, share = self._sampled(alpha, -1.0, 32)
        below = lookup(_at_pixel_centres(below) / share[:, None, None], pixel_directions(height))
        share = share.mean()
        return np.maximum((_at_pixel_centres(total) + share * below) / (norm[:, None, None] + share), 0.0)

    def _sampled(self, alpha, side, height):
        """Sums under the lobe's part above (1) or below (-1) its horizon: planes of `height` rows, and white's."""
        kernels = _kernels()
        steps = -(-_ROWS // height)  # columns of the map for each of the result
        half = height * steps
        planes, unit = self._rows(_ROWS, 4 * half + 1)
        frequency = np.arange(planes.shape[2]) / (2 * half)
        # Transform of the cubic Lagrange interpolant: what spreads a point over four columns.
        window = np.sinc(frequency) ** 4 * (1.0 + (2.0 * np.pi * frequency) ** 2 / 6.0)
        comb = np.empty((_ROWS, 6, half + 1))
        kernels.fold_columns(planes, window, steps, comb)
        lobe = np.empty(((height + 1) // 2, _ROWS, half + 1))
        kernels.sample_lobe(alpha, side, height, lobe)
        # Even in azimuth: the inverse transform of one half is the series, all real.
        lobe = np.fft.irfft(lobe, 2 * half, axis=2)[:, :, : half + 1]
        comb = np.concatenate([comb, comb[::-1]], axis=1).transpose(2, 0, 1)
        joined = (np.ascontiguousarray(lobe.transpose(2, 0, 1)) @ np.ascontiguousarray(comb)).transpose(
            1, 2, 0
        )
        lower = slice(height // 2 - 1, None, -1) if height > 1 else slice(0, 0)
        norm = lobe[:, :, 0] @ unit
        return np.concatenate([joined[:, :6], joined[lower, 6:]]), np.concatenate([norm, norm[lower]])

    def _rows(self, rows, frequencies):
        """The map projected on so many rows: planes (rows, 6, M), with M <= frequencies, and those of white."""
        frequencies = min(frequencies, self._planes.shape[2])
        if (rows, frequencies) not in self._projected:
            weights, first, last = _row_weights(self._env.height, rows)
            planes = np.empty((rows, 6, frequencies))
            _kernels().project_rows(weights, first, last, self._planes, planes)
            self._projected[rows, frequencies] = planes, weights[0].sum(axis=1)
        return self._projected[rows, frequencies]

    @cached_property
    def _planes(self):
        height = self._env.height
        m = np.arange(2 * height + 1)
        spectrum = np.fft.rfft(np.ascontiguousarray(self._env.pixels.transpose(0, 2, 1)), axis=2)
        # From the first pixel's centre to azimuth 0, and from points to straight lines between them.
        factor = np.exp(-0.5j * np.pi * m / height) * np.sinc(0.5 * m / height) ** 2 / (2 * height)
        planes = np.empty((height, 6, len(m)))
        _kernels().row_series(spectrum, factor, planes)
        return planes


def _at_pixel_centres(planes):
    """Values of series along rows (h, 6, M) at the pixel centres: (h, 2h, 3)."""
    height, _, count = planes.shape
    width = 2 * height
    series = planes[:, 0::2] + 1j * planes[:, 1::2]
    series *= np.where(np.arange(count) > 0, 2.0, 1.0) * np.exp(1j * np.pi * np.arange(count) / width)
    # Frequencies a whole number of turns apart look the same there.
    folded = np.zeros((height, 3, -(-count // width) * width), dtype=complex)
    folded[:, :, :count] = series
    folded = folded.reshape(height, 3, -1, width).sum(axis=2)
    return np.ascontiguousarray(np.fft.ifft(folded, axis=2, norm="forward").real.transpose(0, 2, 1))


@lru_cache(maxsize=16)
def _row_weights(rows, new_rows):
    """Integrals over theta of linear interpolation from `rows` times cubic interpolation from `new_rows`.

    Returns weights (2, new_rows, rows), for even and odd frequencies, and where they begin and end (new_rows,).
    """
    centres = [(np.arange(count) + 0.5) / count for count in (rows, new_rows)]
    edges = np.unique(np.concatenate([[0.0], *centres, [1.0]]))
    nodes, gauss = np.polynomial.legendre.leggauss(5)
    x = (edges[:-1, None] + np.diff(edges)[:, None] * 0.5 * (nodes + 1.0)).ravel()
    solid = (np.diff(edges)[:, None] * 0.5 * gauss).ravel() * np.pi * np.sin(np.pi * x)
    b, t = _split(x * rows - 0.5)
    j, s = _split(x * new_rows - 0.5)
    linear = ((b, 1 - t), (b + 1, t))
    cubic = (
        (j - 1, -s * (s - 1) * (s - 2) / 6),
        (j, (s + 1) * (s - 1) * (s - 2) / 2),
        (j + 1, -(s + 1) * s * (s - 2) / 2),
        (j + 2, (s + 1) * s * (s - 1) / 6),
    )
    weights = np.zeros((2, new_rows, rows))
    for new, new_value in cubic:
        new, new_turned = _over_the_poles(new, new_rows)
        for old, old_value in linear:
            old, old_turned = _over_the_poles(old, rows)
            value = solid * new_value * old_value
            np.add.at(weights[0], (new, old), value)
            # Half a turn of azimuth is a sign at odd frequencies.
            np.add.at(weights[1], (new, old), np.where(new_turned ^ old_turned, -value, value))
    used = (weights != 0).any(axis=0)
    return weights, used.argmax(axis=1), rows - used[:, ::-1].argmax(axis=1)


def _split(x):
    whole = np.floor(x)
    return whole.astype(int), x - whole


def _over_the_poles(row, count):
    """The row of the map that a row beyond its ends is, and whether half a turn away."""
    turn, row = np.divmod(row, count)
    return np.where(turn % 2, count - 1 - row, row), (turn % 2).astype(bool)


def _core(alpha, width):
    """What a lobe is beside its share of a wider one with the same tail, as look-ups about the axis.

    Returns
    -------
    share : float       of the light, that the wider lobe carries
    tilt, azimuth, weight : (N,) float      look-ups for the rest; the weights add up to 1
    """

    def lobe(a, s):  # s = sin^2 of the half vector's tilt
        return (1.0 - 2.0 * s) * (a / (a**2 + (1.0 - a**2) * s)) ** 2

    # Even steps in the logarithm of the lobe's denominator resolve peak and tail alike.
    depth = np.log1p(0.5 / alpha**2)
    count = int(np.ceil(depth / _CORE_STEP))
    s = alpha**2 * np.expm1(depth * (np.arange(count) + 0.5) / count)
    step = (s + alpha**2) * depth / count
    # Where the light ends, at s = 1/2, the wider lobe's tail is the lobe's.
    part = (alpha / width * (1.0 + width**2) / (1.0 + alpha**2)) ** 2
    wide, core = part * lobe(width, s) * step, (lobe(alpha, s) - part * lobe(width, s)) * step
    share = wide.sum() / (wide.sum() + core.sum())
    kept = np.flatnonzero(core > 1e-5 * core.sum())
    tilt, azimuth, weight = [], [], []
    for i, ring in enumerate(kept):
        angle = 2.0 * np.arcsin(np.sqrt(s[ring]))
        # Even, and by half a step: the same from north and from south.
        around = 2 * int(
            np.ceil(np.clip(np.pi * angle / (_CORE_ARC * width), _CORE_FEWEST / 2, _CORE_MOST / 2))
        )
        tilt += [angle] * around
        azimuth += list(2.0 * np.pi * (np.arange(around) + 0.5 * (i % 2)) / around)
        weight += [core[ring] / around] * around
    return share, np.array(tilt), np.array(azimuth), np.array(weight) / np.sum(weight)


def _kernels():
    from solutions.fast import prefilter_kernel

    return prefilter_kernel
