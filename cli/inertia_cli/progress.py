"""A progress bar on standard error, where that is a terminal and the work takes long."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

PATIENCE = 0.5
"""Seconds before the bar appears."""

_INTERVAL = 0.1  # seconds between drawings


class Progress:
    """Draw a bar when called with the fraction done; leaving the context wipes it.

    Parameters
    ----------
    what : what is being done
    stream : where to draw; nothing is drawn where it is no terminal
    """

    def __init__(self, what: str, stream: TextIO | None = None) -> None:
        self._what = what
        self._stream = sys.stderr if stream is None else stream
        self._active = self._stream is not None and self._stream.isatty()
        self._next = time.monotonic() + PATIENCE
        self._bar: Bar | None = None

    def __enter__(self) -> Progress:
        """Return the callable itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Wipe the bar."""
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, done: float) -> None:
        """Draw the bar for a fraction between 0 and 1."""
        if not self._active or time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _INTERVAL
        if self._bar is None:
            self._bar = _bar(self._what, self._stream)
        self._bar.update(self._bar.task_ids[0], completed=done, refresh=True)


def _bar(what: str, stream: TextIO) -> Bar:
    """Return a bar that is drawn only when it is told to, and is wiped when it is stopped."""
    from rich.console import Console
    from rich.progress import Progress as Bar

    console = Console(file=stream)
    bar = Bar(console=console, auto_refresh=False, transient=True, redirect_stdout=False, redirect_stderr=False)
    bar.add_task(what, total=1.0)
    bar.start()
    return bar
