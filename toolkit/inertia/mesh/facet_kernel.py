"""The compiled widening of the corners of binary STL records to float64, in a third of numpy's time.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

RECORD = 50
"""Bytes from a binary STL record to the next."""

CORNERS = 9 * 8
"""Bytes of a triangle's corners, widened."""


@intrinsic
def widen(context, records, corners, k):
    """Widen the nine coordinates in the k-th record to the corners of a triangle; eight of them are one vector."""

    def code(context, builder, signature, arguments):
        records, corners, k = arguments

        def number(base, size, offset, kind):
            at = builder.add(builder.mul(k, ir.IntType(64)(size)), ir.IntType(64)(offset))
            return builder.bitcast(builder.gep(base, [at]), kind.as_pointer())

        single, double = ir.FloatType(), ir.DoubleType()
        for first, narrow, wide in ((0, ir.VectorType(single, 8), ir.VectorType(double, 8)), (8, single, double)):
            stored = builder.load(number(records, RECORD, 4 * first, narrow), align=2)
            builder.store(builder.fpext(stored, wide), number(corners, CORNERS, 8 * first, wide), align=8)
        return context.get_dummy_value()

    return types.void(types.voidptr, types.voidptr, types.int64), code


def widen_facets(first, count, corners):
    """Write the corners, (count, 9) float64, of binary STL records, from the first coordinate of the first on."""
    for k in range(count):
        widen(first, corners, k)
    return 0
