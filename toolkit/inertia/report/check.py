"""`Report` of a check → text, and the document ``inertia/check/1``."""

from __future__ import annotations

from typing import Any

from inertia.arrays import Orientation
from inertia.errors import Sentence, Wording
from inertia.mesh.checks.findings import Report, counted
from inertia.mesh.part import Part
from inertia.report.numerals import row


def check_document(
    part: Part, report: Report, orientation: Orientation = "stored", *, wording: Wording = str
) -> dict[str, Any]:
    """Return what a check found as ``inertia/check/1``; lengths and places are in the part's unit."""
    return {
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


def check_text(part: Part, report: Report, orientation: Orientation = "stored", *, wording: Wording = str) -> str:
    """Return what a check found as lines of text, the most important finding first."""
    faults = report.faults(orientation)
    verdict = f"not fit for integration: {counted(len(faults), 'fault')}" if faults else "fit for integration"
    lines = [
        row("Part", f"{part.name} ({part.source.format}), places in {part.unit.name}"),
        row("Verdict", verdict),
        row("Mesh", ", ".join(_state(report))),
    ]
    for finding in report.findings:
        turned = finding.severity == "error" and finding not in faults
        lines.append(row("forgiven" if turned else finding.severity, Sentence(finding.message).worded(wording)))
    lines += [row("note", note) for note in part.notes]
    return "\n".join(lines)


def _state(report: Report) -> list[str]:
    facing = {True: ["facing outward"], False: ["facing inward"], None: []}[report.outward]
    return [
        counted(report.triangles, "element"),
        counted(report.vertices, "vertex", "vertices"),
        "closed" if report.closed else "open",
        "consistently wound" if report.consistent else "wound inconsistently",
        *facing,
        counted(report.bodies, "body", "bodies"),
        "crossings examined" if report.crossings_examined else "crossings not examined",
    ]
