"""One function for each command: call the library, print what the report room makes of the result."""

from __future__ import annotations

import argparse
import contextlib
import json
import threading
from typing import TYPE_CHECKING, Any, TypeVar

from inertia.errors import InertiaError, UsageError
from inertia_cli.progress import Progress

if TYPE_CHECKING:
    from inertia.mesh.part import Part

T = TypeVar("T")

UNFIT = 4


def analyse(options: argparse.Namespace) -> int:
    """Run ``inertia analyse``."""
    from inertia.mass.analysis import analyse as analyse_part
    from inertia.report.analysis import analysis_document, analysis_text

    part, hashing = _read(options)
    repaired = None
    if options.repair or options.weld is not None:
        from inertia.mass.repair import repair, weld

        repaired = repair(part, options.weld) if options.repair else weld(part, options.weld)
        part = repaired.part
    tolerance = {} if options.class_tolerance is None else {"class_tolerance": options.class_tolerance}
    with Progress("integrating") as progress:
        analysis = analyse_part(
            part,
            _by_name("density", options.density),
            material=_by_name("material", options.material),
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
    hashing.join()
    if options.json:
        _print_document(analysis_document(analysis, repaired))
    else:
        print(analysis_text(analysis, repaired))
    return 0


def check(options: argparse.Namespace) -> int:
    """Run ``inertia check``."""
    from inertia.mesh.check import check as check_part
    from inertia.report.check import check_document, check_text

    part, hashing = _read(options)
    report = check_part(part, intersections=options.intersections)
    hashing.join()
    if options.json:
        _print_document(check_document(part, report, options.orientation))
    else:
        print(check_text(part, report, options.orientation))
    return UNFIT if report.faults(options.orientation) else 0


def _read(options: argparse.Namespace) -> tuple[Part, threading.Thread]:
    """Read the part, and begin to hash its file beside the work that follows."""
    from inertia.mesh.read import read

    part = read(options.part, options.unit, format=options.format)

    def digest() -> None:
        with contextlib.suppress(InertiaError):  # it is raised again where the digest is needed
            part.source.sha256  # noqa: B018  # the property keeps it

    hashing = threading.Thread(target=digest, daemon=True)
    hashing.start()
    return part, hashing


def _by_name(option: str, values: list[tuple[str, T]]) -> dict[str, T] | None:
    given: dict[str, T] = {}
    for name, value in values:
        if name in given:
            raise UsageError(f"--{option} is given twice for {repr(name) if name else 'the part'}: give it once")
        given[name] = value
    return given or None


def _print_document(document: dict[str, Any]) -> None:
    """Print one JSON document, a line for each of its fields."""
    fields = (f" {json.dumps(key)}: {_as_json(value)}" for key, value in document.items())
    print("{\n" + ",\n".join(fields) + "\n}")


def _as_json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
