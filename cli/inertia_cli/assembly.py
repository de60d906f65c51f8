"""The command `assembly`."""

from __future__ import annotations

import argparse
import math
from typing import Any

from inertia_cli.printing import print_document, show


def add(parsers: Any) -> None:
    """Add ``inertia assembly``."""
    parser = parsers.add_parser(
        "assembly",
        help="a tree of parts: mass properties of the whole, with their bound, and what each part contributes",
        description="Place the parts of an assembly, and add them up: mass, centre of mass and tensor of the whole "
        "with their certified bound; exit code 5 where parts interfere and that is asked for.",
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part", nargs="?", metavar="FILE", help="assembly file (TOML), or bill of materials (CSV); - is standard input"
    )
    parser.add_argument(
        "--interference", action="store_true", help="look for parts that share space; exit code 5 where there are some"
    )
    parser.add_argument(
        "--clearance",
        type=float,
        metavar="LENGTH",
        help="and for those that are nearer to each other, in the file's unit",
    )
    parser.add_argument("--schema", action="store_true", help="print the JSON Schema of an assembly file")
    parser.add_argument("--json", action="store_true", help="print one JSON document (inertia/assembly/1)")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia assembly``."""
    from inertia.assembly.document import Assembly, json_schema
    from inertia.errors import UsageError

    if options.schema:
        print_document(json_schema())
        return 0
    if options.part is None:
        raise UsageError("no assembly is named: give an assembly file, see `inertia assembly --help`")
    from inertia.report.budget.document import assembly_document
    from inertia.report.budget.text import assembly_text

    if options.clearance is not None and not 0 <= options.clearance < math.inf:
        raise UsageError(f"the clearance is {options.clearance:g}: it must be a length that is not negative")
    assembly = Assembly.load(options.part)
    asked = options.interference or options.clearance is not None
    clearance = (options.clearance or 0.0) * float(assembly.unit.metres)
    pairs = assembly.interferences(clearance) if asked else None
    show(options.json, lambda: assembly_document(assembly, pairs), lambda: assembly_text(assembly, pairs))
    return 5 if pairs else 0
