"""The compiled Taylor method on eight bodies side by side; `inertia.dynamics.integrators.lanes` says what it computes.

Imported only to be compiled (`inertia.native`). A row holds one quantity of eight bodies, so that what is done with it
is one vector instruction; this is why eight statements stand side by side.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.dynamics.integrators.loop_kernel import HEAD, VECTOR

ROWS, WORK, FORCE = 33, 23, 12
"""Rows of coefficients of a series; rows of numbers of a body; rows of numbers of a vector fixed in space."""

fused = njit(error_model="numpy", forceinline=True, fastmath={"contract"})


@fused
def row(table, a, n):
    """Return a row of eight lanes."""
    return (
        table[a, n, 0],
        table[a, n, 1],
        table[a, n, 2],
        table[a, n, 3],
        table[a, n, 4],
        table[a, n, 5],
        table[a, n, 6],
        table[a, n, 7],
    )


@fused
def put(table, a, n, s):
    """Write a row of eight lanes."""
    table[a, n, 0] = s[0]
    table[a, n, 1] = s[1]
    table[a, n, 2] = s[2]
    table[a, n, 3] = s[3]
    table[a, n, 4] = s[4]
    table[a, n, 5] = s[5]
    table[a, n, 6] = s[6]
    table[a, n, 7] = s[7]


@fused
def mul(a, b):
    """Return a b, lane by lane."""
    return (
        a[0] * b[0],
        a[1] * b[1],
        a[2] * b[2],
        a[3] * b[3],
        a[4] * b[4],
        a[5] * b[5],
        a[6] * b[6],
        a[7] * b[7],
    )


@fused
def add(a, b):
    """Return a + b."""
    return (
        a[0] + b[0],
        a[1] + b[1],
        a[2] + b[2],
        a[3] + b[3],
        a[4] + b[4],
        a[5] + b[5],
        a[6] + b[6],
        a[7] + b[7],
    )


@fused
def sub(a, b):
    """Return a − b."""
    return (
        a[0] - b[0],
        a[1] - b[1],
        a[2] - b[2],
        a[3] - b[3],
        a[4] - b[4],
        a[5] - b[5],
        a[6] - b[6],
        a[7] - b[7],
    )


@fused
def scaled(s, a):
    """Return a multiple of a."""
    return (
        s * a[0],
        s * a[1],
        s * a[2],
        s * a[3],
        s * a[4],
        s * a[5],
        s * a[6],
        s * a[7],
    )


@fused
def plus(s, table, a, m, b, k):
    """Return s + aₘ bₖ of two series."""
    return (
        s[0] + table[a, m, 0] * table[b, k, 0],
        s[1] + table[a, m, 1] * table[b, k, 1],
        s[2] + table[a, m, 2] * table[b, k, 2],
        s[3] + table[a, m, 3] * table[b, k, 3],
        s[4] + table[a, m, 4] * table[b, k, 4],
        s[5] + table[a, m, 5] * table[b, k, 5],
        s[6] + table[a, m, 6] * table[b, k, 6],
        s[7] + table[a, m, 7] * table[b, k, 7],
    )


@fused
def minus(s, table, a, m, b, k):
    """Return s − aₘ bₖ of two series."""
    return (
        s[0] - table[a, m, 0] * table[b, k, 0],
        s[1] - table[a, m, 1] * table[b, k, 1],
        s[2] - table[a, m, 2] * table[b, k, 2],
        s[3] - table[a, m, 3] * table[b, k, 3],
        s[4] - table[a, m, 4] * table[b, k, 4],
        s[5] - table[a, m, 5] * table[b, k, 5],
        s[6] - table[a, m, 6] * table[b, k, 6],
        s[7] - table[a, m, 7] * table[b, k, 7],
    )


@fused
def expand(table, work, force, vectors, squares, order):
    """Fill the series of q (rows 0 … 3), ω (4 … 6) and the vectors in the body (7 …) from their first coefficients on.

    The products of q and Ω are summed in two loops, so that the sums of each stay in the registers of AVX2.
    `work` holds 1/I (rows 0 … 2), Euler's coefficients (3 … 5), damping/I (6 … 8), the torque/I of now (9 … 11) and how
    fast that grows (20 … 22);
    `force` of each vector its matrix over I (rows 0 … 8) and the differences of its squares over I (9 … 11).
    """
    none = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for n in range(order):
        last = np.uint64(n)  # an index without a sign needs no test of it
        x = y = z = w = e = f = g = none
        a = b = c = d = none
        for m in range(np.uint64(0), last + np.uint64(1)):
            k = last - m
            x = plus(x, table, 3, m, 4, k)
            y = plus(y, table, 3, m, 5, k)
            z = plus(z, table, 3, m, 6, k)
            w = minus(w, table, 0, m, 4, k)
            c = minus(plus(c, table, 0, m, 5, k), table, 1, m, 4, k)
            d = plus(d, table, 1, m, 5, k)
        for m in range(np.uint64(0), last + np.uint64(1)):
            k = last - m
            a = minus(plus(a, table, 1, m, 6, k), table, 2, m, 5, k)
            b = minus(plus(b, table, 2, m, 4, k), table, 0, m, 6, k)
            d = plus(d, table, 2, m, 6, k)
            e = plus(e, table, 5, m, 6, k)
            f = plus(f, table, 6, m, 4, k)
            g = plus(g, table, 4, m, 5, k)
        scale = 1.0 / (n + 1)
        ahead = n + 1
        put(table, 0, ahead, scaled(0.5 * scale, add(x, a)))
        put(table, 1, ahead, scaled(0.5 * scale, add(y, b)))
        put(table, 2, ahead, scaled(0.5 * scale, add(z, c)))
        put(table, 3, ahead, scaled(0.5 * scale, sub(w, d)))
        first = 1.0 if n == 0 else 0.0
        p, q, r = row(table, 4, n), row(table, 5, n), row(table, 6, n)
        e = sub(add(mul(row(work, 3, 0), e), scaled(first, row(work, 9, 0))), mul(row(work, 6, 0), p))
        f = sub(add(mul(row(work, 4, 0), f), scaled(first, row(work, 10, 0))), mul(row(work, 7, 0), q))
        g = sub(add(mul(row(work, 5, 0), g), scaled(first, row(work, 11, 0))), mul(row(work, 8, 0), r))
        if n == 1:
            e, f, g = add(e, row(work, 20, 0)), add(f, row(work, 21, 0)), add(g, row(work, 22, 0))
        for j in range(vectors):
            at, to = 7 + 3 * j, FORCE * j
            x = y = z = a = b = c = none
            for m in range(np.uint64(0), last + np.uint64(1)):
                k = last - m
                x = plus(x, table, at + 1, m, 6, k)
                y = plus(y, table, at + 2, m, 4, k)
                z = plus(z, table, at, m, 5, k)
                a = plus(a, table, at + 2, m, 5, k)
                b = plus(b, table, at, m, 6, k)
                c = plus(c, table, at + 1, m, 4, k)
            put(table, at, ahead, scaled(scale, sub(x, a)))
            put(table, at + 1, ahead, scaled(scale, sub(y, b)))
            put(table, at + 2, ahead, scaled(scale, sub(z, c)))
            x, y, z = row(table, at, n), row(table, at + 1, n), row(table, at + 2, n)
            for i in range(3):
                a = add(mul(row(force, to + 3 * i, 0), x), mul(row(force, to + 3 * i + 1, 0), y))
                a = add(a, mul(row(force, to + 3 * i + 2, 0), z))
                if i == 0:
                    e = add(e, a)
                elif i == 1:
                    f = add(f, a)
                else:
                    g = add(g, a)
            if squares:
                a = b = c = none
                for m in range(np.uint64(0), last + np.uint64(1)):
                    k = last - m
                    a = plus(a, table, at + 1, m, at + 2, k)
                    b = plus(b, table, at + 2, m, at, k)
                    c = plus(c, table, at, m, at + 1, k)
                e = add(e, mul(row(force, to + 9, 0), a))
                f = add(f, mul(row(force, to + 10, 0), b))
                g = add(g, mul(row(force, to + 11, 0), c))
        put(table, 4, ahead, scaled(scale, e))
        put(table, 5, ahead, scaled(scale, f))
        put(table, 6, ahead, scaled(scale, g))


@fused
def reach_of(table, j, order, tolerance):
    """Return the step of a lane over which its last two coefficients stay below the tolerance."""
    logarithm = np.inf
    for n in range(order - 1, order + 1):
        largest = 0.0
        for a in range(4):
            largest = max(largest, abs(table[a, n, j]))
        for a in range(4, 7):
            largest = max(largest, abs(table[a, n, j]) / max(1.0, abs(table[a, 0, j])))
        if largest > 0.0:
            logarithm = min(logarithm, np.log(tolerance / largest) / n)
        elif largest != 0.0:
            return np.nan
    return np.exp(logarithm)


@fused
def load(table, work, force, vectors, numbers, body, j):
    """Begin a body in a lane; none (−1) leaves one at rest there."""
    for a in range(7 + 3 * vectors):
        table[a, 0, j] = 0.0
    for a in range(WORK):
        work[a, 0, j] = 0.0
    for a in range(FORCE * vectors):
        force[a, 0, j] = 0.0
    table[3, 0, j] = 1.0
    work[15, 0, j] = body
    if body < 0:
        return
    of = numbers[body]
    for a in range(7):
        table[a, 0, j] = of[3 + a]
    work[14, 0, j] = of[10]
    for a in range(3):
        i, b, c = of[a], of[(a + 1) % 3], of[(a + 2) % 3]
        work[a, 0, j] = 1.0 / i
        work[3 + a, 0, j] = (b - c) / i
        work[6 + a, 0, j] = of[11 + 6 + a] / i
        work[9 + a, 0, j] = of[11 + a] / i
        work[20 + a, 0, j] = of[11 + 3 + a] / i
    x, y, z, w = of[3], of[4], of[5], of[6]
    for v in range(vectors):
        at, to = 11 + HEAD + VECTOR * v, FORCE * v
        a, b, c = of[at], of[at + 1], of[at + 2]
        d, e, f = b * z - c * y + w * a, c * x - a * z + w * b, a * y - b * x + w * c
        table[7 + 3 * v, 0, j] = a + 2.0 * (e * z - f * y)
        table[8 + 3 * v, 0, j] = b + 2.0 * (f * x - d * z)
        table[9 + 3 * v, 0, j] = c + 2.0 * (d * y - e * x)
        for k in range(3):
            for l in range(3):
                force[to + 3 * k + l, 0, j] = of[at + 15] * of[at + 3 + 3 * k + l] / of[k]
            b, c = of[at + 12 + (k + 1) % 3], of[at + 12 + (k + 2) % 3]
            force[to + 9 + k, 0, j] = of[at + 15] * (c - b) / of[k]


def follow_bodies(
    numbers_at, bodies, vectors, squares, times_at, samples, order, tolerance, limit, rows_at, steps_at, scratch_at
):
    """Follow bodies by Taylor series, eight at a time, each with steps of its own; a lane that is done takes the next.

    A row of `numbers` (bodies, 11 + HEAD + VECTOR vectors) is I, q, ω, the unit of 1/time and the packed terms of a
    body; `rows` (bodies, samples, 7) become its states at the instants, and stay what they are where it is lost.
    """
    numbers = carray(numbers_at, (bodies, 11 + HEAD + VECTOR * vectors), np.float64)
    times = carray(times_at, (samples,), np.float64)
    rows = carray(rows_at, (bodies, samples, 7), np.float64)
    steps = carray(steps_at, (bodies,), np.float64)
    table = carray(scratch_at, (7 + 3 * vectors + WORK + FORCE * vectors + 8, ROWS, 8), np.float64)
    work = table[7 + 3 * vectors :]
    force = work[WORK:]
    value = force[FORCE * vectors :]
    begun = 0
    for j in range(8):
        load(table, work, force, vectors, numbers, begun if begun < bodies else -1, j)
        begun += 1
    active = min(bodies, 8)
    while active > 0:
        expand(table, work, force, vectors, squares, order)
        for j in range(8):
            work[13, 0, j] = reach_of(table, j, order, tolerance)
        pending = True
        while pending:
            pending = False
            for j in range(8):
                tau = work[13, 0, j]
                sample = int(work[16, 0, j])
                work[18, 0, j] = 0.0
                if work[15, 0, j] >= 0.0 and sample < samples:
                    ahead = (times[sample] * work[14, 0, j] - work[12, 0, j]) - work[19, 0, j]
                    if ahead <= tau:
                        tau, pending = ahead, True
                        work[18, 0, j] = 1.0
                work[17, 0, j] = tau
            tau = row(work, 17, 0)
            for a in range(7):
                s = row(table, a, order)
                for n in range(order - 1, -1, -1):
                    s = add(mul(s, tau), row(table, a, n))
                put(value, a, 0, s)
            for j in range(8):
                if work[18, 0, j] > 0.0:
                    out = rows[int(work[15, 0, j]), int(work[16, 0, j])]
                    work[16, 0, j] += 1.0
                    size = 0.0
                    for a in range(4):
                        size += value[a, 0, j] * value[a, 0, j]
                    unit = 1.0 / np.sqrt(size)
                    for a in range(4):
                        out[a] = value[a, 0, j] * unit
                    for a in range(4, 7):
                        out[a] = value[a, 0, j] * work[14, 0, j]
        for j in range(8):
            body = int(work[15, 0, j])
            if body < 0:
                continue
            steps[body] += 1.0
            reach, size, total = work[13, 0, j], 0.0, 0.0
            for a in range(4):
                size += value[a, 0, j] * value[a, 0, j]
            for a in range(4, 7):
                total += abs(value[a, 0, j])
            if work[16, 0, j] >= samples or not (size + total < np.inf and reach > 0.0) or steps[body] > limit:
                if work[16, 0, j] < samples:
                    steps[body] = -steps[body]
                following = begun if begun < bodies else -1
                begun += 1
                active -= following < 0
                load(table, work, force, vectors, numbers, following, j)
                continue
            unit = 1.5 - 0.5 * size
            for a in range(4):
                table[a, 0, j] = value[a, 0, j] * unit
            for a in range(4, 7):
                table[a, 0, j] = value[a, 0, j]
            x, y, z, w = table[0, 0, j], table[1, 0, j], table[2, 0, j], table[3, 0, j]
            for v in range(vectors):
                at = 11 + HEAD + VECTOR * v
                a0, b0, c0 = numbers[body, at], numbers[body, at + 1], numbers[body, at + 2]
                d, e, f = b0 * z - c0 * y + w * a0, c0 * x - a0 * z + w * b0, a0 * y - b0 * x + w * c0
                table[7 + 3 * v, 0, j] = a0 + 2.0 * (e * z - f * y)
                table[8 + 3 * v, 0, j] = b0 + 2.0 * (f * x - d * z)
                table[9 + 3 * v, 0, j] = c0 + 2.0 * (d * y - e * x)
            span = reach + work[19, 0, j]
            ahead = work[12, 0, j] + span
            work[19, 0, j] = span - (ahead - work[12, 0, j])
            work[12, 0, j] = ahead
            for a in range(3):
                work[9 + a, 0, j] = numbers[body, 11 + a] / numbers[body, a] + work[20 + a, 0, j] * ahead
    return 0
