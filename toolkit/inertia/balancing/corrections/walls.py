"""What is under a tool: which material, and how far it goes on before there is a void."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.corrections.tool import Tool
from inertia.errors import GeometryError
from inertia.mesh.geometry.rays import inside
from inertia.mesh.part import Part

_TOUCHING = 1e-6  # m: bodies with a gap no wider than this are one wall
_PROUD = 0.01  # of the radius: how far the part may stand out of it


@dataclass(frozen=True, eq=False)
class Body:
    """A body's triangles (n, 3, 3) in shaft axes and m, their boxes (n, 3), its own (2, 3), and its density, kg/m³."""

    corners: Float
    low: Float
    high: Float
    box: Float
    density: float


def bodies(parts: Sequence[Part], densities: Sequence[float], shaft: Shaft) -> tuple[Body, ...]:
    """Bring parts into shaft axes."""
    found = []
    for part, density in zip(parts, densities, strict=True):
        corners = shaft.to_shaft(part.triangles.corners() * float(part.unit.metres))
        low, high = corners.min(axis=1), corners.max(axis=1)
        found.append(Body(corners, low, high, np.stack([low.min(axis=0), high.max(axis=0)]), density))
    return tuple(found)


def run(found: Sequence[Body], origin: Float, direction: Float) -> tuple[float, float, float] | None:
    """Return where a ray enters material and where it leaves it, m along it, and the density, kg/m³.

    Bodies that touch are one wall. None where the ray meets nothing.

    Parameters
    ----------
    found : `bodies`
    origin, direction : (3,) in shaft axes, m; direction a unit vector
    """
    stretches = []
    for body in found:
        past = np.linalg.norm(np.abs(body.box - origin).max(axis=0))
        ends = np.stack([origin, origin + past * direction])
        low, high = ends.min(axis=0) - _TOUCHING, ends.max(axis=0) + _TOUCHING
        near = ((body.low <= high) & (low <= body.high)).all(axis=1)
        stretches += [(*pair, body.density) for pair in inside(body.corners[near], origin, direction).tolist()]
    if not stretches:
        return None
    stretches.sort()
    enters, leaves, density = stretches[0]
    for start, stop, _ in stretches[1:]:
        if start > leaves + _TOUCHING:
            break
        leaves = max(leaves, stop)
    return enters, leaves, density


def under(found: Sequence[Body], tool: Tool, angle: float) -> float | None:
    """Return the density (kg/m³) of what a cutting tool at an angle (rad) meets; None where it cuts nothing.

    Raises `GeometryError` where there is no material within its reach, or more than its radius says.
    """
    probes = tool.probes(angle)
    if probes is None:
        return None
    plane, (origins, direction, _) = tool.plane, probes
    met = run(found, origins[0] - tool.clearance * direction, direction)
    where = f"plane {plane.id!r} at z = {1e3 * plane.z:.6g} mm, {math.degrees(angle) % 360:.4g} degrees"
    if met is None or met[0] - tool.clearance > min(tool.greatest, plane.radius):
        raise GeometryError(
            f"{where}: there is no material for the tool under the radius of {1e3 * plane.radius:.6g} mm: move the "
            "plane onto the part, or correct its radius"
        )
    above = tool.clearance - met[0]
    if above > _PROUD * plane.radius:
        raise GeometryError(
            f"{where}: the part begins {1e3 * above:.4g} mm before the surface that depths are measured from: give "
            f"the {'face' if plane.method == 'drill_axial' else 'radius'} where the tool enters"
        )
    return met[2]


def wall(found: Sequence[Body], tool: Tool, angle: float) -> float:
    """Return the largest setting (m) of a tool at an angle (rad) before it breaks through.

    Infinite where it cuts nothing, or goes through by intent. Rays beside the part do not count.
    """
    probes = tool.probes(angle)
    if probes is None or tool.plane.through:
        return math.inf
    origins, direction, ahead = probes
    limits = [math.inf]
    for origin, tip in zip(origins, ahead.tolist(), strict=True):
        met = run(found, origin - tool.clearance * direction, direction)
        if met is not None:
            limits.append(met[1] - tool.clearance - tip)
    return min(limits)
