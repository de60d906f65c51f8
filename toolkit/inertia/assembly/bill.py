"""A bill of materials in CSV, read as the parts of an assembly: a row a part, a column a field of ``[[part]]``."""

from __future__ import annotations

import csv
import io
import re
from typing import Any, get_type_hints

from inertia.assembly.fields import PartFields
from inertia.documents import toml_table
from inertia.errors import ReadError
from inertia.tables import cell_text

_DECIMAL_COMMA = re.compile(r"\d,\d")
_THOUSANDS = re.compile(r"(?<!\d)[1-9]\d{0,2}(?:,\d{3})+(?!\d)")
_MORE_THAN_DECIMALS = re.compile(r",\d+[.,]")


def is_bill(text: str) -> bool:
    """Say whether a text without a name is such a table, and no TOML: its first line names the column `name`.

    Comments may stand before it: a table has none, and is to be refused as one.
    """
    lines = (line for line in map(str.strip, text.split("\n")) if line and not line.startswith("#"))
    first = next(lines, "")
    return "=" not in first and "name" in (cell.strip(' "\r').lower() for cell in re.split("[,;\t]", first))


def parts_of(text: str) -> list[dict[str, Any]]:
    """Return the parts as tables.

    A cell is a number, a list or a table as TOML writes them, or else text, as always in a column of text (a name may
    be a part number); an empty one is not given. Semicolons and tabs may stand for commas, and the names of columns may
    be in any case.

    Raises `ReadError` where it is no such table.

    >>> parts_of("name;quantity;at\\nbolt;4;[1, 2, 0.5]\\n")
    [{'name': 'bolt', 'quantity': 4, 'at': [1, 2, 0.5]}]
    """
    first = text.lstrip().partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    rows = csv.reader(io.StringIO(text), delimiter=delimiter, skipinitialspace=True)
    try:
        names = [name.strip().lower().replace(" ", "_") for name in next(rows, [])]
        if "name" not in names:
            raise ReadError("its first line names no column `name`: a bill of materials has a row a part", code="table")
        if twice := next((name for name in names if name and names.count(name) > 1), None):
            raise ReadError(f"its first line names the column `{twice}` twice: leave one out", code="table")
        words = {name for name, kind in get_type_hints(PartFields).items() if kind in (str, str | None)}
        parts = []
        for row in rows:
            if len(row) > len(names):
                raise ReadError(
                    f"line {rows.line_num} has {len(row)} cells, and the first line {len(names)} names", code="table"
                )
            if any(cell.strip() for cell in row):
                cells = [(name, cell_text(cell.strip())) for name, cell in zip(names, row, strict=False)]
                for name, word in cells:
                    if name not in words and _DECIMAL_COMMA.search(word) and word[0] not in "[{":
                        raise ReadError(
                            f"line {rows.line_num} has {word!r} as its {name}, with a comma: "
                            f"{_without_comma(word, delimiter)}",
                            code="not_a_number",
                        )
                parts.append({name: word if name in words else _value(word) for name, word in cells if word})
    except csv.Error as error:
        raise ReadError(f"it is not CSV: {error}", code="table") from None
    return parts


def _without_comma(word: str, delimiter: str) -> str:
    """Return what to write: where semicolons part cells a comma is a decimal one, else it may part thousands too."""
    point = f"write {word.replace(',', '.')}, with a decimal point"
    plain = _THOUSANDS.sub(lambda found: found[0].replace(",", ""), word)
    if "," in plain:
        return point
    if _MORE_THAN_DECIMALS.search(word):
        return f"write {plain}"
    return point if delimiter == ";" else f"write {plain} if it parts thousands, else {word.replace(',', '.')}"


def _value(word: str) -> Any:
    if word[:1] in "[{+-.0123456789":
        try:
            return toml_table(f"value = {word.replace(chr(10), ' ')}")["value"]
        except ReadError:
            pass
    return word
