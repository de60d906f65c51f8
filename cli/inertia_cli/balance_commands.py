"""The command `balance`."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import GeometryError, ReadError, UsageError
from inertia_cli.documents import print_document
from inertia_cli.progress import Progress
from inertia_cli.run_commands import require_recordable
from inertia_cli.wording import with_options

if TYPE_CHECKING:
    from inertia.balancing.balance import Balance
    from inertia.balancing.rotor import Rotor
    from inertia.report.balance.data import ReportData

_CODES = {"pass": 0, "fail": 5, "undecided": 4}
_ROMAN = ("I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X")
_OPTIONS = {  # fields of a rotor file, by their path without numbers, and what stands for them on the command line
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
    "body[0].mass": "--mass",
    "body[0].unit": "--unit",
    "body[0]": "",
}
_SHORT = (
    "unit", "density", "material", "mass", "chord", "axis", "through", "bearings", "axis_uncertainty", "zero_mark",
    "rotation", "rpm", "critical_rpm", "grade", "e_um", "planes", "drill", "max_depth",
)  # fmt: skip


def balance(options: argparse.Namespace) -> int:
    """Run ``inertia balance``."""
    if options.schema:
        from inertia.balancing.rotor import json_schema

        print_document(json_schema())
        return 0
    if options.part is None:
        raise UsageError("no rotor is named: give a rotor file or a part, see `inertia balance --help`")
    if Path(options.part).suffix.lower() == ".toml":
        return _balanced(_rotor(options), options)
    try:
        return _balanced(_rotor_of_part(options), options)
    except (UsageError, GeometryError, ReadError) as error:
        raise with_options(error, _OPTIONS, part=options.part) from None


def _balanced(rotor: Rotor, options: argparse.Namespace) -> int:
    from inertia.balancing.balance import balance as balance_rotor
    from inertia.output import require_writable
    from inertia.report.balance.document import balance_document
    from inertia.report.balance.figures import report_data
    from inertia.report.balance.text import balance_text

    if options.to_toml:
        print(rotor.to_toml(), end="")
        return 0
    for file, suffix in ((options.csv, ".csv"), (options.report, ".html"), (options.cut_part, ".stl")):
        if file is not None:
            require_writable(file, suffix=suffix, force=options.force)
    require_recordable(options)
    if options.cut_part is not None and not any(plane.method for plane in rotor.fields.plane):
        raise UsageError(f"{options.part}: --cut-part has nothing to write: no correction plane has a method")
    with Progress("balancing") as progress:
        found = balance_rotor(rotor, progress=progress)
    data = report_data(found)
    _write(found, data, options)
    if options.json:
        print_document(balance_document(data))
    else:
        print(balance_text(data))
    return _CODES[found.verdict.outcome]


def _write(found: Balance, data: ReportData, options: argparse.Namespace) -> None:
    """Write the files that were asked for."""
    from inertia.mesh.write import write_stl
    from inertia.output import write_whole
    from inertia.report.balance.document import balance_csv
    from inertia.report.balance.html import save_balance_html

    if options.csv is not None:
        write_whole(Path(options.csv), balance_csv(data).encode())
    if options.report is not None:
        save_balance_html(data, options.report, force=options.force)
    if options.output is not None or options.live:
        from inertia.recording.record import record

        record(found, options.output, force=options.force, live=options.live)
    if options.cut_part is not None and found.correction is not None:
        write_stl(found.correction.parts, options.cut_part, found.rotor.unit, force=options.force)


def _rotor(options: argparse.Namespace) -> Rotor:
    from inertia.balancing.rotor import Rotor

    for name in _SHORT:
        if getattr(options, name) is not None:
            option = f"--{name.replace('_', '-')}"
            raise UsageError(f"{option} goes with a part: {options.part} is a rotor file, write it there")
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
        "chord_tolerance": options.chord,
    }
    axis = {"radial_uncertainty": options.axis_uncertainty, "rotation": options.rotation, **_axis(options)}
    method = {} if options.drill is None else {"method": "drill_radial", "diameters": options.drill}
    if options.drill is None and options.max_depth is not None:
        raise UsageError("--max-depth is that of holes: give --drill with it")
    if options.drill is not None and options.planes is None:
        raise UsageError("--drill says with what, but not where: give --planes with it")
    planes = [
        {"id": _ROMAN[k] if k < len(_ROMAN) else str(k + 1), "z": z, "max_depth": options.max_depth, **method}
        for k, z in enumerate(options.planes or [])
    ]
    table: dict[str, Any] = {
        "unit": options.unit or "mm",
        "body": [_stated(body)],
        "axis": _stated(axis),
        "service": _stated({"rpm": options.rpm, "critical_rpm": options.critical_rpm}),
        "tolerance": _stated({"grade": options.grade, "e_um": options.e_um}),
        "plane": [_stated(plane) for plane in planes],
    }
    if not table["tolerance"]:
        raise UsageError("nothing says what is permissible: give --grade, or --e-um")
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


def _stated(entries: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in entries.items() if value is not None}
