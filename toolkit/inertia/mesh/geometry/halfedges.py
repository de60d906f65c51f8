"""Half-edges of a triangle mesh: three directed edges a triangle, and the undirected edges that they run along."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from inertia.arrays import Int
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class HalfEdges:
    """Directed edges: number 3 f + k runs from corner k of triangle f to the next corner.

    Attributes
    ----------
    tail, head : (3m,), vertex numbers
    edge : (3m,), number of the undirected edge
    """

    tail: Int
    head: Int
    edge: Int

    @cached_property
    def direction(self) -> Int:
        """1 where a directed edge runs from the lower vertex number to the higher, else −1; (3m,)."""
        return np.where(self.tail < self.head, 1, -1)

    @cached_property
    def uses(self) -> Int:
        """How many triangles have each edge, (e,)."""
        return np.bincount(self.edge)

    @cached_property
    def surplus(self) -> Int:
        """How much oftener each edge is used upwards than downwards, (e,); all zero on a closed surface."""
        up, down = (self.edge[self.direction == way] for way in (1, -1))
        return np.bincount(up, minlength=len(self.uses)) - np.bincount(down, minlength=len(self.uses))

    @cached_property
    def by_edge(self) -> Int:
        """The directed edges, those along one edge together, the first triangles first; (3m,)."""
        return np.argsort(self.edge, kind="stable")

    def neighbours(self) -> Int:
        """Return pairs of directed edges, (k, 2), that link all those along the same edge."""
        same = np.diff(self.edge[self.by_edge]) == 0
        return np.column_stack([self.by_edge[:-1][same], self.by_edge[1:][same]])


def half_edges(faces: Int) -> HalfEdges:
    """List the directed edges of faces (m, 3), none of which repeats a corner.

    >>> half_edges(np.array([[0, 1, 2], [2, 1, 3]])).surplus.tolist()
    [1, -1, 0, 1, -1]
    """
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    _, edge = np.unique(low * (high.max(initial=0) + 1) + high, return_inverse=True)
    return HalfEdges(tail, head, edge)
