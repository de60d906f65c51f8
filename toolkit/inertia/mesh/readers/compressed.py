"""Compressed files and archives: the one mesh in a gzip, bzip2, xz, zip or tar file is unpacked, within a limit.

Nothing of an archive is trusted but the bytes of that member: it is written under a name of our own, into a folder of
this run that goes when it has been read. An archive within an archive is not opened, nor are several meshes.
"""

from __future__ import annotations

import atexit
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path, PurePosixPath
from typing import IO, Any, NamedTuple

from inertia.errors import ReadError, Remedy, visible
from inertia.mesh.readers.formats import EXTENSIONS, format_of_zip
from inertia.output import temporary_folder

UNPACK_LIMIT = 2.0
"""GiB that a compressed file may unpack to, unless told."""

ARCHIVE = re.compile(r"(?i)\.(zip|tar|tgz|tbz2?|txz|tar\.(gz|bz2|xz))$")
"""The names of archives that may hold several files."""

_MEMBERS = 10_000  # entries of an archive that are looked at
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
    bytes_left = limit * 2**30
    with temporary_folder() as folder, _damage(kind):
        source, name, how = path, path.name, kind
        if kind not in ("zip", "tar"):
            module = next(module for other, module in _STREAMS.values() if other == kind)
            opened: Callable[[Path], IO[bytes]] = __import__(module).open
            source, name = folder / "stream", re.sub(r"(?i)\.(gz|bz2|xz|gzip|lzma)$", "", path.name)
            with opened(path) as stream:
                _copy(stream, source, bytes_left)
            with source.open("rb") as file:
                head = file.read(512)
            if name.lower().endswith((".tgz", ".tbz", ".tbz2", ".txz")) or _is_tar(head):
                how, name = f"{kind} and tar", ""
            elif inner := packed_as(source, head):
                raise ReadError(
                    f"it is {kind} of {inner}, and archives in archives are not opened: unpack it", code="not_read"
                )
        if how == "zip":
            source, name = _from_zip(source, folder / "part", bytes_left)
        elif how.endswith("tar"):
            source, name = _from_tar(source, folder / "part", bytes_left)
            (folder / "stream").unlink(missing_ok=True)
        suffix = PurePosixPath(name).suffix.lower()
        if suffix in _MESHES:
            source = source.rename(folder / f"part{suffix}")
        yield Unpacked(source, visible(name), f"unpacked from {how}: {visible(name)}, {source.stat().st_size} bytes")


def meshes_in(path: Path) -> list[str]:
    """Return the names of all meshes and archives in a zip or tar archive, in its order.

    Raises `ReadError` where it is damaged.
    """
    import tarfile
    import zipfile

    with _damage("zip or tar"):
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as archive:
                names = [info.filename for info in archive.infolist() if not info.is_dir()]
        else:
            with tarfile.open(path) as stream:
                names = [member.name for member in stream if member.isreg()]
    return [name for name in dict.fromkeys(names) if _is_mesh(name) or _is_archive(name)]


@contextmanager
def member_copy(path: Path, name: str, limit: float) -> Iterator[Path]:
    """Yield a copy of one mesh among several in a zip or tar archive, within a limit in GiB as `unpacked` has it.

    A tar archive can be read from its beginning only: it is unpacked once, and stays so until the next one's turn.
    """
    import zipfile

    bytes_left, suffix = limit * 2**30, PurePosixPath(name).suffix.lower()
    with _damage("zip or tar"):
        if not zipfile.is_zipfile(path):
            places = _tar_members(path, bytes_left)[name]
            _require_one(name, len(places))
            yield places[0]
            return
        with temporary_folder() as folder:
            with zipfile.ZipFile(path) as archive:
                info = _in_zip(archive, name)
                if info.flag_bits & 1:
                    raise ReadError("it is encrypted: unpack it and give the mesh in it", code="encrypted")
                with archive.open(info) as stream:
                    copy = _copy(stream, folder / f"part{suffix}", bytes_left)
            yield copy


_last_tar: list[tuple[object, ExitStack, dict[str, list[Path]]]] = []


def _tar_members(path: Path, limit: float) -> dict[str, list[Path]]:
    """Return where the meshes of a tar archive lie unpacked, by their names: one each, unless names repeat."""
    import tarfile

    status = path.stat()
    version = str(path), status.st_ino, status.st_size, status.st_mtime_ns
    if not _last_tar or _last_tar[0][0] != version:
        _forget_tar()
        stack, files = ExitStack(), dict[str, list[Path]]()
        folder = stack.enter_context(temporary_folder())
        _last_tar.append((version, stack, files))
        with tarfile.open(path) as archive:
            for number, member in enumerate(archive):
                wanted = member.isreg() and (_is_mesh(member.name) or _is_archive(member.name))
                if wanted and (stream := archive.extractfile(member)) is not None:
                    place = folder / f"{number}{PurePosixPath(member.name).suffix.lower()}"
                    files.setdefault(member.name, []).append(_copy(stream, place, limit))
                    limit -= member.size
    return _last_tar[0][2]


@atexit.register
def _forget_tar() -> None:
    while _last_tar:
        _last_tar.pop()[1].close()


def _is_mesh(name: str) -> bool:
    path = PurePosixPath(name)
    return path.suffix.lower() in _MESHES and not path.name.startswith(".") and "__MACOSX" not in name


def _is_archive(name: str) -> bool:
    return ARCHIVE.search(name) is not None and "__MACOSX" not in name


def _is_tar(head: bytes) -> bool:
    return head[257:262] == b"ustar"


def _from_zip(path: Path, to: Path, limit: float) -> tuple[Path, str]:
    import zipfile

    with zipfile.ZipFile(path) as archive:
        files = [info.filename for info in archive.infolist() if not info.is_dir()]
        info = _in_zip(archive, _mesh_among(files))
        if info.flag_bits & 1:
            raise ReadError("it is encrypted: unpack it and give the mesh in it", code="encrypted")
        with archive.open(info) as stream:
            return _copy(stream, to, limit), info.filename


def _from_tar(path: Path, to: Path, limit: float) -> tuple[Path, str]:
    import tarfile

    with tarfile.open(path, "r:") as archive:
        files: dict[str, list[Any]] = {}
        for number, member in enumerate(archive):
            if number >= _MEMBERS:
                raise ReadError(
                    f"it has more than {_MEMBERS} entries: unpack it and give the mesh in it", code="too_large"
                )
            if member.isreg():
                files.setdefault(member.name, []).append(member)
        name = _mesh_among(files)
        _require_one(name, len(files[name]))
        stream = archive.extractfile(files[name][0])
        assert stream is not None  # it is a regular file
        with stream:
            return _copy(stream, to, limit), name


_MESHES = frozenset(suffix for suffixes in EXTENSIONS.values() for suffix in suffixes)


def _in_zip(archive: Any, name: str) -> Any:
    """Return the entry of a name in a zip archive."""
    _require_one(name, sum(info.filename == name for info in archive.infolist()))
    return archive.getinfo(name)


def _require_one(name: str, count: int) -> None:
    if count > 1:
        raise ReadError(
            f"it holds {count} files called {visible(name)}, and nothing says which is meant: pack it again, each "
            "under a name of its own",
            code="several_meshes",
        )


def _mesh_among(files: Iterable[str]) -> str:
    """Return the name of the only mesh, or of the only file."""
    names = dict.fromkeys(files)
    if len(names) > _MEMBERS:
        raise ReadError(f"it has more than {_MEMBERS} entries: unpack it and give the mesh in it", code="too_large")
    seen = [name for name in names if not PurePosixPath(name).name.startswith(".") and "__MACOSX" not in name]
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
    raise ReadError(f"it holds no mesh, but {listed + more if seen else 'nothing'}: give a mesh", code="empty")


def _copy(stream: IO[bytes], to: Path, limit: float) -> Path:
    """Write a stream to a file, and stop at the limit."""
    size = 0
    with to.open("xb") as file:
        while block := stream.read(_BLOCK):
            size += len(block)
            if size > limit:
                raise ReadError(
                    f"it unpacks to more than {limit / 2**30:g} GiB: it is a decompression bomb, or give ",
                    _MORE,
                    code="too_large",
                )
            file.write(block)
    return to


@contextmanager
def _damage(kind: str) -> Iterator[None]:
    """Turn what the decompressors raise into a `ReadError`."""
    import lzma
    import tarfile
    import zipfile
    import zlib

    damage = (EOFError, zlib.error, lzma.LZMAError, tarfile.TarError, zipfile.BadZipFile, zipfile.LargeZipFile)
    try:
        yield
    except damage as error:
        raise ReadError(
            f"it is a damaged {kind} file ({visible(str(error))}): pack it again", code="damaged_archive"
        ) from None
    except (NotImplementedError, RuntimeError) as error:
        raise ReadError(
            f"it is a {kind} file that is not read ({visible(str(error))}): unpack it", code="not_read"
        ) from None
    except OSError as error:
        if error.errno is not None:
            raise
        raise ReadError(
            f"it is a damaged {kind} file ({visible(str(error))}): pack it again", code="damaged_archive"
        ) from None
