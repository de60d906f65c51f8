"""Triangles in the place of faces, and how far each is from the face that it stands for.

How far follows from the face, where it is a plane, a cylinder, a cone, a sphere or a torus; elsewhere it is not known.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from OCP import BRep, BRepMesh, BRepTools, IMeshTools, TopAbs, TopExp, TopLoc

from inertia.arrays import Float, Int
from inertia.mesh.readers.opencascade.kernel import bounds_something, cast, kind_of, parts_of, shape_map
from inertia.mesh.shape import Patch
from inertia.records import dataclass

_BETWEEN_SAMPLES = 9 / 8


@dataclass(frozen=True, eq=False)
class Facets:
    """Vertices (n, 3), triangles (m, 3), how far each is off (m,), NaN where it is not known, and faces without any."""

    vertices: Float
    triangles: Int
    distances: Float
    missing: int

    @property
    def closed(self) -> bool:
        """Whether every edge has two sides."""
        first, second = (np.concatenate([self.triangles[:, k] for k in order]) for order in ((0, 1, 2), (1, 2, 0)))
        count = len(self.vertices)
        return np.array_equal(np.sort(first * count + second), np.sort(second * count + first))


def triangulated(
    body: Any, faces: list[Any], patches: list[Patch | None], closed: bool, linear: float, angular: float
) -> Facets:
    """Put triangles in the place of the faces of a body.

    Parameters
    ----------
    body : shape
    faces : of the body
    patches : the surfaces of the faces
    closed : whether its faces are
    linear : sag relative to the length of an edge
    angular : angle in radians
    """
    kinds = IMeshTools.IMeshTools_MeshAlgoType
    parameters = IMeshTools.IMeshTools_Parameters()
    parameters.Deflection, parameters.Relative, parameters.Angle = linear, True, angular
    parameters.InParallel = False
    # A plane with 100 holes takes 0.7 s by the first and 14 s by the second, which fails less often.
    for parameters.MeshAlgo in (kinds.IMeshTools_MeshAlgoType_Delabella, kinds.IMeshTools_MeshAlgoType_Watson):
        BRepTools.BRepTools.Clean_s(body)
        BRepMesh.BRepMesh_IncrementalMesh(body, parameters)
        facets = _facets(faces, patches)
        if not facets.missing and (facets.closed or not closed):
            break
    return facets


def _facets(faces: list[Any], patches: list[Patch | None]) -> Facets:
    """Return the triangles that faces have, those of faces that share an edge with the same vertices along it."""
    points: list[Float] = []
    triangles: list[Int] = []
    runs: list[tuple[int, Patch | None]] = []
    seams = _Seams()
    count = missing = 0
    for face, patch in zip(faces, patches, strict=True):
        at = TopLoc.TopLoc_Location()
        mesh = BRep.BRep_Tool.Triangulation_s(face, at)
        if mesh is None or not mesh.NbTriangles():
            missing += 1
            continue
        nodes = np.array([(p.X(), p.Y(), p.Z()) for p in map(mesh.Node, range(1, mesh.NbNodes() + 1))])
        if not at.IsIdentity():
            nodes = placed(nodes, matrix(at.Transformation()))
        corners = np.array([mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)], np.int64) - 1
        if face.Orientation() == TopAbs.TopAbs_REVERSED:
            corners = corners[:, ::-1]
        seams.add(face, mesh, at, count)
        points.append(nodes)
        triangles.append(corners + count)
        runs.append((len(corners), patch))
        count += len(nodes)
    if not points:
        return Facets(np.empty((0, 3)), np.empty((0, 3), np.int64), np.empty(0), missing)
    vertices, corners = np.concatenate(points), seams.first_of(count)[np.concatenate(triangles)]
    distances, at_triangle = [], 0
    for length, patch in runs:
        distances.append(_distances(patch, vertices[corners[at_triangle : at_triangle + length]]))
        at_triangle += length
    flat = (corners == np.roll(corners, 1, axis=1)).any(axis=1)  # at the pole of a sphere
    corners, distance = corners[~flat], np.concatenate(distances)[~flat]
    own, places = np.unique(corners, return_inverse=True)
    return Facets(vertices[own], places.reshape(-1, 3), distance, missing)


def matrix(motion: Any) -> Float:
    """Return a transformation as (3, 4)."""
    return np.array([[motion.Value(i, j) for j in range(1, 5)] for i in range(1, 4)])


def placed(points: Float, placement: Float) -> Float:
    """Return points where a placement (3, 4) puts them."""
    moved: Float = points @ placement[:, :3].T + placement[:, 3]
    return moved


class _Seams:
    """Which nodes of the meshes of faces are one: those along an edge, and at a vertex."""

    def __init__(self) -> None:
        self._edges, self._vertices = shape_map(), shape_map()
        self._along: dict[int, Int] = {}
        self._at: dict[int, int] = {}
        self._same: list[Int] = []

    def add(self, face: Any, mesh: Any, at: Any, first: int) -> None:
        """Take in the mesh of a face, whose nodes are counted from `first`."""
        face = cast(face.Oriented(TopAbs.TopAbs_FORWARD), "Face")
        for wire in parts_of(face):
            for edge in parts_of(wire) if kind_of(wire) == "WIRE" else ():
                if kind_of(edge) != "EDGE" or not bounds_something(edge):
                    continue
                edge = cast(edge, "Edge")
                polygon = BRep.BRep_Tool.PolygonOnTriangulation_s(edge, mesh, at)
                if polygon is None:
                    continue
                nodes = np.array([polygon.Node(i) for i in range(1, polygon.NbNodes() + 1)], np.int64) + (first - 1)
                if BRep.BRep_Tool.Degenerated_s(edge):
                    self._pair(nodes, np.full_like(nodes, nodes[0]))
                along = self._along.setdefault(int(self._edges.Add(edge)), nodes)
                if len(along) == len(nodes):
                    self._pair(along, nodes)
                forward = cast(edge.Oriented(TopAbs.TopAbs_FORWARD), "Edge")
                ends = TopExp.TopExp.FirstVertex_s(forward), TopExp.TopExp.LastVertex_s(forward)
                for vertex, node in zip(ends, nodes[[0, -1]].tolist(), strict=True):
                    if not vertex.IsNull():
                        one = self._at.setdefault(int(self._vertices.Add(vertex)), node)
                        self._pair(np.array([one]), np.array([node]))

    def _pair(self, some: Int, others: Int) -> None:
        self._same.append(np.stack([some, others], axis=1))

    def first_of(self, count: int) -> Int:
        """Return the first of those that are one with each node."""
        first = np.arange(count)
        pairs = np.concatenate(self._same) if self._same else np.empty((0, 2), np.int64)
        pairs = pairs[pairs[:, 0] != pairs[:, 1]]
        while True:
            before = first.copy()
            least = first[pairs].min(axis=1)
            for column in pairs.T:
                np.minimum.at(first, column, least)
            first = first[first]
            if np.array_equal(first, before):
                return first


def _distances(patch: Patch | None, corners: Float) -> Float:
    """Return how far triangles (m, 3, 3) are from the surface that they stand for, NaN where it is not one of the five.

    A triangle with corners on a surface is off by a quadratic form that vanishes at the corners, up to terms of higher
    order. Where the curvatures have one sign, an affine map makes the form that of a sphere: the largest distance, at
    the centre of the circumscribed circle or in the middle of the longest edge, is at most 9/8 of that at the centroid
    or there. Where they have two, it lies in the middle of an edge.
    """
    if patch is None or patch.kind not in _SURFACES:
        return np.full(len(corners), np.nan)
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    points = np.concatenate([corners, middles, corners.mean(axis=1, keepdims=True)], axis=1) - patch.frame[0]
    along = points @ patch.frame[3]
    across = np.linalg.norm(points - along[..., None] * patch.frame[3], axis=-1)
    off = _BETWEEN_SAMPLES * np.abs(_SURFACES[patch.kind](across, along, *patch.sizes)).max(axis=1)
    return np.asarray(off)


_SURFACES: dict[str, Callable[..., Float]] = {
    "plane": lambda across, along: along,
    "cylinder": lambda across, along, radius: across - radius,
    "cone": lambda across, along, radius, angle: np.minimum(
        np.abs((across - radius) * np.cos(angle) - along * np.sin(angle)),
        np.abs((across + radius) * np.cos(angle) + along * np.sin(angle)),
    ),
    "sphere": lambda across, along, radius: np.hypot(across, along) - radius,
    "torus": lambda across, along, major, minor: np.hypot(across - major, along) - minor,
}
"""By the distances of a point from the axis and along it: how far it is from the surface."""
