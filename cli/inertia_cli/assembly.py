"""The command `assembly`."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia_cli.options import by_name, named_number, record, require_recordable, tell_of_viewer
from inertia_cli.printing import print_document, print_text, show

if TYPE_CHECKING:
    from inertia.assembly.document import Assembly
    from inertia.assembly.tree import PartTree

_OWN = (".toml", ".csv")

_EXAMPLES = """examples:
  inertia assembly pump.toml
  inertia assembly pump.toml --interference --clearance 0.2
  inertia assembly robot.urdf --joint elbow=1.57
  inertia assembly model.step --to-toml model.toml
"""


def add(parsers: Any) -> None:
    """Add ``inertia assembly``."""
    parser = parsers.add_parser(
        "assembly",
        help="a tree of parts: mass properties of the whole, with their bound, and what each part contributes",
        description="Place the parts of an assembly, and add them up: mass, centre of mass and tensor of the whole "
        "with their certified bound; exit code 5 where parts interfere and that is asked for, 4 where something "
        "of a robot cannot be weighed.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part",
        nargs="?",
        metavar="FILE",
        help="assembly file (TOML), bill of materials (CSV), or a file that carries a tree (glTF, 3MF, STEP, Collada, "
        "URDF, MJCF, …); - is standard input",
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
        help="write an assembly file to fill in: a part for each node of a scene or product file, for each region of "
        "another mesh, or for each link of a robot; without OUT print it",
    )
    add_tree_options(parser)
    parser.add_argument("-o", "--output", metavar="FILE.rrd", help="record the tree, for `inertia play`")
    parser.add_argument(
        "--live", action="store_true", help="stream it to the Rerun viewer that is open on this machine"
    )
    parser.add_argument("--force", action="store_true", help="replace a file that is there")
    parser.add_argument("--schema", action="store_true", help="print the JSON Schema of an assembly file")
    parser.add_argument("--json", action="store_true", help="print one JSON document (inertia/assembly/1)")


def add_tree_options(parser: argparse.ArgumentParser) -> None:
    """Add how a file that carries a tree is to be read."""
    parser.add_argument(
        "--joint",
        action="append",
        default=[],
        type=named_number,
        metavar="NAME=VALUE",
        help="where a robot's joint stands, in rad or m (repeat it); others are at 0, or at the ref of MJCF",
    )
    parser.add_argument("--unit", metavar="UNIT", help="of the coordinates of a mesh, in place of its file's own")


def assembly_of(options: argparse.Namespace) -> Assembly:
    """Return the assembly that a file describes, or the tree that it carries."""
    from inertia.assembly.document import Assembly

    if not (options.joint or options.unit):
        return Assembly.load(options.part)
    _require_carried(options)
    return Assembly.carried_by(options.part, options.unit, by_name("joint", options.joint))


def tell_of_partial(assembly: PartTree) -> int:
    """Say what has a mass and is not in an answer; return the exit code of what is no honest total, or 0."""
    from inertia.errors import GeometryError, visible

    if not assembly.unweighed:
        return 0
    lacks = "; ".join(assembly.unweighed)
    print(f"inertia: {visible(f'{assembly.path}: the total is not that of the whole: {lacks}')}", file=sys.stderr)
    return GeometryError.exit_code


def run(options: argparse.Namespace) -> int:
    """Run ``inertia assembly``."""
    from inertia.assembly.document import json_schema
    from inertia.errors import UsageError

    if options.schema:
        print_document(json_schema())
        return 0
    if options.part is None:
        raise UsageError("no assembly is named: give an assembly file, see `inertia assembly --help`")
    if options.to_toml is not None and (options.output is not None or options.live):
        raise UsageError("--to-toml writes an assembly file and records nothing: leave --output and --live out")
    if options.to_toml is not None:
        if options.json:
            raise UsageError("--to-toml has no room for --json: leave one of them out")
        return _to_toml(options)
    from inertia.report.budget.document import assembly_document
    from inertia.report.budget.text import assembly_text

    if options.clearance is not None and not 0 <= options.clearance < math.inf:
        raise UsageError(f"the clearance is {options.clearance:g}: it must be a length that is not negative")
    require_recordable(options)
    assembly = assembly_of(options)
    asked = options.interference or options.clearance is not None
    clearance = (options.clearance or 0.0) * float(assembly.unit.metres)
    pairs = assembly.interferences(clearance) if asked else None
    if options.output is not None or options.live:
        record(assembly.budget(), options.output, options, live=options.live)
    show(options.json, lambda: assembly_document(assembly, pairs), lambda: assembly_text(assembly, pairs))
    tell_of_viewer(options)
    return 5 if pairs else tell_of_partial(assembly)


def _require_carried(options: argparse.Namespace) -> None:
    from inertia.errors import UsageError

    if Path(options.part).suffix.lower() in _OWN:
        raise UsageError("--to-toml, --joint and --unit are for files that carry a tree: an assembly file has its own")


def _to_toml(options: argparse.Namespace) -> int:
    from inertia.assembly.document import Assembly
    from inertia.assembly.outline import outline, rounded
    from inertia.documents import toml_text
    from inertia.errors import UsageError
    from inertia.output import require_writable, write_whole
    from inertia.standard_input import NAME, path_of

    out = options.to_toml
    if out != "-":
        require_writable(out, ".toml", force=options.force)
    _require_carried(options)
    folder = Path() if out == "-" else Path(out).parent
    table, notes, *_ = outline(path_of(options.part), folder, options.unit, by_name("joint", options.joint))
    if options.part == NAME and any(part.get("file") == NAME for part in table["part"]):
        raise UsageError("--to-toml names the file of the meshes, and standard input has no name: name a file")
    Assembly.from_dict(table, name=options.part)  # refuses what could not be read again
    text = toml_text(rounded(table))
    for note in notes:
        print(f"note: {note}", file=sys.stderr)
    if out == "-":
        print_text(text)
    else:
        write_whole(Path(out), text.encode())
    return 0
