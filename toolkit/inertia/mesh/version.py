"""Whether a file is still the one whose reading began: its inode, size and times; and its SHA-256.

A reader opens a file more than once, and a large one is read while it is integrated. What was read belongs together
when the file was the same before the first look and after the last. A file system gives the same time to two changes
within a tick of its clock, so a file that changed just now is compared by its contents too. The files that it refers to
belong to it.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cached_property
from pathlib import Path

from inertia.errors import ReadError
from inertia.output import note_input

_AT_ONCE = 2**20  # bytes that are hashed before they are read: it takes a millisecond
_TICK = 0.02  # s, longer than the steps in which the kernel gives out times
CHANGED = "it changed while it was being read: wait until it is written, and run again"


class Version:
    """A file as it is now; see `unchanged`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.others: dict[str, Version] = {}
        """The files that it refers to, by the names that it has for them."""
        self._status = state_of(path.stat())
        self._recent = abs(time.time() - max(self._status[3:]) / 1e9) < _TICK
        if self._recent and self.size > _AT_ONCE:
            time.sleep(_TICK)
            self._status, self._recent = state_of(path.stat()), False
        self._digest = self._hashed() if self.size <= _AT_ONCE else None

    @property
    def size(self) -> int:
        """Bytes of the file."""
        return self._status[2]

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of the file, in hexadecimal; raises `ReadError` where it has changed since."""
        digest = self._digest or self._hashed()
        if self._digest is None:
            self.require(self.path.stat())
        return digest

    def require(self, status: os.stat_result, *, links: bool = True) -> None:
        """Raise `ReadError` where the file is no longer the same, as `status` has it.

        Without `links` it may have been moved or deleted while it is open, which leaves its contents alone.
        """
        if state_of(status)[: None if links else 4] != self._status[: None if links else 4]:
            raise ReadError(CHANGED, code="changed")

    def require_contents(self) -> None:
        """Raise `ReadError` where the file is no longer the same, or was written a moment ago and now holds others."""
        self.require(self.path.stat())
        if self._recent and self._hashed() != self._digest:
            raise ReadError(CHANGED, code="changed")
        for other in self.others.values():
            other.require_contents()

    def _hashed(self) -> str:
        return sha256_of(self.path, self.size)


_reading: ContextVar[Version | None] = ContextVar("reading", default=None)


@contextmanager
def unchanged(path: Path) -> Iterator[Version]:
    """Yield the version of a file; raise `ReadError` where it changed before the context is left.

    What goes wrong in the context while the file changes is put down to that.
    """
    version = Version(path)
    before = _reading.set(version)
    try:
        yield version
    except ReadError:
        version.require_contents()
        raise
    finally:
        _reading.reset(before)
    version.require_contents()


def sha256_of(path: Path, size: int) -> str:
    """Return the SHA-256 of a file of so many bytes, in hexadecimal."""
    import hashlib  # loads OpenSSL: 6 ms and 4 MB

    with path.open("rb") as file:
        if size <= _AT_ONCE:  # the buffer for any file is 256 KiB, which cost more than to hash a small one
            return hashlib.sha256(file.read()).hexdigest()
        return hashlib.file_digest(file, "sha256").hexdigest()


def refer_to(path: Path, name: str) -> None:
    """Let a file that the one being read refers to belong to its version."""
    note_input(path)
    version = _reading.get()
    if version is not None and name not in version.others:
        version.others[name] = Version(path)


def state_of(status: os.stat_result) -> tuple[int, ...]:
    """Return what tells a file from another one, and from itself once it has changed."""
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns
