"""A rotor on its shaft, to be cut as often as one likes, each time from the same stock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import add

from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.corrections.walls import Body, bodies
from inertia.balancing.unbalance import PointMass, Unbalance
from inertia.mass.analysis import mass_properties
from inertia.mesh.cut import Stock, stock
from inertia.mesh.part import Part, Surface


@dataclass(frozen=True, eq=False)
class Workpiece:
    """Parts with their densities (kg/m³) on a shaft, and the unbalance (of whatever origin) to start from."""

    parts: tuple[Part, ...]
    densities: tuple[float, ...]
    shaft: Shaft
    initial: Unbalance

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The parts in shaft axes."""
        return bodies(self.parts, self.densities, self.shaft)

    @cached_property
    def _stocks(self) -> tuple[Stock, ...]:
        return tuple(stock(part) for part in self.parts)

    @cached_property
    def _before(self) -> Unbalance:
        return self._measured(self.parts)

    def cut(self, solids: Sequence[Surface], others: Sequence[Operation]) -> tuple[tuple[Part, ...], Unbalance]:
        """Cut solids (shaft axes, m) out of all parts, and return the parts and the unbalance after it.

        What changes is the difference between the parts integrated before and after, and the point masses of the
        other operations; the rest of the initial unbalance stays.
        """
        parts, left = self.parts, self.initial
        if solids:
            parts = tuple(ready.cut([self._in_part(solid, ready.part) for solid in solids]) for ready in self._stocks)
            left = changed(left, self._before, self._measured(parts))
        signs = {"add": 1, "remove": -1}
        return parts, left.with_masses([PointMass(signs[k.method] * k.mass, k.radius, k.angle, k.z) for k in others])

    def _in_part(self, solid: Surface, part: Part) -> Surface:
        return Surface(self.shaft.to_part(solid.vertices) / float(part.unit.metres), solid.faces)

    def _measured(self, parts: Sequence[Part]) -> Unbalance:
        pairs = zip(parts, self.densities, strict=True)
        return Unbalance.of(reduce(add, (mass_properties(part, density) for part, density in pairs)), self.shaft)


def changed(start: Unbalance, before: Unbalance, after: Unbalance) -> Unbalance:
    """Return an unbalance after what turned one rotor into another was done to it; its uncertainties stay."""
    mass = start.mass + after.mass - before.mass
    z = (start.mass * start.z + after.mass * after.z - before.mass * before.z) / mass
    return Unbalance(
        mass,
        z,
        start.static + (after.static - before.static),
        start.couple_about(z) + (after.couple_about(z) - before.couple_about(z)),
        tuple(k.about(z - start.z) for k in start.uncertainties),
    )
