"""Planes between bodies that touch: how deep each of many pairs reaches over one.

Let a plane with the unit normal d be such that all triangles of a body A that come near another, B, lie below the
height α above it, and those of B above −β. Moved by δ = α + β along −d, the surface of A meets that of B no more; where
neither body lies in the other, they share nothing then. So a place that both have lies no deeper than δ in either.

Bodies that were made to touch do so at a face: the planes of the triangles are tried.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inertia.arrays import Bool, Float, Int, runs_of
from inertia.mesh.geometry.near_triangles import ranges
from inertia.mesh.geometry.triangle_pairs import orient3d, unit_normals

_SAMPLE = 12  # corners of each body that all planes are compared with,
_TRIED = 8  # of what is left of a pair, the planes of the largest triangles that are compared with all corners
_AT_ONCE = 1 << 14  # planes compared with samples, and triangles with planes, together
_ROUNDING = 2.0**-48  # of a height, over how far the corners of a pair are from each other: a dozen of roundings


def touching_depths(corners: Float, sides: Sequence[tuple[Int, Int]], most: Float) -> Float:
    """Return how deep, at most, places lie that pairs of bodies share; infinity where no plane shows it.

    It is 0 where they share none, exactly.

    Parameters
    ----------
    corners : (t, 3, 3), triangles of closed bodies, outward
    sides : of each pair, numbers of the triangles of the one and of the other that come nearer the other's box than
        `most`; that neither body lies in the other is not looked at
    most : (k,), the depth that matters

    >>> from inertia.mesh.cut import block
    >>> once = block([0, 0, 0], np.eye(3)).corners()
    >>> both = np.concatenate([once, once + [1 - 2**-20, 0.5, 0.5]])
    >>> touching_depths(both, [(np.arange(12), np.arange(12, 24))], np.array([1e-6])) * 2**20
    array([1.])
    """
    depths = np.full(len(sides), np.inf)
    counts = np.array([[len(one), len(other)] for one, other in sides], np.int64).reshape(-1, 2)
    depths[(counts == 0).any(axis=1)] = 0.0
    asked = np.flatnonzero((counts > 0).all(axis=1))
    if len(asked):
        pairs = _Pairs(corners, [sides[k] for k in asked.tolist()], counts[asked])
        found, planes, deep = pairs.planes(most[asked])
        depths[asked[found]] = np.where(pairs.parts(found, planes), 0.0, deep)
    return depths


class _Pairs:
    """Triangles of pairs of bodies, about one of them, those of the first body of each before those of the second.

    Attributes
    ----------
    corners : (n, 3, 3)
    pair, second : (n,), of which pair each is; whether of its second body
    normals : (n, 3), from the first body to the second; 0 where there is no area
    counts, starts : (k, 2), how many triangles of each body there are, and where they begin
    room : (k,), what heights are rounded by, at most
    """

    def __init__(self, corners: Float, sides: Sequence[tuple[Int, Int]], counts: Int) -> None:
        each = counts.ravel()
        body = np.repeat(np.arange(len(each)), each)
        self.counts, self.starts = counts, (np.cumsum(each) - each).reshape(-1, 2)
        self.pair, self.second = body // 2, body % 2 == 1
        own = corners[np.concatenate([numbers for pair in sides for numbers in pair])]
        self.corners = own - own[self.starts[self.pair, 0], :1]
        self.normals = np.where(self.second[:, None], -1, 1) * unit_normals(own)
        self.exact = own
        extents = np.abs(self.corners).max(axis=(1, 2))
        self.room = _ROUNDING * np.maximum.reduceat(extents, self.starts[:, 0])

    def planes(self, most: Float) -> tuple[Int, Int, Float]:
        """Return the pairs that touch at the plane of a triangle, this triangle, and how deep they reach over it."""
        left = np.flatnonzero(self.normals.any(axis=1))
        samples = self._samples()
        for some in (samples[:, :, :: _SAMPLE // 3], samples):
            pieces = np.split(left, range(_AT_ONCE, len(left), _AT_ONCE))
            left = left[np.concatenate([self._passes(piece, some, most) for piece in pieces])]
        sides = self.corners[left, 1:] - self.corners[left, :1]
        area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        left = left[np.lexsort((-area, self.pair[left]))]
        first = np.searchsorted(self.pair[left], self.pair[left])
        left = left[np.arange(len(left)) - first < _TRIED]
        deep = self._depths(left)
        order = np.lexsort((deep, self.pair[left]))
        order = order[deep[order] <= most[self.pair[left[order]]]]
        found, at = np.unique(self.pair[left[order]], return_index=True)
        return found, left[order[at]], deep[order[at]]

    def _samples(self) -> Float:
        """Return some corners (k, 2, s, 3) of both bodies of each pair."""
        steps = (np.arange(_SAMPLE) * (3 * self.counts[..., None])) // _SAMPLE
        samples: Float = self.corners.reshape(-1, 3)[3 * self.starts[..., None] + steps]
        return samples

    def _passes(self, some: Int, samples: Float, most: Float) -> Bool:
        """Say which triangles' planes part the samples, but for the depth that matters."""
        pair = self.pair[some]
        heights = np.einsum("nbsi,ni->nbs", samples[pair] - self.corners[some, None, None, 0], self.normals[some])
        passes: Bool = (heights[:, 0].max(axis=1) <= most[pair]) & (heights[:, 1].min(axis=1) >= -most[pair])
        return passes

    def _depths(self, planes: Int) -> Float:
        """Return how deep pairs reach over planes: the first body above and the second below."""
        depths = 2 * self.room[self.pair[planes]]
        for body, sign in ((0, 1), (1, -1)):
            counts = self.counts[self.pair[planes], body]
            for run in runs_of(counts, _AT_ONCE):
                some, count = planes[run], counts[run]
                which, owner = ranges(self.starts[self.pair[some], body], count)
                over = (sign * self._heights(which, some[owner])).max(axis=1)
                depths[run] += np.maximum(np.maximum.reduceat(over, np.cumsum(count) - count), 0.0)
        return depths

    def _heights(self, which: Int, planes: Int) -> Float:
        """Return the heights (n, 3) of the corners of triangles over planes."""
        heights: Float = np.einsum("nci,ni->nc", self.corners[which] - self.corners[planes, :1], self.normals[planes])
        return heights

    def parts(self, found: Int, planes: Int) -> Bool:
        """Say of which pairs planes hold the corners apart, exactly; such in a plane are on either side of it."""
        which, owner = ranges(self.starts[found, 0], self.counts[found].sum(axis=1))
        second, heights = self.second[which], self._heights(which, planes[owner])
        over = np.where(second[:, None], -heights, heights)
        room = self.room[found[owner], None]
        crosses = (over > room).any(axis=1)
        beyond = np.bincount(owner, crosses, minlength=len(found)) > 0
        unsure = np.flatnonzero((np.abs(over) <= room).any(axis=1) & ~beyond[owner])
        plane = planes[owner[unsure]]
        a, b, c = self.exact[plane].transpose(1, 0, 2)[:, :, None]
        side = orient3d(a, b, c, self.exact[which[unsure]])
        # The normal of a triangle of the second body leads to the first.
        outside = np.where(self.second[plane] == second[unsure], 1, -1)
        crossed = (side == outside[:, None]).any(axis=1)
        parts: Bool = ~beyond & (np.bincount(owner[unsure], crossed, minlength=len(found)) == 0)
        return parts
