"""Repairing a part on request, with what the repair did to its volume, centre of mass and tensor."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np

from inertia.errors import require_kind
from inertia.mass.density import number_of
from inertia.mass.doubt import FILLED, doubt_error
from inertia.mass.moments import Moments, inertia_tensor
from inertia.mass.properties import ErrorBound
from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mesh import repair as mesh_repair
from inertia.mesh.part import Part
from inertia.mesh.repair import Change, Repair
from inertia.records import dataclass


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

    def _repr_html_(self) -> str:
        """Return a small table with what was changed, as a notebook shows it."""
        from inertia.notebook import html_of

        rows = [
            ("Repaired", self.part.name),
            *(("Changed", f"{each.what}: {each.count}") for each in self.changes),
            ("Volume", f"{self.volume_before:.10g} m³ before, {self.volume_after:.10g} m³ after"),
        ]
        if self.center_of_mass_shift is not None:
            rows.append(("Moved", f"centre of mass by {self.center_of_mass_shift:.2g} m"))
        if self.inertia_change is not None:
            rows.append(("Tensor", f"changed by {self.inertia_change:.2g}, relative"))
        if self.volume_between is not None:
            rows.append(("Certain", "a volume from {:.10g} to {:.10g} m³".format(*self.volume_between)))
        return html_of(rows)


def repair(part: Part, tolerance: float | None = None, *, alike: bool = False) -> Repaired:
    """Repair the surface of a part (see `inertia.mesh.repair` for the steps) and measure the effect.

    Parameters
    ----------
    tolerance : vertices within this distance of each other, in the part's unit, become one; without it only
        those at cracks of at most 1e-6 of the part's size
    alike : whether all regions are of one density, so that it does not matter which of them has what several claim

    Raises
    ------
    GeometryError : the surface cannot be closed, or regions claim the same place
    UsageError : the tolerance is not usable

    >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
    >>> [str(change) for change in repair(part).changes]
    ['holes filled: 1 (of 3 edges around (0, 0.333333333, 0.333333333))']
    """
    require_kind(part, Part, "part", "inertia.read(path)")
    if tolerance is not None:
        tolerance = number_of(tolerance, "tolerance", part.unit.name)
    return _with_effect(part, mesh_repair.repair(part, tolerance=tolerance, alike=alike))


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
    require_kind(part, Part, "part", "inertia.read(path)")
    return _with_effect(part, mesh_repair.weld(part, number_of(tolerance, "tolerance", part.unit.name)))


def _with_effect(part: Part, repair: Repair) -> Repaired:
    before = solid_moments(part.triangles, "float64")
    after = solid_moments(repair.part.triangles, "float64") if repair.changes else before
    unit = part.unit.metres
    result = _compared(repair, before, after, unit)
    if (filling := repair.part.filling) is None:
        return result
    volume = unit**3 * after.zeroth
    error = doubt_error(filling, repair.part.unit, after.in_unit(unit).scaled(unit**3), volume, Fraction(1), FILLED)
    less, more = (float(unit) ** 3 * float(side.sum()) for side in (filling.inward, filling.outward))
    between = max(result.volume_after - less, 0.0), result.volume_after + more
    return replace(result, volume_between=between, error=error)


def _compared(repair: Repair, before: Moments, after: Moments, unit: Fraction) -> Repaired:
    volumes = [float(unit**3 * moments.zeroth) for moments in (before, after)]
    if abs(before.zeroth) <= before.zeroth_bound or abs(after.zeroth) <= after.zeroth_bound:
        return Repaired(repair.part, repair.changes, volumes[0], volumes[1], None, None)
    shift = [float((b - a) * unit) for a, b in zip(before.centroid, after.centroid, strict=True)]
    old, new = (np.array(inertia_tensor(moments.central().second)) for moments in (before, after))
    change = math.sqrt(((new - old) ** 2).sum() / (new**2).sum())
    return Repaired(repair.part, repair.changes, volumes[0], volumes[1], math.hypot(*shift), change)
