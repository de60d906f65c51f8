"""Topology of a mesh of cells, for its check: equal nodes merged, faces paired, bodies counted.

Cells are judged by their corner nodes alone, which come first in meshio's order. Nodes are one where their
stored coordinates are equal. Cells are numbered through all blocks.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from inertia.arrays import Int
from inertia.mesh.checks.findings import Evidence, around, listed, middle, usable
from inertia.mesh.geometry.closure import components
from inertia.mesh.geometry.edges import Place, first_equal
from inertia.mesh.part import Cells

_FACES = {
    "tetra": ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)),
    "pyramid": ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "wedge": ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hexahedron": ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
"""The faces of the volume cells, by their corners' places in the cell."""

_CORNERS = {kind: 1 + max(map(max, faces)) for kind, faces in _FACES.items()}


@dataclass(frozen=True, eq=False)
class CellTopology:
    """A mesh of cells, and how it hangs together.

    >>> from inertia.mesh.part import CellBlock
    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    >>> CellTopology(Cells(points, (CellBlock("tetra", np.array([[0, 1, 2, 3], [1, 2, 3, 4]])),))).bodies
    array([0, 0])
    """

    cells: Cells

    @cached_property
    def merged(self) -> Int:
        """For each node the first node with the same coordinates."""
        return first_equal((self.cells.points + 0.0).view(np.int64))

    @cached_property
    def used(self) -> Int:
        """The numbers of the nodes that cells use, ascending."""
        used = np.zeros(len(self.cells.points), bool)
        for block in self.cells.blocks:
            used[block.nodes] = True
        return np.flatnonzero(used)

    @cached_property
    def bodies(self) -> Int:
        """The body of each cell: bodies are volume cells that hang together by their faces.

        Bodies are numbered as they appear, cell by cell through all blocks; cells without volume have −1.
        """
        _, faces, owner = self._volume_cells
        first = components(np.column_stack([owner, owner[first_equal(faces)]]), self.cells.count)
        solid = np.unique(owner)
        labels = np.full(self.cells.count, -1)
        labels[solid] = np.unique(first[solid], return_inverse=True)[1]
        return labels

    @cached_property
    def _volume_cells(self) -> tuple[Int, Int, Int]:
        """The corners of all cells, the faces of the volume cells, and the cells that these belong to.

        Rows, (number of cells, 8) and (f, 4), hold ascending node numbers after as many −1 as fill them up, so
        that cells and faces with the same corners have equal rows. The row of a cell without volume is all −1.
        """
        corners = np.full((self.cells.count, 8), -1)
        rows, owners = [np.empty((0, 4), np.int64)], [np.empty(0, np.int64)]
        stop = 0
        for block in self.cells.blocks:
            start, stop = stop, stop + len(block.nodes)
            kind = next((kind for kind in _FACES if block.kind.startswith(kind)), None)
            if kind is None:
                continue
            nodes = self.merged[block.nodes[:, : _CORNERS[kind]]]
            corners[start:stop, : nodes.shape[1]] = nodes
            for face in _FACES[kind]:
                row = np.full((len(nodes), 4), -1)
                row[:, : len(face)] = nodes[:, face]
                rows.append(_distinct(row))
                owners.append(np.arange(start, stop))
        faces, owner = np.concatenate(rows), np.concatenate(owners)
        area = faces[:, 1] >= 0  # a face of a collapsed cell may be a line
        return _distinct(corners), faces[area], owner[area]

    def around(self, place: Place) -> str:
        """Return a place in words."""
        nodes = self.cells.points[self.used]
        return around(place, np.stack([nodes.min(axis=0), nodes.max(axis=0)]))

    def _middle(self, nodes: Int) -> Place:
        return middle(self.cells.points[nodes[nodes >= 0]])

    def out_of_range(self) -> Evidence | None:
        """Find cells with a node that does not exist."""
        last = len(self.cells.points) - 1
        wrong = [(block.nodes < 0) | (block.nodes > last) for block in self.cells.blocks]
        which = np.flatnonzero(np.concatenate([bad.any(axis=1) for bad in wrong]))
        if len(which) == 0:
            return None
        node = next(block.nodes[bad][0] for block, bad in zip(self.cells.blocks, wrong, strict=True) if bad.any())
        return Evidence(len(which), listed(which), None, {"node": node, "last": last})

    def unusable(self) -> Evidence | None:
        """Find nodes with a coordinate that is no usable number."""
        wrong = self.used[~usable(self.cells.points[self.used]).all(axis=1)]
        return Evidence(len(wrong), figures={"node": wrong[0]}) if len(wrong) else None

    def duplicates(self) -> Evidence | None:
        """Find cells that repeat an earlier one."""
        corners, _, _ = self._volume_cells
        again = first_equal(corners) != np.arange(len(corners))
        which = np.flatnonzero(again & (corners[:, -1] >= 0))
        if len(which) == 0:
            return None
        return Evidence(len(which), listed(which), self._middle(corners[which[0]]))

    def overlaps(self) -> Evidence | None:
        """Find faces of more than two cells."""
        _, faces, owner = self._volume_cells
        first = first_equal(faces)
        crowded = np.flatnonzero(np.bincount(first, minlength=len(faces)) > 2)
        if len(crowded) == 0:
            return None
        return Evidence(len(crowded), listed(owner[np.isin(first, crowded)]), self._middle(faces[crowded[0]]))

    def several_bodies(self) -> Evidence | None:
        """Count the bodies, and give the first cell of each."""
        count = int(self.bodies.max()) + 1
        first = np.searchsorted(np.maximum.accumulate(self.bodies), np.arange(count))
        return Evidence(count, listed(first)) if count > 1 else None

    def unused(self) -> Evidence | None:
        """Count the nodes that no cell uses."""
        count = len(self.cells.points) - len(self.used)
        return Evidence(count) if count else None


def _distinct(rows: Int) -> Int:
    """Sort each row, after every number that is repeated in it has become −1."""
    rows = np.sort(rows, axis=1)
    rows[:, 1:][rows[:, 1:] == rows[:, :-1]] = -1
    return np.sort(rows, axis=1)
