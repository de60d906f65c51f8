"""Ctrl-C, SIGTERM and SIGHUP: the command ends quietly with 128 and the signal's number, and leaves nothing behind.

It has to be imported before anything that takes a while.
"""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType

_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]

_AGAIN = 0.01  # s, by when the destructor, or whatever dropped the exception, has returned


class Ended(KeyboardInterrupt):
    """Raised where a signal ends the command, so that what is open is closed and temporary files are removed."""


class Interruption:
    """What signals do to this process: end it at once, or while a command runs, raise `Ended` first."""

    def __init__(self) -> None:
        self.running = False
        """Whether there may be something to clean up."""
        self.signal = 0
        """The signal that has arrived, if any."""

    def install(self) -> None:
        """Listen to signals; those that whoever started this process wants to be ignored stay so."""
        for number in _SIGNALS:
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                signal.signal(number, self._arrived)
        sys.unraisablehook = self._swallowed

    @property
    def code(self) -> int:
        """The exit code of a command that a signal ends, Ctrl-C unless another one has arrived."""
        return 128 + (self.signal or signal.SIGINT)

    def finish(self) -> None:
        """Let signals pass: the result is out, and a few milliseconds are left."""
        for number in _SIGNALS:
            if signal.getsignal(number) == self._arrived:
                signal.signal(number, signal.SIG_IGN)

    def _arrived(self, number: int, frame: FrameType | None) -> None:
        if not self.running or self.signal:  # nothing to clean up, or no patience
            os._exit(128 + number)
        self.signal = number
        raise Ended

    def _swallowed(self, fault: sys.UnraisableHookArgs) -> None:
        """Let the signal come again where the interpreter had to drop the exception, as in a destructor."""
        if isinstance(fault.exc_value, Ended):
            from threading import Timer

            self.signal, number = 0, self.signal
            Timer(_AGAIN, os.kill, (os.getpid(), number)).start()
        else:
            sys.__unraisablehook__(fault)


interruption = Interruption()
