"""Integrating arrays in memory on one core: nanoseconds of CPU time a triangle.

A program: ``python -m tests.benchmarks.kernel COUNT [BEGINNING OF A METHOD …]`` prints the times of one mesh.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

from inertia.native import COMPILE_ABOVE

from . import peers
from .meshes import Faces, Vertices, wavy_torus

Prepare = Callable[[Vertices, Faces], peers.Integrate]

METHODS: dict[str, tuple[Prepare, int | None]] = {
    "inertia, vertices and faces": (peers.inertia_faces, None),
    "inertia, STL records": (peers.inertia_facets, None),
    "inertia, sums alone": (peers.inertia_sums, None),
    "inertia, numpy only": (peers.inertia_numpy, None),
    "libigl": (peers.libigl, None),
    "VTK, `vtkMassProperties`": (peers.vtk, None),
    "VTK, `vtkMultiObjectMassProperties`": (peers.vtk_objects, None),
    "trimesh": (peers.trimesh, None),
    "MuJoCo": (peers.mujoco, 2_000_000),
}
"""Each with the most triangles that it is asked for (MuJoCo takes 30 s and 6 GB at ten million)."""

ROUNDS = 15
ENOUGH = 3.0
"""Seconds of CPU time after which a method that has run twice is not run again."""


def measure(count: int, names: Sequence[str] = ()) -> dict[str, Any]:
    """Measure one size: {"triangles": n, "ns": {method: [each run]}}."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    chosen = {name: prepare for name, (prepare, limit) in METHODS.items() if limit is None or count <= limit}
    chosen = {name: prepare for name, prepare in chosen.items() if name.startswith(tuple(names or [""]))}
    small = wavy_torus(COMPILE_ABOVE)
    for name, prepare in list(chosen.items()):  # imports, compiles, fills caches
        try:
            prepare(*small)()
        except ImportError:
            del chosen[name]
    mesh = wavy_torus(count)
    calls = {name: prepare(*mesh) for name, prepare in chosen.items()}
    triangles = len(mesh[1])
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    volumes: dict[str, float] = {}
    turns = list(calls)
    for turn in range(ROUNDS):
        first = turn % len(turns)
        for name in turns[first:] + turns[:first]:  # so that none always finds the caches as the same one left them
            if len(seconds[name]) >= 2 and sum(seconds[name]) > ENOUGH:
                continue
            begin = time.process_time()
            volumes[name] = calls[name]()
            seconds[name].append(time.process_time() - begin)
    true = peers.inertia_faces(*mesh)()
    for name, volume in volumes.items():
        if abs(volume - true) > 1e-6 * true:
            raise SystemExit(f"{name} gives the volume {volume!r}, inertia gives {true!r}")
    return {
        "triangles": triangles,
        "ns": {name: [round(1e9 * s / triangles, 2) for s in runs] for name, runs in seconds.items()},
    }


if __name__ == "__main__":
    print(json.dumps(measure(int(sys.argv[1]), sys.argv[2:])))
