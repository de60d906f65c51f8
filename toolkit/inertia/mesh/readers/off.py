"""OFF: a header, the counts, one line a vertex, one line a face."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from inertia.errors import ReadError
from inertia.mesh.readers.contents import Contents, numbers, plural, shown, split_polygons, text_of
from inertia.mesh.readers.decimals import rounding_of

_HEADER = re.compile(rb"\s*(?:#[^\n]*\n\s*)*((?:ST)?C?N?)(4?n?)OFF(?![A-Za-z])\s*(BINARY)?")
"""Texture, colour and normal may follow the coordinates of a vertex; `4` and `n` change the coordinates."""


_COLOURED = {3, 6, 7}
"""Numbers of a vertex without colour, with red, green and blue, and with opacity too: these may stand side by side."""


def read_off(path: Path) -> Contents:
    """Read a text OFF file of points in space; colours and normals are left aside."""
    data = text_of(path)
    header = _HEADER.match(data)
    if header is None:
        raise ReadError(
            "it does not begin with the word OFF: write that before it, or give the format that it has",
            code="wrong_format",
        )
    if header[2] or header[3]:
        raise ReadError(
            f"{shown(header[0].strip())} files are not read: export it as a plain text OFF file", code="not_read"
        )
    lines = [line for line in re.sub(rb"#[^\r\n]*", b"", data[header.end() :]).splitlines() if line.strip()]
    if lines and (crowd := len(lines[0].split()) - 3) > 0:
        raise ReadError(
            f"behind its counts stand {plural(crowd, 'other number')} in the same line, and each vertex and each face "
            "needs a line of its own: export it again",
            code="not_read",
        )
    counts = numbers(lines[0] if lines else b"", np.int64, "its counts of vertices and faces")
    if len(counts) < 2 or counts[:2].min() < 0:
        raise ReadError("it has no line with the counts of vertices and faces: export it again")
    points, polygons = int(counts[0]), int(counts[1])
    if len(lines) - 1 != points + polygons:
        raise ReadError(
            f"its header says {points} vertices and {polygons} faces, but {plural(len(lines) - 1, 'line')} "
            f"{'follows' if len(lines) == 2 else 'follow'}, and each needs its own: it was cut short, or its counts "
            "are wrong, export it again",
            code="cut_short",
        )
    rows = [line.split() for line in lines[1 : points + 1]]
    short = next((i for i, row in enumerate(rows) if len(row) < 3), None)
    if short is not None:
        raise ReadError(f"vertex {short} has fewer than three coordinates: export it again")
    widths = {len(rows[0]) if rows else 3} | (_COLOURED if rows and len(rows[0]) in _COLOURED else set())
    other = next((i for i, row in enumerate(rows) if len(row) not in widths), None)
    if other is not None and not header[1]:  # a vertex may do without the colour that the header promises
        raise ReadError(f"vertex {other} has {len(rows[other])} numbers, and vertex 0 {len(rows[0])}: export it again")
    words = [word for row in rows for word in row[:3]]
    text = b" ".join(words)
    vertices = numbers(text, np.float64, "its vertices").reshape(-1, 3)
    sizes, corners = [], []
    for face, line in enumerate(lines[points + 1 :]):
        size, *rest = line.split()
        if not size.isdigit() or len(size) > 9 or len(rest) < int(size):
            raise ReadError(f"face {face} says {shown(size)} corners and names {len(rest)}: export it again")
        sizes.append(int(size))
        corners += rest[: int(size)]
    of_face = np.array(sizes, np.int64)
    whole, _, notes = split_polygons(vertices, of_face, numbers(b" ".join(corners), np.int64, "its faces"))
    rounding = rounding_of(vertices, lambda: text, lambda: words)
    return Contents(whole, notes=notes, rounding=rounding)
