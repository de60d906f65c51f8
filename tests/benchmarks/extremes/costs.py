"""What each rung costs on one core: nanoseconds of CPU time a triangle, beside a kernel that gives no bound.

A program: ``python -m tests.benchmarks.extremes.costs COUNT`` prints every run.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mass.triangles.kernels import BLOCK, LANES
from inertia.mesh.surface import Surface
from inertia.native import COMPILE_ABOVE, Kernel

from ..meshes import Faces, Vertices, wavy_torus

ROUNDS = 9
BARE = "bare kernel, no bound"
SUMS = 10

_BARE = Kernel("tests.benchmarks.extremes.bare_kernel", "sum_bare", "ppi" + "ddd" + "pp")


def costs(count: int) -> dict[str, Any]:
    """Measure every rung by turns: {"triangles": n, "ns": {kind of coordinates: {rung: [each run]}}}."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    small = calls(*wavy_torus(COMPILE_ABOVE))
    for call in small.values():  # compiles
        call()
    vertices, faces = wavy_torus(count)
    kinds = {"float32": vertices, "float64": vertices / 3}
    return {
        "triangles": len(faces),
        "ns": {kind: timed(calls(points, faces), len(faces)) for kind, points in kinds.items()},
    }


def calls(vertices: Vertices, faces: Faces) -> dict[str, Callable[[], float]]:
    """Return for each rung a call that integrates the mesh, from the arrays to the bounds, and gives its volume."""
    triangles = Surface(vertices, faces)
    return {
        BARE: lambda: bare(triangles),
        "float64": lambda: float(solid_moments(triangles, "float64").zeroth),
        "double-double": lambda: float(solid_moments(triangles, "double-double").zeroth),
        "exact": lambda: float(solid_moments(triangles, "exact").zeroth),
    }


def timed(calls: dict[str, Callable[[], float]], triangles: int) -> dict[str, list[float]]:
    """Return the runs of each call, in which the calls took turns."""
    ns: dict[str, list[float]] = {name: [] for name in calls}
    volumes: dict[str, float] = {}
    for _ in range(ROUNDS):
        for name, call in calls.items():
            begin = time.process_time()
            volumes[name] = call()
            ns[name].append(round(1e9 * (time.process_time() - begin) / triangles, 2))
    exact = volumes["exact"]
    for name, volume in volumes.items():
        if abs(volume - exact) > 1e-12 * exact:
            raise SystemExit(f"{name} gives the volume {volume!r}, exact integers give {exact!r}")
    return ns


def bare(triangles: Surface) -> float:
    """Return the volume, from the ten sums over all triangles."""
    vertices, faces = triangles.vertices, triangles.faces
    sample = triangles.sample(64).reshape(-1, 3)
    origin = 0.5 * (sample.min(axis=0) + sample.max(axis=0))
    room = np.empty((9 + SUMS) * LANES + 8)
    scratch = room[-room.ctypes.data % 64 // 8 :]  # on a cache line
    out = np.empty((-(-len(faces) // BLOCK), SUMS))
    at = (vertices.ctypes.data, faces.ctypes.data, len(faces), *origin.tolist(), scratch.ctypes.data)
    _BARE.function(*at, out.ctypes.data)
    return float(out.sum(axis=0)[0]) / 6


if __name__ == "__main__":
    print(json.dumps(costs(int(sys.argv[1]))))
