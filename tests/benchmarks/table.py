"""Stored measurements → the text of docs/benchmarks.md.

A program: ``python -m tests.benchmarks.table FOLDER`` writes what FOLDER/benchmarks.json holds.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from .kernel import METHODS
from .whole import programs

OURS = "inertia, Python"

TEXT = """# Benchmarks

`inertia` beside libigl, VTK, trimesh and MuJoCo: from a file to the answer, integrating in memory, small parts, orders
of triangles, memory, and accuracy. A colour is one program throughout; axes are logarithmic.

## From a file to the answer

![Time against triangles: inertia below all others from 100,000 triangles on](benchmarks-time.svg)

A fresh process starts Python, reads a binary STL file of a wavy torus, checks that it is closed and integrates it.
Only `inertia` counts bodies and bounds its error, and up to 200,000 triangles it looks for crossings. Every program
runs with `OPENBLAS_THREAD_TIMEOUT=4`: otherwise each thread of numpy's BLAS spins for 0.1 s after its start. `inertia`,
the command, starts no such threads; set the variable yourself where a Python program of yours is short.

## Whatever the order of the triangles

![CPU time for triangles row by row, in two sweeps, shuffled, in many bodies](benchmarks-order.svg)

“In two sweeps”: the first of every two triangles before the second ones; “in bodies”: as many triangles in tori of 224
each, whose boxes do not meet.

## Memory

![Peak memory against the size of the file](benchmarks-memory.svg)

## Integrating arrays in memory

![Nanoseconds a triangle against triangles](benchmarks-kernel.svg)

The others state no bound. “Sums alone” has a wide one: it leaves out the digits beside float64 that bring the bounds of
`inertia` near its errors, and that take more time than the sums themselves.

## Small parts in memory

![Microseconds a mesh against its triangles](benchmarks-small.svg)

`inertia.many` and `mass_properties` check that a mesh is closed, wound alike, in one piece and free of crossings, and
bound the error; “sums alone” checks nothing.

## Speed against accuracy

![CPU time a triangle against true error, in three places](benchmarks-accuracy.svg)

One mesh of 320,356 triangles in three places, and the true error of the tensor, against rational arithmetic (of VTK,
which gives no more, that of the volume). `inertia` by its three methods, float64, double-double and exact integers; the
bar goes up to its bound.

## Against the targets

{targets}

## How it is measured

```
{command}
```

(after `pip install -e .[benchmark]`) measures everything anew, draws the pictures and writes this page. With `--part
kernel`, `--sizes 1300000`, `--orders shuffled` or `--programs trimesh` it measures a part, whose figures take the place
of those stored; with `--quick` it holds what README and docs state against this machine, in five minutes. The runs,
best and others, are in [benchmarks.json](benchmarks.json).

{machine}

The meshes are wavy tori without any symmetry, closed, one body, written triangle by triangle and row by row. Every
figure is the best of its runs, which are measured with nothing else running; a figure in brackets is a multiple of the
first row's. Read the ratios: they carry over to machines alike better than the times do. On a processor without
AVX-512 those to trimesh were 0.28 to 1.1 of these.

## The figures: from a file to the answer

The file is in the page cache. libigl welds the vertices and looks for a boundary (`remove_duplicate_vertices`,
`boundary_facets`, `moments`); VTK welds, looks for boundary and non-manifold edges, and gives volume and area only;
trimesh welds and must call the mesh a volume; MuJoCo does not check closedness and refuses files of more than 200 000
triangles.

CPU time, user and system, in seconds (†: while other programs ran):

{cpu}

Wall time in seconds (`inertia` integrates on both cores, and some of the libraries use both while they start):

{wall}

Peak resident memory in MB; in brackets a multiple of the file's size:

{peak}

All programs agree on the volume to {agreement:.0e}.

## The figures: integrating arrays in memory

Nanoseconds of CPU time a triangle, on one core, with the arrays that the library asks for ready made.

{kernel}

They do not all compute the same:

| | volume | area | centre of mass | tensor | error bound | besides |
|---|---|---|---|---|---|---|
| inertia | yes | yes | yes | yes | near the error | extents |
| inertia, sums alone | yes | yes | yes | yes | wide | extents |
| libigl `moments` | yes | – | yes | yes | – | |
| `vtkMassProperties` | yes | yes | – | – | – | a shape index |
| `vtkMultiObjectMassProperties` | yes | yes | yes | – | – | bodies, closedness |
| trimesh `mass_properties` | yes | – | yes | yes | – | |
| MuJoCo, compiling a model, `inertia="exact"` | yes | – | yes | yes | – | normals, a bounding volume tree |

Up to 1,024 triangles the sums are formed once more with twice the digits, above that with the digits that float64
loses. The numpy row is `INERTIA_NATIVE=0`; its answers have the same bits up to 1,024 triangles, and agree within
their bounds above that.

## The figures: small parts

Microseconds of CPU time a mesh; in brackets a multiple of the first row's.

{small}

## The figures: speed against accuracy

Nanoseconds of CPU time a triangle, and the relative error (“error ≤ bound”).

{accuracy}

## Starting up

CPU seconds, ten runs in turn.

{startup}
"""


def text(document: dict[str, Any]) -> str:
    """Return the document's tables in Markdown."""
    files = dict(sorted(document["files"].items(), key=_size_and_order))
    return TEXT.format(
        command="python -m tests.benchmarks",
        machine=_machines(document["machines"]),
        targets=_table(["", "target", "measured", ""], [_row(target) for target in targets(document)]),
        kernel=_kernel(document["kernel"]),
        cpu=_files(files, "cpu", _seconds),
        wall=_files(files, "wall", _seconds),
        peak=_files(files, "peak", lambda mb: f"{mb:.0f}", of_file=True),
        agreement=max(map(apart, files.values())),
        small=_small(document["small"]),
        accuracy=_accuracy(document["accuracy"]),
        startup=_startup(document["startup"]),
    )


def _machines(machines: dict[str, Any]) -> str:
    """Return what each part was measured on: a paragraph for all, or one for each machine and its parts."""
    parts: dict[str, list[str]] = {}
    for part, machine in machines.items():
        versions = ", ".join(f"{name} {version}" for name, version in machine["versions"].items())
        said = f"{machine['cpu']}, {machine['cores']} cores, {machine['system']}. Versions: {versions}."
        parts.setdefault(said, []).append(part)
    if len(parts) == 1:
        return f"Machine: {next(iter(parts))}"
    return "\n\n".join(f"Machine of the figures for {', '.join(each)}: {said}" for said, each in parts.items())


def _size_and_order(entry: tuple[str, Any]) -> tuple[int, int]:
    size, _, order = entry[0].partition(" ")
    return int(size.replace(",", "")), ("", "in two sweeps", "shuffled", "in bodies").index(order)


def apart(file: dict[str, Any]) -> float:
    """Return the largest relative distance of a volume from the first program's."""
    volumes = [row["volume"] for row in file["programs"].values() if isinstance(row, dict)]
    return max(abs(volume / volumes[0] - 1.0) for volume in volumes)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _ratio(value: float) -> str:
    return f"{value:.0f}×" if value >= 9.95 else f"{value:.1f}×" if value >= 0.995 else f"{value:.2f}×"


def _seconds(value: float) -> str:
    return f"{value:.2f}" if value < 9.95 else f"{value:.0f}"


def _kernel(sizes: dict[str, Any]) -> str:
    columns = [size["ns"] for size in sizes.values()]
    ours = next(iter(METHODS))
    rows = []
    for name in sorted({name for column in columns for name in column}, key=list(METHODS).index):
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
    """Return a row for each file and a column for each program."""
    names = [program.name for program in programs()]
    rows = []
    for label, file in files.items():
        cells = []
        for name in names:
            row = file["programs"].get(name, "not run")
            if isinstance(row, str):
                cells.append(row)
                continue
            if what == "wall" and row.get("busy"):
                cells.append("–")
                continue
            best = min(row[what])
            ours = file["programs"].get(names[0])
            unit = file["file_mb"] if of_file else min(ours[what]) if ours else None
            ratio = "" if unit is None or (name == names[0] and not of_file) else f" ({_ratio(best / unit)})"
            cells.append(f"{show(best)}{ratio}{' †' if row.get('busy') else ''}")
        rows.append([f"{label}, {file['file_mb']:.0f} MB", *cells])
    return _table(["", *names], rows)


def _small(sizes: dict[str, Any]) -> str:
    columns = list(sizes.values())
    ours = next(iter(columns[0]))
    rows = []
    for name in columns[0]:
        ratios = ["" if name == ours else f" ({_ratio(column[name] / column[ours])})" for column in columns]
        rows.append([name, *(f"{column[name]:.3g}{ratio}" for column, ratio in zip(columns, ratios, strict=True))])
    return _table(["", *(f"{int(count):,} triangles" for count in sizes)], rows)


def _accuracy(cases: dict[str, Any]) -> str:
    rows = []
    for name in next(iter(cases.values())):
        cells = []
        for case in cases.values():
            row = case[name]
            if isinstance(row, str):
                cells.append(row)
                continue
            bound = f" ≤ {row['bound']:.1e}" if "bound" in row else ""
            cells.append(f"{row['ns']:.3g} ns, {row['error']:.1e}{bound}")
        rows.append([name, *cells])
    return _table(["", *cases], rows)


def _startup(commands: dict[str, list[float]]) -> str:
    return _table(["", "best", "median"], [[name, f"{min(s):.3f}", f"{median(s):.3f}"] for name, s in commands.items()])


@dataclass(frozen=True)
class Target:
    """A figure, and the least that it is to be, or (not `above`) the most."""

    name: str
    value: float
    limit: float
    above: bool = True


def targets(document: dict[str, Any]) -> Iterator[Target]:
    """Yield what the tool is meant to reach, at the sizes for which that is stated, and was measured."""
    for count in ("1300000", "10000000"):
        if (size := document["kernel"].get(count)) is None:
            continue
        best = {name: min(runs) for name, runs in size["ns"].items()}
        for ours, words in (("inertia, vertices and faces", "inertia"), ("inertia, sums alone", "sums alone")):
            for peer, least in (("libigl", 2), ("trimesh", 100)):
                if ours in best and peer in best:
                    yield Target(f"kernel, {int(count):,}: {peer} ÷ {words}", best[peer] / best[ours], least)
    for label, least, most in (("1,300,000", 10, 0.40), ("10,000,000", 20, 1.3)):
        orders = {name: file["programs"] for name, file in document["files"].items() if name.startswith(label)}
        ours = {name: min(rows_of[OURS]["cpu"]) for name, rows_of in orders.items() if OURS in rows_of}
        if label not in ours:
            continue
        row_by_row = orders[label]
        for name, programs_of in orders.items():
            trimesh = programs_of.get("trimesh")
            if name in ours and isinstance(trimesh, dict) and not trimesh.get("busy"):
                yield Target(f"file, {name}: CPU, trimesh ÷ inertia", min(trimesh["cpu"]) / ours[name], least)
        memory = min(row_by_row[OURS]["peak"]) / document["files"][label]["file_mb"]
        yield Target(f"file, {label}: peak memory ÷ file", memory, 1.5, above=False)
        for name, seconds in ours.items():
            yield Target(f"file, {name}: CPU s", seconds, most, above=False)
        if (bodies := ours.get(f"{label} in bodies")) is not None:
            yield Target(f"file, {label}: CPU, many bodies ÷ one", bodies / ours[label], 1.5, above=False)
        if label == "10,000,000":
            yield Target(f"file, {label}: wall s, two cores", min(row_by_row[OURS]["wall"]), 0.8, above=False)
    for count, small in document["small"].items():
        if 150 < int(count) < 250:
            for name, limit in (("mass_properties", 150), ("many", 20)):
                ours_took, what = small[f"`inertia.{name}`"], f"{count} triangles in memory"
                yield Target(f"{what}: `{name}`, µs of CPU", ours_took, limit, above=False)
                yield Target(f"{what}: trimesh's sums ÷ `{name}`", small["trimesh, sums alone"] / ours_took, 1)
            yield Target(f"{what}: `many`, µs on the clock, two cores", small["... on the clock"], 20, above=False)
    for name, limit in (("`inertia --help`", 0.15), ("`inertia analyse t_handle.stl`", 0.5)):
        yield Target(f"{name}, CPU s", min(document["startup"][name]), limit, above=False)


def _row(target: Target) -> list[str]:
    reached = target.value >= target.limit if target.above else target.value <= target.limit
    sign = "≥" if target.above else "≤"
    return [target.name, f"{sign} {target.limit:g}", f"{target.value:.3g}", "reached" if reached else "missed"]


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    page = text(json.loads((folder / "benchmarks.json").read_text(encoding="utf-8")))
    (folder / "benchmarks.md").write_text(page, encoding="utf-8")
