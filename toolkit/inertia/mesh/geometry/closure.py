"""Closure and connected components of a triangle surface.

A surface bounds a solid when its boundary chain is zero: every directed edge u→v is matched by an edge v→u.
Edges are paired group by group of triangles (`inertia.mesh.geometry.pairing`), in any order and on all processors.
Triangles whose edges were paired belong to one component. Where more than two triangles meet at an edge, the angles
around it tell which belong together, so that nothing depends on the order of the triangles: then all edges are sorted.
Whether there is such an edge, the keys of all edges that groups may share tell (12 bytes a triangle, at most), as none
may come twice. Vertices are equal when their stored coordinates are (−0 equals +0), which must be finite.

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
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int, Progress
from inertia.mesh.geometry.corner_keys import FACES, FACETS
from inertia.mesh.geometry.edge_fans import links
from inertia.mesh.geometry.halfedges import HalfEdges, half_edges
from inertia.mesh.geometry.pairing import paired_edges
from inertia.mesh.geometry.senses import senses_of
from inertia.mesh.surface import Facets, Surface, Triangles

_SALTS = 15  # seven and seven for a vertex, one for the edges: see `edge_kernel`


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
    """

    open_edges: int
    components: int
    labels: NDArray[np.int32]
    repeated: int
    crowded: int

    @classmethod
    def simple(cls, count: int) -> Closure:
        """Return that of a closed surface of so many triangles in one piece."""
        return cls(0, 1, np.zeros(count, np.int32), 0, 0)


@cache
def process_salt() -> NDArray[np.uint64]:
    """Return the random numbers (15,) of this process."""
    return np.frombuffer(os.urandom(8 * _SALTS), np.uint64)


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


def compiled_closure(
    triangles: Triangles, progress: Progress | None = None, salt: NDArray[np.uint64] | None = None
) -> Closure:
    """Return what `closure` does, by the compiled kernels; `salt` (15,) is this process's own unless given."""
    paired = paired_edges(triangles, process_salt() if salt is None else salt, progress)
    return vectorised_closure(triangles) if paired is None else Closure(*paired, crowded=0)


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


def pieces_of_surface(vertices: Float, faces: Int, edges: HalfEdges) -> Int:
    """Return for each face (m, 3) the first of those that it hangs together with by paired edges.

    Edges of two triangles that run opposite ways are paired; those of more as `inertia.mesh.geometry.edge_fans` says,
    of bodies that are inside out as when they are turned.
    """
    two = (edges.uses == 2) & (edges.surplus == 0)
    pairs = edges.by_edge[two[edges.edge[edges.by_edge]]].reshape(-1, 2) // 3
    piece = components(pairs, len(faces))
    if (edges.uses > 2).any():
        shared = sharing(edges)
        whole, labels = np.unique(components(np.concatenate([pairs, shared]), len(faces)), return_inverse=True)
        asked = np.unique(labels[shared])
        sense = senses_of(Surface(vertices, faces), labels.astype(np.int32), len(whole), asked)
        more = links_turned(vertices, faces, edges, piece, sense[labels] < 0)
        piece = components(np.concatenate([pairs, more]), len(faces))
    return piece


def sharing(edges: HalfEdges) -> Int:
    """Return pairs of triangles (k, 2) that link all that have an edge in common which more than two have."""
    member = edges.by_edge[(edges.uses > 2)[edges.edge[edges.by_edge]]]
    same = np.diff(edges.edge[member]) == 0
    return np.column_stack([member[:-1][same], member[1:][same]]) // 3


def links_turned(vertices: Float, faces: Int, edges: HalfEdges, piece: Int, turned: Bool) -> Int:
    """Return what `links` does where faces (m,) are turned, with all that have edges in common with them."""
    if turned.any():
        faces = np.where(turned[:, None], faces[:, ::-1], faces)
        edges = half_edges(faces)
    return links(vertices, faces, edges, piece)


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
    open_edges, many = int(np.abs(edges.surplus).sum()), int((edges.uses > 2).sum())
    return Closure(open_edges, len(first), labels, len(faces) - len(whole), many)
