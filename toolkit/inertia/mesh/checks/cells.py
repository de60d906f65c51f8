"""Topology of a mesh of cells, for its check: equal nodes merged, faces paired, bodies counted, tangled cells.

Faces are judged by their corner nodes alone, which come first in meshio's order. Nodes are one where their
stored coordinates are equal. Cells are numbered through all blocks.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Int
from inertia.errors import Remedy
from inertia.mesh.checks.findings import Evidence, around, counted, listed, middle
from inertia.mesh.geometry.cell_maps import TANGLED, Jacobians, jacobians
from inertia.mesh.geometry.cell_shapes import FLAT_TRIANGLES, KINDS, known_volume_blocks, numbered_blocks
from inertia.mesh.geometry.edges import Place, first_equal
from inertia.mesh.geometry.faces import components, repeated_corners
from inertia.mesh.part import Cells
from inertia.mesh.surface import Surface, usable
from inertia.records import dataclass

_WIRE = Remedy("analyse", "wire", "AREA")


class _Faces(NamedTuple):
    """The corners of all cells, and the faces of the volume cells.

    Rows, `corners` (number of cells, 8) and `faces` (f, 4), hold ascending node numbers after as many −1 as fill them
    up, so that cells and faces with the same corners have equal rows. The row of a cell without volume is all −1.
    `owner` (f,) is the cell of each face, `turn` (f,) the sense in which its corners run around it, 1 or −1, or 0 where
    a corner is repeated. `area` says which faces of the cells, kind's face by kind's face, these are: the others
    are lines.
    """

    corners: Int
    faces: Int
    owner: Int
    turn: NDArray[np.int8]
    area: Bool


@dataclass(frozen=True, eq=False)
class CellTopology:
    """A mesh of cells, and how it hangs together.

    >>> from inertia.mesh.part import CellBlock
    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    >>> CellTopology(Cells(points, (CellBlock("tetra", np.array([[0, 1, 2, 3], [1, 2, 3, 4]])),))).bodies
    array([0, 0])
    """

    cells: Cells
    unit: str = ""

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
        owner = self._volume_cells.owner
        first = components(np.column_stack([owner, owner[self._first]]), self.cells.count)
        solid = np.zeros(self.cells.count, bool)
        solid[owner] = True
        leads = solid & (first == np.arange(len(first)))
        return np.where(solid, (np.cumsum(leads) - 1)[first], -1)

    @cached_property
    def _volume_cells(self) -> _Faces:
        corners = np.full((self.cells.count, 8), -1)
        rows, owners, turns = [np.empty((0, 4), np.int64)], [np.empty(0, np.int64)], [np.empty(0, np.int8)]
        for start, block in known_volume_blocks(self.cells):
            kind = KINDS[block.kind]
            owner = np.arange(start, start + len(block.nodes))
            nodes = self.merged[block.nodes[:, : kind.corners]]
            corners[owner, : kind.corners] = nodes
            for face_kind, face in kind.faces:
                own = nodes[:, face[: KINDS[face_kind].corners]]
                row = np.full((len(nodes), 4), -1)
                row[:, : own.shape[1]] = own
                rows.append(_distinct(row))
                owners.append(owner)
                turns.append(np.where(rows[-1][:, 4 - own.shape[1]] < 0, 0, _turns(own)))
        faces, owner = np.concatenate(rows), np.concatenate(owners)
        area = faces[:, 1] >= 0  # a face of a collapsed cell may be a line
        return _Faces(_distinct(corners), faces[area], owner[area], np.concatenate(turns)[area], area)

    @cached_property
    def _first(self) -> Int:
        """For each face of the volume cells the first with the same corners."""
        return first_equal(self._volume_cells.faces)

    @cached_property
    def _uses(self) -> Int:
        """How many cells have each face, counted at the first of them."""
        return np.bincount(self._first, minlength=len(self._first))

    @cached_property
    def jacobians(self) -> Jacobians:
        """The signs of the cells' Jacobian determinants."""
        return jacobians(self.cells)

    @cached_property
    def boundary(self) -> tuple[Surface, Int]:
        """The faces that only one volume cell has, as flat triangles between their nodes facing outward.

        Returns the triangles, and the cell of each.
        """
        volume = self._volume_cells
        single = np.zeros(len(volume.area), bool)
        single[volume.area] = self._uses[self._first] == 1
        triangles, owners, at = [np.empty((0, 3), np.int64)], [np.empty(0, np.int64)], 0
        for start, block in known_volume_blocks(self.cells):
            for face_kind, face in KINDS[block.kind].faces:
                which = np.flatnonzero(single[at : at + len(block.nodes)])
                at += len(block.nodes)
                pattern = FLAT_TRIANGLES[face_kind]
                corners = self.merged[block.nodes[which][:, face]][:, pattern]
                inverted = self.jacobians.sign[start + which] < 0
                corners[inverted] = corners[inverted][:, :, ::-1]
                triangles.append(corners.reshape(-1, 3))
                owners.append(np.repeat(start + which, len(pattern)))
        faces, owner = np.concatenate(triangles), np.concatenate(owners)
        whole = ~repeated_corners(faces)
        return Surface(self.cells.points, faces[whole]), owner[whole]

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

    def no_volume_cells(self) -> Evidence | None:
        """Tell lines and points that stand alone."""
        kinds = {block.kind for block in self.cells.blocks}
        if not kinds <= {"line", "line3", "vertex"}:
            return None
        advice = () if kinds == {"vertex"} else ("use ", _WIRE, " for lines, or ")
        return Evidence(self.cells.count, listed(np.arange(self.cells.count)), self._middle(self.used), advice=advice)

    def duplicates(self) -> Evidence | None:
        """Find cells that repeat an earlier one."""
        corners = self._volume_cells.corners
        again = first_equal(corners) != np.arange(len(corners))
        which = np.flatnonzero(again & (corners[:, -1] >= 0))
        if len(which) == 0:
            return None
        return Evidence(len(which), listed(which), self._middle(corners[which[0]]))

    def repeated_lines(self) -> Evidence | None:
        """Find lines that repeat an earlier one, whichever way they run."""
        rows = np.full((self.cells.count, 3), -1)
        for start, block in numbered_blocks(self.cells):
            if block.kind in ("line", "line3"):
                own = np.arange(start, start + len(block.nodes))
                nodes = self.merged[block.nodes]
                rows[own, :2], rows[own, 2:] = np.sort(nodes[:, :2], axis=1), nodes[:, 2:] if nodes.shape[1] > 2 else -1
        which = np.flatnonzero((first_equal(rows) != np.arange(len(rows))) & (rows[:, 0] >= 0))
        return Evidence(len(which), listed(which), self._middle(rows[which[0], :2])) if len(which) else None

    def overlaps(self) -> Evidence | None:
        """Find faces of more than two cells."""
        volume = self._volume_cells
        crowded = np.flatnonzero(self._uses > 2)
        if len(crowded) == 0:
            return None
        owner = volume.owner[np.isin(self._first, crowded)]
        return Evidence(len(crowded), listed(owner), self._middle(volume.faces[crowded[0]]))

    def tangled(self) -> Evidence | None:
        """Find cells whose Jacobian determinant has both signs."""
        return self._in_state(TANGLED)

    def without_volume(self) -> Evidence | None:
        """Find volume cells whose Jacobian determinant is zero."""
        return self._in_state(0)

    def _in_state(self, sign: int) -> Evidence | None:
        which = np.flatnonzero((self.jacobians.sign == sign) & (self._volume_cells.corners[:, -1] >= 0))
        if len(which) == 0:
            return None
        start, block = next(
            (start, block) for start, block in numbered_blocks(self.cells) if which[0] < start + len(block.nodes)
        )
        nodes = block.nodes[which[0] - start]
        figures = {
            "cell": f"cell {which[0]} ({block.kind}, nodes {' '.join(map(str, nodes.tolist()))})",
            "share": self.jacobians.share[which[0]],
            "others": f", and {counted(len(which) - 1, 'further cell')} like it" if len(which) > 1 else "",
        }
        return Evidence(len(which), listed(which), self._middle(nodes), figures)

    def folds(self) -> Evidence | None:
        """Find faces with both their cells on one side."""
        volume = self._volume_cells
        turn = volume.turn * self.jacobians.sign[volume.owner]
        both = np.bincount(self._first, weights=turn, minlength=len(turn))
        folded = np.flatnonzero((self._uses == 2) & (np.abs(both) == 2))
        if len(folded) == 0:
            return None
        pair = np.flatnonzero(self._first == folded[0])
        figures = dict(zip(("one", "other"), volume.owner[pair].tolist(), strict=True))
        owner = np.unique(volume.owner[np.isin(self._first, folded)])
        return Evidence(len(folded), listed(owner), self._middle(volume.faces[folded[0]]), figures)

    def several_bodies(self) -> Evidence | None:
        """Count the bodies, and give the first cell of each."""
        count = int(self.bodies.max()) + 1
        first = np.searchsorted(np.maximum.accumulate(self.bodies), np.arange(count))
        return Evidence(count, listed(first)) if count > 1 else None

    def unused(self) -> Evidence | None:
        """Count the nodes that no cell uses."""
        count = len(self.cells.points) - len(self.used)
        return Evidence(count) if count else None


def _turns(corners: Int) -> NDArray[np.int8]:
    """Return in which sense faces run around, 1 or −1, so that they have the other the other way round."""
    count = corners.shape[1]
    lowest = corners.argmin(axis=1)[:, None]
    after, before = (np.take_along_axis(corners, (lowest + step) % count, axis=1)[:, 0] for step in (1, count - 1))
    turns: NDArray[np.int8] = np.where(after < before, 1, -1).astype(np.int8)
    return turns


def _distinct(rows: Int) -> Int:
    """Sort each row, after every number that is repeated in it has become −1."""
    rows = np.sort(rows, axis=1)
    rows[:, 1:][rows[:, 1:] == rows[:, :-1]] = -1
    return np.sort(rows, axis=1)
