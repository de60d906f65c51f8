"""Checks of array arguments: float64, of the right length, finite; and moments that a body can have."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inertia.arrays import Float, of_rotation, reals
from inertia.errors import GeometryError, UsageError


def rounded_up(value: float) -> str:
    """Return a positive number with two digits, that is not below it.

    >>> rounded_up(3.41e-15), rounded_up(0.1), rounded_up(9.99)
    ('3.5e-15', '0.1', '10')
    """
    text = f"{value:.2g}"
    if not float(text) < value:
        return text
    return f"{float(text) + 10.0 ** (math.floor(math.log10(value)) - 1):.2g}"


def vectors(value: ArrayLike, name: str, size: int = 3) -> Float:
    """Return `value` as finite float64 of shape (…, size), or raise `UsageError` naming it and the sample.

    >>> vectors([1, 2, 3], "omega").tolist()
    [1.0, 2.0, 3.0]
    """
    try:
        array = reals(of_rotation(value, size))
    except (TypeError, ValueError):
        raise UsageError(f"{name} must be numbers of shape (…, {size})") from None
    if array.ndim == 0 or array.shape[-1] != size:
        raise UsageError(f"{name} has shape {array.shape}: its last axis must hold {size} components")
    if not np.isfinite(array).all():
        place = first_index(~np.isfinite(array))[:-1]
        raise UsageError(f"{name}{at_index(place)} holds a value that is not finite: {array[place].tolist()}")
    return array


def moments_of(value: ArrayLike) -> Float:
    """Return principal moments (…, 3) kg m², or raise `GeometryError` naming the first that is not positive."""
    moments = vectors(value, "moments")
    if not (moments > 0).all():
        place = first_index(~(moments > 0))[:-1]
        raise GeometryError(f"moments{at_index(place)} are {moments[place].tolist()} kg m²: all three must be positive")
    return moments


def first_index(faulty: NDArray[np.bool_] | np.bool_) -> tuple[Any, ...]:
    """Return the index of the first true element."""
    return tuple(np.argwhere(faulty)[0].tolist())


def at_index(place: tuple[int, ...]) -> str:
    """Write an index as in ``[12]``, or as nothing where there is but one element."""
    return f"[{', '.join(str(k) for k in place)}]" if place else ""
