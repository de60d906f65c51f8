"""The workers of a Dask scheduler answer for files: each thread of theirs has a worker process, as on one machine.

So a file that takes its process with it costs that process and not the Dask worker; where a Dask worker dies, the
scheduler gives its bundles to another one.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from inertia.batching.answer import Answer, Setup
from inertia.batching.engines import Processes
from inertia.batching.sources import Task, is_url
from inertia.errors import InertiaError, visible
from inertia.scheduler import connected, finished, sent, threads

_BUNDLE = 0.5
"""s that a bundle of files is to take: a task of Dask's costs some milliseconds."""

_FIRST, _MOST = 4, 256  # files in the first bundles, and in any


class Cluster:
    """The workers of a Dask scheduler.

    Parameters
    ----------
    setup : what is asked of all files
    address : of the scheduler, "local" for one in this process
    jobs : threads of that one
    """

    def __init__(self, setup: Setup, address: str, jobs: int) -> None:
        self._setup, self._packed, self._run = setup, pickle.dumps(setup), os.urandom(16)
        self._folder = ""
        with suppress(OSError):  # it has been removed
            self._folder = str(Path.cwd())
        self._bundle: list[tuple[int, Task]] = []
        self._size: int | None = None
        self._sent: dict[str, tuple[Any, list[tuple[int, Task]]]] = {}
        with ExitStack() as stack:
            self._client = client = stack.enter_context(connected(address, jobs))
            self._threads = max(1, threads(client))
            import distributed

            self._done = distributed.as_completed(loop=client.loop, with_results=True, raise_errors=False)
            self._stack = stack.pop_all()

    @property
    def window(self) -> int:
        """Files that are under way at most: enough for all threads there are, and few until it is known how long."""
        if self._size is None:
            return 2 * self._threads * _FIRST
        return max(4096, 4 * self._threads * self._size)

    def submit(self, number: int, task: Task) -> None:
        """Have a file answered for."""
        self._bundle.append((number, task))
        if len(self._bundle) >= (self._size or _FIRST):
            self._send()

    def results(self) -> list[tuple[int, Answer]]:
        """Wait for answers, and return those that there are."""
        self._send()
        answers: list[tuple[int, Answer]] = []
        while not answers:
            for future, result in finished(self._done, self._client):
                _, bundle = self._sent.pop(future.key)
                if isinstance(result, list):  # what is at hand counts, whatever becomes of the scheduler
                    answers += zip([number for number, _ in bundle], result, strict=True)
                elif len(bundle) > 1:  # its worker died more often than the scheduler allows: one file may do that
                    for each in bundle:
                        self._bundle.append(each)
                        self._send()
                else:
                    answers += [(number, self._crashed(task, future)) for number, task in bundle]
        seconds = sum(answer.row["seconds"] or 0.0 for _, answer in answers)
        self._size = max(1, min(_MOST, int(_BUNDLE * len(answers) / (seconds + 1e-9))))
        self._threads = max(1, threads(self._client))
        return answers

    def close(self) -> None:
        """Have nothing answered for any more, and end the worker processes, whatever they do."""
        with self._stack, suppress(Exception):  # where the scheduler has gone, so have its workers
            self._client.cancel([future for future, _ in self._sent.values()])
            self._client.run(sent(end_run, self._run), on_error="ignore")

    def _send(self) -> None:
        if self._bundle:
            tasks = [task for _, task in self._bundle]
            call = sent(answer_bundle, self._run, self._packed, self._folder, tasks)
            future = self._client.submit(call, pure=False)
            self._sent[future.key] = future, self._bundle
            self._bundle = []
            self._done.add(future)

    def _crashed(self, task: Task, future: Any) -> Answer:
        why = f"the Dask workers that answered for it died ({visible(str(future.exception()))})"
        return self._setup.failed(task, "crashed", why)


class _Run:
    """The worker processes that this Dask worker has for a run; `idle` are those that wait for more."""

    def __init__(self) -> None:
        self.all: list[Processes] = []
        self.idle: list[Processes] = []
        self.ended = False


_runs: dict[bytes, _Run] = {}


def answer_bundle(run: bytes, packed: bytes, folder: str, tasks: Sequence[Task]) -> list[Answer]:
    """Return the answers for files, in their order, from a worker process of this one.

    Paths are relative to the folder that the run was started in.
    """
    if not os.access(folder, os.X_OK):
        _require_absolute(tasks, folder)
        folder = os.sep  # where what else may be relative leads nowhere
    own = _runs.setdefault(run, _Run())
    try:
        engine = own.idle.pop()
    except IndexError:
        engine = Processes(pickle.loads(packed), 1, folder)
        own.all.append(engine)
    try:
        if own.ended:  # looked at when `end_run` would find the engine
            raise RuntimeError("the run is over")
        for number, task in enumerate(tasks):
            engine.submit(number, task)
        answers: dict[int, Answer] = {}
        while len(answers) < len(tasks):
            answers.update(engine.results())
    except BaseException:
        engine.close()
        raise
    own.idle.append(engine)
    return [answers[number] for number in range(len(tasks))]


def _require_absolute(tasks: Sequence[Task], folder: str) -> None:
    """Raise `InertiaError` where a path is relative to a folder that this machine has not."""
    import distributed

    for task in tasks:
        if not (Path(task.file).is_absolute() or is_url(task.file)):
            raise InertiaError(
                f"the Dask worker at {distributed.get_worker().address} has no folder {visible(folder)}, which "
                f"{visible(task.path)} is relative to: give paths that begin with {os.sep} and lead to the files there",
                code="workers",
            )


def end_run(run: bytes) -> None:
    """End the worker processes of a run, those at work too, and have none started for it any more."""
    own = _runs.setdefault(run, _Run())
    own.ended = True
    for engine in own.all:
        engine.close()
    own.all.clear()
    own.idle.clear()
