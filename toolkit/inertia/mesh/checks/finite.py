"""Where a surface holds a coordinate that is not a number, or infinite.

Reading does not scan a binary STL file; whoever integrates one sees a sum that is not finite and asks here.
"""

from __future__ import annotations

import numpy as np

from inertia.mesh.part import Facets, Triangles

_CHUNK = 65_536


def first_non_finite(triangles: Triangles) -> tuple[int, int] | None:
    """Return (triangle, corner 0 to 2) of the first NaN or infinite coordinate, or None.

    >>> from inertia.mesh.part import Surface
    >>> first_non_finite(Surface([[0, 0, 0], [1, 0, 0], [0, float("nan"), 0]], [[0, 1, 2]]))
    (0, 2)
    """
    corners = triangles.corners_f4 if isinstance(triangles, Facets) else triangles.corners
    for start in range(0, triangles.count, _CHUNK):
        stop = min(start + _CHUNK, triangles.count)
        finite = np.isfinite(corners(start, stop)).all(axis=2)
        triangles.release(start, stop)
        if not finite.all():
            face, corner = np.argwhere(~finite)[0]
            return start + int(face), int(corner)
    return None
