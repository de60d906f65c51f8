"""How far mass properties lie from the exact ones, and how far their bounds let them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from inertia.mass.moments import ZERO, Moments, inertia_tensor, root_above
from inertia.mass.properties import MassProperties


@dataclass(frozen=True)
class Relative:
    """Relative errors, or bounds on them.

    The centre of mass counts relative to the size of the part (its largest extent), the tensor in the Frobenius norm.
    """

    volume: float
    center_of_mass: float
    inertia: float

    @property
    def worst(self) -> float:
        """The largest of the three."""
        return max(self.volume, self.center_of_mass, self.inertia)


@dataclass(frozen=True)
class Scale:
    """What turns moments of volume in a file's unit into mass properties: `metres` in the unit, `density` in kg/m³.

    `size` is the largest extent of the part in metres.
    """

    metres: Fraction
    density: Fraction
    size: Fraction

    def weighed(self, moments: Moments) -> Moments:
        """Return the moments of mass, kg and metres."""
        return moments.in_unit(self.metres).scaled(self.metres**3 * self.density)

    def properties(self, moments: Moments, method: str) -> MassProperties:
        """Round to mass properties; raises `GeometryError` as `MassProperties.from_moments`."""
        cube = self.metres**3
        return MassProperties.from_moments(
            self.weighed(moments), cube * moments.zeroth, cube * moments.zeroth_bound, method
        )

    def bound(self, properties: MassProperties) -> Relative:
        """Return the certified bounds on the arithmetic error."""
        error = properties.error
        return Relative(error.volume, float(Fraction(error.center_of_mass) / self.size), error.inertia)

    def error(self, properties: MassProperties, truth: Moments) -> Relative:
        """Return the distance of mass properties from `truth`, the moments of volume in the file's unit."""
        exact = self.weighed(truth).central()
        volume = self.metres**3 * truth.zeroth
        tensor = [value for row in inertia_tensor(exact.second) for value in row]
        stored = properties.inertia.ravel().tolist()
        return Relative(
            float(abs(Fraction(properties.volume) / volume - 1)),
            float(_distance(properties.center_of_mass.tolist(), exact.origin) / self.size),
            float(_distance(stored, tensor) / _distance([0.0] * 9, tensor)),
        )


def _distance(stored: list[float], exact: list[Fraction] | tuple[Fraction, ...]) -> Fraction:
    return root_above(sum(((Fraction(a) - b) ** 2 for a, b in zip(stored, exact, strict=True)), ZERO))
