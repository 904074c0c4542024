"""Where a tile's rays meet one part of a scene: in closed form where there is one, else by sphere tracing.

Rays start at the origin of the rows' coordinates, the camera, which is outside of every part.
"""

import numpy as np
from numba import njit

from framework.tape_kernels import (
    BATCH,
    BOX,
    CAPSULE,
    ENTRY,
    INLINE,
    NONE,
    ONE,
    OPTIONS,
    PLANE,
    SPHERE,
    TWO,
    ZERO,
    load_part,
    one_sphere,
    part_value,
    values,
    workspace,
)

INF = np.float32(np.inf)
MOST_STEPS = 400  # for one part and stretch; what still marches then is a hit if within a pixel
TOLERANCE = np.float32(0.001)  # of a pixel's radius: a march ends here
ROUNDING = np.float32(4e-7)  # of the distance from the camera: nothing finer can be told
MOMENTUM, STEEPEST = np.float32(0.3), np.float32(0.8)  # Ban and Valasek 2023
SECANT, GRAZING, SLIVER = np.float32(0.2), np.float32(-0.05), np.float32(0.25)


@njit(**ENTRY)
def hit_part(tape, part, slot, camera, axis, spread, pixel, dx, dy, dz, n, t, owner, rows, lane, work):
    """Bring `t` (n,) to where rays meet a part before it, and `owner` to this part's `slot`.

    `axis` is the tile's middle ray; others are within `spread` of it at distance 1; `pixel` is a pixel's radius there.
    """
    op, start = tape[0], tape[3]
    code = op[start[part]]
    if start[part + 1] - start[part] == 1 and code <= CAPSULE:
        load_part(tape, part, 0.0, 0.0, 0.0, 0.0, camera[0], camera[1], camera[2], work, NONE)
        _hit_convex(code, work[6][0], dx, dy, dz, n, t, owner, slot)
    else:
        _march(tape, part, slot, camera, axis, spread, pixel, dx, dy, dz, n, t, owner, rows, lane, work)


@njit(**OPTIONS)
def _hit_convex(code, p, dx, dy, dz, n, t, owner, slot):
    a, b, c, d, e, f, g, h = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
    if code == PLANE:
        for i in range(n):
            s = d / (a * dx[i] + b * dy[i] + c * dz[i])
            closer = (s >= ZERO) & (s < t[i])
            t[i] = s if closer else t[i]
            owner[i] = slot if closer else owner[i]
    elif code == SPHERE:
        for i in range(n):
            s = _ray_sphere(dx[i], dy[i], dz[i], a, b, c, d)
            closer = s < t[i]
            t[i] = s if closer else t[i]
            owner[i] = slot if closer else owner[i]
    elif code == BOX:
        for i in range(n):
            s = _ray_box(dx[i], dy[i], dz[i], a, b, c, d, e, f)
            closer = s < t[i]
            t[i] = s if closer else t[i]
            owner[i] = slot if closer else owner[i]
    elif code == CAPSULE:
        for i in range(n):
            s = _ray_capsule(dx[i], dy[i], dz[i], a, b, c, d, e, f, g, h)
            closer = s < t[i]
            t[i] = s if closer else t[i]
            owner[i] = slot if closer else owner[i]
    else:
        m00, m01, m02, m10, m11, m12 = p[6], p[7], p[8], p[9], p[10], p[11]
        m20, m21, m22 = p[12], p[13], p[14]
        cx, cy, cz = m00 * a + m01 * b + m02 * c, m10 * a + m11 * b + m12 * c, m20 * a + m21 * b + m22 * c
        for i in range(n):
            x, y, z = dx[i], dy[i], dz[i]
            x, y, z = m00 * x + m01 * y + m02 * z, m10 * x + m11 * y + m12 * z, m20 * x + m21 * y + m22 * z
            s = _ray_box(x, y, z, cx, cy, cz, d, e, f)
            closer = s < t[i]
            t[i] = s if closer else t[i]
            owner[i] = slot if closer else owner[i]


@njit(**OPTIONS)
def _ray_sphere(dx, dy, dz, cx, cy, cz, radius):
    # The half chord from the distance between ray and centre: b * b - c would cancel far from the camera.
    along = dx * cx + dy * cy + dz * cz
    x, y, z = cx - along * dx, cy - along * dy, cz - along * dz
    inside = radius * radius - (x * x + y * y + z * z)
    near = along - np.sqrt(max(inside, ZERO))
    return near if (inside >= ZERO) & (along > ZERO) else INF


@njit(**OPTIONS)
def _ray_box(dx, dy, dz, cx, cy, cz, hx, hy, hz):
    # Along an axis at rest the box's sides are infinitely far, on the side that tells inside from outside.
    tiny = np.float32(1e-30)
    ix = ONE / (dx if abs(dx) > tiny else tiny)
    iy = ONE / (dy if abs(dy) > tiny else tiny)
    iz = ONE / (dz if abs(dz) > tiny else tiny)
    kx, ky, kz = hx * abs(ix), hy * abs(iy), hz * abs(iz)
    near = max(max(cx * ix - kx, cy * iy - ky), cz * iz - kz)
    far = min(min(cx * ix + kx, cy * iy + ky), cz * iz + kz)
    return near if (near <= far) & (near >= ZERO) else INF


@njit(**OPTIONS)
def _ray_capsule(dx, dy, dz, ax, ay, az, radius, ux, uy, uz, length):
    # The tube: a circle in the plane across its axis.
    du, au = dx * ux + dy * uy + dz * uz, ax * ux + ay * uy + az * uz
    px, py, pz = dx - du * ux, dy - du * uy, dz - du * uz
    qx, qy, qz = ax - au * ux, ay - au * uy, az - au * uz
    pp = max(px * px + py * py + pz * pz, np.float32(1e-20))
    s = (px * qx + py * qy + pz * qz) / pp
    ex, ey, ez = qx - s * px, qy - s * py, qz - s * pz
    inside = radius * radius - (ex * ex + ey * ey + ez * ez)
    tube = s - np.sqrt(max(inside, ZERO) / pp)
    height = tube * du - au
    on_tube = (inside >= ZERO) & (height >= ZERO) & (height <= length) & (tube >= ZERO)
    a = _ray_sphere(dx, dy, dz, ax, ay, az, radius)
    b = _ray_sphere(dx, dy, dz, ax + length * ux, ay + length * uy, az + length * uz, radius)
    return tube if on_tube else min(a, b)


@njit(**INLINE)
def _march(tape, part, slot, camera, axis, spread, pixel, dx, dy, dz, n, t, owner, rows, lane, work):
    """Sphere tracing of one part, in stretches of the tile's cone with a program pruned for each."""
    start, box = tape[3], tape[4]
    mx, my, mz, at, radius, step, slope, end = (
        rows[0],
        rows[1],
        rows[2],
        rows[3],
        rows[4],
        rows[5],
        rows[6],
        rows[7],
    )
    x, y, z, state = rows[8], rows[9], rows[10], rows[11]
    alive, begin, finish = _rays_in_box(box[part], camera, dx, dy, dz, n, t, rows, lane)
    if alive == 0:
        return
    whole, stretch = start[part + 1] - start[part] <= 3, (finish - begin) / 16.0
    while alive > 0:
        until = finish
        if whole:
            middle, reach = 0.0, np.inf
        else:
            begin = _cone_march(tape, part, slot, camera, axis, spread, begin, finish, work)
            until = min(finish, begin + max(4.0 * spread * begin, stretch))
            middle, reach = 0.5 * (begin + until), 0.5 * (until - begin) + spread * until
        m = load_part(
            tape, part, camera[0] + middle * axis[0], camera[1] + middle * axis[1], camera[2] + middle * axis[2],
            reach, camera[0], camera[1], camera[2], work, NONE,
        )  # fmt: skip
        limit = np.float32(until) if until < finish else INF
        for _ in range(MOST_STEPS):
            for i in range(alive):
                s = at[i] + step[i]
                x[i], y[i], z[i] = s * mx[i], s * my[i], s * mz[i]
            values(work[5], work[6], m, x, y, z, alive, work[7])
            marching, waiting = _advance(
                work[7][0, 0], alive, at, radius, step, slope, end, state, np.float32(pixel), limit
            )
            if marching == 0:
                break
            if 2 * (marching + waiting) <= alive:
                alive = _compact(alive, t, owner, slot, rows, lane)
        for i in range(alive):  # out of steps
            if state[i] == ZERO and at[i] + step[i] <= limit:
                state[i] = ONE if radius[i] < np.float32(pixel) * at[i] else TWO
                step[i] = ZERO
        alive = _compact(alive, t, owner, slot, rows, lane)
        begin = np.inf
        for i in range(alive):
            begin = min(begin, at[i] + step[i])


@njit(**OPTIONS)
def _rays_in_box(box, camera, dx, dy, dz, n, t, rows, lane):
    """Gather the rays that enter a box before `t`: their number, where the first enters, where the last leaves."""
    # A little larger than it is, for what rounding does to its corners.
    cx, cy, cz, hx, hy, hz = ZERO, ZERO, ZERO, INF, INF, INF
    bounded = np.isfinite(box[0])
    if bounded:
        cx = np.float32(0.5 * (box[0] + box[3]) - camera[0])
        cy = np.float32(0.5 * (box[1] + box[4]) - camera[1])
        cz = np.float32(0.5 * (box[2] + box[5]) - camera[2])
        slack = ROUNDING * (abs(cx) + abs(cy) + abs(cz))
        hx = np.float32(0.5 * (box[3] - box[0])) + slack
        hy = np.float32(0.5 * (box[4] - box[1])) + slack
        hz = np.float32(0.5 * (box[5] - box[2])) + slack
    tiny = np.float32(1e-30)
    count, begin, finish = NONE, INF, ZERO
    enter, leave = rows[12], rows[13]
    for i in range(n):
        ix = ONE / (dx[i] if abs(dx[i]) > tiny else tiny)
        iy = ONE / (dy[i] if abs(dy[i]) > tiny else tiny)
        iz = ONE / (dz[i] if abs(dz[i]) > tiny else tiny)
        kx, ky, kz = hx * abs(ix), hy * abs(iy), hz * abs(iz)
        enter[i] = max(max(max(cx * ix - kx, cy * iy - ky), cz * iz - kz), ZERO)
        leave[i] = min(min(min(cx * ix + kx, cy * iy + ky), cz * iz + kz), t[i])
    for i in range(n):
        if enter[i] <= leave[i]:
            lane[count] = i
            rows[0, count], rows[1, count], rows[2, count] = dx[i], dy[i], dz[i]
            rows[3, count], rows[4, count], rows[5, count], rows[6, count] = enter[i], INF, ZERO, -ONE
            rows[7, count], rows[11, count] = leave[i], ZERO
            begin, finish = min(begin, enter[i]), max(finish, leave[i])
            count += 1
    return count, np.float64(begin), np.float64(finish)


@njit(**OPTIONS)
def _cone_march(tape, part, slot, camera, axis, spread, begin, finish, work):
    """How far along its cone the whole tile can go without meeting a part."""
    s = begin
    for _ in range(64):
        value = part_value(
            tape, part, camera[0] + s * axis[0], camera[1] + s * axis[1], camera[2] + s * axis[2], work[0]
        )
        step = (value - s * spread) / (1.0 + spread)
        if step <= 0.25 * spread * s or s >= finish:
            break
        s += step
    return min(s, finish)


@njit(**OPTIONS)
def _advance(h, n, at, radius, step, slope, end, state, pixel, limit):
    """One step of each ray, from the values at its next point; how many still march, and wait for the next stretch.

    `at` is the last point accepted, `radius` the value there, `step` leads from it to the next point, `slope` is
    that of the value along the ray: the mean of a few steps. `state` is 0 for a ray that marches, 1 for a hit, 2 for
    a miss; a ray that has ended stays where it is.
    """
    marching, waiting = NONE, NONE
    for i in range(n):
        z, r, v, last, ended = step[i], radius[i], h[i], at[i], state[i] > ZERO
        s = last + z
        waits = (s > limit) & (s <= end[i])
        # The empty balls of both points must touch, or what lies between them may have been leapt over.
        far = r >= pixel * last
        apart = far & (abs(z) > r + abs(v))
        local = (v - r) / z if abs(z) > ZERO else -ONE
        local = min(max(local, -ONE), ONE)
        mean = (ONE - MOMENTUM) * slope[i] + MOMENTUM * local
        near = pixel * s
        hit = abs(v) <= max(TOLERANCE * near, ROUNDING * s)
        missed = (s > end[i]) & (far | (v > ZERO))
        # Far away relaxed steps, within a pixel of the surface the secant's, which may lead back out of it.
        stop = min(limit, end[i])
        relaxed = TWO * v / (ONE - min(mean, STEEPEST))
        relaxed = relaxed if (s + relaxed <= stop) | (s + v > stop) else max(v, stop - s)
        inverse = ONE / max(-local, SECANT)
        secant = v * inverse if (local < GRAZING) | (v < ZERO) else max(v, SLIVER * near)
        forward = secant if v < near else relaxed
        keeps = waits | apart | ended
        at[i] = last if keeps else (s + v * inverse if hit else s)
        radius[i] = r if keeps else v
        slope[i] = slope[i] if waits | ended else (-ONE if apart else mean)
        now = ZERO if waits | apart else (ONE if hit else (TWO if missed else ZERO))
        now = state[i] if ended else now
        state[i] = now
        forward = r if apart else (ZERO if now > ZERO else forward)
        step[i] = z if waits | ended else forward
        marching += (now == ZERO) & (not waits)
        waiting += waits & (not ended)
    return marching, waiting


@njit(**OPTIONS)
def _compact(n, t, owner, slot, rows, lane):
    """Write down the hits of rays that have ended, move the others together; their number."""
    state, kept = rows[11], NONE
    for i in range(n):
        if state[i] == ZERO:
            lane[kept] = lane[i]
            for row in range(8):
                rows[row, kept] = rows[row, i]
            rows[11, kept] = ZERO
            kept += 1
        elif state[i] == ONE and rows[3, i] < t[lane[i]]:
            t[lane[i]], owner[lane[i]] = max(rows[3, i], ZERO), slot
    return kept


def warm():
    """Compile what other kernels call."""
    tape, depth = one_sphere()
    rows, lane, work = np.zeros((32, BATCH), np.float32), np.zeros((2, BATCH), np.int32), workspace(tape[0], tape[3], depth)
    hit_part(
        tape, 0, 0, np.array([0.0, 0.0, 3.0]), (0.0, 0.0, -1.0), 0.1, 0.1, rows[16], rows[17], rows[18], 1, rows[19],
        lane[0], rows, lane[1], work,
    )  # fmt: skip
