"""Writing recordings: columns in blocks to a private stream, into a file that is whole or not there."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inertia.arrays import Float
from inertia.errors import InertiaError
from inertia.output import whole
from inertia.recording.entities import TIMELINE

if TYPE_CHECKING:
    import rerun as rr
    import rerun.blueprint as rrb

BLOCK = 65_536
"""Rows of a chunk: as many as are turned into columns at once, so that memory does not grow with the run."""
PIPES = Path("/dev/fd")
"""Where the system names the ends of a pipe."""

_LOOKED_AT = 2000  # samples at which series are compared
_NARROW, _WIDER = 1.5, 2.0  # points, of a line, and more for each line that lies on it
_SAME, _OFTEN = 0.01, 0.2  # of the height of a plot, up to which lines are one, and of the time
_PATIENCE = 600.0  # seconds for one block to reach the disk
_READ = 1 << 20

Columns = Callable[[slice], Any]
"""What makes the columns of a block of rows."""


class Recording:
    """A stream that is open for writing; all that moves goes in by columns, on the timeline of the run.

    On it a second stands for `second` s of the run; `wait` returns when what was written is out of memory.

    Attributes
    ----------
    live : whether it goes to a viewer
    """

    def __init__(
        self, stream: rr.RecordingStream, second: float = 1.0, wait: Callable[[rr.RecordingStream], None] | None = None
    ) -> None:
        self._stream = stream
        self._tick = second * 1e-9
        self._wait = wait or _written
        self.live = wait is not None

    def static(self, path: str, *archetypes: Any) -> None:
        """Write what does not change."""
        self._stream.log(path, *archetypes, static=True)

    def columns(self, path: str, time: Float, *columns: Columns, block: int = BLOCK) -> None:
        """Write a row for each time (n,) in s, block by block; each of `columns` makes some of a block's columns."""
        import rerun as rr

        for rows in blocks(len(time), block):
            nanoseconds = np.round(time[rows] / self._tick).astype("timedelta64[ns]")
            index = [rr.TimeColumn(TIMELINE, duration=nanoseconds)]
            chunk = [column for make in columns for column in make(rows)]
            self._stream.send_columns(path, index, chunk)
            self.flush()

    def scalars(
        self,
        path: str,
        time: Float,
        values: Callable[[slice], Float],
        names: Sequence[str],
        colors: Sequence[Sequence[int]],
        *,
        joined: bool = True,
    ) -> None:
        """Write series of numbers: `values` returns (k, len(names)) for a block; each name ends in its unit.

        They are drawn as lines, or as points that are not joined.
        """
        import rerun as rr

        def columns(block: slice) -> Any:
            rows = values(block)
            return rr.Scalars.columns(scalars=rows.ravel()).partition(np.full(len(rows), len(names)))

        extremes = rr.components.AggregationPolicy.MinMax  # a mean of several samples would cut the tops off
        widths = line_widths(values(slice(None, None, max(1, len(time) // _LOOKED_AT))))
        look: dict[str, Any] = {"names": list(names), "colors": list(colors)}
        if joined:
            self.static(path, rr.SeriesLines(**look, widths=widths, aggregation_policy=extremes))
        else:
            sizes = [0.5 * (_NARROW + width) for width in widths]
            self.static(path, rr.SeriesPoints(**look, markers=["circle"] * len(names), marker_sizes=sizes))
        self.columns(path, time, columns)

    def properties(self, name: str, values: Mapping[str, Any]) -> None:
        """Write properties of the whole recording, those that are None left out."""
        import rerun as rr

        known = {key: value for key, value in values.items() if value is not None}
        if known:
            self._stream.send_property(name, rr.AnyValues(**known))

    def name(self, name: str) -> None:
        """Call the recording `name`."""
        self._stream.send_recording_name(name)

    def flush(self) -> None:
        """Wait until everything is out of memory."""
        self._wait(self._stream)


def _written(stream: rr.RecordingStream) -> None:
    try:
        stream.flush(timeout_sec=_PATIENCE)
    except RuntimeError as error:
        raise InertiaError(f"the recording cannot be written: {error}", code="unwritable") from error


def line_widths(values: Float) -> list[float]:
    """Return widths (k,) for series (n, k), each wider by as many later ones as would hide it: these are drawn over it.

    >>> line_widths(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]))
    [3.5, 1.5, 1.5]
    """
    height = float(np.ptp(values)) or 1.0
    hidden = (np.abs(values[:, :, None] - values[:, None, :]) <= _SAME * height).mean(axis=0) >= _OFTEN
    return [_NARROW + _WIDER * float(np.count_nonzero(row[k + 1 :])) for k, row in enumerate(hidden)]


def blocks(count: int, block: int = BLOCK) -> Iterator[slice]:
    """Yield slices of at most `block` rows that cover `count` of them.

    >>> list(blocks(70_000))
    [slice(0, 65536, None), slice(65536, 70000, None)]
    """
    for start in range(0, count, block):
        yield slice(start, min(start + block, count))


@contextlib.contextmanager
def to_file(path: Path, application: str, blueprint: rrb.Blueprint, second: float = 1.0) -> Iterator[Recording]:
    """Open a recording that appears under `path` when the context is left, and not at all where an error leaves it."""
    import rerun as rr

    with whole(path) as beside, beside.open("wb") as file:
        with _into(file) as sink:
            stream = rr.RecordingStream(application)
            prepare(stream)
            stream.save(sink, default_blueprint=blueprint)
            try:
                yield Recording(stream, second)
            finally:
                stream.disconnect()  # writes the footer
        file.flush()
        os.fsync(file.fileno())


def prepare(stream: rr.RecordingStream) -> None:
    """Leave out the times of the clock."""
    stream.set_log_time_enabled(False)
    stream.set_log_tick_enabled(False)


@contextlib.contextmanager
def _into(file: Any) -> Iterator[str]:
    """Yield a path that leads into an open file, by way of a pipe: Rerun's own sink keeps write errors to itself.

    Raises the first `OSError` of writing. Without /dev/fd (Windows) it is the file's own path.
    """
    if not PIPES.is_dir():
        yield file.name
        return
    reading, writing = os.pipe()
    faults: list[OSError] = []

    def pump() -> None:
        while data := os.read(reading, _READ):
            if not faults:  # else the rest is only drained, so that the writer does not wait for ever
                try:
                    file.write(data)
                except OSError as error:
                    faults.append(error)

    pumping = threading.Thread(target=pump, daemon=True)
    pumping.start()
    try:
        yield f"{PIPES}/{writing}"
    finally:
        os.close(writing)
        pumping.join()
        os.close(reading)
    if faults:
        raise faults[0]
