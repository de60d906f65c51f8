"""The check of a mesh of cells: nodes, coordinates, cells stored twice, faces of more than two cells, bodies.

Cells are judged by their corner nodes alone, which come first in meshio's order. Nodes are one where their
stored coordinates are equal. Cells are numbered through all blocks.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Int
from inertia.mesh.checks.findings import Finding, Report, around, by_severity, counted, listed, middle, usable
from inertia.mesh.geometry.closure import components
from inertia.mesh.geometry.edges import Place, first_equal
from inertia.mesh.part import Cells, Part

_FACES = {
    "tetra": ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)),
    "pyramid": ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "wedge": ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hexahedron": ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
"""The faces of the volume cells, by their corners' places in the cell."""

_CORNERS = {kind: 1 + max(map(max, faces)) for kind, faces in _FACES.items()}


def check_cells(part: Part, cells: Cells) -> Report:
    """Check a mesh of cells; see `inertia.mesh.check.check`."""
    nothing = _empty(cells) or _out_of_range(cells) or _non_finite(cells)
    if nothing:
        return Report(part.source, cells.count, 0, False, False, None, 0, (), (), (nothing,))
    corners, faces, owner = _volume_cells(cells)
    labels = cell_bodies(cells)
    used = _used(cells)
    return Report(
        source=part.source,
        triangles=cells.count,
        vertices=len(np.unique(_welded(cells)[used])),
        closed=True,
        consistent=True,
        outward=None,
        bodies=int(labels.max()) + 1,
        shells=(),
        loops=(),
        findings=by_severity(
            [
                _stored_again(cells, corners),
                _crowded(cells, faces, owner),
                _several_bodies(cells, labels),
                _unused(cells, used),
            ]
        ),
    )


def cell_bodies(cells: Cells) -> Int:
    """Return the body of each cell: bodies are volume cells that hang together by their faces.

    Bodies are numbered as they appear, cell by cell through all blocks; cells without volume have −1.

    >>> from inertia.mesh.part import CellBlock
    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    >>> cell_bodies(Cells(points, (CellBlock("tetra", np.array([[0, 1, 2, 3], [1, 2, 3, 4]])),)))
    array([0, 0])
    """
    _, faces, owner = _volume_cells(cells)
    first = components(np.column_stack([owner, owner[first_equal(faces)]]), cells.count)
    solid = np.unique(owner)
    labels = np.full(cells.count, -1)
    labels[solid] = np.unique(first[solid], return_inverse=True)[1]
    return labels


def _welded(cells: Cells) -> Int:
    """Return for each node the first node with the same coordinates."""
    return first_equal((cells.points + 0.0).view(np.int64))


def _volume_cells(cells: Cells) -> tuple[Int, Int, Int]:
    """Return the corners of all cells, the faces of the volume cells, and the cells that these belong to.

    Rows, (number of cells, 8) and (f, 4), hold ascending node numbers after as many −1 as fill them up, so
    that cells and faces with the same corners have equal rows. The row of a cell without volume is all −1.
    """
    welded = _welded(cells)
    corners = np.full((cells.count, 8), -1)
    rows, owners = [np.empty((0, 4), np.int64)], [np.empty(0, np.int64)]
    stop = 0
    for block in cells.blocks:
        start, stop = stop, stop + len(block.nodes)
        kind = next((kind for kind in _FACES if block.kind.startswith(kind)), None)
        if kind is None:
            continue
        nodes = welded[block.nodes[:, : _CORNERS[kind]]]
        corners[start:stop, : nodes.shape[1]] = nodes
        for face in _FACES[kind]:
            row = np.full((len(nodes), 4), -1)
            row[:, : len(face)] = nodes[:, face]
            rows.append(_distinct(row))
            owners.append(np.arange(start, stop))
    faces, owner = np.concatenate(rows), np.concatenate(owners)
    area = faces[:, 1] >= 0  # a face of a collapsed cell may be a line
    return _distinct(corners), faces[area], owner[area]


def _distinct(rows: Int) -> Int:
    """Sort each row, after every number that is repeated in it has become −1."""
    rows = np.sort(rows, axis=1)
    rows[:, 1:][rows[:, 1:] == rows[:, :-1]] = -1
    return np.sort(rows, axis=1)


def _used(cells: Cells) -> Int:
    """Return the numbers of the nodes that cells use, ascending."""
    used = np.zeros(len(cells.points), bool)
    for block in cells.blocks:
        used[block.nodes] = True
    return np.flatnonzero(used)


def _empty(cells: Cells) -> Finding | None:
    if cells.count:
        return None
    return Finding("empty", "error", "there are no cells: export the mesh again", 0)


def _out_of_range(cells: Cells) -> Finding | None:
    last = len(cells.points) - 1
    wrong = [(block.nodes < 0) | (block.nodes > last) for block in cells.blocks]
    which = np.flatnonzero(np.concatenate([bad.any(axis=1) for bad in wrong]))
    if len(which) == 0:
        return None
    node = next(block.nodes[bad][0] for block, bad in zip(cells.blocks, wrong, strict=True) if bad.any())
    text = (
        f"{counted(len(which), 'cell')} with a node that does not exist, the first being cell {which[0]} "
        f"with node {node} where the nodes are 0 to {last}: export the mesh again"
    )
    return Finding("node_out_of_range", "error", text, len(which), listed(which))


def _non_finite(cells: Cells) -> Finding | None:
    used = _used(cells)
    wrong = used[~usable(cells.points[used]).all(axis=1)]
    if len(wrong) == 0:
        return None
    text = (
        f"{counted(len(wrong), 'node')} with a coordinate that is no usable number (NaN, infinite or beyond "
        f"1e75), the first being node {wrong[0]}: export the mesh again"
    )
    return Finding("non_finite", "error", text, len(wrong))


def _place(cells: Cells, nodes: Int) -> Place:
    return middle(cells.points[nodes[nodes >= 0]])


def _around(cells: Cells, place: Place) -> str:
    used = cells.points[_used(cells)]
    return around(place, np.stack([used.min(axis=0), used.max(axis=0)]))


def _stored_again(cells: Cells, corners: Int) -> Finding | None:
    again = first_equal(corners) != np.arange(len(corners))
    which = np.flatnonzero(again & (corners[:, -1] >= 0))
    if len(which) == 0:
        return None
    place = _place(cells, corners[which[0]])
    text = (
        f"{counted(len(which), 'cell')} stored again, the first being cell {which[0]} "
        f"{_around(cells, place)}, so that the volume counts twice: remove the copies"
    )
    return Finding("duplicate_cell", "error", text, len(which), listed(which), place)


def _crowded(cells: Cells, faces: Int, owner: Int) -> Finding | None:
    first = first_equal(faces)
    crowded = np.flatnonzero(np.bincount(first, minlength=len(faces)) > 2)
    if len(crowded) == 0:
        return None
    which = owner[np.isin(first, crowded)]
    place = _place(cells, faces[crowded[0]])
    text = (
        f"overlapping cells: {counted(len(crowded), 'face')} of more than two cells, the first "
        f"{_around(cells, place)} at cell {which[0]}, so that the volume counts twice: remove what overlaps"
    )
    return Finding("overlapping_cells", "error", text, len(crowded), listed(which), place)


def _several_bodies(cells: Cells, labels: Int) -> Finding | None:
    count = int(labels.max()) + 1
    if count < 2:
        return None
    first = np.searchsorted(np.maximum.accumulate(labels), np.arange(count))
    return Finding("several_bodies", "note", f"{count} separate bodies", count, listed(first))


def _unused(cells: Cells, used: Int) -> Finding | None:
    count = len(cells.points) - len(used)
    if count == 0:
        return None
    return Finding("unused_vertices", "note", f"{counted(count, 'node')} that no cell uses", count)
