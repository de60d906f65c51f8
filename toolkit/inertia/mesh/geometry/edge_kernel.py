"""The compiled kernels that pair the edges of triangles as they stream by; see `closure`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import carray, njit, types, uint64
from numba.extending import intrinsic

S29, S32, S33 = np.uint64(29), np.uint64(32), np.uint64(33)
LOW = np.uint64(0xFFFFFFFF)
ONE = np.uint64(1)
SIGN = np.uint64(0x80000000)
BIN = np.uint64(52)

VERTEX, EDGE = 7, 5
"""Salts of a sum over a vertex and over an edge: one alone, and one for each 32-bit word of three float64 (of three
float32, the first of them), or of two keys. A key is made of two sums."""

SALTS = 2 * (VERTEX + EDGE)

BLOCK = 64
"""Triangles whose edges' keys are computed together, which brings what the table has for them on its way."""

ENTRY = 16
"""Bytes of an entry of the table: the key of an edge that waits, its lowest bit 1, and 2 × its label + that bit."""

STRIDE_F4 = 25
"""Half-words (uint16) in a binary STL record; its corners begin at half-word 6."""


@njit(inline="always")
def word(halves, at):
    """Return the float32 pattern at half-word `at`, with −0 read as +0."""
    bits = uint64(halves[at]) | (uint64(halves[at + 1]) << np.uint64(16))
    if bits == SIGN:
        bits = np.uint64(0)
    return bits


@njit(inline="always")
def corner_key(halves, at, salt):
    """Return the 64-bit key of a stored corner."""
    x, y, z = word(halves, at), word(halves, at + 2), word(halves, at + 4)
    high = salt[0] + x * salt[1] + y * salt[2] + z * salt[3]
    low = salt[VERTEX] + x * salt[VERTEX + 1] + y * salt[VERTEX + 2] + z * salt[VERTEX + 3]
    return (high >> S32 << S32) | (low >> S32)


@intrinsic
def prefetch(context, base, offset):
    """Bring what lies `offset` bytes after `base` into the cache, to be written to."""

    def code(context, builder, signature, arguments):
        index = ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [arguments[0].type, index, index, index])
        function = builder.module.declare_intrinsic("llvm.prefetch", [arguments[0].type], kind)
        builder.call(function, [builder.gep(arguments[0], [arguments[1]]), index(1), index(3), index(1)])
        return context.get_dummy_value()

    return types.void(types.voidptr, types.int64), code


@njit(inline="always")
def edge_key(a, b, salt):
    """Return the key of the edge between two vertices, by theirs; the lowest bit says which way it runs."""
    way = uint64(a < b)
    a, b = min(a, b), max(a, b)
    a0, a1, b0, b1 = a & LOW, a >> S32, b & LOW, b >> S32
    k = 2 * VERTEX
    high = salt[k] + a0 * salt[k + 1] + a1 * salt[k + 2] + b0 * salt[k + 3] + b1 * salt[k + 4]
    k = 2 * VERTEX + EDGE
    low = salt[k] + a0 * salt[k + 1] + a1 * salt[k + 2] + b0 * salt[k + 3] + b1 * salt[k + 4]
    return (high >> S32 << S32) | (low >> S33 << ONE) | way


@njit(inline="always")
def find(parent, label):
    """Return the root of `label`, halving the path to it."""
    while parent[label] != label:
        parent[label] = parent[parent[label]]
        label = parent[label]
    return label


@njit(inline="always")
def home(key, mask):
    """Return the slot where the search for `key` begins."""
    return np.int64(key >> S29) & mask


@njit(inline="always")
def edge_keys(u, v, w, salt, edges, place, table_at, mask):
    """Write the keys of a triangle's edges, 0 where a corner is repeated, and send for what the table has for them."""
    if u == v or v == w or w == u:
        edges[place] = 0
        return
    edges[place], edges[place + 1], edges[place + 2] = edge_key(u, v, salt), edge_key(v, w, salt), edge_key(w, u, salt)
    for side in range(3):
        prefetch(table_at, home(edges[place + side], mask) * ENTRY)


@njit(inline="always")
def insert(table, mask, key, value):
    """Put an entry at its first free slot."""
    slot = home(key, mask)
    while table[slot, 0] != 0:
        slot = (slot + 1) & mask
    table[slot, 0] = key
    table[slot, 1] = value


@njit(inline="always")
def take(table, mask, key, sign):
    """Remove an entry of `key` with the opposite sign and return its label, or −1."""
    slot = home(key, mask)
    while table[slot, 0] != 0:
        if table[slot, 0] == key and (table[slot, 1] & ONE) != sign:
            label = np.int64(table[slot, 1] >> ONE)
            # Close the gap: move back every later entry that could not be found past an empty slot.
            hole = slot
            after = (slot + 1) & mask
            while table[after, 0] != 0:
                if ((after - home(table[after, 0], mask)) & mask) >= ((after - hole) & mask):
                    table[hole, 0] = table[after, 0]
                    table[hole, 1] = table[after, 1]
                    hole = after
                after = (after + 1) & mask
            table[hole, 0] = 0
            return label
        slot = (slot + 1) & mask
    return np.int64(-1)


@njit(inline="always")
def record(log_at, log, sizes, key, state):
    """Append the key of a paired edge to its bin of the log; with no room left, state[3] says that it is not there."""
    place = np.int64(key >> BIN) & (log.shape[0] - 1)
    size = sizes[place]
    if size < log.shape[1]:
        prefetch(log_at, (place * log.shape[1] + size + 16) * 8)  # of so many bins the processor foresees none
        log[place, size] = key
        sizes[place] = size + 1
    else:
        state[3] = 1


@njit(inline="always")
def pair(edges, place, triangle, table, mask, parent, labels, log_at, log, sizes, state):
    """Pair the three directed edges of a triangle, whose keys begin at `place`, with those that wait; the rest wait.

    `state` is (edges waiting, labels given, triangles with a repeated corner, paired edges left out of the log).
    """
    if edges[place] == 0:  # its edges cancel among themselves
        state[2] += 1
        labels[triangle] = -1
        return
    label = np.int64(-1)
    pending = 0
    for side in range(3):
        key = edges[place + side] | ONE
        sign = edges[place + side] & ONE
        other = take(table, mask, key, sign)
        if other >= 0:
            state[0] -= 1
            record(log_at, log, sizes, key, state)
            other = find(parent, other)
            if label < 0:
                label = other
            elif label != other:  # keep the older label: numbering follows the file
                if label < other:
                    parent[other] = label
                else:
                    parent[label] = other
                    label = other
        else:
            edges[place + pending] = edges[place + side]
            pending += 1
    if label < 0:
        label = state[1]
        parent[label] = label
        state[1] += 1
    labels[triangle] = label
    for k in range(pending):
        edge = edges[place + k]
        insert(table, mask, edge | ONE, uint64(label) << ONE | (edge & ONE))
    state[0] += pending


@njit(inline="always")
def any_repeated(table, log_at, log, sizes, slots, state):
    """Say whether any edge was paired twice, or still waits and was used before: whether a key occurs twice."""
    if state[0] > 0:
        for slot in range(len(table)):
            if table[slot, 0] != 0:
                record(log_at, log, sizes, table[slot, 0], state)
    if state[3] != 0:
        return 1
    mask = len(slots) - 1
    for place in range(len(sizes)):
        slots[:] = 0
        for at in range(sizes[place]):
            key = log[place, at]
            slot = home(key, mask)
            while slots[slot] != 0:
                if slots[slot] == np.uint16(key):  # few bits of it (it is odd): nearly always another key
                    for before in range(at):
                        if log[place, before] == key:
                            return 1
                slot = (slot + 1) & mask
            slots[slot] = np.uint16(key)
    return 0


def pair_facets(
    records,
    salt_at,
    start,
    stop,
    table_at,
    capacity,
    edges_at,
    parent_at,
    room,
    labels_at,
    log_at,
    logged,
    sizes_at,
    bins,
    slots_at,
    places,
    state_at,
):
    """Pair the edges of binary STL records `start:stop` (all the tables are carried from call to call).

    With room for `places`, as the last call has, it returns whether an edge is used more than twice.
    """
    halves = carray(records, (stop * STRIDE_F4,), np.uint16)
    salt = carray(salt_at, (SALTS,), np.uint64)
    table = carray(table_at, (capacity, 2), np.uint64)
    edges = carray(edges_at, (3 * BLOCK,), np.uint64)
    parent = carray(parent_at, (room,), np.int32)
    labels = carray(labels_at, (stop,), np.int32)
    log = carray(log_at, (bins, logged), np.uint64)
    sizes = carray(sizes_at, (bins,), np.int64)
    slots = carray(slots_at, (places,), np.uint16)
    state = carray(state_at, (4,), np.int64)
    mask = capacity - 1
    for first in range(start, stop, BLOCK):
        count = min(BLOCK, stop - first)
        for k in range(count):
            at = (first + k) * STRIDE_F4 + 6
            u = corner_key(halves, at, salt)
            v = corner_key(halves, at + 6, salt)
            w = corner_key(halves, at + 12, salt)
            edge_keys(u, v, w, salt, edges, 3 * k, table_at, mask)
        for k in range(count):
            pair(edges, 3 * k, first + k, table, mask, parent, labels, log_at, log, sizes, state)
    return any_repeated(table, log_at, log, sizes, slots, state) if places > 0 else 0


def pair_faces(
    faces_at,
    vertex_keys,
    vertices,
    salt_at,
    start,
    stop,
    table_at,
    capacity,
    edges_at,
    parent_at,
    room,
    labels_at,
    log_at,
    logged,
    sizes_at,
    bins,
    slots_at,
    places,
    state_at,
):
    """Pair the edges of faces `start:stop`, whose vertices have the 64-bit keys `vertex_keys`."""
    faces = carray(faces_at, (stop, 3), np.int64)
    of = carray(vertex_keys, (vertices,), np.uint64)
    salt = carray(salt_at, (SALTS,), np.uint64)
    table = carray(table_at, (capacity, 2), np.uint64)
    edges = carray(edges_at, (3 * BLOCK,), np.uint64)
    parent = carray(parent_at, (room,), np.int32)
    labels = carray(labels_at, (stop,), np.int32)
    log = carray(log_at, (bins, logged), np.uint64)
    sizes = carray(sizes_at, (bins,), np.int64)
    slots = carray(slots_at, (places,), np.uint16)
    state = carray(state_at, (4,), np.int64)
    mask = capacity - 1
    for first in range(start, stop, BLOCK):
        count = min(BLOCK, stop - first)
        for k in range(count):
            u, v, w = of[faces[first + k, 0]], of[faces[first + k, 1]], of[faces[first + k, 2]]
            edge_keys(u, v, w, salt, edges, 3 * k, table_at, mask)
        for k in range(count):
            pair(edges, 3 * k, first + k, table, mask, parent, labels, log_at, log, sizes, state)
    return any_repeated(table, log_at, log, sizes, slots, state) if places > 0 else 0


def key_vertices(vertices_at, count, salt_at, keys_at):
    """Give each vertex the 64-bit key of its float64 coordinates, with −0 read as +0."""
    words = carray(vertices_at, (count, 6), np.uint32)
    salt = carray(salt_at, (SALTS,), np.uint64)
    keys = carray(keys_at, (count,), np.uint64)
    for vertex in range(count):
        high, low = salt[0], salt[VERTEX]
        for k in range(0, 6, 2):
            one, other = uint64(words[vertex, k]), uint64(words[vertex, k + 1])
            if other == SIGN and one == 0:
                other = np.uint64(0)
            high += one * salt[k + 1] + other * salt[k + 2]
            low += one * salt[VERTEX + k + 1] + other * salt[VERTEX + k + 2]
        keys[vertex] = (high >> S32 << S32) | (low >> S32)
    return 0


def rehash(old_at, old_capacity, table_at, capacity):
    """Move all entries into a larger, empty table; those of one key stay in the order in which they came."""
    old = carray(old_at, (old_capacity, 2), np.uint64)
    table = carray(table_at, (capacity, 2), np.uint64)
    free = 0
    while old[free, 0] != 0:
        free += 1
    for step in range(old_capacity):
        slot = (free + step) & (old_capacity - 1)
        if old[slot, 0] != 0:
            insert(table, capacity - 1, old[slot, 0], old[slot, 1])
    return 0
