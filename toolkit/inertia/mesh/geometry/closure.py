"""Closure and connected components of a triangle surface, in one pass over its triangles.

A surface bounds a solid when its boundary chain is zero: every directed edge u→v is matched by an edge v→u.
Edges are paired as the triangles stream by; only those that still wait for their partner are kept, so a file
in any sensible order needs little memory. Triangles whose edges were paired belong to one component; where
more than two triangles meet at an edge, the first to come are paired first. Vertices are equal when their
stored coordinates are (−0 equals +0), which must be finite.

The compiled pass knows a vertex, and an edge, by a 64-bit hash. Two of n edges collide with a probability of
about n²/2⁶⁵ (6e-6 at ten million triangles); a collision can at worst report a closed surface as open, which
the exact pairing (`inertia.mesh.geometry.edges`) then corrects, or join two components.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Int, Progress
from inertia.mesh.part import Facets, Surface, Triangles
from inertia.native import Kernel

FACETS = Kernel("inertia.mesh.geometry.edge_kernel", "pair_facets", "piippipipp")
FACES = Kernel("inertia.mesh.geometry.edge_kernel", "pair_faces", "ppiiippipipp")
REHASH = Kernel("inertia.mesh.geometry.edge_kernel", "rehash", "ppippi")

_CHUNK = 4096  # triangles a call: keeps the table of a well-ordered file inside the cache
_RELEASE = 16 * _CHUNK


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
    """

    open_edges: int
    components: int
    labels: NDArray[np.int32]
    repeated: int


def closure(triangles: Triangles, progress: Progress | None = None) -> Closure:
    """Pair the edges of a surface.

    >>> from inertia.mesh.part import Part
    >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> tetrahedron = closure(part.triangles)
    >>> tetrahedron.open_edges, tetrahedron.components
    (0, 1)
    """
    kernel = FACETS if isinstance(triangles, Facets) else FACES
    if kernel.worthwhile(triangles.count):
        return compiled_closure(triangles, progress)
    return vectorised_closure(triangles)


def _address(array: NDArray[Any]) -> int:
    return int(array.ctypes.data)


def compiled_closure(triangles: Triangles, progress: Progress | None = None) -> Closure:
    """Return what `closure` does, by the compiled kernel."""
    count = triangles.count
    labels = np.empty(count, np.int32)
    state = np.zeros(3, np.int64)
    capacity = 8 * _CHUNK
    keys, values = np.zeros(capacity, np.uint64), np.empty(capacity, np.int64)
    parent = np.empty(16 * _CHUNK, np.int32)
    if isinstance(triangles, Surface):
        vertex_keys = _vertex_keys(triangles.vertices)
        faces = triangles.faces
    for start in range(0, count, _CHUNK):
        stop = min(start + _CHUNK, count)
        if 2 * (state[0] + 3 * _CHUNK) > capacity:
            larger = np.zeros(4 * capacity, np.uint64), np.empty(4 * capacity, np.int64)
            old = _address(keys), _address(values), capacity
            capacity *= 4
            REHASH.function(*old, _address(larger[0]), _address(larger[1]), capacity)
            keys, values = larger
        if state[1] + _CHUNK > len(parent):
            parent = np.concatenate([parent, np.empty_like(parent)])
        tables = (
            _address(keys), _address(values), capacity,
            _address(parent), len(parent), _address(labels), _address(state),
        )  # fmt: skip
        if isinstance(triangles, Facets):
            FACETS.function(_address(triangles.records), start, stop, *tables)
            if stop % _RELEASE == 0 or stop == count:
                triangles.release(max(0, stop - _RELEASE - _CHUNK), stop)
        else:
            FACES.function(_address(faces), _address(vertex_keys), len(vertex_keys), start, stop, *tables)
        if progress is not None and start % _RELEASE == 0:
            progress(stop / count)
    roots = _roots(parent[: state[1]])
    components, number = np.unique(roots, return_inverse=True)
    if len(components) > 1:
        labelled = labels >= 0
        labels[labelled] = number.astype(np.int32)[labels[labelled]]
    else:
        np.minimum(labels, 0, out=labels)
    return Closure(int(state[0]), len(components), labels, int(state[2]))


def _roots(parent: NDArray[np.int32]) -> NDArray[np.int32]:
    while True:
        above = parent[parent]
        if np.array_equal(above, parent):
            return parent
        parent = above


def _vertex_keys(vertices: NDArray[np.float64]) -> NDArray[np.uint64]:
    """Hash each vertex's coordinates to 64 bits (SplitMix64 over the three words, −0 as +0)."""
    bits = (vertices + 0.0).view(np.uint64)
    key = np.zeros(len(vertices), np.uint64)
    for axis in range(3):
        key *= np.uint64(0x9E3779B97F4A7C15)
        key += bits[:, axis]
        key ^= key >> np.uint64(29)
        key *= np.uint64(0xBF58476D1CE4E5B9)
        key ^= key >> np.uint64(32)
        key *= np.uint64(0x94D049BB133111EB)
        key ^= key >> np.uint64(31)
    return key


def merge_equal_vertices(triangles: Triangles) -> tuple[NDArray[np.float64], Int]:
    """Return the distinct vertices (n, 3) and the faces (m, 3) over them; equal means the same coordinates.

    Vertices are numbered in the order in which the triangles first use them. Nothing is moved or left out.
    """
    points = triangles.corners().reshape(-1, 3) + 0.0
    order = np.lexsort(points.T)
    ranked = points[order]
    first = np.ones(len(ranked), bool)
    first[1:] = (ranked[1:] != ranked[:-1]).any(axis=1)
    group = np.cumsum(first) - 1
    inverse = np.empty(len(points), np.int64)
    inverse[order] = group
    earliest = np.minimum.reduceat(order, np.flatnonzero(first)) if len(order) else order
    by_use = np.argsort(earliest)
    number = np.empty_like(by_use)
    number[by_use] = np.arange(len(by_use))
    return points[earliest[by_use]], number[inverse].reshape(-1, 3)


def repeated_corners(faces: Int) -> Bool:
    """Say which faces (m, 3) name a vertex twice."""
    a, b, c = faces.T
    repeated: Bool = (a == b) | (b == c) | (c == a)
    return repeated


def components(pairs: Int, count: int) -> Int:
    """Return for each of `count` nodes the smallest node that the edges `pairs` (k, 2) connect it with.

    Labels fall to the minimum over every edge and then to their label's label, until nothing changes.
    """
    label = np.arange(count)
    if len(pairs) == 0:
        return label
    a, b = pairs.T
    while True:
        low = np.minimum(label[a], label[b])
        moved = label.copy()
        for end in (label[a], label[b], a, b):
            np.minimum.at(moved, end, low)
        moved = moved[moved]
        if np.array_equal(moved, label):
            return label
        label = moved


def vectorised_closure(triangles: Triangles) -> Closure:
    """Return what `closure` does, by sorting all edges."""
    _, faces = merge_equal_vertices(triangles)
    count = len(faces)
    repeated = repeated_corners(faces)
    owner = np.flatnonzero(~repeated)
    tail, head = faces[owner].ravel(), np.roll(faces[owner], -1, axis=1).ravel()
    forward = tail < head
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.lexsort((forward, high, low))
    low, high, forward, owner = low[order], high[order], forward[order], np.repeat(owner, 3)[order]
    first = np.ones(len(low), bool)
    first[1:] = (low[1:] != low[:-1]) | (high[1:] != high[:-1])
    starts = np.flatnonzero(first)
    uses = np.diff(np.append(starts, len(low)))
    ahead = np.add.reduceat(forward, starts, dtype=np.int64) if len(starts) else uses
    behind = uses - ahead
    # First come, first served, as in the compiled pass: an edge's k-th use one way meets the k-th the other.
    pairs = np.minimum(ahead, behind)
    turn = np.arange(pairs.sum()) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    one = np.repeat(starts, pairs) + turn
    other = one + np.repeat(behind, pairs)
    label = components(np.column_stack([owner[one], owner[other]]), count)
    label[repeated] = -1
    roots, number = np.unique(label, return_inverse=True)
    shift = 1 if repeated.any() else 0
    labels = (number - shift).astype(np.int32)
    return Closure(int(np.abs(ahead - behind).sum()), len(roots) - shift, labels, int(repeated.sum()))
