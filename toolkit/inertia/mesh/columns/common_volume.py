"""Volume that two closed surfaces have in common, or one counts more than once, with a bound on its rounding.

A column along z meets the triangles t of a surface at the heights z_t. With s_t = 1 where the surface leads out upwards
and −1 where it leads in, the winding number at the height z is w(z) = Σ_t s_t [z < z_t]. The product of those of two
surfaces, integrated over all columns and heights above a plane z = 0, is a sum over pairs of triangles,

    ∫ w_a w_b dV = Σ_a Σ_b s_a s_b ∫∫ min(z_a⁺, z_b⁺) dx dy,

the inner integral being over what the projections of both triangles have in common. Where the winding numbers are 0
and 1 that is the volume of the intersection. Nothing in it is decided by signs, so that faces in one plane, common
edges and rounded coordinates change it by no more than rounding does.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from inertia.arrays import Float, Int, runs_of
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.native import SHIPPED_ABOVE, Kernel, address

MOST_PAIRS = 1 << 21
"""Pairs of triangles of two bodies that are gone through: some ten seconds."""

MOST_OF_ITSELF = 1 << 18
"""Pairs of triangles of one surface that are: a second or two; few that take longer cross by rounding alone."""

_AT_ONCE = 1 << 15
_TOGETHER = 1 << 14  # triangles of pairs of surfaces that are looked at together
_ROUNDING = 2.0**-49  # of an area or a height, over the breadth of a pair times the largest coordinate: 16 roundings
_UP = 1 + 1e-9  # more than sums of positive terms lose

_SUM = Kernel("inertia.mesh.columns.clipping_kernel", "sum_pairs", "pipi" + "ppi" + "pp")
_CORNERS = 24  # of a polygon of the kernel

Measured = tuple[float, float] | None
"""A volume, and a bound on its rounding; None where that is too much work."""


def common_volume(a: Float, b: Float) -> Measured:
    """Return ∫ w_a w_b dV for two closed surfaces, and a bound on its rounding; None where that is too much work.

    Parameters
    ----------
    a, b : (n, 3, 3) and (m, 3, 3), corners; what lies beside the box around the other, or below it, may be left out

    >>> from inertia.mesh.cut import block
    >>> once = block([0, 0, 0], np.eye(3)).corners()
    >>> volume, rounding = common_volume(once, once + [0.75, 0.5, 0.5])
    >>> volume, rounding < 1e-10
    (0.0625, True)
    """
    together = np.concatenate([a, b])
    return common_volumes(together, [(np.arange(len(a)), np.arange(len(a), len(together)))])[0]


def common_volumes(corners: Float, pairs: Sequence[tuple[Int, Int]]) -> list[Measured]:
    """Return what `common_volume` does of pairs of closed surfaces, each the numbers of its triangles.

    Parameters
    ----------
    corners : (n, 3, 3), of all triangles
    """
    sizes = np.array([len(a) + len(b) for a, b in pairs], np.int64)
    runs = (pairs[run] for run in runs_of(sizes, _TOGETHER))
    return [measured for several in runs for measured in _of_several(corners, several)]


def _of_several(corners: Float, pairs: Sequence[tuple[Int, Int]]) -> list[Measured]:
    """Return the common volume of each of these pairs: as many as are looked at together."""
    sides, extents, boxes = [], [], np.empty((2, len(pairs), 2, 3))
    for body, groups in enumerate(zip(*pairs, strict=True)):
        sizes = np.array([len(group) for group in groups])
        own = corners[np.concatenate(groups)]
        least, most = _extents(own)
        starts = np.cumsum(sizes) - sizes
        boxes[body, :, 0], boxes[body, :, 1] = np.minimum.reduceat(least, starts), np.maximum.reduceat(most, starts)
        sides.append((own, np.repeat(np.arange(len(pairs)), sizes)))
        extents.append((least, most))
    low, high = boxes[:, :, 0].max(axis=0), boxes[:, :, 1].min(axis=0)
    meet, size = (low < high).all(axis=1), high - low
    axes = (np.arange(3) + 1 + np.argmin(size, axis=1)[:, None]) % 3  # z is where the common box is thinnest
    exponent = np.frexp(np.where(meet, size.max(axis=1), 1.0))[1]
    surfaces, owners = [], []
    for (own, owner), (least, most) in zip(sides, extents, strict=True):
        below = least < high[owner]
        below[np.arange(len(below)), axes[owner, 2]] = True
        which = np.flatnonzero(meet[owner] & (below & (most > low[owner])).all(axis=1))
        of = owner[which]
        local = np.ldexp(own[which] - low[of, None], -exponent[of, None, None])
        surfaces.append(np.take_along_axis(local, axes[of, None], axis=2))
        owners.append(of)
    one, other = surfaces
    over = _over_each_other(one, other, owners)
    if over is None and len(pairs) == 1:
        return [None]
    if over is None:
        half = len(pairs) // 2
        return _of_several(corners, pairs[:half]) + _of_several(corners, pairs[half:])
    i, j = over
    ends = np.searchsorted(owners[0][i], np.arange(len(pairs) + 1))
    largest = np.ldexp(np.abs(boxes).max(axis=(0, 2, 3)), -exponent) + 2.0
    return [
        _measured(*_under_both(one, other, i[start:stop], j[start:stop]), far, power)
        for start, stop, far, power in zip(ends, ends[1:], largest.tolist(), exponent.tolist(), strict=False)
    ]


def surplus_volume(corners: Float, box: Float) -> Measured:
    """Return ∫ w (w − 1) / 2 dV over a box, and a bound on its rounding; None where that is too much work.

    It is no less than ∫ |w − [w > 0]| dV: what counts beyond once for the inside of a surface, or less than not at all.

    Parameters
    ----------
    corners : (n, 3, 3), a closed surface; w is its winding number
    box : (2, 3)

    >>> from inertia.mesh.cut import block
    >>> once = block([0, 0, 0], np.eye(3)).corners()
    >>> twice = np.concatenate([once, once + [0.75, 0.5, 0.5]])
    >>> [surplus_volume(solid, np.array([[0, 0, 0], [2, 2, 2]]))[0] for solid in (once, twice)]
    [0.0, 0.0625]
    """
    low, high = box
    if (high <= low).any():
        return 0.0, 0.0
    axes = np.roll(np.arange(3), 2 - int(np.argmin(high - low)))
    exponent = int(np.frexp((high - low).max())[1])
    largest = float(np.ldexp(np.abs(corners).max(), -exponent)) + 2.0
    within = (corners.min(axis=1) < high)[:, axes[:2]].all(axis=1) & (corners.max(axis=1) > low).all(axis=1)
    local = np.ldexp(corners[within] - low, -exponent)[..., axes]
    triangles = _cut_to(local, np.ldexp(high - low, -exponent)[axes])
    if len(triangles) == 0:
        return 0.0, 0.0
    upward, signs = _upward(triangles)
    volume = float(((1 - signs) * (signs != 0) * _integrals(upward, 2)).sum()) / 2
    rounding = float(np.ptp(triangles, axis=1).sum()) * largest * _ROUNDING
    over = _gathered(overlapping(BoxTree(*_rectangles(triangles))), MOST_OF_ITSELF)
    if over is None:
        return None
    more, blur = _under_both(triangles, triangles, *over)
    return _measured(volume + more, blur, largest, exponent, rounding)


def _measured(volume: float, blur: float, largest: float, exponent: int, rounding: float = 0.0) -> tuple[float, float]:
    """Return a volume and its rounding, which blur adds to, in units of 2^`exponent`, in those of the surface."""
    rounding += blur * largest * _ROUNDING
    return float(np.ldexp(volume, 3 * exponent)), float(np.ldexp(rounding * _UP, 3 * exponent))


def _cut_to(corners: Float, size: Float) -> Float:
    """Return triangles as they are in columns through a box from the origin on, their heights kept within it."""
    polygons = corners
    for axis in range(2):
        polygons, _ = _clipped(polygons, polygons[..., axis])
        polygons, _ = _clipped(polygons, size[axis] - polygons[..., axis])
    polygons, _ = _clipped(polygons, polygons[..., 2])
    under = size[2] - polygons[..., 2]
    through = (under < 0).any(axis=1)
    pieces = _clipped(polygons, under)[0], _clipped(polygons[through], -under[through])[0]
    fans = [piece[:, [0, k, k + 1]] for piece in pieces for k in range(1, piece.shape[1] - 1)]
    fan = np.concatenate([np.empty((0, 3, 3)), *fans])
    fan[..., 2] = np.clip(fan[..., 2], 0, size[2])
    return fan


def _over_each_other(one: Float, other: Float, owners: Sequence[Int]) -> tuple[Int, Int] | None:
    """Return the pairs of triangles of one owner whose projections' rectangles meet, ascending; None if too many."""
    if not len(one) or not len(other):
        return np.empty(0, np.int64), np.empty(0, np.int64)
    trees = (BoxTree(*_rectangles(corners, owner)) for corners, owner in zip((one, other), owners, strict=True))
    over = _gathered(overlapping(*trees), MOST_PAIRS)
    if over is None:
        return None
    i, j = np.divmod(np.sort(over[0] * len(other) + over[1]), len(other))
    return i, j


def _gathered(near: Iterable[tuple[Int, Int, Any]], most: int) -> tuple[Int, Int] | None:
    """Return all pairs of triangles at once; None where there are more than `most`."""
    pairs, count = [], 0
    for i, j, _ in near:
        pairs.append((i, j))
        count += len(i)
        if count > most:
            return None
    i, j = (np.concatenate(side) for side in zip(*pairs, strict=True))
    return i, j


def _rectangles(corners: Float, owner: Int | float = 0) -> tuple[Float, Float]:
    """Return boxes around projections, each owner's at heights of its own."""
    low, high = _extents(corners)
    low[:, 2], high[:, 2] = 2 * owner, 2 * owner + 1
    return low, high


def _extents(corners: Float) -> tuple[Float, Float]:
    """Return the least and the largest coordinates (n, 3) of triangles, in a tenth of numpy's time along an axis."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def _under_both(one: Float, other: Float, i: Int, j: Int) -> tuple[float, float]:
    """Return Σ s_a s_b ∫∫ min(z_a⁺, z_b⁺) over pairs of triangles (k,), (k,), and what bounds its rounding.

    The bound is over the largest coordinate and the rounding of one step.
    """
    if len(i) == 0:
        return 0.0, 0.0
    if not _SUM.worthwhile(max(len(i), SHIPPED_ABOVE)):  # numpy takes as long for one pair as loading does
        parts = [slice(start, start + _AT_ONCE) for start in range(0, len(i), _AT_ONCE)]
        sums = [_vectorised(one[i[part]], other[j[part]]) for part in parts]
        return sum(volume for volume, _ in sums), sum(bound for _, bound in sums)
    tables = [np.ascontiguousarray(each) for each in (one, other, i, j)]
    work, results = np.empty((4, _CORNERS, 4)), np.zeros(3)
    first, second, *pairs = (address(table) for table in tables)
    _SUM.function(first, len(one), second, len(other), *pairs, len(i), address(work), address(results))
    return float(results[0] + results[1]), float(results[2])


def _vectorised(a: Float, b: Float) -> tuple[float, float]:
    """Return what `_under_both` does of triangles (k, 3, 3) in pairs."""
    low = np.maximum(*(np.minimum(np.minimum(k[:, 0], k[:, 1]), k[:, 2])[:, :2] for k in (a, b)))
    highest, other = (np.maximum(np.maximum(k[:, 0], k[:, 1]), k[:, 2]) for k in (a, b))
    breadth = (np.minimum(highest, other)[:, :2] - low).sum(axis=1)
    height = np.minimum(highest, other)[:, 2]
    total = 0.0
    signs, lower = _clipped_pairs(a, b)
    for polygons, pair in lower:
        part = signs[pair]
        if (polygons[:, :, 2] < 0).any():
            polygons, rest = _clipped(polygons, polygons[:, :, 2])
            part = part[rest]
        total += float((part * _integrals(polygons, 2)).sum())
    return total, float((breadth * (height + breadth)).sum())


_Lower = list[tuple[Float, Int]]


def _clipped_pairs(a: Float, b: Float) -> tuple[Float, _Lower]:
    """Return the signs s_a s_b of pairs of triangles, and where a is the lower one of two that lie over one another.

    Or both are one; and where b is. Each as polygons (m, w, 3), x, y and the height of the lower one, and their pairs.
    """
    (a, sign_a), (b, sign_b) = _upward(a), _upward(b)
    pair, polygons = np.arange(len(a)), a
    for k in range(3):
        start, end = b[pair, k, :2], b[pair, (k + 1) % 3, :2]
        along = end - start
        way = polygons[:, :, :2] - start[:, None]
        polygons, rest = _clipped(polygons, along[:, None, 0] * way[..., 1] - along[:, None, 1] * way[..., 0])
        pair = pair[rest]
    heights = _heights(b[pair], polygons[:, :, :2])
    difference = heights - polygons[:, :, 2]
    apart = np.flatnonzero((difference < 0).any(axis=1))
    under, first = _clipped(polygons, difference)
    above = np.concatenate([polygons[apart, :, :2], heights[apart, :, None]], axis=2)
    over, second = _clipped(above, -difference[apart])
    return sign_a * sign_b, [(under, pair[first]), (over, pair[apart[second]])]


def _upward(corners: Float) -> tuple[Float, Float]:
    """Return triangles turned so that they face up, and the signs of how they faced; 0 for those that are upright."""
    u, v = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
    sign = np.sign(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    turned = np.where((sign < 0)[:, None, None], corners[:, ::-1], corners)
    return turned, sign


def _clipped(polygons: Float, side: Float) -> tuple[Float, Int]:
    """Return the parts of convex polygons (k, m, c) where a linear function, (k, m) at the corners, is not negative.

    Parameters
    ----------
    polygons : x, y and whatever else is linear; where there are fewer corners than m, the last one is repeated

    Returns
    -------
    polygons, which : what is left, and of which polygons (Sutherland and Hodgman's algorithm)
    """
    after = np.roll(side, -1, axis=1)
    inside = side >= 0
    crosses = inside != (after >= 0)
    share = np.divide(side, side - after, out=np.zeros_like(side), where=crosses)
    between = polygons + share[..., None] * (np.roll(polygons, -1, axis=1) - polygons)
    count = inside.sum(axis=1) + crosses.sum(axis=1)
    which = np.flatnonzero(count > 2)
    if len(which) == 0:
        return polygons[:0], which
    slots = np.stack([polygons[which], between[which]], axis=2).reshape(len(which), -1, polygons.shape[2])
    used = np.stack([inside[which], crosses[which]], axis=2).reshape(len(which), -1)
    order = np.argsort(~used, axis=1, kind="stable")
    place = np.minimum(np.arange(count.max()), count[which, None] - 1)
    return np.take_along_axis(slots, np.take_along_axis(order, place, axis=1)[..., None], axis=1), which


def _heights(corners: Float, points: Float) -> Float:
    """Return the heights of triangles (k, 3, 3) over points (k, m, 2) in their projections, within their own."""
    origin = corners[:, :1]
    u, v = (corners[:, k, None] - origin for k in (1, 2))
    way = points - origin[..., :2]
    area = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    along_u = way[..., 0] * v[..., 1] - way[..., 1] * v[..., 0]
    along_v = u[..., 0] * way[..., 1] - u[..., 1] * way[..., 0]
    rise = along_u * u[..., 2] + along_v * v[..., 2]
    flat = area == 0
    height = origin[..., 2] + np.divide(rise, area, out=np.zeros_like(rise), where=~flat)
    heights: Float = np.clip(height, corners[..., 2].min(axis=1)[:, None], corners[..., 2].max(axis=1)[:, None])
    return heights


def _integrals(polygons: Float, channel: int) -> Float:
    """Return the integral of a linear function, given at the corners, over each convex polygon."""
    if polygons.shape[1] < 3:
        return np.zeros(len(polygons))
    x, y = ((polygons[:, :, k] - polygons[:, :1, k])[:, 1:] for k in (0, 1))
    areas = (x[:, :-1] * y[:, 1:] - y[:, :-1] * x[:, 1:]) / 2
    values = polygons[:, :, channel]
    means = (values[:, :1] + values[:, 1:-1] + values[:, 2:]) / 3
    integrals: Float = (areas * means).sum(axis=1)
    return integrals
