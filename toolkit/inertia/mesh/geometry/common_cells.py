"""Which triangles are in cells of space that triangles of another group are in: all others are sure to be apart."""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Int
from inertia.mesh.geometry.enclosed import chunks
from inertia.mesh.surface import Triangles
from inertia.native import Kernel, address

_MODULE = "inertia.mesh.geometry.common_cells_kernel"
_ENTER = Kernel(_MODULE, "enter_cells", "pippi" + "dddd" + "pi" + "pppi" + "pppp" + "i")
_COMMON = Kernel(_MODULE, "find_common", "pi")
_SIDES = 1.5  # of a cell, over the mean of the longest sides of the boxes of triangles
_SAMPLE = 1 << 10
_BLOCKS = 6  # of cells that a triangle is in, at most, in the mean
_FINEST = 2.0**-20  # of the whole, that a cell has at least
_FEWEST = 8  # cells along the whole, of which none are worth looking at
_IN_RANGE = 1000  # powers of two
_LEAST_BITS = 8

MOST_BITS = 22
"""Of the table of blocks, at most: 160 MB."""


def in_common_cells(triangles: Triangles, groups: Int, family: Int) -> Int | None:
    """Return the triangles that may have points in common with others of another group of their family, ascending.

    Parameters
    ----------
    triangles : n of them, with finite coordinates
    groups : (n,) the group of each triangle
    family : (m,) that of each group

    Returns
    -------
    which : (k,); None where cells do not tell
    """
    count = triangles.count
    if not all(kernel.worthwhile(count) for kernel in (_ENTER, _COMMON)):
        return None
    some = triangles.sample(_SAMPLE)
    low, high = some.min(axis=1), some.max(axis=1)
    origin, extent = low.min(axis=0), float((high.max(axis=0) - low.min(axis=0)).max())
    if not math.isfinite(extent) or abs(math.frexp(extent)[1]) > _IN_RANGE:
        return None
    side = max(_SIDES * float((high - low).max(axis=1).mean()), _FINEST * extent)
    bits = max(count.bit_length() - 4, _LEAST_BITS)
    while side * _FEWEST < extent and bits <= MOST_BITS:
        near = _in_cells(triangles, groups, family, (*origin.tolist(), 1.0 / side), bits)
        if not isinstance(near, int):
            return near
        if near == 1:
            bits += 2
        else:
            side *= 2.0
    return None


def _in_cells(triangles: Triangles, groups: Int, family: Int, grid: tuple[float, ...], bits: int) -> Int | int:
    """Return the triangles in common cells of a grid; 1 where its table is too small, 2 where it is too fine."""
    count, size = triangles.count, 1 << bits
    keys, owners, cells = np.zeros(size, np.uint64), np.zeros((size, 2), np.int32), np.zeros((size, 3), np.uint64)
    tables = address(family), len(family), address(keys), address(owners), address(cells), bits
    slots, own, near = (np.empty(count, kind) for kind in (np.int32, np.uint64, np.uint8))
    for again in (0, 1):
        state = np.array([3 * size // 4, _BLOCKS * count])
        for which, *chunk in chunks(triangles, groups):
            of_chunk = slots[which].ctypes.data, own[which].ctypes.data, near[which].ctypes.data, address(state)
            if failed := _ENTER.function(*chunk, *grid, *tables, *of_chunk, again):
                return failed
        if not again:
            _COMMON.function(address(cells), bits)
    return np.flatnonzero(near)
