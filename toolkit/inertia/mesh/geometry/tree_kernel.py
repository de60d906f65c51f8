"""The compiled descent through two trees of boxes, pair by pair; see `boxes`, which does the same by numpy.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray

WAITING = 512
"""Pairs that wait to be opened, at most: three for each level, and one."""


def pair_trees(
    one_at, starts_at, levels, other_at, begins_at, heights, group_at, grouped, among, touching, stack_at, done_at,
    pairs_at, room,
):  # fmt: skip
    """Write pairs of boxes that overlap until there is no room for more, and return how many.

    A tree is the rows (k, 6) of its boxes and of those that enclose 2, 4, ... of them, least and greatest coordinates,
    and where those of each level start; the last level is one box. The pairs in the `stack` (height, i, j), of which
    there are as many as its last row says, are opened next, and `done` is the share that is done.
    """
    starts, begins = carray(starts_at, (levels + 1,), np.int64), carray(begins_at, (heights + 1,), np.int64)
    one, other = carray(one_at, (starts[levels], 6), np.float64), carray(other_at, (begins[heights], 6), np.float64)
    group = carray(group_at, (grouped,), np.int64)
    stack, done = carray(stack_at, (WAITING, 3), np.int64), carray(done_at, (1,), np.float64)
    pairs = carray(pairs_at, (room, 2), np.int64)
    waiting, written, share = stack[WAITING - 1, 0], 0, done[0]
    top = max(levels, heights) - 1
    while waiting > 0 and written < room:
        waiting -= 1
        height, i, j = stack[waiting, 0], stack[waiting, 1], stack[waiting, 2]
        a, b = starts[min(height, levels - 1)] + i, begins[min(height, heights - 1)] + j
        meet = True
        for axis in range(3):
            low, high, lower, higher = one[a, axis], one[a, axis + 3], other[b, axis], other[b, axis + 3]
            if touching:
                meet &= (low <= higher) & (lower <= high)
            else:
                meet &= (low < higher) & (lower < high)
        if meet and among and grouped > 0:
            meet = group[i << height] < group[min((j + 1) << height, grouped) - 1]
        if not meet or height == 0:
            share += 1.0 / (np.int64(1) << 2 * (top - height))
            if meet:
                pairs[written, 0], pairs[written, 1] = i, j
                written += 1
            continue
        below, under = min(height - 1, levels - 1), min(height - 1, heights - 1)
        many, more = starts[below + 1] - starts[below], begins[under + 1] - begins[under]
        for child in range(3, -1, -1):
            i_child, j_child = 2 * i + (child >> 1), 2 * j + (child & 1)
            if i_child < many and j_child < more and (i_child <= j_child or not among):
                stack[waiting, 0], stack[waiting, 1], stack[waiting, 2] = height - 1, i_child, j_child
                waiting += 1
            else:
                share += 0.25 / (np.int64(1) << 2 * (top - height))
    stack[WAITING - 1, 0], done[0] = waiting, share
    return written
