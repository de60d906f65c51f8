"""The compiled kernels that sum the moments of triangles; `inertia.mass.triangles.sums` says which, in what order.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mass.triangles.fetch_kernel import DEPTH, LANES, fetch_faces, fetch_facets, lowered, raised

ROWS = 19


@njit(inline="always")
def clear(total):
    """Begin a block: sums at zero, extents empty."""
    for row in range(13):
        for lane in range(LANES):
            total[row, lane] = 0.0
    for row in range(13, 16):
        for lane in range(LANES):
            total[row, lane] = np.inf
            total[row + 3, lane] = -np.inf


@njit(inline="always")
def add(corner, total, ox, oy, oz, surface):
    """Add one triangle to each lane."""
    for j in range(LANES):
        x0, y0, z0 = corner[0, j], corner[1, j], corner[2, j]
        x1, y1, z1 = corner[3, j], corner[4, j], corner[5, j]
        x2, y2, z2 = corner[6, j], corner[7, j], corner[8, j]
        ux, uy, uz = x1 - x0, y1 - y0, z1 - z0
        vx, vy, vz = x2 - x0, y2 - y0, z2 - z0
        ax, ay, az = x0 - ox, y0 - oy, z0 - oz
        bx, by, bz = x1 - ox, y1 - oy, z1 - oz
        cx, cy, cz = x2 - ox, y2 - oy, z2 - oz
        px, qx = uy * vz, uz * vy
        py, qy = uz * vx, ux * vz
        pz, qz = ux * vy, uy * vx
        nx, ny, nz = px - qx, py - qy, pz - qz
        mx, my, mz = abs(px) + abs(qx), abs(py) + abs(qy), abs(pz) + abs(qz)
        area = np.sqrt((nx * nx + ny * ny) + nz * nz)
        if surface:
            weight = area
            size = (mx + my) + mz
        else:
            weight = (ax * nx + ay * ny) + az * nz
            size = (abs(ax) * mx + abs(ay) * my) + abs(az) * mz
        tx, ty, tz = ax + bx, ay + by, az + bz
        sx, sy, sz = tx + cx, ty + cy, tz + cz
        total[0, j] += weight
        total[1, j] += weight * sx
        total[2, j] += weight * sy
        total[3, j] += weight * sz
        total[4, j] += weight * ((ax * ax + bx * tx) + cx * sx)
        total[5, j] += weight * ((ay * ay + by * ty) + cy * sy)
        total[6, j] += weight * ((az * az + bz * tz) + cz * sz)
        total[7, j] += weight * (((sy * sz + ay * az) + by * bz) + cy * cz)
        total[8, j] += weight * (((sz * sx + az * ax) + bz * bx) + cz * cx)
        total[9, j] += weight * (((sx * sy + ax * ay) + bx * by) + cx * cy)
        total[10, j] += size
        total[11, j] += area
        total[12, j] += abs(weight)
        total[13, j] = lowered(total[13, j], x0, x1, x2)
        total[14, j] = lowered(total[14, j], y0, y1, y2)
        total[15, j] = lowered(total[15, j], z0, z1, z2)
        total[16, j] = raised(total[16, j], x0, x1, x2)
        total[17, j] = raised(total[17, j], y0, y1, y2)
        total[18, j] = raised(total[18, j], z0, z1, z2)


@njit(inline="always")
def finish(total, out, block):
    """Add up the lanes as a binary tree and store the block."""
    half = LANES // 2
    while half > 0:
        for lane in range(half):
            for row in range(13):
                total[row, lane] += total[row, lane + half]
            for row in range(13, 16):
                total[row, lane] = min(total[row, lane], total[row, lane + half])
                total[row + 3, lane] = max(total[row + 3, lane], total[row + 3, lane + half])
        half //= 2
    for row in range(ROWS):
        out[block, row] = total[row, 0]


def sum_facets(records, count, ox, oy, oz, surface, scratch, out_at):
    """Sum `count` binary STL records."""
    room = carray(scratch, (9 + ROWS, LANES), np.float64)
    corner, total = room[:9], room[9:]
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS), np.float64)
    for block in range(blocks):
        clear(total)
        for start in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_facets(records, start, count, scratch, corner)
            add(corner, total, ox, oy, oz, surface)
        finish(total, out, block)
    return 0


def sum_faces(vertices, faces_at, count, ox, oy, oz, surface, scratch, out_at):
    """Sum `count` faces over shared vertices."""
    faces = carray(faces_at, (count, 3), np.int64)
    room = carray(scratch, (9 + ROWS, LANES), np.float64)
    corner, total = room[:9], room[9:]
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS), np.float64)
    for block in range(blocks):
        clear(total)
        for start in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_faces(vertices, faces, start, count, scratch, corner)
            add(corner, total, ox, oy, oz, surface)
        finish(total, out, block)
    return 0
