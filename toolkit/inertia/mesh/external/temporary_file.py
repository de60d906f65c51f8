"""A temporary file for what the memory does not hold; it is gone when the work is done, however that ends."""

from __future__ import annotations

import os
import shutil
import threading
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from inertia.errors import Remedy, WriteError
from inertia.mesh.external.memory import in_bytes
from inertia.output import remove_left_behind, temporary_folder

MEMORY = Remedy("analyse", "memory", "BYTES")


class TemporaryFile:
    """A file that several threads write to and read from.

    Parameters
    ----------
    size : bytes that it may take, about; where this is 0 there is no file, and none may write to it
    stack : what closes and removes it

    Raises `WriteError` where no folder can be written to, or has no room for it.
    """

    def __init__(self, size: int, stack: ExitStack) -> None:
        if size == 0:
            remove_left_behind()
            return
        self._folder = stack.enter_context(temporary_folder())
        require_space(self._folder, size)
        self._file = os.open(self._folder / "rows", os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o600)
        stack.callback(os.close, self._file)
        self._end, self._lock = 0, threading.Lock()

    def reserve(self, size: int) -> int:
        """Return the byte from which on so many are free."""
        with self._lock:
            self._end += size
            return self._end - size

    def write(self, array: NDArray[Any], at: int) -> None:
        """Write a contiguous array from byte `at` on."""
        data = _bytes_of(array)
        try:
            while len(data):
                written = self._write(data, at)
                data, at = data[written:], at + written
        except OSError as error:
            raise WriteError(
                f"cannot write temporary files to {self._folder.parent}: {error.strerror}: set TMPDIR to another folder"
            ) from None

    def read(self, array: NDArray[Any], at: int) -> None:
        """Fill a contiguous array with what was written from byte `at` on."""
        data = _bytes_of(array)
        while len(data):
            size = self._read(data, at)
            if size == 0:
                raise WriteError("a temporary file is shorter than what was written to it: run again")
            data, at = data[size:], at + size

    def _write(self, data: memoryview, at: int) -> int:
        if hasattr(os, "pwrite"):
            return os.pwrite(self._file, data, at)
        with self._lock:
            os.lseek(self._file, at, os.SEEK_SET)
            return os.write(self._file, data)

    def _read(self, into: memoryview, at: int) -> int:
        if hasattr(os, "preadv"):
            return os.preadv(self._file, [into], at)
        with self._lock:
            os.lseek(self._file, at, os.SEEK_SET)
            data = os.read(self._file, len(into))
        into[: len(data)] = data
        return len(data)


def _bytes_of(array: NDArray[Any]) -> memoryview:
    return array.data.cast("B") if array.size else memoryview(b"")


def require_space(folder: Path, size: int) -> None:
    """Raise `WriteError` where a folder has no room for a temporary file."""
    free = shutil.disk_usage(folder).free
    if free < size:
        raise WriteError(
            f"temporary files of {in_bytes(size)} are needed, and {folder.parent} has room for {in_bytes(free)}: set "
            "TMPDIR to another folder, or allow more memory by ",
            MEMORY,
        )
