"""The compiled sorting of triangles around the edges that they have in common; `edge_fans` says what it is for.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import math

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.crossing_kernel import TERMS, UNSURE, exact_sign, orient

MOST = 64
"""Triangles around an edge, at most."""

LARGEST, SMALLEST = 2.0**300, 2.0**-300
"""Of coordinates, and of the lengths of sides: products of three are normal numbers."""

TELLING = 1e-12  # as in `edge_fans`
X, Y, Z, HEIGHT, BLUR, ANGLE, ROWS = 0, 1, 2, 3, 4, 5, 6
"""Rows of `room`: the unit normal of each triangle, its height, its blur in last digits, its angle."""

PLACE, QUARTER, WHOSE, LISTS = 0, 1, 2, 3
"""Rows of `list`: which triangle is where in order; of each triangle the quarter, and its directed edge."""


@njit(error_model="numpy", forceinline=True)
def side(own, one, other, work):
    """Return on which side of one triangle's half-plane that of another lies, or `UNSURE`."""
    sign = orient(own, 0, 0, 0, 1, one + 1, 0, other + 1, 0)
    return exact_sign(own, 0, 0, 0, 1, one + 1, 0, other + 1, 0, work) if sign == UNSURE else sign


@njit(error_model="numpy", forceinline=True)
def precedes(own, one, i, other, j):
    """Say whether a point comes before another in the order of their coordinates."""
    for axis in range(3):
        a, b = own[one, 3 * i + axis], own[other, 3 * j + axis]
        if a != b:
            return a < b
    return False


@njit(error_model="numpy", forceinline=True)
def measured(own, room, k):
    """Write the unit normal, the height and the blur of a triangle; say whether floating point is sure of them."""
    ax, ay, az = own[0, 3] - own[0, 0], own[0, 4] - own[0, 1], own[0, 5] - own[0, 2]
    bx, by, bz = own[k + 1, 0] - own[0, 0], own[k + 1, 1] - own[0, 1], own[k + 1, 2] - own[0, 2]
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    square = ax * ax + ay * ay + az * az
    size, base, arm = np.sqrt(x * x + y * y + z * z), np.sqrt(square), np.sqrt(bx * bx + by * by + bz * bz)
    if not (base > SMALLEST and arm > SMALLEST and size > TELLING * base * arm):
        return False
    room[X, k], room[Y, k], room[Z, k], room[HEIGHT, k] = x / size, y / size, z / size, size / base
    share = (ax * bx + ay * by + az * bz) / square
    room[BLUR, k] = (1 + abs(share) + abs(1 - share)) / room[HEIGHT, k]
    return True


@njit(error_model="numpy", forceinline=True)
def turned(own, room, lists, k, sign):
    """Write the quarter and the angle of a triangle, from the first one on; see `edge_fans`."""
    px, py, pz, x, y, z = room[X, 0], room[Y, 0], room[Z, 0], room[X, k], room[Y, k], room[Z, k]
    cosine = px * x + py * y + pz * z
    if sign == 0:
        quarter = 0 if cosine > 0 else 2
        room[ANGLE, k] = 0.0 if quarter == 0 else np.pi
    else:
        ax, ay, az = own[0, 3] - own[0, 0], own[0, 4] - own[0, 1], own[0, 5] - own[0, 2]
        sine = ax * (py * z - pz * y) + ay * (pz * x - px * z) + az * (px * y - py * x)
        angle = math.atan2(sine / np.sqrt(ax * ax + ay * ay + az * az), cosine)
        quarter = 1 if sign > 0 else 3
        # Rounding may take an angle across the first one: a full turn off.
        angle -= 2 * np.pi * np.floor((angle - quarter * np.pi / 2) / (2 * np.pi) + 0.5)
        room[ANGLE, k] = min(max(angle, 0.0 if sign > 0 else np.pi), np.pi if sign > 0 else 2 * np.pi)
    lists[QUARTER, k] = quarter


@njit(error_model="numpy", forceinline=True)
def in_order(own, room, lists, count, work):
    """Sort triangles by their angles, exactly; return whether that could be done."""
    for k in range(count):
        at = k
        quarter, angle = lists[QUARTER, k], room[ANGLE, k]
        while at > 0:
            before = lists[PLACE, at - 1]
            if lists[QUARTER, before] < quarter:
                break
            if lists[QUARTER, before] == quarter and room[ANGLE, before] <= angle:
                break
            lists[PLACE, at] = before
            at -= 1
        lists[PLACE, at] = k
    for k in range(1, count):
        at = k
        while at > 0:
            one, other = lists[PLACE, at - 1], lists[PLACE, at]
            if lists[QUARTER, one] != lists[QUARTER, other] or lists[QUARTER, one] % 2 == 0:
                break
            sign = side(own, one, other, work)
            if sign == UNSURE:
                return False
            if sign >= 0:
                break
            lists[PLACE, at - 1], lists[PLACE, at] = other, one
            at -= 1
    return True


@njit(error_model="numpy", forceinline=True)
def gathered(points, corners, half_edge, first, count, own, lists, extent):
    """Bring the triangles of an edge in the order of their third corners; say whether all coordinates are in range."""
    h = half_edge[first]
    tail, head = corners[h], corners[h // 3 * 3 + (h + 1) % 3]
    for axis in range(3):
        own[0, axis], own[0, 3 + axis] = points[tail, axis], points[head, axis]
    low = tail
    if precedes(own, 0, 1, 0, 0):
        low = head
        for axis in range(3):
            own[0, axis], own[0, 3 + axis] = own[0, 3 + axis], own[0, axis]
    for k in range(count):
        h = half_edge[first + k]
        apex, at = corners[h // 3 * 3 + (h + 2) % 3], k
        for axis in range(3):
            own[count + 1, axis] = points[apex, axis]
        while at > 0 and precedes(own, count + 1, 0, at, 0):
            for axis in range(3):
                own[at + 1, axis] = own[at, axis]
            lists[WHOSE, at] = lists[WHOSE, at - 1]
            at -= 1
        for axis in range(3):
            own[at + 1, axis] = points[apex, axis]
        lists[WHOSE, at] = 2 * h + (corners[h] != low)
    largest, single = 0.0, 1.0
    for k in range(count + 2):
        for axis in range(3):
            value = own[0, 3 + axis] if k > count else own[k, axis]
            largest = max(largest, abs(value))
            if np.float64(np.float32(value)) != value:
                single = 0.0
    extent[0], extent[1] = largest, single
    return largest <= LARGEST


def sort_fans(
    vertices_at, vertices, faces_at, faces, half_edge_at, starts_at, groups, own_at, room_at, lists_at, work_at,
    extent_at, sorted_at, plane_at, angle_at, height_at, blur_at, counts_at, state_at,
):  # fmt: skip
    """Sort the directed edges of each group, `starts` (groups + 1,), by the angles of their triangles.

    Writes, one group after the other, twice the number of each directed edge, and one more where material begins behind
    it; which half-plane of all it is in; its angle, its height and its blur over the last digit of the coordinates.
    `counts` (groups,) is how many a group has, −1 where it is left out: there are many, a triangle may have no area, or
    floating point and exact sums of normal numbers do not decide. `state` (2,) becomes the largest coordinate, and 1
    where all are numbers of float32.
    """
    points = carray(vertices_at, (vertices, 3), np.float64)
    corners, half_edge = carray(faces_at, (3 * faces,), np.int64), carray(half_edge_at, (1 << 40,), np.int64)
    starts, counts = carray(starts_at, (groups + 1,), np.int64), carray(counts_at, (groups,), np.int64)
    own, room = carray(own_at, (MOST + 2, 9), np.float64), carray(room_at, (ROWS, MOST), np.float64)
    lists, work = carray(lists_at, (LISTS, MOST), np.int64), carray(work_at, (18 + TERMS,), np.float64)
    extent, state = carray(extent_at, (2,), np.float64), carray(state_at, (2,), np.float64)
    ordered, plane = carray(sorted_at, (1 << 40,), np.int64), carray(plane_at, (1 << 40,), np.int64)
    angle, height = carray(angle_at, (1 << 40,), np.float64), carray(height_at, (1 << 40,), np.float64)
    blur = carray(blur_at, (1 << 40,), np.float64)
    state[0], state[1] = 0.0, 1.0
    written, planes = 0, -1
    for group in range(groups):
        first, count = starts[group], starts[group + 1] - starts[group]
        counts[group] = -1
        if count > MOST or not gathered(points, corners, half_edge, first, count, own, lists, extent):
            continue
        fine = True
        for k in range(count):
            fine = fine and measured(own, room, k)
        for k in range(count):
            sign = 0
            if fine and k > 0:
                sign = side(own, 0, k, work)
                fine = sign != UNSURE
            if fine:
                turned(own, room, lists, k, sign)
        if not fine or not in_order(own, room, lists, count, work):
            continue
        begin = 0
        while begin < count:
            end = begin + 1
            while end < count:
                one, other = lists[PLACE, end - 1], lists[PLACE, end]
                if lists[QUARTER, one] != lists[QUARTER, other]:
                    break
                if lists[QUARTER, one] % 2 == 1 and side(own, one, other, work) != 0:
                    break
                end += 1
            planes += 1
            # In one half-plane, what ends comes before what begins: bodies that touch there stay apart.
            for opens in range(2):
                for at in range(begin, end):
                    k = lists[PLACE, at]
                    if lists[WHOSE, k] % 2 == opens:
                        ordered[written], plane[written], angle[written] = lists[WHOSE, k], planes, room[ANGLE, k]
                        height[written], blur[written] = room[HEIGHT, k], room[BLUR, k]
                        written += 1
            begin = end
        counts[group] = count
        state[0], state[1] = max(state[0], extent[0]), min(state[1], extent[1])
    return 0
