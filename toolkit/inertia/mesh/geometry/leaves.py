"""Edges of triangles in any order, paired leaf by leaf of a tree of planes: in memory, or in a temporary file as well.

Each triangle, packed into 16 bytes, goes to the leaf that it is in. An edge with both ends in one leaf is used by
triangles of this leaf alone, and paired there; only the others wait for the triangles of other leaves. What the memory
does not hold goes, sorted by leaf, to segments of a temporary file, of which a leaf then reads its share.
"""

from __future__ import annotations

import threading
from dataclasses import replace
from functools import partial
from itertools import count, pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int, Progress
from inertia.mesh.geometry.corner_keys import BLOCK, in_threads, load, shares_of, vertex_keys
from inertia.mesh.geometry.place_tree import sample, tree
from inertia.mesh.geometry.waiting_edges import EDGES, REPEATED, WaitingEdges, empty_table
from inertia.mesh.surface import Facets, Triangles
from inertia.native import Kernel, address
from inertia.records import dataclass

LEAF = Kernel("inertia.mesh.geometry.edge_kernel", "pair_leaf", "ppip" + "pip" + "ppi" + "ppip")
_PARTITION = "inertia.mesh.geometry.partition_kernel"
_TREE = "ppppiip"
PLACE_FACETS = Kernel(_PARTITION, "place_facets", "pip" + _TREE + "pippp")
PLACE_FACES = Kernel(_PARTITION, "place_faces", "pipip" + _TREE + "pippp")
LABEL_FACETS = Kernel(_PARTITION, "label_facets", "pi" + _TREE + "ppppp")
LABEL_FACES = Kernel(_PARTITION, "label_faces", "pipi" + _TREE + "ppppp")

BY_PLACE = LEAF, PLACE_FACETS, PLACE_FACES, LABEL_FACETS, LABEL_FACES, EDGES, REPEATED

RUN = 64
"""Rows that lie together, as `partition_kernel` has them."""
ROW = 16
"""Bytes of a packed triangle."""

_BIN = 16384  # paired edges whose keys are compared at a time
_COPIED = 1 << 10  # runs that are copied at a time
_REPORTED = 16 * BLOCK
_STATE = 5 + 6 * 16
_ROOM = 9 * 32 // 2 + 4 + 32  # words for a block of triangles, as `partition_kernel` has them


class Store(Protocol):
    """What holds the rows that the memory does not; see `inertia.mesh.external.temporary_file`."""

    def reserve(self, size: int) -> int:
        """Return the byte from which on so many are free."""

    def write(self, array: NDArray[np.generic], at: int) -> None:
        """Write a contiguous array from byte `at` on."""

    def read(self, array: NDArray[np.generic], at: int) -> None:
        """Fill a contiguous array with what was written from byte `at` on."""


@dataclass(frozen=True, eq=False)
class Limits:
    """What bounds the memory.

    Attributes
    ----------
    rows : triangles that it holds
    runs : of a leaf, at most
    waiting : bytes that the edges that wait may take
    store : of the other triangles
    """

    rows: int
    runs: int
    waiting: int
    store: Store


class Unpaired(Exception):
    """A surface whose edges are not paired leaf by leaf."""


@dataclass(frozen=True, eq=False)
class _Segment:
    """The packed triangles `first:last` of the file, in runs that have room for `RUN` each.

    Those of leaf k are in `runs[of[k]:of[k + 1]]`, (first row in the pool, rows); or these runs lie in the store one
    after another, the first of all from byte `at` on.
    """

    first: int
    last: int
    runs: Int
    of: Int
    at: int | None = None

    @property
    def sizes(self) -> Int:
        """Triangles of each leaf."""
        return np.diff(np.append(0, np.cumsum(self.runs[:, 1]))[self.of])


class _Desk:
    """What one thread has for pairing a leaf: tables that lie in the cache."""

    def __init__(self, salt: NDArray[np.uint64]) -> None:
        self._salt, self._state, self._room = salt, np.zeros(_STATE, np.int64), 0
        self.repeated = self.open = 0
        self.overfull = False

    def pair(
        self, pool: NDArray[np.uint64], runs: Int, size: int, first: int
    ) -> tuple[int, NDArray[np.uint64], NDArray[np.int32]]:
        """Pair the rows of some runs, and put the numbers of their pieces in their places, of which the first is known.

        Returns how many pieces there are, and the edges that wait and of which pieces, until the next leaf.
        """
        if self._room < size:
            self._room = room = 5 * size // 4
            self._table, self._partners = empty_table(2 * room), np.empty(4 * room + 4, np.int32)
            self._queue, self._labels = np.empty(room + 1, np.int32), np.empty(5 * (room + 1), np.uint8)
            self._edges, self._pieces = np.empty(3 * room, np.uint64), np.empty(3 * room, np.int32)
        self._state[:3] = 0
        number = LEAF.function(
            address(pool), address(runs), len(runs), address(self._salt),
            address(self._table), 1 << (4 * size - 1).bit_length(), address(self._partners),
            address(self._queue), address(self._labels), size,
            address(self._edges), address(self._pieces), first, address(self._state),
        )  # fmt: skip
        waiting, alone, repeated, again = self._state[:4].tolist()
        self.open += alone
        self.repeated += repeated
        self.overfull |= bool(again)
        return number, self._edges[:waiting], self._pieces[:waiting]


class _Leaves:
    """Triangles grouped by place, and their edges paired."""

    def __init__(
        self,
        triangles: Triangles,
        leaf: int,
        sampled: int,
        parts: int,
        salt: NDArray[np.uint64],
        progress: Progress | None,
        limits: Limits | None,
    ) -> None:
        self._count, self._parts = triangles.count, parts
        depth = _depth_for(self._count, leaf)
        self._leaves = 1 << depth
        self._triangles, self._salt, self._progress, self._limits = triangles, salt.copy(), progress, limits
        if isinstance(triangles, Facets):
            self._kernels, self._keys = (PLACE_FACETS, LABEL_FACETS), self._salt
            self._vertices: tuple[int, ...] = ()
        else:
            self._kernels, self._keys = (PLACE_FACES, LABEL_FACES), vertex_keys(triangles, self._salt)
            self._vertices = triangles.vertices.ctypes.data, len(triangles.vertices)
        self._bins = 1 << min((self._count // 16 // _BIN).bit_length(), 9)
        self._tree = own = tree(sample(triangles, sampled * self._leaves), depth)
        # Addresses of its arrays, which are taken once: for each block they cost a hundredth of the time.
        self._planes = *map(address, (own.axes, own.planes, own.cells, own.shifts)), own.levels, own.depth
        self._cuts = shares_of(self._count, parts)
        most = max(stop - start for start, stop in pairwise(self._cuts))
        if limits is not None and limits.rows < self._count:
            most = _held_by_each(limits.rows, parts)
        self._largest = 0 if limits is None else limits.runs
        self._piece = np.full(self._leaves, -1, np.int32)  # that all of a leaf is, where it is all of one
        self._runs = _runs_for(most, self._leaves)
        self._pool = np.empty((parts * (self._runs + self._largest) * RUN, 2), np.uint64)
        self._owners = np.empty(parts * self._runs, np.int64)

    def paired(self) -> tuple[int, int, NDArray[np.int32], int]:
        """Return open edges, components, labels and repeated triangles; raises `Unpaired`."""
        scattered = in_threads(self._parts, self._scatter)
        segments = [segment for own, _ in scattered for segment in own]
        sizes = sum(segment.sizes for segment in segments)
        shares = np.searchsorted(np.cumsum(sizes), self._count * np.arange(self._parts + 1) // self._parts)
        shares[0], shares[-1] = 0, self._leaves
        done = in_threads(self._parts, partial(self._pair, segments=segments, sizes=sizes, shares=shares))
        waiting, desks = WaitingEdges(self._bins), [desk for _, desk in done]
        first = [waiting.join(other) for other, _ in done]
        repeated = sum(desk.repeated for desk in desks)
        if repeated != sum(of for _, of in scattered):  # corners of one triangle have the same 40 bits
            raise Unpaired
        doubtful = None if any(desk.overfull for desk in desks) else waiting.doubtful(self._parts)
        open_edges = waiting.open_edges + sum(desk.open for desk in desks)
        if doubtful is None or len(doubtful) or (open_edges and self._limits is not None):
            raise Unpaired
        number = waiting.components()
        components = int(number.max(initial=-1)) + 1
        if components == 1 and not repeated:
            labels = np.zeros(self._count, np.int32)
        else:
            labels = self._in_file_order(segments, number, np.repeat(np.array(first, np.int32), np.diff(shares)))
        return open_edges, components, labels, repeated

    def _scatter(self, which: int, stopped: threading.Event) -> tuple[list[_Segment], int]:
        """Put a share of the triangles into leaves; return the segments, and how many have a repeated corner."""
        begin = which * self._runs
        heads, state, room = np.zeros(self._leaves, np.int64), np.array([begin]), np.empty(_ROOM, np.int64)
        pool = address(self._pool), self._parts * self._runs, address(heads), address(self._owners), address(state)
        (start, stop), repeated, segments = self._cuts[which : which + 2], 0, []
        first = start
        for at in range(start, stop, BLOCK):
            size = min(BLOCK, stop - at)
            if state[0] - begin + size // RUN + min(size, self._leaves) > self._runs:
                segments.append(self._spilled(self._segment(first, at, begin, heads, state)))
                first, state[0], heads[:] = at, begin, 0
            repeated += self._descended(self._kernels[0], at, at + size, (address(self._keys),), room, *pool)
            if stopped.is_set():
                break
            if which == 0 and self._progress is not None and at % _REPORTED == 0:
                self._progress(0.5 * (at + size) / stop)
        return [*segments, self._segment(first, stop, begin, heads, state)], repeated

    def _descended(self, kernel: Kernel, start: int, stop: int, keys: tuple[int, ...], room: Int, *places: int) -> int:
        """Run a kernel that finds the leaves of triangles `start:stop`."""
        block = self._triangles.block(start, stop)
        return kernel.function(
            block.ctypes.data, stop - start, *self._vertices, *keys, *self._planes, address(room), *places
        )

    def _segment(self, first: int, last: int, begin: int, heads: Int, state: Int) -> _Segment:
        """Return the segment that lies in the runs of the pool from `begin` on."""
        end = int(state[0])
        sizes = np.full(end - begin, RUN)
        unfilled = heads[heads % RUN != 0]
        sizes[unfilled // RUN - begin] = unfilled % RUN
        owners = self._owners[begin:end]
        order = np.argsort(owners, kind="stable")
        of = np.searchsorted(owners[order], np.arange(self._leaves + 1))
        return _Segment(first, last, np.column_stack([(begin + order) * RUN, sizes[order]]), of)

    def _spilled(self, segment: _Segment) -> _Segment:
        """Write the runs of a segment to the store, one leaf after another."""
        assert self._limits is not None
        store, pool = self._limits.store, self._pool.reshape(-1, RUN, 2)
        places = segment.runs[:, 0] // RUN
        at, copy = store.reserve(len(places) * RUN * ROW), np.empty((_COPIED, RUN, 2), np.uint64)
        for start in range(0, len(places), _COPIED):
            some = places[start : start + _COPIED]
            np.take(pool, some, axis=0, out=copy[: len(some)], mode="clip")
            store.write(copy[: len(some)], at + start * RUN * ROW)
        return replace(segment, at=at)

    def _pair(
        self, which: int, stopped: threading.Event, segments: list[_Segment], sizes: Int, shares: Int
    ) -> tuple[WaitingEdges, _Desk]:
        """Pair the edges of a share of the leaves, and put the pieces of their triangles in place of the rows.

        Returns the edges that wait for other threads' leaves, and what the leaves had.
        """
        low, high = shares[which : which + 2].tolist()
        desk, waiting, limits = _Desk(self._salt), WaitingEdges(self._bins), self._limits
        ranges = np.stack([segment.of[low : high + 1] for segment in segments], axis=1).tolist()
        for leaf, size, begins, ends in zip(count(low), sizes[low:high].tolist(), ranges, ranges[1:], strict=False):
            if size == 0:
                continue
            runs, stored = [], []
            if limits is not None:
                if size > limits.runs * RUN:
                    raise Unpaired
                stored = self._fetched(segments, begins, ends, (self._parts * self._runs + which * self._largest) * RUN)
            for segment, begin, end in zip(segments, begins, ends, strict=True):
                if segment.at is None:
                    runs.append(segment.runs[begin:end])
            runs += [own for own, _ in stored]
            before = desk.repeated
            number, edges, pieces = desk.pair(self._pool, np.concatenate(runs), size, waiting.pieces)
            if number == 1 and desk.repeated == before:
                self._piece[leaf] = waiting.pieces
            waiting.add_pieces(number)
            waiting.add(edges, pieces)
            if desk.overfull or waiting.overfull or stopped.is_set():
                raise Unpaired
            if limits is not None:
                if desk.open or waiting.size > limits.waiting:
                    raise Unpaired
                for own, at in stored if self._piece[leaf] < 0 else ():
                    labels = self._pool.view(np.int32)[own[0, 0] : own[-1, 0] + RUN, 0]
                    limits.store.write(np.ascontiguousarray(labels), at)
            if which == 0 and self._progress is not None:
                self._progress(0.5 + 0.5 * (leaf + 1) / high)
        return waiting, desk

    def _fetched(
        self, segments: list[_Segment], begins: list[int], ends: list[int], free: int
    ) -> list[tuple[Int, int]]:
        """Read what the store has of a leaf into the pool from row `free` on; return its runs, and where they lie."""
        fetched = []
        last = free + self._largest * RUN
        for segment, begin, end in zip(segments, begins, ends, strict=True):
            if segment.at is None or begin == end or self._limits is None:
                continue
            rows = (end - begin) * RUN
            if free + rows > last:
                raise Unpaired
            at = segment.at + begin * RUN * ROW
            self._limits.store.read(self._pool[free : free + rows], at)
            fetched.append((np.column_stack([np.arange(free, free + rows, RUN), segment.runs[begin:end, 1]]), at))
            free += rows
        return fetched

    def _in_file_order(self, segments: list[_Segment], number: NDArray[np.int32], first: Int) -> NDArray[np.int32]:
        """Return the components of all triangles, numbered by their first; `first` are those of the leaves' pieces."""
        kept, self._pool = _first_words(self._pool), np.empty((0, 2), np.uint64)
        result, number = np.empty(self._count, np.int32), np.append(number, np.int32(-1))

        def label(which: int, stopped: threading.Event) -> None:
            room, begin = np.empty(_ROOM, np.int64), which * self._runs
            for segment in segments:
                if not self._cuts[which] <= segment.first < self._cuts[which + 1]:
                    continue
                own = kept[begin * RUN : (begin + self._runs) * RUN] if segment.at is None else self._stored(segment)
                heads, state = np.zeros(self._leaves, np.int64), np.zeros(1, np.int64)
                places = address(own), address(heads), address(state), address(first)
                for at in range(segment.first, segment.last, BLOCK):
                    size = min(BLOCK, segment.last - at)
                    some = result[at : at + size]
                    self._descended(self._kernels[1], at, at + size, (), room, *places, address(some))
                    some[:] = number[some]
                    if stopped.is_set():
                        return

        in_threads(self._parts, label)
        return _numbered_by_first(result, int(number.max()) + 1)

    def _stored(self, segment: _Segment) -> NDArray[np.int32]:
        """Return the pieces of a segment in the store, where its runs were in the pool."""
        assert self._limits is not None
        assert segment.at is not None
        places = segment.runs[:, 0] // RUN
        labels, lowest = np.empty((len(places), RUN), np.int32), places.min(initial=places.max(initial=0))
        for piece, (begin, end) in zip(self._piece.tolist(), pairwise(segment.of.tolist()), strict=True):
            if piece >= 0:
                labels[places[begin:end] - lowest] = piece
            elif begin < end:
                some = np.empty((end - begin, RUN), np.int32)
                self._limits.store.read(some, segment.at + begin * RUN * ROW)
                labels[places[begin:end] - lowest] = some
        return labels.reshape(-1)


def stored_at_most(count: int, leaf: int, rows: int, parts: int) -> int:
    """Return the bytes that the store takes where the memory holds so many rows; parameters as of `paired_by_place`."""
    if rows >= count:
        return 0
    most = _held_by_each(rows, parts)
    times = max(stop - start for start, stop in pairwise(shares_of(count, parts))) // max(most - BLOCK, 1)
    return parts * times * _runs_for(most, 1 << _depth_for(count, leaf)) * RUN * ROW


def _depth_for(count: int, leaf: int) -> int:
    return max((count // leaf).bit_length() - 1, 1)


def _held_by_each(rows: int, parts: int) -> int:
    return max(rows // parts, BLOCK)


def _runs_for(rows: int, leaves: int) -> int:
    """Return how many runs have room for so many rows in any leaves, and for a block more."""
    return -(-rows // RUN) + min(leaves, BLOCK) + leaves


def paired_by_place(
    triangles: Triangles,
    leaf: int,
    sampled: int,
    parts: int,
    salt: NDArray[np.uint64],
    progress: Progress | None = None,
    limits: Limits | None = None,
) -> tuple[int, int, NDArray[np.int32], int] | None:
    """Return open edges, components, labels and repeated triangles; None where an edge may have more than two.

    Within limits, None stands also for a surface with open edges, and for one that these do not admit.

    Parameters
    ----------
    leaf : triangles of a leaf, about
    sampled : triangles a leaf that the planes are from
    parts : threads
    """
    load(*BY_PLACE)
    leaves = _Leaves(triangles, leaf, sampled, parts, salt, progress, limits)
    try:
        return leaves.paired()
    except Unpaired:
        return None


def _first_words(rows: NDArray[np.uint64]) -> NDArray[np.int32]:
    """Return the first 32 bits of each row, (n,), in the memory of these, of which the rest is given back."""
    number, words = len(rows), rows.reshape(-1).view(np.int32)
    for start in range(0, number, _REPORTED):
        some = words[4 * start : 4 * (start + _REPORTED) : 4]
        words[start : start + len(some)] = some
    del words, some
    rows.resize((-(-number // 4), 2), refcheck=False)
    return rows.reshape(-1).view(np.int32)[:number]


def _numbered_by_first(labels: NDArray[np.int32], components: int) -> NDArray[np.int32]:
    """Number components by their first triangle in the file, in place."""
    first = np.full(components + 1, len(labels))
    for start in reversed(range(0, len(labels), _REPORTED)):
        own = labels[start : start + _REPORTED][::-1]
        first[own] = np.arange(start + len(own), start, -1) - 1  # of several values for one place, the last stays
    number = np.empty(components + 1, np.int32)
    number[np.argsort(first[:components])] = np.arange(components)
    number[components] = -1
    for start in range(0, len(labels), _REPORTED):
        labels[start : start + _REPORTED] = number[labels[start : start + _REPORTED]]
    return labels
