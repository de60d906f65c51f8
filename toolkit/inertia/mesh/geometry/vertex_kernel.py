"""The compiled numbering of different points, by a table of those that there were already; see `faces`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.box_kernel import bits_of

PRIMES = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xC2B2AE3D27D4EB4F), np.uint64(0x165667B19E3779F9)
AHEAD = 32
"""Corners whose places in the table are asked for together, as memory is slow to answer."""


@njit(error_model="numpy", forceinline=True)
def slot_of(points, vertex, bits):
    """Return a place in a table of 2^bits for a point, the same for −0 and +0."""
    key = np.uint64(0)
    for axis in range(3):
        key += bits_of(points[vertex, axis] + 0.0) * PRIMES[axis]
    return np.int64((key ^ key >> np.uint64(29)) * PRIMES[0] >> np.uint64(64 - bits))


def number_vertices(
    points_at, points_count, corners_at, count, shared, ids_at, slots_at, bits, ahead_at, numbers_at, places_at
):
    """Number points in the order in which corners first have them, and return how many there are.

    Corner k is point `corners[k]` of `shared` ones, which have −1 in `ids`, else point k. In the table of `slots`, −1
    at first, is the number of a point, in `places` which point that is. Returns −1 where a corner names none.
    """
    points = carray(points_at, (points_count, 3), np.float64)
    corners, ids = carray(corners_at, (count,), np.int64), carray(ids_at, (points_count,), np.int32)
    slots, ahead = carray(slots_at, (1 << bits,), np.int32), carray(ahead_at, (AHEAD,), np.int64)
    numbers, places = carray(numbers_at, (count,), np.int64), carray(places_at, (points_count,), np.int64)
    mask, numbered, seen = (1 << bits) - 1, 0, 0
    for start in range(0, count, AHEAD):
        stop = min(start + AHEAD, count)
        for k in range(start, stop):
            vertex = corners[k] if shared else k
            if vertex < 0 or vertex >= points_count:
                return -1
            ahead[k - start] = slot_of(points, vertex, bits)
            seen += slots[ahead[k - start]]
        for k in range(start, stop):
            vertex = corners[k] if shared else k
            if shared and ids[vertex] >= 0:
                numbers[k] = ids[vertex]
                continue
            slot = ahead[k - start]
            while slots[slot] >= 0:
                other = places[slots[slot]]
                same = points[other, 0] == points[vertex, 0] and points[other, 1] == points[vertex, 1]
                if same and points[other, 2] == points[vertex, 2]:
                    break
                slot = (slot + 1) & mask
            if slots[slot] < 0:
                slots[slot], places[numbered] = numbered, vertex
                numbered += 1
            numbers[k] = slots[slot]
            if shared:
                ids[vertex] = numbers[k]
    ahead[0] = seen  # so that the reads ahead are not left out
    return numbered
