"""A ball that slides with friction, followed by DOP853; `inertia.dynamics.models.sliding.equations` says what moves it.

Imported only to be compiled (`inertia.native`).
"""

from __future__ import annotations

import numpy as np
from numba import carray

from inertia.dynamics.integrators.dop853_kernel import dop853, inline


@inline
def sliding(problem, time, state, slope):
    """Write the rate of (q, ω, v, place, heat), for a ball of mass and radius one; there is none where it is jammed."""
    moments, figures = problem
    x, y, z, w, p, q, r = state[0], state[1], state[2], state[3], state[4], state[5], state[6]
    v, o = state[7], state[8]
    i, j, k = moments[0], moments[1], moments[2]
    b1, b2, b3 = figures[0], figures[1], figures[2]
    scale = 2.0 / (x * x + y * y + z * z + w * w)
    e1, e2, e3 = 1.0 - scale * (y * y + z * z), scale * (x * y - z * w), scale * (x * z + y * w)
    f1, f2, f3 = scale * (x * y + z * w), 1.0 - scale * (x * x + z * z), scale * (y * z - x * w)
    n1, n2, n3 = scale * (x * z - y * w), scale * (y * z + x * w), 1.0 - scale * (x * x + y * y)
    a1, a2, a3 = b1 - n1, b2 - n2, b3 - n3
    c1, c2, c3 = q * a3 - r * a2, r * a1 - p * a3, p * a2 - q * a1
    s, t = v + c1 * e1 + c2 * e2 + c3 * e3, o + c1 * f1 + c2 * f2 + c3 * f3
    square = s * s + t * t
    drag = figures[6] / np.sqrt(square + figures[7] ** 2)
    h1, h2, h3 = (b2 * n3 - b3 * n2) / i, (b3 * n1 - b1 * n3) / j, (b1 * n2 - b2 * n1) / k
    g1, g2, g3 = (j - k) * q * r, (k - i) * r * p, (i - j) * p * q
    inward = (p * n1 + q * n2 + r * n3) * (p * b1 + q * b2 + r * b3)
    inward -= (p * p + q * q + r * r) * (b1 * n1 + b2 * n2 + b3 * n3)
    pull = -figures[5] - (h1 * g1 + h2 * g2 + h3 * g3) - inward
    if pull < 0.0:
        drag = 0.0
    d1, d2, d3 = n1 - drag * (s * e1 + t * f1), n2 - drag * (s * e2 + t * f2), n3 - drag * (s * e3 + t * f3)
    m1, m2, m3 = a2 * d3 - a3 * d2, a3 * d1 - a1 * d3, a1 * d2 - a2 * d1
    share = 1.0 + h1 * m1 + h2 * m2 + h3 * m3
    if share <= 0.0:
        return False
    force = pull / share
    slope[0] = 0.5 * (w * p + y * r - z * q)
    slope[1] = 0.5 * (w * q + z * p - x * r)
    slope[2] = 0.5 * (w * r + x * q - y * p)
    slope[3] = -0.5 * (x * p + y * q + z * r)
    slope[4], slope[5], slope[6] = (g1 + force * m1) / i, (g2 + force * m2) / j, (g3 + force * m3) / k
    slope[7], slope[8] = figures[3] - force * drag * s, figures[4] - force * drag * t
    slope[9], slope[10], slope[11] = v, o, force * drag * square
    return True


_run = dop853(sliding, 12)


def slide(
    moments_at, figures_at, _, times_at, samples, start, end, rate, limit, rows_at, tolerance, most, table_at, unit_at
):
    """Follow a ball through a piece of a run; its figures are b, gravity, the friction and the slip speed."""
    problem = carray(moments_at, (3,), np.float64), carray(figures_at, (8,), np.float64)
    piece = times_at, samples, start, end, rate, limit, rows_at
    return _run(problem, piece, tolerance, most, table_at, unit_at)
