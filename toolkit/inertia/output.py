"""Files that appear whole or not at all, one by one or several together.

A file is written beside its place, under a hidden name that ends in `.inertia`, reaches the disk, and is renamed.
Several that belong `together` are renamed in a row when all of them are whole. Where a run dies, its temporary files
stay; the next run that writes to the folder removes them: it knows them by the lock that a live run holds. A command
`spares` the files that it reads: none of them is written over.
"""

from __future__ import annotations

import errno
import os
import re
import stat
import sys
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from inertia.errors import FORCE, UsageError, WriteError

if sys.platform != "win32":
    import fcntl

_REMEDIES = {
    errno.ENOSPC: "make room on the disk, or name a place on another one",
    errno.EDQUOT: "make room within the quota, or name a place on another disk",
    errno.EFBIG: "raise the limit on the size of files, or write less",
    errno.ENOENT: "name a folder that is there",
    errno.ENOTDIR: "name a folder that is there",
    errno.ENAMETOOLONG: "give a shorter name",
}
_TEMPORARY = re.compile(r"\..+\.[0-9a-f]{12}\.inertia")
_NAME = 50  # characters of the file's name in that of the temporary one, which has to fit into 255 bytes


class _Renames:
    """The files that are whole and wait to be renamed, and what has to be closed before."""

    def __init__(self) -> None:
        self.stack = ExitStack()
        self.pairs: list[tuple[Path, Path, Path]] = []

    def run(self) -> None:
        """Rename them in a row; an interruption waits until that is done."""
        for _, target, path in self.pairs:
            with _faults(path):
                if target.is_dir():
                    raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        try:
            self._rename()
        except KeyboardInterrupt:
            self._rename()
            raise

    def _rename(self) -> None:
        old = [] if sys.platform == "win32" else [target for _, target, _ in self.pairs]
        with _open(old):  # to let go of their contents takes some 500 times as long as to rename
            for beside, target, path in self.pairs:
                with _faults(path):
                    if beside.exists():
                        beside.replace(target)


@contextmanager
def _open(files: list[Path]) -> Iterator[None]:
    """Keep open what can be opened, until the context is left."""
    descriptors = []
    try:
        for file in files:
            with suppress(OSError):
                descriptors.append(os.open(file, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)))
        yield
    finally:
        for descriptor in descriptors:
            os.close(descriptor)


_pending: ContextVar[_Renames | None] = ContextVar("pending", default=None)
Inputs = dict[Path | int, os.stat_result | None]
"""Files that are read, by path or descriptor, each as it was when it was first noted; None where it is not there."""

_inputs: ContextVar[Inputs | None] = ContextVar("inputs", default=None)


@contextmanager
def sparing_inputs(inputs: Iterable[Path | int]) -> Iterator[None]:
    """Refuse, in the context, to write over any of some files, or one that is read there (`note_input`)."""
    with inputs_noted() as noted:
        noted.update(dict.fromkeys(inputs))
        yield


def status_of(file: Path | str | int) -> os.stat_result | None:
    """Return what the system says of a file; None where there is none."""
    with suppress(OSError, ValueError):  # the name may be one that no file can have
        return os.stat(file)  # noqa: PTH116  # it may be a descriptor
    return None


@contextmanager
def inputs_noted() -> Iterator[Inputs]:
    """Yield the files that are noted in the context, by `note_input`."""
    noted: Inputs = {}
    before = _inputs.set(noted)
    try:
        yield noted
    finally:
        _inputs.reset(before)


def note_input(file: Path | int) -> None:
    """Note a file that is read, by its path or descriptor, as one that a command must not write over.

    One that is looked for and is not there is noted too: what is answered without it may not stand once it is there.
    """
    inputs = _inputs.get()
    if inputs is not None and file not in inputs:
        inputs[file] = status_of(file)


def _require_other(path: Path) -> None:
    """Raise `UsageError` where a file is one that is read, by whatever name or link."""
    if not path.exists():
        return
    for file in _inputs.get() or ():
        status = status_of(file)  # of one that may be gone meanwhile
        if status is not None and os.path.samestat(status, path.stat()):
            what = "what standard input is read from" if isinstance(file, int) else f"an input, {file}"
            raise UsageError(f"cannot write {path}: it is {what}: give the output another name", code="is_input")


def require_writable(file: str | os.PathLike[str], *suffixes: str, force: bool = False) -> Path:
    """Return the path of a file that can be written: to be asked before work that takes a while.

    Raises
    ------
    UsageError : its name is empty or ends in none of `suffixes`, it is a directory, it is an input of the command, or
        it exists and `force` is not set
    WriteError : its folder cannot be written to
    """
    if not os.fspath(file):
        raise UsageError("the name of a file to be written is empty: name one")
    path = Path(file)
    if suffixes and path.suffix.lower() not in suffixes:
        names = " or ".join(filter(None, [", ".join(suffixes[:-1]), suffixes[-1]]))
        raise UsageError(f"cannot write {path}: its name must end in {names}")
    with _faults(path):
        if path.is_dir():
            raise UsageError(f"cannot write {path}: it is a directory: name a file in it")
        if path.exists() and not path.is_file():
            what = "it is not a regular file but a pipe, socket or device: name a file"
            raise UsageError(f"cannot write {path}: {what}")
        _require_other(path)
        if path.exists() and not force:
            raise UsageError(f"{path} exists: give another name, or ", FORCE, " to write over it", code="exists")
        with _beside(path):
            pass
    return path


def write_whole(path: Path, content: bytes) -> None:
    """Write a file that is whole or not there."""
    with whole(path) as beside:
        beside.write_bytes(content)


@contextmanager
def together() -> Iterator[None]:
    """Let all files that are written in the context appear when it is left, and none where an error leaves it.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder, suppress(ZeroDivisionError), together():
    ...     write_whole(Path(folder) / "table.csv", b"1, 2")
    ...     print(1 / 0, Path(folder) / "other.csv")
    """
    if _pending.get() is not None:
        yield
        return
    renames = _Renames()
    before = _pending.set(renames)
    try:
        with renames.stack:
            yield
            renames.run()
    finally:
        _pending.reset(before)


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Yield a path beside that of a file, renamed to it when the context is left without an error, else removed.

    A link is followed: what it leads to is written, and the link stays. A file that is replaced hands on its owner,
    group and permissions, as far as this user may give them. Raises `UsageError` where it is an input of the
    command, or another of the files that are written together.
    """
    _require_other(path)
    with together(), _faults(path):
        renames = _pending.get()
        assert renames is not None
        beside, target = renames.stack.enter_context(_beside(path))
        if any(target == other for _, other, _ in renames.pairs):
            raise UsageError(f"cannot write {path} twice: every result needs a file of its own")
        yield beside
        with beside.open("rb") as file:
            os.fsync(file.fileno())
        _take_rights(beside, target)
        renames.pairs.append((beside, target, path))


@contextmanager
def _beside(path: Path) -> Iterator[tuple[Path, Path]]:
    """Yield an empty file of this run beside a file, or beside what a link leads to, and where it is to go.

    It is gone afterwards, unless it was renamed.
    """
    target = _target(path)
    remove_left_behind(target.parent)
    beside, lock, is_alive = _another(target), None, False
    try:  # a signal may come as soon as the file is there
        while not is_alive:
            lock, is_alive = _new(beside, 0o600 if target.exists() else 0o666)  # what it is to replace may be private
            if not is_alive:
                beside = _another(target)
        yield beside, target
    finally:
        with suppress(OSError):
            beside.unlink(missing_ok=True)
        if lock is not None:
            os.close(lock)


def _take_rights(beside: Path, target: Path) -> None:
    """Give a new file the owner, group and permissions of the one that it replaces, if there is one.

    Where its group is not this user's to give, the group that the new file has gets no rights by that.
    """
    old = status_of(target)
    if old is None or sys.platform == "win32":
        return
    rights = old.st_mode & 0o777
    for owner in (old.st_uid, -1):
        with suppress(OSError):
            os.chown(beside, owner, old.st_gid)
            break
    else:
        rights &= ~0o070
    with suppress(OSError):  # a file system without permissions
        beside.chmod(rights)


def _target(path: Path) -> Path:
    """Return the file that a path leads to."""
    try:
        target = path.resolve()
    except RuntimeError:  # what a link that leads back to itself raises before Python 3.13
        target = path
    if target.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    return target


def _another(target: Path) -> Path:
    """Return a name of a temporary file beside another."""
    return target.with_name(f".{target.name[:_NAME]}.{os.urandom(6).hex()}.inertia")


def _new(beside: Path, rights: int) -> tuple[int | None, bool]:
    """Make a file with rights, of which the system takes its mask.

    Return the descriptor that holds its lock, where there are locks, and whether it is still there.
    """
    lock = os.open(beside, os.O_RDWR | os.O_CREAT | os.O_EXCL, rights)
    if sys.platform == "win32":  # where an open file can be neither renamed nor removed
        os.close(lock)
        return None, True
    if _is_locked(beside, lock):
        return lock, True
    os.close(lock)
    return None, False


def _is_locked(path: Path, lock: int) -> bool:
    """Take the lock of what was made a moment ago; say whether it is still there.

    Until then another run takes it for one that died: it has the lock while it removes it, and is waited for.
    """
    with suppress(OSError):  # a file system without locks
        fcntl.flock(lock, fcntl.LOCK_EX)
    with suppress(FileNotFoundError):
        return os.path.samestat(path.lstat(), os.fstat(lock))
    return False


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """Yield a folder of this run in the system's folder for temporary files; it is removed afterwards.

    Those of runs that have died are removed before. Raises `InertiaError` where no such folder can be written to.
    """
    import tempfile

    wanted = os.environ.get("TMPDIR")  # which tempfile passes over where it cannot be used
    if wanted and not os.access(wanted, os.W_OK | os.X_OK):
        raise WriteError(f"TMPDIR is {wanted}, where no temporary files can be written: set it to another folder")
    with ExitStack() as stack:
        try:
            remove_left_behind()
            while True:
                own = tempfile.TemporaryDirectory(prefix=".", suffix=f".{os.urandom(6).hex()}.inertia")
                folder = Path(stack.enter_context(own))
                if sys.platform == "win32":
                    break
                with suppress(FileNotFoundError):
                    stack.callback(os.close, lock := os.open(folder, os.O_RDONLY))
                    if _is_locked(folder, lock):
                        break
        except OSError as error:
            raise WriteError(
                f"no folder for temporary files can be written to ({error.strerror}): set TMPDIR to one"
            ) from None
        yield folder


def remove_left_behind(folder: Path | None = None) -> None:
    """Remove the temporary files and folders of this user's runs that have died: nobody holds their locks.

    Those in a folder, or in the system's one for temporary files.
    """
    if sys.platform == "win32":
        return
    try:
        if folder is None:
            import tempfile

            folder = Path(tempfile.gettempdir())
        names = [file for file in folder.iterdir() if _TEMPORARY.fullmatch(file.name)]
    except OSError:  # it can perhaps be written to, but not listed
        return
    for file in names:
        with suppress(OSError):  # it is gone, a live run's, or another user's
            lock = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                status = os.fstat(lock)
                if stat.S_ISREG(status.st_mode):
                    file.unlink()
                elif stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid():
                    import shutil

                    shutil.rmtree(file)
            finally:
                os.close(lock)


@contextmanager
def _faults(path: Path) -> Iterator[None]:
    """Say which file could not be written, and what to do about it."""
    try:
        yield
    except OSError as error:
        remedy = _REMEDIES.get(error.errno or 0, "name a place that can be written to")
        raise WriteError(f"cannot write {path}: {error.strerror or error}: {remedy}") from error
