"""The command `trade`."""

from __future__ import annotations

import argparse
from typing import Any

from inertia.errors import UsageError
from inertia.estimate import Estimate
from inertia_cli.options import accuracy, add_input, names_document, read_part
from inertia_cli.printing import write_and_show
from inertia_cli.progress import Progress
from inertia_cli.wording import as_option

_EXAMPLES = """examples:
  inertia trade part.stl
  inertia trade part.stl --accuracy 1e-3 --plot trade.svg
  inertia trade scene.toml --accuracy 1e-9
"""


def add(parsers: Any) -> None:
    """Add ``inertia trade``."""
    parser = parsers.add_parser(
        "trade",
        help="what accuracy costs on this part or scene: time against error",
        description="Measure, on this machine, time against error: of a part for every method and for simplified "
        "meshes, of a scene (.toml) for every method that can follow it.",
        epilog=_EXAMPLES,
    )
    parser.set_defaults(run=run)
    add_input(parser)
    parser.add_argument(
        "--density",
        type=_density,
        metavar="KG/M3",
        help="of the part; 1000 is assumed without it, and an uncertainty behind it costs nothing here",
    )
    parser.add_argument("--material", metavar="MATERIAL", help="take the density from the table of materials")
    parser.add_argument(
        "--accuracy",
        type=accuracy,
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


def _density(text: str) -> float:
    """Return a density, kg/m³, without its uncertainty, which no row depends on."""
    try:
        return float(Estimate.parse(text))
    except UsageError:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of kg/m³, as 7850") from None


def run(options: argparse.Namespace) -> int:
    """Run ``inertia trade``."""
    from inertia.mass.analyse import sound_solids_only
    from inertia.plotting import require_plottable
    from inertia.work_precision.plot import plot
    from inertia.work_precision.render import trade_document, trade_text
    from inertia.work_precision.trade import PartTrade, SceneTrade
    from inertia.work_precision.trade import trade as measure

    scene = names_document(options)
    for name in ("unit", "format", "density", "material"):
        if scene and getattr(options, name) is not None:
            raise UsageError(f"--{name} goes with a part: {options.part} says itself what its body is")
    if options.plot is not None:
        require_plottable(options.plot, force=options.force)
    how = {"repeats": options.repeats, "budget": options.budget}
    cost: PartTrade | SceneTrade
    if scene:
        from inertia.dynamics.scene.document import Scene

        with Progress("measuring") as progress:
            cost = measure(Scene.load(options.part), options.accuracy, progress=progress, **how)
    else:
        part, hashing = read_part(options)
        hashing.join()  # beside the measuring it would disturb it
        weight = {"density": options.density, "material": options.material}
        with sound_solids_only("a trade takes a sound solid only"), Progress("measuring") as progress:
            cost = measure(part, options.accuracy, progress=progress, **weight, **how)

    def draw() -> None:
        if options.plot is not None:
            plot(cost, options.plot, force=options.force)

    write_and_show(
        draw,
        options.json,
        lambda: trade_document(cost, wording=as_option),
        lambda: trade_text(cost, wording=as_option),
    )
    return 0
