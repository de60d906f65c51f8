"""The moment kernel without what only a bound, the area and the extents need: what is left to compare its cost with.

The triangles come into the lanes as in `inertia.mass.triangles.fetch_kernel`, and the terms are formed in the same way.
"""

from __future__ import annotations

import numpy as np
from numba import carray

from inertia.mass.triangles.fetch_kernel import DEPTH, LANES, fetch_faces

SUMS = 10


def sum_bare(vertices, faces_at, count, ox, oy, oz, scratch, out_at):
    """Form the ten sums over `count` faces."""
    faces = carray(faces_at, (count, 3), np.int64)
    room = carray(scratch, (9 + SUMS, LANES), np.float64)
    corner, total = room[:9], room[9:]
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, SUMS), np.float64)
    for block in range(blocks):
        for k in range(SUMS):
            for lane in range(LANES):
                total[k, lane] = 0.0
        for start in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_faces(vertices, faces, start, count, scratch, corner)
            for j in range(LANES):
                x0, y0, z0 = corner[0, j], corner[1, j], corner[2, j]
                x1, y1, z1 = corner[3, j], corner[4, j], corner[5, j]
                x2, y2, z2 = corner[6, j], corner[7, j], corner[8, j]
                ux, uy, uz = x1 - x0, y1 - y0, z1 - z0
                vx, vy, vz = x2 - x0, y2 - y0, z2 - z0
                ax, ay, az = x0 - ox, y0 - oy, z0 - oz
                bx, by, bz = x1 - ox, y1 - oy, z1 - oz
                cx, cy, cz = x2 - ox, y2 - oy, z2 - oz
                nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
                weight = (ax * nx + ay * ny) + az * nz
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
        for k in range(SUMS):
            sum_of_lanes = 0.0
            for lane in range(LANES):
                sum_of_lanes += total[k, lane]
            out[block, k] = sum_of_lanes
    return 0
