"""Frames of parts in fixed-point numbers: rotations from quaternions, matrices and Euler angles, mirrors, patterns.

A quaternion of rational numbers turns by a rational matrix, exactly: R = (2 (w² − v²) …)/|q|². Angles become the
half-angle quaternion with 57 digits; multiples of 90° are exact. Lengths are counted in 2⁻²⁵⁶ m and elements of
rotations in 2⁻¹⁹², so that ten thousand parts are placed in integers, and what rounding takes is counted by whoever
adds them up (`inertia.assembly.rollup`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from inertia.documents import FieldError
from inertia.mass.moments import Vector, dot, norm_above, vector
from inertia.mesh.turns import TURN_BITS, Quaternion, Rational, about

LENGTH_BITS = 256

_CERTAIN = 1e-14  # of the skewness of a rotation that a few products or a decomposition in float64 made
_COARSEST = 3.03e-3  # skewness beyond which no rotation is meant: that of three digits


class Frame(NamedTuple):
    """Where a part's axes lie: x = R x' + t.

    Attributes
    ----------
    rotation : the nine elements of R by rows, in 2⁻¹⁹²; of determinant −1 where it mirrors
    origin : t in 2⁻²⁵⁶ m
    skew : a bound on ‖RᵀR − 1‖ (Frobenius) of what was given
    reach : m, at least the lengths of all translations that led here
    """

    rotation: tuple[int, ...]
    origin: tuple[int, int, int]
    skew: float = 0.0
    reach: float = 0.0

    def then(self, inner: Frame) -> Frame:
        """Return where a frame lies that is placed in this one."""
        a, b, t = self.rotation, inner.rotation, inner.origin
        return Frame(
            tuple(
                (a[i] * b[j] + a[i + 1] * b[j + 3] + a[i + 2] * b[j + 6]) >> TURN_BITS
                for i in (0, 3, 6)
                for j in range(3)
            ),
            self.place(t),
            self.skew + inner.skew + self.skew * inner.skew,
            self.reach + inner.reach,
        )

    def place(self, point: Sequence[int]) -> tuple[int, int, int]:
        """Return a point of this frame, in 2⁻²⁵⁶ m, where it lies outside."""
        r, (x, y, z), t = self.rotation, point, self.origin
        return (
            t[0] + ((r[0] * x + r[1] * y + r[2] * z) >> TURN_BITS),
            t[1] + ((r[3] * x + r[4] * y + r[5] * z) >> TURN_BITS),
            t[2] + ((r[6] * x + r[7] * y + r[8] * z) >> TURN_BITS),
        )


def float_above(value: Fraction) -> float:
    """Return a float64 that is no less; 0 of nothing."""
    return math.nextafter(float(value), math.inf) if value else 0.0


def frame(rotation: tuple[int, ...], origin: Sequence[Rational], skew: float = 0.0, unit: Rational = 1) -> Frame:
    """Return the frame of a rotation in 2⁻¹⁹² and a translation in a unit of so many metres."""
    scale, divisor = unit.as_integer_ratio()
    ratios = [(n * scale, d * divisor) for n, d in (k.as_integer_ratio() for k in origin)]
    x, y, z = (_nearest(n << LENGTH_BITS, d) for n, d in ratios)
    return Frame(rotation, (x, y, z), skew, math.hypot(*(n / d for n, d in ratios)) * (1 + 1e-15))


def _nearest(numerator: int, divisor: int) -> int:
    """Return the whole number nearest to a quotient, of two the even one."""
    whole, rest = divmod(numerator, divisor)
    return whole + (2 * rest > divisor or (2 * rest == divisor and whole & 1))


UNTURNED = tuple(int(k % 4 == 0) << TURN_BITS for k in range(9))
IDENTITY = frame(UNTURNED, (0, 0, 0))


def turned(quaternion: Quaternion) -> tuple[int, ...]:
    """Return the rotation of a quaternion of any length, by rows, in 2⁻¹⁹².

    >>> [k >> TURN_BITS for k in turned((1, 0, 0, 1))]
    [0, -1, 0, 1, 0, 0, 0, 0, 1]
    """
    (w, x, y, z), _ = _integers(quaternion)
    ww, xx, yy, zz = w * w, x * x, y * y, z * z
    xy, yz, zx, wx, wy, wz = 2 * x * y, 2 * y * z, 2 * z * x, 2 * w * x, 2 * w * y, 2 * w * z
    size = ww + xx + yy + zz
    elements = (
        ww + xx - yy - zz,
        xy - wz,
        zx + wy,
        xy + wz,
        ww - xx + yy - zz,
        yz - wx,
        zx - wy,
        yz + wx,
        ww - xx - yy + zz,
    )
    return tuple((k << TURN_BITS) // size for k in elements)


def by_rows(matrix: Sequence[Sequence[float]]) -> tuple[int, ...]:
    """Return a matrix in 2⁻¹⁹²."""
    elements, scale = _integers([k for row in matrix for k in row])
    return tuple((k << TURN_BITS) // scale for k in elements)


def _integers(values: Sequence[Rational | float]) -> tuple[list[int], int]:
    """Return numbers as integers over one denominator."""
    ratios = [k.as_integer_ratio() for k in values]
    scale = math.lcm(*(d for _, d in ratios))
    return [n * (scale // d) for n, d in ratios], scale


def euler(degrees: Sequence[Rational], sequence: str) -> Quaternion:
    """Return the quaternion of Euler angles.

    Parameters
    ----------
    degrees : one for each axis of the sequence
    sequence : as "ZXZ": upper case turns about the axes as they have been turned, lower case about those at rest

    >>> turned(euler([90, 0, 90], "ZXZ")) == turned(euler([180, 0, 0], "ZXZ"))
    True
    """
    result: Quaternion = (1, 0, 0, 0)
    for angle, axis in zip(degrees, sequence, strict=True):
        one = about("xyz".index(axis.lower()), angle)
        result = _times(result, one) if axis.isupper() else _times(one, result)
    return result


def mirror(normal: Sequence[Rational]) -> tuple[Vector, ...]:
    """Return the reflection in the plane through the origin with a normal of any length: 1 − 2 n nᵀ/n²."""
    n = vector(Fraction(k) for k in normal)
    return tuple(vector(int(i == j) - 2 * n[i] * n[j] / dot(n, n) for j in range(3)) for i in range(3))


def skew_of(matrix: Sequence[Sequence[float]]) -> float:
    """Return ‖RᵀR − 1‖ (Frobenius), rounded up."""
    elements, scale = _integers([k for row in matrix for k in row])
    columns = [elements[k::3] for k in range(3)]
    gram = [sum(p * q for p, q in zip(a, b, strict=True)) for a in columns for b in columns]
    return float_above(norm_above(Fraction(k - (n % 4 == 0) * scale**2, scale**2) for n, k in enumerate(gram)))


def require_rotation(rows: Sequence[Sequence[float]], path: str) -> None:
    """Refuse a matrix that is left-handed, or farther from orthonormal than the digits it is written with explain."""
    skew, allowed = skew_of(rows), _allowed([k for row in rows for k in row])
    if skew > allowed:
        digits = "more digits, or " if skew <= _COARSEST else ""
        raise FieldError(
            path,
            f"is no rotation: it is off orthonormal by {skew:.2g}, and its digits explain {allowed:.2g}: give {digits}"
            "the rotation alone without its scale",
        )
    (a, b, c), (d, e, f), (g, h, i) = rows
    if a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0:
        raise FieldError(path, "is left-handed: mirror the part by `mirror`, and turn it by this")


def require_unit(quaternion: Sequence[float], path: str) -> None:
    """Refuse a quaternion whose length is not 1 to what its digits explain; one of whole numbers may have any."""
    if not any(quaternion):
        raise FieldError(path, "is zero: a rotation is a quaternion of length 1, [x, y, z, w]")
    if all(float(k).is_integer() for k in quaternion):
        return
    off, allowed = abs(math.fsum([-1.0, *(k * k for k in quaternion)])), _allowed(quaternion)
    if off > allowed:
        remedy = "give more digits" if off <= _COARSEST else "divide it by its length"
        raise FieldError(
            path,
            f"has a squared length that is off 1 by {off:.2g}, and its digits explain {allowed:.2g}: {remedy}",
        )


def is_rotation(rows: Sequence[Sequence[float]]) -> bool:
    """Whether `require_rotation` takes it."""
    return _passes(require_rotation, rows)


def is_unit(quaternion: Sequence[float]) -> bool:
    """Whether `require_unit` takes it."""
    return _passes(require_unit, quaternion)


def _passes(require: Callable[[Any, str], None], value: object) -> bool:
    try:
        require(value, "")
    except FieldError:
        return False
    return True


def _allowed(values: Sequence[float]) -> float:
    """Return how far from orthonormal the rounding of the last decimal may have made what was written.

    With ‖E‖ ≤ √n 10⁻ᵈ/2 for n numbers of d digits, ‖(R + E)ᵀ(R + E) − 1‖ ≤ 2 ‖E‖ + ‖E‖².
    """
    if all(float(k).is_integer() for k in values):
        return _CERTAIN
    places = max(-_exponent(repr(float(k))) for k in values if k)
    return min(max(1.01 * math.sqrt(len(values)) * 10.0**-places, _CERTAIN), _COARSEST)


def _exponent(word: str) -> int:
    mantissa, _, power = word.partition("e")
    return int(power or 0) - len(mantissa.partition(".")[2].rstrip("0"))


def _times(a: Quaternion, b: Quaternion) -> Quaternion:
    w, x, y, z = a
    p, q, r, s = b
    return (
        w * p - x * q - y * r - z * s,
        w * q + x * p + y * s - z * r,
        w * r - x * s + y * p + z * q,
        w * s + x * r - y * q + z * p,
    )
