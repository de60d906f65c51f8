"""`Report` of a check → text, and the document ``inertia/check/1``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from inertia.arrays import Orientation
from inertia.errors import GeometryError, Sentence, Wording
from inertia.mesh.checks.findings import Report, counted
from inertia.mesh.part import Part
from inertia.report.numerals import row

if TYPE_CHECKING:
    from inertia.mass.analysis import Analysis


def check_document(
    part: Part,
    report: Report,
    orientation: Orientation = "stored",
    *,
    allowed: Analysis | GeometryError | None = None,
    wording: Wording = str,
) -> dict[str, Any]:
    """Return what a check found as ``inertia/check/1``; lengths and places are in the part's unit.

    `allowed` is the answer, or its refusal, that allowing for the faults leads to, where that was asked for.
    """
    document = {
        "schema": "inertia/check/1",
        "source": part.source.to_dict(),
        "unit": part.unit.name,
        "unit_from": part.unit_from,
        "fit": not report.faults(orientation),
        "orientation": orientation,
        "triangles": report.triangles,
        "vertices": report.vertices,
        "closed": report.closed,
        "consistent": report.consistent,
        "outward": report.outward,
        "bodies": report.bodies,
        "crossings_examined": report.crossings_examined,
        "shells": [
            {
                "kind": shell.kind,
                "triangles": shell.triangles,
                "first_triangle": shell.first,
                "signed_volume": shell.signed_volume,
                "box": shell.box.tolist(),
                "depth": shell.depth,
                "parent": shell.parent,
            }
            for shell in report.shells
        ],
        "loops": [
            {"edges": loop.edges, "length": loop.length, "place": list(loop.place), "triangle": loop.triangle}
            for loop in report.loops
        ],
        "findings": [
            {
                "code": finding.code,
                "severity": finding.severity,
                "message": Sentence(finding.message).worded(wording),
                "count": finding.count,
                "faces": list(finding.faces),
                "place": None if finding.place is None else list(finding.place),
            }
            for finding in report.findings
        ],
        "notes": list(part.notes),
    }
    if isinstance(allowed, GeometryError):
        document["allowed_faults"] = {"answered": False, "message": allowed.sentence.worded(wording)}
    elif allowed is not None:
        error = allowed.properties.error
        document["allowed_faults"] = {
            "answered": True,
            "changes": _changes(part, allowed),
            "doubts": [Sentence(finding.message).worded(wording) for finding in allowed.doubts],
            "error": {
                "volume": error.volume,
                "mass": error.mass,
                "center_of_mass": error.center_of_mass,
                "inertia": error.inertia,
            },
        }
    return document


def check_text(
    part: Part,
    report: Report,
    orientation: Orientation = "stored",
    *,
    allowed: Analysis | GeometryError | None = None,
    wording: Wording = str,
) -> str:
    """Return what a check found as lines of text, the most important finding first; see `check_document`."""
    faults = report.faults(orientation)
    verdict = f"not fit for integration: {counted(len(faults), 'fault')}" if faults else "fit for integration"
    lines = [
        row("Part", f"{part.name} ({part.source.format}), places in {part.unit.name}"),
        row("Verdict", verdict),
        row("Mesh", ", ".join(report.state)),
    ]
    for finding in report.findings:
        turned = finding.severity == "error" and finding not in faults
        lines.append(row("forgiven" if turned else finding.severity, Sentence(finding.message).worded(wording)))
    lines += [row("note", note) for note in part.notes]
    if isinstance(allowed, GeometryError):
        lines.append(row("Allowed for", f"no answer: {allowed.sentence.worded(wording)}"))
    elif allowed is not None:
        lines += [row("Allowed for", change) for change in _changes(part, allowed)]
        lines += [row("In doubt", Sentence(finding.message).worded(wording)) for finding in allowed.doubts]
        error = allowed.properties.error
        bounds = f"volume {error.volume:.2g}, mass {error.mass:.2g}, tensor {error.inertia:.2g} (relative),"
        lines += [row("Error bound", bounds), row("", f"centre of mass {error.center_of_mass:.2g} m")]
    return "\n".join(lines)


def _changes(part: Part, allowed: Analysis) -> list[str]:
    """Return what an answer changed of a part, in sentences."""
    return list(allowed.part.notes[len(part.notes) :])
