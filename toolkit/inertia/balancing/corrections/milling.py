"""Flats milled on a round part.

A flat of depth h and width w on the radius R takes away a circular segment with the chord c = 2 √(2 R h − h²). Its
first moment about the shaft is ∫ 2 s √(R² − s²) ds from R − h to R = c³/12, so that U(h) = ρ w c³/12.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import angle_of
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.tool import Ray, Tool
from inertia.mesh.cut import block
from inertia.mesh.part import Surface

_DEEPEST = 0.5  # of the radius, where no limit is given: the chord then spans 120°


def flat_unbalance(density: float, radius: float, width: float, depth: float) -> float:
    """Return the unbalance that a flat takes away, ρ w c³/12, kg m.

    Parameters
    ----------
    density : kg/m³
    radius : R, m
    width : w, m along the shaft
    depth : h, m under the round surface
    """
    half_chord_squared = depth * (2 * radius - depth)
    return density * width * 2 / 3 * half_chord_squared * math.sqrt(half_chord_squared)


def flat_depth(density: float, radius: float, width: float, unbalance: float) -> float:
    """Return the depth (m) of a flat that takes away an unbalance (kg m); not a number where none takes so much.

    >>> round(1e3 * flat_depth(7850, 0.1, 0.02, flat_unbalance(7850, 0.1, 0.02, 0.005)), 9)
    5.0
    """
    half_chord_squared = math.cbrt(1.5 * unbalance / (density * width)) ** 2
    distance_squared = radius**2 - half_chord_squared
    return half_chord_squared / (radius + math.sqrt(distance_squared)) if distance_squared >= 0 else math.nan


def flat_volume(radius: float, width: float, depth: float) -> float:
    """Return the volume that a flat takes away, w (R² φ − (R − h) c/2) with cos φ = 1 − h/R, m³."""
    half = math.acos(1 - depth / radius)
    return width * (radius**2 * half - (radius - depth) * math.sqrt(depth * (2 * radius - depth)))


@dataclass(frozen=True)
class FlatCutter(Tool):
    """A mill that makes flats, set in m of depth."""

    @property
    def width(self) -> float:
        """Width along the shaft, m."""
        assert self.plane.width is not None, "a plane that is milled has a width"
        return self.plane.width

    @property
    def greatest(self) -> float:
        """The largest depth, m."""
        deepest = _DEEPEST * self.plane.radius if self.plane.max_depth is None else self.plane.max_depth
        return max(deepest if self.limit is None else min(deepest, self.limit), 0.0)

    def half_angle_at(self, setting: float) -> float:
        """Half the angle that a flat of this depth takes."""
        return math.acos(1 - setting / self.plane.radius)

    def apart_at(self, setting: float) -> float:
        """The angle at which two flats of this depth meet."""
        return 2 * self.half_angle_at(setting)

    def unbalance(self, setting: float) -> float:
        """Return the unbalance taken, kg m."""
        return flat_unbalance(self.density, self.plane.radius, self.width, setting)

    def setting(self, unbalance: float) -> float:
        """Return the depth, m."""
        return flat_depth(self.density, self.plane.radius, self.width, unbalance)

    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return the flat."""
        plane = self.plane
        return Operation(
            id=name,
            plane=plane.id,
            z=plane.z,
            method="remove",
            kind="mill_flat",
            angle=angle_of(cmath.rect(1.0, angle)),
            radius=plane.radius,
            mass=self.density * flat_volume(plane.radius, self.width, setting),
            unbalance=-cmath.rect(self.unbalance(setting), angle),
            unbalance_z=plane.z,
            depth=setting,
            width=self.width,
        )

    @property
    def clearance(self) -> float:
        """Half of the radius."""
        return 0.5 * self.plane.radius

    def solid(self, angle: float, setting: float) -> Surface:
        """Return the block above the flat."""
        radius = self.plane.radius
        outward, aside, along = self._axes(angle)
        corner = (radius - setting) * outward - radius * aside + (self.plane.z - 0.5 * self.width) * along
        return block(corner, [(self.clearance + setting) * outward, 2 * radius * aside, self.width * along])

    def rays(self) -> tuple[Ray, ...]:
        """Return the rays at the flat's middle and at both of its ends, which may lie off the part."""
        least, end = self.plane.min_wall, 0.5 * 0.999 * self.width
        middle = Ray(0.0, 0.0, least, under=0.0)
        return middle, Ray(end, 0.0, least, None, 0.0), Ray(-end, 0.0, least, None, 0.0)

    def _axes(self, angle: float) -> Float:
        cosine, sine = math.cos(angle), math.sin(angle)
        return np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
