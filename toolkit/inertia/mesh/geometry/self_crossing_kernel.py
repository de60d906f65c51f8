"""The search of small surfaces for triangles that cross: by boxes, fans around corners, planes, and exact signs.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.extending import intrinsic

from inertia.mesh.geometry.box_kernel import (
    BLOCKS,
    GROUP,
    MOST,
    address,
    apart_aslant,
    block,
    boxes_apart,
    lane,
    lowest_bit,
    meeting,
    meeting_apart,
    noted,
)
from inertia.mesh.geometry.crossing_kernel import ORIENT3D, SIDE, SMALLEST, TERMS, UNDERFLOW, cross

CORNERS = 3 * MOST
WORK = 18 + TERMS
ENOUGH = 4096
"""Pairs of triangles that are looked at together."""

IDLE, TESTED = 256, 64
"""Pairs whose boxes touch at most, for each triangle, of which others who look for crossings need none; of so many
pairs, one is tested for that."""

ELSEWHERE, NOT_FLAT = 2**16 - 2, 2**16 - 1
"""Numbers, in 16 bits, of a corner that is too far from those of a group, and of one that is not flat (`mark_flat`)."""

RECORD = 8
"""Numbers for each vertex: a direction and a bound, a normal and a bound (see `flatten_fans`)."""

SLANT_X, SLANT_Y = 0.8125, 0.5859375
STEEPEST = 1.4  # more than their sum


@intrinsic
def transpose(context, a, b, c, d, to):
    """Store the four float64 at each of four addresses as columns of rows `GROUP` long."""

    def code(context, builder, signature, arguments):
        *places, to = arguments
        row = ir.VectorType(ir.DoubleType(), 4)

        def mixed(one, other, order):
            return builder.shuffle_vector(one, other, ir.Constant(ir.VectorType(ir.IntType(32), 4), order))

        a, b, c, d = (builder.load(builder.bitcast(place, row.as_pointer()), align=8) for place in places)
        even, odd = [0, 4, 2, 6], [1, 5, 3, 7]
        p, q, r, s = mixed(a, b, even), mixed(a, b, odd), mixed(c, d, even), mixed(c, d, odd)
        first, last = [0, 1, 4, 5], [2, 3, 6, 7]
        for k, column in enumerate((mixed(p, r, first), mixed(q, s, first), mixed(p, r, last), mixed(q, s, last))):
            at = builder.gep(to, [ir.IntType(64)(8 * GROUP * k)])
            builder.store(column, builder.bitcast(at, row.as_pointer()), align=8)
        return context.get_dummy_value()

    return types.void(*[types.voidptr] * 5), code


@njit(inline="always")
def common_corners(of, k, l):
    """Return which corners of a triangle another one has too, a bit each."""
    a, b, c = of[k, 0], of[k, 1], of[k, 2]
    p, q, r = of[l, 0], of[l, 1], of[l, 2]
    common = np.int64((a == p) | (a == q) | (a == r)) | np.int64((b == p) | (b == q) | (b == r)) << 1
    common |= np.int64((c == p) | (c == q) | (c == r)) << 2
    return common


@njit(inline="always")
def on_one_side(own, normals, plane, triangle, common):
    """Say whether the plane of a triangle surely has another one, but for common corners, on one side."""
    j, plane, i, triangle = lane(plane), block(plane), lane(triangle), block(triangle)
    ax, ay, az = own[plane, 0, j], own[plane, 1, j], own[plane, 2, j]
    nx, ny, nz, size = normals[plane, 0, j], normals[plane, 1, j], normals[plane, 2, j], ORIENT3D * normals[plane, 3, j]
    above = below = True
    for corner in range(3):
        wx, wy, wz = (
            own[triangle, 3 * corner, i] - ax,
            own[triangle, 3 * corner + 1, i] - ay,
            own[triangle, 3 * corner + 2, i] - az,
        )
        height = wx * nx + wy * ny + wz * nz
        least = (size + UNDERFLOW) * (abs(wx) + abs(wy) + abs(wz)) + UNDERFLOW
        free = (common >> corner) & 1 == 0
        above &= not free or height > least
        below &= not free or height < -least
    return above or below


@njit(inline="always")
def apart(own, k, l):
    """Say whether two triangles surely are apart along the line between their middles."""
    i, k, j, l = lane(k), block(k), lane(l), block(l)
    x, y, z = own[k, 0, i], own[k, 1, i], own[k, 2, i]
    dx = own[l, 0, j] + own[l, 3, j] + own[l, 6, j] - (own[k, 0, i] + own[k, 3, i] + own[k, 6, i])
    dy = own[l, 1, j] + own[l, 4, j] + own[l, 7, j] - (own[k, 1, i] + own[k, 4, i] + own[k, 7, i])
    dz = own[l, 2, j] + own[l, 5, j] + own[l, 8, j] - (own[k, 2, i] + own[k, 5, i] + own[k, 8, i])
    near, far, size = -np.inf, np.inf, 0.0
    for corner in range(0, 9, 3):
        ux, uy, uz = own[k, corner, i] - x, own[k, corner + 1, i] - y, own[k, corner + 2, i] - z
        vx, vy, vz = own[l, corner, j] - x, own[l, corner + 1, j] - y, own[l, corner + 2, j] - z
        near = max(near, dx * ux + dy * uy + dz * uz)
        far = min(far, dx * vx + dy * vy + dz * vz)
        size = max(
            size, abs(dx) * max(abs(ux), abs(vx)) + abs(dy) * max(abs(uy), abs(vy)) + abs(dz) * max(abs(uz), abs(vz))
        )
    return far - near > 2 * SIDE * size + SMALLEST


@njit(inline="always")
def fill_normals(own_at, of, count, numbered, normals_at, fans):
    """Write the normals of the triangles, and a bound on what went into them; sum them at each corner."""
    for vertex in range(numbered):
        fans[vertex, 0] = fans[vertex, 1] = fans[vertex, 2] = 0.0
    for start in range(0, count, GROUP):
        own = carray(address(own_at, 8 * 9 * start), (9, GROUP), np.float64)
        normals = carray(address(normals_at, 8 * 4 * start), (4, GROUP), np.float64)
        for k in range(GROUP):
            x, y, z = own[0, k], own[1, k], own[2, k]
            ux, uy, uz = own[3, k] - x, own[4, k] - y, own[5, k] - z
            vx, vy, vz = own[6, k] - x, own[7, k] - y, own[8, k] - z
            px, qx = uy * vz, uz * vy
            py, qy = uz * vx, ux * vz
            pz, qz = ux * vy, uy * vx
            normals[0, k], normals[1, k], normals[2, k] = px - qx, py - qy, pz - qz
            normals[3, k] = max(max(abs(px) + abs(qx), abs(py) + abs(qy)), abs(pz) + abs(qz))
        for k in range(min(GROUP, count - start)):
            x, y, z = normals[0, k], normals[1, k], normals[2, k]
            for corner in range(3):
                at = np.uint64(of[start + k, corner])
                fans[at, 0] += x
                fans[at, 1] += y
                fans[at, 2] += z


@njit(inline="always")
def flatten_fans(own_at, of, count, numbered, normals_at, fans_at, lanes_at, turns):
    """Count how often the triangles around each corner go around it, seen along the sum of their normals, d.

    Where that is once, and each of them faces that way, they share nothing but the corner and their common edges: seen
    so, they lie side by side. `turns` is below zero where that is not certain. They go around once where they pass once
    through a plane along d, from one side to the other. Its normal is at right angles to d whatever the rounding, and
    along no axis that many parts are built on. The record of a corner is d, a factor of the bound on what rounding does
    to d·n, the plane's normal, and the factor of that.
    """
    fans = carray(fans_at, (CORNERS // 2, RECORD), np.float64)
    lanes = carray(lanes_at, (27, GROUP), np.float64)
    fill_normals(own_at, of, count, numbered, normals_at, fans)
    for vertex in range(numbered):
        dx, dy, dz = fans[vertex, 0], fans[vertex, 1], fans[vertex, 2]
        ax, ay, az = abs(dx), abs(dy), abs(dz)
        along_x = ax > ay and ax > az
        along_y = not along_x and ay > az
        fans[vertex, 3] = ORIENT3D * (ax + ay + az)
        fans[vertex, 4] = -(SLANT_X * dy + SLANT_Y * dz) if along_x else (SLANT_Y * dy if along_y else SLANT_X * dz)
        fans[vertex, 5] = SLANT_X * dx if along_x else (-(SLANT_X * dz + SLANT_Y * dx) if along_y else SLANT_Y * dz)
        fans[vertex, 6] = SLANT_Y * dx if along_x else (SLANT_X * dy if along_y else -(SLANT_X * dx + SLANT_Y * dy))
        fans[vertex, 7] = SIDE * STEEPEST * max(ax, max(ay, az))
        turns[vertex] = 0.0
    for k in range(count, -(-count // GROUP) * GROUP):
        of[k, 0], of[k, 1], of[k, 2] = of[0, 0], of[0, 1], of[0, 2]
    for start in range(0, count, GROUP):
        for k in range(0, GROUP, 4):
            for corner in range(3):
                a = address(fans_at, 8 * RECORD * np.int64(of[start + k, corner]))
                b = address(fans_at, 8 * RECORD * np.int64(of[start + k + 1, corner]))
                c = address(fans_at, 8 * RECORD * np.int64(of[start + k + 2, corner]))
                d = address(fans_at, 8 * RECORD * np.int64(of[start + k + 3, corner]))
                to = address(lanes_at, 8 * (RECORD * GROUP * corner + k))
                transpose(a, b, c, d, to)
                half = 8 * RECORD // 2
                transpose(
                    address(a, half), address(b, half), address(c, half), address(d, half), address(to, GROUP * half)
                )
        own = carray(address(own_at, 8 * 9 * start), (9, GROUP), np.float64)
        normals = carray(address(normals_at, 8 * 4 * start), (4, GROUP), np.float64)
        for k in range(GROUP):
            nx, ny, nz, size = normals[0, k], normals[1, k], normals[2, k], normals[3, k]
            x0, y0, z0 = own[0, k], own[1, k], own[2, k]
            x1, y1, z1 = own[3, k], own[4, k], own[5, k]
            x2, y2, z2 = own[6, k], own[7, k], own[8, k]
            ux, uy, uz = x1 - x0, y1 - y0, z1 - z0
            vx, vy, vz = x2 - x1, y2 - y1, z2 - z1
            wx, wy, wz = x0 - x2, y0 - y2, z0 - z2
            u, v, w = abs(ux) + abs(uy) + abs(uz), abs(vx) + abs(vy) + abs(vz), abs(wx) + abs(wy) + abs(wz)
            lanes[24, k] = rise(lanes, 0, k, nx, ny, nz, size, ux, uy, uz, u, wx, wy, wz, w)
            lanes[25, k] = rise(lanes, 8, k, nx, ny, nz, size, vx, vy, vz, v, ux, uy, uz, u)
            lanes[26, k] = rise(lanes, 16, k, nx, ny, nz, size, wx, wy, wz, w, vx, vy, vz, v)
        for k in range(min(GROUP, count - start)):
            for corner in range(3):
                turns[np.uint64(of[start + k, corner])] += lanes[24 + corner, k]


@njit(inline="always")
def rise(lanes, at, j, nx, ny, nz, size, ux, uy, uz, u, wx, wy, wz, w):
    """Return 1 where a triangle passes through the plane of a corner from below, else 0; −`MOST` where it may.

    u is the edge that leaves the corner and w the one that ends there.
    """
    dx, dy, dz, d = lanes[at, j], lanes[at + 1, j], lanes[at + 2, j], lanes[at + 3, j]
    mx, my, mz, m = lanes[at + 4, j], lanes[at + 5, j], lanes[at + 6, j], lanes[at + 7, j]
    one, other = ux * mx + uy * my + uz * mz, wx * mx + wy * my + wz * mz
    sure = (dx * nx + dy * ny + dz * nz > d * size + SMALLEST) & (abs(one) > m * u + SMALLEST)
    sure &= abs(other) > m * w + SMALLEST
    return (1.0 if (one < 0) & (other < 0) else 0.0) if sure else -1.0 * MOST


@njit(inline="always")
def bring(own, k, two, row):
    """Copy the corners of a triangle."""
    for corner in range(9):
        two[row, corner] = own[block(k), corner, lane(k)]


@njit(inline="always")
def settled(pairs, left, own, normals, of, slants_at, turns, two, signs, work):
    """Say whether none of some pairs of triangles whose boxes meet cross; k and l are packed into one number."""
    for at in range(left):
        k, l = np.uint64(pairs[at] >> 32), np.uint64(pairs[at] & 0xFFFFFFFF)
        a, b, c = np.int64(of[k, 0]), np.int64(of[k, 1]), np.int64(of[k, 2])
        if apart_aslant(slants_at, a, b, c, np.int64(of[l, 0]), np.int64(of[l, 1]), np.int64(of[l, 2])):
            continue
        common = common_corners(of, l, k)
        # With two corners in common, they do not cross, nor with one around which all lie side by side.
        if common & (common - 1) != 0:
            continue
        if common != 0 and turns[np.uint64(of[l, lowest_bit(common)])] == 1.0:
            continue
        if on_one_side(own, normals, k, l, common) or on_one_side(own, normals, l, k, common_corners(of, k, l)):
            continue
        if common == 0 and apart(own, k, l):
            continue
        bring(own, k, two, 0)
        bring(own, l, two, 1)
        if cross(two, 0, 1, signs, work) != 0:
            return False
    return True


@njit(inline="always")
def mark_flat(of, count, numbered, turns, flat_at):
    """Write the corners around which all triangles lie side by side, as `short` says, and `NOT_FLAT` for others."""
    flat = carray(flat_at, (BLOCKS, 3, GROUP), np.uint16)
    for k in range(count):
        base = first_of(of, block(k), numbered)
        for corner in range(3):
            vertex = of[k, corner]
            number = short(vertex, base)
            far = number == ELSEWHERE or turns[np.uint64(vertex)] != 1.0
            flat[block(k), corner, lane(k)] = NOT_FLAT if far else number


@njit(inline="always")
def first_of(of, group, numbered):
    """Return the first of the corners that have a number of 16 bits for a group of triangles."""
    return max(0, min(np.int64(of[group << np.uint64(4), 0]) - ELSEWHERE // 2, numbered - ELSEWHERE))


@njit(inline="always")
def short(vertex, base):
    """Return the number of a corner in 16 bits, `ELSEWHERE` where it has none."""
    return np.uint16(min(np.uint64(vertex - base), np.uint64(ELSEWHERE)))


@njit(inline="always")
def may_cross(
    own, normals, of, count, numbered, boxes_at, groups_at, heaps_at, flat_at, slants_at, turns,
    near, pairs, two, signs, work,
):  # fmt: skip
    """Say whether two triangles cross, or cannot be shown not to with little work.

    Those that have a corner in common around which all lie side by side (see `flatten_fans`) are passed over.
    """
    boxes = carray(boxes_at, (BLOCKS, 6, GROUP), np.int16)
    groups = carray(groups_at, (BLOCKS, 6, GROUP), np.int16)
    several_groups, heaps = -(-count // GROUP), -(-count // GROUP**2)
    listed = np.uint64(0)
    idle = 0
    for group in range(several_groups):
        at, j = block(group), lane(group)
        lx, ly, lz = groups[at, 0, j], groups[at, 1, j], groups[at, 2, j]
        hx, hy, hz = groups[at, 3, j], groups[at, 4, j], groups[at, 5, j]
        for several in range(group // GROUP**2 * GROUP, heaps, GROUP):
            heaped = 1 if heaps == 1 else meeting(address(heaps_at, 12 * several), lx, ly, lz, hx, hy, hz)
            if several * GROUP <= group:
                heaped &= -1 << (group // GROUP - several)
            while heaped != 0:
                first = GROUP * (several + lowest_bit(heaped))
                heaped &= heaped - 1
                looked = meeting(address(groups_at, 12 * first), lx, ly, lz, hx, hy, hz)
                if first <= group:
                    looked &= -1 << (group - first)
                listed = noted(near, listed, group << 32 | first, looked, 0)
        if listed > np.uint64(ENOUGH) or group == several_groups - 1:
            left = np.uint64(0)
            for entry in range(listed):
                one, other = near[entry] >> 32, near[entry] & 0xFFFFFFFF
                at, j = block(other), lane(other)
                looking = meeting(
                    address(boxes_at, 12 * GROUP * one),
                    groups[at, 0, j], groups[at, 1, j], groups[at, 2, j],
                    groups[at, 3, j], groups[at, 4, j], groups[at, 5, j],
                )  # fmt: skip
                base = first_of(of, np.uint64(other), numbered)
                while looking != 0:
                    j = np.uint64(lowest_bit(looking))
                    looking &= looking - 1
                    k = np.uint64(GROUP * one) + j
                    looked = meeting_apart(
                        address(boxes_at, 12 * GROUP * other),
                        boxes[one, 0, j], boxes[one, 1, j], boxes[one, 2, j],
                        boxes[one, 3, j], boxes[one, 4, j], boxes[one, 5, j],
                        address(flat_at, 6 * GROUP * other),
                        short(of[k, 0], base), short(of[k, 1], base), short(of[k, 2], base),
                    )  # fmt: skip
                    if one == other:
                        looked &= -2 << np.int64(j)
                    left = noted(pairs, left, np.int64(k) << 32 | GROUP * other, looked, 0)
                if left > np.uint64(ENOUGH) or entry == listed - 1:
                    for at in range(0, left, TESTED):
                        if boxes_apart(own, np.uint64(pairs[at] >> 32), np.uint64(pairs[at] & 0xFFFFFFFF)):
                            idle += TESTED
                    if idle > IDLE * count or not settled(
                        pairs, left, own, normals, of, slants_at, turns, two, signs, work
                    ):
                        return True
                    left = np.uint64(0)
            listed = np.uint64(0)
    return False
