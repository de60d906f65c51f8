"""Parts in memory: microseconds of CPU time each, beside trimesh, a triangle at any size, and bounds over errors.

A program: ``python -m tests.benchmarks.small``.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from unittest.mock import patch

import numpy as np

import inertia
from inertia.mass import integration
from inertia.mass.triangles import arithmetic, sums
from inertia.mass.triangles.arithmetic import solid_moments
from inertia.mesh.surface import Surface

from .batch import stl
from .meshes import Faces, Vertices, wavy_torus

COUNTS = (60, 200, 1000)
CURVE = (100, 200, 500, 1_000, 3_000, 3_100, 10_000, 30_000, 100_000, 199_000, 201_000)
MEASURED = (200, 2_000, 20_000, 180_000, 300_000, 2_000_000)
SHAPES = {
    "torus": (1, 1, 1),
    "plate": (1, 1, 1e-3),
    "wall": (1, 1e-2, 1),
    "needle": (1, 1e-3, 1e-3),
    "foil": (1, 1, 1e-6),
}
BOUNDED = (60, 200, 500, 1_000, 2_000, 4_000, 6_000, 10_000, 50_000, 300_000, 1_300_000)
IN_FILES = ("torus", "plate", "wall")
"""Shapes that are sound where coordinates are rounded to float32."""
PAIRS = 120
MESHES = 500
ROUNDS = 7


def microseconds(call: Callable[[], object], times: int, clock: Callable[[], float] = time.process_time) -> float:
    """Return the least CPU time, or that on another clock, of `ROUNDS` runs, of each of so many answers in it."""
    call()
    runs = []
    for _ in range(ROUNDS):
        begin = clock()
        call()
        runs.append(clock() - begin)
    return 1e6 * min(runs) / times


def on_all_cores(call: Callable[[], object]) -> float:
    """Return the microseconds that pass on the clock where threads are not limited to one, as they are for CPU time."""
    with patch.dict(os.environ):
        os.environ.pop("OMP_NUM_THREADS", None)
        return microseconds(call, MESHES, time.perf_counter)


def speed(count: int) -> dict[str, float]:
    """Return the microseconds that each way takes for a mesh of about so many triangles."""
    import trimesh

    vertices, faces = wavy_torus(count)
    sizes = np.random.default_rng(0).uniform(0.5, 2.0, MESHES)
    several = sizes[:, None, None] * vertices
    corners = [each[faces] for each in several]

    def ours() -> list[float]:
        return [inertia.mass_properties(inertia.Part.from_arrays(each, faces)).mass for each in several]

    def with_bounds() -> list[float]:
        return [inertia.mass_properties(inertia.Part.from_arrays(each, faces)).error.mass for each in several[:50]]

    def analysed() -> list[float]:
        return [inertia.analyse(inertia.Part.from_arrays(each, faces)).properties.mass for each in several[:50]]

    def core() -> list[float]:
        return [float(trimesh.triangles.mass_properties(each).mass) for each in corners]

    def checked() -> list[bool]:
        return [bool(trimesh.Trimesh(each, faces).is_volume) for each in several[:50]]

    return {
        "`inertia.many`": microseconds(lambda: inertia.many(several, faces), MESHES),
        "... on the clock": on_all_cores(lambda: inertia.many(several, faces)),
        "`inertia.mass_properties`": microseconds(ours, MESHES),
        "... and its bounds read": microseconds(with_bounds, 50),
        "`inertia.analyse`": microseconds(analysed, 50),
        "trimesh, sums alone": microseconds(core, MESHES),
        "trimesh, closed and wound": microseconds(checked, 50),
    }


def with_own_faces(count: int) -> tuple[float, float]:
    """Return the microseconds a mesh of `inertia.many` where each has faces of its own: of CPU time, and on the clock.

    Threads share the meshes, so that the clock shows less.
    """
    vertices, faces = wavy_torus(count)
    several = np.random.default_rng(0).uniform(0.5, 2.0, MESHES)[:, None, None] * vertices
    own = [faces.copy() for _ in several]

    def ours() -> object:
        return inertia.many(several, own)

    return microseconds(ours, MESHES), on_all_cores(ours)


def nanoseconds(count: int) -> tuple[int, float]:
    """Return how many triangles a mesh of about so many has, and what `mass_properties` takes for each of them."""
    vertices, faces = wavy_torus(count)
    times = max(1, 10_000 // len(faces))

    def ours() -> list[float]:
        return [inertia.mass_properties(inertia.Part.from_arrays(vertices, faces)).mass for _ in range(times)]

    return len(faces), 1e3 * microseconds(ours, times) / len(faces)


def share_of_bounds(count: int, shape: tuple[float, ...]) -> tuple[int, float, float]:
    """Return how many triangles a file has, milliseconds of CPU time to its answer, and the share of its bounds.

    Runs alternate with such in which float64 is all that is summed, and bounds are a-priori ones: the share is the
    median over pairs. It is below nothing for small parts: the pass that forms both sums takes less than those alone.
    """
    vertices, faces = wavy_torus(count)
    vertices = placed(vertices, shape, 3)
    times = max(1, 2_000 // len(faces))

    def once() -> float:
        begin = time.process_time()
        for _ in range(times):
            inertia.analyse(inertia.read(path, unit="mm"))
        return 1e3 * (time.process_time() - begin) / times

    def without() -> float:
        with (
            patch.object(sums, "MANY", 10**9),
            patch.object(arithmetic, "_measured", lambda *_: None),
            patch.object(integration, "sum_block", lambda _: None),
        ):
            return once()

    with TemporaryDirectory() as folder:
        path = Path(folder, "part.stl")
        path.write_bytes(stl(vertices[faces]))
        once(), without()
        pairs = [(once(), without()) for _ in range(PAIRS)]
    return len(faces), min(one for one, _ in pairs), median(1.0 - other / one for one, other in pairs)


def placed(vertices: Vertices, shape: tuple[float, ...], seed: int) -> Vertices:
    """Return a mesh stretched, turned and moved off."""
    rng = np.random.default_rng(seed)
    turned: Vertices = (vertices * shape) @ np.linalg.qr(rng.normal(size=(3, 3)))[0] + rng.normal(size=3)
    return turned


def ratio(vertices: Vertices, faces: Faces) -> float:
    """Return the bound over the error, the median of the ten moments as float64; stop where one is below it."""
    surface = Surface(vertices, faces)
    moments, exact = solid_moments(surface, "float64"), solid_moments(surface, "exact")
    exact = exact.about(moments.origin)
    ratios = []
    for value, true, bound in zip(
        (moments.zeroth, *moments.first, *moments.second),
        (exact.zeroth, *exact.first, *exact.second),
        (moments.zeroth_bound, *moments.first_bound, *moments.second_bound),
        strict=True,
    ):
        shown = Fraction(float(value))
        off, within = abs(shown - true), bound + abs(shown - value)
        if off > within:
            sys.exit(f"{len(faces)} triangles: off by {float(off):g}, the bound is {float(within):g}")
        if off:
            ratios.append(float(within / off))
    return median(ratios)


def main() -> None:
    """Print both tables; or, with --json, the times."""
    if "--json" in sys.argv:
        print(json.dumps({len(wavy_torus(count)[1]): speed(count) for count in COUNTS}))
        return
    print("| microseconds a mesh |" + "".join(f" {len(wavy_torus(count)[1])} triangles |" for count in COUNTS))
    print("|---|" + "---:|" * len(COUNTS))
    columns = [speed(count) for count in COUNTS]
    for name in columns[0]:
        print(f"| {name} |" + "".join(f" {column[name]:.1f} |" for column in columns))
    others = [with_own_faces(count) for count in COUNTS]
    for name, k in (("`inertia.many`, each its own faces", 0), ("... on the clock", 1)):
        print(f"| {name} |" + "".join(f" {other[k]:.1f} |" for other in others))
    curve = [nanoseconds(count) for count in CURVE]
    print("\n| triangles |" + "".join(f" {count:,} |" for count, _ in curve))
    print("|---|" + "---:|" * len(curve))
    print("| nanoseconds each |" + "".join(f" {each:.0f} |" for _, each in curve))
    for name in IN_FILES:
        shares = [share_of_bounds(count, SHAPES[name]) for count in BOUNDED]
        print(f"\n| {name} of triangles |" + "".join(f" {count:,} |" for count, _, _ in shares))
        print("|---|" + "---:|" * len(shares))
        print("| milliseconds from file to answer |" + "".join(f" {each:.2f} |" for _, each, _ in shares))
        print("| of which its bounds |" + "".join(f" {share:.1%} |" for _, _, share in shares))
    print("\n| bound over error, moments |" + "".join(f" {count:,} |" for count in MEASURED))
    print("|---|" + "---:|" * len(MEASURED))
    for name, shape in SHAPES.items():
        row = []
        for count in MEASURED:
            vertices, faces = wavy_torus(count)
            row.append(ratio(placed(vertices, shape, count), faces))
        print(f"| {name} |" + "".join(f" {value:.3g} |" for value in row))


if __name__ == "__main__":
    main()
