"""`Trade` → a work-precision diagram of a part or a scene, SVG or PNG, by matplotlib."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.palette import BLUE, GREEN, ORANGE, PINK, SKY, VERMILLION
from inertia.plotting import write_figure
from inertia.work_precision.rows import PartRow, SceneRow, front
from inertia.work_precision.trade import PartTrade, SceneTrade

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WHOLE, _SIMPLER, _ASKED = BLUE, VERMILLION, "#666666"
_COLOURS = (
    BLUE,
    VERMILLION,
    GREEN,
    PINK,
    ORANGE,
    SKY,
    "#000000",
    "#999933",
    "#882255",
    "#888888",
)
_MARKS = "osD^v<>PX*"
_NOTHING = 1e-18  # where an error of 0 of a part is drawn
_LEAST, _MOST = 1e-17, 3.2  # rad, between which errors of a scene are drawn
_MS = 1e3
_NEAR = 1.5  # ratio of times within which two names would overlap


def plot(trade: PartTrade | SceneTrade, file: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write the diagram of a trade to a file, SVG or PNG by its name; raises as `require_plottable` does."""
    write_figure(lambda: _figure(trade), file, force=force)


def _figure(trade: PartTrade | SceneTrade) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 5.4), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    axes.set_xscale("log")
    axes.set_yscale("log")
    if isinstance(trade, PartTrade):
        _draw_part(axes, trade)
        name, size = trade.analysis.part.name, f"{trade.analysis.triangles} triangles"
        error, time = "relative error, the worst of volume, centre of mass and tensor", "time of the integration, ms"
        figures, legend = "medians, and the range of the runs", {"ncols": 2, "fontsize": 9}
    else:
        _draw_scene(axes, trade)
        name, run = trade.scene.name, trade.scene.run
        size = f"{run.duration:g} s, {run.samples} samples"
        error, time = "attitude error, rad, the largest of the samples", "CPU time of the simulation, ms"
        figures, legend = "medians", {"ncols": 3, "fontsize": 8}
    axes.yaxis.set_major_formatter(lambda time, _: f"{time:g}")
    axes.grid(alpha=0.3)
    axes.set_xlabel(f"{error} (more accurate to the right)")
    axes.set_ylabel(time)
    axes.set_title(f"{Path(name).name}, {size}", loc="left", fontsize=12, pad=20, parse_math=False)
    machine = f"{trade.machine}; {figures}"
    axes.annotate(machine, (0, 1), (0, 6), "axes fraction", "offset points", fontsize=7, color=_ASKED, parse_math=False)
    figure.legend(loc="outside lower center", **legend)
    return figure


def _draw_part(axes: Axes, trade: PartTrade) -> None:
    whole = [row for row in trade.rows if row.simplification is None]
    simpler = [row for row in trade.rows if row.simplification is not None]
    _draw_bounds(axes, whole)
    _draw_errors(axes, whole, "whole mesh, error of the arithmetic", color=_WHOLE, marker="o", linestyle="none")
    _draw_errors(
        axes, simpler, "simplified mesh, float64, error by simplifying", color=_SIMPLER, marker="s", linestyle=":"
    )
    for row in simpler:
        _name(axes, row.mesh, (_place(row), _MS * row.time.fastest), (0, -8), ha="center", va="top", rotation=90)
    if trade.accuracy is not None:
        _draw_wanted(axes, trade)
    _set_limits(axes, trade.rows)


def _draw_scene(axes: Axes, trade: SceneTrade) -> None:
    by_method = sorted(trade.rows, key=lambda row: row.method)
    for k, (method, rows) in enumerate(groupby(by_method, key=lambda row: row.method)):
        color, marker = _COLOURS[k % len(_COLOURS)], _MARKS[k % len(_MARKS)]
        line = sorted(rows, key=lambda row: -row.asked[0])
        axes.plot(*_places(line), markersize=5, linewidth=1, label=method, color=color, marker=marker)
    axes.plot(*_places(front(trade.rows)), color="#bbbbbb", linewidth=5, zorder=0, label="front")
    planned = [row for row in trade.rows if row.planned]
    axes.scatter(*_places(planned), s=150, facecolors="none", edgecolors=_ASKED, label="what the planner selects")
    if isinstance(trade.accuracy, float):
        axes.axvline(trade.accuracy, color=_ASKED, linewidth=1, linestyle="--", label="accuracy asked for")
    axes.invert_xaxis()


def _places(rows: Sequence[SceneRow]) -> tuple[list[float], list[float]]:
    """Return where rows are drawn: what they reach in rad, and ms."""
    return [min(max(row.reached, _LEAST), _MOST) for row in rows], [_MS * row.time.median for row in rows]


def _set_limits(axes: Axes, rows: Sequence[PartRow]) -> None:
    """Let errors run from 1 on and times between powers of ten, with room for names at the left of and below a row."""
    places = [place for row in rows for place in (row.bound.worst, _place(row))]
    times = [_MS * time for row in rows for time in (row.time.fastest, row.time.slowest)]
    axes.set_xlim(max(1.0, 3 * max(places)), min(1e-17, min(places) / 3))
    axes.set_ylim(_power_below(min(times) / 3), 1 / _power_below(0.8 / max(times)))


def _power_below(value: float) -> float:
    return float(10.0 ** math.floor(math.log10(value)))


def _draw_wanted(axes: Axes, trade: PartTrade) -> None:
    if isinstance(trade.accuracy, float):
        axes.axvline(
            trade.accuracy, color=_ASKED, linewidth=1, linestyle="--", label=f"accuracy asked for, {trade.accuracy:g}"
        )
    row = trade.recommendations[0].row
    if row is not None:
        at = row.reached, _MS * row.time.median
        axes.scatter(*at, s=170, facecolors="none", edgecolors=_ASKED, zorder=3, label="recommended")


def _draw_bounds(axes: Axes, rows: list[PartRow]) -> None:
    bounds, times = [row.bound.worst for row in rows], [_MS * row.time.median for row in rows]
    for row, bound, time in zip(rows, bounds, times, strict=True):
        axes.plot([bound, _place(row)], [time, time], color=_WHOLE, linewidth=1, zorder=1)
        slower = any(time < other <= _NEAR * time for other in times)
        faster = any(other < time <= _NEAR * other for other in times)
        level = "center" if slower == faster else "top" if slower else "bottom"
        _name(axes, row.method, (bound, time), (-10, 0), ha="right", va=level)
    axes.plot(bounds, times, "o", color=_WHOLE, markerfacecolor="white", label="whole mesh, certified bound")


def _draw_errors(axes: Axes, rows: list[PartRow], label: str, **how: Any) -> None:
    if not rows:
        return
    places, times = [_place(row) for row in rows], [_MS * row.time.median for row in rows]
    below = [_MS * (row.time.median - row.time.fastest) for row in rows]
    above = [_MS * (row.time.slowest - row.time.median) for row in rows]
    axes.errorbar(places, times, [below, above], linewidth=0.8, elinewidth=1, markersize=5, label=label, **how)


def _name(axes: Axes, text: str, at: tuple[float, float], offset: tuple[int, int], **how: Any) -> None:
    axes.annotate(text, at, offset, textcoords="offset points", fontsize=8, **how)


def _place(row: PartRow) -> float:
    """Return where the error of a row is drawn: its bound where it has none, a small number where it is 0."""
    error = row.bound if row.error is None else row.error
    return max(error.worst, _NOTHING)
