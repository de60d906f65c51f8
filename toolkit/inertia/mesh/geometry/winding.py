"""Winding numbers of a closed surface around points, by its crossings of a ray.

The ray goes from the point p along +z. Each triangle is projected on the xy plane, where its winding number
about p is −1, 0 or 1; it counts when the triangle passes above p. Whether an edge passes left or right of p
is decided by the sign of one determinant that is bitwise opposite for the two triangles at that edge, so that
no crossing is lost or counted twice at an edge or vertex, however it is rounded. Only triangles whose box
meets the ray are looked at, which makes a thousand points in a million triangles cheap; solid angles would
cost every point every triangle.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int
from inertia.native import Kernel, place

_WIND = Kernel("inertia.mesh.geometry.winding_kernel", "wind", "pipidpp")
_RAYS = 128  # along an axis of a box, for a volume
_PAIRS = 1 << 20  # pairs of a triangle and a point looked at together


def windings(points: Float, corners: Float, margin: float) -> tuple[Int, Float]:
    """Return what triangles add to the winding number of points, and how clear of them the points are.

    Parameters
    ----------
    points : (p, 3)
    corners : (t, 3, 3); the winding numbers of the pieces of a closed surface add up to its own
    margin : distance up to which a triangle counts as near a point

    Returns
    -------
    winding : (p,) int64, the number of times that these triangles cross the ray outwards less inwards
    clearance : (p,), least distance to the plane of a triangle whose box, grown by `margin`, holds the point
    """
    winding = np.zeros(len(points), np.int64)
    clearance = np.full(len(points), np.inf)
    if _WIND.worthwhile(len(corners)):
        order = np.argsort(points[:, 0], kind="stable")
        along, triangles = points[order], np.ascontiguousarray(corners)
        sizes = len(points), len(corners)
        _WIND.function(place(along), sizes[0], place(triangles), sizes[1], margin, place(winding), place(clearance))
        back = np.argsort(order)
        return winding[back], clearance[back]
    low, high = corners.min(axis=1) - margin, corners.max(axis=1) + margin
    for triangle, point in candidates(points, low, high):
        _wind(points, corners, low, high, triangle, point, winding, clearance)
    return winding, clearance


def windings_each(points: Float, corners: Float, owner: Int, margin: float) -> tuple[Int, Float]:
    """Return what `windings` does, of several groups of points (k, s, 3), each among triangles of its own.

    Parameters
    ----------
    owner : (t,), the group among whose triangles each is

    Returns
    -------
    winding, clearance : (k, s)
    """
    groups, count, _ = points.shape
    winding = np.zeros(groups * count, np.int64)
    clearance = np.full(groups * count, np.inf)
    low, high = corners.min(axis=1) - margin, corners.max(axis=1) + margin
    x, y = points[owner, :, 0], points[owner, :, 1]
    meets = (low[:, :1] <= x) & (x <= high[:, :1]) & (low[:, 1:2] <= y) & (y <= high[:, 1:2])
    triangle, sample = np.nonzero(meets)
    point = owner[triangle] * count + sample
    _wind(points.reshape(-1, 3), corners, low, high, triangle, point, winding, clearance)
    return winding.reshape(groups, count), clearance.reshape(groups, count)


def _wind(
    points: Float, corners: Float, low: Float, high: Float, triangle: Int, point: Int, winding: Int, clearance: Float
) -> None:
    """Add what triangles contribute to the winding numbers of points, pair by pair, and lessen their clearances."""
    a, b, c = (corners[triangle] - points[point, None]).transpose(1, 2, 0)
    turns = _turns(a, b) + _turns(b, c) + _turns(c, a)
    normal = _cross(b - a, c - a)
    volume = (a * normal).sum(axis=0)  # positive where the point is behind the triangle
    above = turns * volume > 0
    np.add.at(winding, point[above], turns[above])
    z = points[point, 2]
    near = (low[triangle, 2] <= z) & (z <= high[triangle, 2])
    area = np.sqrt((normal * normal).sum(axis=0))
    near &= area > 0
    np.minimum.at(clearance, point[near], np.abs(volume[near]) / area[near])


def windings_under(triangles: Float, corners: Float) -> tuple[Int, Bool]:
    """Return the winding numbers of a closed surface just under the middles of triangles, in integers.

    Parameters
    ----------
    triangles : (p, 3, 3), of another surface or of the same
    corners : (t, 3, 3), the closed surface

    Returns
    -------
    winding : (p,)
    decided : (p,), False where the ray passes through an edge, or a triangle stands upright on another
    """
    middles = triangles.mean(axis=1)
    low, high = corners.min(axis=1), corners.max(axis=1)
    margin = 8 * np.spacing(np.abs(corners).max())  # more than the middles are rounded by
    winding, decided = np.zeros(len(triangles), np.int64), np.ones(len(triangles), bool)
    for triangle, point in candidates(middles, low - margin, high + margin):
        whole = _integers(np.concatenate([triangles[point], corners[triangle]], axis=1))
        own, other = whole[:, :3], whole[:, 3:]
        a, b, c = (3 * other - own.sum(axis=1)[:, None]).transpose(1, 2, 0)
        turns = np.zeros(len(point), np.int64)
        for u, v in ((a, b), (b, c), (c, a)):
            through = (u[0] * v[1] == u[1] * v[0]) & (u[0] * v[0] + u[1] * v[1] <= 0)
            decided[point[through.astype(bool)]] = False
            turns += _turns(u, v)
        normal = _cross(b - a, c - a)
        height = (a * normal).sum(axis=0)
        facing = (normal * _cross(*(own[:, k].T - own[:, 0].T for k in (1, 2)))).sum(axis=0)
        level = (height == 0).astype(bool) & (turns != 0)
        decided[point[level & (facing == 0).astype(bool)]] = False
        above = turns * np.where(level, facing, height) > 0
        np.add.at(winding, point[above.astype(bool)], turns[above.astype(bool)])
    return winding, decided


def _integers(corners: Float) -> NDArray[np.object_]:
    """Return coordinates (k, ...) as integers, over a power of two that is common to all."""
    mantissa, exponent = np.frexp(corners)
    shift = np.where(mantissa != 0, exponent - exponent[mantissa != 0].min(initial=2000), 0)
    integers: NDArray[np.object_] = np.ldexp(mantissa, 53).astype(np.int64).astype(object) << shift.astype(object)
    return integers


def misplaced_volume(corners: Float, box: Float) -> float:
    """Estimate ∫ |w − [w > 0]| dV, what a closed surface counts of places beyond once for the inside of its volume.

    Parameters
    ----------
    corners : (t, 3, 3), a closed surface; w is its winding number
    box : (2, 3); rays along z, 128 × 128 of them, pass through it and take all that lies above and below, and then as
        many more where those met such places

    >>> from inertia.mesh.cut import block
    >>> once = block([0, 0, 0], np.eye(3)).corners()
    >>> box = np.array([[0, 0, 0], [1.5, 1, 1]])
    >>> misplaced_volume(once, box), round(misplaced_volume(np.concatenate([once, once + [0.5, 0, 0]]), box), 2)
    (0.0, 0.5)
    """
    volume, hit = _misplaced(corners, box)
    if hit is not None:
        finer, _ = _misplaced(corners, hit)
        volume = finer or volume
    return volume


def _misplaced(corners: Float, box: Float) -> tuple[float, Float | None]:
    """Return the estimate, and the box of the rays that met such places, a ray's breadth wider."""
    low, high = box[0, :2], box[1, :2]
    steps = (np.arange(_RAYS) + 0.5) / _RAYS
    x, y = (low[axis] + (high[axis] - low[axis]) * steps for axis in (0, 1))
    points = np.column_stack([np.repeat(x, _RAYS), np.tile(y, _RAYS)])
    table = np.ascontiguousarray(corners.transpose(1, 2, 0))
    rays, heights, turns = [], [], []
    for triangle, point in _grid_candidates(x, y, corners[:, :, :2]):
        own = table[:, :, triangle]
        own[:, :2] -= points[point].T
        a, b, c = own
        turn = _turns(a, b) + _turns(b, c) + _turns(c, a)
        met = np.flatnonzero(turn)
        a, b, c = own[:, :, met]
        normal = _cross(b - a, c - a)
        upright = normal[2] == 0  # but for rounding: anywhere between its corners is as near
        normal[:2, upright], normal[2, upright] = 0.0, 1.0
        rays.append(point[met])
        heights.append((a * normal).sum(axis=0) / normal[2])
        turns.append(turn[met])
    ray, height, turn = np.concatenate(rays), np.concatenate(heights), np.concatenate(turns)
    order = np.lexsort((height, ray))
    ray, height, winding = ray[order], height[order], -np.cumsum(turn[order])
    # Each ray passes as many triangles outwards as inwards, so that the sum is zero where the next begins.
    same = ray[1:] == ray[:-1]
    stretch = np.where(same, height[1:] - height[:-1], 0.0)
    excess = np.abs(winding[:-1] - (winding[:-1] > 0))
    volume = float((stretch * excess).sum() * np.prod((high - low) / _RAYS))
    hits = points[ray[:-1][stretch * excess > 0]]
    if len(hits) == 0:
        return 0.0, None
    breadth = (high - low) / _RAYS
    return volume, np.stack([hits.min(axis=0) - breadth, hits.max(axis=0) + breadth])


def _grid_candidates(x: Float, y: Float, corners: Float) -> Iterator[tuple[Int, Int]]:
    """Yield pairs (triangle, point), ascending: those of a triangle (t, 3, 2) over a point of a grid, and few more.

    The points are each x with every y, both ascending and evenly spaced, and are numbered in that order.
    """
    begin = np.searchsorted(x, corners[:, :, 0].min(axis=1), "left")
    wide = np.searchsorted(x, corners[:, :, 0].max(axis=1), "right") - begin
    total = np.cumsum(wide)
    room = y[1] - y[0] + 8 * np.spacing(np.abs(corners[:, :, 1]).max(initial=0.0))  # more than a height is rounded by
    start = 0
    while start < len(corners):
        done = total[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(total, done + _PAIRS // _RAYS, "right")))
        count = wide[start:stop]
        triangle = np.repeat(np.arange(start, stop), count)
        column = np.arange(len(triangle)) + np.repeat(begin[start:stop] - (total[start:stop] - count - done), count)
        low, high = _across(corners[triangle], x[column])
        lower = np.searchsorted(y, low - room, "left")
        tall = np.searchsorted(y, high + room, "right") - lower
        first = np.cumsum(tall) - tall
        yield np.repeat(triangle, tall), np.arange(tall.sum()) + np.repeat(column * len(y) + lower - first, tall)
        start = stop


def _across(corners: Float, x: Float) -> tuple[Float, Float]:
    """Return from which to which y triangles (k, 3, 2) reach at x (k,), which is within theirs."""
    low, high = np.full(len(x), np.inf), np.full(len(x), -np.inf)
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        meets = (np.minimum(a[:, 0], b[:, 0]) <= x) & (x <= np.maximum(a[:, 0], b[:, 0]))
        run = b[:, 0] - a[:, 0]
        share = np.divide(x - a[:, 0], run, out=np.zeros_like(x), where=run != 0)
        at = a[:, 1] + np.clip(share, 0, 1) * (b[:, 1] - a[:, 1])
        upright = run == 0  # and as a whole at x, where it meets it
        low = np.minimum(low, np.where(meets, np.where(upright, np.minimum(at, b[:, 1]), at), np.inf))
        high = np.maximum(high, np.where(meets, np.where(upright, np.maximum(at, b[:, 1]), at), -np.inf))
    return low, high


def candidates(points: Float, low: Float, high: Float) -> Iterator[tuple[Int, Int]]:
    """Yield pairs (triangle, point) in which the triangle's box meets the point's line along z."""
    order = np.argsort(points[:, 0], kind="stable")
    x = points[order, 0]
    begin = np.searchsorted(x, low[:, 0], "left")
    counts = np.searchsorted(x, high[:, 0], "right") - begin
    total = np.cumsum(counts)
    start = 0
    while start < len(low):
        done = total[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(total, done + _PAIRS, "right")))
        count = counts[start:stop]
        triangle = np.repeat(np.arange(start, stop), count)
        place = np.arange(count.sum()) + np.repeat(begin[start:stop] - (total[start:stop] - count - done), count)
        point = order[place]
        y = points[point, 1]
        meets = (low[triangle, 1] <= y) & (y <= high[triangle, 1])
        yield triangle[meets], point[meets]
        start = stop


def _turns(a: Float, b: Float) -> Int:
    """Return the crossings of the positive x axis by edges a→b in the xy plane: 1 upwards, −1 downwards."""
    side = a[0] * b[1] - a[1] * b[0]
    upwards = (a[1] <= 0) & (b[1] > 0) & (side > 0)
    downwards = (b[1] <= 0) & (a[1] > 0) & (side < 0)
    turns: Int = upwards.astype(np.int64) - downwards
    return turns


def _cross(a: Float, b: Float) -> Float:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
