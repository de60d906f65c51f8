"""Tensors whose eigenvalues and eigenvectors are known exactly, and the eigenvalues of any to many digits."""

from collections.abc import Sequence
from fractions import Fraction

import mpmath
import numpy as np

Rows = list[list[Fraction]]


def frame(seed: int, largest: int = 40) -> Rows:
    """Return a rational rotation: that of an integer quaternion (its columns are Pythagorean)."""
    rng = np.random.default_rng(seed)
    w, x, y, z = (int(k) for k in rng.integers(-largest, largest + 1, 4))
    w = w or 1
    n = w * w + x * x + y * y + z * z
    return [
        [Fraction(k, n) for k in row]
        for row in (
            (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
        )
    ]


def turned(moments: Sequence[Fraction | float], axes: Rows) -> Rows:
    """Return the matrix with these eigenvalues along the columns of `axes`."""
    m = [Fraction(k) for k in moments]
    return [[sum(axes[i][k] * m[k] * axes[j][k] for k in range(3)) for j in range(3)] for i in range(3)]


def plus(rows: Sequence[Sequence[Fraction]], array: np.ndarray) -> Rows:
    """Return the sum of a rational and a float matrix."""
    return [[a + Fraction(b) for a, b in zip(u, v, strict=True)] for u, v in zip(rows, array.tolist(), strict=True)]


def eigenvalues(rows: Sequence[Sequence[Fraction]], digits: int = 80) -> list[Fraction]:
    """Return the eigenvalues, ascending, right to some `digits` digits of the largest."""
    with mpmath.workdps(digits):
        size, scaled = _scaled(rows)
        return sorted(size * Fraction(*_ratio(value)) for value in mpmath.eigsy(scaled, eigvals_only=True))


def eigenvectors(rows: Sequence[Sequence[Fraction]], digits: int = 50) -> list[list[Fraction]]:
    """Return the eigenvectors, in the order of ascending eigenvalues, to some `digits` digits."""
    with mpmath.workdps(digits):
        values, vectors = mpmath.eigsy(_scaled(rows)[1])
        order = sorted(range(len(values)), key=lambda k: values[k])
        return [[Fraction(*_ratio(vectors[i, k])) for i in range(len(values))] for k in order]


def _scaled(rows: Sequence[Sequence[Fraction]]) -> tuple[Fraction, mpmath.matrix]:
    size = max(abs(x) for row in rows for x in row) or Fraction(1)
    return size, mpmath.matrix([[mpmath.mpf((x / size).numerator) / (x / size).denominator for x in r] for r in rows])


def _ratio(value: mpmath.mpf) -> tuple[int, int]:
    sign, mantissa, exponent, _ = value._mpf_
    return (-1 if sign else 1) * int(mantissa) * 2 ** max(exponent, 0), 2 ** max(-exponent, 0)


def angle(axis: np.ndarray, true: Sequence[Fraction]) -> float:
    """Return the angle between two lines, from their exact cross product."""
    a = [Fraction(k) for k in axis.tolist()]
    cross = [a[1] * true[2] - a[2] * true[1], a[2] * true[0] - a[0] * true[2], a[0] * true[1] - a[1] * true[0]]
    with mpmath.workdps(50):
        squares = sum(k * k for k in cross) / (sum(k * k for k in a) * sum(k * k for k in true))
        return float(mpmath.asin(mpmath.sqrt(mpmath.mpf(squares.numerator) / squares.denominator)))
