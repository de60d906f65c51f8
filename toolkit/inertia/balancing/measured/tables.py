"""Tables of readings as CSV: a line for each reading of each run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from inertia.balancing.measured.job_fields import ReadingFields
from inertia.documents import section_of
from inertia.encoding import text_of
from inertia.errors import InertiaError, ReadError, placed
from inertia.output import note_input
from inertia.standard_input import reason_of
from inertia.tables import cell_number, cell_text, headed

_COLUMNS = ("run", "sensor", "rpm", "amplitude", "phase")


def readings_of(file: Path) -> Iterator[tuple[str, str, ReadingFields]]:
    """Yield where each line of a table of readings is, its run and its reading.

    Raises `ReadError`, or `UsageError` where a figure is not usable, naming the line.
    """
    note_input(file)
    try:
        table = headed(text_of(file.read_bytes(), "save the table as CSV in UTF-8"))
        _require_columns(table.columns)
        rows = list(table.rows)
    except OSError as error:
        raise ReadError(f"cannot read {file}: {reason_of(error)}", code="no_file") from None
    except ReadError as error:
        raise placed(error, f"cannot read {file}") from None
    for line, cells in rows:
        where = f"{file}: line {line}"
        if len(cells) < len(table.columns):
            raise ReadError(
                f"cannot read {where}: it has {len(cells)} cells, and the first line {len(table.columns)}", code="table"
            )
        entry: dict[str, Any] = {name: cell for name, cell in cells.items() if cell}
        for name in ("rpm", "amplitude", "phase"):
            if name in entry:
                entry[name] = _float(entry[name], f"{where}: {name}")
        run = cell_text(entry.pop("run", ""))
        entry["sensor"] = cell_text(entry.get("sensor", ""))
        try:
            yield where, run, section_of(ReadingFields, entry, path="")
        except InertiaError as error:
            raise placed(error, where) from None


def _require_columns(columns: Sequence[str]) -> None:
    for name in ("run", "sensor", "amplitude"):
        if name not in columns:
            raise ReadError(f"no column {name}: its first line must name {', '.join(_COLUMNS)}", code="table")
    if unknown := [name for name in columns if name not in _COLUMNS]:
        raise ReadError(f"the column {unknown[0]!r} is unknown: use {', '.join(_COLUMNS)}", code="table")


def _float(cell: str, where: str) -> float:
    try:
        return cell_number(cell)
    except ValueError:
        raise ReadError(
            f"cannot read {where} is {cell!r}: it must be a number, with a point for decimals", code="not_a_number"
        ) from None
