"""Compiled kernels in the cache with bits flipped, cut short or exchanged: compiled again, never run, never a crash."""

from __future__ import annotations

import os
import shutil
from functools import cache
from pathlib import Path

import numpy as np

from .documents import ROOT
from .processes import run_process
from .workers import Outcome

_LINE = ["tumble", str(ROOT / "t_handle.stl"), "--spin", "1,2,3", "--for", "300", "--method", "Taylor"]
_LINE += ["--accuracy", "1e-6", "--samples", "3"]


@cache
def _cached(folder: Path) -> tuple[dict[str, bytes], str]:
    """Return the files of a cache with one kernel, and what the command prints that uses it."""
    store = folder / "store"
    end = run_process(_LINE, folder / "x", environment={"INERTIA_CACHE": str(store)}, fork=False)
    assert end.code == 0, end
    files = {file.name: file.read_bytes() for file in store.iterdir() if file.is_file()}
    assert any(name.endswith(".kernel") for name in files), files.keys()
    return files, end.out


def case(seed: int, number: int, folder: Path) -> Outcome:
    """Damage a file of the cache, and run the command that loads it."""
    rng = np.random.default_rng([seed, number])
    files, answer = _cached(folder)
    store = folder / "damaged"
    shutil.rmtree(store, ignore_errors=True)
    store.mkdir(mode=0o700)
    names = sorted(files)
    chosen = names[rng.integers(len(names))]
    for name, data in files.items():
        changed = bytearray(data)
        if name == chosen:
            at = int(rng.integers(len(data)))
            match rng.integers(5):
                case 0 | 1 | 2:
                    changed[at] ^= 1 << int(rng.integers(8))
                case 3:
                    del changed[at:]
                case 4:
                    changed[at:at] = rng.bytes(int(rng.integers(1, 9)))
        descriptor = os.open(store / name, os.O_WRONLY | os.O_CREAT, 0o600)
        os.write(descriptor, changed)
        os.close(descriptor)
    end = run_process(_LINE, folder / "x", environment={"INERTIA_CACHE": str(store)}, fork=False)
    if end.code != 0 or end.out != answer:
        return Outcome("fault", f"{chosen}: exit code {end.code}: {end.err[-300:]!r}")
    if "Traceback" in end.err or end.err.count("\n") > 1 or (end.err and not end.err.startswith("inertia: ")):
        return Outcome("fault", f"{chosen}: {end.err[-300:]!r}")
    return Outcome("refused" if end.err else "answered")
