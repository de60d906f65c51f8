"""What is wrong with a surface whose edges were paired in bounded memory: the findings of `inertia.mesh.check`.

They are made of the triangles at irregular edges and of the shells alone. What takes a search of the whole surface,
for triangles that cross and for bodies that share space, is not among them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import SHELL, Sentence
from inertia.mesh.checks.crossings import crossing_cavities, cutters, overlap_at_edges, overlapping_bodies
from inertia.mesh.checks.findings import Evidence, Finding, around, listed, middle
from inertia.mesh.checks.kinds import KINDS, findings
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.external.closure import Pairing
from inertia.mesh.geometry.irregular_edges import Irregular
from inertia.mesh.geometry.shells import Shell, bounds_nothing
from inertia.mesh.surface import Triangles

_SEARCHES = (crossing_cavities, cutters, overlap_at_edges, overlapping_bodies)


@dataclass(frozen=True, eq=False)
class _Irregular(SurfaceTopology):
    """The triangles of a surface that have irregular edges.

    Attributes
    ----------
    numbers : (m,), which they are in the whole surface
    extents : (2, 3), of the whole surface
    surface : the whole one
    """

    whole: ClassVar[bool] = False
    numbers: Int
    extents: Float
    surface: Triangles

    @property
    def box(self) -> Float:
        """Least and greatest coordinates of the whole surface, (2, 3)."""
        return self.extents

    @property
    def count(self) -> int:
        """Number of triangles of the whole surface."""
        return self.surface.count

    @property
    def labels(self) -> NDArray[np.int32]:
        """The shell of each face."""
        return self.closure.labels[self.numbers]

    def cancels(self) -> bool:
        """Say whether the whole surface bounds no more than rounding makes."""
        return bounds_nothing(self.surface, self.box)

    def at_faces(self, which: Int) -> Evidence | None:
        """Count the triangles; give the first of them and the middle of the first."""
        if len(which) == 0:
            return None
        return Evidence(len(which), listed(self.numbers[which]), middle(self.vertices[self.faces[which[0]]]))


def edge_faults(
    triangles: Triangles, pairing: Pairing, shells: tuple[Shell, ...], unit: str, extents: Float
) -> Iterator[Finding]:
    """Yield the errors that irregular edges are, the most important first."""
    if pairing.irregular is not None:
        surface = _topology(triangles, pairing.irregular, pairing, shells, unit, extents)
        errors = (kind for kind in KINDS if kind.subject == "surface" and kind.severity == "error")
        yield from (finding for kind in errors if (finding := kind.finding(surface)))
    elif pairing.closure.open_edges:
        assert pairing.triangle is not None
        place = middle(triangles.corners(pairing.triangle, pairing.triangle + 1)[0])
        statement = (
            f"open: {pairing.closure.open_edges} edges without an opposite partner, which are too many to be chained "
            f"in this memory, one of them {around(place, extents)} at triangle {pairing.triangle}"
        )
        message = Sentence(statement, ": close the mesh, or use ", SHELL)
        yield Finding("open", "error", message, pairing.closure.open_edges, (pairing.triangle,), place)


def shell_findings(
    triangles: Triangles, pairing: Pairing, shells: tuple[Shell, ...], unit: str, extents: Float
) -> Iterator[Finding]:
    """Yield what the shells of a closed surface tell without a search."""
    assert pairing.irregular is not None
    surface = _topology(triangles, pairing.irregular, pairing, shells, unit, extents)
    own = (kind for kind in KINDS if kind.subject == "shells" and kind.evidence not in _SEARCHES)
    nothing = [*findings("volume", surface)]
    yield from nothing or (finding for kind in own if (finding := kind.finding(surface)))


def _topology(
    triangles: Triangles,
    irregular: Irregular,
    pairing: Pairing,
    shells: tuple[Shell, ...],
    unit: str,
    extents: Float,
) -> _Irregular:
    return _Irregular(
        irregular.triangles, unit, irregular.vertices, irregular.faces, irregular.edges, pairing.closure, shells,
        room=0.0, chord=None, separate=False, allowed=False, numbers=irregular.numbers, extents=extents,
        surface=triangles,
    )  # fmt: skip
