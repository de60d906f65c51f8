"""From a binary STL file to the answer, closedness included: one fresh process each."""

from __future__ import annotations

import json
import sys
import sysconfig
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from .measure import Cost, cost, python_module

HERE = Path(__file__).resolve().parent
DATA = HERE / "data"
LIMIT = 900.0
"""Seconds of wall time after which a process is stopped."""
ROUNDS = 5
NO_SPINNING = {"OPENBLAS_THREAD_TIMEOUT": "4"}
"""For every program: idle threads of numpy's BLAS sleep at once, where as a rule they spin for 0.1 s at first."""
ENOUGH = 15.0
"""Seconds of wall time after which a program is not run again on the same file."""


@dataclass(frozen=True)
class Program:
    """A command that prints the volume in the file's unit cubed, or JSON; `limit` is the most triangles it takes."""

    name: str
    command: tuple[str, ...]
    needs: str = "inertia"
    limit: float = float("inf")
    empty_cache: bool = False


def _python(name: str, script: str, **options: Any) -> Program:
    return Program(name, (sys.executable, str(HERE / "programs" / script)), **options)


def programs() -> list[Program]:
    """Return what is measured; the first is what the others are compared with."""
    command = str(Path(sysconfig.get_path("scripts")) / "inertia")
    return [
        _python("inertia, Python", "with_inertia.py"),
        _python("… with an empty cache of kernels", "with_inertia.py", empty_cache=True),
        Program("`inertia analyse --json`, with SHA-256", (command, "analyse", "--json", "--unit", "m")),
        _python("libigl", "with_libigl.py", needs="igl"),
        _python("VTK", "with_vtk.py", needs="vtkmodules"),
        _python("trimesh", "with_trimesh.py", needs="trimesh"),
        _python("MuJoCo", "with_mujoco.py", needs="mujoco", limit=200_000),
    ]


def stl_file(folder: Path, count: int, order: str = "") -> Path:
    """Return the file of a wavy torus, made if it is not there yet; for `order` see `meshes.write_stl`."""
    path = folder / f"{'_'.join(['torus', str(count), *order.split()])}.stl"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        python_module("tests.benchmarks.meshes", path, count, order, env={})
    return path


def warm_up(path: Path, environment: dict[str, str]) -> None:
    """Fill the cache of compiled kernels, by analysing a file that is large enough."""
    _run(programs()[0], path, environment)


def whole(
    path: Path,
    count: int,
    environment: dict[str, str],
    say: Callable[[str], None],
    wanted: Callable[[str], bool] = lambda name: True,
    rounds: int = ROUNDS,
) -> dict[str, Any]:
    """Measure programs on one file: its size in MB and {program: {"cpu", "wall", "peak", "volume"} or a reason}."""
    with path.open("rb") as file:  # into the page cache, and no more than a little into this process
        while file.read(1 << 20):
            pass
    runs: dict[str, list[Cost]] = {}
    reasons: dict[str, str] = {}
    for _ in range(rounds):
        for program in programs():
            if not wanted(program.name):
                continue
            done = runs.setdefault(program.name, [])
            if program.name in reasons or sum(run.wall for run in done) > ENOUGH:
                continue
            if find_spec(program.needs) is None:
                reasons[program.name] = "not installed"
            elif count > program.limit:
                reasons[program.name] = "refused"
            elif (run := _run(program, path, environment)) is None:
                reasons[program.name] = f"over {LIMIT:.0f} s"
            else:
                done.append(run)
                say(f"{program.name}: {run.cpu:.2f} s")
    rows: dict[str, Any] = {}
    for name, done in runs.items():
        if not done:
            rows[name] = reasons[name]
            continue
        rows[name] = {
            "cpu": [round(run.cpu, 3) for run in done],
            "wall": [round(run.wall, 3) for run in done],
            "peak": [round(run.peak, 1) for run in done],
            "volume": _volume(done[0].printed),
        }
    return {"file_mb": round(path.stat().st_size / 1e6, 1), "programs": rows}


def _run(program: Program, path: Path, environment: dict[str, str]) -> Cost | None:
    command = [*program.command, str(path)]
    environment = environment | NO_SPINNING
    if not program.empty_cache:
        return cost(command, environment, LIMIT)
    with tempfile.TemporaryDirectory(prefix="inertia-empty-") as empty:
        return cost(command, environment | {"INERTIA_CACHE": empty}, LIMIT)


def _volume(printed: str) -> float:
    return float(json.loads(printed)["volume"] if printed.startswith("{") else printed)
