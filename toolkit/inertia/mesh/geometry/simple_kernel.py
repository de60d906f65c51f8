"""The compiled check of small surfaces: closed, in one piece, and free of triangles that cross; see `simple`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import functools

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.extending import intrinsic

from inertia.mesh.geometry.crossing_kernel import ORIENT3D, SIDE, SMALLEST, TERMS, UNDERFLOW, cross

MOST = 200_000
"""Triangles of a surface that there is room for."""

CORNERS = 3 * MOST
SLOTS = 2**21
GROUP = 16
"""Triangles, or such groups of them, whose boxes are compared with another one together; lanes of a vector loop."""

SIMPLE, PIECES, NO_VERTEX, NOT_USABLE, REPEATED, UNPAIRED, CROSSING, MANY = range(8)
"""What a surface is: the first, or in several pieces that do not cross, or what stands in the way."""

BLOCKS = MOST // GROUP + 2 * GROUP
"""Groups that there is room for. A block of each table has a row of `GROUP` numbers for each of its columns."""

CELLS = 16_000
"""Steps along each axis in which boxes are compared; twice as many and two fit into 16 bits."""

OUTSIDE = 2**15 - 1
BRICKS = 32
"""Cells along each axis by which triangles in no order are sorted; a power of two."""

SCATTERED = 256
"""Triangles that are near another one for nothing but their order, on average, before they are sorted."""

WORK = 18 + TERMS
ENOUGH = 4096
"""Pairs of triangles that are looked at together."""

IDLE, TESTED = 256, 64
"""Pairs whose boxes touch at most, for each triangle, of which others who look for crossings need none; of so many
pairs, one is tested for that."""

FILED = 32
"""Edges of a vertex that are looked through; of one with more, the rest are in a hash table."""

RECORD = 8
"""Numbers for each vertex: a direction and a bound, a normal and a bound (see `flatten_fans`)."""

# Places in the scratch space, in float64.
NORMALS = 9 * GROUP * BLOCKS
FANS = NORMALS + 4 * GROUP * BLOCKS
LANES = FANS + RECORD * (CORNERS // 2 + 8)
TURNS = LANES + 27 * GROUP
PAIRS = TURNS + CORNERS // 2 + 8
NEAR = PAIRS + ENOUGH + 2 * GROUP
TWO = NEAR + BLOCKS + ENOUGH + 8
SIGNS = TWO + 18 + WORK
BOXES = SIGNS + 8
GROUPS = BOXES + 6 * GROUP * BLOCKS // 4
HEAPS = GROUPS + 6 * BLOCKS // 4
FLAT = HEAPS + 6 * BLOCKS // 4
NUMBERS = FLAT + 3 * GROUP * BLOCKS // 2
DOUBLES = NUMBERS + (3 * (MOST + GROUP) + 3 * CORNERS + 2 * CORNERS + MOST + SLOTS) // 2 + 8
"""Numbers in the scratch space, of which little more is touched than the surfaces at hand need."""

SLANT_X, SLANT_Y = 0.8125, 0.5859375
STEEPEST = 1.4  # more than their sum

LARGEST = 1e75  # as `part.LARGEST`
PRIME_X, PRIME_Y, PRIME_Z = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xC2B2AE3D27D4EB4F), np.uint64(0x165667B19E3779F9)


def overlapping(builder, base, sides):
    """Return which of the `GROUP` boxes that begin at an address overlap one with these sides, as a vector."""
    row = ir.VectorType(ir.IntType(16), GROUP)
    low, high = [same(builder, side) for side in sides[:3]], [same(builder, side) for side in sides[3:]]
    meets = [builder.icmp_signed("<", load(builder, base, axis, row), high[axis]) for axis in range(3)]
    meets += [builder.icmp_signed("<", low[axis], load(builder, base, axis + 3, row)) for axis in range(3)]
    return functools.reduce(builder.and_, meets)


def same(builder, value, count=GROUP):
    """Return a vector of one number."""
    first = builder.insert_element(
        ir.Constant(ir.VectorType(value.type, count), ir.Undefined), value, ir.IntType(32)(0)
    )
    return builder.shuffle_vector(first, first, ir.Constant(ir.VectorType(ir.IntType(32), count), [0] * count))


def load(builder, base, k, row):
    """Return a vector of row k of a table of integers."""
    size = row.element.width // 8
    at = builder.gep(base, [ir.IntType(64)(size * GROUP * k)])
    return builder.load(builder.bitcast(at, row.as_pointer()), align=size)


@intrinsic
def meeting(context, base, lx, ly, lz, hx, hy, hz):
    """Return which of the `GROUP` boxes that begin at an address overlap another one, a bit each."""

    def code(context, builder, signature, arguments):
        base, *sides = arguments
        return builder.zext(builder.bitcast(overlapping(builder, base, sides), ir.IntType(GROUP)), ir.IntType(64))

    return types.int64(types.voidptr, *[types.int16] * 6), code


@intrinsic
def meeting_apart(context, base, lx, ly, lz, hx, hy, hz, flat, a, b, c):
    """Return what `meeting` does, of triangles none of whose corners, in rows at `flat`, is one of three."""

    def code(context, builder, signature, arguments):
        base, *sides, flat, a, b, c = arguments
        bits = builder.zext(builder.bitcast(overlapping(builder, base, sides), ir.IntType(GROUP)), ir.IntType(64))
        half, row = GROUP // 2, ir.VectorType(ir.IntType(32), GROUP // 2)
        mine = [same(builder, k, half) for k in (a, b, c)]
        for part in range(2):
            there = builder.gep(flat, [ir.IntType(64)(4 * half * part)])
            theirs = [load(builder, there, k, row) for k in range(3)]
            shared = functools.reduce(builder.or_, [builder.icmp_signed("==", k, l) for k in mine for l in theirs])
            apart = builder.not_(builder.zext(builder.bitcast(shared, ir.IntType(half)), ir.IntType(64)))
            lanes = ir.IntType(64)(~(((1 << half) - 1) << half * part))
            bits = builder.and_(bits, builder.or_(builder.shl(apart, ir.IntType(64)(half * part)), lanes))
        return bits

    return types.int64(types.voidptr, *[types.int16] * 6, types.voidptr, *[types.int32] * 3), code


@intrinsic
def write_cells(context, base, low, scale, to):
    """Write the first and last cell of `GROUP` triangles along an axis (see `fill_boxes`)."""

    def code(context, builder, signature, arguments):
        base, low, scale, to = arguments
        row, whole = ir.VectorType(ir.DoubleType(), 4), ir.VectorType(ir.IntType(32), 4)
        short = ir.VectorType(ir.IntType(16), 4)
        low, scale = (same(builder, value, 4) for value in (low, scale))
        one, two = ir.Constant(whole, [1] * 4), ir.Constant(whole, [2] * 4)
        for part in range(0, GROUP, 4):
            places = (builder.gep(base, [ir.IntType(64)(8 * (3 * k * GROUP + part))]) for k in range(3))
            a, b, c = (builder.load(builder.bitcast(place, row.as_pointer()), align=8) for place in places)
            least = builder.select(builder.fcmp_ordered("<", a, b), a, b)
            least = builder.select(builder.fcmp_ordered("<", least, c), least, c)
            most = builder.select(builder.fcmp_ordered(">", a, b), a, b)
            most = builder.select(builder.fcmp_ordered(">", most, c), most, c)
            flat = builder.zext(builder.fcmp_ordered("==", least, most), whole)
            cells = (builder.fptosi(builder.fmul(builder.fsub(x, low), scale), whole) for x in (least, most))
            first, last = (builder.shl(cell, one) for cell in cells)
            for k, cell in ((0, builder.add(first, flat)), (3, builder.sub(builder.add(last, two), flat))):
                at = builder.gep(to, [ir.IntType(64)(2 * (k * GROUP + part))])
                builder.store(builder.trunc(cell, short), builder.bitcast(at, short.as_pointer()), align=2)
        return context.get_dummy_value()

    return types.void(types.voidptr, types.float64, types.float64, types.voidptr), code


@intrinsic
def transpose(context, a, b, c, d, to):
    """Store the four float64 at each of four addresses as columns of rows `GROUP` long."""

    def code(context, builder, signature, arguments):
        *places, to = arguments
        row = ir.VectorType(ir.DoubleType(), 4)

        def mixed(one, other, order):
            return builder.shuffle_vector(one, other, ir.Constant(ir.VectorType(ir.IntType(32), 4), order))

        a, b, c, d = (builder.load(builder.bitcast(place, row.as_pointer()), align=8) for place in places)
        even, odd = [0, 4, 2, 6], [1, 5, 3, 7]
        p, q, r, s = mixed(a, b, even), mixed(a, b, odd), mixed(c, d, even), mixed(c, d, odd)
        first, last = [0, 1, 4, 5], [2, 3, 6, 7]
        for k, column in enumerate((mixed(p, r, first), mixed(q, s, first), mixed(p, r, last), mixed(q, s, last))):
            at = builder.gep(to, [ir.IntType(64)(8 * GROUP * k)])
            builder.store(column, builder.bitcast(at, row.as_pointer()), align=8)
        return context.get_dummy_value()

    return types.void(*[types.voidptr] * 5), code


@intrinsic
def lowest_bit(context, bits):
    """Return the number of the lowest bit that is set, 64 where none is."""

    def code(context, builder, signature, arguments):
        return builder.cttz(arguments[0], ir.IntType(1)(0))

    return types.int64(types.int64), code


@intrinsic
def count_bits(context, bits):
    """Return how many bits are set."""

    def code(context, builder, signature, arguments):
        return builder.ctpop(arguments[0])

    return types.int64(types.int64), code


@intrinsic
def address(context, base, offset):
    """Return the address `offset` bytes after `base`."""

    def code(context, builder, signature, arguments):
        return builder.gep(arguments[0], [arguments[1]])

    return types.voidptr(types.voidptr, types.int64), code


@njit(inline="always")
def block(k):
    """Return which block of `GROUP` a triangle or group is in; unsigned, which spares the test for numbers below 0."""
    return np.uint64(k) >> np.uint64(4)


@njit(inline="always")
def lane(k):
    """Return which of its block it is."""
    return np.uint64(k) & np.uint64(GROUP - 1)


@njit(inline="always")
def slot_of(bits, vertex):
    """Return a hash of a point; shifted by one bit, −0 is +0."""
    key = (bits[vertex, 0] << np.uint64(1)) * PRIME_X + (bits[vertex, 1] << np.uint64(1)) * PRIME_Y
    key += (bits[vertex, 2] << np.uint64(1)) * PRIME_Z
    return np.int64((key ^ (key >> np.uint64(29))) * PRIME_X >> np.uint64(40))


@njit(inline="always")
def all_distinct(points, bits, places, numbered, slots, room):
    """Say whether corners that are numbered in another mesh are usable points here, no two of them the same."""
    for k in range(room):
        slots[k] = -1
    for k in range(numbered):
        vertex = places[k]
        x, y, z = points[vertex, 0], points[vertex, 1], points[vertex, 2]
        if not (abs(x) <= LARGEST and abs(y) <= LARGEST and abs(z) <= LARGEST):
            return False
        slot = slot_of(bits, vertex) & (room - 1)
        while slots[slot] >= 0:
            other = slots[slot]
            if points[other, 0] == x and points[other, 1] == y and points[other, 2] == z:
                return False
            slot = (slot + 1) & (room - 1)
        slots[slot] = vertex
    return True


@njit(inline="always")
def number_corners(points, bits, faces, count, ids, of, places, slots, room):
    """Give equal corners one number, 0 on, and return how many there are, or −1 − what is wrong with one."""
    mask = room - 1
    for k in range(len(ids)):
        ids[k] = -1
    for k in range(room):
        slots[k] = -1
    numbered = 0
    for k in range(count):
        for corner in range(3):
            vertex = faces[k, corner]
            if vertex < 0 or vertex >= len(ids):
                return -1 - NO_VERTEX
            if ids[vertex] < 0:
                x, y, z = points[vertex, 0], points[vertex, 1], points[vertex, 2]
                if not (abs(x) <= LARGEST and abs(y) <= LARGEST and abs(z) <= LARGEST):
                    return -1 - NOT_USABLE
                slot = slot_of(bits, vertex) & mask
                while slots[slot] >= 0:
                    other = places[slots[slot]]
                    if points[other, 0] == x and points[other, 1] == y and points[other, 2] == z:
                        break
                    slot = (slot + 1) & mask
                if slots[slot] < 0:
                    slots[slot] = numbered
                    places[numbered] = vertex
                    numbered += 1
                ids[vertex] = slots[slot]
            of[k, corner] = ids[vertex]
    return numbered


@njit(inline="always")
def pair_edges(of, count, numbered, first, edges, parent, slots):
    """Pair every edge with the one other that runs against it, and return what the surface is.

    `first` is the last edge filed under a vertex, the lower of its two; `edges` are (the one filed before it, the
    higher vertex times 2 + the way it runs, the triangle, or −1 once it is paired). Those of a vertex that has as many
    as are looked through are filed in a hash table instead, with the lower vertex in place of the one before.
    """
    for k in range(numbered):
        first[k] = -1
    filed = room = 0
    waiting = 0
    pieces = count
    for k in range(count):
        parent[k] = k
        a, b, c = of[k, 0], of[k, 1], of[k, 2]
        if a == b or b == c or c == a:
            return REPEATED
        for side in range(3):
            tail, head = (a, b) if side == 0 else ((b, c) if side == 1 else (c, a))
            low = np.uint32(min(tail, head))
            this = 2 * max(tail, head) + (1 if tail < head else 0)
            at = first[low]
            passed, slot = 0, np.int64(0)
            while at >= 0 and edges[np.uint32(at), 1] >> 1 != this >> 1:
                at = edges[np.uint32(at), 0]
                passed += 1
            if passed == FILED:
                if room == 0:
                    room = 64
                    while room < 4 * count:
                        room *= 2
                    for j in range(room):
                        slots[j] = -1
                key = (np.uint64(low) * PRIME_X ^ np.uint64(this >> 1) * PRIME_Y) * PRIME_Z
                slot = np.int64(key >> np.uint64(40)) & (room - 1)
                while True:
                    at = slots[slot]
                    if at < 0 or (edges[at, 0] == low and edges[at, 1] >> 1 == this >> 1):
                        break
                    slot = (slot + 1) & (room - 1)
            if at < 0:
                edges[filed, 0], edges[filed, 1], edges[filed, 2] = first[low], this, k
                if passed == FILED:
                    edges[filed, 0] = low
                    slots[slot] = filed
                else:
                    first[low] = filed
                filed += 1
                waiting += 1
                continue
            if edges[np.uint32(at), 1] == this or edges[np.uint32(at), 2] < 0:
                return UNPAIRED
            one, other = np.uint32(edges[np.uint32(at), 2]), np.uint32(k)
            edges[np.uint32(at), 2] = -1
            waiting -= 1
            while np.uint32(parent[one]) != one:
                parent[one] = parent[np.uint32(parent[one])]
                one = np.uint32(parent[one])
            while np.uint32(parent[other]) != other:
                parent[other] = parent[np.uint32(parent[other])]
                other = np.uint32(parent[other])
            if one != other:
                pieces -= 1
                parent[max(one, other)] = min(one, other)
    if waiting:
        return UNPAIRED
    return SIMPLE if pieces == 1 else PIECES


@njit(inline="always")
def common_corners(of, k, l):
    """Return which corners of a triangle another one has too, a bit each."""
    a, b, c = of[k, 0], of[k, 1], of[k, 2]
    p, q, r = of[l, 0], of[l, 1], of[l, 2]
    common = np.int64((a == p) | (a == q) | (a == r)) | np.int64((b == p) | (b == q) | (b == r)) << 1
    common |= np.int64((c == p) | (c == q) | (c == r)) << 2
    return common


@njit(inline="always")
def on_one_side(own, normals, plane, triangle, common):
    """Say whether the plane of a triangle surely has another one, but for common corners, on one side."""
    j, plane, i, triangle = lane(plane), block(plane), lane(triangle), block(triangle)
    ax, ay, az = own[plane, 0, j], own[plane, 1, j], own[plane, 2, j]
    nx, ny, nz, size = normals[plane, 0, j], normals[plane, 1, j], normals[plane, 2, j], ORIENT3D * normals[plane, 3, j]
    above = below = True
    for corner in range(3):
        wx, wy, wz = (
            own[triangle, 3 * corner, i] - ax,
            own[triangle, 3 * corner + 1, i] - ay,
            own[triangle, 3 * corner + 2, i] - az,
        )
        height = wx * nx + wy * ny + wz * nz
        least = (size + UNDERFLOW) * (abs(wx) + abs(wy) + abs(wz)) + UNDERFLOW
        free = (common >> corner) & 1 == 0
        above &= not free or height > least
        below &= not free or height < -least
    return above or below


@njit(inline="always")
def apart(own, k, l):
    """Say whether two triangles surely are apart along the line between their middles."""
    i, k, j, l = lane(k), block(k), lane(l), block(l)
    x, y, z = own[k, 0, i], own[k, 1, i], own[k, 2, i]
    dx = own[l, 0, j] + own[l, 3, j] + own[l, 6, j] - (own[k, 0, i] + own[k, 3, i] + own[k, 6, i])
    dy = own[l, 1, j] + own[l, 4, j] + own[l, 7, j] - (own[k, 1, i] + own[k, 4, i] + own[k, 7, i])
    dz = own[l, 2, j] + own[l, 5, j] + own[l, 8, j] - (own[k, 2, i] + own[k, 5, i] + own[k, 8, i])
    near, far, size = -np.inf, np.inf, 0.0
    for corner in range(0, 9, 3):
        ux, uy, uz = own[k, corner, i] - x, own[k, corner + 1, i] - y, own[k, corner + 2, i] - z
        vx, vy, vz = own[l, corner, j] - x, own[l, corner + 1, j] - y, own[l, corner + 2, j] - z
        near = max(near, dx * ux + dy * uy + dz * uz)
        far = min(far, dx * vx + dy * vy + dz * vz)
        size = max(
            size, abs(dx) * max(abs(ux), abs(vx)) + abs(dy) * max(abs(uy), abs(vy)) + abs(dz) * max(abs(uz), abs(vz))
        )
    return far - near > 2 * SIDE * size + SMALLEST


@njit(inline="always")
def boxes_apart(own, k, l):
    """Say whether the boxes of two triangles have no inside in common."""
    i, k, j, l = lane(k), block(k), lane(l), block(l)
    for axis in range(3):
        a, b, c = own[k, axis, i], own[k, axis + 3, i], own[k, axis + 6, i]
        p, q, r = own[l, axis, j], own[l, axis + 3, j], own[l, axis + 6, j]
        if max(a, max(b, c)) <= min(p, min(q, r)) or max(p, max(q, r)) <= min(a, min(b, c)):
            return True
    return False


@njit(inline="always")
def fill_corners(points, places, of, count, own):
    """Write the coordinates of all corners, a row each, and more triangles to fill a group."""
    for k in range(-(-count // GROUP) * GROUP):
        for corner in range(3):
            vertex = np.uint64(places[np.uint64(of[min(k, count - 1), corner])])
            for axis in range(3):
                own[block(k), 3 * corner + axis, lane(k)] = points[vertex, axis]


@njit(inline="always")
def fill_boxes(points, places, numbered, own_at, boxes_at, groups_at, heaps_at, count):
    """Write the boxes of triangles, groups and heaps of groups, in cells that no rounding puts in another order.

    The cells of a box begin at an even number and end before one, so that those of boxes that overlap do. A box that is
    flat has an odd number at both its ends: no other flat one has cells that overlap it.
    """
    padded = -(-count // GROUP) * GROUP
    for axis in range(3):
        low, high = np.inf, -np.inf
        for k in range(numbered):
            x = points[np.uint64(places[k]), axis]
            low, high = min(low, x), max(high, x)
        scale = CELLS / (high - low) if high - low > 1e-300 else 0.0
        for start in range(0, padded, GROUP):
            to = address(boxes_at, 2 * (6 * start + axis * GROUP))
            write_cells(address(own_at, 8 * (9 * start + axis * GROUP)), low, scale, to)
            boxes = carray(to, (6, GROUP), np.int16)
            for j in range(count - start, GROUP):
                boxes[0, j], boxes[3, j] = OUTSIDE, -OUTSIDE
        enclose(boxes_at, groups_at, padded // GROUP, axis)
        enclose(groups_at, heaps_at, -(-padded // GROUP**2), axis)


@njit(inline="always")
def enclose(boxes_at, groups_at, count, axis):
    """Write the boxes of `count` groups of `GROUP` boxes, and empty ones to fill a group of them."""
    groups = carray(groups_at, (BLOCKS, 6, GROUP), np.int16)
    for group in range(count):
        boxes = carray(address(boxes_at, 2 * GROUP * (6 * group + axis)), (6, GROUP), np.int16)
        least, most = np.int16(OUTSIDE), np.int16(-OUTSIDE)
        for j in range(GROUP):
            least, most = min(least, boxes[0, j]), max(most, boxes[3, j])
        groups[block(group), axis, lane(group)], groups[block(group), axis + 3, lane(group)] = least, most
    for group in range(count, -(-count // GROUP) * GROUP):
        groups[block(group), axis, lane(group)], groups[block(group), axis + 3, lane(group)] = OUTSIDE, -OUTSIDE


@njit(inline="always")
def scattered(groups_at, count):
    """Say whether the triangles are in no order, so that the boxes of groups of them overlap most others."""
    groups = carray(groups_at, (BLOCKS, 6, GROUP), np.int16)
    share = 0.0
    for group in range(count // GROUP):
        at, j = block(group), lane(group)
        x, y, z = (
            np.float64(groups[at, 3, j] - groups[at, 0, j]),
            np.float64(groups[at, 4, j] - groups[at, 1, j]),
            np.float64(groups[at, 5, j] - groups[at, 2, j]),
        )
        share += x * y * z
    return share * GROUP > SCATTERED * (2.0 * CELLS) ** 3


@njit(inline="always")
def sort_triangles(boxes_at, of, count, starts, other):
    """Sort triangles by the brick that the lower corner of their box is in, along a curve through neighbours."""
    boxes = carray(boxes_at, (BLOCKS, 6, GROUP), np.int16)
    for brick in range(BRICKS**3 + 1):
        starts[brick] = 0
    for k in range(count):
        starts[1 + brick_of(boxes, k)] += 1
        other[k, 0], other[k, 1], other[k, 2] = of[k, 0], of[k, 1], of[k, 2]
    for brick in range(BRICKS**3):
        starts[brick + 1] += starts[brick]
    for k in range(count):
        brick = brick_of(boxes, k)
        to = np.uint64(starts[brick])
        starts[brick] += 1
        of[to, 0], of[to, 1], of[to, 2] = other[k, 0], other[k, 1], other[k, 2]


@njit(inline="always")
def brick_of(boxes, k):
    """Return the number of the brick along a Z-order curve."""
    brick = np.uint64(0)
    for axis in range(3):
        cell = np.uint64(boxes[block(k), axis, lane(k)]) * np.uint64(BRICKS) // np.uint64(2 * CELLS + 2)
        cell = (cell | cell << np.uint64(8)) & np.uint64(0x100F)
        cell = (cell | cell << np.uint64(4)) & np.uint64(0x10C3)
        cell = (cell | cell << np.uint64(2)) & np.uint64(0x1249)
        brick |= cell << np.uint64(axis)
    return brick


@njit(inline="always")
def fill_normals(own_at, of, count, numbered, normals_at, fans):
    """Write the normals of the triangles, and a bound on what went into them; sum them at each corner."""
    for vertex in range(numbered):
        fans[vertex, 0] = fans[vertex, 1] = fans[vertex, 2] = 0.0
    for start in range(0, count, GROUP):
        own = carray(address(own_at, 8 * 9 * start), (9, GROUP), np.float64)
        normals = carray(address(normals_at, 8 * 4 * start), (4, GROUP), np.float64)
        for k in range(GROUP):
            x, y, z = own[0, k], own[1, k], own[2, k]
            ux, uy, uz = own[3, k] - x, own[4, k] - y, own[5, k] - z
            vx, vy, vz = own[6, k] - x, own[7, k] - y, own[8, k] - z
            px, qx = uy * vz, uz * vy
            py, qy = uz * vx, ux * vz
            pz, qz = ux * vy, uy * vx
            normals[0, k], normals[1, k], normals[2, k] = px - qx, py - qy, pz - qz
            normals[3, k] = max(max(abs(px) + abs(qx), abs(py) + abs(qy)), abs(pz) + abs(qz))
        for k in range(min(GROUP, count - start)):
            x, y, z = normals[0, k], normals[1, k], normals[2, k]
            for corner in range(3):
                at = np.uint64(of[start + k, corner])
                fans[at, 0] += x
                fans[at, 1] += y
                fans[at, 2] += z


@njit(inline="always")
def flatten_fans(own_at, of, count, numbered, normals_at, fans_at, lanes_at, turns):
    """Count how often the triangles around each corner go around it, seen along the sum of their normals, d.

    Where that is once, and each of them faces that way, they share nothing but the corner and their common edges: seen
    so, they lie side by side. `turns` is below zero where that is not certain. They go around once where they pass once
    through a plane along d, from one side to the other. Its normal is at right angles to d whatever the rounding, and
    along no axis that many parts are built on. The record of a corner is d, a factor of the bound on what rounding does
    to d·n, the plane's normal, and the factor of that.
    """
    fans = carray(fans_at, (CORNERS // 2, RECORD), np.float64)
    lanes = carray(lanes_at, (27, GROUP), np.float64)
    fill_normals(own_at, of, count, numbered, normals_at, fans)
    for vertex in range(numbered):
        dx, dy, dz = fans[vertex, 0], fans[vertex, 1], fans[vertex, 2]
        ax, ay, az = abs(dx), abs(dy), abs(dz)
        along_x = ax > ay and ax > az
        along_y = not along_x and ay > az
        fans[vertex, 3] = ORIENT3D * (ax + ay + az)
        fans[vertex, 4] = -(SLANT_X * dy + SLANT_Y * dz) if along_x else (SLANT_Y * dy if along_y else SLANT_X * dz)
        fans[vertex, 5] = SLANT_X * dx if along_x else (-(SLANT_X * dz + SLANT_Y * dx) if along_y else SLANT_Y * dz)
        fans[vertex, 6] = SLANT_Y * dx if along_x else (SLANT_X * dy if along_y else -(SLANT_X * dx + SLANT_Y * dy))
        fans[vertex, 7] = SIDE * STEEPEST * max(ax, max(ay, az))
        turns[vertex] = 0.0
    for k in range(count, -(-count // GROUP) * GROUP):
        of[k, 0], of[k, 1], of[k, 2] = of[0, 0], of[0, 1], of[0, 2]
    for start in range(0, count, GROUP):
        for k in range(0, GROUP, 4):
            for corner in range(3):
                a = address(fans_at, 8 * RECORD * np.int64(of[start + k, corner]))
                b = address(fans_at, 8 * RECORD * np.int64(of[start + k + 1, corner]))
                c = address(fans_at, 8 * RECORD * np.int64(of[start + k + 2, corner]))
                d = address(fans_at, 8 * RECORD * np.int64(of[start + k + 3, corner]))
                to = address(lanes_at, 8 * (RECORD * GROUP * corner + k))
                transpose(a, b, c, d, to)
                half = 8 * RECORD // 2
                transpose(
                    address(a, half), address(b, half), address(c, half), address(d, half), address(to, GROUP * half)
                )
        own = carray(address(own_at, 8 * 9 * start), (9, GROUP), np.float64)
        normals = carray(address(normals_at, 8 * 4 * start), (4, GROUP), np.float64)
        for k in range(GROUP):
            nx, ny, nz, size = normals[0, k], normals[1, k], normals[2, k], normals[3, k]
            x0, y0, z0 = own[0, k], own[1, k], own[2, k]
            x1, y1, z1 = own[3, k], own[4, k], own[5, k]
            x2, y2, z2 = own[6, k], own[7, k], own[8, k]
            ux, uy, uz = x1 - x0, y1 - y0, z1 - z0
            vx, vy, vz = x2 - x1, y2 - y1, z2 - z1
            wx, wy, wz = x0 - x2, y0 - y2, z0 - z2
            u, v, w = abs(ux) + abs(uy) + abs(uz), abs(vx) + abs(vy) + abs(vz), abs(wx) + abs(wy) + abs(wz)
            lanes[24, k] = rise(lanes, 0, k, nx, ny, nz, size, ux, uy, uz, u, wx, wy, wz, w)
            lanes[25, k] = rise(lanes, 8, k, nx, ny, nz, size, vx, vy, vz, v, ux, uy, uz, u)
            lanes[26, k] = rise(lanes, 16, k, nx, ny, nz, size, wx, wy, wz, w, vx, vy, vz, v)
        for k in range(min(GROUP, count - start)):
            for corner in range(3):
                turns[np.uint64(of[start + k, corner])] += lanes[24 + corner, k]


@njit(inline="always")
def rise(lanes, at, j, nx, ny, nz, size, ux, uy, uz, u, wx, wy, wz, w):
    """Return 1 where a triangle passes through the plane of a corner from below, else 0; −`MOST` where it may.

    u is the edge that leaves the corner and w the one that ends there.
    """
    dx, dy, dz, d = lanes[at, j], lanes[at + 1, j], lanes[at + 2, j], lanes[at + 3, j]
    mx, my, mz, m = lanes[at + 4, j], lanes[at + 5, j], lanes[at + 6, j], lanes[at + 7, j]
    one, other = ux * mx + uy * my + uz * mz, wx * mx + wy * my + wz * mz
    sure = (dx * nx + dy * ny + dz * nz > d * size + SMALLEST) & (abs(one) > m * u + SMALLEST)
    sure &= abs(other) > m * w + SMALLEST
    return (1.0 if (one < 0) & (other < 0) else 0.0) if sure else -1.0 * MOST


@njit(inline="always")
def bring(own, k, two, row):
    """Copy the corners of a triangle."""
    for corner in range(9):
        two[row, corner] = own[block(k), corner, lane(k)]


@njit(inline="always")
def settled(pairs, left, own, normals, of, two, signs, work):
    """Say whether none of some pairs of triangles whose boxes meet cross; k and l are packed into one number."""
    for at in range(left):
        k, l = np.uint64(pairs[at] >> 32), np.uint64(pairs[at] & 0xFFFFFFFF)
        common = common_corners(of, l, k)
        # With two corners in common, they do not cross.
        if common & (common - 1) != 0:
            continue
        if on_one_side(own, normals, k, l, common) or on_one_side(own, normals, l, k, common_corners(of, k, l)):
            continue
        if common == 0 and apart(own, k, l):
            continue
        bring(own, k, two, 0)
        bring(own, l, two, 1)
        if cross(two, 0, 1, signs, work) != 0:
            return False
    return True


@njit(inline="always")
def may_cross(own, normals, of, count, boxes_at, groups_at, heaps_at, flat_at, turns, near, pairs, two, signs, work):
    """Say whether two triangles cross, or cannot be shown not to with little work.

    Those that have a corner in common around which all lie side by side (see `flatten_fans`) are passed over.
    """
    boxes = carray(boxes_at, (BLOCKS, 6, GROUP), np.int16)
    flat = carray(flat_at, (BLOCKS, 3, GROUP), np.int32)
    for k in range(count):
        for corner in range(3):
            vertex = of[k, corner]
            flat[block(k), corner, lane(k)] = vertex if turns[np.uint64(vertex)] == 1.0 else -1
    heaps = -(-count // GROUP**2)
    listed = np.uint64(0)
    idle = 0
    for k in range(count):
        at, j = block(k), lane(k)
        lx, ly, lz = boxes[at, 0, j], boxes[at, 1, j], boxes[at, 2, j]
        hx, hy, hz = boxes[at, 3, j], boxes[at, 4, j], boxes[at, 5, j]
        for several in range(k // GROUP**3 * GROUP, heaps, GROUP):
            heaped = 1 if heaps == 1 else meeting(address(heaps_at, 12 * several), lx, ly, lz, hx, hy, hz)
            if several * GROUP**2 <= k:
                heaped &= -1 << (k // GROUP**2 - several)
            while heaped != 0:
                group = GROUP * (several + lowest_bit(heaped))
                heaped &= heaped - 1
                looked = meeting(address(groups_at, 12 * group), lx, ly, lz, hx, hy, hz)
                if group * GROUP <= k:
                    looked &= -1 << (k // GROUP - group)
                listed = noted(near, listed, k << 32 | group << 4, looked, 4)
        if listed > np.uint64(ENOUGH) or k == count - 1:
            left = np.uint64(0)
            for entry in range(listed):
                l, start = near[entry] >> 32, near[entry] & 0xFFFFFFFF
                at, j = block(l), lane(l)
                looked = meeting_apart(
                    address(boxes_at, 12 * start),
                    boxes[at, 0, j], boxes[at, 1, j], boxes[at, 2, j],
                    boxes[at, 3, j], boxes[at, 4, j], boxes[at, 5, j],
                    address(flat_at, 12 * start), of[np.uint64(l), 0], of[np.uint64(l), 1], of[np.uint64(l), 2],
                )  # fmt: skip
                looked &= -2 << (l - start) if l >= start else -1
                left = noted(pairs, left, l << 32 | start, looked, 0)
                if left > np.uint64(ENOUGH) or entry == listed - 1:
                    for at in range(0, left, TESTED):
                        if boxes_apart(own, np.uint64(pairs[at] >> 32), np.uint64(pairs[at] & 0xFFFFFFFF)):
                            idle += TESTED
                    if idle > IDLE * count or not settled(pairs, left, own, normals, of, two, signs, work):
                        return True
                    left = np.uint64(0)
            listed = np.uint64(0)
    return False


@njit(inline="always")
def noted(entries, filled, first, bits, step):
    """Append `first` + the number of each bit that is set, shifted by `step`, and return how many there are then.

    They are written two at a time, of which only those that are there count: that costs less than to ask each time.
    """
    at = filled
    filled += np.uint64(count_bits(bits))
    while True:
        entries[at] = first + (lowest_bit(bits) << step)
        bits &= bits - 1
        entries[at + np.uint64(1)] = first + (lowest_bit(bits) << step)
        bits &= bits - 1
        at += np.uint64(2)
        if at >= filled:
            return filled


def check_small(vertices_at, vertices, faces_at, faces, table_at, meshes, ids_at, room, scratch, states_at):
    """Say of each of `meshes` surfaces what it is.

    A row of the table is (first vertex, vertices, first face, faces) of a surface, whose faces number its vertices from
    0 on; there is `room` for as many as any has.
    """
    points, bits = carray(vertices_at, (vertices, 3), np.float64), carray(vertices_at, (vertices, 3), np.uint64)
    corners = carray(faces_at, (faces, 3), np.int64)
    table = carray(table_at, (meshes, 4), np.int64)
    states = carray(states_at, (meshes,), np.int64)
    ids = carray(ids_at, (room,), np.int32)
    own = carray(scratch, (BLOCKS, 9, GROUP), np.float64)
    normals_at, fans_at, lanes_at = (
        address(scratch, 8 * NORMALS),
        address(scratch, 8 * FANS),
        address(scratch, 8 * LANES),
    )
    normals = carray(normals_at, (BLOCKS, 4, GROUP), np.float64)
    turns = carray(address(scratch, 8 * TURNS), (CORNERS // 2,), np.float64)
    pairs = carray(address(scratch, 8 * PAIRS), (ENOUGH + 2 * GROUP,), np.int64)
    near = carray(address(scratch, 8 * NEAR), (BLOCKS + ENOUGH + 8,), np.int64)
    two, work = (
        carray(address(scratch, 8 * TWO), (2, 9), np.float64),
        carray(address(scratch, 8 * (TWO + 18)), (WORK,), np.float64),
    )
    signs = carray(address(scratch, 8 * SIGNS), (8,), np.int64)
    boxes_at, groups_at = address(scratch, 8 * BOXES), address(scratch, 8 * GROUPS)
    heaps_at, flat_at = address(scratch, 8 * HEAPS), address(scratch, 8 * FLAT)
    of = carray(address(scratch, 8 * NUMBERS), (MOST + GROUP, 3), np.int32)
    edges = carray(address(scratch, 8 * NUMBERS + 12 * (MOST + GROUP)), (CORNERS, 3), np.int32)
    numbers = carray(address(scratch, 8 * NUMBERS + 12 * (MOST + GROUP + CORNERS)), (7 * MOST + SLOTS,), np.int32)
    places, first = numbers[:CORNERS], numbers[CORNERS : 2 * CORNERS]
    parent, slots = numbers[2 * CORNERS : 2 * CORNERS + MOST], numbers[2 * CORNERS + MOST :]
    before, numbered, distinct, state = -1, 0, False, UNPAIRED
    for mesh in range(meshes):
        start, size, begin, count = table[mesh, 0], table[mesh, 1], table[mesh, 2], table[mesh, 3]
        if count < 1 or count > MOST:
            states[mesh] = MANY
            continue
        capacity = 64
        while capacity < 2 * min(size, 3 * count):
            capacity *= 2
        here, own_faces = points[start : start + size], corners[begin : begin + count]
        # Meshes that share their faces and have no two corners in one place are paired alike.
        alike = before >= 0 and size == table[before, 1] and begin == table[before, 2] and count == table[before, 3]
        if alike and distinct:
            alike = all_distinct(here, bits[start : start + size], places, numbered, slots, capacity)
        else:
            alike = False
        before = -1
        if not alike:
            numbered = number_corners(
                here, bits[start : start + size], own_faces, count, ids[:size], of, places, slots, capacity
            )
            if numbered < 0:
                states[mesh] = -1 - numbered
                continue
            distinct = True
            for k in range(size):
                distinct &= ids[k] < 0 or places[np.uint64(ids[k])] == k
            state = pair_edges(of, count, numbered, first, edges, parent, slots)
        before = mesh
        states[mesh] = state
        if state > PIECES:
            continue
        fill_corners(here, places, of, count, own)
        fill_boxes(here, places, numbered, scratch, boxes_at, groups_at, heaps_at, count)
        if scattered(groups_at, count):
            sort_triangles(boxes_at, of, count, slots, edges)
            fill_corners(here, places, of, count, own)
            fill_boxes(here, places, numbered, scratch, boxes_at, groups_at, heaps_at, count)
            distinct = False
        flatten_fans(scratch, of, count, numbered, normals_at, fans_at, lanes_at, turns)
        if may_cross(
            own, normals, of, count, boxes_at, groups_at, heaps_at, flat_at, turns, near, pairs, two, signs, work
        ):
            states[mesh] = CROSSING
    return 0
