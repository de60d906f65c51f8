"""The headings of a table of torque: what may stand above time, x, y and z, in s and N m, and what is refused there."""

from __future__ import annotations

import re
import unicodedata

from inertia.errors import ReadError

_JOINS = r"(?:\s+|\s*[,/]\s*|_|\s+in\s+)"
_AXIS = "(?:torque|moment|tau|τ|applied|[mnt])"


def _named(names: str, unit: str) -> re.Pattern[str]:
    """Return what the heading of a column may be, with its unit behind it, if any."""
    return re.compile(rf"(?:{names})(?:\s*\[\s*{unit}\s*\]|\s*\(\s*{unit}\s*\)|{_JOINS}{unit})?", re.IGNORECASE)


_SECONDS, _NEWTON_METRES = "s(?:ecs?|econds?)?", r"n(?:ewtons?)?[ ·⋅*.-]?m(?:et(?:er|re)s?)?"
_COLUMNS = (
    ("time", _named("t|times?|zeit|seconds|sec|s|", _SECONDS), "s"),
    *(
        (
            axis,
            _named(
                rf"{_AXIS}?[ _.]?[{axis}{place + 1}]|{_AXIS}\[{place}\]|{axis}[ _](?:torque|moment)", _NEWTON_METRES
            ),
            "N m",
        )
        for place, axis in enumerate("xyz")
    ),
)
"""The columns of a table: name, what may stand above it, and unit. Case does not count, as no prefix is read."""

_ANY_UNIT = r"(?:[kmμ]?n[ ·⋅*.-]?[cm]?m|lbf?[ ·⋅*.-]?(?:ft|in)|[mμn]?s|msec|min|h)"
_HEADING = re.compile(
    rf"(?:t|times?|zeit|{_AXIS}?[ _.]?[xyz]|{_AXIS}[123])(?:\s*[\[(/].*|{_JOINS}{_ANY_UNIT})?", re.IGNORECASE
)
"""What is a heading rather than prose, with whichever unit."""
_BETWEEN_BLANKS = re.compile(
    r"(?:(?:torque|moment)\s+)?[^\s\[(]+(?:\s*(?:\[[^\]]*\]|\([^)]*\)|/\s*\S+))?", re.IGNORECASE
)
"""A heading between blanks, and the unit in brackets or below a stroke."""


def require_four(fields: list[str], where: str) -> None:
    """Raise `ReadError` where a line has not four columns."""
    if len(fields) != 4:
        raise ReadError(f"{where}: {len(fields)} columns, 4 are needed: give time, x, y, z in s and N m", code="table")


def require_names(fields: list[str], where: str) -> None:
    """Raise `ReadError` where a name is none of the column at its place, or its unit another than is read."""
    require_four(fields, where)
    for column, (field, (name, pattern, unit)) in enumerate(zip(fields, _COLUMNS, strict=True), 1):
        if not pattern.fullmatch(unicodedata.normalize("NFKC", field).strip()):
            raise ReadError(
                f"{where}: column {column} is named {field.strip()!r}, and {name} in {unit} is read there: give time, "
                "x, y, z in s and N m, and name them time, x, y, z or not at all",
                code="table",
            )


def require_names_in_remarks(remarks: list[tuple[list[str], str]]) -> None:
    """Raise `ReadError` for names that do not fit in lines with # above the first row, as NumPy writes them.

    A line of four cells or more has names where three of them are headings, or the first of four is one.
    """
    for cells, where in remarks:
        headings = [bool(_HEADING.fullmatch(unicodedata.normalize("NFKC", cell).strip())) for cell in cells]
        if len(cells) >= len(_COLUMNS) and (sum(headings) > 2 or (headings[0] and len(cells) == len(_COLUMNS))):
            require_names(cells, where)


def cells_of(fields: list[str]) -> list[str]:
    """Return the cells of a line that begins with #, parted by commas, semicolons, tabs or blanks."""
    cells = [fields[0].strip().lstrip("# "), *fields[1:]]
    if len(cells) == 1:
        cells = re.split(r"[,;\t]", cells[0])
    if len(cells) == 1:
        cells = _BETWEEN_BLANKS.findall(cells[0])
        return cells if len(cells) == len(_COLUMNS) else []
    while cells and not cells[-1].strip():
        cells.pop()
    return cells
