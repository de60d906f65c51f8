"""Closure and components of a surface in bounded memory: its edges partitioned by their keys, paired bucket by bucket.

A closed surface is paired by place, which is cheaper (`inertia.mesh.geometry.leaves`). Of any other, and where the
memory is short, the directed edges become records in buckets (see `inertia.mesh.geometry.edge_buckets`), here or by the
workers of a Dask scheduler. Triangles at an edge that is used once each way belong together: they are joined in one
array of 4 bytes a triangle. All other edges are irregular, and looked at again by their coordinates, exactly.
(J. S. Vitter, "Algorithms and data structures for external memory", Foundations and Trends in Theoretical Computer
Science 2 (2008), section 5; G. Graefe, "Query evaluation techniques", ACM Computing Surveys 25 (1993), section 3.)

Keys are those of `inertia.mesh.geometry.closure`: two edges have the same with a probability of about 2⁻⁶³. Where that
happens to a regular edge, it is irregular, and so looked at. Only two edges of one triangle each can be taken for a
pair, so that a surface with a hole, which has three of them or more, looks closed with a probability below 2⁻⁶³,
whatever its size.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int, Progress
from inertia.errors import UsageError
from inertia.mesh.external.memory import in_bytes
from inertia.mesh.external.runs import Runs
from inertia.mesh.external.temporary_file import MEMORY, TemporaryFile
from inertia.mesh.geometry.closure import Closure
from inertia.mesh.geometry.edge_buckets import BUCKET, MOST, REPEATED, SALTS, Sorter, Steps, irregular_halves, steps_for
from inertia.mesh.geometry.irregular_edges import Irregular, TooMany, irregular_edges
from inertia.mesh.geometry.leaves import BY_PLACE, ROW, RUN, Limits, paired_by_place, stored_at_most
from inertia.mesh.surface import Facets, Triangles
from inertia.native import threads
from inertia.records import dataclass

_LEAST = 1 << 24  # bytes beside the array of triangles, at least
_EXACTLY = 4096  # bytes that a directed edge takes when it is looked at exactly, with its triangle


_LEAF = 1 << 14  # triangles of a leaf, about
_LARGEST = 1 << 18  # triangles of a leaf, at most
_SAMPLED = 16  # triangles a leaf that its planes are from
_FIXED = 32_000_000  # bytes for each thread's tables, and for a leaf that it reads
_FEWEST = 1 << 20  # triangles in memory, for which pairing by place repays its start
_TURNING = 48  # bytes a triangle that it takes to find out what is inside out
_WAITING = 2  # bytes a triangle that the edges between leaves may take


@dataclass(frozen=True, eq=False)
class Pairing:
    """What `external_closure` returns.

    Attributes
    ----------
    closure : as `inertia.mesh.geometry.closure.closure` returns it
    irregular : edges that are not used once each way; where there are more than can be looked at, edges of more than
        two triangles join none in the closure
    """

    closure: Closure
    irregular: Irregular | TooMany


def room_for(count: int) -> int:
    """Return the least number of bytes in which `external_closure` works."""
    return 4 * count + _LEAST


def room_to_look(count: int, halves: int) -> int:
    """Return the number of bytes in which it looks at so many irregular directed edges."""
    return max(room_for(count), 4 * count + 2 * _EXACTLY * (halves + 1))


class Workers(Protocol):
    """Other processes that pair the edges; see `inertia.mesh.external.shuffle`."""

    def pair(self, salt: NDArray[np.uint64], room: int, progress: Progress) -> Iterator[Paired]:
        """Yield what they have, bucket by bucket, each with no more than `room` irregular directed edges."""


@dataclass(frozen=True, eq=False)
class Paired:
    """Edges that workers have paired.

    Attributes
    ----------
    pairs : (k, 2), triangles at regular edges
    irregular : (j,), directed edges along irregular ones
    left_out : how many of these are not among them
    first : of all of these; 3 × MOST where there are none
    state : as of the steps
    repeated : (i,), triangles with a repeated corner
    """

    pairs: NDArray[np.uint32]
    irregular: NDArray[np.uint32]
    left_out: int
    first: int
    state: Int
    repeated: Int


def external_closure(
    triangles: Triangles,
    room: int,
    progress: Progress | None = None,
    salt: NDArray[np.uint64] | None = None,
    workers: Workers | None = None,
) -> Pairing:
    """Pair the edges of a surface with finite coordinates as `closure` does, within `room` bytes.

    Where there are workers, they pair the edges, and no file is written here.

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
    salt = np.frombuffer(os.urandom(8 * SALTS), np.uint64) if salt is None else salt
    if workers is None:
        with ExitStack() as stack:
            closed = closed_by_place(triangles, room, salt, stack, _part_of(progress, 0.0, 1.0))
        if closed is not None:
            nothing = np.empty(0, np.int64)
            none = irregular_edges(triangles, nothing, np.empty(0, np.uint32), steps_for(0, salt), turning=False)[0]
            return Pairing(closed, none)
    steps = steps_for(count, salt)
    parent = np.arange(count, dtype=np.uint32)
    left = room - 4 * count
    most = max(BUCKET, left // 2 // _EXACTLY)
    if workers is None:
        with ExitStack() as stack:
            runs = Runs(count, left, _LEAST // 2, stack)
            repeated = _partition(triangles, runs, steps, parent, _part_of(progress, 0.0, 0.5))
            records = partial(runs.bucket, buffer=np.empty((2 * BUCKET, 3), np.uint32))
            join, pairing = partial(steps.join, parent), _part_of(progress, 0.5, 1.0)
            halves, odd, first = irregular_halves(runs.buckets, records, steps, join, most, pairing)
    else:
        repeated, odd, first, halves = 0, 0, 3 * count, np.empty(most, np.uint32)
        for paired in workers.pair(salt, most, _part_of(progress, 0.0, 1.0)):
            steps.join(parent, paired.pairs)
            parent[paired.repeated] = REPEATED
            repeated += len(paired.repeated)
            steps.state += paired.state
            some = paired.irregular[: max(most - odd, 0)]
            halves[odd : odd + len(some)] = some
            odd += len(paired.irregular) + paired.left_out
            first = min(first, paired.first)
        halves = halves[: min(odd, most)]
    open_edges, crowded, edges, once = steps.state.tolist()
    irregular: Irregular | TooMany = TooMany(first // 3, once, edges - crowded - once, crowded, odd)
    at_crowded = np.empty(0, np.int64)
    if odd <= len(halves):
        which, turning = np.sort(halves).astype(np.int64), left >= _TURNING * count
        irregular, joined = irregular_edges(triangles, which, parent, steps, turning=turning)
        steps.join(parent, joined)
        uses, surplus = irregular.edges.uses, irregular.edges.forward - irregular.edges.backward
        crowded, open_edges, at_crowded = int((uses > 2).sum()), int(np.abs(surplus).sum()), irregular.edges.at_crowded
    components, labels = steps.number(parent), parent.view(np.int32)
    return Pairing(Closure(open_edges, components, labels, repeated, crowded, at_crowded), irregular)


def closed_by_place(
    triangles: Triangles, room: int, salt: NDArray[np.uint64], stack: ExitStack, progress: Progress
) -> Closure | None:
    """Return what `closure` does for a surface with two triangles at each edge, within `room` bytes; None for others.

    None stands also where there is too little room, and where there are no compiled kernels. A temporary file is in
    the folder that `stack` removes.
    """
    count, parts = triangles.count, max(1, min(threads(), room // (4 * _FIXED + 1)))
    fixed = parts * _FIXED + (0 if isinstance(triangles, Facets) else 8 * len(triangles.vertices))
    rows = min((room - fixed - _WAITING * count) // (ROW + 1), (room - fixed - 4 * count) // 8)
    if rows < min(count, _FEWEST) or not all(kernel.worthwhile(count) for kernel in BY_PLACE):
        return None
    file = TemporaryFile(stored_at_most(count, _LEAF, rows, parts), stack)
    limits = Limits(rows, _LARGEST // RUN, (1 << 24) + _WAITING * count // parts, file)
    paired = paired_by_place(triangles, _LEAF, _SAMPLED, parts, salt, progress, limits)
    return None if paired is None else Closure(*paired, crowded=0)


def _partition(triangles: Triangles, runs: Runs, steps: Steps, parent: NDArray[np.uint32], progress: Progress) -> int:
    """Write the edges of all triangles into runs; return how many triangles have a repeated corner."""
    sorter, repeated = Sorter(steps, runs.length, runs.bits), 0
    for first in range(0, triangles.count, runs.length):
        last = min(first + runs.length, triangles.count)
        records, starts, points = sorter.run(triangles, first, last, first)
        runs.add(records, starts)
        parent[points] = REPEATED
        repeated += len(points)
        progress(last / triangles.count)
    return repeated


def _part_of(progress: Progress | None, start: float, stop: float) -> Progress:
    return lambda done: None if progress is None else progress(start + done * (stop - start))
