"""The compiled Taylor method for a rigid body; `inertia.dynamics.stepping.integrators.taylor` says what it computes.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

HEAD, VECTOR = 10, 17


@njit(inline="always")
def horner(series, row, order, tau):
    """Return the value of one row of the series at `tau`."""
    total = series[order, row]
    for n in range(order - 1, -1, -1):
        total = total * tau + series[n, row]
    return total


@njit(inline="always")
def expand(moments, terms, count, now, order, series, pull):
    """Fill `series` (order + 1, 13 + 3 count) with the coefficients of q, ω, Ω, Ω − ω and the vectors in the body.

    Moments are subtracted before anything else, so that slender bodies keep their digits.
    """
    a, b, c = moments[0], moments[1], moments[2]
    kappa = terms[9]
    x, y, z, w = series[0, 0], series[0, 1], series[0, 2], series[0, 3]
    for j in range(count):
        at = HEAD + VECTOR * j
        u0, u1, u2 = terms[at], terms[at + 1], terms[at + 2]
        s0 = u1 * z - u2 * y + w * u0
        s1 = u2 * x - u0 * z + w * u1
        s2 = u0 * y - u1 * x + w * u2
        series[0, 13 + 3 * j] = u0 + 2.0 * (s1 * z - s2 * y)
        series[0, 14 + 3 * j] = u1 + 2.0 * (s2 * x - s0 * z)
        series[0, 15 + 3 * j] = u2 + 2.0 * (s0 * y - s1 * x)
    for n in range(order):
        e0 = e1 = e2 = 0.0
        for m in range(n + 1):
            p0, p1, p2 = series[m, 4], series[m, 5], series[m, 6]
            k = n - m
            e0 += p1 * series[k, 6]
            e1 += p2 * series[k, 4]
            e2 += p0 * series[k, 5]
        e0, e1, e2 = e0 * (b - c) / a, e1 * (c - a) / b, e2 * (a - b) / c
        series[n, 10], series[n, 11], series[n, 12] = kappa * e0 / a, kappa * e1 / b, kappa * e2 / c
        series[n, 7] = series[n, 4] + series[n, 10]
        series[n, 8] = series[n, 5] + series[n, 11]
        series[n, 9] = series[n, 6] + series[n, 12]
        if kappa != 0.0:
            g0 = g1 = g2 = 0.0
            for m in range(n + 1):
                p0, p1, p2 = a * series[m, 4], b * series[m, 5], c * series[m, 6]
                k = n - m
                r0, r1, r2 = series[k, 10], series[k, 11], series[k, 12]
                g0 += p1 * r2 - p2 * r1
                g1 += p2 * r0 - p0 * r2
                g2 += p0 * r1 - p1 * r0
            e0, e1, e2 = e0 + g0 / a, e1 + g1 / b, e2 + g2 / c
        g0 = g1 = g2 = g3 = 0.0
        for m in range(n + 1):
            k = n - m
            r0, r1, r2 = series[k, 7], series[k, 8], series[k, 9]
            x, y, z, w = series[m, 0], series[m, 1], series[m, 2], series[m, 3]
            g0 += w * r0 + y * r2 - z * r1
            g1 += w * r1 + z * r0 - x * r2
            g2 += w * r2 + x * r1 - y * r0
            g3 += x * r0 + y * r1 + z * r2
        scale = 1.0 / (n + 1)
        series[n + 1, 0] = 0.5 * g0 * scale
        series[n + 1, 1] = 0.5 * g1 * scale
        series[n + 1, 2] = 0.5 * g2 * scale
        series[n + 1, 3] = -0.5 * g3 * scale
        t0, t1, t2 = -terms[6] * series[n, 4], -terms[7] * series[n, 5], -terms[8] * series[n, 6]
        if n == 0:
            t0 += terms[0] + now * terms[3]
            t1 += terms[1] + now * terms[4]
            t2 += terms[2] + now * terms[5]
        elif n == 1:
            t0 += terms[3]
            t1 += terms[4]
            t2 += terms[5]
        for j in range(count):
            at, to = HEAD + VECTOR * j, 13 + 3 * j
            h0 = h1 = h2 = 0.0
            f0 = f1 = f2 = 0.0
            for m in range(n + 1):
                k = n - m
                r0, r1, r2 = series[k, 7], series[k, 8], series[k, 9]
                v0, v1, v2 = series[m, to], series[m, to + 1], series[m, to + 2]
                h0 += v1 * r2 - v2 * r1
                h1 += v2 * r0 - v0 * r2
                h2 += v0 * r1 - v1 * r0
                f0 += v1 * series[k, to + 2]
                f1 += v2 * series[k, to]
                f2 += v0 * series[k, to + 1]
            v0, v1, v2 = series[n, to], series[n, to + 1], series[n, to + 2]
            q0, q1, q2 = terms[at + 12], terms[at + 13], terms[at + 14]
            f0 = terms[at + 3] * v0 + terms[at + 4] * v1 + terms[at + 5] * v2 + (q2 - q1) * f0
            f1 = terms[at + 6] * v0 + terms[at + 7] * v1 + terms[at + 8] * v2 + (q0 - q2) * f1
            f2 = terms[at + 9] * v0 + terms[at + 10] * v1 + terms[at + 11] * v2 + (q1 - q0) * f2
            constant, slope = terms[at + 15], terms[at + 16]
            weight = constant + slope * now
            t0 += weight * f0
            t1 += weight * f1
            t2 += weight * f2
            if slope != 0.0:
                if n > 0:
                    t0 += slope * pull[j, 0]
                    t1 += slope * pull[j, 1]
                    t2 += slope * pull[j, 2]
                pull[j, 0], pull[j, 1], pull[j, 2] = f0, f1, f2
            series[n + 1, to] = h0 * scale
            series[n + 1, to + 1] = h1 * scale
            series[n + 1, to + 2] = h2 * scale
        series[n + 1, 4] = (e0 + t0 / a) * scale
        series[n + 1, 5] = (e1 + t1 / b) * scale
        series[n + 1, 6] = (e2 + t2 / c) * scale


@njit(inline="always")
def length(series, rows, order, tolerance):
    """Return the step over which the last two coefficients stay below the tolerance; infinite if they vanish."""
    step = np.inf
    for n in range(order - 1, order + 1):
        largest = 0.0
        for row in range(rows):
            if row < 7 or row > 12:
                largest = max(largest, abs(series[n, row]) / max(1.0, abs(series[0, row])))
        if largest > 0.0:
            step = min(step, (tolerance / largest) ** (1.0 / n))
    return step


def advance(moments_at, terms_at, count, state_at, times_at, samples, order, tolerance, limit, work_at, out_at):
    """Take the state (q, ω) from 0 to the last of `times`; write it at each of them. Return the steps, or −1."""
    rows = 13 + 3 * count
    moments = carray(moments_at, (3,), np.float64)
    terms = carray(terms_at, (HEAD + VECTOR * count,), np.float64)
    state = carray(state_at, (7,), np.float64)
    times = carray(times_at, (samples,), np.float64)
    work = carray(work_at, (order + 1 + count, rows), np.float64)
    out = carray(out_at, (samples, 7), np.float64)
    series, pull = work[: order + 1], work[order + 1 :]
    now = slack = 0.0
    done = steps = 0
    while done < samples:
        for k in range(7):
            series[0, k] = state[k]
        expand(moments, terms, count, now, order, series, pull)
        steps += 1
        step = length(series, rows, order, tolerance)
        if not step > 0.0 or steps > limit:
            return -1
        while done < samples and (times[done] - now) - slack <= step:
            tau = (times[done] - now) - slack
            for k in range(7):
                out[done, k] = horner(series, k, order, tau)
            done += 1
        for k in range(7):
            state[k] = horner(series, k, order, step)
        size = state[0] * state[0] + state[1] * state[1] + state[2] * state[2] + state[3] * state[3]
        for k in range(4):
            state[k] *= 1.5 - 0.5 * size
        step += slack
        ahead = now + step
        slack = step - (ahead - now)
        now = ahead
    return steps
