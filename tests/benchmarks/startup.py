"""What it costs to start: CPU seconds of small commands, each in a process of its own."""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path
from typing import Any

from .measure import ROOT, cost

ROUNDS = 10
LIMIT = 60.0
SAMPLE = ROOT / "meshes" / "inertia_meshes" / "t_handle.stl"


def startup(environment: dict[str, str]) -> dict[str, Any]:
    """Measure each command ten times, in turn: {command: [CPU seconds]}."""
    inertia = str(Path(sysconfig.get_path("scripts")) / "inertia")
    commands = {
        "`python -c pass`": [sys.executable, "-c", "pass"],
        "`python -c 'import numpy'`": [sys.executable, "-c", "import numpy"],
        "`inertia --help`": [inertia, "--help"],
        f"`inertia analyse {SAMPLE.name}`": [inertia, "analyse", "--unit", "mm", str(SAMPLE)],
    }
    seconds: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(ROUNDS):
        for name, command in commands.items():
            if (run := cost(command, environment, LIMIT)) is None:
                raise SystemExit(f"{name} is not done in {LIMIT:.0f} s")
            seconds[name].append(round(run.cpu, 3))
    return seconds
