"""Speed against accuracy: CPU time a triangle and the true error of each program, on one mesh in three places.

A program: ``python -m tests.benchmarks.accuracy --json`` prints the figures.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mesh.surface import Surface

from . import peers
from .extremes.answers import PROGRAMS, answered
from .extremes.rungs import RUNGS, answer, bounds, properties
from .extremes.truth import Truth, errors
from .meshes import Faces, Vertices, wavy_torus

COUNT = 320_000
ROUNDS = 3
TIMED = {"trimesh": peers.trimesh, "libigl": peers.libigl, "VTK": peers.vtk, "MuJoCo": peers.mujoco}


def places() -> tuple[dict[str, Vertices], Faces]:
    """Return the vertices of each case, and the triangles."""
    vertices, faces = wavy_torus(COUNT)
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    return {
        "at the origin": vertices,
        "a thousand diameters away": vertices + 1000 * np.ptp(vertices, axis=0).max(),
        "a plate askew, 1 : 10,000": (vertices * [1, 1, 1e-4]) @ turn,
    }, faces


def least(call: Callable[[], object], triangles: int) -> float:
    """Return the least CPU time of a few runs, ns a triangle."""
    runs = []
    for _ in range(ROUNDS):
        begin = time.process_time()
        call()
        runs.append(1e9 * (time.process_time() - begin) / triangles)
    return round(min(runs), 2)


def measured(vertices: Vertices, faces: Faces) -> dict[str, Any]:
    """Return {program: {"ns", "error", "bound"}}; the error is that of the tensor, of VTK that of the volume."""
    triangles, truth = Surface(vertices, faces), Truth.of(vertices[faces])
    rows: dict[str, Any] = {}
    for rung in RUNGS:
        result = properties(solid_moments(triangles, rung), rung)
        rows[f"inertia, {rung}"] = {
            "ns": least(lambda rung=rung: solid_moments(triangles, rung), triangles.count),  # type: ignore[misc]
            "error": errors(answer(result), truth)["tensor"],
            "bound": bounds(result, truth.size)["tensor"],
        }
    for name, prepare in TIMED.items():
        other = answered(PROGRAMS[name], vertices, faces)
        if isinstance(other, str):
            rows[name] = other
            continue
        off = errors(other, truth)
        rows[name] = {"ns": least(prepare(vertices, faces), triangles.count), "error": off.get("tensor", off["volume"])}
    return rows


def main() -> None:
    """Print the figures of all cases."""
    cases, faces = places()
    print(json.dumps({name: measured(vertices, faces) for name, vertices in cases.items()}))


if __name__ == "__main__":
    main()
