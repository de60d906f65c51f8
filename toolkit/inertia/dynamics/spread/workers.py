"""Blocks of draws given to processes of this machine, or to a Dask cluster."""

from __future__ import annotations

import os
import signal
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator
from functools import partial
from typing import TYPE_CHECKING

from inertia.arrays import Float, Progress
from inertia.dynamics.spread.follow import Block, Task, follow
from inertia.errors import GeometryError, Remedy, UsageError, visible
from inertia.scheduler import connected

if TYPE_CHECKING:
    from concurrent.futures import Future

_BLOCK = 2048
"""Draws that are followed together, at most."""

_REPAYS = 3.0  # s of work that is left, from which on processes are started
_SPAN = 0.5  # s that a block should take, so that progress is told and Ctrl-C is heard

_AHEAD, _FIRST = 16, 256  # blocks that a cluster has at least, and draws in the first of them

_task: Task | None = None  # of a worker


def blocks_of(
    task: Task, values: Float, jobs: int | None, dask: str | None, progress: Progress | None
) -> Generator[Block, None, None]:
    """Yield what became of draws (N, k), in blocks, in their order: the same whoever works on them."""
    tell = progress or (lambda done: None)
    if jobs is not None and jobs < 1:
        raise UsageError(f"the number of processes is {jobs}: give 1 or more")
    if dask is not None:
        yield from _by_dask(task, values, dask, jobs, tell)
        return
    done, size = 0, min(8, len(values))
    processes = jobs or os.cpu_count() or 1
    while done < len(values):
        block, seconds = _timed(task, values[done : done + size])
        each = seconds / size
        yield block
        done = min(done + size, len(values))
        tell(done / len(values))
        left = each * (len(values) - done)
        size = max(1, min(_BLOCK, 4 * size, int(_SPAN / each)))
        if processes > 1 and (left > _REPAYS or (jobs and done < len(values))) and size < len(values) - done:
            yield from _by_processes(task, values[done:], size, processes, partial(_ahead, tell, done / len(values)))
            return


def _ahead(tell: Progress, done: float, share: float) -> None:
    tell(done + share * (1.0 - done))


def _by_processes(task: Task, values: Float, size: int, processes: int, tell: Progress) -> Iterator[Block]:
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import get_context

    # A fork has the task as it is, with functions that cannot be pickled.
    context = get_context("fork" if hasattr(os, "fork") else "spawn")
    pool = ProcessPoolExecutor(processes, context, _begin, (task,))
    try:
        yield from _in_order(lambda piece: pool.submit(_follow, piece), values, size, 2 * processes, tell)
    except BrokenProcessPool:
        raise GeometryError(
            "a process that followed draws was ended, by the system for its memory perhaps: ask for fewer ",
            Remedy("ensemble", "jobs"),
            ", or for fewer ",
            Remedy("ensemble", "samples"),
        ) from None
    except BaseException:
        for process in list((pool._processes or {}).values()):
            process.terminate()  # they would finish their blocks first
        raise
    finally:
        pool.shutdown()


def _in_order(
    submit: Callable[[Float], Future[tuple[Block, float]]], values: Float, size: int, ahead: int, tell: Progress
) -> Iterator[Block]:
    """Yield the blocks of pieces of the draws in their order, of which some are worked on ahead."""
    waiting: deque[Future[tuple[Block, float]]] = deque()
    done = first = 0
    while done < len(values):
        while first < len(values) and len(waiting) < ahead:
            waiting.append(submit(values[first : first + size]))
            first += size
        block, seconds = waiting.popleft().result()
        yield block
        done += len(block.states)
        size = max(1, min(_BLOCK, 4 * size, int(_SPAN * len(block.states) / max(seconds, 1e-6))))
        tell(done / len(values))


def _timed(task: Task, values: Float) -> tuple[Block, float]:
    """Follow draws, and return how long that took, s."""
    begin = time.perf_counter()
    return follow(task, values), time.perf_counter() - begin


def _begin(task: Task) -> None:
    global _task
    _task = task
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # whoever started this process ends it
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN if name == "SIGINT" else signal.SIG_DFL)


def _follow(values: Float) -> tuple[Block, float]:
    assert _task is not None
    return _timed(_task, values)


def _by_dask(task: Task, values: Float, address: str, jobs: int | None, tell: Progress) -> Iterator[Block]:
    if jobs is not None and address != "local":
        says = f" says nothing of the workers of the scheduler {visible(address)}: leave it out"
        raise UsageError(Remedy("ensemble", "jobs"), says)
    with connected(address, jobs or os.cpu_count() or 1) as client:
        shared = client.scatter(task, broadcast=True)
        ahead = max(_AHEAD, 2 * sum(client.nthreads().values()))
        yield from _in_order(
            lambda piece: client.submit(_timed, shared, piece, pure=False), values, _FIRST, ahead, tell
        )
