"""Sheets as the solids that they are: their surface with half the thickness on either side of it."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import GeometryError
from inertia.mesh.geometry.faces import components, merge_equal_vertices, repeated_corners
from inertia.mesh.geometry.halfedges import half_edges
from inertia.mesh.geometry.triangle_pairs import unit_normals
from inertia.mesh.repairs.orientation import inconsistent
from inertia.mesh.surface import Surface

_SMOOTH = 1e-2  # of the largest eigenvalue: normals that differ by less are one, and a sharp edge has no longer tip
_OFF = 0.5  # share by which the volume may differ from area times thickness


def thickened(corners: Float, thickness: float) -> Float | None:
    """Return the closed surface (k, 3, 3) around a sheet; None where its curvature or its folds leave no room for it.

    A vertex moves by the d for which n·d is half the thickness for the normals n of all its triangles, so that flat
    walls keep their thickness up to their edges. Where more than two triangles meet in an edge, the sheet ends.

    Parameters
    ----------
    corners : (m, 3, 3), wound in any way
    thickness : in the unit of the corners

    >>> square = np.array([[[0, 0, 0], [2, 0, 0], [2, 2, 0]], [[0, 0, 0], [2, 2, 0], [0, 2, 0]]], float)
    >>> solid = thickened(square, 0.5)
    >>> solid.shape, solid.min(axis=(0, 1)).tolist(), solid.max(axis=(0, 1)).tolist()
    ((12, 3, 3), [0.0, 0.0, -0.25], [2.0, 2.0, 0.25])
    """
    vertices, faces = merge_equal_vertices(Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)))
    faces = faces[~repeated_corners(faces)]
    try:
        turned = inconsistent(vertices, faces, half_edges(faces))
    except GeometryError:  # one-sided
        return None
    faces = np.where(turned[:, None], faces[:, ::-1], faces)
    edges = half_edges(faces)
    inner = edges.uses[edges.edge] == 2
    one, other = edges.by_edge[inner[edges.by_edge]].reshape(-1, 2).T
    after = np.arange(3 * len(faces)).reshape(-1, 3)[:, [1, 2, 0]].ravel()
    fan = components(
        np.concatenate([np.column_stack([one, after[other]]), np.column_stack([after[one], other])]), len(after)
    )
    first, own = np.unique(fan, return_inverse=True)  # a vertex of its own for each fan of triangles
    points, faces = vertices[faces.ravel()[first]], own.astype(np.int64).reshape(-1, 3)
    way = _outwards(points, faces) * (thickness / 2)
    top, bottom = points + way, points - way
    rim = np.flatnonzero(~inner)
    a, b = faces.ravel()[rim], faces.ravel()[after[rim]]
    solid = np.concatenate(
        [
            top[faces],
            bottom[faces[:, ::-1]],
            np.stack([top[b], top[a], bottom[a]], axis=1),
            np.stack([top[b], bottom[a], bottom[b]], axis=1),
        ]
    )
    middle = points.mean(axis=0)
    volume = float(np.linalg.det(solid - middle).sum()) / 6
    area = float(np.linalg.norm(_doubled_areas(points[faces]), axis=1).sum()) / 2
    return solid if abs(volume - area * thickness) <= _OFF * area * thickness else None


def _outwards(points: Float, faces: Int) -> Float:
    """Return (n, 3) how far each vertex moves where its triangles move by 1 along their normals, in least squares."""
    normals = unit_normals(points[faces])
    sides = points[np.roll(faces, -1, axis=1)] - points[faces]
    back = -np.roll(sides, 1, axis=1)
    angles = np.arctan2(np.linalg.norm(np.cross(sides, back), axis=2), np.einsum("fkx,fkx->fk", sides, back))
    weights = angles[..., None] * normals[:, None]
    sums, squares = np.zeros((len(points), 3)), np.zeros((len(points), 3, 3))
    np.add.at(sums, faces, weights)
    np.add.at(squares, faces, weights[..., None] * normals[:, None, None])
    moves: Float = np.einsum("nij,nj->ni", np.linalg.pinv(squares, rcond=_SMOOTH, hermitian=True), sums)
    return moves


def _doubled_areas(corners: Float) -> Float:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
