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
_TIME = "t|times?|zeit"
_HEADING, _HEADING_OF_TIME = (
    re.compile(rf"(?:{names})(?:\s*[\[(/].*|{_JOINS}{_ANY_UNIT})?", re.IGNORECASE)
    for names in (rf"{_TIME}|{_AXIS}?[ _.]?[xyz]|{_AXIS}[123]", _TIME)
)
"""What is a heading rather than prose, with whichever unit; what is one of time."""
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
        if not _is(pattern, field):
            raise ReadError(
                f"{where}: column {column} is named {field.strip()!r}, and {name} in {unit} is read there: give time, "
                "x, y, z in s and N m, and name them time, x, y, z or not at all",
                code="table",
            )


def require_names_in_remarks(remarks: list[tuple[list[str], str]]) -> None:
    """Raise `ReadError` for names that do not fit in lines with # above the first row, as NumPy writes them.

    A line of four cells or more has names where all are headings; or three, with one of time first or a unit in
    brackets; or where it has four, and one of time is first.
    """
    for cells, where in remarks:
        if len(cells) < len(_COLUMNS):
            continue
        headings = [cell for cell in cells if _is(_HEADING, cell)]
        timed = _is(_HEADING_OF_TIME, cells[0])
        several = len(headings) > 2 and (timed or any(set("[(/") & set(cell) for cell in headings))
        if len(headings) == len(cells) or several or (timed and len(cells) == len(_COLUMNS)):
            require_names(cells, where)


def _is(pattern: re.Pattern[str], cell: str) -> bool:
    return bool(pattern.fullmatch(unicodedata.normalize("NFKC", cell).strip()))


def cells_of(fields: list[str]) -> list[str]:
    """Return the cells of a line that begins with #, parted by commas, semicolons, tabs, or blanks.

    What is parted by blanks is a remark, without cells, unless it has four of which three are headings.
    """
    cells = [fields[0].strip().lstrip("# "), *fields[1:]]
    if len(cells) == 1:
        cells = re.split(r"[,;\t]", cells[0])
    if len(cells) == 1:
        cells = _BETWEEN_BLANKS.findall(cells[0])
        headings = sum(_is(_HEADING, cell) for cell in cells)
        return cells if len(cells) == len(_COLUMNS) and headings > 2 else []
    while cells and not cells[-1].strip():
        cells.pop()
    return cells
