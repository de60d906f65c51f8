"""Edges of groups of triangles that wait for a triangle of another group, paired as they come; see `pairing`."""

from __future__ import annotations

import threading

import numpy as np
from numpy.typing import NDArray

from inertia.mesh.geometry.corner_keys import in_threads
from inertia.native import Kernel, address

_MODULE = "inertia.mesh.geometry.edge_kernel"
EDGES = Kernel(_MODULE, "pair_edges", "ppipi" + "pi" + "piipp")
REPEATED = Kernel(_MODULE, "repeated_edges", "piiiipipi")

_TABLE = 1 << 14  # room for edges, to begin with
_LISTED = 1 << 12  # edges of more than two triangles
_ONE = np.uint64(1)
_NEVER = -(1 << 62)  # from which edges are counted that wait, so that the kernel does not take them for open ones


class Log:
    """The keys of edges that were paired, in bins."""

    def __init__(self, edges: int, bins: int) -> None:
        self.room = edges // bins + 8 * int(np.sqrt(edges // bins)) + 64
        self.keys, self.sizes = np.empty(bins * self.room, np.uint64), np.zeros(bins, np.int64)
        self.arguments = address(self.keys), bins, self.room, address(self.sizes)


class WaitingEdges:
    """The edges that wait, and the pieces of surface that the paired ones join.

    Few wait at a time: those at the border of the groups that have been.

    Attributes
    ----------
    logs : the keys of the paired ones
    pieces : how many have been appended
    overfull : whether an edge may have been left out
    """

    def __init__(self, bins: int) -> None:
        self._bins, self._state = bins, np.array([_NEVER, 0, 0, 0, 0])
        self._table, self._parent = empty_table(_TABLE), np.empty(_TABLE, np.int32)
        self.logs = [Log(_TABLE, bins)]
        self.pieces = 0
        self.overfull = False

    @property
    def parent(self) -> NDArray[np.int32]:
        """The table of joined pieces, (pieces,)."""
        return self._parent[: self.pieces]

    @property
    def size(self) -> int:
        """Bytes of memory."""
        return self._table.nbytes + self._parent.nbytes + sum(log.keys.nbytes for log in self.logs)

    @property
    def open_edges(self) -> int:
        """How many edges wait."""
        return int(self._state[0]) - _NEVER

    def add_pieces(self, number: int) -> int:
        """Append pieces that nothing joins yet; return the number of the first."""
        first = self._room_for(number)
        self._parent[first : self.pieces] = np.arange(first, self.pieces, dtype=np.int32)
        return first

    def _room_for(self, number: int) -> int:
        """Append so many pieces without numbers; return the number of the first."""
        first, before = self.pieces, self.parent
        self.pieces += number
        if self.pieces > len(self._parent):
            self._parent = np.empty(2 * self.pieces, np.int32)
            self._parent[:first] = before
        return first

    def add(self, edges: NDArray[np.uint64], pieces: NDArray[np.int32]) -> None:
        """Pair edges, of pieces that have been appended, with those that wait; the rest wait."""
        waiting = self.open_edges + len(edges)
        if 5 * waiting > 4 * len(self._table):
            before = self.left()
            self._table, self._state[0] = empty_table(5 * waiting // 2), _NEVER
            self._pair(*before)
        most = len(edges) // self._bins
        if self.logs[-1].sizes.max() + most + 8 * int(np.sqrt(most)) + 64 > self.logs[-1].room:
            self.logs.append(Log(max(sum(int(log.sizes.sum()) for log in self.logs), len(edges)), self._bins))
        self._pair(edges, pieces)

    def left(self) -> tuple[NDArray[np.uint64], NDArray[np.int32]]:
        """Return the edges that wait, and of which pieces."""
        used = self._table[self._table[:, 0] != 0]
        return used[:, 0] & ~_ONE | used[:, 1] & _ONE, (used[:, 1] >> _ONE).astype(np.int32)

    def join(self, other: WaitingEdges) -> int:
        """Append all that another has; return the number of its first piece."""
        first = self._room_for(other.pieces)
        np.add(other.parent, np.int32(first), out=self._parent[first : self.pieces])
        edges, pieces = other.left()
        self.add(edges, pieces + np.int32(first))
        self.logs += other.logs
        self.overfull |= other.overfull
        return first

    def doubtful(self, parts: int) -> NDArray[np.uint64] | None:
        """Return keys of edges (k,) where some may have more than two triangles: of these, and of all that wait.

        None where they are many. All edges have been added; so many threads look.
        """
        waiting = self.left()[0] | _ONE
        if len(waiting):
            self.logs.append(Log(len(waiting), self._bins))
            self._state[0] = len(waiting)  # those that wait are logged as well
            self._pair(np.empty(1, np.uint64), np.empty(1, np.int32), 0)
            self._state[0] += _NEVER
        repeated = None if self.overfull else _repeated(self.logs, self._bins, parts)
        return repeated if repeated is None or len(repeated) == 0 else np.union1d(repeated, waiting)

    def components(self) -> NDArray[np.int32]:
        """Return the component of each piece, (pieces,); all pieces have been appended and all edges added."""
        parent = self.parent
        while not np.array_equal(above := parent[parent], parent):
            parent = above
        firsts = parent == np.arange(len(parent), dtype=np.int32)
        number: NDArray[np.int32] = np.cumsum(firsts, dtype=np.int32)[parent] - np.int32(1)
        return number

    def _pair(self, edges: NDArray[np.uint64], pieces: NDArray[np.int32], count: int | None = None) -> None:
        if len(edges) == 0:
            return
        EDGES.function(
            address(edges), address(pieces), len(edges) if count is None else count,
            address(self._table), len(self._table), address(self._parent), len(self._parent),
            *self.logs[-1].arguments, address(self._state),
        )  # fmt: skip
        self.overfull |= bool(self._state[3])


def empty_table(slots: int) -> NDArray[np.uint64]:
    """Return a table with that many slots or more, a power of two, which is written to.

    Of what is only read, all pages are one page of zeros, and its copy at the first write stops the other processors.
    """
    table = np.empty((1 << (slots - 1).bit_length(), 2), np.uint64)
    table.fill(0)
    return table


def _repeated(logs: list[Log], bins: int, parts: int) -> NDArray[np.uint64] | None:
    """Return the keys that are in the logs more than once, some of them several times; None where they are many."""
    table = np.array([(address(log.keys), log.room, address(log.sizes)) for log in logs])
    places = 1 << (4 * int(np.sum([log.sizes for log in logs], axis=0).max())).bit_length()
    cuts = np.linspace(0, bins, parts + 1).astype(np.int64).tolist()

    def repeated(which: int, _: threading.Event) -> NDArray[np.uint64] | None:
        slots, found = np.empty(places, np.uint16), np.empty(_LISTED, np.uint64)
        of_bins = address(table), len(logs), bins, *cuts[which : which + 2]
        size = REPEATED.function(*of_bins, address(slots), places, address(found), _LISTED)
        return found[:size] if size <= _LISTED else None

    found = in_threads(parts, repeated)
    return None if any(each is None for each in found) else np.concatenate(found)
