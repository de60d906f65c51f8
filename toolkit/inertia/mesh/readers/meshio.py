"""VTK, VTU, Nastran, Abaqus, MED, XDMF and a few more, through meshio.

meshio prints, calls `sys.exit` on files that it cannot read, raises whatever comes, and passes over what it
does not understand. What it would misread is refused before (`inertia.mesh.readers.meshio_guards`); the rest is dealt
with here.
"""

from __future__ import annotations

import importlib
import re
from codecs import BOM_UTF8
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int
from inertia.errors import ReadError
from inertia.mesh.part import Rounding
from inertia.mesh.readers.abaqus import plain_input
from inertia.mesh.readers.cells import Block, cell_contents, dimension_of, with_joint
from inertia.mesh.readers.contents import UNNAMED, Contents, plural, quietly, shown, text_of, was
from inertia.mesh.readers.decimals import rounding_of
from inertia.mesh.readers.legacy_vtk import teach
from inertia.mesh.readers.med import families, med_unit, with_families
from inertia.mesh.readers.medit import plain_medit
from inertia.mesh.readers.meshio_guards import NASTRAN_READ, cells_expected, without_comments
from inertia.mesh.readers.nastran import plain_bulk_data
from inertia.mesh.readers.su2 import plain_su2
from inertia.mesh.readers.ucd import plain_ucd
from inertia.mesh.readers.vtu import plain_vtu
from inertia.mesh.readers.xdmf import mixed_cells, plain_xdmf
from inertia.output import temporary_folder

_TAGS = (
    "nastran:ref", "medit:ref", "netgen:index", "su2:tag", "avsucd:material", "gmsh:physical",
    "material", "materialid", "materialids", "mat", "matid", "region", "regionid", "regions", "tag", "tags",
    "part", "partid", "group", "groupid", "body", "bodyid", "domain", "subdomain", "block", "blockid",
    "zone", "zoneid", "cellentityids",
)  # fmt: skip
"""Cell data that say which region a cell is in, by preference; their names in lower case and without `_`."""

_FORGOTTEN = ("wedge15", "pyramid13", "hexahedron24")
"""Kinds that meshio 5.3.5 knows, but raises `KeyError` for want of their dimension."""


_ALIGNED = {8: ("pixel", 9, (0, 1, 3, 2)), 11: ("voxel", 12, (0, 1, 3, 2, 4, 5, 7, 6))}
"""VTK's cells along the axes, whose corners run row by row: name, the kind that they are, and its order of them."""

_SEVERAL = {2: "poly-vertex", 4: "poly-line", 6: "triangle strip"}
"""VTK's cells of any number of others, which meshio does not know."""

_GHOST = 1 | 32  # of another piece, or hidden

_LISTED = 5  # names of sets in a note

_DECIMALS = {
    "vtk": rb"\A[^\n]*\n[^\n]*\n\s*ASCII\b",
    "vtu": rb"(?is)<Points>[^>]*?<DataArray[^>]*format=.ascii.",
    "xdmf": rb"(?is)<Geometry\b[^>]*>\s*<DataItem\b(?![^>]*\bFormat\s*=\s*.HDF\b)",
    **dict.fromkeys(("nastran", "abaqus", "medit", "netgen", "su2", "avsucd"), rb""),
}
"""What is in the files of a format that write points as decimals."""

_UNMARKED = ("vtk", "nastran", "abaqus", "medit", "netgen", "su2", "avsucd")
"""Formats of text, other than XML, before which meshio knows no byte order mark."""

_PLAIN = {"abaqus": plain_input, "medit": plain_medit, "avsucd": plain_ucd}
"""What brings the text of a format into the words that meshio knows."""

_NO_END = "it has no End: it was read for the tables that are there"


def read_with_meshio(path: Path, kind: str) -> Contents:
    """Read a file of the format that meshio calls `kind`."""
    if kind in _UNMARKED and (data := path.read_bytes()).startswith(BOM_UTF8):
        with temporary_folder() as folder:
            plain = folder / f"part{path.suffix}"
            plain.write_bytes(data.removeprefix(BOM_UTF8))
            return read_with_meshio(plain, kind)
    expected = cells_expected(path, kind)
    notes = [_NO_END] if kind == "medit" and not _ends(path) else []
    text: bytes | None = None
    if kind == "nastran":
        text, more = plain_bulk_data(without_comments(text_of(path)), NASTRAN_READ)
        notes += more
    elif kind == "su2":
        text, expected = plain_su2(text_of(path))
    elif kind in _PLAIN:
        text = _PLAIN[kind](text_of(path))
    elif kind == "vtu":
        text = plain_vtu(path.read_bytes())
    unit = None
    if kind == "med":
        unit = med_unit(path)
        with with_families(path) as whole:
            mesh = _mesh(whole, kind)
    elif text is None:
        mesh = _mesh(path, kind)
    else:
        with temporary_folder() as folder:
            plain = folder / "part"
            plain.write_bytes(text)
            mesh = _mesh(plain, kind)
    contents = contents_of(mesh, expected)
    rounding = _rounding(path, kind, mesh.points, text)
    return replace(contents, unit=unit, notes=(*contents.notes, *notes), rounding=rounding)


def contents_of(mesh: Any, expected: int | None = None) -> Contents:
    """Return what a `meshio.Mesh` holds; `expected` is how many cells there are, where that is known."""
    if np.any(mesh.point_data.get("nastran:ref", 0)):
        raise ReadError("its grid points have a coordinate system of their own: write them in the basic one")
    nodes = [_nodes(block) for block in mesh.cells]
    count = sum(map(len, nodes))
    if expected is not None and count != expected:
        raise ReadError(
            f"it lists {plural(expected, 'cell')}, but meshio could read {count}: "
            "use cells of first or second order, or its count is wrong, and export the mesh again"
        )
    names, regions, of_sets = _regions(mesh, [len(block) for block in nodes])
    ghosts = [
        np.asarray(ghost).reshape(-1).astype(np.int64) & _GHOST != 0
        for ghost in mesh.cell_data.get("vtkGhostType", [np.zeros(len(block), np.int64) for block in nodes])
    ]
    if left_out := int(sum(map(np.count_nonzero, ghosts))):
        of_sets.append(
            f"{plural(left_out, 'cell')} that vtkGhostType calls duplicate or hidden {was(left_out)} left out"
        )
        nodes = [block[~ghost] for block, ghost in zip(nodes, ghosts, strict=True)]
        regions = [each if each is None else each[~ghost] for each, ghost in zip(regions, ghosts, strict=True)]
    blocks: list[Block] = [
        (block.type, corners, region) for block, corners, region in zip(mesh.cells, nodes, regions, strict=True)
    ]
    families: dict[int, list[str]] = getattr(mesh, "cell_tags", {})
    joint = {"+".join(groups) for groups in families.values() if len(groups) > 1}
    contents = with_joint(cell_contents(np.asarray(mesh.points), blocks, names), joint)
    return replace(contents, notes=(*contents.notes, *of_sets))


def _rounding(path: Path, kind: str, stored: NDArray[Any], text: bytes | None) -> Rounding | None:
    """Return what was rounded of points in decimals, which meshio takes to the nearest number of the file's type.

    `text` was read in place of the file's, if not None.
    """
    if stored.dtype.kind != "f" or not _writes_decimals(path, kind):
        return None
    points = np.zeros((len(stored), 3))
    points[:, : stored.shape[1]] = stored
    written = path.read_bytes if text is None else lambda: text
    return rounding_of(points, written, precision=np.float32 if stored.dtype.itemsize == 4 else np.float64)


def _writes_decimals(path: Path, kind: str) -> bool:
    """Say whether a file holds its points as text."""
    pattern = _DECIMALS.get(kind)
    return pattern is not None and re.search(pattern, path.read_bytes()) is not None


def _ends(path: Path) -> bool:
    return any(b"End" in line.partition(b"#")[0].split() for line in path.read_bytes()[-4096:].splitlines())


def _mesh(path: Path, kind: str) -> Any:
    """Return meshio's mesh."""
    with quietly("meshio", kind):
        if kind == "xdmf":  # of version 2 or 3, which differ in words alone
            return _meshio().xdmf.main.XdmfReader(path).read_xdmf3(plain_xdmf(path))
        return _meshio().read(path, file_format=kind)


@cache
def _meshio() -> Any:
    """Return meshio, once it checks cells of VTK and XDMF and knows all attributes of legacy VTK."""
    meshio = importlib.import_module("meshio")
    for name in _FORGOTTEN:
        meshio._mesh.topological_dimension.setdefault(name, 3)
    for name in _SEVERAL.values():
        meshio._mesh.topological_dimension.setdefault(name, dimension_of(name))
    meshio.vtu._vtu._organize_cells = _vtu_cells(meshio.vtu._vtu._organize_cells)
    meshio.vtu._vtu.vtk_cells_from_data = meshio.vtk._vtk_51.vtk_cells_from_data = _vtk_cells
    meshio.xdmf.main.translate_mixed_cells = mixed_cells
    meshio.med._med._read_families = families
    meshio.vtk._vtk_42.translate_cells = _vtk_lists
    teach(meshio.vtk._vtk_42)
    teach(meshio.vtk._vtk_51)
    return meshio


def _vtu_cells(known: Callable[..., Any]) -> Callable[..., Any]:
    """Return what reads the cells of VTU once their kinds are known to be read; meshio looks for faces of polyhedra."""

    def read(offsets: Int, pieces: list[dict[str, Int]], cell_data: list[dict[str, Any]]) -> Any:
        for number in {number for piece in pieces for number in np.unique(piece["types"]).tolist()}:
            _kind_of(number)
        return known(offsets, pieces, cell_data)

    return read


def _vtk_cells(corners: Int, ends: Int, types: Int, cell_data: dict[str, Any]) -> Any:
    """Return meshio's cells of a VTK file, once each is known to have as many corners as its type has.

    meshio takes as many corners before the end of a cell as its type needs, whoever they belong to, and passes over
    the types that it does not know.
    """
    if not len(types):
        return [], {}
    meshio = importlib.import_module("meshio")
    ends = ends.astype(np.int64)
    sizes = np.diff(ends, prepend=0)
    for number, size in {*zip(types.tolist(), sizes.tolist(), strict=True)}:
        kind, nodes = _kind_of(number)
        if nodes not in (size, None):
            raise ReadError(f"a cell of the kind {kind} has {size} nodes, not {nodes}: it is damaged, export it again")
    if int(ends[-1]) != len(corners):
        raise ReadError(f"its cells have {ends[-1]} corners, but {len(corners)} are listed: it is damaged")
    corners, types = _turned_around(corners, ends - sizes, types)
    single = ~np.isin(types, [*_SEVERAL])
    blocks: list[Any] = []
    data: dict[str, list[Any]] = {}
    if single.any():
        blocks, data = meshio._vtk_common.vtk_cells_from_data(
            corners[np.repeat(single, sizes)],
            np.cumsum(sizes[single]),
            types[single],
            {name: values[single] for name, values in cell_data.items()},
        )
    for number, size in {*zip(types[~single].tolist(), sizes[~single].tolist(), strict=True)}:
        at = np.flatnonzero((types == number) & (sizes == size))
        blocks.append(meshio.CellBlock(_SEVERAL[number], corners[(ends - sizes)[at, None] + np.arange(size)]))
        for name, values in cell_data.items():
            data.setdefault(name, []).append(values[at])
    return blocks, data


def _kind_of(number: int) -> tuple[str, int | None]:
    """Return the name of VTK's type and how many nodes it has, None for any number; refuse one that meshio does not."""
    if number in _ALIGNED:
        kind, _, order = _ALIGNED[number]
        return kind, len(order)
    if number in _SEVERAL:
        return _SEVERAL[number], None
    meshio = importlib.import_module("meshio")
    kind = meshio._vtk_common.vtk_to_meshio_type.get(number, f"{number} of VTK")
    nodes = meshio._common.num_nodes_per_cell.get(kind)
    if nodes is None and kind != "polygon" and not kind.startswith("VTK_LAGRANGE"):
        raise ReadError(
            f"its cells of the kind {kind} are not read: use cells of first or second order", code="not_read"
        )
    return kind, nodes


def _vtk_lists(lists: Int, types: Int, cell_data: dict[str, Any]) -> Any:
    """Return meshio's cells of a VTK file before version 5.1, whose lists of corners begin with their number."""
    known = importlib.import_module("meshio").vtk._vtk_42.vtk_type_to_numnodes
    sizes = known[np.clip(types, 0, len(known) - 1)]
    if types.max(initial=0) >= len(known) or (sizes < 1).any():  # of any number
        at = 0
        for k in range(len(types)):
            sizes[k] = lists[at] if at < len(lists) else -1
            at += 1 + max(int(sizes[k]), 0)
    ends = np.cumsum(sizes)
    heads = ends - sizes + np.arange(len(types))
    if (sizes < 0).any() or sizes.sum() + len(types) != len(lists) or (lists[heads] != sizes).any():
        raise ReadError("its lists of corners do not agree with its CELL_TYPES: it is damaged, export it again")
    return _vtk_cells(np.delete(lists, heads), ends, types, cell_data)


def _turned_around(corners: Int, starts: Int, types: Int) -> tuple[Int, Int]:
    """Return the corners and kinds with pixels as quadrilaterals and voxels as hexahedra, which begin at `starts`."""
    turned, kinds = corners.copy(), types.copy()
    for number, (_, kind, order) in _ALIGNED.items():
        first = starts[types == number][:, None]
        turned[first + np.arange(len(order))] = corners[first + np.array(order)]
        kinds[types == number] = kind
    return turned, kinds


def _nodes(block: Any) -> Int:
    """Return the nodes of a block of cells, (m, k)."""
    if str(block.type).startswith("polyhedron"):
        raise ReadError(
            "its cells of the kind polyhedron are not read: use cells of first or second order", code="not_read"
        )
    nodes = np.asarray(block.data)
    if nodes.ndim != 2 or nodes.dtype.kind not in "iu":
        raise ReadError(f"its cells of the kind {shown(str(block.type))} have no table of nodes: export the mesh again")
    if nodes.dtype.kind == "u" and nodes.dtype.itemsize >= 4:  # a node 0 that counts from 1 is -1
        nodes = nodes.astype(f"i{nodes.dtype.itemsize}")
    return nodes.astype(np.int64)


def _regions(mesh: Any, sizes: list[int]) -> tuple[tuple[str, ...], list[NDArray[np.int32] | None], list[str]]:
    """Return names, the region of each cell by block, and notes, from sets of cells or else cell data."""
    if mesh.cell_sets and sizes:
        return _from_sets(mesh.cell_sets, sizes)
    known = {name.lower().replace("_", "").replace(" ", ""): values for name, values in mesh.cell_data.items()}
    families: dict[int, list[str]] = getattr(mesh, "cell_tags", {})
    for key in ("celltags", *_TAGS):
        tags = [np.asarray(values) for values in known.get(key, ())]
        if tags and len(tags) == len(sizes) and all(_whole(tag, size) for tag, size in zip(tags, sizes, strict=True)):
            tag = np.concatenate([tag.reshape(-1) for tag in tags])
            numbers, index = np.unique(tag, return_inverse=True)
            names = tuple("+".join(families.get(int(t), [])) or (str(int(t)) if t else UNNAMED) for t in numbers)
            ends = np.cumsum(sizes)[:-1]
            return names, list(np.split(index.astype(np.int32), ends)), []
    return (), [None] * len(sizes), []


def _whole(tags: NDArray[Any], size: int) -> bool:
    return (
        tags.size == size and tags.dtype.kind in "iuf" and bool((np.abs(tags) < 2**53).all() and (tags % 1 == 0).all())
    )


def _from_sets(
    sets: dict[str, Any], sizes: list[int]
) -> tuple[tuple[str, ...], list[NDArray[np.int32] | None], list[str]]:
    """Return regions from sets of cells; a cell in several sets belongs to the smallest."""
    names = [UNNAMED]
    regions = [np.zeros(size, np.int32) for size in sizes]
    members: dict[str, list[NDArray[Any]]] = {}
    notes = []
    for name, lists in sets.items():
        parts = [_members(part) for part in lists]
        if len(parts) == len(sizes) and all(
            part.ndim == 1 and part.dtype.kind in "iu" and (part >= 0).all() and (part < size).all()
            for part, size in zip(parts, sizes, strict=True)
        ):
            members[name] = parts
        else:
            notes.append(f"the set of sets {shown(str(name))} was not taken for a region")
    several = 0
    for name in sorted(members, key=lambda name: -sum(map(len, members[name]))):
        for region, part in zip(regions, members[name], strict=True):
            several += int((region[part] > 0).sum())
            region[part] = len(names)
        names.append(str(name))
    if several:
        left = {int(number) for region in regions for number in np.unique(region)}
        empty = [shown(name) for number, name in enumerate(names) if number and number not in left and members[name]]
        more = f" and {len(empty) - _LISTED} more" if len(empty) > _LISTED else ""
        leaves = f", which leaves none to {', '.join(empty[:_LISTED])}{more}" if empty else ""
        notes.append(f"{plural(several, 'cell')} in more than one set {was(several)} counted to the smallest{leaves}")
    return tuple(names), list(regions), notes


def _members(part: Any) -> NDArray[Any]:
    """Return the numbers of a set's cells in one block; what is no list of numbers is no flat array."""
    try:
        return np.empty(0, np.int64) if part is None else np.asarray(part)
    except ValueError:  # lists of several lengths
        return np.empty((0, 0))
