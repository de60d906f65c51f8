"""Stored measurements → docs/benchmarks-*.svg, in colours that show on light and on dark ground.

A program: ``python -m tests.benchmarks.pictures FOLDER`` draws what FOLDER/benchmarks.json holds.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from inertia.palette import BLUE, GREEN, GREY, PLUM, VERMILLION, VIOLET

INK = "#7A7A7A"
"""Of text and axes: as far from white as from a dark page."""
COLORS = {"inertia": VERMILLION, "libigl": BLUE, "VTK": GREEN, "trimesh": VIOLET, "MuJoCo": PLUM}
SETTINGS = {
    "svg.fonttype": "none",
    "svg.hashsalt": "inertia",
    "font.size": 10.0,
    "font.sans-serif": ["DejaVu Sans", "Verdana", "sans-serif"],
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
} | dict.fromkeys(
    ("text.color", "axes.labelcolor", "axes.edgecolor", "axes.titlecolor", "xtick.color", "ytick.color", "grid.color"),
    INK,
)
ORDERS = {"": "row by row", " in two sweeps": "in two sweeps", " shuffled": "shuffled", " in bodies": "in bodies"}
PEERS = {"inertia": "inertia, Python"} | {name: name for name in ("libigl", "VTK", "trimesh", "MuJoCo")}
WAYS = {
    "`inertia.many`": ("inertia.many", "inertia", "-"),
    "`inertia.mass_properties`": ("inertia.mass_properties", "inertia", "--"),
    "`inertia.analyse`": ("inertia.analyse", "inertia", ":"),
    "trimesh, sums alone": ("trimesh, sums alone", "trimesh", "-"),
    "trimesh, closed and wound": ("trimesh, closed and wound", "trimesh", "--"),
}
KERNELS = {
    "inertia, vertices and faces": ("inertia", "inertia", "-"),
    "inertia, sums alone": ("inertia, sums alone", "inertia", "--"),
    "libigl": ("libigl", "libigl", "-"),
    "VTK, `vtkMassProperties`": ("VTK", "VTK", "-"),
    "VTK, `vtkMultiObjectMassProperties`": ("VTK, by bodies", "VTK", "--"),
    "trimesh": ("trimesh", "trimesh", "-"),
    "MuJoCo": ("MuJoCo", "MuJoCo", "-"),
}
Point = tuple[float, float]


def draw(document: dict[str, Any], into: Path) -> None:
    """Draw what the document has figures for."""
    sizes = (label for label in document.get("files", {}) if " " not in label)
    files = {label: document["files"][label] for label in sorted(sizes, key=lambda size: int(size.replace(",", "")))}
    pictures: dict[str, tuple[Callable[[Any], Figure], Any]] = {
        "time": (_times, files),
        "kernel": (_kernel, document.get("kernel")),
        "small": (_small, document.get("small")),
        "order": (_orders, document.get("files")),
        "memory": (_memory, files),
        "accuracy": (_accuracy, document.get("accuracy")),
    }
    with rc_context(SETTINGS):
        for name, (picture, data) in pictures.items():
            if data:
                file = into / f"benchmarks-{name}.svg"
                picture(data).savefig(file, format="svg", transparent=True, metadata={"Date": None})
                lines = (line.rstrip() for line in file.read_text(encoding="utf-8").splitlines())
                file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def color(name: str) -> str:
    """Return the colour of a program, by the beginning of its name."""
    return next((value for peer, value in COLORS.items() if name.startswith(peer)), GREY)


def _panel(figure: Figure, *place: Any, title: str = "", xlabel: str = "", ylabel: str = "") -> Axes:
    axes = figure.add_subplot(*place)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_title(title, loc="left", fontsize=10.5)
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.grid(alpha=0.25, linewidth=0.6)
    return axes


def _short(value: float, _: object = None) -> str:
    if value >= 1e6:
        return f"{value / 1e6:g} M"
    return f"{value / 1e3:g} k" if value >= 1e4 else f"{value:,.0f}" if value >= 1 else f"{value:g}"


def _plain(axes: Axes, right: float) -> None:
    """Label the axes with plain numbers, and leave room for labels on the right."""
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        axis.set_major_locator(LogLocator(10, (1.0,) if high > 300 * low else (1.0, 2.0, 5.0), numticks=12))
        axis.set_major_formatter(FuncFormatter(_short))
        axis.set_minor_formatter(NullFormatter())
    axes.set_xlim(right=right)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.04)


def _lines(axes: Axes, lines: Sequence[tuple[str, str, str, Sequence[Point]]], above: float = 24.0) -> None:
    """Draw (label, program, style, points) with each label at the end of its line, none upon another.

    A point by itself has its label so far `above` it that no curve beside it passes through.
    """
    lines = [line for line in lines if line[3]]
    for _, name, style, points in lines:
        width = 2.6 if name == "inertia" and style == "-" else 1.5
        axes.plot(*zip(*points, strict=True), style, marker="o", markersize=4, linewidth=width, color=color(name))
    values = [y for line in lines for _, y in line[3]]
    low, high = math.log10(min(values)), math.log10(max(values))
    end = max(line[3][-1][0] for line in lines)
    last, gap = -math.inf, 0.062 * (high - low)
    for label, name, _, points in sorted(lines, key=lambda line: line[3][-1][1]):
        x, y = points[-1]
        shift, where = (7.0, 0.0), {"va": "center"}
        if x < end:
            shift, where = (0.0, 6.0 if len(points) > 1 else above), {"va": "bottom"}
        else:
            last = max(math.log10(y), last + gap)
            y = 10**last
        weight = "bold" if label.startswith("inertia") else "normal"
        axes.annotate(label, (x, y), shift, textcoords="offset points", color=color(name), fontweight=weight, **where)


def _of(files: dict[str, Any], name: str, what: str, *, sized: bool = False) -> list[Point]:
    return [
        (file["file_mb"] if sized else float(label.replace(",", "")), min(file["programs"][name][what]))
        for label, file in files.items()
        if isinstance(file["programs"].get(name), dict)
    ]


def _times(files: dict[str, Any]) -> Figure:
    figure = Figure(figsize=(9.2, 4.4), layout="constrained")
    for place, (what, title) in enumerate({"wall": "seconds one waits", "cpu": "seconds of CPU"}.items(), 1):
        axes = _panel(figure, 1, 2, place, title=title, xlabel="triangles in the file")
        _lines(axes, [(peer, peer, "-", _of(files, name, what)) for peer, name in PEERS.items()])
        _plain(axes, 7e7)
    return figure


def _memory(files: dict[str, Any]) -> Figure:
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = _panel(figure, 1, 1, 1, title="peak memory, MB", xlabel="size of the file, MB")
    _lines(axes, [(peer, peer, "-", _of(files, name, "peak", sized=True)) for peer, name in PEERS.items()], 46.0)
    sizes = [file["file_mb"] for file in files.values()]
    axes.plot(ends := [max(min(sizes), 50), max(sizes)], ends, ":", color=INK)
    axes.annotate("the file", (ends[1], ends[1]), (7, 0), textcoords="offset points", va="center")
    _plain(axes, 3000)
    return figure


def _kernel(sizes: dict[str, Any]) -> Figure:
    figure = Figure(figsize=(7.6, 4.6), layout="constrained")
    axes = _panel(figure, 1, 1, 1, title="nanoseconds of CPU a triangle, arrays in memory", xlabel="triangles")
    lines = [
        (label, name, style, [(s["triangles"], min(s["ns"][key])) for s in sizes.values() if key in s["ns"]])
        for key, (label, name, style) in KERNELS.items()
    ]
    _lines(axes, lines)
    _plain(axes, 1.2e8)
    return figure


def _small(sizes: dict[str, Any]) -> Figure:
    figure = Figure(figsize=(7.6, 4.2), layout="constrained")
    axes = _panel(figure, 1, 1, 1, title="microseconds of CPU a mesh, in memory", xlabel="triangles of a mesh")
    lines = [
        (label, name, style, [(float(count), row[key]) for count, row in sizes.items()])
        for key, (label, name, style) in WAYS.items()
    ]
    _lines(axes, lines)
    _plain(axes, 5e3)
    return figure


def _seconds(run: Any) -> float:
    """Return the seconds of a program, or 0 where it has none."""
    return min(run["cpu"]) if isinstance(run, dict) else 0.0


def _orders(files: dict[str, Any]) -> Figure:
    sizes = [label for label in files if f"{label} shuffled" in files and label != "320,000"]
    figure = Figure(figsize=(9.2, 1.0 + 2.2 * ((len(sizes) + 1) // 2)), layout="constrained")
    for place, size in enumerate(sizes, 1):
        axes = figure.add_subplot((len(sizes) + 1) // 2, 2, place)
        axes.set_xscale("log")
        axes.set_title(f"{size} triangles", loc="left", fontsize=10.5)
        axes.set_yticks(range(len(ORDERS)), list(ORDERS.values()))
        axes.set_ylim(len(ORDERS) - 0.4, -1.1)
        axes.grid(axis="x", alpha=0.25, linewidth=0.6)
        beside = 0.0
        for peer, name in sorted(PEERS.items(), key=lambda each: _seconds(files[size]["programs"].get(each[1]))):
            points = [
                (min(files[size + order]["programs"][name]["cpu"]), row)
                for row, order in enumerate(ORDERS)
                if isinstance(run := files.get(size + order, {}).get("programs", {}).get(name), dict)
                and not run.get("busy")
            ]
            if points:
                axes.plot(*zip(*points, strict=True), "o-", color=color(name), linewidth=1.0, markersize=6)
                shift = 19 if points[0][0] < 2.2 * beside else 8
                beside = points[0][0] if shift == 8 else 0.0
                axes.annotate(peer, points[0], (0, shift), textcoords="offset points", ha="center", color=color(name))
        low, high = axes.get_xlim()
        axes.set_xlim(low * 0.8, high * 1.25)
        axes.xaxis.set_major_locator(LogLocator(10, (1.0, 2.0, 5.0), numticks=12))
        axes.xaxis.set_major_formatter(FuncFormatter(_short))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel("seconds of CPU, file to answer")
    return figure


def _accuracy(cases: dict[str, Any]) -> Figure:
    figure = Figure(figsize=(10.2, 4.4), layout="constrained")
    first = None
    for place, (case, programs) in enumerate(cases.items(), 1):
        axes = _panel(figure, 1, len(cases), place, title=case, xlabel="ns of CPU a triangle")
        rungs = [row for name, row in programs.items() if name.startswith("inertia")]
        for row in rungs:
            axes.plot([row["ns"]] * 2, [row["error"], row["bound"]], color=VERMILLION, linewidth=1.2)
            axes.plot(row["ns"], row["bound"], "_", color=VERMILLION, markersize=9)
        points = [(row["ns"], row["error"]) for row in rungs]
        axes.plot(*zip(*points, strict=True), "o-", color=VERMILLION, markersize=5, linewidth=0.8)
        axes.annotate("inertia", points[0], (0, -14), textcoords="offset points", color=VERMILLION, fontweight="bold")
        for name, row in programs.items():
            if isinstance(row, dict) and not name.startswith("inertia"):
                axes.plot(row["ns"], row["error"], "o", color=color(name), markersize=5)
                axes.annotate(
                    name, (row["ns"], row["error"]), (0, 7), textcoords="offset points", ha="center", color=color(name)
                )
        _plain(axes, 4000)
        axes.xaxis.set_major_locator(LogLocator(10))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0e}".replace("e-0", "e-")))
        axes.set_ylim(5e-19, 1e5)
        axes.set_xlim(left=6)
        if first is None:
            axes.set_ylabel("true relative error of the tensor")
            first = axes
        else:
            axes.tick_params(labelleft=False)
    return figure


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    draw(json.loads((folder / "benchmarks.json").read_text(encoding="utf-8")), folder)
