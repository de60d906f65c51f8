"""Sums over many triangles with the digits that float64 loses, in 1.3 to twice the time of float64 alone.

The ten sums are those of `inertia.mass.triangles.sums`. Each coordinate is split into A, a multiple of a step of its
axis of at most 25 bits about an origin on that grid, and a remainder r of half a step or less. Of the multiples, edges,
normals, s and the brackets are integers of steps below 2⁵³: float64 has them exactly. What the remainders add is some
2⁻²⁴ of that, with a relative error of a few u = 2⁻⁵³. Products of d with s or a bracket are added to sums that are kept
on a grid of their own, coarse enough for their total to need 50 bits: the fused addition rounds each to that grid,
nothing else is rounded, and what is left of it goes to the sum of the remainders (the pre-rounding of J. Demmel, H. D.
Nguyen, *Fast reproducible floating-point summation*, ARITH 21, 2013).

Of a needle or a foil that does not lie along axes, the terms of d cancel. Where bounds are expected to be more than a
few roundings of the result, multiples of its longest coordinate x_i are taken from the other two, and of the next one
from the last, such that what is left has the extents of its width and thickness: that keeps volumes, and moments are
brought back in rational arithmetic. The factors have so few bits that multiples of the steps stay integers, now of a
finer step, on which what is left of them is split again.

Bounds, lengths in steps, with R the farthest A along an axis, u and v two edges, L² = N Σ (u² + v²) along an axis over
N triangles, g the step of the grid of d. A normal's remainder is m = u × q + p × w with w = v + q, where p and q are
what the remainders make of the edges, at most 1 along each axis. The four products of its coordinate x are at most
|w_y|, |w_z|, |u_z|, |u_y|; six, five, three and two roundings enter, and four, three or two of the product of A with m
and of what that is added to. By Cauchy's inequality, as Σ (10 |w| + 6 |u|) is below 12 L + 10 N, and Σ (9 |w| + 7 |u|)
below 12 L + 9 N, the remainders of d are together off by u Σ R (12 (L + L') + 19 N) over the three axes, L and L' along
the two others. To these come u (14 L + 11 N) of each axis from the product of the corner's remainder, half a step or
less, with m, 2.6 u L L' / N from that with n, and 9 u g N from the residues of the three products on the grid. With e
the sum of all that, B ≤ 12 R² a bracket, l the magnitudes of the remainders of d, which are summed too: the remainder
of a product with B is off by e B + u (2 B l + 84 R |d|) and one and a half u steps of its sum's grid: six remainders of
half a step or less that are added in pairs (12 R), at most six numbers they multiply (12 R), six fused additions (42
R), d and the last addition (18 R). It passes through 42 additions (32 down a lane, five across the lanes, four and one
across the blocks), each off by u of B l + 12 R |d| and half such a step. With s for the bracket it is S = 3 R for B. No
step of this holds unless Σ |d| is below 2⁵⁰ g, and so is what the three terms of one d can be, 24 times the product of
the three R.

A sheared coordinate is off by m = u (2 ρ + 1), where the remainders that it is made of are at most ρ of its steps.
Every corner at one place is moved alike: the surface stays closed, and an integral of f over the solid changes by at
most max |f| Σ m |n| / 2 along each axis, with |n| the magnitudes of that coordinate of the normals, whose sum Cauchy's
inequality has from the squares of the edges. Of the ten sums, f is 6, 24 x and 120 x x: five Σ m |n| in e will do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from inertia.arrays import Float
from inertia.mass.triangles.kernels import BlockKernel
from inertia.native import Kernel, address
from inertia.records import dataclass

ADDED, ROWS = 26, 34
"""Ten sums on their grids, their remainders, what the bounds need, Σ |n|; with the extents, stored and sheared."""

_ABI = "ddd" + "ddd" + "d" + "iii" + "ddd" + "ddd" + "pp"

KERNEL = BlockKernel(
    Kernel("inertia.mass.triangles.fine_kernel", "sum_facets", "pi" + _ABI, wide=True),
    Kernel("inertia.mass.triangles.fine_kernel", "sum_faces", "ppi" + _ABI, wide=True),
    columns=ROWS,
    room=11,
)

_SAMPLE = Kernel("inertia.mass.triangles.sample_kernel", "measure_sample", "piip")
_STATISTICS = 28  # as `sample_kernel.COLUMNS`

REACH = 1.6 * 2.0**24
"""Steps to the farthest corner: 12 of their squares are below 2⁵³."""

BITS = 50
"""Bits of a sum on its grid."""

SHARE = 2.0**-3
"""Of a step, what the factors of a shear times a step are multiples of."""

WORTHWHILE = 32.0
"""Times smaller the volume of a cell has to become by a shear."""

_AMPLE = 128.0
_FINEST = 2.0**-23  # of a step before the shear: sums of three products are exact below 2⁵³ shares of it
_SMALLEST = 2.0**-1000


@dataclass(frozen=True)
class Shear:
    """The axes i, j, k with x_j − p x_i and x_k − q x_i − r x_j for x_j and x_k, (p, q, r), and the steps (3,) then."""

    axes: tuple[int, int, int]
    factors: tuple[float, float, float]
    steps: tuple[float, ...]

    def matrix(self) -> Float:
        """Return what coordinates (3,) are multiplied by, (3, 3)."""
        (i, j, k), matrix = self.axes, np.eye(3)
        matrix[[j, k, k], [i, i, j]] = np.negative(self.factors)
        return matrix


@dataclass(frozen=True)
class Grid:
    """The origin (3,) and the steps (3,) of the coordinates, and the step of d; all steps are powers of two."""

    origin: tuple[float, ...]
    steps: tuple[float, ...]
    unit: float
    shear: Shear | None = None

    @property
    def finer(self) -> tuple[float, ...]:
        """The steps of the coordinates as they are multiplied."""
        return self.steps if self.shear is None else self.shear.steps

    def numbers(self) -> tuple[float, ...]:
        """Return what the kernels take."""
        axes, factors = ((-1, -1, -1), (0.0, 0.0, 0.0)) if self.shear is None else (self.shear.axes, self.shear.factors)
        return *self.origin, *self.steps, self.unit, *axes, *factors, *self.finer


@dataclass(frozen=True, eq=False)
class FineSums:
    """The ten sums (10,) about the origin of the grid, their remainders, and what the bounds need.

    `edges` (3,) are the sums of the squares of two edges, `size` that of the magnitudes of d, `rest` that of the
    magnitudes of what is added to its remainder; `far` (2,) has the largest magnitudes of the two coordinates that a
    shear changes.
    """

    grid: Grid
    high: list[float]
    low: list[float]
    edges: list[float]
    size: float
    rest: float
    far: list[float]

    @classmethod
    def of(cls, grid: Grid, added: list[float], far: list[float]) -> FineSums:
        """Name the sums (25,) of the columns."""
        return cls(grid, added[:10], added[10:20], added[20:23], added[23], added[24], far)


def grid_for(origin: Sequence[float], low: Sequence[float], high: Sequence[float], largest: float) -> Grid | None:
    """Return a grid for a box about a local origin and for sums of |d| of about `largest`; None for extreme sizes."""
    box = list(zip(origin, low, high, strict=True))
    reach = [max(b - o, o - a) for o, a, b in box]
    reach = [max(k, 2.0**-40 * max(reach)) for k in reach]
    farthest = [max(abs(a), abs(b)) + 2.0 * k for k, (_, a, b) in zip(reach, box, strict=True)]
    steps = [_power_above(max(1.25 * a / REACH, b * 2.0**-49)) for a, b in zip(reach, farthest, strict=True)]
    tops = [1.5 * 2.0**52 * step for step in steps]
    about = tuple((x + top) - top for x, top in zip(origin, tops, strict=True))
    return _checked(Grid(about, tuple(steps), _unit(reach, largest)))


@dataclass(frozen=True, eq=False)
class Sample:
    """Some of `count` triangles, (n, 3, 3), with the extents and the mean of their corners, (3,).

    `plain` is a grid for all of them, where it is sure that no shear is worth it. `products` are the elements xx, yy,
    zz, yz, zx, xy of ∑x xᵀ about the mean, `largest` is the largest sum of the magnitudes of the terms of d about the
    middle of the extents. `rough` says whether bounds on a grid without a shear are expected to be so.
    """

    corners: Float
    count: int
    low: list[float]
    high: list[float]
    mean: list[float]
    products: list[float]
    largest: float
    rough: bool
    plain: Grid | None

    @classmethod
    def of(cls, corners: Float, count: int) -> Sample:
        """Measure triangles, taken from so many."""
        out = np.empty(_STATISTICS)
        _SAMPLE.function(address(corners), len(corners), count, address(out))
        each = out.tolist()
        plain = Grid(tuple(each[21:24]), tuple(each[24:27]), each[27]) if each[20] else None
        return cls(corners, count, each[:3], each[3:6], each[6:9], each[9:15], each[15], bool(each[19]), plain)

    @property
    def is_finite(self) -> bool:
        """Whether all coordinates are finite, and their sums."""
        return math.isfinite(sum(self.mean))

    @property
    def is_askew(self) -> bool:
        """Whether a shear may make the cell of the corners smaller by as much as it has to."""
        xx, yy, zz, yz, zx, xy = self.products
        shrunk = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)
        return shrunk * WORTHWHILE < xx * yy * zz  # the square of the ratio; extents are no more than a few times off

    def grid(self, origin: Sequence[float]) -> Grid | None:
        """Return the grid for all triangles, sheared where that is worth it."""
        count = self.count
        plain = grid_for(origin, self.low, self.high, 4.0 * count * self.largest)
        if plain is None or not (self.rough and self.is_askew):
            return plain
        inner = np.ascontiguousarray((self.corners - self.mean).reshape(-1, 3).T)
        shear = _along_the_part(inner)
        placed = shear.matrix() @ inner
        least, most = placed.min(axis=1), placed.max(axis=1)
        middle = self.mean + np.linalg.solve(shear.matrix(), 0.5 * (least + most))
        about = grid_for(middle.tolist(), self.low, self.high, 0.0)
        if about is None:
            return plain
        shear = _on_steps(shear, about.steps, 0.5 * (most - least))
        if math.prod(shear.steps) * WORTHWHILE > math.prod(plain.steps):
            return plain
        sheared = (self.corners - np.array(about.origin)) @ shear.matrix().T
        unit = _unit(np.abs(sheared).max(axis=(0, 1)).tolist(), 4.0 * count * Sample.of(sheared, count).largest)
        return _checked(replace(about, unit=unit, shear=shear))


def grid_again(low: Float, high: Float, sums: FineSums) -> Grid | None:
    """Return the grid for triangles in this box whose sums are on a grid that does not suit them."""
    before = sums.grid.shear
    grid = grid_for(sums.grid.origin, low.tolist(), high.tolist(), 4.0 * sums.size)
    if grid is None or before is None:
        return grid
    reach = np.maximum(high - grid.origin, grid.origin - low)
    reach[list(before.axes[1:])] = sums.far
    return _checked(
        replace(grid, unit=_unit(reach.tolist(), 4.0 * sums.size), shear=_on_steps(before, grid.steps, reach))
    )


def _along_the_part(points: Float) -> Shear:
    """Return the shear that leaves the coordinates (3, n) without correlation, the longest first, without its steps."""
    products = points @ points.T
    i = int(np.argmax(products.diagonal()))
    by = products[i] / max(float(products[i, i]), _SMALLEST)
    rest = points - np.outer(by, points[i])
    products = rest @ rest.T
    j, k = sorted({0, 1, 2} - {i}, key=lambda axis: -float(products[axis, axis]))
    last = float(products[j, k]) / max(float(products[j, j]), _SMALLEST)
    return Shear((i, j, k), (float(by[j]), float(by[k]) - last * float(by[j]), last), (0.0,) * 3)


def _on_steps(shear: Shear, coarse: tuple[float, ...], reach: Float) -> Shear:
    """Return the shear with steps for coordinates that reach so far (3,), and factors to suit."""
    i, j, k = shear.axes
    steps = list(coarse)
    for axis in (j, k):
        steps[axis] = min(coarse[axis], max(_power_above(1.4 * float(reach[axis]) / REACH), _FINEST * coarse[axis]))
    shares = (SHARE * a / b for a, b in ((steps[j], steps[i]), (steps[k], steps[i]), (steps[k], coarse[j])))
    p, q, r = (round(factor / share) * share for factor, share in zip(shear.factors, shares, strict=True))
    return Shear(shear.axes, (p, q, r), tuple(steps))


def _unit(reach: Sequence[float], largest: float) -> float:
    return _power_above(max(_AMPLE * math.prod(reach), largest) * 2.0**-BITS)


def _checked(grid: Grid) -> Grid | None:
    return grid if 2.0**-300 < grid.unit < 2.0**300 else None


def _power_above(value: float) -> float:
    return math.ldexp(1.0, math.frexp(value)[1])
