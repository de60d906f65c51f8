"""Edges of a triangle surface paired by compiled kernels: group by group of triangles, each inside the cache.

Triangles that follow one another in a file mostly are neighbours, so that a group is what stands together there; of its
edges few are left for the other groups. Where more wait for their partners than the cache holds, the triangles are put
into groups by where they are in space: by the leaf of a tree of planes that part a sample of them into equal shares
(see `leaves`). What is found does not depend on the groups, nor on how many threads pair them.
"""

from __future__ import annotations

import threading

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Progress
from inertia.mesh.geometry.corner_keys import BLOCK, corner_keys, in_threads, load, shares_of
from inertia.mesh.geometry.leaves import BY_PLACE, paired_by_place
from inertia.mesh.geometry.waiting_edges import EDGES, REPEATED, Log, WaitingEdges, empty_table
from inertia.mesh.surface import Triangles
from inertia.native import Kernel, address, threads
from inertia.records import dataclass

_MODULE = "inertia.mesh.geometry.edge_kernel"
ROWS = Kernel(_MODULE, "pair_rows", "pip" + "pippi" + "piipp")
CLOSE = Kernel(_MODULE, "close_group", "pippi" + "ppp")

_GROUP = 1 << 17  # triangles that are paired together where they stand together
_REPORTED = 16 * BLOCK
_TABLE = 1 << 15  # room for the edges that wait, of which half is used: it stays inside the cache
_LEAF = 8192  # triangles that are paired together where they are near each other, about
_SAMPLED = 16  # triangles a leaf that the planes are from
_BIN = 16384  # paired edges whose keys are compared at a time
_SHARED = 1 << 18  # triangles from which on threads repay their start


class _Scattered(Exception):
    """Triangles that follow one another are no neighbours."""


@dataclass(frozen=True, eq=False)
class Doubtful:
    """A surface of which some edges may have more than two triangles.

    Attributes
    ----------
    labels : (n,) int32, the component of each triangle, as of `Closure`, where any two triangles at an edge that run
        opposite ways hang together: as they do in those without edges in doubt
    edges : (k,), keys of the edges in doubt, and of those without a partner, the lowest bit 1
    """

    labels: NDArray[np.int32]
    edges: NDArray[np.uint64]


class _Groups:
    """The groups that one thread has paired, and what it has for that.

    Attributes
    ----------
    waiting : edges that wait for other groups, and the pieces of all
    logs : the keys of the edges that are paired within groups
    labels : the labels that each group's triangles get, and the number of its first piece
    repeated : triangles with a repeated corner
    """

    def __init__(self, salt: NDArray[np.uint64], bins: int) -> None:
        self._salt, self._bins = salt, bins
        self._state, self._table = np.zeros(5 + 3 * 64, np.int64), empty_table(_TABLE)
        self._own, self._parent = np.empty(_GROUP, np.int32), np.empty(_GROUP, np.int32)
        self.waiting = WaitingEdges(bins)
        self.logs: list[Log] = []
        self.labels: list[tuple[NDArray[np.int32], int]] = []
        self.repeated = 0

    def begin(self, labels: NDArray[np.int32], left: int) -> None:
        """Begin a group, to whose triangles labels are given; so many triangles are left after it."""
        self._state[:3] = self._state[4] = 0
        self.labels.append((labels, self.waiting.pieces))
        if len(self.labels) < 3:  # the first group, which may be given up, has little memory
            self._log = Log(3 * (len(labels) if len(self.labels) == 1 else len(labels) + left) // 2, self._bins)
            self.logs.append(self._log)

    def pair(self, rows: NDArray[np.uint64], count: int) -> bool:
        """Pair the first rows, which go on with the group; say whether the table is too small for them."""
        return ROWS.function(
            address(rows), count, address(self._salt), address(self._table), len(self._table),
            address(self._parent), address(self._own), len(self._own), *self._log.arguments, address(self._state),
        ) == 1  # fmt: skip

    def end(self) -> None:
        """End the group: pair its edges that still wait with those of others."""
        labels, first = self.labels[-1]
        edges, pieces = np.empty(self._state[0], np.uint64), np.empty(self._state[0], np.int32)
        number = CLOSE.function(
            address(self._table), len(self._table), address(self._parent), address(self._own), len(labels),
            edges.ctypes.data, pieces.ctypes.data, address(self._state),
        )  # fmt: skip
        if number > 1 or self._state[2]:  # memory that stays 0 is not taken
            labels[:] = self._own[: len(labels)]
        self.repeated += int(self._state[2])
        self.waiting.add_pieces(number)
        if len(edges):
            self.waiting.add(edges, pieces + np.int32(first))
        self.waiting.overfull |= bool(self._state[3])


def paired_edges(
    triangles: Triangles, salt: NDArray[np.uint64], progress: Progress | None = None
) -> tuple[int, int, NDArray[np.int32], int] | Doubtful | None:
    """Return open edges, components, labels and repeated triangles; where few edges may have more than two, these.

    None where more may.
    """
    count, progress = triangles.count, _rising(progress)
    parts = threads() if count >= _SHARED else 1
    try:
        return _paired_in_order(triangles, parts, salt.copy(), progress)  # may be written to, as `address` asks
    except _Scattered:
        if not all(kernel.worthwhile(count) for kernel in BY_PLACE):
            return None
        return paired_by_place(triangles, _LEAF, _SAMPLED, parts, salt, progress)


def _rising(progress: Progress | None) -> Progress | None:
    """Return a report of progress that leaves out what is done again."""
    if progress is None:
        return None
    report, reached = progress, 0.0

    def rise(fraction: float) -> None:
        nonlocal reached
        if fraction > reached:
            reached = fraction
            report(fraction)

    return rise


def _paired_in_order(
    triangles: Triangles, parts: int, salt: NDArray[np.uint64], progress: Progress | None
) -> tuple[int, int, NDArray[np.int32], int] | Doubtful | None:
    """Return what `paired_edges` does, by groups of triangles that follow one another; raises `_Scattered`."""
    load(ROWS, CLOSE, EDGES, REPEATED)
    count = triangles.count
    cuts, keys, labels = shares_of(count, parts), corner_keys(triangles, salt), np.zeros(count, np.int32)
    bins = 1 << min(max(3 * count // 2 // _BIN, 1).bit_length() - 1, 12)

    def pair(which: int, stopped: threading.Event) -> _Groups:
        start, stop = cuts[which : which + 2]
        groups, rows = _Groups(salt, bins), np.empty((BLOCK, 3), np.uint64)
        for first in range(start, stop, _GROUP):
            last = min(first + _GROUP, stop)
            groups.begin(labels[first:last], stop - last)
            for at in range(first, last, BLOCK):
                size = min(BLOCK, last - at)
                keys(at, at + size, rows)
                if stopped.is_set() or groups.pair(rows, size):
                    raise _Scattered
                if progress is not None and which == 0 and at % _REPORTED == 0:
                    progress((at + size) / stop)
            groups.end()
        return groups

    done = in_threads(parts, pair)
    waiting, repeated = WaitingEdges(bins), sum(groups.repeated for groups in done)
    firsts = [waiting.join(groups.waiting) for groups in done]
    waiting.logs += [log for groups in done for log in groups.logs]
    doubtful = waiting.doubtful(parts)
    if doubtful is None:
        return None
    number = waiting.components()
    components = int(number.max(initial=-1)) + 1
    if components > 1:
        for groups, base in zip(done, firsts, strict=True):
            for group, first in groups.labels:
                own = number[group + np.int32(base + first)]
                group[:] = np.where(group < 0, -1, own) if groups.repeated else own
    elif repeated or waiting.pieces > sum(len(groups.labels) for groups in done):
        np.minimum(labels, 0, out=labels)
    if len(doubtful):
        return Doubtful(labels, doubtful)
    return waiting.open_edges, components, labels, repeated
