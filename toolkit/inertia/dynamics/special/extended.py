"""Double-double arithmetic for phases: some 31 digits, so that frequency times time can be reduced to one turn.

A number is the unevaluated sum of two float64, high and low, as a pair; the functions take pairs of floats and pairs
of arrays alike. Operations are off by a few 2⁻¹⁰⁶ of their result, sums of that of their terms (M. Joldeş,
J.-M. Muller, V. Popescu, *Tight and rigorous error bounds for basic building blocks of double-word arithmetic*, ACM
TOMS 44, 2017). Products are split after Dekker, which is exact for magnitudes from 1e-290 to 1e290.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from inertia.mesh.part import Float

Number = Any
"""A float or an array of them."""

Pair = tuple[Number, Number]
"""High and low part of a double-double."""

PI: Pair = (3.141592653589793, 1.2246467991473532e-16)
ZERO: Pair = (0.0, 0.0)

_SPLIT = 134217729.0  # 2²⁷ + 1


def of(x: Number) -> Pair:
    """Return x as a pair."""
    return x, 0.0 * x


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
    s, e = two_sum(x[0], y[0])
    t, f = two_sum(x[1], y[1])
    s, e = _quick(s, e + t)
    return _quick(s, e + f)


def minus(x: Pair) -> Pair:
    """Return −x."""
    return -x[0], -x[1]


def multiply(x: Pair, y: Pair) -> Pair:
    """Return x y."""
    product, e = two_product(x[0], y[0])
    return _quick(product, e + (x[0] * y[1] + x[1] * y[0]))


def times(x: Pair, y: Number) -> Pair:
    """Return x y for a plain number y."""
    product, e = two_product(x[0], y)
    return _quick(product, e + x[1] * y)


def divide(x: Pair, y: Pair) -> Pair:
    """Return x / y for y ≠ 0."""
    q = x[0] / y[0]
    remainder = add(x, minus(times(y, q)))
    return _quick(q, remainder[0] / y[0])


def square_root(x: Pair) -> Pair:
    """Return √x for x > 0."""
    root = math.sqrt(x[0]) if isinstance(x[0], float) else np.sqrt(x[0])
    remainder = add(x, minus(two_product(root, root)))
    return _quick(root, remainder[0] / (2.0 * root))


def select(condition: Any, x: Pair, y: Pair) -> Pair:
    """Return x where the condition holds, else y."""
    if isinstance(condition, bool):
        return x if condition else y
    return np.where(condition, x[0], y[0]), np.where(condition, x[1], y[1])


def reduce(x: Pair, period: Pair) -> tuple[Float, Pair]:
    """Return the whole number of periods nearest to x / period, and what is left of x, within half a period."""
    count = np.rint(x[0] / period[0])
    return count, add(x, minus(times(period, count)))


def _quick(high: Number, low: Number) -> Pair:
    s = high + low
    return s, low - (s - high)
