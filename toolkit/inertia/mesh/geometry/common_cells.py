"""Which triangles are in cells of space that triangles of another group are in: all others are sure to be apart."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int
from inertia.mesh.geometry.enclosed import chunks
from inertia.mesh.surface import Triangles
from inertia.native import Kernel, address

_MODULE = "inertia.mesh.geometry.common_cells_kernel"
_ENTER = Kernel(_MODULE, "enter_cells", "pippii" + "dddd" + "pi" + "pppi" + "ppppp")
_COMMON = Kernel(_MODULE, "mark_common", "pi" + "ppi" + "ppi" + "p")
_RUN = 4  # triangles one after another whose box is looked at first
_COHERENT = 4.0  # how much larger such boxes may be than those of single triangles
_SIDES = 1.5  # of a cell, over the mean of the longest sides of the boxes
_SAMPLE = 1 << 8
_BLOCKS = 3  # of cells that runs in several of them are in, at most, over the number of all runs
_FINEST = 2.0**-20  # of the whole, that a cell has at least
_FEWEST = 8  # cells along the whole, of which none are worth looking at
_IN_RANGE = 1000  # powers of two
_LEAST_BITS = 8

MOSTLY = 0.75
"""Of triangles: to copy as many of them takes longer than to look at the rest."""

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
    if not all(kernel.worthwhile(triangles.count) for kernel in (_ENTER, _COMMON)):
        return None
    near = _in_runs(triangles, groups, family, _RUN)
    if near is None or len(near) > MOSTLY * triangles.count:
        return _in_runs(triangles, groups, family, 1)
    if len(near) == 0:
        return near
    nearer = _in_runs(triangles.select(near), groups[near], family, 1)
    return near if nearer is None else near[nearer]


def _in_runs(triangles: Triangles, groups: Int, family: Int, run: int) -> Int | None:
    """Return the triangles, `run` of them one after another taken together, as `in_common_cells`."""
    count = triangles.count
    starts = np.arange(0, count, run * max(count // (run * _SAMPLE), 1))
    rows = np.minimum(starts[:, None] + np.arange(run), count - 1)
    some = triangles.select(rows.ravel()).corners()
    sizes = np.ptp(some, axis=1).max(axis=1)
    some = some.reshape(len(rows), -1, 3)
    origin, extent = some.min(axis=(0, 1)), float(np.ptp(some, axis=(0, 1)).max())
    if not math.isfinite(extent) or abs(math.frexp(extent)[1]) > _IN_RANGE:
        return None
    mean = float(np.ptp(some, axis=1).max(axis=1).mean())
    if mean > _COHERENT * float(sizes.mean()):
        return None
    side = max(_SIDES * mean, _FINEST * extent)
    bits = max((count // run).bit_length() - 4, _LEAST_BITS)
    while side * _FEWEST < extent and bits <= MOST_BITS:
        near = _in_cells(triangles, groups, family, run, (*origin.tolist(), 1.0 / side), bits)
        if not isinstance(near, int):
            return np.flatnonzero(np.repeat(near, run)[:count])
        if near == 1:
            bits += 2
        else:
            side *= 2.0
    return None


def _in_cells(
    triangles: Triangles, groups: Int, family: Int, run: int, grid: tuple[float, ...], bits: int
) -> NDArray[np.uint8] | int:
    """Say which runs are in common cells of a grid; 1 where its table is too small, 2 where it is too fine."""
    count, size = -(-triangles.count // run), 1 << bits
    keys, owners, cells = np.zeros(size, np.uint64), np.zeros((size, 2), np.int32), np.zeros((size, 3), np.uint64)
    tables = address(family), len(family), address(keys), address(owners), address(cells), bits
    slots, own, near = np.empty(count, np.int32), np.empty(count, np.uint64), np.empty(count, np.uint8)
    more, parts = (np.empty(_BLOCKS * count, kind) for kind in (np.int32, np.uint64))
    room = np.array([3 * size // 4, 0, len(more)])
    for which, *chunk in chunks(triangles, groups):
        first = which.start // run
        of_chunk = slots[first:].ctypes.data, own[first:].ctypes.data, address(more), address(parts), address(room)
        if failed := _ENTER.function(*chunk, run, *grid, *tables, *of_chunk):
            return failed
    of_more = address(more), address(parts), int(room[1])
    _COMMON.function(address(cells), bits, address(slots), address(own), count, *of_more, address(near))
    return near
