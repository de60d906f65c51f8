"""`batch`: many files, a row for each, refusals included."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

from inertia.batching.answer import Row, Setup
from inertia.batching.columns import COLUMNS
from inertia.batching.engines import Engine, Processes, in_order, processors
from inertia.batching.sources import OPTIONS, Task, tasks_of
from inertia.errors import UsageError
from inertia.mass.density import densities
from inertia.units import length_unit


def batch(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    *,
    verb: str = "analyse",
    jobs: int | None = None,
    dask: str | None = None,
    timeout: float | None = None,
    memory: int | None = None,
    manifest: str | os.PathLike[str] | None = None,
    shard: tuple[int, int] | None = None,
    **options: Any,
) -> Iterator[Row]:
    """Answer for many files in worker processes: yield a row for each, in an order that depends on the names alone.

    Parameters
    ----------
    paths : files, globs (``**`` goes through folders), URLs that fsspec reads, archives (each mesh in them is a file),
        manifests (``.csv`` or ``.parquet`` with a column `path` and columns of options)
    verb : "analyse", "check", "balance" (rotor files) or "audit" (robots)
    jobs : worker processes; one for each processor without it
    dask : the address of a Dask scheduler whose workers are used in place of that, "local" for one in this process
    timeout : s that a file may take
    memory : bytes that a file may take (Linux)
    manifest : a manifest of whatever name
    shard : (i, n): every n-th file from the i-th, counted from 1
    **options : of the verb, for all files: unit, density, material, mass, accuracy, ...; a file's own come first

    Raises
    ------
    UsageError : an argument is not usable, a glob matches nothing
    """
    setup = setup_for(verb, options, timeout=timeout, memory=memory)
    tasks = sharded(tasks_for(paths, setup, manifest=manifest), shard)
    engine = engine_for(setup, jobs, dask)
    return (answer.row for answer in in_order(tasks, engine))


def setup_for(verb: str, options: dict[str, Any], **limits: Any) -> Setup:
    """Return what is asked of all files; raise `UsageError` where it cannot be."""
    if verb not in COLUMNS:
        raise UsageError(f"verb is {verb!r}: use one of {', '.join(COLUMNS)}")
    for name in options:
        if name not in OPTIONS[verb]:
            raise UsageError(f"{name} is no option of {verb}: use one of {', '.join(OPTIONS[verb])}")
    timeout, memory = limits["timeout"], limits["memory"]
    if timeout is not None and not 0 < timeout < float("inf"):
        raise UsageError(f"timeout is {timeout!r}: it must be positive and finite, in seconds")
    if memory is not None:
        if not memory > 0:
            raise UsageError(f"memory is {memory!r}: it must be positive, in bytes")
        if not Path("/proc/self/status").exists():
            raise UsageError("memory of a process is limited on Linux only: leave the limit out")
    # What is wrong whatever the file is said once.
    if "unit" in options:
        length_unit(options["unit"])
    if verb == "analyse":
        densities(options.get("density"), options.get("material"), options.get("mass"))
    return Setup(verb, options, **limits)


def tasks_for(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    setup: Setup,
    *,
    manifest: str | os.PathLike[str] | None = None,
) -> list[Task]:
    """Return the files of a batch."""
    names = [paths] if isinstance(paths, str | os.PathLike) else paths
    listed = None if manifest is None else os.fspath(manifest)
    return tasks_of((os.fspath(name) for name in names), setup.verb, listed)


def sharded(tasks: list[Task], shard: tuple[int, int] | None) -> list[Task]:
    """Return the files of a shard, if there are shards: every n-th, so that those of one folder spread."""
    if shard is None:
        return tasks
    number, count = shard
    if not 1 <= number <= count:
        raise UsageError(f"shard {number} of {count} is none: the first is 1, the last {count}")
    return tasks[number - 1 :: count]


def engine_for(setup: Setup, jobs: int | None, dask: str | None) -> Callable[[], Engine]:
    """Return what makes what answers: `jobs` processes here, or the workers of a Dask scheduler."""
    if jobs is not None and jobs < 1:
        raise UsageError(f"jobs is {jobs}: give the number of worker processes, 1 or more")
    count = jobs or processors()
    if dask is None:
        return lambda: Processes(setup, count)
    from inertia.batching.cluster import Cluster

    return lambda: Cluster(setup, dask, count)
