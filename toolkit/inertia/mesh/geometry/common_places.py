"""Which of many pairs of bodies are sure to share space: places in the boxes that they have in common, inside both."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.geometry.winding import windings_each

_PLACES = 12, 84  # tried in each box, and then in those where none of these was inside both
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
    sure = np.zeros(len(sides), bool)
    first = 0
    for count in _PLACES:
        tried = np.flatnonzero(~sure & (inner < _SHALLOW) & (high > low).all(axis=1))
        if len(tried) == 0:
            break
        # Fractions of the box that repeat along no axis, the middle first (the R3 sequence of M. Roberts, 2018).
        fractions = (0.5 + np.arange(first, first + count)[:, None] * _STEPS) % 1
        middle = (low / 2 + high / 2)[tried]
        points = (fractions - 0.5) * ((high - low) / size[:, None])[tried, None]
        margin = 2 * _CLEAR * float(inner[tried].max())
        inside = np.ones(points.shape[:2], bool)
        for side in range(2):
            numbers = [sides[k][side] for k in tried.tolist()]
            owner = np.repeat(np.arange(len(tried)), [len(own) for own in numbers])
            local = (corners[np.concatenate(numbers)] - middle[owner, None]) / size[tried][owner, None, None]
            winding, clearance = windings_each(points, local, owner, margin)
            inside &= (winding > 0) & (clearance > _CLEAR * inner[tried, None])
        sure[tried] = inside.any(axis=1)
        first += count
    return sure
