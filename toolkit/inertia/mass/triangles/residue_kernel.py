"""The compiled kernel that sums the moments of triangles modulo a prime; `inertia.mass.triangles.exact` says how.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

IMPLICIT = np.int64(1 << 52)
MANTISSA = IMPLICIT - np.int64(1)
EXPONENT = np.int64(0x7FF)


@njit(inline="always")
def reduce(value, prime, inverse):
    """Return a residue of `value` between −prime and prime."""
    return value - np.int64(np.float64(value) * inverse) * prime


@njit(inline="always")
def local(bits, power, origin, prime, inverse):
    """Return the residue of a coordinate, given as the bits of a float64, minus that of the origin."""
    exponent = (bits >> np.int64(52)) & EXPONENT
    mantissa = bits & MANTISSA
    if exponent > 0:
        mantissa |= IMPLICIT
    residue = reduce(mantissa, prime, inverse) * power[exponent]
    if bits < 0:
        residue = -residue
    return reduce(residue - origin, prime, inverse)


def sum_residues(corners_at, count, power_at, origin_at, prime, inverse, out_at):
    """Add to `out` the ten sums over `count` triangles, their corners given as (9, count) float64."""
    corner = carray(corners_at, (9, count), np.int64)
    power = carray(power_at, (2048,), np.int64)
    origin = carray(origin_at, (3,), np.int64)
    out = carray(out_at, (10,), np.int64)
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = s8 = s9 = np.int64(0)
    for j in range(count):
        ax = local(corner[0, j], power, origin[0], prime, inverse)
        ay = local(corner[1, j], power, origin[1], prime, inverse)
        az = local(corner[2, j], power, origin[2], prime, inverse)
        bx = local(corner[3, j], power, origin[0], prime, inverse)
        by = local(corner[4, j], power, origin[1], prime, inverse)
        bz = local(corner[5, j], power, origin[2], prime, inverse)
        cx = local(corner[6, j], power, origin[0], prime, inverse)
        cy = local(corner[7, j], power, origin[1], prime, inverse)
        cz = local(corner[8, j], power, origin[2], prime, inverse)
        ux, uy, uz = bx - ax, by - ay, bz - az
        vx, vy, vz = cx - ax, cy - ay, cz - az
        nx = reduce(uy * vz - uz * vy, prime, inverse)
        ny = reduce(uz * vx - ux * vz, prime, inverse)
        nz = reduce(ux * vy - uy * vx, prime, inverse)
        d = reduce(ax * nx + ay * ny + az * nz, prime, inverse)
        tx, ty, tz = ax + bx, ay + by, az + bz
        sx = reduce(tx + cx, prime, inverse)
        sy = reduce(ty + cy, prime, inverse)
        sz = reduce(tz + cz, prime, inverse)
        s0 += d
        s1 += reduce(d * sx, prime, inverse)
        s2 += reduce(d * sy, prime, inverse)
        s3 += reduce(d * sz, prime, inverse)
        s4 += reduce(d * reduce(ax * ax + bx * tx + cx * sx, prime, inverse), prime, inverse)
        s5 += reduce(d * reduce(ay * ay + by * ty + cy * sy, prime, inverse), prime, inverse)
        s6 += reduce(d * reduce(az * az + bz * tz + cz * sz, prime, inverse), prime, inverse)
        s7 += reduce(d * reduce(sy * sz + ay * az + by * bz + cy * cz, prime, inverse), prime, inverse)
        s8 += reduce(d * reduce(sz * sx + az * ax + bz * bx + cz * cx, prime, inverse), prime, inverse)
        s9 += reduce(d * reduce(sx * sy + ax * ay + bx * by + cx * cy, prime, inverse), prime, inverse)
    out[0] += s0
    out[1] += s1
    out[2] += s2
    out[3] += s3
    out[4] += s4
    out[5] += s5
    out[6] += s6
    out[7] += s7
    out[8] += s8
    out[9] += s9
    return 0
