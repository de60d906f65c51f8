"""Measure, draw docs/benchmarks-*.svg, and write docs/benchmarks.md and docs/benchmarks.json.

Without options everything is measured anew. A part, a size, an order or a program alone takes its place among the
stored figures. With --quick, in five minutes, each figure of the README stands beside what is measured here.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import tempfile
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from inertia.native import COMPILE_ABOVE

from .measure import ROOT, python_module
from .startup import startup
from .whole import DATA, ROUNDS, stl_file, warm_up, whole

SIZES = [20_000, 320_000, 1_300_000, 10_000_000]
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "VTK_SMP_MAX_THREADS"), "1")
ORDERS = {"rows": "", "sweeps": "in two sweeps", "shuffled": "shuffled", "bodies": "in bodies"}
ORDERED_FROM = 100_000
PARTS = "startup", "kernel", "small", "accuracy", "files"
PACKAGES = ["inertia", "numpy", "numba", "llvmlite", "libigl", "vtk", "trimesh", "mujoco"]


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="what README and docs state beside what is measured here")
    parser.add_argument("--part", choices=PARTS, nargs="+", default=PARTS, help="measure these alone")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, metavar="COUNT", help="numbers of triangles")
    parser.add_argument("--orders", choices=ORDERS, nargs="+", default=list(ORDERS), help="of the triangles of files")
    parser.add_argument("--programs", nargs="+", default=[""], metavar="NAME", help="beginnings of names of programs")
    parser.add_argument("--rounds", type=int, default=ROUNDS, metavar="N", help="runs of each program on a file")
    parser.add_argument("--more", action="store_true", help="keep the stored runs beside the new ones")
    parser.add_argument("--busy", action="store_true", help="other programs run meanwhile: the page says so of files")
    parser.add_argument("--draw", action="store_true", help="measure nothing: write the page from the stored figures")
    parser.add_argument("--into", type=Path, default=ROOT / "docs", help="the folder to write to (docs)")
    options = parser.parse_args()
    if options.quick:
        from .quick import judged

        sys.exit(judged())
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # whoever installs a package has its compiled bytecode
    stored = options.into / "benchmarks.json"
    whole_run = options == parser.parse_args(["--into", str(options.into)])
    document = {} if whole_run or not stored.exists() else json.loads(stored.read_text(encoding="utf-8"))
    if not options.draw:
        with tempfile.TemporaryDirectory(prefix="inertia-cache-") as cache:
            for _ in measure(document, options, {"INERTIA_CACHE": cache}):
                options.into.mkdir(parents=True, exist_ok=True)
                stored.write_text(_as_json(document) + "\n", encoding="utf-8")
    python_module("tests.benchmarks.pictures", options.into, env={})
    if missing := [part for part in PARTS if part not in document]:
        sys.exit(f"no page yet: {', '.join(missing)} not measured")
    python_module("tests.benchmarks.table", options.into, env={})


def measure(document: dict[str, Any], options: argparse.Namespace, environment: dict[str, str]) -> Iterator[None]:
    """Measure the parts one after the other, into the document, and yield after each."""
    here = {
        "cpu": _cpu(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "versions": {"Python": platform.python_version()} | _versions(),
    }
    document["machines"] = document.get("machines", {}) | dict.fromkeys(options.part, here)
    if "startup" in options.part:
        document["startup"] = startup(environment)
        yield
    if "kernel" in options.part:
        for count in sorted(options.sizes):
            _kernel(document.setdefault("kernel", {}), count, options, environment)
            yield
    for part in ("small", "accuracy"):
        if part in options.part:
            _say(part)
            document[part] = json.loads(
                python_module(f"tests.benchmarks.{part}", "--json", env=environment | ONE_THREAD)
            )
            yield
    if "files" in options.part:
        with tempfile.TemporaryDirectory() as folder:  # compiles what is not yet in the cache
            warm_up(stl_file(Path(folder), COMPILE_ABOVE), environment)
        for count in sorted(options.sizes):
            for key in options.orders if count > ORDERED_FROM else ("rows",):
                _file(document.setdefault("files", {}), count, ORDERS[key], options, environment)
                yield


def _kernel(stored: dict[str, Any], count: int, options: argparse.Namespace, environment: dict[str, str]) -> None:
    _say(f"kernel, {count:,} triangles")
    printed = python_module("tests.benchmarks.kernel", count, *options.programs, env=environment | ONE_THREAD)
    row = json.loads(printed)
    ns = stored.setdefault(str(count), {"triangles": row["triangles"], "ns": {}})["ns"]
    for name, runs in row["ns"].items():
        ns[name] = [*ns.get(name, []), *runs] if options.more else runs


def _file(
    stored: dict[str, Any], count: int, order: str, options: argparse.Namespace, environment: dict[str, str]
) -> None:
    label = f"{count:,} {order}".strip()

    def wanted(name: str) -> bool:
        return name.startswith(tuple(options.programs))

    path = stl_file(DATA, count, order)
    new = whole(path, count, environment, lambda line: _say(f"{label}, {line}"), wanted, options.rounds)
    old = stored.setdefault(label, new)["programs"]
    for name, row in new["programs"].items():
        if options.busy and isinstance(row, dict):
            row["busy"] = True
        if options.more and old is not new["programs"] and isinstance(old.get(name), dict) and isinstance(row, dict):
            for key in ("cpu", "wall", "peak"):
                row[key] = old[name][key] + row[key]
        old[name] = row


def _versions() -> dict[str, str]:
    versions = {}
    for name in PACKAGES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    return versions


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
