"""Standard weights at positions such as blades, bolts or threaded holes."""

from __future__ import annotations

import cmath
from dataclasses import dataclass

from inertia.balancing.corrections.correction_plane import CorrectionPlane, KitWeight, angle_of
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.tool import Tool


def weight_operation(plane: CorrectionPlane, name: str, angle: float, weight: KitWeight, pieces: int) -> Operation:
    """Return the putting of some weights of one kind at a position (rad)."""
    mass = pieces * weight.mass
    return Operation(
        id=name,
        plane=plane.id,
        z=plane.z,
        method="add",
        kind="weight",
        angle=angle_of(cmath.rect(1.0, angle)),
        radius=plane.radius,
        mass=mass,
        unbalance=cmath.rect(mass * plane.radius, angle),
        unbalance_z=plane.z,
        pieces=pieces,
        item=weight.name,
    )


@dataclass(frozen=True, kw_only=True)
class WeightTool(Tool):
    """One kind of weight of a kit, set in pieces: one at a time."""

    weight: KitWeight

    @property
    def step(self) -> float:
        """One."""
        return 1.0

    @property
    def least(self) -> float:
        """One."""
        return 1.0

    @property
    def greatest(self) -> float:
        """One."""
        return 1.0

    def half_angle_at(self, setting: float) -> float:
        """0: a point."""
        return 0.0

    def apart_at(self, setting: float) -> float:
        """0: weights are put where the plane has positions for them."""
        return 0.0

    def unbalance(self, setting: float) -> float:
        """Return m r of so many, kg m."""
        return setting * self.weight.mass * self.plane.radius

    def setting(self, unbalance: float) -> float:
        """Return how many."""
        return unbalance / (self.weight.mass * self.plane.radius)

    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return the putting of so many at an angle (rad)."""
        return weight_operation(self.plane, name, angle, self.weight, round(setting))
