"""The convex hull of points, as triangles."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float


def convex_hull(points: Float) -> Float | None:
    """Return the triangles (k, 3, 3) of the convex hull of points (n, 3), wound outwards; None for what is flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(np.unique(points, axis=0))
    except (QhullError, ValueError):
        return None
    corners = hull.points[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
    corners[inward] = corners[inward, ::-1]
    return np.ascontiguousarray(corners)
