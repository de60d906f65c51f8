"""A tree of planes that part triangles by where they are in space, by a sample of them; see `leaves`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int
from inertia.mesh.surface import Facets, Triangles
from inertia.records import dataclass

_READ, _EVERY = 512, 16  # triangles that are read together, and every so manieth of which is taken


def sample(triangles: Triangles, number: int) -> NDArray[np.float32]:
    """Return corners (number, 3) of triangles from all over the file, a few of each block that is read."""
    blocks = range(0, triangles.count, max(triangles.count * _READ // (_EVERY * number), _READ))
    corners = triangles.corners_f4 if isinstance(triangles, Facets) else triangles.corners
    with np.errstate(over="ignore", invalid="ignore"):
        some = np.concatenate([corners(at, at + _READ)[::_EVERY, 0].astype(np.float32) for at in blocks])
    return some[np.arange(number) * len(some) // number]


@dataclass(frozen=True, eq=False)
class Tree:
    """A tree of planes, each node of which parts space into two or four along an axis.

    Attributes
    ----------
    axes : (k,) of the nodes, level by level
    planes : (k, 4), ascending; not a number in place of those that a node does not have, which nothing is beyond
    cells : (leaves, 2, 4), the least and the greatest coordinates of the leaves
    shifts : (32,), the number of children of a node as a power of two, level by level; and of nodes, from 16 on
    levels : of nodes
    """

    axes: Int
    planes: NDArray[np.float32]
    cells: NDArray[np.float32]
    shifts: Int
    levels: int

    @property
    def depth(self) -> int:
        """The number of leaves as a power of two."""
        return len(self.cells).bit_length() - 1


def tree(points: NDArray[np.float32], depth: int) -> Tree:
    """Return the tree of 2^depth leaves that parts points (k 2^depth, 3) into equal shares, along the widest extent."""
    each = [2] * (depth // 2) + [1] * (depth % 2)
    axes, planes = [], []
    nodes, cells = points[None], np.full((1, 2, 4), [[[-np.inf], [np.inf]]], np.float32)
    for shift in each:
        children = 1 << shift
        with np.errstate(over="ignore", invalid="ignore"):
            widest = np.ptp(nodes, axis=1).argmax(axis=1)
        along = np.take_along_axis(nodes, widest[:, None, None], axis=2)[:, :, 0]
        cuts = along.shape[1] // children * np.arange(1, children)
        order = np.argpartition(along, cuts, axis=1)
        between = np.take_along_axis(along, order[:, cuts], axis=1)
        axes.append(widest)
        planes.append(np.pad(between, ((0, 0), (0, 4 - len(cuts))), constant_values=np.nan))
        nodes = np.take_along_axis(nodes, order[:, :, None], axis=1).reshape(children * len(nodes), -1, 3)
        cells, which = np.repeat(cells, children, axis=0), np.arange(len(widest)) * children
        for k in range(1, children):
            cells[which + k - 1, 1, widest] = cells[which + k, 0, widest] = between[:, k - 1]
    shifts = np.zeros(32, np.int64)
    shifts[: len(each)], shifts[16 : 16 + len(each)] = each, np.append(0, np.cumsum(each))[:-1]
    return Tree(np.concatenate(axes), np.ascontiguousarray(np.concatenate(planes)), cells, shifts, len(each))
