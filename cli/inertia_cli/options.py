"""Options that several commands take, the values they hold, and the part that they name."""

from __future__ import annotations

import argparse
import contextlib
import math
import re
import sys
import threading
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

from inertia.errors import InertiaError, ReadError, UsageError
from inertia.estimate import Estimate, relative_figure
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.standard_input import file_of

if TYPE_CHECKING:
    from pathlib import Path

    from inertia.mesh.part import Part

T = TypeVar("T")


def add_input(parser: argparse.ArgumentParser) -> None:
    """Add the part and how to read it."""
    parser.add_argument(
        "part",
        metavar="PART",
        help="STL, OBJ, PLY, OFF, glTF, 3MF, Collada, STEP, VTK, Gmsh, Nastran, Abaqus, ...; - for standard input",
    )
    add_reading(parser)


def add_reading(parser: Any) -> None:
    """Add how a mesh is read."""
    parser.add_argument("--unit", metavar="UNIT", help="length unit of the coordinates: mm (assumed), m, in, ...")
    parser.add_argument("--unpack-limit", type=float, metavar="GIB", help="that a compressed file may unpack to (2)")
    parser.add_argument("--format", metavar="KIND", help="kind of file, where its contents should not decide")


def add_density(parser: argparse.ArgumentParser) -> None:
    """Add what says how heavy the part is, with its uncertainty."""
    density = parser.add_argument_group("density")
    density.add_argument(
        "--density",
        action="append",
        default=[],
        type=_named_estimate,
        metavar="[NAME=]KG/M3",
        help="of the part, or of the region or body NAME (repeat it), as 7850 or 7850±50; 1000 is assumed without it",
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
        "--mass", type=estimate, metavar="KG", help="the total as weighed, as 1.2±0.001; densities are proportions then"
    )


def add_orientation(parser: Any) -> None:
    """Add which way the shells are taken to face."""
    parser.add_argument(
        "--orientation",
        choices=["stored", "absolute"],
        default="stored",
        help="absolute: take every shell as facing the way its nesting asks, however it is wound",
    )


def add_parts(parser: Any) -> None:
    """Add whether bodies are taken one by one."""
    parser.add_argument(
        "--parts",
        choices=["together", "separate"],
        default="together",
        help="separate: integrate each body by itself; what bodies share is in the bounds then, and no fault",
    )


def add_faults(parser: Any) -> None:
    """Add how much small faults of the mesh may leave open."""
    parser.add_argument(
        "--allow-faults",
        type=_share,
        metavar="REL",
        help="answer for a mesh with small faults, with bounds that cover them, of at most REL, as 0.01 or 1%%",
    )


def _share(text: str) -> float:
    """Return a relative figure, which may be written in percent."""
    try:
        return relative_figure(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no number, as 0.01 or 1%") from None


def add_intersections(parser: Any) -> None:
    """Add whether triangles that cross one another are looked for."""
    parser.add_argument(
        "--intersections",
        action=argparse.BooleanOptionalAction,
        help="look for triangles of one shell that cross each other, and for volume cells that share space, or do not "
        "(up to 200,000 triangles, outer ones of a volume mesh, it is done)",
    )


def _named(text: str) -> tuple[str, str]:
    name, equals, value = text.rpartition("=")
    if not value:
        raise argparse.ArgumentTypeError(f"{text!r} has nothing after the equals sign" if equals else "it is empty")
    if equals and not name.strip():
        raise argparse.ArgumentTypeError(
            f"{text!r} has no name before the equals sign: name a region or body, or give {value} alone for the rest"
        )
    return name, value


def named_number(text: str) -> tuple[str, float]:
    """Return NAME and a number from ``NAME=NUMBER``, "" without a name."""
    name, value = _named(text)
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{value!r} is no number") from None


def _named_estimate(text: str) -> tuple[str, Estimate]:
    """Return the same with its uncertainty, from ``NAME=KG/M3±U``."""
    name, value = _named(text)
    try:
        return name, Estimate.parse(value)
    except UsageError:
        raise argparse.ArgumentTypeError(f"{value!r} is no number of kg/m³, as 7850 or 7850±50") from None


def estimate(text: str) -> Estimate:
    """Return a number, with its standard uncertainty where that is written behind it."""
    try:
        return Estimate.parse(text)
    except UsageError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def count(text: str) -> int:
    """Return a whole number, also from ``1e6``.

    >>> count("250"), count("1e6")
    (250, 1000000)
    """
    try:
        return int(text)
    except ValueError:
        pass
    try:
        value = float(text)
        if value == int(value):
            return int(value)
    except (ValueError, OverflowError):
        pass
    raise argparse.ArgumentTypeError(f"{text!r} is no whole number, as 1000 or 1e6")


def scale(text: str) -> Estimate:
    """Return the scale 1 with its uncertainty, from ``1±0.001`` or ``±0.1%``."""
    return estimate(text if text.strip()[:1].isdigit() else f"1{text}")


def size(text: str) -> int:
    """Return a number of bytes from ``2GB``, ``512 MiB`` or ``4e9``.

    >>> size("2GB"), size("512MiB"), size("4e9")
    (2000000000, 536870912, 4000000000)
    """
    units = {"": 1, "b": 1} | {
        f"{letter}{end}": base**power
        for power, letter in enumerate("kmgt", 1)
        for base, end in ((1000, "b"), (1000, ""), (1024, "ib"))
    }
    written = re.fullmatch(r"(-?[0-9.]+(?:e\+?[0-9]+)?) *([a-z]*)", text.strip().lower())
    try:
        count = int(float(written[1]) * units[written[2]]) if written else int("")
    except (ValueError, KeyError, OverflowError):
        raise argparse.ArgumentTypeError(f"{text!r} is no number of bytes, as 2GB, 512MiB or 4e9") from None
    if not count:
        raise argparse.ArgumentTypeError(f"{text!r} is less than one byte")
    return count


def decimal_triple(text: str) -> tuple[Fraction, ...]:
    """Return three finite numbers from ``X,Y,Z``, just as they are written."""
    # What is too small for a float counts as zero: 1e-999999999 would fill the memory as a fraction.
    return tuple(Fraction(part) if k else Fraction(0) for k, part in zip(triple(text), text.split(","), strict=True))


def triple(text: str) -> tuple[float, ...]:
    """Return three finite numbers from ``X,Y,Z``."""
    try:
        point = tuple(float(part) for part in text.split(","))
    except ValueError:
        point = ()
    if len(point) != 3 or not all(map(math.isfinite, point)):
        raise argparse.ArgumentTypeError(f"{text!r} is no point: give three numbers as X,Y,Z")
    return point


def accuracy(text: str) -> float | str:
    """Return a relative accuracy, or "exact"."""
    if text == "exact":
        return text
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number nor 'exact'") from None


def by_name(option: str, values: list[tuple[str, T]]) -> dict[str, T] | None:
    """Return what an option that may be repeated said of each name; None where it was not given."""
    values_of: dict[str, T] = {}
    for name, value in values:
        if name in values_of:
            raise UsageError(f"--{option} is given twice for {repr(name) if name else 'the part'}: give it once")
        values_of[name] = value
    return values_of or None


def read_part(options: argparse.Namespace, coarser: float = 1.0) -> tuple[Part, threading.Thread]:
    """Read the part, and begin to hash its file beside the work that follows."""
    from inertia.mesh.read import read

    limit = {} if options.unpack_limit is None else {"unpack_limit": options.unpack_limit}
    memory = 0.0 if getattr(options, "dask", None) else getattr(options, "memory", None)  # workers read the file too
    part = read(options.part, options.unit, format=options.format, coarser=coarser, memory=memory, **limit)

    def digest() -> None:
        with contextlib.suppress(InertiaError):  # it is raised again where the digest is needed
            part.source.sha256, part.source.files  # noqa: B018  # the properties keep them

    hashing = threading.Thread(target=digest, daemon=True)
    hashing.start()
    return part, hashing


def names_document(options: argparse.Namespace) -> bool:
    """Say whether what is named is a TOML file, and no mesh; of standard input, the contents decide."""
    name: str = options.part
    if name != STANDARD_INPUT:
        return name.lower().endswith(".toml")
    if getattr(options, "format", None) is not None:
        return False
    from inertia.mesh.readers.formats import HEAD, sniff

    try:
        path = file_of(name)
        with path.open("rb") as file:
            head = file.read(HEAD)
        if head:
            sniff(path, head, path.stat().st_size)
        return False
    except ReadError:
        return True


def names_recording(name: str) -> bool:
    """Say whether what is named is a recording, by how the name ends; of standard input, the contents decide."""
    return str(file_of(name) if name == STANDARD_INPUT else name).lower().endswith(".rrd")


def require_recordable(options: argparse.Namespace) -> None:
    """Ask what a recording needs before the work, which may take a while."""
    if options.output is None and not options.live:
        return
    from inertia.output import require_writable
    from inertia.recording.live import require_viewer

    if options.output is not None:
        require_writable(options.output, ".rrd", force=options.force)
    if options.live:
        require_viewer()


def record(result: Any, file: str | Path | None, options: argparse.Namespace, *, live: bool, other: Any = None) -> None:
    """Record a run or a balance to a file, on the viewer, or both; a viewer that ends takes nothing along."""
    from inertia.recording.live import ViewerError
    from inertia.recording.record import record

    try:
        record(result, file, other=other, force=options.force, live=live)
    except ViewerError as error:
        options.lost = error


def tell_of_viewer(options: argparse.Namespace) -> None:
    """Say so at the end where the viewer did not get all."""
    if (error := getattr(options, "lost", None)) is not None:
        print(f"inertia: {error}", file=sys.stderr)
