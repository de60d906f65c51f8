"""The key of a shaft as a point mass, after the key convention (ISO 21940-32).

A shaft is balanced with half a key in its keyway (H) and the fitment with the other half, unless the parts are marked
F: then the shaft takes the full key. N is no key at all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from inertia.balancing.unbalance import PointMass
from inertia.errors import UsageError

KeyConvention = Literal["H", "F", "N"]


@dataclass(frozen=True)
class Key:
    """A straight key of rectangular section in a keyway of the shaft.

    Attributes
    ----------
    width, height, length : m; the height along the radius, the length along the shaft
    floor : m, distance of the keyway's floor from the axis
    angle : rad from 0°
    z : m, middle of the key along the shaft
    density : kg/m³

    >>> key = Key(0.008, 0.007, 0.04, floor=0.011, angle=0.0, z=0.1, density=7850.0)
    >>> half, full = key.point_masses("H")[0], key.point_masses("F")[0]
    >>> round(full.mass / half.mass, 12), round(half.radius, 6), round(full.radius, 6)
    (2.0, 0.01275, 0.0145)
    """

    width: float
    height: float
    length: float
    floor: float
    angle: float
    z: float
    density: float

    def __post_init__(self) -> None:
        for name in ("width", "height", "length", "floor", "density"):
            if not 0 < (value := getattr(self, name)) < math.inf:
                raise UsageError(f"the {name} of the key is {value!r}: it must be positive and finite")

    def point_masses(self, convention: KeyConvention) -> tuple[PointMass, ...]:
        """Return what stands for the key on the shaft: half its height from the floor up, all of it, or nothing."""
        if convention not in ("H", "F", "N"):
            raise UsageError(f"the key convention is {convention!r}: use 'H' (half key), 'F' (full key) or 'N' (none)")
        if convention == "N":
            return ()
        height = self.height if convention == "F" else 0.5 * self.height
        mass = self.density * self.width * height * self.length
        return (PointMass(mass, self.floor + 0.5 * height, self.angle, self.z),)
