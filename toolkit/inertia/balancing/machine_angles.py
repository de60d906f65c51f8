"""How a balancing machine counts angles, where it is not as the rotor file does."""

from __future__ import annotations

from typing import Literal

from inertia.records import dataclass


@dataclass(frozen=True)
class MachineAngles:
    """The angles of a machine beside those of `inertia.balancing.unbalance`.

    Attributes
    ----------
    sense : in which they grow, seen from bearing B looking toward A
    zero : degrees of the rotor file, where the machine's zero is
    """

    sense: Literal["ccw", "cw"] = "ccw"
    zero: float = 0.0

    @property
    def others(self) -> bool:
        """Whether the machine calls places by other angles than the rotor file."""
        return self.sense == "cw" or self.zero % 360.0 != 0.0

    def of(self, angle: float) -> float:
        """Return what the machine calls an angle of the rotor file, both in degrees.

        >>> MachineAngles("cw", 90.0).of(119.5)
        330.5
        """
        turned = angle - self.zero if self.sense == "ccw" else self.zero - angle
        return float(f"{turned % 360.0:.12g}") % 360.0

    def ends_of(self, ends: tuple[float, float]) -> tuple[float, float]:
        """Return what it calls the ends of an arc, in its own sense."""
        start, stop = map(self.of, ends)
        return (start, stop) if self.sense == "ccw" else (stop, start)
