"""The compiled kernels that sum the moments of triangles; `inertia.mass.sums` says what they sum and in what order.

Imported only to be compiled (`inertia.native`). The corners of four triangles are brought into vectors together
(`transpose`): stored one number at a time they cost as much as the arithmetic, and the processor's gather
instructions cost twice that.
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.extending import intrinsic

LANES = 32
DEPTH = 32
ROWS = 18

GROUP = 4
"""Triangles brought into the lanes together."""

RECORD, CORNER = 50, 12
"""Bytes of a binary STL record, and of its normal and of each of the three corners that follow."""


@intrinsic
def address(context, base, offset):
    """Return the address `offset` bytes after `base`."""

    def code(context, builder, signature, arguments):
        return builder.gep(arguments[0], [arguments[1]])

    return types.voidptr(types.voidptr, types.int64), code


def transposer(number, size, alignment):
    """Make the function that transposes points (3,) of `number`, an LLVM type of `size` bytes."""
    index = ir.IntType(32)
    pair, four = ir.VectorType(number, 2), ir.VectorType(number, 4)
    row = ir.VectorType(ir.DoubleType(), 4)

    @intrinsic
    def transpose(context, a, b, c, d, lane):
        """Store the points at four addresses as rows x, y, z of float64, the first at `lane`."""

        def code(context, builder, signature, arguments):
            def at(base, offset, kind):
                return builder.bitcast(builder.gep(base, [ir.IntType(64)(offset)]), kind.as_pointer())

            def load(base, offset, kind):
                return builder.load(at(base, offset, kind), align=alignment)

            def mixed(one, other, places):
                return builder.shuffle_vector(one, other, ir.Constant(ir.VectorType(index, 4), places))

            *points, lane = arguments
            xy = [load(point, 0, pair) for point in points]
            even, odd = mixed(xy[0], xy[2], [0, 1, 2, 3]), mixed(xy[1], xy[3], [0, 1, 2, 3])
            z = ir.Constant(four, ir.Undefined)
            for k, point in enumerate(points):
                z = builder.insert_element(z, load(point, 2 * size, number), index(k))
            for axis, found in enumerate((mixed(even, odd, [0, 4, 2, 6]), mixed(even, odd, [1, 5, 3, 7]), z)):
                widened = found if four == row else builder.fpext(found, row)
                builder.store(widened, at(lane, axis * LANES * 8, row), align=8 * GROUP)
            return context.get_dummy_value()

        return types.void(*[types.voidptr] * 5), code

    return transpose


transpose_f4 = transposer(ir.FloatType(), 4, 2)
transpose_f8 = transposer(ir.DoubleType(), 8, 8)


@njit(inline="always")
def clear(total):
    """Begin a block: sums at zero, extents empty."""
    for row in range(12):
        for lane in range(LANES):
            total[row, lane] = 0.0
    for row in range(12, 15):
        for lane in range(LANES):
            total[row, lane] = np.inf
            total[row + 3, lane] = -np.inf


@njit(inline="always")
def pad(corner, filled):
    """Fill the lanes from `filled` on with a point: no area, no volume, no new extent."""
    for lane in range(filled, LANES):
        for k in range(9):
            corner[k, lane] = corner[k % 3, 0]


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
        total[12, j] = min(total[12, j], min(x0, min(x1, x2)))
        total[13, j] = min(total[13, j], min(y0, min(y1, y2)))
        total[14, j] = min(total[14, j], min(z0, min(z1, z2)))
        total[15, j] = max(total[15, j], max(x0, max(x1, x2)))
        total[16, j] = max(total[16, j], max(y0, max(y1, y2)))
        total[17, j] = max(total[17, j], max(z0, max(z1, z2)))


@njit(inline="always")
def finish(total, out, block):
    """Add up the lanes as a binary tree and store the block."""
    half = LANES // 2
    while half > 0:
        for lane in range(half):
            for row in range(12):
                total[row, lane] += total[row, lane + half]
            for row in range(12, 15):
                total[row, lane] = min(total[row, lane], total[row, lane + half])
                total[row + 3, lane] = max(total[row + 3, lane], total[row + 3, lane + half])
        half //= 2
    for row in range(ROWS):
        out[block, row] = total[row, 0]


@njit(inline="always")
def facet(records, triangle, count, corner):
    """Return the address of a corner; past the last triangle, of the last one's."""
    return address(records, min(triangle, count - 1) * RECORD + (corner + 1) * CORNER)


@njit(inline="always")
def vertex(vertices, faces, triangle, count, corner):
    """Return the address of a corner; past the last triangle, of the last one's."""
    triangle = np.uint64(min(triangle, count - 1))  # spares the test for indices below 0
    return address(vertices, faces[triangle, corner] * 24)


def sum_facets(records, count, ox, oy, oz, surface, scratch, out_at):
    """Sum `count` binary STL records."""
    room = carray(scratch, (9 + ROWS, LANES), np.float64)
    corner, total = room[:9], room[9:]
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, ROWS), np.float64)
    for block in range(blocks):
        clear(total)
        for row in range(DEPTH):
            start = (block * DEPTH + row) * LANES
            filled = min(LANES, count - start)
            if filled <= 0:
                break
            for j in range(0, filled, GROUP):
                for k in range(3):
                    transpose_f4(
                        facet(records, start + j, count, k),
                        facet(records, start + j + 1, count, k),
                        facet(records, start + j + 2, count, k),
                        facet(records, start + j + 3, count, k),
                        address(scratch, (3 * k * LANES + j) * 8),
                    )
            pad(corner, filled)
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
        for row in range(DEPTH):
            start = (block * DEPTH + row) * LANES
            filled = min(LANES, count - start)
            if filled <= 0:
                break
            for j in range(0, filled, GROUP):
                for k in range(3):
                    transpose_f8(
                        vertex(vertices, faces, start + j, count, k),
                        vertex(vertices, faces, start + j + 1, count, k),
                        vertex(vertices, faces, start + j + 2, count, k),
                        vertex(vertices, faces, start + j + 3, count, k),
                        address(scratch, (3 * k * LANES + j) * 8),
                    )
            pad(corner, filled)
            add(corner, total, ox, oy, oz, surface)
        finish(total, out, block)
    return 0
