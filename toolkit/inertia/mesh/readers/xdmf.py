"""XDMF: what meshio passes over or misreads in silence, refused before it sees the file; and cells of mixed kinds.

Source: "XDMF Model and Format", xdmf.org.
"""

from __future__ import annotations

import importlib
import math
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from inertia.arrays import Int
from inertia.errors import ReadError
from inertia.mesh.readers.contents import beneath, numbers, plural, shown
from inertia.mesh.readers.hdf5 import check_hdf5, h5py
from inertia.mesh.readers.trimesh import parse_xml

_MIXED = {
    1: ("vertex", 1), 2: ("line", 2), 4: ("triangle", 3), 5: ("quad", 4),
    6: ("tetra", 4), 7: ("pyramid", 5), 8: ("wedge", 6), 9: ("hexahedron", 8),
}  # fmt: skip
"""Numbers of the kinds that may stand in a list of mixed cells: meshio's name, and nodes."""

_ASIDE = ("Time", "Information")

_COUNTED = (1, 2)  # whose number of nodes stands before them


def plain_xdmf(path: Path) -> Element:
    """Return the root of a file with its one grid alone, and the defaults of the format written out for meshio.

    A collection of one grid is that grid; times, remarks and attributes of other places say nothing of a body.
    """
    root = parse_xml(path.read_bytes())
    version = root.get("Version", "2")
    if version.partition(".")[0] not in ("2", "3"):
        raise ReadError(f"it is of the version {shown(version)}, but 2 and 3 are read: write it so", code="not_read")
    grids = [grid for grid in root.iter("Grid") if grid.find("Grid") is None]
    kinds = {grid.get("GridType", "Uniform") for grid in grids}
    if len(grids) > 1 or kinds - {"Uniform"}:
        raise ReadError(
            f"it has {plural(len(grids), 'grid')} ({', '.join(sorted(kinds))}), but one, uniform, is read: write it so",
            code="not_read",
        )
    if root.find(".//include") is not None:
        raise ReadError("it includes parts of other files, which are not read: write them out", code="not_read")
    root[:] = root.findall("Domain")
    for domain in root:
        domain[:] = grids
    for grid in grids:
        grid[:] = [part for part in grid if part.tag not in _ASIDE and part.get("Center", "Node") in ("Node", "Cell")]
        for part in grid:
            if part.tag == "Attribute":
                part.attrib.setdefault("Center", "Node")
            elif part.tag == "Geometry" and "Type" not in part.attrib:
                part.attrib.setdefault("GeometryType", "XYZ")
    for item in root.iter("DataItem"):
        form = item.get("Format", "XML")
        item.set("Format", form.upper() if form.upper() in ("XML", "HDF") else form)
    for item in root.findall(".//Topology/DataItem"):
        if "NumberType" not in item.attrib and "DataType" not in item.attrib:
            item.attrib.update(NumberType="Int", Precision="8")
    return root


def xdmf_cells(path: Path) -> int | None:
    """Check a file; return how many cells it lists, where it says.

    Refuses raw binary files, which meshio would read from anywhere, and HDF5 files outside the folder.
    """
    h5py()  # which meshio loads whatever the file
    root = plain_xdmf(path)
    _check_items(root, path.resolve().parent)
    return _count(root)


def _check_items(root: Element, folder: Path) -> None:
    """Check that every list of numbers is as long as its element says."""
    checked: dict[Path, dict[str, int]] = {}
    for item in root.iter():  # a `Reference` may make any element a data item
        kind = item.get("Format", "").upper()
        text = (item.text or "").strip()
        if kind == "BINARY":
            raise ReadError(
                "it keeps its data in raw binary files, which are not read: use HDF5 or XML", code="not_read"
            )
        if item.get("ItemType", "Uniform") != "Uniform":
            raise ReadError(
                f"its data are a {shown(item.get('ItemType', ''))}, which is not read: write the numbers out",
                code="not_read",
            )
        held: int | None = None
        if kind == "HDF":
            name, _, inside = text.partition(":")
            beside = beneath(folder, name)
            if beside not in checked:
                checked[beside] = check_hdf5(beside)
            held = checked[beside].get(inside.strip("/"))
        elif kind == "XML" and "Reference" not in item.attrib:
            whole = "Int" in (item.get("DataType") or item.get("NumberType") or "")
            held = len(numbers(text.encode(), np.int64 if whole else np.float64, "its data"))
        stated = _product(item.get("Dimensions"))
        if None not in (held, stated) and held != stated:
            raise ReadError(
                f"an element of it has the Dimensions {shown(item.get('Dimensions', ''))}, but {held} numbers: "
                "export it again"
            )


def _count(root: Element) -> int | None:
    """Return how many cells the topology says there are, once nothing is known to change what cells or points mean."""
    tables = {tag: list(root.iter(tag)) for tag in ("Topology", "Geometry")}
    for tag, found in tables.items():
        if len(found) > 1:
            raise ReadError(f"it has {len(found)} elements {tag}, but one is read: write one grid", code="not_read")
    for tag, name in (("Topology", "BaseOffset"), ("Topology", "Order"), ("Geometry", "Origin")):
        for element in tables[tag]:
            value = element.get(name, "")
            words = value.split()
            if words != [*map(str, range(len(words)))] if name == "Order" else any(map(_is_not_zero, words)):
                raise ReadError(
                    f"its {tag} has the {name} {shown(value)}, which is not read: export it without",
                    code="not_read",
                )
    for element in tables["Topology"]:
        stated = element.get("NumberOfElements") or element.get("Dimensions") or ""
        return _product(stated) if len(stated.split()) == 1 else None
    return None


def _product(dimensions: str | None) -> int | None:
    """Return how many items dimensions make; None where there are none, or what are no numbers."""
    words = (dimensions or "").split()
    return math.prod(map(int, words)) if words and all(word.isdecimal() and len(word) < 19 for word in words) else None


def _is_not_zero(word: str) -> bool:
    try:
        return float(word) != 0
    except ValueError:
        return True


def mixed_cells(data: Int) -> list[Any]:
    """Return meshio's blocks of the cells in a list of mixed kinds: the number of each one's kind, and its nodes."""
    blocks: list[tuple[str, list[Int]]] = []
    at = 0
    while at < len(data):
        number = int(data[at])
        kind, nodes = _MIXED.get(number, ("", 0))
        begin = at + 1 + (number in _COUNTED)
        if not kind or (number in _COUNTED and data[begin - 1 : begin].tolist() != [nodes]):
            raise ReadError(
                f"its list of mixed cells has one of the kind {number} at place {at}, which is not read: use points, "
                "lines of two nodes, and cells of first order",
                code="not_read",
            )
        at = begin + nodes
        if at > len(data):
            raise ReadError("its list of mixed cells ends within one: it was cut short", code="cut_short")
        if not blocks or blocks[-1][0] != kind:
            blocks.append((kind, []))
        blocks[-1][1].append(data[begin:at])
    block = importlib.import_module("meshio").CellBlock
    return [block(kind, np.array(rows)) for kind, rows in blocks]
