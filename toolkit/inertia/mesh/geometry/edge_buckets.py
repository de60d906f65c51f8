"""Directed edges of triangles as records in buckets, by the first bits of their keys; the edges of a bucket, paired.

A record has 12 bytes: the 64-bit key of the edge, whose lowest bit says which way it runs, and the number of the
directed edge, 3 × triangle + side. What a bucket has is counted in a table inside the cache. There are two forms of
each step: compiled, and by numpy for any triangles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Int, Progress
from inertia.mesh.geometry.corner_keys import FACETS, Keys, corner_keys
from inertia.mesh.surface import Facets, Triangles
from inertia.native import Kernel, address

_MODULE = "inertia.mesh.geometry.bucket_kernel"
KEYS = Kernel(_MODULE, "key_edges", "pippp" + "ii")
SORT = Kernel(_MODULE, "sort_edges", "pii" + "ipi" + "pi")
COUNT = Kernel(_MODULE, "count_uses", "pi" + "pip" + "i")
PAIRS = Kernel(_MODULE, "regular_pairs", "pip" + "pp")
IRREGULAR = Kernel(_MODULE, "irregular_uses", "pi" + "pi" + "pii")
JOIN = Kernel(_MODULE, "join_pairs", "pi" + "pi")
NUMBER = Kernel(_MODULE, "number_pieces", "pi")
_KERNELS = (FACETS, KEYS, SORT, COUNT, PAIRS, IRREGULAR, JOIN, NUMBER)

SALTS = 15
"""Random numbers of the keys: seven and seven for a vertex, one for the edges (see `edge_kernel`)."""
BYTES = 12
"""Of a record."""
BUCKET = 1 << 16
"""Records in a bucket, about, or twice as many: the table of their edges lies in the cache."""
CHUNK = 1 << 15
"""Triangles that are read at a time."""
MOST = 2**32 // 3 - 1
"""Triangles whose directed edges can be numbered in 32 bits."""
REPEATED = 0xFFFFFFFF
"""In place of the piece of a triangle with a repeated corner."""


class Compiled:
    """The steps by the compiled kernels; numpy makes the keys of faces over vertices, unless theirs are at hand."""

    def __init__(self, salt: NDArray[np.uint64], corners: Keys | None = None) -> None:
        self._salt, self._by_numpy, self._corners = np.array(salt), Vectorised(salt), corners
        self._table, self._uses = np.zeros((BUCKET, 2), np.uint64), np.zeros((BUCKET, 2), np.uint32)
        self._pairs, self._rows = np.empty((BUCKET, 2), np.uint32), np.empty((CHUNK, 3), np.uint64)
        self.state = np.zeros(4, np.int64)
        """By keys: directed edges without an opposite partner; edges used more than twice, irregular, used once."""

    def keys(
        self, triangles: Triangles, start: int, stop: int, keys: NDArray[np.uint64], counts: Int, bits: int
    ) -> int:
        """Write the keys of the edges of triangles `start:stop`, and count them by bucket; 0 for a repeated corner."""
        if self._corners is None and not isinstance(triangles, Facets):
            return self._by_numpy.keys(triangles, start, stop, keys, counts, bits)
        (self._corners or corner_keys(triangles, self._salt))(start, stop, self._rows)
        salt, rows = address(self._salt), address(self._rows)
        return KEYS.function(rows, stop - start, salt, keys.ctypes.data, address(counts), len(counts), 64 - bits)

    def scatter(
        self, keys: NDArray[np.uint64], first: int, starts: Int, records: NDArray[np.uint32], bits: int
    ) -> None:
        """Sort records by bucket."""
        places = starts[:-1].copy()
        out = places.ctypes.data, len(places), records.ctypes.data, len(records)
        SORT.function(keys.ctypes.data, len(keys), first, 64 - bits, *out)

    def pairs(self, pieces: Callable[[], Iterable[NDArray[np.uint32]]]) -> tuple[NDArray[np.uint32], int]:
        """Return the pairs (k, 2) of triangles at the regular edges of a bucket, and how many edges are irregular."""
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
            size = 2 * len(table)
            self._table, self._uses = np.zeros((size, 2), np.uint64), np.zeros((size, 2), np.uint32)
            self._pairs = np.empty((size, 2), np.uint32)
        before = int(self.state[2])
        size = PAIRS.function(*at, self._pairs.ctypes.data, address(self.state))
        return self._pairs[:size], int(self.state[2]) - before

    def irregular(self, records: NDArray[np.uint32], halves: NDArray[np.uint32], size: int) -> int:
        """Append the irregular directed edges of the bucket that was joined last."""
        table = self._table.ctypes.data, len(self._table)
        return IRREGULAR.function(records.ctypes.data, len(records), *table, halves.ctypes.data, size, len(halves))

    def join(self, parent: NDArray[np.uint32], pairs: NDArray[Any]) -> None:
        """Join pairs (k, 2) of triangles."""
        each = np.ascontiguousarray(pairs, np.uint32)
        JOIN.function(each.ctypes.data, len(each), parent.ctypes.data, len(parent))

    def number(self, parent: NDArray[np.uint32]) -> int:
        """Number the pieces in the order of the file, in place."""
        return NUMBER.function(parent.ctypes.data, len(parent))


class Vectorised:
    """The same steps by numpy, for any triangles."""

    def __init__(self, salt: NDArray[np.uint64]) -> None:
        self._salt = np.array(salt)
        self._odd: NDArray[np.uint64] = np.empty(0, np.uint64)
        self.state = np.zeros(4, np.int64)
        """By keys: directed edges without an opposite partner; edges used more than twice, irregular, used once."""

    def keys(
        self, triangles: Triangles, start: int, stop: int, keys: NDArray[np.uint64], counts: Int, bits: int
    ) -> int:
        """Write the keys of the edges of triangles `start:stop`, and count them by bucket; 0 for a repeated corner."""
        stored = triangles.corners_f4 if isinstance(triangles, Facets) else triangles.corners
        corners: NDArray[Any] = np.ascontiguousarray(stored(start, stop))
        corners = corners + corners.dtype.type(0)  # −0 becomes +0
        tail = _of_vertices(corners.view(np.uint32).reshape(len(corners), 3, -1), *self._salt[:14].reshape(2, 7))
        head = np.roll(tail, -1, axis=1)
        edge = np.maximum(_of_edges(tail, head, self._salt[14]), np.uint64(2)) | (tail < head).astype(np.uint64)
        repeated: Bool = (tail == head).any(axis=1)
        keys[:] = np.where(repeated[:, None], np.uint64(0), edge).reshape(-1)
        counts += np.bincount((keys[keys != 0] >> np.uint64(64 - bits)).astype(np.int64), minlength=len(counts))
        return int(repeated.sum())

    def scatter(
        self, keys: NDArray[np.uint64], first: int, starts: Int, records: NDArray[np.uint32], bits: int
    ) -> None:
        """Sort records by bucket."""
        order = np.argsort(keys >> np.uint64(64 - bits), kind="stable")
        order = order[keys[order] != 0]
        records[: len(order), :2] = keys[order].view(np.uint32).reshape(-1, 2)
        records[: len(order), 2] = first + order

    def pairs(self, pieces: Callable[[], Iterable[NDArray[np.uint32]]]) -> tuple[NDArray[np.uint32], int]:
        """Return the pairs (k, 2) of triangles at the regular edges of a bucket, and how many edges are irregular."""
        records = np.concatenate([np.empty((0, 3), np.uint32), *(piece.copy() for piece in pieces())])
        keys = _keys_of(records)
        order = np.argsort(keys, kind="stable")
        edges, first, uses = np.unique(keys[order] >> np.uint64(1), return_index=True, return_counts=True)
        forward = np.add.reduceat(keys[order] & np.uint64(1), first, dtype=np.int64) if len(first) else uses
        regular = (uses == 2) & (forward == 1)
        self._odd = edges[~regular]
        self.state += np.abs(2 * forward - uses).sum(), (uses > 2).sum(), len(self._odd), (uses == 1).sum()
        return records[order, 2][first[regular][:, None] + [0, 1]] // 3, len(self._odd)

    def irregular(self, records: NDArray[np.uint32], halves: NDArray[np.uint32], size: int) -> int:
        """Append the irregular directed edges of the bucket that was joined last."""
        which = records[np.isin(_keys_of(records) >> np.uint64(1), self._odd), 2]
        fit = which[: max(len(halves) - size, 0)]
        halves[size : size + len(fit)] = fit
        return size + len(which)

    def join(self, parent: NDArray[np.uint32], pairs: NDArray[Any]) -> None:
        """Join pairs (k, 2) of triangles."""
        _join(parent, pairs)

    def number(self, parent: NDArray[np.uint32]) -> int:
        """Number the pieces in the order of the file, in place."""
        roots = []
        whole = parent != REPEATED
        for start in range(0, len(parent), CHUNK):
            own = parent[start : start + CHUNK]
            which = whole[start : start + CHUNK]
            own[which] = roots_of(parent, own[which])
            roots.append(start + np.flatnonzero(which & (own == np.arange(start, start + len(own)))))
        first = np.concatenate(roots)
        for start in range(0, len(parent), CHUNK):
            own, which = parent[start : start + CHUNK], whole[start : start + CHUNK]
            own[which] = np.searchsorted(first, own[which])
        return len(first)


Steps = Compiled | Vectorised


class Sorter:
    """Sorts the directed edges of up to `length` triangles by bucket.

    Parameters
    ----------
    bits : of a key that number the bucket
    """

    def __init__(self, steps: Steps, length: int, bits: int) -> None:
        self._steps, self._bits = steps, bits
        self._keys, self._records = np.empty(3 * length, np.uint64), np.empty((3 * length, 3), np.uint32)

    def run(self, triangles: Triangles, start: int, stop: int, first: int) -> tuple[NDArray[np.uint32], Int, Int]:
        """Return the records of triangles `start:stop`, where each bucket begins, and who has a repeated corner.

        `first` is the number of the first triangle in the whole surface; the records are overwritten by the next run.
        """
        counts, repeated = np.zeros(1 << self._bits, np.int64), []
        keys = self._keys[: 3 * (stop - start)]
        for at in range(start, stop, CHUNK):
            end = min(at + CHUNK, stop)
            own = keys[3 * (at - start) : 3 * (end - start)]
            if self._steps.keys(triangles, at, end, own, counts, self._bits):
                repeated.append(first + at - start + np.flatnonzero(own[::3] == 0))
        starts = np.append(0, np.cumsum(counts))
        self._steps.scatter(keys, 3 * first, starts, self._records, self._bits)
        return self._records[: starts[-1]], starts, np.concatenate([np.empty(0, np.int64), *repeated])


def irregular_halves(
    buckets: int,
    records: Callable[[int], Iterable[NDArray[np.uint32]]],
    steps: Steps,
    join: Callable[[NDArray[np.uint32]], None],
    room: int,
    progress: Progress | None = None,
) -> tuple[NDArray[np.uint32], int, int]:
    """Return the irregular directed edges, `room` at most, how many there are, and the first of all.

    `records` gives those of a bucket, piece by piece; `join` takes the pairs (k, 2) of triangles at regular edges.
    """
    halves, odd, first = np.empty(room, np.uint32), 0, MOST * 3
    for number in range(buckets):
        pairs, irregular = steps.pairs(lambda: records(number))  # noqa: B023  # it is used at once
        join(pairs)
        if irregular:
            for piece in records(number):
                some = np.empty(len(piece), np.uint32)
                some = some[: steps.irregular(piece, some, 0)]
                first = min(first, int(some.min(initial=first)))
                fit = some[: max(room - odd, 0)]
                halves[odd : odd + len(fit)] = fit
                odd += len(some)
        if progress is not None:
            progress((number + 1) / buckets)
    return halves[: min(odd, room)], odd, first


def steps_for(count: int, salt: NDArray[np.uint64], corners: Keys | None = None) -> Steps:
    """Return the form of the steps for so many triangles, whose corners have keys at hand or not."""
    return Compiled(salt, corners) if all(kernel.worthwhile(count) for kernel in _KERNELS) else Vectorised(salt)


def bits_for(count: int) -> int:
    """Return how many bits of a key number the buckets for so many triangles."""
    return min(max((3 * count // (2 * BUCKET)).bit_length(), 1), 14)


def _of_vertices(words: NDArray[np.uint32], one: NDArray[np.uint64], other: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return 60-bit keys of words (..., k): the upper halves of two sums over random numbers."""
    each, shift = words.astype(np.uint64), np.uint64(32)
    high, low = (salt[0] + (each * salt[1 : each.shape[-1] + 1]).sum(axis=-1, dtype=np.uint64) for salt in (one, other))
    key: NDArray[np.uint64] = ((high >> shift << shift) | (low >> shift)) >> np.uint64(4)
    return key


def _of_edges(tail: NDArray[np.uint64], head: NDArray[np.uint64], salt: np.uint64) -> NDArray[np.uint64]:
    """Return `edge_kernel.edge_key` without the way: (r + a)(r + b) modulo 2⁶¹ − 1, by products of 31 bits."""
    prime, half, s30, s31, s61 = (np.uint64(k) for k in (2**61 - 1, 2**31 - 1, 30, 31, 61))
    one, other = tail + (salt & prime), head + (salt & prime)
    high, low = (one >> s31, other >> s31), (one & half, other & half)
    middle = high[0] * low[1] + low[0] * high[1]
    rest = (middle & (half >> np.uint64(1))) << s31
    key = np.uint64(2) * high[0] * high[1] + (middle >> s30) + rest + low[0] * low[1]
    key = (key & prime) + (key >> s61)
    key -= prime * (key >= prime)
    edge: NDArray[np.uint64] = key << np.uint64(3)
    return edge


def _keys_of(records: NDArray[np.uint32]) -> NDArray[np.uint64]:
    return np.ascontiguousarray(records[:, :2]).view(np.uint64).reshape(-1)


def roots_of(parent: NDArray[np.uint32], places: NDArray[Any]) -> NDArray[np.uint32]:
    """Return the first triangles of the pieces that triangles belong to, by the table of joined ones."""
    while True:
        above: NDArray[np.uint32] = parent[places]
        if np.array_equal(above, places):
            return above
        places = above


def _join(parent: NDArray[np.uint32], pairs: NDArray[Any]) -> None:
    """Join pairs (k, 2) of triangles under the first of each piece."""
    while len(pairs):
        ends = np.sort(np.stack([roots_of(parent, pairs[:, 0]), roots_of(parent, pairs[:, 1])], axis=1), axis=1)
        pairs = ends[ends[:, 0] != ends[:, 1]]
        np.minimum.at(parent, pairs[:, 1], pairs[:, 0])
