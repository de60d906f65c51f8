"""Write the machine code that is shipped, `inertia/compiled`: ``python tests/compile_kernels.py`` on Linux, x86-64.

Python 3.11 with the numba and llvmlite of `constraints.txt` writes the same bytes on any such machine.
"""

from __future__ import annotations

import importlib.util
import multiprocessing
import os
import pkgutil
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import inertia
from inertia.mass.triangles.kernels import BlockKernel
from inertia.native import LEVEL, SHIPPED, Kernel


def kernels() -> list[Kernel]:
    """Return all kernels of the package, by name."""
    every: dict[Path, Kernel] = {}
    for module in pkgutil.walk_packages(inertia.__path__, "inertia."):
        place = Path(importlib.util.find_spec(module.name).origin or "")  # type: ignore[union-attr]
        if not module.ispkg and " Kernel(" in place.read_text(encoding="utf-8") and module.name != "inertia.native":
            for value in vars(importlib.import_module(module.name)).values():
                both = (value.facets, value.faces) if isinstance(value, BlockKernel) else (value,)
                every |= {each.shipped_as: each for each in both if isinstance(each, Kernel)}
    return [every[place] for place in sorted(every)]


def machine_code(kernel: Kernel) -> bytes:
    """Compile one in a process of its own: names in machine code count what was compiled before."""
    os.environ["NUMBA_CPU_NAME"], os.environ["NUMBA_CPU_FEATURES"] = LEVEL, ""  # which numba reads once
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as alone:
        return alone.submit(kernel.machine_code, LEVEL).result()


def write() -> None:
    """Compile those that have changed, and remove what no kernel is named after."""
    every = kernels()
    SHIPPED.mkdir(exist_ok=True)
    for old in set(SHIPPED.iterdir()) - {each.shipped_as for each in every}:
        old.unlink()
    for each in every:
        if each.shipped_as.exists():
            continue
        each.shipped_as.write_bytes(machine_code(each))
        print(f"{each.shipped_as.stat().st_size:7d} {each.shipped_as.name}")


if __name__ == "__main__":
    write()
