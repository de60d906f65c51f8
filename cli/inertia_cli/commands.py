"""One function for each command: call the library, print what the report room makes of the result."""

from __future__ import annotations

import argparse
import contextlib
import threading
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from inertia.errors import InertiaError, UsageError
from inertia_cli.documents import print_document
from inertia_cli.progress import Progress
from inertia_cli.wording import as_option

if TYPE_CHECKING:
    from inertia.mass.analysis import Analysis
    from inertia.mass.repair import Repaired
    from inertia.mesh.part import Part

T = TypeVar("T")

UNFIT = 4
_COARSER = 2.0


def analyse(options: argparse.Namespace) -> int:
    """Run ``inertia analyse``."""
    from inertia.report.analysis.document import analysis_document
    from inertia.report.analysis.text import analysis_text

    if options.richardson and options.chord is not None:
        raise UsageError("--chord and --richardson are two answers to one question: give one")
    part, hashing = _read(options)
    repaired = _repaired(part, options)
    analysis = _analysed(part if repaired is None else repaired.part, options)
    if options.richardson:
        from inertia.mass.tessellation import richardson

        coarse, _ = _read(options, coarser=_COARSER)
        mended = _repaired(coarse, options)
        coarser = _analysed(coarse if mended is None else mended.part, options)
        estimate = richardson(coarser.properties, analysis.properties, _COARSER)
        analysis = replace(analysis, tessellation=estimate)
    hashing.join()
    if options.json:
        print_document(analysis_document(analysis, repaired))
    else:
        print(analysis_text(analysis, repaired, wording=as_option))
    return 0


def _repaired(part: Part, options: argparse.Namespace) -> Repaired | None:
    if not options.repair and options.weld is None:
        return None
    from inertia.mass.repair import repair, weld

    return repair(part, options.weld) if options.repair else weld(part, options.weld)


def _analysed(part: Part, options: argparse.Namespace) -> Analysis:
    from inertia.mass.analysis import analyse as analyse_part

    tolerance = {} if options.class_tolerance is None else {"class_tolerance": options.class_tolerance}
    with Progress("integrating") as progress:
        return analyse_part(
            part,
            by_name("density", options.density),
            material=by_name("material", options.material),
            mass=options.mass,
            accuracy=options.accuracy,
            shell=options.shell,
            wire=options.wire,
            orientation=options.orientation,
            about=options.about,
            chord=options.chord,
            progress=progress,
            **tolerance,
        )


def check(options: argparse.Namespace) -> int:
    """Run ``inertia check``."""
    from inertia.mesh.check import check as check_part
    from inertia.report.check import check_document, check_text

    part, hashing = _read(options)
    report = check_part(part, intersections=options.intersections)
    hashing.join()
    if options.json:
        print_document(check_document(part, report, options.orientation, wording=as_option))
    else:
        print(check_text(part, report, options.orientation, wording=as_option))
    return UNFIT if report.faults(options.orientation) else 0


def trade(options: argparse.Namespace) -> int:
    """Run ``inertia trade``."""
    from inertia.mass.analysis import sound_solids_only
    from inertia.work_precision.plot import plot, require_plottable
    from inertia.work_precision.render import trade_document, trade_text
    from inertia.work_precision.trade import PartTrade, SceneTrade
    from inertia.work_precision.trade import trade as measure

    scene = options.part.lower().endswith(".toml")
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
        part, hashing = _read(options)
        hashing.join()  # beside the measuring it would disturb it
        weight = {"density": options.density, "material": options.material}
        with sound_solids_only("a trade takes a sound solid only"), Progress("measuring") as progress:
            cost = measure(part, options.accuracy, progress=progress, **weight, **how)
    try:
        if options.plot is not None:
            plot(cost, options.plot, force=options.force)
    finally:  # what took so long to measure is told even where the plot cannot be written
        if options.json:
            print_document(trade_document(cost))
        else:
            print(trade_text(cost, wording=as_option))
    return 0


def _read(options: argparse.Namespace, coarser: float = 1.0) -> tuple[Part, threading.Thread]:
    """Read the part, and begin to hash its file beside the work that follows."""
    from inertia.mesh.read import read

    part = read(options.part, options.unit, format=options.format, coarser=coarser)

    def digest() -> None:
        with contextlib.suppress(InertiaError):  # it is raised again where the digest is needed
            part.source.sha256  # noqa: B018  # the property keeps it

    hashing = threading.Thread(target=digest, daemon=True)
    hashing.start()
    return part, hashing


def by_name(option: str, values: list[tuple[str, T]]) -> dict[str, T] | None:
    """Return what an option that may be repeated said of each name; None where it was not given."""
    given: dict[str, T] = {}
    for name, value in values:
        if name in given:
            raise UsageError(f"--{option} is given twice for {repr(name) if name else 'the part'}: give it once")
        given[name] = value
    return given or None
