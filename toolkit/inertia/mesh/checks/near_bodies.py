"""Pairs of bodies that come near each other, and whether they only touch."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

from inertia.arrays import Bool, Float, Int, cut_by, distinct_pairs, runs_of
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.geometry.boxes import BoxTree, nested, overlapping
from inertia.mesh.geometry.contact_depth import contact_depths
from inertia.mesh.geometry.shells import Body, members
from inertia.mesh.surface import Surface
from inertia.once import once

_T = TypeVar("_T")
_AT_ONCE = 1 << 18  # triangles compared with boxes of other bodies at a time
_KEPT = 4  # times that many, of which what was found is kept for another look: tens of megabytes


class Pair(NamedTuple):
    """Two bodies that come near each other.

    Attributes
    ----------
    surface : with every shell turned as its depth asks, and the `corners` (n, 3, 3) of its triangles
    groups : the triangles of both
    inside, beside : which of these reach into the other's box, and which into the column along z that it is in
    boxes : (2, 2, 3)
    depth : how deep places lie that they share, at most, where a plane shows that they only touch; else infinity
    """

    surface: Surface
    corners: Float
    groups: tuple[Int, Int]
    inside: tuple[Bool, Bool]
    beside: tuple[Bool, Bool]
    boxes: Float
    depth: float

    @property
    def inside_boxes(self) -> tuple[Int, Int]:
        """The triangles that reach into the other's box."""
        (one, other), (of_one, of_other) = self.groups, self.inside
        return one[of_one], other[of_other]

    @property
    def columns(self) -> tuple[Int, Int]:
        """Those above and below the other's box: they matter for winding numbers, what lies beside it does not."""
        (one, other), (of_one, of_other) = self.groups, self.beside
        return one[of_one], other[of_other]


class _Bodies(NamedTuple):
    """The bodies of a surface: this, turned, with the corners of its triangles; the triangles and the box of each."""

    surface: Surface
    corners: Float
    low: Float
    high: Float
    groups: list[Int]
    boxes: Float

    @property
    def sizes(self) -> Int:
        """How many triangles each has, (m,)."""
        return np.array([len(group) for group in self.groups])

    def compared(self, numbers: Int, depths: Float) -> list[Pair]:
        """Compare pairs (k, 2) of bodies that touch where they share space no deeper than (k,)."""
        from inertia.mesh.geometry.contact_planes import touching_depths

        boxes, room = self.boxes[numbers], depths[:, None, None]
        others = boxes[:, ::-1]
        inside = (others[:, :, 0] <= boxes[:, :, 0] + room) & (boxes[:, :, 1] <= others[:, :, 1] + room)
        nested = np.repeat(np.any(inside.all(axis=2), axis=1), 2)
        groups = [self.groups[number] for number in numbers.ravel().tolist()]
        which, count = np.concatenate(groups), self.sizes[numbers.ravel()]
        box, margin = (
            np.repeat(others.reshape(-1, 2, 3), count, axis=0),
            np.repeat(np.repeat(depths, 2), count)[:, None],
        )
        low, high = self.low[which], self.high[which]
        reach = (low <= box[:, 1]) & (box[:, 0] <= high)
        near = ((low <= box[:, 1] + margin) & (box[:, 0] <= high + margin)).all(axis=1)
        near |= np.repeat(nested, count)  # all, where one may lie in the other
        beside = reach[:, 0] & reach[:, 1]
        taken, *reaches = (_in_twos(cut_by(which, count)) for which in (near, beside & reach[:, 2], beside))
        both = _in_twos(groups)
        sides = [(a[of_a], b[of_b]) for (a, b), (of_a, of_b) in zip(both, taken, strict=True)]
        deep = touching_depths(self.corners, sides, depths).tolist()
        return [Pair(self.surface, self.corners, *each) for each in zip(both, *reaches, boxes, deep, strict=True)]


def _in_twos(items: Sequence[_T]) -> list[tuple[_T, _T]]:
    return list(zip(items[::2], items[1::2], strict=True))


def near_bodies(surface: SurfaceTopology, *, alike: bool) -> Iterator[list[Pair]]:
    """Yield pairs of bodies that come near each other, wound alike or not, several at a time."""
    parts = surface.turned_bodies
    boxes = np.array([surface.shells[body.shells[0]].box for body in parts])
    outward = [surface.shells[body.shells[0]].kind == "outward" for body in parts]
    pairs = _touching_bodies(surface, parts, boxes)
    meeting = meeting_boxes(boxes) if pairs is None else pairs
    meeting = [(one, other) for one, other in meeting if (outward[one] == outward[other]) == alike]
    if not meeting:
        return
    triangles_of = members(surface.closure)
    groups = [np.concatenate([triangles_of[number] for number in body.shells]) for body in parts]
    corners = surface.turned.corners()
    bodies = _Bodies(surface.turned, corners, corners.min(axis=1), corners.max(axis=1), groups, boxes)
    numbers = np.array(meeting, np.int64)
    if pairs is None and not surface.separate:
        # Where no triangle of one comes near the other, they are apart or nested, which their shells show.
        numbers = numbers[_reaching(numbers, bodies) & _reaching(numbers[:, ::-1], bodies)]
    depths = contact_depths(surface.vertices, boxes[numbers]) / 2
    for k, run in enumerate(runs_of(bodies.sizes[numbers].sum(axis=1), _AT_ONCE)):
        comparing = partial(bodies.compared, numbers[run], depths[run])
        yield once(("near", alike, k), surface, comparing) if k < _KEPT else comparing()


def _touching_bodies(surface: SurfaceTopology, parts: tuple[Body, ...], boxes: Float) -> list[tuple[int, int]] | None:
    """Return the pairs of bodies that may share space, ascending; None where that was not looked for.

    Where no triangles of two bodies meet, these are apart or one lies in the other: that is no fault where shells are
    turned as their depth asks, and where bodies are taken by themselves their boxes show it.
    """
    if len(parts) < 2 or surface.touching is None:
        return None
    body_of = surface.body_of
    pairs = np.sort(body_of[surface.touching], axis=1)
    pairs = pairs[(pairs[:, 0] >= 0) & (pairs[:, 0] < pairs[:, 1])]
    if surface.separate:
        inside = nested(boxes)
        pairs = np.concatenate([pairs, np.sort(inside, axis=1)])
    one, other = boxes[pairs.T]
    meet = ((one[:, 0] < other[:, 1]) & (other[:, 0] < one[:, 1])).all(axis=1)
    return [(one, other) for one, other in distinct_pairs(pairs[meet]).tolist()]


def _reaching(pairs: Int, bodies: _Bodies) -> Bool:
    """Say of which pairs (k, 2) of bodies a triangle of the first reaches into the box of the second."""
    sizes, reach = bodies.sizes[pairs[:, 0]], np.zeros(len(pairs), bool)
    for run in runs_of(sizes, _AT_ONCE):
        which = np.concatenate([bodies.groups[one] for one in pairs[run, 0].tolist()])
        box = np.repeat(bodies.boxes[pairs[run, 1]], sizes[run], axis=0)
        near = ((bodies.low[which] <= box[:, 1]) & (box[:, 0] <= bodies.high[which])).all(axis=1)
        reach[run] = np.logical_or.reduceat(near, np.cumsum(sizes[run]) - sizes[run])
    return reach


def meeting_boxes(boxes: Float) -> list[tuple[int, int]]:
    """Return the pairs of boxes (n, 2, 3) that overlap, ascending."""
    if len(boxes) < 2:
        return []
    tree = BoxTree(boxes[:, 0], boxes[:, 1])
    return sorted((int(i), int(j)) for ones, others, _ in overlapping(tree) for i, j in zip(ones, others, strict=True))
