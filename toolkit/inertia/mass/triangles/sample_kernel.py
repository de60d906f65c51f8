"""The compiled statistics of a sample of triangles, from which a grid of `inertia.mass.triangles.fine_sums` is chosen.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray

LOW, HIGH, MEAN, PRODUCTS, LARGEST, COLUMNS = 0, 3, 6, 9, 15, 16
"""Places of the extents, of the mean of the corners, of ∑x xᵀ about it (xx, yy, zz, yz, zx, xy) and of the largest sum
of the magnitudes of the terms of d."""


def measure_sample(corners_at, count, out_at):
    """Write the statistics of `count` triangles, those of d about the middle of the extents."""
    corners = carray(corners_at, (count, 9), np.float64)
    out = carray(out_at, (COLUMNS,), np.float64)
    out[:] = 0.0
    for axis in range(3):
        low, high, total = np.inf, -np.inf, 0.0
        for n in range(count):
            a, b, c = corners[n, axis], corners[n, 3 + axis], corners[n, 6 + axis]
            low, high = min(low, min(a, min(b, c))), max(high, max(a, max(b, c)))
            total += (a + b) + c
        out[LOW + axis], out[HIGH + axis], out[MEAN + axis] = low, high, total / (3 * count)
    x, y, z = (0.5 * (out[LOW] + out[HIGH]), 0.5 * (out[LOW + 1] + out[HIGH + 1]), 0.5 * (out[LOW + 2] + out[HIGH + 2]))
    mx, my, mz = out[MEAN], out[MEAN + 1], out[MEAN + 2]
    for n in range(count):
        for k in range(0, 9, 3):
            a, b, c = corners[n, k] - mx, corners[n, k + 1] - my, corners[n, k + 2] - mz
            out[PRODUCTS] += a * a
            out[PRODUCTS + 1] += b * b
            out[PRODUCTS + 2] += c * c
            out[PRODUCTS + 3] += b * c
            out[PRODUCTS + 4] += c * a
            out[PRODUCTS + 5] += a * b
        ax, ay, az = corners[n, 0], corners[n, 1], corners[n, 2]
        ux, uy, uz = abs(corners[n, 3] - ax), abs(corners[n, 4] - ay), abs(corners[n, 5] - az)
        vx, vy, vz = abs(corners[n, 6] - ax), abs(corners[n, 7] - ay), abs(corners[n, 8] - az)
        d = abs(ax - x) * (uy * vz + uz * vy) + abs(ay - y) * (uz * vx + ux * vz) + abs(az - z) * (ux * vy + uy * vx)
        out[LARGEST] = max(out[LARGEST], d)
    return 0
