"""The compiled kernel of double-double sums over triangles; `inertia.mass.triangles.double_double` says how.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit, types
from numba.extending import intrinsic

from inertia.mass.triangles.fetch_kernel import DEPTH, LANES, fetch_faces, fetch_facets

TERMS = 10


@intrinsic
def fma(context, a, b, c):
    """Return a·b + c, rounded once."""

    def generate(context, builder, signature, arguments):
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), generate


@njit(error_model="numpy", forceinline=True)
def two_sum(a, b):
    """Return a + b and what rounding took from it."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


@njit(error_model="numpy", forceinline=True)
def add(ah, al, bh, bl, loose):
    """Return the sum of two double-doubles."""
    h, e = two_sum(ah, bh)
    e += al + bl
    if loose:
        return h, e
    s = h + e
    return s, e - (s - h)


@njit(error_model="numpy", forceinline=True)
def mul(ah, al, bh, bl, loose):
    """Return the product of two double-doubles."""
    h = ah * bh
    e = fma(ah, bh, -h) + (ah * bl + al * bh)
    if loose:
        return h, e
    s = h + e
    return s, e - (s - h)


@njit(error_model="numpy", forceinline=True)
def dot(ah, al, bh, bl, ch, cl, dh, dl, loose):
    """Return a·b + c·d."""
    ph, pl = mul(ah, al, bh, bl, loose)
    qh, ql = mul(ch, cl, dh, dl, loose)
    return add(ph, pl, qh, ql, loose)


@njit(error_model="numpy", forceinline=True)
def cross(ah, al, bh, bl, ch, cl, dh, dl, loose):
    """Return a·b − c·d."""
    return dot(ah, al, bh, bl, -ch, -cl, dh, dl, loose)


@njit(error_model="numpy", forceinline=True)
def store(total, row, j, h, l, loose):
    """Add to a sum."""
    total[row, j], total[row + 1, j] = add(total[row, j], total[row + 1, j], h, l, loose)


@njit(inline="always")
def terms(corner, total, ox, oy, oz, loose):
    """Add one triangle to each lane.

    Where it is `loose`, the lower of two numbers is not brought below the last place of the upper one: a third less
    work. No term has more than 40 roundings u of the magnitudes that enter it in its lower number, so that what is lost
    of it, in products of two of them and in their own rounding, stays below 2⁻⁹⁵ of these.
    """
    for j in range(LANES):
        x0, y0, z0 = corner[0, j], corner[1, j], corner[2, j]
        x1, y1, z1 = corner[3, j], corner[4, j], corner[5, j]
        x2, y2, z2 = corner[6, j], corner[7, j], corner[8, j]
        uxh, uxl = two_sum(x1, -x0)
        uyh, uyl = two_sum(y1, -y0)
        uzh, uzl = two_sum(z1, -z0)
        vxh, vxl = two_sum(x2, -x0)
        vyh, vyl = two_sum(y2, -y0)
        vzh, vzl = two_sum(z2, -z0)
        axh, axl = two_sum(x0, -ox)
        ayh, ayl = two_sum(y0, -oy)
        azh, azl = two_sum(z0, -oz)
        bxh, bxl = two_sum(x1, -ox)
        byh, byl = two_sum(y1, -oy)
        bzh, bzl = two_sum(z1, -oz)
        cxh, cxl = two_sum(x2, -ox)
        cyh, cyl = two_sum(y2, -oy)
        czh, czl = two_sum(z2, -oz)
        nxh, nxl = cross(uyh, uyl, vzh, vzl, uzh, uzl, vyh, vyl, loose)
        nyh, nyl = cross(uzh, uzl, vxh, vxl, uxh, uxl, vzh, vzl, loose)
        nzh, nzl = cross(uxh, uxl, vyh, vyl, uyh, uyl, vxh, vxl, loose)
        dh, dl = dot(axh, axl, nxh, nxl, ayh, ayl, nyh, nyl, loose)
        eh, el = mul(azh, azl, nzh, nzl, loose)
        dh, dl = add(dh, dl, eh, el, loose)
        txh, txl = add(axh, axl, bxh, bxl, loose)
        tyh, tyl = add(ayh, ayl, byh, byl, loose)
        tzh, tzl = add(azh, azl, bzh, bzl, loose)
        sxh, sxl = add(txh, txl, cxh, cxl, loose)
        syh, syl = add(tyh, tyl, cyh, cyl, loose)
        szh, szl = add(tzh, tzl, czh, czl, loose)
        store(total, 0, j, dh, dl, loose)
        h, l = mul(dh, dl, sxh, sxl, loose)
        store(total, 2, j, h, l, loose)
        h, l = mul(dh, dl, syh, syl, loose)
        store(total, 4, j, h, l, loose)
        h, l = mul(dh, dl, szh, szl, loose)
        store(total, 6, j, h, l, loose)
        gh, gl = square(axh, axl, bxh, bxl, txh, txl, cxh, cxl, sxh, sxl, loose)
        h, l = mul(dh, dl, gh, gl, loose)
        store(total, 8, j, h, l, loose)
        gh, gl = square(ayh, ayl, byh, byl, tyh, tyl, cyh, cyl, syh, syl, loose)
        h, l = mul(dh, dl, gh, gl, loose)
        store(total, 10, j, h, l, loose)
        gh, gl = square(azh, azl, bzh, bzl, tzh, tzl, czh, czl, szh, szl, loose)
        h, l = mul(dh, dl, gh, gl, loose)
        store(total, 12, j, h, l, loose)
        gh, gl = mixed(syh, syl, szh, szl, ayh, ayl, azh, azl, byh, byl, bzh, bzl, cyh, cyl, czh, czl, loose)
        h, l = mul(dh, dl, gh, gl, loose)
        store(total, 14, j, h, l, loose)
        gh, gl = mixed(szh, szl, sxh, sxl, azh, azl, axh, axl, bzh, bzl, bxh, bxl, czh, czl, cxh, cxl, loose)
        h, l = mul(dh, dl, gh, gl, loose)
        store(total, 16, j, h, l, loose)
        gh, gl = mixed(sxh, sxl, syh, syl, axh, axl, ayh, ayl, bxh, bxl, byh, byl, cxh, cxl, cyh, cyl, loose)
        h, l = mul(dh, dl, gh, gl, loose)
        store(total, 18, j, h, l, loose)


@njit(error_model="numpy", forceinline=True)
def square(ah, al, bh, bl, th, tl, ch, cl, sh, sl, loose):
    """Return a² + b t + c s."""
    gh, gl = dot(ah, al, ah, al, bh, bl, th, tl, loose)
    ph, pl = mul(ch, cl, sh, sl, loose)
    return add(gh, gl, ph, pl, loose)


@njit(error_model="numpy", forceinline=True)
def mixed(sh, sl, rh, rl, ah, al, ph, pl, bh, bl, qh, ql, ch, cl, wh, wl, loose):
    """Return s r + a p + b q + c w."""
    gh, gl = dot(sh, sl, rh, rl, ah, al, ph, pl, loose)
    kh, kl = dot(bh, bl, qh, ql, ch, cl, wh, wl, loose)
    return add(gh, gl, kh, kl, loose)


@njit(inline="always")
def clear(total):
    """Begin a block."""
    for row in range(2 * TERMS):
        for lane in range(LANES):
            total[row, lane] = 0.0


@njit(inline="always")
def finish(total, out, block):
    """Add up the lanes as a binary tree and store the block."""
    half = LANES // 2
    while half > 0:
        for row in range(0, 2 * TERMS, 2):
            for lane in range(half):
                store(total, row, lane, total[row, lane + half], total[row + 1, lane + half], False)
        half //= 2
    for row in range(2 * TERMS):
        out[block, row] = total[row, 0]


def sum_facets(records, count, ox, oy, oz, scratch, out_at):
    """Sum `count` binary STL records into a row (10 sums, high and low) for each block."""
    room = carray(scratch, (9 + 2 * TERMS, LANES), np.float64)
    corner, total = room[:9], room[9:]
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, 2 * TERMS), np.float64)
    for block in range(blocks):
        clear(total)
        for start in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_facets(records, start, count, scratch, corner)
            terms(corner, total, ox, oy, oz, False)
        finish(total, out, block)
    return 0


def sum_faces(vertices, faces_at, count, ox, oy, oz, scratch, out_at):
    """Sum `count` faces over shared vertices into a row (10 sums, high and low) for each block."""
    faces = carray(faces_at, (count, 3), np.int64)
    room = carray(scratch, (9 + 2 * TERMS, LANES), np.float64)
    corner, total = room[:9], room[9:]
    blocks = (count + LANES * DEPTH - 1) // (LANES * DEPTH)
    out = carray(out_at, (blocks, 2 * TERMS), np.float64)
    for block in range(blocks):
        clear(total)
        for start in range(block * LANES * DEPTH, min((block + 1) * LANES * DEPTH, count), LANES):
            fetch_faces(vertices, faces, start, count, scratch, corner)
            terms(corner, total, ox, oy, oz, False)
        finish(total, out, block)
    return 0
