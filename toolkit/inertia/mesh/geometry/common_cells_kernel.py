"""The compiled search for triangles in cells of space that triangles of another group are in too; see `common_cells`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.record_kernel import triangle
from inertia.mesh.geometry.shell_kernel import enlarged, most

FAMILY = np.uint64(0x9E3779B97F4A7C15)
SIDE = 4  # cells along a block
FAR, NUMBERS = 2.0**20, (1 << 20) - 1  # cells from the origin, at most; bits of the number of a block along an axis
LINE, EVERY_FOURTH = np.uint64(0xF), np.uint64(0x1111)
IN_ROWS, EVERY_SIXTEENTH, PLANE = np.uint64(0x1111111111111111), np.uint64(0x0001000100010001), np.uint64(0xFFFF)


@njit(error_model="numpy", forceinline=True)
def along(block, first, last):
    """Return which of the four cells of a block along an axis are among some, as bits."""
    low, high = max(first - SIDE * block, 0), min(last - SIDE * block, SIDE - 1)
    return (LINE >> np.uint64(SIDE - 1 - high)) & (LINE << np.uint64(low))


@njit(error_model="numpy", forceinline=True)
def in_rows(part):
    """Return a plane's rows of cells as bits of it."""
    return (part | part << np.uint64(3) | part << np.uint64(6) | part << np.uint64(9)) & EVERY_FOURTH


@njit(error_model="numpy", forceinline=True)
def in_planes(part):
    """Return a block's planes of cells as bits of it."""
    return (part | part << np.uint64(15) | part << np.uint64(30) | part << np.uint64(45)) & EVERY_SIXTEENTH


def enter_cells(
    base, vertices, faces_at, labels_at, count, roles_at, run, few_at, x, y, z, factor,
    groups_at, width, size, family_at, families,
    keys_at, owners_at, cells_at, bits, slots_at, own_at, more_at, parts_at, room_at,
):  # fmt: skip
    """Enter the boxes of runs of triangles, `run` one after another, in the table of cells, group by group.

    The group of a triangle stands in row `role`, column `label` + 1 of a table of `width` columns and `size` numbers.
    Without `vertices`, `few` has a box around each run, whatever the groups of its triangles.

    `keys`, `owners` and `cells` are a table of 2^bits blocks of 4 × 4 × 4 cells, zeros at first: two groups plus one
    that are in the block, and which cells those of the first, of the second, and of all others are in. Keys that are
    equal by chance can only mark more. `slots` and `own` say where a run is that is in one block; of one that is in
    several, or in several groups, `slots` has their number, negative, and `more` and `parts`, from where `room` says,
    where it is in them. `room` has how many blocks may be added, where `more` goes on and where it ends. Returns 1
    where there is no more room, 2 where runs are in too many blocks, or too far off.
    """
    points = carray(base, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    labels, roles = carray(labels_at, (count,), np.int32), carray(roles_at, (count,), np.uint8)
    groups = carray(groups_at, (size,), np.int64)
    family = carray(family_at, (families,), np.int64)
    keys, owners = carray(keys_at, (1 << bits,), np.uint64), carray(owners_at, (1 << bits, 2), np.int32)
    cells = carray(cells_at, (1 << bits, 3), np.uint64)
    runs = (count + run - 1) // run
    few = carray(few_at, (runs, 6), np.float32)
    slots, own = carray(slots_at, (runs,), np.int32), carray(own_at, (runs,), np.uint64)
    room = carray(room_at, (3,), np.int64)
    more, parts = carray(more_at, (room[2],), np.int32), carray(parts_at, (room[2],), np.uint64)
    none, final = np.uint64(0), np.int64((1 << bits) - 1)
    slot, last, at = np.int64(0), none, room[1]
    label, role, number, salt = np.int32(-2), np.uint8(0), np.int32(0), none
    for n in range(runs):
        k, stop = n * run, min((n + 1) * run, count)
        slots[n] = 0
        while k < stop:
            if labels[k] != label or roles[k] != role:  # triangles of a group mostly follow one another
                label, role = labels[k], roles[k]
                group = groups[role * width + label + 1]
                number, salt = np.int32(group + 1), np.uint64(family[group] + 1) * FAMILY
            begin = k
            if vertices == 0:
                lx, ly, lz = np.float64(few[n, 0]), np.float64(few[n, 1]), np.float64(few[n, 2])
                hx, hy, hz = np.float64(few[n, 3]), np.float64(few[n, 4]), np.float64(few[n, 5])
                while k < stop and labels[k] == label and roles[k] == role:
                    k += 1
            else:
                a, _, _ = triangle(base, points, faces, vertices < 0, k)
                box = a[0], a[1], a[2], a[0], a[1], a[2]
                while k < stop and labels[k] == label and roles[k] == role:
                    a, b, c = triangle(base, points, faces, vertices < 0, k)
                    box = enlarged(box, a, b, c)
                    k += 1
                lx, ly, lz, hx, hy, hz = box
            lx, hx, ly, hy, lz, hz = lx - x, hx - x, ly - y, hy - y, lz - z, hz - z
            far = most(most(-lx, -ly, -lz, -lz), hx, hy, hz) * factor
            if not far < FAR:
                return 2
            a, b = np.int64(lx * factor + FAR), np.int64(hx * factor + FAR)
            c, d = np.int64(ly * factor + FAR), np.int64(hy * factor + FAR)
            e, f = np.int64(lz * factor + FAR), np.int64(hz * factor + FAR)
            blocks = ((b >> 2) - (a >> 2) + 1) * ((d >> 2) - (c >> 2) + 1) * ((f >> 2) - (e >> 2) + 1)
            alone = blocks == 1 and k - begin == stop - n * run
            if not alone:
                if at + blocks > room[2]:
                    return 2
                slots[n] -= blocks
            for p in range(a >> 2, (b >> 2) + 1):
                rows = along(p, a, b) * IN_ROWS
                for q in range(c >> 2, (d >> 2) + 1):
                    both = rows & (in_rows(along(q, c, d)) * LINE * EVERY_SIXTEENTH)
                    for r in range(e >> 2, (f >> 2) + 1):
                        part = both & (in_planes(along(r, e, f)) * PLANE)
                        key = salt + np.uint64((p & NUMBERS) | (q & NUMBERS) << 20 | (r & NUMBERS) << 40)
                        key += np.uint64(key == none)
                        if key != last:
                            last = key
                            slot = np.int64((key ^ key >> np.uint64(32)) * FAMILY >> np.uint64(64 - bits))
                            while keys[slot] != key and keys[slot] != none:
                                slot = (slot + 1) & final
                            if keys[slot] == none:
                                if room[0] == 0:
                                    return 1
                                room[0] -= 1
                                keys[slot], owners[slot, 0] = key, number
                        if owners[slot, 0] == number:
                            cells[slot, 0] |= part
                        elif owners[slot, 1] == number or owners[slot, 1] == 0:
                            owners[slot, 1] = number
                            cells[slot, 1] |= part
                        else:
                            cells[slot, 2] |= part
                        if alone:
                            slots[n], own[n] = slot, part
                        else:
                            more[at], parts[at] = slot, part
                            at += 1
    room[1] = at
    return 0


def mark_common(cells_at, bits, slots_at, own_at, runs, more_at, parts_at, entries, near_at):
    """Mark the runs in cells that triangles of several groups may be in; for the arguments see `enter_cells`."""
    cells = carray(cells_at, (1 << bits, 3), np.uint64)
    slots, own = carray(slots_at, (runs,), np.int32), carray(own_at, (runs,), np.uint64)
    more, parts = carray(more_at, (entries,), np.int32), carray(parts_at, (entries,), np.uint64)
    near = carray(near_at, (runs,), np.uint8)
    for block in range(1 << bits):
        cells[block, 0] = cells[block, 0] & cells[block, 1] | cells[block, 2]
    at = 0
    for k in range(runs):
        if slots[k] >= 0:
            found = own[k] & cells[slots[k], 0]
        else:
            found = np.uint64(0)
            for _ in range(-slots[k]):
                found |= parts[at] & cells[more[at], 0]
                at += 1
        near[k] = found != np.uint64(0)
    return 0
