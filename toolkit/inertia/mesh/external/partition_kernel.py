"""The compiled kernels that write the edges of triangles into buckets, and pair them bucket by bucket; see `closure`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit, uint64

S1, S32, S33 = np.uint64(1), np.uint64(32), np.uint64(33)
LOW = np.uint64(0xFFFFFFFF)
ONE, TWO, THREE = np.uint64(1), np.uint64(2), np.uint64(3)
SIGN = np.uint64(0x80000000)

STRIDE = 25
"""Half-words (uint16) in a binary STL record; its corners begin at half-word 6."""

VERTEX, EDGE = 7, 5
"""Salts of a sum over a vertex and over an edge: one alone, and one for each 32-bit word of three float64 (of three
float32, the first of them), or of two keys. A key is made of two sums."""

SALTS = 2 * (VERTEX + EDGE)
PAIRS = 64
"""Pairs of triangles whose places are brought into the cache together."""

REPEATED = np.uint32(0xFFFFFFFF)
ONCE, IRREGULAR = np.uint64(0xFFFFFFFF), np.uint64(0xFFFFFFFE)
"""In place of the number of a second directed edge: there is none, or the edge is irregular."""


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


@njit(inline="always")
def edge_key(a, b, salt):
    """Return the key of the edge between two vertices, by theirs, never 0 or 1; the lowest bit says how it runs."""
    way = uint64(a < b)
    a, b = min(a, b), max(a, b)
    a0, a1, b0, b1 = a & LOW, a >> S32, b & LOW, b >> S32
    k = 2 * VERTEX
    high = salt[k] + a0 * salt[k + 1] + a1 * salt[k + 2] + b0 * salt[k + 3] + b1 * salt[k + 4]
    k = 2 * VERTEX + EDGE
    low = salt[k] + a0 * salt[k + 1] + a1 * salt[k + 2] + b0 * salt[k + 3] + b1 * salt[k + 4]
    key = (high >> S32 << S32) | (low >> S33 << ONE)
    return (key if key != 0 else TWO) | way


@njit(inline="always")
def write_keys(u, v, w, salt, keys, place, counts, shift):
    """Write the keys of a triangle's edges and count them by bucket; 0, where a corner is repeated. Say whether."""
    if u == v or v == w or w == u:
        keys[place], keys[place + 1], keys[place + 2] = 0, 0, 0
        return 1
    one, two, three = edge_key(u, v, salt), edge_key(v, w, salt), edge_key(w, u, salt)
    keys[place], keys[place + 1], keys[place + 2] = one, two, three
    counts[np.int64(one >> shift)] += 1
    counts[np.int64(two >> shift)] += 1
    counts[np.int64(three >> shift)] += 1
    return 0


def key_facets(records, count, salt_at, keys_at, counts_at, buckets, shift):
    """Write the keys of the edges of binary STL records; return how many have a repeated corner."""
    halves = carray(records, (count * STRIDE,), np.uint16)
    salt = carray(salt_at, (SALTS,), np.uint64)
    keys = carray(keys_at, (3 * count,), np.uint64)
    counts = carray(counts_at, (buckets,), np.int64)
    repeated = 0
    for k in range(count):
        at = k * STRIDE + 6
        u, v, w = corner_key(halves, at, salt), corner_key(halves, at + 6, salt), corner_key(halves, at + 12, salt)
        repeated += write_keys(u, v, w, salt, keys, 3 * k, counts, uint64(shift))
    return repeated


def key_faces(faces_at, count, vertex_keys, vertices, salt_at, keys_at, counts_at, buckets, shift):
    """Write the keys of the edges of faces, whose vertices have the 64-bit keys `vertex_keys`."""
    faces = carray(faces_at, (count, 3), np.int64)
    of = carray(vertex_keys, (vertices,), np.uint64)
    salt = carray(salt_at, (SALTS,), np.uint64)
    keys = carray(keys_at, (3 * count,), np.uint64)
    counts = carray(counts_at, (buckets,), np.int64)
    repeated = 0
    for k in range(count):
        u, v, w = of[faces[k, 0]], of[faces[k, 1]], of[faces[k, 2]]
        repeated += write_keys(u, v, w, salt, keys, 3 * k, counts, uint64(shift))
    return repeated


def scatter(keys_at, count, first, shift, places_at, buckets, out_at, room):
    """Write (key, number) of directed edges, the first of which has the number `first`, where their buckets go on."""
    keys = carray(keys_at, (count,), np.uint64)
    places = carray(places_at, (buckets,), np.int64)
    out = carray(out_at, (room, 3), np.uint32)
    by = uint64(shift)
    for k in range(count):
        key = keys[k]
        if key == 0:
            continue
        bucket = np.int64(key >> by)
        place = places[bucket]
        places[bucket] = place + 1
        out[place, 0] = np.uint32(key & LOW)
        out[place, 1] = np.uint32(key >> S32)
        out[place, 2] = np.uint32(first + k)
    return 0


@njit(inline="always")
def slot_of(table, mask, key):
    """Return the slot that holds a key, or the free one where it would go."""
    slot = np.int64(key >> S1) & mask
    while table[slot, 0] != 0 and (table[slot, 0] ^ key) > ONE:  # that differ by more than the way
        slot = (slot + 1) & mask
    return slot


def count_uses(records_at, count, table_at, capacity, uses_at, used):
    """Look up who uses each edge of a bucket; −1 where the table is too small.

    A row is the key with the way of the first directed edge that has it, the number of that, and of the second, or
    `ONCE`, or `IRREGULAR`: then there are more, or both run the same way, and `uses` holds how many run which way.
    With `used` rows so far, it returns how many there are.
    """
    records = carray(records_at, (count, 3), np.uint32)
    table = carray(table_at, (capacity, 2), np.uint64)
    uses = carray(uses_at, (capacity, 2), np.uint32)
    mask = capacity - 1
    for k in range(count):
        key = uint64(records[k, 0]) | (uint64(records[k, 1]) << S32)
        number = uint64(records[k, 2])
        slot = slot_of(table, mask, key)
        own = table[slot, 0]
        if own == 0:
            used += 1
            if 5 * used > 4 * capacity:
                return -1
            table[slot, 0], table[slot, 1] = key, number | (ONCE << S32)
            continue
        other = table[slot, 1] >> S32
        if other == ONCE and own != key:
            table[slot, 1] = (table[slot, 1] & LOW) | (number << S32)
            continue
        if other != IRREGULAR:
            table[slot, 1] = (table[slot, 1] & LOW) | (IRREGULAR << S32)
            uses[slot, 0] = uses[slot, 1] = 0 if other == ONCE else 1
            if other == ONCE:
                uses[slot, np.int64(own & ONE)] = 1
        uses[slot, np.int64(key & ONE)] += 1
    return used


@njit(inline="always")
def unite(parent, a, b):
    """Join two pieces; no triangle lies under one behind it.

    Rem's algorithm (M. Patwary, J. Blair and F. Manne, "Experiments on union-find algorithms for the disjoint-set data
    structure", SEA 2010, figure 2), which stops as soon as both have one parent.
    """
    above, other = parent[a], parent[b]
    while above != other:
        if above < other:
            a, b, above, other = b, a, other, above
        parent[a] = other
        if np.int64(above) == a:
            return
        a = np.int64(above)
        above = parent[a]


def regular_pairs(table_at, capacity, uses_at, pairs_at, state_at):
    """Write the pairs of triangles at edges that are used once each way; return how many there are.

    `state` adds up how many directed edges have no opposite partner, how many edges are used more than twice, and how
    many otherwise than once each way.
    """
    table = carray(table_at, (capacity, 2), np.uint64)
    uses = carray(uses_at, (capacity, 2), np.uint32)
    pairs = carray(pairs_at, (capacity, 2), np.uint32)
    state = carray(state_at, (3,), np.int64)
    size = 0
    for slot in range(capacity):
        if table[slot, 0] == 0:
            continue
        one, other = table[slot, 1] & LOW, table[slot, 1] >> S32
        if other < IRREGULAR:
            pairs[size, 0], pairs[size, 1] = np.uint32(one // THREE), np.uint32(other // THREE)
            size += 1
            continue
        state[2] += 1
        if other == ONCE:
            state[0] += 1
        else:
            forward, backward = np.int64(uses[slot, 1]), np.int64(uses[slot, 0])
            state[0] += abs(forward - backward)
            state[1] += forward + backward > 2
    return size


def join_pairs(pairs_at, size, parent_at, count, warm_at):
    """Join pairs of triangles."""
    pairs = carray(pairs_at, (size, 2), np.uint32)
    parent = carray(parent_at, (count,), np.uint32)
    warm = carray(warm_at, (1,), np.uint64)
    for start in range(0, size, PAIRS):
        stop = min(start + PAIRS, size)
        for k in range(start, stop):  # to read them all before any is waited for; a sum that is not kept is not formed
            warm[0] += uint64(parent[np.int64(pairs[k, 0])]) + uint64(parent[np.int64(pairs[k, 1])])
        for k in range(start, stop):
            unite(parent, np.int64(pairs[k, 0]), np.int64(pairs[k, 1]))
    return 0


def irregular_uses(records_at, count, table_at, capacity, out_at, size, room):
    """Append the numbers of the directed edges along edges that are not used once each way; return how many there are.

    Those for which there is no room are counted only.
    """
    records = carray(records_at, (count, 3), np.uint32)
    table = carray(table_at, (capacity, 2), np.uint64)
    out = carray(out_at, (room,), np.uint32)
    mask = capacity - 1
    for k in range(count):
        key = uint64(records[k, 0]) | (uint64(records[k, 1]) << S32)
        if table[slot_of(table, mask, key), 1] >> S32 >= IRREGULAR:
            if size < room:
                out[size] = records[k, 2]
            size += 1
    return size


def number_pieces(parent_at, count):
    """Turn the table of joined triangles into the numbers of their pieces, in the order of the file."""
    parent = carray(parent_at, (count,), np.uint32)
    pieces = 0
    for k in range(count):
        above = parent[k]
        if above == REPEATED:
            continue
        if np.int64(above) == k:
            parent[k] = np.uint32(pieces)
            pieces += 1
        else:
            parent[k] = parent[above]
    return pieces
