"""The compiled statistics of a sample of triangles, from which a grid of `inertia.mass.triangles.fine_sums` is chosen.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

LOW, HIGH, MEAN, PRODUCTS, LARGEST, EDGES, ROUGH = 0, 3, 6, 9, 15, 16, 19
PLAIN, ABOUT, STEPS, UNIT, COLUMNS = 20, 21, 24, 27, 28
"""Places of the extents, of the mean of the corners, of ∑x xᵀ about it (xx, yy, zz, yz, zx, xy), of the largest sum of
the magnitudes of the terms of d, of the sums of the squares of edges, of whether bounds are rough without a shear, of
whether there is a grid that suits, and of that: origin, steps, the step of d."""

REACH, AMPLE, LAST_BIT, WORTHWHILE = 1.6 * 2.0**24, 128.0, 2.0**-50, 32.0  # as `fine_sums` has them
ROUGHLY, FILLED = 3.0, 100.0
"""Times u, the relative bound that a shear is too much trouble for; times the product of the standard deviations of the
corners along principal axes, six times the volume that is expected."""
SMALLEST, LARGEST_SIZE = 2.0**-90, 2.0**90


@njit(error_model="numpy", forceinline=True)
def power_above(value):
    """Return the least power of two above a positive number."""
    power = 1.0
    while power <= value:
        power *= 2.0
    while 0.5 * power > value:
        power *= 0.5
    return power


@njit(error_model="numpy", forceinline=True)
def choose_grid(out, count, total):
    """Write the grid for `total` triangles as `fine_sums.grid_for` chooses it; none if it may be scaled or sheared."""
    largest, product, cell, arms = 0.0, 1.0, 1.0, 0.0
    out[ROUGH] = True
    for axis in range(3):
        low, high = out[LOW + axis], out[HIGH + axis]
        origin = low + 0.5 * (high - low)
        out[ABOUT + axis], out[STEPS + axis] = origin, max(high - origin, origin - low)
        largest = max(largest, out[STEPS + axis])
    if not SMALLEST < largest < LARGEST_SIZE:
        return
    lengths = np.sqrt(count * out[EDGES]), np.sqrt(count * out[EDGES + 1]), np.sqrt(count * out[EDGES + 2])
    for axis in range(3):
        origin, reach = out[ABOUT + axis], max(out[STEPS + axis], 2.0**-40 * largest)
        farthest = max(abs(out[LOW + axis]), abs(out[HIGH + axis])) + 2.0 * reach
        step = power_above(max(1.25 * reach / REACH, farthest * 2.0**-49))
        top = 1.5 * 2.0**52 * step
        out[ABOUT + axis], out[STEPS + axis] = (origin + top) - top, step
        product *= reach
        cell *= step
    for axis in range(3):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        reach = max(out[HIGH + axis] - out[ABOUT + axis], out[ABOUT + axis] - out[LOW + axis])
        arms += reach * (lengths[one] * out[STEPS + other] + lengths[other] * out[STEPS + one])
    xx, yy, zz, yz = out[PRODUCTS], out[PRODUCTS + 1], out[PRODUCTS + 2], out[PRODUCTS + 3]
    zx, xy = out[PRODUCTS + 4], out[PRODUCTS + 5]
    shrunk = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)
    volume = FILLED * np.sqrt(max(shrunk, 0.0) / (3.0 * count) ** 3)
    out[ROUGH] = 12.0 * arms * total > ROUGHLY * volume * count
    if out[ROUGH] and shrunk * WORTHWHILE < xx * yy * zz:
        return
    out[UNIT] = power_above(max(AMPLE * product, 4.0 * total * out[LARGEST]) * LAST_BIT)
    out[PLAIN] = 2.0**-300 < out[UNIT] < 2.0**300


def measure_sample(corners_at, count, total, out_at):
    """Write the statistics of `count` of `total` triangles, those of d about the middle of their box, and the grid."""
    corners = carray(corners_at, (count, 9), np.float64)
    out = carray(out_at, (COLUMNS,), np.float64)
    out[:] = 0.0
    for axis in range(3):
        low, high, added = np.inf, -np.inf, 0.0
        for n in range(count):
            a, b, c = corners[n, axis], corners[n, 3 + axis], corners[n, 6 + axis]
            low, high = min(low, min(a, min(b, c))), max(high, max(a, max(b, c)))
            added += (a + b) + c
        out[LOW + axis], out[HIGH + axis], out[MEAN + axis] = low, high, added / (3 * count)
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
        ux, uy, uz = corners[n, 3] - ax, corners[n, 4] - ay, corners[n, 5] - az
        vx, vy, vz = corners[n, 6] - ax, corners[n, 7] - ay, corners[n, 8] - az
        out[EDGES] += ux * ux + vx * vx
        out[EDGES + 1] += uy * uy + vy * vy
        out[EDGES + 2] += uz * uz + vz * vz
        ax, ay, az, ux, uy, uz = abs(ax - x), abs(ay - y), abs(az - z), abs(ux), abs(uy), abs(uz)
        vx, vy, vz = abs(vx), abs(vy), abs(vz)
        d = ax * (uy * vz + uz * vy) + ay * (uz * vx + ux * vz) + az * (ux * vy + uy * vx)
        out[LARGEST] = max(out[LARGEST], d)
    if np.isfinite(mx + my + mz):
        choose_grid(out, count, total)
    return 0
