"""Winding numbers on both sides of places on a surface, exactly: by rays along an axis, and by what lies at the place.

The ray starts at a place of a triangle, along the axis from which that is seen best. Each triangle that it meets is
crossed upwards or downwards. Floating point decides where its error bounds allow, integers do elsewhere. An edge that
lies right above the place counts as if the ray were moved aside a little, and alike for all triangles there.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Bool, Float, Int, Progress
from inertia.mesh.arrangement.cells import Cell
from inertia.mesh.arrangement.integers import Line, Point, Triangles, scaled
from inertia.mesh.geometry.winding import candidates
from inertia.records import dataclass

_EPSILON = 2.0**-53
_ORIENT2D = (3 + 16 * _EPSILON) * _EPSILON  # Shewchuk's first stage, as in `crossing_kernel`
_HEIGHT = 16 * _EPSILON  # more than three differences, a cross and a dot product are rounded by
_UNDERFLOW = 2.0**-1000
_TRIES = 4
_AT_ONCE = 1 << 14


@dataclass(frozen=True)
class Probe:
    """A place on a triangle: exactly, in its plane, and in float64, where that is the same."""

    triangle: int
    point: Point
    stored: tuple[float, float] | None


@dataclass(frozen=True)
class Sides:
    """Winding numbers just above and below a place, seen along the triangle's axis, and the first triangle there."""

    above: int
    below: int
    first: int


def probe(triangles: Triangles, triangle: int, cell: Cell, lines: list[Line]) -> Probe:
    """Choose a place inside a cell, if possible one with float64 coordinates."""
    k = triangles.plane(triangle).axis
    origin, exponent = triangles.origin, triangles.exponent
    u, v = origin[k - 2], origin[k - 1]
    corners = [(scaled(x + u * w, w, exponent), scaled(y + v * w, w, exponent)) for x, y, w in cell.corners]
    for attempt in range(_TRIES):
        weights = [1.0 + ((0.618 * j + 0.37 * attempt) % 1.0) for j in range(len(corners))]
        total = sum(weights)
        stored = (
            sum(weight * x for weight, (x, _) in zip(weights, corners, strict=True)) / total,
            sum(weight * y for weight, (_, y) in zip(weights, corners, strict=True)) / total,
        )
        point = _exact(triangles, stored, u, v)
        if cell.contains(point, lines):
            return Probe(triangle, point, stored)
    (a, b, i), (c, d, j), (e, f, m) = cell.corners[:3]
    middle = 5 * a * j * m + 7 * c * i * m + 11 * e * i * j, 5 * b * j * m + 7 * d * i * m + 11 * f * i * j
    return Probe(triangle, (*middle, 23 * i * j * m), None)


def _exact(triangles: Triangles, stored: tuple[float, float], u: int, v: int) -> Point:
    (x, i), (y, j) = (value.as_integer_ratio() for value in stored)
    w = max(i, j)
    x, y = x * (w // i), y * (w // j)
    if triangles.exponent > 0:
        w <<= triangles.exponent
    else:
        x, y = x << -triangles.exponent, y << -triangles.exponent
    return x - u * w, y - v * w, w


def sides(triangles: Triangles, probes: list[Probe], progress: Progress | None = None) -> list[Sides]:
    """Return the winding numbers on both sides of places."""
    above = np.zeros(len(probes), np.int64)
    at = np.zeros(len(probes), np.int64)
    first = np.array([each.triangle for each in probes])
    axes = np.array([triangles.plane(each.triangle).axis for each in probes])
    stored = np.array([each.stored is not None for each in probes])
    plane = _planes(triangles, set(first.tolist()))
    own = plane[first]
    seen = 0
    for axis in range(3):
        frame = [(axis + 1) % 3, (axis + 2) % 3, axis]
        corners = triangles.vertices[triangles.faces][:, :, frame]
        low, high = corners.min(axis=1), corners.max(axis=1)
        for which, safe in ((stored, 0.0), (~stored, 1.0)):
            numbers = np.flatnonzero((axes == axis) & which)
            for start in range(0, len(numbers), _AT_ONCE):
                some = numbers[start : start + _AT_ONCE]
                points = np.array([_spatial(triangles, probes[number]) for number in some])
                # What is not stored exactly is at most one rounding off.
                aside = safe * 4 * _EPSILON * np.abs(points).max(initial=0.0)
                for triangle, point in candidates(points, low - aside, high + aside):
                    number = some[point]
                    turn, here, unsure = _crossed(corners[triangle], points[point], plane[triangle] == own[number])
                    if safe:
                        turn[:], here[:], unsure[:] = 0, 0, True
                    np.add.at(above, number, turn)
                    np.add.at(at, number, here)
                    np.minimum.at(first, number[here != 0], triangle[here != 0])
                    for s, k in zip(triangle[unsure].tolist(), number[unsure].tolist(), strict=True):
                        turned, height = _crossed_exactly(triangles, probes[k], s)
                        if height > 0:
                            above[k] += turned
                        elif height == 0 and turned:
                            at[k] += turned
                            first[k] = min(first[k], s)
                seen += len(some)
                if progress is not None:
                    progress(seen / len(probes))
    # Upwards through the sheets that lie there, the winding number falls by those that face up.
    return [Sides(a, a + b, f) for a, b, f in zip(above.tolist(), at.tolist(), first.tolist(), strict=True)]


def _spatial(triangles: Triangles, at: Probe) -> tuple[float, float, float]:
    """Return the place in the triangle's frame, its axis last, rounded to float64 once."""
    (normal, d, k), (x, y, w) = triangles.plane(at.triangle), at.point
    origin, exponent = triangles.origin, triangles.exponent
    below = w * normal[k]
    above = d * w - normal[k - 2] * x - normal[k - 1] * y + origin[k] * below
    if below < 0:
        above, below = -above, -below
    u, v = at.stored or (
        scaled(x + origin[k - 2] * w, w, exponent),
        scaled(y + origin[k - 1] * w, w, exponent),
    )
    return u, v, scaled(above, below, exponent)


def _planes(triangles: Triangles, which: set[int]) -> Int:
    """Return a number for each triangle, the same for those of `which` that lie in one plane; −1 for all others."""
    numbers: dict[tuple[int, ...], int] = {}
    plane = np.full(len(triangles.faces), -1)
    for triangle in sorted(which):
        normal, offset, axis = triangles.plane(triangle)
        way = 1 if normal[axis] > 0 else -1
        plane[triangle] = numbers.setdefault((*(way * k for k in normal), way * offset), len(numbers))
    return plane


def _crossed(corners: Float, points: Float, coplanar: Bool) -> tuple[Int, Int, Bool]:
    """Return how rays from points (k, 3) cross triangles (k, 3, 3), upwards 1 or downwards −1, and what is unsure.

    The last coordinate of the points is rounded; what is unsure is 0.

    Parameters
    ----------
    coplanar : which triangles lie in the plane of their point: if so, what they are crossed by comes second
    """
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        arms = (corners - points[:, None]).transpose(1, 2, 0)
        turn, unsure = np.zeros(len(points), np.int64), np.zeros(len(points), bool)
        for a, b in ((arms[0], arms[1]), (arms[1], arms[2]), (arms[2], arms[0])):
            left, right = a[0] * b[1], a[1] * b[0]
            value, bound = left - right, _ORIENT2D * (np.abs(left) + np.abs(right)) + _UNDERFLOW
            straddles = (a[1] <= 0) != (b[1] <= 0)
            upwards = a[1] <= 0
            turn += straddles * (upwards & (value > 0)) - straddles * (~upwards & (value < 0)).astype(np.int64)
            unsure |= straddles & ~(np.abs(value) > bound)
        u, v = ((corners[:, k] - corners[:, 0]).T for k in (1, 2))
        value, size = np.zeros(len(points)), np.zeros(len(points))
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            left, right = u[j] * v[k], u[k] * v[j]
            value += arms[0][i] * (left - right)
            rounded = np.abs(points[:, 2]) if i == 2 else 0.0
            size += (np.abs(arms[0][i]) + rounded) * (np.abs(left) + np.abs(right))
        bound = _HEIGHT * size + _UNDERFLOW
        here = np.where(coplanar & ~unsure, turn, 0)
        unsure |= (turn != 0) & ~coplanar & ~(np.abs(value) > bound)
    turn[unsure | coplanar | (turn * value < 0)] = 0
    return turn, here, unsure


def _crossed_exactly(triangles: Triangles, at: Probe, number: int) -> tuple[int, int]:
    """Return how a ray crosses a triangle, 0 where it passes by, and the sign of how far above the place that is."""
    here, (x, y, w) = triangles.plane(at.triangle), at.point
    k = here.axis
    u, v = k - 2, k - 1
    arms = [(p[u] * w - x, p[v] * w - y) for p in triangles.corners(number)]
    turn = 0
    for (a, b), (c, d) in zip(arms, arms[1:] + arms[:1], strict=True):
        if b <= 0 < d:
            turn += a * d > b * c
        elif d <= 0 < b:
            turn -= a * d < b * c
    if turn == 0:
        return 0, 1
    there = triangles.plane(number)
    n = here.normal[k]
    third = here.offset * w - here.normal[u] * x - here.normal[v] * y
    height = n * (there.normal[u] * x + there.normal[v] * y - there.offset * w) + there.normal[k] * third
    if n < 0:
        height = -height
    behind = (height < 0) - (height > 0)  # of the triangle there: it is above where it faces up
    return turn, turn * behind
