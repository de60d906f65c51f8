"""Which bodies of a surface come so near each other that their triangles may meet: all pairs of bodies at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from inertia.arrays import Bool, Float, Int, distinct_pairs
from inertia.mesh.geometry.boxes import BoxTree, overlapping
from inertia.mesh.geometry.common_cells import MOSTLY, Groups, in_common_cells
from inertia.mesh.geometry.intersect import CompiledTree
from inertia.mesh.surface import Triangles
from inertia.native import Kernel

FIND = Kernel("inertia.mesh.geometry.touching_kernel", "find_touching", "pppi" + "pi" + "pppp" + "ip")
PAIRS = 1 << 14  # pairs of triangles listed at a time
_WORK = 16  # times what integrating a triangle costs, about, where the boxes of two bodies meet


def touching_bodies(
    triangles: Triangles,
    labels: NDArray[np.integer[Any]],
    boxes: Float,
    *,
    among: Bool | None = None,
    few: bool = False,
) -> Int | None:
    """Return the pairs of bodies whose triangles may meet; those of other pairs are sure not to.

    Parameters
    ----------
    labels : (n,) the body of each triangle, −1 of those in none
    boxes : (m, 2, 3), least and greatest coordinates of the bodies, finite
    among : (m,), the bodies whose boxes meet others; None where that is not known
    few : whether to stop where there are more than some thousand

    Returns
    -------
    pairs : (k, 2), ascending, the lower number first; None where there is no kernel for it, or it was stopped
    """
    bodies = BoxTree(boxes[:, 0], boxes[:, 1])
    if among is None:
        among = np.zeros(len(boxes), bool)
        for i, j, _ in overlapping(bodies, touching=True):
            among[i] = among[j] = True
    within = among[labels] & (labels >= 0)
    which = np.flatnonzero(within)
    if len(which) == 0:
        return np.empty((0, 2), np.int64)
    rank = np.empty(len(boxes), np.int64)
    rank[bodies.order] = np.arange(len(boxes))
    own = triangles if within.all() else triangles.select(which)
    groups = Groups.of(labels[which].astype(np.int32), rank)
    pairs = touching_groups(own, groups, np.zeros(len(boxes), np.int64), stop=few)
    return None if pairs is None else distinct_pairs(np.sort(bodies.order[pairs], axis=1))


def touching_groups(
    triangles: Triangles,
    groups: Groups,
    family: Int,
    *,
    boxes: NDArray[np.float32] | None = None,
    stop: bool = False,
) -> Int | None:
    """Return the pairs (k, 2) of groups, of one family, whose triangles may meet; those of other pairs are sure not to.

    Parameters
    ----------
    groups : those of n triangles
    family : (m,) that of each group, ascending
    boxes : around each few triangles, as for `in_common_cells`
    stop : whether to stop where there are more than some thousand, and return None
    """
    if triangles.count == 0:
        return np.empty((0, 2), np.int64)
    if not FIND.worthwhile(_WORK * triangles.count):
        return None
    near = in_common_cells(triangles, groups, family, boxes)
    if near is not None and len(near) < MOSTLY * triangles.count:
        triangles, groups = triangles.select(near), groups.select(near)
        if len(near) == 0:
            return np.empty((0, 2), np.int64)
    each = groups.each()
    tree = CompiledTree.over(triangles, each)
    if tree is None:
        return None
    label = each[tree.order]
    axis, stack, state = np.zeros(3), np.zeros((256, 3), np.int64), np.array([1, 0])
    stack[0, 0] = tree.levels - 1
    pairs = np.empty((PAIRS, 2), np.int64)
    tables = [_address(table) for table in (tree.corners, tree.boxes, label)]
    tables += [len(label), _address(family), len(family)]
    tables += [_address(table) for table in (axis, stack, tree.starts, pairs)]
    results = [np.empty((0, 2), np.int64)]
    while state[0]:
        FIND.function(*tables, PAIRS, _address(state))
        if state[1]:
            results.append(distinct_pairs(np.sort(pairs[: state[1]], axis=1)))
        if stop and state[0]:
            return None
    return distinct_pairs(np.concatenate(results))


def _address(array: NDArray[Any]) -> int:
    return int(array.ctypes.data)
