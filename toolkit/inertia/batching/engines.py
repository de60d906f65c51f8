"""Worker processes that answer for files, and what becomes of a file whose process dies; the same under Dask.

A worker is started once and answers for bundles of files. Whoever dies over a file, or is killed, is replaced, and the
file gets one more try in a fresh process. A file that takes longer than it may costs its process.
"""

from __future__ import annotations

import math
import os
import pickle
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, suppress
from itertools import chain
from pathlib import Path
from typing import NamedTuple, Protocol

import inertia
from inertia.batching.answer import Answer, Setup, within
from inertia.batching.columns import State
from inertia.batching.process import READY
from inertia.batching.sources import Task
from inertia.errors import InertiaError, Remedy
from inertia.output import remove_left_behind, status_of

_BUNDLE = 0.05
"""s that a bundle of files is to take: less costs more in messages, more leaves workers idle at the end."""

_MOST = 64  # files in a bundle
_LOOK = 0.1  # s between looks at what takes too long
_GATHER = 0.01  # s in which answers gather: waking up for each costs more than to write its row
_STARTS = 10  # times that a process may die before it is ready
_JOBS = Remedy("batch", "jobs", "N")

_ALLOCATION = {"MALLOC_MMAP_THRESHOLD_": str(2**25), "MALLOC_TRIM_THRESHOLD_": str(2**26)}
"""What the C library on Linux comes to by itself once 32 MiB were freed: memory is not given back from file to file."""


class _Job(NamedTuple):
    """A file to answer for, what it was `before`, and `spent`, the seconds after which a process died over it."""

    number: int
    task: Task
    spent: float = 0.0
    before: os.stat_result | None = None


class Engine(Protocol):
    """What answers for files, in whatever order; `window` of them are under way at most, and wait for each other."""

    @property
    def window(self) -> int:
        """How many that is."""

    def submit(self, number: int, task: Task) -> None:
        """Have a file answered for."""

    def results(self) -> list[tuple[int, Answer]]:
        """Wait for answers, and return those that there are."""

    def close(self) -> None:
        """End the workers, whatever they do."""


class Processes:
    """Workers on this machine, a thread for each that talks to it; no more of them than files have been submitted.

    Parameters
    ----------
    setup : what is asked of all files
    jobs : workers, at most
    folder : that paths are relative to; "" for the one that this process is in
    """

    window = 4096

    def __init__(self, setup: Setup, jobs: int, folder: str = "") -> None:
        self._setup, self._folder = setup, folder
        self._jobs: queue.SimpleQueue[_Job | None] = queue.SimpleQueue()
        self._answers: queue.SimpleQueue[tuple[int, Answer] | BaseException] = queue.SimpleQueue()
        self._most = jobs
        self._workers: list[_Worker] = []
        self._threads: list[threading.Thread] = []
        self._next_look = 0.0

    def submit(self, number: int, task: Task) -> None:
        """Have a file answered for."""
        self._jobs.put(_Job(number, task))
        if len(self._workers) < self._most:
            worker = _Worker(self._setup, self._folder)
            thread = threading.Thread(target=self._serve, args=(worker,), daemon=True)
            self._workers.append(worker)
            try:
                thread.start()
            except RuntimeError as error:  # the system has no more
                raise _too_many(str(error)) from None
            self._threads.append(thread)

    def results(self) -> list[tuple[int, Answer]]:
        """Wait for answers, and return those that there are."""
        answers: list[tuple[int, Answer]] = []
        while not answers or not self._answers.empty():
            if time.monotonic() >= self._next_look:
                self._next_look = time.monotonic() + _LOOK
                for worker in self._workers:
                    worker.end_if_late()
            try:
                answer = self._answers.get(timeout=_LOOK)
            except queue.Empty:
                continue
            if not answers:
                time.sleep(_GATHER)
            if isinstance(answer, BaseException):
                raise answer
            answers.append(answer)
        return answers

    def close(self) -> None:
        """End the workers, whatever they do, and whoever waits for answers; nothing of theirs is left behind."""
        self._answers.put(RuntimeError("the workers are ended"))
        for worker in self._workers:
            self._jobs.put(None)
            worker.end()
        for thread in self._threads:
            thread.join()
        if self._threads:
            remove_left_behind()

    def _serve(self, worker: _Worker) -> None:
        try:
            while (bundle := self._bundle(worker)) is not None:
                for number, answer in worker.answers(bundle):
                    self._answers.put((number, answer))
        except BaseException as fault:
            self._answers.put(fault)
        finally:
            worker.dispose()

    def _bundle(self, worker: _Worker) -> list[_Job] | None:
        """Wait for a file, and take as many as are answered for in a short while, but no more than a fair share."""
        bundle: list[_Job] = []
        most = min(worker.bundle, 1 + self._jobs.qsize() // (2 * len(self._workers)))
        while len(bundle) < max(1, most):
            try:
                job = self._jobs.get(block=not bundle)
            except queue.Empty:
                break
            if job is None:
                return None
            bundle.append(job)
        return bundle


class _Worker:
    """A process that answers, and its successors."""

    def __init__(self, setup: Setup, folder: str) -> None:
        self.bundle = 1
        self._setup, self._folder = setup, folder
        self._limit = math.inf if setup.timeout is None else setup.timeout
        self._process: subprocess.Popen[bytes] | None = None
        self._since: float | None = None
        self._ended = False

    def answers(self, bundle: Sequence[_Job]) -> Iterator[tuple[int, Answer]]:
        """Yield the answers for files in their order."""
        jobs = self._as_they_are(bundle)
        while jobs and not self._ended:
            process = self._process or self._start()
            assert process.stdin is not None
            assert process.stdout is not None
            started = since = self._since = time.monotonic()
            count = len(jobs)
            try:
                pickle.dump([job.task for job in jobs], process.stdin)
                process.stdin.flush()
                while jobs:
                    answer: Answer = pickle.load(process.stdout)
                    since = self._since = time.monotonic()
                    job = jobs.pop(0)
                    took = answer.row["seconds"]
                    yield job.number, self._timed_out(job, took) if took > self._limit else answer
            except (OSError, EOFError, pickle.UnpicklingError):
                self._since = None
                yield from self._failed(jobs, time.monotonic() - since)
            else:
                self._since = None
                self.bundle = max(1, min(_MOST, int(_BUNDLE * count / (time.monotonic() - started + 1e-9))))

    def _failed(self, jobs: list[_Job], took: float) -> Iterator[tuple[int, Answer]]:
        """Leave the file that the process died over for another try, or yield that there is no answer."""
        if self._ended:
            return
        code = self.dispose()
        job = jobs.pop(0)
        if took > self._limit:
            yield job.number, self._timed_out(job, took)
        elif job.spent:
            how = f"signal {-code}" if code < 0 else f"exit code {code}"
            why = f"the process that answered for it died ({how}), and so did the second one: report the file"
            yield job.number, self._row_of(job, "crashed", why, job.spent + took)
        else:
            jobs.insert(0, job._replace(spent=took))

    def _timed_out(self, job: _Job, took: float) -> Answer:
        why = f"it took longer than the {self._setup.timeout:g} s that a file may take"
        return self._row_of(job, "timed_out", why, took)

    def _row_of(self, job: _Job, state: State, why: str, took: float) -> Answer:
        return self._setup.failed(job.task, state, why, took, job.before, self._folder)

    def _as_they_are(self, bundle: Sequence[_Job]) -> list[_Job]:
        """Return files with what they are now, where that is known in time."""
        names = [Path(self._folder, job.task.file) for job in bundle]
        unknown: list[os.stat_result | None] = [None] * len(names)
        statuses = within(self._setup.timeout, lambda: list(map(status_of, names)), unknown)
        return [job._replace(before=status) for job, status in zip(bundle, statuses, strict=True)]

    def _start(self) -> subprocess.Popen[bytes]:
        """Return a process that is ready to answer."""
        code = "import sys; sys.path.append(sys.argv[1]); from inertia.batching.process import main; main()"
        command = [sys.executable, "-P", "-c", code, str(Path(inertia.__file__).parent.parent)]
        alone = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
        quiet = None if os.environ.get("INERTIA_TRACEBACK") == "1" else subprocess.DEVNULL
        for _ in range(_STARTS):
            try:
                process = subprocess.Popen(
                    command,
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=quiet,
                    env={**_ALLOCATION, **os.environ, **alone},
                    cwd=self._folder or None,
                )
            except OSError as error:
                raise _too_many(error.strerror or str(error)) from None
            self._process = process
            if self._ended:
                process.kill()
            assert process.stdin is not None
            assert process.stdout is not None
            try:
                pickle.dump(self._setup, process.stdin)
                process.stdin.flush()
                if pickle.load(process.stdout) == READY:
                    return process
            except (OSError, EOFError, pickle.UnpicklingError):
                self.dispose()
                if self._ended:
                    break
        raise InertiaError(
            "no worker process could be started: set INERTIA_TRACEBACK=1 to see what it says", code="workers"
        )

    def end_if_late(self) -> None:
        """End the process where its file takes longer than it may; its successor goes on."""
        since, process = self._since, self._process
        if since is not None and process is not None and time.monotonic() - since > self._limit:
            process.kill()

    def end(self) -> None:
        """End the process for good."""
        self._ended = True
        if (process := self._process) is not None:
            process.kill()

    def dispose(self) -> int:
        """End the process and close what leads to it; return its exit code."""
        process, self._process = self._process, None
        if process is None:
            return 0
        process.kill()
        for stream in (process.stdin, process.stdout):
            with suppress(OSError):  # what was not read any more cannot be written
                if stream is not None:
                    stream.close()
        return process.wait()


def _too_many(why: str) -> InertiaError:
    return InertiaError(f"not all worker processes could be started ({why}): ask for fewer by ", _JOBS, code="workers")


def in_order(
    tasks: Iterable[Task | Answer], engine: Callable[[], Engine], arrived: Callable[[int, Answer], None] | None = None
) -> Generator[Answer, None, None]:
    """Yield the answers in the order of the files; no more than a window of them are under way.

    Parameters
    ----------
    tasks : files, or answers that there are already
    engine : called where there is something to answer for
    arrived : called with the number of a file and its answer as soon as that is there, whatever its turn
    """
    ready: dict[int, Answer] = {}
    first = last = 0
    with ExitStack() as stack:
        at_work: Engine | None = None
        for task in chain(tasks, [None]):
            if isinstance(task, Answer):
                ready[last] = task
            elif task is not None:
                if at_work is None:
                    at_work = stack.enter_context(closing(engine()))
                at_work.submit(last, task)
            last += task is not None
            while first < last:
                if first in ready:
                    yield ready.pop(first)
                    first += 1
                elif at_work is not None and (task is None or last - first >= at_work.window):
                    for number, answer in at_work.results():
                        ready[number] = answer
                        if arrived is not None:
                            arrived(number, answer)
                else:
                    break


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
