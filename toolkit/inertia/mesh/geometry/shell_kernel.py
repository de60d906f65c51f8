"""The compiled kernel that measures the shells of a surface as its triangles stream by; see `shells.all_apart`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import math

import numpy as np
from numba import carray

COLUMNS = 8


def measure_shells(corners_at, labels_at, count, x, y, z, table_at, shells):
    """Add triangles to the rows of their shells: box, 6 × volume about (x, y, z), and the size of its terms."""
    corners = carray(corners_at, (count, 3, 3), np.float64)
    labels = carray(labels_at, (count,), np.int32)
    table = carray(table_at, (shells, COLUMNS), np.float64)
    for k in range(count):
        row = labels[k]
        if row < 0:
            continue
        for axis in range(3):
            a, b, c = corners[k, 0, axis], corners[k, 1, axis], corners[k, 2, axis]
            table[row, axis] = min(table[row, axis], a, b, c)
            table[row, 3 + axis] = max(table[row, 3 + axis], a, b, c)
        x0, y0, z0 = corners[k, 0, 0], corners[k, 0, 1], corners[k, 0, 2]
        ux, uy, uz = corners[k, 1, 0] - x0, corners[k, 1, 1] - y0, corners[k, 1, 2] - z0
        vx, vy, vz = corners[k, 2, 0] - x0, corners[k, 2, 1] - y0, corners[k, 2, 2] - z0
        ax, ay, az = x0 - x, y0 - y, z0 - z
        table[row, 6] += ax * (uy * vz - uz * vy) + ay * (uz * vx - ux * vz) + az * (ux * vy - uy * vx)
        sizes = (ax * ax + ay * ay + az * az) * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz)
        table[row, 7] += math.sqrt(sizes)
    return 0
