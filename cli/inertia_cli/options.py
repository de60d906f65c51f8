"""The commands and their options; importing this loads nothing that is slow."""

from __future__ import annotations

import argparse
from typing import NoReturn

import inertia
from inertia_cli import commands
from inertia_cli.balance_options import add_balance_command
from inertia_cli.run_options import add_run_commands
from inertia_cli.shared_options import add_density, add_input, triple

_CODES = """exit codes:
  0  done
  1  a fault of this program, or the result could not be written
  2  the command line is not usable
  3  the file cannot be read
  4  the mesh or the data cannot give an honest answer; of `balance`: undecided
  5  judged, and out of tolerance
"""

_ANALYSE = """examples:
  inertia analyse part.stl --density 7850
  inertia analyse part.stl --unit in --mass 1.25 --about 0,0,-1.5 --json
  inertia analyse assembly.3mf --material housing=aluminium --material shaft=steel
  inertia analyse sheet.obj --shell 1.5 --material steel
"""

_TRADE = """examples:
  inertia trade part.stl
  inertia trade part.stl --accuracy 1e-3 --plot trade.svg
  inertia trade scene.toml --accuracy 1e-9
"""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Leave with one sentence and exit code 2."""
        self.exit(2, f"{self.prog}: {message}; see `{self.prog} --help`\n")


def build_parser() -> argparse.ArgumentParser:
    """Return the parser; the chosen command's function is its default `run`."""
    parser = _Parser(
        prog="inertia",
        description="Mesh in, exact inertia out.",
        epilog=_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"inertia {inertia.__version__}")
    parsers = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    _add_analyse(parsers)
    _add_check(parsers)
    _add_trade(parsers)
    add_run_commands(parsers)
    add_balance_command(parsers)
    return parser


def _add_analyse(parsers: argparse._SubParsersAction[_Parser]) -> None:
    parser = parsers.add_parser(
        "analyse",
        aliases=["analyze"],
        help="mass, centre of mass, inertia tensor, principal axes",
        description="Integrate a mesh to its mass, centre of mass and inertia tensor, with an error bound.",
        epilog=_ANALYSE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=commands.analyse)
    add_input(parser)
    add_density(parser)
    model = parser.add_argument_group("what carries the mass")
    model.add_argument("--shell", type=float, metavar="THICKNESS", help="the surface, which may be open, in --unit")
    model.add_argument(
        "--wire", type=float, metavar="AREA", help="the lines of the mesh, cross-section in --unit squared"
    )
    _add_orientation(parser)
    mend = parser.add_argument_group("mending, never unasked")
    mend.add_argument("--weld", type=float, metavar="DISTANCE", help="merge vertices within DISTANCE, in --unit")
    mend.add_argument("--repair", action="store_true", help="close, turn and unite; every change is listed")
    result = parser.add_argument_group("result")
    result.add_argument("--about", type=triple, metavar="X,Y,Z", help="give the tensor about this point too, in --unit")
    result.add_argument(
        "--accuracy", type=_accuracy, metavar="REL", help='relative bound that must be reached, as 1e-12, or "exact"'
    )
    result.add_argument(
        "--class-tolerance", type=float, metavar="REL", help="moments within this part of the largest are equal (1e-6)"
    )
    result.add_argument(
        "--chord",
        type=float,
        metavar="LENGTH",
        help="tolerance of the tessellation, in --unit: bounds what it left out",
    )
    result.add_argument(
        "--richardson",
        action="store_true",
        help="mesh a STEP file twice, and estimate what that left out",
    )
    result.add_argument("--json", action="store_true", help="print one JSON document (inertia/analysis/1)")


def _add_check(parsers: argparse._SubParsersAction[_Parser]) -> None:
    parser = parsers.add_parser(
        "check",
        help="closed, wound, overlapping? each finding says where",
        description="Check whether a mesh bounds an honest volume; exit code 4 if it does not.",
    )
    parser.set_defaults(run=commands.check)
    add_input(parser)
    _add_orientation(parser)
    parser.add_argument(
        "--intersections", action="store_true", help="look for triangles of one shell that cross each other (slow)"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document (inertia/check/1)")


def _add_trade(parsers: argparse._SubParsersAction[_Parser]) -> None:
    parser = parsers.add_parser(
        "trade",
        help="what accuracy costs on this part or scene: time against error",
        description="Measure, on this machine, time against error: of a part for every method and for simplified "
        "meshes, of a scene (.toml) for every method that can follow it.",
        epilog=_TRADE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=commands.trade)
    add_input(parser)
    parser.add_argument("--density", type=float, metavar="KG/M3", help="of the part; 1000 is assumed without it")
    parser.add_argument("--material", metavar="MATERIAL", help="take the density from the table of materials")
    parser.add_argument(
        "--accuracy",
        type=_accuracy,
        metavar="REL",
        help='recommend a row for this accuracy, as 1e-3, or "exact"; of a scene in rad',
    )
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="runs of each row (5); the median counts")
    parser.add_argument(
        "--budget", type=float, default=30.0, metavar="SECONDS", help="for all of it (30); what does not fit is skipped"
    )
    result = parser.add_argument_group("result")
    result.add_argument(
        "--json",
        action="store_true",
        help="print one JSON document (inertia/trade/1, of a scene inertia/trade-scene/1)",
    )
    result.add_argument("--plot", metavar="FILE", help="draw a diagram too, to FILE.svg or FILE.png")
    result.add_argument("--force", action="store_true", help="write over FILE where it exists")


def _add_orientation(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--orientation",
        choices=["stored", "absolute"],
        default="stored",
        help="absolute: take every shell as facing the way its nesting asks, however it is wound",
    )


def _accuracy(text: str) -> float | str:
    if text == "exact":
        return text
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number nor 'exact'") from None
