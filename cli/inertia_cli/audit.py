"""The command `audit`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from inertia_cli.options import by_name, named_number
from inertia_cli.printing import write_and_show

_CODES = {"consistent": 0, "inconsistent": 5, "undecided": 4}

_EXAMPLES = """examples:
  inertia audit robot.urdf
  inertia audit robot.urdf --density 2700 --density motor.stl=7850
  inertia audit robot.urdf --report audit.html --fix mended.urdf
"""


def add(parsers: Any) -> None:
    """Add ``inertia audit``."""
    parser = parsers.add_parser(
        "audit",
        help="a robot's stated mass properties against those of its meshes, and the mistake that explains a difference",
        description="Compare the mass properties that a robot's file states with those of each link's meshes, and "
        "name the mistake that explains a difference; exit code 5 if a link is inconsistent.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part",
        metavar="FILE",
        help="URDF, MJCF, SDFormat, USD, or a list of parts as CSV or TOML; - is standard input",
    )
    parser.add_argument(
        "--density",
        action="append",
        default=[],
        type=named_number,
        metavar="[MESH=]KG/M3",
        help="of all meshes, or of the file MESH (repeat it); without it, one that gives the stated mass",
    )
    parser.add_argument(
        "--tolerance",
        type=float,
        default=0.02,
        metavar="REL",
        help="relative difference up to which stated and computed agree (0.02)",
    )
    parser.add_argument(
        "--lump", action="store_true", help="count links that hang together by fixed joints as one, as simulators do"
    )
    parser.add_argument("--report", metavar="FILE.html", help="write a report with a picture of each link")
    parser.add_argument(
        "--fix",
        metavar="OUT",
        help="write the file anew, with the mistaken links mended and nothing else changed",
    )
    parser.add_argument("--force", action="store_true", help="replace files that are there")
    parser.add_argument("--json", action="store_true", help="print one JSON document (inertia/audit/1)")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia audit``."""
    from inertia.auditing.audit import audit
    from inertia.exchange.robots.read import lost_by
    from inertia.output import require_writable, together, write_whole
    from inertia.report.audit.document import audit_document
    from inertia.report.audit.text import audit_text

    if options.report is not None:
        require_writable(options.report, ".html", force=options.force)
    if options.fix is not None:
        suffixes = filter(None, [Path(options.part).suffix.lower()])
        require_writable(options.fix, *suffixes, force=options.force)
    result = audit(
        options.part,
        densities=by_name("density", options.density),
        tolerance=options.tolerance,
        lump=options.lump,
    )

    def write() -> None:
        with together():
            if options.report is not None:
                from inertia.report.audit.html import write_audit

                write_audit(result, options.report, force=options.force)
            if options.fix is not None:
                write_whole(Path(options.fix), result.fixed())

    write_and_show(write, options.json, lambda: audit_document(result), lambda: audit_text(result))
    if options.fix is not None:
        for sentence in (*result.unmended, lost_by(result.robot, Path(options.fix))):
            if sentence:
                print(f"inertia: {options.fix}: {sentence}", file=sys.stderr)
    return _CODES[result.verdict]
