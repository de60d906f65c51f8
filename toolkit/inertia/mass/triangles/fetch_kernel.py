"""Bring the corners of triangles into the lanes of the kernels: from STL records, or from faces over shared vertices.

Imported only to be compiled (`inertia.native`). The corners of four triangles are brought into vectors together
(`transpose`): stored one number at a time they cost as much as the arithmetic, and the processor's gather
instructions cost twice that.
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

LANES = 32
DEPTH = 32

GROUP = 4
"""Triangles brought into the lanes together."""

EIGHT = 8
"""The same, where their extents are taken too."""

RECORD, CORNER = 50, 12
"""Bytes of a binary STL record, and of its normal and of each of the three corners that follow."""


@intrinsic
def address(context, base, offset):
    """Return the address `offset` bytes after `base`."""

    def code(context, builder, signature, arguments):
        return builder.gep(arguments[0], [arguments[1]])

    return types.voidptr(types.voidptr, types.int64), code


def transposer(number, size, alignment):
    """Make the function that transposes points (3,) of `number`, an LLVM type of `size` bytes."""
    index = ir.IntType(32)
    pair, four = ir.VectorType(number, 2), ir.VectorType(number, 4)
    row = ir.VectorType(ir.DoubleType(), 4)

    @intrinsic
    def transpose(context, a, b, c, d, lane):
        """Store the points at four addresses as rows x, y, z of float64, the first at `lane`."""

        def code(context, builder, signature, arguments):
            def at(base, offset, kind):
                return builder.bitcast(builder.gep(base, [ir.IntType(64)(offset)]), kind.as_pointer())

            def load(base, offset, kind):
                return builder.load(at(base, offset, kind), align=alignment)

            def mixed(one, other, places):
                return builder.shuffle_vector(one, other, ir.Constant(ir.VectorType(index, 4), places))

            *points, lane = arguments
            xy = [load(point, 0, pair) for point in points]
            even, odd = mixed(xy[0], xy[2], [0, 1, 2, 3]), mixed(xy[1], xy[3], [0, 1, 2, 3])
            z = ir.Constant(four, ir.Undefined)
            for k, point in enumerate(points):
                z = builder.insert_element(z, load(point, 2 * size, number), index(k))
            for axis, component in enumerate((mixed(even, odd, [0, 4, 2, 6]), mixed(even, odd, [1, 5, 3, 7]), z)):
                widened = component if four == row else builder.fpext(component, row)
                builder.store(widened, at(lane, axis * LANES * 8, row), align=8 * GROUP)
            return context.get_dummy_value()

        return types.void(*[types.voidptr] * 5), code

    return transpose


transpose_f4 = transposer(ir.FloatType(), 4, 2)
transpose_f8 = transposer(ir.DoubleType(), 8, 8)


@njit(inline="always")
def facet(records, triangle, corner):
    """Return the address of a corner."""
    return address(records, triangle * RECORD + (corner + 1) * CORNER)


@njit(inline="always")
def vertex(vertices, faces, triangle, corner):
    """Return the address of a corner."""
    return address(vertices, faces[np.uint64(triangle), corner] * 24)  # unsigned spares the test for indices below 0


@njit(inline="always")
def four_facets(records, a, b, c, d, lane):
    """Bring four records into the lanes from `lane` on."""
    for k in range(3):
        at = address(lane, 3 * k * LANES * 8)
        transpose_f4(facet(records, a, k), facet(records, b, k), facet(records, c, k), facet(records, d, k), at)


@njit(inline="always")
def four_faces(vertices, faces, a, b, c, d, lane):
    """Bring four faces into the lanes from `lane` on."""
    for k in range(3):
        transpose_f8(
            vertex(vertices, faces, a, k),
            vertex(vertices, faces, b, k),
            vertex(vertices, faces, c, k),
            vertex(vertices, faces, d, k),
            address(lane, 3 * k * LANES * 8),
        )


@njit(inline="always")
def pad(corner, filled):
    """Fill the lanes from `filled` on with a point: no area, no volume, no new extent."""
    for lane in range(filled, LANES):
        for k in range(9):
            corner[k, lane] = corner[k % 3, 0]


@njit(inline="always")
def fetch_facets(records, start, count, corner_at, corner):
    """Fill the lanes, (9, LANES) at `corner_at`, from record `start` on."""
    filled, last = min(LANES, count - start), count - 1
    whole = filled // GROUP * GROUP
    for j in range(0, whole, GROUP):
        k = start + j
        four_facets(records, k, k + 1, k + 2, k + 3, address(corner_at, j * 8))
    if filled < LANES:
        if whole < filled:
            k = start + whole
            four_facets(records, k, min(k + 1, last), min(k + 2, last), last, address(corner_at, whole * 8))
        pad(corner, filled)


@njit(inline="always")
def fetch_faces(vertices, faces, start, count, corner_at, corner):
    """Fill the lanes, (9, LANES) at `corner_at`, from face `start` on."""
    filled, last = min(LANES, count - start), count - 1
    whole = filled // GROUP * GROUP
    for j in range(0, whole, GROUP):
        k = start + j
        four_faces(vertices, faces, k, k + 1, k + 2, k + 3, address(corner_at, j * 8))
    if filled < LANES:
        if whole < filled:
            k = start + whole
            four_faces(vertices, faces, k, min(k + 1, last), min(k + 2, last), last, address(corner_at, whole * 8))
        pad(corner, filled)


def extreme(name):
    """Make the function that calls an intrinsic of LLVM, for the lesser or the greater of two numbers.

    It is one instruction as no number is said to be NaN: one that is may or may not be the result. What a comparison
    chooses LLVM stores under a mask where it goes back to its own place, which takes some processors several times
    as long.
    """

    @intrinsic
    def of_two(context, a, b):
        """Return one of two numbers."""

        def code(context, builder, signature, arguments):
            number = ir.DoubleType()
            function = builder.module.declare_intrinsic(name, [number], ir.FunctionType(number, [number, number]))
            return builder.call(function, arguments, fastmath=("nnan",))

        return types.float64(types.float64, types.float64), code

    return of_two


lesser, greater = extreme("llvm.minnum"), extreme("llvm.maxnum")


@njit(inline="always")
def lowered(least, a, b, c):
    """Return the least of an extent and three coordinates."""
    return lesser(lesser(a, lesser(b, c)), least)


@njit(inline="always")
def raised(most, a, b, c):
    """Return the largest of an extent and three coordinates."""
    return greater(greater(a, greater(b, c)), most)


@intrinsic
def eight_facets(context, records, lane, extents):
    """Store the corners of eight records as rows of float64, and widen extents, (6, EIGHT) of float32, by them.

    Extents of float32 take half the steps of those of float64.
    """

    def code(context, builder, signature, arguments):
        number = ir.FloatType()
        four, eight, wide = (ir.VectorType(*of) for of in ((number, 4), (number, EIGHT), (ir.DoubleType(), EIGHT)))
        records, lane, extents = arguments

        def at(base, offset, kind):
            return builder.bitcast(builder.gep(base, [ir.IntType(64)(offset)]), kind.as_pointer())

        def mixed(one, other, *places):
            return builder.shuffle_vector(one, other, ir.Constant(ir.VectorType(ir.IntType(32), len(places)), places))

        def columns(offset):
            """Return four numbers one after another of the records."""
            rows = [builder.load(at(records, k * RECORD + offset, four), align=2) for k in range(EIGHT)]
            a, b, c, d = (mixed(rows[k], rows[k + 4], *range(EIGHT)) for k in range(4))
            found = []
            for pairs in ((0, 8, 1, 9, 4, 12, 5, 13), (2, 10, 3, 11, 6, 14, 7, 15)):
                one, other = mixed(a, b, *pairs), mixed(c, d, *pairs)
                found += [mixed(one, other, 0, 1, 8, 9, 4, 5, 12, 13), mixed(one, other, 2, 3, 10, 11, 6, 7, 14, 15)]
            return found

        rows = [*columns(CORNER), *columns(CORNER + 16), columns(CORNER + 20)[3]]
        for k, row in enumerate(rows):
            builder.store(builder.fpext(row, wide), at(lane, k * LANES * 8, wide), align=8 * EIGHT)
        for k, sign in enumerate("<<<>>>"):
            place = at(extents, k * EIGHT * 4, eight)
            best = builder.load(place, align=4)
            for row in rows[k % 3 :: 3]:
                best = builder.select(builder.fcmp_ordered(sign, row, best), row, best)
            builder.store(best, place, align=4)
        return context.get_dummy_value()

    return types.void(types.voidptr, types.voidptr, types.voidptr), code


@njit(inline="always")
def fetch_eights(records, start, count, corner_at, corner, extents_at, extents):
    """Fill the lanes as `fetch_facets` does, and widen extents, (6, EIGHT) of float32, by the triangles."""
    if start + LANES <= count:
        for j in range(0, LANES, EIGHT):
            eight_facets(address(records, (start + j) * RECORD), address(corner_at, j * 8), extents_at)
    else:
        fetch_facets(records, start, count, corner_at, corner)
        for axis in range(3):
            for lane in range(LANES):
                for k in range(axis, 9, 3):
                    extents[axis, 0] = min(extents[axis, 0], np.float32(corner[k, lane]))
                    extents[axis + 3, 0] = max(extents[axis + 3, 0], np.float32(corner[k, lane]))
