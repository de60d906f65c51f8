"""A tree of planes that halves triangles by where they are in space, of a sample of them; see `leaves`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Int
from inertia.mesh.surface import Facets, Triangles

_READ, _EVERY = 512, 16  # triangles that are read together, and every so manieth of which is taken


def sample(triangles: Triangles, number: int) -> NDArray[np.float32]:
    """Return corners (number, 3) of triangles from all over the file, a few of each block that is read."""
    blocks = range(0, triangles.count, max(triangles.count * _READ // (_EVERY * number), _READ))
    corners = triangles.corners_f4 if isinstance(triangles, Facets) else triangles.corners
    with np.errstate(over="ignore", invalid="ignore"):
        some = np.concatenate([corners(at, at + _READ)[::_EVERY, 0].astype(np.float32) for at in blocks])
    return some[np.arange(number) * len(some) // number]


def tree(points: NDArray[np.float32], depth: int) -> tuple[Int, NDArray[np.float32], NDArray[np.float32]]:
    """Return axes and planes (2^depth,) that halve the points (k 2^depth, 3), and again their halves, along the widest.

    Node 0 comes first, and the nodes 2 k + 1 and 2 k + 2 below and above node k. The cells (2^depth, 6) of the leaves
    are their least and their greatest coordinates.
    """
    axes, planes = np.zeros(1 << depth, np.int64), np.zeros(1 << depth, np.float32)
    nodes, cells = points[None], np.array([[-np.inf] * 3 + [np.inf] * 3], np.float32)
    for level in range(depth):
        with np.errstate(over="ignore", invalid="ignore"):
            widest = np.ptp(nodes, axis=1).argmax(axis=1)
        along = np.take_along_axis(nodes, widest[:, None, None], axis=2)[:, :, 0]
        half = along.shape[1] // 2
        order = np.argpartition(along, half, axis=1)
        here = slice((1 << level) - 1, (2 << level) - 1)
        axes[here], planes[here] = widest, np.take_along_axis(along, order[:, half : half + 1], axis=1)[:, 0]
        nodes = np.take_along_axis(nodes, order[:, :, None], axis=1).reshape(2 << level, half, 3)
        cells = np.repeat(cells, 2, axis=0)
        cells[np.arange(0, 2 << level, 2), 3 + widest] = cells[np.arange(1, 2 << level, 2), widest] = planes[here]
    return axes, planes, cells
