"""How much of the light arrives at a tile's points: `soft_shadow`, where something can come near the ray.

The march is that of the definition, step by step, over exact values: only then are the visited points the same.
What is saved is rays that nothing comes near, the rest of a ray beyond the last thing that does, and parts of the
scene that are never the nearest one.
"""

import numpy as np
from numba import njit

from framework.tape_kernels import (
    BATCH,
    CAPSULE,
    ENTRY,
    INLINE,
    NONE,
    ONE,
    OPTIONS,
    ZERO,
    load_ball,
    one_sphere,
    values,
    workspace,
)

INF = np.float32(np.inf)
BLOCKED = np.float32(1e-4)  # by definition
MOST_STEPS = 512
FEW_PARTS = 12  # that are cheaper to evaluate than to choose from


@njit(**ENTRY)
def shadow(
    tape, origin, light, px, py, pz, nx, ny, nz, owner, pixel, bits, n, visibility, rows, lane, others, work
):
    """Fill `visibility` (n,) of points `px, py, pz` relative to `origin`, with unit normals and the parts they lie on."""
    lx, ly, lz = np.float32(light[0]), np.float32(light[1]), np.float32(light[2])
    k, offset, t_min = light[3], np.float32(light[4]), np.float32(light[5])
    ox, oy, oz, end, on = rows[0], rows[1], rows[2], rows[4], rows[5]
    count = NONE
    for i in range(n):
        cosine = nx[i] * lx + ny[i] * ly + nz[i] * lz
        visibility[i] = ZERO
        if cosine > ZERO:
            visibility[i] = ONE
            lane[count] = i
            ox[count], oy[count], oz[count] = (
                px[i] + offset * nx[i],
                py[i] + offset * ny[i],
                pz[i] + offset * nz[i],
            )
            # From a convex part the distance grows by at least n.l: it is never in the way of the light's cone.
            clear = cosine * np.float32(k) >= ONE and offset + cosine * t_min > np.float32(2.0) * BLOCKED
            on[count] = np.float32(owner[i]) if clear and _convex(tape, owner[i]) else -ONE
            count += 1
    if count == 0:
        return
    x, y, z, radius = ball(ox, oy, oz, count)
    for i in range(count):
        end[i] = ZERO
    _reach(tape, origin, light, x, y, z, radius, count, rows, work)
    marching = NONE
    for i in range(count):
        if end[i] >= t_min:
            rows[27, marching], rows[28, marching], rows[29, marching] = ox[i], oy[i], oz[i]
            rows[30, marching], others[marching] = end[i], lane[i]
            marching += 1
    # Points of one part lie close together, and few parts are near to all of them.
    few, begin = tape[3].shape[0] - 1 <= FEW_PARTS, NONE
    while begin < marching:
        stop = marching if few else begin + 1
        while stop < marching and owner[others[stop]] == owner[others[begin]]:
            stop += 1
        # Many are cut in four by their place in the tile.
        whole = few or stop - begin <= 16
        for quarter in range(1 if whole else 4):
            m = NONE
            for i in range(begin, stop):
                at = pixel[others[i]]
                if whole or ((at >> (2 * bits - 1)) & 1) * 2 + ((at >> (bits - 1)) & 1) == quarter:
                    ox[m], oy[m], oz[m], end[m] = rows[27, i], rows[28, i], rows[29, i], rows[30, i]
                    lane[m] = others[i]
                    m += 1
            if m > 0:
                _march(tape, origin, light, few, m, visibility, rows, lane, work)
        begin = stop


@njit(**OPTIONS)
def _convex(tape, part):
    op, start = tape[0], tape[3]
    return start[part + 1] - start[part] == 1 and op[start[part]] <= CAPSULE


@njit(**ENTRY)
def ball(x, y, z, n):
    """A ball around points: its middle and radius, a little larger for rounding."""
    x0, y0, z0, x1, y1, z1 = x[0], y[0], z[0], x[0], y[0], z[0]
    for i in range(n):
        x0, y0, z0 = min(x0, x[i]), min(y0, y[i]), min(z0, z[i])
        x1, y1, z1 = max(x1, x[i]), max(y1, y[i]), max(z1, z[i])
    x0, y0, z0, x1, y1, z1 = (
        np.float64(x0),
        np.float64(y0),
        np.float64(z0),
        np.float64(x1),
        np.float64(y1),
        np.float64(z1),
    )
    mx, my, mz = 0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (z0 + z1)
    radius = 0.500001 * np.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2 + (z1 - z0) ** 2)
    return mx, my, mz, radius + 1e-6 * (abs(mx) + abs(my) + abs(mz))


@njit(**OPTIONS)
def _reach(tape, origin, light, x, y, z, radius, n, rows, work):
    """Bring `end` (rows[4]) to where along each ray something last comes into the light's cone, 0 where nothing does.

    A part matters at distance t where it is nearer than t / k, or than what counts as blocked. So a box matters
    to rays that meet it when it is made larger by `t / k` at the last t at which it can.
    """
    number, start, box, node, leaf, unbounded = (
        tape[1],
        tape[3],
        tape[4],
        tape[5],
        tape[6],
        tape[7],
    )
    todo = work[2]
    ox, oy, oz, end, on = rows[0], rows[1], rows[2], rows[4], rows[5]
    k, t_min, t_max = light[3], np.float32(light[5]), np.float32(light[6])
    for part in range(unbounded):
        if start[part + 1] - start[part] == 1:
            p = number[start[part]]
            away = np.float32(p[3] - (p[0] * origin[0] + p[1] * origin[1] + p[2] * origin[2]))
            nx, ny, nz = np.float32(p[0]), np.float32(p[1]), np.float32(p[2])
            rise = np.float32(p[0] * light[0] + p[1] * light[1] + p[2] * light[2])
            inverse, me = np.float32(1.0 / k), np.float32(part)
            for i in range(n):
                first = nx * ox[i] + ny * oy[i] + nz * oz[i] - away + rise * t_min
                last = first + rise * (t_max - t_min)
                free = (first >= max(t_min * inverse, BLOCKED)) & (last >= max(t_max * inverse, BLOCKED))
                end[i] = end[i] if free | (on[i] == me) else t_max
        else:
            for i in range(n):
                end[i] = t_max
    inner = node.shape[0] // 2
    todo[0], waiting = 0, 1
    while waiting > 0:
        waiting -= 1
        i = todo[waiting]
        if not _in_cone(node, i, origin, light, x, y, z, radius):
            continue
        if i < inner:
            todo[waiting], todo[waiting + 1] = 2 * i + 1, 2 * i + 2
            waiting += 2
            continue
        for part in range(leaf[i - inner], leaf[i - inner + 1]):
            if _in_cone(box, part, origin, light, x, y, z, radius):
                _rays_near_box(box, part, origin, light, x, y, z, radius, n, ox, oy, oz, end, on)


@njit(**OPTIONS)
def _growth(box, i, origin, light, x, y, z, radius):
    """By how much box `i` is to be made larger for rays from a ball, negative where it lies behind them all."""
    half = 0.5 * (
        (box[i, 3] - box[i, 0]) * abs(light[0])
        + (box[i, 4] - box[i, 1]) * abs(light[1])
        + (box[i, 5] - box[i, 2]) * abs(light[2])
    )
    ahead = (
        (0.5 * (box[i, 0] + box[i, 3]) - origin[0] - x) * light[0]
        + (0.5 * (box[i, 1] + box[i, 4]) - origin[1] - y) * light[1]
        + (0.5 * (box[i, 2] + box[i, 5]) - origin[2] - z) * light[2]
    )
    last = ahead + half + radius
    if last < 0.0:
        return -1.0
    # Beyond its last point the distance to the box grows with t, and from there on t / k catches up no more.
    k = light[3]
    return max(min(last / max(k - 1.0, 1e-9), light[6] / k), 1e-4)


@njit(**OPTIONS)
def _in_cone(box, i, origin, light, x, y, z, radius):
    """Whether box `i` of `box` (B, 6) can matter to rays from anywhere in a ball."""
    growth = _growth(box, i, origin, light, x, y, z, radius)
    if growth < 0.0:
        return False
    reach, near, far = growth + radius, 0.0, light[6]
    for axis in range(3):
        at = origin[axis] + (x if axis == 0 else (y if axis == 1 else z))
        inverse = 1.0 / (light[axis] if abs(light[axis]) > 1e-30 else 1e-30)
        a, b = (box[i, axis] - reach - at) * inverse, (box[i, axis + 3] + reach - at) * inverse
        near, far = max(near, min(a, b)), min(far, max(a, b))
    return near <= far


@njit(**OPTIONS)
def _rays_near_box(box, part, origin, light, x, y, z, radius, n, ox, oy, oz, end, on):
    growth = _growth(box, part, origin, light, x, y, z, radius)
    tiny = 1e-30
    ix = np.float32(1.0 / (light[0] if abs(light[0]) > tiny else tiny))
    iy = np.float32(1.0 / (light[1] if abs(light[1]) > tiny else tiny))
    iz = np.float32(1.0 / (light[2] if abs(light[2]) > tiny else tiny))
    cx = np.float32(0.5 * (box[part, 0] + box[part, 3]) - origin[0])
    cy = np.float32(0.5 * (box[part, 1] + box[part, 4]) - origin[1])
    cz = np.float32(0.5 * (box[part, 2] + box[part, 5]) - origin[2])
    growth += 1e-6 * (abs(cx) + abs(cy) + abs(cz))
    kx = np.float32(0.5 * (box[part, 3] - box[part, 0]) + growth) * abs(ix)
    ky = np.float32(0.5 * (box[part, 4] - box[part, 1]) + growth) * abs(iy)
    kz = np.float32(0.5 * (box[part, 5] - box[part, 2]) + growth) * abs(iz)
    t_max, me = np.float32(light[6]), np.float32(part)
    for i in range(n):
        a, b, c = (cx - ox[i]) * ix, (cy - oy[i]) * iy, (cz - oz[i]) * iz
        near = max(max(a - kx, b - ky), max(c - kz, ZERO))
        far = min(min(a + kx, b + ky), min(c + kz, t_max))
        matters = (near <= far) & (on[i] != me)
        end[i] = max(end[i], far) if matters else end[i]


@njit(**INLINE)
def _march(tape, origin, light, few, n, visibility, rows, lane, work):
    """The march of rays up to their `end`, in stretches with a program pruned for each."""
    lx, ly, lz = np.float32(light[0]), np.float32(light[1]), np.float32(light[2])
    k = np.float32(light[3])
    ox, oy, oz, end, at, seen = rows[0], rows[1], rows[2], rows[4], rows[6], rows[7]
    x, y, z = rows[8], rows[9], rows[10]
    bx, by, bz, radius = ball(ox, oy, oz, n)
    ball_x, ball_y, ball_z = np.float32(bx), np.float32(by), np.float32(bz)
    for i in range(n):
        ox[i], oy[i], oz[i], at[i], seen[i] = (
            ox[i] - ball_x,
            oy[i] - ball_y,
            oz[i] - ball_z,
            np.float32(light[5]),
            ONE,
        )
    begin, stride = light[5], ZERO
    while n > 0:
        middle, reach, limit = 0.0, np.inf, INF
        if not few:
            length = max(radius, np.float64(stride))
            middle, reach, limit = begin + 0.5 * length, radius + 0.5 * length, np.float32(begin + length)
        m = load_ball(
            tape, origin[0] + bx + middle * light[0], origin[1] + by + middle * light[1],
            origin[2] + bz + middle * light[2], reach, work,
        )  # fmt: skip
        forth = np.float32(middle)
        for _ in range(MOST_STEPS):
            for i in range(n):
                s = at[i] - forth
                x[i], y[i], z[i] = ox[i] + s * lx, oy[i] + s * ly, oz[i] + s * lz
            values(work[5], work[6], m, x, y, z, n, work[7])
            marching, waiting, stride = _advance(work[7][0, 0], n, at, seen, end, k, limit)
            if marching == 0:
                break
            if 2 * (marching + waiting) <= n:
                n = _compact(n, visibility, rows, lane)
        n = _compact(n, visibility, rows, lane)
        begin = np.inf
        for i in range(n):
            begin = min(begin, at[i])
        if begin <= limit:  # out of steps
            break
    for i in range(n):
        visibility[lane[i]] = seen[i]


@njit(**OPTIONS)
def _advance(h, n, at, seen, end, k, limit):
    """One step of each ray; how many still march, and wait for the next stretch; their longest last step.

    A blocked ray is at infinity.
    """
    marching, waiting, stride = NONE, NONE, ZERO
    for i in range(n):
        t, v = at[i], h[i]
        visits = (t <= end[i]) & (t <= limit)
        blocked = v < BLOCKED
        light = ZERO if blocked else min(k * v / t, seen[i])
        seen[i] = light if visits else seen[i]
        t = (INF if blocked else t + v) if visits else t
        at[i] = t
        stride = max(stride, v if visits & (t <= end[i]) else ZERO)
        marching += (t <= end[i]) & (t <= limit)
        waiting += (t <= end[i]) & (t > limit)
    return marching, waiting, stride


@njit(**OPTIONS)
def _compact(n, visibility, rows, lane):
    """Write down what rays that have ended saw, move the others together; their number."""
    kept = NONE
    for i in range(n):
        if rows[6, i] <= rows[4, i]:
            lane[kept] = lane[i]
            rows[0, kept], rows[1, kept], rows[2, kept] = rows[0, i], rows[1, i], rows[2, i]
            rows[4, kept], rows[6, kept], rows[7, kept] = rows[4, i], rows[6, i], rows[7, i]
            kept += 1
        else:
            visibility[lane[i]] = rows[7, i]
    return kept


def warm():
    """Compile what other kernels call."""
    tape, depth = one_sphere()
    rows, lane, work = np.zeros((32, BATCH), np.float32), np.zeros((4, BATCH), np.int32), workspace(tape[0], tape[3], depth)
    light = np.array([0.0, 1.0, 0.0, 8.0, 0.005, 0.02, 12.0])
    px, py, pz, nx, ny, nz, seen = rows[20], rows[21], rows[22], rows[23], rows[24], rows[25], rows[26]
    shadow(
        tape, np.zeros(3), light, px, py, pz, nx, ny, nz, lane[0], lane[1], 4, 1, seen, rows, lane[2], lane[3], work
    )  # fmt: skip
