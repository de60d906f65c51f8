"""Boxes of small triangles in 16-bit cells, and in groups of 16, of which as many are compared at a time.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import functools

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.extending import intrinsic

MOST = 200_000
"""Triangles of a surface that there is room for."""

GROUP = 16
"""Triangles, or such groups of them, whose boxes are compared with another one together; lanes of a vector loop."""

BLOCKS = MOST // GROUP + 2 * GROUP
"""Groups that there is room for. A block of each table has a row of `GROUP` numbers for each of its columns."""

CELLS = 16_000
"""Steps along each axis in which boxes are compared; twice as many and two fit into 16 bits."""

OUTSIDE = 2**15 - 1
BRICKS = 32
"""Cells along each axis by which triangles in no order are sorted; a power of two."""

SLANTS = [
    *((1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1)),
    *((1, 1, 1), (1, 1, -1), (1, -1, 1), (-1, 1, 1)),
    *[(0, 0, 0)] * (GROUP - 10),
]
"""Directions along which two triangles whose boxes overlap are often apart, in cells."""

GAP = 3
"""Cells by which two points may seem apart that are not: each of three coordinates is rounded down to a whole one."""

SCATTERED = 256
"""Triangles that are near another one for nothing but their order, on average, before they are sorted."""


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
        row = ir.VectorType(ir.IntType(16), GROUP)
        mine, theirs = [same(builder, k) for k in (a, b, c)], [load(builder, flat, k, row) for k in range(3)]
        shared = functools.reduce(builder.or_, [builder.icmp_signed("==", k, l) for k in mine for l in theirs])
        lanes = builder.and_(overlapping(builder, base, sides), builder.not_(shared))
        return builder.zext(builder.bitcast(lanes, ir.IntType(GROUP)), ir.IntType(64))

    return types.int64(types.voidptr, *[types.int16] * 6, types.voidptr, *[types.uint16] * 3), code


@intrinsic
def write_slants(context, to, x, y, z):
    """Write how far a point lies along each of `SLANTS`, given in cells."""

    def code(context, builder, signature, arguments):
        to, *cells = arguments
        row = ir.VectorType(ir.IntType(16), GROUP)
        total = ir.Constant(row, [-CELLS if sum(slant) == 3 else 0 for slant in SLANTS])
        for axis, cell in enumerate(cells):
            along = ir.Constant(row, [slant[axis] for slant in SLANTS])
            total = builder.add(total, builder.mul(along, same(builder, cell)))
        builder.store(total, builder.bitcast(to, row.as_pointer()), align=2)
        return context.get_dummy_value()

    return types.void(types.voidptr, *[types.int16] * 3), code


@intrinsic
def apart_aslant(context, base, a, b, c, p, q, r):
    """Say whether the points a, b, c and p, q, r, whose rows begin at an address, surely are apart along a slant."""

    def code(context, builder, signature, arguments):
        base, *points = arguments
        row = ir.VectorType(ir.IntType(16), GROUP)
        where = (builder.gep(base, [builder.shl(point, ir.IntType(64)(5))]) for point in points)
        a, b, c, p, q, r = (builder.load(builder.bitcast(at, row.as_pointer()), align=2) for at in where)

        def extreme(order, *rows):
            return functools.reduce(lambda x, y: builder.select(builder.icmp_signed(order, x, y), x, y), rows)

        gap = ir.Constant(row, [GAP] * GROUP)
        beyond = builder.icmp_signed(">", extreme("<", p, q, r), builder.add(extreme(">", a, b, c), gap))
        before = builder.icmp_signed(">", extreme("<", a, b, c), builder.add(extreme(">", p, q, r), gap))
        lanes = builder.bitcast(builder.or_(beyond, before), ir.IntType(GROUP))
        return builder.icmp_unsigned("!=", lanes, ir.IntType(GROUP)(0))

    return types.boolean(types.voidptr, *[types.int64] * 6), code


@intrinsic
def bits_of(context, x):
    """Return the 64 bits of a number."""

    def code(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.uint64(types.float64), code


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
def fill_boxes(points, places, numbered, own_at, boxes_at, groups_at, heaps_at, frame, count):
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
        frame[0, axis], frame[1, axis] = low, scale
        for start in range(0, padded, GROUP):
            to = address(boxes_at, 2 * (6 * start + axis * GROUP))
            write_cells(address(own_at, 8 * (9 * start + axis * GROUP)), low, scale, to)
            boxes = carray(to, (6, GROUP), np.int16)
            for j in range(count - start, GROUP):
                boxes[0, j], boxes[3, j] = OUTSIDE, -OUTSIDE
        enclose(boxes_at, groups_at, padded // GROUP, axis)
        enclose(groups_at, heaps_at, -(-padded // GROUP**2), axis)


@njit(inline="always")
def fill_slants(points, places, numbered, frame, slants_at):
    """Write a row for each corner that tells how far it lies along each of `SLANTS`."""
    for k in range(numbered):
        at = np.uint64(places[k])
        x = np.int16((points[at, 0] - frame[0, 0]) * frame[1, 0])
        y = np.int16((points[at, 1] - frame[0, 1]) * frame[1, 1])
        z = np.int16((points[at, 2] - frame[0, 2]) * frame[1, 2])
        write_slants(address(slants_at, 2 * GROUP * k), x, y, z)


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
