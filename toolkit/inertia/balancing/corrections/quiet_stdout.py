"""The process's standard output switched off while a compiled library runs."""

from __future__ import annotations

import contextlib
import ctypes
import os
import threading
from collections.abc import Iterator

_STDOUT = 1
_ONE_AT_A_TIME = threading.Lock()


@contextlib.contextmanager
def quiet_stdout() -> Iterator[None]:
    """Drop what is written to the process's standard output below Python.

    The solver HiGHS in scipy prints a line of its own where it mends a solution, whatever its options are
    (HiGHS.jl issue 312). What C holds back in its buffer is written before and dropped after.
    """
    with _ONE_AT_A_TIME:
        try:
            stdout = os.dup(_STDOUT)
        except OSError:  # there is no standard output
            yield
            return
        c = ctypes.CDLL("ucrtbase" if os.name == "nt" else None)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        c.fflush(None)
        os.dup2(nowhere, _STDOUT)
        try:
            yield
        finally:
            c.fflush(None)
            os.dup2(stdout, _STDOUT)
            os.close(stdout)
            os.close(nowhere)
