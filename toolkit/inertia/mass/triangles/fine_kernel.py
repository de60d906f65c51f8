"""The compiled kernels that sum the moments of triangles with the digits that float64 loses.

Imported only to be compiled (`inertia.native`); `inertia.mass.triangles.fine_sums` says how. All that is done with the
triangles of a row of lanes is one loop, as storing what lies between its steps takes longer than they do. Where
coordinates are sheared, they are taken in the order of the axes of the shear, and sums are put back where they end.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mass.triangles.double_double_kernel import fma
from inertia.mass.triangles.fetch_kernel import DEPTH, EIGHT, LANES, address, fetch_eights, fetch_faces, lowered, raised

HIGH, LOW, EDGES, SIZE, REST, AREA = 0, 10, 20, 23, 24, 25
"""Rows of the ten sums, their remainders, the squares of edges, |d|, the magnitudes of its remainders, |n|."""

LEAST, MOST, FAR, ROWS = 26, 29, 32, 34
"""Rows of the least and the largest coordinates, of the largest |A| along the two sheared axes; of all."""

ROOM = 11
"""Rows of what the ten sums start from, and of the extents of STL records as they are stored."""

TOP = 1.5 * 2.0**52
"""Times a step of a grid: what rounds to that grid where it is added."""


@njit(inline="always")
def prepare(start, steps, unit):
    """Write what the sums start from: the middle of the range of their grids."""
    dx, dy, dz = steps
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
def near(value, top):
    """Return the multiple of a grid that is nearest."""
    return (value + top) - top


@njit(inline="always")
def twos(numbers):
    """Return the sums of two of three numbers."""
    a, b, c = numbers
    return a + b, b + c, c + a


@njit(inline="always")
def along(fine, k, j, d, low, both, corners, left):
    """Add to the first moment and to the second one along an axis."""
    (ab, bc, ca), (rs, st, tr) = twos(corners), twos(left)
    put(fine, 1 + k, j, d, low, both, ab + corners[2], rs + left[2])
    square = fma(ab, ab, fma(bc, bc, ca * ca))
    more = fma(rs, fma(0.5, rs, ab), fma(st, fma(0.5, st, bc), tr * fma(0.5, tr, ca)))
    put(fine, 4 + k, j, d, low, 2.0 * both, square, more)


@njit(inline="always")
def across(fine, row, j, d, low, both, corners, left, others, rest):
    """Add to the second moment of two axes."""
    (ab, bc, ca), (rs, st, tr) = twos(corners), twos(left)
    (de, ef, fd), (uv, vw, wu) = twos(others), twos(rest)
    product = fma(ab, de, fma(bc, ef, ca * fd))
    more = fma(ab, uv, fma(bc, vw, ca * wu))
    more = fma(rs, de + uv, fma(st, ef + vw, fma(tr, fd + wu, more)))
    put(fine, row, j, d, low, both, product, more)


@njit(inline="always")
def triangle(fine, j, top, x, y, z, left):
    """Add a triangle to a lane and return its normal; its corners along an axis are on the grid, but for what is left.

    The area is not added.
    """
    (ax, bx, cx), (ay, by, cy), (az, bz, cz) = x, y, z
    (rx, sx, tx), (ry, sy, ty), (rz, sz, tz) = left
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - ax, cy - ay, cz - az
    px, py, pz = sx - rx, sy - ry, sz - rz
    qx, qy, qz = tx - rx, ty - ry, tz - rz
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
    more = fma(ax, mx, fma(ay, my, az * mz))
    nx, ny, nz = nx + mx, ny + my, nz + mz
    low = more + fma(rx, nx, fma(ry, ny, fma(rz, nz, low)))
    fine[HIGH, j] += d
    fine[LOW, j] += low
    fine[SIZE, j] += abs(d)
    fine[REST, j] += abs(low)
    both, (r, s, t) = d + low, left
    along(fine, 0, j, d, low, both, x, r)
    along(fine, 1, j, d, low, both, y, s)
    along(fine, 2, j, d, low, both, z, t)
    across(fine, 7, j, d, low, both, y, s, z, t)
    across(fine, 8, j, d, low, both, z, t, x, r)
    across(fine, 9, j, d, low, both, x, r, y, s)
    return nx, ny, nz


@njit(inline="always")
def area(x, y, z):
    """Return |n|."""
    return np.sqrt(fma(x, x, fma(y, y, z * z)))


@njit(inline="always")
def add_plain(corner, fine, top, origin, steps):
    """Add one triangle to each lane, as it is stored."""
    x, y, z = origin
    f, g, h = TOP * steps[0], TOP * steps[1], TOP * steps[2]
    for j in range(LANES):
        ax, ay, az = corner[0, j], corner[1, j], corner[2, j]
        bx, by, bz = corner[3, j], corner[4, j], corner[5, j]
        cx, cy, cz = corner[6, j], corner[7, j], corner[8, j]
        rx, sx, tx = near(ax, f), near(bx, f), near(cx, f)
        ry, sy, ty = near(ay, g), near(by, g), near(cy, g)
        rz, sz, tz = near(az, h), near(bz, h), near(cz, h)
        left = (ax - rx, bx - sx, cx - tx), (ay - ry, by - sy, cy - ty), (az - rz, bz - sz, cz - tz)
        on_x, on_y, on_z = (rx - x, sx - x, tx - x), (ry - y, sy - y, ty - y), (rz - z, sz - z, tz - z)
        nx, ny, nz = triangle(fine, j, top, on_x, on_y, on_z, left)
        fine[AREA, j] += area(nx, ny, nz)


@njit(inline="always")
def widen(corner, fine):
    """Widen the extents of each lane by a triangle."""
    for j in range(LANES):
        ax, ay, az = corner[0, j], corner[1, j], corner[2, j]
        bx, by, bz = corner[3, j], corner[4, j], corner[5, j]
        cx, cy, cz = corner[6, j], corner[7, j], corner[8, j]
        fine[LEAST, j] = lowered(fine[LEAST, j], ax, bx, cx)
        fine[MOST, j] = raised(fine[MOST, j], ax, bx, cx)
        fine[LEAST + 1, j] = lowered(fine[LEAST + 1, j], ay, by, cy)
        fine[MOST + 1, j] = raised(fine[MOST + 1, j], ay, by, cy)
        fine[LEAST + 2, j] = lowered(fine[LEAST + 2, j], az, bz, cz)
        fine[MOST + 2, j] = raised(fine[MOST + 2, j], az, bz, cz)


@njit(inline="always")
def of_axis(axis, numbers):
    """Return one of three numbers."""
    x, y, z = numbers
    return x if axis == 0 else (y if axis == 1 else z)


@njit(inline="always")
def along_axes(axes, numbers):
    """Return three numbers in the order of the axes of a shear."""
    i, j, k = axes
    return of_axis(i, numbers), of_axis(j, numbers), of_axis(k, numbers)


@njit(inline="always")
def sheared(a, b, c, u, v, w, p, q, r, one, other):
    """Return b − p a and c − q a − r b on their finer grids, and what is left; u, v, w is what is left of a, b, c."""
    c = fma(-r, b, fma(-q, a, c))
    w = fma(-r, v, fma(-q, u, w))
    b = fma(-p, a, b)
    v = fma(-p, u, v)
    f, g = near(b + v, one), near(c + w, other)
    return f, g, (b - f) + v, (c - g) + w


@njit(inline="always")
def add_sheared(corner, fine, top, origin, steps, axes, factors, finer):
    """Add one triangle to each lane, with x_j − p x_i and x_k − q x_i − r x_j for x_j and x_k, in the order i, j, k."""
    (x, y, z), (p, q, r), (_, one, other) = origin, factors, finer
    f, g, h, one, other = TOP * steps[0], TOP * steps[1], TOP * steps[2], TOP * one, TOP * other
    for n in range(LANES):
        ax, ay, az = along_axes(axes, (corner[0, n], corner[1, n], corner[2, n]))
        bx, by, bz = along_axes(axes, (corner[3, n], corner[4, n], corner[5, n]))
        cx, cy, cz = along_axes(axes, (corner[6, n], corner[7, n], corner[8, n]))
        ai, aj, ak = near(ax, f), near(ay, g), near(az, h)
        bi, bj, bk = near(bx, f), near(by, g), near(bz, h)
        ci, cj, ck = near(cx, f), near(cy, g), near(cz, h)
        ri, si, ti = ax - ai, bx - bi, cx - ci
        ai, bi, ci = ai - x, bi - x, ci - x
        aj, ak, rj, rk = sheared(ai, aj - y, ak - z, ri, ay - aj, az - ak, p, q, r, one, other)
        bj, bk, sj, sk = sheared(bi, bj - y, bk - z, si, by - bj, bz - bk, p, q, r, one, other)
        cj, ck, tj, tk = sheared(ci, cj - y, ck - z, ti, cy - cj, cz - ck, p, q, r, one, other)
        fine[FAR, n] = raised(fine[FAR, n], abs(aj), abs(bj), abs(cj))
        fine[FAR + 1, n] = raised(fine[FAR + 1, n], abs(ak), abs(bk), abs(ck))
        left = (ri, si, ti), (rj, sj, tj), (rk, sk, tk)
        nx, ny, nz = triangle(fine, n, top, (ai, bi, ci), (aj, bj, cj), (ak, bk, ck), left)
        nx, ny = fma(-q, nz, fma(-p, ny, nx)), fma(-r, nz, ny)
        fine[AREA, n] += area(nx, ny, nz)


@njit(inline="always")
def end(fine, start, out, block, axes):
    """Add up the lanes as a binary tree and store the block, along x, y, z."""
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
    sign = 1.0 if (axes[1] - axes[0]) % 3 == 1 else -1.0  # d changes its own where the order is not a cyclic one
    for row in (HIGH, LOW):
        out[block, row] = sign * fine[row, 0]
        for n in range(3):
            for several in (1, 4, 7):
                out[block, row + several + axes[n]] = sign * fine[row + several + n, 0]
    for n in range(3):
        out[block, EDGES + axes[n]] = fine[EDGES + n, 0]
    for row in range(SIZE, ROWS):
        out[block, row] = fine[row, 0]


@njit(inline="always")
def in_order(axes, origin, steps, finer):
    """Return the axes in the order in which coordinates are taken, and what is known along them."""
    if axes[0] < 0:
        return (0, 1, 2), origin, steps, finer
    return axes, along_axes(axes, origin), along_axes(axes, steps), along_axes(axes, finer)


def sum_facets(records, count, x, y, z, dx, dy, dz, unit, first, second, third, k, m, n, ex, ey, ez, scratch, out_at):
    """Sum `count` binary STL records, about (x, y, z) on the grid of steps (dx, dy, dz) and, sheared, (ex, ey, ez)."""
    room = carray(scratch, (9 + ROWS + ROOM, LANES), np.float64)
    corner, fine, start = room[:9], room[9 : 9 + ROWS], room[9 + ROWS :]
    stored = address(scratch, (9 + ROWS + LOW) * LANES * 8)
    extents = carray(stored, (6, EIGHT), np.float32)
    is_sheared, factors = first >= 0, (k, m, n)
    axes, origin, steps, finer = in_order((first, second, third), (x, y, z), (dx, dy, dz), (ex, ey, ez))
    prepare(start, finer, unit)
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS), np.float64)
    for block in range(blocks):
        begin(fine, start)
        for lane in range(EIGHT):
            for axis in range(3):
                extents[axis, lane], extents[axis + 3, lane] = np.inf, -np.inf
        for begins in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_eights(records, begins, count, scratch, corner, stored, extents)
            if is_sheared:
                add_sheared(corner, fine, TOP * unit, origin, steps, axes, factors, finer)
            else:
                add_plain(corner, fine, TOP * unit, origin, steps)
        for lane in range(EIGHT):
            for axis in range(6):
                fine[LEAST + axis, lane] = extents[axis, lane]
        end(fine, start, out, block, axes)
    return 0


def sum_faces(
    vertices, faces_at, count, x, y, z, dx, dy, dz, unit, first, second, third, k, m, n, ex, ey, ez, scratch, out_at
):
    """Sum `count` faces over shared vertices, in the same way."""
    faces = carray(faces_at, (count, 3), np.int64)
    room = carray(scratch, (9 + ROWS + ROOM, LANES), np.float64)
    corner, fine, start = room[:9], room[9 : 9 + ROWS], room[9 + ROWS :]
    is_sheared, factors = first >= 0, (k, m, n)
    axes, origin, steps, finer = in_order((first, second, third), (x, y, z), (dx, dy, dz), (ex, ey, ez))
    prepare(start, finer, unit)
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS), np.float64)
    for block in range(blocks):
        begin(fine, start)
        for begins in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_faces(vertices, faces, begins, count, scratch, corner)
            widen(corner, fine)
            if is_sheared:
                add_sheared(corner, fine, TOP * unit, origin, steps, axes, factors, finer)
            else:
                add_plain(corner, fine, TOP * unit, origin, steps)
        end(fine, start, out, block, axes)
    return 0
