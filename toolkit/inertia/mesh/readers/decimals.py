"""Decimals of a text file against the float64 nearest to them: how far apart they may be, and exactly are.

A decimal with k digits after its point is a whole number over 10ᵏ. Where the float64 x nearest to it times 2ᵏ is whole,
x is one over 10ᵏ too, so that the two are equal unless they are 10⁻ᵏ apart or more; and they are at most half a unit of
the last place apart.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from decimal import Decimal
from fractions import Fraction
from functools import cache

import numpy as np

from inertia.arrays import Float
from inertia.errors import ReadError
from inertia.mesh.part import Rounding
from inertia.mesh.readers.contents import shown
from inertia.mesh.surface import usable

_MOST_DIGITS = 22  # after the point, of decimals that are looked at; those of a float64 near 1 that is exact have fewer
_LONGEST = 1000  # characters in a number that is read exactly
_EXPONENT = re.compile(rb"[eE]([-+]?\d{1,9})(?!\d)")
_BARE_EXPONENT = re.compile(rb"\.\d*[-+]\d")  # as Nastran writes it
_POINT = ord(".")


def rounding_of(
    points: Float,
    text: Callable[[], bytes],
    words: Callable[[], Iterable[bytes | str]] | None = None,
    precision: type[np.float64] | type[np.float32] = np.float64,
) -> Rounding | None:
    """Return what turning decimals into float64 did to points; None where it did nothing.

    Parameters
    ----------
    points : (n, 3), the float64 nearest to each decimal
    text : returns the decimals (and perhaps other numbers)
    words : returns the decimals, point by point, when they are to be read exactly; None where that cannot be
    precision : of the numbers that the decimals became, if these were widened to float64 afterwards
    """
    if not len(points) or not usable(points).all():
        return None
    half = 0.5 * np.spacing(np.abs(points).max(axis=0).astype(precision)).astype(np.float64)
    if not _rounded(points, text, float(half.max())):
        return None
    distance = float(np.linalg.norm(half)) * (1 + 1e-6 if precision is np.float32 else 1 + 1e-15)
    if words is None:
        return Rounding(distance)
    return Rounding(distance, cache(lambda: remainders(points, map(written, words()), distance)))


def _rounded(points: Float, text: Callable[[], bytes], half: float) -> bool:
    for some in (points[:1000], points):  # most meshes tell at once
        scaled = np.ldexp(some, _MOST_DIGITS)
        if (np.floor(scaled) != scaled).any():
            return True
    digits = _digits_after_point(text())
    if digits > _MOST_DIGITS or half * 10.0**digits > 0.9:
        return True
    scaled = np.ldexp(points, digits)
    return bool((np.floor(scaled) != scaled).any())


def _digits_after_point(text: bytes) -> int:
    """Return the most digits that a number in `text` has after its point, once its exponent has moved that."""
    letters = np.frombuffer(text, np.uint8)
    others = np.append(np.flatnonzero((letters < ord("0")) | (letters > ord("9"))), len(letters))
    runs = np.diff(others)[letters[others[:-1]] == _POINT]
    digits = int(runs.max()) - 1 if len(runs) else 0
    if _BARE_EXPONENT.search(text):
        return _MOST_DIGITS + 1
    if b"e" in text or b"E" in text:
        digits += max(0, -min((int(exponent) for exponent in set(_EXPONENT.findall(text))), default=0))
    return digits


def written(word: bytes | str) -> Fraction:
    """Return the number that a word of the file writes; one nearer to zero than any float64 counts as zero."""
    if len(word) > _LONGEST:
        raise ReadError(f"it has a number of {len(word)} digits, {shown(word, 12)}, which is not read exactly")
    decimal = Decimal(word if isinstance(word, str) else word.decode("ascii"))
    return Fraction(decimal) if decimal and decimal.adjusted() > -_LONGEST else Fraction(0)


def remainders(points: Float, exact: Iterable[Fraction], distance: float) -> Float:
    """Return exact − points, (n, 3), each difference rounded once.

    Raises `ReadError` where one is larger than `distance`: the file is no longer the one that was read.
    """

    def difference(point: float, value: Fraction) -> float:
        n, d = point.as_integer_ratio()
        return (value.numerator * d - n * value.denominator) / (value.denominator * d)

    try:
        flat = [difference(point, value) for point, value in zip(points.ravel().tolist(), exact, strict=True)]
    except ValueError:
        flat = [np.inf]
    result = np.array(flat)
    if (np.abs(result) > distance).any():
        raise ReadError("it has changed since it was read: read it again", code="changed")
    return result.reshape(-1, 3)
