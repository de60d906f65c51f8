"""What a batch is asked for → files: globs, lists on standard input, manifests, archives and URLs."""

from __future__ import annotations

import csv
import errno
import glob
import io
import os
import re
import stat
import sys
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from itertools import chain, repeat
from pathlib import Path
from typing import Any, NamedTuple

from inertia.batching.columns import SCHEMA
from inertia.encoding import text_of
from inertia.errors import InertiaError, ReadError, Remedy, UsageError, placed, visible
from inertia.estimate import Estimate, relative_figure, scale_of
from inertia.mesh.readers.compressed import ARCHIVE, UNPACK_LIMIT, is_packed, member_copy, meshes_in
from inertia.mesh.readers.contents import alone
from inertia.output import note_input, status_of, temporary_folder
from inertia.standard_input import FULL, NO_FILE, reason_of
from inertia.standard_input import NAME as STANDARD_INPUT
from inertia.tables import SUFFIXES, cell_text, load_pyarrow, read_table

_URL = re.compile(r"[a-z][a-z0-9+.-]+(?:::[a-z][a-z0-9+.-]+)*::?//")
_SEPARATORS = os.sep + (os.altsep or "")
_ANYWHERE = re.compile(rf"(?:^|(?<=[{re.escape(_SEPARATORS)}]))\*\*(?=[{re.escape(_SEPARATORS)}]|$)")
PART = re.compile(r"[0-9a-f]{16}\.jsonl")
"""The names of finished rows of a batch under way, in the folder ``TABLE.parts``."""

_PATHS = ("path", "file", "part")
_BETWEEN = {",": "comma", ";": "semicolon", "\t": "tab"}
"""What stands between the columns of a manifest: the first of them in the line of their names."""

_MANIFEST = Remedy("batch", "manifest", "FILE")


class Task(NamedTuple):
    """A file to answer for.

    Attributes
    ----------
    path : as the row has it
    options : its own, beside those of all files
    archive, member : where it lies in an archive: that, and the name in it; "" of an archive or URL that is not opened
    """

    path: str
    options: Mapping[str, Any] = {}
    archive: str = ""
    member: str = ""

    @property
    def file(self) -> str:
        """The file that it is read out of."""
        return self.archive or self.path


class Cell(NamedTuple):
    """What a cell of a manifest holds: what reads it, which raises `ValueError`, and in words."""

    read: Callable[[str], Any]
    holds: str


class _TwiceError(ValueError):
    """A name in a cell that has two values."""


def _flag(text: str) -> bool:
    if text.lower() in ("true", "yes", "1"):
        return True
    if text.lower() in ("false", "no", "0"):
        return False
    raise ValueError(text)


def _by_name(cell: Cell) -> Cell:
    """Return a cell with such a value, or several as ``housing=2700; shaft=7850``."""

    def value(text: str) -> Any:
        if "=" not in text:
            return cell.read(text)
        values: dict[str, Any] = {}
        for entry in text.split(";"):
            name, _, one = entry.rpartition("=")
            if (name := name.strip()) in values:
                raise _TwiceError(repr(visible(name)) if name else "the part")
            values[name] = cell.read(one)
        return dict(sorted(values.items()))  # the same however it is written

    return Cell(value, f"{cell.holds}, or one for each region or body as housing=2700; shaft=7850")


def _accuracy(text: str) -> float | str:
    return "exact" if text == "exact" else float(text)


def _estimate(example: str) -> Cell:
    return Cell(Estimate.parse, f"a number, alone or with its standard uncertainty as {example}")


_NUMBER = Cell(float, "a number")
_TEXT = Cell(str.strip, "text")
_FLAG = Cell(_flag, "yes or no")

_MESH = {
    "unit": _TEXT, "format": _TEXT, "unpack_limit": _NUMBER, "orientation": _TEXT, "intersections": _FLAG,
    "parts": _TEXT,
}  # fmt: skip
OPTIONS: dict[str, dict[str, Cell]] = {
    "analyse": {
        **_MESH,
        "density": _by_name(_estimate("7850±50")),
        "material": _by_name(_TEXT),
        "mass": _estimate("1.2±0.001"),
        "accuracy": Cell(_accuracy, "a number, or exact"),
        "shell": _estimate("1.5±0.1"),
        "wire": _estimate("1.5±0.1"),
        "union": _FLAG,
        "allow_faults": Cell(relative_figure, "a number, as 0.01 or 1%"),
        "tessellated": _FLAG,
        "chord": _NUMBER,
        "class_tolerance": _NUMBER,
        "sigma": _NUMBER,
        "scale": Cell(scale_of, "1 with its standard uncertainty, as 1±0.001"),
    },
    "check": _MESH,
    "balance": {"time": _NUMBER},
    "audit": {"density": _by_name(_NUMBER), "tolerance": _NUMBER, "lump": _FLAG},
}
"""The options of each verb, and how each is read from a cell of a manifest."""


def tasks_of(
    paths: Iterable[str], verb: str, manifest: str | None = None, unpack_limit: float = UNPACK_LIMIT
) -> list[Task]:
    """Return a task for every file that is named, in an order that depends on the names alone; each file once.

    A glob stands for its files in the order of their names, a manifest for its rows, an archive for its meshes, and
    ``-`` for the paths on standard input. What an archive may unpack to, GiB, is its own option's, or `unpack_limit`.

    Raises
    ------
    UsageError : a glob that matches nothing, a column of a manifest that is no option, ...
    ReadError : a manifest cannot be read
    """
    tasks: dict[Any, Task] = {}
    if manifest is not None:
        _require_path(manifest)
    named = chain.from_iterable(_named(path, verb) for path in paths)
    for task in chain(named, () if manifest is None else _rows(manifest, verb)):
        for each in _members(task, verb, unpack_limit):
            tasks.setdefault((each.path, repr(each.options)), each)
    return list(tasks.values())


def _named(path: str, verb: str) -> Iterable[Task]:
    """Return the files that an argument names; it may be a glob of manifests too, by its ending."""
    _require_path(path)
    if path.lower().endswith((".csv", ".parquet")) and not (verb == "audit" and path.lower().endswith(".csv")):
        manifests = [path] if _URL.match(path) else _matching(path)
        for name in manifests:
            if name != path and (status := status_of(name)) is not None and not stat.S_ISREG(status.st_mode):
                says = "it is not a regular file but a pipe, socket or device: give it by its name if it is a manifest"
                raise ReadError(f"cannot read {visible(name)}: {says}")
        return chain.from_iterable(_rows(name, verb) for name in manifests)
    if path == STANDARD_INPUT:
        return _some(map(Task, _lines()), "standard input names no file: give it a path a line")
    return map(Task, _matching(path))


def _require_path(path: str) -> None:
    if not path:
        raise UsageError("the path of a file is empty: name a file, or leave it out")


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
    # A line may end as on Windows; with zero bytes between them, names are as they stand.
    names = data.split(b"\0") if b"\0" in data else [line.rstrip(b"\r") for line in data.split(b"\n")]
    for name in names:
        if name:
            yield name.decode(sys.getfilesystemencoding(), "surrogateescape")


def _matching(pattern: str) -> list[str]:
    """Return the files that a path, a glob or a URL stands for."""
    if _URL.match(pattern):
        return _remote(pattern)
    if "\0" in pattern or not glob.has_magic(pattern):  # no name has a zero byte
        return [pattern]
    with suppress(OSError):  # it may be too long for a name
        if Path(pattern).exists():
            return [pattern]
    files = {name for name in _globbed(pattern) if not os.path.isdir(name)}  # noqa: PTH112  # never raises
    names = sorted(name for name in files if not _is_of_a_batch(Path(name)))
    if not names:
        raise UsageError(f"{visible(pattern)} matches no file: check it, with quotation marks round it in a shell")
    return names


def _is_of_a_batch(path: Path) -> bool:
    """Say whether a file is what a batch wrote: a table, what stands beside it, or finished rows of one under way."""
    if PART.fullmatch(path.name) and path.parent.suffix == ".parts":
        return True
    table = path.with_name(path.name.removesuffix(".meta.json") or path.name)
    with suppress(InertiaError):
        return table.suffix.lower() in SUFFIXES and read_table(table)[0]["schema"] == SCHEMA
    return False


def _globbed(pattern: str) -> Iterator[str]:
    """Yield what a glob matches; ``**`` passes over links to folders that it is in already, which have no end."""
    before, *behind = _ANYWHERE.split(pattern, maxsplit=1)
    _require_listed(before)
    if not behind:
        yield from glob.iglob(pattern)  # noqa: PTH207  # `Path.glob` rewrites the names
        return
    rest = behind[0].lstrip(_SEPARATORS) if behind[0] else "*"
    for top in glob.iglob(before) if before else [""]:  # noqa: PTH207
        for folder in _folders(top):
            yield from _globbed(glob.escape(folder) + rest)


_NO_FOLDER = (errno.ENOENT, errno.ENOTDIR, errno.ELOOP, errno.ENAMETOOLONG)


def _require_listed(pattern: str) -> None:
    """Raise `ReadError` where a folder that a glob looks through may not be, which `glob` passes over in silence."""
    above, name = os.path.split(pattern)
    if glob.has_magic(above):
        _require_listed(above)
    elif not glob.has_magic(name):
        return
    for folder in glob.iglob(above) if glob.has_magic(above) else [above]:  # noqa: PTH207
        try:
            if glob.has_magic(name):
                os.scandir(folder or ".").close()
            else:
                Path(folder, name).lstat()
        except ValueError:  # a name that no file can have
            continue
        except OSError as error:
            _require_no_folder(folder, error)


def _require_no_folder(folder: str, error: OSError) -> None:
    """Raise `ReadError` where a folder cannot be listed, unless it is none: its files would be missing unnoticed."""
    if error.errno not in _NO_FOLDER:
        says = f"{reason_of(error)}, or give the files that are meant by name"
        raise ReadError(f"cannot list {visible(folder) or '.'}: {says}", code="no_file") from None


def _folders(folder: str, above: tuple[tuple[int, int], ...] = ()) -> Iterator[str]:
    """Yield a folder and all that lie in it and are not hidden, each with a separator behind its name."""
    try:
        status = Path(folder).stat()
        with os.scandir(folder or ".") as entries:
            names = [entry.name for entry in entries if not entry.name.startswith(".") and _may_be_folder(entry)]
    except OSError as error:
        _require_no_folder(folder, error)
        return
    own = status.st_dev, status.st_ino
    if own in above:
        return
    yield folder
    for name in names:
        yield from _folders(f"{folder}{name}{os.sep}", (*above, own))


def _may_be_folder(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.is_dir()
    except OSError as error:  # of a link
        return error.errno not in _NO_FOLDER


def is_url(path: str) -> bool:
    """Say whether a path is a URL."""
    return _URL.match(path) is not None


def _require_back_end(url: str) -> None:
    """Raise `UsageError` where nothing is installed that reads such URLs."""
    try:
        import fsspec

        for each in url.split("::"):
            fsspec.get_filesystem_class(fsspec.utils.get_protocol(each))
    except ImportError as missing:
        raise UsageError(f"{visible(url)}: {missing}: install what reads such URLs") from None
    except ValueError as error:
        says = f"{visible(url)}: {error}: check how it begins, or copy the file to this machine"
        raise UsageError(says) from None


def _remote(pattern: str) -> list[str]:
    _require_back_end(pattern)
    if not glob.has_magic(pattern):
        return [pattern]
    import fsspec

    try:
        system, path = fsspec.core.url_to_fs(pattern)
        if not glob.has_magic(path):  # what looks like one is a question to a server
            return [pattern]
        chain_behind = "".join(pattern.partition("://")[2].partition("::")[1:])  # as of zip://*.stl::https://...
        names = sorted(f"{system.unstrip_protocol(name)}{chain_behind}" for name in system.glob(path))
    except Exception as error:  # of whatever back end it is
        says = f"{visible(pattern)} cannot be listed: {visible(str(error))}"
        raise ReadError(f"{says}: copy the files to this machine, or name each") from None
    if not names:
        raise UsageError(f"{visible(pattern)} matches no file: check it")
    return names


def _members(task: Task, verb: str, unpack_limit: float) -> Iterator[Task]:
    """Yield a task for every mesh in an archive that has several, or an archive; the task itself for all others."""
    if task.path == STANDARD_INPUT:  # which an argument alone stands for: among files, one has that name
        task = task._replace(path=f".{os.sep}{STANDARD_INPUT}")
    names: list[str] = []
    is_archive = _is_archive(task.path)
    if "unpack_limit" not in OPTIONS[verb] and (is_archive or _URL.match(task.path)):
        yield task._replace(archive=task.path)
        return
    if is_archive:
        with suppress(ReadError, OSError):  # it is said of the archive when it is its turn
            names = meshes_in(Path(task.path), task.options.get("unpack_limit", unpack_limit))
    if len(names) < 2 and not any(map(is_packed, names)):
        yield task
        return
    for name in names:
        yield Task(f"{task.path}/{name}", task.options, task.path, name)


def _is_archive(path: str) -> bool:
    """Say whether a file is one by its name; what is no regular file, as a pipe, is left to whoever answers for it."""
    if ARCHIVE.search(path) and not _URL.match(path):
        with suppress(OSError):
            return Path(path).is_file()
    return False


def _rows(manifest: str, verb: str) -> Iterator[Task]:
    """Yield a task for every row of a manifest, whose paths are relative to it, and names as they stand."""
    known = OPTIONS[verb]
    path = Path(manifest)
    folder = Path() if path.is_relative_to("/dev") else path.parent  # no file lies beside a pipe of the shell's
    is_csv = path.suffix.lower() != ".parquet"
    number = None
    for number, row in _records(manifest, known):
        where = f"{visible(manifest)}, row {number}"
        column = next((name for name in _PATHS if name in row), None)
        if column is None:
            listed = ", ".join(repr(visible(name)) for name in row)
            commas = ", and put commas between columns" if is_csv else ""
            raise UsageError(
                f"{visible(manifest)} has no column 'path', but {listed}: name the column of paths so{commas}"
            )
        name, options = row[column], {}
        if name is not None and not isinstance(name, str):
            raise UsageError(f"{where}: the path is {visible(str(name))}, which is no text")
        if name and is_csv:
            name = _file_of_cell(name, folder, where)
        for option, value in row.items():
            if option == column or not option or option.startswith("#") or value in (None, "") or value != value:
                continue  # NaN is what many programs store where there is no number
            if option not in known:
                raise UsageError(
                    f"{visible(manifest)}: column {visible(option)!r} is no option of {verb} ({', '.join(known)}): "
                    "rename it, or put # before its name to have it passed over"
                )
            try:
                options[option] = known[option].read(str(value).strip())
            except _TwiceError as twice:
                raise UsageError(f"{where}: {option} is given twice for {twice}: give it once") from None
            except ValueError:
                raise UsageError(f"{where}: {option} is {visible(str(value))!r}: give {known[option].holds}") from None
        if not name:
            raise UsageError(f"{where}: the path is empty")
        yield Task(name if _URL.match(name) else str(folder / name), dict(sorted(options.items())))
    if number is None:
        raise UsageError(f"{visible(manifest)} names no file: give it a row for each")


def _file_of_cell(cell: str, folder: Path, where: str) -> str:
    """Return the file that a cell of CSV names, whose apostrophe may be its own, or the one before a formula."""
    text = cell_text(cell)
    if text == cell or not os.path.lexists(folder / cell):
        return text
    if os.path.lexists(folder / text):
        raise UsageError(
            f"{where}: the path {visible(cell)} may be that file or {visible(text)}, and both are there: put ./ before "
            "the one that is meant"
        )
    return cell


def _columns(manifest: str, written: Iterable[str], known: Collection[str]) -> list[str]:
    """Return the names of columns, those that are known in lower case; raise `UsageError` where two are the same."""
    names = [low if (low := name.strip().lower()) in known or low in _PATHS else name for name in written]
    twice = next((name for name in names if name and names.count(name) > 1), None)
    if twice is not None:
        raise UsageError(f"{visible(manifest)} has two columns {visible(twice)!r}: leave one out")
    return names


def _records(manifest: str, known: Collection[str]) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield the rows of a manifest, each with its number.

    In CSV that is the one in a spreadsheet, where the names of columns are row 1; the first row of Parquet is row 1.
    """
    if _URL.match(manifest):
        raise UsageError(f"{visible(manifest)} is a URL, and a manifest is read from a file: copy it to this machine")
    path = Path(manifest)
    names: list[str] = []
    note_input(path)
    if path.suffix.lower() == ".parquet":
        pyarrow = load_pyarrow()
        try:
            file = pyarrow.parquet.ParquetFile(path)
            names = _columns(manifest, file.schema_arrow.names, known)
            batches = (batch.rename_columns(names).to_pylist() for batch in file.iter_batches())
            yield from enumerate(chain.from_iterable(batches), 1)
        except OSError as error:
            raise _unreadable(manifest, error) from None
        except pyarrow.ArrowException as error:
            says = f"cannot read {visible(manifest)}: it is no Parquet table ({visible(str(error))})"
            raise ReadError(f"{says}: write it again", code="wrong_format") from None
        return
    text = _text(manifest)
    head = text.lstrip("\r\n").partition("\n")[0]
    between = next((each for each in _BETWEEN if each in head), ",")
    rows = csv.reader(io.StringIO(text, newline=""), strict=True, delimiter=between)
    try:
        for number, cells in enumerate(rows, 1):
            if not names:
                names = _columns(manifest, cells, known)
                continue
            if any(cells[len(names) :]):
                raise UsageError(
                    f"{visible(manifest)}, line {rows.line_num}: it has more cells than there are columns: put "
                    f"quotation marks round a cell with a {_BETWEEN[between]} in it"
                )
            if cells:
                values = zip(names, chain(cells, repeat("")), strict=False)
                yield number, {name: value if name in _PATHS else cell_text(value) for name, value in values if name}
    except csv.Error as error:
        raise ReadError(
            f"cannot read {visible(manifest)}: it is no CSV ({error}): write it again", code="table"
        ) from None


def _text(manifest: str) -> str:
    """Return the text of a manifest, which is read once: it may come out of a pipe."""
    try:
        return text_of(Path(manifest).read_bytes(), "save it as CSV in UTF-8")
    except OSError as error:
        raise _unreadable(manifest, error) from None
    except ReadError as error:
        raise placed(error, f"cannot read {visible(manifest)}") from None
    except ValueError:  # a zero byte in the name
        raise ReadError(f"cannot read {visible(manifest)}: {NO_FILE}", code="no_file") from None


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
            except OSError as error:  # it was there when the archives were listed
                raise _unreadable(task.path, error) from None
            yield str(path)
    elif task.archive:
        says = "archives are opened for meshes only: unpack it and give the files in it"
        if _URL.match(task.path):
            says = "URLs are read of meshes only: copy it to this machine, with the files that it refers to"
        raise ReadError(f"cannot read {visible(task.path)}: {says}", code="not_read")
    elif _URL.match(task.path):
        with temporary_folder() as folder, alone():
            _require_back_end(task.path)
            import fsspec

            try:
                system, name = fsspec.core.url_to_fs(task.path)
                path = folder / f"part{Path(name).suffix}"  # of a chain, the suffix of the file in it
                system.get_file(name, str(path))
            except FileNotFoundError:
                says = f"cannot read {visible(task.path)}: there is no such file: check the URL"
                raise ReadError(says, code="no_file") from None
            except Exception as error:  # of whatever back end it is
                if isinstance(error, OSError) and error.errno in FULL:
                    raise _unreadable(task.path, error) from None
                says = visible(str(error)) or type(error).__name__
                raise ReadError(f"cannot read {visible(task.path)}: {says}: check the URL and the network") from None
            yield str(path)
    else:
        yield task.path
