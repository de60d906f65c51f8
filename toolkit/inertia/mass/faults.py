"""Solids with small faults: the surface closed and turned, with bounds on all that its faults leave open.

What is covered: of a hole, all closures that `inertia.mesh.repairs.closures` admits, over the filling and no farther
from it than the hole is broad; of a crack, its rims anywhere within its breadth, with the triangles; of an open piece
that is left out, all of its convex hull; of a shell that is turned, that it is material, a void or nothing; of a shell
in the material of another, that it is counted twice, once, or a void; of what bodies share, or a shell that crosses
itself encloses twice, that it is counted once or twice. Copies of triangles, triangles that run the wrong way and fins
without thickness leave nothing open.
"""

from __future__ import annotations

import math
from decimal import ROUND_CEILING, Context
from numbers import Real

import numpy as np

from inertia.errors import ALLOW_FAULTS, GeometryError, Remedy, UsageError
from inertia.mass.properties import ErrorBound
from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mesh.check import check
from inertia.mesh.checks.findings import Finding, counted
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.doubt import Doubt
from inertia.mesh.geometry.intersect import crossings
from inertia.mesh.part import Part
from inertia.mesh.repair import repair
from inertia.mesh.unite import unite
from inertia.records import dataclass

_CROSSINGS = 2_000  # that are united in a second or two
_LEAST, _MOST = 1e-9, 0.5  # worth allowing for, and above that the fault is not small
_TWO_DIGITS = Context(prec=2, rounding=ROUND_CEILING)


@dataclass(frozen=True, eq=False)
class Mended:
    """A part that is closed and wound, and what that leaves in doubt."""

    part: Part
    doubts: tuple[Finding, ...]


def require_allowance(allow_faults: float) -> None:
    """Raise `UsageError` where no relative bound can be that."""
    real = isinstance(allow_faults, Real) and not isinstance(allow_faults, bool)
    if not (real and 0 < allow_faults < 1):
        raise UsageError(
            f"faults are allowed for up to {allow_faults!r}: give a relative bound between 0 and 1, such as 0.01"
        )


def mended(part: Part, *, alike: bool) -> Mended:
    """Close and turn the surface of a part; parameters and errors as of `inertia.repair`."""
    repaired = repair(part, unite=False, bounded=True, alike=alike).part
    return Mended(repaired, left_open(repaired))


def left_open(part: Part) -> tuple[Finding, ...]:
    """Return what repair leaves in doubt: fillings of holes, and what else it had to guess."""
    unit = part.unit.name
    guesses = tuple(_finding(each.code, each.what, each.count, each.doubt, unit) for each in part.guesses)
    if part.filling is None:
        return guesses
    words = "filled holes: what lies between the closures that their rims admit"
    return (_finding("hole", words, 1, part.filling, unit), *guesses)


def nested(part: Part) -> tuple[Finding, ...]:
    """Return what shells in the material of others leave in doubt beyond being counted once: each may be a void."""
    inside = [
        shell for shell in SurfaceTopology.of(part).shells if shell.kind == "outward" and shell.winding_outside > 0
    ]
    doubt = Doubt.joined(Doubt.within(shell.box, 0.0, abs(shell.signed_volume)) for shell in inside)
    if doubt is None:
        return ()
    words = f"voids: {counted(len(inside), 'shell')} inside the material of another may be one"
    return (_finding("overlapping_bodies", words, len(inside), doubt, part.unit.name),)


def united(part: Part) -> Mended:
    """Count what a surface encloses more than once there only once; what that changes is in doubt.

    Raises `GeometryError` where triangles cross in more than 2,000 places, which would take seconds, or as `unite`.
    """
    corners = part.triangles.corners().reshape(-1, 3)
    meetings = crossings(part.triangles, limit=_CROSSINGS)
    if meetings.truncated:
        raise GeometryError(f"{part.name} crosses itself in more than {_CROSSINGS} places: unite it")
    union = unite(part)
    box = np.stack([corners.min(axis=0), corners.max(axis=0)])
    doubt = Doubt.within(box, union.more_than_once, union.negative)
    words = (
        f"crossings: {counted(union.crossings, 'pair')} of triangles cross or lie on one another, and what they enclose"
    )
    finding = _finding("self_intersection", f"{words} twice counts once", union.crossings, doubt, part.unit.name)
    return Mended(union.part, (finding,))


def _finding(code: str, words: str, count: int, doubt: Doubt, unit: str) -> Finding:
    sentence = f"{words}: up to {doubt.volume:.2g} {unit}³ more or less, which is in the bounds"
    x, y, z = doubt.places[int(np.argmax(doubt.either))].tolist()
    return Finding(code, "warning", sentence, count, (), (x, y, z), statement=sentence, doubt=doubt)


def widths(error: ErrorBound, size: float) -> dict[str, float]:
    """Return the relative bounds by quantity, the centre of mass' over the size (m) of the part."""
    return {
        "volume": error.volume,
        "mass": error.mass,
        "tensor": error.inertia,
        "centre of mass": error.center_of_mass / size if size > 0 else math.inf,
    }


def allowance(width: float) -> Remedy | None:
    """Return what to allow for a bound of this width, rounded up to two digits; None where that is too much."""
    named = float(_TWO_DIGITS.create_decimal_from_float(width)) if width > _LEAST else _LEAST
    return ALLOW_FAULTS._replace(value=named) if named <= _MOST else None


def too_wide(part: Part, error: ErrorBound, size: float, allowed: float) -> GeometryError:
    """Return the refusal of a part whose faults leave more open than is allowed."""
    quantity, width = max(widths(error, size).items(), key=lambda item: item[1])
    faults = check(part).faults()
    what = f"{faults[0].statement}; this leaves" if faults else "what repair made up leaves"
    words = f"{what} the {quantity} open to {width:.2g}, above the {allowed:g} allowed: mend the mesh"
    named = allowance(width)
    return GeometryError(words, *(() if named is None else (", or use ", named)), places=(part.name,))


def room(part: Part) -> float:
    """Return the volume of a part, file units, about."""
    return abs(float(solid_moments(part.triangles, "float64").zeroth))
