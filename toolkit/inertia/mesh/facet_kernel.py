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
def widen(context, record, triangle):
    """Widen the nine coordinates in a record; eight of them are one vector."""

    def code(context, builder, signature, arguments):
        record, triangle = arguments
        for first, count in ((0, 8), (8, 1)):
            narrow, wide = (
                ir.VectorType(kind, count) if count > 1 else kind for kind in (ir.FloatType(), ir.DoubleType())
            )
            source = builder.gep(record, [ir.IntType(64)(4 * first)])
            number = builder.load(builder.bitcast(source, narrow.as_pointer()), align=2)
            target = builder.gep(triangle, [ir.IntType(64)(8 * first)])
            builder.store(builder.fpext(number, wide), builder.bitcast(target, wide.as_pointer()), align=8)
        return context.get_dummy_value()

    return types.void(types.voidptr, types.voidptr), code


@intrinsic
def after(context, base, offset):
    """Return the address `offset` bytes after `base`."""

    def code(context, builder, signature, arguments):
        return builder.gep(arguments[0], [arguments[1]])

    return types.voidptr(types.voidptr, types.int64), code


def widen_facets(first, count, corners):
    """Write the corners, (count, 9) float64, of binary STL records, from the first coordinate of the first on."""
    for k in range(count):
        widen(after(first, RECORD * k), after(corners, CORNERS * k))
    return 0
