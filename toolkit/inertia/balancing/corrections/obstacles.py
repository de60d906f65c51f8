"""Surfaces of a part that its tools must stay away from: all but those that they enter.

A tool with the wall around it may hold no triangle of the part but those of the surface that it enters. All that the
two contain between them is then metal, as along the tool's axis, and the wall is there in every direction, whatever
lies between the rays of `room`: ribs, bores, tapped holes, keyways.

Of the surface that is entered are triangles that look out of the part and lie no deeper under it than the wall is
thick: its relief.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.tool import Tool
from inertia.balancing.corrections.workpiece import Body
from inertia.errors import GeometryError
from inertia.mesh.geometry.faces import merge_equal_vertices, repeated_corners
from inertia.mesh.manifold import exponent_of, solid, union
from inertia.mesh.surface import Surface
from inertia.records import dataclass

_TOUCHING = 2.0**-20  # m: bodies with a gap no wider than this are one wall
_ROUNDED = 1e-9  # of the radius: a wall may be thinner by this
_UPRIGHT = 1e-3  # cosine: walls that stand upright on a surface look out of the part as well


@dataclass(frozen=True, eq=False)
class Obstacles:
    """Triangles: `corners` (k, 3, 3) in shaft axes, m, and `normals` (k, 3), unit vectors out of the part."""

    corners: Float
    normals: Float

    @property
    def outward(self) -> Float:
        """The share of each normal that points away from the shaft, (k,)."""
        middle = self.corners[:, :, :2].mean(axis=1)
        length = np.maximum(np.linalg.norm(middle, axis=1), 1e-300)
        return np.asarray(np.einsum("ij,ij->i", self.normals[:, :2], middle) / length)


def wall_of(tool: Tool) -> float:
    """Return the wall that a tool has to leave, m, but for rounding."""
    return max(tool.plane.min_wall - _ROUNDED * tool.plane.radius, 0.0)


def obstacles(bodies: Sequence[Body], tool: Tool, enter: Float) -> Obstacles:
    """Return the triangles of a part, but for those of the surface that a plane's tools enter.

    Parameters
    ----------
    bodies : in shaft axes
    enter : m under the plane's surface, where metal begins at the angles looked at; nan where there is none
    """
    plane = tool.plane
    corners = _surface(tuple(bodies))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normals, axis=1)
    found = Obstacles(corners[size > 0], normals[size > 0] / size[size > 0, None])
    if tool.towards_shaft:
        depth, outward = plane.radius - np.linalg.norm(found.corners[:, :, :2], axis=2), found.outward
    else:
        sign = 1.0 if plane.face == "a" else -1.0
        depth, outward = sign * (found.corners[:, :, 2] - plane.entry), -sign * found.normals[:, 2]
    near = enter[np.isfinite(enter)]
    low, high = (float(near.min()), float(near.max())) if len(near) else (0.0, 0.0)
    relief = plane.min_wall + _ROUNDED * plane.radius
    entered = (outward >= -_UPRIGHT) & (depth.min(axis=1) >= low - relief) & (depth.max(axis=1) <= high + relief)
    return Obstacles(found.corners[~entered], found.normals[~entered])


@lru_cache(maxsize=1)
def _surface(bodies: tuple[Body, ...]) -> Float:
    """Return the triangles (n, 3, 3) of what bodies that touch are together."""
    pieces = [body.corners[piece] for body in bodies for piece in body.pieces]
    if len(pieces) == 1:
        return pieces[0]
    everything = np.concatenate(pieces)
    exponent = exponent_of(everything)
    try:
        # On a grid, what touches but for rounding does so exactly.
        whole = union([_solid(_TOUCHING * np.round(k / _TOUCHING), exponent) for k in pieces]).to_mesh64()
    except GeometryError:
        return everything  # tools then stay away from what the bodies have in common, too
    return np.asarray(np.ldexp(whole.vert_properties[:, :3], exponent)[whole.tri_verts.astype(np.int64)])


def _solid(corners: Float, exponent: int) -> Any:
    numbers = np.arange(3 * len(corners)).reshape(-1, 3)
    vertices, faces = merge_equal_vertices(Surface(corners.reshape(-1, 3), numbers))
    return solid(vertices, faces[~repeated_corners(faces)], exponent)
