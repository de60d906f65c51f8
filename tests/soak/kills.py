"""Commands that write files, ended at any moment by SIGKILL, SIGTERM or SIGINT: all outputs are there, or none."""

from __future__ import annotations

import os
import shutil
import signal
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np

from .documents import ROOT
from .processes import OLD, fault_in_files, outputs, run_process, stray
from .workers import Outcome

_START = 0.3
"""s, in which Python starts and nothing of ours runs yet; it is ended there with a trace of its own."""


@cache
def _length(kind: int, folder: Path) -> float:
    """Return how long a command takes that nobody ends, s."""
    inside = folder / "length"
    inside.mkdir(exist_ok=True)
    line, _ = outputs(kind, inside, ROOT)
    end = run_process([*line, "--force"], inside)
    assert end.code in (0, 5), end
    return end.seconds


def case(seed: int, number: int, folder: Path) -> Outcome:
    """End a command at a moment of its own; after SIGKILL the next run cleans up."""
    rng = np.random.default_rng([seed, number])
    kind, fork = int(rng.integers(4)), rng.random() < 0.8
    inside = folder / "kill"
    shutil.rmtree(inside, ignore_errors=True)
    inside.mkdir()
    line, files = outputs(kind, inside, ROOT)
    before = bool(rng.random() < 0.5)
    if before:
        for file in files:
            file.write_bytes(OLD)
        line.append("--force")
    how = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)[rng.integers(3)]
    delay = rng.random() * _length(kind, folder) + (0.0 if fork else _START)

    def kill(pid: int) -> None:
        time.sleep(delay)
        with suppress(ProcessLookupError):
            os.kill(pid, how)

    end = run_process(line, inside, meanwhile=kill, fork=fork)
    expected = {signal.SIGKILL: (-9,), signal.SIGTERM: (143, -15), signal.SIGINT: (130, -2)}[how]
    ended = end.code in expected
    if not ended and end.code not in (0, 5):
        return Outcome("fault", f"{how.name} after {delay:.3f} s: exit code {end.code}: {end.err[-300:]!r} [{line}]")
    if fault := fault_in_files(inside, files, before):
        return Outcome("fault", f"{how.name} after {delay:.3f} s: {fault} [{line}]")
    if "Traceback" in end.err or "Exception" in end.err:
        return Outcome("fault", f"{how.name} after {delay:.3f} s: {end.err[-300:]!r} [{line}]")
    if how == signal.SIGKILL and stray(inside, files):
        again = run_process([*line, *([] if before else ["--force"])], inside)
        if again.code not in (0, 5):
            return Outcome("fault", f"the next run ended with {again.code}: {again.err[-300:]!r}")
    if left := stray(inside, files):
        return Outcome("fault", f"{how.name} after {delay:.3f} s: {left} left behind [{line}]")
    return Outcome("refused" if ended else "answered")
