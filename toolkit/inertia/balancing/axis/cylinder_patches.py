"""Patches of a mesh that may be cylinders along a given direction: smooth walls whose vertices lie on a circle.

A facet is a wall where its normal is perpendicular to the direction; walls that share an edge at which the surface
turns by little are one patch.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.axis.cylinder_fit import across, circle
from inertia.mesh.geometry.edges import pair_edges
from inertia.mesh.geometry.faces import components, merge_equal_vertices
from inertia.mesh.surface import Triangles
from inertia.records import dataclass

_WALL = math.sin(math.radians(3.0))
_SMOOTH = math.cos(math.radians(35.0))  # a polygon of eleven sides or more is a circle
_TURNED = math.sin(math.radians(0.5))  # from which two normals tell an axis
_VOTES = 8
_BINS = 64  # a direction's components are counted in steps of 1/64
_SAME = math.cos(math.radians(1.0))
_FACING = 0.85  # mean of a wall's outward component at its middle: 0.96 for eleven sides
_LEAST_TURN = math.radians(30.0)  # of a wall that tells a circle


@dataclass(frozen=True, eq=False)
class Facets:
    """A welded mesh with what patches are made from.

    Attributes
    ----------
    vertices, faces : (n, 3), (m, 3)
    normals : (m, 3) unit, zero for a triangle without area
    areas : (m,)
    smooth : (k, 2) triangles that share an edge at which the surface turns by little
    """

    vertices: Float
    faces: Int
    normals: Float
    areas: Float
    smooth: Int

    @classmethod
    def of(cls, triangles: Triangles) -> Facets:
        """Weld a surface and pair its triangles."""
        vertices, faces = merge_equal_vertices(triangles)
        corners = vertices[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normals, axis=1)
        normals /= np.where(length > 0, length, 1.0)[:, None]
        edges = pair_edges(faces)
        first = (np.cumsum(edges.uses) - edges.uses)[edges.uses == 2]
        pairs = np.column_stack([edges.users[first], edges.users[first + 1]])
        turn = np.einsum("ij,ij->i", normals[pairs[:, 0]], normals[pairs[:, 1]])
        return cls(vertices, faces, normals, 0.5 * length, pairs[turn > _SMOOTH])


@dataclass(frozen=True, eq=False)
class Patch:
    """A wall whose vertices lie on a circle, seen along a direction.

    Attributes
    ----------
    faces : (f,) triangles
    vertices : (v,) their vertices
    center : (3,) of the circle, at the middle of the wall's height
    radius : of the circle
    area : of the triangles
    coverage : share of the full turn that the triangles take up about the centre
    bore : the material is outside the circle
    """

    faces: Int
    vertices: Int
    center: Float
    radius: float
    area: float
    coverage: float
    bore: bool


def directions(mesh: Facets) -> list[Float]:
    """Return unit vectors (3,) that walls may run along.

    They are found from the principal axes of the surface, from those of its normals' scatter, and from the directions
    that most neighbouring triangles turn about.
    """
    middles = mesh.vertices[mesh.faces].mean(axis=1)
    middles = middles - np.average(middles, axis=0, weights=mesh.areas)
    wide = [*np.linalg.eigh(_scatter(mesh.normals, mesh.areas))[1].T]
    wide += [*np.linalg.eigh(_scatter(middles, mesh.areas))[1].T]
    distinct: list[Float] = []
    for starts, within in ((wide, 40.0), (_turning_axes(mesh), 1.0)):
        for start in starts:
            direction = along_walls(mesh, start, within)
            if all(abs(direction @ other) < _SAME for other in distinct):
                distinct.append(direction)
    return distinct


def along_walls(mesh: Facets, direction: Float, within: float) -> Float:
    """Return a direction (3,) moved to where the normals nearly perpendicular to it are perpendicular best.

    What counts as nearly is `within` degrees at first, and half of that again and again down to one degree.
    """
    while True:
        near = np.abs(mesh.normals @ direction) < math.sin(math.radians(within))
        if not (mesh.areas[near] > 0).any():
            return direction
        direction = np.linalg.eigh(_scatter(mesh.normals[near], mesh.areas[near]))[1][:, 0]
        if within <= 1.0:
            return direction
        within = max(1.0, 0.5 * within)


def _turning_axes(mesh: Facets) -> list[Float]:
    """Return the directions that the most area turns about from one triangle to the next."""
    one, other = mesh.smooth.T
    axis = np.cross(mesh.normals[one], mesh.normals[other])
    length = np.linalg.norm(axis, axis=1)
    turned = length > _TURNED
    axis = axis[turned] / length[turned, None]
    if not len(axis):
        return []
    weight = np.minimum(mesh.areas[one], mesh.areas[other])[turned]
    axis *= np.where(axis @ [1.0, 1e-3, 1e-6] < 0, -1.0, 1.0)[:, None]
    _, first, place = np.unique(np.rint(_BINS * axis), axis=0, return_index=True, return_inverse=True)
    votes = np.bincount(place, weight)
    return [*axis[first[np.argsort(-votes, kind="stable")[:_VOTES]]]]


def patches(mesh: Facets, direction: Float, tolerance: float) -> list[Patch]:
    """Return the walls along a direction (3,) whose vertices lie within `tolerance` of a circle."""
    wall = (np.abs(mesh.normals @ direction) < _WALL) & (mesh.areas > 0)
    pairs = mesh.smooth[wall[mesh.smooth].all(axis=1)]
    label = components(pairs, len(mesh.faces))
    walls = np.flatnonzero(wall)
    walls = walls[np.argsort(label[walls], kind="stable")]
    starts = np.flatnonzero(np.diff(label[walls])) + 1
    candidates = (_patch(mesh, faces, direction, tolerance) for faces in np.split(walls, starts))
    return [patch for patch in candidates if patch is not None]


def _patch(mesh: Facets, faces: Int, direction: Float, tolerance: float) -> Patch | None:
    frame = across(direction)
    for _ in range(3):
        vertices = np.unique(mesh.faces[faces])
        if len(vertices) < 6:
            return None
        flat = mesh.vertices[vertices] @ frame
        fit = circle(flat)
        if fit is None:
            return None
        center, radius = fit
        off = np.abs(np.linalg.norm(flat - center, axis=1) - radius) > tolerance
        if not off.any():
            break
        # The foot of a fillet leaves the circle; the wall itself does not.
        on_circle = ~np.isin(mesh.faces[faces], vertices[off]).any(axis=1)
        if 2 * on_circle.sum() < len(faces):
            return None
        faces = faces[on_circle]
    else:
        return None
    height = mesh.vertices[vertices] @ direction
    middle = frame @ center + 0.5 * (height.min() + height.max()) * direction
    coverage = turn_covered(mesh, [faces], middle, direction)
    if 2.0 * math.pi * coverage < _LEAST_TURN:
        return None
    area = float(mesh.areas[faces].sum())
    outward = mesh.vertices[mesh.faces[faces]].mean(axis=1) - middle
    outward -= np.outer(outward @ direction, direction)
    turned = float(mesh.areas[faces] @ np.einsum("ij,ij->i", mesh.normals[faces], outward)) / (area * radius)
    if abs(turned) < _FACING:  # the corners of a flat strip lie on a circle, too
        return None
    return Patch(faces, vertices, middle, radius, area, coverage, turned < 0)


def turn_covered(mesh: Facets, groups: Sequence[Int], point: Float, direction: Float) -> float:
    """Return the share of the full turn that triangles take up, seen from an axis: the union of their angles."""
    corners = (mesh.vertices[mesh.faces[np.concatenate(groups)]] - point) @ across(direction)
    angle = np.arctan2(corners[..., 1], corners[..., 0])
    from_first = (angle - angle[:, :1] + math.pi) % (2.0 * math.pi) - math.pi
    start = (angle[:, 0] + from_first.min(axis=1)) % (2.0 * math.pi)
    stop = start + np.ptp(from_first, axis=1)
    over = stop > 2.0 * math.pi
    start = np.concatenate([start, np.zeros(over.sum())])
    stop = np.concatenate([np.minimum(stop, 2.0 * math.pi), stop[over] - 2.0 * math.pi])
    order = np.argsort(start)
    reached = np.maximum.accumulate(stop[order])
    gaps = np.maximum(0.0, start[order][1:] - reached[:-1]).sum()
    return float((reached[-1] - start[order][0] - gaps) / (2.0 * math.pi))


def _scatter(vectors: Float, weights: Float) -> Float:
    scatter: Float = (vectors * weights[:, None]).T @ vectors
    return scatter
