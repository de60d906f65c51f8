"""`Trade` → a table of text, and the document ``inertia/trade/1``."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from inertia.report.layout import LABEL, number, row
from inertia.work_precision.compare import Relative
from inertia.work_precision.recommend import duration
from inertia.work_precision.rows import Row
from inertia.work_precision.trade import Trade

_WIDTH = 100
_SAID_BY = {
    "option": "as given",
    "file": "from the file",
    "material": "of the material given",
    "assumed": "assumed",
}
_STEPS = {"read": "reading the file", "closedness": "pairing its edges", "results": "results with bounds"}


def trade_document(trade: Trade) -> dict[str, Any]:
    """Return the trade as ``inertia/trade/1``; numbers are SI, errors and bounds relative."""
    analysis, part = trade.analysis, trade.analysis.part
    return {
        "schema": "inertia/trade/1",
        "source": {"path": part.source.path, "sha256": part.source.sha256, "format": part.source.format},
        "unit": part.unit.name,
        "unit_from": part.unit_from,
        "density": analysis.density,
        "density_from": analysis.density_from,
        "mesh": {"triangles": analysis.triangles, "closed": analysis.closed, "bodies": analysis.bodies},
        "accuracy": trade.accuracy,
        "machine": asdict(trade.machine),
        "repeats": trade.repeats,
        "budget": trade.budget,
        "steps": {name: asdict(timing) for name, timing in trade.steps.items()},
        "reference": trade.reference,
        "rows": [_row_document(row) for row in trade.rows],
        "skipped": [asdict(item) for item in trade.skipped],
        "recommendations": [
            {
                "coarsest": advice.coarsest,
                "finest": advice.finest,
                "row": None if advice.row is None else trade.rows.index(advice.row),
                "sentence": advice.sentence,
            }
            for advice in trade.recommendations
        ],
        "notes": list(analysis.notes),
    }


def _row_document(row: Row) -> dict[str, Any]:
    properties = row.properties
    return {
        "method": row.method,
        "mesh": row.mesh,
        "triangles": row.triangles,
        "simplification": None if row.simplification is None else asdict(row.simplification),
        "time": asdict(row.time),
        "error": None if row.error is None else _relative(row.error),
        "bound": _relative(row.bound),
        "reached": row.reached,
        "loses_smallest_moment": properties.loses_smallest_moment,
        "volume": properties.volume,
        "mass": properties.mass,
        "center_of_mass": properties.center_of_mass.tolist(),
        "inertia": properties.inertia.tolist(),
    }


def _relative(error: Relative) -> dict[str, float]:
    return {"volume": error.volume, "center_of_mass_over_size": error.center_of_mass, "inertia": error.inertia}


def trade_text(trade: Trade) -> str:
    """Return the trade as lines of text, at most 100 columns wide but for long paths."""
    blocks = [list(_head(trade)), list(_whole(trade)), list(_simplified(trade)), list(_closing(trade))]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _head(trade: Trade) -> Iterator[str]:
    analysis, part = trade.analysis, trade.analysis.part
    bodies = f"{analysis.bodies} {'body' if analysis.bodies == 1 else 'bodies'}"
    yield row("Part", f"{part.name} ({part.source.format}), {analysis.triangles} triangles, {bodies}")
    yield row("Unit", f"{part.unit.name} ({_SAID_BY[part.unit_from]})")
    density, mass = number(analysis.density), number(analysis.properties.mass)
    yield row("Density", f"{density} kg/m³ ({_SAID_BY[analysis.density_from]}), for a mass of {mass} kg")
    yield from paragraph("Machine", f"{trade.machine}; the times are of this machine")
    yield from paragraph(
        "Time", "wall time of the integration alone, median of the runs; first use (compiling, loading) is not counted"
    )
    steps = ", ".join(f"{_STEPS[name]} {duration(timing.median)}" for name, timing in trade.steps.items())
    yield from paragraph("Besides", steps)


def _whole(trade: Trade) -> Iterator[str]:
    yield from _heads("Whole mesh", "Method", f"error against {trade.reference}", "certified")
    for line in trade.rows:
        if line.simplification is None:
            yield _line(line.method, line)


def _simplified(trade: Trade) -> Iterator[str]:
    unit = trade.analysis.part.unit
    simpler = [(line, line.simplification) for line in trade.rows if line.simplification]
    if not simpler:
        return
    names = f"{'Mesh':<9}{'Triangles':>9}{f'Tol., {unit.name}':>9}{'Made in':>9}"
    yield from _heads("Simplified meshes, float64", names, "error by simplifying", "arithmetic")
    for line, made in simpler:
        tolerance = f"{made.tolerance / float(unit.metres):.2g}"
        yield _line(f"{line.mesh:<9}{line.triangles:>9}{tolerance:>9}{duration(made.seconds):>9}", line)


def _heads(title: str, names: str, error: str, bound: str) -> Iterator[str]:
    yield f"{title:<36}{'time, ms':>15}{'':>12}{error:^27}{bound:>10}"
    yield f"{names:<36}{'median':>9}{'range':>13}{'runs':>5}{'volume':>9}{'COM/size':>9}{'tensor':>9}{'bound':>10}"


def _line(names: str, line: Row) -> str:
    time = line.time
    spread = f"{milliseconds(time.fastest)}–{milliseconds(time.slowest)}"
    errors = "".join(f"{_error(value):>9}" for value in _errors(line.error))
    return f"{names:<36}{milliseconds(time.median):>9}{spread:>13}{time.runs:>5}{errors}{_error(line.bound.worst):>10}"


def _closing(trade: Trade) -> Iterator[str]:
    for k, advice in enumerate(trade.recommendations):
        yield from paragraph("" if k else "Recommended", advice.sentence)
    for item in trade.skipped:
        estimate = "" if item.seconds is None else f" (about {duration(item.seconds)}): give a larger --budget"
        yield from paragraph("Skipped", f"{item.what}: {item.why}{estimate}")
    whole = [line for line in trade.rows if line.simplification is None]
    if losing := [line.method for line in whole if line.properties.loses_smallest_moment]:
        verb = "leaves" if len(losing) == 1 else "leave"
        yield from paragraph(
            "Slender",
            f"{' and '.join(losing)} {verb} the smallest principal moment uncertain by more than a part in 10⁹: such "
            "rows are recommended only where no other one reaches the accuracy",
        )
    for note in trade.analysis.notes:
        yield from paragraph("Note", note)
    yield from paragraph(
        "Errors",
        "over the whole mesh they are those of the arithmetic, over a simplified one those of its geometry; how far "
        "the mesh lies from the shape that was meshed, its tessellation, is in neither",
    )


def paragraph(label: str, text: str) -> Iterator[str]:
    """Yield the lines of a labelled text; a time stays together with its unit."""
    tied = re.sub(r"(\d) (ms|s)\b", "\\1\N{NO-BREAK SPACE}\\2", text)
    for k, line in enumerate(textwrap.wrap(tied, _WIDTH - LABEL, break_long_words=False, break_on_hyphens=False)):
        yield row("" if k else label, line.replace("\N{NO-BREAK SPACE}", " "))


def milliseconds(seconds: float) -> str:
    """Return a time in ms, to three digits."""
    value = 1e3 * seconds
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def _errors(error: Relative | None) -> tuple[float | None, ...]:
    return (None, None, None) if error is None else (error.volume, error.center_of_mass, error.inertia)


def _error(value: float | None) -> str:
    return "–" if value is None else f"{value:.1e}" if value else "0"
