"""Triangles that lie on a neighbour, as the two sides of a sheet do, or copies: a shell counts their area twice."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float
from inertia.mesh.checks.findings import around, counted, middle
from inertia.mesh.geometry.faces import merge_equal_vertices, repeated_corners
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.intersect import EXAMINED
from inertia.mesh.geometry.triangle_pairs import unit
from inertia.mesh.surface import Triangles

_TOGETHER = 8  # triangles at an edge that are compared
_FOLDED = 1e-6  # rad between two triangles that lie on one another
_FLAT = 1e-5  # height of a triangle over its side, more than six digits of a coordinate can make of none


def doubled_faces(triangles: Triangles) -> str | None:
    """Say where triangles lie on one another and share an edge there, whichever way they are wound.

    None where none do, or where there are too many triangles to look. Coordinates must be finite.

    >>> from inertia.mesh.surface import Surface
    >>> square = Surface([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], [[0, 1, 2], [0, 2, 3], [3, 2, 1]])
    >>> doubled_faces(square)
    'triangles lie on one another at 2 edges, the first being triangles 0 and 2 around (2.0, 1.0, 0.0)'
    """
    if triangles.count > EXAMINED:
        return None
    vertices, faces = merge_equal_vertices(triangles)
    distinct = np.flatnonzero(~repeated_corners(faces))
    faces = faces[distinct]
    edges = half_edges(faces)
    order, third = edges.by_edge, np.roll(faces, 1, axis=1).ravel()
    folded = []
    for step in range(1, min(int(edges.uses.max(initial=0)), _TOGETHER)):
        one, other = order[:-step], order[step:]
        same = edges.edge[one] == edges.edge[other]
        one, other = one[same], other[same]
        corners = (vertices[each] for each in (edges.tail[one], edges.head[one], third[one], third[other]))
        which = np.flatnonzero(_folded(*corners))
        folded.append(np.column_stack([one, other])[which])
    pairs = np.concatenate([np.empty((0, 2), np.int64), *folded])
    if not len(pairs):
        return None
    first, second = pairs[np.lexsort(pairs.T[::-1])[0]]
    ends = vertices[[edges.tail[first], edges.head[first]]]
    box = np.stack([vertices.min(axis=0), vertices.max(axis=0)])
    count = counted(len(np.unique(edges.edge[pairs[:, 0]])), "edge")
    return (
        f"triangles lie on one another at {count}, the first being triangles {distinct[first // 3]} and "
        f"{distinct[second // 3]} {around(middle(ends), box)}"
    )


def _folded(tail: Float, head: Float, one: Float, other: Float) -> Bool:
    """Say which triangles over edges (k, 3) from tails to heads, with third corners `one` and `other`, are folded.

    Slivers, as at T-vertices, lie where the rounding of their corners has them.
    """
    along, a, b = head - tail, one - tail, other - tail
    square = _dot(along, along)
    on_one_side = _dot(a, b) * square > _dot(a, along) * _dot(b, along)  # which few are
    which = np.flatnonzero(on_one_side)
    along = unit(along[which])
    thirds = a[which], b[which]
    across = [third - _dot(third, along)[:, None] * along for third in thirds]
    near = np.linalg.norm(unit(across[0]) - unit(across[1]), axis=1) < _FOLDED
    for third, height in zip(thirds, across, strict=True):
        near &= np.linalg.norm(height, axis=1) > _FLAT * np.linalg.norm(third, axis=1)
    on_one_side[which] = near
    return on_one_side


def _dot(a: Float, b: Float) -> Float:
    result: Float = np.einsum("kx,kx->k", a, b)
    return result
