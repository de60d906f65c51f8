"""Measure what balancing a rotor costs, and write docs/balancing-benchmarks.md and .json."""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .measure import ROOT, python_module

ROUNDS = 5
TARGETS = {
    "analysis, 1 M triangles": ("analysis", 1_000_000, 10.0),
    "one cut and integration, 100 k triangles": ("cut", 100_000, 1.0),
    "Monte Carlo, 10 000 draws": ("draws", 10_000, 1.0),
}
TEXT = """# What balancing costs

Seconds of one process, the median of {rounds} runs (in brackets the fastest and the slowest) on {machine}; the runs are
in [balancing-benchmarks.json](balancing-benchmarks.json).

| | s | target | |
|-|-:|-:|-|
{rows}

The rotor is a wavy disc on a shaft, one closed mesh without any symmetry. *Analysis* is `inertia.balance` of a rotor
file: the mesh is read from a binary STL file in the page cache, checked and integrated; unbalance, tolerance,
tessellation bound, verdict and Monte Carlo follow. *One cut and integration* takes a drilled hole out of the mesh and
integrates what is left; a correction takes three or four of them. The *Monte Carlo* has {terms} inputs: axis,
tessellation, and the depth, diameter, angle, radius and place of two holes.

Measured by `python -m tests.benchmarks.balancing`.
"""


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.balancing", description=__doc__)
    parser.add_argument("--into", type=Path, default=ROOT / "docs", help="the folder to write to (docs)")
    parser.add_argument("--one", nargs=2, metavar=("KIND", "COUNT"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(MEASURES[options.one[0]](int(options.one[1]))))
        return
    from .__main__ import _cpu

    result: dict[str, Any] = {"machine": f"{_cpu()}, {os.cpu_count()} cores", "rows": {}}
    lines = []
    for label, (kind, count, target) in TARGETS.items():
        one = json.loads(python_module("tests.benchmarks.balancing", "--one", kind, count, env={}))
        seconds = one["seconds"]
        middle = statistics.median(seconds)
        verdict = "reached" if middle <= target else "missed"
        spread = f"{middle:.2g} ({min(seconds):.2g}–{max(seconds):.2g})"
        lines.append(f"| {label} | {spread} | {target:g} | {verdict} |")
        result["rows"][label] = one | {"target": target}
        print(lines[-1], file=sys.stderr, flush=True)
    terms = result["rows"]["Monte Carlo, 10 000 draws"]["terms"]
    text = TEXT.format(rounds=ROUNDS, machine=result["machine"], rows="\n".join(lines), terms=terms)
    (options.into / "balancing-benchmarks.md").write_text(text, encoding="utf-8")
    (options.into / "balancing-benchmarks.json").write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


def analysis(count: int) -> dict[str, Any]:
    """Return the times of balancing a rotor file whose mesh has about `count` triangles."""
    from inertia import Rotor, balance

    with tempfile.TemporaryDirectory() as folder:
        triangles = _write_rotor(Path(folder) / "rotor.stl", count)
        rotor = Rotor.from_dict(_described(), folder)
        return {"triangles": triangles, "seconds": _timed(lambda: balance(rotor))}


def cut(count: int) -> dict[str, Any]:
    """Return the times of cutting one hole out of a rotor of about `count` triangles and integrating it."""
    from inertia.balancing.axis.shaft import Shaft
    from inertia.balancing.corrections.correction_plane import CorrectionPlane
    from inertia.balancing.corrections.drilling import RadialDrill
    from inertia.balancing.corrections.workpiece import Workpiece
    from inertia.balancing.unbalance import Unbalance
    from inertia.mass.analyse import mass_properties
    from inertia.mesh.read import read

    with tempfile.TemporaryDirectory() as folder:
        triangles = _write_rotor(Path(folder) / "rotor.stl", count)
        part = read(Path(folder) / "rotor.stl", unit="mm")
        shaft = Shaft(np.array([0.0, 0.0, 0.02]), np.array([0.0, 0.0, 0.28]), np.array([1.0, 0.0, 0.0]))
        plane = CorrectionPlane("I", 0.15, "drill_radial", 0.1, diameters=(0.01,), max_depth=0.02)
        hole = RadialDrill(plane, 7850.0, diameter=0.01).solid(angle=0.5, setting=0.02)
        piece = Workpiece((part,), (7850.0,), shaft, Unbalance.of(mass_properties(part, 7850.0), shaft))
        return {"triangles": triangles, "seconds": _timed(lambda: piece.cut([hole], ()))}


def draws(count: int) -> dict[str, Any]:
    """Return the times of drawing the residual of the sample rotor, corrected by two holes."""
    from dataclasses import replace

    from inertia import Rotor, balance
    from inertia.balancing.monte_carlo import monte_carlo
    from inertia.balancing.monte_carlo_terms import operation_terms, rotor_terms
    from inertia_meshes import path

    rotor = Rotor.load(path("rotors/two_disc_rotor.toml"))
    axis = replace(rotor.fields.axis, radial_uncertainty=0.005)
    result = balance(replace(rotor, fields=replace(rotor.fields, axis=axis)))
    at, left = result.tolerance_planes, result.residual
    assert result.correction is not None
    terms = rotor_terms(left, at) + operation_terms(result.correction.operations, left, at, rotor.shop)
    return {"terms": len(terms), "seconds": _timed(lambda: monte_carlo(left.in_planes(*at), terms, draws=count))}


def _timed(work: Callable[[], object]) -> list[float]:
    work()  # imports, and the page cache
    seconds = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        work()
        seconds.append(round(time.perf_counter() - begin, 4))
    return seconds


def _described() -> dict[str, Any]:
    return {
        "body": [{"file": "rotor.stl", "material": "steel", "chord_tolerance": 0.001}],
        "axis": {"bearing_a": [0, 0, 20], "bearing_b": [0, 0, 280], "radial_uncertainty": 0.005},
        "service": {"rpm": 3000},
        "tolerance": {"grade": 6.3},
        "plane": [{"id": "I", "z": 90}, {"id": "II", "z": 215}],
    }


def _write_rotor(file: Path, count: int) -> int:
    """Write a wavy disc on a shaft (mm) as binary STL, and return its number of triangles, about `count`."""
    from .meshes import facets

    around = round(math.sqrt(count))
    along = count // (2 * around)
    z = np.linspace(0.0, 300.0, along + 1)
    turn = 2.0 * math.pi * np.arange(around) / around
    radius = 15.0 + 85.0 / (1.0 + np.exp(((z - 150.0) ** 2 - 3600.0) / 400.0))
    rim = radius[:, np.newaxis] * (
        1.0 + 0.002 * np.cos(turn - 0.5) + 0.001 * np.cos(7.0 * turn + 0.02 * z[:, np.newaxis])
    )
    height = np.broadcast_to(z[:, np.newaxis], rim.shape)
    ring = np.stack([rim * np.cos(turn), rim * np.sin(turn), height], axis=2).reshape(-1, 3)
    vertices = np.concatenate([ring, [[0.0, 0.0, 0.0], [0.0, 0.0, 300.0]]])
    here = (np.arange(along)[:, np.newaxis] * around + np.arange(around)).ravel()
    beside = (np.arange(along)[:, np.newaxis] * around + (np.arange(around) + 1) % around).ravel()
    first, last = here[:around], here[-around:] + around
    faces = [
        np.column_stack([here, beside, beside + around]),
        np.column_stack([here, beside + around, here + around]),
        np.column_stack([beside[:around], first, np.full(around, len(ring))]),
        np.column_stack([last, beside[-around:] + around, np.full(around, len(ring) + 1)]),
    ]
    triangles = np.concatenate(faces)
    with file.open("wb") as stream:
        stream.write(bytes(80) + len(triangles).to_bytes(4, "little"))
        facets(vertices, triangles).tofile(stream)
    return len(triangles)


MEASURES = {"analysis": analysis, "cut": cut, "draws": draws}

if __name__ == "__main__":
    main()
