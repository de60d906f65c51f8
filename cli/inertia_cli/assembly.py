"""The command `assembly`."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import Any

from inertia_cli.options import by_name, named_number
from inertia_cli.printing import print_document, print_text, show


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
    parser.add_argument(
        "--to-toml",
        metavar="OUT.toml",
        nargs="?",
        const="-",
        help="write an assembly file to fill in: a part for each region of a mesh or STEP file, or for each link of a "
        "robot (URDF, MJCF); without OUT print it",
    )
    parser.add_argument(
        "--joint",
        action="append",
        default=[],
        type=named_number,
        metavar="NAME=VALUE",
        help="with --to-toml, where a robot's joint stands, in rad or m (repeat it); others are at 0",
    )
    parser.add_argument("--unit", metavar="UNIT", help="with --to-toml, of a mesh whose file states none")
    parser.add_argument("--force", action="store_true", help="replace a file that is there")
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
    if options.to_toml is not None:
        return _to_toml(options)
    if options.joint or options.unit:
        raise UsageError("--joint and --unit go with --to-toml: an assembly file has its own")
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


def _to_toml(options: argparse.Namespace) -> int:
    from inertia.assembly.document import Assembly
    from inertia.assembly.outline import outline
    from inertia.documents import toml_text
    from inertia.errors import UsageError
    from inertia.exchange.robots.read import read_robot
    from inertia.exchange.robots.tree import robot_tree
    from inertia.mesh.read import read
    from inertia.output import require_writable, write_whole

    path, out = Path(options.part), options.to_toml
    if out != "-":
        require_writable(out, ".toml", force=options.force)
    notes: tuple[str, ...] = ()
    if path.suffix.lower() in (".urdf", ".xml", ".mjcf", ".xacro"):
        table, notes = robot_tree(read_robot(options.part), by_name("joint", options.joint) or {})
    elif options.joint:
        raise UsageError(f"{options.part} is no robot, and has no joints: leave --joint out")
    else:
        table = outline(read(options.part, options.unit), path, Path() if out == "-" else Path(out).parent)
    Assembly.from_dict(table, name=options.part)  # refuses what could not be read again
    text = toml_text(table)
    for note in notes:
        print(f"note: {note}", file=sys.stderr)
    if out == "-":
        print_text(text)
    else:
        write_whole(Path(out), text.encode())
    return 0
