"""Files that appear whole or not at all."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from inertia.errors import FORCE, InertiaError, UsageError

_REMEDIES = {
    errno.ENOSPC: "make room on the disk, or name a place on another one",
    errno.EDQUOT: "make room within the quota, or name a place on another disk",
    errno.EFBIG: "raise the limit on the size of files, or write less",
    errno.ENOENT: "name a folder that is there",
    errno.ENOTDIR: "name a folder that is there",
}


def require_writable(file: str | os.PathLike[str], *suffixes: str, force: bool = False) -> Path:
    """Return the path of a file that can be written: to be asked before work that takes a while.

    Raises
    ------
    UsageError : its name ends in none of `suffixes`, it is a directory, or it exists and `force` is not set
    InertiaError : its folder cannot be written to
    """
    path = Path(file)
    if suffixes and path.suffix.lower() not in suffixes:
        raise UsageError(f"cannot write {path}: its name must end in {' or '.join(suffixes)}")
    if path.is_dir():
        raise UsageError(f"cannot write {path}: it is a directory")
    if path.exists() and not force:
        raise UsageError(f"{path} exists: give another name, or ", FORCE, " to write over it")
    with _faults(path), _beside(path) as beside:
        beside.touch()
    return path


def write_whole(path: Path, content: bytes) -> None:
    """Write a file that is whole or not there."""
    with whole(path) as beside:
        beside.write_bytes(content)


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Yield a path beside that of a file, renamed to it when the context is left without an error, else removed."""
    with _faults(path), _beside(path) as beside:
        yield beside
        beside.replace(path.resolve())


@contextmanager
def _beside(path: Path) -> Iterator[Path]:
    """Yield a path of this process beside a file, or beside what a link leads to; nothing is there afterwards."""
    path = path.resolve()
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        yield beside
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def _faults(path: Path) -> Iterator[None]:
    """Say which file could not be written, and what to do about it."""
    try:
        yield
    except OSError as error:
        remedy = _REMEDIES.get(error.errno or 0, "name a place that can be written to")
        raise InertiaError(f"cannot write {path}: {error.strerror or error}: {remedy}") from error
