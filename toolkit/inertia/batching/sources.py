"""What a batch is asked for → files: globs, lists on standard input, manifests, archives and URLs."""

from __future__ import annotations

import csv
import glob
import os
import re
import sys
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

from inertia.encoding import require_no_utf_16
from inertia.errors import ReadError, Remedy, UsageError, placed, visible
from inertia.estimate import Estimate
from inertia.mesh.readers.compressed import ARCHIVE, UNPACK_LIMIT, member_copy, meshes_in
from inertia.output import temporary_folder
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.standard_input import reason_of
from inertia.tables import cell_text, load_pyarrow

_URL = re.compile(r"[a-z][a-z0-9+.-]+::?//")
_SEPARATORS = os.sep + (os.altsep or "")
_ANYWHERE = re.compile(rf"(?:^|(?<=[{re.escape(_SEPARATORS)}]))\*\*(?=[{re.escape(_SEPARATORS)}]|$)")
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
        if not path:
            raise UsageError("the path of a file is empty: name a file, or leave it out")
        if path.lower().endswith((".csv", ".parquet")) and not (verb == "audit" and path.lower().endswith(".csv")):
            rows = _rows(path, verb)
        elif path == STANDARD_INPUT:
            rows = (Task(line) for line in _lines())
            rows = _some(rows, "standard input names no file: give it a path a line")
        else:
            rows = (Task(name) for name in _matching(path))
        for task in rows:
            for each in _members(task):
                tasks.setdefault((each.path, repr(each.options)), each)
    for task in () if manifest is None else _rows(manifest, verb):
        for each in _members(task):
            tasks.setdefault((each.path, repr(each.options)), each)
    return list(tasks.values())


def _some(rows: Iterable[Task], otherwise: str) -> Iterator[Task]:
    """Yield rows; raise `UsageError` where there are none."""
    row = None
    for row in rows:
        yield row
    if row is None:
        raise UsageError(otherwise)


def _lines() -> Iterator[str]:
    """Yield the paths on standard input: one a line, or each with a zero byte behind it (``find -print0``)."""
    if sys.stdin is None:
        raise ReadError("standard input is closed: name files")
    data = sys.stdin.buffer.read()
    if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):  # as PowerShell writes
        data = data.decode("utf-16", "replace").encode()
    data = data.removeprefix(BOM_UTF8)
    for name in data.split(b"\0" if b"\0" in data else b"\n"):
        if line := name.rstrip(b"\r").decode(sys.getfilesystemencoding(), "surrogateescape"):
            yield line


def _matching(pattern: str) -> list[str]:
    """Return the files that a path, a glob or a URL stands for."""
    if _URL.match(pattern):
        return _remote(pattern)
    if not glob.has_magic(pattern) or Path(pattern).exists():
        return [pattern]
    names = sorted({name for name in _globbed(pattern) if not Path(name).is_dir()})
    if not names:
        raise UsageError(f"{visible(pattern)} matches no file: check it, with quotation marks round it in a shell")
    return names


def _globbed(pattern: str) -> Iterator[str]:
    """Yield what a glob matches; ``**`` passes over links to folders that it is in already, which have no end."""
    before, *behind = _ANYWHERE.split(pattern, maxsplit=1)
    if not behind:
        yield from glob.iglob(pattern)  # noqa: PTH207  # `Path.glob` rewrites the names
        return
    rest = behind[0].lstrip(_SEPARATORS) if behind[0] else "*"
    for top in glob.iglob(before) if before else [""]:  # noqa: PTH207
        for folder in _folders(top):
            yield from _globbed(glob.escape(folder) + rest)


def _folders(folder: str, above: tuple[tuple[int, int], ...] = ()) -> Iterator[str]:
    """Yield a folder and all that lie in it and are not hidden, each with a separator behind its name."""
    try:
        status = Path(folder).stat()
        with os.scandir(folder or ".") as entries:
            names = [entry.name for entry in entries if not entry.name.startswith(".") and Path(entry).is_dir()]
    except OSError:
        return
    own = status.st_dev, status.st_ino
    if own in above:
        return
    yield folder
    for name in names:
        yield from _folders(f"{folder}{name}{os.sep}", (*above, own))


def _require_back_end(url: str) -> None:
    """Raise `UsageError` where nothing is installed that reads such URLs."""
    try:
        import fsspec

        for each in url.split("::"):
            fsspec.get_filesystem_class(fsspec.utils.get_protocol(each))
    except ImportError as missing:
        raise UsageError(f"{visible(url)}: {missing}: install what reads such URLs") from None
    except ValueError as error:
        raise UsageError(f"{visible(url)}: {error}") from None


def _remote(pattern: str) -> list[str]:
    _require_back_end(pattern)
    if not glob.has_magic(pattern):
        return [pattern]
    import fsspec

    try:
        system, path = fsspec.core.url_to_fs(pattern)
        if not glob.has_magic(path):  # what looks like one is a question to a server
            return [pattern]
        names = sorted(system.unstrip_protocol(name) for name in system.glob(path))
    except Exception as error:  # of whatever back end it is
        raise ReadError(f"{visible(pattern)} cannot be listed: {visible(str(error))}") from None
    if not names:
        raise UsageError(f"{visible(pattern)} matches no file: check it")
    return names


def _members(task: Task) -> Iterator[Task]:
    """Yield a task for every mesh in an archive that has several, or an archive; the task itself for all others."""
    names: list[str] = []
    if ARCHIVE.search(task.path) and not _URL.match(task.path):
        with suppress(ReadError, OSError):  # it is said of the archive when it is its turn
            names = meshes_in(Path(task.path))
    if len(names) < 2 and not any(map(ARCHIVE.search, names)):
        yield task
        return
    for name in names:
        yield Task(f"{task.path}/{name}", task.options, task.path, name)


def _rows(manifest: str, verb: str) -> Iterator[Task]:
    """Yield a task for every row of a manifest, whose paths are relative to it."""
    known = OPTIONS[verb]
    number = 1
    for number, row in enumerate(_records(manifest), 2):
        where = f"{visible(manifest)}, row {number}"
        column = next((name for name in _PATHS if name in row), None)
        if column is None:
            raise UsageError(
                f"{visible(manifest)} has no column 'path', but {', '.join(repr(visible(name)) for name in row)}: name "
                "the column of paths so, and put commas between columns"
            )
        path, options = row[column], {}
        if path is not None and not isinstance(path, str):
            raise UsageError(f"{where}: the path is {visible(str(path))}, which is no text")
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
    if number == 1:
        raise UsageError(f"{visible(manifest)} names no file: give it a row for each")


def _records(manifest: str) -> Iterator[Mapping[str, Any]]:
    path = Path(manifest)
    if path.suffix.lower() == ".parquet":
        pyarrow = load_pyarrow()
        try:
            for batch in pyarrow.parquet.ParquetFile(path).iter_batches():
                yield from batch.to_pylist()
        except OSError as error:
            raise _unreadable(manifest, error) from None
        except pyarrow.ArrowException as error:
            says = f"cannot read {visible(manifest)}: it is no Parquet table ({visible(str(error))})"
            raise ReadError(f"{says}: write it again", code="wrong_format") from None
        return
    try:
        with path.open("rb") as file:
            require_no_utf_16(file.read(4))
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = csv.DictReader(file, strict=True)
            names = [name for name in rows.fieldnames or () if name]
            twice = next((name for name in names if names.count(name) > 1), None)
            if twice is not None:
                raise UsageError(f"{visible(manifest)} has two columns {visible(twice)!r}: leave one out")
            for row in rows:
                if any(row.pop(None, ())):  # cells behind the last column
                    raise UsageError(
                        f"{visible(manifest)}, line {rows.line_num}: it has more cells than there are columns: put "
                        "quotation marks round a cell with a comma in it"
                    )
                yield {name: cell_text(value) for name, value in row.items() if name and value is not None}
    except OSError as error:
        raise _unreadable(manifest, error) from None
    except ReadError as error:
        raise placed(error, f"cannot read {visible(manifest)}") from None
    except UnicodeDecodeError:
        says = "it is no table in UTF-8: save it as CSV in UTF-8"
        raise ReadError(f"cannot read {visible(manifest)}: {says}", code="encoding") from None
    except csv.Error as error:
        raise ReadError(
            f"cannot read {visible(manifest)}: it is no CSV ({error}): write it again", code="table"
        ) from None


def _unreadable(manifest: str, error: OSError) -> ReadError:
    return ReadError(f"cannot read {visible(manifest)}: {reason_of(error)}", code="no_file")


@contextmanager
def local_copy(task: Task, unpack_limit: float | None = None) -> Iterator[str]:
    """Yield the path of a file on this machine: what a URL or the name in an archive leads to is copied for a while."""
    if task.member:
        with ExitStack() as stack:
            try:
                copy = member_copy(Path(task.archive), task.member, unpack_limit or UNPACK_LIMIT)
                path = stack.enter_context(copy)
            except ReadError as error:
                raise placed(error, f"cannot read {task.path}") from None
            yield str(path)
    elif _URL.match(task.path):
        with temporary_folder() as folder:
            path = folder / f"part{Path(task.path).suffix}"
            _require_back_end(task.path)
            import fsspec

            try:
                system, name = fsspec.core.url_to_fs(task.path)
                system.get_file(name, str(path))
            except FileNotFoundError:
                says = f"cannot read {visible(task.path)}: there is no such file: check the URL"
                raise ReadError(says, code="no_file") from None
            except Exception as error:  # of whatever back end it is
                says = visible(str(error)) or type(error).__name__
                raise ReadError(f"cannot read {visible(task.path)}: {says}: check the URL and the network") from None
            yield str(path)
    else:
        yield task.path
