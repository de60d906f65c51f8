"""Duplicate triangles, wound the same way or the opposite way, and fins without thickness.

Two triangles with the same corners make a pair; pairs that share an edge with one another only form a
region. What else has the edges around a region tells what it is. One triangle: the region is a part of one
surface that is there twice. Two triangles: two surfaces coincide there. Nothing: it is a sheet by itself.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Int
from inertia.mesh.geometry.faces import components
from inertia.mesh.geometry.halfedges import half_edges
from inertia.records import dataclass


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Pairs of triangles (k, 2), the earlier first, and for each the number of edges around its region.

    Of these `edges`, `one` have one other triangle (or three, ...) and `nothing` have no other.
    """

    triangles: Int
    edges: Int
    one: Int
    nothing: Int


def copies(faces: Int) -> Int:
    """Return the faces (m, 3) that repeat an earlier one, which stands before each, as (k, 2).

    Those that belong to a second surface are left out.

    >>> copies(np.array([[0, 1, 2], [1, 2, 0], [0, 2, 1]])).tolist()
    [[0, 1]]
    """
    pairs = _pairs(faces, opposite=False)
    two_surfaces = 2 * (pairs.edges - pairs.one - pairs.nothing) > pairs.edges
    return pairs.triangles[~two_surfaces]


def facing(faces: Int) -> tuple[Int, Int]:
    """Judge the pairs of faces with the same corners and opposite windings.

    Returns
    -------
    doubled : the later face of each pair in a part of a surface that is there twice
    fins : both faces of each pair in a sheet that ends in free edges; what is left is where bodies touch
    """
    pairs = _pairs(faces, opposite=True)
    doubled = 2 * pairs.one > pairs.edges
    fins = ~doubled & (pairs.nothing > 0)
    return np.unique(pairs.triangles[doubled, 1]), np.unique(pairs.triangles[fins])


def _pairs(faces: Int, *, opposite: bool) -> _Pairs:
    corners = np.sort(faces, axis=1)
    second = np.take_along_axis(faces, (np.argmin(faces, axis=1)[:, None] + 1) % 3, axis=1)[:, 0]
    order = np.lexsort((second, *corners.T))
    paired = (np.diff(corners[order], axis=0) == 0).all(axis=1) & ((np.diff(second[order]) != 0) == opposite)
    pairs = np.sort(np.column_stack([order[:-1][paired], order[1:][paired]]), axis=1)
    if len(pairs) == 0:
        empty = np.empty(0, np.int64)
        return _Pairs(pairs, empty, empty, empty)
    edge = half_edges(faces).edge.reshape(-1, 3)
    own = np.bincount(edge[np.unique(pairs)].ravel(), minlength=edge.max() + 1)
    sides = edge[pairs[:, 0]]
    others = (np.bincount(edge.ravel()) - own)[sides]
    region = components(_links(np.where(others == 0, sides, -1)), len(pairs))
    nothing = (others == 0) & (own[sides] == 2)
    edges, one, none = (
        np.bincount(region, which.sum(axis=1), len(pairs)).astype(np.int64)[region]
        for which in (nothing | (others > 0), others % 2 == 1, nothing)
    )
    return _Pairs(pairs, edges, one, none)


def _links(edge: Int) -> Int:
    """Return pairs of rows of (k, 3) that have an edge number in common; −1 links nothing."""
    order = np.argsort(edge.ravel(), kind="stable")
    order = order[edge.ravel()[order] >= 0]
    same = np.diff(edge.ravel()[order]) == 0
    return np.column_stack([order[:-1][same], order[1:][same]]) // 3
