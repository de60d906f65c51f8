"""The compiled sum of what triangles add to the winding numbers of points.

Imported only to be compiled (`inertia.native`); see `winding`, which does the same by numpy.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit


@njit(error_model="numpy", forceinline=True)
def turned(ax, ay, bx, by):
    """Return the crossing of the positive x axis by an edge a→b in the xy plane: 1 upwards, −1 downwards."""
    side = ax * by - ay * bx
    if ay <= 0 and by > 0 and side > 0:
        return 1
    if by <= 0 and ay > 0 and side < 0:
        return -1
    return 0


@njit(error_model="numpy", forceinline=True)
def reach(a, b, c, margin):
    """Return from where to where coordinates of three corners reach."""
    return min(a, b, c) - margin, max(a, b, c) + margin


def wind(points_at, count, corners_at, triangles, margin, winding_at, clearance_at):
    """Add to the winding numbers of points, ascending along x, and lessen their clearances."""
    points = carray(points_at, (count, 3), np.float64)
    corners = carray(corners_at, (triangles, 9), np.float64)
    winding, clearance = carray(winding_at, (count,), np.int64), carray(clearance_at, (count,), np.float64)
    for t in range(triangles):
        low_x, high_x = reach(corners[t, 0], corners[t, 3], corners[t, 6], margin)
        low_y, high_y = reach(corners[t, 1], corners[t, 4], corners[t, 7], margin)
        low_z, high_z = reach(corners[t, 2], corners[t, 5], corners[t, 8], margin)
        first, last = 0, count
        while first < last:
            middle = (first + last) // 2
            if points[middle, 0] < low_x:
                first = middle + 1
            else:
                last = middle
        for p in range(first, count):
            x, y, z = points[p, 0], points[p, 1], points[p, 2]
            if x > high_x:
                break
            if y < low_y or y > high_y:
                continue
            ax, ay, az = corners[t, 0] - x, corners[t, 1] - y, corners[t, 2] - z
            bx, by, bz = corners[t, 3] - x, corners[t, 4] - y, corners[t, 5] - z
            cx, cy, cz = corners[t, 6] - x, corners[t, 7] - y, corners[t, 8] - z
            turns = turned(ax, ay, bx, by) + turned(bx, by, cx, cy) + turned(cx, cy, ax, ay)
            near = low_z <= z and z <= high_z
            if turns == 0 and not near:
                continue
            ux, uy, uz = bx - ax, by - ay, bz - az
            vx, vy, vz = cx - ax, cy - ay, cz - az
            nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            volume = ax * nx + ay * ny + az * nz
            if turns * volume > 0:
                winding[p] += turns
            if near:
                area = np.sqrt(nx * nx + ny * ny + nz * nz)
                if area > 0:
                    clearance[p] = min(clearance[p], abs(volume) / area)
    return 0
