"""The compiled tests of pairs of triangles that are listed: whether they cross, and whether a plane holds them apart.

Imported only to be compiled (`inertia.native`); see `triangle_pairs`, which does the same by numpy.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.crossing_kernel import ORIENT3D, TERMS, UNSURE, cross, exact_sign, orient
from inertia.mesh.geometry.edge_kernel import pointer

UNDERFLOW = 2.0**-1070  # as in `triangle_pairs`
LARGEST = 2.0**300  # of which the products of three are numbers
EVERYWHERE = 1 << 60  # numbers from a place in memory on: no array is that long


def orient_points(places_at, rows, columns, own_at, work_at, signs_at):
    """Write the sign of (b − a) × (c − a) · (d − a) for a table of four points each, or `UNSURE`.

    `places` (4, 4) has for a, b, c and d where the first of them lies, and how many numbers it is to the next row, to
    the next column and to the next coordinate; none of these is negative.
    """
    places = carray(places_at, (4, 4), np.int64)
    own, work = carray(own_at, (4, 3), np.float64), carray(work_at, (18 + TERMS,), np.float64)
    signs = carray(signs_at, (rows, columns), np.int8)
    for row in range(rows):
        for column in range(columns):
            largest = 0.0
            for k in range(4):
                points = carray(pointer(places[k, 0]), (EVERYWHERE,), np.float64)
                at = row * places[k, 1] + column * places[k, 2]
                for axis in range(3):
                    own[k, axis] = points[at + axis * places[k, 3]]
                    largest = max(largest, abs(own[k, axis]))
            sign = orient(own, 0, 0, 1, 0, 2, 0, 3, 0)
            if sign == UNSURE and largest <= LARGEST:
                sign = exact_sign(own, 0, 0, 1, 0, 2, 0, 3, 0, work)
            signs[row, column] = sign
    return 0


@njit(error_model="numpy", forceinline=True)
def gather(points, one, other, pair, own):
    """Copy the corners of a pair of triangles; return their largest coordinate."""
    largest = 0.0
    for k in range(3):
        for axis in range(3):
            a, b = points[one[pair, k], axis], points[other[pair, k], axis]
            own[0, 3 * k + axis], own[1, 3 * k + axis] = a, b
            largest = max(largest, abs(a), abs(b))
    return largest


def cross_pairs(vertices_at, vertices, one_at, other_at, count, own_at, work_at, signs_at, crosses_at):
    """Write of which pairs of triangles that are given by their corners (count, 3) both cross: 0, 1, or `UNSURE`."""
    points = carray(vertices_at, (vertices, 3), np.float64)
    one, other = carray(one_at, (count, 3), np.int64), carray(other_at, (count, 3), np.int64)
    own, work = carray(own_at, (2, 9), np.float64), carray(work_at, (18 + TERMS,), np.float64)
    signs = carray(signs_at, (6,), np.int64)
    crosses = carray(crosses_at, (count,), np.int8)
    for pair in range(count):
        largest = gather(points, one, other, pair, own)
        crosses[pair] = cross(own, 0, 1, signs, work) if largest <= LARGEST else UNSURE
    return 0


@njit(error_model="numpy", forceinline=True)
def held_apart(own, plane, other):
    """Say whether floating point shows that the corners of a triangle lie on one side of the plane of another."""
    ax, ay, az = own[plane, 0], own[plane, 1], own[plane, 2]
    ux, uy, uz = own[plane, 3] - ax, own[plane, 4] - ay, own[plane, 5] - az
    vx, vy, vz = own[plane, 6] - ax, own[plane, 7] - ay, own[plane, 8] - az
    px, qx = uy * vz, uz * vy
    py, qy = uz * vx, ux * vz
    pz, qz = ux * vy, uy * vx
    mx, my, mz = abs(px) + abs(qx), abs(py) + abs(qy), abs(pz) + abs(qz)
    above = below = 0
    for k in range(3):
        wx, wy, wz = own[other, 3 * k] - ax, own[other, 3 * k + 1] - ay, own[other, 3 * k + 2] - az
        height = wx * (px - qx) + wy * (py - qy) + wz * (pz - qz)
        size = abs(wx) * mx + abs(wy) * my + abs(wz) * mz
        if not abs(height) > ORIENT3D * size + UNDERFLOW * (1 + (abs(wx) + abs(wy) + abs(wz))):
            return False
        if height > 0:
            above += 1
        else:
            below += 1
    return above == 0 or below == 0


def part_pairs(vertices_at, vertices, one_at, other_at, count, own_at, parted_at):
    """Write which pairs of triangles, given by their corners (count, 3), the plane of one of the two holds apart."""
    points = carray(vertices_at, (vertices, 3), np.float64)
    one, other = carray(one_at, (count, 3), np.int64), carray(other_at, (count, 3), np.int64)
    own = carray(own_at, (2, 9), np.float64)
    parted = carray(parted_at, (count,), np.int8)
    for pair in range(count):
        gather(points, one, other, pair, own)
        parted[pair] = held_apart(own, 0, 1) or held_apart(own, 1, 0)
    return 0
