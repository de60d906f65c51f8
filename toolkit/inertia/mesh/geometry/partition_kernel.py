"""The compiled kernels that put rows of numbers into buckets: by where they are in space, and each with its like.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray

RUN = 64
"""Rows that lie together; see `scatter`."""

BLOCK = 64
"""Points that descend side by side: each has to wait at each node for what is read there."""


def descend(points_at, count, axes_at, planes_at, depth, leaves_at):
    """Write for each point (float32) the leaf of a tree of 2^depth of them that it falls into.

    Node k has its plane across axis `axes[k]` at `planes[k]`, and the nodes 2 k + 1 and 2 k + 2 below and above it.
    """
    points = carray(points_at, (3 * count,), np.float32)
    axes = carray(axes_at, (1 << depth,), np.int64)
    planes = carray(planes_at, (1 << depth,), np.float32)
    leaves = carray(leaves_at, (count,), np.int64)
    for first in range(0, count, BLOCK):
        last = min(first + BLOCK, count)
        leaves[first:last] = 0
        for _ in range(depth):
            for k in range(first, last):
                node = leaves[k]
                leaves[k] = 2 * node + 1 + np.int64(points[3 * k + axes[node]] >= planes[node])
        for k in range(first, last):
            leaves[k] += 1 - (1 << depth)
    return 0


def scatter(rows_at, width, first, count, buckets_at, number, pool_at, runs, heads_at, owners_at, state_at):
    """Copy rows of `width` uint64, and after each its number (from `first`), into the runs of their buckets.

    A bucket takes the next free run of `RUN` rows of the pool, `state[0]`, whenever its last is full; `owners` says
    whose each run is, `heads` where in the pool the next row of each bucket goes (0 before its first).
    """
    rows = carray(rows_at, (count, width), np.uint64)
    buckets = carray(buckets_at, (count,), np.int64)
    pool = carray(pool_at, (runs * RUN, width + 1), np.uint64)
    heads = carray(heads_at, (number,), np.int64)
    owners = carray(owners_at, (runs,), np.int64)
    state = carray(state_at, (1,), np.int64)
    for k in range(count):
        bucket = buckets[k]
        place = heads[bucket]
        if place % RUN == 0:
            place = state[0] * RUN
            owners[state[0]] = bucket
            state[0] += 1
        for column in range(width):
            pool[place, column] = rows[k, column]
        pool[place, width] = first + k
        heads[bucket] = place + 1
    return 0
