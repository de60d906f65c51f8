"""What a process costs: CPU time, wall time and peak memory, as the system counts them.

A new process inherits the peak memory of the one that starts it. So that one stays small: whatever needs numpy runs
in a process of its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Cost:
    """CPU (user and system) and wall time in s, peak resident memory in MB (10⁶ bytes), what was printed."""

    cpu: float
    wall: float
    peak: float
    printed: str


def cost(command: Sequence[str], env: Mapping[str, str], limit: float) -> Cost | None:
    """Run a command; None if it is not done after `limit` seconds. Raises `SystemExit` where it fails."""
    begin = time.perf_counter()
    process = subprocess.Popen(
        command, cwd=ROOT, env={**os.environ, **env}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stderr is not None
    stopper = threading.Timer(limit, process.kill)
    stopper.start()
    with process.stdout, process.stderr:
        printed, complaint = process.stdout.read(), process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - begin
    late = not stopper.is_alive()
    stopper.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    if late:
        return None
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command)} ended with {process.returncode}: {complaint.strip()[-500:]}")
    unit = 1 if sys.platform == "darwin" else 1024
    return Cost(usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss * unit / 1e6, printed)


def python_module(module: str, *arguments: object, env: Mapping[str, str]) -> str:
    """Run a module of this package in a process of its own and return what it prints."""
    command = [sys.executable, "-m", module, *map(str, arguments)]
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, **env}, stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout
