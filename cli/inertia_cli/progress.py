"""A progress bar on standard error, where that is a terminal and the work takes long."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import TextIO

_PATIENCE = 0.5  # seconds before the bar appears
_INTERVAL = 0.1  # seconds between drawings
_WIDTH = 40


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
        self._next = time.monotonic() + _PATIENCE
        self._drawn = False

    def __enter__(self) -> Progress:
        """Return the callable itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Wipe the bar."""
        if self._drawn:
            self._stream.write("\r\x1b[K")
            self._stream.flush()

    def __call__(self, done: float) -> None:
        """Draw the bar for a fraction between 0 and 1."""
        if not self._active or time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _INTERVAL
        self._drawn = True
        filled = round(_WIDTH * min(max(done, 0.0), 1.0))
        self._stream.write(f"\r{self._what} [{'#' * filled}{'.' * (_WIDTH - filled)}] {done:4.0%}")
        self._stream.flush()
