"""Which of many pairs of bodies are sure to share space: places that lie inside both.

They are looked for in the boxes that two bodies have in common, and beneath triangles that cross."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.intersect import FACING
from inertia.mesh.geometry.near_triangles import COMPARED, near_triangles
from inertia.mesh.geometry.triangle_pairs import crossing, unit_normals
from inertia.mesh.geometry.winding import windings_each
from inertia.mesh.surface import Surface

_PLACES = 12, 84  # tried in each box, and then in those where none of these was inside both
_CROSSED = 8  # places of each pair of bodies at such crossings
_STEPS = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])
_CLEAR = 4.0  # times deeper than a contact
_SHALLOW = 1e-3  # of the smaller body: the deepest contact for which places are tried


def sure_to_share(
    corners: Float, sides: Sequence[tuple[Int, Int]], low: Float, high: Float, size: Float, depth: float
) -> Bool:
    """Say of which pairs of bodies a place is found that lies inside both, clearly deeper than a contact.

    Parameters
    ----------
    corners : (t, 3, 3), triangles of all bodies, closed and outward (cavities inward)
    sides : of each pair, numbers of the triangles of the one and of the other body that lines along z through the box
        that they have in common may meet
    low, high : (k, 3), that box
    size : (k,), the largest extent of the smaller body
    depth : of a contact; at least as much as 1e-6 of the size is taken

    >>> from inertia.mesh.cut import block
    >>> once = block([0, 0, 0], np.eye(3)).corners()
    >>> both = np.concatenate([once, once + [0.75, 0.5, 0.5]])
    >>> boxes = np.array([[0.75, 0.5, 0.5]]), np.array([[1.0, 1, 1]])
    >>> sure_to_share(both, [(np.arange(12), np.arange(12, 24))], *boxes, np.ones(1), 0.0).tolist()
    [True]
    """
    inner = np.maximum(1e-6 * size, depth) / size
    middle = low / 2 + high / 2
    sure = np.zeros(len(sides), bool)

    def open_ones() -> Int:
        return np.flatnonzero(~sure & (inner < _SHALLOW) & (high > low).all(axis=1))

    def look(tried: Int, points: Float) -> None:
        """Look at places (k, s, 3) from the middles of the boxes of pairs (k,) on, over their sizes."""
        margin = 2 * _CLEAR * float(inner[tried].max())
        inside = np.ones(points.shape[:2], bool)
        for side in range(2):
            numbers = [sides[k][side] for k in tried.tolist()]
            owner = np.repeat(np.arange(len(tried)), [len(own) for own in numbers])
            local = (corners[np.concatenate(numbers)] - middle[tried][owner, None]) / size[tried][owner, None, None]
            winding, clearance = windings_each(points, local, owner, margin)
            inside &= (winding > 0) & (clearance > _CLEAR * inner[tried, None])
        sure[tried] = inside.any(axis=1)

    first = 0
    for count in _PLACES:
        if first and len(tried := open_ones()):
            which, places = _under_crossings(
                corners, [sides[k] for k in tried.tolist()], 2 * _CLEAR * (inner * size)[tried]
            )
            tried = tried[which]
            if len(tried):
                look(tried, (places - middle[tried, None]) / size[tried, None, None])
        if len(tried := open_ones()):
            # Fractions of the box that repeat along no axis, the middle first (the R3 sequence of M. Roberts, 2018).
            fractions = (0.5 + np.arange(first, first + count)[:, None] * _STEPS) % 1
            look(tried, (fractions - 0.5) * ((high - low) / size[:, None])[tried, None])
        first += count
    return sure


def _under_crossings(corners: Float, sides: Sequence[tuple[Int, Int]], depth: Float) -> tuple[Int, Float]:
    """Return places under both of two triangles that cross, at a depth (k,) below each: of which pairs, and (m, s, 3).

    Where there are fewer than s, the first is repeated; pairs of bodies with many triangles are passed over.
    """
    few = [(one, other) if len(one) * len(other) <= COMPARED else (one[:0], other[:0]) for one, other in sides]
    owner, i, j = near_triangles(corners, few)
    vertices, faces = merge_equal_vertices(Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)))
    crossed, middles = crossing(vertices, faces[i], faces[j])
    owner, normals = owner[crossed], unit_normals(corners)
    inwards = -(normals[i[crossed]] + normals[j[crossed]])
    size = np.linalg.norm(inwards, axis=1)
    apart = size > FACING
    owner, inwards, size, middles = owner[apart], inwards[apart], size[apart], middles[apart]
    places = middles + (2 * depth[owner] / size**2)[:, None] * inwards
    which, start, count = np.unique(owner, return_index=True, return_counts=True)
    steps = np.arange(_CROSSED)
    return which, places[start[:, None] + np.where(steps < count[:, None], steps, 0)]
