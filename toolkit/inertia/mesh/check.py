"""Check a part: is its volume an honest one, and if not, what is wrong and where."""

from __future__ import annotations

from inertia.errors import require_kind
from inertia.mesh.checks.cells import cell_bodies, check_cells
from inertia.mesh.checks.crossings import self_intersections
from inertia.mesh.checks.faces import face_findings, unusable
from inertia.mesh.checks.findings import Finding, Report, by_severity
from inertia.mesh.checks.shells import outward, shell_findings
from inertia.mesh.checks.surface_topology import measure
from inertia.mesh.geometry.edges import pieces
from inertia.mesh.geometry.shells import bodies
from inertia.mesh.part import Cells, Part

__all__ = ["Finding", "Report", "cell_bodies", "check"]


def check(part: Part, *, intersections: bool = False) -> Report:
    """Check a part; no geometry makes it raise, see `Report.require_fit` for that.

    Parameters
    ----------
    part : a surface or a mesh of cells
    intersections : look also for triangles of one shell that cross each other, which is slow

    >>> part = Part.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3]], unit="mm")
    >>> report = check(part)
    >>> report.fit, report.findings[0].code, report.loops[0].edges
    (False, 'open', 3)
    """
    require_kind(part, Part, "part", "inertia.read(path)")
    if isinstance(part.geometry, Cells):
        return check_cells(part, part.geometry)
    triangles = part.geometry
    nothing = unusable(triangles)
    if nothing is not None:
        return Report(part.source, triangles.count, 0, False, False, None, 0, (), (), (nothing,))
    surface = measure(triangles, part.unit.name)
    crossed = self_intersections(surface) if intersections else None
    return Report(
        source=part.source,
        triangles=triangles.count,
        vertices=len(surface.vertices),
        closed=surface.closed,
        consistent=surface.consistent,
        outward=outward(surface.shells),
        bodies=len(bodies(surface.shells)) if surface.bounds else pieces(surface.edges),
        shells=surface.shells,
        loops=surface.loops,
        findings=by_severity([*face_findings(surface), *shell_findings(surface), crossed]),
    )
