"""Faces over vertices: equal vertices merged, corners that repeat, and what hangs together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Int
from inertia.mesh.surface import Triangles


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
