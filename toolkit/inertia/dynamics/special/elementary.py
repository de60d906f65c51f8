"""Functions of one float or of an array of them, so that one formula serves a body alone and a million together.

Arithmetic on floats is some twenty times as fast as on arrays of one element, which is what a single body at a single
instant would be. Conditions are bools or arrays of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float

Number = Any
"""A float or an array of them."""


def _either(of_float: Callable[[float], Any], of_array: Callable[[Float], Any]) -> Callable[[Number], Any]:
    def function(x: Number) -> Any:
        return of_float(x) if isinstance(x, float) else of_array(x)

    return function


sqrt = _either(math.sqrt, np.sqrt)
sin = _either(math.sin, np.sin)
cos = _either(math.cos, np.cos)
exp = _either(math.exp, np.exp)
tanh = _either(math.tanh, np.tanh)
arctan = _either(math.atan, np.arctan)
frexp = _either(math.frexp, np.frexp)
rint = _either(lambda x: float(round(x)), np.rint)
"""Nearest whole number, the even one of two."""


def number(x: ArrayLike) -> Number:
    """Return a float, of whatever kind, as Python's own, anything else as an array."""
    return float(x) if isinstance(x, float) else np.asarray(x, dtype=np.float64)


def ldexp(x: Number, exponent: Any) -> Number:
    """Return x · 2**exponent, which is a number of the kind of x."""
    return math.ldexp(x, exponent) if isinstance(x, float) else np.ldexp(x, exponent)


def maximum(x: Number, y: Number) -> Number:
    """Return the larger one."""
    return max(x, y) if isinstance(x, float) and isinstance(y, float) else np.maximum(x, y)


def where(condition: Any, x: Any, y: Any) -> Any:
    """Return x where the condition holds, else y."""
    if isinstance(condition, bool):
        return x if condition else y
    return np.where(condition, x, y)


def select(condition: Any, x: tuple[Any, ...], y: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the tuple x where the condition holds, else y, element by element."""
    if isinstance(condition, bool):
        return x if condition else y
    return tuple([np.where(condition, s, t) for s, t in zip(x, y, strict=True)])


def anywhere(condition: Any) -> bool:
    """Say whether the condition holds at all."""
    return condition if isinstance(condition, bool) else bool(condition.any())


def columns(rows: Float) -> tuple[Number, ...]:
    """Return the columns (…) of an array (…, k): as floats where it holds one row.

    >>> columns(np.array([[1.0, 2.0, 3.0]]))
    (1.0, 2.0, 3.0)
    """
    if rows.size == rows.shape[-1]:
        return tuple(rows.reshape(-1).tolist())
    return tuple([rows[..., k] for k in range(rows.shape[-1])])


def packed(numbers: tuple[Any, ...], shape: tuple[int, ...], dtype: type = float) -> NDArray[Any]:
    """Return an array (*shape, k) with k numbers as its columns, each broadcast to shape.

    >>> packed((1.0, np.array([2.0, 3.0])), (2,)).tolist()
    [[1.0, 2.0], [1.0, 3.0]]
    """
    rows: NDArray[Any] = np.empty((*shape, len(numbers)), dtype=dtype)
    for k, column in enumerate(numbers):
        rows[..., k] = column
    return rows
