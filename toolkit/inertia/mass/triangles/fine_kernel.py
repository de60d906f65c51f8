"""The compiled kernels that sum the moments of triangles twice, in float64 and with the digits that it loses.

Imported only to be compiled (`inertia.native`); `inertia.mass.triangles.fine_sums` says how. The work on a row of lanes
goes through the memory `hold`, step by step, as it has three times the numbers that a processor has registers for.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mass.triangles import moment_kernel
from inertia.mass.triangles.double_double_kernel import fma
from inertia.mass.triangles.fetch_kernel import DEPTH, LANES, fetch_faces, fetch_facets

ROWS = moment_kernel.ROWS
HIGH, LOW, EDGES, PLACES, SIZE, FINE = 0, 10, 20, 23, 26, 27
"""Rows of the ten sums, their remainders, the squares of edges and first corners, |remainder of d|, and of all."""

A, R, D, P, REST, MIDDLE, START, ROOM = 0, 9, 18, 22, 31, 40, 49, 59
"""Rows of `hold`: corners on the grid, what is left of them; d, its remainder, both, twice both; sums of two corners,
what is left of them, the middle of the two; what the ten sums start from."""

TOP = 1.5 * 2.0**52
"""Times a step of a grid: what rounds to that grid where it is added."""


@njit(inline="always")
def prepare(start, dx, dy, dz, unit):
    """Write what the sums start from: the middle of the range of their grids."""
    first, second = TOP * (2.0**27 * unit), TOP * (2.0**53 * unit)
    for lane in range(LANES):
        start[0, lane] = 0.0
        start[1, lane], start[2, lane], start[3, lane] = first * dx, first * dy, first * dz
        start[4, lane], start[5, lane], start[6, lane] = second * dx * dx, second * dy * dy, second * dz * dz
        start[7, lane], start[8, lane], start[9, lane] = second * dy * dz, second * dz * dx, second * dx * dy


@njit(inline="always")
def begin(fine, start):
    """Begin a block."""
    for row in range(LOW):
        for lane in range(LANES):
            fine[row, lane] = start[row, lane]
    for row in range(LOW, FINE):
        for lane in range(LANES):
            fine[row, lane] = 0.0


@njit(inline="always")
def put(fine, k, j, d, low_d, both, high, low):
    """Add a product to a sum on its grid, and what that leaves of it to the sum's remainder."""
    old = fine[k, j]
    new = fma(d, high, old)
    fine[k, j] = new
    fine[LOW + k, j] += fma(both, low, fma(low_d, high, fma(d, high, old - new)))


@njit(inline="always")
def place(corner, hold, x, y, z, dx, dy, dz):
    """Split the coordinates into multiples of the grid, about its origin, and what is left."""
    tx, ty, tz = TOP * dx, TOP * dy, TOP * dz
    for k in range(0, 9, 3):
        for j in range(LANES):
            px, py, pz = corner[k, j], corner[k + 1, j], corner[k + 2, j]
            gx, gy, gz = (px + tx) - tx, (py + ty) - ty, (pz + tz) - tz
            hold[A + k, j], hold[A + k + 1, j], hold[A + k + 2, j] = gx - x, gy - y, gz - z
            hold[R + k, j], hold[R + k + 1, j], hold[R + k + 2, j] = px - gx, py - gy, pz - gz


@njit(inline="always")
def volumes(hold, fine, top):
    """Form d and its remainder, and what the bounds need."""
    for j in range(LANES):
        ax, ay, az = hold[A, j], hold[A + 1, j], hold[A + 2, j]
        rx, ry, rz = hold[R, j], hold[R + 1, j], hold[R + 2, j]
        ux, uy, uz = hold[A + 3, j] - ax, hold[A + 4, j] - ay, hold[A + 5, j] - az
        vx, vy, vz = hold[A + 6, j] - ax, hold[A + 7, j] - ay, hold[A + 8, j] - az
        px, py, pz = hold[R + 3, j] - rx, hold[R + 4, j] - ry, hold[R + 5, j] - rz
        qx, qy, qz = hold[R + 6, j] - rx, hold[R + 7, j] - ry, hold[R + 8, j] - rz
        wx, wy, wz = vx + qx, vy + qy, vz + qz
        fine[EDGES, j] = fma(ux, ux, fma(vx, vx, fine[EDGES, j]))
        fine[EDGES + 1, j] = fma(uy, uy, fma(vy, vy, fine[EDGES + 1, j]))
        fine[EDGES + 2, j] = fma(uz, uz, fma(vz, vz, fine[EDGES + 2, j]))
        fine[PLACES, j] = fma(ax, ax, fine[PLACES, j])
        fine[PLACES + 1, j] = fma(ay, ay, fine[PLACES + 1, j])
        fine[PLACES + 2, j] = fma(az, az, fine[PLACES + 2, j])
        nx, ny, nz = fma(uy, vz, -(uz * vy)), fma(uz, vx, -(ux * vz)), fma(ux, vy, -(uy * vx))
        mx = fma(uy, qz, fma(-uz, qy, fma(py, wz, -(pz * wy))))
        my = fma(uz, qx, fma(-ux, qz, fma(pz, wx, -(px * wz))))
        mz = fma(ux, qy, fma(-uy, qx, fma(px, wy, -(py * wx))))
        e = fma(ax, nx, top)
        f = fma(ay, ny, e)
        g = fma(az, nz, f)
        d = g - top
        low = fma(ax, nx, top - e) + fma(ay, ny, e - f) + fma(az, nz, f - g)
        low = fma(ax, mx, fma(ay, my, fma(az, mz, low)))
        low = fma(rx, nx + mx, fma(ry, ny + my, fma(rz, nz + mz, low)))
        fine[HIGH, j] += d
        fine[LOW, j] += low
        fine[SIZE, j] += abs(low)
        hold[D, j], hold[D + 1, j], hold[D + 2, j], hold[D + 3, j] = d, low, d + low, 2.0 * (d + low)


@njit(inline="always")
def along(hold, fine, k):
    """Add to the first moment and to the second one along an axis."""
    for j in range(LANES):
        a, b, c = hold[A + k, j], hold[A + 3 + k, j], hold[A + 6 + k, j]
        r, s, t = hold[R + k, j], hold[R + 3 + k, j], hold[R + 6 + k, j]
        d, low, both, twice = hold[D, j], hold[D + 1, j], hold[D + 2, j], hold[D + 3, j]
        ab, bc, ca = a + b, b + c, c + a
        rs, st, tr = r + s, s + t, t + r
        f, g, h = fma(0.5, rs, ab), fma(0.5, st, bc), fma(0.5, tr, ca)
        put(fine, 1 + k, j, d, low, both, ab + c, rs + t)
        put(fine, 4 + k, j, d, low, twice, fma(ab, ab, fma(bc, bc, ca * ca)), fma(rs, f, fma(st, g, tr * h)))
        hold[P + k, j], hold[P + 3 + k, j], hold[P + 6 + k, j] = ab, bc, ca
        hold[REST + k, j], hold[REST + 3 + k, j], hold[REST + 6 + k, j] = rs, st, tr
        hold[MIDDLE + k, j], hold[MIDDLE + 3 + k, j], hold[MIDDLE + 6 + k, j] = f, g, h


@njit(inline="always")
def across(hold, fine, row, k, m):
    """Add to the second moment of two axes."""
    for j in range(LANES):
        high = fma(hold[P + 3 + k, j], hold[P + 3 + m, j], hold[P + 6 + k, j] * hold[P + 6 + m, j])
        high = fma(hold[P + k, j], hold[P + m, j], high)
        low = fma(hold[REST + 3 + k, j], hold[MIDDLE + 3 + m, j], hold[REST + 6 + k, j] * hold[MIDDLE + 6 + m, j])
        low = fma(hold[REST + m, j], hold[MIDDLE + k, j], fma(hold[REST + k, j], hold[MIDDLE + m, j], low))
        low = fma(hold[REST + 3 + m, j], hold[MIDDLE + 3 + k, j], low)
        low = fma(hold[REST + 6 + m, j], hold[MIDDLE + 6 + k, j], low)
        put(fine, row, j, hold[D, j], hold[D + 1, j], hold[D + 2, j], high, low)


@njit(inline="always")
def add(corner, hold, fine, x, y, z, dx, dy, dz, unit):
    """Add one triangle to each lane."""
    place(corner, hold, x, y, z, dx, dy, dz)
    volumes(hold, fine, TOP * unit)
    along(hold, fine, 0)
    along(hold, fine, 1)
    along(hold, fine, 2)
    across(hold, fine, 7, 1, 2)
    across(hold, fine, 8, 2, 0)
    across(hold, fine, 9, 0, 1)


@njit(inline="always")
def end(fine, start, out, block):
    """Add up the lanes as a binary tree and store the block."""
    for row in range(LOW):
        for lane in range(LANES):
            fine[row, lane] -= start[row, lane]
    half = LANES // 2
    while half > 0:
        for lane in range(half):
            for row in range(FINE):
                fine[row, lane] += fine[row, lane + half]
        half //= 2
    for row in range(FINE):
        out[block, ROWS + row] = fine[row, 0]


def sum_facets(records, count, ox, oy, oz, x, y, z, dx, dy, dz, unit, scratch, out_at):
    """Sum `count` binary STL records, about (ox, oy, oz) in float64 and about (x, y, z) on the grid."""
    room = carray(scratch, (9 + ROWS + FINE + ROOM, LANES), np.float64)
    corner, total, fine, hold = room[:9], room[9 : 9 + ROWS], room[9 + ROWS : 9 + ROWS + FINE], room[9 + ROWS + FINE :]
    start = hold[START:]
    prepare(start, dx, dy, dz, unit)
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS + FINE), np.float64)
    for block in range(blocks):
        moment_kernel.clear(total)
        begin(fine, start)
        for begins in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_facets(records, begins, count, scratch, corner)
            moment_kernel.add(corner, total, ox, oy, oz, 0)
            add(corner, hold, fine, x, y, z, dx, dy, dz, unit)
        moment_kernel.finish(total, out, block)
        end(fine, start, out, block)
    return 0


def sum_faces(vertices, faces_at, count, ox, oy, oz, x, y, z, dx, dy, dz, unit, scratch, out_at):
    """Sum `count` faces over shared vertices, in the same way."""
    faces = carray(faces_at, (count, 3), np.int64)
    room = carray(scratch, (9 + ROWS + FINE + ROOM, LANES), np.float64)
    corner, total, fine, hold = room[:9], room[9 : 9 + ROWS], room[9 + ROWS : 9 + ROWS + FINE], room[9 + ROWS + FINE :]
    start = hold[START:]
    prepare(start, dx, dy, dz, unit)
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS + FINE), np.float64)
    for block in range(blocks):
        moment_kernel.clear(total)
        begin(fine, start)
        for begins in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_faces(vertices, faces, begins, count, scratch, corner)
            moment_kernel.add(corner, total, ox, oy, oz, 0)
            add(corner, hold, fine, x, y, z, dx, dy, dz, unit)
        moment_kernel.finish(total, out, block)
        end(fine, start, out, block)
    return 0
