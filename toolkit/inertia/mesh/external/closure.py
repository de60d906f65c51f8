"""Closure and components of a surface in bounded memory: its edges partitioned by their keys, paired bucket by bucket.

Each directed edge becomes a record of 12 bytes: its 64-bit key, whose lowest bit says which way it runs, and its
number, 3 × triangle + side. Runs of records are sorted by the first bits of their keys, the bucket, and written one
after another: to memory where they fit, else to a temporary file. What a bucket holds of all runs is then counted in a
table inside the cache. Triangles at an edge that is used once each way belong together: they are joined in one array
of 4 bytes a triangle. All other edges are irregular, and looked at again by their coordinates, exactly.
(J. S. Vitter, "Algorithms and data structures for external memory", Foundations and Trends in Theoretical Computer
Science 2 (2008), section 5; G. Graefe, "Query evaluation techniques", ACM Computing Surveys 25 (1993), section 3.)

Keys are those of `inertia.mesh.geometry.closure`: two edges have the same with a probability of about 2⁻⁶³. Where that
happens to a regular edge, it is irregular, and so looked at. Only two edges of one triangle each can be taken for a
pair, so that a surface with a hole, which has three of them or more, looks closed with a probability below 2⁻⁶³,
whatever its size.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int, Progress
from inertia.errors import Remedy, UsageError, WriteError
from inertia.mesh.geometry.closure import Closure, merge_equal_vertices
from inertia.mesh.geometry.edge_fans import links
from inertia.mesh.geometry.edges import Edges
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.part import Facets, Triangles
from inertia.native import Kernel, address
from inertia.output import temporary_folder

KEY_FACETS = Kernel("inertia.mesh.external.partition_kernel", "key_facets", "pippp" + "ii")
SCATTER = Kernel("inertia.mesh.external.partition_kernel", "scatter", "pii" + "ipi" + "pi")
COUNT = Kernel("inertia.mesh.external.partition_kernel", "count_uses", "pi" + "pip" + "i")
SETTLE = Kernel("inertia.mesh.external.partition_kernel", "settle", "pip" + "pi" + "pp")
IRREGULAR = Kernel("inertia.mesh.external.partition_kernel", "irregular_uses", "pi" + "pi" + "pii")
NUMBER = Kernel("inertia.mesh.external.partition_kernel", "number_pieces", "pi")
_KERNELS = (KEY_FACETS, SCATTER, COUNT, SETTLE, IRREGULAR, NUMBER)

MEMORY = Remedy("analyse", "memory", "BYTES")
MOST = 2**32 // 3 - 1
"""Triangles whose directed edges can be numbered in 32 bits."""

_RECORD = np.dtype((np.uint32, 3))
_BYTES = 12  # of a record
_SALTS = 18  # four and four for a vertex, five and five for an edge: see `partition_kernel`
_CHUNK = 1 << 15  # triangles that are read at a time
_BUCKET = 1 << 16  # records in a bucket, about: their table lies in the cache
_RUN = 3 * (8 + _BYTES)  # bytes of memory that a triangle of a run takes
_LEAST = 1 << 24  # bytes beside the array of triangles, at least
_EXACTLY = 4096  # bytes that a directed edge takes when it is looked at exactly, with its triangle
_REPEATED = 0xFFFFFFFF


@dataclass(frozen=True, eq=False)
class Irregular:
    """The edges that are not used once each way; `users` of `edges` are numbers of triangles of the whole surface.

    Attributes
    ----------
    triangles : those that have such an edge
    numbers : (m,), which they are in the whole surface, ascending
    vertices, faces : the different vertices of these, and the faces over them
    edges : the irregular ones
    """

    triangles: Triangles
    numbers: Int
    vertices: Float
    faces: Int
    edges: Edges


@dataclass(frozen=True, eq=False)
class Pairing:
    """What `external_closure` returns.

    Attributes
    ----------
    closure : as `inertia.mesh.geometry.closure.closure` returns it
    irregular : None where there are more such edges than can be looked at; edges of more than two triangles then join
        none in the closure
    triangle : one with an irregular edge, if there is any: the first, unless there are too many
    """

    closure: Closure
    irregular: Irregular | None
    triangle: int | None


def room_for(count: int) -> int:
    """Return the least number of bytes in which `external_closure` works."""
    return 4 * count + _LEAST


def external_closure(
    triangles: Triangles, room: int, progress: Progress | None = None, salt: NDArray[np.uint64] | None = None
) -> Pairing:
    """Pair the edges of a surface with finite coordinates as `closure` does, within `room` bytes.

    Raises
    ------
    UsageError : the room is too small
    WriteError : there is no room for temporary files

    >>> from inertia.mesh.part import Surface
    >>> tetrahedron = Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
    >>> pairing = external_closure(tetrahedron, room_for(3))
    >>> pairing.closure.open_edges, pairing.closure.components, pairing.irregular.edges.users.tolist()
    (3, 1, [0, 1, 2])
    """
    count = triangles.count
    if count > MOST:
        raise UsageError(f"{count} triangles are more than can be paired in one file, {MOST}: split the part")
    if room < room_for(count):
        raise UsageError(f"{count} triangles take {in_bytes(room_for(count))} or more: allow more by ", MEMORY)
    salt = np.frombuffer(os.urandom(8 * _SALTS), np.uint64) if salt is None else salt
    compiled = isinstance(triangles, Facets) and all(kernel.worthwhile(count) for kernel in _KERNELS)
    steps = _Compiled(salt) if compiled else _Vectorised(salt)
    parent = np.arange(count, dtype=np.uint32)
    left = room - 4 * count
    with ExitStack() as stack:
        runs = _Runs(count, left, stack)
        repeated = _partition(triangles, runs, steps, parent, _part_of(progress, 0.0, 0.5))
        halves, odd = _pair(runs, steps, parent, max(_BUCKET, left // 2 // _EXACTLY), _part_of(progress, 0.5, 1.0))
    irregular, (open_edges, crowded) = None, steps.state.tolist()
    if odd <= len(halves):
        irregular, joined = _exactly(triangles, np.sort(halves[:odd]).astype(np.int64), parent)
        steps.join(parent, joined)
        uses, surplus = irregular.edges.uses, irregular.edges.forward - irregular.edges.backward
        crowded, open_edges = int((uses > 2).sum()), int(np.abs(surplus).sum())
    components = steps.number(parent)
    labels = parent.view(np.int32)
    first = int(halves[:odd].min()) // 3 if odd else None
    return Pairing(Closure(open_edges, components, labels, repeated, crowded), irregular, first)


class _Runs:
    """Records of directed edges, in runs sorted by bucket: in memory where they fit in `room` bytes, else in a file."""

    def __init__(self, count: int, room: int, stack: ExitStack) -> None:
        self.bits = min(max((3 * count // (2 * _BUCKET)).bit_length(), 1), 14)
        self.in_memory = 3 * _BYTES * count + _RUN * min(count, _CHUNK) <= room // 2
        self._arrays: list[NDArray[np.uint32]] = []
        self._starts: list[Int] = []
        self._begin: list[int] = []
        self._end = 0
        if self.in_memory:
            self.length = min(count, max(_CHUNK, room // 4 // _RUN))
            return
        self.length = min(count, max(_CHUNK, (room - _LEAST // 2) // _RUN))
        folder = stack.enter_context(temporary_folder())
        _require_space(folder, 3 * _BYTES * count)
        self._file = os.open(folder / "edges", os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o600)
        stack.callback(os.close, self._file)
        self._folder = folder

    @property
    def buckets(self) -> int:
        """How many there are."""
        return int(1 << self.bits)

    def add(self, records: NDArray[np.uint32], starts: Int) -> None:
        """Keep a run (n, 3), whose bucket b is `starts[b]:starts[b + 1]`."""
        self._starts.append(starts)
        if self.in_memory:
            self._arrays.append(records.copy())
            return
        self._begin.append(self._end)
        data = records.data.cast("B")
        try:
            while len(data):
                written = os.pwrite(self._file, data, self._end) if hasattr(os, "pwrite") else self._write(data)
                self._end += written
                data = data[written:]
        except OSError as error:
            raise WriteError(
                f"cannot write temporary files to {self._folder.parent}: {error.strerror}: set TMPDIR to another folder"
            ) from None

    def bucket(self, number: int, buffer: NDArray[np.uint32]) -> Iterator[NDArray[np.uint32]]:
        """Yield what all runs have of a bucket, in pieces no longer than the buffer, which they may lie in."""
        filled = 0
        for run, starts in enumerate(self._starts):
            at, stop = int(starts[number]), int(starts[number + 1])
            if self.in_memory:
                for first in range(at, stop, len(buffer)):
                    yield self._arrays[run][first : min(first + len(buffer), stop)]
                continue
            while at < stop:
                size = min(stop - at, len(buffer) - filled)
                self._read(self._begin[run] + _BYTES * at, buffer[filled : filled + size].data.cast("B"))
                at, filled = at + size, filled + size
                if filled == len(buffer):
                    yield buffer
                    filled = 0
        if filled:
            yield buffer[:filled]

    def _write(self, data: memoryview) -> int:
        os.lseek(self._file, self._end, os.SEEK_SET)
        return os.write(self._file, data)

    def _read(self, at: int, into: memoryview) -> None:
        if hasattr(os, "preadv"):
            size = os.preadv(self._file, [into], at)
        else:
            os.lseek(self._file, at, os.SEEK_SET)
            data = os.read(self._file, len(into))
            size = len(data)
            into[:size] = data
        if size < len(into):
            raise WriteError("a temporary file is shorter than what was written to it: run again")


def _require_space(folder: Path, size: int) -> None:
    """Raise `WriteError` where a folder has no room for a temporary file."""
    free = shutil.disk_usage(folder).free
    if free < size:
        raise WriteError(
            f"temporary files of {in_bytes(size)} are needed, and {folder.parent} has room for {in_bytes(free)}: set "
            "TMPDIR to another folder, or allow more memory by ",
            MEMORY,
        )


def _partition(
    triangles: Triangles, runs: _Runs, steps: _Compiled | _Vectorised, parent: NDArray[np.uint32], progress: Progress
) -> int:
    """Write the edges of all triangles into runs; return how many triangles have a repeated corner."""
    count = triangles.count
    repeated = 0
    keys = np.empty(3 * runs.length, np.uint64)
    records = np.empty((3 * runs.length, 3), np.uint32)
    for first in range(0, count, runs.length):
        last = min(first + runs.length, count)
        counts = np.zeros(runs.buckets, np.int64)
        for start in range(first, last, _CHUNK):
            stop = min(start + _CHUNK, last)
            own = keys[3 * (start - first) : 3 * (stop - first)]
            if more := steps.keys(triangles, start, stop, own, counts, runs.bits):
                repeated += more
                parent[start:stop][own[::3] == 0] = _REPEATED
            progress(stop / count)
        starts = np.append(0, np.cumsum(counts))
        steps.scatter(keys[: 3 * (last - first)], 3 * first, starts, records, runs.bits)
        runs.add(records[: starts[-1]], starts)
    return repeated


def _pair(
    runs: _Runs, steps: _Compiled | _Vectorised, parent: NDArray[np.uint32], room: int, progress: Progress
) -> tuple[NDArray[np.uint32], int]:
    """Join triangles at regular edges; return the irregular directed edges, `room` at most, and how many there are."""
    halves, odd = np.empty(room, np.uint32), 0
    buffer = np.empty((2 * _BUCKET, 3), np.uint32)
    for number in range(runs.buckets):
        if steps.join_bucket(lambda: runs.bucket(number, buffer), parent):  # noqa: B023  # it is used at once
            for records in runs.bucket(number, buffer):
                odd = steps.irregular(records, halves, odd)
        progress((number + 1) / runs.buckets)
    return halves, odd


class _Compiled:
    """The steps by the compiled kernels, for binary STL records."""

    def __init__(self, salt: NDArray[np.uint64]) -> None:
        self._salt = np.array(salt)
        self._table, self._uses = np.zeros((_BUCKET, 2), np.uint64), np.zeros((_BUCKET, 2), np.uint32)
        self._pairs = np.empty((64, 2), np.int64)
        self.state = np.zeros(2, np.int64)
        """Directed edges without an opposite partner, and edges used more than twice, by their keys."""

    def keys(
        self, triangles: Triangles, start: int, stop: int, keys: NDArray[np.uint64], counts: Int, bits: int
    ) -> int:
        """Write the keys of the edges of triangles `start:stop`, and count them by bucket; 0 for a repeated corner."""
        assert isinstance(triangles, Facets)
        block = triangles.block(start, stop)
        at = address(self._salt), keys.ctypes.data, address(counts)
        return KEY_FACETS.function(block.ctypes.data, stop - start, *at, len(counts), 64 - bits)

    def scatter(
        self, keys: NDArray[np.uint64], first: int, starts: Int, records: NDArray[np.uint32], bits: int
    ) -> None:
        """Sort records by bucket."""
        places = starts[:-1].copy()
        out = places.ctypes.data, len(places), records.ctypes.data, len(records)
        SCATTER.function(keys.ctypes.data, len(keys), first, 64 - bits, *out)

    def join_bucket(self, pieces: Callable[[], Iterator[NDArray[np.uint32]]], parent: NDArray[np.uint32]) -> int:
        """Count the uses of the edges of a bucket, join the triangles of the regular ones, and count the others."""
        while True:
            used, table = 0, self._table
            table[:] = 0
            at = table.ctypes.data, len(table), self._uses.ctypes.data
            for records in pieces():
                used = COUNT.function(records.ctypes.data, len(records), *at, used)
                if used < 0:
                    break
            else:
                break
            self._table, self._uses = np.zeros((2 * len(table), 2), np.uint64), np.zeros((2 * len(table), 2), np.uint32)
        return SETTLE.function(*at, parent.ctypes.data, len(parent), self._pairs.ctypes.data, address(self.state))

    def irregular(self, records: NDArray[np.uint32], halves: NDArray[np.uint32], size: int) -> int:
        """Append the irregular directed edges of the bucket that was joined last."""
        table = self._table.ctypes.data, len(self._table)
        return IRREGULAR.function(records.ctypes.data, len(records), *table, halves.ctypes.data, size, len(halves))

    def join(self, parent: NDArray[np.uint32], pairs: Int) -> None:
        """Join pairs (k, 2) of triangles."""
        _join(parent, pairs)

    def number(self, parent: NDArray[np.uint32]) -> int:
        """Number the pieces in the order of the file, in place."""
        return NUMBER.function(parent.ctypes.data, len(parent))


class _Vectorised:
    """The same steps by numpy, for any triangles."""

    def __init__(self, salt: NDArray[np.uint64]) -> None:
        self._salt = np.array(salt)
        self._odd: NDArray[np.uint64] = np.empty(0, np.uint64)
        self.state = np.zeros(2, np.int64)
        """Directed edges without an opposite partner, and edges used more than twice, by their keys."""

    def keys(
        self, triangles: Triangles, start: int, stop: int, keys: NDArray[np.uint64], counts: Int, bits: int
    ) -> int:
        """Write the keys of the edges of triangles `start:stop`, and count them by bucket; 0 for a repeated corner."""
        corners = np.ascontiguousarray(triangles.corners(start, stop) + 0.0)
        vertex = self._hashed(corners.view(np.uint32).reshape(-1, 3, 6))
        tail, head = vertex, np.roll(vertex, -1, axis=1)
        forward = (tail < head).astype(np.uint64)
        ends = np.sort(np.stack([tail, head], axis=2), axis=2).view(np.uint32).reshape(len(corners), 3, 4)
        edge = self._hashed(ends[..., [0, 1, 2, 3, 0, 1]]) & ~np.uint64(1)
        edge = np.where(edge == 0, np.uint64(2), edge) | forward
        repeated: Bool = (tail == head).any(axis=1)
        keys[:] = np.where(repeated[:, None], np.uint64(0), edge).reshape(-1)
        counts += np.bincount(keys[keys != 0] >> np.uint64(64 - bits), minlength=len(counts)).astype(np.int64)
        return int(repeated.sum())

    def scatter(
        self, keys: NDArray[np.uint64], first: int, starts: Int, records: NDArray[np.uint32], bits: int
    ) -> None:
        """Sort records by bucket."""
        order = np.argsort(keys >> np.uint64(64 - bits), kind="stable")
        order = order[keys[order] != 0]
        records[: len(order), :2] = keys[order].view(np.uint32).reshape(-1, 2)
        records[: len(order), 2] = first + order

    def join_bucket(self, pieces: Callable[[], Iterator[NDArray[np.uint32]]], parent: NDArray[np.uint32]) -> int:
        """Count the uses of the edges of a bucket, join the triangles of the regular ones, and count the others."""
        records = np.concatenate([np.empty((0, 3), np.uint32), *(piece.copy() for piece in pieces())])
        keys = _keys_of(records)
        order = np.argsort(keys, kind="stable")
        edges, first, uses = np.unique(keys[order] >> np.uint64(1), return_index=True, return_counts=True)
        forward = np.add.reduceat(keys[order] & np.uint64(1), first, dtype=np.int64) if len(first) else uses
        self.state += np.abs(2 * forward - uses).sum(), (uses > 2).sum()
        regular = (uses == 2) & (forward == 1)
        pairs = records[order, 2].astype(np.int64)[first[regular][:, None] + [0, 1]] // 3
        _join(parent, pairs)
        self._odd = edges[~regular]
        return len(self._odd)

    def irregular(self, records: NDArray[np.uint32], halves: NDArray[np.uint32], size: int) -> int:
        """Append the irregular directed edges of the bucket that was joined last."""
        which = records[np.isin(_keys_of(records) >> np.uint64(1), self._odd), 2]
        fit = which[: max(len(halves) - size, 0)]
        halves[size : size + len(fit)] = fit
        return size + len(which)

    def join(self, parent: NDArray[np.uint32], pairs: Int) -> None:
        """Join pairs (k, 2) of triangles."""
        _join(parent, pairs)

    def number(self, parent: NDArray[np.uint32]) -> int:
        """Number the pieces in the order of the file, in place."""
        roots = []
        whole = parent != _REPEATED
        for start in range(0, len(parent), _CHUNK):
            own = parent[start : start + _CHUNK]
            which = whole[start : start + _CHUNK]
            own[which] = _roots(parent, own[which])
            roots.append(start + np.flatnonzero(which & (own == np.arange(start, start + len(own)))))
        first = np.concatenate(roots)
        for start in range(0, len(parent), _CHUNK):
            own, which = parent[start : start + _CHUNK], whole[start : start + _CHUNK]
            own[which] = np.searchsorted(first, own[which])
        return len(first)

    def _hashed(self, words: NDArray[np.uint32]) -> NDArray[np.uint64]:
        """Return a 64-bit key of each row of six words: the upper halves of two sums over random numbers."""
        each = words.astype(np.uint64)
        high, low = (
            salt[0] + (each * salt[1:7]).sum(axis=-1, dtype=np.uint64) for salt in self._salt[:14].reshape(2, 7)
        )
        shift = np.uint64(32)
        key: NDArray[np.uint64] = (high >> shift << shift) | (low >> shift)
        return key


def _keys_of(records: NDArray[np.uint32]) -> NDArray[np.uint64]:
    return np.ascontiguousarray(records[:, :2]).view(np.uint64).reshape(-1)


def _roots(parent: NDArray[np.uint32], places: NDArray[Any]) -> NDArray[np.uint32]:
    """Return the first triangles of the pieces that triangles belong to."""
    while True:
        above: NDArray[np.uint32] = parent[places]
        if np.array_equal(above, places):
            return above
        places = above


def _join(parent: NDArray[np.uint32], pairs: Int) -> None:
    """Join pairs (k, 2) of triangles under the first of each piece."""
    while len(pairs):
        ends = np.sort(np.stack([_roots(parent, pairs[:, 0]), _roots(parent, pairs[:, 1])], axis=1), axis=1)
        pairs = ends[ends[:, 0] != ends[:, 1]]
        np.minimum.at(parent, pairs[:, 1], pairs[:, 0])


def _exactly(triangles: Triangles, halves: Int, parent: NDArray[np.uint32]) -> tuple[Irregular, Int]:
    """Pair irregular directed edges by their coordinates; return those that are, and the triangles that they join."""
    numbers = np.unique(halves // 3)
    some = triangles.select(numbers)
    vertices, faces = merge_equal_vertices(some)
    order = np.argsort(_first_uses(triangles, vertices), kind="stable")
    vertices, faces = vertices[order], np.argsort(order)[faces]
    directed = half_edges(faces)
    marked = np.zeros(3 * len(faces), bool)
    marked[3 * np.searchsorted(numbers, halves // 3) + halves % 3] = True
    member = directed.by_edge[marked[directed.by_edge]]
    edge = directed.edge[member]
    leads = np.append(True, edge[1:] != edge[:-1])[: len(edge)]
    start = np.flatnonzero(leads)
    uses = np.diff(np.append(start, len(edge)))
    forward = np.add.reduceat(directed.direction[member] > 0, start, dtype=np.int64) if len(start) else uses
    regular = (uses == 2) & (forward == 1)
    joined = numbers[member[start[regular][:, None] + [0, 1]] // 3]
    if (uses > 2).any():
        piece = _roots(parent, numbers).astype(np.int64)
        more = links(vertices, faces, directed, np.unique(piece, return_inverse=True)[1])
        joined = np.concatenate([joined, numbers[more]])
    low, high = np.minimum(directed.tail, directed.head), np.maximum(directed.tail, directed.head)
    odd: Bool = ~regular
    first = member[start[odd]]
    users = numbers[member[np.repeat(odd, uses)] // 3]
    edges = Edges(np.column_stack([low[first], high[first]]), forward[odd], (uses - forward)[odd], users)
    return Irregular(some, numbers, vertices, faces, edges), joined


def _first_uses(triangles: Triangles, vertices: Float) -> Int:
    """Return the number of the first corner of the surface at each vertex: whoever numbers them all goes by that."""
    first = np.full(len(vertices), 3 * triangles.count)
    if len(vertices) == 0:
        return first
    hashes = _mixed(vertices)
    order = np.argsort(hashes, kind="stable")
    ranked = hashes[order]
    some = np.zeros(1 << 16, bool)
    some[ranked >> np.uint64(48)] = True
    for start in range(0, triangles.count, _CHUNK):
        corners = triangles.corners(start, start + _CHUNK).reshape(-1, 3) + 0.0
        mixed = _mixed(corners)
        which = np.flatnonzero(some[mixed >> np.uint64(48)])
        rank = np.minimum(np.searchsorted(ranked, mixed[which]), len(ranked) - 1)
        same = (vertices[order[rank]] == corners[which]).all(axis=1)
        np.minimum.at(first, order[rank[same]], 3 * start + which[same])
    return first


def _mixed(points: Float) -> NDArray[np.uint64]:
    """Return a number for each point (k, 3) that is the same for the same coordinates, and seldom for others."""
    mixed = np.zeros(len(points), np.uint64)
    for bits in points.view(np.uint64).T:
        mixed = (mixed ^ bits) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    return mixed * np.uint64(0xBF58476D1CE4E5B9)


def _part_of(progress: Progress | None, start: float, stop: float) -> Progress:
    return lambda done: None if progress is None else progress(start + done * (stop - start))


def in_bytes(size: float) -> str:
    """Return a number of bytes in words.

    >>> in_bytes(3.6e9), in_bytes(16777216)
    ('3.6 GB', '16.8 MB')
    """
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.3g} MB"
