"""From blocks of finite elements to a `Part`'s geometry: the cells of the highest dimension are the part.

Surface or line cells that stand beside volume cells are their boundary, marked for loads and supports; they
weigh nothing and are left out. Shells and membranes without volume cells are a surface, whose cells become
flat triangles.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import ReadError
from inertia.mesh.geometry.cell_shapes import FLAT_TRIANGLES
from inertia.mesh.part import CellBlock, Cells, Regions
from inertia.mesh.readers.contents import (
    UNNAMED,
    Contents,
    around_notches,
    check_indices,
    fan,
    fan_note,
    first_bad_point,
    plural,
    shown,
    surface,
    was,
)

_NODES = {
    "vertex": 1, "line": 2, "line3": 3,
    "tetra": 4, "tetra10": 10, "hexahedron": 8, "hexahedron20": 20, "hexahedron24": 24, "hexahedron27": 27,
    "wedge": 6, "wedge15": 15, "wedge18": 18, "pyramid": 5, "pyramid13": 13, "pyramid14": 14,
}  # fmt: skip
"""Nodes of the kinds that `Cells` may hold, under meshio's names."""

_DIMENSIONS = {
    "vertex": 0, "poly-vertex": 0, "line": 1, "poly-line": 1,
    "triangle": 2, "triangle strip": 2, "quad": 2, "polygon": 2,
}  # fmt: skip

Block = tuple[str, Int, NDArray[np.int32] | None]
"""A kind, the nodes (m, k), and the region of each cell (None, for all blocks: the file has no regions)."""


def cell_contents(points: NDArray[Any], blocks: Sequence[Block], names: tuple[str, ...] = ()) -> Contents:
    """Return the part that blocks of cells over points (n, 2) or (n, 3) make; regions refer to `names`."""
    blocks = [block for block in blocks if len(block[1])]
    if not blocks:
        raise ReadError("it holds no cells: export the mesh again with its elements", code="empty")
    points = _points(points)
    dimensions = [dimension_of(kind) for kind, _, _ in blocks]
    highest = max(dimensions)
    lowest = highest if highest > 1 else 0  # wires and points go together
    part = [block for block, dimension in zip(blocks, dimensions, strict=True) if dimension >= lowest]
    beside = sum(len(nodes) for _, nodes, _ in blocks) - sum(len(nodes) for _, nodes, _ in part)
    notes = []
    if beside:
        what = "volume" if highest == 3 else "surface"
        notes.append(f"{plural(beside, 'cell')} of lower dimension beside the {what} cells {was(beside)} left out")
    for kind, nodes, _ in part:
        check_indices(nodes, len(points), f"{kind} cell")
    regions = _regions(part, names)
    if highest == 2:
        return _flat(points, part, regions, notes)
    for kind, nodes, _ in part:
        if nodes.shape[1:] != (_NODES.get(kind),):
            raise ReadError(
                f"its cells of the kind {shown(kind)} are not read: use cells of first or second order", code="not_read"
            )
    cells = Cells(points, tuple(CellBlock(kind, np.ascontiguousarray(nodes, np.int64)) for kind, nodes, _ in part))
    return Contents(cells, regions=regions, notes=tuple(notes))


def dimension_of(kind: str) -> int:
    """Return the dimension of a kind of cell, 3 for a kind that is not known."""
    stem = kind.rstrip("0123456789")
    return 1 if kind == "VTK_LAGRANGE_CURVE" else _DIMENSIONS.get(stem, 3)


def with_joint(contents: Contents, joint: Collection[str]) -> Contents:
    """Return contents with a note of the regions among `joint`, which hold what is in several groups of the file."""
    regions = contents.regions
    named = [name for name in (() if regions is None else regions.names) if name in joint]
    if not named:
        return contents
    first = shown(named[0], 80) + (f" and {len(named) - 1} more" if len(named) > 1 else "")
    note = f"cells in several groups at once are regions of their own, which need a density of their own: {first}"
    return replace(contents, notes=(*contents.notes, note))


def _points(points: NDArray[Any]) -> Float:
    if points.ndim != 2 or points.shape[1] not in (2, 3) or points.dtype.kind not in "fiu":
        raise ReadError(f"its points are an array of shape {points.shape}, not (n, 3): export the mesh again")
    flat = np.zeros((len(points), 3))
    flat[:, : points.shape[1]] = points
    bad = first_bad_point(flat)
    if bad is not None:
        says = f"point {bad} is {list(map(float, flat[bad]))}, which is not finite: export the mesh again"
        raise ReadError(says, code="non_finite")
    return flat


def _regions(blocks: Sequence[Block], names: tuple[str, ...]) -> Regions | None:
    """Return the regions that the cells in `blocks` are in; None where none is named."""
    regions = [region for _, _, region in blocks if region is not None]
    if not regions:
        return None
    used, index = np.unique(np.concatenate(regions), return_inverse=True)
    places: dict[str, int] = {}
    place = np.array([places.setdefault(names[i], len(places)) for i in used], np.int32)
    return None if [*places] == [UNNAMED] else Regions(tuple(places), place[index])


def _flat(points: Float, blocks: Sequence[Block], regions: Regions | None, notes: list[str]) -> Contents:
    faces, owners = [], []
    first = curved = split = notched = 0
    for kind, nodes, _ in blocks:
        if kind == "polygon":
            triangles, owner = fan(np.full(len(nodes), nodes.shape[1]), nodes.reshape(-1))
        else:
            pattern = np.array(FLAT_TRIANGLES.get(kind, [[-1] * 3]))
            if nodes.shape[1] <= pattern.max() or pattern.min() < 0:
                raise ReadError(
                    f"its cells of the kind {shown(kind)} are not read: use triangles or quadrilaterals",
                    code="not_read",
                )
            triangles = nodes[:, pattern].reshape(-1, 3)
            owner = np.repeat(np.arange(len(nodes)), len(pattern))
        if kind in ("quad", "polygon") and triangles.size and 0 <= triangles.min() <= triangles.max() < len(points):
            triangles, more = around_notches(points, triangles, owner)
            notched += more
        faces.append(triangles)
        owners.append(owner + first)
        first += len(nodes)
        curved += len(nodes) if kind[-1].isdigit() else 0
        split += len(nodes) if kind == "quad" or (kind == "polygon" and nodes.shape[1] > 3) else 0
    notes += fan_note(split, notched)
    if curved:
        notes.append(f"{plural(curved, 'second-order cell')} {was(curved)} split into flat triangles")
    whole = surface(points, np.concatenate(faces).astype(np.int64))
    if regions is not None:
        regions = Regions(regions.names, regions.index[np.concatenate(owners)])
    return Contents(whole, regions=regions, notes=tuple(notes))
