"""Where triangles meet one another in more than a point: segments that divide them, and edges that others touch.

Boxes and signs of determinants (`inertia.mesh.geometry.triangle_pairs`) sort out all but few pairs; the rest is worked
out in integers. Two triangles whose planes differ share an interval of the line in which the planes meet; two
in one plane divide each other by their edges.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field
from typing import cast

import numpy as np

from inertia.arrays import Bool, Float, Int, Progress
from inertia.mesh.arrangement.cells import Segment
from inertia.mesh.arrangement.integers import Line, Point, Triangles, Vector, cross, meet, side, through
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.triangle_pairs import UNSURE, Sign, crossing, orient3d, orient3d_filter
from inertia.records import dataclass

_COPLANAR = -1  # the first part of a line's name where it is not the number of a triangle
_CLEARLY = 1e-3  # sine of an angle that no rounding turns


@dataclass
class Contacts:
    """What divides the triangles.

    Attributes
    ----------
    segments : of each triangle that others meet in more than a point of its boundary; () where they lie on it
    touched : edges (two vertices, ascending) along which another triangle lies, or which it crosses there
    crossings : pairs of triangles that divide at least one of the two
    """

    segments: dict[int, list[Segment]] = field(default_factory=dict)
    touched: set[tuple[int, int]] = field(default_factory=set)
    crossings: int = 0


def contacts(triangles: Triangles, faces: Int, progress: Progress | None = None) -> Contacts:
    """Find where triangles meet; `faces` are the numbers of those that have an area."""
    result = Contacts()
    pairs = []
    for pair, done in _pairs(triangles, faces):
        pairs.append(pair)
        if progress is not None:
            progress(0.5 * done)
    every = np.concatenate([np.empty((0, 2), np.int64), *pairs])
    every = every[np.lexsort(every.T[::-1])]
    for k, (one, other) in enumerate(every.tolist()):
        if triangles.plane(one)[:2] == triangles.plane(other)[:2] or _opposite(triangles, one, other):
            _in_one_plane(triangles, result, one, other)
        else:
            _in_two_planes(triangles, result, one, other)
        if progress is not None and k % 256 == 0:
            progress(0.5 + 0.5 * k / len(every))
    return result


def _opposite(triangles: Triangles, one: int, other: int) -> bool:
    (a, d, _), (b, e, _) = triangles.plane(one), triangles.plane(other)
    return d == -e and a[0] == -b[0] and a[1] == -b[1] and a[2] == -b[2]


def _pairs(triangles: Triangles, numbers: Int) -> Iterator[tuple[Int, float]]:
    """Yield pairs (k, 2) of triangles that may meet in more than a point and have at most one corner in common.

    Those with an edge in common are among them where they lie in one plane, on the same side of that edge.
    """
    vertices, faces = triangles.vertices, triangles.faces[numbers]
    corners = vertices[faces]
    tree = BoxTree(corners.min(axis=1), corners.max(axis=1))
    for i, j, done in overlapping(tree, touching=True):
        crossed, _ = crossing(vertices, faces[i], faces[j])
        touch = _touching(vertices, faces[i], faces[j])
        which = np.union1d(crossed, touch)
        yield np.sort(np.column_stack([numbers[i[which]], numbers[j[which]]]), axis=1), done


def _touching(vertices: Float, a: Int, b: Int) -> Int:
    """Return which pairs of faces (k, 3) may have an edge of one in the plane of the other, and meet there."""
    shared = a[:, :, None] == b[:, None, :]
    common = shared.sum(axis=(1, 2))
    pair = np.arange(len(a))
    signs: list[Sign] = []
    for points, plane, axis in ((b, a, 1), (a, b, 2)):
        corners = vertices[plane[pair]]
        sign = orient3d_filter(corners[:, None, 0], corners[:, None, 1], corners[:, None, 2], vertices[points[pair]])
        sign[shared[pair].any(axis=axis)] = 0
        meets = _edge_or_both_sides(sign)
        pair, signs = pair[meets], [*(s[meets] for s in signs), sign[meets]]
    for k, (points, plane) in enumerate(((b, a), (a, b))):
        corners, unsure = vertices[plane[pair]], signs[k] == UNSURE
        row, corner = np.nonzero(unsure)
        signs[k][row, corner] = orient3d(
            corners[row, 0], corners[row, 1], corners[row, 2], vertices[points[pair[row], corner]]
        )
    edge = np.zeros(len(pair), bool)
    meets = np.ones(len(pair), bool)
    for sign in signs:
        edge |= (sign == 0).sum(axis=1) > 1
        meets &= _edge_or_both_sides(sign)
    flat = (signs[0] == 0).all(axis=1)
    which = np.flatnonzero(edge & meets & (flat | (common[pair] < 2)))
    pair, flat = pair[which], flat[which]
    apart = np.zeros(len(pair), bool)
    apart[flat] = _clearly_beside(vertices, a[pair[flat]], b[pair[flat]])
    return pair[~apart]


def _edge_or_both_sides(sign: Sign) -> Bool:
    """Say of signs (k, 3) whether two of them are, or may be, zero, or one of them positive and another negative."""
    zeros = ((sign == 0) | (sign == UNSURE)).sum(axis=1) > 1
    above, below = (((sign == way) | (sign == UNSURE)).any(axis=1) for way in (1, -1))
    either: Bool = zeros | (above & below)
    return either


def _clearly_beside(vertices: Float, a: Int, b: Int) -> Bool:
    """Say which faces (k, 3) in one plane an edge of one of them keeps apart, by far more than rounding."""
    beside = np.zeros(len(a), bool)
    for one, other in ((a, b), (b, a)):
        corners, points = vertices[one], vertices[other]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        steep = np.abs(normal).argmax(axis=1)
        rows = np.arange(len(one))
        way = np.sign(normal[rows, steep])
        for k in range(3):
            along = corners[:, (k + 1) % 3] - corners[:, k]
            arms = points - corners[:, None, k]
            u, v = (steep + 1) % 3, (steep + 2) % 3
            left = along[rows, u][:, None] * arms[rows, :, v]
            right = along[rows, v][:, None] * arms[rows, :, u]
            outside = way[:, None] * (left - right) < -_CLEARLY * (np.abs(left) + np.abs(right))
            ends = (other == one[:, k, None]) | (other == one[:, (k + 1) % 3, None])
            beside |= (outside | ends).all(axis=1)
    return beside


def _in_one_plane(triangles: Triangles, result: Contacts, one: int, other: int) -> None:
    seen = []
    for number in (one, other):
        a, b, c = triangles.seen(number)
        seen.append((a, b, c) if side(through(a, b), c) > 0 else (a, c, b))
    edges = [[through(p, q) for p, q in zip(points, points[1:] + points[:1], strict=True)] for points in seen]
    for lines, points in zip(edges, reversed(seen), strict=True):
        if any(all(side(line, point) <= 0 for point in points) for line in lines):
            return
    result.crossings += 1
    for number, clip, others in ((one, edges[0], other), (other, edges[1], one)):
        segments = result.segments.setdefault(number, [])
        points = triangles.seen(others)
        ends = triangles.faces[others].tolist()
        for k in range(3):
            p, q = points[k], points[(k + 1) % 3]
            line = through(p, q)
            if (inside := _clipped(line, p, q, clip)) is not None:
                low, high = sorted((ends[k], ends[(k + 1) % 3]))
                segments.append(Segment(line, edge_name(low, high), *inside))


def edge_name(low: int, high: int) -> tuple[int, int]:
    """Return the name of the line along an edge; that in which two planes meet is named by two triangles."""
    return -1 - low, -1 - high


def _clipped(line: Line, start: Point, end: Point, clip: Sequence[Line]) -> tuple[Point, Point] | None:
    """Return what of a segment lies on the positive sides of lines, if that is more than a point."""
    for edge in clip:
        at_start, at_end = side(edge, start), side(edge, end)
        if at_start <= 0 and at_end <= 0:
            return None
        if at_start < 0:
            start = meet(line, edge)
        elif at_end < 0:
            end = meet(line, edge)
    return start, end


_Spatial = tuple[int, int, int, int]  # homogeneous, in space, the last above zero


def _in_two_planes(triangles: Triangles, result: Contacts, one: int, other: int) -> None:
    planes = triangles.plane(one), triangles.plane(other)
    direction = cross(planes[0].normal, planes[1].normal)
    axis = max(range(3), key=lambda k: abs(direction[k]))
    heights = triangles.heights(one, planes[1]), triangles.heights(other, planes[0])
    start: _Spatial | None = None
    end: _Spatial | None = None
    for number, height in zip((one, other), heights, strict=True):
        low, high = _span(triangles.corners(number), height)
        if low[axis] * high[3] > high[axis] * low[3]:
            low, high = high, low
        if start is None or end is None:
            start, end = low, high
            continue
        start = low if low[axis] * start[3] > start[axis] * low[3] else start
        end = high if high[axis] * end[3] < end[axis] * high[3] else end
    start, end = cast(_Spatial, start), cast(_Spatial, end)
    if start[axis] * end[3] >= end[axis] * start[3]:
        return
    result.crossings += heights[0].count(0) < 2 or heights[1].count(0) < 2
    for number, height, by in ((one, heights[0], 1), (other, heights[1], 0)):
        if height.count(0) == 2:
            a, b = (vertex for vertex, far in zip(triangles.faces[number].tolist(), height, strict=True) if far == 0)
            result.touched.add((min(a, b), max(a, b)))
            continue
        k = triangles.plane(number).axis
        ends = ((point[(k + 1) % 3], point[(k + 2) % 3], point[3]) for point in (start, end))
        segment = Segment(triangles.cut(number, planes[by]), (one, other), *ends)
        result.segments.setdefault(number, []).append(segment)


def _span(corners: Sequence[Vector], heights: Sequence[int]) -> tuple[_Spatial, _Spatial]:
    """Return the ends of the interval in which a triangle meets a plane that cuts it."""
    ends: list[_Spatial] = [(*p, 1) for p, height in zip(corners, heights, strict=True) if height == 0]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        at_a, at_b = heights[a], heights[b]
        if (at_a < 0 < at_b) or (at_b < 0 < at_a):
            p, q, w = corners[a], corners[b], at_b - at_a
            x, y, z = (i * at_b - j * at_a for i, j in zip(p, q, strict=True))
            ends.append((x, y, z, w) if w > 0 else (-x, -y, -z, -w))
    return ends[0], ends[1]
