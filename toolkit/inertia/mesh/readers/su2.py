"""SU2: the tables of points, cells and markers, checked, and handed to meshio without what may stand beside them.

Source: SU2 v8 documentation, "Mesh File".
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice

import numpy as np

from inertia.errors import ReadError
from inertia.mesh.readers.contents import numbers, shown

_NEEDED = (b"NDIME", b"NPOIN", b"NELEM")
_TABLES = (b"NPOIN", b"NELEM", b"MARKER_ELEMS")
_NODES = {b"3": 2, b"5": 3, b"9": 4, b"10": 4, b"12": 8, b"13": 6, b"14": 5}
_COMMENT = re.compile(rb"%[^\r\n]*")
_ROWS_ASIDE = (b"FFD_", b"PERIODIC_", b"NPERIODIC")
"""How keywords begin behind which rows stand that say nothing of the body: boxes of deformation, periodic bounds."""


def plain_su2(data: bytes) -> tuple[bytes, int]:
    """Return what meshio needs of a file, and how many cells it lists.

    Every line stands in the table that it belongs to, as many words long as the others there.
    """
    lines = (row for line in _COMMENT.sub(b"", data).splitlines() if (row := line.strip()))
    plain: list[bytes] = []
    cells = 0
    seen: set[bytes] = set()
    keyword = b""
    for line in lines:
        word, equals, value = (part.strip() for part in line.partition(b"="))
        if not equals:
            if keyword.startswith(_ROWS_ASIDE):
                continue
            raise ReadError(f"its line {shown(line)} stands outside its tables: its counts are wrong")
        keyword = word
        if keyword in seen or (keyword == b"NZONE" and value.split()[:1] != [b"1"]):
            raise ReadError(
                f"its {keyword.decode()} says that it has several zones, of which one is read: write each into a file",
                code="not_read",
            )
        seen |= {keyword} & set(_NEEDED)
        if keyword in _TABLES:
            rows = _table(keyword.decode(), value, lines)
            if rows:  # meshio expects one
                plain += [b"%s= %d" % (keyword, len(rows)), *rows]
            cells += len(rows) if keyword != b"NPOIN" else 0
        elif keyword in (b"NDIME", b"MARKER_TAG"):
            plain.append(keyword + b"=" + value)
    if missing := [each.decode() for each in _NEEDED if each not in seen]:
        raise ReadError(f"it has no {missing[0]}: it was cut short, export it again", code="cut_short")
    return b"\n".join([*plain, b""]), cells


def _table(keyword: str, value: bytes, lines: Iterator[bytes]) -> list[bytes]:
    """Return the rows of the table that begins with a keyword and how many they are."""
    stated = re.match(rb"\d{1,18}(?!\S)", value)
    if stated is None:
        raise ReadError(f"its {keyword} is {shown(value)}, not a count: export it again")
    count = int(stated[0])
    rows = list(islice(lines, count))
    if rows and rows[0].startswith(b"SEND_RECV"):
        raise ReadError(
            "its marker SEND_RECEIVE says that it is one partition of a mesh, or has cells twice: write the mesh "
            "whole, without it",
            code="not_read",
        )
    words = [row.split() for row in rows]
    if keyword == "NPOIN":
        surplus = {len(row) for row in words}
        numbers(b" ".join(rows), np.float64, "its points")
    else:
        numbers(b" ".join(rows), np.int64, "its elements")
        surplus = {len(row) - _NODES.get(row[0], -1) for row in words}
    if len(surplus) > 1 or len(rows) < count:
        raise ReadError(
            f"the rows of its {keyword} are not alike, or too few: it was cut short or damaged", code="cut_short"
        )
    return rows
