"""Findings about the edges and triangles of a surface, one function for each kind."""

from __future__ import annotations

import numpy as np

from inertia.arrays import Int
from inertia.errors import REPAIR, SHELL, Sentence
from inertia.mesh.checks.findings import Finding, by_severity, counted, listed, usable
from inertia.mesh.checks.surface_topology import Measured
from inertia.mesh.geometry.closure import repeated_corners
from inertia.mesh.geometry.edges import duplicates, flat
from inertia.mesh.part import Surface, Triangles

_CHUNK = 1 << 16


def unusable(triangles: Triangles) -> Finding | None:
    """Find what leaves nothing to measure: no triangles, or coordinates that are not usable numbers."""
    if triangles.count == 0:
        return Finding("empty", "error", "there are no triangles: export the part again", 0)
    wrong = [
        ~usable(triangles.corners(start, start + _CHUNK)).all(axis=(1, 2))
        for start in range(0, triangles.count, _CHUNK)
    ]
    which = np.flatnonzero(np.concatenate(wrong))
    if len(which) == 0:
        return None
    text = (
        f"{counted(len(which), 'triangle')} with a coordinate that is no usable number (NaN, infinite or "
        f"beyond 1e75), the first being triangle {which[0]}: export the part again"
    )
    return Finding("non_finite", "error", text, len(which), listed(which))


def face_findings(surface: Measured) -> tuple[Finding, ...]:
    """Return what is wrong with edges and triangles, the most important first."""
    same, opposite = duplicates(surface.faces)
    return by_severity(
        [
            _open(surface),
            _inconsistent(surface),
            _stored_again(surface, same),
            _unpaired(surface),
            _facing(surface, opposite),
            _non_manifold(surface),
            _repeated_corners(surface),
            _flat(surface),
            _unused(surface.triangles),
        ]
    )


def _open(surface: Measured) -> Finding | None:
    if not surface.loops:
        return None
    longest, count = surface.loops[0], len(surface.loops)
    text = Sentence(
        f"open: {counted(count, 'boundary loop')}, {'the longest ' if count > 1 else ''}{longest.length:.4g} "
        f"{surface.unit} {surface.around(longest.place)} at triangle {longest.triangle}: close the mesh, or use ",
        SHELL,
        " or ",
        REPAIR,
    )
    first = listed(np.array([loop.triangle for loop in surface.loops]))
    return Finding("open", "error", text, count, first, longest.place)


def _inconsistent(surface: Measured) -> Finding | None:
    if not surface.edges.inconsistent.any():
        return None
    at = surface.at_edges(surface.edges.inconsistent)
    text = Sentence(
        f"inconsistent winding: the two triangles at {counted(at.number, 'edge')} run the same way, the "
        f"first being triangles {at.faces[0]} and {at.faces[1]} {surface.around(at.place)}: turn the wrong "
        "ones, or use ",
        REPAIR,
    )
    return Finding("inconsistent_winding", "error", text, *at)


def _stored_again(surface: Measured, which: Int) -> Finding | None:
    if len(which) == 0:
        return None
    at = surface.at_faces(which)
    text = Sentence(
        f"{counted(at.number, 'triangle')} stored again with the same winding, the first being triangle "
        f"{at.faces[0]} {surface.around(at.place)}: remove the copies, or use ",
        REPAIR,
    )
    return Finding("duplicate_face", "error", text, *at)


def _facing(surface: Measured, which: Int) -> Finding | None:
    if len(which) == 0:
        return None
    at = surface.at_faces(which)
    text = (
        f"{counted(at.number, 'triangle')} stored again with the opposite winding, the first being triangle "
        f"{at.faces[0]} {surface.around(at.place)}: look whether bodies should touch there or a wall has no "
        "thickness"
    )
    return Finding("duplicate_face", "warning", text, *at)


def _unpaired(surface: Measured) -> Finding | None:
    mask = surface.edges.non_manifold & ~surface.edges.balanced
    if not mask.any():
        return None
    at = surface.at_edges(mask)
    text = Sentence(
        f"three or more triangles that do not pair up share {counted(at.number, 'edge')}, the first "
        f"{surface.around(at.place)} at triangle {at.faces[0]}: remove inner walls and fins, or use ",
        REPAIR,
    )
    return Finding("non_manifold_edge", "error", text, *at)


def _non_manifold(surface: Measured) -> Finding | None:
    mask = surface.edges.non_manifold & surface.edges.balanced
    if not mask.any():
        return None
    at = surface.at_edges(mask)
    text = (
        f"four or more triangles share {counted(at.number, 'edge')}, the first {surface.around(at.place)} at "
        f"triangle {at.faces[0]}: the volume is not affected, but look whether bodies should touch there"
    )
    return Finding("non_manifold_edge", "warning", text, *at)


def _repeated_corners(surface: Measured) -> Finding | None:
    which = np.flatnonzero(repeated_corners(surface.faces))
    if len(which) == 0:
        return None
    at = surface.at_faces(which)
    text = Sentence(
        f"{counted(at.number, 'triangle')} with a repeated corner, the first being triangle {at.faces[0]} "
        f"{surface.around(at.place)}: the volume is not affected, and ",
        REPAIR,
        " removes them",
    )
    return Finding("degenerate_face", "warning", text, *at)


def _flat(surface: Measured) -> Finding | None:
    which = np.flatnonzero(flat(surface.vertices, surface.faces))
    if len(which) == 0:
        return None
    at = surface.at_faces(which)
    text = Sentence(
        f"{counted(at.number, 'triangle')} without area (the corners lie on a line), the first being "
        f"triangle {at.faces[0]} {surface.around(at.place)}: the volume is not affected, and ",
        REPAIR,
        " removes them",
    )
    return Finding("degenerate_face", "warning", text, *at)


def _unused(triangles: Triangles) -> Finding | None:
    if not isinstance(triangles, Surface):
        return None
    used = np.zeros(len(triangles.vertices), bool)
    used[triangles.faces] = True
    unused = np.flatnonzero(~used)
    if len(unused) == 0:
        return None
    count = counted(len(unused), "vertex", "vertices")
    text = f"{count} that no triangle uses, the first being vertex {unused[0]}"
    return Finding("unused_vertices", "note", text, len(unused))
