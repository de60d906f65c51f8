"""The compiled kernels that measure and nest the shells of a surface as its triangles stream by; see `sound_shells`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import math

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.crossing_kernel import spread
from inertia.mesh.geometry.record_kernel import EIGHT, FEW, add_finely, add_records, triangle

COLUMNS = 12
"""Numbers for each shell: its box, 6 × its volume, the sum of its terms' largest magnitudes squared, a place on it, how
many triangles it has."""

RUN, MIXED = 64, -2
"""Triangles one after another whose box is kept, with their shell; this, where they are of several."""

ULP, SMALLEST = np.float32(2.0**-23), np.float32(2.0**-149)
"""Of float32: what the next number is away, over a number's size, and at least."""

LARGE = 1 << 12
"""Triangles of a shell above which the sphere around it is that of the boxes of its runs."""

FAR, FARTHEST = 1 << 61, 1 << 62
"""Added to how far shells of a family are from each other, where that is not told by their numbers; of two families."""

MEETS, INSIDE, AROUND, NEAR = 1, 2, 4, 8
"""What a shell's box does to that of another: meet it, lie in it, hold it; come near triangles of the shell around."""

DIGIT, DIGITS = 11, 6
"""Bits that places are sorted by at a time, and how often that is enough for all of them."""

FIRST, SECOND, THIRD = 0.4140625, 0.3515625, 0.234375
"""Weights of the corners for a place on a triangle: in no plane of symmetry, so that few rays pass through edges."""

BLUR = 1e-14
"""What a height times the sides of a triangle is rounded by, at most, over the product of their lengths."""

TINY = 2.0**-900
"""Above what squares that underflow are off by."""


@njit(error_model="numpy", forceinline=True)
def smaller(a, b):
    """Return the smaller of two finite numbers, in fewer steps than `min`, which looks for what is none."""
    return b if b < a else a


@njit(error_model="numpy", forceinline=True)
def larger(a, b):
    """Return the larger of two finite numbers."""
    return b if b > a else a


@njit(error_model="numpy", forceinline=True)
def least(a, b, c, d):
    """Return the least of four finite numbers."""
    return smaller(smaller(a, b), smaller(c, d))


@njit(error_model="numpy", forceinline=True)
def most(a, b, c, d):
    """Return the largest of four finite numbers."""
    return larger(larger(a, b), larger(c, d))


@njit(error_model="numpy", forceinline=True)
def below(x):
    """Return a float32 no larger than a number."""
    value = np.float32(x)
    return value - (abs(value) * ULP + SMALLEST)


@njit(error_model="numpy", forceinline=True)
def above(x):
    """Return a float32 no smaller than a number."""
    value = np.float32(x)
    return value + (abs(value) * ULP + SMALLEST)


@njit(error_model="numpy", forceinline=True)
def around(few, n, box):
    """Write a box as float32 around it."""
    lx, ly, lz, hx, hy, hz = box
    few[n, 0], few[n, 1], few[n, 2] = below(lx), below(ly), below(lz)
    few[n, 3], few[n, 4], few[n, 5] = above(hx), above(hy), above(hz)


@njit(error_model="numpy", forceinline=True)
def enlarged(box, a, b, c):
    """Return a box with the corners of another triangle."""
    (lx, ly, lz, hx, hy, hz), (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = box, a, b, c
    lx, ly, lz = least(lx, x0, x1, x2), least(ly, y0, y1, y2), least(lz, z0, z1, z2)
    return lx, ly, lz, most(hx, x0, x1, x2), most(hy, y0, y1, y2), most(hz, z0, z1, z2)


@njit(error_model="numpy", forceinline=True)
def enclose(base, points, faces, records, start, stop, few):
    """Write boxes around each `FEW` of some triangles."""
    for begin in range(start, stop, FEW):
        a, _, _ = triangle(base, points, faces, records, begin)
        box = a[0], a[1], a[2], a[0], a[1], a[2]
        for k in range(begin, min(begin + FEW, stop)):
            a, b, c = triangle(base, points, faces, records, k)
            box = enlarged(box, a, b, c)
        around(few, begin // FEW, box)


@njit(error_model="numpy", forceinline=True)
def joined(one, other):
    """Return the box of two boxes."""
    (ax, ay, az, bx, by, bz), (lx, ly, lz, hx, hy, hz) = one, other
    return smaller(ax, lx), smaller(ay, ly), smaller(az, lz), larger(bx, hx), larger(by, hy), larger(bz, hz)


@njit(error_model="numpy", forceinline=True)
def measured(several, volume, size):
    """Return the box of several triangles, and the volume and the squares that theirs are added to."""
    return several[:6], volume + several[6], size + several[7]


@njit(error_model="numpy", forceinline=True)
def write(rows, n, box):
    """Write a box to the first numbers of a row."""
    rows[n, 0], rows[n, 1], rows[n, 2], rows[n, 3], rows[n, 4], rows[n, 5] = box


@njit(error_model="numpy", forceinline=True)
def alike(labels, start, stop, count):
    """Say whether triangles are of one shell, all of which there are."""
    if stop > count or start % RUN != 0 or labels[start] < 0:
        return False
    same = True
    for k in range(start, start + RUN):
        same &= labels[k] == labels[start]
    return same


@njit(error_model="numpy", forceinline=True)
def added(a, b, c, x, y, z, box, volume, size):
    """Return a box, a volume about a place and the squares of what it is made of with another triangle."""
    box = enlarged(box, a, b, c)
    (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = a, b, c
    ux, uy, uz = x1 - x0, y1 - y0, z1 - z0
    vx, vy, vz = x2 - x0, y2 - y0, z2 - z0
    ax, ay, az = x0 - x, y0 - y, z0 - z
    volume += ax * (uy * vz - uz * vy) + ay * (uz * vx - ux * vz) + az * (ux * vy - uy * vx)
    size += (ax * ax + ay * ay + az * az) * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz)
    return box, volume, size


@njit(error_model="numpy", forceinline=True)
def measure(base, vertices, faces_at, labels_at, count, table_at, shells, boxes_at, shell_at, few_at, fine, records):
    """Add triangles to the rows of their shells, zero at first; volumes are about a place on the first triangle.

    Of each run of triangles the box, (n, 6), and the shell, (n,), are written, and with `fine` boxes around each `FEW`
    triangles of whatever shells, (n, 6).
    """
    points = carray(base, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    labels = carray(labels_at, (count,), np.int32)
    table = carray(table_at, (shells, COLUMNS), np.float64)
    runs = (count + RUN - 1) // RUN
    boxes, shell = carray(boxes_at, (runs, 6), np.float64), carray(shell_at, (runs,), np.int32)
    few = carray(few_at, ((count + FEW - 1) // FEW, 6), np.float32)
    for n in range(runs):
        k, stop = n * RUN, min((n + 1) * RUN, count)
        shell[n] = labels[k]
        while k < stop:
            row = labels[k]
            if row != shell[n]:
                shell[n] = MIXED
            if row < 0:
                k += 1
                continue
            # Triangles of a shell mostly follow one another: its numbers need not go through memory for each.
            a, b, c = triangle(base, points, faces, records, k)
            if table[row, 11] == 0.0:
                for axis in range(3):
                    table[row, 8 + axis] = FIRST * a[axis] + SECOND * b[axis] + THIRD * c[axis]
            box = a[0], a[1], a[2], a[0], a[1], a[2]
            volume, size = table[row, 6], table[row, 7]
            x, y, z = table[row, 8], table[row, 9], table[row, 10]
            begin = k
            if fine and alike(labels, k, n * RUN + RUN, count):
                if records:
                    part, volume, size = measured(add_finely(base, k, RUN // EIGHT, x, y, z, few_at), volume, size)
                    box, k = joined(box, part), stop
                while k < stop:
                    a, b, c = triangle(base, points, faces, records, k)
                    part, number = (a[0], a[1], a[2], a[0], a[1], a[2]), k // FEW
                    for _ in range(FEW):
                        a, b, c = triangle(base, points, faces, records, k)
                        part, volume, size = added(a, b, c, x, y, z, part, volume, size)
                        k += 1
                    around(few, number, part)
                    box = joined(box, part)
            if records and not fine and stop - k >= EIGHT:
                end = k
                while end < stop and labels[end] == row:
                    end += 1
                if end - k >= EIGHT:
                    part, volume, size = measured(
                        add_records(base, k, (end - k) // EIGHT, x, y, z, few_at), volume, size
                    )
                    box, k = joined(box, part), end - (end - k) % EIGHT
            while k < stop and labels[k] == row:
                a, b, c = triangle(base, points, faces, records, k)
                box, volume, size = added(a, b, c, x, y, z, box, volume, size)
                k += 1
            if k - begin == stop - n * RUN:
                write(boxes, n, box)
            if table[row, 11] > 0.0:
                before = table[row, 0], table[row, 1], table[row, 2], table[row, 3], table[row, 4], table[row, 5]
                box = joined(box, before)
            write(table, row, box)
            table[row, 6], table[row, 7] = volume, size
            table[row, 11] += k - begin
        if fine and not alike(labels, n * RUN, n * RUN + RUN, count):
            enclose(base, points, faces, records, n * RUN, stop, few)
    return 0


def measure_shells(base, vertices, faces_at, labels_at, count, table_at, shells, boxes_at, shell_at):
    """Measure shells as `measure` does, without boxes around a few triangles."""
    given = base, vertices, faces_at, labels_at, count, table_at, shells, boxes_at, shell_at, boxes_at
    if vertices < 0:
        return measure(*given, False, True)
    return measure(*given, False, False)


def measure_finely(base, vertices, faces_at, labels_at, count, table_at, shells, boxes_at, shell_at, few_at):
    """Measure shells as `measure` does, with boxes around a few triangles."""
    given = base, vertices, faces_at, labels_at, count, table_at, shells, boxes_at, shell_at, few_at
    if vertices < 0:
        return measure(*given, True, True)
    return measure(*given, True, False)


def curve_places(table_at, shells, cells, noise, stored, bits, box_at, boxes_at, places_at):
    """Write the box of all shells, (2, 3), and the place of each along a Z-order curve, its number in the last `bits`.

    Their own boxes, (n, 6), are written as float32: rounding never changes an order, so that those that overlap still
    meet. Returns 1 where a volume is not known to have a sign, or the boxes are points.
    """
    table = carray(table_at, (shells, COLUMNS), np.float64)
    box = carray(box_at, (2, 3), np.float64)
    boxes = carray(boxes_at, (shells, 6), np.float32)
    places = carray(places_at, (shells,), np.uint64)
    lx, ly, lz, hx, hy, hz = table[0, 0], table[0, 1], table[0, 2], table[0, 3], table[0, 4], table[0, 5]
    for k in range(shells):
        lx, ly, lz = smaller(lx, table[k, 0]), smaller(ly, table[k, 1]), smaller(lz, table[k, 2])
        hx, hy, hz = larger(hx, table[k, 3]), larger(hy, table[k, 4]), larger(hz, table[k, 5])
        for axis in range(6):
            boxes[k, axis] = np.float32(table[k, axis])
        # The sum of n numbers is no more than the root of n times that of their squares.
        size, count = table[k, 7], table[k, 11]
        if not (size > TINY and abs(table[k, 6]) > (noise + count * stored) * math.sqrt(count * size)):
            return 1
    box[0, 0], box[0, 1], box[0, 2], box[1, 0], box[1, 1], box[1, 2] = lx, ly, lz, hx, hy, hz
    size = max(hx - lx, hy - ly, hz - lz)
    if not 0.0 < size < np.inf:
        return 1
    factor = cells / size
    for k in range(shells):
        code = np.uint64(0)
        for axis in range(3):
            middle = 0.5 * table[k, axis] + 0.5 * table[k, 3 + axis]
            code |= spread(np.uint64(larger((middle - box[0, axis]) * factor, 0.0))) << np.uint64(axis)
        places[k] = code >> np.uint64(bits - 1) << np.uint64(bits) | np.uint64(k)
    return 0


def sort_places(places_at, room_at, counts_at, count, bits):
    """Sort places by what is above their last `bits`, which ascend, digit by digit from the last; see `DIGITS`."""
    one = carray(places_at, (count,), np.uint64)
    other = carray(room_at, (count,), np.uint64)
    counts = carray(counts_at, (DIGITS, 1 << DIGIT), np.int64)
    last, digits = np.uint64((1 << DIGIT) - 1), (64 - bits + DIGIT - 1) // DIGIT
    for k in range(count):
        key = one[k] >> np.uint64(bits)
        for digit in range(digits):
            counts[digit, key & last] += 1
            key >>= np.uint64(DIGIT)
    moved = False
    for digit in range(digits):
        by, first = np.uint64(bits + digit * DIGIT), 0
        for k in range(1 << DIGIT):
            number = counts[digit, k]
            counts[digit, k] = first
            first += number
        for k in range(count):
            key = one[k]
            at = (key >> by) & last
            place = counts[digit, at]
            counts[digit, at] = place + 1
            other[place] = key
        one, other, moved = other, one, not moved
    if moved:
        for k in range(count):
            other[k] = one[k]
    return 0


def meet_boxes(
    table_at, single_at, order_at, places_at, count,
    family_at, boxes_at, nodes_at, stack_at, flags_at, zones_at, spots_at,
):  # fmt: skip
    """Enclose boxes two by two, and say which of them meet others of their family, lie in one and hold one, and where.

    Shells are looked at in order; `family`, which ascends, and `places` along the curve in each are those in order. Two
    nodes are joined before their neighbours where the places of the shells between them differ in lower bits, so that
    the boxes of nodes are mostly apart (T. Karras, "Maximizing parallelism in the construction of BVHs, octrees, and
    k-d trees", High Performance Graphics 2012). Node k < `count` is the k-th shell, and has in `nodes`, (2 count, 2),
    the root of its family, if it is the last of it; others have the two nodes that they join. The boxes written,
    (2 count, 6), are float32, as those of the shells in `single` are. `stack` has room for 512 rows. `zones`,
    (count, 6), come to enclose what each that meets others has in common with them, `spots`, (count, 6), the places on
    those that lie in the box of each that holds others.
    """
    table = carray(table_at, (count, COLUMNS), np.float64)
    single = carray(single_at, (count, 6), np.float32)
    order = carray(order_at, (count,), np.int64)
    places = carray(places_at, (count,), np.uint64)
    family = carray(family_at, (count,), np.int64)
    boxes = carray(boxes_at, (2 * count, 6), np.float32)
    nodes = carray(nodes_at, (2 * count, 2), np.int32)
    stack = carray(stack_at, (512, 2), np.int64)
    flags, zones = carray(flags_at, (count,), np.uint8), carray(zones_at, (count, 6), np.float64)
    spots = carray(spots_at, (count, 6), np.float64)
    for k in range(count):  # by themselves, as these places in memory are far apart
        one = order[k]
        for axis in range(6):
            boxes[k, axis] = single[one, axis]
    waiting, built = 0, count
    for k in range(count):
        # How far the node that ends here is from the next: equal places are told apart by their numbers.
        key = np.int64(k ^ (k + 1))
        after = min(k + 1, count - 1)
        last = k == count - 1 or family[k] != family[after]
        if last:
            key |= FARTHEST
        elif places[k] != places[after]:
            key = FAR + np.int64(places[k] ^ places[after])
        node = k
        while waiting > 0 and stack[waiting - 1, 1] < min(key, FARTHEST):
            waiting -= 1
            before = stack[waiting, 0]
            apart = False
            for axis in range(3):
                low, high = boxes[before, axis], boxes[before, axis + 3]
                lower, higher = boxes[node, axis], boxes[node, axis + 3]
                apart |= (high < lower) | (higher < low)
                boxes[built, axis] = lower if lower < low else low
                boxes[built, axis + 3] = higher if higher > high else high
            nodes[built, 0], nodes[built, 1] = before, node
            if not apart:
                descend(table, order, boxes, nodes, stack, waiting, flags, zones, spots, count, before, node)
            node = built
            built += 1
        if last:
            nodes[k, 0] = node
            waiting = 0
        else:
            stack[waiting, 0], stack[waiting, 1] = node, key
            waiting += 1
    return 0


@njit(error_model="numpy", forceinline=True)
def overlap(boxes, p, q):
    """Say whether two boxes have a point in common."""
    return (
        boxes[p, 0] <= boxes[q, 3]
        and boxes[q, 0] <= boxes[p, 3]
        and boxes[p, 1] <= boxes[q, 4]
        and boxes[q, 1] <= boxes[p, 4]
        and boxes[p, 2] <= boxes[q, 5]
        and boxes[q, 2] <= boxes[p, 5]
    )


@njit(error_model="numpy", forceinline=True)
def girth(boxes, node):
    """Return the sum of the sides of a box."""
    return (boxes[node, 3] - boxes[node, 0]) + (boxes[node, 4] - boxes[node, 1]) + (boxes[node, 5] - boxes[node, 2])


@njit(error_model="numpy", forceinline=True)
def descend(table, order, boxes, nodes, stack, base, flags, zones, spots, count, one, other):
    """Compare the shells in two nodes whose boxes overlap; rows of the stack from `base` on are free."""
    stack[base, 0], stack[base, 1] = one, other
    waiting = base + 1
    while waiting > base:
        waiting -= 1
        p, q = stack[waiting, 0], stack[waiting, 1]
        if p < count and q < count:
            compare(table, flags, zones, spots, order[p], order[q])
            continue
        if p < count or (q >= count and girth(boxes, q) > girth(boxes, p)):
            p, q = q, p
        for k in range(2):
            child = nodes[p, k]
            if overlap(boxes, child, q):
                stack[waiting, 0], stack[waiting, 1] = child, q
                waiting += 1


@njit(error_model="numpy", forceinline=True)
def meet(table, flags, zones, one, other):
    """Enlarge the zone of a shell by what its box has in common with another's."""
    known = flags[one] & MEETS
    for axis in range(3):
        low, high = max(table[one, axis], table[other, axis]), min(table[one, axis + 3], table[other, axis + 3])
        zones[one, axis] = min(zones[one, axis], low) if known else low
        zones[one, axis + 3] = max(zones[one, axis + 3], high) if known else high
    flags[one] |= MEETS


@njit(error_model="numpy", forceinline=True)
def hold(table, flags, zones, spots, inner, outer):
    """Write down that the box of a shell lies in that of another."""
    known = flags[outer] & AROUND
    for axis in range(3):
        x = table[inner, 8 + axis]
        spots[outer, axis] = min(spots[outer, axis], x) if known else x
        spots[outer, axis + 3] = max(spots[outer, axis + 3], x) if known else x
    flags[inner] |= INSIDE
    flags[outer] |= AROUND


@njit(error_model="numpy", forceinline=True)
def compare(table, flags, zones, spots, one, other):
    """Write down what the boxes of two shells do to each other; what meets at a face of boxes shares no space."""
    apart, a_in_b, b_in_a = False, True, True
    for axis in range(3):
        low, high = table[one, axis], table[one, axis + 3]
        lower, higher = table[other, axis], table[other, axis + 3]
        apart |= high <= lower or higher <= low
        a_in_b &= lower <= low and high <= higher
        b_in_a &= low <= lower and higher <= high
    if not apart:
        meet(table, flags, zones, one, other)
        meet(table, flags, zones, other, one)
    if a_in_b:
        hold(table, flags, zones, spots, one, other)
    if b_in_a:
        hold(table, flags, zones, spots, other, one)


@njit(error_model="numpy", forceinline=True)
def upwards(ax, ay, bx, by):
    """Return the crossing of the positive x axis by an edge: 1 upwards, −1 downwards; opposite if it is reversed."""
    side = ax * by - ay * bx
    if ay <= 0.0 and by > 0.0 and side > 0.0:
        return 1
    if by <= 0.0 and ay > 0.0 and side < 0.0:
        return -1
    return 0


@njit(error_model="numpy", forceinline=True)
def cells_between(low, high, origin, step, across):
    """Return the first and the last of the cells along an axis that a range is in; none where the last is less."""
    first = int(max((low - origin) * step - 1e-6, 0.0))
    return first, min(int(max((high - origin) * step + 1e-6, 0.0)), across - 1)


def ask_runs(
    table_at, shells, flags_at, spots_at, radii_at,
    points_at, whose_at, points, cells_at, across, x, y, step_x, step_y, margin, boxes_at, shell_at, runs, asked_at,
):  # fmt: skip
    """Say of which runs of triangles `cast_rays` has to look at each; for the arguments see there.

    Of large shells that lie in others, the squares of radii are written.
    """
    table = carray(table_at, (shells, COLUMNS), np.float64)
    flags = carray(flags_at, (shells,), np.uint8)
    spots = carray(spots_at, (shells, 6), np.float64)
    radii = carray(radii_at, (shells,), np.float64)
    place = carray(points_at, (points, 3), np.float64)
    whose = carray(whose_at, (points,), np.int64)
    cells = carray(cells_at, (across * across + 1,), np.int64)
    boxes, shell = carray(boxes_at, (runs, 6), np.float64), carray(shell_at, (runs,), np.int32)
    asked = carray(asked_at, (runs,), np.uint8)
    for n in range(runs):
        row = shell[n]
        asked[n] = row == MIXED
        if row < 0:
            continue
        flag = flags[row]
        if flag & INSIDE:
            if table[row, 11] > LARGE:
                square = 0.0
                for axis in range(3):
                    middle = 0.5 * table[row, axis] + 0.5 * table[row, 3 + axis]
                    far = max(middle - boxes[n, axis], boxes[n, 3 + axis] - middle)
                    square += far * far
                radii[row] = max(radii[row], square)
            else:
                asked[n] = 1
        if asked[n] or not flag & AROUND:
            continue
        lx, hx = max(boxes[n, 0] - margin, spots[row, 0]), min(boxes[n, 3] + margin, spots[row, 3])
        ly, hy = max(boxes[n, 1] - margin, spots[row, 1]), min(boxes[n, 4] + margin, spots[row, 4])
        hz, bottom = boxes[n, 5] + margin, spots[row, 2]
        if (hx < lx) | (hy < ly) | (hz < bottom):
            continue
        left, right = cells_between(lx, hx, x, step_x, across)
        near, far = cells_between(ly, hy, y, step_y, across)
        for line in range(near, far + 1):
            if left > right:
                break
            for at in range(cells[line * across + left], cells[line * across + right + 1]):
                px, py, pz = place[at, 0], place[at, 1], place[at, 2]
                if bottom <= pz <= hz and lx <= px <= hx and ly <= py <= hy and whose[at] != row:
                    asked[n] = 1
    return 0


def cast_rays(
    base, vertices, faces_at, labels_at, count,
    table_at, shells, flags_at, spots_at, signs_at, numbers_at, radii_at,
    points_at, whose_at, points, cells_at, across, x, y, step_x, step_y, margin, sums_at, depths_at,
):  # fmt: skip
    """Add what triangles cross of the rays from points upwards to the sums and depths of the points' shells.

    Points (x, y, z) lie in order of `across` × `across` cells of the xy plane, each of which begins at `cells`. To the
    sum goes the number of the shell that is crossed, to the depth its sign, each as often as it is crossed. `radii` are
    the squares of those of the shells that lie in others, about the middles of their boxes; what lies in the box of one
    that holds others has its points in `spots`. Returns 1 where a point is nearer than the margin to another shell, so
    that it cannot be told.
    """
    corners = carray(base, (vertices, 3), np.float64)
    faces = carray(faces_at, (count, 3), np.int64)
    labels = carray(labels_at, (count,), np.int32)
    table = carray(table_at, (shells, COLUMNS), np.float64)
    flags = carray(flags_at, (shells,), np.uint8)
    spots = carray(spots_at, (shells, 6), np.float64)
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
        flag = flags[shell]
        if not flag & (INSIDE | AROUND):
            continue
        (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = triangle(base, corners, faces, vertices < 0, k)
        if flag & INSIDE:
            mx = 0.5 * table[shell, 0] + 0.5 * table[shell, 3]
            my = 0.5 * table[shell, 1] + 0.5 * table[shell, 4]
            mz = 0.5 * table[shell, 2] + 0.5 * table[shell, 5]
            d0 = (x0 - mx) * (x0 - mx) + (y0 - my) * (y0 - my) + (z0 - mz) * (z0 - mz)
            d1 = (x1 - mx) * (x1 - mx) + (y1 - my) * (y1 - my) + (z1 - mz) * (z1 - mz)
            d2 = (x2 - mx) * (x2 - mx) + (y2 - my) * (y2 - my) + (z2 - mz) * (z2 - mz)
            radii[shell] = most(radii[shell], d0, d1, d2)
        if not flag & AROUND:
            continue
        lx, hx = least(x0, x1, x2, x2) - margin, most(x0, x1, x2, x2) + margin
        ly, hy = least(y0, y1, y2, y2) - margin, most(y0, y1, y2, y2) + margin
        lz, hz = least(z0, z1, z2, z2) - margin, most(z0, z1, z2, z2) + margin
        # Points beside those of shells in its box, or below them, are outside.
        lx, hx = max(lx, spots[shell, 0]), min(hx, spots[shell, 3])
        ly, hy = max(ly, spots[shell, 1]), min(hy, spots[shell, 4])
        bottom = spots[shell, 2]
        if (hx < lx) | (hy < ly) | (hz < bottom):  # as most are: one branch costs less than several
            continue
        left, right = cells_between(lx, hx, x, step_x, across)
        near, far = cells_between(ly, hy, y, step_y, across)
        for row in range(near, far + 1):
            if left > right:
                break
            for at in range(cells[row * across + left], cells[row * across + right + 1]):
                px, py, pz = place[at, 0], place[at, 1], place[at, 2]
                if hz < pz or pz < bottom or px < lx or hx < px or py < ly or hy < py or whose[at] == shell:
                    continue
                ax, ay, az = x0 - px, y0 - py, z0 - pz
                bx, by, bz = x1 - px, y1 - py, z1 - pz
                cx, cy, cz = x2 - px, y2 - py, z2 - pz
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
