"""`Long`: an array of double-doubles that adds, multiplies and divides as an array of float64 does."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float
from inertia.dynamics.models.rational import rounded
from inertia.dynamics.special import double_double as pairs

Number = Any
"""A float, an array of them, or a `Long`."""

_HALVINGS = 5  # of an angle before its series: it is then below 1/40
_TERMS = 10


class Long:
    """Double-doubles, high and low part each an array or a float; some 31 digits.

    >>> third = Long(1.0) / 3.0
    >>> (3.0 * third - 1.0).high, (third * third - 1.0 / Long(9.0)).high < 1e-31
    (0.0, True)
    """

    __slots__ = ("high", "low")
    __array_ufunc__ = None

    def __init__(self, high: Any, low: Any = None) -> None:
        self.high, self.low = high, 0.0 * high if low is None else low

    @classmethod
    def of(cls, value: Fraction) -> Long:
        """Return a rational, rounded."""
        (high,), (low,) = rounded([value])
        return cls(float(high), float(low))

    def __add__(self, other: Number) -> Long:
        return Long(*pairs.add((self.high, self.low), _pair(other)))

    def __mul__(self, other: Number) -> Long:
        if isinstance(other, Long):
            return Long(*pairs.multiply((self.high, self.low), (other.high, other.low)))
        return Long(*pairs.times((self.high, self.low), other))

    def __truediv__(self, other: Number) -> Long:
        return Long(*pairs.divide((self.high, self.low), _pair(other)))

    def __rtruediv__(self, other: Number) -> Long:
        return Long(*pairs.divide(_pair(other), (self.high, self.low)))

    __radd__ = __add__
    __rmul__ = __mul__

    def __neg__(self) -> Long:
        return Long(-self.high, -self.low)

    def __sub__(self, other: Number) -> Long:
        return self.__add__(-other)

    def __rsub__(self, other: Number) -> Long:
        return (-self).__add__(other)

    def __getitem__(self, key: Any) -> Long:
        return Long(self.high[key], self.low[key])

    def __setitem__(self, key: Any, value: Long) -> None:
        self.high[key], self.low[key] = value.high, value.low

    def over(self, shape: tuple[int, ...]) -> Long:
        """Return a copy of this shape."""
        return Long(*(np.array(np.broadcast_to(part, shape)) for part in (self.high, self.low)))


def _pair(value: Number) -> pairs.Pair:
    return (value.high, value.low) if isinstance(value, Long) else (value, 0.0)


def root(value: Number) -> Number:
    """Return the square root of what is positive."""
    if isinstance(value, Long):
        return Long(*pairs.square_root((value.high, value.low)))
    return math.sqrt(value) if isinstance(value, float) else np.sqrt(value)


def where(condition: Any, value: Number, other: float) -> Number:
    """Return the value where the condition holds, elsewhere the other."""
    if isinstance(value, Long):
        return Long(np.where(condition, value.high, other), np.where(condition, value.low, 0.0))
    return np.where(condition, value, other)


def plain(value: Number) -> Any:
    """Return the nearest float64 numbers."""
    return value.high if isinstance(value, Long) else value


def turn_of(angle: Number) -> tuple[Number, Number]:
    """Return sine and cosine of an angle in rad, of some turns."""
    if not isinstance(angle, Long):
        return (math.sin(angle), math.cos(angle)) if isinstance(angle, float) else (np.sin(angle), np.cos(angle))
    quarters, rest = pairs.reduce((angle.high, angle.low), (0.5 * pairs.PI[0], 0.5 * pairs.PI[1]))
    x = Long(*rest) * 2.0**-_HALVINGS
    square, sine, versed = x * x, Long(0.0), Long(0.0)
    for k in range(_TERMS, 0, -1):
        sine = -(sine + 1.0) * square / float(2 * k * (2 * k + 1))
        versed = (1.0 - versed) * square / float((2 * k) * (2 * k - 1))
    sine = x * (sine + 1.0)
    for _ in range(_HALVINGS):  # sin 2x and 1 − cos 2x, which keeps its digits
        sine, versed = 2.0 * sine * (1.0 - versed), 2.0 * sine * sine
    cosine = 1.0 - versed
    turned = [(sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine)]
    which = np.asarray(pairs.modulo(quarters, 4.0)).astype(int)
    return tuple(  # type: ignore[return-value]
        Long(*(np.choose(which, [getattr(each[k], part) for each in turned]) for part in ("high", "low")))
        for k in (0, 1)
    )


def dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    """Return a·b of three components each."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Sequence[Number], b: Sequence[Number]) -> list[Number]:
    """Return a × b."""
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def times(matrix: Sequence[Sequence[Number]], vector: Sequence[Number]) -> list[Number]:
    """Return a matrix of three rows by a vector."""
    return [dot(row, vector) for row in matrix]


def product(p: Sequence[Number], q: Sequence[Number]) -> list[Number]:
    """Return the quaternion p q, scalar last."""
    vector = cross(p[:3], q[:3])
    return [p[3] * q[k] + q[3] * p[k] + vector[k] for k in range(3)] + [p[3] * q[3] - dot(p, q)]


def back(q: Sequence[Number]) -> list[Number]:
    """Return the conjugate of a quaternion."""
    return [-q[0], -q[1], -q[2], q[3]]


def rotated(q: Sequence[Number], vector: Sequence[Number]) -> list[Number]:
    """Return a vector turned by a quaternion of any length: v + 2 u × (s v + u × v)/|q|²."""
    inner = cross(q[:3], vector)
    inner = [q[3] * x + y for x, y in zip(vector, inner, strict=True)]
    scale = 2.0 / (dot(q, q) + q[3] * q[3])
    return [x + scale * y for x, y in zip(vector, cross(q[:3], inner), strict=True)]


def spun(q: Sequence[Number], spin: Sequence[Number]) -> list[Number]:
    """Return the rate ½ q ω of a quaternion."""
    return [0.5 * x for x in product(q, [*spin, 0.0])]


def stacked(values: Sequence[Long], shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return the high parts of some numbers, of one shape, as an array (…, k)."""
    return np.stack([np.broadcast_to(each.high, shape) for each in values], axis=-1)


def exactly(values: Sequence[Fraction]) -> list[Long]:
    """Return rationals, rounded."""
    return [Long.of(value) for value in values]


def from_floats(values: Float) -> list[Fraction]:
    """Return float64 numbers as the rationals that they are."""
    return [Fraction(float(value)) for value in values]


def solution(matrix: Sequence[Sequence[Number]], vector: Sequence[Number]) -> list[Number]:
    """Return M⁻¹ v of a symmetric matrix, by its cofactors."""
    rows = [cross(matrix[k - 2], matrix[k - 1]) for k in range(3)]
    determinant = dot(matrix[0], rows[0])
    return [dot(row, vector) / determinant for row in rows]


def shifted(mass: Number, arm: Sequence[Number]) -> list[list[Number]]:
    """Return the tensor m (r² 1 − r rᵀ) of a mass at r."""
    square = dot(arm, arm)
    return [[mass * ((square if i == j else 0.0) - arm[i] * arm[j]) for j in range(3)] for i in range(3)]
