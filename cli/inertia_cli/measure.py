"""The command `balance measure`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import UsageError
from inertia_cli.balance import require_no_results, show_grades, tell_what_is_not_cut
from inertia_cli.printing import print_document, write_and_show
from inertia_cli.progress import Progress

if TYPE_CHECKING:
    from inertia.balancing.measured.measure import Measurement

NAME = "balance measure"
_FILES = (
    ("certificate", ".html"), ("log", ".csv"), ("coefficients", ".toml"), ("report", ".html"), ("cut_part", ".stl"),
)  # fmt: skip
_CODES = {"pass": 0, None: 0, "fail": 5, "undecided": 4, "conditional": 4}

_EXAMPLES = """examples:
  inertia balance measure fan.toml                             # what to mount, and whether it is in tolerance
  inertia balance measure fan.toml --certificate fan.html --log fan-log.csv
  inertia balance measure fan.toml --coefficients fan-coefficients.toml     # for the next job on this machine
  inertia balance measure --schema > job.schema.json

exit codes: 0 passed, or nothing says what is permissible, 5 failed, 4 undecided; others as `inertia --help` has them
"""


def add(parsers: Any) -> None:
    """Add ``inertia balance measure``."""
    parser = parsers.add_parser(
        NAME,
        help="readings of a machine to weights or holes, and a certificate",
        description="Balance from readings: runs with trial weights, of a balancing machine, or without phase, become "
        "weights at positions, or holes in the rotor of a rotor file, with their uncertainty and a verdict.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    parser.add_argument("part", nargs="?", metavar="JOB", help="a job (.toml); - for standard input")
    parser.add_argument("--json", action="store_true", help="print one JSON document (inertia/measurement/1)")
    parser.add_argument("--certificate", metavar="FILE.html", help="write the certificate: one HTML file")
    parser.add_argument("--log", metavar="FILE.csv", help="write the log of runs as CSV")
    parser.add_argument("--coefficients", metavar="FILE.toml", help="write the influence coefficients, for a later job")
    parser.add_argument("--report", metavar="FILE.html", help="write the report on the rotor file, with its shop sheet")
    parser.add_argument("--cut-part", metavar="FILE.stl", help="write the corrected mesh of the rotor file")
    parser.add_argument(
        "--time", type=float, metavar="SECONDS", help="how long a plan of corrections of the rotor is looked for (10)"
    )
    parser.add_argument("--force", action="store_true", help="write over files that exist")
    parser.add_argument("--grades", action="store_true", help="print grades, their machines and standards, and stop")
    parser.add_argument("--schema", action="store_true", help="print the JSON Schema of a job, and stop")


def run(options: argparse.Namespace) -> int:
    """Run ``inertia balance measure``."""
    require_no_results(options, (name for name, _ in _FILES))
    if options.schema:
        from inertia.balancing.measured.job import json_schema

        print_document(json_schema())
        return 0
    if options.grades:
        return show_grades(as_json=options.json)
    if options.part is None:
        raise UsageError("no job is named: give a job file, see `inertia balance measure --help`")
    from inertia.balancing.measured.job import Job
    from inertia.balancing.measured.measure import measure
    from inertia.output import require_writable
    from inertia.report.measurement.document import measurement_document
    from inertia.report.measurement.text import measurement_text

    for name, suffix in _FILES:
        if getattr(options, name) is not None:
            require_writable(getattr(options, name), suffix, force=options.force)
    job = Job.load(options.part)
    for name in ("report", "cut_part"):
        if getattr(options, name) is not None and job.fields.rotor is None:
            option = f"--{name.replace('_', '-')}"
            raise UsageError(
                f"{options.part}: {option} is of a rotor file, and the job names none: give it as rotor = ..."
            )
    with Progress("balancing") as progress:
        result = measure(job, seconds=options.time, progress=progress)
    write_and_show(
        lambda: _write(result, options),
        options.json,
        lambda: measurement_document(result),
        lambda: measurement_text(result),
    )
    for file in (options.report, options.cut_part):
        if file is not None and result.balance is None:
            print(f"inertia: {file} is not written: the readings do not bound the unbalance", file=sys.stderr)
    tell_what_is_not_cut(options.cut_part, result.balance)
    return _CODES[result.outcome]


def _write(result: Measurement, options: argparse.Namespace) -> None:
    """Write the files that were asked for, all of them or none."""
    from inertia.mesh.write import write_stl
    from inertia.output import together, write_whole
    from inertia.report.balance.figures import report_data
    from inertia.report.balance.html import save_balance_html
    from inertia.report.measurement.document import measurement_csv
    from inertia.report.measurement.html import certificate_html

    with together():
        if options.certificate is not None:
            write_whole(Path(options.certificate), certificate_html(result).encode("utf-8", "replace"))
        if options.log is not None:
            write_whole(Path(options.log), measurement_csv(result).encode())
        if options.coefficients is not None:
            write_whole(Path(options.coefficients), result.coefficients().to_toml().encode())
        balance = result.balance
        if options.report is not None and balance is not None:
            data = report_data(balance, machine=result.job.machine_angles)
            save_balance_html(data, options.report, force=options.force)
        if options.cut_part is not None and balance is not None and balance.correction is not None:
            write_stl(balance.correction.parts, options.cut_part, balance.rotor.unit, force=options.force)
