"""The compiled search for bodies whose surfaces come so near each other that no plane is sure to lie between triangles.

The triangles stand body by body under boxes enclosed two by two (`crossing_kernel.enclose`), descended pair by pair.
Two triangles that do not meet are held apart along one of 17 directions: the two normals, the products of their edges,
and, in one plane, the normals of the edges (the separating axes of S. Gottschalk, M. C. Lin and D. Manocha, "OBBTree",
SIGGRAPH 1996, §5). Which direction is tried need not be exact; that it holds them apart is, with the rounding of the
projections allowed for.

Imported only to be compiled (`inertia.native`); see `touching`.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

ROUNDING = 2.0**-49  # more than a difference, three products and two sums are rounded by
UNDERFLOW = 2.0**-1000


@njit(error_model="numpy", forceinline=True)
def between(own, a, b, x, y, z):
    """Say whether a plane at right angles to (x, y, z) is sure to lie between two triangles."""
    least = greatest = largest = 0.0  # of the first triangle, whose first corner is the origin
    nearest, farthest = np.inf, -np.inf  # of the second
    for k in range(1, 6):
        row, at = (a, 3 * k) if k < 3 else (b, 3 * k - 9)
        p, q, r = x * (own[row, at] - own[a, 0]), y * (own[row, at + 1] - own[a, 1]), z * (own[row, at + 2] - own[a, 2])
        height = p + q + r
        largest = max(largest, abs(p) + abs(q) + abs(r))
        if k < 3:
            least, greatest = min(least, height), max(greatest, height)
        else:
            nearest, farthest = min(nearest, height), max(farthest, height)
    room = 2 * ROUNDING * largest + UNDERFLOW
    return nearest - greatest > room or least - farthest > room


@njit(error_model="numpy", forceinline=True)
def apart(own, a, b, axis):
    """Say whether two triangles are sure not to meet; `axis` is the direction that showed it last, tried first."""
    for turn in range(-1, 17):
        if turn < 0:
            if between(own, a, b, axis[0], axis[1], axis[2]):
                return True
            continue
        # An edge or normal of one, times one of the other: normals have the number 3.
        i, j, one, other = 3, 3, a, b
        if turn == 1:
            one, other = b, a
        elif 1 < turn < 11:
            i, j = (turn - 2) // 3, (turn - 2) % 3
        elif turn > 10:
            j = (turn - 11) % 3
            one = other = a if turn < 14 else b
        ux = uy = uz = vx = vy = vz = 0.0
        for side in range(2):
            row, edge = (one, i) if side == 0 else (other, j)
            p, q = 3 * (edge % 3), 3 * ((edge + 1) % 3)
            x, y, z = own[row, q] - own[row, p], own[row, q + 1] - own[row, p + 1], own[row, q + 2] - own[row, p + 2]
            if edge == 3:
                sx, sy, sz = own[row, 6] - own[row, 0], own[row, 7] - own[row, 1], own[row, 8] - own[row, 2]
                x, y, z = y * sz - z * sy, z * sx - x * sz, x * sy - y * sx
            if side == 0:
                ux, uy, uz = x, y, z
            else:
                vx, vy, vz = x, y, z
        if turn > 1:
            ux, uy, uz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        if between(own, a, b, ux, uy, uz):
            axis[0], axis[1], axis[2] = ux, uy, uz
            return True
    return False


def find_touching(
    own_at, boxes_at, label_at, count, family_at, families, axis_at, stack_at, starts_at, pairs_at, room, state_at
):  # fmt: skip
    """Write pairs of labels of triangles that may meet, until all are written or there is no room for 4 more.

    `label` is that of each triangle in order, ascending; `family`, that of each label, ascending too: only those of one
    family are looked at. `axis` is the direction that held two triangles apart last; `stack` holds (level, one, other)
    still to be opened; the boxes of a level begin at `starts`; `state` is (boxes that wait in pairs, pairs written).
    """
    own = carray(own_at, (count, 9), np.float64)
    boxes = carray(boxes_at, (2 * count + 64, 6), np.float32)
    label = carray(label_at, (count,), np.int64)
    family = carray(family_at, (families,), np.int64)
    stack = carray(stack_at, (256, 3), np.int64)
    starts = carray(starts_at, (64,), np.int64)
    axis = carray(axis_at, (3,), np.float64)
    pairs = carray(pairs_at, (room, 2), np.int64)
    state = carray(state_at, (2,), np.int64)
    waiting = state[0]
    written = 0
    while waiting > 0 and written + 4 <= room:
        waiting -= 1
        level, i, j = stack[waiting, 0], stack[waiting, 1], stack[waiting, 2]
        start = starts[level - 1]
        size = starts[level] - start
        for k in range(3, -1, -1):
            a, b = 2 * i + (k >> 1), 2 * j + (k & 1)
            if a > b or a >= size or b >= size:
                continue
            p, q = start + a, start + b
            if a != b and not (
                boxes[p, 0] <= boxes[q, 3]
                and boxes[q, 0] <= boxes[p, 3]
                and boxes[p, 1] <= boxes[q, 4]
                and boxes[q, 1] <= boxes[p, 4]
                and boxes[p, 2] <= boxes[q, 5]
                and boxes[q, 2] <= boxes[p, 5]
            ):
                continue
            one = label[a << (level - 1)]
            other = label[min(((b + 1) << (level - 1)), count) - 1]
            if one == other or family[label[min((a + 1) << (level - 1), count) - 1]] < family[label[b << (level - 1)]]:
                continue
            if level > 1:
                stack[waiting, 0], stack[waiting, 1], stack[waiting, 2] = level - 1, a, b
                waiting += 1
            elif written > 0 and pairs[written - 1, 0] == one and pairs[written - 1, 1] == other:
                continue
            elif not apart(own, a, b, axis):
                pairs[written, 0], pairs[written, 1] = one, other
                written += 1
    state[0] = waiting
    state[1] = written
    return 0
