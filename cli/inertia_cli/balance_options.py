"""The options of `balance`."""

from __future__ import annotations

import argparse
from typing import Any

from inertia_cli import balance_commands
from inertia_cli.shared_options import triple

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

_EXAMPLES = """examples:
  inertia balance rotor.toml --report report.html --cut-part corrected.stl
  inertia balance part.stl --axis z --bearings 20,280 --planes 90,215 --rpm 3000 --grade 6.3
  inertia balance part.stl --axis z --bearings 20,280 --planes 90,215 --rpm 3000 --grade 6.3 --drill 8,10,12
  inertia balance part.stl --rpm 3000 --grade 6.3              # lists what the axis might be
  inertia balance --schema > rotor.schema.json

exit codes: 0 passed, 5 failed, 4 undecided or no honest answer; others as `inertia --help` has them
"""


def add_balance_command(parsers: Any) -> None:
    """Add ``inertia balance``."""
    parser = parsers.add_parser(
        "balance",
        help="unbalance, tolerance and verdict of a rotor; corrections cut into its mesh",
        description="Balance a rotor: from its meshes to its unbalance, the holes that correct it, and a verdict.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=balance_commands.balance)
    parser.add_argument("part", nargs="?", metavar="ROTOR | PART", help="a rotor file (.toml), or a mesh or STEP file")
    _add_short_form(parser)
    result = parser.add_argument_group("result")
    result.add_argument("--json", action="store_true", help="print one JSON document (inertia/balance/1)")
    result.add_argument("--csv", metavar="FILE", help="write the planes and the work as CSV")
    result.add_argument("--report", metavar="FILE", help="write the report: one HTML file, which prints on A4")
    result.add_argument("-o", "--output", metavar="FILE", help="record to FILE.rrd, for `inertia play`")
    result.add_argument("--live", action="store_true", help="stream to the Rerun viewer that is open on this machine")
    result.add_argument("--cut-part", metavar="FILE", help="write the corrected mesh, as STL in the rotor's unit")
    result.add_argument("--force", action="store_true", help="write over files that exist")
    result.add_argument("--to-toml", action="store_true", help="print the rotor file that says the same, and stop")
    result.add_argument("--schema", action="store_true", help="print the JSON Schema of a rotor file, and stop")


def _add_short_form(parser: argparse.ArgumentParser) -> None:
    """Add what stands for a rotor file where a part is named; lengths are in --unit, angles in degrees."""
    short = parser.add_argument_group("of a part, in place of a rotor file (lengths in --unit)")
    short.add_argument("--unit", metavar="UNIT", help="length unit of the coordinates and options: mm (assumed), ...")
    weight = short.add_mutually_exclusive_group()
    weight.add_argument("--density", type=float, metavar="KG/M3", help="of the part; 1000 is assumed without it")
    weight.add_argument("--material", metavar="MATERIAL", help="take the density from the table of materials")
    weight.add_argument("--mass", type=float, metavar="KG", help="as weighed")
    short.add_argument("--chord", type=float, metavar="LENGTH", help="tolerance of the tessellation; estimated without")
    short.add_argument("--axis", type=_direction, metavar="x|y|z|X,Y,Z", help="direction of the shaft, from A to B")
    short.add_argument("--through", type=triple, metavar="X,Y,Z", help="a point on the shaft (0,0,0)")
    short.add_argument("--bearings", type=_numbers, metavar="A,B", help="places of the bearings along the axis")
    short.add_argument("--axis-uncertainty", type=float, metavar="RADIUS", help="of the bearing centres")
    short.add_argument("--zero-mark", type=triple, metavar="X,Y,Z", help="vector to the 0° mark; +x, else +y")
    short.add_argument("--rotation", choices=("ccw", "cw"), help="seen from B looking toward A (ccw)")
    short.add_argument("--rpm", type=float, metavar="N", help="highest speed in service, r/min")
    short.add_argument("--critical-rpm", type=float, metavar="N", help="first critical speed, r/min")
    limit = short.add_mutually_exclusive_group()
    limit.add_argument("--grade", type=float, metavar="G", help="balance quality grade of ISO 21940-11, mm/s")
    limit.add_argument("--e-um", type=float, metavar="UM", help="permissible specific unbalance, µm")
    short.add_argument(
        "--planes", type=_numbers, metavar="Z,...", help="places of the correction planes along the axis"
    )
    short.add_argument(
        "--drill", type=_numbers, metavar="D,...", help="drill there towards the shaft, by these diameters"
    )
    short.add_argument("--max-depth", type=float, metavar="LENGTH", help="of the holes")


def _numbers(text: str) -> list[float]:
    try:
        return [float(one) for one in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no list of numbers: give them as A,B") from None


def _direction(text: str) -> tuple[float, ...]:
    return _AXES[text] if text in _AXES else triple(text)
