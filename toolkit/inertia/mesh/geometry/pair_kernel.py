"""The compiled tests of pairs of triangles that are listed: whether they cross, and whether a plane holds them apart.

Imported only to be compiled (`inertia.native`); see `triangle_pairs`, which does the same by numpy.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.crossing_kernel import ORIENT3D, TERMS, UNSURE, cross

UNDERFLOW = 2.0**-1070  # as in `triangle_pairs`
LARGEST = 2.0**300  # of which the products of three are numbers


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
