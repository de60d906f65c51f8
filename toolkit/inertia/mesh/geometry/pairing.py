"""Edges of a triangle surface paired by compiled kernels: group by group of triangles, each inside the cache.

Triangles that follow one another in a file mostly are neighbours, so that a group is what stands together there; of its
edges few are left for the other groups. Where more wait for their partners than the cache holds, the triangles are put
into groups by where they are in space: by the leaf of a tree of planes, each of which halves a sample of them. An edge
with both ends in one leaf is then used by triangles of this leaf alone; only the others are paired with those of other
groups. What is found does not depend on the groups, nor on how many threads pair them.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int, Progress
from inertia.mesh.part import Facets, Triangles
from inertia.native import Kernel, address, threads

_MODULE = "inertia.mesh.geometry.edge_kernel"
FACETS = Kernel(_MODULE, "key_facets", "pippp" + "i")
FACES = Kernel(_MODULE, "key_faces", "pippipp" + "i")
KEYS = Kernel(_MODULE, "key_vertices", "pipp")
ROWS = Kernel(_MODULE, "pair_rows", "pipii" + "ppippi" + "piipp")
CLOSE = Kernel(_MODULE, "close_group", "pippi" + "ppp")
LEAF = Kernel(_MODULE, "pair_leaf", "ppip" + "pip" + "ppi" + "ppp")
EDGES = Kernel(_MODULE, "pair_edges", "ppipi" + "pi" + "piipp")
REPEATED = Kernel(_MODULE, "repeated_edges", "piiiipi")
_PARTITION = "inertia.mesh.geometry.partition_kernel"
DESCEND = Kernel(_PARTITION, "descend", "pipppip")
PACK = Kernel(_PARTITION, "pack", "pipp")
SCATTER = Kernel(_PARTITION, "scatter", "piipipippp")

BY_PLACE = LEAF, DESCEND, PACK, SCATTER

BLOCK = 8192  # triangles whose corners' keys are computed at a time
_GROUP = 1 << 17  # triangles that are paired together where they stand together
_REPORTED = 16 * BLOCK
_TABLE = 1 << 15  # room for the edges that wait, of which half is used: it stays inside the cache
_LEAF = 8192  # triangles that are paired together where they are near each other, about
RUN = 64  # rows that lie together, as `partition_kernel` has them
_SAMPLED = 16  # triangles a leaf that the planes are from:
_EVERY, _READ, _APART = 16, 512, 8192  # every so manieth of so many that are read of so many
BIN = 16384  # paired edges whose keys are compared at a time
_SHARED = 1 << 18  # triangles from which on threads repay their start

Keys = Callable[[int, int, NDArray[np.uint64], NDArray[np.float32] | None], None]
"""Writes the keys of the corners of triangles `start:stop`, and, where that is wanted, their coordinates."""


class _Scattered(Exception):
    """Triangles that follow one another are no neighbours."""


class Log:
    """The keys of edges that were paired, in bins."""

    def __init__(self, edges: int, bins: int) -> None:
        self.room = edges // bins + 8 * int(np.sqrt(edges // bins)) + 64
        self.keys, self.sizes = np.empty(bins * self.room, np.uint64), np.zeros(bins, np.int64)
        self.arguments = address(self.keys), bins, self.room, address(self.sizes)


class Thread:
    """What one thread has for pairing, and the groups that it has done: see `group`."""

    def __init__(self, salt: NDArray[np.uint64], log: Log) -> None:
        self.salt, self.log = salt, log
        self.state = np.zeros(5 + 3 * 64, np.int64)
        self.table = _empty_table(_TABLE)
        self.own, self.parent, self.partners, self.whose = (np.empty(0, np.int32) for _ in range(4))
        self.waiting = np.empty(0, np.uint64)
        self.edges: list[NDArray[np.uint64]] = []
        self.pieces: list[NDArray[np.int32]] = []
        self.labels: list[NDArray[np.int32]] = []
        self.numbers: list[int] = []
        self.repeated = self.open = 0
        self.overfull = False

    def begin(self, labels: NDArray[np.int32]) -> None:
        """Begin a group, to whose triangles labels are given."""
        self.state[:3] = self.state[4] = 0
        self.labels.append(labels)
        if len(self.own) <= len(labels):
            self.own, self.parent = np.empty(len(labels) + 1, np.int32), np.empty(len(labels) + 1, np.int32)

    def pair(self, rows: NDArray[np.uint64], runs: Int, passed: int = 0) -> bool:
        """Pair the rows of runs, after those `passed` in the group; say whether the table is too small for them."""
        labels, table = self.own[: len(self.labels[-1])], self.table
        return ROWS.function(
            address(rows), rows.shape[1], address(runs), len(runs), passed, address(self.salt),
            address(table), len(table), address(self.parent), address(labels), len(labels),
            *self.log.arguments, address(self.state),
        ) == 1  # fmt: skip

    def end(self) -> None:
        """End the group: keep its edges that still wait, and how many pieces it has."""
        labels = self.own[: len(self.labels[-1])]
        edges, pieces = np.empty(self.state[0], np.uint64), np.empty(self.state[0], np.int32)
        number = CLOSE.function(
            address(self.table), len(self.table), address(self.parent), address(labels), len(labels),
            edges.ctypes.data, pieces.ctypes.data, address(self.state),
        )  # fmt: skip
        self._keep(edges, pieces, number, labels)

    def leaf(self, rows: NDArray[np.uint64], runs: Int, largest: int = 0) -> None:
        """Pair the rows of some runs, which are a group by themselves; if known, the largest such group has so many."""
        size = len(self.labels[-1])
        largest, capacity = max(largest, size), 1 << (4 * size - 1).bit_length()
        if len(self.waiting) < 3 * size:
            self.table = _empty_table(4 * largest)
            self.partners, self.waiting = np.empty(4 * largest + 4, np.int32), np.empty(3 * largest, np.uint64)
            self.whose = np.empty(3 * largest, np.int32)
        number = LEAF.function(
            address(rows), address(runs), len(runs), address(self.salt), address(self.table), capacity,
            address(self.partners), address(self.parent), address(self.own), size,
            address(self.waiting), address(self.whose), address(self.state),
        )  # fmt: skip
        self.open += int(self.state[1])
        waiting = self.state[0]
        self._keep(self.waiting[:waiting].copy(), self.whose[:waiting].copy(), number, self.own[1 : size + 1])

    def _keep(
        self, edges: NDArray[np.uint64], pieces: NDArray[np.int32], number: int, labels: NDArray[np.int32]
    ) -> None:
        if number > 1 or self.state[2]:  # memory that stays 0 is not taken
            self.labels[-1][:] = labels
        self.edges.append(edges)
        self.pieces.append(pieces)
        self.numbers.append(number)
        self.repeated += int(self.state[2])
        self.overfull |= bool(self.state[3])


def _empty_table(slots: int) -> NDArray[np.uint64]:
    """Return a table with that many slots or more, a power of two, which is written to.

    Of what is only read, all pages are one page of zeros, and its copy at the first write stops the other processors.
    """
    table = np.empty((1 << (slots - 1).bit_length(), 2), np.uint64)
    table.fill(0)
    return table


def paired_edges(
    triangles: Triangles, salt: NDArray[np.uint64], progress: Progress | None = None
) -> tuple[int, int, NDArray[np.int32], int] | None:
    """Return open edges, components, labels and repeated triangles; None where an edge may have more than two."""
    count, salt, progress = (
        triangles.count,
        salt.copy(),
        _rising(progress),
    )  # which may be written to, as `address` asks
    bins = 1 << min(max(3 * count // 2 // BIN, 1).bit_length() - 1, 12)
    parts = threads() if count >= _SHARED else 1
    cuts = [*(BLOCK * (part * count // (parts * BLOCK)) for part in range(parts)), count]
    keys = corner_keys(triangles, salt)
    load(ROWS, CLOSE, EDGES, REPEATED)
    index = None
    labels = np.zeros(count, np.int32)
    try:
        done = _pair_in_order(labels, keys, cuts, salt, bins, progress)
    except _Scattered:
        if not all(kernel.worthwhile(count) for kernel in BY_PLACE):
            return None
        done, index = _pair_by_place(triangles, labels, keys, cuts, salt, bins, progress)
    numbers = np.array([number for thread in done for number in thread.numbers], np.int64)
    base = np.cumsum(numbers) - numbers
    edges = [each for thread in done for each in thread.edges]
    logs, state = [thread.log for thread in done], np.zeros(5, np.int64)
    number = np.arange(numbers.sum(), dtype=np.int32)
    if waiting := sum(map(len, edges)):
        apart = [each for thread in done for each in thread.pieces]
        keys_left = np.concatenate(edges)
        pieces = np.concatenate([each + np.int32(of) for each, of in zip(apart, base, strict=True)])
        logs.append(Log(waiting, bins))
        table = _empty_table(5 * waiting // 4 + 2)
        EDGES.function(
            address(keys_left), address(pieces), waiting, address(table), len(table), address(number), len(number),
            *logs[-1].arguments, address(state),
        )  # fmt: skip
        number = np.unique(roots(number), return_inverse=True)[1].astype(np.int32)
    overfull = any(thread.overfull for thread in done) or bool(state[3])
    if overfull or any_repeated(logs, bins, len(cuts) - 1):
        return None
    components = int(number.max(initial=-1)) + 1
    repeated = sum(thread.repeated for thread in done)
    groups = zip((group for thread in done for group in thread.labels), base, strict=True)
    if components > 1:
        for group, of in groups:
            group[:] = np.where(group < 0, -1, number[group + of])
    elif repeated or len(numbers) < numbers.sum():
        np.minimum(labels, 0, out=labels)
    if index is not None and (components > 1 or repeated):
        labels = _in_file_order(labels, index(), components)
    return int(state[0]) + sum(thread.open for thread in done), components, labels, repeated


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


def load(*kernels: Kernel) -> None:
    """Load kernels here, before threads ask for them."""
    for kernel in kernels:
        kernel.function  # noqa: B018


def corner_keys(triangles: Triangles, salt: NDArray[np.uint64]) -> Keys:
    """Return what writes the keys of corners, by random numbers (15,)."""
    if isinstance(triangles, Facets):
        facets, key_facets = triangles, FACETS.function

        def of_facets(start: int, stop: int, rows: NDArray[np.uint64], points: NDArray[np.float32] | None) -> None:
            records = facets.block(start, stop)
            wanted = points is not None
            at = address(points if wanted else rows), wanted
            key_facets(records.ctypes.data, stop - start, address(salt), address(rows), *at)

        return of_facets
    surface, vertices, key_faces = triangles, triangles.vertices, FACES.function
    of = np.empty(len(vertices), np.uint64)
    KEYS.function(vertices.ctypes.data, len(vertices), address(salt), of.ctypes.data)

    def of_faces(start: int, stop: int, rows: NDArray[np.uint64], points: NDArray[np.float32] | None) -> None:
        faces = surface.block(start, stop)
        those = of.ctypes.data, vertices.ctypes.data, len(vertices)
        wanted = points is not None
        key_faces(faces.ctypes.data, len(faces), *those, address(rows), address(points if wanted else rows), wanted)

    return of_faces


def _pair_in_order(
    labels: NDArray[np.int32],
    keys: Keys,
    cuts: Sequence[int],
    salt: NDArray[np.uint64],
    bins: int,
    progress: Progress | None,
) -> list[Thread]:
    def pair(which: int, stopped: threading.Event) -> Thread:
        start, stop = cuts[which : which + 2]
        thread, rows = Thread(salt, Log(3 * (stop - start) // 2, bins)), np.empty((BLOCK, 3), np.uint64)
        for first in range(start, stop, _GROUP):
            last = min(first + _GROUP, stop)
            thread.begin(labels[first:last])
            for at in range(first, last, BLOCK):
                size = min(BLOCK, last - at)
                keys(at, at + size, rows, None)
                if stopped.is_set() or thread.pair(rows, np.array([[0, size]]), at - first):
                    raise _Scattered
                if progress is not None and which == 0 and at % _REPORTED == 0:
                    progress((at + size) / stop)
            thread.end()
        return thread

    return in_threads(len(cuts) - 1, pair)


def _pair_by_place(
    triangles: Triangles,
    labels: NDArray[np.int32],
    keys: Keys,
    cuts: Sequence[int],
    salt: NDArray[np.uint64],
    bins: int,
    progress: Progress | None,
) -> tuple[list[Thread], Callable[[], Int]]:
    load(*BY_PLACE)
    count, parts = triangles.count, len(cuts) - 1
    depth = max((count // _LEAF).bit_length() - 1, 1)
    leaves = 1 << depth
    axes, planes, cells = tree(sample(triangles, _SAMPLED * leaves), depth)
    most = [-(-(stop - start) // RUN) + leaves for start, stop in pairwise(cuts)]
    ends = np.cumsum([0, *most]).tolist()

    def scatter(which: int, stopped: threading.Event, into: NDArray[np.uint64], numbered: bool) -> tuple[Int, int, int]:
        heads, state = np.zeros(leaves, np.int64), np.array([ends[which]])
        rows, points = np.empty((BLOCK, 3), np.uint64), np.empty((BLOCK, 9), np.float32)
        leaf, packed = np.empty(BLOCK, np.int64), np.empty((BLOCK, into.shape[1]), np.uint64)
        tree = address(axes), address(planes), address(cells), depth
        places = address(into), ends[-1], address(heads), address(owners), address(state)
        (start, stop), repeated = cuts[which : which + 2], 0
        for at in range(start, stop, BLOCK):
            size = min(BLOCK, stop - at)
            keys(at, at + size, rows, points)
            DESCEND.function(address(points), size, *tree, address(leaf))
            if numbered:
                packed[:size, 0] = np.arange(at, at + size, dtype=np.uint64)
            else:
                repeated += PACK.function(address(rows), size, address(leaf), address(packed))
            SCATTER.function(address(packed), packed.shape[1], size, address(leaf), leaves, *places)
            if stopped.is_set():
                break
            if progress is not None and which == 0 and at % _REPORTED == 0:
                progress(0.5 * (at + size) / stop)
        return heads, int(state[0]), repeated

    pool, owners = np.empty((ends[-1] * RUN, 2), np.uint64), np.empty(ends[-1], np.int64)
    scattered = in_threads(parts, partial(scatter, into=pool, numbered=False))
    taken = np.concatenate([np.arange(first, last) for first, (_, last, _) in zip(ends, scattered, strict=False)])
    sizes = np.full(ends[-1], RUN)
    for heads, *_ in scattered:
        unfilled = heads[heads % RUN != 0]
        sizes[unfilled // RUN] = unfilled % RUN
    taken = taken[np.argsort(owners[taken], kind="stable")]
    runs = np.column_stack([taken * RUN, sizes[taken]])
    first_run = np.searchsorted(owners[taken], np.arange(leaves + 1))
    ends_of = np.concatenate([[0], np.cumsum(runs[:, 1])])
    shares = np.searchsorted(ends_of[first_run], np.array(cuts))  # leaves, as many triangles to each thread

    def pair(which: int, stopped: threading.Event) -> Thread:
        low, high = shares[which : which + 2]
        thread = Thread(salt, Log(0, bins))
        largest = int(np.diff(ends_of[first_run[low : high + 1]]).max(initial=0))
        for leaf in range(low, high):
            first, last = first_run[leaf : leaf + 2]
            if first == last:
                continue
            thread.begin(labels[ends_of[first] : ends_of[last]])
            own = np.ascontiguousarray(runs[first:last])
            thread.leaf(pool, own, largest)
            if stopped.is_set():
                break
            if progress is not None and which == 0:
                progress(0.5 + 0.5 * (leaf + 1) / high)
        return thread

    def index() -> Int:
        numbers = pool.reshape(-1)[: ends[-1] * RUN, None]  # the keys have done their service
        in_threads(parts, partial(scatter, into=numbers, numbered=True))
        inside: Int = numbers.reshape(-1, RUN)[taken][np.arange(RUN) < runs[:, 1:]].astype(np.int64)
        return inside

    done = in_threads(parts, pair)
    if sum(thread.repeated for thread in done) != sum(repeated for *_, repeated in scattered):
        done[0].overfull = True  # corners of one triangle have the same 40 bits
    return done, index


def in_threads(number: int, work: Callable[[int, threading.Event], Any]) -> list[Any]:
    """Return what `work` returns for 0, 1, … `number` − 1, each in a thread; of what they raise, the first."""
    results: list[Any] = [None] * number
    errors: list[BaseException | None] = [None] * number
    stopped = threading.Event()

    def one(which: int) -> None:
        try:
            results[which] = work(which, stopped)
        except BaseException as error:  # it is raised again where the others have ended
            errors[which] = error
            stopped.set()

    others = [threading.Thread(target=one, args=(which,)) for which in range(1, number)]
    for thread in others:
        thread.start()
    one(0)
    for thread in others:
        thread.join()
    try:
        for error in errors:
            if error is not None:
                raise error
    finally:
        errors.clear()  # which refer to what the threads have had in memory
        error = None
    return results


def sample(triangles: Triangles, number: int) -> NDArray[np.float32]:
    """Return corners (number, 3) of triangles from all over the file, a few of each block that is read."""
    blocks = range(0, triangles.count, _APART)
    corners = triangles.corners_f4 if isinstance(triangles, Facets) else triangles.corners
    with np.errstate(over="ignore", invalid="ignore"):
        some = np.concatenate([corners(at, at + _READ)[::_EVERY, 0].astype(np.float32) for at in blocks])
    return some[np.arange(number) * len(some) // number]


def tree(points: NDArray[np.float32], depth: int) -> tuple[Int, NDArray[np.float32], NDArray[np.float32]]:
    """Return axes and planes (2^depth,) that halve the points (k 2^depth, 3), and again their halves, along the widest.

    Node 0 comes first, and the nodes 2 k + 1 and 2 k + 2 below and above node k. The cells (2^depth, 6) of the leaves
    are their least and their greatest coordinates.
    """
    axes, planes = np.zeros(1 << depth, np.int64), np.zeros(1 << depth, np.float32)
    nodes, cells = points[None], np.array([[-np.inf] * 3 + [np.inf] * 3], np.float32)
    for level in range(depth):
        with np.errstate(over="ignore", invalid="ignore"):
            widest = np.ptp(nodes, axis=1).argmax(axis=1)
        along = np.take_along_axis(nodes, widest[:, None, None], axis=2)[:, :, 0]
        order = np.argsort(along, axis=1)
        half = along.shape[1] // 2
        here = slice((1 << level) - 1, (2 << level) - 1)
        axes[here], planes[here] = widest, np.take_along_axis(along, order[:, half : half + 1], axis=1)[:, 0]
        nodes = np.take_along_axis(nodes, order[:, :, None], axis=1).reshape(2 << level, half, 3)
        cells = np.repeat(cells, 2, axis=0)
        cells[np.arange(0, 2 << level, 2), 3 + widest] = cells[np.arange(1, 2 << level, 2), widest] = planes[here]
    return axes, planes, cells


def any_repeated(logs: list[Log], bins: int, parts: int) -> bool:
    """Say whether a key is in the logs twice."""
    table = np.array([(address(log.keys), log.room, address(log.sizes)) for log in logs])
    places = 1 << (4 * int(np.sum([log.sizes for log in logs], axis=0).max())).bit_length()
    cuts = np.linspace(0, bins, parts + 1).astype(np.int64).tolist()

    def repeated(which: int, _: threading.Event) -> bool:
        slots = np.empty(places, np.uint16)
        return REPEATED.function(address(table), len(logs), bins, *cuts[which : which + 2], address(slots), places) == 1

    return any(in_threads(parts, repeated))


def _in_file_order(labels: NDArray[np.int32], index: Int, components: int) -> NDArray[np.int32]:
    """Put the labels of triangles at the numbers that they have in the file, and number those by their first."""
    result = np.empty_like(labels)
    result[index] = labels
    first = np.empty(components + 1, np.int64)
    first[result[::-1]] = np.arange(len(result))[::-1]  # of several values for one place, the last stays
    number = np.empty(components + 1, np.int32)
    number[np.argsort(first[:components])] = np.arange(components)
    number[components] = -1
    return number[result]


def roots(parent: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the first of those that each is joined with, by the table of joined ones, (n,)."""
    while True:
        above = parent[parent]
        if np.array_equal(above, parent):
            return parent
        parent = above
