"""Moments of a mesh from the sums over its triangles, with a-priori bounds on what rounding did to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import sqrt

import numpy as np

from inertia.arrays import Float
from inertia.mass.moments import PAIRS, Moments, six, vector
from inertia.mass.triangles.kernels import BLOCK, DEPTH, LANES
from inertia.mass.triangles.sums import Sums


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


FLOAT64 = Roundings(Fraction(1, 2**53), normal=8, corner=3, bracket=10, blocks=5)
"""The roundings of `inertia.mass.triangles.sums`.

Eight in d (two edges and a product: 3, the difference: 1, the corner: 1, its product: 1, two additions: 2), three in
s (a corner, two additions), ten in a bracket (three for each s, their product, three additions), four additions across
blocks and one for the final sum.
"""


def moments_of(sums: Sums, *, surface: bool = False, running: Float | None = None) -> Moments:
    """Turn the sums over triangles into moments with bounds, in the file's unit.

    For a solid, V = Σd/6, ∫x = Σd s/24, ∫x xᵀ = Σd(…)/120 (twice that on the diagonal); for a shell, with |n| for d,
    A = Σ|n|/2, ∫x = Σ|n|s/6, ∫x xᵀ = Σ|n|(…)/24. The bounds are the a-priori ones of `moments_with_bounds`, or those of
    a second evaluation where they are smaller.

    Parameters
    ----------
    running : (10,) such bounds, of `inertia.mass.triangles.running_error` or `distances`, where they are at hand
    """
    values = tuple(map(Fraction, sums.sums[:10].tolist()))
    return moments_with_bounds(values, sums, FLOAT64, surface=surface, running=running)


def moments_with_bounds(
    value: Sequence[Fraction],
    sums: Sums,
    roundings: Roundings,
    *,
    surface: bool = False,
    running: Float | None = None,
) -> Moments:
    """Turn ten sums in the frame of `sums` into moments; the magnitudes in their bounds are those of `sums`.

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

    What underflow can add, at most 100 smallest normal numbers a triangle (in a shell 2⁻⁵⁰⁰, as a square root is
    taken of the squares of n) times the four lengths that may multiply them, is added.
    """
    shrink = Fraction(2) ** -sums.exponent
    origin = vector(Fraction(float(k)) for k in sums.origin)
    reach = _reach(sums)
    tiny = sums.count * (2.0**-500 if surface else 100 * 2.0**-1022) * max(1.0, *reach) ** 4
    bounds = _bounds(value, sums, roundings, reach)
    if running is not None:
        bounds = [min(pair) for pair in zip(bounds, running.tolist(), strict=True)]  # of a NaN, the first
    zeroth, *others = (Fraction((k + tiny) * _INFLATED) for k in bounds)
    unit = shrink ** (2 if surface else 3)
    zeroth_factor = unit / (2 if surface else 6)
    first_factor = unit * shrink / (6 if surface else 24)
    second_factor = unit * shrink**2 / (24 if surface else 120)
    twice = 2 * second_factor
    return Moments(
        origin,
        zeroth_factor * value[0],
        vector(first_factor * k for k in value[1:4]),
        six((*(twice * k for k in value[4:7]), *(second_factor * k for k in value[7:10]))),
        zeroth_factor * zeroth,
        vector(first_factor * k for k in others[:3]),
        six(second_factor * k for k in others[3:]),
    )


def distances(sums: Sums, accurate: Sequence[Fraction], roundings: Roundings) -> Float:
    """Return bounds (10,) on the errors of Σd, Σd s and Σd(…) of a solid, twice that on the diagonal.

    They are the distances from sums of more digits, and the a-priori bounds on the errors of these.
    """
    bounds = _bounds(accurate, sums, roundings, _reach(sums))
    apart = (abs(Fraction(k) - exact) for k, exact in zip(sums.sums[:10].tolist(), accurate, strict=True))
    times = (1, 1, 1, 1, 2, 2, 2, 1, 1, 1)
    return np.array([t * float(k) + bound for t, k, bound in zip(times, apart, bounds, strict=True)])


def _reach(sums: Sums) -> list[float]:
    """Return the largest distances from the origin along the axes, in the scaled frame."""
    farthest = np.maximum(np.abs(sums.high - sums.origin), np.abs(sums.low - sums.origin))
    reach: list[float] = (np.ldexp(farthest, sums.exponent) * _INFLATED).tolist()
    return reach


_INFLATED = 1.0 + 1e-9
"""More than the arithmetic of the bounds, the products of two γ and the roundings of P and D can take from them."""


def _bounds(value: Sequence[Fraction], sums: Sums, roundings: Roundings, reach: list[float]) -> list[float]:
    """Return a-priori bounds on the errors of Σd, Σd s and Σd(…), twice that on the diagonal."""
    unit = float(roundings.unit) * _INFLATED
    additions = roundings.across(sums.count) * unit
    across = additions + unit  # and the product before them
    normal, corner, bracket = (k * unit for k in (roundings.normal, roundings.corner, roundings.bracket))
    magnitude, total = float(sums.sums[10]) * _INFLATED, float(sums.sums[12]) * _INFLATED
    slack = 1e-12 * (magnitude + total)  # far more than the errors of the sums that take part here
    negative = max(total - float(value[0]) + slack, 0.0)
    weighted = [
        min(6 * x * x * total, max(float(value[4 + i]), 0.0) + 6 * x * x * negative) for i, x in enumerate(reach)
    ]
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
