"""A part drawn on axes of matplotlib: its surface, or the outside, the lines and the points of a mesh of cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inertia.mesh.checks.cells import CellTopology
from inertia.mesh.part import DRAWN, Cells, Part
from inertia.plotting import draw_lines, draw_triangles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ALONG = {"line": [0, 1], "line3": [0, 2, 1], "vertex": [0]}
"""The nodes of each kind of cell without faces, in their order along it."""


def draw_part(axes: Axes, part: Part, scale: float, *, opacity: float) -> None:
    """Draw a part, its coordinates times `scale`, the nearest triangles last."""
    if not isinstance(part.geometry, Cells):
        draw_triangles(axes, scale * part.geometry.sample(DRAWN), opacity=opacity)
        return
    cells = part.geometry
    outside, _ = CellTopology(cells).boundary
    if outside.count:
        draw_triangles(axes, scale * outside.sample(DRAWN), opacity=opacity)
    for block in cells.blocks:
        if block.kind in _ALONG:
            some = block.nodes[:: max(1, len(block.nodes) // DRAWN)]
            draw_lines(axes, scale * cells.points[some[:, _ALONG[block.kind]]], opacity=opacity)
