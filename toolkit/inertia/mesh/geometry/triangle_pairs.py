"""Which pairs of triangles cross, and where.

Two triangles cross when their planes differ and their interiors share a line segment. Contact is no crossing:
a vertex on a face, an edge on an edge or along a face, faces in one plane. The test is that of P. Guigue and
O. Devillers, "Fast and robust triangle-triangle overlap test using orientation predicates", Journal of
Graphics Tools 8 (2003): on the line that the planes have in common, either triangle has an interval, and the
order of their ends is read from exact signs (`inertia.mesh.geometry.predicates`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.mesh.geometry.predicates import UNSURE, Sign, orient3d, orient3d_filter


def crossing(vertices: Float, faces_a: Int, faces_b: Int) -> tuple[Int, Float]:
    """Return which pairs of welded faces (k, 3) cross, and the middles of the segments that they share."""
    shared = faces_a[:, :, None] == faces_b[:, None, :]
    pair = np.flatnonzero(shared.sum(axis=(1, 2)) < 2)
    sides: list[Sign] = []
    for points, plane, axis in ((faces_a, faces_b, 2), (faces_b, faces_a, 1)):
        side = _sides(orient3d_filter, vertices[points[pair]], vertices[plane[pair]])
        side[shared[pair].any(axis=axis)] = 0
        kept = ((side > 0) | (side == UNSURE)).any(axis=1) & ((side < 0) | (side == UNSURE)).any(axis=1)
        pair, sides = pair[kept], [*(earlier[kept] for earlier in sides), side[kept]]
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
