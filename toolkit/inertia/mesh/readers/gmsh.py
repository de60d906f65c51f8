"""Gmsh MSH 2.2 and 4.1, text or binary; physical groups are regions.

Read here, and not through meshio, which refuses files where only some entities are in a physical group,
leaves the nodes of `wedge18` and `pyramid14` in Gmsh's order, and allocates by the largest tag that a file
names. Source: C. Geuzaine and J.-F. Remacle, "Gmsh Reference Manual" 4.13, sections 10.1 and 10.2.
"""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from dataclasses import replace
from itertools import groupby
from pathlib import Path

import numpy as np

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.readers.cells import Block, cell_contents, dimension_of, with_joint
from inertia.mesh.readers.contents import UNNAMED, Contents, shown
from inertia.mesh.readers.decimals import rounding_of
from inertia.mesh.readers.gmsh_sections import FORMAT, TYPES, Group, MshFile, Section, nodes_of

_OLD, _NEW = ("2", "2.1", "2.2"), ("4.1",)
_FIRST = re.compile(rb"^\$NOD\s", re.MULTILINE)
_NAME = re.compile(rb'(\d)\s+(\d{1,9})\s+"([^"\r\n]*)"')


def read_gmsh(path: Path) -> Contents:
    """Read an MSH file; the region of an element is its physical group, or the several that it is in."""
    data = path.read_bytes().removeprefix(BOM_UTF8)
    header = FORMAT.search(data)
    if header is None:
        raise _unknown(data)
    version = header[1].decode("ascii", "replace")
    if version not in (*_OLD, *_NEW):
        named = "4.0" if version == "4" else version
        raise ReadError(f"it is MSH {shown(named)}, but 2.2 and 4.1 are read: save it as one of these", code="not_read")
    file = MshFile(data, header)
    old = version in _OLD
    tags, points = _nodes_2(file) if old else _nodes_4(file)
    if not len(tags):
        raise ReadError("it holds no nodes: export the mesh again", code="empty")
    order = np.argsort(tags, kind="stable")
    twice = np.diff(tags[order]) == 0
    if twice.any():
        raise ReadError(f"it defines node {tags[order][np.argmax(twice)]} twice: export it again")
    titles = _physical_names(file)
    several: list[tuple[int, ...]] = []
    places: dict[str, int] = {}
    blocks: list[Block] = []
    joint: set[str] = set()
    for number, physical, corners in _elements_2(file, several) if old else _elements_4(file, several):
        kind, arrangement = TYPES[number]
        groups, which = np.unique(physical, return_inverse=True)
        own = [several[~tag] if ~tag in range(len(several)) else (tag,) for tag in groups.tolist()]
        dimension = dimension_of(kind)
        titled = [dict.fromkeys(titles.get((dimension, k), str(k)) if k else UNNAMED for k in tags) for tags in own]
        names = ["+".join(each) for each in titled]
        joint |= {name for name, each in zip(names, titled, strict=True) if len(each) > 1}
        region = np.array([places.setdefault(name, len(places)) for name in names], np.int32)
        blocks.append((kind, _points(tags, order, corners[:, arrangement]), region[which]))
    contents = with_joint(cell_contents(points, blocks, tuple(places)), joint)
    if file.binary:
        return contents
    rounding = rounding_of(points, lambda: file.section("Nodes") or b"", lambda: _coordinates(path))
    return replace(contents, rounding=rounding)


def _unknown(data: bytes) -> ReadError:
    """Return what is wrong with a file whose version cannot be read."""
    if _FIRST.search(data):
        return ReadError("it is MSH 1, but 2.2 and 4.1 are read: save it as one of these", code="not_read")
    if b"$MeshFormat" not in data:
        return ReadError(
            "it has no section $MeshFormat: it is no MSH file of Gmsh, or was cut short", code="wrong_format"
        )
    return ReadError("its $MeshFormat section is damaged: export it again")


def _coordinates(path: Path) -> list[bytes]:
    """Return the coordinates of all nodes as a text file writes them."""
    data = path.read_bytes().removeprefix(BOM_UTF8)
    header = FORMAT.search(data)
    words = (MshFile(data, header).section("Nodes") or b"").split() if header else []
    if header is None or header[1].decode("ascii", "replace") in _OLD:
        return [word for at, word in enumerate(words[1:]) if at % 4]
    coordinates, at = [], 4
    try:
        while at < len(words):
            dimension, _, parametric, count = map(int, words[at : at + 4])
            width = 3 + (dimension if parametric else 0)
            at += 4 + count
            coordinates += [word for k in range(count) for word in words[at + k * width : at + k * width + 3]]
            at += count * width
    except ValueError:  # it has changed: what was read does not match, which is said
        return []
    return coordinates


def _physical_names(file: MshFile) -> dict[tuple[int, int], str]:
    """Return (dimension, tag) of each physical group → its name."""
    matches = _NAME.finditer(file.section("PhysicalNames") or b"")
    return {(int(match[1]), int(match[2])): match[3].decode("utf-8", "replace") for match in matches}


def _points(tags: Int, order: Int, names: Int) -> Int:
    """Return the places in `tags` of the tags that elements name; `order` sorts `tags`."""
    at = np.searchsorted(tags, names, sorter=order)
    place: Int = order[np.minimum(at, len(tags) - 1)]
    missing = tags[place] != names
    if missing.any():
        raise ReadError(
            f"its elements name node {names[missing][0]}, which it does not define: export it again",
            code="node_out_of_range",
        )
    return place


def _nodes_2(file: MshFile) -> tuple[Int, Float]:
    """Return the tags (n,) and the coordinates (n, 3) of the nodes of MSH 2."""
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


_Elements = tuple[int, Int, Int, Int]
"""Elements of MSH 2 of one type: Gmsh's number of it, the physical and the elementary tag of each, its node tags."""


def _elements_2(file: MshFile, several: list[tuple[int, ...]]) -> list[Group]:
    """Return the elements of MSH 2, which stores one that is in several physical groups once for each of them.

    Those have ~k for their group, as in `_elements_4`.
    """
    body = file.numbers("Elements")
    total = body.line()
    elements = _binary_elements(body, total) if file.binary else _text_elements(body, total)
    body.finish("elements", total, sum(len(corners) for _, _, _, corners in elements))
    groups = []
    for number, runs in groupby(elements, key=lambda each: each[0]):
        _, *columns = zip(*runs, strict=True)
        physical, elementary, corners = map(np.concatenate, columns)
        again = (corners[1:] == corners[:-1]).all(axis=1) & (elementary[1:] == elementary[:-1])
        again &= (physical[1:] != physical[:-1]) & (physical[1:] != 0) & (physical[:-1] != 0)
        first = np.flatnonzero(np.append(True, ~again))
        sizes = np.diff(first, append=len(corners))
        tags = physical[first]
        for size in np.unique(sizes[sizes > 1]).tolist():
            at = np.flatnonzero(sizes == size)
            own = np.sort(physical[first[at, None] + np.arange(size)], axis=1)
            sets, which = np.unique(own, axis=0, return_inverse=True)
            tags[at] = np.array([_joint(set(each), several) for each in sets.tolist()])[which.reshape(-1)]
        groups.append((number, tags, corners[first]))
    return groups


def _joint(groups: set[int], several: list[tuple[int, ...]]) -> int:
    """Return ~k for physical groups, k their place in `several`, which takes them in where they are new."""
    key = tuple(sorted(groups))
    if key not in several:
        several.append(key)
    return ~several.index(key)


def _binary_elements(body: Section, total: int) -> list[_Elements]:
    groups = []
    done = 0
    while done < total:
        number, count, tags = (int(value) for value in body.ints(3))
        width = _width(1, number, tags)
        rows = body.ints(count * width).reshape(-1, width)
        groups.append((number, *_split(rows, number, 1, tags)))
        done += count
    return groups


def _text_elements(body: Section, total: int) -> list[_Elements]:
    values = body.rest()
    groups = []
    done = at = 0
    while done < total:
        if at + 3 > len(values):
            raise ReadError(
                f"its section $Elements ends after {done} of {total} elements: it was cut short", code="cut_short"
            )
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
    count, step = 0, 64
    while count < most:
        rows = values[count * width : min(count + step, most) * width].reshape(-1, width)
        alike = (rows[:, 1:3] == values[1:3]).all(axis=1)
        if not alike.all():
            count += int(np.argmin(alike))
            break
        count += len(rows)
        step *= 2
    if not count:
        raise ReadError(
            "its section $Elements ends within an element: it was cut short, export it again", code="cut_short"
        )
    return values[: count * width].reshape(-1, width)


def _width(first: int, number: int, tags: int) -> int:
    """Return the numbers in the row of an element whose tags begin at column `first`."""
    if tags < 0:
        raise ReadError(f"its section $Elements has an element with {tags} tags: it is damaged, export it again")
    return first + tags + nodes_of(number)


def _split(rows: Int, number: int, first: int, tags: int) -> tuple[Int, Int, Int]:
    """Return the physical, elementary and node tags of rows whose tags begin at column `first`.

    The sign of a physical tag says which way round the entity is in its group, as in MSH 4.
    """
    none = np.zeros(len(rows), np.int64)
    physical, elementary = (rows[:, first + k] if k < tags else none for k in (0, 1))
    return np.abs(physical), elementary, rows[:, -nodes_of(number) :]


def _nodes_4(file: MshFile) -> tuple[Int, Float]:
    """Return the tags (n,) and the coordinates (n, 3) of the nodes of MSH 4."""
    body = file.numbers("Nodes")
    blocks, total, _, _ = body.sizes(4).tolist()
    tags: list[Int] = [np.empty(0, np.int64)]
    points: list[Float] = [np.empty((0, 3))]
    for _ in range(blocks):
        dimension, _, parametric = body.ints(3).tolist()
        if not 0 <= dimension <= 3:
            raise ReadError(f"its section $Nodes has an entity of dimension {dimension}: export it again")
        count = body.size()
        width = 3 + (dimension if parametric else 0)
        tags.append(body.sizes(count))
        points.append(body.floats(count * width).reshape(count, width)[:, :3])
    body.finish("nodes", total, sum(map(len, tags)))
    return np.concatenate(tags), np.concatenate(points)


def _elements_4(file: MshFile, several: list[tuple[int, ...]]) -> list[Group]:
    """Return the elements of MSH 4; their entity says which physical group they belong to.

    Elements in more than one have ~k for it, the place of their groups in `several`, which is filled.
    """
    physical = _entities(file, several)
    body = file.numbers("Elements")
    blocks, total, _, _ = body.sizes(4).tolist()
    groups: list[Group] = []
    for _ in range(blocks):
        dimension, entity, number = body.ints(3).tolist()
        count = body.size()
        width = 1 + nodes_of(number)
        rows = body.sizes(count * width).reshape(count, width)
        groups.append((number, np.full(count, physical.get((dimension, entity), 0)), rows[:, 1:]))
    body.finish("elements", total, sum(len(corners) for _, _, corners in groups))
    return groups


def _entities(file: MshFile, several: list[tuple[int, ...]]) -> dict[tuple[int, int], int]:
    """Return (dimension, tag) of each entity in physical groups → the tag of the group, or ~k as above."""
    physical: dict[tuple[int, int], int] = {}
    if file.section("Entities") is None:
        return physical
    body = file.numbers("Entities")
    for dimension, count in enumerate(body.sizes(4).tolist()):
        for _ in range(count):
            tag = int(body.ints(1)[0])
            body.floats(6 if dimension else 3)
            groups = {abs(group) for group in body.ints(body.size()).tolist()}
            if dimension:
                body.ints(body.size())
            if groups:
                physical[dimension, tag] = _joint(groups, several) if len(groups) > 1 else groups.pop()
    return physical
