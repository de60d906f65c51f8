"""A bill of materials in CSV, read as the parts of an assembly: a row a part, a column a field of ``[[part]]``."""

from __future__ import annotations

import re
from typing import Any, get_type_hints

from inertia.assembly.fields import PartFields
from inertia.documents import toml_table
from inertia.errors import ReadError
from inertia.tables import cell_text, has_column, headed

_DECIMAL_COMMA = re.compile(r"\d,\d")
_THOUSANDS = re.compile(r"(?<!\d)[1-9]\d{0,2}(?:,\d{3})+(?!\d)")
_MORE_THAN_DECIMALS = re.compile(r",\d+[.,]")


def is_bill(text: str) -> bool:
    """Say whether a text without a name is such a table, and no TOML: its first line names the column `name`.

    Comments may stand before it.
    """
    return has_column(text, "name")


def parts_of(text: str) -> list[dict[str, Any]]:
    """Return the parts as tables.

    A cell is a number, a list or a table as TOML writes them, or else text, as always in a column of text (a name may
    be a part number); an empty one is not given. See `inertia.tables.headed` for what parts them.

    Raises `ReadError` where it is no such table.

    >>> parts_of("name;quantity;at\\nbolt;4;[1, 2, 0.5]\\n")
    [{'name': 'bolt', 'quantity': 4, 'at': [1, 2, 0.5]}]
    """
    table = headed(text, key="name")
    if "name" not in table.columns:
        raise ReadError("its first line names no column `name`: a bill of materials has a row a part", code="table")
    words = {name for name, kind in get_type_hints(PartFields).items() if kind in (str, str | None)}
    parts = []
    for line, row in table.rows:
        cells = {name: word for name, cell in row.items() if (word := cell_text(cell))}
        for name, word in cells.items():
            if name not in words and _DECIMAL_COMMA.search(word) and word[0] not in "[{":
                raise ReadError(
                    f"line {line} has {word!r} as its {name}, with a comma: {_without_comma(word, table.delimiter)}",
                    code="not_a_number",
                )
        parts.append({name: word if name in words else _value(word) for name, word in cells.items()})
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
