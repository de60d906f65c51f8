"""A disk that is full from the n-th write on, for every n of every command that writes: the result is printed all the
same, and no output is half there.

A shim in C stands before the C library's writes (`full_disk.c`); without a C compiler there are no such cases.
"""

from __future__ import annotations

import shutil
import subprocess
from functools import cache
from pathlib import Path

from .documents import ROOT
from .processes import OLD, fault_in_files, outputs, run_process, stray
from .workers import Outcome

SOURCE = Path(__file__).with_suffix(".c")
COMPILER = shutil.which("cc")


@cache
def _shim(folder: Path) -> Path:
    assert COMPILER is not None
    library = folder / "full_disk.so"
    subprocess.run([COMPILER, "-O1", "-shared", "-fPIC", "-o", library, SOURCE, "-ldl"], check=True)
    return library


def _run(kind: int, after: int, folder: Path, before: bool, cold: bool) -> tuple[list[str], list[Path], Path, object]:
    inside, cache_folder, count = folder / "full", folder / "cache", folder / "count"
    shutil.rmtree(inside, ignore_errors=True)
    inside.mkdir()
    if cold:
        shutil.rmtree(cache_folder, ignore_errors=True)
    line, files = outputs(kind, inside, ROOT)
    if before:
        for file in files:
            file.write_bytes(OLD)
        line.append("--force")
    environment = {"LD_PRELOAD": str(_shim(folder)), "SOAK_FULL_AFTER": str(after), "SOAK_COUNT": str(count)}
    environment["INERTIA_CACHE"] = str(cache_folder)
    return line, files, inside, run_process(line, inside, environment=environment, fork=False)


@cache
def _writes(kind: int, folder: Path) -> int:
    """Return how many writes a command makes."""
    _run(kind, 10**9, folder, False, False)
    return int((folder / "count").read_text())


def case(seed: int, number: int, folder: Path) -> Outcome:
    """Let the disk be full from a write on that follows from the number of the case."""
    if COMPILER is None:
        return Outcome("refused")
    kind, before = (number + seed) % 4, bool(number // 4 % 2)
    after = number // 8 % (_writes(kind, folder) + 1)
    line, files, inside, end = _run(kind, after, folder, before, number % 16 == 0)
    told = f"full after {after} writes: "
    if end.code not in (0, 1, 5) or "Traceback" in end.err or "fault of this program" in end.err:
        return Outcome("fault", f"{told}exit code {end.code}: {end.err[-400:]!r} [{line}]")
    if fault := fault_in_files(inside, files, before):
        return Outcome("fault", f"{told}{fault} [{line}]")
    if left := stray(inside, files):
        return Outcome("fault", f"{told}{left} left behind [{line}]")
    if not end.out:
        return Outcome("fault", f"{told}no result was printed, but {end.err[-400:]!r} [{line}]")
    if end.code == 1 and "cannot write" not in end.err:
        return Outcome("fault", f"{told}not said: {end.err[-400:]!r} [{line}]")
    if end.code != 1 and not all(file.exists() and file.read_bytes() != OLD for file in files):
        return Outcome("fault", f"{told}nothing was written, and exit code {end.code} [{line}]")
    return Outcome("refused" if end.code == 1 else "answered")
