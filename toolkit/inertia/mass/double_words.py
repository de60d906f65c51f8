"""Double-double arithmetic on arrays: each number is the unevaluated sum of two float64, some 32 digits.

Each operation is off by at most 8u² = 2⁻¹⁰³ of the magnitudes that enter it, u = 2⁻⁵³: the sloppy addition by
5u² (|x| + |y|), the product by 8u² |x y| (M. Joldeş, J.-M. Muller, V. Popescu, *Tight and rigorous error bounds for
basic building blocks of double-word arithmetic*, ACM TOMS 44, 2017, algorithms 5 and 11; the figures here are looser
and hold for both variants that are used), the square root by 25/8 u² of itself (V. Lefèvre, N. Louvet, J.-M. Muller,
J. Picot, L. Rideau, *Accurate calculation of Euclidean norms using double-word arithmetic*, ACM TOMS 49, 2023).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.records import dataclass

UNIT = 2.0**-103
"""What an operation may be off by, relative to the magnitudes that enter it."""

_SPLIT = 134217729.0  # 2²⁷ + 1


@dataclass(frozen=True, eq=False)
class Pair:
    """Arrays of numbers, each `high` + `low` with |low| of at most half a unit in the last place of high."""

    high: Float
    low: Float

    @staticmethod
    def sum_of(a: Float, b: Float) -> Pair:
        """Return a + b, exactly (Knuth's two-sum)."""
        s = a + b
        t = s - a
        return Pair(s, (a - (s - t)) + (b - t))

    def __getitem__(self, index: Any) -> Pair:
        """Return the part of the arrays that an index selects."""
        return Pair(self.high[index], self.low[index])

    def __neg__(self) -> Pair:
        """Return −x, exactly."""
        return Pair(-self.high, -self.low)

    def __add__(self, other: Pair) -> Pair:
        """Return x + y."""
        h = Pair.sum_of(self.high, other.high)
        e = h.low + (self.low + other.low)
        s = h.high + e
        return Pair(s, e - (s - h.high))

    def __sub__(self, other: Pair) -> Pair:
        """Return x − y."""
        return self + -other

    def __mul__(self, other: Pair) -> Pair:
        """Return x y; the product of the low parts is left out."""
        h = self.high * other.high
        e = _rest(self.high, other.high, h) + (self.high * other.low + self.low * other.high)
        s = h + e
        return Pair(s, e - (s - h))

    def root(self) -> Pair:
        """Return √x of numbers that are not negative: the float64 root and one step of Newton's method."""
        h = np.sqrt(self.high)
        rest = self.low - _rest(h, h, self.high)
        e = np.divide(rest, 2 * h, out=np.zeros_like(h), where=h > 0)
        s = h + e
        return Pair(s, e - (s - h))


def folded(values: Pair) -> Pair:
    """Add up along the first axis, as a binary tree: ⌈log₂ n⌉ additions."""
    while len(values.high) > 1:
        half = len(values.high) // 2
        sums = values[:half] + values[half : 2 * half]
        if len(values.high) % 2:
            last = values[-1:]
            sums = Pair(np.concatenate([sums.high, last.high]), np.concatenate([sums.low, last.low]))
        values = sums
    return values[0]


def near_pair(values: Sequence[float]) -> tuple[float, float]:
    """Return the sum of floats in float64, and what that leaves of it, each rounded once."""
    high = math.fsum(values)
    return high, math.fsum((*values, -high))


def near_sum(values: list[float]) -> Fraction:
    """Add up floats to within a part in 2¹⁰⁵."""
    (n, d), (m, e) = map(float.as_integer_ratio, near_pair(values))
    last = max(d, e)  # powers of two
    return Fraction(n * (last // d) + m * (last // e), last)


def _rest(a: Float, b: Float, product: Float) -> Float:
    """Return a b − `product`, exactly where that is the product's rounding (Dekker)."""
    (p, q), (r, s) = _halves(a), _halves(b)
    rest: Float = ((p * r - product) + p * s + q * r) + q * s
    return rest


def _halves(a: Float) -> tuple[Float, Float]:
    """Split 53 bits into two halves of 26."""
    t = _SPLIT * a
    high = t - (t - a)
    return high, a - high
