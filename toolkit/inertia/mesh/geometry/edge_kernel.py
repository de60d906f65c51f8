"""The compiled kernels that pair the edges of triangles as they stream by; see `closure`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit, uint64

S29, S32 = np.uint64(29), np.uint64(32)
LOW = np.uint64(0xFFFFFFFF)
ONE = np.uint64(1)
SIGN = np.uint64(0x80000000)
BIN = np.uint64(52)

VERTEX, EDGE = 7, 5
"""Salts of a sum over a vertex and over an edge: one alone, and one for each 32-bit word of three float64 (of three
float32, the first of them), or of two keys. A key is made of two sums."""

SALTS = 2 * (VERTEX + EDGE)

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


@njit(inline="always")
def edge_key(a, b, salt):
    """Return the key of the edge between two vertices, by their keys in ascending order; it is odd."""
    a0, a1, b0, b1 = a & LOW, a >> S32, b & LOW, b >> S32
    k = 2 * VERTEX
    high = salt[k] + a0 * salt[k + 1] + a1 * salt[k + 2] + b0 * salt[k + 3] + b1 * salt[k + 4]
    k = 2 * VERTEX + EDGE
    low = salt[k] + a0 * salt[k + 1] + a1 * salt[k + 2] + b0 * salt[k + 3] + b1 * salt[k + 4]
    return (high >> S32 << S32) | (low >> S32) | ONE


@njit(inline="always")
def find(parent, label):
    """Return the root of `label`, halving the path to it."""
    while parent[label] != label:
        parent[label] = parent[parent[label]]
        label = parent[label]
    return label


@njit(inline="always")
def home(key, mask):
    """Return the slot where the search for `key` begins (its lowest bit is always 1)."""
    return np.int64(key >> S29) & mask


@njit(inline="always")
def insert(keys, values, mask, key, value):
    """Put an entry at its first free slot."""
    slot = home(key, mask)
    while keys[slot] != 0:
        slot = (slot + 1) & mask
    keys[slot] = key
    values[slot] = value


@njit(inline="always")
def take(keys, values, mask, key, sign):
    """Remove an entry of `key` with the opposite sign and return its label, or −1."""
    slot = home(key, mask)
    while keys[slot] != 0:
        if keys[slot] == key and (values[slot] & 1) != sign:
            label = values[slot] >> 1
            # Close the gap: move back every later entry that could not be found past an empty slot.
            hole = slot
            after = (slot + 1) & mask
            while keys[after] != 0:
                if ((after - home(keys[after], mask)) & mask) >= ((after - hole) & mask):
                    keys[hole] = keys[after]
                    values[hole] = values[after]
                    hole = after
                after = (after + 1) & mask
            keys[hole] = 0
            return label
        slot = (slot + 1) & mask
    return np.int64(-1)


@njit(inline="always")
def record(log, sizes, key, state):
    """Append the key of a paired edge to its bin of the log; with no room left, state[3] says that it is not there."""
    place = np.int64(key >> BIN) & (log.shape[0] - 1)
    size = sizes[place]
    if size < log.shape[1]:
        log[place, size] = key
        sizes[place] = size + 1
    else:
        state[3] = 1


@njit(inline="always")
def pair(u, v, w, triangle, salt, keys, values, mask, parent, labels, log, sizes, state):
    """Pair the three directed edges of one triangle with those that wait, and let the rest wait.

    `state` is (edges waiting, labels given, triangles with a repeated corner, paired edges left out of the log).
    """
    if u == v or v == w or w == u:  # its edges cancel among themselves
        state[2] += 1
        labels[triangle] = -1
        return
    label = np.int64(-1)
    pending = 0
    k0 = k1 = k2 = np.uint64(0)
    s0 = s1 = s2 = np.int64(0)
    for side in range(3):
        if side == 0:
            a, b = u, v
        elif side == 1:
            a, b = v, w
        else:
            a, b = w, u
        sign = np.int64(a < b)
        key = edge_key(min(a, b), max(a, b), salt)
        other = take(keys, values, mask, key, sign)
        if other >= 0:
            state[0] -= 1
            record(log, sizes, key, state)
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
            if pending == 0:
                k0, s0 = key, sign
            elif pending == 1:
                k1, s1 = key, sign
            else:
                k2, s2 = key, sign
            pending += 1
    if label < 0:
        label = state[1]
        parent[label] = label
        state[1] += 1
    labels[triangle] = label
    if pending > 0:
        insert(keys, values, mask, k0, label << 1 | s0)
    if pending > 1:
        insert(keys, values, mask, k1, label << 1 | s1)
    if pending > 2:
        insert(keys, values, mask, k2, label << 1 | s2)
    state[0] += pending


@njit(inline="always")
def any_repeated(keys, log, sizes, slots, state):
    """Say whether any edge was paired twice, or still waits and was used before: whether a key occurs twice."""
    if state[0] > 0:
        for slot in range(len(keys)):
            if keys[slot] != 0:
                record(log, sizes, keys[slot], state)
    if state[3] != 0:
        return 1
    mask = len(slots) - 1
    for place in range(len(sizes)):
        slots[:] = -1
        for at in range(sizes[place]):
            key = log[place, at]
            slot = home(key, mask)
            while slots[slot] >= 0:
                if log[place, slots[slot]] == key:
                    return 1
                slot = (slot + 1) & mask
            slots[slot] = at
    return 0


def pair_facets(
    records,
    salt_at,
    start,
    stop,
    keys_at,
    values_at,
    capacity,
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
    keys = carray(keys_at, (capacity,), np.uint64)
    values = carray(values_at, (capacity,), np.int64)
    parent = carray(parent_at, (room,), np.int32)
    labels = carray(labels_at, (stop,), np.int32)
    log = carray(log_at, (bins, logged), np.uint64)
    sizes = carray(sizes_at, (bins,), np.int64)
    slots = carray(slots_at, (places,), np.int32)
    state = carray(state_at, (4,), np.int64)
    for triangle in range(start, stop):
        at = triangle * STRIDE_F4 + 6
        u = corner_key(halves, at, salt)
        v = corner_key(halves, at + 6, salt)
        w = corner_key(halves, at + 12, salt)
        pair(u, v, w, triangle, salt, keys, values, capacity - 1, parent, labels, log, sizes, state)
    return any_repeated(keys, log, sizes, slots, state) if places > 0 else 0


def pair_faces(
    faces_at,
    vertex_keys,
    vertices,
    salt_at,
    start,
    stop,
    keys_at,
    values_at,
    capacity,
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
    keys = carray(keys_at, (capacity,), np.uint64)
    values = carray(values_at, (capacity,), np.int64)
    parent = carray(parent_at, (room,), np.int32)
    labels = carray(labels_at, (stop,), np.int32)
    log = carray(log_at, (bins, logged), np.uint64)
    sizes = carray(sizes_at, (bins,), np.int64)
    slots = carray(slots_at, (places,), np.int32)
    state = carray(state_at, (4,), np.int64)
    for triangle in range(start, stop):
        u, v, w = of[faces[triangle, 0]], of[faces[triangle, 1]], of[faces[triangle, 2]]
        pair(u, v, w, triangle, salt, keys, values, capacity - 1, parent, labels, log, sizes, state)
    return any_repeated(keys, log, sizes, slots, state) if places > 0 else 0


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


def rehash(old_keys_at, old_values_at, old_capacity, keys_at, values_at, capacity):
    """Move all entries into a larger, empty table; those of one key stay in the order in which they came."""
    old_keys = carray(old_keys_at, (old_capacity,), np.uint64)
    old_values = carray(old_values_at, (old_capacity,), np.int64)
    keys = carray(keys_at, (capacity,), np.uint64)
    values = carray(values_at, (capacity,), np.int64)
    free = 0
    while old_keys[free] != 0:
        free += 1
    for step in range(old_capacity):
        slot = (free + step) & (old_capacity - 1)
        if old_keys[slot] != 0:
            insert(keys, values, capacity - 1, old_keys[slot], old_values[slot])
    return 0
