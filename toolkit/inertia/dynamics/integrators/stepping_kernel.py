"""The compiled steppers of equal steps: symmetric-top splitting and the classical Runge–Kutta method.

Imported only to be compiled (`inertia.native`); `splitting` and `runge_kutta` say what they compute.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

from inertia.dynamics.integrators.loop_kernel import HEAD, VECTOR, equal_steps


@njit(inline="always")
def pull(terms, count, time, x, y, z, w):
    """Return the torque at an attitude, without damping."""
    t0 = terms[0] + time * terms[3]
    t1 = terms[1] + time * terms[4]
    t2 = terms[2] + time * terms[5]
    for j in range(count):
        at = HEAD + VECTOR * j
        u0, u1, u2 = terms[at], terms[at + 1], terms[at + 2]
        s0 = u1 * z - u2 * y + w * u0
        s1 = u2 * x - u0 * z + w * u1
        s2 = u0 * y - u1 * x + w * u2
        v0 = u0 + 2.0 * (s1 * z - s2 * y)
        v1 = u1 + 2.0 * (s2 * x - s0 * z)
        v2 = u2 + 2.0 * (s0 * y - s1 * x)
        b0, b1, b2 = terms[at + 12] * v0, terms[at + 13] * v1, terms[at + 14] * v2
        weight = terms[at + 15] + terms[at + 16] * time
        t0 += weight * (terms[at + 3] * v0 + terms[at + 4] * v1 + terms[at + 5] * v2 + (v1 * b2 - v2 * b1))
        t1 += weight * (terms[at + 6] * v0 + terms[at + 7] * v1 + terms[at + 8] * v2 + (v2 * b0 - v0 * b2))
        t2 += weight * (terms[at + 9] * v0 + terms[at + 10] * v1 + terms[at + 11] * v2 + (v0 * b1 - v1 * b0))
    return t0, t1, t2


@njit(inline="always")
def turn(x, y, z, w, a, b, c, d):
    """Return the product of two quaternions."""
    return (
        w * a + x * d + (y * c - z * b),
        w * b + y * d + (z * a - x * c),
        w * c + z * d + (x * b - y * a),
        w * d - (x * a + y * b + z * c),
    )


@njit(inline="always")
def kick_axis(speed, torque, drag, moment, step):
    """Return the angular velocity after a constant torque and linear damping have acted on one axis."""
    z = drag * step / moment
    if z == 0.0:
        return speed + torque * step / moment
    lost = -np.expm1(-z)
    return speed * (1.0 - lost) + torque / drag * lost


@njit(inline="always")
def double_angle(half):
    """Return sine and cosine of an angle and of its half."""
    s, c = np.sin(half), np.cos(half)
    return 2.0 * s * c, 1.0 - 2.0 * s * s, s, c


@njit(error_model="numpy", forceinline=True)
def split_once(work, begin, step, first, last, state):
    """Take a step of a composition of pairs of flows.

    Axis 3 is that of the symmetric top, axis 1 that of the rest. The kick that ends a step is one with the kick that
    begins the next.
    """
    _, moments, terms, count, pairs, loaded = work
    stages = len(pairs)
    a, b, c = moments[0], moments[1], moments[2]
    ab, cb = a / b, c / b
    bc, ba = b / c, b / a
    rest, own = (b - a) / b, (b - c) / b
    x, y, z, w, p, q, r = state
    time = begin
    before = 0.0 if first else pairs[stages - 1, 1]
    for stage in range(stages + 1):
        if stage == stages and not last:
            break
        if loaded:
            kick = (before + (pairs[stage, 0] if stage < stages else 0.0)) * step
            t0, t1, t2 = pull(terms, count, time, x, y, z, w)
            p = kick_axis(p, t0, terms[6], a, kick)
            q = kick_axis(q, t1, terms[7], b, kick)
            r = kick_axis(r, t2, terms[8], c, kick)
        if stage == stages:
            break
        first_part, second_part = pairs[stage, 0] * step, pairs[stage, 1] * step
        before = pairs[stage, 1]
        if a != b:
            s, co, sh, ch = double_angle(0.5 * first_part * p * rest)
            q, r = co * q + s * cb * r, co * r - s * bc * q
            x, y, z, w = x * ch + w * sh, y * ch + z * sh, z * ch - y * sh, w * ch - x * sh
        both = first_part + second_part
        l0, l1, l2 = p * ab, q, r * cb
        size = np.sqrt(l0 * l0 + l1 * l1 + l2 * l2)
        half = 0.5 * both * size
        part = np.sin(half) / size if size > 0.0 else 0.0
        x, y, z, w = turn(x, y, z, w, part * l0, part * l1, part * l2, np.cos(half))
        s, co, sh, ch = double_angle(0.5 * both * r * own)
        p, q = co * p + s * ba * q, co * q - s * ab * p
        x, y, z, w = x * ch + y * sh, y * ch - x * sh, z * ch + w * sh, w * ch - z * sh
        if a != b:
            s, co, sh, ch = double_angle(0.5 * second_part * p * rest)
            q, r = co * q + s * cb * r, co * r - s * bc * q
            x, y, z, w = x * ch + w * sh, y * ch + z * sh, z * ch - y * sh, w * ch - x * sh
        time += both
    scale = 1.5 - 0.5 * (x * x + y * y + z * z + w * w)
    return x * scale, y * scale, z * scale, w * scale, p, q, r


_follow_split = equal_steps(split_once)


def split(
    moments_at, terms_at, count, times_at, samples, start, end, rate, limit, rows_at, counts_at, pairs_at, stages
):
    """Follow a composition of `stages` pairs through a piece of a run, with the axes in the order of `split_once`."""
    moments = carray(moments_at, (3,), np.float64)
    terms = carray(terms_at, (HEAD + VECTOR * count,), np.float64)
    counts = carray(counts_at, (samples + 1,), np.int64)
    pairs = carray(pairs_at, (stages, 2), np.float64)
    loaded = count > 0
    for k in range(9):
        loaded = loaded or terms[k] != 0.0
    work = counts, moments, terms, count, pairs, loaded
    return _follow_split(work, (times_at, samples, start, end, rate, limit, rows_at))


@njit(inline="always")
def rate(moments, terms, count, time, state):
    """Return the rate of (q, ω)."""
    x, y, z, w, p, q, r = state
    a, b, c = moments[0], moments[1], moments[2]
    e, f, g = (b - c) * q * r, (c - a) * r * p, (a - b) * p * q
    o0, o1, o2 = p, q, r
    if terms[9] != 0.0:
        kappa = terms[9]
        s0, s1, s2 = kappa * e / (a * a), kappa * f / (b * b), kappa * g / (c * c)
        o0, o1, o2 = p + s0, q + s1, r + s2
        e, f, g = e + (b * q * s2 - c * r * s1), f + (c * r * s0 - a * p * s2), g + (a * p * s1 - b * q * s0)
    size = 1.0 / np.sqrt(x * x + y * y + z * z + w * w)
    t0, t1, t2 = pull(terms, count, time, x * size, y * size, z * size, w * size)
    return (
        0.5 * (w * o0 + y * o2 - z * o1),
        0.5 * (w * o1 + z * o0 - x * o2),
        0.5 * (w * o2 + x * o1 - y * o0),
        -0.5 * (x * o0 + y * o1 + z * o2),
        (e + t0 - terms[6] * p) / a,
        (f + t1 - terms[7] * q) / b,
        (g + t2 - terms[8] * r) / c,
    )


@njit(inline="always")
def along(state, step, slope):
    """Return the state a step further along a slope."""
    x, y, z, w, p, q, r = state
    return (
        x + step * slope[0],
        y + step * slope[1],
        z + step * slope[2],
        w + step * slope[3],
        p + step * slope[4],
        q + step * slope[5],
        r + step * slope[6],
    )


@njit(error_model="numpy", forceinline=True)
def runge_kutta_once(work, time, step, first, last, state):
    """Take one step of the classical method of order four."""
    _, moments, terms, count = work
    half, sixth = 0.5 * step, step / 6.0
    a = rate(moments, terms, count, time, state)
    b = rate(moments, terms, count, time + half, along(state, half, a))
    c = rate(moments, terms, count, time + half, along(state, half, b))
    d = rate(moments, terms, count, time + step, along(state, step, c))
    mean = (
        a[0] + 2.0 * (b[0] + c[0]) + d[0],
        a[1] + 2.0 * (b[1] + c[1]) + d[1],
        a[2] + 2.0 * (b[2] + c[2]) + d[2],
        a[3] + 2.0 * (b[3] + c[3]) + d[3],
        a[4] + 2.0 * (b[4] + c[4]) + d[4],
        a[5] + 2.0 * (b[5] + c[5]) + d[5],
        a[6] + 2.0 * (b[6] + c[6]) + d[6],
    )
    x, y, z, w, p, q, r = along(state, sixth, mean)
    scale = 1.0 / np.sqrt(x * x + y * y + z * z + w * w)
    return x * scale, y * scale, z * scale, w * scale, p, q, r


_follow_runge_kutta = equal_steps(runge_kutta_once)


def runge_kutta_4(moments_at, terms_at, count, times_at, samples, start, end, rate, limit, rows_at, counts_at):
    """Follow the classical method of order four through a piece of a run."""
    moments = carray(moments_at, (3,), np.float64)
    terms = carray(terms_at, (HEAD + VECTOR * count,), np.float64)
    counts = carray(counts_at, (samples + 1,), np.int64)
    work = counts, moments, terms, count
    return _follow_runge_kutta(work, (times_at, samples, start, end, rate, limit, rows_at))
