"""What the check of a surface is based on, measured once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from inertia.arrays import Bool, Float, Int
from inertia.mesh.checks.findings import Where, around, listed, middle
from inertia.mesh.geometry.closure import Closure, closure, merge_equal_vertices
from inertia.mesh.geometry.edges import Edges, Loop, Place, boundary_loops, pair_edges
from inertia.mesh.geometry.shells import Shell, shells
from inertia.mesh.part import Triangles


@dataclass(frozen=True, eq=False)
class Measured:
    """A surface with usable coordinates: welded, edges paired, shells nested if it bounds a volume."""

    triangles: Triangles
    unit: str
    vertices: Float
    faces: Int
    edges: Edges
    loops: tuple[Loop, ...]
    closure: Closure
    shells: tuple[Shell, ...]

    @property
    def closed(self) -> bool:
        """Whether every edge is used an even number of times."""
        return not (self.edges.uses % 2).any()

    @property
    def consistent(self) -> bool:
        """Whether every edge is used both ways equally often, as far as the number of its uses allows."""
        return bool((np.abs(self.edges.forward - self.edges.backward) == self.edges.uses % 2).all())

    @property
    def bounds(self) -> bool:
        """Whether the surface bounds a volume, of whatever sign."""
        return bool(self.edges.balanced.all())

    @cached_property
    def box(self) -> Float:
        """Least and greatest coordinates, (2, 3)."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    def around(self, place: Place) -> str:
        """Return a place in words."""
        return around(place, self.box)

    def at_edges(self, mask: Bool) -> Where:
        """Count the edges; give the triangles at the first of them and the middle of the first."""
        which = np.flatnonzero(mask)
        return Where(len(which), self.edges.triangles(which), middle(self.vertices[self.edges.ends[which[0]]]))

    def at_faces(self, which: Int) -> Where:
        """Count the triangles; give the first of them and the middle of the first."""
        return Where(len(which), listed(which), middle(self.vertices[self.faces[which[0]]]))

    def at_shells(self, which: Sequence[Shell]) -> Where:
        """Count the shells; give the triangles they begin with and the middle of the first."""
        return Where(len(which), listed(np.array([shell.first for shell in which])), middle(which[0].box))


def measure(triangles: Triangles, unit: str) -> Measured:
    """Weld a surface with usable coordinates, pair its edges, and nest its shells."""
    vertices, faces = merge_equal_vertices(triangles)
    edges = pair_edges(faces)
    found = closure(triangles)
    return Measured(
        triangles=triangles,
        unit=unit,
        vertices=vertices,
        faces=faces,
        edges=edges,
        loops=boundary_loops(vertices, edges),
        closure=found,
        shells=shells(triangles, found) if edges.balanced.all() else (),
    )
