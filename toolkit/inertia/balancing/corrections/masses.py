"""Point masses added at a radius or taken away from it, and how to split them.

A mass m at radius r and angle θ adds m r exp(iθ) to the unbalance, and takes it away where it is removed.
"""

from __future__ import annotations

import cmath
import math

from inertia.balancing.corrections.correction_plane import angle_of
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.tool import Tool
from inertia.errors import UsageError
from inertia.records import dataclass

_APART = math.radians(10)  # between masses that share a correction, as their size is not known
_PARALLEL = 1e-9


@dataclass(frozen=True)
class MassTool(Tool):
    """Masses added to or removed from a plane, set in kg."""

    @property
    def step(self) -> float:
        """What the shop can weigh, kg."""
        return self.plane.mass_step

    @property
    def greatest(self) -> float:
        """The largest mass at one place, kg."""
        return math.inf if self.plane.max_mass is None else self.plane.max_mass

    def half_angle_at(self, setting: float) -> float:
        """0: a point."""
        return 0.0

    def apart_at(self, setting: float) -> float:
        """The angle between two masses, rad."""
        return _APART

    def unbalance(self, setting: float) -> float:
        """Return m r, kg m."""
        return setting * self.plane.radius

    def setting(self, unbalance: float) -> float:
        """Return m = U/r, kg."""
        return unbalance / self.plane.radius

    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return the mass added or removed."""
        plane = self.plane
        return Operation(
            id=name,
            plane=plane.id,
            z=plane.z,
            method="add" if self.sign > 0 else "remove",
            kind="point_mass",
            angle=angle_of(cmath.rect(1.0, angle)),
            radius=plane.radius,
            mass=setting,
            unbalance=self.sign * cmath.rect(setting * plane.radius, angle),
            unbalance_z=plane.z,
        )


def split(vector: complex, first: float, second: float) -> tuple[float, float]:
    """Return the magnitudes at two angles (rad) that are together the vector.

    a = V sin(θ₂ − θ)/sin(θ₂ − θ₁) and b = V sin(θ − θ₁)/sin(θ₂ − θ₁), in the unit of the vector.

    Raises `UsageError` where the vector does not lie between the two angles, so that one would be negative.

    >>> a, b = split(cmath.rect(10.0, 0.5), 0.0, 1.0)
    >>> round(a, 4), round(b, 4)
    (5.6975, 5.6975)
    """
    size, angle = cmath.polar(vector)
    between = math.sin(second - first)
    if abs(between) <= _PARALLEL:
        raise UsageError(
            f"the angles {math.degrees(first):g}° and {math.degrees(second):g}° lie on one line: give two between "
            "which the correction lies"
        )
    a, b = (size * math.sin(gap) / between for gap in (second - angle, angle - first))
    if min(a, b) < -_PARALLEL * size:
        raise UsageError(
            f"the correction at {math.degrees(angle) % 360:.4g}° does not lie between {math.degrees(first):g}° and "
            f"{math.degrees(second):g}°: name the allowed angles on both sides of it"
        )
    return max(a, 0.0), max(b, 0.0)


def equal_pair(vector: complex, each: float) -> tuple[float, float]:
    """Return the angles (rad) of two equal magnitudes that are together the vector: θ ± arccos(V/2a).

    Raises `UsageError` where two of them are too little.

    >>> low, high = equal_pair(10.0, 10.0)
    >>> round(math.degrees(low)), round(math.degrees(high))
    (300, 60)
    """
    size, angle = cmath.polar(vector)
    if not size <= 2 * each:
        raise UsageError(f"two weights of {each:g} make up {2 * each:g} at most, not {size:g}: take larger ones")
    half = math.acos(size / (2 * each))
    return angle_of(cmath.rect(1.0, angle - half)), angle_of(cmath.rect(1.0, angle + half))
