"""Tables of readings as CSV: a line for each reading of each run."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from inertia.balancing.measured.job_fields import ReadingFields
from inertia.documents import section_of
from inertia.encoding import text_of
from inertia.errors import InertiaError, ReadError, placed
from inertia.output import note_input
from inertia.standard_input import reason_of
from inertia.tables import cell_text

_COLUMNS = ("run", "sensor", "rpm", "amplitude", "phase")


def readings_of(file: Path) -> Iterator[tuple[str, str, ReadingFields]]:
    """Yield where each line of a table of readings is, its run and its reading.

    Raises `ReadError`, or `UsageError` where a figure is not usable, naming the line.
    """
    try:
        yield from _rows(file)
    except csv.Error as error:
        raise ReadError(f"cannot read {file}: it is no CSV: {error}", code="table") from None


def _rows(file: Path) -> Iterator[tuple[str, str, ReadingFields]]:
    note_input(file)
    try:
        lines = text_of(file.read_bytes(), "save the table as CSV in UTF-8").splitlines()
    except OSError as error:
        raise ReadError(f"cannot read {file}: {reason_of(error)}", code="no_file") from None
    except ReadError as error:
        raise placed(error, f"cannot read {file}") from None
    first = next((line for line in lines if line.strip()), "")
    rows = csv.reader(lines, delimiter=";" if ";" in first else ",")
    head: list[str] = []
    for row in rows:
        cells = [cell.strip() for cell in row]
        if not any(cells) or cells[0].startswith("#"):
            continue
        if not head:
            head = [cell.lower() for cell in cells]
            for name in ("run", "sensor", "amplitude"):
                if name not in head:
                    parted = ", parted by commas or semicolons, not by tabs" if "\t" in first else ""
                    raise ReadError(
                        f"cannot read {file}: no column {name}: its first line must name {', '.join(_COLUMNS)}{parted}",
                        code="table",
                    )
            if unknown := [name for name in head if name not in _COLUMNS]:
                raise ReadError(
                    f"cannot read {file}: the column {unknown[0]!r} is unknown: use {', '.join(_COLUMNS)}", code="table"
                )
            continue
        where = f"{file}: line {rows.line_num}"
        if len(cells) != len(head):
            raise ReadError(
                f"cannot read {where}: it has {len(cells)} cells, and the first line {len(head)}", code="table"
            )
        entry: dict[str, Any] = {name: cell for name, cell in zip(head, cells, strict=True) if cell}
        for name in ("rpm", "amplitude", "phase"):
            if name in entry:
                entry[name] = _float(entry[name], f"{where}: {name}")
        run = cell_text(entry.pop("run", ""))
        entry["sensor"] = cell_text(entry.get("sensor", ""))
        try:
            yield where, run, section_of(ReadingFields, entry, path="")
        except InertiaError as error:
            raise placed(error, where) from None


def _float(cell: str, where: str) -> float:
    try:
        return float(cell)
    except ValueError:
        raise ReadError(
            f"cannot read {where} is {cell!r}: it must be a number, with a point for decimals", code="not_a_number"
        ) from None
