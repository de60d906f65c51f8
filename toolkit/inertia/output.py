"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from inertia.errors import FORCE, InertiaError, UsageError


def require_writable(file: str | os.PathLike[str], *, suffix: str | None = None, force: bool = False) -> Path:
    """Return the path of a file that can be written: to be asked before work that takes a while.

    Raises
    ------
    UsageError : its name does not end in `suffix`, it is a directory, or it exists and `force` is not set
    InertiaError : its folder cannot be written to
    """
    path = Path(file)
    if suffix is not None and path.suffix.lower() != suffix:
        raise UsageError(f"cannot write {path}: its name must end in {suffix}")
    if path.is_dir():
        raise UsageError(f"cannot write {path}: it is a directory")
    if path.exists() and not force:
        raise UsageError(f"{path} exists: give another name, or ", FORCE, " to write over it")
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise InertiaError(
            f"cannot write {path}: {error.strerror}: name a folder that is there and can be written to"
        ) from error
    return path


def write_whole(path: Path, content: bytes) -> None:
    """Write beside the file and rename, so that it is whole or not there."""
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        beside.write_bytes(content)
        beside.replace(path)
    except OSError as error:
        raise InertiaError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        beside.unlink(missing_ok=True)
