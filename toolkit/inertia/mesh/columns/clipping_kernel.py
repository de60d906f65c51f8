"""The compiled sum over pairs of triangles over one another, for the volume under both; see `common_volume`.

The steps are those of `common_volume._clipped_pairs` in numpy, pair by pair.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

MOST = 24
"""Corners of a polygon, at most: each of five cuts of a triangle makes three of two, however signs are rounded."""


@njit(error_model="numpy", forceinline=True)
def cut(work, source, size, target):
    """Write the part of a polygon where a linear function is not negative; return how many corners that has.

    `work[0]` holds x, y, z and the function at the corners of the polygon `source`.
    """
    count = 0
    for m in range(size):
        then = m + 1 if m + 1 < size else 0
        side, after = work[source, m, 3], work[source, then, 3]
        inside = side >= 0
        if inside:
            for c in range(3):
                work[target, count, c] = work[source, m, c]
            count += 1
        if inside != (after >= 0):
            share = side / (side - after)
            for c in range(3):
                work[target, count, c] = work[source, m, c] + share * (work[source, then, c] - work[source, m, c])
            count += 1
    return count


@njit(error_model="numpy", forceinline=True)
def facing(corners, k):
    """Return the sign of how a triangle faces along z; 0 of an upright one."""
    ux, uy = corners[k, 1, 0] - corners[k, 0, 0], corners[k, 1, 1] - corners[k, 0, 1]
    vx, vy = corners[k, 2, 0] - corners[k, 0, 0], corners[k, 2, 1] - corners[k, 0, 1]
    area = ux * vy - uy * vx
    return -1.0 if area < 0 else (1.0 if area > 0 else 0.0)


@njit(error_model="numpy", forceinline=True)
def under(work, polygon, size, spare):
    """Return the integral of z⁺ over a convex polygon."""
    lowest = 0.0
    for m in range(size):
        work[polygon, m, 3] = work[polygon, m, 2]
        lowest = min(lowest, work[polygon, m, 2])
    if lowest < 0:
        size, polygon = cut(work, polygon, size, spare), spare
    x, y, z = work[polygon, 0, 0], work[polygon, 0, 1], work[polygon, 0, 2]
    total = 0.0
    for m in range(2, size):
        ux, uy = work[polygon, m - 1, 0] - x, work[polygon, m - 1, 1] - y
        vx, vy = work[polygon, m, 0] - x, work[polygon, m, 1] - y
        total += 0.5 * (ux * vy - uy * vx) * ((z + work[polygon, m - 1, 2] + work[polygon, m, 2]) / 3)
    return total


def sum_pairs(one_at, ones, other_at, others, first_at, second_at, count, work_at, sums_at):
    """Add Σ s_a s_b ∫∫ min(z_a⁺, z_b⁺) over pairs of triangles, and what bounds its rounding, to sums.

    The pairs are `first`, `second`; `sums` is (the volume, what rounding took from its sum, the bound over the largest
    coordinate and the rounding of one step).
    """
    one = carray(one_at, (ones, 3, 3), np.float64)
    other = carray(other_at, (others, 3, 3), np.float64)
    first = carray(first_at, (count,), np.int64)
    second = carray(second_at, (count,), np.int64)
    work = carray(work_at, (4, MOST, 4), np.float64)
    sums = carray(sums_at, (3,), np.float64)
    volume, lost, bound = sums[0], sums[1], sums[2]
    for k in range(count):
        i, j = first[k], second[k]
        breadth, height = 0.0, np.inf
        for c in range(3):
            low = max(
                min(one[i, 0, c], one[i, 1, c], one[i, 2, c]), min(other[j, 0, c], other[j, 1, c], other[j, 2, c])
            )
            high = min(
                max(one[i, 0, c], one[i, 1, c], one[i, 2, c]), max(other[j, 0, c], other[j, 1, c], other[j, 2, c])
            )
            if c < 2:
                breadth += high - low
            else:
                height = high
        bound += breadth * (height + breadth)
        up, above = facing(one, i), facing(other, j)
        sign = up * above
        if sign == 0:
            continue
        for m in range(3):
            corner = 2 - m if up < 0 else m
            for c in range(3):
                work[0, m, c] = one[i, corner, c]
        start, then, last = (2, 1, 0) if above < 0 else (0, 1, 2)
        now, size = 0, 3
        for edge in range(3):
            p, q = (start, then) if edge == 0 else ((then, last) if edge == 1 else (last, start))
            x, y = other[j, p, 0], other[j, p, 1]
            along_x, along_y = other[j, q, 0] - x, other[j, q, 1] - y
            for m in range(size):
                work[now, m, 3] = along_x * (work[now, m, 1] - y) - along_y * (work[now, m, 0] - x)
            size, now = cut(work, now, size, 1 - now), 1 - now
            if size < 3:
                break
        if size < 3:
            continue
        x, y, z = other[j, start, 0], other[j, start, 1], other[j, start, 2]
        ux, uy, uz = other[j, then, 0] - x, other[j, then, 1] - y, other[j, then, 2] - z
        vx, vy, vz = other[j, last, 0] - x, other[j, last, 1] - y, other[j, last, 2] - z
        area = ux * vy - uy * vx
        least, greatest = min(z, other[j, then, 2], other[j, last, 2]), max(z, other[j, then, 2], other[j, last, 2])
        nearer, apart = 2, False
        for m in range(size):
            way_x, way_y = work[now, m, 0] - x, work[now, m, 1] - y
            rise = (way_x * vy - way_y * vx) * uz + (ux * way_y - uy * way_x) * vz
            level = min(max(z + (rise / area if area != 0 else 0.0), least), greatest)
            side = level - work[now, m, 2]
            apart = apart or side < 0
            work[nearer, m, 0], work[nearer, m, 1], work[nearer, m, 2] = work[now, m, 0], work[now, m, 1], level
            work[now, m, 3], work[nearer, m, 3] = side, -side
        term = 0.0
        if apart:
            term += under(work, 3, cut(work, nearer, size, 3), 2)
        term += under(work, 1 - now, cut(work, now, size, 1 - now), 3)
        term *= sign
        together = volume + term
        lost += (volume - together) + term if abs(volume) >= abs(term) else (term - together) + volume
        volume = together
    sums[0], sums[1], sums[2] = volume, lost, bound
    return 0
