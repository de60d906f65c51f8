"""The compiled kernels that write the edges of triangles into buckets, and pair them bucket by bucket; see `closure`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit, uint64

from inertia.mesh.geometry.edge_kernel import LOW, ONE, S32, SALTS, edge_key, prefetch

TWO, THREE = np.uint64(2), np.uint64(3)

BLOCK = 64
"""Pairs of triangles whose places are brought into the cache together."""

REPEATED = np.uint32(0xFFFFFFFF)
ONCE, IRREGULAR = np.uint64(0xFFFFFFFF), np.uint64(0xFFFFFFFE)
"""In place of the number of a second directed edge: there is none, or the edge is irregular."""


def key_edges(rows_at, count, salt_at, keys_at, counts_at, buckets, shift):
    """Write the keys of the edges of triangles by those of their corners, never 0 or 1, and count them by bucket.

    They are 0 where a corner is repeated; it returns how many triangles have one.
    """
    rows = carray(rows_at, (count, 3), np.uint64)
    salt = carray(salt_at, (SALTS,), np.uint64)
    keys = carray(keys_at, (count, 3), np.uint64)
    counts = carray(counts_at, (buckets,), np.int64)
    by = uint64(shift)
    repeated = 0
    for k in range(count):
        u, v, w = rows[k, 0], rows[k, 1], rows[k, 2]
        if u == v or v == w or w == u:
            keys[k, 0], keys[k, 1], keys[k, 2] = 0, 0, 0
            repeated += 1
            continue
        keys[k, 0], keys[k, 1], keys[k, 2] = edge_key(u, v, salt), edge_key(v, w, salt), edge_key(w, u, salt)
        for side in range(3):
            if keys[k, side] < TWO:
                keys[k, side] += TWO
            counts[np.int64(keys[k, side] >> by)] += 1
    return repeated


def sort_edges(keys_at, count, first, shift, places_at, buckets, out_at, room):
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
        if uint64(above) == a:
            return
        a = uint64(above)
        above = parent[a]


@njit(inline="always")
def slot_of(table, mask, key):
    """Return the slot that holds a key, or the free one where it would go."""
    slot = np.int64(key >> ONE) & mask
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


def regular_pairs(table_at, capacity, uses_at, pairs_at, state_at):
    """Write the pairs of triangles at edges that are used once each way; return how many there are.

    `state` adds up how many directed edges have no opposite partner, how many edges are used more than twice, how many
    otherwise than once each way, and how many once.
    """
    table = carray(table_at, (capacity, 2), np.uint64)
    uses = carray(uses_at, (capacity, 2), np.uint32)
    pairs = carray(pairs_at, (capacity, 2), np.uint32)
    state = carray(state_at, (4,), np.int64)
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
            state[3] += 1
        else:
            forward, backward = np.int64(uses[slot, 1]), np.int64(uses[slot, 0])
            state[0] += abs(forward - backward)
            state[1] += forward + backward > 2
    return size


def join_pairs(pairs_at, size, parent_at, count):
    """Join pairs of triangles."""
    pairs = carray(pairs_at, (size, 2), np.uint32)
    parent = carray(parent_at, (count,), np.uint32)
    for start in range(0, size, BLOCK):
        stop = min(start + BLOCK, size)
        for k in range(start, stop):
            prefetch(parent_at, 4 * np.int64(pairs[k, 0]))
            prefetch(parent_at, 4 * np.int64(pairs[k, 1]))
        for k in range(start, stop):
            unite(parent, uint64(pairs[k, 0]), uint64(pairs[k, 1]))
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
