"""An independent rolling body: Newton and Euler along the axes of space, in decimal arithmetic of 34 digits.

No Euler angle and no reduced equation enters. The unknown reaction F acts at the lowest point ρ of the rim:

    I ω̇ + ω × I ω = ρ × F,   M v̇ = F − M g k,   v̇ = −ω̇ × ρ − ω × ρ̇  (no slip, differentiated),

and what is carried along is axis 1 and axis 3 of the body, ω, and the position and velocity of the centre of mass. That
v = −ω × ρ stays true is a check, not an input. Integrator: Gragg's modified midpoint rule, extrapolated in h² (Hairer,
Nørsett & Wanner, Solving Ordinary Differential Equations I, II.9); every answer is computed to two tolerances, and
their difference is the error that is stated.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass
from decimal import Decimal, localcontext

import numpy as np

DIGITS = 34
RUNS = 10  # midpoint runs extrapolated: order 20


@dataclass(frozen=True)
class Wheel:
    mass: float
    transverse: float
    axial: float
    radius: float
    offset: float
    gravity: float


@dataclass(frozen=True)
class Answer:
    """Float64 roundings at n times; `error` bounds every component, `slip` is the largest |v + ω × ρ|."""

    rotation: np.ndarray
    angular_velocity: np.ndarray
    position: np.ndarray
    force: np.ndarray
    error: float
    slip: float


def roll(wheel: Wheel, attitude, angular_velocity, times) -> Answer:
    """Follow a wheel from t = 0, starting with its contact at the origin, to ascending `times` in s."""
    with localcontext(prec=DIGITS):
        start = _start(wheel, attitude, angular_velocity)
        coarse, fine = (_integrate(wheel, start, times, Decimal(10) ** -digits) for digits in (18, 20))
        error = max(abs(a - b) for p, q in zip(coarse, fine, strict=True) for a, b in zip(p, q, strict=True))
        slip = max(abs(x) for s in fine for x in _add(s[12:], _cross(s[6:9], _arm(wheel, s[3:6]))))
        rotation = [np.array([s[:3], _cross(s[3:6], s[:3]), s[3:6]], dtype=float).T for s in fine]
        body = [[_dot(axis, s[6:9]) for axis in (s[:3], _cross(s[3:6], s[:3]), s[3:6])] for s in fine]
        weight = [0, 0, Decimal(wheel.gravity)]
        force = [[Decimal(wheel.mass) * x for x in _add(_rates(wheel, s)[12:], weight)] for s in fine]
    return Answer(
        np.array(rotation),
        np.array(body, dtype=float),
        np.array([s[9:12] for s in fine], dtype=float),
        np.array(force, dtype=float),
        float(error),
        float(slip),
    )


def _start(wheel, attitude, angular_velocity):
    x, y, z, w = (Decimal(float(a)) for a in attitude)
    size = x * x + y * y + z * z + w * w
    columns = [
        [1 - 2 * (y * y + z * z) / size, 2 * (x * y + z * w) / size, 2 * (x * z - y * w) / size],
        [2 * (x * y - z * w) / size, 1 - 2 * (x * x + z * z) / size, 2 * (y * z + x * w) / size],
        [2 * (x * z + y * w) / size, 2 * (y * z - x * w) / size, 1 - 2 * (x * x + y * y) / size],
    ]
    spin = [Decimal(0)] * 3
    for column, rate in zip(columns, angular_velocity, strict=True):
        spin = _add(spin, [Decimal(float(rate)) * a for a in column])
    arm = _arm(wheel, columns[2])
    return [*columns[0], *columns[2], *spin, *(-a for a in arm), *_cross(arm, spin)]


def _arm(wheel, n):
    """From the centre of mass to the lowest point of the rim."""
    s = (n[0] ** 2 + n[1] ** 2).sqrt()
    down = [n[2] * n[0] / s, n[2] * n[1] / s, -s]
    return [Decimal(wheel.offset) * a + Decimal(wheel.radius) * b for a, b in zip(n, down, strict=True)]


def _rates(wheel, state):
    mass, a, c, radius, offset, gravity = (Decimal(x) for x in astuple(wheel))
    first, n, w, v = state[:3], state[3:6], state[6:9], state[12:]
    dn = _cross(w, n)
    s = (n[0] ** 2 + n[1] ** 2).sqrt()
    ds = (n[0] * dn[0] + n[1] * dn[1]) / s
    arm = _arm(wheel, n)
    ddown = [(dn[2] * x + n[2] * dx) / s - n[2] * x * ds / s**2 for x, dx in zip(n[:2], dn[:2], strict=True)]
    darm = [offset * p + radius * q for p, q in zip(dn, [*ddown, -ds], strict=True)]
    along = _dot(n, w)
    momentum = [a * p + (c - a) * along * q for p, q in zip(w, n, strict=True)]
    push = [-x for x in _cross(w, darm)]
    push[2] += gravity
    right = _add(_cross(momentum, w), [mass * x for x in _cross(arm, push)])
    diagonal = a + mass * _dot(arm, arm)
    matrix = [
        [(c - a) * n[i] * n[j] - mass * arm[i] * arm[j] + (diagonal if i == j else 0) for j in range(3)]
        for i in range(3)
    ]
    rows = [_cross(matrix[1], matrix[2]), _cross(matrix[2], matrix[0]), _cross(matrix[0], matrix[1])]
    determinant = _dot(matrix[0], rows[0])
    dw = [sum(rows[i][j] * right[i] for i in range(3)) / determinant for j in range(3)]
    dv = [p + q for p, q in zip(_cross(arm, dw), _cross(darm, w), strict=True)]
    return [*_cross(w, first), *dn, *dw, *v, *dv]


def _integrate(wheel, state, times, tolerance):
    now, step, states = Decimal(0), Decimal(1) / 32, []
    for time in times:
        end = +Decimal(float(time))  # the sign rounds it to the digits that are carried
        while now < end:
            h = min(step, end - now)
            trial, error = _step(wheel, state, h)
            if error < tolerance:
                now, state = now + h, trial
            grow = 0.8 * float(tolerance / (error + tolerance / 10**9)) ** (0.5 / RUNS)
            step = h * Decimal(min(2.0, grow))
        states.append(state)
    return states


def _step(wheel, state, step):
    rates = _rates(wheel, state)
    row = []
    for k in range(1, RUNS + 1):
        h = step / (2 * k)
        before, here = state, [x + h * d for x, d in zip(state, rates, strict=True)]
        for _ in range(2 * k - 1):
            before, here = here, [x + 2 * h * d for x, d in zip(before, _rates(wheel, here), strict=True)]
        previous, row = row, [here]
        for j, earlier in enumerate(previous, 1):
            factor = (Decimal(k) / (k - j)) ** 2 - 1
            row.append([x + (x - p) / factor for x, p in zip(row[-1], earlier, strict=True)])
    return row[-1], max(abs(x - y) for x, y in zip(row[-1], row[-2], strict=True))


def _add(a, b):
    return [x + y for x, y in zip(a, b, strict=True)]


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
