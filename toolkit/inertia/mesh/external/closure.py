"""Closure and components of a surface in bounded memory: its edges partitioned by their keys, paired bucket by bucket.

A closed surface is paired by place, which is cheaper (`inertia.mesh.geometry.leaves`). Of any other, and where the
memory is short, the directed edges become records in buckets (see `inertia.mesh.external.buckets`), here or by the
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
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int, Progress
from inertia.errors import UsageError
from inertia.mesh.external.buckets import (
    BUCKET,
    CHUNK,
    REPEATED,
    SALTS,
    Runs,
    Sorter,
    Steps,
    roots_of,
    steps_for,
)
from inertia.mesh.external.memory import in_bytes
from inertia.mesh.external.temporary_file import MEMORY, TemporaryFile
from inertia.mesh.geometry.closure import Closure, links_turned, merge_equal_vertices, sharing
from inertia.mesh.geometry.edges import Edges
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.leaves import BY_PLACE, ROW, RUN, Limits, paired_by_place
from inertia.mesh.geometry.senses import senses_of
from inertia.mesh.surface import Facets, Triangles
from inertia.native import threads

MOST = 2**32 // 3 - 1
"""Triangles whose directed edges can be numbered in 32 bits."""

_LEAST = 1 << 24  # bytes beside the array of triangles, at least
_EXACTLY = 4096  # bytes that a directed edge takes when it is looked at exactly, with its triangle


_LEAF = 1 << 16  # triangles of a leaf, about
_SAMPLED = 64  # triangles a leaf that its planes are from
_FIXED = 32_000_000  # bytes for each thread's tables, and for a leaf that it reads
_FEWEST = 1 << 20  # triangles in memory, for which pairing by place repays its start
_TURNING = 48  # bytes a triangle that it takes to find out what is inside out
_WAITING = 2  # bytes a triangle that the edges between leaves may take


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
    state : as of the steps
    repeated : (i,), triangles with a repeated corner
    """

    pairs: NDArray[np.uint32]
    irregular: NDArray[np.uint32]
    left_out: int
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
            return Pairing(closed, _exactly(triangles, nothing, np.empty(0, np.uint32), steps_for(0, salt), 0)[0], None)
    steps = steps_for(count, salt)
    parent = np.arange(count, dtype=np.uint32)
    left = room - 4 * count
    most = max(BUCKET, left // 2 // _EXACTLY)
    if workers is None:
        with ExitStack() as stack:
            runs = Runs(count, left, _LEAST // 2, stack)
            repeated = _partition(triangles, runs, steps, parent, _part_of(progress, 0.0, 0.5))
            halves, odd = _pair(runs, steps, parent, most, _part_of(progress, 0.5, 1.0))
    else:
        repeated, odd, halves = 0, 0, np.empty(most, np.uint32)
        for paired in workers.pair(salt, most, _part_of(progress, 0.0, 1.0)):
            steps.join(parent, paired.pairs)
            parent[paired.repeated] = REPEATED
            repeated += len(paired.repeated)
            steps.state += paired.state
            some = paired.irregular[: max(most - odd, 0)]
            halves[odd : odd + len(some)] = some
            odd += len(paired.irregular) + paired.left_out
    irregular, (open_edges, crowded, _) = None, steps.state.tolist()
    if odd <= len(halves):
        irregular, joined = _exactly(triangles, np.sort(halves[:odd]).astype(np.int64), parent, steps, left)
        steps.join(parent, joined)
        uses, surplus = irregular.edges.uses, irregular.edges.forward - irregular.edges.backward
        crowded, open_edges = int((uses > 2).sum()), int(np.abs(surplus).sum())
    components = steps.number(parent)
    labels = parent.view(np.int32)
    first = int(halves[:odd].min()) // 3 if odd else None
    return Pairing(Closure(open_edges, components, labels, repeated, crowded), irregular, first)


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
    file = TemporaryFile(max(ROW * (count - rows), 0), stack)
    limits = Limits(rows, 4 * _LEAF // RUN, (1 << 24) + _WAITING * count // parts, file)
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


def _pair(
    runs: Runs, steps: Steps, parent: NDArray[np.uint32], room: int, progress: Progress
) -> tuple[NDArray[np.uint32], int]:
    """Join triangles at regular edges; return the irregular directed edges, `room` at most, and how many there are."""
    halves, odd = np.empty(room, np.uint32), 0
    buffer = np.empty((2 * BUCKET, 3), np.uint32)
    for number in range(runs.buckets):
        pairs, irregular = steps.pairs(lambda: runs.bucket(number, buffer))  # noqa: B023  # it is used at once
        steps.join(parent, pairs)
        if irregular:
            for records in runs.bucket(number, buffer):
                odd = steps.irregular(records, halves, odd)
        progress((number + 1) / runs.buckets)
    return halves, odd


def _exactly(
    triangles: Triangles, halves: Int, parent: NDArray[np.uint32], steps: Steps, room: int
) -> tuple[Irregular, Int]:
    """Pair irregular directed edges by their coordinates; return those that are, and the triangles that they join.

    Bodies that are inside out are paired as when turned where there is room, in bytes, to find out which are.
    """
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
        piece = roots_of(parent, numbers).astype(np.int64)
        turned = np.zeros(len(faces), bool)
        if room >= _TURNING * triangles.count:
            shared, whole = numbers[sharing(directed)], parent.copy()
            steps.join(whole, np.concatenate([joined, shared]))
            pieces = steps.number(whole)
            turned = senses_of(triangles, whole.view(np.int32), pieces, np.unique(whole[shared]))[whole[numbers]] < 0
        more = links_turned(vertices, faces, directed, np.unique(piece, return_inverse=True)[1], turned)
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
    for start in range(0, triangles.count, CHUNK):
        corners = triangles.corners(start, start + CHUNK).reshape(-1, 3) + 0.0
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
