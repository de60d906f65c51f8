"""Edges of leaves that wait for a triangle of another leaf, paired as they come; see `leaves`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from inertia.mesh.geometry.pairing import EDGES, Log
from inertia.native import address

_TABLE = 1 << 14  # room for edges, to begin with
_ONE = np.uint64(1)
_NEVER = -(1 << 62)  # from which edges are counted that wait, so that the kernel does not take them for open ones


class WaitingEdges:
    """The edges that wait, and the pieces of surface that the paired ones join.

    Few wait at a time: those at the border of the leaves that have been.

    Attributes
    ----------
    logs : the keys of the paired ones
    pieces : how many have been appended
    """

    def __init__(self, bins: int) -> None:
        self._bins, self._state = bins, np.array([_NEVER, 0, 0, 0, 0])
        self._table, self._parent = np.zeros((_TABLE, 2), np.uint64), np.empty(_TABLE, np.int32)
        self.logs = [Log(_TABLE, bins)]
        self.pieces = 0

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

    @property
    def overfull(self) -> bool:
        """Whether an edge may have been left out."""
        return bool(self._state[3])

    def add_pieces(self, number: int) -> None:
        """Append pieces that nothing joins yet."""
        if self.pieces + number > len(self._parent):
            self._parent = np.resize(self._parent, 2 * (self.pieces + number))
        self._parent[self.pieces : self.pieces + number] = np.arange(self.pieces, self.pieces + number)
        self.pieces += number

    def add(self, edges: NDArray[np.uint64], pieces: NDArray[np.int32]) -> None:
        """Pair edges, of pieces that have been appended, with those that wait; the rest wait."""
        if 5 * (self.open_edges + len(edges)) > 4 * len(self._table):
            before, after = self.left(), 1 << (5 * (self.open_edges + len(edges)) // 4).bit_length()
            self._table, self._state[0] = np.zeros((after, 2), np.uint64), _NEVER
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
        first = self.pieces
        self.add_pieces(other.pieces)
        self._parent[first : self.pieces] = other.parent + first
        edges, pieces = other.left()
        self.add(edges, pieces + np.int32(first))
        self.logs += other.logs
        self._state[3] |= other._state[3]
        return first

    def _pair(self, edges: NDArray[np.uint64], pieces: NDArray[np.int32]) -> None:
        if len(edges) == 0:
            return
        EDGES.function(
            address(edges), address(pieces), len(edges), address(self._table), len(self._table),
            address(self._parent), len(self._parent), *self.logs[-1].arguments, address(self._state),
        )  # fmt: skip
