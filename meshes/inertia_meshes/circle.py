"""π, and the cosines of parts of a turn, in rational arithmetic.

No coordinate of a sample comes from the machine's own cosine, so the files are the same bytes everywhere; and
the cosine of a quarter turn is exactly zero.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

PI = Fraction(31415926535897932384626433832795028841971693993751058209749445923, 10**64)
"""π to 65 digits."""

_BITS = 200
_KEPT = 150


@cache
def cosine(turns: Fraction) -> Fraction:
    """Return cos(2π·turns) to 45 digits, by its power series in fixed point.

    >>> cosine(Fraction(1, 3)), cosine(Fraction(1, 4))
    (Fraction(-1, 2), Fraction(0, 1))
    """
    angle = 2 * PI * (turns - round(turns))
    square = round(angle * angle * (1 << _BITS))
    total, term, k, sign = 0, 1 << _BITS, 0, 1
    while term:
        total += sign * term
        k += 2
        sign = -sign
        term = (term * square >> _BITS) // (k * (k - 1))
    return Fraction(round(Fraction(total, 1 << (_BITS - _KEPT))), 1 << _KEPT)


def sine(turns: Fraction) -> Fraction:
    """Return sin(2π·turns) to 45 digits."""
    return cosine(turns - Fraction(1, 4))
