"""Measure everything and write docs/benchmarks.md and docs/benchmarks.json."""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path
from typing import Any

from inertia.native import COMPILE_ABOVE

from .measure import ROOT, python_module
from .startup import startup
from .table import text
from .whole import stl_file, warm_up, whole

DATA = Path(__file__).resolve().parent / "data"
SIZES = [20_000, 320_000, 1_300_000, 10_000_000]
QUICK = [20_000, 320_000]
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "VTK_SMP_MAX_THREADS"), "1")
ORDERS = "in two sweeps", "shuffled", "in bodies"
ORDERED_FROM = 100_000
PACKAGES = ["inertia", "numpy", "numba", "llvmlite", "libigl", "vtk", "trimesh", "mujoco"]


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, metavar="COUNT", help="numbers of triangles")
    parser.add_argument("--quick", action="store_true", help="small meshes only, written beside the meshes")
    parser.add_argument("--into", type=Path, help="the folder to write to (docs)")
    options = parser.parse_args()
    sizes = QUICK if options.quick else sorted(options.sizes)
    into = options.into or (DATA if options.quick else ROOT / "docs")
    with tempfile.TemporaryDirectory(prefix="inertia-cache-") as cache:
        document = measure(sizes, {"INERTIA_CACHE": cache})
    into.mkdir(parents=True, exist_ok=True)
    (into / "benchmarks.json").write_text(_as_json(document) + "\n", encoding="utf-8")
    (into / "benchmarks.md").write_text(text(document), encoding="utf-8")
    print((into / "benchmarks.md").read_text(encoding="utf-8"))


def measure(sizes: list[int], environment: dict[str, str]) -> dict[str, Any]:
    """Measure kernel, files and start-up, one after the other; nothing else should run meanwhile."""
    document: dict[str, Any] = {
        "command": " ".join(["python -m tests.benchmarks", *sys.argv[1:]]),
        "machine": {"cpu": _cpu(), "cores": os.cpu_count(), "system": f"{platform.system()} {platform.machine()}"},
        "versions": {"Python": platform.python_version()} | {name: version(name) for name in PACKAGES},
        "kernel": {},
        "files": {},
    }
    document["startup"] = startup(environment)
    for count in sizes:
        _say(f"kernel, {count:,} triangles")
        printed = python_module("tests.benchmarks.kernel", count, env=environment | ONE_THREAD)
        document["kernel"][str(count)] = json.loads(printed)
    with tempfile.TemporaryDirectory() as folder:  # compiles what is not yet in the cache
        warm_up(stl_file(Path(folder), COMPILE_ABOVE), environment)
    for count in sizes:
        for order in ("", *ORDERS) if count > ORDERED_FROM else ("",):
            _file(document, count, environment, order)
    return document


def _file(document: dict[str, Any], count: int, environment: dict[str, str], order: str) -> None:
    label = f"{count:,} {order}".strip()
    path = stl_file(DATA, count, order)
    document["files"][label] = whole(path, count, environment, lambda line: _say(f"{label}, {line}"))


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _as_json(value: Any, indent: str = "") -> str:
    """Write a line for each entry of a dictionary that holds none itself."""
    if not isinstance(value, dict) or not any(isinstance(entry, (dict, list)) for entry in value.values()):
        return json.dumps(value, ensure_ascii=False)
    inner = indent + " "
    entries = (
        f"{inner}{json.dumps(key, ensure_ascii=False)}: {_as_json(entry, inner)}" for key, entry in value.items()
    )
    return "{\n" + ",\n".join(entries) + f"\n{indent}}}"


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
