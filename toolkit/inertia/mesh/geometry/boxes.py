"""Overlapping pairs of boxes: a tree of bounding boxes over a space-filling curve, descended pair by pair.

The boxes are put in Morton order and enclosed two by two, four by four, and so on. Pairs of enclosing boxes
that overlap are opened until single boxes remain. A large box burdens only those that enclose it, so sizes
may be as uneven as they like; pairs are opened a chunk at a time, so memory is bounded however many there
are.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int, distinct_pairs
from inertia.mesh.geometry.oriented_boxes import OrientedBoxes
from inertia.native import Kernel, address, place

_CHUNK = 1 << 16  # pairs of boxes opened at a time
_PAIR = Kernel("inertia.mesh.geometry.tree_kernel", "pair_trees", "ppi" * 2 + "pi" + "ii" + "pppi")
_WAITING = 512  # pairs that wait to be opened, as the kernel has it
_WORK = 4  # times what integrating a triangle costs, for a box, without the kernel
_LEAST = 1e-300  # size below which boxes stay in their order: that its inverse overflows must not matter
PATIENCE = 16
"""Pairs of boxes, over their number, that are opened before any along other axes are made."""

CELLS = 2**21 - 1
"""The last cell of a Morton code along an axis."""


class BoxTree:
    """Boxes, and those that enclose 2, 4, 8, ... of them.

    Parameters
    ----------
    low, high : (n, 3), least and greatest coordinates, finite; n ≥ 1
    group : (n,), groups that stand one after another in the order; boxes of one group are not paired among themselves
    corners : (n, 3, 3), triangles that the boxes are around, no coordinate larger than 1: where many boxes overlap,
        pairs are left out whose triangles are sure not to meet
    """

    def __init__(self, low: Float, high: Float, group: Int | None = None, corners: Float | None = None) -> None:
        code = _morton(low / 2 + high / 2)
        self.order: Int = np.argsort(code, kind="stable") if group is None else np.lexsort((code, group))
        self.group = None if group is None else group[self.order]
        self.corners = corners
        self.low = [np.ascontiguousarray(low[self.order].T)]
        self.high = [np.ascontiguousarray(high[self.order].T)]
        while self.low[-1].shape[1] > 1:
            pairs = np.arange(0, self.low[-1].shape[1], 2)
            self.low.append(np.minimum.reduceat(self.low[-1], pairs, axis=1))
            self.high.append(np.maximum.reduceat(self.high[-1], pairs, axis=1))

    @cached_property
    def oriented(self) -> OrientedBoxes | None:
        """Boxes around the same triangles along other axes; None where these are not known."""
        return None if self.corners is None else OrientedBoxes.around(self.corners[self.order])

    @cached_property
    def rows(self) -> tuple[Float, Int]:
        """Boxes (k, 6) level by level, least and greatest coordinates, and where those of each level start."""
        sizes = [low.shape[1] for low in self.low]
        boxes = np.empty((sum(sizes), 6))
        for column, levels in ((0, self.low), (3, self.high)):
            np.concatenate(levels, axis=1, out=boxes.T[column : column + 3])
        return boxes, np.cumsum([0, *sizes])

    def level(self, height: int) -> tuple[Float, Float]:
        """Return the boxes (3, k) that enclose 2**height of those given; above the root there is the root."""
        height = min(height, len(self.low) - 1)
        return self.low[height], self.high[height]


def overlapping(a: BoxTree, b: BoxTree | None = None, *, touching: bool = False) -> Iterator[tuple[Int, Int, float]]:
    """Yield the pairs of boxes of `a` and `b` that overlap, chunk by chunk.

    Parameters
    ----------
    b : None pairs the boxes of `a` among themselves, each pair once, the lower number first
    touching : count boxes that only touch; without it, a flat box overlaps one that it cuts, and no flat box
        in its own plane

    Yields
    ------
    i, j : (k,) numbers of boxes in `a` and in `b`; k may be 0
    done : fraction of the search that is done
    """
    other = a if b is None else b
    if a.corners is None and _PAIR.worthwhile(_WORK * (len(a.order) + len(other.order))):
        pairs = _compiled_pairs(a, other, b is None, touching)
    else:
        pairs = _vectorised_pairs(a, other, b is None, touching)
    for i, j, done in pairs:
        i, j = a.order[i], other.order[j]
        if b is None:
            i, j = np.minimum(i, j), np.maximum(i, j)
            i, j = i[i < j], j[i < j]
        yield i, j, done


def _compiled_pairs(a: BoxTree, b: BoxTree, among: bool, touching: bool) -> Iterator[tuple[Int, Int, float]]:
    """Yield the pairs of boxes that overlap, by their places in the order; `among` one tree, each pair once."""
    stack, done = np.zeros((_WAITING, 3), np.int64), np.zeros(1)
    stack[0, 0], stack[-1, 0] = max(len(a.low), len(b.low)) - 1, 1
    group = np.empty(0, np.int64) if a.group is None else np.ascontiguousarray(a.group, np.int64)
    trees = [part for tree in (a, b) for part in (*map(place, tree.rows), len(tree.low))]
    while stack[-1, 0]:
        pairs = np.empty((_CHUNK, 2), np.int64)
        count = _PAIR.function(
            *trees, place(group), len(group), among, touching, address(stack), address(done), address(pairs), _CHUNK
        )
        yield pairs[:count, 0], pairs[:count, 1], float(done[0])


def _vectorised_pairs(a: BoxTree, b: BoxTree, among: bool, touching: bool) -> Iterator[tuple[Int, Int, float]]:
    """Yield what `_compiled_pairs` does, in the same order, but for pairs of triangles that are sure not to meet."""
    below = np.less_equal if touching else np.less
    root = np.zeros(1, np.int64)
    todo = [(max(len(a.low), len(b.low)) - 1, root, root, 1.0)]
    done, patience = 0.0, PATIENCE * (len(a.order) + len(b.order))
    while todo:
        height, i, j, share = todo.pop()
        if len(i) > _CHUNK:
            half = len(i) // 2
            todo += [(height, i[half:], j[half:], share / 2), (height, i[:half], j[:half], share / 2)]
            continue
        (low_a, high_a), (low_b, high_b) = a.level(height), b.level(height)
        for axis in range(3):
            overlaps = below(low_a[axis, i], high_b[axis, j]) & below(low_b[axis, j], high_a[axis, i])
            i, j = i[overlaps], j[overlaps]
        if among and a.group is not None:
            mixed = a.group[i << height] < a.group[np.minimum((j + 1) << height, len(a.group)) - 1]
            i, j = i[mixed], j[mixed]
        patience -= len(i)
        if patience < 0 and a.oriented is not None and b.oriented is not None:
            meet = a.oriented.meeting(b.oriented, height, i, j)
            i, j = i[meet], j[meet]
        if height > 0 and len(i):
            todo.append((height - 1, *_children(i, j, a, b, height - 1, among), share))
            continue
        done += share
        yield i, j, done


def nested(boxes: Float, room: Float | None = None) -> Int:
    """Return the pairs (k, 2), ascending, of a box and another that it contains, but for the other's room (m,)."""
    low, high = np.ascontiguousarray(boxes[:, 0]), np.ascontiguousarray(boxes[:, 1])
    room = np.zeros(len(boxes)) if room is None else room
    pairs = [np.empty((0, 2), np.int64)]
    for i, j, _ in overlapping(BoxTree(low, high), touching=True):
        pairs += [np.column_stack(two)[within(low, high, two[1], two[0], room)] for two in ((i, j), (j, i))]
    return distinct_pairs(np.concatenate(pairs))


def within(low: Float, high: Float, inner: Int, outer: Int, room: Float) -> Bool:
    """Say which boxes lie within others, but for their room (equal ones do)."""
    more = room[inner, None]
    inside: Bool = np.all((low[outer] <= low[inner] + more) & (high[inner] <= high[outer] + more), axis=1)
    return inside


def _children(i: Int, j: Int, a: BoxTree, b: BoxTree, height: int, among: bool) -> tuple[Int, Int]:
    """Return the pairs of boxes one level below pairs of boxes; `among` one tree, each pair once."""
    i = (2 * i[:, None] + (0, 0, 1, 1)).ravel()
    j = (2 * j[:, None] + (0, 1, 0, 1)).ravel()
    exists = (i < a.level(height)[0].shape[1]) & (j < b.level(height)[0].shape[1])
    if among:
        exists &= i <= j
    return i[exists], j[exists]


def _morton(points: Float) -> NDArray[np.uint64]:
    """Return for points (n, 3) their place along a Z-order curve through their common box."""
    low = points.min(axis=0)
    extent = float((points.max(axis=0) - low).max())
    cells = (points - low) * (CELLS / extent if extent > _LEAST else 0.0)
    code = np.zeros(len(points), np.uint64)
    for axis, cell in enumerate(cells.T.astype(np.uint64)):
        # Spread the bits, two free places after each.
        for shift, mask in (
            (32, 0x1F00000000FFFF),
            (16, 0x1F0000FF0000FF),
            (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3),
            (2, 0x1249249249249249),
        ):
            cell = (cell | cell << np.uint64(shift)) & np.uint64(mask)
        code |= cell << np.uint64(axis)
    return code
