"""The compiled kernels that put triangles into the leaves of a tree, by where they are in space; see `pairing`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

RUN = 64
"""Rows that lie together; see `scatter`."""

BLOCK = 32
"""Triangles that descend side by side: each has to wait at each node for what is read there."""

LEAF = np.int64(0xFFFFFFFF)
ALL = np.int64(7 << 32)


@njit(inline="always")
def leaf_of(points, at, axes, planes, depth):
    """Return the leaf of the point that begins at `at`."""
    node = np.int64(0)
    for _ in range(depth):
        node = 2 * node + 1 + np.int64(points[at + axes[node]] >= planes[node])
    return node + 1 - (1 << depth)


@njit(inline="always")
def within(points, at, cells, leaf):
    """Say whether the point that begins at `at` is in the cell of a leaf."""
    inside = True
    for axis in range(3):
        inside &= (points[at + axis] >= cells[leaf, axis]) & (points[at + axis] < cells[leaf, 3 + axis])
    return inside


def descend(points_at, count, axes_at, planes_at, cells_at, depth, leaves_at):
    """Write for each triangle (nine float32) its leaf of a tree of 2^depth of them, and which of its edges are there.

    Node k has its plane across axis `axes[k]` at `planes[k]`, and the nodes 2 k + 1 and 2 k + 2 below and above it;
    `cells` are the least and the greatest coordinates of the leaves. An edge is in the leaf that both its ends are in,
    if there is one, and a triangle in that of some edge of it: bits 32 to 34 say of which. So whatever triangles have
    an edge are all in its leaf.
    """
    points = carray(points_at, (9 * count,), np.float32)
    axes = carray(axes_at, (1 << depth,), np.int64)
    planes = carray(planes_at, (1 << depth,), np.float32)
    cells = carray(cells_at, (1 << depth, 6), np.float32)
    leaves = carray(leaves_at, (count,), np.int64)
    for first in range(0, count, BLOCK):
        last = min(first + BLOCK, count)
        low = high = points[9 * first], points[9 * first + 1], points[9 * first + 2]
        for at in range(9 * first + 3, 9 * last, 3):
            x, y, z = points[at], points[at + 1], points[at + 2]
            low = min(low[0], x), min(low[1], y), min(low[2], z)
            high = max(high[0], x), max(high[1], y), max(high[2], z)
        common, node = 0, np.int64(0)  # they descend as one while no plane parts them
        while common < depth:
            above = low[axes[node]] >= planes[node]
            if not above and high[axes[node]] >= planes[node]:
                break
            node = 2 * node + 1 + np.int64(above)
            common += 1
        leaves[first:last] = node
        for _ in range(common, depth):
            for k in range(first, last):
                node = leaves[k]
                leaves[k] = 2 * node + 1 + np.int64(points[9 * k + axes[node]] >= planes[node])
        for k in range(first, last):
            leaf = leaves[k] + 1 - (1 << depth)
            leaves[k] = leaf | ALL
            if common < depth and not (
                within(points, 9 * k + 3, cells, leaf) and within(points, 9 * k + 6, cells, leaf)
            ):
                second = leaf_of(points, 9 * k + 3, axes, planes, depth)
                third = leaf_of(points, 9 * k + 6, axes, planes, depth)
                edges = np.int64(leaf == second) | np.int64(second == third) << 1 | np.int64(third == leaf) << 2
                leaves[k] = (second if second == third else leaf) | edges << 32
    return 0


def scatter(rows_at, first, count, leaves_at, number, pool_at, runs, heads_at, owners_at, state_at):
    """Copy rows of three uint64, and after each 8 × its number (from `first`) + its edges, into runs of their leaves.

    A leaf takes the next free run of `RUN` rows of the pool, `state[0]`, whenever its last is full; `owners` says
    whose each run is, `heads` where in the pool the next row of each leaf goes (0 before its first).
    """
    rows = carray(rows_at, (count, 3), np.uint64)
    leaves = carray(leaves_at, (count,), np.int64)
    pool = carray(pool_at, (runs * RUN, 4), np.uint64)
    heads = carray(heads_at, (number,), np.int64)
    owners = carray(owners_at, (runs,), np.int64)
    state = carray(state_at, (1,), np.int64)
    for k in range(count):
        leaf = leaves[k] & LEAF
        place = heads[leaf]
        if place % RUN == 0:
            place = state[0] * RUN
            owners[state[0]] = leaf
            state[0] += 1
        pool[place, 0], pool[place, 1], pool[place, 2] = rows[k, 0], rows[k, 1], rows[k, 2]
        pool[place, 3] = (first + k) << 3 | leaves[k] >> 32
        heads[leaf] = place + 1
    return 0
