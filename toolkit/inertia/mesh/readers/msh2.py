"""The nodes and elements of Gmsh MSH 2.2."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.readers.msh_numbers import Group, MshFile, MshNumbers
from inertia.mesh.readers.msh_types import nodes_of


def nodes(file: MshFile) -> tuple[Int, Float]:
    """Return the tags (n,) and the coordinates (n, 3) of the nodes."""
    body = file.numbers("Nodes")
    count = body.line()
    if file.binary:
        rows = body.take([("tag", "i4"), ("x", "f8", 3)], count)
        tags, points = rows["tag"].astype(np.int64), rows["x"].astype(np.float64)
    else:
        table = body.floats(4 * count).reshape(-1, 4)
        tags, points = body.whole(table[:, 0]), table[:, 1:]
    body.finish("nodes", count, len(tags))
    return tags, points


def elements(file: MshFile) -> list[Group]:
    """Return the elements; the first of an element's own tags is its physical group."""
    body = file.numbers("Elements")
    total = body.line()
    groups = _binary(body, total) if file.binary else _text(body, total)
    body.finish("elements", total, sum(len(corners) for _, _, corners in groups))
    return groups


def _binary(body: MshNumbers, total: int) -> list[Group]:
    groups = []
    done = 0
    while done < total:
        number, count, tags = (int(value) for value in body.ints(3))
        width = _width(1, number, tags)
        rows = body.ints(count * width).reshape(-1, width)
        groups.append((number, *_split(rows, number, 1, tags)))
        done += count
    return groups


def _text(body: MshNumbers, total: int) -> list[Group]:
    values = body.rest()
    groups = []
    done = at = 0
    while done < total:
        if at + 3 > len(values):
            raise ReadError(f"its section $Elements ends after {done} of {total} elements: it was cut short")
        _, number, tags = (int(value) for value in values[at : at + 3])
        width = _width(3, number, tags)
        rows = _alike(values[at:], width, total - done)
        groups.append((number, *_split(rows, number, 3, tags)))
        done += len(rows)
        at += rows.size
    body.at = at + 1
    return groups


def _alike(values: Int, width: int, limit: int) -> Int:
    """Return the rows (m, width) at the front of `values` that are of the type of the first."""
    most = min(len(values) // width, limit)
    found, step = 0, 64
    while found < most:
        rows = values[found * width : min(found + step, most) * width].reshape(-1, width)
        alike = (rows[:, 1:3] == values[1:3]).all(axis=1)
        if not alike.all():
            found += int(np.argmin(alike))
            break
        found += len(rows)
        step *= 2
    if not found:
        raise ReadError("its section $Elements ends within an element: it was cut short, export it again")
    return values[: found * width].reshape(-1, width)


def _width(first: int, number: int, tags: int) -> int:
    """Return the numbers in the row of an element whose tags begin at column `first`."""
    if tags < 0:
        raise ReadError(f"its section $Elements has an element with {tags} tags: it is damaged, export it again")
    return first + tags + nodes_of(number)


def _split(rows: Int, number: int, first: int, tags: int) -> tuple[Int, Int]:
    """Return the physical tags and the node tags of rows whose tags begin at column `first`."""
    physical = rows[:, first] if tags else np.zeros(len(rows), np.int64)
    return physical, rows[:, -nodes_of(number) :]
