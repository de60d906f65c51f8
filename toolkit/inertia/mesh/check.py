"""`check`: whether a part bounds a volume (closed, wound, free of overlaps), and if not, what is wrong and where."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields, replace

import numpy as np

from inertia.arrays import Float, Int, Parts
from inertia.errors import UsageError, require_kind
from inertia.mesh.checks.cells import CellTopology
from inertia.mesh.checks.findings import Evidence, Finding, Report, Severity, listed
from inertia.mesh.checks.kinds import Subject, findings
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.geometry.edges import pieces
from inertia.mesh.geometry.intersect import to_be_examined
from inertia.mesh.part import Cells, Part
from inertia.mesh.surface import Surface, counts_once
from inertia.once import once
from inertia.records import dataclass

_IN_TURN: tuple[Subject, ...] = ("maps", "sides", "space")
_ORDER: tuple[Severity, ...] = ("error", "warning", "note")


def check(
    part: Part, *, intersections: bool | None = None, parts: Parts = "together", allowance: float = 0.0
) -> Report:
    """Check a part; no geometry makes it raise, see `Report.require_fit` for that.

    Parameters
    ----------
    part : a surface or a mesh of cells
    intersections : whether to look for triangles of one shell that cross each other; without it, up to 200,000
        triangles that bound a volume are looked through, and any number where more than two share an edge; for
        volume cells that share space, which the triangles between the outer nodes of a mesh of cells show
    parts : "separate" takes each body of a surface by itself: what they share is no fault, but in doubt
    allowance : volume, in the part's unit, that a shell that crosses itself may enclose twice and be in doubt only

    >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3]], unit="mm")
    >>> report = check(part)
    >>> report.fit, report.findings[0].code, report.loops[0].edges
    (False, 'open', 3)
    """
    require_kind(part, Part, "part", "inertia.read(path)")
    if parts not in ("together", "separate"):
        raise UsageError(f"parts is {parts!r}: use 'together' or 'separate'")
    surface = part.geometry

    def report() -> Report:
        if isinstance(surface, Cells):
            return _check_cells(part, CellTopology(surface, part.unit.name), intersections)
        if unusable := next(findings("triangles", surface), None):
            return _nothing_to_measure(part, surface.count, unusable)
        topology = SurfaceTopology.of(part, separate=parts == "separate", room=allowance)
        return check_surface(part, topology, intersections)

    return once(("report", intersections, parts, allowance), part, report)


@dataclass(frozen=True, eq=False)
class _WholeShells(SurfaceTopology):
    """Some shells of a surface; `numbers` (m,) says which triangles they have in it."""

    numbers: Int

    def as_numbered(self, evidence: Evidence) -> Evidence:
        """Return evidence whose triangles have their numbers in the part."""
        return replace(evidence, faces=listed(self.numbers[list(evidence.faces)]))


def check_some(part: Part, which: Int, box: Float) -> Report:
    """Check some triangles by themselves, for all but triangles of one shell that cross.

    Parameters
    ----------
    part : a surface whose triangles do not stand for another shape, and of which no holes were filled
    which : (k,), the numbers of the triangles, ascending: whole shells with usable coordinates
    box : (2, 3), that of all triangles; findings state numbers and places as those of all do
    """
    corners = part.triangles.select(which).corners().reshape(-1, 3)
    surface = Surface(corners, np.arange(len(corners)).reshape(-1, 3))
    some = Part(surface, part.unit, part.unit_from, part.source)
    topology = SurfaceTopology.of(some)
    # With the corners of the box, contacts may be as deep as in the whole part, and places have as many digits.
    known = {each.name: getattr(topology, each.name) for each in fields(topology)}
    known["vertices"] = np.concatenate([topology.vertices, box])
    return check_surface(some, _WholeShells(**known, numbers=which), False)


def check_surface(part: Part, surface: SurfaceTopology, intersections: bool | None) -> Report:
    """Check a surface whose topology is known."""
    triangles, separate = surface.triangles, surface.separate
    remarks = [*findings("surface", surface)]
    flat = [*findings("volume", surface)] if surface.bounds else []
    if surface.bounds:
        remarks += flat or findings("shells", surface, separate=separate)
    bounds_volume = surface.bounds and not flat
    proven = surface.bounds and counts_once(triangles)
    examined = to_be_examined(triangles, intersections, surface.closure.crowded) and (
        bounds_volume or intersections is True
    )
    if examined and not proven:
        remarks += findings("crossings", surface)
    if proven:  # what is left of errors is the rounding of its vertices
        remarks = [finding for finding in remarks if finding.severity != "error"]
    elif bounds_volume and not any(finding.severity == "error" for finding in remarks):
        remarks += findings("contacts", surface)
    return Report(
        source=part.source,
        triangles=triangles.count,
        vertices=len(surface.vertices),
        closed=surface.closed,
        consistent=surface.consistent,
        outward=surface.outward,
        bodies=len(surface.bodies) if surface.bounds else pieces(surface.edges),
        shells=surface.shells,
        loops=surface.loops,
        findings=_by_severity(remarks),
        crossings_examined=examined or proven,
    )


def _check_cells(part: Part, mesh: CellTopology, intersections: bool | None) -> Report:
    if unusable := next(findings("nodes", mesh), None):
        return _nothing_to_measure(part, mesh.cells.count, unusable)
    remarks = [*findings("cells", mesh)]
    examined = False
    for subject in _IN_TURN:
        if any(finding.severity == "error" for finding in remarks):
            break
        if subject == "space":
            outside, _ = mesh.boundary
            examined = outside.count > 0 and to_be_examined(outside, intersections)
        if subject != "space" or examined:
            remarks += findings(subject, mesh)
    return Report(
        source=part.source,
        triangles=mesh.cells.count,
        vertices=int(np.count_nonzero(np.bincount(mesh.merged[mesh.used]))),
        closed=int(mesh.bodies.max()) >= 0,
        consistent=True,
        outward=None,
        bodies=int(mesh.bodies.max()) + 1,
        shells=(),
        loops=(),
        findings=_by_severity(remarks),
        crossings_examined=examined,
    )


def _nothing_to_measure(part: Part, count: int, finding: Finding) -> Report:
    return Report(part.source, count, 0, False, False, None, 0, (), (), (finding,))


def _by_severity(remarks: Iterable[Finding]) -> tuple[Finding, ...]:
    return tuple(sorted(remarks, key=lambda finding: _ORDER.index(finding.severity)))
