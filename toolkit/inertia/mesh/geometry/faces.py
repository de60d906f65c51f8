"""Faces over vertices: equal vertices merged, corners that repeat, and what hangs together."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.surface import Surface, Triangles
from inertia.native import Kernel, place

_NUMBER = Kernel("inertia.mesh.geometry.vertex_kernel", "number_vertices", "pipii" + "ppippp")
_AHEAD = 32  # as the kernel has it
_MOST = 2**31 - 1  # points, whose numbers it has in 32 bits


def merge_equal_vertices(triangles: Triangles) -> tuple[Float, Int]:
    """Return the distinct vertices (n, 3) and the faces (m, 3) over them; equal means the same coordinates.

    Vertices are numbered in the order in which the triangles first use them. Nothing is moved or left out.
    """
    if type(triangles) is Surface and len(triangles.vertices) < 3 * triangles.count:  # few are the same, or unused
        points, corner = triangles.vertices, triangles.faces.reshape(-1)
    else:
        points, corner = triangles.corners().reshape(-1, 3), None
    places, numbers = _compiled_numbers(points, corner) or _sorted_numbers(points, corner)
    return points[places] + 0.0, numbers.reshape(-1, 3)  # −0 becomes +0


def _compiled_numbers(points: Float, corner: Int | None) -> tuple[Int, Int] | None:
    """Return what `_sorted_numbers` does, by a kernel; None where that does not pay, or equal points cannot be told."""
    count = len(points) if corner is None else len(corner)
    if not _NUMBER.worthwhile(count) or len(points) > _MOST or not np.isfinite(points).all():
        return None
    bits = (2 * min(count, len(points))).bit_length()
    ids = np.full(0 if corner is None else len(points), -1, np.int32)
    slots, ahead, numbers = np.full(1 << bits, -1, np.int32), np.empty(_AHEAD, np.int64), np.empty(count, np.int64)
    places = np.empty(len(points), np.int64)
    tables = [np.ascontiguousarray(table) for table in (points, numbers if corner is None else corner)]
    different = _NUMBER.function(
        place(tables[0]), len(points), place(tables[1]), count, corner is not None, place(ids), place(slots), bits,
        place(ahead), place(numbers), place(places),
    )  # fmt: skip
    return None if different < 0 else (places[:different].copy(), numbers)


def _sorted_numbers(points: Float, corner: Int | None) -> tuple[Int, Int]:
    """Return one point each that corners have, in the order in which they do, and the number of that of each corner.

    `corner` (k,) are the points of the corners; None where these are all points in turn.
    """
    points, first = points + 0.0, np.arange(len(points))
    if corner is not None:
        first = np.full(len(points), len(corner))
        first[corner[::-1]] = np.arange(len(corner))[::-1]  # the last that is written stays
    order = np.lexsort(points.T)
    ranked = points[order]
    leads = np.ones(len(ranked), bool)
    leads[1:] = (ranked[1:] != ranked[:-1]).any(axis=1)
    group = np.empty(len(points), np.int64)
    group[order] = np.cumsum(leads) - 1
    starts = np.flatnonzero(leads)
    earliest = np.minimum.reduceat(first[order], starts) if len(order) else order
    by_use = np.argsort(earliest)
    by_use = by_use[: np.count_nonzero(earliest < len(first if corner is None else corner))]
    number = np.empty(len(earliest), np.int64)
    number[by_use] = np.arange(len(by_use))
    return order[starts[by_use]], number[group] if corner is None else number[group][corner]


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
