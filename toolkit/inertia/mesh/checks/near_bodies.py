"""Pairs of bodies that come near each other, and whether they only touch."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, partial
from typing import TypeVar

import numpy as np

from inertia.arrays import Bool, Float, Int, cut_by, distinct_pairs, runs_of
from inertia.mesh.checks.surface_topology import SurfaceTopology
from inertia.mesh.geometry.boxes import BoxTree, nested, overlapping
from inertia.mesh.geometry.contact_depth import contact_depths
from inertia.mesh.geometry.shells import Body, members
from inertia.mesh.geometry.winding import windings
from inertia.mesh.surface import Surface
from inertia.once import once
from inertia.records import dataclass

LARGE = 1 << 10
"""Triangles of a body that are looked for by a tree, among those of all bodies."""

_T = TypeVar("_T")
_AT_ONCE = 1 << 18  # triangles near other bodies that are compared at a time
_SAMPLES = 32  # triangles of a body, of which one may show that it does not lie in another
_KEPT = 4  # times that many, of which what was found is kept for another look: tens of megabytes


@dataclass(frozen=True, eq=False)
class Pair:
    """Two bodies that come near each other.

    Attributes
    ----------
    bodies : all of them, and the surface
    numbers : of these two
    inside_boxes : the triangles of each that reach into the other's box
    depth : how deep places lie that they share, at most, where a plane shows that they only touch; else infinity
    """

    bodies: _Bodies
    numbers: tuple[int, int]
    inside_boxes: tuple[Int, Int]
    depth: float

    @property
    def surface(self) -> Surface:
        """The surface, with every shell turned as its depth asks."""
        return self.bodies.surface

    @property
    def corners(self) -> Float:
        """The corners (n, 3, 3) of its triangles."""
        return self.bodies.corners

    @property
    def boxes(self) -> Float:
        """The boxes of both, (2, 2, 3)."""
        boxes: Float = self.bodies.boxes[list(self.numbers)]
        return boxes

    @property
    def groups(self) -> tuple[Int, Int]:
        """The triangles of both."""
        one, other = self.numbers
        return self.bodies.groups[one], self.bodies.groups[other]

    def in_columns(self, axes: Sequence[int]) -> tuple[Int, Int]:
        """Return the triangles of each that reach, along all axes but one of these, into the other's box.

        Those above and below it matter for winding numbers and volumes, what lies beside it does not.
        """
        one, other = self.numbers
        return self.bodies.in_columns(one, other, axes), self.bodies.in_columns(other, one, axes)


@dataclass(frozen=True, eq=False)
class _Bodies:
    """The bodies of a surface: this, turned, with the corners of its triangles; the triangles and the box of each."""

    surface: Surface
    corners: Float
    low: Float
    high: Float
    groups: list[Int]
    boxes: Float

    @classmethod
    def of(cls, surface: SurfaceTopology, parts: tuple[Body, ...], boxes: Float) -> _Bodies:
        """Measure the triangles."""
        triangles_of = members(surface.closure)
        groups = [np.concatenate([triangles_of[number] for number in body.shells]) for body in parts]
        corners = surface.turned.corners()
        return cls(surface.turned, corners, corners.min(axis=1), corners.max(axis=1), groups, boxes)

    def in_columns(self, one: int, other: int, axes: Sequence[int]) -> Int:
        """Return the triangles of a body that reach, along all axes but one of these, into the box of another."""
        own, (least, most) = self.groups[one], self.boxes[other]
        if len(own) > LARGE:
            every = self.boxes[one]
            along = [np.arange(3) == axis for axis in axes]
            low, high = (np.where(along, all_of_it, box) for all_of_it, box in zip(every, (least, most), strict=True))
            found = [triangle for triangle, _, _ in overlapping(self.tree, BoxTree(low, high), touching=True)]
            near = np.unique(np.concatenate(found))
            mine: Int = near[self.owner[near] == one]
            return mine
        x, y, z = ((self.low[own, k] <= most[k]) & (least[k] <= self.high[own, k]) for k in range(3))
        reach: Bool = np.logical_or.reduce([(y & z, z & x, x & y)[axis] for axis in axes])
        return own[reach]

    @cached_property
    def tree(self) -> BoxTree:
        """A tree of the boxes of all triangles."""
        return BoxTree(self.low, self.high)

    @cached_property
    def owner(self) -> Int:
        """The body of each triangle; −1 is none."""
        owner = np.full(len(self.low), -1)
        for number, group in enumerate(self.groups):
            owner[group] = number
        return owner

    def reaching(self, numbers: Int, room: Float) -> Iterator[tuple[Int, Int]]:
        """Yield triangles of each body of pairs (k, 2) that come as near the other's box as (k,).

        Yields
        ------
        side, triangle : (n,), 2 p for the first body of pair p, 2 p + 1 for the second
        """
        count = len(self.groups)
        both = np.stack([numbers, numbers[:, ::-1]], axis=1).reshape(-1, 2)
        keys = both[:, 0] * count + both[:, 1]
        order = np.argsort(keys)
        keys, which = keys[order], np.unique(numbers)
        most = np.zeros(count)
        np.maximum.at(most, numbers, room[:, None])
        low, high = (self.boxes[which, k] + sign * most[which, None] for k, sign in ((0, -1), (1, 1)))
        for triangle, body, _ in overlapping(self.tree, BoxTree(low, high), touching=True):
            key = self.owner[triangle] * count + which[body]
            at = np.minimum(np.searchsorted(keys, key), len(keys) - 1)
            asked = np.flatnonzero(keys[at] == key)
            side, triangle = order[at[asked]], triangle[asked]
            (least, largest), margin = self.boxes[both[side, 1]].transpose(1, 0, 2), room[side // 2, None]
            near = ((self.low[triangle] <= largest + margin) & (least <= self.high[triangle] + margin)).all(axis=1)
            yield side[near], triangle[near]

    def compared(self, numbers: Int, depths: Float) -> list[Pair]:
        """Compare pairs (k, 2) of bodies that touch where they share space no deeper than (k,)."""
        from inertia.mesh.geometry.contact_planes import touching_depths

        found = [(np.empty(0, np.int64),) * 2, *self.reaching(numbers, depths)]
        side, triangle = (np.concatenate(column) for column in zip(*found, strict=True))
        order = np.lexsort((triangle, side))
        side, triangle = side[order], triangle[order]
        least, most = self.boxes[numbers[:, ::-1].ravel()[side]].transpose(1, 0, 2)
        inside = ((self.low[triangle] <= most) & (least <= self.high[triangle])).all(axis=1)
        near, within = (
            _in_twos(cut_by(triangle[some], np.bincount(side[some], minlength=2 * len(numbers))))
            for some in (slice(None), inside)
        )
        deep = touching_depths(self.corners, near, depths)
        deep[self._may_lie_within(numbers, depths, np.flatnonzero(deep < np.inf))] = np.inf
        pairs = zip(numbers.tolist(), within, deep.tolist(), strict=True)
        return [Pair(self, (one, other), sides, depth) for (one, other), sides, depth in pairs]

    def _may_lie_within(self, numbers: Int, depths: Float, asked: Int) -> Int:
        """Return those of the pairs asked of which one body may lie in the other, where their surfaces do not meet.

        It does not where a place on it lies outside the other, deeper than twice what they may share. Moved by that,
        the surface meets the other's no more, and the place is still outside.
        """
        boxes, room = self.boxes[numbers[asked]], depths[asked, None, None]
        others = boxes[:, ::-1]
        held = (others[:, :, 0] <= boxes[:, :, 0] + room) & (boxes[:, :, 1] <= others[:, :, 1] + room)
        at, which = np.nonzero(held.all(axis=2))
        inner, outer, pair = numbers[asked[at], which], numbers[asked[at], 1 - which], asked[at]
        unclear = []
        for number in np.unique(outer).tolist():
            own = np.flatnonzero(outer == number)
            samples = [self.groups[k][:: len(self.groups[k]) // _SAMPLES + 1] for k in inner[own].tolist()]
            sizes = np.array([len(some) for some in samples])
            middle, exponent = self.boxes[number].mean(axis=0), np.frexp(np.ptp(self.boxes[number], axis=0).max())[1]
            points, corners = (
                np.ldexp(self.corners[some] - middle, -exponent)
                for some in (np.concatenate(samples), self.groups[number])
            )
            far = np.ldexp(2.0 * depths[pair[own]], -exponent)
            winding, clearance = windings(points.mean(axis=1), corners, float(far.max()))
            outside = (winding == 0) & (clearance >= np.repeat(far, sizes))
            unclear.append(pair[own[~np.logical_or.reduceat(outside, np.cumsum(sizes) - sizes)]])
        return np.concatenate([np.empty(0, np.int64), *unclear])


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
    bodies = once("bodies", surface, lambda: _Bodies.of(surface, parts, boxes))
    numbers = np.array(meeting, np.int64)
    depths = contact_depths(surface.vertices, boxes[numbers]) / 2
    reaching = np.zeros((len(numbers), 2), np.int64)
    for side, _ in bodies.reaching(numbers, depths):
        reaching += np.bincount(side, minlength=reaching.size).reshape(-1, 2)
    if pairs is None and not surface.separate:
        # Where no triangle of one comes near the other, they are apart or nested, which their shells show.
        close = reaching.all(axis=1)
        numbers, depths, reaching = numbers[close], depths[close], reaching[close]
    for k, run in enumerate(runs_of(reaching.sum(axis=1), _AT_ONCE)):
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


def meeting_boxes(boxes: Float) -> list[tuple[int, int]]:
    """Return the pairs of boxes (n, 2, 3) that overlap, ascending."""
    if len(boxes) < 2:
        return []
    tree = BoxTree(boxes[:, 0], boxes[:, 1])
    return sorted((int(i), int(j)) for ones, others, _ in overlapping(tree) for i, j in zip(ones, others, strict=True))
