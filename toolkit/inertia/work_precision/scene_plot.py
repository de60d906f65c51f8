"""`SceneTrade` → a work-precision diagram, SVG or PNG, by matplotlib."""

from __future__ import annotations

import os
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from inertia.work_precision.plot import draw, require_plottable
from inertia.work_precision.scene_rows import SceneRow, front
from inertia.work_precision.scenes import SceneTrade

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#000000",
    "#999933",
    "#882255",
    "#888888",
)
_MARKS = "osD^v<>PX*"
_MS = 1e3
_LEAST, _MOST = 1e-17, 3.2  # rad, between which errors are drawn


def plot_scene(trade: SceneTrade, file: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write the diagram of a scene's trade to a file, SVG or PNG by its name; raises as `plot.require_plottable`."""
    draw(lambda: _figure(trade), require_plottable(file, force=force))


def _figure(trade: SceneTrade) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 5.4), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    by_method = sorted(trade.rows, key=lambda row: row.method)
    for k, (method, rows) in enumerate(groupby(by_method, key=lambda row: row.method)):
        look = {"color": _COLOURS[k % len(_COLOURS)], "marker": _MARKS[k % len(_MARKS)]}
        line = sorted(rows, key=lambda row: -row.asked[0])
        axes.plot(*_places(line), markersize=5, linewidth=1, label=method, **look)  # type: ignore[arg-type]
    axes.plot(*_places(front(trade.rows)), color="#bbbbbb", linewidth=5, zorder=0, label="front")
    chosen = [row for row in trade.rows if row.planned]
    axes.scatter(*_places(chosen), s=150, facecolors="none", edgecolors="#666666", label="what the planner selects")
    if trade.accuracy is not None:
        axes.axvline(trade.accuracy, color="#666666", linewidth=1, linestyle="--", label="accuracy asked for")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.invert_xaxis()
    axes.yaxis.set_major_formatter(lambda time, _: f"{time:g}")
    axes.grid(alpha=0.3)
    axes.set_xlabel("attitude error, rad, the largest of the samples (more accurate to the right)")
    axes.set_ylabel("CPU time of the simulation, ms")
    run = trade.scene.run
    title = f"{Path(trade.scene.name).name}, {run.duration:g} s, {run.samples} samples"
    axes.set_title(title, loc="left", fontsize=12, pad=20, parse_math=False)
    machine = f"{trade.machine}; medians"
    axes.annotate(
        machine, (0, 1), (0, 6), "axes fraction", "offset points", fontsize=7, color="#666666", parse_math=False
    )
    figure.legend(loc="outside lower center", ncols=3, fontsize=8)
    return figure


def _places(rows: list[SceneRow]) -> tuple[list[float], list[float]]:
    """Return where rows are drawn: what they reach in rad, and ms."""
    return [min(max(row.reached, _LEAST), _MOST) for row in rows], [_MS * row.time.median for row in rows]
