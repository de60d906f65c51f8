"""PLY, text or binary: of the elements that the header declares, vertices and faces, or edges where there are no faces.

Text is turned into float64 first, so that both kinds are rows of numbers of known size. Rows of one length
(the usual case: triangles throughout) are viewed as one array, others are walked row by row. Source: G. Turk,
"The PLY Polygon File Format", 1994.
"""

from __future__ import annotations

import os
import re
import struct
from codecs import BOM_UTF8
from collections.abc import Iterator
from dataclasses import field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.external.memory import fits
from inertia.mesh.readers.cells import cell_contents
from inertia.mesh.readers.contents import Contents, numbers, require_finite, shown, split_polygons, text_of
from inertia.mesh.readers.decimals import rounding_of
from inertia.mesh.surface import FacesInFile, RowsInFile
from inertia.records import dataclass

_TYPES = {
    "char": "b", "int8": "b", "uchar": "B", "uint8": "B",
    "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
    "int": "i", "int32": "i", "uint": "I", "uint32": "I", "int64": "q", "uint64": "Q",
    "float": "f", "float32": "f", "double": "d", "float64": "d",
}  # fmt: skip
"""PLY's names of types as those of `struct`, which numpy shares."""

_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_CORNERS = ("vertex_indices", "vertex_index")
_ENDS = ("vertex1", "vertex2")
_HEADER_LIMIT = 2**20
_VERTICES = 1 << 18  # read at a time
_LINE_ENDS = 64  # bytes of them, at most, that may follow binary rows which stay in the file


@dataclass
class _Property:
    """A column: its name, the type of its numbers and, for a list, the type of the count before them."""

    name: str
    type: str
    count: str | None = None


@dataclass
class _Element:
    """A table: its name, its number of rows and its columns."""

    name: str
    rows: int
    properties: list[_Property] = field(default_factory=list)


_Table = dict[str, tuple[NDArray[Any], Int]]
"""Name of a column → its numbers, row after row, and how many each row has."""


def read_ply(path: Path, memory: float | None = None) -> Contents:
    """Read a PLY file; colours, normals and other elements are left aside.

    Binary faces that take more than `memory`, bytes of this process, stay in the file where all are triangles.
    """
    with path.open("rb") as file:
        marked = file.read(_HEADER_LIMIT)
    head = marked.removeprefix(BOM_UTF8)
    last = re.search(rb"(?:\A|[\r\n])[ \t]*end_header\b", head)  # a comment may name it
    end = -1 if last is None else last.end() - len(b"end_header")
    line_end = min((at for at in (head.find(b"\n", end), head.find(b"\r", end)) if at >= 0), default=-1)
    if end < 0 or line_end < 0:
        raise ReadError("its header has no end_header line: it was cut short, export it again", code="cut_short")
    body = line_end + (2 if head[line_end : line_end + 2] == b"\r\n" else 1)
    encoding, elements = _header([line.decode("utf-8", "replace") for line in head[:end].splitlines()])
    order = _ORDERS[encoding] or "="
    begin = body + len(marked) - len(head)
    if memory is not None and order != "=" and (surface_in_file := _in_file(path, elements, order, begin, memory)):
        return Contents(surface_in_file)
    if encoding == "ascii":
        text = text_of(path)[body:]
        data = numbers(text, np.float64, "its rows").view(np.uint8)
        for column in (column for element in elements for column in element.properties):
            column.type, column.count = "d", column.count and "d"
    else:
        data = np.fromfile(path, np.uint8, offset=begin)
    tables: dict[str, _Table] = {}
    for element in elements:
        if element.rows and element.properties:
            tables[element.name], used = _table(data, element, order)
            data = data[used:]
    if data.tobytes().strip(b"\r\n"):
        left = f"{len(data)} bytes" if _ORDERS[encoding] else f"{len(data) // 8} numbers"
        raise ReadError(f"{left} follow the rows that its header counts: its counts are wrong, export it again")
    if others := [name for name, table in tables.items() if name != "face" and not table.keys().isdisjoint(_CORNERS)]:
        raise ReadError(
            f"its element {shown(others[0])} lists vertices too, which is not read: export its triangles as faces",
            code="not_read",
        )
    if "face" not in tables and "edge" not in tables:
        raise ReadError("it holds no faces and no edges: export the part as a surface mesh", code="empty")
    vertices = _vertices(tables.get("vertex", {}))
    if "face" in tables:
        whole, _, notes = split_polygons(vertices, *_faces(tables["face"]))
        contents = Contents(whole, notes=notes)
    else:
        contents = cell_contents(vertices, [("line", _edges(tables["edge"]), None)])
    rounding = None
    if encoding == "ascii":
        rounding = rounding_of(vertices, lambda: text, lambda: _coordinates(text_of(path)[body:].split(), elements))
    return replace(contents, rounding=rounding)


def _in_file(path: Path, elements: list[_Element], order: str, body: int, memory: float) -> FacesInFile | None:
    """Return the surface with its faces in the file, where it is vertices and triangles that do not fit otherwise."""
    if [element.name for element in elements] != ["vertex", "face"] or fits(elements[1].rows, memory):
        return None
    vertex, face = elements
    if any(column.count for column in vertex.properties):
        return None
    if [column.name for column in face.properties if column.count] not in ([name] for name in _CORNERS):
        return None
    point = np.dtype([(column.name, order + column.type) for column in vertex.properties])
    fields: list[tuple[Any, ...]] = []
    for k, column in enumerate(face.properties):
        fields += [("count", order + column.count)] if column.count else []
        fields += [("corners", order + column.type, 3) if column.count else (f"{k}", order + column.type)]
    row = np.dtype(fields)
    begin = body + vertex.rows * point.itemsize
    left = path.stat().st_size - begin - face.rows * row.itemsize
    if row["corners"].base.kind == "f" or not 0 <= left <= _LINE_ENDS:
        return None  # other polygons are among them, or its counts are wrong
    with path.open("rb") as file:
        file.seek(-left, os.SEEK_END)
        if file.read().strip(b"\r\n"):
            return None
    if not face.rows or not {"x", "y", "z"} <= set(point.names or ()):
        return None
    stored, vertices = RowsInFile(path, point, vertex.rows, body), np.empty((vertex.rows, 3))
    for start in range(0, vertex.rows, _VERTICES):
        block = stored.block(start, min(start + _VERTICES, vertex.rows))
        for axis, name in enumerate("xyz"):
            vertices[start : start + len(block), axis] = block[name]
    require_finite(vertices)
    return FacesInFile(vertices, RowsInFile(path, row, face.rows, begin))


def _coordinates(words: list[bytes], elements: list[_Element]) -> Iterator[bytes]:
    """Yield the coordinates of all vertices as the words of a text file write them."""
    at = 0
    for element in elements:
        for _ in range(element.rows):
            row: dict[str, bytes] = {}
            for column in element.properties:
                row[column.name] = words[at]
                at += 1 + int(float(words[at])) if column.count else 1
            if element.name == "vertex":
                yield from (row[axis] for axis in "xyz")


def _header(lines: list[str]) -> tuple[str, list[_Element]]:
    if not lines or lines[0].strip() != "ply":
        raise ReadError("its header does not begin with ply and a format: export it again", code="wrong_format")
    encoding = ""
    elements: list[_Element] = []
    for line in lines[1:]:
        match line.split():
            case ["format", name, _] if name in _ORDERS:
                encoding = name
            case ["element", name, rows] if name.isprintable() and rows.isdecimal() and len(rows) < 19:
                elements.append(_Element(name, int(rows)))
            case ["property", "list", count, kind, name] if elements and count in _TYPES and kind in _TYPES:
                elements[-1].properties.append(_Property(name, _TYPES[kind], _TYPES[count]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append(_Property(name, _TYPES[kind]))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise ReadError(f"its header has the line {shown(line)}, which PLY does not know: export it again")
    for kind, names in (
        ("elements", [element.name for element in elements]),
        *((f"columns of {element.name}", [column.name for column in element.properties]) for element in elements),
    ):
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise ReadError(f"its header has two {kind} called {shown(twice)}: export it again")
    if not encoding:
        raise ReadError("its header does not begin with ply and a format: export it again", code="wrong_format")
    return encoding, elements


def _table(data: NDArray[np.uint8], element: _Element, order: str) -> tuple[_Table, int]:
    """Return the columns of an element that begins `data`, and the bytes that it takes."""
    raw = data.data
    fields: list[Any] = []
    at = 0
    for i, column in enumerate(element.properties):
        length = 1
        if column.count:
            length, at = _length(raw, at, order + column.count, element.name, 0)
            fields.append((f"count{i}", order + column.count))
        fields.append((f"{i}", order + column.type, (length,)))
        at += length * struct.calcsize(order + column.type)
    if element.rows * at <= len(data):
        rows = data[: element.rows * at].view(np.dtype(fields))
        lengths = {i: rows[f"{i}"].shape[1] for i in range(len(element.properties))}
        if all((rows[f"count{i}"] == lengths[i]).all() for i, c in enumerate(element.properties) if c.count):
            table = {
                column.name: (rows[f"{i}"].reshape(-1), np.full(element.rows, lengths[i]))
                for i, column in enumerate(element.properties)
            }
            return table, element.rows * at
    return _walk(data, element, order)


def _walk(data: NDArray[np.uint8], element: _Element, order: str) -> tuple[_Table, int]:
    raw = data.data
    sizes = [struct.calcsize(order + column.type) for column in element.properties]
    starts: list[list[int]] = [[] for _ in sizes]
    lengths: list[list[int]] = [[] for _ in sizes]
    at = 0
    for row in range(element.rows):
        for column, size, start, length in zip(element.properties, sizes, starts, lengths, strict=True):
            count = 1
            if column.count:
                count, at = _length(raw, at, order + column.count, element.name, row)
            start.append(at)
            length.append(count)
            at += count * size
        if at > len(data):
            raise _cut_short(element.name, row)
    table: _Table = {}
    for i, (column, size) in enumerate(zip(element.properties, sizes, strict=True)):
        counts = np.array(lengths[i], np.int64)
        base = np.array(starts[i], np.int64) - (np.cumsum(counts) - counts) * size
        places = np.repeat(base, counts) + np.arange(counts.sum()) * size
        picked = data[places[:, None] + np.arange(size)].reshape(-1)
        table[column.name] = picked.view(order + column.type), counts
    return table, at


def _length(raw: memoryview, at: int, code: str, name: str, row: int) -> tuple[int, int]:
    """Return the count of a list at byte `at`, and the byte at which its numbers begin."""
    size = struct.calcsize(code)
    if at + size > len(raw):
        raise _cut_short(name, row)
    count = struct.unpack_from(code, raw, at)[0]
    if not 0 <= count <= len(raw) or count != int(count):
        raise ReadError(
            f"{name} {row} says that it has {count:g} items: it was cut short or damaged, export it again",
            code="cut_short",
        )
    return int(count), at + size


def _cut_short(name: str, row: int) -> ReadError:
    return ReadError(
        f"it ends within {name} {row}, before its header's count: it was cut short, export it again", code="cut_short"
    )


def _vertices(table: _Table) -> Float:
    if not all(axis in table and (table[axis][1] == 1).all() for axis in "xyz"):
        raise ReadError("its vertices have no x, y and z: export it again")
    return np.stack([table[axis][0].astype(np.float64) for axis in "xyz"], axis=1)


def _faces(table: _Table) -> tuple[Int, Int]:
    """Return how many corners each face has, and the vertex of each corner."""
    name = next((name for name in _CORNERS if name in table), None)
    if name is None:
        raise ReadError("its faces have no list named vertex_indices: export it again")
    corners, counts = table[name]
    return counts, _indices(corners, "faces")


def _edges(table: _Table) -> Int:
    """Return the two vertices of each edge."""
    if not all(name in table and (table[name][1] == 1).all() for name in _ENDS):
        raise ReadError(f"its edges have no {' and '.join(_ENDS)}: export it again")
    return np.stack([_indices(table[name][0], "edges") for name in _ENDS], axis=1)


def _indices(corners: NDArray[Any], what: str) -> Int:
    if corners.dtype.kind in "fu":
        most = 2**53 if corners.dtype.kind == "f" else 2**63
        whole = (np.abs(corners) < most) & (np.floor(corners) == corners)
        if not whole.all():
            wrong = corners[np.argmin(whole)]
            raise ReadError(
                f"its {what} hold {wrong.item():.20g}, which is no index of a vertex: export it again",
                code="node_out_of_range",
            )
    return corners.astype(np.int64)
