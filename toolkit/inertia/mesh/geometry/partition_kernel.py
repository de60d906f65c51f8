"""The compiled kernels that put triangles into the leaves of a tree, by where they are in space; see `pairing`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit, uint64

RUN = 64
"""Rows that lie together; see `scatter`."""

BLOCK = np.uint64(32)
"""Triangles that descend as one while no plane parts them."""

LEAF = np.uint64(0xFFFFFFFF)
ALL = np.uint64(7 << 32)
ONE, TWO, THREE, FOUR, SIX, NINE = (np.uint64(k) for k in (1, 2, 3, 4, 6, 9))

S8, S16, S20, S24, S32, S48 = (np.uint64(k) for k in (8, 16, 20, 24, 32, 48))


@njit(inline="always")
def child(points, at, axes, planes, node):
    """Return the node that the point that begins at `at` is in, below or above that of a node."""
    return ONE + node + node + uint64(points[at + axes[node]] >= planes[node])


@njit(inline="always")
def along(axis, x, y, z):
    """Return the coordinate along an axis."""
    return x if axis == 0 else (y if axis == ONE else z)


@njit(inline="always")
def together(points, first, last, axis, plane):
    """Say whether a plane leaves some triangles `first:last` on one side: in any order, they seldom all are."""
    above = parted = points[NINE * first + axis] >= plane
    for k in range(first + FOUR, last, FOUR):
        other = points[NINE * k + axis] >= plane
        above, parted = above & other, parted | other
    return above == parted


@njit(inline="always")
def within(points, at, cells, leaf):
    """Say whether the point that begins at `at` is in the cell of a leaf."""
    x, y, z = points[at], points[at + ONE], points[at + TWO]
    return (
        (x >= cells[leaf, 0]) & (y >= cells[leaf, 1]) & (z >= cells[leaf, 2])
        & (x < cells[leaf, 3]) & (y < cells[leaf, 4]) & (z < cells[leaf, 5])
    )  # fmt: skip


def descend(points_at, count, axes_at, planes_at, cells_at, depth, leaves_at):
    """Write for each triangle (nine float32) its leaf of a tree of 2^depth of them, and which of its edges are there.

    Node k has its plane across axis `axes[k]` at `planes[k]`, and the nodes 2 k + 1 and 2 k + 2 below and above it;
    `cells` are the least and the greatest coordinates of the leaves. An edge is in the leaf that both its ends are in,
    if there is one, and a triangle in that of some edge of it: bits 32 to 34 say of which. So whatever triangles have
    an edge are all in its leaf.
    """
    points = carray(points_at, (9 * count,), np.float32)
    axes = carray(axes_at, (1 << depth,), np.uint64)
    planes = carray(planes_at, (1 << depth,), np.float32)
    cells = carray(cells_at, (1 << depth, 6), np.float32)
    leaves = carray(leaves_at, (count,), np.uint64)
    for first in range(uint64(0), uint64(count), BLOCK):
        last = min(first + BLOCK, uint64(count))
        common, node = 0, uint64(0)
        if together(points, first, last, axes[0], planes[0]):
            low_x = high_x = points[NINE * first]
            low_y = high_y = points[NINE * first + ONE]
            low_z = high_z = points[NINE * first + TWO]
            for place in range(NINE * first + THREE, NINE * last, THREE):
                x, y, z = points[place], points[place + ONE], points[place + TWO]
                low_x, low_y, low_z = min(low_x, x), min(low_y, y), min(low_z, z)
                high_x, high_y, high_z = max(high_x, x), max(high_y, y), max(high_z, z)
            while common < depth:
                above = along(axes[node], low_x, low_y, low_z) >= planes[node]
                if not above and along(axes[node], high_x, high_y, high_z) >= planes[node]:
                    break
                node = ONE + node + node + uint64(above)
                common += 1
        for k in range(first, last):
            leaves[k] = node
        for _ in range(common, depth):  # side by side, as each step of one waits for the one before
            for k in range(first, last):
                leaves[k] = child(points, NINE * k, axes, planes, leaves[k])
        for k in range(first, last):
            leaf = leaves[k] + ONE - uint64(1 << depth)
            leaves[k] = leaf | ALL
            at = NINE * k
            if common < depth and not (
                within(points, at + THREE, cells, leaf) and within(points, at + SIX, cells, leaf)
            ):
                own = np.int64(leaf)
                b = c = node
                for _ in range(common, depth):
                    b = child(points, at + THREE, axes, planes, b)
                    c = child(points, at + SIX, axes, planes, c)
                second, third = np.int64(b) + 1 - (1 << depth), np.int64(c) + 1 - (1 << depth)
                edges = np.int64(own == second) | np.int64(second == third) << 1 | np.int64(third == own) << 2
                leaves[k] = (second if second == third else own) | edges << 32
    return 0


def pack(rows_at, count, leaves_at, packed_at):
    """Pack the keys of three corners, of 60 bits each, into two words: 40 bits of each, and the edges in the leaf.

    It returns how many triangles have a repeated corner.
    """
    rows = carray(rows_at, (count, 3), np.uint64)
    leaves = carray(leaves_at, (count,), np.uint64)
    packed = carray(packed_at, (count, 2), np.uint64)
    repeated = 0
    for k in range(count):
        u, v, w = rows[k, 0], rows[k, 1], rows[k, 2]
        repeated += (u == v) | (v == w) | (w == u)
        u, v, w = u >> S20, v >> S20, w >> S20
        packed[k, 0] = u << S24 | v >> S16
        packed[k, 1] = v << S48 | w << S8 | leaves[k] >> S32
    return repeated


def scatter(rows_at, count, leaves_at, number, pool_at, runs, heads_at, owners_at, state_at):
    """Copy rows of two uint64 into runs of their leaves.

    A leaf takes the next free run of `RUN` rows of the pool, `state[0]`, whenever its last is full; `owners` says
    whose each run is, `heads` where in the pool the next row of each leaf goes (0 before its first).
    """
    rows = carray(rows_at, (count, 2), np.uint64)
    leaves = carray(leaves_at, (count,), np.uint64)
    pool = carray(pool_at, (runs * RUN, 2), np.uint64)
    heads = carray(heads_at, (number,), np.uint64)
    owners = carray(owners_at, (runs,), np.uint64)
    state = carray(state_at, (1,), np.uint64)
    for k in range(count):
        leaf = leaves[k] & LEAF
        place = heads[leaf]
        if place % uint64(RUN) == 0:
            place = state[0] * uint64(RUN)
            owners[state[0]] = leaf
            state[0] += ONE
        pool[place, 0], pool[place, 1] = rows[k, 0], rows[k, 1]
        heads[leaf] = place + ONE
    return 0


def gather_labels(labels_at, count, leaves_at, number, heads_at, state_at, firsts_at, out_at):
    """Write the labels of triangles, which lie where `scatter` has put their rows from run `state[0]` on.

    `firsts` is what the labels of each leaf count from; below 0 they stay as they are.
    """
    leaves = carray(leaves_at, (count,), np.uint64)
    heads = carray(heads_at, (number,), np.uint64)
    state = carray(state_at, (1,), np.uint64)
    firsts = carray(firsts_at, (number,), np.int32)
    out = carray(out_at, (count,), np.int32)
    for k in range(count):
        leaf = leaves[k] & LEAF
        place = heads[leaf]
        if place % uint64(RUN) == 0:
            place = state[0] * uint64(RUN)
            state[0] += ONE
        label = carray(labels_at, (place + ONE,), np.int32)[place]
        out[k] = label if label < 0 else label + firsts[leaf]
        heads[leaf] = place + ONE
    return 0
