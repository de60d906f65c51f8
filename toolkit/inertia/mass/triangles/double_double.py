"""Sum the moments of triangles in double-double: some 30 digits, for about five times the price of float64.

The sums, their order and the origin are those of `inertia.mass.triangles.sums`; every number is the unevaluated sum of
two float64. Differences of coordinates are exact (Knuth's two-sum); products lose the term of the two low parts.

Each operation is off by at most 8u² = 2⁻¹⁰³ of the magnitudes that enter it, u = 2⁻⁵³: the sloppy addition by
5u² (|x| + |y|), the product by 8u² |x y| (M. Joldeş, J.-M. Muller, V. Popescu, *Tight and rigorous error bounds for
basic building blocks of double-word arithmetic*, ACM TOMS 44, 2017, algorithms 5 and 11; the figures here are looser
and hold for both variants below).

The compiled kernel gets the error of a product by a fused multiply-add, the numpy path by Dekker's splitting; both
are exact, so the answers have the same bits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from inertia.arrays import Float, Progress
from inertia.mass.triangles.kernels import BLOCK, DEPTH, LANES, BlockKernel
from inertia.mass.triangles.moments_from_sums import Roundings
from inertia.mass.triangles.sums import Sums
from inertia.mesh.part import Triangles
from inertia.native import Kernel

METHOD = "double-double, a-priori bound"

ROUNDINGS = Roundings(Fraction(1, 2**103), normal=5, corner=2, bracket=7, blocks=2)
"""Five in d (a product and a difference for the normal, a product and two additions), two in s, seven in a bracket (two
additions for each s, their product, two additions), two for the sum of the blocks.
"""

_TERMS = 10
_KERNEL = BlockKernel(
    Kernel("inertia.mass.triangles.double_double_kernel", "sum_facets", "pi" + "ddd" + "pp"),
    Kernel("inertia.mass.triangles.double_double_kernel", "sum_faces", "ppi" + "ddd" + "pp"),
    columns=2 * _TERMS,
)
_CHUNK = 32 * BLOCK
_SPLIT = 134217729.0  # 2²⁷ + 1

_Pair = tuple[Float, Float]


def sum_in_double_double(triangles: Triangles, sums: Sums, progress: Progress | None = None) -> tuple[Fraction, ...]:
    """Return the ten sums of a solid, in the frame of the float64 `sums` of the same triangles."""
    if sums.exponent == 0 and _KERNEL.worthwhile(triangles):
        runs = _KERNEL.rows(triangles, tuple(sums.origin.tolist()))
    else:
        runs = _vectorised(triangles, sums.origin, sums.exponent)
    blocks = []
    for stop, rows in runs:
        blocks.append(rows)
        if progress is not None:
            progress(stop / triangles.count)
    table = np.concatenate(blocks).reshape(-1, _TERMS, 2)
    return tuple(_exact_sum(pairs.ravel().tolist()) for pairs in table.transpose(1, 0, 2))


def _exact_sum(values: list[float]) -> Fraction:
    """Add up floats to within a part in 2¹⁰⁵."""
    high = math.fsum(values)
    return Fraction(high) + Fraction(math.fsum([*values, -high]))


def _vectorised(triangles: Triangles, origin: Float, exponent: int) -> Iterator[tuple[int, Float]]:
    for start in range(0, triangles.count, _CHUNK):
        stop = min(start + _CHUNK, triangles.count)
        corners = triangles.corners(start, stop).reshape(-1, 9)
        triangles.release(start, stop)
        padded = np.empty((-(-len(corners) // BLOCK) * BLOCK, 9))
        padded[: len(corners)] = corners
        padded[len(corners) :] = np.tile(corners[0, :3], 3)
        rows = np.ldexp(padded, exponent).reshape(-1, LANES, 9).transpose(0, 2, 1)
        total = _blocks(rows, np.ldexp(origin, exponent))
        while total[0].shape[-1] > 1:
            half = total[0].shape[-1] // 2
            total = _add((total[0][..., :half], total[1][..., :half]), (total[0][..., half:], total[1][..., half:]))
        yield stop, np.concatenate(total, axis=-1).reshape(-1, 2 * _TERMS)


def _blocks(rows: Float, origin: Float) -> _Pair:
    corners = rows.reshape(-1, DEPTH, 3, 3, LANES)  # block, row, corner, axis, lane
    x0, x1, x2 = (corners[:, :, k].transpose(2, 0, 1, 3) for k in range(3))
    o = -origin[:, None, None, None]
    u, v = _two_sum(x1, -x0), _two_sum(x2, -x0)
    a, b, c = _two_sum(x0, o), _two_sum(x1, o), _two_sum(x2, o)
    n = [_add(_mul(_at(u, i), _at(v, j)), _minus(_mul(_at(u, j), _at(v, i)))) for i, j in ((1, 2), (2, 0), (0, 1))]
    d = _add(_dot(_at(a, 0), n[0], _at(a, 1), n[1]), _mul(_at(a, 2), n[2]))
    t = _add(a, b)
    s = _add(t, c)
    terms = [d, *(_mul(d, _at(s, i)) for i in range(3))]
    terms += [
        _mul(d, _add(_dot(_at(a, i), _at(a, i), _at(b, i), _at(t, i)), _mul(_at(c, i), _at(s, i)))) for i in range(3)
    ]
    terms += [
        _mul(
            d,
            _add(_dot(_at(s, i), _at(s, j), _at(a, i), _at(a, j)), _dot(_at(b, i), _at(b, j), _at(c, i), _at(c, j))),
        )
        for i, j in ((1, 2), (2, 0), (0, 1))
    ]
    high, low = np.stack([term[0] for term in terms], axis=1), np.stack([term[1] for term in terms], axis=1)
    total = np.zeros_like(high[:, :, 0]), np.zeros_like(high[:, :, 0])
    for row in range(DEPTH):
        total = _add(total, (high[:, :, row], low[:, :, row]))
    return total


def _at(pair: _Pair, axis: int) -> _Pair:
    return pair[0][axis], pair[1][axis]


def _minus(pair: _Pair) -> _Pair:
    return -pair[0], -pair[1]


def _two_sum(a: Float, b: Float) -> _Pair:
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


def _add(x: _Pair, y: _Pair) -> _Pair:
    h, e = _two_sum(x[0], y[0])
    e = e + (x[1] + y[1])
    s = h + e
    return s, e - (s - h)


def _mul(x: _Pair, y: _Pair) -> _Pair:
    h = x[0] * y[0]
    (a, b), (c, d) = _halves(x[0]), _halves(y[0])
    e = (((a * c - h) + a * d + b * c) + b * d) + (x[0] * y[1] + x[1] * y[0])
    s = h + e
    return s, e - (s - h)


def _halves(a: Float) -> _Pair:
    """Split 53 bits into two halves of 26 (Dekker)."""
    t = _SPLIT * a
    high = t - (t - a)
    return high, a - high


def _dot(a: _Pair, b: _Pair, c: _Pair, d: _Pair) -> _Pair:
    return _add(_mul(a, b), _mul(c, d))
