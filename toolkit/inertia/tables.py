"""Tables as CSV, in which no text is a formula."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Return rows as CSV, with an apostrophe before text that a spreadsheet would take for a formula.

    Source: OWASP, "CSV Injection". Numbers stay as they are, whether or not they have a sign.

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

    >>> cell_text("'=x"), cell_text("'x'")
    ('=x', "'x'")
    """
    return cell[1:] if cell[:1] == "'" and _no_formula(cell[1:]) == cell else cell


def _no_formula(cell: object) -> object:
    if not isinstance(cell, str) or cell.lstrip(" ")[:1] not in {*"=+-@\t\r\n＝＋－＠"}:
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell
