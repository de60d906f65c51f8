"""The compiled search for planes between shells whose boxes meet, or of which one holds the other; see `sound_shells`.

Which direction is tried need not be exact: that of the middles of two shells first, then that of the point nearest the
origin among the differences of their points found so far (E. G. Gilbert, D. W. Johnson and S. S. Keerthi, "A fast
procedure for computing the distance between complex objects in three-dimensional space", IEEE Journal of Robotics and
Automation 4 (1988) 193). That a plane at right angles to it holds the shells apart is exact, with the rounding of
float32 allowed for.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.extending import intrinsic

from inertia.mesh.geometry.record_kernel import triangle
from inertia.mesh.geometry.shell_kernel import (
    BLUR,
    COLUMNS,
    MEETS,
    NEAR,
    TINY,
    girth,
    larger,
    least,
    most,
    overlap,
    smaller,
)

DIRECTIONS, FURTHER = 1, 12
"""Directions that are tried of whole shells; of their triangles near each other."""

MANY, SOME = 32, 8
"""Points that are projected together."""

ROOM = 2.0**-21
"""More than what storing points and projecting them rounds by, over how far they are from the middle of their box."""

PAD = 2.0**-22
"""More than storing points, and the boxes of others, rounds by, over the sides of both boxes."""

WHOLE = 16
"""Of a shell all of whose triangles may meet others, as far as is known; beside what its box does to others."""

SMALLEST = 2.0**-126
"""Above what float32 numbers that underflow are off by."""

SHARE = 2.0**-20
"""Of a squared height, that it has to be larger than what it is compared with; a quarter of it for the rounding."""

FLAT = 1e-14
"""Of the squared sides of a triangle, what its squared area has to be more than for its inside to be looked at."""


def copy_shells(
    base, vertices, faces_at, labels_at, count, first, table_at, shells, flags_at, zones_at, ends_at,
    numbers_at, points_at, slots,
):  # fmt: skip
    """Copy the triangles in the zones of shells that meet others, shell by shell: float32, about the middles of boxes.

    `points`, (3, 3 slots), has their corners axis by axis, `numbers` the numbers of the triangles, which begin with
    `first`; those of a shell go where `ends` says, which moves on.
    """
    corners = carray(base, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    labels = carray(labels_at, (count,), np.int32)
    table = carray(table_at, (shells, COLUMNS), np.float64)
    flags = carray(flags_at, (shells,), np.uint8)
    zones = carray(zones_at, (shells, 6), np.float64)
    ends = carray(ends_at, (shells,), np.int64)
    numbers = carray(numbers_at, (slots,), np.int64)
    points = carray(points_at, (3, 3 * slots), np.float32)
    for k in range(count):
        shell = labels[k]
        if shell < 0 or not flags[shell] & MEETS:
            continue
        (a, b, c), beside = triangle(base, corners, faces, vertices < 0, k), False
        for axis in range(3):
            x, y, z = a[axis], b[axis], c[axis]
            beside |= (most(x, y, z, z) < zones[shell, axis]) | (zones[shell, axis + 3] < least(x, y, z, z))
        if beside:
            continue
        at = ends[shell]
        for axis in range(3):
            middle = 0.5 * table[shell, axis] + 0.5 * table[shell, axis + 3]
            points[axis, 3 * at] = np.float32(a[axis] - middle)
            points[axis, 3 * at + 1] = np.float32(b[axis] - middle)
            points[axis, 3 * at + 2] = np.float32(c[axis] - middle)
        numbers[at] = first + k
        ends[shell] = at + 1
    return 0


def highest_of(lanes):
    """Make the function that returns the largest projection of so many points, one after another, onto a direction."""

    @intrinsic
    def of_several(context, points, k, x, y, z):
        """Return that of points from the k-th on, of (3, n) float32."""

        def code(context, builder, signature, arguments):
            numbers = ir.VectorType(ir.FloatType(), lanes)
            table = context.make_array(signature.args[0])(context, builder, arguments[0])
            row, place = builder.extract_value(table.strides, 0), builder.gep(table.data, [arguments[1]])
            place, heights = builder.bitcast(place, ir.IntType(8).as_pointer()), None

            def part(first, count):
                return ir.Constant(ir.VectorType(ir.IntType(32), count), [*range(first, first + count)])

            for direction in arguments[2:]:
                alone = builder.insert_element(ir.Constant(numbers, ir.Undefined), direction, ir.IntType(32)(0))
                same = builder.shuffle_vector(alone, alone, ir.Constant(part(0, lanes).type, [0] * lanes))
                along = builder.load(builder.bitcast(place, numbers.as_pointer()), align=4)
                product = builder.fmul(along, same, flags=("contract",))
                heights = product if heights is None else builder.fadd(heights, product, flags=("contract",))
                place = builder.gep(place, [row])
            half = lanes // 2
            while half:
                one, other = (builder.shuffle_vector(heights, heights, part(first, half)) for first in (0, half))
                heights = builder.select(builder.fcmp_ordered(">", one, other), one, other)
                half //= 2
            return builder.extract_element(heights, ir.IntType(32)(0))

        return types.float32(points, types.int64, types.float32, types.float32, types.float32), code

    return of_several


highest_of_many, highest_of_some = highest_of(MANY), highest_of(SOME)


@njit(error_model="numpy", forceinline=True)
def highest(points, k, end, x, y, z):
    """Return the largest projection of points onto a direction: many at a time, as vector instructions have it."""
    best = np.float32(-np.inf)
    while k + MANY <= end:
        best = larger(best, highest_of_many(points, k, x, y, z))
        k += MANY
    while k + SOME <= end:
        best = larger(best, highest_of_some(points, k, x, y, z))
        k += SOME
    while k < end:
        best = larger(best, x * points[0, k] + y * points[1, k] + z * points[2, k])
        k += 1
    return best


@njit(error_model="numpy", forceinline=True)
def farthest(points, begin, end, x, y, z):
    """Return which of the points has the largest projection onto a direction."""
    largest, at = np.float32(-np.inf), begin
    for k in range(begin, end):
        height = x * points[0, k] + y * points[1, k] + z * points[2, k]
        if height > largest:
            largest, at = height, k
    return at


@njit(error_model="numpy", forceinline=True)
def nearest(simplex, n):
    """Return the point of a simplex of n ≤ 4 corners that is nearest the origin, among what its last corner belongs to.

    Corners that it does not need are dropped; where the origin lies inside, there are 4 left.
    """
    px, py, pz = simplex[n - 1, 0], simplex[n - 1, 1], simplex[n - 1, 2]
    x, y, z = px, py, pz
    distance, one, other, inside = px * px + py * py + pz * pz, -1, -1, n == 4
    for i in range(n - 1):
        ux, uy, uz = simplex[i, 0] - px, simplex[i, 1] - py, simplex[i, 2] - pz
        uu, up = ux * ux + uy * uy + uz * uz, -(ux * px + uy * py + uz * pz)
        if 0.0 < up < uu:
            t = up / uu
            qx, qy, qz = px + t * ux, py + t * uy, pz + t * uz
            square = qx * qx + qy * qy + qz * qz
            if square < distance:
                distance, one, other, x, y, z = square, i, -1, qx, qy, qz
        for j in range(i + 1, n - 1):
            vx, vy, vz = simplex[j, 0] - px, simplex[j, 1] - py, simplex[j, 2] - pz
            vv, vp = vx * vx + vy * vy + vz * vz, -(vx * px + vy * py + vz * pz)
            uv = ux * vx + uy * vy + uz * vz
            area = uu * vv - uv * uv
            s, t = up * vv - vp * uv, vp * uu - up * uv
            if area > FLAT * uu * vv and s > 0.0 and t > 0.0 and s + t < area:
                s, t = s / area, t / area
                qx, qy, qz = px + s * ux + t * vx, py + s * uy + t * vy, pz + s * uz + t * vz
                square = qx * qx + qy * qy + qz * qz
                if square < distance:
                    distance, one, other, x, y, z = square, i, j, qx, qy, qz
            if inside:
                k = 3 - i - j
                nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
                wx, wy, wz = simplex[k, 0] - px, simplex[k, 1] - py, simplex[k, 2] - pz
                side = wx * nx + wy * ny + wz * nz
                flat = side * side <= FLAT * area * (wx * wx + wy * wy + wz * wz)
                inside = side * -(px * nx + py * ny + pz * nz) > 0.0 and not flat
    if inside:
        return 4, x, y, z
    left = 0
    for k in (one, other):
        if k >= 0:
            simplex[left, 0], simplex[left, 1], simplex[left, 2] = simplex[k, 0], simplex[k, 1], simplex[k, 2]
            left += 1
    simplex[left, 0], simplex[left, 1], simplex[left, 2] = px, py, pz
    return left + 1, x, y, z


@njit(error_model="numpy", forceinline=True)
def parted(one, a, a_end, other, b, b_end, ox, oy, oz, radius, directions, simplex):
    """Say whether a plane is sure to lie between points and others, which are about a place (ox, oy, oz) away."""
    x, y, z, n = ox, oy, oz, 0
    for turn in range(directions):
        size = max(abs(x), abs(y), abs(z))
        if not size > 0.0:
            x, size = 1.0, 1.0
        fx, fy, fz = np.float32(x / size), np.float32(y / size), np.float32(z / size)
        gap = np.float64(fx) * ox + np.float64(fy) * oy + np.float64(fz) * oz
        gap -= np.float64(highest(one, a, a_end, fx, fy, fz)) + np.float64(highest(other, b, b_end, -fx, -fy, -fz))
        if gap > ROOM * (abs(fx) + abs(fy) + abs(fz)) * radius + SMALLEST:
            return True
        if turn + 1 == directions:
            break
        i, j = farthest(one, a, a_end, fx, fy, fz), farthest(other, b, b_end, -fx, -fy, -fz)
        simplex[n, 0] = np.float64(other[0, j]) + ox - np.float64(one[0, i])
        simplex[n, 1] = np.float64(other[1, j]) + oy - np.float64(one[1, i])
        simplex[n, 2] = np.float64(other[2, j]) + oz - np.float64(one[2, i])
        n, x, y, z = nearest(simplex, n + 1)
        if n == 4:
            return False
    return False


@njit(error_model="numpy", forceinline=True)
def pick(points, begin, end, low, high, spare, which):
    """Copy the triangles whose boxes meet another; return how many there are."""
    lx, ly, lz = np.float32(low[0]), np.float32(low[1]), np.float32(low[2])
    hx, hy, hz = np.float32(high[0]), np.float32(high[1]), np.float32(high[2])
    count = 0
    for k in range(begin, end):
        i = 3 * k
        x0, x1, x2 = points[0, i], points[0, i + 1], points[0, i + 2]
        y0, y1, y2 = points[1, i], points[1, i + 1], points[1, i + 2]
        z0, z1, z2 = points[2, i], points[2, i + 1], points[2, i + 2]
        beside = (least(x0, x1, x2, x2) > hx) | (most(x0, x1, x2, x2) < lx)
        beside |= (least(y0, y1, y2, y2) > hy) | (most(y0, y1, y2, y2) < ly)
        beside |= (least(z0, z1, z2, z2) > hz) | (most(z0, z1, z2, z2) < lz)
        if not beside:
            j = 3 * count
            spare[0, j], spare[0, j + 1], spare[0, j + 2] = x0, x1, x2
            spare[1, j], spare[1, j + 1], spare[1, j + 2] = y0, y1, y2
            spare[2, j], spare[2, j + 1], spare[2, j + 2] = z0, z1, z2
            which[count] = k
            count += 1
    return count


@njit(error_model="numpy", forceinline=True)
def compare(table, points, starts, ends, one, other, patience, spare, which, work):
    """Return how many triangles of two shells may meet, which are in `which`; no shell may meet another where it is 0.

    It is -1, for all, where the shells have been looked at too often.
    """
    box, simplex = work[:4], work[4:]
    radius, apart = 0.0, False
    for axis in range(3):
        low, high, lower, upper = table[one, axis], table[one, axis + 3], table[other, axis], table[other, axis + 3]
        apart |= high <= lower or upper <= low
        radius = max(radius, 0.5 * (high - low) + 0.5 * (upper - lower))
        a, b = 0.5 * low + 0.5 * high, 0.5 * lower + 0.5 * upper
        pad = PAD * (high - low + upper - lower)
        box[0, axis], box[1, axis] = lower - a - pad, upper - a + pad
        box[2, axis], box[3, axis] = low - b - pad, high - b + pad
        simplex[3, axis] = b - a
    if apart:
        return 0, 0
    if patience[one] < 0 or patience[other] < 0:
        return -1, -1
    a, a_end, b, b_end = starts[one], ends[one], starts[other], ends[other]
    patience[one] -= a_end - a
    patience[other] -= b_end - b
    x, y, z = simplex[3, 0], simplex[3, 1], simplex[3, 2]
    if parted(points, 3 * a, 3 * a_end, points, 3 * b, 3 * b_end, x, y, z, radius, DIRECTIONS, simplex):
        return 0, 0
    near = pick(points, a, a_end, box[0], box[1], spare[:3], which[0])
    beside = pick(points, b, b_end, box[2], box[3], spare[3:], which[1])
    if near == 0 or beside == 0:
        return 0, 0
    if parted(spare, 0, 3 * near, spare[3:], 0, 3 * beside, x, y, z, radius, FURTHER, simplex):
        return 0, 0
    return near, beside


@njit(error_model="numpy", forceinline=True)
def mark(shell, near, which, numbers, flags, within):
    """Mark a shell, and those of its triangles that may meet another."""
    flags[shell] |= MEETS
    if near < 0:
        flags[shell] |= WHOLE
    for k in range(near):
        within[numbers[which[k]]] = 1


def part_shells(
    table_at, count, order_at, boxes_at, nodes_at, last, starts_at, ends_at, numbers_at, points_at, slots,
    patience_at, spare_at, which_at, room, work_at, stack_at, flags_at, within_at, triangles,
):  # fmt: skip
    """Mark the shells that no plane is found to hold apart from others, and the triangles with which they may meet.

    `boxes`, and `nodes` up to the `last`, are those of the shells in order, and enclosing them, as `meet_boxes` leaves
    them; `starts` and `ends` say where the triangles of a shell are that `copy_shells` wrote; `patience` how many of
    them may be looked at. `spare`, (6, 3 room), and `which`, (2, room), have room for those of any shell;
    `work` is (8, 3), `stack` (512, 2).
    """
    table = carray(table_at, (count, COLUMNS), np.float64)
    order = carray(order_at, (count,), np.int64)
    boxes = carray(boxes_at, (2 * count, 6), np.float32)
    nodes = carray(nodes_at, (2 * count, 2), np.int32)
    starts, ends = carray(starts_at, (count,), np.int64), carray(ends_at, (count,), np.int64)
    numbers = carray(numbers_at, (slots,), np.int64)
    points = carray(points_at, (3, 3 * slots), np.float32)
    patience = carray(patience_at, (count,), np.int64)
    spare = carray(spare_at, (6, 3 * room), np.float32)
    which = carray(which_at, (2, room), np.int64)
    work = carray(work_at, (8, 3), np.float64)
    stack = carray(stack_at, (512, 2), np.int64)
    flags = carray(flags_at, (count,), np.uint8)
    within = carray(within_at, (triangles,), np.uint8)
    for node in range(count, last):
        stack[0, 0], stack[0, 1] = nodes[node, 0], nodes[node, 1]
        waiting = 1
        while waiting > 0:
            waiting -= 1
            p, q = stack[waiting, 0], stack[waiting, 1]
            if not overlap(boxes, p, q):
                continue
            if p < count and q < count:
                one, other = order[p], order[q]
                near, beside = compare(table, points, starts, ends, one, other, patience, spare, which, work)
                if near != 0:
                    mark(one, near, which[0], numbers, flags, within)
                    mark(other, beside, which[1], numbers, flags, within)
                continue
            if p < count or (q >= count and girth(boxes, q) > girth(boxes, p)):
                p, q = q, p
            for k in range(2):
                stack[waiting, 0], stack[waiting, 1] = nodes[p, k], q
                waiting += 1
    return 0


@njit(error_model="numpy", forceinline=True)
def overlaps(boxes, row, lx, ly, lz, hx, hy, hz):
    """Say whether a box has a point in common with another."""
    beside = (boxes[row, 3] < lx) | (hx < boxes[row, 0]) | (boxes[row, 4] < ly) | (hy < boxes[row, 1])
    return not (beside | (boxes[row, 5] < lz) | (hz < boxes[row, 2]))


@njit(error_model="numpy", forceinline=True)
def sphere(table, radii, shell):
    """Return the middle of a sphere around a shell, and the square of its radius."""
    x = 0.5 * table[shell, 0] + 0.5 * table[shell, 3]
    y = 0.5 * table[shell, 1] + 0.5 * table[shell, 4]
    return x, y, 0.5 * table[shell, 2] + 0.5 * table[shell, 5], radii[shell]


@njit(error_model="numpy", forceinline=True)
def passes(x, y, z, square, nx, ny, nz, sides):
    """Say whether a plane is sure to pass a sphere, given from a place in the plane; `sides` as for `BLUR`, squared."""
    height = x * nx + y * ny + z * nz
    height *= height
    blur = BLUR * BLUR * sides * (x * x + y * y + z * z)
    clear = height * (1.0 - SHARE) > square * (nx * nx + ny * ny + nz * nz)
    return clear & (blur + TINY < SHARE * SHARE / 16.0 * height)


@njit(error_model="numpy", forceinline=True)
def largest_of(x, y, z):
    """Return the largest magnitude of three numbers."""
    return larger(larger(abs(x), abs(y)), abs(z))


@njit(error_model="numpy", forceinline=True)
def beyond(table, shell, points, begin, end, corners, normal):
    """Say whether a triangle is sure to lie beyond all points of a shell, along the normal that leads away from it."""
    (nx, ny, nz), (a, b, c) = normal, corners
    size = largest_of(nx, ny, nz)
    if not size > 0.0:
        return False
    x = 0.5 * table[shell, 0] + 0.5 * table[shell, 3]
    y = 0.5 * table[shell, 1] + 0.5 * table[shell, 4]
    z = 0.5 * table[shell, 2] + 0.5 * table[shell, 5]
    ax, ay, az = a[0] - x, a[1] - y, a[2] - z
    bx, by, bz = b[0] - x, b[1] - y, b[2] - z
    cx, cy, cz = c[0] - x, c[1] - y, c[2] - z
    size = size if ax * nx + ay * ny + az * nz > 0.0 else -size
    fx, fy, fz = np.float32(nx / size), np.float32(ny / size), np.float32(nz / size)
    dx, dy, dz = np.float64(fx), np.float64(fy), np.float64(fz)
    height = smaller(dx * ax + dy * ay + dz * az, smaller(dx * bx + dy * by + dz * bz, dx * cx + dy * cy + dz * cz))
    far = largest_of(ax, ay, az) + largest_of(bx, by, bz) + largest_of(cx, cy, cz)
    far += largest_of(x - table[shell, 0], y - table[shell, 1], z - table[shell, 2])
    room = ROOM * (abs(dx) + abs(dy) + abs(dz)) * far + SMALLEST
    return height - np.float64(highest(points, 3 * begin, 3 * end, fx, fy, fz)) > room


def near_children(
    base, vertices, faces_at, labels_at, count, table_at, shells, radii_at, boxes_at, nodes_at, order_at,
    ranges_at, starts_at, ends_at, points_at, slots, patience_at, again, near_at, flags_at, stack_at,
):  # fmt: skip
    """Mark the triangles that may meet a shell next inside their own, and these shells.

    `boxes` and `nodes` are those of the shells in order, and enclosing them, as `meet_boxes` leaves them; `ranges` says
    where those next inside a shell begin and end. A triangle is apart from one whose box its own does not meet, or
    where its plane passes the sphere around it; `again` only those are looked at that are marked, and are apart too
    where their planes have all points of it on one side, of those that `copy_shells` wrote.
    """
    corners = carray(base, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    labels = carray(labels_at, (count,), np.int32)
    table = carray(table_at, (shells, COLUMNS), np.float64)
    radii = carray(radii_at, (shells,), np.float64)
    boxes = carray(boxes_at, (2 * shells, 6), np.float32)
    nodes = carray(nodes_at, (2 * shells, 2), np.int32)
    order = carray(order_at, (shells,), np.int64)
    ranges = carray(ranges_at, (shells, 2), np.int64)
    starts, ends = carray(starts_at, (shells,), np.int64), carray(ends_at, (shells,), np.int64)
    points = carray(points_at, (3, 3 * slots), np.float32)
    patience = carray(patience_at, (shells,), np.int64)
    near = carray(near_at, (count,), np.uint8)
    flags = carray(flags_at, (shells,), np.uint8)
    stack = carray(stack_at, (512,), np.int64)
    before, root, only = np.int32(-1), 0, False
    x, y, z, square = 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        shell = labels[k]
        if shell < 0 or ranges[shell, 0] == ranges[shell, 1] or near[k] < again:
            continue
        near[k] = 0
        if shell != before:  # triangles of a shell mostly follow one another
            before, root = shell, nodes[ranges[shell, 1] - 1, 0]
            only = root < shells
            if only:
                x, y, z, square = sphere(table, radii, order[root])
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = triangle(base, corners, faces, vertices < 0, k)
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        sides = (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz)
        if only and passes(x - ax, y - ay, z - az, square, nx, ny, nz, sides):
            continue
        lx, ly, lz = least(ax, bx, cx, cx), least(ay, by, cy, cy), least(az, bz, cz, cz)
        hx, hy, hz = most(ax, bx, cx, cx), most(ay, by, cy, cy), most(az, bz, cz, cz)
        lx, ly, lz = np.float32(lx), np.float32(ly), np.float32(lz)
        hx, hy, hz = np.float32(hx), np.float32(hy), np.float32(hz)
        stack[0] = root
        waiting = 1
        while waiting > 0:
            waiting -= 1
            row = stack[waiting]
            if row >= shells:
                if overlaps(boxes, row, lx, ly, lz, hx, hy, hz):
                    stack[waiting], stack[waiting + 1] = nodes[row, 1], nodes[row, 0]
                    waiting += 2
                continue
            child = order[row]
            if not only:
                x, y, z, square = sphere(table, radii, child)
            # The sphere first, as it tells most apart: a branch that is hard to predict costs more.
            if passes(x - ax, y - ay, z - az, square, nx, ny, nz, sides):
                continue
            if not overlaps(boxes, row, lx, ly, lz, hx, hy, hz):
                continue
            if patience[child] > 0:
                patience[child] -= ends[child] - starts[child]
                own = (ax, ay, az), (bx, by, bz), (cx, cy, cz)
                if beyond(table, child, points, starts[child], ends[child], own, (nx, ny, nz)):
                    continue
            near[k] = 1
            flags[child] |= NEAR
    return 0
