"""A batch as a file: rows are kept in parts as they come, and a run that was cut short goes on where it was.

The parts lie in a folder beside the table, ``NAME.parts``, until it is whole. A part has rows, each with the key of its
question (path, verb, options, version) and the files that its answer rests on; where the key is the same and the files
have the same contents, the row counts.
"""

from __future__ import annotations

import errno
import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from contextvars import Context
from hashlib import sha256
from itertools import zip_longest
from pathlib import Path
from typing import Any

from inertia import __version__
from inertia.batching.answer import Answer, Setup, Used, within
from inertia.batching.columns import COLUMNS, SCHEMA
from inertia.batching.engines import Engine, in_order
from inertia.batching.sources import PART, Task
from inertia.batching.summary import Summary
from inertia.errors import ReadError, UsageError, WriteError
from inertia.output import note_input, write_whole
from inertia.tables import read_table, require_as_written, require_table, table_writer

if sys.platform != "win32":
    import fcntl

_SOON, _LATER = 0.5, 0.02
"""s after which a part is written, and the share of the time so far that it is later on: there are few parts, then."""


def write_batch(
    path: Path | None,
    tasks: Sequence[Task],
    setup: Setup,
    engine: Callable[[], Engine],
    *,
    shard: tuple[int, int] | None = None,
    everything: Sequence[Task] = (),
    force: bool = False,
    timings: bool = False,
    progress: Callable[[Summary], None] | None = None,
) -> Summary:
    """Write the table of a batch and return its summary; what an earlier run has left is used.

    Parameters
    ----------
    path : of the table; None to print JSON lines, of which no part is kept
    tasks : the files
    everything : those of all shards, where there are any
    engine : called where there is something to answer for
    shard : which of how many the tasks are
    force : whether a table that is there already, or comes meanwhile, is replaced
    timings : whether the seconds stand in the table, whose bytes are then never the same
    progress : called with the states of all files so far, in a summary, as each is answered for, whatever its turn
    """
    about = {
        "schema": SCHEMA,
        "version": __version__,
        "verb": setup.verb,
        "options": {name: _plain(value) for name, value in setup.options.items()},
        **({} if shard is None else {"shard": list(shard), "files": _list_of(everything)}),
    }
    for task in tasks:
        note_input(Path(task.archive or task.path))
    summary, so_far = Summary(setup.verb, len(tasks)), Summary(setup.verb, len(tasks))
    with _alone(path) as folder:
        if path is not None and not force:
            require_table(str(path))  # another run may have written it while the files were listed
        parts = Parts(folder, setup)
        with table_writer(path, COLUMNS[setup.verb], about) as write, closing(parts):

            def seen(answer: Answer) -> None:
                so_far.states[answer.row["state"]] += 1
                so_far.stored += answer.stored
                if progress is not None:
                    progress(so_far)

            def known() -> Iterator[Task | Answer]:
                for task in tasks:
                    if (answer := parts.answer(task)) is not None:
                        seen(answer)
                    yield answer or task

            def arrived(number: int, answer: Answer) -> None:
                parts.add(tasks[number], answer)
                seen(answer)

            with closing(in_order(known(), engine, arrived)) as answers:
                for answer in answers:
                    summary.count(answer.row, answer.stored)
                    write(answer.row if timings else {**answer.row, "seconds": None})
            if path is not None and not force:
                require_table(str(path))  # another run may have written it meanwhile; the parts are kept then
        parts.remove()
    return summary


@contextmanager
def _alone(table: Path | None) -> Iterator[Path | None]:
    """Yield the folder of the parts of a table, which is this run's as long as the context lasts.

    Raises `UsageError` where it is another one's.
    """
    if table is None:
        yield None
        return
    folder = table.with_name(f"{table.name}.parts")
    with ExitStack() as stack:
        if sys.platform != "win32":
            with suppress(OSError):  # it cannot be used, which is said later, or its file system has no locks
                folder.mkdir(exist_ok=True)
                stack.callback(os.close, lock := os.open(folder, os.O_RDONLY | os.O_DIRECTORY))
                try:
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    raise UsageError(f"another run writes {table}: wait until it ends, or name another table") from None
        try:
            yield folder
        finally:
            with suppress(OSError):  # there are parts in it
                folder.rmdir()


def _list_of(tasks: Sequence[Task]) -> dict[str, Any]:
    """Return how many files there are, and what tells their list from others."""
    digest = sha256(repr([(task.path, sorted(task.options.items())) for task in tasks]).encode()).hexdigest()
    return {"count": len(tasks), "sha256": digest}


def _plain(value: Any) -> Any:
    """Return the value of an option as JSON has it."""
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    uncertainty = getattr(value, "uncertainty", 0.0)
    return f"{float(value)!r}±{uncertainty!r}" if uncertainty else value


class Parts:
    """Rows that were answered for before the table is whole, in a folder; nothing is kept where that is None."""

    def __init__(self, folder: Path | None, setup: Setup) -> None:
        self._folder, self._setup = folder, setup
        self._limits = [setup.timeout, setup.memory]
        with self._faults():
            if folder is not None and folder.exists() and not folder.is_dir():
                says = f"{folder}, where finished rows are kept, is no folder: remove it, or name another table"
                raise UsageError(says)
        self._rows: list[bytes] = []
        self._started = self._saved = time.monotonic()
        self._places: dict[bytes, tuple[Path, int]] = {}
        with self._faults():
            self._paths = self._files()
            for path in self._paths:
                with suppress(FileNotFoundError):  # it was another run's, whose table is whole
                    self._index(path)
            if folder is not None and folder.is_dir() and not os.access(folder, os.W_OK | os.X_OK):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    def answer(self, task: Task) -> Answer | None:
        """Return what was answered for a file, if it still stands."""
        if (place := self._places.get(self._key(task))) is None:
            return None
        path, offset = place
        try:
            with path.open("rb") as file:
                file.seek(offset)
                entry = json.loads(file.readline())
        except FileNotFoundError:  # it was another run's
            return None
        row, files = entry["row"], [Used(*each) for each in entry["files"]]
        # What could not be read may have been written meanwhile; limits may keep any file from an answer.
        if row["state"] == "unreadable" or (row["state"] != "answered" and entry["limits"] != self._limits):
            return None
        unchanged = within(self._setup.timeout, lambda: all(file.unchanged for file in files), False)
        return Answer(row, tuple(files), True) if unchanged else None

    def add(self, task: Task, answer: Answer) -> None:
        """Keep an answer."""
        if self._folder is None:
            return
        entry = {
            "key": self._key(task).hex(),
            "limits": self._limits,
            "row": answer.row,
            "files": answer.files,
        }
        self._rows.append(json.dumps(entry).encode() + b"\n")
        now = time.monotonic()
        if now - self._saved > max(_SOON, _LATER * (now - self._started)):
            self._save()

    def close(self) -> None:
        """Write what there is to be kept."""
        self._save()

    def remove(self) -> None:
        """Remove the parts that were there and that this run has written: the table is whole."""
        with suppress(OSError):
            for path in self._paths:
                path.unlink(missing_ok=True)

    def _files(self) -> list[Path]:
        if self._folder is None or not self._folder.is_dir():
            return []
        return sorted(path for path in self._folder.iterdir() if PART.fullmatch(path.name))

    def _save(self) -> None:
        if self._rows and self._folder is not None:
            with self._faults():
                self._folder.mkdir(exist_ok=True)
            path = self._folder / f"{os.urandom(8).hex()}.jsonl"
            self._paths.append(path)
            Context().run(write_whole, path, b"".join(self._rows))  # at once, and not together with the table
        self._rows.clear()
        self._saved = time.monotonic()

    @contextmanager
    def _faults(self) -> Iterator[None]:
        """Say which folder cannot be used, and what to do about it."""
        try:
            yield
        except OSError as error:
            remedy = "name another table"
            if error.errno == errno.ENOENT:  # the folder of the table has gone meanwhile
                remedy = "name a table in a folder that is there"
            elif self._folder is not None and os.path.lexists(self._folder):
                remedy += ", or remove it"
            says = f"{self._folder}, where finished rows are kept, cannot be used ({error.strerror or error}): {remedy}"
            raise WriteError(says) from None

    def _index(self, path: Path) -> None:
        with path.open("rb") as file:
            offset = 0
            for line in file:
                with suppress(ValueError, KeyError, TypeError):  # what is damaged is answered for again
                    self._places[bytes.fromhex(json.loads(line)["key"])] = path, offset
                offset += len(line)

    def _key(self, task: Task) -> bytes:
        setup = self._setup
        options = sorted(setup.options_of(task).items(), key=str)
        return sha256(repr((__version__, SCHEMA, setup.verb, task.path, options)).encode()).digest()[:16]


def merge(path: Path, tables: Sequence[Path]) -> Summary:
    """Write one table from those of all shards, as one run would have written it, and return its summary.

    Raises `UsageError` where they do not belong together, or one is missing.
    """
    opened = [read_table(each) for each in tables]
    own = ("shard", "files", "sha256")
    abouts = [{name: value for name, value in about.items() if name not in own} for about, _ in opened]
    for each, about in zip(tables, abouts, strict=True):
        if about.get("schema") != SCHEMA or str(about.get("verb")) not in COLUMNS:
            raise ReadError(f"cannot read {each}: it is no table of a batch")
        if about != abouts[0]:
            raise UsageError(f"{each} was made with another version, verb or other options than {tables[0]}")
    shards = [_shard_of(each, about) for each, (about, _) in zip(tables, opened, strict=True)]
    count = shards[0][1] if shards[0] else 0
    numbers = {shard[0] for shard in shards if shard}
    missing = next((number for number in range(1, count + 1) if number not in numbers), None)
    if missing or len(shards) != count or any(shard[1:] != (count,) for shard in shards):
        which = f"shard {missing} of {count} is missing" if missing else "they are not the shards of one batch"
        raise UsageError(f"{which}: give the table of each shard, once")
    lists = [about.get("files") or {} for about, _ in opened]
    for each, files in zip(tables, lists, strict=True):
        if not isinstance(files, dict) or not isinstance(files.get("count"), int):
            raise ReadError(f"cannot read {each}: it does not say how many files there are: run its shard again")
        if files != lists[0]:
            raise UsageError(f"{each} is of another list of files than {tables[0]}: run all shards again on one list")
    verb = abouts[0]["verb"]
    order = sorted(range(count), key=lambda k: shards[k])
    lengths = [0] * count
    summary = Summary(verb, 0)
    with table_writer(path, COLUMNS[verb], {name: abouts[0][name] for name in abouts[0] if name != "columns"}) as write:
        for rows in zip_longest(*(opened[k][1] for k in order)):
            for k, row in zip(order, rows, strict=True):
                if row is not None:
                    lengths[k] += 1
                    summary.files += 1
                    summary.count(row, False)
                    write(row)
        for k in range(count):
            number = shards[k][0]
            if lengths[k] != (wanted := len(range(number - 1, lists[0]["count"], count))):
                raise ReadError(f"cannot read {tables[k]}: it has {lengths[k]} of {wanted} rows: run its shard again")
            require_as_written(tables[k], opened[k][0])
    return summary


def _shard_of(table: Path, about: Mapping[str, Any]) -> tuple[int, ...]:
    """Return which of how many shards a table is; empty where it is none."""
    shard = about.get("shard", [])
    if not isinstance(shard, list) or len(shard) not in (0, 2) or not all(isinstance(k, int) for k in shard):
        raise ReadError(f"cannot read {table}: it is shard {shard!r}, and not one as [3, 8]: run its shard again")
    return tuple(shard)
