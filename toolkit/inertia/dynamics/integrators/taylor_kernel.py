"""The compiled Taylor method for a rigid body; `inertia.dynamics.integrators.taylor` says what it computes.

Imported only to be compiled (`inertia.native`).

Every sum of products Σ aₘ bₙ₋ₘ that the series need stands in one lane of a *block* of eight, so that eight of them
grow by one vector instruction; this is why eight statements stand side by side. A block keeps a row of left and a row
of right factors for each coefficient.

    block 1   left (w, w, w, −x | y, z, x, −y)         right (Ω₁, Ω₂, Ω₃, Ω₁ | Ω₃, Ω₁, Ω₂, Ω₂)          q Ω, two thirds
    block 2   left (−z, −x, −y, −z | ω₂, ω₃, ω₁, 0)    right (Ω₂, Ω₃, Ω₁, Ω₃ | ω₃, ω₁, ω₂, 0)            the rest; ω ω
    block 3   left, right: the factors of I ω × (Ω − ω)
    block 4   and every second from there: of v × Ω;   block 5 and every second: of v ∘ v, where it has a torque

Block 0 holds the coefficients (x, y, z, w, ω₁, ω₂, ω₃, 0) themselves.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.dynamics.integrators.loop_kernel import HEAD, VECTOR, through

ROWS, SPARE = 33, 32
"""Rows of a block: coefficients, and a last one for what the block of a vector keeps for the next coefficient. Their
number is odd, so that rows of two blocks do not fall on one line of the cache."""


@njit(error_model="numpy", forceinline=True, fastmath={"contract"})
def put(table, at, n, side, a, b, c, d, e, f, g, h):
    """Write a row of eight."""
    table[at, n, side, 0] = a
    table[at, n, side, 1] = b
    table[at, n, side, 2] = c
    table[at, n, side, 3] = d
    table[at, n, side, 4] = e
    table[at, n, side, 5] = f
    table[at, n, side, 6] = g
    table[at, n, side, 7] = h


@njit(error_model="numpy", forceinline=True, fastmath={"contract"})
def convolve(table, at, n, l0, l1, l2, l3, l4, l5, l6, l7, r0, r1, r2, r3, r4, r5, r6, r7):
    """Add row n of the left and right factors to a block; return the eight sums over m of left[m] right[n − m].

    The products with the youngest rows come last: the others need not wait for them.
    """
    put(table, at, n, 0, l0, l1, l2, l3, l4, l5, l6, l7)
    put(table, at, n, 1, r0, r1, r2, r3, r4, r5, r6, r7)
    a = b = c = d = e = f = g = h = 0.0
    if n > 3:
        last = np.uint64(n)  # an index without a sign needs no test of it
        for m in range(np.uint64(2), last - np.uint64(1)):
            a += table[at, m, 0, 0] * table[at, last - m, 1, 0]
            b += table[at, m, 0, 1] * table[at, last - m, 1, 1]
            c += table[at, m, 0, 2] * table[at, last - m, 1, 2]
            d += table[at, m, 0, 3] * table[at, last - m, 1, 3]
            e += table[at, m, 0, 4] * table[at, last - m, 1, 4]
            f += table[at, m, 0, 5] * table[at, last - m, 1, 5]
            g += table[at, m, 0, 6] * table[at, last - m, 1, 6]
            h += table[at, m, 0, 7] * table[at, last - m, 1, 7]
    if n > 0:
        if n > 1:
            a += table[at, 1, 0, 0] * table[at, n - 1, 1, 0]
            b += table[at, 1, 0, 1] * table[at, n - 1, 1, 1]
            c += table[at, 1, 0, 2] * table[at, n - 1, 1, 2]
            d += table[at, 1, 0, 3] * table[at, n - 1, 1, 3]
            e += table[at, 1, 0, 4] * table[at, n - 1, 1, 4]
            f += table[at, 1, 0, 5] * table[at, n - 1, 1, 5]
            g += table[at, 1, 0, 6] * table[at, n - 1, 1, 6]
            h += table[at, 1, 0, 7] * table[at, n - 1, 1, 7]
            if n > 2:
                a += table[at, n - 1, 0, 0] * table[at, 1, 1, 0]
                b += table[at, n - 1, 0, 1] * table[at, 1, 1, 1]
                c += table[at, n - 1, 0, 2] * table[at, 1, 1, 2]
                d += table[at, n - 1, 0, 3] * table[at, 1, 1, 3]
                e += table[at, n - 1, 0, 4] * table[at, 1, 1, 4]
                f += table[at, n - 1, 0, 5] * table[at, 1, 1, 5]
                g += table[at, n - 1, 0, 6] * table[at, 1, 1, 6]
                h += table[at, n - 1, 0, 7] * table[at, 1, 1, 7]
        a += table[at, 0, 0, 0] * r0
        b += table[at, 0, 0, 1] * r1
        c += table[at, 0, 0, 2] * r2
        d += table[at, 0, 0, 3] * r3
        e += table[at, 0, 0, 4] * r4
        f += table[at, 0, 0, 5] * r5
        g += table[at, 0, 0, 6] * r6
        h += table[at, 0, 0, 7] * r7
    a += l0 * table[at, 0, 1, 0]
    b += l1 * table[at, 0, 1, 1]
    c += l2 * table[at, 0, 1, 2]
    d += l3 * table[at, 0, 1, 3]
    e += l4 * table[at, 0, 1, 4]
    f += l5 * table[at, 0, 1, 5]
    g += l6 * table[at, 0, 1, 6]
    h += l7 * table[at, 0, 1, 7]
    return a, b, c, d, e, f, g, h


@njit(error_model="numpy", forceinline=True, fastmath={"contract"})
def value(table, order, tau):
    """Return the state at `tau` by Horner's rule."""
    a = table[0, order, 0, 0]
    b = table[0, order, 0, 1]
    c = table[0, order, 0, 2]
    d = table[0, order, 0, 3]
    e = table[0, order, 0, 4]
    f = table[0, order, 0, 5]
    g = table[0, order, 0, 6]
    h = table[0, order, 0, 7]
    for n in range(order - 1, -1, -1):
        a = a * tau + table[0, n, 0, 0]
        b = b * tau + table[0, n, 0, 1]
        c = c * tau + table[0, n, 0, 2]
        d = d * tau + table[0, n, 0, 3]
        e = e * tau + table[0, n, 0, 4]
        f = f * tau + table[0, n, 0, 5]
        g = g * tau + table[0, n, 0, 6]
        h = h * tau + table[0, n, 0, 7]
    return a, b, c, d, e, f, g


@njit(error_model="numpy", forceinline=True, fastmath={"contract"})
def to_body(x, y, z, w, a, b, c):
    """Return the body components of a vector of space."""
    d, e, f = b * z - c * y + w * a, c * x - a * z + w * b, a * y - b * x + w * c
    return a + 2.0 * (e * z - f * y), b + 2.0 * (f * x - d * z), c + 2.0 * (d * y - e * x)


@njit(error_model="numpy", forceinline=True, fastmath={"contract"})
def expand(moments, terms, count, simple, now, order, table):
    """Fill block 0 with the coefficients of the motion from its first row on.

    Moments are subtracted before anything else, so that slender bodies keep their digits. Terms are `simple` where
    there is no dissipation, and one vector with a torque that is linear in it and keeps its strength.
    """
    i0, i1, i2 = 1.0 / moments[0], 1.0 / moments[1], 1.0 / moments[2]
    m0 = (moments[1] - moments[2]) * i0
    m1 = (moments[2] - moments[0]) * i1
    m2 = (moments[0] - moments[1]) * i2
    kappa = terms[9]
    d0, d1, d2 = terms[6] * i0, terms[7] * i1, terms[8] * i2
    c0, c1, c2 = terms[0] + now * terms[3], terms[1] + now * terms[4], terms[2] + now * terms[5]
    x, y, z, w = table[0, 0, 0, 0], table[0, 0, 0, 1], table[0, 0, 0, 2], table[0, 0, 0, 3]
    p, q, r = table[0, 0, 0, 4], table[0, 0, 0, 5], table[0, 0, 0, 6]
    for n in range(order):
        o0, o1, o2 = p, q, r
        g0, g1, g2, g3, e0, e1, e2, idle = convolve(
            table, 2, n, -z, -x, -y, -z, q, r, p, 0.0, o1, o2, o0, o2, r, p, q, 0.0
        )
        e0, e1, e2 = m0 * e0, m1 * e1, m2 * e2
        if not simple and kappa != 0.0:
            s0, s1, s2 = kappa * e0 * i0, kappa * e1 * i1, kappa * e2 * i2
            o0, o1, o2 = p + s0, q + s1, r + s2
            g0, g1 = g0 + table[2, 0, 0, 0] * s1, g1 + table[2, 0, 0, 1] * s2
            g2, g3 = g2 + table[2, 0, 0, 2] * s0, g3 + table[2, 0, 0, 3] * s2
            put(table, 2, n, 1, o1, o2, o0, o2, r, p, q, 0.0)
            l0, l1, l2 = moments[0] * p, moments[1] * q, moments[2] * r
            f0, f1, f2, _, f4, f5, f6, _ = convolve(
                table, 3, n, l1, l2, l0, 0.0, l2, l0, l1, 0.0, s2, s0, s1, 0.0, s1, s2, s0, 0.0
            )
            e0, e1, e2 = e0 + (f0 - f4) * i0, e1 + (f1 - f5) * i1, e2 + (f2 - f6) * i2
        f0, f1, f2, f3, f4, f5, f6, f7 = convolve(table, 1, n, w, w, w, -x, y, z, x, -y, o0, o1, o2, o0, o2, o0, o1, o1)
        scale = 1.0 / (n + 1)
        t0, t1, t2 = c0, c1, c2
        if n == 0:
            c0, c1, c2 = terms[3], terms[4], terms[5]
        else:
            c0 = c1 = c2 = 0.0
        for j in range(1 if simple else count):
            at, to = HEAD + VECTOR * j, 4 + 2 * j
            spare = table[to, SPARE, 0]
            if n == 0:
                u, v, s = to_body(x, y, z, w, terms[at], terms[at + 1], terms[at + 2])
            else:
                u, v, s = spare[0], spare[1], spare[2]
            h0, h1, h2, h3, h4, h5, h6, h7 = convolve(
                table, to, n, v, s, u, 0.0, s, u, v, 0.0, o2, o0, o1, 0.0, o1, o2, o0, 0.0
            )
            spare[0], spare[1], spare[2] = (h0 - h4) * scale, (h1 - h5) * scale, (h2 - h6) * scale
            spare[3] = h3 - h7
            h0 = terms[at + 3] * u + terms[at + 4] * v + terms[at + 5] * s
            h1 = terms[at + 6] * u + terms[at + 7] * v + terms[at + 8] * s
            h2 = terms[at + 9] * u + terms[at + 10] * v + terms[at + 11] * s
            q0, q1, q2 = terms[at + 12], terms[at + 13], terms[at + 14]
            if not simple and (q0 != 0.0 or q1 != 0.0 or q2 != 0.0):
                s0, s1, s2, _, _, _, _, _ = convolve(
                    table, to + 1, n, v, s, u, 0.0, 0.0, 0.0, 0.0, 0.0, s, u, v, 0.0, 0.0, 0.0, 0.0, 0.0
                )
                h0, h1, h2 = h0 + (q2 - q1) * s0, h1 + (q0 - q2) * s1, h2 + (q1 - q0) * s2
            constant, slope = terms[at + 15], terms[at + 16]
            weight = constant + slope * now
            t0, t1, t2 = t0 + weight * h0, t1 + weight * h1, t2 + weight * h2
            if not simple and slope != 0.0:
                if n > 0:
                    t0, t1, t2 = t0 + slope * spare[4], t1 + slope * spare[5], t2 + slope * spare[6]
                spare[4], spare[5], spare[6] = h0, h1, h2
        half = 0.5 * scale
        x, y, z, w = (f0 + f4 + g0) * half, (f1 + f5 + g1) * half, (f2 + f6 + g2) * half, (f3 + f7 + g3) * half
        p = (e0 + t0 * i0 - d0 * p) * scale
        q = (e1 + t1 * i1 - d1 * q) * scale
        r = (e2 + t2 * i2 - d2 * r) * scale
        put(table, 0, n + 1, 0, x, y, z, w, p, q, r, idle)


@njit(error_model="numpy", forceinline=True, fastmath={"contract"})
def length(table, order, tolerance):
    """Return the step over which the last two coefficients stay below the tolerance; infinite if they vanish."""
    u = 1.0 / max(1.0, abs(table[0, 0, 0, 4]))
    v = 1.0 / max(1.0, abs(table[0, 0, 0, 5]))
    w = 1.0 / max(1.0, abs(table[0, 0, 0, 6]))
    logarithm = np.inf
    for n in range(order - 1, order + 1):
        turned = max(abs(table[0, n, 0, 0]), abs(table[0, n, 0, 1]), abs(table[0, n, 0, 2]), abs(table[0, n, 0, 3]))
        spun = max(abs(table[0, n, 0, 4]) * u, abs(table[0, n, 0, 5]) * v, abs(table[0, n, 0, 6]) * w)
        largest = max(turned, spun)
        if largest > 0.0:
            logarithm = min(logarithm, np.log(tolerance / largest) / n)
    return np.exp(logarithm)


inline = njit(error_model="numpy", forceinline=True, fastmath={"contract"})


def taylor(simple):
    """Return the kernel of the Taylor method for terms that are `simple`, or for all."""

    @inline
    def aim(work, clock, row, target):
        return clock

    @inline
    def short(clock, target):
        now, slack, reach = clock
        return (target - now) - slack > reach

    @inline
    def step(work, clock, state, target):
        moments, terms, count, order, tolerance, table = work
        now, slack, reach = clock
        a, b, c, d, e, f, g = state
        fine = True
        if reach > 0.0:
            a, b, c, d, e, f, g = value(table, order, reach)
            size = a * a + b * b + c * c + d * d
            fine = size + abs(e) + abs(f) + abs(g) < np.inf
            unit = 1.5 - 0.5 * size
            a, b, c, d = a * unit, b * unit, c * unit, d * unit
            reach += slack
            ahead = now + reach
            slack = reach - (ahead - now)
            now = ahead
        put(table, 0, 0, 0, a, b, c, d, e, f, g, 0.0)
        expand(moments, terms, count, simple, now, order, table)
        reach = length(table, order, tolerance)
        return (now, slack, reach), (a, b, c, d, e, f, g), 1 if fine and reach > 0.0 else 0

    @inline
    def within(work, clock, state, target):
        now, slack, _ = clock
        a, b, c, d, e, f, g = value(work[5], work[3], (target - now) - slack)
        unit = 1.0 / np.sqrt(a * a + b * b + c * c + d * d)
        return a * unit, b * unit, c * unit, d * unit, e, f, g

    follow = through(inline, (0.0, 0.0, 0.0), aim, short, step, within)

    def advance(
        moments_at,
        terms_at,
        count,
        times_at,
        samples,
        start,
        end,
        rate,
        limit,
        rows_at,
        order,
        tolerance,
        scratch_at,
    ):
        """Follow the series through a piece of a run; −1 also where the motion leaves float64."""
        moments = carray(moments_at, (3,), np.float64)
        terms = carray(terms_at, (HEAD + VECTOR * count,), np.float64)
        table = carray(scratch_at, (4 + 2 * count, ROWS, 2, 8), np.float64)
        work = moments, terms, count, order, tolerance, table
        steps = follow(work, (times_at, samples, start, end, rate, limit, rows_at))
        last = carray(rows_at, (samples + 1, 7), np.float64)[samples]
        finite = abs(last[0]) + abs(last[4]) + abs(last[5]) + abs(last[6]) < np.inf
        return steps if steps < 0 or finite else -1

    return advance


advance, advance_simple = taylor(False), taylor(True)
