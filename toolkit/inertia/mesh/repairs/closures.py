"""The closures that the rim of a filled hole admits: how much volume may lie between the filling and the lost surface.

A filling is one closure of its rim; which one the part had, the rim does not tell. Taken as possible is every surface
over the rim that keeps

* under the planes of the triangles at the rim, continued beyond it until they meet, and nowhere farther from the
  filling than the diagonal of the box around what is left of the part (a cone has its tip, and a tube goes on; of a
  convex part, all that was lost lies there);
* or within 45° of the filling as seen from the rim, outward and inward, where these planes leave less room than that;
* or within the convex hull of the rim. A rim that comes back near itself, as that of a crack does, is cut there, along
  the edges of the filling that are ten times shorter than the way along the rim: counted are the hulls of the pieces.

The first two are one room, measured in columns; the third is added. Along a crack, a rim that is fifty times as long as
its filling is broad, the planes tell nothing, but the rim itself may be displaced by that breadth, with the triangles
at it: that is added too. Nor do the planes of a fin, whose filling is its other side.

The room is measured in columns at right angles to the triangles of the filling. Over each place x of it, with normal
n, the plane of a rim triangle (a point y, normal m) is z = m·(y − x) / m·n high, and none if it is as steep as a wall;
a column is as high as the lowest of max(z, |y − x|) over the rim, and as deep as the lowest of max(−z, |y − x|). Walls
that lean outward on average widen the columns, as they would a truncated cone of that height.

What lies farther out, a spike under a small hole for instance, no rim can tell, and is not counted.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.mesh.doubt import Doubt
from inertia.mesh.geometry.halfedges import HalfEdges
from inertia.mesh.geometry.triangle_pairs import unit

_PARTS = 6  # in which the sides of a triangle are split, its parts being the places where the room is measured
_PLACES = 5_000  # places of a filling, about, at most
_RIM = 500  # edges of a rim that are looked at: to leave some out makes the room no smaller
_PAIRS = 200_000  # pairs of a place and an edge at a time
_WALL = 1e-9  # cosine between the normals of a filling and of a wall
_LEAN = 1.5  # tangent of the angle, at most, by which walls lean outward
_FLAT = 1e-9  # area of a rim triangle without a normal, over its rim edge squared
_NEAR = 0.1  # length of an edge of the filling along which a rim is cut, over the way along the rim
_SLIT = 0.02  # breadth of a crack, over the length of its rim
_THIN = 1e-12  # of the size of a hull: what rounding makes of a plane one


def closures(
    vertices: Float, faces: Int, edges: HalfEdges, loop: list[int], filling: Int, size: float, *, small: bool = False
) -> Doubt:
    """Return the room that the rim of one filled hole leaves to other closures.

    Parameters
    ----------
    vertices : (n, 3)
    faces : (m, 3), those there were
    edges : theirs
    loop : the directed edges along the rim, see `inertia.mesh.repairs.holes.rims`
    filling : (k, 3), the new faces
    size : the diagonal of the box around the part, in file units
    small : whether closures stay over the filling, and no farther from it than the rim is broad
    """
    corners = vertices[filling]
    areas = _vector_areas(corners)
    around = faces[np.array(loop) // 3]
    thin = breadth(vertices, edges.head[loop], filling) > 0 or _lies_on(filling, around)
    start, end = vertices[edges.head[loop]], vertices[edges.tail[loop]]
    beside = vertices[around]
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
    lean = min(spread / rise, _LEAN) if rise > 0 and spread > 0 and not (thin or small) else 0.0
    size = min(size, float(np.linalg.norm(np.ptp(vertices[edges.head[loop]], axis=0)))) if small else size

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
        if thin:
            height[:] = 0.0
        for side, sign in enumerate((1, -1)):
            heights[side, part] = np.minimum(size, np.maximum(sign * height, distance).min(axis=1))
    outward, inward = area * heights
    radius = np.sqrt(area.sum() / np.pi)
    wider = radius + size * lean
    outward *= (radius**2 + radius * wider + wider**2) / (3 * radius**2) if lean and radius else 1.0
    # Root mean squares: of a column's height, and of the distance from the centroid of a triangle with such sides.
    spread_out = np.sqrt(((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=(1, 2)) / 36) / parts
    reach = heights.max(axis=0) * (1 + lean if lean else 3**-0.5) + np.repeat(spread_out, len(weights))
    columns = Doubt(places, outward, inward, reach)
    hulls = [hull(vertices[piece]) for piece in _pieces(vertices, edges.head[loop], filling)]
    whole = Doubt.joined([columns, *hulls])
    assert whole is not None
    return whole


def _lies_on(filling: Int, around: Int) -> bool:
    """Say whether a filling does no more than give the triangles around it a second side, as that of a fin does."""
    there = set(map(tuple, np.sort(around, axis=1).tolist()))
    return all(tuple(face) in there for face in np.sort(filling, axis=1).tolist())


def _pieces(vertices: Float, rim: Int, filling: Int) -> list[Int]:
    """Return the rim (n,), cut along the edges of its filling that are much shorter than the way along it."""
    place = {vertex: k for k, vertex in enumerate(rim.tolist())}
    if len(place) < len(rim) or len(rim) < 4 or not np.isin(filling, rim).all():
        return [rim]
    sides = np.sort(np.concatenate([filling[:, [0, 1]], filling[:, [1, 2]], filling[:, [2, 0]]]), axis=1)
    inner, count = np.unique(sides, axis=0, return_counts=True)
    chords = [sorted((place[a], place[b])) for a, b in inner[count == 2].tolist()]
    points = vertices[rim]
    loops, pieces = [(list(range(len(rim))), chords)], []
    while loops:
        loop, inside = loops.pop()
        if inside:
            own = {k: at for at, k in enumerate(loop)}
            way = np.linalg.norm(np.roll(points[loop], -1, axis=0) - points[loop], axis=1)
            along = np.concatenate([[0.0], np.cumsum(way)])
            start, end = np.array([[own[a], own[b]] for a, b in inside]).T
            between = np.abs(along[end] - along[start])
            arc = np.minimum(between, along[-1] - between)
            length = np.linalg.norm(points[[a for a, _ in inside]] - points[[b for _, b in inside]], axis=1)
            share = np.divide(length, arc, out=np.ones_like(arc), where=arc > 0)
            best = int(share.argmin())
            if share[best] < _NEAR:
                low, high = sorted((int(start[best]), int(end[best])))
                for part in (loop[low : high + 1], loop[high:] + loop[: low + 1]):
                    members = set(part)
                    rest = [c for k, c in enumerate(inside) if k != best and c[0] in members and c[1] in members]
                    loops.append((part, rest))
                continue
        pieces.append(rim[loop])
    return pieces


def hull(points: Float) -> Doubt | None:
    """Return the doubt about all of the convex hull of points (n, 3); None where it is flat."""
    if len(points) < 4:
        return None
    middle = points.mean(axis=0)
    turned = np.linalg.svd(points - middle, full_matrices=False)[2]
    local = (points - middle) @ turned.T
    low, high = local.min(axis=0), local.max(axis=0)
    sides = high - low
    if sides.min() <= _THIN * sides.max():
        return None
    if len(points) == 4:
        return Doubt.anywhere_in(points[None])
    from scipy.spatial import ConvexHull, QhullError

    try:  # stretched to a cube, so that a shallow hull is no special case
        facets = ConvexHull((local - low) / sides)
    except QhullError:
        box = np.stack([middle + low @ turned, middle + high @ turned])
        half = float(np.linalg.norm(sides)) / 2
        volume = np.array([float(np.prod(sides))])
        return Doubt(box.mean(axis=0)[None], volume, volume, np.array([half]), volume)
    corners = points[facets.simplices]
    apex = np.broadcast_to(points[facets.vertices].mean(axis=0), (len(corners), 1, 3))
    return Doubt.anywhere_in(np.concatenate([corners, apex], axis=1))


def breadth(vertices: Float, rim: Int, filling: Int) -> float:
    """Return how broad a crack is, at most; 0 of a hole that is none."""
    corners = vertices[filling]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    doubled = 2 * np.linalg.norm(_vector_areas(corners), axis=1)
    most = float(np.divide(doubled, longest, out=np.zeros_like(longest), where=longest > 0).max())
    length = np.linalg.norm(vertices[rim] - vertices[np.roll(rim, 1)], axis=1).sum()
    return most if most <= _SLIT * length else 0.0


def displaced(vertices: Float, faces: Int, moves: Float) -> Doubt | None:
    """Return what it does to a surface that each of its vertices may lie as far away as `moves` (n,) says."""
    thickness = moves[faces].max(axis=1)
    which = thickness > 0
    return Doubt.anywhere_in(vertices[faces[which]], thickness[which]) if which.any() else None


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
