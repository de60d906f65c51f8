"""`Tool`: what every way of correcting by degrees has in common; each has a module of its own.

A tool is set to a depth (drills, flats; m), an arc (rad) or a mass (added and removed masses; kg), and takes or adds
the more unbalance the larger its setting is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from inertia.arrays import Float
from inertia.balancing.corrections.correction_plane import CorrectionPlane
from inertia.balancing.corrections.operation import Operation
from inertia.mesh.surface import Surface
from inertia.records import dataclass


@dataclass(frozen=True)
class Ray:
    """A ray that runs with a tool, and what it asks for, m.

    Attributes
    ----------
    along, aside : from the tool's axis: along the shaft, or away from it for tools along the shaft; and around it
    ahead : how far the tool, and the wall under it, run ahead of its setting
    lag : how much later than along the axis the ray may meet the surface; None where it need not meet any
    under : how far the tool runs ahead of its setting there; None beside the tool
    """

    along: float
    aside: float
    ahead: float
    lag: float | None = 0.0
    under: float | None = None


@dataclass(frozen=True)
class Tool(ABC):
    """A tool at work in a plane.

    Attributes
    ----------
    plane : where it works
    density : kg/m³, of what it cuts
    limit : the largest setting, if there is one besides the plane's own
    start : m, how far under the plane's own surface the metal begins where it works, which depths are counted from
    """

    plane: CorrectionPlane
    density: float
    limit: float | None = None
    start: float = 0.0

    @property
    def radius(self) -> float:
        """Of the surface that it begins at, towards the shaft; else of its axis, or of the mass, m."""
        return self.plane.radius - (self.start if self.towards_shaft else 0.0)

    @property
    def entry(self) -> float:
        """Where along the shaft it begins, m."""
        return self.plane.entry

    @property
    def sign(self) -> int:
        """+1 where mass is added, −1 where it is removed."""
        return self.plane.sign

    @property
    def step(self) -> float:
        """What the shop can set it to multiples of; 0 for any setting."""
        return self.plane.depth_step

    @property
    def least(self) -> float:
        """The smallest setting."""
        return 0.0

    @property
    @abstractmethod
    def greatest(self) -> float:
        """The largest setting."""

    @abstractmethod
    def half_angle_at(self, setting: float) -> float:
        """Return how far it reaches to both sides of its angle with a setting, rad."""

    @abstractmethod
    def apart_at(self, setting: float) -> float:
        """Return the angle that two of its places with this setting are apart at least, rad."""

    @abstractmethod
    def unbalance(self, setting: float) -> float:
        """Return the magnitude of the unbalance that it takes or adds, kg m."""

    @abstractmethod
    def setting(self, unbalance: float) -> float:
        """Return the setting for an unbalance of this magnitude, kg m; the inverse of `unbalance`."""

    def unbalance_z(self, setting: float) -> float:
        """Return where along the shaft the unbalance acts, m."""
        return self.plane.z

    @abstractmethod
    def operation(self, name: str, angle: float, setting: float) -> Operation:
        """Return what it does at an angle (rad)."""

    def solid(self, angle: float, setting: float) -> Surface | None:
        """Return the solid that it cuts away, in shaft axes and m; None where it cuts nothing."""
        return None

    @property
    def clearance(self) -> float:
        """How far the tool, which is long, reaches out of the surface that depths are measured from, m."""
        return 0.0

    @property
    def towards_shaft(self) -> bool:
        """Whether it runs towards the shaft, rather than along it."""
        return True

    def rays(self) -> tuple[Ray, ...]:
        """Return the rays along which there has to be material, none where it cuts nothing; the first is its axis.

        All are measured from the surface that depths are measured from.
        """
        return ()

    def under(self, angle: float, setting: float) -> tuple[Float, float]:
        """Return the angles (m,) rad under which the wall is measured, and how deep it goes there, m."""
        return np.array([angle]), setting

    def sideways(self, angle: float, setting: float) -> list[tuple[Float, Float, float]]:
        """Return rays, origin and direction (3,), along which the wall beside the tool is measured, and its radius."""
        return []
