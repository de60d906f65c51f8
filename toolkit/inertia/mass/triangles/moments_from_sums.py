"""Moments of a mesh from the sums over its triangles, with a-priori bounds on what rounding did to them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from math import inf, ldexp, prod, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.mass.moments import PAIRS, Moments, Over, dyadic, over, times
from inertia.mass.triangles.fine_sums import BITS, REACH, SHARE, FineSums, Shear
from inertia.mass.triangles.kernels import BLOCK, DEPTH, LANES
from inertia.mass.triangles.sums import PlainSums, Sums, SumsOnGrid
from inertia.records import dataclass

ROUNDOFF = 2.0**-53


@dataclass(frozen=True)
class Roundings:
    """How many errors of `unit`, relative to the magnitudes that enter, a term of the sums passes through.

    `normal`: in d; `corner`: in s; `bracket`: in the brackets; `blocks`: where the rows of the blocks are added. To
    these come one for the product of d with s or a bracket, and those of the additions within a block.
    """

    unit: Fraction
    normal: int
    corner: int
    bracket: int
    blocks: int

    def across(self, count: int) -> int:
        """Return the most additions that the term of one of `count` triangles passes through."""
        within = min(DEPTH, -(-count // LANES)) + LANES.bit_length() - 1
        return within + min(self.blocks, (-(-count // BLOCK)).bit_length() + 1)

    def most(self, count: int) -> float:
        """Return a bound on the error of any of the ten sums over so many triangles, relative to what enters."""
        return (self.normal + self.bracket + self.across(count) + 2) * float(self.unit)


FLOAT64 = Roundings(Fraction(1, 2**53), normal=8, corner=3, bracket=10, blocks=5)
"""The roundings of `inertia.mass.triangles.sums`.

Eight in d (two edges and a product: 3, the difference: 1, the corner: 1, its product: 1, two additions: 2), three in
s (a corner, two additions), ten in a bracket (three for each s, their product, three additions), four additions across
blocks and one for the final sum.
"""


def moments_of(sums: PlainSums, *, surface: bool = False, bounds: Sequence[float] | None = None) -> Moments:
    """Turn the sums over triangles into moments with bounds, in the file's unit.

    For a solid, V = Σd/6, ∫x = Σd s/24, ∫x xᵀ = Σd(…)/120 (twice that on the diagonal); for a shell, with |n| for d,
    A = Σ|n|/2, ∫x = Σ|n|s/6, ∫x xᵀ = Σ|n|(…)/24.

    Parameters
    ----------
    bounds : (10,) on the errors of the sums, twice that on the diagonal; the a-priori ones where they are left out
    """
    values = sums.sums[:10].tolist()
    return moments_with_bounds(dyadic(values), bounds or a_priori(values, sums, FLOAT64), sums, surface=surface)


def moments_with_bounds(values: Over, bounds: Sequence[float], sums: Sums, *, surface: bool = False) -> Moments:
    """Turn ten sums in the frame of `sums`, and bounds on their errors, twice that on the diagonal, into moments.

    What underflow can add, at most 100 smallest normal numbers a triangle (in a shell 2⁻⁵⁰⁰, as a square root is
    taken of the squares of n) times the four lengths that may multiply them, is added.
    """
    reach = _reach(sums)
    tiny = sums.count * (2.0**-500 if surface else 100 * 2.0**-1022) * max(1.0, *reach) ** 4
    zeroth, first, second = _factors(sums.exponent, surface)
    k, d = values
    b, e = dyadic([(k + tiny) * _INFLATED for k in bounds])
    return Moments.over(
        origin=dyadic(sums.origin.tolist()),
        zeroth=times((k[:1], d), zeroth),
        first=times((k[1:4], d), first),
        second=times(([2 * each for each in k[4:7]] + k[7:], d), second),
        zeroth_bound=times((b[:1], e), zeroth),
        first_bound=times((b[1:4], e), first),
        second_bound=times((b[4:], e), second),
    )


@cache
def _factors(exponent: int, surface: bool) -> tuple[Fraction, Fraction, Fraction]:
    """Return what the sums are multiplied by for the zeroth, first and second moments."""
    shrink = Fraction(2) ** -exponent
    unit = shrink ** (2 if surface else 3)
    zeroth, first, second = (2, 6, 24) if surface else (6, 24, 120)
    return unit / zeroth, unit * shrink / first, unit * shrink**2 / second


def in_two_parts(high: Sequence[float], low: Sequence[float]) -> Over:
    """Return ten sums of two floats each over one denominator."""
    parts, d = dyadic([*high, *low])
    return [a + b for a, b in zip(parts[:10], parts[10:], strict=True)], d


def distances(sums: PlainSums, high: Sequence[float], low: Sequence[float], bounds: Sequence[float]) -> list[float]:
    """Return bounds (10,) on the errors of Σd, Σd s and Σd(…) of a solid, twice that on the diagonal.

    They are the distances from sums of more digits, in two parts, and the bounds on the errors of these.
    """
    result = []
    for number, (k, a, b, bound) in enumerate(zip(sums.sums[:10].tolist(), high, low, bounds, strict=True)):
        apart = abs((k - a) - b) + 4.0 * ROUNDOFF * (abs(k - a) + abs(b))  # with what rounding did to it
        result.append((2 if number in (4, 5, 6) else 1) * apart + bound)
    return result


def fine_values(sums: Sums) -> tuple[Over, list[float]] | None:
    """Return the ten sums with the digits that float64 loses, and bounds on their errors, twice that on the diagonal.

    The sums are integers over a common denominator, as rational arithmetic would look for common factors at every step.
    The bounds are those of `inertia.mass.triangles.fine_sums`. None where the sums were not formed so, or on a grid
    that does not suit the part.
    """
    if not isinstance(sums, SumsOnGrid):
        return None
    fine, grid, count = sums.fine, sums.fine.grid, sums.count
    box = list(zip(sums.low.tolist(), sums.high.tolist(), grid.origin, grid.steps, strict=True))
    far = [max(abs(a - o), abs(b - o)) / step + 1.0 for a, b, o, step in box]
    if any(max(abs(a), abs(b)) > 2.0**50 * step for a, b, _, step in box):
        return None
    moved = [0.0, 0.0, 0.0]
    if grid.shear is not None:
        far, moved = _sheared(far, fine, grid.shear)
    if max(far) > REACH:
        return None
    cube = prod(grid.finer)
    lengths = [sqrt(count * k) / step for k, step in zip(fine.edges, grid.finer, strict=True)]
    unit, total, rest = grid.unit / cube, fine.size / cube, 1.001 * fine.rest / cube
    steps = unit * count
    if not max(1.001 * total + 4.0 * steps, 24.1 * prod(far)) <= 2.0**BITS * unit:
        return None
    arms = sum(far[i] * (12.0 * (lengths[i - 2] + lengths[i - 1]) + 19.0 * count) for i in range(3))
    normals = sum(lengths[i - 2] * lengths[i - 1] for i in range(3)) / count
    off = 1.001 * (arms + 2.6 * normals + 14.0 * sum(lengths) + 33.0 * count + 9.0 * steps)
    if grid.shear is not None:
        edges = [length / sqrt(count) + sqrt(2.0 * count) for length in lengths]
        off += 5.0 * sum(moved[k] * edges[k - 2] * edges[k - 1] for k in range(3))
    bounds = [cube * ROUNDOFF * (off + 42.0 * rest)]
    for r, step in zip(far, grid.finer, strict=True):
        product = r * (3.0 * off + 132.0 * rest) + 70.0 * total + 23.0 * 2.0**27 * steps
        bounds.append(cube * step * ROUNDOFF * product)
    for i, j in PAIRS:
        r, s = far[i], far[j]
        product = r * s * (12.0 * off + 528.0 * rest) + 320.0 * (r + s) * total + 23.0 * 2.0**53 * steps
        bounds.append(cube * grid.finer[i] * grid.finer[j] * ROUNDOFF * product)
    values = in_two_parts(fine.high, fine.low)
    if grid.shear is not None:
        values, bounds = _unsheared(values, bounds, grid.shear)
    (v, x, y, z, *second), d = values
    once = [2 * v, 2 * x, 2 * y, 2 * z, *second[:3], *(2 * k for k in second[3:])], 2 * d
    return _shortened(once, min(bounds)), [_AMPLY * bound for bound in bounds]


def _shortened(values: Over, bound: float) -> Over:
    """Return dyadic numbers without the bits below a billionth of a bound, which all that follows would carry."""
    numbers, d = values
    n, e = bound.as_integer_ratio()
    spare = (n * d // e).bit_length() - 31
    return ([k >> spare for k in numbers], d >> spare) if 0 < spare < d.bit_length() else values


def _sheared(far: list[float], fine: FineSums, shear: Shear) -> tuple[list[float], list[float]]:
    """Return how far the sheared coordinates reach, and what their roundings move them by in u, both in steps.

    They reach to infinity where multiples of a step may not be exact.
    """
    far, moved = list(far), [0.0, 0.0, 0.0]
    (i, j, k), (p, q, r) = shear.axes, map(abs, shear.factors)
    parts = {k: ((i, q), (j, r), (k, 1.0)), j: ((i, p), (j, 1.0))}
    for (axis, factors), farthest in zip(parts.items(), fine.far[::-1], strict=True):
        step = shear.steps[axis]
        own = [(far[each], factor * fine.grid.steps[each] / step) for each, factor in factors]
        moved[axis] = sum(length for _, length in own) + 1.0
        exact = sum(reach * length for reach, length in own) <= SHARE * 2.0**53
        far[axis] = farthest / step + 1.0 if exact else inf
    return far, moved


def _unsheared(values: Over, bounds: list[float], shear: Shear) -> tuple[Over, list[float]]:
    """Return the ten sums, twice that on the diagonal, and bounds on their errors, in the coordinates as stored."""
    (i, j, k), (one, two, three) = shear.axes, map(Fraction, shear.factors)
    (p, q, r), e = over([one, two + three * one, three])
    rows = np.array([[e if a == b else 0 for b in range(3)] for a in range(3)], object)
    rows[j, i], rows[k, i], rows[k, j] = p, q, r
    whole, d = values
    first, second = rows @ np.array(whole[1:4], object), rows @ _matrix(whole[4:], object) @ rows.T
    size = np.abs(rows / e).astype(np.float64)
    larger = size @ _matrix(bounds[4:], np.float64) @ size.T
    return (
        ([whole[0] * e * e, *(e * n for n in first), *(second[a] for a in PAIRS)], d * e * e),
        [bounds[0], *(size @ bounds[1:4]).tolist(), *(float(larger[a]) for a in PAIRS)],
    )


def _matrix(six: Sequence[int] | Sequence[float], kind: type) -> NDArray[Any]:
    """Return the symmetric matrix (3, 3) of six elements."""
    xx, yy, zz, yz, zx, xy = six
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]], kind)


def _reach(sums: Sums) -> list[float]:
    """Return the largest distances from the origin along the axes, in the scaled frame."""
    box = zip(sums.low.tolist(), sums.high.tolist(), sums.origin.tolist(), strict=True)
    return [ldexp(max(abs(b - o), abs(a - o)), sums.exponent) * _INFLATED for a, b, o in box]


_AMPLY = 1.0 + 1e-5
"""More than the arithmetic of the bounds can add."""

_INFLATED = 1.0 + 1e-9
"""More than the arithmetic of the bounds, the products of two γ and the roundings of P and D can take from them."""


def roughest(sums: PlainSums, relative: float) -> list[float]:
    """Return bounds like `a_priori` with every triangle as far out as the farthest: larger, and sooner formed.

    `relative` bounds the error relative to the magnitudes that enter.
    """
    reach = _reach(sums)
    size = relative * _INFLATED * float(sums.sums[10] + sums.sums[12])
    return [size, *(3 * r * size for r in reach), *(12 * reach[i] * reach[j] * size for i, j in PAIRS)]


def a_priori(value: Sequence[float], sums: PlainSums, roundings: Roundings) -> list[float]:
    """Return a-priori bounds on the errors of Σd, Σd s and Σd(…), twice that on the diagonal.

    A product of k numbers and sums each known to a relative error of u is off by at most γₖ = k u/(1 − k u) of its
    magnitude (Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., lemma 3.1). So a term d B, with a
    bracket B (or an s), is off by at most

        γ p |B|  (roundings in d)  +  γ |d| M  (those in B, M: with the magnitudes of all that enters)
        +  γ |d B|  (those of the product and of the additions),

    each with the γ of its own count. With X, Y the largest distances from the origin along two axes, P = Σp, D = Σ|d|:

    - |B| ≤ 6 X² on the diagonal and M ≤ 4 B, since B = ½ (s² + a² + b² + c²) and M ≤ 2 (a² + b² + c²);
    - E = Σ |d| B ≤ Σ d B + 6 X² (D − Σ d), the last factor being twice the sum of the |d| with d < 0;
    - off the diagonal (where brackets are taken twice) Σ |d B| ≤ 2 √(E_xx E_yy) and Σ |d| M ≤ 8 √(E_xx E_yy), by
      Cauchy's inequality;
    - Σ |d s| ≤ √(2 D E), Σ |d| M ≤ √(6 D E) in the first moments.
    """
    reach = _reach(sums)
    unit = float(roundings.unit) * _INFLATED
    additions = roundings.across(sums.count) * unit
    across = additions + unit  # and the product before them
    normal, corner, bracket = (k * unit for k in (roundings.normal, roundings.corner, roundings.bracket))
    magnitude, total = float(sums.sums[10]) * _INFLATED, float(sums.sums[12]) * _INFLATED
    slack = 1e-12 * (magnitude + total)  # far more than the errors of the sums that take part here
    negative = max(total - value[0] + slack, 0.0)
    weighted = [min(6 * x * x * total, max(value[4 + i], 0.0) + 6 * x * x * negative) for i, x in enumerate(reach)]
    first = [
        3 * x * normal * magnitude
        + corner * min(3 * x * total, sqrt(6 * total) * sqrt(e))
        + across * min(3 * x * total, sqrt(2 * total) * sqrt(e))
        for x, e in zip(reach, weighted, strict=True)
    ]
    second = [
        12 * x * x * normal * magnitude + 2 * (bracket * min(6 * x * x * total, 4 * e) + across * e)
        for x, e in zip(reach, weighted, strict=True)
    ]
    for i, j in PAIRS[3:]:
        largest, both = 12 * reach[i] * reach[j], sqrt(weighted[i]) * sqrt(weighted[j])
        second.append(
            largest * normal * magnitude
            + bracket * min(largest * total, 8 * both)
            + across * min(largest * total, 2 * both)
        )
    return [normal * magnitude + additions * total, *first, *second]
