"""AVS UCD: rows checked against the counts of the header, and handed to meshio without what may stand beside them.

Source: "AVS Developer's Guide", ASCII description of unstructured cell data.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from inertia.errors import ReadError
from inertia.mesh.readers.contents import numbers, plural, shown

_NODES = {b"pt": 1, b"line": 2, b"tri": 3, b"quad": 4, b"tet": 4, b"pyr": 5, b"prism": 6, b"hex": 8}


def plain_ucd(data: bytes) -> bytes:
    """Return the header, nodes and cells of a file without comments, blank lines and data, once they agree."""
    rows = (line.split() for line in data.splitlines() if line.strip())
    mesh = (row for row in rows if not row[0].startswith(b"#"))
    header = next(mesh, [])
    if len(header) != 5 or not all(word.isdigit() and len(word) < 19 for word in header):
        raise ReadError(f"its header is {shown(b' '.join(header))}, not five counts: export it as UCD text")
    nodes, cells, *widths, model = map(int, header)
    points = list(islice(mesh, nodes))
    elements = list(islice(mesh, cells))
    if len(points) < nodes or len(elements) < cells:
        raise ReadError(
            f"its header counts {plural(nodes, 'node')} and {plural(cells, 'cell')}, but it holds {len(points)} and "
            f"{len(elements)}: it was cut short, or its counts are wrong",
            code="cut_short",
        )
    _check(points, elements)
    _pass_over_data(rows, [count for width, count in zip(widths, (nodes, cells), strict=True) if width])
    if model == 0 and (left := next(mesh, None)):
        raise ReadError(
            f"its line {shown(b' '.join(left))} stands behind the {plural(cells, 'cell')} and the data that its header "
            "counts: its counts are wrong, export it again"
        )
    lines = [b" ".join(row) for row in (*points, *elements)]
    return b"\n".join([b"%d %d 0 0 0" % (nodes, cells), *lines, b""])


def _check(points: list[list[bytes]], elements: list[list[bytes]]) -> None:
    """Check that nodes have a number of their own and coordinates, and cells as many nodes as their kind has."""
    names = numbers(b" ".join(row[0] for row in points), np.int64, "its numbers of nodes")
    numbers(b" ".join(word for row in points for word in row[1:]), np.float64, "its nodes")
    if len({len(row) for row in points} | {4}) > 1:
        raise ReadError("its nodes do not all have three coordinates: it was cut short or damaged, export it again")
    several, counts = np.unique(names, return_counts=True)
    if (counts > 1).any():
        raise ReadError(f"it defines node {several[counts > 1][0]} twice: export it again")
    for row in elements:
        row[2:3] = [word.lower() for word in row[2:3]]
        if len(row) < 3 or row[2] not in _NODES:
            raise ReadError(
                f"its cell {shown(b' '.join(row))} has no kind that is read: use cells of first order",
                code="not_read",
            )
        if len(row) != 3 + _NODES[row[2]]:
            raise ReadError(
                f"its cell {shown(b' '.join(row))} has {plural(len(row) - 3, 'node')}, not {_NODES[row[2]]}: it was "
                "cut short, or is not of first order"
            )
    numbers(b" ".join(word for row in elements for word in row[:2]), np.int64, "its cells")
    nodes = numbers(b" ".join(word for row in elements for word in row[3:]), np.int64, "its cells")
    if len(missing := np.setdiff1d(nodes, names)):
        raise ReadError(
            f"its cells name node {missing[0]}, which it does not define: export it again", code="node_out_of_range"
        )


def _pass_over_data(rows: Iterator[list[bytes]], counts: list[int]) -> None:
    """Pass over tables of data: a row of sizes, behind their number, a label of each, and numbers in any lines.

    They are a number of the node or cell, and as many values as the sizes add up to, for each that is counted.
    """
    for count in counts:
        sizes = next(rows, [b""])
        known = all(size.isdigit() and len(size) < 10 for size in sizes) and len(sizes) == int(sizes[0]) + 1
        left = count * (1 + sum(map(int, sizes[1:]))) if known else -1
        if known and sum(1 for _ in islice(rows, len(sizes) - 1)) == len(sizes) - 1:
            while left > 0 and (row := next(rows, [])):
                left -= len(row)
        if left:
            raise ReadError("its data are not as many as its header counts: it was cut short, or its counts are wrong")
