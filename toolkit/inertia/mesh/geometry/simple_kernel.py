"""The compiled check of small surfaces: closed, in one piece, and free of triangles that cross; see `simple`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import functools

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.extending import intrinsic

from inertia.mesh.geometry.crossing_kernel import ORIENT3D, SIDE, SMALLEST, TERMS, UNDERFLOW, cross

MOST = 4096
"""Triangles of a surface that there is room for; a power of two."""

CORNERS = 3 * MOST
SLOTS = 8 * MOST
GROUP = 16
"""Triangles, or such groups of them, whose boxes are compared with another one together."""

SIMPLE, NO_VERTEX, NOT_USABLE, REPEATED, UNPAIRED, PIECES, CROSSING, MANY = range(8)
"""What a surface is: the first, or what stands in the way."""

WORK = 18 + TERMS
SIGNS = 9 * MOST + WORK
BOXES = SIGNS + 8
ALONG = BOXES + 6 * MOST
NUMBERS = ALONG + 3 * CORNERS
DOUBLES = NUMBERS + (19 * MOST + SLOTS) // 2
"""Float64 in the scratch space."""

SLANT_X, SLANT_Y = 0.8125, 0.5859375

LARGEST = 1e75  # as `part.LARGEST`
PRIME_X, PRIME_Y, PRIME_Z = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xC2B2AE3D27D4EB4F), np.uint64(0x165667B19E3779F9)


@intrinsic
def meeting(context, base, lx, ly, lz, hx, hy, hz):
    """Return which of the `GROUP` boxes that begin at an address overlap another one, a bit each."""

    def code(context, builder, signature, arguments):
        base, *box = arguments
        four, index = ir.VectorType(ir.DoubleType(), 4), ir.IntType(32)
        splat = ir.Constant(ir.VectorType(index, 4), [0] * 4)
        same = [builder.insert_element(ir.Constant(four, ir.Undefined), side, index(0)) for side in box]
        same = [builder.shuffle_vector(side, side, splat) for side in same]
        bits = ir.IntType(64)(0)
        for part in range(0, GROUP, 4):
            rows = []
            for row in range(6):
                at = builder.gep(base, [ir.IntType(64)(8 * (MOST * row + part))])
                rows.append(builder.load(builder.bitcast(at, four.as_pointer()), align=8))
            meets = [builder.fcmp_ordered("<", rows[axis], same[axis + 3]) for axis in range(3)]
            meets += [builder.fcmp_ordered("<", same[axis], rows[axis + 3]) for axis in range(3)]
            together = functools.reduce(builder.and_, meets)
            lanes = builder.zext(builder.bitcast(together, ir.IntType(4)), ir.IntType(64))
            bits = builder.or_(bits, builder.shl(lanes, ir.IntType(64)(part)))
        return bits

    return types.int64(types.voidptr, *[types.float64] * 6), code


@intrinsic
def lowest_bit(context, bits):
    """Return the number of the lowest bit that is set."""

    def code(context, builder, signature, arguments):
        return builder.cttz(arguments[0], ir.IntType(1)(1))

    return types.int64(types.int64), code


@intrinsic
def address(context, base, offset):
    """Return the address `offset` bytes after `base`."""

    def code(context, builder, signature, arguments):
        return builder.gep(arguments[0], [arguments[1]])

    return types.voidptr(types.voidptr, types.int64), code


@njit(inline="always")
def number_corners(points, bits, faces, count, ids, of, places, slots, own, room):
    """Give equal corners one number, 0 on, and return how many there are, or −1 − what is wrong with one."""
    mask = room - 1
    for k in range(len(ids)):
        ids[k] = -1
    for k in range(room):
        slots[k] = -1
    numbered = 0
    for k in range(count):
        for corner in range(3):
            vertex = faces[k, corner]
            if vertex < 0 or vertex >= len(ids):
                return -1 - NO_VERTEX
            x, y, z = points[vertex, 0], points[vertex, 1], points[vertex, 2]
            own[k, 3 * corner], own[k, 3 * corner + 1], own[k, 3 * corner + 2] = x, y, z
            if ids[vertex] < 0:
                if not (abs(x) <= LARGEST and abs(y) <= LARGEST and abs(z) <= LARGEST):
                    return -1 - NOT_USABLE
                # Shifted by one bit, −0 is +0.
                key = (bits[vertex, 0] << np.uint64(1)) * PRIME_X + (bits[vertex, 1] << np.uint64(1)) * PRIME_Y
                key += (bits[vertex, 2] << np.uint64(1)) * PRIME_Z
                slot = np.int64((key ^ (key >> np.uint64(29))) * PRIME_X >> np.uint64(40)) & mask
                while slots[slot] >= 0:
                    other = places[slots[slot]]
                    if points[other, 0] == x and points[other, 1] == y and points[other, 2] == z:
                        break
                    slot = (slot + 1) & mask
                if slots[slot] < 0:
                    slots[slot] = numbered
                    places[numbered] = vertex
                    numbered += 1
                ids[vertex] = slots[slot]
            of[k, corner] = ids[vertex]
    return numbered


@njit(inline="always")
def pair_edges(of, count, numbered, first, edges, parent):
    """Pair every edge with the one other that runs against it, and return what the surface is.

    `first` is the last edge filed under a vertex, the lower of its two; `edges` are (the one filed before it, the
    higher vertex times 2 + the way it runs, the triangle, or −1 once it is paired).
    """
    for k in range(numbered):
        first[k] = -1
    filed = 0
    waiting = 0
    pieces = count
    for k in range(count):
        parent[k] = k
        if of[k, 0] == of[k, 1] or of[k, 1] == of[k, 2] or of[k, 2] == of[k, 0]:
            return REPEATED
        for side in range(3):
            tail, head = of[k, side], of[k, (side + 1) % 3]
            low = min(tail, head)
            this = 2 * max(tail, head) + (1 if tail < head else 0)
            at = first[low]
            while at >= 0 and edges[at, 1] >> 1 != this >> 1:
                at = edges[at, 0]
            if at < 0:
                edges[filed, 0], edges[filed, 1], edges[filed, 2] = first[low], this, k
                first[low] = filed
                filed += 1
                waiting += 1
                continue
            if edges[at, 1] == this or edges[at, 2] < 0:
                return UNPAIRED
            one, other = edges[at, 2], np.int32(k)
            edges[at, 2] = -1
            waiting -= 1
            while parent[one] != one:
                parent[one] = parent[parent[one]]
                one = parent[one]
            while parent[other] != other:
                parent[other] = parent[parent[other]]
                other = parent[other]
            if one != other:
                pieces -= 1
                parent[max(one, other)] = min(one, other)
    if waiting:
        return UNPAIRED
    return SIMPLE if pieces == 1 else PIECES


@njit(inline="always")
def common_corners(of, k, l):
    """Return which corners of a triangle another one has too, a bit each."""
    a, b, c = of[k, 0], of[k, 1], of[k, 2]
    p, q, r = of[l, 0], of[l, 1], of[l, 2]
    common = np.int64((a == p) | (a == q) | (a == r)) | np.int64((b == p) | (b == q) | (b == r)) << 1
    common |= np.int64((c == p) | (c == q) | (c == r)) << 2
    return common


@njit(inline="always")
def on_one_side(own, plane, triangle, common):
    """Say whether the plane of a triangle surely has another one, but for common corners, on one side."""
    ax, ay, az = own[plane, 0], own[plane, 1], own[plane, 2]
    ux, uy, uz = own[plane, 3] - ax, own[plane, 4] - ay, own[plane, 5] - az
    vx, vy, vz = own[plane, 6] - ax, own[plane, 7] - ay, own[plane, 8] - az
    px, qx = uy * vz, uz * vy
    py, qy = uz * vx, ux * vz
    pz, qz = ux * vy, uy * vx
    nx, ny, nz = px - qx, py - qy, pz - qz
    mx, my, mz = abs(px) + abs(qx), abs(py) + abs(qy), abs(pz) + abs(qz)
    above = below = True
    for corner in range(3):
        wx, wy, wz = (
            own[triangle, 3 * corner] - ax,
            own[triangle, 3 * corner + 1] - ay,
            own[triangle, 3 * corner + 2] - az,
        )
        height = wx * nx + wy * ny + wz * nz
        least = ORIENT3D * (abs(wx) * mx + abs(wy) * my + abs(wz) * mz)
        least += UNDERFLOW * (1 + (abs(wx) + abs(wy) + abs(wz)))
        free = (common >> corner) & 1 == 0
        above &= not free or height > least
        below &= not free or height < -least
    return above or below


@njit(inline="always")
def apart(own, k, l):
    """Say whether two triangles surely are apart along the line between their middles."""
    x, y, z = own[k, 0], own[k, 1], own[k, 2]
    dx = own[l, 0] + own[l, 3] + own[l, 6] - (own[k, 0] + own[k, 3] + own[k, 6])
    dy = own[l, 1] + own[l, 4] + own[l, 7] - (own[k, 1] + own[k, 4] + own[k, 7])
    dz = own[l, 2] + own[l, 5] + own[l, 8] - (own[k, 2] + own[k, 5] + own[k, 8])
    near, far, size = -np.inf, np.inf, 0.0
    for corner in range(0, 9, 3):
        ux, uy, uz = own[k, corner] - x, own[k, corner + 1] - y, own[k, corner + 2] - z
        vx, vy, vz = own[l, corner] - x, own[l, corner + 1] - y, own[l, corner + 2] - z
        near = max(near, dx * ux + dy * uy + dz * uz)
        far = min(far, dx * vx + dy * vy + dz * vz)
        size = max(
            size, abs(dx) * max(abs(ux), abs(vx)) + abs(dy) * max(abs(uy), abs(vy)) + abs(dz) * max(abs(uz), abs(vz))
        )
    return far - near > 2 * SIDE * size + SMALLEST


@njit(inline="always")
def aside(own, k, corner, other, dx, dy, dz):
    """Return on which side of a plane along d through one corner another corner is, 0 where that is not certain.

    The plane's normal is at right angles to d whatever the rounding, and along no axis that many parts are built on.
    """
    wx = own[k, 3 * other] - own[k, 3 * corner]
    wy = own[k, 3 * other + 1] - own[k, 3 * corner + 1]
    wz = own[k, 3 * other + 2] - own[k, 3 * corner + 2]
    if abs(dx) > abs(dy) and abs(dx) > abs(dz):
        wx, wy, wz, dx, dy, dz = wy, wz, wx, dy, dz, dx
    elif abs(dy) > abs(dz):
        wx, wy, wz, dx, dy, dz = wz, wx, wy, dz, dx, dy
    p, q = SLANT_X * wx + SLANT_Y * wy, SLANT_X * dx + SLANT_Y * dy
    height = dz * p - wz * q
    least = SIDE * (abs(dz) * (abs(wx) + abs(wy)) + abs(wz) * (abs(dx) + abs(dy))) + SMALLEST
    return 1 if height > least else (-1 if height < -least else 0)


@njit(inline="always")
def flatten_fans(own, of, count, numbered, along, turns):
    """Count how often the triangles around each corner go around it, seen along the sum of their normals.

    Where that is once, and each of them faces that way, they share nothing but the corner and their common edges: seen
    so, they lie side by side. `turns` is below zero where that is not certain.
    """
    for vertex in range(numbered):
        along[vertex, 0] = along[vertex, 1] = along[vertex, 2] = 0.0
        turns[vertex] = 0
    for turn in range(2):
        for k in range(count):
            x, y, z = own[k, 0], own[k, 1], own[k, 2]
            ux, uy, uz = own[k, 3] - x, own[k, 4] - y, own[k, 5] - z
            vx, vy, vz = own[k, 6] - x, own[k, 7] - y, own[k, 8] - z
            px, qx = uy * vz, uz * vy
            py, qy = uz * vx, ux * vz
            pz, qz = ux * vy, uy * vx
            nx, ny, nz = px - qx, py - qy, pz - qz
            if turn == 0:
                for corner in range(3):
                    vertex = of[k, corner]
                    along[vertex, 0] += nx
                    along[vertex, 1] += ny
                    along[vertex, 2] += nz
                continue
            mx, my, mz = abs(px) + abs(qx), abs(py) + abs(qy), abs(pz) + abs(qz)
            for corner in range(3):
                vertex = of[k, corner]
                dx, dy, dz = along[vertex, 0], along[vertex, 1], along[vertex, 2]
                least = ORIENT3D * (abs(dx) * mx + abs(dy) * my + abs(dz) * mz) + SMALLEST
                one = aside(own, k, corner, (corner + 1) % 3, dx, dy, dz)
                other = aside(own, k, corner, (corner + 2) % 3, dx, dy, dz)
                if not dx * nx + dy * ny + dz * nz > least or one == 0 or other == 0:
                    turns[vertex] = -MOST
                elif one < other:
                    turns[vertex] += 1


@njit(inline="always")
def may_cross(own, of, count, numbered, boxes, boxes_at, along, whole, whole_at, turns, pairs, signs, work):
    """Say whether two triangles cross, or cannot be shown not to; `along` and `whole` share their memory."""
    flatten_fans(own, of, count, numbered, along, turns)
    left = 0
    padded = (count + GROUP - 1) // GROUP * GROUP
    for axis in range(3):
        for k in range(count):
            a, b, c = own[k, axis], own[k, axis + 3], own[k, axis + 6]
            boxes[axis, k] = min(a, min(b, c))
            boxes[axis + 3, k] = max(a, max(b, c))
        for k in range(count, padded):
            boxes[axis, k] = np.inf
            boxes[axis + 3, k] = -np.inf
    groups = padded // GROUP
    for group in range(groups):
        for axis in range(3):
            low, high = np.inf, -np.inf
            for k in range(group * GROUP, (group + 1) * GROUP):
                low, high = min(low, boxes[axis, k]), max(high, boxes[axis + 3, k])
            whole[axis, group], whole[axis + 3, group] = low, high
    for group in range(groups, (groups + GROUP - 1) // GROUP * GROUP):
        for axis in range(3):
            whole[axis, group], whole[axis + 3, group] = np.inf, -np.inf
    for k in range(count):
        lx, ly, lz = boxes[0, k], boxes[1, k], boxes[2, k]
        hx, hy, hz = boxes[3, k], boxes[4, k], boxes[5, k]
        for several in range(k // (GROUP * GROUP) * GROUP, groups, GROUP):
            looked = meeting(address(whole_at, 8 * several), lx, ly, lz, hx, hy, hz)
            if several * GROUP <= k:
                looked &= -1 << (k // GROUP - several)
            while looked != 0:
                start = GROUP * (several + lowest_bit(looked))
                looked &= looked - 1
                near = meeting(address(boxes_at, 8 * start), lx, ly, lz, hx, hy, hz)
                if k >= start:
                    near &= -2 << (k - start)
                while near != 0:
                    j = start + lowest_bit(near)
                    near &= near - 1
                    common = common_corners(of, j, k)
                    # With two corners in common, they do not cross.
                    if common & (common - 1) != 0 or (common != 0 and turns[of[j, common >> 1]] == 1):
                        continue
                    if on_one_side(own, k, j, common) or on_one_side(own, j, k, common_corners(of, k, j)):
                        continue
                    if common == 0 and apart(own, k, j):
                        continue
                    if left == len(pairs):
                        return True
                    pairs[left, 0], pairs[left, 1] = k, j
                    left += 1
    while left > 0:
        left -= 1
        if cross(own, pairs[left, 0], pairs[left, 1], signs, work) != 0:
            return True
    return False


def check_small(vertices_at, vertices, faces_at, faces, table_at, meshes, ids_at, room, scratch, states_at):
    """Say of each of `meshes` surfaces what it is.

    A row of the table is (first vertex, vertices, first face, faces) of a surface, whose faces number its vertices from
    0 on; there is `room` for as many as any has.
    """
    points, bits = carray(vertices_at, (vertices, 3), np.float64), carray(vertices_at, (vertices, 3), np.uint64)
    corners = carray(faces_at, (faces, 3), np.int64)
    table = carray(table_at, (meshes, 4), np.int64)
    states = carray(states_at, (meshes,), np.int64)
    ids = carray(ids_at, (room,), np.int32)
    own, work = carray(scratch, (MOST, 9), np.float64), carray(address(scratch, 72 * MOST), (WORK,), np.float64)
    signs = carray(address(scratch, 8 * SIGNS), (8,), np.int64)
    boxes = carray(address(scratch, 8 * BOXES), (6, MOST), np.float64)
    along = carray(address(scratch, 8 * ALONG), (CORNERS, 3), np.float64)
    whole = carray(address(scratch, 8 * ALONG), (6, MOST), np.float64)
    of = carray(address(scratch, 8 * NUMBERS), (MOST, 3), np.int32)
    edges = carray(address(scratch, 8 * NUMBERS + 12 * MOST), (CORNERS, 3), np.int32)
    numbers = carray(address(scratch, 8 * NUMBERS + 48 * MOST), (7 * MOST + SLOTS,), np.int32)
    places, first = numbers[:CORNERS], numbers[CORNERS : 2 * CORNERS]
    parent, slots = numbers[2 * CORNERS : 2 * CORNERS + MOST], numbers[2 * CORNERS + MOST :]
    for mesh in range(meshes):
        start, size, begin, count = table[mesh, 0], table[mesh, 1], table[mesh, 2], table[mesh, 3]
        if count < 1 or count > MOST:
            states[mesh] = MANY
            continue
        capacity = 64
        while capacity < 2 * min(size, 3 * count):
            capacity *= 2
        numbered = number_corners(
            points[start : start + size], bits[start : start + size], corners[begin : begin + count], count,
            ids[:size], of, places, slots, own, capacity,
        )  # fmt: skip
        if numbered < 0:
            states[mesh] = -1 - numbered
            continue
        state = pair_edges(of, count, numbered, first, edges, parent)
        if state == SIMPLE and may_cross(
            own,
            of,
            count,
            numbered,
            boxes,
            address(scratch, 8 * BOXES),
            along,
            whole,
            address(scratch, 8 * ALONG),
            first,
            edges[:, :2],
            signs,
            work,
        ):
            state = CROSSING
        states[mesh] = state
    return 0
