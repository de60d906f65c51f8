"""Wavefront OBJ: polygons over shared vertices, or lines where there are no polygons, in named objects or groups.

A negative index counts back from the line that it stands on. A # behind the numbers of a line begins a comment; in a
name it may be part of that (`o Body #2`). A keyword that OBJ does not know is an error, because it may be a damaged
face.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.part import Regions
from inertia.mesh.readers.cells import cell_contents
from inertia.mesh.readers.contents import (
    UNNAMED,
    Contents,
    label,
    numbers,
    plural,
    shown,
    split_polygons,
    text_of,
    was,
)
from inertia.mesh.readers.decimals import rounding_of

_KEYWORDS = frozenset(
    b"v vt vn vp f fo l p o g s mg mtllib usemtl usemap maplib bevel c_interp d_interp lod shadow_obj "
    b"trace_obj ctech stech cstype deg bmat step curv curv2 cdc res parm trim hole scrv sp end con".split()
)
_SURFACES = b"surf", b"bsp", b"bzp", b"cdp"  # the last three of old files
_CALLS = b"call", b"csh"

_CONTINUED = re.compile(rb"(?m)^([^#\r\n]*)\\[ \t]*\r?\n")  # not a comment, which may end with a folder of Windows
_COMMENT = re.compile(rb"(?:^|\s)#.*")
_AFTER_SLASH = re.compile(rb"/\S*")


def read_obj(path: Path) -> Contents:
    """Read an OBJ file: its faces or else its lines, and the object of each (or, without objects, the group)."""
    data = _text(path)
    points: list[bytes] = []
    polygons: list[bytes] = []
    lines: list[bytes] = []
    before: list[int] = []  # vertices read before each face, from which its negative indices count,
    before_lines: list[int] = []  # and before each line
    names: dict[bytes, list[tuple[int, int, bytes]]] = {b"o": [], b"g": []}
    strays = 0
    for number, line in enumerate(data.splitlines(), 1):
        word, *rest = line.split(None, 1) or [b"#"]
        if word == b"v":
            points.append(_uncommented(rest))
        elif word in (b"f", b"fo"):
            polygons.append(_uncommented(rest))
            before.append(len(points))
        elif word in names:
            names[word].append((len(polygons), len(lines), b"".join(rest).strip()))
        elif word == b"l":
            lines.append(_uncommented(rest))
            before_lines.append(len(points))
        elif word == b"p":
            strays += 1
        elif word in _CALLS:
            raise ReadError(
                f"line {number} begins with {shown(word)}, which has another file or command put in: export the part "
                "as one file",
                code="not_read",
            )
        elif word in _SURFACES:
            raise ReadError(
                f"line {number} begins a free-form surface: export the part as a polygon mesh", code="not_read"
            )
        elif word not in _KEYWORDS and not word.startswith(b"#"):
            raise ReadError(f"line {number} begins with {shown(word)}, which OBJ does not know: export it again")
    if not polygons and not lines:
        raise ReadError("it holds no faces, only points: export the part as a surface mesh", code="empty")
    vertices = _points(points)
    regions = [(faces if polygons else edges, name) for faces, edges, name in names[b"o"] or names[b"g"]]
    strays += len(lines) if polygons else 0
    if polygons:
        counts, corners = _corners(polygons, np.array(before, np.int64), len(points))
        whole, owner, notes = split_polygons(vertices, counts, corners)
        contents = Contents(whole, regions=_regions(regions, len(polygons), owner), notes=notes)
    else:
        counts, corners = _corners(lines, np.array(before_lines, np.int64), len(points), "line element")
        if (counts < 2).any():
            raise ReadError(f"line element {np.argmax(counts < 2)} has fewer than two vertices: export it again")
        start = np.delete(np.arange(len(corners)), np.cumsum(counts) - 1)
        contents = cell_contents(vertices, [("line", corners[start[:, None] + [0, 1]], None)])
        owner = np.repeat(np.arange(len(lines)), counts - 1)
        contents = replace(contents, regions=_regions(regions, len(lines), owner))
    if strays:
        what = "line or point element" if polygons else "point element"
        more = f"{plural(strays, what)} beside the {'faces' if polygons else 'lines'} {was(strays)} left out"
        contents = replace(contents, notes=(*contents.notes, more))
    rounding = rounding_of(vertices, lambda: b" ".join(points), lambda: _coordinates(path))
    return replace(contents, rounding=rounding)


def _uncommented(rest: list[bytes]) -> bytes:
    """Return what stands behind the keyword of a line, without the comment behind that."""
    text = rest[0] if rest else b""
    return _COMMENT.sub(b"", text) if b"#" in text else text


def _text(path: Path) -> bytes:
    data = text_of(path)
    return _CONTINUED.sub(rb"\1 ", data) if b"\\" in data else data


def _coordinates(path: Path) -> list[bytes]:
    """Return the coordinates of all vertices as the file writes them."""
    rows = (line.split(None, 4) for line in _text(path).splitlines())
    return [word for row in rows if row[:1] == [b"v"] for word in row[1:4]]


def _points(lines: list[bytes]) -> Float:
    """Return the first three numbers of each line; weights and colours may follow them."""
    widths = {len(line.split()) for line in lines}
    if len(widths) == 1 and min(widths) >= 3:
        return numbers(b" ".join(lines), np.float64, "vertex", lines).reshape(len(lines), -1)[:, :3]
    rows = [line.split()[:3] for line in lines]
    short = next((i for i, row in enumerate(rows) if len(row) < 3), None)
    if short is not None:
        raise ReadError(f"vertex {short} has fewer than three coordinates: export it again")
    return numbers(b" ".join(word for row in rows for word in row), np.float64, "vertex", lines).reshape(-1, 3)


def _corners(lines: list[bytes], before: Int, points: int, what: str = "face") -> tuple[Int, Int]:
    """Return how many corners each face or line has, and the vertex of each corner, from zero, of so many points."""
    counts = np.array([len(line.split()) for line in lines], np.int64)
    text = b"\n".join(lines)
    if b"/" in text:
        text = _AFTER_SLASH.sub(b"", text)
    corners: Int = numbers(text, np.int64, what, lines)
    if len(corners) != counts.sum():
        raise ReadError(f"a corner of a {what} names no vertex before its slash: export it again")
    face = np.repeat(np.arange(len(counts)), counts)
    if (corners == 0).any():
        at = face[np.argmax(corners == 0)]
        raise ReadError(f"{what} {at} names vertex 0, but OBJ counts from 1: export it again", code="node_out_of_range")
    nodes = np.where(corners > 0, corners - 1, corners + before[face])
    out = (nodes < 0) | (nodes >= points)
    if out.any():  # as the file numbers them
        at = int(np.argmax(out))
        extent = f"the vertices are 1 to {points}" if corners[at] > 0 else f"{before[face[at]]} stand before it"
        raise ReadError(
            f"{what} {face[at]} names vertex {corners[at]}, but {extent}: export the mesh again",
            code="node_out_of_range",
        )
    return counts, nodes


def _regions(names: list[tuple[int, bytes]], count: int, owner: Int) -> Regions | None:
    """Return the region of each triangle, from (first face, name) and the face that it came from."""
    if not names:
        return None
    starts = [first for first, _ in names]
    runs: list[tuple[str | None, int]] = [(None, starts[0])]
    for (start, name), stop in zip(names, [*starts[1:], count], strict=True):
        runs.append((name.decode("utf-8", "replace") or UNNAMED, stop - start))
    of_face = label(runs)
    return None if of_face is None else Regions(of_face.names, of_face.index[owner])
