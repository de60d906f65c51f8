"""Axis of a rotor: through the bearing centres of its file, or through cylinders of the mesh that may be journals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from inertia.arrays import Float
from inertia.balancing.axis.journals import Journal, axis_candidates
from inertia.balancing.axis.shaft import Shaft
from inertia.balancing.rotor import Rotor
from inertia.balancing.rotor_bodies import RotorBody
from inertia.errors import FieldPath, GeometryError, UsageError
from inertia.records import dataclass

_JOURNALS = FieldPath("axis.journals")
_OFFERED = 5


@dataclass(frozen=True, eq=False)
class Candidate:
    """Bearing centres that a rotor might have.

    Attributes
    ----------
    bearing_a, bearing_b : (3,) m, part axes
    radii : m, of the journals there
    coverage : share of the full turn that the journals' facets cover, the smaller of the two
    rms : m, of their vertices' distances from the cylinders, the larger of the two
    uncertainty : m, standard deviation of the axis at the journals
    where : which cylinders these are, in words
    """

    bearing_a: Float
    bearing_b: Float
    radii: tuple[float, float]
    coverage: float
    rms: float
    uncertainty: float
    where: str


@dataclass(frozen=True, eq=False)
class Axis:
    """The shaft that a balance is worked out for.

    Attributes
    ----------
    shaft : `Shaft`
    obtained : how, in words
    candidates : what was found where no bearings were given, the likeliest first; the shaft is then that of the first
    """

    shaft: Shaft
    obtained: str
    candidates: tuple[Candidate, ...] = ()

    @property
    def confirmed(self) -> bool:
        """Whether the bearings were given, so that a verdict can be had."""
        return not self.candidates


def rotor_axis(rotor: Rotor, bodies: Sequence[RotorBody]) -> Axis:
    """Return the shaft through the bearings, or, where the file asks for journals, through the likeliest candidate.

    Raises `GeometryError` where no journals are found, `UsageError` for an unknown region.
    """
    if rotor.shaft is not None:
        return Axis(rotor.shaft, "two bearing centres, as given")
    journals = rotor.fields.axis.journals
    assert journals is not None, "the section asks for bearings or journals"
    if isinstance(journals, str):
        candidates = _detected(bodies)
        obtained = "detected from cylinders in the mesh: needs confirming"
    else:
        candidates = (_named(bodies, *journals),)
        obtained = f"cylinders fitted to the regions {journals[0]!r} and {journals[1]!r}: needs confirming"
    if not candidates:
        raise GeometryError(
            "the mesh has no axis with two separate cylinders that could be journals: give bearing_a and bearing_b",
            places=(rotor.name, _JOURNALS),
        )
    best = candidates[0]
    return Axis(rotor.shaft_between(best.bearing_a, best.bearing_b), obtained, candidates)


def _detected(bodies: Sequence[RotorBody]) -> tuple[Candidate, ...]:
    """Return an axis for each set of coaxial cylinders of the bodies, between the two that are farthest apart."""
    scored: list[tuple[float, Candidate]] = []
    for body in bodies:
        metres = float(body.part.unit.metres)
        for axis in axis_candidates(body.part.triangles):
            outer = [journal for journal in axis.journals if not journal.bore]
            if len(outer) > 1:
                where = f"the first and last of {len(outer)} coaxial cylinders of {body.name}"
                ends = _in_metres(outer[0], metres), _in_metres(outer[-1], metres)
                scored.append((axis.score * metres**2, _candidate(*ends, metres * axis.uncertainty, where)))
    ranked = sorted(scored, key=lambda entry: -entry[0])
    return tuple(candidate for _, candidate in ranked[:_OFFERED])


def _named(bodies: Sequence[RotorBody], first: str, second: str) -> Candidate:
    (a, at_a), (b, at_b) = (_journal(bodies, name) for name in (first, second))
    return _candidate(a, b, max(at_a, at_b), f"the regions {first!r} and {second!r}")


def _journal(bodies: Sequence[RotorBody], name: str) -> tuple[Journal, float]:
    """Return the cylinder of a region, in m, and the standard deviation of its axis, m."""
    names: list[str] = []
    for body in bodies:
        regions = body.whole.regions
        if regions is None:
            continue
        names += regions.names
        if name not in regions.names:
            continue
        triangles = np.flatnonzero(regions.index == regions.names.index(name))
        axes = axis_candidates(body.whole.triangles.select(triangles))
        if not axes:
            raise GeometryError(
                f"the region {name!r} of {body.whole.name} is no cylinder: name the regions of the journals, or give "
                "bearing_a and bearing_b",
                places=(_JOURNALS,),
            )
        metres = float(body.whole.unit.metres)
        largest = max(axes[0].journals, key=lambda journal: journal.area)
        return _in_metres(largest, metres), metres * axes[0].uncertainty
    there = f"they have {', '.join(map(repr, dict.fromkeys(names)))}" if names else "they name none"
    raise UsageError(f"no body has a region {name!r}: {there}", places=(_JOURNALS,))


def _in_metres(journal: Journal, metres: float) -> Journal:
    return replace(
        journal,
        center=metres * journal.center,
        radius=metres * journal.radius,
        length=metres * journal.length,
        area=metres**2 * journal.area,
        rms=metres * journal.rms,
    )


def _candidate(a: Journal, b: Journal, uncertainty: float, where: str) -> Candidate:
    return Candidate(
        bearing_a=a.center,
        bearing_b=b.center,
        radii=(a.radius, b.radius),
        coverage=min(a.coverage, b.coverage),
        rms=max(a.rms, b.rms),
        uncertainty=uncertainty,
        where=where,
    )
