"""The compiled half of `microfacet_brdf`."""

import math

import numpy as np
from numba import njit, prange


@njit(parallel=True, cache=True, nogil=True, error_model="numpy", fastmath={"nsz", "arcp", "contract", "afn"})
def microfacet(normal, view, light, r0, alpha, out):
    """`F G D / (4 n.i n.o)` for normals and views (N, 3), one light, r0 (3,) and alpha, into `out` (N, 3)."""
    squared, lx, ly, lz = alpha * alpha, light[0], light[1], light[2]
    for i in prange(normal.shape[0]):
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        vx, vy, vz = view[i, 0], view[i, 1], view[i, 2]
        cos_i, cos_o = nx * lx + ny * ly + nz * lz, nx * vx + ny * vy + nz * vz
        # Flatter than 1e-30 is at the horizon: there the squares of the half vector would vanish.
        if not (cos_i > 1e-30 and cos_o > 1e-30):
            out[i, 0] = out[i, 1] = out[i, 2] = 0.0
            continue
        hx, hy, hz = vx + lx, vy + ly, vz + lz
        scale = 1.0 / math.sqrt(hx * hx + hy * hy + hz * hz)
        hx, hy, hz = hx * scale, hy * scale, hz * scale
        cos_h = nx * hx + ny * hy + nz * hz
        # The sine by the cross product: 1 - cos^2 would lose the narrow lobes to rounding.
        cx, cy, cz = ny * hz - nz * hy, nz * hx - nx * hz, nx * hy - ny * hx
        width = cx * cx + cy * cy + cz * cz + squared * cos_h * cos_h
        density = squared / (math.pi * width * width)
        # Smith's height-correlated G2 over 4 n.i n.o (Heitz 2014).
        seen = cos_i * math.sqrt(squared + (1.0 - squared) * cos_o * cos_o)
        seen += cos_o * math.sqrt(squared + (1.0 - squared) * cos_i * cos_i)
        term = density * 0.5 / seen
        miss = 1.0 - min(max(vx * hx + vy * hy + vz * hz, 0.0), 1.0)
        power = miss * miss * miss * miss * miss
        for k in range(3):
            out[i, k] = (r0[k] + (1.0 - r0[k]) * power) * term


def warm():
    """Compile the kernel that `microfacet_brdf` calls."""
    up = np.array([[0.0, 1.0, 0.0]])
    microfacet(up, up, up[0], np.ones(3), 0.5, np.empty((1, 3)))
