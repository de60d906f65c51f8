"""The compiled Runge–Kutta method on many free bodies at once, for `inertia.dynamics.integrators.ensemble`.

Imported only to be compiled (`inertia.native`). The bodies of a block lie side by side, one quantity a row, so that
the innermost loop over them becomes vector instructions.
"""

from __future__ import annotations

import numpy as np
from numba import carray, njit

LANES = 16


@njit(inline="always")
def rate(e, f, g, x, y, z, w, p, q, r):
    """Return the rate of (q, ω) of a free body whose Euler coefficients are (I₂ − I₃)/I₁ and so on."""
    return (
        0.5 * (w * p + y * r - z * q),
        0.5 * (w * q + z * p - x * r),
        0.5 * (w * r + x * q - y * p),
        -0.5 * (x * p + y * q + z * r),
        e * q * r,
        f * r * p,
        g * p * q,
    )


def step_bodies(bodies_at, padded, steps, step, block_at):
    """Take `steps` steps with every body; the rows of `bodies` (10, padded) are q, ω and the Euler coefficients."""
    bodies = carray(bodies_at, (10, padded), np.float64)
    block = carray(block_at, (10, LANES), np.float64)
    half, sixth = 0.5 * step, step / 6.0
    for begin in range(0, padded, LANES):
        for k in range(10):
            for j in range(LANES):
                block[k, j] = bodies[k, begin + j]
        for _ in range(steps):
            for j in range(LANES):
                x, y, z, w = block[0, j], block[1, j], block[2, j], block[3, j]
                p, q, r = block[4, j], block[5, j], block[6, j]
                e, f, g = block[7, j], block[8, j], block[9, j]
                a0, a1, a2, a3, a4, a5, a6 = rate(e, f, g, x, y, z, w, p, q, r)
                b0, b1, b2, b3, b4, b5, b6 = rate(
                    e,
                    f,
                    g,
                    x + half * a0,
                    y + half * a1,
                    z + half * a2,
                    w + half * a3,
                    p + half * a4,
                    q + half * a5,
                    r + half * a6,
                )
                c0, c1, c2, c3, c4, c5, c6 = rate(
                    e,
                    f,
                    g,
                    x + half * b0,
                    y + half * b1,
                    z + half * b2,
                    w + half * b3,
                    p + half * b4,
                    q + half * b5,
                    r + half * b6,
                )
                d0, d1, d2, d3, d4, d5, d6 = rate(
                    e,
                    f,
                    g,
                    x + step * c0,
                    y + step * c1,
                    z + step * c2,
                    w + step * c3,
                    p + step * c4,
                    q + step * c5,
                    r + step * c6,
                )
                x += sixth * (a0 + 2.0 * (b0 + c0) + d0)
                y += sixth * (a1 + 2.0 * (b1 + c1) + d1)
                z += sixth * (a2 + 2.0 * (b2 + c2) + d2)
                w += sixth * (a3 + 2.0 * (b3 + c3) + d3)
                scale = 1.5 - 0.5 * (x * x + y * y + z * z + w * w)
                block[0, j], block[1, j], block[2, j], block[3, j] = x * scale, y * scale, z * scale, w * scale
                block[4, j] = p + sixth * (a4 + 2.0 * (b4 + c4) + d4)
                block[5, j] = q + sixth * (a5 + 2.0 * (b5 + c5) + d5)
                block[6, j] = r + sixth * (a6 + 2.0 * (b6 + c6) + d6)
        for k in range(7):
            for j in range(LANES):
                bodies[k, begin + j] = block[k, j]
    return 0
