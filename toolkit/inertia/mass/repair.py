"""Repairing a part on request, with what the repair did to its volume, centre of mass and tensor."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from inertia.errors import GeometryError
from inertia.mass.moments import PAIRS, ZERO, Moments, Vector, inertia_tensor, six, vector
from inertia.mass.properties import ErrorBound
from inertia.mass.tessellation import error_within
from inertia.mass.triangles.moments_from_sums import moments_of
from inertia.mass.triangles.sums import sum_triangles
from inertia.mesh import repair as mesh_repair
from inertia.mesh.part import Guess, Part
from inertia.mesh.repair import Change, Repair

_METHOD = "bounds over the closures that the rims of the filled holes admit"
_ROUNDED_UP = Fraction(1) + Fraction(1, 10**9)  # more than float64 sums of positive terms can lose


@dataclass(frozen=True)
class Repaired:
    """A repaired part, every change that was made, and how far the answer moved.

    The integral before the repair is the one over the triangles that there were, about the middle of the part: of
    a surface with holes it is no volume, but it shows the size of the change.

    Attributes
    ----------
    part : the part to go on with; the one given where nothing was changed
    changes : what was changed, in the order it was done
    volume_before, volume_after : m³
    center_of_mass_shift : m; None where there was no volume before
    inertia_change : Frobenius norm of the change of the tensor about the centre of mass (at equal density), as a
        part of the new tensor; None where there was no volume before
    volume_between : m³, least and most volume that the rims of the holes admit, where some were filled
    error : how far volume, centre of mass and tensor (at equal density) may be off for that; infinite where nothing is
        certain of them
    """

    part: Part
    changes: tuple[Change, ...]
    volume_before: float
    volume_after: float
    center_of_mass_shift: float | None
    inertia_change: float | None
    volume_between: tuple[float, float] | None = None
    error: ErrorBound | None = None


def repair(part: Part, tolerance: float | None = None) -> Repaired:
    """Repair the surface of a part (see `inertia.mesh.repair` for the steps) and measure the effect.

    Parameters
    ----------
    tolerance : vertices within this distance of each other, in the part's unit, become one; without it only
        those at cracks of at most 1e-6 of the part's size

    Raises
    ------
    GeometryError : the surface cannot be closed
    UsageError : the tolerance is not usable

    >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
    >>> [str(change) for change in repair(part).changes]
    ['holes filled: 1 (of 3 edges around (0, 0.333333333, 0.333333333))']
    """
    return _with_effect(part, mesh_repair.repair(part, tolerance=tolerance))


def weld(part: Part, tolerance: float) -> Repaired:
    """Let the vertices within `tolerance` (the part's unit) of each other become one, and measure the effect.

    Closeness chains, so that a vertex may go farther than the tolerance: the change says how far.

    Raises
    ------
    GeometryError : a coordinate is not finite
    UsageError : the tolerance is not above 0, or exceeds a tenth of the diagonal of the part's box

    >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1e-9, 0, 0]],
    ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3], [4, 3, 2]])
    >>> [str(change) for change in weld(part, 1e-6).changes]
    ['vertices within the tolerance merged: 1 (0 triangles collapsed and left out), moved by at most 1e-09']
    """
    return _with_effect(part, mesh_repair.weld(part, tolerance))


def _with_effect(part: Part, repair: Repair) -> Repaired:
    before = moments_of(sum_triangles(part.triangles))
    after = moments_of(sum_triangles(repair.part.triangles)) if repair.changes else before
    unit = part.unit.metres
    result = _compared(repair, before, after, unit)
    if (guess := repair.part.guess) is None:
        return result
    volume = unit**3 * after.zeroth
    error = guess_error(repair.part, after.in_unit(unit).scaled(unit**3), volume, Fraction(1))
    less, more = (float(unit) ** 3 * float(side.sum()) for side in (guess.inward, guess.outward))
    between = max(result.volume_after - less, 0.0), result.volume_after + more
    return replace(result, volume_between=between, error=error)


def guess_error(
    part: Part, moments: Moments, volume: Fraction, density: Fraction, mass: Fraction | None = None
) -> ErrorBound:
    """Return the relative bounds that the closures admitted by the rims of filled holes leave.

    Parameters
    ----------
    part : with its `guess`
    moments : of mass, kg and m
    volume : m³
    density : kg/m³, the largest of any body
    mass : kg, where it was weighed: then it has no error of this kind
    """
    assert part.guess is not None
    f = part.unit.metres
    central = moments.about(moments.centroid)
    origin = vector(k / f for k in central.origin)
    between = _room(part.guess, origin).in_unit(f).scaled(f**3 * density)
    try:
        return error_within(central, volume, between, density, mass, _METHOD)
    except GeometryError:
        share = float(between.zeroth_bound / density / volume) if volume > 0 else math.inf
        return ErrorBound(_METHOD, share, share if mass is None else 0.0, math.inf, math.inf)


def _room(guess: Guess, origin: Vector) -> Moments:
    """Return bounds on the moments of the room that the rims leave; in file units."""
    away = np.abs(guess.places - [float(k) for k in origin]) + guess.reach[:, None]
    either = guess.outward + guess.inward
    first = (_up(float(either @ away[:, axis])) for axis in range(3))
    second = (_up(float((either * away[:, i]) @ away[:, j])) for i, j in PAIRS)
    volume = _up(float(max(guess.outward.sum(), guess.inward.sum())))
    return Moments(origin, ZERO, (ZERO,) * 3, (ZERO,) * 6, volume, vector(first), six(second))


def _up(value: float) -> Fraction:
    return Fraction(value) * _ROUNDED_UP


def _compared(repair: Repair, before: Moments, after: Moments, unit: Fraction) -> Repaired:
    volumes = [float(unit**3 * moments.zeroth) for moments in (before, after)]
    if abs(before.zeroth) <= before.zeroth_bound or abs(after.zeroth) <= after.zeroth_bound:
        return Repaired(repair.part, repair.changes, volumes[0], volumes[1], None, None)
    shift = [float((b - a) * unit) for a, b in zip(before.centroid, after.centroid, strict=True)]
    old, new = (np.array(inertia_tensor(moments.central().second)) for moments in (before, after))
    change = math.sqrt(((new - old) ** 2).sum() / (new**2).sum())
    return Repaired(repair.part, repair.changes, volumes[0], volumes[1], math.hypot(*shift), change)
