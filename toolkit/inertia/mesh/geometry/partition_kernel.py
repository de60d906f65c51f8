"""The compiled kernels that put triangles into the leaves of a tree, by where they are in space; see `leaves`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import carray, njit, types, uint64
from numba.extending import intrinsic

from inertia.mesh.geometry.edge_kernel import SALTS, key_of, prefetch

RUN = 64
"""Rows that lie together; see `put`."""

BLOCK = 32
"""Triangles that descend as one while no plane parts them."""

BOX = 9 * BLOCK
"""Where the box of a block lies, behind the corners of its triangles: float32."""

ROOM = BOX // 2 + 4 + BLOCK
"""Words of 64 bits that hold a block: its corners, its box, its leaves."""

LEVELS = 16
"""At most, of the tree."""

RECORD, CORNERS, AHEAD = 50, 12, 4
"""Bytes of a binary STL record, and before its corners; rows after the last of a leaf that will be written."""

LEAF = np.uint64(0xFFFFFFFF)
ALL = np.uint64(7 << 32)
ONE, TWO, THREE, FOUR, SIX, NINE = (np.uint64(k) for k in (1, 2, 3, 4, 6, 9))

S8, S16, S20, S24, S32, S48 = (np.uint64(k) for k in (8, 16, 20, 24, 32, 48))


@intrinsic
def copy_corners(context, target, at, source, begin):
    """Copy nine float32 from `begin` bytes after `source` to `at` bytes after `target`, with −0 as +0."""

    def code(context, builder, signature, arguments):
        target, source = (builder.gep(arguments[k], [arguments[k + 1]]) for k in (0, 2))
        word = ir.IntType(32)
        for kind, offset in ((ir.VectorType(word, 8), 0), (word, 32)):
            here, there = (
                builder.bitcast(builder.gep(base, [ir.IntType(64)(offset)]), kind.as_pointer())
                for base in (target, source)
            )
            sign, zero = (ir.Constant(kind, k if kind == word else [k] * 8) for k in (1 << 31, 0))
            value = builder.load(there, align=2)
            builder.store(builder.select(builder.icmp_unsigned("==", value, sign), zero, value), here, align=4)
        return context.get_dummy_value()

    return types.void(types.voidptr, types.int64, types.voidptr, types.int64), code


def vector(builder, base, at, lanes):
    """Load float32 from `at` bytes after `base`."""
    kind = ir.FloatType() if lanes == 1 else ir.VectorType(ir.FloatType(), lanes)
    return builder.load(builder.bitcast(builder.gep(base, [at]), kind.as_pointer()), align=4)


def bits(builder, lanes):
    """Return four truth values as the bits of a number."""
    return builder.zext(builder.bitcast(lanes, ir.IntType(4)), ir.IntType(64))


@intrinsic
def above(context, points, at, planes, node):
    """Count the planes of a node, four float32, that a coordinate `at` bytes after `points` is not below."""

    def code(context, builder, signature, arguments):
        points, at, planes, node = arguments
        four, lane = ir.VectorType(ir.FloatType(), 4), ir.IntType(32)
        one = builder.insert_element(ir.Constant(four, ir.Undefined), vector(builder, points, at, 1), lane(0))
        each = builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(lane, 4), [0] * 4))
        those = vector(builder, planes, builder.mul(node, ir.IntType(64)(16)), 4)
        return builder.ctpop(bits(builder, builder.fcmp_ordered(">=", each, those)))

    return types.uint64(types.voidptr, types.uint64, types.voidptr, types.uint64), code


@intrinsic
def inside(context, points, at, cells, leaf):
    """Say whether the point `at` bytes after `points` is in the cell of a leaf, its least and then its greatest."""

    def code(context, builder, signature, arguments):
        points, at, cells, leaf = arguments
        point, cell = vector(builder, points, at, 4), builder.mul(leaf, ir.IntType(64)(32))
        least, greatest = (vector(builder, cells, builder.add(cell, ir.IntType(64)(by)), 4) for by in (0, 16))
        both = builder.and_(builder.fcmp_ordered(">=", point, least), builder.fcmp_ordered("<", point, greatest))
        three = builder.and_(bits(builder, both), ir.IntType(64)(7))
        return builder.icmp_unsigned("==", three, ir.IntType(64)(7))

    return types.boolean(types.voidptr, types.uint64, types.voidptr, types.uint64), code


@njit(inline="always")
def together(points, count, axis, plane):
    """Say whether a plane leaves some triangles on one side: in any order, they seldom all are."""
    beyond = parted = points[axis] >= plane
    for k in range(FOUR, count, FOUR):
        other = points[NINE * k + axis] >= plane
        beyond, parted = beyond & other, parted | other
    return beyond == parted


@njit(inline="always")
def shared(points, points_at, count, levels, shifts, axes, planes_at):
    """Return how many levels a block of triangles descends as one, the first node of the next, and the node there."""
    for axis in range(uint64(3)):  # the box, behind the triangles
        low = high = points[axis]
        for place in range(axis, NINE * count, THREE):
            low, high = min(low, points[place]), max(high, points[place])
        points[BOX + axis], points[BOX + THREE + axis] = low, high
    common, first, node = 0, uint64(0), uint64(0)
    while common < levels:
        at = BOX + axes[first + node]
        child = above(points_at, at << TWO, planes_at, first + node)
        if above(points_at, (at + THREE) << TWO, planes_at, first + node) != child:
            break
        first += ONE << shifts[LEVELS + uint64(common)]
        node = node << shifts[common] | child
        common += 1
    return common, first, node


@njit(inline="always")
def descend(points, points_at, count, levels, shifts, axes, planes, planes_at, cells_at, leaves):
    """Write for each triangle of a block its leaf of a tree, and which of its edges are there.

    Level l of the tree has nodes with 2^`shifts[l]` children each, between planes `planes[k]` across axis `axes[k]`;
    `cells` are the least and the greatest coordinates of the leaves. An edge is in the leaf that both its ends are in,
    if there is one, and a triangle in that of some edge of it: bits 32 to 34 say of which. So whatever triangles have
    an edge are all in its leaf.
    """
    common, begin, node = 0, uint64(0), uint64(0)
    if together(points, count, axes[0], planes[0]):
        common, begin, node = shared(points, points_at, count, levels, shifts, axes, planes_at)
    for k in range(count):
        leaves[k] = node
    first = begin
    for level in range(common, levels):  # side by side, as each step of one waits for the one before
        for k in range(count):
            at, here = NINE * k + axes[first + leaves[k]], first + leaves[k]
            leaves[k] = leaves[k] << shifts[level] | above(points_at, at << TWO, planes_at, here)
        first += ONE << shifts[LEVELS + uint64(level)]
    for k in range(count):
        leaf, at = leaves[k], NINE * k
        leaves[k] = leaf | ALL
        if common < levels and not (
            inside(points_at, (at + THREE) << TWO, cells_at, leaf)
            & inside(points_at, (at + SIX) << TWO, cells_at, leaf)
        ):
            first, second, third = begin, node, node
            for level in range(common, levels):
                b, c = first + second, first + third
                second = second << shifts[level] | above(points_at, (at + THREE + axes[b]) << TWO, planes_at, b)
                third = third << shifts[level] | above(points_at, (at + SIX + axes[c]) << TWO, planes_at, c)
                first += ONE << shifts[LEVELS + uint64(level)]
            edges = np.int64(leaf == second) | np.int64(second == third) << 1 | np.int64(third == leaf) << 2
            leaves[k] = (second if second == third else leaf) | uint64(edges) << S32


@njit(inline="always")
def put(u, v, w, leaf, pool_at, pool, heads, owners, state):
    """Pack the keys of three corners, of 60 bits each, into two words, in a run of their leaf.

    They are 40 bits of each, and the edges in the leaf. A leaf takes the next free run of `RUN` rows of the pool,
    `state[0]`, whenever its last is full; `owners` says whose each run is, `heads` where in the pool the next row of
    each leaf goes (0 before its first). Returns whether a corner is repeated.
    """
    place = heads[leaf & LEAF]
    if place % uint64(RUN) == 0:
        place = state[0] * uint64(RUN)
        owners[state[0]] = leaf & LEAF
        state[0] += ONE
    prefetch(pool_at, np.int64(place + uint64(AHEAD)) * 16)
    a, b, c = u >> S20, v >> S20, w >> S20
    pool[place, 0] = a << S24 | b >> S16
    pool[place, 1] = b << S48 | c << S8 | leaf >> S32
    heads[leaf & LEAF] = place + ONE
    return (u == v) | (v == w) | (w == u)


@njit(inline="always")
def corner_key(words, at, salt):
    """Return the 60-bit key of the corner whose coordinates begin at `at`."""
    return key_of(uint64(words[at]), uint64(words[at + ONE]), uint64(words[at + TWO]), salt)


@njit(inline="always")
def copy_points(faces, first, count, vertices, points):
    """Copy the corners of faces, rounded to float32."""
    for k in range(count):
        for column in range(9):
            points[9 * k + column] = np.float32(vertices[faces[first + k, column // 3], column % 3])


@njit(inline="always")
def opened(axes_at, planes_at, shifts_at, depth, room_at):
    """Return a tree's axes, planes and shifts, and the corners, their words and the leaves of a block."""
    leaves = carray(room_at, (ROOM,), np.uint64)[BOX // 2 + 4 :]
    points, words = carray(room_at, (2 * ROOM,), np.float32), carray(room_at, (2 * ROOM,), np.uint32)
    axes, planes = carray(axes_at, (1 << depth,), np.uint64), carray(planes_at, (4 << depth,), np.float32)
    return axes, planes, carray(shifts_at, (2 * LEVELS,), np.uint64), points, words, leaves


@njit(inline="always")
def pooled(pool_at, runs, heads_at, owners_at, state_at, depth):
    """Return the pool, the heads of the leaves, the owners of the runs, and the next free run."""
    pool, owners = carray(pool_at, (runs * RUN, 2), np.uint64), carray(owners_at, (runs,), np.uint64)
    return pool, carray(heads_at, (1 << depth,), np.uint64), owners, carray(state_at, (1,), np.uint64)


def place_facets(
    records_at,
    count,
    salt_at,
    axes_at,
    planes_at,
    cells_at,
    shifts_at,
    levels,
    depth,
    room_at,
    pool_at,
    runs,
    heads_at,
    owners_at,
    state_at,
):
    """Put binary STL records into the runs of their leaves; return how many have a repeated corner."""
    salt = carray(salt_at, (SALTS,), np.uint64)
    axes, planes, shifts, points, words, leaves = opened(axes_at, planes_at, shifts_at, depth, room_at)
    pool, heads, owners, state = pooled(pool_at, runs, heads_at, owners_at, state_at, depth)
    repeated = 0
    for first in range(0, count, BLOCK):
        number = min(BLOCK, count - first)
        for k in range(number):
            copy_corners(room_at, 36 * k, records_at, (first + k) * RECORD + CORNERS)
        descend(points, room_at, uint64(number), levels, shifts, axes, planes, planes_at, cells_at, leaves)
        for k in range(uint64(number)):
            at = NINE * k
            u, v, w = (
                corner_key(words, at, salt),
                corner_key(words, at + THREE, salt),
                corner_key(words, at + SIX, salt),
            )
            repeated += put(u, v, w, leaves[k], pool_at, pool, heads, owners, state)
    return repeated


def place_faces(
    faces_at,
    count,
    vertices_at,
    number_of_vertices,
    keys_at,
    axes_at,
    planes_at,
    cells_at,
    shifts_at,
    levels,
    depth,
    room_at,
    pool_at,
    runs,
    heads_at,
    owners_at,
    state_at,
):
    """Put faces over vertices into the runs of their leaves; return how many have a repeated corner."""
    faces = carray(faces_at, (count, 3), np.uint64)
    vertices = carray(vertices_at, (number_of_vertices, 3), np.float64)
    keys = carray(keys_at, (number_of_vertices,), np.uint64)
    axes, planes, shifts, points, _, leaves = opened(axes_at, planes_at, shifts_at, depth, room_at)
    pool, heads, owners, state = pooled(pool_at, runs, heads_at, owners_at, state_at, depth)
    repeated = 0
    for first in range(0, count, BLOCK):
        number = min(BLOCK, count - first)
        copy_points(faces, first, number, vertices, points)
        descend(points, room_at, uint64(number), levels, shifts, axes, planes, planes_at, cells_at, leaves)
        for k in range(number):
            u, v, w = keys[faces[first + k, 0]], keys[faces[first + k, 1]], keys[faces[first + k, 2]]
            repeated += put(u, v, w, leaves[k], pool_at, pool, heads, owners, state)
    return repeated


@njit(inline="always")
def fetch_labels(count, leaves, labels_at, heads, state, firsts, out, begin):
    """Write the labels of triangles, which lie where `put` has put their rows from run `state[0]` on.

    `firsts` is what the labels of each leaf count from; below 0 they stay as they are.
    """
    for k in range(count):
        leaf = leaves[k] & LEAF
        place = heads[leaf]
        if place % uint64(RUN) == 0:
            place = state[0] * uint64(RUN)
            state[0] += ONE
        label = carray(labels_at, (place + ONE,), np.int32)[place]
        out[begin + k] = label if label < 0 else label + firsts[leaf]
        heads[leaf] = place + ONE


def label_facets(
    records_at,
    count,
    axes_at,
    planes_at,
    cells_at,
    shifts_at,
    levels,
    depth,
    room_at,
    labels_at,
    heads_at,
    state_at,
    firsts_at,
    out_at,
):
    """Write the labels of binary STL records that `place_facets` has put into the leaves."""
    axes, planes, shifts, points, _, leaves = opened(axes_at, planes_at, shifts_at, depth, room_at)
    heads, state = carray(heads_at, (1 << depth,), np.uint64), carray(state_at, (1,), np.uint64)
    firsts, out = carray(firsts_at, (1 << depth,), np.int32), carray(out_at, (count,), np.int32)
    for first in range(0, count, BLOCK):
        number = min(BLOCK, count - first)
        for k in range(number):
            copy_corners(room_at, 36 * k, records_at, (first + k) * RECORD + CORNERS)
        descend(points, room_at, uint64(number), levels, shifts, axes, planes, planes_at, cells_at, leaves)
        fetch_labels(number, leaves, labels_at, heads, state, firsts, out, first)
    return 0


def label_faces(
    faces_at,
    count,
    vertices_at,
    number_of_vertices,
    axes_at,
    planes_at,
    cells_at,
    shifts_at,
    levels,
    depth,
    room_at,
    labels_at,
    heads_at,
    state_at,
    firsts_at,
    out_at,
):
    """Write the labels of faces that `place_faces` has put into the leaves."""
    faces = carray(faces_at, (count, 3), np.uint64)
    vertices = carray(vertices_at, (number_of_vertices, 3), np.float64)
    axes, planes, shifts, points, _, leaves = opened(axes_at, planes_at, shifts_at, depth, room_at)
    heads, state = carray(heads_at, (1 << depth,), np.uint64), carray(state_at, (1,), np.uint64)
    firsts, out = carray(firsts_at, (1 << depth,), np.int32), carray(out_at, (count,), np.int32)
    for first in range(0, count, BLOCK):
        number = min(BLOCK, count - first)
        copy_points(faces, first, number, vertices, points)
        descend(points, room_at, uint64(number), levels, shifts, axes, planes, planes_at, cells_at, leaves)
        fetch_labels(number, leaves, labels_at, heads, state, firsts, out, first)
    return 0
