"""A table as TOML text, which Python's own `tomllib` reads back."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_DELETE = "\x7f"  # which JSON writes as it is and TOML forbids


def toml_text(table: Mapping[str, Any]) -> str:
    """Return the text of a table whose entries are numbers, texts, flags, lists, tables and lists of tables.

    A table stands under a header of its own, a list of tables under a double one, and what they hold in one line each.

    >>> print(toml_text({"unit": "mm", "axis": {"a": [0, 0.5]}, "plane": [{"id": "I"}, {"id": "II", "on": True}]}))
    unit = "mm"
    <BLANKLINE>
    [axis]
    a = [0, 0.5]
    <BLANKLINE>
    [[plane]]
    id = "I"
    <BLANKLINE>
    [[plane]]
    id = "II"
    on = true
    """
    blocks = [list(_lines({key: value for key, value in table.items() if not _headed(value)}))]
    for key, value in table.items():
        if isinstance(value, Mapping):
            blocks.append([f"[{_key(key)}]", *_lines(value)])
        elif _headed(value):
            blocks += [[f"[[{_key(key)}]]", *_lines(entry)] for entry in value]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _headed(value: Any) -> bool:
    if isinstance(value, list):
        return bool(value) and all(isinstance(entry, Mapping) for entry in value)
    return isinstance(value, Mapping)


def _lines(table: Mapping[str, Any]) -> Iterator[str]:
    for key, value in table.items():
        yield f"{_key(key)} = {_value(value)}"


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _value(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace(_DELETE, "\\u007f")
    if isinstance(value, Mapping):
        return "{ " + ", ".join(_lines(value)) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return repr(value)
