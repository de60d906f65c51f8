"""The compiled clipping of pairs of triangles over one another, for the volume under both; see `common_volume`.

The steps, their order and what each rounds are those of `common_volume.clipped_pairs` in numpy, so that the polygons
are the same bits: a polygon with fewer corners than another of its table has the last one again, which counts as one.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

MOST = 12
"""Corners of a polygon: three of a triangle, one more for each of five cuts, and repeated ones."""


@njit(error_model="numpy", forceinline=True)
def cut(source, row, size, width, scratch, target, place):
    """Write the part of a polygon where a linear function is not negative; return how many corners that has.

    `scratch[0]` is the function at the first `size` corners; more than `MOST` are counted and not written.
    """
    count = 0
    for m in range(width):
        at, then = min(m, size - 1), min(m + 1, size - 1) if m + 1 < width else 0
        side, after = scratch[0, at], scratch[0, then]
        inside = side >= 0
        if inside:
            if count < MOST:
                for c in range(3):
                    target[place, count, c] = source[row, at, c]
            count += 1
        if inside != (after >= 0):
            share = side / (side - after)
            if count < MOST:
                for c in range(3):
                    target[place, count, c] = source[row, at, c] + share * (source[row, then, c] - source[row, at, c])
            count += 1
    return count


@njit(error_model="numpy", forceinline=True)
def turn(corners, k):
    """Let a triangle face up, and return the sign of how it faced; 0 of an upright one."""
    ux, uy = corners[k, 1, 0] - corners[k, 0, 0], corners[k, 1, 1] - corners[k, 0, 1]
    vx, vy = corners[k, 2, 0] - corners[k, 0, 0], corners[k, 2, 1] - corners[k, 0, 1]
    area = ux * vy - uy * vx
    if area < 0:
        for c in range(3):
            corners[k, 0, c], corners[k, 2, c] = corners[k, 2, c], corners[k, 0, c]
        return -1.0
    return 1.0 if area > 0 else 0.0


def clip_pairs(a_at, b_at, count, signs_at, polygons_at, sizes_at, which_at, lower_at, lowest_at, scratch_at, state_at):
    """Cut triangles `a` to those of `b` over one another, and then to where `a` is the lower one, and where `b` is.

    `polygons`, `lower` hold x, y and the height of the lower one, `which` the pairs of both tables; `state` is
    (rows and width of `polygons`, the same of `lower`), the first −1 where a polygon has more than `MOST` corners.
    Both triangles of a pair are turned up in place.
    """
    a = carray(a_at, (count, 3, 3), np.float64)
    b = carray(b_at, (count, 3, 3), np.float64)
    signs = carray(signs_at, (count,), np.float64)
    polygons = carray(polygons_at, (count + 1, MOST, 3), np.float64)
    lower = carray(lower_at, (count + 1, MOST, 3), np.float64)
    sizes = carray(sizes_at, (count,), np.int64)
    which = carray(which_at, (count,), np.int64)
    lowest = carray(lowest_at, (count,), np.int64)
    scratch = carray(scratch_at, (2, MOST), np.float64)
    state = carray(state_at, (4,), np.int64)
    state[0] = -1
    rows, width = count, 3
    for k in range(count):
        signs[k] = turn(a, k) * turn(b, k)
        which[k] = k
        sizes[k] = 3
        for m in range(3):
            for c in range(3):
                polygons[k, m, c] = a[k, m, c]
    for edge in range(3):
        kept, widest = 0, 0
        for row in range(rows):
            k, size = which[row], sizes[row]
            following = (edge + 1) % 3
            x, y = b[k, edge, 0], b[k, edge, 1]
            along_x, along_y = b[k, following, 0] - x, b[k, following, 1] - y
            for m in range(size):
                scratch[0, m] = along_x * (polygons[row, m, 1] - y) - along_y * (polygons[row, m, 0] - x)
            corners = cut(polygons, row, size, width, scratch, polygons, count)
            widest = max(widest, corners)
            if corners > MOST:
                return 0
            if corners > 2:
                for m in range(corners):
                    for c in range(3):
                        polygons[kept, m, c] = polygons[count, m, c]
                which[kept], sizes[kept] = k, corners
                kept += 1
        rows, width = kept, widest
        if rows == 0:
            break
    above = tall = 0
    kept = widest = 0
    for row in range(rows):
        k, size = which[row], sizes[row]
        x, y, z = b[k, 0, 0], b[k, 0, 1], b[k, 0, 2]
        ux, uy, uz = b[k, 1, 0] - x, b[k, 1, 1] - y, b[k, 1, 2] - z
        vx, vy, vz = b[k, 2, 0] - x, b[k, 2, 1] - y, b[k, 2, 2] - z
        area = ux * vy - uy * vx
        least, greatest = min(z, b[k, 1, 2], b[k, 2, 2]), max(z, b[k, 1, 2], b[k, 2, 2])
        apart = False
        for m in range(size):
            way_x, way_y = polygons[row, m, 0] - x, polygons[row, m, 1] - y
            rise = (way_x * vy - way_y * vx) * uz + (ux * way_y - uy * way_x) * vz
            height = z + (rise / area if area != 0 else 0.0)
            scratch[1, m] = min(max(height, least), greatest)
            scratch[0, m] = scratch[1, m] - polygons[row, m, 2]
            apart = apart or scratch[0, m] < 0
        if apart:
            for m in range(size):
                own = polygons[row, m, 2]
                scratch[0, m] = -scratch[0, m]
                polygons[row, m, 2] = scratch[1, m]
                scratch[1, m] = own
            corners = cut(polygons, row, size, width, scratch, lower, above)
            tall = max(tall, corners)
            if corners > MOST:
                return 0
            if corners > 2:
                for m in range(corners, MOST):
                    for c in range(3):
                        lower[above, m, c] = lower[above, corners - 1, c]
                lowest[above] = k
                above += 1
            for m in range(size):
                scratch[0, m] = -scratch[0, m]
                polygons[row, m, 2] = scratch[1, m]
        corners = cut(polygons, row, size, width, scratch, polygons, count)
        widest = max(widest, corners)
        if corners > MOST:
            return 0
        if corners > 2:
            for m in range(MOST):
                for c in range(3):
                    polygons[kept, m, c] = polygons[count, min(m, corners - 1), c]
            which[kept] = k
            kept += 1
    state[0], state[1], state[2], state[3] = kept, widest, above, tall
    return 0
