"""The compiled kernels that sum the moments of triangles with the digits that float64 loses.

Imported only to be compiled (`inertia.native`); `inertia.mass.triangles.fine_sums` says how. The work on a row of lanes
goes through the memory `hold`, step by step, as it has three times the numbers that a processor has registers for.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mass.triangles.double_double_kernel import fma
from inertia.mass.triangles.fetch_kernel import DEPTH, LANES, fetch_faces, fetch_facets, lowered, raised

HIGH, LOW, EDGES, SIZE, AREA = 0, 10, 20, 23, 24
"""Rows of the ten sums, their remainders, the squares of edges, |d|, |n|."""

LEAST, MOST, FAR, ROWS = 25, 28, 31, 33
"""Rows of the least and the largest coordinates, of the largest |A| along the two sheared axes; of all."""

A, R, D, N, START, HALF, ROOM = 0, 9, 18, 22, 25, 35, 44
"""Rows of `hold`: corners on the grid, what is left of them; d, its remainder, both, twice both; the normal; what the
ten sums start from. Then, of two corners, the sums of either, and in `HALF` the former with half of the latter."""

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
    """Begin a block: sums at their start, extents empty."""
    for row in range(LOW):
        for lane in range(LANES):
            fine[row, lane] = start[row, lane]
    for row in range(LOW, LEAST):
        for lane in range(LANES):
            fine[row, lane] = 0.0
    for row in range(LEAST, MOST):
        for lane in range(LANES):
            fine[row, lane] = np.inf
            fine[row + 3, lane] = -np.inf
    for row in range(FAR, ROWS):
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
def place(corner, hold, fine, k, origin, step):
    """Split the coordinates along an axis into multiples of the grid, about its origin, and what is left."""
    top = TOP * step
    for j in range(LANES):
        a, b, c = corner[k, j], corner[3 + k, j], corner[6 + k, j]
        f, g, h = (a + top) - top, (b + top) - top, (c + top) - top
        hold[A + k, j], hold[A + 3 + k, j], hold[A + 6 + k, j] = f - origin, g - origin, h - origin
        hold[R + k, j], hold[R + 3 + k, j], hold[R + 6 + k, j] = a - f, b - g, c - h
        fine[LEAST + k, j] = lowered(fine[LEAST + k, j], a, b, c)
        fine[MOST + k, j] = raised(fine[MOST + k, j], a, b, c)


@njit(inline="always")
def shear(hold, fine, axes, factors, finer, finest):
    """Make x_j − p x_i and x_k − q x_i − r x_j of x_j and x_k, and split them anew."""
    i, j, k = axes
    p, q, r = factors
    near, far = TOP * finer, TOP * finest
    for corner in range(0, 9, 3):
        for n in range(LANES):
            a, b, c = hold[A + corner + i, n], hold[A + corner + j, n], hold[A + corner + k, n]
            u, v, w = hold[R + corner + i, n], hold[R + corner + j, n], hold[R + corner + k, n]
            c = fma(-r, b, fma(-q, a, c))
            w = fma(-r, v, fma(-q, u, w))
            b = fma(-p, a, b)
            v = fma(-p, u, v)
            f, g = ((b + v) + near) - near, ((c + w) + far) - far
            hold[A + corner + j, n], hold[A + corner + k, n] = f, g
            hold[R + corner + j, n], hold[R + corner + k, n] = (b - f) + v, (c - g) + w
            fine[FAR, n], fine[FAR + 1, n] = max(fine[FAR, n] + 0.0, abs(f)), max(fine[FAR + 1, n] + 0.0, abs(g))


@njit(inline="always")
def unshear(hold, axes, factors):
    """Take from the normal what the shear has added to it."""
    i, j, k = axes
    p, q, r = factors
    for n in range(LANES):
        x, y, z = hold[N + i, n], hold[N + j, n], hold[N + k, n]
        hold[N + i, n], hold[N + j, n] = fma(-q, z, fma(-p, y, x)), fma(-r, z, y)


@njit(inline="always")
def areas(hold, fine):
    """Add |n|."""
    for j in range(LANES):
        x, y, z = hold[N, j], hold[N + 1, j], hold[N + 2, j]
        fine[AREA, j] += np.sqrt(fma(x, x, fma(y, y, z * z)))


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
        fine[SIZE, j] += abs(d)
        hold[N, j], hold[N + 1, j], hold[N + 2, j] = nx + mx, ny + my, nz + mz
        hold[D, j], hold[D + 1, j], hold[D + 2, j], hold[D + 3, j] = d, low, d + low, 2.0 * (d + low)


@njit(inline="always")
def along(hold, fine, k):
    """Add to the first moment and to the second one along an axis; leave sums of two corners in place of these."""
    for j in range(LANES):
        a, b, c = hold[A + k, j], hold[A + 3 + k, j], hold[A + 6 + k, j]
        r, s, t = hold[R + k, j], hold[R + 3 + k, j], hold[R + 6 + k, j]
        d, low, both, twice = hold[D, j], hold[D + 1, j], hold[D + 2, j], hold[D + 3, j]
        ab, bc, ca = a + b, b + c, c + a
        rs, st, tr = r + s, s + t, t + r
        f, g, h = fma(0.5, rs, ab), fma(0.5, st, bc), fma(0.5, tr, ca)
        put(fine, 1 + k, j, d, low, both, ab + c, rs + t)
        put(fine, 4 + k, j, d, low, twice, fma(ab, ab, fma(bc, bc, ca * ca)), fma(rs, f, fma(st, g, tr * h)))
        hold[A + k, j], hold[A + 3 + k, j], hold[A + 6 + k, j] = ab, bc, ca
        hold[R + k, j], hold[R + 3 + k, j], hold[R + 6 + k, j] = rs, st, tr
        hold[HALF + k, j], hold[HALF + 3 + k, j], hold[HALF + 6 + k, j] = f, g, h


@njit(inline="always")
def across(hold, fine, row, k, m):
    """Add to the second moment of two axes, of sums of two corners."""
    for j in range(LANES):
        high = fma(
            hold[A + k, j],
            hold[A + m, j],
            fma(hold[A + 3 + k, j], hold[A + 3 + m, j], hold[A + 6 + k, j] * hold[A + 6 + m, j]),
        )
        low = fma(
            hold[HALF + k, j],
            hold[R + m, j],
            fma(hold[HALF + 3 + k, j], hold[R + 3 + m, j], hold[HALF + 6 + k, j] * hold[R + 6 + m, j]),
        )
        low = fma(
            hold[R + k, j],
            hold[HALF + m, j],
            fma(hold[R + 3 + k, j], hold[HALF + 3 + m, j], fma(hold[R + 6 + k, j], hold[HALF + 6 + m, j], low)),
        )
        put(fine, row, j, hold[D, j], hold[D + 1, j], hold[D + 2, j], high, low)


@njit(inline="always")
def of_axis(axis, numbers):
    """Return one of three numbers."""
    x, y, z = numbers
    return x if axis == 0 else (y if axis == 1 else z)


@njit(inline="always")
def add(corner, hold, fine, origin, steps, unit, axes, factors, finer):
    """Add one triangle to each lane."""
    place(corner, hold, fine, 0, origin[0], steps[0])
    place(corner, hold, fine, 1, origin[1], steps[1])
    place(corner, hold, fine, 2, origin[2], steps[2])
    if axes[0] >= 0:
        shear(hold, fine, axes, factors, of_axis(axes[1], finer), of_axis(axes[2], finer))
    volumes(hold, fine, TOP * unit)
    if axes[0] >= 0:
        unshear(hold, axes, factors)
    areas(hold, fine)
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
            for row in range(LEAST):
                fine[row, lane] += fine[row, lane + half]
            for row in range(LEAST, MOST):
                fine[row, lane] = min(fine[row, lane], fine[row, lane + half])
                fine[row + 3, lane] = max(fine[row + 3, lane], fine[row + 3, lane + half])
            for row in range(FAR, ROWS):
                fine[row, lane] = max(fine[row, lane], fine[row, lane + half])
        half //= 2
    for row in range(ROWS):
        out[block, row] = fine[row, 0]


def sum_facets(records, count, x, y, z, dx, dy, dz, unit, first, second, third, k, m, n, ex, ey, ez, scratch, out_at):
    """Sum `count` binary STL records, about (x, y, z) on the grid of steps (dx, dy, dz) and, sheared, (ex, ey, ez)."""
    room = carray(scratch, (9 + ROWS + ROOM, LANES), np.float64)
    corner, fine, hold = room[:9], room[9 : 9 + ROWS], room[9 + ROWS :]
    start = hold[START:]
    origin, steps, finer = (x, y, z), (dx, dy, dz), (ex, ey, ez)
    axes, factors = (first, second, third), (k, m, n)
    prepare(start, ex, ey, ez, unit)
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS), np.float64)
    for block in range(blocks):
        begin(fine, start)
        for begins in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_facets(records, begins, count, scratch, corner)
            add(corner, hold, fine, origin, steps, unit, axes, factors, finer)
        end(fine, start, out, block)
    return 0


def sum_faces(
    vertices, faces_at, count, x, y, z, dx, dy, dz, unit, first, second, third, k, m, n, ex, ey, ez, scratch, out_at
):
    """Sum `count` faces over shared vertices, in the same way."""
    faces = carray(faces_at, (count, 3), np.int64)
    room = carray(scratch, (9 + ROWS + ROOM, LANES), np.float64)
    corner, fine, hold = room[:9], room[9 : 9 + ROWS], room[9 + ROWS :]
    start = hold[START:]
    origin, steps, finer = (x, y, z), (dx, dy, dz), (ex, ey, ez)
    axes, factors = (first, second, third), (k, m, n)
    prepare(start, ex, ey, ez, unit)
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS), np.float64)
    for block in range(blocks):
        begin(fine, start)
        for begins in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_faces(vertices, faces, begins, count, scratch, corner)
            add(corner, hold, fine, origin, steps, unit, axes, factors, finer)
        end(fine, start, out, block)
    return 0
