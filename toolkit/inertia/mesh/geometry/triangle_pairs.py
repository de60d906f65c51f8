"""Crossing pairs of triangles, decided by the exact sign of the orientation determinant.

Two triangles cross when their planes differ and their interiors share a line segment. Contact is no crossing:
a vertex on a face, an edge on an edge or along a face, faces in one plane. The test is that of P. Guigue and
O. Devillers, "Fast and robust triangle-triangle overlap test using orientation predicates", Journal of
Graphics Tools 8 (2003): on the line that the planes have in common, either triangle has an interval, and the
order of their ends is read from exact signs.

On which side of a plane a point lies, floating point decides wherever its error bound allows; the few cases that
remain are decided in integers. The bound is that of J. R. Shewchuk, "Adaptive precision floating-point arithmetic
and fast robust geometric predicates", Discrete & Computational Geometry 18 (1997) 305, the first stage of ORIENT3D
(figure 23), with a term for underflow.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int
from inertia.native import Kernel, address, place

Sign = NDArray[np.int8]

UNSURE = 2
"""What `orient3d_filter` returns where floating point does not decide."""

LARGEST = 2.0**300
"""The largest coordinate that kernels decide exact signs of: products of three such numbers are numbers."""

_EPSILON = 2.0**-53
_RELATIVE = (7 + 56 * _EPSILON) * _EPSILON  # error, over the same sum with every product taken positive
_UNDERFLOW = 2.0**-1070  # more than the products together lose when they fall below the normal numbers
_ROWS = 1 << 15  # decided in integers at a time

_SIGNS = Kernel("inertia.mesh.geometry.pair_kernel", "orient_points", "piippp")
_CROSS = Kernel("inertia.mesh.geometry.pair_kernel", "cross_pairs", "pippi" + "pppp")
_PART = Kernel("inertia.mesh.geometry.pair_kernel", "part_pairs", "pippi" + "pp")
_WORK = 10  # times what integrating a triangle costs, in integers
_ROOM = 256  # numbers that the kernel needs


def orient3d(a: Float, b: Float, c: Float, d: Float) -> Sign:
    """Return the sign of (b − a) × (c − a) · (d − a), exactly.

    Parameters
    ----------
    a, b, c, d : (..., 3), finite; they are broadcast against each other

    Returns
    -------
    sign : (...) int8, +1 where d lies on the side that the normal (b − a) × (c − a) points to, −1 on the
        other side, 0 in the plane or where abc has no area

    >>> orient3d(*np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.2, 1e-300]]))
    array(1, dtype=int8)
    """
    points = a, b, c, d
    shape = np.broadcast_shapes(*(point.shape for point in points))
    sign = _compiled(points, shape[:-1], 1)
    if sign is None:
        sign = orient3d_filter(*points)
    unsure = sign == UNSURE
    if unsure.any():
        sign[unsure] = _exactly(np.stack([np.broadcast_to(point, shape)[unsure] for point in points]))
    return sign


def _exactly(points: Float) -> Sign:
    """Return the sign for columns of four points (4, n, 3), compiled where that pays and integers need not be long."""
    sign = _compiled(points, points.shape[1:2], _WORK)
    if sign is None:
        return _in_integers(points.transpose(1, 0, 2))
    unsure = sign == UNSURE
    if unsure.any():
        sign[unsure] = _in_integers(points.transpose(1, 0, 2)[unsure])
    return sign


def _compiled(points: Iterable[Float], shape: tuple[int, ...], work: int) -> Sign | None:
    """Return what `orient3d` does, or `UNSURE`, by a kernel; None where it does not pay or reads no such tables.

    `work` is how many times as long it takes as integrating a triangle, without the kernel.
    """
    if len(shape) > 2 or not _SIGNS.worthwhile(work * math.prod(shape)):
        return None
    places, sign = np.zeros((4, 4), np.int64), np.empty(shape, np.int8)
    for row, point in zip(places, points, strict=True):
        steps = [step if size > 1 else 0 for size, step in zip(point.shape, point.strides, strict=True)]
        if point.dtype != np.float64 or min(steps) < 0 or any(step % 8 for step in steps):
            return None
        row[4 - len(steps) :] = steps
        row //= 8
        row[0] = point.ctypes.data
    rows, columns = (1, 1, *shape)[-2:]
    room = np.empty((4, 3)), np.empty(_ROOM)
    _SIGNS.function(address(places), rows, columns, *map(address, room), place(sign))
    return sign


def orient3d_filter(a: Float, b: Float, c: Float, d: Float) -> Sign:
    """Return what `orient3d` does where floating point decides, and `UNSURE` elsewhere."""
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        u, v, w = (np.moveaxis(point - a, -1, 0) for point in (b, c, d))
        determinant = permanent = np.zeros(())
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            left, right = u[j] * v[k], u[k] * v[j]
            determinant = determinant + w[i] * (left - right)
            permanent = permanent + np.abs(w[i]) * (np.abs(left) + np.abs(right))
        bound = _RELATIVE * permanent + _UNDERFLOW * (1 + np.abs(w).sum(axis=0))
        sign = np.sign(determinant)
        # Comparing this way round, what has overflowed is unsure.
        decided = np.abs(determinant) > bound
    return np.where(decided, sign, UNSURE).astype(np.int8)


def _in_integers(points: Float) -> Sign:
    """Return the sign for rows of four points (n, 4, 3), scaled to integers of any length."""
    sign = np.empty(len(points), np.int8)
    for start in range(0, len(points), _ROWS):
        mantissa, exponent = np.frexp(points[start : start + _ROWS])
        least = np.where(mantissa != 0, exponent, np.iinfo(np.int32).max).min(axis=(1, 2), keepdims=True)
        shift = np.where(mantissa != 0, exponent - least, 0)
        whole = np.ldexp(mantissa, 53).astype(np.int64).astype(object) << shift.astype(object)
        u, v, w = (whole[:, 1:] - whole[:, :1]).transpose(1, 2, 0)
        determinant = sum(w[i] * (u[j] * v[k] - u[k] * v[j]) for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)))
        sign[start : start + _ROWS] = (determinant > 0).astype(np.int8) - (determinant < 0)
    return sign


def crossing(vertices: Float, faces_a: Int, faces_b: Int) -> tuple[Int, Float]:
    """Return which pairs of welded faces (k, 3) cross, and the middles of the segments that they share."""
    which = np.flatnonzero(cross_signs(vertices, faces_a, faces_b))
    crossed, middles = _crossing(vertices, faces_a[which], faces_b[which])
    return which[crossed], middles


def cross_signs(vertices: Float, faces_a: Int, faces_b: Int) -> Sign:
    """Say which pairs of faces (k, 3) cross, welded or not, as far as a kernel tells: 1, 0, or `UNSURE`."""
    sign = np.full(len(faces_a), UNSURE, np.int8)
    if _CROSS.worthwhile(len(sign)):
        tables = [np.ascontiguousarray(table) for table in (vertices, faces_a, faces_b)]
        points, one, other = map(place, tables)
        work = np.empty((2, 9)), np.empty(_ROOM), np.empty(6, np.int64)
        _CROSS.function(points, len(vertices), one, other, len(sign), *map(address, work), place(sign))
    return sign


def parted(vertices: Float, faces_a: Int, faces_b: Int) -> Bool:
    """Say of which pairs of faces (k, 3) floating point shows that the plane of one holds both apart."""
    if _PART.worthwhile(len(faces_a)):
        tables = [np.ascontiguousarray(table) for table in (vertices, faces_a, faces_b)]
        points, one, other = map(place, tables)
        own, apart = np.empty((2, 9)), np.empty(len(faces_a), bool)
        _PART.function(points, len(vertices), one, other, len(apart), address(own), place(apart))
        return apart
    apart = np.zeros(len(faces_a), bool)
    for plane, others in ((faces_a, faces_b), (faces_b, faces_a)):
        left = np.flatnonzero(~apart)
        side = _sides(orient3d_filter, vertices[others[left]], vertices[plane[left]])
        apart[left] = (side == 1).all(axis=1) | (side == -1).all(axis=1)
    return apart


def _crossing(vertices: Float, faces_a: Int, faces_b: Int) -> tuple[Int, Float]:
    shared = faces_a[:, :, None] == faces_b[:, None, :]
    pair = np.flatnonzero(shared.sum(axis=(1, 2)) < 2)
    sides: list[Sign] = []
    for points, plane, axis in ((faces_a, faces_b, 2), (faces_b, faces_a, 1)):
        side = _sides(orient3d_filter, vertices[points[pair]], vertices[plane[pair]])
        side[shared[pair].any(axis=axis)] = 0
        straddles = ((side > 0) | (side == UNSURE)).any(axis=1) & ((side < 0) | (side == UNSURE)).any(axis=1)
        pair, sides = pair[straddles], [*(earlier[straddles] for earlier in sides), side[straddles]]
    side_a, side_b = sides
    a, b = vertices[faces_a[pair]], vertices[faces_b[pair]]
    for side, corners, others in ((side_a, a, b), (side_b, b, a)):
        unsure = (side == UNSURE).any(axis=1)
        side[unsure] = _sides(orient3d, corners[unsure], others[unsure])
    cut = np.ones(len(pair), bool)
    for side in (side_a, side_b):
        cut &= (side > 0).any(axis=1) & (side < 0).any(axis=1)
    pair, a, b, side_a, side_b = pair[cut], a[cut], b[cut], side_a[cut], side_b[cut]
    a, up_a = _lone_first(a, side_a)
    b, up_b = _lone_first(b, side_b)
    # Seen from either plane, let the corner that is alone on its side be above.
    a[~up_b] = a[~up_b][:, [0, 2, 1]]
    b[~up_a] = b[~up_a][:, [0, 2, 1]]
    meet = orient3d(a[:, 0], a[:, 1], b[:, 0], b[:, 1]) < 0
    meet &= orient3d(a[:, 0], a[:, 2], b[:, 2], b[:, 0]) < 0
    return pair[meet], _middles(a[meet], b[meet])


def heights_over(corners: Float, normals: Float, others: Float) -> Float:
    """Return the heights (k, 3) of the corners of triangles `others` (k, 3, 3) over planes of triangles (k, 3, 3)."""
    over: Float = np.einsum("kci,ki->kc", others - corners[:, :1], normals)
    return over


def held_apart(over: Float, margin: float) -> Bool:
    """Say where three heights (k, 3) are farther than a margin on one side."""
    least = np.minimum(np.minimum(over[:, 0], over[:, 1]), over[:, 2])
    most = np.maximum(np.maximum(over[:, 0], over[:, 1]), over[:, 2])
    apart: Bool = (least > margin) | (most < -margin)
    return apart


def _sides(predicate: Callable[[Float, Float, Float, Float], Sign], points: Float, planes: Float) -> Sign:
    """Return on which sides of triangles' planes (k, 3, 3) the corners of others (k, 3, 3) are, (k, 3)."""
    return predicate(planes[:, None, 0], planes[:, None, 1], planes[:, None, 2], points)


def _lone_first(corners: Float, side: Sign) -> tuple[Float, NDArray[np.bool_]]:
    """Turn triangles so that a corner that is alone on its side comes first, and say whether it is above."""
    alone = (side != 0) & (side * np.roll(side, 1, axis=1) <= 0) & (side * np.roll(side, 2, axis=1) <= 0)
    lone = alone.argmax(axis=1)[:, None]
    turned = np.take_along_axis(corners, ((lone + np.arange(3)) % 3)[:, :, None], axis=1)
    return turned, np.take_along_axis(side, lone, axis=1)[:, 0] > 0


def _middles(a: Float, b: Float) -> Float:
    """Return the middles of the segments shared by triangles whose first corners are alone on their sides."""
    origin = a[:, :1]
    a, b = a - origin, b - origin
    normal_a, normal_b = unit_normals(a), unit_normals(b)
    ends = []
    for corners, other, normal in ((a, b, normal_b), (b, a, normal_a)):
        height = np.einsum("kij,kj->ki", corners - other[:, :1], normal)
        drop = height[:, :1] - height[:, 1:]
        share = np.divide(height[:, :1], drop, out=np.full_like(drop, 0.5), where=drop != 0)
        ends.append(corners[:, :1] + np.clip(share, 0, 1)[:, :, None] * (corners[:, 1:] - corners[:, :1]))
    points = np.concatenate(ends, axis=1)
    along = np.einsum("kij,kj->ki", points, np.cross(normal_a, normal_b))
    inner = np.argsort(along, axis=1)[:, 1:3, None]
    middles: Float = np.take_along_axis(points, inner, axis=1).mean(axis=1) + origin[:, 0]
    return middles


def unit_normals(corners: Float) -> Float:
    """Return unit normals (k, 3); zero where a triangle has no area."""
    return unit(np.cross(unit(corners[:, 1] - corners[:, 0]), unit(corners[:, 2] - corners[:, 0])))


def unit(vectors: Float) -> Float:
    """Return vectors at unit length; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: Float = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)
    return unit
