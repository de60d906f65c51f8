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
from inertia.native import LEVEL, SHIPPED, Kernel, Level


def kernels() -> list[Kernel]:
    """Return all kernels of the package, by name."""
    every: dict[Path, Kernel] = {}
    for module in pkgutil.walk_packages(inertia.__path__, "inertia."):
        place = Path(importlib.util.find_spec(module.name).origin or "")  # type: ignore[union-attr]
        if not module.ispkg and " Kernel(" in place.read_text(encoding="utf-8") and module.name != "inertia.native":
            for value in vars(importlib.import_module(module.name)).values():
                both = (value.facets, value.faces) if isinstance(value, BlockKernel) else (value,)
                every |= {each.shipped_as(): each for each in both if isinstance(each, Kernel)}
    return [every[place] for place in sorted(every)]


def files() -> dict[Path, tuple[Kernel, Level]]:
    """Return the files that are shipped, and what each holds."""
    return {each.shipped_as(level): (each, level) for each in kernels() for level in each.levels}


def machine_code(kernel: Kernel, level: Level = LEVEL) -> bytes:
    """Compile one in a process of its own: names in machine code count what was compiled before."""
    os.environ["NUMBA_CPU_NAME"], os.environ["NUMBA_CPU_FEATURES"] = level.name, level.features  # numba reads them once
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as alone:
        return alone.submit(kernel.machine_code, level).result()


def write() -> None:
    """Compile those that have changed, and remove what no kernel is named after."""
    every = files()
    SHIPPED.mkdir(exist_ok=True)
    for old in set(SHIPPED.iterdir()) - set(every):
        old.unlink()
    for file, (kernel, level) in every.items():
        if file.exists():
            continue
        file.write_bytes(machine_code(kernel, level))
        print(f"{file.stat().st_size:7d} {file.name}")


if __name__ == "__main__":
    write()
