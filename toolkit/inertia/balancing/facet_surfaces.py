"""Cylinders and cones behind the facets of a mesh: patches grown from three facets, axes fitted to the vertices.

What is assumed is that vertices lie on the true surface, as those of CAD systems do. A patch is a cylinder or a cone
where the vertices of three facets or more, side by side, lie on one to within the rounding of the coordinates. A facet
that is far wider than all others of its patch is a true plane that was cut into it.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.balancing.axis.cylinder_fit import across
from inertia.mesh.geometry.edges import pair_edges
from inertia.mesh.geometry.faces import components
from inertia.records import dataclass

SHARP = math.radians(60.0)
"""Edges that turn by this or more are true ones."""

STORED = 2.0**-20
"""Rounding of coordinates, of the largest: eight roundings to float32, or seven digits of text."""

_ALIGNED = 0.05  # of the cosine between normals and the axis, along a patch
_FACING = 0.5  # cosine between a facet and the surface that it stands for
_WIDE = 2.5  # times as wide as the next: a true plane
_PLANES = 4  # of them in a patch at most
_STEPS = 12
_FAILURES = 100  # in a row, or patches of few facets, after which no further one is looked for
_FEW = 6
_NEIGHBOURS = 6
_WALK = 12  # facets
_TURNED = math.cos(math.radians(8.0))  # from where two normals tell an axis
_AHEAD = 0.9  # cosine between the first turn and all of them together: a flat cone turns back
_STRAIGHT = 0.7  # cosine between the turns from one facet to the next
_ATTEMPTS = 500
_WORK = 2e8  # attempts times triangles
_OPPOSITE = -0.5  # cosine between the turns to both sides of a facet
_LEAST = 7  # vertices that a cone is fitted to
_MOST = 4000


@dataclass(frozen=True, eq=False)
class FacetMesh:
    """A welded mesh, and how its triangles hang together.

    Attributes
    ----------
    vertices, faces : (n, 3) m, (m, 3)
    normals, areas : (m, 3) unit, zero for a triangle without area; (m,)
    ends, pairs : (e, 2) vertices and triangles of each edge of two triangles
    opposite : (e, 2) the third corner of either
    turn : (e,) rad, between the two normals
    flat : (e,) whether the two lie in one plane
    convex : (e,) 1 where the solid is convex there, −1 elsewhere
    plane : (m,) number of the coplanar patch of each triangle
    beside : (m, 3) edges of each triangle, −1 for those of any other number of triangles
    tolerance : m, within which a vertex counts as on a surface
    """

    vertices: Float
    faces: Int
    normals: Float
    areas: Float
    ends: Int
    pairs: Int
    opposite: Int
    turn: Float
    flat: Bool
    convex: Float
    plane: Int
    beside: Int
    tolerance: float

    @classmethod
    def of(cls, vertices: Float, faces: Int) -> FacetMesh:
        """Pair the triangles of a welded surface."""
        edges = pair_edges(faces)
        twice = edges.uses == 2
        start = (np.cumsum(edges.uses) - edges.uses)[twice]
        ends, pairs = edges.ends[twice], np.column_stack([edges.users[start], edges.users[start + 1]])
        corners = vertices[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        doubled = np.linalg.norm(normals, axis=1)
        normals /= np.where(doubled > 0, doubled, 1.0)[:, np.newaxis]
        opposite = faces[pairs].sum(axis=2) - ends.sum(axis=1)[:, np.newaxis]
        one, other = pairs.T
        sine = np.linalg.norm(np.cross(normals[one], normals[other]), axis=1)
        turn = np.arctan2(sine, np.einsum("ij,ij->i", normals[one], normals[other]))
        # The larger triangle tells its plane best; a sliver's own normal is noise.
        larger = doubled[one] >= doubled[other]
        base, off = np.where(larger, one, other), np.where(larger, opposite[:, 1], opposite[:, 0])
        height = np.einsum("ij,ij->i", vertices[off] - vertices[ends[:, 0]], normals[base])
        tolerance = STORED * float(np.abs(vertices).max(initial=0.0))
        flat = np.abs(height) <= 0.5 * tolerance
        beside = np.full(faces.shape, -1)
        number = np.arange(len(ends))
        for side in (0, 1):
            third = faces[pairs[:, side]] == opposite[:, side : side + 1]
            beside[pairs[:, side], third.argmax(axis=1)] = number
        return cls(
            vertices, faces, normals, 0.5 * doubled, ends, pairs, opposite, turn, flat, np.where(height > 0, -1.0, 1.0),
            components(pairs[flat], len(faces)), beside, tolerance,
        )  # fmt: skip

    def across_edges(self, triangles: Int, allowed: Bool) -> Int:
        """Return the triangles beyond the allowed edges (e,) of some triangles, each once."""
        edges = self.beside[triangles]
        owner = np.broadcast_to(triangles[:, np.newaxis], edges.shape)
        passable = (edges >= 0) & allowed[edges]
        edges, owner = edges[passable], owner[passable]
        return np.unique(self.pairs[edges].sum(axis=1) - owner)


@dataclass(frozen=True, eq=False)
class Cone:
    """A cone about an axis, or a cylinder: radius r = r₀ + k h at the height h above a point of the axis.

    Attributes
    ----------
    point, direction : (3,) m, on the axis, and unit
    radius, slope : r₀ in m, k
    worst, rms : m, of the distances of the vertices that it was fitted to
    """

    point: Float
    direction: Float
    radius: float
    slope: float
    worst: float = math.inf
    rms: float = math.inf

    def distance(self, points: Float) -> tuple[Float, Float]:
        """Return distances (n,) from the surface, outward, and the outward normals (n, 3) there."""
        local = points - self.point
        height = local @ self.direction
        flat = local - np.multiply.outer(height, self.direction)
        size = np.linalg.norm(flat, axis=1)
        cosine = 1.0 / math.sqrt(1.0 + self.slope**2)
        outward = flat / np.where(size > 0, size, 1.0)[:, np.newaxis]
        return (size - self.radius - self.slope * height) * cosine, (outward - self.slope * self.direction) * cosine


def recognise(mesh: FacetMesh) -> tuple[list[Cone], Int]:
    """Return the cylinders and cones of a mesh, and the number of that of each triangle (m,), −1 for none."""
    label = np.full(len(mesh.faces), -1)
    cones: list[Cone] = []
    smooth = mesh.turn < SHARP
    hinge = smooth & ~mesh.flat
    seeds = np.unique(mesh.pairs[hinge])
    seeds = seeds[np.argsort(-mesh.areas[seeds], kind="stable")]
    tried = np.zeros(len(mesh.faces), bool)
    failures = 0
    attempts = 0
    for seed in seeds.tolist():
        if label[seed] >= 0 or tried[seed]:
            continue
        attempts += 1
        if failures >= _FAILURES or attempts > min(_ATTEMPTS, _WORK / len(mesh.faces)):
            break
        facet = _facet_of(mesh, seed)
        tried[facet] = True
        patch = _largest_patch(mesh, facet, label, smooth, hinge)
        triangles = None if patch is None else _without_planes(mesh, patch[0], patch[1], hinge)
        if patch is None or triangles is None:
            failures += 1
            continue
        few = len(np.unique(mesh.plane[triangles])) < _FEW
        failures = failures + 1 if few else 0
        label[triangles] = len(cones)
        cones.append(patch[0])
    return cones, label


def _largest_patch(mesh: FacetMesh, facet: Int, label: Int, smooth: Bool, hinge: Bool) -> tuple[Cone, Int] | None:
    """Return the largest cone that a facet and two of its neighbours begin, with its triangles."""
    beyond = _beside(mesh, facet, label, hinge)
    walks = [_walked(mesh, facet, int(first), label, hinge) for first in beyond]
    best: tuple[Cone, Int] | None = None
    for k in range(len(walks)):
        for j in range(k):
            one, other = (mesh.normals[walks[n][-1]] - mesh.normals[facet[0]] for n in (j, k))
            axis = np.cross(one, other)
            size, both = float(np.linalg.norm(axis)), float(np.linalg.norm(one) * np.linalg.norm(other))
            if float(one @ other) > _OPPOSITE * both or size <= 1e-6 * both:
                continue
            start = np.unique(np.concatenate([facet, walks[j], walks[k]]))
            patch = _grown(mesh, start, axis / size, label, smooth, hinge)
            if patch is not None and (best is None or len(patch[1]) > len(best[1])):
                best = patch
    return best


def _beside(mesh: FacetMesh, facet: Int, label: Int, hinge: Bool) -> Int:
    """Return a triangle of each facet beside one, the largest first."""
    beyond = mesh.across_edges(facet, hinge)
    beyond = beyond[label[beyond] < 0]
    beyond = beyond[np.argsort(-mesh.areas[beyond], kind="stable")]
    _, first = np.unique(mesh.plane[beyond], return_index=True)
    return beyond[np.sort(first)][:_NEIGHBOURS]


def _walked(mesh: FacetMesh, facet: Int, first: int, label: Int, hinge: Bool) -> Int:
    """Return the triangles of facets from one on, straight ahead, until they have turned enough to tell an axis."""
    start = before = mesh.normals[facet[0]]
    parts = [_facet_of(mesh, first)]
    for _ in range(_WALK):
        here = mesh.normals[first]
        away, once = here - start, mesh.normals[parts[0][0]] - start
        if float(start @ here) < _TURNED or float(away @ once) < _AHEAD * float(
            np.linalg.norm(away) * np.linalg.norm(once)
        ):
            break
        ahead = _beside(mesh, parts[-1], label, hinge)
        ahead = ahead[~np.isin(ahead, np.concatenate([facet, *parts]))]
        turns = mesh.normals[ahead] - here
        size = np.linalg.norm(turns, axis=1) * np.linalg.norm(here - before)
        # A facet may lie beside itself, across a bore through it: that is no way ahead.
        straight = np.divide(turns @ (here - before), size, out=np.full(len(turns), -1.0), where=size > 0)
        if not len(ahead) or straight.max() < _STRAIGHT:
            break
        first, before = int(ahead[straight.argmax()]), here
        parts.append(_facet_of(mesh, first))
    return np.concatenate([*parts[:-1], parts[-1][parts[-1] != first], [first]])


def _facet_of(mesh: FacetMesh, seed: int) -> Int:
    """Return the triangles of the facet that a triangle belongs to, or a thousand of them."""
    facet = front = np.array([seed])
    while len(front) and len(facet) < 1000:
        front = np.setdiff1d(mesh.across_edges(front, mesh.flat), facet)
        facet = np.concatenate([facet, front])
    return facet


def _grown(mesh: FacetMesh, start: Int, axis: Float, label: Int, smooth: Bool, hinge: Bool) -> tuple[Cone, Int] | None:
    """Grow a patch whose normals keep their angle with an axis, for as long as its vertices lie on one cone."""
    inside = np.zeros(len(mesh.faces), bool)
    inside[start] = True
    patch, front, rings = start, start, 4
    cosine, allowed = _leaning(mesh, start, axis)
    while len(np.unique(mesh.faces[patch])) < _LEAST:  # at the tip of a cone, three facets have five
        front = mesh.across_edges(front, smooth)
        front = front[~inside[front] & (label[front] < 0)]
        front = front[np.abs(mesh.normals[front] @ axis - cosine) < allowed]
        if not len(front):
            return None
        inside[front] = True
        patch = np.concatenate([patch, front])
    cone: Cone | None = None
    certain = patch
    while True:
        fit = _fitted(mesh, patch, inside, hinge, axis, cone)
        if fit is None or fit.worst > mesh.tolerance:
            break
        cone, axis, certain = fit, fit.direction, patch
        cosine, allowed = _leaning(mesh, patch, axis)
        for _ in range(rings):
            front = mesh.across_edges(front, smooth)
            front = front[~inside[front] & (label[front] < 0)]
            front = front[np.abs(mesh.normals[front] @ axis - cosine) < allowed]
            inside[front] = True
            patch = np.concatenate([patch, front])
            if not len(front):
                break
        if len(patch) == len(certain):
            break
        rings *= 2
    if cone is None:
        return None
    if fit is not None and fit.worst <= mesh.tolerance:
        return cone, certain
    certain = _on_cone(mesh, cone, certain, label, smooth)
    inside[:] = False
    inside[certain] = True
    fit = _fitted(mesh, certain, inside, hinge, cone.direction, cone)
    return (fit or cone), certain


def _leaning(mesh: FacetMesh, patch: Int, axis: Float) -> tuple[float, float]:
    """Return the cosine between the normals of a patch and an axis, and by how much it may differ along the patch."""
    cosine = float(np.mean(mesh.normals[patch] @ axis))
    return cosine, _ALIGNED * max(math.sqrt(max(0.0, 1.0 - cosine**2)), 1e-2)


def _on_cone(mesh: FacetMesh, cone: Cone, start: Int, label: Int, smooth: Bool) -> Int:
    """Return the triangles that hang together with some and have their vertices on a cone."""
    inside = np.zeros(len(mesh.faces), bool)
    inside[start] = True
    parts, front = [start], start
    while len(front):
        front = mesh.across_edges(front, smooth)
        front = front[~inside[front] & (label[front] < 0)]
        off, outward = cone.distance(mesh.vertices[mesh.faces[front]].reshape(-1, 3))
        outward = outward.reshape(-1, 3, 3).sum(axis=1)
        fits = (np.abs(off).reshape(-1, 3) <= mesh.tolerance).all(axis=1)
        front = front[fits & (np.abs(np.einsum("ij,ij->i", mesh.normals[front], outward)) > 3.0 * _FACING)]
        inside[front] = True
        parts.append(front)
    return np.concatenate(parts)


def _fitted(mesh: FacetMesh, patch: Int, inside: Bool, hinge: Bool, axis: Float, near: Cone | None) -> Cone | None:
    """Return the cone through the vertices of a patch by Gauss-Newton: least Σ (ρ − r₀ − k h)²."""
    points = mesh.vertices[np.unique(mesh.faces[patch])]
    if len(points) < _LEAST:
        return None
    middle = points.mean(axis=0)
    size = float(np.abs(points - middle).max())
    every = -(-len(points) // _MOST)
    local = (points[::every] - middle) / size
    if near is None:
        point = _center(mesh, patch, inside, hinge, axis)
        if point is None:
            return None
        point = (point - middle) / size
    else:
        point = (near.point - middle) / size
    direction = axis
    radius = slope = 0.0
    for step_number in range(_STEPS):
        frame = across(direction)
        point = point - direction * (point @ direction)
        height = local @ direction
        flat = (local - point) @ frame
        reach = np.linalg.norm(flat, axis=1)
        tip = reach <= 1e-3 * reach.max()  # of a cone, which has no outward direction
        outward = np.where(tip[:, np.newaxis], 0.0, flat / np.where(tip, 1.0, reach)[:, np.newaxis])
        line = np.column_stack([np.ones(len(height)), height])
        if step_number == 0:
            radius, slope = np.linalg.lstsq(line, reach, rcond=None)[0].tolist()
        residual = reach - radius - slope * height
        jacobian = np.hstack([-outward, -outward * height[:, np.newaxis] - slope * flat, -line])
        if tip.any():  # the tip lies on the axis
            rows = np.zeros((2 * int(tip.sum()), 6))
            rows[0::2, 0] = rows[1::2, 1] = -1.0
            rows[0::2, 2] = rows[1::2, 3] = -height[tip]
            jacobian = np.concatenate([jacobian, rows])
            residual = np.concatenate([residual, flat[tip].ravel()])
        # Two parallel lines of vertices leave the slope and the tilt open: the least step is taken.
        step = np.linalg.lstsq(jacobian, -residual, rcond=1e-12)[0]
        point = point + frame @ step[:2]
        direction = direction + frame @ step[2:4]
        direction = direction / np.linalg.norm(direction)
        radius, slope = radius + float(step[4]), slope + float(step[5])
        if not np.isfinite(step).all() or abs(slope) > 1e3:
            return None
        if np.abs(step).max() < 1e-12:
            break
    shift = float(point @ direction)
    cone = Cone(middle + size * (point - shift * direction), direction, size * (radius - slope * shift), slope)
    off, _ = cone.distance(points)
    return replace(cone, worst=float(np.abs(off).max()), rms=float(np.sqrt(np.mean(off**2))))


def _center(mesh: FacetMesh, patch: Int, inside: Bool, hinge: Bool, axis: Float) -> Float | None:
    """Return the point that the planes between neighbouring facets meet in, across an axis."""
    edges = np.unique(mesh.beside[patch])
    edges = edges[edges >= 0]
    edges = edges[hinge[edges] & inside[mesh.pairs[edges]].all(axis=1)]
    frame = across(axis)
    between = mesh.normals[mesh.pairs[edges]].sum(axis=1) @ frame
    length = np.linalg.norm(between, axis=1)
    if not (length > 0).any():
        return None
    normal = np.column_stack([-between[:, 1], between[:, 0]])[length > 0] / length[length > 0, np.newaxis]
    middle = mesh.vertices[mesh.ends[edges[length > 0]]].mean(axis=1)
    place = middle.mean(axis=0)
    solution, _, rank, _ = np.linalg.lstsq(normal, np.einsum("ij,ij->i", normal, (middle - place) @ frame), rcond=1e-6)
    return None if rank < 2 else place + frame @ solution


def _without_planes(mesh: FacetMesh, cone: Cone, triangles: Int, hinge: Bool) -> Int | None:
    """Return a patch without the few facets far wider than the others; None where less than three facets stay."""
    corners = mesh.vertices[mesh.faces[triangles]] - cone.point
    flat = corners @ across(cone.direction)
    angle = np.arctan2(flat[..., 1], flat[..., 0])
    away = (angle - angle[:, :1] + math.pi) % (2.0 * math.pi) - math.pi
    facets, number = np.unique(mesh.plane[triangles], return_inverse=True)
    start = np.full(len(facets), np.nan)
    start[number[::-1]] = angle[::-1, 0]
    shift = (angle[:, 0] - start[number] + math.pi) % (2.0 * math.pi) - math.pi
    low, high = np.full(len(facets), np.inf), np.full(len(facets), -np.inf)
    np.minimum.at(low, number, (away + shift[:, np.newaxis]).min(axis=1))
    np.maximum.at(high, number, (away + shift[:, np.newaxis]).max(axis=1))
    width = high - low
    order = np.argsort(-width, kind="stable")
    most = min(_PLANES, len(order) - 1)
    ratio = width[order[:most]] / np.maximum(width[order[1 : most + 1]], 1e-12)
    planes = order[: int(np.flatnonzero(ratio >= _WIDE).max(initial=-1)) + 1]
    stays = np.ones(len(facets), bool)
    stays[planes] = False
    left = triangles[stays[number]]
    edges = np.unique(mesh.beside[left])
    edges = edges[edges >= 0]
    edges = edges[hinge[edges]]
    within = mesh.pairs[edges][np.isin(mesh.pairs[edges], left).all(axis=1)]
    left = left[np.isin(mesh.plane[left], mesh.plane[within])]
    return left if len(np.unique(mesh.plane[left])) >= 3 else None
