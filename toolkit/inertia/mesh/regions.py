"""One named region of a part as a part of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inertia.arrays import Bool
from inertia.errors import UsageError
from inertia.mesh.part import CellBlock, Cells, Part


def region_of(part: Part, name: str) -> Part:
    """Return what a part has under a name; raise `UsageError` where it has no region of that name."""
    names = () if part.regions is None else part.regions.names
    if part.regions is None or name not in names:
        there = f"it has {', '.join(map(repr, names))}" if names else "it names none: leave region out"
        raise UsageError(f"{part.name} has no region {name!r}: {there}", code="unknown_region")
    elements = part.regions.index == names.index(name)
    if isinstance(part.geometry, Cells):
        return replace(part, geometry=_cells(part.geometry, elements), regions=None)
    triangles = np.flatnonzero(elements)
    chord = None if part.chord is None else part.chord[triangles]
    shape = part.shape
    if shape is not None:
        own = tuple(solid for solid in shape.solids if solid.name == name)
        shape = replace(shape, solids=own) if own else None
    return replace(part, geometry=part.triangles.select(triangles), regions=None, chord=chord, shape=shape)


def _cells(cells: Cells, elements: Bool) -> Cells:
    ends = np.cumsum([len(block.nodes) for block in cells.blocks])[:-1]
    own = zip(cells.blocks, np.split(elements, ends), strict=True)
    return Cells(cells.points, tuple(CellBlock(block.kind, block.nodes[which]) for block, which in own if which.any()))
