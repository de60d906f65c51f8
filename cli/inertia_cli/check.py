"""The command `check`."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from inertia.errors import GeometryError
from inertia_cli.options import add_faults, add_input, add_intersections, add_orientation, add_parts, read_part
from inertia_cli.printing import show
from inertia_cli.wording import as_option

if TYPE_CHECKING:
    from inertia.mass.analysis import Analysis
    from inertia.mesh.part import Part

_UNFIT = 4

_EXAMPLES = """examples:
  inertia check part.stl
  inertia check assembly.3mf --intersections --json
  inertia check scan.stl --allow-faults 1%
"""


def add(parsers: Any) -> None:
    """Add ``inertia check``."""
    parser = parsers.add_parser(
        "check",
        help="closed, wound, overlapping? each finding says where",
        description="Check whether a mesh bounds an honest volume; exit code 4 if it does not.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    add_input(parser)
    add_orientation(parser)
    add_intersections(parser)
    add_parts(parser)
    add_faults(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON document (inertia/check/1)")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia check``."""
    from inertia.mesh.check import check as check_part
    from inertia.report.check import check_document, check_text

    part, hashing = read_part(options)
    report = check_part(part, intersections=options.intersections, parts=options.parts)
    faulty = bool(report.faults(options.orientation))
    allowed = None if options.allow_faults is None or not faulty else _allowed(part, options)
    hashing.join()
    show(
        options.json,
        lambda: check_document(part, report, options.orientation, allowed=allowed, wording=as_option),
        lambda: check_text(part, report, options.orientation, allowed=allowed, wording=as_option),
    )
    return _UNFIT if faulty and (allowed is None or isinstance(allowed, GeometryError)) else 0


def _allowed(part: Part, options: argparse.Namespace) -> Analysis | GeometryError:
    """Return the answer that allowing for the faults leads to, or why there is none."""
    from inertia.mass.analyse import analyse

    try:
        return analyse(
            part,
            orientation=options.orientation,
            intersections=options.intersections,
            parts=options.parts,
            allow_faults=options.allow_faults,
        )
    except GeometryError as refusal:
        return refusal
