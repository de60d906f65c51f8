"""The parts of a body that changes its shape, as they are shown: along assembly axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.models.deforming.assembly import JointedBody
from inertia.dynamics.models.deforming.joints import JointedPart
from inertia.mass.principal import principal
from inertia.mesh.part import Part
from inertia.recording.display import equivalent_ellipsoid
from inertia.recording.reduce import facet_normals, shown_triangles

COLORS = ((150, 165, 185), (200, 150, 110), (130, 180, 140), (190, 140, 180), (180, 175, 120), (120, 170, 190))
_POINT = 0.05  # of the body, the radius of a part that is a point


@dataclass(frozen=True, eq=False)
class Solid:
    """A part.

    Attributes
    ----------
    center : (3,) m, its centre of mass
    radius : m, how far from there it reaches
    triangles : (k, 3, 3) m about the centre of mass; None where it has no faces to show
    semi_axes : (3,) m, of the ellipsoid that is shown then
    attitude : (4,) that takes the ellipsoid's axes to assembly axes
    said : what was done for display only
    """

    center: Float
    radius: float
    triangles: Float | None
    semi_axes: Float
    attitude: Float
    said: str = ""

    def archetypes(self, unit: float, number: int) -> list[Any]:
        """Return what draws it, in units of `unit` m, in the colour of its number."""
        import rerun as rr

        color = COLORS[number % len(COLORS)]
        if self.triangles is not None:
            corners = (self.triangles + self.center).reshape(-1, 3) / unit
            normals = np.repeat(facet_normals(self.triangles), 3, axis=0)
            return [
                rr.Mesh3D(
                    vertex_positions=corners.astype(np.float32),
                    vertex_normals=normals.astype(np.float32),
                    albedo_factor=color,
                )
            ]
        return [
            rr.Ellipsoids3D(
                half_sizes=[self.semi_axes / unit],
                centers=[self.center / unit],
                quaternions=[rr.Quaternion(xyzw=self.attitude)],
                colors=[color],
                fill_mode=rr.components.FillMode.Solid,
            )
        ]


def solids_of(assembly: JointedBody, meshes: Sequence[Part | None]) -> list[Solid]:
    """Return the parts as shown: their meshes, or the solid ellipsoids of the same moments; a point is a sphere."""
    files = meshes or [None] * len(assembly.parts)
    found = [_solid(part, mesh) for part, mesh in zip(assembly.parts, files, strict=True)]
    place = np.stack([solid.center for solid in found])
    size = max(solid.radius for solid in found) or float(np.ptp(place, axis=0).max())
    return [solid if solid.radius else _point(solid.center, _POINT * size) for solid in found]


def _solid(part: JointedPart, mesh: Part | None) -> Solid:
    center = np.asarray(part.center_of_mass)
    if mesh is not None:
        triangles, count = shown_triangles(mesh, center)
        if len(triangles):
            said = "" if len(triangles) == count else f"shown with {len(triangles)} of its {count} triangles"
            radius = float(np.linalg.norm(triangles, axis=2).max())
            return Solid(center, radius, triangles, np.zeros(3), np.asarray(quaternion.IDENTITY), said)
    own = principal(part.inertia)
    semi_axes = equivalent_ellipsoid(own.moments, part.mass)
    return Solid(center, float(semi_axes.max()), None, semi_axes, quaternion.from_matrix(own.axes))


def _point(center: Float, radius: float) -> Solid:
    return Solid(center, radius, None, np.full(3, radius), np.asarray(quaternion.IDENTITY))
