"""The area of the outside of a volume mesh."""

from __future__ import annotations

import math

import numpy as np

from inertia.arrays import Float, Int
from inertia.mass.cells.shape_functions import table
from inertia.mass.cells.shapes import KINDS, volume_blocks
from inertia.mesh.geometry.edges import first_equal
from inertia.mesh.part import Cells

_CHUNK = 4096


def boundary_area(cells: Cells) -> float:
    """Return the area of the faces that only one volume cell uses, in the file's unit².

    Faces are the same where their corners are, nodes with equal coordinates counting as one. Flat triangles
    have their closed form; other faces are integrated by Gauss's rule with 6 × 6 points over their own map,
    which is exact but for rounding for flat quadrilaterals, and for curved faces limited by how smooth they
    are.

    >>> from inertia.mesh.part import CellBlock
    >>> points = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    >>> cube = CellBlock("hexahedron", np.array([[0, 1, 3, 2, 4, 5, 7, 6]]))
    >>> round(boundary_area(Cells(points, (cube,))), 12)
    6.0
    """
    blocks = volume_blocks(cells)
    if not blocks:
        return 0.0
    welded = first_equal((cells.points + 0.0).view(np.int64))
    faces = [(kind, block.nodes[:, nodes]) for _, block in blocks for kind, nodes in KINDS[block.kind].faces]
    first = first_equal(np.concatenate([_key(welded[nodes[:, : KINDS[kind].corners]]) for kind, nodes in faces]))
    single = np.bincount(first, minlength=len(first))[first] == 1
    parts, start = [], 0
    for kind, nodes in faces:
        outside = nodes[single[start : start + len(nodes)]]
        start += len(nodes)
        parts += [_area(cells.points, kind, outside[i : i + _CHUNK]) for i in range(0, len(outside), _CHUNK)]
    return math.fsum(parts)


def _key(corners: Int) -> Int:
    """Return the corners of each face in ascending order, (m, 4), the last repeated until there are four.

    So a quadrilateral with two corners in one place is the same as the triangle on its other side.
    """
    key = np.sort(np.pad(corners, ((0, 0), (0, 4 - corners.shape[1])), mode="edge"), axis=1)
    key[:, 1:] = np.where(key[:, 1:] == key[:, :-1], key[:, -1:], key[:, 1:])
    return np.sort(key, axis=1)


def _area(points: Float, kind: str, nodes: Int) -> float:
    shape = table(kind)
    edges = points[nodes] - points[nodes[:, :1]]
    u, v = np.einsum("aqn,fnx->afqx", shape.slopes[:, : len(shape.weights)], edges)
    return float((np.linalg.norm(np.cross(u, v), axis=2) @ shape.weights).sum())
