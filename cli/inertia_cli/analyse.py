"""The command `analyse`."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import REPAIR, GeometryError, UsageError
from inertia.output import require_writable, write_whole
from inertia_cli.options import (
    accuracy,
    add_density,
    add_faults,
    add_input,
    add_intersections,
    add_orientation,
    add_parts,
    by_name,
    decimal_triple,
    estimate,
    read_part,
    scale,
    size,
)
from inertia_cli.printing import print_file, show
from inertia_cli.progress import Progress
from inertia_cli.wording import as_option, tried

if TYPE_CHECKING:
    from inertia.mass.analysis import Analysis
    from inertia.mass.repair import Repaired
    from inertia.mesh.part import Part

_COARSER = 2.0

_EXAMPLES = """examples:
  inertia analyse part.stl --density 7850
  inertia analyse part.stl --unit in --mass 1.25 --about 0,0,-1.5 --json
  inertia analyse assembly.3mf --material housing=aluminium --material shaft=steel
  inertia analyse sheet.obj --shell 1.5 --material steel
  inertia analyse link.stl --mass 0.85 --as urdf -o link.urdf
  inertia analyse scan.stl --sigma 0.02 --density 7850±50 --scale 1±0.001
"""


def number(example: str) -> Callable[[str], float]:
    """Return how an option reads a number without an uncertainty; what is none is refused with an example."""

    def read(text: str) -> float:
        try:
            return float(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is no number, as {example}") from None

    return read


def add(parsers: Any) -> None:
    """Add ``inertia analyse``."""
    parser = parsers.add_parser(
        "analyse",
        aliases=["analyze"],
        help="mass, centre of mass, inertia tensor, principal axes",
        description="Integrate a mesh to its mass, centre of mass and inertia tensor, with an error bound.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    add_input(parser)
    add_density(parser)
    model = parser.add_argument_group("what carries the mass")
    model.add_argument("--shell", type=estimate, metavar="THICKNESS", help="the surface, which may be open, in --unit")
    model.add_argument(
        "--wire", type=estimate, metavar="AREA", help="the lines of the mesh, cross-section in --unit squared"
    )
    add_orientation(parser)
    add_intersections(parser)
    add_parts(parser)
    mend = parser.add_argument_group("mending, never unasked")
    mend.add_argument(
        "--weld", type=number("0.001"), metavar="DISTANCE", help="merge vertices within DISTANCE, in --unit"
    )
    mend.add_argument("--repair", action="store_true", help="close, turn and unite; every change is listed")
    mend.add_argument(
        "--union", action="store_true", help="count once what bodies, or a shell that crosses itself, enclose twice"
    )
    add_faults(mend)
    uncertain = parser.add_argument_group("uncertain input, beside ± in densities, masses, thicknesses (GUM)")
    uncertain.add_argument(
        "--sigma",
        type=number("0.02"),
        metavar="LENGTH",
        help="standard deviation of every vertex coordinate, in --unit",
    )
    uncertain.add_argument(
        "--scale", type=scale, metavar="1±U", help="standard uncertainty of a factor common to all coordinates"
    )
    uncertain.add_argument(
        "--coverage",
        type=number("2, for about 95 %"),
        metavar="K",
        help="state the expanded uncertainties U = k u too, as 2",
    )
    large = parser.add_argument_group("larger than memory, or on many machines")
    large.add_argument(
        "--memory",
        type=size,
        metavar="BYTES",
        help="that may be taken, as 2GB: beyond it binary STL and PLY go piece by piece, on disk (TMPDIR)",
    )
    large.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="have the workers of that Dask scheduler do it, as tcp://host:8786; local for one in this process",
    )
    result = parser.add_argument_group("result")
    result.add_argument(
        "--about", type=decimal_triple, metavar="X,Y,Z", help="give the tensor about this point too, in --unit"
    )
    result.add_argument(
        "--accuracy", type=accuracy, metavar="REL", help='relative bound that must be reached, as 1e-12, or "exact"'
    )
    result.add_argument(
        "--class-tolerance",
        type=number("1e-6"),
        metavar="REL",
        help="moments within this part of the largest are equal (1e-6)",
    )
    result.add_argument(
        "--chord",
        type=number("0.1"),
        metavar="LENGTH",
        help="tolerance of the tessellation, in --unit: bounds what it left out",
    )
    result.add_argument(
        "--richardson",
        action="store_true",
        help="mesh a STEP file twice, and estimate what that left out",
    )
    result.add_argument(
        "--tessellated", action="store_true", help="integrate triangles in place of the true shape (STEP)"
    )
    result.add_argument(
        "--as",
        dest="target",
        metavar="FORMAT",
        help="print for another program: urdf, sdf, mjcf, usd, modelica, simscape, nastran, adams, abaqus, drake, csv",
    )
    result.add_argument("--name", metavar="NAME", help="of the body in what --as prints: the file's, if not given")
    result.add_argument("-o", "--output", metavar="FILE", help="write what --as prints to FILE, - prints it")
    result.add_argument("--force", action="store_true", help="write over FILE where it exists")
    result.add_argument("--json", action="store_true", help="print one JSON document (inertia/analysis/1)")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia analyse``."""
    from dataclasses import replace

    from inertia.report.analysis.document import analysis_document
    from inertia.report.analysis.text import analysis_text

    if options.richardson and options.chord is not None:
        raise UsageError("--chord and --richardson are two answers to one question: give one")
    output = _output(options)
    part, hashing = read_part(options)
    repaired = _repair(part, options)
    try:
        analysis = _analysis(part if repaired is None else repaired.part, options)
    except GeometryError as error:
        raise tried(error, REPAIR) if options.repair and REPAIR in error.remedies else error from None
    if options.richardson:
        from inertia.mass.tessellation import richardson

        coarse, _ = read_part(options, coarser=_COARSER)
        mended = _repair(coarse, options)
        coarser = _analysis(coarse if mended is None else mended.part, options)
        estimate = richardson(coarser.properties, analysis.properties, _COARSER)
        analysis = replace(analysis, tessellation=estimate)
    hashing.join()
    if options.target is not None:
        text = _exported(analysis, repaired, options)
        if output is None:
            print_file(text)
        else:
            write_whole(output, text.encode())
        return 0
    show(
        options.json,
        lambda: analysis_document(analysis, repaired, wording=as_option),
        lambda: analysis_text(analysis, repaired, wording=as_option),
    )
    return 0


def _output(options: argparse.Namespace) -> Path | None:
    """Return the file that is written for another program, if any; refuse before the work what cannot be had."""
    if options.target is None:
        for option in ("output", "name"):
            if getattr(options, option) is not None:
                raise UsageError(f"--{option} goes with what is written for another program: name that with --as")
        return None
    for option in ("json", "about"):
        if getattr(options, option):
            raise UsageError(f"--as has no room for --{option}: leave one of them out")
    from inertia.exchange.export import require_writer

    require_writer(options.target)
    # As of any file, `-` is the stream, and `./-` a file of that name.
    return None if options.output in (None, "-") else require_writable(options.output, force=options.force)


def _exported(analysis: Analysis, repaired: Repaired | None, options: argparse.Namespace) -> str:
    from inertia.exchange.export import export
    from inertia.report.analysis.text import omission_lines, source_lines, uncertainty_lines

    named = source_lines(analysis, repaired, wording=lambda word: str(word).partition("=")[0])
    comments = (*named, *omission_lines(analysis, wording=as_option), *uncertainty_lines(analysis))
    name = options.name
    if name is None:
        name = "part" if options.part == "-" else Path(options.part).stem  # standard input has no name
    return export(analysis.properties, options.target, name=name, comments=comments)


def _repair(part: Part, options: argparse.Namespace) -> Repaired | None:
    if not options.repair and options.weld is None:
        return None
    if options.dask is not None or options.memory is not None:
        from inertia.mass.external import answered_at_once, require_external

        memory = math.inf if options.memory is None else options.memory
        if options.dask is not None or not answered_at_once(part, memory):
            require_external(part, memory, ["a repair"])
        options.memory = None  # what is enough for the repair is enough for the rest
    from inertia.mass.repair import repair, weld

    if not options.repair:
        return weld(part, options.weld)
    return repair(part, options.weld, alike=not any(name for name, _ in (*options.density, *options.material)))


def _analysis(part: Part, options: argparse.Namespace) -> Analysis:
    from inertia.mass.analyse import analyse as analyse_part

    tolerance = {} if options.class_tolerance is None else {"class_tolerance": options.class_tolerance}
    with Progress("uniting" if options.union else "integrating") as progress:
        return analyse_part(
            part,
            by_name("density", options.density),
            material=by_name("material", options.material),
            mass=options.mass,
            accuracy=options.accuracy,
            shell=options.shell,
            wire=options.wire,
            orientation=options.orientation,
            intersections=options.intersections,
            union=options.union,
            parts=options.parts,
            allow_faults=options.allow_faults,
            about=options.about,
            chord=options.chord,
            tessellated=options.tessellated or options.richardson,
            sigma=options.sigma,
            scale=options.scale,
            coverage=options.coverage,
            memory=options.memory,
            dask=options.dask,
            progress=progress,
            **tolerance,
        )
