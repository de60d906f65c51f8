"""Options that several commands take, and the values they hold."""

from __future__ import annotations

import argparse
import math


def add_input(parser: argparse.ArgumentParser) -> None:
    """Add the part and how to read it."""
    parser.add_argument(
        "part", metavar="PART", help="STL, OBJ, PLY, OFF, glTF, 3MF, STEP, VTK, Gmsh, Nastran, Abaqus, ..."
    )
    parser.add_argument("--unit", metavar="UNIT", help="length unit of the coordinates: mm (assumed), m, in, ...")
    parser.add_argument("--format", metavar="KIND", help="kind of file, where its contents should not decide")


def add_density(parser: argparse.ArgumentParser) -> None:
    """Add what says how heavy the part is."""
    density = parser.add_argument_group("density")
    density.add_argument(
        "--density",
        action="append",
        default=[],
        type=_named_number,
        metavar="[NAME=]KG/M3",
        help="of the part, or of the region or body NAME (repeat it); 1000 is assumed without it",
    )
    density.add_argument(
        "--material",
        action="append",
        default=[],
        type=_named,
        metavar="[NAME=]MATERIAL",
        help="take the density from the table of materials: steel, aluminium, abs, ...",
    )
    density.add_argument(
        "--mass", type=float, metavar="KG", help="the total as weighed; densities are proportions then"
    )


def _named(text: str) -> tuple[str, str]:
    name, _, value = text.rpartition("=")
    if not value:
        raise argparse.ArgumentTypeError(f"{text!r} has nothing after the equals sign")
    return name, value


def _named_number(text: str) -> tuple[str, float]:
    name, value = _named(text)
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{value!r} is no number of kg/m³") from None


def triple(text: str) -> tuple[float, ...]:
    """Return three finite numbers from ``X,Y,Z``."""
    try:
        point = tuple(float(part) for part in text.split(","))
    except ValueError:
        point = ()
    if len(point) != 3 or not all(map(math.isfinite, point)):
        raise argparse.ArgumentTypeError(f"{text!r} is no point: give three numbers as X,Y,Z")
    return point
