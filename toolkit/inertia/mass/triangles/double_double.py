"""Sum the moments of triangles in double-double: some 30 digits, for about five times the price of float64.

The sums, their order and the origin are those of `inertia.mass.triangles.sums`; every number is the unevaluated sum of
two float64. Differences of coordinates are exact (Knuth's two-sum); products lose the term of the two low parts.

For a shell |n| takes the place of d; those run without a compiled kernel. What each operation may be off by is that of
`inertia.mass.double_words`.

The compiled kernel gets the error of a product by a fused multiply-add, the numpy path by Dekker's splitting; both
are exact, so the answers have the same bits.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from inertia.arrays import Float, Progress
from inertia.mass.double_words import UNIT, Pair, near_pair
from inertia.mass.triangles.kernels import BLOCK, DEPTH, LANES, BlockKernel
from inertia.mass.triangles.moments_from_sums import Roundings
from inertia.mass.triangles.sums import Sums
from inertia.mesh.surface import Triangles
from inertia.native import SHIPPED_ABOVE, Kernel

METHOD = "double-double, a-priori bound"

ROUNDINGS = Roundings(Fraction(UNIT), normal=5, corner=2, bracket=7, blocks=2)
"""Five in d (a product and a difference for the normal, a product and two additions; in |n| half of these and a root),
two in s, seven in a bracket (two
additions for each s, their product, two additions), two for the sum of the blocks.
"""

_TERMS = 10
_KERNEL = BlockKernel(
    Kernel("inertia.mass.triangles.double_double_kernel", "sum_facets", "pi" + "ddd" + "pp", wide=True),
    Kernel("inertia.mass.triangles.double_double_kernel", "sum_faces", "ppi" + "ddd" + "pp", wide=True),
    columns=2 * _TERMS,
    cost=2,
    least=SHIPPED_ABOVE,
)
_CHUNK = 32 * BLOCK


def compiled(triangles: Triangles, sums: Sums) -> bool:
    """Say whether a compiled kernel forms the sums of a solid."""
    return sums.exponent == 0 and _KERNEL.worthwhile(triangles)


def sum_in_double_double(
    triangles: Triangles, sums: Sums, progress: Progress | None = None, *, surface: bool = False
) -> tuple[list[float], list[float]]:
    """Return the ten sums of a solid or shell, in the frame of the float64 `sums` of the same triangles.

    Of each there is the sum in float64, and what that leaves of it.
    """
    if not surface and compiled(triangles, sums):
        runs = _KERNEL.rows(triangles, tuple(sums.origin.tolist()))
    else:
        runs = _vectorised(triangles, sums.origin, sums.exponent, surface)
    blocks = []
    for stop, rows in runs:
        blocks.append(rows)
        if progress is not None:
            progress(stop / triangles.count)
    table = blocks[0] if len(blocks) == 1 else np.concatenate(blocks)
    terms = table.reshape(-1, _TERMS, 2).transpose(1, 0, 2).reshape(_TERMS, -1).tolist()
    high, low = zip(*map(near_pair, terms), strict=True)
    return list(high), list(low)


def _vectorised(triangles: Triangles, origin: Float, exponent: int, surface: bool) -> Iterator[tuple[int, Float]]:
    for start in range(0, triangles.count, _CHUNK):
        stop = min(start + _CHUNK, triangles.count)
        corners = triangles.corners(start, stop).reshape(-1, 9)
        padded = np.empty((-(-len(corners) // BLOCK) * BLOCK, 9))
        padded[: len(corners)] = corners
        padded[len(corners) :] = np.tile(corners[0, :3], 3)
        rows = np.ldexp(padded, exponent).reshape(-1, LANES, 9).transpose(0, 2, 1)
        total = _blocks(rows, np.ldexp(origin, exponent), surface)
        while total.high.shape[-1] > 1:
            half = total.high.shape[-1] // 2
            total = total[..., :half] + total[..., half:]
        yield stop, np.concatenate([total.high, total.low], axis=-1).reshape(-1, 2 * _TERMS)


def _blocks(rows: Float, origin: Float, surface: bool) -> Pair:
    corners = rows.reshape(-1, DEPTH, 3, 3, LANES)  # block, row, corner, axis, lane
    x0, x1, x2 = (corners[:, :, k].transpose(2, 0, 1, 3) for k in range(3))
    o = -origin[:, None, None, None]
    u, v = Pair.sum_of(x1, -x0), Pair.sum_of(x2, -x0)
    a, b, c = Pair.sum_of(x0, o), Pair.sum_of(x1, o), Pair.sum_of(x2, o)
    n = [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]
    along = n if surface else [a[i] for i in range(3)]
    d = along[0] * n[0] + along[1] * n[1] + along[2] * n[2]
    d = d.root() if surface else d
    t = a + b
    s = t + c
    terms = [d, *(d * s[i] for i in range(3))]
    terms += [d * (a[i] * a[i] + b[i] * t[i] + c[i] * s[i]) for i in range(3)]
    terms += [d * ((s[i] * s[j] + a[i] * a[j]) + (b[i] * b[j] + c[i] * c[j])) for i, j in ((1, 2), (2, 0), (0, 1))]
    high, low = np.stack([term.high for term in terms], axis=1), np.stack([term.low for term in terms], axis=1)
    total = Pair(np.zeros_like(high[:, :, 0]), np.zeros_like(high[:, :, 0]))
    for row in range(DEPTH):
        total = total + Pair(high[:, :, row], low[:, :, row])
    return total
