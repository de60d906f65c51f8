"""What a batch is asked for → files: globs, lists on standard input, manifests, archives and URLs."""

from __future__ import annotations

import csv
import glob
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

from inertia.errors import ReadError, Remedy, UsageError, visible
from inertia.estimate import Estimate
from inertia.mesh.readers.compressed import UNPACK_LIMIT, member_copy, meshes_in
from inertia.output import temporary_folder
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.tables import cell_text

_ARCHIVE = re.compile(r"(?i)\.(zip|tar|tgz|tbz2?|txz|tar\.(gz|bz2|xz))$")
_URL = re.compile(r"[a-z][a-z0-9+.-]+::?//")
_PATHS = ("path", "file", "part")
_MANIFEST = Remedy("batch", "manifest", "FILE")


class Task(NamedTuple):
    """A file to answer for.

    Attributes
    ----------
    path : as the row has it
    options : its own, beside those of all files
    archive, member : where it lies in an archive: that, and the name in it
    """

    path: str
    options: Mapping[str, Any] = {}
    archive: str = ""
    member: str = ""


def _flag(text: str) -> bool:
    if text.lower() in ("true", "yes", "1"):
        return True
    if text.lower() in ("false", "no", "0"):
        return False
    raise ValueError(text)


def _by_name(read: Callable[[str], Any]) -> Callable[[str], Any]:
    """Return what reads a value, or several as ``housing=2700; shaft=7850``."""

    def value(text: str) -> Any:
        if "=" not in text:
            return read(text)
        pairs = (entry.rpartition("=") for entry in text.split(";"))
        return {name.strip(): read(one) for name, _, one in pairs}

    return value


def _accuracy(text: str) -> float | str:
    return "exact" if text == "exact" else float(text)


def _material(text: str) -> str:
    return text.strip()


_MESH: dict[str, Callable[[str], Any]] = {
    "unit": str, "format": str, "unpack_limit": float, "orientation": str, "intersections": _flag, "parts": str,
}  # fmt: skip
OPTIONS: dict[str, dict[str, Callable[[str], Any]]] = {
    "analyse": {
        **_MESH,
        "density": _by_name(Estimate.parse),
        "material": _by_name(_material),
        "mass": Estimate.parse,
        "accuracy": _accuracy,
        "shell": Estimate.parse,
        "wire": Estimate.parse,
        "union": _flag,
        "allow_faults": float,
        "tessellated": _flag,
        "chord": float,
        "class_tolerance": float,
        "sigma": float,
        "scale": Estimate.parse,
    },
    "check": _MESH,
    "balance": {"time": float},
    "audit": {"density": _by_name(float), "tolerance": float, "lump": _flag},
}
"""The options of each verb, and how each is read from a cell of a manifest."""


def tasks_of(paths: Iterable[str], verb: str, manifest: str | None = None) -> list[Task]:
    """Return a task for every file that is named, in an order that depends on the names alone; each file once.

    A glob stands for its files in the order of their names, a manifest for its rows, an archive for its meshes, and
    ``-`` for the paths on standard input.

    Raises
    ------
    UsageError : a glob that matches nothing, a column of a manifest that is no option, ...
    ReadError : a manifest cannot be read
    """
    tasks: dict[Any, Task] = {}
    for path in paths:
        if path.lower().endswith((".csv", ".parquet")) and not (verb == "audit" and path.lower().endswith(".csv")):
            rows = _rows(path, verb)
        elif path == STANDARD_INPUT:
            rows = (Task(line) for line in _lines())
        else:
            rows = (Task(name) for name in _matching(path))
        for task in rows:
            for each in _members(task):
                tasks.setdefault((each.path, repr(each.options)), each)
    for task in () if manifest is None else _rows(manifest, verb):
        for each in _members(task):
            tasks.setdefault((each.path, repr(each.options)), each)
    return list(tasks.values())


def _lines() -> Iterator[str]:
    """Yield the paths on standard input: one a line, or each with a zero byte behind it (``find -print0``)."""
    if sys.stdin is None:
        raise ReadError("standard input is closed: name files")
    data = sys.stdin.buffer.read()
    for name in data.split(b"\0" if b"\0" in data else b"\n"):
        if line := name.rstrip(b"\r").decode(sys.getfilesystemencoding(), "surrogateescape"):
            yield line


def _matching(pattern: str) -> list[str]:
    """Return the files that a path, a glob or a URL stands for."""
    if _URL.match(pattern):
        return _remote(pattern)
    if not glob.has_magic(pattern) or Path(pattern).exists():
        return [pattern]
    matches = glob.iglob(pattern, recursive=True)  # noqa: PTH207  # `Path.glob` rewrites the names
    names = sorted(name for name in matches if not Path(name).is_dir())
    if not names:
        raise UsageError(f"{visible(pattern)} matches no file: check it, with quotation marks round it in a shell")
    return names


def _file_system(url: str) -> tuple[Any, str]:
    try:
        import fsspec

        system, path = fsspec.core.url_to_fs(url)
    except ImportError as missing:
        raise UsageError(f"{visible(url)}: {missing}: install what reads such URLs") from None
    except ValueError as error:
        raise UsageError(f"{visible(url)}: {error}") from None
    return system, path


def _remote(pattern: str) -> list[str]:
    system, path = _file_system(pattern)
    if not glob.has_magic(path):
        return [pattern]
    try:
        names = sorted(system.unstrip_protocol(name) for name in system.glob(path))
    except Exception as error:  # of whatever back end it is
        raise ReadError(f"{visible(pattern)} cannot be listed: {visible(str(error))}") from None
    if not names:
        raise UsageError(f"{visible(pattern)} matches no file: check it")
    return names


def _members(task: Task) -> Iterator[Task]:
    """Yield a task for every mesh in an archive that has several; the task itself for all others."""
    names: list[str] = []
    if _ARCHIVE.search(task.path) and not _URL.match(task.path):
        with suppress(ReadError, OSError):  # it is said of the archive when it is its turn
            names = meshes_in(Path(task.path))
    if len(names) < 2:
        yield task
        return
    for name in names:
        yield Task(f"{task.path}/{name}", task.options, task.path, name)


def _rows(manifest: str, verb: str) -> Iterator[Task]:
    """Yield a task for every row of a manifest, whose paths are relative to it."""
    known = OPTIONS[verb]
    for number, row in enumerate(_records(manifest), 2):
        where = f"{visible(manifest)}, row {number}"
        column = next((name for name in _PATHS if name in row), None)
        if column is None:
            raise UsageError(f"{visible(manifest)} has no column 'path': name the column of paths so")
        path, options = row[column], {}
        for name, value in row.items():
            if name == column or not name or name.startswith("#") or value in (None, ""):
                continue
            if name not in known:
                raise UsageError(
                    f"{visible(manifest)}: column {visible(name)!r} is no option of {verb} ({', '.join(known)}): "
                    "rename it, or put # before its name to have it passed over"
                )
            try:
                options[name] = known[name](str(value).strip())
            except ValueError:
                raise UsageError(f"{where}: {name} is {visible(str(value))!r}, which it cannot be") from None
        if not path:
            raise UsageError(f"{where}: the path is empty")
        for name in _matching(path if _URL.match(path) else str(Path(manifest).parent / path)):
            yield Task(name, options)


def _records(manifest: str) -> Iterator[Mapping[str, Any]]:
    path = Path(manifest)
    try:
        if path.suffix.lower() == ".parquet":
            import pyarrow.parquet

            for batch in pyarrow.parquet.ParquetFile(path).iter_batches():
                yield from batch.to_pylist()
            return
        with path.open(encoding="utf-8-sig", newline="") as file:
            for row in csv.DictReader(file):
                yield {name: cell_text(value) for name, value in row.items() if name and value is not None}
    except OSError as error:
        raise ReadError(f"cannot read {visible(manifest)}: {error.strerror or error}", code="no_file") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise ReadError(
            f"cannot read {visible(manifest)}: it is no table in UTF-8 ({error})", code="encoding"
        ) from None


@contextmanager
def local_copy(task: Task, unpack_limit: float | None = None) -> Iterator[str]:
    """Yield the path of a file on this machine: what a URL or the name in an archive leads to is copied for a while."""
    if task.member:
        with member_copy(Path(task.archive), task.member, unpack_limit or UNPACK_LIMIT) as path:
            yield str(path)
    elif _URL.match(task.path):
        with temporary_folder() as folder:
            path = folder / f"part{Path(task.path).suffix}"
            try:
                system, name = _file_system(task.path)
                system.get_file(name, str(path))
            except Exception as error:  # of whatever back end it is
                raise ReadError(f"cannot read {visible(task.path)}: {visible(str(error))}") from None
            yield str(path)
    else:
        yield task.path
