"""Sheets as the solids that they are: the union of the prisms of their triangles, half the thickness on either side."""

from __future__ import annotations

from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.mesh.geometry.triangle_pairs import unit_normals
from inertia.mesh.manifold import solid, union
from inertia.mesh.repairs.weld import clusters

MOST_PRISMS = 5_000
"""Prisms that are united: some ten seconds where the sheet is curved."""

STEP = 2.0**-34
"""To which coordinates of prisms are rounded, of the scale of `manifold.solid`. In planes that differ by rounding alone
manifold3d may lose whole prisms."""

_WELDED = STEP / 16  # corners of neighbours in a plane, which are off by rounding
_FACES = np.array([[0, 1, 2], [3, 4, 5], [1, 0, 5], [1, 5, 4], [2, 1, 4], [2, 4, 3], [0, 2, 3], [0, 3, 5]])


def sides(corners: Float, thickness: float) -> Float:
    """Return both sides (k, 2, 3, 3) of the prisms of a sheet's triangles that have an area, facing outwards.

    Corner i of one side lies opposite corner 2 − i of the other, also where both are turned to face the other way.

    Parameters
    ----------
    corners : (m, 3, 3), wound in any way
    thickness : in the unit of the corners

    >>> sides(np.array([[[0, 0, 0], [2, 0, 0], [0, 2, 0]]], float), 0.5)[0, :, :, 2].tolist()
    [[0.25, 0.25, 0.25], [-0.25, -0.25, -0.25]]
    """
    normals = unit_normals(corners)
    flat = normals.any(axis=1)
    corners, way = corners[flat], normals[flat, None] * (thickness / 2)
    return np.stack([corners + way, corners[:, ::-1] - way], axis=1)


def united(prisms: Float, exponent: int) -> Any:
    """Return the solid of manifold3d that prisms (k, 2, 3, 3) of a sheet are together, its coordinates times 2⁻ᵉ."""
    points = np.ldexp(prisms.reshape(-1, 3), -exponent)
    if len(points):
        points = np.round(points[clusters(points, _WELDED)] / STEP) * STEP
    corners = points.reshape(-1, 6, 3)
    volumes = np.linalg.det(corners[:, [1, 2, 5]] - corners[:, :1]) * -1.0
    return union([solid(each, _FACES, 0) for each in corners[volumes > 0]])
