"""Measure everything and write docs/motion-benchmarks.md, .json and .svg."""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from inertia.work_precision.machine import this_machine

from ..measure import ROOT
from .ensembles import ensembles
from .loaded_ensembles import loaded_ensembles
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
    parser.add_argument(
        "--ensembles", action="store_true", help="measure many loaded bodies at once only, beside what is there"
    )
    options = parser.parse_args()
    options.into.mkdir(parents=True, exist_ok=True)
    figures = options.into / f"{NAME}.json"
    if options.ensembles:
        figures.write_text(_as_json(_read(figures) | _loaded()) + "\n", encoding="utf-8")
    elif not options.again:
        figures.write_text(_as_json(_measured(options.quick)) + "\n", encoding="utf-8")
    document = _read(figures)
    (options.into / f"{NAME}.md").write_text(text(document), encoding="utf-8")
    draw(document, options.into / f"{NAME}.svg")


def _read(figures: Path) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(figures.read_text(encoding="utf-8"))
    return document


def _measured(quick: bool) -> dict[str, Any]:
    motions = tuple(replace(motion, revolutions=motion.revolutions[:1]) for motion in MOTIONS) if quick else MOTIONS
    return {**_circumstances(), "motions": measure(_say, motions), "ensembles": ensembles(), **_loaded()}


def _loaded() -> dict[str, Any]:
    loaded = _circumstances()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    loaded["methods"] = loaded_ensembles(_say)
    return {"loaded ensembles": loaded}


def _circumstances() -> dict[str, Any]:
    machine = this_machine()
    return {
        "command": " ".join(["python -m tests.benchmarks.motion", *sys.argv[1:]]),
        "machine": {"cpu": machine.cpu, "cores": machine.cores, "system": machine.system},
        "versions": {"Python": platform.python_version()} | {name: version(name) for name in PACKAGES},
    }


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _as_json(value: Any, indent: str = "") -> str:
    """Write a line for each list or number, and one for each key above it."""
    if not isinstance(value, dict):
        return json.dumps(value, ensure_ascii=False)
    inner = indent + " "
    entries = (f"{inner}{json.dumps(key, ensure_ascii=False)}: {_as_json(item, inner)}" for key, item in value.items())
    return "{\n" + ",\n".join(entries) + f"\n{indent}}}"


if __name__ == "__main__":
    main()
