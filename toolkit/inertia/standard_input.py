"""Files that are named to be read: what `-` stands for, what outputs call them, and why one cannot be read."""

from __future__ import annotations

import atexit
import errno
import os
import sys
from contextlib import ExitStack
from functools import cache
from pathlib import Path

from inertia.errors import ReadError, UsageError
from inertia.output import note_input, temporary_folder

NAME = "-"
"""What stands for standard input; a file of that name is `./-`."""

DESCRIPTOR = 0
"""Of standard input, for `inertia.output.note_input`."""

FULL = errno.ENOSPC, errno.EDQUOT
"""What reading a file meets where it is unpacked, converted or copied for a while."""

_REASONS = {
    errno.ENOENT: "there is no such file: check the path",
    errno.EISDIR: "it is a directory: give a file in it",
    errno.ENOTDIR: "part of the path is not a directory: check the path",
    errno.EACCES: "permission is denied: ask its owner to let you read it",
    errno.ELOOP: "it is a symbolic link that leads back to itself: point the link at a file",
    errno.ENAMETOOLONG: "the path is too long: check the path",
    **dict.fromkeys(
        FULL, "there is no room for temporary files: make room in their folder, or set TMPDIR to one on another disk"
    ),
}
_RECORDING = b"RRF"  # how recordings of Rerun begin, whatever their version
NO_FILE = _REASONS[errno.ENOENT]


def reason_of(error: OSError) -> str:
    """Return why a file cannot be read, and what to do about it."""
    return _REASONS.get(error.errno or 0, f"{error.strerror or error}: check the path and the disk")


def path_of(name: str | os.PathLike[str]) -> Path:
    """Return a name as a path: `-` of standard input alone, and the whole path of a file that is called so."""
    path = Path(name)
    return path.absolute() if str(path) == NAME != os.fspath(name) else path


_folders: dict[str, str] = {}


def call_folder(folder: Path, name: str) -> None:
    """Let what lies in a temporary folder be called after the file it came out of; in one within it, say so first."""
    _folders[str(folder)] = name


def called(name: str) -> str:
    """Return what outputs call a file.

    >>> call_folder(Path("/tmp/inertia-5x"), "run.rrd")
    >>> called("/tmp/inertia-5x/scenes/../part.stl"), called("part.stl")
    ('run.rrd/part.stl', 'part.stl')
    """
    path = Path(os.path.normpath(name))
    for folder, whole in _folders.items():
        if path.is_relative_to(folder):
            return f"{whole}/{path.relative_to(folder).as_posix()}"
    return name


def require_name(name: str) -> None:
    """Raise `UsageError` where a name is empty, which as a path would be the working directory."""
    if not name:
        raise UsageError("the path of a file is empty: name a file, or - for standard input")


def file_of(name: str) -> Path:
    """Return the file to be read that a name stands for: of `-` one that holds all of standard input until the end.

    Raises `FileNotFoundError` for what no file can be called, and `UsageError` for an empty name.
    """
    require_name(name)
    if name == NAME:
        note_input(DESCRIPTOR)
        return _spooled()
    try:
        possible = b"\0" not in os.fsencode(name)
    except UnicodeEncodeError:
        possible = False
    if not possible:
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), name)
    note_input(path := Path(name))
    return path


@cache
def _spooled() -> Path:
    if sys.stdin is None:
        raise ReadError("standard input is closed: name a file")
    import shutil  # loads what packs and unpacks archives

    stack = ExitStack()
    try:
        path = stack.enter_context(temporary_folder()) / "input"
        atexit.register(stack.close)
        with path.open("wb") as file:
            shutil.copyfileobj(sys.stdin.buffer, file, 2**20)
        with path.open("rb") as file:
            recorded = file.read(len(_RECORDING)) == _RECORDING
        if recorded:  # Rerun tells what it opens by the name alone
            path = path.rename(path.with_suffix(".rrd"))
    except OSError as error:
        where = "" if error.filename is None else f" ({error.filename})"
        raise ReadError(
            f"standard input cannot be put into a temporary file{where}: {error.strerror}: make room there, or name "
            "another folder for such files by TMPDIR"
        ) from error
    return path
