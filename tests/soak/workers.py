"""Cases run in worker processes, each within a limit of time and memory: a hang or a crash is told of its own case."""

from __future__ import annotations

import itertools
import multiprocessing
import os
import resource
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, NamedTuple

TIME_LIMIT = 20.0
"""s of computing, for one case; what computes for twice that is ended."""

PATIENCE = 900.0
"""s by the clock, for one case, on a machine that does much else."""

MEMORY_LIMIT = 12 * 2**30
"""Bytes of addresses that a worker may have."""

_CHUNK = 50
_FORK = multiprocessing.get_context("fork")


class Outcome(NamedTuple):
    """How a case went: "answered", "refused" or "fault", and what a fault says of itself."""

    kind: str
    fault: str = ""


Case = Callable[[int], Outcome]


@dataclass
class Tally:
    """How many cases went how, the faults by number of the case, and the slowest case (s, number)."""

    counts: Counter[str] = field(default_factory=Counter)
    faults: dict[int, str] = field(default_factory=dict)
    slowest: tuple[float, int] = (0.0, -1)

    def add(self, number: int, outcome: Outcome, seconds: float) -> None:
        """Count a case."""
        self.counts[outcome.kind] += 1
        if outcome.kind == "fault":
            self.faults[number] = outcome.fault
        self.slowest = max(self.slowest, (seconds, number))


class _Worker:
    """A process that runs chunks of cases, one after the other."""

    def __init__(self, case: Case, memory: int) -> None:
        self.connection, other = _FORK.Pipe()
        self.process = _FORK.Process(target=_serve, args=(case, memory, other), daemon=True)
        self.process.start()
        other.close()
        self.todo: list[int] = []
        self.since, self.before = time.monotonic(), 0.0

    def give(self, numbers: list[int]) -> None:
        self.todo, self.since, self.before = numbers, time.monotonic(), self.computed()
        self.connection.send(numbers)

    def computed(self) -> float:
        """Return the seconds that the process has computed; 0 where the system does not tell."""
        try:
            fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            return 0.0
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def end(self) -> int | None:
        """End the process, and return what it ended with."""
        self.process.join(0.5)
        if self.process.is_alive():
            os.killpg(self.process.pid or 0, signal.SIGKILL)
        self.process.join()
        self.connection.close()
        return self.process.exitcode


def run_cases(
    case: Case,
    numbers: Iterable[int],
    *,
    processes: int = 1,
    memory: int = MEMORY_LIMIT,
    together: int = _CHUNK,
    report: Callable[[Tally], Any] = lambda _: None,
) -> Tally:
    """Run `case(number)` for every number in worker processes; `report` is called about once a second."""
    tally = Tally()
    source = iter(numbers)
    waiting: list[list[int]] = []

    def chunk() -> list[int]:
        return waiting.pop() if waiting else list(itertools.islice(source, together))

    workers: list[_Worker] = []
    for _ in range(processes):
        if todo := chunk():
            workers.append(_Worker(case, memory))
            workers[-1].give(todo)
    last = time.monotonic()
    while workers:
        wait([worker.connection for worker in workers], timeout=0.5)
        for place, worker in enumerate(list(workers)):
            fault = _collect(worker, tally)
            if fault is None and worker.todo:
                continue
            rest = worker.todo
            if fault is not None:
                tally.add(rest[0], Outcome("fault", fault), time.monotonic() - worker.since)
                if rest[1:]:
                    waiting.append(rest[1:])
                worker = _Worker(case, memory)
                workers[place] = worker
            if todo := chunk():
                worker.give(todo)
        for worker in [worker for worker in workers if not worker.todo]:
            worker.connection.send([])
            worker.end()
            workers.remove(worker)
        if time.monotonic() - last > 1:
            report(tally)
            last = time.monotonic()
    return tally


def _collect(worker: _Worker, tally: Tally) -> str | None:
    """Count what a worker has done, and return what is the matter with it: it is dead, or takes too long."""
    try:
        while worker.connection.poll():
            number, outcome, seconds = worker.connection.recv()
            worker.todo.remove(number)
            worker.since, worker.before = time.monotonic(), worker.computed()
            tally.add(number, outcome, seconds)
    except (EOFError, OSError):
        code = worker.end()
        return f"the process ended with {code}"
    if worker.todo and (computed := worker.computed() - worker.before) > 2 * TIME_LIMIT:
        worker.end()
        return f"no answer in {computed:.0f} s of computing"
    if worker.todo and time.monotonic() - worker.since > PATIENCE:
        worker.end()
        return f"no answer in {PATIENCE:g} s"
    return None


def _computed() -> float:
    """Return the seconds of computing of this process and those that it has waited for."""
    return sum(os.times()[:4])


def _serve(case: Case, memory: int, connection: Connection) -> None:
    os.setpgid(0, 0)
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory(prefix="inertia-soak-") as folder, open(f"{folder}/printed", "wb") as printed:  # noqa: PTH123
        os.chdir(folder)
        for stream in (1, 2):
            os.dup2(printed.fileno(), stream)
        size = 0
        while numbers := connection.recv():
            for number in numbers:
                began = _computed()
                try:
                    outcome = case(number)
                except Exception as error:  # any at all is a fault of what is tested, or of the case
                    outcome = Outcome("fault", f"{type(error).__name__}: {error}")
                if (now := os.fstat(1).st_size) > size:
                    outcome, size = Outcome("fault", f"{now - size} bytes printed past Python"), now
                if (seconds := _computed() - began) > TIME_LIMIT:
                    outcome = Outcome("fault", f"{seconds:.0f} s of computing")
                connection.send((number, outcome, seconds))
