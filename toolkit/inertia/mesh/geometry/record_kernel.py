"""The corners of triangles as kernels read them, of binary STL records too; and eight records at a time, as vectors.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

from functools import reduce

from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

RECORD = 50
"""Bytes from a binary STL record to the next."""

EIGHT, FEW = 8, 4
"""Records that are added together; triangles whose box is kept for `enter_cells`."""

BOX = 24
"""Bytes of such a box."""

SINGLE, DOUBLE = ir.FloatType(), ir.DoubleType()
TWO, FOUR, WIDE = (ir.VectorType(*of) for of in ((SINGLE, 2), (SINGLE, 4), (DOUBLE, EIGHT)))

FIRSTS, SECONDS = (0, 8, 1, 9, 4, 12, 5, 13), (2, 10, 3, 11, 6, 14, 7, 15)
"""Where vectors are mixed number by number: the lower and the upper pairs of their halves."""

LOWER, UPPER = (0, 1, 8, 9, 4, 5, 12, 13), (2, 3, 10, 11, 6, 7, 14, 15)
"""Where they are mixed pair by pair."""

SIGNS = "<<<>>>"
"""Which of two numbers counts for a box: three least and three largest coordinates."""


@intrinsic
def widened(context, base, offset):
    """Return a float32 so many bytes after an address, as float64."""

    def code(context, builder, signature, arguments):
        place = builder.bitcast(builder.gep(arguments[0], [arguments[1]]), SINGLE.as_pointer())
        return builder.fpext(builder.load(place, align=2), DOUBLE)

    return types.float64(types.voidptr, types.int64), code


@njit(error_model="numpy", forceinline=True)
def triangle(base, points, faces, records, k):
    """Return the three corners of a triangle: of those over vertices, or of records whose first number is at `base`."""
    if records:
        at = k * RECORD
        a = widened(base, at), widened(base, at + 4), widened(base, at + 8)
        b = widened(base, at + 12), widened(base, at + 16), widened(base, at + 20)
        return a, b, (widened(base, at + 24), widened(base, at + 28), widened(base, at + 32))
    p, q, r = faces[k, 0], faces[k, 1], faces[k, 2]
    a, b = (points[p, 0], points[p, 1], points[p, 2]), (points[q, 0], points[q, 1], points[q, 2])
    return a, b, (points[r, 0], points[r, 1], points[r, 2])


class Vectors:
    """Steps on vectors of numbers, as a builder of LLVM's writes them."""

    def __init__(self, builder):
        self.builder = builder

    def place(self, base, number, size, kind):
        """Return where the so-manieth thing of a size in bytes begins."""
        at = self.builder.mul(number, ir.IntType(64)(size))
        return self.builder.bitcast(self.builder.gep(base, [at]), kind.as_pointer())

    def mixed(self, one, other, places):
        """Return the numbers of two vectors at some places."""
        which = ir.Constant(ir.VectorType(ir.IntType(32), len(places)), [*places])
        return self.builder.shuffle_vector(one, other, which)

    def every(self, number):
        """Return a vector of eight times one number."""
        alone = self.builder.insert_element(ir.Constant(WIDE, ir.Undefined), number, ir.IntType(32)(0))
        return self.mixed(alone, alone, [0] * EIGHT)

    def best(self, sign, *several):
        """Return the least or the largest of several, number by number."""
        build = self.builder
        return reduce(lambda a, b: build.select(build.fcmp_ordered(sign, a, b), a, b), several)

    def plus(self, one, other):
        """Return sums; an addition and the product in it may be one step."""
        return self.builder.fadd(one, other, flags=("contract",))

    def minus(self, one, other):
        """Return differences."""
        return self.builder.fsub(one, other, flags=("contract",))

    def times(self, one, other):
        """Return products."""
        return self.builder.fmul(one, other, flags=("contract",))

    def dot(self, one, other):
        """Return scalar products of vectors in space."""
        return reduce(self.plus, map(self.times, one, other))

    def cross(self, u, v):
        """Return vector products of vectors in space."""
        ways = (1, 2), (2, 0), (0, 1)
        return [self.minus(self.times(u[i], v[j]), self.times(u[j], v[i])) for i, j in ways]

    def folded(self, vector, join):
        """Return the eight numbers of a vector as one."""
        lanes = EIGHT
        while lanes > 1:
            lanes //= 2
            vector = join(*(self.mixed(vector, vector, range(first, first + lanes)) for first in (0, lanes)))
        return self.builder.extract_element(vector, ir.IntType(32)(0))

    def four_of_eight(self, records, number, first):
        """Return four numbers one after another, from byte `first` on, of eight records: four vectors."""
        places = [self.builder.add(number, ir.IntType(64)(k)) for k in range(EIGHT)]
        after = self.builder.gep(records, [ir.IntType(64)(first)])
        rows = [self.builder.load(self.place(after, place, RECORD, FOUR), align=2) for place in places]
        a, b, c, d = (self.mixed(rows[k], rows[k + 4], range(EIGHT)) for k in range(4))
        halves = [(self.mixed(a, b, which), self.mixed(c, d, which)) for which in (FIRSTS, SECONDS)]
        return [self.mixed(*half, which) for half in halves for which in (LOWER, UPPER)]

    def corners(self, records, number):
        """Return the nine coordinates of eight records, from the `number`-th on: nine vectors."""
        return [
            *self.four_of_eight(records, number, 0),
            *self.four_of_eight(records, number, 16),
            self.four_of_eight(records, number, 20)[3],
        ]

    def write_boxes(self, extents, few, number):
        """Write the boxes of four triangles and of the next; extents are those of all eight, axis by axis."""
        halves = []
        for sign, (x, y, z) in (("<", extents[:3]), (">", extents[3:])):
            pairs = (
                self.best(sign, *(self.mixed(a, b, way) for way in (FIRSTS, SECONDS))) for a, b in ((x, y), (z, z))
            )
            xy, zz = pairs  # x y x y and z z z z, of either four
            halves.append(self.best(sign, *(self.mixed(xy, zz, way) for way in (LOWER, UPPER))))
        for part in range(EIGHT // FEW):
            low, high = (self.mixed(half, half, range(4 * part, 4 * part + 4)) for half in halves)
            row = self.builder.add(self.builder.udiv(number, ir.IntType(64)(FEW)), ir.IntType(64)(part))
            box = self.place(few, row, BOX, FOUR)
            self.builder.store(self.mixed(low, high, [0, 1, 2, 4]), box, align=4)
            rest = self.builder.bitcast(self.builder.gep(box, [ir.IntType(64)(1)]), TWO.as_pointer())
            self.builder.store(self.mixed(high, high, [1, 2]), rest, align=4)


def adder(fine):
    """Make the function that adds records, eight at a time, and with `fine` writes the boxes of each `FEW`."""

    @intrinsic
    def add(context, base, first, eights, x, y, z, few):
        """Return the box of 8 × `eights` ≥ 8 records, 6 × the volume about a place, and the squares of its terms."""

        def code(context, builder, signature, arguments):
            (base, first, eights, *middle, few), on = arguments, Vectors(builder)
            middle, rows = [on.every(number) for number in middle], on.corners(base, first)
            extents = [cgutils.alloca_once_value(builder, rows[k % 3]) for k in range(6)]
            sums = [cgutils.alloca_once_value(builder, ir.Constant(WIDE, [0.0] * EIGHT)) for _ in range(2)]
            with cgutils.for_range(builder, eights) as loop:
                number = builder.add(first, builder.mul(loop.index, ir.IntType(64)(EIGHT)))
                rows = on.corners(base, number)
                found = [on.best(sign, *rows[k % 3 :: 3]) for k, sign in enumerate(SIGNS)]
                for sign, each, extent in zip(SIGNS, found, extents, strict=True):
                    builder.store(on.best(sign, each, builder.load(extent)), extent)
                if fine:
                    on.write_boxes(found, few, number)
                a, b, c = ([builder.fpext(row, WIDE) for row in rows[k : k + 3]] for k in (0, 3, 6))
                u, v, arm = (list(map(on.minus, *ends)) for ends in ((b, a), (c, a), (a, middle)))
                size = on.times(on.times(on.dot(arm, arm), on.dot(u, u)), on.dot(v, v))
                for total, term in zip(sums, (on.dot(arm, on.cross(u, v)), size), strict=True):
                    builder.store(on.plus(builder.load(total), term), total)
            results = []
            for sign, extent in zip(SIGNS, extents, strict=True):
                of = on.folded(builder.load(extent), lambda one, other, sign=sign: on.best(sign, one, other))
                results.append(builder.fpext(of, DOUBLE))
            results += [on.folded(builder.load(total), on.plus) for total in sums]
            return context.make_tuple(builder, signature.return_type, results)

        kinds = types.voidptr, types.int64, types.int64, *[types.float64] * 3, types.voidptr
        return types.UniTuple(types.float64, 8)(*kinds), code

    return add


add_records, add_finely = adder(False), adder(True)
