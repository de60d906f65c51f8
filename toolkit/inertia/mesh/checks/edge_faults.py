"""What is wrong with a surface, by its irregular edges and its shells alone: the findings of `inertia.mesh.check`.

So an open surface is refused at once, and one that is larger than the memory can be checked. What takes a search of the
whole surface, for triangles that cross and for bodies that share space, is not among them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Float, Int
from inertia.errors import REPAIR, SHELL, Sentence
from inertia.mesh.checks.crossings import crossing_cavities, cutters, overlap_at_edges, overlapping_bodies
from inertia.mesh.checks.findings import Evidence, Finding, around, counted, listed, middle
from inertia.mesh.checks.kinds import KINDS, findings
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.geometry.closure import Closure
from inertia.mesh.geometry.irregular_edges import Irregular, TooMany
from inertia.mesh.geometry.shells import Shell, bounds_nothing
from inertia.mesh.part import Part
from inertia.mesh.surface import Triangles
from inertia.records import dataclass

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
    part: Part,
    closure: Closure,
    irregular: Irregular | TooMany,
    shells: tuple[Shell, ...],
    extents: Float,
) -> Iterator[Finding]:
    """Yield the errors that irregular edges are, the most important first.

    Parameters
    ----------
    shells : of a closed surface; none of others
    extents : (2, 3), of the whole surface
    """
    if isinstance(irregular, Irregular):
        surface = _topology(part, irregular, closure, shells, extents)
        errors = (kind for kind in KINDS if kind.subject == "surface" and kind.severity == "error")
        yield from (finding for kind in errors if (finding := kind.finding(surface)))
    elif closure.open_edges:
        yield from _too_many(part, irregular, extents)


def _too_many(part: Part, edges: TooMany, extents: Float) -> Iterator[Finding]:
    """Yield what is known of irregular edges that are too many to be looked at."""
    place = middle(part.triangles.corners(edges.triangle, edges.triangle + 1)[0])
    first = f"the first triangle concerned is {edges.triangle} {around(place, extents)}"
    for code, count, says, remedies in (
        ("open", edges.once, "open: {} of one triangle alone", ("close the mesh, or use ", SHELL)),
        (
            "inconsistent_winding", edges.same_way, "inconsistent winding: the two triangles run the same way at {}",
            ("turn the wrong ones, or use ", REPAIR),
        ),
        (
            "non_manifold_edge", edges.crowded, "three or more triangles that do not all pair up share {}",
            ("remove inner walls and fins, or use ", REPAIR),
        ),
    ):  # fmt: skip
        if count:
            statement = f"{says.format(counted(count, 'edge'))}, too many to be looked at here; {first}"
            yield Finding(code, "error", Sentence(statement, ": ", *remedies), count, (edges.triangle,), place)


def shell_findings(
    part: Part, closure: Closure, irregular: Irregular, shells: tuple[Shell, ...], extents: Float
) -> Iterator[Finding]:
    """Yield what the shells of a closed surface tell without a search."""
    surface = _topology(part, irregular, closure, shells, extents)
    own = (kind for kind in KINDS if kind.subject == "shells" and kind.evidence not in _SEARCHES)
    nothing = [*findings("volume", surface)]
    yield from nothing or (finding for kind in own if (finding := kind.finding(surface)))


def _topology(
    part: Part, irregular: Irregular, closure: Closure, shells: tuple[Shell, ...], extents: Float
) -> _Irregular:
    return _Irregular(
        irregular.triangles, part.unit.name, irregular.vertices, irregular.faces, irregular.edges, closure, shells,
        room=0.0, chord=None, separate=False, allowed=False, numbers=irregular.numbers, extents=extents,
        surface=part.triangles,
    )  # fmt: skip
