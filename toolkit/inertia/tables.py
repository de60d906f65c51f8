"""Tables: CSV in which no text is a formula, and tables with typed columns as CSV, JSON lines or Parquet.

CSV and JSON lines cannot say what their columns hold; a file beside them, whose name goes on with ``.meta.json``, does.
In Parquet that stands in the metadata, under `inertia`, and with each column.
"""

from __future__ import annotations

import csv
import errno
import io
import json
import math
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal, NamedTuple

from inertia.errors import ReadError, UsageError, visible
from inertia.output import require_writable, together, whole, write_whole
from inertia.standard_input import reason_of

SUFFIXES = (".parquet", ".csv", ".jsonl")
_HALVES = re.compile("[\ud800-\udfff]")  # of pairs, as Python has bytes of names that are no UTF-8
_COMMENT = re.compile(r'\s*"?#')  # a line that begins so
_PARTING = re.compile(r'\s*"?sep=."?\s*$', re.IGNORECASE)  # a line for spreadsheets, which says what parts cells
_ROWS = 65_536  # in a group of Parquet's
_ARROW = {"text": "string", "integer": "int64", "number": "float64", "truth": "bool_"}


class Column(NamedTuple):
    """A column: `kind` is "text", "integer", "number" (float64) or "truth"; `unit` is "" where there is none."""

    name: str
    kind: Literal["text", "integer", "number", "truth"]
    unit: str
    meaning: str


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Return rows as CSV, with an apostrophe before text that a spreadsheet would take for a formula.

    So has such text with apostrophes before it already: each text reads back as itself. Source: OWASP, "CSV Injection".
    Numbers stay as they are, whether or not they have a sign.

    >>> print(csv_text([["plane", "z"], ["=cmd|' /C calc'!A0", -1.5], ["-1.5", "@SUM(1)"], ["a, b", "x=1"]]), end="")
    plane,z
    '=cmd|' /C calc'!A0,-1.5
    -1.5,'@SUM(1)
    "a, b",x=1
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([_no_formula(cell) for cell in row] for row in rows)
    return text.getvalue()


def cell_text(cell: str) -> str:
    """Return the text that `csv_text` wrote into a cell.

    >>> cell_text("'=x"), cell_text("''=x"), cell_text("'x'")
    ('=x', "'=x", "'x'")
    """
    return cell[1:] if cell[:1] == "'" and _no_formula(cell[1:]) == cell else cell


def cell_number(cell: str) -> float:
    """Return the number in a cell; raise `ValueError` where it is none, as 5_74, which Python takes for 574.

    >>> cell_number(" -1.5e3")
    -1500.0
    """
    if "_" in cell:
        raise ValueError(cell)
    return float(cell)


class Headed(NamedTuple):
    """A table in CSV: its columns, what parts its cells, and of each row the number of the line and cells by column."""

    columns: list[str]
    delimiter: str
    rows: Iterator[tuple[int, dict[str, str]]]


def headed(text: str, *, key: str | None = None) -> Headed:
    r"""Return what stands in a table in CSV, whose first line names the columns.

    Commas, semicolons or tabs part the cells, whichever stands most often in the line of the columns; empty lines are
    passed over, and before that line those that begin with # and ``sep=;``. Names of columns are in lower case, with _
    for spaces; those of remarks, which begin with #, may be the same. A first column without a name may count the rows
    from 0, as the index of a data frame does, and is passed over.

    Parameters
    ----------
    key : a column of a table in which cells may begin with #, the first column too where that line names the key; in
        a table without one, lines that begin with # are passed over below the columns too

    Raises `ReadError` where a column is named twice, and as the rows go on where a cell has no column.

    >>> table = headed("#,export; 2\nName,Part No,\n#1,7,\n\nb\n", key="name")
    >>> table.columns, table.delimiter, list(table.rows)
    (['name', 'part_no'], ',', [(3, {'name': '#1', 'part_no': '7'}), (5, {'name': 'b'})])
    """
    lines = _lines(text)
    start = _first(lines, key)
    kept = ["\n" if k < start or (key is None and _COMMENT.match(line)) else line for k, line in enumerate(lines)]
    delimiter = max(",;\t", key="".join(lines[start : start + 1]).count)
    rows = _rows_of(kept, delimiter)
    columns = [name.lower().replace(" ", "_") for name in next(rows, (0, []))[1]]
    if twice := next((name for name in columns if name and name[0] != "#" and columns.count(name) > 1), None):
        raise ReadError(f"its first line names the column `{twice}` twice: leave one out", code="table")
    while columns and not columns[-1]:
        columns.pop()
    named = [name for name in columns if name]
    by_column = ((line, _by_column(line, cells, columns, k)) for k, (line, cells) in enumerate(rows))
    return Headed(named, delimiter, by_column)


def has_column(text: str, key: str) -> bool:
    """Say whether the line in which `headed` looks for columns names this one, and is none of TOML."""
    lines = _lines(text)
    line = "".join(lines[(start := _first(lines, key)) : start + 1])
    return "=" not in line and key in _cells(line)


def _lines(text: str) -> list[str]:
    return list(io.StringIO(text, newline=""))


def _first(lines: Sequence[str], key: str | None) -> int:
    """Return which line names the columns: the first that is neither empty nor said for readers or spreadsheets."""

    def comment(line: str) -> bool:
        if _PARTING.match(line):
            return True
        return bool(_COMMENT.match(line)) and not (_cells(line)[0] == "#" and key in _cells(line))

    return next((k for k, line in enumerate(lines) if line.strip() and not comment(line)), 0)


def _cells(line: str) -> list[str]:
    """Return the names that may be parted in a line, whatever parts them."""
    return [cell.strip(' "\r\n').lower() for cell in re.split("[,;\t]", line)]


def _rows_of(lines: Iterable[str], delimiter: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the cells of each line of CSV that is not empty."""
    rows = csv.reader(lines, delimiter=delimiter, skipinitialspace=True)
    try:
        for row in rows:
            cells = [cell.strip() for cell in row]
            if any(cells):
                yield rows.line_num, cells
    except csv.Error as error:
        raise ReadError(f"it is not CSV: {error}", code="table") from None


def _by_column(line: int, cells: Sequence[str], columns: Sequence[str], count: int) -> dict[str, str]:
    """Return cells by the names of their columns.

    Those that have none are empty, as after a separator at the end, or `count` the rows in the first column.
    """
    if any(cells[len(columns) :]):
        raise ReadError(
            f"line {line} has {len(cells)} cells, and the first line {len(columns)} names: name each column, write "
            "numbers with a decimal point, and put text that holds the separator in quotes",
            code="table",
        )
    pairs = list(zip(columns, cells, strict=False))
    if pairs[:1] == [("", f"{count}")]:
        del pairs[0]
    if stray := next((cell for name, cell in pairs if cell and not name), None):
        raise ReadError(
            f"line {line} has {stray!r} in a column that the first line does not name: name that column, or leave it "
            "out",
            code="table",
        )
    return {name: cell for name, cell in pairs if name}


def _no_formula(cell: object) -> object:
    if not isinstance(cell, str) or (bare := cell.lstrip("'")).lstrip(" ")[:1] not in {*"=+-@\t\r\n＝＋－＠"}:
        return cell
    try:
        float(bare)
    except ValueError:
        return f"'{cell}"
    return cell


def require_table(file: str, *, force: bool = False) -> Path:
    """Return the path of a table that can be written; raise `UsageError` where it cannot: see `require_writable`."""
    path = require_writable(file, *SUFFIXES, force=force)
    if path.suffix.lower() == ".parquet":
        load_pyarrow()
    else:
        require_writable(_beside(path), force=force)
    return path


@contextmanager
def table_writer(
    path: Path | None, columns: Sequence[Column], about: Mapping[str, Any]
) -> Iterator[Callable[[Mapping[str, Any]], None]]:
    """Yield what writes a row; the table appears when the context is left without an error, whole.

    The same rows give the same bytes. Text reads back from JSON lines and Parquet as it is, but for halves of surrogate
    pairs, which no UTF-8 has; in CSV it is written as it may be printed. A number that is not finite is null.

    Parameters
    ----------
    path : its suffix says what it becomes; None for JSON lines on standard output
    about : what is said of the table beside its columns: its schema, ...
    """
    cells = [(column.name, column.kind) for column in columns]

    def plain(row: Mapping[str, Any]) -> list[Any]:
        return [_cell(row.get(name), kind) for name, kind in cells]

    if path is None:
        # Whoever reads JSON takes it for UTF-8, of which ASCII is a part.
        escape = not str(getattr(sys.stdout, "encoding", None) or "utf-8").lower().startswith("utf-8")
        yield lambda row: print(_line(columns, plain(row), escape), end="")
        return
    with together(), whole(path) as beside:
        if path.suffix.lower() == ".parquet":
            with _parquet(beside, columns, _described(about, columns)) as add:
                yield lambda row: add(plain(row))
            return
        with beside.open("w", encoding="utf-8", newline="") as file:
            if path.suffix.lower() == ".csv":
                file.write(csv_text([[column.name for column in columns]]))

            def write(row: Mapping[str, Any]) -> None:
                values = plain(row)
                as_csv = path.suffix.lower() == ".csv"
                file.write(csv_text([map(_in_csv, values)]) if as_csv else _line(columns, values))

            yield write
        write_whole(_beside(path), f"{_described({**about, 'sha256': _digest(beside)}, columns)}\n".encode())


def _described(about: Mapping[str, Any], columns: Sequence[Column]) -> str:
    return json.dumps({**about, "columns": [column._asdict() for column in columns]}, ensure_ascii=False, indent=1)


def _digest(path: Path) -> str:
    import hashlib  # loads OpenSSL: 6 ms and 4 MB

    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _line(columns: Sequence[Column], values: list[Any], escape: bool = False) -> str:
    """Return a row as JSON, in which what steers a terminal is escaped as JSON has it."""
    row = {column.name: value for column, value in zip(columns, values, strict=True)}
    text = json.dumps(row, ensure_ascii=escape, allow_nan=False)
    if not text.isprintable():
        text = "".join(one if one.isprintable() else json.dumps(one)[1:-1] for one in text)
    return f"{text}\n"


def _in_csv(value: Any) -> Any:
    if isinstance(value, bool):
        return "true" if value else "false"
    return visible(value) if isinstance(value, str) else value


def _cell(value: Any, kind: str) -> Any:
    if value is None:
        return None
    if kind == "text":
        return _HALVES.sub(lambda half: visible(half[0]), value) or None
    if kind == "number":
        return float(value) if math.isfinite(value) else None
    return bool(value) if kind == "truth" else int(value)


def _beside(path: Path) -> Path:
    return path.with_name(f"{path.name}.meta.json")


def load_pyarrow() -> Any:
    """Return pyarrow, with its `parquet`; raise `UsageError` where it is not installed."""
    try:
        import pyarrow.parquet
    except ImportError:
        raise UsageError(
            "Parquet needs pyarrow: install it by pip install 'inertia[parquet]'", code="needs_package"
        ) from None
    return pyarrow


@contextmanager
def _parquet(path: Path, columns: Sequence[Column], described: str) -> Iterator[Callable[[list[Any]], None]]:
    pyarrow = load_pyarrow()
    schema = pyarrow.schema(
        [
            pyarrow.field(
                column.name,
                getattr(pyarrow, _ARROW[column.kind])(),
                metadata={"unit": column.unit, "meaning": column.meaning},
            )
            for column in columns
        ],
        metadata={"inertia": described},
    )
    rows: list[list[Any]] = []

    def flush() -> None:
        arrays = [pyarrow.array([row[k] for row in rows], field.type) for k, field in enumerate(schema)]
        writer.write_table(pyarrow.Table.from_arrays(arrays, schema=schema))
        rows.clear()

    def add(row: list[Any]) -> None:
        rows.append(row)
        if len(rows) == _ROWS:
            flush()

    with pyarrow.parquet.ParquetWriter(path, schema) as writer:
        yield add
        flush()


def read_table(path: Path) -> tuple[dict[str, Any], Iterator[dict[str, Any]]]:
    """Return what is said of a table that `table_writer` wrote, and its rows.

    Raises `ReadError` where it is none.
    """
    try:
        for each in (path, _beside(path)):
            if each.exists() and not (each.is_file() or each.is_dir()):  # a pipe without a writer would wait for one
                raise ValueError(f"{each.name} is not a regular file")
        if path.suffix.lower() == ".parquet":
            file = load_pyarrow().parquet.ParquetFile(path)
            about = json.loads((file.schema_arrow.metadata or {})[b"inertia"])
            kinds = _kinds(about)
            return about, _sound_rows(path, kinds, (row for batch in file.iter_batches() for row in batch.to_pylist()))
        with path.open("rb"):
            pass
        about = json.loads(_beside(path).read_text(encoding="utf-8"))
        kinds = _kinds(about)
        rows = _csv_rows(path, kinds) if path.suffix.lower() == ".csv" else _json_rows(path)
        return about, _sound_rows(path, kinds, rows)
    except OSError as error:
        missing = error.errno == errno.ENOENT and os.fspath(error.filename or path) == os.fspath(_beside(path))
        beside = f"there is no {_beside(path).name} beside it, which says what it holds: keep them together"
        says = f"cannot read {path}: {beside if missing else reason_of(error)}"
        raise ReadError(visible(says), code="no_file") from None
    except (KeyError, TypeError, ValueError) as error:
        raise ReadError(f"cannot read {path}: it is no table that a batch wrote ({visible(str(error))})") from None


def require_as_written(path: Path, about: Mapping[str, Any]) -> None:
    """Raise `ReadError` where a table has other bytes than what stands beside it was written for."""
    if path.suffix.lower() != ".parquet" and "sha256" in about and about["sha256"] != _digest(path):
        beside = _beside(path).name
        raise ReadError(
            f"cannot read {path}: it is not the table that {beside} was written for, or was changed since: keep the "
            "two files of a run together, or write them again"
        )


def _kinds(about: Any) -> dict[str, str]:
    return {column["name"]: column["kind"] for column in about["columns"]}


def _sound_rows(path: Path, kinds: Mapping[str, str], rows: Iterator[Any]) -> Iterator[dict[str, Any]]:
    """Yield rows that have the columns of the table; raise `ReadError` at the first that has not."""
    number = 0
    try:
        for number, row in enumerate(rows, 1):
            if not isinstance(row, dict) or row.keys() != kinds.keys():
                raise ValueError("it has not the columns that the table has")
            yield row
            number += 1
    except (KeyError, TypeError, ValueError, OSError) as error:
        why = visible(str(error))
        raise ReadError(f"cannot read {path}, row {number or 1}: {why}: it is damaged, write it again") from None


def _json_rows(path: Path) -> Iterator[dict[str, Any]]:
    with path.open(encoding="utf-8") as file:
        yield from map(json.loads, file)


_FROM_TEXT: dict[str, Callable[[str], Any]] = {
    "text": cell_text, "integer": int, "number": float, "truth": "true".__eq__,
}  # fmt: skip


def _csv_rows(path: Path, kinds: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            yield {name: _FROM_TEXT[kinds[name]](value) if value else None for name, value in row.items()}
