"""Filtered maps, every pixel of them, by plain sums over all of the source: the truth that prefiltering is held to."""

import numba
import numpy as np

from solutions.truth_maps import bilinear, sphere_grid


def filtered_maps(maps, alpha, height, parts, rows=slice(None)):
    """Maps of the same size under the GGX lobe of n = v = r, weighted by n.l and normalised, in float64.

    Parameters
    ----------
    maps : (M, H, 2H, 3) float     bilinear between pixel centres
    alpha : float > 0
    height : int                   rows of the results; divides H * parts
    parts : int                    each pixel counts as parts x parts, with their exact solid angles
    rows : slice                   of the results, which to compute

    Returns
    -------
    (M, rows, 2 height, 3) float
    """
    around, solid_angle = sphere_grid(len(maps[0]) * parts)
    light = np.stack([bilinear(pixels, around) if parts > 1 else pixels for pixels in maps])
    light = np.ascontiguousarray(light.transpose(0, 3, 1, 2)) * solid_angle
    theta = np.pi * (np.arange(height)[rows] + 0.5) / height
    total, white = np.zeros((len(theta), len(maps), 2 * height, 3)), np.zeros(len(theta))
    _sum(light, solid_angle[:, 0], alpha, theta, total, white)
    return np.ascontiguousarray((total / white[:, None, None, None]).transpose(1, 0, 2, 3))


@numba.njit(parallel=True, fastmath={"reassoc", "contract", "nsz", "arcp"})
def _sum(light, solid_angle, alpha, theta, total, white):
    maps, _, height, width = light.shape
    columns = total.shape[2]
    step = width // columns
    for i in numba.prange(len(theta)):
        # The weights of a row of the source depend on the difference in azimuth alone; twice round saves a modulo.
        weight = np.empty(2 * width)
        for j in range(height):
            other = np.pi * (j + 0.5) / height
            polar = np.sin(0.5 * (theta[i] - other)) ** 2
            if polar >= 0.5:  # all of the row is below the horizon
                continue
            sines = np.sin(theta[i]) * np.sin(other)
            for k in range(width):
                # sin^2 of half the angle between the two: of the half vector's tilt
                sin2 = polar + sines * np.sin(np.pi * (k + 0.5 - 0.5 * step) / width) ** 2
                weight[k] = max(1.0 - 2.0 * sin2, 0.0) * (alpha / (alpha**2 * (1.0 - sin2) + sin2)) ** 2
                weight[k + width] = weight[k]
                white[i] += weight[k] * solid_angle[j]
            for c in range(columns):
                turned = weight[width - step * c : 2 * width - step * c]
                for m in range(maps):
                    red, green, blue = light[m, 0, j], light[m, 1, j], light[m, 2, j]
                    r = g = b = 0.0
                    for k in range(width):
                        r += turned[k] * red[k]
                        g += turned[k] * green[k]
                        b += turned[k] * blue[k]
                    total[i, m, c, 0] += r
                    total[i, m, c, 1] += g
                    total[i, m, c, 2] += b
