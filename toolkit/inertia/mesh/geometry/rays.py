"""Ray casting: the stretches of a ray that lie inside a closed surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float

_EDGE = 1e-12  # of a triangle's size: how far beside it a ray still counts as hitting it
_GRAZING = 1e-14  # sine of the angle to a triangle's plane, under which the ray runs in the plane
_SAME = 1e-9  # of the farthest hit: two hits of one surface that are no farther apart are one, at an edge


def inside(corners: Float, origin: ArrayLike, direction: ArrayLike) -> Float:
    """Return the stretches (k, 2) of the ray origin + t direction, t ≥ 0, that lie inside a closed surface.

    The surface faces outward. A ray that starts inside has a first stretch from 0; one that only grazes the surface
    has none there.

    Parameters
    ----------
    corners : (n, 3, 3)
    origin : (3,)
    direction : (3,), a unit vector

    >>> from inertia.mesh.cut import block
    >>> inside(block([0, 0, 0], np.eye(3)).corners(), [-2, 0.5, 0.25], [1, 0, 0]).tolist()
    [[2.0, 3.0]]
    """
    start, along = np.asarray(origin, float), np.asarray(direction, float)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(u, v)
    facing = normal @ along
    met = np.flatnonzero(np.abs(facing) > _GRAZING * np.linalg.norm(normal, axis=1))
    u, v, normal, facing = u[met], v[met], normal[met], facing[met]
    offset = start - corners[met, 0]
    turned = np.cross(offset, along)
    a = -np.einsum("ij,ij->i", turned, v) / facing
    b = np.einsum("ij,ij->i", turned, u) / facing
    t = -np.einsum("ij,ij->i", offset, normal) / facing
    hit = (np.minimum(a, b) >= -_EDGE) & (a + b <= 1 + _EDGE) & (t >= 0)
    order = np.argsort(t[hit])
    distances, leaves = t[hit][order], facing[hit][order] > 0
    stretches: list[tuple[float, float]] = []
    entered = 0.0 if len(leaves) and leaves[0] else None
    same = _SAME * float(distances.max(initial=0.0))
    for distance, leaving in zip(distances.tolist(), leaves.tolist(), strict=True):
        if not leaving and entered is None:
            entered = distance
        elif leaving and entered is not None:
            if distance - entered > same:
                stretches.append((entered, distance))
            entered = None
    return np.array(stretches).reshape(-1, 2)
