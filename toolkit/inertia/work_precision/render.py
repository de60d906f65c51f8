"""`Trade` → a table of text, and the document ``inertia/trade/1`` of a part or ``inertia/trade-scene/1`` of a scene."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any, Generic

import numpy as np

from inertia.errors import Remedy, Sentence, Wording
from inertia.records import dataclass
from inertia.report.numerals import LABEL, number, row
from inertia.work_precision.recommend import duration
from inertia.work_precision.rows import PartRow, R, Relative, SceneRow, front
from inertia.work_precision.trade import PartTrade, SceneTrade, Trade

_BUDGET = Remedy("trade", "budget")
_WIDTH = 100
_ORIGINS = {
    "option": "as given",
    "file": "from the file",
    "material": "of the material given",
    "assumed": "assumed",
}
_STEPS = {"read": "reading the file", "closedness": "pairing its edges", "results": "results with bounds"}


def trade_document(trade: PartTrade | SceneTrade, *, wording: Wording = str) -> dict[str, Any]:
    """Return the trade as ``inertia/trade/1``, its errors and bounds relative, or ``inertia/trade-scene/1``; all SI."""
    if isinstance(trade, PartTrade):
        analysis, part = trade.analysis, trade.analysis.part
        return {
            "schema": "inertia/trade/1",
            "source": part.source.to_dict(),
            "unit": part.unit.name,
            "unit_from": part.unit_from,
            "density": analysis.density,
            "density_from": analysis.density_from,
            "mesh": {"triangles": analysis.triangles, "closed": analysis.closed, "bodies": analysis.bodies},
            **_head_document(trade),
            "steps": {name: asdict(timing) for name, timing in trade.steps.items()},
            "reference": trade.reference.method,
            **_rows_document(trade, [_part_row_document(line) for line in trade.rows], wording),
            "notes": list(analysis.notes),
        }
    best, doubt = front(trade.rows), trade.reference.estimate
    lines = [_scene_row_document(line, doubt, on_front=line in best) for line in trade.rows]
    return {
        "schema": "inertia/trade-scene/1",
        "scene": trade.scene.name,
        "duration": trade.scene.run.duration,
        "samples": trade.scene.run.samples,
        **_head_document(trade),
        "reference": trade.rows.index(trade.reference) if trade.reference in trade.rows else None,
        "reference_method": trade.reference.method,
        "reference_error": trade.reference.estimate,
        **_rows_document(trade, lines, wording),
    }


def _head_document(trade: Trade[R]) -> dict[str, Any]:
    return {
        "accuracy": trade.accuracy,
        "machine": asdict(trade.machine),
        "repeats": trade.repeats,
        "budget": trade.budget,
    }


def _rows_document(trade: Trade[R], rows: list[dict[str, Any]], wording: Wording) -> dict[str, Any]:
    return {
        "rows": rows,
        "skipped": [asdict(item) | {"why": Sentence(item.why).worded(wording)} for item in trade.skipped],
        "recommendations": [
            {
                "coarsest": advice.coarsest,
                "finest": advice.finest,
                "row": None if advice.row is None else trade.rows.index(advice.row),
                "sentence": advice.sentence,
            }
            for advice in trade.recommendations
        ],
    }


def _part_row_document(line: PartRow) -> dict[str, Any]:
    properties = line.properties
    return {
        "method": line.method,
        "mesh": line.mesh,
        "triangles": line.triangles,
        "simplification": None if line.simplification is None else asdict(line.simplification),
        "time": asdict(line.time),
        "error": None if line.error is None else _relative(line.error),
        "bound": _relative(line.bound),
        "reached": line.reached,
        "loses_smallest_moment": properties.loses_smallest_moment,
        "volume": properties.volume,
        "mass": properties.mass,
        "center_of_mass": properties.center_of_mass.tolist(),
        "inertia": properties.inertia.tolist(),
    }


def _relative(error: Relative) -> dict[str, float]:
    return {"volume": error.volume, "center_of_mass_over_size": error.center_of_mass, "inertia": error.inertia}


def _scene_row_document(line: SceneRow, doubt: float, *, on_front: bool) -> dict[str, Any]:
    return {
        "model": line.model,
        "method": line.method,
        "asked": list(line.asked),
        "planned": line.planned,
        "on_front": on_front,
        "time": asdict(line.time),
        "steps": line.steps,
        "error": line.error,
        "below_reference": line.error is not None and line.error < doubt,
        "estimate": line.estimate,
        "reached": line.reached,
    }


def trade_text(trade: PartTrade | SceneTrade, *, wording: Wording = str) -> str:
    """Return the trade as lines of text, at most 100 columns wide but for long paths."""
    blocks: list[Iterable[str]]
    if isinstance(trade, PartTrade):
        blocks = [_part_head(trade), _whole_table(trade), _simplified_table(trade), _part_closing(trade, wording)]
    else:
        blocks = [_scene_head(trade), _scene_table(trade), _scene_closing(trade, wording)]
    return "\n\n".join(text for block in blocks if (text := "\n".join(block)))


@dataclass(frozen=True)
class _Column(Generic[R]):
    """A column of a table: its head, its width, and what it says of a row."""

    head: str
    width: int
    cell: Callable[[R], str]


def _table(over: str, columns: Sequence[_Column[R]], rows: Iterable[R]) -> Iterator[str]:
    """Yield a line that stands over the heads, the heads, and a line for each row.

    The first column goes to the left, the others to the right. Where the first says again what it said in the line
    above, it is left empty.
    """
    yield over
    yield _line(columns, [column.head for column in columns])
    above = ""
    for each in rows:
        name, *figures = (column.cell(each) for column in columns)
        yield _line(columns, ["" if name == above else name, *figures])
        above = name


def _line(columns: Sequence[_Column[R]], cells: Sequence[str]) -> str:
    width = columns[0].width
    name = cells[0] if len(cells[0]) < width else f"{cells[0][: width - 2]}…"
    figures = (f"{cell:>{column.width}}" for column, cell in zip(columns[1:], cells[1:], strict=True))
    return f"{name:<{width}}{''.join(figures)}".rstrip()


def _part_head(trade: PartTrade) -> Iterator[str]:
    analysis, part = trade.analysis, trade.analysis.part
    bodies = f"{analysis.bodies} {'body' if analysis.bodies == 1 else 'bodies'}"
    yield row("Part", f"{part.name} ({part.source.format}), {analysis.triangles} triangles, {bodies}")
    yield row("Unit", f"{part.unit.name} ({_ORIGINS[part.unit_from]})")
    density, mass = number(analysis.density), number(analysis.properties.mass)
    yield row("Density", f"{density} kg/m³ ({_ORIGINS[analysis.density_from]}), for a mass of {mass} kg")
    yield from _machine(trade)
    yield from _paragraph(
        "Time", "wall time of the integration alone, median of the runs; first use (compiling, loading) is not counted"
    )
    steps = ", ".join(f"{_STEPS[name]} {duration(timing.median)}" for name, timing in trade.steps.items())
    yield from _paragraph("Besides", steps)


def _scene_head(trade: SceneTrade) -> Iterator[str]:
    run = trade.scene.run
    turned = float(np.linalg.norm(trade.scene.angular_velocity)) * run.duration
    yield row("Scene", f"{trade.scene.name}, {run.duration:g} s, {run.samples} samples")
    yield from _paragraph("Start", f"the spin at the start would turn the body by {turned:.4g} rad in this time")
    yield from _machine(trade)
    yield from _paragraph("Time", "CPU time of the whole simulation with the estimate of its error, median of the runs")
    best = trade.reference
    whose = f" for {best.asked[0]:g} rad, which its own estimate" if best.asked else ", which a second run of it"
    whose = whose if best.steps else ", which its bound"
    yield from _paragraph("Reference", f"{best.model}, {best.method}{whose} puts within {best.estimate:.2g} rad")


def _machine(trade: Trade[R]) -> Iterator[str]:
    return _paragraph("Machine", f"{trade.machine}; the times are of this machine")


def _part_table(title: str, names: Sequence[_Column[PartRow]], rows: list[PartRow], over: str) -> Iterator[str]:
    """Yield the lines of a table with some columns that name a row, 36 wide, and those of its time and errors."""
    columns = [
        *names,
        _Column("median", 9, lambda line: _milliseconds(line.time.median)),
        _Column("range", 13, lambda line: "–".join(map(_milliseconds, (line.time.fastest, line.time.slowest)))),
        _Column("runs", 5, lambda line: f"{line.time.runs}"),
        _Column("volume", 9, lambda line: _error(None if line.error is None else line.error.volume)),
        _Column("COM/size", 9, lambda line: _error(None if line.error is None else line.error.center_of_mass)),
        _Column("tensor", 9, lambda line: _error(None if line.error is None else line.error.inertia)),
        _Column("bound", 10, lambda line: _error(line.bound.worst)),
    ]
    return _table(f"{title:<36}{'time, ms':>15}{'':>12}{over}", columns, rows)


def _whole_table(trade: PartTrade) -> Iterator[str]:
    over = f"{f'error against {trade.reference.method}':^27}{'certified':>10}"
    rows = [line for line in trade.rows if line.simplification is None]
    return _part_table("Whole mesh", [_Column("Method", 36, lambda line: line.method)], rows, over)


def _simplified_table(trade: PartTrade) -> Iterator[str]:
    unit = trade.analysis.part.unit
    simpler = {line: line.simplification for line in trade.rows if line.simplification}
    names: list[_Column[PartRow]] = [
        _Column("Mesh", 9, lambda line: line.mesh),
        _Column("Triangles", 9, lambda line: f"{line.triangles}"),
        _Column(f"Tol., {unit.name}", 9, lambda line: f"{simpler[line].tolerance / float(unit.metres):.2g}"),
        _Column("Made in", 9, lambda line: duration(simpler[line].seconds)),
    ]
    over = f"{'error by simplifying':^27}{'arithmetic':>10}"
    return _part_table("Simplified meshes, float64", names, list(simpler), over) if simpler else iter(())


def _scene_table(trade: SceneTrade) -> Iterator[str]:
    best = front(trade.rows)

    def accuracy(line: SceneRow) -> str:
        return "" if len(line.asked) > 1 and not line.steps else f"{line.asked[-1]:g}"

    def error(line: SceneRow) -> str:
        if line.error is None:
            return "–"
        doubt = trade.reference.estimate
        return f"{line.error:.1e}" if line.error >= doubt else f"<{doubt:.1e}"

    columns: list[_Column[SceneRow]] = [
        _Column("Method", 39, lambda line: line.method),
        _Column("rad", 7, accuracy),
        _Column("ms", 9, lambda line: _milliseconds(line.time.median)),
        _Column("runs", 5, lambda line: f"{line.time.runs}"),
        _Column("steps", 9, lambda line: f"{line.steps}"),
        _Column("rad", 9, error),
        _Column("estimate", 9, lambda line: f"{line.estimate:.1e}"),
        _Column("", 7, lambda line: "front" if line in best else ""),
        _Column("", 6, lambda line: "plan" if line.planned else ""),
    ]
    return _table(f"{'asked,':>46}{'CPU,':>9}{'error,':>23}{'own':>9}", columns, trade.rows)


def _recommended(trade: Trade[R]) -> Iterator[str]:
    for k, advice in enumerate(trade.recommendations):
        yield from _paragraph("" if k else "Recommended", advice.sentence)


def _part_closing(trade: PartTrade, wording: Wording) -> Iterator[str]:
    yield from _recommended(trade)
    for item in trade.skipped:
        estimate = (
            "" if item.seconds is None else f" (about {duration(item.seconds)}): give a larger {wording(_BUDGET)}"
        )
        yield from _paragraph("Skipped", f"{item.what}: {Sentence(item.why).worded(wording)}{estimate}")
    whole = [line for line in trade.rows if line.simplification is None]
    if losing := [line.method for line in whole if line.properties.loses_smallest_moment]:
        verb = "leaves" if len(losing) == 1 else "leave"
        yield from _paragraph(
            "Slender",
            f"{' and '.join(losing)} {verb} the smallest principal moment uncertain by more than a part in 10⁹: such "
            "rows are recommended only where no other one reaches the accuracy",
        )
    for note in trade.analysis.notes:
        yield from _paragraph("Note", note)
    yield from _paragraph(
        "Errors",
        "over the whole mesh they are those of the arithmetic, over a simplified one those of its geometry; how far "
        "the mesh lies from the shape that was meshed, its tessellation, is in neither",
    )


def _scene_closing(trade: SceneTrade, wording: Wording) -> Iterator[str]:
    yield from _paragraph(
        "Marks", "front: no other row is as fast and as accurate; plan: what the planner selects for this accuracy"
    )
    yield from _recommended(trade)
    late = [f"{item.what} ({duration(item.seconds)})" for item in trade.skipped if item.seconds is not None]
    if late:
        yield from _paragraph("Skipped", f"give a larger {wording(_BUDGET)} for {', '.join(late)}")
    reasons = dict.fromkeys(item.why for item in trade.skipped if item.seconds is None)
    for why in reasons:
        what = "; ".join(item.what for item in trade.skipped if item.why == why)
        yield from _paragraph("Left out", f"{what}: {why}")


def _paragraph(label: str, text: str) -> Iterator[str]:
    """Yield the lines of a labelled text; a time stays together with its unit."""
    tied = re.sub(r"(\d) (ms|s)\b", "\\1\N{NO-BREAK SPACE}\\2", text)
    for k, line in enumerate(textwrap.wrap(tied, _WIDTH - LABEL, break_long_words=False, break_on_hyphens=False)):
        yield row("" if k else label, line.replace("\N{NO-BREAK SPACE}", " "))


def _milliseconds(seconds: float) -> str:
    """Return a time in ms, to three digits."""
    value = 1e3 * seconds
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def _error(value: float | None) -> str:
    return "–" if value is None else f"{value:.1e}" if value else "0"
