"""Triangles for display: about the centre of mass, in metres, and few enough for a viewer.

Where a part has more than `MOST` triangles, corners in one cell of a grid are merged into their mean, and triangles
that lose a side by it are left out. Results never come from these triangles.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from inertia.arrays import Float
from inertia.mass.cells.shapes import KINDS, volume_blocks
from inertia.mesh.geometry.closure import repeated_corners
from inertia.mesh.geometry.edges import first_equal
from inertia.mesh.part import Cells, Part, Surface, Triangles

MOST = 50_000
"""Triangles that are shown; merging aims at this number."""

_BLOCK = 1 << 18
_FINEST = 1 << 20  # cells along an edge of the part's box
_STRIDES = (1 << 42, 1 << 21, 1)  # a cell's number fits an integer


def shown_triangles(part: Part, center: Float, most: int = MOST) -> tuple[Float, int]:
    """Return the corners (k, 3, 3) in m about `center` (3,) m of what is shown, and how many triangles the part has.

    Of a mesh of cells it is the outside. Parts without faces (wires, points) have none.
    """
    triangles = outside(part.geometry) if isinstance(part.geometry, Cells) else part.geometry
    metres = float(part.unit.metres)

    def corners() -> Iterator[Float]:
        for start in range(0, triangles.count, _BLOCK):
            stop = min(start + _BLOCK, triangles.count)
            yield metres * (triangles.corners(start, stop) - center / metres)
            triangles.release(start, stop)

    if triangles.count <= most:
        return np.concatenate([np.empty((0, 3, 3)), *corners()]), triangles.count
    low, high, area = np.full(3, np.inf), np.full(3, -np.inf), 0.0
    for some in corners():
        low, high = np.minimum(low, some.min(axis=(0, 1))), np.maximum(high, some.max(axis=(0, 1)))
        area += 0.5 * float(np.linalg.norm(_normals(some), axis=1).sum())
    # A surface of area A crosses about 3A/2 of the squares of a grid, with two triangles in each.
    size = max(math.sqrt(3.0 * area / most), float((high - low).max()) / _FINEST)
    return _merged(corners(), low, size), triangles.count


def facet_normals(corners: Float) -> Float:
    """Return the unit normals (k, 3) of triangles (k, 3, 3); zero where a triangle has no area."""
    normals = _normals(corners)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: Float = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    return unit


def outside(cells: Cells) -> Triangles:
    """Return the faces that only one volume cell uses, as triangles over their corners."""
    welded = first_equal((cells.points + 0.0).view(np.int64))
    faces, keys = [np.empty((0, 4), np.int64)], [np.empty((0, 4), np.int64)]
    for _, block in volume_blocks(cells):
        for kind, nodes in KINDS[block.kind].faces:
            corners = block.nodes[:, nodes[: KINDS[kind].corners]]
            fourth = (0, 0), (0, 4 - corners.shape[1])  # of a triangle, the last again
            faces.append(np.pad(corners, fourth, mode="edge"))
            keys.append(np.pad(np.sort(welded[corners], axis=1), fourth, mode="edge"))
    first = first_equal(np.concatenate(keys))
    quads = np.concatenate(faces)[np.bincount(first, minlength=len(first))[first] == 1]
    halves = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Surface(cells.points, halves[halves[:, 1] != halves[:, 2]])


def _normals(corners: Float) -> Float:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _merged(blocks: Iterator[Float], low: Float, size: float) -> Float:
    """Return the triangles that are left when all corners in one cell of the grid become their mean."""
    found, sums, faces = [], [], []
    for corners in blocks:
        cells = ((corners.reshape(-1, 3) - low) / size).astype(np.int64)
        keys, place = np.unique(cells @ np.array(_STRIDES), return_inverse=True)
        count = np.bincount(place)
        added = [np.bincount(place, column) for column in corners.reshape(-1, 3).T]
        found.append(keys)
        sums.append(np.stack([*added, count], axis=1))
        triples = keys[place.reshape(-1, 3)]
        faces.append(triples[~repeated_corners(triples)])
    keys, place = np.unique(np.concatenate(found), return_inverse=True)
    total = np.stack([np.bincount(place, column) for column in np.concatenate(sums).T], axis=1)
    triples = np.searchsorted(keys, np.concatenate(faces))
    first = np.argmin(triples, axis=1)[:, None]
    distinct = np.unique(np.take_along_axis(triples, (first + np.arange(3)) % 3, axis=1), axis=0)
    means: Float = total[:, :3] / total[:, 3:]
    return means[distinct]
