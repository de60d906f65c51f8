"""The compiled step from the sums of many small surfaces to volume, mass, centre and tensor with their bounds.

The arithmetic is double-double, rounded once; the bounds are the distances of the float64 sums from the double-double
ones, carried through as in `inertia.mass.moments.Moments.central`. See `inertia.mass.many`.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.mass.triangles.double_double_kernel import add, mul, two_sum
from inertia.mass.triangles.small_kernel import COLUMNS

VOLUME, MASS, CENTER, TENSOR, VOLUME_ERROR, CENTER_ERROR, INERTIA_ERROR, SURE = 0, 1, 2, 5, 14, 15, 16, 17
RESULTS = 18
"""Numbers of a surface; the last is 1 where they are certain, else 0."""

UNITS = 7
"""Powers of the unit: (m³/6, m, m⁵/480) in double-double, and m⁵."""

A_PRIORI = 1e-28
"""More than a term of the sums loses, 2⁻⁹⁵ (see `double_double_kernel.terms`), and 70 roundings of double-double, 2⁻¹⁰³
each: no term passes through more."""

ROUNDED = 2.0**-52  # once to float64, and all that double-double leaves
INFLATED = 1.0 + 1e-9  # more than the arithmetic of the bounds can lose
NORMAL = 2.0**-900  # far above the numbers that have fewer digits
CERTAIN = 1e-9  # as `inertia.mass.properties.CERTAIN`


@njit(error_model="numpy", forceinline=True)
def over(ah, al, b):
    """Return a/b for a float64 b: the float64 quotient and one step of Newton's method."""
    quotient = ah / b
    ph, pl = mul(quotient, 0.0, b, 0.0, False)
    rest, _ = add(ah, al, -ph, -pl, False)
    return two_sum(quotient, rest / b)


@njit(error_model="numpy", forceinline=True)
def diagonal(v, p, q, f, g, sh, sl):
    """Return (8 v (p + q) − 5 (f² + g²))/v times a factor."""
    th, tl = two_sum(p, q)
    th, tl = mul(8.0 * v, 0.0, th, tl, False)
    fh, fl = mul(f, 0.0, f, 0.0, False)
    gh, gl = mul(g, 0.0, g, 0.0, False)
    fh, fl = add(fh, fl, gh, gl, False)
    fh, fl = mul(fh, fl, 5.0, 0.0, False)
    th, tl = add(th, tl, -fh, -fl, False)
    th, tl = over(th, tl, v)
    return mul(th, tl, sh, sl, False)[0]


@njit(error_model="numpy", forceinline=True)
def mixed(v, p, f, g, sh, sl):
    """Return (5 f g − 4 v p)/v times a factor."""
    fh, fl = mul(f, 0.0, g, 0.0, False)
    fh, fl = mul(fh, fl, 5.0, 0.0, False)
    th, tl = mul(4.0 * v, 0.0, p, 0.0, False)
    fh, fl = add(fh, fl, -th, -tl, False)
    th, tl = over(fh, fl, v)
    return mul(th, tl, sh, sl, False)[0]


@njit(error_model="numpy", forceinline=True)
def apart(sums, accurate, k):
    """Return how far a sum is from the double-double one."""
    return abs((sums[k] - accurate[2 * k]) - accurate[2 * k + 1])


@njit(error_model="numpy", forceinline=True)
def is_sure(tensor, error):
    """Say whether a tensor's principal moments are certain to a part in 10⁹, and those of some body."""
    trace = tensor[0] + tensor[4] + tensor[8]
    xx, yy, zz = tensor[0] / trace, tensor[4] / trace, tensor[8] / trace
    yz, zx, xy = tensor[5] / trace, tensor[2] / trace, tensor[1] / trace
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)
    p, q, r = 0.5 - xx, 0.5 - yy, 0.5 - zz
    body = p * (q * r - yz * yz) - xy * (xy * r + yz * zx) - zx * (xy * yz + q * zx)
    physical = (p > 0) and (q > 0) and (r > 0) and (body > 3.0 * error + 1e-14)
    return physical and 2.0 * error < CERTAIN * (determinant - 1e-13)


@njit(error_model="numpy", forceinline=True)
def norm(xx, yy, zz, yz, zx, xy):
    """Return the Frobenius norm of a symmetric matrix, of whose elements the squares may be beyond float64."""
    largest = max(max(abs(xx), abs(yy), abs(zz)), max(abs(yz), abs(zx), abs(xy)))
    if not 0.0 < largest < np.inf:
        return largest
    xx, yy, zz, yz, zx, xy = xx / largest, yy / largest, zz / largest, yz / largest, zx / largest, xy / largest
    return largest * np.sqrt((xx * xx + yy * yy + zz * zz) + 2.0 * (yz * yz + zx * zx + xy * xy))


@njit(error_model="numpy", forceinline=True)
def second_bound(off, f, g, along, other, weight):
    """Return the bound on a central second moment, of that of the sum, and (bound, bound moved along) of each axis."""
    return off + along * g[0] + other * f[1] + f[1] * g[1] * weight


def mass_results(rows_at, meshes, densities_at, units_at, out_at):
    """Write the results of surfaces whose sums (`small_kernel.sum_small`) are given, and whose volume is positive."""
    rows = carray(rows_at, (meshes, COLUMNS), np.float64)
    densities = carray(densities_at, (meshes,), np.float64)
    units = carray(units_at, (UNITS,), np.float64)
    out = carray(out_at, (meshes, RESULTS), np.float64)
    for mesh in range(meshes):
        row, density, result = rows[mesh], densities[mesh], out[mesh]
        origin, sums, low, high, accurate = row[:3], row[3:16], row[16:19], row[19:22], row[22:]
        v, fx, fy, fz = sums[0], sums[1], sums[2], sums[3]
        xx, yy, zz, yz, zx, xy = sums[4], sums[5], sums[6], sums[7], sums[8], sums[9]
        vh, vl = mul(v, 0.0, units[0], units[1], False)
        result[VOLUME] = vh
        result[MASS] = mul(vh, vl, density, 0.0, False)[0]
        reach = 0.0
        for axis in range(3):
            reach = max(reach, max(origin[axis] - low[axis], high[axis] - origin[axis]))
        size = A_PRIORI * (sums[10] + sums[12])
        off = (apart(sums, accurate, 0) + size) / 6.0
        least = v / 6.0 - off
        x = y = z = far = 0.0
        bx = by = bz = (0.0, 0.0)
        for axis in range(3):
            rh, rl = over(sums[1 + axis], 0.0, 4.0 * v)
            along = abs(rh)
            first = (apart(sums, accurate, 1 + axis) + 3.0 * reach * size) / 24.0
            moved = first + along * off
            if axis == 0:
                x, bx = along, (first, moved)
            elif axis == 1:
                y, by = along, (first, moved)
            else:
                z, bz = along, (first, moved)
            rh, rl = add(rh, rl, origin[axis], 0.0, False)
            result[CENTER + axis] = mul(rh, rl, units[2], units[3], False)[0]
            far += result[CENTER + axis] * result[CENTER + axis]
        sh, sl = mul(units[4], units[5], density, 0.0, False)
        ixx, iyy, izz = (
            diagonal(v, yy, zz, fy, fz, sh, sl),
            diagonal(v, zz, xx, fz, fx, sh, sl),
            diagonal(v, xx, yy, fx, fy, sh, sl),
        )
        iyz, izx, ixy = mixed(v, yz, fy, fz, sh, sl), mixed(v, zx, fz, fx, sh, sl), mixed(v, xy, fx, fy, sh, sl)
        tensor = result[TENSOR:VOLUME_ERROR]
        tensor[0], tensor[1], tensor[2] = ixx, ixy, izx
        tensor[3], tensor[4], tensor[5] = ixy, iyy, iyz
        tensor[6], tensor[7], tensor[8] = izx, iyz, izz

        weight = (v / 6.0 + off) / least**2
        lost = 12.0 * reach * reach * size
        oxx = second_bound((apart(sums, accurate, 4) + lost) / 60.0, bx, bx, x, x, weight)
        oyy = second_bound((apart(sums, accurate, 5) + lost) / 60.0, by, by, y, y, weight)
        ozz = second_bound((apart(sums, accurate, 6) + lost) / 60.0, bz, bz, z, z, weight)
        oyz = second_bound((apart(sums, accurate, 7) + lost) / 120.0, by, bz, y, z, weight)
        ozx = second_bound((apart(sums, accurate, 8) + lost) / 120.0, bz, bx, z, x, weight)
        oxy = second_bound((apart(sums, accurate, 9) + lost) / 120.0, bx, by, x, y, weight)
        lost = norm(oyy + ozz, ozz + oxx, oxx + oyy, oyz, ozx, oxy) * (units[6] * density)
        distance = norm(bx[1], by[1], bz[1], 0.0, 0.0, 0.0) / least + A_PRIORI * reach
        volume_error = off / (v / 6.0) * INFLATED + ROUNDED
        center_error = distance * units[2] * INFLATED + ROUNDED * np.sqrt(far)
        whole = norm(ixx, iyy, izz, iyz, izx, ixy)
        inertia_error = lost / whole * INFLATED + ROUNDED
        result[VOLUME_ERROR], result[CENTER_ERROR], result[INERTIA_ERROR] = volume_error, center_error, inertia_error
        sure = is_sure(tensor, inertia_error) and volume_error <= CERTAIN and abs(center_error) < np.inf
        sure = sure and NORMAL < whole < np.inf and vh > NORMAL and NORMAL < result[MASS] < np.inf
        result[SURE] = 1.0 if sure else 0.0
    return 0
