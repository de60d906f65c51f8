"""One binary STL file that is larger than memory: ``python -m tests.benchmarks.large FOLDER 1e7 3e7 1e8``.

The surface is a torus whose triangles are written in an order in which no neighbours are near: number k of the file is
k p modulo n of the surface, p / n near the golden ratio. It prints CPU time and peak memory of the command, from file
to answer with its SHA-256, within 1 GB, or 8 bytes a triangle where that is more.
"""

from __future__ import annotations

import math
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np

from inertia.mesh.surface import FACET

_CHUNK = 1 << 17
_PROGRAM = """
import sys
from inertia_cli.main import main
code = main(sys.argv[1:])
print(open("/proc/self/status").read(), file=sys.stderr)
sys.exit(code)
"""


def write_torus(path: Path, triangles: float) -> int:
    """Write a torus of about so many triangles; return how many."""
    side = round(math.sqrt(triangles / 2))
    count = 2 * side * side
    step = int(count * (math.sqrt(5) - 1) / 2)
    while math.gcd(step, count) != 1:
        step += 1
    angle = 2 * np.pi * np.arange(side) / side
    x, y = np.cos(angle), np.sin(angle)
    with path.open("wb") as file:
        file.write(bytes(80) + np.uint32(count).tobytes())
        for first in range(0, count, _CHUNK):
            number = np.arange(first, min(first + _CHUNK, count), dtype=np.int64)
            number = number * step % count  # below 2⁶³ up to two thousand million
            cell, half = number >> 1, (number & 1).astype(bool)
            u, v = np.divmod(cell, side)
            beside, above = (u + 1) % side, (v + 1) % side
            corners = ((u, v), (beside, np.where(half, above, v)), (np.where(half, u, beside), above))
            records = np.zeros(len(number), FACET)
            for k, (i, j) in enumerate(corners):
                radius = 3 + x[j]
                records[f"x{k}"], records[f"y{k}"], records[f"z{k}"] = radius * x[i], radius * y[i], y[j]
            file.write(records.data)
    return count


def measure(path: Path, *options: str) -> tuple[float, float]:
    """Return CPU time, s, and peak memory, MB, of an analysis."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-c", _PROGRAM, "analyse", str(path), "--json", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    peak = re.search(r"VmHWM:\s*(\d+) kB", done.stderr)
    assert peak is not None
    assert '"closed": true' in done.stdout
    assert '"bodies": 1' in done.stdout
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, int(peak[1]) * 1024 / 1e6


def main(folder: str, *counts: str) -> None:
    """Measure each count."""
    print("| triangles | CPU s | ns a triangle | peak memory, MB |\n|---|---|---|---|")
    for wanted in counts:
        path = Path(folder) / "torus.stl"
        try:
            count = write_torus(path, float(wanted))
            seconds, peak = measure(path, "--memory", f"{max(10**9, 8 * count)}")
            print(f"| {count:,} | {seconds:.1f} | {1e9 * seconds / count:.0f} | {peak:.0f} |", flush=True)
        finally:
            path.unlink(missing_ok=True)


if __name__ == "__main__":
    os.nice(10)
    main(*sys.argv[1:])
