"""The compiled search for triangles in cells of space that triangles of another group are in too; see `common_cells`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

FAMILY = np.uint64(0x9E3779B97F4A7C15)
SIDE = 4  # cells along a block
FAR, NUMBERS = 2.0**20, (1 << 20) - 1  # cells from the origin, at most; bits of the number of a block along an axis
LINE, EVERY_FOURTH = np.uint64(0xF), np.uint64(0x1111)
IN_ROWS, EVERY_SIXTEENTH, PLANE = np.uint64(0x1111111111111111), np.uint64(0x0001000100010001), np.uint64(0xFFFF)


@njit(error_model="numpy", forceinline=True)
def cells_of(points, faces, k, axis, origin, factor):
    """Return the first and the last cell of a triangle along an axis: that of no point of it is outside them."""
    a, b, c = points[faces[k, 0], axis], points[faces[k, 1], axis], points[faces[k, 2], axis]
    low, high = (min(a, b, c) - origin) * factor, (max(a, b, c) - origin) * factor
    return np.int64(np.floor(low)), np.int64(np.floor(high)), max(-low, high)


@njit(error_model="numpy", forceinline=True)
def along(block, first, last):
    """Return which of the four cells of a block along an axis are among some, as bits."""
    low, high = max(first - SIDE * block, 0), min(last - SIDE * block, SIDE - 1)
    return (LINE >> np.uint64(SIDE - 1 - high)) & (LINE << np.uint64(low))


def enter_cells(
    vertices_at, vertices, faces_at, group_at, count, x, y, z, factor, family_at, families,
    keys_at, owners_at, cells_at, bits, slots_at, own_at, near_at, state_at, again,
):  # fmt: skip
    """Enter triangles in the table of cells, or, `again`, mark those in cells that others of their family may be in.

    `keys`, `owners` and `cells` are a table of 2^bits blocks of 4 × 4 × 4 cells, zeros at first: two groups plus one
    that have triangles in the block, and which cells those of the first, of the second, and of all others are in. Keys
    that are equal by chance can only mark more. `slots` and `own` say where a triangle in one block is. `state` has how
    many blocks there is room for, and how many triangles may be in. Returns 1 where there is no more room, 2 where
    triangles are in too many blocks, or too far off.
    """
    points = carray(vertices_at, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    group = carray(group_at, (count,), np.int64)
    family = carray(family_at, (families,), np.int64)
    keys, owners = carray(keys_at, (1 << bits,), np.uint64), carray(owners_at, (1 << bits, 2), np.int32)
    cells = carray(cells_at, (1 << bits, 3), np.uint64)
    slots, own = carray(slots_at, (count,), np.int32), carray(own_at, (count,), np.uint64)
    near, state = carray(near_at, (count,), np.uint8), carray(state_at, (2,), np.int64)
    none, most = np.uint64(0), np.int64((1 << bits) - 1)
    slot, last = np.int64(0), none
    for k in range(count):
        if again and slots[k] >= 0:
            near[k] = (own[k] & cells[slots[k], 0]) != none
            continue
        number = np.int32(group[k] + 1)
        salt = np.uint64(family[group[k]] + 1) * FAMILY
        a, b, far = cells_of(points, faces, k, 0, x, factor)
        c, d, farther = cells_of(points, faces, k, 1, y, factor)
        e, f, farthest = cells_of(points, faces, k, 2, z, factor)
        if not max(far, farther, farthest) < FAR:
            return 2
        blocks = ((b >> 2) - (a >> 2) + 1) * ((d >> 2) - (c >> 2) + 1) * ((f >> 2) - (e >> 2) + 1)
        state[1] -= blocks
        if state[1] < 0:
            return 2
        found = none
        for p in range(a >> 2, (b >> 2) + 1):
            rows = along(p, a, b) * IN_ROWS
            for q in range(c >> 2, (d >> 2) + 1):
                part = along(q, c, d)
                part = (part | part << np.uint64(3) | part << np.uint64(6) | part << np.uint64(9)) & EVERY_FOURTH
                both = rows & (part * LINE * EVERY_SIXTEENTH)
                for r in range(e >> 2, (f >> 2) + 1):
                    part = along(r, e, f)
                    part |= part << np.uint64(15) | part << np.uint64(30) | part << np.uint64(45)
                    part = both & ((part & EVERY_SIXTEENTH) * PLANE)
                    key = salt + np.uint64((p & NUMBERS) | (q & NUMBERS) << 20 | (r & NUMBERS) << 40)
                    key += np.uint64(key == none)
                    if key != last:
                        last = key
                        slot = np.int64((key ^ key >> np.uint64(32)) * FAMILY >> np.uint64(64 - bits))
                        while keys[slot] != key and keys[slot] != none:
                            slot = (slot + 1) & most
                        if keys[slot] == none:
                            if state[0] == 0:
                                return 1
                            state[0] -= 1
                            keys[slot], owners[slot, 0] = key, number
                    if again:
                        found |= part & cells[slot, 0]
                    elif owners[slot, 0] == number:
                        cells[slot, 0] |= part
                    elif owners[slot, 1] == number or owners[slot, 1] == 0:
                        owners[slot, 1] = number
                        cells[slot, 1] |= part
                    else:
                        cells[slot, 2] |= part
                    own[k] = part
        if again:
            near[k] = found != none
        else:
            slots[k] = slot if blocks == 1 else -1
    return 0


def find_common(cells_at, bits):
    """Leave of each block the cells that triangles of several groups may be in."""
    cells = carray(cells_at, (1 << bits, 3), np.uint64)
    for block in range(1 << bits):
        cells[block, 0] = cells[block, 0] & cells[block, 1] | cells[block, 2]
    return 0
