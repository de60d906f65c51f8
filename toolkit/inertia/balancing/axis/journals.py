"""Candidates for the axis of a rotor: cylinders fitted to the vertices of its mesh, coaxial ones together, ranked.

What is found is offered, never chosen: where a rotor really runs, its drawing says. Lengths are in the mesh's own unit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from inertia.arrays import Float, Int
from inertia.balancing.axis.cylinder_fit import AxisFit, fit_axis
from inertia.balancing.axis.cylinder_patches import Facets, Patch, along_walls, directions, patches, turn_covered
from inertia.errors import UsageError
from inertia.mass.tensor import array_of
from inertia.mesh.repairs.weld import require_finite
from inertia.mesh.surface import Triangles
from inertia.records import dataclass

TOLERANCE = 2e-4
"""How far vertices may be off their cylinder, and cylinders off a common axis: of the mesh's diagonal."""

LEAST_COVERAGE = 0.25
"""Share of the full turn below which a cylinder is not a journal."""

_ROUGHLY = 5.0  # degrees
_SIGMAS = 3.0
_PARALLEL = math.cos(math.radians(1.0))


@dataclass(frozen=True, eq=False)
class Journal:
    """A cylinder on an axis.

    Attributes
    ----------
    center : (3,) on the axis, at the middle of its length
    radius, length : in the mesh's unit
    coverage : share of the full turn, 0 to 1
    area : of its triangles
    rms : of its vertices' distances from the cylinder
    bore : the material is outside
    """

    center: Float
    radius: float
    length: float
    coverage: float
    area: float
    rms: float
    bore: bool


@dataclass(frozen=True, eq=False)
class AxisCandidate:
    """An axis that cylinders have in common.

    Attributes
    ----------
    point : (3,) on the axis
    direction : (3,) unit; its largest component is positive
    journals : its cylinders in the order along the axis
    score : Σ area × coverage, by which candidates are ranked
    rms : of all vertices' distances from their cylinders
    uncertainty : standard deviation of the axis at the end of the farthest journal, from the scatter of the vertices
    """

    point: Float
    direction: Float
    journals: tuple[Journal, ...]
    score: float
    rms: float
    uncertainty: float


def axis_candidates(
    triangles: Triangles, *, along: ArrayLike | None = None, tolerance: float | None = None
) -> tuple[AxisCandidate, ...]:
    """Return the axes that a part's cylinders lie on, the likeliest first; none where it has no cylinder.

    Parameters
    ----------
    triangles : the surface
    along : (3,) the direction of the axis to within 5°, where it is known; else directions are found from the shape
    tolerance : in the mesh's unit, of vertices off their cylinder and of cylinders off their common axis; 2e-4 of the
        mesh's diagonal where it is not given

    Raises `GeometryError` where a coordinate is not finite.

    >>> from importlib.resources import files
    >>> from inertia.mesh.read import read
    >>> axes = axis_candidates(read(files("inertia_meshes") / "two_disc_rotor.stl").triangles)
    >>> [(round(k.radius, 3), round(k.length, 3)) for k in axes[0].journals]
    [(15.0, 80.0), (100.0, 20.0), (15.0, 100.0), (80.0, 30.0), (15.0, 70.0)]
    """
    require_finite(triangles)
    mesh = Facets.of(triangles)
    if not mesh.areas.any():
        return ()
    allowed = TOLERANCE * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))) if tolerance is None else tolerance
    if not 0 < allowed < math.inf:
        raise UsageError(f"the tolerance is {allowed!r}: it must be positive and finite")
    if along is None:
        tried = directions(mesh)
    else:
        vector = array_of(along, (3,), "along")
        if not vector.any():
            raise UsageError("along has no length: give a direction")
        tried = [along_walls(mesh, vector / np.linalg.norm(vector), _ROUGHLY)]
    axes = [axis for direction in tried for axis in _axes_along(mesh, direction, allowed)]
    distinct: list[AxisCandidate] = []
    for axis in sorted(axes, key=lambda axis: -axis.score):
        if not any(_same_axis(axis, other, allowed) for other in distinct):
            distinct.append(axis)
    return tuple(distinct)


def _same_axis(axis: AxisCandidate, other: AxisCandidate, tolerance: float) -> bool:
    """Say whether the cylinders of a candidate lie on another candidate's axis."""
    apart = (np.linalg.norm(np.cross(k.center - other.point, other.direction)) for k in axis.journals)
    return abs(float(axis.direction @ other.direction)) > _PARALLEL and float(max(apart)) <= tolerance


def _axes_along(mesh: Facets, direction: Float, tolerance: float) -> list[AxisCandidate]:
    """Return the axes along a direction, once as it is given and then along the best of those found."""
    axes = _axes(mesh, direction, tolerance)
    best = max(axes, key=lambda axis: axis.score, default=None)
    if best is None or abs(float(best.direction @ direction)) < _PARALLEL:
        return axes
    return _axes(mesh, best.direction, tolerance)


def _axes(mesh: Facets, direction: Float, tolerance: float) -> list[AxisCandidate]:
    """Return the axes along a direction: again and again the best patch that is left, with all that share its axis."""
    remaining = sorted(patches(mesh, direction, tolerance), key=lambda patch: -patch.area * patch.coverage)
    axes = []
    while remaining:
        group = remaining[:1]
        fit = _fit(mesh, group, direction)
        for _ in range(2):  # the axis of one patch, and then that of all, say which patches belong to it
            if fit is None:
                break
            group = [patch for patch in remaining if _shares(fit, patch, tolerance)] or remaining[:1]
            fit = _fit(mesh, group, fit.direction)
        if fit is None:
            remaining = remaining[1:]
            continue
        used = {id(patch) for patch in group} | {id(remaining[0])}
        remaining = [patch for patch in remaining if id(patch) not in used]
        axis = _candidate(mesh, group, fit, tolerance)
        if axis is not None:
            axes.append(axis)
    return axes


def _shares(fit: AxisFit, patch: Patch, tolerance: float) -> bool:
    return fit.offset(patch.center) <= tolerance + _SIGMAS * fit.uncertainty(patch.center)


def _fit(mesh: Facets, group: Sequence[Patch], direction: Float) -> AxisFit | None:
    points = mesh.vertices[np.concatenate([patch.vertices for patch in group])]
    return fit_axis(points, _members(group), direction, group[0].center)


def _members(group: Sequence[Patch]) -> Int:
    return np.repeat(np.arange(len(group)), [len(patch.vertices) for patch in group])


def _candidate(mesh: Facets, group: Sequence[Patch], fit: AxisFit, tolerance: float) -> AxisCandidate | None:
    member = _members(group)
    squares = np.bincount(member, fit.residuals**2)
    journals = [
        _journal(mesh, [group[k] for k in together], fit, float(squares[together].sum()))
        for together in _merged(mesh, group, fit, tolerance)
    ]
    covering = [journal for journal in journals if journal.coverage >= LEAST_COVERAGE]
    if not covering:
        return None
    sign = float(np.sign(fit.direction[np.argmax(np.abs(fit.direction))]))
    direction = sign * fit.direction
    covering.sort(key=lambda journal: float(journal.center @ direction))
    ends = [k.center + 0.5 * k.length * side * direction for k in covering for side in (-1.0, 1.0)]
    return AxisCandidate(
        fit.point,
        direction,
        tuple(covering),
        sum(k.area * k.coverage for k in covering),
        fit.rms,
        max(fit.uncertainty(end) for end in ends),
    )


def _merged(mesh: Facets, group: Sequence[Patch], fit: AxisFit, tolerance: float) -> list[list[int]]:
    """Return which patches are one cylinder: of the same radius and side, and beside each other."""
    heights = [mesh.vertices[patch.vertices] @ fit.direction for patch in group]
    spans = [(float(height.min()), float(height.max())) for height in heights]
    groups: list[list[int]] = []
    for k in sorted(range(len(group)), key=lambda k: spans[k]):
        for together in groups:
            last = together[-1]
            same = group[k].bore == group[last].bore and abs(fit.radii[k] - fit.radii[last]) <= tolerance
            if same and spans[k][0] < max(spans[j][1] for j in together) - tolerance:
                together.append(k)
                break
        else:
            groups.append([k])
    return groups


def _journal(mesh: Facets, together: Sequence[Patch], fit: AxisFit, squares: float) -> Journal:
    points = mesh.vertices[np.concatenate([patch.vertices for patch in together])]
    height = (points - fit.point) @ fit.direction
    low, high = float(height.min()), float(height.max())
    radius = float(np.linalg.norm(np.cross(points - fit.point, fit.direction), axis=1).mean())
    return Journal(
        center=fit.point + 0.5 * (low + high) * fit.direction,
        radius=radius,
        length=high - low,
        coverage=turn_covered(mesh, [patch.faces for patch in together], fit.point, fit.direction),
        area=sum(patch.area for patch in together),
        rms=math.sqrt(squares / len(points)),
        bore=together[0].bore,
    )
