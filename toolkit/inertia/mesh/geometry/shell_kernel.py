"""The compiled kernels that measure and nest the shells of a surface as its triangles stream by; see `sound_shells`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import math

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.crossing_kernel import spread

COLUMNS = 12
"""Numbers for each shell: its box, 6 × its volume, the size of the terms, a place on it, how many triangles it has."""

MEETS, INSIDE, AROUND = 1, 2, 4
"""What a shell's box does to that of another: meet it, lie in it, hold it."""

FIRST, SECOND, THIRD = 0.4140625, 0.3515625, 0.234375
"""Weights of the corners for a place on a triangle: in no plane of symmetry, so that few rays pass through edges."""

BLUR = 1e-14
"""What a height times the sides of a triangle is rounded by, at most, over the product of their lengths."""


def measure_shells(vertices_at, vertices, faces_at, labels_at, count, table_at, shells):
    """Add triangles to the rows of their shells; volumes are about a place on the first triangle of each."""
    corners = carray(vertices_at, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    labels = carray(labels_at, (count,), np.int32)
    table = carray(table_at, (shells, COLUMNS), np.float64)
    for k in range(count):
        row = labels[k]
        if row < 0:
            continue
        p, q, r = faces[k, 0], faces[k, 1], faces[k, 2]
        for axis in range(3):
            a, b, c = corners[p, axis], corners[q, axis], corners[r, axis]
            table[row, axis] = min(table[row, axis], a, b, c)
            table[row, 3 + axis] = max(table[row, 3 + axis], a, b, c)
            if table[row, 11] == 0.0:
                table[row, 8 + axis] = FIRST * a + SECOND * b + THIRD * c
        table[row, 11] += 1.0
        x0, y0, z0 = corners[p, 0], corners[p, 1], corners[p, 2]
        ux, uy, uz = corners[q, 0] - x0, corners[q, 1] - y0, corners[q, 2] - z0
        vx, vy, vz = corners[r, 0] - x0, corners[r, 1] - y0, corners[r, 2] - z0
        ax, ay, az = x0 - table[row, 8], y0 - table[row, 9], z0 - table[row, 10]
        table[row, 6] += ax * (uy * vz - uz * vy) + ay * (uz * vx - ux * vz) + az * (ux * vy - uy * vx)
        sizes = (ax * ax + ay * ay + az * az) * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz)
        table[row, 7] += math.sqrt(sizes)
    return 0


def curve_codes(table_at, shells, x, y, z, factor, codes_at):
    """Write the places of shells along a Z-order curve, by the middles of their boxes from (x, y, z) on."""
    table = carray(table_at, (shells, COLUMNS), np.float64)
    codes = carray(codes_at, (shells,), np.uint64)
    for k in range(shells):
        code = np.uint64(0)
        for axis in range(3):
            origin = x if axis == 0 else (y if axis == 1 else z)
            middle = 0.5 * table[k, axis] + 0.5 * table[k, 3 + axis]
            code |= spread(np.uint64(max((middle - origin) * factor, 0.0))) << np.uint64(axis)
        codes[k] = code
    return 0


def meet_boxes(table_at, order_at, count, family_at, boxes_at, stack_at, flags_at):
    """Enclose boxes two by two, and say which of them meet others of their family, lie in one and hold one.

    Shells are looked at in order, in which their families ascend. The boxes written, (2 count + 64, 6), are float32:
    rounding never changes an order, so that those that overlap still meet. `stack` has room for 256 rows.
    """
    table = carray(table_at, (count, COLUMNS), np.float64)
    order = carray(order_at, (count,), np.int64)
    family = carray(family_at, (count,), np.int64)
    boxes = carray(boxes_at, (2 * count + 64, 6), np.float32)
    stack = carray(stack_at, (256, 5), np.int64)
    flags = carray(flags_at, (count,), np.uint8)
    for k in range(count):
        for axis in range(6):
            boxes[k, axis] = np.float32(table[order[k], axis])
    start, size, level = 0, count, 0
    while size > 1:
        above = start + size
        half = (size + 1) // 2
        for k in range(half):
            one = start + 2 * k
            other = min(one + 1, above - 1)
            for axis in range(3):
                boxes[above + k, axis] = min(boxes[one, axis], boxes[other, axis])
                boxes[above + k, axis + 3] = max(boxes[one, axis + 3], boxes[other, axis + 3])
        stack[level, 4] = size
        start, size, level = above, half, level + 1
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = level, start, 0, 0
    waiting = 1 if level > 0 else 0
    while waiting > 0:
        waiting -= 1
        level, start, i, j = stack[waiting, 0], stack[waiting, 1], stack[waiting, 2], stack[waiting, 3]
        size = stack[level - 1, 4]
        start -= size
        for k in range(3, -1, -1):
            a, b = 2 * i + (k >> 1), 2 * j + (k & 1)
            if a > b or a >= size or b >= size:
                continue
            p, q = start + a, start + b
            if a != b:
                if not (
                    boxes[p, 0] <= boxes[q, 3]
                    and boxes[q, 0] <= boxes[p, 3]
                    and boxes[p, 1] <= boxes[q, 4]
                    and boxes[q, 1] <= boxes[p, 4]
                    and boxes[p, 2] <= boxes[q, 5]
                    and boxes[q, 2] <= boxes[p, 5]
                ):
                    continue
                one, other = order[min((a + 1) << (level - 1), count) - 1], order[b << (level - 1)]
                if family[one] < family[other]:
                    continue
                if level == 1:
                    apart, a_in_b, b_in_a = False, True, True
                    for axis in range(3):
                        low, high = table[one, axis], table[one, axis + 3]
                        lower, higher = table[other, axis], table[other, axis + 3]
                        apart |= high < lower or higher < low
                        a_in_b &= lower <= low and high <= higher
                        b_in_a &= low <= lower and higher <= high
                    if not apart:
                        flags[one] |= MEETS
                        flags[other] |= MEETS
                    if a_in_b:
                        flags[one] |= INSIDE
                        flags[other] |= AROUND
                    if b_in_a:
                        flags[other] |= INSIDE
                        flags[one] |= AROUND
            if level > 1:
                stack[waiting, 0], stack[waiting, 1], stack[waiting, 2], stack[waiting, 3] = level - 1, start, a, b
                waiting += 1
    return 0


@njit(error_model="numpy", forceinline=True)
def upwards(ax, ay, bx, by):
    """Return the crossing of the positive x axis by an edge: 1 upwards, −1 downwards; opposite if it is reversed."""
    side = ax * by - ay * bx
    if ay <= 0.0 and by > 0.0 and side > 0.0:
        return 1
    if by <= 0.0 and ay > 0.0 and side < 0.0:
        return -1
    return 0


def cast_rays(
    vertices_at, vertices, faces_at, labels_at, count,
    table_at, shells, flags_at, signs_at, numbers_at, radii_at,
    points_at, whose_at, points, cells_at, across, x, y, step_x, step_y, margin, sums_at, depths_at,
):  # fmt: skip
    """Add what triangles cross of the rays from points upwards to the sums and depths of the points' shells.

    Points (x, y, z) lie in order of `across` × `across` cells of the xy plane, each of which begins at `cells`. To the
    sum goes the number of the shell that is crossed, to the depth its sign, each as often as it is crossed. `radii` are
    the squares of those of the shells that lie in others, about the middles of their boxes. Returns 1 where a point is
    nearer than the margin to another shell, so that it cannot be told.
    """
    corners = carray(vertices_at, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    labels = carray(labels_at, (count,), np.int32)
    table = carray(table_at, (shells, COLUMNS), np.float64)
    flags = carray(flags_at, (shells,), np.uint8)
    signs = carray(signs_at, (shells,), np.int64)
    numbers = carray(numbers_at, (shells,), np.int64)
    radii = carray(radii_at, (shells,), np.float64)
    place = carray(points_at, (points, 3), np.float64)
    whose = carray(whose_at, (points,), np.int64)
    cells = carray(cells_at, (across * across + 1,), np.int64)
    sums = carray(sums_at, (shells,), np.int64)
    depths = carray(depths_at, (shells,), np.int64)
    unclear = 0
    for k in range(count):
        shell = labels[k]
        if shell < 0:
            continue
        if flags[shell] & INSIDE:
            mx = 0.5 * table[shell, 0] + 0.5 * table[shell, 3]
            my = 0.5 * table[shell, 1] + 0.5 * table[shell, 4]
            mz = 0.5 * table[shell, 2] + 0.5 * table[shell, 5]
            for corner in range(3):
                at = faces[k, corner]
                dx, dy, dz = corners[at, 0] - mx, corners[at, 1] - my, corners[at, 2] - mz
                radii[shell] = max(radii[shell], dx * dx + dy * dy + dz * dz)
        if not flags[shell] & AROUND:
            continue
        p, q, r = faces[k, 0], faces[k, 1], faces[k, 2]
        lx = min(corners[p, 0], corners[q, 0], corners[r, 0]) - margin
        hx = max(corners[p, 0], corners[q, 0], corners[r, 0]) + margin
        ly = min(corners[p, 1], corners[q, 1], corners[r, 1]) - margin
        hy = max(corners[p, 1], corners[q, 1], corners[r, 1]) + margin
        lz = min(corners[p, 2], corners[q, 2], corners[r, 2]) - margin
        hz = max(corners[p, 2], corners[q, 2], corners[r, 2]) + margin
        left = int(max((lx - x) * step_x - 1e-6, 0.0))
        right = min(int(max((hx - x) * step_x + 1e-6, 0.0)), across - 1)
        near = int(max((ly - y) * step_y - 1e-6, 0.0))
        far = min(int(max((hy - y) * step_y + 1e-6, 0.0)), across - 1)
        for row in range(near, far + 1):
            if left > right:
                break
            for at in range(cells[row * across + left], cells[row * across + right + 1]):
                px, py, pz = place[at, 0], place[at, 1], place[at, 2]
                if hz < pz or px < lx or hx < px or py < ly or hy < py or whose[at] == shell:
                    continue
                ax, ay, az = corners[p, 0] - px, corners[p, 1] - py, corners[p, 2] - pz
                bx, by, bz = corners[q, 0] - px, corners[q, 1] - py, corners[q, 2] - pz
                cx, cy, cz = corners[r, 0] - px, corners[r, 1] - py, corners[r, 2] - pz
                turns = upwards(ax, ay, bx, by) + upwards(bx, by, cx, cy) + upwards(cx, cy, ax, ay)
                if lz <= pz:
                    bx, by, bz, cx, cy, cz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
                    nx, ny, nz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
                    height = ax * nx + ay * ny + az * nz
                    sizes = (bx * bx + by * by + bz * bz) * (cx * cx + cy * cy + cz * cz)
                    blur = BLUR * math.sqrt(sizes * (ax * ax + ay * ay + az * az))
                    if not abs(height) > margin * math.sqrt(nx * nx + ny * ny + nz * nz) + blur:
                        unclear = 1
                    if height * turns < 0.0:
                        continue
                if turns != 0:
                    sums[whose[at]] += turns * numbers[shell]
                    depths[whose[at]] += turns * signs[shell]
    return unclear


def near_children(
    vertices_at,
    vertices,
    faces_at,
    labels_at,
    count,
    table_at,
    shells,
    radii_at,
    boxes_at,
    order_at,
    ranges_at,
    near_at,
    flags_at,
):
    """Mark the triangles that may meet a shell next inside their own, and these shells.

    `boxes` are those of the shells in order, and enclosing them, as `meet_boxes` leaves them; `ranges` says where those
    next inside a shell begin and end. A triangle is apart from one whose box its own does not meet, or where its plane
    passes the sphere around it.
    """
    corners = carray(vertices_at, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    labels = carray(labels_at, (count,), np.int32)
    table = carray(table_at, (shells, COLUMNS), np.float64)
    radii = carray(radii_at, (shells,), np.float64)
    boxes = carray(boxes_at, (2 * shells + 64, 6), np.float32)
    order = carray(order_at, (shells,), np.int64)
    ranges = carray(ranges_at, (shells, 2), np.int64)
    near = carray(near_at, (count,), np.uint8)
    flags = carray(flags_at, (shells,), np.uint8)
    for k in range(count):
        shell = labels[k]
        if shell < 0 or ranges[shell, 0] == ranges[shell, 1]:
            continue
        p, q, r = faces[k, 0], faces[k, 1], faces[k, 2]
        ax, ay, az = corners[p, 0], corners[p, 1], corners[p, 2]
        bx, by, bz = corners[q, 0], corners[q, 1], corners[q, 2]
        cx, cy, cz = corners[r, 0], corners[r, 1], corners[r, 2]
        lx, ly, lz = np.float32(min(ax, bx, cx)), np.float32(min(ay, by, cy)), np.float32(min(az, bz, cz))
        hx, hy, hz = np.float32(max(ax, bx, cx)), np.float32(max(ay, by, cy)), np.float32(max(az, bz, cz))
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        normal = math.sqrt(nx * nx + ny * ny + nz * nz)
        sides = (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz)
        at, last = ranges[shell, 0], ranges[shell, 1]
        level, most = 0, 63
        while at < last:
            # The largest block of 2^level boxes that begins here and ends within the range.
            level, start, size = 0, 0, shells
            while level < most and not (at >> level) & 1 and at + (2 << level) <= last:
                start, size, level = start + size, (size + 1) // 2, level + 1
            row = start + (at >> level)
            if not (
                lx <= boxes[row, 3]
                and boxes[row, 0] <= hx
                and ly <= boxes[row, 4]
                and boxes[row, 1] <= hy
                and lz <= boxes[row, 5]
                and boxes[row, 2] <= hz
            ):
                at, most = at + (1 << level), 63
                continue
            if level > 0:
                most = level - 1
                continue
            child = order[at]
            mx = 0.5 * table[child, 0] + 0.5 * table[child, 3] - ax
            my = 0.5 * table[child, 1] + 0.5 * table[child, 4] - ay
            mz = 0.5 * table[child, 2] + 0.5 * table[child, 5] - az
            height = abs(mx * nx + my * ny + mz * nz)
            blur = BLUR * math.sqrt(sides * (mx * mx + my * my + mz * mz))
            if not height - blur > (1.0 + 1e-12) * math.sqrt(radii[child]) * normal:
                near[k] = 1
                flags[child] |= MEETS
            at, most = at + 1, 63
    return 0
