"""Gmsh MSH 2.2 and 4.1, text or binary; physical groups are regions.

Read here, and not through meshio, which refuses files where only some entities are in a physical group,
leaves the nodes of `wedge18` and `pyramid14` in Gmsh's order, and allocates by the largest tag that a file
names. Source: C. Geuzaine and J.-F. Remacle, "Gmsh Reference Manual" 4.13, sections 10.1 and 10.2.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from inertia.arrays import Int
from inertia.errors import ReadError
from inertia.mesh.readers import msh2, msh4
from inertia.mesh.readers.cells import Block, cell_contents, dimension_of
from inertia.mesh.readers.contents import UNNAMED, Contents, shown
from inertia.mesh.readers.msh_numbers import FORMAT, MshFile
from inertia.mesh.readers.msh_types import TYPES

_VERSIONS = {"2": msh2, "2.1": msh2, "2.2": msh2, "4": msh4, "4.1": msh4}
_NAME = re.compile(rb'(\d)\s+(\d{1,9})\s+"([^"\r\n]*)"')


def read_gmsh(path: Path) -> Contents:
    """Read an MSH file; the region of an element is its physical group (the first, if it is in several)."""
    data = path.read_bytes()
    header = FORMAT.search(data)
    if header is None:
        raise ReadError("its $MeshFormat section is damaged: export it again")
    version = header[1].decode("ascii", "replace")
    if version not in _VERSIONS:
        raise ReadError(f"it is MSH {shown(version)}, but 2.2 and 4.1 are read: save it as one of these")
    file = MshFile(data, header)
    tags, points = _VERSIONS[version].nodes(file)
    if not len(tags):
        raise ReadError("it holds no nodes: export the mesh again")
    order = np.argsort(tags, kind="stable")
    twice = np.diff(tags[order]) == 0
    if twice.any():
        raise ReadError(f"it defines node {tags[order][np.argmax(twice)]} twice: export it again")
    titles = _physical_names(file)
    places: dict[str, int] = {}
    blocks: list[Block] = []
    for number, physical, corners in _VERSIONS[version].elements(file):
        kind, arrangement = TYPES[number]
        found, which = np.unique(physical, return_inverse=True)
        names = [titles.get((dimension_of(kind), tag), str(tag)) if tag else UNNAMED for tag in found.tolist()]
        region = np.array([places.setdefault(name, len(places)) for name in names], np.int32)
        blocks.append((kind, _points(tags, order, corners[:, arrangement]), region[which]))
    return cell_contents(points, blocks, tuple(places))


def _physical_names(file: MshFile) -> dict[tuple[int, int], str]:
    """Return (dimension, tag) of each physical group → its name."""
    found = _NAME.finditer(file.section("PhysicalNames") or b"")
    return {(int(match[1]), int(match[2])): match[3].decode("utf-8", "replace") for match in found}


def _points(tags: Int, order: Int, wanted: Int) -> Int:
    """Return the places in `tags` of the tags that elements name; `order` sorts `tags`."""
    at = np.searchsorted(tags, wanted, sorter=order)
    place: Int = order[np.minimum(at, len(tags) - 1)]
    missing = tags[place] != wanted
    if missing.any():
        raise ReadError(f"its elements name node {wanted[missing][0]}, which it does not define: export it again")
    return place
