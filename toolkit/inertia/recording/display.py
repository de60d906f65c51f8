"""What a body looks like on the screen: float32 about the centre of mass, in a unit near its own size."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from inertia.arrays import Float
from inertia.dynamics.kinematics import quaternion
from inertia.dynamics.scene.body import SceneBody
from inertia.recording.reduce import facet_normals, shown_triangles

STEEL = (150, 165, 185)
_THINNEST = 0.01  # of the largest semi-axis, for an equivalent ellipsoid that would be flat


@dataclass(frozen=True, eq=False)
class Display:
    """A body as it is shown, along part axes.

    Attributes
    ----------
    unit : m, a power of ten: one unit of the view
    radius : the body's largest distance from its centre of mass, in `unit`, 1 ≤ radius < 10
    triangles : (k, 3, 3) corners about the centre of mass, in `unit`; None where the body has no faces to show
    semi_axes : (3,) of the equivalent ellipsoid along its principal axes, in `unit`; None where triangles are shown
    attitude : (4,) principal axes to part axes
    said : what was done for display only, in sentences
    """

    unit: float
    radius: float
    triangles: Float | None
    semi_axes: Float | None
    attitude: Float
    said: tuple[str, ...]

    def archetypes(self, color: tuple[int, int, int] = STEEL) -> list[Any]:
        """Return what draws the body."""
        import rerun as rr

        if self.triangles is not None:
            normals = np.repeat(facet_normals(self.triangles), 3, axis=0)
            corners = self.triangles.reshape(-1, 3)
            return [
                rr.Mesh3D(
                    vertex_positions=corners.astype(np.float32),
                    vertex_normals=normals.astype(np.float32),
                    albedo_factor=color,
                )
            ]
        return [
            rr.Ellipsoids3D(
                half_sizes=[self.semi_axes],
                quaternions=[rr.Quaternion(xyzw=self.attitude)],
                colors=[color],
                fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
            )
        ]


def display_of(body: SceneBody) -> Display:
    """Return how a body is shown: its part, or the solid ellipsoid of the same moments where it has no part."""
    principal = body.body.principal
    attitude = quaternion.from_matrix(principal.axes)
    if body.part is not None:
        corners, count = shown_triangles(body.part, body.body.center_of_mass)
        if len(corners):
            unit, radius = _unit(float(np.linalg.norm(corners, axis=2).max()))
            said = (
                ()
                if len(corners) == count
                else (f"shown with {len(corners)} of its {count} triangles: near corners are merged, for display only",)
            )
            return Display(unit, radius, corners / unit, None, attitude, said)
    semi_axes = equivalent_ellipsoid(principal.moments, body.body.mass)
    unit, radius = _unit(float(semi_axes.max()))
    said = ("shown as the solid ellipsoid of the same moments",)
    if body.body.mass is None:
        said = (f"{said[0]}, of 1 kg as no mass is given",)
    return Display(unit, radius, None, semi_axes / unit, attitude, said)


def equivalent_ellipsoid(moments: Float, mass: float | None) -> Float:
    """Return the semi-axes (3,) in m of the uniform solid ellipsoid with these moments: a₁² = 5 (I₂ + I₃ − I₁)/2m.

    A flat body is given a little thickness, so that it can be seen from its edge; without a mass it has 1 kg.

    >>> equivalent_ellipsoid(np.array([0.4, 0.4, 0.4]), 1.0).round(12).tolist()
    [1.0, 1.0, 1.0]
    """
    squares = 2.5 * (moments.sum() - 2.0 * moments) / (mass or 1.0)
    semi_axes: Float = np.sqrt(np.maximum(squares, _THINNEST**2 * squares.max()))
    return semi_axes


def _unit(size: float) -> tuple[float, float]:
    """Return the power of ten below a size, and the size in it."""
    unit = 10.0 ** math.floor(math.log10(size))
    return unit, size / unit
