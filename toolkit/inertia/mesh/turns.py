"""Turns by an angle as quaternions of rational numbers: exact for multiples of 90°, with 57 digits otherwise."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction

TURN_BITS = 192
"""Cosines and sines are counted in 2⁻¹⁹²."""

Rational = Fraction | int
Quaternion = tuple[Rational | float, Rational | float, Rational | float, Rational | float]
"""w, x, y, z; of any length but zero."""

_PI = Fraction(314159265358979323846264338327950288419716939937510582097494459, 10**62)


def about(axis: int | Sequence[Rational], degrees: Rational) -> Quaternion:
    """Return the quaternion of a turn about an axis, by its number or its direction of any length."""
    cosine, sine = _half(Fraction(degrees))
    if isinstance(axis, int):
        direction: Sequence[Rational] = tuple(int(k == axis) for k in range(3))
        length: Rational = 1
    else:
        direction, length = axis, root(sum((Fraction(k) ** 2 for k in axis), Fraction(0)))
    x, y, z = (sine * k for k in direction)
    return cosine * length, x, y, z


def _half(degrees: Fraction) -> tuple[Rational, Rational]:
    """Return what is in proportion to the cosine and the sine of half an angle: exact for multiples of 90°."""
    turn = degrees % 360
    if turn % 90 == 0:
        return ((1, 0), (1, 1), (0, 1), (-1, 1))[int(turn / 90)]
    cosine, sine = (sum(terms) for terms in zip(*_terms(turn * _PI / 360), strict=True))
    return Fraction(cosine, 1 << TURN_BITS), Fraction(sine, 1 << TURN_BITS)


def _terms(angle: Fraction) -> Iterator[tuple[int, int]]:
    """Yield the terms of the series of cosine and sine, in 2⁻¹⁹²."""
    scaled, term, k = round(angle * (1 << TURN_BITS)), 1 << TURN_BITS, 0
    while term:
        following = ((term * scaled) >> TURN_BITS) // (k + 1)
        sign = -1 if k % 4 else 1
        yield sign * term, sign * following
        term, k = ((following * scaled) >> TURN_BITS) // (k + 2), k + 2


def root(square: Fraction) -> Fraction:
    """Return the root of a rational to 57 digits, exactly where it is rational."""
    n, d = square.numerator, square.denominator
    if math.isqrt(n) ** 2 == n and math.isqrt(d) ** 2 == d:
        return Fraction(math.isqrt(n), math.isqrt(d))
    shift = max(0, TURN_BITS - (n.bit_length() - d.bit_length()) // 2)
    return Fraction(math.isqrt((n << (2 * shift)) // d), 1 << shift)
