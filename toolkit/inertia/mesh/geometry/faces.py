"""Faces over vertices: equal vertices merged, corners that repeat, and what hangs together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Int
from inertia.mesh.surface import Surface, Triangles


def merge_equal_vertices(triangles: Triangles) -> tuple[NDArray[np.float64], Int]:
    """Return the distinct vertices (n, 3) and the faces (m, 3) over them; equal means the same coordinates.

    Vertices are numbered in the order in which the triangles first use them. Nothing is moved or left out.
    """
    if type(triangles) is Surface and len(triangles.vertices) < 3 * triangles.count:  # few are the same, or unused
        points, corner = triangles.vertices + 0.0, triangles.faces.reshape(-1)
        first = np.full(len(points), len(corner))
        first[corner[::-1]] = np.arange(len(corner))[::-1]  # the last that is written stays
    else:
        points, corner, first = triangles.corners().reshape(-1, 3) + 0.0, None, None
    order = np.lexsort(points.T)
    ranked = points[order]
    leads = np.ones(len(ranked), bool)
    leads[1:] = (ranked[1:] != ranked[:-1]).any(axis=1)
    group = np.empty(len(points), np.int64)
    group[order] = np.cumsum(leads) - 1
    starts = np.flatnonzero(leads)
    uses = order if first is None else first[order]
    earliest = np.minimum.reduceat(uses, starts) if len(order) else order
    by_use = np.argsort(earliest)[: np.count_nonzero(earliest < 3 * triangles.count)]
    number = np.empty(len(earliest), np.int64)
    number[by_use] = np.arange(len(by_use))
    faces = number[group] if corner is None else number[group][corner]
    return ranked[starts[by_use]], faces.reshape(-1, 3)


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
