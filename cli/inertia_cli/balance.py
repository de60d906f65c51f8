"""The command `balance`."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import GeometryError, ReadError, Remedy, UsageError
from inertia_cli.options import (
    estimate,
    names_document,
    names_recording,
    record,
    require_recordable,
    tell_of_viewer,
    triple,
)
from inertia_cli.printing import print_document, print_file, print_text, show, write_and_show
from inertia_cli.progress import Progress
from inertia_cli.wording import with_options

if TYPE_CHECKING:
    from inertia.balancing.balance import Balance
    from inertia.balancing.rotor import Rotor
    from inertia.balancing.verdict import Verdict
    from inertia.report.balance.data import ReportData

_ROMAN = ("I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X")
FIELDS = {  # fields of a rotor file, by their path without numbers, and what stands for them on the command line
    "axis.bearing_a and bearing_b": "--bearings",
    "axis.bearing_a": "--bearings",
    "axis.journals": "--axis",
    "axis.radial_uncertainty": "--axis-uncertainty",
    "axis.zero_mark": "--zero-mark",
    "service.rpm": "--rpm",
    "service.critical_rpm": "--critical-rpm",
    "tolerance.grade": "--grade",
    "tolerance.e_um": "--e-um",
    "body[0].chord_tolerance": "--chord",
    "body[0].density": "--density",
    "body[0].material": "--material",
    "body[0].mass": "--mass",
    "body[0].sigma": "--sigma",
    "body[0].unit": "--unit",
    "body[0]": "",
    "plane[0].z": "--planes",
    "plane[0].diameters": "--drill",
    "plane[0].max_depth": "--max-depth",
    "plan.time": "--time",
}
_SHORT = (
    "unit", "density", "material", "mass", "sigma", "chord", "axis", "through", "bearings", "axis_uncertainty",
    "zero_mark", "rotation", "rpm", "critical_rpm", "grade", "e_um", "planes", "drill", "max_depth",
)  # fmt: skip
_FILES = ("csv", "report", "output", "cut_part")
_PERMISSIBLE = "nothing says what is permissible: give ", Remedy("balance", "grade"), ", or ", Remedy("balance", "e_um")
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

_EXAMPLES = """examples:
  inertia balance rotor.toml --report report.html --cut-part corrected.stl
  inertia balance part.stl --axis z --bearings 20,280 --planes 90,215 --rpm 3000 --grade 6.3
  inertia balance part.stl --axis z --bearings 20,280 --planes 90,215 --rpm 3000 --grade 6.3 --drill 8,10,12
  inertia balance part.stl                                     # says what else it takes, and proposes the axis
  inertia balance part.stl --rpm 3000 --grade 6.3              # lists what the axis might be
  inertia balance --schema > rotor.schema.json

exit codes: 0 passed, 5 failed or fewer than half of the parts within tolerance, 4 conditional, undecided or no honest
answer; others as `inertia --help` has them
"""


def add(parsers: Any) -> None:
    """Add ``inertia balance``."""
    parser = parsers.add_parser(
        "balance",
        help="unbalance, tolerance and verdict of a rotor; corrections cut into its mesh",
        description="Balance a rotor: from its meshes to its unbalance, the holes that correct it, and a verdict.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "part",
        nargs="?",
        metavar="ROTOR | PART",
        help="a rotor file (.toml), a mesh or STEP file, or a recording of a rotor (.rrd); - for standard input",
    )
    _add_short_form(parser)
    result = parser.add_argument_group("result")
    result.add_argument("--json", action="store_true", help="print one JSON document (inertia/balance/1)")
    result.add_argument(
        "--time", type=float, metavar="SECONDS", help="how long a plan of corrections is looked for (10)"
    )
    result.add_argument("--csv", metavar="FILE", help="write the planes and the work as CSV")
    result.add_argument("--report", metavar="FILE", help="write the report: one HTML file, which prints on A4")
    result.add_argument("-o", "--output", metavar="FILE", help="record to FILE.rrd, for `inertia play`")
    result.add_argument("--live", action="store_true", help="stream to the Rerun viewer that is open on this machine")
    result.add_argument("--cut-part", metavar="FILE", help="write the corrected mesh, as STL in the rotor's unit")
    result.add_argument("--force", action="store_true", help="write over files that exist")
    result.add_argument("--to-toml", action="store_true", help="print the rotor file that says the same, and stop")
    result.add_argument("--grades", action="store_true", help="print grades, their machines and standards, and stop")
    result.add_argument("--schema", action="store_true", help="print the JSON Schema of a rotor file, and stop")


def _add_short_form(parser: argparse.ArgumentParser) -> None:
    """Add what stands for a rotor file where a part is named; lengths are in --unit, angles in degrees."""
    short = parser.add_argument_group("of a part, in place of a rotor file (lengths in --unit)")
    short.add_argument("--unit", metavar="UNIT", help="length unit of the coordinates and options: mm (assumed), ...")
    weight = short.add_mutually_exclusive_group()
    weight.add_argument(
        "--density", type=estimate, metavar="KG/M3", help="of the part, as 7850±50; 1000 is assumed without it"
    )
    weight.add_argument("--material", metavar="MATERIAL", help="take the density from the table of materials")
    weight.add_argument("--mass", type=estimate, metavar="KG", help="as weighed, as 1.2±0.001")
    short.add_argument("--sigma", type=float, metavar="LENGTH", help="standard deviation of every vertex coordinate")
    short.add_argument("--chord", type=float, metavar="LENGTH", help="tolerance of the mesh, where more than it shows")
    short.add_argument("--axis", type=_direction, metavar="x|y|z|X,Y,Z", help="direction along the shaft")
    short.add_argument("--through", type=triple, metavar="X,Y,Z", help="a point on the shaft (0,0,0)")
    short.add_argument("--bearings", type=_numbers, metavar="A,B", help="places of the bearings along the axis")
    short.add_argument("--axis-uncertainty", type=float, metavar="RADIUS", help="of the bearing centres")
    short.add_argument("--zero-mark", type=triple, metavar="X,Y,Z", help="vector to the 0° mark; +x, else +y")
    short.add_argument("--rotation", choices=("ccw", "cw"), help="seen from B looking toward A (ccw)")
    short.add_argument("--rpm", type=float, metavar="N", help="highest speed in service, r/min")
    short.add_argument("--critical-rpm", type=float, metavar="N", help="first critical speed, r/min")
    limit = short.add_mutually_exclusive_group()
    limit.add_argument("--grade", type=_grade, metavar="G", help="balance quality grade of ISO 21940-11, 6.3 or G6.3")
    limit.add_argument("--e-um", type=float, metavar="UM", help="permissible specific unbalance, µm")
    short.add_argument(
        "--planes", type=_numbers, metavar="Z,...", help="places of the correction planes along the axis"
    )
    short.add_argument(
        "--drill", type=_numbers, metavar="D,...", help="drill there towards the shaft, by these diameters"
    )
    short.add_argument("--max-depth", type=float, metavar="LENGTH", help="of the holes")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia balance``."""
    require_no_results(options, (*_FILES, "live", "to_toml"))
    if options.schema:
        from inertia.balancing.rotor import json_schema

        print_document(json_schema())
        return 0
    if options.grades:
        return show_grades(options.rpm, as_json=options.json)
    if options.part is None:
        raise UsageError("no rotor is named: give a rotor file or a part, see `inertia balance --help`")
    if names_recording(options.part) or names_document(options):
        return _balance(_rotor(options), options)
    if _part_alone(options):
        return _propose(options)
    try:
        return _balance(_rotor_of_part(options), options)
    except (UsageError, GeometryError, ReadError) as error:
        raise with_options(error, FIELDS, part=options.part) from None


def require_no_results(options: argparse.Namespace, results: Iterable[str]) -> None:
    """Refuse to write results where grades or a schema are printed, and nothing else is done."""
    stops = next((name for name in ("schema", "grades") if getattr(options, name)), None)
    for name in results if stops else ():
        if getattr(options, name) not in (None, False):
            raise UsageError(f"nothing is balanced with --{stops}: leave --{name.replace('_', '-')} out")


def show_grades(rpm: float | None = None, *, as_json: bool) -> int:
    """Print the grades, with the specific unbalance that they permit at a speed, where one is given."""
    from inertia.balancing.standards import grades_document
    from inertia.report.balance.text import grades_text

    if rpm is not None and not 0 < rpm < math.inf:
        raise UsageError(f"--rpm is {rpm:g}: it must be positive and finite")
    document = grades_document(rpm)
    show(as_json, lambda: document, lambda: grades_text(document))
    return 0


def _part_alone(options: argparse.Namespace) -> bool:
    """Whether nothing is said of the machine that a part belongs to, and nothing is to be written of it."""
    machine = "rpm", "grade", "e_um", "axis", "bearings", "through"
    unsaid = all(getattr(options, name) is None for name in (*machine, *_FILES))
    return unsaid and not (options.live or options.to_toml)


def _propose(options: argparse.Namespace) -> int:
    """Say how to go on with a part alone, of which nothing is judged; as a document, only that."""
    _require_usable(options)
    if options.json:
        from inertia.mesh.read import read

        read(options.part, options.unit)
        raise GeometryError(*_PERMISSIBLE, "; without --json a whole command line is proposed")
    from inertia_cli import proposal

    print_text(proposal.proposal(options))
    return proposal.EXIT


def _require_usable(options: argparse.Namespace) -> None:
    """Refuse what was given where no rotor could have it, whatever else will be said of that."""
    said = vars(options) | {"rpm": 1.0, "grade": 1.0}
    if options.max_depth is not None and options.drill is None:
        said["drill"] = [1.0]
    if said["drill"] is not None and options.planes is None:
        said["planes"] = [0.5]
    try:
        rotor = _rotor_of_part(argparse.Namespace(**said))
        if options.time is not None:
            rotor.planned_in(options.time)
    except UsageError as error:
        raise with_options(error, FIELDS, part=options.part) from None


def _missing(options: argparse.Namespace) -> list[str]:
    """Return what is missing for planes in which nothing is done."""
    if options.planes is None or options.drill is not None:
        return []
    return [
        "nothing is done in the planes: --drill D,... drills there, a rotor file (--to-toml) takes other methods too"
    ]


def _balance(rotor: Rotor, options: argparse.Namespace) -> int:
    from inertia.balancing.balance import balance as balance_rotor
    from inertia.balancing.corrections.correction_plane import CUTTING
    from inertia.output import note_input, require_writable
    from inertia.report.balance.document import balance_document
    from inertia.report.balance.figures import report_data
    from inertia.report.balance.text import balance_text
    from inertia.report.numerals import row

    if options.time is not None:
        rotor = rotor.planned_in(options.time)
    if options.to_toml:
        if options.json:
            raise UsageError("--to-toml has no room for --json: leave one of them out")
        print_file(rotor.to_toml())
        return 0
    for body in rotor.fields.body:
        note_input(rotor.folder / body.file)
    for file, suffix in ((options.csv, ".csv"), (options.report, ".html"), (options.cut_part, ".stl")):
        if file is not None:
            require_writable(file, suffix, force=options.force)
    require_recordable(options)
    if options.cut_part is not None and not any(plane.method in CUTTING for plane in rotor.fields.plane):
        raise UsageError(
            f"{options.part}: --cut-part has nothing to write: no correction plane is drilled or milled, and "
            "weights and masses are not put into the mesh"
        )
    with Progress("balancing") as progress:
        result = balance_rotor(rotor, progress=progress)
    data = report_data(result)
    write_and_show(
        lambda: _write(result, data, options),
        options.json,
        lambda: balance_document(data),
        lambda: "\n".join([balance_text(data), *(row("Missing", sentence) for sentence in _missing(options))]),
    )
    tell_of_viewer(options)
    tell_what_is_not_cut(options.cut_part, result)
    return _code(result.verdict)


def tell_what_is_not_cut(file: str | None, balance: Balance | None) -> None:
    """Say of a corrected mesh which operations it does not show."""
    if file is None or balance is None or balance.correction is None:
        return
    left = [each.id for each in balance.correction.operations if each.kind in ("point_mass", "weight")]
    if left:
        names = ", ".join(left)
        print(f"inertia: {file} holds what is cut: weights and masses ({names}) are not in its mesh", file=sys.stderr)


def _code(verdict: Verdict) -> int:
    if verdict.outcome == "conditional":
        return 5 if verdict.within is not None and verdict.within < 0.5 else 4
    return {"pass": 0, "fail": 5, "undecided": 4}[verdict.outcome]


def _write(balance: Balance, data: ReportData, options: argparse.Namespace) -> None:
    """Write the files that were asked for, all of them or none."""
    from inertia.mesh.write import write_stl
    from inertia.output import together, write_whole
    from inertia.report.balance.document import balance_csv
    from inertia.report.balance.html import save_balance_html

    with together():
        if options.csv is not None:
            write_whole(Path(options.csv), balance_csv(data).encode())
        if options.report is not None:
            save_balance_html(data, options.report, force=options.force)
        if options.output is not None or options.live:
            record(balance, options.output, options, live=options.live)
        if options.cut_part is not None and balance.correction is not None:
            write_stl(balance.correction.parts, options.cut_part, balance.rotor.unit, force=options.force)


def _rotor(options: argparse.Namespace) -> Rotor:
    from inertia.balancing.rotor import Rotor

    for name in _SHORT:
        if getattr(options, name) is not None:
            option = f"--{name.replace('_', '-')}"
            raise UsageError(f"{option} goes with a part: {options.part} is a rotor file, write it there")
    if names_recording(options.part):
        from inertia.recording.provenance import rotor_of

        return rotor_of(options.part)
    return Rotor.load(options.part)


def _rotor_of_part(options: argparse.Namespace) -> Rotor:
    """Return the rotor that the options describe."""
    from inertia.balancing.rotor import Rotor

    body = {
        "file": options.part,
        "unit": options.unit,
        "density": options.density,
        "material": options.material,
        "mass": options.mass,
        "sigma": options.sigma,
        "chord_tolerance": options.chord,
    }
    axis = {"radial_uncertainty": options.axis_uncertainty, "rotation": options.rotation, **_axis(options)}
    method = {} if options.drill is None else {"method": "drill_radial", "diameters": options.drill}
    if options.drill is None and options.max_depth is not None:
        raise UsageError("--max-depth is that of holes: give --drill with it")
    if options.drill is not None and options.planes is None:
        raise UsageError("--drill says with what, but not where: give --planes with it")
    # Options count along --axis, a rotor's places from bearing A to B.
    back = options.axis is not None and len(options.bearings or ()) == 2 and options.bearings[1] < options.bearings[0]
    planes = [
        {"id": _ROMAN[k] if k < len(_ROMAN) else str(k + 1), "z": 0.0 - z if back else z, **method}
        | {"max_depth": options.max_depth}
        for k, z in enumerate(options.planes or [])
    ]
    table: dict[str, Any] = {
        "unit": options.unit or "mm",
        "body": [_without_none(body)],
        "axis": _without_none(axis),
        "service": _without_none({"rpm": options.rpm, "critical_rpm": options.critical_rpm}),
        "tolerance": _without_none({"grade": options.grade, "e_um": options.e_um}),
        "plane": [_without_none(plane) for plane in planes],
    }
    if not table["tolerance"]:
        raise UsageError(f"{options.part}: ", *_PERMISSIBLE)
    return Rotor.from_dict(table, name=options.part)


def _axis(options: argparse.Namespace) -> dict[str, Any]:
    """Return where the shaft runs; without an axis, that candidates for it are asked for."""
    if options.axis is None or options.bearings is None:
        lone = next((name for name in ("axis", "through", "bearings") if getattr(options, name) is not None), None)
        if lone is not None:
            raise UsageError(f"--{lone} alone leaves the shaft open: give --axis and --bearings")
        return {"journals": "detect", **({} if options.zero_mark is None else {"zero_mark": list(options.zero_mark)})}
    if len(options.bearings) != 2:
        raise UsageError(f"--bearings names {len(options.bearings)} places: give two, A,B")
    length = math.hypot(*options.axis)
    if length == 0:
        raise UsageError("--axis has no length: give x, y, z or a direction")
    along = [x / length for x in options.axis]
    through = options.through or (0.0, 0.0, 0.0)
    start = sum(x * d for x, d in zip(through, along, strict=True))
    ends = ([x + (place - start) * d for x, d in zip(through, along, strict=True)] for place in options.bearings)
    across = [1.0, 0.0, 0.0] if abs(along[0]) < 0.9 else [0.0, 1.0, 0.0]
    mark = across if options.zero_mark is None else list(options.zero_mark)
    return {"bearing_a": next(ends), "bearing_b": next(ends), "zero_mark": mark}


def _without_none(entries: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in entries.items() if value is not None}


def _numbers(text: str) -> list[float]:
    try:
        return [float(one) for one in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no list of numbers: give them as A,B") from None


def _grade(text: str) -> float:
    from inertia.balancing.standards import GRADE

    written = GRADE.fullmatch(text)
    try:
        return float(written[1] if written else text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no grade: give a number, as 6.3 or G6.3") from None


def _direction(text: str) -> tuple[float, ...]:
    return _AXES[text] if text in _AXES else triple(text)
