"""Files in the user's cache folder, read only where nobody else can have made them: owner, mode and keyed hash.

What is kept there is run, so a file counts as ours if all of this holds, and else as if it were not there:

* it and its folder belong to this user, every folder above to this user or to root, and nobody else may write to them;
  above, a folder that everybody may write to is passed where it is sticky, as /tmp is, since what is ours in it stays
  ours (OpenSSH asks the like of the files of its keys: `safe_path` in its misc.c);
* it begins with the HMAC-SHA256 of its name and of what follows, by a key that lies beside it and that only this user
  can read.

The folder is `INERTIA_CACHE`, else `XDG_CACHE_HOME`/inertia, else `~/.cache/inertia`. Where the system has no owners
(Windows), the folder of a user's profile is private already, and the hash alone is asked for. Nothing is locked: a file
is written beside and renamed, so that several processes may write it, and the last one stays.
"""

from __future__ import annotations

import contextlib
import os
import stat
import time
from pathlib import Path
from threading import get_ident

DIGEST = 32
"""Bytes of the keyed hash, and of its key."""

_LIMIT = 64 * 2**20  # no file of ours is nearly as large
_ABANDONED = 3600.0  # seconds after which what is being written is not being written any more
_KEY, _SECRET = "key", 0o077
_OPEN = os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK if os.name == "posix" else getattr(os, "O_BINARY", 0)


class CacheError(Exception):
    """The cache cannot be used: the message says why."""


def load(name: str) -> bytes | None:
    """Return what was stored under a name; None where nothing was, and nothing (b"") where it is not what was stored.

    Raises
    ------
    CacheError : the folder is not this user's alone
    """
    folder = cache_folder()
    if not os.path.lexists(folder / name):
        return None
    place = _own_folder(folder)
    data = _own_bytes(place / name)
    key = _own_bytes(place / _KEY, _SECRET)
    content = data[DIGEST:]
    return content if len(key) == DIGEST and data[:DIGEST] == _digest(key, name, content) else b""


def store(name: str, content: bytes) -> None:
    """Store bytes under a name, to be found by `load`.

    Raises
    ------
    CacheError : there is no folder to write to, or it is not this user's alone
    """
    folder = cache_folder()
    try:
        for missing in reversed([each for each in (folder, *folder.parents) if not each.exists()]):
            with contextlib.suppress(FileExistsError):
                missing.mkdir(0o700)
        place = _own_folder(folder)
        _sweep(place)
        _write(place / name, _digest(_key(place), name, content) + content)
    except OSError as error:
        raise CacheError(f"{folder} cannot be written to ({error.strerror or error})") from None


def cache_folder() -> Path:
    """Return the folder that is asked for, which need not be there."""
    if folder := os.environ.get("INERTIA_CACHE"):
        return Path(folder).absolute()
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    if base and Path(base).is_absolute():  # a relative one is to be passed over (XDG Base Directory Specification)
        return Path(base) / "inertia"
    try:
        home = Path.home()
    except RuntimeError:  # neither HOME nor a line in the table of users, as in a container
        home = Path()
    if not home.is_absolute():
        raise CacheError("there is no home folder")
    return home / ".cache" / "inertia"


def _digest(key: bytes, name: str, content: bytes) -> bytes:
    import hmac  # and hashlib with it, which takes 3 ms

    return hmac.digest(key, name.encode() + b"\0" + content, "sha256")


def _own_folder(folder: Path) -> Path:
    """Return a folder without links in its path, once it and all above it are known to be in this user's hands."""
    try:
        place = folder.resolve(strict=True)
        if os.name == "posix":
            for each in (place, *place.parents):
                _require_own(each, each.lstat(), this_alone=each is place)
    except OSError as error:
        raise CacheError(f"{folder} cannot be read ({error.strerror or error})") from None
    except RuntimeError:  # links that lead in a circle, before Python 3.13
        raise CacheError(f"{folder} is a link that leads back to itself") from None
    return place


def _require_own(folder: Path, status: os.stat_result, this_alone: bool) -> None:
    """Raise `CacheError` where somebody else may have had a hand in a folder."""
    user, mode = os.geteuid(), stat.S_IMODE(status.st_mode)
    if status.st_uid != user and (this_alone or status.st_uid != 0):
        raise CacheError(f"{folder} belongs to user {status.st_uid}, not to user {user}")
    if mode & 0o022 and (this_alone or not mode & stat.S_ISVTX):
        raise CacheError(f"others may write to {folder} (its mode is {mode:04o})")


def _own_bytes(file: Path, others: int = 0o022) -> bytes:
    """Return the contents of a file of this user's on which others have none of the rights `others`, else nothing."""
    try:
        with os.fdopen(os.open(file, os.O_RDONLY | _OPEN), "rb") as opened:
            status = os.fstat(opened.fileno())
            odd = os.name == "posix" and (status.st_uid != os.geteuid() or status.st_mode & others)
            return b"" if odd or not stat.S_ISREG(status.st_mode) else opened.read(_LIMIT)
    except OSError:
        return b""


def _key(place: Path) -> bytes:
    """Return the key of a folder, made where there is none that is whole and secret."""
    file = place / _KEY
    key = _own_bytes(file, _SECRET)
    if len(key) != DIGEST and os.path.lexists(file):
        key = _own_bytes(file, _SECRET)  # by now it may be another's, who has been first and uses it
        if len(key) != DIGEST:
            file.unlink(missing_ok=True)
    if len(key) == DIGEST:
        return key
    _write(file, os.urandom(DIGEST), only_if_absent=True)
    return _own_bytes(file, _SECRET)  # another process may have been first


def _write(file: Path, content: bytes, *, only_if_absent: bool = False) -> None:
    beside = file.with_name(f"{file.name}.{os.getpid()}.{get_ident()}.part")
    try:
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _OPEN, 0o600), "wb") as opened:
            opened.write(content)
        if only_if_absent:
            with contextlib.suppress(FileExistsError):
                _link(beside, file)
        else:
            beside.replace(file)
    finally:
        beside.unlink(missing_ok=True)


def _link(beside: Path, file: Path) -> None:
    """Give a file its name, unless that is taken; file systems without links have it renamed."""
    try:
        os.link(beside, file)
    except FileExistsError:
        raise
    except OSError:
        beside.replace(file)


def _sweep(place: Path) -> None:
    """Remove what processes that died were writing."""
    for part in place.glob("*.part"):
        with contextlib.suppress(OSError):
            if time.time() - part.lstat().st_mtime > _ABANDONED:
                part.unlink()
