"""Measurements → the text of docs/benchmarks.md."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import median
from typing import Any

TEXT = """# Benchmarks

`inertia` beside libigl, VTK, trimesh and MuJoCo, all measured in one run by

```
{command}
```

(after `pip install -e .[benchmark]`). The runs, best and others, are in [benchmarks.json](benchmarks.json).

{machine}

The meshes are wavy tori without any symmetry, closed, one body, written triangle by triangle and row by row. Every
figure is the best of several runs, in which the programs took turns; a figure in brackets is a multiple of the first
row's. Read the ratios: they carry over to another machine, the times do not.

## Against the targets

{targets}

## Integrating arrays in memory

Nanoseconds of CPU time a triangle, on one core, with the arrays that the library asks for ready made.

{kernel}

They do not all compute the same:

| | volume | area | centre of mass | tensor | error bound | besides |
|---|---|---|---|---|---|---|
| inertia | yes | yes | yes | yes | yes | extents |
| libigl `moments` | yes | – | yes | yes | – | |
| `vtkMassProperties` | yes | yes | – | – | – | a shape index |
| `vtkMultiObjectMassProperties` | yes | yes | yes | – | – | bodies, closedness |
| trimesh `mass_properties` | yes | – | yes | yes | – | |
| MuJoCo, compiling a model, `inertia="exact"` | yes | – | yes | yes | – | normals, a bounding volume tree |

At 20 k triangles the constant part of a call shows: for `inertia` it is the choice of a local origin, and the moments
and their bounds in rational arithmetic. The numpy row is `INERTIA_NATIVE=0`; its answers have the same bits.

## From a file to the answer

A fresh process that starts Python, reads a binary STL file from the page cache, checks that it is closed and
integrates it. The triangles come row by row; “in two sweeps”, the first of every two before the second ones;
“shuffled”, in random order; “in bodies”, as many bodies of 224 triangles, whose boxes do not meet. libigl welds the
vertices and looks for a boundary (`remove_duplicate_vertices`, `boundary_facets`, `moments`); VTK welds, looks for
boundary and non-manifold edges, and gives volume and area only; trimesh welds and must call the mesh a volume; MuJoCo
does not check closedness and refuses files of more than 200 000 triangles. Only `inertia` counts bodies and bounds its
error.

CPU time, user and system, in seconds:

{cpu}

Wall time in seconds (some of the libraries use both cores while they start):

{wall}

Peak resident memory in MB; in brackets a multiple of the file's size:

{peak}

All programs agree on the volume to {agreement:.0e}.

## Starting up

CPU seconds, ten runs in turn.

{startup}
"""


def text(document: dict[str, Any]) -> str:
    """Return the document's tables in Markdown."""
    machine = document["machine"]
    versions = ", ".join(f"{name} {version}" for name, version in document["versions"].items())
    differences = [
        row["volume_differs"]
        for file in document["files"].values()
        for row in file["programs"].values()
        if isinstance(row, dict)
    ]
    return TEXT.format(
        command=document["command"],
        machine=f"Machine: {machine['cpu']}, {machine['cores']} cores, {machine['system']}. Versions: {versions}.",
        targets=_targets(document),
        kernel=_kernel(document["kernel"]),
        cpu=_files(document["files"], "cpu", _seconds),
        wall=_files(document["files"], "wall", _seconds),
        peak=_files(document["files"], "peak", lambda mb: f"{mb:.0f}", of_file=True),
        agreement=max(differences, default=0.0),
        startup=_startup(document["startup"]),
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _ratio(value: float) -> str:
    return f"{value:.0f}×" if value >= 9.95 else f"{value:.1f}×" if value >= 0.995 else f"{value:.2f}×"


def _seconds(value: float) -> str:
    return f"{value:.2f}" if value < 9.95 else f"{value:.0f}"


def _kernel(sizes: dict[str, Any]) -> str:
    columns = [size["ns"] for size in sizes.values()]
    ours = next(iter(columns[0]))
    rows = []
    for name in columns[0]:
        cells = []
        for column in columns:
            if name not in column:
                cells.append("not run")
                continue
            best = min(column[name])
            ratio = "" if name == ours else f" ({_ratio(best / min(column[ours]))})"
            cells.append(f"{best:.1f}{ratio}" if best < 99.5 else f"{best:.0f}{ratio}")
        rows.append([name, *cells])
    return _table(["", *(f"{int(size['triangles']):,}" for size in sizes.values())], rows)


def _files(files: dict[str, Any], what: str, show: Callable[[float], str], *, of_file: bool = False) -> str:
    names = list(next(iter(files.values()))["programs"])
    rows = []
    for name in names:
        cells = []
        for file in files.values():
            row = file["programs"][name]
            if isinstance(row, str):
                cells.append(row)
                continue
            best = min(row[what])
            unit = file["file_mb"] if of_file else min(file["programs"][names[0]][what])
            ratio = "" if name == names[0] and not of_file else f" ({_ratio(best / unit)})"
            cells.append(f"{show(best)}{ratio}")
        rows.append([name, *cells])
    return _table(["", *(f"{label}, {file['file_mb']:.0f} MB" for label, file in files.items())], rows)


def _startup(commands: dict[str, list[float]]) -> str:
    return _table(["", "best", "median"], [[name, f"{min(s):.3f}", f"{median(s):.3f}"] for name, s in commands.items()])


def _targets(document: dict[str, Any]) -> str:
    """Compare with what the tool is meant to reach, at the sizes for which that is stated."""
    rows: list[list[str]] = []
    for count in ("1300000", "10000000"):
        if (size := document["kernel"].get(count)) is None:
            continue
        best = {name: min(runs) for name, runs in size["ns"].items()}
        ours = next(iter(best.values()))
        for peer, least in (("libigl", 2), ("trimesh", 100)):
            rows.append(_row(f"kernel, {int(count):,}: {peer} ÷ inertia", best[peer] / ours, least))
    for label, least in (("1,300,000", 10), ("10,000,000", 20)):
        if (file := document["files"].get(label)) is None:
            continue
        programs = list(file["programs"].values())
        first, trimesh = programs[0], file["programs"]["trimesh"]
        if isinstance(trimesh, dict):
            rows.append(_row(f"file, {label}: CPU, trimesh ÷ inertia", min(trimesh["cpu"]) / min(first["cpu"]), least))
        rows.append(_row(f"file, {label}: peak memory ÷ file", min(first["peak"]) / file["file_mb"], 1.5, above=False))
    for name, most in (("`inertia --help`", 0.15), ("`inertia analyse t_handle.stl`", 0.5)):
        rows.append(_row(f"{name}, CPU s", min(document["startup"][name]), most, above=False))
    return _table(["", "target", "measured", ""], rows)


def _row(name: str, value: float, target: float, *, above: bool = True) -> list[str]:
    reached = value >= target if above else value < target
    return [name, f"{'≥' if above else '<'} {target:g}", f"{value:.3g}", "reached" if reached else "missed"]
