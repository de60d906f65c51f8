"""The command `budget`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from inertia_cli.assembly import add_tree_options, assembly_of, tell_of_partial
from inertia_cli.options import record, require_recordable, tell_of_viewer
from inertia_cli.printing import show, write_and_show

_CODES = {None: 0, "pass": 0, "fail": 5, "undecided": 4}

_EXAMPLES = """examples:
  inertia budget satellite.toml
  inertia budget satellite.toml --report budget.html --csv budget.csv
  inertia budget --diff before.toml after.toml
"""


def add(parsers: Any) -> None:
    """Add ``inertia budget``."""
    parser = parsers.add_parser(
        "budget",
        help="the mass budget of an assembly: allowances, uncertainties, limits",
        description="List what each part of an assembly contributes to its mass, with growth allowances and standard "
        "uncertainties, and judge the limits; exit code 5 if one is exceeded, 4 if one is undecided, with --diff of "
        "NEW.",
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
    add_tree_options(parser)
    parser.add_argument(
        "--diff",
        nargs=2,
        metavar=("OLD", "NEW"),
        help="what changed from one assembly file to another, and what it did",
    )
    parser.add_argument("--report", metavar="FILE.html", help="write a report with pictures: one HTML file")
    parser.add_argument("--csv", metavar="FILE.csv", help="write a row for each part, SI")
    parser.add_argument("-o", "--output", metavar="FILE.rrd", help="record the tree, for `inertia play`")
    parser.add_argument(
        "--live", action="store_true", help="stream it to the Rerun viewer that is open on this machine"
    )
    parser.add_argument("--force", action="store_true", help="replace files that are there")
    parser.add_argument(
        "--json",
        action="store_true",
        help="print one JSON document (inertia/budget/1, with --diff inertia/budget-diff/1)",
    )


def run(options: argparse.Namespace) -> int:
    """Run ``inertia budget``."""
    from inertia.errors import UsageError
    from inertia.output import require_writable, together, write_whole
    from inertia.report.budget.document import budget_document
    from inertia.report.budget.text import budget_text

    if options.diff is not None:
        return _diff(options)
    if options.part is None:
        raise UsageError("no assembly is named: give an assembly file, see `inertia budget --help`")
    for file, suffix in ((options.csv, ".csv"), (options.report, ".html")):
        if file is not None:
            require_writable(file, suffix, force=options.force)
    require_recordable(options)
    whole = assembly_of(options).budget()

    def write() -> None:
        with together():
            if options.output is not None or options.live:
                record(whole, options.output, options, live=options.live)
            if options.report is not None:
                from inertia.report.budget.html import write_budget

                write_budget(whole, options.report, force=options.force)
            if options.csv is not None:
                from inertia.tables import csv_text

                table = whole.columns
                write_whole(Path(options.csv), csv_text([table, *zip(*table.values(), strict=True)]).encode())

    write_and_show(write, options.json, lambda: budget_document(whole), lambda: budget_text(whole))
    tell_of_viewer(options)
    return tell_of_partial(whole.assembly) or _CODES[whole.verdict]


def _diff(options: argparse.Namespace) -> int:
    from inertia.assembly.compare import compare
    from inertia.errors import UsageError
    from inertia.report.budget.comparison import comparison_document, comparison_text

    others = options.part, options.csv, options.report, options.unit, options.joint or None, options.output
    if options.live or any(other is not None for other in others):
        raise UsageError("--diff takes two assembly files and nothing else but --json: leave the rest out")
    budgets = []
    for file in options.diff:
        options.part = file  # what goes wrong is said of it
        budgets.append(assembly_of(options).budget())
    comparison = compare(*budgets)
    show(options.json, lambda: comparison_document(comparison), lambda: comparison_text(comparison))
    return max(tell_of_partial(budget.assembly) for budget in budgets) or _CODES[comparison.new.verdict]
