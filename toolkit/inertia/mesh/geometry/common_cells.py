"""Which triangles are in cells of space that triangles of another group are in: all others are sure to be apart."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int
from inertia.mesh.geometry.enclosed import FEW, chunks, in_runs
from inertia.mesh.surface import Triangles
from inertia.native import Kernel, address

_MODULE = "inertia.mesh.geometry.common_cells_kernel"
_ENTER = Kernel(_MODULE, "enter_cells", "pippi" + "pip" + "dddd" + "pii" + "pi" + "pppi" + "ppppp")
_COMMON = Kernel(_MODULE, "mark_common", "pi" + "ppi" + "ppi" + "p")
_COHERENT = 4.0  # how much larger such boxes may be than those of single triangles
_SIDES = 1.5  # of a cell, over the mean of the longest sides of the boxes
_SAMPLE = 1 << 7
_BLOCKS = 3  # of cells that runs in several of them are in, at most, over the number of all runs
_FINEST = 2.0**-20  # of the whole, that a cell has at least
_FEWEST = 8  # cells along the whole, of which none are worth looking at
_IN_RANGE = 1000  # powers of two
_LEAST_BITS = 8

MOSTLY = 0.75
"""Of triangles: to copy as many of them takes longer than to look at the rest."""

MOST_BITS = 22
"""Of the table of blocks, at most: 160 MB."""


class Groups(NamedTuple):
    """The groups of triangles, looked up in a table, which is quicker than to list the group of each.

    Attributes
    ----------
    labels : (n,), of each triangle, −1 or more
    roles : (n,), of each triangle
    table : (r, m + 1), the group of those of each role and label, from that of −1 on
    """

    labels: NDArray[np.int32]
    roles: NDArray[np.uint8]
    table: Int

    @classmethod
    def of(cls, labels: NDArray[np.int32], groups: Int) -> Groups:
        """Return the groups (m,) of triangles that labels (n,) of 0 and more tell."""
        return cls(labels, np.zeros(len(labels), np.uint8), np.append(-1, groups)[None])

    def select(self, which: Int) -> Groups:
        """Return those of some triangles."""
        return Groups(self.labels[which], self.roles[which], self.table)

    def each(self) -> Int:
        """Return the group (n,) of each triangle."""
        return self.table[self.roles, self.labels + 1]


def in_common_cells(
    triangles: Triangles, groups: Groups, family: Int, few: NDArray[np.float32] | None = None
) -> Int | None:
    """Return the triangles that may have points in common with others of another group of their family, ascending.

    Parameters
    ----------
    triangles : n of them, with finite coordinates
    family : (m,) that of each group
    few : (⌈n / FEW⌉, 6), boxes around each `FEW` triangles, where they are known

    Returns
    -------
    which : (k,); None where cells do not tell
    """
    if not all(kernel.worthwhile(triangles.count) for kernel in (_ENTER, _COMMON)):
        return None
    near = _in_runs(triangles, groups, family, FEW, few)
    if near is None or len(near) > MOSTLY * triangles.count:
        return _in_runs(triangles, groups, family, 1)
    if len(near) == 0:
        return near
    nearer = _in_runs(triangles.select(near), groups.select(near), family, 1)
    return near if nearer is None else near[nearer]


def _in_runs(
    triangles: Triangles, groups: Groups, family: Int, run: int, few: NDArray[np.float32] | None = None
) -> Int | None:
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
        near = _in_cells(triangles, groups, family, run, few, (*origin.tolist(), 1.0 / side), bits)
        if not isinstance(near, int):
            return in_runs(near, run, count)
        if near == 1:
            bits += 2
        else:
            side *= 2.0
    return None


def _in_cells(
    triangles: Triangles,
    groups: Groups,
    family: Int,
    run: int,
    few: NDArray[np.float32] | None,
    grid: tuple[float, ...],
    bits: int,
) -> NDArray[np.uint8] | int:
    """Say which runs are in common cells of a grid; 1 where its table is too small, 2 where it is too fine."""
    count, size = -(-triangles.count // run), 1 << bits
    keys, owners, cells = np.zeros(size, np.uint64), np.zeros((size, 2), np.int32), np.zeros((size, 3), np.uint64)
    table = np.ascontiguousarray(groups.table)
    of_groups = address(table), table.shape[1], table.size, address(family), len(family)
    tables = *of_groups, address(keys), address(owners), address(cells), bits
    slots, own, near = np.empty(count, np.int32), np.empty(count, np.uint64), np.empty(count, np.uint8)
    more, parts = (np.empty(_BLOCKS * count, kind) for kind in (np.int32, np.uint64))
    room = np.array([3 * size // 4, 0, len(more)])
    known = few is not None
    boxed = slice(0, triangles.count), 0, 0, 0, address(groups.labels), triangles.count
    for which, *chunk in [boxed] if known else chunks(triangles, groups.labels):
        first = which.start // run
        of_runs = groups.roles[which].ctypes.data, run, address(few) if known else 0
        of_chunk = slots[first:].ctypes.data, own[first:].ctypes.data, address(more), address(parts), address(room)
        if failed := _ENTER.function(*chunk, *of_runs, *grid, *tables, *of_chunk):
            return failed
    of_more = address(more), address(parts), int(room[1])
    _COMMON.function(address(cells), bits, address(slots), address(own), count, *of_more, address(near))
    return near
