"""The machine that times were measured on."""

from __future__ import annotations

import os
import platform
from pathlib import Path

import numpy as np

from inertia.records import dataclass


@dataclass(frozen=True)
class Machine:
    """Name of the processor, cores that this process may use, versions of Python and numpy, operating system."""

    cpu: str
    cores: int
    python: str
    numpy: str
    system: str

    def __str__(self) -> str:
        cores = f"{self.cores} core{'' if self.cores == 1 else 's'}"
        return f"{self.cpu}, {cores}, {self.system}, Python {self.python}, numpy {self.numpy}"


def this_machine() -> Machine:
    """Describe the machine that this process runs on."""
    return Machine(_cpu(), _cores(), platform.python_version(), np.__version__, platform.system())


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor()) or platform.machine()


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
