"""Measure everything and write docs/motion-benchmarks.md, .json and .svg."""

from __future__ import annotations

import argparse
import json
import platform
import sys
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from inertia.work_precision.machine import this_machine

from ..measure import ROOT
from .ensembles import ensembles
from .measure import measure
from .plot import draw
from .scenes import MOTIONS
from .table import text

PACKAGES = ["inertia", "numpy", "scipy", "numba", "heyoka", "mujoco", "mpmath"]
NAME = "motion-benchmarks"


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.motion", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="ten revolutions only")
    parser.add_argument("--into", type=Path, default=ROOT / "docs", help="the folder to write to (docs)")
    parser.add_argument("--again", action="store_true", help="write text and plot from the figures that are there")
    options = parser.parse_args()
    options.into.mkdir(parents=True, exist_ok=True)
    figures = options.into / f"{NAME}.json"
    if not options.again:
        figures.write_text(_as_json(_measured(options.quick)) + "\n", encoding="utf-8")
    document = json.loads(figures.read_text(encoding="utf-8"))
    (options.into / f"{NAME}.md").write_text(text(document), encoding="utf-8")
    draw(document, options.into / f"{NAME}.svg")


def _measured(quick: bool) -> dict[str, Any]:
    motions = tuple(replace(motion, revolutions=motion.revolutions[:1]) for motion in MOTIONS) if quick else MOTIONS
    machine = this_machine()
    return {
        "command": " ".join(["python -m tests.benchmarks.motion", *sys.argv[1:]]),
        "machine": {"cpu": machine.cpu, "cores": machine.cores, "system": machine.system},
        "versions": {"Python": platform.python_version()} | {name: version(name) for name in PACKAGES},
        "motions": measure(lambda line: print(line, file=sys.stderr, flush=True), motions),
        "ensembles": ensembles(),
    }


def _as_json(value: Any, indent: str = "") -> str:
    """Write a line for each list or number, and one for each key above it."""
    if not isinstance(value, dict):
        return json.dumps(value, ensure_ascii=False)
    inner = indent + " "
    entries = (f"{inner}{json.dumps(key, ensure_ascii=False)}: {_as_json(item, inner)}" for key, item in value.items())
    return "{\n" + ",\n".join(entries) + f"\n{indent}}}"


if __name__ == "__main__":
    main()
