"""Types that signatures share: arrays by their entries, progress, how windings are read; rotations of scipy; runs."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any, Literal, TypeGuard, TypeVar

import numpy as np
from numpy.typing import NDArray

from inertia.estimate import float_of

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Bool = NDArray[np.bool_]
_T = TypeVar("_T", bound=np.generic)


def of_rotation(value: Any, size: int) -> Any:
    """Return what a `Rotation` of scipy stands for, and anything else as it is.

    Parameters
    ----------
    size : of the last axis that is asked for: 4 for quaternions, scalar last, 3 for matrices
    """
    if hasattr(value, "as_quat") and size in (3, 4):
        return value.as_quat() if size == 4 else value.as_matrix()
    return value


def is_masked(value: object) -> TypeGuard[np.ma.MaskedArray[Any, Any]]:
    """Say whether something is an array with a mask, without importing what makes such arrays."""
    return "numpy.ma" in sys.modules and isinstance(value, np.ma.MaskedArray)


def reals(value: Any) -> Float:
    """Return numbers as float64: what is masked as not a number, what is beyond float64 as infinite.

    Raises `TypeError` or `ValueError` for what are no real numbers, complex ones too.

    >>> reals(np.ma.array([1, 2], mask=[False, True])).tolist(), reals([10**400]).tolist()
    ([1.0, nan], [inf])
    """
    masked = is_masked(value)
    array = value if masked else np.asarray(value)
    if array.dtype.kind == "c":
        raise TypeError("complex numbers are no real ones")
    try:
        numbers = array.astype(np.float64, copy=False)
    except OverflowError:
        numbers = np.array([float_of(each) for each in array.flat]).reshape(array.shape)
    return np.ma.filled(numbers, np.nan) if masked else numbers


Progress = Callable[[float], None]
"""Called with the fraction of the work that is done, from 0 to 1."""

Orientation = Literal["stored", "absolute"]
"""Whether the sign of a shell's volume follows from the winding of its triangles, or from how shells are nested."""

Parts = Literal["together", "separate"]
"""Whether the bodies of a part are one solid, in which nothing may count twice, or each is integrated by itself."""


_NEXT, _AFTER = np.array([1, 2, 0]), np.array([2, 0, 1])


def cross(a: Float, b: Float) -> Float:
    """Return a × b, (…, 3), to the last bit as `numpy.cross`, which takes eight times as long for single vectors.

    >>> cross(np.array([1.0, 2.0, 3.0]), np.eye(3)[1:]).tolist()
    [[-3.0, 0.0, 1.0], [2.0, -1.0, 0.0]]
    """
    product: Float = a.take(_NEXT, -1) * b.take(_AFTER, -1) - a.take(_AFTER, -1) * b.take(_NEXT, -1)
    return product


def cut_by(values: NDArray[_T], sizes: Int) -> list[NDArray[_T]]:
    """Cut rows into pieces of sizes (k,) that follow one another: `numpy.split` takes six times as long for many.

    >>> cut_by(np.arange(4), np.array([1, 0, 3]))
    [array([0]), array([], dtype=int64), array([1, 2, 3])]
    """
    return [values[first:last] for first, last in pairwise([0, *np.cumsum(sizes).tolist()])]


def runs_of(sizes: Int, most: int) -> Iterator[slice]:
    """Yield one run of items (k,) after the other, whose sizes add up to `most` at most, or single ones.

    >>> [(run.start, run.stop) for run in runs_of(np.array([3, 1, 9, 2, 2]), 4)]
    [(0, 2), (2, 3), (3, 5)]
    """
    ends, first = np.cumsum(sizes), 0
    while first < len(ends):
        last = max(first + 1, int(np.searchsorted(ends, ends[first] - sizes[first] + most, side="right")))
        yield slice(first, last)
        first = last


def distinct_pairs(pairs: Int) -> Int:
    """Return the pairs (k, 2) of numbers from 0 on, ascending, each once, in a tenth of the time that rows take numpy.

    >>> distinct_pairs(np.array([[2, 0], [1, 3], [2, 0]])).tolist()
    [[1, 3], [2, 0]]
    """
    if len(pairs) == 0:
        return pairs
    size = int(pairs[:, 1].max()) + 1
    return np.stack(np.divmod(np.unique(pairs[:, 0] * size + pairs[:, 1]), size), axis=1)
