"""Measure the extremes and write docs/extremes.md and docs/extremes.json."""

from __future__ import annotations

import argparse
import json
import math
import platform
import sys
import tempfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from statistics import median, quantiles
from typing import Any

import numpy as np

from inertia.errors import GeometryError
from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mesh.surface import Surface
from inertia.work_precision.machine import this_machine

from ..measure import ROOT, python_module
from ..meshes import wavy_torus
from .answers import PROGRAMS, Answer, answered
from .cases import Case, cases, nearly_equal, refused
from .commands import measured_command, questions
from .growth import growth
from .rungs import RUNGS, answer, bounds, chosen, properties
from .sweep import sweep
from .text import exceeded, text
from .truth import Truth, errors, lost

LARGE = 10_000_000
LARGE_PROGRAMS = ("trimesh", "libigl", "VTK")
PRICED = 1_300_000
"""Triangles for which the costs are measured."""
PACKAGES = ("inertia", "numpy", "numba", "trimesh", "libigl", "drake", "mujoco", "vtk")


def main() -> None:
    """Measure what the command line asks for; exit 1 where a bound did not hold."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.extremes", description=__doc__)
    parser.add_argument("--meshes", type=int, default=2000, metavar="N", help="random meshes in the sweep (2000)")
    parser.add_argument("--large", action="store_true", help="only ten million triangles (4 GB, some minutes)")
    parser.add_argument("--costs", action="store_true", help="only the costs (leave the machine to itself meanwhile)")
    parser.add_argument("--into", type=Path, default=ROOT / "docs", help="the folder to write to (docs)")
    parser.add_argument(
        "--parts", type=Path, metavar="FOLDER", help="only write the parts that are asked about to files"
    )
    options = parser.parse_args()
    if options.parts is not None:
        options.parts.mkdir(parents=True, exist_ok=True)
        for question in questions():
            (options.parts / question.name).write_bytes(question.content)
        return
    path = options.into / "extremes.json"
    document = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    if options.large:
        document["large"] = large()
    if options.costs or "costs" not in document:
        document["costs"] = costs()
    if not (options.large or options.costs) or "sweep" not in document:
        document |= small(options.meshes)
    options.into.mkdir(parents=True, exist_ok=True)
    path.write_text(_as_json(document), encoding="utf-8")
    (options.into / "extremes.md").write_text(text(document), encoding="utf-8")
    sys.exit(1 if exceeded(document) else 0)


def small(meshes: int) -> dict[str, Any]:
    """Measure every case and the sweep."""
    tally = sweep(0, meshes)
    return {
        "versions": {"Python": platform.python_version()} | _versions(),
        "cases": [measured(case) for case in cases()],
        "nearly_equal": [measured_axes(power, case) for power, case in nearly_equal()],
        "refused": [measured_refusal(case) for case in refused()],
        "commands": commands(),
        "sweep": {"meshes": meshes, "refused": tally.refused} | {rung: summaries(tally.ratios[rung]) for rung in RUNGS},
        "growth": [row | {"ratios": summaries(row["ratios"])} for row in growth()],
    }


def commands() -> list[dict[str, Any]]:
    """Ask the command line about each part."""
    with tempfile.TemporaryDirectory(prefix="inertia-parts-") as folder:
        return [measured_command(question, Path(folder)) for question in questions()]


def _versions() -> dict[str, str]:
    result = {}
    for name in PACKAGES:
        try:
            result[name] = version(name)
        except PackageNotFoundError:
            continue
    return result


def costs() -> dict[str, Any]:
    """Measure what each rung costs, in a process of its own with a cache of its own."""
    one_thread = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    with tempfile.TemporaryDirectory(prefix="inertia-cache-") as cache:
        printed = python_module("tests.benchmarks.extremes.costs", PRICED, env=one_thread | {"INERTIA_CACHE": cache})
    return {"machine": str(this_machine()), **json.loads(printed)}


def measured(case: Case) -> dict[str, Any]:
    """Return errors and bounds of every rung and the errors of the other programs."""
    truth = Truth.of(case.triangles.corners())
    row: dict[str, Any] = {"family": case.family, "case": case.name, "triangles": len(case.faces)}
    if case.meant is not None:
        row["lost"] = _rounded(lost(case.meant, truth))
    row["default"] = chosen(case.triangles, None)
    row["chosen"] = chosen(case.triangles, 1e-12)
    for rung in RUNGS:
        try:
            result = properties(solid_moments(case.triangles, rung), rung)
        except GeometryError as refusal:
            row[rung] = str(refusal)
            continue
        row[rung] = {
            "error": _rounded(errors(answer(result), truth)),
            "bound": _rounded(bounds(result, truth.size)),
        }
    for name, program in PROGRAMS.items():
        other = answered(program, case.vertices, case.faces)
        row[name] = other if isinstance(other, str) else _rounded(errors(other, truth))
    return row


def measured_axes(power: int, case: Case) -> dict[str, Any]:
    """Return the class at tolerance 0, and how far the first axis is off, for moments 10^-power apart."""
    truth = Truth.of(case.triangles.corners())
    low, high, largest = truth.spectrum[0]
    row: dict[str, Any] = {"gap": f"1e-{power}", "stored": _short(float((high - low) / largest))}
    for rung in RUNGS:
        result = properties(solid_moments(case.triangles, rung), rung).principal_within(0.0)
        row[rung] = {
            "class": result.kind,
            "angle": _short(truth.angle(result.axes[:, 0].tolist(), 0)),
            "bound": None if (0, 1) in result.equal else _short(float(result.axis_bounds[0])),
        }
    for name, program in PROGRAMS.items():
        other = answered(program, case.vertices, case.faces)
        if isinstance(other, str):
            row[name] = other
        elif other.axes is not None:
            row[name] = _short(truth.angle(other.axes[:, 0].tolist(), 0))
    return row


def measured_refusal(case: Case) -> dict[str, Any]:
    """Return the sentence that refuses a part, and what the other programs answer."""
    row: dict[str, Any] = {"case": case.name, "inertia": chosen(case.triangles, None)}
    for name, program in PROGRAMS.items():
        other = answered(program, case.vertices, case.faces)
        row[name] = other if isinstance(other, str) else _described(other)
    return row


def _described(result: Answer) -> str:
    tensor = "" if result.inertia is None else f", largest element of I {_short(float(np.abs(result.inertia).max())):g}"
    return f"V {_short(result.volume):g}{tensor}"


def large() -> dict[str, Any]:
    """Measure ten million triangles, all rungs against rational arithmetic piece by piece."""
    vertices, faces = wavy_torus(LARGE)
    triangles = Surface(vertices, faces)
    truth = Truth.of(vertices[faces])
    row: dict[str, Any] = {"case": "a wavy torus", "triangles": len(faces)}
    for rung in RUNGS:
        result = properties(solid_moments(triangles, rung), rung)
        row[rung] = {
            "error": _rounded(errors(answer(result), truth)),
            "bound": _rounded(bounds(result, truth.size)),
        }
    for name in LARGE_PROGRAMS:
        other = answered(PROGRAMS[name], vertices, faces)
        row[name] = other if isinstance(other, str) else _rounded(errors(other, truth))
    return row


def summaries(ratios: dict[str, list[float]]) -> dict[str, Any]:
    """Return for each quantity how many were compared, how many exceeded their bound, and the ratios bound/error."""
    rows: dict[str, Any] = {}
    for quantity, values in ratios.items():
        finite = [ratio for ratio in values if math.isfinite(ratio)]
        rows[quantity] = {
            "compared": len(values),
            "exceeded": sum(ratio < 1 for ratio in values),
            "without_error": len(values) - len(finite),
        }
        if len(finite) > 1:
            most = quantiles(finite, n=20)[-1]
            rows[quantity] |= {"median": _short(median(finite)), "95 %": _short(most), "largest": _short(max(finite))}
    return rows


def _rounded(figures: dict[str, float]) -> dict[str, float]:
    return {name: _short(value) for name, value in figures.items()}


def _short(value: float) -> float:
    return float(f"{value:.1e}")


def _as_json(document: dict[str, Any]) -> str:
    """Write a line for each case."""
    parts = []
    for key, value in document.items():
        if isinstance(value, list):
            lines = ",\n".join(f"  {json.dumps(row, ensure_ascii=False)}" for row in value)
            parts.append(f' "{key}": [\n{lines}\n ]')
        else:
            parts.append(f' "{key}": {json.dumps(value, ensure_ascii=False)}')
    return "{\n" + ",\n".join(parts) + "\n}\n"


if __name__ == "__main__":
    main()
