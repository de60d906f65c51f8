"""The compiled check of small surfaces: closed, in one piece, and free of triangles that cross; see `simple`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.box_kernel import (
    BLOCKS,
    GROUP,
    MOST,
    address,
    bits_of,
    block,
    fill_boxes,
    fill_slants,
    lane,
    scattered,
    sort_triangles,
)
from inertia.mesh.geometry.self_crossing_kernel import CORNERS, ENOUGH, RECORD, WORK, flatten_fans, mark_flat, may_cross

SLOTS = 2**21
SIMPLE, PIECES, NO_VERTEX, NOT_USABLE, REPEATED, UNPAIRED, CROSSING, MANY = range(8)
"""What a surface is: the first, or in several pieces that do not cross, or what stands in the way."""

FILED = 32
"""Edges of a vertex that are looked through; of one with more, the rest are in a hash table."""

# Places in the scratch space, in float64.
NORMALS = 9 * GROUP * BLOCKS
FANS = NORMALS + 4 * GROUP * BLOCKS
LANES = FANS + RECORD * (CORNERS // 2 + 8)
TURNS = LANES + 27 * GROUP
PAIRS = TURNS + CORNERS // 2 + 8
NEAR = PAIRS + ENOUGH + GROUP * GROUP + 2 * GROUP
TWO = NEAR + BLOCKS + ENOUGH + 8
SIGNS = TWO + 18 + WORK
FRAME = SIGNS + 8
BOXES = FRAME + 8
GROUPS = BOXES + 6 * GROUP * BLOCKS // 4
HEAPS = GROUPS + 6 * BLOCKS // 4
FLAT = HEAPS + 6 * BLOCKS // 4
NUMBERS = FLAT + 3 * GROUP * BLOCKS // 4
DOUBLES = NUMBERS + (3 * (MOST + GROUP) + 3 * CORNERS + 2 * CORNERS + MOST + SLOTS) // 2 + 8
"""Numbers in the scratch space, of which little more is touched than the surfaces at hand need."""

LARGEST = 1e75  # as `part.LARGEST`
PRIME_X, PRIME_Y, PRIME_Z = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xC2B2AE3D27D4EB4F), np.uint64(0x165667B19E3779F9)


@njit(inline="always")
def slot_of(x, y, z):
    """Return a hash of a point, the same for −0 and +0, and another one for its mirror images."""
    key = bits_of(x + 0.0) * PRIME_X + bits_of(y + 0.0) * PRIME_Y + bits_of(z + 0.0) * PRIME_Z
    return np.int64((key ^ (key >> np.uint64(29))) * PRIME_X >> np.uint64(40))


@njit(inline="always")
def all_distinct(points, places, numbered, slots, room):
    """Say whether corners that are numbered in another mesh are usable points here, no two of them the same."""
    for k in range(room):
        slots[k] = -1
    for k in range(numbered):
        vertex = places[k]
        x, y, z = points[vertex, 0], points[vertex, 1], points[vertex, 2]
        if not (abs(x) <= LARGEST and abs(y) <= LARGEST and abs(z) <= LARGEST):
            return False
        slot = slot_of(x, y, z) & (room - 1)
        while slots[slot] >= 0:
            other = slots[slot]
            if points[other, 0] == x and points[other, 1] == y and points[other, 2] == z:
                return False
            slot = (slot + 1) & (room - 1)
        slots[slot] = vertex
    return True


@njit(inline="always")
def number_corners(points, faces, count, ids, of, places, slots, room):
    """Give equal corners one number, 0 on, and return how many there are, or −1 − what is wrong with one."""
    mask = room - 1
    for k in range(len(ids)):
        ids[k] = -1
    for k in range(room):
        slots[k] = -1
    numbered = 0
    for k in range(count):
        for corner in range(3):
            vertex = faces[k, corner]
            if vertex < 0 or vertex >= len(ids):
                return -1 - NO_VERTEX
            if ids[vertex] < 0:
                x, y, z = points[vertex, 0], points[vertex, 1], points[vertex, 2]
                if not (abs(x) <= LARGEST and abs(y) <= LARGEST and abs(z) <= LARGEST):
                    return -1 - NOT_USABLE
                slot = slot_of(x, y, z) & mask
                while slots[slot] >= 0:
                    other = places[slots[slot]]
                    if points[other, 0] == x and points[other, 1] == y and points[other, 2] == z:
                        break
                    slot = (slot + 1) & mask
                if slots[slot] < 0:
                    slots[slot] = numbered
                    places[numbered] = vertex
                    numbered += 1
                ids[vertex] = slots[slot]
            of[k, corner] = ids[vertex]
    return numbered


@njit(inline="always")
def pair_edges(of, count, numbered, first, edges, parent, slots):
    """Pair every edge with the one other that runs against it, and return what the surface is.

    `first` is the last edge filed under a vertex, the lower of its two; `edges` are (the one filed before it, the
    higher vertex times 2 + the way it runs, the triangle, or −1 once it is paired). Those of a vertex that has as many
    as are looked through are filed in a hash table instead, with the lower vertex in place of the one before.
    """
    for k in range(numbered):
        first[k] = -1
    filed = room = 0
    waiting = 0
    pieces = count
    for k in range(count):
        parent[k] = k
        a, b, c = of[k, 0], of[k, 1], of[k, 2]
        if a == b or b == c or c == a:
            return REPEATED
        for side in range(3):
            tail, head = (a, b) if side == 0 else ((b, c) if side == 1 else (c, a))
            low = np.uint32(min(tail, head))
            this = 2 * max(tail, head) + (1 if tail < head else 0)
            at = first[low]
            passed, slot = 0, np.int64(0)
            while at >= 0 and edges[np.uint32(at), 1] >> 1 != this >> 1:
                at = edges[np.uint32(at), 0]
                passed += 1
            if passed == FILED:
                if room == 0:
                    room = 64
                    while room < 4 * count:
                        room *= 2
                    for j in range(room):
                        slots[j] = -1
                key = (np.uint64(low) * PRIME_X ^ np.uint64(this >> 1) * PRIME_Y) * PRIME_Z
                slot = np.int64(key >> np.uint64(40)) & (room - 1)
                while True:
                    at = slots[slot]
                    if at < 0 or (edges[at, 0] == low and edges[at, 1] >> 1 == this >> 1):
                        break
                    slot = (slot + 1) & (room - 1)
            if at < 0:
                edges[filed, 0], edges[filed, 1], edges[filed, 2] = first[low], this, k
                if passed == FILED:
                    edges[filed, 0] = low
                    slots[slot] = filed
                else:
                    first[low] = filed
                filed += 1
                waiting += 1
                continue
            if edges[np.uint32(at), 1] == this or edges[np.uint32(at), 2] < 0:
                return UNPAIRED
            one, other = np.uint32(edges[np.uint32(at), 2]), np.uint32(k)
            edges[np.uint32(at), 2] = -1
            waiting -= 1
            while np.uint32(parent[one]) != one:
                parent[one] = parent[np.uint32(parent[one])]
                one = np.uint32(parent[one])
            while np.uint32(parent[other]) != other:
                parent[other] = parent[np.uint32(parent[other])]
                other = np.uint32(parent[other])
            if one != other:
                pieces -= 1
                parent[max(one, other)] = min(one, other)
    if waiting:
        return UNPAIRED
    return SIMPLE if pieces == 1 else PIECES


@njit(inline="always")
def fill_corners(points, places, of, count, own):
    """Write the coordinates of all corners, a row each, and more triangles to fill a group."""
    for k in range(-(-count // GROUP) * GROUP):
        for corner in range(3):
            vertex = np.uint64(places[np.uint64(of[min(k, count - 1), corner])])
            for axis in range(3):
                own[block(k), 3 * corner + axis, lane(k)] = points[vertex, axis]


def check_small(vertices_at, vertices, faces_at, faces, table_at, meshes, ids_at, room, scratch, states_at):
    """Say of each of `meshes` surfaces what it is.

    A row of the table is (first vertex, vertices, first face, faces) of a surface, whose faces number its vertices from
    0 on; there is `room` for as many as any has.
    """
    points = carray(vertices_at, (vertices, 3), np.float64)
    corners = carray(faces_at, (faces, 3), np.int64)
    table = carray(table_at, (meshes, 4), np.int64)
    states = carray(states_at, (meshes,), np.int64)
    ids = carray(ids_at, (room,), np.int32)
    own = carray(scratch, (BLOCKS, 9, GROUP), np.float64)
    normals_at, fans_at, lanes_at = (
        address(scratch, 8 * NORMALS),
        address(scratch, 8 * FANS),
        address(scratch, 8 * LANES),
    )
    normals = carray(normals_at, (BLOCKS, 4, GROUP), np.float64)
    turns = carray(address(scratch, 8 * TURNS), (CORNERS // 2,), np.float64)
    pairs = carray(address(scratch, 8 * PAIRS), (ENOUGH + GROUP * GROUP + 2 * GROUP,), np.int64)
    near = carray(address(scratch, 8 * NEAR), (BLOCKS + ENOUGH + 8,), np.int64)
    two, work = (
        carray(address(scratch, 8 * TWO), (2, 9), np.float64),
        carray(address(scratch, 8 * (TWO + 18)), (WORK,), np.float64),
    )
    signs = carray(address(scratch, 8 * SIGNS), (8,), np.int64)
    frame = carray(address(scratch, 8 * FRAME), (2, 3), np.float64)
    boxes_at, groups_at = address(scratch, 8 * BOXES), address(scratch, 8 * GROUPS)
    heaps_at, flat_at = address(scratch, 8 * HEAPS), address(scratch, 8 * FLAT)
    of = carray(address(scratch, 8 * NUMBERS), (MOST + GROUP, 3), np.int32)
    edges = carray(address(scratch, 8 * NUMBERS + 12 * (MOST + GROUP)), (CORNERS, 3), np.int32)
    numbers = carray(address(scratch, 8 * NUMBERS + 12 * (MOST + GROUP + CORNERS)), (7 * MOST + SLOTS,), np.int32)
    places, first = numbers[:CORNERS], numbers[CORNERS : 2 * CORNERS]
    parent, slots = numbers[2 * CORNERS : 2 * CORNERS + MOST], numbers[2 * CORNERS + MOST :]
    before, numbered, distinct, state = -1, 0, False, UNPAIRED
    for mesh in range(meshes):
        start, size, begin, count = table[mesh, 0], table[mesh, 1], table[mesh, 2], table[mesh, 3]
        if count < 1 or count > MOST:
            states[mesh] = MANY
            continue
        capacity = 64
        while capacity < 2 * min(size, 3 * count):
            capacity *= 2
        here, own_faces = points[start : start + size], corners[begin : begin + count]
        # Meshes that share their faces and have no two corners in one place are paired alike.
        alike = before >= 0 and size == table[before, 1] and begin == table[before, 2] and count == table[before, 3]
        alike = all_distinct(here, places, numbered, slots, capacity) if alike and distinct else False
        before = -1
        if not alike:
            numbered = number_corners(here, own_faces, count, ids[:size], of, places, slots, capacity)
            if numbered < 0:
                states[mesh] = -1 - numbered
                continue
            distinct = True
            for k in range(size):
                distinct &= ids[k] < 0 or places[np.uint64(ids[k])] == k
            state = pair_edges(of, count, numbered, first, edges, parent, slots)
        before = mesh
        states[mesh] = state
        if state > PIECES:
            continue
        fill_corners(here, places, of, count, own)
        fill_boxes(here, places, numbered, scratch, boxes_at, groups_at, heaps_at, frame, count)
        if scattered(groups_at, count):
            sort_triangles(boxes_at, of, count, slots, edges)
            fill_corners(here, places, of, count, own)
            fill_boxes(here, places, numbered, scratch, boxes_at, groups_at, heaps_at, frame, count)
            distinct = False
        flatten_fans(scratch, of, count, numbered, normals_at, fans_at, lanes_at, turns)
        mark_flat(of, count, numbered, turns, flat_at)
        slants_at = fans_at  # whose records are read no more
        fill_slants(here, places, numbered, frame, slants_at)
        if may_cross(
            own, normals, of, count, numbered, boxes_at, groups_at, heaps_at, flat_at, slants_at, turns,
            near, pairs, two, signs, work,
        ):  # fmt: skip
            states[mesh] = CROSSING
    return 0
