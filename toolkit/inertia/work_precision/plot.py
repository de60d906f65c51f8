"""`Trade` → a work-precision diagram, SVG or PNG, by matplotlib."""

from __future__ import annotations

import io
import math
import os
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inertia.errors import UsageError
from inertia.output import require_writable, write_whole
from inertia.work_precision.rows import Row
from inertia.work_precision.trade import Trade

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_FORMATS = (".svg", ".png")
_WHOLE, _SIMPLER, _ASKED = "#0072B2", "#D55E00", "#666666"  # Okabe and Ito: told apart by the colour-blind
_NOTHING = 1e-18  # where an error of 0 is drawn
_MS = 1e3
_NEAR = 1.5  # ratio of times within which two names would overlap


def require_plottable(file: str | os.PathLike[str], *, force: bool = False) -> Path:
    """Return the path of a plot that can be written: to be asked before the measuring, which takes a while.

    Raises
    ------
    UsageError : the name ends neither in .svg nor .png, the file exists and `force` is not set, or matplotlib is not
        installed
    InertiaError : its folder cannot be written to
    """
    path = Path(file)
    if path.suffix.lower() not in _FORMATS:
        raise UsageError(f"cannot plot to {path}: its name must end in {' or '.join(_FORMATS)}")
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise UsageError("plotting needs matplotlib: install it by pip install 'inertia[plot]'") from None
    return require_writable(path, force=force)


def plot(trade: Trade, file: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write the diagram of a trade to a file, SVG or PNG by its name; raises as `require_plottable`."""
    draw(lambda: _figure(trade), require_plottable(file, force=force))


def draw(make: Callable[[], Figure], path: Path) -> None:
    """Make a figure in the style of these diagrams, and write it."""
    import matplotlib as mpl

    style = mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "inertia", "font.size": 10.0})
    with style, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a name in a script that the font lacks
        _write(make(), path)


def _write(figure: Figure, path: Path) -> None:
    kind = path.suffix.lower()[1:]
    drawn = io.BytesIO()
    figure.savefig(drawn, format=kind, metadata={"Date": None} if kind == "svg" else None)
    write_whole(path, drawn.getvalue())


def _figure(trade: Trade) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 5.4), dpi=150, layout="constrained")
    axes = figure.add_subplot()
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
    _scale(axes, trade.rows)
    axes.grid(alpha=0.3)
    axes.set_xlabel("relative error, the worst of volume, centre of mass and tensor (more accurate to the right)")
    axes.set_ylabel("time of the integration, ms")
    name = Path(trade.analysis.part.name).name
    title = f"{name}, {trade.analysis.triangles} triangles"
    axes.set_title(title, loc="left", fontsize=12, pad=20, parse_math=False)
    machine = f"{trade.machine}; medians, and the range of the runs"
    axes.annotate(machine, (0, 1), (0, 6), "axes fraction", "offset points", fontsize=7, color=_ASKED, parse_math=False)
    figure.legend(loc="outside lower center", ncols=2, fontsize=9)
    return figure


def _scale(axes: Axes, rows: Sequence[Row]) -> None:
    """Set both axes to powers of ten, from an error of 1 on, with room for the names at the left of and below a row."""
    places = [place for row in rows for place in (row.bound.worst, _place(row))]
    times = [_MS * time for row in rows for time in (row.time.fastest, row.time.slowest)]
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(max(1.0, 3 * max(places)), min(1e-17, min(places) / 3))
    axes.set_ylim(_power_below(min(times) / 3), 1 / _power_below(0.8 / max(times)))
    axes.yaxis.set_major_formatter(lambda time, _: f"{time:g}")


def _power_below(value: float) -> float:
    return float(10.0 ** math.floor(math.log10(value)))


def _draw_wanted(axes: Axes, trade: Trade) -> None:
    if isinstance(trade.accuracy, float):
        axes.axvline(
            trade.accuracy, color=_ASKED, linewidth=1, linestyle="--", label=f"accuracy asked for, {trade.accuracy:g}"
        )
    row = trade.recommendations[0].row
    if row is not None:
        at = row.reached, _MS * row.time.median
        axes.scatter(*at, s=170, facecolors="none", edgecolors=_ASKED, zorder=3, label="recommended")


def _draw_bounds(axes: Axes, rows: list[Row]) -> None:
    bounds, times = [row.bound.worst for row in rows], [_MS * row.time.median for row in rows]
    for row, bound, time in zip(rows, bounds, times, strict=True):
        axes.plot([bound, _place(row)], [time, time], color=_WHOLE, linewidth=1, zorder=1)
        slower = any(time < other <= _NEAR * time for other in times)
        faster = any(other < time <= _NEAR * other for other in times)
        level = "center" if slower == faster else "top" if slower else "bottom"
        _name(axes, row.method, (bound, time), (-10, 0), ha="right", va=level)
    axes.plot(bounds, times, "o", color=_WHOLE, markerfacecolor="white", label="whole mesh, certified bound")


def _draw_errors(axes: Axes, rows: list[Row], label: str, **how: Any) -> None:
    if not rows:
        return
    places, times = [_place(row) for row in rows], [_MS * row.time.median for row in rows]
    below = [_MS * (row.time.median - row.time.fastest) for row in rows]
    above = [_MS * (row.time.slowest - row.time.median) for row in rows]
    axes.errorbar(places, times, [below, above], linewidth=0.8, elinewidth=1, markersize=5, label=label, **how)


def _name(axes: Axes, text: str, at: tuple[float, float], offset: tuple[int, int], **how: Any) -> None:
    axes.annotate(text, at, offset, textcoords="offset points", fontsize=8, **how)


def _place(row: Row) -> float:
    """Return where the error of a row is drawn: its bound where it has none, a small number where it is 0."""
    error = row.bound if row.error is None else row.error
    return max(error.worst, _NOTHING)
