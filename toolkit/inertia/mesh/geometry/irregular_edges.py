"""Edges that are not used once each way, looked at by their coordinates, exactly, with the triangles that have them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.edge_buckets import CHUNK, Steps, roots_of
from inertia.mesh.geometry.edges import Edges
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.pieces import links_turned, sharing
from inertia.mesh.geometry.senses import senses_of
from inertia.mesh.surface import Surface, Triangles
from inertia.records import dataclass


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

    @classmethod
    def none(cls, triangles: Triangles) -> Irregular:
        """Return those of a surface that has none."""
        no, two, three = (np.empty(shape, np.int64) for shape in ((0,), (0, 2), (0, 3)))
        return cls(triangles.select(no), no, np.empty((0, 3)), three, Edges(two, no, no, no))


@dataclass(frozen=True, eq=False)
class TooMany:
    """Irregular edges that are more than the memory lets be looked at.

    Attributes
    ----------
    triangle : the first that has one
    once, same_way, crowded : edges of one triangle; of two that run the same way; of more
    halves : directed edges along them
    """

    triangle: int
    once: int
    same_way: int
    crowded: int
    halves: int


def irregular_edges(
    triangles: Triangles, halves: Int, parent: NDArray[np.uint32], steps: Steps, *, turning: bool = True
) -> tuple[Irregular, Int]:
    """Pair irregular directed edges by their coordinates; return those that are, and the triangles (k, 2) they join.

    Parameters
    ----------
    halves : their numbers, ascending, 3 × triangle + side; regular ones whose keys collided may be among them
    parent, steps : what the regular edges have joined, and how
    turning : whether to find out which bodies are inside out (48 bytes a triangle), to pair them as when turned
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
        if turning:
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
    hashes, some = _mixed(vertices), np.zeros(1 << 16, bool)
    order = np.argsort(hashes, kind="stable")
    ranked = hashes[order]
    some[_mixed(vertices[:, :1]) >> np.uint64(48)] = True

    def found(points: NDArray[Any]) -> tuple[Int, Int]:
        """Return which of some points (..., 3) are at vertices, and at which."""
        near = np.flatnonzero(some[_mixed(points[..., :1].reshape(-1, 1) + 0.0) >> np.uint64(48)])
        own = points[np.unravel_index(near, points.shape[:-1])] + 0.0
        mixed = _mixed(own)
        rank = np.minimum(np.searchsorted(ranked, mixed), len(ranked) - 1)
        same = (vertices[order[rank]] == own).all(axis=1)
        return near[same], order[rank[same]]

    if isinstance(triangles, Surface):
        number = np.full(len(triangles.vertices), -1)
        own, at = found(triangles.vertices)
        number[own] = at
    for start in range(0, triangles.count, CHUNK):
        if isinstance(triangles, Surface):
            corners = number[triangles.block(start, start + CHUNK).reshape(-1)]
            which = np.flatnonzero(corners >= 0)
            vertex = corners[which]
        else:
            which, vertex = found(triangles.corners_f4(start, start + CHUNK))
        np.minimum.at(first, vertex, 3 * start + which)
    return first


def _mixed(points: NDArray[Any]) -> NDArray[np.uint64]:
    """Return a number for each point (k, m) that is the same for the same coordinates, and seldom for others."""
    mixed = np.zeros(len(points), np.uint64)
    for bits in points.astype(np.float64, copy=False).view(np.uint64).T:
        mixed = (mixed ^ bits) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    return mixed * np.uint64(0xBF58476D1CE4E5B9)
