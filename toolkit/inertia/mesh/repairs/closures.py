"""The closures that the rim of a filled hole admits: how much volume may lie between the filling and the lost surface.

A filling is one closure of its rim; which one the part had, the rim does not tell. Taken as possible is every surface
over the rim that keeps

* under the planes of the triangles at the rim, continued beyond it until they meet, and nowhere farther from the
  filling than the diagonal of the box around what is left of the part (a cone has its tip, and a tube goes on; of a
  convex part, all that was lost lies there);
* or within 45° of the filling as seen from the rim, outward and inward, where these planes leave less room than that.

The room is measured in columns at right angles to the triangles of the filling. Over each place x of it, with normal
n, the plane of a rim triangle (a point y, normal m) is z = m·(y − x) / m·n high, and none if it is as steep as a wall;
a column is as high as the lowest of max(z, |y − x|) over the rim, and as deep as the lowest of max(−z, |y − x|). Walls
that lean outward on average widen the columns, as they would a truncated cone of that height.

What lies farther out, a spike under a small hole for instance, no rim can tell, and is not counted.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.mesh.geometry.halfedges import HalfEdges
from inertia.mesh.geometry.triangle_pairs import unit
from inertia.mesh.part import Doubt

_PARTS = 6  # in which the sides of a triangle are split, its parts being the places where the room is measured
_PLACES = 5_000  # places of a filling, about, at most
_RIM = 500  # edges of a rim that are looked at: to leave some out makes the room no smaller
_PAIRS = 200_000  # pairs of a place and an edge at a time
_WALL = 1e-9  # cosine between the normals of a filling and of a wall
_LEAN = 1.5  # tangent of the angle, at most, by which walls lean outward
_FLAT = 1e-9  # area of a rim triangle without a normal, over its rim edge squared


def closures(vertices: Float, faces: Int, edges: HalfEdges, loop: list[int], filling: Int, size: float) -> Doubt:
    """Return the room that the rim of one filled hole leaves to other closures.

    Parameters
    ----------
    vertices : (n, 3)
    faces : (m, 3), those there were
    edges : theirs
    loop : the directed edges along the rim, see `inertia.mesh.repairs.holes.rims`
    filling : (k, 3), the new faces
    size : the diagonal of the box around the part, in file units
    """
    corners = vertices[filling]
    areas = _vector_areas(corners)
    start, end = vertices[edges.head[loop]], vertices[edges.tail[loop]]
    beside = vertices[faces[np.array(loop) // 3]]
    normals = _vector_areas(beside)
    along = end - start
    usable = np.linalg.norm(normals, axis=1) > _FLAT * (along**2).sum(axis=1)
    usable &= np.arange(len(loop)) % -(-len(loop) // _RIM) == 0
    start, along, beside = start[usable], along[usable], beside[usable]
    normals = unit(normals[usable])
    leaving = np.cross(normals, along)  # in the plane of a rim triangle, away from it, as long as its edge
    leaving *= np.sign(np.einsum("ij,ij->i", leaving, start - beside.mean(axis=1)))[:, None]
    upward = unit(areas.sum(axis=0))
    rise = float((leaving @ upward).sum())
    spread = -float(np.einsum("ij,ij->", leaving, unit(np.cross(upward, along))))
    lean = min(spread / rise, _LEAN) if rise > 0 and spread > 0 else 0.0

    parts = min(_PARTS, max(1, round((_PLACES / len(filling)) ** 0.5)))
    weights = _places(parts)
    places = np.einsum("sk,tkc->tsc", weights, corners).reshape(-1, 3)
    area = np.repeat(np.linalg.norm(areas, axis=1) / len(weights), len(weights))
    over = np.repeat(unit(areas), len(weights), axis=0)
    heights = np.full((2, len(places)), size)
    step = max(1, _PAIRS // max(1, len(start)))
    for first in range(0, len(places), step) if len(start) else ():
        part = slice(first, first + step)
        way = start - places[part, None]
        at = np.clip(-np.einsum("xij,ij->xi", way, along) / (along**2).sum(axis=1), 0, 1)
        distance = np.linalg.norm(way + at[..., None] * along, axis=2)
        cosine = over[part] @ normals.T
        wall = cosine <= _WALL
        height = np.einsum("xij,ij->xi", way, normals) / np.where(wall, 1, cosine)
        height[wall] = np.inf if rise > 0 else -np.inf
        for side, sign in enumerate((1, -1)):
            heights[side, part] = np.minimum(size, np.maximum(sign * height, distance).min(axis=1))
    outward, inward = area * heights
    radius = np.sqrt(area.sum() / np.pi)
    wider = radius + size * lean
    outward *= (radius**2 + radius * wider + wider**2) / (3 * radius**2) if lean and radius else 1.0
    # Root mean squares: of a column's height, and of the distance from the centroid of a triangle with such sides.
    spread_out = np.sqrt(((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=(1, 2)) / 36) / parts
    reach = heights.max(axis=0) * (1 + lean if lean else 3**-0.5) + np.repeat(spread_out, len(weights))
    return Doubt(places, outward, inward, reach)


def _places(parts: int) -> Float:
    """Return the centroids, as weights of the corners, of the triangles that a triangle is split in, (parts², 3)."""
    i, j = np.divmod(np.arange(parts**2), parts)
    upright = np.column_stack([i, j])[i + j < parts] + 1 / 3
    upturned = np.column_stack([i, j])[i + j < parts - 1] + 2 / 3
    two = np.concatenate([upright, upturned]) / parts
    return np.column_stack([two, 1 - two.sum(axis=1)])


def _vector_areas(corners: Float) -> Float:
    areas: Float = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    return areas
