"""Whether a polygon goes once around what it encloses: what it winds round twice, or the other way, counts wrongly."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import GeometryError
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.triangle_pairs import orient3d

_THICK = np.array([0.0, 0.0, 1.0])

_NONE = 1e-9
"""A part of the area enclosed that counts as none: as much as corners off the plane may feign."""

_ROUNDING = 1e-15
"""How far off the edges an order of theirs that is found in float64 may be, as a part of the size; size about one."""


def require_simple(corners: Float) -> None:
    """Raise `GeometryError` where a polygon of corners (n, 2), its size about one, does not go once around an area.

    Edges may touch, and run to and fro between an outer edge and a hole.
    """
    crossed, touching = _meetings(corners)
    if crossed is not None:
        i, j = crossed
        raise GeometryError(f"the outline crosses itself: its edges from corners {i} and {j} on, counted from 0, cross")
    if not touching:
        return
    once, otherwise = _areas_by_winding(corners)
    perimeter = float(np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1).sum())
    if otherwise > _NONE * once + _ROUNDING * perimeter:
        raise GeometryError(
            "the outline goes round something twice, or round one part this way and another that way: give its corners "
            "once around it, and parts as outlines of their own"
        )


def _meetings(corners: Float) -> tuple[tuple[int, int] | None, bool]:
    """Return the first edges of a polygon that cross within both, or None, and whether any touch beside neighbours.

    A polygon whose edges neither cross nor touch has an inside that it goes once around.
    """
    raised = np.pad(corners, ((0, 0), (0, 1)))
    a, b = raised, np.roll(raised, -1, axis=0)
    boxes = BoxTree(np.minimum(a, b) - _THICK, np.maximum(a, b) + _THICK)

    def side(of: Int, other: Int, end: Float) -> NDArray[np.int8]:
        return orient3d(a[of], b[of], end[other], a[of] + _THICK)

    crossed: list[tuple[int, int]] = []
    touching = False
    for i, j, _ in overlapping(boxes, touching=True):
        ends = np.stack([side(i, j, a) * side(i, j, b), side(j, i, a) * side(j, i, b)])
        parted = (ends < 0).all(axis=0)
        crossed += zip(i[parted].tolist(), j[parted].tolist(), strict=True)
        neighbours = np.isin(np.abs(i - j), (1, len(a) - 1))
        back = ((b[i] - a[i]) * (b[j] - a[j])).sum(axis=1) <= 0  # of neighbours in line: one runs back over the other
        flat = (side(i, j, a) == 0) & (side(i, j, b) == 0)
        touching = touching or bool(((ends <= 0).all(axis=0) & (~neighbours | (flat & back))).any())
    return min(crossed, default=None), touching


def _areas_by_winding(corners: Float) -> tuple[float, float]:
    """Return the area that a polygon goes once around, the way it encloses more, and that of all else it goes around.

    Between neighbouring x of corners no two of its edges cross, which has been seen to: they are in one order of y.
    Where rounding changes that order, the areas change by no more than it.
    """
    ahead = np.roll(corners, -1, axis=0)
    slanted = corners[:, 0] != ahead[:, 0]
    a, b = corners[slanted], ahead[slanted]
    way = np.where(b[:, 0] > a[:, 0], 1, -1)
    left, right = (np.where(way[:, None] > 0, *ends) for ends in ((a, b), (b, a)))
    order = np.argsort(left[:, 0], kind="stable")
    left, right, way = left[order], right[order], way[order]
    across = np.unique(corners[:, 0])
    begins = np.searchsorted(left[:, 0], across, side="right").tolist()
    areas = np.zeros(2 * len(way) + 1)  # by winding, which may be negative as places of an array may
    active, at = np.empty(0, np.int64), 0
    for (start, stop), begun in zip(pairwise(across.tolist()), begins, strict=False):
        active = np.concatenate([active[right[active, 0] > start], np.arange(at, begun)])
        at = begun
        low, high = left[active], right[active]
        share = (0.5 * (start + stop) - low[:, 0]) / (high[:, 0] - low[:, 0])
        heights = low[:, 1] + share * (high[:, 1] - low[:, 1])
        upward = np.argsort(heights, kind="stable")
        np.add.at(areas, np.cumsum(way[active[upward]])[:-1], (stop - start) * np.diff(heights[upward]))
    areas[0] = 0.0
    once = max(areas[1], areas[-1])
    return once, float(areas.sum()) - once
