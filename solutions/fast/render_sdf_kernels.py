"""The compiled half of `render_sdf`: tiles of pixels, from the parts they may see to their channels."""

import numpy as np
from numba import njit

from framework.tape_kernels import (
    BATCH,
    ENTRY,
    INLINE,
    NONE,
    ONE,
    OPTIONS,
    PLANE,
    ZERO,
    distance_to_box,
    gradients,
    lent_rows,
    lent_tape,
    lent_work,
    load_part,
    one_sphere,
    part_value,
    parts_near,
    workspace,
)
from solutions.fast.sdf_hit_kernels import ROUNDING, hit_part
from solutions.fast.sdf_shadow_kernels import ball, shadow

BITS = 4  # a lane's row and column in its tile are bits of its number
TILE = 1 << BITS  # pixels along a side
MANY = 10  # parts in a tile, above which it pays to cut it in four


@njit(**ENTRY)
def render(thread, threads, tape, depth, view, t_max, light, out_t, out_normal, out_visibility):
    """Fill one thread's tiles of the channels (H, W), (H, W, 3), (H, W) float32.

    `view` is (4, 3): the camera's position, the ray through the image's upper left corner, what it changes by
    from column to column and from row to row.
    """
    _tiles(thread, threads, tape, view, t_max, light, out_t, out_normal, out_visibility, _rooms(tape, depth))


@njit(**OPTIONS)
def _tiles(thread, threads, tape, view, t_max, light, out_t, out_normal, out_visibility, rooms):
    tape, view, light = lent_tape(tape), lent_rows(view), lent_rows(light)
    out_t, out_normal, out_visibility = lent_rows(out_t), lent_rows(out_normal), lent_rows(out_visibility)
    work, rows, lane, owner, seen, starts, near = rooms
    rooms = (
        lent_work(work), lent_rows(rows), lent_rows(lane), lent_rows(owner), lent_rows(seen), lent_rows(starts),
        lent_rows(near),
    )  # fmt: skip
    height, width = out_t.shape
    tiles_x, tiles_y = -(-width // TILE), -(-height // TILE)
    work, seen, near = rooms[0], rooms[4], rooms[6]
    x, y, z = view[0, 0], view[0, 1], view[0, 2]
    inside = False
    if parts_near(tape, x, y, z, 0.0, work) > 0:
        inside = part_value(tape, work[3][0], x, y, z, work[0]) <= 0.0
    for tile in range(thread, tiles_x * tiles_y, threads):
        top, left = tile // tiles_x * TILE, tile % tiles_x * TILE
        bottom, right = min(top + TILE, height), min(left + TILE, width)
        count = 0 if inside else _parts_seen(tape, view, t_max, top, left, bottom, right, seen, near, work)
        bits = BITS if count <= MANY else BITS - 1
        for row in range(top, bottom, 1 << bits):
            for column in range(left, right, 1 << bits):
                _tile(
                    tape, view, inside, t_max, light, count, bits, row, column,
                    min(row + (1 << bits), bottom), min(column + (1 << bits), right),
                    out_t, out_normal, out_visibility, rooms,
                )  # fmt: skip


@njit(**OPTIONS)
def _rooms(tape, depth):
    """What one thread needs: work, rows, lanes, owners, and the parts that a tile sees with their distance."""
    parts = tape[3].shape[0] - 1
    return (
        workspace(tape[0], tape[3], depth), np.empty((32, BATCH), np.float32), np.empty((4, BATCH), np.int32),
        np.empty((2, BATCH), np.int32), np.empty(parts, np.int64), np.empty(parts + 2, np.int64),
        np.empty(parts, np.float64),
    )  # fmt: skip


@njit(**INLINE)
def _tile(tape, view, inside, t_max, light, count, bits, top, left, bottom, right, out_t, out_normal,
          out_visibility, rooms):  # fmt: skip
    """A tile of up to `1 << bits` pixels a side, that sees `count` parts; of a smaller one that is yet to be found out."""
    work, rows, lane, owner, seen, starts, near = rooms
    n = (bottom - top) << bits
    dx, dy, dz, t, on = rows[16], rows[17], rows[18], rows[19], owner[0]
    if inside:
        parts_near(tape, view[0, 0], view[0, 1], view[0, 2], 0.0, work)
        seen[0], count = work[3][0], 1
    elif bits < BITS:
        count = _parts_seen(tape, view, t_max, top, left, bottom, right, seen, near, work)
    if count > 0:
        _rays(view, top, left, bits, n, dx, dy, dz)
        for i in range(n):
            t[i], on[i] = np.float32(0.0 if inside else t_max), 0 if inside else -1
        if not inside:
            _hits(tape, view, top, left, bottom, right, count, n, seen, near, rows, lane[0], on, work)
        count = _gather(n, rows, on, seen, count, starts, owner[1], lane[1])
    if count < n:
        for row in range(top, bottom):
            for column in range(left, right):
                out_t[row, column], out_visibility[row, column] = np.inf, ZERO
                for axis in range(3):
                    out_normal[row, column, axis] = ZERO
    if count == 0:
        return
    px, py, pz, nx, ny, nz, arrives = rows[20], rows[21], rows[22], rows[23], rows[24], rows[25], rows[26]
    _normals(tape, view[0], count, owner[1], lane[1], rows, work)
    shadow(
        tape,
        view[0],
        light,
        px,
        py,
        pz,
        nx,
        ny,
        nz,
        owner[1],
        lane[1],
        bits,
        count,
        arrives,
        rows,
        lane[2],
        lane[3],
        work,
    )
    for i in range(count):
        pixel = lane[1, i]
        row, column = top + (pixel >> bits), left + (pixel & ((1 << bits) - 1))
        if column >= right:
            continue
        out_t[row, column], out_visibility[row, column] = t[pixel], arrives[i]
        out_normal[row, column, 0], out_normal[row, column, 1], out_normal[row, column, 2] = (
            nx[i],
            ny[i],
            nz[i],
        )


@njit(**OPTIONS)
def _rays(view, top, left, bits, n, dx, dy, dz):
    """Unit directions through the pixels' centres. Every row has all its pixels, also beyond the image's edge."""
    for i in range(n):
        column, row = left + (i & ((1 << bits) - 1)) + 0.5, top + (i >> bits) + 0.5
        x = view[1, 0] + column * view[2, 0] + row * view[3, 0]
        y = view[1, 1] + column * view[2, 1] + row * view[3, 1]
        z = view[1, 2] + column * view[2, 2] + row * view[3, 2]
        inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
        dx[i], dy[i], dz[i] = x * inverse, y * inverse, z * inverse


@njit(**OPTIONS)
def _corner(view, row, column):
    return (
        view[1, 0] + column * view[2, 0] + row * view[3, 0],
        view[1, 1] + column * view[2, 1] + row * view[3, 1],
        view[1, 2] + column * view[2, 2] + row * view[3, 2],
    )


@njit(**OPTIONS)
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(**OPTIONS)
def _parts_seen(tape, view, t_max, top, left, bottom, right, seen, near, work):
    """Parts whose boxes meet a tile's pyramid, roughly from front to back; their number."""
    op, number, start, box, node, leaf, unbounded = (
        tape[0],
        tape[1],
        tape[3],
        tape[4],
        tape[5],
        tape[6],
        tape[7],
    )
    todo = work[2]
    a, b = _corner(view, top, left), _corner(view, top, right)
    c, d = _corner(view, bottom, right), _corner(view, bottom, left)
    sides = (_cross(d, a), _cross(c, d), _cross(b, c), _cross(a, b))
    x, y, z = view[0, 0], view[0, 1], view[0, 2]
    count = NONE
    for part in range(unbounded):
        p = number[start[part]]
        if op[start[part]] == PLANE and start[part + 1] - start[part] == 1:
            # A half-space, seen from outside: some ray must go down.
            down = min(
                min(p[0] * a[0] + p[1] * a[1] + p[2] * a[2], p[0] * b[0] + p[1] * b[1] + p[2] * b[2]),
                min(p[0] * c[0] + p[1] * c[1] + p[2] * c[2], p[0] * d[0] + p[1] * d[1] + p[2] * d[2]),
            )
            if down >= 0.0:
                continue
        seen[count], near[count] = part, 0.0
        count += 1
    inner = node.shape[0] // 2
    todo[0], waiting = 0, 1
    while waiting > 0:
        waiting -= 1
        i = todo[waiting]
        if not _box_in_pyramid(node, i, sides, x, y, z) or distance_to_box(node, i, x, y, z) > t_max:
            continue
        if i < inner:
            first = 2 * i + 1
            swap = distance_to_box(node, first, x, y, z) > distance_to_box(node, first + 1, x, y, z)
            todo[waiting], todo[waiting + 1] = (first, first + 1) if swap else (first + 1, first)
            waiting += 2
            continue
        for part in range(leaf[i - inner], leaf[i - inner + 1]):
            if _box_in_pyramid(box, part, sides, x, y, z):
                seen[count], near[count] = part, distance_to_box(box, part, x, y, z)
                count += 1
    return count


@njit(**OPTIONS)
def _box_in_pyramid(box, i, sides, x, y, z):
    """Whether box `i` reaches the inner side of all four planes through the camera, of inward normals `sides`."""
    for side in sides:
        u, v, w = side
        most = (
            max(u * (box[i, 0] - x), u * (box[i, 3] - x))
            + max(v * (box[i, 1] - y), v * (box[i, 4] - y))
            + max(w * (box[i, 2] - z), w * (box[i, 5] - z))
        )
        if most < 0.0:
            return False
    return True


@njit(**OPTIONS)
def _hits(tape, view, top, left, bottom, right, count, n, seen, near, rows, lane, on, work):
    dx, dy, dz, t = rows[16], rows[17], rows[18], rows[19]
    ax, ay, az = _corner(view, 0.5 * (top + bottom), 0.5 * (left + right))
    length = np.sqrt(ax * ax + ay * ay + az * az)
    axis = (ax / length, ay / length, az / length)
    # Half the diagonal of a pixel, and the farthest corner of the tile, as seen at distance 1.
    step = np.sqrt(view[2, 0] ** 2 + view[2, 1] ** 2 + view[2, 2] ** 2)
    pixel, spread = 0.5 * step / length, 0.0
    for row, column in ((top, left), (top, right), (bottom, left), (bottom, right)):
        x, y, z = _corner(view, row, column)
        length = np.sqrt(x * x + y * y + z * z)
        spread = max(
            spread,
            np.sqrt((x / length - axis[0]) ** 2 + (y / length - axis[1]) ** 2 + (z / length - axis[2]) ** 2),
        )
    farthest = np.float64(t[0])
    for j in range(count):
        if near[j] <= farthest:
            hit_part(tape, seen[j], j, view[0], axis, spread, pixel, dx, dy, dz, n, t, on, rows, lane, work)
            if j + 1 < count and j % 4 == 3:
                most = ZERO
                for i in range(n):
                    most = max(most, t[i])
                farthest = np.float64(most)


@njit(**OPTIONS)
def _gather(n, rows, on, seen, count, start, owner, lane):
    """Hits, those of a part together: pixels in `lane`, parts in `owner`, positions in rows 20 to 22; their number.

    Positions are a rounding nearer to the camera than the surface, where flat solids have a normal too.
    """
    dx, dy, dz, t = rows[16], rows[17], rows[18], rows[19]
    others = NONE
    for i in range(n):
        others += on[i] != on[0]
    if others == 0:
        if on[0] < 0:
            return NONE
        for i in range(n):
            lane[i], owner[i] = i, seen[on[0]]
            s = t[i] * (ONE - ROUNDING)
            rows[20, i], rows[21, i], rows[22, i] = s * dx[i], s * dy[i], s * dz[i]
        return n
    for j in range(count + 1):
        start[j] = 0
    for i in range(n):
        if on[i] >= 0:
            start[on[i] + 1] += 1
    for j in range(count):
        start[j + 1] += start[j]
    hits = start[count]
    for i in range(n):
        if on[i] >= 0:
            j = start[on[i]]
            start[on[i]] += 1
            lane[j], owner[j] = i, seen[on[i]]
            s = t[i] * (ONE - ROUNDING)
            rows[20, j], rows[21, j], rows[22, j] = s * dx[i], s * dy[i], s * dz[i]
    return hits


@njit(**OPTIONS)
def _normals(tape, camera, n, owner, lane, rows, work):
    """Unit gradients at hits into rows 23 to 25, of each part's own field; towards the camera where there is none."""
    begin = NONE
    while begin < n:
        part, end = np.int64(owner[begin]), begin + 1
        while end < n and owner[end] == part:
            end += 1
        x, y, z = rows[20, begin:end], rows[21, begin:end], rows[22, begin:end]
        middle_x, middle_y, middle_z, radius = 0.0, 0.0, 0.0, np.inf
        if tape[3][part + 1] - tape[3][part] > 3:
            middle_x, middle_y, middle_z, radius = ball(x, y, z, end - begin)
        m = load_part(
            tape, part, camera[0] + middle_x, camera[1] + middle_y, camera[2] + middle_z, radius,
            camera[0], camera[1], camera[2], work, NONE,
        )  # fmt: skip
        gradients(work[5], work[6], m, x, y, z, end - begin, work[7])
        nx, ny, nz, out = rows[23, begin:end], rows[24, begin:end], rows[25, begin:end], work[7][0]
        for i in range(end - begin):
            a, b, c = out[1, i], out[2, i], out[3, i]
            square = a * a + b * b + c * c
            inverse = ONE / np.sqrt(square) if square > ZERO else ZERO
            nx[i], ny[i], nz[i] = a * inverse, b * inverse, c * inverse
        for i in range(end - begin):
            if nx[i] == ZERO and ny[i] == ZERO and nz[i] == ZERO:
                j = lane[begin + i]
                nx[i], ny[i], nz[i] = -rows[16, j], -rows[17, j], -rows[18, j]
        begin = end


def warm():
    """Compile the kernel that `render_sdf` calls."""
    tape, depth = one_sphere()
    view = np.array([[0.0, 0.0, 3.0], [-0.5, 0.5, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    light = np.array([0.0, 1.0, 0.0, 8.0, 0.005, 0.02, 12.0])
    t, normal, visibility = (np.empty(shape, np.float32) for shape in ((1, 1), (1, 1, 3), (1, 1)))
    render(0, 1, tape, depth, view, 40.0, light, t, normal, visibility)
