"""Compressed files and archives: the one mesh in a gzip, bzip2, xz, zip or tar file is unpacked, within a limit.

Nothing of an archive is trusted but the bytes of that member: it is written under a name of our own, into a folder of
this run that goes when it has been read. An archive within an archive is not opened, nor are several meshes. A link is
the file of the archive that it leads to; hidden files, and those in hidden folders, are passed over as globs do.
"""

from __future__ import annotations

import atexit
import math
import re
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path, PurePosixPath
from posixpath import dirname, join, normpath
from typing import IO, Any, NamedTuple

from inertia.errors import InertiaError, ReadError, Remedy, visible
from inertia.mesh.readers.contents import alone
from inertia.mesh.readers.formats import EXTENSIONS, format_of_zip
from inertia.mesh.version import CHANGED
from inertia.output import temporary_folder

UNPACK_LIMIT = 2.0
"""GiB that a compressed file may unpack to, unless told."""

ARCHIVE = re.compile(r"(?i)\.(zip|tar|tgz|tbz2?|txz|tar\.(gz|bz2|xz))$")
"""The names of archives that may hold several files."""

_COMPRESSED = re.compile(r"(?i)\.(gz|bz2|xz|gzip|lzma)$")
_MEMBERS = 10_000  # entries of an archive that are looked at
_LINKS = 40  # symbolic links that are followed to one file, as Linux does
_BLOCK = 2**20
_NAMED = 5
_STREAMS = {b"\x1f\x8b": ("gzip", "gzip"), b"BZh": ("bzip2", "bz2"), b"\xfd7zXZ\x00": ("xz", "lzma")}
_MORE = Remedy("read", "unpack_limit", "GIB")


class Unpacked(NamedTuple):
    """A file that was unpacked: where it is, what it was called, and the note that says so."""

    path: Path
    name: str
    note: str


def packed_as(path: Path, head: bytes) -> str | None:
    """Return what a file that begins with `head` is packed as: "gzip", "zip", ...; None where it is not.

    3MF, 3DXML and zipped Collada are formats of their own.
    """
    for magic, (kind, _) in _STREAMS.items():
        if head.startswith(magic):
            return kind
    if re.match(rb"PK(?:\x03\x04|\x05\x06)", head) and format_of_zip(path) is None:
        return "zip"
    return "tar" if _is_tar(head) else None


@contextmanager
def unpacked(path: Path, kind: str, limit: float) -> Iterator[Unpacked]:
    """Yield the mesh in a file that is packed as `kind`; it is gone when the context is left.

    Parameters
    ----------
    limit : GiB that it may unpack to

    Raises `ReadError` where it is damaged or encrypted, unpacks to more, or holds no mesh or several.
    """
    with temporary_folder() as folder:
        with _damage(kind):
            source, name, how = _mesh_of(path, kind, folder, limit * 2**30)
        suffix = PurePosixPath(name).suffix.lower()
        if suffix in _MESHES:
            source = source.rename(folder / f"part{suffix}")
        if inner := packed_as(source, _head(source)):
            holds = f"it holds {visible(name)}, which is packed as {inner}"
            raise ReadError(f"{holds}, and archives in archives are not opened: unpack it first", code="not_read")
        note = f"unpacked from {how}: {visible(name)}, {source.stat().st_size} bytes"
        with alone():
            yield Unpacked(source, visible(name), note)


def _mesh_of(path: Path, kind: str, folder: Path, limit: float) -> tuple[Path, str, str]:
    """Return where in a folder the mesh in a packed file now lies, its name, and what it was unpacked from."""
    if kind == "zip":
        return *_from_zip(path, folder / "part", limit), kind
    if kind == "tar":
        return *_from_tar(path, folder / "part", limit), kind
    module = next(module for other, module in _STREAMS.values() if other == kind)
    opened: Callable[[Path], IO[bytes]] = __import__(module).open
    name = _COMPRESSED.sub("", path.name)
    with opened(path) as stream:
        source = _copy(stream, folder / "stream", limit)
    if not (name.lower().endswith((".tgz", ".tbz", ".tbz2", ".txz")) or _is_tar(_head(source))):
        return source, name, kind
    unpacked = _from_tar(source, folder / "part", limit)
    source.unlink()
    return *unpacked, f"{kind} and tar"


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(512)


def meshes_in(path: Path, limit: float = UNPACK_LIMIT) -> list[str]:
    """Return the names of all meshes, packed or not, and archives in a zip or tar archive, in its order.

    Raises `ReadError` where it is damaged, or a compressed tar archive unpacks to more than a limit in GiB.
    """
    import tarfile
    import zipfile

    with _damage("zip or tar"):
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as archive:
                names = _zip_files(archive)
        else:
            room = math.inf if _is_tar(_head(path)) else limit * 2**30
            with tarfile.open(path) as stream:
                names = [name for name, _ in _tar_files(stream, room=room)]
    return [name for name in dict.fromkeys(names) if _is_mesh(name) or is_packed(name)]


def is_packed(name: str) -> bool:
    """Say whether a file in an archive is, by its name, an archive or a compressed mesh."""
    mesh = _COMPRESSED.sub("", name)
    return not _is_hidden(name) and (ARCHIVE.search(name) is not None or (mesh != name and _is_mesh(mesh)))


@contextmanager
def member_copy(path: Path, name: str, limit: float) -> Iterator[Path]:
    """Yield a copy of one mesh among several in a zip or tar archive, within a limit in GiB as `unpacked` has it.

    A tar archive can be read from its beginning only: it is unpacked once, and stays so until the next one's turn.
    """
    import zipfile

    bytes_left = limit * 2**30
    with temporary_folder() as folder:
        with _damage("zip or tar"):
            if zipfile.is_zipfile(path):
                copy = _zip_member(path, name, folder / f"part{_suffix(name)}", bytes_left)
            else:
                copy = _tar_member(path, name, bytes_left)
        with alone():
            yield copy


def _zip_member(path: Path, name: str, to: Path, limit: float) -> Path:
    import zipfile

    with zipfile.ZipFile(path) as archive:
        info = _in_zip(archive, name)
        if info.flag_bits & 1:
            raise ReadError("it is encrypted: unpack it and give the mesh in it", code="encrypted")
        with archive.open(info) as stream:
            return _copy(stream, to, limit)


class _Tar(NamedTuple):
    """A tar archive that is unpacked: where the files of each name lie, or why they do not; and what removes them."""

    version: object
    files: dict[str, list[Path]]
    astray: dict[str, ReadError]
    refusal: ReadError | None
    stack: ExitStack


_last_tar: list[_Tar] = []


def _tar_member(path: Path, name: str, limit: float) -> Path:
    status = path.stat()
    version = str(path), status.st_ino, status.st_size, status.st_mtime_ns, limit
    if not _last_tar or _last_tar[0].version != version:
        _forget_tar()
        _last_tar.append(_unpacked_tar(path, limit, version))
    if (refusal := _last_tar[0].refusal) is not None:
        raise refusal
    places = _last_tar[0].files.get(name)
    if places == []:
        raise _last_tar[0].astray[name]
    _require_one(name, len(places or ()))
    assert places is not None
    return places[0]


def _unpacked_tar(path: Path, limit: float, version: object) -> _Tar:
    """Unpack the meshes of a tar archive: one for each name, unless names repeat; none for a link that leads astray."""
    import tarfile

    files: dict[str, list[Path]] = {}
    astray: dict[str, ReadError] = {}
    copies: dict[tuple[int, str], Path] = {}  # a file that several links share is there once
    used, refusal = 0, None
    with ExitStack() as stack, tarfile.open(path) as archive:
        folder = stack.enter_context(temporary_folder())
        for name, member in _tar_files(archive):
            if not (_is_mesh(name) or is_packed(name)):
                continue
            places = files.setdefault(name, [])
            if not member.isreg():
                astray[name] = _astray(member)
                continue
            key = member.offset_data, _suffix(name)
            if key not in copies:
                try:
                    copies[key] = _tar_copy(archive, member, folder / f"{len(copies)}{key[1]}", limit, used)
                except ReadError as error:  # too large, all of them together
                    refusal = error
                    break
                used += member.size
            if copies[key] not in places:
                places.append(copies[key])
        return _Tar(version, files, astray, refusal, stack.pop_all())


@atexit.register
def _forget_tar() -> None:
    while _last_tar:
        _last_tar.pop().stack.close()


def _is_mesh(name: str) -> bool:
    return PurePosixPath(name).suffix.lower() in _MESHES and not _is_hidden(name)


def _is_hidden(name: str) -> bool:
    """Say whether a file is hidden, or lies in a hidden folder, or holds what macOS keeps beside another one."""
    return "__MACOSX" in name or any(part[0] == "." and part != ".." for part in PurePosixPath(name).parts)


def _suffix(name: str) -> str:
    """Return the ending of the name of a mesh or an archive; of a compressed mesh, both of its endings."""
    mesh = PurePosixPath(_COMPRESSED.sub("", name)).suffix.lower()
    suffix = PurePosixPath(name).suffix.lower()
    return f"{mesh}{suffix}" if mesh in _MESHES and mesh != suffix else suffix


def _is_tar(head: bytes) -> bool:
    return head[257:262] == b"ustar"


def _from_zip(path: Path, to: Path, limit: float) -> tuple[Path, str]:
    import zipfile

    with zipfile.ZipFile(path) as archive:
        info = _in_zip(archive, _mesh_among(_zip_files(archive)))
        if info.flag_bits & 1:
            raise ReadError("it is encrypted: unpack it and give the mesh in it", code="encrypted")
        with archive.open(info) as stream:
            return _copy(stream, to, limit), info.filename


def _from_tar(path: Path, to: Path, limit: float) -> tuple[Path, str]:
    import tarfile

    with tarfile.open(path, "r:") as archive:
        files: dict[str, list[Any]] = {}
        seen: set[tuple[str, int]] = set()
        for name, member in _tar_files(archive, _MEMBERS):
            key = "" if _is_mesh(name) else name, member.offset  # a mesh and a link to it are one
            if key not in seen:
                seen.add(key)
                files.setdefault(name, []).append(member)
        name = _mesh_among(files)
        _require_one(name, len(files[name]))
        if not files[name][0].isreg():
            raise _astray(files[name][0])
        return _tar_copy(archive, files[name][0], to, limit), name


def _zip_files(archive: Any) -> list[str]:
    """Return the names of all files in a zip archive."""
    import zipfile

    names: list[str] = archive.namelist()
    if "" in names:  # what is before a zero byte, which is the whole name
        raise zipfile.BadZipFile("a file in it has no name")
    return [name for name in names if not name.endswith("/")]


def _tar_copy(archive: Any, member: Any, to: Path, limit: float, used: int = 0) -> Path:
    with archive.extractfile(member) as stream:
        return _copy(stream, to, limit, used)


def _astray(member: Any) -> ReadError:
    """Return why an entry of a tar archive has no contents."""
    says = "it is a pipe or a device, and no file: leave it out"
    if member.islnk():
        says = "it is a hard link to a file that is not before it: pack it again, with that file"
    elif member.issym():
        return _no_file(member.linkname)
    return ReadError(says, code="damaged_archive")


def _no_file(target: str) -> ReadError:
    says = f"it is a link to {visible(target)}, which is no file in the archive: pack it again, with that file"
    return ReadError(says, code="damaged_archive")


def _tar_files(archive: Any, most: float = math.inf, room: float = math.inf) -> Iterator[tuple[str, Any]]:
    """Yield the name of every file in a tar archive, and the entry with its contents: of a link, another one's.

    Symbolic links come last, since they may lead to what is behind them. A link to no file in the archive, of a hard
    one to none before it, comes with its own entry, as pipes and devices do. Only so many entries are read, and bytes.
    """
    files: dict[str, Any] = {}
    links: list[Any] = []
    for number, member in enumerate(archive):
        if number >= most:
            raise ReadError(f"it has more than {most} entries: unpack it and give the mesh in it", code="too_large")
        if archive.offset > room:
            raise _bomb(room)
        if member.issym():
            links.append(member)
        elif not member.isdir():
            entry = files.get(normpath(member.linkname), member) if member.islnk() else member
            files[normpath(member.name)] = entry
            yield member.name, entry
    files = {normpath(member.name): member for member in links} | files
    for member in links:
        entry = member
        for _ in range(_LINKS):
            if entry is not None and entry.issym():
                entry = files.get(_led_to(entry.name, entry.linkname))
        yield member.name, member if entry is None or entry.issym() else entry


def _led_to(name: str, target: str) -> str:
    """Return the name in an archive that a symbolic link leads to."""
    return normpath(join(dirname(name), target))


_MESHES = frozenset(suffix for suffixes in EXTENSIONS.values() for suffix in suffixes)


def _in_zip(archive: Any, name: str) -> Any:
    """Return the entry of a name in a zip archive; of a symbolic link, the one that it leads to."""
    _require_one(name, sum(info.filename == name for info in archive.infolist()))
    info = archive.getinfo(name)
    target = ""
    for _ in range(_LINKS):
        if not stat.S_ISLNK(info.external_attr >> 16) or info.flag_bits & 1:
            return info
        with archive.open(info) as stream:
            target = stream.read(_BLOCK).decode(errors="replace")
        files = {normpath(each.filename): each for each in archive.infolist()}
        if (led_to := files.get(_led_to(info.filename, target))) is None:
            break
        info = led_to
    raise _no_file(target)


def _require_one(name: str, count: int) -> None:
    if count == 0:  # when the archive was listed, it was there
        raise ReadError(CHANGED, code="changed")
    if count > 1:
        raise ReadError(
            f"the archive holds {count} files called {visible(name)}, and nothing says which is meant: pack it again, "
            "each under a name of its own",
            code="several_meshes",
        )


def _mesh_among(files: Iterable[str]) -> str:
    """Return the name of the only mesh, or of the only file."""
    names = dict.fromkeys(files)
    if len(names) > _MEMBERS:
        raise ReadError(f"it has more than {_MEMBERS} entries: unpack it and give the mesh in it", code="too_large")
    seen = [name for name in names if not _is_hidden(name)] or list(names)
    meshes = [name for name in seen if PurePosixPath(name).suffix.lower() in _MESHES]
    if len(meshes) == 1 or (not meshes and len(seen) == 1):
        return (meshes or seen)[0]
    listed = ", ".join(visible(name) for name in (meshes or seen)[:_NAMED])
    more = f" and {len(meshes or seen) - _NAMED} more" if len(meshes or seen) > _NAMED else ""
    if meshes:
        raise ReadError(
            f"it holds {len(meshes)} meshes, {listed}{more}: unpack it and give the one that is meant",
            code="several_meshes",
        )
    raise ReadError(f"it holds no mesh{f', but {listed}{more}' if seen else ' at all'}: give a mesh", code="empty")


def _copy(stream: IO[bytes], to: Path, limit: float, used: int = 0) -> Path:
    """Write a stream to a file, and stop at the limit, of which some is used already."""
    size = used
    with to.open("xb") as file:
        while block := stream.read(_BLOCK):
            size += len(block)
            if size > limit:
                raise _bomb(limit)
            file.write(block)
    return to


def _bomb(limit: float) -> ReadError:
    says = f"it unpacks to more than {limit / 2**30:g} GiB: it is a decompression bomb, or give "
    return ReadError(says, _MORE, code="too_large")


@contextmanager
def _damage(kind: str) -> Iterator[None]:
    """Turn what the decompressors and the parsers of archives raise, which may be anything, into a `ReadError`."""
    try:
        yield
    except (InertiaError, MemoryError):
        raise
    except (NotImplementedError, RuntimeError) as error:
        raise ReadError(
            f"it is a {kind} file that is not read ({visible(str(error))}): unpack it", code="not_read"
        ) from None
    except Exception as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        raise ReadError(
            f"it is a damaged {kind} file ({visible(str(error))}): pack it again", code="damaged_archive"
        ) from None
