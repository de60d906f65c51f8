"""The compiled search for triangles that cross: boxes enclosed two by two, descended pair by pair, and exact signs.

It yields the pairs that cross, and the few that it cannot decide; `inertia.mesh.geometry.intersect` says how it is
used, `inertia.mesh.geometry.triangle_pairs` what a crossing is. Two triangles with one corner in common are mostly told
apart by a plane through it. Floating point decides the remaining signs where its error bound allows; where it does
not, a line in a projection may separate the triangles, and else the determinant is expanded into a sum of
floating-point numbers without any rounding, which is distilled until its sign shows (T. Ogita, S. M. Rump and S. Oishi,
"Accurate sum and dot product", SIAM Journal on Scientific Computing 26 (2005) 1955, algorithm 4.3).

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

EPSILON = 2.0**-53
ORIENT3D = (7 + 56 * EPSILON) * EPSILON  # as in `triangle_pairs`
ORIENT2D = (3 + 16 * EPSILON) * EPSILON  # Shewchuk's first stage of ORIENT2D
SIDE = 8 * EPSILON  # more than the rounding of three differences, their products and sums
UNDERFLOW = 2.0**-1000
SMALLEST = 2.0**-280  # products of three such numbers, and what they are rounded by, are normal numbers
SPLITTER = 2.0**27 + 1
UNSURE = 2
PASSES = 64
TERMS = 192  # of a determinant of differences in two parts each


@njit(error_model="numpy", forceinline=True)
def spread(cell):
    """Spread the bits of a number below 2^21, two free places after each."""
    cell = (cell | cell << np.uint64(32)) & np.uint64(0x1F00000000FFFF)
    cell = (cell | cell << np.uint64(16)) & np.uint64(0x1F0000FF0000FF)
    cell = (cell | cell << np.uint64(8)) & np.uint64(0x100F00F00F00F00F)
    cell = (cell | cell << np.uint64(4)) & np.uint64(0x10C30C30C30C30C3)
    return (cell | cell << np.uint64(2)) & np.uint64(0x1249249249249249)


def morton_codes(vertices_at, vertices, faces_at, count, cells, box_at, codes_at):
    """Write the least and greatest coordinates, and for each triangle its box's place along a Z-order curve."""
    points = carray(vertices_at, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    box = carray(box_at, (2, 3), np.float64)
    codes = carray(codes_at, (count,), np.uint64)
    for axis in range(3):
        low = high = points[faces[0, 0], axis]
        for k in range(count):
            a, b, c = points[faces[k, 0], axis], points[faces[k, 1], axis], points[faces[k, 2], axis]
            low = min(low, a, b, c)
            high = max(high, a, b, c)
        box[0, axis], box[1, axis] = low, high
    x, y, z = box[0, 0], box[0, 1], box[0, 2]
    extent = max(box[1, 0] - x, box[1, 1] - y, box[1, 2] - z)
    factor = cells / extent if extent > 1e-300 else 0.0
    for k in range(count):
        code = np.uint64(0)
        for axis in range(3):
            a, b, c = points[faces[k, 0], axis], points[faces[k, 1], axis], points[faces[k, 2], axis]
            centre = 0.5 * min(a, b, c) + 0.5 * max(a, b, c)
            code |= spread(np.uint64((centre - box[0, axis]) * factor)) << np.uint64(axis)
        codes[k] = code
    return 0


def enclose(vertices_at, vertices, faces_at, order_at, count, x, y, z, scale, own_at, boxes_at):
    """Copy the triangles in order, multiplied by a power of two, and enclose them in boxes, level by level.

    The boxes are float32, about (x, y, z): rounding never changes an order, so that boxes that overlap still meet.
    Returns 1 where the multiplication is not exact.
    """
    points = carray(vertices_at, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    order = carray(order_at, (count,), np.int64)
    own = carray(own_at, (count, 9), np.float64)
    boxes = carray(boxes_at, (2 * count + 64, 6), np.float32)
    back = 1.0 / scale
    for k in range(count):
        for corner in range(3):
            point = faces[order[k], corner]
            for axis in range(3):
                value = points[point, axis] * scale
                if value * back != points[point, axis]:
                    return 1
                own[k, 3 * corner + axis] = value
        for axis in range(3):
            origin = x if axis == 0 else (y if axis == 1 else z)
            a, b, c = own[k, axis], own[k, axis + 3], own[k, axis + 6]
            boxes[k, axis] = np.float32(min(a, b, c) - origin)
            boxes[k, axis + 3] = np.float32(max(a, b, c) - origin)
    start, size = 0, count
    while size > 1:
        above = start + size
        half = (size + 1) // 2
        for k in range(half):
            one = start + 2 * k
            other = min(one + 1, above - 1)
            for axis in range(3):
                boxes[above + k, axis] = min(boxes[one, axis], boxes[other, axis])
                boxes[above + k, axis + 3] = max(boxes[one, axis + 3], boxes[other, axis + 3])
        start, size = above, half
    return 0


@njit(error_model="numpy", forceinline=True)
def two_sum(a, b):
    """Return a + b and what rounding took from it."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


@njit(error_model="numpy", forceinline=True)
def two_product(a, b):
    """Return a·b and what rounding took from it (T. J. Dekker)."""
    p = a * b
    t = SPLITTER * a
    ah = t - (t - a)
    al = a - ah
    t = SPLITTER * b
    bh = t - (t - b)
    bl = b - bh
    return p, al * bl - (((p - ah * bh) - al * bh) - ah * bl)


@njit(error_model="numpy", forceinline=True)
def distilled(terms, count):
    """Return the sign of the exact sum of `count` terms; `UNSURE` where one is no number."""
    for _ in range(PASSES):
        rest = 0.0
        left = 0
        total = 0.0
        for k in range(count):
            total, error = two_sum(total, terms[k])
            if error != 0.0:
                terms[left] = error
                left += 1
                rest += abs(error)
        if abs(total) > 2 * rest:
            return 1 if total > 0 else -1
        if left == 0:
            return 0
        if left == count:  # the first term leaves an error only where it is no number
            return UNSURE
        terms[left] = total
        count = left + 1
    return UNSURE


@njit(error_model="numpy", forceinline=True)
def exact_sign(own, a, i, b, j, c, k, d, l, work):
    """Return the sign of the determinant of corners i, j, k, l of triangles a, b, c, d without any rounding.

    `UNSURE` where products would leave the normal numbers.
    """
    # Differences in two parts: u, v, w, the high parts of the three axes before the low ones.
    parts, terms = work[:18], work[18:]
    low = 0.0
    for axis in range(3):
        origin = own[a, 3 * i + axis]
        for point in range(3):
            if point == 0:
                value = own[b, 3 * j + axis]
            elif point == 1:
                value = own[c, 3 * k + axis]
            else:
                value = own[d, 3 * l + axis]
            high, error = two_sum(value, -origin)
            parts[6 * point + axis] = high
            parts[6 * point + 3 + axis] = error
            low = max(low, abs(error))
            if (high != 0.0 and abs(high) < SMALLEST) or (error != 0.0 and abs(error) < SMALLEST):
                return UNSURE
    halves = 1 if low == 0.0 else 2
    count = 0
    for axis in range(3):
        for turn in range(2):
            y, z = (axis + 1 + turn) % 3, (axis + 2 - turn) % 3
            sign = 1.0 - 2.0 * turn
            for p in range(halves):
                for q in range(halves):
                    high, error = two_product(parts[3 * p + y], sign * parts[6 + 3 * q + z])
                    for r in range(halves):
                        factor = parts[12 + 3 * r + axis]
                        if factor != 0.0:
                            terms[count], terms[count + 1] = two_product(high, factor)
                            terms[count + 2], terms[count + 3] = two_product(error, factor)
                            count += 4
    return distilled(terms, count)


@njit(error_model="numpy", forceinline=True)
def filtered(determinant, size, wx, wy, wz):
    """Return the sign of a determinant where floating point decides it; `size` is the sum with positive products."""
    bound = ORIENT3D * size + UNDERFLOW * (1 + (abs(wx) + abs(wy) + abs(wz)))
    if abs(determinant) > bound:
        return 1 if determinant > 0 else -1
    return UNSURE


@njit(error_model="numpy", forceinline=True)
def sides(own, plane, triangle, shared, signs, at):
    """Write on which sides of a triangle's plane the corners of another lie; those that are shared lie in it."""
    ax, ay, az = own[plane, 0], own[plane, 1], own[plane, 2]
    ux, uy, uz = own[plane, 3] - ax, own[plane, 4] - ay, own[plane, 5] - az
    vx, vy, vz = own[plane, 6] - ax, own[plane, 7] - ay, own[plane, 8] - az
    px, qx = uy * vz, uz * vy
    py, qy = uz * vx, ux * vz
    pz, qz = ux * vy, uy * vx
    nx, ny, nz = px - qx, py - qy, pz - qz
    mx, my, mz = abs(px) + abs(qx), abs(py) + abs(qy), abs(pz) + abs(qz)
    for k in range(3):
        if shared & (1 << k):
            signs[at + k] = 0
            continue
        wx, wy, wz = own[triangle, 3 * k] - ax, own[triangle, 3 * k + 1] - ay, own[triangle, 3 * k + 2] - az
        size = abs(wx) * mx + abs(wy) * my + abs(wz) * mz
        signs[at + k] = filtered(wx * nx + wy * ny + wz * nz, size, wx, wy, wz)


@njit(error_model="numpy", forceinline=True)
def orient(own, a, i, b, j, c, k, d, l):
    """Return what `exact_sign` does, where floating point decides it."""
    ax, ay, az = own[a, 3 * i], own[a, 3 * i + 1], own[a, 3 * i + 2]
    ux, uy, uz = own[b, 3 * j] - ax, own[b, 3 * j + 1] - ay, own[b, 3 * j + 2] - az
    vx, vy, vz = own[c, 3 * k] - ax, own[c, 3 * k + 1] - ay, own[c, 3 * k + 2] - az
    wx, wy, wz = own[d, 3 * l] - ax, own[d, 3 * l + 1] - ay, own[d, 3 * l + 2] - az
    px, qx = uy * vz, uz * vy
    py, qy = uz * vx, ux * vz
    pz, qz = ux * vy, uy * vx
    size = abs(wx) * (abs(px) + abs(qx)) + abs(wy) * (abs(py) + abs(qy)) + abs(wz) * (abs(pz) + abs(qz))
    return filtered(wx * (px - qx) + wy * (py - qy) + wz * (pz - qz), size, wx, wy, wz)


@njit(error_model="numpy", forceinline=True)
def apart_at(own, one, i, other, j):
    """Say whether a plane through the corner that two triangles share has them on different sides."""
    nx = ny = nz = 0.0
    for which in range(2):
        triangle, corner = (one, i) if which == 0 else (other, j)
        sign = 1.0 if which == 0 else -1.0
        for step in range(1, 3):
            at = 3 * ((corner + step) % 3)
            nx += sign * (own[triangle, at] - own[one, 3 * i])
            ny += sign * (own[triangle, at + 1] - own[one, 3 * i + 1])
            nz += sign * (own[triangle, at + 2] - own[one, 3 * i + 2])
    for which in range(2):
        triangle, corner = (one, i) if which == 0 else (other, j)
        sign = 1.0 if which == 0 else -1.0
        for step in range(1, 3):
            at = 3 * ((corner + step) % 3)
            x = nx * (own[triangle, at] - own[one, 3 * i])
            y = ny * (own[triangle, at + 1] - own[one, 3 * i + 1])
            z = nz * (own[triangle, at + 2] - own[one, 3 * i + 2])
            if not sign * (x + y + z) > SIDE * (abs(x) + abs(y) + abs(z)) + UNDERFLOW:
                return False
    return True


@njit(error_model="numpy", forceinline=True)
def turn(own, a, i, b, j, c, k, x, y):
    """Return the sign of the turn a → b → c in the projection on axes x and y, where floating point decides it."""
    ax, ay = own[a, 3 * i + x], own[a, 3 * i + y]
    bx, by = own[b, 3 * j + x], own[b, 3 * j + y]
    cx, cy = own[c, 3 * k + x], own[c, 3 * k + y]
    if (ax == cx and ay == cy) or (bx == cx and by == cy):
        return 0
    p, q = (ax - cx) * (by - cy), (ay - cy) * (bx - cx)
    if abs(p - q) > ORIENT2D * (abs(p) + abs(q)) + UNDERFLOW:
        return 1 if p > q else -1
    return UNSURE


@njit(error_model="numpy", forceinline=True)
def apart_in_projection(own, one, other):
    """Say whether the line along an edge of one of two triangles separates them, seen along an axis."""
    axis, largest = 0, -1.0
    for k in range(3):
        y, z = (k + 1) % 3, (k + 2) % 3
        p = (own[one, 3 + y] - own[one, y]) * (own[one, 6 + z] - own[one, z])
        q = (own[one, 3 + z] - own[one, z]) * (own[one, 6 + y] - own[one, y])
        if abs(p - q) > largest:
            axis, largest = k, abs(p - q)
    x, y = (axis + 1) % 3, (axis + 2) % 3
    for which in range(2):
        a, b = (one, other) if which == 0 else (other, one)
        for k in range(3):
            own_side = turn(own, a, k, a, (k + 1) % 3, a, (k + 2) % 3, x, y)
            if own_side == 0 or own_side == UNSURE:
                continue
            beyond = True
            for corner in range(3):
                side = turn(own, a, k, a, (k + 1) % 3, b, corner, x, y)
                if side in (UNSURE, own_side):
                    beyond = False
                    break
            if beyond:
                return True
    return False


@njit(error_model="numpy", forceinline=True)
def straddle(signs, at):
    """Say whether signs of either kind are, or may be, among three."""
    above = below = False
    for k in range(at, at + 3):
        above |= signs[k] > 0
        below |= signs[k] < 0 or signs[k] == UNSURE
    return above and below


@njit(error_model="numpy", forceinline=True)
def lone(signs, at):
    """Return the corner that is alone on its side."""
    for k in range(2):
        sign = signs[at + k]
        if sign != 0 and sign * signs[at + (k + 1) % 3] <= 0 and sign * signs[at + (k + 2) % 3] <= 0:
            return k
    return 2


@njit(error_model="numpy", forceinline=True)
def cross(own, one, other, signs, work):
    """Say whether two triangles cross: 0, 1, or `UNSURE`."""
    for axis in range(3):
        p, q, r = own[one, axis], own[one, axis + 3], own[one, axis + 6]
        x, y, z = own[other, axis], own[other, axis + 3], own[other, axis + 6]
        if not (min(p, q, r) < max(x, y, z) and min(x, y, z) < max(p, q, r)):
            return 0
    in_one = in_other = 0  # the corners that both have, a bit each
    count = 0
    i = j = 0
    for k in range(3):
        for l in range(3):
            if (
                own[one, 3 * k] == own[other, 3 * l]
                and own[one, 3 * k + 1] == own[other, 3 * l + 1]
                and own[one, 3 * k + 2] == own[other, 3 * l + 2]
            ):
                in_one |= 1 << k
                in_other |= 1 << l
                count += 1
                i, j = k, l
    if count > 1:
        return 0
    if count == 1 and apart_at(own, one, i, other, j):
        return 0
    sides(own, other, one, in_one, signs, 0)
    if not straddle(signs, 0):
        return 0
    sides(own, one, other, in_other, signs, 3)
    if not straddle(signs, 3):
        return 0
    unsure = False
    for k in range(6):
        unsure |= signs[k] == UNSURE
    if unsure and apart_in_projection(own, one, other):
        return 0
    a0 = a1 = a2 = b0 = b1 = b2 = 0
    for query in range(8):
        if query < 6:
            sign = signs[query]
            a, b, c, d = (other, other, other, one) if query < 3 else (one, one, one, other)
            i, j, k, l = 0, 1, 2, query % 3
        elif query == 6:
            a, b, c, d = one, one, other, other
            i, j, k, l = a0, a1, b0, b1
            sign = orient(own, a, i, b, j, c, k, d, l)
        else:
            i, j, k, l = a0, a2, b2, b0
            sign = orient(own, a, i, b, j, c, k, d, l)
        if sign == UNSURE:
            sign = exact_sign(own, a, i, b, j, c, k, d, l, work)
            if sign == UNSURE:
                return UNSURE
        if query > 5:
            if sign >= 0:
                return 0
            continue
        signs[query] = sign
        if query % 3 == 2 and not straddle(signs, query - 2):
            return 0
        if query == 5:
            # Seen from either plane, let the corner that is alone on its side be above.
            a0, b0 = lone(signs, 0), lone(signs, 3)
            a1, a2, b1, b2 = (a0 + 1) % 3, (a0 + 2) % 3, (b0 + 1) % 3, (b0 + 2) % 3
            if signs[3 + b0] < 0:
                a1, a2 = a2, a1
            if signs[a0] < 0:
                b1, b2 = b2, b1
    return 1


def find_crossings(
    own_at, boxes_at, order_at, labels_at, count, work_at, stack_at, starts_at, pairs_at, room, steps, state_at
):
    """Descend for at most `steps` pairs of boxes, or until no room for 4 more pairs of triangles is left.

    Triangles of different labels, in the order of their numbers, are not compared.
    `stack` holds (level, one, other) still to be opened; the boxes of a level begin at `starts`; `state` is (how many
    pairs of boxes wait, pairs written, the last triangle looked at), and then six signs.
    """
    own = carray(own_at, (count, 9), np.float64)
    boxes = carray(boxes_at, (2 * count + 64, 6), np.float32)
    order, labels = carray(order_at, (count,), np.int64), carray(labels_at, (count,), np.int64)
    work = carray(work_at, (18 + TERMS,), np.float64)
    stack = carray(stack_at, (256, 3), np.int64)
    starts = carray(starts_at, (64,), np.int64)
    pairs = carray(pairs_at, (room, 2), np.int64)
    state = carray(state_at, (9,), np.int64)
    signs = state[3:]
    waiting = state[0]
    written = 0
    while waiting > 0 and written + 4 <= room and steps > 0:
        steps -= 1
        waiting -= 1
        level, i, j = stack[waiting, 0], stack[waiting, 1], stack[waiting, 2]
        state[2] = i << level
        start = starts[level - 1]
        size = starts[level] - start
        # The last to be put there is the first to be opened.
        for k in range(3, -1, -1):
            a, b = 2 * i + (k >> 1), 2 * j + (k & 1)
            if a > b or a >= size or b >= size:
                continue
            p, q = start + a, start + b
            if a == b or (
                boxes[p, 0] <= boxes[q, 3]
                and boxes[q, 0] <= boxes[p, 3]
                and boxes[p, 1] <= boxes[q, 4]
                and boxes[q, 1] <= boxes[p, 4]
                and boxes[p, 2] <= boxes[q, 5]
                and boxes[q, 2] <= boxes[p, 5]
            ):
                if level > 1:
                    stack[waiting, 0], stack[waiting, 1], stack[waiting, 2] = level - 1, a, b
                    waiting += 1
                elif a != b and labels[order[a]] == labels[order[b]] and cross(own, a, b, signs, work) != 0:
                    pairs[written, 0] = min(order[a], order[b])
                    pairs[written, 1] = max(order[a], order[b])
                    written += 1
    state[0] = waiting
    state[1] = written
    return 0
