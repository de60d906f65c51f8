"""The compiled kernels that pair the edges of triangles, group by group; see `pairing`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import carray, njit, types, uint64
from numba.extending import intrinsic

S29, S32 = np.uint64(29), np.uint64(32)
LOW = np.uint64(0xFFFFFFFF)
ONE, TWO, FOUR, EIGHT = (np.uint64(k) for k in (1, 2, 4, 8))
NONE = np.uint64(0xFFFFFFFFFFFFFFFF)
"""Indices are unsigned throughout: numba looks whether one with a sign is negative, each time."""

SIGN = np.uint64(0x80000000)
BIN = np.uint64(52)

VERTEX = 7
"""Salts of a sum over a vertex: one alone, and one for each 32-bit word of three float64 (of three float32, the
first of them). A vertex's key is made of two sums."""

SALTS = 2 * VERTEX + 1
"""Those and one for the edges."""

PRIME = np.uint64(2**61 - 1)
PACKED = np.uint64(2**40 - 1)
S3, S4, S8, S16, S24, S48, S61 = (np.uint64(k) for k in (3, 4, 8, 16, 24, 48, 61))

BLOCK = 64
"""Triangles whose edges' keys are computed together, which brings what the table has for them on its way."""

ENTRY = 16
"""Bytes of an entry of the table: the key of an edge that waits, its lowest bit 1, and 2 × its label + that bit."""

FEW = 16
"""Triangles of a leaf whose edges' keys are computed together."""

ALL, WAYS = np.uint64(7), np.uint64(3)
"""The edges of a triangle, and the ways that one can run, as bits."""

AHEAD = np.uint64(16)
FAR = 1000
"""Slots after its own that an entry may have to go in a table with free ones; edges of one key go so far."""

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
def key_of(x, y, z, salt):
    """Return the 60-bit key of a corner by the patterns of its float32 coordinates."""
    high = salt[0] + x * salt[1] + y * salt[2] + z * salt[3]
    low = salt[VERTEX] + x * salt[VERTEX + 1] + y * salt[VERTEX + 2] + z * salt[VERTEX + 3]
    return (high >> S32 << S32 | low >> S32) >> S4


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


@intrinsic
def pointer(context, address):
    """Return the pointer to an address."""

    def code(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], context.get_value_type(types.voidptr))

    return types.voidptr(types.int64), code


@intrinsic
def multiply(context, a, b):
    """Return the upper and the lower half of the product of two uint64."""

    def code(context, builder, signature, arguments):
        wide = ir.IntType(128)
        product = builder.mul(*(builder.zext(each, wide) for each in arguments))
        halves = builder.lshr(product, ir.Constant(wide, 64)), product
        return context.make_tuple(builder, signature.return_type, [builder.trunc(k, ir.IntType(64)) for k in halves])

    return types.UniTuple(types.uint64, 2)(types.uint64, types.uint64), code


@njit(inline="always")
def edge_key(a, b, salt):
    """Return the key of the edge between two vertices, by theirs; the lowest bit says which way it runs.

    It is (r + a)(r + b) modulo the prime 2⁶¹ − 1, in the upper bits. For two edges these are polynomials in r that
    differ, by one of the first degree at most, so that they agree for one r at most.
    """
    r = salt[2 * VERTEX] & PRIME
    high, low = multiply(r + a, r + b)
    key = (low & PRIME) + (high << S3 | low >> S61)
    key = (key & PRIME) + (key >> S61)
    if key >= PRIME:
        key -= PRIME
    return key << S3 | uint64(a < b)


@njit(inline="always")
def find(parent, label):
    """Return the root of `label`, halving the path to it."""
    above = uint64(parent[label])
    while above != label:
        parent[label] = parent[above]
        label = uint64(parent[label])
        above = uint64(parent[label])
    return label


@njit(inline="always")
def home(key, mask):
    """Return the slot where the search for `key` begins."""
    return (key >> S29) & mask


@njit(inline="always")
def edge_keys(u, v, w, salt, edges, place, table_at, mask):
    """Write the keys of a triangle's edges, 0 where a corner is repeated, and send for what the table has for them."""
    if u == v or v == w or w == u:
        edges[place] = 0
        return
    edges[place], edges[place + 1], edges[place + 2] = edge_key(u, v, salt), edge_key(v, w, salt), edge_key(w, u, salt)
    for side in range(3):
        prefetch(table_at, np.int64(home(edges[place + side], mask)) * ENTRY)


@njit(inline="always")
def insert(table, mask, key, value):
    """Put an entry at its first free slot, and say whether that is too far to go for each of many."""
    first = slot = home(key, mask)
    while table[slot, 0] != 0:
        slot = (slot + ONE) & mask
    table[slot, 0] = key
    table[slot, 1] = value
    return ((slot - first) & mask) > uint64(FAR)


@njit(inline="always")
def take(table, mask, key, sign):
    """Remove an entry of `key` with the opposite sign and return its label, or `NONE`."""
    slot = home(key, mask)
    while table[slot, 0] != 0:
        if table[slot, 0] == key and (table[slot, 1] & ONE) != sign:
            label = table[slot, 1] >> ONE
            # Close the gap: move back every later entry that could not be found past an empty slot.
            hole = slot
            after = (slot + ONE) & mask
            while table[after, 0] != 0:
                if ((after - home(table[after, 0], mask)) & mask) >= ((after - hole) & mask):
                    table[hole, 0] = table[after, 0]
                    table[hole, 1] = table[after, 1]
                    hole = after
                after = (after + ONE) & mask
            table[hole, 0] = 0
            return label
        slot = (slot + ONE) & mask
    return NONE


@njit(inline="always")
def record(log_at, log, sizes, key, state):
    """Append the key of a paired edge to its bin of the log; with no room left, state[3] says that it is not there."""
    place = (key >> BIN) & uint64(log.shape[0] - 1)
    size = sizes[place]
    if size < uint64(log.shape[1]):
        ahead = place * uint64(log.shape[1]) + size + AHEAD  # of so many bins the processor foresees none
        prefetch(log_at, np.int64(ahead) * 8)
        log[place, size] = key
        sizes[place] = size + ONE
    else:
        state[3] = 1


@njit(inline="always")
def join(parent, label, other):
    """Join two labels, of which the first may be `NONE`, and return the root: the older of their roots."""
    other = find(parent, other)
    if label == NONE:
        return other
    low, high = min(label, other), max(label, other)
    parent[high] = np.uint32(low)
    return low


@njit(inline="always")
def pair(edges, place, triangle, table, mask, parent, labels, log_at, log, sizes, state):
    """Pair the three directed edges of a triangle, whose keys begin at `place`, with those that wait; the rest wait.

    `state` is (edges waiting, labels given, triangles with a repeated corner, paired edges left out of the log,
    triangles done).
    """
    if edges[place] == 0:  # its edges cancel among themselves
        state[2] += 1
        labels[triangle] = -1
        return False
    label = NONE
    pending = 0
    for side in range(3):
        key = edges[place + side] | ONE
        sign = edges[place + side] & ONE
        other = take(table, mask, key, sign)
        if other != NONE:
            state[0] -= 1
            record(log_at, log, sizes, key, state)
            label = join(parent, label, other)
        else:
            edges[place + pending] = edges[place + side]
            pending += 1
    if label == NONE:
        label = uint64(state[1])
        parent[label] = np.uint32(label)
        state[1] += 1
    labels[triangle] = np.int32(label)
    far = False
    for k in range(pending):
        edge = edges[place + k]
        far |= insert(table, mask, edge | ONE, label << ONE | (edge & ONE))
    state[0] += pending
    return far


def pair_rows(
    rows_at,
    number,
    salt_at,
    table_at,
    capacity,
    parent_at,
    labels_at,
    group,
    log_at,
    bins,
    logged,
    sizes_at,
    state_at,
):
    """Pair the edges of further triangles of one group, by the keys of their corners, three a row.

    It returns 1 where less than half of the table would be left free, or edges of one key crowd it.
    """
    rows = carray(rows_at, (number, 3), np.uint64)
    salt = carray(salt_at, (SALTS,), np.uint64)
    table = carray(table_at, (capacity, 2), np.uint64)
    parent = carray(parent_at, (group,), np.uint32)
    labels = carray(labels_at, (group,), np.int32)
    log = carray(log_at, (bins, logged), np.uint64)
    sizes = carray(sizes_at, (bins,), np.uint64)
    state = carray(state_at, (5 + 3 * BLOCK,), np.int64)
    edges = carray(state_at, (5 + 3 * BLOCK,), np.uint64)[5:]
    mask = uint64(capacity - 1)
    for first in range(0, number, BLOCK):
        count = min(BLOCK, number - first)
        if 2 * (state[0] + 3 * BLOCK) > capacity:
            return 1
        for k in range(count):
            row = first + k
            edge_keys(rows[row, 0], rows[row, 1], rows[row, 2], salt, edges, 3 * k, table_at, mask)
        far = False
        for k in range(count):
            far |= pair(edges, 3 * k, state[4] + k, table, mask, parent, labels, log_at, log, sizes, state)
        state[4] += count
        if far:
            return 1
    return 0


def close_group(table_at, capacity, parent_at, labels_at, group, edges_at, pieces_at, state_at):
    """Number the pieces of a group in the order of their first triangles, and list the edges that still wait.

    `edges` are their keys with the way that they run, `pieces` whose they are. Returns how many pieces there are.
    """
    table = carray(table_at, (capacity, 2), np.uint64)
    parent = carray(parent_at, (group,), np.uint32)
    labels = carray(labels_at, (group,), np.int32)
    state = carray(state_at, (5,), np.int64)
    edges = carray(edges_at, (state[0],), np.uint64)
    pieces = carray(pieces_at, (state[0],), np.int32)
    number = 0
    for label in range(state[1]):
        above = uint64(parent[label])
        if above == uint64(label):
            parent[label] = np.uint32(number)
            number += 1
        else:
            parent[label] = parent[above]  # an older one, which has its number
    if number == 1:
        for k in range(state[4]):
            labels[k] = min(labels[k], 0)
    else:
        for k in range(state[4]):
            if labels[k] >= 0:
                labels[k] = np.int32(parent[uint64(labels[k])])
    waiting = slot = 0
    while waiting < state[0]:
        if table[slot, 0] != 0:
            edges[waiting] = table[slot, 0] & ~ONE | table[slot, 1] & ONE
            pieces[waiting] = np.int32(parent[table[slot, 1] >> ONE])
            waiting += 1
            table[slot, 0] = 0
        slot += 1
    return number


@njit(inline="always")
def hold(key, way, place, table_at, mask, upper, edges, slots, count):
    """Write what the table is to have of an edge, and where, and send for what it has there."""
    slot = (key >> S4) & mask
    prefetch(table_at, np.int64(slot << S3))
    slots[count] = slot
    edges[count] = (key & upper) | place + uint64(way)


def pair_leaf(
    rows_at,
    runs_at,
    number,
    salt_at,
    table_at,
    capacity,
    partners_at,
    queue_at,
    labels_at,
    group,
    edges_at,
    pieces_at,
    piece,
    state_at,
):
    """Pair the edges of a leaf of triangles, in an order that no processor foresees; return how many pieces there are.

    A row has the keys of the corners and which edges are used in this leaf alone (`put`, `descend`); of the others,
    `edges` are the keys with the way that they run, `pieces` whose they are, and state[0] says how many. An entry of
    the table has upper bits of a key, 4 × the triangle + the side of its first use, where triangles count from 1, and
    two bits that say which ways the edge runs; there is room for all. The keys are (r + 2 a)(r + 2 b) modulo 2⁶⁴ with
    an odd r, of which other bits say where an entry goes; all of them tell edges apart but for 40 · 2⁻⁶³. So
    `partners` has who is across each side: 0 stands for nobody, and is written to like the others, which spares a
    branch. state[1] counts edges used once; a second use of the same way sets state[3]. `labels` has one more in front,
    and a byte for each behind. They are put in place of the first 32 bits of the rows; that of the first piece is
    given.
    """
    runs = carray(runs_at, (number, 2), np.int64)
    salt = carray(salt_at, (SALTS,), np.uint64)
    table = carray(table_at, (capacity,), np.uint64)
    partners = carray(partners_at, (4 * group + 4,), np.uint32)
    queue = carray(queue_at, (group + 1,), np.uint32)
    labels = carray(labels_at, (group + 1,), np.int32)
    seen = carray(labels_at, (5 * (group + 1),), np.uint8)[4 * (group + 1) :]
    waits = carray(edges_at, (3 * group,), np.uint64)
    pieces = carray(pieces_at, (3 * group,), np.int32)
    state = carray(state_at, (5 + 6 * FEW,), np.int64)
    room = carray(state_at, (5 + 6 * FEW,), np.uint64)
    edges, slots = room[5 : 5 + 3 * FEW], room[5 + 3 * FEW :]
    mask, r = uint64(capacity - 1), salt[2 * VERTEX] | ONE
    shift = TWO
    while uint64(4 * group + 3) >> (shift - TWO) != 0:
        shift += ONE
    places, upper = (ONE << (shift - TWO)) - ONE, ~((ONE << shift) - ONE)
    triangle, waiting = uint64(0), uint64(0)
    labels[0], seen[0] = 0, 1
    for run in range(number):
        begin, end = uint64(runs[run, 0]), uint64(runs[run, 0] + runs[run, 1])
        ahead = uint64(runs[min(run + 1, number - 1), 0]) - begin  # the next run is elsewhere
        rows = carray(rows_at, (runs[run, 0] + runs[run, 1], 2), np.uint64)
        for first in range(begin, end, uint64(FEW)):
            count = uint64(0)
            for row in range(first, min(first + uint64(FEW), end)):
                prefetch(rows_at, np.int64((row + ahead) << S4))
                one, other = rows[row, 0], rows[row, 1]
                u, v, w = one >> S24, (one << S16 | other >> S48) & PACKED, other >> S8 & PACKED
                triangle += ONE
                seen[triangle] = 0
                if u == v or v == w or w == u:
                    state[2] += 1
                    labels[triangle], seen[triangle] = -1, 1
                    continue
                a, b, c = r + (u << ONE), r + (v << ONE), r + (w << ONE)
                place = triangle << S4
                # The edges that other leaves use as well are overwritten by the next.
                hold(a * b, u < v, place | ONE, table_at, mask, upper, edges, slots, count)
                count += other & ONE
                hold(b * c, v < w, place | ONE | FOUR, table_at, mask, upper, edges, slots, count)
                count += other >> ONE & ONE
                hold(c * a, w < u, place | ONE | EIGHT, table_at, mask, upper, edges, slots, count)
                count += other >> TWO & ONE
                if other & ALL != ALL:
                    for side in range(uint64(0), uint64(3)):
                        if other >> side & ONE == 0:
                            tail = u if side == 0 else (v if side == 1 else w)
                            head = v if side == 0 else (w if side == 1 else u)
                            waits[waiting] = edge_key(tail, head, salt)
                            pieces[waiting] = np.int32(triangle)
                            waiting += ONE
                            partners[triangle << TWO | side] = 0
            for k in range(count):
                edge, slot = edges[k], slots[k]
                held = table[slot]
                while held * ((held ^ edge) >> shift) != 0:  # one branch: whether it is free or found, none foresees
                    slot = (slot + ONE) & mask
                    held = table[slot]
                table[slot] = edge if held == 0 else held | edge & WAYS
                if held & edge & WAYS != 0:
                    state[3] = 1
                place, partner = edge >> TWO & places, held >> TWO & places
                partners[place] = np.uint32(partner)
                partners[partner] = np.uint32(place)
    table[:] = 0
    before, alone = piece, uint64(0)
    head, tail = uint64(0), uint64(0)
    for first in range(uint64(1), triangle + ONE):
        if seen[first] != 0:
            continue
        start = tail
        seen[first] = 1
        queue[tail] = np.uint32(first)
        tail += ONE
        while head < tail:  # breadth first, so that one step does not wait for the one before
            place = uint64(queue[head]) << TWO
            head += ONE
            for side in range(3):
                across = uint64(partners[place + uint64(side)] >> np.uint32(2))
                alone += uint64(across == 0)
                queue[tail] = np.uint32(across)
                tail += uint64(seen[across] == 0)
                seen[across] = 1
        if start > 0 or tail < triangle:
            for k in range(start, tail):
                labels[uint64(queue[k])] = np.int32(piece)
        piece += 1
    whole = tail == triangle and piece == before + 1
    for k in range(waiting):
        pieces[k] = np.int32(before) if whole else labels[uint64(pieces[k])]
    state[0] = np.int64(waiting)
    state[1] += np.int64(alone - waiting)
    triangle = uint64(0)
    for run in range(number):
        rows = carray(rows_at, (4 * (runs[run, 0] + runs[run, 1]),), np.int32)
        for row in range(uint64(runs[run, 0]), uint64(runs[run, 0] + runs[run, 1])):
            triangle += ONE
            rows[row << TWO] = np.int32(before) if whole else labels[triangle]
    return piece - before


def pair_edges(
    edges_at, pieces_at, count, table_at, capacity, parent_at, number, log_at, bins, logged, sizes_at, state_at
):
    """Pair single edges, of pieces that have a label each, as `pair_rows` does; those that stay alone are logged.

    Where edges of one key crowd the table, state[3] says that some were left out.
    """
    edges = carray(edges_at, (count,), np.uint64)
    pieces = carray(pieces_at, (count,), np.int32)
    table = carray(table_at, (capacity, 2), np.uint64)
    parent = carray(parent_at, (number,), np.uint32)
    log = carray(log_at, (bins, logged), np.uint64)
    sizes = carray(sizes_at, (bins,), np.uint64)
    state = carray(state_at, (5,), np.int64)
    mask = uint64(capacity - 1)
    for first in range(0, count, BLOCK):
        last = min(first + BLOCK, count)
        for k in range(first, last):
            prefetch(table_at, np.int64(home(edges[k] | ONE, mask)) * ENTRY)
        for k in range(first, last):
            key, way = edges[k] | ONE, edges[k] & ONE
            other = take(table, mask, key, way)
            if other != NONE:
                state[0] -= 1
                record(log_at, log, sizes, key, state)
                join(parent, find(parent, uint64(pieces[k])), other)
            else:
                state[0] += 1
                if insert(table, mask, key, uint64(pieces[k]) << ONE | way):
                    state[3] = 1
                    return 0
    if state[0] > 0:
        for slot in range(capacity):
            if table[slot, 0] != 0:
                record(log_at, log, sizes, table[slot, 0], state)
    return 0


@njit(inline="always")
def logged_before(logs, bins, place, key, which, at):
    """Say whether a key is in a bin of the logs before place `at` of the log `which`."""
    for earlier in range(which + 1):
        log = carray(pointer(logs[earlier, 0]), (bins, logs[earlier, 1]), np.uint64)
        size = carray(pointer(logs[earlier, 2]), (bins,), np.int64)[place]
        for before in range(at if earlier == which else size):
            if log[place, before] == key:
                return True
    return False


def repeated_edges(logs_at, number, bins, first, last, slots_at, places, found_at, room):
    """Write the keys that occur more than once in bins `first:last` of the logs (keys, room of a bin, sizes of bins).

    Returns how many it has written, some of them several times; more than `room` where these are too many.
    """
    logs = carray(logs_at, (number, 3), np.int64)
    slots = carray(slots_at, (places,), np.uint16)
    found = carray(found_at, (room,), np.uint64)
    mask, written = uint64(places - 1), 0
    for place in range(first, last):
        slots[:] = 0
        for which in range(number):
            size = carray(pointer(logs[which, 2]), (bins,), np.int64)[place]
            log = carray(pointer(logs[which, 0]), (bins, logs[which, 1]), np.uint64)
            for at in range(size):
                key = log[place, at]
                slot, again = home(key, mask), False
                while slots[slot] != 0 and not again:
                    if slots[slot] == np.uint16(key):  # few bits of it (it is odd): nearly always another key
                        again = logged_before(logs, bins, place, key, which, at)
                    slot = (slot + ONE) & mask
                if not again:
                    slots[slot] = np.uint16(key)
                elif written < room:
                    found[written] = key
                    written += 1
                else:
                    return room + 1
    return written


def key_facets(records_at, count, salt_at, rows_at):
    """Give the corners of binary STL records their keys, three a row."""
    halves = carray(records_at, (count * STRIDE_F4,), np.uint16)
    salt = carray(salt_at, (SALTS,), np.uint64)
    rows = carray(rows_at, (count, 3), np.uint64)
    for k in range(count):
        at = k * STRIDE_F4 + 6
        for corner in range(3):
            x = at + 6 * corner
            rows[k, corner] = key_of(word(halves, x), word(halves, x + 2), word(halves, x + 4), salt)
    return 0


def key_faces(faces_at, count, vertex_keys_at, vertices, rows_at):
    """Give the corners of faces the keys of their vertices, three a row."""
    faces = carray(faces_at, (count, 3), np.int64)
    of = carray(vertex_keys_at, (vertices,), np.uint64)
    rows = carray(rows_at, (count, 3), np.uint64)
    for k in range(count):
        for corner in range(3):
            rows[k, corner] = of[faces[k, corner]]
    return 0


def key_vertices(vertices_at, count, salt_at, keys_at):
    """Give each vertex the 60-bit key of its float64 coordinates, with −0 read as +0."""
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
        keys[vertex] = (high >> S32 << S32 | low >> S32) >> S4
    return 0
