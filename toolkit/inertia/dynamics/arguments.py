"""Checks of array arguments: float64, of the right length, finite; moments that a body can have; and their scales."""

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


def moments_of(value: ArrayLike, *, rotor: bool = False) -> Float:
    """Return principal moments (…, 3) kg m², or raise `GeometryError` naming the first that are not positive.

    Where they only multiply, a `rotor` counts too: one of its moments is 0 (textbook § 13.10).
    """
    moments = vectors(value, "moments")
    usable = (moments > 0) | (rotor & (moments == 0) & ((moments > 0).sum(axis=-1, keepdims=True) == 2))
    if not usable.all():
        place = first_index(~usable)[:-1]
        rule = "none may be negative, and one of them 0 at most" if rotor else "all three must be positive, as divisors"
        raise GeometryError(f"moments{at_index(place)} are {moments[place].tolist()} kg m²: {rule}")
    return moments


def scaled(vector: Float) -> tuple[Float, NDArray[np.intc]]:
    """Return vectors (…, 3) over the power of two next above their largest component, and its exponent (…, 1).

    >>> [each.tolist() for each in scaled(np.array([3.0, 0.0, -1.0]))]
    [[0.75, 0.0, -0.25], [2]]
    """
    _, exponent = np.frexp(np.max(np.abs(vector), axis=-1, keepdims=True))
    return np.ldexp(vector, -exponent), exponent


def first_index(faulty: NDArray[np.bool_] | np.bool_) -> tuple[Any, ...]:
    """Return the index of the first true element."""
    return tuple(np.argwhere(faulty)[0].tolist())


def at_index(place: tuple[int, ...]) -> str:
    """Write an index as in ``[12]``, or as nothing where there is but one element."""
    return f"[{', '.join(str(k) for k in place)}]" if place else ""
