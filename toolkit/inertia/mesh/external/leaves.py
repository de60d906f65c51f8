"""Closure and components of a closed surface in bounded memory, its triangles grouped by where they are in space.

Each triangle, packed into 16 bytes, goes to the leaf of a tree of planes (`inertia.mesh.geometry.pairing`), where its
edges are paired with those of its neighbours. What the memory does not hold of the leaves goes, sorted by leaf, to
segments of a temporary file, of which a leaf then reads its share. An edge that has not two users, one each way, ends
the work: whoever asks for such a surface pairs the edges themselves (`inertia.mesh.external.closure`).
"""

from __future__ import annotations

import threading
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Int, Progress
from inertia.mesh.external.temporary_file import TemporaryFile
from inertia.mesh.external.waiting_edges import WaitingEdges
from inertia.mesh.geometry.closure import Closure
from inertia.mesh.geometry.pairing import (
    BIN,
    BLOCK,
    BY_PLACE,
    DESCEND,
    PACK,
    RUN,
    SCATTER,
    Log,
    Thread,
    any_repeated,
    corner_keys,
    in_threads,
    load,
    roots,
    sample,
    tree,
)
from inertia.mesh.part import Facets, Triangles
from inertia.native import address, threads

LEAF = 1 << 16
"""Triangles of a leaf, about."""
FIXED = 32_000_000
"""Bytes for each thread's tables, and for a leaf that it reads."""
LEAST = 1 << 20
"""Triangles in memory, for which the work repays its start."""

_ROW = 16  # bytes of a packed triangle
_TAKEN = _ROW + 5  # by a triangle in memory, with its label
_WAITING = 2  # bytes a triangle that the edges between leaves may take
_SAMPLED = 64  # triangles a leaf that the planes are from
_COPIED = 1 << 10  # runs that are copied at a time
_REPORTED = 16 * BLOCK


class Beyond(Exception):
    """A surface whose edges are not paired leaf by leaf."""


@dataclass(frozen=True, eq=False)
class _Segment:
    """The packed triangles `first:last` of the file, by leaf: those of leaf k are in the runs `of[k]:of[k + 1]`.

    A run has `sizes` rows, and room for `RUN`. It is number `places` of the pool, or of those that lie in the
    temporary file from byte `at` on.
    """

    first: int
    last: int
    places: Int
    sizes: Int
    of: Int
    at: int | None = None

    def runs(self, leaf: int) -> tuple[Int, Int]:
        """Return places and sizes of the runs of a leaf."""
        own = slice(int(self.of[leaf]), int(self.of[leaf + 1]))
        return self.places[own], self.sizes[own]


class _Leaves:
    """Triangles grouped by place, and their edges paired."""

    def __init__(
        self,
        triangles: Triangles,
        rows: int,
        parts: int,
        salt: NDArray[np.uint64],
        file: TemporaryFile,
        progress: Progress,
    ) -> None:
        count, self._parts = triangles.count, parts
        depth = max((count // LEAF).bit_length() - 1, 1)
        self._count, self._leaves = count, 1 << depth
        self._file, self._salt, self._progress = file, salt.copy(), progress
        self._bins = 1 << min((count // 16 // BIN).bit_length(), 9)
        self._room = (1 << 24) + _WAITING * count // self._parts
        self._keys = corner_keys(triangles, self._salt)
        axes, planes, cells = self._tree = tree(sample(triangles, _SAMPLED * self._leaves), depth)
        self._descent = address(axes), address(planes), address(cells), depth
        self._cuts = [*(BLOCK * (part * count // (self._parts * BLOCK)) for part in range(self._parts)), count]
        most = int(np.diff(self._cuts).max()) if rows >= count else max(rows // self._parts, BLOCK)
        self._largest = 4 * LEAF // RUN  # runs of a leaf that is paired, at most
        self._runs = -(-most // RUN) + min(self._leaves, BLOCK) + self._leaves  # of a thread
        self._pool = np.empty((self._parts * (self._runs + self._largest), RUN, 2), np.uint64)
        self._owners = np.empty(self._parts * self._runs, np.int64)

    def closure(self) -> Closure:
        """Return the closure; raises `Beyond` where an edge has not two triangles, one each way."""
        scattered = in_threads(self._parts, self._scatter)
        segments = [segment for own, _ in scattered for segment in own]
        runs = sum(segment.of for segment in segments)
        shares = np.searchsorted(runs, runs[-1] * np.arange(self._parts + 1) // self._parts)
        shares[0], shares[-1] = 0, self._leaves
        done = in_threads(self._parts, partial(self._pair, segments=segments, shares=shares))
        waiting, repeated = WaitingEdges(self._bins), sum(of for _, of in done)
        first = [waiting.join(other) for other, _ in done]
        if waiting.open_edges or waiting.overfull or repeated != sum(of for _, of in scattered):
            raise Beyond
        if any_repeated(waiting.logs, self._bins, self._parts):
            raise Beyond
        number = np.unique(roots(waiting.parent), return_inverse=True)[1].astype(np.int32)
        components = int(number.max(initial=-1)) + 1
        if components == 1 and not repeated:
            labels = np.zeros(self._count, np.int32)
        else:
            labels = self._in_file_order(segments, number, np.repeat(first, np.diff(shares)))
        return Closure(0, components, labels, repeated, 0)

    def _scatter(self, which: int, stopped: threading.Event) -> tuple[list[_Segment], int]:
        """Put a share of the triangles into leaves; return the segments, and how many have a repeated corner."""
        begin = which * self._runs
        heads, state = np.zeros(self._leaves, np.int64), np.array([begin])
        rows, points = np.empty((BLOCK, 3), np.uint64), np.empty((BLOCK, 9), np.float32)
        leaf, packed = np.empty(BLOCK, np.int64), np.empty((BLOCK, 2), np.uint64)
        places = address(self._pool), self._parts * self._runs, address(heads), address(self._owners), address(state)
        (start, stop), repeated, segments = self._cuts[which : which + 2], 0, []
        first = start
        for at in range(start, stop, BLOCK):
            size = min(BLOCK, stop - at)
            if state[0] - begin + size // RUN + min(size, self._leaves) > self._runs:
                segments.append(self._spilled(self._segment(first, at, begin, heads, state)))
                first, state[0], heads[:] = at, begin, 0
            self._keys(at, at + size, rows, points)
            DESCEND.function(address(points), size, *self._descent, address(leaf))
            repeated += PACK.function(address(rows), size, address(leaf), address(packed))
            SCATTER.function(address(packed), 2, size, address(leaf), self._leaves, *places)
            if stopped.is_set():
                break
            if which == 0 and at % _REPORTED == 0:
                self._progress(0.5 * (at + size) / stop)
        return [*segments, self._segment(first, stop, begin, heads, state)], repeated

    def _segment(self, first: int, last: int, begin: int, heads: Int, state: Int) -> _Segment:
        """Return the segment that lies in the runs of the pool from `begin` on."""
        end = int(state[0])
        sizes = np.full(end - begin, RUN)
        unfilled = heads[heads % RUN != 0]
        sizes[unfilled // RUN - begin] = unfilled % RUN
        owners = self._owners[begin:end]
        order = np.argsort(owners, kind="stable")
        of = np.searchsorted(owners[order], np.arange(self._leaves + 1))
        return _Segment(first, last, begin + order, sizes[order], of)

    def _spilled(self, segment: _Segment) -> _Segment:
        """Write the runs of a segment to the file, one leaf after another."""
        count = len(segment.places)
        at, copy = self._file.reserve(count * RUN * _ROW), np.empty((_COPIED, RUN, 2), np.uint64)
        for start in range(0, count, _COPIED):
            some = segment.places[start : start + _COPIED]
            np.take(self._pool, some, axis=0, out=copy[: len(some)], mode="clip")
            self._file.write(copy[: len(some)], at + start * RUN * _ROW)
        return replace(segment, places=np.arange(count), at=at)

    def _pair(
        self, which: int, stopped: threading.Event, segments: list[_Segment], shares: Int
    ) -> tuple[WaitingEdges, int]:
        """Pair the edges of a share of the leaves, and put the pieces of their triangles in place of the rows.

        Returns the edges that wait for other threads' leaves, and how many triangles have a repeated corner.
        """
        low, high = shares[which : which + 2].tolist()
        thread, scratch = Thread(self._salt, Log(0, self._bins)), self._parts * self._runs + which * self._largest
        waiting = WaitingEdges(self._bins)
        for leaf in range(low, high):
            free, runs = scratch, []
            for segment in segments:
                places, sizes = segment.runs(leaf)
                if segment.at is not None and len(places):
                    if free + len(places) > scratch + self._largest:
                        raise Beyond
                    self._file.read(self._pool[free : free + len(places)], segment.at + int(places[0]) * RUN * _ROW)
                    places = places + (free - places[0])
                    free += len(places)
                runs.append(np.column_stack([places * RUN, sizes]))
            every = np.concatenate(runs)
            if len(every) == 0:
                continue
            pieces = np.zeros(int(every[:, 1].sum()), np.int32)
            if len(pieces) > self._largest * RUN:
                raise Beyond
            thread.begin(pieces)
            thread.leaf(self._pool, every)
            thread.labels.pop()
            np.add(pieces, waiting.pieces, out=pieces, where=pieces >= 0)
            edges, of = thread.edges.pop(), thread.pieces.pop() + np.int32(waiting.pieces)
            waiting.add_pieces(thread.numbers.pop())
            waiting.add(edges, of)
            if thread.open or thread.overfull or waiting.overfull or waiting.size > self._room or stopped.is_set():
                raise Beyond
            for segment, own in zip(segments, runs, strict=True):
                size = int(own[:, 1].sum())
                self._keep(segment, leaf, pieces[:size])
                pieces = pieces[size:]
            if which == 0:
                self._progress(0.5 + 0.5 * (leaf + 1) / high)
        return waiting, thread.repeated

    def _keep(self, segment: _Segment, leaf: int, labels: NDArray[np.int32]) -> None:
        """Put the pieces of a segment's triangles in a leaf where their rows were."""
        places, sizes = segment.runs(leaf)
        padded = np.empty((len(places), RUN), np.int32)
        padded[_filled(sizes)] = labels
        if segment.at is None:
            self._pool.view(np.int32)[places, :, 0] = padded
        elif len(places):
            self._file.write(padded, segment.at + int(places[0]) * RUN * _ROW)

    def _labels(self, segment: _Segment, leaf: int) -> NDArray[np.int32]:
        """Return what `_keep` has kept."""
        places, sizes = segment.runs(leaf)
        padded = np.empty((len(places), RUN), np.int32)
        if segment.at is None:
            padded = self._pool.view(np.int32)[places, :, 0]
        elif len(places):
            self._file.read(padded, segment.at + int(places[0]) * RUN * _ROW)
        labels: NDArray[np.int32] = padded[_filled(sizes)]
        return labels

    def _components(self, segment: _Segment, number: NDArray[np.int32], first: Int) -> NDArray[np.int32]:
        """Return the components of a segment's triangles, leaf by leaf; −1 for one with a repeated corner."""
        labels = np.empty(segment.last - segment.first, np.int32)
        end = 0
        for leaf, of in enumerate(first.tolist()):
            own = self._labels(segment, leaf)
            labels[end : end + len(own)] = np.where(own < 0, -1, number[own + of])
            end += len(own)
        return labels

    def _in_file_order(self, segments: list[_Segment], number: NDArray[np.int32], first: Int) -> NDArray[np.int32]:
        """Return the components of all triangles."""
        inside = [None if segment.at is not None else self._components(segment, number, first) for segment in segments]
        self._pool = np.empty((0, RUN, 2), np.uint64)
        result = np.empty(self._count, np.int32)

        def label(which: int, stopped: threading.Event) -> None:
            rows, points = np.empty((BLOCK, 3), np.uint64), np.empty((BLOCK, 9), np.float32)
            leaf = np.empty(BLOCK, np.int64)
            for place, segment in enumerate(segments):
                if not self._cuts[which] <= segment.first < self._cuts[which + 1] or stopped.is_set():
                    continue
                labels, inside[place] = inside[place], None
                if labels is None:
                    labels = self._components(segment, number, first)
                sizes = np.append(0, np.cumsum(segment.sizes))[segment.of]
                following = sizes[:-1]
                for at in range(segment.first, segment.last, BLOCK):
                    size = min(BLOCK, segment.last - at)
                    self._keys(at, at + size, rows, points)
                    DESCEND.function(address(points), size, *self._descent, address(leaf))
                    of = leaf[:size] & 0xFFFFFFFF
                    order = np.argsort(of.astype(np.uint16), kind="stable")
                    uses = np.bincount(of, minlength=self._leaves)
                    rank = np.arange(size) - np.repeat(np.cumsum(uses) - uses, uses)
                    result[at + order] = labels[np.repeat(following, uses) + rank]
                    following = following + uses

        in_threads(self._parts, label)
        return _numbered_by_first(result, int(number.max()) + 1)


def closed_by_place(
    triangles: Triangles, room: int, salt: NDArray[np.uint64], stack: ExitStack, progress: Progress
) -> Closure | None:
    """Return what `closure` does for a surface with two triangles at each edge, within `room` bytes; None for others.

    None stands also where there is too little room, and where there are no compiled kernels. A temporary file is in
    the folder that `stack` removes.
    """
    count, parts = triangles.count, max(1, min(threads(), room // (4 * FIXED + 1)))
    fixed = parts * FIXED + (0 if isinstance(triangles, Facets) else 8 * len(triangles.vertices))
    rows = min((room - fixed - _WAITING * count) // _TAKEN, (room - fixed - 4 * count) // 8)
    if rows < min(count, LEAST) or not all(kernel.worthwhile(count) for kernel in BY_PLACE):
        return None
    load(*BY_PLACE)
    file = TemporaryFile(max(_ROW * (count - rows), 0), stack)
    leaves = _Leaves(triangles, rows, parts, salt, file, progress)
    try:
        return leaves.closure()
    except Beyond:
        return None


def _filled(sizes: Int) -> Bool:
    """Say which rows of runs are filled."""
    filled: Bool = np.arange(RUN) < sizes[:, None]
    return filled


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
