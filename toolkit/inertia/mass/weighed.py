"""The integral of a part with its densities: its mass properties, with bounds of all that is in doubt."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Literal

import numpy as np

from inertia.arrays import Float
from inertia.errors import (
    CHECK,
    GeometryError,
    UsageError,
    Word,
)
from inertia.mass.analysis import BodyShare
from inertia.mass.density import Densities
from inertia.mass.doubt import FILLED, doubt_bounds, doubt_error
from inertia.mass.integrand import Integrand
from inertia.mass.integration import Integral, naming
from inertia.mass.moments import ZERO, Moments, nearby, total, vector
from inertia.mass.properties import CERTAIN, ErrorBound, MassProperties
from inertia.mass.tensor import faults
from inertia.mass.tessellation import chord_error
from inertia.mesh.doubt import Doubt
from inertia.mesh.part import Part
from inertia.records import dataclass

_SLENDER = 4.0  # norm of the tensor over its smallest moment: of compact parts it is less


@dataclass(frozen=True, eq=False)
class Weighed:
    """The integral of a part with its densities; `factor` is the volume, m³, of a unit of the integral's."""

    part: Part
    integral: Integral
    densities: Densities
    factor: Fraction

    @cached_property
    def weights(self) -> list[Fraction]:
        """The density of each group, kg/m³; a weighed mass scales them all."""
        groups, total_mass = self.integral.groups, self.densities.mass
        weights = [Fraction(self.densities.of(group.name)) for group in groups]
        if total_mass is not None:
            mass = self.factor * sum((w * g.moments.zeroth for w, g in zip(weights, groups, strict=True)), ZERO)
            if mass <= 0:
                raise GeometryError("the solid has no volume to spread the mass over: check the mesh")
            weights = [w * Fraction(total_mass) / mass for w in weights]
            if max(weights) > sys.float_info.max:
                raise UsageError(
                    f"a mass of {total_mass:g} kg makes a density above 1.8e308 kg/m³: check mass and unit"
                )
        return weights

    @cached_property
    def room(self) -> Moments | None:
        """Moments of zero with the bounds of what is in doubt about the centroid, in the part's unit."""
        doubt = Doubt.joined(finding.doubt for finding in self.integral.doubts)
        if doubt is None:
            return None
        whole = total(group.moments for group in self.integral.groups)
        return doubt_bounds(doubt, vector(map(nearby, whole.centroid)) if whole.zeroth else whole.origin)

    @property
    def undoubted(self) -> Weighed:
        """The same without what is in doubt, which no arithmetic makes less."""
        return replace(self, integral=replace(self.integral, doubts=())) if self.integral.doubts else self

    @cached_property
    def moments(self) -> Moments:
        """The moments of mass, kg and m."""
        moments = total(
            group.moments.in_unit(self.part.unit.metres).scaled(self.factor * weight)
            for group, weight in zip(self.integral.groups, self.weights, strict=True)
        )
        if self.room is not None:
            room = self.room.in_unit(self.part.unit.metres).scaled(self.factor * max(self.weights))
            moments = moments.about(room.origin) + room  # shifting the room would make it larger
        if self.densities.mass is not None and moments.zeroth > moments.zeroth_bound:
            return moments.weighed(Fraction(self.densities.mass))
        return moments

    @cached_property
    def volume(self) -> Fraction:
        """The volume, m³."""
        return self.factor * sum((group.moments.zeroth for group in self.integral.groups), ZERO)

    @cached_property
    def properties(self) -> MassProperties:
        """The mass properties."""
        volume_bound = self.factor * sum((group.moments.zeroth_bound for group in self.integral.groups), ZERO)
        if self.room is not None:
            volume_bound += self.factor * self.room.zeroth_bound
        with naming(self.part):
            return MassProperties.from_moments(self.moments, self.volume, volume_bound, self.integral.method)

    def integrand(self, model: Literal["solid", "shell", "wire"]) -> Integrand:
        """Return the elements and densities that the properties are of."""
        weighed, weights = self.densities.mass is not None, tuple(self.weights)
        groups, turned = self.integral.groups, self.integral.turned
        return Integrand(self.part, model, self.factor, groups, weights, turned, self.properties, weighed)

    @property
    def bounds(self) -> dict[str, float]:
        """The relative bounds of the quantities; that of the centre of mass, as a pair, over the size of the part."""
        error = self.properties.error
        size = float(Fraction(float(np.ptp(self.integral.extents, axis=0).max())) * self.part.unit.metres)
        return {
            "volume": error.volume,
            "mass": error.mass,
            "tensor": error.inertia,
            "centre of mass": self.properties.center_of_mass_pair()[1] / size,
        }

    @property
    def mean_density(self) -> Fraction:
        """The mean density by volume, kg/m³."""
        groups = self.integral.groups
        if len(groups) == 1:
            return self.weights[0]
        volume = sum((group.moments.zeroth for group in groups), ZERO)
        return sum((w * g.moments.zeroth for w, g in zip(self.weights, groups, strict=True)), ZERO) / volume

    def tessellation(self, chord: float | Float) -> ErrorBound:
        """Return the bounds that follow from a chord tolerance, or from that of each triangle, in the part's unit."""
        mass = None if self.densities.mass is None else self.moments.zeroth
        return chord_error(self.part, chord, self.moments, self.volume, max(self.weights), mass)

    def repair(self) -> ErrorBound:
        """Return the bounds that follow from holes filled by a guess."""
        assert self.part.filling is not None
        mass = None if self.densities.mass is None else self.moments.zeroth
        density = max(self.weights)
        return doubt_error(self.part.filling, self.part.unit, self.moments, self.volume, density, FILLED, mass)

    def shares(self) -> tuple[BodyShare, ...]:
        """Return what each group contributes."""
        shares = []
        for group, weight in zip(self.integral.groups, self.weights, strict=True):
            volume = self.factor * group.moments.zeroth
            x, y, z = (float(self.part.unit.metres * k) for k in group.moments.centroid)
            shares.append(BodyShare(group.name, float(weight), float(volume), float(weight * volume), (x, y, z)))
        return tuple(shares)


def good_enough(answers: Iterable[Weighed], limit: float | None, *, allowed: bool = False) -> Weighed:
    """Return the first answer within the limit, the volume and principal moments certain, or the last there is.

    Raises `GeometryError` where its tensor is that of no body, or a principal moment is in doubt by all of itself;
    faults `allowed` for, or bodies that may share space, may leave most of the tensor in doubt, and then a moment, too.
    """
    for answer in answers:
        arithmetic = answer.undoubted
        try:
            properties = arithmetic.properties
        except GeometryError as fault:
            if fault.code != "unphysical":
                raise
            raise GeometryError(*fault.words, *_blamed(answer), places=fault.places, code=fault.code) from None
        bound = properties.error.volume if limit is None else max(arithmetic.bounds.values())
        if bound <= (limit or CERTAIN) and properties.moments_within(max(limit or CERTAIN, CERTAIN)):
            break
    if answer.integral.closed:
        _require_physical(answer, allowed)
    return answer


def _require_physical(answer: Weighed, allowed: bool) -> None:
    """Raise `GeometryError` where the tensor is surely that of no body, or what is in doubt is as much as a moment.

    That a tensor has a tolerance of its trace where it is given does not do here: the smallest moment of a needle is
    less, and the bounds say what rounding may have done.
    """
    properties, told = answer.properties, answer.undoubted.properties
    useless = answer.room is None and properties.error.inertia >= 1
    if answer.room is None and not useless and not faults(told.inertia, 0.0):
        return
    i1, i2, i3 = (Fraction(k) for k in told.principal.moments.tolist())
    off = [Fraction(min(k, sys.float_info.max)) for k in told.principal.moment_bounds.tolist()]
    moments = "the principal moments " + ", ".join(f"{k:.6g}" for k in told.principal.moments.tolist())
    if i1 < -off[0] or i1 + i2 < i3 - sum(off):
        broken = "are not all positive" if i1 < -off[0] else "break the triangle rule: no body has I1 + I2 < I3"
        raise GeometryError(
            f"the inertia tensor is not physical: {moments} {broken}",
            *_blamed(answer),
            places=(answer.part.name,),
            code="unphysical",
        )
    bounds = properties.principal.moment_bounds
    allowed = allowed or any(finding.code == "shared_space" for finding in answer.integral.doubts)
    share = max(1.0, _SLENDER * properties.error.inertia if allowed else 0.0)
    if useless or (answer.room is not None and (bounds >= share * properties.principal.moments).any()):
        raise GeometryError(
            f"{moments} kg m² may be off by {', '.join(f'{k:.2g}' for k in bounds.tolist())}: by all that there is",
            *_blamed(answer),
            places=(answer.part.name,),
        )


def _blamed(answer: Weighed) -> tuple[Word, ...]:
    """Return the words of a refusal on what is to blame for a tensor, and what to do about it."""
    doubts = "; ".join(finding.statement for finding in answer.integral.doubts if finding.doubt is not None)
    if not doubts:
        return ": see ", CHECK
    return (f" ({doubts}): take that out, or mend it, where the part was made",)


def doubted(answer: Weighed) -> tuple[Word, ...]:
    """Return the words of a refusal on how much is in doubt; none where nothing is."""
    if answer.room is None:
        return ()
    return f" (up to {float(answer.room.zeroth_bound):.2g} {answer.part.unit.name}³ is in doubt, see ", CHECK, ")"
