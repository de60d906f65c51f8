"""The command `assembly`."""

from __future__ import annotations

import argparse
from typing import Any

from inertia_cli.printing import print_document, show


def add(parsers: Any) -> None:
    """Add ``inertia assembly``."""
    parser = parsers.add_parser(
        "assembly",
        help="a tree of parts: mass properties of the whole, with their bound, and what each part contributes",
        description="Place the parts of an assembly, and add them up: mass, centre of mass and tensor of the whole "
        "with their certified bound.",
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part", nargs="?", metavar="FILE", help="assembly file (TOML), or bill of materials (CSV); - is standard input"
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

    assembly = Assembly.load(options.part)
    show(options.json, lambda: assembly_document(assembly), lambda: assembly_text(assembly))
    return 0
