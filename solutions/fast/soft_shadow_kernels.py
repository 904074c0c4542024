"""The compiled half of `soft_shadow`: rays from anywhere, in batches of neighbours."""

import numpy as np
from numba import njit

from framework.tape_kernels import BATCH, ENTRY, one_sphere, workspace
from solutions.fast.sdf_shadow_kernels import shadow

BITS = np.int64(1)  # of neighbours' number in a batch that tell its quarters apart; of shadow's dtype


@njit(**ENTRY)
def soft_shadows(thread, threads, tape, depth, origin, light, visibility):
    """Fill one thread's batches of `visibility` (N,) float64 for rays from `origin` (N, 3)."""
    work = workspace(tape[0], tape[3], depth)
    rows, lane = np.empty((8 + 32, BATCH), np.float32), np.zeros((4, BATCH), np.int32)
    px, py, pz, nx, ny, nz, seen = rows[32], rows[33], rows[34], rows[35], rows[36], rows[37], rows[38]
    # The rays leave no part of the scene: a normal so slanted that no part is taken for the one they leave.
    cosine = 0.5 / light[3]
    for i in range(BATCH):
        lane[1, i] = 4 * i // BATCH  # many are cut in four: neighbours stay together
        nx[i], ny[i], nz[i] = cosine * light[0], cosine * light[1], cosine * light[2]
    for start in range(thread * BATCH, origin.shape[0], threads * BATCH):
        n, middle = min(BATCH, origin.shape[0] - start), origin[start]
        for i in range(n):
            px[i] = origin[start + i, 0] - middle[0]
            py[i] = origin[start + i, 1] - middle[1]
            pz[i] = origin[start + i, 2] - middle[2]
        shadow(tape, middle, light, px, py, pz, nx, ny, nz, lane[0], lane[1], BITS, n, seen, rows[:32], lane[2], lane[3], work)
        for i in range(n):
            visibility[start + i] = seen[i]


def warm():
    """Compile the kernel that `soft_shadow` calls."""
    light = np.array([0.0, 1.0, 0.0, 8.0, 0.0, 0.02, 12.0])
    soft_shadows(0, 1, *one_sphere(), np.ones((1, 3)), light, np.empty(1))
