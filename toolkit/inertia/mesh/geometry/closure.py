"""Closure and connected components of a triangle surface.

A surface bounds a solid when its boundary chain is zero: every directed edge u→v is matched by an edge v→u. Edges are
paired group by group of triangles (`inertia.mesh.geometry.pairing`), in any order and on all processors. Triangles
whose edges were paired belong to one component. Where more than two triangles meet at an edge, the angles around it
tell which belong together, so that nothing depends on the order of the triangles: then the components with such edges,
or all triangles where these are many, are paired by the keys of their edges, and those at such edges by their
coordinates; where these are many, all edges are sorted. Whether there is such an edge, the keys of all edges that
groups may share tell (12 bytes a triangle, at most), as none may come twice. Vertices are equal when their stored
coordinates are (−0 equals +0), which must be finite.

The compiled pass knows a vertex by a 60-bit key: the upper halves of two sums of random 64-bit numbers, one of them
alone and one times each 32-bit word of its coordinates. Whatever two are given, their keys agree with a probability of
2⁻⁶⁰ (D. Lemire and O. Kaser, "Strongly universal string hashing is fast", The Computer Journal 57 (2014)). An edge it
knows by (r + a)(r + b) modulo the prime 2⁶¹ − 1, where a and b are the keys of its ends and r is random: for two edges
these are polynomials in r that agree at one value at most. As each process draws numbers of its own, which who made the
file cannot know, n vertices and e edges hold a collision with a probability of at most n²/2⁶¹ + e²/2⁶², which is 6e-5
at ten million triangles. A collision of closed edges shows as an edge of more than two triangles, for which the exact
pairing is made (`inertia.mesh.geometry.edges`); one of open edges can hide these two. Where triangles are grouped by
place, their edges are told apart by 40 bits of the keys of vertices: two edges of one vertex agree with a probability
of 2⁻⁴⁰, which shows in the same way, and corners of one triangle that agree show as their whole keys differ. Nothing
else depends on the numbers.
"""

from __future__ import annotations

import os
from dataclasses import field
from functools import cache, partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int, Progress
from inertia.mesh.geometry.corner_keys import FACES, FACETS, corner_keys
from inertia.mesh.geometry.edge_buckets import (
    CHUNK,
    MOST,
    REPEATED,
    SALTS,
    Sorter,
    Steps,
    bits_for,
    irregular_halves,
    steps_for,
)
from inertia.mesh.geometry.faces import merge_equal_vertices, repeated_corners
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.irregular_edges import Irregular, irregular_edges
from inertia.mesh.geometry.pairing import Doubtful, paired_edges
from inertia.mesh.geometry.pieces import pieces_of_surface
from inertia.mesh.surface import Facets, Triangles
from inertia.native import Kernel
from inertia.records import dataclass

SHARE = 8
"""How many times as many triangles as irregular directed edges there are where these are looked at alone."""


@dataclass(frozen=True, eq=False)
class Closure:
    """How the triangles of a surface hang together by their edges.

    Attributes
    ----------
    open_edges : directed edges without an opposite partner; 0 for a closed, consistently wound surface
    components : pieces of surface that hang together by their edges
    labels : (n,) int32, the component of each triangle, numbered as they appear in the file; −1 for one with
        a repeated corner
    repeated : triangles with a repeated corner (they have no area and take part in nothing)
    crowded : edges that more than two triangles share
    at_crowded : the triangles that have such edges, ascending; none also where these are too many to be looked at
    """

    open_edges: int
    components: int
    labels: NDArray[np.int32]
    repeated: int
    crowded: int
    at_crowded: Int = field(default_factory=lambda: np.empty(0, np.int64))

    @classmethod
    def simple(cls, count: int) -> Closure:
        """Return that of a closed surface of so many triangles in one piece."""
        return cls(0, 1, np.zeros(count, np.int32), 0, 0)


@cache
def process_salt() -> NDArray[np.uint64]:
    """Return the random numbers (15,) of this process."""
    return np.frombuffer(os.urandom(8 * SALTS), np.uint64)


def closure(triangles: Triangles, progress: Progress | None = None) -> Closure:
    """Pair the edges of a surface.

    >>> from inertia.mesh.part import Part
    >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> tetrahedron = closure(part.triangles)
    >>> tetrahedron.open_edges, tetrahedron.components
    (0, 1)
    """
    if _keys(triangles).worthwhile(triangles.count):
        return compiled_closure(triangles, progress)
    return vectorised_closure(triangles)


def _keys(triangles: Triangles) -> Kernel:
    return FACETS if isinstance(triangles, Facets) else FACES


def compiled_closure(
    triangles: Triangles, progress: Progress | None = None, salt: NDArray[np.uint64] | None = None
) -> Closure:
    """Return what `closure` does, by the compiled kernels; `salt` (15,) is this process's own unless given."""
    salt = process_salt() if salt is None else salt
    paired = paired_edges(triangles, salt, progress)
    if isinstance(paired, tuple):
        return Closure(*paired, crowded=0)
    known = paired_by_keys(triangles, salt, paired)
    return vectorised_closure(triangles) if known is None else known[0]


def paired_by_keys(
    triangles: Triangles, salt: NDArray[np.uint64] | None = None, doubtful: Doubtful | None = None
) -> tuple[Closure, Irregular] | None:
    """Return what `closure` does, and the edges that are not used once each way.

    None stands where these are many, and where there are no compiled kernels. `salt` (15,) is as in `compiled_closure`;
    where edges in doubt are known by it, only components that have them are looked at.
    """
    count, salt = triangles.count, process_salt() if salt is None else salt
    if count > MOST or not _keys(triangles).worthwhile(count):
        return None
    steps, room = steps_for(count, salt, corner_keys(triangles, salt.copy())), int(count / SHARE)
    which = None if doubtful is None else _in_doubt(triangles, doubtful, steps)
    if doubtful is None or which is None:
        parent = np.arange(count, dtype=np.uint32)
        halves = _joined(triangles, steps, parent, room)
    else:
        some = triangles.select(which)
        own = np.arange(len(which), dtype=np.uint32)
        halves = _joined(some, steps_for(len(which), salt, corner_keys(some, salt.copy())), own, room)
        parent = _firsts(doubtful.labels)
        parent[which] = np.append(which, REPEATED)[np.minimum(own, len(which))]
        halves = None if halves is None else 3 * which[halves // 3] + halves % 3
    if halves is None:
        return None
    repeated = int(np.count_nonzero(parent == REPEATED))
    irregular, joined = irregular_edges(triangles, halves, parent, steps)
    steps.join(parent, joined)
    edges, components, labels = irregular.edges, steps.number(parent), parent.view(np.int32)
    open_edges, crowded = int(np.abs(edges.forward - edges.backward).sum()), int(edges.non_manifold.sum())
    return Closure(open_edges, components, labels, repeated, crowded, edges.at_crowded), irregular


def _joined(triangles: Triangles, steps: Steps, parent: NDArray[np.uint32], room: int) -> Int | None:
    """Join triangles at regular edges; return the irregular directed edges, ascending, None where more than `room`."""
    count = triangles.count
    records, starts, repeated = Sorter(steps, count, bits_for(count)).run(triangles, 0, count, 0)
    parent[repeated] = REPEATED
    buckets = [[records[first:last]] for first, last in pairwise(starts)]
    halves, odd, _ = irregular_halves(len(buckets), buckets.__getitem__, steps, partial(steps.join, parent), room)
    return None if odd > len(halves) else np.sort(halves).astype(np.int64)


def _in_doubt(triangles: Triangles, doubtful: Doubtful, steps: Steps) -> Int | None:
    """Return the triangles of the components that have edges in doubt, ascending; None where they are most of all."""
    edges = doubtful.edges
    some, bits = np.zeros(1 << 16, bool), bits_for(triangles.count)
    some[edges >> np.uint64(48)] = True
    keys, counts = np.empty(3 * CHUNK, np.uint64), np.zeros(1 << bits, np.int64)
    within = np.zeros(int(doubtful.labels.max(initial=-1)) + 2, bool)  # the last is for those in none
    for start in range(0, triangles.count, CHUNK):
        stop = min(start + CHUNK, triangles.count)
        own = keys[: 3 * (stop - start)]
        steps.keys(triangles, start, stop, own, counts, bits)
        near = np.flatnonzero(some[own >> np.uint64(48)])
        users = near[np.isin(own[near] | np.uint64(1), edges)] // 3
        within[doubtful.labels[start + users]] = True
    which = np.flatnonzero(within[doubtful.labels])
    return which if SHARE * len(which) < triangles.count else None


def _firsts(labels: NDArray[np.int32]) -> NDArray[np.uint32]:
    """Return the first triangle of each one's component (n,), `REPEATED` of one in none."""
    firsts = np.full(int(labels.max(initial=-1)) + 2, REPEATED, np.uint32)
    firsts[labels[::-1]] = np.arange(len(labels), dtype=np.uint32)[::-1]
    firsts[-1] = REPEATED
    result: NDArray[np.uint32] = firsts[labels]
    return result


def vectorised_closure(triangles: Triangles) -> Closure:
    """Return what `closure` does, by sorting all edges."""
    vertices, faces = merge_equal_vertices(triangles)
    whole = np.flatnonzero(~repeated_corners(faces))
    labels = np.full(len(faces), -1, np.int32)
    if len(whole) == 0:
        return Closure(0, 0, labels, len(faces), 0)
    edges = half_edges(faces[whole])
    piece = pieces_of_surface(vertices, faces[whole], edges)
    first, number = np.unique(piece, return_inverse=True)
    labels[whole] = number
    open_edges, many = int(np.abs(edges.surplus).sum()), edges.uses > 2
    at_many = whole[many[edges.edge].reshape(-1, 3).any(axis=1)]
    return Closure(open_edges, len(first), labels, len(faces) - len(whole), int(many.sum()), at_many)
