"""Double-double arithmetic for phases: some 31 digits, so that frequency times time can be reduced to one turn.

A number is the unevaluated sum of two float64, high and low, as a pair; the functions take pairs of floats and pairs
of arrays alike. Operations are off by a few 2⁻¹⁰⁶ of their result, sums of that of their terms (M. Joldeş,
J.-M. Muller, V. Popescu, *Tight and rigorous error bounds for basic building blocks of double-word arithmetic*, ACM
TOMS 44, 2017). Products are split after Dekker, which is exact for magnitudes from 1e-290 to 1e290.
"""

from __future__ import annotations

import math
from fractions import Fraction

from inertia.dynamics.special.elementary import Number, anywhere, rint, select, sqrt, where

Pair = tuple[Number, Number]
"""High and low part of a double-double."""

PI: Pair = (3.141592653589793, 1.2246467991473532e-16)
ZERO: Pair = (0.0, 0.0)

_MANY = 1e9
_SPLIT = 134217729.0  # 2²⁷ + 1
_ORDER = 28  # of the series of sine and cosine: (π/4)²⁹/29! is 1e-34


def of(x: Number) -> Pair:
    """Return x as a pair."""
    return x, 0.0 * x


def of_fraction(x: Fraction) -> Pair:
    """Return x, rounded to a pair of floats."""
    high = float(x)
    return high, float(x - Fraction(high))


def two_sum(x: Number, y: Number) -> Pair:
    """Return x + y exactly."""
    s = x + y
    t = s - x
    return s, (x - (s - t)) + (y - t)


def two_product(x: Number, y: Number) -> Pair:
    """Return x y exactly."""
    product = x * y
    t = _SPLIT * x
    x_high = t - (t - x)
    x_low = x - x_high
    t = _SPLIT * y
    y_high = t - (t - y)
    y_low = y - y_high
    return product, ((x_high * y_high - product) + x_high * y_low + x_low * y_high) + x_low * y_low


def add(x: Pair, y: Pair) -> Pair:
    """Return x + y; x − y where nothing but rounding is left costs digits, as it must."""
    (high, low), (other, rest) = x, y
    s = high + other
    t = s - high
    e = ((high - (s - t)) + (other - t)) + (low + rest)
    total = s + e
    return total, e - (total - s)


def minus(x: Pair) -> Pair:
    """Return −x."""
    return -x[0], -x[1]


def multiply(x: Pair, y: Pair) -> Pair:
    """Return x y."""
    product, e = two_product(x[0], y[0])
    e = e + (x[0] * y[1] + x[1] * y[0])
    high = product + e
    return high, e - (high - product)


def times(x: Pair, y: Number) -> Pair:
    """Return x y for a plain number y."""
    product, e = two_product(x[0], y)
    e = e + x[1] * y
    high = product + e
    return high, e - (high - product)


def divide(x: Pair, y: Pair) -> Pair:
    """Return x / y for y ≠ 0."""
    q = x[0] / y[0]
    product, e = two_product(q, y[0])
    rest = ((x[0] - product) + (x[1] - (e + q * y[1]))) / y[0]  # the first difference is exact
    high = q + rest
    return high, rest - (high - q)


def square_root(x: Pair) -> Pair:
    """Return √x for x > 0."""
    root = sqrt(x[0])
    product, e = two_product(root, root)
    rest = ((x[0] - product) + (x[1] - e)) / (2.0 * root)  # the first difference is exact
    high = root + rest
    return high, rest - (high - root)


def reduce(x: Pair, period: Pair) -> tuple[Pair, Pair]:
    """Return the whole number of periods nearest to x / period, and what is left of x, within half a period.

    The number is a sum of two whole ones, as beyond 2⁵³ a float64 does not tell odd from even: see `modulo`, `several`.
    """
    count = rint(x[0] / period[0])
    rest = add(x, minus(times(period, count)))
    if not anywhere(abs(count) > _MANY):
        return of(count), rest
    again = rint(rest[0] / period[0])  # as such a quotient is rounded by more than a millionth
    return (count, again), add(rest, minus(times(period, again)))


def modulo(count: Pair, small: float) -> Number:
    """Return what division of a whole number by a small one leaves."""
    return (count[0] % small + count[1] % small) % small


def several(x: Pair, count: Pair) -> Pair:
    """Return x times a whole number."""
    return add(times(x, count[0]), times(x, count[1]))


_QUARTER: Pair = (0.5 * PI[0], 0.5 * PI[1])
_TERMS = tuple(of_fraction(Fraction((-1) ** (k // 2), math.factorial(k))) for k in range(_ORDER + 1))


def sine_and_cosine(x: Pair) -> tuple[Pair, Pair]:
    """Return sin x and cos x, to 2⁻¹⁰⁰ and what π lacks, 2⁻¹⁰⁷ of x.

    >>> sine, cosine = sine_and_cosine((0.5, 0.0))
    >>> add(multiply(sine, sine), multiply(cosine, cosine))[0]
    1.0
    """
    quarters, rest = reduce(x, _QUARTER)
    square = multiply(rest, rest)
    sine, cosine = multiply(rest, _series(square, _TERMS[1::2])), _series(square, _TERMS[::2])
    turned = modulo(quarters, 4.0)
    odd = (turned == 1.0) | (turned == 3.0)
    a, b, c, d = select(odd, (*cosine, *sine), (*sine, *cosine))
    below, left = where(turned >= 2.0, -1.0, 1.0), where((turned == 1.0) | (turned == 2.0), -1.0, 1.0)
    return (below * a, below * b), (left * c, left * d)


def _series(x: Pair, terms: tuple[Pair, ...]) -> Pair:
    total = terms[-1]
    for term in terms[-2::-1]:
        total = add(multiply(total, x), term)
    return total
