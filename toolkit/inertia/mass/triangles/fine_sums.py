"""Sums over many triangles with the digits that float64 loses, in about twice the time of float64 alone.

The ten sums are those of `inertia.mass.triangles.sums`. Each coordinate is split into A, a multiple of
a step of its axis of at most 25 bits about an origin on that grid, and a remainder r of half a step or less. Of the
multiples, edges, normals, s and the brackets are integers of steps below 2⁵³: float64 has them exactly. What the
remainders add is some 2⁻²⁴ of that, with a relative error of a few u = 2⁻⁵³. Products of d with s or a bracket are
added to sums that are kept on a grid of their own, coarse enough for their total to need 50 bits: the fused addition
rounds each to that grid, nothing else is rounded, and what is left of it goes to the sum of the remainders (the
pre-rounding of J. Demmel, H. D. Nguyen, *Fast reproducible floating-point summation*, ARITH 21, 2013).

Bounds, per triangle, lengths in steps, with R the farthest A, e the magnitudes of the coordinates of two edges u and v,
S = 3 R, g the step of the grid of d. The remainder of a normal's coordinate x is below T = e_y + e_z + 2 and off by
6 u T. With P = Σ |A| T over the three axes, that of d is off by ε = u (12.1 P + 4.1 R e + 7 (e + 3) + 14 g): six u in
T, six fused additions, those of the normal itself, and the residues of the three products on the grid. Let l be its
magnitude. The remainder of a product with a bracket B ≤ 12 R² is off by ε B + u (2 B l + 84 R |d|) and one and a half u
steps of its sum's grid: six remainders of half a step or less that are added in pairs (12 R), six numbers they multiply
(12 R), six fused additions (42 R), d and the last addition (18 R). It passes through 42 additions (32 down a lane, five
across the lanes, four and one across the blocks), each off by u of B l + 12 R |d| and half such a step. With s for the
bracket it is S for B. The sums of e and P over the triangles are had from those of squares, by Cauchy's inequality. No
step of this holds unless Σ |d|, with the magnitudes of the three terms of d, is below 2⁵⁰ g.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float
from inertia.mass.triangles.kernels import BlockKernel
from inertia.native import Kernel

ROWS = 36
"""Ten sums on their grids, their remainders, what the bounds need, Σ |n|, and the extents."""

KERNEL = BlockKernel(
    Kernel("inertia.mass.triangles.fine_kernel", "sum_facets", "pi" + 2 * "ddd" + "d" + "pp", wide=True),
    Kernel("inertia.mass.triangles.fine_kernel", "sum_faces", "ppi" + 2 * "ddd" + "d" + "pp", wide=True),
    columns=ROWS,
    room=32,
)

REACH = 1.6 * 2.0**24
"""Steps to the farthest corner: 12 of their squares are below 2⁵³."""

BITS = 50
"""Bits of a sum on its grid."""

_AMPLE = 64.0


@dataclass(frozen=True)
class Grid:
    """The origin (3,) and the steps (3,) of the coordinates, and the step of d; all steps are powers of two."""

    origin: tuple[float, ...]
    steps: tuple[float, ...]
    unit: float


@dataclass(frozen=True, eq=False)
class FineSums:
    """The ten sums (10,) about the origin of the grid, their remainders, and what the bounds need.

    `edges` and `places` (3,) are the sums of the squares of two edges and of the first corner, `terms`, `size` and
    `rest` those of the magnitudes of the three terms of d, of d, and of its remainder.
    """

    grid: Grid
    high: Float
    low: Float
    edges: Float
    places: Float
    terms: float
    size: float
    rest: float

    @classmethod
    def of(cls, grid: Grid, added: Float) -> FineSums:
        """Name the sums (29,) of the columns."""
        return cls(grid, added[:10], added[10:20], added[20:23], added[23:26], *added[26:29].tolist())


def grid_for(origin: Float, low: Float, high: Float, largest: float) -> Grid | None:
    """Return a grid for a box about a local origin and for sums of |d| of about `largest`; None for extreme sizes."""
    reach = np.maximum(high - origin, origin - low)
    reach = np.maximum(reach, 2.0**-40 * reach.max())
    farthest = np.maximum(np.abs(low), np.abs(high)) + 2.0 * reach
    steps = [_power_above(max(1.25 * a / REACH, b * 2.0**-49)) for a, b in zip(reach, farthest, strict=True)]
    unit = _power_above(max(_AMPLE * float(np.prod(reach)), largest) * 2.0**-BITS)
    if not 2.0**-300 < unit < 2.0**300:
        return None
    tops = [1.5 * 2.0**52 * step for step in steps]
    return Grid(tuple((x + top) - top for x, top in zip(origin.tolist(), tops, strict=True)), tuple(steps), unit)


def sample_grid(origin: Float, corners: Float, count: int) -> Grid | None:
    """Return the grid for `count` triangles of which these (n, 3, 3) are a sample."""
    points = corners.reshape(-1, 3)
    a = np.abs(corners[:, 0] - origin)
    u, v = (np.abs(corners[:, k] - corners[:, 0]) for k in (1, 2))
    terms = sum(a[:, i] * (u[:, i - 2] * v[:, i - 1] + u[:, i - 1] * v[:, i - 2]) for i in range(3))
    return grid_for(origin, points.min(axis=0), points.max(axis=0), 4.0 * count * float(np.max(terms)))


def _power_above(value: float) -> float:
    return math.ldexp(1.0, math.frexp(value)[1])
