"""Topology of a triangle surface, for its check: equal vertices merged, edges paired, shells nested."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int
from inertia.mesh.checks.findings import Evidence, around, listed, middle
from inertia.mesh.geometry import edges, shells
from inertia.mesh.geometry.closure import Closure, closure
from inertia.mesh.geometry.contact_depth import contact_depth
from inertia.mesh.geometry.edges import Edges, Loop, Place
from inertia.mesh.geometry.faces import merge_equal_vertices
from inertia.mesh.geometry.shells import WOUND, Body, Shell
from inertia.mesh.geometry.sound_shells import sound_nesting
from inertia.mesh.part import Part
from inertia.mesh.surface import Surface, Triangles
from inertia.once import once
from inertia.records import dataclass

State = Literal["sheet", "sound", "inverted", "overlapping"]
_STATES: dict[tuple[str, int], State] = {
    ("outward", 0): "sound",
    ("inward", 1): "sound",
    ("inward", 0): "inverted",
    ("outward", -1): "inverted",
}
"""The state of a shell by its kind and the winding number around it; the inside of any other counts twice."""

_KEPT = 100_000  # triangles whose topology is kept for another look: tens of megabytes


@dataclass(frozen=True, eq=False)
class SurfaceTopology:
    """A surface with usable coordinates, and how it hangs together; `shells` is empty where it bounds no volume.

    Attributes
    ----------
    room : the volume that the fillings of its holes may be off by, or that may be in doubt, if that is more
    chord : (m,), how far the true surface may be from each triangle, where that is known
    separate : whether each body is taken by itself
    allowed : whether it is the caller who allows for the room
    """

    triangles: Triangles
    unit: str
    vertices: Float
    faces: Int
    edges: Edges
    closure: Closure
    shells: tuple[Shell, ...]
    room: float
    chord: Float | None
    separate: bool
    allowed: bool
    whole: ClassVar[bool] = True
    """Whether all triangles of the part are there; see `inertia.mesh.checks.edge_faults`."""

    @classmethod
    def of(cls, part: Part, *, separate: bool = False, room: float = 0.0) -> SurfaceTopology:
        """Merge equal vertices, pair the edges, and nest the shells."""
        triangles = part.triangles
        filled = part.filling.volume if part.filling else 0.0
        allowed, room = room > filled, max(room, filled)

        def topology() -> tuple[Float, Int, Edges, Closure, tuple[Shell, ...]]:
            vertices, faces = merge_equal_vertices(triangles)
            pairs, pieces = edges.pair_edges(faces), once("closure", triangles, lambda: closure(triangles))
            if not pairs.balanced.all():
                return vertices, faces, pairs, pieces, ()
            return vertices, faces, pairs, pieces, once("shells", triangles, lambda: shells.shells(triangles, pieces))

        def surface() -> SurfaceTopology:
            known = once("topology", triangles, topology) if triangles.count <= _KEPT else topology()
            return cls(triangles, part.unit.name, *known, room, part.chord, separate, allowed)

        return once(("surface", separate, room, allowed), part, surface) if triangles.count <= _KEPT else surface()

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

    @property
    def labels(self) -> NDArray[np.int32]:
        """The shell of each face, (m,)."""
        return self.closure.labels

    @cached_property
    def evidence(self) -> dict[Callable[[Any], Evidence | None], Evidence | None]:
        """The evidence that was looked for so far, by what looks for it."""
        return {}

    @cached_property
    def loops(self) -> tuple[Loop, ...]:
        """The rims of the holes, the longest first."""
        return edges.boundary_loops(self.vertices, self.edges)

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The bodies that the shells bound as they are wound."""
        return shells.bodies(self.shells)

    @cached_property
    def wrong_shells(self) -> list[int]:
        """The numbers of the shells that are not wound as their depth asks; none where bodies are separate."""
        return [] if self.separate else shells.absolute_orientation(self.shells).tolist()

    @cached_property
    def turned(self) -> Surface:
        """The triangles with every shell turned as its depth asks; as they are, where bodies are separate."""
        faces = self.faces.copy()
        wrong = np.isin(self.labels, self.wrong_shells)
        faces[wrong] = faces[wrong, ::-1]
        return Surface(self.vertices, faces)

    @cached_property
    def turned_bodies(self) -> tuple[Body, ...]:
        """The bodies that there are when every shell is turned as its depth asks; else those of their own."""
        if self.separate:
            return shells.bodies_apart(self.shells)
        return shells.bodies(
            [
                shell
                if shell.kind in ("sheet", WOUND[shell.depth % 2])
                else replace(shell, kind=WOUND[shell.depth % 2])
                for shell in self.shells
            ]
        )

    @cached_property
    def body_of(self) -> Int:
        """The number, among `turned_bodies`, of the body of each shell, −1 of sheets."""
        body_of = np.full(len(self.shells), -1)
        for body in self.turned_bodies:
            body_of[list(body.shells)] = body.number
        return body_of

    @cached_property
    def touching(self) -> Int | None:
        """The pairs (k, 2) of shells that may meet, ascending; None where that was not looked for.

        Those whose boxes share no volume, and those that meet at common corners and edges alone and share no space
        there, are not among them.
        """
        from inertia.mesh.geometry.touching import touching_bodies

        if len(self.shells) > shells.FEW and sound_nesting(self.triangles, self.closure) is not None:
            return np.empty((0, 2), np.int64)
        boxes, labels = np.array([shell.box for shell in self.shells]), self.closure.labels
        near = touching_bodies(self.triangles, labels, boxes)
        if near is None:
            return None
        one, other = boxes[near.T]
        meet = ((one[:, 0] < other[:, 1]) & (other[:, 0] < one[:, 1])).all(axis=1)
        pairs: Int = near[meet & (self.body_of[near] >= 0).all(axis=1)]
        if len(pairs) == 0:
            return pairs
        from inertia.mesh.geometry.corner_contacts import beyond_corners

        among = np.zeros(len(boxes), bool)
        among[pairs] = True
        which = np.flatnonzero(among[labels] & (labels >= 0))
        shell = labels[which].astype(np.int64)
        turned = np.isin(shell, self.wrong_shells)
        return beyond_corners(self.vertices, self.faces[which], shell, self.body_of[shell], turned, boxes, pairs)

    @cached_property
    def digits(self) -> float:
        """The depth of a contact of which the last digits of coordinates alone are the measure."""
        return contact_depth(self.vertices, 0.0)

    @cached_property
    def crowded(self) -> Int:
        """The triangles with an edge that more than two have, ascending."""
        return self.edges.at_crowded

    @cached_property
    def duplicates(self) -> tuple[Int, Int]:
        """The triangles that repeat an earlier one: wound the same way, and the opposite way.

        Where one of two bodies that touch is inside out, its triangles are wound as those that they touch: these are
        counted as if it were turned.
        """
        same, opposite = edges.duplicates(self.faces)
        inverted = np.isin(self.labels, [shell.number for shell in self.in_state("inverted")])
        if len(same) == 0 or not inverted.any():
            return same, opposite
        first = edges.first_equal(np.sort(self.faces, axis=1))
        twice = np.bincount(first, minlength=len(first))[first] == 2
        touching = same[twice[same] & (inverted[same] != inverted[first[same]])]
        # What has all of its triangles in common with another is a copy of it.
        both = np.sort(self.labels[np.stack([touching, first[touching]])], axis=0)
        pairs, which, common = np.unique(both, axis=1, return_inverse=True, return_counts=True)
        sizes = np.array([shell.triangles for shell in self.shells])
        touching = touching[(common < sizes[pairs].min(axis=0))[which.ravel()]]
        return np.setdiff1d(same, touching), np.union1d(opposite, touching)

    @property
    def outward(self) -> bool | None:
        """Whether all shells are wound rightly (True), all wrongly (False), or neither (None)."""
        states = {_state(shell) for shell in self.shells} - {"sheet"}
        if states == {"sound"}:
            return True
        return False if states == {"inverted"} else None

    def in_state(self, state: State) -> list[Shell]:
        """Return the shells in a state."""
        return [shell for shell in self.shells if _state(shell) == state]

    @cached_property
    def slivers(self) -> list[Shell]:
        """The sheets of some volume, more than rounding the whole's takes."""
        least = 2.0**-53 * sum(abs(shell.signed_volume) for shell in self.shells)
        return [shell for shell in self.shells if shell.kind == "sheet" and abs(shell.signed_volume) > least]

    @cached_property
    def box(self) -> Float:
        """Least and greatest coordinates, (2, 3)."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @property
    def count(self) -> int:
        """Number of triangles."""
        return len(self.faces)

    def cancels(self) -> bool:
        """Say whether it bounds no more than the rounding of its coordinates makes."""
        return shells.bounds_nothing(self.triangles, self.box)

    def around(self, place: Place) -> str:
        """Return a place in words."""
        return around(place, self.box)

    def as_numbered(self, evidence: Evidence) -> Evidence:
        """Return evidence whose triangles have their numbers in the part."""
        return evidence

    def at_edges(self, mask: Bool) -> Evidence | None:
        """Count the edges; give the triangles at the first of them and the middle of the first."""
        which = np.flatnonzero(mask)
        if len(which) == 0:
            return None
        return Evidence(len(which), self.edges.triangles(which), middle(self.vertices[self.edges.ends[which[0]]]))

    def at_faces(self, which: Int) -> Evidence | None:
        """Count the triangles; give the first of them and the middle of the first."""
        if len(which) == 0:
            return None
        return Evidence(len(which), listed(which), middle(self.vertices[self.faces[which[0]]]))

    def at_shells(self, which: Sequence[Shell], volumes: Iterable[float] = ()) -> Evidence | None:
        """Count the shells; give the triangles they begin with, the middle of the first and the sum of volumes."""
        if not which:
            return None
        first = listed(np.array([shell.first for shell in which]))
        return Evidence(len(which), first, middle(which[0].box), {"volume": sum(volumes), "unit": self.unit})


def _state(shell: Shell) -> State:
    if shell.kind == "sheet":
        return "sheet"
    return _STATES.get((shell.kind, shell.winding_outside), "overlapping")
