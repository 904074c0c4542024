"""The compiled half of `framework.tape`: values and gradients over batches of points, and pruning.

Batches are rows of at most 256 float32 numbers, one row per coordinate: every loop over them vectorises, and a
program's rows stay in the first-level cache. Coordinates are relative to an origin near the points, subtracted
in float64, so that neither the place nor the size of a scene costs digits.
"""

import numpy as np
from numba import njit
from numba.core import cgutils
from numba.extending import intrinsic

# What an instruction does. Up to CAPSULE a solid is convex and a ray's hit has a closed form.
PLANE, SPHERE, BOX, ROTATED_BOX, CAPSULE, TORUS, UNION, INTERSECTION, SUBTRACTION, SMOOTH_UNION, BLEND = (
    range(11)
)

WIDTH = 16  # numbers an instruction has
BATCH = 256
# For what Python or another module calls: compiled once, and linked to wherever it is called.
ENTRY = {"nogil": True, "error_model": "numpy", "fastmath": {"nsz", "arcp", "contract", "afn"}, "cache": True}
# For what its module alone calls: no code that Python could call it by, which takes longer to compile than many a function.
OPTIONS = ENTRY | {"cache": False, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
INLINE = OPTIONS | {"inline": "always"}  # for what has one caller: LLVM then meets it once, not once a level
NONE = np.int64(0)  # a count's start; a literal 0 would have its callees compiled twice

# Of float32, so that they never widen what they meet.
ZERO, HALF, ONE, TWO = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(2.0)


# Numba counts the references to an array, with an atomic addition wherever one is passed on: in a picture of many parts
# that took half of the time, more where threads share the arrays. What is lent is not counted, so its owner must
# live on: lend in a function what its caller holds.


@intrinsic
def _lent(typing_context, array):
    def build(context, builder, signature, arguments):
        lent = context.make_array(array)(context, builder, arguments[0])
        lent.meminfo = cgutils.get_null_value(lent.meminfo.type)
        return lent._getvalue()

    return array(array), build


@njit(**OPTIONS)
def lent_tape(tape):
    return (
        _lent(tape[0]), _lent(tape[1]), _lent(tape[2]), _lent(tape[3]), _lent(tape[4]), _lent(tape[5]), _lent(tape[6]),  # type: ignore[call-arg]
        tape[7],
    )  # fmt: skip


@njit(**OPTIONS)
def lent_work(work):
    return (
        _lent(work[0]), _lent(work[1]), _lent(work[2]), _lent(work[3]), _lent(work[4]), _lent(work[5]), _lent(work[6]),  # type: ignore[call-arg]
        _lent(work[7]),  # type: ignore[call-arg]
    )  # fmt: skip


@njit(**OPTIONS)
def lent_rows(rows):
    return _lent(rows)  # type: ignore[call-arg]


# Primitives: value and gradient at one point, in float32 or float64. What a caller does not use costs nothing.


@njit(**OPTIONS)
def _plane(x, y, z, nx, ny, nz, offset):
    return nx * x + ny * y + nz * z - offset, nx, ny, nz


@njit(**OPTIONS)
def _sphere(x, y, z, radius):
    length = np.sqrt(x * x + y * y + z * z)
    inverse = ONE / length if length > ZERO else ZERO
    return length - radius, x * inverse, y * inverse, z * inverse


@njit(**OPTIONS)
def _box(x, y, z, hx, hy, hz):
    qx, qy, qz = abs(x) - hx, abs(y) - hy, abs(z) - hz
    most = max(max(qx, qy), qz)
    ox, oy, oz = max(qx, ZERO), max(qy, ZERO), max(qz, ZERO)
    length = np.sqrt(ox * ox + oy * oy + oz * oz)
    outside = most > ZERO
    inverse = ONE / length if outside else ONE
    gx = ox if outside else (ONE if qx == most else ZERO)
    gy = oy if outside else (ONE if qy == most and qx != most else ZERO)
    gz = oz if outside else (ONE if qz == most and qx != most and qy != most else ZERO)
    gx, gy, gz = gx * inverse, gy * inverse, gz * inverse
    return (
        length + min(most, ZERO),
        gx if x > ZERO else -gx,
        gy if y > ZERO else -gy,
        gz if z > ZERO else -gz,
    )


@njit(**OPTIONS)
def _rotated_box(x, y, z, hx, hy, hz, m00, m01, m02, m10, m11, m12, m20, m21, m22):
    value, gx, gy, gz = _box(
        m00 * x + m01 * y + m02 * z, m10 * x + m11 * y + m12 * z, m20 * x + m21 * y + m22 * z, hx, hy, hz
    )
    return (
        value,
        m00 * gx + m10 * gy + m20 * gz,
        m01 * gx + m11 * gy + m21 * gz,
        m02 * gx + m12 * gy + m22 * gz,
    )


@njit(**OPTIONS)
def _capsule(x, y, z, radius, ux, uy, uz, length):
    along = min(max(x * ux + y * uy + z * uz, ZERO), length)
    return _sphere(x - along * ux, y - along * uy, z - along * uz, radius)


@njit(**OPTIONS)
def _torus(x, y, z, minor, ax, ay, az, major):
    height = x * ax + y * ay + z * az
    x, y, z = x - height * ax, y - height * ay, z - height * az
    across = np.sqrt(x * x + y * y + z * z)
    outward = across - major
    length = np.sqrt(outward * outward + height * height)
    inverse = ONE / length if length > ZERO else ZERO
    e = outward * inverse / across if across > ZERO else ZERO
    h = height * inverse
    return length - minor, e * x + h * ax, e * y + h * ay, e * z + h * az


# Operators: value of both, and the weights of the two gradients.


@njit(**OPTIONS)
def _combine(op, a, b, k):
    if op == UNION:
        first = a <= b
        return (a if first else b), (ONE if first else ZERO), (ZERO if first else ONE)
    if op == INTERSECTION:
        first = a >= b
        return (a if first else b), (ONE if first else ZERO), (ZERO if first else ONE)
    if op == SUBTRACTION:
        first = a >= -b
        return (a if first else -b), (ONE if first else ZERO), (ZERO if first else -ONE)
    if op == SMOOTH_UNION:
        overlap = max(k - abs(a - b), ZERO)
        weight = HALF * overlap / k
        first = a <= b
        value = min(a, b) - HALF * weight * overlap
        return value, (ONE - weight if first else weight), (weight if first else ONE - weight)
    return (ONE - k) * a + k * b, ONE - k, k


@njit(**OPTIONS)
def _leaf(op, number, j, x, y, z):
    """Value of primitive `j` at one point."""
    p = number[j]
    if op == PLANE:
        return _plane(x, y, z, p[0], p[1], p[2], p[3])[0]
    x, y, z = x - p[0], y - p[1], z - p[2]
    if op == SPHERE:
        return _sphere(x, y, z, p[3])[0]
    if op == BOX:
        return _box(x, y, z, p[3], p[4], p[5])[0]
    if op == ROTATED_BOX:
        return _rotated_box(
            x, y, z, p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12], p[13], p[14]
        )[0]
    if op == CAPSULE:
        return _capsule(x, y, z, p[3], p[4], p[5], p[6], p[7])[0]
    return _torus(x, y, z, p[3], p[4], p[5], p[6], p[7])[0]


# Batches: a program over rows of points. Results are in `stack[0]`: the value, then the gradient.


@njit(**ENTRY)
def values(op, number, length, x, y, z, n, stack):
    """Values of a local program at points (n,) into `stack[0, 0, :n]`; `stack` is (depth, 4, 256) float32."""
    top = -1
    for j in range(length):
        code, p = op[j], number[j]
        if code > TORUS:
            top -= 1
            _combine_values(code, p[0], stack[top, 0], stack[top + 1, 0], n)
        else:
            top += 1
            _leaf_values(code, p, x, y, z, n, stack[top, 0])


@njit(**INLINE)
def _leaf_values(code, p, x, y, z, n, out):
    cx, cy, cz, r, a, b, c, d = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
    if code == PLANE:
        for i in range(n):
            out[i] = _plane(x[i], y[i], z[i], cx, cy, cz, r)[0]
    elif code == SPHERE:
        for i in range(n):
            out[i] = _sphere(x[i] - cx, y[i] - cy, z[i] - cz, r)[0]
    elif code == BOX:
        for i in range(n):
            out[i] = _box(x[i] - cx, y[i] - cy, z[i] - cz, r, a, b)[0]
    elif code == CAPSULE:
        for i in range(n):
            out[i] = _capsule(x[i] - cx, y[i] - cy, z[i] - cz, r, a, b, c, d)[0]
    elif code == TORUS:
        for i in range(n):
            out[i] = _torus(x[i] - cx, y[i] - cy, z[i] - cz, r, a, b, c, d)[0]
    else:
        e, f, g, h, k, l, m = p[8], p[9], p[10], p[11], p[12], p[13], p[14]
        for i in range(n):
            out[i] = _rotated_box(
                x[i] - cx, y[i] - cy, z[i] - cz, r, a, b, c, d, e, f, g, h, k, l, m
            )[0]  # fmt: skip


@njit(**INLINE)
def _combine_values(code, k, a, b, n):
    if code == UNION:
        for i in range(n):
            a[i] = min(a[i], b[i])
    elif code == INTERSECTION:
        for i in range(n):
            a[i] = max(a[i], b[i])
    elif code == SUBTRACTION:
        for i in range(n):
            a[i] = max(a[i], -b[i])
    elif code == SMOOTH_UNION:
        for i in range(n):
            a[i] = _combine(SMOOTH_UNION, a[i], b[i], k)[0]
    else:
        for i in range(n):
            a[i] = (ONE - k) * a[i] + k * b[i]


@njit(**ENTRY)
def gradients(op, number, length, x, y, z, n, stack):
    """As `values`, with the gradient, not normalised, in `stack[0, 1:, :n]`."""
    top = -1
    for j in range(length):
        code, p = op[j], number[j]
        if code > TORUS:
            top -= 1
            first, second = stack[top], stack[top + 1]
            for i in range(n):
                value, u, v = _combine(code, first[0, i], second[0, i], p[0])
                first[0, i] = value
                for row in range(1, 4):
                    first[row, i] = u * first[row, i] + v * second[row, i]
        else:
            top += 1
            _leaf_gradients(code, p, x, y, z, n, stack[top])


@njit(**INLINE)
def _leaf_gradients(code, p, x, y, z, n, out):
    cx, cy, cz, r, a, b, c, d = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
    if code == PLANE:
        for i in range(n):
            out[0, i], out[1, i], out[2, i], out[3, i] = _plane(x[i], y[i], z[i], cx, cy, cz, r)
    elif code == SPHERE:
        for i in range(n):
            out[0, i], out[1, i], out[2, i], out[3, i] = _sphere(x[i] - cx, y[i] - cy, z[i] - cz, r)
    elif code == BOX:
        for i in range(n):
            out[0, i], out[1, i], out[2, i], out[3, i] = _box(x[i] - cx, y[i] - cy, z[i] - cz, r, a, b)
    elif code == CAPSULE:
        for i in range(n):
            out[0, i], out[1, i], out[2, i], out[3, i] = _capsule(
                x[i] - cx, y[i] - cy, z[i] - cz, r, a, b, c, d
            )
    elif code == TORUS:
        for i in range(n):
            out[0, i], out[1, i], out[2, i], out[3, i] = _torus(
                x[i] - cx, y[i] - cy, z[i] - cz, r, a, b, c, d
            )
    else:
        e, f, g, h, k, l, m = p[8], p[9], p[10], p[11], p[12], p[13], p[14]
        for i in range(n):
            out[0, i], out[1, i], out[2, i], out[3, i] = _rotated_box(
                x[i] - cx, y[i] - cy, z[i] - cz, r, a, b, c, d, e, f, g, h, k, l, m
            )


# Pruning: what of the tape matters in a ball. A value changes by at most R from its middle to its edge.


@njit(**ENTRY)
def workspace(op, start, depth):
    """Room for one thread: what the functions below take as `work`."""
    instructions, parts = op.shape[0], start.shape[0] - 1
    return (
        np.empty(instructions, np.float64),  # values of a part's instructions at the ball's middle
        np.empty(instructions, np.bool_),  # which of them are kept
        np.empty(instructions + 64, np.int64),  # a stack of instructions, or of nodes of the hierarchy
        np.empty(parts, np.int64),  # parts near the ball
        np.empty(parts, np.float64),  # and their values
        np.empty(2 * instructions, np.int32),  # the local program: codes
        np.empty((2 * instructions, WIDTH), np.float32),  # and numbers
        np.empty((depth + 1, 4, BATCH), np.float32),
    )


@njit(**ENTRY)
def part_value(tape, part, x, y, z, value):
    """Value of a part at one point, float64; leaves those of its instructions in `value`."""
    op, number, size, start = tape[0], tape[1], tape[2], tape[3]
    first, last = start[part], start[part + 1] - 1
    if first == last:
        value[0] = _leaf(op[first], number, first, x, y, z)
        return value[0]
    for j in range(first, last + 1):
        code, i = op[j], j - first
        if code > TORUS:
            value[i] = _combine(code, value[i - 1 - size[j - 1]], value[i - 1], number[j, 0])[0]
        else:
            value[i] = _leaf(code, number, j, x, y, z)
    return value[last - first]


@njit(**OPTIONS)
def distance_to_box(box, i, x, y, z):
    """Euclidean distance from a point to box `i` of `box` (B, 6); 0 inside."""
    dx = max(max(box[i, 0] - x, x - box[i, 3]), 0.0)
    dy = max(max(box[i, 1] - y, y - box[i, 4]), 0.0)
    dz = max(max(box[i, 2] - z, z - box[i, 5]), 0.0)
    return np.sqrt(dx * dx + dy * dy + dz * dz)


@njit(**ENTRY)
def parts_near(tape, x, y, z, radius, work):
    """The parts that can be the smallest somewhere in a ball: their number; they are in `work[3]`, values in `work[4]`."""
    box, node, leaf, unbounded = tape[4], tape[5], tape[6], tape[7]
    value, todo, found, found_value = work[0], work[2], work[3], work[4]
    best, count = np.inf, NONE
    for part in range(unbounded):
        v = part_value(tape, part, x, y, z, value)
        best = min(best, v)
        found[count], found_value[count] = part, v
        count += 1
    inner = node.shape[0] // 2
    todo[0], waiting = 0, 1
    while waiting > 0:
        waiting -= 1
        i = todo[waiting]
        if not distance_to_box(node, i, x, y, z) <= best + 2.0 * radius:
            continue
        if i < inner:
            left = 2 * i + 1
            nearer = distance_to_box(node, left, x, y, z) <= distance_to_box(node, left + 1, x, y, z)
            todo[waiting], todo[waiting + 1] = (left + 1, left) if nearer else (left, left + 1)
            waiting += 2
            continue
        for part in range(leaf[i - inner], leaf[i - inner + 1]):
            if distance_to_box(box, part, x, y, z) <= best + 2.0 * radius:
                v = part_value(tape, part, x, y, z, value)
                best = min(best, v)
                found[count], found_value[count] = part, v
                count += 1
    kept = 0
    for i in range(count):
        if found_value[i] <= best + 2.0 * radius:
            found[kept] = found[i]
            kept += 1
    return kept


@njit(**OPTIONS)
def _load(op, number, j, origin_x, origin_y, origin_z, local_op, local_number, m):
    """Copy instruction `j` to place `m` of a local program, relative to an origin."""
    code, p, out = op[j], number[j], local_number[m]
    local_op[m] = code
    for i in range(WIDTH):
        out[i] = p[i]
    if code == PLANE:
        out[3] = p[3] - (p[0] * origin_x + p[1] * origin_y + p[2] * origin_z)
    elif code <= TORUS:
        out[0], out[1], out[2] = p[0] - origin_x, p[1] - origin_y, p[2] - origin_z


@njit(**ENTRY)
def load_part(tape, part, x, y, z, radius, origin_x, origin_y, origin_z, work, m):
    """Append to the local program, at `m`, what of a part its value in a ball depends on; the new length."""
    op, number, size, start = tape[0], tape[1], tape[2], tape[3]
    value, keep, todo, local_op, local_number = work[0], work[1], work[2], work[5], work[6]
    first, last = start[part], start[part + 1] - 1
    if last - first < 3:
        for j in range(first, last + 1):
            _load(op, number, j, origin_x, origin_y, origin_z, local_op, local_number, m)
            m += 1
        return m
    part_value(tape, part, x, y, z, value)
    for j in range(last - first + 1):
        keep[j] = False
    todo[0], waiting = last, 1
    while waiting > 0:
        waiting -= 1
        j = todo[waiting]
        code = op[j]
        if code <= TORUS:
            keep[j - first] = True
            continue
        right, left = j - 1, j - 1 - size[j - 1]
        a, b = value[left - first], value[right - first]
        # Where the operands differ by more than this, one of them alone is the value.
        room = 2.0 * radius + (number[j, 0] if code == SMOOTH_UNION else 0.0)
        only_a = only_b = False
        if code == UNION or code == SMOOTH_UNION:
            only_a, only_b = b - a > room, a - b > room
        elif code == INTERSECTION:
            only_a, only_b = a - b > room, b - a > room
        elif code == SUBTRACTION:
            only_a = a + b > room
        keep[j - first] = not (only_a or only_b)
        if not only_b:
            todo[waiting] = left
            waiting += 1
        if not only_a:
            todo[waiting] = right
            waiting += 1
    for j in range(first, last + 1):
        if keep[j - first]:
            _load(op, number, j, origin_x, origin_y, origin_z, local_op, local_number, m)
            m += 1
    return m


@njit(**ENTRY)
def load_ball(tape, x, y, z, radius, work):
    """Make the local program of the whole scene in a ball, relative to the ball's middle; its length."""
    found, local_op = work[3], work[5]
    m = NONE
    for i in range(parts_near(tape, x, y, z, radius, work)):
        m = load_part(tape, found[i], x, y, z, radius, x, y, z, work, m)
        if i > 0:
            local_op[m] = UNION
            m += 1
    return m


@njit(**ENTRY)
def evaluate(tape, depth, points, out):
    """`framework.tape.Tape.__call__`: points (N, 3) float64, out (N,) float32."""
    work = workspace(tape[0], tape[3], depth)
    x, y, z = np.empty(BATCH, np.float32), np.empty(BATCH, np.float32), np.empty(BATCH, np.float32)
    total = points.shape[0]
    for begin in range(0, total, BATCH):
        n = min(BATCH, total - begin)
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for i in range(n):
            for axis in range(3):
                if np.isfinite(points[begin + i, axis]):
                    low[axis] = min(low[axis], points[begin + i, axis])
                    high[axis] = max(high[axis], points[begin + i, axis])
        a, b, c = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
        radius = 0.5 * np.sqrt((high[0] - low[0]) ** 2 + (high[1] - low[1]) ** 2 + (high[2] - low[2]) ** 2)
        for i in range(n):
            x[i], y[i], z[i] = points[begin + i, 0] - a, points[begin + i, 1] - b, points[begin + i, 2] - c
        m = load_ball(tape, a, b, c, radius, work)
        values(work[5], work[6], m, x, y, z, n, work[7])
        for i in range(n):
            out[begin + i] = work[7][0, 0, i] if m > 0 else np.float32(np.nan)


def one_sphere():
    """The arrays of a tape of one sphere, and its depth."""
    box, numbers = np.array([[-1.0, -1.0, -1.0, 1.0, 1.0, 1.0]]), np.zeros((1, WIDTH))
    numbers[0, 3] = 1.0
    code, one, ends = np.array([SPHERE], np.int32), np.ones(1, np.int64), np.array([0, 1])
    return (code, numbers, one, ends, box, box, ends, 0), 1


def warm():
    """Compile what `Tape` and other kernels call."""
    tape, depth = one_sphere()
    evaluate(tape, depth, np.zeros((1, 3)), np.empty(1, np.float32))
    work, point = workspace(tape[0], tape[3], depth), np.zeros(1, np.float32)
    parts_near(tape, 0.0, 0.0, 0.0, 0.0, work)
    load_part(tape, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, work, 0)
    part_value(tape, 0, 0.0, 0.0, 0.0, work[0])
    gradients(work[5], work[6], 1, point, point, point, 1, work[7])
