"""The compiled comparison of triangles that may meet at common corners alone.

The steps are those of `corner_contacts` in numpy, pair by pair, and pairs of shells that are known to meet elsewhere
are looked at no further.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mesh.geometry.crossing_kernel import TERMS, UNSURE, exact_sign, orient


@njit(error_model="numpy", forceinline=True)
def sign_of(own, a, b, c, d, l, work):
    """Return on which side of corners 0, 1 and 2 of rows a, b and c lies corner l of row d, exactly, or `UNSURE`."""
    sign = orient(own, a, 0, b, 1, c, 2, d, l)
    return exact_sign(own, a, 0, b, 1, c, 2, d, l, work) if sign == UNSURE else sign


@njit(error_model="numpy", forceinline=True)
def has_common(same, corner, of):
    """Say whether a corner is common; `same` has the bit 3 i + j where corner i of one is corner j of the other."""
    return same & (0b111 << 3 * corner if of == 0 else 0b1001001 << corner) != 0


@njit(error_model="numpy", forceinline=True)
def ends_along(own, row, left, axis):
    """Return the least and the largest coordinate of those corners of a triangle that are left, a bit each."""
    low, high = np.inf, -np.inf
    for k in range(3):
        if left >> k & 1:
            low, high = min(low, own[row, 3 * k + axis]), max(high, own[row, 3 * k + axis])
    return low, high


@njit(error_model="numpy", forceinline=True)
def lie_at(own, row, left, axis, value):
    """Return which of the corners that are left have this coordinate."""
    for k in range(3):
        if own[row, 3 * k + axis] != value:
            left &= ~(1 << k)
    return left


@njit(error_model="numpy", forceinline=True)
def all_common(same, left, of):
    """Say whether all corners that are left are common."""
    every = True
    for k in range(3):
        every &= not left >> k & 1 or has_common(same, k, of)
    return every


@njit(error_model="numpy", forceinline=True)
def meet_in_boxes(own, same):
    """Say whether comparing coordinates shows that two triangles meet at common corners alone."""
    one, other = 0b111, 0b111
    for _ in range(3):
        to_one, to_other, ends, apart = one, other, False, False
        for axis in range(3):
            low, high = ends_along(own, 0, one, axis)
            lower, higher = ends_along(own, 1, other, axis)
            apart |= low > higher or lower > high
            for turn in range(2):
                at = high if turn == 0 else low
                if at == (lower if turn == 0 else higher):
                    ends = True
                    to_one, to_other = lie_at(own, 0, to_one, axis, at), lie_at(own, 1, to_other, axis, at)
        one, other = to_one, to_other
        if apart or all_common(same, one, 0) or all_common(same, other, 1):
            return True
        if not ends:
            return False
    return False


@njit(error_model="numpy", forceinline=True)
def parted_in_plane(own, plane, triangle, same, work):
    """Say whether a side of a triangle parts it from another in its plane, but at the side's ends; or `UNSURE`."""
    ux, uy, uz = (own[plane, 3] - own[plane, 0], own[plane, 4] - own[plane, 1], own[plane, 5] - own[plane, 2])
    vx, vy, vz = (own[plane, 6] - own[plane, 0], own[plane, 7] - own[plane, 1], own[plane, 8] - own[plane, 2])
    nx, ny, nz = abs(uy * vz - uz * vy), abs(uz * vx - ux * vz), abs(ux * vy - uy * vx)
    axis = 0 if nx >= ny and nx >= nz else (1 if ny >= nz else 2)  # along which neither is upright
    for k in range(3):
        then, last, facing = (k + 1) % 3, (k + 2) % 3, 0
        parts = True
        for point in range(4):  # the third corner of its own, and those of the other
            row, corner = (plane, last) if point == 0 else (triangle, point - 1)
            ends = same >> (3 * k + corner) | same >> (3 * then + corner)
            if plane == 1:
                ends = same >> (3 * corner + k) | same >> (3 * corner + then)
            if point > 0 and ends & 1:
                continue
            for c in range(3):
                own[2, c] = own[2, 6 + c] = 0.0 if c == axis else own[plane, 3 * k + c]
                own[2, 3 + c] = 0.0 if c == axis else own[plane, 3 * then + c]
                own[3, c] = 0.0 if c == axis else own[row, 3 * corner + c]
            own[2, 6 + axis] = 1.0
            sign = sign_of(own, 2, 2, 2, 3, 0, work)
            if sign == UNSURE:
                return UNSURE
            if point == 0:
                facing = sign
            if sign == 0 or (point > 0 and sign == facing):
                parts = False
                break
        if parts:
            return 1
    return 0


@njit(error_model="numpy", forceinline=True)
def parted(own, plane, triangle, same, work):
    """Say whether the plane of a triangle, or a side in it, parts it from another but at common corners."""
    above = below = level = True
    for k in range(3):
        if has_common(same, k, triangle):
            continue
        sign = sign_of(own, plane, plane, plane, triangle, k, work)
        if sign == UNSURE:
            return UNSURE
        above, below, level = above and sign > 0, below and sign < 0, level and sign == 0
    if above or below:
        return 1
    return parted_in_plane(own, plane, triangle, same, work) if level else 0


def settle_pairs(
    corners_at, faces_at, clear_at, faces_count, listed_at, count, beyond_at, pairs, own_at, work_at, unsure_at
):
    """Mark the pairs of shells of which listed triangles (one, other, pair) meet beyond their common corners.

    Or that have an edge in common that is not `clear`. What exact signs do not tell is marked as unsure.
    """
    corners, faces = carray(corners_at, (faces_count, 9), np.float64), carray(faces_at, (faces_count, 3), np.int64)
    clear, listed = carray(clear_at, (faces_count, 3), np.uint8), carray(listed_at, (count, 3), np.int64)
    beyond, unsure = carray(beyond_at, (pairs,), np.uint8), carray(unsure_at, (count,), np.uint8)
    own, work = carray(own_at, (4, 9), np.float64), carray(work_at, (18 + TERMS,), np.float64)
    for row in range(count):
        one, other, pair = listed[row, 0], listed[row, 1], listed[row, 2]
        if beyond[pair]:
            continue
        same = 0
        for i in range(3):
            for j in range(3):
                same |= (1 if faces[one, i] == faces[other, j] else 0) << (3 * i + j)
        for k in range(9):
            own[0, k], own[1, k] = corners[one, k], corners[other, k]
        shown = 1 if meet_in_boxes(own, same) else 0
        for plane in range(2):
            if shown == 0:
                shown = parted(own, plane, 1 - plane, same, work)
        if shown == UNSURE:
            unsure[row] = 1
            continue
        for k in range(3):
            if has_common(same, k, 0) and has_common(same, (k + 1) % 3, 0) and not clear[one, k]:
                shown = 0
        if shown == 0:
            beyond[pair] = 1
    return 0
