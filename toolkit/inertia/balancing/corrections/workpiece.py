"""The rotor under a tool: its unbalance after cutting, and the material and wall thickness along a ray."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property, reduce
from operator import add

import numpy as np

from inertia.arrays import Float, Int
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.corrections.operation import Operation
from inertia.balancing.unbalance import Complex, PointMass, Unbalance
from inertia.mass.analyse import mass_properties
from inertia.mesh.cut import Stock, pieces, stock
from inertia.mesh.geometry.closure import closure
from inertia.mesh.geometry.rays import inside
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface, Triangles
from inertia.records import dataclass

_TOUCHING = 1e-6  # m: bodies with a gap no wider than this are one wall
_PROUD = 0.01  # of the radius: how far the part may stand out of it


@dataclass(frozen=True, eq=False)
class Taken:
    """What a tool takes away: kg, the unbalance kg m and where along the shaft (m) it was, and what that changes.

    `change` is the change of the unbalance in the planes asked for, (t,) kg m.
    """

    mass: float
    unbalance: complex
    z: float
    change: Complex


@dataclass(frozen=True, eq=False)
class Workpiece:
    """Parts with their densities (kg/m³) on a shaft, and the unbalance (of whatever origin) to start from.

    `uncut` is the unbalance of the parts themselves, where it is known: it is integrated otherwise.
    """

    parts: tuple[Part, ...]
    densities: tuple[float, ...]
    shaft: Shaft
    initial: Unbalance
    uncut: Unbalance | None = None

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The parts in shaft axes."""
        return bodies(self.parts, self.densities, self.shaft)

    @cached_property
    def _stocks(self) -> tuple[Stock, ...]:
        return tuple(stock(part) for part in self.parts)

    @cached_property
    def _before(self) -> Unbalance:
        # What is left after cutting are triangles, so that a true shape would bring in what they are off by.
        of_triangles = all(part.shape is None for part in self.parts)
        return self.uncut if self.uncut is not None and of_triangles else self._integrated(self.parts)

    def cut(self, solids: Sequence[Surface], others: Sequence[Operation]) -> tuple[tuple[Part, ...], Unbalance]:
        """Cut solids (shaft axes, m) out of all parts, and return the parts and the unbalance after it.

        What changes is the difference between the parts integrated before and after, and the point masses of the
        other operations; the rest of the initial unbalance stays.
        """
        parts, unbalance = self.parts, self.initial
        if solids:
            parts = tuple(ready.cut([self._in_part(solid, ready.part) for solid in solids]) for ready in self._stocks)
            unbalance = changed(unbalance, self._before, self._integrated(parts))
        signs = {"add": 1, "remove": -1}
        return parts, unbalance.with_masses(
            [PointMass(signs[k.method] * k.mass, k.radius, k.angle, k.z) for k in others]
        )

    def taken(self, solid: Surface, at: Sequence[float]) -> Taken:
        """Return what a solid (shaft axes, m) takes away by itself, as seen in planes at (t,) m."""
        mass, vectors, moment, unbalance = 0.0, np.zeros(len(at), complex), 0j, 0j
        for ready, density in zip(self._stocks, self.densities, strict=True):
            piece = ready.common(self._in_part(solid, ready.part))
            if piece is not None:
                removed = Unbalance.of(mass_properties(piece, density, intersections=False), self.shaft)
                mass += removed.mass
                vectors += removed.in_many_planes(at)
                unbalance += removed.static
                moment += removed.static * removed.z + removed.couple
        z = (moment * unbalance.conjugate()).real / abs(unbalance) ** 2 if unbalance else math.nan
        return Taken(mass, unbalance, z, -vectors)

    def _in_part(self, solid: Surface, part: Part) -> Surface:
        return Surface(self.shaft.to_part(solid.vertices) / float(part.unit.metres), solid.faces)

    def _integrated(self, parts: Sequence[Part]) -> Unbalance:
        pairs = zip(parts, self.densities, strict=True)
        return Unbalance.of(
            reduce(
                add,
                (mass_properties(part, density, intersections=False, tessellated=True) for part, density in pairs),
            ),
            self.shaft,
        )


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


@dataclass(frozen=True, eq=False)
class Body:
    """A body's triangles (n, 3, 3) in shaft axes and m, their boxes (n, 3), its own (2, 3), and its density, kg/m³.

    `surface` is its surface as it is in the part.
    """

    corners: Float
    low: Float
    high: Float
    box: Float
    density: float
    surface: Triangles

    @cached_property
    def pieces(self) -> list[Int]:
        """The numbers of the triangles of each of its pieces, those that have nothing in common."""
        return pieces(self.surface, closure(self.surface))


def bodies(parts: Sequence[Part], densities: Sequence[float], shaft: Shaft) -> tuple[Body, ...]:
    """Bring parts into shaft axes."""
    placed = []
    for part, density in zip(parts, densities, strict=True):
        corners = shaft.to_shaft(part.triangles.corners() * float(part.unit.metres))
        low, high = corners.min(axis=1), corners.max(axis=1)
        placed.append(Body(corners, low, high, np.stack([low.min(axis=0), high.max(axis=0)]), density, part.triangles))
    return tuple(placed)


def run(rotor_bodies: Sequence[Body], origin: Float, direction: Float) -> tuple[float, float, float] | None:
    """Return where a ray enters material and where it leaves it, m along it, and the density, kg/m³.

    Bodies that touch are one wall. None where the ray meets nothing.

    Parameters
    ----------
    rotor_bodies : `bodies`
    origin, direction : (3,) in shaft axes, m; direction a unit vector
    """
    stretches = []
    for body in rotor_bodies:
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
