"""Evidence of volume cells that share space.

Where every cell's Jacobian determinant has one sign and the two cells at each inner face lie on either side of it, the
number of cells that cover a place is the winding number of the outside of the mesh around it: so cells share space only
where the outside crosses, touches or holds itself. Places there are tried, each cell that is near by its own map.
"""

from __future__ import annotations

import numpy as np

from inertia.arrays import Float, Int
from inertia.mesh.checks.cells import CellTopology
from inertia.mesh.checks.findings import Evidence, listed
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.cell_maps import covering
from inertia.mesh.geometry.cell_shapes import KINDS, known_volume_blocks
from inertia.mesh.geometry.doubled_places import places_of_doubt
from inertia.mesh.geometry.winding import misplaced_volume

_PLACES = 1 << 14  # at a time
_REACH = 1.5  # how far a cell of second order may be from the middle of its nodes, over their half extents


def shared_space(mesh: CellTopology) -> Evidence | None:
    """Find cells that share a place."""
    surface, _ = mesh.boundary
    if surface.count == 0:
        return None
    size = float(np.ptp(surface.corners(), axis=(0, 1)).max())
    tree, number = None, np.empty(0, np.int64)
    for places in places_of_doubt(surface, size):
        for start in range(0, len(places), _PLACES):
            if tree is None:  # which few meshes need
                low, high, number = _boxes(mesh)
                tree = BoxTree(low, high)
            some = places[start : start + _PLACES]
            met = [(i, j) for i, j, _ in overlapping(BoxTree(some, some), tree, touching=True)]
            pairs = np.column_stack([np.concatenate(column) for column in zip(*met, strict=True)])
            pairs[:, 1] = number[pairs[:, 1]]
            pairs = pairs[covering(mesh.cells, some, pairs)]
            twice = np.flatnonzero(np.bincount(pairs[:, 0]) > 1)
            if len(twice):
                cells = np.sort(pairs[pairs[:, 0] == twice[0], 1])
                x, y, z = some[twice[0]].tolist()
                return Evidence(len(cells), listed(cells), (x, y, z), _figures(mesh, cells))
    return None


def _boxes(mesh: CellTopology) -> tuple[Float, Float, Int]:
    """Return low and high corners of boxes around the volume cells, and the cells' numbers."""
    low, high, number = [], [], []
    for start, block in known_volume_blocks(mesh.cells):
        nodes = mesh.cells.points[block.nodes]
        least, most = nodes.min(axis=1), nodes.max(axis=1)
        more = 0.0 if block.nodes.shape[1] == KINDS[block.kind].corners else (_REACH - 1) / 2
        low.append(least - more * (most - least))
        high.append(most + more * (most - least))
        number.append(np.arange(start, start + len(block.nodes)))
    return np.concatenate(low), np.concatenate(high), np.concatenate(number)


def _figures(mesh: CellTopology, cells: Int) -> dict[str, object]:
    corners = mesh.boundary[0].corners()
    volume = misplaced_volume(corners, np.stack([corners.min(axis=(0, 1)), corners.max(axis=(0, 1))]))
    return {
        "cells": f"cells {' and '.join(map(str, cells.tolist()))}",
        "doubt": f": about {volume:.2g} {mesh.unit}³" if volume > 0 else "",
    }
