"""`batch`: many files, a row for each, refusals included."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Container, Iterable, Iterator
from contextlib import suppress
from difflib import get_close_matches
from numbers import Integral, Real
from operator import index
from pathlib import Path
from typing import Any

from inertia.batching.answer import READ, WEIGHED, Row, Setup
from inertia.batching.columns import COLUMNS
from inertia.batching.engines import Engine, Processes, in_order, processors
from inertia.batching.sources import OPTIONS, Task, tasks_of
from inertia.errors import GeometryError, InertiaError, ReadError, Remedy, UsageError, Wording
from inertia.mass.density import densities
from inertia.mesh.readers.compressed import UNPACK_LIMIT
from inertia.units import length_unit

_ARGUMENT = Remedy("batch", "verb")  # one of them: the others are worded alike


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
    jobs : worker processes, of dask="local" threads; one for each processor without it
    dask : the address of a Dask scheduler whose workers are used in place of that, "local" for one in this process
    timeout : s that a file may take
    memory : bytes that a file may take (Linux)
    manifest : a manifest of whatever name
    shard : (i, n): every n-th file from the i-th, counted from 1
    **options : of the verb, for all files: unit, density, material, mass, accuracy, ...; a file's own come first, and
        None is as if it were left out

    Raises
    ------
    UsageError : an argument is not usable, a glob matches nothing
    """
    setup = setup_for(verb, options, timeout=timeout, memory=memory)
    tasks = sharded(tasks_for(paths, setup, manifest=manifest), shard)
    engine = engine_for(setup, jobs, dask)
    return (answer.row for answer in in_order(tasks, engine))


def setup_for(
    verb: str,
    options: dict[str, Any],
    *,
    timeout: float | None = None,
    memory: float | None = None,
    offered: Container[str] | None = None,
    wording: Wording = str,
) -> Setup:
    """Return what is asked of all files; raise `UsageError` where it cannot be.

    Parameters
    ----------
    offered : the names of options that there are where this is asked from; all without it
    """
    if not isinstance(verb, str) or verb not in COLUMNS:
        raise UsageError(f"verb is {verb!r}: use one of {', '.join(COLUMNS)}")
    for name in options:
        if name not in OPTIONS[verb]:
            raise _unknown(name, verb, [each for each in OPTIONS[verb] if offered is None or each in offered], wording)
    options = {name: value for name, value in options.items() if value is not None}
    _require_positive("timeout", timeout, "seconds")
    _require_positive("memory", memory, "bytes")
    _require_positive("unpack_limit", options.get("unpack_limit"), "GiB")
    if memory is not None and not Path("/proc/self/status").exists():
        raise UsageError("memory of a process is limited on Linux only: leave the limit out")
    # What is wrong whatever the file is said once.
    if "unit" in options:
        if not isinstance(options["unit"], str):
            raise UsageError(f"unit is {options['unit']!r}: give its name, as 'mm'")
        length_unit(options["unit"])
    if verb == "analyse":
        densities(options.get("density"), options.get("material"), options.get("mass"))
    for name, value in options.items():
        _require_usable(verb, name, value)
    if verb == "analyse":
        _require_together({name: value for name, value in options.items() if name not in (*READ, *WEIGHED)})
    # The worker hands its limit on to the system, which takes whole numbers only.
    limits = None if timeout is None else float(timeout), None if memory is None else math.ceil(memory)
    return Setup(verb, options, *limits, wording)


def _require_usable(verb: str, name: str, value: Any) -> None:
    """Raise `UsageError` where a verb refuses the value of an option whatever the file: it is tried on next to none."""
    with warnings.catch_warnings(), suppress(ReadError, GeometryError, ArithmeticError):
        warnings.simplefilter("ignore", RuntimeWarning)
        try:
            _try(verb, name, value)
        except (TypeError, ValueError) as error:
            if isinstance(error, InertiaError):
                raise
            raise UsageError(f"{name} is {value!r}: give {OPTIONS[verb][name].holds}") from None


def _try(verb: str, name: str, value: Any) -> None:
    if verb == "balance":
        from inertia.balancing.rotor_fields import PlanFields

        PlanFields(**{name: value})
    elif verb == "audit":
        from inertia.auditing.audit import audit

        audit(os.devnull, **{"densities" if name == "density" else name: value})
    elif name in READ:
        from inertia.mesh.read import read

        read(os.devnull, **{name: value})
    elif name not in WEIGHED:
        _analyse({name: value})


def _require_together(options: dict[str, Any]) -> None:
    """Raise `UsageError` where options exclude each other whatever the file, each of which is usable by itself."""
    with warnings.catch_warnings(), suppress(ReadError, GeometryError, ArithmeticError):
        warnings.simplefilter("ignore", RuntimeWarning)
        _analyse(options)


def _analyse(options: dict[str, Any]) -> None:
    """Ask for the analysis of a tetrahedron, of which all may be asked that may be asked of any surface."""
    from inertia.mass.analyse import analyse
    from inertia.mesh.part import Part

    corners, faces = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    analyse(Part.from_arrays(corners, faces, unit="mm"), **options)


def _unknown(name: str, verb: str, known: list[str], wording: Wording) -> UsageError:
    """Return that a verb has no option of that name, and which it has: first the one that may be meant."""

    def said(name: str) -> str:
        return wording(_ARGUMENT._replace(argument=name))

    close = get_close_matches(name, known, n=1)
    others = ", ".join(said(each) for each in known if each not in close)
    first = f"{said(close[0])}, or " if close else ""
    return UsageError(f"{said(name)} is no option of {verb}: use {first}one of {others}")


def _require_positive(name: str, value: float | None, unit: str) -> None:
    if value is not None and not (isinstance(value, Real) and 0 < value < math.inf):
        says = f" is {value!r}: it must be positive and finite, in {unit}"
        raise UsageError(_ARGUMENT._replace(argument=name), says)


def tasks_for(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    setup: Setup,
    *,
    manifest: str | os.PathLike[str] | None = None,
) -> list[Task]:
    """Return the files of a batch."""
    one = isinstance(paths, str | bytes | os.PathLike) or not isinstance(paths, Iterable)
    names: Any = [paths] if one else paths
    listed = None if manifest is None else _path(manifest)
    limit = setup.options.get("unpack_limit")
    return tasks_of(map(_path, names), setup.verb, listed, UNPACK_LIMIT if limit is None else limit)


def _path(name: Any) -> str:
    path = os.fspath(name) if isinstance(name, os.PathLike) else name
    if not isinstance(path, str):
        raise UsageError(f"a path is {name!r}: give it as text or as a pathlib.Path")
    return path


def sharded(tasks: list[Task], shard: tuple[int, int] | None) -> list[Task]:
    """Return the files of a shard, if there are shards: every n-th, so that those of one folder spread."""
    if shard is None:
        return tasks
    try:
        number, count = map(index, shard)
    except (TypeError, ValueError):
        raise UsageError(f"shard is {shard!r}: give two whole numbers, as (3, 8)") from None
    if not 1 <= number <= count:
        which = f"the first is 1, the last {count}" if count > 0 else "there is at least one"
        raise UsageError(f"shard {number} of {count} is none: {which}")
    return tasks[number - 1 :: count]


def engine_for(setup: Setup, jobs: int | None, dask: str | None) -> Callable[[], Engine]:
    """Return what makes what answers: processes here, or workers of a Dask scheduler; of a local one, `jobs` too."""
    if jobs is not None and not (isinstance(jobs, Integral) and jobs >= 1):
        says = f" is {jobs!r}: give the number of worker processes, 1 or more"
        raise UsageError(_ARGUMENT._replace(argument="jobs"), says)
    count = jobs or processors()
    if dask is None:
        return lambda: Processes(setup, count)
    if jobs is not None and isinstance(dask, str) and dask != "local":
        says = f" says nothing of the workers of the scheduler {dask}: leave it out"
        raise UsageError(_ARGUMENT._replace(argument="jobs"), says)
    from inertia.batching.cluster import Cluster

    return lambda: Cluster(setup, dask, count)
